//! `nullray render model.glb --flash`: a film of light in flight on a model without a scene.

use nullray::io::image::Layers;
use serde_json::json;

use super::models::{SIZE, folder, picture, render, seen};

/// What makes a flash on a model quick.
const COARSE: [&str; 4] = ["--flash", "--texels", "16x16", "--bounces=1"];

#[test]
fn a_flash_goes_over_a_model_in_a_film() {
    let folder = folder(0.3);
    let film = ["model.gltf", "-o", "a-##.exr", "--aovs", "object"];
    render(&folder, &[&film[..], &COARSE].concat());
    assert!(folder.path("model-light-model.npz").exists());
    assert!(folder.path("model-light-floor.npz").exists());
    let films: Vec<Layers> = (0..48)
        .map(|k| picture(&folder, &format!("a-{k:02}.exr")))
        .collect();
    // By row, when the light that is seen there of the model is brightest: the lamp is above it, and so is the camera.
    let seen = seen(&films[0]);
    let light: Vec<Vec<[f64; 3]>> = films.iter().map(|film| film.radiance().unwrap()).collect();
    let when = |row: usize| {
        let columns: Vec<usize> = (0..60).filter(|&j| seen[row][j]).collect();
        let sum =
            |frame: &[[f64; 3]]| -> f64 { columns.iter().map(|j| frame[60 * row + j][1]).sum() };
        let sums: Vec<f64> = light.iter().map(|frame| sum(frame)).collect();
        (0..48)
            .max_by(|a, b| sums[*a].total_cmp(&sums[*b]))
            .unwrap()
    };
    let rows: Vec<usize> = (0..40)
        .filter(|&i| seen[i][20..40].iter().all(|s| *s))
        .collect();
    let (top, bottom) = (rows[1], rows[rows.len() - 2]);
    // Of the square's side of 1.41 radii, these rows are at least 1 apart; light that comes from above at about 45° and is seen from above
    // is later by more than that, and a picture shows a tenth of a radius.
    assert!(
        when(top) + 5 < when(bottom),
        "{} {}",
        when(top),
        when(bottom)
    );
    // Nothing is seen before, and nearly nothing at the end.
    let total = |k: usize| -> f64 { light[k].iter().flatten().sum() };
    let most = (0..48).map(total).fold(0.0, f64::max);
    assert!(total(0) < 0.1 * most && total(24) > 0.01 * most);
    // The same light serves a camera that moves.
    let said = folder.ok(&[
        &["render", "model.gltf", "--beta", "0.5", "-o", "film.apng"][..],
        &["--frames", "20..26"],
        &COARSE,
        &SIZE,
    ]
    .concat());
    assert_eq!(said.matches("exists already").count(), 2, "{said}");
    assert!(said.contains("6 pictures"), "{said}");
}

#[test]
fn the_scene_of_a_flash_shows_the_same_and_says_how_its_light_is_baked() {
    let folder = folder(20.0);
    let motion = ["--beta", "0.9", "--direction", "towards"];
    let all = [&["model.gltf"][..], &motion, &COARSE].concat();
    let printed = folder.ok(&[&["render", "--print-scene"], &all[..], &SIZE].concat());
    assert_eq!(folder.names(), ["model.bin", "model.gltf"]);
    folder.write("printed.toml", &printed);
    // Without its light it says what to do.
    let run = folder.run(&["render", "printed.toml"]);
    let line = printed
        .lines()
        .find(|line| line.starts_with("#   nullray bake"));
    let command = line.unwrap().trim_start_matches("#   nullray ");
    assert!(
        run.code == 2 && run.message().contains(command),
        "{}",
        run.message()
    );
    let command = command.replace('"', "");
    let said = folder.ok(&command.split(' ').collect::<Vec<_>>());
    assert!(said.contains("wrote model-light-floor.npz"), "{said}");
    folder.ok(&[
        "render",
        "printed.toml",
        "--frames",
        "24..25",
        "-o",
        "b-##.exr",
    ]);
    let frames = ["-o", "a-##.exr", "--frames", "24..25"];
    let said = folder.ok(&[&["render"], &all[..], &frames, &SIZE].concat());
    assert_eq!(said.matches("exists already").count(), 2, "{said}");
    let [a, b] = ["a-24.exr", "b-24.exr"].map(|name| picture(&folder, name));
    assert_eq!(a.channels, b.channels);
    assert!(a.radiance().unwrap().iter().any(|rgb| rgb[1] > 0.0));
}

#[test]
fn a_fast_camera_sees_the_model_of_a_flash_as_a_whole_and_large_about_the_middle_of_the_film() {
    let folder = folder(1.0);
    for direction in ["x", "towards", "away"] {
        let motion = ["--beta", "0.9", "--direction", direction];
        let frames = ["-o", "a-##.exr", "--aovs", "object", "--frames", "12..37"];
        render(
            &folder,
            &[&["model.gltf"][..], &frames, &motion, &COARSE].concat(),
        );
        let mut widest = 0.0f64;
        for k in (12..37).step_by(4) {
            let layers = picture(&folder, &format!("a-{k:02}.exr"));
            let object = layers.channels.iter().find(|c| c.name == "object").unwrap();
            let ids = object.samples.to_f64();
            let shown: Vec<usize> = (0..60 * 40).filter(|i| ids[*i] == 0.0).collect();
            assert!(!shown.is_empty(), "{direction}, {k}");
            // It does not touch the edges.
            let is_inside = |i: &usize| (1..59).contains(&(i % 60)) && (1..39).contains(&(i / 60));
            assert!(shown.iter().all(is_inside), "{direction}, {k}");
            let extent = |of: fn(usize) -> usize, whole: f64| {
                let places = shown.iter().map(|i| of(*i));
                let (least, most) = (places.clone().min().unwrap(), places.max().unwrap());
                (most - least + 1) as f64 / whole
            };
            widest = widest
                .max(extent(|i| i % 60, 60.0))
                .max(extent(|i| i / 60, 40.0));
        }
        assert!(widest > 0.25, "{direction}: {widest}");
    }
}

#[test]
fn materials_that_shine_flash_like_lamps_if_they_are_a_good_part_of_the_surface() {
    let folder = folder(0.3);
    let text = String::from_utf8(folder.read("model.gltf")).unwrap();
    // With a second square, of this size and with this emission.
    let with = |size: f64, emission: [f64; 3]| {
        let mut model: serde_json::Value = serde_json::from_str(&text).unwrap();
        model["nodes"] = json!([{ "mesh": 0 }, { "mesh": 1, "scale": [size, size, size] }]);
        let (mut mesh, mut shining) = (model["meshes"][0].clone(), model["materials"][0].clone());
        mesh["primitives"][0]["material"] = json!(1);
        shining["emissiveFactor"] = json!(emission);
        model["meshes"].as_array_mut().unwrap().push(mesh);
        model["materials"].as_array_mut().unwrap().push(shining);
        model.to_string()
    };
    let film = |size: f64, emission: [f64; 3]| {
        folder.write("model.gltf", with(size, emission));
        let frames = ["-o", "a-##.exr", "--frames", "24..25"];
        let run = folder.run(&[&["render", "model.gltf"][..], &frames, &COARSE, &SIZE].concat());
        assert_eq!(run.code, 0, "{}", run.message());
        let light = picture(&folder, "a-24.exr").radiance().unwrap().to_vec();
        std::fs::remove_file(folder.path("model-light-model.npz")).unwrap();
        std::fs::remove_file(folder.path("model-light-floor.npz")).unwrap();
        (run.message(), light)
    };
    let (dark, green) = ([0.0; 3], [0.0, 1.0, 0.0]);
    let said = "the steady light that the model's materials emit is left out";
    // A 400th of the other square's area: it is left out.
    let ((before, black), (after, glowing)) = (film(0.05, dark), film(0.05, green));
    assert!(!before.contains(said) && after.contains(said), "{after}");
    assert!(black == glowing);
    // A hundredth: it is the only lamp. A plan bakes nothing.
    folder.write("model.gltf", with(0.1, green));
    let planned = folder.ok(&["bake", "model.gltf", "--flash", "--plan", "--texels=16x16"]);
    assert!(
        planned.contains("model-light-model.npz: 16 rows"),
        "{planned}"
    );
    assert!(!folder.names().iter().any(|name| name.contains("light")));
    let (after, light) = film(0.1, green);
    assert!(!after.contains(said), "{after}");
    let sum = |c: usize| -> f64 { light.iter().map(|rgb| rgb[c]).sum() };
    assert!(
        sum(1) > 0.0 && sum(0).max(sum(2)) < 1e-6 * sum(1),
        "{}",
        sum(1)
    );
}

#[test]
fn light_from_afar_comes_with_that_of_near_lamps() {
    let folder = folder(1.0);
    let text = String::from_utf8(folder.read("model.gltf")).unwrap();
    // The square is a kilometre from the origin, with a near lamp, parallel light and a distant lamp, in this order.
    let with = |lamps: &[usize]| {
        let mut model: serde_json::Value = serde_json::from_str(&text).unwrap();
        let place = |x: f64, z: f64| json!([1000.0 + x, 1.0, z - 2.0]);
        let lamp = |k: &usize| {
            let at = place([3.0, 3.0, 3.0][*k], [1.5, 0.0, 700.0][*k]);
            json!({ "translation": at, "extensions": { "KHR_lights_punctual": { "light": k } } })
        };
        let mut nodes = vec![json!({ "mesh": 0, "translation": [1000.0, 0.0, 0.0] })];
        nodes.extend(lamps.iter().map(lamp));
        model["nodes"] = json!(nodes);
        model["extensionsUsed"] = json!(["KHR_lights_punctual"]);
        model["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
            { "type": "point" }, { "type": "directional" }, { "type": "point", "intensity": 1e5 }] } });
        folder.write("lamps.gltf", model.to_string());
        let printed = folder.ok(&["render", "lamps.gltf", "--flash", "--print-scene"]);
        let number = |key: &str| -> f64 {
            let line = printed.lines().find_map(|line| line.strip_prefix(key));
            let said = line
                .unwrap()
                .trim_start_matches(" = \"")
                .trim_end_matches(" m\"");
            said.parse().unwrap()
        };
        (
            number("clock_zero"),
            number("time"),
            number("frame_interval"),
        )
    };
    let alone = with(&[0]);
    // At the middle all of it arrives at once, and nowhere on the square, of radius 0.71, more than a few radii apart.
    for lamps in [&[0, 1][..], &[0, 2], &[0, 1, 2]] {
        let all = with(lamps);
        assert!(
            (all.0 - alone.0).abs() < 1e-6,
            "{lamps:?} {all:?} {alone:?}"
        );
        assert!(all.2 < 2.0 * alone.2, "{lamps:?} {all:?} {alone:?}");
    }
}

#[test]
fn a_flash_of_a_lamp_inside_a_closed_body_says_why_it_is_black() {
    let folder = folder(1.0);
    // A tetrahedron with its lamp in the middle.
    let corners: [[f32; 3]; 4] = [
        [1.0, 1.0, 1.0],
        [1.0, -1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
    ];
    let faces: [[u16; 3]; 4] = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    let mut bytes: Vec<u8> = corners
        .as_flattened()
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    bytes.extend(faces.as_flattened().iter().flat_map(|i| i.to_le_bytes()));
    folder.write("body.bin", &bytes);
    let model = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0, 1] }],
        "nodes": [
            { "mesh": 0, "name": "body" },
            { "name": "bulb", "extensions": { "KHR_lights_punctual": { "light": 0 } } },
        ],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": { "KHR_lights_punctual": { "lights": [{ "type": "point" }] } },
        "materials": [{ "pbrMetallicRoughness": { "metallicFactor": 0 } }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -1, -1], "max": [1, 1, 1] },
            { "bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 24 },
        ],
        "buffers": [{ "byteLength": 72, "uri": "body.bin" }],
    });
    folder.write("body.gltf", model.to_string());
    let mut arguments = vec![
        "render",
        "body.gltf",
        "--flash",
        "--texels",
        "16x16",
        "-o",
        "a.apng",
    ];
    arguments.extend(SIZE);
    let said = folder.ok(&arguments);
    assert!(said.contains("lamp \"bulb\" is inside \"model\""), "{said}");
    let why = "the picture is black: the data of what is in view are dark: all their numbers are 0";
    assert!(said.contains(why), "{said}");
}

#[test]
fn flashes_that_show_nothing_are_refused() {
    let folder = folder(1.0);
    folder.write("scene.toml", super::SMALL);
    let refused = |arguments: &[&str], what: &str| {
        let run = folder.run(arguments);
        let said = run.message();
        assert!(
            run.code == 2 && said.contains(what),
            "{arguments:?}: {said}"
        );
    };
    refused(&["render", "scene.toml", "--flash"], "this is a scene");
    refused(&["bake", "scene.toml", "--flash"], "this is a scene");
    refused(&["render", "model.gltf", "--flash", "--flyby"], "--flyby");
    refused(
        &["render", "model.gltf", "--flash", "--time", "1 m"],
        "--time",
    );
    // What only a flash has is not passed over in other views.
    for view in [&[][..], &["--flyby"], &["--time", "1 m"]] {
        let texels = ["render", "model.gltf", "--texels", "8x8"];
        refused(&[&texels[..], view].concat(), "--texels");
    }
    refused(
        &["render", "model.gltf", "--flash", "--error=1%"],
        "this is a sequence",
    );
    refused(&["bake", "model.gltf", "--flash", "-o", "a.npy"], ".npz");
    refused(&["bake", "model.gltf", "--flash", "--bins", "9"], "--bins");
    refused(&["bake", "scene.toml"], "--bin-width");
    refused(&["bake", "model.gltf", "--bin-width=1 m"], "--flash");
    let text = String::from_utf8(folder.read("model.gltf")).unwrap();
    folder.write(
        "model.gltf",
        text.replace("\"metallicFactor\":0.0", "\"metallicFactor\":1.0"),
    );
    refused(
        &["render", "model.gltf", "--flash"],
        "all its surfaces are metal or glass",
    );
    assert!(!folder.names().iter().any(|name| name.contains("light")));
}
