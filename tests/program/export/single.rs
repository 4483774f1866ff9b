//! Programs in single precision that follow the bundle's page are within the tolerances of its test vectors, in whatever order they add.

use std::fs;
use std::path::Path;

use nullray::validate::export::ExportOptions;
use serde_json::Value;

use super::exported_with;
use super::reader::{Matrix, inverse, matrix, minus, vector};

/// Orders of ct, x, y, z in sums.
const ORDERS: [[usize; 4]; 4] = [[0, 1, 2, 3], [2, 0, 3, 1], [3, 1, 0, 2], [1, 3, 2, 0]];

/// Σ a b in an order, each product rounded by itself or only with the sum.
fn dot(a: [f32; 4], b: [f32; 4], order: [usize; 4], fused: bool) -> f32 {
    let add = |sum: f32, i: usize| match fused {
        true => a[i].mul_add(b[i], sum),
        false => sum + a[i] * b[i],
    };
    order.into_iter().fold(0.0, add)
}

fn rounded(m: Matrix) -> [[f32; 4]; 4] {
    m.map(|row| row.map(|x| x as f32))
}

/// How far the page's formulas in single precision are off at one vector, in its tolerances: of event, film point and W.
fn off(
    camera: &Value,
    entry: &Value,
    test: &Value,
    at: &Value,
    (order, fused): ([usize; 4], bool),
) -> [f64; 3] {
    let (m, l) = (
        matrix(&entry["world_from_object"]),
        matrix(&camera["world_from_camera"]),
    );
    let (shot, origin): ([f64; 4], [f64; 4]) =
        (vector(&camera["shot_event"]), vector(&entry["origin"]));
    let since = minus(shot, origin);
    let q = inverse(&m).map(|row| (0..4).map(|i| row[i] * since[i]).sum::<f64>() as f32);
    let dot = |a: [f32; 4], b: [f32; 4]| dot(a, b, order, fused);
    let length = |v: [f32; 4]| dot([0.0, v[1], v[2], v[3]], [0.0, v[1], v[2], v[3]]).sqrt();
    let times = |m: [[f32; 4]; 4], v: [f32; 4]| m.map(|row| dot(row, v));

    let p = vector::<3>(&at["position"]).map(|x| x as f32);
    let r = [0.0, p[0] - q[1], p[1] - q[2], p[2] - q[3]];
    let k = times(rounded(m), [-length(r), r[1], r[2], r[3]]);
    let s = length(k);
    let kappa = [-1.0, k[1] / s, k[2] / s, k[3] / s];
    let seen = times(rounded(inverse(&l)), kappa);
    let along = ["right", "up", "forward"].map(|axis| {
        let [x, y, z] = vector::<3>(&camera[axis]).map(|x| x as f32);
        dot([0.0, x, y, z], seen)
    });
    let tangents = vector::<2>(&camera["tan_half_fov"]).map(|x| x as f32);
    let size = vector::<2>(&camera["size"]).map(|x| x as f32);
    let x = 0.5 * size[0] * (1.0 + along[0] / tangents[0] / along[2]);
    let y = 0.5 * size[1] * (1.0 - along[1] / tangents[1] / along[2]);
    let velocity = |m: Matrix| [0, 1, 2, 3].map(|i| if i == 0 { -m[i][0] } else { m[i][0] } as f32);
    let w = dot(kappa, velocity(m)) / dot(kappa, velocity(l));

    let tolerance = |name: &str| test["tolerance_single"][name].as_f64().unwrap();
    let event = vector::<4>(&at["event"]);
    let of_event = (0..4).map(|i| (f64::from(shot[i] as f32 + k[i]) - event[i]).abs());
    let of_film = match at["film"].is_null() {
        true => 0.0,
        false => {
            let film = vector::<2>(&at["film"]);
            let off = (f64::from(x) - film[0])
                .abs()
                .max((f64::from(y) - film[1]).abs());
            off / tolerance("film")
        }
    };
    let of_ratio = (f64::from(w) - at["wavelength_ratio"].as_f64().unwrap()).abs();
    [
        of_event.fold(0.0, f64::max) / tolerance("event"),
        of_film,
        of_ratio / tolerance("wavelength_ratio"),
    ]
}

#[test]
fn single_precision_is_within_the_tolerances_up_to_gamma_100_in_any_order() {
    let mut state = 1u64;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let options = ExportOptions {
        vectors: true,
        ..ExportOptions::default()
    };
    let mut worst = [0.0f64; 3];
    for gammas in [
        [1.2, 3.0],
        [3.0, 1.2],
        [5.0, 5.0],
        [1.5, 20.0],
        [20.0, 20.0],
        [1.1, 100.0],
        [100.0, 1.1],
        [2.0, 2.0],
    ] {
        // In any direction at these γ; objects are at their origins at the time of the shot.
        let mut velocity = |gamma: f64| {
            let (z, angle) = (2.0 * random() - 1.0, std::f64::consts::TAU * random());
            let (flat, beta) = ((1.0 - z * z).sqrt(), (1.0 - 1.0 / (gamma * gamma)).sqrt());
            [flat * angle.cos(), flat * angle.sin(), z].map(|x| beta * x)
        };
        let (of_camera, of_ball, of_box) = (
            velocity(gammas[0]),
            velocity(gammas[1]),
            velocity(gammas[1]),
        );
        let text = format!(
            "camera = {{ eye = [0.3, 1, 4], look_at = [0.1, 0.5, 0], hfov = \"60 deg\", size = [8, 6], velocity = {{ beta = {of_camera:?} }} }}
             [[object]]
             shape = {{ sphere = {{ radius = 0.7, subdivisions = 2 }} }}
             velocity = {{ beta = {of_ball:?} }}
             origin = {{ position = [-1, 0.7, 0] }}
             [[object]]
             shape = {{ box = {{ size = [1, 1, 1] }} }}
             velocity = {{ beta = {of_box:?} }}
             origin = {{ position = [1.3, 0.5, 0.4] }}"
        );
        let exported = exported_with(&text, Path::new("."), &options);
        let tests: Value =
            serde_json::from_slice(&fs::read(exported.path("vectors.json")).unwrap()).unwrap();
        let bundle = &exported.bundle.json;
        for (n, test) in tests["objects"].as_array().unwrap().iter().enumerate() {
            for at in test["vectors"].as_array().unwrap() {
                for order in ORDERS {
                    for fused in [false, true] {
                        let off = off(
                            &bundle["camera"],
                            &bundle["objects"][n],
                            test,
                            at,
                            (order, fused),
                        );
                        worst = [0, 1, 2].map(|k| worst[k].max(off[k]));
                    }
                }
            }
        }
    }
    assert!(worst.iter().all(|off| *off <= 1.0), "{worst:?}");
    // The tolerances are those of single precision: they are not far above what it reaches.
    assert!(worst.iter().all(|off| *off > 0.1), "{worst:?}");
}
