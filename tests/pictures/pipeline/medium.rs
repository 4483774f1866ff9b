//! Light in a medium: what reflects it, and what is refused there.

use nullray::render::aov::Aov;
use nullray::render::plan::{Plan, Request};
use nullray::scene::model::Scene;

use crate::pipeline::files::{self, Quad};
use crate::pipeline::stage::{self, above_plane, assert_relative};

/// A plane seen from straight above, with further keys, in a medium of this index under a sky of radiance 1.
fn plane(index: f64, bounces: u32, keys: &str) -> Scene {
    let text = above_plane(2, [0.0; 3], [0.0; 3], "");
    let text = text.replace(
        "colour = [1, 1, 1]\nvelocity = { beta = [0.0, 0.0, 0.0] }",
        keys,
    );
    stage::scene(&format!(
        "medium.index = {index}\nrender.bounces = {bounces}\n{text}\n[sky]\nradiance = 1"
    ))
}

#[test]
fn a_dielectric_reflects_by_its_index_over_that_of_the_medium_as_glass_does() {
    for (index, expected) in [(1.0, 0.04), (1.5, 0.0), (1.8, (0.3f64 / 3.3).powi(2))] {
        let black = "colour = [0, 0, 0]\nroughness = 0\nior = 1.5";
        let film = stage::film(&plane(index, 1, black));
        let seen = film.radiance()[0][1];
        assert!((seen - expected).abs() < 1e-6, "{index}: {seen}");
    }
}

#[test]
fn a_matte_surface_that_moves_in_a_medium_reflects_a_panel_as_in_vacuum() {
    // A white plane below a panel of radiance 1 that covers the half space. In the plane's rest frame it receives
    // ∫ W⁻⁴ cos θ′ dω′ = ∫ W⁻¹ cos θ dω = γ π, so it has the radiance γ, seen at W⁻⁴.
    for bounces in [0, 1] {
        let mut text = above_plane(16, [0.0; 3], [0.5, 0.0, 0.0], "");
        text += "
[[object]]
name = \"panel\"
shape = { plane = { size = [4e4, 4e4] } }
transform = { translate = [0, 4, 0], rotate = { axis = [1, 0, 0], angle = \"180 deg\" } }
colour = [0, 0, 0]
[[light]]
type = \"area\"
object = \"panel\"
[display]
samples_per_pixel = 64";
        let scene = format!("medium.index = 1.5\nrender.bounces = {bounces}\n{text}");
        let film = stage::rendered(&stage::scene(&scene), &stage::sampled()).unwrap();
        let all: Vec<usize> = (0..stage::pixels(&film)).collect();
        let w = stage::value(&film, Aov::WavelengthRatio, 0);
        let gamma = 1.0 / 0.75f64.sqrt();
        let mean = stage::mean(&film, &all)[1];
        assert_relative(mean, gamma / w.powi(4), 1e-2, format!("{bounces} bounces"));
    }
}

#[test]
fn what_moves_in_a_medium_and_is_not_matte_is_refused_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let textured = r#"{ "name": "paint", "pbrMetallicRoughness": {
        "metallicFactor": 0, "metallicRoughnessTexture": { "index": 0 } } }"#;
    let png = folder.path().join("grey.png");
    nullray::io::image::png::write(&png, 2, 2, &[128; 12], &[]).unwrap();
    let image = std::fs::read(png).unwrap();
    let quad = Quad {
        image: Some(&image),
        material: Some(textured),
        ..Quad::PLAIN
    };
    files::glb(&folder.path().join("quad.glb"), &quad);
    let planned = |index: f64, keys: &str, tables: &str| {
        let scene = stage::scene_in(
            folder.path(),
            &format!(
                "medium.index = {index}
[camera]
eye = [0, 2, 0]
look_at = [0, 0, -1]
size = [4, 4]
[[object]]
name = \"ship\"
{keys}
{tables}"
            ),
        );
        Plan::new(&scene, &Request::default()).map(|_| ())
    };
    let shape = "shape = { box = { size = [1, 1, 1] } }\n";
    let moves = "velocity = { beta = [0.1, 0, 0] }\n";
    let sky = "[sky]\nradiance = 1\n";
    let traced = "[sky]\nradiance = 1\n[render]\nbounces = 1\n";
    for (body, tables, words) in [
        (
            format!("{shape}metallic = 1\nroughness = 0"),
            sky,
            "is a mirror",
        ),
        (format!("{shape}metallic = 1"), sky, "has gloss"),
        (format!("{shape}roughness = 0.3"), traced, "has gloss"),
        (format!("{shape}transmission = 1"), traced, "is glass"),
        (
            "gltf = \"quad.glb\"".into(),
            sky,
            "has gloss, by its material \"paint\"",
        ),
    ] {
        let moving = format!("{body}\n{moves}");
        let error = planned(1.5, &moving, tables).unwrap_err();
        let said = error.to_string();
        assert!(
            said.contains("\"ship\" moves in a medium of index 1.5") && said.contains(words),
            "{body}: {said}"
        );
        assert!(error.help().contains("leave index = 1"), "{}", error.help());
        // In vacuum, and at rest.
        planned(1.0, &moving, tables).unwrap();
        planned(1.5, &body, tables).unwrap();
    }
    // Matte; opaque, as no light is traced; not lit; and with light of its own.
    for (body, tables) in [
        (shape.into(), traced),
        (format!("{shape}transmission = 1"), sky),
        (format!("{shape}roughness = 0.3"), ""),
        (
            format!("{shape}roughness = 0.3\nspectrum = {{ blackbody = \"4000 K\" }}"),
            "[sky]\nradiance = 1\n[radiance]\nquantity = \"rgb\"\n",
        ),
    ] {
        planned(1.5, &format!("{body}\n{moves}"), tables).unwrap();
    }
}
