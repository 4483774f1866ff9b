//! What a picture costs: counts and the time per stage.
//!
//! A [`Meter`] goes along with every batch. [`Unmetered`] does nothing and is compiled to nothing; [`Stats`]
//! reads the clock between stages, once per batch and not per ray. On many threads the times of all of them
//! are summed: time per stage is that of processors, not of the clock on the wall.

use std::time::{Duration, Instant};

use serde::Serialize;

use crate::accel::{Counts, NoTally, Tally};

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
    /// Bytes of time-resolved data that lookups in batches have read.
    TextureBytes,
}

/// Goes along with batches and notes what they cost.
pub trait Meter: Default + Send {
    /// Whether anything is noted.
    const ON: bool;
    /// Counts the work of rays.
    type Tally: Tally;
    /// The work of rays from the camera.
    fn visibility(&mut self) -> &mut Self::Tally;
    /// The work of rays that ask whether something stands between two events.
    fn occlusion(&mut self) -> &mut Self::Tally;
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
pub struct Unmetered(NoTally);

impl Meter for Unmetered {
    const ON: bool = false;
    type Tally = NoTally;
    #[inline(always)]
    fn visibility(&mut self) -> &mut NoTally {
        &mut self.0
    }
    #[inline(always)]
    fn occlusion(&mut self) -> &mut NoTally {
        &mut self.0
    }
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
    /// The work of rays from the camera, once per rest frame.
    pub visibility: Counts,
    /// The work of rays towards pulses and capture cameras.
    pub occlusion: Counts,
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
    type Tally = Counts;

    fn visibility(&mut self) -> &mut Counts {
        &mut self.visibility
    }

    fn occlusion(&mut self) -> &mut Counts {
        &mut self.occlusion
    }

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
            Counter::TextureBytes => &mut self.texture_bytes,
        };
        *sum += more;
    }

    fn merge(&mut self, other: Self) {
        self.rays += other.rays;
        self.hits += other.hits;
        self.visibility += other.visibility;
        self.occlusion += other.occlusion;
        self.texture_bytes += other.texture_bytes;
        for (sum, more) in self.seconds.iter_mut().zip(other.seconds) {
            *sum += more;
        }
    }
}
