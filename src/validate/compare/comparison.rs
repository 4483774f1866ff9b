//! The comparison itself: matched pictures to everything that is measured of them.

use rayon::prelude::*;
use serde::Serialize;

use super::diagnose::{self, Diagnosis};
use super::errors::{Errors, Sums};
use super::flip::{self, Flip};
use super::geometry::Field;
use super::known::{self, KnownScene};
use super::matching::{self, Uncompared};
use super::options::{CompareOptions, Region};
use super::picture::{Encoding, Picture, Plane, RADIANCE, is_auxiliary, is_light};
use super::points::Points;
use super::ssim;
use super::surface::{self, SurfaceErrors};
use crate::error::{Error, Message, Result, Setting};
use crate::io::image::Layers;

/// What a comparison has found.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Comparison {
    /// Columns and rows.
    pub size: [u32; 2],
    /// How many pixels were compared.
    pub pixels: u64,
    /// What the values are.
    pub encoding: Encoding,
    /// Errors of the light, its three channels together.
    pub radiance: Option<Errors>,
    /// ꟻLIP of the light.
    pub flip: Option<Flip>,
    /// Errors of what surfaces are seen where.
    pub surface: Option<SurfaceErrors>,
    /// Errors of each channel that holds quantities, in the order of the reference.
    pub channels: Vec<ChannelErrors>,
    /// What explains most of the errors.
    pub diagnoses: Vec<Diagnosis>,
    /// Channels that one of the pictures has alone.
    pub uncompared: Uncompared,
    /// What a reader should know of the pictures.
    pub notes: Vec<Message>,
    /// Geometric error of each pixel, NaN where there is none; where it was asked for.
    #[serde(skip)]
    pub geometric_map: Option<Vec<f32>>,
}

/// Errors of one channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ChannelErrors {
    /// Its name.
    pub name: String,
    /// Samples that are no finite number in the reference alone.
    pub only_candidate: u64,
    /// Samples that are no finite number in the candidate alone.
    pub only_reference: u64,
    /// Errors of the others; none where there are none.
    #[serde(flatten)]
    pub errors: Option<Errors>,
}

/// The comparison of a picture that is grey with one in colours.
fn of_grey(name: &str, comparison: Result<Comparison>) -> Result<Comparison> {
    let mut comparison = comparison?;
    let note =
        format!("{name} is grey: its one channel is compared with red, with green and with blue");
    comparison.notes.push(note.into());
    Ok(comparison)
}

/// Compares a candidate with its reference. Where one of them has red, green and blue and the other a single channel that is
/// not auxiliary, that one stands for all three.
///
/// # Errors
/// Pictures that do not belong together: other sizes, channels, encodings, quantities; swapped ones;
/// a region that is not theirs; pixels per degree below 1 or above 1000; a scene that is not the reference's; samples that are refused by [`CompareOptions::not_finite`].
pub fn compare(
    reference: &Picture,
    candidate: &Picture,
    options: &CompareOptions,
) -> Result<Comparison> {
    // ꟻLIP's filters grow with it.
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
    // Geometry: where the points that each pixel shows lie on their objects, and how far apart they are.
    let pair = [reference, candidate];
    let points = Points::pair(pair.map(|picture| &picture.layers));
    let known = known_of(reference, &points[0], options)?;
    let mut notes = matched.notes.clone();
    let field = Field::new(&points, known.as_ref());
    if let Some(Field::Search(_)) = &field {
        let note = "the reference does not say which scene it shows: geometric errors are measured on the surfaces that it shows (";
        notes.push(Message::from(note) + Setting::Scene + " names the scene)");
    }
    let (surface, geometric_map) =
        surface::compare([r, c], &points, field.as_ref(), region, options.bin_width);
    // What would explain the difference.
    let own_scene = match options.scene {
        Some(_) => None,
        None => known::scene_of_picture(reference),
    };
    let case = diagnose::Case {
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

/// The scene of the reference: the one that is given, or that of its metadata where the reference's points are seen
/// where this says.
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
    // A sky alone has no points.
    let has_points = has_points && !scene.objects.is_empty();
    match &known {
        Some(known) if has_points && !known.is_that_of(points) => {
            let what = format!(
                "it is not a picture of {}: its points are not where that scene says",
                scene.name
            );
            let help = "name the scene that the reference shows, at the time of its shot";
            Err(Error::invalid(&reference.name, "scene", what, help))
        }
        _ => Ok(known),
    }
}

/// Sums of the errors of all channels, with the numbers of samples that only one picture has.
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

/// The light's channels, which have one range.
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
