//! Rasterizers converge to the ray tracer at the rate of curved edges: second order in their length.

use nullray::render::aov::Aov;

use super::stage::{
    BODIES, camera, centred, different, errors, film, scene, scene_file, values, worst,
};

const FAST: &str = "velocity = { beta = [0.1, -0.3, -0.85] }";

fn root_mean_square(numbers: &[f64]) -> f64 {
    (numbers.iter().map(|x| x * x).sum::<f64>() / numbers.len() as f64).sqrt()
}

#[test]
fn errors_are_of_second_order_in_the_edge_length() {
    let stage = centred(&scene(&(camera(FAST) + BODIES)));
    let error = |method: &str| root_mean_square(&errors(&stage, &film(&stage, method)));
    // Lengths that cut the edges of the floor (6 m, 6 √2 m) into 2ⁿ and 1.5 · 2ⁿ parts.
    let lengths = [0.375, 0.1875, 0.09375, 0.046875];
    let found = lengths.map(|length| error(&format!("raster:uniform={length}")));
    for pair in found.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.8..2.2).contains(&order), "{found:?}: order {order}");
    }
}

#[test]
fn interpolated_times_and_ratios_are_of_second_order_too() {
    let stage = centred(&scene(&(camera(FAST) + BODIES)));
    let traced = film(&stage, "trace");
    for aov in [Aov::EventCt, Aov::WavelengthRatio] {
        let error = |length: f64| {
            let drawn = film(
                &stage,
                &format!("raster:uniform={length},attributes=vertex"),
            );
            let apart = different(&traced, &drawn);
            let (a, b) = (values(&traced, aov), values(&drawn, aov));
            let same = (0..a.len()).filter(|i| a[*i].is_finite() && !apart.contains(i));
            root_mean_square(&same.map(|i| a[i] - b[i]).collect::<Vec<_>>())
        };
        let found = [0.1875, 0.09375, 0.046875].map(error);
        for pair in found.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!(
                (1.7..2.3).contains(&order),
                "{aov:?} {found:?}: order {order}"
            );
        }
    }
}

#[test]
fn by_fragment_the_wavelength_ratio_is_that_of_the_ray_tracer_on_flat_triangles_too() {
    let stage = centred(&scene(&(camera(FAST) + BODIES)));
    let (traced, drawn) = (film(&stage, "trace"), film(&stage, "raster:none"));
    let (a, b) = (
        values(&traced, Aov::WavelengthRatio),
        values(&drawn, Aov::WavelengthRatio),
    );
    let both = (0..a.len()).filter(|i| a[*i].is_finite() && b[*i].is_finite());
    let worst = both.map(|i| (a[i] / b[i] - 1.0).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-12, "{worst:e}");
}

#[test]
fn bodies_at_different_velocities_come_to_look_as_the_ray_tracer_sees_them() {
    let stage = centred(&scene_file("several-velocities.toml", [160, 100]));
    let traced = film(&stage, "trace");
    let coarse = different(&traced, &film(&stage, "raster:none")).len();
    let fine = film(&stage, "raster:adaptive=0.002");
    let apart = different(&traced, &fine);
    // Triangles of the balls are smaller than a pixel: some edges pass close to a centre.
    assert!(
        apart.len() < 30 && coarse > 5 * apart.len(),
        "{coarse} {}",
        apart.len()
    );
    for i in (0..traced.radiance().len()).filter(|i| !apart.contains(i)) {
        let (a, b) = (traced.radiance()[i][1], fine.radiance()[i][1]);
        assert!((a - b).abs() < 0.01 * a.max(1e-3), "pixel {i}: {a} {b}");
    }
}

#[test]
fn a_flat_triangle_at_nine_tenths_of_light_is_far_off() {
    let stage = centred(&scene(&(camera(FAST) + BODIES)));
    let flat = worst(&stage, "raster:none");
    assert!(flat > 5.0, "{flat}");
}

#[test]
fn no_cracks_open_between_triangles_that_are_cut() {
    let ball = "[[object]]\nshape = { sphere = { radius = 1.2, subdivisions = 1 } }\n\
                velocity = { beta = [0.9, 0, 0] }\norigin = { position = [-0.4, 0.6, 0], time = \"-4 m\" }\n";
    let stage = centred(&scene(&(camera("") + ball)));
    for method in [
        "raster:adaptive=0.3",
        "raster:uniform=0.2",
        "raster:uniform=0.07",
    ] {
        let drawn = film(&stage, method);
        let seen = values(&drawn, Aov::Object);
        assert!(seen.iter().filter(|o| **o >= 0.0).count() > 500);
        let (columns, rows) = (120, 90);
        let around = |i: usize| [i - 1, i + 1, i - columns, i + columns];
        let inner = (columns..columns * (rows - 1)).filter(|i| !matches!(i % columns, 0 | 119));
        let cracks: Vec<_> = inner
            .filter(|i| seen[*i] < 0.0 && around(*i).iter().all(|j| seen[*j] >= 0.0))
            .collect();
        assert!(cracks.is_empty(), "{method}: {cracks:?}");
    }
}
