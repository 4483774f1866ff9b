//! Lights that a scene takes from a glTF file.

use glam::DVec3;
use nullray::error::Result;
use nullray::scene::model::{Beam, Lamp, Light, LightKind, Motion, Scene};
use nullray::scene::{Builder, Overrides, parse};
use tempfile::TempDir;

use crate::scene_file::problem;

/// Nodes 0 "mast" (at y = 1) above 1 "lamp" (a point at y = 3), 2 "torch" (a spot along −z at x = 1), 3 without a name (the light "sun"), and
/// 4 "desk" without a light.
const LIGHTS: &str = r#"{
    "asset": { "version": "2.0" }, "extensionsUsed": ["KHR_lights_punctual"],
    "extensions": { "KHR_lights_punctual": { "lights": [
        { "type": "point", "color": [1, 0.5, 0.25], "intensity": 8 },
        { "type": "spot", "intensity": 3, "spot": { "innerConeAngle": 0.25, "outerConeAngle": 0.5 } },
        { "type": "directional", "name": "sun", "intensity": 2 }
    ] } },
    "nodes": [
        { "name": "mast", "translation": [0, 1, 0], "children": [1] },
        { "name": "lamp", "translation": [0, 2, 0], "extensions": { "KHR_lights_punctual": { "light": 0 } } },
        { "name": "torch", "translation": [1, 0, 0], "extensions": { "KHR_lights_punctual": { "light": 1 } } },
        { "extensions": { "KHR_lights_punctual": { "light": 2 } } },
        { "name": "desk" }
    ]
}"#;

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.gltf"), LIGHTS).unwrap();
    folder
}

fn text(keys: &str) -> String {
    format!(
        "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n[[object]]\nshape = {{ sphere = {{ radius = 1 }} }}\n\
         [[light]]\n{keys}\n"
    )
}

fn scene(keys: &str, overrides: &Overrides) -> Result<Scene> {
    parse(&text(keys), "scene.toml", folder().path(), overrides)
}

fn lamp(light: &Light) -> &Lamp {
    match &light.kind {
        LightKind::Lamp(lamp) => lamp,
        LightKind::Area { .. } => panic!("not a lamp"),
    }
}

/// The lamp of a light with these keys.
fn taken(keys: &str) -> Lamp {
    let scene = scene(keys, &Overrides::default());
    let scene = scene.unwrap_or_else(|error| panic!("{}", error.report(false)));
    lamp(&scene.lights[0]).clone()
}

#[test]
fn a_light_has_the_type_place_cone_and_brightness_of_its_node() {
    let point = taken("gltf = 'a.gltf'\nnode = 'lamp'");
    assert_eq!(point.beam, Beam::Point);
    assert_eq!(point.intensity, [8.0, 4.0, 2.0]);
    assert_eq!(point.origin.x, DVec3::new(0.0, 3.0, 0.0));
    // Below the node of that name.
    assert_eq!(taken("gltf = 'a.gltf'\nnode = 'mast'").origin, point.origin);
    let spot = taken("gltf = 'a.gltf'\nnode = 'torch'");
    let Beam::Spot { axis, inner, outer } = spot.beam else {
        panic!("{:?}", spot.beam);
    };
    assert_eq!((axis, spot.intensity), (DVec3::NEG_Z, [3.0; 3]));
    assert!((inner - 0.25).abs() < 1e-15 && (outer - 0.5).abs() < 1e-15);
    // By the name of the light itself, and by the number of its node.
    for node in ["sun", "node 3"] {
        let sun = taken(&format!("gltf = 'a.gltf'\nnode = '{node}'"));
        assert_eq!(sun.beam, Beam::Parallel(DVec3::NEG_Z));
        assert_eq!(sun.intensity, [2.0; 3]);
    }
}

#[test]
fn keys_of_the_table_replace_those_of_the_file() {
    let torch = "gltf = 'a.gltf'\nnode = 'torch'";
    let brighter = taken(&format!("{torch}\nintensity = 7\nouter = '1 rad'"));
    assert_eq!(brighter.intensity, [7.0; 3]);
    assert!(matches!(brighter.beam, Beam::Spot { outer, .. } if (outer - 1.0).abs() < 1e-15));
    let wide = taken(&format!(
        "{torch}\ntype = 'point'\npower = 12.566370614359172"
    ));
    assert_eq!((wide.beam, wide.intensity), (Beam::Point, [1.0; 3]));
    let elsewhere = taken(&format!(
        "{torch}\nposition = [0, 0, 4]\ndirection = [0, 2, 0]"
    ));
    assert_eq!(elsewhere.origin.x, DVec3::Z * 4.0);
    assert!(matches!(elsewhere.beam, Beam::Spot { axis, .. } if axis == DVec3::Y));
}

#[test]
fn a_light_of_a_file_moves_like_any_other() {
    let lamp = "gltf = 'a.gltf'\nnode = 'lamp'";
    let moving = taken(&format!("{lamp}\nvelocity = {{ beta = [0.5, 0, 0] }}"));
    assert!((moving.velocity.beta() - DVec3::X * 0.5).length() < 1e-15);
    assert_eq!(moving.origin.x, DVec3::new(0.0, 3.0, 0.0));
    let keyframes = "motion.keyframes = [{ time = '1 m', position = [0, 0, 7] }, \
                     { time = '3 m', position = [1, 0, 7] }]";
    let ridden = taken(&format!("{lamp}\n{keyframes}"));
    assert_eq!(ridden.origin.x, DVec3::Z * 7.0);
    assert!(matches!(ridden.motion, Motion::Keyframes(_)));
}

#[test]
fn lights_of_files_are_named_by_their_nodes_or_files_and_known_to_overrides() {
    let keys = "gltf = 'a.gltf'\nnode = 'torch'\n[[light]]\ngltf = 'a.gltf'\nnode = 'torch'";
    let set = |key: &str| Overrides {
        set: vec![(key.into(), "5".into())],
        ..Overrides::default()
    };
    let scene = scene(keys, &set("light.torch-2.intensity")).unwrap();
    let names: Vec<&str> = scene
        .lights
        .iter()
        .map(|light| light.name.as_str())
        .collect();
    assert_eq!(names, ["torch", "torch-2"]);
    let brightness = scene.lights.iter().map(|light| lamp(light).intensity[0]);
    assert_eq!(brightness.collect::<Vec<_>>(), [3.0, 5.0]);
    assert_eq!(scene.lights[0].gltf, scene.lights[1].gltf);
    assert!(scene.lights[0].gltf.as_ref().unwrap().ends_with("a.gltf"));
}

#[test]
fn a_program_takes_lights_from_files_like_a_scene() {
    let folder = folder();
    let built = Builder::from_toml("built", &text("position = [0, 0, 9]"))
        .folder(folder.path())
        .light("lit", [("gltf", "a.gltf".into()), ("node", "torch".into())])
        .build()
        .unwrap();
    let own = taken("gltf = 'a.gltf'\nnode = 'torch'");
    let built = lamp(&built.lights[1]);
    assert_eq!((built.beam, built.origin), (own.beam, own.origin));
}

#[test]
fn what_is_wrong_with_a_light_of_a_file_is_told_at_its_place() {
    let lights = "name one of: \"lamp\", \"torch\", \"sun\"";
    for (keys, place, what, help) in [
        (
            "gltf = 'a.gltf'\nnode = 'desk'",
            "light \"desk\"",
            "nor a node of this name with one",
            lights,
        ),
        (
            "gltf = 'a.gltf'\nnode = 'none'",
            "light \"none\"",
            "there is no light of this name",
            lights,
        ),
        (
            "gltf = 'a.gltf'",
            "lights",
            "there are 3 lights to choose from",
            lights,
        ),
        (
            "gltf = 'b.gltf'",
            "light[0].gltf",
            "cannot find this file",
            "relative to the scene file",
        ),
        (
            "node = 'lamp'",
            "light[0].node",
            "no file is given",
            "add gltf",
        ),
        (
            "gltf = 'a.gltf'\nnode = ''",
            "light[0].node",
            "the node's name is empty",
            "leave the key out",
        ),
        (
            "gltf = 'a.gltf'\nnode = 'lamp'\ntype = 'directional'",
            "light[0].type",
            "the light of the file is of type \"point\", and cannot be of type \"directional\"",
            "leave `type` out",
        ),
        (
            "gltf = 'a.gltf'\nnode = 'sun'\ntype = 'area'",
            "light[0].type",
            "of type \"directional\", and cannot be of type \"area\"",
            "leave `type` out",
        ),
        (
            "gltf = 'a.gltf'\nnode = 'sun'\nintensity = 1",
            "light[0].intensity",
            "a light of type \"directional\" has no `intensity`",
            "leave it out",
        ),
        (
            "gltf = 'a.gltf'\nnode = 'torch'\ninner = '0.6 rad'",
            "light[0].gltf",
            "this is not a cone",
            "inner < outer",
        ),
    ] {
        let problem = problem(scene(keys, &Overrides::default()));
        assert!(problem.place.contains(place), "{keys}: {}", problem.place);
        assert!(problem.what.contains(what), "{keys}: {}", problem.what);
        assert!(
            problem.help.to_string().contains(help),
            "{keys}: {}",
            problem.help
        );
    }
}
