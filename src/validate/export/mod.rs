//! Scenes as bundles for other programs: geometry, camera, sources, and reference pictures to compare with.
//!
//! [`export`] writes a directory that a rasterizer in any language can load: GLB files of the objects in their own rest frames,
//! `bundle.json` ([`Bundle`], with its JSON schema) for everything that glTF cannot hold, cubes, and the ray tracer's result for the ray
//! through each pixel's centre, with every auxiliary channel. The page for authors of other programs is [`README`]; it is in every
//! bundle, and here:
//!
#![doc = include_str!("README.md")]

mod bundle;
mod describe;
mod folder;
mod lights;
mod reference;
mod sources;
mod vectors;

use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::path::Path;

pub use bundle::*;
pub use reference::channels as reference_channels;
pub use vectors::{ObjectVectors, Tolerances, VECTORS_FORMAT, Vector, Vectors};

use crate::accel::Precision;
use crate::camera::Camera;
use crate::colour::RGB_BASIS;
use crate::error::{Error, Message, Result, Setting};
use crate::io::gltf::{self, Want};
use crate::io::image::{npz, write_atomically};
use crate::io::temporary::in_target;
use crate::render::metadata;
use crate::render::plan::{Plan, Request, is_moot};
use crate::render::prepare::object_mesh;
use crate::render::progress::Progress;
use crate::scene::model::Scene;
use crate::spacetime::Quantity;
use folder::Folder;

/// The value of [`Bundle::format`].
pub const FORMAT: &str = "nullray-bundle";
/// The version of the format that is written.
pub const VERSION: u32 = 1;
/// The page that goes with each bundle.
pub const README: &str = include_str!("README.md");

/// The description's name.
const DESCRIPTION: &str = "bundle.json";
const SCHEMA: &str = "bundle.schema.json";
const TEXT: &str = "scene.toml";
const VECTORS: &str = "vectors.json";

/// Options of an export.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExportOptions {
    /// Whether reference pictures are rendered. Default: true.
    pub reference: bool,
    /// What to do with stored cubes. Default: copy them.
    pub cubes: Cubes,
    /// Whether test vectors are written (`vectors.json`). Default: false.
    pub vectors: bool,
    /// Whether an existing export is replaced. Default: false.
    pub overwrite: bool,
    /// The memory limit for the scene, bytes. Default: 16 GiB.
    pub memory_limit: u64,
    /// Memory of the program itself within that, bytes. Default: 0.
    pub program: u64,
}

/// What to do with stored cubes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cubes {
    /// They are copied into the bundle.
    Copied,
    /// The bundle names them, with their SHA-256; built-in ones are copied.
    Referenced,
}

impl Default for ExportOptions {
    fn default() -> Self {
        ExportOptions {
            reference: true,
            cubes: Cubes::Copied,
            vectors: false,
            overwrite: false,
            memory_limit: Request::default().memory_limit,
            program: 0,
        }
    }
}

/// What was written.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Exported {
    /// The description.
    pub bundle: Bundle,
    /// Unusual features of the scene's files that are not errors.
    pub warnings: Vec<String>,
}

/// The plan that [`export`] will carry out; for progress.
///
/// # Errors
/// As [`Plan::new`].
pub fn plan(scene: &Scene, options: &ExportOptions) -> Result<Plan> {
    let request = Request {
        aovs: reference::channels(),
        pixel_centers: true,
        precision: Precision::Certified,
        memory_limit: options.memory_limit,
        program: options.program,
        ..Request::default()
    };
    Plan::new(scene, &request)
}

/// The JSON schema (draft 2020-12) of `bundle.json`, as included in each bundle, but without indentation. It is derived from [`Bundle`]; a test compares the two.
pub const BUNDLE_SCHEMA: &str = include_str!("schema.json");

/// The same, derived from the type.
#[cfg(feature = "schema")]
pub fn derived_schema() -> serde_json::Value {
    schemars::schema_for!(Bundle).to_value()
}

/// Writes `scene` as the directory `target`, completely or not at all.
///
/// # Errors
/// A target that exists and must not be replaced; anything that cannot be planned, loaded or written; a mesh that a GLB file cannot hold;
/// [`Error::Cancelled`] when `progress` says so.
pub fn export(
    scene: &Scene,
    target: &Path,
    options: &ExportOptions,
    progress: &dyn Progress,
) -> Result<Exported> {
    if scene.camera.stereo.is_some() {
        return Err(Error::unsupported(
            &scene.name,
            "camera.stereo",
            "a bundle describes one camera, but a stereo pair has two",
            "leave [camera.stereo] out, and export each eye by its own `eye`",
        ));
    }
    let plan = plan(scene, options)?;
    let folder = Folder::create(target, options.overwrite)?;
    let temporary = folder.path("");
    filled(folder, scene, &plan, options, progress)
        .map_err(|error| in_target(error, &temporary, target))
}

/// Fills the directory, and renames it to its target.
fn filled(
    folder: Folder,
    scene: &Scene,
    plan: &Plan,
    options: &ExportOptions,
    progress: &dyn Progress,
) -> Result<Exported> {
    let mut files = Files {
        folder,
        entries: Vec::new(),
    };
    let mut warnings = Vec::new();
    let shot = Camera::new(scene)?;
    let camera = describe::camera(scene, &shot);
    if options.vectors && !vectors::fits(&camera) {
        let what = "test vectors need a camera whose rays all leave one event, with a perspective";
        let help = Message::from("leave out ")
            + Setting::Vectors
            + ", or the sensor, the shutter and the projection";
        return Err(Error::unsupported(&scene.name, "camera", what, help));
    }
    // Geometry first: the description refers to its files, and test vectors use the vertices as written.
    let seen = options.vectors.then_some((&shot, &camera));
    let (objects, tested, is_matte) = objects(scene, seen, &mut files, &mut warnings, progress)?;
    if options.vectors {
        let vectors = Vectors {
            format: VECTORS_FORMAT,
            version: VERSION,
            objects: tested,
        };
        files.text(VECTORS, &json(&vectors)?)?;
    }
    let sources = sources::write(scene, plan, options.cubes, &mut files, progress)?;
    let (reference, rendered) = match options.reference {
        true => (
            Some(reference::write(scene, plan, &mut files, progress)?),
            plan.film.channels.clone(),
        ),
        false => (None, Vec::new()),
    };
    // The description last, because it contains the checksums of all other files.
    files.text(TEXT, &scene.text)?;
    files.text("README.md", README)?;
    let schema: serde_json::Value = serde_json::from_str(BUNDLE_SCHEMA).unwrap_or_default();
    files.text(SCHEMA, &format!("{schema:#}\n"))?;
    let mut quantities = scene.sources.iter().map(|source| source.quantity);
    if scene.quantity == Quantity::Rgb || quantities.any(|quantity| quantity == Quantity::Rgb) {
        files.text("rgb_basis.csv", RGB_BASIS)?;
    }
    stop_if_cancelled(progress)?;
    let bundle = Bundle {
        format: FORMAT,
        version: VERSION,
        software: format!("nullray {}", env!("CARGO_PKG_VERSION")),
        scene: describe::scene(scene, TEXT, lights::undescribed(scene, is_matte)),
        camera,
        objects,
        sources,
        lamps: lights::lamps(scene),
        channels: describe::channels(&rendered),
        reference,
        vectors: options.vectors.then_some(VECTORS),
        files: files.entries.clone(),
    };
    files.text(DESCRIPTION, &json(&bundle)?)?;
    files.folder.finish()?;
    // Objects that share a file share its warnings.
    let mut said = BTreeSet::new();
    warnings.retain(|what| !is_moot(scene, what) && said.insert(what.clone()));
    Ok(Exported { bundle, warnings })
}

/// Writes the objects: their descriptions, the test vectors of each, and whether all of them are matte.
fn objects(
    scene: &Scene,
    seen: Option<(&Camera, &CameraEntry)>,
    files: &mut Files,
    warnings: &mut Vec<String>,
    progress: &dyn Progress,
) -> Result<(Vec<ObjectEntry>, Vec<ObjectVectors>, bool)> {
    files.folder.subfolder("geometry")?;
    let mut entries = Vec::with_capacity(scene.objects.len());
    let (mut tested, mut is_matte) = (Vec::new(), true);
    for (index, object) in scene.objects.iter().enumerate() {
        stop_if_cancelled(progress)?;
        let all = Want {
            uvs: true,
            textures: true,
            shading: false,
            normals: true,
            bad_vertices: object.bad_vertices,
            bad_textures: object.bad_textures,
        };
        let (mesh, images) = object_mesh(scene, object, all, warnings)?;
        is_matte &= mesh.materials.iter().all(lights::is_matte);
        let runs = gltf::glb::runs(&mesh);
        let bytes = gltf::glb::write(&object.name, &mesh, &runs, &images, |_| true)
            .map_err(|what| unfit(scene, &object.name, what))?;
        let name = format!("geometry/{index:03}.glb");
        files.bytes(&name, &bytes)?;
        // GLB files have single precision: if that loses digits, the vertices are also written in double precision.
        let positions = (!gltf::glb::is_exact(&mesh)).then(|| format!("geometry/{index:03}.npy"));
        if let Some(name) = &positions {
            let rows: Vec<_> = mesh.positions.iter().map(|p| p.to_array()).collect();
            files.written(name, |path| npz::write_vectors(path, &rows))?;
        }
        let names = [Some(name), positions];
        let entry = describe::object(scene, index, &mesh, &runs, names);
        if let Some((shot, camera)) = seen {
            tested.push(vectors::of_object(
                scene,
                shot,
                index,
                &mesh,
                (camera, &entry),
            )?);
        }
        entries.push(entry);
    }
    Ok((entries, tested, is_matte))
}

fn unfit(scene: &Scene, object: &str, what: &str) -> Error {
    let help = "scale the object down, or split it";
    Error::unsupported(&scene.name, format!("object \"{object}\""), what, help)
}

/// The files of a bundle under construction.
#[derive(Debug)]
struct Files {
    folder: Folder,
    entries: Vec<FileEntry>,
}

impl Files {
    fn text(&mut self, name: &str, text: &str) -> Result<()> {
        self.bytes(name, text.as_bytes())
    }

    fn bytes(&mut self, name: &str, bytes: &[u8]) -> Result<()> {
        self.written(name, |path| {
            write_atomically(path, |writer| {
                writer
                    .write_all(bytes)
                    .map_err(Error::io(path, "cannot write"))
            })
        })
    }

    /// Calls `write` to write the file `name`, and adds it to the list.
    fn written(&mut self, name: &str, write: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
        let path = self.folder.path(name);
        write(&path)?;
        let (bytes, sha256) = digest(&path)?;
        self.entries.push(FileEntry {
            path: name.into(),
            bytes,
            sha256,
        });
        Ok(())
    }
}

/// Length and SHA-256 of a file.
fn digest(path: &Path) -> Result<(u64, String)> {
    let failed = || Error::io(path, "cannot read");
    let mut file = fs::File::open(path).map_err(failed())?;
    metadata::sha256_of(&mut file).map_err(failed())
}

fn json(value: &impl serde::Serialize) -> Result<String> {
    let text = serde_json::to_string_pretty(value);
    let text = text.map_err(|e| Error::invalid(DESCRIPTION, "", e.to_string(), ""))?;
    Ok(text + "\n")
}

fn stop_if_cancelled(progress: &dyn Progress) -> Result<()> {
    match progress.is_cancelled() {
        true => Err(Error::Cancelled),
        false => Ok(()),
    }
}
