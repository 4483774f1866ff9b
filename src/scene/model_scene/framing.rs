//! The camera that has a whole model in view.
//!
//! At rest it looks from a fixed side at the centre C of the model's bounding box. A moving camera that takes a still looks from the nearest
//! side from which C has about its own colour: along the angle θ to the motion β n from C to the camera
//!
//! ```text
//! W = 1/(γ (1 − β cos θ)),   cos θ = (1 − 1/(γ W))/β.
//! ```
//!
//! A model at rest looks the same from an event at any time, so that
//! a moving camera at that event sees a vertex that lies in the direction l in the aberrated direction l′ = Λ l ([`Boost::direction`]).
//! Straight edges appear curved, so points along long edges are included. Of all points, those farthest from C in each small cone of directions
//! form the outline (a few thousand).
//!
//! The forward axis points at the middle of the outline's extent on the film; a few iterations find it, because each turn changes the extent.
//! The distance at which the outline fills the picture is found by bisection: the nearer the camera, the more it fills. What is ahead of a fast
//! camera appears small: to fill the picture, the camera would have to be so near that it sees the model from many sides at once, one part
//! blueshifted and another dark. The camera therefore stays where the model lies within a cone ([`WIDEST`]) and its wavelength ratios
//! within a factor ([`STILL_SPREAD`]), and narrows its field of view instead.

use std::fmt::Write;

use glam::DVec3;

use super::fronts::Show;
use super::motion::Motion;
use super::subject::{Ball, Subject};
use super::text::vector;
use super::view::{ModelView, VIEWPOINT};
use crate::spacetime::{Boost, CameraFrame, Direction, Quantity, World};

/// Horizontal field of view of a picture, degrees.
const FOV: f64 = 50.0;
/// How much of the picture, from its centre to its edges, the model fills along the axis on which it fills more.
pub(super) const FILLED: f64 = 0.88;
/// Iterations of the forward axis: each leaves about a fifth of the offset of the model's middle, and all of them 1e-5.
const TURNS: usize = 8;
/// Directions whose cosine with the forward axis is below this count as outside any picture.
const SIDEWAYS: f64 = 0.02;
/// Largest angular radius of the model's bounding sphere as seen at rest, degrees: the camera is not nearer than 1.74 r.
const WIDEST: f64 = 35.0;
/// Largest quotient of two wavelength ratios W of the model in a film of a flash, and in a still: colours from red to blue, with none
/// shifted out of sight and none bleached.
const SPREAD: f64 = 4.0;
const STILL_SPREAD: f64 = 2.2;
/// The least and the greatest W of the middle of a still.
const CENTRE: [f64; 2] = [0.9, 1.1];
/// Motion at a smaller angle to the line of sight, radians, is along it.
const STRAIGHT: f64 = 1e-3;
/// Beyond this W colours keep their hue.
const REDDEST: f64 = 5.0;

/// The camera of a scene.
pub(super) struct Framing {
    pub(super) eye: DVec3,
    pub(super) forward: DVec3,
    /// Degrees.
    pub(super) fov: f64,
    pub(super) motion: Option<Motion>,
    /// Camera time between the pictures of a sequence, metres.
    pub(super) interval: Option<f64>,
    /// The world time at which the camera is at `eye`, and its own time of the first picture after that, metres.
    pub(super) times: Option<[f64; 2]>,
    /// Distance from `eye` to `look_at`, metres.
    pub(super) reach: f64,
    /// The least and the greatest W of the model.
    pub(super) ratios: [f64; 2],
}

impl Framing {
    /// The scene's radiance quantity: hues are kept if the model would be shifted out of sight.
    pub(super) fn quantity(&self) -> Quantity {
        match self.ratios[1] > REDDEST {
            true => Quantity::Integrated,
            false => Quantity::Rgb,
        }
    }

    pub(super) fn write(&self, text: &mut String, size: [u32; 2]) -> std::fmt::Result {
        writeln!(text, "[camera]")?;
        writeln!(text, "eye = {}", vector(self.eye))?;
        let target = self.eye + self.forward * self.reach;
        writeln!(text, "look_at = {}", vector(target))?;
        let up = up_of(self.forward);
        if up != DVec3::Y {
            writeln!(text, "up = {}", vector(up))?;
        }
        // To twelve digits: the arc tangent of a tangent is the angle but for its last digits.
        let fov: f64 = format!("{:.11e}", self.fov).parse().unwrap_or(self.fov);
        writeln!(text, "hfov = \"{fov:?} deg\"")?;
        writeln!(text, "size = [{}, {}]", size[0], size[1])?;
        if let Some(Motion { beta, n, .. }) = self.motion {
            let direction = vector(n);
            writeln!(
                text,
                "velocity = {{ beta = {beta:?}, direction = {direction} }}"
            )?;
        }
        if let Some([zero, first]) = self.times {
            writeln!(text, "clock_zero = \"{zero:?} m\"")?;
            writeln!(text, "time = \"{first:?} m\"")?;
        }
        match self.interval {
            Some(interval) => writeln!(text, "frame_interval = \"{interval:?} m\""),
            None => Ok(()),
        }
    }
}

/// The part of a film of a flash, about its middle, in which all of the model is in view. Before and after it the model comes and goes: in
/// view from end to end, it would be small where a fast camera passes it.
const PASSING: f64 = 0.6;

/// A camera that has the whole model in view; with `show`, in the middle of a film of a flash.
pub(super) fn framing(
    subject: &Subject,
    motion: Option<Motion>,
    [width, height]: [u32; 2],
    show: Option<&Show>,
) -> Framing {
    // A film of a flash begins and ends elsewhere in any case.
    let (away, spread) = match show {
        Some(_) => (VIEWPOINT.normalize(), SPREAD),
        None => (viewpoint(motion.as_ref()), STILL_SPREAD),
    };
    let Ball { centre, radius } = subject.ball;
    let aspect = f64::from(width) / f64::from(height);
    // Half the extents of the film at the distance 1.
    let across = libm::tan(0.5 * FOV.to_radians());
    let film = [across, across / aspect];
    let boost = motion.as_ref().map(Motion::boost);
    let look = |alpha: f64| {
        let eye = centre + away * (radius / libm::sin(alpha));
        let span = show.map(|show| show.span(subject, eye, motion.as_ref()));
        let eyes = match (span, motion) {
            (Some(span), Some(Motion { beta, n, .. })) => {
                let ends = [span.first, span.last].map(|end| eye + n * (beta * PASSING * end));
                vec![eye, ends[0], ends[1]]
            }
            _ => vec![eye],
        };
        let look = Look::at(subject, &eyes, boost.as_ref(), film);
        (eye, look, span)
    };
    let widest = WIDEST.to_radians();
    let fits = |alpha: f64| {
        let is_fit = |look: Look| look.filled < FILLED && look.ratios[1] < spread * look.ratios[0];
        look(alpha).1.is_some_and(is_fit)
    };
    let alpha = bisect(widest, fits);
    // The bisection may end one last digit beyond the edge, where nothing may be in view at all.
    let (eye, look, span) = look(alpha * (1.0 - f64::EPSILON));
    let gamma = motion.map_or(1.0, |motion| motion.gamma);
    let Look {
        forward,
        filled,
        ratios,
    } = look.unwrap_or(Look {
        forward: -away,
        filled: FILLED,
        ratios: [1.0; 2],
    });
    // A narrower view where the camera would have to be too near to fill the picture.
    let tangent = across * (filled / FILLED).min(1.0);
    Framing {
        eye,
        forward,
        fov: 2.0 * libm::atan(tangent).to_degrees(),
        motion,
        interval: span
            .map(|span| (span.last - span.first) / gamma / (ModelView::FLYBY_FRAMES - 1) as f64),
        times: span.map(|span| [span.zero, span.first / gamma]),
        reach: eye.distance(centre),
        ratios,
    }
}

/// From the model to the camera of a still.
fn viewpoint(motion: Option<&Motion>) -> DVec3 {
    let away = VIEWPOINT.normalize();
    let Some(Motion { beta, gamma, n }) = motion else {
        return away;
    };
    let [least, most] = CENTRE.map(|w| (1.0 - 1.0 / (gamma * w)) / beta);
    let along = away.dot(*n).clamp(least.max(-1.0), most.min(1.0));
    let across = away.reject_from_normalized(*n);
    // Towards the model and away from it there is no other side.
    match across.length() < STRAIGHT {
        true => away,
        false => *n * along + across.normalize() * (1.0 - along * along).max(0.0).sqrt(),
    }
}

/// How a camera looks at a model so that it is in the middle of the picture.
#[derive(Debug, Clone, Copy)]
struct Look {
    forward: DVec3,
    /// The part of half the picture that the model fills, horizontally or vertically, whichever is more.
    filled: f64,
    /// The least and the greatest W of the model.
    ratios: [f64; 2],
}

impl Look {
    /// The look of a camera that is at all of `eyes` in turn, with a film of these half extents at distance 1; `None` if the model is seen too
    /// far to the side.
    fn at(
        subject: &Subject,
        eyes: &[DVec3],
        boost: Option<&Boost<CameraFrame, World>>,
        film: [f64; 2],
    ) -> Option<Look> {
        let seen = |point: DVec3, eye: DVec3| {
            let d = (point - eye).normalize();
            match boost {
                None => (d, 1.0),
                // The boost to the world has W where the one back has 1/W.
                Some(boost) => {
                    let (seen, inverse) = boost.direction(Direction::from_unit(d));
                    (seen.unit(), inverse.recip())
                }
            }
        };
        let from = |eye: &DVec3| {
            let eye = *eye;
            subject.outline.iter().map(move |p| seen(*p, eye))
        };
        let outline: Vec<(DVec3, f64)> = eyes.iter().flat_map(from).collect();
        let ratios = outline.iter().map(|(_, w)| *w);
        let ratios = ratios.fold([f64::INFINITY, 0.0], |[a, b]: [f64; 2], w| {
            [a.min(w), b.max(w)]
        });
        let middles = eyes.iter().map(|eye| seen(subject.ball.centre, *eye).0);
        let mut forward = middles.sum::<DVec3>().normalize();
        let mut filled = f64::INFINITY;
        for turn in 1..=TURNS {
            let right = forward.cross(up_of(forward)).normalize();
            let up = right.cross(forward);
            let mut least = [f64::INFINITY; 2];
            let mut most = [f64::NEG_INFINITY; 2];
            for (l, _) in &outline {
                let ahead = l.dot(forward);
                if ahead < SIDEWAYS {
                    return None;
                }
                for (k, axis) in [right, up].into_iter().enumerate() {
                    let place = l.dot(axis) / ahead;
                    least[k] = least[k].min(place);
                    most[k] = most[k].max(place);
                }
            }
            // The edge that is farther from the picture's centre; after some iterations both are equally far.
            let parts = [0, 1].map(|k| most[k].max(-least[k]) / film[k]);
            let before = std::mem::replace(&mut filled, parts[0].max(parts[1]));
            let [x, y] = [0, 1].map(|k| 0.5 * (least[k] + most[k]));
            if turn == TURNS || before - filled <= 1e-9 * filled {
                break;
            }
            forward = (forward + right * x + up * y).normalize();
        }
        Some(Look {
            forward,
            filled,
            ratios,
        })
    }
}

/// The up vector of a camera that looks along `forward`; +Y unless it looks almost straight up or down.
fn up_of(forward: DVec3) -> DVec3 {
    match forward.y.abs() > 0.99 {
        true => DVec3::new(0.0, 0.0, -forward.y.signum()),
        false => DVec3::Y,
    }
}

/// The largest number up to `most` for which `below` holds, as it does for all smaller ones.
fn bisect(most: f64, below: impl Fn(f64) -> bool) -> f64 {
    if below(most) {
        return most;
    }
    let (mut low, mut high) = (0.0, most);
    // A hundred halvings exhaust the digits of f64, for results as small as 1e-14, too.
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        match below(middle) {
            true => low = middle,
            false => high = middle,
        }
    }
    high
}
