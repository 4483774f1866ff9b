//! The number of points at which triangles are cut: limited by memory, with an estimate before the limit is reached.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;

use crate::error::{Error, Message, Setting};

/// The number of points at which triangles have been cut so far, in all batches.
#[derive(Debug)]
pub(super) struct Cuts {
    count: AtomicUsize,
    /// The limit; more are refused.
    most: usize,
}

impl Cuts {
    /// The limit, however much memory there is.
    const MOST: usize = 1 << 24;
    /// The number of cuts that are counted at once.
    pub const LOT: usize = 1 << 10;
    /// The maximum memory of one cut: the point, its two pieces, and the data for dividing them.
    pub const BYTES: u64 = 400;
    /// Triangles are refused without a trial only if the estimate exceeds the limit by this factor: estimates from few triangles are too
    /// large for those that are curved in only one place.
    const MARGIN: f64 = 8.0;
    /// From this fraction of the limit on, the estimate is repeated with smaller triangles.
    const UNCERTAIN: f64 = 0.25;
    /// The factor for estimates from [`Cuts::CLOSE`] triangles or more.
    const CLOSE_MARGIN: f64 = 1.1;
    /// From so many triangles, those of pictures near the limit are a few pixels of what they will be cut into.
    const CLOSE: usize = 1 << 18;

    /// None so far, limited to what fits in `memory` bytes.
    pub fn within(memory: u64) -> Self {
        Cuts {
            count: AtomicUsize::new(0),
            most: Cuts::most(memory),
        }
    }

    /// The number of cuts that fit in `memory` bytes.
    pub fn most(memory: u64) -> usize {
        (memory / Cuts::BYTES).min(Cuts::MOST as u64) as usize
    }

    /// Counts this many further cuts.
    pub fn add(&self, more: usize) {
        self.count.fetch_add(more, Ordering::Relaxed);
    }

    /// Whether the limit is exceeded. This never changes back, and no thread stops before it: the final result does not depend on threads.
    pub fn are_too_many(&self) -> bool {
        self.count.load(Ordering::Relaxed) > self.most
    }

    /// Evaluates the forecast that about this many further cuts will follow, estimated from this many triangles.
    pub fn outlook(&self, more: f64, triangles: usize) -> Outlook {
        let all = self.count.load(Ordering::Relaxed) as f64 + more;
        let most = self.most as f64;
        match triangles >= Cuts::CLOSE {
            // Nothing is divided any more, so there is nothing to wait for.
            _ if self.are_too_many() => Outlook::TooMany,
            _ if all > Cuts::MARGIN * most => Outlook::TooMany,
            true if all > Cuts::CLOSE_MARGIN * most => Outlook::TooMany,
            false if all > Cuts::UNCERTAIN * most => Outlook::Uncertain,
            _ => Outlook::Enough,
        }
    }

    /// The error for too many cuts.
    pub fn refusal(&self) -> Error {
        let help = match self.most {
            Cuts::MOST => "a longer edge, or more pixels of error".into(),
            _ => {
                Message::from("a longer edge, more pixels of error, or a higher ")
                    + Setting::MemoryLimit
            }
        };
        Error::unsupported(
            "rasterizer",
            Setting::Method,
            format!("triangles would be cut at more than {} points", self.most),
            help,
        )
    }
}

/// The result of a forecast.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Outlook {
    /// The estimate is within the limit, or close enough to try.
    Enough,
    /// The estimate must be repeated with smaller triangles.
    Uncertain,
    /// Over the limit.
    TooMany,
}

/// The approximate number of points at which a triangle is cut if its edges must be at most `length` long; 0 if it is not cut.
pub(super) fn cuts_of([a, b, c]: [DVec3; 3], length: f64) -> f64 {
    let parts = [b.distance(c), c.distance(a), a.distance(b)].map(|edge| edge / length);
    points(parts)
}

/// The approximate number of points at which a triangle is cut if its edges are cut into the given numbers of parts: there is one for every
/// two pieces (Euler), and pieces have edges of one part. Heron's formula gives their number; n²/2 points if all edges have n.
pub(super) fn points([a, b, c]: [f64; 3]) -> f64 {
    let half = 0.5 * (a + b + c);
    let square = half * (half - a) * (half - b) * (half - c);
    // Near 0 if only one edge is cut. False for NaN.
    match square > 0.0 {
        // The number of pieces is the area divided by √3/4, the area of a piece; there are half as many points.
        true => square.sqrt() * 2.0 / 3f64.sqrt(),
        false => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forecasts_end_once_there_are_too_many_cuts() {
        // However few cuts or triangles are left: none of them is divided any more.
        let cuts = Cuts::within(1000 * Cuts::BYTES);
        cuts.count.store(1000, Ordering::Relaxed);
        assert_eq!(cuts.outlook(0.0, 1), Outlook::Uncertain);
        cuts.count.store(1001, Ordering::Relaxed);
        assert_eq!(cuts.outlook(0.0, 1), Outlook::TooMany);
        assert_eq!(cuts.outlook(100.0, Cuts::CLOSE), Outlook::TooMany);
    }
}
