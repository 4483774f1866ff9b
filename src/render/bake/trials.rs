//! How many samples a bake needs: a share of its texels or tiles, baked with more and more of them.
//!
//! Those tried form a sheared lattice, which has the same share of every chart, whatever its shape. Their random numbers are independent of
//! those of the bake: a number of samples chosen by their error has nothing to do with the values baked, whose mean stays unbiased.

use rayon::prelude::*;

use super::camera::{Pixels, check_plain};
use super::part::{Part, Summary};
use super::surface::{Charts, Surface, Texels, check_size, sampling};
use super::{Bins, check, paths};
use crate::error::Result;
use crate::render::film::{TILE, Tile};
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::trace::{CameraRays, TimedPaths};
use crate::scene::model::Scene;

/// At most one in so many texels or tiles is tried, so that trying all powers of two up to a number of samples takes an eighth of the bake.
const ONE_IN: usize = 16;
/// As many are tried if there are so many, for an error that is right to a few per cent.
const TEXELS: usize = 1024;
const TILES: usize = 8;
/// The offset of the tried ones from row to row of the lattice: odd, so that they visit all columns.
const SHEAR: usize = 5;

/// A share of the texels of a cube, to be baked as a trial.
pub struct Trials<'a> {
    scene: &'a Scene,
    prepared: &'a Prepared,
    bins: &'a Bins,
    paths: TimedPaths<'a>,
    kind: Kind<'a>,
    one_in: usize,
}

enum Kind<'a> {
    /// The texels of a surface, with as many of its back if light may reach it.
    Surface(Box<Charts<'a>>, [usize; 2]),
    /// The tiles of a camera's film.
    Camera,
}

/// The outcome of a trial.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Trial {
    /// As [`Baked::relative_error`](super::Baked::relative_error), of the texels tried; NaN if they are dark.
    pub relative_error: f64,
    /// The texels tried, as a fraction of all, above 0.
    pub share: f64,
}

impl<'a> Trials<'a> {
    /// Trials for [`surface_cube`](super::surface_cube).
    ///
    /// # Errors
    /// As for [`check_surface`](super::check_surface).
    pub fn of_surface(
        scene: &'a Scene,
        prepared: &'a Prepared,
        surface: &Surface,
        bins: &'a Bins,
    ) -> Result<Trials<'a>> {
        check(scene)?;
        check_size(scene, surface)?;
        let paths = paths(scene, prepared)?;
        let charts = Charts::new(scene, &paths, surface, prepared.memory_left)?;
        let [width, height] = surface.size.map(|n| n as usize);
        let size = [width, height * (1 + usize::from(charts.has_lit_backs))];
        Ok(Trials {
            scene,
            prepared,
            bins,
            paths,
            kind: Kind::Surface(Box::new(charts), size),
            one_in: (size[0] * size[1] / TEXELS).clamp(1, ONE_IN),
        })
    }

    /// Trials for [`camera_cube`](super::camera_cube).
    ///
    /// # Errors
    /// As for [`check_camera`](super::check_camera).
    pub fn of_camera(
        scene: &'a Scene,
        prepared: &'a Prepared,
        bins: &'a Bins,
    ) -> Result<Trials<'a>> {
        check(scene)?;
        check_plain(scene)?;
        let tiles = Tile::count(prepared.layout.size) as usize;
        Ok(Trials {
            scene,
            prepared,
            bins,
            paths: paths(scene, prepared)?,
            kind: Kind::Camera,
            one_in: (tiles / TILES).clamp(1, ONE_IN),
        })
    }

    /// The number of texels or pixels tried.
    pub fn texels(&self) -> u64 {
        match &self.kind {
            Kind::Surface(_, [width, height]) => {
                let rows = 0..*height;
                rows.map(|i| self.tried(i, *width).count() as u64).sum()
            }
            Kind::Camera => self.tiles().map(|tile| tile.pixels() as u64).sum(),
        }
    }

    /// Bakes them with this many samples each, at least two, on the threads of rayon's current pool.
    ///
    /// # Errors
    /// Charts that overlap, and [`Error::Cancelled`](crate::Error::Cancelled) when `progress` says so.
    pub fn run(&self, samples: u32, progress: &dyn Progress) -> Result<Trial> {
        // Other random numbers than those of the bake.
        let (sampler, samples) = sampling(!self.scene.seed, samples);
        // Only the sums of each part are kept: the numbers of all texels tried may take as much memory as a cube.
        let sums = |part: Part| {
            let texels = part.covered.len();
            progress.rays_done(texels as u64 * u64::from(samples));
            (texels, part.summary)
        };
        let (all, tried): (usize, Vec<(usize, Summary)>) = match &self.kind {
            Kind::Surface(charts, [width, height]) => {
                let texels = Texels {
                    charts,
                    paths: &self.paths,
                    bins: self.bins,
                };
                let row = |i: usize| {
                    let columns = self.tried(i, *width);
                    let part = texels.row(i, columns, (sampler, samples), progress)?;
                    Ok(sums(part))
                };
                let rows = (0..*height).into_par_iter().map(row);
                (width * height, rows.collect::<Result<_>>()?)
            }
            Kind::Camera => {
                let sampling = (sampler, samples);
                let pixels = Pixels::new(
                    (self.scene, self.prepared),
                    &self.paths,
                    self.bins,
                    sampling,
                );
                let tiles: Vec<Tile> = self.tiles().collect();
                let make = |rays: &mut CameraRays, tile: Tile| {
                    let part = pixels.of_tile(tile, rays, progress)?;
                    Ok(sums(part))
                };
                let tiles = tiles.into_par_iter().map_init(CameraRays::default, make);
                let [width, height] = self.prepared.layout.size.map(|n| n as usize);
                (width * height, tiles.collect::<Result<_>>()?)
            }
        };
        let texels: usize = tried.iter().map(|(texels, _)| texels).sum();
        let sum = |of: fn(&Summary) -> f64| tried.iter().map(|(_, sums)| of(sums)).sum::<f64>();
        let errors = sum(|summary| summary.error_squares.iter().sum());
        Ok(Trial {
            relative_error: (errors / sum(|summary| summary.energy_squares)).sqrt(),
            share: texels as f64 / all as f64,
        })
    }

    /// The columns of row `i` that are tried.
    fn tried(&self, i: usize, width: usize) -> impl Iterator<Item = usize> + use<> {
        let first = i * SHEAR % self.one_in;
        (first..width).step_by(self.one_in)
    }

    /// The tiles that are tried.
    fn tiles(&self) -> impl Iterator<Item = Tile> + use<> {
        let size = self.prepared.layout.size;
        let columns = (size[0] as usize).div_ceil(TILE as usize).max(1);
        let one_in = self.one_in;
        let is_tried = move |index: &usize| {
            let (i, j) = (index / columns, index % columns);
            (j + i * SHEAR).is_multiple_of(one_in)
        };
        let all = (0..Tile::count(size) as usize).filter(is_tried);
        all.map(move |index| Tile::of_image(size, index as u64))
    }
}
