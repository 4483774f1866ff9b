//! Whether two pictures belong together.
//!
//! Channels are matched by name: those that both pictures have are compared, those of only one picture are listed, and requested channels
//! must exist. Pictures that cannot be compared are refused with a message of what would be right; other things worth knowing become notes.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::options::{CompareOptions, NotFinite, Region};
use super::picture::{Alpha, Encoding, Picture, Plane, is_auxiliary, is_identity, is_light};
use super::points::{OBJECT_POINT, Points, WORLD_POINT};
use crate::error::{Error, Message, Result, Setting};
use crate::io::image::{Channel, Layers, Samples};
use crate::render::aov::Aov;

/// Metadata that must agree, and what they describe.
const SAME: [(&str, &str); 4] = [
    ("radiance_quantity", "quantities of light"),
    ("units", "units"),
    ("white", "radiances of white"),
    ("logarithmic", "radiances of black and white"),
];
/// Metadata that describe the shot.
const SHOT: [&str; 10] = [
    "camera_clock_zero_event",
    "camera_rapidity",
    "camera_time",
    "camera_shot_event",
    "camera_shot_rapidity",
    "camera_right",
    "camera_up",
    "camera_forward",
    "camera_horizontal_fov_rad",
    "medium_index",
];

/// More of them, which are omitted where there is no such thing: a single pinhole in front of a plane, without acceleration, sensor and
/// shutter, has none.
const NOT_PLAIN: [&str; 16] = [
    "camera_projection",
    "camera_interpupillary_distance",
    "camera_motion",
    "camera_proper_acceleration_per_m",
    "camera_circle_centre",
    "camera_circle_axis",
    "camera_circle_rate_rad_per_m",
    "sensor_focal_length",
    "sensor_size",
    "sensor_assembly",
    "rotation_axis",
    "rotation_rate_rad_per_m",
    "rotation_through",
    "rotation_elements",
    "shutter_duration",
    "shutter_records",
];

/// Channels that only one of the pictures has, and that are not compared.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
#[non_exhaustive]
pub struct Uncompared {
    /// Channels that the candidate lacks.
    pub only_reference: Vec<String>,
    /// Channels that the reference lacks.
    pub only_candidate: Vec<String>,
}

impl Uncompared {
    /// The channels of the light that one picture lacks, if any.
    pub(super) fn of_light(&self) -> Option<Message> {
        let lacks = |names: &[String], who: &str| {
            let lost = names.iter().map(String::as_str);
            let lost: Vec<&str> = lost.filter(|name| is_light(name)).collect();
            (!lost.is_empty()).then(|| format!("the {who} lacks {} of the light", lost.join(", ")))
        };
        let lacks = lacks(&self.only_reference, "candidate")
            .or_else(|| lacks(&self.only_candidate, "reference"))?;
        Some(Message::from(lacks) + " (choose what to compare with " + Setting::Channels + ")")
    }
}

/// Two pictures that belong together.
#[derive(Debug)]
pub(super) struct Matched<'a> {
    reference: Cow<'a, Layers>,
    candidate: Cow<'a, Layers>,
    /// Channels that hold quantities, in the order of the reference.
    pub names: Vec<String>,
    pub uncompared: Uncompared,
    /// The pixels that are compared.
    pub region: Region,
    pub notes: Vec<Message>,
}

impl Matched<'_> {
    pub fn layers(&self) -> [&Layers; 2] {
        [&self.reference, &self.candidate]
    }
}

/// Matches the candidate's channels with the reference's, or returns why that fails.
pub(super) fn matched<'a>(
    reference: &'a Picture,
    candidate: &'a Picture,
    options: &CompareOptions,
) -> Result<Matched<'a>> {
    let pair = [reference, candidate];
    // First, whatever makes any comparison meaningless.
    check_sizes(pair)?;
    options
        .region
        .check(reference.layers.width, reference.layers.height)?;
    check_encodings(pair)?;
    check_order(pair, options)?;
    check_identities(pair)?;
    let mut notes = metadata(pair)?;
    notes.extend(unread(pair));
    notes.extend(no_hit(pair, options));
    // Then the channels: requested, present, and in both pictures.
    demanded(pair, &options.channels)?;
    let chosen = pair.map(|picture| chosen(picture, &options.channels));
    let chosen = alpha(pair, chosen, &mut notes)?;
    let (chosen, uncompared) = common(pair, chosen)?;
    notes.extend(depth(&uncompared));
    let names: Vec<String> = chosen[0]
        .iter()
        .filter(|channel| !is_identity(channel))
        .map(|channel| channel.name.clone())
        .collect();
    // A pixel without light in one picture counts in no channel.
    let mut region = options.region.clone();
    if options.not_finite == NotFinite::Ignore {
        region = usable(pair, &chosen, region, &mut notes)?;
    }
    // The pictures are copied only if samples must be replaced.
    let layers =
        |picture: &'a Picture, chosen: &[&Channel]| finite(picture, chosen, options, &mut notes);
    let [reference, candidate] = for_both(pair, &chosen, layers)?;
    Ok(Matched {
        reference,
        candidate,
        names,
        uncompared,
        region,
        notes,
    })
}

fn for_both<'a, T>(
    [r, c]: [&'a Picture; 2],
    chosen: &[Vec<&Channel>; 2],
    mut of: impl FnMut(&'a Picture, &[&Channel]) -> Result<T>,
) -> Result<[T; 2]> {
    Ok([of(r, &chosen[0])?, of(c, &chosen[1])?])
}

fn refuse<T>(
    candidate: &Picture,
    place: &str,
    what: impl Into<Message>,
    help: impl Into<Message>,
) -> Result<T> {
    Err(Error::invalid(&candidate.name, place, what, help))
}

fn check_sizes([r, c]: [&Picture; 2]) -> Result<()> {
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
        "render the candidate at the reference's size",
    )
}

fn check_encodings([r, c]: [&Picture; 2]) -> Result<()> {
    if r.encoding == c.encoding {
        return Ok(());
    }
    let of = |p: &Picture| match p.encoding {
        Encoding::Linear => "linear light",
        Encoding::Srgb => "sRGB codes for a display",
    };
    let what = format!("it holds {}; {} holds {}", of(c), r.name, of(r));
    let help = Message::from(
        "pictures of one colour space: two .exr or .npz, or two .png of one exposure; a .png that holds linear \
         values is read ",
    ) + Setting::AsLinear;
    refuse(c, "colour space", what, help)
}

fn check_order([r, c]: [&Picture; 2], options: &CompareOptions) -> Result<()> {
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
        Message::from("the reference comes first; ")
            + Setting::AllowSwapped
            + " compares them as they are given",
    )
}

/// Refuses identities that are not integers.
fn check_identities(pair: [&Picture; 2]) -> Result<()> {
    for picture in pair {
        let width = picture.layers.width as usize;
        for aov in [Aov::Object, Aov::Primitive] {
            let Some(plane) = Plane::aov(&picture.layers, aov) else {
                continue;
            };
            let is_part = |i: &usize| plane.at(*i).is_finite() && plane.at(*i).fract() != 0.0;
            if let Some(i) = (0..width * picture.layers.height as usize).find(is_part) {
                let what = format!(
                    "it holds {} at column {}, row {}, and indices are whole numbers",
                    plane.at(i),
                    i % width,
                    i / width
                );
                let place = format!("channel {}", aov.name());
                let help = "indices of one sample of each pixel: averaged indices are meaningless";
                return refuse(picture, &place, what, help);
            }
        }
    }
    Ok(())
}

/// Notes on arrays that are not channels, and on an only one that is taken for light.
fn unread(pair: [&Picture; 2]) -> Vec<Message> {
    let taken = pair.into_iter().filter_map(|picture| {
        let name = picture.taken_for_light.as_ref()?;
        let note = format!(
            "the only array of {}, \"{name}\", is taken for light",
            picture.name
        );
        Some(note.into())
    });
    let some = pair
        .into_iter()
        .filter(|picture| !picture.unread.is_empty());
    let unread = some.map(|picture| {
        let names: Vec<&str> = picture.unread.iter().map(String::as_str).collect();
        format!(
            "not read of {}, as they are not channels of a picture: {}",
            picture.name,
            list(&names)
        )
        .into()
    });
    unread.chain(taken).collect()
}

/// The fraction of the reference's pixels without a surface at which one number in a candidate must stand to mean no hit, and the fraction
/// of the other pixels at which it may stand.
const SAYS_NOTHING: f64 = 0.95;
const STANDS_ELSEWHERE: f64 = 0.05;

/// A note on a number that marks pixels without an object in the candidate, if it is not a known one.
fn no_hit([r, c]: [&Picture; 2], options: &CompareOptions) -> Option<Message> {
    let points = Points::pair([&r.layers, &c.layers]);
    let theirs = points[1].object?;
    let (mut empty, mut counts) = (0usize, BTreeMap::<i64, [usize; 2]>::new());
    let (mut full, mut known) = (0usize, BTreeSet::new());
    for i in options.region.pixels(points[0].size()) {
        let object = points[0].object_at(i)?;
        let id = match points[1].object_at(i)? {
            id if id < 0.0 => theirs.at(i),
            id => id,
        };
        let count = counts.entry(id as i64).or_default();
        match object < 0.0 {
            true => {
                empty += 1;
                count[0] += usize::from(!id.is_nan());
            }
            false => {
                full += 1;
                count[1] += usize::from(!id.is_nan());
                known.insert(object as i64);
            }
        }
    }
    let (id, [at_empty, at_full]) = counts
        .into_iter()
        .max_by_key(|(_, [at_empty, _])| *at_empty)?;
    let is_known = known.contains(&id) || id == -1 || id >= u32::MAX.into();
    let says_nothing = at_empty > 0 && at_empty as f64 >= SAYS_NOTHING * empty as f64;
    let is_object = at_full as f64 > STANDS_ELSEWHERE * full as f64;
    (says_nothing && !is_known && !is_object).then(|| {
        let place = format!("{id} marks no hit in {}: ", c.name);
        Message::from(place) + Setting::NoHit + format!(" {id} says so")
    })
}

/// A note on a channel `Z`, which may be a distance or a depth, where the reference has distances.
fn depth(uncompared: &Uncompared) -> Option<Message> {
    let has = |names: &[String], name: &str| names.iter().any(|n| n == name);
    let is_unread = has(&uncompared.only_reference, Aov::Distance.name())
        && has(&uncompared.only_candidate, "Z");
    let note = "the candidate's channel Z is not compared: in other programs it may be the depth along the axis; name it distance if it is the world's distance from the pinhole";
    is_unread.then(|| note.into())
}

/// Refuses contradictory metadata; returns notes on metadata of two different shots.
fn metadata([r, c]: [&Picture; 2]) -> Result<Vec<Message>> {
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
    // Pictures of different shots may be compared on purpose: a note, not an error.
    let mut notes = Vec::new();
    // A camera without a stated projection, motion or sensor is a plain one, provided that the picture has a camera.
    let has_camera = |p: &Picture| p.metadata("camera_forward").is_some();
    let is_plain_in_one = |key: &&str| {
        let there = [r, c].map(|p| p.metadata(key).is_some());
        NOT_PLAIN.contains(key) && there[0] != there[1] && [r, c].into_iter().all(has_camera)
    };
    let moved: Vec<&str> = (SHOT.into_iter().chain(NOT_PLAIN))
        .filter(|key| differs(key).is_some() || is_plain_in_one(key))
        .collect();
    if !moved.is_empty() {
        notes.push(format!("the shots differ in {}", moved.join(", ")).into());
    }
    if let Some((a, b)) = differs("equations") {
        notes.push(
            format!("the reference follows the equations \"{a}\", the candidate \"{b}\"").into(),
        );
    }
    // A reference that is worse than its candidate swaps the meaning of errors.
    let approximations = [r, c].map(Picture::approximation);
    if let Some(method) = approximations[0] {
        notes.push(format!("the reference is itself an approximation (method = {method})").into());
    }
    // FLIP has two variants, for displays and for light; the pair decides which is used.
    if [r, c].iter().any(|p| p.is_high_range())
        && [r, c].iter().any(|p| !p.is_high_range())
        && r.encoding == Encoding::Linear
    {
        notes.push("one picture is a .png of linear values, which is limited to 1: FLIP is that of high dynamic range".into());
    }
    let samples = |p: &Picture| {
        p.metadata("samples_per_pixel")
            .and_then(|n| n.parse::<u64>().ok())
    };
    if let (Some(a), Some(b), [None, None]) = (samples(r), samples(c), approximations)
        && a < b
    {
        notes.push(
            format!("the reference has fewer samples per pixel ({a}) than the candidate ({b})")
                .into(),
        );
    }
    // A mean of positions on two surfaces lies on neither.
    let mixed = |p: &&Picture| p.metadata("pixel_centers") == Some("false");
    let has = |aov: Aov| r.layers.channel(aov.name()).is_some();
    let has_places = [OBJECT_POINT, WORLD_POINT]
        .iter()
        .any(|point| has(point[0]));
    if has_places && [r, c].iter().any(mixed) {
        let note = "auxiliary channels are means over pixels, which mix surfaces at silhouettes: geometric errors are those of pictures of pixel centres (";
        notes.push(Message::from(note) + Setting::PixelCenters + ")");
    }
    Ok(notes)
}

/// The channels to compare.
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

/// Alpha that only one picture has: ignored if it is 1 everywhere, refused otherwise.
fn alpha<'a>(
    pair: [&Picture; 2],
    mut chosen: [Vec<&'a Channel>; 2],
    notes: &mut Vec<Message>,
) -> Result<[Vec<&'a Channel>; 2]> {
    let position = |channels: &[&Channel]| channels.iter().position(|c| c.name == "A");
    for (one, other) in [(0, 1), (1, 0)] {
        let (Some(at), None) = (position(&chosen[one]), position(&chosen[other])) else {
            continue;
        };
        // Opaque alpha does not change the light, so its absence does not matter.
        let alpha = Plane::new(&pair[one].layers, chosen[one][at]);
        if (0..chosen[one][at].samples.len()).all(|i| alpha.at(i) == 1.0) {
            notes.push(
                format!(
                    "{} has an alpha channel that is opaque everywhere; it is left out",
                    pair[one].name
                )
                .into(),
            );
            chosen[one].remove(at);
            continue;
        }
        let what = format!(
            "it has an alpha channel with transparent pixels, and {} has none",
            pair[other].name
        );
        // Whether light is multiplied by alpha depends on the format: the hint says which applies.
        let stored = match pair[one].alpha {
            Alpha::Premultiplied => {
                "light is compared as it is stored, which is premultiplied by alpha"
            }
            Alpha::Straight => {
                "colours of a .png are compared as they are stored, which is not multiplied by alpha"
            }
            Alpha::Unknown => "light is compared as it is stored",
        };
        let help = Message::from(stored)
            + ": compose both over the same background, or leave alpha out with "
            + Setting::RadianceAlone;
        return refuse(pair[one], "alpha", what, help);
    }
    Ok(chosen)
}

/// Refuses pictures without the requested channels.
fn demanded(pair: [&Picture; 2], names: &[String]) -> Result<()> {
    for name in names {
        let of_group = format!("{name}.");
        let is_meant =
            |channel: &&Channel| channel.name == *name || channel.name.starts_with(&of_group);
        let named = |picture: &Picture| -> Vec<String> {
            let channels = picture.layers.channels.iter().filter(is_meant);
            channels.map(|c| c.name.clone()).collect()
        };
        for (one, other) in [(0, 1), (1, 0)] {
            let (there, wanted) = (named(pair[one]), named(pair[other]));
            // Any channel of the group that the other picture has is needed here; if neither has one, the name itself.
            let lacks = wanted.iter().find(|name| !there.contains(name));
            let lacks = lacks.or((there.is_empty() && wanted.is_empty()).then_some(name));
            if let Some(lacks) = lacks {
                let what = Message::from(format!("there is no {lacks}, which "))
                    + Setting::Channels
                    + " demands";
                let help = format!("it holds {}", list(&names_of(pair[one])));
                return refuse(pair[one], "channels", what, help);
            }
        }
    }
    Ok(())
}

fn names_of(picture: &Picture) -> Vec<&str> {
    let channels = picture.layers.channels.iter();
    channels.map(|c| c.name.as_str()).collect()
}

/// The channels that both pictures have, and the names of the others.
fn common<'a>(
    [r, c]: [&Picture; 2],
    [mut a, mut b]: [Vec<&'a Channel>; 2],
) -> Result<([Vec<&'a Channel>; 2], Uncompared)> {
    let without = |a: &[&Channel], b: &[&Channel]| -> Vec<String> {
        let alone = a.iter().filter(|x| !b.iter().any(|y| y.name == x.name));
        alone.map(|x| x.name.clone()).collect()
    };
    let uncompared = Uncompared {
        only_reference: without(&a, &b),
        only_candidate: without(&b, &a),
    };
    a.retain(|x| b.iter().any(|y| y.name == x.name));
    b.retain(|x| a.iter().any(|y| y.name == x.name));
    if a.is_empty() {
        let what = format!(
            "it has no channel in common with {}, which holds {}",
            r.name,
            list(&names_of(r))
        );
        let help = format!(
            "give its channels these names; it holds {}",
            list(&names_of(c))
        );
        return refuse(c, "channels", what, help);
    }
    Ok(([a, b], uncompared))
}

fn list(names: &[&str]) -> String {
    const MOST: usize = 12;
    match names.len() {
        0 => "no channel".into(),
        n if n > MOST => format!("{} and {} more", names[..MOST].join(", "), n - MOST),
        _ => names.join(", "),
    }
}

/// The pixels of the region with finite light in both pictures.
fn usable(
    pair: [&Picture; 2],
    chosen: &[Vec<&Channel>; 2],
    region: Region,
    notes: &mut Vec<Message>,
) -> Result<Region> {
    let [width, height] = [pair[0].layers.width, pair[0].layers.height].map(|n| n as usize);
    // Auxiliary channels are NaN where nothing is hit; only light must be a number.
    let light = [0, 1].map(|k| {
        let light = chosen[k].iter().filter(|c| !is_auxiliary(&c.name));
        light.map(move |c| Plane::new(&pair[k].layers, c))
    });
    let planes: Vec<Plane> = light
        .into_iter()
        .flatten()
        .filter(|p| !p.is_finite())
        .collect();
    if planes.is_empty() {
        return Ok(region);
    }
    // One mask for both pictures and all channels, so that all metrics cover the same pixels.
    let mut mask = vec![false; width * height];
    let mut dropped = 0;
    for i in region.pixels([width, height]) {
        mask[i] = planes.iter().all(|plane| plane.at(i).is_finite());
        dropped += u64::from(!mask[i]);
    }
    if !mask.contains(&true) {
        let what = "no pixel has finite light".to_string();
        return refuse(
            pair[1],
            "pixels",
            what,
            Setting::CountNotFinite + " counts such samples as a value",
        );
    }
    if dropped > 0 {
        let words = match dropped {
            1 => "1 pixel does not count, in any channel: its".into(),
            n => format!("{n} pixels do not count, in any channel: their"),
        };
        notes.push((words + " light is not finite in one of the pictures").into());
    }
    let crop = None;
    Ok(Region {
        crop,
        mask: Some(mask),
    })
}

/// The layers, after handling samples of light that are not finite.
fn finite<'a>(
    picture: &'a Picture,
    chosen: &[&Channel],
    options: &CompareOptions,
    notes: &mut Vec<Message>,
) -> Result<Cow<'a, Layers>> {
    let mut layers = Cow::Borrowed(&picture.layers);
    for channel in chosen.iter().filter(|channel| !is_auxiliary(&channel.name)) {
        let Some(found) = Unusable::of(channel, &picture.layers, options) else {
            continue;
        };
        let treatment = match options.not_finite {
            NotFinite::Refuse => return Err(found.refusal(picture, channel)),
            NotFinite::Ignore => continue,
            NotFinite::CountAs(value) => {
                replace(layers.to_mut(), &channel.name, value);
                value
            }
        };
        notes.push(
            format!(
                "{} of {}: {}; they count as {treatment}",
                channel.name,
                picture.name,
                found.words()
            )
            .into(),
        );
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
    /// Column and row of the first one.
    first: [usize; 2],
}

impl Unusable {
    /// `None` if all samples of the region are finite.
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
        let kinds = kinds.join(" and ");
        match self.nan + self.infinite {
            1 => format!("{kinds} sample (at column {x}, row {y})"),
            _ => format!("{kinds} samples (the first at column {x}, row {y})"),
        }
    }

    fn refusal(&self, picture: &Picture, channel: &Channel) -> Error {
        let overflow = self.infinite > 0 && picture.half.contains(&channel.name);
        let what = match overflow {
            true => format!(
                "{}: the channel is stored in half precision, whose largest number is {}",
                self.words(),
                half::f16::MAX
            ),
            false => self.words(),
        };
        let help = match overflow {
            true => {
                Message::from("write the picture in single precision; ")
                    + Setting::IgnoreNotFinite
                    + " leaves the pixels out"
            }
            false => {
                Setting::IgnoreNotFinite
                    + " leaves the pixels out; "
                    + Setting::CountNotFinite
                    + " counts them as a value"
            }
        };
        Error::invalid(
            &picture.name,
            format!("channel {}", channel.name),
            what,
            help,
        )
    }
}
