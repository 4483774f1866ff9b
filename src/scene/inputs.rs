//! What a scene names outside its text, gathered before it is resolved: resolving opens nothing.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::PathBuf;

use glam::DVec3;

use super::at::At;
use super::memory::Memory;
use crate::error::Result;

/// Where a camera is and where it looks.
#[derive(Debug, Clone)]
pub(super) struct Pose {
    pub eye: DVec3,
    /// Orthonormal: right, up, forward.
    pub axes: [DVec3; 3],
    /// From a glTF camera: the horizontal field of view where it is known, and the vertical one.
    pub gltf_fov: Option<(Option<f64>, f64)>,
}

/// What was found of that which a scene names.
#[derive(Default)]
pub(super) struct Inputs {
    /// The folder against which relative paths resolve.
    pub base: PathBuf,
    /// Meshes and cubes in memory.
    pub memory: Memory,
    /// By place in the text: why the file that is named there cannot be used.
    problems: HashMap<usize, String>,
    /// By place in the text: the pose that the glTF camera named there has.
    poses: RefCell<HashMap<usize, Result<Pose>>>,
    /// By place in the text: the rows of the table of a spectrum that is named there.
    tables: RefCell<HashMap<usize, Result<Vec<[f64; 2]>>>>,
}

impl Inputs {
    /// Nothing yet.
    pub fn new(base: PathBuf, memory: Memory) -> Self {
        Inputs {
            base,
            memory,
            ..Inputs::default()
        }
    }

    /// The file named at `file` cannot be used.
    pub fn add_problem(&mut self, file: &At<String>, problem: String) {
        self.problems.insert(file.span.start, problem);
    }

    /// The glTF camera in the file named at `file` has this pose, or cannot be read.
    pub fn add_pose(&mut self, file: &At<String>, pose: Result<Pose>) {
        self.poses.get_mut().insert(file.span.start, pose);
    }

    /// The table of a spectrum in the file named at `file` has these rows, or cannot be read.
    pub fn add_table(&mut self, file: &At<String>, rows: Result<Vec<[f64; 2]>>) {
        self.tables.get_mut().insert(file.span.start, rows);
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
