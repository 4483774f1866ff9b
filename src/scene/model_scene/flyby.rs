//! A camera that passes by.
//!
//! The camera passes C at the distance b. A point seen at the angle θ′ from its motion lies at θ, with sin θ = sin θ′/W, cos θ =
//! (cos θ′ − β)/(1 − β cos θ′), and has the wavelength ratio W = γ(1 − β cos θ′). C lies at θ when the camera is b cot θ before its closest
//! approach, at
//!
//! ```text
//! x = −b cot θ = b γ (β − cos θ′)/sin θ′.
//! ```
//!
//! The forward axis has W = 1, at cos θ′ = γβ/(γ + 1), between blueshift and redshift: slow cameras look across their motion, and fast ones
//! nearly ahead, where everything appears to be. In the first picture C is at θ = 40°, in the last one at the other edge of the picture, or
//! at W = 2.5, beyond which daylight is darker than a three-hundredth. Between them (x₂ − x₁)/(γβ) of the camera's proper time passes.

use glam::DVec3;

use super::framing::Framing;
use super::motion::Motion;
use super::subject::Ball;
use super::view::ModelView;

/// The direction of the model when a fly-by begins, degrees from the motion: a little beyond the picture's edge for a slow camera.
const FLYBY_EDGE: f64 = 40.0;
/// The distance of that direction from the middle of the picture, relative to half the picture.
const BEYOND: f64 = 50.0 / 45.0;
/// The distance of the fly-by, in radii.
const FLYBY_DISTANCE: f64 = 2.0;
/// The W at which a fly-by ends.
const FLYBY_REDDEST: f64 = 2.5;

/// A camera that passes by.
pub(super) fn passing(ball: &Ball, motion: Motion) -> Framing {
    let Motion { beta, gamma, n } = motion;
    // It passes in front; on the right if it comes from there or goes there.
    let side = |v: DVec3| v.reject_from_normalized(n);
    let front = side(DVec3::new(0.0, 0.25, 1.0));
    let across = match front.length() > 0.3 {
        true => front.normalize(),
        false => side(DVec3::new(1.0, 0.25, 0.0)).normalize(),
    };
    let distance = FLYBY_DISTANCE * ball.radius;
    // From θ = 40°, seen at tan θ′/2 = e^−φ tan θ/2.
    let edge = FLYBY_EDGE.to_radians();
    let shrinks = 1.0 / (gamma * (1.0 + beta));
    let first = 2.0 * libm::atan(shrinks * libm::tan(0.5 * edge));
    let middle = libm::acos(gamma * beta / (gamma + 1.0));
    let reddest = libm::acos(((1.0 - FLYBY_REDDEST / gamma) / beta).max(-1.0));
    let last = (2.0 * middle - first).min(reddest);
    let place = |seen: f64| {
        let (sin, cos) = libm::sincos(seen);
        distance * gamma * (beta - cos) / sin
    };
    let [from, to] = [first, last].map(place);
    let duration = (to - from) / (gamma * beta);
    let (sin, cos) = libm::sincos(middle);
    Framing {
        eye: ball.centre + across * distance + n * from,
        forward: n * cos - across * sin,
        fov: (2.0 * (middle - first) / BEYOND).to_degrees(),
        motion: Some(motion),
        interval: Some(duration / (ModelView::FLYBY_FRAMES - 1) as f64),
        times: None,
        reach: distance,
        ratios: [first, last].map(|seen| gamma * (1.0 - beta * libm::cos(seen))),
    }
}
