//! Wrongly used data, from scene to warning: each is warned about before anything is rendered, with the numbers that would be right. The
//! recording of `scenes/capture.toml` begins at 7 m, has bins of 0.1 m, and no warnings.

use std::path::Path;
use std::sync::Arc;

use nullray::io::cube::{self, Bricks, Cube, CubeSamples, CubeStore, Negative, Wanted};
use nullray::light::time_texture::survey::{Order, of_samples};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::survey::{Shots, misfits, moments, seen_times};
use nullray::scene::model::Scene;
use nullray::scene::{Overrides, parse};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

fn recording() -> Cube {
    let path = Path::new(ROOT).join("scenes/corner/capture_rgb.npz");
    cube::load(&path, Wanted::default()).unwrap()
}

fn scene(change: impl Fn(String) -> String) -> Scene {
    let folder = Path::new(ROOT).join("scenes");
    let text = std::fs::read_to_string(folder.join("capture.toml")).unwrap();
    let text = change(text.replace("size = [640, 480]", "size = [64, 48]"));
    parse(&text, "capture", &folder, &Overrides::default())
        .unwrap_or_else(|e| panic!("{e} {}", e.help()))
}

fn prepared(scene: &Scene) -> Result<Prepared, nullray::Error> {
    let plan = Plan::new(scene, &Request::default())?;
    Prepared::new(scene, &plan, &Silent)
}

fn remarks(from: &str, to: &str) -> String {
    let scene = scene(|text| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    });
    let mut prepared = prepared(&scene).unwrap();
    let misfits = misfits(&scene, &mut prepared);
    prepared.warnings.extend(misfits);
    prepared.warnings.join("\n")
}

#[test]
fn nothing_is_said_of_data_that_are_used_rightly() {
    assert_eq!(remarks("start = \"7 m\"", "start = \"7 m\""), "");
}

/// What is said of `text`, whose files are in `folder`.
fn misfits_of(text: &str, folder: &Path) -> Vec<String> {
    let scene = parse(text, "flash", folder, &Overrides::default())
        .unwrap_or_else(|e| panic!("{e} {}", e.help()));
    misfits(&scene, &mut prepared(&scene).unwrap())
}

/// A flash lights the floor from 2 m on and the wall from 12 m on. The camera sees both as they were at 4 to 8 m.
const FLASH: &str = r#"
        [camera]
        eye = [0, 1, 3]
        look_at = [0, 0.5, -1]
        hfov = "60 deg"
        size = [48, 40]
        time = "10 m"

        [[object]]
        name = "floor"
        shape = { plane = { size = [4, 6] } }

        [[object]]
        name = "wall"
        shape = { plane = { size = [4, 3] } }
        transform = { translate = [0, 1.5, -2], rotate = { axis = [1, 0, 0], angle = "90 deg" } }

        [[source]]
        name = "light on floor"
        objects = ["floor"]
        cube = { file = "floor.npy", start = "0 m", bin_width = "0.1 m", clock = "world", uv = 0 }

        [[source]]
        name = "light on wall"
        objects = ["wall"]
        cube = { file = "wall.npy", start = "0 m", bin_width = "0.1 m", clock = "world", uv = 0 }
    "#;

fn write_flash(folder: &Path) {
    for (name, lit_from) in [("floor", 20), ("wall", 120)] {
        let samples = (0..2 * 2 * 160).map(|n| f32::from(u8::from(n % 160 >= lit_from)));
        let cube = Cube {
            shape: [2, 2, 160, 1],
            samples: CubeSamples::F32(samples.collect()),
        };
        let path = folder.join(name).with_extension("npy");
        nullray::io::image::npz::write_cube(&path, &cube).unwrap();
    }
}

#[test]
fn surfaces_that_light_reaches_later_get_no_warning() {
    let folder = tempfile::tempdir().unwrap();
    write_flash(folder.path());
    assert_eq!(misfits_of(FLASH, folder.path()), [""; 0]);
    // One whose times are not those of the others is another matter.
    let wall = "\"wall.npy\", start = \"0 m\"";
    assert!(FLASH.contains(wall));
    let late = FLASH.replace(wall, "\"wall.npy\", start = \"-0.3 m\"");
    let late = misfits_of(&late, folder.path());
    assert!(
        late.len() == 1 && late[0].contains("light on wall"),
        "{late:?}"
    );
}

/// Data of textures as long as they should be that begin too late are said to begin too late, before another unit that would also fit.
#[test]
fn a_wrong_start_of_a_texture_is_not_reported_as_a_wrong_unit_only() {
    let folder = tempfile::tempdir().unwrap();
    write_flash(folder.path());
    let late = FLASH.replace("start = \"0 m\"", "start = \"60 m\"");
    let said = misfits_of(&late, folder.path()).join("\n");
    let start = said
        .find("they would fit with a start (now 60 m) between")
        .expect(&said);
    assert!(
        said.find("in a unit").is_none_or(|unit| unit > start),
        "{said}"
    );
    // Milliseconds that are taken for seconds are far too long.
    let long = FLASH.replace(
        "start = \"0 m\", bin_width = \"0.1 m\"",
        "start = \"300 m\", bin_width = \"100 m\"",
    );
    let said = misfits_of(&long, folder.path()).join("\n");
    assert!(said.contains("in a unit 10^-"), "{said}");
}

#[test]
fn light_that_arrives_too_early_is_reported_with_a_start_that_would_fit() {
    let said = remarks("start = \"7 m\"", "start = \"0 m\"");
    assert!(
        said.contains("before time 0") && said.contains("start (now 0 m)"),
        "{said}"
    );
    // The recording begins at 7 m, and first light is known to two bins of 0.1 m and a half.
    let start = said.split("; start = \"").nth(1).expect(&said);
    let start: f64 = start.split(' ').next().unwrap().parse().unwrap();
    assert!((6.75..=7.25).contains(&start), "{said}");
}

#[test]
fn units_off_by_powers_of_ten_are_said_with_those_that_would_fit() {
    for power in [-6, -3, -2, -1, 1, 2, 3, 6] {
        let [start, width] = [7.0, 0.1].map(|length| length * 10f64.powi(power));
        let keys = "start = \"7 m\"\nbin_width = \"0.1 m\"";
        let said = remarks(
            keys,
            &format!("start = \"{start} m\"\nbin_width = \"{width} m\""),
        );
        assert!(said.contains("would fit: start = "), "{power}: {said}");
        let number = said.split("would fit: start = \"").nth(1).unwrap();
        let number: f64 = number.split(' ').next().unwrap().parse().unwrap();
        // Within a power of ten: neighbouring ones may fit, too.
        assert!((0.69..70.1).contains(&number), "{power}: {said}");
    }
}

#[test]
fn a_width_or_a_start_that_is_wrong_by_itself_is_said() {
    for width in ["10 m", "1 m", "0.01 m", "0.001 m", "0.1 ns"] {
        let said = remarks("bin_width = \"0.1 m\"", &format!("bin_width = \"{width}\""));
        assert_eq!(
            said.contains("bin_width = \"0.1 m\""),
            width.len() < 5,
            "{width}: {said}"
        );
        assert!(!said.is_empty(), "{width}");
    }
    for start in ["70 m", "20 m", "0.7 m"] {
        let said = remarks("start = \"7 m\"", &format!("start = \"{start}\""));
        let [from, to] = ["between ", "m and "].map(|word| {
            let number = said
                .split("with a start")
                .nth(1)
                .and_then(|text| text.split(word).nth(1));
            let number = number.and_then(|text| text.split(' ').next()).expect(&said);
            number.parse::<f64>().expect(&said)
        });
        assert!(from < 7.0 && 7.0 < to, "{start}: {said}");
    }
    let said = remarks("clock = \"capture\"", "clock = \"world\"");
    assert!(said.contains("with clock = \"capture\""), "{said}");
}

#[test]
fn a_picture_in_colours_is_not_taken_for_a_cube_in_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npy");
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (64, 64, 3), }";
    let header = format!("{header:<117}\n");
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    bytes.extend(header.bytes());
    bytes.resize(bytes.len() + 64 * 64 * 3 * 4, 0);
    std::fs::write(&path, bytes).unwrap();
    let refused = cube::inspect(&path, Wanted::default()).unwrap_err();
    let said = format!("{refused} {}", refused.help());
    assert!(
        said.contains("colour picture") && said.contains("H W C"),
        "{said}"
    );
    for (axes, shape) in [("H W C", [64, 64, 1, 3]), ("H W T", [64, 64, 3, 1])] {
        let axes = axes.parse().unwrap();
        let wanted = Wanted {
            axes: Some(&axes),
            ..Wanted::default()
        };
        assert_eq!(cube::inspect(&path, wanted).unwrap().shape, shape);
    }
}

#[test]
fn a_pose_that_is_not_the_capture_s_is_said() {
    let said = remarks(
        "look_at = [-0.4, 1.0, -0.6], hfov",
        "look_at = [9.4, 1.0, 9.6], hfov",
    );
    assert!(
        said.contains("show no object") && said.contains("pose"),
        "{said}"
    );
}

/// With the cube of the recording, changed.
fn with_cube(shape: [usize; 4], samples: Vec<f32>, axes: &str) -> Result<Prepared, nullray::Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("changed.npy");
    let cube = Cube {
        shape,
        samples: CubeSamples::F32(samples),
    };
    nullray::io::image::npz::write_cube(&path, &cube).unwrap();
    let file = format!("file = {:?}\n{axes}", path.display().to_string());
    prepared(&scene(|text| {
        text.replace("file = \"corner/capture_rgb.npz\"", &file)
    }))
}

fn samples(cube: &Cube) -> Vec<f32> {
    let all = 0..cube.samples.len();
    all.filter_map(|n| Some(cube.samples.get(n)? as f32))
        .collect()
}

#[test]
fn energy_that_is_cut_at_the_window_s_ends_is_said() {
    let cube = recording();
    let [h, w, t, c] = cube.shape;
    let ends = [
        (0..30, "last bin is still lit", "at the end of the data"),
        (
            30..t,
            "first bin is already lit",
            "at the start of the data",
        ),
    ];
    for (bins, lit, end) in ends {
        let part = samples(&cube);
        let part = part.chunks(t * c);
        let part = part.flat_map(|line| line[bins.start * c..bins.end * c].to_vec());
        let said = with_cube([h, w, bins.len(), c], part.collect(), "").unwrap();
        let said = said.warnings.join("\n");
        assert!(said.contains("cut off") && said.contains(lit), "{said}");
        assert!(said.contains(end), "{said}");
    }
}

#[test]
fn an_order_of_axes_in_which_time_is_not_like_time_is_said() {
    let cube = recording();
    let [h, w, t, c] = cube.shape;
    let all = samples(&cube);
    let mut turned = Vec::with_capacity(all.len());
    for (bin, pixel) in (0..t).flat_map(|bin| (0..h * w).map(move |pixel| (bin, pixel))) {
        let at = (pixel * t + bin) * c;
        turned.extend_from_slice(&all[at..at + c]);
    }
    let shape = [t, h, w, c];
    let said = with_cube(shape, turned.clone(), "")
        .unwrap()
        .warnings
        .join("\n");
    assert!(said.contains("axes = \"T H W\""), "{said}");
    let said = with_cube(shape, turned, "axes = \"T H W C\"").unwrap();
    assert_eq!(said.warnings, [""; 0]);
}

#[test]
fn a_non_finite_sample_is_refused_with_its_position() {
    let cube = recording();
    let mut all = samples(&cube);
    let [_, w, t, c] = cube.shape;
    all[((3 * w + 5) * t + 7) * c + 2] = f32::NAN;
    let error = with_cube(cube.shape, all, "").unwrap_err();
    let said = format!("{error} {}", error.help());
    assert!(
        said.contains("[3, 5, 7, 2]") && said.contains("nan_to_num"),
        "{said}"
    );
}

#[test]
fn times_that_miss_the_light_in_view_are_reported_with_those_that_would_not() {
    let scene = scene(|text| text.replace("time = \"0 m\"", "time = \"-60 m\""));
    let mut prepared = prepared(&scene).unwrap();
    let seen = seen_times(&prepared);
    assert!(!seen[0].meets() && seen[0].data == [7.0, 16.5], "{seen:?}");
    let [from, to] = Shots::new(&scene, &mut prepared).showing(&seen[0]).unwrap();
    assert!(-60.0 < from && from < 0.0 && 0.0 < to, "{from} {to}");
}

/// A camera 2 m above a floor, with its shutter open from 3 m to 4 m of its own time.
fn exposure(beta: f64, light: &str) -> String {
    format!(
        "[camera]\neye = [0, 2, 0]\nlook_at = [0, 0, 0]\nup = [0, 0, -1]\nhfov = \"0.001 deg\"\nsize = [2, 2]\ntime = \"3 m\"\n\
         velocity = {{ beta = [0, {beta:?}, 0] }}\nshutter = {{ duration = \"1 m\" }}\n\
         [[object]]\nname = \"floor\"\nshape = {{ plane = {{ size = [4, 4] }} }}\n{light}"
    )
}

#[test]
fn all_that_is_seen_while_a_shutter_is_open_counts_as_seen() {
    let folder = tempfile::tempdir().unwrap();
    let samples = (0..2 * 2 * 20).map(|n| f32::from(u8::from(n % 20 == 13)));
    let cube = Cube::new([2, 2, 20, 1], CubeSamples::F32(samples.collect())).unwrap();
    nullray::io::image::npz::write_cube(&folder.path().join("floor.npy"), &cube).unwrap();
    let shows = "[[source]]\ncube = { file = \"floor.npy\", start = \"0 m\", bin_width = \"0.1 m\", clock = \"world\", uv = 0 }\n";
    // At its own time τ, the world time γτ, a camera that recedes is 2 m + γβτ above the floor: what it sees left at γ(1 − β)τ − 2 m.
    for (beta, expected) in [(0.0, [1.0, 2.0]), (0.6, [-0.5, 0.0])] {
        let text = exposure(beta, shows);
        let scene = parse(&text, "exposed", folder.path(), &Overrides::default()).unwrap();
        let seen = seen_times(&prepared(&scene).unwrap())[0].seen;
        for (seen, expected) in seen.into_iter().zip(expected) {
            assert!((seen - expected).abs() < 1e-9, "{beta} {seen} {expected}");
        }
    }
    // The bin that is lit, from 1.3 m to 1.4 m, is before the middle of the exposure, and so is a flash from 0.04 m to 0.36 m.
    assert_eq!(misfits_of(&exposure(0.0, shows), folder.path()), [""; 0]);
    let flash = "[[light]]\nposition = [0, 1, 0]\nemission = { gaussian = { time = \"0.2 m\", sigma = \"2 cm\" } }\n";
    let text = exposure(0.0, flash);
    let scene = parse(&text, "flash", folder.path(), &Overrides::default()).unwrap();
    let mut prepared = prepared(&scene).unwrap();
    let told = moments(&scene, &mut prepared, false);
    assert!(told[0].contains("shows some of it"), "{told:?}");
    assert!(moments(&scene, &mut prepared, true).is_empty());
}

#[test]
fn dead_bins_are_reported_until_they_are_declared() {
    let cube = recording();
    let [_, _, t, c] = cube.shape;
    let mut all = samples(&cube);
    for line in all.chunks_mut(t * c) {
        line[40 * c..41 * c].fill(0.0);
    }
    let said = with_cube(cube.shape, all.clone(), "")
        .unwrap()
        .warnings
        .join("\n");
    assert!(said.contains("dead_bins = [40]"), "{said}");
    let mended = with_cube(cube.shape, all, "dead_bins = [40]").unwrap();
    assert_eq!(mended.warnings, [""; 0]);
    let all = samples(&cube);
    let error = with_cube(cube.shape, all, "dead_bins = [95]").unwrap_err();
    assert!(error.to_string().contains("no bin 95"), "{error}");
}

/// The same of cubes that are read from disk, of which a small part is looked at; dead bins are mended alike.
#[test]
fn cubes_on_disk_are_looked_at_and_mended_too() {
    let folder = tempfile::tempdir().unwrap();
    let cube = recording();
    let [h, w, t, c] = cube.shape;
    let mut all = samples(&cube);
    for line in all.chunks_mut(t * c) {
        line[40 * c..42 * c].fill(0.0);
    }
    let path = folder.path().join("a.npy");
    let written = Cube::new(cube.shape, CubeSamples::F32(all)).unwrap();
    nullray::io::image::npz::write_cube(&path, &written).unwrap();
    let store = |wanted: Wanted| -> CubeStore {
        Arc::new(Bricks::open(&path, wanted, 9 << 20).unwrap()).into()
    };
    let said = of_samples(&store(Wanted::default()), Order::Array).join("\n");
    assert!(
        said.contains("dead_bins = [40, 41]") && !said.contains("axes"),
        "{said}"
    );
    let wanted = Wanted {
        dead_bins: &[0, 40, 41],
        ..Wanted::default()
    };
    assert_eq!(of_samples(&store(wanted), Order::Array), [""; 0]);
    let whole = cube::load(&path, wanted).unwrap();
    let on_disk = Bricks::open(&path, wanted, 9 << 20).unwrap();
    let mut line = vec![0.0; t * c];
    for pixel in 0..h * w {
        on_disk.samples(&mut Default::default(), pixel, 0, &mut line);
        for (k, sample) in line.iter().enumerate() {
            assert_eq!(
                Some(*sample),
                whole.samples.get(pixel * t * c + k),
                "{pixel} {k}"
            );
        }
    }
    // Bin 41 lies two thirds of the way from 39 to 42; bin 0 has what bin 1 has.
    let at = |bin: usize| whole.samples.get((2000 * t + bin) * c).unwrap();
    assert!((at(41) - (at(39) + 2.0 * at(42)) / 3.0).abs() <= 1e-6 * at(41).abs());
    assert_eq!(at(0), at(1));

    let order = [t, h, w, c];
    let mut turned = Vec::new();
    for (bin, pixel) in (0..t).flat_map(|bin| (0..h * w).map(move |pixel| (bin, pixel))) {
        let at = (pixel * t + bin) * c;
        turned.extend((at..at + c).map(|n| written.samples.get(n).unwrap() as f32));
    }
    let turned = Cube::new(order, CubeSamples::F32(turned)).unwrap();
    nullray::io::image::npz::write_cube(&path, &turned).unwrap();
    let said = of_samples(&store(Wanted::default()), Order::Array).join("\n");
    assert!(said.contains("axes = \"T H W\""), "{said}");
}

/// Of the recording, a thousandth of the samples below 0: counted, said with the least, and dealt with as is asked, from memory
/// and from disk alike.
#[test]
fn samples_below_zero_are_counted_with_the_least_and_treated_as_requested() {
    let cube = recording();
    let mut all = samples(&cube);
    all.iter_mut().step_by(1009).for_each(|x| *x = -0.25 - *x);
    let [_, w, t, c] = cube.shape;
    all[((3 * w + 5) * t + 7) * c + 2] = -9e5;
    let count = all.iter().filter(|x| **x < 0.0).count();
    let said = |policy: &str| with_cube(cube.shape, all.clone(), policy);
    let warned = said("").unwrap().warnings.join("\n");
    assert!(
        warned.contains(&format!("{count} of {} samples are below 0", all.len()))
            && warned.contains("the least -900000 at [3, 5, 7, 2]")
            && warned.contains("negative = \"keep\""),
        "{warned}"
    );
    for policy in ["keep", "zero"] {
        let warned = said(&format!("negative = {policy:?}")).unwrap().warnings;
        let warned = warned.join("\n");
        assert!(!warned.contains("below 0"), "{policy}: {warned}");
    }
    let refused = said("negative = \"refuse\"").unwrap_err();
    let words = format!("{refused} {}", refused.help());
    assert!(
        words.contains("[3, 5, 7, 2]") && words.contains("\"zero\""),
        "{words}"
    );

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npy");
    let written = Cube::new(cube.shape, CubeSamples::F32(all.clone())).unwrap();
    nullray::io::image::npz::write_cube(&path, &written).unwrap();
    let with = |negative| Wanted {
        negative: Some(negative),
        ..Wanted::default()
    };
    let mut line = vec![0.0; t * c];
    for (negative, deal) in [
        (Negative::Keep, (|x| x) as fn(f32) -> f32),
        (Negative::Zero, |x| x.max(0.0)),
    ] {
        let whole = cube::load(&path, with(negative)).unwrap();
        let on_disk = Bricks::open(&path, with(negative), 9 << 20).unwrap();
        for pixel in 0..all.len() / (t * c) {
            on_disk.samples(&mut Default::default(), pixel, 0, &mut line);
            for (k, sample) in line.iter().enumerate() {
                let at = pixel * t * c + k;
                assert_eq!(*sample, f64::from(deal(all[at])), "{pixel} {k}");
                assert_eq!(whole.samples.get(at), Some(*sample));
            }
        }
        on_disk.check().unwrap();
    }
    let on_disk = Bricks::open(&path, with(Negative::Refuse), 9 << 20).unwrap();
    on_disk.samples(&mut Default::default(), 0, 0, &mut line);
    assert!(on_disk.check().unwrap_err().to_string().contains("below 0"));
    let store: CubeStore =
        Arc::new(Bricks::open(&path, Wanted::default(), 9 << 20).unwrap()).into();
    let said = of_samples(&store, Order::Array).join("\n");
    assert!(
        said.contains("below 0") && said.contains("part examined"),
        "{said}"
    );
}

/// The header says the other order of bytes than the samples have.
#[test]
fn bytes_in_the_wrong_order_are_reported_and_right_ones_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npy");
    let recorded = recording();
    let [h, w, t, c] = recorded.shape;
    // The recording has half precision; the other samples have all the digits of theirs.
    let full = |n: usize, x: f64| x * (1.0 + 1e-3 * (n as f64).sin());
    for (descr, other, digits) in [
        ("<f4", ">f4", false),
        ("<f4", ">f4", true),
        ("<f8", ">f8", true),
    ] {
        let mut bytes = Vec::new();
        for n in 0..recorded.samples.len() {
            let mut x = recorded.samples.get(n).unwrap();
            if digits {
                x = full(n, x);
            }
            match descr {
                "<f4" => bytes.extend((x as f32).to_le_bytes()),
                _ => bytes.extend(x.to_le_bytes()),
            }
        }
        for said in [descr, other] {
            let header = format!(
                "{{'descr': '{said}', 'fortran_order': False, 'shape': ({h}, {w}, {t}, {c}), }}"
            );
            let mut file = b"\x93NUMPY\x01\x00\x96\x00".to_vec();
            file.extend(format!("{header:<149}\n").bytes());
            file.extend(&bytes);
            std::fs::write(&path, file).unwrap();
            let found = match cube::load(&path, Wanted::default()) {
                Ok(cube) => of_samples(&cube.into(), Order::Array).join("\n"),
                Err(error) => format!("{error} {}", error.help()),
            };
            match said == descr {
                true => assert_eq!(found, "", "{descr}"),
                false => assert!(
                    found.contains("bytes in the other order"),
                    "{descr} {digits}: {found}"
                ),
            }
        }
    }
}

/// Cubes that the program comes with, and those by other programs: none is taken for one that was read in the wrong order of
/// bytes, and no sample of them is below 0.
#[test]
fn no_cube_of_the_scenes_and_of_other_programs_is_doubted() {
    let root = Path::new(ROOT);
    let mut looked_at = 0;
    for folder in [
        "scenes/corner",
        "tests/data/transient",
        "tests/data/mitransient",
    ] {
        for entry in std::fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let Ok(info) = cube::inspect(&path, Wanted::default()) else {
                continue;
            };
            if info.bytes > 64 << 20 || info.shape[2] < 8 {
                continue;
            }
            let cube = cube::load(&path, Wanted::default()).unwrap();
            assert!(cube.below_zero().is_none(), "{}", path.display());
            let found = of_samples(&cube.into(), Order::Stated).join("\n");
            assert!(
                !found.contains("bytes in the other order"),
                "{}: {found}",
                path.display()
            );
            looked_at += 1;
        }
    }
    assert!(looked_at >= 6, "{looked_at}");
}

/// Noise about 0 at the ends of the data is no light that is cut off there; light is, beside it.
#[test]
fn noise_about_zero_is_not_light_that_is_cut_off() {
    let noise = |n: usize| {
        let hash = (n as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (hash >> 40) as f64 / f64::from(1 << 24) - 0.5
    };
    let [h, w, t] = [32, 32, 40];
    let cube = |pulse: usize| {
        let value = |n: usize| {
            let bin = n % t;
            let light = (-0.5 * ((bin as f64 - pulse as f64) / 2.0).powi(2)).exp();
            (light + 0.6 * noise(n)) as f32
        };
        let samples = (0..h * w * t).map(value).collect();
        Cube::new([h, w, t, 1], CubeSamples::F32(samples)).unwrap()
    };
    let said = |pulse| of_samples(&cube(pulse).into(), Order::Stated).join("\n");
    assert!(
        !said(20).contains("cut off") && said(20).contains("below 0"),
        "{}",
        said(20)
    );
    assert!(said(39).contains("last bin is still lit"), "{}", said(39));
}
