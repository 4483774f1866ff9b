//! The snippets of the bundle's page run unchanged, and reproduce the test vectors.

use std::fs;
use std::path::Path;
use std::process::Command;

use nullray::validate::export::{ExportOptions, README};

use super::exported_with;
use super::reader::{apply, dot, inverse, length, matrix, minkowski, minus, place, plus, vector};

/// A ball, which single precision does not hold, and a box that move past a moving camera.
const SCENE: &str = r#"
[camera]
eye = [0.3, 1.0, 4]
look_at = [0.1, 0.5, 0]
size = [40, 30]
velocity = { beta = [0.3, 0, -0.4] }
[[object]]
name = "ball"
shape = { sphere = { radius = 0.7, subdivisions = 2 } }
velocity = { beta = [0.5, 0, 0.2] }
origin = { position = [-1, 0.7, 0], time = "-4 m" }
[[object]]
name = "crate"
shape = { box = { size = [1, 1, 1] } }
velocity = { beta = [-0.9, 0, 0] }
origin = { position = [1.3, 0.5, 0.4], time = "-4 m" }
"#;

fn bundle() -> super::Exported {
    let options = ExportOptions {
        vectors: true,
        ..ExportOptions::default()
    };
    exported_with(SCENE, Path::new("."), &options)
}

/// The first block of the page in this language that contains `words`.
fn snippet(language: &str, words: &str) -> String {
    let fence = format!("```{language}\n");
    let mut blocks = README
        .split(&fence)
        .skip(1)
        .map(|rest| rest.split("```").next().unwrap());
    blocks
        .find(|block| block.contains(words))
        .unwrap()
        .to_string()
}

/// Whether Python has these modules; otherwise says what is skipped.
fn has_python(modules: &str) -> bool {
    let imported = Command::new("python3")
        .args(["-c", &format!("import {modules}")])
        .output();
    let there = imported.is_ok_and(|output| output.status.success());
    if !there {
        crate::common::skipped::skipped(format_args!("Python with {modules} is not installed"));
    }
    there
}

#[test]
fn the_reader_in_numpy_finds_what_the_reference_shows() {
    if !has_python("numpy") {
        return;
    }
    let bundle = bundle();
    let script = snippet("python", "def seen");
    assert!(
        script
            .lines()
            .filter(|line| !line.trim().is_empty())
            .count()
            <= 60
    );
    let output = Command::new("python3")
        .args(["-c", &script])
        .current_dir(bundle.path("."))
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(told.contains("ball") && told.contains("crate"), "{told}");
}

#[test]
fn the_shader_meets_the_tolerances_of_single_precision() {
    let bundle = bundle();
    let shader = bundle.path("transform.vert");
    fs::write(&shader, snippet("glsl", "#version")).unwrap();
    match Command::new("glslangValidator").arg(&shader).output() {
        Ok(output) => assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stdout)
        ),
        Err(_) => crate::common::skipped::skipped("glslangValidator is not installed"),
    }
    if !has_python("numpy") {
        return;
    }
    let output = Command::new("python3")
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/program/export/glsl.py"))
        .args([&shader, &bundle.path(".")])
        .env("LIBGL_ALWAYS_SOFTWARE", "1")
        .output()
        .unwrap();
    match output.status.code() {
        Some(77) => crate::common::skipped::skipped("there is no OpenGL ES 3 without a window"),
        code => assert_eq!(
            code,
            Some(0),
            "{}{}",
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr)
        ),
    }
}

#[test]
fn test_vectors_are_what_the_formulas_of_the_page_give() {
    let bundle = bundle();
    let text = fs::read(bundle.path("vectors.json")).unwrap();
    let vectors: serde_json::Value = serde_json::from_slice(&text).unwrap();
    assert_eq!(vectors["format"], "nullray-vectors");
    let camera = &bundle.bundle.json["camera"];
    let shot: [f64; 4] = vector(&camera["shot_event"]);
    let l = matrix(&camera["world_from_camera"]);
    let axes = ["right", "up", "forward"].map(|axis| vector::<3>(&camera[axis]));
    let t: [f64; 2] = vector(&camera["tan_half_fov"]);
    let (objects, tested) = (
        &bundle.bundle.objects,
        vectors["objects"].as_array().unwrap(),
    );
    assert_eq!(objects.len(), tested.len());
    for (object, test) in objects.iter().zip(tested) {
        let list = test["vectors"].as_array().unwrap();
        assert!(list.len() >= 24 && list.len() <= 32, "{}", list.len());
        for v in list {
            let p: [f64; 3] = vector(&v["position"]);
            let vertex = v["vertex"].as_u64().unwrap() as usize;
            assert!(length([0, 1, 2].map(|i| p[i] - object.positions[vertex][i])) < 1e-15);
            // (T, q) = M⁻¹ (P − O); τ = T − |p − q|; E = O + M (τ, p).
            let m = &object.world_from_object;
            let q = apply(&inverse(m), minus(shot, object.origin));
            let tau = q[0] - length([0, 1, 2].map(|i| p[i] - q[i + 1]));
            let event = plus(object.origin, apply(m, [tau, p[0], p[1], p[2]]));
            let found: [f64; 4] = vector(&v["event"]);
            assert!(
                minus(event, found).iter().all(|d| d.abs() < 1e-13),
                "{event:?} {found:?}"
            );
            let kappa = minus(event, shot);
            let column = |m: &super::reader::Matrix| [m[0][0], m[1][0], m[2][0], m[3][0]];
            let w = minkowski(kappa, column(m)) / minkowski(kappa, column(&l));
            assert!((w / v["wavelength_ratio"].as_f64().unwrap() - 1.0).abs() < 1e-13);
            let seen = place(apply(&inverse(&l), kappa));
            let [x, y, z] = axes.map(|axis| dot(axis, seen));
            match z > 0.0 {
                false => assert!(v["film"].is_null()),
                true => {
                    let film: [f64; 2] = vector(&v["film"]);
                    let by_page = [20.0 * (1.0 + x / z / t[0]), 15.0 * (1.0 - y / z / t[1])];
                    let scale = by_page[0].abs().max(by_page[1].abs()).max(1.0);
                    let off = (0..2)
                        .map(|i| (film[i] - by_page[i]).abs())
                        .fold(0.0, f64::max);
                    assert!(off < 1e-12 * scale, "{film:?} {by_page:?}");
                }
            }
        }
    }
}
