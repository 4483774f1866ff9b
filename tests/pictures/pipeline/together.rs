//! Samples that are traced together, and tiles that are rendered alone.

use std::num::NonZeroU32;

use nullray::approximate::raster::{self, Method};
use nullray::render::aov::Aov;
use nullray::render::bake::{self, Baked, Bins, CubePrecision};
use nullray::render::film::{Film, Tile};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::{render, render_tiles};

use super::stage::{on, scene};

/// A camera whose last tiles are smaller, in front of a floor and a wall.
fn corner(samples: u32) -> String {
    format!(
        "[render]\nbounces = 2\n[display]\nsamples_per_pixel = {samples}\nback_faces = \"two_sided\"\n\
         [camera]\neye = [1.4, 1.2, 2]\nlook_at = [0, 0.3, 0]\nhfov = \"50 deg\"\nsize = [37, 21]\n\
         [[object]]\nname = \"floor\"\nshape = {{ box = {{ size = [3, 0.1, 3] }} }}\ncolour = [0.7, 0.7, 0.6]\n\
         [[object]]\nname = \"wall\"\nshape = {{ box = {{ size = [3, 3, 0.1] }} }}\ncolour = [0.8, 0.2, 0.1]\n\
         transform = {{ translate = [0, 1, -1] }}\n"
    )
}

/// A box of this finish in the corner, lit by a panel, with 7 samples.
fn boxed(finish: &str) -> Prepared {
    let text = format!(
        "{}[[object]]\nname = \"box\"\nshape = {{ box = {{ size = [0.5, 0.8, 0.5] }} }}\n{finish}\n\
         transform = {{ translate = [0, 0.4, 0], rotate = {{ axis = [0, 1, 0], angle = \"30 deg\" }} }}\n\
         [[object]]\nname = \"panel\"\nshape = {{ plane = {{ size = [0.6, 0.6] }} }}\n\
         transform = {{ translate = [0, 2, 0], rotate = {{ axis = [1, 0, 0], angle = \"180 deg\" }} }}\n\
         [[light]]\ntype = \"area\"\nobject = \"panel\"\nradiance = [6, 5, 4]\n",
        corner(7)
    );
    let request = Request {
        aovs: vec![Aov::Distance, Aov::Object],
        ..Request::default()
    };
    let scene = scene(&text);
    Prepared::new(&scene, &Plan::new(&scene, &request).unwrap(), &Silent).unwrap()
}

/// The film of `scene`, rendered `at_once` samples at a time.
fn film(scene: &mut Prepared, at_once: u32) -> Film {
    scene.samples_at_once = NonZeroU32::new(at_once);
    render(scene, &Silent).unwrap()
}

/// Bits of a channel: distances are NaN if nothing is hit.
fn bits(film: &Film, channel: Aov) -> Vec<u64> {
    let all = film.aov(channel).unwrap().iter();
    all.map(|x| x.to_bits()).collect()
}

/// The random numbers are the same, but a pixel's sum has another order if its samples hit several surfaces.
#[test]
fn samples_that_are_shaded_together_are_those_that_are_shaded_one_by_one() {
    for finish in ["colour = [0.2, 0.6, 0.3]", "metallic = 1\nroughness = 0.3"] {
        let mut scene = boxed(finish);
        let alone = film(&mut scene, 1);
        for at_once in [2, 4, 7] {
            let together = film(&mut scene, at_once);
            let all = together.radiance().iter().zip(alone.radiance());
            for (pixel, (a, b)) in all.enumerate() {
                for (a, b) in a.iter().zip(b) {
                    assert!(
                        (a - b).abs() <= 1e-13 * b,
                        "{finish}, {at_once}, {pixel}: {a} {b}"
                    );
                }
            }
            for channel in [Aov::Distance, Aov::Object] {
                assert_eq!(bits(&together, channel), bits(&alone, channel), "{at_once}");
            }
            assert_eq!(together.met(), alone.met());
            // They were summed in another order.
            assert_ne!(together.radiance(), alone.radiance(), "{at_once}");
        }
    }
}

/// The random numbers are the same, but the sums of a bin are in another order.
#[test]
fn samples_that_are_followed_together_are_those_that_are_followed_one_by_one() {
    let lamp =
        "[[light]]\nposition = [0.5, 1.5, 0.5]\nemission = { gaussian = { sigma = \"0.05 m\" } }\n";
    let scene = scene(&(corner(14) + lamp));
    let plan = Plan::new(&scene, &Request::default()).unwrap();
    let mut prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    let bins = Bins {
        start: 1.0,
        width: 0.1,
        count: 60,
    };
    let mut baked = |at_once| -> Baked {
        prepared.samples_at_once = NonZeroU32::new(at_once);
        let single = CubePrecision::Single;
        bake::camera_cube(&scene, &prepared, &bins, single, None, &Silent).unwrap()
    };
    let alone = baked(1);
    let all = |baked: &Baked| -> Vec<f64> {
        let [height, width, times, channels] = baked.cube.shape;
        let count = height * width * times * channels;
        (0..count)
            .map(|k| baked.cube.samples.get(k).unwrap())
            .collect()
    };
    let expected = all(&alone);
    for at_once in [2, 4, 7] {
        let together = baked(at_once);
        for (a, b) in all(&together).iter().zip(&expected) {
            let rounding = 2.0 * f64::from(f32::EPSILON) * b;
            assert!((a - b).abs() <= rounding, "{at_once}: {a} {b}");
        }
        let errors = together.standard_error.iter().zip(&alone.standard_error);
        for (a, b) in errors {
            assert!((a - b).abs() <= 1e-10 * b, "{at_once}: {a} {b}");
        }
    }
    let lit = expected.iter().filter(|x| **x > 0.0).count();
    assert!(lit > 10_000, "{lit}");
}

#[test]
fn tiles_are_the_same_whichever_were_rendered_before_them() {
    let scene = boxed("metallic = 1\nroughness = 0.3");
    let whole = on(1, || render(&scene, &Silent)).unwrap();
    let width = scene.layout.size[0] as usize;
    for index in 0..Tile::count(scene.layout.size) {
        let alone = render_tiles(&scene, index..index + 1, &Silent).unwrap();
        for (column, row) in Tile::of_image(scene.layout.size, index).coordinates() {
            let pixel = row as usize * width + column as usize;
            let bits = |film: &Film| {
                let aovs = [Aov::Distance, Aov::Object].map(|aov| film.aov(aov).unwrap()[pixel]);
                (
                    film.radiance()[pixel].map(f64::to_bits),
                    aovs.map(f64::to_bits),
                )
            };
            assert_eq!(bits(&alone), bits(&whole), "{column} {row}");
        }
    }
}

/// Pictures of other sizes, with other channels.
#[test]
fn pictures_are_the_same_whichever_were_rendered_in_their_memory() {
    let request = |aovs: &[Aov]| Request {
        aovs: aovs.to_vec(),
        ..Request::default()
    };
    let prepared = |samples, size: &str, aovs: &[Aov]| {
        let text = corner(samples).replace("[37, 21]", size);
        let scene = scene(&text);
        Prepared::new(&scene, &Plan::new(&scene, &request(aovs)).unwrap(), &Silent).unwrap()
    };
    let scenes = [
        prepared(2, "[37, 21]", &[Aov::Distance]),
        prepared(1, "[64, 40]", &[]),
        prepared(
            3,
            "[5, 90]",
            &[Aov::Object, Aov::StandardError, Aov::Distance],
        ),
        prepared(2, "[37, 21]", &[Aov::Distance]),
    ];
    let all = |film: &Film| {
        let channels = [Aov::Distance, Aov::Object, Aov::StandardError];
        let channels = channels.iter().filter_map(|aov| film.aov(*aov));
        let channels = channels.flatten().map(|x| x.to_bits());
        let radiance = film.radiance().as_flattened().iter().map(|x| x.to_bits());
        (film.size(), radiance.chain(channels).collect::<Vec<_>>())
    };
    for method in ["trace", "raster:adaptive=0.1"] {
        let method: Method = method.parse().unwrap();
        let mut last = None;
        for scene in &scenes {
            let alone = raster::render(scene, &method, &Silent).unwrap();
            let before = last.unwrap_or_else(|| render(&scenes[2], &Silent).unwrap());
            let film = raster::render_over(scene, &method, before, &Silent).unwrap();
            assert_eq!(all(&film), all(&alone));
            assert!(film.radiance().iter().any(|rgb| rgb[0] > 0.0));
            last = Some(film);
        }
    }
}
