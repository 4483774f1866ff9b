use super::*;
use dashu_float::FBig;
use proptest::prelude::*;

type Big = FBig<dashu_float::round::mode::Zero, 2>;

fn big(x: f64) -> Big {
    // Precision 0 means exact.
    Big::try_from(x).unwrap().with_precision(0).value()
}

fn determinant(rows: [[Big; 3]; 3]) -> Big {
    let [[a, b, c], [d, e, f], [g, h, i]] = &rows;
    a * &(e * i - f * h) - b * &(d * i - f * g) + c * &(d * h - e * g)
}

fn difference(p: DVec3, o: DVec3) -> [Big; 3] {
    [0, 1, 2].map(|i| big(p[i]) - big(o[i]))
}

fn close(value: f64, exact: &Big) {
    let error = (big(value) - exact).to_f64().value().abs();
    assert!(
        error <= 4.0 * f64::EPSILON * value.abs(),
        "{value} for {exact:?}"
    );
}

fn vector() -> impl Strategy<Value = DVec3> {
    let number = prop_oneof![
        -1.0..1.0f64,
        (-8i32..8).prop_map(f64::from),
        (-1.0..1.0f64).prop_map(|x| x * 1e9),
        (-1.0..1.0f64).prop_map(|x| x * 1e-9)
    ];
    [number.clone(), number.clone(), number].prop_map(DVec3::from)
}

proptest! {
    #[test]
    fn determinants_have_the_sign_and_the_digits_of_exact_arithmetic(
        o in vector(), d in vector(), p in vector(), q in vector(),
    ) {
        let rows = [difference(d, DVec3::ZERO), difference(p, o), difference(q, o)];
        close(edge(o, d, p, q), &determinant(rows));
        let rows = [difference(d, o), difference(p, o), difference(q, o)];
        close(volume(o, [d, p, q]), &determinant(rows));
    }

    #[test]
    fn a_ray_through_a_point_of_an_edge_is_exactly_on_it(
        o in [-100i32..100, -100..100, -100..100], d in [-9i32..9, -9..9, -9..9], e in [-9i32..9, -9..9, -9..9],
    ) {
        let [o, d, e] = [o, d, e].map(|v| DVec3::from(v.map(f64::from)) * 0.1);
        // p and q are exact: multiples of o's, d's and e's last bits.
        prop_assert_eq!(edge(DVec3::ZERO, d, d * 4.0 - e, d * 4.0 + e) == 0.0,
            exact_zero(DVec3::ZERO, d, d * 4.0 - e, d * 4.0 + e));
        prop_assert_eq!(edge(o, d, o, o + e), 0.0);
    }
}

fn exact_zero(o: DVec3, d: DVec3, p: DVec3, q: DVec3) -> bool {
    let rows = [
        difference(d, DVec3::ZERO),
        difference(p, o),
        difference(q, o),
    ];
    determinant(rows) == Big::ZERO
}

#[test]
fn a_tail_of_one_part_in_2_to_the_100_is_seen() {
    let tiny = 2f64.powi(-50);
    let (x, y) = (1.0 + tiny, 1.0 - tiny);
    // (1 + t)(1 − t) − 1 = −t².
    let value = edge(
        DVec3::ZERO,
        DVec3::Z,
        DVec3::new(x, 1.0, 0.0),
        DVec3::new(1.0, y, 0.0),
    );
    assert_eq!(value, -tiny * tiny);
}
