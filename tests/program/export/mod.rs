//! Exported scenes, as read by other programs.

mod apparent;
mod contents;
mod lamps;
mod reader;
mod single;
mod snippets;
mod targets;

use std::path::{Path, PathBuf};

use nullray::render::progress::Silent;
use nullray::scene::model::Scene;
use nullray::scene::{self, Overrides};
use nullray::validate::export::{ExportOptions, export};
use tempfile::TempDir;

/// An export in a directory of its own.
struct Exported {
    folder: TempDir,
    bundle: reader::Bundle,
}

impl Exported {
    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join("bundle").join(name)
    }
}

fn exported(text: &str) -> Exported {
    exported_with(text, Path::new("."), &ExportOptions::default())
}

fn exported_with(text: &str, base: &Path, options: &ExportOptions) -> Exported {
    let scene = scene::parse(text, "test", base, &Overrides::default()).unwrap();
    exported_scene(&scene, options)
}

fn exported_scene(scene: &Scene, options: &ExportOptions) -> Exported {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("bundle");
    export(scene, &target, options, &Silent).unwrap();
    Exported {
        bundle: reader::Bundle::read(&target),
        folder,
    }
}
