//! The sources of a bundle: cubes are copied unchanged, or named with their SHA-256; those whose samples are mended when they are read
//! are written as they are then.

use std::collections::HashMap;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::bundle::{CubeEntry, LightEntry, SourceEntry};
use super::{Cubes, Files, describe, stop_if_cancelled};
use crate::error::{Error, Result};
use crate::io::cube::{self, Channels, Cube, Negative, format_of};
use crate::io::files;
use crate::io::image::{npz, write_atomically};
use crate::render::metadata::sha256_of;
use crate::render::plan::Plan;
use crate::render::progress::Progress;
use crate::scene::model::{CubeData, CubeFile, CubeSource, Scene, SourceKind, TimeBins};

/// Writes the files of the sources of `scene`, and describes them.
pub(super) fn write(
    scene: &Scene,
    plan: &Plan,
    cubes: Cubes,
    files: &mut Files,
    progress: &dyn Progress,
) -> Result<Vec<SourceEntry>> {
    let mut stored = Stored::default();
    let mut entries = Vec::with_capacity(scene.sources.len());
    for (index, source) in scene.sources.iter().enumerate() {
        stop_if_cancelled(progress)?;
        let light = match &source.kind {
            SourceKind::Pulse(pulse) => describe::pulse(pulse),
            SourceKind::Cube(cube) => {
                let place = match &cube.data {
                    CubeData::File(file) if is_raw(cube, file) => {
                        stored.place(&file.path, cubes, files)?
                    }
                    CubeData::File(file) => {
                        let wanted = cube.wanted(file);
                        let wanted = wanted.within(plan.memory_limit);
                        write_out(&cube::load(&file.path, wanted)?, index, files)?
                    }
                    CubeData::Memory(cube) => write_out(cube, index, files)?,
                };
                let shape = plan.cubes.get(index).and_then(Option::as_ref);
                LightEntry::Cube(Box::new(entry(cube, place, shape.map(|cube| cube.shape))))
            }
        };
        entries.push(SourceEntry {
            name: source.name.clone(),
            radiometry: describe::radiometry(scene, source.quantity),
            light,
        });
    }
    Ok(entries)
}

/// The bundle's description of a cube. A time axis has one width, or edges if widths differ.
fn entry(cube: &CubeSource, place: Place, shape: Option<[usize; 4]>) -> CubeEntry {
    let raw = match &cube.data {
        CubeData::File(file) if is_raw(cube, file) => Some(file),
        CubeData::File(_) | CubeData::Memory(_) => None,
    };
    CubeEntry {
        file: place.file,
        is_copied: place.is_copied,
        sha256: place.sha256,
        array: raw.and_then(|file| file.array.clone()),
        axes: raw.and_then(|file| file.axes.as_ref().map(|axes| axes.to_string())),
        shape,
        channels: cube.channels.as_ref().map(Channels::names),
        start: cube.bins.edge(0),
        bin_width: match &cube.bins {
            TimeBins::Uniform { width, .. } => Some(*width),
            TimeBins::Edges(_) => None,
        },
        bin_edges: match &cube.bins {
            TimeBins::Uniform { .. } => None,
            TimeBins::Edges(edges) => Some(edges.to_vec()),
        },
        values: cube.values,
        scale: cube.scale,
        filter: cube.filter,
        reconstruction: cube.reconstruction,
        clock: cube.clock,
        mapping: describe::mapping(&cube.mapping, shape.unwrap_or([1; 4])),
    }
}

/// Whether these are arrays whose samples are read as they are, which a bundle contains unchanged; everything else is converted to one.
fn is_raw(cube: &CubeSource, file: &CubeFile) -> bool {
    let is_numpy = cube::format_called(&file.path).is_some_and(|format| format.key == "numpy");
    is_numpy && file.dead_bins.is_empty() && cube.negative != Some(Negative::Zero)
}

/// The location of a cube's file.
#[derive(Debug, Clone)]
struct Place {
    file: String,
    is_copied: bool,
    sha256: String,
}

/// Files of cubes, each of which is read once.
#[derive(Debug, Default)]
struct Stored(HashMap<PathBuf, Place>);

impl Stored {
    fn place(&mut self, path: &Path, cubes: Cubes, files: &mut Files) -> Result<Place> {
        if let Some(place) = self.0.get(path) {
            return Ok(place.clone());
        }
        let place = match (cubes, path.canonicalize()) {
            (Cubes::Referenced, Ok(full)) => Place {
                file: full.display().to_string(),
                is_copied: false,
                sha256: sha256(path)?,
            },
            _ => copy(path, self.0.len(), files)?,
        };
        self.0.insert(path.to_path_buf(), place.clone());
        Ok(place)
    }
}

/// Writes the cube of source `index`, which no file holds as it is read.
fn write_out(cube: &Cube, index: usize, files: &mut Files) -> Result<Place> {
    files.folder.subfolder("sources")?;
    let name = format!("sources/memory-{index:03}.npy");
    files.written(&name, |target| npz::write_cube(target, cube))?;
    let sha256 = files.entries.last().map(|entry| entry.sha256.clone());
    Ok(Place {
        file: name,
        is_copied: true,
        sha256: sha256.unwrap_or_default(),
    })
}

/// Copies the file `path` as cube `number` of the bundle.
fn copy(path: &Path, number: usize, files: &mut Files) -> Result<Place> {
    files.folder.subfolder("sources")?;
    let failed = || Error::io(path, "cannot read");
    let (mut reader, _) = files::open(path).map_err(failed())?;
    let mut start = [0; 6];
    reader.read_exact(&mut start).map_err(failed())?;
    // By content, as the importer does.
    let extension = format_of(&start, path).map_or("", |format| format.extensions[0]);
    let name = format!("sources/{number:03}.{extension}");
    files.written(&name, |target| {
        write_atomically(target, |writer| {
            let mut whole = start.as_slice().chain(reader);
            io::copy(&mut whole, writer).map_err(Error::io(target, "cannot write"))?;
            Ok(())
        })
    })?;
    let sha256 = files.entries.last().map(|entry| entry.sha256.clone());
    Ok(Place {
        file: name,
        is_copied: true,
        sha256: sha256.unwrap_or_default(),
    })
}

fn sha256(path: &Path) -> Result<String> {
    let failed = || Error::io(path, "cannot read");
    let (mut reader, _) = files::open(path).map_err(failed())?;
    let (_, sha256) = sha256_of(&mut reader).map_err(failed())?;
    Ok(sha256)
}
