//! Models without a scene of which a part cannot be shown, and what is said of it.

use nullray::io::image::exr;
use serde_json::{Value, json};

use super::Folder;

/// A folder with `model.gltf`: a square that faces +z, with this material, and a triangle beside it with a corner at `x`.
fn folder(material: &Value, x: f32) -> Folder {
    let corners = [
        [-1f32, -1.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, 1.0, 0.0],
        [-1.0, -1.0, 0.0],
        [1.0, 1.0, 0.0],
        [-1.0, 1.0, 0.0],
        [1.0, -1.0, 0.0],
        [x, -1.0, 0.0],
        [1.0, 0.0, 0.0],
    ];
    let mut document = json!({
        "asset": { "version": "2.0" },
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "material": 0 }] }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 9, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0] },
            { "componentType": 5126, "count": 9, "type": "VEC2" }],
        "bufferViews": [{ "buffer": 0, "byteLength": 108 }],
        "buffers": [{ "byteLength": 108, "uri": "model.bin" }],
        "textures": [{ "source": 0 }],
        "images": [{ "uri": "gone.png" }],
        "materials": [material],
    });
    if material.is_null() {
        let document = document.as_object_mut().unwrap();
        document.remove("materials");
        let primitive = document["meshes"][0]["primitives"][0].as_object_mut();
        primitive.unwrap().remove("material");
    }
    let bytes = corners.iter().flatten().flat_map(|c| c.to_le_bytes());
    let folder = Folder::empty();
    folder.write("model.gltf", document.to_string());
    folder.write("model.bin", bytes.collect::<Vec<u8>>());
    folder
}

#[test]
fn a_model_is_shown_without_a_missing_texture_and_without_triangles_that_have_nan() {
    let white = json!({ "pbrMetallicRoughness": { "metallicFactor": 0.0, "baseColorTexture": { "index": 0 } } });
    let folder = folder(&white, f32::NAN);
    let small = ["--size", "32x24", "--spp", "1"];
    let shown = [&["render", "model.gltf", "-o", "a.exr"][..], &small].concat();
    let run = folder.run(&shown);
    assert_eq!(run.code, 0, "{}", run.message());
    for said in [
        "image 0: its texture is left out: its data cannot be read",
        "triangles with a vertex that is not finite are dropped",
    ] {
        assert_eq!(run.message().matches(said).count(), 1, "{}", run.message());
    }
    // The scene that is printed shows the same.
    let printed = folder.run(&[&["render", "model.gltf", "--print-scene"][..], &small].concat());
    folder.write("scene.toml", &printed.stdout);
    folder.ok(&["render", "scene.toml", "--spp", "1", "-o", "b.exr"]);
    let [a, b] = ["a.exr", "b.exr"].map(|name| {
        let picture = exr::read(&folder.path(name), &Default::default()).unwrap();
        picture.channels
    });
    assert!(a == b);
    // A scene that does not say so is refused, with the key that does.
    for (key, said) in [
        ("bad_textures", "bad_textures = \"drop\" leaves them out"),
        (
            "bad_vertices",
            "bad_vertices = \"drop\" leaves their triangles out",
        ),
    ] {
        let drops = format!("{key} = \"drop\"\n");
        assert!(printed.stdout.contains(&drops), "{}", printed.stdout);
        folder.write("scene.toml", printed.stdout.replace(&drops, ""));
        let run = folder.run(&["render", "scene.toml", "-o", "c.png"]);
        assert_eq!(run.code, 2);
        assert!(run.message().contains(said), "{}", run.message());
    }
}

#[test]
fn a_flash_on_a_model_without_materials_says_why_there_is_none() {
    let folder = folder(&Value::Null, 2.0);
    let run = folder.run(&["render", "model.gltf", "--flash"]);
    assert_eq!(run.code, 2);
    let said = run.message();
    assert!(
        said.contains("it has no materials, and the default of glTF is metal"),
        "{said}"
    );
    let info = folder.ok(&["info", "model.gltf"]);
    for said in [
        "materials   1: (the default of glTF, a white metal)",
        "metres, as the file declares them",
    ] {
        assert!(info.contains(said), "{info}");
    }
}

/// Its metalness, which is 1 unless the file says otherwise, does not count.
#[test]
fn an_unlit_model_flashes() {
    let folder = folder(&json!({ "extensions": { "KHR_materials_unlit": {} } }), 2.0);
    folder.ok(&["bake", "model.gltf", "--flash", "--plan"]);
}

#[test]
fn speeds_take_the_unit_c() {
    let folder = folder(&json!({ "name": "paint" }), 2.0);
    let scene = |beta: &str| folder.ok(&["render", "model.gltf", "--beta", beta, "--print-scene"]);
    assert_eq!(scene("0.9c"), scene("0.9"));
    let run = folder.run(&["render", "model.gltf", "--beta", "fast"]);
    assert!(
        run.message().contains("write v/c as a number, like 0.9"),
        "{}",
        run.message()
    );
}
