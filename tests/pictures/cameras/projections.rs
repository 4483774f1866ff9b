//! Fisheyes, panoramas and stereo pairs, against their definitions, solid angles and aberration in closed form.

use std::f64::consts::PI;
use std::path::Path;

use glam::DVec3;
use nullray::camera::{AnyProjection, Camera, Projection, ViewKind};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::{film::Film, render};
use nullray::scene::model::{ProjectionKind, Scene};
use nullray::scene::{self, Overrides};
use nullray::spacetime::{Event, Velocity};

const AXES: [DVec3; 3] = [DVec3::X, DVec3::Y, DVec3::NEG_Z];
const KINDS: [(ProjectionKind, f64); 5] = [
    (ProjectionKind::Perspective, 1.2),
    (ProjectionKind::FisheyeEquidistant, 2.0 * PI),
    (ProjectionKind::FisheyeEquisolid, 2.0 * PI),
    (ProjectionKind::FisheyeOrthographic, PI),
    (ProjectionKind::Equirectangular, 2.0 * PI),
];

fn scene(text: &str) -> Result<Scene, nullray::Error> {
    scene::parse(text, "test", Path::new(""), &Overrides::default())
}

fn film(scene: &Scene) -> Film {
    let request = Request {
        pixel_centers: true,
        ..Request::default()
    };
    let plan = Plan::new(scene, &request).unwrap();
    let prepared = Prepared::new(scene, &plan, &Silent).unwrap();
    render(&prepared, &Silent).unwrap()
}

/// The radiance of a pixel.
fn pixel(film: &Film, column: usize, row: usize) -> [f64; 3] {
    film.radiance()[row * film.size()[0] as usize + column]
}

/// The solid angle of a spherical triangle of unit vectors (Van Oosterom & Strackee 1983).
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let product = a.dot(b.cross(c));
    2.0 * product.abs().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

/// What a small square about (x, y) sees, per area of the film.
fn density(film: &AnyProjection, x: f64, y: f64) -> f64 {
    const STEP: f64 = 1e-3;
    let at = |dx, dy| film.direction(x + dx * STEP, y + dy * STEP).unit();
    let [a, b, c, d] = [at(-0.5, -0.5), at(0.5, -0.5), at(0.5, 0.5), at(-0.5, 0.5)];
    (solid_angle([a, b, c]) + solid_angle([a, c, d])) / (STEP * STEP)
}

#[test]
fn a_direction_is_seen_where_the_film_looks_that_way() {
    for (kind, fov) in KINDS {
        let film = AnyProjection::of_kind(kind, AXES, fov, [40.0, 20.0]);
        for (column, row) in [(0, 10), (3, 2), (20, 10), (20, 1), (37, 18), (39, 9)] {
            let (x, y) = (f64::from(column) + 0.3, f64::from(row) + 0.4);
            assert!(film.sees(x, y) || kind != ProjectionKind::Equirectangular);
            if !film.sees(x, y) {
                continue;
            }
            let d = film.vector(x, y);
            let [u, v] = film.film_point(film.along_axes(d)).unwrap();
            assert!(
                (u - x).abs() + (v - y).abs() < 1e-9,
                "{kind:?} {x} {y}: {u} {v}"
            );
        }
        let middle = film.direction(20.0, 10.0).unit();
        assert_eq!(middle, DVec3::NEG_Z, "{kind:?}");
    }
}

#[test]
fn fisheyes_show_angles_at_the_distances_of_their_definition() {
    for theta in [0.1, 0.7, 1.5] {
        for (kind, distance) in [
            (ProjectionKind::FisheyeEquidistant, theta),
            (
                ProjectionKind::FisheyeEquisolid,
                2.0 * f64::sin(theta / 2.0),
            ),
            (ProjectionKind::FisheyeOrthographic, f64::sin(theta)),
        ] {
            // Half of a field of view of 2 rad is at half the width.
            let edge = match kind {
                ProjectionKind::FisheyeEquidistant => 1.0,
                ProjectionKind::FisheyeEquisolid => 2.0 * f64::sin(0.5),
                _ => f64::sin(1.0),
            };
            let film = AnyProjection::of_kind(kind, AXES, 2.0, [200.0, 100.0]);
            let r = 100.0 * distance / edge;
            let d = film.direction(100.0 + 0.6 * r, 50.0 - 0.8 * r).unit();
            let (sin, cos) = theta.sin_cos();
            let expected = DVec3::new(0.6 * sin, 0.8 * sin, -cos);
            assert!((d - expected).length() < 1e-14, "{kind:?} {theta}: {d}");
        }
    }
}

#[test]
fn the_pixels_of_a_panorama_see_the_whole_sphere_and_those_of_an_equisolid_fisheye_equal_parts() {
    let (width, height) = (64, 32);
    let panorama = ProjectionKind::Equirectangular;
    let film = AnyProjection::of_kind(panorama, AXES, 2.0 * PI, [64.0, 32.0]);
    let mut sum = 0.0;
    for row in 0..height {
        // Latitudes of the row's edges; φ = π/2 is the top.
        let sine = |row: i32| (PI / 2.0 - PI * f64::from(row) / f64::from(height)).sin();
        let pixel = (sine(row) - sine(row + 1)) * 2.0 * PI / f64::from(width);
        sum += pixel * f64::from(width);
        let middle = density(&film, 10.25, f64::from(row) + 0.5);
        // cos φ at the middle times Δ²; the mean over the row is sin(Δ/2)/(Δ/2) of it.
        let half = PI / f64::from(height) / 2.0;
        assert!(
            (middle * half.sin() / half / pixel - 1.0).abs() < 1e-4,
            "{row}"
        );
    }
    assert!((sum / (4.0 * PI) - 1.0).abs() < 1e-14);
    let equisolid = ProjectionKind::FisheyeEquisolid;
    let film = AnyProjection::of_kind(equisolid, AXES, 2.0 * PI, [80.0, 80.0]);
    // F = 40 px / 2: each pixel has 1/400 sr, and the disc of 1600 π pixels all 4π.
    for (x, y) in [(40.0, 40.0), (55.0, 30.0), (70.0, 62.0), (1.5, 40.0)] {
        assert!((density(&film, x, y) * 400.0 - 1.0).abs() < 1e-5, "{x} {y}");
    }
}

/// tan(θ′/2) = √((1 − β)/(1 + β)) tan(θ/2) (Penrose 1959), θ from the direction of motion: a circle about
/// the middle of an equidistant fisheye is another one.
#[test]
fn circles_of_a_fisheye_are_aberrated_to_circles() {
    for beta in [0.5, 0.99, -0.9] {
        let mut scene = scene(
            "camera = { eye = [0, 0, 0], look_at = [0, 0, -1], size = [200, 200], \
             projection = \"fisheye_equidistant\", hfov = \"360 deg\" }\n\
             object = [{ shape = { sphere = { radius = 1 } } }]",
        )
        .unwrap();
        scene.camera.velocity = Velocity::from_beta(DVec3::NEG_Z * beta).unwrap();
        let camera = Camera::new(&scene).unwrap();
        let factor = ((1.0 - beta) / (1.0 + beta)).sqrt();
        for seen in [0.3_f64, 1.2, 2.9] {
            let r = 100.0 * seen / PI;
            let theta = 2.0 * ((0.5 * seen).tan() / factor).atan();
            for azimuth in [0.1_f64, 2.0, 4.0] {
                let (sin, cos) = azimuth.sin_cos();
                let ray = camera.view.ray(100.0 + r * cos, 100.0 - r * sin, 0.0);
                let across = theta.sin();
                let expected = DVec3::new(across * cos, across * sin, -theta.cos());
                assert!((ray.d.unit() - expected).length() < 1e-12, "{beta} {seen}");
                assert!(ray.origin.sees());
            }
        }
        // The corners of the film are beyond the circle that sees something. It is a point camera all the same.
        assert_eq!(camera.view.kind(), ViewKind::Moving);
        assert!(camera.has_blind_points() && camera.view.point().is_none());
        assert!(!camera.view.ray(0.5, 0.5, 0.0).origin.sees());
    }
}

/// In a uniform surrounding of radiance 1 the camera sees W⁻⁴ from each direction, W = γ(1 − β cos θ′), of
/// which the integral over all directions is 4π γ²(1 + β²/3): the energy density of an isotropic gas of
/// photons in motion.
#[test]
fn a_panorama_in_motion_has_the_beamed_total() {
    let text = "\
camera = { eye = [0.1, 0, 0], look_at = [0.1, 0, -1], size = [128, 64], projection = \"equirectangular\", \
velocity = { beta = [0.3, 0.4, 0.3] } }
object = [{ shape = { box = { size = [4, 4, 4] } }, colour = [1, 1, 1] }]
display = { back_faces = \"two_sided\" }
radiance = { quantity = \"integrated\" }
";
    let film = film(&scene(text).unwrap());
    let mut sum = 0.0;
    for row in 0..64 {
        let sine = |row: usize| (PI / 2.0 - PI * row as f64 / 64.0).sin();
        let solid = (sine(row) - sine(row + 1)) * 2.0 * PI / 128.0;
        sum += (0..128)
            .map(|column| solid * self::pixel(&film, column, row)[0])
            .sum::<f64>();
    }
    // β² = 0.34.
    let expected = 4.0 * PI / 0.66 * (1.0 + 0.34 / 3.0);
    // The midpoint rule on a grid of 2.8° is off by about a thousandth of that.
    assert!((sum / expected - 1.0).abs() < 2e-3, "{sum} {expected}");
}

const PAIR: &str = "\
[camera]
eye = [0.2, 0.1, 5]
look_at = [0.2, 0, 0]
size = [40, 16]
hfov = \"90 deg\"
velocity = { beta = [0.3, 0.1, -0.2] }
time = \"0.3 m\"
[camera.stereo]
interpupillary_distance = \"0.4 m\"
[[object]]
shape = { box = { size = [3, 3, 3] } }
velocity = { beta = [0, 0.1, 0] }
";

#[test]
fn the_eyes_of_a_stereo_pair_are_simultaneous_in_the_cameras_frame() {
    let scene = scene(PAIR).unwrap();
    let camera = Camera::new(&scene).unwrap();
    assert_eq!(camera.view.kind(), ViewKind::Stereo);
    let right = scene.camera.axes[0];
    for (x, side) in [(3.5, -0.2), (19.5, -0.2), (20.5, 0.2), (33.5, 0.2)] {
        let ray = camera.view.ray(x, 4.0, 0.0);
        let own = camera.shot.frame.frame_from_world();
        let eye = own.displacement(ray.origin.displacement);
        assert!(eye.ct.abs() < 1e-15);
        assert!((eye.x - right * side).length() < 1e-15);
        // Both look alike.
        let twin = camera.view.ray((x + 20.0) % 40.0, 4.0, 0.0);
        assert_eq!(ray.d, twin.d);
    }
}

#[test]
fn either_half_of_a_stereo_pair_is_the_picture_of_a_camera_there() {
    let pair = scene(PAIR).unwrap();
    let seen = film(&pair);
    let shot = Camera::new(&pair).unwrap().shot;
    for (side, first) in [(-0.2, 0), (0.2, 20)] {
        let mut one = pair.clone();
        one.camera.stereo = None;
        one.camera.size = [20, 16];
        let offset = nullray::spacetime::Displacement::new(0.0, one.camera.axes[0] * side);
        let moved = shot.frame.world_from_frame().displacement(offset);
        one.camera.origin = Event::new(
            one.camera.origin.ct + moved.ct,
            one.camera.origin.x + moved.x,
        );
        let expected = film(&one);
        let mut lit = 0;
        for row in 0..16 {
            for column in 0..20 {
                let (a, b) = (
                    pixel(&seen, first + column, row),
                    pixel(&expected, column, row),
                );
                lit += u32::from(b[0] > 0.0);
                assert!((a[0] - b[0]).abs() < 1e-9, "{column} {row}: {a:?} {b:?}");
            }
        }
        assert!(lit > 10);
    }
}

#[test]
fn invalid_cameras_are_refused_with_the_position_of_the_error() {
    let one = |keys: &str| {
        let text = format!(
            "camera = {{ eye = [0, 0, 0], look_at = [0, 0, -1], {keys} }}\n\
             object = [{{ shape = {{ sphere = {{ radius = 1 }} }} }}]"
        );
        scene(&text).unwrap_err().to_string()
    };
    for (keys, what) in [
        (
            "projection = 'fisheye_orthographic', hfov = '190 deg'",
            "camera.hfov: a field of view of 190 deg is not between 0 and 180",
        ),
        (
            "projection = 'equirectangular', hfov = '361 deg'",
            "camera.hfov: a field of view of 361 deg is not between 0 and 360",
        ),
        ("projection = 'equidistant'", "camera.projection"),
        (
            "projection = 'equirectangular', sensor = { focal_length = '1 cm' }",
            "camera.sensor: a sensor is a plane behind a pinhole",
        ),
        (
            "size = [41, 20], stereo = { interpupillary_distance = '6 cm' }",
            "camera.size: 41 columns cannot be shared",
        ),
        (
            "stereo = { interpupillary_distance = '-6 cm' }",
            "camera.stereo.interpupillary_distance: the pupils are -6 cm apart",
        ),
        (
            "sensor = { focal_length = '1 cm' }, stereo = { interpupillary_distance = '6 cm' }",
            "camera.sensor: the eyes of a stereo pair are points",
        ),
        (
            "rotation = { axis = [0, 1, 0], rate = '1 rad/m' }, stereo = { interpupillary_distance = '6 cm' }",
            "camera.rotation: the eyes",
        ),
        (
            "shutter = { duration = '1 m' }, motion = { acceleration = { proper = '1 /m', direction = [1, 0, 0] } }, stereo = { interpupillary_distance = '6 cm' }",
            "camera.shutter: two accelerating eyes",
        ),
    ] {
        let found = one(keys);
        assert!(found.contains(what), "{keys}: {found}");
    }
}
