//! Surfaces that shine as a function of their own time: like lamps, as they were when light left them, with bounces and in bakes.

use std::f64::consts::TAU;
use std::path::Path;

use nullray::io::cube::Cube;
use nullray::render::bake::{self, Bins, CubePrecision};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::render::survey;
use nullray::scene::model::Scene;
use nullray::scene::{Overrides, parse};

use crate::pipeline::files::{self, Quad};

fn scene(text: &str) -> Scene {
    parse(text, "flashes", Path::new(""), &Overrides::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn prepared(scene: &Scene, pixel_centers: bool) -> Prepared {
    let request = Request {
        pixel_centers,
        ..Request::default()
    };
    let plan = Plan::new(scene, &request).unwrap();
    Prepared::new(scene, &plan, &Silent).unwrap()
}

/// The green channel, row by row.
fn picture(text: &str) -> Vec<f64> {
    rendered(text, false)
}

fn rendered(text: &str, pixel_centers: bool) -> Vec<f64> {
    let film = render(&prepared(&scene(text), pixel_centers), &Silent).unwrap();
    film.radiance().iter().map(|c| c[1]).collect()
}

/// f(τ) = (τ + 40)/80, from which a time can be told.
const RAMP: &str =
    "emission = { table = [{ time = \"-40 m\", factor = 0 }, { time = \"40 m\", factor = 1 }] }";

/// The times at which light left that makes `varied` of `steady`.
fn told(varied: &str, steady: &str) -> Vec<Option<f64>> {
    let ratio =
        |(varied, steady): (f64, f64)| (steady > 0.0).then(|| 80.0 * varied / steady - 40.0);
    rendered(varied, true)
        .into_iter()
        .zip(rendered(steady, true))
        .map(ratio)
        .collect()
}

/// A floor, and light from 1 m above it that flies over it.
fn floor(beta: f64, time: f64, light: &str) -> String {
    format!(
        "[camera]\neye = [0, 4, 3]\nlook_at = [0, 0, 0]\nhfov = \"50 deg\"\nsize = [9, 7]\ntime = \"{time} m\"\n\
         [radiance]\nquantity = \"integrated\"\n\
         [[object]]\nname = \"floor\"\nshape = {{ plane = {{ size = [8, 8] }} }}\n\
         [[object]]\nname = \"panel\"\nshape = {{ plane = {{ size = [1e-4, 1e-4] }} }}\nvelocity = {{ beta = [{beta}, 0, 0] }}\n\
         transform = {{ translate = [0, 1, 0], rotate = {{ axis = [1, 0, 0], angle = \"180 deg\" }} }}\n\
         [[light]]\n{light}\n"
    )
}

#[test]
fn a_small_surface_shines_at_the_proper_times_of_a_lamp_in_its_place() {
    for (beta, time) in [(0.0, 5.0), (0.6, 4.0), (-0.9, 7.0)] {
        let area = |emission| {
            floor(
                beta,
                time,
                &format!("type = \"area\"\nobject = \"panel\"\n{emission}"),
            )
        };
        let lamp = |emission| {
            let motion = format!("velocity = {{ beta = [{beta}, 0, 0] }}");
            floor(
                beta,
                time,
                &format!("position = [0, 1, 0]\n{motion}\n{emission}"),
            )
        };
        let (ours, theirs) = (told(&area(RAMP), &area("")), told(&lamp(RAMP), &lamp("")));
        let both = ours.iter().zip(&theirs).filter_map(|(a, b)| a.zip(*b));
        let mut count = 0;
        for (ours, theirs) in both {
            // Its size, 10⁻⁴ m, as fast as time goes there: γ (1 + β) < 5.
            assert!((ours - theirs).abs() < 5e-4, "{beta}: {ours} {theirs}");
            count += 1;
        }
        // Nobody behind the panel's back is lit, and one pixel may show the panel.
        assert!(count > 40, "{beta}: {count}");
        if beta == 0.0 {
            // Of the radiance 1, right below it: 10⁻⁸ m² cos θ times what a lamp of intensity 1 does.
            let (ours, theirs) = (rendered(&area(RAMP), true), rendered(&lamp(RAMP), true));
            let middle = 9 * 3 + 4;
            let ratio = ours[middle] / theirs[middle];
            assert!((ratio / 1e-8 - 1.0).abs() < 1e-6, "{ratio}");
        }
    }
}

/// A wall across the view, 3 m away, which passes by.
fn wall(beta: f64, time: f64, keys: &str, light: &str) -> String {
    format!(
        "{keys}\n[camera]\neye = [0, 0, 3]\nlook_at = [0, 0, 0]\nhfov = \"40 deg\"\nsize = [6, 4]\ntime = \"{time} m\"\n\
         [[object]]\nname = \"wall\"\nshape = {{ plane = {{ size = [60, 60] }} }}\nvelocity = {{ beta = [{beta}, 0, 0] }}\n\
         transform = {{ rotate = {{ axis = [1, 0, 0], angle = \"90 deg\" }} }}\n\
         [[light]]\ntype = \"area\"\nobject = \"wall\"\n{light}\n"
    )
}

#[test]
fn a_surface_is_seen_as_it_shone_when_light_left_each_of_its_points() {
    let rgb = "radiance.quantity = \"rgb\"";
    let spectrum = "spectrum = { blackbody = \"5000 K\" }";
    for (keys, light) in [
        ("radiance.quantity = \"integrated\"", ""),
        ("radiance.quantity = \"integrated\"\nrender.bounces = 1", ""),
        (rgb, ""),
        (rgb, spectrum),
        ("radiance.quantity = \"rgb\"\nrender.bounces = 1", spectrum),
    ] {
        for (beta, time) in [(0.0, 4.0), (0.8, 2.5)] {
            let with = |emission: &str| wall(beta, time, keys, &format!("{light}\n{emission}"));
            let told = told(&with(RAMP), &with(""));
            let gamma = 1.0 / (1.0_f64 - beta * beta).sqrt();
            let half = (20.0_f64.to_radians()).tan();
            for (n, time_told) in told.into_iter().enumerate() {
                // The middle of pixel n, seen at the world event (T − s, x): τ = γ (t − β x).
                let (x, y) = ((n % 6) as f64, (n / 6) as f64);
                let x = half * ((2.0 * x + 1.0) / 6.0 - 1.0);
                let y = half * ((2.0 * y + 1.0) / 6.0 - 4.0 / 6.0);
                let s = 3.0 * (1.0 + x * x + y * y).sqrt();
                let expected = gamma * ((time - s) - beta * 3.0 * x);
                let found = time_told.unwrap();
                assert!(
                    (found - expected).abs() < 1e-9,
                    "{keys} {light} {beta} {n}: {found} {expected}"
                );
            }
        }
    }
}

/// A corner of grey surfaces under a panel that shines like `emission`.
fn corner(bounces: u32, time: f64, samples: u32, emission: &str) -> String {
    format!(
        "[render]\nbounces = {bounces}\n[radiance]\nquantity = \"integrated\"\n[display]\nsamples_per_pixel = {samples}\n\
         [camera]\neye = [0, 1.2, 4]\nlook_at = [0, 0.8, 0]\nhfov = \"55 deg\"\nsize = [8, 6]\ntime = \"{time} m\"\n\
         [[object]]\nname = \"floor\"\nshape = {{ plane = {{ size = [6, 6] }} }}\n\
         [[object]]\nname = \"back\"\nshape = {{ plane = {{ size = [6, 6] }} }}\n\
         transform = {{ translate = [0, 0, -1.5], rotate = {{ axis = [1, 0, 0], angle = \"90 deg\" }} }}\n\
         [[object]]\nname = \"panel\"\nshape = {{ plane = {{ size = [0.6, 0.6] }} }}\n\
         transform = {{ translate = [0, 1.6, 0], rotate = {{ axis = [1, 0, 0], angle = \"150 deg\" }} }}\n\
         [[light]]\ntype = \"area\"\nobject = \"panel\"\nradiance = 5\n{emission}\n"
    )
}

fn flash(sigma: f64) -> String {
    format!("emission = {{ gaussian = {{ time = \"0.3 m\", sigma = \"{sigma} m\" }} }}")
}

#[test]
fn pictures_of_a_flash_add_up_to_that_of_steady_light_also_with_bounces() {
    for bounces in [0, 2] {
        // As bright as steady, but not known to be, so that no paths are shared.
        let always = "emission = { table = [{ time = \"-99 m\", factor = 1 }, { time = \"99 m\", factor = 1 }] }";
        let steady = picture(&corner(bounces, 0.0, 4, always));
        // The same paths at all times, each once with every phase: Σ exp(−½ (kσ + x)²/σ²) = √(2π) to 2 exp(−2π²) of it.
        let sigma = 0.5;
        let mut sum = vec![0.0; steady.len()];
        for k in 0..100 {
            let time = -3.0 + f64::from(k) * sigma;
            for (sum, now) in sum
                .iter_mut()
                .zip(picture(&corner(bounces, time, 4, &flash(sigma))))
            {
                *sum += now;
            }
        }
        for (n, (sum, steady)) in sum.iter().zip(&steady).enumerate() {
            let expected = TAU.sqrt() * steady;
            assert!(
                (sum - expected).abs() <= 1e-7 * expected,
                "{bounces} {n}: {sum} {expected}"
            );
        }
        assert!(steady.iter().filter(|x| **x > 0.0).count() > 40);
        // The camera is more than 2.4 m from all: what left at −0.45 m cannot be there at 1.9 m.
        let early = picture(&corner(bounces, 1.9, 4, &flash(0.05)));
        assert!(early.iter().all(|x| *x == 0.0), "{early:?}");
    }
}

#[test]
fn a_bake_of_a_flash_has_the_light_and_the_times_of_pictures() {
    let (sigma, bounces, samples) = (0.1, 1, 512);
    // The panel itself is out of view: where it is seen is tested below.
    let corner = |bounces, time, samples, emission: &str| {
        let text = corner(bounces, time, samples, emission);
        text.replace("look_at = [0, 0.8, 0]", "look_at = [0, 0.1, 0]")
            .replace("hfov = \"55 deg\"", "hfov = \"40 deg\"")
    };
    let bins = Bins {
        start: 2.0,
        width: 0.25,
        count: 60,
    };
    let baked = scene(&corner(bounces, 0.0, samples, &flash(sigma)));
    let cube = bake::camera_cube(
        &baked,
        &prepared(&baked, false),
        &bins,
        CubePrecision::Single,
        None,
        &Silent,
    )
    .unwrap()
    .cube;
    let pixels = 8 * 6;
    let green = |cube: &Cube, pixel: usize, bin: usize| {
        cube.samples
            .get((pixel * bins.count + bin) * 3 + 1)
            .unwrap()
    };
    // All energy, pixel by pixel: L ∫ f dτ, by means over squares of four pixels for less noise.
    let steady = picture(&corner(bounces, 0.0, samples, ""));
    let area = (TAU).sqrt() * sigma;
    for row in 0..3 {
        for column in 0..4 {
            let square =
                [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(i, j)| (2 * row + i) * 8 + 2 * column + j);
            let ours: f64 = square
                .iter()
                .map(|p| (0..bins.count).map(|k| green(&cube, *p, k)).sum::<f64>())
                .sum();
            let theirs: f64 = square.iter().map(|p| steady[*p] * area).sum();
            assert!(
                (ours - theirs).abs() < 0.04 * theirs,
                "{square:?}: {ours} {theirs}"
            );
        }
    }
    // When it comes, by the whole picture: the integral over a bin by Simpson's rule.
    let mut seen = 0;
    for k in [12, 13, 14, 15, 16, 18] {
        let ours: f64 = (0..pixels).map(|p| green(&cube, p, k)).sum();
        let start = bins.start + k as f64 * bins.width;
        let at = |part: f64| {
            picture(&corner(
                bounces,
                start + part * bins.width,
                samples,
                &flash(sigma),
            ))
            .iter()
            .sum::<f64>()
        };
        let theirs = (at(0.0) + 4.0 * at(0.25) + 2.0 * at(0.5) + 4.0 * at(0.75) + at(1.0)) / 12.0
            * bins.width;
        if theirs > 1e-3 {
            seen += 1;
            assert!(
                (ours - theirs).abs() < 0.06 * theirs,
                "{k}: {ours} {theirs}"
            );
        }
    }
    assert!(seen >= 4, "{seen}");
}

#[test]
fn a_bake_of_a_shining_wall_has_its_light_when_that_arrives() {
    let sigma = 0.1;
    let seen = scene(&wall(
        0.0,
        0.0,
        "display.samples_per_pixel = 64",
        &flash(sigma),
    ));
    let bins = Bins {
        start: 2.5,
        width: 0.2,
        count: 12,
    };
    let baked = bake::camera_cube(
        &seen,
        &prepared(&seen, false),
        &bins,
        CubePrecision::Single,
        None,
        &Silent,
    )
    .unwrap();
    let half = (20.0_f64.to_radians()).tan();
    let until = |x: f64| sigma * (TAU / 4.0).sqrt() * libm::erf(x / (sigma * 2.0_f64.sqrt()));
    for n in 0..24 {
        for k in 0..bins.count {
            // Of 8 × 8 places in the pixel: light of the wall's time t arrives at t + s.
            let mut expected = 0.0;
            for place in 0..64 {
                let (x, y) = ((n % 6) as f64, (n / 6) as f64);
                let (a, b) = (f64::from(place % 8), f64::from(place / 8));
                let x = half * (2.0 * (x + (a + 0.5) / 8.0) / 6.0 - 1.0);
                let y = half * (2.0 * (y + (b + 0.5) / 8.0) / 6.0 - 4.0 / 6.0);
                let s = 3.0 * (1.0 + x * x + y * y).sqrt();
                let start = bins.start + k as f64 * bins.width - 0.3 - s;
                expected += (until(start + bins.width) - until(start)) / 64.0;
            }
            let found = baked
                .cube
                .samples
                .get((n * bins.count + k) * 3 + 1)
                .unwrap();
            assert!(
                (found - expected).abs() < 2e-3,
                "{n} {k}: {found} {expected}"
            );
        }
    }
}

/// A square over a floor, with this material, as an area light or not.
fn glowing(folder: &Path, material: &str, bounces: u32, light: &str) -> Scene {
    let square = Quad {
        material: Some(material),
        ..Quad::PLAIN
    };
    files::glb(&folder.join("glow.glb"), &square);
    let text = format!(
        "[render]\nbounces = {bounces}\n[radiance]\nquantity = \"integrated\"\n[display]\nsamples_per_pixel = 64\n\
         [camera]\neye = [0, 2, 6]\nlook_at = [0, -0.5, 0]\nhfov = \"50 deg\"\nsize = [8, 6]\n\
         [[object]]\nname = \"floor\"\nshape = {{ plane = {{ size = [8, 8] }} }}\ntransform = {{ translate = [0, -1, 0] }}\n\
         [[object]]\nname = \"glow\"\ngltf = \"glow.glb\"\n{light}\n"
    );
    parse(&text, "glow", folder, &Overrides::default()).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn an_area_light_without_a_radiance_shines_as_its_materials_emit() {
    let folder = tempfile::tempdir().unwrap();
    let picture = |material: &str, bounces, light: &str| -> Vec<[f64; 3]> {
        let scene = glowing(folder.path(), material, bounces, light);
        let film = render(&prepared(&scene, false), &Silent).unwrap();
        film.radiance().to_vec()
    };
    let emitting = "{ \"emissiveFactor\": [0.5, 1, 0.25] }";
    let area = |keys: &str| format!("[[light]]\ntype = \"area\"\nobject = \"glow\"\n{keys}");
    // Constant over all times in view, but not known to be.
    let dimmed = area(
        "emission = { table = [{ time = \"-99 m\", factor = 0.25 }, { time = \"99 m\", factor = 0.25 }] }",
    );
    // Materials emit in any scene with light, however dark.
    let own = picture(emitting, 0, "[sky]\nradiance = 0");
    let lit = own.iter().filter(|c| c[1] > 0.0).count();
    assert!(lit > 30, "{lit}");
    for (ours, own) in picture(emitting, 0, &dimmed).iter().zip(&own) {
        for (ours, own) in ours.iter().zip(own) {
            assert!((ours - 0.25 * own).abs() <= 1e-9 * own, "{ours} {own}");
        }
    }
    // A radiance replaces what they emit, and 1 is that of materials that emit nothing.
    let one = picture(emitting, 0, &area("radiance = 1"));
    let plain = picture("{}", 0, &area(""));
    assert!(one == plain && one != own);
    // All energy of a flash is in the bins.
    let (sigma, bounces) = (0.1, 1);
    let baked = glowing(folder.path(), emitting, bounces, &area(&flash(sigma)));
    let bins = Bins {
        start: 0.0,
        width: 0.5,
        count: 60,
    };
    let prepared = prepared(&baked, false);
    let cube = bake::camera_cube(
        &baked,
        &prepared,
        &bins,
        CubePrecision::Single,
        None,
        &Silent,
    );
    let cube = cube.unwrap().cube;
    let steady = picture(emitting, bounces, "[sky]\nradiance = 0");
    for c in 0..3 {
        let all = 0..8 * 6 * bins.count;
        let ours: f64 = all.map(|k| cube.samples.get(3 * k + c).unwrap()).sum();
        let theirs: f64 = steady.iter().map(|rgb| rgb[c]).sum::<f64>() * TAU.sqrt() * sigma;
        assert!((ours / theirs - 1.0).abs() < 0.02, "{c}: {ours} {theirs}");
    }
}

#[test]
fn times_that_miss_a_flash_are_reported_with_those_that_do_not() {
    // Right before and on the floor: from 3 m to 3.3 m away, with 0.3 m ± 8 σ.
    let text = wall(0.0, 0.0, "", &flash(0.1));
    let dark = scene(&text);
    let told = survey::moments(&dark, &mut prepared(&dark, false), true);
    assert_eq!(told.len(), 1, "{told:?}");
    for said in [
        "light \"area\": light in view left between its own times -3.",
        "it shines from -0.5 m to 1.1 m; try camera.time",
    ] {
        assert!(told[0].contains(said), "{told:?}");
    }
    // The times are right: there is light at their middle, and what lights the corner is told, too.
    let numbers: Vec<f64> = told[0]
        .split('"')
        .filter_map(|word| word.strip_suffix(" m")?.parse().ok())
        .collect();
    let [from, to] = [numbers[0], numbers[1]];
    assert!(
        (2.4..2.9).contains(&from) && (4.0..4.5).contains(&to),
        "{told:?}"
    );
    assert!(
        picture(&wall(0.0, 0.5 * (from + to), "", &flash(0.1)))
            .iter()
            .any(|x| *x > 0.0)
    );
    let lit = scene(
        &corner(0, 0.0, 1, &flash(0.1)).replace("look_at = [0, 0.8, 0]", "look_at = [0, -1, 0]"),
    );
    let told = survey::moments(&lit, &mut prepared(&lit, false), true);
    assert!(
        told.len() == 1 && told[0].contains("try camera.time"),
        "{told:?}"
    );
}

#[test]
fn hints_hold_for_lamps_in_motion_and_pulses_of_trains() {
    // A flash at the lamp's own time 10 m, or pulses every 600 m of it, 10 m ± 8 σ among them, over a floor.
    let flash =
        "clock_zero = \"0 m\"\nemission = { gaussian = { time = \"10 m\", sigma = \"5 cm\" } }";
    let endless =
        "emission = { train = { time = \"10 m\", sigma = \"5 cm\", period = \"600 m\" } }";
    let three = "emission = { train = { time = \"-590 m\", sigma = \"5 cm\", period = \"600 m\", count = 3 } }";
    let motions = [
        "",
        "velocity = { beta = [0.5, 0, 0] }",
        "velocity = { beta = [-0.95, 0, 0] }",
        "velocity = { beta = [0, 0, 0.8] }",
    ];
    let is_lit = |text: &str| rendered(text, true).iter().any(|x| *x > 0.0);
    for motion in motions {
        for emission in [flash, endless, three] {
            let at = |time: f64| {
                let lamp = format!("position = [0.5, 1, 0]\n{motion}\n{emission}");
                let text = floor(0.0, time, &lamp);
                // Without the panel, which would keep light off the floor.
                let [before, rest] = text
                    .split("[[object]]\nname = \"panel\"")
                    .collect::<Vec<_>>()[..]
                else {
                    panic!("{text}");
                };
                format!("{before}{}", &rest[rest.find("[[light]]").unwrap()..])
            };
            let dark = scene(&at(1.0));
            let told = survey::moments(&dark, &mut prepared(&dark, false), true);
            assert_eq!(told.len(), 1, "{motion} {emission} {told:?}");
            let numbers: Vec<f64> = told[0]
                .split('"')
                .filter_map(|word| word.strip_suffix(" m")?.parse().ok())
                .collect();
            let [from, to] = numbers[..] else {
                panic!("{motion} {emission} {told:?}")
            };
            // Dark right before and after, lit right within.
            let margin = 0.02 * (to - from);
            let found = [from - margin, from + margin, to - margin, to + margin];
            let found = found.map(|time| is_lit(&at(time)));
            assert_eq!(
                found,
                [false, true, true, false],
                "{motion} {emission} {told:?}"
            );
        }
    }
}

#[test]
fn what_does_not_end_or_goes_through_a_medium_is_refused() {
    let bins = Bins {
        start: 0.0,
        width: 0.1,
        count: 10,
    };
    for emission in [
        "",
        "emission = { train = { sigma = \"1 cm\", period = \"1 m\" } }",
    ] {
        let steady = scene(&corner(0, 0.0, 1, emission));
        let error = bake::camera_cube(
            &steady,
            &prepared(&steady, false),
            &bins,
            CubePrecision::Single,
            None,
            &Silent,
        )
        .unwrap_err();
        assert!(error.to_string().contains("never stops shining"), "{error}");
    }
    let text = wall(0.5, 0.0, "medium.index = 1.5", RAMP);
    let error = parse(&text, "flashes", Path::new(""), &Overrides::default()).unwrap_err();
    assert!(
        error.to_string().contains("moves in a medium of index 1.5"),
        "{error}"
    );
}
