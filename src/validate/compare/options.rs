//! Options: what is compared in two pictures, and how.

use std::sync::Arc;

use crate::error::{Error, Result};
use crate::io::image::Layers;
use crate::scene::model::Scene;

/// Pixels per degree of visual angle on a 3840-pixel display of 0.7 m seen from 0.7 m: 3840 π/180.
pub const PIXELS_PER_DEGREE: f64 = 67.020_643;

/// How pictures are compared.
#[derive(Debug, Clone)]
pub struct CompareOptions {
    /// The pixels to compare.
    pub region: Region,
    /// How to treat light that is not finite.
    pub not_finite: NotFinite,
    /// Channels and groups of them ("event") to compare; all if empty.
    pub channels: Vec<String>,
    /// The scene of the reference, with the pictures' size; if `None`, the text in the reference's metadata is used.
    pub scene: Option<Arc<Scene>>,
    /// Width of a time bin, metres of light path, for emission times in bins.
    pub bin_width: Option<f64>,
    /// Pixels per degree of visual angle, from 1 to 1000, for ꟻLIP; `None` to omit ꟻLIP.
    pub pixels_per_degree: Option<f64>,
    /// Whether pictures are accepted even if the reference's metadata call it the candidate, or the reverse.
    pub allow_swapped: bool,
    /// Whether maps of errors are kept.
    pub maps: bool,
}

impl Default for CompareOptions {
    /// All pixels and channels, ꟻLIP for the observer of its authors, no maps.
    fn default() -> Self {
        CompareOptions {
            region: Region::default(),
            not_finite: NotFinite::Refuse,
            channels: Vec::new(),
            scene: None,
            bin_width: None,
            pixels_per_degree: Some(PIXELS_PER_DEGREE),
            allow_swapped: false,
            maps: false,
        }
    }
}

/// How to treat samples that are NaN or infinite, except in auxiliary channels, where NaN means no hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NotFinite {
    /// Refuse them.
    Refuse,
    /// Skip their pixels.
    Ignore,
    /// Replace them by this value.
    CountAs(f64),
}

/// Part of a picture.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Region {
    /// Left column, top row, width and height; `None` for the whole picture.
    pub crop: Option<[u32; 4]>,
    /// One value per pixel of the picture, row 0 at the top: whether it is compared; `None` for all pixels.
    pub mask: Option<Vec<bool>>,
}

impl Region {
    /// A mask from a picture: pixels whose first channel is above half of its largest value.
    pub fn mask_of(layers: &Layers) -> Vec<bool> {
        let values = layers.channels.first().map(|c| c.samples.to_f64());
        let values = values.unwrap_or_default();
        let largest = values.iter().copied().fold(0.0, f64::max);
        values.iter().map(|v| *v > largest / 2.0).collect()
    }

    /// Refuses a region that is empty or outside of a picture of this size.
    pub(super) fn check(&self, width: u32, height: u32) -> Result<()> {
        let refuse = |place: &str, what: String, help: &str| {
            Err(Error::invalid("comparison", place, what, help))
        };
        if let Some([x, y, w, h]) = self.crop {
            let fits = |start: u32, size: u32, all: u32| {
                size > 0 && u64::from(start) + u64::from(size) <= u64::from(all)
            };
            if !fits(x, w, width) || !fits(y, h, height) {
                let what = format!(
                    "{w} × {h} pixels at ({x}, {y}) are not entirely within {width} × {height} pixels"
                );
                return refuse(
                    "crop",
                    what,
                    "a part of the picture: left column, top row, width, height",
                );
            }
        }
        if let Some(mask) = &self.mask {
            if mask.len() as u64 != u64::from(width) * u64::from(height) {
                let what = format!(
                    "it has {} pixels; the pictures have {width} × {height}",
                    mask.len()
                );
                return refuse("mask", what, "a mask of the pictures' size");
            }
            if !(0..height).any(|y| self.row(y as usize, width as usize).contains(&true)) {
                return refuse(
                    "mask",
                    "it leaves no pixel to compare".into(),
                    "white where pixels are compared",
                );
            }
        }
        Ok(())
    }

    /// Whether every pixel is compared.
    pub fn is_all(&self) -> bool {
        self.crop.is_none() && self.mask.is_none()
    }

    /// The pixels of a picture of this size that are compared, in reading order.
    pub(super) fn pixels(&self, [width, height]: [usize; 2]) -> impl Iterator<Item = usize> {
        (0..height).flat_map(move |y| {
            let chosen = self.row(y, width).into_iter().enumerate();
            chosen.filter_map(move |(x, chosen)| chosen.then_some(y * width + x))
        })
    }

    /// Whether each pixel of row `y` is compared.
    pub(super) fn row(&self, y: usize, width: usize) -> Vec<bool> {
        let mut chosen = match &self.mask {
            Some(mask) => mask[y * width..(y + 1) * width].to_vec(),
            None => vec![true; width],
        };
        if let Some([left, top, w, h]) = self.crop.map(|crop| crop.map(|n| n as usize)) {
            let inside = (top..top + h).contains(&y);
            for (x, chosen) in chosen.iter_mut().enumerate() {
                *chosen &= inside && (left..left + w).contains(&x);
            }
        }
        chosen
    }
}
