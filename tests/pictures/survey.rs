//! Warnings about data that look wrong, and none about data that do not.

use nullray::io::cube::{Cube, CubeSamples};
use nullray::light::time_texture::survey::{Order, of_samples};

/// A pulse that crosses 16 × 24 pixels within 32 bins, and an exponential tail; rows, columns and time are the
/// axes `order` of the array.
fn crossing(order: [usize; 3]) -> Cube {
    decaying(order, [16, 24, 32], 1.5)
}

/// The same of pixels and bins in `sizes`, with a tail of `decay` bins, on tiles of two colours.
fn decaying(order: [usize; 3], sizes: [usize; 3], decay: f64) -> Cube {
    let shape = order.map(|axis| sizes[axis]);
    let [h, w, t] = shape;
    let sample = |n: usize| {
        let index = [n / (w * t), n / t % w, n % t];
        let at = |axis| index[order.iter().position(|a| *a == axis).unwrap()];
        let since = at(2) as f64 - 4.0 - 0.3 * at(0) as f64 - 0.2 * at(1) as f64;
        let tile = [1.0, 0.4][(at(0) / 3 + at(1) / 5) % 2];
        if since >= 0.0 {
            (-since / decay).exp() as f32 * tile
        } else {
            0.0
        }
    };
    let samples = (0..h * w * t).map(sample).collect();
    Cube::new([h, w, t, 1], CubeSamples::F32(samples)).unwrap()
}

#[test]
fn another_order_of_axes_is_doubted_and_the_right_one_is_not() {
    assert_eq!(
        of_samples(&crossing([0, 1, 2]).into(), Order::Array),
        [""; 0]
    );
    for (order, named) in [([2, 0, 1], "T H W"), ([0, 2, 1], "H T W")] {
        let doubt = format!("axes = \"{named}\"");
        let found = of_samples(&crossing(order).into(), Order::Array);
        assert!(found.iter().any(|r| r.contains(&doubt)), "{found:?}");
        // Who says the order is believed.
        let found = of_samples(&crossing(order).into(), Order::Stated);
        assert!(!found.iter().any(|r| r.contains("axes")), "{found:?}");
    }
}

#[test]
fn another_order_is_doubted_of_light_that_decays_slowly() {
    let cube = |order, decay| decaying(order, [16, 24, 200], decay).into();
    for decay in [20.0, 60.0, 200.0] {
        assert!(
            !of_samples(&cube([0, 1, 2], decay), Order::Array)
                .iter()
                .any(|r| r.contains("axes")),
            "{decay}"
        );
        for (order, named) in [([2, 0, 1], "T H W"), ([0, 2, 1], "H T W")] {
            let doubt = format!("axes = \"{named}\"");
            let found = of_samples(&cube(order, decay), Order::Array);
            assert!(
                found.iter().any(|r| r.contains(&doubt)),
                "{decay}: {found:?}"
            );
        }
    }
}

#[test]
fn axes_without_light_get_no_warning() {
    // All light of 16 × 16 pixels comes in one of 20,011 bins, which no line of pixels that is looked at has.
    let sample = |n: usize| if n % 20_011 == 7_003 { 1.0 } else { 0.0 };
    let samples = CubeSamples::F32((0..16 * 16 * 20_011).map(sample).collect());
    let cube = Cube::new([16, 16, 20_011, 1], samples).unwrap();
    let found = of_samples(&cube.into(), Order::Array);
    assert!(!found.iter().any(|r| r.contains("axes")), "{found:?}");
}

#[test]
fn streaks_that_are_taken_for_frames_are_doubted() {
    // Files, rows and columns are the camera's rows, its columns and time, and are taken for time, rows and columns.
    let found = of_samples(&crossing([1, 2, 0]).into(), Order::Pictures);
    assert!(
        found.iter().any(|r| r.contains("axes = \"H W T\"")),
        "{found:?}"
    );
    assert_eq!(
        of_samples(&crossing([0, 1, 2]).into(), Order::Pictures),
        [""; 0]
    );
}

#[test]
fn light_that_is_cut_off_is_remarked_on() {
    let found = |f: fn(usize) -> f32| {
        let samples = CubeSamples::F32((0..20).map(f).collect());
        of_samples(
            &Cube::new([1, 1, 20, 1], samples).unwrap().into(),
            Order::Array,
        )
    };
    let cut = found(|n| (n + 1) as f32);
    assert!(
        cut[0].contains("last bin is") && cut[0].contains("100.0 %"),
        "{cut:?}"
    );
    assert_eq!(found(|_| 1.0), [""; 0], "steady light has no end");
    assert_eq!(found(|n| if n == 9 { 1.0 } else { 0.02 }), [""; 0]);
}

#[test]
fn samples_below_zero_and_data_without_light_are_remarked_on() {
    let samples = (0..64)
        .map(|n| if n % 8 == 3 { 1.0 } else { -0.1 })
        .collect();
    let found = of_samples(
        &Cube::new([2, 4, 8, 1], CubeSamples::F32(samples))
            .unwrap()
            .into(),
        Order::Stated,
    );
    // Seven samples of -0.1 beside one of 1: 0.7 / 1.7 = 41.2 %.
    assert!(found[0].contains("41.2 %"), "{found:?}");
    let dark = Cube::new([1, 1, 2, 1], CubeSamples::F32(vec![0.0; 2])).unwrap();
    assert!(of_samples(&dark.into(), Order::Stated)[0].contains("is 0"));
}
