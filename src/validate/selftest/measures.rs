//! Errors of results of this crate against arbitrary precision, in units of the expected rounding error.
//!
//! With eps = 2⁻⁵³, φ the rapidity, n the direction of motion, W the wavelength ratio:
//!
//! **Aberration.** Rounding moves a look direction d′ by eps, n too, and φ by eps φ. Aberration is conformal with scale 1/W, a change of
//! φ rotates d by δφ sin ∠(n, d), and n itself carries d along: δd ~ eps (1 + φ + 1/W). Boosting takes fewer than 16 roundings on any
//! path of a component: bound 16.
//!
//! **Wavelength ratio.** W = ½ (e^−φ(1 + c) + e^φ(1 − c)): δφ enters with the factor 1 + φ; rotating n by eps changes 1 − c by eps |d⊥|,
//! and in second order by eps², with the factor e^φ: δW/W ~ eps (1 + φ + sinh φ (|d⊥| + eps)/W). Bound 16.
//!
//! **Pictures.** The error of aberration is a shift in the picture: in the camera frame δd becomes W δd. An error of n rotates d by the
//! same amount, so the shift is at most (8 W + 8 (1 + φ)) eps ≤ 8 (2γ + 1 + φ) eps, over the angle of a pixel (1.13e-3: 60° in 1024):
//! 1.6e-12 γ pixels, whatever the direction of β.
//!
//! **Events.** A component of a boosted displacement is a sum: γ|t| + sinh φ Σ|nⱼxⱼ| for the time,
//! |xᵢ| + (γ − 1)|nᵢ| Σ|nⱼxⱼ| + sinh φ |nᵢt| for places. Each term passes through fewer than 16
//! roundings, those of φ φ-fold and of the light-cone form twice: bound 32 eps (1 + φ) of it.
//!
//! **Hits.** With corners a, b, c, a relative to the origin, e₁ = b − a, e₂ = c − a, Δ = (e₁ × e₂)·d:
//! s = (e₁ × e₂)·a/Δ, each triple product with at most 8 roundings of six terms, which are together below
//! |a|₁|e₁|₁|e₂|₁ or |d|∞|e₁|₁|e₂|₁: δs ≤ 8 eps κ + eps s, κ = (|a|₁ + |s||d|∞)|e₁|₁|e₂|₁/|Δ|. Barycentric
//! weights likewise with κ = |d|∞(|a|₁ + L)L/|Δ|, L = |e₁|₁ + |e₂|₁. Bound 10. Whether the line meets the
//! triangle is decided exactly, and a mistake counts as infinite. On which side of the origin it does is
//! decided by s: where s of a hit is missing, it counts as 0.
//!
//! **Horizons.** For a hyperbola at rest at the origin along an axis, only the closed form is rounded: 4 ulp (8 eps) of the largest
//! coordinate, however close to the horizon; beyond it there is no result.

use glam::DVec3;

use super::rows::{EPS, Fine};
use crate::accel::{Bvh, Facing, Ray};
use crate::spacetime::worldline::WorldLine;
use crate::spacetime::{Boost, CameraFrame, Direction, Displacement, Event, Rest, Velocity, World};

/// The angle of a pixel at the centre of 1024 that cover 60°.
const PIXEL: f64 = 1.127_637_244_512_189_7e-3; // 2 tan 30° / 1024

fn vector(numbers: &[f64]) -> DVec3 {
    DVec3::new(numbers[0], numbers[1], numbers[2])
}

fn difference(got: DVec3, reference: &[Fine]) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|i| reference[i].error(got[i])))
}

/// Infinite if there is no number.
fn or_infinite(error: Option<f64>) -> f64 {
    error.filter(|e| !e.is_nan()).unwrap_or(f64::INFINITY)
}

/// A look direction of the camera in the world.
struct Look {
    velocity: Velocity,
    d: DVec3,
    ratio: f64,
}

impl Look {
    /// Of w and d′.
    fn new(inputs: &[f64]) -> Option<Look> {
        let velocity = Velocity::from_rapidity(vector(&inputs[..3])).ok()?;
        let direction = Direction::<CameraFrame>::new(vector(&inputs[3..]))?;
        let (d, ratio) = Boost::<World, CameraFrame>::new(velocity).direction(direction);
        let d = d.unit();
        Some(Look { velocity, d, ratio })
    }

    fn rapidity(&self) -> f64 {
        self.velocity.rapidity().length()
    }
}

/// w, d′ → d, W: the error of d over eps (1 + φ + 1/W).
pub(super) fn aberration(inputs: &[f64], reference: &[Fine]) -> f64 {
    or_infinite(Look::new(inputs).map(|look| {
        let condition = 1.0 + look.rapidity() + 1.0 / reference[3].value;
        difference(look.d, reference).length() / (EPS * condition)
    }))
}

/// w, d′ → d, W: the relative error of W over eps (1 + φ + sinh φ (|d⊥| + eps)/W).
pub(super) fn wavelength(inputs: &[f64], reference: &[Fine]) -> f64 {
    or_infinite(Look::new(inputs).map(|look| {
        let (w, phi) = (reference[3].value, look.rapidity());
        let across = look.velocity.rapidity().cross(look.d).length() / phi;
        // |d⊥| is W times that of the world.
        let turned = libm::sinh(phi) * (across + EPS / w);
        reference[3].error(look.ratio) / (w * EPS * (1.0 + phi + turned))
    }))
    .abs()
}

/// w, d′ → d, W: the error of the picture there, in pixels.
pub(super) fn picture(inputs: &[f64], reference: &[Fine]) -> f64 {
    or_infinite(Look::new(inputs).map(|look| {
        let error = difference(look.d, reference);
        // The component along d itself moves nothing.
        let aside = error - look.d * look.d.dot(error);
        aside.length() * reference[3].value / PIXEL
    }))
}

/// w, t, x → t′, x′: the error over eps (1 + φ) of the sum of a component's terms.
pub(super) fn event(inputs: &[f64], reference: &[Fine]) -> f64 {
    let Ok(velocity) = Velocity::from_rapidity(vector(&inputs[..3])) else {
        return f64::INFINITY;
    };
    let (t, x) = (inputs[3], vector(&inputs[4..]));
    let got = Boost::<World, Rest>::new(velocity).displacement(Displacement::new(t, x));
    let phi = velocity.rapidity().length();
    let n = velocity.rapidity().abs() / phi;
    // Terms by their absolute values, as in the bound of `Boost::displacement`.
    let (along, sinh) = (n.dot(x.abs()), libm::sinh(phi));
    let shared = velocity.gamma_minus_one() * along + sinh * t.abs();
    let mut worst = reference[0].error(got.ct).abs() / (velocity.gamma() * t.abs() + sinh * along);
    for axis in 0..3 {
        let terms = x[axis].abs() + n[axis] * shared;
        let error = reference[axis + 1].error(got.x[axis]).abs();
        worst = worst.max(if error == 0.0 { 0.0 } else { error / terms });
    }
    or_infinite(Some(worst / (EPS * (1.0 + phi))))
}

/// Corners, origin, direction → side (1 hit, −1 behind the origin, 0 none), s, u, v, Δ: the largest error
/// over eps κ.
pub(super) fn hit(inputs: &[f64], reference: &[Fine]) -> f64 {
    let corners = [0, 3, 6].map(|at| vector(&inputs[at..]));
    let (origin, direction) = (vector(&inputs[9..]), vector(&inputs[12..]));
    let bvh = Bvh::build(vec![corners], |_| Facing::TwoSided);
    let ray = Ray {
        origin,
        direction,
        s_min: 0.0,
    };
    let found = bvh.closest(&ray, f64::INFINITY);
    let [side, s, u, v, delta] = [0, 1, 2, 3, 4].map(|i| reference[i]);
    if side.value == 0.0 {
        return found.map_or(0.0, |_| f64::INFINITY);
    }
    let norm = |v: DVec3| v.x.abs() + v.y.abs() + v.z.abs();
    let [e1, e2] = [1, 2].map(|i| norm(corners[i] - corners[0]));
    let (a, steepest) = (norm(corners[0] - origin), direction.abs().max_element());
    // The condition of s: the sizes of its terms over Δ.
    let kappa = (a + s.value.abs() * steepest) * (e1 * e2 / delta.value.abs());
    let error_of_s = s.error(found.map_or(0.0, |hit| hit.s)).abs() / (EPS * kappa);
    if side.value < 0.0 {
        // Behind the origin: no hit, unless s is lost in rounding.
        return found.map_or(0.0, |_| error_of_s);
    }
    let Some(hit) = found else {
        return error_of_s;
    };
    let length = e1 + e2;
    // The same for u and v.
    let kappa = (a + length) * (length * steepest / delta.value.abs());
    let weights = u.error(hit.u).abs().max(v.error(hit.v).abs());
    or_infinite(Some(error_of_s.max(weights / (EPS * kappa))))
}

/// Proper acceleration, and the apex of a light cone → where the hyperbola crosses it, from the origin, or
/// NaN: the error over eps of the largest coordinate.
pub(super) fn horizon(inputs: &[f64], reference: &[Fine]) -> f64 {
    let apex = Displacement::<World>::new(inputs[3], vector(&inputs[4..]));
    let line = WorldLine::hyperbolic(Velocity::REST, Event::ORIGIN, vector(inputs));
    let near = line.ok().and_then(|line| Some((line.state(0.0)?, line)));
    let Some((near, line)) = near else {
        return f64::INFINITY;
    };
    let crossing = line.on_past_light_cone(&near, apex);
    let Some(crossing) = crossing else {
        return if reference[0].value.is_nan() {
            0.0
        } else {
            f64::INFINITY
        };
    };
    let got = crossing.displacement;
    let size = |d: Displacement<World>| d.ct.abs().max(d.x.abs().max_element());
    let aside = [0, 1, 2].map(|i| reference[i + 1].error(got.x[i]).abs());
    let error = aside
        .into_iter()
        .fold(reference[0].error(got.ct).abs(), f64::max);
    or_infinite(Some(error / (EPS * size(apex).max(size(got)))))
}
