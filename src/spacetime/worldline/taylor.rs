//! Taylor series of motion with a proper acceleration that changes linearly with proper time.
//!
//! With the spatial part U = γβ of the four-velocity and the proper acceleration a in the boosted axes,
//!
//! ```text
//! U̇ = a + s V,   γ̇ = s,   s = U·a,   V = U D,   D = 1/(1 + γ),   Ḋ = −D² s,   ẋ = U,   ct˙ = γ.
//! ```
//!
//! If a is given in axes eᵢ that are carried along without rotation, these rotate relative to the boosted ones (Thomas),
//!
//! ```text
//! a = Σ aᵢ eᵢ,   ėᵢ = Ω × eᵢ,   Ω = a × V.
//! ```
//!
//! All right-hand sides are products, whose coefficients are sums of products of earlier ones. A step begins with |a| h ≤ 1 and is
//! shortened until the last two coefficients of U and of the axes are below rounding: the nearest singularities, those of D, are at |a| h =
//! π for constant a. γ² = 1 + U² is recomputed at each step.
//!
//! Sources: the Taylor-series method of recurrent power series, e.g. Jorba and Zou, Exp. Math. 14 (2005); Thomas precession ω = γ²/(γ + 1)
//! v̇ × v as in Jackson, Classical Electrodynamics, 11.8; Ω is the same per proper time.

use glam::{DVec3, DVec4};

/// The order of the series.
const ORDER: usize = 24;

/// The tolerance for the last coefficients, in units of γ: a hundredth of the rounding error of U.
const TOLERANCE: f64 = 1e-18;

/// One step of the motion.
pub(super) struct Step {
    /// Its length in proper time, with the sign of the requested length.
    pub length: f64,
    /// Coefficients c₁, c₂, … of (x, y, z, ct) in u = τ/length, from the step's beginning.
    pub coefficients: Vec<DVec4>,
    /// The change of U.
    pub gained: DVec3,
    /// The axes in which accelerations are given, at its end.
    pub axes: [DVec3; 3],
}

/// The series of U and γ.
struct Motion {
    u: [DVec3; ORDER + 1],
    gamma: [f64; ORDER + 1],
    /// Series of the axes, if they rotate.
    axes: [[DVec3; ORDER + 1]; 3],
}

/// The vector with components `a` along `axes`.
pub(super) fn combined(axes: [DVec3; 3], a: DVec3) -> DVec3 {
    let [x, y, z] = axes;
    x * a.x + y * a.y + z * a.z
}

/// A step from U = `start`, of at most this length, with proper acceleration `a` + `slope` τ, whose components refer to `axes`. These are
/// given in the boosted axes, and rotate relative to them if they are `carried` along.
pub(super) fn step(
    start: DVec3,
    (axes, carried): ([DVec3; 3], bool),
    a: DVec3,
    slope: DVec3,
    mut length: f64,
) -> Step {
    // |a| h ≤ 1 at both ends, and so in between, as a is linear.
    while length.abs() * a.length().max((a + slope * length).length()) > 1.0 {
        length *= 0.5;
    }
    let (a, slope) = (a * length, slope * (length * length));
    let mut motion = match carried {
        true => Motion::carried(start, axes, a, slope),
        false => Motion::new(start, axes, a, slope),
    };
    let factor = motion.shortening();
    motion.shorten(factor);
    length *= factor;
    Step {
        length,
        coefficients: motion.positions(length),
        // Small terms first.
        gained: (1..=ORDER).rev().map(|k| motion.u[k]).sum(),
        axes: motion.axes.map(|axis| axis.iter().rev().sum()),
    }
}

impl Motion {
    /// The series for proper acceleration `a` + `slope` u in the boosted axes.
    fn new(start: DVec3, axes: [DVec3; 3], a: DVec3, slope: DVec3) -> Self {
        let mut u = [DVec3::ZERO; ORDER + 1];
        let [mut gamma, mut d] = [[0.0; ORDER + 1]; 2];
        let mut v = [DVec3::ZERO; ORDER];
        let [mut s, mut sd] = [[0.0; ORDER]; 2];
        // Order 0: γ² = 1 + U².
        u[0] = start;
        gamma[0] = (1.0 + start.length_squared()).sqrt();
        d[0] = 1.0 / (1.0 + gamma[0]);
        for k in 0..ORDER {
            let next = (k + 1) as f64;
            // Coefficient k of s = U·a, V = U D and s D, from those of U and D so far.
            s[k] = u[k].dot(a) + if k > 0 { u[k - 1].dot(slope) } else { 0.0 };
            v[k] = (0..=k).map(|i| u[i] * d[k - i]).sum();
            sd[k] = (0..=k).map(|i| s[i] * d[k - i]).sum();
            // Coefficients k + 1 of U̇ = a + s V, γ̇ = s and Ḋ = −D (s D).
            let own = [a, slope].get(k).copied().unwrap_or(DVec3::ZERO);
            let gained: DVec3 = (0..=k).map(|i| v[k - i] * s[i]).sum();
            u[k + 1] = (own + gained) / next;
            gamma[k + 1] = s[k] / next;
            d[k + 1] = -(0..=k).map(|i| sd[i] * d[k - i]).sum::<f64>() / next;
        }
        let axes = axes.map(|axis| {
            let mut series = [DVec3::ZERO; ORDER + 1];
            series[0] = axis;
            series
        });
        Motion { u, gamma, axes }
    }

    /// The series for proper acceleration `a` + `slope` u in axes that are carried along and start as `axes`.
    fn carried(start: DVec3, axes: [DVec3; 3], a: DVec3, slope: DVec3) -> Self {
        let mut motion = Motion::new(start, axes, DVec3::ZERO, DVec3::ZERO);
        let Motion { u, gamma, axes } = &mut motion;
        let mut d = [0.0; ORDER + 1];
        let [mut own, mut v, mut turn] = [[DVec3::ZERO; ORDER]; 3];
        let [mut s, mut sd] = [[0.0; ORDER]; 2];
        d[0] = 1.0 / (1.0 + gamma[0]);
        for k in 0..ORDER {
            let next = (k + 1) as f64;
            // Coefficient k of a = Σ (aᵢ + slopeᵢ u) eᵢ, s = U·a, V = U D, s D and Ω = a × V.
            own[k] = combined(axes.map(|axis| axis[k]), a);
            if k > 0 {
                own[k] += combined(axes.map(|axis| axis[k - 1]), slope);
            }
            s[k] = (0..=k).map(|i| u[i].dot(own[k - i])).sum();
            v[k] = (0..=k).map(|i| u[i] * d[k - i]).sum();
            sd[k] = (0..=k).map(|i| s[i] * d[k - i]).sum();
            turn[k] = (0..=k).map(|i| own[i].cross(v[k - i])).sum();
            // Coefficients k + 1 of U̇ = a + s V, γ̇ = s, Ḋ = −D (s D) and ėᵢ = Ω × eᵢ.
            let gained: DVec3 = (0..=k).map(|i| v[k - i] * s[i]).sum();
            u[k + 1] = (own[k] + gained) / next;
            gamma[k + 1] = s[k] / next;
            d[k + 1] = -(0..=k).map(|i| sd[i] * d[k - i]).sum::<f64>() / next;
            for axis in axes.iter_mut() {
                let turned: DVec3 = (0..=k).map(|i| turn[i].cross(axis[k - i])).sum();
                axis[k + 1] = turned / next;
            }
        }
        motion
    }

    /// The factor on u for which the last coefficients are below rounding.
    fn shortening(&self) -> f64 {
        let factor = |k: usize| {
            let turned = self.axes.iter().map(|axis| axis[k].length());
            let size = turned.fold(self.u[k].length() / self.gamma[0], f64::max);
            // size · factorᵏ = `TOLERANCE`.
            libm::pow(TOLERANCE / size, 1.0 / k as f64)
        };
        factor(ORDER).min(factor(ORDER - 1)).min(1.0)
    }

    /// Replaces u by `factor` u.
    fn shorten(&mut self, factor: f64) {
        let mut power = 1.0;
        for k in 0..=ORDER {
            self.u[k] *= power;
            self.gamma[k] *= power;
            for axis in &mut self.axes {
                axis[k] *= power;
            }
            power *= factor;
        }
    }

    /// The series of (x, y, z, ct), without coefficients below rounding.
    fn positions(&self, length: f64) -> Vec<DVec4> {
        // ẋ = U and ct˙ = γ, integrated over τ = length · u.
        let own = |k: usize| self.u[k].extend(self.gamma[k]) * (length / (k + 1) as f64);
        let least = TOLERANCE * self.gamma[0] * length.abs();
        let count = (1..=ORDER)
            .rev()
            .find(|k| own(*k).abs().max_element() > least);
        (0..=count.unwrap_or(0)).map(own).collect()
    }
}
