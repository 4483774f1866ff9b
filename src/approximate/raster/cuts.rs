//! The number of points at which triangles are cut: limited by memory, with an estimate before the limit is reached.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;

use crate::error::{Error, Message, Setting};

/// The number of points at which triangles have been cut so far, in all batches.
#[derive(Debug)]
pub(super) struct Cuts {
    count: AtomicUsize,
    /// More are refused.
    most: usize,
}

impl Cuts {
    /// The most that are kept, however much memory there is.
    const MOST: usize = 1 << 24;
    /// Number of cuts that are counted at once.
    pub const LOT: usize = 1 << 10;
    /// The memory of one, at most: the point, its two pieces, and the data for dividing them.
    pub const BYTES: u64 = 400;
    /// Triangles are refused untried only if the estimate exceeds the limit by this factor: estimates from few triangles overrate those
    /// that are curved in one place only.
    const MARGIN: f64 = 8.0;
    /// From this part of as many as may be on, smaller triangles are asked.
    const UNCERTAIN: f64 = 0.25;
    /// The same for forecasts from [`Cuts::CLOSE`] triangles.
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

    /// How many fit in `memory` bytes.
    pub fn most(memory: u64) -> usize {
        (memory / Cuts::BYTES).min(Cuts::MOST as u64) as usize
    }

    /// Counts this many more.
    pub fn add(&self, more: usize) {
        self.count.fetch_add(more, Ordering::Relaxed);
    }

    /// Whether the limit is exceeded. Once it is, it stays so; until then no thread stops for it: the final result does not depend on
    /// threads.
    pub fn are_too_many(&self) -> bool {
        self.count.load(Ordering::Relaxed) > self.most
    }

    /// Takes into account the forecast that about this many more cuts will follow, estimated from this many triangles.
    pub fn outlook(&self, more: f64, triangles: usize) -> Outlook {
        let all = self.count.load(Ordering::Relaxed) as f64 + more;
        let most = self.most as f64;
        match triangles >= Cuts::CLOSE {
            // Nothing is divided any more, and there is nothing to wait for.
            _ if self.are_too_many() => Outlook::TooMany,
            _ if all > Cuts::MARGIN * most => Outlook::TooMany,
            true if all > Cuts::CLOSE_MARGIN * most => Outlook::TooMany,
            false if all > Cuts::UNCERTAIN * most => Outlook::Uncertain,
            _ => Outlook::Enough,
        }
    }

    /// The error for too many.
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
    /// The estimate is within the limit, or division is tried.
    Enough,
    /// Smaller triangles decide.
    Uncertain,
    /// Over the limit.
    TooMany,
}

/// The approximate number of points at which a triangle is cut whose edges must be at most `length` long; 0 if it is not cut.
pub(super) fn cuts_of([a, b, c]: [DVec3; 3], length: f64) -> f64 {
    let parts = [b.distance(c), c.distance(a), a.distance(b)].map(|edge| edge / length);
    points(parts)
}

/// The approximate number of points at which a triangle is cut whose edges are cut into the given numbers of parts: there is one for
/// every two pieces (Euler), and pieces have edges of one part. Heron's formula gives their number; n²/2 points if all edges have n.
pub(super) fn points([a, b, c]: [f64; 3]) -> f64 {
    let half = 0.5 * (a + b + c);
    let square = half * (half - a) * (half - b) * (half - c);
    // No more than a little where one edge is cut alone. Not for NaN either.
    match square > 0.0 {
        // The area over √3/4, that of a piece, is the number of pieces; there are half as many points.
        true => square.sqrt() * 2.0 / 3f64.sqrt(),
        false => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forecasts_end_once_there_are_too_many_cuts() {
        // However few are to come, and however few triangles are left: none of them is divided any more.
        let cuts = Cuts::within(1000 * Cuts::BYTES);
        cuts.count.store(1000, Ordering::Relaxed);
        assert_eq!(cuts.outlook(0.0, 1), Outlook::Uncertain);
        cuts.count.store(1001, Ordering::Relaxed);
        assert_eq!(cuts.outlook(0.0, 1), Outlook::TooMany);
        assert_eq!(cuts.outlook(100.0, Cuts::CLOSE), Outlook::TooMany);
    }
}
