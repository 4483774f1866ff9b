//! Stars: discs of uniform radiance, found by a grid on the faces of a cube.
//!
//! A star is a blackbody: seen at W it is one of the temperature T/W, for W⁻⁵ B(λ/W; T) = B(λ; T/W). What comes of it
//! through a surface across is that times the solid angle Ω that a blackbody would have, and with dω_F = W² dω
//!
//! ```text
//! E_F = W² Ω B(λ; T/W).
//! ```
//!
//! Discs smaller than pixels would fall between samples. Pixels at rest in a camera's frame that are a wide see a/W of the world, alike in all directions,
//! for the boost of directions is conformal. So a disc of a radius ρ below 1.2 a/W is seen with a larger one R, and at the angle θ from its middle, with
//! s = sin² θ/sin² R and q = sin² ρ/sin² R, as
//!
//! ```text
//! sin² R = (1.4 a/W)² − 0.36 sin² ρ,
//! L = E/(π sin² R) · (5 (1 − q²) (1 − s)⁴ + q²),        ∫ L cos θ dω = π sin² R ∫₀¹ L ds = E,
//! ```
//!
//! which is the disc itself where R = ρ. Of a point, q = 0, the transform of (1 − s)⁴ is as J₅(kR)/(kR)⁵, whose first zero is at R = 1.396 (2π/k): the sum over
//! pixel centres keeps its light to 0.4 %, wherever it lies among them, and half of the radiance is reached across 1.1 pixels.
//!
//! For sin R up to a bound r there is a level, with lists of what reaches into cells as wide as r; the next is for 2r. There the stars of a square of r/4 are in one
//! place, in the middle of their light, which moves them by half a pixel at most. As R grows from r/2 to r they move there, so that levels meet without a step.
//! Of what is seen in one direction, stars whose ln B, about −c₂/(λT), differs by at most ½ are summed up to one of their luminance and their mean 1/T, whose
//! colours at W ≤ 1 are right to (½)²/24 = 1 %. Sizes of levels, and times of look-ups, thus have bounds however many stars a pixel sees.

use std::f64::consts::FRAC_1_PI;
use std::ops::Range;
use std::sync::OnceLock;

use glam::DVec3;

use super::PixelAngles;
use super::panorama::{greater, integer, lesser};
use crate::accel::vectors::{BLOCK, Columns, VectorLoop, dispatch};
use crate::colour::blackbody_colour;

/// sin R of a point over the width of a pixel: the zero of the fundamental.
const REACH: f64 = 1.4;
/// By how much sin² R is less for each of sin² ρ: so that R = ρ at 1.4/√1.36 = 1.2 pixels.
const LESS: f64 = 0.36;
/// The largest sin R, 2 to the power of −1: pixels that see more of the world see little of the change of W across them either.
const WIDEST: f64 = 0.5;
/// The power of 2 in it.
const WIDEST_POWER: i32 = -1;
/// Steps of 1/T in which stars are summed up, 1/K: ½ in c₂/(λT), at 0.55 µm.
const STEP: f64 = 0.5 * 0.55e-6 / 1.438_777e-2;
/// How many, down to 817 K; what is colder is in the last.
const STEPS: usize = 64;
/// The cosine of the angle between the axis of a face and its corners, 1/√3.
const CORNER: f64 = 0.577_350_269;

/// A star.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Star {
    /// Unit vector towards it.
    pub direction: DVec3,
    /// Of its spectrum, in kelvin.
    pub temperature: f64,
    /// Ω: what it sends through a surface across, over the radiance of a blackbody.
    pub solid_angle: f64,
}

impl Star {
    /// One that sends light of this luminance through a surface across, at rest in the world.
    pub fn new(direction: DVec3, temperature: f64, luminance: f64) -> Star {
        Star {
            direction,
            temperature,
            solid_angle: luminance / self::luminance(temperature),
        }
    }

    /// Linear sRGB of Ω B(λ; T/W).
    #[inline]
    pub fn colour(&self, w: f64) -> [f64; 3] {
        blackbody_colour(self.temperature / w).map(|c| c * self.solid_angle)
    }

    /// The same at rest, within sRGB.
    #[inline]
    pub fn channels(&self) -> [f64; 3] {
        self.colour(1.0).map(|c| c.max(0.0))
    }

    /// Its luminance through a surface across, at rest.
    fn luminance(&self) -> f64 {
        self.solid_angle * luminance(self.temperature)
    }
}

/// Y of the linear sRGB of a blackbody.
fn luminance(temperature: f64) -> f64 {
    let [r, g, b] = blackbody_colour(temperature);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Stars of one angular radius ρ: radiance E/(π sin² ρ) within it, or as the head of this file says where pixels are wider than that.
#[derive(Debug)]
pub struct StarMap {
    stars: Vec<Star>,
    /// sin ρ, cos ρ, and 1/(π sin² ρ).
    sine: f64,
    cosine: f64,
    density: f64,
    /// Stars by what their discs reach.
    discs: Lists,
    /// For wider discs, the finest first, each made when it is first asked for.
    levels: Vec<OnceLock<Level>>,
}

/// Square cells on the faces of a cube about the observer.
#[derive(Debug, Clone, Copy)]
struct Grid {
    /// Along an edge of a face.
    cells: usize,
}

/// What reaches into each cell of a grid.
#[derive(Debug)]
struct Lists {
    grid: Grid,
    /// Where a cell's list begins, and the lists one after the other.
    begins: Vec<u32>,
    lists: Vec<u32>,
}

/// Stars to be seen with sin R up to some bound.
#[derive(Debug)]
struct Level {
    families: Vec<Family>,
    /// The places of all families of more than one.
    members: Vec<Place>,
    parts: Vec<Part>,
    /// Families by what they reach.
    lists: Lists,
}

/// Places that the next level has as one.
#[derive(Debug, Clone)]
struct Family {
    merged: Place,
    /// Those that they are; none for one that stays as it is.
    members: Range<u32>,
    /// The longest chord from one of them to there.
    spread: f64,
}

/// A place from which light comes, and its parts by steps of 1/T.
#[derive(Debug, Clone)]
struct Place {
    direction: DVec3,
    parts: Range<u32>,
}

/// Stars that are alike in 1/T.
#[derive(Debug, Clone, Copy)]
struct Part {
    step: usize,
    luminance: f64,
    /// Luminance over temperature.
    per_kelvin: f64,
    solid_angle: f64,
}

/// Sums of parts.
#[derive(Debug)]
struct Sums {
    /// By step, where its bit is set in `some`; `many` says where there is more than one.
    luminance: [f64; STEPS],
    per_kelvin: [f64; STEPS],
    solid_angle: [f64; STEPS],
    some: u64,
    many: u64,
}

/// A widened disc.
#[derive(Debug, Clone, Copy)]
struct Profile {
    /// sin² R, and one over it.
    square: f64,
    inverse: f64,
    /// L/E is that of the part that falls off, times (1 − s)⁴, and that of the even one.
    density: f64,
    even: f64,
}

impl StarMap {
    /// More bytes than a map of so many stars takes once all of its levels are made: 1.1 to 1.6 kB for each of 500,000 and of 100,000.
    pub fn bytes(stars: usize) -> u64 {
        2048 * stars as u64
    }

    /// `stars` of the angular `radius`, at most some degrees.
    pub fn new(stars: Vec<Star>, radius: f64) -> StarMap {
        let sine = libm::sin(radius);
        let grid = Grid::new(stars.len(), radius);
        let discs = Lists::new(grid, stars.iter().map(|star| (star.direction, sine)));
        // Cells of a level are as wide as its largest sin R: 2/cells, from this on, up to the widest.
        let finest = Grid::of_levels(stars.len()).cells.ilog2() as i32;
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

    /// The sum of the radiances of the stars within whose discs `d` lies, where pixels are `angle` wide, `light` of each being what it sends
    /// through a surface across, in proportion to its solid angle.
    #[inline]
    pub fn radiance(&self, d: DVec3, angle: f64, light: impl Fn(&Star) -> [f64; 3]) -> [f64; 3] {
        let reach = self.reach(angle);
        if reach > self.sine {
            return self.widened(d, reach, light);
        }
        let mut sum = [0.0; 3];
        for &index in self.discs.of(self.discs.grid.cell(d.as_vec3().to_array())) {
            let star = &self.stars[index as usize];
            if d.dot(star.direction) > self.cosine {
                for (sum, e) in sum.iter_mut().zip(light(star)) {
                    *sum += e * self.density;
                }
            }
        }
        sum
    }

    /// The same of discs with sin R = `reach`.
    fn widened(&self, d: DVec3, reach: f64, light: impl Fn(&Star) -> [f64; 3]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        let number = self.level_of(reach);
        let level = self.level(number);
        let list = level
            .lists
            .of(level.lists.grid.cell(d.as_vec3().to_array()));
        if list.is_empty() {
            return sum;
        }
        let profile = Profile::new(self.sine, reach);
        // One part is seen as it is, more of them are summed up.
        let (mut one, mut sums) = (None, None);
        let mut add = |direction: DVec3, parts: &Range<u32>| {
            let density = profile.density(d, direction);
            if density > 0.0 {
                for part in &level.parts[parts.start as usize..parts.end as usize] {
                    match (&mut sums, one) {
                        (Some(sums), _) => Sums::add(sums, part, density),
                        (None, None) => one = Some((part, density)),
                        (None, Some((first, of_first))) => {
                            let sums = sums.insert(Sums::none());
                            sums.add(first, of_first);
                            sums.add(part, density);
                        }
                    }
                }
            }
        };
        // How far stars are on the way to where the next level has them.
        let way = (2.0 * reach / self.reach_of(number) - 1.0).max(0.0);
        for &index in list {
            let Family {
                merged,
                members,
                spread,
            } = &level.families[index as usize];
            if members.is_empty() {
                add(merged.direction, &merged.parts);
                continue;
            }
            // None is farther from there than what is left of the way; a chord of 30° is longer than the sine by less than 4 %.
            let farthest = 1.04 * reach + (1.0 - way) * spread;
            if (d - merged.direction).length_squared() > farthest * farthest {
                continue;
            }
            for member in &level.members[members.start as usize..members.end as usize] {
                add(member.towards(merged, way), &member.parts);
            }
        }
        let mut shine = |star: Star| {
            for (sum, e) in sum.iter_mut().zip(light(&star)) {
                *sum += e;
            }
        };
        match (sums, one) {
            (Some(sums), _) => sums.parts().for_each(|part| shine(part.star(d))),
            (None, Some((part, density))) if part.luminance > 0.0 => shine(Star {
                solid_angle: part.solid_angle * density,
                ..part.star(d)
            }),
            (None, _) => {}
        }
        sum
    }

    /// sin R in pixels so wide; sin ρ or less where discs stay as they are.
    #[inline(always)]
    fn reach(&self, pixel: f64) -> f64 {
        let point = REACH * pixel;
        let square = point * point - LESS * self.sine * self.sine;
        lesser_of(square.max(0.0).sqrt(), WIDEST)
    }

    /// The level for discs with sin R = `reach`, from above 0 to the widest.
    #[inline(always)]
    fn level_of(&self, reach: f64) -> usize {
        // The power of 2 from which on numbers are not below it, counted from the widest down.
        let power = ((reach.to_bits() - 1) >> 52) as i32 - 1022;
        let coarser = (WIDEST_POWER - power) as usize;
        (self.levels.len() - 1).saturating_sub(coarser)
    }

    /// The largest sin R of a level.
    #[inline(always)]
    fn reach_of(&self, level: usize) -> f64 {
        let halvings = (self.levels.len() - 1 - level) as u64;
        f64::from_bits(WIDEST.to_bits() - (halvings << 52))
    }

    /// A level, of the stars of the one before it: the same whoever asks first.
    fn level(&self, number: usize) -> &Level {
        self.levels[number].get_or_init(|| match number.checked_sub(1) {
            None => {
                let parts: Vec<_> = self.stars.iter().map(Part::of).collect();
                let places = (0..).zip(&self.stars).map(|(k, star)| Place {
                    direction: star.direction,
                    parts: k..k + 1,
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

    /// Calls `each` with the numbers of the directions near which there is a star, where pixels are as wide as `angles` says: all others
    /// lie in no disc.
    pub(crate) fn each_near(
        &self,
        directions: &Columns,
        angles: PixelAngles,
        mut each: impl FnMut(usize),
    ) {
        let (mut cells, mut near) = ([0; BLOCK], [0; BLOCK]);
        let (mut levels, mut halves) = ([None; BLOCK], [0.0; BLOCK]);
        // Discs whose W is below that may be widened, whatever the rounding.
        let least = REACH * angles.pixel / self.sine * (1.0 + LESS).sqrt().recip() * (1.0 + 1e-9);
        let mut begin = 0;
        while begin < directions.len() {
            let ratios = &angles.ratios[begin..directions.len().min(begin + BLOCK)];
            let mut is_widened = false;
            for w in ratios {
                is_widened |= *w < least;
            }
            halves.fill(0.5 * self.discs.grid.cells as f32);
            if is_widened {
                for ((level, half), w) in levels.iter_mut().zip(&mut halves).zip(ratios) {
                    let reach = self.reach(angles.pixel / w);
                    *level = (reach > self.sine).then(|| {
                        let number = self.level_of(reach);
                        *half = (1.0 / self.reach_of(number)) as f32;
                        self.level(number)
                    });
                }
            }
            dispatch(Cells {
                halves: &halves,
                directions,
                begin,
                cells: &mut cells,
            });
            // Whether there is one near goes into the count, and not into a branch that would often be guessed wrongly.
            let mut count = 0;
            if is_widened {
                for (k, (cell, level)) in cells.iter().zip(&levels).enumerate().take(ratios.len()) {
                    let lists = level.map_or(&self.discs, |level| &level.lists);
                    near[count % BLOCK] = begin + k;
                    count += usize::from(lists.has(*cell));
                }
            } else {
                for (k, cell) in cells.iter().enumerate() {
                    near[count % BLOCK] = begin + k;
                    count += usize::from(self.discs.has(*cell));
                }
            }
            for k in &near[..count] {
                // The last block is filled up.
                if *k < directions.len() {
                    each(*k);
                }
            }
            begin += BLOCK;
        }
    }

    /// The stars.
    pub fn stars(&self) -> &[Star] {
        &self.stars
    }
}

/// The lesser of two numbers, neither of which is NaN.
#[inline(always)]
fn lesser_of(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

impl Lists {
    /// Of discs about directions, whose radii have these sines.
    fn new(grid: Grid, discs: impl Iterator<Item = (DVec3, f64)> + Clone) -> Lists {
        // Where lists begin, by counting; filled disc by disc, they are in the order of those.
        let mut begins = vec![0; 6 * grid.cells * grid.cells + 1];
        for (d, sine) in discs.clone() {
            grid.each_reached(d, sine, |cell| begins[cell as usize] += 1);
        }
        let mut sum = 0;
        for begin in &mut begins {
            let count = *begin;
            *begin = sum;
            sum += count;
        }
        let mut ends = begins.clone();
        let mut lists = vec![0; sum as usize];
        for (index, (d, sine)) in (0..).zip(discs) {
            grid.each_reached(d, sine, |cell| {
                let end = &mut ends[cell as usize];
                lists[*end as usize] = index;
                *end += 1;
            });
        }
        Lists {
            grid,
            begins,
            lists,
        }
    }

    /// What reaches into a cell.
    #[inline]
    fn of(&self, cell: u32) -> &[u32] {
        let cell = cell as usize;
        &self.lists[self.begins[cell] as usize..self.begins[cell + 1] as usize]
    }

    /// Whether anything does.
    #[inline(always)]
    fn has(&self, cell: u32) -> bool {
        let cell = cell as usize;
        self.begins[cell] != self.begins[cell + 1]
    }
}

impl Level {
    /// `places` to be seen with sin R up to `reach`, a power of 2, from half of that on.
    fn new(places: &[Place], of_places: &[Part], reach: f64) -> Level {
        let parts_of =
            |place: &Place| &of_places[place.parts.start as usize..place.parts.end as usize];
        // By squares of a quarter of that.
        let squares = Grid {
            cells: (8.0 / reach) as usize,
        };
        let square = |place: &Place| squares.cell(place.direction.as_vec3().to_array());
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
                // Without light, anywhere among them.
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
        // About where places end: there they have the whole radius, and where they begin half of it, which reaches less far, as they move by at
        // most the diagonal of a square: 0.36 of the radius.
        let disc = |family: &Family| (family.merged.direction, 1.0001 * reach);
        let discs: Vec<_> = families.iter().map(disc).collect();
        let grid = Grid {
            cells: (2.0 / reach) as usize,
        };
        let lists = Lists::new(grid, discs.iter().copied());
        Level {
            families,
            members,
            parts,
            lists,
        }
    }
}

impl Place {
    /// Where it is when it has gone this part of the way to the `merged` one.
    #[inline]
    fn towards(&self, merged: &Place, way: f64) -> DVec3 {
        self.direction.lerp(merged.direction, way).normalize()
    }
}

impl Part {
    fn of(star: &Star) -> Part {
        let luminance = star.luminance();
        Part {
            step: ((1.0 / (STEP * star.temperature)) as usize).min(STEPS - 1),
            luminance,
            per_kelvin: luminance / star.temperature,
            solid_angle: star.solid_angle,
        }
    }

    /// One star in its place.
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

    /// Adds a part of that many times the light, unless it is dark.
    #[inline(always)]
    fn add(&mut self, part: &Part, times: f64) {
        if part.luminance > 0.0 {
            let step = part.step % STEPS;
            self.luminance[step] += part.luminance * times;
            self.per_kelvin[step] += part.per_kelvin * times;
            self.solid_angle[step] += part.solid_angle * times;
            self.many |= self.some & 1 << step;
            self.some |= 1 << step;
        }
    }

    /// One for each step: of one part itself, and of more of their luminance and mean 1/T.
    fn parts(&self) -> impl Iterator<Item = Part> {
        // The lowest bit that is left, and all without it.
        let lowest = |left: &u64| (*left != 0).then_some(left & left.wrapping_sub(1));
        let lefts = std::iter::successors(Some(self.some), lowest).take_while(|left| *left != 0);
        lefts.map(|left| {
            let step = left.trailing_zeros() as usize;
            let (luminance, per_kelvin) = (self.luminance[step], self.per_kelvin[step]);
            let solid_angle = match self.many >> step & 1 == 1 {
                true => luminance / self::luminance(luminance / per_kelvin),
                false => self.solid_angle[step],
            };
            Part {
                step,
                luminance,
                per_kelvin,
                solid_angle,
            }
        })
    }
}

impl Profile {
    /// Of a disc of the radius of this `sine`, as wide as one of the sine `reach`.
    fn new(sine: f64, reach: f64) -> Profile {
        let square = reach * reach;
        let inverse = 1.0 / square;
        let q = sine * sine * inverse;
        let even = q * q * inverse * FRAC_1_PI;
        Profile {
            square,
            inverse,
            density: 5.0 * (inverse * FRAC_1_PI - even),
            even,
        }
    }

    /// L/E along `d` of one about `middle`.
    #[inline(always)]
    fn density(&self, d: DVec3, middle: DVec3) -> f64 {
        // Of the chord c: sin² θ = c² (1 − c²/4), ahead where c² < 2.
        let chord = (d - middle).length_squared();
        let left = self.square - chord * (1.0 - 0.25 * chord);
        if chord < 2.0 && left > 0.0 {
            let part = left * self.inverse;
            let square = part * part;
            self.density * (square * square) + self.even
        } else {
            0.0
        }
    }
}

impl Grid {
    /// For so many stars of the angular `radius`: most cells are empty, unless discs are as wide as cells.
    fn new(stars: usize, radius: f64) -> Grid {
        // 16 cells per star, and an edge of a cell, 2 of the face's own units, at least as long as a disc is wide.
        let by_count = (16.0 / 6.0 * stars as f64).sqrt();
        let by_radius = 1.0 / radius;
        let cells = by_count.min(by_radius).clamp(64.0, 512.0) as usize;
        Grid {
            cells: cells.next_power_of_two(),
        }
    }

    /// The finest of levels for so many stars: 64 cells per star, so that most are empty.
    fn of_levels(stars: usize) -> Grid {
        let by_count = (64.0 / 6.0 * stars as f64).sqrt();
        let cells = by_count.clamp(64.0, 1024.0) as usize;
        Grid {
            cells: cells.next_power_of_two(),
        }
    }

    /// The cell in which a direction lies.
    #[inline(always)]
    fn cell(self, d: [f32; 3]) -> u32 {
        cell(0.5 * self.cells as f32, d)
    }

    /// Calls `each` with the cells that a disc about `d` may reach into, which has a radius of this sine, at most 35°.
    fn each_reached(self, d: DVec3, sine: f64, mut each: impl FnMut(u32)) {
        let cosine = (1.0 - sine * sine).sqrt();
        // Of the angle from a face's axis to its corners and the radius together.
        let (corner, across) = (CORNER, (1.0 - CORNER * CORNER).sqrt());
        let least = corner * cosine - across * sine - 1e-6;
        for face in 0..6 {
            let (axis, u, v) = axes(face);
            let depth = d.dot(axis);
            if depth < least {
                continue;
            }
            // In the plane of the axis and a side, the planes through the other side that touch the disc are turned from d's by δ either way, of
            // sin δ = sin R over the length of d there; places on the face are tangents. They may be beyond the plane of the other sides, and there are
            // none where the disc has the other side in it. Places in single precision are off by up to 1·10⁻⁶.
            let range = |side: DVec3| {
                let along = d.dot(side);
                let rest = (depth * depth + along * along - sine * sine)
                    .max(0.0)
                    .sqrt();
                let (low, high) = (depth * rest + along * sine, depth * rest - along * sine);
                let tangent = |x: f64, depth: f64, beyond: f64| match depth > 0.0 {
                    true => x / depth,
                    false => beyond,
                };
                let first = tangent(along * rest - depth * sine, low, -2.0) - 1e-6;
                let last = tangent(along * rest + depth * sine, high, 2.0) + 1e-6;
                let at = |x: f64| ((0.5 * (x + 1.0)) * self.cells as f64).floor();
                (at(first).max(0.0), at(last).min(self.cells as f64 - 1.0))
            };
            let ((left, right), (top, bottom)) = (range(u), range(v));
            let mut y = top;
            while y <= bottom {
                let mut x = left;
                while x <= right {
                    each(((face * self.cells + y as usize) * self.cells + x as usize) as u32);
                    x += 1.0;
                }
                y += 1.0;
            }
        }
    }
}

/// The cell in which a direction lies, of twice as many as `half` along the edge of a face; its place on the face is right to 1·10⁻⁶.
#[inline(always)]
fn cell(half: f32, [x, y, z]: [f32; 3]) -> u32 {
    // The longest axis, and the others in turn after it.
    let (a, b, c) = (x.abs(), y.abs(), z.abs());
    let (is_x, is_y) = ((a >= b) & (a >= c), b >= c);
    let (first, u, v, face) = if is_y { (y, z, x, 2) } else { (z, x, y, 4) };
    let (first, u, v, face) = if is_x {
        (x, y, z, 0)
    } else {
        (first, u, v, face)
    };
    let face = face + u32::from(first < 0.0);
    // Rounding may reach the end of the last cell.
    let (scale, most) = (half / first.abs(), 2.0 * half - 1.0);
    let column = integer(lesser(greater(u * scale + half, 0.0).floor(), most));
    let row = integer(lesser(greater(v * scale + half, 0.0).floor(), most));
    let cells = integer(2.0 * half);
    (face * cells + row) * cells + column
}

/// Directions of a block to cells.
struct Cells<'a> {
    /// Half as many as there are cells along the edge of a face.
    halves: &'a [f32; BLOCK],
    directions: &'a Columns,
    begin: usize,
    cells: &'a mut [u32; BLOCK],
}

impl VectorLoop for Cells<'_> {
    #[inline(always)]
    fn run(self) {
        let d = self.directions.block(self.begin);
        let (mut x, mut y, mut z) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
        for k in 0..BLOCK {
            let d = d.get(k).as_vec3();
            (x[k], y[k], z[k]) = (d.x, d.y, d.z);
        }
        for k in 0..BLOCK {
            self.cells[k] = cell(self.halves[k], [x[k], y[k], z[k]]);
        }
    }
}

/// The outward axis of a face of the cube, and its sides.
pub(super) fn axes(face: usize) -> (DVec3, DVec3, DVec3) {
    let sign = if face.is_multiple_of(2) { 1.0 } else { -1.0 };
    match face / 2 {
        0 => (DVec3::X * sign, DVec3::Y, DVec3::Z),
        1 => (DVec3::Y * sign, DVec3::Z, DVec3::X),
        _ => (DVec3::Z * sign, DVec3::X, DVec3::Y),
    }
}

/// The face of the cube that `d` goes through, and where, from −1 to 1 along its sides.
#[inline]
pub(super) fn on_cube(d: DVec3) -> (usize, [f64; 2]) {
    let a = d.abs();
    if a.x >= a.y && a.x >= a.z {
        (usize::from(d.x < 0.0), [d.y / a.x, d.z / a.x])
    } else if a.y >= a.z {
        (2 + usize::from(d.y < 0.0), [d.z / a.y, d.x / a.y])
    } else {
        (4 + usize::from(d.z < 0.0), [d.x / a.z, d.y / a.z])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_near_no_star_lie_in_no_disc_and_are_most() {
        let mut state = 3u64;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let mut vector = || DVec3::new(next(), next(), next()).normalize();
        let stars: Vec<_> = (0..3000)
            .map(|_| Star::new(vector(), 5000.0, 1.0))
            .collect();
        // As small as discs may be, and as wide as some pixels.
        for radius in [1e-9, 7e-4] {
            let map = StarMap::new(stars.clone(), radius);
            let mut directions = Columns::default();
            for k in 0..5000 {
                // Every fifth within a disc or at its edge.
                let d = match k % 5 {
                    0 => (stars[k % 3000].direction + vector() * radius).normalize(),
                    _ => vector(),
                };
                directions.push(d);
            }
            let mut is_near = vec![false; directions.len()];
            let angles = PixelAngles {
                angle: 0.0,
                pixel: 0.0,
                ratios: &vec![1.0; directions.len()],
            };
            map.each_near(&directions, angles, |k| is_near[k] = true);
            let mut seen = 0;
            for (k, is_near) in is_near.iter().enumerate() {
                let d = directions.get(k);
                let lies_in = stars.iter().any(|s| d.dot(s.direction) > map.cosine);
                assert!(*is_near || !lies_in, "{radius} {d}");
                assert!(*is_near || map.radiance(d, 0.0, |_| [1.0; 3]) == [0.0; 3]);
                seen += usize::from(lies_in);
            }
            assert!(radius < 1e-6 || seen > 300, "{seen}");
            let near = is_near.iter().filter(|near| **near).count();
            assert!((1000..2000).contains(&near), "{near}");
        }
    }

    /// Cells of directions are found in single precision, which takes those closer to a cell's edge than its rounding for the next cell's.
    #[test]
    fn a_disc_that_ends_before_the_edge_of_a_cell_is_found_beyond_it() {
        const RADIUS: f64 = 3e-7;
        // On the face z = 1, where x = 0 is an edge between cells: directions just before it, and for each a star whose disc ends little beyond the
        // direction. Near x = 0 an angle is as wide there as du / √(1 + y²).
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
            assert!(map.radiance(d, 0.0, |_| [1.0; 3]) != [0.0; 3], "{d}");
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
                let found = map.radiance(d, 0.0, |_| [0.0, 1.0, 0.0])[1] / map.density;
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

    /// Directions within some distance of −Z on the plane one before, and within a cap that is as large.
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

    /// Sums over pixel centres are within 0.4 % of the integral: so far the second ring of harmonics comes at the first one's zero.
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
                let seen = centres.map(|d| map.radiance(d, PIXEL, |star| [star.luminance(); 3])[0]);
                let light = seen.sum::<f64>() * PIXEL * PIXEL;
                assert!((light / 2.0 - 1.0).abs() < 4e-3, "{radius} {k}: {light}");
            }
        }
    }

    /// Where a disc is as wide as 1.2 pixels: sin² R = 1.96 a² − 0.36 sin² ρ = sin² ρ.
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
            let at = |pixel| map.radiance(d, pixel, |star| [star.luminance(); 3])[0];
            // All the same bits up to there, and little less beyond.
            let (narrow, wide) = (at(edge * (1.0 - 1e-9)), at(edge * (1.0 + 1e-9)));
            assert_eq!(narrow, at(0.0));
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
            // What is there of all places on their way, from no list.
            let reach = 0.8 * bound;
            let profile = Profile::new(map.sine, reach);
            let all = level.families.iter().flat_map(
                |Family {
                     merged, members, ..
                 }| {
                    let members = &level.members[members.start as usize..members.end as usize];
                    let moved = members
                        .iter()
                        .map(|m| (m.towards(merged, 0.6), m.parts.clone()));
                    let itself = (merged.direction, merged.parts.clone());
                    moved.chain(members.is_empty().then_some(itself))
                },
            );
            let all: Vec<_> = all.collect();
            for d in cap(150, 1.5, number as u64) {
                let found = map.widened(d, reach, |star| [star.luminance(); 3])[0];
                let mut expected = 0.0;
                for (place, parts) in &all {
                    let density = profile.density(d, *place);
                    let parts = &level.parts[parts.start as usize..parts.end as usize];
                    expected += density * parts.iter().map(|part| part.luminance).sum::<f64>();
                }
                assert!(
                    (found - expected).abs() <= 1e-9 * expected,
                    "{number} {d}: {found} {expected}"
                );
                // The last of this level, and the first of the next.
                if number + 1 < map.levels.len() {
                    let (last, first) = (
                        map.widened(d, bound, light),
                        map.widened(d, bound * (1.0 + 1e-12), light),
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
                let profile = Profile::new(map.sine, reach);
                let (mut off, mut more, mut whole) = (0.0, 0.0, 0.0);
                for d in cap(300, 0.4, 9) {
                    let found = map.widened(d, reach, |star| star.colour(w));
                    let mut expected = [0.0; 3];
                    for star in &stars {
                        let density = profile.density(d, star.direction);
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
                // Places within a square make most of that; on the whole there is as much light.
                assert!(off < 0.05 * whole, "{w} {reach}: {off} of {whole}");
                assert!(more.abs() < 0.01 * whole, "{w} {reach}: {more} of {whole}");
            }
        }
        // However many there are: 6 · 16² squares of the last level, each of at most 15 steps from 3000 to 12000 K.
        let last = map.level(map.levels.len() - 1);
        assert!(last.families.len() <= 6 * 256, "{}", last.families.len());
        for Family { merged, .. } in &last.families {
            assert!(merged.parts.len() <= 15, "{}", merged.parts.len());
        }
    }

    #[test]
    fn directions_near_no_star_see_none_in_pixels_of_any_width() {
        let stars = stars_at(&cap(500, 1.0, 11), 12);
        let map = StarMap::new(stars, 1e-4);
        let mut directions = Columns::default();
        // Far from them too.
        let all: Vec<_> = cap(3000, 3.0, 13);
        all.iter().for_each(|d| directions.push(*d));
        let ratios: Vec<_> = (0..all.len())
            .map(|k| 1e4 / 1.006f64.powi(k as i32))
            .collect();
        let angles = PixelAngles {
            angle: 0.0,
            pixel: 1e-2,
            ratios: &ratios,
        };
        let mut is_near = vec![false; all.len()];
        map.each_near(&directions, angles, |k| is_near[k] = true);
        let (mut seen, mut passed) = (0, 0);
        for ((d, w), is_near) in all.iter().zip(&ratios).zip(is_near) {
            let sees = map.radiance(*d, 1e-2 / w, |_| [1.0; 3]) != [0.0; 3];
            assert!(is_near || !sees, "{d} {w}");
            seen += usize::from(sees);
            passed += usize::from(!is_near);
        }
        assert!(seen > 500 && passed > 500, "{seen} {passed}");
    }
}
