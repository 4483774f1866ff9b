//! The meaning of valid scenes.

use std::f64::consts::PI;
use std::path::Path;

use glam::DVec3;
use nullray::scene::model::*;
use nullray::scene::{Overrides, load, parse};
use nullray::spacetime::{Quantity, Velocity};

use crate::scene_file::{Folder, VALID};

const C: f64 = 299_792_458.0;

fn shape_scene(camera: &str, rest: &str) -> Scene {
    let text = format!(
        "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n{camera}\n[[object]]\nname = 'thing'\n\
         shape = {{ box = {{ size = [1, 1, 1] }} }}\n{rest}\n"
    );
    parse(&text, "test", Path::new(""), &Overrides::default()).unwrap()
}

#[test]
fn every_part_of_a_scene_is_resolved() {
    let folder = Folder::with_files();
    let scene = folder.parse(VALID).unwrap();
    assert_eq!(scene.name, "scene.toml");
    assert_eq!(scene.text, VALID);
    assert_eq!(scene.medium_index, 1.5);
    assert_eq!(scene.camera.size, [64, 48]);
    assert_eq!(scene.camera.horizontal_fov, 40.0 * PI / 180.0);
    assert_eq!(scene.camera.time, 2e-9 * C);
    let names: Vec<&str> = scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["wheel", "floor", "ship"]);
    assert_eq!(
        scene.objects[0].geometry,
        Geometry::Gltf {
            path: folder.path().join("a.glb"),
            node: Some("Wheel".into())
        }
    );
    let moved = scene.objects[0].transform.transform_point3(DVec3::X);
    assert_eq!(moved, DVec3::new(3.0, 2.0, 3.0));
    assert_eq!(scene.objects[2].origin.ct, 3.0);
    assert_eq!(scene.objects[2].origin.x, DVec3::X);
    assert_eq!(&VALID[scene.objects[2].span.clone()], "\"ship\"");
    assert_eq!(scene.quantity, Quantity::Line { wavelength: 532e-9 });
    assert_eq!(scene.outside.before, Fill::Hold);
    assert_eq!(scene.outside.after, Fill::Mark([1.0, 0.0, 1.0]));
    assert_eq!(scene.outside.occluded, Fill::Black);
    assert_eq!(scene.exposure, Exposure::Percentile(98.0));
    assert_eq!(scene.samples_per_pixel, 16);
}

#[test]
fn sources_are_bound_by_name() {
    let scene = Folder::with_files().parse(VALID).unwrap();
    let [data, flash] = &scene.sources[..] else {
        panic!("{:?}", scene.sources);
    };
    let bound = Binding::Only {
        objects: vec![0],
        materials: vec!["rim".into()],
    };
    assert_eq!(data.binding, bound);
    let SourceKind::Cube(cube) = &data.kind else {
        panic!("{data:?}");
    };
    assert_eq!(cube.bins.width(), 0.05);
    assert_eq!(cube.clock, Clock::Capture);
    assert_eq!(cube.values, BinValues::PerBin);
    let Mapping::Capture(capture) = &cube.mapping else {
        panic!("{cube:?}");
    };
    assert_eq!(capture.axes, [DVec3::X, DVec3::Y, DVec3::NEG_Z]);
    let SourceKind::Pulse(pulse) = &flash.kind else {
        panic!("{flash:?}");
    };
    assert_eq!(pulse.sigma, 0.02);
    assert_eq!(pulse.intensity, [1.0; 3]);
    assert!(pulse.shadows);
    assert_eq!(flash.quantity, scene.quantity);
}

#[test]
fn all_ways_to_say_three_fifths_of_the_speed_of_light_agree() {
    for way in [
        "{ beta = [0.6, 0, 0] }",
        "{ beta = 0.6, direction = [7, 0, 0] }",
        "{ beta = -0.6, direction = [-1, 0, 0] }",
        "{ gamma = 1.25, direction = [1, 0, 0] }",
        "{ rapidity = [0.6931471805599453, 0, 0] }",
        "{ rapidity = 0.6931471805599453, direction = [0.1, 0, 0] }",
        "{ one_minus_beta = 0.4, direction = [1, 0, 0] }",
    ] {
        let scene = shape_scene(&format!("velocity = {way}"), "");
        let error = scene.camera.velocity.rapidity() - DVec3::X * 2f64.ln();
        assert!(error.length() < 3e-16, "{way}");
    }
}

#[test]
fn rest_needs_no_direction() {
    for way in ["{ beta = 0 }", "{ gamma = 1 }", "{ rapidity = 0 }"] {
        let scene = shape_scene(&format!("velocity = {way}"), "");
        assert_eq!(scene.camera.velocity, Velocity::REST, "{way}");
    }
}

#[test]
fn seconds_are_converted_with_the_scenes_own_speed_of_light() {
    let text = "speed_of_light = \"36 km/h\"\n[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n\
                time = \"3 s\"\nclock_zero = \"3 m\"\n[[object]]\nshape.sphere.radius = 1\n";
    let scene = parse(text, "test", Path::new(""), &Overrides::default()).unwrap();
    assert_eq!(scene.speed_of_light, 10.0);
    assert_eq!(scene.camera.time, 30.0);
    assert_eq!(scene.camera.origin.ct, 3.0);
}

#[test]
fn scale_rotation_and_translation_apply_in_this_order() {
    let transform = "transform = { translate = [10, 0, 0], scale = [2, 3, 4], \
                     rotate = { axis = [0, 0, 5], angle = \"90 deg\" } }";
    let scene = shape_scene("", transform);
    // (1, 1, 1) → (2, 3, 4) → a quarter turn about z: (−3, 2, 4) → (7, 2, 4).
    let point = scene.objects[0].transform.transform_point3(DVec3::ONE);
    assert_eq!(point, DVec3::new(7.0, 2.0, 4.0));
}

#[test]
fn bad_vertices_are_refused_unless_the_object_says_otherwise() {
    let folder = Folder::with_files();
    for (said, expected) in [
        ("", BadVertices::Refuse),
        ("bad_vertices = \"refuse\"\n", BadVertices::Refuse),
        ("bad_vertices = \"drop\"\n", BadVertices::Drop),
    ] {
        let text = VALID.replace("node = \"Wheel\"\n", said);
        let scene = folder.parse(&text).unwrap();
        assert_eq!(scene.objects[0].bad_vertices, expected, "{said}");
    }
}

#[test]
fn bad_textures_are_refused_unless_the_object_says_otherwise() {
    let folder = Folder::with_files();
    for (said, expected) in [
        ("", BadTextures::Refuse),
        ("bad_textures = \"drop\"\n", BadTextures::Drop),
    ] {
        let text = VALID.replace("node = \"Wheel\"\n", said);
        let scene = folder.parse(&text).unwrap();
        assert_eq!(scene.objects[0].bad_textures, expected, "{said}");
    }
}

#[test]
fn a_matrix_is_given_by_rows() {
    let scene = shape_scene(
        "",
        "transform = { matrix = [0, -3, 0, 10, 2, 0, 0, 0, 0, 0, 4, 0, 0, 0, 0, 1] }",
    );
    let point = scene.objects[0].transform.transform_point3(DVec3::ONE);
    assert_eq!(point, DVec3::new(7.0, 2.0, 4.0));
}

#[test]
fn one_answer_may_stand_for_all_outside_data() {
    for (said, expected) in [
        ("outside = \"hold\"", [Fill::Hold; 4]),
        ("outside = \"black\"", [Fill::Black; 4]),
        (
            "outside = { mark = [1, 0, 1] }",
            [Fill::Mark([1.0, 0.0, 1.0]); 4],
        ),
        (
            "outside = { mark = [1, 0, 1], after = \"hold\", occluded = \"black\" }",
            [
                Fill::Mark([1.0, 0.0, 1.0]),
                Fill::Hold,
                Fill::Mark([1.0, 0.0, 1.0]),
                Fill::Black,
            ],
        ),
    ] {
        let text = format!(
            "{said}\n[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n[[object]]\nshape.sphere.radius = 1\n"
        );
        let scene = parse(&text, "test", Path::new(""), &Overrides::default()).unwrap();
        let Outside {
            before,
            after,
            off_texture,
            occluded,
        } = scene.outside;
        assert_eq!([before, after, off_texture, occluded], expected, "{said}");
    }
}

#[test]
fn things_without_a_name_are_called_after_what_they_are() {
    let folder = Folder::with_files();
    let text = "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n\
                [[object]]\ngltf = 'a.glb'\n[[object]]\ngltf = 'a.glb'\n[[object]]\ngltf = 'a.glb'\nnode = 'N'\n\
                [[object]]\nshape.lattice = { cells = [1, 1, 1], spacing = 1, bar = 0.1 }\n\
                [[source]]\nobjects = ['a']\ncube = { file = 'a.npy', bin_width = '1 m' }\n\
                [[source]]\nobjects = ['a-2', 'lattice']\npulse = { position = [0, 0, 0], sigma = '1 m' }\n";
    let scene = folder.parse(text).unwrap();
    let names: Vec<&str> = scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["a", "a-2", "N", "lattice"]);
    let names: Vec<&str> = scene.sources.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["a", "pulse"]);
}

#[test]
fn co_moving_objects_of_one_origin_share_a_capture_camera() {
    let folder = Folder::with_files();
    let object = "[[object]]\nshape.sphere.radius = 1\nvelocity = { beta = [0.5, 0, 0] }\n";
    let text = format!(
        "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n{object}{object}[[source]]\n\
         cube = {{ file = 'a.npy', bin_width = '1 m', capture = {{ eye = [0, 0, 9], look_at = [0, 0, 0], hfov = '9 deg' }} }}\n"
    );
    assert_eq!(
        folder.parse(&text).unwrap().sources[0].binding,
        Binding::All
    );
}

#[test]
fn a_file_is_loaded_relative_to_its_own_folder() {
    let folder = Folder::with_files();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, VALID.replace('\n', "\r\n")).unwrap();
    let scene = load(&path, &Overrides::default()).unwrap();
    assert_eq!(scene.name, path.display().to_string());
    assert_eq!(scene.objects.len(), 3);
}

#[test]
fn the_reference_scene_says_the_defaults() {
    let reference = include_str!("../../../scenes/reference.toml");
    let minimal = "\
[camera]
eye = [0, 1.2, 6]
look_at = [0, 0.8, 0]
[[object]]
name = 'floor'
shape = { plane = { size = [12, 12] } }
[[object]]
shape = { sphere = { radius = 0.5 } }
transform = { translate = [0, 0.5, 0] }
[[source]]
objects = ['floor', 'sphere']
pulse = { position = [2, 3, 1], sigma = '5 cm' }
";
    let parse = |text: &str| parse(text, "test", Path::new(""), &Overrides::default()).unwrap();
    let (said, left_out) = (parse(reference), parse(minimal));
    assert_eq!(said.camera, left_out.camera);
    let settings = |s: &Scene| {
        let (a, b, c, d, e) = (
            s.speed_of_light,
            s.medium_index,
            s.quantity,
            s.effects,
            s.outside,
        );
        let (f, g, h, i) = (s.back_faces, s.background, s.exposure, s.samples_per_pixel);
        format!("{:?}", (a, b, c, d, e, f, g, h, i))
    };
    assert_eq!(settings(&said), settings(&left_out));
    let object = |o: &Object| format!("{:?}", (&o.geometry, o.transform, o.velocity, o.origin));
    assert_eq!(object(&said.objects[0]), object(&left_out.objects[0]));
    assert_eq!(object(&said.objects[1]), object(&left_out.objects[1]));
    let source = |s: &Scene| format!("{:?}", (&s.sources[0].kind, &s.sources[0].binding));
    assert_eq!(source(&said), source(&left_out));
}

/// The bins of a cube whose time axis is given by `keys`, with a table of 0, 1, 3 and 4 in edges.npy.
fn bins(keys: &str) -> Result<TimeBins, String> {
    let folder = Folder::with_files();
    let header = "{'descr': '<i4', 'fortran_order': False, 'shape': (4,), }";
    let mut table = b"\x93NUMPY\x01\x00".to_vec();
    table.extend((header.len() as u16 + 1).to_le_bytes());
    table.extend(format!("{header}\n").bytes());
    table.extend([0i32, 1, 3, 4].into_iter().flat_map(i32::to_le_bytes));
    std::fs::write(folder.path().join("edges.npy"), &table).unwrap();
    let text = VALID.replacen("bin_width = \"5 cm\"", keys, 1);
    let scene = folder.parse(&text).map_err(|error| error.to_string())?;
    match &scene.sources[0].kind {
        SourceKind::Cube(cube) => Ok(cube.bins.clone()),
        other => panic!("{other:?}"),
    }
}

#[test]
fn edges_of_bins_are_listed_or_come_from_a_file() {
    // Light goes 0.299792458 mm in a picosecond.
    let listed = bins("edges = [\"0 m\", \"1 mm\", \"0.25 m\", \"1 s\"]").unwrap();
    let expected = [0.0, 0.001, 0.25, 299_792_458.0];
    assert_eq!(listed, TimeBins::Edges(expected.into()));
    let TimeBins::Edges(edges) =
        bins("edges_file = { file = \"edges.npy\", unit = \"1 ps\" }").unwrap()
    else {
        panic!("no edges");
    };
    let expected = [0.0, 1.0, 3.0, 4.0].map(|n| n * 0.299792458e-3);
    assert!(
        edges
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() < 1e-18)
    );
    for (keys, wrong) in [
        ("edges = [\"0 m\"]", "too few"),
        ("edges = [\"0 m\", \"1 m\", \"1 m\"]", "not after"),
        ("edges = [\"0 m\", \"1 m\"], start = \"1 m\"", "given twice"),
        (
            "edges = [\"0 m\", \"1 m\"], bin_width = \"1 m\"",
            "given twice",
        ),
        (
            "edges_file = { file = \"edges.npy\", unit = \"1 m\" }, first_center = \"1 m\"",
            "given twice",
        ),
        (
            "edges_file = { file = \"no.npy\", unit = \"1 m\" }",
            "cannot find",
        ),
        (
            "edges_file = { file = \"edges.npy\", unit = \"0 m\" }",
            "above 0",
        ),
    ] {
        let error = bins(keys).unwrap_err();
        assert!(error.contains(wrong), "{keys}: {error}");
    }
}
