//! Golden pictures, as last reviewed.

use crate::common::png::decode;
use std::path::PathBuf;

use nullray::figures::drawing::png::{RgbaImage, render, write};

use super::samples;

/// Where two pictures may differ without anybody seeing it, of 255: at edges, and on the average.
const MOST: u8 = 24;
const MEAN: f64 = 0.1;

fn golden(name: &str) -> PathBuf {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/drawing");
    PathBuf::from(folder).join(format!("{name}.png"))
}

/// All pictures: samples at twice the points, and the classic diagrams small.
fn pictures() -> Vec<(String, RgbaImage)> {
    let samples = samples::all().into_iter();
    let samples = samples.map(|(name, drawing)| (name.to_string(), render(&drawing, 2.0).unwrap()));
    let classics = samples::classics().into_iter();
    let classics = classics.map(|(name, drawing)| (name, render(&drawing, 0.6).unwrap()));
    samples.chain(classics).collect()
}

/// expected | difference | actual, where a failed test leaves them.
fn strip(name: &str, expected: &[u8], actual: &RgbaImage) -> PathBuf {
    let row = 4 * actual.width as usize;
    let mut rgba = Vec::with_capacity(3 * expected.len());
    for (expected, actual) in expected
        .chunks_exact(row)
        .zip(actual.rgba.chunks_exact(row))
    {
        let difference = expected.iter().zip(actual).enumerate();
        let difference =
            difference.map(|(i, (a, b))| if i % 4 == 3 { 255 } else { a.abs_diff(*b) });
        rgba.extend_from_slice(expected);
        rgba.extend(difference);
        rgba.extend_from_slice(actual);
    }
    let strip = RgbaImage {
        width: 3 * actual.width,
        rgba,
        ..actual.clone()
    };
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.png"));
    std::fs::write(&path, write(&strip).unwrap()).unwrap();
    path
}

#[test]
fn samples_look_as_they_did() {
    for (name, actual) in pictures() {
        let expected = decode(&std::fs::read(golden(&name)).unwrap()).unwrap();
        assert_eq!(
            (expected.width, expected.height),
            (actual.width, actual.height)
        );
        let pairs = expected.rgba.iter().zip(&actual.rgba);
        let off: Vec<u8> = pairs.map(|(a, b)| a.abs_diff(*b)).collect();
        let most = *off.iter().max().unwrap();
        let mean = off.iter().map(|o| f64::from(*o)).sum::<f64>() / off.len() as f64;
        if most > MOST || mean > MEAN {
            let strip = strip(&name, &expected.rgba, &actual);
            panic!(
                "{name} is off by {most}, {mean} on the average: see {}",
                strip.display()
            );
        }
    }
}

/// Run by name after looking at the strips of a change that is meant.
#[test]
#[ignore = "replaces the pictures that the other test compares with"]
fn write_the_pictures() {
    for (name, picture) in pictures() {
        std::fs::write(golden(&name), write(&picture).unwrap()).unwrap();
    }
}
