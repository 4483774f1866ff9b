//! Reading files, and what their limits cost.
//!
//! Before anything is allocated, readers look at what a header claims, and take it from a budget. That does not grow
//! with the samples: it takes less than all of a file with one pixel or bin does, from opening to the last byte. JSON lines
//! in `target/bench/load.jsonl`: fields `case`, `bytes` of the file, `load_s`, `one_pixel_s` for such a file, `limits_at_most`,
//! the second over the first, and `spread`, quartiles of the first over its best. `--smoke` and `NULLRAY_BENCH_SMOKE=1` use tiny sizes.

mod common;

use std::fs;
use std::hint::black_box;
use std::path::Path;

use nullray::io::budget::Budget;
use nullray::io::cube::{self, Cube, Wanted};
use nullray::io::image::{Channel, Layers, Samples, exr, npz, png};
use nullray::validate::compare::{Encoding, Picture};

use common::{Rounds, is_smoke, report, report_file};

/// A format: its name, and how a file of so many pixels to the side is written and read.
type Case = (&'static str, fn(&Path, usize), fn(&Path));

const CASES: [Case; 4] = [
    (
        "picture.png",
        |path, side| {
            let rgb: Vec<u8> = (0..3 * side * side).map(|i| (i * i / 7) as u8).collect();
            png::write(path, side as u32, side as u32, &rgb, &[]).expect("it can be written");
        },
        |path| {
            drop(black_box(
                png::read(path, &Budget::default()).expect("it can be read"),
            ))
        },
    ),
    (
        "picture.exr",
        |path, side| exr::write(path, &layers(side)).expect("it can be written"),
        |path| {
            drop(black_box(
                exr::read(path, &Budget::default()).expect("it can be read"),
            ))
        },
    ),
    (
        "picture.npz",
        |path, side| npz::write(path, &layers(side)).expect("it can be written"),
        |path| {
            drop(black_box(
                Picture::read(path, Encoding::Linear, &Budget::default()).expect("it can be read"),
            ))
        },
    ),
    ("cube.npy", write_cube, read_cube),
];

/// Radiance and a channel, as smooth as pictures are.
fn layers(side: usize) -> Layers {
    let names = ["radiance.R", "radiance.G", "radiance.B", "distance"];
    let value = |k: usize, i: usize| libm::sin((k + 1) as f64 * i as f64 / side as f64) as f32;
    let channel = |(k, name): (usize, &&str)| Channel {
        name: name.to_string(),
        samples: Samples::F32((0..side * side).map(|i| value(k, i)).collect()),
    };
    Layers {
        width: side as u32,
        height: side as u32,
        channels: names.iter().enumerate().map(channel).collect(),
        metadata: Vec::new(),
    }
}

/// A cube of about as many samples as a picture of that side has.
fn write_cube(path: &Path, side: usize) {
    let bins = if side > 1 { 64 } else { 1 };
    let side = side.div_ceil(8);
    let samples = (0..side * side * bins).map(|i| i as f32).collect();
    let cube = Cube {
        shape: [side, side, bins, 1],
        samples: cube::CubeSamples::F32(samples),
    };
    npz::write_cube(path, &cube).expect("it can be written");
}

fn read_cube(path: &Path) {
    drop(black_box(
        cube::load(path, Wanted::default()).expect("it can be read"),
    ));
}

fn main() {
    let (side, rounds) = if is_smoke() { (64, 3) } else { (2048, 9) };
    let folder = tempfile::tempdir().expect("a folder");
    let mut file = report_file("load");
    for (name, write, read) in CASES {
        let [large, one] = [side, 1].map(|side| {
            let path = folder.path().join(format!("{side}-{name}"));
            write(&path, side);
            let bytes = fs::metadata(&path).expect("it is there").len();
            let rounds = if side == 1 { 100 * rounds } else { rounds };
            let times = Rounds::of(rounds, &mut [|| read(&path)]);
            (bytes, times.best(0), times.spread(0).quartiles())
        });
        let line = serde_json::json!({
            "case": name, "bytes": large.0, "load_s": large.1, "one_pixel_s": one.1, "limits_at_most": one.1 / large.1,
            "spread": large.2,
        });
        report(&mut file, &line);
    }
}
