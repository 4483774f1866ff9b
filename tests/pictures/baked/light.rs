//! Baked light against an independent renderer of transient light, and closed forms.

use std::path::Path;

use nullray::io::cube::{self, Cube, Wanted};
use nullray::render::bake::{Bins, Coordinates, Surface};
use nullray::scene::model::{Clock, CubeBacks, Scene};

use super::{CORNER, PI, camera_cube, cube_of, prepared, surface_cube, value};
use crate::pipeline::stage;

/// A reference cube of one channel: shape and values.
fn reference(file: &str) -> Cube {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    cube::load(&path, Wanted::default()).unwrap()
}

/// √(Σ(a−b)²/Σb²) of the sums over so many `pixels` in a row and `bins`, where `counts`.
fn relative_rmse(
    a: &Cube,
    b: &Cube,
    [pixels, bins]: [usize; 2],
    counts: impl Fn(usize) -> bool,
) -> f64 {
    let [h, w, t, _] = b.shape;
    let (mut squares, mut all) = (0.0, 0.0);
    for first in (0..h * w).step_by(pixels).filter(|p| counts(*p)) {
        for begin in (0..t).step_by(bins) {
            let sum = |cube: &Cube| -> f64 {
                let pixels = first..(first + pixels).min(h * w);
                let each = pixels.flat_map(|p| (begin..(begin + bins).min(t)).map(move |k| (p, k)));
                each.map(|(p, k)| value(cube, p, k)).sum()
            };
            let (a, b) = (sum(a), sum(b));
            squares += (a - b) * (a - b);
            all += b * b;
        }
    }
    (squares / all).sqrt()
}

#[test]
fn a_baked_camera_cube_is_that_of_an_independent_renderer_wavefront_by_wavefront() {
    let mut scene = stage::scene(CORNER);
    scene.samples_per_pixel = 24;
    let bins = Bins {
        start: 7.85,
        width: 0.05,
        count: 183,
    };
    let baked = camera_cube(&scene, &bins).unwrap();
    let expected = reference("tests/data/transient/reference_cube.npz");
    assert_eq!(baked.cube.shape[..3], expected.shape[..3]);
    // Each bin of all pixels, and each pixel of all bins; then bins of 0.2 m in rows of 16 pixels, with the noise of 384 paths.
    let all = |_| true;
    let [h, w, t, _] = expected.shape;
    let by_time = relative_rmse(&baked.cube, &expected, [h * w, 1], all);
    let by_place = relative_rmse(&baked.cube, &expected, [1, t], all);
    let both = relative_rmse(&baked.cube, &expected, [16, 4], all);
    assert!(by_time < 4e-3, "{by_time}");
    assert!(by_place < 4e-2, "{by_place}");
    assert!(both < 3e-2, "{both}");
    // Without the last bounce it would be off by far.
    let mut less = scene;
    less.bounces = 1;
    let less = camera_cube(&less, &bins).unwrap();
    let by_time = relative_rmse(&less.cube, &expected, [h * w, 1], all);
    assert!(by_time > 1e-2, "{by_time}");
    // The bins hold 99.51 % of the energy, by the description of the data.
    let energy = baked.energy;
    let missed = (energy.before + energy.after) / (energy.held + energy.before + energy.after);
    assert!((missed - 0.0049).abs() < 5e-4, "{missed}");
}

#[test]
fn a_baked_surface_is_that_of_an_independent_renderer() {
    // The lightmap of the corner: charts of 64 and 20 texels between gutters, row by row.
    let mut scene = stage::scene(CORNER);
    scene.samples_per_pixel = 64;
    let bins = Bins {
        start: 1.75,
        width: 0.05,
        count: 153,
    };
    let expected = reference("scenes/corner/lightmap.npz");
    let [h, w, ..] = expected.shape;
    let baked = surface_cube(&scene, 0, [w as u32, h as u32], &bins).unwrap();
    // Texels of the floor's chart, from (1, 1) on.
    let floor = |texel: usize| (1..65).contains(&(texel / w)) && (1..65).contains(&(texel % w));
    let by_place = relative_rmse(&baked.cube, &expected, [1, 153], floor);
    assert!(by_place < 3e-2, "{by_place}");
    let by_time = relative_rmse(&baked.cube, &expected, [h * w, 1], |_| true);
    assert!(by_time < 1e-2, "{by_time}");
    // Bilinear lookups beside a chart find its edge's light.
    let sum = |column: usize| -> f64 {
        let texels = (1..65).map(|row| row * w + column);
        let each = texels.flat_map(|texel| (0..153).map(move |bin| (texel, bin)));
        each.map(|(texel, bin)| value(&baked.cube, texel, bin))
            .sum()
    };
    let (edge, gutter) = (sum(1), sum(0));
    assert!(
        edge > 0.0 && (gutter / edge - 1.0).abs() < 0.02,
        "{edge} {gutter}"
    );
}

#[test]
fn light_in_a_sphere_arrives_by_the_density_of_its_chords() {
    // A flash at the centre of a sphere comes back from the wall to a camera there at 2R, and by one more bounce at 2R + s, the chord s with
    // the density s/(2R²) up to 2R. Of intensity 1: L = ρ/(πR²), and ρ²/(πR²) (b² − a²)/(4R²) within a < s < b.
    let (radius, albedo) = (1.5, 0.8);
    for beta in [0.0, 0.9] {
        let scene = stage::scene(&format!(
            "
render = {{ bounces = 1 }}
display = {{ back_faces = \"two_sided\", samples_per_pixel = 64 }}
[camera]
eye = [0, 0, 0]
look_at = [1, 0.3, 0.4]
hfov = \"70 deg\"
size = [24, 16]
velocity = {{ beta = [{beta}, 0, 0] }}
[[object]]
name = \"sphere\"
shape = {{ sphere = {{ radius = {radius}, subdivisions = 5 }} }}
colour = [{albedo}, {albedo}, {albedo}]
velocity = {{ beta = [{beta}, 0, 0] }}
[[light]]
position = [0, 0, 0]
velocity = {{ beta = [{beta}, 0, 0] }}
emission = {{ gaussian = {{ sigma = \"1 cm\" }} }}"
        ));
        let bins = Bins {
            start: 2.0 * radius - 0.15,
            width: 0.3,
            count: 12,
        };
        let baked = camera_cube(&scene, &bins).unwrap();
        let mean = |bin: usize| {
            let sum: f64 = (0..24 * 16).map(|p| value(&baked.cube, p, bin)).sum();
            sum / (24.0 * 16.0)
        };
        // The integral of a Gaussian of peak 1.
        let energy = 0.01 * (2.0 * PI).sqrt();
        let direct = albedo / (PI * radius * radius) * energy;
        let chords = |a: f64, b: f64| direct * albedo * (b * b - a * a) / (4.0 * radius * radius);
        stage::assert_relative(mean(0), direct + chords(0.0, 0.15), 3e-3, beta);
        for bin in 1..10 {
            let a = -0.15 + 0.3 * bin as f64;
            // So many of the paths end in the bin: four standard deviations.
            let part = chords(a, a + 0.3) / (direct * albedo);
            let deviation = (24.0 * 16.0 * 64.0 * part).sqrt().recip();
            let what = format!("{beta} {bin}");
            stage::assert_relative(mean(bin), chords(a, a + 0.3), 4.0 * deviation, what);
        }
        assert_eq!(mean(11), 0.0);
        assert_eq!(baked.clock, Clock::Capture);
        let all = direct * (1.0 + albedo);
        stage::assert_relative(baked.energy.held / (24.0 * 16.0), all, 5e-3, beta);
        let [from, to] = baked.energy.span.unwrap();
        assert!((from - 2.0 * radius + 0.08).abs() < 0.01 && to < 4.0 * radius + 0.09);
    }
}

/// Steps of lengths, metres.
const STEP: f64 = 0.005;

/// How much of the light has a way in each step from 0 on, where `until` says how much has a shorter one.
fn lengths(until: impl Fn(f64) -> f64, count: usize) -> Vec<f64> {
    let edge = |k: usize| until(k as f64 * STEP);
    (0..count).map(|k| edge(k + 1) - edge(k)).collect()
}

/// The same of one way after another: what is even in two steps is half in either of two, to the square of a step.
fn one_after_another(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0; a.len()];
    for (i, a) in a.iter().enumerate() {
        for (k, b) in b[..b.len() - i].iter().enumerate() {
            all[i + k] += 0.5 * a * b;
            if let Some(next) = all.get_mut(i + k + 1) {
                *next += 0.5 * a * b;
            }
        }
    }
    all
}

/// Asserts that the energies of `bins`, means over pixels of cubes of 12 seeds, are `expected` to six times what these seeds tell of their
/// error and `beside` of the value: by Student's t of 11 degrees of freedom 9·10⁻⁵ of true values are farther off. Then the sum over all times.
fn assert_energies(scene: &Scene, bins: &Bins, expected: &[f64], (sum, beside): (f64, f64)) {
    const SEEDS: u32 = 12;
    let mut found = vec![Vec::new(); bins.count + 1];
    for seed in 0..SEEDS {
        let mut scene = scene.clone();
        scene.seed = seed;
        let baked = camera_cube(&scene, bins).unwrap();
        let [h, w, ..] = baked.cube.shape;
        for (bin, found) in found[..bins.count].iter_mut().enumerate() {
            let sum: f64 = (0..h * w).map(|pixel| value(&baked.cube, pixel, bin)).sum();
            found.push(sum / (h * w) as f64);
        }
        let energy = baked.energy;
        let all = energy.before + energy.held + energy.after;
        found[bins.count].push(all / (h * w) as f64);
    }
    let n = f64::from(SEEDS);
    let mut told = 0;
    for (bin, (found, expected)) in found.iter().zip(expected.iter().chain([&sum])).enumerate() {
        let mean = found.iter().sum::<f64>() / n;
        let squares: f64 = found.iter().map(|x| (x - mean).powi(2)).sum();
        let error = (squares / (n * (n - 1.0))).sqrt();
        assert!(
            (mean - expected).abs() <= 6.0 * error + beside * expected,
            "bin {bin}: {mean:e} ± {error:e}, not {expected:e}"
        );
        told += usize::from(error < 0.02 * expected);
    }
    // Errors are small enough to tell anything, but of few bins.
    let lit = expected.iter().filter(|x| **x > 0.0).count();
    assert!(told > lit * 3 / 4, "{told} of {lit} bins");
}

#[test]
fn light_between_two_plates_comes_late_by_ways_across() {
    // Two wide plates of albedo ρ at a distance of 1 m. What leaves one with the cosine meets the other after s = 1 m/cos θ, of which 1 − 1/s² are
    // shorter. Of a pulse of the lower plate, of energy E, the upper one shows ρ E, ρ³ E, … after 1, 3, … ways across, one after another, and the lower
    // one E, ρ² E, ρ⁴ E after 0, 2, 4: nothing until 2 m after the pulse.
    const COUNT: usize = 1400;
    let (albedo, bounces) = (0.8f64, 4);
    let way = lengths(|s| if s > 1.0 { 1.0 - s.powi(-2) } else { 0.0 }, COUNT);
    let mut ways = vec![Vec::new(), way.clone()];
    for n in 2..=bounces + 1 {
        ways.push(one_after_another(&ways[n - 1], &way));
    }
    let energy = 3.0 * 0.002 * (2.0 * PI).sqrt();
    for (looks_at, first) in [(1.0, 1), (0.0, 2)] {
        let scene = stage::scene(&format!(
            "
render = {{ bounces = {bounces} }}
display = {{ samples_per_pixel = 128 }}
[camera]
eye = [0, 0.5, 0]
look_at = [0, {looks_at}, 0]
up = [1, 0, 0]
hfov = \"2 deg\"
size = [16, 16]
[[object]]
name = \"below\"
shape = {{ plane = {{ size = [600, 600] }} }}
colour = [{albedo}, {albedo}, {albedo}]
[[object]]
name = \"above\"
shape = {{ plane = {{ size = [600, 600] }} }}
colour = [{albedo}, {albedo}, {albedo}]
transform = {{ translate = [0, 1, 0], rotate = {{ axis = [1, 0, 0], angle = \"180 deg\" }} }}
[[light]]
type = \"area\"
object = \"below\"
radiance = 3
emission = {{ gaussian = {{ sigma = \"2 mm\" }} }}"
        ));
        // Half a metre to the camera; from 0.1 m after the pulse on.
        let bins = Bins {
            start: 0.6,
            width: 0.2,
            count: 34,
        };
        let all = || (first..=bounces + 1).step_by(2);
        let of_bin = |bin: usize| -> f64 {
            let steps = 20 + 40 * bin..60 + 40 * bin;
            let of_way =
                |n: usize| albedo.powi(n as i32) * ways[n][steps.clone()].iter().sum::<f64>();
            energy * all().map(of_way).sum::<f64>()
        };
        let expected: Vec<f64> = (0..bins.count).map(of_bin).collect();
        let series: f64 = all().map(|n| albedo.powi(n as i32)).sum();
        // What the lower plate shows of its own.
        let own = if first == 2 { 1.0 } else { 0.0 };
        assert_energies(&scene, &bins, &expected, (energy * (own + series), 5e-4));
        // In the first bins there is nothing: up to 0.9 m, or to 1.9 m.
        let dark = if first == 1 { 4 } else { 9 };
        assert!(expected[..dark].iter().all(|x| *x == 0.0) && expected[dark] > 0.0);
    }
}

#[test]
fn light_in_a_sphere_comes_late_by_chords_one_after_another() {
    // As in the test above: after n bounces by n chords, of which (s/2R)² are shorter than s. Up to 2R two of them have the density s³/(24 R⁴).
    const COUNT: usize = 2000;
    let (radius, albedo, bounces) = (1.5, 0.8f64, 3);
    let chord = lengths(|s| (s / (2.0 * radius)).min(1.0).powi(2), COUNT);
    let two = one_after_another(&chord, &chord);
    let short: f64 = two[..600].iter().sum();
    stage::assert_relative(
        short,
        3.0f64.powi(4) / (96.0 * radius.powi(4)),
        1e-5,
        "two chords",
    );
    let three = one_after_another(&two, &chord);
    let scene = stage::scene(&format!(
        "
render = {{ bounces = {bounces} }}
display = {{ back_faces = \"two_sided\", samples_per_pixel = 64 }}
[camera]
eye = [0, 0, 0]
look_at = [1, 0.3, 0.4]
hfov = \"70 deg\"
size = [24, 16]
[[object]]
shape = {{ sphere = {{ radius = {radius}, subdivisions = 6 }} }}
colour = [{albedo}, {albedo}, {albedo}]
[[light]]
position = [0, 0, 0]
emission = {{ gaussian = {{ sigma = \"2 mm\" }} }}"
    ));
    let bins = Bins {
        start: 2.0 * radius + 0.1,
        width: 0.2,
        count: 49,
    };
    let energy = 0.002 * (2.0 * PI).sqrt() * albedo / (PI * radius * radius);
    let of_bin = |bin: usize| -> f64 {
        let steps = 20 + 40 * bin..60 + 40 * bin;
        let all = [&chord, &two, &three].into_iter().zip(1..);
        let of_chords =
            |(ways, n): (&Vec<f64>, i32)| albedo.powi(n) * ways[steps.clone()].iter().sum::<f64>();
        energy * all.map(of_chords).sum::<f64>()
    };
    let expected: Vec<f64> = (0..bins.count).map(of_bin).collect();
    let series: f64 = (0..=bounces).map(|n| albedo.powi(n)).sum();
    // The sphere's triangles lie inside of it by 2·10⁻⁴ of its radius on average.
    assert_energies(&scene, &bins, &expected, (energy * series, 2e-3));
}

/// A ball with a flash in its middle: its back alone is lit, from everywhere alike, as closed forms have it.
#[test]
fn the_back_of_a_sphere_has_the_light_of_a_flash_within() {
    let scene = stage::scene(
        "camera = { eye = [0, 0, 5], look_at = [0, 0, 0], size = [4, 4] }\n\
         display = { back_faces = \"two_sided\", samples_per_pixel = 4 }\n\
         [[object]]\nname = \"ball\"\ncolour = [0.6, 0.6, 0.6]\nshape = { sphere = { radius = 2, subdivisions = 5 } }\n\
         [[light]]\nposition = [0, 0, 0]\nintensity = 3\nemission = { gaussian = { sigma = \"5 cm\" } }\n",
    );
    let bins = Bins {
        start: 1.5,
        width: 1.0,
        count: 1,
    };
    let surface = Surface {
        object: 0,
        coordinates: Coordinates::Atlas,
        size: [96, 96],
    };
    let baked = cube_of(&scene, &prepared(&scene), &surface, &bins).unwrap();
    assert_eq!(baked.backs, CubeBacks::SecondHalf);
    assert_eq!(baked.cube.shape[..3], [192, 96, 1]);
    // I/r² of irradiance for the duration √(2π) σ of the flash, and albedo/π of it.
    let expected = 0.6 / PI * 3.0 / 4.0 * (2.0 * PI).sqrt() * 0.05;
    let mut lit = 0;
    for pixel in 0..192 * 96 {
        let value = value(&baked.cube, pixel, 0);
        assert!(pixel >= 96 * 96 || value == 0.0);
        if value > 0.0 {
            lit += 1;
            assert!((value / expected - 1.0).abs() < 0.02, "{value} {expected}");
        }
    }
    assert!(lit > 3000, "{lit}");
}
