//! Lookups in time textures: nanoseconds per lookup, one thread.
//!
//! A cube that fits the second-level cache and one that fits none, each in half and single precision
//! and with every filter in time; at texture coordinates row by row with a slowly moving time, as a picture
//! asks, and anywhere at any time. Filters are measured in turn. JSON lines in `target/bench/lookup.jsonl`: fields `case`, `filter`, `order`,
//! `bytes` of the cube, `lookups`, `ns_per_lookup`, `times_nearest` (the median of rounds) and its `quartiles`. `--smoke` and `NULLRAY_BENCH_SMOKE=1` use tiny sizes.

mod common;

use std::hint::black_box;

use glam::DVec2;
use half::f16;
use nullray::io::cube::{Cube, CubeSamples};
use nullray::light::time_texture::{TimeAxis, TimeTexture};
use nullray::scene::model::{BinValues, Fill, Outside, TimeBins, TimeFilter};

use common::{Rounds, report, report_file};

const FILTERS: [(&str, TimeFilter); 4] = [
    ("nearest", TimeFilter::Nearest),
    ("linear", TimeFilter::Linear),
    ("cubic", TimeFilter::Cubic),
    ("cubic_means", TimeFilter::CubicMeans),
];

fn main() {
    let smoke = common::is_smoke();
    let (small, large, rounds) = match smoke {
        true => ([8, 8, 16, 3], [16, 16, 32, 3], 1),
        false => ([32, 32, 64, 3], [512, 512, 128, 3], 5),
    };
    let mut file = report_file("lookup");
    let lookups = if smoke { 1000 } else { 1 << 20 };
    for (place, shape) in [("in cache", small), ("in memory", large)] {
        for precision in ["f16", "f32"] {
            let cube = std::sync::Arc::new(cube(shape, precision));
            for (order, points) in [
                ("in order", ordered(lookups)),
                ("anywhere", anywhere(lookups)),
            ] {
                let look_up = |(_, filter)| {
                    let texture = texture(cube.clone(), filter);
                    let points = &points;
                    move || {
                        for (uv, t) in points {
                            black_box(texture.sample_uv(*uv, *t));
                        }
                    }
                };
                let times = Rounds::of(rounds, &mut FILTERS.map(look_up));
                for (k, (name, _)) in FILTERS.into_iter().enumerate() {
                    let ratio = times.ratio(k, 0);
                    let line = serde_json::json!({
                        "case": format!("{place}, {precision}, {name}, {order}"), "filter": name, "order": order,
                        "threads": 1, "bytes": bytes(shape, precision), "lookups": lookups,
                        "ns_per_lookup": times.best(k) * 1e9 / lookups as f64,
                        "times_nearest": ratio.middle, "quartiles": ratio.quartiles(),
                    });
                    report(&mut file, &line);
                }
            }
        }
    }
}

fn bytes(shape: [usize; 4], precision: &str) -> usize {
    shape.iter().product::<usize>() * if precision == "f16" { 2 } else { 4 }
}

/// A smooth RGB cube.
fn cube(shape: [usize; 4], precision: &str) -> Cube {
    let value = |i: usize| ((i % 97) * (i / 193 % 89)) as f32 / 8633.0;
    let count = shape.iter().product();
    let samples = match precision {
        "f16" => CubeSamples::F16((0..count).map(|i| f16::from_f32(value(i))).collect()),
        _ => CubeSamples::F32((0..count).map(value).collect()),
    };
    Cube { shape, samples }
}

/// Times 0 to 1 m.
fn texture(cube: std::sync::Arc<Cube>, filter: TimeFilter) -> TimeTexture {
    let axis = TimeAxis {
        bins: TimeBins::Uniform {
            start: 0.0,
            width: 1.0 / cube.shape[2] as f64,
        },
        values: BinValues::PerBin,
        filter,
        scale: 1.0,
    };
    let outside = Outside {
        before: Fill::Black,
        after: Fill::Black,
        off_texture: Fill::Black,
        occluded: Fill::Black,
    };
    TimeTexture::new(cube, axis, outside).expect("a texture")
}

/// Tiles of 16 × 16 of an image, row by row; the time changes with the place.
fn ordered(count: usize) -> Vec<(DVec2, f64)> {
    let size = (count as f64).sqrt() as usize;
    let tiles = size.div_ceil(16);
    let point = |i: usize| {
        let (tile, at) = (i / 256, i % 256);
        let x = (tile % tiles * 16 + at % 16) as f64 / (tiles * 16) as f64;
        let y = ((tile / tiles * 16 + at / 16) as f64 / (tiles * 16) as f64).min(1.0);
        (DVec2::new(x, y), 0.1 + 0.3 * (x + y))
    };
    (0..count).map(point).collect()
}

/// SplitMix64.
fn anywhere(count: usize) -> Vec<(DVec2, f64)> {
    let mut state = 1u64;
    let mut number = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..count)
        .map(|_| (DVec2::new(number(), number()), number()))
        .collect()
}
