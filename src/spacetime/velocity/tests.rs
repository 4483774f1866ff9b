use super::*;

#[test]
fn four_ways_to_say_one_velocity_agree() {
    // β = 3/5: γ = 5/4, rapidity ln 2.
    let w = DVec3::new(0.0, 2f64.ln(), 0.0);
    for v in [
        Velocity::from_beta(DVec3::new(0.0, 0.6, 0.0)),
        Velocity::from_gamma(1.25, DVec3::Y * 7.0),
        Velocity::from_one_minus_beta(0.4, DVec3::Y),
        Velocity::from_rapidity(w),
    ] {
        assert!((v.unwrap().rapidity() - w).length() < 2e-16);
    }
}

#[test]
fn the_speed_of_light_is_refused() {
    assert_eq!(
        Velocity::from_beta(DVec3::X),
        Err(VelocityError::NotSlowerThanLight(1.0))
    );
    assert_eq!(
        Velocity::from_gamma(0.5, DVec3::X),
        Err(VelocityError::GammaBelowOne(0.5))
    );
    assert_eq!(
        Velocity::from_one_minus_beta(0.0, DVec3::X),
        Err(VelocityError::OneMinusBeta(0.0))
    );
    assert_eq!(
        Velocity::from_beta(DVec3::NAN),
        Err(VelocityError::NotFinite)
    );
    assert_eq!(
        Velocity::from_gamma(2.0, DVec3::ZERO),
        Err(VelocityError::NoDirection)
    );
    assert!(Velocity::from_rapidity(DVec3::X * 41.0).is_err());
}

#[test]
fn a_body_at_rest_needs_no_direction() {
    assert_eq!(Velocity::from_gamma(1.0, DVec3::ZERO), Ok(Velocity::REST));
    assert_eq!(Velocity::from_beta(DVec3::ZERO), Ok(Velocity::REST));
}

#[test]
fn the_length_of_the_direction_does_not_matter_even_at_the_ends_of_f64() {
    let v = DVec3::new(1.0, -1.0, 1.0);
    let expected = v / 3f64.sqrt() * 0.5;
    for scale in [5e-324, 1e-200, 1.0, 1e200, 1.7e308] {
        let w = Velocity::from_rapidity_along(0.5, v * scale)
            .unwrap()
            .rapidity();
        assert!((w - expected).length() < 2e-16, "{scale}: {w}");
    }
}

#[test]
fn the_smallest_velocities_have_a_unit_direction_of_motion() {
    for tiny in [5e-324, 1e-310, 1e-200] {
        let velocity = Velocity::from_beta(DVec3::new(tiny, tiny, 0.0)).unwrap();
        let (n, phi) = velocity.split();
        assert!((n.length() - 1.0).abs() < 3e-16, "{tiny}: {n}");
        assert!(phi >= tiny && phi <= 2.0 * tiny);
        assert_eq!(velocity.gamma(), 1.0);
    }
}

#[test]
fn a_small_beta_keeps_its_digits_when_given_as_one_minus_beta() {
    // β = 2⁻³³: artanh β = β + β³/3 + …
    let beta = 2f64.powi(-33);
    let w = Velocity::from_one_minus_beta(1.0 - beta, DVec3::X).unwrap();
    assert_eq!(w.rapidity().x, beta + beta * beta * beta / 3.0);
}

#[test]
fn the_largest_rapidity_is_accepted_in_every_direction_and_nothing_above_it() {
    for x in -9..=9 {
        let direction = DVec3::new(f64::from(x) * 0.3, 1.7, -0.9);
        let v = Velocity::from_rapidity_along(MAX_RAPIDITY, direction).unwrap();
        assert!(v.gamma().is_finite());
        assert!(Velocity::from_rapidity_along(MAX_RAPIDITY.next_up(), direction).is_err());
    }
    let too_fast = |v| matches!(v, Err(VelocityError::TooFast(w)) if w > MAX_RAPIDITY);
    assert!(too_fast(Velocity::from_gamma(1e200, DVec3::X)));
    assert!(too_fast(Velocity::from_gamma(f64::MAX, DVec3::X)));
    assert!(too_fast(Velocity::from_one_minus_beta(5e-324, DVec3::X)));
    assert!(too_fast(Velocity::from_rapidity(DVec3::splat(1e300))));
}

#[test]
fn the_fastest_beta_below_one_is_accepted() {
    // 1 − β = 2⁻⁵³: |w| = ½ ln((2 − q)/q) = ½ (54 ln 2 − q/2).
    let v = Velocity::from_beta(DVec3::Z * 1f64.next_down()).unwrap();
    assert!((v.rapidity().z / (27.0 * 2f64.ln()) - 1.0).abs() < 4e-16);
}

#[test]
fn collinear_rapidities_subtract_and_a_frame_is_at_rest_in_itself() {
    // Along an axis: at γ = 10⁸, different rounding in any other direction would be a relative motion.
    let n = DVec3::NEG_Z;
    for (a, b) in [(20.0, 19.5), (3.0, -4.0), (1e-9, 2e-9), (0.0, 17.0)] {
        let v = Velocity::from_rapidity_along(a, n).unwrap();
        let observer = Velocity::from_rapidity_along(b, n).unwrap();
        let seen = v.relative_to(observer).unwrap().rapidity();
        let allowed = 8.0 * f64::EPSILON * (a - b).abs().max(a).max(b.abs());
        assert!((seen - n * (a - b)).length() <= allowed, "{a} {b}: {seen}");
        assert_eq!(v.relative_to(v), Ok(Velocity::REST));
        assert_eq!(v.relative_to(Velocity::REST), Ok(v));
    }
    let fast = Velocity::from_rapidity_along(39.0, n).unwrap();
    assert!(fast.relative_to(-fast).is_err());
}
