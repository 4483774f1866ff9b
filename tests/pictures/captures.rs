//! Several captures of one surface, with known data: the floor y = 0 shines with f(x, z, t) = (1 + sin 3x cos 2z / 2) (1 + cos 2(t − x) /
//! 2), and every pixel of a capture is its mean over 8 × 8 points.
//!
//! `grazing` sees all of the visible floor, at 3 degrees in its middle; `above` looks down on its right half.

use std::fs;
use std::path::Path;

use glam::DVec3;
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::{Overrides, parse};

const BINS: usize = 24;
const WIDTH: f64 = 0.1;

fn f(x: f64, z: f64, t: f64) -> f64 {
    (1.0 + 0.5 * (3.0 * x).sin() * (2.0 * z).cos()) * (1.0 + 0.5 * (2.0 * (t - x)).cos())
}

struct Camera {
    name: &'static str,
    eye: DVec3,
    look_at: DVec3,
    up: DVec3,
    hfov: f64,
    size: [usize; 2],
}

/// 3 degrees above the horizon, seen from the middle of the floor.
fn grazing() -> Camera {
    Camera {
        name: "grazing",
        eye: DVec3::new(-0.2, 0.3, 5.7),
        look_at: DVec3::ZERO,
        up: DVec3::Y,
        hfov: 60.0,
        size: [96, 64],
    }
}

fn above() -> Camera {
    Camera {
        name: "above",
        eye: DVec3::new(0.5, 3.0, 0.0),
        look_at: DVec3::new(0.5, 0.0, 0.0),
        up: DVec3::NEG_Z,
        hfov: 18.0,
        size: [64, 64],
    }
}

/// Writes what the camera records of the floor: (H, W, T), the mean radiance of each bin, by the time of emission.
fn record(folder: &Path, camera: &Camera) {
    let forward = (camera.look_at - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    let [w, h] = camera.size;
    let scale = 2.0 * (0.5 * camera.hfov.to_radians()).tan() / w as f64;
    const PLACES: usize = 8;
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    let header =
        format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({h}, {w}, {BINS}), }}");
    bytes.extend(format!("{header:<117}\n").bytes());
    for (row, column) in (0..h).flat_map(|row| (0..w).map(move |column| (row, column))) {
        let mut bins = [0.0; BINS];
        for n in 0..PLACES * PLACES {
            let place = |at: usize, n: usize| at as f64 + (n as f64 + 0.5) / PLACES as f64;
            let x = (place(column, n % PLACES) - 0.5 * w as f64) * scale;
            let y = (0.5 * h as f64 - place(row, n / PLACES)) * scale;
            let d = right * x + up * y + forward;
            let hit = camera.eye - d * (camera.eye.y / d.y);
            if d.y < 0.0 && hit.x.abs() < 8.0 && hit.z.abs() < 8.0 {
                for (k, bin) in bins.iter_mut().enumerate() {
                    let t = (k as f64 + 0.5) * WIDTH - 1.2;
                    *bin += f(hit.x, hit.z, t) / (PLACES * PLACES) as f64;
                }
            }
        }
        bytes.extend(bins.iter().flat_map(|bin| bin.to_le_bytes()));
    }
    fs::write(folder.join(format!("{}.npy", camera.name)), bytes).unwrap();
}

/// The floor seen from the front and above, by these captures in their order.
fn picture(folder: &Path, cameras: &[Camera], render_keys: &str) -> nullray::Result<Film> {
    let mut text = format!(
        "[camera]
eye = [0, 2.5, 2.5]
look_at = [0, 0, 0]
hfov = \"30 deg\"
size = [64, 48]
time = \"3.5 m\"
[render]
{render_keys}
[[object]]
name = \"floor\"
shape = {{ plane = {{ size = [16, 16] }} }}
"
    );
    for Camera {
        name,
        eye,
        look_at,
        up,
        hfov,
        ..
    } in cameras
    {
        let [eye, look_at, up] = [eye, look_at, up].map(|v| v.to_array());
        text += &format!(
            "[[source]]
[source.cube]
file = \"{name}.npy\"
start = \"-1.2 m\"
bin_width = \"{WIDTH} m\"
values = \"density\"
[source.cube.capture]
eye = {eye:?}
look_at = {look_at:?}
up = {up:?}
hfov = \"{hfov} deg\"
"
        );
    }
    let scene = parse(&text, "test scene", folder, &Overrides::default())?;
    let request = Request {
        aovs: Aov::ALL.to_vec(),
        pixel_centers: true,
        ..Request::default()
    };
    let plan = Plan::new(&scene, &request)?;
    render(&Prepared::new(&scene, &plan, &Silent)?, &Silent)
}

/// Squared errors of all pixels, of those whose data are known.
fn errors(film: &Film) -> Vec<Option<f64>> {
    let [x, z, t] = [Aov::EventX, Aov::EventZ, Aov::EventCt].map(|aov| film.aov(aov).unwrap());
    let known = film.aov(Aov::Coverage).unwrap();
    let error = |i: usize| (film.radiance()[i][0] - f(x[i], z[i], t[i])).powi(2);
    let pixels = 0..film.radiance().len();
    pixels
        .map(|i| (known[i] == 1.0).then(|| error(i)))
        .collect()
}

fn total(errors: &[Option<f64>], of: impl Fn(usize) -> bool) -> f64 {
    let chosen = errors.iter().enumerate().filter(|(i, _)| of(*i));
    chosen.filter_map(|(_, error)| *error).sum()
}

#[test]
fn blending_takes_most_from_the_capture_that_sees_finest() {
    let folder = tempfile::tempdir().unwrap();
    for camera in [grazing(), above()] {
        record(folder.path(), &camera);
    }
    let film = |cameras: &[Camera], keys: &str| picture(folder.path(), cameras, keys).unwrap();
    let alone = film(&[grazing()], "");
    let fine = film(&[above()], "");
    let both = film(&[grazing(), above()], "");
    let [of_grazing, of_fine, of_both] = [&alone, &fine, &both].map(errors);
    let seen_finely = |i: usize| of_fine[i].is_some();
    let everywhere = |_: usize| true;
    assert!(of_grazing.iter().chain(&of_both).all(Option::is_some));
    let count = (0..of_fine.len()).filter(|i| seen_finely(*i)).count();
    assert!(count > 500 && count < of_fine.len(), "{count}");

    // Where both see the floor, what is seen at 3 degrees counts for nothing.
    let [coarse, blended, best] =
        [&of_grazing, &of_both, &of_fine].map(|errors| total(errors, seen_finely));
    println!("where both see: grazing {coarse:.3e}, blended {blended:.3e}, above {best:.3e}");
    assert!(blended < 0.02 * coarse && blended < 1.1 * best + 1e-6 * coarse);
    let [coarse, blended] = [&of_grazing, &of_both].map(|errors| total(errors, everywhere));
    println!("everywhere: grazing {coarse:.3e}, blended {blended:.3e}");
    assert!(blended < 0.8 * coarse);

    // The channel says which it is, as does that of its footprint.
    let source = both.aov(Aov::CaptureSource).unwrap();
    let cosine = both.aov(Aov::CaptureCosine).unwrap();
    for i in 0..source.len() {
        let inside = fine.aov(Aov::CaptureSource).unwrap()[i] == 0.0;
        assert_eq!(inside, seen_finely(i), "{i}");
        assert!(source[i] == 0.0 || inside, "{i}");
        assert_eq!(cosine[i] > 0.9, source[i] == 1.0, "{i}");
    }
    let taken = source.iter().filter(|source| **source == 1.0).count();
    assert!(taken as f64 > 0.9 * count as f64, "{taken} of {count}");
}

#[test]
fn the_first_that_sees_a_point_gives_all_of_it_where_that_is_asked() {
    let folder = tempfile::tempdir().unwrap();
    for camera in [grazing(), above()] {
        record(folder.path(), &camera);
    }
    let film = |cameras: &[Camera], keys: &str| picture(folder.path(), cameras, keys).unwrap();
    let alone = film(&[grazing()], "");
    let fine = film(&[above()], "");
    let first = film(&[above(), grazing()], "captures = \"first\"");
    let other = film(&[grazing(), above()], "captures = \"first\"");
    assert_eq!(other.radiance(), alone.radiance());
    let seen = fine.aov(Aov::Coverage).unwrap();
    for (i, seen) in seen.iter().enumerate() {
        let expected = if *seen == 1.0 { &fine } else { &alone };
        assert_eq!(first.radiance()[i], expected.radiance()[i], "{i}");
    }
}

#[test]
fn where_no_capture_sees_channels_say_why() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), &above());
    let twice = [above(), above()];
    let both = picture(folder.path(), &twice, "").unwrap();
    let alone = picture(folder.path(), &twice[..1], "").unwrap();
    // Two captures that are the same: the sum of two equal weights changes nothing but roundings.
    for (a, b) in both.radiance().iter().zip(alone.radiance()) {
        assert!((a[0] - b[0]).abs() < 1e-14, "{a:?} {b:?}");
    }
    let off = both.aov(Aov::MissingOffTexture).unwrap();
    assert_eq!(off, alone.aov(Aov::MissingOffTexture).unwrap());
    let source = both.aov(Aov::CaptureSource).unwrap();
    for i in 0..off.len() {
        assert_eq!(source[i] == -1.0, off[i] == 1.0, "{i}");
    }
    assert!(off.contains(&1.0) && off.contains(&0.0));
}

#[test]
fn captures_share_a_surface_with_captures_of_the_same_quantity_only() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), &above());
    let source = |rest: &str| {
        format!("[[source]]\n{rest}[source.cube]\nfile = \"above.npy\"\nbin_width = \"1 m\"\n")
    };
    let capture = "capture = { eye = [0.5, 3, 0], look_at = [0.5, 0, 0], up = [0, 0, -1], hfov = \"18 deg\" }\n";
    let plan = |sources: String| {
        let text = format!(
            "[camera]\neye = [0, 2, 2]\nlook_at = [0, 0, 0]\n[[object]]\nshape = {{ plane = {{ size = [4, 4] }} }}\n{sources}"
        );
        let scene = parse(&text, "test", folder.path(), &Overrides::default())?;
        Plan::new(&scene, &Request::default())
    };
    let both = source("") + capture + &source("") + capture;
    assert_eq!(plan(both).unwrap().rays.shadow_at_most % 2, 0);
    let texture = source("") + capture + &source("") + "uv = 0\n";
    assert!(
        plan(texture)
            .unwrap_err()
            .to_string()
            .contains("two sources")
    );
    let line = "radiance = { quantity = \"line\", wavelength = \"500 nm\" }\n";
    let other = source("") + capture + &source(line) + capture;
    assert!(plan(other).unwrap_err().to_string().contains("quantity"));
}
