//! The figures of Jarabo et al. 2015 by the paper's equations, compared with the same pictures by special
//! relativity: the table of `scenes/paper/paper-versus-exact.md`.
//!
//! If the page does not agree, a failure prints the table as it should be.

use std::path::{Path, PathBuf};

use nullray::io::image::Layers;
use nullray::render::aov::Aov;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::{LoadedCubes, Prepared};
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::model::Scene;
use nullray::scene::{self, Overrides, SceneFile};
use nullray::validate::compare::{CompareOptions, Comparison, Picture, compare};

use crate::paper_scenes::Kept;

/// Figure and panel; its camera, in words.
const PANELS: [(u32, &str, &str); 19] = [
    (2, "camera-6.5", "at rest"),
    (3, "alike-1.5", "accelerating, 1.5 m after its start"),
    (3, "alike-3", "accelerating, 3 m after its start"),
    (4, "searchlight-towards-0.2", "towards the scene at 0.2 c"),
    (4, "searchlight-towards-0.5", "towards the scene at 0.5 c"),
    (4, "aberration-towards-0.99", "towards the scene at 0.99 c"),
    (4, "aberration-away-0.6", "away from the scene at 0.6 c"),
    (5, "cube-world-0.6", "towards the scene at 0.6 c"),
    (5, "cube-world-0.77", "towards the scene at 0.77 c"),
    (5, "bunny-world-0.9", "towards the scene at 0.9 c"),
    (
        6,
        "caption-0.9",
        "from rest to 0.9 c, with the caption's g and d",
    ),
    (6, "alike-0.3", "from rest to 0.3 c, gd = 0.5"),
    (6, "alike-0.9", "from rest to 0.9 c, gd = 0.5"),
    (7, "constant-0.6", "at a constant 0.6 c"),
    (7, "alike-0.6", "from rest to 0.6 c, gd = 0.7"),
    (8, "receding", "going out at 0.76 c, accelerating"),
    (10, "exact-0.4", "turning, rim at 0.4 c"),
    (10, "comoving-0.4", "turning, with pinholes that move along"),
    (
        11,
        "aberrated-0.75",
        "turning, seen aberrated, rim at 0.75 c",
    ),
];

const CHANNELS: [Aov; 3] = [Aov::Object, Aov::EventCt, Aov::WavelengthRatio];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/paper")
}

/// Makes pictures of panels one after the other. They share files and cubes, and those that differ in their cameras alone what is prepared.
#[derive(Default)]
struct Photographer {
    /// The last figure: its number, its file, and its scene as a whole, which may be what the paper does not have.
    figure: Option<(u32, SceneFile, Scene)>,
    cubes: LoadedCubes,
    exact: Kept,
    paper: Kept,
}

impl Photographer {
    /// A picture of a panel of a figure, 80 × 60 pixels, one ray through the middle of each.
    fn picture(&mut self, number: u32, panel: &str, model: &str) -> Picture {
        let figure = self.figure.take().filter(|(last, ..)| *last == number);
        let (_, file, whole) = self.figure.insert(figure.unwrap_or_else(|| {
            let path = folder().join(format!("figure-{number:02}.toml"));
            let file = SceneFile::read(&path).unwrap();
            let whole = file.scene(&Overrides::default()).unwrap();
            (number, file, whole)
        }));
        let panel = whole.panels.iter().find(|p| p.name == panel).unwrap();
        let overrides = Overrides {
            size: Some([80, 60]),
            set: vec![("model".into(), format!("\"{model}\""))],
            ..Overrides::default()
        };
        let scene = file.panel(whole, panel, &overrides).unwrap();
        let request = Request {
            aovs: CHANNELS.to_vec(),
            pixel_centers: true,
            ..Request::default()
        };
        let kept = match model {
            "exact" => &mut self.exact,
            _ => &mut self.paper,
        };
        let prepared = kept.prepared(&scene, &request, &mut self.cubes);
        let film = render(prepared, &Silent).unwrap();
        let [width, height] = film.size();
        let layers = Layers::new(width, height, film.channels(&CHANNELS), vec![]).unwrap();
        Picture::linear(model, layers)
    }

    /// The exact picture of a panel, and what the paper's differs by.
    fn compared(&mut self, figure: u32, panel: &str) -> (Picture, Comparison) {
        let exact = self.picture(figure, panel, "exact");
        // Of exact rotation the paper has none: it has its own in place of it.
        let paper = match panel {
            "exact-0.4" => "paper-0.4",
            _ => panel,
        };
        let paper = self.picture(figure, paper, "paper2015");
        let found = compare(&exact, &paper, &CompareOptions::default()).unwrap();
        (exact, found)
    }
}

fn compared(figure: u32, panel: &str) -> Comparison {
    Photographer::default().compared(figure, panel).1
}

/// A row of the page's table.
fn row(by: &mut Photographer, figure: u32, panel: &str, camera: &str) -> String {
    let (exact, found) = by.compared(figure, panel);
    let radiance = found.radiance.unwrap();
    let surface = found.surface.unwrap();
    let wrong = surface.wrong_objects.unwrap();
    let time = surface.emission_time.unwrap();
    let ratio = surface.wavelength_ratio.unwrap().absolute.summary.unwrap();
    let brightness = 1.0 + radiance.bias / mean(&exact);
    format!(
        "| {figure} | `{panel}` | {camera} | {} % | {} m | {} % | {} | {} | {} |",
        digits(100.0 * wrong.pixels as f64 / wrong.of as f64),
        digits(time.bias.unwrap()),
        digits(100.0 * ratio.rms),
        digits(brightness),
        digits(radiance.relrmse.unwrap()),
        digits(found.flip.unwrap().mean),
    )
}

/// The mean of a picture's light.
fn mean(exact: &Picture) -> f64 {
    let light = exact.layers.radiance().unwrap();
    light.iter().flatten().sum::<f64>() / (3 * light.len()) as f64
}

/// Three digits; what is below a millionth is 0.
fn digits(value: f64) -> String {
    if value.abs() < 1e-6 {
        return "0".into();
    }
    let decimals = (2 - value.abs().log10().floor() as i32).max(0) as usize;
    match value.abs() < 1e5 {
        true => format!("{value:.decimals$}").replace('-', "−"),
        false => format!("{value:.2e}").replace('-', "−"),
    }
}

#[test]
fn the_page_has_the_numbers_that_the_comparison_gives() {
    let mut by = Photographer::default();
    let rows = PANELS.map(|(figure, panel, camera)| row(&mut by, figure, panel, camera));
    let page = std::fs::read_to_string(folder().join("paper-versus-exact.md")).unwrap();
    let is_row = |line: &&str| line.starts_with("| ") && line.contains("| `");
    let stated: Vec<_> = page.lines().filter(is_row).collect();
    assert!(stated == rows, "the table should be\n{}", rows.join("\n"));
}

#[test]
fn a_camera_at_rest_is_seen_alike_by_both() {
    let found = compared(2, "camera-6.5");
    assert_eq!(found.radiance.unwrap().rmse, 0.0);
    let time = found.surface.unwrap().emission_time.unwrap();
    assert_eq!(time.absolute.summary.unwrap().max, 0.0);
}

#[test]
fn the_papers_light_left_later_by_the_time_of_flight_that_it_leaves_out() {
    // The approaching camera of figure 5 at 0.9 c: t = t′/γ − η z′ with z′ < r, against γt′ − ηr.
    let found = compared(5, "bunny-world-0.9").surface.unwrap();
    assert!(found.emission_time.unwrap().bias.unwrap() > 0.5);
    // Aberration is the same: what differs is the place of the finite pinhole.
    let wrong = found.wrong_objects.unwrap();
    assert!(10 * wrong.pixels < wrong.of, "{wrong:?}");
}

#[test]
fn a_line_is_brighter_by_the_paper_by_one_power_of_the_shift() {
    // D⁻⁵ against W⁻⁴ leaves 1/W: 2 straight ahead at 0.6 c, where the one pixel looks.
    let light = |model: &str| {
        let text = format!(
            "model = \"{model}\"\n\
             radiance = {{ quantity = \"line\", wavelength = \"550 nm\" }}\n\
             effects = {{ doppler = false }}\n\
             [camera]\neye = [0, 3, 0]\nlook_at = [0, 0, 0]\nup = [1, 0, 0]\nsize = [1, 1]\n\
             velocity = {{ beta = [0, -0.6, 0] }}\n\
             [[object]]\nshape = {{ plane = {{ size = [9, 9] }} }}\n"
        );
        let scene = scene::parse(&text, "test", Path::new("."), &Overrides::default()).unwrap();
        let request = Request {
            pixel_centers: true,
            ..Request::default()
        };
        let plan = Plan::new(&scene, &request).unwrap();
        let film = render(&Prepared::new(&scene, &plan, &Silent).unwrap(), &Silent).unwrap();
        film.radiance()[0].iter().sum::<f64>()
    };
    let ratio = light("paper2015") / light("exact");
    assert!((ratio - 2.0).abs() < 1e-12, "{ratio}");
}

#[test]
fn angles_of_view_that_the_difference_evaluator_has_no_filters_for_are_refused() {
    let picture = Photographer::default().picture(2, "camera-6.5", "exact");
    for pixels_per_degree in [0.0, -5.0, f64::NAN, 1e9] {
        let options = CompareOptions {
            pixels_per_degree: Some(pixels_per_degree),
            ..CompareOptions::default()
        };
        let said = compare(&picture, &picture, &options)
            .unwrap_err()
            .to_string();
        assert!(said.contains("pixels per degree"), "{said}");
    }
}
