//! What files say of the light in their cubes, beside its samples.

use std::path::Path;

use serde_json::{Map, Value};

use super::wanted::FileTimes;
use crate::io::npy;

/// What a file says of the light in a cube. All but the times are in the metadata of archives that nullray wrote.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct Recorded {
    /// The time axis.
    pub times: Option<FileTimes>,
    /// The name of its clock, as in scene files.
    pub clock: Option<String>,
    /// What the backs of surfaces show, as in scene files.
    pub backs: Option<String>,
    /// What its radiance measures, in words.
    pub quantity: Option<String>,
    /// The refractive index of the medium in which the light travelled.
    pub medium_index: Option<f64>,
}

/// The array in which nullray writes the light of a cube.
const LIGHT: &str = "radiance";

/// The keys of metadata.
const START: &str = "start";
const WIDTH: &str = "bin_width";
const CLOCK: &str = "clock";
const BACKS: &str = "backs";
const QUANTITY: &str = "radiance_quantity";
const INDEX: &str = "medium_index";

/// What the metadata of the archive at `path` say of a cube in it; `None` for other files. Metadata of pictures say nothing of cubes.
pub(super) fn of_archive(path: &Path, array: Option<&str>) -> Option<Recorded> {
    if array.is_some_and(|name| name != LIGHT) {
        return None;
    }
    let metadata = npy::load_metadata(path)?;
    let text = |key: &str| metadata.get(key).and_then(Value::as_str).map(str::to_owned);
    let times = times(&metadata);
    Some(Recorded {
        times,
        clock: text(CLOCK),
        backs: text(BACKS),
        // Pictures have these, too.
        quantity: times.and_then(|_| text(QUANTITY)),
        medium_index: times.and_then(|_| number(&metadata, INDEX)),
    })
}

fn times(metadata: &Map<String, Value>) -> Option<FileTimes> {
    let width = number(metadata, WIDTH).filter(|width| *width > 0.0)?;
    Some(FileTimes {
        start: number(metadata, START)?,
        width,
        at_sensor: false,
    })
}

fn number(metadata: &Map<String, Value>, key: &str) -> Option<f64> {
    let number: f64 = metadata.get(key)?.as_str()?.parse().ok()?;
    number.is_finite().then_some(number)
}

impl Recorded {
    /// The metadata that say the same.
    pub(super) fn metadata(&self) -> Vec<(String, String)> {
        let times = self.times.into_iter();
        let times = times.flat_map(|times| [(START, times.start), (WIDTH, times.width)]);
        let numbers = times.chain(self.medium_index.map(|index| (INDEX, index)));
        let numbers = numbers.map(|(key, value)| (key, value.to_string()));
        let texts = [
            (CLOCK, &self.clock),
            (QUANTITY, &self.quantity),
            (BACKS, &self.backs),
        ];
        let texts = texts.into_iter();
        let texts = texts.filter_map(|(key, text)| Some((key, text.clone()?)));
        let pairs = numbers.chain(texts);
        pairs.map(|(key, text)| (key.into(), text)).collect()
    }
}
