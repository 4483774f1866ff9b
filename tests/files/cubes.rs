//! Cubes that are not NumPy arrays: folders of pictures, streaks, transient images.

use std::fs;
use std::path::Path;

use nullray::io::cube::{self, Axes, Bricks, Cube, CubeSamples, Transfer, Wanted};
use nullray::io::image::{Channel, Layers, exr, png};
use nullray::scene::model::{CubeData, SourceKind, TimeBins};
use nullray::scene::{self, Overrides};

fn load(path: &Path, axes: Option<&str>, transfer: Option<Transfer>) -> Result<Cube, String> {
    let axes: Option<Axes> = axes.map(|axes| axes.parse().unwrap());
    let wanted = Wanted {
        axes: axes.as_ref(),
        transfer,
        ..Wanted::default()
    };
    cube::load(path, wanted).map_err(|error| error.to_string())
}

fn single(cube: &Cube) -> &[f32] {
    match &cube.samples {
        CubeSamples::F32(samples) => samples,
        other => panic!("{other:?}"),
    }
}

#[test]
fn frames_of_mitransient_are_the_array_that_they_were_written_from() {
    let folder = Path::new("tests/data/mitransient");
    let whole = cube::load(&folder.join("unwarped.npz"), Wanted::default()).unwrap();
    let [_, width, bins, _] = whole.shape;
    for name in [
        "frames",
        "frames/{i:03d}.exr",
        "frames/%03d.exr",
        "frames/###.exr",
    ] {
        let frames = load(&folder.join(name), None, None).unwrap();
        assert_eq!(frames.shape, [16, 20, 10, 1], "{name}");
        let mut samples = single(&frames).iter();
        for (row, column, bin) in
            (0..16).flat_map(|i| (0..20).flat_map(move |j| (0..10).map(move |k| (i, j, k))))
        {
            // make_frames.py: rows from 4, columns from 10, bins from 18 on.
            let place = ((row + 4) * width + column + 10) * bins + bin + 18;
            assert_eq!(
                samples.next().copied().map(f64::from),
                whole.samples.get(place)
            );
        }
    }
    let info = cube::inspect(&folder.join("frames"), Wanted::default()).unwrap();
    assert_eq!(
        (info.shape, info.bytes),
        ([16, 20, 10, 1], 4 * 16 * 20 * 10)
    );
}

#[test]
fn frames_without_numbers_between_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    for number in [0, 1, 3] {
        let name = format!("{number:03}.exr");
        fs::copy(
            Path::new("tests/data/mitransient/frames").join(&name),
            folder.path().join(&name),
        )
        .unwrap();
    }
    let error = load(folder.path(), None, None).unwrap_err();
    assert!(error.contains("the first and the last: 2"), "{error}");
    fs::write(folder.path().join("002.exr"), "no picture").unwrap();
    let error = load(folder.path(), None, None).unwrap_err();
    assert!(error.contains("002.exr"), "{error}");
}

/// Frames of other sizes than the first, or that end before they should, and what is asked of a sequence that it has not.
#[test]
fn frames_that_do_not_fit_together_are_refused_by_name() {
    let frames = Path::new("tests/data/mitransient/frames");
    let folder = tempfile::tempdir().unwrap();
    let copy = |number: u8| {
        let name = format!("{number:03}.exr");
        fs::copy(frames.join(&name), folder.path().join(&name)).unwrap();
    };
    (0..3).for_each(copy);
    assert_eq!(
        load(folder.path(), None, None).unwrap().shape,
        [16, 20, 3, 1]
    );
    // A picture that was cut anywhere: in its header, its table of places, its samples, or at their very end.
    let whole = fs::read(frames.join("001.exr")).unwrap();
    for length in [0, 3, 100, whole.len() / 2, whole.len() - 1] {
        fs::write(folder.path().join("001.exr"), &whole[..length]).unwrap();
        let error = load(folder.path(), None, None).unwrap_err();
        assert!(error.contains("001.exr"), "{length}: {error}");
    }
    // Another size, which the message has with that of the first.
    let name = folder.path().join("001.exr");
    let layers = Layers {
        width: 5,
        height: 4,
        channels: vec![Channel {
            name: "Y".into(),
            samples: nullray::io::image::Samples::F32(vec![1.0; 20]),
        }],
        metadata: Vec::new(),
    };
    exr::write(&name, &layers).unwrap();
    let error = load(folder.path(), None, None).unwrap_err();
    let parts = ["001.exr", "5 × 4 pixels", "000.exr", "20 × 16"];
    assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    // Pictures have no arrays, and one axis of files.
    copy(1);
    let asked = Wanted {
        array: Some("data"),
        ..Wanted::default()
    };
    let error = cube::load(folder.path(), asked).unwrap_err().to_string();
    assert!(error.contains("no arrays with names"), "{error}");
    let error = load(folder.path(), Some("H W"), None).unwrap_err();
    assert!(error.contains("(files, rows, columns, colours)"), "{error}");
    // In streaks a file is a row.
    assert_eq!(
        load(folder.path(), Some("H W T"), None).unwrap().shape,
        [3, 16, 20, 1]
    );
}

/// Numbers in single precision, as numpy saves them.
fn npy(path: &Path, shape: &str, count: usize) {
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}");
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    bytes.extend(format!("{header:<117}\n").bytes());
    bytes.extend((0..count).flat_map(|n| (n as f32 + 1.0).to_le_bytes()));
    fs::write(path, bytes).unwrap();
}

#[test]
fn pictures_without_time_are_steady_cubes_where_their_axes_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npy");
    for (shape, axes, count, expected) in [
        ("(4, 5)", "H W", 20, [4, 5, 1, 1]),
        ("(4, 5, 3)", "H W C", 60, [4, 5, 1, 3]),
        ("(3, 4, 5)", "C H W", 60, [4, 5, 1, 3]),
        ("(5, 4)", "W H", 20, [4, 5, 1, 1]),
    ] {
        npy(&path, shape, count);
        let cube = load(&path, Some(axes), None).unwrap();
        assert_eq!(cube.shape, expected, "{axes}");
        // Row 1, column 2, channel 0: where the array has it.
        let place = match axes {
            "H W" => 5 + 2,
            "H W C" => 3 * (5 + 2),
            "C H W" => 5 + 2,
            _ => 2 * 4 + 1,
        };
        let sample = (5 + 2) * expected[3];
        assert_eq!(single(&cube)[sample], place as f32 + 1.0, "{axes}");
    }
    // A scene: no time is asked for, and none may be given.
    let scene = |more: &str| {
        let text = format!(
            "[camera]\neye = [0, 0, 1]\nlook_at = [0, 0, 0]\n[[object]]\nname = \"wall\"\nshape = {{ plane = {{ size = [1, 1] }} }}\n[[source]]\n[source.cube]\n\
             file = \"a.npy\"\naxes = \"W H\"\nuv = 0\n{more}"
        );
        scene::parse(&text, "scene", folder.path(), &Overrides::default())
    };
    scene("").unwrap_or_else(|e| panic!("{e} {}", e.help()));
    for key in ["start = \"1 m\"", "bin_width = \"1 m\""] {
        assert!(scene(key).is_err(), "{key}");
    }
}

#[test]
fn films_of_other_quantities_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.npy");
    for (channels, words) in [
        (12, "a polarised film in colours"),
        (4, "a polarised film"),
        (2, "a phasor film"),
        (5, "means 5 channels"),
    ] {
        npy(&path, &format!("(4, 5, 6, {channels})"), 120 * channels);
        let error = load(&path, Some("H W T C"), None).unwrap_err();
        assert!(error.contains(words), "{channels}: {error}");
        let inspected = cube::inspect(&path, Wanted::default());
        assert!(inspected.is_err(), "{channels}");
    }
    // The intensity alone, as the message has it.
    npy(&path, "(4, 5, 6, 1)", 120);
    load(&path, Some("H W T C"), None).unwrap();
}

/// sRGB: ((188/255 + 0.055)/1.055)^2.4 = 0.502886.
/// A picture of 100 × 100 pixels takes 160 kB while it is decoded (4 bytes of codes, 12 of samples), the cube of four 480 kB.
#[test]
fn png_frames_are_decoded_within_memory_and_looked_at_without() {
    let folder = tempfile::tempdir().unwrap();
    for number in 0..4u8 {
        let codes: Vec<u8> = (0..30_000).map(|i| (i % 251) as u8 + number).collect();
        let path = folder.path().join(format!("f{number}.png"));
        png::write(&path, 100, 100, &codes, &[]).unwrap();
    }
    let linear = Wanted {
        transfer: Some(Transfer::Linear),
        ..Wanted::default()
    };
    let info = cube::inspect(folder.path(), linear.within(1)).unwrap();
    assert_eq!(info.shape, [100, 100, 4, 3]);
    let whole = cube::load(folder.path(), linear).unwrap();
    // Room for one at a time.
    let one_by_one = cube::load(folder.path(), linear.within(650_000)).unwrap();
    assert!(one_by_one == whole);
    for memory in [470_000, 600_000] {
        let error = cube::load(folder.path(), linear.within(memory)).unwrap_err();
        assert!(error.to_string().contains("B of memory"), "{error}");
    }
}

#[test]
fn codes_of_png_frames_are_linear_by_the_declared_transfer() {
    let folder = tempfile::tempdir().unwrap();
    for number in 0..2u8 {
        let rgb = [188, 0, 255, 10 * number, 188, 188];
        png::write(
            &folder.path().join(format!("f{number}.png")),
            2,
            1,
            &rgb,
            &[],
        )
        .unwrap();
    }
    let error = load(folder.path(), None, None).unwrap_err();
    assert!(error.contains("not radiance as they stand"), "{error}");
    let linear = load(folder.path(), None, Some(Transfer::Linear)).unwrap();
    assert_eq!(linear.shape, [1, 2, 2, 3]);
    // Column 1, bin 1, red.
    assert_eq!(single(&linear)[9], 10.0 / 255.0);
    let srgb = load(folder.path(), None, Some(Transfer::Srgb)).unwrap();
    assert!((single(&srgb)[0] - 0.502886).abs() < 1e-6);
    assert_eq!(single(&srgb)[2], 1.0);
}

/// A Radiance picture of uncompressed pixels, (m + ½) 2^(e − 136) in each colour.
fn hdr(path: &Path, width: usize, pixels: &[[u8; 4]]) {
    let header = format!(
        "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {width}\n",
        pixels.len() / width
    );
    fs::write(path, [header.as_bytes(), &pixels.concat()].concat()).unwrap();
}

#[test]
fn streaks_have_a_file_per_row_and_time_along_x() {
    let folder = tempfile::tempdir().unwrap();
    // Rows 0 and 1 of the camera, 3 columns, 4 bins: mantissa 16 row + 4 column + bin + 128 and exponent 136.
    let mantissa = |row: u8, column: u8, bin: u8| 128 + 16 * row + 4 * column + bin;
    for row in 0..2 {
        let pixels = (0..3).flat_map(|j| (0..4).map(move |k| [mantissa(row, j, k), 128, 128, 136]));
        hdr(
            &folder.path().join(format!("streak_{row:04}.hdr")),
            4,
            &pixels.collect::<Vec<_>>(),
        );
    }
    hdr(
        &folder.path().join("streak.hdr"),
        1,
        &[[128, 128, 128, 128]],
    );
    let cube = load(&folder.path().join("streak_%04d.hdr"), Some("H W T"), None).unwrap();
    assert_eq!(cube.shape, [2, 3, 4, 3]);
    let place = |row: usize, column: usize, bin: usize| ((row * 3 + column) * 4 + bin) * 3;
    assert_eq!(
        single(&cube)[place(1, 2, 3)],
        f32::from(mantissa(1, 2, 3)) + 0.5
    );
    assert_eq!(
        single(&cube)[place(0, 1, 2)],
        f32::from(mantissa(0, 1, 2)) + 0.5
    );
}

/// A transient image of version 4: 2 rows, 3 columns and 4 bins, bin 0 centred at 1 m, 0.5 m wide.
fn transient_image() -> Vec<u8> {
    let mut file = b"TI04".to_vec();
    for number in [10u32, 6, 4] {
        file.extend(number.to_le_bytes());
    }
    for number in [1.0f32, 0.5] {
        file.extend(number.to_le_bytes());
    }
    file.extend(68u32.to_le_bytes());
    file.extend((0..24u8).flat_map(|n| f32::from(n).to_le_bytes()));
    for number in [3u32, 2] {
        file.extend(number.to_le_bytes());
    }
    file.extend((0..15u8).flat_map(|n| f32::from(n).to_le_bytes()));
    file.extend(b"{ \"Name\": \"wall\" }");
    file
}

#[test]
fn transient_images_say_their_times() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wall.ti");
    fs::write(&path, transient_image()).unwrap();
    let cube = load(&path, None, None).unwrap();
    assert_eq!(cube.shape, [2, 3, 4, 1]);
    assert!(single(&cube).iter().copied().eq((0..24u8).map(f32::from)));
    let info = cube::inspect(&path, Wanted::default()).unwrap();
    assert_eq!(info.notes[1], "top right (3, 4, 5)");
    assert_eq!(info.notes[5], "properties { \"Name\": \"wall\" }");
    assert_eq!(info.notes[6], "bins of 0.5 m, the first about 1 m");

    let parse = |keys: &str| {
        let text = format!(
            "[camera]\neye = [0, 1, 5]\nlook_at = [0, 0, 0]\nhfov = \"40 deg\"\nsize = [8, 8]\n[[object]]\n\
             shape = {{ plane = {{ size = [1, 1] }} }}\n[[source]]\ncube = {{ file = \"wall.ti\"{keys} }}\n"
        );
        scene::parse(&text, "scene.toml", folder.path(), &Overrides::default())
    };
    let bins = |keys: &str| match parse(keys).unwrap().sources.remove(0).kind {
        SourceKind::Cube(cube) => (cube.bins, cube.read.len(), cube.assumed.len()),
        other => panic!("{other:?}"),
    };
    // From the centre of bin 0, half a bin back.
    let uniform = |start, width| TimeBins::Uniform { start, width };
    assert_eq!(bins("").0, uniform(0.75, 0.5));
    assert_eq!((bins("").1, bins("").2), (2, 4));
    assert_eq!(bins(", start = \"3 m\"").0, uniform(3.0, 0.5));
    assert_eq!(
        bins(", start = \"3 m\", bin_width = \"1 m\"").0,
        uniform(3.0, 1.0)
    );
    fs::write(&path, "TI04").unwrap();
    assert!(
        parse("")
            .unwrap_err()
            .to_string()
            .contains("ends within it")
    );
}

/// Written by the library of the University of Bonn, and by the steps of BunnyKiller's film (tests/data/bonn, tests/data/bunnykiller).
#[test]
fn files_of_the_programs_that_define_a_format_are_read() {
    let image = load(Path::new("tests/data/bonn/wall.ti"), None, None).unwrap();
    assert_eq!(image.shape, [5, 6, 12, 1]);
    let place = |v: usize, u: usize, t: usize| (v * 6 + u) * 12 + t;
    assert_eq!(
        single(&image)[place(4, 2, 7)],
        1.0 + 7.0 + 16.0 * 2.0 + 128.0 * 4.0
    );
    let times = cube::times(Path::new("tests/data/bonn/wall.ti"), None)
        .unwrap()
        .unwrap();
    assert_eq!((times.start, times.width), (2.0, 0.5));
    // 3 m × 2.5 m in six columns and five rows: centres half a pixel of 0.5 m within.
    let wall = cube::wall(Path::new("tests/data/bonn/wall.ti"), Wanted::default())
        .unwrap()
        .unwrap();
    assert_eq!(wall.size, [5, 6]);
    assert!((wall.points[0] - glam::DVec3::new(-1.25, 1.75, 0.0)).length() < 1e-12);
    assert!((wall.points[29] - glam::DVec3::new(1.25, -0.25, 0.0)).length() < 1e-12);
    assert!((wall.points[1] - wall.points[0] - 0.5 * glam::DVec3::X).length() < 1e-12);

    // Pictures of fewer than eight bins are stored transposed.
    for (name, bins, axes) in [("streak", 10, "H W T"), ("short", 5, "H T W")] {
        let folder = Path::new("tests/data/bunnykiller");
        let cube = load(&folder.join(format!("{name}_%04d.hdr")), Some(axes), None).unwrap();
        assert_eq!(cube.shape, [4, 6, bins, 3], "{name}");
        let samples = single(&cube);
        for (n, got) in samples.iter().enumerate() {
            let (c, t, x, y) = (n % 3, n / 3 % bins, n / 3 / bins % 6, n / 3 / bins / 6);
            let pixel = ((t + 1) * (x + 1) * (y + 1)) as f32 / 4.0;
            let expected = pixel * (c + 1) as f32;
            // Eight bits of the brightest colour, whose last is cut off and put at its middle.
            assert!(
                (got - expected).abs() <= 3.0 * pixel / 128.0,
                "{name} {n}: {got} {expected}"
            );
        }
    }
}

/// Bytes of streaks and transient images changed, and files cut off: an error or samples, and neither a panic nor more memory than the file
/// may ask for.
#[test]
fn damaged_streaks_and_transient_images_are_refused_or_read() {
    let mut random = crate::random_numbers();
    let folder = tempfile::tempdir().unwrap();
    let (mut read, mut refused) = (0, 0);
    for (name, files, axes) in [
        (
            "bunnykiller/streak_0000.hdr",
            "streak_%04d.hdr",
            Some("H W T"),
        ),
        ("bonn/wall.ti", "wall.ti", None),
    ] {
        let whole = fs::read(Path::new("tests/data").join(name)).unwrap();
        let path = folder.path().join(Path::new(name).file_name().unwrap());
        for _ in 0..2000 {
            let mut bytes = whole.clone();
            for _ in 0..1 + random() % 3 {
                // Headers more often than samples.
                let among = if random().is_multiple_of(2) {
                    bytes.len().min(100)
                } else {
                    bytes.len()
                };
                bytes[random() % among] = random() as u8;
            }
            if random().is_multiple_of(10) {
                bytes.truncate(random() % whole.len());
            }
            fs::write(&path, &bytes).unwrap();
            match load(&folder.path().join(files), axes, None) {
                Ok(cube) => {
                    read += 1;
                    assert!(single(&cube).iter().all(|sample| sample.is_finite()));
                }
                Err(_) => refused += 1,
            }
            let _ = cube::wall(&path, Wanted::default());
        }
    }
    assert!(read > 100 && refused > 100, "{read} {refused}");
    // Sizes that no such file can hold are refused before memory is asked for.
    let header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n";
    fs::write(folder.path().join("large_0.hdr"), header).unwrap();
    load(&folder.path().join("large_%d.hdr"), Some("H W T"), None).unwrap_err();
}

#[test]
fn broken_transient_images_are_refused() {
    let whole = transient_image();
    let refused = |bytes: &[u8]| {
        let loaded = cube::load_bytes(bytes, "a.ti", Wanted::default());
        loaded.unwrap_err().to_string()
    };
    let least = 28 + 4 * 24 + 68;
    for length in 4..least {
        refused(&whole[..length]);
    }
    assert!(cube::load_bytes(&whole[..least], "a.ti", Wanted::default()).is_ok());
    let changed = |at: usize, bytes: [u8; 4]| {
        let mut file = whole.clone();
        file[at..at + 4].copy_from_slice(&bytes);
        refused(&file)
    };
    assert!(changed(4, 11u32.to_le_bytes()).contains("mode 11"));
    assert!(changed(8, u32::MAX.to_le_bytes()).contains("truncated"));
    assert!(changed(12, 0u32.to_le_bytes()).contains("truncated"));
    assert!(changed(20, 0f32.to_le_bytes()).contains("do not form a time axis"));
    assert!(changed(20, f32::NAN.to_le_bytes()).contains("do not form a time axis"));
    assert!(changed(24, 4u32.to_le_bytes()).contains("68 bytes"));
    assert!(changed(28 + 4 * 5, f32::INFINITY.to_le_bytes()).contains("[0, 1, 1]"));
    assert!(changed(28 + 96, 7u32.to_le_bytes()).contains("grid of 7 columns"));
    assert!(changed(28 + 96, u32::MAX.to_le_bytes()).contains("grid"));
}

/// Dead bins are filled alike where a cube is loaded and where it goes part by part to another file.
#[test]
fn dead_bins_are_filled_on_the_way_to_another_file() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = ["a.npy", "b.npy"].map(|name| folder.path().join(name));
    let samples = (0..2 * 3 * 8).map(|n| (n * n) as f32).collect();
    let cube = Cube::new([2, 3, 8, 1], CubeSamples::F32(samples)).unwrap();
    nullray::io::image::npz::write_cube(&a, &cube).unwrap();
    let wanted = Wanted {
        dead_bins: &[0, 3, 4, 7],
        ..Wanted::default()
    };
    let loaded = cube::load(&a, wanted).unwrap();
    let line = |pixel: usize| &single(&loaded)[8 * pixel..8 * pixel + 8];
    // Of n²: bin 1 in place of 0, the line from 4 to 25 in place of 9 and 16, bin 6 in place of 7.
    assert_eq!(line(0), [1.0, 1.0, 4.0, 11.0, 18.0, 25.0, 36.0, 36.0]);
    for axes in ["H W T C", "T H W"] {
        let axes: Axes = axes.parse().unwrap();
        let changes = cube::Changes {
            axes: Some(axes.clone()),
            ..cube::Changes::default()
        };
        cube::convert((&a, wanted), &b, &changes, &mut |_, _| true).unwrap();
        let written = Wanted {
            axes: Some(&axes),
            ..Wanted::default()
        };
        assert_eq!(cube::load(&b, written).unwrap(), loaded, "{axes}");
    }
    let part = cube::Changes {
        bins: Some(3..4),
        ..cube::Changes::default()
    };
    cube::convert((&a, wanted), &b, &part, &mut |_, _| true).unwrap();
    assert_eq!(single(&cube::load(&b, Wanted::default()).unwrap())[0], 11.0);
    for (dead, wrong) in [
        (&[8][..], "no bin 8"),
        (&[0, 1, 2, 3, 4, 5, 6, 7], "every bin is listed as dead"),
    ] {
        let wanted = Wanted {
            dead_bins: dead,
            ..Wanted::default()
        };
        let error = cube::load(&a, wanted).unwrap_err().to_string();
        assert!(error.contains(wrong), "{error}");
    }
}

/// A line in time comes back, from energies and from densities, where cubes are in memory and on disk.
#[test]
fn dead_bins_of_different_widths_are_filled_as_densities() {
    let folder = tempfile::tempdir().unwrap();
    let edges = [1.0, 1.1, 1.2, 1.3, 2.3, 2.4, 2.5, 3.5];
    let dead = [3, 4];
    for (values, of_energy) in [("per_bin", 1.0), ("density", 0.0)] {
        for slope in [0.0, 4.0] {
            // The mean of 10 + slope t over a bin, and what the bin holds.
            let held = |bin: &[f64]| {
                let density = 10.0 + slope * 0.5 * (bin[0] + bin[1]);
                density * (bin[1] - bin[0]).powf(of_energy)
            };
            let expected: Vec<f64> = edges.windows(2).map(held).collect();
            let mut samples = expected.clone();
            for bin in dead {
                samples[bin] = 0.0;
            }
            let cube = Cube::new([1, 1, 7, 1], CubeSamples::F64(samples)).unwrap();
            nullray::io::image::npz::write_cube(&folder.path().join("a.npy"), &cube).unwrap();
            let text = format!(
                "[camera]\neye = [0, 1, 5]\nlook_at = [0, 0, 0]\nsize = [8, 8]\n[[object]]\nshape = {{ plane = {{ size = [1, 1] }} }}\n\
                 [[source]]\ncube = {{ file = \"a.npy\", edges = {:?}, dead_bins = {dead:?}, values = \"{values}\" }}\n",
                edges.map(|edge| format!("{edge} m"))
            );
            let scene = scene::parse(&text, "a.toml", folder.path(), &Overrides::default());
            let SourceKind::Cube(source) = scene.unwrap().sources.remove(0).kind else {
                panic!("no cube");
            };
            let CubeData::File(file) = &source.data else {
                panic!("no file");
            };
            let wanted = source.wanted(file);
            let loaded = cube::load(&file.path, wanted).unwrap();
            let mut line = [0.0; 7];
            let on_disk = Bricks::open(&file.path, wanted, 9 << 20).unwrap();
            on_disk.samples(&mut Default::default(), 0, 0, &mut line);
            for (bin, expected) in expected.iter().enumerate() {
                assert!(
                    (loaded.total(0, bin) - expected).abs() < 1e-12,
                    "{values} {slope} {bin}"
                );
                assert_eq!(loaded.total(0, bin), line[bin]);
            }
        }
    }
}
