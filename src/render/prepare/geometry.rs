//! Rest frames: the triangles of all objects at rest in one, and the BVH over them.

use std::sync::{Arc, OnceLock};
use std::time::Instant;

use glam::DVec3;
use rayon::prelude::*;

use super::backs::{Backs, backs_of};
use super::emitters::Builder;
use crate::accel::pages::Pages;
use crate::accel::{Bvh, Facing, Preset};
use crate::error::{Error, Result};
use crate::io::budget::Budget;
use crate::io::{gltf, npy};
use crate::mesh::atlas::Corners;
use crate::mesh::{Mesh, shapes};
use crate::render::plan::{
    BUILT_TOGETHER, Plan, PlannedFrame, PlannedObject, is_moot, keeps_normals,
};
use crate::render::progress::Progress;
use crate::render::trace::{AlphaMasks, MaskedRun, Patch, RestFrame};
use crate::scene::model::{BadVertices, CoordinateFile, Geometry, Object, Scene};
use crate::spacetime::{Event, InertialFrame, Rest};

/// All rest frames of `plan`, and the time to build their trees, seconds. Trees are built in parallel once there are many triangles: a
/// small one is not worth waking threads.
///
/// # Errors
/// Broken files, and [`Error::Cancelled`] when `progress` says so.
pub(super) fn frames(
    scene: &Scene,
    plan: &Plan,
    light: &mut Builder,
    warnings: &mut Vec<String>,
    progress: &dyn Progress,
) -> Result<(Vec<RestFrame>, f64)> {
    let normals = keeps_normals(scene, &plan.objects, &plan.cubes);
    let mut frames = Vec::with_capacity(plan.frames.len());
    let mut built_in = 0.0;
    let mut gathered = Vec::new();
    let mut triangles = 0;
    for (index, planned) in plan.frames.iter().enumerate() {
        progress.check()?;
        let frame = gathered_frame(scene, plan, planned, light, warnings)?;
        triangles += frame.triangles.len() as u64;
        gathered.push(frame);
        if triangles >= BUILT_TOGETHER || index + 1 == plan.frames.len() {
            let begin = Instant::now();
            let built = gathered
                .par_drain(..)
                .map(|frame| frame.built(plan.trees, normals, progress));
            frames.append(&mut built.collect::<Result<Vec<_>>>()?);
            built_in += begin.elapsed().as_secs_f64();
            triangles = 0;
        }
    }
    Ok((frames, built_in))
}

/// Loads the objects of `planned`.
fn gathered_frame(
    scene: &Scene,
    plan: &Plan,
    planned: &PlannedFrame,
    light: &mut Builder,
    warnings: &mut Vec<String>,
) -> Result<Gathered> {
    // Objects of one velocity share the frame of the first; the others keep their own origins in it.
    let first = &scene.objects[planned.objects[0]];
    let frame = InertialFrame::new(first.velocity, first.origin);
    let mut gathered = Gathered::new(frame, planned.triangles as usize);
    for &index in &planned.objects {
        let object = &scene.objects[index];
        let planned = &plan.objects[index];
        let want = want(scene, object, planned);
        let mut told = Vec::new();
        let (mesh, images) = object_mesh(scene, object, want, &mut told)?;
        told.retain(|what| !is_moot(scene, what));
        tell(warnings, told);
        let emitters = light.materials(index, &mesh, images)?;
        let origin = frame.event_from_world(object.origin);
        gathered.add(scene, index, mesh, origin, &emitters);
    }
    // If materials have masks, triangles have holes.
    gathered.masked = masked_runs(&gathered.patches, light);
    Ok(gathered)
}

/// What to read from the file of an object.
pub(super) fn want(scene: &Scene, object: &Object, planned: &PlannedObject) -> gltf::Want {
    gltf::Want {
        uvs: planned.uvs,
        textures: planned.textures,
        shading: scene.is_lit(),
        normals: planned.normals,
        bad_vertices: object.bad_vertices,
        bad_textures: object.bad_textures,
    }
}

/// The patches whose material has an alpha mask.
fn masked_runs(patches: &[Patch], light: &Builder) -> Vec<MaskedRun> {
    let ends = patches.iter().skip(1).map(|next| next.first);
    let runs = patches.iter().zip(ends.chain([u32::MAX]));
    let masked = runs.filter_map(|(patch, end)| {
        let mask = light.mask(patch.emitter)?.clone();
        Some(MaskedRun {
            first: patch.first,
            end,
            object_first: patch.object_first,
            mesh: patch.mesh,
            mask,
        })
    });
    masked.collect()
}

/// The mesh of an object of `scene` in object coordinates, as it is rendered, and the requested images of its file.
///
/// # Errors
/// Those of [`gltf::load`], and vertices that are out of range.
pub(crate) fn object_mesh(
    scene: &Scene,
    object: &Object,
    want: gltf::Want,
    warnings: &mut Vec<String>,
) -> Result<(Mesh, Vec<gltf::EncodedImage>)> {
    let (mut mesh, images, own_sets) = match &object.geometry {
        Geometry::Gltf { path, node } => {
            let imported = gltf::load(path, node.as_deref(), want)?;
            let named = |w: String| format!("{}: {w}", path.display());
            tell(warnings, imported.warnings.into_iter().map(named));
            (imported.mesh, imported.images, imported.uv_sets)
        }
        Geometry::Shape {
            shape,
            colour,
            metallic,
            roughness,
            transmission,
            ior,
        } => {
            let mut mesh = shapes::mesh(*shape, *colour);
            for material in &mut mesh.materials {
                (material.metallic, material.roughness) = (*metallic, *roughness);
                (material.transmission, material.ior) = (*transmission, *ior);
                // A plane has no inside.
                material.solid = !matches!(shape, shapes::Shape::Plane { .. });
            }
            let own_sets = mesh.uvs.len();
            (mesh, Vec::new(), own_sets)
        }
        Geometry::Mesh(shared) => {
            // What is not requested is not copied.
            let with_uvs = want.uvs || shared.has_masks();
            let mesh = Mesh {
                positions: shared.positions.clone(),
                uvs: match with_uvs {
                    true => shared.uvs.clone(),
                    false => Vec::new(),
                },
                normals: match want.normals {
                    true => shared.normals.clone(),
                    false => Vec::new(),
                },
                colours: shared.colours.clone(),
                triangles: shared.triangles.clone(),
                parts: shared.parts.clone(),
                materials: shared.materials.clone(),
            };
            (mesh, Vec::new(), shared.uvs.len())
        }
    };
    // Masks always need the coordinates of their textures.
    match &object.texture_coordinates {
        _ if !want.uvs && mesh.has_masks() => {}
        _ if !want.uvs => mesh.uvs.clear(),
        None => {}
        Some(file) => {
            let corners = texture_coordinates(object, file, mesh.triangles.len())?;
            mesh.insert_uvs(own_sets, &corners);
        }
    }
    let transform = object.transform;
    mesh.turn_normals(transform.matrix3);
    for p in &mut mesh.positions {
        *p = transform.transform_point3(*p);
    }
    check_reach(scene, object, &mut mesh, warnings)?;
    // A mirroring transform reverses the order of corners, by which the front is known.
    if transform.matrix3.determinant() < 0.0 {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    Ok((mesh, images))
}

/// Adds what is not among `warnings` yet: objects may share a file.
fn tell(warnings: &mut Vec<String>, told: impl IntoIterator<Item = String>) {
    for text in told {
        if !warnings.contains(&text) {
            warnings.push(text);
        }
    }
}

/// The coordinates in the file of an object with this many triangles.
fn texture_coordinates(
    object: &Object,
    file: &CoordinateFile,
    triangles: usize,
) -> Result<Vec<Corners>> {
    let path = &file.path;
    let place = |more: &str| match &file.array {
        Some(array) => format!("array \"{array}\"{more}"),
        None => more.trim_start_matches(", ").to_string(),
    };
    // As stored and widened; a longer file has another shape.
    let budget = Budget::new(96 * triangles as u64 + (1 << 20));
    let plain = npy::load_plain(path, file.array.as_deref(), &budget)?;
    if plain.shape != [triangles, 3, 2] {
        let what = format!(
            "its shape is {:?}, and object \"{}\" has {triangles} triangles",
            plain.shape, object.name
        );
        let help = "an array of shape (triangles, 3, 2): u and v by triangle and corner, as baked for this mesh";
        return Err(Error::invalid(path, place(""), what, help));
    }
    let values = plain.samples.into_f64();
    let values: Vec<f32> = values.into_iter().map(|x| x as f32).collect();
    if let Some(at) = values.iter().position(|x| !x.is_finite()) {
        let what = format!("it is {}", values[at]);
        let at = place(&format!(", triangle {}", at / 6));
        return Err(Error::invalid(path, at, what, "finite texture coordinates"));
    }
    let pairs = values.as_chunks::<2>().0;
    Ok(pairs.as_chunks::<3>().0.to_vec())
}

/// Refuses vertices that are too far away for a ray to hit, or drops their triangles.
fn check_reach(
    scene: &Scene,
    object: &Object,
    mesh: &mut Mesh,
    warnings: &mut Vec<String>,
) -> Result<()> {
    // False for NaN.
    let is_reached = |p: &DVec3| p.abs().max_element() <= Bvh::MAX_COORDINATE && !p.is_nan();
    let Some(at) = mesh.positions.iter().position(|p| !is_reached(p)) else {
        return Ok(());
    };
    if object.bad_vertices == BadVertices::Refuse {
        let (file, vertex) = match &object.geometry {
            Geometry::Gltf { path, .. } => (path.display().to_string(), format!("vertex {at}")),
            Geometry::Shape { .. } => (scene.name.clone(), format!("vertex {at}")),
            Geometry::Mesh(_) => (scene.name.clone(), format!("positions[{at}]")),
        };
        let place = format!("object \"{}\", {vertex}", object.name);
        // Debug: with an exponent if numbers are long.
        let what = format!(
            "is at {:?} m after its transform",
            mesh.positions[at].to_array()
        );
        let help = format!(
            "coordinates must be within {:.0e} m; bad_vertices = \"drop\" leaves such triangles out",
            Bvh::MAX_COORDINATE
        );
        return Err(Error::invalid(file, place, what, help));
    }
    let positions = &mesh.positions;
    let is_bad = |t: &&mut [u32; 3]| t.iter().any(|&v| !is_reached(&positions[v as usize]));
    let mut dropped = 0;
    for triangle in mesh.triangles.iter_mut().filter(is_bad) {
        // Without area no ray hits it, and the others keep their numbers.
        *triangle = [triangle[0]; 3];
        dropped += 1;
    }
    let bad = mesh.positions.iter_mut().filter(|p| !is_reached(p));
    bad.for_each(|p| *p = DVec3::ZERO);
    warnings.push(format!(
        "object \"{}\": {dropped} triangles with a vertex that is out of range are dropped",
        object.name
    ));
    Ok(())
}

/// A rest frame while its triangles are gathered.
struct Gathered {
    frame: InertialFrame<Rest>,
    triangles: Vec<[DVec3; 3]>,
    patches: Vec<Patch>,
    /// Per patch: whether its back faces are culled.
    culled: Vec<bool>,
    masked: Vec<MaskedRun>,
    meshes: Vec<Mesh>,
}

impl Gathered {
    fn new(frame: InertialFrame<Rest>, triangles: usize) -> Gathered {
        Gathered {
            frame,
            triangles: Vec::with_capacity(triangles),
            patches: Vec::new(),
            culled: Vec::new(),
            masked: Vec::new(),
            meshes: Vec::new(),
        }
    }

    /// The frame with its tree, with or without `normals`.
    ///
    /// # Errors
    /// [`Error::Cancelled`] when `progress` says so.
    fn built(self, trees: Preset, normals: bool, progress: &dyn Progress) -> Result<RestFrame> {
        // Patches are in the order of their triangles.
        let (patches, culled) = (self.patches, self.culled);
        let facing = |triangle: u32| {
            let patch = patches
                .partition_point(|p| p.first <= triangle)
                .saturating_sub(1);
            if culled[patch] {
                Facing::FrontOnly
            } else {
                Facing::TwoSided
            }
        };
        let goes_on = || !progress.is_cancelled();
        let bvh = Bvh::build_while(self.triangles, &facing, trees, &goes_on);
        let bvh = bvh.ok_or(Error::Cancelled)?;
        let meshes: Arc<[Mesh]> = self.meshes.into();
        let bvh = match AlphaMasks::new(self.masked, meshes.clone()) {
            Some(masks) => bvh.with_alpha_test(Arc::new(masks)),
            None => bvh,
        };
        Ok(RestFrame {
            frame: self.frame,
            normals: if normals {
                bvh.normals()
            } else {
                Pages::default()
            },
            bvh,
            patches,
            meshes,
            vertices: OnceLock::new(),
        })
    }

    fn add(
        &mut self,
        scene: &Scene,
        object: usize,
        mut mesh: Mesh,
        origin: Event<Rest>,
        emitters: &[u32],
    ) {
        let object_first = self.triangles.len() as u32;
        for index in 0..mesh.triangles.len() as u32 {
            // Coordinates of the frame, relative to its origin.
            self.triangles
                .push(mesh.corners(index).map(|p| p + origin.x));
        }
        for part in mesh.parts.iter().filter(|p| p.triangles > 0) {
            let material = &mesh.materials[part.material as usize];
            let backs = backs_of(scene, object, material);
            self.culled.push(backs == Backs::Culled);
            self.patches.push(Patch {
                first: object_first + part.first_triangle,
                object: object as u32,
                mesh: self.meshes.len() as u32,
                object_first,
                object_origin: origin,
                emitter: emitters[part.material as usize],
                black_back: backs == Backs::Black,
            });
        }
        // From here on the BVH holds the corners; texture coordinates are kept.
        mesh.positions = Vec::new();
        if mesh.uvs.is_empty() && mesh.normals.is_empty() && mesh.colours.is_empty() {
            mesh.triangles = Vec::new();
        }
        mesh.triangles.shrink_to_fit();
        mesh.uvs.iter_mut().for_each(Vec::shrink_to_fit);
        mesh.normals.shrink_to_fit();
        mesh.colours.shrink_to_fit();
        self.meshes.push(mesh);
    }
}
