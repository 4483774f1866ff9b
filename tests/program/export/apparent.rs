//! A program that reads only the bundle reproduces the ray tracer's picture.
//!
//! For each pixel of the reference: the point with its barycentric coordinates on its triangle, in the object's frame; then, by the vertex
//! transform of the README, the emission event, the direction, the wavelength ratio, and the film position, which must be the pixel's
//! centre.

use super::reader::{
    Bundle, Object, Vec3, Vec4, apply, dot, inverse, length, matrix, minkowski, minus, place, plus,
    vector,
};
use super::{Exported, exported};

/// A ball, which single precision does not hold, and a box, both moving, over a floor.
const MOVING: &str = r#"
[camera]
eye = [0.3, 1.0, 4]
look_at = [0.1, 0.5, 0]
hfov = "75 deg"
size = [40, 30]
time = "0.25 m"
CAMERA
[display]
back_faces = "two_sided"
[[object]]
name = "floor"
shape = { plane = { size = [8, 8] } }
[[object]]
name = "ball"
shape = { sphere = { radius = 0.7, subdivisions = 3 } }
transform = { translate = [0.1, 0.2, 0.3] }
velocity = { beta = [0.5, 0, 0.2] }
origin = { position = [-1, 0.7, 0], time = "-4 m" }
[[object]]
name = "crate"
shape = { box = { size = [1, 1, 1] } }
velocity = { beta = [-0.9, 0, 0] }
origin = { position = [1.3, 0.5, 0.4], time = "-4 m" }
"#;

/// What the vertex transform makes of a point of an object.
struct Apparent {
    event: Vec4,
    object_time: f64,
    direction: Vec3,
    distance: f64,
    pixel: [f64; 2],
    ratio: f64,
}

fn apparent(bundle: &Bundle, object: &Object, p: Vec3) -> Apparent {
    let camera = &bundle.json["camera"];
    let shot: Vec4 = vector(&camera["shot_event"]);
    let (m, l) = (
        &object.world_from_object,
        matrix(&camera["world_from_camera"]),
    );
    let index = bundle.json["scene"]["ray_index"].as_f64().unwrap();
    let object_time = emission_time(minus(shot, object.origin), m, index, p);
    let event = plus(object.origin, apply(m, [object_time, p[0], p[1], p[2]]));
    let distance = length(place(minus(event, shot)));
    let direction = place(minus(event, shot)).map(|x| x / distance);
    let kappa = [-1.0, direction[0], direction[1], direction[2]];
    let column = |m: &super::reader::Matrix| [m[0][0], m[1][0], m[2][0], m[3][0]];
    Apparent {
        event,
        object_time,
        direction,
        distance,
        pixel: project(bundle, place(apply(&inverse(&l), kappa))),
        ratio: minkowski(kappa, column(m)) / minkowski(kappa, column(&l)),
    }
}

/// The object's time at which light left its point `p` for the shot, which is at `shot` from its origin in the
/// world: the earlier solution of η² |X|² = ct² of (ct, X) = M (τ, p) − shot.
fn emission_time(shot: Vec4, m: &super::reader::Matrix, index: f64, p: Vec3) -> f64 {
    let at_zero = minus(apply(m, [0.0, p[0], p[1], p[2]]), shot);
    let u = [m[0][0], m[1][0], m[2][0], m[3][0]];
    let square = |a: Vec4, b: Vec4| index * index * dot(place(a), place(b)) - a[0] * b[0];
    let (a, b, c) = (square(u, u), square(u, at_zero), square(at_zero, at_zero));
    // a < 0 for a body slower than light in the medium: the earlier root has the plus sign.
    (-b + (b * b - a * c).sqrt()) / a
}

fn project(bundle: &Bundle, d: Vec3) -> [f64; 2] {
    let camera = &bundle.json["camera"];
    let [t0, t1]: [f64; 2] = vector(&camera["tan_half_fov"]);
    let [width, height]: [f64; 2] = vector(&camera["size"]);
    let along = |axis: &str| dot(d, vector(&camera[axis]));
    [
        0.5 * width * (1.0 + along("right") / along("forward") / t0),
        0.5 * height * (1.0 - along("up") / along("forward") / t1),
    ]
}

/// Compares all pixels with a hit; returns which objects there were.
fn check(Exported { bundle, .. }: &Exported, allowed: f64) -> Vec<usize> {
    let get = |name: &str| bundle.reference(name);
    let vectors = |group: &str, parts: &[&str]| -> Vec<Vec<f64>> {
        let of = |part: &&str| get(&format!("{group}.{part}"));
        parts.iter().map(of).collect()
    };
    let (objects, primitives) = (get("object"), get("primitive"));
    let barycentric = vectors("barycentric", &["u", "v"]);
    let event = vectors("event", &["ct", "x", "y", "z"]);
    let object_event = vectors("object_event", &["ct", "x", "y", "z"]);
    let direction = vectors("direction", &["x", "y", "z"]);
    let uv = vectors("uv", &["u", "v"]);
    let (ratio, distance) = (get("wavelength_ratio"), get("distance"));
    let width = bundle.json["camera"]["size"][0].as_u64().unwrap() as usize;
    let near = |what: &str, i: usize, a: f64, b: f64| {
        let scale = 1f64.max(a.abs());
        assert!(
            (a - b).abs() <= allowed * scale,
            "{what} of pixel {i}: {a} and {b}"
        );
    };
    let mut seen = Vec::new();
    for i in (0..objects.len()).filter(|i| objects[*i] >= 0.0) {
        let number = objects[i] as usize;
        let object = &bundle.objects[number];
        let corners = object.triangles[primitives[i] as usize];
        let (u, v) = (barycentric[0][i], barycentric[1][i]);
        let mix = |x: [f64; 3]| (1.0 - u - v) * x[0] + u * x[1] + v * x[2];
        let p: Vec3 = std::array::from_fn(|axis| mix(corners.map(|c| object.positions[c][axis])));
        let found = apparent(bundle, object, p);
        for (channel, value) in event.iter().zip(found.event) {
            near("event", i, channel[i], value);
        }
        for part in 0..3 {
            near("object_event", i, object_event[part + 1][i], p[part]);
            near("direction", i, direction[part][i], found.direction[part]);
        }
        for (part, channel) in uv.iter().enumerate() {
            let value = mix(corners.map(|c| object.uvs[c][part]));
            near("uv", i, channel[i], value);
        }
        near("object_event.ct", i, object_event[0][i], found.object_time);
        near("distance", i, distance[i], found.distance);
        near("wavelength_ratio", i, ratio[i], found.ratio);
        near("column", i, (i % width) as f64 + 0.5, found.pixel[0]);
        near("row", i, (i / width) as f64 + 0.5, found.pixel[1]);
        seen.push(number);
    }
    seen.sort_unstable();
    seen.dedup();
    seen
}

fn scene(camera: &str) -> String {
    MOVING.replace("CAMERA", camera)
}

#[test]
fn a_camera_at_rest_is_reproduced() {
    assert_eq!(check(&exported(&scene("")), 1e-9), [0, 1, 2]);
}

#[test]
fn a_camera_at_nine_tenths_of_the_speed_of_light_is_reproduced() {
    let moving = "velocity = { beta = [0.1, 0.05, -0.893] }";
    assert_eq!(check(&exported(&scene(moving)), 1e-9), [0, 1, 2]);
}

#[test]
fn a_medium_delays_light_in_the_bundle_too() {
    let slow = scene("velocity = { beta = [0, 0, -0.4] }")
        .replace("beta = [-0.9, 0, 0]", "beta = [-0.5, 0, 0]");
    let exported = exported(&format!("{slow}\n[medium]\nindex = 1.3\n"));
    assert_eq!(check(&exported, 1e-9), [0, 1, 2]);
}

#[test]
fn a_camera_that_turns_or_accelerates_is_given_at_the_shot() {
    let text = "motion = { acceleration = { proper = \"0.2 /m\", direction = [0, 0.3, -1] } }\n\
                rotation = { axis = [0, 0.2, 1], rate = \"0.6 rad/m\" }";
    let turned = scene("rotation = { axis = [0, 0.2, 1], rate = \"0.6 rad/m\" }");
    assert_eq!(check(&exported(&turned), 1e-9), [0, 1, 2]);
    let accelerated = scene(text.lines().next().unwrap());
    assert_eq!(check(&exported(&accelerated), 1e-9), [0, 1, 2]);
}

#[test]
fn a_wrong_matrix_would_be_noticed() {
    let mut wrong = exported(&scene("velocity = { beta = [0, 0, -0.9] }"));
    let object = &mut wrong.bundle.objects[2];
    object.world_from_object = inverse(&object.world_from_object);
    let checked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| check(&wrong, 1e-9)));
    assert!(checked.is_err());
}
