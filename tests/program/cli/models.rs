//! `nullray render model.glb`: a model without a scene.

use nullray::io::image::{Layers, exr, png};
use serde_json::json;

use super::Folder;

/// A folder with `model.gltf`: a square that stands about (3, 1, −2), all times `size`, facing +z.
pub(super) fn folder(size: f32) -> Folder {
    let corner = |x: f32, y: f32| [(3.0 + x) * size, (1.0 + y) * size, -2.0 * size];
    let (a, c) = (corner(-0.5, -0.5), corner(0.5, 0.5));
    let (b, d) = (corner(0.5, -0.5), corner(-0.5, 0.5));
    let corners = [a, b, c, a, c, d];
    let document = json!({
        "asset": { "version": "2.0" },
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
        "materials": [{ "pbrMetallicRoughness": { "metallicFactor": 0.0 }, "doubleSided": true }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3",
            "min": a, "max": c }],
        "bufferViews": [{ "buffer": 0, "byteLength": 72 }],
        "buffers": [{ "byteLength": 72, "uri": "model.bin" }],
    });
    let bytes = corners.iter().flatten().flat_map(|c| c.to_le_bytes());
    let folder = Folder::empty();
    folder.write("model.gltf", document.to_string());
    folder.write("model.bin", bytes.collect::<Vec<u8>>());
    folder
}

#[test]
fn a_file_that_is_missing_beside_a_model_is_called_missing() {
    let folder = folder(1.0);
    std::fs::create_dir(folder.path("below")).unwrap();
    std::fs::rename(folder.path("model.gltf"), folder.path("below/model.gltf")).unwrap();
    std::fs::rename(folder.path("model.bin"), folder.path("other.bin")).unwrap();
    for arguments in [["render", "below/model.gltf"], ["info", "below/model.gltf"]] {
        let run = folder.run(&arguments);
        let said = run.message() + &run.stdout;
        assert!(!said.contains("outside"), "{arguments:?}: {said}");
    }
    let run = folder.run(&["render", "below/model.gltf"]);
    assert_eq!(run.code, 2);
    assert!(
        run.message().contains("model.bin: cannot read"),
        "{}",
        run.message()
    );
}

pub(super) const SIZE: [&str; 4] = ["--size", "60x40", "--spp", "1"];

pub(super) fn render(folder: &Folder, arguments: &[&str]) {
    let mut all = vec!["render"];
    all.extend(arguments);
    all.extend(SIZE);
    folder.ok(&all);
}

pub(super) fn picture(folder: &Folder, name: &str) -> Layers {
    exr::read(&folder.path(name), &Default::default()).unwrap()
}

/// By row, whether each pixel sees the model.
pub(super) fn seen(layers: &Layers) -> Vec<Vec<bool>> {
    let object = layers.channels.iter().find(|c| c.name == "object").unwrap();
    let ids = object.samples.to_f64();
    ids.chunks(60)
        .map(|row| row.iter().map(|&id| id >= 0.0).collect())
        .collect()
}

#[test]
fn the_whole_model_is_in_the_picture_at_any_speed_and_scale() {
    for size in [1e-3, 1.0, 1e3] {
        let folder = folder(size);
        for motion in [
            &[][..],
            &["--beta", "0.9"],
            &["--beta", "0.9", "--direction", "towards"],
            &["--beta", "0.5", "--direction", "away"],
            &["--beta", "0.99", "--direction", "-y"],
            &["--beta", "0.8", "--direction", "1,-1,0.5"],
        ] {
            let mut arguments = vec!["model.gltf", "-o", "a.exr", "--aovs", "object"];
            arguments.extend(motion);
            render(&folder, &arguments);
            let seen = seen(&picture(&folder, "a.exr"));
            let span = |lit: Vec<usize>| [lit[0], lit[lit.len() - 1]];
            let rows = span((0..40).filter(|&i| seen[i].contains(&true)).collect());
            let in_column = |j: usize| seen.iter().any(|row| row[j]);
            let columns = span((0..60).filter(|&j| in_column(j)).collect());
            // The square spans 0.88 of the rows or of the columns, and has its middle in that of the picture, to a pixel.
            let case = format!("{size} {motion:?}: rows {rows:?}, columns {columns:?}");
            let part = |[first, last]: [usize; 2], of: f64| (last + 1 - first) as f64 / of;
            let filled = part(rows, 40.0).max(part(columns, 60.0));
            assert!((0.83..0.93).contains(&filled), "{case}");
            let is_central =
                |[first, last]: [usize; 2], of: usize| (first + last).abs_diff(of - 1) <= 2;
            assert!(is_central(rows, 40) && is_central(columns, 60), "{case}");
        }
    }
}

#[test]
fn the_scene_that_a_model_stands_for_renders_the_same_picture() {
    let folder = folder(0.02);
    let motion = ["--beta", "0.9", "--direction", "-x"];
    let said = folder.ok(&[
        &["render", "model.gltf", "--print-scene"],
        &motion[..],
        &SIZE,
    ]
    .concat());
    assert!(said.contains("gltf = \"model.gltf\""), "{said}");
    assert!(said.contains("beta = 0.9"), "{said}");
    assert_eq!(folder.names(), ["model.bin", "model.gltf"]);
    folder.write("printed.toml", &said);
    folder.ok(&["render", "printed.toml", "-o", "b.exr"]);
    render(
        &folder,
        &[&["model.gltf", "-o", "a.exr"], &motion[..]].concat(),
    );
    let [a, b] = ["a.exr", "b.exr"].map(|name| picture(&folder, name));
    assert_eq!(a.channels, b.channels);
}

#[test]
fn a_flyby_is_a_sequence_that_the_model_crosses() {
    let folder = folder(5.0);
    let arguments = [
        "model.gltf",
        "--flyby",
        "--beta",
        "0.6",
        "-o",
        "a-##.exr",
        "--aovs",
        "object",
    ];
    // The middle of its 48 pictures, and those at either end of it.
    render(&folder, &[&arguments[..], &["--frames", "8..40"]].concat());
    // The camera moves to the right (it looks along −z), so that the model moves to the left.
    let place = |name: &str| {
        let seen = seen(&picture(&folder, name));
        let columns = seen.iter().flat_map(|row| (0..60).filter(|&k| row[k]));
        let columns: Vec<usize> = columns.collect();
        columns.iter().sum::<usize>() as f64 / columns.len() as f64
    };
    let places = [place("a-08.exr"), place("a-24.exr"), place("a-39.exr")];
    assert!(
        places[0] > places[1] + 3.0 && places[1] > places[2] + 3.0,
        "{places:?}"
    );
    folder.ok(&[
        "render",
        "model.gltf",
        "--flyby",
        "--size",
        "4x4",
        "--spp",
        "1",
        "-q",
    ]);
    assert!(folder.names().contains(&"model-0047.png".to_string()));
}

#[test]
fn the_model_is_seen_behind_a_camera_that_flies_by() {
    let folder = folder(5.0);
    let arguments =
        "model.gltf --flyby --beta 0.9 --frames 36..37 -o a-##.png -o a-##.exr --aovs object";
    render(&folder, &arguments.split(' ').collect::<Vec<_>>());
    let seen = seen(&picture(&folder, "a-36.exr"));
    let codes = png::read(&folder.path("a-36.png"), &Default::default());
    let codes = codes.unwrap().radiance().unwrap();
    let of_model = seen.iter().flatten().zip(codes);
    let of_model: Vec<f64> = of_model
        .filter(|(seen, _)| **seen)
        .map(|(_, rgb)| rgb.into_iter().fold(0.0, f64::max))
        .collect();
    // By a linear display it is black there.
    assert!(of_model.len() > 5, "{}", of_model.len());
    assert!(of_model.iter().all(|code| *code > 0.1), "{of_model:?}");
}

/// Writes a box as `model.gltf`, of this size about this middle.
fn write_box(folder: &Folder, size: [f32; 3], middle: [f32; 3]) {
    let corner = |k: usize| {
        std::array::from_fn(|axis| middle[axis] + size[axis] * ((k >> axis & 1) as f32 - 0.5))
    };
    let corners: [[f32; 3]; 8] = std::array::from_fn(corner);
    let sides = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = sides
        .iter()
        .flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d]);
    let triangles: Vec<u8> = triangles.collect();
    let mut bytes: Vec<u8> = corners
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    bytes.extend(&triangles);
    let document = json!({
        "asset": { "version": "2.0" },
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }] }],
        "materials": [{ "pbrMetallicRoughness": { "metallicFactor": 0.0 }, "doubleSided": true }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": corners[0], "max": corners[7] },
            { "bufferView": 1, "componentType": 5121, "count": 36, "type": "SCALAR" },
        ],
        "bufferViews": [{ "buffer": 0, "byteLength": 96 }, { "buffer": 0, "byteOffset": 96, "byteLength": 36 }],
        "buffers": [{ "byteLength": 132, "uri": "model.bin" }],
    });
    folder.write("model.gltf", document.to_string());
    folder.write("model.bin", bytes);
}

/// What part of a picture shows the model, and the median and the 5th percentile of its brightness there, from 0 to 1 as codes are.
fn shown(folder: &Folder, arguments: &[&str], name: &str) -> (f64, [f64; 2]) {
    let [png, exr] = ["png", "exr"].map(|ending| format!("{name}.{ending}"));
    render(folder, arguments);
    let seen = seen(&picture(folder, &exr));
    let display = png::read(&folder.path(&png), &Default::default()).unwrap();
    let light = display.radiance().unwrap();
    let of_model = seen.iter().flatten().zip(light).filter(|(seen, _)| **seen);
    let mut codes: Vec<f64> = of_model
        .map(|(_, rgb)| rgb.into_iter().fold(0.0, f64::max))
        .collect();
    codes.sort_by(f64::total_cmp);
    let part = codes.len() as f64 / 2400.0;
    let at = |part: f64| {
        codes
            .get((part * codes.len() as f64) as usize)
            .copied()
            .unwrap_or(0.0)
    };
    (part, [at(0.5), at(0.05)])
}

#[test]
fn a_model_of_any_form_is_seen_well_at_any_speed_from_any_side() {
    let folder = Folder::empty();
    for (size, middle, least) in [
        ([1.0, 1.0, 1.0], [0.0, 0.5, 0.0], 0.1),
        // Tiny and flat, huge and long, and each far from the origin.
        ([2e-4, 1e-7, 2e-4], [5e-3, 0.0, 1e-3], 0.04),
        ([9e5, 4e4, 4e4], [-1e7, 3e6, 0.0], 0.01),
    ] {
        write_box(&folder, size, middle);
        for beta in ["0.5", "0.99", "0.9999"] {
            for direction in ["x", "-x", "y", "z", "away", "towards"] {
                let direction = format!("--direction={direction}");
                let mut arguments = vec!["model.gltf", "--beta", beta, &direction, "-o", "a.png"];
                arguments.extend(["-o", "a.exr", "--aovs", "object"]);
                let (part, [median, dark]) = shown(&folder, &arguments, "a");
                let case = format!("{size:?} {beta} {direction}: {part} {median} {dark}");
                assert!((least..0.85).contains(&part), "{case}");
                // White is the 99th percentile: of one flat face all is nearly white, and not all is beyond it.
                assert!(median > 0.25 && (0.04..0.999).contains(&dark), "{case}");
            }
        }
    }
}

#[test]
fn a_model_is_seen_well_from_a_camera_that_flies_by_at_any_speed() {
    let folder = Folder::empty();
    write_box(&folder, [1.0, 0.6, 1.0], [0.0; 3]);
    for beta in ["0.1", "0.9", "0.99", "0.9999"] {
        for (frames, name) in [("16..17", "a-16"), ("24..25", "a-24"), ("36..37", "a-36")] {
            let mut arguments = vec!["model.gltf", "--flyby", "--beta", beta, "--frames", frames];
            arguments.extend(["-o", "a-##.png", "-o", "a-##.exr", "--aovs", "object"]);
            let (part, [median, _]) = shown(&folder, &arguments, name);
            let case = format!("{beta} {frames}: {part} {median}");
            assert!((0.008..0.5).contains(&part), "{case}");
            assert!((0.2..0.99).contains(&median), "{case}");
        }
    }
}

#[test]
fn what_cannot_be_framed_is_refused() {
    let folder = folder(1.0);
    folder.write("scene.toml", super::SMALL);
    let refused = |arguments: &[&str], what: &str| {
        let run = folder.run(&[&["render"], arguments].concat());
        assert_eq!(run.code, 2, "{arguments:?}");
        assert!(
            run.message().contains(what),
            "{arguments:?}: {}",
            run.message()
        );
    };
    refused(&["model.gltf", "--beta", "1"], "|β| = 1 is not below 1");
    refused(&["model.gltf", "--beta", "nan"], "|β| = NaN is not below 1");
    refused(&["model.gltf", "--direction", "x"], "--beta");
    refused(
        &["model.gltf", "--beta", "0.5", "--direction", "up"],
        "towards or away",
    );
    refused(
        &["model.gltf", "--flyby", "--beta", "0"],
        "a camera at rest passes nothing",
    );
    refused(&["scene.toml", "--beta", "0.5"], "this is a scene");
    refused(&["scene.toml", "--flyby"], "this is a scene");
    refused(&["missing.glb"], "missing.glb");
    // Nothing of other folders is read, whoever wrote the file.
    let text = String::from_utf8(folder.read("model.gltf")).unwrap();
    std::fs::create_dir(folder.path("below")).unwrap();
    folder.write(
        "below/model.gltf",
        text.replace("model.bin", "../model.bin"),
    );
    refused(&["below/model.gltf"], "outside its folder");
    render(
        &folder,
        &["below/model.gltf", "--allow-outside", "-o", "below.png"],
    );
    folder.write("model.bin", [0; 72]);
    refused(&["model.gltf"], "its triangles have no extent");
    folder.write("model.bin", [0; 7]);
    refused(&["model.gltf"], "it should have 72 bytes and has 7");
}

#[test]
fn a_model_in_light_brighter_than_any_white_of_a_scene_file_is_exposed_by_its_picture() {
    // W is some 10⁻⁸ ahead, and W⁻⁴ beyond 10³⁰.
    let folder = folder(1.0);
    let arguments = [
        "render",
        "model.gltf",
        "--beta",
        "0.9999999999999999",
        "--size",
        "16x12",
        "--set",
        "radiance.quantity=\"integrated\"",
        "-o",
        "a.png",
    ];
    let said = folder.ok(&arguments);
    assert!(said.contains("white is radiance"), "{said}");
}

const LIGHTS_UNREAD: &str =
    "the file's lights shine in a scene only if it names them, by gltf and node in [[light]]";

/// The values of a table whose keys a file gives are those that the scene of a model alone has: no unit is converted on the way.
#[test]
fn a_scene_that_names_the_lights_of_a_model_shows_the_picture_of_the_model() {
    let folder = folder(1.0);
    let mut model: serde_json::Value = serde_json::from_slice(&folder.read("model.gltf")).unwrap();
    model["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    model["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "spot", "intensity": 5.3, "color": [1, 0.7, 0.3], "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.31 } },
        { "type": "point", "intensity": 3.7 },
        { "type": "directional", "intensity": 0.9, "color": [0.2, 0.3, 1] },
    ] } });
    let node = |name: &str, light: usize, place: [f64; 3], turn: [f64; 4]| {
        json!({ "name": name, "translation": place, "rotation": turn,
            "extensions": { "KHR_lights_punctual": { "light": light } } })
    };
    model["nodes"] = json!([
        { "mesh": 0 },
        node("Torch", 0, [3.1, 1.3, 0.7], [0.1, 0.05, 0.0, 0.993_730_345]),
        node("Bulb", 1, [2.3, 1.7, -1.2], [0.0, 0.0, 0.0, 1.0]),
        node("Sun", 2, [0.0; 3], [-0.3, 0.2, 0.1, 0.927_361_849]),
    ]);
    folder.write("model.gltf", model.to_string());
    let printed = folder.ok(&["render", "model.gltf", "--print-scene"]);
    let (head, rest) = printed.split_once("\n[[light]]").unwrap();
    let (_, display) = rest.split_once("\n[display]").unwrap();
    let tables = ["Torch", "Bulb", "Sun"]
        .map(|node| format!("\n[[light]]\ngltf = \"model.gltf\"\nnode = \"{node}\"\n"));
    let named = format!("{head}{}\n[display]{display}", tables.concat());
    folder.write("printed.toml", printed.as_str());
    // As somebody would write it.
    folder.write("named.toml", named.split_once('\n').unwrap().1);
    render(&folder, &["printed.toml", "-o", "printed.exr"]);
    let said = folder.ok(&[&["render", "named.toml", "-o", "named.exr"], &SIZE[..]].concat());
    assert!(!said.contains(LIGHTS_UNREAD), "{said}");
    let lit = picture(&folder, "named.exr").channels;
    assert_eq!(lit, picture(&folder, "printed.exr").channels);
    let unlit = format!("{head}\n[display]{display}");
    folder.write("unlit.toml", unlit.split_once('\n').unwrap().1);
    let said = folder.ok(&[&["render", "unlit.toml", "-o", "unlit.exr"], &SIZE[..]].concat());
    assert!(said.contains(LIGHTS_UNREAD), "{said}");
    assert_ne!(lit, picture(&folder, "unlit.exr").channels);
}

#[test]
fn a_model_of_which_nothing_is_lit_or_nothing_is_left_says_so() {
    let folder = folder(1.0);
    let text = String::from_utf8(folder.read("model.gltf")).unwrap();
    let dark = "nothing of the model in view is lit";
    let render = |name: &str| folder.ok(&[&["render", name, "-o", "a.png"], &SIZE[..]].concat());
    assert!(!render("model.gltf").contains(dark));
    let black = text.replace(
        "\"metallicFactor\":0.0",
        "\"metallicFactor\":0.0,\"baseColorFactor\":[0,0,0,1]",
    );
    assert_ne!(black, text);
    folder.write("black.gltf", black);
    let said = render("black.gltf");
    assert!(said.contains(dark), "{said}");
    // Colours of vertices are read for the picture alone.
    let mut model: serde_json::Value = serde_json::from_str(&text).unwrap();
    model["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(1);
    model["accessors"].as_array_mut().unwrap().push(json!({
        "bufferView": 1, "componentType": 5126, "count": 6, "type": "VEC3" }));
    model["bufferViews"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "buffer": 1, "byteLength": 72 }));
    model["buffers"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "byteLength": 72, "uri": "colours.bin" }));
    folder.write("colours.bin", f32::NAN.to_le_bytes().repeat(18));
    folder.write("colours.gltf", model.to_string());
    let said = render("colours.gltf");
    assert!(
        said.contains("only the sky is in view: no triangle can be seen"),
        "{said}"
    );
    assert!(!said.contains("aim the camera"), "{said}");
}

#[test]
fn numbers_of_the_scene_of_a_model_have_no_digits_of_rounding() {
    let folder = folder(1.0);
    for motion in [&[][..], &["--flyby"], &["--beta", "0.9"]] {
        let printed = folder.ok(&[&["render", "model.gltf", "--print-scene"], motion].concat());
        let angle = printed
            .lines()
            .find_map(|line| line.strip_prefix("hfov = \""))
            .unwrap();
        let digits = angle.chars().filter(char::is_ascii_digit).count();
        assert!(digits <= 12, "{motion:?}: {angle}");
        assert!(
            !motion.is_empty() || angle.starts_with("50.0 deg"),
            "{angle}"
        );
    }
}

#[test]
fn a_surface_of_which_parts_shine_is_said_to_be_lit_by_its_lights_once() {
    let folder = folder(1.0);
    let mut model: serde_json::Value = serde_json::from_slice(&folder.read("model.gltf")).unwrap();
    let (shining, mut part) = (
        json!({ "name": "bulb", "emissiveFactor": [1, 1, 1] }),
        model["meshes"][0]["primitives"][0].clone(),
    );
    part["material"] = json!(1);
    model["materials"].as_array_mut().unwrap().push(shining);
    model["meshes"][0]["primitives"]
        .as_array_mut()
        .unwrap()
        .push(part);
    folder.write("model.gltf", model.to_string());
    let plan = folder.ok(&["plan", "model.gltf"]);
    assert_eq!(plan.matches("lit by the sky").count(), 1, "{plan}");
    assert!(
        plan.contains("base colour lit by the sky, and what parts of it emit"),
        "{plan}"
    );
    // Plural and singular of what it holds.
    let info = folder.ok(&["info", "model.gltf"]);
    assert!(
        info.contains("1, placed as 2 primitives") && info.contains("0 images"),
        "{info}"
    );
    model["meshes"][0]["primitives"]
        .as_array_mut()
        .unwrap()
        .pop();
    folder.write("model.gltf", model.to_string());
    let info = folder.ok(&["info", "model.gltf"]);
    assert!(info.contains("1, placed as 1 primitive\n"), "{info}");
}

#[test]
fn the_lights_of_a_model_are_lights_of_its_scene_in_place_of_a_sun() {
    let folder = folder(1.0);
    let said = folder.ok(&["render", "model.gltf", "--print-scene"]);
    assert!(
        said.contains("sun = { direction = ") && !said.contains("[[light]]"),
        "{said}"
    );
    let mut document: serde_json::Value =
        serde_json::from_slice(&folder.read("model.gltf")).unwrap();
    document["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    document["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "spot", "intensity": 5, "range": 9, "spot": { "outerConeAngle": 0.5 } },
    ] } });
    document["nodes"] = json!([
        { "mesh": 0 },
        { "translation": [3, 1, 4], "extensions": { "KHR_lights_punctual": { "light": 0 } } },
    ]);
    folder.write("model.gltf", document.to_string());
    let said = folder.ok(&["render", "model.gltf", "--print-scene"]);
    let light = "[[light]]\ntype = \"spot\"\ndirection = [0.0, 0.0, -1.0]\ninner = \"0 deg\"\n\
                 outer = \"28.64788975654116 deg\"\nposition = [3.0, 1.0, 4.0]\nintensity = [5.0, 5.0, 5.0]\n";
    assert!(said.contains(light) && !said.contains("sun"), "{said}");
    let mut arguments = vec!["render", "model.gltf", "-o", "a.exr"];
    arguments.extend(SIZE);
    let said = folder.ok(&arguments);
    assert!(!said.contains(LIGHTS_UNREAD), "{said}");
    assert!(
        said.contains("the range of its light is not applied"),
        "{said}"
    );
    // A scene that somebody wrote has its own.
    let own = "[camera]\neye = [3, 1, 4]\nlook_at = [3, 1, -2]\nsize = [8, 6]\n[sky]\ngradient = {}\n\
               [[object]]\ngltf = \"model.gltf\"\n";
    folder.write("own.toml", own);
    let said = folder.ok(&["render", "own.toml", "-o", "b.exr"]);
    assert!(said.contains(LIGHTS_UNREAD), "{said}");
    // Also one that has no light, which shows base colours.
    folder.write("dark.toml", own.replace("[sky]\ngradient = {}\n", ""));
    let said = folder.ok(&["render", "dark.toml", "-o", "c.exr"]);
    assert!(said.contains(LIGHTS_UNREAD), "{said}");
}

#[test]
fn what_is_not_read_of_a_model_is_named_once_wherever_it_is_looked_at() {
    let folder = folder(1.0);
    let mut document: serde_json::Value =
        serde_json::from_slice(&folder.read("model.gltf")).unwrap();
    document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(0);
    document["cameras"] =
        json!([{ "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.1 } }]);
    document["nodes"] = json!([{ "mesh": 0 }, { "name": "cart", "camera": 0 }]);
    document["animations"] = json!([{
        "name": "ride",
        "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }],
        "samplers": [{ "input": 0, "output": 0 }],
    }]);
    folder.write("model.gltf", document.to_string());
    let info = folder.ok(&["info", "model.gltf"]);
    assert!(info.contains("animations  1: ride"), "{info}");
    let plan = folder.ok(&["plan", "model.gltf"]);
    let render = folder.ok(&[&["render", "model.gltf", "-o", "a.png"], &SIZE[..]].concat());
    for said in [info, plan, render] {
        let part = "animation 0: no mesh moves with it";
        assert_eq!(said.matches(part).count(), 1, "{part}: {said}");
        // Normals of vertices are read.
        assert!(!said.contains("normals"), "{said}");
    }
}

#[test]
fn a_plan_of_a_model_takes_the_options_of_its_picture() {
    let folder = folder(1.0);
    folder.ok(&["plan", "model.gltf", "--beta", "0.9", "--direction", "x"]);
    folder.ok(&["plan", "model.gltf", "--flyby"]);
    let run = folder.run(&["plan", "model.gltf", "--direction", "x"]);
    assert!(
        run.code == 2 && run.stderr.contains("--beta 0.9"),
        "{}",
        run.stderr
    );
}

#[test]
fn pages_sheets_and_diagrams_are_made_of_a_model() {
    let folder = folder(1.0);
    let small = ["--size", "12x8", "--spp", "1"];
    let made = |arguments: &[&str]| {
        folder.ok(arguments);
    };
    made(&[&["sheet", "model.gltf", "-o", "sheet.png"][..], &small[..]].concat());
    let page = [
        "page",
        "model.gltf",
        "--steps",
        "2",
        "--grid",
        "2x2",
        "-o",
        "pages",
    ];
    made(&[&page[..], &small[..]].concat());
    made(&["diagram", "model.gltf", "-o", "model.svg"]);
    made(&[
        "diagram",
        "model.gltf",
        "--pixel",
        "320,240",
        "-o",
        "pixel.svg",
    ]);
    // The diagram is that of the scene that stands for the model.
    let text = folder.ok(&["render", "model.gltf", "--print-scene"]);
    folder.write("scene.toml", text);
    made(&["diagram", "scene.toml", "-o", "scene.svg"]);
    let lines = |name: &str| {
        let text = std::fs::read_to_string(folder.path(name)).unwrap();
        let paths = text.lines().filter(|line| line.contains("<path"));
        paths.map(str::to_owned).collect::<Vec<_>>()
    };
    let drawn = lines("model.svg");
    assert!(drawn.len() > 5, "{drawn:?}");
    assert_eq!(drawn, lines("scene.svg"));
    let film = [
        "film",
        "model.gltf",
        "--speeds",
        "0.5",
        "--pictures",
        "2",
        "--beside",
        "diagram",
    ];
    made(&[&film[..], &["-o", "film.apng"], &small[..]].concat());
}

#[test]
fn display_settings_that_do_not_set_the_exposure_leave_it_as_it_is() {
    let folder = folder(1.0);
    let scene = |set: &[&str]| {
        let print = ["render", "model.gltf", "--print-scene"];
        folder.ok(&[&print[..], set].concat())
    };
    let white = |text: &str| {
        let line = text.lines().find(|line| line.starts_with("white = "));
        line.map(str::to_owned)
    };
    let exposed = white(&scene(&[]));
    assert!(exposed.is_some());
    assert_eq!(white(&scene(&["--set", "display.bits=16"])), exposed);
    let said = white(&scene(&["--set", "display.white=0.25"]));
    assert_eq!(said.as_deref(), Some("white = 0.25"));
    assert_eq!(white(&scene(&["--set", "display.exposure=\"90 %\""])), None);
    // The scale of a fast fly-by is logarithmic, which no user wrote.
    let fast = ["--flyby", "--beta", "0.9", "--set", "display.white=0.25"];
    assert!(scene(&fast[..3]).contains("logarithmic = "));
    assert_eq!(white(&scene(&fast)).as_deref(), Some("white = 0.25"));
}

#[test]
fn a_model_is_exposed_for_what_its_lamps_light_unless_it_is_mostly_lamp() {
    let folder = folder(1.0);
    let text = String::from_utf8(folder.read("model.gltf")).unwrap();
    // White with a second square beside the model, of this size and with this emission.
    let white = |size: f64, strength: f64| {
        let mut model: serde_json::Value = serde_json::from_str(&text).unwrap();
        let place = [4.6 - 3.0 * size, 1.0 - size, -2.0 + 2.0 * size];
        model["nodes"] = json!([{ "mesh": 0 }, { "mesh": 1, "translation": place, "scale": [size, size, size] }]);
        let (mut mesh, mut shining) = (model["meshes"][0].clone(), model["materials"][0].clone());
        mesh["primitives"][0]["material"] = json!(1);
        shining["emissiveFactor"] = json!([1, 1, 1]);
        shining["extensions"] =
            json!({ "KHR_materials_emissive_strength": { "emissiveStrength": strength } });
        model["meshes"].as_array_mut().unwrap().push(mesh);
        model["materials"].as_array_mut().unwrap().push(shining);
        folder.write("two.gltf", model.to_string());
        let scene = folder.ok(&["render", "two.gltf", "--print-scene"]);
        let line = scene.lines().find_map(|line| line.strip_prefix("white = "));
        line.unwrap().parse::<f64>().unwrap()
    };
    let unlit = white(0.5, 0.0);
    assert!((0.1..3.0).contains(&unlit), "{unlit}");
    // The lamp does not light the square beside it, which is in its plane.
    assert!((white(0.5, 100.0) / unlit - 1.0).abs() < 0.05);
    assert!((100.0..103.0).contains(&white(2.0, 100.0)));
}

#[test]
fn glass_of_a_model_is_seen_through_and_is_called_opaque_where_no_light_is_followed() {
    let folder = folder(1.0);
    let text = folder.ok(&["render", "model.gltf", "--print-scene"]);
    assert!(!text.contains("bounces"), "{text}");
    let solid = std::fs::read_to_string(folder.path("model.gltf")).unwrap();
    let extension = r#""doubleSided":true,"extensions":{"KHR_materials_transmission":{"transmissionFactor":1.0}}"#;
    let glass = solid.replace("\"doubleSided\":true", extension);
    assert_ne!(solid, glass);
    folder.write("model.gltf", glass);
    let text = folder.ok(&["render", "model.gltf", "--print-scene"]);
    assert!(text.contains("\n[render]\nbounces = 8\n"), "{text}");
    for (bounces, is_said) in [("render.bounces=0", true), ("render.bounces=2", false)] {
        let planned = folder.ok(&["plan", "model.gltf", "--set", bounces]);
        let rendered = folder.ok(&[
            &["render", "model.gltf", "--set", bounces, "-o", "a.png"],
            &SIZE[..],
        ]
        .concat());
        for said in [planned, rendered] {
            let opaque = "the glass of \"model\" is opaque without `render.bounces`";
            assert_eq!(said.contains(opaque), is_said, "{bounces}: {said}");
        }
    }
}

#[test]
fn lights_of_a_model_keep_their_names() {
    let folder = folder(1.0);
    let mut model: serde_json::Value = serde_json::from_slice(&folder.read("model.gltf")).unwrap();
    let lamp = |name: &str| json!({ "name": name, "extensions": { "KHR_lights_punctual": { "light": 0 } } });
    model["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    model["extensions"] =
        json!({ "KHR_lights_punctual": { "lights": [{ "type": "point", "name": "bulb" }] } });
    let names = ["left \"one\"", "same", "same", "emission", ""];
    model["nodes"] = json!([{ "mesh": 0 }]);
    let nodes = model["nodes"].as_array_mut().unwrap();
    nodes.extend(names.map(lamp));
    folder.write("lamps.gltf", model.to_string());
    for flash in [&[][..], &["--flash"]] {
        let printed = folder.ok(&[&["render", "lamps.gltf", "--print-scene"], flash].concat());
        if flash.is_empty() {
            let own = printed.lines().filter(|line| line.starts_with("name = "));
            let own: Vec<&str> = own.map(|line| &line[7..]).collect();
            let wanted = [
                "'left \"one\"'",
                "\"same\"",
                "\"same-2\"",
                "\"emission-2\"",
                "\"bulb\"",
            ];
            assert_eq!(own, wanted);
        }
    }
    folder.ok(&["bake", "lamps.gltf", "--flash", "--plan"]);
}
