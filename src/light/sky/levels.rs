//! Stars seen by pixels wider than their discs: spread over about a pixel, and merged where one pixel holds many.
//!
//! Implements the derivation at the head of `stars`: the profile of a widened disc, levels for discs up to some width, and sums of similar
//! stars.

use std::f64::consts::FRAC_1_PI;
use std::ops::Range;

use glam::DVec3;

use super::faces::{Grid, Index};
use super::rays::Rays;
use super::star::{Beaming, Star, luminance};
use crate::accel::vectors::{BLOCK, VectorLoop, dispatch};

/// Step of 1/T for merging stars, 1/K: ½ in c₂/(λT), at 0.55 µm.
const STEP: f64 = 0.5 * 0.55e-6 / 1.438_777e-2;
/// Number of steps, down to 817 K; colder stars are in the last.
const STEPS: usize = 64;
/// Parts of a block that are looked at only if they are near.
const EIGHTHS: usize = 8;
const LANES: usize = BLOCK / EIGHTHS;
/// An upper bound of a chord of up to 30° divided by the sine of its angle.
pub(super) const CHORD: f64 = 1.04;
/// The diagonal of the squares of a level, √2/4, divided by its largest sin R.
pub(super) const DIAGONAL: f64 = 0.36;
/// The largest distance of a ray from the merged place of a star that it sees, in units of a level's largest sin R, and in all: a bound of
/// `distance` of `stars`, (√(STEEP/4) + √(1 + STEEP/4 − BENT))/(1 − BENT) times [`CHORD`]; and the sine of 34.8°.
const FARTHEST_OF_LEVEL: f64 = 1.56;
pub(super) const FARTHEST: f64 = 0.57;

/// Stars for sin R up to some bound.
#[derive(Debug)]
pub(super) struct Level {
    pub families: Vec<Family>,
    /// The places of all families with more than one.
    pub members: Vec<Place>,
    pub parts: Vec<Part>,
    /// The families of the finer level that make each family, or the stars.
    pub finer: Vec<u32>,
    /// Families by direction, with their reach.
    pub index: Index,
}

/// Places that the next level merges into one.
#[derive(Debug, Clone)]
pub(super) struct Family {
    pub merged: Place,
    /// Its members; empty for a single place, which does not move.
    pub members: Range<u32>,
    /// Where they are in [`Level::finer`].
    pub finer: Range<u32>,
    /// The longest chord from a member to the merged place.
    pub spread: f64,
}

/// A place from which light comes, and its parts by step of 1/T.
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub direction: DVec3,
    pub parts: Range<u32>,
    /// The sum of the channels of its stars.
    pub channels: [f32; 3],
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
    /// The same times W_s/W_d.
    seen_per_kelvin: [f64; STEPS],
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
        let mut copied = |direction: DVec3, of: &[Part], channels: [f32; 3]| {
            let begin = parts.len() as u32;
            parts.extend_from_slice(of);
            Place {
                direction,
                parts: begin..parts.len() as u32,
                channels,
            }
        };
        let mut begin_finer = 0;
        for family in order.chunk_by(|a, b| a.0 == b.0) {
            let finer = begin_finer..begin_finer + family.len() as u32;
            begin_finer = finer.end;
            let of_family = family.iter().map(|(_, k)| &places[*k as usize]);
            let begin = members.len() as u32;
            if family.len() > 1 {
                let copied = |p: &Place| copied(p.direction, parts_of(p), p.channels);
                members.extend(of_family.clone().map(copied));
            }
            let (mut sums, mut middle) = (Sums::none(), DVec3::ZERO);
            let mut channels = [0.0; 3];
            for place in of_family.clone() {
                channels = std::array::from_fn(|c| channels[c] + place.channels[c]);
                for part in parts_of(place) {
                    sums.add(part, 1.0, 1.0);
                    middle += part.luminance * place.direction;
                }
            }
            let merged = match family {
                [(_, one)] => {
                    let one = &places[*one as usize];
                    copied(one.direction, parts_of(one), one.channels)
                }
                // If all are dark, any of their places.
                [(_, first), ..] => {
                    let first = places[*first as usize].direction;
                    let direction = middle.try_normalize().unwrap_or(first);
                    copied(direction, &sums.parts().collect::<Vec<_>>(), channels)
                }
                [] => continue,
            };
            let moved = members[begin as usize..].iter();
            let chords = moved.map(|member: &Place| member.direction.distance(merged.direction));
            families.push(Family {
                spread: chords.fold(0.0, f64::max),
                merged,
                members: begin..members.len() as u32,
                finer,
            });
        }
        // Discs around the merged places: at the end of the move they have the whole radius, and at the start half of it, which reaches
        // less far, as they move by at most the diagonal of a square.
        let sine = (FARTHEST_OF_LEVEL * reach).min(FARTHEST);
        let disc = |family: &Family| (family.merged.direction, sine);
        let discs: Vec<_> = families.iter().map(disc).collect();
        let grid = Grid {
            cells: (2.0 / reach) as usize,
        };
        let index = Index::new(grid, discs.iter().copied());
        Level {
            families,
            members,
            parts,
            finer: order.into_iter().map(|(_, k)| k).collect(),
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
    pub fn star(&self, direction: DVec3) -> Star {
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
            seen_per_kelvin: [0.0; STEPS],
            solid_angle: [0.0; STEPS],
            some: 0,
            many: 0,
        }
    }

    /// Clears the sums.
    fn clear(&mut self) {
        (self.some, self.many) = (0, 0);
    }

    /// Adds a part with `times` its light and at this W_s/W_d, unless it is dark.
    #[inline(always)]
    fn add(&mut self, part: &Part, times: f64, ratio: f64) {
        if part.luminance > 0.0 {
            let step = part.step % STEPS;
            let before = match self.some >> step & 1 == 1 {
                true => [
                    self.luminance[step],
                    self.per_kelvin[step],
                    self.seen_per_kelvin[step],
                    self.solid_angle[step],
                ],
                false => [0.0; 4],
            };
            let per_kelvin = part.per_kelvin * times;
            self.luminance[step] = before[0] + part.luminance * times;
            self.per_kelvin[step] = before[1] + per_kelvin;
            self.seen_per_kelvin[step] = before[2] + per_kelvin * ratio;
            self.solid_angle[step] = before[3] + part.solid_angle * times;
            self.many |= self.some & 1 << step;
            self.some |= 1 << step;
        }
    }

    /// One part per step: a single part unchanged, several as one of their total luminance and mean 1/T, seen at the mean of W_s/(W_d T).
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
                per_kelvin: self.seen_per_kelvin[step],
                solid_angle,
            }
        })
    }
}

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
    /// The middle of each eighth of the rays, and the distance of the farthest from there.
    middles: [Lanes; 3],
    radii: Lanes,
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

/// Computes the profiles of discs whose radius has this `sine`, for rays on a level up to `most`, which have their `OWN` motions or share one.
struct Widen<'a, const OWN: bool> {
    rays: Rays<'a>,
    /// sin ρ, and how sin² R decreases with its square and increases with the width of pixels, as at the head of `stars`.
    widths: (f64, f64, f64),
    most: f64,
    to: &'a mut Profiles,
}

impl<const OWN: bool> VectorLoop for Widen<'_, OWN> {
    #[inline(always)]
    fn run(self) {
        let Widen { rays, to, .. } = self;
        let (sine, less, reach) = self.widths;
        let (square_of_sine, twice) = (sine * sine, 2.0 / self.most);
        let (count, shared) = (rays.len(), rays.beaming.motion);
        for eighth in 0..count.div_ceil(LANES).min(EIGHTHS) {
            let [x, y, z, ratios] = [rays.axes[0], rays.axes[1], rays.axes[2], rays.ratios]
                .map(|column| lanes(column, eighth * LANES));
            let own = [x, y, z];
            for lane in 0..LANES {
                let point = reach * rays.pixel / ratios[lane];
                let square = point * point - less * square_of_sine;
                let inverse = 1.0 / square;
                let q = square_of_sine * inverse;
                let even = q * q * inverse * FRAC_1_PI;
                to.squares[eighth][lane] = square;
                to.inverses[eighth][lane] = inverse;
                to.densities[eighth][lane] = 5.0 * (inverse * FRAC_1_PI - even);
                to.evens[eighth][lane] = even;
                let way = twice * square.sqrt() - 1.0;
                to.ways[eighth][lane] = if way > 0.0 { way } else { 0.0 };
                let d = DVec3::new(x[lane], y[lane], z[lane]);
                let motion = if OWN {
                    rays.motion(eighth * LANES + lane)
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
            let mut squares = [0.0; LANES];
            for (axis, own) in own.iter().enumerate() {
                let mut sum = 0.0;
                for x in own {
                    sum += x;
                }
                let middle = sum / LANES as f64;
                for lane in 0..LANES {
                    let x = own[lane] - middle;
                    squares[lane] += x * x;
                }
                to.directions[axis][eighth] = *own;
                to.middles[axis][eighth] = middle;
            }
            let mut farthest = 0.0;
            for square in squares {
                farthest = if square > farthest { square } else { farthest };
            }
            to.radii[eighth] = farthest.sqrt();
        }
        // Nothing is seen past the end, and in the eighths after that.
        for k in count..count.next_multiple_of(LANES) {
            to.squares[k / LANES % EIGHTHS][k % LANES] = 0.0;
        }
        for radius in &mut to.radii[count.div_ceil(LANES).min(EIGHTHS)..] {
            *radius = f64::NEG_INFINITY;
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
    profiles: Box<Profiles>,
    densities: Eighths,
    ratios: Eighths,
    /// How far rays see, as a chord, and the part of the way to their merged places that stars have left at most.
    distance: f64,
    left: f64,
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
            profiles: Box::default(),
            densities: Eighths::default(),
            ratios: Eighths::default(),
            distance: 0.0,
            left: 0.0,
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
    /// Begins with `rays`, which have seen nothing, on a level for up to `most`; see [`Widen`] for the widths.
    pub fn begin(
        &mut self,
        rays: Rays,
        widths: (f64, f64, f64),
        most: f64,
        (distance, left): (f64, f64),
    ) {
        (self.some, self.many) = (0, 0);
        (self.beaming, self.distance, self.left) = (rays.beaming, distance, left);
        match rays.motions {
            [] => self.widen::<false>(rays, widths, most),
            _ => self.widen::<true>(rays, widths, most),
        }
    }

    fn widen<const OWN: bool>(&mut self, rays: Rays, widths: (f64, f64, f64), most: f64) {
        dispatch(Widen::<OWN> {
            rays,
            widths,
            most,
            to: &mut self.profiles,
        });
    }

    /// Adds what the rays see of a family.
    pub fn add(&mut self, level: &Level, number: u32) {
        let family = &level.families[number as usize];
        // No member is farther from the merged place than the rest of the way.
        let (middle, farthest) = (
            family.merged.direction,
            self.distance + self.left * family.spread,
        );
        let ([x, y, z], mut near) = (&self.profiles.middles, 0);
        for (eighth, radius) in self.profiles.radii.iter().enumerate() {
            let away = DVec3::new(x[eighth], y[eighth], z[eighth]) - middle;
            let most = radius + farthest;
            let is_near = (most > 0.0) & (away.length_squared() <= most * most);
            near |= u64::from(is_near) << eighth;
        }
        if near == 0 {
            return;
        }
        if family.members.is_empty() {
            return self.add_place(level, near, &family.merged, None);
        }
        for member in &level.members[family.members.start as usize..family.members.end as usize] {
            self.add_place(level, near, member, Some(&family.merged));
        }
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

/// x to a power.
#[inline(always)]
pub(super) fn raised(x: f64, power: i32) -> f64 {
    let all = (0..power.unsigned_abs()).fold(1.0, |all, _| all * x);
    if power < 0 { 1.0 / all } else { all }
}
