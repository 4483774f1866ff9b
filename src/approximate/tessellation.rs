//! How finely a rasterizer must tessellate, so that every point is drawn within ε pixels of its true position.
//!
//! A rasterizer that moves vertices to their apparent positions and joins them by straight edges draws a
//! point Δ = v δ pixels off (see [`projection`](crate::approximate::projection) for v and c). On an edge of rest length L that
//! runs across the line of sight, and in a triangle none of whose edges is longer,
//!
//! ```text
//! δ ≤ L²/(8 |c|)   on the edge,      δ ≤ L²/(6 |c|)   in the triangle,
//! ```
//!
//! in vacuum; in a medium 1 is replaced by |c × Ce|²/|c|² for the direction e in the triangle's plane for which it is largest, where C is
//! the map from rest coordinates to c. Δ includes two effects: its component across the edge bends outlines, the one along it makes
//! textures and wave fronts slide. So the required edge length where the camera sees a point is
//!
//! ```text
//! L = √(6 ε |c| / |v|).
//! ```
//!
//! Slivers need less if they lie along the line of sight. No piece of a triangle with longest edge along a and height h over it extends
//! farther than h across a, so that with q(e) = |c × Ce|²/|c|³ also
//!
//! ```text
//! δ ≤ (√q(a) L + √q(b) h)²/6,      b across a in its plane.
//! ```
//!
//! [`forecast`] examines the point behind the centre of each pixel, and takes the smallest L of each object: what the picture does not
//! show needs no finer triangles. It is the parameter of `raster:uniform`.

use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

use crate::approximate::projection::{ApparentProjection, Observer};
use crate::error::{Error, Message, Result, Setting};
use crate::render::film::Tile;
use crate::render::plan::count;
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::trace::{HitBuffer, Meter, Rays, SurfaceHit, Surfaces};
use crate::scene::model::Scene;

/// The tessellation that a picture needs.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Forecast {
    /// The scene's name.
    pub scene: String,
    /// The allowed error, pixels.
    pub pixels: f64,
    /// The visible objects, in the order of the scene.
    pub objects: Vec<Needed>,
}

/// The tessellation that an object needs.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Needed {
    /// Index of the object in the scene.
    pub object: u32,
    /// Its name.
    pub name: String,
    /// The number of pixels that see it.
    pub seen_by: u64,
    /// The longest edge of all its triangles, metres in its rest frame.
    pub longest_edge: f64,
    /// The allowed edge length for the allowed error, metres in its rest frame; `None` if any length will do.
    pub edge_length: Option<f64>,
    /// The number of parts into which the longest edge must be cut for that.
    pub parts: u64,
    /// The number of cuts, if edges are only ever halved.
    pub halvings: u32,
    /// Where the shortest edges are needed.
    pub worst: Worst,
}

/// Where the shortest edges are needed.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Worst {
    /// Index of the triangle in its object.
    pub triangle: u32,
    /// Column and row of the pixel.
    pub pixel: [u32; 2],
    /// The position on the object, metres in its own coordinates.
    pub place: [f64; 3],
    /// The displacement of points there with edges as long as the longest, pixels.
    pub untessellated: f64,
}

/// What a pixel sees.
#[derive(Debug, Clone, Copy)]
struct Sample {
    surface_hit: SurfaceHit,
    pixel: [u32; 2],
    bend: Bend,
}

/// How errors there grow with the edge length: √(6 δ) per metre times the square root of |v|.
#[derive(Debug, Clone, Copy)]
struct Bend {
    /// In the direction for which it is largest.
    most: f64,
    /// Along the longest edge.
    along: f64,
    /// Across it, times the height: pixels to the power of ½.
    height: f64,
}

impl Bend {
    /// The length that edges may have for an error of `pixels`, metres.
    fn length(self, pixels: f64) -> f64 {
        let allowed = (6.0 * pixels).sqrt();
        let sliver = (allowed - self.height) / self.along;
        // 0/0 is no length.
        (allowed / self.most).max(if sliver > 0.0 { sliver } else { 0.0 })
    }

    /// The error with edges of `length` metres, pixels.
    fn error(self, length: f64) -> f64 {
        let root = (self.most * length).min(self.along * length + self.height);
        root * root / 6.0
    }
}

/// Estimates the edge lengths that keep everything that `scene`, prepared as `prepared`, shows within `pixels` of its true position.
///
/// # Errors
/// A camera whose rays leave events of their own, or whose projection bends straight lines; objects as fast as light in the medium, or
/// faster; [`Error::Cancelled`] when `progress` says so.
pub fn forecast(
    scene: &Scene,
    prepared: &Prepared,
    pixels: f64,
    progress: &dyn Progress,
) -> Result<Forecast> {
    let observer = Observer::new(prepared)?;
    let projections = prepared
        .frames
        .iter()
        .map(|f| observer.projection(&f.frame));
    let projections = projections.collect::<Result<Vec<_>>>()?;
    let samples = samples(prepared, &projections, progress)?;
    let objects = (0..scene.objects.len() as u32)
        .filter_map(|object| Needed::of(scene, prepared, object, &samples, pixels))
        .collect();
    Ok(Forecast {
        scene: scene.name.clone(),
        pixels,
        objects,
    })
}

/// What the centres of all pixels see, row by row within tiles.
fn samples(
    prepared: &Prepared,
    projections: &[ApparentProjection],
    progress: &dyn Progress,
) -> Result<Vec<Sample>> {
    let size = prepared.layout.size;
    let event_in = |frame: &_| prepared.camera.shot.event_in(frame);
    let surfaces = Surfaces::unbuffered(&prepared.frames, event_in, prepared.ray_index);
    let tile = |hits: &mut HitBuffer, index: u64| {
        if progress.is_cancelled() {
            return Err(Error::Cancelled);
        }
        let tile = Tile::of_image(size, index);
        // Centres of pixels, at the moment of the shot.
        let centre = |(column, row): (u32, u32)| [column, row].map(|p| f64::from(p) + 0.5);
        let look = |[x, y]: [f64; 2]| prepared.camera.view.ray(x, y, 0.0).d.unit();
        let directions: Vec<_> = tile.coordinates().map(centre).map(look).collect();
        let rays = Rays::from_shot(&directions, prepared.method);
        surfaces.nearest(&rays, hits, &mut Meter::off());
        progress.rays_done(tile.pixels() as u64);
        let met = tile
            .coordinates()
            .enumerate()
            .filter_map(|(ray, (column, row))| {
                let surface_hit = hits.hit(ray)?;
                let bend = bend(
                    prepared,
                    &projections[surface_hit.frame as usize],
                    surface_hit,
                )?;
                Some(Sample {
                    surface_hit,
                    pixel: [column, row],
                    bend,
                })
            });
        Ok(met.collect::<Vec<_>>())
    };
    // Tiles come back in their order, whichever thread was first.
    let tiles = (0..Tile::count(size))
        .into_par_iter()
        .map_init(HitBuffer::default, tile)
        .collect::<Result<Vec<_>>>()?;
    Ok(tiles.into_iter().flatten().collect())
}

/// Where the ray met the triangle, metres in the rest frame.
fn place(prepared: &Prepared, surface_hit: SurfaceHit) -> DVec3 {
    let rest = &prepared.frames[surface_hit.frame as usize];
    let [a, b, c] = rest.bvh.corners(surface_hit.hit.slot);
    a + (b - a) * surface_hit.hit.u + (c - a) * surface_hit.hit.v
}

/// How errors grow in the triangle that was hit; `None` behind the camera.
fn bend(
    prepared: &Prepared,
    projection: &ApparentProjection,
    surface_hit: SurfaceHit,
) -> Option<Bend> {
    let bvh = &prepared.frames[surface_hit.frame as usize].bvh;
    let [p, q, r] = bvh.corners(surface_hit.hit.slot);
    let edges = [q - p, r - q, p - r];
    let longer = |a: DVec3, b: DVec3| {
        if b.length_squared() > a.length_squared() {
            b
        } else {
            a
        }
    };
    let longest = edges.into_iter().fold(DVec3::ZERO, longer);
    // Twice the area over the longest edge.
    let height = edges[0].cross(edges[1]).length() / longest.length();
    let x = place(prepared, surface_hit);
    let c = projection.optical(x);
    // Unit vectors of the plane, along the longest edge and across it.
    let along = longest.normalize();
    let across = bvh.normal(&surface_hit.hit).cross(along);
    // c × Ce for unit vectors e of the plane: the largest is the greater eigenvalue of their products.
    let turned = |e: DVec3| c.cross(projection.optical(x + e) - c) / c.length();
    let (u, v) = (turned(along), turned(across));
    let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
    let greatest = 0.5 * (uu + vv) + (0.25 * (uu - vv) * (uu - vv) + uv * uv).sqrt();
    let [dx, dy] = projection.slide(projection.image_of(c)?.film)?;
    let pixels = (dx * dx + dy * dy).sqrt() / c.length();
    let bend = Bend {
        most: (pixels * greatest).sqrt(),
        along: (pixels * uu).sqrt(),
        height: (pixels * vv).sqrt() * height,
    };
    bend.most.is_finite().then_some(bend)
}

impl Needed {
    /// `None` for an object that no pixel sees.
    fn of(
        scene: &Scene,
        prepared: &Prepared,
        object: u32,
        samples: &[Sample],
        pixels: f64,
    ) -> Option<Needed> {
        let is_of = |s: &&Sample| {
            let rest = &prepared.frames[s.surface_hit.frame as usize];
            rest.patch(s.surface_hit.hit.triangle).object == object
        };
        let mut seen_by = 0;
        let worst = samples.iter().filter(is_of).inspect(|_| seen_by += 1);
        // Among equals, the first.
        let length = |s: &Sample| s.bend.length(pixels);
        let worst = worst.reduce(|worst, s| if length(s) < length(worst) { s } else { worst })?;
        let rest = &prepared.frames[worst.surface_hit.frame as usize];
        let patch = rest.patch(worst.surface_hit.hit.triangle);
        let longest_edge = longest_edge(prepared, worst.surface_hit.frame, object);
        let edge_length = Some(length(worst)).filter(|l| l.is_finite());
        let parts = (longest_edge / edge_length.unwrap_or(f64::INFINITY))
            .ceil()
            .max(1.0);
        Some(Needed {
            object,
            name: scene.objects[object as usize].name.clone(),
            seen_by,
            longest_edge,
            edge_length,
            parts: parts as u64,
            halvings: parts.log2().ceil() as u32,
            worst: Worst {
                triangle: worst.surface_hit.hit.triangle - patch.object_first,
                pixel: worst.pixel,
                place: (place(prepared, worst.surface_hit) - patch.object_origin.x).to_array(),
                untessellated: worst.bend.error(longest_edge),
            },
        })
    }
}

/// The longest edge of an object's triangles, metres.
fn longest_edge(prepared: &Prepared, frame: u32, object: u32) -> f64 {
    let rest = &prepared.frames[frame as usize];
    let square = |slot: u32| {
        let [a, b, c] = rest.bvh.corners(slot);
        let edges = [
            a.distance_squared(b),
            b.distance_squared(c),
            c.distance_squared(a),
        ];
        edges.into_iter().fold(0.0, f64::max)
    };
    let slots = (0..rest.bvh.len() as u32).into_par_iter();
    let own = slots.filter(|slot| rest.patch(rest.bvh.triangle(*slot).0).object == object);
    // The maximum does not depend on the order.
    own.map(square).reduce(|| 0.0, f64::max).sqrt()
}

impl Forecast {
    /// The results as a printable table.
    pub fn report(&self) -> Message {
        let (scene, pixels) = (self.scene.escape_debug(), self.pixels);
        let mut text = format!("{scene}: edges for an error of at most {pixels} pixels\n");
        if self.objects.is_empty() {
            return (text + "  the picture shows no object\n").into();
        }
        let names = self.objects.iter().map(|o| o.name.chars().count());
        // At least as wide as its head, "object"; names longer than 32 overflow.
        let width = names.max().unwrap_or(0).clamp(6, 32);
        text += &format!(
            "  {:<width$}  {:>10}  {:>10}  {:>8}  {:>8}  {:>12}  worst at\n",
            "object", "edges ≤ m", "longest m", "parts", "halvings", "now ≤ pixels"
        );
        text.extend(self.objects.iter().map(|object| object.row(width)));
        let (before, method) = match self.finest() {
            Some(length) => (
                "  for all of them: ",
                format!(" raster:uniform={}\n", short(length)),
            ),
            None => ("  no edge is bent: ", " raster:none\n".into()),
        };
        Message::from(text + before) + Setting::Method + method
    }

    /// The edge length that is sufficient for all objects, metres; `None` if any is.
    pub fn finest(&self) -> Option<f64> {
        let lengths = self.objects.iter().filter_map(|o| o.edge_length);
        lengths.reduce(f64::min)
    }
}

impl Needed {
    fn row(&self, width: usize) -> String {
        let name: String = self.name.chars().take(width).collect();
        let length = self.edge_length.map_or("any".into(), short);
        let [column, row] = self.worst.pixel;
        format!(
            "  {:<width$}  {length:>10}  {:>10}  {:>8}  {:>8}  {:>12}  triangle {}, pixel ({column}, {row})\n",
            name.escape_debug().to_string(),
            short(self.longest_edge),
            count(self.parts),
            self.halvings,
            short(self.worst.untessellated),
            count(self.worst.triangle.into()),
        )
    }
}

/// Four significant digits, truncated rather than rounded: an allowed length stays allowed.
fn short(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let exponent = x.abs().log10().floor();
    if !(-4.0..6.0).contains(&exponent) {
        return format!("{x:.3e}");
    }
    let decimals = (3.0 - exponent).max(0.0);
    let scale = 10f64.powf(decimals);
    format!("{:.*}", decimals as usize, (x * scale).floor() / scale)
}
