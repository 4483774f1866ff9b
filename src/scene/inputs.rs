//! What a scene names outside its text, gathered before it is resolved: resolving opens nothing.

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
use crate::io::cube::FileTimes;
use crate::io::gltf::GltfTrack;

/// Where a camera is and where it looks.
#[derive(Debug, Clone)]
pub(super) struct Pose {
    pub eye: DVec3,
    /// Orthonormal: right, up, forward.
    pub axes: [DVec3; 3],
    /// From a camera of glTF or COLMAP: the horizontal field of view where it is known, and the vertical one.
    pub gltf_fov: Option<(Option<f64>, f64)>,
}

/// What was found outside the text of a scene, so that all that is read from one text sees the same.
#[derive(Debug, Default)]
pub(super) struct FileCache {
    /// Files that are there.
    files: Mutex<HashSet<PathBuf>>,
    /// Poses of glTF cameras, by file and node.
    poses: Mutex<HashMap<InFile, Pose>>,
    /// Ways of nodes, by file, node and animation.
    tracks: Mutex<HashMap<(InFile, Option<String>), GltfTrack>>,
    /// Rows of the tables of spectra.
    tables: Mutex<HashMap<PathBuf, Rows>>,
    /// Arrays of one axis, by file and array.
    numbers: Mutex<HashMap<InFile, Vec<f64>>>,
    /// Time axes that files of cubes say, by file and array.
    times: Mutex<HashMap<InFile, Option<FileTimes>>>,
}

/// A file, and what it is called that is looked for in it.
type InFile = (PathBuf, Option<String>);

/// The rows of a table.
type Rows = Vec<[f64; 2]>;

impl FileCache {
    /// Whether the file at `path` was there when it was first looked for; `look` looks for it.
    pub fn look_for(&self, path: &Path, look: impl FnOnce() -> io::Result<u64>) -> io::Result<()> {
        let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        if !files.contains(path) {
            look()?;
            files.insert(path.to_path_buf());
        }
        Ok(())
    }

    /// The pose of the camera at `node` in the file at `path`, as it was first read; `read` reads it.
    pub fn pose(
        &self,
        path: &Path,
        node: Option<&str>,
        read: impl FnOnce() -> Result<Pose>,
    ) -> Result<Pose> {
        let node = node.map(str::to_string);
        once(&self.poses, (path.to_path_buf(), node), read)
    }

    /// The way of a node in the file at `path`, as it was first read; `read` reads it.
    pub fn track(
        &self,
        path: &Path,
        [node, animation]: [Option<&str>; 2],
        read: impl FnOnce() -> Result<GltfTrack>,
    ) -> Result<GltfTrack> {
        let [node, animation] = [node, animation].map(|name| name.map(str::to_string));
        once(&self.tracks, ((path.to_path_buf(), node), animation), read)
    }

    /// The rows of the table in the file at `path`, as they were first read; `read` reads them.
    pub fn table(&self, path: &Path, read: impl FnOnce() -> Result<Rows>) -> Result<Rows> {
        once(&self.tables, path.to_path_buf(), read)
    }

    /// What the file of a cube at `path` says of the time axis of an array, as it was first read; `read` reads it.
    pub fn times(
        &self,
        path: &Path,
        array: Option<&str>,
        read: impl FnOnce() -> Result<Option<FileTimes>>,
    ) -> Result<Option<FileTimes>> {
        let array = array.map(str::to_string);
        once(&self.times, (path.to_path_buf(), array), read)
    }

    /// The numbers of an array of the file at `path`, as they were first read; `read` reads them.
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

/// What `known` has of `key`, or what `read` gives, which is kept.
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

/// What was found of that which a scene names.
#[derive(Default)]
pub(super) struct Inputs {
    /// The folder against which relative paths resolve.
    pub base: PathBuf,
    /// The folder within which glTF files may refer to others, besides their own; none for anywhere.
    pub reach: Option<PathBuf>,
    /// Meshes and cubes in memory.
    pub memory: Memory,
    /// Files, and folders of COLMAP, that were read for poses, ways, tables and numbers.
    pub read: BTreeSet<PathBuf>,
    /// What to do about files that are not there, as the scene says.
    pub if_missing: Option<String>,
    /// By place in the text: why the file that is named there cannot be used.
    problems: HashMap<usize, String>,
    /// Places in the text where files are named that are not there.
    missing: HashSet<usize>,
    /// By place in the text: the pose that the glTF camera named there has.
    poses: RefCell<HashMap<usize, Result<Pose>>>,
    /// By place in the text: the way of the node of the glTF file named there.
    tracks: RefCell<HashMap<usize, Result<GltfTrack>>>,
    /// By place in the text: the rows of the table of a spectrum that is named there.
    tables: RefCell<HashMap<usize, Result<Vec<[f64; 2]>>>>,
    /// By place in the text: the numbers in the file that is named there.
    numbers: RefCell<HashMap<usize, Result<Vec<f64>>>>,
    /// By place in the text: what the file of a cube that is named there says of its time axis.
    times: RefCell<HashMap<usize, Result<Option<FileTimes>>>>,
}

impl Inputs {
    /// Nothing yet.
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

    /// The file named at `file` cannot be used.
    pub fn add_problem(&mut self, file: &At<String>, problem: String) {
        self.problems.insert(file.span.start, problem);
    }

    /// There is no file named at `file`, for this reason.
    pub fn add_missing(&mut self, file: &At<String>, problem: String) {
        self.missing.insert(file.span.start);
        self.add_problem(file, problem);
    }

    /// What the scene says to do about the file named at `file`, if it is not there.
    pub fn remedy(&self, file: &At<String>) -> Option<&str> {
        let said = self.if_missing.as_deref();
        said.filter(|_| self.missing.contains(&file.span.start))
    }

    /// The glTF camera in the file named at `file` has this pose, or cannot be read.
    pub fn add_pose(&mut self, file: &At<String>, pose: Result<Pose>) {
        self.note(file);
        self.poses.get_mut().insert(file.span.start, pose);
    }

    /// The node of the glTF file named at `file` goes this way, or cannot be read.
    pub fn add_track(&mut self, file: &At<String>, track: Result<GltfTrack>) {
        self.note(file);
        self.tracks.get_mut().insert(file.span.start, track);
    }

    /// The way of the node of the glTF file named at `file`, if that was read.
    pub fn track(&self, file: &At<String>) -> Option<Result<GltfTrack>> {
        let mut tracks = self.tracks.borrow_mut();
        match tracks.get(&file.span.start) {
            Some(Ok(track)) => Some(Ok(track.clone())),
            // As of poses.
            _ => tracks.remove(&file.span.start),
        }
    }

    /// The table of a spectrum in the file named at `file` has these rows, or cannot be read.
    pub fn add_table(&mut self, file: &At<String>, rows: Result<Vec<[f64; 2]>>) {
        self.note(file);
        self.tables.get_mut().insert(file.span.start, rows);
    }

    /// The cube in the file named at `file` has this time axis, or cannot be read.
    pub fn add_times(&mut self, file: &At<String>, times: Result<Option<FileTimes>>) {
        self.times.get_mut().insert(file.span.start, times);
    }

    /// The time axis of the cube in the file named at `file`, if that was looked for. Asked once.
    pub fn times(&self, file: &At<String>) -> Option<Result<Option<FileTimes>>> {
        self.times.borrow_mut().remove(&file.span.start)
    }

    /// The file named at `file` holds these numbers, or cannot be read.
    pub fn add_numbers(&mut self, file: &At<String>, numbers: Result<Vec<f64>>) {
        self.note(file);
        self.numbers.get_mut().insert(file.span.start, numbers);
    }

    /// The numbers in the file named at `file`, if that was read. Asked once.
    pub fn numbers(&self, file: &At<String>) -> Option<Result<Vec<f64>>> {
        self.numbers.borrow_mut().remove(&file.span.start)
    }

    /// The rows of the table in the file named at `file`, if that was read. Asked once.
    pub fn table(&self, file: &At<String>) -> Option<Result<Vec<[f64; 2]>>> {
        self.tables.borrow_mut().remove(&file.span.start)
    }

    /// Why the file named at `file` cannot be used, if it cannot.
    pub fn problem(&self, file: &At<String>) -> Option<&str> {
        self.problems.get(&file.span.start).map(String::as_str)
    }

    /// The pose of the glTF camera in the file named at `file`, if that was read.
    pub fn pose(&self, file: &At<String>) -> Option<Result<Pose>> {
        let mut poses = self.poses.borrow_mut();
        match poses.get(&file.span.start) {
            Some(Ok(pose)) => Some(Ok(pose.clone())),
            // Errors cannot be cloned; one ends the resolving.
            _ => poses.remove(&file.span.start),
        }
    }
}
