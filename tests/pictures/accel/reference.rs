//! Against arbitrary-precision reference vectors.

use glam::DVec3;

use crate::accel::common::*;

/// One row of triangles.csv.
struct Row<'a> {
    case: &'a str,
    numbers: Vec<f64>,
}

impl Row<'_> {
    fn vector(&self, at: usize) -> DVec3 {
        DVec3::from_slice(&self.numbers[at..])
    }
}

fn rows() -> Vec<Row<'static>> {
    let text = include_str!("../../data/physics/triangles.csv");
    let rows = text.lines().filter(|l| !l.starts_with('#')).skip(1);
    rows.map(|line| {
        let (case, numbers) = line.split_once(',').unwrap();
        let numbers = numbers.split(',').map(|n| n.parse().unwrap()).collect();
        Row { case, numbers }
    })
    .collect()
}

#[test]
fn reference_vectors_are_met_within_the_conditioning_limits() {
    let epsilon = f64::EPSILON / 2.0;
    let (mut worst_bary, mut worst_s, mut hits) = (0.0f64, 0.0f64, 0);
    for (i, row) in rows().iter().enumerate() {
        let corners = [0, 3, 6].map(|at| row.vector(at));
        let (o, d) = (row.vector(9), row.vector(12));
        let [hit, s, u, v] = [17, 18, 19, 20].map(|at| row.numbers[at]);
        let [cosn, cond] = [23, 24].map(|at| row.numbers[at]);
        let found = closest(&build(&[corners]), o, d);
        assert_eq!(found.is_some(), hit == 1.0, "row {i}, {}", row.case);
        let Some(found) = found else { continue };
        hits += 1;
        let bary = (found.u - u).abs().max((found.v - v).abs());
        let bary = bary / (epsilon * cond * u.abs().max(v.abs()).max(1.0));
        let s_error = (found.s * d.length() - s).abs() / s / (epsilon / cosn);
        // The hit's time on the ray, and its distance from the nearest edge in barycentric units.
        let [eta, start, time, margin] = [15, 16, 21, 22].map(|at| row.numbers[at]);
        let length = found.s * d.length();
        let allowed = epsilon * (4.0 * start.abs() + 64.0 * s / cosn);
        assert!(
            (start - eta * length - time).abs() <= allowed,
            "row {i}, {}",
            row.case
        );
        let inside = found.u.min(found.v).min(1.0 - found.u - found.v);
        let allowed = 24.0 * epsilon * cond * u.abs().max(v.abs()).max(1.0);
        assert!(
            (inside - margin).abs() <= allowed,
            "row {i}, {}: {inside} for {margin}",
            row.case
        );
        assert!(bary <= 8.0, "row {i}, {}: {bary}", row.case);
        assert!(s_error <= 64.0, "row {i}, {}: {s_error}", row.case);
        (worst_bary, worst_s) = (worst_bary.max(bary), worst_s.max(s_error));
    }
    assert!(hits > 250, "{hits} hits");
    println!("worst: barycentrics {worst_bary:.2}, s {worst_s:.2}");
}
