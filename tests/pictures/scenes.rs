//! Every scene of the repository, and the one in README.md, renders to something lit and finite.

use std::path::{Path, PathBuf};

use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::model::Scene;
use nullray::scene::{self, Overrides};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn small() -> Overrides {
    Overrides {
        size: Some([48, 36]),
        samples_per_pixel: Some(4),
        ..Overrides::default()
    }
}

/// All scene files below `folder` that have a camera: those of `diagrams` have none.
fn scene_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path());
    let mut files: Vec<_> = entries
        .flat_map(|path| {
            // Light that is baked first has a test beside those of baking.
            if path.ends_with("diagrams") || path.ends_with("baked") {
                Vec::new()
            } else if path.is_dir() {
                scene_files(&path)
            } else {
                vec![path]
            }
        })
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
    files
}

/// Brightest channel of the picture of `scene`.
fn brightest(scene: &Scene) -> f64 {
    let plan = Plan::new(scene, &Request::default()).unwrap();
    let film = render(&Prepared::new(scene, &plan, &Silent).unwrap(), &Silent).unwrap();
    let values = film.radiance().iter().flatten();
    values.fold(0.0, |brightest, value| {
        assert!(value.is_finite(), "{}: {value}", scene.name);
        f64::max(brightest, *value)
    })
}

#[test]
fn every_scene_file_renders_to_a_lit_picture() {
    let files = scene_files(&root().join("scenes"));
    assert!(files.len() >= 18, "{files:?}");
    for file in files {
        let scene = scene::load(&file, &small()).unwrap_or_else(|e| panic!("{e}"));
        assert!(brightest(&scene) > 0.0, "{} is black", file.display());
    }
}

#[test]
fn the_scene_in_the_readme_is_a_scene() {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let (_, after) = readme.split_once("```toml\n").unwrap();
    let (text, _) = after.split_once("```").unwrap();
    let scene = scene::parse(text, "README.md", &root().join("scenes"), &small()).unwrap();
    assert!(brightest(&scene) > 0.0);
}

#[test]
fn the_camera_of_a_gltf_file_takes_the_picture_that_its_numbers_describe() {
    let rest = "[[object]]\ngltf = \"corner/corner.glb\"";
    let folder = root().join("scenes");
    let scene = |camera: &str| {
        let text = format!("[camera]\nsize = [64, 64]\n{camera}\n{rest}");
        scene::parse(&text, "camera", &folder, &Overrides::default()).unwrap()
    };
    let from_file = scene("gltf = \"corner/corner.glb\"\nnode = \"cam_A\"").camera;
    let numbers = "eye = [3.2, 3.0, 4.6]\nlook_at = [-0.4, 1.0, -0.6]\nhfov = \"45 deg\"";
    let said = scene(numbers).camera;
    // The file holds single precision.
    let near = |a: glam::DVec3, b: glam::DVec3| (a - b).length() < 1e-6;
    assert!(near(from_file.origin.x, said.origin.x), "{from_file:?}");
    for (a, b) in from_file.axes.into_iter().zip(said.axes) {
        assert!(near(a, b), "{a} {b}");
    }
    assert!((from_file.horizontal_fov - said.horizontal_fov).abs() < 1e-6);
}
