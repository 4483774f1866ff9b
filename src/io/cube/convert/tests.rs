//! Conversion part by part against that of the whole.

use super::*;
use crate::io::cube::{Cube, CubeSamples, load};

/// (5, 4, 7, 1), written and read back part by part, with bins that pixels shift by different numbers of bins.
#[test]
fn parts_of_all_orders_are_as_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let value = |pixel: usize, bin: i64| match bin {
        0..7 => libm::sin((pixel * 7) as f64 + bin as f64),
        _ => 0.0,
    };
    let samples = (0..140).map(|n| value(n / 7, (n % 7) as i64)).collect();
    let cube = Cube::new([5, 4, 7, 1], CubeSamples::F64(samples)).unwrap();
    npz::write_cube(&path("a.npy"), &cube).unwrap();
    let shift: Vec<f64> = (0..20).map(|pixel| 0.25 * f64::from(pixel) - 2.0).collect();
    for (axes, merge) in [("H W T C", 1), ("T H W", 1), ("T W H C", 3), ("H C T W", 2)] {
        let axes: Axes = axes.parse().unwrap();
        let changes = Changes {
            rows: Some(1..4),
            merge,
            shift: Some(shift.clone()),
            axes: Some(axes.clone()),
            ..Changes::default()
        };
        let (to, whole) = (path("b.npz"), Wanted::default());
        let converted = convert((&path("a.npy"), whole), &to, &changes, &mut |_, _| true).unwrap();
        // Rows 1 to 3 are shifted by −1 to 1.75: one bin more makes them 0 to 2.75.
        assert_eq!(
            (converted.later, converted.shape[2]),
            (-1.0, 10usize.div_ceil(merge))
        );
        let wanted = Wanted {
            axes: Some(&axes),
            ..whole
        };
        let written = load(&to, wanted).unwrap();
        for (pixel, bin) in
            (0..12).flat_map(|pixel| (0..converted.shape[2]).map(move |bin| (pixel, bin)))
        {
            let moved = shift[pixel + 4] + 1.0;
            let (i, f) = (moved.floor() as i64, moved - moved.floor());
            let fine = (bin * merge) as i64..((bin + 1) * merge) as i64;
            let expected: f64 = fine
                .map(|j| (1.0 - f) * value(pixel + 4, j - i) + f * value(pixel + 4, j - i - 1))
                .sum();
            assert!(
                (written.total(pixel, bin) - expected).abs() < 1e-14,
                "{axes} {pixel} {bin}"
            );
        }
    }
    let stopped = convert(
        (&path("a.npy"), Wanted::default()),
        &path("c.npy"),
        &Changes::default(),
        &mut |_, _| false,
    );
    assert!(matches!(stopped, Err(Error::Cancelled)) && !path("c.npy").exists());
}
