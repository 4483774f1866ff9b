//! Overlays: measured on the lines, which are data, not on pixels.

use nullray::figures::drawing::{Item, pdf, png, svg};
use nullray::figures::overlay::{
    CentredPicture, Outline, Overlay, Part, Parts, Target, apparent, instantaneous, outlines,
};
use nullray::io::image::RgbImage;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::scene::model::Scene;
use nullray::scene::{self, Overrides};

/// A far sphere of radius 1 that moves sideways at 0.9 c, seen through a long lens from the distance 100,
/// so that light from all of it is about equally late. At world time 0 its centre is on the axis.
const SIDEWAYS: &str = r#"
camera = { eye = [0, 0, 100], look_at = [0, 0, 0], hfov = "8 deg", size = [640, 96] }
display = { samples_per_pixel = 1, white = 1.0 }
object = [{ name = "ball", shape = { sphere = { radius = 1, subdivisions = 6 } },
    velocity = { beta = [0.9, 0, 0] }, origin = { position = [XX, 0, 0], time = "0 m" } }]
"#;

fn scene(text: &str) -> Scene {
    scene::parse(text, "test scene", ".".as_ref(), &Overrides::default()).unwrap()
}

fn films(scene: &Scene, parts: Parts) -> (CentredPicture, CentredPicture) {
    let plan = Plan::new(scene, &Request::default()).unwrap();
    let mut prepared = Prepared::new(scene, &plan, &Silent).unwrap();
    let film = apparent(&mut prepared, parts, &Silent).unwrap();
    let instant = instantaneous(scene, &mut prepared, &Silent).unwrap();
    (film, instant)
}

fn overlay(scene: &Scene, parts: Parts) -> Overlay {
    let (film, instant) = films(scene, parts);
    Overlay::trace(scene, Some(&film), Some(&instant), parts, None).unwrap()
}

/// The least and the greatest x and y of a single closed outline.
fn extent(outlines: &[Outline]) -> [[f64; 2]; 2] {
    let [outline] = outlines else {
        panic!("{} outlines", outlines.len())
    };
    let [line] = outline.lines.as_slice() else {
        panic!("{} lines", outline.lines.len())
    };
    assert_eq!(line.first(), line.last());
    [0, 1].map(|axis| {
        let along = || line.iter().map(|p| p[axis]);
        [
            along().fold(f64::INFINITY, f64::min),
            along().fold(f64::NEG_INFINITY, f64::max),
        ]
    })
}

fn middle([low, high]: [f64; 2]) -> f64 {
    0.5 * (low + high)
}

fn length([low, high]: [f64; 2]) -> f64 {
    high - low
}

/// Pixels per metre at the distance 100 in the middle of the picture.
fn pixels_per_metre() -> f64 {
    320.0 / (100.0 * 4f64.to_radians().tan())
}

#[test]
fn a_sphere_that_moves_sideways_is_contracted_to_1_over_gamma_where_it_is() {
    // In the world it is an ellipsoid of half axes 1/γ = 0.43589 and 1.
    let overlay = overlay(&scene(&SIDEWAYS.replace("XX", "0")), Parts::default());
    // Light from the middle is 100 m late: 90 m to the left, far outside.
    assert!(overlay.apparent.is_empty());
    let [x, y] = extent(&overlay.instantaneous);
    let ratio = length(x) / length(y);
    assert!((ratio - 0.435_89).abs() < 0.01, "{ratio}");
    assert!((length(y) / 2.0 - pixels_per_metre()).abs() < 0.3, "{y:?}");
    assert!((middle(x) - 320.0).abs() < 0.1, "{x:?}");
}

#[test]
fn a_sphere_that_moves_sideways_is_seen_round_where_it_was() {
    // Its centre is seen where it was at the time t with |(90 + 0.9 t, 100)| = −t; found by bisection.
    let scene = scene(&SIDEWAYS.replace("XX", "90"));
    let overlay = overlay(&scene, Parts::default());
    let mut t = [-120.0, -80.0];
    while t[1] - t[0] > 1e-12 {
        let m = middle(t);
        let late = (90.0f64 + 0.9 * m).hypot(100.0) < -m;
        t[usize::from(!late)] = m;
    }
    let seen_at = 90.0 + 0.9 * t[0];
    let [x, y] = extent(&overlay.apparent);
    let ratio = length(x) / length(y);
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    let expected = 320.0 + pixels_per_metre() * seen_at;
    assert!((middle(x) - expected).abs() < 1.0, "{x:?} {expected}");
    // Where it is, 90 m to the right, is outside.
    assert!(overlay.instantaneous.is_empty());
}

#[test]
fn both_outlines_of_what_rests_are_the_same() {
    let text = SIDEWAYS.replace("XX", "0").replace("0.9, 0, 0", "0, 0, 0");
    let overlay = overlay(&scene(&text), Parts::default());
    assert_eq!(overlay.apparent, overlay.instantaneous);
    assert!(!overlay.apparent.is_empty());
}

/// The outline of object 3, which is where `inside` says, in a picture of 100 × 100 pixels.
fn outlined(inside: impl Fn([f64; 2]) -> bool) -> Vec<[f64; 2]> {
    let seen = |p: [f64; 2]| if inside(p) { 3.0 } else { -1.0 };
    let pixel = |i: u32| [f64::from(i % 100) + 0.5, f64::from(i / 100) + 0.5];
    let objects: Vec<f64> = (0..10_000).map(|i| seen(pixel(i))).collect();
    let look = |points: &[[f64; 2]]| Ok(points.iter().map(|p| seen(*p)).collect());
    let found = outlines([100, 100], &objects, look).unwrap();
    assert_eq!((found.len(), found[0].object), (1, 3));
    let [line] = &found[0].lines[..] else {
        panic!("{} lines", found[0].lines.len())
    };
    assert_eq!(line.first(), line.last());
    line.clone()
}

/// A number in [0, 1) for every seed (Knuth's MMIX generator, a few steps).
fn random(seed: u64) -> f64 {
    let step = |x: u64| {
        x.wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407)
    };
    (step(step(step(seed))) >> 11) as f64 / (1u64 << 53) as f64
}

#[test]
fn points_of_an_outline_are_on_the_edge_at_any_phase() {
    for seed in 0..40 {
        let [x, y, r] = [0, 1, 2].map(|k| random(3 * seed + k));
        let (x, y, r) = (50.0 + x, 50.0 + y, 1.5 + 40.0 * r);
        let line = outlined(|p| (p[0] - x).hypot(p[1] - y) < r);
        for p in &line {
            // The way is halved 12 times; an edge that the way only grazes is met at an angle.
            let off = (p[0] - x).hypot(p[1] - y) - r;
            assert!(off.abs() < 1.0 / 4096.0, "{off} of {r}");
        }
        // Chords of squares of one pixel: the arc between is farther by √2²/(8r) at most.
        for pair in line.windows(2) {
            let middle = [0, 1].map(|k| 0.5 * (pair[0][k] + pair[1][k]));
            let off = (middle[0] - x).hypot(middle[1] - y) - r;
            assert!(-0.26 / r < off && off < 1e-3, "{off} of {r}");
        }
    }
}

#[test]
fn straight_edges_have_their_slope_at_any_phase() {
    for seed in 0..40 {
        let [x, y, turn] = [0, 1, 2].map(|k| random(1000 + 3 * seed + k));
        let (sin, cos) = (6.3 * turn).sin_cos();
        // A rectangle of 60 × 40 pixels about a point of the middle pixel, turned.
        let own = |p: [f64; 2]| {
            let [u, v] = [p[0] - 50.0 - x, p[1] - 50.0 - y];
            [(u * cos + v * sin) / 30.0, (v * cos - u * sin) / 20.0]
        };
        let line = outlined(|p| own(p).iter().all(|c| c.abs() < 1.0));
        let mut straight = 0;
        for pair in line.windows(2) {
            let [a, b] = [own(pair[0]), own(pair[1])];
            // The side that both ends are on, away from its corners.
            let side = (0..2).find(|&k| a[k].abs() > 0.999 && (a[k] - b[k]).abs() < 0.1);
            let Some(k) = side.filter(|&k| a[1 - k].abs() < 0.9 && b[1 - k].abs() < 0.9) else {
                continue;
            };
            straight += 1;
            let half = [30.0, 20.0];
            let off = |p: [f64; 2]| (p[k].abs() - 1.0) * half[k];
            assert!(
                off(a).abs() < 2.5e-4 && off(b).abs() < 2.5e-4,
                "{} {}",
                off(a),
                off(b)
            );
            let along = (a[1 - k] - b[1 - k]).abs() * half[1 - k];
            let slope = (off(a) - off(b)) / along;
            assert!(along < 0.1 || slope.abs() < 5e-3, "{slope} over {along}");
        }
        assert!(straight > 150, "{straight}");
    }
}

#[test]
fn corners_of_an_outline_are_where_they_are_at_any_phase() {
    let mut exact = 0;
    for seed in 0..60 {
        let [x, y, turn] = [0, 1, 2].map(|k| random(3000 + 3 * seed + k));
        let (sin, cos) = (6.3 * turn).sin_cos();
        let own = |p: [f64; 2]| {
            let [u, v] = [p[0] - 50.0 - x, p[1] - 50.0 - y];
            [u * cos + v * sin, v * cos - u * sin]
        };
        // A square of 60 pixels without its fourth quarter: five corners that stick out, and one that goes in.
        let line = outlined(|p| {
            let [u, v] = own(p);
            u.abs() < 30.0 && v.abs() < 30.0 && !(u > 0.0 && v > 0.0)
        });
        let corners = [[-30, -30], [30, -30], [30, 0], [0, 0], [0, 30], [-30, 30]];
        for corner in corners.map(|c| c.map(f64::from)) {
            let off = line.iter().map(|p| {
                let [u, v] = own(*p);
                (u - corner[0]).hypot(v - corner[1])
            });
            let nearest = off.fold(f64::INFINITY, f64::min);
            // What is cut off by less than 0.05 pixels stays so.
            assert!(nearest < 0.08, "{nearest} from {corner:?}, seed {seed}");
            exact += usize::from(nearest < 2e-3);
        }
    }
    assert!(exact > 320, "{exact} of 360");
}

#[test]
fn the_outline_of_a_turned_box_is_its_projection_at_any_phase() {
    // A camera at rest at distance 5 from the front of a slab of 2 × 1: f = 100/tan 30° pixels.
    for seed in 0..8 {
        let [turn, x, y] = [0, 1, 2].map(|k| random(2000 + 3 * seed + k));
        let (turn, x, y) = (90.0 * turn, 0.1 * x, 0.1 * y);
        let text = format!(
            "camera = {{ eye = [0, 0, 5], look_at = [0, 0, 0], hfov = \"60 deg\", size = [200, 160] }}\n\
             object = [{{ shape = {{ box = {{ size = [2, 1, 0.002] }} }}, transform = {{ \
             rotate = {{ axis = [0, 0, 1], angle = \"{turn} deg\" }}, translate = [{x}, {y}, -0.001] }} }}]"
        );
        let overlay = overlay(&scene(&text), Parts::default());
        let [outline] = &overlay.apparent[..] else {
            panic!("{} outlines", overlay.apparent.len())
        };
        let pixels = 100.0 / 30f64.to_radians().tan() / 5.0;
        let (sin, cos) = turn.to_radians().sin_cos();
        let mut on_edge = 0;
        for p in outline.lines.iter().flatten() {
            let [u, v] = [(p[0] - 100.0) / pixels - x, (80.0 - p[1]) / pixels - y];
            let own = [
                (u * cos + v * sin).abs() - 1.0,
                (v * cos - u * sin).abs() - 0.5,
            ];
            let off = own[0].max(own[1]) * pixels;
            assert!(off.abs() < 5e-4, "{off} at {p:?}, turned by {turn}");
            on_edge += 1;
        }
        assert!(on_edge > 200, "{on_edge}");
    }
}

#[test]
fn the_line_between_two_objects_is_drawn_once() {
    let objects: Vec<f64> = (0..400).map(|i| f64::from(i % 20 / 8)).collect();
    let look = |points: &[[f64; 2]]| Ok(points.iter().map(|p| (p[0] / 8.0).floor()).collect());
    let found = outlines([20, 20], &objects, look).unwrap();
    let lines: Vec<_> = found.iter().flat_map(|outline| &outline.lines).collect();
    assert_eq!(lines.len(), 2);
    for (line, x) in lines.into_iter().zip([8.0, 16.0]) {
        assert!(line.iter().all(|p| (p[0] - x).abs() < 2e-4), "{line:?}");
    }
}

#[test]
fn fields_of_a_chessboard_are_joined_as_they_are_in_the_middle() {
    // Two fields of an object that meet at a corner, or are joined there by a bridge, or are apart.
    for (bridge, lines) in [(0.3, 1), (-0.3, 2)] {
        let seen = |p: [f64; 2]| {
            let [u, v] = [p[0] - 10.0, p[1] - 10.0];
            let near = (u + v).abs() < 0.4 * bridge && bridge > 0.0;
            let far = u * v > 0.0 && u.hypot(v) > bridge.abs();
            let within = u.abs() < 5.0 && v.abs() < 5.0;
            if within && (far || u.hypot(v) <= bridge || near) {
                0.0
            } else {
                -1.0
            }
        };
        let pixel = |i: u32| [f64::from(i % 20) + 0.5, f64::from(i / 20) + 0.5];
        let objects: Vec<f64> = (0..400).map(|i| seen(pixel(i))).collect();
        let look = |points: &[[f64; 2]]| Ok(points.iter().map(|p| seen(*p)).collect());
        let found = outlines([20, 20], &objects, look).unwrap();
        assert_eq!(found[0].lines.len(), lines, "{bridge}");
    }
}

/// A camera at the origin that looks along −z with 90° over 200 × 100 pixels.
fn pointing(beta: &str) -> Option<Target> {
    let text = format!(
        "camera = {{ eye = [0, 0, 0], look_at = [0, 0, -1], hfov = \"90 deg\", size = [200, 100], \
         velocity = {{ beta = {beta} }} }}\nobject = [{{ shape = {{ sphere = {{ radius = 0.1 }} }}, \
         transform = {{ translate = [0, 0, -5] }} }}]"
    );
    let parts = Parts::parse("beta").unwrap();
    let scene = scene(&text);
    let overlay = Overlay::trace(&scene, None, None, parts, None).unwrap();
    overlay.pointer.map(|pointer| pointer.target)
}

#[test]
fn the_velocity_points_to_its_pixel() {
    // The focal length is 100 pixels: (0.3, 0.2, −1) is 30 pixels right of and 20 above the middle.
    let close = |at: [f64; 2], x: f64, y: f64| (at[0] - x).hypot(at[1] - y) < 1e-9;
    match pointing("[0.24, 0.16, -0.8]") {
        Some(Target::Ahead(at)) => assert!(close(at, 130.0, 30.0), "{at:?}"),
        other => panic!("{other:?}"),
    }
    match pointing("[-0.24, -0.16, 0.8]") {
        Some(Target::Behind(at)) => assert!(close(at, 130.0, 30.0), "{at:?}"),
        other => panic!("{other:?}"),
    }
    match pointing("[0.6, 0.6, 0]") {
        Some(Target::Outside(way)) => {
            let k = std::f64::consts::FRAC_1_SQRT_2;
            assert!(close(way, k, -k), "{way:?}");
        }
        other => panic!("{other:?}"),
    }
    assert_eq!(pointing("[0, 0, 0]"), None);
}

#[test]
fn isochrones_are_where_their_time_is() {
    // A wall at distance 4 that is seen square on: ct = −4 √(1 + r²/f²).
    let text = r#"
camera = { eye = [0, 0, 4], look_at = [0, 0, 0], hfov = "90 deg", size = [200, 200] }
display = { samples_per_pixel = 1 }
object = [{ shape = { box = { size = [40, 40, 0.002] } } }]
"#;
    let overlay = overlay(&scene(text), Parts::default());
    let isochrones = overlay.isochrones.unwrap();
    assert!(isochrones.lines.len() > 4);
    for line in &isochrones.lines {
        for p in line.lines.iter().flatten() {
            let r = (p[0] - 100.0).hypot(p[1] - 100.0) / 100.0;
            let ct = -3.999 * (1.0 + r * r).sqrt();
            assert!((ct - line.ct).abs() < 0.002, "{ct} {}", line.ct);
        }
    }
}

#[test]
fn only_the_parts_that_are_asked_for_are_there() {
    let scene = scene(&SIDEWAYS.replace("XX", "90"));
    let parts = Parts::parse("outlines").unwrap();
    assert!(parts.has(Part::Outlines) && !parts.has(Part::Legend));
    let overlay = overlay(&scene, parts);
    assert!(overlay.isochrones.is_none() && overlay.legend.is_none());
    assert!(overlay.pointer.is_none() && !overlay.apparent.is_empty());
}

#[test]
fn unknown_parts_are_refused_with_those_that_there_are() {
    let message = Parts::parse("outlines,shadow").unwrap_err();
    assert!(message.contains("\"shadow\"") && message.contains("legend"));
    assert!(Parts::parse(" , ").unwrap_err().contains("isochrones"));
}

#[test]
fn a_page_holds_the_picture_and_is_the_same_every_time() {
    let scene = scene(&SIDEWAYS.replace("XX", "90"));
    let overlay = overlay(&scene, Parts::default());
    let picture = RgbImage {
        width: 640,
        height: 96,
        rgb: vec![40; 3 * 640 * 96],
    };
    let page = overlay.drawing("a ball", picture.clone()).unwrap();
    assert!(matches!(&page.items[0], Item::Image { image, .. } if *image == picture));
    assert!(page.height > 72.0, "with its legend: {}", page.height);
    let again = overlay.drawing("a ball", picture).unwrap();
    assert_eq!(svg::write(&page).unwrap(), svg::write(&again).unwrap());
    assert_eq!(pdf::write(&page).unwrap(), pdf::write(&again).unwrap());
    let pixels = |page| png::write(&png::render(page, 2.0).unwrap()).unwrap();
    assert_eq!(pixels(&page), pixels(&again));
    let small = RgbImage {
        width: 1,
        height: 1,
        rgb: vec![0; 3],
    };
    let message = overlay.drawing("", small).unwrap_err().to_string();
    assert!(message.contains("640 × 96"), "{message}");
}

/// The pixel that the camera moves towards, and half the width of the legend's scale: a camera that looks along −z with 90° over
/// 200 × 100 pixels, with this sensor.
fn of_sensor(more: &str, assembly: &str) -> ([f64; 2], f64) {
    let text = format!(
        "camera = {{ eye = [0, 0, 0], forward = [0, 0, -1], size = [200, 100], velocity = {{ beta = [0.36, 0, -0.48] }}, {more} \
         sensor = {{ focal_length = \"1 mm\", width = \"2 mm\", assembly = \"{assembly}\" }} }}\n\
         object = [{{ shape = {{ sphere = {{ radius = 0.1 }} }}, transform = {{ translate = [0, 0, -5] }} }}]"
    );
    let parts = Parts::parse("beta,legend").unwrap();
    let overlay = Overlay::trace(&scene(&text), None, None, parts, None).unwrap();
    match overlay.pointer.unwrap().target {
        Target::Ahead(at) => (at, overlay.legend.unwrap().half_width),
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_velocity_and_the_scale_are_those_of_the_sensor_in_motion() {
    // β = 0.6 at an angle of cos α = 0.8 to the forward axis: tan α = 0.75, 75 pixels from the middle at the focal length of the scene.
    let accelerated =
        "motion = { acceleration = { proper = \"1e-3 /m\", direction = [0, 1, 0] } },";
    // 1/√(1 − β² cos² α): the focal length that the camera measures.
    let stretch = 1.0 / (1.0_f64 - 0.48 * 0.48).sqrt();
    // S takes forward to (0.12, 0, −1.16) and right to (1.09, 0, −0.12), as γ = 1.25: |S right × S forward| / |S forward|².
    let [forward, right] = [[0.12_f64, 1.16], [1.09_f64, 0.12]];
    let sheared =
        (right[0] * forward[1] - right[1] * forward[0]) / (forward[0].powi(2) + forward[1].powi(2));
    for more in ["", accelerated] {
        for (assembly, x, t) in [
            ("rigid", 175.0, 1.0),
            ("world_length", 100.0 + 75.0 * stretch, 1.0 / stretch),
            ("bell", 175.0, sheared),
        ] {
            let (at, half_width) = of_sensor(more, assembly);
            let apart = (at[0] - x).hypot(at[1] - 50.0);
            assert!(apart < 1e-9, "{more} {assembly}: {at:?}, not {x}");
            assert!(
                (half_width - t).abs() < 1e-12,
                "{more} {assembly}: {half_width}, not {t}"
            );
        }
    }
}
