//! What a picture costs: counts and the time per stage.
//!
//! A [`Meter`] accompanies every batch. If it is on, it reads the clock between stages, once per batch and not per ray. The times of all
//! threads are summed: a stage on two threads at once counts twice. Time in which the system runs other processes counts, too.

use std::time::{Duration, Instant};

use crate::accel::Counts;
use crate::io::cube::BytesRead;

/// The stages of a batch, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Samples in pixels, and the camera's rays through them.
    CameraRays,
    /// Directions and origins of rays into the rest frames.
    Boosts,
    /// The nearest hits.
    Visibility,
    /// Hits to surface points, and what they emit: texture coordinates, times, lookups, shadows.
    Radiance,
    /// Factors, colours, sums per pixel, auxiliary channels.
    Film,
}

impl Stage {
    /// All of them, in order.
    pub const ALL: [Stage; 5] = [
        Stage::CameraRays,
        Stage::Boosts,
        Stage::Visibility,
        Stage::Radiance,
        Stage::Film,
    ];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Stage::CameraRays => "camera rays",
            Stage::Boosts => "boosts",
            Stage::Visibility => "visibility",
            Stage::Radiance => "hits and lookups",
            Stage::Film => "film",
        }
    }
}

/// What is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Counter {
    /// Rays from the camera.
    Rays,
    /// Those that hit a surface.
    Hits,
    /// Bytes of time-resolved data that lookups in batches have read.
    TextureBytes,
}

/// Counts, and time per stage.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stats {
    /// Rays from the camera.
    pub rays: u64,
    /// Those that hit a surface.
    pub hits: u64,
    /// The work of rays from the camera, once per rest frame.
    pub visibility: Counts,
    /// The work of rays towards pulses and capture cameras.
    pub occlusion: Counts,
    /// Bytes of time-resolved data that were read.
    pub texture_bytes: u64,
    /// What of it was read from the disk meanwhile, where cubes are not loaded whole.
    pub disk: BytesRead,
    /// Time by [`Stage::ALL`], summed over threads, seconds.
    pub seconds: [f64; Stage::ALL.len()],
    last: Option<Instant>,
}

impl Stats {
    /// Time of all stages, summed over threads, seconds.
    pub fn total_seconds(&self) -> f64 {
        self.seconds.iter().sum()
    }

    /// Adds what another has noted.
    pub fn merge(&mut self, other: Self) {
        self.rays += other.rays;
        self.hits += other.hits;
        self.visibility += other.visibility;
        self.occlusion += other.occlusion;
        self.texture_bytes += other.texture_bytes;
        self.disk.all += other.disk.all;
        self.disk.again += other.disk.again;
        for (sum, more) in self.seconds.iter_mut().zip(other.seconds) {
            *sum += more;
        }
    }
}

/// Goes along with batches and notes what they cost, if it is on.
#[derive(Debug, Default)]
pub struct Meter(Option<Stats>);

impl Meter {
    /// Notes nothing.
    pub fn off() -> Self {
        Meter(None)
    }

    /// Notes everything if `on`.
    pub fn new(on: bool) -> Self {
        Meter(on.then(Stats::default))
    }

    /// What was noted.
    pub(crate) fn into_stats(self) -> Option<Stats> {
        self.0
    }

    /// Whether anything is noted.
    pub(super) fn is_on(&self) -> bool {
        self.0.is_some()
    }

    /// The work of rays from the camera.
    pub(super) fn visibility(&mut self) -> Option<&mut Counts> {
        self.0.as_mut().map(|stats| &mut stats.visibility)
    }

    /// The work of rays that ask whether something stands between two events.
    pub(super) fn occlusion(&mut self) -> Option<&mut Counts> {
        self.0.as_mut().map(|stats| &mut stats.occlusion)
    }

    /// A batch begins.
    pub(crate) fn start(&mut self) {
        if let Some(stats) = &mut self.0 {
            stats.last = Some(Instant::now());
        }
    }

    /// What was done since the last call, or the start, belongs to `stage`.
    #[inline]
    pub(crate) fn lap(&mut self, stage: Stage) {
        if let Some(stats) = &mut self.0 {
            let now = Instant::now();
            let since = stats.last.map_or(Duration::ZERO, |last| now - last);
            stats.seconds[stage as usize] += since.as_secs_f64();
            stats.last = Some(now);
        }
    }

    /// So many more.
    #[inline]
    pub(crate) fn count(&mut self, counter: Counter, more: u64) {
        if let Some(stats) = &mut self.0 {
            let sum = match counter {
                Counter::Rays => &mut stats.rays,
                Counter::Hits => &mut stats.hits,
                Counter::TextureBytes => &mut stats.texture_bytes,
            };
            *sum += more;
        }
    }
}
