//! Steady pictures on surfaces, rendered and compared with bilinear means and the laws of aberration and beaming.

use std::path::Path;

use nullray::io::cube::{self, Axes, Cube, CubeSamples, Wanted};
use nullray::io::image::{Channel, Layers, Samples, exr, npz};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::{Overrides, parse};

/// Rows and columns of the picture.
const SIZE: [usize; 2] = [5, 7];

/// What it holds: no two rows or columns alike, and no plane.
fn value(i: f64, j: f64) -> f64 {
    1.0 + 0.7 * i + 0.4 * j + 0.3 * i * j
}

/// The picture as an array, as a picture, and as the one frame of a folder.
fn write(folder: &Path) {
    let [h, w] = SIZE;
    let samples = || (0..h * w).map(|n| value((n / w) as f64, (n % w) as f64) as f32);
    let cube = Cube::new([h, w, 1, 1], CubeSamples::F32(samples().collect())).unwrap();
    npz::write_cube(&folder.join("cube.npy"), &cube).unwrap();
    let channel = Channel {
        name: "Y".into(),
        samples: Samples::F32(samples().collect()),
    };
    let layers = Layers::new(w as u32, h as u32, vec![channel], Vec::new()).unwrap();
    std::fs::create_dir(folder.join("one")).unwrap();
    for file in ["photo.exr", "one/000.exr"] {
        exr::write(&folder.join(file), &layers).unwrap();
    }
}

/// A wall of 4 × 4 m, 2 m from a camera that comes near to it at this speed.
fn picture(folder: &Path, keys: &str, beta: f64, time: f64) -> Vec<f64> {
    let text = format!(
        "[radiance]\nquantity = \"integrated\"\n\
         [camera]\neye = [0, 0, 2]\nlook_at = [0, 0, 0]\nhfov = \"50 deg\"\nsize = [16, 12]\n\
         velocity = {{ beta = [0, 0, {}] }}\nclock_zero = \"{time} m\"\n\
         [[object]]\nname = \"wall\"\nshape = {{ plane = {{ size = [4, 4] }} }}\n\
         transform = {{ rotate = {{ axis = [1, 0, 0], angle = \"90 deg\" }} }}\n\
         [[source]]\n[source.cube]\n{keys}\nuv = 0\n",
        -beta
    );
    let scene = parse(&text, "steady", folder, &Overrides::default())
        .unwrap_or_else(|e| panic!("{keys}: {e} {}", e.help()));
    let request = Request {
        pixel_centers: true,
        ..Request::default()
    };
    let plan = Plan::new(&scene, &request).unwrap();
    let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    let film = render(&prepared, &Silent).unwrap();
    film.radiance().iter().map(|c| c[1]).collect()
}

#[test]
fn a_steady_picture_is_seen_on_its_surface_at_any_time_and_speed() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    let half = 25.0_f64.to_radians().tan();
    for keys in [
        "file = \"cube.npy\"\naxes = \"H W 1 1\"",
        "file = \"photo.exr\"",
        "file = \"photo.exr\"\naxes = \"H W\"",
        "file = \"one\"\naxes = \"H W\"",
    ] {
        for (beta, time) in [(0.0, 0.0), (0.0, 1e4), (0.6, 0.0), (0.6, -300.0)] {
            for (n, found) in picture(folder.path(), keys, beta, time)
                .into_iter()
                .enumerate()
            {
                // The middle of the pixel in the camera's frame, and the direction in the world: cos θ = (cos θ′ − β)/(1 − β cos θ′).
                let (a, b) = ((n % 16) as f64, (n / 16) as f64);
                let a = half * ((2.0 * a + 1.0) / 16.0 - 1.0);
                let b = half * (12.0 - (2.0 * b + 1.0)) / 16.0;
                let length = (1.0 + a * a + b * b).sqrt();
                let cosine = (1.0 / length - beta) / (1.0 - beta / length);
                let tangent = (1.0 - cosine * cosine).sqrt() / cosine;
                let across = (a * a + b * b).sqrt();
                let (x, y) = (2.0 * tangent * a / across, 2.0 * tangent * b / across);
                if x.abs() > 2.0 || y.abs() > 2.0 {
                    continue;
                }
                // Means of neighbours of value(), which is linear along each axis, are itself; and at the rim the last sample goes on.
                let [h, w] = SIZE.map(|n| n as f64);
                let i = ((2.0 - y) / 4.0 * h - 0.5).clamp(0.0, h - 1.0);
                let j = ((x + 2.0) / 4.0 * w - 0.5).clamp(0.0, w - 1.0);
                // ω′/ω = γ (1 + β cos θ), and L as its fourth power.
                let shift = (1.0 + beta * cosine) / (1.0_f64 - beta * beta).sqrt();
                let expected = value(i, j) * shift.powi(4);
                assert!(
                    (found - expected).abs() < 1e-6 * expected,
                    "{keys} {beta} {time} {n}: {found} {expected}"
                );
            }
        }
    }
}

#[test]
fn several_pictures_are_not_steady_and_a_steady_one_has_no_times() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    std::fs::copy(
        folder.path().join("photo.exr"),
        folder.path().join("one/001.exr"),
    )
    .unwrap();
    let axes: Axes = "H W".parse().unwrap();
    let wanted = Wanted {
        axes: Some(&axes),
        ..Wanted::default()
    };
    let error = cube::load(&folder.path().join("one"), wanted).unwrap_err();
    assert!(
        error.to_string().contains("4 axes, and 3 are named"),
        "{error}"
    );
    let text = "[camera]\neye = [0, 0, 2]\nlook_at = [0, 0, 0]\n[[object]]\nname = \"a\"\nshape = { plane = { size = [1, 1] } }\n\
                [[source]]\ncube = { file = \"photo.exr\", bin_width = \"1 m\", uv = 0 }\n";
    let error = parse(text, "steady", folder.path(), &Overrides::default()).unwrap_err();
    assert!(error.to_string().contains("bin_width"), "{error}");
    let missing = text.replace("photo", "no");
    assert!(parse(&missing, "steady", folder.path(), &Overrides::default()).is_err());
}
