//! `nullray convert`: round trips, parts, merged bins, clocks.

use std::path::Path;

use nullray::io::cube::{self, Axes, Cube, CubeSamples, Wanted};
use nullray::io::image::npz;

use super::refused::refused;
use super::{Folder, repository};

fn load(folder: &Folder, name: &str, axes: Option<&str>) -> Cube {
    let axes: Option<Axes> = axes.map(|axes| axes.parse().unwrap());
    let wanted = Wanted {
        axes: axes.as_ref(),
        ..Wanted::default()
    };
    cube::load(&folder.path(name), wanted).unwrap()
}

fn values(cube: &Cube) -> Vec<f64> {
    (0..cube.samples.len())
        .filter_map(|at| cube.samples.get(at))
        .collect()
}

fn input() -> String {
    repository("tests/data/mitransient/near_clip.npz")
}

/// The cube of `input`: 32 rows, 40 columns, 90 bins, grey, half precision.
fn original() -> Cube {
    cube::load(Path::new(&input()), Wanted::default()).unwrap()
}

#[test]
fn cubes_go_through_all_formats_and_come_back_bit_for_bit() {
    let folder = Folder::empty();
    folder.ok(&["convert", &input(), "-o", "a.npy", "--to-axes", "T H W"]);
    folder.ok(&["convert", "a.npy", "--axes", "T H W", "-o", "b.npz"]);
    folder.ok(&["convert", "b.npz", "-o", "frames", "--type", "f16"]);
    folder.ok(&["convert", "frames", "-o", "c.npy", "--type", "f16"]);
    folder.ok(&[
        "convert",
        "frames/{i:03d}.exr",
        "-o",
        "d.npz",
        "--type",
        "f64",
    ]);
    let original = original();
    for name in ["b.npz", "c.npy"] {
        assert_eq!(load(&folder, name, None), original, "{name}");
    }
    assert_eq!(load(&folder, "a.npy", Some("T H W")), original);
    let wide = load(&folder, "d.npz", None);
    assert!(matches!(wide.samples, CubeSamples::F64(_)));
    assert_eq!(values(&wide), values(&original));
    assert_eq!(
        folder.names(),
        ["a.npy", "b.npz", "c.npy", "d.npz", "frames"]
    );
    // Ninety frames, the last of them 089.
    assert!(folder.path("frames/089.exr").exists() && !folder.path("frames/090.exr").exists());
}

#[test]
fn archives_keep_the_times_that_are_known() {
    let folder = Folder::empty();
    let times = ["--start", "4 m", "--bin-width", "0.1 m"];
    folder.ok(&[&["convert", &input(), "-o", "a.npz"][..], &times].concat());
    let said = folder.ok(&[
        "convert", "a.npz", "-o", "b.npz", "--bins", "20:80", "--merge", "4",
    ]);
    // Bin 20 begins at 4 m + 20 · 0.1 m.
    assert!(
        said.contains("start = \"6 m\", bin_width = \"0.4 m\""),
        "{said}"
    );
    let said = folder.ok(&["info", "b.npz"]);
    assert!(
        said.contains("start 6 m, bin_width 0.4 m, by its metadata"),
        "{said}"
    );
    assert!(
        said.contains("yes: as the file of a [source.cube]"),
        "{said}"
    );
    let lengths = [4.0f32; 32 * 40];
    npz::write_cube(
        &folder.path("d.npy"),
        &Cube::new([32, 40, 1, 1], CubeSamples::F32(lengths.into())).unwrap(),
    )
    .unwrap();
    let header = b"(32, 40, 1, 1)";
    let mut map = folder.read("d.npy");
    let at = map
        .windows(header.len())
        .position(|part| part == header)
        .unwrap();
    map[at..at + header.len()].copy_from_slice(b"(32, 40)      ");
    folder.write("d.npy", map);
    // Ten bins of the path of 4 m.
    let said = folder.ok(&["convert", "b.npz", "-o", "c.npz", "--unwarp", "d.npy"]);
    assert!(said.contains("start = \"2 m\""), "{said}");
    let kept = load(&folder, "c.npz", None);
    let sums = [load(&folder, "b.npz", None), kept].map(|cube| values(&cube).iter().sum::<f64>());
    assert!((sums[0] / sums[1] - 1.0).abs() < 1e-2, "{sums:?}");
}

#[test]
fn infrared_and_ultraviolet_of_frames_are_not_lost_without_a_word() {
    let folder = Folder::empty();
    let samples = (0..3 * 4 * 9 * 5).map(|n| 1.0 + n as f32).collect();
    let cube = Cube::new([3, 4, 9, 5], CubeSamples::F32(samples)).unwrap();
    npz::write_cube(&folder.path("a.npy"), &cube).unwrap();
    let channels = ["--channels", "R,G,B,IR,UV"];
    let said = folder.ok(&[&["convert", "a.npy", "-o", "frames"][..], &channels].concat());
    assert!(
        said.contains("9 time bins, channels R, G, B, IR, UV;"),
        "{said}"
    );
    let lost = "IR and UV beside R, G and B, which is left out";
    for command in [
        &["info", "frames"][..],
        &["convert", "frames", "-o", "b.npy"],
    ] {
        let said = folder.ok(command);
        // Rows of `info` are wrapped.
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains(lost), "{said}");
    }
    let said = folder.ok(&[&["convert", "frames", "-o", "c.npy"][..], &channels].concat());
    assert!(!said.contains(lost), "{said}");
    assert_eq!(folder.read("c.npy"), folder.read("a.npy"));
}

#[test]
fn cubes_are_compared_by_the_pictures_of_their_bins_as_compare_says() {
    let folder = Folder::empty();
    let cube = Cube::new([9, 8, 10, 1], CubeSamples::F32(vec![1.0; 720])).unwrap();
    npz::write_cube(&folder.path("a.npy"), &cube).unwrap();
    let run = folder.run(&["compare", "a.npy", "a.npy"]);
    let said = run.message();
    assert!(
        run.code == 2 && said.contains("nullray convert a.npy -o frames"),
        "{said}"
    );
    folder.ok(&["convert", "a.npy", "-o", "frames"]);
    let run = folder.run(&["compare", "frames", "frames"]);
    let said = run.message();
    assert!(
        run.code == 2 && said.contains("like frames/000.exr"),
        "{said}"
    );
    folder.ok(&["compare", "frames/000.exr", "frames/009.exr"]);
}

#[test]
fn parts_are_kept_and_bins_are_merged() {
    let folder = Folder::empty();
    let parts = [
        "--rows",
        "3:7",
        "--columns",
        "10:15",
        "--bins",
        "20:80",
        "--merge",
        "4",
        "--type",
        "f64",
    ];
    let said = folder.ok(&[
        &[
            "convert",
            &input(),
            "-o",
            "a.npy",
            "--start",
            "4 m",
            "--bin-width",
            "0.1 m",
        ],
        &parts[..],
    ]
    .concat());
    // 4 m + 20 bins of 0.1 m.
    assert!(
        said.contains("4 rows, 5 columns, 15 time bins, grey; f64"),
        "{said}"
    );
    assert!(
        said.contains("start = \"6 m\", bin_width = \"0.4 m\""),
        "{said}"
    );
    folder.ok(&[
        &["convert", &input(), "-o", "b.npy", "--density"],
        &parts[..],
    ]
    .concat());
    let (original, sums, means) = (
        original(),
        load(&folder, "a.npy", None),
        load(&folder, "b.npy", None),
    );
    for (row, column, bin) in [(0, 0, 0), (3, 4, 14), (2, 1, 7)] {
        let sum: f64 = (0..4)
            .map(|k| original.total((row + 3) * 40 + column + 10, 20 + 4 * bin + k))
            .sum();
        assert_eq!(sums.total(row * 5 + column, bin), sum);
        assert!((means.total(row * 5 + column, bin) - 0.25 * sum).abs() < 1e-15);
    }
}

/// The sum of a pixel's bins, and their mean time in bins.
fn moments(cube: &Cube, pixel: usize) -> (f64, f64) {
    let sum: f64 = (0..cube.shape[2]).map(|bin| cube.total(pixel, bin)).sum();
    let first: f64 = (0..cube.shape[2])
        .map(|bin| bin as f64 * cube.total(pixel, bin))
        .sum();
    (sum, first / sum)
}

/// A distance of r lies r/w bins back, and every sum stays.
#[test]
fn unwarping_takes_off_the_way_and_warping_puts_it_back() {
    let folder = Folder::empty();
    let original = original();
    let distance = |pixel: usize| 2.0 + 0.013 * pixel as f64;
    let mut map = b"\x93NUMPY\x01\x00".to_vec();
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (32, 40), }\n";
    map.extend((header.len() as u16).to_le_bytes());
    map.extend(header.bytes());
    map.extend((0..32 * 40).flat_map(|pixel| distance(pixel).to_le_bytes()));
    folder.write("map.npy", &map);
    let said = folder.ok(&[
        "convert",
        &input(),
        "-o",
        "world.npy",
        "--unwarp",
        "map.npy",
        "--bin-width",
        "0.1 m",
        "--start",
        "4 m",
        "--type",
        "f64",
    ]);
    let start: f64 = said
        .split("start = \"")
        .nth(1)
        .unwrap()
        .split(' ')
        .next()
        .unwrap()
        .parse()
        .unwrap();
    let world = load(&folder, "world.npy", None);
    for pixel in [0, 17, 640, 1279] {
        let (sum, mean) = moments(&original, pixel);
        let (moved, earlier) = moments(&world, pixel);
        if sum > 0.0 {
            assert!((moved / sum - 1.0).abs() < 1e-12, "{pixel}");
            // Times in metres: 4 + 0.1 mean less the distance.
            let expected = 4.0 + 0.1 * mean - distance(pixel);
            assert!((start + 0.1 * earlier - expected).abs() < 1e-9, "{pixel}");
        }
    }
    // Frames and parts of it, bin by bin, are the same numbers.
    folder.ok(&[
        "convert",
        &input(),
        "-o",
        "by_time.npy",
        "--unwarp",
        "map.npy",
        "--bin-width",
        "0.1 m",
        "--type",
        "f64",
        "--to-axes",
        "T H W",
    ]);
    assert_eq!(load(&folder, "by_time.npy", Some("T H W")), world);
    folder.ok(&[
        "convert",
        "world.npy",
        "-o",
        "back.npy",
        "--warp",
        "map.npy",
        "--bin-width",
        "0.1 m",
    ]);
    let back = load(&folder, "back.npy", None);
    let total = |cube: &Cube| values(cube).iter().sum::<f64>();
    assert!((total(&back) / total(&original) - 1.0).abs() < 1e-12);
}

/// Where there is no place for temporary files, those without it go on working.
#[cfg(all(unix, feature = "hdf5", feature = "zarr"))]
#[test]
fn arrays_in_chunks_are_converted_without_a_temporary_file() {
    let folder = Folder::empty();
    folder.ok(&["convert", &input(), "-o", "a.zarr"]);
    folder.ok(&["convert", &input(), "-o", "b.h5", "--to-axes", "T H W"]);
    let convert = |from: &str, to: &str| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_nullray"));
        command.args(["convert", from, "-o", to]);
        command
            .current_dir(folder.path(""))
            .env("TMPDIR", "/nowhere");
        let output = command.output().unwrap();
        (
            output.status.code(),
            String::from_utf8_lossy(&output.stderr).into_owned(),
        )
    };
    for (from, to) in [("a.zarr", "a.npy"), ("b.h5", "b.npy"), ("a.zarr", "frames")] {
        assert_eq!(
            convert(from, to).0,
            Some(0),
            "{from}: {}",
            convert(from, to).1
        );
    }
    assert_eq!(values(&load(&folder, "a.npy", None)), values(&original()));
    assert_eq!(values(&load(&folder, "b.npy", None)), values(&original()));
    // An archive is unpacked.
    let (code, said) = convert(&input(), "c.npy");
    assert!(
        code == Some(2) && said.contains("/nowhere") && said.contains("TMPDIR"),
        "{code:?} {said}"
    );
}

#[test]
fn what_cannot_be_converted_is_refused_and_leaves_nothing() {
    let folder = Folder::empty();
    folder.write("large.npy", large());
    let input = input();
    for (arguments, wrong) in [
        (&["-o", "a.png"][..], "cubes cannot be written as .png"),
        (&["-o", "a.npy", "--rows", "30:33"], "it has no rows 30:33"),
        (
            &["-o", "a.npy", "--merge", "4"],
            "90 bins cannot be merged by 4",
        ),
        (
            &["-o", "a.npy", "--bins", "7:8", "--merge", "2"],
            "merge at most 1",
        ),
        (
            &["-o", "a.npy", "--to-axes", "W H T"],
            "row by row or bin by bin",
        ),
        (&["-o", "a.npy", "--to-axes", "H W"], "there are 90 bins"),
        (
            &["-o", "a.npy", "--unwarp", "large.npy"],
            "width of a bin is not known",
        ),
        (
            &["-o", "a.npy", "--unwarp", "large.npy", "--bin-width", "1 m"],
            "distances of shape [1, 1, 1]",
        ),
        (
            &["-o", "frames", "--type", "f64"],
            "no samples of double precision",
        ),
        (&["-o", "a.npy", "--array", "x"], "there is no such array"),
        (&["-o", "large.npy/a.npy"], "no directory large.npy"),
    ] {
        refused(
            &folder,
            &[&["convert", input.as_str()], arguments].concat(),
            &[wrong],
        );
    }
    refused(
        &folder,
        &["convert", "large.npy", "-o", "a.npy", "--type", "f16"],
        &["f16 cannot hold a sample of 1e6"],
    );
    refused(
        &folder,
        &["convert", "large.npy", "-o", "large.npy"],
        &["this is an input file"],
    );
    // What is no cube is not called a broken one.
    for name in ["scene.toml", "unnamed"] {
        folder.write(name, "[camera]\n");
        refused(
            &folder,
            &["convert", name, "-o", "a.npy"],
            &[name, "not in a supported cube format", ".npz", "Zarr"],
        );
        std::fs::remove_file(folder.path(name)).unwrap();
    }
    assert_eq!(folder.names(), ["large.npy"]);
}

#[test]
fn frames_say_their_own_precision_and_hold_no_infinity() {
    let folder = Folder::empty();
    let write = |name: &str, sample: f64| {
        let cube = Cube::new([1, 1, 2, 1], CubeSamples::F64(vec![0.5, sample])).unwrap();
        nullray::io::image::npz::write_cube(&folder.path(name), &cube).unwrap();
    };
    write("wide.npy", 0.1);
    let said = folder.ok(&["convert", "wide.npy", "-o", "frames"]);
    assert!(said.contains("grey; f32, 8"), "{said}");
    write("big.npy", 1e60);
    refused(
        &folder,
        &["convert", "big.npy", "-o", "big"],
        &["f32 cannot hold a sample of 1e60"],
    );
}

#[test]
fn samples_that_a_type_holds_few_digits_of_are_told_with_their_share() {
    let folder = Folder::empty();
    for (samples, kind, words) in [
        (
            [9e-5, 3e-5],
            "f16",
            "25.0 % of the light is in numbers below 6.1e-5, of which f16",
        ),
        (
            [9e-38, 1e-38],
            "f32",
            "10.0 % of the light is in numbers below 1.2e-38, of which f32",
        ),
        ([1e-7, 2e-7], "f16", "100.0 % of the light"),
        // Nothing is lost.
        ([1e-7, 2e-7], "f32", ""),
        ([1e-38, 2e-39], "f64", ""),
        ([f64::powi(2.0, -20), f64::powi(2.0, -24)], "f16", ""),
    ] {
        let cube = Cube::new([1, 1, 2, 1], CubeSamples::F64(samples.to_vec())).unwrap();
        nullray::io::image::npz::write_cube(&folder.path("in.npy"), &cube).unwrap();
        for output in ["out.npy", "frames"] {
            if (output, kind) == ("frames", "f64") {
                continue;
            }
            let said = folder.ok(&["convert", "in.npy", "-o", output, "--type", kind]);
            assert_eq!(said.contains("of the light"), !words.is_empty(), "{said}");
            assert!(said.contains(words), "{output} {words}: {said}");
        }
        let _ = std::fs::remove_dir_all(folder.path("frames"));
    }
}

#[test]
fn what_has_no_effect_on_a_conversion_is_refused() {
    let folder = Folder::empty();
    folder.write("large.npy", large());
    for (options, said) in [
        (
            &["-o", "a.npy", "--transfer", "srgb"][..],
            "applies only to pictures",
        ),
        (&["-o", "a.npy", "--medium-index", "3"], "--warp"),
        (&["-o", "a", "--to-axes", "T H W C"], "frames"),
        // What the surface is written to is checked before the cube is written.
        (&["-o", "a.npy", "--surface", "a.npy"], "ends in .glb"),
        (&["-o", "a.npy", "--surface", "b.obj"], "ends in .glb"),
        (&["-o", "a.npy", "--surface", "no/b.glb"], "no directory no"),
        (
            &["-o", "a.npy", "--surface", "b.glb"],
            "does not say where the points",
        ),
    ] {
        refused(
            &folder,
            &[&["convert", "large.npy"], options].concat(),
            &[said],
        );
    }
}

/// One sample of a million.
fn large() -> Vec<u8> {
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 1), }\n";
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.bytes());
    file.extend(1e6f32.to_le_bytes());
    file
}

#[test]
fn named_channels_go_through_all_formats_and_come_back() {
    let folder = Folder::empty();
    let samples: Vec<f32> = (0..4 * 5 * 6 * 5).map(|n| n as f32).collect();
    let cube = Cube::new([4, 5, 6, 5], CubeSamples::F32(samples)).unwrap();
    nullray::io::image::npz::write_cube(&folder.path("a.npy"), &cube).unwrap();
    let named = ["--channels", "UV,B,IR,G,R"];
    folder.ok(&[&["convert", "a.npy", "-o", "frames"], &named[..]].concat());
    folder.ok(&[&["convert", "frames", "-o", "b.npz"], &named[..]].concat());
    folder.ok(&[&["convert", "b.npz", "-o", "c.npy"], &named[..]].concat());
    let channels = "UV,B,IR,G,R".parse().unwrap();
    let wanted = Wanted {
        channels: Some(&channels),
        ..Wanted::default()
    };
    assert!(cube::load(&folder.path("c.npy"), wanted).unwrap() == cube);
    // By name, in another order.
    folder.ok(&["convert", "frames", "-o", "d.npy", "--channels", "R,G,B"]);
    let rgb = values(&load(&folder, "d.npy", None));
    assert_eq!(rgb[..6], [4.0, 3.0, 1.0, 9.0, 8.0, 6.0]);
    refused(
        &folder,
        &["convert", "a.npy", "-o", "e.npy"],
        &["means 5 channels"],
    );
    refused(
        &folder,
        &["convert", "a.npy", "-o", "e.npy", "--channels", "R,G"],
        &["no channel B"],
    );
    let more = ["convert", "d.npy", "-o", "e.npy", "--channels", "R,G,B,IR"];
    refused(&folder, &more, &["3 channels, and `channels` names 4"]);
}

/// An array (2, 2) of 0.41 m.
fn map() -> Vec<u8> {
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), }";
    let mut file = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    file.extend(format!("{header:<117}\n").bytes());
    file.extend([0.41f64; 4].iter().flat_map(|x| x.to_le_bytes()));
    file
}

/// A cube with times from 4 m on, and this beside them.
fn recording(folder: &Folder, more: [&str; 2]) {
    let cube = Cube::new([2, 2, 8, 1], CubeSamples::F32(vec![1.0; 32])).unwrap();
    let said = [["start", "4"], ["bin_width", "0.1"], more];
    let metadata = said.map(|[key, text]| (key.to_string(), text.to_string()));
    let options = npz::CubeOptions {
        metadata: &metadata,
        ..Default::default()
    };
    npz::write_cube_with(&folder.path("a.npz"), &cube, &options).unwrap();
}

#[test]
fn the_path_of_light_is_taken_off_and_put_back_once() {
    let folder = Folder::empty();
    recording(&folder, ["clock", "capture"]);
    folder.write("map.npy", map());
    let clock = |name: &str| cube::recorded(&folder.path(name), None).unwrap().clock;
    let to =
        |name: &'static str, to: &'static str| ["convert", name, "--unwarp", "map.npy", "-o", to];
    let unwarp = |name| to(name, "b.npz");
    let again = to("b.npz", "e.npz");
    let warp = |name: &'static str| ["convert", name, "--warp", "map.npy", "-o", "c.npz"];
    refused(&folder, &warp("a.npz"), &["--warp", "arrival", "already"]);
    let said = folder.ok(&unwarp("a.npz"));
    // 4 m less the path, in whole bins.
    assert!(
        said.contains("start = \"3.5 m\"") && said.contains("clock = \"world\""),
        "{said}"
    );
    assert_eq!(clock("b.npz").as_deref(), Some("world"));
    refused(&folder, &again, &["--unwarp", "emission", "already"]);
    folder.ok(&warp("b.npz"));
    assert_eq!(clock("c.npz").as_deref(), Some("capture"));
    // A clock is known without the start, too.
    npz::write_cube(&folder.path("d.npy"), &load(&folder, "a.npz", None)).unwrap();
    let width = ["--bin-width", "0.1 m"];
    folder.ok(&[&unwarp("d.npy")[..], &width].concat());
    refused(&folder, &[&again[..], &width].concat(), &["emission"]);
}

#[test]
fn options_that_contradict_the_times_of_a_file_are_used_with_a_warning() {
    let folder = Folder::empty();
    recording(&folder, ["medium_index", "1.5"]);
    folder.write("map.npy", map());
    let convert = |more: &[&str]| {
        let command = ["convert", "a.npz", "-o", "b.npz", "--unwarp", "map.npy"];
        folder.ok(&[&command, more].concat())
    };
    let same = ["--start=4 m", "--bin-width=10 cm", "--medium-index=1.5"];
    let said = convert(&same);
    assert!(
        said.contains("start = \"3.3 m\"") && !said.contains("warning"),
        "{said}"
    );
    let said = convert(&["--start=7 m", "--bin-width=20 cm", "--medium-index=1"]);
    assert!(
        said.contains("start = \"6.4 m\", bin_width = \"0.2 m\""),
        "{said}"
    );
    for warning in [
        "a.npz says start = \"4 m\", but the options \"7 m\", which is used",
        "a.npz says bin_width = \"0.1 m\", but the options \"0.2 m\", which is used",
        "a.npz says medium_index = \"1.5\", but the options \"1\", which is used",
    ] {
        assert!(said.contains(warning), "{warning}: {said}");
    }
}

#[test]
fn what_backs_show_is_kept_with_all_rows_and_asked_for_where_it_is_not_known() {
    let folder = Folder::empty();
    recording(&folder, ["backs", "second_half"]);
    let backs = |name: &str| cube::recorded(&folder.path(name), None).unwrap().backs;
    folder.ok(&["convert", "a.npz", "-o", "b.npz", "--bins", "2:8"]);
    folder.ok(&["convert", "a.npz", "-o", "c.npz", "--rows", "0:1"]);
    assert_eq!(backs("b.npz").as_deref(), Some("second_half"));
    assert_eq!(backs("c.npz"), None);
    let scene = |name: &str| {
        let cube = format!("[[source]]\ncube = {{ file = \"{name}\", backs = \"as_baked\" }}\n");
        folder.write("s.toml", super::bake::FLASH.to_string() + &cube);
    };
    scene("b.npz");
    folder.ok(&["info", "s.toml"]);
    scene("c.npz");
    refused(
        &folder,
        &["info", "s.toml"],
        &["\"c.npz\" does not say what backs show", "as_front"],
    );
}
