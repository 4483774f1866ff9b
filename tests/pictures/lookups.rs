//! Batches of lookups against single ones.

use glam::DVec2;
use nullray::io::cube::{Cube, CubeSamples};
use nullray::light::time_texture::{BATCH, Coverage, Lookups, TimeAxis, TimeTexture};
use nullray::scene::model::{BinValues, Fill, Outside, TimeBins, TimeFilter};

/// A texture of 3 × 5 texels and 9 bins.
fn texture(samples: CubeSamples, filter: TimeFilter) -> TimeTexture {
    let channels = samples.len() / (3 * 5 * 9);
    let cube = Cube::new([3, 5, 9, channels], samples).unwrap();
    let axis = TimeAxis {
        bins: TimeBins::Uniform {
            start: -0.3,
            width: 0.21,
        },
        values: BinValues::PerBin,
        filter,
        scale: 1.7,
    };
    let outside = Outside {
        before: Fill::Hold,
        after: Fill::Black,
        off_texture: Fill::Mark([1.0, 0.0, 1.0]),
        occluded: Fill::Black,
    };
    TimeTexture::new(cube, axis, outside).unwrap()
}

/// Values with many digits, of both signs.
fn values(count: usize) -> Vec<f64> {
    let value = |i: usize| libm::sin(i as f64 * 1.234) * 3.0;
    (0..count).map(value).collect()
}

fn cubes() -> Vec<CubeSamples> {
    let sizes = [3 * 5 * 9, 3 * 5 * 9 * 3];
    let half = |x: &f64| half::f16::from_f64(*x);
    let cubes = sizes.map(|n| {
        let values = values(n);
        [
            CubeSamples::F16(values.iter().map(half).collect()),
            CubeSamples::F32(values.iter().map(|x| *x as f32).collect()),
            CubeSamples::F64(values),
        ]
    });
    cubes.into_iter().flatten().collect()
}

#[test]
fn a_batch_of_lookups_is_as_many_single_ones_bit_for_bit() {
    let filters = [
        TimeFilter::Nearest,
        TimeFilter::Linear,
        TimeFilter::Cubic,
        TimeFilter::CubicMeans,
    ];
    for (filter, samples) in filters
        .into_iter()
        .flat_map(|f| cubes().into_iter().map(move |c| (f, c)))
    {
        let texture = texture(samples, filter);
        let mut lookups = Lookups::default();
        for i in 0..BATCH {
            let x = i as f64;
            lookups.u[i] = 0.5 + 0.53 * libm::sin(x);
            lookups.v[i] = if i == 77 {
                f64::NAN
            } else {
                0.5 + 0.51 * libm::cos(1.7 * x)
            };
            lookups.t[i] = 0.645 + libm::sin(2.9 * x);
        }
        texture.sample_each(&mut lookups, BATCH);
        for i in 0..BATCH {
            let uv = DVec2::new(lookups.u[i], lookups.v[i]);
            let single = texture.sample_uv(uv, lookups.t[i]);
            let other = lookups.others.iter().find(|(at, _)| *at == i);
            let bits = |rgb: [f64; 3]| rgb.map(f64::to_bits);
            let [r, g, b, _] = lookups.radiance[i];
            assert_eq!(bits([r, g, b]), bits(single.radiance), "{filter:?} {i}");
            match other {
                Some((_, sampled)) => assert_eq!(*sampled, single),
                None => assert_eq!(single.coverage, Coverage::HELD),
            }
        }
        let plain = BATCH - lookups.others.len();
        assert!(
            (30..220).contains(&plain),
            "{filter:?}: {plain} plain lookups"
        );
    }
}

#[test]
fn a_table_of_edges_of_equal_bins_reads_as_a_width_does() {
    let edges: Vec<f64> = (0..=9).map(|k| -0.3 + 0.21 * f64::from(k)).collect();
    for filter in [
        TimeFilter::Nearest,
        TimeFilter::Linear,
        TimeFilter::Cubic,
        TimeFilter::CubicMeans,
    ] {
        let uniform = texture(cubes().remove(5), filter);
        let axis = TimeAxis {
            bins: TimeBins::Edges(edges.as_slice().into()),
            ..uniform.axis().clone()
        };
        let outside = Outside {
            before: Fill::Hold,
            after: Fill::Black,
            off_texture: Fill::Mark([1.0, 0.0, 1.0]),
            occluded: Fill::Black,
        };
        let table = TimeTexture::new(uniform.cube().clone(), axis, outside).unwrap();
        let mut lookups = Lookups::default();
        for i in 0..BATCH {
            (lookups.u[i], lookups.v[i]) = (0.4, 0.003 * i as f64);
            // From before the data to after them, clear of the borders that nearest tells apart.
            lookups.t[i] = -0.7 + 0.011003 * i as f64;
        }
        table.sample_each(&mut lookups, BATCH);
        for (i, sampled) in &lookups.others {
            let uv = DVec2::new(lookups.u[*i], lookups.v[*i]);
            let expected = uniform.sample_uv(uv, lookups.t[*i]);
            assert_eq!(sampled.coverage, expected.coverage, "{i}");
            for (a, b) in sampled.radiance.iter().zip(expected.radiance) {
                assert!(
                    (a - b).abs() < 1e-12 * 40.0,
                    "{filter:?} {i}: {a} is not {b}"
                );
            }
        }
        assert_eq!(lookups.others.len(), BATCH);
    }
}
