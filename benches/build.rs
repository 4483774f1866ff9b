//! Building trees: by mesh, preset and number of threads.
//!
//! Measured in turn with obvhs alone (its medium preset: f32 boxes, no corners), best of several rounds and their `times_obvhs` on one
//! thread (median and `quartiles`), and
//! what the tree is worth: the time of one 1024² picture by one thread, for the sum that a still takes, and of 2¹⁷ rays that
//! go on from what it shows all ways. JSON lines in `target/bench/build.jsonl`: fields `case`, `preset`, `threads`,
//! `triangles`, `build_s`, `mtriangles_per_s`, `bytes_per_triangle`, `trace_s`, `ns_per_ray`, `ns_per_bounced_ray`. Meshes: every `*.tri` of the folder `NULLRAY_BENCH_MESHES`, else generated ones and a
//! sphere of 1.6 million triangles. Then triangles of which none lies better with one than with another: coincident,
//! concentric, … ([`FAMILIES`]), from 10³ to 10⁶, with `over_random`, the time over that of as many random ones. `--smoke` and `NULLRAY_BENCH_SMOKE=1` use tiny sizes.

mod common;

use std::time::Instant;

use glam::DVec3;
use nullray::accel::{Bvh, Facing, Origins, Preset, Ray, Traversal};

use common::{
    Camera, Peer, Ratio, TILE, best, best_of, meshes, on_threads, report, report_file, sphere,
    trace_tile,
};

fn main() {
    let smoke = common::is_smoke();
    let (image, rounds) = if smoke { (32, 1) } else { (1024, 5) };
    let mut file = report_file("build");
    let mut all = meshes(smoke, if smoke { 12 } else { 256 });
    if !smoke && std::env::var_os("NULLRAY_BENCH_MESHES").is_none() {
        all.push(("large sphere".into(), sphere(730)));
    }
    for (name, triangles) in all {
        let rounds = if triangles.len() > 1_000_000 {
            rounds.min(3)
        } else {
            rounds
        };
        let mut seconds: Vec<Vec<f64>> = cases().map(|_| Vec::new()).collect();
        for _ in 0..rounds {
            for (seconds, (preset, threads)) in seconds.iter_mut().zip(cases()) {
                seconds.push(build_time(&triangles, preset, threads));
            }
        }
        let alone = cases().position(|case| case == (None, 1)).expect("obvhs");
        for (k, (preset, threads)) in cases().enumerate() {
            let ratio = Ratio::of(&seconds[k], &seconds[alone]);
            let seconds = best(&seconds[k]);
            let worth = preset.map(|preset| worth(&name, &triangles, preset, image));
            let line = serde_json::json!({
                "case": name, "preset": preset.map_or("obvhs medium".into(), |p| format!("{p:?}").to_lowercase()),
                "threads": threads, "triangles": triangles.len(), "build_s": seconds,
                "mtriangles_per_s": triangles.len() as f64 / seconds / 1e6,
                "times_obvhs": ratio.middle, "quartiles": ratio.quartiles(),
                "bytes_per_triangle": worth.as_ref().map(|w| w.bytes), "trace_s": worth.as_ref().map(|w| w.picture),
                "ns_per_ray": worth.as_ref().map(|w| w.per_ray), "ns_per_bounced_ray": worth.as_ref().map(|w| w.per_bounced_ray),
            });
            report(&mut file, &line);
        }
    }
    let counts: &[usize] = match smoke {
        true => &[1000],
        false => &[1000, 10_000, 100_000, 1_000_000],
    };
    for &count in counts {
        let mut random = f64::NAN;
        for (name, triangle) in FAMILIES {
            let mut numbers = Numbers(1);
            let triangles: Vec<_> = (0..count)
                .map(|i| triangle(i, count, &mut numbers))
                .collect();
            let time = |_| build_time(&triangles, Some(Preset::Balanced), 2);
            let seconds: Vec<f64> = (0..rounds.min(3)).map(time).collect();
            let seconds = best(&seconds);
            if name == "random" {
                random = seconds;
            }
            let line = serde_json::json!({
                "case": name, "preset": "balanced", "threads": 2, "triangles": count, "build_s": seconds,
                "mtriangles_per_s": count as f64 / seconds / 1e6, "over_random": seconds / random,
            });
            report(&mut file, &line);
        }
    }
}

/// A linear congruential generator.
struct Numbers(u64);

impl Numbers {
    /// A number in [0, 1).
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn point(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }
}

/// A triangle of a family: its index, of how many, and random numbers.
type Make = fn(usize, usize, &mut Numbers) -> [DVec3; 3];

/// Triangles on which builders of trees have been seen to be slow; random ones come first.
const FAMILIES: [(&str, Make); 10] = [
    ("random", |_, count, numbers| {
        small(numbers.point(), (count as f64).cbrt().recip())
    }),
    ("coincident", |_, _, _| small(DVec3::splat(0.5), 0.3)),
    ("concentric", |i, count, _| {
        let size = (i + 1) as f64 / count as f64;
        [DVec3::X, DVec3::Y, -DVec3::ONE].map(|corner| corner * size)
    }),
    ("from one corner", |i, count, _| {
        let size = (i + 1) as f64 / count as f64;
        [DVec3::ZERO, DVec3::X * size, DVec3::Y * size]
    }),
    ("duplicated", |i, count, _| {
        let mut place = Numbers((i % (count / 100).max(1)) as u64);
        place.next();
        small(place.point(), 0.02)
    }),
    ("collinear", |i, count, _| {
        let x = i as f64 / count as f64;
        let step = DVec3::X / count as f64;
        [
            DVec3::X * x,
            DVec3::X * x + step,
            DVec3::X * x + DVec3::Y * 1e-6,
        ]
    }),
    ("huge and tiny", |i, _, numbers| match i % 2 {
        0 => [DVec3::ZERO, DVec3::X, DVec3::new(0.5, 1.0, 1.0)],
        _ => small(numbers.point(), 1e-9),
    }),
    ("concentric, on a floor", |i, count, _| match i {
        0 => [DVec3::X * -99.0, DVec3::X * 99.0, DVec3::Z * 99.0],
        _ => [DVec3::X, DVec3::Y, -DVec3::ONE].map(|corner| corner * i as f64 / count as f64),
    }),
    (
        "coincident, among random ones",
        |i, count, numbers| match i % 4 {
            0 => small(DVec3::splat(0.5), 0.02),
            _ => small(numbers.point(), (count as f64).cbrt().recip()),
        },
    ),
    ("needles", |_, _, numbers| {
        [numbers.point(), numbers.point(), numbers.point()]
    }),
];

fn small(place: DVec3, size: f64) -> [DVec3; 3] {
    [
        place,
        place + DVec3::X * size,
        place + DVec3::new(0.3, 1.0, 0.5) * size,
    ]
}

/// Presets, and none for obvhs alone, by one and by two threads.
fn cases() -> impl Iterator<Item = (Option<Preset>, usize)> {
    let presets = Preset::ALL.map(Some).into_iter().chain([None]);
    presets.flat_map(|preset| [(preset, 1), (preset, 2)])
}

fn build_time(triangles: &[[DVec3; 3]], preset: Option<Preset>, threads: usize) -> f64 {
    on_threads(threads, || {
        let Some(preset) = preset else {
            return Peer::build(triangles).1.as_secs_f64();
        };
        let copy = triangles.to_vec();
        let begin = Instant::now();
        std::hint::black_box(Bvh::build_with(copy, |_| Facing::TwoSided, preset));
        begin.elapsed().as_secs_f64()
    })
}

/// What a tree is worth.
struct Worth {
    /// Bytes per triangle.
    bytes: f64,
    /// Seconds of a picture, and nanoseconds per ray of it.
    picture: f64,
    per_ray: f64,
    /// Nanoseconds per ray that goes on from what the picture shows, one of eight, in no order and all ways.
    per_bounced_ray: f64,
}

fn worth(name: &str, triangles: &[[DVec3; 3]], preset: Preset, image: usize) -> Worth {
    let bvh = Bvh::build_with(triangles.to_vec(), |_| Facing::TwoSided, preset);
    let place = match name {
        "kitchen" | "room" => (0.3, 0.7),
        _ => (2.2, 0.5),
    };
    let camera = Camera::new(&bvh, place.0, place.1, image);
    let picture = best_of(5, || {
        for tile in camera.directions.chunks(TILE * TILE) {
            trace_tile(&bvh, camera.origin, tile);
        }
    });
    // Rays of the picture in no order, and from where they end.
    let rays = camera.rays();
    let mut numbers = Numbers(1);
    let (mut origins, mut directions) = (Vec::new(), Vec::new());
    for k in 0..rays / 8 {
        let direction = camera.directions[k * 8 * 40_503 % rays];
        let ray = Ray {
            origin: camera.origin,
            direction,
            s_min: 0.0,
        };
        if let Some(hit) = bvh.closest(&ray, f64::INFINITY) {
            origins.push(camera.origin + direction * (hit.s * (1.0 - 1e-9)));
            directions.push((numbers.point() - 0.5).normalize());
        }
    }
    let bounced = best_of(5, || {
        let tiles = origins
            .chunks(TILE * TILE)
            .zip(directions.chunks(TILE * TILE));
        for (origins, directions) in tiles {
            let mut hits = [None; TILE * TILE];
            let (method, from) = (Traversal::default(), Origins::Each(origins));
            let hits = &mut hits[..origins.len()];
            bvh.closest_by(method, from, directions, hits, None, None);
            std::hint::black_box(hits);
        }
    });
    Worth {
        bytes: bvh.bytes() as f64 / triangles.len() as f64,
        picture,
        per_ray: 1e9 * picture / rays as f64,
        per_bounced_ray: 1e9 * bounced / origins.len() as f64,
    }
}
