//! What cannot be baked is refused with the reason.

use std::sync::Arc;

use nullray::io::cube::{Cube, CubeSamples};
use nullray::mesh::{Shape, shapes};
use nullray::render::bake::{self, Bins, Coordinates, CubePrecision, Surface};
use nullray::scene::model::Geometry;

use super::{CORNER, camera_cube, cube_of, prepared, surface_cube};
use crate::pipeline::files::{self, Quad};
use crate::pipeline::stage;

#[test]
fn bins_that_hold_no_time_or_no_memory_holds_are_refused() {
    let scene = stage::scene(CORNER);
    let good = Bins {
        start: 0.0,
        width: 1.0,
        count: 2,
    };
    for (bins, part) in [
        (Bins { count: 0, ..good }, "no bin"),
        (
            Bins {
                count: 1 << 50,
                ..good
            },
            "no memory",
        ),
        (
            Bins {
                count: usize::MAX,
                ..good
            },
            "no memory",
        ),
        (Bins { width: 0.0, ..good }, "hold no light"),
        (
            Bins {
                width: f64::NAN,
                ..good
            },
            "hold no light",
        ),
        (
            Bins {
                start: f64::INFINITY,
                ..good
            },
            "hold no light",
        ),
    ] {
        for baked in [
            camera_cube(&scene, &bins),
            surface_cube(&scene, 0, [4, 4], &bins),
        ] {
            let said = baked.unwrap_err().to_string();
            assert!(said.contains(part), "{bins:?}: {said}");
        }
    }
}

#[test]
fn scenes_that_cannot_be_baked_are_refused_with_a_message() {
    let bins = Bins {
        start: 0.0,
        width: 0.1,
        count: 4,
    };
    let plane = "[[object]]\nname = \"floor\"\nshape = { plane = { size = [1, 1] } }\n";
    let flash = "[[light]]\nposition = [0, 1, 0]\nemission = { gaussian = { sigma = \"5 cm\" } }\n";
    let refused = |more: &str| {
        let scene = stage::scene(&format!(
            "camera = {{ eye = [0, 1, 5], look_at = [0, 0, 0], size = [4, 4] }}\n{more}"
        ));
        let size = [8, 8];
        let surface = surface_cube(&scene, 0, size, &bins);
        surface
            .and(camera_cube(&scene, &bins))
            .unwrap_err()
            .to_string()
    };
    let moving =
        "[[object]]\nshape = { plane = { size = [1, 1] } }\nvelocity = { beta = [0.5, 0, 0] }\n";
    let cases = [
        (
            format!("{plane}{moving}{flash}"),
            "moves relative to \"floor\"",
        ),
        (format!("{moving}{flash}"), "moves relative to"),
        (plane.into(), "no light to bake"),
        (
            format!("{plane}[[light]]\nposition = [0, 1, 0]\n"),
            "never stops shining",
        ),
        (format!("{plane}{flash}[sky]\n"), "lights surfaces steadily"),
        (
            format!("[[object]]\nshape = {{ box = {{ size = [1, 1, 1] }} }}\n{flash}"),
            "charts overlap",
        ),
        (
            format!("{plane}[[light]]\ntype = \"area\"\nobject = \"floor\"\n"),
            "never stops shining",
        ),
    ];
    for (scene, words) in cases {
        let error = refused(&scene);
        assert!(error.contains(words), "{words}: {error}");
    }
}

#[test]
fn objects_that_are_not_there_and_textures_without_texels_are_refused() {
    let scene = stage::scene(
        "camera = { eye = [0, 1, 5], look_at = [0, 0, 0], size = [4, 4] }\n\
         [[object]]\nshape = { plane = { size = [1, 1] } }\n\
         [[light]]\nposition = [0, 1, 0]\nemission = { gaussian = { sigma = \"5 cm\" } }\n",
    );
    let bins = Bins {
        start: 0.0,
        width: 0.1,
        count: 4,
    };
    let prepared = prepared(&scene);
    for (object, size, words) in [
        (1, [8, 8], "there is no object 1: the scene has 1"),
        (usize::MAX, [8, 8], "there is no object"),
        (0, [0, 8], "0 × 8 texels holds no light"),
        (0, [8, 0], "8 × 0 texels holds no light"),
    ] {
        for coordinates in [Coordinates::Set(0), Coordinates::Atlas] {
            let surface = Surface {
                object,
                coordinates,
                size,
            };
            let precision = CubePrecision::Single;
            let errors = [
                cube_of(&scene, &prepared, &surface, &bins).map(drop),
                bake::check_surface(&scene, &prepared, &surface, &bins, precision).map(drop),
            ];
            for error in errors {
                let said = error.unwrap_err().to_string();
                assert!(said.contains(words), "{said}");
            }
        }
    }
}

#[test]
fn objects_that_shine_for_ever_are_refused_by_name() {
    let bins = Bins {
        start: 0.0,
        width: 0.1,
        count: 4,
    };
    let folder = tempfile::tempdir().unwrap();
    let head = "[radiance]\nquantity = \"rgb\"\n[camera]\neye = [0, 1, 5]\nlook_at = [0, 0, 0]\nsize = [4, 4]\n\
         [[object]]\nname = \"floor\"\nshape = { plane = { size = [1, 1] } }\n";
    let flash = "[[light]]\nposition = [0, 1, 0]\nemission = { gaussian = { sigma = \"5 cm\" } }\n";
    let pulse =
        "[[source]]\nobjects = [\"floor\"]\npulse = { position = [0, 1, 0], sigma = \"5 cm\" }\n";
    let ends = "[[light]]\ntype = \"area\"\nobject = \"glow\"\nemission = { gaussian = { sigma = \"5 cm\" } }\n";
    let shape = "shape = { plane = { size = [1, 1] } }\n";
    let hot = format!("{shape}spectrum = {{ blackbody = \"3000 K\" }}\n");
    let black = format!("{shape}colour = [0, 0, 0]\n");
    let model = "gltf = \"glow.glb\"\n";
    let ending = format!("{flash}{ends}");
    for (glow, emissive, light, refused) in [
        (hot.as_str(), "[0, 0, 0]", flash, true),
        (model, "[1, 0.5, 0]", flash, true),
        // Of light with an end nothing is lost.
        (model, "[1, 0.5, 0]", &ending, false),
        (&hot, "[0, 0, 0]", &ending, false),
        (model, "[0, 0, 0]", flash, false),
        // A base colour that no light falls on is radiance.
        (shape, "[0, 0, 0]", pulse, true),
        (&black, "[0, 0, 0]", pulse, false),
    ] {
        let material = format!("{{ \"emissiveFactor\": {emissive} }}");
        let quad = Quad {
            material: Some(&material),
            ..Quad::PLAIN
        };
        files::glb(&folder.path().join("glow.glb"), &quad);
        let text = format!("{head}[[object]]\nname = \"glow\"\n{glow}{light}");
        let scene = stage::scene_in(folder.path(), &text);
        let results = [
            surface_cube(&scene, 0, [8, 8], &bins).err(),
            camera_cube(&scene, &bins).err(),
        ];
        for error in results {
            assert_eq!(error.is_some(), refused, "{text}: {error:?}");
            let Some(error) = error else { continue };
            let said = error.to_string();
            let words = "object \"glow\": it never stops shining";
            assert!(said.contains(words), "{said}");
            assert!(error.help().contains("type = \"area\""), "{text}");
        }
    }
}

#[test]
fn light_of_cubes_is_refused_where_it_would_be_left_out() {
    let bins = Bins {
        start: 0.0,
        width: 0.1,
        count: 4,
    };
    let folder = tempfile::tempdir().unwrap();
    let cube = Cube::new([1, 1, 1, 1], CubeSamples::F32(vec![1.0])).unwrap();
    nullray::io::image::npz::write_cube(&folder.path().join("a.npy"), &cube).unwrap();
    // With bounces the wall lights the floor; without, it is only black in what a camera sees.
    for (bounces, is_refused) in [(0, false), (1, true)] {
        let text = format!(
            "camera = {{ eye = [0, 1, 5], look_at = [0, 0, 0], size = [4, 4] }}\nrender = {{ bounces = {bounces} }}\n\
             [[object]]\nname = \"floor\"\nshape = {{ plane = {{ size = [1, 1] }} }}\n\
             [[object]]\nname = \"wall\"\nshape = {{ plane = {{ size = [1, 1] }} }}\ntransform = {{ translate = [0, 1, 0] }}\n\
             [[light]]\nposition = [0, 0.5, 0]\nemission = {{ gaussian = {{ sigma = \"5 cm\" }} }}\n\
             [[source]]\nname = \"shown\"\nobjects = [\"wall\"]\ncube = {{ file = \"a.npy\", bin_width = \"1 m\", uv = 0 }}\n"
        );
        let scene = stage::scene_in(folder.path(), &text);
        let surface = surface_cube(&scene, 0, [4, 4], &bins).err();
        assert_eq!(surface.is_some(), is_refused, "{surface:?}");
        let camera = camera_cube(&scene, &bins).err();
        assert!(camera.is_some());
        for error in surface.into_iter().chain(camera) {
            let said = error.to_string();
            assert!(
                said.contains("source \"shown\"") && said.contains("\"wall\" shows its light"),
                "{said}"
            );
        }
    }
}

#[test]
fn a_moving_camera_without_aberration_is_not_baked() {
    let bins = Bins {
        start: 0.0,
        width: 0.1,
        count: 4,
    };
    for (aberration, beta, is_refused) in
        [(false, 0.6, true), (false, 0.0, false), (true, 0.6, false)]
    {
        let velocity = format!("velocity = {{ beta = [{beta:?}, 0, 0] }}");
        let scene = stage::scene(&format!(
            "effects = {{ aberration = {aberration} }}\n[camera]\neye = [0, 1, 5]\nlook_at = [0, 0, 0]\nsize = [4, 4]\n{velocity}\n\
             [[object]]\nname = \"floor\"\nshape = {{ plane = {{ size = [1, 1] }} }}\n{velocity}\n\
             [[light]]\nposition = [0, 1, 0]\nemission = {{ gaussian = {{ sigma = \"5 cm\" }} }}\n{velocity}\n"
        ));
        let error = camera_cube(&scene, &bins).err().map(|e| e.to_string());
        assert_eq!(error.is_some(), is_refused, "{error:?}");
        assert!(error.is_none_or(|said| said.contains("effects.aberration")));
        // Light on surfaces depends on no camera.
        assert!(surface_cube(&scene, 0, [4, 4], &bins).is_ok());
    }
}

#[test]
fn texture_coordinates_without_an_area_are_refused() {
    let mut scene = stage::scene(
        "camera = { eye = [0, 1, 5], look_at = [0, 0, 0], size = [4, 4] }\n\
         [[object]]\nname = \"floor\"\nshape = { plane = { size = [1, 1] } }\n\
         [[light]]\nposition = [0, 1, 0]\nemission = { gaussian = { sigma = \"5 cm\" } }\n",
    );
    let bins = Bins {
        start: 0.0,
        width: 0.1,
        count: 4,
    };
    let size = [1.0; 2];
    let mut mesh = shapes::mesh(Shape::Plane { size }, [0.5; 3]);
    scene.objects[0].geometry = Geometry::Mesh(Arc::new(mesh.clone()));
    assert!(surface_cube(&scene, 0, [8, 8], &bins).is_ok());
    // Of one of its two triangles, two corners at one place.
    let uvs = mesh.uvs[0].clone();
    let [a, b, c] = mesh.triangles[1].map(|v| v as usize);
    let alone = [a, b, c]
        .into_iter()
        .find(|v| !mesh.triangles[0].contains(&(*v as u32)));
    let other = if alone == Some(a) { b } else { a };
    mesh.uvs[0][alone.unwrap()] = uvs[other];
    scene.objects[0].geometry = Geometry::Mesh(Arc::new(mesh.clone()));
    let error = surface_cube(&scene, 0, [8, 8], &bins).unwrap_err();
    let said = error.to_string();
    for words in ["\"floor\"", "1 of its 2 triangles", "without an area"] {
        assert!(said.contains(words), "{said}");
    }
    assert!(
        error.help().contains("`Coordinates::Atlas`"),
        "{}",
        error.help()
    );
    mesh.uvs[0].fill([0.5; 2]);
    scene.objects[0].geometry = Geometry::Mesh(Arc::new(mesh));
    let error = surface_cube(&scene, 0, [8, 8], &bins)
        .unwrap_err()
        .to_string();
    for words in ["\"floor\"", "texture coordinates have no area"] {
        assert!(error.contains(words), "{error}");
    }
}
