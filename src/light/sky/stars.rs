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
//! the coarsest squares across which W changes by a tenth at most. A camera whose velocity changes during the exposure is taken to have
//! that of its start, unless W differs from that twofold: then W_s = W_d.
//!
//! Rays come in blocks, most of which look into one small part of a face: the candidates there are found once for the whole block, and each
//! disc is tested against the rays of each eighth of it that comes near, in vector loops.

use std::sync::OnceLock;

use glam::DVec3;

use super::PixelAngles;
use super::faces::{Grid, Index, Rectangle};
use super::levels::{CHORD, DIAGONAL, FARTHEST, Level, Part, Place, Tally, raised};
use super::rays::{FEW, Rays};
use super::star::{Beaming, Motion, Star};
use crate::accel::vectors::{BLOCK, Columns, VectorLoop, dispatch};

/// sin R of a point divided by the width of a pixel: the zero of the fundamental.
const REACH: f64 = 1.4;
/// The decrease of sin² R per sin² ρ, such that R = ρ at 1.4/√1.36 = 1.2 pixels.
const LESS: f64 = 0.36;
/// The largest sin R of a level, 2 to the power of −1, and of a disc in the camera's frame.
const WIDEST: f64 = 0.5;
/// Its power of 2.
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
/// The maximum number of cells that rays look through together: in pictures, 64 rays mostly need fewer, and so do 8.
const MOST_CELLS: usize = 512;

/// Stars of one angular radius ρ: radiance E/(π sin² ρ) within it, or as given at the head of this file if pixels are wider than that.
#[derive(Debug)]
pub struct StarMap {
    stars: Vec<Star>,
    /// sin ρ, cos ρ, and 1/(π sin² ρ).
    sine: f64,
    cosine: f64,
    density: f64,
    /// The stars' discs by direction.
    discs: Index,
    /// Levels for widened discs, the finest first, each built on first use.
    levels: Vec<OnceLock<Level>>,
}

/// What one ray sees in the camera's frame: the cap of the world that the head of this file derives, s·axis > bound.
struct Cap {
    d: DVec3,
    /// W_d.
    ratio: f64,
    /// sin R.
    sine: f64,
    axis: DVec3,
    bound: f64,
    motion: Motion,
}

impl Cap {
    /// For the direction `d`, seen at the ratio `w`, and discs of this `sine` in the world.
    fn new(d: DVec3, w: f64, sine: f64, motion: Motion) -> Cap {
        let ratio = 1.0 / motion.inverse_ratio(d);
        // As for many rays together, in `levels`.
        let (motion, ratio) = match w > 0.5 * ratio && w < 2.0 * ratio {
            true => (motion, ratio),
            false => (Motion::REST, 1.0),
        };
        let sine = (sine * ratio).min(WIDEST);
        let square = sine * sine;
        let chord = 2.0 * square / (1.0 + (1.0 - square).sqrt());
        Cap {
            d,
            ratio,
            sine,
            axis: 2.0 * ratio * d + motion.n * (motion.sinh * chord),
            bound: 2.0 * ratio - chord * motion.gamma,
            motion,
        }
    }

    /// L/E of a star, and W_d/W_s.
    fn density(&self, star: DVec3) -> [f64; 2] {
        let x = self.ratio * self.motion.inverse_ratio(star);
        let chord = (star - self.d).length_squared() * (self.ratio * self.ratio / x);
        let square = self.sine * self.sine;
        let part = 1.0 - chord * (1.0 - 0.25 * chord) / square;
        let world = self.ratio * self.ratio / (std::f64::consts::PI * square);
        let is_seen = chord < 2.0 && part > 0.0;
        [
            if is_seen {
                5.0 * world * raised(part, 4)
            } else {
                0.0
            },
            x,
        ]
    }
}

/// Which rays look at a disc: 1 if so, else 0.
struct Within<'a> {
    rays: Rays<'a>,
    direction: DVec3,
    cosine: f64,
    within: &'a mut [u64; BLOCK],
    any: &'a mut u64,
}

impl VectorLoop for Within<'_> {
    #[inline(always)]
    fn run(self) {
        let [x, y, z] = self.rays.axes;
        let count = x.len().min(y.len()).min(z.len()).min(BLOCK);
        let (direction, cosine) = (self.direction, self.cosine);
        let (mut within, mut any) = ([0; BLOCK], 0);
        for k in 0..count {
            within[k] = u64::from(DVec3::new(x[k], y[k], z[k]).dot(direction) > cosine);
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
        let discs = Index::new(grid, stars.iter().map(|star| (star.direction, sine)));
        // Cells of a level are as wide as its largest sin R: 2/cells, starting from this and up to the widest.
        let finest = cells(stars.len(), PER_STAR_WIDENED, FINEST_WIDENED).ilog2() as i32;
        let levels = finest + WIDEST_POWER;
        StarMap {
            sine,
            cosine: libm::cos(radius),
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
            if d.dot(star.direction) > self.cosine {
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
        };
        let mut tally = Tally::default();
        let mut begin = 0;
        while begin < directions.len() {
            let end = directions.len().min(begin + BLOCK);
            // The whole block, groups of a few rays, or single rays.
            let mut see = |begin: usize, end: usize| {
                let light = |k: usize, star: &Star| light(begin + k, star);
                let each = |k: usize, radiance| each(begin + k, radiance);
                self.see(all.part(begin, end), &mut tally, light, each)
            };
            if !see(begin, end) {
                for few in (begin..end).step_by(FEW) {
                    let end = end.min(few + FEW);
                    if !see(few, end) {
                        (few..end).for_each(|one| {
                            see(one, one + 1);
                        });
                    }
                }
            }
            begin = end;
        }
    }

    /// [`StarMap::each_seen`] for up to a block of rays; does nothing and says so if these look into more than one face, through too many
    /// cells, see stars of more than one level, or too much for one.
    fn see(
        &self,
        rays: Rays,
        tally: &mut Tally,
        light: impl Fn(usize, &Star) -> [f64; 3],
        mut each: impl FnMut(usize, [f64; 3]),
    ) -> bool {
        let [[x, y, z, least], [far_x, far_y, far_z, greatest]] = rays.bounds();
        // Discs are widest where W is smallest.
        let reaches = [least, greatest].map(|w| self.reach(rays.pixel / w));
        let levels = reaches.map(|reach| (reach > self.sine).then(|| self.level_of(reach)));
        let Some(at) =
            Rectangle::of([x, y, z], [far_x, far_y, far_z]).filter(|_| levels[0] == levels[1])
        else {
            return false;
        };
        let most = if rays.len() > 1 {
            MOST_CELLS
        } else {
            usize::MAX
        };
        let Some(number) = levels[0] else {
            let rows = self.discs.rows(at.widened(self.sine), most);
            return rows
                .map(|rows| self.see_discs(rays, rows, light, each))
                .is_some();
        };
        let bound = self.reach_of(number);
        // The part of the way to their merged places that stars have left.
        let left = (2.0 - 2.0 * reaches[1] / bound).clamp(0.0, 1.0);
        let distance = distance(&rays, [least, greatest], reaches[0]).filter(|distance| {
            reaches[0] <= WIDEST && distance + left * DIAGONAL * bound <= FARTHEST
        });
        let Some(distance) = distance else {
            if rays.len() == 1 {
                let cap = Cap::new(rays.get(0), rays.ratios[0], reaches[0], rays.beaming.motion);
                let seen = self.in_cap(&cap, rays.beaming, |star| light(0, star));
                if seen != [0.0; 3] {
                    each(0, seen);
                }
            }
            return rays.len() == 1;
        };
        let level = self.level(number);
        let near = at.widened(distance + left * DIAGONAL * bound);
        let rows = level.index.rows(near, most);
        rows.map(|rows| {
            let mut rows = rows.skip_while(|row| row.is_empty()).peekable();
            if rows.peek().is_some() {
                tally.begin(rays, (self.sine, LESS, REACH), bound, (distance, left));
                rows.flatten().for_each(|family| tally.add(level, *family));
                tally.each_seen(level, &rays, light, each);
            }
        })
        .is_some()
    }

    /// The sum of the `light` in a cap.
    fn in_cap(&self, cap: &Cap, beaming: Beaming, light: impl Fn(&Star) -> [f64; 3]) -> [f64; 3] {
        let mut sum = [0.0; 3];
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
        let last = self.levels.len() - 1;
        let mut left: Vec<_> = (0u32..self.level(last).families.len() as u32)
            .map(|family| (last, family))
            .collect();
        while let Some((number, family)) = left.pop() {
            let (level, bound) = (self.level(number), self.reach_of(number));
            let family = &level.families[family as usize];
            let (place, size) = (&family.merged, DIAGONAL * bound);
            if place.direction.dot(cap.axis) + size * cap.axis.length() <= cap.bound {
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
    fn see_discs<'a>(
        &self,
        rays: Rays,
        rows: impl Iterator<Item = &'a [u32]>,
        light: impl Fn(usize, &Star) -> [f64; 3],
        mut each: impl FnMut(usize, [f64; 3]),
    ) {
        let (mut within, mut sums, mut seen) = ([0; BLOCK], [[0.0; 3]; BLOCK], 0u64);
        for &number in rows.flatten() {
            let star = &self.stars[number as usize];
            let mut any = 0;
            dispatch(Within {
                rays,
                direction: star.direction,
                cosine: self.cosine,
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
        while seen != 0 {
            let k = seen.trailing_zeros() as usize;
            seen &= seen - 1;
            each(k, sums[k]);
        }
    }

    /// sin R for pixels of this width; sin ρ or less if discs are not widened.
    #[inline(always)]
    fn reach(&self, pixel: f64) -> f64 {
        let point = REACH * pixel;
        let square = point * point - LESS * self.sine * self.sine;
        square.max(0.0).sqrt()
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
    let (motion, point) = (rays.beaming.motion, CHORD * REACH * rays.pixel);
    let (mut steep, mut bent) = (0.0, 0.0);
    if motion.sinh > 0.0 {
        // r² g² and r² k, where they are largest for 1/W in this range.
        let (square, gamma) = (point * point, motion.gamma);
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
mod tests {
    use super::super::levels::Family;
    use super::*;
    use crate::spacetime::{Boost, CameraFrame, Direction, Velocity, World};

    /// What is seen along each of `directions`, for pixels of these widths there.
    fn seen(
        map: &StarMap,
        directions: &[DVec3],
        pixels: &[f64],
        light: impl Fn(&Star) -> [f64; 3],
    ) -> Vec<[f64; 3]> {
        let mut columns = Columns::default();
        directions.iter().for_each(|d| columns.push(*d));
        let ratios: Vec<_> = pixels.iter().map(|pixel| 1.0 / pixel).collect();
        let angles = PixelAngles {
            angle: 0.0,
            pixel: 1.0,
            ratios: &ratios,
            beaming: Beaming::REST,
        };
        let mut seen = vec![[0.0; 3]; directions.len()];
        map.each_seen(
            &columns,
            angles,
            |_, star| light(star),
            |k, light| {
                seen[k] = light;
            },
        );
        seen
    }

    /// The same for one direction, with discs of this sin R.
    fn widened(map: &StarMap, d: DVec3, reach: f64, light: impl Fn(&Star) -> [f64; 3]) -> [f64; 3] {
        let pixel = (reach * reach + LESS * map.sine * map.sine).sqrt() / REACH;
        seen(map, &[d], &[pixel], light)[0]
    }

    #[test]
    fn directions_see_the_stars_in_whose_discs_they_lie_alone_and_in_blocks() {
        let mut next = numbers(3);
        let mut vector = || DVec3::new(next(), next(), next()).normalize();
        let stars: Vec<_> = (0..3000)
            .map(|_| Star::new(vector(), 5000.0, 1.0))
            .collect();
        // As small as discs may be, and as wide as some pixels.
        for radius in [1e-9, 7e-4, 0.03] {
            let map = StarMap::new(stars.clone(), radius);
            // Rows of a picture, some with a star in them, and directions all over the sky.
            let directions: Vec<_> = (0..5000)
                .map(|k| match k / 64 % 3 {
                    0 => (stars[k % 3000].direction + vector() * radius).normalize(),
                    1 => vector(),
                    _ => {
                        let star = stars[k / 64].direction;
                        let side = star.any_orthonormal_vector();
                        (star + side * (k % 64) as f64 * radius / 40.0).normalize()
                    }
                })
                .collect();
            let together = seen(&map, &directions, &vec![1e-12; 5000], |_| [1.0; 3]);
            let mut lit = 0;
            for (d, together) in directions.iter().zip(together) {
                let within = stars.iter().filter(|s| d.dot(s.direction) > map.cosine);
                let expected = within.count() as f64 * map.density;
                assert!(
                    (together[0] - expected).abs() <= 1e-12 * expected,
                    "{radius} {d}"
                );
                assert_eq!(together, map.radiance(*d, |_| [1.0; 3]), "{radius} {d}");
                lit += usize::from(expected > 0.0);
            }
            assert!(radius < 1e-6 || lit > 1000, "{lit}");
        }
    }

    #[test]
    fn a_disc_that_ends_before_the_edge_of_a_cell_is_found_beyond_it() {
        const RADIUS: f64 = 3e-7;
        // On the face z = 1, where x = 0 is an edge between cells: directions just before it, each with a star whose disc ends just beyond
        // the direction. Near x = 0 an angle is du / √(1 + y²).
        let places = (0..2000).map(|k| {
            let (before, y) = (
                (f64::from(k) + 0.5) / 2000.0 * 4e-8,
                0.3 + f64::from(k) * 1e-4,
            );
            let along = |x: f64| DVec3::new(-x, y, 1.0).normalize();
            let star = along(before + 0.98 * RADIUS * (1.0 + y * y).sqrt());
            (along(before), Star::new(star, 5000.0, 1.0))
        });
        let (directions, stars): (Vec<_>, Vec<_>) = places.unzip();
        let map = StarMap::new(stars, RADIUS);
        for d in directions {
            assert!(map.radiance(d, |_| [1.0; 3]) != [0.0; 3], "{d}");
        }
    }

    #[test]
    fn every_direction_finds_the_stars_that_it_lies_in() {
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let mut vector = || DVec3::new(next(), next(), next()).normalize();
        let stars: Vec<_> = (0..400).map(|_| Star::new(vector(), 5000.0, 1.0)).collect();
        for radius in [1e-4, 0.01, 0.087] {
            let map = StarMap::new(stars.clone(), radius);
            for k in 0..4000 {
                let near = stars[k % stars.len()].direction;
                let d = (near + vector() * (radius * 1.2)).normalize();
                let lies_in = |s: &&Star| d.dot(s.direction) > libm::cos(radius);
                let count = stars.iter().filter(lies_in).count() as f64;
                let found = map.radiance(d, |_| [0.0, 1.0, 0.0])[1] / map.density;
                assert!(
                    (found - count).abs() < 1e-9,
                    "{radius} {d}: {found} {count}"
                );
            }
        }
    }

    /// Numbers from −1 to 1.
    fn numbers(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    /// Directions within some distance of −Z in the plane at distance one, and within a cap of the same size.
    fn cap(count: usize, half: f64, seed: u64) -> Vec<DVec3> {
        let mut next = numbers(seed);
        let direction = |_| DVec3::new(half * next(), half * next(), -1.0).normalize();
        (0..count).map(direction).collect()
    }

    fn stars_at(directions: &[DVec3], seed: u64) -> Vec<Star> {
        let mut next = numbers(seed);
        let star = |d: &DVec3| {
            let (kelvin, magnitude) = (3000.0 * 4f64.powf(next().abs()), 2.5 * next());
            Star::new(*d, kelvin, 10f64.powf(-0.4 * magnitude))
        };
        directions.iter().map(star).collect()
    }

    /// L/E as given at the head of this file.
    fn density(sine: f64, reach: f64, d: DVec3, middle: DVec3) -> f64 {
        let s = d.cross(middle).length_squared() / (reach * reach);
        let q = (sine / reach).powi(2);
        match d.dot(middle) > 0.0 && s < 1.0 {
            true => {
                let fall = 5.0 * (1.0 - q * q) * (1.0 - s).powi(4) + q * q;
                fall / (std::f64::consts::PI * reach * reach)
            }
            false => 0.0,
        }
    }

    /// Sums over pixel centres are within 0.4 % of the integral: the contribution of the second ring of harmonics at the first one's zero.
    #[test]
    fn pixel_centres_keep_the_light_of_a_star_wherever_it_lies_among_them() {
        const PIXEL: f64 = 1e-3;
        for radius in [1e-7, 1e-4] {
            for k in 0..144 {
                let at = |k: usize| (k as f64 / 12.0 + 0.3) * PIXEL;
                let star = DVec3::new(at(k % 12), at(k / 12), -1.0).normalize();
                let map = StarMap::new(vec![Star::new(star, 5000.0, 2.0)], radius);
                let centres = (0..100).map(|n| {
                    let at = |n: i32| f64::from(n - 5) * PIXEL;
                    DVec3::new(at(n % 10), at(n / 10), -1.0).normalize()
                });
                let centres: Vec<_> = centres.collect();
                let seen = seen(&map, &centres, &[PIXEL; 100], |star| [star.luminance(); 3]);
                let light = seen.iter().map(|seen| seen[0]).sum::<f64>() * PIXEL * PIXEL;
                assert!((light / 2.0 - 1.0).abs() < 4e-3, "{radius} {k}: {light}");
            }
        }
    }

    /// At a width of 1.2 pixels: sin² R = 1.96 a² − 0.36 sin² ρ = sin² ρ.
    #[test]
    fn wide_discs_are_as_they_were_and_become_wider_without_a_step() {
        const RADIUS: f64 = 1e-3;
        let map = StarMap::new(vec![Star::new(DVec3::NEG_Z, 5000.0, 1.0)], RADIUS);
        let edge = RADIUS.sin() * 1.36f64.sqrt() / 1.4;
        let expected = 1.0 / (std::f64::consts::PI * RADIUS.sin().powi(2));
        for part in [0.0, 0.3, 0.9, 0.99999, 1.00001] {
            let d = DVec3::new(
                part * RADIUS.sin(),
                0.0,
                -(1.0 - (part * RADIUS.sin()).powi(2)).sqrt(),
            );
            let at = |pixel| seen(&map, &[d], &[pixel], |star| [star.luminance(); 3])[0][0];
            // The same bits up to there, and only a little less beyond.
            let (narrow, wide) = (at(edge * (1.0 - 1e-9)), at(edge * (1.0 + 1e-9)));
            assert_eq!(narrow, at(1e-12));
            assert!((narrow - if part < 1.0 { expected } else { 0.0 }).abs() < 1e-6 * expected);
            assert!(
                (wide - narrow).abs() < 1e-6 * expected,
                "{part}: {narrow} {wide}"
            );
            assert!(at(edge * 1.1) > 0.0);
        }
    }

    #[test]
    fn levels_meet_without_a_step_and_find_all_that_they_hold() {
        let stars = stars_at(&cap(20_000, 0.6, 5), 6);
        let map = StarMap::new(stars, 1e-6);
        let light = |star: &Star| star.colour(0.7);
        let mut merged = 0;
        for number in 0..map.levels.len() {
            let bound = map.reach_of(number);
            assert_eq!(map.level_of(bound), number);
            assert_eq!(map.level_of(0.501 * bound), number);
            let level = map.level(number);
            merged += level.members.len();
            // The sum over all places on their way, without using the lists.
            let reach = 0.8 * bound;
            let profile = |d: DVec3, middle: DVec3| density(map.sine, reach, d, middle);
            let all = level.families.iter().flat_map(
                |Family {
                     merged, members, ..
                 }| {
                    let members = &level.members[members.start as usize..members.end as usize];
                    let moved = members.iter().map(|m| {
                        let between = m.direction.lerp(merged.direction, 0.6);
                        (between.normalize(), m.parts.clone())
                    });
                    let itself = (merged.direction, merged.parts.clone());
                    moved.chain(members.is_empty().then_some(itself))
                },
            );
            let all: Vec<_> = all.collect();
            for d in cap(150, 1.5, number as u64) {
                let found = widened(&map, d, reach, |star| [star.luminance(); 3])[0];
                let mut expected = 0.0;
                for (place, parts) in &all {
                    let density = profile(d, *place);
                    let parts = &level.parts[parts.start as usize..parts.end as usize];
                    expected += density * parts.iter().map(|part| part.luminance).sum::<f64>();
                }
                assert!(
                    (found - expected).abs() <= 1e-9 * expected,
                    "{number} {d}: {found} {expected}"
                );
                // The end of this level, and the start of the next.
                if number + 1 < map.levels.len() {
                    let (last, first) = (
                        widened(&map, d, bound, light),
                        widened(&map, d, bound * (1.0 + 1e-12), light),
                    );
                    for (last, first) in last.iter().zip(first) {
                        assert!(
                            (last - first).abs() <= 1e-6 * last.abs(),
                            "{number} {d}: {last} {first}"
                        );
                    }
                }
            }
        }
        assert!(merged > 20_000, "{merged}");
    }

    #[test]
    fn merged_stars_shine_as_all_of_them() {
        let stars = stars_at(&cap(40_000, 1.0, 7), 8);
        let map = StarMap::new(stars.clone(), 1e-6);
        for w in [0.02, 0.3, 1.0] {
            for reach in [0.02, 0.11, 0.3] {
                let profile = |d: DVec3, middle: DVec3| density(map.sine, reach, d, middle);
                let (mut off, mut more, mut whole) = (0.0, 0.0, 0.0);
                for d in cap(300, 0.4, 9) {
                    let found = widened(&map, d, reach, |star| star.colour(w));
                    let mut expected = [0.0; 3];
                    for star in &stars {
                        let density = profile(d, star.direction);
                        if density > 0.0 {
                            for (sum, e) in expected.iter_mut().zip(star.colour(w)) {
                                *sum += e * density;
                            }
                        }
                    }
                    for (found, expected) in found.iter().zip(expected) {
                        off += (found - expected).abs();
                        more += found - expected;
                        whole += expected;
                    }
                }
                // Merging within a square makes most of that; the total light is conserved.
                assert!(off < 0.05 * whole, "{w} {reach}: {off} of {whole}");
                assert!(more.abs() < 0.01 * whole, "{w} {reach}: {more} of {whole}");
            }
        }
        // However many stars there are: 6 · 16² squares of the last level, each of at most 15 steps from 3000 to 12000 K.
        let last = map.level(map.levels.len() - 1);
        assert!(last.families.len() <= 6 * 256, "{}", last.families.len());
        for Family { merged, .. } in &last.families {
            assert!(merged.parts.len() <= 15, "{}", merged.parts.len());
        }
    }

    /// Blocks in which W changes by little and by much, within one level and across several.
    #[test]
    fn directions_see_the_same_in_blocks_as_alone_in_pixels_of_any_width() {
        let stars = stars_at(&cap(3000, 1.0, 11), 12);
        let map = StarMap::new(stars, 1e-4);
        let scattered = cap(2000, 1.0, 13);
        let rows = (0..2000).map(|k| {
            let (x, y) = (f64::from(k % 64), f64::from(k / 64));
            DVec3::new(0.003 * (x - 20.0), 0.003 * (y - 10.0), -1.0).normalize()
        });
        for directions in [scattered, rows.collect()] {
            for growth in [1.0, 1.0 + 1e-5, 1.005] {
                let pixel = |k: usize| 0.004 * f64::powi(growth, k as i32 - 1000);
                let pixels: Vec<_> = (0..directions.len()).map(pixel).collect();
                let colour = |star: &Star| star.colour(0.8);
                let together = seen(&map, &directions, &pixels, colour);
                let mut lit = 0;
                for ((d, pixel), together) in directions.iter().zip(&pixels).zip(together) {
                    assert_eq!(
                        seen(&map, &[*d], &[*pixel], colour)[0],
                        together,
                        "{d} {pixel}"
                    );
                    lit += usize::from(together != [0.0; 3]);
                }
                assert!(lit > 50, "{growth}: {lit}");
            }
        }
    }

    /// The radiance that a camera sees along directions of its own frame, of channels if `channels`, and otherwise of blackbodies.
    fn seen_from(
        map: &StarMap,
        camera: &Boost<World, CameraFrame>,
        own: &[DVec3],
        pixel: f64,
        channels: bool,
    ) -> Vec<f64> {
        let looks = own
            .iter()
            .map(|d| camera.direction(Direction::from_unit(*d)));
        let (directions, ratios): (Vec<_>, Vec<_>) = looks.map(|(d, w)| (d.unit(), w)).unzip();
        let mut columns = Columns::default();
        columns.take(&directions);
        let angles = PixelAngles {
            angle: 0.0,
            pixel,
            ratios: &ratios,
            beaming: Beaming {
                motion: Motion::of(camera),
                power: if channels { 2 } else { -2 },
                channels,
                shifted: true,
            },
        };
        let light = |k: usize, star: &Star| match channels {
            true => star.channels(),
            false => star.colour(ratios[k]),
        };
        let mut seen = vec![0.0; own.len()];
        map.each_seen(&columns, angles, light, |k, [r, _, _]| {
            seen[k] = r * if channels { ratios[k].powi(-4) } else { 1.0 };
        });
        seen
    }

    /// Against the sum over all stars in the camera's frame: of the aberrated direction of each, its light W² Ω B(λ; T/W) or W⁻² times its
    /// channels, and the profile around it.
    #[test]
    fn pixels_of_any_width_see_all_stars_where_they_are_at_any_speed() {
        let mut next = numbers(21);
        let vectors: Vec<_> = (0..3000)
            .map(|_| DVec3::new(next(), next(), next()).normalize())
            .collect();
        let stars = stars_at(&vectors, 22);
        let map = StarMap::new(stars.clone(), 1e-5);
        // Near the equator, where the pixels of the panorama are square.
        let ahead = DVec3::new(0.6, 0.02, -0.8).normalize();
        let side = ahead.any_orthonormal_vector();
        for gamma in [1.0, 3.0, 10.0, 30.0, 100.0, 1e3, 1e5] {
            let velocity = Velocity::from_gamma(gamma, ahead).unwrap();
            let camera = Boost::<World, CameraFrame>::new(velocity);
            for (degrees, channels) in [0.1f64, 1.0, 5.0]
                .into_iter()
                .flat_map(|degrees| [(degrees, true), (degrees, false)])
            {
                let pixel = degrees.to_radians();
                let images = stars.iter().map(|star| {
                    let d = Direction::from_unit(star.direction);
                    let (d, inverse) = camera.inverse().direction(d);
                    let w = 1.0 / inverse;
                    let light = match channels {
                        true => star.channels()[0] / (w * w),
                        false => star.colour(w)[0] * (w * w),
                    };
                    (d.unit(), light)
                });
                let images: Vec<_> = images.collect();
                // Pixels about the direction of motion, and at 5° all around, which see all light.
                let own: Vec<_> = match degrees {
                    5.0 => (0..72 * 36)
                        .map(|k| {
                            let (at, up) = (f64::from(k % 72) + 0.5, f64::from(k / 72) + 0.5);
                            let ((s, c), (sin, cos)) =
                                ((at * pixel).sin_cos(), (up * pixel).sin_cos());
                            DVec3::new(s * sin, cos, c * sin)
                        })
                        .collect(),
                    _ => (0..600)
                        .map(|k| {
                            let at = |n: i32| (f64::from(n) - 11.3) * pixel;
                            let across = side * at(k % 24) + ahead.cross(side) * at(k / 24);
                            (ahead + across).normalize()
                        })
                        .collect(),
                };
                let seen = seen_from(&map, &camera, &own, pixel, channels);
                let reach = REACH * pixel;
                let (mut off, mut more, mut all, mut light) = (0.0, 0.0, 0.0, 0.0);
                for (d, seen) in own.iter().zip(seen) {
                    let sum = |sum, (s, light): &(DVec3, f64)| {
                        sum + light * density(map.sine, reach, *d, *s)
                    };
                    let expected = images.iter().fold(0.0, sum);
                    (off, more) = (off + (seen - expected).abs(), more + seen - expected);
                    all += expected;
                    light += seen * pixel * (0.5 * pixel).sin() * 2.0 * d.x.hypot(d.z);
                }
                let case = format!("{gamma} {degrees} {channels}");
                assert!(off < 0.1 * all, "{case}: {off} of {all}");
                assert!(more.abs() < 0.01 * all, "{case}: {more} of {all}");
                if degrees == 5.0 {
                    let whole: f64 = images.iter().map(|(_, light)| light).sum();
                    assert!(
                        (light / whole - 1.0).abs() < 0.01,
                        "{case}: {light} of {whole}"
                    );
                }
            }
        }
    }
}
