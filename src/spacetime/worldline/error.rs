//! Reasons why something is not a world line.

use crate::spacetime::MAX_RAPIDITY;

/// The maximum number of segments, knots or key events of one world line.
pub const MAX_ENTRIES: usize = 100_000;

/// The largest proper acceleration, 1/m. Beyond it the product of its square and that of a length exceeds f64's range.
pub const MAX_ACCELERATION: f64 = 1e100;

/// The largest speed between key events. 1 − |v|² is a difference of rounded numbers: nearer to the speed of light than this, γ would keep
/// fewer than four digits.
pub const MAX_KEYFRAME_SPEED: f64 = 1.0 - 5e-13;

/// Why something is not a valid world line. An `index` counts from 0, in the order of the given list; messages count from 1.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WorldLineError {
    /// A single value is NaN or infinite.
    #[error("{0} must be finite")]
    NotFinite(&'static str),
    /// A value of a list is NaN or infinite.
    #[error("entry {} of the world line must be finite", .index + 1)]
    EntryNotFinite {
        /// The index of the segment, knot or key event.
        index: usize,
    },
    /// Above [`MAX_ACCELERATION`].
    #[error("a proper acceleration of {acceleration} per metre is above {MAX_ACCELERATION:e}")]
    TooStrong {
        /// The index of the segment or knot; `None` if there is only one acceleration.
        index: Option<usize>,
        /// Its magnitude, 1/m.
        acceleration: f64,
    },
    /// Fewer than two entries.
    #[error("a world line needs at least two entries, but has {0}")]
    TooFew(usize),
    /// More than [`MAX_ENTRIES`].
    #[error("a world line has at most {MAX_ENTRIES} entries, but this one has {0}")]
    TooMany(usize),
    /// A segment whose duration is not above 0, or which is infinite although it is not the last.
    #[error("segment {} lasts {duration} m of proper time: it must be above 0, and finite unless it is the last", .index + 1)]
    Duration {
        /// The index of the segment.
        index: usize,
        /// Its duration, metres.
        duration: f64,
    },
    /// The time of an entry is not after that of the previous one.
    #[error("entry {} is at {time} m, which is not after {before} m, the time of the previous one", .index + 1)]
    NotAscending {
        /// The later entry in the list.
        index: usize,
        /// Its time, metres.
        time: f64,
        /// That of the entry before it, metres.
        before: f64,
    },
    /// Proper time 0, for which the state is given, is not within the profile.
    #[error(
        "the profile must include proper time 0, at which the velocity is given, but goes from {first} m to {last} m"
    )]
    ZeroOutside {
        /// Its first proper time, metres.
        first: f64,
        /// Its last proper time, metres.
        last: f64,
    },
    /// The acceleration would exceed [`MAX_RAPIDITY`].
    #[error(
        "the acceleration of stretch {} exceeds rapidity {MAX_RAPIDITY} near proper time {proper_time} m: make it weaker or shorter", .index + 1
    )]
    TooFast {
        /// The index of the segment, or of the knot at which the stretch of the profile begins.
        index: usize,
        /// Proper time near which this happens, metres.
        proper_time: f64,
    },
    /// The velocity changes too often to be followed.
    #[error(
        "the acceleration of stretch {} is too strong to be followed beyond proper time {proper_time} m: \
         make it weaker or shorter", .index + 1
    )]
    TooLong {
        /// The index of the knot at which the stretch begins.
        index: usize,
        /// Proper time reached, metres.
        proper_time: f64,
    },
    /// Between two key events the curve is as fast as light, or faster.
    #[error(
        "between events {} and {} the curve would reach {speed} times the speed of light, at world time {ct} m: \
         give it more time there, or less distance", .index + 1, .index + 2
    )]
    Superluminal {
        /// The index of the event at which the span begins.
        index: usize,
        /// World time at which the speed is largest, metres.
        ct: f64,
        /// The speed there, in units of the speed of light.
        speed: f64,
    },
    /// The axis of a circle is the zero vector.
    #[error("the axis of a circular motion is the zero vector")]
    NoAxis,
    /// The circle has no radius.
    #[error("the axis of a circular motion passes through the position itself, so nothing moves")]
    OnAxis,
    /// |ΩR| ≥ 1.
    #[error(
        "a circular motion at {speed} times the speed of light: |rate| × radius must be below 1"
    )]
    RimTooFast {
        /// |ΩR|.
        speed: f64,
    },
}

crate::error::value_errors!(WorldLineError);

impl WorldLineError {
    /// The index of the segment, knot or key event to point at, from 0; for a span, of its beginning.
    pub fn index(&self) -> Option<usize> {
        use WorldLineError::*;
        match *self {
            EntryNotFinite { index }
            | Duration { index, .. }
            | NotAscending { index, .. }
            | TooFast { index, .. }
            | TooLong { index, .. }
            | Superluminal { index, .. } => Some(index),
            TooStrong { index, .. } => index,
            NotFinite(_)
            | TooFew(_)
            | TooMany(_)
            | ZeroOutside { .. }
            | NoAxis
            | OnAxis
            | RimTooFast { .. } => None,
        }
    }
}

/// Refuses lists that are too short or too long.
pub(super) fn check_count(count: usize) -> Result<(), WorldLineError> {
    match count {
        0 | 1 => Err(WorldLineError::TooFew(count)),
        _ if count > MAX_ENTRIES => Err(WorldLineError::TooMany(count)),
        _ => Ok(()),
    }
}

/// Refuses times that are not ascending.
pub(super) fn check_ascending(times: impl Iterator<Item = f64>) -> Result<(), WorldLineError> {
    let mut before = f64::NEG_INFINITY;
    for (index, time) in times.enumerate() {
        if time <= before {
            return Err(WorldLineError::NotAscending {
                index,
                time,
                before,
            });
        }
        before = time;
    }
    Ok(())
}
