//! The times of a cube that a command reads: those of its options, or else of its file.

use std::path::Path;

use nullray::Result;
use nullray::error::number;
use nullray::io::cube::{self, FileTimes};
use nullray::spacetime::SPEED_OF_LIGHT;
use nullray::spacetime::units::Time;

use super::console::warn;

/// The time axis of an input, metres, as far as known.
pub struct Times {
    pub start: Option<f64>,
    pub width: Option<f64>,
    pub at_sensor: bool,
    /// The name of its clock, if the file says it.
    pub clock: Option<String>,
    /// The refractive index of the medium in which its light travelled.
    pub medium_index: Option<f64>,
}

impl Times {
    /// Of the array `array` of `input`; with the start, the width of a bin and the index that options give. Warns where the file says
    /// otherwise.
    pub fn of(
        (input, array): (&Path, Option<&str>),
        [start, width]: [&Option<Time>; 2],
        index: Option<f64>,
        quiet: bool,
    ) -> Result<Times> {
        let recorded = cube::recorded(input, array)?;
        let metres = |time: &Option<Time>| time.as_ref().map(|time| time.metres(SPEED_OF_LIGHT));
        let (start, width, said) = (metres(start), metres(width), recorded.times);
        let times = Times {
            start: start.or(said.map(|said| said.start)),
            width: width.or(said.map(|said| said.width)),
            at_sensor: said.is_some_and(|said| said.at_sensor),
            // Only the file of such a capture knows where its sensor is.
            clock: match said {
                Some(FileTimes {
                    at_sensor: true, ..
                }) => Some("capture".into()),
                _ => recorded.clock,
            },
            medium_index: index.or(recorded.medium_index),
        };
        let mut warnings = Vec::new();
        let mut differs = |key: &str, [said, used]: [String; 2]| {
            let file = input.display();
            warnings.push(format!(
                "{file} says {key} = \"{said}\", but the options \"{used}\", which is used"
            ));
        };
        if let Some((said, (start, width))) = said.zip(times.start.zip(times.width)) {
            for (key, both) in said.differing(start, width) {
                differs(key, both.map(|time| format!("{} m", number(time))));
            }
        }
        match recorded.medium_index.zip(index) {
            Some((said, used)) if said != used => {
                differs("medium_index", [said, used].map(|n| number(n).to_string()));
            }
            _ => {}
        }
        warn(quiet, &warnings);
        Ok(times)
    }
}
