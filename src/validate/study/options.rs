//! What to study: methods, and for the ray tracer the precision of visibility.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use crate::accel::Precision;
use crate::approximate::raster::Method;
use crate::render::plan::Request;
use crate::scene::model::MOST_SAMPLES;

/// Options of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyOptions {
    /// The methods, in any order.
    pub methods: Vec<Subject>,
    /// Numbers of samples per pixel to measure every method with; ascending.
    pub samples: Vec<u32>,
    /// The largest number of pictures per method and number of samples. Default: 5.
    pub runs: u32,
    /// Time limit for the measurements, not counting the reference. What would exceed it is left out; everything that has been started
    /// has one run. Default: 60 s.
    pub budget: Duration,
    /// Samples per pixel of the reference. Default: 1024.
    pub reference_samples: u32,
    /// The memory limit for the scene, bytes. Default: 16 GiB.
    pub memory_limit: u64,
    /// Memory of the program itself within that, bytes. Default: 0.
    pub program: u64,
}

/// The default methods.
pub const METHODS: &str = "trace; trace:fast; raster:none; raster:uniform=0.2; raster:uniform=0.1; raster:uniform=0.05; \
                           raster:uniform=0.02; raster:adaptive=1; raster:adaptive=0.3; raster:adaptive=0.1; raster:adaptive=0.01; \
                           warp:cube=256; warp:cube=1024";

impl Default for StudyOptions {
    fn default() -> Self {
        StudyOptions {
            methods: parse_methods(METHODS).unwrap_or_default(),
            samples: vec![1, 4, 16, 64],
            runs: 5,
            budget: Duration::from_secs(60),
            reference_samples: 1024,
            memory_limit: Request::default().memory_limit,
            program: 0,
        }
    }
}

/// Methods, separated by semicolons or spaces.
///
/// # Errors
/// An unknown method or an empty list, in words.
pub fn parse_methods(text: &str) -> Result<Vec<Subject>, String> {
    let words = text
        .split([';', ' '])
        .map(str::trim)
        .filter(|w| !w.is_empty());
    let mut methods = Vec::new();
    for method in words.map(str::parse) {
        let method = method?;
        if !methods.contains(&method) {
            methods.push(method);
        }
    }
    match methods.is_empty() {
        true => Err("no method; give some, like \"trace; raster:uniform=0.05\"".into()),
        false => Ok(methods),
    }
}

/// Numbers of samples per pixel, separated by commas; ascending, each once.
///
/// # Errors
/// An invalid number of samples, in words.
pub fn parse_samples(text: &str) -> Result<Vec<u32>, String> {
    let number = |word: &str| {
        let number = word.trim().parse::<u32>().ok();
        number
            .filter(|n| (1..=MOST_SAMPLES).contains(n))
            .ok_or_else(|| {
                format!("\"{word}\": give numbers from 1 to {MOST_SAMPLES}, like 1,4,16")
            })
    };
    let mut samples = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
    samples.sort_unstable();
    samples.dedup();
    Ok(samples)
}

/// A method with a precision of visibility; written like "trace", "trace:fast", "raster:uniform=0.05".
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Subject {
    /// How pictures are made.
    pub method: Method,
    /// The precision of the ray tracer's hits; certified for all other methods, which have their own hits.
    pub precision: Precision,
}

impl Subject {
    /// The reference for all methods.
    pub const REFERENCE: Subject = Subject {
        method: Method::Trace,
        precision: Precision::Certified,
    };

    /// The ray tracer in single precision, for previews.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_methods_of_the_default_are_all_methods() {
        assert_eq!(
            StudyOptions::default().methods.len(),
            METHODS.split(';').count()
        );
    }

    #[test]
    fn lists_are_read_and_what_is_wrong_in_them_is_said() {
        assert_eq!(parse_methods("trace; trace raster:none").unwrap().len(), 2);
        assert!(parse_methods(" ; ").unwrap_err().contains("no method"));
        assert!(
            parse_methods("trace; rays")
                .unwrap_err()
                .contains("\"rays\"")
        );
        assert_eq!(parse_samples("16, 1,4,4").unwrap(), [1, 4, 16]);
        assert!(parse_samples("1,0").unwrap_err().contains("\"0\""));
        assert!(parse_samples("").is_err());
    }
}
