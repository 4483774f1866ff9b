//! The figures of Jarabo et al. 2015 in `scenes/paper`: they render, and the numbers in their headers and in
//! `scenes/paper/README.md` are those of the program.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use std::process::Command;

use glam::DVec3;
use nullray::camera::Camera;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::{LoadedCubes, Prepared};
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::model::{CameraModel, Scene};
use nullray::scene::{self, Overrides};
use nullray::spacetime::worldline::{State, WorldLine};
use nullray::spacetime::{
    self, Boost, Direction, Displacement, Event, InertialFrame, Quantity, Velocity,
    WavelengthRatio, World, paper2015,
};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/paper")
}

/// The files of Figures 2 to 11.
fn figures() -> Vec<PathBuf> {
    (2..=11)
        .map(|n| folder().join(format!("figure-{n:02}.toml")))
        .collect()
}

fn tiny() -> Overrides {
    Overrides {
        size: Some([16, 12]),
        samples_per_pixel: Some(1),
        ..Overrides::default()
    }
}

/// All panels of the scene file at `path`, by name.
fn panels(path: &Path, overrides: &Overrides) -> Vec<(String, Scene)> {
    panels_if(path, overrides, |_| true)
}

/// Those of them whose names are asked for.
fn panels_if(
    path: &Path,
    overrides: &Overrides,
    is_asked: impl Fn(&str) -> bool,
) -> Vec<(String, Scene)> {
    let file = scene::SceneFile::read(path).unwrap_or_else(|e| panic!("{e}"));
    let scene = file.scene(overrides).unwrap_or_else(|e| panic!("{e}"));
    let asked = scene.panels.iter().filter(|panel| is_asked(&panel.name));
    let panel = |panel: &scene::model::Panel| {
        let changed = file.panel(&scene, panel, overrides);
        (
            panel.name.clone(),
            changed.unwrap_or_else(|e| panic!("{e}")),
        )
    };
    asked.map(panel).collect()
}

/// The panel of this name of a figure, as the file has it.
fn panel(figure: u32, name: &str) -> Scene {
    let path = folder().join(format!("figure-{figure:02}.toml"));
    let mut found = panels_if(&path, &Overrides::default(), |n| n == name);
    found
        .pop()
        .unwrap_or_else(|| panic!("figure {figure} has no panel {name}"))
        .1
}

/// All of `scene` but its names and texts, with `camera` in place of its own of that size, in words.
fn but_the_camera(scene: &Scene, camera: &CameraModel) -> String {
    let (mut scene, size) = (scene.clone(), scene.camera.size);
    scene.text.clear();
    scene.name.clear();
    scene.caption = None;
    scene.panels.clear();
    scene.read.clear();
    scene.camera = camera.clone();
    scene.camera.size = size;
    format!("{scene:?}")
}

/// What was prepared of the last scene: one that differs from it in its camera alone shares what is loaded and built.
#[derive(Default)]
pub struct Kept {
    /// A camera that stands for all.
    camera: Option<CameraModel>,
    last: Option<(String, Prepared)>,
}

impl Kept {
    /// The scene, prepared for pictures of one `request`; its cubes are among `cubes` if they were before.
    pub fn prepared(
        &mut self,
        scene: &Scene,
        request: &Request,
        cubes: &mut LoadedCubes,
    ) -> &Prepared {
        let camera = self.camera.get_or_insert_with(|| scene.camera.clone());
        let others = but_the_camera(scene, camera);
        let prepared = match self.last.take() {
            Some((alike, mut prepared)) if alike == others => {
                prepared.retake(scene).unwrap();
                prepared
            }
            _ => {
                let plan = Plan::new(scene, request).unwrap();
                Prepared::sharing(scene, &plan, cubes, &Silent).unwrap()
            }
        };
        &self.last.insert((others, prepared)).1
    }
}

#[test]
fn every_panel_renders_to_a_lit_picture() {
    // The test of sheets below prepares each panel by itself.
    let (mut kept, mut cubes) = (Kept::default(), LoadedCubes::default());
    for path in figures() {
        let panels = panels(&path, &tiny());
        assert!(panels.len() >= 3, "{}", path.display());
        for (name, scene) in panels {
            let prepared = kept.prepared(&scene, &Request::default(), &mut cubes);
            let film = render(prepared, &Silent).unwrap();
            let values = film.radiance().iter().flatten();
            let brightest = values.fold(0.0, |brightest, value| {
                assert!(value.is_finite(), "{} {name}", path.display());
                f64::max(brightest, *value)
            });
            assert!(brightest > 0.0, "{} {name} is black", path.display());
        }
    }
}

#[test]
fn all_figures_become_contact_sheets() {
    let directory = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_nullray"));
    command.arg("sheet").args(figures());
    command.args(["--size", "16x12", "--spp", "1", "-q", "--directory"]);
    let output = command.arg(directory.path()).output().unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let sheets = std::fs::read_dir(directory.path()).unwrap().count();
    assert_eq!(sheets, figures().len());
}

#[test]
fn the_sheets_of_the_page_are_there_and_small() {
    let mut total = 0;
    for n in 2..=11 {
        let path = folder().join(format!("sheets/figure-{n:02}.png"));
        let size = std::fs::metadata(&path).unwrap().len();
        assert!(size <= 250_000, "{} has {size} bytes", path.display());
        total += size;
    }
    assert!(total <= 1_600_000, "{total}");
}

/// Rows of the README's table: identifier, the paper's number, the exact one.
fn table() -> Vec<[String; 3]> {
    let text = std::fs::read_to_string(folder().join("README.md")).unwrap();
    let rows = text.lines().filter(|line| line.starts_with("| ("));
    rows.map(|row| {
        let cells: Vec<_> = row.split('|').map(str::trim).collect();
        assert_eq!(cells.len(), 9, "{row}");
        [cells[1], cells[6], cells[7]].map(str::to_string)
    })
    .collect()
}

/// Whether `text`, a number with a unit or without, is `value` rounded to the digits that it has.
fn states(text: &str, value: f64) -> bool {
    let number = text.split(' ').next().unwrap().replace('−', "-");
    let (mantissa, exponent) = number.split_once('e').unwrap_or((&number, "0"));
    let decimals = mantissa
        .split_once('.')
        .map_or(0, |(_, digits)| digits.len());
    let unit = 10f64.powi(exponent.parse().unwrap());
    let half = 0.5 * unit * 10f64.powi(-(decimals as i32));
    (number.parse::<f64>().unwrap() - value).abs() <= half * (1.0 + 1e-9)
}

/// λ′/λ along `look` of a camera that moves along z at β = 0.6.
fn wavelength_ratio(look: DVec3) -> f64 {
    let velocity = Velocity::from_beta(DVec3::Z * 0.6).unwrap();
    let boost = Boost::<World, spacetime::CameraFrame>::new(velocity);
    boost.direction(Direction::new(look).unwrap()).1
}

/// The event at 2 m world distance ahead whose light comes to a camera at β = 0.6 at its time 4 m: in the
/// world, and in its frame as seen from the pinhole.
fn emission() -> (Event<World>, Displacement<spacetime::CameraFrame>) {
    let velocity = Velocity::from_beta(DVec3::Z * 0.6).unwrap();
    let frame = InertialFrame::<spacetime::CameraFrame>::new(velocity, Event::ORIGIN);
    let pinhole = frame.event_to_world(Event::new(4.0, DVec3::ZERO));
    let event = pinhole + Displacement::new(-2.0, DVec3::Z * 2.0);
    (
        event,
        frame.frame_from_world().displacement(event - pinhole),
    )
}

/// Bell's ships from rest, the pinhole 1 m ahead, at proper acceleration 0.5 /m: the sensor when its
/// velocity is 0.8, on a world line that the pinhole's is a copy of.
fn ships() -> (WorldLine, State) {
    let line = WorldLine::hyperbolic(Velocity::REST, Event::ORIGIN, DVec3::Z * 0.5).unwrap();
    let sensor = line.state(libm::atanh(0.8) / 0.5).unwrap();
    (line, sensor)
}

/// How far ahead of the sensor the pinhole is at the sensor's own time, in its frame.
fn simultaneous_distance() -> f64 {
    let (line, sensor) = ships();
    let pinhole = |time: f64| {
        let event = line.state(time).unwrap().event;
        sensor
            .frame()
            .event_from_world(event + Displacement::new(0.0, DVec3::Z))
    };
    let (mut early, mut late) = (sensor.proper_time - 10.0, sensor.proper_time + 10.0);
    for _ in 0..100 {
        let middle = 0.5 * (early + late);
        match pinhole(middle).ct < 0.0 {
            true => early = middle,
            false => late = middle,
        }
    }
    pinhole(late).x.z
}

/// The way of the light from pinhole to sensor in the sensor's frame.
fn lights_way() -> f64 {
    let (line, sensor) = ships();
    let to_sensor = Displacement::new(0.0, -DVec3::Z);
    let crossing = line
        .on_past_light_cone(&sensor, to_sensor)
        .unwrap()
        .displacement;
    let way = Displacement::new(crossing.ct, crossing.x + DVec3::Z);
    sensor
        .frame()
        .frame_from_world()
        .displacement(way)
        .x
        .length()
}

/// The paper's number and the exact one of a row.
fn numbers(row: &str) -> (f64, f64) {
    let ahead = wavelength_ratio(DVec3::Z);
    let d = paper2015::doppler_factor(0.6, PI);
    match row {
        "(a)" => (paper2015::doppler_factor(0.6, 0.0), ahead),
        "(b)" => (
            paper2015::contracted_distance(0.6, PI, 2.0),
            emission().1.x.length(),
        ),
        "(b′)" => {
            let z = paper2015::contracted_distance(0.6, PI, 2.0);
            (paper2015::emission_time(0.6, 4.0, z, 1.0), emission().0.ct)
        }
        "(c)" => {
            let line = Quantity::Line { wavelength: 550e-9 };
            (
                paper2015::radiance_factor(d),
                line.radiance_factor(WavelengthRatio(ahead)),
            )
        }
        "(d)" => {
            let exact = Quantity::PerWavelength.radiance_factor(WavelengthRatio(ahead));
            (paper2015::radiance_factor(d) / d, exact)
        }
        "(e)" => {
            // The motion is along z, the axis along x; light propagates at 120° to the motion.
            let look = DVec3::new(0.75f64.sqrt(), 0.0, 0.5);
            let w = WavelengthRatio(wavelength_ratio(look));
            let paper = paper2015::doppler_factor(0.6, PI * 2.0 / 3.0);
            (
                paper2015::radiance_factor(paper),
                Quantity::PerWavelength.radiance_factor(w),
            )
        }
        "(f)" => (
            paper2015::comoving_separation(0.5, 1.0, 0.8),
            simultaneous_distance(),
        ),
        "(f′)" => (paper2015::comoving_separation(0.5, 1.0, 0.8), lights_way()),
        "(f″)" => {
            let (g, d) = (0.01 / 299_792_458.0, 0.036);
            let resting = paper2015::lorentz_factor(0.99) * d;
            let longer = |g: f64| paper2015::comoving_separation(g, d, 0.99) / resting - 1.0;
            (longer(g), longer(-g))
        }
        "(g)" => {
            let along = |beta: f64| Velocity::from_beta(DVec3::Z * beta).unwrap();
            let exact = along(-0.6).relative_to(along(0.6)).unwrap();
            (paper2015::composed_speed(0.6, -0.6), exact.beta().z)
        }
        other => panic!("{other}: a row that no test knows"),
    }
}

#[test]
fn the_numbers_of_the_page_are_those_of_the_functions() {
    let table = table();
    assert_eq!(table.len(), 10);
    for [row, paper, exact] in table {
        let numbers = numbers(&row);
        assert!(states(&paper, numbers.0), "{row}: {paper} is {}", numbers.0);
        assert!(states(&exact, numbers.1), "{row}: {exact} is {}", numbers.1);
    }
}

#[test]
fn a_number_states_what_it_rounds_and_nothing_else() {
    assert!(states("1.950", 1.9497) && !states("1.950", 1.9506));
    assert!(states("−4.17e-12", -4.1715e-12) && !states("4.17e-12", -4.1715e-12));
    assert!(states("64.00 m", 64.0) && !states("64.00 m", 64.01));
}

/// The focal length that the middle of a picture shows: how far an element is from the middle of the sensor,
/// over the tangent of how far from the axis it looks, in the camera's frame.
fn focal_length(figure: u32, name: &str) -> f64 {
    let scene = panel(figure, name);
    let camera = Camera::new(&scene).unwrap();
    let [width, height] = scene.camera.size.map(f64::from);
    let sensor = scene.camera.sensor.unwrap();
    let pixels = 0.01;
    let pitch = 2.0 * sensor.focal_length * libm::tan(0.5 * scene.camera.horizontal_fov) / width;
    let ray = camera.view.ray(0.5 * width + pixels, 0.5 * height, 0.5);
    let (seen, _) = camera.shot.frame.frame_from_world().direction(ray.d);
    let [right, _, forward] = scene.camera.axes.map(|axis| axis.dot(seen.unit()));
    pixels * pitch * forward / right
}

#[test]
fn accelerating_cameras_have_the_focal_lengths_that_their_figures_derive() {
    for (figure, name, expected) in [
        (3, "alike-0", 0.5),
        (3, "alike-1.5", 0.6632),
        (3, "alike-3", 1.1795),
        (3, "rigid-0", 0.5),
        (3, "rigid-3", 0.5833),
        (6, "caption-0", 0.036),
        (6, "caption-0.6", 0.036 * 1.25),
        (6, "alike-0", 1.0),
        (6, "alike-0.6", 1.3333),
        (6, "rigid-0", 1.0),
        (6, "rigid-0.6", 1.5),
        (6, "rigid-0.9", 1.5),
        (6, "paper-0.6", 1.1140),
        (7, "constant-0.6", 0.7 * 1.25),
        (7, "alike-0", 0.7 * 1.0),
        (7, "alike-0.3", 0.7 * 1.2688),
        (7, "alike-0.6", 0.7 * 1.3846),
        (7, "alike-0.99", 0.7 * 7.0907),
        (7, "rigid-0.3", 0.7 * 1.3346),
        (7, "rigid-0.6", 0.7 * 1.7857),
        (7, "rigid-0.9", 0.7 * 2.1667),
        (7, "paper-0.6", 0.7 * 1.0651),
        (7, "paper-0.99", 0.7 * 1.3555),
    ] {
        let length = focal_length(figure, name);
        assert!(
            (length / expected - 1.0).abs() < 1e-4,
            "{figure} {name}: {length}"
        );
    }
}

#[test]
fn a_camera_longer_in_its_own_frame_sees_as_from_further_back() {
    // γ(0.9) = 2.2942: a focal length of 36 mm is 0.08259 m long, which γ makes 0.18947 m of world time.
    assert!((focal_length(5, "bunny-world-0.9") - 0.08259).abs() < 1e-5);
    let scene = panel(5, "bunny-world-0.9");
    let camera = Camera::new(&scene).unwrap();
    let [width, height] = scene.camera.size.map(f64::from);
    let from = camera.view.ray(0.5 * width, 0.5 * height, 0.5).origin;
    assert!((from.displacement.ct + 0.18947).abs() < 1e-4, "{from:?}");
}

#[test]
fn local_frames_before_and_after_the_turn_are_at_the_same_place() {
    // (cosh 1 − 1)/0.5 = 1.0862 m behind, 2 sinh 1 = 2.3504 m before and after.
    let event = |name| Camera::new(&panel(8, name)).unwrap().shot.event;
    let (before, still, after) = (event("approaching"), event("still"), event("receding"));
    assert!((before.x - after.x).length() < 1e-12);
    assert!(((before.x - still.x) - DVec3::Z * 1.0862).length() < 1e-4);
    assert!((after.ct - still.ct - 2.3504).abs() < 1e-4);
}

#[test]
fn tiles_of_the_turning_sensor_move_with_their_place() {
    let path = folder().join("figure-09.toml");
    let panels = panels(&path, &Overrides::default());
    let rates: Vec<_> = panels.iter().map(|(_, scene)| tiles_turn(scene)).collect();
    assert_eq!(rates, [0.0, 0.3, 0.6, 0.9]);
}

/// Ω of the sensor in `scene`, 1/m, all of whose tiles have been seen to move with Ω × r from their place r
/// at world time 0.
fn tiles_turn(scene: &Scene) -> f64 {
    let camera = &scene.camera;
    assert_eq!(camera.origin.ct, 0.0);
    let rate = camera.velocity.beta().z / camera.origin.x.y;
    let omega = DVec3::X * rate;
    let close = |a: DVec3, b: DVec3| (a - b).length() < 1e-5;
    // The camera is 2 cm above its element, along its motion.
    let element = camera.origin.x.with_z(0.0);
    assert!(close(camera.velocity.beta(), omega.cross(element)));
    let tiles = scene.objects.iter().filter(|o| o.name != "pinhole");
    let mut places = Vec::new();
    for tile in tiles {
        let place = tile.origin.x.with_z(0.0);
        assert_eq!(tile.origin.ct, 0.0, "{}", tile.name);
        assert!(
            close(tile.velocity.beta(), omega.cross(place)),
            "{}",
            tile.name
        );
        assert!(!places.contains(&place), "{}: two at one place", tile.name);
        places.push(place);
    }
    assert_eq!(places.len(), 91);
    assert!(places.contains(&element), "no tile under the camera");
    (rate * 1e9).round() / 1e9
}

#[test]
fn edges_of_a_turning_sensor_see_the_wavelengths_that_its_figure_derives() {
    for (name, left, right) in [("exact-0.4", 384.1, 733.0), ("comoving-0.4", 412.7, 787.5)] {
        let scene = panel(10, name);
        let camera = Camera::new(&scene).unwrap();
        let [width, height] = scene.camera.size.map(f64::from);
        for (x, expected) in [(0.0, left), (width, right)] {
            let observed = 550.0 * camera.view.ray(x, 0.5 * height, 0.5).ratio;
            assert!((observed - expected).abs() < 0.1, "{name}: {observed} nm");
        }
    }
}

#[test]
fn a_turning_sensor_covers_what_its_figure_derives() {
    // Uncovered, as parts of the half width: to 0.741 on the red side.
    for (name, left, right) in [
        ("aberrated-0.99", None, Some(0.741)),
        ("paper-0.99", Some(0.741), None),
    ] {
        let scene = panel(11, name);
        let camera = Camera::new(&scene).unwrap();
        let [width, height] = scene.camera.size.map(f64::from);
        let sees = |part: f64| {
            let x = 0.5 * width * (1.0 + part);
            camera.view.ray(x, 0.5 * height, 0.5).origin.sees()
        };
        for (side, limit) in [(-1.0, left), (1.0, right)] {
            let limit: f64 = limit.unwrap_or(1.0);
            assert!(sees(side * (limit - 0.002)), "{name} {side}");
            assert_eq!(
                sees(side * (limit + 0.002).min(1.0)),
                limit == 1.0,
                "{name} {side}"
            );
        }
    }
}

/// Rows of the README's table of captions: file, beginning of the panels' names, what is listed, and the values.
fn captions() -> Vec<[String; 4]> {
    let text = std::fs::read_to_string(folder().join("README.md")).unwrap();
    let rows = text.lines().filter(|line| line.contains("| `figure-"));
    rows.map(|row| {
        let cells: Vec<_> = row.split('|').map(str::trim).collect();
        assert_eq!(cells.len(), 8, "{row}");
        [cells[3], cells[4], cells[5], cells[6]].map(|cell| cell.trim_matches('`').to_string())
    })
    .collect()
}

/// What a row lists, of a diagram: the camera's speed, the sensor's times, or the speeds of the curves.
fn in_diagram(file: &str) -> Vec<f64> {
    let path = folder().join(file);
    let model = nullray::figures::diagram::load(&path, &Overrides::default()).unwrap();
    let unit = model.unit.metres;
    let rounded = |value: f64| (value * 1e6).round() / 1e6;
    match file {
        "figure-03.toml" => {
            let moving = model.frames.iter().find(|frame| frame.name == "S'");
            vec![rounded(moving.unwrap().frame.velocity().beta().length())]
        }
        "figure-08.toml" => {
            let sensor = &model.lines[0].track;
            let time = |k: usize| {
                let frame = &model.frames[k].frame;
                let moment = sensor.where_zero(|event| event.ct - frame.origin().ct);
                let moment = moment.unwrap();
                assert!((moment.event.x - frame.origin().x).length() < 1e-6 * unit);
                (moment.proper_time / unit).round()
            };
            (1..=3).map(time).collect()
        }
        // The velocity at the sensor's edge, where each of the first curves ends.
        "figure-10.toml" => {
            let ends = model.curves.iter().take(4).map(|curve| curve.points.last());
            ends.map(|end| rounded(end.unwrap().ct / unit)).collect()
        }
        _ => (0..model.curves.len()).map(|k| k as f64 / 10.0).collect(),
    }
}

/// What a row lists, of one panel.
fn listed(what: &str, scene: &Scene) -> f64 {
    let camera = &scene.camera;
    let shot = Camera::new(scene).unwrap().shot;
    match what {
        "β of the camera" => shot.frame.velocity().beta().length(),
        "ΩR" => {
            let sensor = camera.sensor.unwrap();
            let half = sensor.focal_length * libm::tan(0.5 * camera.horizontal_fov);
            camera.rotation.unwrap().rate * half
        }
        other => panic!("{other}: nothing that a test knows"),
    }
}

#[test]
fn panels_have_the_values_of_the_captions() {
    let rows = captions();
    assert_eq!(rows.len(), 29);
    let mut checked = 0;
    for [file, prefix, what, values] in rows {
        let values: Vec<f64> = values
            .split(", ")
            .map(|value| value.replace('−', "-").parse().unwrap())
            .collect();
        if what == "diagram" {
            assert_eq!(in_diagram(&file), values, "{file}");
            continue;
        }
        let all = panels(&folder().join(&file), &Overrides::default());
        let is_listed = |name: &str| {
            let rest = name.strip_prefix(prefix.as_str());
            rest.is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
        };
        let own: Vec<_> = all.iter().filter(|(name, _)| is_listed(name)).collect();
        assert_eq!(own.len(), values.len(), "{file} {prefix}");
        for ((name, scene), value) in own.into_iter().zip(values) {
            let found = listed(&what, scene);
            assert!((found - value).abs() < 1e-6, "{file} {name}: {found}");
            checked += 1;
        }
    }
    assert!(checked > 100, "{checked}");
}

/// What the captions of the paper say: all values, or the first and the last where they give these alone.
const PAPER: [(&str, &str, &[f64]); 16] = [
    ("figure-03.toml", "[diagram]", &[0.2]),
    (
        "figure-04.toml",
        "aberration-towards-",
        &[0.0, 0.3, 0.6, 0.9, 0.99],
    ),
    (
        "figure-04.toml",
        "aberration-away-",
        &[0.0, 0.3, 0.6, 0.9, 0.99],
    ),
    (
        "figure-04.toml",
        "doppler-towards-",
        &[0.0, 0.15, 0.25, 0.35, 0.5, 0.55],
    ),
    (
        "figure-04.toml",
        "searchlight-towards-",
        &[0.0, 0.2, 0.3, 0.4, 0.5],
    ),
    ("figure-05.toml", "cube-camera-", &[0.0, 0.77]),
    ("figure-05.toml", "cube-world-", &[0.0, 0.77]),
    ("figure-05.toml", "bunny-camera-", &[0.2, 0.9]),
    ("figure-05.toml", "bunny-world-", &[0.2, 0.9]),
    ("figure-06.toml", "caption-", &[0.0, 0.9]),
    ("figure-07.toml", "constant-", &[0.0, 0.99]),
    ("figure-07.toml", "alike-", &[0.0, 0.99]),
    ("figure-09.toml", "[diagram]", &[0.0, 0.9]),
    ("figure-10.toml", "[diagram]", &[0.0, 0.4, 0.8, 0.99]),
    (
        "figure-11.toml",
        "aberration-",
        &[0.0, 0.25, 0.5, 0.75, 0.99],
    ),
    (
        "figure-11.toml",
        "aberrated-",
        &[0.0, 0.25, 0.5, 0.75, 0.99],
    ),
];

#[test]
fn the_page_lists_the_values_of_the_paper_s_captions() {
    let rows = captions();
    for (file, prefix, values) in PAPER {
        let row = rows.iter().find(|row| row[0] == file && row[1] == prefix);
        let row = row.unwrap_or_else(|| panic!("{file} {prefix}"));
        let listed: Vec<f64> = row[3].split(", ").map(|v| v.parse().unwrap()).collect();
        match values {
            [first, last] => {
                let ends = [listed[0], listed[listed.len() - 1]];
                assert_eq!(ends, [*first, *last], "{file} {prefix}");
                assert!(listed.len() >= 5 && listed.is_sorted(), "{file} {prefix}");
            }
            all => assert_eq!(listed, *all, "{file} {prefix}"),
        }
    }
}

#[test]
fn each_figure_has_one_white_and_panels_of_one_size() {
    for path in figures() {
        let scenes = panels(&path, &Overrides::default());
        let (_, first) = &scenes[0];
        // None is made for each picture.
        use nullray::scene::model::Exposure::{Logarithmic, White};
        assert!(
            matches!(first.exposure, White(_) | Logarithmic(_)),
            "{}",
            path.display()
        );
        for (name, scene) in &scenes {
            assert_eq!(scene.exposure, first.exposure, "{} {name}", path.display());
            assert_eq!(scene.times, first.times, "{} {name}", path.display());
            let isochrones = name.starts_with("times");
            assert!(
                isochrones || scene.camera.size == first.camera.size,
                "{name}"
            );
        }
    }
}

#[test]
fn lasers_have_the_wavelengths_of_the_caption() {
    for (prefix, expected) in [("doppler", 670e-9), ("searchlight", 508e-9)] {
        let path = folder().join("figure-04.toml");
        for (name, scene) in panels(&path, &Overrides::default()) {
            if name.starts_with(prefix) {
                let Quantity::Line { wavelength } = scene.quantity else {
                    panic!("{name} has no line");
                };
                assert!((wavelength / expected - 1.0).abs() < 1e-12, "{name}");
            }
        }
    }
}

/// The one panel, or the panels, of a figure's diagram.
fn diagram(figure: u32) -> Vec<nullray::figures::diagram::Panel> {
    let path = folder().join(format!("figure-{figure:02}.toml"));
    let model = nullray::figures::diagram::load(&path, &Overrides::default()).unwrap();
    nullray::figures::diagram::layout(&model).panels
}

#[test]
fn the_diagram_of_figure_3_has_the_numbers_of_its_header() {
    // d/γ = 0.5 · √0.96 = 0.4899 m ahead; light under way for d/(γ(1 + β)) = 0.4082 m, along a line at 45°.
    let panels = diagram(3);
    let panel = &panels[0];
    let [sensor, pinhole] = [0, 1].map(|i| &panel.world_lines[i].curve.points);
    for line in [sensor, pinhole] {
        let (a, b) = (line[0], line[line.len() - 1]);
        assert!(((b.x - a.x) / (b.ct - a.ct) - 0.2).abs() < 1e-6);
    }
    let at = |line: &[nullray::figures::diagram::Point], ct: f64| {
        let (a, b) = (line[0], line[line.len() - 1]);
        a.x + (b.x - a.x) * (ct - a.ct) / (b.ct - a.ct)
    };
    assert!((at(pinhole, 0.3) - at(sensor, 0.3) - 0.4899).abs() < 1e-4);
    assert!(at(sensor, 0.0).abs() < 1e-5);
    let [from, to] = panel.signals[0].ends;
    assert!((to.ct - from.ct - 0.4082).abs() < 1e-4);
    assert!((from.x - to.x - 0.4082).abs() < 1e-4);
    // The sensor's axes: its own line, and ct = β x.
    let axes = panel.axes.iter().find(|axes| axes.frame > 0).unwrap();
    let [a, b] = axes.space.ends;
    assert!(((b.ct - a.ct) / (b.x - a.x) - 0.2).abs() < 1e-6);
}

#[test]
fn the_four_diagrams_of_figure_8_are_those_of_the_caption() {
    // Of the sensor at its times 200, 400, 600 s with g = 0.002 c/s.
    let panels = diagram(8);
    assert_eq!(panels.len(), 4);
    let expected = [[205.38, 40.54], [444.05, 168.72], [754.73, 405.33]];
    for (event, [ct, x]) in panels[0].events.iter().zip(expected) {
        assert!((event.at.ct - ct).abs() < 0.01, "{:?}", event.at);
        assert!((event.at.x - x).abs() < 0.01, "{:?}", event.at);
    }
    // In its own frame each is at the origin.
    for (k, panel) in panels[1..].iter().enumerate() {
        let at = panel.events[k].at;
        assert!(at.ct.abs() < 1e-6 && at.x.abs() < 1e-6, "{at:?}");
    }
    // From rest: before time 0 the world lines are upright, 150 light-seconds apart.
    let before: Vec<f64> = (0..2)
        .map(|i| panels[0].world_lines[i].curve.points[0].x)
        .collect();
    assert!(before[0].abs() < 1e-9 && (before[1] - 150.0).abs() < 1e-9);
}

#[test]
fn the_velocity_field_of_figure_10_is_that_of_a_rotation() {
    let panels = diagram(10);
    let curves = &panels[0].curves;
    assert_eq!(curves.len(), 4 + 8);
    for (curve, edge) in curves.iter().zip([0.0, 0.4, 0.8, 0.99]) {
        for p in &curve.points {
            assert!((p.ct - edge * p.x).abs() < 1e-9, "{p:?}");
        }
    }
    // From the sensor to the velocity of the fastest.
    for curve in &curves[4..] {
        let [from, to] = [curve.points[0], curve.points[1]];
        assert!(
            from.ct == 0.0 && (to.ct - 0.99 * to.x).abs() < 1e-9,
            "{curve:?}"
        );
    }
}

#[test]
fn the_plot_of_figure_9_is_the_aberrated_sensor() {
    // Directions by composition of velocities, distances by Doppler: an element that moves with v′ is at the elevation
    // arcsin V, V = (v − v′)/(1 − v v′), at the distance γ_V Δ, because the light's time in the element's frame is Δ.
    let panels = diagram(9);
    let panel = &panels[0];
    assert_eq!(panel.curves.len(), 10);
    let gamma = |v: f64| 1.0 / (1.0 - v * v).sqrt();
    for (k, curve) in panel.curves.iter().enumerate() {
        let v = k as f64 / 10.0;
        for p in &curve.points {
            let w = v * p.x;
            let relative = (v - w) / (1.0 - v * w);
            let height = gamma(relative) * (1.0 - p.x) * relative;
            assert!((p.ct - height).abs() < 1e-4 * (1.0 + height), "{v} {p:?}");
        }
        // The pinhole, at rest at 45°: aberrated to arcsin (s + v)/(1 + s v), its distance from the axis kept.
        let s = 0.5f64.sqrt();
        let sine = (s + v) / (1.0 + s * v);
        let at = panel.events[k].at;
        assert!((at.ct - sine * gamma(sine)).abs() < 1e-4, "{v} {at:?}");
    }
}

/// The figures whose light is baked, by their files.
const IN_THE_HALL: [&str; 9] = [
    "figure-03",
    "figure-04",
    "figure-05",
    "figure-06",
    "figure-07",
    "figure-08",
    "figure-10",
    "figure-11",
    "paper-and-exact",
];

#[test]
fn the_figures_with_bunny_and_dragon_look_light_up_that_was_baked_in_their_hall() {
    let hall = scene::load(&folder().join("hall-lit.toml"), &Overrides::default()).unwrap();
    assert_eq!(hall.lights.len(), 3);
    let names: Vec<_> = hall.objects.iter().map(|o| o.name.clone()).collect();
    for figure in IN_THE_HALL {
        let path = folder().join(format!("{figure}.toml"));
        let (_, scene) = panels(&path, &Overrides::default()).remove(0);
        let own: Vec<_> = scene.objects.iter().map(|o| o.name.clone()).collect();
        assert_eq!(own, names, "{figure}");
        for (here, baked) in scene.objects.iter().zip(&hall.objects) {
            assert_eq!(here.transform, baked.transform, "{figure} {}", here.name);
        }
        let sources: Vec<_> = scene.sources.iter().map(|s| s.name.clone()).collect();
        let lit: Vec<_> = names.iter().map(|n| format!("light on {n}")).collect();
        assert_eq!(sources, lit, "{figure}");
        // Nothing is said of light that lasts beyond the data, as it is held.
        let plan = Plan::new(&scene, &Request::default()).unwrap();
        let warnings = Prepared::new(&scene, &plan, &Silent).unwrap().warnings;
        assert!(warnings.is_empty(), "{figure}: {warnings:?}");
    }
}

/// Figure 4 at rest, by its baked light and by paths: sums over quarters of the picture agree to 5 %, which is what texels and bins leave.
#[test]
fn the_light_of_the_hall_is_what_paths_find() {
    let small = |samples| Overrides {
        size: Some([32, 24]),
        samples_per_pixel: Some(samples),
        ..Overrides::default()
    };
    let quarters = |scene: &Scene| {
        let request = Request::default();
        let plan = Plan::new(scene, &request).unwrap();
        let film = render(&Prepared::new(scene, &plan, &Silent).unwrap(), &Silent).unwrap();
        let mut sums = [0.0; 4];
        for (k, pixel) in film.radiance().iter().enumerate() {
            let (column, row) = (k % 32, k / 32);
            sums[2 * (row / 12) + column / 16] += pixel.iter().sum::<f64>();
        }
        sums
    };
    let lit = scene::load(&folder().join("hall-lit.toml"), &small(256)).unwrap();
    let figure = panels(&folder().join("figure-04.toml"), &small(64)).remove(0);
    assert_eq!(figure.0, "aberration-towards-0");
    let (baked, traced) = (quarters(&figure.1), quarters(&lit));
    for (baked, traced) in baked.into_iter().zip(traced) {
        assert!((baked / traced - 1.0).abs() < 0.05, "{baked} {traced}");
    }
}
