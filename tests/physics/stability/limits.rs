//! The limits of f64: the error of a picture as γ grows.

use glam::DVec3;
use nullray::spacetime::{MAX_RAPIDITY, Velocity};
use nullray::validate::selftest::{REGIMES, Row};

use crate::stability::cases::Random;
use crate::stability::reference;

const PAGE: &str = include_str!("../../../src/validate/selftest/README.md");

/// The rows of the page's second table: γ, pixels for any direction of motion, pixels along an axis.
fn rows() -> Vec<[f64; 3]> {
    let rows = PAGE.lines().filter(|line| line.starts_with("| 1e"));
    let numbers = |row: &str| {
        let cells = row
            .trim_matches('|')
            .split(" | ")
            .map(|cell| cell.trim().parse().unwrap());
        cells.collect::<Vec<f64>>().try_into().unwrap()
    };
    rows.map(numbers).collect()
}

/// The largest shift of the picture, pixels, over directions that a camera of 60° may look in.
fn shift(gamma: f64, n: impl Fn(&mut Random) -> DVec3) -> f64 {
    let picture = REGIMES.iter().find(|r| r.name == "picture-1e12").unwrap();
    let mut random = Random::new(7);
    let phi = libm::acosh(gamma).min(MAX_RAPIDITY * 0.999_999);
    let cases = (0..2000).map(|_| {
        let w = n(&mut random) * phi;
        let d = random.unit();
        let inputs = [w.to_array(), d.to_array()].concat();
        Row {
            family: "look-end".into(),
            reference: reference::of("look-end", &inputs),
            inputs,
        }
    });
    cases.map(|row| picture.error(&row)).fold(0.0, f64::max)
}

#[test]
fn the_page_says_where_pictures_end_as_it_is_measured() {
    let rows = rows();
    assert!(rows.len() >= 6, "{rows:?}");
    let mut stale = Vec::new();
    for [gamma, oblique, along_an_axis] in rows {
        for (said, worst) in [
            (oblique, shift(gamma, Random::unit)),
            (along_an_axis, shift(gamma, Random::axis)),
        ] {
            println!("γ = {gamma:e}: {worst:.2e} pixels, {said:e} said");
            if worst > said || said > 1.3 * worst {
                stale.push(format!("γ = {gamma:e}: {worst:.3e}, {said:e} said"));
            }
        }
    }
    assert!(stale.is_empty(), "{stale:#?}");
}

#[test]
fn a_pixel_is_lost_only_beyond_a_lorentz_factor_of_three_trillion() {
    assert!(shift(3e12, Random::unit) < 1.0);
    assert!(shift(5e12, Random::unit) > 1.0);
    assert!(shift(1e17, Random::axis) < 1e-9);
}

#[test]
fn beyond_the_largest_rapidity_velocities_are_refused() {
    // γ = cosh 40 = 1.2e17: nothing is left of a picture but along an axis.
    assert!(Velocity::from_rapidity_along(MAX_RAPIDITY, DVec3::Z).is_ok());
    assert!(Velocity::from_rapidity_along(MAX_RAPIDITY.next_up(), DVec3::Z).is_err());
    assert!(Velocity::from_gamma(1.3e17, DVec3::Z).is_err());
}
