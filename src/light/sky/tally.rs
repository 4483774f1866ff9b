//! What a block of rays sees of the stars of a level, widened to about a pixel.
//!
//! Implements the derivation at the head of `stars`: the profile of a widened disc, and sums of similar stars.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::levels::{Family, Level, NearFamily, Place, Sums};
use super::rays::{Bounds, Rays};
use super::star::{Beaming, Star, raised};
use crate::accel::vectors::{BLOCK, Block, VectorLoop, dispatch};

/// Parts of a block that are looked at only if they are near.
const EIGHTHS: usize = 8;
const LANES: usize = BLOCK / EIGHTHS;

/// The bit of the eighth of each ray.
const EIGHTH: [u64; BLOCK] = {
    let mut bits = [0; BLOCK];
    let mut k = 0;
    while k < BLOCK {
        bits[k] = 1 << (k / LANES);
        k += 1;
    }
    bits
};

/// Numbers of an eighth of a block, and of a block.
type Lanes = [f64; LANES];
type Eighths = [Lanes; EIGHTHS];

/// How discs are widened for some rays, ray by ray.
#[derive(Debug, Default)]
struct Profiles {
    directions: [Eighths; 3],
    /// sin² R, 0 past the last ray, and its inverse.
    squares: Eighths,
    inverses: Eighths,
    /// L/E is the sum of the first, times (1 − s)⁴, and the second, uniform one.
    densities: Eighths,
    evens: Eighths,
    /// The fraction of the way of stars to their places on the next level.
    ways: Eighths,
    /// The gradient of 1/W along the motion, times W; the motion's direction; and W²/4.
    slopes: Eighths,
    motions: [Eighths; 3],
    quarters: Eighths,
}

/// How far rays see on a level.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight {
    /// sin ρ, and how sin² R decreases with its square and increases with the width of pixels, as at the head of `stars`.
    pub widths: (f64, f64, f64),
    /// The largest sin R of the level.
    pub most: f64,
    /// An upper bound of the chord at which rays see stars, and of the part of the way to their merged places that these have left.
    pub distance: f64,
    pub left: f64,
}

impl Sight {
    /// Nothing is seen.
    const NONE: Sight = Sight {
        widths: (0.0, 0.0, 0.0),
        most: 1.0,
        distance: 0.0,
        left: 0.0,
    };
}

/// A family that rays may see.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    number: u32,
    /// Its merged place, and an upper bound of the distance from there at which rays see a member.
    middle: DVec3,
    farthest: f64,
}

impl Candidate {
    #[inline(always)]
    pub fn new(near: &NearFamily, sight: &Sight) -> Candidate {
        // No member is farther from the merged place than the rest of the way.
        Candidate {
            number: near.number,
            middle: near.middle,
            farthest: sight.distance + sight.left * near.spread,
        }
    }

    /// Whether a direction within `bounds` may see it.
    #[inline(always)]
    pub fn is_near(&self, bounds: &Bounds) -> bool {
        bounds.is_near(self.middle, self.farthest)
    }
}

impl Profiles {
    /// L/E along the ray in a lane of an eighth, of a star at `middle`, and W_d/W_s.
    #[inline(always)]
    fn density(&self, eighth: usize, lane: usize, middle: DVec3) -> [f64; 2] {
        let [x, y, z] = &self.directions;
        let d = DVec3::new(x[eighth][lane], y[eighth][lane], z[eighth][lane]);
        let quarter = self.quarters[eighth][lane];
        // W_d/W_s, and c² = c_world² W_d W_s of the chord c in the camera's frame, all over W_d²: sin² θ = c² (1 − c²/4), in front if
        // c² < 2.
        let away = middle - d;
        let [x, y, z] = &self.motions;
        let n = DVec3::new(x[eighth][lane], y[eighth][lane], z[eighth][lane]);
        let ratio = 1.0 + self.slopes[eighth][lane] * away.dot(n);
        let chord = away.length_squared() / ratio;
        let left = self.squares[eighth][lane] - chord * (1.0 - quarter * chord);
        let part = left * self.inverses[eighth][lane];
        let square = part * part;
        let density = self.densities[eighth][lane] * (square * square) + self.evens[eighth][lane];
        let seen = if (quarter * chord < 0.5) & (left > 0.0) {
            density
        } else {
            0.0
        };
        [seen, ratio]
    }
}

/// Copies the directions of a block, and finds which of its eighths may see each candidate, as bit masks.
struct Approach<'a> {
    rays: Rays<'a>,
    candidates: &'a [Candidate],
    directions: &'a mut [Eighths; 3],
    near: &'a mut [u64],
}

impl VectorLoop for Approach<'_> {
    #[inline(always)]
    fn run(self) {
        let eighths = self.rays.len().div_ceil(LANES).min(EIGHTHS);
        for (directions, column) in self.directions.iter_mut().zip(self.rays.axes) {
            for (eighth, directions) in directions[..eighths].iter_mut().enumerate() {
                *directions = lanes(column, eighth * LANES);
            }
        }
        let whole = |axis: &Eighths| axis.as_flattened().first_chunk().copied();
        let [Some(x), Some(y), Some(z)] = self.directions.each_ref().map(whole) else {
            return;
        };
        let (x, y, z): (Block, Block, Block) = (x, y, z);
        // Eighths past the last ray hold old directions: they see nothing.
        let all = u64::MAX >> (u64::BITS - eighths as u32);
        for (candidate, near) in self.candidates.iter().zip(self.near) {
            let (middle, most) = (candidate.middle, candidate.farthest * candidate.farthest);
            let mut any = 0;
            for k in 0..BLOCK {
                let square = (middle - DVec3::new(x[k], y[k], z[k])).length_squared();
                any |= u64::from(square <= most).wrapping_neg() & EIGHTH[k];
            }
            *near = any & all;
        }
    }
}

/// Computes the profiles of discs for some eighths of a block, whose rays have their `OWN` motions or share one.
struct Widen<'a, const OWN: bool> {
    rays: Rays<'a>,
    sight: Sight,
    /// A bit mask.
    eighths: u64,
    to: &'a mut Profiles,
}

impl<const OWN: bool> VectorLoop for Widen<'_, OWN> {
    #[inline(always)]
    fn run(self) {
        let Widen { rays, to, .. } = self;
        let (sine, less, reach) = self.sight.widths;
        let (square_of_sine, twice) = (sine * sine, 2.0 / self.sight.most);
        let (count, shared) = (rays.len(), rays.beaming.motion);
        let mut left = self.eighths;
        while left != 0 {
            let eighth = left.trailing_zeros() as usize % EIGHTHS;
            left &= left - 1;
            let begin = eighth * LANES;
            let [x, y, z] = to.directions.map(|axis| axis[eighth]);
            let ratios = lanes(rays.ratios, begin);
            for lane in 0..LANES {
                // sin² R = (1.4 a/W)² − 0.36 sin² ρ, and q² and the densities that follow from it.
                let point = reach * rays.pixel / ratios[lane];
                let square = point * point - less * square_of_sine;
                let inverse = 1.0 / square;
                let q = square_of_sine * inverse;
                let even = q * q * inverse * FRAC_1_PI;
                // Nothing is seen past the last ray.
                let is_ray = lane < count - begin;
                to.squares[eighth][lane] = if is_ray { square } else { 0.0 };
                to.inverses[eighth][lane] = inverse;
                to.densities[eighth][lane] = 5.0 * (inverse * FRAC_1_PI - even);
                to.evens[eighth][lane] = even;
                // 0 up to half of the level's largest sin R, and 1 at that.
                let way = twice * square.sqrt() - 1.0;
                to.ways[eighth][lane] = if way > 0.0 { way } else { 0.0 };
                let d = DVec3::new(x[lane], y[lane], z[lane]);
                let motion = if OWN {
                    rays.motion(begin + lane)
                } else {
                    shared
                };
                let ratio = 1.0 / motion.inverse_ratio(d);
                // An element of a turning sensor may have another motion: no change of W is known.
                let is_own = (ratios[lane] > 0.5 * ratio) & (ratios[lane] < 2.0 * ratio);
                to.slopes[eighth][lane] = if is_own { motion.sinh * ratio } else { 0.0 };
                to.motions[0][eighth][lane] = motion.n.x;
                to.motions[1][eighth][lane] = motion.n.y;
                to.motions[2][eighth][lane] = motion.n.z;
                to.quarters[eighth][lane] = 0.25 * ratio * ratio;
            }
        }
    }
}

/// Numbers from `begin` on; past the end, the last again.
#[inline(always)]
fn lanes(column: &[f64], begin: usize) -> Lanes {
    match column[begin..].first_chunk() {
        Some(lanes) => *lanes,
        None => {
            let mut lanes = [column[column.len() - 1]; LANES];
            for (lane, x) in lanes.iter_mut().zip(&column[begin..]) {
                *lane = *x;
            }
            lanes
        }
    }
}

/// L/E of a place for the rays of some eighths of a block, W_d/W_s for each, and a bit mask of the eighths in which any L is above 0.
struct Densities<'a> {
    profiles: &'a Profiles,
    place: &'a Place,
    /// The place it moves to; `None` for one that stays.
    merged: Option<&'a Place>,
    near: u64,
    densities: &'a mut Eighths,
    ratios: &'a mut Eighths,
    eighths: &'a mut u64,
}

impl VectorLoop for Densities<'_> {
    #[inline(always)]
    fn run(self) {
        let profiles = self.profiles;
        let mut left = self.near;
        while left != 0 {
            let eighth = left.trailing_zeros() as usize % EIGHTHS;
            left &= left - 1;
            let (mut densities, mut ratios) = ([0.0; LANES], [0.0; LANES]);
            match self.merged {
                None => {
                    for lane in 0..LANES {
                        let middle = self.place.direction;
                        [densities[lane], ratios[lane]] = profiles.density(eighth, lane, middle);
                    }
                }
                Some(merged) => {
                    for lane in 0..LANES {
                        let middle = self.place.towards(merged, profiles.ways[eighth][lane]);
                        [densities[lane], ratios[lane]] = profiles.density(eighth, lane, middle);
                    }
                }
            }
            let mut any = 0;
            for density in &densities {
                any |= u64::from(*density > 0.0);
            }
            *self.eighths |= any << eighth;
            (self.densities[eighth], self.ratios[eighth]) = (densities, ratios);
        }
    }
}

/// What some rays see of a level, ray by ray.
#[derive(Debug)]
pub(super) struct Tally {
    beaming: Beaming,
    sight: Sight,
    /// Families that the rays may see, with bit masks of the eighths that may.
    candidates: Vec<Candidate>,
    near: Vec<u64>,
    /// Profiles of the eighths in this bit mask, the ones that were needed.
    profiles: Box<Profiles>,
    widened: u64,
    densities: Eighths,
    ratios: Eighths,
    /// Bit masks of the rays that see anything, and of those that see more than one part.
    some: u64,
    many: u64,
    /// The first part that a ray sees, L/E and W_s/W_d; for rays that see more, the index of their sums.
    first: [(u32, f64, f64); BLOCK],
    slots: [u8; BLOCK],
    sums: Vec<Sums>,
    /// The sums of channels.
    channels: [[f64; 3]; BLOCK],
}

impl Default for Tally {
    fn default() -> Self {
        Tally {
            beaming: Beaming::REST,
            sight: Sight::NONE,
            candidates: Vec::new(),
            near: Vec::new(),
            profiles: Box::default(),
            widened: 0,
            densities: Eighths::default(),
            ratios: Eighths::default(),
            some: 0,
            many: 0,
            first: [(0, 0.0, 0.0); BLOCK],
            slots: [0; BLOCK],
            sums: Vec::new(),
            channels: [[0.0; 3]; BLOCK],
        }
    }
}

impl Tally {
    /// Adds up what `rays` see of those of `candidates` that are near; returns whether any are.
    pub fn add(
        &mut self,
        level: &Level,
        rays: Rays,
        sight: Sight,
        candidates: impl Iterator<Item = Candidate>,
    ) -> bool {
        self.candidates.clear();
        self.candidates.extend(candidates);
        if self.candidates.is_empty() {
            return false;
        }
        (self.some, self.many, self.widened) = (0, 0, 0);
        (self.beaming, self.sight) = (rays.beaming, sight);
        self.near.resize(self.candidates.len(), 0);
        dispatch(Approach {
            rays,
            candidates: &self.candidates,
            directions: &mut self.profiles.directions,
            near: &mut self.near,
        });
        for k in 0..self.candidates.len() {
            if self.near[k] != 0 {
                let family = &level.families[self.candidates[k].number as usize];
                self.add_family(level, &rays, self.near[k], family);
            }
        }
        true
    }

    fn add_family(&mut self, level: &Level, rays: &Rays, near: u64, family: &Family) {
        // Profiles depend on the rays and the level only: each eighth needs them once for all families.
        let new = near & !self.widened;
        if new != 0 {
            self.widened |= new;
            match rays.motions {
                [] => self.widen::<false>(rays, new),
                _ => self.widen::<true>(rays, new),
            }
        }
        if family.members.is_empty() {
            return self.add_place(level, near, &family.merged, None);
        }
        for member in &level.members[family.members.start as usize..family.members.end as usize] {
            self.add_place(level, near, member, Some(&family.merged));
        }
    }

    fn widen<const OWN: bool>(&mut self, rays: &Rays, eighths: u64) {
        dispatch(Widen::<OWN> {
            rays: *rays,
            sight: self.sight,
            eighths,
            to: &mut self.profiles,
        });
    }

    fn add_place(&mut self, level: &Level, near: u64, place: &Place, merged: Option<&Place>) {
        let mut eighths = 0;
        dispatch(Densities {
            profiles: &self.profiles,
            place,
            merged,
            near,
            densities: &mut self.densities,
            ratios: &mut self.ratios,
            eighths: &mut eighths,
        });
        while eighths != 0 {
            let eighth = eighths.trailing_zeros() as usize % EIGHTHS;
            eighths &= eighths - 1;
            for lane in 0..LANES {
                let (ray, density) = (eighth * LANES + lane, self.densities[eighth][lane]);
                if density > 0.0 {
                    let ratio = self.ratios[eighth][lane];
                    let density = density * raised(ratio, self.beaming.power);
                    match self.beaming.channels {
                        true => self.add_channels(ray, place, density),
                        false => {
                            let ratio = if self.beaming.shifted {
                                1.0 / ratio
                            } else {
                                1.0
                            };
                            let parts = place.parts.clone();
                            parts
                                .for_each(|part| self.add_part(level, ray, part, (density, ratio)));
                        }
                    }
                }
            }
        }
    }

    #[inline]
    fn add_channels(&mut self, ray: usize, place: &Place, density: f64) {
        let bit = 1 << ray;
        let before = if self.some & bit == 0 {
            [0.0; 3]
        } else {
            self.channels[ray]
        };
        self.some |= bit;
        self.channels[ray] =
            std::array::from_fn(|c| before[c] + density * f64::from(place.channels[c]));
    }

    /// A single part stays as it is; several are summed.
    #[inline]
    fn add_part(&mut self, level: &Level, ray: usize, number: u32, (density, ratio): (f64, f64)) {
        let part = &level.parts[number as usize];
        let bit = 1 << ray;
        if self.some & bit == 0 {
            self.some |= bit;
            self.first[ray] = (number, density, ratio);
            return;
        }
        if self.many & bit == 0 {
            let slot = self.many.count_ones() as usize;
            self.many |= bit;
            self.slots[ray] = slot as u8;
            match self.sums.get_mut(slot) {
                Some(sums) => sums.clear(),
                None => self.sums.push(Sums::none()),
            }
            let (number, density, ratio) = self.first[ray];
            self.sums[slot].add(&level.parts[number as usize], density, ratio);
        }
        self.sums[self.slots[ray] as usize].add(part, density, ratio);
    }

    /// Calls `each` with each ray that sees light, and with the sum of the `light` of the stars it sees, with solid angles scaled so that
    /// their irradiance is the radiance seen.
    pub fn each_seen(
        &self,
        level: &Level,
        rays: &Rays,
        light: impl Fn(usize, &Star) -> [f64; 3],
        mut each: impl FnMut(usize, [f64; 3]),
    ) {
        let mut left = self.some;
        while left != 0 {
            let ray = left.trailing_zeros() as usize;
            left &= left - 1;
            if self.beaming.channels {
                each(ray, self.channels[ray]);
                continue;
            }
            let direction = rays.get(ray);
            let mut sum = [0.0; 3];
            let mut shine = |star: Star| {
                for (sum, e) in sum.iter_mut().zip(light(ray, &star)) {
                    *sum += e;
                }
            };
            // Several parts were summed; a single one is the star itself.
            if self.many >> ray & 1 == 1 {
                let sums = &self.sums[self.slots[ray] as usize];
                sums.parts().for_each(|part| shine(part.star(direction)));
            } else {
                let (number, density, ratio) = self.first[ray];
                let part = &level.parts[number as usize];
                if part.luminance > 0.0 {
                    let star = part.star(direction);
                    shine(Star {
                        solid_angle: part.solid_angle * density,
                        temperature: star.temperature / ratio,
                        ..star
                    });
                }
            }
            each(ray, sum);
        }
    }
}
