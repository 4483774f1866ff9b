//! Whole pictures, from the text of a scene to its channels, that must not depend on the position and scale of the scene.
//!
//! Powers of two scale without rounding, and adding multiples of 2⁻²⁰ m to 2³⁰ m is exact: so every channel about the hit must have the
//! same bits at 2⁻³⁰ (1e-9) and 2³⁰ (1e9) times the size, 2³⁰ m from the origin, and 2⁴⁸ m (9.4e5 s) later, for a camera
//! and objects at several velocities; and when the camera's own clock shows 2⁴⁸ m, for objects that move with it. Events themselves are rounded to half an ulp of their coordinates: 3 cm at 2⁴⁸ m.

use glam::DVec3;

use super::{Check, Outcome, counted};
use crate::Result;
use crate::render::aov::Aov;
use crate::render::film::Film;
use crate::render::plan::{Plan, Request};
use crate::render::prepare::Prepared;
use crate::render::progress::{Progress, Silent};
use crate::render::render;
use crate::scene::model::{Geometry, Scene, Shape};
use crate::scene::{self, Overrides};

pub(super) const CHECKS: [Check; 1] = [counted(
    "pictures",
    "pictures of a moving scene of 1e-9 to 1e9 times the size, 1e9 m away, 1e6 s later; with the camera, at its time 1e6 s: pixels that differ",
    "pixel",
    [5 * PIXELS, 5 * PIXELS],
    pictures,
)];

const PIXELS: u64 = 160 * 120;

const SCENE: &str = r#"
camera = { eye = [0.5, 1.25, 4], look_at = [0, 0.5, 0], hfov = "60 deg", size = [160, 120], velocity = { beta = [0.3, 0.1, -0.8] } }
object = [
  { name = "floor", shape = { plane = { size = [8, 8] } }, origin = { position = [0, -0.5, 0] } },
  { name = "crate", shape = { box = { size = [1, 1, 1] } }, velocity = { beta = [0.6, 0, 0] }, origin = { position = [0, 0.5, 0], time = "-4 m" } },
  { name = "ball", shape = { sphere = { radius = 0.75 } }, velocity = { beta = [0, 0.1, 0.9] }, origin = { position = [-1, 0.5, 0.25], time = "-3.5 m" } },
]
display = { back_faces = "two_sided" }
"#;

/// The channels that record what was hit, and where on it.
const CHANNELS: [Aov; 5] = [
    Aov::Object,
    Aov::Primitive,
    Aov::BarycentricU,
    Aov::BarycentricV,
    Aov::WavelengthRatio,
];

fn pictures(_: u64, progress: &dyn Progress) -> Result<Outcome> {
    let scene = scene::parse(SCENE, "self-test", ".".as_ref(), &Overrides::default())?;
    let original = film(&scene)?;
    // Powers of two: scenes and positions change without rounding.
    let far = DVec3::new(1.0, -1.0, 1.0) * libm::exp2(30.0);
    let others = [
        scaled(&scene, libm::exp2(-30.0)),
        scaled(&scene, libm::exp2(30.0)),
        moved(&scene, 0.0, far),
        moved(&scene, libm::exp2(48.0), DVec3::ZERO),
    ];
    let mut differing = 0;
    for other in &others {
        progress.check()?;
        differing += difference(&original, &film(other)?);
        progress.rays_done(PIXELS);
    }
    // What moves with the camera is where it was.
    let mut together = scene;
    for object in &mut together.objects {
        object.velocity = together.camera.velocity;
    }
    let at_first = film(&together)?;
    together.camera = together.camera.at(libm::exp2(48.0));
    differing += difference(&at_first, &film(&together)?);
    progress.rays_done(PIXELS);
    Ok(Outcome {
        worst: differing as f64,
        cases: 5 * PIXELS,
    })
}

fn film(scene: &Scene) -> Result<Film> {
    let request = Request {
        aovs: CHANNELS.to_vec(),
        pixel_centers: true,
        ..Request::default()
    };
    let plan = Plan::new(scene, &request)?;
    render(&Prepared::new(scene, &plan, &Silent)?, &Silent)
}

/// The number of pixels that differ in any channel; all pixels if nothing is visible.
fn difference(a: &Film, b: &Film) -> usize {
    let bits = |film: &Film, aov, i: usize| film.aov(aov).map(|values| values[i].to_bits());
    let differs = |&i: &usize| {
        let same = |&aov: &Aov| bits(a, aov, i) == bits(b, aov, i);
        !CHANNELS.iter().all(same) || a.radiance()[i] != b.radiance()[i]
    };
    match a.met() > 0.0 {
        true => (0..a.radiance().len()).filter(differs).count(),
        false => a.radiance().len(),
    }
}

/// The scene with all lengths and times multiplied by `factor`.
fn scaled(scene: &Scene, factor: f64) -> Scene {
    let mut scene = scene.clone();
    scene.camera.origin.ct *= factor;
    scene.camera.origin.x *= factor;
    for object in &mut scene.objects {
        object.origin.ct *= factor;
        object.origin.x *= factor;
        if let Geometry::Shape { shape, .. } = &mut object.geometry {
            enlarge(shape, factor);
        }
    }
    scene
}

fn enlarge(shape: &mut Shape, factor: f64) {
    match shape {
        Shape::Box { size } => *size = size.map(|s| s * factor),
        Shape::Sphere { radius, .. } => *radius *= factor,
        Shape::Plane { size } => *size = size.map(|s| s * factor),
        Shape::Lattice { spacing, bar, .. } => {
            *spacing *= factor;
            *bar *= factor;
        }
    }
}

/// The scene with everything moved by (`ct`, `x`).
fn moved(scene: &Scene, ct: f64, x: DVec3) -> Scene {
    let mut scene = scene.clone();
    let objects = scene.objects.iter_mut().map(|object| &mut object.origin);
    for origin in objects.chain([&mut scene.camera.origin]) {
        origin.ct += ct;
        origin.x += x;
    }
    scene
}
