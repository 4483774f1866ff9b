//! The transient reference frames: cameras, ground truth, masks, and the accuracy that careful code reaches on them.

use std::path::PathBuf;

use super::arrays::array_at;

/// A reference frame.
#[derive(Debug, Clone)]
pub struct Frame {
    pub name: String,
    pub eye: [f64; 3],
    pub forward: [f64; 3],
    pub hfov: f64,
    pub beta: [f64; 3],
    pub time: f64,
    pub limit: Limit,
}

/// relRMSE of an independent numpy renderer with the same reconstruction.
#[derive(Debug, Clone, Copy)]
pub struct Limit {
    pub linear: f64,
    pub cubic: f64,
    pub means: f64,
    pub world_interior: f64,
    pub camera_interior: f64,
}

impl Frame {
    pub fn look_at(&self) -> [f64; 3] {
        std::array::from_fn(|i| self.eye[i] + self.forward[i])
    }
}

/// A file of the reference data.
pub fn data(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/transient")
        .join(name)
}

/// All instant frames.
pub fn frames() -> Vec<Frame> {
    let text = std::fs::read_to_string(data("frames.csv")).unwrap();
    text.lines().skip(1).map(frame).collect()
}

fn frame(line: &str) -> Frame {
    let (name, rest) = line.split_once(',').unwrap();
    let n: Vec<f64> = rest.split(',').map(|t| t.parse().unwrap()).collect();
    Frame {
        name: name.into(),
        eye: [n[0], n[1], n[2]],
        forward: [n[3], n[4], n[5]],
        hfov: n[6],
        beta: [n[7], n[8], n[9]],
        time: n[10],
        limit: Limit {
            linear: n[11],
            cubic: n[12],
            means: n[13],
            world_interior: n[14],
            camera_interior: n[15],
        },
    }
}

/// Reference radiance per pixel, row by row.
pub fn reference(name: &str) -> Vec<f64> {
    array("frames.npz", name)
}

/// A mask per pixel.
pub fn mask(name: &str) -> Vec<f64> {
    array("masks.npz", name)
}

fn array(file: &str, name: &str) -> Vec<f64> {
    array_at(&data(file), name)
}
