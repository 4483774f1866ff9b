use super::*;

#[test]
fn exponentials_in_loops_have_the_bits_of_single_ones() {
    let steps = (0..400_000).map(|i| -f64::from(i) * (33.0 / 400_000.0));
    let powers = (0..2000).map(|i| -libm::exp2(-f64::from(i) * 0.03));
    let edges = [
        0.0,
        -0.0,
        -0.5 * std::f64::consts::LN_2,
        -1.5 * std::f64::consts::LN_2,
    ];
    for x in steps.chain(powers).chain(edges) {
        let (ours, libm) = (exp_of_negative(x), libm::exp(x));
        assert_eq!(ours.to_bits(), libm.to_bits(), "{x:e}: {ours:e} {libm:e}");
    }
    let emission = Emission::Gaussian {
        centre: 0.3,
        sigma: 0.2,
        scale: 1.7,
    };
    let times: Vec<f64> = (-999..999)
        .map(|i| f64::from(i) * 3e-3)
        .chain([f64::NAN])
        .collect();
    let mut each = times.clone();
    emission.at_each(&mut each);
    for (time, each) in times.iter().zip(&each) {
        assert_eq!(emission.at(*time).to_bits(), each.to_bits(), "{time}");
    }
}

#[test]
fn the_normal_distribution_is_right_to_its_bound() {
    for k in -90_000..=90_000 {
        let x = f64::from(k) * 1e-4;
        let exact = 0.5 * libm::erfc(-x * FRAC_1_SQRT_2);
        let off = normal(x) - exact;
        assert!(off.abs() < 1e-12, "{x}: {off:e}");
    }
    assert_eq!(
        [normal(f64::NEG_INFINITY), normal(f64::INFINITY)],
        [0.0, 1.0]
    );
}

#[test]
fn a_train_is_the_sum_of_its_pulses() {
    for count in [1.0, 3.0, f64::INFINITY] {
        for x in [-2.3, -0.5, 0.0, 0.4, 1.5, 2.0, 2.2, 7.0] {
            let pulses =
                (-40..=40).filter(|k| count.is_infinite() || (0..count as i32).contains(k));
            let sum: f64 = pulses
                .map(|k| libm::exp(-0.5 * (1.5 * (x - f64::from(k))).powi(2)))
                .sum();
            assert!((train(x, 1.5, count) - sum).abs() < 1e-13, "{count} {x}");
        }
    }
    // No time is too late, and a finished train stays dark.
    assert_eq!(train(1e300, 1.5, 3.0), 0.0);
}

#[test]
fn emission_adds_up_to_its_integral() {
    let all = [
        Emission::Gaussian {
            centre: 0.3,
            sigma: 0.2,
            scale: 1.7,
        },
        Emission::Train {
            centre: -1.0,
            sigma: 0.2,
            period: 0.35,
            count: 5.0,
        },
        Emission::Table(Table::new(vec![
            [-1.0, 0.5],
            [0.2, 2.0],
            [0.5, 0.0],
            [1.5, 1.0],
        ])),
    ];
    for emission in all {
        // By the midpoint rule with 4000 steps.
        let (mut sum, step) = (0.0, 2e-3);
        for k in 0..4000 {
            let t = -4.0 + (f64::from(k) + 0.5) * step;
            sum += emission.at(t) * step;
            let until = emission.until(t + 0.5 * step);
            assert!(
                (until - sum).abs() < 2e-3,
                "{emission:?} {t}: {until} {sum}"
            );
        }
        let [from, to] = emission.span().unwrap();
        assert!(emission.until(from) < 1e-12 && emission.at(from - 1e-9) == 0.0);
        assert!((emission.until(to) - emission.until(9.0)).abs() < 1e-12);
    }
}

#[test]
fn a_table_is_linear_between_its_times_and_dark_outside() {
    let table = Table::new(vec![[0.0, 1.0], [2.0, 3.0], [3.0, 0.5]]);
    let values = [-0.1, 0.0, 1.0, 2.0, 2.5, 3.0, 3.1].map(|t| table.at(t));
    assert_eq!(values, [0.0, 1.0, 2.0, 3.0, 1.75, 0.5, 0.0]);
}

#[test]
fn the_integral_of_a_table_is_the_sum_over_its_pieces() {
    // Segments of lengths from 0.01 to 1, with values that also fall below 0; sums in the same order have the same bits.
    let knot = |k: u32| {
        let k = f64::from(k);
        [0.5 * k + 0.49 * libm::sin(k), libm::cos(0.7 * k)]
    };
    let knots: Vec<_> = (0..400).map(knot).collect();
    let table = Table::new(knots.clone());
    let direct = |time: f64| -> f64 {
        let pieces = knots.windows(2).map(|pair| {
            let upto = time.clamp(pair[0][0], pair[1][0]);
            trapezoid(pair[0], [upto, between(pair[0], pair[1], upto)])
        });
        pieces.sum()
    };
    let times = (-50..5000).map(|k| f64::from(k) * 0.041);
    for time in times.chain(knots.iter().map(|knot| knot[0])) {
        let (found, sum) = (table.until(time), direct(time));
        assert_eq!(found, sum, "{time}");
    }
    assert!(table.until(0.9) > 0.5);
    let none = Table::new(Vec::new());
    assert_eq!([none.until(1.0), none.at(1.0)], [0.0; 2]);
}
