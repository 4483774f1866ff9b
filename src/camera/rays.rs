//! The rays of many film points, in arrays.

use glam::DVec3;

use super::{Projection, RayOrigin, View};
use crate::accel::vectors::{BLOCK, Block, Vectors, load, store};
use crate::spacetime::{Boost, CameraFrame, Direction, Displacement, Frame, World};

/// Film points, pixels, and moments of the exposure, 0 to 1; no moments if a view does not use them, which then count as 0.
#[derive(Debug, Clone, Copy)]
pub struct FilmPoints<'a> {
    /// From the left edge.
    pub x: &'a [f64],
    /// From the top edge.
    pub y: &'a [f64],
    /// Moments.
    pub moments: &'a [f64],
}

/// Where their rays are written: look directions in the world, W, and origins if rays have their own.
#[derive(Debug)]
pub struct RaySlices<'a> {
    /// Look directions, unit vectors.
    pub directions: &'a mut [DVec3],
    /// W for a source at rest in the world.
    pub ratios: &'a mut [f64],
    /// Where the rays leave.
    pub origins: &'a mut [RayOrigin],
}

/// Branch-free rays for almost all film points of a view.
pub(super) trait SimpleRays {
    /// The rays of a block of film points at their moments, with the same bits as [`View::ray_through`], which computes those that are
    /// marked as not simple. Implementations use short loops, one step after the other, with copies of shared values: compilers do not
    /// vectorize a long loop, or one that reads through references, for AVX2.
    fn rays<P: Projection>(&self, film: &P, at: [&Block; 2], moments: &Block, to: &mut RayBlock);
}

impl FilmPoints<'_> {
    #[inline(always)]
    fn moment(&self, k: usize) -> f64 {
        self.moments.get(k).copied().unwrap_or(0.0)
    }
}

impl RaySlices<'_> {
    /// The rays of `view`, one after the other.
    #[inline(always)]
    pub(super) fn fill<V: View, P: Projection>(&mut self, view: &V, film: &P, points: &FilmPoints) {
        // Slices of known length avoid bounds checks in the loop.
        let count = points.x.len();
        let (x, y) = (points.x, &points.y[..count]);
        let directions = &mut self.directions[..count];
        let ratios = &mut self.ratios[..count];
        for k in 0..count {
            let ray = view.ray_through(film, x[k], y[k], points.moment(k));
            directions[k] = ray.d.unit();
            ratios[k] = ray.ratio;
            if !V::SHARED_ORIGIN {
                self.origins[k] = ray.origin;
            }
        }
    }

    /// The rays of a point camera, block by block; `boost` takes its look directions to the world, if it moves.
    #[inline(always)]
    pub(super) fn fill_from_point<P: Projection>(
        &mut self,
        film: &P,
        points: &FilmPoints,
        boost: Option<&Boost<World, CameraFrame>>,
    ) {
        // Test once: a branch at each direction would keep the loop from vectorizing.
        let boost = boost.filter(|boost| !boost.is_identity());
        let (mut d, mut lengths, mut ratios) = (Vectors::ZERO, [0.0; BLOCK], [1.0; BLOCK]);
        for (block, directions) in self.directions.chunks_mut(BLOCK).enumerate() {
            let begin = block * BLOCK;
            let (x, y) = (load(points.x, begin), load(points.y, begin));
            // Two loops: roots and quotients depend on each other, and in short loops more rays are in flight at once.
            film.directions_and_lengths([&x, &y], d.axes_mut(), &mut lengths);
            if let Some(boost) = boost {
                for (k, ratio) in ratios.iter_mut().enumerate() {
                    let seen = Direction::from_unit(d.get(k));
                    let in_world;
                    (in_world, *ratio) = boost.direction_of_moving(seen);
                    d.set(k, in_world.unit());
                }
            }
            // Without a boost they are all still 1.
            store(&ratios, self.ratios, begin);
            for (k, direction) in directions.iter_mut().enumerate() {
                *direction = d.get(k);
            }
        }
    }

    /// The rays of `view`, block by block: first those that `simple` computes, then the others.
    #[inline(always)]
    pub(super) fn fill_by<S: SimpleRays, V: View, P: Projection>(
        &mut self,
        simple: &S,
        view: &V,
        film: &P,
        points: &FilmPoints,
    ) {
        let count = points.x.len();
        let mut rays = RayBlock::SIMPLE;
        let mut begin = 0;
        while begin < count {
            let (x, y) = (load(points.x, begin), load(points.y, begin));
            let moments = match points.moments.is_empty() {
                true => [0.0; BLOCK],
                false => load(points.moments, begin),
            };
            simple.rays(film, [&x, &y], &moments, &mut rays);
            let end = (begin + BLOCK).min(count);
            for k in begin..end {
                self.directions[k] = rays.d.get(k - begin);
                self.ratios[k] = rays.ratio[k - begin];
                self.origins[k] = rays.origin(k - begin);
            }
            for k in begin..end {
                // The rays that the closed form does not cover.
                if rays.is_simple[k - begin] == 0.0 {
                    let ray =
                        view.ray_through(film, x[k - begin], y[k - begin], moments[k - begin]);
                    self.directions[k] = ray.d.unit();
                    self.ratios[k] = ray.ratio;
                    self.origins[k] = ray.origin;
                }
            }
            begin = end;
        }
    }
}

/// Rays by component.
pub(super) struct RayBlock {
    /// Look directions, first in the camera's frame, then in the world's.
    pub d: Vectors,
    pub ratio: Block,
    /// Where the rays leave: [`RayOrigin`].
    pub ct: Block,
    pub x: Vectors,
    pub weight: Block,
    /// 1 for simple rays, 0 for others, whose values are arbitrary.
    pub is_simple: Block,
}

impl RayBlock {
    /// All simple, to be filled in.
    const SIMPLE: RayBlock = RayBlock {
        d: Vectors::ZERO,
        ratio: [0.0; BLOCK],
        ct: [0.0; BLOCK],
        x: Vectors::ZERO,
        weight: [0.0; BLOCK],
        is_simple: [1.0; BLOCK],
    };

    /// Takes look directions to the world by `boost`, and sets their ratios; without `aberration` the directions are unchanged.
    #[inline(always)]
    pub fn look(&mut self, boost: &Boost<World, CameraFrame>, aberration: bool) {
        let boost = *boost;
        let seen = |d: &Vectors, k: usize| Direction::<CameraFrame>::from_unit(d.get(k));
        if aberration {
            for k in 0..BLOCK {
                let (d, ratio) = boost.direction(seen(&self.d, k));
                self.d.set(k, d.unit());
                self.ratio[k] = ratio;
            }
        } else {
            for k in 0..BLOCK {
                (_, self.ratio[k]) = boost.direction(seen(&self.d, k));
            }
        }
    }

    /// Where ray `k` leaves so far.
    #[inline(always)]
    pub fn place<F: Frame>(&self, k: usize) -> Displacement<F> {
        Displacement::new(self.ct[k], self.x.get(k))
    }

    /// Sets where ray `k` leaves.
    #[inline(always)]
    pub fn set_place<F: Frame>(&mut self, k: usize, place: Displacement<F>) {
        self.ct[k] = place.ct;
        self.x.set(k, place.x);
    }

    /// Sets whether ray `k` is simple.
    #[inline(always)]
    pub fn set_simple(&mut self, k: usize, is_simple: bool) {
        self.is_simple[k] = if is_simple { 1.0 } else { 0.0 };
    }

    #[inline(always)]
    fn origin(&self, k: usize) -> RayOrigin {
        RayOrigin {
            displacement: self.place(k),
            delay: 1.0,
            weight: self.weight[k],
        }
    }
}
