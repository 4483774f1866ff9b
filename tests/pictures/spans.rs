//! Means over time spans: prefix sums against the sum of single bins, and against many lookups.

use std::time::Instant;

use glam::DVec2;
use nullray::io::cube::{Cube, CubeSamples};
use nullray::light::time_texture::{Near, Sampled, TimeAxis, TimeTexture};
use nullray::scene::model::{BinValues, Fill, Outside, TimeBins, TimeFilter};

const FILTERS: [TimeFilter; 4] = [
    TimeFilter::Nearest,
    TimeFilter::Linear,
    TimeFilter::Cubic,
    TimeFilter::CubicMeans,
];

/// A number in [0, 1) that tells nothing of its neighbours.
fn noise(index: usize) -> f64 {
    ((index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64 / (1u64 << 53) as f64
}

/// 3 × 4 texels of `bins` bins of 0.1 from −1 on.
fn texture(
    bins: usize,
    channels: usize,
    filter: TimeFilter,
    [before, after]: [Fill; 2],
) -> TimeTexture {
    let samples = (0..3 * 4 * bins * channels).map(noise).collect();
    let cube = Cube::new([3, 4, bins, channels], CubeSamples::F64(samples)).unwrap();
    let axis = TimeAxis {
        bins: TimeBins::Uniform {
            start: -1.0,
            width: 0.1,
        },
        values: BinValues::PerBin,
        filter,
        scale: 1.5,
    };
    let outside = Outside {
        before,
        after,
        off_texture: Fill::Black,
        occluded: Fill::Black,
    };
    TimeTexture::new(cube, axis, outside).unwrap()
}

const FILLS: [[Fill; 2]; 4] = [
    [Fill::Black, Fill::Black],
    [Fill::Hold, Fill::Hold],
    [Fill::Hold, Fill::Black],
    [Fill::Mark([1.0, 0.5, 0.25]), Fill::Hold],
];

fn difference(a: &Sampled, b: &Sampled) -> f64 {
    let both = |a: [f64; 3], b: [f64; 3]| a.into_iter().zip(b).collect::<Vec<_>>();
    let of_coverage = [
        (a.coverage.held, b.coverage.held),
        (a.coverage.before, b.coverage.before),
        (a.coverage.after, b.coverage.after),
    ];
    both(a.radiance, b.radiance)
        .into_iter()
        .chain(both(a.unscaled, b.unscaled))
        .chain(of_coverage)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

#[test]
fn prefix_sums_equal_sums_of_bins() {
    for filter in FILTERS {
        for fills in FILLS {
            for channels in [1, 3] {
                let direct = texture(300, channels, filter, fills);
                let summed = direct.clone().with_sums();
                for n in 0..400 {
                    let uv = DVec2::new(noise(3 * n), noise(3 * n + 1));
                    let from = -8.0 + 44.0 * noise(3 * n + 2);
                    let to = from + 1e-3 + 50.0 * noise(7 * n + 5).powi(3);
                    let [a, b] =
                        [&direct, &summed].map(|t| t.mean_uv(uv, [from, to], &Near::default()));
                    // Values are of the size of 15.
                    let error = difference(&a, &b);
                    assert!(error <= 1e-12, "{filter:?} {from} {to}: {error:e}");
                }
            }
        }
    }
}

#[test]
fn means_are_those_of_what_lookups_find() {
    const LOOKUPS: usize = 4000;
    for filter in FILTERS {
        for fills in FILLS {
            let texture = texture(40, 3, filter, fills).with_sums();
            for (from, to) in [
                (-0.93, -0.91),
                (-0.75, 0.35),
                (-1.4, 0.2),
                (2.5, 3.4),
                (-3.0, 5.0),
                (-2.0, -1.7),
                (4.1, 4.2),
            ] {
                let uv = DVec2::new(0.37, 0.61);
                let mut sum = Sampled::default();
                let part = 1.0 / LOOKUPS as f64;
                for n in 0..LOOKUPS {
                    let t = from + (to - from) * (n as f64 + 0.5) * part;
                    let Sampled {
                        radiance,
                        unscaled,
                        coverage,
                    } = texture.sample_uv(uv, t);
                    for c in 0..3 {
                        sum.radiance[c] += radiance[c] * part;
                        sum.unscaled[c] += unscaled[c] * part;
                    }
                    sum.coverage += coverage * part;
                }
                // Steps (of nearest, and at black ends) fall on one lookup or the next.
                let error = difference(&texture.mean_uv(uv, [from, to], &Near::default()), &sum);
                assert!(error < 0.02, "{filter:?} {fills:?} {from} {to}: {error:e}");
            }
        }
    }
}

#[test]
fn the_mean_over_a_very_short_span_is_the_value_there() {
    let later = |t: f64, ulps: u32| (0..ulps).fold(t, |t, _| t.next_up());
    let uv = DVec2::new(0.37, 0.61);
    for filter in FILTERS {
        for fills in FILLS {
            let texture = texture(40, 3, filter, fills).with_sums();
            for from in [
                -1e9, -3.7, -0.96, -0.95, 1e-17, 0.01, 0.55, 1.23456, 2.97, 7.3, 1e9,
            ] {
                for to in [
                    from,
                    later(from, 1),
                    later(from, 2),
                    later(from, 7),
                    from + 1e-13,
                    from + 1e-8,
                ] {
                    let mean = texture.mean_uv(uv, [from, to], &Near::default());
                    // A step of the nearest filter is at 0 and at −0.9 only, up to rounding.
                    let error = difference(&mean, &texture.sample_uv(uv, from));
                    assert!(error < 1e-5, "{filter:?} {fills:?} {from} {to}: {error:e}");
                }
            }
            // At the ends of the data, where held, marked and black times join, parts are between none and all.
            for at in [-1.0, 3.0] {
                for (before, after) in [(0, 0), (1, 0), (0, 1), (1, 2), (3, 1)] {
                    let from = (0..before).fold(at, |t: f64, _| t.next_down());
                    let mean = texture.mean_uv(uv, [from, later(at, after)], &Near::default());
                    let parts = [
                        mean.coverage.held,
                        mean.coverage.before,
                        mean.coverage.after,
                    ];
                    assert!(
                        parts.iter().all(|part| (0.0..=1.0).contains(part)),
                        "{parts:?}"
                    );
                    assert!(
                        mean.radiance.iter().all(|l| (0.0..=20.0).contains(l)),
                        "{mean:?}"
                    );
                }
            }
        }
    }
}

/// Not a limit, but a figure: `cargo test --release --test pictures spans:: -- --nocapture --ignored`.
#[test]
#[ignore = "measures"]
fn long_spans_cost_no_more_than_short_ones() {
    for bins in [10, 100, 1000] {
        let direct = texture(1200, 3, TimeFilter::CubicMeans, FILLS[0]);
        let summed = direct.clone().with_sums();
        let cost = |texture: &TimeTexture| {
            let start = Instant::now();
            let mut sum = 0.0;
            for n in 0..20_000 {
                let from = 0.5 + noise(n);
                let span = [from, from + 0.1 * bins as f64];
                sum += texture
                    .mean_uv(DVec2::new(0.4, noise(n + 9)), span, &Near::default())
                    .radiance[0];
            }
            assert!(sum > 0.0);
            start.elapsed().as_secs_f64() / 20_000.0 * 1e9
        };
        let [one_by_one, by_sums] = [cost(&direct), cost(&summed)];
        println!("{bins} bins: {one_by_one:.0} ns one by one, {by_sums:.0} ns by prefix sums");
    }
}

/// Bins from 1 to 3.9 of widths 0.1 to 0.8, with black ends, that hold `energy(from, to)`.
fn uneven(filter: TimeFilter, energy: impl Fn(f64, f64) -> f64) -> TimeTexture {
    const EDGES: [f64; 9] = [1.0, 1.1, 1.4, 1.5, 2.3, 2.4, 3.0, 3.7, 3.9];
    let samples = EDGES.windows(2).map(|bin| energy(bin[0], bin[1])).collect();
    let cube = Cube::new([1, 1, 8, 1], CubeSamples::F64(samples)).unwrap();
    let axis = TimeAxis {
        bins: TimeBins::Edges(EDGES.into()),
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
    TimeTexture::new(cube, axis, outside).unwrap().with_sums()
}

#[test]
fn means_over_bins_of_different_widths_are_those_of_their_light() {
    let mean = |texture: &TimeTexture, span| {
        let sampled = texture.mean_uv(DVec2::new(0.5, 0.5), span, &Near::default());
        (sampled.radiance[0], sampled.coverage)
    };
    // Of the quadratic 2 − 3t + 0.7t², by its antiderivative; filters by centres see its mean as the value at the centre.
    let integral = |t: f64| 2.0 * t - 1.5 * t * t + 0.7 / 3.0 * t * t * t;
    let quadratic = |t: f64| 2.0 - 3.0 * t + 0.7 * t * t;
    let by_means = uneven(TimeFilter::CubicMeans, |from, to| {
        integral(to) - integral(from)
    });
    let by_centres = uneven(TimeFilter::Cubic, |from, to| {
        (to - from) * quadratic(0.5 * (from + to))
    });
    let line = |t: f64| 5.0 * t - 0.5 * t * t;
    let linear = uneven(TimeFilter::Linear, |from, to| line(to) - line(from));
    // As far inside as no filter reads beyond the ends; and all of one bin, a part of one, one time.
    for span in [[1.6, 2.2], [1.9, 1.91], [1.45, 2.65], [2.0, 2.0 + 1e-9]] {
        let of = |f: &dyn Fn(f64) -> f64| (f(span[1]) - f(span[0])) / (span[1] - span[0]);
        let tolerated = 1e-11 + 1e-15 / (span[1] - span[0]);
        for texture in [&by_means, &by_centres] {
            let error = mean(texture, span).0 - of(&integral);
            assert!(error.abs() < tolerated, "{span:?}: {error:e}");
        }
        let error = mean(&linear, span).0 - of(&line);
        assert!(error.abs() < tolerated, "{span:?}: {error:e}");
    }
    assert!((mean(&linear, [2.0, 2.0]).0 - 3.0).abs() < 1e-12);
    // The nearest filter: all of the light of bins within, and parts of the others.
    let nearest = uneven(TimeFilter::Nearest, |from, to| from + 10.0 * to);
    let energy = |from: f64, to: f64| from + 10.0 * to;
    let whole = energy(1.1, 1.4) + energy(1.4, 1.5) + energy(1.5, 2.3);
    let (found, coverage) = mean(&nearest, [0.4, 2.35]);
    let expected = (energy(1.0, 1.1) + whole + 0.5 * energy(2.3, 2.4)) / 1.95;
    assert!((found / expected - 1.0).abs() < 1e-13, "{found} {expected}");
    assert!((coverage.before - 0.6 / 1.95).abs() < 1e-13 && coverage.after == 0.0);
    let (found, _) = mean(&nearest, [1.1, 2.3]);
    assert!((found / (whole / 1.2) - 1.0).abs() < 1e-13);
}
