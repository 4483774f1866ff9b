//! glTF files refer to other files. The author of a file must not choose which other files of this machine are read and shown.

use std::path::{Path, PathBuf};

use super::planned::PlannedObject;
use crate::error::{Error, Result};
use crate::io::gltf::outside_help;
use crate::scene::model::Scene;

/// Refuses glTF files that refer, by `..` or by links, to anything outside their own folder and the scene's.
pub(super) fn check(scene: &Scene, objects: &[PlannedObject]) -> Result<()> {
    let Some(folder) = &scene.folder else {
        return Ok(());
    };
    for object in objects {
        let Some(file) = &object.file else { continue };
        // Its own folder, even if the scene names it by a link.
        let real = file.canonicalize().unwrap_or_else(|_| file.clone());
        let roots = [Some(folder.as_path()), file.parent(), real.parent()];
        let roots: Vec<PathBuf> = roots.into_iter().flatten().filter_map(folder_at).collect();
        for other in &object.files {
            // A missing file is reported when it is read.
            let Ok(real) = other.canonicalize() else {
                continue;
            };
            if !roots.iter().any(|root| real.starts_with(root)) {
                return Err(outside(file, other, &real));
            }
        }
    }
    Ok(())
}

/// A folder with links resolved; an empty name is the current one.
fn folder_at(path: &Path) -> Option<PathBuf> {
    match path.as_os_str().is_empty() {
        true => Path::new(".").canonicalize().ok(),
        false => path.canonicalize().ok(),
    }
}

fn outside(file: &Path, other: &Path, real: &Path) -> Error {
    let what = format!(
        "it refers to {}, which is {}: outside its folder and the scene's",
        other.display(),
        real.display()
    );
    let help = outside_help();
    Error::invalid(file, "uri", what, help)
}
