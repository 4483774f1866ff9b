//! Comparing pictures: is a candidate right, where not, by how much, and why.
//!
//! ```text
//! two pictures → matched → errors per channel, structural similarity, ꟻLIP, errors of surfaces
//!                [matching]  [errors]           [ssim]                 [flip]  [surface]
//!              → diagnoses → tolerances, tables, maps, reports
//!                [diagnose]  [tolerance, report]
//! ```
//!
//! Definitions stand at the head of the module of each metric. Rows are worked through in strips whose results are
//! added in their order: the same bits on any number of threads.
//!
//! ```
//! use nullray::validate::compare::{Options, Picture, compare};
//! use nullray::io::image::{Channel, Layers, Samples};
//! # fn main() -> nullray::Result<()> {
//! let picture = |name: &str, light: f64| {
//!     let channel = |c: &str| Channel { name: format!("radiance.{c}"), samples: Samples::F64(vec![light; 64]) };
//!     let layers = Layers::new(8, 8, ["R", "G", "B"].map(channel).into(), vec![])?;
//!     Ok::<_, nullray::Error>(Picture::linear(name, layers))
//! };
//! let comparison = compare(&picture("exact", 1.0)?, &picture("mine", 1.1)?, &Options::default())?;
//! let radiance = comparison.radiance.as_ref().unwrap();
//! assert!((radiance.rmse - 0.1).abs() < 1e-12);
//! # Ok(())
//! # }
//! ```

pub mod diagnose;
mod errors;
mod finite;
pub mod flip;
mod matching;
mod picture;
mod plane;
mod read;
mod region;
pub mod report;
mod ssim;
pub mod surface;
mod tolerance;

use rayon::prelude::*;
use serde::Serialize;

pub use diagnose::{Diagnosis, Kind};
pub use errors::{Errors, Histogram};
pub use flip::Flip;
pub use picture::{Encoding, Picture};
pub use region::Region;
pub use surface::SurfaceErrors;
pub use tolerance::{Breach, Tolerance};

use crate::error::Result;
use crate::io::image::{Channel, Layers};
use crate::render::aov::Aov;
use errors::Sums;
use plane::Plane;

/// The channels of light, in this order.
pub(crate) const RADIANCE: [&str; 3] = ["radiance.R", "radiance.G", "radiance.B"];

/// How pictures are compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Which pixels.
    pub region: Region,
    /// What is done where light is no finite number.
    pub not_finite: NotFinite,
    /// Channels and groups of them ("event") that are compared; all where it is empty.
    pub channels: Vec<String>,
    /// Width of a time bin, metres of light path, to which emission times relate.
    pub bin_width: Option<f64>,
    /// Pixels per degree of visual angle, for ꟻLIP; none to leave ꟻLIP out.
    pub pixels_per_degree: Option<f64>,
    /// Whether a reference that says it is the candidate, and the reverse, is taken as given.
    pub allow_swapped: bool,
    /// Whether maps of errors are kept.
    pub maps: bool,
}

impl Default for Options {
    /// All pixels and channels, ꟻLIP for the observer of its authors, no maps.
    fn default() -> Self {
        Options {
            region: Region::default(),
            not_finite: NotFinite::Refuse,
            channels: Vec::new(),
            bin_width: None,
            pixels_per_degree: Some(flip::PIXELS_PER_DEGREE),
            allow_swapped: false,
            maps: false,
        }
    }
}

/// What is done with samples that are NaN or infinite, other than in auxiliary channels, where NaN says that no surface is met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NotFinite {
    /// They are refused.
    Refuse,
    /// Their pixels do not count.
    Ignore,
    /// They count as this value.
    CountAs(f64),
}

/// What a comparison has found.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
    /// What a reader should know of the pictures.
    pub notes: Vec<String>,
    /// Geometric error of each pixel, NaN where there is none; where it was asked for.
    #[serde(skip)]
    pub geometric_map: Option<Vec<f32>>,
}

/// Errors of one channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelErrors {
    /// Its name.
    pub name: String,
    /// Samples that are no finite number in the reference alone.
    pub only_candidate: u64,
    /// Samples that are no finite number in the candidate alone.
    pub only_reference: u64,
    /// Errors of the others.
    #[serde(flatten)]
    pub errors: Errors,
}

/// Compares a candidate with its reference.
///
/// # Errors
/// Pictures that do not belong together: other sizes, channels, encodings, quantities; swapped ones;
/// a region that is not theirs; samples that are refused by [`Options::not_finite`].
pub fn compare(reference: &Picture, candidate: &Picture, options: &Options) -> Result<Comparison> {
    let matched = matching::matched(reference, candidate, options)?;
    let [r, c] = matched.layers();
    let size = [r.width as usize, r.height as usize];
    let region = &options.region;
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
            high_range: reference.encoding == Encoding::Linear,
            encoded: reference.encoding == Encoding::Srgb,
            pixels_per_degree,
            map: options.maps,
        }))
    });
    let (surface, geometric_map) = surface::compare([r, c], region, options.bin_width);
    Ok(Comparison {
        size: [r.width, r.height],
        pixels: (0..size[1]).map(|y| region.count(y, size[0])).sum(),
        encoding: reference.encoding,
        radiance: group.errors(&matched.names, &sums, &channels),
        flip,
        surface,
        channels,
        diagnoses: diagnose::diagnose([reference, candidate], region, options.bin_width),
        notes: matched.notes,
        geometric_map: geometric_map.filter(|_| options.maps),
    })
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
            let before = sums.count();
            sums.add_row(y, &row_r, &row_c, chosen.as_deref());
            let whole = sums.count() - before == width as u64;
            let pairs = row_r.iter().zip(&row_c).enumerate();
            for (x, (r, c)) in pairs.filter(|_| !whole) {
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
        let similar: Option<Vec<f64>> = similar.map(|channel| channel.errors.ssim).collect();
        let ssim = similar.map(|s| s.iter().sum::<f64>() / s.len() as f64);
        Some(all.errors(self.range.unwrap_or(0.0), ssim))
    }
}

/// Whether the channel is one of the light's.
pub(crate) fn is_light(name: &str) -> bool {
    name.starts_with("radiance.")
}

/// Whether the channel is auxiliary: NaN in it says that no surface is met.
pub(crate) fn is_auxiliary(name: &str) -> bool {
    Aov::named(name).is_some()
}

/// Whether the channel holds indices, whose differences mean nothing.
pub(crate) fn is_identity(channel: &Channel) -> bool {
    Aov::named(&channel.name).is_some_and(Aov::is_identity)
}
