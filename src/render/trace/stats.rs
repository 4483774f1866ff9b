//! The cost of a picture: counts and the time per stage.
//!
//! A [`Meter`] accompanies every batch. If it is on, it reads the clock between stages, once per batch, not per ray. The times of all
//! threads are summed: a stage on two threads at once counts twice. Time during which the system runs other processes is included.

use std::time::{Duration, Instant};

use crate::accel::Counts;
use crate::io::cube::BytesRead;

/// The stages of a batch, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// Sample positions in pixels, and camera rays through them.
    CameraRays,
    /// Transformation of the rays' directions and origins to the rest frames.
    Boosts,
    /// Finding the nearest hits.
    Visibility,
    /// From hits to surface points and their radiance: texture coordinates, times, lookups, shadows.
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

/// Counted quantities.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Counter {
    /// Rays from the camera.
    Rays,
    /// Camera rays that hit a surface.
    Hits,
    /// Bytes of time-resolved data read by lookups in batches.
    TextureBytes,
}

/// Counts, and time per stage.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stats {
    /// Rays from the camera.
    pub rays: u64,
    /// Camera rays that hit a surface.
    pub hits: u64,
    /// Traversal work for camera rays, once per rest frame.
    pub visibility: Counts,
    /// Traversal work for rays towards pulses and capture cameras.
    pub occlusion: Counts,
    /// Bytes of time-resolved data that lookups read.
    pub texture_bytes: u64,
    /// The part of it that was read from disk in the meantime, if cubes are not loaded whole.
    pub disk: BytesRead,
    /// Time by stage, in the order of [`Stage::ALL`], summed over threads, seconds.
    pub seconds: [f64; Stage::ALL.len()],
    last: Option<Instant>,
}

impl Stats {
    /// Time of all stages, summed over threads, seconds.
    pub fn total_seconds(&self) -> f64 {
        self.seconds.iter().sum()
    }

    /// Adds the statistics of another meter.
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

/// Accompanies batches and records their cost, if it is on.
#[derive(Debug, Default)]
pub struct Meter(Option<Stats>);

impl Meter {
    /// A meter that records nothing.
    pub fn off() -> Self {
        Meter(None)
    }

    /// A meter that records everything if `on`.
    pub fn new(on: bool) -> Self {
        Meter(on.then(Stats::default))
    }

    /// The recorded statistics.
    pub(crate) fn into_stats(self) -> Option<Stats> {
        self.0
    }

    /// Whether the meter records anything.
    pub(super) fn is_on(&self) -> bool {
        self.0.is_some()
    }

    /// The traversal work of camera rays.
    pub(super) fn visibility(&mut self) -> Option<&mut Counts> {
        self.0.as_mut().map(|stats| &mut stats.visibility)
    }

    /// The traversal work of rays that test for obstacles between two events.
    pub(super) fn occlusion(&mut self) -> Option<&mut Counts> {
        self.0.as_mut().map(|stats| &mut stats.occlusion)
    }

    /// Starts a batch.
    pub(crate) fn start(&mut self) {
        if let Some(stats) = &mut self.0 {
            stats.last = Some(Instant::now());
        }
    }

    /// Attributes the time since the last call, or the start, to `stage`.
    #[inline]
    pub(crate) fn lap(&mut self, stage: Stage) {
        if let Some(stats) = &mut self.0 {
            let now = Instant::now();
            let since = stats.last.map_or(Duration::ZERO, |last| now - last);
            stats.seconds[stage as usize] += since.as_secs_f64();
            stats.last = Some(now);
        }
    }

    /// Adds `more` to a counter.
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
