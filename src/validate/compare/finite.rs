//! Light that is no finite number: refused, left out, or counted as a value.

use std::borrow::Cow;

use super::{NotFinite, Options, Picture, is_auxiliary};
use crate::error::{Error, Result};
use crate::io::image::{Channel, Layers, Samples};

/// The layers with samples that are no finite number dealt with.
pub(super) fn finite<'a>(
    picture: &'a Picture,
    chosen: &[&Channel],
    options: &Options,
    notes: &mut Vec<String>,
) -> Result<Cow<'a, Layers>> {
    let mut layers = Cow::Borrowed(&picture.layers);
    for channel in chosen.iter().filter(|channel| !is_auxiliary(&channel.name)) {
        let found = Unusable::of(channel, &picture.layers, options);
        if found.nan + found.infinite == 0 {
            continue;
        }
        match options.not_finite {
            NotFinite::Refuse => return Err(found.refusal(picture, channel)),
            NotFinite::Ignore => notes.push(format!(
                "{} of {}: {}; their pixels do not count",
                channel.name,
                picture.name,
                found.words()
            )),
            NotFinite::CountAs(value) => {
                notes.push(format!(
                    "{} of {}: {}; they count as {value}",
                    channel.name,
                    picture.name,
                    found.words()
                ));
                replace(layers.to_mut(), &channel.name, value);
            }
        }
    }
    Ok(layers)
}

fn replace(layers: &mut Layers, name: &str, value: f64) {
    let channel = layers
        .channels
        .iter_mut()
        .find(|channel| channel.name == name);
    match channel.map(|channel| &mut channel.samples) {
        Some(Samples::F32(v)) => v
            .iter_mut()
            .filter(|x| !x.is_finite())
            .for_each(|x| *x = value as f32),
        Some(Samples::F64(v)) => v
            .iter_mut()
            .filter(|x| !x.is_finite())
            .for_each(|x| *x = value),
        _ => {}
    }
}

/// Samples that are no finite numbers.
struct Unusable {
    nan: u64,
    infinite: u64,
    first: [usize; 2],
}

impl Unusable {
    fn of(channel: &Channel, layers: &Layers, options: &Options) -> Unusable {
        let mut found = Unusable {
            nan: 0,
            infinite: 0,
            first: [0; 2],
        };
        let width = layers.width as usize;
        for y in 0..layers.height as usize {
            let row = y * width..(y + 1) * width;
            if is_finite(&channel.samples, row.clone()) {
                continue;
            }
            let chosen = options.region.row(y, width);
            for (x, i) in row.enumerate().filter(|(x, _)| chosen[*x]) {
                let value = value(&channel.samples, i);
                if value.is_finite() {
                    continue;
                }
                if found.nan + found.infinite == 0 {
                    found.first = [x, y];
                }
                found.nan += u64::from(value.is_nan());
                found.infinite += u64::from(value.is_infinite());
            }
        }
        found
    }

    fn words(&self) -> String {
        let [x, y] = self.first;
        let kinds = [(self.nan, "NaN"), (self.infinite, "infinite")];
        let kinds: Vec<String> = (kinds.iter().filter(|(n, _)| *n > 0))
            .map(|(n, kind)| format!("{n} {kind}"))
            .collect();
        format!(
            "{} samples (the first at column {x}, row {y})",
            kinds.join(" and ")
        )
    }

    fn refusal(&self, picture: &Picture, channel: &Channel) -> Error {
        let overflow = self.infinite > 0 && picture.half.contains(&channel.name);
        let what = match overflow {
            true => format!(
                "{}: the channel is stored in half precision, which ends at 65504",
                self.words()
            ),
            false => self.words(),
        };
        let help = match overflow {
            true => "write the picture in single precision; --nan ignore leaves the pixels out",
            false => "--nan ignore leaves the pixels out; --nan count-as=0 counts them as a value",
        };
        Error::invalid(
            &picture.name,
            format!("channel {}", channel.name),
            what,
            help,
        )
    }
}

/// Whether all of these samples are finite numbers.
fn is_finite(samples: &Samples, span: std::ops::Range<usize>) -> bool {
    match samples {
        Samples::F32(v) => v[span].iter().all(|x| x.is_finite()),
        Samples::F64(v) => v[span].iter().all(|x| x.is_finite()),
        Samples::U32(_) | Samples::I32(_) => true,
    }
}

/// A sample as f64.
pub(super) fn value(samples: &Samples, index: usize) -> f64 {
    match samples {
        Samples::F32(v) => v[index].into(),
        Samples::F64(v) => v[index],
        Samples::U32(v) => v[index].into(),
        Samples::I32(v) => v[index].into(),
    }
}
