//! Light against Mitsuba 3 (tests/data/mitsuba): panel, uniform and pictured sky, point lamp, parallel light, diffuse surfaces, GGX, glossy
//! dielectrics; and light that bounces between diffuse walls, a mirror and glass, in pictures and in bakes.

use std::path::Path;

use nullray::io::image::{Channel, Layers, Samples, exr};
use nullray::render::bake::{self, Bins, CubePrecision};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::model::Scene;
use nullray::scene::{self, Overrides};

/// The camera, floor and box of all scenes of generate.py, and the ball that takes its material from what follows.
const ROOM: &str = "
[display]
samples_per_pixel = 256
[camera]
eye = [0.5, 2.2, 5]
look_at = [0, 0.6, 0]
hfov = \"50 deg\"
[[object]]
shape = { plane = { size = [12, 12] } }
colour = [0.6, 0.5, 0.4]
[[object]]
shape = { box = { size = [1, 1, 1] } }
transform = { translate = [1.1, 0.5, -0.2] }
colour = [0.3, 0.7, 0.4]
[[object]]
shape = { sphere = { radius = 0.8, subdivisions = 6 } }
transform = { translate = [-0.9, 0.8, 0.2] }
";

/// The rest of the scene under the panel. Roughness ½ is α = ¼; white metal has F = 1.
const PANEL: &str = "
colour = [1, 1, 1]
metallic = 1
roughness = 0.5
[[object]]
name = \"panel\"
shape = { plane = { size = [1.2, 0.8] } }
transform = { translate = [0, 3, 0.5], rotate = { axis = [1, 0, 0], angle = \"180 deg\" } }
colour = [0, 0, 0]
[[light]]
type = \"area\"
object = \"panel\"
radiance = [9, 7, 5]
[sky]
radiance = [0.3, 0.4, 0.6]
";

#[test]
fn direct_light_at_rest_is_that_of_mitsuba() {
    // The noise of the means is below 0.1 % in both; pixels have that of 256 samples, and edges.
    check("direct", PANEL, Path::new("."), ([40, 30], 256), 0.004, 20);
}

/// The second ball of the scenes of lamps; roughness is the root of α.
const BALLS: &str = "
colour = [1, 1, 1]
metallic = 1
roughness = 0.3
[[object]]
shape = { sphere = { radius = 0.4, subdivisions = 6 } }
transform = { translate = [0.3, 0.4, 1.3] }
colour = [1, 1, 1]
metallic = 1
roughness = 0.6
";

#[test]
fn lamps_and_a_pictured_sky_at_rest_are_those_of_mitsuba() {
    let folder = tempfile::tempdir().unwrap();
    write_sky(&folder.path().join("sky.exr"));
    for (name, light) in [
        (
            "point",
            "[[light]]\nposition = [1.5, 3, 2]\nintensity = [20, 18, 15]",
        ),
        (
            "directional",
            "[[light]]\ntype = \"directional\"\ndirection = [-0.4, -1, -0.3]\nirradiance = [2, 1.8, 1.5]",
        ),
        ("environment", "[sky]\nimage = { file = \"sky.exr\" }"),
    ] {
        let rest = format!("{BALLS}\n{light}");
        check(name, &rest, folder.path(), ([28, 21], 256), 0.01, 15);
    }
}

/// The balls of glossy dielectrics, one mixed with metal.
const DIELECTRICS: &str = "
colour = [0.7, 0.2, 0.1]
metallic = 0
roughness = 0.3
[[object]]
shape = { sphere = { radius = 0.4, subdivisions = 6 } }
transform = { translate = [0.3, 0.4, 1.3] }
colour = [0.2, 0.5, 0.8]
metallic = 0.4
roughness = 0.6
[[light]]
position = [1.5, 3, 2]
intensity = [20, 18, 15]
[sky]
image = { file = \"sky.exr\" }
";

#[test]
fn glossy_dielectrics_at_rest_are_those_of_mitsuba_with_the_published_model() {
    let folder = tempfile::tempdir().unwrap();
    write_sky(&folder.path().join("sky.exr"));
    // An index of 1.7 in place of 1.5, or a metalness of 0.05 in place of 0, is beyond both bounds.
    check(
        "dielectric",
        DIELECTRICS,
        folder.path(),
        ([28, 21], 64),
        0.003,
        40,
    );
}

/// The room of generate.py that is open in front, with up to four bounces; what follows says how the panel shines in time.
const BOUNCES: &str = "
[render]
bounces = 4
[display]
back_faces = \"black\"
[camera]
eye = [0, 1, 4.4]
look_at = [0, 0.95, 0]
hfov = \"36 deg\"
[[object]]
shape = { plane = { size = [2, 2] } }
colour = [0.7, 0.7, 0.7]
[[object]]
shape = { plane = { size = [2, 2] } }
transform = { translate = [0, 2, 0], rotate = { axis = [1, 0, 0], angle = \"180 deg\" } }
colour = [0.7, 0.7, 0.7]
[[object]]
shape = { plane = { size = [2, 2] } }
transform = { translate = [0, 1, -1], rotate = { axis = [1, 0, 0], angle = \"90 deg\" } }
colour = [0.5, 0.6, 0.8]
[[object]]
shape = { plane = { size = [2, 2] } }
transform = { translate = [-1, 1, 0], rotate = { axis = [0, 0, 1], angle = \"-90 deg\" } }
colour = [0.75, 0.2, 0.15]
[[object]]
shape = { plane = { size = [2, 2] } }
transform = { translate = [1, 1, 0], rotate = { axis = [0, 0, 1], angle = \"90 deg\" } }
colour = [0.2, 0.6, 0.2]
[[object]]
name = \"panel\"
shape = { plane = { size = [0.8, 0.6] } }
transform = { translate = [0.1, 1.9, 0], rotate = { axis = [1, 0, 0], angle = \"180 deg\" } }
colour = [0, 0, 0]
[[object]]
shape = { box = { size = [0.5, 0.6, 0.5] } }
transform = { translate = [0.45, 0.3, 0.3] }
colour = [0.7, 0.6, 0.3]
[[object]]
shape = { sphere = { radius = 0.45, subdivisions = 6 } }
transform = { translate = [-0.45, 0.45, -0.4] }
colour = [1, 1, 1]
metallic = 1
roughness = 0
[[object]]
shape = { sphere = { radius = 0.3, subdivisions = 6 } }
transform = { translate = [-0.3, 0.3, 0.5] }
colour = [1, 1, 1]
roughness = 0
transmission = 1
ior = 1.5
[[light]]
type = \"area\"
object = \"panel\"
radiance = [12, 10, 8]
";

#[test]
fn light_that_bounces_is_that_of_mitsuba() {
    let scene = sized(BOUNCES, Path::new("."), [28, 21], 256);
    let plan = Plan::new(&scene, &Request::default()).unwrap();
    let film = render(&Prepared::new(&scene, &plan, &Silent).unwrap(), &Silent).unwrap();
    check_bounces(film.radiance());
}

#[test]
fn light_that_is_baked_adds_up_over_all_times_to_that_of_mitsuba() {
    let flash = "emission = { gaussian = { time = \"0 m\", sigma = \"0.1 m\" } }";
    let scene = sized(&format!("{BOUNCES}{flash}"), Path::new("."), [28, 21], 256);
    let plan = Plan::new(&scene, &Request::default()).unwrap();
    let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    // The camera is 3.4 m from the opening; six ways through the room, partly in glass, are shorter than 30 m.
    let bins = Bins {
        start: 2.0,
        width: 1.0,
        count: 30,
    };
    let precision = CubePrecision::Single;
    let baked = bake::camera_cube(&scene, &prepared, &bins, precision, None, &Silent).unwrap();
    let value = |at: usize| baked.cube.samples.get(at).unwrap();
    // ∫ exp(−t²/2σ²) dt = √(2π) σ.
    let energy = std::f64::consts::TAU.sqrt() * 0.1;
    let pixel = |pixel: usize| {
        [0, 1, 2].map(|c| {
            let values = (0..bins.count).map(|bin| value((pixel * bins.count + bin) * 3 + c));
            values.sum::<f64>() / energy
        })
    };
    check_bounces(&(0..28 * 21).map(pixel).collect::<Vec<_>>());
}

/// Compares a picture of the room of 256 samples with Mitsuba's. With twelve seeds the mean over the picture was off by 0.25 % rms, the
/// median of means over 4 × 3 pixels by 0.2 %, and the worst of these, in and above the caustic, by 7 to 9 %: the limits are four times
/// that. With three bounces the median is 3.3 % lower, with five 1.0 % higher; without the mirror it is 2.5 % lower; without the glass one
/// of the means is 47 % off.
fn check_bounces(got: &[[f64; 3]]) {
    let (width, height) = (28, 21);
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/mitsuba/bounces.npy");
    let expected = reference(&file, [width, height]);
    // Over so many pixels from a corner on.
    let ratio = |c: usize, [x, y]: [usize; 2], [w, h]: [usize; 2]| {
        let pixels = (y..y + h).flat_map(|j| (x..x + w).map(move |i| j * width + i));
        let sums = pixels.fold([0.0; 2], |[a, b], k| [a + got[k][c], b + expected[k][c]]);
        sums[0] / sums[1]
    };
    let mut parts = Vec::new();
    for c in 0..3 {
        let whole = ratio(c, [0, 0], [width, height]);
        assert!((whole - 1.0).abs() < 0.01, "channel {c}: {whole}");
        for corner in (0..7).flat_map(|j| (0..7).map(move |i| [4 * i, 3 * j])) {
            let part = ratio(c, corner, [4, 3]);
            let most = if corner[1] < 15 { 0.28 } else { 0.36 };
            assert!((part - 1.0).abs() < most, "channel {c}, {corner:?}: {part}");
            parts.push(part);
        }
    }
    parts.sort_by(f64::total_cmp);
    let median = parts[parts.len() / 2];
    assert!((median - 1.0).abs() < 0.008, "median {median}");
}

/// A scene of this size, with so many samples per pixel.
fn sized(text: &str, folder: &Path, size: [usize; 2], samples: u32) -> Scene {
    let overrides = Overrides {
        size: Some(size.map(|n| n as u32)),
        samples_per_pixel: Some(samples),
        ..Overrides::default()
    };
    scene::parse(text, "mitsuba", folder, &overrides).unwrap()
}

/// Renders the room with `rest`, with so many samples per pixel: the mean of each channel has to be that of Mitsuba but for a part `mean`,
/// and pixels have to be those of Mitsuba but for one in `most_off`. Those may be off by noise, at edges and in highlights, and because
/// masking and shadowing of GGX are correlated here and not there.
fn check(
    name: &str,
    rest: &str,
    folder: &Path,
    (size, samples): ([usize; 2], u32),
    mean: f64,
    most_off: usize,
) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/mitsuba");
    let expected = reference(&file.join(name).with_extension("npy"), size);
    let scene = sized(&format!("{ROOM}{rest}"), folder, size, samples);
    let plan = Plan::new(&scene, &Request::default()).unwrap();
    let film = render(&Prepared::new(&scene, &plan, &Silent).unwrap(), &Silent).unwrap();
    let got = film.radiance();
    assert_eq!(got.len(), expected.len());
    for c in 0..3 {
        let of = |image: &[[f64; 3]]| image.iter().map(|p| p[c]).sum::<f64>() / image.len() as f64;
        let (a, b) = (of(got), of(&expected));
        assert!((a - b).abs() < mean * b, "{name}, channel {c}: {a} {b}");
    }
    let off = |k: &usize| {
        (0..3).any(|c| (got[*k][c] - expected[*k][c]).abs() > 0.06 * expected[*k][c] + 0.004)
    };
    let off = (0..got.len()).filter(off).count();
    let count = got.len();
    assert!(off < count / most_off, "{name}: {off} of {count} pixels");
}

/// The picture of the sky of generate.py.
fn write_sky(file: &Path) {
    let (width, height) = (128, 64);
    let pi = std::f64::consts::PI;
    let texel = |k: usize| {
        let latitude = pi * (0.5 - ((k / width) as f64 + 0.5) / height as f64);
        let longitude = pi * (((k % width) as f64 + 0.5) / height as f64 - 1.0);
        let (across, y) = (latitude.cos(), latitude.sin());
        let (x, z) = (across * longitude.sin(), -across * longitude.cos());
        0.5 + 0.3 * y + 0.15 * x - 0.1 * z
    };
    let channel = |(name, factor): (&str, f64)| Channel {
        name: name.into(),
        samples: Samples::F32(
            (0..width * height)
                .map(|k| (factor * texel(k)) as f32)
                .collect(),
        ),
    };
    let channels = [("R", 1.0), ("G", 0.8), ("B", 0.6)].map(channel).into();
    let layers = Layers::new(width as u32, height as u32, channels, vec![]).unwrap();
    exr::write(file, &layers).unwrap();
}

/// An array of this many columns and rows.
fn reference(file: &Path, [width, height]: [usize; 2]) -> Vec<[f64; 3]> {
    let bytes = std::fs::read(file).unwrap();
    // NumPy's header ends at a multiple of 64 bytes with a line feed; the rest is f32, little-endian.
    let data = &bytes[bytes.len() - width * height * 3 * 4..];
    let value = |b: &[u8]| f64::from(f32::from_le_bytes(b.try_into().unwrap()));
    let values: Vec<f64> = data.chunks_exact(4).map(value).collect();
    values.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect()
}
