//! Textures that cannot be shown, and materials that are approximated.

use std::path::PathBuf;

use crate::ALL;
use nullray::io::gltf::{self, Imported, Want};
use nullray::mesh::{AlphaMode, Material};
use nullray::scene::model::BadTextures;
use tempfile::TempDir;

const DROP: Want = Want {
    bad_textures: BadTextures::Drop,
    ..ALL
};

/// A PNG of one pixel of this type of colours: 2 is RGB, 6 RGBA. Its data are not checked when a model is read.
fn png(kind: u8, chunk: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\0\x01\0\0\0\x01\x08".to_vec();
    bytes.extend([kind, 0, 0, 0, 0, 0, 0, 0]);
    bytes.extend(chunk);
    bytes.extend(b"\0\0\0\0IDAT\0\0\0\0");
    bytes
}

/// A model of one triangle with this material; its texture 0 has the image `paint.png`, which exists if `image` has its bytes, and its texture 1
/// one that only an extension knows.
fn model(material: &str, image: Option<&[u8]>) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    if let Some(image) = image {
        std::fs::write(folder.path().join("paint.png"), image).unwrap();
    }
    let text = format!(
        r#"{{"asset": {{"version": "2.0"}}, "extensionsUsed": ["EXT_texture_webp"], "extensionsRequired": ["EXT_texture_webp"],
        "nodes": [{{"mesh": 0}}], "materials": [{{"name": "wall", {material}}}],
        "textures": [{{"source": 0}}, {{"extensions": {{"EXT_texture_webp": {{"source": 0}}}}}}],
        "images": [{{"uri": "paint.png", "name": "paint"}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "TEXCOORD_0": 1}}, "material": 0}}]}}],
        "buffers": [{{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}},
                      {{"componentType": 5126, "type": "VEC2", "count": 3}}]}}"#
    );
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

fn load(material: &str, image: Option<&[u8]>, want: Want) -> nullray::Result<Imported> {
    let (_folder, path) = model(material, image);
    gltf::load(&path, None, want)
}

fn material(material: &str, image: Option<&[u8]>) -> Material {
    let imported = load(material, image, ALL).unwrap();
    imported.mesh.materials[0].clone()
}

#[test]
fn textures_without_an_image_that_can_be_read_are_refused_or_left_out() {
    let textured = |index: usize| {
        format!(
            r#""pbrMetallicRoughness": {{"baseColorFactor": [0.5, 0.25, 0.125, 1], "baseColorTexture": {{"index": {index}}}}}"#
        )
    };
    let webp = b"RIFF\x04\0\0\0WEBPVP8 ";
    let ktx = b"\xabKTX 20\xbb\r\n\x1a\n";
    for (index, image, place, what, help) in [
        (0, None, "image 0 \"paint\"", "cannot be read", "must be at"),
        (
            0,
            Some(&webp[..]),
            "image 0 \"paint\"",
            "it is neither PNG nor JPEG",
            "`gltf-transform png IN.glb OUT.glb --formats \"*\"`",
        ),
        (
            0,
            Some(&ktx[..]),
            "image 0 \"paint\"",
            "it is neither PNG nor JPEG",
            "`gltf-transform ktxdecompress IN.glb OUT.glb`",
        ),
        (
            1,
            None,
            "material 0 \"wall\", texture 1",
            "it has no image, or one that only an extension knows",
            "gltf-transform",
        ),
    ] {
        let error = load(&textured(index), image, ALL).unwrap_err();
        let said = error.to_string();
        assert!(said.contains(place) && said.contains(what), "{said}");
        let remedy = error.help();
        assert!(remedy.contains(help), "{remedy}");
        assert!(
            remedy.ends_with("bad_textures = \"drop\" leaves them out"),
            "{remedy}"
        );

        let imported = load(&textured(index), image, DROP).unwrap();
        let [told] = &imported.warnings[..] else {
            panic!("one warning, not {:?}", imported.warnings);
        };
        let start = format!("{place}: its texture is left out: ");
        assert!(told.starts_with(&start) && told.contains(what), "{told}");
        let [material] = &imported.mesh.materials[..] else {
            panic!("one material");
        };
        assert_eq!(material.base_colour, [0.5, 0.25, 0.125]);
        assert!(material.base_colour_texture.is_none());
    }
}

/// What is shown at half the alpha of the texture does not depend on the factor.
#[test]
fn blending_by_a_texture_with_alpha_becomes_a_mask_at_one_half() {
    let blend = |index: &str| {
        format!(
            r#""alphaMode": "BLEND", "pbrMetallicRoughness": {{"baseColorFactor": [1, 1, 1, 0.5]{index}}}"#
        )
    };
    let textured = blend(r#", "baseColorTexture": {"index": 0}"#);
    let mask = AlphaMode::Mask { cutoff: 0.25 };
    // A palette with a transparent colour has an alpha, too.
    let transparent = png(3, b"\0\0\0\0tRNS\0\0\0\0");
    for (text, image, mode) in [
        (&textured, png(6, b""), mask),
        (&textured, png(4, b""), mask),
        (&textured, transparent, mask),
        (&textured, png(2, b""), AlphaMode::Blend),
        (&textured, b"\xff\xd8\xff\xe0".to_vec(), AlphaMode::Blend),
        (&blend(""), png(6, b""), AlphaMode::Blend),
    ] {
        assert_eq!(material(text, Some(&image)).alpha_mode, mode, "{text}");
    }
    let told = load(&textured, Some(&png(6, b"")), ALL).unwrap().warnings;
    assert!(
        told[0].contains("with an alpha below a half is left out"),
        "{told:?}"
    );
    let told = load(&blend(""), None, ALL).unwrap().warnings;
    assert!(told[0].ends_with("the surface is opaque"), "{told:?}");
}

#[test]
fn of_a_diffuse_and_a_specular_colour_the_diffuse_one_is_shown() {
    let glossy = |more: &str, pbr: &str| {
        format!(
            r#"{pbr} "extensions": {{"KHR_materials_pbrSpecularGlossiness": {{"diffuseFactor": [0.5, 0.25, 0.125, 1], "glossinessFactor": 0.75,
            "diffuseTexture": {{"index": 0}}{more}}}}}"#
        )
    };
    let image = png(2, b"");
    let shown = material(&glossy("", ""), Some(&image));
    assert_eq!(shown.base_colour, [0.5, 0.25, 0.125]);
    assert!(shown.base_colour_texture.is_some());
    assert_eq!((shown.metallic, shown.roughness), (0.0, 0.25));
    let texture = r#", "specularGlossinessTexture": {"index": 0}"#;
    assert_eq!(material(&glossy(texture, ""), Some(&image)).roughness, 1.0);
    // What the file gives for programs without the extension comes first.
    let own = r#""pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]},"#;
    let shown = material(&glossy("", own), Some(&image));
    assert_eq!(shown.base_colour, [1.0, 0.0, 0.0]);
    let told = load(&glossy("", ""), Some(&image), ALL).unwrap().warnings;
    assert!(told[0].contains("only the diffuse colour"), "{told:?}");
    assert_eq!(told.len(), 1);
}

/// Without `metallicFactor` a material is a metal.
#[test]
fn an_unlit_material_is_matte_where_it_reflects_light() {
    let unlit = r#""extensions": {"KHR_materials_unlit": {}}"#;
    let shown = material(unlit, None);
    assert_eq!(
        (shown.unlit, shown.metallic, shown.roughness),
        (true, 0.0, 1.0)
    );
}

/// A PNG of these greys in one row.
fn greys(values: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, values.len() as u32, 1);
    encoder.set_color(png::ColorType::Grayscale);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(values).unwrap();
    writer.finish().unwrap();
    bytes
}

/// By the extension the transmitted part is transmissionFactor times the red of the texture.
#[test]
fn a_texture_of_transmission_is_a_factor_if_it_is_even_and_else_its_mean_decides() {
    let glass = r#""pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0}, "extensions": {
        "KHR_materials_transmission": {"transmissionFactor": 0.8, "transmissionTexture": {"index": 0}},
        "KHR_materials_volume": {"thicknessFactor": 1, "thicknessTexture": {"index": 0}, "attenuationDistance": 1}}"#;
    let parts = "material 0 \"wall\": its transmissionTexture makes ";
    for (values, expected, warning) in [
        (&[0, 0, 0, 0][..], 0.0, None),
        (&[255, 255], 0.8, None),
        (&[128, 130, 129], 0.8 * 129.0 / 255.0, None),
        (&[255, 0, 255], 0.8, Some("all of it is glass")),
        (&[0, 255, 0], 0.0, Some("all of it is opaque")),
    ] {
        let (_folder, path) = model(glass, Some(&greys(values)));
        let imported = gltf::load(&path, None, ALL).unwrap();
        let material = &imported.mesh.materials[0];
        assert!(
            (material.transmission - expected).abs() < 1e-6,
            "{values:?}: {}",
            material.transmission
        );
        let said: Vec<_> = imported
            .warnings
            .iter()
            .filter(|w| w.starts_with(parts))
            .collect();
        assert_eq!(
            said.len(),
            usize::from(warning.is_some()),
            "{values:?}: {said:?}"
        );
        assert!(
            warning.is_none_or(|part| said[0].contains(part)),
            "{values:?}: {said:?}"
        );
        // What is not computed of glass concerns only glass.
        for what in [
            "thicknessTexture is not read",
            "absorption in glass is not computed",
        ] {
            let is_said = imported.warnings.iter().any(|w| w.contains(what));
            assert_eq!(is_said, expected > 0.0, "{values:?}: {what}");
        }
        // A plan knows the same.
        let held = gltf::inspect(&path, None).unwrap();
        assert_eq!(held.factors, [material.factors()]);
        assert_eq!(held.warnings, imported.warnings);
    }
}

#[test]
fn a_texture_of_transmission_that_cannot_be_read_is_refused_or_left_out() {
    let glass = |index: usize| {
        format!(
            r#""extensions": {{"KHR_materials_transmission": {{"transmissionFactor": 0.5, "transmissionTexture": {{"index": {index}}}}}}}"#
        )
    };
    for index in [0, 1] {
        for image in [None, Some(&b"RIFF"[..]), Some(b"\x89PNG\r\n\x1a\n\0")] {
            let refusal = load(&glass(index), image, ALL).unwrap_err();
            let place = ["image 0 \"paint\"", "texture 1"][index];
            assert!(refusal.to_string().contains(place), "{refusal}");
            if index == 0 && image.is_none() {
                continue;
            }
            let kept = load(&glass(index), image, DROP).unwrap();
            assert_eq!(kept.mesh.materials[0].transmission, 0.5);
            let is_told = |warning: &String| warning.contains("its texture is left out");
            assert!(kept.warnings.iter().any(is_told), "{:?}", kept.warnings);
        }
    }
    // Without the image, a file can be looked into.
    let (_folder, path) = model(&glass(0), None);
    assert_eq!(
        gltf::inspect(&path, None).unwrap().factors[0].transmission,
        0.5
    );
    let wrong = glass(0).replace(r#"{"index": 0}"#, "7");
    let refusal = load(&wrong, None, ALL).unwrap_err().to_string();
    assert!(
        refusal.contains("its transmissionTexture cannot be read"),
        "{refusal}"
    );
}

#[test]
fn nodes_and_cameras_without_names_are_found_by_their_numbers() {
    let (_folder, path) = model(r#""doubleSided": true"#, None);
    let text = std::fs::read_to_string(&path).unwrap();
    let nodes = r#""nodes": [{"mesh": 0}, {"camera": 0}, {"camera": 1, "translation": [0, 0, 5]}, {"name": "node 1", "mesh": 0}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}},
                    {"type": "perspective", "perspective": {"yfov": 0.5, "znear": 1}}]"#;
    std::fs::write(&path, text.replace(r#""nodes": [{"mesh": 0}]"#, nodes)).unwrap();
    let names = gltf::inspect(&path, None).unwrap().cameras;
    assert_eq!(names, ["node 1", "node 2"]);
    let camera = gltf::camera(&path, Some("node 2")).unwrap();
    assert_eq!((camera.eye.z, camera.vertical_fov), (5.0, 0.5));
    let error = gltf::camera(&path, None).unwrap_err();
    assert!(
        error.help().contains("\"node 1\", \"node 2\""),
        "{}",
        error.help()
    );
    let parts = gltf::load(&path, Some("node 0"), ALL).unwrap().mesh.parts;
    assert_eq!(parts[0].node, "node 0");
}

#[test]
fn the_default_material_is_told_from_those_without_a_name() {
    let (_folder, path) = model("\"name\": \"\"", None);
    let text = std::fs::read_to_string(&path).unwrap();
    let text = text.replace("\"name\": \"wall\", ", "");
    std::fs::write(&path, &text).unwrap();
    let held = gltf::inspect(&path, None).unwrap();
    assert_eq!((held.materials.len(), held.default_material), (1, None));
    std::fs::write(&path, text.replace(", \"material\": 0", "")).unwrap();
    let held = gltf::inspect(&path, None).unwrap();
    assert_eq!((held.materials.len(), held.default_material), (1, Some(0)));
}
