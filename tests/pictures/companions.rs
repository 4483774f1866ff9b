//! Infrared and ultraviolet channels of cubes and pictures: what shifts into view from them.
//!
//! The spectrum of five channels is summed here from its definition over 0.025 nm of the observer's wavelengths: the colours between 360
//! and 830 nm, and beyond them the constant values of the white at 830 nm up to 3500 nm and at 360 nm down to 100 nm, times the channels. W
//! is that of the picture's own channel, which other tests compare with closed forms.

use std::path::Path;
use std::sync::Arc;

use nullray::colour::{Continuation, Spectrum, colour_matching, rgb_from_xyz};
#[cfg(any(feature = "hdf5", feature = "zarr"))]
use nullray::io::cube::Changes;
use nullray::io::cube::{self, Channels, Cube, CubeSamples, Wanted};
use nullray::io::image::{Channel, Layers, Samples, exr, npz};
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::render::metadata::metadata;
use nullray::render::plan::{Plan, Request};
use nullray::scene::model::{Scene, Shape};
use nullray::scene::{Builder, Value};

use crate::pipeline::stage;

/// Rows and columns of the picture.
const SIZE: [usize; 2] = [5, 7];

/// The names in the order of the arrays, and which of red, green, blue, infrared, ultraviolet each is.
const ORDER: [(&str, usize); 5] = [("IR", 3), ("B", 2), ("R", 0), ("UV", 4), ("G", 1)];

/// Red, green, blue, infrared and ultraviolet at row i, column j: each linear along both axes, none like another.
fn value(i: f64, j: f64) -> [f64; 5] {
    [
        0.2 + 0.1 * i + 0.03 * i * j,
        0.9 - 0.1 * i + 0.05 * j,
        0.3 + 0.07 * j,
        1.5 - 0.2 * i + 0.1 * j,
        0.4 + 0.2 * i + 0.02 * i * j,
    ]
}

/// What is seen at W of a surface with these channels: 18,800 terms.
fn seen(channels: [f64; 5], w: f64) -> [f64; 3] {
    let [r, g, b, infrared, ultraviolet] = channels;
    let colours = Spectrum::rgb([r, g, b], Continuation::Dark);
    // A constant continuation is the value at its end.
    let white = Spectrum::rgb([1.0; 3], Continuation::Edge);
    let ends = [900e-9, 300e-9].map(|l| white.per_wavelength(l));
    let mut xyz = [0.0; 3];
    for k in 0..18_800 {
        let l = 360.0125 + 0.025 * f64::from(k);
        let radiance = match l / w {
            at if !(100.0..=3500.0).contains(&at) => 0.0,
            at if at > 830.0 => infrared * ends[0],
            at if at < 360.0 => ultraviolet * ends[1],
            at => colours.per_wavelength(at * 1e-9),
        };
        let m = colour_matching(l * 1e-9);
        (0..3).for_each(|j| xyz[j] += radiance / w.powi(5) * 0.025e-9 * m[j]);
    }
    rgb_from_xyz(xyz)
}

/// Asserts that pixel `i` of `film` shows these channels; says its W.
#[track_caller]
fn check(film: &Film, i: usize, channels: [f64; 5]) -> f64 {
    let w = stage::value(film, Aov::WavelengthRatio, i);
    let (got, expected) = (film.radiance()[i], seen(channels, w));
    // 1e-4 of the table, and as much of the sum, which is off by half a term where a band ends.
    let size = expected.iter().fold(w.powi(-5), |a, c| a.max(c.abs()));
    for (got, expected) in got.into_iter().zip(expected) {
        let error = (got - expected).abs() / size;
        assert!(error < 4e-4, "W = {w}: {got} is not {expected}");
    }
    w
}

/// The picture as an array, in an archive, and as an EXR picture.
fn write(folder: &Path) {
    let [h, w] = SIZE;
    let at = |n: usize| value((n / w) as f64, (n % w) as f64);
    let samples = (0..h * w).flat_map(|n| ORDER.map(|(_, c)| at(n)[c]));
    let cube = Cube::new([h, w, 1, 5], CubeSamples::F64(samples.collect())).unwrap();
    npz::write_cube(&folder.join("five.npy"), &cube).unwrap();
    // An archive of one stored member.
    let array = std::fs::read(folder.join("five.npy")).unwrap();
    std::fs::write(folder.join("five.npz"), stored_archive("five.npy", &array)).unwrap();
    let channel = |(name, c): (&str, usize)| Channel {
        name: if c < 3 {
            format!("radiance.{name}")
        } else {
            name.into()
        },
        samples: Samples::F32((0..h * w).map(|n| at(n)[c] as f32).collect()),
    };
    let layers = Layers::new(w as u32, h as u32, ORDER.map(channel).into(), Vec::new()).unwrap();
    exr::write(&folder.join("five.exr"), &layers).unwrap();
}

/// A zip archive of one member that is not compressed (PKWARE APPNOTE, 4.3).
fn stored_archive(name: &str, data: &[u8]) -> Vec<u8> {
    let mut crc = u32::MAX;
    for byte in data {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg());
        }
    }
    let common = |out: &mut Vec<u8>| {
        for field in [20u16, 0, 0, 0, 0x21] {
            out.extend(field.to_le_bytes());
        }
        for field in [!crc, data.len() as u32, data.len() as u32] {
            out.extend(field.to_le_bytes());
        }
        out.extend((name.len() as u16).to_le_bytes());
        out.extend([0, 0]);
    };
    let mut out = b"PK\x03\x04".to_vec();
    common(&mut out);
    out.extend(name.bytes());
    out.extend(data);
    let directory = out.len();
    out.extend(b"PK\x01\x02\x14\x00");
    common(&mut out);
    out.extend([0; 14]);
    out.extend(name.bytes());
    let size = out.len() - directory;
    out.extend(b"PK\x05\x06\x00\x00\x00\x00\x01\x00\x01\x00");
    out.extend((size as u32).to_le_bytes());
    out.extend((directory as u32).to_le_bytes());
    out.extend([0, 0]);
    out
}

/// The names of the arrays' channels, as the scene has them.
fn names() -> String {
    format!("channels = {:?}", ORDER.map(|(name, _)| name))
}

/// A wall of 4 × 4 m, from which a camera 2 m away flies with this speed, or to which, below 0.
fn wall(keys: &str, beta: f64) -> String {
    format!(
        "[radiance]\nquantity = \"rgb\"\n\
         [camera]\neye = [0, 0, 2]\nlook_at = [0, 0, 0]\nhfov = \"10 deg\"\nsize = [6, 4]\n\
         velocity = {{ beta = [0, 0, {beta}] }}\n\
         [[object]]\nname = \"wall\"\nshape = {{ plane = {{ size = [4, 4] }} }}\n\
         transform = {{ rotate = {{ axis = [1, 0, 0], angle = \"90 deg\" }} }}\n\
         [[source]]\n[source.cube]\n{keys}\n"
    )
}

/// Checks every pixel of `scene` against the picture; says the range of W.
#[track_caller]
fn check_wall(scene: &Scene) -> [f64; 2] {
    let film = stage::film(scene);
    let mut range = [f64::INFINITY, 0.0f64];
    let met = stage::met(&film);
    for i in &met {
        let [u, v] = [Aov::UvU, Aov::UvV].map(|aov| stage::value(&film, aov, *i));
        let [h, w] = SIZE.map(|n| n as f64);
        let place = |at: f64, n: f64| (at * n - 0.5).clamp(0.0, n - 1.0);
        let w = check(&film, *i, value(place(v, h), place(u, w)));
        range = [range[0].min(w), range[1].max(w)];
    }
    assert!(met.len() > 5);
    range
}

#[test]
fn five_channels_are_seen_as_the_spectrum_that_they_stand_for() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    let mut range = [f64::INFINITY, 0.0f64];
    for (file, axes, betas) in [
        (
            "five.npy",
            "axes = \"H W 1 C\"",
            &[-0.97, -0.9, -0.5, 0.0, 0.3, 0.7, 0.97][..],
        ),
        ("five.npz", "axes = \"H W 1 C\"", &[-0.6]),
        ("five.exr", "", &[0.5]),
    ] {
        let keys = format!("file = \"{file}\"\n{axes}\n{}", names());
        for beta in betas {
            let [low, high] = check_wall(&stage::scene_in(folder.path(), &wall(&keys, *beta)));
            range = [range[0].min(low), range[1].max(high)];
        }
    }
    // From where the infrared begins to leave the view again to where the ultraviolet does.
    assert!(range[0] < 0.2 && range[1] > 4.0, "{range:?}");
}

#[test]
fn a_false_colour_shows_the_infrared_at_rest() {
    // The eye that sees 1110 nm as 555 nm sees at rest what the human one sees at W = 1/2, less W⁻⁴.
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    let keys = format!("file = \"five.npy\"\naxes = \"H W 1 C\"\n{}", names());
    let text = wall(&keys, 0.0) + "[display]\nfalse_colour = \"1110 nm\"\n";
    let film = stage::film(&stage::scene_in(folder.path(), &text));
    for i in stage::met(&film) {
        let [u, v] = [Aov::UvU, Aov::UvV].map(|aov| stage::value(&film, aov, i));
        let [h, w] = SIZE.map(|n| n as f64);
        let channels = value(
            (v * h - 0.5).clamp(0.0, h - 1.0),
            (u * w - 0.5).clamp(0.0, w - 1.0),
        );
        let expected = seen(channels, 0.5).map(|c| c / 16.0);
        for (got, expected) in film.radiance()[i].into_iter().zip(expected) {
            assert!(
                (got - expected).abs() < 4e-4 * 2.0,
                "{got} is not {expected}"
            );
        }
    }
}

/// A cube in time whose channels are c_k (1 + 0.05 t) of its object's time, over bins of 0.5 m from −30 m on.
#[test]
fn a_source_in_motion_shows_its_companions_at_its_own_time() {
    const CHANNELS: [f64; 5] = [0.5, 0.2, 0.7, 1.2, 0.6];
    let folder = tempfile::tempdir().unwrap();
    let samples = (0..2 * 2 * 120).flat_map(|n: usize| {
        let t = -30.0 + 0.5 * ((n % 120) as f64 + 0.5);
        ORDER.map(|(_, c)| CHANNELS[c] * (2.0 + 0.05 * t))
    });
    let cube = Cube::new([2, 2, 120, 5], CubeSamples::F64(samples.collect())).unwrap();
    npz::write_cube(&folder.path().join("moving.npy"), &cube).unwrap();
    for beta in [[0.0, 0.0, 0.8], [0.0, 0.0, -0.7], [0.6, 0.0, 0.3]] {
        let text = format!(
            "[radiance]\nquantity = \"rgb\"\n\
             [camera]\neye = [0.1, 0.2, 6]\nlook_at = [0, 0, 0]\nhfov = \"40 deg\"\nsize = [6, 5]\n\
             time = \"6 m\"\nvelocity = {{ beta = [0.1, -0.2, 0.3] }}\n\
             [[object]]\nname = \"wall\"\nshape = {{ plane = {{ size = [6, 6] }} }}\n\
             transform = {{ rotate = {{ axis = [1, 0, 0], angle = \"90 deg\" }} }}\n\
             velocity = {{ beta = {beta:?} }}\n\
             [[source]]\n[source.cube]\nfile = \"moving.npy\"\n{}\nstart = \"-30 m\"\n\
             bin_width = \"0.5 m\"\nclock = \"object\"\nvalues = \"density\"\nfilter = \"linear\"\n",
            names()
        );
        let film = stage::film(&stage::scene_in(folder.path(), &text));
        let met = stage::met(&film);
        assert!(met.len() > 3, "{beta:?}");
        for i in met {
            let t = stage::value(&film, Aov::ObjectEventCt, i);
            check(&film, i, CHANNELS.map(|c| c * (2.0 + 0.05 * t)));
        }
    }
}

/// Captures that hold the same everywhere, one or two of them, with channels in other orders.
#[test]
fn captures_hold_companions_and_so_do_means_over_what_samples_stand_for() {
    const CHANNELS: [f64; 5] = [0.5, 0.2, 0.7, 1.2, 0.6];
    let folder = tempfile::tempdir().unwrap();
    let mut names = Vec::new();
    for (file, order) in [("a.npy", [0, 1, 2, 3, 4]), ("b.npy", [4, 0, 3, 2, 1])] {
        let samples = (0..16 * 16 * 40).flat_map(|_| order.map(|k| CHANNELS[ORDER[k].1]));
        let cube = Cube::new([16, 16, 40, 5], CubeSamples::F64(samples.collect())).unwrap();
        npz::write_cube(&folder.path().join(file), &cube).unwrap();
        names.push(order.map(|k| ORDER[k].0));
    }
    let source = |k: usize, keys: &str| {
        format!(
            "[[source]]\n[source.cube]\nfile = \"{}.npy\"\nchannels = {:?}\nstart = \"-20 m\"\n\
             bin_width = \"1 m\"\nvalues = \"density\"\nclock = \"capture\"\n{keys}\n\
             [source.cube.capture]\neye = [{k}, 0, 2]\nlook_at = [0, 0, 0]\nhfov = \"80 deg\"\n",
            ["a", "b"][k],
            names[k],
        )
    };
    let sharp = "reconstruction = \"sharp\"";
    let footprint = "reconstruction = \"footprint\"";
    let exposed = "\n[camera.shutter]\nduration = \"0.5 m\"\nintegration = \"means\"\n";
    for sources in [
        source(0, ""),
        source(1, ""),
        source(0, sharp),
        source(0, footprint),
        source(0, "") + &source(1, ""),
        source(1, footprint) + &source(0, footprint) + exposed,
        source(0, "") + exposed,
    ] {
        let text = format!(
            "[radiance]\nquantity = \"rgb\"\n\
             [camera]\neye = [0, 0, 2]\nlook_at = [0, 0, 0]\nhfov = \"20 deg\"\nsize = [5, 4]\n\
             velocity = {{ beta = [0, 0, -0.6] }}\n\
             [[object]]\nname = \"wall\"\nshape = {{ plane = {{ size = [4, 4] }} }}\n\
             transform = {{ rotate = {{ axis = [1, 0, 0], angle = \"90 deg\" }} }}\n{sources}"
        );
        let film = stage::film(&stage::scene_in(folder.path(), &text));
        let met = stage::met(&film);
        assert_eq!(met.len(), 20);
        for i in met {
            check(&film, i, CHANNELS);
        }
    }
}

fn bits(film: &Film) -> Vec<u64> {
    film.radiance()
        .iter()
        .flatten()
        .map(|c| c.to_bits())
        .collect()
}

#[test]
fn without_companions_pictures_are_those_of_a_dark_continuation_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    let [h, w] = SIZE;
    let at = |n: usize| value((n / w) as f64, (n % w) as f64);
    let samples = (0..h * w).flat_map(|n| at(n)[..3].to_vec());
    let three = Cube::new([h, w, 1, 3], CubeSamples::F64(samples.collect())).unwrap();
    npz::write_cube(&folder.path().join("three.npy"), &three).unwrap();
    let samples = (0..h * w).flat_map(|n| [at(n)[0], at(n)[1], at(n)[2], 0.0, 0.0]);
    let five = Cube::new([h, w, 1, 5], CubeSamples::F64(samples.collect())).unwrap();
    npz::write_cube(&folder.path().join("zeros.npy"), &five).unwrap();
    for beta in [-0.45, 0.5] {
        let film = |file: &str, channels: &str, continuation: &str| {
            let keys = format!("file = \"{file}\"\naxes = \"H W 1 C\"\n{channels}");
            let text = wall(&keys, beta).replace(
                "quantity = \"rgb\"",
                &format!("quantity = \"rgb\"\ncontinuation = \"{continuation}\""),
            );
            bits(&stage::film(&stage::scene_in(folder.path(), &text)))
        };
        let dark = film("three.npy", "", "dark");
        assert!(dark.iter().any(|bits| *bits != 0));
        let named = "channels = [\"R\", \"G\", \"B\", \"IR\", \"UV\"]";
        assert!(film("zeros.npy", named, "companions") == dark);
        assert!(film("three.npy", "", "companions") == dark);
        // Companions that the scene does not ask for.
        assert!(film("five.npy", &names(), "dark") == dark);
        assert!(film("five.npy", &names(), "companions") != dark);
        // Colours in another order, without companions.
        let edge = film("three.npy", "", "edge");
        assert!(film("five.npy", &names(), "edge") == edge);
        assert!(film("three.npy", "channels = [\"R\", \"G\", \"B\"]", "edge") == edge);
        assert!(film("three.npy", "channels = [\"B\", \"G\", \"R\"]", "edge") != edge);
    }
}

#[test]
fn a_cube_in_memory_has_companions_too() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    let channels = Channels::named(ORDER.map(|(name, _)| name)).unwrap();
    let wanted = Wanted {
        axes: Some(&"H W 1 C".parse().unwrap()),
        channels: Some(&channels),
        ..Wanted::default()
    };
    let cube = cube::load(&folder.path().join("five.npy"), wanted).unwrap();
    assert_eq!(cube.shape, [5, 7, 1, 5]);
    let memory = |names: &[&str]| {
        Builder::new("memory")
            .set("radiance.quantity", "rgb")
            .set("camera.eye", [0.0, 0.0, 3.0])
            .set("camera.look_at", [0.0, 0.0, 0.0])
            .set("camera.size", [6, 4])
            .set("camera.velocity.beta", [0.0, 0.0, -0.7])
            .shape("box", Shape::Box { size: [2.0; 3] })
            .cube("five", Arc::new(cube.clone()), 2e9)
            .set("source.five.cube.channels", Value::from(names.to_vec()))
            .set("source.five.cube.start", "-1e9 m")
            .set("source.five.cube.values", "density")
            .set("source.five.cube.filter", "nearest")
            .build()
    };
    let text = format!(
        "[radiance]\nquantity = \"rgb\"\n\
         [camera]\neye = [0, 0, 3]\nlook_at = [0, 0, 0]\nsize = [6, 4]\nvelocity.beta = [0, 0, -0.7]\n\
         [[object]]\nshape = {{ box = {{ size = [2, 2, 2] }} }}\n\
         [[source]]\n[source.cube]\nfile = \"five.npy\"\naxes = \"H W 1 C\"\n{}\n",
        names()
    );
    let file = stage::film(&stage::scene_in(folder.path(), &text));
    let all = ORDER.map(|(name, _)| name);
    assert!(bits(&stage::film(&memory(&all).unwrap())) == bits(&file));
    assert!(bits(&file).iter().any(|bits| *bits != 0));
    let refused = memory(&["R", "G", "B", "IR"]).unwrap_err().to_string();
    assert!(
        refused.contains("4 channels are named, but the cube has 5"),
        "{refused}"
    );
}

#[test]
fn metadata_and_the_plan_say_what_is_beyond() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    let keys = format!("file = \"five.npy\"\naxes = \"H W 1 C\"\n{}", names());
    let scene = stage::scene_in(folder.path(), &wall(&keys, -0.5));
    let film = stage::film(&scene);
    let said = metadata(&scene, &film).unwrap();
    let entry = |key: &str| said.iter().find(|(k, _)| k == key).map(|(_, v)| v.as_str());
    assert_eq!(entry("radiance_continuation"), Some("companions"));
    let metres = |key: &str| -> Vec<f64> {
        let numbers = entry(key).unwrap().split(' ');
        numbers.map(|n| n.parse().unwrap()).collect()
    };
    for (key, [from, to]) in [
        ("infrared_channel_m", [830e-9, 3500e-9]),
        ("ultraviolet_channel_m", [100e-9, 360e-9]),
    ] {
        let found = metres(key);
        stage::assert_relative(found[0], from, 1e-12, key);
        stage::assert_relative(found[1], to, 1e-12, key);
    }
    assert_eq!(entry("infrared_channel_m"), Some("8.3e-7 3.5e-6"));
    assert_eq!(entry("ultraviolet_channel_m"), Some("1e-7 3.6e-7"));
    let notes = |text: &str| {
        let scene = stage::scene_in(folder.path(), text);
        Plan::new(&scene, &Request::default())
            .unwrap()
            .notes
            .join("\n")
    };
    let said = notes(&wall(&keys, -0.5));
    assert!(
        said.contains("source \"five\": IR is its radiance from 830 to 3500 nm, UV"),
        "{said}"
    );
    let dark = wall(&keys, -0.5).replace("\"rgb\"", "\"rgb\"\ncontinuation = \"dark\"");
    let said = notes(&dark);
    assert!(
        said.contains("IR and UV are not used: radiance.continuation is \"dark\""),
        "{said}"
    );
    let without = wall("file = \"five.exr\"", -0.5)
        .replace("\"rgb\"", "\"rgb\"\ncontinuation = \"companions\"");
    let said = notes(&without);
    assert!(
        said.contains("source \"five\" without infrared or ultraviolet"),
        "{said}"
    );
    // Existing pictures say what they said.
    let plain = stage::scene_in(folder.path(), &wall("file = \"five.exr\"", -0.5));
    let said = metadata(&plain, &stage::film(&plain)).unwrap();
    assert!(
        said.iter()
            .any(|(k, v)| k == "radiance_continuation" && v == "blackbody")
    );
    assert!(!said.iter().any(|(k, _)| k.contains("infrared")));
}

#[cfg(any(feature = "hdf5", feature = "zarr"))]
#[test]
fn arrays_in_chunks_hold_companions() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    let channels = Channels::named(ORDER.map(|(name, _)| name)).unwrap();
    let wanted = Wanted {
        axes: Some(&"H W 1 C".parse().unwrap()),
        channels: Some(&channels),
        ..Wanted::default()
    };
    let from = folder.path().join("five.npy");
    let forms = [
        #[cfg(feature = "hdf5")]
        "five.h5",
        #[cfg(feature = "zarr")]
        "five.zarr",
    ];
    for form in forms {
        let to = folder.path().join(form);
        cube::convert((&from, wanted), &to, &Changes::default(), &mut |_, _| true).unwrap();
        let keys = format!("file = \"{form}\"\naxes = \"H W 1 C\"\n{}", names());
        check_wall(&stage::scene_in(folder.path(), &wall(&keys, -0.6)));
    }
}

/// A mirror shows the wall behind the camera, in its own motion: what falls onto it is seen of all five channels, and what it
/// sends on has red, green and blue alone.
///
/// A mirror that moves with βc away from the wall sees it along n, in its own frame, with W = γ (1 − β n_z); n is the look direction
/// of the camera with its part along z reversed. A camera at rest with the mirror adds no shift; another one adds that of its channel.
#[test]
fn a_mirror_in_motion_shows_companions_of_what_falls_onto_it() {
    const CHANNELS: [f64; 5] = [0.5, 0.2, 0.7, 1.2, 0.6];
    let folder = tempfile::tempdir().unwrap();
    let samples = (0..4).flat_map(|_| ORDER.map(|(_, c)| CHANNELS[c]));
    let cube = Cube::new([2, 2, 1, 5], CubeSamples::F64(samples.collect())).unwrap();
    npz::write_cube(&folder.path().join("even.npy"), &cube).unwrap();
    for (mirror, camera) in [
        (0.0, 0.0),
        (0.4, 0.4),
        (-0.4, -0.4),
        (0.8, 0.8),
        (-0.8, -0.8),
        (-0.3, 0.2),
        (0.2, -0.1),
    ] {
        let text = format!(
            "[radiance]\nquantity = \"rgb\"\n[render]\nbounces = 1\n[sky]\nradiance = 0\n\
             [camera]\neye = [0, 0, 1]\nlook_at = [0, 0, 3]\nhfov = \"30 deg\"\nsize = [5, 4]\n\
             velocity = {{ beta = [0, 0, {camera}] }}\n\
             [[object]]\nname = \"wall\"\nshape = {{ plane = {{ size = [400, 400] }} }}\n\
             transform = {{ rotate = {{ axis = [1, 0, 0], angle = \"90 deg\" }} }}\n\
             [[object]]\nname = \"mirror\"\nshape = {{ plane = {{ size = [40, 40] }} }}\n\
             transform = {{ rotate = {{ axis = [1, 0, 0], angle = \"-90 deg\" }}, translate = [0, 0, 3] }}\n\
             metallic = 1\nroughness = 0\ncolour = [1, 1, 1]\nvelocity = {{ beta = [0, 0, {mirror}] }}\n\
             [[source]]\nobjects = [\"wall\"]\n[source.cube]\nfile = \"even.npy\"\naxes = \"H W 1 C\"\n{}\n",
            names()
        );
        let film = stage::film(&stage::scene_in(folder.path(), &text));
        let met = stage::met(&film);
        assert_eq!(met.len(), 20);
        for i in met {
            // The look direction as the mirror has it (aberration), and after the mirror.
            let z = stage::value(&film, Aov::DirectionZ, i);
            let z = (z + mirror) / (1.0 + mirror * z);
            let w = (1.0 + mirror * z) / f64::sqrt(1.0 - mirror * mirror);
            let [r, g, b] = seen(CHANNELS, w);
            let on = stage::value(&film, Aov::WavelengthRatio, i);
            let expected = match mirror == camera {
                true => [r, g, b],
                false => seen([r, g, b, 0.0, 0.0], on),
            };
            let size =
                [r, g, b].iter().fold(w.powi(-5), |a, c| a.max(c.abs())) * on.powi(-5).max(1.0);
            for (got, expected) in film.radiance()[i].into_iter().zip(expected) {
                let error = (got - expected).abs() / size;
                assert!(
                    error < 6e-4,
                    "{mirror} {camera}: W = {w}, {on}: {got} is not {expected}"
                );
            }
        }
    }
}
