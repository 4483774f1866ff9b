//! The cube of the surface of an object.

use std::ops::Range;

use glam::{DVec2, DVec3, Vec2};
use rayon::prelude::*;

use super::histogram::Histogram;
use super::part::{Part, Summary, kept};
use super::stored::Stored;
use super::{Baked, Bins, CubePrecision, PARTS, baked, check, paths};
use crate::accel::{Facing, Hit};
use crate::error::{Error, Message, Result, Setting};
use crate::mesh::atlas::{Corners, atlas};
use crate::render::journal::Journal;
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::sampler::{Sampler, pixel_key, samples_per_part, sobol};
use crate::render::trace::{Patch, RestFrame, Seen, Start, TimedPaths};
use crate::scene::model::{CubeBacks, Object, Scene};

/// What of an object is baked onto its texture.
#[derive(Debug, Clone, Copy)]
pub struct Surface {
    /// Index of the object in the scene.
    pub object: usize,
    /// Its texture coordinates.
    pub coordinates: Coordinates,
    /// Columns and rows of texels.
    pub size: [u32; 2],
}

/// Texture coordinates by which a surface is baked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinates {
    /// Of a set that the mesh has, in which every place has its own.
    Set(usize),
    /// Made for it: an [`atlas`](crate::mesh::atlas).
    Atlas,
}

/// The cube of the surface of an object by its texture coordinates; rows are kept in `journal`, where there is one.
///
/// # Errors
/// What [`check`] refuses, an object that the scene does not have, a texture without texels, surfaces that shine for ever, bins without width or number, energies beyond 65504 in half precision, no texture coordinates, some outside [0, 1], charts that overlap, a texture too small for an atlas,
/// lists of triangles or light of backs that take more than [`memory_left`](Prepared::memory_left), which fronts are taken off already, I/O errors of the journal, and [`Error::Cancelled`] when `progress` says so.
pub fn surface_cube(
    scene: &Scene,
    prepared: &Prepared,
    surface: &Surface,
    bins: &Bins,
    precision: CubePrecision,
    journal: Option<&Journal>,
    progress: &dyn Progress,
) -> Result<Baked> {
    let cube = match precision {
        CubePrecision::Single => cube::<f32>,
        CubePrecision::Half => cube::<u16>,
    };
    cube(scene, prepared, surface, bins, journal, progress)
}

fn cube<T: Stored>(
    scene: &Scene,
    prepared: &Prepared,
    surface: &Surface,
    bins: &Bins,
    journal: Option<&Journal>,
    progress: &dyn Progress,
) -> Result<Baked> {
    check(scene)?;
    check_size(scene, surface)?;
    let [width, height] = surface.size.map(|n| n as usize);
    bins.check::<T>(scene, width * height)?;
    let paths = paths(scene, prepared)?;
    let charts = Charts::new(scene, &paths, surface, prepared.memory_left)?;
    charts.check_backs(bins, T::PRECISION)?;
    // Rows of fronts, and those of backs behind them, where light may come to any.
    let sides = 1 + usize::from(charts.has_lit_backs);
    // A row of texels is the part that a journal keeps, and that threads share out.
    bins.check::<T>(scene, width * sides * height)?;
    let row = width * bins.count * 3;
    let mut values = vec![T::default(); sides * height * row];
    let sampler = Sampler::stratified(samples_per_part(prepared.layout.samples, PARTS));
    let sampling = (sampler.with_seed(scene.seed), prepared.layout.samples);
    let make = |i: usize| {
        let mut part = Part::new(bins);
        for j in 0..width {
            progress.check()?;
            let mut texel = Histogram::new(bins);
            charts.gather(&paths, bins, [j, i], sampling, &mut texel)?;
            part.push(&texel);
        }
        Ok(part)
    };
    // Rows come back in their order, so that sums do not depend on the number of threads.
    let rows: Vec<(Summary, Vec<bool>)> = values
        .par_chunks_mut(row)
        .enumerate()
        .map(|(i, values)| {
            let part = kept(journal, i, [width, bins.count], || make(i))?;
            // Zeros are there already: memory of what is never written is not taken.
            if part.summary.energy.span.is_some() {
                let places = values.iter_mut().zip(&part.values);
                places.for_each(|(place, value)| *place = T::of(*value));
            }
            progress.rays_done(width as u64 * u64::from(prepared.layout.samples));
            Ok((part.summary, part.covered))
        })
        .collect::<Result<_>>()?;
    let (summaries, covered): (Vec<Summary>, Vec<Vec<bool>>) = rows.into_iter().unzip();
    // What no light comes to needs no rows.
    let is_dark = |summary: &Summary| summary.energy.span.is_none();
    let sides = match summaries[height..].iter().all(is_dark) {
        true => 1,
        false => 2,
    };
    values.truncate(sides * height * row);
    let summaries = &summaries[..sides * height];
    // Bilinear lookups at the edge of a chart reach texels beyond it.
    let halves = values.chunks_mut(height * row).zip(covered.chunks(height));
    for (values, covered) in halves {
        fill_gutters(values, covered.concat(), [width, height], bins.count * 3);
    }
    let size = [sides * height, width];
    let baked = baked(scene, prepared, size, bins, values, summaries)?;
    Ok(Baked {
        backs: match sides {
            1 => CubeBacks::Black,
            _ => CubeBacks::SecondHalf,
        },
        texture_coordinates: charts.into_coordinates(&scene.objects[surface.object]),
        ..baked
    })
}

/// What the cube of a surface takes beside the numbers of its fronts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct SurfaceNeeds {
    /// Whether light may come to its back, which has as many rows of its own then.
    pub backs: bool,
    /// Bytes of the lists of triangles by texel.
    pub lists: u64,
}

/// Refuses surfaces that [`surface_cube`] would, before any light is followed, most that overlap among them; of others, what the cube takes.
///
/// # Errors
/// As there, but for those of the journal.
pub fn check_surface(
    scene: &Scene,
    prepared: &Prepared,
    surface: &Surface,
    bins: &Bins,
    precision: CubePrecision,
) -> Result<SurfaceNeeds> {
    check(scene)?;
    check_size(scene, surface)?;
    let paths = paths(scene, prepared)?;
    let charts = Charts::new(scene, &paths, surface, prepared.memory_left)?;
    charts.check_backs(bins, precision)?;
    Ok(SurfaceNeeds {
        backs: charts.has_lit_backs,
        lists: charts.bytes(),
    })
}

/// Refuses an object that the scene does not have, and textures without texels.
fn check_size(scene: &Scene, surface: &Surface) -> Result<()> {
    let refuse = |place, what, help: &str| Err(Error::invalid(&scene.name, place, what, help));
    let count = scene.objects.len();
    if surface.object >= count {
        let what = format!(
            "there is no object {}: the scene has {count}",
            surface.object
        );
        return refuse("object", what, "objects count from 0");
    }
    let [columns, rows] = surface.size;
    if columns == 0 || rows == 0 {
        let what = format!("a texture of {columns} × {rows} texels holds no light");
        return refuse("texels", what, "at least one column and one row");
    }
    Ok(())
}

/// The triangles of an object on its texture.
struct Charts<'a> {
    scene: &'a Scene,
    object: &'a str,
    triangles: Vec<ChartTriangle>,
    /// By texel, where the triangles that may lie in it begin in `listed`; at last, where all end.
    begins: Vec<u32>,
    listed: Vec<u32>,
    size: [usize; 2],
    /// Whether light may come to a back that is seen.
    has_lit_backs: bool,
    /// Bytes that are left beside it.
    left: u64,
    /// What was made for it, by triangle of its mesh.
    atlas: Option<Vec<Corners>>,
}

struct ChartTriangle {
    /// Id and slot in the tree.
    triangle: u32,
    slot: u32,
    /// Corners in texels.
    corners: [DVec2; 3],
    /// Whether its back is seen, and shines.
    has_back: bool,
}

impl<'a> Charts<'a> {
    /// The triangles of the object, laid into its texture, and for each texel those that touch it, within so many bytes.
    fn new(scene: &'a Scene, paths: &TimedPaths, surface: &Surface, memory: u64) -> Result<Self> {
        let rest = paths.rest;
        let object = scene.objects[surface.object].name.as_str();
        let size = surface.size.map(|n| n as usize);
        let mut charts = Charts {
            scene,
            object,
            triangles: Vec::new(),
            begins: Vec::new(),
            listed: Vec::new(),
            size,
            has_lit_backs: false,
            left: memory,
            atlas: None,
        };
        // The frame's tree holds other objects at rest with it, too.
        let of_object = |slot: &u32| {
            let patch = rest.patch(rest.bvh.triangle(*slot).0);
            patch.object as usize == surface.object
        };
        let slots: Vec<u32> = (0..rest.bvh.len() as u32).filter(of_object).collect();
        if surface.coordinates == Coordinates::Atlas {
            charts.atlas = Some(charts.made(rest, &slots, surface.size)?);
        }
        for slot in slots {
            let (triangle, _) = rest.bvh.triangle(slot);
            let patch = rest.patch(triangle);
            let corners = match (&charts.atlas, surface.coordinates) {
                (None, Coordinates::Set(set)) => {
                    charts.of_set(rest, patch, set, [triangle, slot])?
                }
                (made, _) => {
                    let corners = made.as_ref().map_or([[0.0; 2]; 3], |made| {
                        made[(triangle - patch.object_first) as usize]
                    });
                    corners.map(|uv| Vec2::from(uv).as_dvec2())
                }
            };
            let (_, facing) = rest.bvh.triangle(slot);
            let has_back = facing == Facing::TwoSided && !patch.black_back;
            let scale = DVec2::new(size[0] as f64, size[1] as f64);
            charts.triangles.push(ChartTriangle {
                triangle,
                slot,
                corners: corners.map(|uv| uv * scale),
                has_back,
            });
        }
        charts.list()?;
        charts.check_areas(rest)?;
        let backs = charts.triangles.iter().filter(|t| t.has_back);
        charts.has_lit_backs = paths.may_light_backs(backs.map(|t| t.slot));
        Ok(charts)
    }

    /// Refuses texture coordinates on which triangles lie in points and lines, where no sample would meet them.
    fn check_areas(&self, rest: &RestFrame) -> Result<()> {
        // Of the object's surface: what f32 leaves of a triangle that is a line itself, which loses nothing.
        const LEAST: f64 = 1e-7;
        let area = |t: &ChartTriangle| {
            let [a, b, c] = rest.bvh.corners(t.slot);
            0.5 * (b - a).cross(c - a).length()
        };
        let least = LEAST * self.triangles.iter().map(area).sum::<f64>();
        let has_area = |t: &&ChartTriangle| area(t) > least;
        let all = self.triangles.iter().filter(has_area);
        let flat = all.clone().filter(|t| t.is_flat(self.size)).count();
        let what = match (flat, all.count()) {
            (flat, all) if flat == all => "its texture coordinates have no area".into(),
            // An atlas has slivers of slivers.
            (1.., all) if self.atlas.is_none() => format!(
                "{flat} of its {all} triangles have texture coordinates without an area, where no light can be baked"
            ),
            _ => return Ok(()),
        };
        let help = other_coordinates("for every place");
        Err(self.refuse(what, help))
    }

    /// Refuses light of backs that takes more memory than is left.
    fn check_backs(&self, bins: &Bins, precision: CubePrecision) -> Result<()> {
        let [width, height] = self.size.map(|n| n as u32);
        let of_sides =
            |sides: u32| super::bytes([width, height.saturating_mul(sides)], bins, precision, 0);
        let more = of_sides(2) - of_sides(1);
        if !self.has_lit_backs || more <= self.left {
            return Ok(());
        }
        let gigabytes = |bytes: u64| bytes as f64 / 1e9;
        let what = format!(
            "light may come to its back, whose rows take {:.3} GB: the limit leaves {:.3} GB beside those of its front",
            gigabytes(more),
            gigabytes(self.left)
        );
        let help = Message::from(
            "fewer texels or bins, backs that are not seen (display.back_faces = \"black\"), or a higher ",
        ) + Setting::MemoryLimit;
        Err(self.refuse(what, help))
    }

    /// Bytes of its lists.
    fn bytes(&self) -> u64 {
        let listed = size_of::<u32>() * (self.begins.len() + self.listed.len());
        (size_of::<ChartTriangle>() * self.triangles.len() + listed) as u64
    }

    /// An atlas of the object, whose triangles are in these slots: by triangle of its mesh.
    fn made(&self, rest: &RestFrame, slots: &[u32], size: [u32; 2]) -> Result<Vec<Corners>> {
        let Some(first) = slots.first() else {
            return Ok(Vec::new());
        };
        let patch = rest.patch(rest.bvh.triangle(*first).0);
        let parts = &rest.meshes[patch.mesh as usize].parts;
        let count: u32 = parts.iter().map(|part| part.triangles).sum();
        // Triangles without an area may have no slot.
        let mut triangles = vec![[DVec3::ZERO; 3]; count as usize];
        for slot in slots {
            let (triangle, _) = rest.bvh.triangle(*slot);
            triangles[(triangle - patch.object_first) as usize] = rest.bvh.corners(*slot);
        }
        atlas(&triangles, size).map_err(|error| {
            let help = Setting::TexelsOf + format!(" {0}x{0} or more", error.least);
            self.refuse(error.to_string(), help)
        })
    }

    /// The atlas by triangles as the mesh's file has them: a mirroring transform exchanges two of their corners.
    fn into_coordinates(self, object: &Object) -> Option<Vec<Corners>> {
        let mut atlas = self.atlas?;
        if object.transform.matrix3.determinant() < 0.0 {
            atlas.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        Some(atlas)
    }

    fn refuse(&self, what: String, help: impl Into<Message>) -> Error {
        let place = format!("object \"{}\"", self.object);
        Error::invalid(&self.scene.name, place, what, help)
    }

    /// The coordinates of a triangle in a set that the mesh has.
    fn of_set(
        &self,
        rest: &RestFrame,
        patch: &Patch,
        set: usize,
        [triangle, slot]: [u32; 2],
    ) -> Result<[DVec2; 3]> {
        let help = || other_coordinates("for every place, within 0 to 1");
        let at = |u, v| rest.uv(patch, set, &place(triangle, slot, [u, v]));
        let corners = [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)];
        let [Some(a), Some(b), Some(c)] = corners else {
            let what = format!("it has no texture coordinates of set {set}");
            return Err(self.refuse(what, help()));
        };
        let corners = [a, b, c];
        // What was stored in f32 may be a little beyond.
        let inside = |uv: DVec2| uv.min_element() >= -1e-6 && uv.max_element() <= 1.0 + 1e-6;
        if let Some(uv) = corners.into_iter().find(|uv| !inside(*uv)) {
            let what = format!(
                "its texture coordinates ({}, {}) are outside of 0 to 1",
                uv.x, uv.y
            );
            return Err(self.refuse(what, help()));
        }
        Ok(corners)
    }

    /// Lists the triangles by the texels that they reach.
    ///
    /// # Errors
    /// Triangles that lie on others at the centre of a texel: most overlaps are found here, before any light is followed. More memory
    /// than is left.
    fn list(&mut self) -> Result<()> {
        let texels = self.size[0] * self.size[1];
        self.take(size_of::<ChartTriangle>() * self.triangles.len())?;
        self.take(size_of::<u32>() * (texels + 1))?;
        // How many reach each texel, and whether its centre is inside one.
        self.begins = vec![0; texels + 1];
        let mut centres = vec![false; texels];
        for k in 0..self.triangles.len() {
            for (i, columns) in self.triangles[k].reaches(self.size) {
                self.take(size_of::<u32>() * columns.len())?;
                for j in columns {
                    let texel = i * self.size[0] + j;
                    self.begins[texel] += 1;
                    let centre = DVec2::new(j as f64 + 0.5, i as f64 + 0.5);
                    if self.triangles[k].barycentric(centre).is_some_and(is_inside)
                        && std::mem::replace(&mut centres[texel], true)
                    {
                        return Err(self.overlap(2, centre));
                    }
                }
            }
        }
        // Where the list of each texel ends, from where it is filled backwards, from the last triangle on.
        let mut sum = 0u32;
        for begin in &mut self.begins {
            sum = match sum.checked_add(*begin) {
                Some(sum) => sum,
                None => return Err(self.too_long()),
            };
            *begin = sum;
        }
        self.listed = vec![0; sum as usize];
        for (k, triangle) in self.triangles.iter().enumerate().rev() {
            for (i, columns) in triangle.reaches(self.size) {
                for begin in &mut self.begins[i * self.size[0]..][columns] {
                    *begin -= 1;
                    self.listed[*begin as usize] = k as u32;
                }
            }
        }
        Ok(())
    }

    /// Takes so many bytes of those that are left.
    fn take(&mut self, bytes: usize) -> Result<()> {
        match self.left.checked_sub(bytes as u64) {
            Some(left) => self.left = left,
            None => return Err(self.too_long()),
        }
        Ok(())
    }

    fn too_long(&self) -> Error {
        let what = "its charts reach so many texels that lists of them take more memory than the limit leaves";
        let help = Message::from("fewer texels, or a higher ") + Setting::MemoryLimit;
        self.refuse(what.into(), help)
    }

    /// The triangles that may lie in a texel.
    fn reaching(&self, texel: usize) -> &[u32] {
        &self.listed[self.begins[texel] as usize..self.begins[texel + 1] as usize]
    }

    /// The refusal of charts of which so many triangles share a point, in texels.
    fn overlap(&self, triangles: u32, point: DVec2) -> Error {
        let what = format!(
            "its charts overlap: {triangles} triangles share the texture coordinates ({:.4}, {:.4})",
            point.x / self.size[0] as f64,
            point.y / self.size[1] as f64
        );
        let help = other_coordinates("for every place");
        self.refuse(what, help)
    }

    /// The place of the front, or of the back, of the surface at a point of the texture, in texels.
    fn locate(&self, [j, i]: [usize; 2], point: DVec2, front: bool) -> Result<Option<Hit>> {
        let mut found = None;
        let mut inside = 0;
        for index in self.reaching(i * self.size[0] + j) {
            let triangle = &self.triangles[*index as usize];
            let Some([u, v]) = triangle.barycentric(point) else {
                continue;
            };
            let least = u.min(v).min(1.0 - u - v);
            if least >= 0.0 && (front || triangle.has_back) {
                let at = place(triangle.triangle, triangle.slot, [u, v]);
                // On an edge that triangles share the first of them has it.
                found = found.or(Some(Hit { front, ..at }));
            }
            inside += u32::from(is_inside([u, v]));
        }
        if inside > 1 {
            return Err(self.overlap(inside, point));
        }
        Ok(found)
    }

    /// Adds all samples of a texel that lie on the surface; rows from the height of the texture on are those of backs.
    fn gather(
        &self,
        paths: &TimedPaths,
        bins: &Bins,
        [j, i]: [usize; 2],
        (sampler, samples): (Sampler, u32),
        texel: &mut Histogram,
    ) -> Result<()> {
        let height = self.size[1];
        let row = i % height;
        // Part by part, and of a large part so many paths at a time.
        let (per_part, mut begin) = (sampler.samples(), 0);
        while begin < samples {
            let end = (begin + TOGETHER).min((begin / per_part + 1) * per_part);
            let end = end.min(samples);
            let mut starts = Vec::new();
            for sample in begin..end {
                let (within, salt) = sampler.replicate(sample);
                let key = pixel_key(j as u32, i as u32) ^ salt;
                let [x, y] = sobol(key, within, IN_TEXEL);
                let point = DVec2::new(j as f64 + x, row as f64 + y);
                if let Some(hit) = self.locate([j, row], point, i < height)? {
                    starts.push(Start {
                        hit,
                        seen: Seen::Diffuse,
                        sample: (key, within),
                    });
                }
            }
            texel.found += starts.len() as u32;
            paths.follow(&starts, per_part, |path, emission, light, delay| {
                let clock = paths.clock(paths.rest.patch(starts[path].hit.triangle));
                texel.add(bins, emission, light, delay + clock);
            });
            if end.is_multiple_of(per_part) {
                texel.end_part();
            }
            begin = end;
        }
        Ok(())
    }
}

/// Paths of a texel that are followed together.
const TOGETHER: u32 = 1024;

/// What random numbers of a texel are for, beside those of its paths.
const IN_TEXEL: u32 = 1 << 16;

/// What to do about texture coordinates that are not what a bake needs: those that a mesh should have.
fn other_coordinates(needed: &str) -> Message {
    Setting::Atlas
        + format!(", which makes coordinates; a mesh that has its own {needed}; or ")
        + Setting::CameraCube
}

/// A place of a triangle, on its front.
fn place(triangle: u32, slot: u32, [u, v]: [f64; 2]) -> Hit {
    Hit {
        s: 0.0,
        u,
        v,
        triangle,
        slot,
        front: true,
    }
}

/// Whether a point of these weights is in a triangle by more than rounding: points on a shared edge are in both triangles, and charts
/// overlap only where a point is inside two.
fn is_inside([u, v]: [f64; 2]) -> bool {
    u.min(v).min(1.0 - u - v) > 1e-6
}

impl ChartTriangle {
    /// The rows of texels that it reaches, and of each the columns: those between the ends of what the row has of its edges.
    fn reaches(&self, size: [usize; 2]) -> impl Iterator<Item = (usize, Range<usize>)> + use<> {
        // Points that rounding puts inside lie no farther away, texels.
        const MARGIN: f64 = 1e-6;
        let corners = self.corners;
        let span = |low: f64, high: f64, size: usize| {
            (low - MARGIN).max(0.0) as usize..((high + MARGIN).max(0.0) as usize + 1).min(size)
        };
        let low = corners[0].min(corners[1]).min(corners[2]);
        let high = corners[0].max(corners[1]).max(corners[2]);
        span(low.y, high.y, size[1]).map(move |i| {
            let [from, to] = [i as f64 - MARGIN, i as f64 + 1.0 + MARGIN];
            let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
            for (k, p) in corners.into_iter().enumerate() {
                let q = corners[(k + 1) % 3];
                if p.y.max(q.y) < from || p.y.min(q.y) > to {
                    continue;
                }
                for end in [p, q] {
                    // An end beyond the row counts where the edge crosses the row's border.
                    let y = end.y.clamp(from, to);
                    let x = match y == end.y {
                        true => end.x,
                        false => p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y)),
                    };
                    (left, right) = (left.min(x), right.max(x));
                }
            }
            (i, span(left, right, size[0]))
        })
    }

    /// Whether it is a point or a line on a texture of this size.
    fn is_flat(&self, size: [usize; 2]) -> bool {
        // Twice the distance of f32 below 1: what rounding makes of coordinates that are meant to be on one line.
        const WIDTH: f64 = f32::EPSILON as f64;
        let [a, b, c] = self
            .corners
            .map(|p| p / DVec2::new(size[0] as f64, size[1] as f64));
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        (b - a).perp_dot(c - a).abs() <= WIDTH * longest
    }

    /// The weights of the second and third corner at a point; none where the triangle has no area on the texture.
    fn barycentric(&self, point: DVec2) -> Option<[f64; 2]> {
        let [a, b, c] = self.corners;
        let (b, c, p) = (b - a, c - a, point - a);
        let area = b.perp_dot(c);
        let (u, v) = (p.perp_dot(c) / area, b.perp_dot(p) / area);
        (u.is_finite() && v.is_finite()).then_some([u, v])
    }
}

/// Gives texels beside charts the mean of their neighbours on them, two texels wide, so that bilinear lookups find no black there.
fn fill_gutters<T: Stored>(
    values: &mut [T],
    mut covered: Vec<bool>,
    [width, height]: [usize; 2],
    stride: usize,
) {
    for _ in 0..2 {
        let known = covered.clone();
        for texel in (0..width * height).filter(|texel| !known[*texel]) {
            let (i, j) = (texel / width, texel % width);
            let rows = i.saturating_sub(1)..(i + 2).min(height);
            let around = rows.flat_map(|i| {
                (j.saturating_sub(1)..(j + 2).min(width)).map(move |j| i * width + j)
            });
            let around: Vec<usize> = around.filter(|k| known[*k]).collect();
            if around.is_empty() {
                continue;
            }
            for at in 0..stride {
                let sum: f32 = around
                    .iter()
                    .map(|k| values[k * stride + at].number())
                    .sum();
                values[texel * stride + at] = T::of(sum / around.len() as f32);
            }
            covered[texel] = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers from 0 to 1 that look random: a linear congruential generator.
    fn random() -> impl FnMut() -> f64 {
        let mut state = 1u64;
        move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    #[test]
    fn a_triangle_reaches_every_texel_that_has_a_point_of_it_and_few_others() {
        let mut random = random();
        let size = [40, 30];
        let mut listed = 0;
        for k in 0..200 {
            let mut corner = || DVec2::new(40.0 * random(), 30.0 * random());
            let [a, b, mut c] = [corner(), corner(), corner()];
            // Every other one is a sliver.
            if k % 2 == 0 {
                c = a.lerp(b, 0.3) + 1e-3 * (c - a);
            }
            let triangle = ChartTriangle {
                triangle: 0,
                slot: 0,
                corners: [a, b, c],
                has_back: false,
            };
            let mut reached = vec![false; size[0] * size[1]];
            for (i, columns) in triangle.reaches(size) {
                listed += columns.len();
                columns.for_each(|j| reached[i * size[0] + j] = true);
            }
            for _ in 0..1000 {
                let (u, v) = (random(), random());
                let (u, v) = if u + v > 1.0 {
                    (1.0 - u, 1.0 - v)
                } else {
                    (u, v)
                };
                let point = a + u * (b - a) + v * (c - a);
                assert!(
                    reached[point.y as usize * size[0] + point.x as usize],
                    "{point}"
                );
            }
        }
        // Half of them are 1/13 of a rectangle of 40 × 30 on average, the others lines about 18 texels long: with edges, fewer than
        // 160 and 40 texels. The rectangles around them have 133.
        assert!(listed < 100 * (160 + 40), "{listed}");
    }
}
