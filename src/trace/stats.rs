//! What a picture costs: counts and the time per stage.
//!
//! A [`Meter`] goes along with every batch. [`Unmetered`] does nothing and is compiled to nothing; [`Stats`]
//! reads the clock between stages, once per batch and not per ray. On many threads the times of all of them
//! are summed: time per stage is that of processors, not of the clock on the wall.

use std::time::{Duration, Instant};

use serde::Serialize;

/// The stages of a batch, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Samples in pixels, look directions in the world, departures.
    Looks,
    /// Rays and departures into the rest frames.
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
        Stage::Looks,
        Stage::Boosts,
        Stage::Visibility,
        Stage::Radiance,
        Stage::Film,
    ];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Looks => "look directions",
            Stage::Boosts => "boosts",
            Stage::Visibility => "visibility",
            Stage::Radiance => "hits and lookups",
            Stage::Film => "film",
        }
    }
}

/// What is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Counter {
    /// Rays from the camera.
    Rays,
    /// Those that met a surface.
    Hits,
    /// Rays that asked whether something stands between two events.
    Occlusion,
    /// Bytes of time-resolved data that lookups in batches have read.
    TextureBytes,
}

/// Goes along with batches and notes what they cost.
pub trait Meter: Default + Send {
    /// Whether anything is noted.
    const ON: bool;
    /// A batch begins.
    fn start(&mut self);
    /// What was done since the last call, or the start, belongs to `stage`.
    fn lap(&mut self, stage: Stage);
    /// So many more.
    fn count(&mut self, counter: Counter, more: u64);
    /// Takes over what another has noted.
    fn merge(&mut self, other: Self);
}

/// Notes nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unmetered;

impl Meter for Unmetered {
    const ON: bool = false;
    #[inline(always)]
    fn start(&mut self) {}
    #[inline(always)]
    fn lap(&mut self, _: Stage) {}
    #[inline(always)]
    fn count(&mut self, _: Counter, _: u64) {}
    #[inline(always)]
    fn merge(&mut self, _: Self) {}
}

/// Counts, and time per stage.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stats {
    /// Rays from the camera.
    pub rays: u64,
    /// Those that met a surface.
    pub hits: u64,
    /// Rays that asked whether something stands between two events: shadows, capture cameras.
    pub occlusion_rays: u64,
    /// Bytes of time-resolved data that were read.
    pub texture_bytes: u64,
    /// Processor time by [`Stage::ALL`], seconds.
    pub seconds: [f64; Stage::ALL.len()],
    last: Option<Instant>,
}

impl Stats {
    /// Processor time of all stages, seconds.
    pub fn total_seconds(&self) -> f64 {
        self.seconds.iter().sum()
    }
}

impl Meter for Stats {
    const ON: bool = true;

    fn start(&mut self) {
        self.last = Some(Instant::now());
    }

    fn lap(&mut self, stage: Stage) {
        let now = Instant::now();
        let since = self.last.map_or(Duration::ZERO, |last| now - last);
        self.seconds[stage as usize] += since.as_secs_f64();
        self.last = Some(now);
    }

    fn count(&mut self, counter: Counter, more: u64) {
        let sum = match counter {
            Counter::Rays => &mut self.rays,
            Counter::Hits => &mut self.hits,
            Counter::Occlusion => &mut self.occlusion_rays,
            Counter::TextureBytes => &mut self.texture_bytes,
        };
        *sum += more;
    }

    fn merge(&mut self, other: Self) {
        self.rays += other.rays;
        self.hits += other.hits;
        self.occlusion_rays += other.occlusion_rays;
        self.texture_bytes += other.texture_bytes;
        for (sum, more) in self.seconds.iter_mut().zip(other.seconds) {
            *sum += more;
        }
    }
}
