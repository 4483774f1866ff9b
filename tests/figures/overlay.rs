//! What is drawn over pictures: measured on the lines, which are data, not on pixels.

use nullray::figures::drawing::{Item, pdf, png, svg};
use nullray::figures::overlay::{
    Outline, Overlay, Part, Parts, Target, apparent, instantaneous, outlines,
};
use nullray::io::image::RgbImage;
use nullray::render::film::Film;
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

fn films(scene: &Scene, parts: Parts) -> (Film, Film) {
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

#[test]
fn an_outline_lies_within_fractions_of_a_pixel() {
    // A disc of radius 30.3 about (50.2, 49.9), and the shift 1/(2r) of the smoothing.
    let (size, r) = ([100, 100], 30.3);
    let from = |x: f64, y: f64| (x - 50.2).hypot(y - 49.9);
    let pixel = |i: u32| from(f64::from(i % 100) + 0.5, f64::from(i / 100) + 0.5);
    let objects: Vec<f64> = (0..10_000)
        .map(|i| if pixel(i) < r { 3.0 } else { -1.0 })
        .collect();
    let found = outlines(size, &objects);
    assert_eq!((found.len(), found[0].object), (1, 3));
    let radii: Vec<f64> = found[0].lines[0].iter().map(|p| from(p[0], p[1])).collect();
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    assert!((mean - r + 0.5 / r).abs() < 0.05, "{mean}");
    let worst = radii.iter().map(|q| (q - mean).abs()).fold(0.0, f64::max);
    assert!(worst < 0.5, "{worst}");
}

#[test]
fn the_line_between_two_objects_is_drawn_once() {
    let objects: Vec<f64> = (0..400).map(|i| f64::from(i % 20 / 8)).collect();
    let found = outlines([20, 20], &objects);
    let lines: usize = found.iter().map(|outline| outline.lines.len()).sum();
    assert_eq!(lines, 2, "at x = 8 and x = 16");
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
