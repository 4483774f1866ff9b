//! Arrival times of the light of one flash, instead of the emission times of the picture's light.
//!
//! A flash at the event S lights a surface point x, at rest, at the world time ct_S + η|x − x_S|. That light arrives at a receiver y, at
//! rest, at ct_S + η|x − x_S| + η|y − x|. On a plane, lines of equal time are circles about the flash in the world's time, and sections
//! of ellipsoids with flash and receiver as foci in a camera's time.

use glam::DVec3;

use crate::render::aov::Aov;
use crate::render::film::Film;
use crate::scene::model::{FlashClock, FlashTimes};

/// The channels that this is computed from.
pub const NEEDED: [Aov; 3] = [Aov::EventX, Aov::EventY, Aov::EventZ];

/// The arrival time of the flash's light that reaches the point shown by each pixel, metres of ct; NaN if the pixel shows nothing. `film`
/// has one sample in each pixel, and the channels [`NEEDED`]; `index` is the medium's.
pub fn flash_times(film: &Film, times: &FlashTimes, index: f64) -> Vec<f64> {
    let [x, y, z] = NEEDED.map(|aov| film.aov(aov).unwrap_or_default());
    let points = x
        .iter()
        .zip(y)
        .zip(z)
        .map(|((x, y), z)| DVec3::new(*x, *y, *z));
    let FlashTimes { flash, clock } = times;
    let received = |point: DVec3| {
        let lit = flash.ct + index * (point - flash.x).length();
        match clock {
            FlashClock::World => lit,
            FlashClock::Camera(zero) => lit - zero.ct + index * (zero.x - point).length(),
            FlashClock::Capture(eye) => lit + index * (*eye - point).length(),
        }
    };
    points.map(received).collect()
}

/// The title of such a picture.
pub fn title(clock: FlashClock) -> &'static str {
    match clock {
        FlashClock::World => "Light of the flash: world time",
        FlashClock::Camera(_) => "Light of the flash: time of the camera",
        FlashClock::Capture(_) => "Light of the flash: time of the capture",
    }
}
