//! External files that a scene names, gathered before it is resolved: resolving opens nothing.

use std::cell::RefCell;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::hash::Hash;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use glam::DVec3;

use super::at::At;
use super::memory::Memory;
use crate::error::Result;
use crate::io::colmap::ColmapPicture;
use crate::io::cube::Recorded;
use crate::io::gltf::{GltfLight, GltfTrack};

/// The pose of a camera.
#[derive(Debug, Clone)]
pub(super) struct Pose {
    pub eye: DVec3,
    /// Orthonormal: right, up, forward.
    pub axes: [DVec3; 3],
    /// From a camera of glTF: the horizontal field of view if known, and the vertical one.
    pub gltf_fov: Option<(Option<f64>, f64)>,
    /// Of a camera of COLMAP.
    pub picture: Option<ColmapPicture>,
}

/// Results of looking at external files, shared by everything that is read from the same text.
#[derive(Debug, Default)]
pub(super) struct FileCache {
    /// Files that exist.
    files: Mutex<HashSet<PathBuf>>,
    /// Poses of glTF cameras, by file and node.
    poses: Mutex<HashMap<InFile, Pose>>,
    /// Paths of nodes, by file, node and animation.
    tracks: Mutex<HashMap<(InFile, Option<String>), GltfTrack>>,
    /// Lights of glTF files, by file and node.
    lights: Mutex<HashMap<InFile, GltfLight>>,
    /// Rows of the tables of spectra.
    tables: Mutex<HashMap<PathBuf, Rows>>,
    /// Arrays of one axis, by file and array.
    numbers: Mutex<HashMap<InFile, Vec<f64>>>,
    /// What files of cubes say of their light, by file and array.
    recorded: Mutex<HashMap<InFile, Recorded>>,
}

/// A file, and the name of the item in it.
type InFile = (PathBuf, Option<String>);

/// The rows of a table.
type Rows = Vec<[f64; 2]>;

impl FileCache {
    /// Whether the file at `path` existed when it was first checked; `look` checks it.
    pub fn look_for(&self, path: &Path, look: impl FnOnce() -> io::Result<u64>) -> io::Result<()> {
        let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        if !files.contains(path) {
            look()?;
            files.insert(path.to_path_buf());
        }
        Ok(())
    }

    /// The pose of the camera at `node` in the file at `path`, as first read; `read` reads it.
    pub fn pose(
        &self,
        path: &Path,
        node: Option<&str>,
        read: impl FnOnce() -> Result<Pose>,
    ) -> Result<Pose> {
        let node = node.map(str::to_string);
        once(&self.poses, (path.to_path_buf(), node), read)
    }

    /// The light at `node` in the file at `path`, as first read; `read` reads it.
    pub fn light(
        &self,
        path: &Path,
        node: Option<&str>,
        read: impl FnOnce() -> Result<GltfLight>,
    ) -> Result<GltfLight> {
        let node = node.map(str::to_string);
        once(&self.lights, (path.to_path_buf(), node), read)
    }

    /// The path of a node in the file at `path`, as first read; `read` reads it.
    pub fn track(
        &self,
        path: &Path,
        [node, animation]: [Option<&str>; 2],
        read: impl FnOnce() -> Result<GltfTrack>,
    ) -> Result<GltfTrack> {
        let [node, animation] = [node, animation].map(|name| name.map(str::to_string));
        once(&self.tracks, ((path.to_path_buf(), node), animation), read)
    }

    /// The rows of the table in the file at `path`, as first read; `read` reads them.
    pub fn table(&self, path: &Path, read: impl FnOnce() -> Result<Rows>) -> Result<Rows> {
        once(&self.tables, path.to_path_buf(), read)
    }

    /// What the cube file at `path` says of the light in an array, as first read; `read` reads it.
    pub fn recorded(
        &self,
        path: &Path,
        array: Option<&str>,
        read: impl FnOnce() -> Result<Recorded>,
    ) -> Result<Recorded> {
        let array = array.map(str::to_string);
        once(&self.recorded, (path.to_path_buf(), array), read)
    }

    /// The numbers of an array of the file at `path`, as first read; `read` reads them.
    pub fn numbers(
        &self,
        path: &Path,
        array: Option<&str>,
        read: impl FnOnce() -> Result<Vec<f64>>,
    ) -> Result<Vec<f64>> {
        let array = array.map(str::to_string);
        once(&self.numbers, (path.to_path_buf(), array), read)
    }
}

/// The entry of `known` for `key`, or the result of `read`, which is kept.
fn once<K: Hash + Eq, V: Clone>(
    known: &Mutex<HashMap<K, V>>,
    key: K,
    read: impl FnOnce() -> Result<V>,
) -> Result<V> {
    let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(value) = known.get(&key) {
        return Ok(value.clone());
    }
    let value = read()?;
    known.insert(key, value.clone());
    Ok(value)
}

/// What was found in the files that a scene names.
#[derive(Default)]
pub(super) struct Inputs {
    /// The folder against which relative paths resolve.
    pub base: PathBuf,
    /// The folder within which glTF files may refer to others, besides their own; `None` for no restriction.
    pub reach: Option<PathBuf>,
    /// Meshes and cubes in memory.
    pub memory: Memory,
    /// Files, and COLMAP folders, that were read for poses, paths, lights, tables and numbers.
    pub read: BTreeSet<PathBuf>,
    /// What to do about missing files, as the scene says.
    pub if_missing: Option<String>,
    /// By place in the text: why the file named there cannot be used.
    problems: HashMap<usize, String>,
    /// Places in the text that name missing files.
    missing: HashSet<usize>,
    /// By place in the text: the pose of the glTF camera named there.
    poses: RefCell<HashMap<usize, Result<Pose>>>,
    /// By place in the text: the path of the node of the glTF file named there.
    tracks: RefCell<HashMap<usize, Result<GltfTrack>>>,
    /// By place in the text: the light of the glTF file named there.
    lights: RefCell<HashMap<usize, Result<GltfLight>>>,
    /// By place in the text: the rows of the table of a spectrum named there.
    tables: RefCell<HashMap<usize, Result<Vec<[f64; 2]>>>>,
    /// By place in the text: the numbers in the file named there.
    numbers: RefCell<HashMap<usize, Result<Vec<f64>>>>,
    /// By place in the text: what the cube file named there says of its light.
    recorded: RefCell<HashMap<usize, Result<Recorded>>>,
}

impl Inputs {
    /// Without any inputs so far.
    pub fn new(base: PathBuf, memory: Memory) -> Self {
        Inputs {
            reach: Some(base.clone()),
            base,
            memory,
            ..Inputs::default()
        }
    }

    fn note(&mut self, file: &At<String>) {
        self.read.insert(self.base.join(&file.value));
    }

    /// Records that the file named at `file` cannot be used.
    pub fn add_problem(&mut self, file: &At<String>, problem: String) {
        self.problems.insert(file.span.start, problem);
    }

    /// Records that the file named at `file` is missing, and why.
    pub fn add_missing(&mut self, file: &At<String>, problem: String) {
        self.missing.insert(file.span.start);
        self.add_problem(file, problem);
    }

    /// What the scene says to do if the file named at `file` is missing.
    pub fn remedy(&self, file: &At<String>) -> Option<&str> {
        let said = self.if_missing.as_deref();
        said.filter(|_| self.missing.contains(&file.span.start))
    }

    /// Records the pose of the glTF camera in the file named at `file`, or why it cannot be read.
    pub fn add_pose(&mut self, file: &At<String>, pose: Result<Pose>) {
        self.note(file);
        self.poses.get_mut().insert(file.span.start, pose);
    }

    /// Records the path of the node of the glTF file named at `file`, or why it cannot be read.
    pub fn add_track(&mut self, file: &At<String>, track: Result<GltfTrack>) {
        self.note(file);
        self.tracks.get_mut().insert(file.span.start, track);
    }

    /// The path of the node of the glTF file named at `file`, if it was read.
    pub fn track(&self, file: &At<String>) -> Option<Result<GltfTrack>> {
        let mut tracks = self.tracks.borrow_mut();
        match tracks.get(&file.span.start) {
            Some(Ok(track)) => Some(Ok(track.clone())),
            // As for poses.
            _ => tracks.remove(&file.span.start),
        }
    }

    /// Records the light of the glTF file named at `file`, or why it cannot be read.
    pub fn add_light(&mut self, file: &At<String>, light: Result<GltfLight>) {
        self.note(file);
        self.lights.get_mut().insert(file.span.start, light);
    }

    /// The light of the glTF file named at `file`, if it was read. Can be called once.
    pub fn light(&self, file: &At<String>) -> Option<Result<GltfLight>> {
        self.lights.borrow_mut().remove(&file.span.start)
    }

    /// Records the rows of the spectrum in the file named at `file`, or why they cannot be read.
    pub fn add_table(&mut self, file: &At<String>, rows: Result<Vec<[f64; 2]>>) {
        self.note(file);
        self.tables.get_mut().insert(file.span.start, rows);
    }

    /// Records what the file named at `file` says of the light in its cube, or why it cannot be read.
    pub fn add_recorded(&mut self, file: &At<String>, recorded: Result<Recorded>) {
        self.recorded.get_mut().insert(file.span.start, recorded);
    }

    /// What the file named at `file` says of the light in its cube; nothing, if it was not looked for. Can be called once.
    pub fn recorded(&self, file: &At<String>) -> Result<Recorded> {
        let found = self.recorded.borrow_mut().remove(&file.span.start);
        found.unwrap_or_else(|| Ok(Recorded::default()))
    }

    /// Records the numbers in the file named at `file`, or why they cannot be read.
    pub fn add_numbers(&mut self, file: &At<String>, numbers: Result<Vec<f64>>) {
        self.note(file);
        self.numbers.get_mut().insert(file.span.start, numbers);
    }

    /// The numbers in the file named at `file`, if it was read. Can be called once.
    pub fn numbers(&self, file: &At<String>) -> Option<Result<Vec<f64>>> {
        self.numbers.borrow_mut().remove(&file.span.start)
    }

    /// The rows of the table in the file named at `file`, if it was read. Can be called once.
    pub fn table(&self, file: &At<String>) -> Option<Result<Vec<[f64; 2]>>> {
        self.tables.borrow_mut().remove(&file.span.start)
    }

    /// Why the file named at `file` cannot be used, if so.
    pub fn problem(&self, file: &At<String>) -> Option<&str> {
        self.problems.get(&file.span.start).map(String::as_str)
    }

    /// The pose of the glTF camera in the file named at `file`, if it was read.
    pub fn pose(&self, file: &At<String>) -> Option<Result<Pose>> {
        let mut poses = self.poses.borrow_mut();
        match poses.get(&file.span.start) {
            Some(Ok(pose)) => Some(Ok(pose.clone())),
            // Errors cannot be cloned; one ends the resolution.
            _ => poses.remove(&file.span.start),
        }
    }
}
