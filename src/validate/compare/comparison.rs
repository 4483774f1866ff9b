//! The comparison itself: from matched pictures to all measurements of them.

use rayon::prelude::*;
use serde::Serialize;

use super::diagnose::{self, Diagnosis};
use super::errors::{Errors, Sums};
use super::flip::{self, Flip};
use super::geometry::{Field, Search};
use super::known::{self, Contradiction, KnownScene};
use super::matching::{self, Uncompared};
use super::options::{CompareOptions, Region};
use super::picture::{Encoding, Picture, Plane, RADIANCE, is_auxiliary, is_light};
use super::points::Points;
use super::ssim;
use super::surface::{self, SurfaceErrors};
use crate::error::{Error, Message, Result, Setting};
use crate::io::image::Layers;

/// The result of a comparison.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Comparison {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Number of pixels that were compared.
    pub pixels: u64,
    /// The encoding of the values.
    pub encoding: Encoding,
    /// Errors of the light, over its three channels.
    pub radiance: Option<Errors>,
    /// ꟻLIP of the light.
    pub flip: Option<Flip>,
    /// Errors of the surfaces shown, and of their positions.
    pub surface: Option<SurfaceErrors>,
    /// Errors of each channel that holds quantities, in the order of the reference.
    pub channels: Vec<ChannelErrors>,
    /// Explanations of most of the errors.
    pub diagnoses: Vec<Diagnosis>,
    /// Channels that only one of the pictures has.
    pub uncompared: Uncompared,
    /// Notes on the pictures for the reader.
    pub notes: Vec<Message>,
    /// Geometric error of each pixel, NaN if it has none; only if maps were requested.
    #[serde(skip)]
    pub geometric_map: Option<Vec<f32>>,
}

/// Errors of one channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ChannelErrors {
    /// Its name.
    pub name: String,
    /// Samples that are not finite in the reference only.
    pub only_candidate: u64,
    /// Samples that are not finite in the candidate only.
    pub only_reference: u64,
    /// Errors of the other samples; `None` if there are none.
    #[serde(flatten)]
    pub errors: Option<Errors>,
}

/// The comparison of a grey picture with one in colour.
fn of_grey(name: &str, comparison: Result<Comparison>) -> Result<Comparison> {
    let mut comparison = comparison?;
    let note =
        format!("{name} is grey: its one channel is compared with red, with green and with blue");
    comparison.notes.push(note.into());
    Ok(comparison)
}

/// Compares a candidate with its reference. If one of them has red, green and blue and the other a single channel that is not auxiliary,
/// that channel stands for all three.
///
/// # Errors
/// Channels without one sample per pixel; pictures that do not belong together: different sizes, channels, encodings or quantities; swapped ones; a region outside of them; pixels
/// per degree below 1 or above 1000; a width of bins that is not above 0; a scene other than the reference's; samples that [`CompareOptions::not_finite`] refuses.
pub fn compare(
    reference: &Picture,
    candidate: &Picture,
    options: &CompareOptions,
) -> Result<Comparison> {
    for picture in [reference, candidate] {
        picture.layers.check_lengths()?;
    }
    // ꟻLIP's filters grow with the pixels per degree.
    if let Some(all) = options.pixels_per_degree
        && !(1.0..=1000.0).contains(&all)
    {
        let what = format!("{all} pixels per degree of visual angle");
        return Err(Error::invalid(
            "comparison",
            "pixels_per_degree",
            what,
            "from 1 to 1000",
        ));
    }
    if let Some(width) = options.bin_width
        && !(width > 0.0 && width.is_finite())
    {
        let what = format!("bins of {width} m");
        let help = "the width of a bin in metres of light path, above 0";
        return Err(Error::invalid("comparison", "bin_width", what, help));
    }
    if let Some(named) = reference.with_alpha_named_as_in(candidate) {
        return compare(&named, candidate, options);
    }
    if let Some(named) = candidate.with_alpha_named_as_in(reference) {
        return compare(reference, &named, options);
    }
    if let Some(colours) = reference.in_colours(candidate) {
        return of_grey(&reference.name, compare(&colours, candidate, options));
    }
    if let Some(colours) = candidate.in_colours(reference) {
        return of_grey(&candidate.name, compare(reference, &colours, options));
    }
    // Channels, pixel by pixel.
    let matched = matching::matched(reference, candidate, options)?;
    let [r, c] = matched.layers();
    let size = [r.width as usize, r.height as usize];
    let region = &matched.region;
    let sums = sums([r, c], &matched.names, region);
    let group = Group::of(&matched.names, &sums, reference.encoding);
    let channels = (matched.names.iter().zip(&sums))
        .map(|(name, sums)| channel([r, c], name, sums, &group, region))
        .collect::<Vec<_>>();
    let flip = options.pixels_per_degree.and_then(|pixels_per_degree| {
        Some(flip::evaluate(&flip::Question {
            reference: Plane::group(r, RADIANCE)?,
            candidate: Plane::group(c, RADIANCE)?,
            size,
            region,
            high_range: reference.is_high_range() || candidate.is_high_range(),
            encoded: reference.encoding == Encoding::Srgb,
            pixels_per_degree,
            map: options.maps,
        }))
    });
    // Geometry: the object points that each pixel shows, and the distances between them.
    let pair = [reference, candidate];
    let points = Points::pair(pair.map(|picture| &picture.layers));
    let known = known_of(reference, &points[0], options)?;
    let mut notes = matched.notes.clone();
    let field = Field::new(&points, known.as_ref());
    if let Some(Field::Search(_)) = &field {
        let note = "the reference does not say which scene it shows: geometric errors are measured on the surfaces that it shows (";
        notes.push(Message::from(note) + Setting::Scene + " names the scene)");
    }
    // Points of moving objects by events of the world, where the candidate has nothing else.
    let by_events = known.as_ref().filter(|_| points[1].material.is_none());
    let own = by_events.and_then(|known| Some([known.own_points(r)?, known.own_points(c)?]));
    let own_points = own.as_ref().map(|own| Points::pair(own.each_ref()));
    let search = own_points.as_ref().and_then(Search::new);
    let (surface, geometric_map) = surface::compare(
        [r, c],
        &points,
        field.as_ref(),
        search.as_ref(),
        [&options.region, region],
        options.bin_width,
    );
    // Possible explanations of the difference.
    let own_scene = match options.scene {
        Some(_) => None,
        None => known::scene_of_picture(reference),
    };
    let mixed = diagnose::mixed::pixels(pair, &points);
    let lists = diagnose::PixelLists::default();
    let case = diagnose::Case {
        lists: &lists,
        mixed: &mixed,
        pair,
        points,
        region,
        bin_width: options.bin_width,
        known: known.as_ref(),
        field: field.as_ref(),
        scene: options.scene.as_deref().or(own_scene.as_ref()),
    };
    Ok(Comparison {
        size: [r.width, r.height],
        pixels: region.pixels(size).count() as u64,
        encoding: reference.encoding,
        radiance: group.errors(&matched.names, &sums, &channels),
        flip,
        surface,
        channels,
        diagnoses: diagnose::diagnose(&case),
        uncompared: matched.uncompared.clone(),
        notes,
        geometric_map: geometric_map.filter(|_| options.maps),
    })
}

/// The scene of the reference: the given one, or the one in its metadata if the reference's points are seen where this predicts.
fn known_of(
    reference: &Picture,
    points: &Points,
    options: &CompareOptions,
) -> Result<Option<KnownScene>> {
    let has_points = points.material.is_some() || points.world.is_some();
    let Some(scene) = &options.scene else {
        let known = has_points
            .then(|| KnownScene::of_picture(reference))
            .flatten();
        return Ok(known.filter(|known| known.is_that_of(points)));
    };
    let known = KnownScene::of(scene);
    // A sky without objects has no points.
    let has_points = has_points && !scene.objects.is_empty();
    let contradiction = known
        .as_ref()
        .filter(|_| has_points)
        .and_then(|known| known.contradiction(points));
    let Some(contradiction) = contradiction else {
        return Ok(known);
    };
    let where_not = match contradiction {
        Contradiction::Points => "its points are not where that scene says".into(),
        Contradiction::Object(k) => {
            format!("the points of object {k} are not where that scene says")
        }
    };
    let what = format!("it is not a picture of {}: {where_not}", scene.name);
    let help = "name the scene that the reference shows, at the time of its shot";
    Err(Error::invalid(&reference.name, "scene", what, help))
}

/// Sums of the errors of all channels, with the numbers of samples that are finite in only one picture.
fn sums(pair: [&Layers; 2], names: &[String], region: &Region) -> Vec<(Sums, [u64; 2])> {
    let [width, height] = [pair[0].width as usize, pair[0].height as usize];
    let sum = |name: &String| {
        let mut sums = Sums::new();
        let mut alone = [0; 2];
        let [Some(r), Some(c)] = pair.map(|layers| Plane::find(layers, name)) else {
            return (sums, alone);
        };
        let (mut row_r, mut row_c) = (Vec::new(), Vec::new());
        for y in 0..height {
            r.row(y, &mut row_r);
            c.row(y, &mut row_c);
            let chosen = (!region.is_all()).then(|| region.row(y, width));
            let counted = sums.add_row(y, &row_r, &row_c, chosen.as_deref());
            let pairs = row_r.iter().zip(&row_c).enumerate();
            for (x, (r, c)) in pairs.filter(|_| counted < width as u64) {
                let (r, c) = (r.is_finite(), c.is_finite());
                if r != c && chosen.as_ref().is_none_or(|chosen| chosen[x]) {
                    alone[usize::from(r)] += 1;
                }
            }
        }
        (sums, alone)
    };
    names.par_iter().map(sum).collect()
}

fn channel(
    pair: [&Layers; 2],
    name: &str,
    (sums, [only_candidate, only_reference]): &(Sums, [u64; 2]),
    group: &Group,
    region: &Region,
) -> ChannelErrors {
    let range = group.range(name).unwrap_or(sums.largest());
    let ssim = (!is_auxiliary(name)).then(|| {
        let [r, c] = pair.map(|layers| Plane::find(layers, name));
        let size = [pair[0].width as usize, pair[0].height as usize];
        ssim::mean([r?, c?], size, region, range)
    });
    ChannelErrors {
        name: name.into(),
        only_candidate: *only_candidate,
        only_reference: *only_reference,
        errors: sums.errors(range, ssim.flatten()),
    }
}

/// The channels of light, which share one range.
struct Group {
    range: Option<f64>,
}

impl Group {
    fn of(names: &[String], sums: &[(Sums, [u64; 2])], encoding: Encoding) -> Group {
        let light = names.iter().zip(sums).filter(|(name, _)| is_light(name));
        let largest = light.map(|(_, (sums, _))| sums.largest()).reduce(f64::max);
        Group {
            range: match encoding {
                Encoding::Linear => largest,
                Encoding::Srgb => Some(1.0),
            },
        }
    }

    fn range(&self, name: &str) -> Option<f64> {
        self.range.filter(|_| is_light(name))
    }

    fn errors(
        &self,
        names: &[String],
        sums: &[(Sums, [u64; 2])],
        channels: &[ChannelErrors],
    ) -> Option<Errors> {
        let mut light = names.iter().zip(sums).filter(|(name, _)| is_light(name));
        let mut all = light.next()?.1.0.clone();
        light.for_each(|(_, (sums, _))| all.add(sums));
        let similar = channels.iter().filter(|channel| is_light(&channel.name));
        let similar: Option<Vec<f64>> = similar
            .map(|channel| channel.errors.as_ref()?.ssim)
            .collect();
        let ssim = similar.map(|s| s.iter().sum::<f64>() / s.len() as f64);
        all.errors(self.range.unwrap_or(0.0), ssim)
    }
}
