//! Positions of animated glTF nodes, and of cameras and lights that follow them.

use std::path::{Path, PathBuf};

use glam::DVec3;
use nullray::io::gltf;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::{render, survey};
use nullray::scene::{self, Overrides};

/// A glTF file whose node "tip" hangs two metres along x from "arm", which turns by a right angle about y within a second;
/// "cart" goes from x = 0 to 3 m in two seconds, and in two more as far to the side, and jumps by animation "jump".
fn animated(folder: &Path) -> PathBuf {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let floats = [
        0.0, 1.0, // seconds of the turn
        0.0, 0.0, 0.0, 1.0, 0.0, half, 0.0, half, // its rotations
        0.0, 2.0, 4.0, // seconds of the cart
        0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 3.0, 0.0, -3.0, // its places
    ];
    let bytes: Vec<u8> = floats.iter().flat_map(|f: &f32| f.to_le_bytes()).collect();
    std::fs::write(folder.join("animated.bin"), &bytes).unwrap();
    let view = |offset: usize, length: usize| {
        format!(
            "{{ \"buffer\": 0, \"byteOffset\": {}, \"byteLength\": {} }}",
            4 * offset,
            4 * length
        )
    };
    let accessor = |view: usize, count: usize, kind: &str| {
        format!(
            "{{ \"bufferView\": {view}, \"componentType\": 5126, \"count\": {count}, \"type\": \"{kind}\" }}"
        )
    };
    let channel = |node: usize, path: &str| {
        format!("{{ \"sampler\": 0, \"target\": {{ \"node\": {node}, \"path\": \"{path}\" }} }}")
    };
    let animation = |name: &str, channel: String, input: usize, how: &str| {
        let sampler = format!(
            "{{ \"input\": {input}, \"output\": {}, \"interpolation\": \"{how}\" }}",
            input + 1
        );
        format!("{{ \"name\": \"{name}\", \"channels\": [{channel}], \"samplers\": [{sampler}] }}")
    };
    let text = format!(
        "{{ \"asset\": {{ \"version\": \"2.0\" }}, \
           \"nodes\": [{{ \"name\": \"arm\", \"translation\": [0, 1, 0], \"children\": [1] }}, \
                       {{ \"name\": \"tip\", \"translation\": [2, 0, 0] }}, {{ \"name\": \"cart\" }}], \
           \"animations\": [{}, {}, {}], \
           \"buffers\": [{{ \"uri\": \"animated.bin\", \"byteLength\": {} }}], \
           \"bufferViews\": [{}, {}, {}, {}], \"accessors\": [{}, {}, {}, {}] }}",
        animation("turn", channel(0, "rotation"), 0, "LINEAR"),
        animation("drive", channel(2, "translation"), 2, "LINEAR"),
        animation("jump", channel(2, "translation"), 2, "STEP"),
        bytes.len(),
        view(0, 2),
        view(2, 8),
        view(10, 3),
        view(13, 9),
        accessor(0, 2, "SCALAR"),
        accessor(1, 2, "VEC4"),
        accessor(2, 3, "SCALAR"),
        accessor(3, 3, "VEC3"),
    );
    let path = folder.join("animated.gltf");
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn an_animated_node_goes_where_those_above_it_take_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = animated(folder.path());
    let tip = gltf::track(&path, "tip", Some("turn")).unwrap();
    assert!(tip.turns);
    let tip = tip.points;
    assert!(tip.len() > 9);
    for (seconds, at) in tip {
        // About y, from +x towards −z.
        let (sin, cos) = (seconds * std::f64::consts::FRAC_PI_2).sin_cos();
        let expected = DVec3::new(2.0 * cos, 1.0, -2.0 * sin);
        assert!((at - expected).length() < 1e-7, "{at} at {seconds} s");
    }
    let cart = gltf::track(&path, "cart", Some("drive")).unwrap();
    assert!(!cart.turns);
    let cart = cart.points;
    let side = DVec3::new(3.0, 0.0, -3.0);
    assert_eq!(
        cart,
        [(0.0, DVec3::ZERO), (2.0, DVec3::X * 3.0), (4.0, side)]
    );
}

#[test]
fn animations_that_are_no_way_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = animated(folder.path());
    for (node, animation, said) in [
        ("cart", Some("jump"), "faster than light"),
        ("cart", Some("turn"), "does not move it"),
        ("cart", Some("fly"), "no animation \"fly\""),
        ("cart", None, "3 animations to choose from"),
        ("cat", Some("drive"), "no node of this name"),
    ] {
        let error = gltf::track(&path, node, animation).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
    // A matrix is not left out, and not kept in place of the animation.
    let text = std::fs::read_to_string(&path).unwrap();
    let matrix = "\"name\": \"cart\", \"matrix\": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1]";
    std::fs::write(&path, text.replace("\"name\": \"cart\"", matrix)).unwrap();
    let error = gltf::track(&path, "cart", Some("drive")).unwrap_err();
    let error = error.to_string();
    assert!(
        error.contains("node 2 \"cart\"") && error.contains("`matrix`"),
        "{error}"
    );
}

#[test]
fn channels_without_a_node_are_passed_over_and_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = animated(folder.path());
    let before = gltf::track(&path, "tip", Some("turn")).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let pointer = "{ \"sampler\": 0, \"target\": { \"path\": \"pointer\", \"extensions\": \
                   { \"KHR_animation_pointer\": { \"pointer\": \"/materials/0/emissiveFactor\" } } } }, ";
    let first = "\"channels\": [";
    std::fs::write(&path, text.replacen(first, &format!("{first}{pointer}"), 1)).unwrap();
    // The channels that have a node are as before.
    let tip = gltf::track(&path, "tip", Some("turn")).unwrap();
    assert_eq!(tip, before);
    let said = "animation 0, channel 0: it animates something other than a node, and is not played";
    let mesh =
        "\"meshes\": [{ \"primitives\": [{ \"attributes\": { \"POSITION\": 3 } }] }], \"nodes\"";
    let text = std::fs::read_to_string(&path).unwrap();
    let text = text.replacen("\"nodes\"", mesh, 1);
    let cart = "\"name\": \"cart\"";
    std::fs::write(&path, text.replace(cart, &format!("{cart}, \"mesh\": 0"))).unwrap();
    let held = gltf::inspect(&path, None).unwrap();
    assert!(
        held.warnings.iter().any(|warning| warning == said),
        "{:?}",
        held.warnings
    );
}

/// `nodes` in a row, each turned by the same `keys`, and "tip" below them.
fn turned_by_all(folder: &Path, nodes: usize, keys: usize) -> PathBuf {
    let times = (0..keys).flat_map(|k| (k as f32).to_le_bytes());
    let rotations = (0..keys).flat_map(|_| [0, 0, 0, 127]);
    let bytes: Vec<u8> = times.chain(rotations).collect();
    std::fs::write(folder.join("turned.bin"), &bytes).unwrap();
    let node = |i: usize| format!("{{\"children\": [{}]}}, ", i + 1);
    let channel = |i: usize| {
        format!("{{\"sampler\": 0, \"target\": {{\"node\": {i}, \"path\": \"rotation\"}}}}")
    };
    let channels: Vec<String> = (0..nodes).map(channel).collect();
    let all: String = (0..nodes).map(node).collect();
    let text = format!(
        r#"{{"asset": {{"version": "2.0"}}, "nodes": [{all}{{"name": "tip"}}],
        "animations": [{{"samplers": [{{"input": 0, "output": 1}}], "channels": [{}]}}],
        "buffers": [{{"uri": "turned.bin", "byteLength": {}}}],
        "bufferViews": [{{"buffer": 0, "byteLength": {}}}, {{"buffer": 0, "byteOffset": {}, "byteLength": {}}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": {keys}, "type": "SCALAR"}},
        {{"bufferView": 1, "componentType": 5120, "normalized": true, "count": {keys}, "type": "VEC4"}}]}}"#,
        channels.join(", "),
        8 * keys,
        4 * keys,
        4 * keys,
        4 * keys
    );
    let path = folder.join("turned.gltf");
    std::fs::write(&path, text).unwrap();
    path
}

/// A small file may name the same keys many times: what they cost is known, and refused, before it is spent.
#[test]
fn animations_of_more_keys_points_or_transforms_than_a_path_needs_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (nodes, keys, said) in [
        (3, 10, None),
        // 1.2 million values.
        (12, 100_000, Some("more than 1000000 values")),
        // Eight pieces between two keys.
        (1, 12_502, Some("its path has 100009 points")),
        // 8009 points by 801 nodes and 800 channels.
        (800, 1002, Some("by 801 nodes and 800 channels")),
    ] {
        let path = turned_by_all(folder.path(), nodes, keys);
        match (gltf::track(&path, "tip", None), said) {
            (Ok(track), None) => assert_eq!(track.points.len(), 8 * (keys - 1) + 1),
            (Err(error), Some(said)) => {
                let text = error.to_string();
                assert!(text.contains(said), "{text}");
            }
            (other, said) => panic!("{other:?}, not {said:?}"),
        }
    }
}

#[test]
fn cameras_and_lights_follow_animated_nodes_slower_than_light() {
    let folder = tempfile::tempdir().unwrap();
    animated(folder.path());
    let scene = |speed: &str, node: &str, name: &str| {
        let follow = format!(
            "animation = {{ gltf = \"animated.gltf\", node = \"{node}\", name = \"{name}\" }}"
        );
        let text = format!(
            "speed_of_light = \"{speed}\"\n[camera]\nlook_at = [0, 0, -9]\nmotion.{follow}\n\
             [[light]]\nintensity = 1\nmotion.{follow}\n[[object]]\nshape = {{ sphere = {{ radius = 1 }} }}\n"
        );
        scene::parse(&text, "test scene", folder.path(), &Overrides::default())
    };
    // 3 m in two seconds, of which light goes 4 m: β = 0.75.
    let driven = scene("2 m/s", "cart", "drive").unwrap();
    assert!((driven.camera.velocity.beta() - DVec3::X * 0.75).length() < 1e-12);
    // And straight on, as LINEAR says, whatever comes after.
    let line = driven.camera.world_line().unwrap();
    let later = line.state(2.0 * (1.0f64 - 0.75 * 0.75).sqrt()).unwrap();
    assert!(
        (later.event.x - DVec3::X * 1.5).length() < 1e-12,
        "{later:?}"
    );
    let error = scene("1 m/s", "cart", "drive").unwrap_err();
    let (said, help) = (error.to_string(), error.help().to_string());
    assert!(
        said.contains("node \"cart\" moves at |β| = 1.5 between 0 s and 2 s"),
        "{said}"
    );
    assert!(help.contains("speed_of_light"), "{help}");
    assert!(driven.passed_over.is_empty());
    // The tip goes π metres in a second.
    let turned = scene("4 m/s", "tip", "turn").unwrap();
    let beta = turned.camera.velocity.beta().length();
    assert!((beta - std::f64::consts::FRAC_PI_4).abs() < 1e-6, "{beta}");
    assert!(scene("3.1 m/s", "tip", "turn").is_err());
    // Of its turn only the way is followed, which is said; a point light looks the same from all sides.
    assert_eq!(turned.passed_over.len(), 1);
    let said = &turned.passed_over[0];
    assert!(
        said.starts_with("the camera: node \"tip\" also rotates"),
        "{said}"
    );
}

/// Node (0 is the arm), property, interpolation, times and values.
type Channel<'a> = (usize, &'a str, &'a str, &'a [f32], &'a [&'a [f32]]);

/// A file whose camera "Cam" hangs at (r, 0, 0) from "Arm", with an animation of these channels.
fn swung(folder: &Path, r: f64, channels: &[Channel]) -> PathBuf {
    let (mut bytes, mut views, mut accessors) = (Vec::<u8>::new(), vec![], vec![]);
    let mut add = |rows: Vec<&[f32]>| {
        let kind = ["SCALAR", "", "VEC3", "VEC4"][rows[0].len() - 1];
        let own: Vec<u8> = rows.concat().iter().flat_map(|f| f.to_le_bytes()).collect();
        views.push(format!(
            r#"{{"buffer": 0, "byteOffset": {}, "byteLength": {}}}"#,
            bytes.len(),
            own.len()
        ));
        bytes.extend(own);
        accessors.push(format!(
            r#"{{"bufferView": {}, "componentType": 5126, "count": {}, "type": "{kind}"}}"#,
            accessors.len(),
            rows.len()
        ));
        accessors.len() - 1
    };
    let (mut targets, mut samplers) = (vec![], vec![]);
    for (k, (node, property, how, times, values)) in channels.iter().enumerate() {
        let [input, output] = [times.chunks(1).collect(), values.to_vec()].map(&mut add);
        samplers.push(format!(
            r#"{{"input": {input}, "output": {output}, "interpolation": "{how}"}}"#
        ));
        targets.push(format!(
            r#"{{"sampler": {k}, "target": {{"node": {node}, "path": "{property}"}}}}"#
        ));
    }
    std::fs::write(folder.join("swung.bin"), &bytes).unwrap();
    let text = format!(
        r#"{{"asset": {{"version": "2.0"}}, "nodes": [{{"name": "Arm", "children": [1]}},
        {{"name": "Cam", "camera": 0, "translation": [{r}, 0, 0]}}],
        "cameras": [{{"type": "perspective", "perspective": {{"yfov": 0.8, "znear": 0.1}}}}],
        "animations": [{{"channels": [{}], "samplers": [{}]}}],
        "buffers": [{{"uri": "swung.bin", "byteLength": {}}}], "bufferViews": [{}], "accessors": [{}]}}"#,
        targets.join(", "),
        samplers.join(", "),
        bytes.len(),
        views.join(", "),
        accessors.join(", ")
    );
    let path = folder.join("swung.gltf");
    std::fs::write(&path, text).unwrap();
    path
}

/// The scene whose camera follows "Cam" of that file, where light goes one metre in a second.
fn following(folder: &Path) -> nullray::Result<scene::model::Scene> {
    let text = "speed_of_light = \"1 m/s\"\n[camera]\ngltf = \"swung.gltf\"\nnode = \"Cam\"\n\
                motion.animation = { gltf = \"swung.gltf\", node = \"Cam\" }\n\
                [[object]]\nshape = { sphere = { radius = 1 } }\n";
    scene::parse(text, "test scene", folder, &Overrides::default())
}

/// The quaternion of half a turn about y: that from 0 to π turns by π t.
const HALF_TURN: &[f32] = &[0.0, 1.0, 0.0, 0.0];
const NO_TURN: &[f32] = &[0.0, 0.0, 0.0, 1.0];

/// x = 2t(1 − t)/c and rest elsewhere, by two CUBICSPLINE keys; the camera's own rotation and scale change nothing.
#[test]
fn translations_are_followed_exactly_whatever_the_node_does_about_its_own_origin() {
    let folder = tempfile::tempdir().unwrap();
    let zero: &[f32] = &[0.0; 3];
    let turns = (
        1,
        "rotation",
        "LINEAR",
        &[0.0, 0.5, 1.0][..],
        &[NO_TURN, HALF_TURN, NO_TURN][..],
    );
    let grows = (
        1,
        "scale",
        "LINEAR",
        &[0.0, 1.0][..],
        &[&[1.0; 3][..], &[3.0; 3]][..],
    );
    let bow = |slope: &[f32; 3]| {
        let back = slope.map(|v| -v);
        let rows: [&[f32]; 6] = [zero, zero, slope, &back, zero, zero];
        let moves = (1, "translation", "CUBICSPLINE", &[0.0, 1.0][..], &rows[..]);
        swung(folder.path(), 0.0, &[moves, turns, grows]);
        following(folder.path())
    };
    let line = bow(&[0.5, 0.0, 0.0]).unwrap().camera.world_line().unwrap();
    let end = line.rests().unwrap()[1];
    for part in 0..=20 {
        let state = line.state(end * f64::from(part) / 20.0).unwrap();
        let t = state.event.ct;
        let [place, velocity] = [0.5 * t * (1.0 - t), 0.5 - t].map(|x| DVec3::X * x);
        assert!((state.event.x - place).length() < 1e-14, "{t}: {state:?}");
        assert!((state.velocity.beta() - velocity).length() < 1e-13, "{t}");
    }
    // At its keys alone it is faster than light.
    let error = bow(&[1.0625, 0.0, 0.0]).unwrap_err().to_string();
    assert!(
        error.contains("node \"Cam\" moves at |β| = 1.0625 at"),
        "{error}"
    );
    // There and back at 15/16 of the speed of light.
    let places: [&[f32]; 3] = [zero, &[0.9375, 0.0, 0.0], zero];
    let times: &[f32] = &[0.0, 1.0, 2.0];
    let moves = (1, "translation", "LINEAR", times, &places[..]);
    swung(folder.path(), 0.0, &[moves, turns]);
    let line = following(folder.path())
        .unwrap()
        .camera
        .world_line()
        .unwrap();
    for (time, speed) in [(0.1, 0.9375), (0.3, 0.9375), (0.6, -0.9375)] {
        let state = line.state(time).unwrap();
        let place = 0.9375 * (1.0 - (1.0 - state.event.ct).abs());
        assert!((state.event.x.x - place).abs() < 1e-14, "{state:?}");
        assert!((state.velocity.beta().x - speed).abs() < 1e-14);
    }
}

/// Half a turn in two seconds, at half a metre from the axis: π/4 of the speed of light.
#[test]
fn an_arm_takes_a_camera_along_its_circle() {
    let folder = tempfile::tempdir().unwrap();
    let turn = (
        0,
        "rotation",
        "LINEAR",
        &[0.0, 2.0][..],
        &[NO_TURN, HALF_TURN][..],
    );
    let path = swung(folder.path(), 0.5, &[turn]);
    let line = following(folder.path())
        .unwrap()
        .camera
        .world_line()
        .unwrap();
    let (end, rate) = (line.rests().unwrap()[1], std::f64::consts::FRAC_PI_2);
    for part in 0..=300 {
        let state = line.state(end * f64::from(part) / 300.0).unwrap();
        let (sin, cos) = (rate * state.event.ct).sin_cos();
        let [place, velocity] =
            [(cos, -sin, 0.5), (-sin, -cos, 0.5 * rate)].map(|(x, z, r)| DVec3::new(x, 0.0, z) * r);
        // The bounds of the guide: 10⁻⁹ of the way, 10⁻⁶ of the velocity.
        assert!((state.event.x - place).length() < 1e-9, "{state:?}");
        assert!(
            (state.velocity.beta() - velocity).length() < 7e-7,
            "{state:?}"
        );
    }
    let points = gltf::track(&path, "Cam", None).unwrap().points.len();
    assert!((100..400).contains(&points), "{points}");
}

/// CUBICSPLINE with level tangents: (0, s, 0, 1 − s) with s = 3t² − 2t³, normalized, which is a turn by 2 atan(s/(1 − s)).
#[test]
fn a_camera_looks_where_its_channels_turn_it_at_the_time_of_the_shot() {
    let folder = tempfile::tempdir().unwrap();
    let level: &[f32] = &[0.0; 4];
    let rows = [level, NO_TURN, level, level, HALF_TURN, level];
    let turn = (1, "rotation", "CUBICSPLINE", &[0.0, 8.0][..], &rows[..]);
    swung(folder.path(), 0.25, &[turn]);
    let camera = following(folder.path()).unwrap().camera;
    for time in [0.5f64, 2.2, 3.1, 4.4, 7.0] {
        let t = time / 8.0;
        let s = t * t * (3.0 - 2.0 * t);
        let (sin, cos) = (2.0 * s.atan2(1.0 - s)).sin_cos();
        let [_, up, forward] = camera.at(time).axes;
        let expected = DVec3::new(-sin, 0.0, -cos);
        assert!((forward - expected).length() < 1e-14, "{time}: {forward}");
        assert!((up - DVec3::Y).length() < 1e-14, "{time}: {up}");
    }
}

#[test]
fn a_camera_of_the_file_turns_with_its_node_from_picture_to_picture() {
    let folder = tempfile::tempdir().unwrap();
    let path = animated(folder.path());
    // A camera on the tip and one on the arm, which turn from −z to −x within a second.
    let text = std::fs::read_to_string(&path).unwrap();
    let camera = "\"cameras\": [{ \"type\": \"perspective\", \"perspective\": { \"yfov\": 1, \"znear\": 1 } }], \"nodes\"";
    let text = text.replacen("\"nodes\"", camera, 1);
    let text = ["arm", "tip"].iter().fold(text, |text, name| {
        let name = format!("\"name\": \"{name}\"");
        text.replace(&name, &format!("{name}, \"camera\": 0"))
    });
    std::fs::write(&path, text).unwrap();
    let scene = |node: &str, keys: &str, time: f64| {
        let text = format!(
            "speed_of_light = \"4 m/s\"\n[camera]\n{keys}\n\
             motion.animation = {{ gltf = \"animated.gltf\", node = \"{node}\", name = \"turn\" }}\n\
             [[object]]\nshape = {{ sphere = {{ radius = 1 }} }}\n"
        );
        let overrides = Overrides {
            time: Some(format!("{time} m")),
            ..Overrides::default()
        };
        scene::parse(&text, "test scene", folder.path(), &overrides).unwrap()
    };
    for node in ["arm", "tip"] {
        // Before the first key, between keys, and after the last.
        for time in [-1.0, 0.0, 0.7, 2.0, 9.0] {
            let followed = scene(
                node,
                &format!("gltf = \"animated.gltf\"\nnode = \"{node}\""),
                time,
            );
            let camera = &followed.camera;
            let shot = camera.world_line().unwrap().state(time).unwrap().event;
            let angle = (shot.ct / 4.0).clamp(0.0, 1.0) * std::f64::consts::FRAC_PI_2;
            let forward = DVec3::new(-angle.sin(), 0.0, -angle.cos());
            let [right, up, ahead] = camera.axes;
            assert!((ahead - forward).length() < 1e-6, "{node}, {time}: {ahead}");
            assert!((up - DVec3::Y).length() < 1e-6, "{node}, {time}: {up}");
            assert!((right - forward.cross(up)).length() < 1e-6, "{right}");
            assert!(followed.passed_over.is_empty());
        }
    }
    // A direction of the scene's own is kept, and so is the one at which a shutter opens; both are said.
    let kept = scene("arm", "look_at = [0, 1, -9]", 2.0);
    assert!((kept.camera.axes[2] - DVec3::NEG_Z).length() < 1e-6);
    let open = "gltf = \"animated.gltf\"\nnode = \"arm\"\nshutter = { duration = \"1 m\" }";
    for (scene, said) in [
        (kept, "only its position is followed"),
        (scene("arm", open, 0.0), "as when it opened"),
    ] {
        assert_eq!(scene.passed_over.len(), 1);
        assert!(
            scene.passed_over[0].contains(said),
            "{:?}",
            scene.passed_over
        );
    }
}

#[test]
fn a_picture_without_objects_names_times_at_which_a_camera_that_turns_with_its_node_sees_some() {
    let folder = tempfile::tempdir().unwrap();
    let path = animated(folder.path());
    let text = std::fs::read_to_string(&path).unwrap();
    let camera = "\"cameras\": [{ \"type\": \"perspective\", \"perspective\": { \"yfov\": 0.6, \"znear\": 1 } }], \"nodes\"";
    let text = text.replacen("\"nodes\"", camera, 1);
    let text = text.replace("\"name\": \"tip\"", "\"name\": \"tip\", \"camera\": 0");
    std::fs::write(&path, text).unwrap();
    // The tip goes from (2, 1, 0) to (0, 1, -2) within 4 m and turns from −z to −x: early it looks at what lies far along −z.
    let seen = |time: &str| {
        let text = "speed_of_light = \"4 m/s\"\n[camera]\nsize = [32, 24]\ngltf = \"animated.gltf\"\nnode = \"tip\"\n\
                    motion.animation = { gltf = \"animated.gltf\", node = \"tip\", name = \"turn\" }\n\
                    [[object]]\nshape = { sphere = { radius = 1 } }\norigin = { position = [2, 1, -6] }\n";
        let overrides = Overrides {
            time: Some(time.into()),
            ..Overrides::default()
        };
        let scene = scene::parse(text, "test scene", folder.path(), &overrides).unwrap();
        let plan = Plan::new(&scene, &Request::default()).unwrap();
        let mut prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
        let met = render(&prepared, &Silent).unwrap().met();
        (met, survey::other_times(&scene, &mut prepared))
    };
    assert!(seen("0 m").0 > 0.0);
    let (met, times) = seen("2 m");
    assert_eq!(met, 0.0);
    let times = times.unwrap().to_string();
    let times: Vec<&str> = times.split('"').skip(1).step_by(2).collect();
    assert_eq!(times.len(), 2, "{times:?}");
    for time in times {
        assert!(seen(time).0 > 0.0, "{time}");
    }
}

/// glTF 2.0, appendix C: before the first key its value holds, and after the last that of the last. By light of before or after,
/// a lamp on the cart lights a wall as one at rest there does, and a camera on it stays where it is.
#[test]
fn animated_cameras_and_lights_rest_before_and_after_their_keys() {
    let folder = tempfile::tempdir().unwrap();
    animated(folder.path());
    let drive =
        "motion.animation = { gltf = \"animated.gltf\", node = \"cart\", name = \"drive\" }";
    let scene = |camera: &str, light: &str| {
        let text = format!(
            "speed_of_light = \"2 m/s\"\n[camera]\nlook_at = [0, 0, -9]\nsize = [6, 4]\n{camera}\n\
             [[light]]\nintensity = 3\n{light}\n[[object]]\nshape = {{ box = {{ size = [40, 40, 1] }} }}\n\
             transform = {{ translate = [0, 0, -9] }}\n"
        );
        scene::parse(&text, "test scene", folder.path(), &Overrides::default()).unwrap()
    };
    let radiance = |scene: &scene::model::Scene| {
        let plan = Plan::new(scene, &Request::default()).unwrap();
        let prepared = Prepared::new(scene, &plan, &Silent).unwrap();
        render(&prepared, &Silent).unwrap().radiance().to_vec()
    };
    // The cart starts at the origin at time 0, and ends 8 m of light later at (3, 0, −3).
    for (time, place) in [(0.0, [0.0, 0.0, 0.0]), (60.0, [3.0, 0.0, -3.0])] {
        let eye = format!("eye = [0, 0, 5]\ntime = \"{time} m\"");
        let follows = radiance(&scene(&eye, drive));
        let rests = radiance(&scene(&eye, &format!("position = {place:?}")));
        assert!(follows.iter().all(|rgb| rgb[0] > 0.0), "{follows:?}");
        for (a, b) in follows.iter().flatten().zip(rests.iter().flatten()) {
            assert!((a / b - 1.0).abs() < 1e-12, "{time}: {a} {b}");
        }
    }
    let line = scene(drive, "position = [0, 0, 0]").camera.world_line();
    let line = line.unwrap();
    for (time, place) in [(-7.0, DVec3::ZERO), (90.0, DVec3::new(3.0, 0.0, -3.0))] {
        let state = line.state(time).unwrap();
        assert_eq!((state.event.x, state.velocity.beta()), (place, DVec3::ZERO));
    }
    assert_eq!(line.state(-7.0).unwrap().event.ct, -7.0);
}
