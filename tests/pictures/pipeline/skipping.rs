//! Data that a plan skips are not loaded: broken data that nothing needs do no harm, and are reported if something needs them.

use std::path::Path;

use nullray::accel::{Precision, Preset};
use nullray::camera::ViewKind;
use nullray::render;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::scene::model::{Binding, Scene};
use tempfile::TempDir;

use crate::pipeline::files::{self, Quad};
use crate::pipeline::stage;

/// A PNG's first bytes, and then nothing of one.
const CORRUPT: &[u8] = b"\x89PNG\r\n\x1a\nthis is no picture";

const CAMERA: &str = "
[camera]
eye = [0, 0, 3]
look_at = [0, 0, 0]
size = [8, 8]
[display]
samples_per_pixel = 1
[[object]]
name = \"quad\"
gltf = \"quad.glb\"
";

const CUBE: &str = "
[[source]]
name = \"light\"
cube = { file = \"cube.npy\", bin_width = \"100 m\", start = \"-50 m\", values = \"density\", filter = \"nearest\" }
";

const PULSE: &str = "
[[source]]
name = \"flash\"
pulse = { position = [0, 0, 2], sigma = \"10 m\" }
";

/// A folder with quad.glb and cube.npy (all 7).
fn folder(quad: &Quad) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    files::glb(&folder.path().join("quad.glb"), quad);
    files::npy(&folder.path().join("cube.npy"), &[2, 2, 1], [7.0; 4]);
    folder
}

fn scene(folder: &Path, sources: &str) -> Scene {
    stage::scene_in(folder, &format!("{CAMERA}{sources}"))
}

fn plan(scene: &Scene) -> Plan {
    Plan::new(scene, &Request::default()).unwrap()
}

fn skips(plan: &Plan, what: &str) -> bool {
    plan.skipped.iter().any(|s| s.what.contains(what))
}

/// Radiance of the middle, or what is wrong.
fn middle(scene: &Scene) -> Result<[f64; 3], String> {
    let film = stage::rendered(scene, &Request::default());
    film.map(|f| f.radiance()[36]).map_err(|e| e.to_string())
}

#[test]
fn a_texture_is_not_decoded_where_a_cube_takes_its_place() {
    let folder = folder(&Quad {
        image: Some(CORRUPT),
        ..Quad::PLAIN
    });
    let lit = scene(folder.path(), CUBE);
    assert!(skips(&plan(&lit), "base colour textures") && !plan(&lit).objects[0].textures);
    assert_eq!(middle(&lit), Ok([7.0; 3]));
    for needing in ["", PULSE] {
        let scene = scene(folder.path(), needing);
        assert!(plan(&scene).objects[0].textures);
        let error = middle(&scene).unwrap_err();
        assert!(
            error.contains("quad.glb") && error.contains("image 0"),
            "{error}"
        );
    }
}

#[test]
fn texture_coordinates_are_not_read_where_nothing_is_addressed_by_them() {
    let folder = folder(&Quad {
        nan_uvs: true,
        ..Quad::PLAIN
    });
    for (sources, radiance) in [("", Some([0.5, 0.25, 0.125])), (PULSE, None)] {
        let scene = scene(folder.path(), sources);
        assert!(skips(&plan(&scene), "texture coordinates") && !plan(&scene).objects[0].uvs);
        let middle = middle(&scene).unwrap();
        assert!(radiance.is_none_or(|r| r == middle), "{middle:?}");
    }
    let needing = scene(folder.path(), CUBE);
    assert!(plan(&needing).objects[0].uvs);
    let error = middle(&needing).unwrap_err();
    assert!(error.contains("texture coordinates"), "{error}");
    // Nor may a channel show them.
    assert!(stage::rendered(&scene(folder.path(), ""), &stage::centred()).is_err());
}

#[test]
fn a_cube_that_lights_nothing_is_not_loaded() {
    let folder = folder(&Quad::PLAIN);
    let path = folder.path().join("cube.npy");
    let mut scene = scene(folder.path(), CUBE);
    std::fs::write(&path, b"\x93NUMPY and then nothing").unwrap();
    assert!(Plan::new(&scene, &Request::default()).is_err());
    scene.sources[0].binding = Binding::Only {
        objects: vec![],
        materials: vec![],
    };
    assert!(skips(&plan(&scene), "cube of source \"light\""));
    assert_eq!(plan(&scene).cubes.iter().flatten().count(), 0);
    assert_eq!(middle(&scene), Ok([0.5, 0.25, 0.125]));
}

#[test]
fn a_cube_with_broken_data_is_named() {
    let folder = folder(&Quad::PLAIN);
    let path = folder.path().join("cube.npy");
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&path, &whole[..whole.len() - 5]).unwrap();
    let error = middle(&scene(folder.path(), CUBE)).unwrap_err();
    assert!(error.contains("cube.npy"), "{error}");
}

#[test]
fn a_material_that_no_object_has_is_refused_with_those_that_there_are() {
    let folder = folder(&Quad::PLAIN);
    let named = CUBE.replace(
        "cube = ",
        "objects = [\"quad\"]\nmaterials = [\"pain\"]\ncube = ",
    );
    let error = Plan::new(&scene(folder.path(), &named), &Request::default()).unwrap_err();
    let help = error.help();
    assert!(
        error.to_string().contains("\"pain\"") && help.contains("paint"),
        "{error}: {help}"
    );
}

#[test]
fn a_scene_at_rest_without_sources_has_no_boosts_no_time_and_no_channels() {
    let folder = folder(&Quad::PLAIN);
    let scene = scene(folder.path(), "");
    let plan = plan(&scene);
    for what in [
        "boost of look directions",
        "boosts into rest frames",
        "loop over rest frames",
        "time axis",
        "capture camera",
        "shadow rays",
        "auxiliary channels",
        "texture coordinates",
    ] {
        assert!(skips(&plan, what), "{what}");
    }
    let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    assert_eq!(
        (plan.view, prepared.camera.view.kind()),
        (ViewKind::Still, ViewKind::Still)
    );
    assert!(prepared.cubes().is_empty() && prepared.radiance().even().is_some());
    assert!(prepared.layout.channels.is_empty() && !prepared.layout.has_gaps);
    assert!(
        prepared.frames[0]
            .meshes
            .iter()
            .all(|m| m.uvs.is_empty() && m.triangles.is_empty())
    );
}

#[test]
fn a_plan_lists_what_is_prepared() {
    let folder = folder(&Quad::PLAIN);
    let moving = "
[[object]]
name = \"ball\"
shape = { sphere = { radius = 0.3, subdivisions = 3 } }
velocity = { beta = [0.5, 0, 0] }
[[object]]
name = \"crate\"
shape = { box = { size = [0.3, 0.3, 0.3] } }
";
    let bound = CUBE.replace("cube = ", "objects = [\"quad\"]\ncube = ");
    let scene = scene(folder.path(), &format!("{moving}{bound}"));
    let plan = plan(&scene);
    let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    let triangles: Vec<u64> = plan.frames.iter().map(|f| f.triangles).collect();
    assert_eq!(triangles, [14, 1280]);
    let built: Vec<u64> = prepared.frames.iter().map(|f| f.bvh.len() as u64).collect();
    assert_eq!(built, triangles);
    assert!(prepared.radiance().even().is_none());
    let cubes = prepared.cubes();
    assert_eq!(cubes.len(), plan.cubes.iter().flatten().count());
    let bytes: usize = cubes
        .iter()
        .map(|c| c.cube().shape().iter().product::<usize>() * 8)
        .sum();
    assert_eq!(bytes as u64, plan.memory.cubes);
    assert_eq!(plan.rays.capture, 0);
    for (frame, planned) in prepared.frames.iter().zip(&plan.frames) {
        for (mesh, object) in frame.meshes.iter().zip(&planned.objects) {
            assert_eq!(!mesh.uvs.is_empty(), plan.objects[*object].uvs);
        }
    }
}

/// 64 rays of one picture on 1,282 triangles are worth no more than a quick tree. What is seen is the same through all.
#[test]
fn trees_are_built_for_the_rays_of_all_pictures() {
    let folder = folder(&Quad::PLAIN);
    let ball = "
[[object]]
name = \"ball\"
shape = { sphere = { radius = 0.3, subdivisions = 3 } }
";
    let lit = "
[render]
bounces = 3
[[light]]
name = \"lamp\"
position = [0, 2, 2]
intensity = 1
";
    let dark = scene(folder.path(), ball);
    let lit = scene(folder.path(), &format!("{ball}{lit}"));
    let trees = |scene: &Scene, pictures, precision| {
        let request = Request {
            pictures,
            precision,
            ..Request::default()
        };
        Plan::new(scene, &request).unwrap().trees
    };
    for (pictures, of_dark, of_lit) in [
        (1, Preset::Quick, Preset::Quick),
        // 150 camera rays and as many of each bounce per triangle.
        (3_000, Preset::Quick, Preset::Thorough),
        (25_000, Preset::Balanced, Preset::Thorough),
        (u64::MAX, Preset::Thorough, Preset::Thorough),
    ] {
        assert_eq!(trees(&dark, pictures, Precision::Certified), of_dark);
        assert_eq!(trees(&lit, pictures, Precision::Certified), of_lit);
        // In f32 rays along edges may depend on the tree.
        assert_eq!(trees(&dark, pictures, Precision::Fast), Preset::Balanced);
    }
    let film = |trees| {
        let mut plan = plan(&lit);
        plan.trees = trees;
        let prepared = Prepared::new(&lit, &plan, &Silent).unwrap();
        let film = render::render(&prepared, &Silent).unwrap();
        film.radiance().to_vec()
    };
    let [quick, balanced, thorough] = Preset::ALL.map(film);
    assert!(quick == balanced && balanced == thorough);
    assert!(quick.iter().any(|pixel| pixel[0] > 0.0));
}
