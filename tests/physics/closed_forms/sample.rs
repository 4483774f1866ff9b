//! Random directions and velocities for property tests.

use glam::DVec3;
use nullray::spacetime::{Direction, Frame, Velocity};
use proptest::prelude::*;

/// The largest relative rounding error of one operation.
pub const EPS: f64 = f64::EPSILON / 2.0;

/// Proptest's defaults (PROPTEST_CASES sets the number of cases), but nothing written to the sources.
pub fn config() -> ProptestConfig {
    ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// Unit vectors, evenly over the sphere.
pub fn unit() -> impl Strategy<Value = DVec3> {
    (-1.0..1.0f64, 0.0..std::f64::consts::TAU).prop_map(|(z, azimuth)| {
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * azimuth.cos(), r * azimuth.sin(), z)
    })
}

/// Look directions, evenly over the sphere.
pub fn direction<F: Frame>() -> impl Strategy<Value = Direction<F>> {
    unit().prop_map(|d| Direction::new(d).unwrap())
}

/// Velocities of any direction, rapidity up to `max`.
pub fn velocity(max: f64) -> impl Strategy<Value = Velocity> {
    (unit(), 0.0..max).prop_map(|(n, phi)| Velocity::from_rapidity_along(phi, n).unwrap())
}

/// A unit vector at a right angle to the unit vector `n`.
pub fn perpendicular(n: DVec3) -> DVec3 {
    n.any_orthonormal_vector()
}
