//! Lookups that average over the footprint of a sample, against pictures with very many samples and closed forms.

use std::io::Write;

use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::{Overrides, parse};
use tempfile::TempDir;

/// Texels along each side, and bins.
const SIDE: usize = 640;
const BINS: usize = 5;

/// Noise from texel to texel that rises in time: nothing is as hard to show in few pixels.
fn cube(folder: &TempDir) {
    let header =
        format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({SIDE}, {SIDE}, {BINS}), }}");
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    writeln!(bytes, "{header:<117}").unwrap();
    for texel in 0..(SIDE * SIDE) as u64 {
        let noise = texel.wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(23) % 1000;
        for bin in 0..BINS {
            let sample = noise as f32 * (1.0 + bin as f32);
            bytes.extend(sample.to_le_bytes());
        }
    }
    std::fs::write(folder.path().join("cube.npy"), bytes).unwrap();
}

/// A floor that fills the picture, seen at a slant by a camera that moves; as `mapping` has it.
fn picture(
    folder: &TempDir,
    samples: u32,
    size: [u32; 2],
    mapping: &str,
    object: &str,
) -> Vec<f64> {
    // Light takes some 9 m more to a capture camera.
    let start = if mapping.contains("capture") { 5 } else { -10 };
    let text = format!(
        "[camera]\neye = [0.2, 3, 0.1]\nlook_at = [0, 0, -3]\nhfov = \"50 deg\"\nsize = {size:?}\nvelocity = {{ beta = [0.1, 0, -0.5] }}\n\
         time = \"10 m\"\n[display]\nsamples_per_pixel = {samples}\n\
         [[object]]\nname = \"floor\"\nshape = {{ plane = {{ size = [40, 40] }} }}\n{object}\n\
         [[source]]\n[source.cube]\nfile = \"cube.npy\"\nstart = \"{start} m\"\nbin_width = \"5 m\"\n{mapping}\n"
    );
    let scene = parse(&text, "footprints", folder.path(), &Overrides::default())
        .unwrap_or_else(|e| panic!("{e} {}", e.help()));
    let plan = Plan::new(&scene, &Request::default()).unwrap();
    let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    let film = render(&prepared, &Silent).unwrap();
    film.radiance().iter().map(|rgb| rgb[0]).collect()
}

fn error(picture: &[f64], truth: &[f64]) -> f64 {
    let (mut square, mut all) = (0.0, 0.0);
    for (value, truth) in picture.iter().zip(truth) {
        square += (value - truth) * (value - truth);
        all += truth * truth;
    }
    (square / all).sqrt()
}

const CAPTURE: &str = "clock = \"capture\"
capture = { eye = [1, 9, -9], look_at = [1, 0, -9], up = [0, 0, -1], hfov = \"100 deg\" }";
const RESTS: &str = "";

#[test]
fn one_filtered_sample_is_as_good_as_dozens_of_plain_ones() {
    let folder = tempfile::tempdir().unwrap();
    cube(&folder);
    for (mapping, object, least) in [("uv = 0", RESTS, 6.0), (CAPTURE, RESTS, 6.0)] {
        let filtered = format!("reconstruction = \"footprint\"\n{mapping}");
        let size = [24, 18];
        let truth = picture(&folder, 1024, size, mapping, object);
        assert!(truth.iter().all(|value| *value > 0.0));
        let plain = error(&picture(&folder, 1, size, mapping, object), &truth);
        let one = error(&picture(&folder, 1, size, &filtered, object), &truth);
        let four = error(&picture(&folder, 4, size, &filtered, object), &truth);
        println!("{mapping} {object}: {plain} {one} {four}");
        assert!(one < plain / least, "{mapping} {object}: {one} for {plain}");
        assert!(
            four < plain / least,
            "{mapping} {object}: {four} for {plain}"
        );
    }
}

/// Where the camera moves, what a place on the film shows slides over the floor while the shutter is open: 1 m of the camera's time is
/// some 0.6 m of way, ten texels.
#[test]
fn an_exposure_filters_along_the_way_that_points_slide() {
    let folder = tempfile::tempdir().unwrap();
    cube(&folder);
    let size = [24, 18];
    for mapping in ["uv = 0", CAPTURE] {
        let open = |mapping: &str| {
            format!("{mapping}\n[camera.shutter]\nduration = \"1 m\"\nintegration = \"means\"")
        };
        let plain = open(mapping);
        let filtered = open(&format!("reconstruction = \"footprint\"\n{mapping}"));
        let truth = picture(&folder, 4096, size, &plain, RESTS);
        assert!(truth.iter().all(|value| *value > 0.0));
        let [few, one, four, many] = [(&plain, 4), (&filtered, 1), (&filtered, 4), (&filtered, 64)]
            .map(|(mapping, samples)| {
                error(&picture(&folder, samples, size, mapping, RESTS), &truth)
            });
        println!("{mapping}: {few} {one} {four} {many}");
        assert!(one < few / 4.0, "{mapping}: {one} for {few}");
        assert!(four < few / 4.0, "{mapping}: {four} for {few}");
        assert!(many < few / 4.0, "{mapping}: {many} for {few}");
    }
}

#[test]
fn where_a_pixel_is_within_a_texel_nothing_changes() {
    let folder = tempfile::tempdir().unwrap();
    cube(&folder);
    let object = "transform = { scale = 400 }";
    for mapping in [
        "uv = 0",
        "capture = { eye = [0, 4000, -4], look_at = [0, 0, -4], up = [0, 0, -1], hfov = \"100 deg\" }",
    ] {
        let filtered = format!("reconstruction = \"footprint\"\n{mapping}");
        let [plain, filtered] =
            [mapping, &filtered].map(|mapping| picture(&folder, 2, [64, 48], mapping, object));
        assert!(plain.iter().any(|value| *value > 0.0));
        assert_eq!(plain, filtered, "{mapping}");
    }
}

/// Values of 2 × 2 texels, all alike, by bin.
fn of_time(folder: &TempDir, bins: usize, value: impl Fn(usize) -> f64) {
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2, {bins}), }}");
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    writeln!(bytes, "{header:<117}").unwrap();
    for _ in 0..4 {
        for bin in 0..bins {
            bytes.extend(value(bin).to_le_bytes());
        }
    }
    std::fs::write(folder.path().join("time.npy"), bytes).unwrap();
}

/// A floor, seen at a slant from 3 m above it, with light that changes in time alone.
fn in_time(folder: &TempDir, (samples, hfov): (u32, f64), camera: &str, source: &str) -> Vec<f64> {
    let text = format!(
        "[camera]\neye = [0, 3, 0]\nlook_at = [0, 0, -3]\nhfov = \"{hfov} deg\"\nsize = [24, 18]\ntime = \"10 m\"\n{camera}\n\
         [display]\nsamples_per_pixel = {samples}\n\
         [[object]]\nname = \"floor\"\nshape = {{ plane = {{ size = [40, 40] }} }}\n\
         [[source]]\n[source.cube]\nfile = \"time.npy\"\nvalues = \"density\"\n{source}\n"
    );
    let scene = parse(&text, "footprints", folder.path(), &Overrides::default())
        .unwrap_or_else(|e| panic!("{e} {}", e.help()));
    let plan = Plan::new(&scene, &Request::default()).unwrap();
    let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    let film = render(&prepared, &Silent).unwrap();
    film.radiance().iter().map(|rgb| rgb[0]).collect()
}

/// Noise from bin to bin, where pixels show up to some dozens of bins.
#[test]
fn a_filtered_sample_is_the_mean_over_all_bins_that_it_shows() {
    let folder = tempfile::tempdir().unwrap();
    let noise = |bin: usize| {
        let hash = (bin as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        0.5 + ((hash ^ (hash >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 40) as f64 / 1e7
    };
    const BINS: usize = 4000;
    of_time(&folder, BINS, noise);
    let even = "start = \"-20 m\"\nbin_width = \"0.01 m\"";
    let edges: Vec<String> = (0..=BINS)
        .map(|k| format!("\"{} m\"", -20.0 + 0.01 * (k as f64 + 0.3 * (k % 2) as f64)))
        .collect();
    let uneven = format!("edges = [{}]", edges.join(", "));
    let capture = "start = \"0 m\"\nbin_width = \"0.01 m\"\nclock = \"capture\"
capture = { eye = [1, 9, -9], look_at = [1, 0, -9], up = [0, 0, -1], hfov = \"130 deg\" }";
    let moves = "velocity = { beta = [0.1, 0, -0.5] }";
    // A pixel shows less time than the exposure takes, and more.
    let long = "[camera.shutter]\nduration = \"2 m\"\nintegration = \"means\"";
    let short = "[camera.shutter]\nduration = \"0.1 m\"\nintegration = \"means\"";
    for (camera, source, least) in [
        ("", format!("uv = 0\n{even}"), 8.0),
        (moves, format!("uv = 0\n{even}"), 8.0),
        ("", format!("uv = 0\n{uneven}"), 4.0),
        (moves, capture.to_string(), 6.0),
        (short, format!("uv = 0\n{even}"), 3.0),
        // Means over 200 bins have little noise left; of the 4096 samples of the truth 0.005.
        (long, format!("uv = 0\n{even}"), 1.3),
    ] {
        let filtered = format!("reconstruction = \"footprint\"\n{source}");
        let truth = in_time(&folder, (4096, 50.0), camera, &source);
        let plain = error(&in_time(&folder, (1, 50.0), camera, &source), &truth);
        let one = error(&in_time(&folder, (1, 50.0), camera, &filtered), &truth);
        let four = error(&in_time(&folder, (4, 50.0), camera, &filtered), &truth);
        let what = format!("{camera} {}", &source[..source.len().min(60)]);
        println!("{what}: {plain} {one} {four}");
        assert!(one < plain / least, "{what}: {one} for {plain}");
        // All parts of the pixel and all parts of an exposure are among what four samples stand for.
        assert!(four < plain / least, "{what}: {four} for {plain}");
    }
}

/// Radiance (t − t₀)²: its mean over a pixel exceeds that in its middle by the variance of the times that the pixel shows,
/// which for a pinhole at rest are ct − r with r = 3 m |d|/(−d_y), d the direction with a forward part of 1.
#[test]
fn the_spread_of_times_is_that_of_the_distances_to_a_tilted_floor() {
    let folder = tempfile::tempdir().unwrap();
    let zero = 10.0 - 18f64.sqrt();
    const BINS: usize = 2048;
    let width = 5e-4;
    let start = zero - 0.5 * BINS as f64 * width;
    of_time(&folder, BINS, |bin| {
        let t = start + (bin as f64 + 0.5) * width - zero;
        t * t
    });
    let source = format!(
        "reconstruction = \"footprint\"\nuv = 0\nstart = \"{start} m\"\nbin_width = \"{width} m\"\nfilter = \"linear\""
    );
    let hfov = 2.0;
    let shown = in_time(&folder, (1, hfov), "", &source);
    let half = (0.5 * hfov).to_radians().tan();
    // 24 × 18 pixels, y down; the camera looks 45° down.
    let retarded = |x: f64, y: f64| {
        let [right, up] = [(x - 12.0) / 12.0 * half, (9.0 - y) / 12.0 * half];
        let fall = (1.0 - up) * 0.5f64.sqrt();
        10.0 - 3.0 * (1.0 + right * right + up * up).sqrt() / fall - zero
    };
    const PARTS: usize = 64;
    let mut told = 0;
    for (pixel, shown) in shown.iter().enumerate() {
        let [x, y] = [(pixel % 24) as f64, (pixel / 24) as f64];
        let times: Vec<f64> = (0..PARTS * PARTS)
            .map(|n| [n % PARTS, n / PARTS].map(|n| (n as f64 + 0.5) / PARTS as f64))
            .map(|[u, v]| retarded(x + u, y + v))
            .collect();
        let mean = |of: &dyn Fn(f64) -> f64| {
            times.iter().map(|t| of(*t)).sum::<f64>() / times.len() as f64
        };
        let middle = mean(&|t| t);
        let variance = mean(&|t| (t - middle) * (t - middle));
        // Derivatives at the sample stand for those of all of the pixel: (t_xx + t_yy)/24 is `curved`, and from a corner to
        // the middle they miss (t_xx + t_yy)/8 and what the two have in common.
        let curved = (middle - retarded(x + 0.5, y + 0.5)).abs();
        let allowed = 12.0 * curved * middle.abs() + 0.02 * variance + width * width;
        let error = shown - mean(&|t| t * t);
        assert!(error.abs() < allowed, "{x}, {y}: {error} of {variance}");
        told += usize::from(variance > 4.0 * allowed);
    }
    println!("{told} pixels tell");
    assert!(told > 100, "{told}");
}
