//! What a single pixel sees: the numbers of the rendered picture, and the diagram made from them.

mod agreement;
mod diagram;
mod light;
mod refused;

use std::path::Path;

use nullray::Result;
use nullray::figures::diagram::model::Diagram;
use nullray::figures::pixel_probe::{Probe, ProbeHit, trace};
use nullray::render::progress::Silent;
use nullray::scene::model::Scene;
use nullray::scene::{self, Overrides};

const NO_LIMIT: u64 = 1 << 40;

/// A floor, and a crate that moves at 0.6 c; `camera` says more of the camera, whose last table is open.
fn text(camera: &str) -> String {
    format!(
        r#"
[[object]]
name = "floor"
shape = {{ plane = {{ size = [8, 8] }} }}
[[object]]
name = "crate"
shape = {{ box = {{ size = [1, 1, 1] }} }}
velocity = {{ beta = [0.6, 0, 0] }}
origin = {{ position = [0, 0.5, 0], time = "-4 m" }}
[camera]
look_at = [0.0, 0.5, 0]
hfov = "60 deg"
size = [32, 24]
{camera}
"#
    )
}

const STILL: &str = "eye = [0, 1, 4]";
const MOVING: &str = "eye = [0, 1, 4]\nvelocity = { beta = [0.2, 0.1, -0.5] }\nclock_zero = \"1 m\"\ntime = \"0.3 m\"";
const SENSOR: &str = "eye = [0, 1, 4]\nvelocity = { beta = [0.2, 0.1, -0.5] }\n\
                      [camera.sensor]\nfocal_length = \"0.4 m\"\nassembly = \"world_length\"";
const BELL: &str = "eye = [0, 1, 4]\ntime = \"0.7 m\"\n[camera.sensor]\nfocal_length = \"0.4 m\"\nassembly = \"bell\"\n\
                    [camera.motion]\nacceleration = { proper = \"0.5 /m\", direction = [0, 0.1, -1] }";
const RIGID: &str = "eye = [0, 1, 4]\ntime = \"0.7 m\"\n[camera.sensor]\nfocal_length = \"0.4 m\"\nassembly = \"rigid\"\n\
                     [camera.motion]\nacceleration = { proper = \"0.5 /m\", direction = [0, 0.1, -1] }";
const TURNING: &str = "eye = [0, 1, 4]\ntime = \"0.2 m\"\n[camera.sensor]\nfocal_length = \"0.4 m\"\n\
                       [camera.rotation]\naxis = [0, 0, 1]\nrate = \"0.5 rad/m\"";
const OPEN: &str =
    "eye = [0, 1, 4]\nvelocity = { beta = [0.3, 0, 0] }\n[camera.shutter]\nduration = \"0.5 m\"";

const ALL: [&str; 7] = [STILL, MOVING, SENSOR, BELL, RIGID, TURNING, OPEN];
const WITH_SENSOR: [&str; 4] = [SENSOR, BELL, RIGID, TURNING];

fn scene(text: &str) -> Scene {
    scene::parse(text, "test scene", Path::new(""), &Overrides::default())
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn traced(scene: &Scene, pixel: [u32; 2]) -> Result<Probe> {
    trace(scene, pixel, NO_LIMIT, &Silent)
}

fn seen(camera: &str, pixel: [u32; 2]) -> Probe {
    traced(&scene(&text(camera)), pixel).unwrap_or_else(|error| panic!("{error}"))
}

/// A probe of this camera of something, and what it is.
fn hit(camera: &str) -> (Probe, ProbeHit) {
    let scene = scene(&text(camera));
    let rows = (0..24)
        .rev()
        .flat_map(|row| (0..32).map(move |column| [column, row]));
    for pixel in rows.step_by(37) {
        let probe = traced(&scene, pixel).unwrap();
        if let Some(hit) = probe.hit.clone() {
            return (probe, hit);
        }
    }
    panic!("nothing is met: {camera}");
}

/// The diagram of a scene, for its unit and style.
fn base(text: &str) -> Diagram {
    nullray::figures::diagram::parse(text, "test scene", Path::new(""), &Overrides::default())
        .unwrap()
}

#[track_caller]
fn equal(found: f64, expected: f64) {
    let error = (found - expected).abs();
    assert!(
        error <= 1e-12 * expected.abs().max(1.0),
        "{found} is not {expected}"
    );
}
