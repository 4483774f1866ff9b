//! The progress bar: only on a terminal, with rate and remaining time.

use std::fmt::Write;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use nullray::render::progress::Progress;

use super::console::harmless;
use super::interrupt;

/// Writes the number of `unit`s done per second, averaged over the whole time: the latest steps alone say nothing about pictures that take
/// milliseconds.
fn rate(unit: &'static str) -> impl Fn(&ProgressState, &mut dyn Write) + Clone + Send + Sync {
    // Fails only if `out` fails, and then the failure cannot be reported anyway.
    move |state, out| {
        let per_second = state.pos() as f64 / state.elapsed().as_secs_f64();
        let per_second = Some(per_second).filter(|rate| rate.is_finite());
        let _ = write!(out, "{:.1} M{unit}/s", per_second.unwrap_or(0.0) / 1e6);
    }
}

/// Writes the remaining time at that rate; nothing before there is a rate.
fn left(state: &ProgressState, out: &mut dyn Write) {
    let done = state.pos() as f64;
    let rest = state.len().unwrap_or(0) as f64 - done;
    let seconds = state.elapsed().as_secs_f64() * rest.max(0.0) / done;
    // A rate so small that the time exceeds `Duration` counts as no rate.
    if let Ok(time) = Duration::try_from_secs_f64(seconds) {
        let _ = write!(out, "{:#} left", HumanDuration(time));
    }
}

/// Shows finished rays on standard error, and passes Ctrl-C on.
pub struct Bar(ProgressBar);

impl Bar {
    /// A bar for `rays` rays; hidden if standard error is not a terminal, or if `quiet`.
    pub fn new(rays: u64, quiet: bool) -> Self {
        Bar::of(rays, "rays", quiet)
    }

    /// The same for written samples.
    pub fn samples(samples: u64, quiet: bool) -> Self {
        Bar::of(samples, "samples", quiet)
    }

    /// Reports written samples; returns whether to continue.
    pub fn reached(&self, samples: u64, of: u64) -> bool {
        self.0.set_length(of);
        self.0.set_position(samples);
        !interrupt::is_stopping()
    }

    fn of(count: u64, unit: &'static str, quiet: bool) -> Self {
        let visible = !quiet && std::io::stderr().is_terminal();
        let target = if visible {
            ProgressDrawTarget::stderr_with_hz(8)
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(count), target);
        if let Ok(style) =
            ProgressStyle::with_template("{prefix}{wide_bar} {percent:>3} %  {rate}  {left}")
        {
            bar.set_style(style.with_key("rate", rate(unit)).with_key("left", left));
        }
        Bar(bar)
    }

    /// The same, as a part of larger work that began at `since`: `rays` are already done.
    pub fn after(self, rays: u64, since: Instant) -> Self {
        self.0.set_position(rays);
        Bar(self.0.clone().with_elapsed(since.elapsed()))
    }

    /// The same, with the name of its subject in front.
    pub fn named(self, what: String) -> Self {
        self.0.set_prefix(harmless(&(what + "  ")).into_owned());
        self
    }

    /// Starts the measurement of the rate and the remaining time.
    pub fn start(&self) {
        self.0.reset_elapsed();
    }
}

/// Removes the bar, also if the work failed.
impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

impl Progress for Bar {
    fn rays_done(&self, rays: u64) {
        self.0.inc(rays);
    }

    fn is_cancelled(&self) -> bool {
        interrupt::is_stopping()
    }
}
