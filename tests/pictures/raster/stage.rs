//! Scenes, films by any method, and their differences.

use std::path::Path;

use nullray::approximate::projection::displacements;
use nullray::approximate::raster;
use nullray::render::aov::{self, Aov};
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::scene::model::Scene;
use nullray::scene::{self, Overrides};

/// A cube on a floor, lit for ever.
pub const BODIES: &str = r#"
[[object]]
name = "floor"
shape = { plane = { size = [6, 6] } }
[[object]]
name = "crate"
shape = { box = { size = [1, 1, 1] } }
transform = { rotate = { axis = [0, 1, 0], angle = "30 deg" }, translate = [0, 0.5, 0] }
"#;

/// A camera that sees them, with `more` keys.
pub fn camera(more: &str) -> String {
    format!(
        "[camera]\neye = [0.3, 1.4, 3.4]\nlook_at = [0, 0.5, 0]\nhfov = \"70 deg\"\nsize = [120, 90]\n{more}\n"
    )
}

/// The scene that `text` says.
pub fn scene(text: &str) -> Scene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    scene::parse(text, "test scene", folder, &Overrides::default()).unwrap()
}

/// A scene of the repository, `width` pixels wide.
pub fn scene_file(name: &str, size: [u32; 2]) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenes")
        .join(name);
    let overrides = Overrides {
        size: Some(size),
        samples_per_pixel: Some(1),
        ..Overrides::default()
    };
    scene::load(&path, &overrides).unwrap()
}

/// `scene` with all channels, seen through the centres of pixels.
pub fn centred(scene: &Scene) -> Prepared {
    let request = Request {
        aovs: aov::parse("all").unwrap(),
        pixel_centers: true,
        ..Request::default()
    };
    prepared(scene, &request)
}

/// `scene` with what `request` asks for.
pub fn prepared(scene: &Scene, request: &Request) -> Prepared {
    let plan = Plan::new(scene, request).unwrap();
    Prepared::new(scene, &plan, &Silent).unwrap()
}

/// The film of `prepared` by `method`.
pub fn film(prepared: &Prepared, method: &str) -> Film {
    raster::render(prepared, &method.parse().unwrap(), &Silent).unwrap()
}

/// A channel's values.
pub fn values(film: &Film, aov: Aov) -> &[f64] {
    film.aov(aov).unwrap()
}

/// By how many pixels the points of `film` are drawn beside their places, where they are seen.
pub fn errors(prepared: &Prepared, film: &Film) -> Vec<f64> {
    let all = displacements(prepared, film).unwrap();
    let met = values(film, Aov::Object).iter().map(|o| *o >= 0.0);
    let seen = all.into_iter().zip(met).filter(|(_, met)| *met);
    seen.map(|([x, y], _)| x.hypot(y)).collect()
}

/// The greatest of `numbers`, NaN if there is one.
pub fn greatest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(
        0.0,
        |a: f64, b| if b.is_nan() { f64::NAN } else { a.max(*b) },
    )
}

/// The greatest error in pixels of `scene` by `method`.
pub fn worst(prepared: &Prepared, method: &str) -> f64 {
    greatest(&errors(prepared, &film(prepared, method)))
}

/// Pixels where two films see different triangles.
pub fn different(a: &Film, b: &Film) -> Vec<usize> {
    let (a, b) = (identities(a), identities(b));
    (0..a.len()).filter(|i| a[*i] != b[*i]).collect()
}

/// Object and triangle of each pixel.
pub fn identities(film: &Film) -> Vec<(i64, i64)> {
    let (objects, triangles) = (values(film, Aov::Object), values(film, Aov::Primitive));
    let both = objects.iter().zip(triangles);
    both.map(|(o, t)| (*o as i64, *t as i64)).collect()
}
