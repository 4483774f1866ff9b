//! Stars seen by pixels wider than their discs: spread over about a pixel, and merged where one pixel holds many.
//!
//! Implements the derivation at the head of `stars`: levels for discs up to some width, and sums of similar stars. What rays see of a level
//! is added up in `tally`.

use std::ops::Range;

use glam::DVec3;

use super::faces::{Grid, Index};
use super::star::{Star, luminance};

/// Step of 1/T for merging stars, 1/K: ½ in c₂/(λT), at 0.55 µm.
const STEP: f64 = 0.5 * 0.55e-6 / 1.438_777e-2;
/// Number of steps, down to 817 K; colder stars are in the last.
const STEPS: usize = 64;
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
    pub index: Index<NearFamily>,
}

/// What tells whether rays may see a family.
#[derive(Debug, Clone, Copy)]
pub(super) struct NearFamily {
    pub number: u32,
    /// The direction of its merged place, and the longest chord from there to a member.
    pub middle: DVec3,
    pub spread: f64,
}

/// Places that the next level merges into one.
#[derive(Debug, Clone)]
pub(super) struct Family {
    pub merged: Place,
    /// Its members; empty for a single place, which does not move.
    pub members: Range<u32>,
    /// Where they are in [`Level::finer`].
    pub finer: Range<u32>,
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
    pub solid_angle: f64,
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
        // Squares with indices are all different: the order is the same for any kind of sort.
        order.sort_unstable();
        let (mut families, mut near) = (Vec::new(), Vec::new());
        let (mut members, mut parts) = (Vec::new(), Vec::new());
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
            near.push(NearFamily {
                number: families.len() as u32,
                middle: merged.direction,
                spread: chords.fold(0.0, f64::max),
            });
            families.push(Family {
                merged,
                members: begin..members.len() as u32,
                finer,
            });
        }
        // Discs around the merged places: at the end of the move they have the whole radius, and at the start half of it, which reaches
        // less far, as they move by at most the diagonal of a square.
        let sine = (FARTHEST_OF_LEVEL * reach).min(FARTHEST);
        let grid = Grid {
            cells: (2.0 / reach) as usize,
        };
        let disc = |family: &NearFamily| (*family, family.middle, sine);
        let index = Index::new(grid, near.iter().map(disc));
        // What lists have grown beyond their lengths is given back.
        families.shrink_to_fit();
        members.shrink_to_fit();
        parts.shrink_to_fit();
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
    pub fn towards(&self, merged: &Place, way: f64) -> DVec3 {
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
    pub fn none() -> Sums {
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
    pub fn clear(&mut self) {
        (self.some, self.many) = (0, 0);
    }

    /// Adds a part with `times` its light and at this W_s/W_d, unless it is dark.
    #[inline(always)]
    pub fn add(&mut self, part: &Part, times: f64, ratio: f64) {
        if part.luminance > 0.0 {
            let step = part.step % STEPS;
            // Sums are not cleared one by one: without its bit, a step holds old numbers.
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
    pub fn parts(&self) -> impl Iterator<Item = Part> {
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
