//! The light cube of an object's surface.

use std::ops::Range;

use glam::{DVec2, DVec3, Vec2};
use rayon::prelude::*;

use super::charts::{self, Readers, reached};
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
use crate::render::trace::{Patch, RestFrame, Start, TimedPaths, Viewpoint};
use crate::scene::model::{CubeBacks, Object, Scene};

/// Which object is baked, and onto which texture.
#[derive(Debug, Clone, Copy)]
pub struct Surface {
    /// Index of the object in the scene.
    pub object: usize,
    /// Its texture coordinates.
    pub coordinates: Coordinates,
    /// Columns and rows of texels.
    pub size: [u32; 2],
}

/// Texture coordinates for baking a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinates {
    /// A set of the mesh in which no two points of the surface share coordinates.
    Set(usize),
    /// Generated: an [`atlas`](crate::mesh::atlas).
    Atlas,
}

/// The cube of an object's surface by its texture coordinates; finished rows are stored in `journal`, if given.
///
/// # Errors
/// Whatever [`check`] refuses, an object that is not in the scene, a texture without texels, surfaces that shine for ever, bins without
/// width or number, energies above 65504 in half precision, no texture coordinates, some outside [0, 1], charts that overlap, a texture too
/// small for an atlas, lists of triangles or light of backs that take more than [`memory_left`](Prepared::memory_left) (from which the
/// fronts are already subtracted), I/O errors of the journal, and [`Error::Cancelled`] when `progress` says so.
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
    // Rows of fronts, followed by those of backs if light may reach any of them.
    let sides = 1 + usize::from(charts.has_lit_backs);
    // The journal stores rows of texels, and threads share them out.
    bins.check::<T>(scene, width * sides * height)?;
    let row = width * bins.count * 3;
    let mut values = vec![T::default(); sides * height * row];
    let texels = Texels {
        charts: &charts,
        paths: &paths,
        bins,
    };
    let sampling = sampling(scene.seed, prepared.layout.samples);
    let make = |i: usize| texels.row(i, 0..width, sampling, progress);
    // Rows are collected in order, so that sums do not depend on the number of threads.
    let rows: Vec<(Summary, Vec<bool>)> = values
        .par_chunks_mut(row)
        .enumerate()
        .map(|(i, values)| {
            let mut part = kept(journal, i, [width, bins.count], || make(i))?;
            // The values are zero already: memory that is never written is never allocated.
            if part.summary.energy.span.is_some() {
                part.summary.faint = T::faint(&part.values);
                let places = values.iter_mut().zip(&part.values);
                places.for_each(|(place, value)| *place = T::of(*value));
            }
            progress.rays_done(width as u64 * u64::from(prepared.layout.samples));
            Ok((part.summary, part.covered))
        })
        .collect::<Result<_>>()?;
    let (summaries, covered): (Vec<Summary>, Vec<Vec<bool>>) = rows.into_iter().unzip();
    // Sides that no light reaches need no rows.
    let is_dark = |summary: &Summary| summary.energy.span.is_none();
    let sides = match summaries[height..].iter().all(is_dark) {
        true => 1,
        false => 2,
    };
    values.truncate(sides * height * row);
    let summaries = &summaries[..sides * height];
    // Bilinear lookups at the edge of a chart read texels beyond it.
    let halves = values.chunks_mut(height * row).zip(covered.chunks(height));
    for (values, covered) in halves {
        let (covered, stride) = (covered.concat(), bins.count * 3);
        fill_gutters(values, covered, &charts.readers, [width, height], stride);
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

/// The sampler of so many samples per texel, in independent parts, and their number.
pub(super) fn sampling(seed: u32, samples: u32) -> (Sampler, u32) {
    let sampler = Sampler::stratified(samples_per_part(samples, PARTS));
    (sampler.with_seed(seed), samples)
}

/// How the texels of a surface are computed.
pub(super) struct Texels<'a> {
    pub charts: &'a Charts<'a>,
    pub paths: &'a TimedPaths<'a>,
    pub bins: &'a Bins,
}

impl Texels<'_> {
    /// The texels of row `i` in these columns; rows from the height of the texture on are rows of backs.
    pub fn row(
        &self,
        i: usize,
        columns: impl Iterator<Item = usize>,
        sampling: (Sampler, u32),
        progress: &dyn Progress,
    ) -> Result<Part> {
        let Texels {
            charts,
            paths,
            bins,
        } = self;
        let mut part = Part::new(bins, columns.size_hint().0);
        for j in columns {
            progress.check()?;
            let mut texel = Histogram::new(bins);
            charts.gather(paths, bins, [j, i], sampling, &mut texel)?;
            part.push(&texel);
        }
        Ok(part)
    }
}

/// Requirements of a surface's cube besides the numbers of its fronts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct SurfaceNeeds {
    /// Whether light may reach its back, which then has as many rows of its own.
    pub backs: bool,
    /// Bytes of the per-texel lists of triangles.
    pub lists: u64,
    /// Number of texels that lookups on several charts read, where light of one shows on another: charts less than two texels apart.
    pub shared: u64,
}

/// Refuses the surfaces that [`surface_cube`] would refuse, before any light is traced, including most overlapping charts; otherwise
/// returns the cube's requirements.
///
/// # Errors
/// As for [`surface_cube`], except those of the journal.
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
        shared: charts.readers.shared(),
    })
}

/// Refuses an object that is not in the scene, and textures without texels.
pub(super) fn check_size(scene: &Scene, surface: &Surface) -> Result<()> {
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

/// The triangles of an object in texture space.
pub(super) struct Charts<'a> {
    scene: &'a Scene,
    object: &'a str,
    triangles: Vec<ChartTriangle>,
    /// By texel, where its candidate triangles begin in `listed`; the last entry is the end of the list.
    begins: Vec<u32>,
    listed: Vec<u32>,
    readers: Readers,
    size: [usize; 2],
    /// Whether light may reach a visible back.
    pub has_lit_backs: bool,
    /// Bytes of memory left besides this.
    left: u64,
    /// The generated atlas, by triangle of the object's mesh.
    atlas: Option<Vec<Corners>>,
}

struct ChartTriangle {
    /// Id and slot in the tree.
    triangle: u32,
    slot: u32,
    /// Corners in texels.
    corners: [DVec2; 3],
    /// Whether its back is visible and not black.
    has_back: bool,
}

impl<'a> Charts<'a> {
    /// Lays the triangles of the object into its texture, and lists for each texel those that touch it, within `memory` bytes.
    pub fn new(
        scene: &'a Scene,
        paths: &TimedPaths,
        surface: &Surface,
        memory: u64,
    ) -> Result<Self> {
        let rest = paths.rest;
        let object = scene.objects[surface.object].name.as_str();
        let size = surface.size.map(|n| n as usize);
        let mut charts = Charts {
            scene,
            object,
            triangles: Vec::new(),
            begins: Vec::new(),
            listed: Vec::new(),
            readers: Readers::default(),
            size,
            has_lit_backs: false,
            left: memory,
            atlas: None,
        };
        // The frame's tree also holds other objects at rest relative to it.
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
        charts.find_readers(rest)?;
        let backs = charts.triangles.iter().filter(|t| t.has_back);
        charts.has_lit_backs = paths.may_light_backs(backs.map(|t| t.slot));
        Ok(charts)
    }

    /// Refuses texture coordinates that collapse triangles to points or lines, which no sample would hit.
    fn check_areas(&self, rest: &RestFrame) -> Result<()> {
        // As a fraction of the object's surface: the area that f32 rounding gives to a degenerate triangle, which loses no light.
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
            // In an atlas, slivers of the mesh remain slivers.
            (1.., all) if self.atlas.is_none() => format!(
                "{flat} of its {all} triangles have texture coordinates without an area, where no light can be baked"
            ),
            _ => return Ok(()),
        };
        let help = other_coordinates("for every place");
        Err(self.refuse(what, help))
    }

    /// Refuses light of backs that needs more memory than is left.
    fn check_backs(&self, bins: &Bins, precision: CubePrecision) -> Result<()> {
        let [width, height] = self.size.map(|n| n as u32);
        let of_sides = |sides: u32| {
            super::surface_bytes([width, height.saturating_mul(sides)], bins, precision, 0)
        };
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

    /// Bytes of the lists of triangles.
    fn bytes(&self) -> u64 {
        let listed = size_of::<u32>() * (self.begins.len() + self.listed.len());
        (size_of::<ChartTriangle>() * self.triangles.len() + listed + self.readers.bytes()) as u64
    }

    /// Generates an atlas of the object, whose triangles are in these slots, by triangle of its mesh.
    fn made(&self, rest: &RestFrame, slots: &[u32], size: [u32; 2]) -> Result<Vec<Corners>> {
        let Some(first) = slots.first() else {
            return Ok(Vec::new());
        };
        let patch = rest.patch(rest.bvh.triangle(*first).0);
        let parts = &rest.meshes[patch.mesh as usize].parts;
        let count: u32 = parts.iter().map(|part| part.triangles).sum();
        // Triangles of zero area may have no slot.
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

    /// The atlas by triangle in the order of the mesh's file: a mirroring transform swaps two of their corners.
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

    /// The coordinates of a triangle in a set of the mesh.
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
        // Values stored in f32 may be slightly outside.
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

    /// Lists the triangles by the texels that they touch.
    ///
    /// # Errors
    /// Triangles that overlap at the centre of a texel (beside it, if there is only one): most overlaps are found here, before any light is traced. More memory than is left.
    fn list(&mut self) -> Result<()> {
        let texels = self.size[0] * self.size[1];
        self.take(size_of::<ChartTriangle>() * self.triangles.len())?;
        self.take(size_of::<u32>() * (texels + 1))?;
        // How many triangles touch each texel, and whether its centre is inside one.
        self.begins = vec![0; texels + 1];
        let mut centres = vec![false; texels];
        // The centre of a single texel lies on the diagonals that divide squares, where no triangle has an inside.
        let within = match texels {
            1 => DVec2::new(0.5, 0.25),
            _ => DVec2::splat(0.5),
        };
        for k in 0..self.triangles.len() {
            for (i, columns) in self.triangles[k].reaches(self.size) {
                self.take(size_of::<u32>() * columns.len())?;
                for j in columns {
                    let texel = i * self.size[0] + j;
                    self.begins[texel] += 1;
                    let centre = DVec2::new(j as f64, i as f64) + within;
                    if self.triangles[k].barycentric(centre).is_some_and(is_inside)
                        && std::mem::replace(&mut centres[texel], true)
                    {
                        return Err(self.overlap(2, centre));
                    }
                }
            }
        }
        // Where the list of each texel ends; it is filled backwards, from the last triangle on.
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

    /// Finds the chart whose lookups read each texel.
    fn find_readers(&mut self, rest: &RestFrame) -> Result<()> {
        let left = self.left;
        let texels = self.size[0] * self.size[1];
        self.take(charts::BYTES * self.triangles.len() + size_of::<u32>() * texels)?;
        let corners = |k: usize| {
            let triangle = &self.triangles[k];
            (rest.bvh.corners(triangle.slot), triangle.corners)
        };
        self.readers = Readers::of(self.triangles.len(), corners, self.size);
        self.left = left.saturating_sub(self.readers.bytes() as u64);
        Ok(())
    }

    /// Subtracts `bytes` from the memory left.
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

    /// The error for charts in which this many triangles share a point, in texels.
    fn overlap(&self, triangles: u32, point: DVec2) -> Error {
        let what = format!(
            "its charts overlap: {triangles} triangles share the texture coordinates ({:.4}, {:.4})",
            point.x / self.size[0] as f64,
            point.y / self.size[1] as f64
        );
        let help = other_coordinates("for every place");
        self.refuse(what, help)
    }

    /// The point on the front or back of the surface at a point of the texture, in texels.
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
                // On a shared edge the first triangle is taken.
                found = found.or(Some(Hit { front, ..at }));
            }
            inside += u32::from(is_inside([u, v]));
        }
        if inside > 1 {
            return Err(self.overlap(inside, point));
        }
        Ok(found)
    }

    /// Adds all samples of a texel that lie on the surface; rows from the height of the texture on are rows of backs.
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
        // Part by part; a large part is traced in batches of limited size.
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
                        seen: Viewpoint::Diffuse,
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

/// Paths of a texel that are traced together.
const TOGETHER: u32 = 1024;

/// Random dimensions of a texel besides those of its paths.
const IN_TEXEL: u32 = 1 << 16;

/// The advice for unsuitable texture coordinates: which ones the mesh needs instead.
fn other_coordinates(needed: &str) -> Message {
    Setting::Atlas
        + format!(", which makes coordinates; a mesh that has its own {needed}; or ")
        + Setting::CameraCube
}

/// A point of a triangle, on its front.
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

/// Whether a point with these weights is inside a triangle by more than rounding: points on a shared edge are in both triangles, and charts
/// overlap only if a point is inside two.
fn is_inside([u, v]: [f64; 2]) -> bool {
    u.min(v).min(1.0 - u - v) > 1e-6
}

impl ChartTriangle {
    /// The texels that the triangle touches, as [`reached`] returns them.
    fn reaches(&self, size: [usize; 2]) -> impl Iterator<Item = (usize, Range<usize>)> + use<> {
        // Distance within which rounding may put points inside, texels.
        reached(self.corners, 1e-6, size)
    }

    /// Whether it degenerates to a point or a line on a texture of this size.
    fn is_flat(&self, size: [usize; 2]) -> bool {
        // Twice the spacing of f32 below 1: the effect of rounding on coordinates meant to be on one line.
        const WIDTH: f64 = f32::EPSILON as f64;
        let [a, b, c] = self
            .corners
            .map(|p| p / DVec2::new(size[0] as f64, size[1] as f64));
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        (b - a).perp_dot(c - a).abs() <= WIDTH * longest
    }

    /// The weights of the second and third corner at a point; `None` if the triangle has no area on the texture.
    fn barycentric(&self, point: DVec2) -> Option<[f64; 2]> {
        let [a, b, c] = self.corners;
        let (b, c, p) = (b - a, c - a, point - a);
        let area = b.perp_dot(c);
        let (u, v) = (p.perp_dot(c) / area, b.perp_dot(p) / area);
        (u.is_finite() && v.is_finite()).then_some([u, v])
    }
}

/// Fills texels beside charts with the mean of their neighbours on charts, two texels wide, so that bilinear lookups find no black there.
/// Texels that lookups on one chart read take no light of others.
fn fill_gutters<T: Stored>(
    values: &mut [T],
    mut covered: Vec<bool>,
    readers: &Readers,
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
            let counts = |k: &usize| known[*k] && readers.belong_together(texel, *k);
            let around: Vec<usize> = around.filter(counts).collect();
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
    use crate::accel::numbers;

    #[test]
    fn a_triangle_reaches_every_texel_that_has_a_point_of_it_and_few_others() {
        let mut signed = numbers(1);
        let mut random = || (signed() + 1.0) / 2.0;
        let size = [40, 30];
        let mut listed = 0;
        for k in 0..200 {
            let mut corner = || DVec2::new(40.0 * random(), 30.0 * random());
            let [a, b, mut c] = [corner(), corner(), corner()];
            // Every other triangle is a sliver.
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
        // Half of the triangles cover 1/13 of a rectangle of 40 × 30 on average, the others are lines about 18 texels long: with edges,
        // fewer than 160 and 40 texels. Their bounding boxes have 133.
        assert!(listed < 100 * (160 + 40), "{listed}");
    }
}
