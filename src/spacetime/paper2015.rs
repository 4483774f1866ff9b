//! The equations of Jarabo et al. 2015, exactly as published, for validating implementations that follow them.
//!
//! Jarabo, Masia, Velten, Barsi, Raskar, Gutierrez, "Relativistic Effects for Time-Resolved Light Transport",
//! Computer Graphics Forum 34(8), 2015. Everywhere else this crate computes the exact quantities; the documentation of each function here
//! says how it differs from the exact counterpart.
//!
//! Conventions: c = 1, times are ct in metres, accelerations in 1/m; β is signed, γ = 1/√(1 − β²); primes mark
//! the camera frame. The angle θ is that between the motion and the *propagation* of the light. The paper calls it the angle of the view,
//! but its Eqs. 2 and 5 hold for π minus that; with this reading its D is the wavelength ratio W = λ′/λ of this crate.

/// γ = 1/√(1 − β²).
pub fn lorentz_factor(beta: f64) -> f64 {
    // 1 − β² as a product, whose factor 1 − |β| keeps its digits.
    1.0 / ((1.0 - beta) * (1.0 + beta)).sqrt()
}

/// Eq. 1: t′ = t + zη, when light emitted at `time` at depth z = `depth` is captured, in a medium of
/// refractive index η = `index`; all metres.
///
/// Exact if the distance to the pinhole replaces the depth along the axis.
pub fn capture_time(time: f64, depth: f64, index: f64) -> f64 {
    time + depth * index
}

/// Eq. 2: D = γ (1 + β cos θ′) = λ′/λ for light that propagates at θ′ (radians) in the camera frame.
///
/// Exact: the wavelength ratio W.
pub fn doppler_factor(beta: f64, camera_angle: f64) -> f64 {
    lorentz_factor(beta) * one_plus(beta, camera_angle)
}

/// Eq. 2: cos θ = (cos θ′ + β)/(1 + β cos θ′), aberration from the camera frame to the world; the angle θ.
///
/// Exact. Evaluated as tan(θ/2) = √((1 − β)/(1 + β)) tan(θ′/2), which keeps the digits of small angles.
pub fn world_angle(beta: f64, camera_angle: f64) -> f64 {
    aberrated(-beta, camera_angle)
}

/// Eq. 2: λ = λ′/D, the wavelength emitted for one observed, in its unit.
///
/// Exact.
pub fn emitted_wavelength(observed: f64, doppler_factor: f64) -> f64 {
    observed / doppler_factor
}

/// D⁻⁵: observed radiance for an emitted one of 1.
///
/// Exact for radiance per wavelength in any direction of motion, though the paper restricts it to motion along the sensor's normal. The
/// paper uses the same for a spectral line, and for radiance over the spectrum, for both of which the exponent is −4; energies per exposure
/// of camera time have one power less, see [`Quantity`](super::Quantity).
pub fn radiance_factor(doppler_factor: f64) -> f64 {
    let square = doppler_factor * doppler_factor;
    1.0 / (square * square * doppler_factor)
}

/// Eq. 3: z′ = z √(sin²θ + cos²θ/γ²), the distance `distance` at angle θ to the motion, contracted like a
/// rod.
///
/// Differs from special relativity: light was emitted at an event, not by a rod. Exact: in the camera frame the emission event is at
/// distance z/D.
pub fn contracted_distance(beta: f64, world_angle: f64, distance: f64) -> f64 {
    let across = libm::sin(world_angle);
    let along = libm::cos(world_angle) / lorentz_factor(beta);
    distance * libm::sqrt(across * across + along * along)
}

/// Eq. 4: α′ = 2 arctan(tan(α/2)/γ), the field of view (radians) of a moving pinhole camera whose focal
/// length was d in the world and is taken to be γd in its own frame.
///
/// Differs from special relativity if the camera is a rigid body: its field of view, in its own frame, stays α.
pub fn field_of_view(beta: f64, resting_field_of_view: f64) -> f64 {
    let half = libm::tan(0.5 * resting_field_of_view);
    2.0 * libm::atan(half / lorentz_factor(beta))
}

/// Eq. 5: cos θ′ = (cos θ − β)/(1 − β cos θ), aberration from the world to the camera frame; the angle θ′.
///
/// Exact; the inverse of [`world_angle`].
pub fn camera_angle(beta: f64, world_angle: f64) -> f64 {
    aberrated(beta, world_angle)
}

/// Eq. 11: t = t′/γ − z′η, the time argument of the time-resolved texture, with z′ of
/// [`contracted_distance`].
///
/// Differs from special relativity: Δt = γ Δt′. Exact, for a point at rest at world distance r and a pinhole through the common origin: t
/// = γt′ − ηr.
pub fn emission_time(beta: f64, camera_time: f64, contracted_distance: f64, index: f64) -> f64 {
    camera_time / lorentz_factor(beta) - contracted_distance * index
}

/// Eq. 12: g = γ³ a, the proper acceleration along the motion for an acceleration a = dβ/dct in the world.
///
/// Exact for an acceleration along the velocity.
pub fn proper_acceleration(beta: f64, world_acceleration: f64) -> f64 {
    let gamma = lorentz_factor(beta);
    gamma * gamma * gamma * world_acceleration
}

/// Eq. 13: v = g t/√(1 + g²t²), the speed after world time t = `elapsed` of proper acceleration g from rest.
///
/// Exact.
pub fn speed_after(g: f64, elapsed: f64) -> f64 {
    let u = g * elapsed;
    u / libm::sqrt(1.0 + u * u)
}

/// Eq. 14: x − x₀ = (√(1 + g²t²) − 1)/g, the distance covered in world time t = `elapsed` from rest.
///
/// Exact. Evaluated as g t²/(√(1 + g²t²) + 1), which has no difference and allows g = 0.
pub fn position_after(g: f64, elapsed: f64) -> f64 {
    let u = g * elapsed;
    u * elapsed / (libm::sqrt(1.0 + u * u) + 1.0)
}

/// Eq. 15: t = sinh(g t′)/g, the world time after proper time t′ of proper acceleration g from rest.
///
/// Exact: [`WorldLine::hyperbolic`](super::worldline::WorldLine::hyperbolic). g = 0 gives t′.
pub fn world_time(g: f64, proper_time: f64) -> f64 {
    let u = g * proper_time;
    if u == 0.0 {
        return proper_time;
    }
    libm::sinh(u) / g
}

/// Eq. 16: d′ = (1/g)(1 − √((1 − v² + (gd)²v²)/(1 − v²))) + γd, the distance from sensor to pinhole in the
/// sensor's frame at speed v = `beta`, both with proper acceleration g from rest at distance d (Bell's ships).
///
/// Differs from special relativity by a sign: the equation is for a sensor that *leads* its pinhole. Exact for a pinhole ahead of the
/// sensor: γd + (√(1 + (gdγβ)²) − 1)/g, which this function gives for −g.
pub fn comoving_separation(g: f64, separation: f64, beta: f64) -> f64 {
    let gamma = lorentz_factor(beta);
    // (1 − v² + (gd)²v²)/(1 − v²) = 1 + (gdγv)², and the difference is that of position_after.
    gamma * separation - position_after(g, separation * gamma * beta)
}

/// Eq. 17: β = (βᵢ + βⱼ)/(1 + βᵢβⱼ), the speeds of camera and object composed.
///
/// Differs from special relativity: the paper uses it as the velocity of one relative to the other, for which (βⱼ − βᵢ)/(1 − βᵢβⱼ) is exact
/// along one line, and [`Velocity::relative_to`](super::Velocity::relative_to) in general.
pub fn composed_speed(first: f64, second: f64) -> f64 {
    (first + second) / (1.0 + first * second)
}

/// 1 + β cos θ, from the half angle whose square is added.
fn one_plus(beta: f64, angle: f64) -> f64 {
    let half = if beta > 0.0 {
        libm::cos(0.5 * angle)
    } else {
        libm::sin(0.5 * angle)
    };
    // cos θ = 2 cos²(θ/2) − 1 = 1 − 2 sin²(θ/2), whichever avoids a difference.
    (1.0 - beta.abs()) + 2.0 * beta.abs() * half * half
}

/// θ′ with cos θ′ = (cos θ − β)/(1 − β cos θ): tan(θ′/2) = √((1 + β)/(1 − β)) tan(θ/2).
fn aberrated(beta: f64, angle: f64) -> f64 {
    let factor = libm::sqrt((1.0 + beta) / (1.0 - beta));
    2.0 * libm::atan(factor * libm::tan(0.5 * angle))
}
