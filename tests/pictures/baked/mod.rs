//! Baked light: against an independent renderer of transient light, closed forms, and path tracing in space-time.

mod films;
mod light;
mod refusals;
mod runs;
mod trials;

use nullray::error::Result;
use nullray::io::cube::Cube;
use nullray::render::aov::Aov;
use nullray::render::bake::{self, Baked, Bins, Coordinates, CubePrecision, Surface};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::scene::model::Scene;

const PI: f64 = std::f64::consts::PI;

/// The corner of tests/data/transient, as its second camera sees it.
const CORNER: &str = "
render = { bounces = 2 }
display = { back_faces = \"black\", samples_per_pixel = 16 }
[camera]
eye = [0.3, 3.4, 6.0]
look_at = [-0.4, 0.9, -0.6]
hfov = \"45 deg\"
size = [64, 64]
[[object]]
name = \"corner\"
gltf = \"scenes/corner/corner.glb\"
[[source]]
name = \"flash\"
pulse = { position = [1.2, 2.8, 1.0], sigma = \"0.1 m\", intensity = 10 }
";

fn prepared(scene: &Scene) -> Prepared {
    let request = Request {
        aovs: vec![Aov::UvU],
        ..Request::default()
    };
    let plan = Plan::new(scene, &request).unwrap();
    Prepared::new(scene, &plan, &Silent).unwrap()
}

fn camera_cube(scene: &Scene, bins: &Bins) -> Result<Baked> {
    bake::camera_cube(
        scene,
        &prepared(scene),
        bins,
        CubePrecision::Single,
        None,
        &Silent,
    )
}

/// Over the texture coordinates of an object.
fn surface_cube(scene: &Scene, object: usize, size: [u32; 2], bins: &Bins) -> Result<Baked> {
    let surface = Surface {
        object,
        coordinates: Coordinates::Set(0),
        size,
    };
    cube_of(scene, &prepared(scene), &surface, bins)
}

/// Of any surface, in single precision.
fn cube_of(scene: &Scene, prepared: &Prepared, surface: &Surface, bins: &Bins) -> Result<Baked> {
    let precision = CubePrecision::Single;
    bake::surface_cube(scene, prepared, surface, bins, precision, None, &Silent)
}

/// The mean of the channels of bin `bin` of pixel `pixel`.
fn value(cube: &Cube, pixel: usize, bin: usize) -> f64 {
    cube.total(pixel, bin) / cube.shape[3] as f64
}
