//! Lookups by projection into a capture camera, against a scene whose radiance is known everywhere:
//! a plane z = 0 and a sphere on it, lit by a Gaussian wave front g(t − |P − light|).

use glam::DVec3;
use nullray::io::cube::{Cube, CubeSamples};
use nullray::light::time_texture::{
    Capture, CapturePoint, Coverage, Sampled, SeenPoint, TimeAxis, TimeTexture,
};
use nullray::scene::model::{BinValues, CaptureCamera, Fill, TimeBins, TimeFilter};

use crate::time_texture::{everywhere, filled};

const SIZE: usize = 192;
const BINS: usize = 160;
const BIN_WIDTH: f64 = 0.05;
const EYE: DVec3 = DVec3::new(0.0, -4.0, 3.0);
const LIGHT: DVec3 = DVec3::new(1.5, 1.0, 2.5);
const CENTRE: DVec3 = DVec3::new(-0.3, 0.2, 0.6);
const RADIUS: f64 = 0.6;

fn wave(p: DVec3, t: f64) -> f64 {
    let x = (t - p.distance(LIGHT)) / 0.12;
    (-0.5 * x * x).exp()
}

fn camera() -> CaptureCamera {
    let forward = (DVec3::new(0.0, 0.3, 0.3) - EYE).normalize();
    let right = forward.cross(DVec3::Z).normalize();
    CaptureCamera::new(EYE, [right, right.cross(forward), forward], 0.7)
}

fn sphere(origin: DVec3, direction: DVec3) -> Option<SeenPoint> {
    let b = (CENTRE - origin).dot(direction);
    let discriminant = b * b - (origin.distance_squared(CENTRE) - RADIUS * RADIUS);
    let distance = b - discriminant.max(0.0).sqrt();
    (discriminant > 0.0 && distance > 1e-9).then(|| SeenPoint {
        distance,
        normal: (origin + direction * distance - CENTRE) / RADIUS,
    })
}

fn plane(origin: DVec3, direction: DVec3) -> Option<SeenPoint> {
    let distance = -origin.z / direction.z;
    (distance > 1e-9).then_some(SeenPoint {
        distance,
        normal: DVec3::NEG_Z, // the side does not matter
    })
}

fn trace(origin: DVec3, direction: DVec3) -> Option<SeenPoint> {
    sphere(origin, direction).or_else(|| plane(origin, direction))
}

/// Brute force: whether the sphere is between the point and the eye.
fn occluded(point: DVec3, eye: DVec3) -> bool {
    let way = point - eye;
    let hit = sphere(eye, way.normalize());
    hit.is_some_and(|hit| hit.distance < way.length() - 1e-6)
}

fn nothing_occludes(_: DVec3, _: DVec3) -> bool {
    false
}

/// A capture of the scene: its camera with the pixels' distances, and the recorded cube.
fn capture(index: Option<f64>, fill: Fill) -> (Capture, TimeTexture) {
    let capture = Capture::new(
        &camera(),
        [SIZE; 2],
        index.is_some(),
        index.unwrap_or(1.0),
        trace,
    );
    let start = 1.0 + index.unwrap_or(0.0) * 4.0;
    let mut samples = Vec::new();
    for pixel in 0..SIZE * SIZE {
        let distance = capture.distance(pixel);
        let seen = distance.map(|d| EYE + d * direction_through(pixel));
        let delay = index.unwrap_or(0.0) * distance.unwrap_or(0.0);
        samples.extend((0..BINS).map(|k| {
            let t = start + (k as f64 + 0.5) * BIN_WIDTH;
            seen.map_or(0.0, |p| wave(p, t - delay))
        }));
    }
    let axis = TimeAxis {
        bins: TimeBins::Uniform {
            start,
            width: BIN_WIDTH,
        },
        values: BinValues::Density,
        filter: TimeFilter::Cubic,
        scale: 1.0,
    };
    let cube = Cube::new([SIZE, SIZE, BINS, 1], CubeSamples::F64(samples)).unwrap();
    (
        capture,
        TimeTexture::new(cube, axis, everywhere(fill)).unwrap(),
    )
}

fn direction_through(pixel: usize) -> DVec3 {
    let [right, up, forward] = camera().axes;
    let scale = 2.0 * (0.35f64).tan() / SIZE as f64;
    let x = (pixel % SIZE) as f64 + 0.5 - SIZE as f64 / 2.0;
    let y = SIZE as f64 / 2.0 - (pixel / SIZE) as f64 - 0.5;
    (right * x * scale + up * y * scale + forward).normalize()
}

/// Points on plane and sphere, on a fixed irregular grid.
fn points() -> Vec<CapturePoint> {
    let mut points = Vec::new();
    for i in 0..4000 {
        let (a, b) = (
            (i as f64 * 0.618_033_988_75).fract(),
            (i as f64 + 0.5) / 4000.0,
        );
        points.push(CapturePoint {
            position: DVec3::new(2.0 * a - 1.0, 2.0 * b - 1.0, 0.0),
            normal: DVec3::Z,
        });
        let (z, phi) = (2.0 * b - 1.0, a * std::f64::consts::TAU);
        let r = (1.0 - z * z).sqrt();
        let normal = DVec3::new(r * phi.cos(), r * phi.sin(), z);
        points.push(CapturePoint {
            position: CENTRE + RADIUS * normal,
            normal,
        });
    }
    points
}

/// √(Σ(a − b)²/Σb²) of lookups that the data hold, at the time when the wave passes each point (and
/// a little before and after); and how many there were.
fn relative_error(look: impl Fn(&CapturePoint, f64) -> Sampled) -> (f64, usize) {
    let (mut error, mut norm, mut held) = (0.0, 0.0, 0);
    for point in points() {
        for shift in [-0.15, 0.0, 0.1] {
            let t = point.position.distance(LIGHT) + shift;
            let (sampled, truth) = (look(&point, t), wave(point.position, t));
            assert!((sampled.coverage.total() - 1.0).abs() < 1e-12);
            if sampled.coverage.held > 0.999 {
                error += (sampled.radiance[0] - truth).powi(2);
                norm += truth * truth;
                held += 1;
            }
        }
    }
    ((error / norm).sqrt(), held)
}

#[test]
fn a_warped_capture_gives_back_the_surface_radiance() {
    for index in [1.0, 1.5] {
        let (capture, texture) = capture(Some(index), Fill::Black);
        let (error, held) = relative_error(|p, t| texture.sample_capture(&capture, p, t, occluded));
        assert!(error < 0.02, "error {error} at index {index}");
        assert!(held > 10_000, "only {held} held");
    }
}

#[test]
fn one_distance_for_all_taps_would_be_worse() {
    let (capture, texture) = capture(Some(1.0), Fill::Black);
    let (own, _) = relative_error(|p, t| texture.sample_capture(&capture, p, t, occluded));
    let unwarped = Capture::new(&camera(), [SIZE; 2], false, 1.0, trace);
    let (common, _) = relative_error(|p, t| {
        let t = t + p.position.distance(EYE);
        texture.sample_capture(&unwarped, p, t, occluded)
    });
    assert!(common > 1.5 * own, "common {common}, own {own}");
}

#[test]
fn a_capture_in_world_time_needs_no_distance() {
    let (capture, texture) = capture(None, Fill::Black);
    let (error, _) = relative_error(|p, t| texture.sample_capture(&capture, p, t, occluded));
    assert!(error < 0.02, "error {error}");
}

#[test]
fn a_pixel_centre_reads_its_own_pixel() {
    let (capture, texture) = capture(Some(1.0), Fill::Black);
    for pixel in (0..SIZE * SIZE).step_by(37) {
        let ray = direction_through(pixel);
        let seen = trace(EYE, ray).unwrap();
        let point = CapturePoint {
            position: EYE + ray * seen.distance,
            normal: seen.normal * -seen.normal.dot(ray).signum(),
        };
        if point.position.length() > 1.5 {
            continue; // the wave is there after the end of the data
        }
        let [x, y] = capture.project(point.position).unwrap();
        assert!((x - (pixel % SIZE) as f64 - 0.5).abs() < 1e-10);
        assert!((y - (pixel / SIZE) as f64 - 0.5).abs() < 1e-10);
        let t = point.position.distance(LIGHT) + 0.06;
        let sampled = texture.sample_capture(&capture, &point, t, nothing_occludes);
        assert!((sampled.radiance[0] - wave(point.position, t)).abs() < 2e-3);
        assert!((sampled.coverage.held - 1.0).abs() < 1e-12);
    }
}

#[test]
fn hidden_points_are_occluded_and_the_rest_is_not() {
    let (capture, texture) = capture(None, Fill::Black);
    let (mut hidden, mut missed, mut by_taps_alone) = (0, 0, 0);
    let points = points();
    for point in &points {
        let faces_away = point.normal.dot(EYE - point.position) <= 0.0;
        let truth = faces_away || occluded(point.position, EYE);
        let exact = texture
            .sample_capture(&capture, point, 2.0, occluded)
            .coverage;
        let taps = texture
            .sample_capture(&capture, point, 2.0, nothing_occludes)
            .coverage;
        hidden += usize::from(truth);
        assert!(!truth || exact == Coverage::OCCLUDED, "{point:?}");
        // In sight, but between the pixel centres that see the surface.
        missed += usize::from(!truth && exact.occluded > 0.0);
        by_taps_alone += usize::from(truth != (taps.occluded > 0.0));
    }
    assert!(hidden > points.len() / 5);
    assert!(missed < points.len() / 200, "{missed} missed");
    assert!(
        by_taps_alone < points.len() / 50,
        "{by_taps_alone} of {}",
        points.len()
    );
}

#[test]
fn the_other_side_of_a_surface_was_not_seen() {
    let (capture, texture) = capture(None, Fill::Black);
    let below = CapturePoint {
        position: DVec3::new(0.8, 0.0, 0.0),
        normal: DVec3::NEG_Z,
    };
    let sampled = texture.sample_capture(&capture, &below, 2.0, nothing_occludes);
    assert_eq!(sampled.coverage, Coverage::OCCLUDED);
}

#[test]
fn outside_the_image_and_behind_the_pinhole_is_off_the_texture() {
    let behind = EYE - camera().axes[2];
    for (position, nearest_is_data) in [
        (DVec3::new(30.0, 0.0, 0.0), true),
        (behind, false),
        (EYE, false),
        (DVec3::NAN, false),
    ] {
        for fill in [Fill::Black, Fill::Mark([7.0; 3]), Fill::Hold] {
            let (capture, texture) = constant(fill);
            let point = CapturePoint {
                position,
                normal: DVec3::Z,
            };
            let sampled = texture.sample_capture(&capture, &point, 2.0, nothing_occludes);
            assert_eq!(sampled.coverage, Coverage::OFF_TEXTURE);
            let held = if nearest_is_data { 2.0 } else { 0.0 };
            let expected = filled(fill, held);
            assert_eq!((sampled.radiance, sampled.unscaled), expected);
        }
    }
}

#[test]
fn unseen_points_are_filled_by_policy() {
    let hidden = CapturePoint {
        position: CENTRE + DVec3::Y * RADIUS,
        normal: DVec3::Y,
    };
    for fill in [Fill::Black, Fill::Mark([7.0; 3]), Fill::Hold] {
        let (capture, texture) = constant(fill);
        let sampled = texture.sample_capture(&capture, &hidden, 2.0, nothing_occludes);
        assert_eq!(sampled.coverage, Coverage::OCCLUDED);
        assert_eq!((sampled.radiance, sampled.unscaled), filled(fill, 2.0));
    }
}

/// All samples 2, at every time.
fn constant(fill: Fill) -> (Capture, TimeTexture) {
    let capture = Capture::new(&camera(), [4, 2], true, 1.0, trace);
    let cube = Cube::new([2, 4, 1, 1], CubeSamples::F32(vec![2.0; 8])).unwrap();
    let axis = TimeAxis {
        bins: TimeBins::Uniform {
            start: 0.0,
            width: 100.0,
        },
        values: BinValues::Density,
        filter: TimeFilter::Nearest,
        scale: 1.0,
    };
    (
        capture,
        TimeTexture::new(cube, axis, everywhere(fill)).unwrap(),
    )
}

#[test]
fn taps_across_a_crease_or_a_silhouette_do_not_bleed() {
    // Floor pixels hold 1, sphere pixels 5: every held lookup must be of its own surface alone.
    let capture = Capture::new(&camera(), [SIZE; 2], false, 1.0, trace);
    let samples = (0..SIZE * SIZE)
        .map(|pixel| match sphere(EYE, direction_through(pixel)) {
            Some(_) => 5.0,
            None => 1.0,
        })
        .collect();
    let cube = Cube::new([SIZE, SIZE, 1, 1], CubeSamples::F32(samples)).unwrap();
    let axis = TimeAxis {
        bins: TimeBins::Uniform {
            start: 0.0,
            width: 1.0,
        },
        values: BinValues::Density,
        filter: TimeFilter::Nearest,
        scale: 1.0,
    };
    let texture = TimeTexture::new(cube, axis, everywhere(Fill::Black)).unwrap();
    for point in points() {
        // Where the sphere stands on the floor the two are one surface to within a pixel.
        let contact = DVec3::new(CENTRE.x, CENTRE.y, 0.0);
        if point.position.distance(contact) < 0.3 {
            continue;
        }
        let sampled = texture.sample_capture(&capture, &point, 0.5, occluded);
        if sampled.coverage.held > 0.0 {
            let own = if point.position.z == 0.0 { 1.0 } else { 5.0 };
            assert!((sampled.radiance[0] - own).abs() < 1e-12, "{point:?}");
        }
    }
}

#[test]
fn a_capture_is_the_same_on_any_number_of_threads() {
    let distances = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let capture = pool.install(|| Capture::new(&camera(), [SIZE; 2], true, 1.0, trace));
        (0..SIZE * SIZE)
            .map(|p| capture.distance(p))
            .collect::<Vec<_>>()
    };
    assert_eq!(distances(1), distances(3));
}
