//! Film points of a batch and what is seen along them: offset → film point → look direction, W, departure.

use glam::DVec3;

use crate::accel::vectors::{VectorLoop, dispatch};
use crate::camera::{Departure, View};
use crate::render::film::Tile;
use crate::render::sampler::{Sampler, pixel_key};

/// Samples of a batch, one per pixel of a tile, and how each looks into the world.
#[derive(Debug)]
pub struct Looks<D> {
    pixels: Vec<u64>,
    offsets: [Vec<f64>; 2],
    film: [Vec<f64>; 2],
    moments: Vec<f64>,
    /// Look directions in the world, unit vectors.
    pub(crate) directions: Vec<DVec3>,
    /// W for a source at rest in the world.
    pub(crate) ratios: Vec<f64>,
    /// Where each ray leaves.
    pub(super) from: Vec<D>,
}

impl<D> Default for Looks<D> {
    fn default() -> Self {
        Looks {
            pixels: Vec::new(),
            offsets: Default::default(),
            film: Default::default(),
            moments: Vec::new(),
            directions: Vec::new(),
            ratios: Vec::new(),
            from: Vec::new(),
        }
    }
}

impl<D: Departure> Looks<D> {
    /// Where in its pixel sample `ray` lies.
    pub(crate) fn offset(&self, ray: usize) -> [f64; 2] {
        [self.offsets[0][ray], self.offsets[1][ray]]
    }

    fn aim<V: View<From = D>>(&mut self, view: &V, sampler: &Sampler, tile: Tile, index: u32) {
        self.resize(tile.pixels());
        let [left, top] = tile.corner;
        let rows = self.pixels.chunks_mut(tile.size[0].max(1) as usize);
        for (row, pixels) in (top..).zip(rows) {
            for (column, pixel) in (left..).zip(pixels) {
                *pixel = pixel_key(column, row);
            }
        }
        let [x, y] = &mut self.offsets;
        sampler.offsets(&self.pixels, index, x, y);
        if V::EXPOSED {
            let moment = |(column, row)| sampler.moment(column, row, index);
            self.moments.clear();
            self.moments.extend(tile.coordinates().map(moment));
        }
        let [x, y] = &mut self.film;
        dispatch(Sights {
            view,
            pixels: &self.pixels,
            offsets: [&self.offsets[0], &self.offsets[1]],
            x,
            y,
            moments: &self.moments,
            directions: &mut self.directions,
            ratios: &mut self.ratios,
            from: &mut self.from,
        });
    }

    fn resize(&mut self, count: usize) {
        self.pixels.resize(count, 0);
        for axis in 0..2 {
            self.offsets[axis].resize(count, 0.0);
            self.film[axis].resize(count, 0.0);
        }
        self.directions.resize(count, DVec3::ZERO);
        self.ratios.resize(count, 0.0);
        self.from.resize(count, D::HERE);
    }
}

/// A view of whatever kind, asked for a batch of looks at a time.
pub trait Aim<D>: Sync {
    /// Looks through sample `index` of every pixel of `tile`.
    fn aim(&self, looks: &mut Looks<D>, sampler: &Sampler, tile: Tile, index: u32);
}

impl<D: Departure, V: View<From = D>> Aim<D> for V {
    fn aim(&self, looks: &mut Looks<D>, sampler: &Sampler, tile: Tile, index: u32) {
        looks.aim(self, sampler, tile, index);
    }
}

/// The loop over film points.
struct Sights<'a, V: View> {
    view: &'a V,
    pixels: &'a [u64],
    offsets: [&'a [f64]; 2],
    x: &'a mut [f64],
    y: &'a mut [f64],
    moments: &'a [f64],
    directions: &'a mut [DVec3],
    ratios: &'a mut [f64],
    from: &'a mut [V::From],
}

impl<V: View> VectorLoop for Sights<'_, V> {
    #[inline(always)]
    fn run(self) {
        film_points(
            self.pixels,
            self.offsets[0],
            self.offsets[1],
            self.x,
            self.y,
        );
        let film = [&*self.x, &*self.y];
        look(
            self.view,
            film,
            self.moments,
            self.directions,
            self.ratios,
            self.from,
        );
    }
}

#[inline(always)]
fn film_points(pixels: &[u64], in_x: &[f64], in_y: &[f64], x: &mut [f64], y: &mut [f64]) {
    let count = pixels.len();
    let (in_x, in_y) = (&in_x[..count], &in_y[..count]);
    let (x, y) = (&mut x[..count], &mut y[..count]);
    for k in 0..count {
        x[k] = f64::from(pixels[k] as u32) + in_x[k];
        y[k] = f64::from((pixels[k] >> 32) as u32) + in_y[k];
    }
}

#[inline(always)]
fn look<V: View>(
    view: &V,
    [x, y]: [&[f64]; 2],
    moments: &[f64],
    directions: &mut [DVec3],
    ratios: &mut [f64],
    from: &mut [V::From],
) {
    let count = x.len();
    let (y, directions) = (&y[..count], &mut directions[..count]);
    let (ratios, from) = (&mut ratios[..count], &mut from[..count]);
    for k in 0..count {
        let moment = if V::EXPOSED { moments[k] } else { 0.0 };
        let look = view.look(x[k], y[k], moment);
        directions[k] = look.d.unit();
        ratios[k] = look.ratio;
        from[k] = look.from;
    }
}
