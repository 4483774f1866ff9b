//! Samples that are rasterized together, and hits with no more data than radiance needs.

use nullray::render::aov::{self, Aov};
use nullray::render::film::Film;
use nullray::render::plan::Request;

use super::stage::{BODIES, film, prepared, scene};

/// Three bodies on a floor, in a picture whose tiles on the right and below are narrow.
fn small(more: &str) -> String {
    let camera = "[camera]\neye = [0.3, 1.4, 3.4]\nlook_at = [0, 0.5, 0]\nhfov = \"70 deg\"\nsize = [37, 21]\n";
    let balls = [(-0.9, "[0.9, 0.1, 0.2]"), (0.8, "[0.1, 0.3, 0.9]")].map(|(x, colour)| {
        format!(
            "[[object]]\nname = \"ball {x}\"\ncolour = {colour}\n\
             shape = {{ sphere = {{ radius = 0.4, subdivisions = 3 }} }}\ntransform = {{ translate = [{x}, 0.5, 0.8] }}\n"
        )
    });
    format!("{more}\n{camera}{BODIES}{}", balls.concat())
}

/// How far the radiance of two films is apart, as a part of the greatest.
fn apart(a: &Film, b: &Film) -> f64 {
    let all = |film: &Film| film.radiance().concat();
    let (a, b) = (all(a), all(b));
    let greatest = a.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    assert!(greatest > 0.0);
    let differences = a.iter().zip(&b).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max) / greatest
}

#[test]
fn samples_that_are_rasterized_together_are_those_of_the_ray_tracer() {
    // Less than a strip of rows, a row, a row and one more, and several.
    for samples in [1, 2, 3, 5, 16, 17, 40] {
        let text = small(&format!("[display]\nsamples_per_pixel = {samples}"));
        let stage = prepared(&scene(&text), &Request::default());
        let (traced, drawn) = (film(&stage, "trace"), film(&stage, "raster:none"));
        let all = traced.radiance().iter().zip(drawn.radiance());
        let other = all.filter(|(a, b)| a != b).count();
        // Bit for bit, but where a sample lies on an edge.
        assert!(other <= 2, "{samples} samples: {other} pixels");
        assert_eq!(traced.met(), drawn.met());
    }
}

#[test]
fn parts_of_the_standard_error_end_between_samples_that_go_together() {
    let text = small("[display]\nsamples_per_pixel = 24");
    let request = Request {
        aovs: aov::parse("standard_error").unwrap(),
        ..Request::default()
    };
    let stage = prepared(&scene(&text), &request);
    let (traced, drawn) = (film(&stage, "trace"), film(&stage, "raster:none"));
    let channel = Aov::StandardError;
    let errors = traced.aov(channel).unwrap().iter();
    let all = errors.zip(drawn.aov(channel).unwrap());
    let other = all.filter(|(a, b)| a != b).count();
    // A pixel counts in the errors of 5 × 5.
    assert!(other <= 2 * 25, "{other} pixels");
    assert!(traced.aov(channel).unwrap().iter().any(|e| *e > 0.0));
}

#[test]
fn radiance_is_the_same_whether_channels_ask_for_more_of_the_hits_or_not() {
    let moving = "name = \"crate\"\nvelocity = { beta = [0.6, 0, 0.2] }";
    let lamp = "[[source]]\nname = \"lamp\"\n\
                pulse = { position = [1, 3, 2], time = \"0 m\", sigma = \"9 m\", intensity = 20.0 }\n";
    let plain = small("[display]\nsamples_per_pixel = 5");
    let lit = format!("{plain}{lamp}");
    let scenes = [plain, lit].map(|text| [text.replace("name = \"crate\"", moving), text]);
    for text in scenes.as_flattened() {
        let scene = scene(text);
        let few = prepared(&scene, &Request::default());
        let request = Request {
            aovs: vec![Aov::Distance],
            ..Request::default()
        };
        let many = prepared(&scene, &request);
        for method in ["raster:none", "raster:adaptive=0.1"] {
            // W may go through one product and one quotient more.
            let apart = apart(&film(&few, method), &film(&many, method));
            assert!(apart < 1e-14, "{method}: {apart}");
        }
    }
}

#[test]
fn a_sky_behind_rasterized_bodies_is_that_behind_traced_ones() {
    let sky = "[display]\nsamples_per_pixel = 3\n[sky]\ngradient = { zenith = [0.1, 0.2, 0.9], horizon = [0.9, 0.8, 0.7] }\nlights = false";
    let stage = prepared(&scene(&small(sky)), &Request::default());
    let (traced, drawn) = (film(&stage, "trace"), film(&stage, "raster:none"));
    let all = traced.radiance().iter().zip(drawn.radiance());
    assert!(all.filter(|(a, b)| a != b).count() <= 2);
}
