//! A camera that passes by.
//!
//! The camera passes C at the distance b. What it sees at the angle θ′ from its motion lies at θ, with
//! sin θ = sin θ′/W, cos θ = (cos θ′ − β)/(1 − β cos θ′), and has the wavelength ratio W = γ(1 − β cos θ′). C is at θ where the camera is
//! b cot θ before it, which it is at
//!
//! ```text
//! x = −b cot θ = b γ (β − cos θ′)/sin θ′.
//! ```
//!
//! The forward axis is where W = 1, at cos θ′ = γβ/(γ + 1), between blueshift and redshift: slow cameras look across their motion, and fast
//! ones nearly ahead, where everything appears to be. The first picture has C at θ = 40°, the last one at the other edge
//! of the picture, or at W = 2.5, beyond which daylight is darker than a three-hundredth. From the one to the other it takes (x₂ − x₁)/(γβ) of the camera's
//! own time.

use glam::DVec3;

use super::framing::Framing;
use super::motion::Motion;
use super::subject::Ball;
use super::view::ModelView;

/// Where the model is when a fly-by begins, degrees from the motion: a little beyond the edge of the picture of a slow camera.
const FLYBY_EDGE: f64 = 40.0;
/// How far beyond the edge that is, of half the picture.
const BEYOND: f64 = 50.0 / 45.0;
/// Distance of the fly-by, in radii.
const FLYBY_DISTANCE: f64 = 2.0;
/// W at which a fly-by ends.
const FLYBY_REDDEST: f64 = 2.5;

/// A camera that passes by.
pub(super) fn passing(ball: &Ball, motion: Motion) -> Framing {
    let Motion { beta, gamma, n } = motion;
    // It passes in front; to the right where it comes from there, or goes there.
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
