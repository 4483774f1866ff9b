//! From a scene's text to its film, and the film's channels as vectors.

use std::path::Path;

use glam::DVec3;
use nullray::error::Result;
use nullray::render::aov::{self, Aov};
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::model::{CameraModel, Scene};
use nullray::scene::{self, Overrides};

/// The scene that `text` says.
pub fn scene(text: &str) -> Scene {
    scene_in(Path::new(env!("CARGO_MANIFEST_DIR")), text)
}

/// The scene that `text` says, its files in `folder`.
pub fn scene_in(folder: &Path, text: &str) -> Scene {
    scene::parse(text, "test scene", folder, &Overrides::default()).unwrap()
}

/// All auxiliary channels of the rays through the pixels' centres.
pub fn centred() -> Request {
    Request {
        aovs: aov::parse("all").unwrap(),
        pixel_centers: true,
        ..Request::default()
    }
}

/// All auxiliary channels but the standard error, which has the samples taken in parts, and the scene's own samples per pixel.
pub fn sampled() -> Request {
    let mut request = Request {
        pixel_centers: false,
        ..centred()
    };
    request.aovs.retain(|aov| *aov != Aov::StandardError);
    request
}

/// The film of `scene`.
pub fn rendered(scene: &Scene, request: &Request) -> Result<Film> {
    let plan = Plan::new(scene, request)?;
    render(&Prepared::new(scene, &plan, &Silent)?, &Silent)
}

/// The film of the rays through the pixels' centres, with all channels.
pub fn film(scene: &Scene) -> Film {
    rendered(scene, &centred()).unwrap()
}

/// Number of pixels.
pub fn pixels(film: &Film) -> usize {
    film.radiance().len()
}

/// A channel's value in pixel `i`.
pub fn value(film: &Film, aov: Aov, i: usize) -> f64 {
    film.aov(aov).unwrap()[i]
}

/// Pixels that see an object.
pub fn met(film: &Film) -> Vec<usize> {
    let object = film.aov(Aov::Object).unwrap();
    (0..object.len()).filter(|i| object[*i] >= 0.0).collect()
}

/// Pixels that see object `number`.
pub fn met_of(film: &Film, number: usize) -> Vec<usize> {
    let object = film.aov(Aov::Object).unwrap();
    let is_it = |i: &usize| object[*i] == number as f64;
    (0..object.len()).filter(is_it).collect()
}

/// The mean radiance of these pixels.
pub fn mean(film: &Film, pixels: &[usize]) -> [f64; 3] {
    let part = 1.0 / pixels.len() as f64;
    let mut mean = [0.0; 3];
    for i in pixels {
        (0..3).for_each(|c| mean[c] += part * film.radiance()[*i][c]);
    }
    mean
}

/// The bits of the radiance of all pixels.
pub fn bits(film: &Film) -> Vec<u64> {
    let all = film.radiance().iter().flatten();
    all.map(|x| x.to_bits()).collect()
}

/// Does `work` on so many threads.
pub fn on<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(work)
}

/// Planck's law, written out: W m⁻² sr⁻¹ per metre.
pub fn planck(wavelength: f64, kelvin: f64) -> f64 {
    let (h, c, k) = (6.62607015e-34, 299792458.0, 1.380649e-23);
    2.0 * h * c * c / wavelength.powi(5) / (h * c / (wavelength * k * kelvin)).exp_m1()
}

/// The tables of a camera in a room, 1.4 m above its floor, that moves at `beta`; and of the floor, of this colour.
pub fn room(beta: [f64; 3], floor: &str) -> String {
    format!(
        "[camera]
eye = [0, 1.4, 5]
look_at = [0, 0.7, 0]
hfov = \"50 deg\"
size = [16, 12]
velocity = {{ beta = {beta:?} }}
[[object]]
name = \"floor\"
shape = {{ plane = {{ size = [9, 9] }} }}
colour = {floor}"
    )
}

/// The table of a ball in that room, at this place along x.
pub fn ball_at(name: &str, x: f64) -> String {
    format!(
        "[[object]]
name = \"{name}\"
shape = {{ sphere = {{ radius = 0.7, subdivisions = 3 }} }}
transform = {{ translate = [{x}, 0.8, 0] }}"
    )
}

/// The table of a panel in that room, which is to shine.
pub const PANEL: &str = "[[object]]
name = \"panel\"
shape = { box = { size = [2, 0.1, 1] } }
transform = { translate = [-1, 3, 0] }";

/// The tables of a camera that looks straight down from 2 m at a small part of a wide plane, with further `keys`; each moves at its β.
pub fn above_plane(size: u32, camera: [f64; 3], plane: [f64; 3], keys: &str) -> String {
    format!(
        "[camera]
eye = [0, 2, 0]
look_at = [0, 0, -1e-6]
up = [0, 0, -1]
hfov = \"0.5 deg\"
size = [{size}, {size}]
velocity = {{ beta = {camera:?} }}
[[object]]
shape = {{ plane = {{ size = [40, 40] }} }}
colour = [1, 1, 1]
velocity = {{ beta = {plane:?} }}
{keys}"
    )
}

/// World time and place of the emission event.
pub fn event(film: &Film, i: usize) -> (f64, DVec3) {
    let v = |aov| value(film, aov, i);
    let x = DVec3::new(v(Aov::EventX), v(Aov::EventY), v(Aov::EventZ));
    (v(Aov::EventCt), x)
}

/// The object's time and place of the emission event.
pub fn object_event(film: &Film, i: usize) -> (f64, DVec3) {
    let v = |aov| value(film, aov, i);
    let x = DVec3::new(
        v(Aov::ObjectEventX),
        v(Aov::ObjectEventY),
        v(Aov::ObjectEventZ),
    );
    (v(Aov::ObjectEventCt), x)
}

/// World look direction.
pub fn direction(film: &Film, i: usize) -> DVec3 {
    let v = |aov| value(film, aov, i);
    DVec3::new(v(Aov::DirectionX), v(Aov::DirectionY), v(Aov::DirectionZ))
}

/// The look direction in the camera frame through film point `(x, y)` in pixels: the pinhole's
/// definition, written down anew.
pub fn pinhole(camera: &CameraModel, x: f64, y: f64) -> DVec3 {
    let [right, up, forward] = camera.axes;
    let [width, height] = camera.size.map(f64::from);
    let focal = 0.5 * width / (0.5 * camera.horizontal_fov).tan();
    (forward * focal + right * (x - 0.5 * width) - up * (y - 0.5 * height)).normalize()
}

/// The look direction in the camera frame through the centre of pixel `i`.
pub fn through(camera: &CameraModel, i: usize) -> DVec3 {
    let width = camera.size[0] as usize;
    pinhole(camera, (i % width) as f64 + 0.5, (i / width) as f64 + 0.5)
}

/// Asserts that `got` is `expected` to `tolerance` of it.
#[track_caller]
pub fn assert_relative(got: f64, expected: f64, tolerance: f64, what: impl std::fmt::Display) {
    let error = (got - expected).abs();
    assert!(
        error <= tolerance * expected.abs(),
        "{what}: {got:e} is not {expected:e} (relative error {:.1e})",
        error / expected.abs()
    );
}
