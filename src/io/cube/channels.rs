//! The channels of a cube, if its scene declares them: red, green and blue in any order, infrared and ultraviolet.
//!
//! Lookups handle grey cubes and cubes of red, green and blue. So one with more channels becomes several cubes of the same pixels and
//! times: its colours, and one of a single channel for each companion.

use std::fmt;
use std::str::FromStr;

use super::axes::Axes;
use super::samples::{Cube, CubeSamples};
use crate::colour::{INFRARED, ULTRAVIOLET};
use crate::error::{Error, Result};

/// What a channel of a cube holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CubeChannel {
    /// `R`.
    Red,
    /// `G`.
    Green,
    /// `B`.
    Blue,
    /// `IR`: from 830 to 3500 nm.
    Infrared,
    /// `UV`: from 100 to 360 nm.
    Ultraviolet,
}

impl CubeChannel {
    const ALL: [(CubeChannel, &'static str); 5] = [
        (CubeChannel::Red, "R"),
        (CubeChannel::Green, "G"),
        (CubeChannel::Blue, "B"),
        (CubeChannel::Infrared, "IR"),
        (CubeChannel::Ultraviolet, "UV"),
    ];

    /// Channels beside red, green and blue.
    pub const COMPANIONS: [CubeChannel; 2] = [CubeChannel::Infrared, CubeChannel::Ultraviolet];

    /// The wavelengths of a companion, metres; for colours, the whole visible range.
    pub fn band(self) -> [f64; 2] {
        match self {
            CubeChannel::Red | CubeChannel::Green | CubeChannel::Blue => {
                [ULTRAVIOLET[1], INFRARED[0]]
            }
            CubeChannel::Infrared => INFRARED,
            CubeChannel::Ultraviolet => ULTRAVIOLET,
        }
    }

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        let row = CubeChannel::ALL
            .iter()
            .find(|(channel, _)| *channel == self);
        row.map_or("", |(_, name)| name)
    }
}

/// The channels of a cube, in the order of its file: red, green and blue, and maybe companions.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Channels(Vec<CubeChannel>);

impl Channels {
    /// Channels of these names.
    ///
    /// # Errors
    /// An [`Error::Value`]: an unknown or repeated name, or a missing colour.
    pub fn named<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<Channels> {
        let refuse = |what: String| Err(Error::Value(what.into()));
        let mut channels = Vec::new();
        for name in names {
            let known = CubeChannel::ALL.iter().find(|(_, known)| *known == name);
            let Some((channel, _)) = known else {
                return refuse(format!("{name:?} is not the name of a channel"));
            };
            if channels.contains(channel) {
                return refuse(format!("the channel {name} is named twice"));
            }
            channels.push(*channel);
        }
        for (colour, name) in &CubeChannel::ALL[..3] {
            if !channels.contains(colour) {
                return refuse(format!("there is no channel {name}"));
            }
        }
        Ok(Channels(channels))
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// The names, in their order.
    pub fn names(&self) -> Vec<&'static str> {
        self.0.iter().map(|channel| channel.name()).collect()
    }

    /// Their names in layers of pictures, in order.
    pub(super) fn in_pictures(&self) -> Vec<&'static str> {
        let name = |channel: &CubeChannel| match channel {
            CubeChannel::Red => "radiance.R",
            CubeChannel::Green => "radiance.G",
            CubeChannel::Blue => "radiance.B",
            CubeChannel::Infrared | CubeChannel::Ultraviolet => channel.name(),
        };
        self.0.iter().map(name).collect()
    }

    /// Those beside red, green and blue.
    pub fn companions(&self) -> Vec<CubeChannel> {
        let all = CubeChannel::COMPANIONS.into_iter();
        all.filter(|channel| self.0.contains(channel)).collect()
    }

    /// The positions of red, green and blue.
    pub fn colours(&self) -> [usize; 3] {
        [CubeChannel::Red, CubeChannel::Green, CubeChannel::Blue]
            .map(|channel| self.place(channel).unwrap_or(0))
    }

    /// The position of a channel.
    pub fn place(&self, channel: CubeChannel) -> Option<usize> {
        self.0.iter().position(|own| *own == channel)
    }

    /// Checks that `count` channels of an array with these axes match the declaration, or without one can be grey or red, green and blue.
    ///
    /// # Errors
    /// What is wrong, and what would be right.
    pub(super) fn check(
        declared: Option<&Channels>,
        count: usize,
        axes: &Axes,
    ) -> Result<(), (String, String)> {
        match declared {
            None if matches!(count, 1 | 3) => Ok(()),
            None => Err((
                format!("{count} channels: the axes were taken for {axes}"),
                "a cube has 1 or 3 channels, or `channels` names them, like [\"R\", \"G\", \"B\", \"IR\", \"UV\"]".into(),
            )),
            Some(channels) if channels.count() == count => Ok(()),
            Some(channels) => Err((
                format!(
                    "{count} {}, and `channels` names {}: {channels}; the axes were taken for {axes}",
                    if count == 1 { "channel" } else { "channels" },
                    channels.count()
                ),
                "name each channel of the array once, in its order; and the axis of channels, C, in `axes`".into(),
            )),
        }
    }
}

impl FromStr for Channels {
    type Err = Error;

    /// From names with blanks or commas between them, like `R,G,B,IR,UV`.
    fn from_str(text: &str) -> Result<Channels> {
        let names = text.split([',', ' ']);
        Channels::named(names.filter(|name| !name.is_empty()))
    }
}

impl fmt::Display for Channels {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.names().join(", "))
    }
}

impl Cube {
    /// The same with these of its channels, in this order; zeros for channels that do not exist.
    pub fn taking(&self, channels: &[usize]) -> Cube {
        fn of<T: Copy + Default>(samples: &[T], each: usize, channels: &[usize]) -> Vec<T> {
            let mut taken = Vec::with_capacity(samples.len() / each.max(1) * channels.len());
            for bin in samples.chunks(each.max(1)) {
                taken.extend(
                    channels
                        .iter()
                        .map(|c| bin.get(*c).copied().unwrap_or_default()),
                );
            }
            taken
        }
        let [h, w, t, each] = self.shape;
        Cube {
            shape: [h, w, t, channels.len()],
            samples: match &self.samples {
                CubeSamples::F16(samples) => CubeSamples::F16(of(samples, each, channels)),
                CubeSamples::F32(samples) => CubeSamples::F32(of(samples, each, channels)),
                CubeSamples::F64(samples) => CubeSamples::F64(of(samples, each, channels)),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_are_named_once_and_hold_all_colours() {
        let all = Channels::named(["UV", "B", "G", "R", "IR"]).unwrap();
        assert_eq!(all.colours(), [3, 2, 1]);
        assert_eq!(all.companions(), CubeChannel::COMPANIONS);
        assert_eq!(all.to_string(), "UV, B, G, R, IR");
        for (names, wrong) in [
            (&["R", "G", "B", "B"][..], "B is named twice"),
            (&["R", "G", "IR"], "no channel B"),
            (&["r", "g", "b"], "\"r\" is not"),
            (&["R", "G", "B", "NIR"], "\"NIR\" is not"),
            (&[], "no channel R"),
        ] {
            let error = Channels::named(names.iter().copied());
            let error = error.unwrap_err().to_string();
            assert!(error.contains(wrong), "{names:?}: {error}");
        }
    }

    #[test]
    fn a_cube_of_five_channels_becomes_three_cubes() {
        // Sample (i, j, k, c) is 10 (its bin of all bins) + c.
        let samples = (0..2 * 3 * 4 * 5).map(|n| f64::from(n / 5 * 10 + n % 5));
        let cube = Cube::new([2, 3, 4, 5], CubeSamples::F64(samples.collect())).unwrap();
        let channels = Channels::named(["B", "IR", "R", "UV", "G"]).unwrap();
        let colours = cube.taking(&channels.colours());
        let companions = channels.companions().into_iter();
        let places = companions.map(|channel| channels.place(channel).unwrap());
        let companions: Vec<_> = places.map(|place| cube.taking(&[place])).collect();
        assert_eq!(colours.shape, [2, 3, 4, 3]);
        assert_eq!(companions.len(), 2);
        for bin in 0..24u32 {
            let first = 10.0 * f64::from(bin);
            for (c, place) in [2.0, 4.0, 0.0].into_iter().enumerate() {
                let sample = colours.samples.get(3 * bin as usize + c);
                assert_eq!(sample, Some(first + place));
            }
            for (companion, place) in companions.iter().zip([1.0, 3.0]) {
                assert_eq!(companion.shape, [2, 3, 4, 1]);
                assert_eq!(companion.samples.get(bin as usize), Some(first + place));
            }
        }
    }
}
