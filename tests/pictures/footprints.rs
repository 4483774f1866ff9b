//! Lookups that are means over what samples stand for, against pictures of very many samples.

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
