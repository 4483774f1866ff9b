//! Estimates of the additional memory of the methods, and their restrictions.

use super::batch::Piece;
use super::cuts::{Cuts, cuts_of};
use super::method::{Method, Tessellation, moves, samples_spectra};
use super::vertices::{FilmCorner, Vertex};
use super::warp::TEXEL_BYTES;
use crate::camera::ViewKind;
use crate::error::{Error, Result, Setting};
use crate::io::gltf;
use crate::render::plan::{Plan, Request, bytes, count};
use crate::render::prepare::object_mesh;
use crate::scene::model::Scene;

impl Method {
    /// Plans a picture by this method: what the ray tracer needs for it, and what this method holds in addition.
    ///
    /// # Errors
    /// As [`Plan::new`] and [`Method::added_to`].
    pub fn plan(&self, scene: &Scene, request: &Request) -> Result<Plan> {
        self.added_to(Plan::new(scene, request)?)
    }

    /// The plan with the vertices, triangles or texels that this method holds. The number of points at which triangles will be cut is
    /// known only once they are loaded: a note gives the limit.
    ///
    /// # Errors
    /// What [`Method::check`] refuses, and more than the memory limit.
    pub fn added_to(&self, plan: Plan) -> Result<Plan> {
        self.check(&plan)?;
        let [beside, working] = self.bytes(&plan);
        let mut plan = plan.holding(beside, working)?;
        if let Method::Raster(raster) = self
            && raster.tessellation != Tessellation::None
        {
            let most = Cuts::most(plan.memory_left());
            plan.notes.push(format!(
                "triangles may be cut at up to {} points, which take up to {}; a picture that needs more is refused",
                count(most as u64),
                bytes(most as u64 * Cuts::BYTES)
            ));
        }
        Ok(plan)
    }

    /// The approximate number of points at which triangles are cut into edges of a given length if the whole scene is in view, from its
    /// meshes, which are loaded one after the other. `None` for other methods, or if a mesh has more than `most` triangles.
    ///
    /// # Errors
    /// Errors of loading meshes.
    pub fn cuts_in_view(&self, scene: &Scene, plan: &Plan, most: u64) -> Result<Option<f64>> {
        let Method::Raster(raster) = self else {
            return Ok(None);
        };
        let Tessellation::Uniform(length) = raster.tessellation else {
            return Ok(None);
        };
        let mut all = 0.0;
        for frame in &plan.frames {
            for &index in &frame.objects {
                let object = &scene.objects[index];
                if plan.objects[index].triangles > most {
                    return Ok(None);
                }
                let want = gltf::Want {
                    uvs: false,
                    textures: false,
                    shading: false,
                    normals: false,
                    bad_vertices: object.bad_vertices,
                    bad_textures: object.bad_textures,
                };
                let (mesh, _) = object_mesh(scene, object, want, &mut Vec::new())?;
                let triangles = 0..mesh.triangles.len() as u32;
                all += triangles
                    .map(|triangle| cuts_of(mesh.corners(triangle), length))
                    .sum::<f64>();
            }
        }
        Ok(Some(all))
    }

    /// Adds a note with the number of points at which triangles are cut into edges of a given length, if it is known.
    ///
    /// # Errors
    /// As [`Method::cuts_in_view`].
    pub fn explain_cuts(&self, scene: &Scene, plan: &mut Plan, most: u64) -> Result<()> {
        let Some(cuts) = self.cuts_in_view(scene, plan, most)? else {
            return Ok(());
        };
        let taken = (cuts * Cuts::BYTES as f64).min(u64::MAX as f64) as u64;
        let refused = match cuts > Cuts::most(plan.memory_left()) as f64 {
            true => ": over the limit, unless most lie outside the picture",
            false => "",
        };
        let points = count(cuts.min(u64::MAX as f64) as u64);
        let all = plan.memory.total().saturating_add(taken);
        plan.notes.push(format!(
            "with the whole scene in view triangles are cut at about {points} points, which take {}, {} with the rest{refused}",
            bytes(taken),
            bytes(all)
        ));
        Ok(())
    }

    /// The memory that it holds in addition to the ray tracer for `plan`, bytes: to the end, and until the film is complete.
    fn bytes(&self, plan: &Plan) -> [u64; 2] {
        match self {
            Method::Trace => [0, 0],
            Method::Raster(_) => {
                let frames = plan.frames.iter().map(|frame| {
                    let objects = frame.objects.iter().filter_map(|o| plan.objects.get(*o));
                    let vertices: u64 = objects.map(|o| o.vertices).sum();
                    triangle_bytes(frame.triangles, vertices.min(3 * frame.triangles))
                });
                // The film point of each pixel's only sample.
                let samples = match plan.film.samples {
                    1 => 8 * plan.film.size.map(u64::from).iter().product::<u64>(),
                    _ => 0,
                };
                frames.fold([0, samples], |sum: [u64; 2], held| {
                    [0, 1].map(|k| sum[k].saturating_add(held[k]))
                })
            }
            Method::Warp(warp) => [0, warp.map.texels().saturating_mul(TEXEL_BYTES)],
        }
    }

    /// Refuses features of `plan` that the method does not support, before anything is loaded.
    ///
    /// # Errors
    /// A camera whose rays leave separate events, or of whose film parts see nothing; for warps, objects that move; parameters that no text of a method could have.
    pub fn check(&self, plan: &Plan) -> Result<()> {
        self.check_numbers()?;
        if *self == Method::Trace {
            return Ok(());
        }
        if plan.samples_spectra {
            return Err(samples_spectra(&plan.scene));
        }
        if let Some(why) = apart(plan) {
            return Err(why);
        }
        match (self, plan.frames.iter().find(|frame| frame.gamma > 1.0)) {
            (Method::Warp(_), Some(frame)) => {
                let object = frame.objects.first().and_then(|o| plan.objects.get(*o));
                let object = object.map_or(String::new(), |o| format!("object \"{}\"", o.name));
                Err(moves(&plan.scene, &object))
            }
            _ => Ok(()),
        }
    }
}

/// The refusal of a camera whose rays do not all leave one event, or of whose film parts see nothing.
fn apart(plan: &Plan) -> Option<Error> {
    let refuse = |what: String, remedy: &str| {
        let remedy = Setting::TraceIt + ", or " + remedy;
        Some(Error::unsupported(&plan.scene, "camera", what, remedy))
    };
    let (what, remedy) = match plan.view {
        ViewKind::Still | ViewKind::Moving | ViewKind::Unaberrated if plan.has_blind_points => {
            return refuse(
                "rasterizers need a film that sees something everywhere: parts of this one see nothing (the corners of a fisheye, or what \
                 is beyond the poles of a panorama)"
                    .into(),
                "set a size or an hfov for which all of the film sees something",
            );
        }
        ViewKind::Still | ViewKind::Moving | ViewKind::Unaberrated => return None,
        ViewKind::Inertial => (
            "those of a sensor or a shutter do not",
            "remove the sensor or the shutter",
        ),
        ViewKind::Accelerated => (
            "those of this motion do not",
            "remove the sensor or the shutter",
        ),
        ViewKind::Turning => ("those of a rotating sensor do not", "remove the rotation"),
        ViewKind::Stereo => ("those of a stereo pair leave two eyes", "remove `stereo`"),
        ViewKind::Paper => (
            "those of model = \"paper2015\" do not",
            "set model = \"exact\"",
        ),
    };
    let what = format!("rasterizers need a camera whose rays all leave one event: {what}");
    refuse(what, remedy)
}

/// The bytes that this many uncut triangles and their distinct corners take: to the end, and until the film is complete. Growing lists may
/// have twice the capacity that they need.
fn triangle_bytes(triangles: u64, vertices: u64) -> [u64; 2] {
    // The positions of corners, the longest edges there and the corners' indices stay with the rest frame. Positions are found in a hash
    // table with an entry per triangle, whose capacity is a power of two and which is at most 7/8 full.
    let shared = ((2 * 24 + 8) * vertices).saturating_add(12 * triangles);
    let table = 75 * triangles;
    // Per triangle: its piece, its place in the level, its index in the tiles, and the data that a tile gathers about it.
    let pieces = 2 * size_of::<Piece>() as u64 + 2 * 16 + 8 + 112;
    let vertex = (size_of::<Vertex>() + size_of::<FilmCorner>()) as u64;
    let drawn = (vertex * vertices).saturating_add(pieces * triangles);
    [shared, table.max(drawn)]
}
