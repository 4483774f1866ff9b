//! From a file, or its text, to a scene.

use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;

use super::at::At;
use super::file;
use super::inputs::{FileCache, Inputs, Pose};
use super::memory::{self, Memory};
use super::model::Scene;
use super::overrides::{self, Overrides};
use super::report::Report;
use super::resolve::{self, Context, GLTF, Kinematics, NUMBERS, SPECTRUM};
use super::text::Text;
use crate::error::{Error, Result};
use crate::io::budget::Budget;
use crate::io::cube::{self, CubeFormat};
use crate::io::{colmap, files, gltf, npy, spectrum};

/// The longest scene file, bytes. Scenes name their data; they do not hold them.
const LONGEST: usize = 4 << 20;

/// The memory limit for a table of numbers, bytes.
const LONGEST_TABLE: u64 = 16 << 20;

/// A scene file that was read once: even if the file changes, all scenes and panels made from this use the same text and the same glTF
/// cameras and lights, and look for the same files once.
#[derive(Debug)]
pub struct SceneFile {
    pub(super) name: String,
    pub(super) text: String,
    pub(super) base: PathBuf,
    /// The folder within which glTF files may refer to others, besides their own.
    pub(super) reach: PathBuf,
    /// Meshes and cubes from a program.
    pub(super) memory: Memory,
    pub(super) cache: FileCache,
}

impl SceneFile {
    /// Reads the file at `path`; relative paths in it resolve against its folder.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be read; [`Error::Invalid`] if it is too long for a scene, or not UTF-8.
    pub fn read(path: &Path) -> Result<SceneFile> {
        let name = path.display().to_string();
        Ok(SceneFile::of_text(&text_of(path)?, &name, base(path)))
    }

    /// Reads a scene called `name` from a stream, like a pipe; relative paths in it resolve against `base`.
    ///
    /// # Errors
    /// As [`SceneFile::read`].
    pub fn read_from(reader: impl Read, name: &str, base: &Path) -> Result<SceneFile> {
        let text = text(start_of(reader, Path::new(name))?, Path::new(name))?;
        Ok(SceneFile::of_text(&text, name, base))
    }

    /// The text as it was read.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The name of the scene in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The folder against which relative paths in it resolve.
    pub fn base(&self) -> &Path {
        &self.base
    }

    /// A scene called `name` from its text; relative paths in it resolve against `base`.
    pub fn of_text(text: &str, name: &str, base: &Path) -> SceneFile {
        SceneFile {
            name: name.to_string(),
            text: text.to_string(),
            base: base.to_path_buf(),
            reach: base.to_path_buf(),
            memory: Memory::default(),
            cache: FileCache::default(),
        }
    }

    /// The same scene, restricted so that its glTF files may refer only to files within `folder` and their own folders, not within the
    /// folder against which paths resolve: a model without a scene must not read files that happen to be beside it.
    pub fn reaching(mut self, folder: &Path) -> SceneFile {
        self.reach = folder.to_path_buf();
        self
    }

    /// The text with the changes of `overrides`; no file that it names is looked for.
    ///
    /// # Errors
    /// Changes that cannot be made.
    pub fn changed_text(&self, overrides: &Overrides) -> Result<String> {
        let report = report(&self.text, &self.name, overrides)?;
        Ok(report.text.edited.to_string())
    }

    /// The scene with the changes of `overrides`.
    ///
    /// # Errors
    /// As [`load`].
    pub fn scene(&self, overrides: &Overrides) -> Result<Scene> {
        let report = report(&self.text, &self.name, overrides)?;
        scene(report, self, overrides.allow_outside)
    }
}

/// Reads the scene file at `path`; relative paths in it resolve against its folder.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read; [`Error::Invalid`] if it is not a valid scene, with the place in it and what would be right.
/// Files that it names are checked for existence, not read (except for the poses of glTF cameras, and glTF lights).
pub fn load(path: &Path, overrides: &Overrides) -> Result<Scene> {
    SceneFile::read(path)?.scene(overrides)
}

/// The text of the scene file at `path`.
pub(crate) fn text_of(path: &Path) -> Result<String> {
    text(read(path)?, path)
}

fn text(bytes: Vec<u8>, path: &Path) -> Result<String> {
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let help = "a scene is a TOML file in UTF-8";
        Error::invalid(path, format!("byte {at}"), "not UTF-8 text", help)
    })
}

/// The folder against which relative paths in the scene file at `path` resolve.
pub(crate) fn base(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// Reads the text of a scene called `name`; relative paths in it resolve against `base`.
///
/// # Errors
/// As [`load`].
pub fn parse(text: &str, name: &str, base: &Path, overrides: &Overrides) -> Result<Scene> {
    SceneFile::of_text(text, name, base).scene(overrides)
}

/// The scene of the report's text; files that it names are looked up in the cache.
pub(super) fn scene(
    report: Report,
    SceneFile {
        base,
        reach,
        memory,
        cache,
        ..
    }: &SceneFile,
    allow_outside: bool,
) -> Result<Scene> {
    let file: file::Scene = report.read()?;
    // Every file that the scene names is looked for here: the resolver gets the results, and opens nothing.
    let mut inputs = Inputs::new(base.clone(), memory.clone());
    inputs.reach = (!allow_outside).then(|| reach.clone());
    let meshes = file.object.iter().filter_map(|at| at.value.gltf.as_ref());
    let cubes = || file.source.iter().filter_map(|at| at.value.cube.as_ref());
    for name in meshes {
        look_for(&mut inputs, cache, name);
    }
    for cube in cubes() {
        look_for_cube(&mut inputs, cache, &cube.value);
    }
    let sky = file.sky.as_ref().map(|at| &at.value);
    let image = sky.and_then(|sky| Some(&sky.image.as_ref()?.value.file));
    let stars = sky.and_then(|sky| sky.stars.as_ref()?.value.file.as_ref());
    for name in image.into_iter().chain(stars) {
        look_for(&mut inputs, cache, name);
    }
    if let Some(sky) = sky {
        read_spectrum(&mut inputs, cache, &sky.spectrum);
    }
    for capture in cubes().filter_map(|cube| cube.value.capture.as_ref()) {
        read_pose(&mut inputs, cache, &capture.value.gltf, &capture.value.node);
        read_colmap(&mut inputs, cache, &capture.value.pose);
    }
    for edges in cubes().filter_map(|cube| cube.value.edges_file.as_ref()) {
        read_numbers(&mut inputs, cache, &edges.value);
    }
    for object in &file.object {
        if let Some(coordinates) = &object.value.texture_coordinates {
            look_for(&mut inputs, cache, &coordinates.value.file);
        }
        read_spectrum(&mut inputs, cache, &object.value.spectrum);
    }
    for light in &file.light {
        read_spectrum(&mut inputs, cache, &light.value.spectrum);
    }
    lights(&mut inputs, cache, &file.light);
    camera(&mut inputs, cache, &file);
    resolve::scene(report, inputs, file)
}

/// Reads the table of a spectrum, if it has one.
fn read_spectrum(inputs: &mut Inputs, cache: &FileCache, spectrum: &Option<At<file::Spectrum>>) {
    let Some(name) = spectrum.as_ref().and_then(|at| at.value.table.as_ref()) else {
        return;
    };
    look_for(inputs, cache, name);
    let path = inputs.base.join(&name.value);
    if inputs.problem(name).is_none() && resolve::has_extension(&path, SPECTRUM) {
        inputs.add_table(name, cache.table(&path, || spectrum::load(&path)));
    }
}

/// Looks for the file of a cube or for the pictures of a sequence, and reads what the file says of its light.
fn look_for_cube(inputs: &mut Inputs, cache: &FileCache, cube: &file::Cube) {
    let name = &cube.file;
    if name.value.starts_with(memory::PREFIX) {
        return;
    }
    let path = inputs.base.join(&name.value);
    let array = cube.array.as_ref().map(|at| at.value.as_str());
    let format = cube::format_called(&path);
    match format.and_then(CubeFormat::by_path) {
        None => look_for(inputs, cache, name),
        // All or some of its files.
        Some(_) => {
            if let Err(error) = cube::files(&path) {
                inputs.add_missing(name, error.to_string());
            }
        }
    }
    if inputs.problem(name).is_none() && format.is_some() {
        let recorded = cache.recorded(&path, array, || cube::recorded(&path, array));
        inputs.add_recorded(name, recorded);
    }
}

/// Reads a table of edges.
fn read_numbers(inputs: &mut Inputs, cache: &FileCache, table: &file::EdgesFile) {
    let name = &table.file;
    look_for(inputs, cache, name);
    let path = inputs.base.join(&name.value);
    if inputs.problem(name).is_some() || !resolve::has_extension(&path, NUMBERS) {
        return;
    }
    let array = table.array.as_ref().map(|array| array.value.as_str());
    let numbers = cache.numbers(&path, array, || {
        npy::load_numbers(&path, array, &Budget::new(LONGEST_TABLE))
    });
    inputs.add_numbers(name, numbers);
}

/// The kinematics in the text of a scene called `name`: positions, motions, and effects. No mesh and no cube is looked for.
///
/// # Errors
/// As [`load`].
pub(crate) fn kinematics(
    text: &str,
    name: &str,
    base: &Path,
    overrides: &Overrides,
) -> Result<Kinematics> {
    let report = report(text, name, overrides)?;
    let file: file::Scene = report.read()?;
    let cache = SceneFile::of_text(text, name, base).cache;
    let mut inputs = Inputs::new(base.to_path_buf(), Memory::default());
    camera(&mut inputs, &cache, &file);
    Kinematics::new(&Context::new(report, inputs, &file.speed_of_light)?, &file)
}

fn camera<D>(inputs: &mut Inputs, cache: &FileCache, file: &file::Scene<D>) {
    if let Some(camera) = &file.camera {
        read_pose(inputs, cache, &camera.value.gltf, &camera.value.node);
        read_track(inputs, cache, &camera.value.motion);
    }
}

/// Reads lights of glTF files, and the paths that lights follow.
fn lights(inputs: &mut Inputs, cache: &FileCache, lights: &[At<file::Light>]) {
    for light in lights.iter().map(|at| &at.value) {
        read_track(inputs, cache, &light.motion);
        let Some((name, path)) = gltf_file(inputs, cache, &light.gltf) else {
            continue;
        };
        let node = light.node.as_ref().map(|node| node.value.as_str());
        let found = cache.light(&path, node, || gltf::light(&path, node));
        inputs.add_light(name, found);
    }
}

/// Looks for a glTF file, if there is one that can be read.
fn gltf_file<'n>(
    inputs: &mut Inputs,
    cache: &FileCache,
    name: &'n Option<At<String>>,
) -> Option<(&'n At<String>, PathBuf)> {
    let name = name.as_ref()?;
    look_for(inputs, cache, name);
    let path = inputs.base.join(&name.value);
    let is_there = inputs.problem(name).is_none() && resolve::has_extension(&path, GLTF);
    is_there.then_some((name, path))
}

/// Reads the path of an animated node, if a motion follows one.
fn read_track(inputs: &mut Inputs, cache: &FileCache, motion: &Option<At<file::Motion>>) {
    let animation = motion.as_ref().and_then(|at| at.value.animation.as_ref());
    let Some(file::Animation { gltf, node, name }) = animation.map(|at| &at.value) else {
        return;
    };
    look_for(inputs, cache, gltf);
    let path = inputs.base.join(&gltf.value);
    if inputs.problem(gltf).is_some() || !resolve::has_extension(&path, GLTF) {
        return;
    }
    let (node, name) = (
        node.value.as_str(),
        name.as_ref().map(|name| name.value.as_str()),
    );
    let track = cache.track(&path, [Some(node), name], || gltf::track(&path, node, name));
    inputs.add_track(gltf, track);
}

/// Records what is wrong with the file that `name` refers to; opens no file.
fn look_for(inputs: &mut Inputs, cache: &FileCache, name: &At<String>) {
    if name.value.starts_with(memory::PREFIX) {
        return;
    }
    let path = inputs.base.join(&name.value);
    match cache.look_for(&path, || files::length(&path)) {
        Ok(_) => {}
        // It exists, but is a directory or a device.
        Err(error) if error.kind() == ErrorKind::InvalidInput && path.exists() => {
            inputs.add_problem(name, error.to_string());
        }
        Err(error) => {
            let problem = format!("cannot find this file: {error}");
            match error.kind() {
                ErrorKind::NotFound => inputs.add_missing(name, problem),
                _ => inputs.add_problem(name, problem),
            }
        }
    }
}

/// Reads the pose of the camera at `node` of the glTF file `name`, if there is one.
fn read_pose(
    inputs: &mut Inputs,
    cache: &FileCache,
    name: &Option<At<String>>,
    node: &Option<At<String>>,
) {
    let Some((name, path)) = gltf_file(inputs, cache, name) else {
        return;
    };
    let node = node.as_ref().map(|node| node.value.as_str());
    let pose = cache.pose(&path, node, || {
        let camera = gltf::camera(&path, node)?;
        Ok(Pose {
            eye: camera.eye,
            axes: camera.axes,
            gltf_fov: Some((camera.horizontal_fov, camera.vertical_fov)),
            picture: None,
        })
    });
    inputs.add_pose(name, pose);
}

/// Reads the pose of an image of a COLMAP reconstruction, if one is named.
fn read_colmap(inputs: &mut Inputs, cache: &FileCache, pose: &Option<At<file::GivenPose>>) {
    let pose = pose.as_ref().map(|at| (&at.value.colmap, &at.value.image));
    let Some((Some(name), Some(image))) = pose else {
        return;
    };
    let path = inputs.base.join(&name.value);
    let pose = cache.pose(&path, Some(&image.value), || {
        let found = colmap::pose(&path, &image.value)?;
        Ok(Pose {
            eye: found.eye,
            axes: found.axes,
            gltf_fov: None,
            picture: Some(found.picture),
        })
    });
    inputs.add_pose(name, pose);
}

/// Reads the text of a file whose `[diagram]` is a `D`; `resolve` resolves it, from the scene's world lines. No mesh and no cube is
/// looked for.
pub(crate) fn parse_diagram<D: DeserializeOwned, T>(
    text: &str,
    name: &str,
    base: &Path,
    overrides: &Overrides,
    resolve: impl FnOnce(&Context, &Kinematics, Option<&At<D>>) -> Result<T>,
) -> Result<T> {
    let report = report(text, name, overrides)?;
    let mut file: file::Scene<D> = report.read()?;
    let (mut inputs, cache) = (
        Inputs::new(base.to_path_buf(), Memory::default()),
        FileCache::default(),
    );
    camera(&mut inputs, &cache, &file);
    lights(&mut inputs, &cache, &file.light);
    let cx = Context::new(report, inputs, &file.speed_of_light)?;
    let scene = Kinematics::new(&cx, &file)?.with_lamps(&cx, &mut file.light)?;
    resolve(&cx, &scene, file.diagram.as_ref())
}

/// The text of a scene, with its overrides.
fn report(text: &str, name: &str, overrides: &Overrides) -> Result<Report> {
    refuse_long(text.len(), name)?;
    let (edited, edits) = overrides::apply(text, overrides)?;
    let text = Text {
        edited: edited.into(),
        file: text.into(),
    };
    let name = name.to_string();
    Ok(Report { name, text, edits })
}

/// The extensions of models that are not read.
const OTHER_MODELS: [&str; 12] = [
    "3ds", "abc", "blend", "dae", "fbx", "obj", "ply", "stl", "usd", "usda", "usdc", "usdz",
];

/// Refuses files that are models by their names: only glTF can be read, and not as a scene.
fn refuse_model(path: &Path) -> Result<()> {
    let extension = path.extension().unwrap_or_default();
    let mut all = OTHER_MODELS.iter();
    let Some(other) = all.find(|other| extension.eq_ignore_ascii_case(other)) else {
        return Ok(());
    };
    let what =
        format!("this is a model (.{other}); glTF is the only format of models that can be read");
    let help = "export it as .glb or .gltf";
    Err(Error::unsupported(path, "", what, help))
}

fn read(path: &Path) -> Result<Vec<u8>> {
    let file = match files::open(path) {
        Ok((file, _)) => file,
        // It exists, but is a directory, a device, or a pipe, which may never end.
        Err(error) if error.kind() == ErrorKind::InvalidInput => {
            return Err(Error::invalid(
                path,
                "",
                error.to_string(),
                "name a file, not a directory, a pipe or a device; a scene can come from standard input, as -",
            ));
        }
        Err(error) => return Err(Error::io(path, "cannot open")(error)),
    };
    refuse_model(path)?;
    start_of(file, path)
}

/// The whole content, if it is not too long for a scene.
fn start_of(reader: impl Read, path: &Path) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    reader
        .take(LONGEST as u64 + 1)
        .read_to_end(&mut bytes)
        .map_err(Error::io(path, "cannot read"))?;
    refuse_long(bytes.len(), path)?;
    Ok(bytes)
}

fn refuse_long(bytes: usize, name: impl AsRef<Path>) -> Result<()> {
    if bytes <= LONGEST {
        return Ok(());
    }
    let help = "a scene names its meshes and data; it does not hold them";
    let what = format!("a scene file is at most {} MiB long", LONGEST >> 20);
    Err(Error::invalid(name, "", what, help))
}
