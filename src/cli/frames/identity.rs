//! What makes the files of a frame those of this frame, as one number.
//!
//! fingerprint = SHA-256 (common, kind[, isochrone step]), with common = SHA-256 (version, scene text with
//! the frame's time, poses read from other files, channels, sampling, method, content of every input file); each
//! part is preceded by its length.

use std::io::Read;
use std::path::{Path, PathBuf};

use nullray::figures::overlay;
use nullray::io::files;
use nullray::render::plan::Request;
use nullray::scene::model::{Mapping, Scene, SourceKind};
use sha2::{Digest, Sha256};

use crate::cli::output::{Kind, Outputs};

/// The content of all input files.
pub struct Inputs(Vec<u8>);

impl Inputs {
    /// Reads the files. One that cannot be read counts as none: whether it is needed turns out later.
    pub fn read(paths: &[PathBuf]) -> Inputs {
        let mut all = Parts::default();
        for path in paths {
            match content(path) {
                Some(hash) => all.add(&hash),
                None => all.add(b"none"),
            }
        }
        Inputs(all.finish())
    }
}

fn content(path: &Path) -> Option<Vec<u8>> {
    let (mut reader, _) = files::open(path).ok()?;
    let mut hash = Sha256::new();
    let mut block = vec![0; 1 << 16];
    loop {
        match reader.read(&mut block).ok()? {
            0 => return Some(hash.finalize().to_vec()),
            n => hash.update(block.get(..n)?),
        }
    }
}

/// Tells the files of a frame from all others.
#[derive(Debug, Clone)]
pub struct Identity {
    common: Vec<u8>,
    step: Option<f64>,
}

impl Identity {
    /// The key of the fingerprint in the metadata of files.
    pub const KEY: &'static str = "frame_fingerprint";

    /// The identity of the frame that `scene` shows.
    pub fn new(scene: &Scene, request: &Request, outputs: &Outputs, inputs: &Inputs) -> Identity {
        let mut parts = Parts::default();
        parts.add(env!("CARGO_PKG_VERSION").as_bytes());
        parts.add(scene.text.as_bytes());
        parts.add(poses(scene).as_bytes());
        for aov in &outputs.aovs {
            parts.add(aov.name().as_bytes());
        }
        parts.add(&[u8::from(request.pixel_centers)]);
        parts.add(outputs.method.to_string().as_bytes());
        parts.add(request.precision.name().as_bytes());
        parts.add(&inputs.0);
        Identity {
            common: parts.finish(),
            step: outputs.step,
        }
    }

    /// The fingerprint of the frame's file of this kind, as text.
    pub fn fingerprint(&self, kind: Kind) -> String {
        let step = self.step.filter(|_| kind == Kind::Isochrones);
        self.number(kind.word(), step)
    }

    /// The fingerprint of the frame's picture with these lines over it, as text.
    pub fn of_overlay(&self, parts: overlay::Parts) -> String {
        self.number(&format!("overlay {parts:?}"), self.step)
    }

    fn number(&self, what: &str, step: Option<f64>) -> String {
        let mut parts = Parts::default();
        parts.add(&self.common);
        parts.add(what.as_bytes());
        if let Some(step) = step {
            parts.add(&step.to_le_bytes());
        }
        let bytes = parts.finish();
        bytes.iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// Cameras, whose poses may come from files that are not inputs otherwise.
fn poses(scene: &Scene) -> String {
    let captures = scene
        .sources
        .iter()
        .filter_map(|source| match &source.kind {
            SourceKind::Cube(cube) => match &cube.mapping {
                Mapping::Capture(camera) => Some(camera),
                Mapping::Uv { .. } => None,
            },
            SourceKind::Pulse(_) => None,
        });
    format!("{:?} {:?}", scene.camera, captures.collect::<Vec<_>>())
}

/// Hashes parts, so that no two lists of parts are the same to it.
#[derive(Default)]
struct Parts(Sha256);

impl Parts {
    fn add(&mut self, part: &[u8]) {
        self.0.update((part.len() as u64).to_le_bytes());
        self.0.update(part);
    }

    fn finish(self) -> Vec<u8> {
        self.0.finalize().to_vec()
    }
}
