//! The light of lamps, by the formula on the bundle's page only; and the list of what a bundle does not describe.

use std::f64::consts::PI;
use std::path::Path;

use nullray::validate::export::ExportOptions;
use serde_json::Value;

use super::reader::{
    Bundle, Vec3, Vec4, apply, dot, inverse, length, matrix, minkowski, minus, place, vector,
};
use super::{exported, exported_with};

/// A box that moves and a floor, lit by a point that moves, a cone and parallel light, all in pulses; without shadows.
const LIT: &str = r#"
camera = { eye = [0.3, 1.4, 4], look_at = [0, 0.4, 0], hfov = "60 deg", size = [40, 30], velocity = { beta = [0.2, 0, -0.5] } }
[[object]]
name = "floor"
shape = { plane = { size = [8, 8] } }
colour = [0.5, 0.4, 0.3]
[[object]]
name = "crate"
shape = { box = { size = [1, 1, 1] } }
colour = [0.2, 0.6, 0.9]
velocity = { beta = [0.6, 0, 0.1] }
origin = { position = [-2.8, 0.6, -0.4], time = "-8.5 m" }
[[light]]
name = "flyer"
position = [-2, 1.9, 0.6]
clock_zero = "-9 m"
velocity = { beta = [0.7, 0, 0.1] }
intensity = [3, 2, 1]
emission = { gaussian = { time = "2 m", sigma = "1.5 m" } }
shadows = false
[[light]]
name = "cone"
type = "spot"
position = [1, 3, 1]
direction = [-0.3, -1, -0.3]
inner = "14 deg"
outer = "32 deg"
intensity = [5, 7, 9]
velocity = { beta = [0, 0, 0.3] }
shadows = false
[[light]]
name = "far"
type = "directional"
direction = [0.4, -1, -0.2]
irradiance = [0.2, 0.3, 0.4]
velocity = { beta = [-0.5, 0.2, 0] }
shadows = false
"#;

fn column(m: &super::reader::Matrix) -> Vec4 {
    [m[0][0], m[1][0], m[2][0], m[3][0]]
}

fn factor(emission: &Value, time: f64) -> f64 {
    match emission["kind"].as_str().unwrap() {
        "steady" => 1.0,
        "gaussian" => {
            let [centre, sigma] = ["centre", "sigma"].map(|key| emission[key].as_f64().unwrap());
            (-0.5 * ((time - centre) / sigma).powi(2)).exp()
        }
        other => panic!("{other}"),
    }
}

/// E′ of a lamp at the event `e` of a surface that rests with `m`, on the side with the normal `n`.
fn irradiance(lamp: &Value, e: Vec4, m: &super::reader::Matrix, n: Vec3, p: i32) -> Vec3 {
    let frame = matrix(&lamp["world_from_lamp"]);
    let way = apply(&inverse(&frame), minus(e, vector(&lamp["origin"])));
    let (time, q) = (way[0], place(way));
    let r = length(q);
    let axis = || vector::<3>(&lamp["axis"]);
    let (kappa, time, fall) = match lamp["beam"].as_str().unwrap() {
        "parallel" => {
            let a = axis();
            ([-1.0, -a[0], -a[1], -a[2]], time - dot(q, a), 1.0)
        }
        beam => {
            let within = match beam {
                "spot" => {
                    let [inner, outer] = vector::<2>(&lamp["cone"]).map(f64::cos);
                    ((dot(q, axis()) / r - outer) / (inner - outer)).clamp(0.0, 1.0)
                }
                _ => 1.0,
            };
            (
                [-r, -q[0], -q[1], -q[2]],
                time - r,
                within * within / (r * r),
            )
        }
    };
    let kappa = apply(&frame, kappa);
    let ratio = minkowski(kappa, column(&frame)) / minkowski(kappa, column(m));
    let towards = place(apply(&inverse(m), kappa));
    let cosine = (dot(towards, n) / length(towards)).max(0.0);
    let intensity: Vec3 = vector(&lamp["intensity"]);
    let all = factor(&lamp["emission"], time) * ratio.powi(2 - p) * cosine * fall;
    intensity.map(|i| i * all)
}

fn check(bundle: &Bundle) {
    let get = |name: &str| bundle.reference(name);
    let four = ["ct", "x", "y", "z"].map(|axis| get(&format!("event.{axis}")));
    let [normal, look] = ["normal", "direction"]
        .map(|group| ["x", "y", "z"].map(|axis| get(&format!("{group}.{axis}"))));
    let (object, ratio, radiance) = (get("object"), get("wavelength_ratio"), get("radiance"));
    let p = bundle.json["scene"]["base_colour"]["exponent"]
        .as_i64()
        .unwrap() as i32;
    let mut lit = [0; 2];
    for i in 0..object.len() {
        if object[i] < 0.0 {
            continue;
        }
        let k = object[i] as usize;
        let m = &bundle.objects[k].world_from_object;
        let e: Vec4 = std::array::from_fn(|axis| four[axis][i]);
        let mut n: Vec3 = std::array::from_fn(|axis| normal[axis][i]);
        // The side that the camera sees.
        let d: Vec3 = std::array::from_fn(|axis| look[axis][i]);
        let own = place(apply(&inverse(m), [-1.0, d[0], d[1], d[2]]));
        if dot(own, n) > 0.0 {
            n = n.map(|x| -x);
        }
        let albedo: Vec3 = vector(&bundle.json["objects"][k]["parts"][0]["base_colour"]);
        let mut sum = [0.0; 3];
        for lamp in bundle.json["lamps"].as_array().unwrap() {
            let light = irradiance(lamp, e, m, n, p);
            (0..3).for_each(|c| sum[c] += light[c]);
        }
        for c in 0..3 {
            let expected = albedo[c] * sum[c] / PI * ratio[i].powi(-p);
            let found = radiance[3 * i + c];
            assert!(
                (found - expected).abs() <= 1e-6 * expected.abs() + 1e-12,
                "pixel {i}, channel {c}: {found}, {expected}"
            );
        }
        lit[k] += usize::from(sum[0] > 0.0);
    }
    assert!(lit.iter().all(|count| *count > 20), "{lit:?}");
}

#[test]
fn light_of_lamps_is_that_of_the_formula_of_the_page() {
    let lit = exported(LIT);
    let scene = &lit.bundle.json["scene"];
    assert_eq!(scene["is_lit"], true);
    assert_eq!(scene["undescribed"], serde_json::json!([]));
    assert_eq!(lit.bundle.json["lamps"].as_array().unwrap().len(), 3);
    check(&lit.bundle);
    let by_frequency = format!("{LIT}\n[radiance]\nquantity = \"per_frequency\"\n");
    check(&exported(&by_frequency).bundle);
}

#[test]
fn what_a_bundle_cannot_describe_of_the_light_is_listed_and_all_else_is_there() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let text = std::fs::read_to_string(scenes.join("lamps.toml")).unwrap();
    let size = text
        .lines()
        .find(|line| line.starts_with("size = "))
        .unwrap();
    let text = text.replacen(size, "size = [32, 24]", 1);
    let options = ExportOptions {
        vectors: true,
        ..ExportOptions::default()
    };
    let exported = exported_with(&text, &scenes, &options);
    let json = &exported.bundle.json;
    let undescribed = json["scene"]["undescribed"].as_array().unwrap();
    let words: Vec<&str> = undescribed
        .iter()
        .map(|what| what.as_str().unwrap())
        .collect();
    for part in ["the sky", "surfaces of objects", "\"rgb\""] {
        assert!(
            words.iter().any(|word| word.contains(part)),
            "{part}: {words:?}"
        );
    }
    let names: Vec<_> = json["lamps"]
        .as_array()
        .unwrap()
        .iter()
        .map(|l| &l["name"])
        .collect();
    assert_eq!(names, ["lamp", "flyer"]);
    // Geometry, events and W are those of any scene.
    let seen = exported.bundle.reference("object");
    assert!(seen.iter().filter(|id| **id >= 0.0).count() > 300);
    assert!(exported.path("vectors.json").exists());
}
