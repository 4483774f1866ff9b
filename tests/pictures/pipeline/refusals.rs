//! Input that cannot be rendered gives one clear error.

use std::path::Path;

use nullray::error::Error;
use nullray::render::plan::{Plan, Request};
use nullray::scene::model::Scene;
use nullray::scene::{self, Overrides};

use crate::pipeline::{files, stage};

const SPHERE: &str = "
[camera]
eye = [0, 0, 5]
look_at = [0, 0, 0]
size = [8, 8]
[[object]]
shape = { sphere = { radius = 1, subdivisions = 8 } }
";

fn with_cube(shape: &[usize], values: Vec<f64>) -> Result<[f64; 3], String> {
    let folder = tempfile::tempdir().unwrap();
    files::npy(&folder.path().join("cube.npy"), shape, values);
    let scene = stage::scene_in(
        folder.path(),
        "
[camera]
eye = [0, 3, 0]
look_at = [0, 0, 0]
up = [0, 0, 1]
size = [8, 8]
[[object]]
shape = { plane = { size = [9, 9] } }
[[source]]
cube = { file = \"cube.npy\", start = \"-50 m\", bin_width = \"100 m\", values = \"density\", filter = \"nearest\" }
",
    );
    let film = stage::rendered(&scene, &Request::default());
    film.map(|f| f.radiance()[27]).map_err(|e| e.to_string())
}

#[test]
fn a_cube_of_one_bin_is_a_cube() {
    assert_eq!(with_cube(&[1, 1, 1], vec![4.0]), Ok([4.0; 3]));
    assert_eq!(
        with_cube(&[1, 1, 1, 3], vec![1.0, 2.0, 3.0]),
        Ok([1.0, 2.0, 3.0])
    );
}

#[test]
fn files_that_are_not_cubes_are_refused_by_name() {
    for (shape, values) in [
        (vec![1, 1, 2], vec![1.0, f64::NAN]),
        (vec![1, 1, 2], vec![f64::INFINITY, 0.0]),
        (vec![1, 1, 1, 1, 1], vec![1.0]),
        (vec![4], vec![1.0; 4]),
        (vec![1, 1, 1, 2], vec![1.0; 2]),
        (vec![1, 0, 1], vec![]),
    ] {
        let error = with_cube(&shape, values).unwrap_err();
        let named = error.contains("cube.npy") || error.contains("source");
        assert!(named, "{shape:?}: {error}");
    }
}

fn refused(text: &str) -> String {
    let scene = scene::parse(text, "test scene", Path::new(""), &Overrides::default());
    scene.unwrap_err().to_string()
}

#[test]
fn an_empty_image_is_refused() {
    for size in ["[0, 8]", "[8, 0]", "[70000, 1]", "[65536, 65536]"] {
        let error = refused(&SPHERE.replace("[8, 8]", size));
        assert!(error.contains("camera.size"), "{error}");
    }
}

#[test]
fn impossible_fields_of_view_of_pinholes_are_refused() {
    for fov in ["0 deg", "180 deg", "-1 deg", "nan deg"] {
        let size = format!("size = [8, 8]\nhfov = \"{fov}\"");
        let error = refused(&SPHERE.replace("size = [8, 8]", &size));
        assert!(error.contains("hfov"), "{error}");
    }
}

#[test]
fn a_scene_beyond_the_memory_limit_names_the_option() {
    let scene = stage::scene(SPHERE);
    let request = Request {
        memory_limit: 1 << 20,
        ..Request::default()
    };
    let error = Plan::new(&scene, &request).unwrap_err();
    let help = error.help();
    assert!(
        error.to_string().contains("1.0 MiB") && help.contains("`memory_limit`"),
        "{error}"
    );
}

/// A scene of `count` spheres of 1,310,720 triangles each.
fn spheres(count: usize) -> Scene {
    let mut scene = stage::scene(SPHERE);
    scene.objects = vec![scene.objects[0].clone(); count];
    scene
}

#[test]
fn more_triangles_than_a_tree_can_hold_are_refused_before_any_is_made() {
    // 2³⁰/1,310,720 = 819.2
    let request = Request {
        memory_limit: u64::MAX,
        ..Request::default()
    };
    assert!(Plan::new(&spheres(819), &request).is_ok());
    let error = Plan::new(&spheres(820), &request).unwrap_err();
    assert!(matches!(error, Error::Unsupported(_)));
    assert!(
        error.to_string().contains("1074790400 triangles"),
        "{error}"
    );
}

#[test]
fn a_cube_on_texture_coordinates_that_the_mesh_lacks_is_refused_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    files::npy(&folder.path().join("cube.npy"), &[1, 1, 1], vec![1.0]);
    let scene = stage::scene_in(
        folder.path(),
        "
[camera]
eye = [0, 0, 5]
look_at = [0, 0, 0]
[[object]]
shape = { sphere = { radius = 1 } }
[[source]]
cube = { file = \"cube.npy\", bin_width = \"1 m\", uv = 1 }
",
    );
    let Err(Error::Invalid(problem)) = Plan::new(&scene, &Request::default()) else {
        panic!("not refused");
    };
    assert!(problem.what.contains("TEXCOORD_1"), "{problem}");
    assert!(problem.snippet.is_some(), "no label");
}

#[test]
fn textures_keep_within_the_memory_limit_and_are_decoded_once_for_all_objects() {
    // 512 × 512 RGB in memory, of which PNG needs next to nothing when it is all one colour.
    let texture = 3 * 512 * 512;
    let folder = tempfile::tempdir().unwrap();
    let png = folder.path().join("grey.png");
    nullray::io::image::png::write(&png, 512, 512, &vec![128; texture], &[]).unwrap();
    let image = std::fs::read(png).unwrap();
    let quad = files::Quad {
        image: Some(&image),
        ..files::Quad::PLAIN
    };
    files::glb(&folder.path().join("quad.glb"), &quad);
    let text = "
[camera]
eye = [0, 0, 5]
look_at = [0, 0, 0]
size = [8, 8]
[[object]]
gltf = \"quad.glb\"
[[object]]
gltf = \"quad.glb\"
";
    let scene = stage::scene_in(folder.path(), text);
    let planned = Plan::new(&scene, &Request::default())
        .unwrap()
        .memory
        .total();
    let within = |left: usize| {
        let memory_limit = planned + left as u64;
        stage::rendered(
            &scene,
            &Request {
                memory_limit,
                ..Request::default()
            },
        )
    };
    assert!(within(texture).is_ok(), "one texture for both objects");
    let error = within(texture - 1).unwrap_err();
    let help = error.help();
    assert!(
        error.to_string().contains("quad.glb") && help.contains("`memory_limit`"),
        "{error}"
    );
}
