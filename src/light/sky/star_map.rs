//! Stars: discs of uniform radiance, looked up by the cells of a cube that contain them.
//!
//! A star is a blackbody: seen at W it is one of the temperature T/W, because W⁻⁵ B(λ/W; T) = B(λ; T/W). Its irradiance on a perpendicular
//! surface is that times the solid angle Ω that a blackbody would have, and with dω_F = W² dω
//!
//! ```text
//! E_F = W² Ω B(λ; T/W).
//! ```
//!
//! Discs smaller than pixels would fall between samples. Pixels of width a in a camera's frame see a/W of the world, in all directions
//! alike, because the boost of directions is conformal. So a disc with a radius ρ below 1.2 a/W is seen with a larger one R, and at the
//! angle θ from its centre, with s = sin² θ/sin² R and q = sin² ρ/sin² R,
//!
//! ```text
//! sin² R = (1.4 a/W)² − 0.36 sin² ρ,
//! L = E/(π sin² R) · (5 (1 − q²) (1 − s)⁴ + q²),        ∫ L cos θ dω = π sin² R ∫₀¹ L ds = E,
//! ```
//!
//! which is the disc itself if R = ρ. W may change within the disc, by orders of magnitude for pixels that see much of the world. So θ is
//! the angle in the camera's frame, between the direction d and the star s, which follows from the invariant product of their null vectors:
//!
//! ```text
//! 1 − cos θ = W_d W_s (1 − cos θ_world),
//! ```
//!
//! and E is received with W_s: times (W_d/W_s)ᵖ⁻² beyond W_d⁻ᵖ, as a blackbody of T/W_s. With 1/W = γ (1 + β·d), everything within the chord
//! C in the camera's frame is in a cap of the world,
//!
//! ```text
//! s·(2 W_d d + C² γβ) > 2 W_d − C² γ.
//! ```
//!
//! For a point, q = 0, the transform of (1 − s)⁴ is as J₅(kR)/(kR)⁵, whose first zero is at R = 1.396 (2π/k): the sum over pixel centres
//! conserves its light to 0.4 %, wherever it lies among them, and the width at half of the radiance is 1.1 pixels.
//!
//! For sin R in the world up to a bound r there is a level, with lists of everything that reaches into cells of width r; the next level is
//! for 2r. There the stars of a square of width r/4 are merged into one place, at the centre of their light, which moves them by half a
//! pixel at most. As R grows from r/2 to r they move there gradually, so there is no step between levels. Among the light seen in one direction, stars whose
//! ln B, about −c₂/(λT), differs by at most ½ are merged into one of their total luminance and their mean 1/T, whose colours at W ≤ 1 have
//! an error of (½)²/24 = 1 %. This bounds the sizes of levels and the times of look-ups however many stars a pixel sees.
//!
//! A pixel across which W changes by more than half, or that sees more than 30° of the world (few do in any picture), takes from all levels
//! the coarsest squares across which W changes by a tenth at most. If the camera's velocity changes during the exposure, each ray has that
//! of its own moment. The elements of a turning sensor are taken to have the camera's, unless W differs from that twofold: then W_s = W_d.
//!
//! The rays of a tile mostly look into one small part of a face: the candidates there are found once for all of them, and each disc is tested
//! against the rays of each eighth of a block that comes near, in vector loops.

use std::sync::OnceLock;

use glam::DVec3;

use super::PixelAngles;
use super::cap::{Cap, Disc, LESS, REACH, WIDEST, reach};
use super::faces::{Grid, Index, Rectangle};
use super::levels::{CHORD, DIAGONAL, FARTHEST, Level, Part, Place};
use super::rays::{Bounds, FEW, Rays};
use super::star::{Beaming, Star, raised};
use super::tally::{Candidate, Sight, Tally};
use crate::accel::vectors::{BLOCK, Columns, VectorLoop, dispatch};

/// The power of 2 of the largest sin R of a level.
const WIDEST_POWER: i32 = -1;
/// Cells per star, so that most are empty, and the maximum along an edge of a face; the same for the finest level of widened discs. And the
/// minimum.
const PER_STAR: f64 = 16.0;
const FINEST: f64 = 512.0;
const PER_STAR_WIDENED: f64 = 64.0;
const FINEST_WIDENED: f64 = 1024.0;
const COARSEST: f64 = 64.0;
/// Up to these a level serves: the square of the change of W over sin R by its gradient, and the change by its curvature.
const STEEP: f64 = 0.25;
const BENT: f64 = 0.2;
/// The greatest change of W across a square that a wider pixel sees as one place.
const CHANGE: f64 = 0.1;
/// The numbers of rays that look for stars together: those of a tile, or, where these look too far apart, fewer and fewer.
const TOGETHER: [usize; 4] = [MOST_TOGETHER, BLOCK, FEW, 1];
const MOST_TOGETHER: usize = 4 * BLOCK;
/// The maximum number of cells that up to 64 of them look through together: in pictures, 64 rays mostly need fewer, and so do 8. More rays
/// may look through twice as many.
const MOST_CELLS: usize = 512;

/// Stars of one angular radius ρ: radiance E/(π sin² ρ) within it, or as given at the head of this file if pixels are wider than that.
#[derive(Debug)]
pub struct StarMap {
    stars: Vec<Star>,
    /// sin ρ, what is within ρ, and 1/(π sin² ρ).
    sine: f64,
    disc: Disc,
    density: f64,
    /// The stars' discs by direction.
    discs: Index<u32>,
    /// Levels for widened discs, the finest first, each built on first use.
    levels: Vec<OnceLock<Level>>,
}

/// Room for looking at stars.
#[derive(Debug, Default)]
struct Seeing {
    tally: Tally,
    /// What the rays that look together may see: families of a level, or discs.
    candidates: Vec<Candidate>,
    discs: Vec<u32>,
}

/// Which rays look at a disc: 1 if so, else 0.
struct Within<'a> {
    rays: Rays<'a>,
    direction: DVec3,
    disc: Disc,
    within: &'a mut [u64; BLOCK],
    any: &'a mut u64,
}

impl VectorLoop for Within<'_> {
    #[inline(always)]
    fn run(self) {
        let [x, y, z] = self.rays.axes;
        let count = x.len().min(y.len()).min(z.len()).min(BLOCK);
        let (direction, disc) = (self.direction, self.disc);
        let (mut within, mut any) = ([0; BLOCK], 0);
        for k in 0..count {
            within[k] = u64::from(disc.around(direction, DVec3::new(x[k], y[k], z[k])));
            any |= within[k];
        }
        (*self.within, *self.any) = (within, any);
    }
}

impl StarMap {
    /// An upper bound on the bytes of a map of this many stars once all of its levels are built.
    pub fn bytes(stars: usize) -> u64 {
        let faces = |cells: usize| 6 * 4 * (cells * cells) as u64;
        let finest = faces(cells(stars, PER_STAR_WIDENED, FINEST_WIDENED));
        // All levels have 4/3 as many cells as the finest, which are counted once more while a level is built.
        let cells = faces(cells(stars, PER_STAR, FINEST)) + finest * 7 / 3;
        // Families, parts and places on all levels, of 500,000 stars.
        cells + 1000 * stars as u64
    }

    /// `stars` with the angular `radius`, at most a few degrees.
    pub fn new(stars: Vec<Star>, radius: f64) -> StarMap {
        let sine = libm::sin(radius);
        // Most cells are empty, unless discs are as wide as cells.
        let by_radius = (1.0 / radius).clamp(COARSEST, FINEST);
        let grid = Grid {
            cells: cells(stars.len(), PER_STAR, by_radius),
        };
        let discs = Index::new(
            grid,
            (0..).zip(&stars).map(|(k, star)| (k, star.direction, sine)),
        );
        // Cells of a level are as wide as its largest sin R: 2/cells, starting from this and up to the widest.
        let finest = cells(stars.len(), PER_STAR_WIDENED, FINEST_WIDENED).ilog2() as i32;
        let levels = finest + WIDEST_POWER;
        StarMap {
            sine,
            disc: Disc::of(radius),
            density: 1.0 / (std::f64::consts::PI * sine * sine),
            discs,
            levels: (0..levels).map(|_| OnceLock::new()).collect(),
            stars,
        }
    }

    /// The sum of the radiances of the stars whose discs contain `d`; `light` of each is its irradiance on a perpendicular surface,
    /// proportional to its solid angle.
    #[inline]
    pub fn radiance(&self, d: DVec3, light: impl Fn(&Star) -> [f64; 3]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        let place = d.to_array();
        let near = Rectangle::of(place, place).map(|at| at.widened(self.sine));
        let rows = near.and_then(|near| self.discs.rows(near, usize::MAX));
        for &number in rows.into_iter().flatten().flatten() {
            let star = &self.stars[number as usize];
            if self.disc.around(star.direction, d) {
                for (sum, e) in sum.iter_mut().zip(light(star)) {
                    *sum += e * self.density;
                }
            }
        }
        sum
    }

    /// Calls `each` with the indices of the directions along which stars are seen, and with the sum of their radiances, for pixels as wide
    /// as `angles` says; `light` of each star along a direction is its irradiance on a perpendicular surface.
    pub(crate) fn each_seen(
        &self,
        directions: &Columns,
        angles: PixelAngles,
        light: impl Fn(usize, &Star) -> [f64; 3],
        mut each: impl FnMut(usize, [f64; 3]),
    ) {
        let all = Rays {
            axes: directions.axes(),
            ratios: angles.ratios,
            pixel: angles.pixel,
            beaming: angles.beaming,
            motions: angles.motions,
        };
        let mut seeing = Seeing::default();
        self.see_all(all, 0, &TOGETHER, &mut seeing, &light, &mut each);
    }

    /// [`StarMap::each_seen`] for rays with indices from `first` on, the first of `numbers` of them at a time, or, where these look too far
    /// apart, the next.
    fn see_all(
        &self,
        rays: Rays,
        first: usize,
        numbers: &[usize],
        seeing: &mut Seeing,
        light: &impl Fn(usize, &Star) -> [f64; 3],
        each: &mut impl FnMut(usize, [f64; 3]),
    ) {
        let [number, smaller @ ..] = numbers else {
            return;
        };
        for begin in (0..rays.len()).step_by(*number) {
            let part = rays.part(begin, rays.len().min(begin + number));
            if !self.see(part, first + begin, seeing, light, each) {
                self.see_all(part, first + begin, smaller, seeing, light, each);
            }
        }
    }

    /// [`StarMap::each_seen`] for rays with indices from `first` on; does nothing and says so if these look into more than one face,
    /// through too many cells, see stars of more than one level, or too much for one.
    fn see(
        &self,
        rays: Rays,
        first: usize,
        seeing: &mut Seeing,
        light: &impl Fn(usize, &Star) -> [f64; 3],
        each: &mut impl FnMut(usize, [f64; 3]),
    ) -> bool {
        let mut of_blocks = [Bounds::NONE; MOST_TOGETHER / BLOCK];
        for (bounds, (_, block)) in of_blocks.iter_mut().zip(rays.blocks()) {
            *bounds = block.bounds();
        }
        let bounds = of_blocks.into_iter().fold(Bounds::NONE, Bounds::with);
        let ([x, y, z, least], [far_x, far_y, far_z, greatest]) = (bounds.low, bounds.high);
        // Discs are widest where W is smallest.
        let reaches = [least, greatest].map(|w| reach(self.sine, rays.pixel / w));
        let levels = reaches.map(|reach| (reach > self.sine).then(|| self.level_of(reach)));
        // All rays have to look into one face, and see one level, or all of them discs of their true size.
        let Some(at) =
            Rectangle::of([x, y, z], [far_x, far_y, far_z]).filter(|_| levels[0] == levels[1])
        else {
            return false;
        };
        let most = match rays.len() {
            1 => usize::MAX,
            2..=BLOCK => MOST_CELLS,
            _ => 2 * MOST_CELLS,
        };
        let Some(number) = levels[0] else {
            let Some(rows) = self.discs.rows(at.widened(self.sine), most) else {
                return false;
            };
            seeing.discs.clear();
            seeing.discs.extend(rows.flatten());
            if !seeing.discs.is_empty() {
                for (begin, block) in rays.blocks() {
                    let first = first + begin;
                    let light = |k: usize, star: &Star| light(first + k, star);
                    self.see_discs(block, &seeing.discs, light, |k, seen| each(first + k, seen));
                }
            }
            return true;
        };
        let bound = self.reach_of(number);
        // The part of the way to their merged places that stars have left.
        let left = (2.0 - 2.0 * reaches[1] / bound).clamp(0.0, 1.0);
        let distance = distance(&rays, [least, greatest], reaches[0]).filter(|distance| {
            reaches[0] <= WIDEST && distance + left * DIAGONAL * bound <= FARTHEST
        });
        let Some(distance) = distance else {
            if rays.len() == 1 {
                let cap = Cap::of_points(rays.get(0), rays.ratios[0], reaches[0], rays.motion(0));
                let seen = self.in_cap(&cap, rays.beaming, |star| light(first, star));
                if seen != [0.0; 3] {
                    each(first, seen);
                }
            }
            return rays.len() == 1;
        };
        let level = self.level(number);
        let near = at.widened(distance + left * DIAGONAL * bound);
        let Some(rows) = level.index.rows(near, most) else {
            return false;
        };
        let sight = Sight {
            widths: (self.sine, LESS, REACH),
            most: bound,
            distance,
            left,
        };
        // What all of the rays may see, and of that what those of each block may.
        let Seeing {
            tally, candidates, ..
        } = seeing;
        let all = rows.flatten().map(|near| Candidate::new(near, &sight));
        candidates.clear();
        candidates.extend(all.filter(|candidate| candidate.is_near(&bounds)));
        if !candidates.is_empty() {
            for ((begin, block), bounds) in rays.blocks().zip(of_blocks) {
                let first = first + begin;
                let near = candidates.iter().filter(|c| c.is_near(&bounds));
                if tally.add(level, block, sight, near.copied()) {
                    let light = |k: usize, star: &Star| light(first + k, star);
                    tally.each_seen(level, &block, light, |k, seen| each(first + k, seen));
                }
            }
        }
        true
    }

    /// The sum of the `light` in a cap.
    fn in_cap(&self, cap: &Cap, beaming: Beaming, light: impl Fn(&Star) -> [f64; 3]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        let (axis, bound_of_cap) = cap.in_world();
        let mut shine = |direction: DVec3, parts: &[Part], channels: [f32; 3]| {
            let [density, x] = cap.density(direction);
            if density > 0.0 {
                let density = density * raised(x, beaming.power);
                let mut add = |seen: [f64; 3], times: f64| {
                    for (sum, seen) in sum.iter_mut().zip(seen) {
                        *sum += seen * times;
                    }
                };
                if beaming.channels {
                    return add(channels.map(f64::from), density);
                }
                let x = if beaming.shifted { x } else { 1.0 };
                let stars = parts.iter().map(|part| part.star(direction));
                stars
                    .filter(|star| star.solid_angle > 0.0)
                    .for_each(|star| {
                        let temperature = star.temperature * x;
                        add(
                            light(&Star {
                                temperature,
                                ..star
                            }),
                            density,
                        );
                    });
            }
        };
        // From the widest level down, until a family is narrow enough for the cap and W hardly changes across it.
        let last = self.levels.len() - 1;
        let mut left: Vec<_> = (0u32..self.level(last).families.len() as u32)
            .map(|family| (last, family))
            .collect();
        while let Some((number, family)) = left.pop() {
            let (level, bound) = (self.level(number), self.reach_of(number));
            let family = &level.families[family as usize];
            let (place, size) = (&family.merged, DIAGONAL * bound);
            // No star of the family is in the cap.
            if place.direction.dot(axis) + size * axis.length() <= bound_of_cap {
                continue;
            }
            let inverse = cap.motion.inverse_ratio(place.direction);
            let finer = &level.finer[family.finer.start as usize..family.finer.end as usize];
            if bound <= cap.sine * inverse && cap.motion.change(inverse, size) <= CHANGE {
                let parts = &level.parts[place.parts.start as usize..place.parts.end as usize];
                shine(place.direction, parts, place.channels);
            } else if number > 0 {
                left.extend(finer.iter().map(|family| (number - 1, *family)));
            } else {
                for star in finer.iter().map(|star| &self.stars[*star as usize]) {
                    let channels = star.channels().map(|c| c as f32);
                    shine(star.direction, &[Part::of(star)], channels);
                }
            }
        }
        sum
    }

    /// The same with unwidened discs, those with these indices.
    fn see_discs(
        &self,
        rays: Rays,
        discs: &[u32],
        light: impl Fn(usize, &Star) -> [f64; 3],
        mut each: impl FnMut(usize, [f64; 3]),
    ) {
        let (mut within, mut sums, mut seen) = ([0; BLOCK], [[0.0; 3]; BLOCK], 0u64);
        for &number in discs {
            let star = &self.stars[number as usize];
            let mut any = 0;
            dispatch(Within {
                rays,
                direction: star.direction,
                disc: self.disc,
                within: &mut within,
                any: &mut any,
            });
            if any > 0 {
                for k in (0..rays.len()).filter(|k| within[*k] > 0) {
                    seen |= 1 << k;
                    for (sum, e) in sums[k].iter_mut().zip(light(k, star)) {
                        *sum += e * self.density;
                    }
                }
            }
        }
        // Bit k for ray k: a block has 64 rays.
        while seen != 0 {
            let k = seen.trailing_zeros() as usize;
            seen &= seen - 1;
            each(k, sums[k]);
        }
    }

    /// The level for discs with sin R = `reach`, above 0; the last if they are wider than on any.
    #[inline(always)]
    fn level_of(&self, reach: f64) -> usize {
        // The exponent of the smallest power of 2 that is not below `reach`; levels are counted down from the widest.
        let power = ((reach.min(WIDEST).to_bits() - 1) >> 52) as i32 - 1022;
        let coarser = (WIDEST_POWER - power) as usize;
        (self.levels.len() - 1).saturating_sub(coarser)
    }

    /// The largest sin R of a level.
    #[inline(always)]
    fn reach_of(&self, level: usize) -> f64 {
        // Half of the width for each finer level: one less in the exponent.
        let halvings = (self.levels.len() - 1 - level) as u64;
        f64::from_bits(WIDEST.to_bits() - (halvings << 52))
    }

    /// A level, built from the stars of the one before it: the same whichever thread builds it.
    fn level(&self, number: usize) -> &Level {
        self.levels[number].get_or_init(|| match number.checked_sub(1) {
            None => {
                let parts: Vec<_> = self.stars.iter().map(Part::of).collect();
                let places = (0..).zip(&self.stars).map(|(k, star)| Place {
                    direction: star.direction,
                    parts: k..k + 1,
                    channels: star.channels().map(|c| c as f32),
                });
                Level::new(&places.collect::<Vec<_>>(), &parts, self.reach_of(number))
            }
            Some(finer) => {
                let Level {
                    families, parts, ..
                } = self.level(finer);
                let places = families.iter().map(|family| family.merged.clone());
                Level::new(&places.collect::<Vec<_>>(), parts, self.reach_of(number))
            }
        })
    }

    /// The stars.
    pub fn stars(&self) -> &[Star] {
        &self.stars
    }
}

/// An upper bound of the chord, in the world, at which rays see stars, with W from the least to the greatest and sin R up to `reach`; `None`
/// if W changes too much over it.
///
/// C² > c² W_d W_s, and over c 1/W grows by its gradient and curvature at most ([`Motion`]): with r = C/W_d, c² < r² (1 + g c + k c²).
fn distance(rays: &Rays, [least, greatest]: [f64; 2], reach: f64) -> Option<f64> {
    let (gamma, point) = (rays.fastest(), CHORD * REACH * rays.pixel);
    let (mut steep, mut bent) = (0.0, 0.0);
    if gamma > 1.0 {
        // r² g² and r² k, where they are largest for 1/W in this range.
        let square = point * point;
        let at = |y: f64| y.max(1.0 / greatest).min(1.0 / least);
        let (y, x) = (at(gamma), at(0.5 * gamma));
        steep = (square * (2.0 * gamma * y - 1.0 - y * y)).max(0.0);
        bent = (0.5 * square * (gamma * x - x * x)).max(0.0);
    }
    let root = (0.25 * steep + 1.0 - bent).max(0.0).sqrt();
    let distance = CHORD * reach * (0.5 * steep.sqrt() + root) / (1.0 - bent);
    (steep <= STEEP && bent <= BENT).then_some(distance)
}

/// Cells along an edge of a face for this many cells per star.
fn cells(stars: usize, per_star: f64, most: f64) -> usize {
    let cells = (per_star / 6.0 * stars as f64).sqrt().clamp(COARSEST, most);
    (cells as usize).next_power_of_two()
}

#[cfg(test)]
mod tests;
