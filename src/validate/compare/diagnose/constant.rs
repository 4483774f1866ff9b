//! Channels that hold one number at every pixel although the reference's vary: channels that were never written.
//!
//! They are reported, and all other hypotheses are tested without them: zeros are explained equally well by mirrors, units, velocities and
//! any other mistake. Cases with a diagnosis of their own are left to it: one index for all triangles, one time for all events, black
//! light, and planes with exchanged coordinates.

use super::super::geometry::Field;
use super::super::picture::{Picture, Plane, RADIANCE, is_light};
use super::super::points::Points;
use super::{Case, Diagnosis, FEWEST, Kind, MOST, PixelLists, diagnose_channels};
use crate::render::aov::{Aov, group};

/// The least variation of the reference's numbers, relative to the largest.
const VARIES: f64 = 1e-3;
/// Groups of channels that describe surfaces; others, of the film, may be constant.
const OF_SURFACES: [&str; 9] = [
    "object",
    "barycentric",
    "uv",
    "event",
    "object_event",
    "direction",
    "distance",
    "wavelength_ratio",
    "normal",
];
/// Channels with a diagnosis of their own for this.
const NAMED_OTHERWISE: [Aov; 3] = [Aov::Primitive, Aov::EventCt, Aov::ObjectEventCt];

/// The constant channels, and the diagnoses of a candidate without them; `None` if no channel is constant.
pub(super) fn set_apart(case: &Case) -> Option<Vec<Diagnosis>> {
    let [r, c] = case.pair.map(|picture| &picture.layers);
    let names = c.channels.iter().map(|channel| channel.name.as_str());
    let stuck = names.filter_map(|name| {
        let planes = [Plane::find(r, name)?, Plane::find(c, name)?];
        Some((name, only_number(case, name, planes)?))
    });
    let stuck: Vec<(&str, Only)> = stuck.collect();
    // At least one channel of the group is wrong at many pixels.
    let is_plain = |name: &str| {
        (stuck.iter()).any(|(other, only)| only.is_plain && group(other) == group(name))
    };
    let stuck: Vec<(&str, f64)> = (stuck.iter())
        .filter(|(name, _)| is_plain(name))
        .map(|(name, only)| (*name, only.number))
        .collect();
    let (first, _) = stuck.first()?;
    // The other channels of a group are meaningless by themselves.
    let is_stuck = |name: &str| stuck.iter().any(|(other, _)| group(other) == group(name));
    let mut without: Picture = case.pair[1].clone();
    without
        .layers
        .channels
        .retain(|channel| !is_stuck(&channel.name));
    let points = Points::pair([r, &without.layers]);
    let field = Field::new(&points, case.known);
    let lists = PixelLists::default();
    let rest = Case {
        lists: &lists,
        pair: [case.pair[0], &without],
        points,
        field: field.as_ref(),
        ..*case
    };
    let mut found = vec![describe(first, &stuck)];
    found.extend(diagnose_channels(&rest));
    Some(found)
}

/// The only value of a channel, and whether it is wrong at more pixels than edges account for.
#[derive(Debug, Clone, Copy)]
struct Only {
    number: f64,
    is_plain: bool,
}

/// The only value of a channel of the candidate, if the reference has several.
fn only_number(case: &Case, name: &str, [r, c]: [Plane; 2]) -> Option<Only> {
    let is_named = NAMED_OTHERWISE.iter().any(|aov| aov.name() == name);
    let is_expected = is_light(name) || OF_SURFACES.contains(&group(name));
    (is_expected && !is_named).then_some(())?;
    let is_object = name == Aov::Object.name();
    let everywhere = is_object || group(name) == group(Aov::DirectionX.name());
    let pixels = match everywhere {
        true => case.everywhere(),
        false => case.pixels(),
    };
    // Where both pictures agree there may be one surface, in uniform light.
    let number = constant(&c, case.everywhere())?;
    let in_reference = || pixels.iter().map(|i| r.at(*i)).filter(|v| v.is_finite());
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let [low, high] = in_reference().fold(none, |[low, high], v| [low.min(v), high.max(v)]);
    let varies = high - low > VARIES * high.abs().max(low.abs());
    let is_wrong = |v: &f64| (v - number).abs() > VARIES * (high - low);
    let wrong = in_reference().filter(is_wrong).count();
    // If objects cover the whole picture, the others may be missing.
    let is_told = !is_object || number >= 0.0 && low < 0.0;
    let is_clipped = is_light(name) && number == 1.0 && low >= 1.0;
    let is_stuck = varies && is_told && !is_clipped && wrong >= FEWEST;
    (is_stuck && has_more_constants(case, name, pixels)).then_some(Only {
        number,
        is_plain: wrong as f64 >= (1.0 - MOST) * pixels.len() as f64,
    })
}

/// The value of a channel that is constant at these pixels.
fn constant(plane: &Plane, pixels: &[usize]) -> Option<f64> {
    let mut numbers = pixels
        .iter()
        .map(|i| plane.at(*i))
        .filter(|v| v.is_finite());
    let first = numbers.next()?;
    numbers.all(|v| v == first).then_some(first)
}

/// Whether more channels of the group are constant in the candidate than in the reference, since axes may be exchanged; completely black
/// light does not count.
fn has_more_constants(case: &Case, name: &str, pixels: &[usize]) -> bool {
    let count = |which: usize| {
        let layers = &case.pair[which].layers;
        let names = layers.channels.iter().map(|channel| channel.name.as_str());
        let of_group = names.filter(|other| group(other) == group(name));
        let numbers = of_group.filter_map(|other| constant(&Plane::find(layers, other)?, pixels));
        let numbers: Vec<f64> = numbers.collect();
        let is_black =
            is_light(name) && numbers.iter().all(|v| *v == 0.0) && numbers.len() >= RADIANCE.len();
        if is_black { 0 } else { numbers.len() }
    };
    count(1) > count(0)
}

fn describe(first: &str, stuck: &[(&str, f64)]) -> Diagnosis {
    let number = stuck[0].1;
    let are_same = stuck.iter().all(|(_, other)| *other == number);
    let words = |(name, value): &(&str, f64)| match are_same {
        true => name.to_string(),
        false => format!("{name} ({value})"),
    };
    let names: Vec<String> = stuck.iter().map(words).collect();
    let number_in_words = if are_same {
        format!(", {number},")
    } else {
        String::new()
    };
    let what = match stuck.len() {
        1 if first == Aov::WavelengthRatio.name() && number == 1.0 => {
            "channel wavelength_ratio is the same number, 1, at every pixel: that of light without a Doppler shift".into()
        }
        1 => format!("channel {first} is the same number{number_in_words} at every pixel"),
        _ => format!("channels {} are the same number{number_in_words} at every pixel", names.join(", ")),
    };
    Diagnosis {
        kind: Kind::ConstantChannel,
        what: what.into(),
        evidence: vec![("number", number)],
    }
}
