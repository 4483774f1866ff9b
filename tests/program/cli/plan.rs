//! The output of `nullray plan`, and the work that it avoids.

use std::fs;
use std::time::{Duration, Instant};

use nullray::io::image::png;
use serde_json::Value;

use super::refused::TRIANGLE;
use super::{Folder, SMALL, repository};

#[test]
fn the_plan_says_what_is_done_and_what_is_skipped() {
    let folder = Folder::new();
    let text = folder.ok(&["plan", "scene.toml"]);
    for part in [
        "  film      32 × 24 pixels, 4 samples each, moving camera\n",
        "  frame     β = (0.6, 0, 0), γ = 1.25: 1 object, 12 triangles\n",
        "    object  crate (shape, 12 triangles): base colour lit by lamp\n",
        "  rays      3,072 from the camera, at most 3,072 for shadows\n",
        "  skipped   auxiliary channels: none is asked for\n",
    ] {
        assert!(text.contains(part), "{part:?} in {text}");
    }
    assert_eq!(folder.names(), ["scene.toml"]);
}

#[test]
fn a_fisheye_with_dark_corners_is_planned_as_the_point_that_it_is() {
    let folder = Folder::new();
    let planned = |more: &[&str]| {
        let fisheye = ["camera.projection=fisheye_equisolid", "camera.hfov=360 deg"];
        let sets = fisheye.iter().chain(more).flat_map(|set| ["--set", set]);
        let arguments: Vec<_> = ["plan", "scene.toml"].into_iter().chain(sets).collect();
        let text = folder.ok(&arguments);
        let json = folder.ok(&[&arguments[..], &["--json"]].concat());
        (text, serde_json::from_str::<Value>(&json).unwrap())
    };
    for (more, camera, kind) in [
        (&[][..], "moving camera", "moving"),
        (&["camera.velocity.beta=0"], "camera at rest", "still"),
        (
            &["effects.aberration=false"],
            "moving camera without aberration",
            "unaberrated",
        ),
    ] {
        let (text, json) = planned(more);
        let film = format!("4 samples each, {camera}, parts of the film see nothing\n");
        assert!(text.contains(&film), "{text}");
        assert_eq!(json["view"], kind);
        assert_eq!(json["has_blind_points"], true);
    }
    let (_, json) = planned(&["camera.shutter={duration=\"1 cm\"}"]);
    assert_eq!(json["view"], "inertial");
}

#[test]
fn the_plan_as_json_has_the_same_numbers() {
    let folder = Folder::new();
    let text = folder.ok(&[
        "plan",
        "scene.toml",
        "--json",
        "--aovs",
        "event",
        "--size",
        "10x10",
    ]);
    let plan: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(plan["rays"]["camera"], 400);
    assert_eq!(plan["film"]["channels"][0], "event.ct");
    assert_eq!(plan["frames"][1]["gamma"], 1.25);
}

#[test]
fn false_colours_that_show_nothing_are_told() {
    let folder = Folder::new();
    let notes = |more: &[&str]| {
        let mut arguments = vec!["plan", "scene.toml", "--set", "display.false_colour=1 um"];
        arguments.extend(more.iter().flat_map(|set| ["--set", set]));
        let said = folder.ok(&arguments);
        said.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let none = "display.false_colour has no effect";
    let some = "colours are false: 1000 nm is shown as 555 nm";
    let rgb = "radiance.quantity=rgb";
    let line = ["radiance.quantity=line", "radiance.wavelength=900 nm"];
    let unshifted = [rgb, "effects.doppler=false"];
    for (more, expected, other) in [
        (&[][..], none, some),
        (&[rgb], some, none),
        (&line, some, none),
        (&unshifted, none, some),
    ] {
        let said = notes(more);
        assert!(said.contains(expected), "{more:?}: {said}");
        assert!(!said.contains(other), "{more:?}: {said}");
    }
}

#[test]
fn a_thousand_objects_stay_readable_and_are_all_in_the_json() {
    let folder = Folder::empty();
    let mut scene = SMALL.split("[[object]]").next().unwrap().to_string();
    for i in 0..1000 {
        scene += &format!(
            "[[object]]\nshape = {{ box = {{ size = [1, 1, 1] }} }}\n\
             velocity = {{ beta = [{}, 0, 0] }}\n",
            f64::from(i % 40) / 100.0
        );
    }
    folder.write("scene.toml", scene);
    let text = folder.ok(&["plan", "scene.toml"]);
    assert!(text.lines().count() < 200, "{}", text.lines().count());
    assert!(text.contains("25 objects, 300 triangles"), "{text}");
    assert!(text.contains("… and 17 more: 204 triangles"), "{text}");
    assert!(text.contains("… and 24 more: 7,200 triangles"), "{text}");
    let json: Value = serde_json::from_str(&folder.ok(&["plan", "scene.toml", "--json"])).unwrap();
    assert_eq!(json["objects"].as_array().unwrap().len(), 1000);
    assert_eq!(json["frames"].as_array().unwrap().len(), 40);
}

#[test]
fn a_mesh_is_planned_without_its_buffer() {
    let folder = Folder::empty();
    folder.write("mesh.gltf", TRIANGLE);
    let scene = SMALL.replace(
        "shape = { box = { size = [1, 1, 1] } }",
        "gltf = \"mesh.gltf\"",
    );
    folder.write("scene.toml", scene);
    let text = folder.ok(&["plan", "scene.toml"]);
    assert!(text.contains("crate (mesh.gltf, 1 triangle)"), "{text}");
    let run = folder.run(&["render", "scene.toml"]);
    assert_eq!(run.code, 2);
    assert!(run.message().contains("mesh.bin"), "{}", run.message());
}

/// A cube of 2048 × 2048 × 1024 bins, 17 GB: a sparse file, of which only the header is there.
#[test]
fn a_huge_cube_is_planned_from_its_header() {
    let folder = Folder::empty();
    fs::copy(
        repository("scenes/corner/corner.glb"),
        folder.path("corner.glb"),
    )
    .unwrap();
    let mut header =
        b"{'descr': '<f4', 'fortran_order': False, 'shape': (2048, 2048, 1024), }".to_vec();
    header.resize(117, b' ');
    header.push(b'\n');
    let start = [
        b"\x93NUMPY\x01\x00".as_slice(),
        &118u16.to_le_bytes(),
        &header,
    ]
    .concat();
    folder.write("data.npy", &start);
    let file = fs::OpenOptions::new()
        .write(true)
        .open(folder.path("data.npy"))
        .unwrap();
    file.set_len(start.len() as u64 + (1 << 34)).unwrap();
    folder.write(
        "scene.toml",
        "[camera]\neye = [1, 1, 4]\nlook_at = [0, 1, 0]\nhfov = \"60 deg\"\nsize = [32, 24]\n\
         [[object]]\ngltf = \"corner.glb\"\n[[source]]\n[source.cube]\nfile = \"data.npy\"\n\
         start = \"-8 m\"\nbin_width = \"1 cm\"\nuv = 0\n",
    );
    let start = Instant::now();
    let text = folder.ok(&["plan", "scene.toml", "--max-memory", "20GiB"]);
    assert!(
        start.elapsed() < Duration::from_secs(10),
        "{:?}",
        start.elapsed()
    );
    assert!(
        text.contains("2048 rows × 2048 columns × 1024 time bins, 1 channel, 16.0 GiB"),
        "{text}"
    );

    // What does not fit is read in parts: as many as the plan estimates, and no more than that is held.
    let limit = ["--memory", "96MiB"];
    let text = folder.ok(&[&["plan", "scene.toml"], &limit[..]].concat());
    let row = text
        .lines()
        .find(|line| line.contains("read from disk in parts"));
    let needed = row.and_then(|row| row.split("about ").nth(1)).unwrap();
    let needed = needed.strip_suffix(" of it are needed").unwrap();
    let arguments = [
        "render",
        "scene.toml",
        "--stats",
        "-o",
        "a.png",
        "--stats-json",
        "a.json",
    ];
    let text = folder.ok(&[&arguments[..], &limit].concat());
    for row in ["needed of cubes on disk", "read of cubes on disk"] {
        let said = text.lines().find(|line| line.contains(row)).unwrap();
        assert!(said.ends_with(needed), "{said} {needed}");
    }
    let said: Value = serde_json::from_slice(&fs::read(folder.path("a.json")).unwrap()).unwrap();
    assert_eq!(said["disk_bytes"]["read"], said["disk_bytes"]["needed"]);
    // 768 pixels have four samples of four texels, in two bricks at the most.
    let read = said["disk_bytes"]["read"].as_u64().unwrap();
    assert!(read > 4096 && read <= 768 * 4 * 4 * 2 * 4096, "{read}");
}

#[test]
fn what_does_not_fit_even_in_parts_is_refused() {
    let folder = Folder::new();
    let run = folder.run(&["render", "scene.toml", "--max-memory", "1k"]);
    assert_eq!(run.code, 2);
    assert!(
        run.message().contains("more than the limit"),
        "{}",
        run.message()
    );
}

/// Bytes of the parts of the memory that a plan estimates.
fn memory(folder: &Folder, options: &[&str]) -> Value {
    let text = folder.ok(&[&["plan", "scene.toml", "--json"], options].concat());
    let plan: Value = serde_json::from_str(&text).unwrap();
    plan["memory"].clone()
}

#[test]
fn the_plan_has_the_memory_of_rasterizers_and_warps() {
    let folder = Folder::empty();
    let shape = "shape = { sphere = { radius = 1, subdivisions = 6 } }";
    let scene = SMALL.replace("shape = { box = { size = [1, 1, 1] } }", shape);
    let scene = scene.replace("velocity = { beta = [0.6, 0, 0] }\n", "");
    folder.write("scene.toml", scene);
    let traced = memory(&folder, &[]);
    let drawn = memory(&folder, &["--method", "raster:none"]);
    assert_eq!(traced["beside"], 0);
    // 81,920 triangles: their corners stay, everything else only while the picture is made.
    let beside = drawn["beside"].as_u64().unwrap();
    assert!((81_920 * 12..81_920 * 200).contains(&beside), "{beside}");
    assert_eq!(drawn["geometry"], traced["geometry"]);
    // 6 · 1000² texels of 48 bytes.
    let warped = memory(&folder, &["--method", "warp:cube=1000"]);
    assert_eq!(warped["temporary"], 288_000_000);
    for command in ["plan", "render"] {
        let warp = [
            command,
            "scene.toml",
            "--method",
            "warp:cube=1000",
            "--max-memory",
            "200MiB",
        ];
        let run = folder.run(&warp);
        assert_eq!(run.code, 2);
        assert!(
            run.message().contains("more than the limit of 200.0 MiB"),
            "{}",
            run.message()
        );
    }
}

#[test]
fn the_plan_says_at_how_many_points_triangles_may_be_cut_and_more_are_refused_at_once() {
    let folder = Folder::new();
    let method = [
        "--method",
        "raster:adaptive=0.00000001",
        "--max-memory",
        "512MiB",
    ];
    let text = folder.ok(&[&["plan", "scene.toml"][..], &method].concat());
    assert!(text.contains("triangles may be cut at up to 1,2"), "{text}");
    let start = Instant::now();
    let run = folder.run(&[&["render", "scene.toml"][..], &method].concat());
    assert_eq!(run.code, 2);
    assert!(
        run.message().contains("points") && run.message().contains("--max-memory"),
        "{}",
        run.message()
    );
    assert!(
        start.elapsed() < Duration::from_secs(3),
        "{:?}",
        start.elapsed()
    );
}

/// Every scene that the program comes with: no warning, but for those whose light has to be baked first, and one whose panels say when.
#[test]
fn no_scene_of_the_program_is_warned_of() {
    let scenes = std::path::PathBuf::from(repository("scenes"));
    let mut folders = vec![scenes];
    let (mut planned, mut to_bake) = (0, 0);
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = || fs::read_to_string(&path).unwrap();
            let is_scene =
                path.extension().is_some_and(|e| e == "toml") && text().contains("[camera]");
            if !is_scene {
                continue;
            }
            let run = Folder::empty().run(&["plan", path.to_str().unwrap()]);
            let is_baked = run.code == 2 && run.stderr.contains("light/");
            // Its panels have times of their own, at which its light is in view.
            let has_times_of_panels = path.ends_with("paper/figure-03.toml");
            let is_of_time = |line: &str| line.is_empty() || line.contains("light in view left");
            let is_silent = match has_times_of_panels {
                true => run.stderr.lines().all(is_of_time),
                false => run.stderr.is_empty(),
            };
            assert!(
                is_baked || run.code == 0 && is_silent,
                "{}: {}",
                path.display(),
                run.stderr
            );
            planned += usize::from(!is_baked);
            to_bake += usize::from(is_baked);
        }
    }
    assert!(planned >= 20 && to_bake <= 4, "{planned} {to_bake}");
}

/// A mirror, a lamp without extent, and bounces.
const MIRROR: &str = r#"
[camera]
eye = [0, 2, 4]
look_at = [0, 0, 0]
size = [4, 4]
[render]
bounces = 2
[[object]]
name = "floor"
shape = { plane = { size = [4, 4] } }
[[object]]
name = "pane"
shape = { box = { size = [0.1, 1, 1] } }
metallic = 1
roughness = 0
[[light]]
name = "bulb"
position = [1, 1, 0]
"#;

#[test]
fn light_of_lamps_that_mirrors_and_glass_lose_is_said_with_both_names() {
    let folder = Folder::new();
    let glass = MIRROR.replace("metallic = 1\nroughness = 0", "transmission = 1");
    for (scene, way) in [
        (MIRROR, "via the perfect mirrors \"pane\""),
        (&glass, "via the smooth glass \"pane\""),
    ] {
        folder.write("mirror.toml", scene);
        for said in [
            folder.ok(&["plan", "mirror.toml"]),
            folder.ok(&["render", "mirror.toml", "-o", "a.png"]),
        ] {
            for words in [
                "lamps without extent (\"bulb\"): their light cannot be sampled",
                way,
                "it is missing, and the standard error does not include it",
            ] {
                assert!(said.contains(words), "{words}: {said}");
            }
        }
    }
    // Rough mirrors find it, and lamps with an extent, and without bounces no path is followed.
    let panel = MIRROR.to_string() + "type = \"area\"\nobject = \"floor\"\n";
    for scene in [
        MIRROR.replace("roughness = 0", "roughness = 0.001"),
        MIRROR.replace("bounces = 2", "bounces = 0"),
        panel.replace("position = [1, 1, 0]\n", ""),
    ] {
        folder.write("mirror.toml", scene);
        let said = folder.ok(&["plan", "mirror.toml"]);
        assert!(!said.contains("without extent"), "{said}");
    }
}

/// A metal mirror whose texture of roughness (green) and metalness (blue) has these texels.
fn textured_mirror(folder: &Folder, texels: &[[u8; 3]], factor: f64) {
    let corners: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let uvs: [[f32; 2]; 3] = [[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]];
    let numbers = corners.iter().flatten().chain(uvs.iter().flatten());
    folder.write(
        "a.bin",
        numbers.flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>(),
    );
    let document = serde_json::json!({
        "asset": { "version": "2.0" },
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "material": 0 }] }],
        "materials": [{ "pbrMetallicRoughness": { "roughnessFactor": factor, "metallicRoughnessTexture": { "index": 0 } } }],
        "textures": [{ "source": 0 }],
        "images": [{ "uri": "a.png" }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 24 },
        ],
        "buffers": [{ "byteLength": 60, "uri": "a.bin" }],
    });
    folder.write("a.gltf", document.to_string());
    let width = texels.len() as u32;
    png::write(&folder.path("a.png"), width, 1, texels.as_flattened(), &[]).unwrap();
}

#[test]
fn mirrors_that_textures_make_lose_light_and_are_named() {
    let folder = Folder::empty();
    let pane = "shape = { box = { size = [0.1, 1, 1] } }\nmetallic = 1\nroughness = 0";
    assert!(MIRROR.contains(pane));
    folder.write("mirror.toml", MIRROR.replace(pane, "gltf = \"a.gltf\""));
    let (rough, smooth, dark_red) = ([0, 90, 255], [255, 0, 255], [0, 1, 0]);
    for (texels, factor, is_named) in [
        (&[rough, smooth, rough][..], 1.0, true),
        (&[rough, dark_red], 1.0, false),
        (&[rough, dark_red], 0.0, true),
    ] {
        textured_mirror(&folder, texels, factor);
        for said in [
            folder.ok(&["plan", "mirror.toml"]),
            folder.ok(&["render", "mirror.toml", "-o", "b.png"]),
        ] {
            let words = "cannot be sampled via the perfect mirrors \"pane\"";
            assert_eq!(
                said.matches(words).count(),
                usize::from(is_named),
                "{texels:?}: {said}"
            );
        }
    }
}

#[test]
fn a_camera_inside_glass_is_remarked_in_the_plan_and_with_pictures() {
    let folder = Folder::empty();
    let scene = |eye: &str| {
        format!(
            "[camera]\neye = {eye}\nlook_at = [0, 0, -9]\nsize = [8, 6]\n[render]\nbounces = 2\n\
             [[object]]\nname = \"block\"\nshape = {{ box = {{ size = [2, 2, 2] }} }}\ntransmission = 1\n\
             [sky]\nradiance = 1\n"
        )
    };
    for (eye, is_inside) in [("[0, 0, 0.5]", true), ("[0, 0, 3]", false)] {
        folder.write("in.toml", scene(eye));
        for command in [
            &["plan", "in.toml"][..],
            &["render", "in.toml", "-o", "in.png", "--white", "1"],
            &[
                "render",
                "in.toml",
                "-o",
                "#.png",
                "--white",
                "1",
                "--frames",
                "0..2",
                "--interval",
                "1 mm",
            ],
        ] {
            // Lines of the plan are broken.
            let said = folder
                .ok(command)
                .split_whitespace()
                .collect::<Vec<_>>()
                .join(" ");
            let words = "camera is inside the glass of \"block\"";
            assert_eq!(said.contains(words), is_inside, "{eye} {command:?}: {said}");
        }
    }
}

#[test]
fn light_that_loses_digits_at_high_speed_is_remarked() {
    let folder = Folder::empty();
    let scene = |gamma: &str, lamp: &str| {
        let moves = format!("velocity = {{ gamma = {gamma}, direction = [1, 2, -3] }}");
        let lamp = lamp.replace("MOVES", &moves);
        format!(
            "[camera]\neye = [0, 1, 3]\nlook_at = [0, 0, 0]\nsize = [8, 6]\n{moves}\n[render]\nbounces = 1\n\
             [[object]]\nname = \"floor\"\nshape = {{ plane = {{ size = [4, 4] }} }}\n{moves}\n\
             [[light]]\nname = \"lamp\"\nposition = [0, 2, 0]\n{lamp}\n"
        )
    };
    // γ² 2⁻⁵³ is 1e-5 at 3e5; γ² 2⁻⁴² is 1e-3 at 6.6e4. A lamp at rest keeps its digits.
    for (gamma, lamp, light, bounces) in [
        ("1e6", "MOVES", true, true),
        ("1e6", "", false, true),
        ("1e5", "MOVES", false, true),
        ("5e4", "MOVES", false, false),
    ] {
        folder.write("fast.toml", scene(gamma, lamp));
        let said = folder.ok(&["plan", "fast.toml"]);
        // Lines of the plan are broken.
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        let has = |words: &str| said.contains(words);
        assert_eq!(has("has relative errors of 1e-4"), light, "{gamma}: {said}");
        assert_eq!(has("light that bounces starts"), bounces, "{gamma}: {said}");
    }
}

/// After T of the camera's time its event is γT away in the world, where it is rounded by 2⁻⁵³ γT; in the frame of lamp and wall, 3 m away,
/// that is 2⁻⁵³ γ² T.
#[test]
fn light_that_loses_digits_after_a_long_camera_time_or_acceleration_is_remarked() {
    let folder = Folder::empty();
    let scene = |gamma: &str, time: &str, lamp: &str| {
        let moves = format!("velocity = {{ gamma = {gamma}, direction = [1, 0, 0] }}");
        format!(
            "[camera]\neye = [0, 0, 0]\nforward = [0, 0, -1]\nsize = [8, 6]\ntime = \"{time}\"\n{moves}\n\
             [[object]]\nshape = {{ box = {{ size = [4, 4, 2] }} }}\norigin = {{ position = [0, 0, -3] }}\n{moves}\n\
             [[light]]\n{}\n",
            lamp.replace("MOVES", &moves)
        )
    };
    let with_camera = "position = [0, 1, 0]\nMOVES";
    // From rest to γ = 10⁷ within 10⁷ m.
    let catches_up = "position = [-9999999, 1, 0]\nclock_zero = \"-9999999.95 m\"\n\
                      motion.segments = [{ duration = \"16.811242831518264 m\", acceleration = { proper = \"1 /m\", direction = [1, 0, 0] } }]";
    for (gamma, time, lamp, said) in [
        ("1e4", "0 m", with_camera, None),
        ("1e4", "1 km", with_camera, None),
        // 2⁻⁵³ · 10⁸ · 10⁶/3 = 3.7·10⁻³.
        (
            "1e4",
            "1000 km",
            with_camera,
            Some(
                "γ = 1.0e4 in the world, where coordinates are rounded: the light of such lamps on such surfaces has relative errors of 4e-3",
            ),
        ),
        ("1e7", "0 m", catches_up, Some("γ = 1.0e7 in the world")),
    ] {
        folder.write("late.toml", scene(gamma, time, lamp));
        let plan = folder.ok(&["plan", "late.toml"]);
        let plan = plan.split_whitespace().collect::<Vec<_>>().join(" ");
        match said {
            Some(said) => assert!(plan.contains(said), "{plan}"),
            None => assert!(!plan.contains("has relative errors"), "{plan}"),
        }
    }
}
