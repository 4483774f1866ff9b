//! Stars seen by pixels wider than their discs: spread over about a pixel, and merged where one pixel holds many.
//!
//! Implements the derivation at the head of `stars`: the profile of a widened disc, levels for discs up to some width, and sums of similar
//! stars.

use std::f64::consts::FRAC_1_PI;
use std::ops::Range;

use glam::DVec3;

use super::faces::{Grid, Index};
use super::rays::Rays;
use super::star::{Star, luminance};
use crate::accel::vectors::{BLOCK, Block, VectorLoop, dispatch};

/// Step of 1/T for merging stars, 1/K: ½ in c₂/(λT), at 0.55 µm.
const STEP: f64 = 0.5 * 0.55e-6 / 1.438_777e-2;
/// Number of steps, down to 817 K; colder stars are in the last.
const STEPS: usize = 64;
/// An eighth of a block.
const LANES: usize = BLOCK / 8;
/// An upper bound of a chord of up to 30° divided by the sine of its angle.
const CHORD: f64 = 1.04;

/// Stars for sin R up to some bound.
#[derive(Debug)]
pub(super) struct Level {
    pub families: Vec<Family>,
    /// The places of all families with more than one.
    pub members: Vec<Place>,
    pub parts: Vec<Part>,
    /// Families by direction, with their reach.
    pub index: Index,
}

/// Places that the next level merges into one.
#[derive(Debug, Clone)]
pub(super) struct Family {
    pub merged: Place,
    /// Its members; empty for a single place, which does not move.
    pub members: Range<u32>,
    /// The longest chord from a member to the merged place.
    pub spread: f64,
}

/// A place from which light comes, and its parts by step of 1/T.
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub direction: DVec3,
    pub parts: Range<u32>,
}

/// Stars of similar 1/T.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    step: usize,
    pub luminance: f64,
    /// Luminance over temperature.
    per_kelvin: f64,
    solid_angle: f64,
}

/// Accumulated parts.
#[derive(Debug)]
pub(super) struct Sums {
    /// By step, valid only if its bit is set in `some`; `many` marks steps with more than one part.
    luminance: [f64; STEPS],
    per_kelvin: [f64; STEPS],
    solid_angle: [f64; STEPS],
    some: u64,
    many: u64,
}

impl Level {
    /// `places` for sin R up to `reach`, a power of 2, from half of it on.
    pub fn new(places: &[Place], of_places: &[Part], reach: f64) -> Level {
        let parts_of =
            |place: &Place| &of_places[place.parts.start as usize..place.parts.end as usize];
        // Grouped by squares of a quarter of that width.
        let squares = Grid {
            cells: (8.0 / reach) as usize,
        };
        let square = |place: &Place| squares.cell(place.direction);
        let mut order: Vec<_> = places.iter().map(square).zip(0u32..).collect();
        order.sort_unstable();
        let (mut families, mut members, mut parts) = (Vec::new(), Vec::new(), Vec::new());
        let mut copied = |direction: DVec3, of: &[Part]| {
            let begin = parts.len() as u32;
            parts.extend_from_slice(of);
            Place {
                direction,
                parts: begin..parts.len() as u32,
            }
        };
        for family in order.chunk_by(|a, b| a.0 == b.0) {
            let of_family = family.iter().map(|(_, k)| &places[*k as usize]);
            let begin = members.len() as u32;
            if family.len() > 1 {
                members.extend(of_family.clone().map(|p| copied(p.direction, parts_of(p))));
            }
            let (mut sums, mut middle) = (Sums::none(), DVec3::ZERO);
            for place in of_family.clone() {
                for part in parts_of(place) {
                    sums.add(part, 1.0);
                    middle += part.luminance * place.direction;
                }
            }
            let merged = match family {
                [(_, one)] => {
                    let one = &places[*one as usize];
                    copied(one.direction, parts_of(one))
                }
                // If all are dark, any of their places.
                [(_, first), ..] => {
                    let first = places[*first as usize].direction;
                    let direction = middle.try_normalize().unwrap_or(first);
                    copied(direction, &sums.parts().collect::<Vec<_>>())
                }
                [] => continue,
            };
            let moved = members[begin as usize..].iter();
            let chords = moved.map(|member: &Place| member.direction.distance(merged.direction));
            families.push(Family {
                spread: chords.fold(0.0, f64::max),
                merged,
                members: begin..members.len() as u32,
            });
        }
        // Discs around the merged places: at the end of the move they have the whole radius, and at the start half of it, which reaches
        // less far, as they move by at most the diagonal of a square: 0.36 of the radius.
        let disc = |family: &Family| (family.merged.direction, 1.0001 * reach);
        let discs: Vec<_> = families.iter().map(disc).collect();
        let grid = Grid {
            cells: (2.0 / reach) as usize,
        };
        let index = Index::new(grid, discs.iter().copied());
        Level {
            families,
            members,
            parts,
            index,
        }
    }
}

impl Place {
    /// The place after this fraction of the way to the `merged` one.
    #[inline(always)]
    fn towards(&self, merged: &Place, way: f64) -> DVec3 {
        let between = self.direction + (merged.direction - self.direction) * way;
        between / between.length_squared().sqrt()
    }
}

impl Part {
    pub fn of(star: &Star) -> Part {
        let luminance = star.luminance();
        Part {
            step: ((1.0 / (STEP * star.temperature)) as usize).min(STEPS - 1),
            luminance,
            per_kelvin: luminance / star.temperature,
            solid_angle: star.solid_angle,
        }
    }

    /// A single star in its place.
    fn star(&self, direction: DVec3) -> Star {
        Star {
            direction,
            temperature: self.luminance / self.per_kelvin,
            solid_angle: self.solid_angle,
        }
    }
}

impl Sums {
    fn none() -> Sums {
        Sums {
            luminance: [0.0; STEPS],
            per_kelvin: [0.0; STEPS],
            solid_angle: [0.0; STEPS],
            some: 0,
            many: 0,
        }
    }

    /// Clears the sums.
    fn clear(&mut self) {
        (self.some, self.many) = (0, 0);
    }

    /// Adds a part with `times` its light, unless it is dark.
    #[inline(always)]
    fn add(&mut self, part: &Part, times: f64) {
        if part.luminance > 0.0 {
            let step = part.step % STEPS;
            let before = match self.some >> step & 1 == 1 {
                true => [
                    self.luminance[step],
                    self.per_kelvin[step],
                    self.solid_angle[step],
                ],
                false => [0.0; 3],
            };
            self.luminance[step] = before[0] + part.luminance * times;
            self.per_kelvin[step] = before[1] + part.per_kelvin * times;
            self.solid_angle[step] = before[2] + part.solid_angle * times;
            self.many |= self.some & 1 << step;
            self.some |= 1 << step;
        }
    }

    /// One part per step: a single part unchanged, several as one of their total luminance and mean 1/T.
    fn parts(&self) -> impl Iterator<Item = Part> {
        // The lowest set bit, and the rest without it.
        let lowest = |left: &u64| (*left != 0).then_some(left & left.wrapping_sub(1));
        let lefts = std::iter::successors(Some(self.some), lowest).take_while(|left| *left != 0);
        lefts.map(|left| {
            let step = left.trailing_zeros() as usize;
            let (light, per_kelvin) = (self.luminance[step], self.per_kelvin[step]);
            let solid_angle = match self.many >> step & 1 == 1 {
                true => light / luminance(light / per_kelvin),
                false => self.solid_angle[step],
            };
            Part {
                step,
                luminance: light,
                per_kelvin,
                solid_angle,
            }
        })
    }
}

/// How discs are widened for some rays, ray by ray.
#[derive(Debug)]
struct Profiles {
    /// sin² R and its inverse.
    squares: Block,
    inverses: Block,
    /// L/E is the sum of the first, times (1 − s)⁴, and the second, uniform one.
    densities: Block,
    evens: Block,
    /// The fraction of the way of stars to their places on the next level, and sin R, which bounds how far from there a direction can see a
    /// family, besides the chord to its members.
    ways: Block,
    reaches: Block,
}

impl Profiles {
    /// Placeholder to be overwritten.
    const ZERO: Profiles = Profiles {
        squares: [0.0; BLOCK],
        inverses: [0.0; BLOCK],
        densities: [0.0; BLOCK],
        evens: [0.0; BLOCK],
        ways: [0.0; BLOCK],
        reaches: [0.0; BLOCK],
    };

    /// L/E along `d` of ray `k`, of a star at `middle`.
    #[inline(always)]
    fn density(&self, k: usize, d: DVec3, middle: DVec3) -> f64 {
        // From the chord c: sin² θ = c² (1 − c²/4), in front if c² < 2.
        let chord = (d - middle).length_squared();
        let left = self.squares[k] - chord * (1.0 - 0.25 * chord);
        let part = left * self.inverses[k];
        let square = part * part;
        let density = self.densities[k] * (square * square) + self.evens[k];
        if (chord < 2.0) & (left > 0.0) {
            density
        } else {
            0.0
        }
    }
}

/// Computes the profiles of discs whose radius has this `sine`, widened to the sines `reaches`, on a level for up to `most`.
struct Widen<'a> {
    sine: f64,
    reaches: &'a Block,
    most: f64,
    to: &'a mut Profiles,
}

impl VectorLoop for Widen<'_> {
    #[inline(always)]
    fn run(self) {
        let (square_of_sine, twice) = (self.sine * self.sine, 2.0 / self.most);
        let mut to = Profiles {
            reaches: *self.reaches,
            ..Profiles::ZERO
        };
        for k in 0..BLOCK {
            let square = to.reaches[k] * to.reaches[k];
            let inverse = 1.0 / square;
            let q = square_of_sine * inverse;
            let even = q * q * inverse * FRAC_1_PI;
            (to.squares[k], to.inverses[k]) = (square, inverse);
            to.densities[k] = 5.0 * (inverse * FRAC_1_PI - even);
            to.evens[k] = even;
            let way = twice * to.reaches[k] - 1.0;
            to.ways[k] = if way > 0.0 { way } else { 0.0 };
        }
        *self.to = to;
    }
}

/// L/E of a place for each of some rays, and a bit mask of the eighths of the block in which any is above 0.
struct Densities<'a> {
    rays: Rays<'a>,
    profiles: &'a Profiles,
    place: &'a Place,
    /// The place it moves to; `None` for one that stays.
    merged: Option<&'a Place>,
    densities: &'a mut Block,
    eighths: &'a mut u64,
}

impl VectorLoop for Densities<'_> {
    #[inline(always)]
    fn run(self) {
        let [x, y, z] = self.rays.axes;
        let count = x.len().min(y.len()).min(z.len()).min(BLOCK);
        let mut densities = [0.0; BLOCK];
        match self.merged {
            None => {
                for k in 0..count {
                    let d = DVec3::new(x[k], y[k], z[k]);
                    densities[k] = self.profiles.density(k, d, self.place.direction);
                }
            }
            Some(merged) => {
                for k in 0..count {
                    let d = DVec3::new(x[k], y[k], z[k]);
                    let middle = self.place.towards(merged, self.profiles.ways[k]);
                    densities[k] = self.profiles.density(k, d, middle);
                }
            }
        }
        let (lanes, _) = densities.as_chunks::<LANES>();
        for (eighth, lanes) in lanes.iter().enumerate() {
            let mut any = 0;
            for density in lanes {
                any |= u64::from(*density > 0.0);
            }
            *self.eighths |= any << eighth;
        }
        *self.densities = densities;
    }
}

/// Whether any ray is close enough to a family to see one of its members.
struct IsNear<'a> {
    rays: Rays<'a>,
    profiles: &'a Profiles,
    family: &'a Family,
    /// Set to 1 if so.
    near: &'a mut u64,
}

impl VectorLoop for IsNear<'_> {
    #[inline(always)]
    fn run(self) {
        let [x, y, z] = self.rays.axes;
        let count = x.len().min(y.len()).min(z.len()).min(BLOCK);
        let (spread, middle) = (self.family.spread, self.family.merged.direction);
        let mut near = 0;
        for k in 0..count {
            // No member is farther from the merged place than the rest of the way.
            let left = (1.0 - self.profiles.ways[k]) * spread;
            let farthest = CHORD * self.profiles.reaches[k] + left;
            let d = DVec3::new(x[k], y[k], z[k]) - middle;
            near |= u64::from(d.length_squared() <= farthest * farthest);
        }
        *self.near = near;
    }
}

/// What some rays see of a level, ray by ray.
#[derive(Debug)]
pub(super) struct Tally<'a> {
    level: &'a Level,
    rays: Rays<'a>,
    profiles: Profiles,
    densities: Block,
    /// Bit masks of the rays that see anything, and of those that see more than one part.
    some: u64,
    many: u64,
    /// The first part that a ray sees, and L/E; for rays that see more, the index of their sums.
    first: [(u32, f64); BLOCK],
    slots: [u8; BLOCK],
    sums: &'a mut Vec<Sums>,
}

impl<'a> Tally<'a> {
    /// An empty tally. Discs whose radius has this `sine` are widened to the sines `reaches` for `rays`, on a level for up to `most`;
    /// `sums` is scratch space.
    #[inline(always)]
    pub fn new(
        (level, most): (&'a Level, f64),
        rays: Rays<'a>,
        (sine, reaches): (f64, &Block),
        sums: &'a mut Vec<Sums>,
    ) -> Self {
        let mut profiles = Profiles::ZERO;
        dispatch(Widen {
            sine,
            reaches,
            most,
            to: &mut profiles,
        });
        Tally {
            level,
            rays,
            profiles,
            densities: [0.0; BLOCK],
            some: 0,
            many: 0,
            first: [(0, 0.0); BLOCK],
            slots: [0; BLOCK],
            sums,
        }
    }

    /// Adds what the rays see of a family.
    pub fn add(&mut self, number: u32) {
        let level = self.level;
        let family = &level.families[number as usize];
        if family.members.is_empty() {
            return self.add_place(&family.merged, None);
        }
        let mut near = 0;
        dispatch(IsNear {
            rays: self.rays,
            profiles: &self.profiles,
            family,
            near: &mut near,
        });
        if near > 0 {
            for member in &level.members[family.members.start as usize..family.members.end as usize]
            {
                self.add_place(member, Some(&family.merged));
            }
        }
    }

    fn add_place(&mut self, place: &Place, merged: Option<&Place>) {
        let mut eighths = 0;
        dispatch(Densities {
            rays: self.rays,
            profiles: &self.profiles,
            place,
            merged,
            densities: &mut self.densities,
            eighths: &mut eighths,
        });
        for eighth in (0..BLOCK / LANES).filter(|eighth| eighths >> eighth & 1 == 1) {
            for ray in eighth * LANES..(eighth + 1) * LANES {
                let density = self.densities[ray];
                if density > 0.0 {
                    let parts = place.parts.clone();
                    parts.for_each(|part| self.add_part(ray, part, density));
                }
            }
        }
    }

    /// A single part stays as it is; several are summed.
    #[inline]
    fn add_part(&mut self, ray: usize, number: u32, density: f64) {
        let part = &self.level.parts[number as usize];
        let bit = 1 << ray;
        if self.some & bit == 0 {
            self.some |= bit;
            self.first[ray] = (number, density);
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
            let (number, density) = self.first[ray];
            self.sums[slot].add(&self.level.parts[number as usize], density);
        }
        self.sums[self.slots[ray] as usize].add(part, density);
    }

    /// Calls `each` with each ray that sees light, and with the sum of the `light` of the stars it sees, with solid angles scaled so that
    /// their irradiance is the radiance seen.
    pub fn each_seen(
        &self,
        light: impl Fn(usize, &Star) -> [f64; 3],
        mut each: impl FnMut(usize, [f64; 3]),
    ) {
        let mut left = self.some;
        while left != 0 {
            let ray = left.trailing_zeros() as usize;
            left &= left - 1;
            let direction = self.rays.get(ray);
            let mut sum = [0.0; 3];
            let mut shine = |star: Star| {
                for (sum, e) in sum.iter_mut().zip(light(ray, &star)) {
                    *sum += e;
                }
            };
            if self.many >> ray & 1 == 1 {
                let sums = &self.sums[self.slots[ray] as usize];
                sums.parts().for_each(|part| shine(part.star(direction)));
            } else {
                let (number, density) = self.first[ray];
                let part = &self.level.parts[number as usize];
                if part.luminance > 0.0 {
                    shine(Star {
                        solid_angle: part.solid_angle * density,
                        ..part.star(direction)
                    });
                }
            }
            each(ray, sum);
        }
    }
}
