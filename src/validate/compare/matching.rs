//! Whether two pictures belong together.
//!
//! Channels are matched by name. What cannot be compared is refused with what would be right; what should be known
//! becomes a note.

use std::borrow::Cow;

use super::options::{CompareOptions, NotFinite};
use super::picture::{Encoding, Picture, Plane, is_auxiliary, is_identity};
use crate::error::{Error, Result};
use crate::io::image::{Channel, Layers, Samples};

/// Metadata that have to agree, and what they are.
const SAME: [(&str, &str); 3] = [
    ("radiance_quantity", "quantities of light"),
    ("units", "units"),
    ("white", "radiances of white"),
];
/// Metadata that describe the shot.
const SHOT: [&str; 10] = [
    "camera_clock_zero_event",
    "camera_rapidity",
    "camera_time",
    "camera_right",
    "camera_up",
    "camera_forward",
    "camera_horizontal_fov_rad",
    "camera_projection",
    "camera_interpupillary_distance",
    "medium_index",
];

/// Two pictures that belong together.
#[derive(Debug)]
pub(super) struct Matched<'a> {
    reference: Cow<'a, Layers>,
    candidate: Cow<'a, Layers>,
    /// Channels that hold quantities, in the order of the reference.
    pub names: Vec<String>,
    pub notes: Vec<String>,
}

impl Matched<'_> {
    pub fn layers(&self) -> [&Layers; 2] {
        [&self.reference, &self.candidate]
    }
}

/// Matches the candidate's channels with the reference's, or says why not.
pub(super) fn matched<'a>(
    reference: &'a Picture,
    candidate: &'a Picture,
    options: &CompareOptions,
) -> Result<Matched<'a>> {
    let pair = [reference, candidate];
    sizes(pair)?;
    options
        .region
        .check(reference.layers.width, reference.layers.height)?;
    encodings(pair)?;
    swapped(pair, options)?;
    let mut notes = metadata(pair)?;
    let chosen = pair.map(|picture| chosen(picture, &options.channels));
    let chosen = alpha(pair, chosen, &mut notes)?;
    channels(pair, &chosen, options)?;
    let names: Vec<String> = chosen[0]
        .iter()
        .filter(|channel| !is_identity(channel))
        .map(|channel| channel.name.clone())
        .collect();
    let layers =
        |picture: &'a Picture, chosen: &[&Channel]| finite(picture, chosen, options, &mut notes);
    let [reference, candidate] = two(pair, &chosen, layers)?;
    Ok(Matched {
        reference,
        candidate,
        names,
        notes,
    })
}

fn two<'a, T>(
    [r, c]: [&'a Picture; 2],
    chosen: &[Vec<&Channel>; 2],
    mut of: impl FnMut(&'a Picture, &[&Channel]) -> Result<T>,
) -> Result<[T; 2]> {
    Ok([of(r, &chosen[0])?, of(c, &chosen[1])?])
}

fn refuse<T>(candidate: &Picture, place: &str, what: String, help: impl Into<String>) -> Result<T> {
    Err(Error::invalid(&candidate.name, place, what, help))
}

fn sizes([r, c]: [&Picture; 2]) -> Result<()> {
    let [a, b] = [r, c].map(|p| [p.layers.width, p.layers.height]);
    if a == b {
        return Ok(());
    }
    let what = format!(
        "it has {} × {} pixels; {} has {} × {}",
        b[0], b[1], r.name, a[0], a[1]
    );
    refuse(
        c,
        "size",
        what,
        "pictures of one size: render the candidate at the reference's",
    )
}

fn encodings([r, c]: [&Picture; 2]) -> Result<()> {
    if r.encoding == c.encoding {
        return Ok(());
    }
    let of = |p: &Picture| match p.encoding {
        Encoding::Linear => "linear light",
        Encoding::Srgb => "sRGB codes for a display",
    };
    let what = format!("it holds {}; {} holds {}", of(c), r.name, of(r));
    let help = "pictures of one colour space: two .exr or .npz, or two .png of one exposure; a .png that holds linear \
                values is read with --transfer linear";
    refuse(c, "colour space", what, help)
}

fn swapped([r, c]: [&Picture; 2], options: &CompareOptions) -> Result<()> {
    let Some(method) = r.approximation() else {
        return Ok(());
    };
    if options.allow_swapped || !c.is_ray_traced() {
        return Ok(());
    }
    let what = format!(
        "the arguments look swapped: {} says that it is an approximation (method = {method}), and this one was ray-traced",
        r.name
    );
    refuse(
        c,
        "order",
        what,
        "the reference comes first; --allow-swapped compares them as they are given",
    )
}

/// Refuses metadata that contradict each other; notes on those that say that two shots are not the same.
fn metadata([r, c]: [&Picture; 2]) -> Result<Vec<String>> {
    let differs = |key: &str| {
        let (a, b) = (r.metadata(key)?, c.metadata(key)?);
        (a != b).then_some((a, b))
    };
    for (key, quantities) in SAME {
        if let Some((a, b)) = differs(key) {
            let what = format!("its {key} is {b}; that of {} is {a}", r.name);
            return refuse(
                c,
                "metadata",
                what,
                format!("pictures of equal {quantities}"),
            );
        }
    }
    let mut notes = Vec::new();
    let moved: Vec<&str> = SHOT
        .into_iter()
        .filter(|key| differs(key).is_some())
        .collect();
    if !moved.is_empty() {
        notes.push(format!("the shots differ in {}", moved.join(", ")));
    }
    if let Some((a, b)) = differs("equations") {
        notes.push(format!(
            "the reference follows the equations \"{a}\", the candidate \"{b}\""
        ));
    }
    let approximations = [r, c].map(Picture::approximation);
    if let Some(method) = approximations[0] {
        notes.push(format!(
            "the reference is itself an approximation (method = {method})"
        ));
    }
    let samples = |p: &Picture| {
        p.metadata("samples_per_pixel")
            .and_then(|n| n.parse::<u64>().ok())
    };
    if let (Some(a), Some(b), [None, None]) = (samples(r), samples(c), approximations)
        && a < b
    {
        notes.push(format!(
            "the reference has fewer samples per pixel ({a}) than the candidate ({b})"
        ));
    }
    let mixed = |p: &&Picture| p.metadata("pixel_centers") == Some("false");
    let has_places = r
        .layers
        .channels
        .iter()
        .any(|c| c.name == "event.x" || c.name == "object_event.x");
    if has_places && [r, c].iter().any(mixed) {
        notes.push("auxiliary channels are means over pixels, which mix surfaces at silhouettes: geometric errors are those of pictures of pixel centres (--pixel-centers)".into());
    }
    Ok(notes)
}

/// The channels that are to be compared.
fn chosen<'a>(picture: &'a Picture, names: &[String]) -> Vec<&'a Channel> {
    let is_named = |channel: &&Channel| {
        let group = channel.name.split('.').next().unwrap_or("");
        names.is_empty()
            || names
                .iter()
                .any(|name| *name == channel.name || name == group)
    };
    picture.layers.channels.iter().filter(is_named).collect()
}

/// Alpha that one picture has alone: left out where it is 1 everywhere, otherwise refused.
fn alpha<'a>(
    pair: [&Picture; 2],
    mut chosen: [Vec<&'a Channel>; 2],
    notes: &mut Vec<String>,
) -> Result<[Vec<&'a Channel>; 2]> {
    let position = |channels: &[&Channel]| channels.iter().position(|c| c.name == "A");
    for (one, other) in [(0, 1), (1, 0)] {
        let (Some(at), None) = (position(&chosen[one]), position(&chosen[other])) else {
            continue;
        };
        let alpha = Plane::new(&pair[one].layers, chosen[one][at]);
        if (0..chosen[one][at].samples.len()).all(|i| alpha.at(i) == 1.0) {
            notes.push(format!(
                "{} has an alpha channel that is opaque everywhere; it is left out",
                pair[one].name
            ));
            chosen[one].remove(at);
            continue;
        }
        let what = format!(
            "it has an alpha channel with transparent pixels, and {} has none",
            pair[other].name
        );
        let help = "light is compared as it is stored, which is premultiplied by alpha: compose both over the same \
                    background, or leave alpha out with --channels radiance";
        return refuse(pair[one], "alpha", what, help);
    }
    Ok(chosen)
}

fn channels(
    [r, c]: [&Picture; 2],
    [a, b]: &[Vec<&Channel>; 2],
    options: &CompareOptions,
) -> Result<()> {
    for name in &options.channels {
        let has = |channels: &[&Channel]| {
            channels
                .iter()
                .any(|c| c.name == *name || c.name.starts_with(&format!("{name}.")))
        };
        if let Some(picture) = [(r, a), (c, b)]
            .iter()
            .find(|(_, channels)| !has(channels))
            .map(|x| x.0)
        {
            let names: Vec<_> = picture
                .layers
                .channels
                .iter()
                .map(|c| c.name.as_str())
                .collect();
            return refuse(
                picture,
                "channels",
                format!("there is no {name}"),
                format!("it holds {}", list(&names)),
            );
        }
    }
    let without = |a: &[&Channel], b: &[&Channel]| -> Vec<String> {
        let missing = a.iter().filter(|x| !b.iter().any(|y| y.name == x.name));
        missing.map(|x| x.name.clone()).collect()
    };
    let (missing, added) = (without(a, b), without(b, a));
    if a.is_empty() || !missing.is_empty() || !added.is_empty() {
        let parts = [("lacks", &missing), ("has also", &added)];
        let parts: Vec<String> = (parts.iter().filter(|(_, names)| !names.is_empty()))
            .map(|(verb, names)| {
                format!(
                    "{verb} {}",
                    list(&names.iter().map(String::as_str).collect::<Vec<_>>())
                )
            })
            .collect();
        let what = format!(
            "its channels are not those of {}: it {}",
            r.name,
            parts.join(", and ")
        );
        let common: Vec<&str> = a
            .iter()
            .filter(|x| b.iter().any(|y| y.name == x.name))
            .map(|x| x.name.as_str())
            .collect();
        let help = match common.as_slice() {
            [] => "pictures with channels of the same names".into(),
            common => format!("compare what both have: --channels {}", groups(common)),
        };
        return refuse(c, "channels", what, help);
    }
    Ok(())
}

fn list(names: &[&str]) -> String {
    const MOST: usize = 12;
    match names.len() {
        0 => "no channel".into(),
        n if n > MOST => format!("{} and {} more", names[..MOST].join(", "), n - MOST),
        _ => names.join(", "),
    }
}

/// Channels by their groups, for the option.
fn groups(names: &[&str]) -> String {
    let mut groups: Vec<&str> = names
        .iter()
        .map(|name| name.split('.').next().unwrap_or(name))
        .collect();
    groups.dedup();
    groups.join(",")
}

/// The layers, with samples of light that are not finite dealt with.
fn finite<'a>(
    picture: &'a Picture,
    chosen: &[&Channel],
    options: &CompareOptions,
    notes: &mut Vec<String>,
) -> Result<Cow<'a, Layers>> {
    let mut layers = Cow::Borrowed(&picture.layers);
    for channel in chosen.iter().filter(|channel| !is_auxiliary(&channel.name)) {
        let Some(found) = Unusable::of(channel, &picture.layers, options) else {
            continue;
        };
        let treatment = match options.not_finite {
            NotFinite::Refuse => return Err(found.refusal(picture, channel)),
            NotFinite::Ignore => "their pixels do not count".into(),
            NotFinite::CountAs(value) => {
                replace(layers.to_mut(), &channel.name, value);
                format!("they count as {value}")
            }
        };
        notes.push(format!(
            "{} of {}: {}; {treatment}",
            channel.name,
            picture.name,
            found.words()
        ));
    }
    Ok(layers)
}

fn replace(layers: &mut Layers, name: &str, value: f64) {
    let channel = layers.channels.iter_mut().find(|c| c.name == name);
    match channel.map(|channel| &mut channel.samples) {
        Some(Samples::F32(v)) => {
            let unusable = v.iter_mut().filter(|x| !x.is_finite());
            unusable.for_each(|x| *x = value as f32);
        }
        Some(Samples::F64(v)) => {
            let unusable = v.iter_mut().filter(|x| !x.is_finite());
            unusable.for_each(|x| *x = value);
        }
        Some(Samples::U32(_) | Samples::I32(_)) | None => {}
    }
}

/// Samples that are not finite.
struct Unusable {
    nan: u64,
    infinite: u64,
    /// Column and row of the first.
    first: [usize; 2],
}

impl Unusable {
    /// None where all samples of the region are finite.
    fn of(channel: &Channel, layers: &Layers, options: &CompareOptions) -> Option<Unusable> {
        let plane = Plane::new(layers, channel);
        if plane.is_finite() {
            return None;
        }
        let size = [layers.width, layers.height].map(|n| n as usize);
        let pixels = options.region.pixels(size);
        let unusable: Vec<usize> = pixels.filter(|i| !plane.at(*i).is_finite()).collect();
        let first = *unusable.first()?;
        let nan = unusable.iter().filter(|i| plane.at(**i).is_nan()).count();
        Some(Unusable {
            nan: nan as u64,
            infinite: (unusable.len() - nan) as u64,
            first: [first % size[0], first / size[0]],
        })
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
