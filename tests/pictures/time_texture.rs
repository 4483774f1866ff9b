//! Lookups by texture coordinates, against closed forms.

use glam::DVec2;
use nullray::io::cube::{Cube, CubeError, CubeSamples};
use nullray::light::time_texture::{Coverage, TimeAxis, TimeTexture};
use nullray::scene::model::{BinValues, Fill, Outside, TimeBins, TimeFilter};
use proptest::prelude::*;

const MARK: Fill = Fill::Mark([0.25, 0.5, 4.0]);
const THROUGH_CENTRES: [TimeFilter; 3] =
    [TimeFilter::Nearest, TimeFilter::Linear, TimeFilter::Cubic];
const FILTERS: [TimeFilter; 4] = [
    TimeFilter::Nearest,
    TimeFilter::Linear,
    TimeFilter::Cubic,
    TimeFilter::CubicMeans,
];

pub fn everywhere(fill: Fill) -> Outside {
    Outside {
        before: fill,
        after: fill,
        off_texture: fill,
        occluded: fill,
    }
}

fn axis(filter: TimeFilter) -> TimeAxis {
    TimeAxis {
        bins: TimeBins::Uniform {
            start: 7.0,
            width: 0.25,
        },
        values: BinValues::Density,
        filter,
        scale: 1.0,
    }
}

/// Time in bins from the centre of bin 0, for the axis above.
fn x(t: f64) -> f64 {
    (t - 7.0) / 0.25 - 0.5
}

/// One texel whose bin k holds `value(k)`.
fn column(bins: usize, filter: TimeFilter, fill: Fill, value: impl Fn(f64) -> f64) -> TimeTexture {
    let samples = CubeSamples::F64((0..bins).map(|k| value(k as f64)).collect());
    let cube = Cube::new([1, 1, bins, 1], samples).unwrap();
    TimeTexture::new(cube, axis(filter), everywhere(fill)).unwrap()
}

fn at(texture: &TimeTexture, t: f64) -> f64 {
    texture.sample_uv(DVec2::splat(0.5), t).radiance[0]
}

fn close(a: f64, b: f64, tolerance: f64) {
    assert!(
        (a - b).abs() <= tolerance,
        "{a} is not {b} within {tolerance}"
    );
}

#[test]
fn linear_reproduces_polynomials_of_degree_one() {
    let f = |x: f64| 3.0 - 2.0 * x;
    let texture = column(20, TimeFilter::Linear, Fill::Black, f);
    for i in 0..=190 {
        let t = 7.125 + 0.025 * i as f64;
        close(at(&texture, t), f(x(t)), 1e-12);
    }
}

#[test]
fn cubic_reproduces_quadratics_and_misses_a_cube_by_the_closed_form() {
    // Hermite form with the tangent ((k+1)³ − (k−1)³)/2 = 3k² + 1: too steep by 1 at both ends, so
    // the error is h₁₀ + h₁₁ = f(1 − f)(1 − 2f).
    let f = |x: f64| 1.0 - x + 0.5 * x * x + 2.0 * x * x * x;
    let texture = column(20, TimeFilter::Cubic, Fill::Black, f);
    for i in 0..=170 {
        let t = 7.375 + 0.025 * i as f64;
        let u = x(t);
        let fraction = u - (u + 1e-9).floor();
        let error = 2.0 * fraction * (1.0 - fraction) * (1.0 - 2.0 * fraction);
        close(at(&texture, t), f(u) + error, 1e-7);
    }
    let quadratic = column(20, TimeFilter::Cubic, Fill::Black, |x| 4.0 - x + x * x);
    close(at(&quadratic, 9.1), 4.0 - x(9.1) + x(9.1) * x(9.1), 1e-12);
}

#[test]
fn cubic_from_means_reproduces_a_quadratic_from_its_bin_means() {
    // The mean of x² over [k − ½, k + ½] is k² + 1/12.
    let f = |x: f64| 1.0 - x + 3.0 * x * x;
    let texture = column(20, TimeFilter::CubicMeans, Fill::Black, |k| {
        f(k) + 3.0 / 12.0
    });
    let uncorrected = column(20, TimeFilter::Cubic, Fill::Black, |k| f(k) + 3.0 / 12.0);
    for i in 0..=150 {
        let t = 7.625 + 0.025 * i as f64;
        close(at(&texture, t), f(x(t)), 1e-11);
        close(at(&uncorrected, t), f(x(t)) + 3.0 / 12.0, 1e-11);
    }
}

#[test]
fn nearest_gives_the_bin_that_contains_the_time() {
    let texture = column(4, TimeFilter::Nearest, Fill::Black, |k| 10.0 + k);
    for (t, value) in [
        (7.0, 10.0),
        (7.249, 10.0),
        (7.25, 11.0),
        (7.74, 12.0),
        (7.76, 13.0),
        (8.0, 13.0),
    ] {
        assert_eq!(at(&texture, t), value, "at {t}");
    }
}

#[test]
fn bin_centres_give_the_stored_values() {
    for filter in THROUGH_CENTRES {
        let texture = column(6, filter, Fill::Black, |k| (k * k) - 7.0);
        for k in 0..6 {
            let k = k as f64;
            close(at(&texture, 7.125 + 0.25 * k), k * k - 7.0, 1e-12);
        }
    }
}

#[test]
fn per_bin_energies_are_divided_by_the_bin_width_and_scaled() {
    let cube = Cube::new([1, 1, 1, 1], CubeSamples::F32(vec![0.5])).unwrap();
    let per_bin = TimeAxis {
        values: BinValues::PerBin,
        scale: 3.0,
        ..axis(TimeFilter::Nearest)
    };
    let texture = TimeTexture::new(cube, per_bin, everywhere(Fill::Black)).unwrap();
    assert_eq!(at(&texture, 7.1), 6.0); // 3 · 0.5 / 0.25
    assert_eq!(texture.span(), [7.0, 7.25]);
}

#[test]
fn at_the_ends_the_filter_sees_zero_beyond_black_and_the_end_value_beyond_hold() {
    for (filter, weight) in [
        (TimeFilter::Linear, 0.5),
        (TimeFilter::Cubic, 0.5 + 1.0 / 16.0),
    ] {
        // At the very end half of the linear weight, and 9/16 of the cubic one, is on the only bin.
        let black = column(1, filter, Fill::Black, |_| 8.0);
        close(at(&black, 7.0), 8.0 * weight, 1e-12);
        close(at(&black, 7.25), 8.0 * weight, 1e-12);
        for fill in [Fill::Hold, MARK] {
            close(at(&column(1, filter, fill, |_| 8.0), 7.0), 8.0, 1e-12);
        }
    }
    // Cubic at the start of (v₀, v₁, …): −1/16, 9/16, 9/16, −1/16 on v₀, v₀, v₀, v₁ when held.
    let held = column(3, TimeFilter::Cubic, Fill::Hold, |k| {
        [16.0, 32.0, 5.0][k as usize]
    });
    close(at(&held, 7.0), 16.0 + (16.0 - 32.0) / 16.0, 1e-12);
}

#[test]
fn a_held_end_joins_without_a_step_and_becomes_the_end_value() {
    for filter in FILTERS {
        let texture = column(5, filter, Fill::Hold, |k| 3.0 + k * k);
        for (end, outwards, value) in [(7.0, -1.0, 3.0), (8.25, 1.0, 19.0)] {
            let outside = at(&texture, end + outwards * 1e-12);
            close(at(&texture, end), outside, 1e-9);
            for distance in [0.6251, 1.0, 1e30, f64::INFINITY] {
                close(at(&texture, end + outwards * distance), value, 1e-12);
            }
        }
    }
}

#[test]
fn each_side_of_time_is_filled_by_its_own_policy() {
    let fills = [Fill::Black, MARK, Fill::Hold];
    for before in fills {
        for after in fills {
            let outside = Outside {
                before,
                after,
                ..everywhere(Fill::Black)
            };
            let cube = Cube::new([1, 1, 2, 1], CubeSamples::F64(vec![3.0, 5.0])).unwrap();
            let texture = TimeTexture::new(cube, axis(TimeFilter::Linear), outside).unwrap();
            for (t, fill, held) in [(6.5, before, 3.0), (8.0, after, 5.0)] {
                let sampled = texture.sample_uv(DVec2::splat(0.5), t);
                let (radiance, unscaled) = filled(fill, held);
                assert_eq!((sampled.radiance, sampled.unscaled), (radiance, unscaled));
                let one = if t < 7.0 {
                    sampled.coverage.before
                } else {
                    sampled.coverage.after
                };
                assert_eq!((one, sampled.coverage.total()), (1.0, 1.0));
            }
        }
    }
}

/// What a lookup without data gives: radiance, and what is not scaled.
pub fn filled(fill: Fill, held: f64) -> ([f64; 3], [f64; 3]) {
    match fill {
        Fill::Black => ([0.0; 3], [0.0; 3]),
        Fill::Mark(colour) => ([0.0; 3], colour),
        Fill::Hold => ([held; 3], [0.0; 3]),
    }
}

#[test]
fn off_the_texture_is_filled_and_held_places_are_clamped() {
    for fill in [Fill::Black, MARK, Fill::Hold] {
        let cube = Cube::new([1, 2, 1, 1], CubeSamples::F64(vec![3.0, 5.0])).unwrap();
        let texture = TimeTexture::new(cube, axis(TimeFilter::Nearest), everywhere(fill)).unwrap();
        for (u, v, held) in [
            (-0.1, 0.5, 3.0),
            (1.1, 0.5, 5.0),
            (1.0, 2.0, 5.0),
            (0.1, f64::NAN, 3.0),
        ] {
            let sampled = texture.sample_uv(DVec2::new(u, v), 7.1);
            assert_eq!((sampled.radiance, sampled.unscaled), filled(fill, held));
            assert_eq!(sampled.coverage, Coverage::OFF_TEXTURE);
        }
    }
}

#[test]
fn a_held_place_at_a_missing_time_is_filled_as_that_time_is() {
    let outside = Outside {
        after: MARK,
        ..everywhere(Fill::Hold)
    };
    let cube = Cube::new([1, 1, 1, 1], CubeSamples::F64(vec![3.0])).unwrap();
    let texture = TimeTexture::new(cube, axis(TimeFilter::Nearest), outside).unwrap();
    let sampled = texture.sample_uv(DVec2::new(2.0, 0.5), 100.0);
    assert_eq!((sampled.radiance, sampled.unscaled), filled(MARK, 0.0));
    assert_eq!(sampled.coverage, Coverage::OFF_TEXTURE);
}

#[test]
fn rows_count_from_the_top_and_bins_and_channels_are_innermost() {
    let (h, w, bins) = (3, 4, 5);
    let value = |i: usize, j: usize, k: usize, c: usize| (1000 * i + 100 * j + 10 * k + c) as f32;
    let mut samples = Vec::new();
    for i in 0..h {
        for j in 0..w {
            for k in 0..bins {
                samples.extend((0..3).map(|c| value(i, j, k, c)));
            }
        }
    }
    let cube = Cube::new([h, w, bins, 3], CubeSamples::F32(samples)).unwrap();
    for filter in THROUGH_CENTRES {
        let texture =
            TimeTexture::new(cube.clone(), axis(filter), everywhere(Fill::Black)).unwrap();
        let sampled = texture.sample_uv(DVec2::new(2.5 / 4.0, 1.5 / 3.0), 7.0 + 3.5 * 0.25);
        for (c, radiance) in sampled.radiance.into_iter().enumerate() {
            close(radiance, f64::from(value(1, 2, 3, c)), 1e-9);
        }
    }
}

#[test]
fn space_and_time_are_interpolated_as_a_product() {
    let f = |x: f64, y: f64, t: f64| (2.0 + x) * (1.0 - 0.5 * y) * (1.0 + 3.0 * t);
    let (h, w, bins) = (4, 5, 6);
    let mut samples = Vec::new();
    for i in 0..h {
        for j in 0..w {
            samples.extend((0..bins).map(|k| f(j as f64 + 0.5, i as f64 + 0.5, k as f64)));
        }
    }
    let cube = Cube::new([h, w, bins, 1], CubeSamples::F64(samples)).unwrap();
    let texture =
        TimeTexture::new(cube, axis(TimeFilter::Linear), everywhere(Fill::Black)).unwrap();
    for (x, y, k) in [(0.5, 0.5, 0.0), (2.2, 1.7, 3.3), (4.49, 3.49, 4.99)] {
        let uv = DVec2::new(x / w as f64, y / h as f64);
        let sampled = texture.sample_uv(uv, 7.125 + 0.25 * k);
        close(sampled.radiance[1], f(x, y, k), 1e-11);
        assert_eq!(sampled.coverage.held, 1.0);
    }
}

#[test]
fn stored_precisions_agree_to_their_own() {
    let values: Vec<f64> = (0..3 * 3 * 9)
        .map(|i| 1.0 + (i as f64 * 0.7).sin())
        .collect();
    let textures = [
        CubeSamples::F64(values.clone()),
        CubeSamples::F32(values.iter().map(|v| *v as f32).collect()),
        CubeSamples::F16(values.iter().map(|v| half::f16::from_f64(*v)).collect()),
    ]
    .map(|samples| {
        let cube = Cube::new([3, 3, 9, 1], samples).unwrap();
        TimeTexture::new(cube, axis(TimeFilter::Cubic), everywhere(Fill::Hold)).unwrap()
    });
    for i in 0..200 {
        let uv = DVec2::new(0.005 * i as f64, 0.5);
        let [exact, single, half] = textures
            .each_ref()
            .map(|t| t.sample_uv(uv, 7.0 + 0.01 * i as f64).radiance[0]);
        close(single, exact, 2.0 * 6.0e-8 * 1.25);
        close(half, exact, 2.0 * 4.9e-4 * 1.25);
    }
}

#[test]
fn a_time_axis_that_cannot_be_meant_is_refused() {
    fn uniform(start: f64, width: f64) -> TimeBins {
        TimeBins::Uniform { start, width }
    }
    let cube = || Cube::new([1, 1, 4, 1], CubeSamples::F64(vec![1.0; 4])).unwrap();
    let refused = |change: fn(&mut TimeAxis)| {
        let mut axis = axis(TimeFilter::Cubic);
        change(&mut axis);
        match TimeTexture::new(cube(), axis, everywhere(Fill::Black)) {
            Err(CubeError::Axis { quantity, .. }) => quantity,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(refused(|a| a.bins = uniform(7.0, 0.0)), "bin width");
    assert_eq!(refused(|a| a.bins = uniform(7.0, -1.0)), "bin width");
    assert_eq!(refused(|a| a.bins = uniform(7.0, f64::NAN)), "bin width");
    assert_eq!(refused(|a| a.bins = uniform(7.0, 5e-324)), "bin width");
    assert_eq!(refused(|a| a.bins = uniform(7.0, 1e308)), "bin width");
    assert_eq!(refused(|a| a.bins = uniform(1e20, 0.25)), "bin width");
    assert_eq!(refused(|a| a.bins = uniform(f64::INFINITY, 0.25)), "start");
    assert_eq!(refused(|a| a.scale = f64::NAN), "scale");
    fn edges(edges: &[f64]) -> TimeBins {
        TimeBins::Edges(edges.into())
    }
    assert_eq!(
        refused(|a| a.bins = edges(&[7.0, 7.1, 7.3, 7.3, 8.0])),
        "bin edge"
    );
    assert_eq!(
        refused(|a| a.bins = edges(&[7.0, 7.1, f64::NAN, 7.3, 8.0])),
        "bin edge"
    );
    let few = TimeAxis {
        bins: edges(&[7.0, 7.1, 7.3, 8.0]),
        ..axis(TimeFilter::Linear)
    };
    let refused = TimeTexture::new(cube(), few, everywhere(Fill::Black)).unwrap_err();
    assert_eq!(refused, CubeError::Edges { edges: 4, bins: 4 });
}

#[test]
fn two_channels_and_a_shape_made_up_by_hand_are_refused() {
    let two = Cube::new([1, 1, 1, 2], CubeSamples::F64(vec![1.0; 2])).unwrap();
    let made_up = Cube {
        shape: [2, 2, 2, 1],
        samples: CubeSamples::F64(vec![1.0; 2]),
    };
    let new = |cube| TimeTexture::new(cube, axis(TimeFilter::Linear), everywhere(Fill::Black));
    assert_eq!(new(two).unwrap_err(), CubeError::Channels(2));
    assert!(matches!(new(made_up), Err(CubeError::Length { .. })));
}

fn any_fill() -> impl Strategy<Value = Fill> {
    prop_oneof![Just(Fill::Black), Just(MARK), Just(Fill::Hold)]
}

/// Near the data mostly, and now and then any number there is.
fn any_number(near: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    prop_oneof![3 => near, 1 => prop::num::f64::ANY]
}

proptest! {
    #[test]
    fn any_lookup_is_finite_and_its_coverage_sums_to_one(
        (u, v, t) in (any_number(-0.2..1.2), any_number(-0.2..1.2), any_number(6.0..9.0)),
        (h, w, bins) in (1usize..4, 1usize..4, 1usize..7),
        filter in prop::sample::select(&FILTERS[..]),
        (before, after, off_texture) in (any_fill(), any_fill(), any_fill()),
    ) {
        let outside = Outside { before, after, off_texture, occluded: Fill::Black };
        let cube = Cube::new([h, w, bins, 1], CubeSamples::F32(vec![1.0; h * w * bins])).unwrap();
        let texture = TimeTexture::new(cube, axis(filter), outside).unwrap();
        let sampled = texture.sample_uv(DVec2::new(u, v), t);
        prop_assert!((sampled.coverage.total() - 1.0).abs() < 1e-14);
        prop_assert!(sampled.radiance.iter().all(|r| (-0.2..1.2).contains(r)));
        let missing = 1.0 - sampled.coverage.held;
        prop_assert!(sampled.unscaled[0] <= 0.25 * missing + 1e-14);
        let fills = [before, after, off_texture];
        if !fills.contains(&Fill::Black) && !fills.contains(&MARK) {
            prop_assert!((sampled.radiance[0] - 1.0).abs() < 1e-14);
        }
    }
}
