//! Many rays: closed meshes from inside, and all ways of tracing compared with each other.
//!
//! A ray from inside a closed mesh hits it, from behind: anything else is a leak. All kernels and all presets of the tree must hit the
//! same triangle at the same point, bit for bit.

use glam::DVec3;

use super::meshes::{PLACES, Random, Triangle, build, disc, placed, soup, sphere, tile};
use super::{Check, Outcome, count_in_batches, counted};
use crate::Result;
use crate::accel::{Bvh, Facing, Hit, Kernel, Origins, Precision, Preset, Traversal};
use crate::render::progress::Progress;

pub(super) const CHECKS: [Check; 3] = [
    counted(
        "watertight",
        "closed meshes from inside, at six sizes and places: random rays that are lost",
        "ray",
        [4_000_000, 100_000_000],
        watertight,
    ),
    counted(
        "kernels",
        "rays that two kernels do not trace alike, bit for bit: closed meshes, soups, needles",
        "ray",
        [500_000, 10_000_000],
        kernels,
    ),
    counted(
        "presets",
        "rays that two presets of the tree do not trace alike",
        "ray",
        [500_000, 10_000_000],
        presets,
    ),
];

/// The number of rays of a batch.
const BATCH: u64 = 256;

fn trace(bvh: &Bvh, kernel: Kernel, origin: DVec3, directions: &[DVec3]) -> Vec<Option<Hit>> {
    let method = Traversal {
        kernel,
        precision: Precision::Certified,
    };
    let mut hits = vec![None; directions.len()];
    let from = Origins::Shared(origin);
    bvh.closest_by(method, from, directions, &mut hits, None, None);
    hits
}

fn watertight(cases: u64, progress: &dyn Progress) -> Result<Outcome> {
    let squash = [DVec3::ONE, DVec3::new(1.0, 1.0, 1e-4)];
    let at = |(scale, shift): (f64, DVec3)| {
        let meshes = [sphere(5), disc(5)].map(|m| placed(m, DVec3::splat(scale), shift));
        meshes.map(build)
    };
    let trees = PLACES.map(at);
    count_in_batches(cases, BATCH, progress, |i| {
        let mut random = Random(i ^ 0x7761_7465);
        let (place, kind) = (i as usize % PLACES.len(), i as usize / 8 % 2);
        let (scale, shift) = PLACES[place];
        let origin = shift + random.vector() * squash[kind] * (0.5 * scale);
        // Coherent tiles of four densities, and rays in all directions.
        let directions: Vec<DVec3> = match i % 5 {
            4 => (0..BATCH).map(|_| random.direction()).collect(),
            k => {
                let axis = random.direction();
                tile(&mut random, axis, [0.05, 0.003, 2e-4, 1e-6][k as usize])
            }
        };
        let kernel = Kernel::ALL[i as usize / 16 % Kernel::ALL.len()];
        let hits = trace(&trees[place][kind], kernel, origin, &directions);
        hits.iter()
            .filter(|hit| hit.is_none_or(|h| h.front))
            .count() as u64
    })
}

/// Meshes without a shape.
fn meshes() -> [Vec<Triangle>; 4] {
    let mut random = Random(3);
    let needle = |i: usize| {
        let [at, along, aside] = [0; 3].map(|_| random.vector());
        let width = libm::exp2(-((i % 50) as f64));
        [at, at + along, at + along * 0.5 + aside * width]
    };
    let needles = (0..20_000).map(needle).collect();
    let mut random = Random(4);
    [
        placed(sphere(5), DVec3::splat(0.7), DVec3::ZERO),
        soup(&mut random, 30_000, 0.03),
        soup(&mut random, 300, 0.8),
        needles,
    ]
}

/// Rays of batch `i` into meshes of size 1 about the origin.
fn rays(i: u64) -> (DVec3, Vec<DVec3>) {
    let mut random = Random(i ^ 0x7261_7973);
    let origin = random.vector() * [0.5, 2.0, 1e3, 1e9][i as usize / 4 % 4];
    let axis = random.vector() * 0.7 - origin;
    let pitch = [0.05, 0.003, 1e-5][i as usize / 16 % 3] / (1.0 + origin.length());
    (origin, tile(&mut random, axis, pitch))
}

/// The numbers of a hit, without its position in the tree.
fn numbers(hit: &Option<Hit>) -> Option<[u64; 5]> {
    let bits = |h: &Hit| {
        let [s, u, v] = [h.s, h.u, h.v].map(f64::to_bits);
        [s, u, v, u64::from(h.triangle), u64::from(h.front)]
    };
    hit.as_ref().map(bits)
}

/// The number of entries in which two lists differ.
fn differing(a: &[Option<Hit>], b: &[Option<Hit>]) -> u64 {
    let differ = |(a, b): &(&Option<Hit>, &Option<Hit>)| numbers(a) != numbers(b);
    a.iter().zip(b).filter(differ).count() as u64
}

fn kernels(cases: u64, progress: &dyn Progress) -> Result<Outcome> {
    let trees = meshes().map(build);
    count_in_batches(cases, BATCH, progress, |i| {
        let (origin, directions) = rays(i);
        let all = Kernel::ALL.map(|k| trace(&trees[i as usize % 4], k, origin, &directions));
        all.iter()
            .map(|hits| differing(hits, &all[0]))
            .max()
            .unwrap_or(0)
    })
}

fn presets(cases: u64, progress: &dyn Progress) -> Result<Outcome> {
    let two_sided = |_| Facing::TwoSided;
    let of = |mesh: &Vec<_>| Preset::ALL.map(|p| Bvh::build_with(mesh.clone(), two_sided, p));
    let trees = meshes().each_ref().map(of);
    count_in_batches(cases, BATCH, progress, |i| {
        let (origin, directions) = rays(i);
        let all = trees[i as usize % 4].each_ref();
        let all = all.map(|bvh| trace(bvh, Kernel::best(), origin, &directions));
        all.iter()
            .map(|hits| differing(hits, &all[0]))
            .max()
            .unwrap_or(0)
    })
}
