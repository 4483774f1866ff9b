//! The same results in arbitrary precision, from textbook equations.
//!
//! Triangles: sums and products without rounding, so that signs are exact, and quotients with 320 bits. Everything else: 320 bits
//! throughout.

use nullray::validate::selftest::Fine;

use crate::common::exact::{Exact, ExactBoost, Four, exact, four, look, rounded};
use glam::DVec3;

/// The results for `inputs` of `family`.
pub fn of(family: &str, inputs: &[f64]) -> Vec<Fine> {
    match family {
        "event" => event(inputs),
        "horizon" => horizon(inputs),
        _ if family.starts_with("look") => looked(inputs),
        _ => hit(inputs),
    }
}

fn vector(numbers: &[f64]) -> DVec3 {
    DVec3::from_slice(numbers)
}

/// The nearest f64, and three digits of what is left.
fn fine(x: &Exact) -> Fine {
    let value = rounded(x);
    let rest = rounded(&(x - exact(value)));
    Fine {
        value,
        rest: format!("{rest:.2e}").parse().unwrap(),
    }
}

fn plain(value: f64) -> Fine {
    Fine { value, rest: 0.0 }
}

fn looked(inputs: &[f64]) -> Vec<Fine> {
    let null = look(vector(&inputs[3..]));
    let [t, x, y, z] = ExactBoost::new(vector(inputs)).apply(&null);
    let w = -t;
    [x / &w, y / &w, z / &w, w].iter().map(fine).collect()
}

fn event(inputs: &[f64]) -> Vec<Fine> {
    let event = four(inputs[3], vector(&inputs[4..]));
    let boosted = ExactBoost::new(vector(inputs)).apply(&event);
    boosted.iter().map(fine).collect()
}

/// A number whose sums and products are not rounded.
fn big(x: f64) -> Exact {
    Exact::try_from(x).unwrap().with_precision(0).value()
}

fn minus(p: &[f64], q: &[f64]) -> [Exact; 3] {
    [0, 1, 2].map(|i| big(p[i]) - big(q[i]))
}

fn determinant([a, b, c]: [&[Exact; 3]; 3]) -> Exact {
    let cross = |i: usize, j: usize| &b[i] * &c[j] - &b[j] * &c[i];
    &a[0] * cross(1, 2) + &a[1] * cross(2, 0) + &a[2] * cross(0, 1)
}

fn hit(inputs: &[f64]) -> Vec<Fine> {
    let origin = &inputs[9..12];
    let [a, b, c] = [0, 3, 6].map(|at| minus(&inputs[at..], origin));
    let d = minus(&inputs[12..], &[0.0; 3]);
    // Volumes of the ray with the three edges: u weights b, v weights c.
    let [u, v, w] = [(&c, &a), (&a, &b), (&b, &c)].map(|(p, q)| determinant([&d, p, q]));
    let zero = big(0.0);
    let delta = &u + &v + &w;
    let inside =
        [&u, &v, &w].iter().all(|x| **x >= zero) || [&u, &v, &w].iter().all(|x| **x <= zero);
    if !inside || delta == zero {
        return vec![plain(0.0); 5];
    }
    let quotient = |x: &Exact| {
        let [x, delta] = [x, &delta].map(|x| x.clone().with_precision(320).value());
        x / delta
    };
    let s = quotient(&determinant([&a, &b, &c]));
    let side = if s > zero { 1.0 } else { -1.0 };
    let delta = plain(rounded(&delta.clone().with_precision(320).value()));
    vec![
        plain(side),
        fine(&s),
        fine(&quotient(&u)),
        fine(&quotient(&v)),
        delta,
    ]
}

/// Where (t, x∥) = (sinh gτ, cosh gτ − 1)/g crosses the past light cone of (T, X), with z = e^(gτ) from
/// (P − z)(1/z − Q) = g²X⊥², P = 1 + g(T + X∥), Q = 1 − g(T − X∥): of its roots the least above 0.
fn horizon(inputs: &[f64]) -> Vec<Fine> {
    let axis = (0..3).find(|&i| inputs[i] != 0.0).unwrap();
    let forward = inputs[axis].signum();
    let g = exact(inputs[axis].abs());
    let apex: Four = four(inputs[3], vector(&inputs[4..]));
    let along = &apex[axis + 1] * exact(forward);
    let one = exact(1.0);
    let p = &one + &g * (&apex[0] + &along);
    let q = &one - &g * (&apex[0] - &along);
    if p <= exact(0.0) {
        return vec![plain(f64::NAN); 4];
    }
    let across = (0..3)
        .filter(|&i| i != axis)
        .map(|i| &apex[i + 1] * &apex[i + 1]);
    let across = across.reduce(|a, b| a + b).unwrap();
    let m = (&one + &p * &q + &g * &g * &across) / exact(2.0);
    let root = (&m * &m - &p * &q).sqrt();
    let z = if m > exact(0.0) {
        &p / (&m + root)
    } else {
        (&m - root) / &q
    };
    let t = (&z - &one / &z) / (exact(2.0) * &g);
    let x = (&z + &one / &z - exact(2.0)) / (exact(2.0) * &g);
    // On the cone: T − t = |X − x| to eighty digits of the largest.
    let left = &apex[0] - &t;
    let aside = &along - &x;
    let distance = (&aside * &aside + across).sqrt();
    let largest = rounded(&t)
        .abs()
        .max(rounded(&apex[0]).abs())
        .max(rounded(&along).abs());
    assert!(
        rounded(&(left - distance)).abs() <= 1e-60 * largest,
        "{inputs:?}"
    );
    let mut crossing = vec![fine(&t)];
    crossing.extend((0..3).map(|i| match i == axis {
        true => fine(&(&x * exact(forward))),
        false => plain(0.0),
    }));
    crossing
}
