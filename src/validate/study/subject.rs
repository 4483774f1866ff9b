//! One thing that is measured: a method, and for the ray tracer what its visibility is worth.

use std::fmt;
use std::str::FromStr;

use crate::accel::Precision;
use crate::approximate::raster::Method;

/// A method with a precision of visibility; written like "trace", "trace:fast", "raster:uniform=0.05".
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Subject {
    /// How pictures are made.
    pub method: Method,
    /// What the ray tracer's hits are worth; certified for all other methods, whose hits are their own.
    pub precision: Precision,
}

impl Subject {
    /// What everything is compared with.
    pub const REFERENCE: Subject = Subject {
        method: Method::Trace,
        precision: Precision::Certified,
    };

    /// The ray tracer as it is for previews.
    pub const FAST: Subject = Subject {
        precision: Precision::Fast,
        ..Subject::REFERENCE
    };
}

impl FromStr for Subject {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "trace:fast" => Ok(Subject::FAST),
            _ => Ok(Subject {
                method: text.parse()?,
                ..Subject::REFERENCE
            }),
        }
    }
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.precision {
            Precision::Certified => self.method.fmt(f),
            Precision::Fast => write!(f, "{}:{}", self.method, self.precision.name()),
        }
    }
}
