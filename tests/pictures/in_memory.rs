//! Scenes made in memory, without any file: the same pictures as those of files, bit for bit.

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use nullray::Error;
use nullray::io::cube::{self, Channels, Cube, CubeSamples, Wanted};
use nullray::io::gltf::{self, Want};

use nullray::mesh::{AlphaMode, Mesh, shapes};
use nullray::render::aov::{self, Aov};
use nullray::render::film::Film;
use nullray::render::metadata::metadata;
use nullray::render::plan::{Plan, Request};
use nullray::scene::model::{
    BadTextures, BadVertices, Beam, Brightness, CaptureCamera, Catalogue, CubeData,
    EmissionProfile, Geometry, Lamp, LightKind, Mapping, Motion, Pulse, Scene, Sky, SkyRadiance,
    SourceKind, Stars, Stereo,
};
use nullray::scene::{Builder, Value};
use nullray::spacetime::units::Time;
use nullray::spacetime::worldline::WorldLine;
use nullray::spacetime::{Event, Velocity};

use crate::pipeline::{files, stage};

/// Two films of the same numbers.
fn assert_same(a: &Film, b: &Film) {
    let bits = |film: &Film| {
        film.radiance_array()
            .1
            .iter()
            .map(|x| x.to_bits())
            .collect::<Vec<_>>()
    };
    assert_eq!(bits(a), bits(b));
    for aov in [Aov::EventCt, Aov::UvU, Aov::Primitive] {
        let bits = |film: &Film| stage_bits(film, aov);
        assert_eq!(bits(a), bits(b), "{aov:?}");
    }
    assert!(stage::met(a).len() > 30);
}

fn stage_bits(film: &Film, aov: Aov) -> Vec<u64> {
    film.aov(aov).unwrap().iter().map(|x| x.to_bits()).collect()
}

/// A camera at (0.5, 0, 4) that looks at the origin, and takes its picture late enough for light to come.
fn camera(name: &str) -> Builder {
    Builder::new(name)
        .set("camera.eye", [0.5, 0.0, 4.0])
        .set("camera.look_at", DVec3::ZERO)
        .set("camera.size", [32, 24])
        .set("camera.time", "4 m")
}

const CAMERA: &str =
    "[camera]\neye = [0.5, 0, 4]\nlook_at = [0, 0, 0]\nsize = [32, 24]\ntime = '4 m'\n";

#[test]
fn a_mesh_of_a_file_renders_the_same_when_it_is_passed_as_arrays() {
    let folder = tempfile::tempdir().unwrap();
    files::glb(&folder.path().join("quad.glb"), &files::Quad::PLAIN);
    let text =
        "[[object]]\ngltf = 'quad.glb'\nvelocity = { beta = [0.5, 0, 0] }\norigin.time = '1 m'";
    let file = stage::scene_in(folder.path(), &format!("{CAMERA}{text}"));

    let want = Want {
        uvs: true,
        textures: false,
        shading: false,
        normals: false,
        bad_vertices: BadVertices::Refuse,
        bad_textures: BadTextures::Refuse,
    };
    let mesh = gltf::load(&folder.path().join("quad.glb"), None, want)
        .unwrap()
        .mesh;
    let memory = camera("arrays")
        .mesh("quad", Arc::new(mesh))
        .set("object.quad.velocity.beta", [0.5, 0.0, 0.0])
        .set("object.quad.origin.time", Time::customary(1.0));
    assert_same(&stage::film(&file), &stage::film(&memory.build().unwrap()));
}

#[test]
fn a_cube_of_a_file_renders_the_same_when_it_is_passed_as_an_array() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cube.npy");
    let value = |i: usize| (i * 37 % 101) as f64 / 7.0;
    files::npy(&path, &[4, 5, 16, 3], (0..4 * 5 * 16 * 3).map(value));
    let text = "[[object]]\nname = 'wall'\nshape = { box = { size = [2, 2, 1] } }\n[[source]]\n\
                cube = { file = 'cube.npy', bin_width = '0.3 m', start = '-1 m', filter = 'cubic' }";
    let file = stage::scene_in(folder.path(), &format!("{CAMERA}{text}"));

    let cube = Arc::new(cube::load(&path, Wanted::default()).unwrap());
    let memory = camera("array")
        .shape("wall", shapes_box())
        .cube("light", cube.clone(), 0.3)
        .set("source.light.cube.start", "-1 m")
        .set("source.light.cube.filter", "cubic")
        .build()
        .unwrap();
    assert_same(&stage::film(&file), &stage::film(&memory));

    // It is shared: the builder and the renderer have made no copy.
    let SourceKind::Cube(source) = &memory.sources[0].kind else {
        panic!("{:?}", memory.sources[0]);
    };
    assert!(source.data.path().is_none());
    assert_eq!(Arc::strong_count(&cube), 2);
}

fn shapes_box() -> nullray::scene::model::Shape {
    nullray::scene::model::Shape::Box {
        size: [2.0, 2.0, 1.0],
    }
}

#[test]
fn a_box_renders_the_same_as_its_arrays() {
    let velocity = Velocity::from_beta(DVec3::new(0.0, 0.6, 0.0)).unwrap();
    let colour = [0.25, 0.5, 1.0];
    let shape = camera("shape")
        .shape("box", shapes_box())
        .set("object.box.colour", colour)
        .set("object.box.velocity", velocity);
    let mesh = shapes::mesh(shapes_box(), colour);
    let arrays = camera("arrays")
        .mesh("box", Arc::new(mesh))
        .set("object.box.velocity", velocity);
    let [shape, arrays] = [shape, arrays].map(|b| stage::film(&b.build().unwrap()));
    assert_same(&shape, &arrays);
}

/// A triangle with texture coordinates.
fn triangle() -> Mesh {
    let corners = [DVec3::NEG_X, DVec3::X, DVec3::Y];
    let mut mesh = Mesh::new(corners.into(), vec![[0, 1, 2]], [1.0; 3]);
    mesh.uvs = vec![vec![[0.0; 2]; 3]];
    mesh
}

#[test]
fn the_text_of_a_scene_tells_arrays_apart() {
    let scene = |mesh: Mesh| camera("same").mesh("a", Arc::new(mesh)).build().unwrap();
    let hash = |scene: &Scene| {
        let pairs = metadata(scene, &stage::film(scene)).unwrap();
        pairs
            .into_iter()
            .find(|(key, _)| key == "scene_sha256")
            .unwrap()
            .1
    };
    let one = hash(&scene(triangle()));
    assert_eq!(one, hash(&scene(triangle())));
    let mut moved = triangle();
    moved.positions[2].y += f64::EPSILON;
    assert_ne!(one, hash(&scene(moved)));
    let mut painted = triangle();
    painted.materials[0].base_colour[1] = 0.5;
    assert_ne!(one, hash(&scene(painted)));
    let of_another_node = |mesh: &mut Mesh| mesh.parts[0].node = "wheel".into();
    let changes: [fn(&mut Mesh); 3] = [
        of_another_node,
        |mesh| mesh.materials[0].unlit = true,
        |mesh| mesh.materials[0].double_sided = true,
    ];
    let texts = changes.map(|change| {
        let mut mesh = triangle();
        change(&mut mesh);
        scene(mesh).text
    });
    let all: std::collections::HashSet<_> = texts.iter().collect();
    assert_eq!(all.len(), 3);
    assert!(!all.contains(&scene(triangle()).text));
}

#[test]
fn a_value_of_a_list_s_name_is_refused_as_in_a_file() {
    let of_file = |text: &str| {
        let text = format!("{text}\n{CAMERA}");
        let overrides = nullray::scene::Overrides::default();
        let read = nullray::scene::parse(&text, "a scene", Path::new(""), &overrides);
        read.unwrap_err().to_string()
    };
    for text in ["object = 5", "object = [5]", "object = { name = 'x' }"] {
        let builder = Builder::from_toml("a scene", &format!("{text}\n{CAMERA}"));
        let refused = builder.shape("box", shapes_box()).build().unwrap_err();
        assert_eq!(refused.to_string(), of_file(text));
    }
    // Lists of other notations are lists.
    for (text, count) in [
        ("object = []", 1),
        ("object = [{ shape = { sphere = { radius = 1 } } }]", 2),
    ] {
        let builder = Builder::from_toml("a scene", &format!("{text}\n{CAMERA}"));
        let scene = builder.shape("box", shapes_box()).build().unwrap();
        assert_eq!(scene.objects.len(), count);
    }
}

#[test]
fn keys_take_numbers_of_every_integer_type() {
    let with = |bits: Value| {
        let builder = camera("bits").shape("box", shapes_box());
        builder.set("display.bits", bits).build().unwrap().bits
    };
    let numbers = [
        16_u8.into(),
        16_u16.into(),
        16_u32.into(),
        16_u64.into(),
        16_usize.into(),
    ];
    assert_eq!(numbers.map(with), [16; 5]);
    let most = camera("bits").set("display.samples_per_pixel", u64::MAX);
    let (place, _) = refusal(most.shape("box", shapes_box()));
    assert_eq!(place, "display.samples_per_pixel");
}

/// The first sample of bin 1 of pixel (2, 3), and shapes that do not fit: a cube is checked when it is given, and one that a program puts
/// into a finished scene before that is planned.
#[test]
fn a_cube_built_by_hand_is_checked_as_one_of_a_file() {
    let shape = [4, 5, 6, 3];
    let bad = |x: f32| {
        let mut samples = vec![1.0; 4 * 5 * 6 * 3];
        samples[((2 * 5 + 3) * 6 + 1) * 3] = x;
        CubeSamples::F32(samples)
    };
    let no_columns = CubeSamples::F64(Vec::new());
    let rows = [
        (shape, bad(f32::NAN), "samples[2,3,1,0]", "not finite"),
        (shape, bad(f32::INFINITY), "samples[2,3,1,0]", "not finite"),
        ([4, 5, 6, 1], bad(1.0), "shape", "does not hold 360 samples"),
        ([1 << 32, 1 << 32, 1, 1], bad(1.0), "shape", "does not hold"),
        (
            [4, 0, 6, 3],
            no_columns,
            "shape",
            "the column axis is empty",
        ),
    ];
    let lit = || camera("by hand").shape("box", shapes_box());
    let good = Cube::new(shape, bad(1.0)).unwrap();
    let good = lit().cube("light", Arc::new(good), 0.5).build().unwrap();
    for (shape, samples, place, what) in rows {
        let cube = Arc::new(Cube { shape, samples });
        let place = format!("source \"light\", {place}");
        let edges = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let mut changed = good.clone();
        let SourceKind::Cube(source) = &mut changed.sources[0].kind else {
            panic!("another kind");
        };
        source.data = CubeData::Memory(cube.clone());
        let planned = match Plan::new(&changed, &Request::default()) {
            Err(Error::Invalid(problem)) => (problem.place.to_string(), problem.what.to_string()),
            other => panic!("not refused: {other:?}"),
        };
        let given = [
            refusal(lit().cube("light", cube.clone(), 0.5)),
            refusal(lit().cube_with_edges("light", cube, &edges)),
            planned,
        ];
        for (found, text) in given {
            assert_eq!(found, place, "{text}");
            assert!(text.contains(what), "{place}: {text}");
        }
    }
}

#[test]
fn a_scene_made_by_a_program_says_what_it_is_as_a_scene_file() {
    let by_hand = camera("text").shape("box", shapes_box()).build().unwrap();
    let read = stage::scene(&by_hand.text);
    assert_same(&stage::film(&by_hand), &stage::film(&read));
    let more = Builder::from_toml("more", &by_hand.text).shape("second", shapes_box());
    assert_eq!(more.build().unwrap().objects.len(), 2);
}

#[test]
fn a_plan_counts_what_is_in_memory() {
    let cube = Cube::new([1, 1, 8, 1], CubeSamples::F32(vec![1.0; 8])).unwrap();
    let scene = camera("plan")
        .mesh("a", Arc::new(triangle()))
        .cube("light", Arc::new(cube), 0.5)
        .build()
        .unwrap();
    assert!(matches!(scene.objects[0].geometry, Geometry::Mesh(_)));
    let plan = Plan::new(&scene, &Request::default()).unwrap();
    assert_eq!(plan.frames[0].triangles, 1);
    let planned = plan.cubes[0].as_ref().unwrap();
    assert_eq!((planned.shape, planned.bytes), ([1, 1, 8, 1], 32));
    let text = plan.to_string();
    assert!(text.contains("a (mesh in memory, 1 triangle)"), "{text}");
    assert!(text.contains("light (in memory)"), "{text}");
}

/// Place and text of the refusal of `builder`.
fn refusal(builder: Builder) -> (String, String) {
    match builder.build() {
        Err(Error::Invalid(problem)) => (problem.place.to_string(), problem.what.to_string()),
        other => panic!("not refused: {other:?}"),
    }
}

#[test]
fn errors_of_a_mesh_in_memory_name_the_scene_and_the_field() {
    let rendered = |mesh: Mesh| {
        let scene = camera("my scene")
            .mesh("q", Arc::new(mesh))
            .build()
            .unwrap();
        let plan = Plan::new(&scene, &Request::default()).unwrap();
        let silent = nullray::render::progress::Silent;
        nullray::render::prepare::Prepared::new(&scene, &plan, &silent).unwrap_err()
    };
    for (bad, said) in [(f64::NAN, "[NaN, NaN, NaN]"), (1e300, "[1e300, 0.0, 0.0]")] {
        let mut mesh = triangle();
        mesh.positions[1].x = bad;
        let error = rendered(mesh).to_string();
        let start =
            format!("my scene, object \"q\", positions[1]: is at {said} m after its transform");
        assert!(error.starts_with(&start), "{error}");
    }
    let mut mesh = triangle();
    mesh.parts[0].material = 4;
    let (place, what) = refusal(camera("my scene").mesh("q", Arc::new(mesh)));
    assert!(place.contains("parts[0].material"), "{place}");
    assert_eq!(what, "is 4, but there is only material 0");
    let (place, what) = refusal(camera("my scene").mesh("q", Arc::new(Mesh::default())));
    assert!(place.contains("triangles"), "{place}");
    assert_eq!(what, "there are none");
    // No hundred zeros in a message.
    let cube = Cube::new([1, 1, 8, 1], CubeSamples::F32(vec![1.0; 8])).unwrap();
    let with_cube = camera("wide bins").mesh("q", Arc::new(triangle()));
    let (_, what) = refusal(with_cube.cube("light", Arc::new(cube), 1e40));
    assert_eq!(what, "\"1e40 m\" is beyond 1e30");
}

#[test]
fn what_a_program_has_made_of_a_scene_is_checked_before_it_is_rendered() {
    let scene = camera("changed")
        .mesh("a", Arc::new(triangle()))
        .shape("b", shapes_box())
        .light("c", [("position", DVec3::Y.into())])
        .build()
        .unwrap();
    let refused = |change: fn(&mut Scene)| {
        let mut scene = scene.clone();
        change(&mut scene);
        Plan::new(&scene, &Request::default())
            .unwrap_err()
            .to_string()
    };
    for (said, part) in [
        (refused(|s| s.camera.size = [u32::MAX; 2]), "camera.size"),
        (refused(|s| s.camera.size = [0, 8]), "camera.size"),
        (refused(|s| s.samples_per_pixel = 0), "samples_per_pixel"),
        (
            refused(|s| s.camera.horizontal_fov = f64::NAN),
            "camera.horizontal_fov",
        ),
        (refused(|s| s.medium_index = f64::NAN), "medium_index"),
        (refused(|s| s.medium_index = -1.0), "medium_index"),
        (refused(|s| s.bounces = 65), "bounces"),
        (refused(|s| s.camera.time = f64::NAN), "camera.time"),
        (
            refused(|s| s.camera.horizontal_fov = std::f64::consts::PI),
            "camera.horizontal_fov",
        ),
        (
            refused(|s| {
                let mut mesh = triangle();
                mesh.triangles[0][1] = 77;
                s.objects[0].geometry = Geometry::Mesh(Arc::new(mesh));
            }),
            "triangles[0]",
        ),
        (
            refused(|s| {
                if let Geometry::Shape { shape, .. } = &mut s.objects[1].geometry {
                    *shape = nullray::scene::model::Shape::Sphere {
                        radius: 1.0,
                        subdivisions: 32,
                    };
                }
            }),
            "subdivisions",
        ),
        (
            refused(|s| {
                if let Geometry::Shape { shape, .. } = &mut s.objects[1].geometry {
                    let size = [1.0, f64::NAN, 1.0];
                    *shape = nullray::scene::model::Shape::Box { size };
                }
            }),
            "object \"b\", size",
        ),
        (
            refused(|s| {
                if let Geometry::Shape { shape, .. } = &mut s.objects[1].geometry {
                    *shape = nullray::scene::model::Shape::Lattice {
                        cells: [1, 0, 1],
                        spacing: 1.0,
                        bar: 0.1,
                    };
                }
            }),
            "object \"b\", cells",
        ),
        (
            refused(|s| {
                if let Geometry::Shape { colour, .. } = &mut s.objects[1].geometry {
                    colour[2] = -0.5;
                }
            }),
            "object \"b\", colour: -0.5 is not",
        ),
        (
            refused(|s| {
                if let Geometry::Shape { ior, .. } = &mut s.objects[1].geometry {
                    *ior = 0.9;
                }
            }),
            "object \"b\", ior: 0.9 is not",
        ),
        (
            refused(|s| {
                if let LightKind::Lamp(lamp) = &mut s.lights[0].kind {
                    lamp.emission = EmissionProfile::Train {
                        centre: 0.0,
                        sigma: 0.05,
                        period: 1.0,
                        count: Some(0),
                    };
                }
            }),
            "light \"c\", emission: a train of 0 pulses",
        ),
        (
            refused(|s| {
                if let LightKind::Lamp(lamp) = &mut s.lights[0].kind {
                    lamp.emission = EmissionProfile::Table(vec![[0.0, 0.0], [1.0, 0.0]]);
                }
            }),
            "light \"c\", emission: all factors are 0",
        ),
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    // A plan of another scene.
    let plan = Plan::new(&scene, &Request::default()).unwrap();
    let fewer = camera("fewer")
        .mesh("a", Arc::new(triangle()))
        .build()
        .unwrap();
    let prepared =
        nullray::render::prepare::Prepared::new(&fewer, &plan, &nullray::render::progress::Silent);
    assert!(
        prepared
            .unwrap_err()
            .to_string()
            .contains("the scene has 1 objects, but 2 were planned")
    );
}

/// What a program may set in a scene, to be refused.
type Change = fn(&mut Scene);

#[test]
fn numbers_that_no_scene_file_can_contain_are_refused_by_name() {
    const NAN: f64 = f64::NAN;
    fn lamp(scene: &mut Scene) -> &mut Lamp {
        match &mut scene.lights[0].kind {
            LightKind::Lamp(lamp) => lamp,
            LightKind::Area { .. } => unreachable!(),
        }
    }
    fn pulse(scene: &mut Scene) -> &mut Pulse {
        match &mut scene.sources[0].kind {
            SourceKind::Pulse(pulse) => pulse,
            SourceKind::Cube(_) => unreachable!(),
        }
    }
    fn capture(scene: &mut Scene) -> &mut CaptureCamera {
        match &mut scene.sources[1].kind {
            SourceKind::Cube(cube) => match &mut cube.mapping {
                Mapping::Capture(camera) => camera,
                Mapping::Uv { .. } => unreachable!(),
            },
            SourceKind::Pulse(_) => unreachable!(),
        }
    }
    fn sky(scene: &mut Scene) -> &mut Sky {
        scene.sky.as_mut().unwrap()
    }
    fn stars(scene: &mut Scene) -> &mut Stars {
        sky(scene).stars.as_mut().unwrap()
    }
    fn random(scene: &mut Scene, many: u32, magnitude: f64) {
        stars(scene).catalogue = Catalogue::Random {
            count: many,
            seed: 1,
            faintest: magnitude,
        };
    }
    fn train(period: f64) -> EmissionProfile {
        EmissionProfile::Train {
            centre: 0.0,
            sigma: 0.1,
            period,
            count: None,
        }
    }
    let cube = Cube::new([4, 4, 2, 1], CubeSamples::F32(vec![1.0; 32])).unwrap();
    let keys = Value::table([
        ("eye", [0.0, 0.0, 4.0].into()),
        ("look_at", DVec3::ZERO.into()),
        ("hfov", "40 deg".into()),
    ]);
    let text = "[sky]\nsun = { direction = [0, 1, 0] }\nstars = { count = 10 }\n[camera]\n[camera.sensor]\nfocal_length = \"36 mm\"\n\
                [camera.shutter]\nduration = \"1 m\"\n[camera.rotation]\naxis = [0, 0, 1]\nrate = \"0.1 rad/m\"\n";
    let scene = Builder::from_toml("changed", text)
        .set("camera.eye", [0.5, 0.0, 4.0])
        .set("camera.look_at", DVec3::ZERO)
        .set("camera.size", [8, 6])
        .shape("a", shapes_box())
        .shape("b", shapes_box())
        .light("l", [("position", DVec3::Y.into())])
        .pulse("p", DVec3::Y, 0.1)
        .set("source.p.objects", ["a"])
        .cube("c", Arc::new(cube), 0.5)
        .set("source.c.cube.capture", keys)
        .set("source.c.objects", ["b"])
        .build()
        .unwrap();
    Plan::new(&scene, &Request::default()).unwrap();
    let rows: &[(&str, Change)] = &[
        ("speed_of_light", |s| s.speed_of_light = 0.0),
        ("background", |s| s.background[1] = NAN),
        ("bits", |s| s.bits = 7),
        ("camera.origin", |s| s.camera.origin.ct = NAN),
        ("camera.axes", |s| s.camera.axes = [DVec3::ZERO; 3]),
        ("camera.axes", |s| s.camera.axes[1] = DVec3::NAN),
        ("camera.axes", |s| s.camera.axes[1] = s.camera.axes[0]),
        ("camera.frame_interval", |s| {
            s.camera.frame_interval = Some(0.0)
        }),
        ("camera.rotation.axis", |s| {
            s.camera.rotation.as_mut().unwrap().axis *= 2.0
        }),
        ("camera.rotation.rate", |s| {
            s.camera.rotation.as_mut().unwrap().rate = NAN
        }),
        ("camera.sensor.focal_length", |s| {
            s.camera.sensor.as_mut().unwrap().focal_length = 0.0
        }),
        ("camera.sensor.focal_length", |s| {
            s.camera.sensor.as_mut().unwrap().focal_length = NAN
        }),
        ("camera.shutter.duration", |s| {
            s.camera.shutter.as_mut().unwrap().duration = -1.0
        }),
        ("camera.stereo.interpupillary_distance", |s| {
            let interpupillary_distance = NAN;
            s.camera.stereo = Some(Stereo {
                interpupillary_distance,
            });
        }),
        ("object \"a\", transform", |s| {
            s.objects[0].transform.matrix3.x_axis = DVec3::ZERO
        }),
        ("object \"a\", transform", |s| {
            s.objects[0].transform.matrix3.x_axis.x = NAN
        }),
        ("object \"a\", transform", |s| {
            s.objects[0].transform.translation.x = NAN
        }),
        ("object \"b\", origin", |s| s.objects[1].origin.x.y = NAN),
        ("source \"p\", objects", |s| s.objects.clear()),
        ("source \"c\", objects", |s| s.objects.truncate(1)),
        ("source \"p\", sigma", |s| pulse(s).sigma = 0.0),
        ("source \"p\", sigma", |s| pulse(s).sigma = NAN),
        ("source \"p\", origin", |s| pulse(s).origin.x.x = NAN),
        ("source \"p\", intensity", |s| pulse(s).intensity[2] = -1.0),
        ("source \"c\", capture.fov", |s| capture(s).fov = 0.0),
        ("source \"c\", capture.fov", |s| capture(s).fov = NAN),
        ("source \"c\", capture.eye", |s| capture(s).eye.x = NAN),
        ("source \"c\", capture.axes", |s| {
            capture(s).axes[2] = DVec3::ZERO
        }),
        ("source \"c\", capture.near_clip", |s| {
            capture(s).near_clip = NAN
        }),
        ("light \"l\", intensity", |s| lamp(s).intensity[0] = -1.0),
        ("light \"l\", intensity", |s| lamp(s).intensity[0] = NAN),
        ("light \"l\", origin", |s| lamp(s).origin.ct = NAN),
        ("light \"l\", beam", |s| {
            lamp(s).beam = Beam::Parallel(DVec3::ZERO)
        }),
        ("light \"l\", beam", |s| {
            lamp(s).beam = Beam::Spot {
                axis: DVec3::Y,
                inner: 1.0,
                outer: 0.5,
            };
        }),
        ("light \"l\", motion", |s| {
            lamp(s).motion = Motion::Circular {
                centre: DVec3::ZERO,
                axis: DVec3::Z,
                rate: 2.0,
            };
        }),
        ("light \"l\", emission", |s| lamp(s).emission = train(0.0)),
        ("light \"l\", emission", |s| lamp(s).emission = train(0.05)),
        ("light \"l\", emission", |s| {
            lamp(s).emission = EmissionProfile::Gaussian {
                centre: 0.0,
                sigma: NAN,
            };
        }),
        ("light \"l\", emission", |s| {
            lamp(s).emission = EmissionProfile::Table(vec![[1.0, 1.0], [0.0, 1.0]]);
        }),
        ("light \"l\", emission", |s| {
            lamp(s).emission = EmissionProfile::Table(vec![[0.0, 1.0], [1.0, NAN]]);
        }),
        ("light \"l\", object", |s| {
            s.lights[0].kind = LightKind::Area {
                object: 99,
                brightness: Brightness::Radiance([1.0; 3]),
                emission: EmissionProfile::Steady,
            };
        }),
        ("sky.background", |s| {
            sky(s).background = SkyRadiance::Uniform([0.0, -1.0, 0.0])
        }),
        ("sky.background", |s| {
            sky(s).background = SkyRadiance::Uniform([NAN; 3])
        }),
        ("sky.sun.direction", |s| {
            sky(s).sun.as_mut().unwrap().direction = DVec3::NAN
        }),
        ("sky.sun.irradiance", |s| {
            sky(s).sun.as_mut().unwrap().irradiance[0] = NAN
        }),
        ("sky.sun.radius", |s| {
            sky(s).sun.as_mut().unwrap().radius = 0.0
        }),
        ("sky.stars.scale", |s| stars(s).scale = NAN),
        ("sky.stars.radius", |s| stars(s).radius = NAN),
        ("sky.stars.count", |s| random(s, u32::MAX, 6.5)),
        ("sky.stars.faintest", |s| random(s, 10, NAN)),
    ];
    for (place, change) in rows {
        let mut scene = scene.clone();
        change(&mut scene);
        let said = Plan::new(&scene, &Request::default());
        let said = said.expect_err(place).to_string();
        assert!(
            said.contains(&format!("changed, {place}: ")),
            "{place}: {said}"
        );
    }
}

#[test]
fn a_lamp_of_a_builder_lights_as_that_of_a_file() {
    let text = "[[object]]\nname = 'wall'\nshape = { box = { size = [2, 2, 1] } }\n[[light]]\nname = 'lamp'\n\
                position = [0.5, 1, 3]\npower = 10\n";
    let file = stage::scene(&format!("{CAMERA}{text}"));
    let keys = [
        ("position", DVec3::new(0.5, 1.0, 3.0).into()),
        ("power", 10.0.into()),
    ];
    let memory = camera("lamp")
        .shape("wall", shapes_box())
        .light("lamp", keys);
    let (film, expected) = (stage::film(&memory.build().unwrap()), stage::film(&file));
    assert_same(&expected, &film);
    let (_, radiance) = film.radiance_array();
    assert!(radiance.iter().any(|x| *x > 0.0));
}

#[test]
fn what_only_files_have_is_refused_of_a_cube_in_memory() {
    let cube = || Arc::new(Cube::new([1, 1, 4, 3], CubeSamples::F32(vec![1.0; 12])).unwrap());
    let with = |key: &str, value: Value| {
        let builder = camera("cube").mesh("a", Arc::new(triangle()));
        refusal(builder.cube("light", cube(), 0.5).set(key, value)).1
    };
    for (key, value) in [
        ("transfer", Value::from("srgb")),
        ("dead_bins", Value::from(vec![Value::from(2i64)])),
    ] {
        let said = with(&format!("source.light.cube.{key}"), value);
        assert!(said.contains("in memory"), "{key}: {said}");
    }
}

#[test]
fn samples_below_0_of_a_cube_in_memory_are_dealt_with_as_those_of_a_file() {
    let samples = CubeSamples::F32(vec![2.0, -1.0, 1.0, 3.0]);
    let cube = Arc::new(Cube::new([1, 1, 4, 1], samples).unwrap());
    let with = |negative: Option<&str>| {
        let builder = camera("cube").mesh("a", Arc::new(triangle()));
        let builder = builder.cube("light", cube.clone(), 0.5);
        match negative {
            Some(negative) => builder.set("source.light.cube.negative", negative),
            None => builder,
        }
    };
    let warnings = |negative: Option<&str>| {
        let scene = with(negative).build().unwrap();
        let plan = Plan::new(&scene, &Request::default()).unwrap();
        let silent = nullray::render::progress::Silent;
        let prepared = nullray::render::prepare::Prepared::new(&scene, &plan, &silent).unwrap();
        prepared.warnings.join("\n")
    };
    assert!(warnings(None).contains("1 of 4 samples is below 0"));
    for stated in ["keep", "zero"] {
        assert!(!warnings(Some(stated)).contains("below 0"), "{stated}");
    }
    let zero = with(Some("zero")).build().unwrap();
    let SourceKind::Cube(source) = &zero.sources[0].kind else {
        unreachable!()
    };
    let CubeData::Memory(zeroed) = &source.data else {
        unreachable!()
    };
    assert_eq!(zeroed.samples, CubeSamples::F32(vec![2.0, 0.0, 1.0, 3.0]));
    let (_, what) = refusal(with(Some("refuse")));
    assert!(what.contains("1 of 4 samples is below 0"), "{what}");
}

#[test]
fn a_cube_in_memory_may_have_bins_of_different_widths() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cube.npy");
    files::npy(&path, &[2, 2, 3, 1], (0..12).map(f64::from));
    let text = "[[object]]\nname = 'wall'\nshape = { box = { size = [2, 2, 1] } }\n[[source]]\n\
                cube = { file = 'cube.npy', edges = ['-1 m', '0.5 m', '1 m', '6 m'] }";
    let file = stage::scene_in(folder.path(), &format!("{CAMERA}{text}"));
    let cube = Arc::new(cube::load(&path, Wanted::default()).unwrap());
    let memory = camera("edges").shape("wall", shapes_box()).cube_with_edges(
        "light",
        cube,
        &[-1.0, 0.5, 1.0, 6.0],
    );
    assert_same(&stage::film(&file), &stage::film(&memory.build().unwrap()));
}

#[test]
fn values_are_made_of_numbers_texts_and_slices() {
    let [name, sizes] = ["b".to_string(), "a".to_string()].map(|text| text);
    let beta: &[f64] = &[0.1, 0.0, 0.0];
    let scene = camera("values")
        .shape(&name, shapes_box())
        .set("object.b.name", &sizes)
        .set("object.a.velocity.beta", beta)
        .set("display.samples_per_pixel", 9_usize)
        .build()
        .unwrap();
    assert_eq!(
        (scene.objects[0].name.as_str(), scene.samples_per_pixel),
        ("a", 9)
    );
    assert_eq!(scene.objects[0].velocity.beta().x, 0.1);
    let (_, what) = refusal(camera("many").set("camera.size", [usize::MAX, 8]));
    assert!(!what.is_empty());
}

#[test]
fn refusals_name_the_field() {
    let good = || camera("refused").mesh("a", Arc::new(triangle()));
    let with = |change: fn(&mut Mesh)| {
        let mut mesh = triangle();
        change(&mut mesh);
        camera("refused").mesh("a", Arc::new(mesh))
    };
    let tilted = Value::table([("axis", DVec3::ZERO.into()), ("angle", "1 deg".into())]);
    let rows = [
        (
            with(|m| m.triangles[0][1] = 3),
            "object \"a\", triangles[0]",
            "there are 3",
        ),
        (
            with(|m| m.uvs[0].truncate(2)),
            "object \"a\", uvs[0]",
            "2 texture coordinates for 3",
        ),
        (
            with(|m| m.parts.clear()),
            "object \"a\", parts",
            "cover 0 of 1",
        ),
        (
            with(|m| m.materials.clear()),
            "object \"a\", parts[0].material",
            "0 materials",
        ),
        (
            good().set("camera.hfov", 40.0),
            "camera.hfov",
            "has no unit",
        ),
        (good().set("camera.size", [0, 10]), "camera.size", "0 by 10"),
        (
            good().set("camera.eye", [f64::NAN, 0.0, 0.0]),
            "camera.eye[0]",
            "not a finite number",
        ),
        (
            good().set("object.a.velocity.beta", [0.0, 1.0, 0.0]),
            "object \"a\", velocity.beta",
            "not below 1",
        ),
        (
            good().set("object.a.transform.rotate", tilted),
            "object \"a\", transform.rotate.axis",
            "zero vector",
        ),
        (
            good().set("object.a.node", "x"),
            "object \"a\", node",
            "exclude each other",
        ),
        (
            good().set("object.a.colour", [1.0, 0.0, 0.0]),
            "object \"a\", colour",
            "`mesh`",
        ),
        (
            good().set("object.b.node", "x"),
            "object.b.node",
            "there is no object \"b\"",
        ),
        (
            good().set("camera..eye", 1.0),
            "camera..eye",
            "not a dotted key",
        ),
        (
            good().mesh("a", Arc::new(triangle())),
            "object[1].name",
            "two objects are named \"a\"",
        ),
        (
            good().pulse("p", DVec3::Y, 0.0),
            "source \"p\", pulse.sigma",
            "not above 0",
        ),
        (
            good().gltf("b", "missing.glb"),
            "object \"b\", gltf",
            "cannot find this file",
        ),
        (Builder::from_toml("refused", "a = ["), "", "unclosed array"),
        (camera("refused"), "camera", "the scene has no object"),
        (
            good().set("object.a.motion.acceleration.proper", "1 /m"),
            "object \"a\", motion",
            "unknown key `motion`",
        ),
    ];
    for (builder, place, what) in rows {
        let (found, text) = refusal(builder);
        assert_eq!(found, place, "{text}");
        assert!(text.contains(what), "{place}: {text}");
    }
}

#[test]
fn an_object_with_its_own_world_line_is_refused_with_the_reason() {
    let scene = camera("refused").mesh("a", Arc::new(triangle()));
    let error = scene
        .set("object.a.motion.acceleration.proper", "1 /m")
        .build()
        .unwrap_err();
    assert!(
        error.help().starts_with("objects move uniformly"),
        "{}",
        error.help()
    );
    // Other keys are not known either, and have nothing to do with motion.
    let error = camera("refused")
        .mesh("a", Arc::new(triangle()))
        .set("object.a.mass", 1.0)
        .build()
        .unwrap_err();
    assert!(error.help().starts_with("the keys of"), "{}", error.help());
}

#[test]
fn one_type_of_error_takes_those_of_values() {
    fn all(beta: f64, corner: u32, width: &str, samples: usize) -> nullray::Result<()> {
        let velocity = Velocity::from_beta(DVec3::X * beta)?;
        WorldLine::hyperbolic(velocity, Event::new(0.0, DVec3::ZERO), DVec3::X)?;
        Mesh::new(vec![DVec3::ZERO; 3], vec![[0, 1, corner]], [1.0; 3]).check()?;
        width.parse::<Time>()?;
        Cube::new([1, 1, 2, 1], CubeSamples::F32(vec![0.0; samples]))?;
        aov::parse("event, object")?;
        Channels::named(["R", "G", "B"])?;
        Ok(())
    }
    for error in [aov::parse("events").err(), Channels::named(["R"]).err()] {
        assert!(matches!(error, Some(Error::Value(_))), "{error:?}");
    }
    all(0.5, 2, "1 m", 2).unwrap();
    for (error, said) in [
        (all(1.5, 2, "1 m", 2), "|β| = 1.5 is not below 1"),
        (all(0.5, 3, "1 m", 2), "triangles[0]"),
        (all(0.5, 2, "1 apple", 2), "apple"),
        (all(0.5, 2, "1 m", 3), "does not hold 3 samples"),
    ] {
        let error = error.unwrap_err();
        assert!(matches!(error, Error::Value(_)), "{error:?}");
        assert!(error.to_string().contains(said), "{error}");
    }
}

#[test]
fn numbers_of_materials_out_of_their_ranges_are_refused_by_name() {
    type Field = fn(&mut Mesh, f32);
    let part: &[f32] = &[0.0, 1.0];
    let factor: &[f32] = &[0.0, 1e6];
    let rows: [(&str, Field, &[f32], &[f32]); 9] = [
        (
            "roughness",
            |m, x| m.materials[0].roughness = x,
            part,
            &[-0.1, 1.1],
        ),
        (
            "metallic",
            |m, x| m.materials[0].metallic = x,
            part,
            &[-0.1, 1.1],
        ),
        (
            "transmission",
            |m, x| m.materials[0].transmission = x,
            part,
            &[-0.1, 1.1],
        ),
        ("alpha", |m, x| m.materials[0].alpha = x, part, &[-0.1, 1.1]),
        (
            "ior",
            |m, x| m.materials[0].ior = x,
            &[1.0, 10.0],
            &[0.99, 10.1],
        ),
        (
            "emissive",
            |m, x| m.materials[0].emissive[2] = x,
            factor,
            &[-0.1],
        ),
        (
            "base_colour",
            |m, x| m.materials[0].base_colour[1] = x,
            factor,
            &[-0.1],
        ),
        (
            "alpha_mode.cutoff",
            |m, x| m.materials[0].alpha_mode = AlphaMode::Mask { cutoff: x },
            factor,
            &[-0.1],
        ),
        (
            "colours",
            |m, x| m.colours = vec![[1.0, x, 1.0, 1.0]; 3],
            factor,
            &[-0.1],
        ),
    ];
    let with = |set: Field, value: f32| {
        let mut mesh = triangle();
        set(&mut mesh, value);
        camera("material").mesh("a", Arc::new(mesh))
    };
    for (field, set, right, wrong) in rows {
        for value in right {
            with(set, *value).build().unwrap();
        }
        let none = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        for value in wrong.iter().chain(&none) {
            let (place, what) = refusal(with(set, *value));
            let place = place.strip_prefix("object \"a\", ").unwrap();
            let material = format!("materials[0].{field}");
            assert!(
                place == material || place == "colours[0]",
                "{field}: {place}"
            );
            assert!(what.contains(&value.to_string()), "{field}: {what}");
        }
    }
}

#[test]
fn a_file_cannot_name_what_was_in_memory() {
    let scene = camera("first")
        .mesh("a", Arc::new(triangle()))
        .build()
        .unwrap();
    let overrides = nullray::scene::Overrides::default();
    let again = nullray::scene::parse(&scene.text, "copy", Path::new(""), &overrides);
    let message = again.unwrap_err().to_string();
    assert!(
        message.contains("object[0].gltf: this was given in memory"),
        "{message}"
    );
}

#[test]
fn a_channel_is_an_array_with_a_shape() {
    let scene = camera("array").shape("box", shapes_box()).build().unwrap();
    let film = stage::film(&scene);
    let (shape, values) = film.radiance_array();
    assert_eq!(shape, [24, 32, 3]);
    assert_eq!(values.len(), 24 * 32 * 3);
    assert_eq!(values[(7 * 32 + 9) * 3 + 1], film.radiance()[7 * 32 + 9][1]);
    assert_eq!(film.aov_array(Aov::EventCt).unwrap().0, [24, 32]);
    assert!(film.aov_array(Aov::Coverage).is_some() == film.aov(Aov::Coverage).is_some());
}

#[test]
fn a_panel_of_a_scene_in_memory_is_that_scene_with_the_panel_s_changes() {
    let panels =
        "[[panel]]\nname = 'fast'\nset = { 'object.triangle.velocity.beta' = [0.1, 0, 0] }\n";
    let text = format!("{CAMERA}{panels}");
    let still = Builder::from_toml("panels", &text).mesh("triangle", Arc::new(triangle()));
    let fast = still.clone().build_panel("fast").unwrap();
    assert!(fast.panels.is_empty());
    let moving = still
        .clone()
        .set("object.triangle.velocity.beta", [0.1, 0.0, 0.0]);
    let moving = moving.build().unwrap();
    assert_eq!(fast.objects[0].velocity, moving.objects[0].velocity);
    assert_same(&stage::film(&fast), &stage::film(&moving));
    assert!(still.clone().build().unwrap().objects[0].velocity.is_rest());

    let error = still.build_panel("slow").unwrap_err().to_string();
    assert!(
        error.contains("no panel \"slow\"") && error.contains("panels"),
        "{error}"
    );
}
