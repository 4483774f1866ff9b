use super::*;

/// Numbers in (0, 1) without a pattern.
fn noise(n: u64) -> f64 {
    let hash = (n + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    ((hash ^ (hash >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 11) as f64 / (1u64 << 53) as f64
}

/// Samples of every kind that are read correctly, and the same with their bytes swapped.
#[test]
fn a_wrong_order_is_told_of_all_kinds_of_samples_and_of_no_right_one() {
    type Kind = (&'static str, fn(u64) -> f64);
    let kinds: [Kind; 7] = [
        ("noise", noise),
        ("noise about 0", |n| noise(n) - 0.5),
        ("normal", |n| {
            (0..12).map(|k| noise(12 * n + k)).sum::<f64>() - 6.0
        }),
        ("counts", |n| (noise(n) * 40.0).floor()),
        ("few digits", |n| half::f16::from_f64(noise(n)).to_f64()),
        ("a decay over ten decades", |n| 10f64.powf(-10.0 * noise(n))),
        ("another unit", |n| 1e-12 * noise(n)),
    ];
    for (name, kind) in kinds {
        let read = |turn: bool| {
            let single = |n| {
                let x = kind(n) as f32;
                let bits = x.to_bits();
                f64::from(f32::from_bits(if turn { bits.swap_bytes() } else { bits }))
            };
            let double = |n| {
                let bits = kind(n).to_bits();
                f64::from_bits(if turn { bits.swap_bytes() } else { bits })
            };
            let singles: Vec<f64> = (0..4000).map(single).collect();
            let doubles: Vec<f64> = (0..4000).map(double).collect();
            [ByteOrder::of(&singles, 4, 1), ByteOrder::of(&doubles, 8, 1)]
        };
        assert_eq!(read(false), [None, None], "{name}");
        assert!(
            read(true).iter().all(Option::is_some),
            "{name}: {:?}",
            read(true)
        );
    }
    // Tiny and huge samples, tails of a Gaussian down to 0, and too few samples to decide.
    for size in [1e-35, 1e35] {
        let samples: Vec<f64> = (0..4000)
            .map(|n| f64::from((size * noise(n)) as f32))
            .collect();
        assert_eq!(ByteOrder::of(&samples, 4, 1), None);
    }
    let tails: Vec<f64> = (0..4000)
        .map(|n| f64::from((-80.0 * noise(n)).exp() as f32))
        .collect();
    assert_eq!(ByteOrder::of(&tails, 4, 1), None);
    assert_eq!(ByteOrder::of(&[1e-40; 63], 4, 1), None);
}

/// Pulses with a tail, in consecutive lines of 100 bins.
fn pulse(n: u64) -> f64 {
    let t = (n % 100) as f64 - 20.0 - 10.0 * noise(n / 100);
    match t > 0.0 {
        true => (-t / 25.0).exp(),
        false => (-t * t / 8.0).exp(),
    }
}

/// The samples of a line each by what bits the file has, in the right order and the other.
fn told(bytes: usize, read: impl Fn(u64, bool) -> f64) -> [bool; 2] {
    [false, true].map(|turn| {
        let samples: Vec<f64> = (0..4000).map(|n| read(n, turn)).collect();
        ByteOrder::of(&samples, bytes, 1).is_some()
    })
}

type Kind = (&'static str, fn(u64) -> f64);

/// No evidence is reported for samples that look the same in either order, or that are correct.
#[test]
fn a_wrong_order_is_told_of_samples_in_half_precision() {
    let kinds: [Kind; 8] = [
        ("noise", noise),
        ("noise about 0", |n| noise(n) - 0.5),
        ("pulses", pulse),
        ("bright pulses", |n| 3e4 * pulse(n)),
        ("faint pulses", |n| 1e-3 * pulse(n)),
        ("noisy pulses", |n| pulse(n) * (0.9 + 0.2 * noise(n))),
        ("counts", |n| (noise(n) * 40.0).floor()),
        ("few counts", |n| (pulse(n) * 4.0 * noise(n)).floor()),
    ];
    for (name, kind) in kinds {
        let read = |n, turn: bool| {
            let bits = half::f16::from_f64(kind(n)).to_bits();
            half::f16::from_bits(if turn { bits.swap_bytes() } else { bits }).to_f64()
        };
        assert_eq!(told(2, read), [false, true], "{name}");
    }
    let tiny = |n, _| half::f16::from_f64(1e-6 * pulse(n)).to_f64();
    assert_eq!(told(2, tiny), [false; 2]);
}

#[test]
fn a_wrong_order_is_told_of_integers() {
    let kinds: [Kind; 6] = [
        ("counts", |n| (noise(n) * 40.0).floor()),
        ("few counts", |n| (pulse(n) * 4.0 * noise(n)).floor()),
        ("pulses up to 300", |n| (300.0 * pulse(n)).floor()),
        ("pulses up to 5000", |n| (5000.0 * pulse(n)).floor()),
        ("noisy pulses", |n| {
            (30000.0 * pulse(n) * (0.9 + 0.1 * noise(n))).floor()
        }),
        ("less a background", |n| {
            (90.0 * pulse(n) - 9.0 * noise(n)).floor()
        }),
    ];
    for (name, kind) in kinds {
        let is_signed = name.starts_with("less");
        let turned = |n: u64| {
            [
                f64::from((kind(n) as u16).swap_bytes()),
                f64::from((kind(n) as i16).swap_bytes()),
                f64::from((kind(n) as u32).swap_bytes()),
                f64::from((kind(n) as i32).swap_bytes()),
            ]
        };
        for (number, bytes) in [4, 4, 8, 8].into_iter().enumerate() {
            let unsigned = number % 2 == 0;
            if unsigned && is_signed {
                continue;
            }
            let read = |n, turn: bool| if turn { turned(n)[number] } else { kind(n) };
            assert_eq!(told(bytes, read), [false, true], "{name} {number}");
        }
    }
    // What is large in four bytes: 16 bits that a sum has shifted.
    let large = |n: u64| (5e8 * pulse(n)).floor();
    let read = |n, turn: bool| match turn {
        true => f64::from((large(n) as u32).swap_bytes()),
        false => large(n),
    };
    assert_eq!(told(8, read), [false, true]);
    // Noise from bin to bin, up to a quarter of the type, or with as many values below 0.
    let noisy = |n: u64| (1e9 * noise(n)).floor();
    let read = |n, turn: bool| match turn {
        true => f64::from((noisy(n) as u32).swap_bytes()),
        false => noisy(n),
    };
    assert_eq!(told(8, read), [false, true]);
    let read = |n, turn: bool| match turn {
        true => f64::from(((noisy(n) - 5e8) as i32).swap_bytes()),
        false => noisy(n) - 5e8,
    };
    assert_eq!(told(8, read), [false, true]);
    let read = |n, turn: bool| match turn {
        true => f64::from(((16384.0 * noise(n)) as u16).swap_bytes()),
        false => (16384.0 * noise(n)).floor(),
    };
    assert_eq!(told(4, read), [false, true]);
    // Eight bytes, of which double precision holds 53 bits.
    let counts = |n: u64| (5000.0 * noise(n)).floor();
    let read = |n, turn: bool| match turn {
        true => (counts(n) as u64).swap_bytes() as f64,
        false => counts(n),
    };
    assert_eq!(told(8, read), [false, true]);
    let fewer = |n: u64| (90.0 * pulse(n) - 9.0 * noise(n)).floor();
    let read = |n, turn: bool| match turn {
        true => (fewer(n) as i64).swap_bytes() as f64,
        false => fewer(n),
    };
    assert_eq!(told(8, read), [false, true]);
    // Noise that fills its type looks the same either way.
    let full = |n, _| (65535.0 * noise(n)).floor();
    assert_eq!(told(4, full), [false; 2]);
    // Twelve bits at the upper end of sixteen, and counts in single precision.
    let upper = |n, _| 16.0 * (4000.0 * pulse(n)).floor();
    assert_eq!(told(4, upper), [false; 2]);
}
