//! Warps: exact except for the directions between texels.

use nullray::render::aov::Aov;
use nullray::render::film::Film;

use super::stage::{BODIES, camera, centred, errors, film, scene, values};

const FAST: &str = "velocity = { beta = [0.1, -0.3, -0.6] }";

#[test]
fn errors_of_the_nearest_texel_are_of_first_order() {
    let stage = centred(&scene(&(camera(FAST) + BODIES)));
    for kind in ["cube=", "panorama="] {
        let error = |n: u32| {
            let map = match kind {
                "cube=" => format!("{n}"),
                _ => format!("{}x{}", 4 * n, 2 * n),
            };
            let all = errors(
                &stage,
                &film(&stage, &format!("warp:{kind}{map},lookup=nearest")),
            );
            (all.iter().map(|e| e * e).sum::<f64>() / all.len() as f64).sqrt()
        };
        let found = [128, 256, 512].map(error);
        for pair in found.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((0.85..1.15).contains(&order), "{kind} {found:?}");
        }
    }
}

#[test]
fn a_texel_is_off_by_at_most_half_its_diagonal_as_aberration_shows_it() {
    // At rest, 70° across 120 pixels: 85.7 pixels per radian in the centre, and 2/512 radians per texel at most.
    let stage = centred(&scene(&(camera("") + BODIES)));
    let all = errors(&stage, &film(&stage, "warp:cube=512,lookup=nearest"));
    let worst = all.iter().fold(0.0, |a: f64, b| a.max(*b));
    let density = 85.7 * (1.0 + 0.7f64.powi(2) * (1.0 + 0.5625));
    assert!(
        worst < density * (2.0 / 512.0) * 0.5 * 2f64.sqrt(),
        "{worst}"
    );
    assert!(worst > 0.1, "{worst}");
}

#[test]
fn wavelength_ratios_are_exact_and_times_nearly_so() {
    let stage = centred(&scene(&(camera(FAST) + BODIES)));
    let (traced, warped) = (film(&stage, "trace"), film(&stage, "warp:cube=1024"));
    let same = |aov: Aov, tolerance: f64| {
        let (a, b, object) = (
            values(&traced, aov),
            values(&warped, aov),
            values(&traced, Aov::Object),
        );
        let off = (0..a.len())
            .filter(|i| object[*i] >= 0.0 && ((a[*i] - b[*i]).abs() > tolerance || b[*i].is_nan()));
        off.count()
    };
    let seen = values(&traced, Aov::Object)
        .iter()
        .filter(|o| **o >= 0.0)
        .count();
    // Outlines move by part of a pixel.
    assert!(same(Aov::WavelengthRatio, 1e-12) < seen / 200);
    assert!(same(Aov::EventCt, 0.1) < seen / 200);
}

#[test]
fn a_moving_camera_sees_the_sky_of_a_warp_shifted_like_the_traced_one() {
    let fast = camera("velocity = { beta = [0, 0, -0.5] }");
    // Pixels of sky, away from outlines.
    let object = values(
        &film(&centred(&scene(&(fast.clone() + BODIES))), "trace"),
        Aov::Object,
    )
    .to_vec();
    let is_sky = |x: i64, y: i64| object[(x + 120 * y) as usize] < 0.0;
    let around = |x: i64, y: i64| (-3..=3).all(|v| (-3..=3).all(|u| is_sky(x + u, y + v)));
    let sky: Vec<usize> = (3..87i64)
        .flat_map(|y| (3..117i64).map(move |x| (x, y)))
        .filter(|(x, y)| around(*x, *y))
        .map(|(x, y)| (x + 120 * y) as usize)
        .collect();
    assert!(sky.len() > 1000, "{}", sky.len());
    let rgb = "[radiance]\nquantity = \"rgb\"\n";
    let lamp = "[[light]]\nposition = [0, 3, 0]\n";
    // Those that are the same in all directions have no error of texels, the others one of their sum.
    for (text, tolerance) in [
        ("[sky]\nradiance = [1, 0.5, 0.2]\n".to_string(), 1e-9),
        (format!("[sky]\nradiance = [1, 0.5, 0.2]\n{rgb}"), 1e-3),
        (
            format!("[sky]\nspectrum = {{ blackbody = \"4000 K\" }}\n{rgb}"),
            1e-3,
        ),
        ("[sky]\ngradient = {}\n".into(), 1e-2),
        (
            "[sky]\nradiance = 0\nsun = { direction = [0, 0.3, -1], diameter = \"8 deg\" }\n"
                .into(),
            5e-2,
        ),
        (
            "[sky]\nradiance = 0\nstars = { count = 2000 }\n".into(),
            5e-2,
        ),
        // As observed, whatever moves.
        (
            format!("[display]\nbackground = [1, 0.5, 0.2]\n{lamp}"),
            1e-12,
        ),
    ] {
        let stage = centred(&scene(&(fast.clone() + BODIES + &text)));
        let [traced, warped] = ["trace", "warp:cube=512"].map(|method| film(&stage, method));
        for film in [&traced, &warped] {
            let ratios = values(film, Aov::WavelengthRatio);
            assert!(sky.iter().all(|i| ratios[*i].is_nan()), "{text}");
        }
        for c in 0..3 {
            let at = |film: &Film, i: &usize| film.radiance()[*i][c];
            let [a, b] =
                [&traced, &warped].map(|film| sky.iter().map(|i| at(film, i)).sum::<f64>());
            assert!((a - b).abs() <= tolerance * a, "{text}: {a}, {b}");
            // Pixel by pixel where texels make no error.
            let near =
                |i: &usize| (at(&traced, i) - at(&warped, i)).abs() <= tolerance * at(&traced, i);
            assert!(tolerance > 2e-3 || sky.iter().all(near), "{text}");
        }
    }
}

#[test]
fn bilinear_lookup_of_a_smooth_radiance_is_of_second_order() {
    let lamp = "[[source]]\nname = \"lamp\"\npulse = { position = [1, 2.5, 2], time = \"0 m\", sigma = \"50 m\", intensity = 10, shadows = false }\n";
    let floor = BODIES.split("[[object]]").nth(1).unwrap();
    let text = format!("{}[[object]]{floor}{lamp}", camera(FAST));
    let stage = centred(&scene(&text));
    let traced = film(&stage, "trace");
    let object = values(&traced, Aov::Object);
    // Away from the floor's outline.
    let inner: Vec<_> = (3 * 120..87 * 120)
        .filter(|i| (3..117).contains(&(i % 120)))
        .filter(|i| {
            (-3i64..=3)
                .all(|y| (-3i64..=3).all(|x| object[(*i as i64 + 120 * y + x) as usize] >= 0.0))
        })
        .collect();
    assert!(inner.len() > 500);
    let error = |n: u32| {
        let warped = film(&stage, &format!("warp:cube={n}"));
        let off = inner
            .iter()
            .map(|i| (traced.radiance()[*i][0] - warped.radiance()[*i][0]).powi(2));
        (off.sum::<f64>() / inner.len() as f64).sqrt()
    };
    let found = [128, 256, 512].map(error);
    for pair in found.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.6..2.4).contains(&order), "{found:?}");
    }
}
