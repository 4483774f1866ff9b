//! What a scene and a request need, what is skipped and why; with nothing heavy loaded.
//!
//! The plan reads only headers (the JSON of glTF files, the first lines of cubes). It is exactly what [`prepare`](crate::render::prepare)
//! carries out, and what `nullray plan` prints.

mod bindings;
mod check;
mod fixed;
mod frames;
mod inside;
mod medium;
mod memory;
mod notes;
mod planned;
mod recorded;
mod report;

use std::sync::Arc;

use crate::accel::{Precision, Preset};
use crate::camera::Camera;
use crate::error::{Error, Message, Result, Setting};
use crate::io::cube::{self as cubes, Channels};
use crate::io::gltf;
use crate::light::time_texture::TimeTexture;
use crate::mesh::{Factors, shapes};
use crate::render::aov::Aov;
use crate::render::film::Layout;
use crate::scene::model::{
    Crop, CubeBacks, CubeData, CubeSource, Elements, Geometry, Mapping, Object, Scene, Shape,
    Source, SourceKind, Spectra, TimeBins,
};

pub(crate) use bindings::shown_by;
pub use bindings::{Lit, lit_by};
pub(crate) use check::check_camera;
pub(crate) use fixed::{PLANNED, PREPARED, check_same, check_size};
pub(crate) use memory::BUILT_TOGETHER;
pub use notes::unread;
pub(crate) use notes::{is_moot, unfound_light, unshown};
pub use planned::{Memory, Plan, PlannedCube, PlannedFrame, PlannedObject, Rays, Request, Skipped};
pub use recorded::contradicted;
pub use report::{bytes, count, count_of, motion};

impl Plan {
    /// Plans `request` for `scene`, reading only headers.
    ///
    /// # Errors
    /// Numbers that no scene file can contain, files that are missing or whose headers are broken, materials that do not exist, a scene
    /// that exceeds the request's memory limit.
    pub fn new(scene: &Scene, request: &Request) -> Result<Plan> {
        check::check(scene)?;
        let mut objects = inspect_objects(scene)?;
        inside::check(scene, &objects)?;
        bindings::check(scene, &objects)?;
        medium::check(scene, &objects)?;
        let wants_uv = request
            .aovs
            .iter()
            .any(|a| matches!(a, Aov::UvU | Aov::UvV));
        for (index, object) in objects.iter_mut().enumerate() {
            bindings::resolve(scene, index, object, wants_uv);
        }
        let mut cubes = inspect_cubes(scene, &objects, request.memory_limit)?;
        let frames = frames::by_velocity(scene, &objects)?;
        let layout = layout(scene, request, &objects);
        let rays = rays(scene, &layout, &objects, &cubes);
        let trees = trees(request, &rays, &objects);
        let normals = keeps_normals(scene, &objects, &cubes);
        let memory =
            |cubes: &_| memory::memory(scene, &frames, normals, &objects, cubes, &layout, request);
        memory::read_in_parts(&mut cubes, request.memory_limit, &memory);
        let memory = memory(&cubes);
        let camera = Camera::new(scene)?;
        let mut plan = Plan {
            scene: scene.name.clone(),
            view: camera.view.kind(),
            has_blind_points: camera.has_blind_points(),
            frames,
            time_resolved: is_time_resolved(scene, &objects),
            objects,
            cubes,
            film: layout,
            rays,
            trees,
            memory,
            memory_limit: request.memory_limit,
            samples_spectra: scene.spectra == Spectra::Sampled,
            counts_only: false,
            of: Arc::new(scene.clone()),
            skipped: Vec::new(),
            notes: Vec::new(),
        };
        notes::explain(scene, &mut plan);
        plan.within(request.memory_limit)?;
        Ok(plan)
    }

    /// The same if a picture holds `beside` bytes to the end, and `working` until its film is complete, neither while BVHs are built nor
    /// while files are written.
    ///
    /// # Errors
    /// More than the memory limit.
    pub(crate) fn holding(mut self, beside: u64, working: u64) -> Result<Plan> {
        let memory = &mut self.memory;
        memory.beside = memory.beside.saturating_add(beside);
        memory.temporary = memory.temporary.max(working);
        self.within(self.memory_limit)?;
        Ok(self)
    }

    /// What the memory limit leaves, bytes.
    pub(crate) fn memory_left(&self) -> u64 {
        self.memory_limit.saturating_sub(self.memory.total())
    }

    /// The same for the sky: including what is planned for it, and for work before and after it is loaded.
    pub(crate) fn memory_for_sky(&self) -> u64 {
        self.memory_left()
            .saturating_add(self.memory.sky)
            .saturating_add(self.memory.temporary)
    }

    fn within(&self, limit: u64) -> Result<()> {
        let total = self.memory.total();
        if total <= limit {
            return Ok(());
        }
        Err(Error::invalid(
            &self.scene,
            "memory",
            format!(
                "needs about {}, more than the limit of {}",
                report::bytes(total),
                report::bytes(limit)
            ),
            Message::from("a smaller image or mesh, or a higher ") + Setting::MemoryLimit,
        ))
    }
}

fn layout(scene: &Scene, request: &Request, objects: &[PlannedObject]) -> Layout {
    Layout {
        size: scene.camera.size,
        samples: if request.pixel_centers {
            1
        } else {
            scene.samples_per_pixel
        },
        pixel_centers: request.pixel_centers,
        precision: request.precision,
        channels: request.aovs.clone(),
        has_gaps: covers_itself(scene) || is_time_resolved(scene, objects),
        covers_itself: covers_itself(scene),
    }
}

/// Whether any radiance varies with time.
fn is_time_resolved(scene: &Scene, objects: &[PlannedObject]) -> bool {
    let varies = |o: usize| {
        let mut materials = objects[o].materials.iter();
        materials.any(|m| !matches!(lit_by(scene, o, m), Lit::Base | Lit::Spectrum))
    };
    (0..objects.len()).any(varies)
}

/// Whether the normals of all triangles are kept: if surfaces reflect light, or capture cameras see them.
pub(crate) fn keeps_normals(
    scene: &Scene,
    objects: &[PlannedObject],
    cubes: &[Option<PlannedCube>],
) -> bool {
    let reflects = |o: usize| {
        let mut materials = objects[o].materials.iter();
        materials.any(|m| matches!(lit_by(scene, o, m), Lit::Reflecting(_)))
    };
    cubes.iter().flatten().any(|c| c.capture_rays > 0) || (0..objects.len()).any(reflects)
}

/// Whether the camera's sensor can hide the pinhole from parts of itself.
fn covers_itself(scene: &Scene) -> bool {
    let rotation = scene.camera.rotation;
    scene.camera.sensor.is_some() && rotation.is_some_and(|r| r.elements == Elements::Aberrated)
}

fn inspect_objects(scene: &Scene) -> Result<Vec<PlannedObject>> {
    let inspect = |object: &Object| {
        let mut planned = inspect_geometry(object)?;
        if object.texture_coordinates.is_some() {
            planned.uv_sets += 1;
            // Different corners are separate vertices.
            planned.vertices = planned.vertices.max(3 * planned.triangles);
        }
        Ok(planned)
    };
    scene.objects.iter().map(inspect).collect()
}

/// What is known of an object's geometry without loading it: a glTF file's header has all counts.
fn inspect_geometry(object: &Object) -> Result<PlannedObject> {
    match &object.geometry {
        Geometry::Gltf { path, node } => {
            let summary = gltf::inspect_for(path, node.as_deref(), object.bad_textures)?;
            Ok(PlannedObject {
                name: object.name.clone(),
                file: Some(path.clone()),
                without_file: "",
                files: summary.files,
                triangles: summary.triangles,
                vertices: summary.vertices,
                uvs: false,
                textures: false,
                normals: false,
                radiance: Vec::new(),
                uv_sets: summary.uv_sets,
                materials: summary.materials,
                factors: summary.factors,
                has_gloss_textures: summary.has_gloss_textures,
                images: summary.images,
                placing: summary.placing,
                has_colours: summary.has_colours,
                has_normals: summary.has_normals,
                unlit: summary.unlit,
                has_masks: summary.has_masks,
                unread: summary.warnings,
            })
        }
        Geometry::Shape {
            shape,
            metallic,
            roughness,
            transmission,
            ..
        } => {
            let triangles = shapes::triangle_count(*shape);
            Ok(PlannedObject {
                name: object.name.clone(),
                file: None,
                without_file: "shape",
                files: Vec::new(),
                triangles,
                // As many as for boxes; spheres share theirs.
                vertices: 2 * triangles,
                uvs: false,
                textures: false,
                normals: false,
                radiance: Vec::new(),
                uv_sets: 1,
                materials: vec![String::new()],
                factors: vec![Factors {
                    metallic: *metallic,
                    roughness: *roughness,
                    transmission: *transmission,
                    double_sided: matches!(shape, Shape::Plane { .. }),
                    emits: false,
                    has_gloss_texture: false,
                }],
                has_gloss_textures: false,
                images: 0,
                placing: 0,
                has_colours: false,
                has_normals: false,
                unlit: Vec::new(),
                has_masks: false,
                unread: Vec::new(),
            })
        }
        Geometry::Mesh(mesh) => Ok(PlannedObject {
            name: object.name.clone(),
            file: None,
            without_file: "mesh in memory",
            files: Vec::new(),
            triangles: mesh.triangles.len() as u64,
            vertices: mesh.positions.len() as u64,
            uvs: false,
            textures: false,
            normals: false,
            radiance: Vec::new(),
            uv_sets: mesh.uvs.iter().filter(|set| !set.is_empty()).count(),
            materials: mesh.materials.iter().map(|m| m.name.clone()).collect(),
            factors: mesh.materials.iter().map(|m| m.factors()).collect(),
            has_gloss_textures: false,
            images: 0,
            placing: 0,
            has_colours: !mesh.colours.is_empty(),
            has_normals: !mesh.normals.is_empty(),
            unlit: (mesh.materials.iter().filter(|m| m.unlit))
                .map(|m| m.name.clone())
                .collect(),
            has_masks: mesh.has_masks(),
            unread: Vec::new(),
        }),
    }
}

/// Shape and size of each cube that is used, from the header of its file, with the checks that need no samples.
fn inspect_cubes(
    scene: &Scene,
    objects: &[PlannedObject],
    memory: u64,
) -> Result<Vec<Option<PlannedCube>>> {
    let used = bindings::used_sources(scene, objects);
    scene
        .sources
        .iter()
        .zip(used)
        .map(|(source, used)| {
            let SourceKind::Cube(cube) = &source.kind else {
                return Ok(None);
            };
            if !used {
                return Ok(None);
            }
            let (shape, bytes, file, array) = match &cube.data {
                CubeData::File(file) => {
                    let wanted = cube.wanted(file).within(memory);
                    let info = cubes::inspect(&file.path, wanted)?;
                    (
                        info.shape,
                        info.bytes,
                        Some(file.path.clone()),
                        file.array.clone(),
                    )
                }
                CubeData::Memory(cube) => (cube.shape, cube.samples.bytes(), None, None),
            };
            let [h, w, ..] = shape;
            check_crop(scene, source, cube, [w, h])?;
            check_picture(scene, source, cube, [w, h])?;
            check_edges(scene, source, cube, shape[2])?;
            check_backs(scene, source, cube, h)?;
            let projected = matches!(cube.mapping, Mapping::Capture(_));
            Ok(Some(PlannedCube {
                source: source.name.clone(),
                file,
                array,
                shape,
                channels: cube.channels.as_ref().map(Channels::names),
                bytes,
                capture_rays: if projected { (h * w) as u64 } else { 0 },
                sums: match cube.is_read_over_spans(&scene.camera) {
                    true => TimeTexture::bytes_of_sums(shape),
                    false => 0,
                },
                held: None,
                read: None,
            }))
        })
        .collect()
}

/// Refuses a cube that does not fit on the film that it is a crop of.
fn check_crop(scene: &Scene, source: &Source, cube: &CubeSource, size: [usize; 2]) -> Result<()> {
    let Mapping::Capture(camera) = &cube.mapping else {
        return Ok(());
    };
    let Some(Crop { film, offset }) = camera.crop else {
        return Ok(());
    };
    let fits = |axis: usize| size[axis] <= film[axis].saturating_sub(offset[axis]) as usize;
    if fits(0) && fits(1) {
        return Ok(());
    }
    let ([w, h], [fw, fh], [x, y]) = (size, film, offset);
    Err(Error::invalid(
        &scene.name,
        format!("source \"{}\", capture.crop", source.name),
        format!("a cube of {w} × {h} pixels at ({x}, {y}) reaches beyond a film of {fw} × {fh}"),
        "`film` is the size of the whole film, `offset` where the cube begins on it, both columns first",
    ))
}

/// Refuses a cube that cannot be a picture of its camera.
fn check_picture(
    scene: &Scene,
    source: &Source,
    cube: &CubeSource,
    size: [usize; 2],
) -> Result<()> {
    let Mapping::Capture(camera) = &cube.mapping else {
        return Ok(());
    };
    let Some(picture) = camera.picture else {
        return Ok(());
    };
    let [w, h] = size.map(|n| n as u64);
    let [columns, rows] = picture.map(u64::from);
    // At another resolution, rows and columns are rounded.
    let is_alike = match camera.crop {
        Some(_) => [w, h] == [columns, rows],
        None => (w * rows).abs_diff(h * columns) <= columns.max(rows),
    };
    if is_alike {
        return Ok(());
    }
    let help = match camera.crop {
        Some(_) => {
            "a cube of that size; or give `hfov`, `crop` and the pose without `colmap`".to_string()
        }
        None => format!(
            "a cube of that shape; of a part of the picture, crop = {{ film = [{columns}, {rows}], offset = [left, above] }}"
        ),
    };
    Err(Error::invalid(
        &scene.name,
        format!("source \"{}\", capture.pose", source.name),
        format!("a cube of {w} × {h} pixels of a camera whose pictures have {columns} × {rows}"),
        help,
    ))
}

/// Refuses an odd number of rows if half of them belong to backs, and rows of backs that the source does not declare.
fn check_backs(scene: &Scene, source: &Source, cube: &CubeSource, rows: usize) -> Result<()> {
    let Mapping::Uv { backs, .. } = cube.mapping else {
        return Ok(());
    };
    let refuse = |what: String, help: &str| {
        let place = format!("source \"{}\", cube.backs", source.name);
        Err(Error::invalid(&scene.name, place, what, help))
    };
    if backs == CubeBacks::SecondHalf {
        return match rows.is_multiple_of(2) {
            true => Ok(()),
            false => refuse(
                format!("{rows} rows have no second half of backs"),
                "a cube as `nullray bake` writes it, or backs = \"black\"",
            ),
        };
    }
    match has_rows_of_backs(cube) {
        true => refuse(
            "the second half of the file's rows is light of backs, by its metadata".into(),
            "add backs = \"second_half\", as `nullray bake` prints it and `nullray info` of the file",
        ),
        false => Ok(()),
    }
}

/// Whether a file written by `nullray bake` says that it contains backs.
fn has_rows_of_backs(cube: &CubeSource) -> bool {
    let said = cube.recorded.backs.as_deref();
    said.and_then(CubeBacks::named) == Some(CubeBacks::SecondHalf)
}

/// Refuses a table of edges that does not match the number of bins.
fn check_edges(scene: &Scene, source: &Source, cube: &CubeSource, bins: usize) -> Result<()> {
    let TimeBins::Edges(edges) = &cube.bins else {
        return Ok(());
    };
    if edges.len() == bins + 1 {
        return Ok(());
    }
    Err(Error::invalid(
        &scene.name,
        format!("source \"{}\", cube.edges", source.name),
        format!("{} edges for {bins} time bins", edges.len()),
        format!(
            "{bins} bins have {} edges: the start of each, and the end of the last",
            bins + 1
        ),
    ))
}

/// How much work the pictures' rays justify. In f32, results on edges may depend on the tree: there it is always the same.
fn trees(request: &Request, rays: &Rays, objects: &[PlannedObject]) -> Preset {
    if request.precision == Precision::Fast {
        return Preset::default();
    }
    let triangles = objects.iter().map(|object| object.triangles).sum();
    Preset::for_rays(triangles, rays.of_pictures(request.pictures))
}

fn rays(
    scene: &Scene,
    layout: &Layout,
    objects: &[PlannedObject],
    cubes: &[Option<PlannedCube>],
) -> Rays {
    let camera = layout.size[0] as u64 * layout.size[1] as u64 * layout.samples as u64;
    let pulses = bindings::used_sources(scene, objects)
        .into_iter()
        .zip(&scene.sources)
        .filter(|(used, s)| *used && matches!(&s.kind, SourceKind::Pulse(p) if p.shadows))
        .count() as u64;
    let lights = scene.lights.iter().filter(|light| light.shadows).count() as u64;
    // For a sky: one for its light, one for gloss, one for its sun.
    let sky = scene.sky.as_ref().filter(|sky| sky.lights && sky.shadows);
    let lights = lights + sky.map_or(0, |sky| 2 + u64::from(sky.sun.is_some()));
    let capture: u64 = cubes.iter().flatten().map(|c| c.capture_rays).sum();
    let towards = match scene.objects.is_empty() {
        true => 0,
        false => (pulses + lights).max(bindings::most_captures(scene, objects)),
    };
    // Each level of a path has its own shadow rays; after the last surface a ray looks for emission.
    let (levels, reflects) = (
        u64::from(scene.bounces) + 1,
        pulses + lights > 0 && towards > 0,
    );
    let bounces_at_most = match scene.bounces > 0 && reflects {
        true => camera.saturating_mul(levels),
        false => 0,
    };
    Rays {
        camera,
        shadow_at_most: camera.saturating_mul(towards).saturating_mul(levels),
        bounces_at_most,
        capture,
    }
}
