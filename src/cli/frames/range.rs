//! The frames of a sequence, and their times.
//!
//! Frame k is taken at the camera time t₀ + k Δ, with a single multiplication, so that it does not depend on earlier frames: any part of a
//! sequence has the same frames as the whole, except for a measured white, which is common to all requested frames. For N frames per second
//! of the camera's clock the offset is (k / N) c. A range of times is half-open; a frame within 10⁻⁹ Δ of its end counts as at the end.

use std::ops::Range;

use nullray::Result;
use nullray::scene::model::{Motion, Scene};
use nullray::spacetime::units::Time;
use nullray::spacetime::{Event, Velocity, World};

use crate::cli::args::FrameArguments;
use crate::cli::failure::refused;
use crate::cli::values::MOST_FRAMES;

/// A frame this close to the end of the range counts as at the end, in intervals.
const AT_THE_END: f64 = 1e-9;

/// Frames this many times as far apart as the farthest object is away look like a mistake.
const FAR: f64 = 1000.0;

/// The frames of a sequence.
#[derive(Debug, Clone, PartialEq)]
pub struct Frames {
    /// Frame numbers.
    pub numbers: Range<u64>,
    /// The camera time of frame 0, metres.
    start: f64,
    pace: Pace,
}

/// The position and velocity of the camera in one picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shot {
    /// The pinhole's event.
    pub event: Event<World>,
    /// The camera's velocity in the world.
    pub velocity: Velocity,
}

impl Shot {
    /// The scene as seen here by a camera without acceleration.
    pub fn seen(self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        scene.camera.origin = self.event;
        scene.camera.velocity = self.velocity;
        scene.camera.motion = Motion::Inertial;
        scene.camera.time = 0.0;
        scene
    }

    /// The same at a later world time, metres.
    pub fn later(self, time: f64) -> Shot {
        Shot {
            event: Event::new(self.event.ct + time, self.event.x),
            ..self
        }
    }
}

/// The spacing of frames.
#[derive(Debug, Clone, PartialEq)]
enum Pace {
    /// Each frame is given.
    Shots(Vec<Shot>),
    /// A number of frames per second of camera time.
    Rate {
        per_second: f64,
        metres_per_second: f64,
    },
    /// The camera time between two frames, metres.
    Interval(f64),
}

impl Pace {
    fn interval(&self) -> f64 {
        match self {
            Pace::Rate {
                per_second,
                metres_per_second,
            } => metres_per_second / per_second,
            Pace::Interval(interval) => *interval,
            Pace::Shots(_) => 0.0,
        }
    }

    /// Camera time from frame 0 to frame `number`, metres; `None` if frames have no common clock.
    fn offset(&self, number: u64) -> Option<f64> {
        let number = number as f64;
        match self {
            Pace::Rate {
                per_second,
                metres_per_second,
            } => Some(number / per_second * metres_per_second),
            Pace::Interval(interval) => Some(number * interval),
            Pace::Shots(_) => None,
        }
    }
}

impl Frames {
    /// The requested frames; `None` for a single picture.
    ///
    /// # Errors
    /// Intervals that are missing or not above 0; ranges without a frame, or with too many.
    pub fn of(arguments: &FrameArguments, scene: &Scene) -> Result<Option<Frames>> {
        let metres = |time: Time| time.metres(scene.speed_of_light);
        let frames = match (&arguments.frames, arguments.from, arguments.to) {
            (Some(numbers), ..) => Frames {
                numbers: numbers.clone(),
                start: scene.camera.time,
                pace: pace(arguments, scene)?,
            },
            (None, Some(from), Some(to)) => {
                let pace = pace(arguments, scene)?;
                Self::between(metres(from), metres(to), pace)?
            }
            _ => return Ok(None),
        };
        Ok(Some(frames))
    }

    fn between(from: f64, to: f64, pace: Pace) -> Result<Frames> {
        let count = ((to - from) / pace.interval() - AT_THE_END).ceil();
        if count < 1.0 {
            return Err(not_after());
        }
        // Also true for an infinite count.
        if count > MOST_FRAMES as f64 {
            return Err(too_many(count));
        }
        Ok(Frames {
            numbers: 0..count as u64,
            start: from,
            pace,
        })
    }

    /// One frame for each shot.
    pub fn of_shots(shots: Vec<Shot>) -> Frames {
        Frames {
            numbers: 0..shots.len() as u64,
            start: 0.0,
            pace: Pace::Shots(shots),
        }
    }

    /// The given number of frames, from the first to the last camera time, metres.
    ///
    /// # Errors
    /// A last time that is not after the first.
    pub fn evenly([from, to]: [f64; 2], count: u32) -> Result<Frames> {
        if to <= from {
            return Err(not_after());
        }
        let steps = f64::from(count.saturating_sub(1).max(1));
        Ok(Frames {
            numbers: 0..count.into(),
            start: from,
            pace: Pace::Interval((to - from) / steps),
        })
    }

    /// The remark on frames of a rate that are so far apart that it looks like the speed of a film.
    pub fn far_apart(&self, scene: &Scene) -> Option<String> {
        let Pace::Rate { per_second, .. } = self.pace else {
            return None;
        };
        let origins = scene.objects.iter().map(|object| object.origin.x);
        let distances = origins.map(|x| x.distance(scene.camera.origin.x));
        let (farthest, interval) = (distances.fold(1.0, f64::max), self.pace.interval());
        (interval > FAR * farthest && self.numbers.end - self.numbers.start > 1).then(|| {
            format!(
                "frames are {interval:.3e} m of light path apart: --fps {per_second} is a rate of the camera's own clock; for the speed of \
                 a film give --play-fps, and for the time between frames --interval"
            )
        })
    }

    /// The camera time of a frame, metres; `None` if it is given by its shot.
    pub fn time(&self, number: u64) -> Option<f64> {
        Some(self.start + self.pace.offset(number)?)
    }

    /// The shot of a frame; `None` if it is given by its time.
    pub fn shot(&self, number: u64) -> Option<Shot> {
        match &self.pace {
            Pace::Shots(shots) => shots.get(usize::try_from(number).ok()?).copied(),
            _ => None,
        }
    }
}

fn pace(arguments: &FrameArguments, scene: &Scene) -> Result<Pace> {
    if let Some(per_second) = arguments.fps {
        return Ok(Pace::Rate {
            per_second,
            metres_per_second: scene.speed_of_light,
        });
    }
    let said = arguments.interval;
    let said = said.map(|time| time.metres(scene.speed_of_light));
    match said.or(scene.camera.frame_interval) {
        Some(interval) if interval > 0.0 => Ok(Pace::Interval(interval)),
        Some(_) => Err(refused(
            "--interval",
            "the time between frames is not above 0",
            "give a time like \"1 cm\" or \"40 ps\"",
        )),
        None => Err(refused(
            arguments.from.map_or("--frames", |_| "--from"),
            "the time between frames is not given",
            "give --interval TIME or --fps N, or camera.frame_interval in the scene",
        )),
    }
}

fn not_after() -> nullray::Error {
    let what = "it is not after --from, so there is no frame between them";
    refused("--to", what, "give a later time")
}

fn too_many(count: f64) -> nullray::Error {
    let what = format!("{count} frames are more than {MOST_FRAMES}");
    let help = "render a part of them, or give a longer --interval";
    refused("sequence", what, help)
}

#[cfg(test)]
mod tests;
