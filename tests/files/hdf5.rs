//! Captures in HDF5 files, by their own writers (`tests/data/hdf5`), against the closed form that they were made from.

use std::path::{Path, PathBuf};

use glam::DVec3;
use nullray::Error;
use nullray::io::cube::{self, Axes, Changes, Cube, CubeInfo, FileTimes, Wanted};

const ROWS: usize = 4;
const COLUMNS: usize = 5;
const BINS: usize = 96;
const WIDTH: f64 = 0.05;
const START: f64 = 1.0;
const HIDDEN: DVec3 = DVec3::new(0.1, 0.2, 0.9);
const LASER: DVec3 = DVec3::new(-0.5, 0.0, 0.8);
const SENSOR: DVec3 = DVec3::new(0.3, -0.2, 0.7);

/// The point of row i and column j.
fn wall(i: usize, j: usize) -> DVec3 {
    DVec3::new(-0.4 + 0.2 * j as f64, -0.3 + 0.25 * i as f64, 0.0)
}

fn lit() -> DVec3 {
    wall(1, 2)
}

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/hdf5")
        .join(name)
}

fn load(name: &str, wanted: Wanted) -> Cube {
    let path = data(name);
    let cube = cube::load(&path, wanted).unwrap_or_else(|e| panic!("{name}: {e} {}", e.help()));
    let info = cube::inspect(&path, wanted).unwrap();
    assert_eq!(
        (info.shape, info.bytes),
        (cube.shape, cube.samples.bytes()),
        "{name}"
    );
    cube
}

/// The mean time of what arrives at each pixel, against `path(pixel's point)`. A Gaussian that is sampled every third of its
/// width has the mean of its samples where its own is to 1e-9; `tolerance` is that of the samples' precision.
fn assert_arrivals(name: &str, cube: &Cube, path: impl Fn(DVec3) -> f64, tolerance: f64) {
    assert_eq!(cube.shape[..3], [ROWS, COLUMNS, BINS], "{name}");
    for pixel in 0..ROWS * COLUMNS {
        let (mut sum, mut moment) = (0.0, 0.0);
        for bin in 0..BINS {
            let value = cube.total(pixel, bin);
            sum += value;
            moment += value * (START + WIDTH * (bin as f64 + 0.5));
        }
        let expected = path(wall(pixel / COLUMNS, pixel % COLUMNS));
        assert!(
            (moment / sum - expected).abs() < tolerance,
            "{name}, pixel {pixel}: {} for {expected}",
            moment / sum
        );
    }
}

fn from(lit: DVec3) -> impl Fn(DVec3) -> f64 {
    move |point| lit.distance(HIDDEN) + HIDDEN.distance(point)
}

/// With the ways from the laser to the wall and from the wall to the sensor.
fn both_ways(point: DVec3) -> f64 {
    from(lit())(point) + LASER.distance(lit()) + point.distance(SENSOR)
}

fn times(name: &str) -> FileTimes {
    cube::times(&data(name), None).unwrap().unwrap()
}

#[test]
fn y_tal_is_read_in_all_its_formats() {
    for name in ["tal_1.hdf5", "tal_3.hdf5"] {
        assert_arrivals(name, &load(name, Wanted::default()), from(lit()), 1e-6);
        assert!(!times(name).at_sensor);
    }
    for name in ["tal_1_both.hdf5", "tal_spelling.hdf5"] {
        assert_arrivals(name, &load(name, Wanted::default()), both_ways, 1e-6);
        assert!(times(name).at_sensor, "{name}");
    }
    assert_arrivals(
        "tal_2",
        &load("tal_2.hdf5", Wanted::array("H[1,0]")),
        from(wall(2, 1)),
        1e-6,
    );
    assert_arrivals(
        "tal_4",
        &load("tal_4.hdf5", Wanted::array("H[3]")),
        from(wall(2, 2)),
        1e-6,
    );
    let FileTimes { start, width, .. } = times("tal_1.hdf5");
    assert_eq!((start, width), (START, WIDTH));
}

#[test]
fn confocal_captures_are_said_to_be_of_as_many_flashes_as_points() {
    let path = |point: DVec3| 2.0 * point.distance(HIDDEN);
    let cube = load("tal_confocal.hdf5", Wanted::default());
    assert_arrivals("tal_confocal", &cube, path, 1e-6);
    let is_said = |name: &str| {
        let info = cube::inspect(&data(name), Wanted::default()).unwrap();
        info.notes.iter().any(|note| note.contains("confocal"))
    };
    assert!(is_said("tal_confocal.hdf5"));
    for other in ["tal_1.hdf5", "tal_3.hdf5", "zaragoza_5.hdf5"] {
        assert!(!is_said(other), "{other}");
    }
}

#[test]
fn bounces_of_the_zaragoza_data_set_are_added_up() {
    for name in ["zaragoza_5.hdf5", "zaragoza_7.hdf5"] {
        let cube = load(name, Wanted::default());
        assert_arrivals(name, &cube, both_ways, 1e-6);
        // 0.75 and 0.25 of a pulse whose sum over bins is √(2π) · 0.15/0.05.
        let sum: f64 = (0..BINS).map(|bin| cube.total(7, bin)).sum();
        assert!(
            (sum - 3.0 * (2.0 * std::f64::consts::PI).sqrt()).abs() < 1e-5,
            "{sum}"
        );
        let times = times(name);
        assert!(times.at_sensor && (times.width - WIDTH).abs() < 1e-8);
        let info = cube::inspect(&data(name), Wanted::default()).unwrap();
        assert!(
            !info.assumed && info.notes.iter().any(|note| note.contains("added up")),
            "{:?}",
            info.notes
        );
    }
    // Declared axes are taken instead: one of the bounces, chosen by its number.
    let axes: Axes = "C T L H W".parse().unwrap();
    let wanted = Wanted {
        axes: Some(&axes),
        ..Wanted::array("data[1]")
    };
    let sum: f64 = (0..BINS)
        .map(|bin| load("zaragoza_5.hdf5", wanted).total(7, bin))
        .sum();
    assert!(
        (sum - 0.75 * (2.0 * std::f64::consts::PI).sqrt()).abs() < 1e-5,
        "{sum}"
    );
}

#[test]
fn phasor_fields_are_pictures_of_the_points_that_the_laser_lit() {
    let swapped = |point: DVec3| {
        from(lit())(point) + lit().distance(SENSOR) - lit().distance(SENSOR) + lit_to_laser(point)
    };
    // Light goes from the laser to each point, to the hidden one, to the one that the camera sees, and to the camera.
    fn lit_to_laser(point: DVec3) -> f64 {
        wall(1, 2).distance(SENSOR) + point.distance(LASER)
    }
    assert_arrivals(
        "phasor_fields.mat",
        &load("phasor_fields.mat", Wanted::default()),
        swapped,
        1e-6,
    );
    assert!(times("phasor_fields.mat").at_sensor);
}

#[test]
fn coverage_beside_the_colours_of_transient_nerf_is_left_out() {
    let cube = load("transient_nerf.h5", Wanted::default());
    assert_eq!(cube.shape, [ROWS, COLUMNS, BINS, 3]);
    assert_arrivals("transient_nerf.h5", &cube, from(lit()), 1e-3);
    let at = |channel: usize| cube.samples.get((3 * BINS + 19) * 3 + channel).unwrap();
    assert!((at(1) / at(0) - 0.5).abs() < 1e-2 && (at(2) / at(0) - 0.25).abs() < 1e-2);
    assert_eq!(cube::times(&data("transient_nerf.h5"), None).unwrap(), None);
}

#[test]
fn every_kind_of_numbers_and_of_storage_has_its_values() {
    let mut count = 0;
    for format in cube::FORMATS
        .iter()
        .filter(|format| format.extensions.contains(&"h5"))
    {
        for header in (format.arrays)(&data("kinds.h5")).unwrap() {
            let name = header.name.unwrap();
            let cube = load("kinds.h5", Wanted::array(&name));
            assert_eq!(cube.shape, [2, 3, 4, 1], "{name}");
            for n in 0..24 {
                assert_eq!(cube.samples.get(n), Some(n as f64), "{name}");
            }
            count += 1;
        }
    }
    assert_eq!(count, 20);
}

/// Arrays by h5py whose axes are said in every way that there is (`axes.h5`).
#[test]
fn axes_are_those_that_the_file_says_and_asked_for_where_it_says_others() {
    let path = data("axes.h5");
    for (name, by) in [
        ("labels", "dimension labels"),
        ("scale/of_group", "dimension scales"),
        ("attribute", "attribute `axes`"),
        ("fixed", "attribute `axes`"),
        ("both", "attribute `axes`"),
        ("unsaid", ""),
        ("matlab", ""),
    ] {
        let info = cube::inspect(&path, Wanted::array(name)).unwrap();
        assert_eq!(info.shape, [2, 3, 5, 1], "{name}");
        assert_eq!(info.assumed, by.is_empty(), "{name}");
        let said = format!("axes T H W, by its {by}");
        assert_eq!(
            info.notes.contains(&said),
            !by.is_empty(),
            "{name}: {:?}",
            info.notes
        );
        let cube = load("axes.h5", Wanted::array(name));
        for n in 0..30 {
            let [i, j, k] = [n / 15, n / 5 % 3, n % 5];
            assert_eq!(
                cube.samples.get(n),
                Some((100 * i + 10 * j + k) as f64),
                "{name}"
            );
        }
    }
    let times = cube::times(&path, Some("attribute")).unwrap().unwrap();
    assert_eq!((times.start, times.width), (1.5, 0.25));
    assert_eq!(cube::times(&path, Some("fixed")).unwrap(), None);
    let axes: Axes = "T H W".parse().unwrap();
    for (name, words) in [
        ("partly", "called (no name), (no name), time"),
        ("others", "called wavelength, y, x"),
        ("wrong", "\"T Q W\": 'Q'"),
        ("picture", "probably a colour picture"),
    ] {
        let error = cube::load(&path, Wanted::array(name)).unwrap_err();
        let said = format!("{error}; {}", error.help());
        assert!(
            said.contains(words) && said.contains("axes"),
            "{name}: {said}"
        );
        // Who says them is believed.
        let wanted = Wanted {
            axes: Some(&axes),
            ..Wanted::array(name)
        };
        assert!(!cube::inspect(&path, wanted).unwrap().assumed);
    }
    // What is written here says all that it is read by.
    let folder = tempfile::tempdir().unwrap();
    let written = folder.path().join("a.h5");
    let times = FileTimes {
        start: 1.0,
        width: 0.5,
        at_sensor: false,
    };
    let changes = Changes {
        times: Some(times),
        axes: Some("T H W".parse().unwrap()),
        ..Changes::default()
    };
    let from = (&*path, Wanted::array("attribute"));
    cube::convert(from, &written, &changes, &mut |_, _| true).unwrap();
    let notes = cube::inspect(&written, Wanted::default()).unwrap().notes;
    let expected = [
        "axes T H W, by its attribute `axes`",
        "start 1 m, bin_width 0.5 m, by its attributes",
    ];
    assert_eq!(notes, expected);
}

#[test]
fn the_wall_is_where_the_file_says() {
    for name in [
        "tal_1.hdf5",
        "tal_3.hdf5",
        "zaragoza_5.hdf5",
        "phasor_fields.mat",
    ] {
        let found = cube::wall(&data(name), Wanted::default()).unwrap().unwrap();
        assert_eq!(found.size, [ROWS, COLUMNS], "{name}");
        for (n, point) in found.points.iter().enumerate() {
            assert!(
                point.distance(wall(n / COLUMNS, n % COLUMNS)) < 1e-7,
                "{name} {n}"
            );
        }
        assert!(found.normals.iter().all(|normal| *normal == DVec3::Z));
        let sensor = if name == "phasor_fields.mat" {
            LASER
        } else {
            SENSOR
        };
        assert!(found.sensor.unwrap().distance(sensor) < 1e-7);
    }
}

/// Taking off the way to the sensor leaves the times at the wall; what goes through a temporary file is what is loaded.
#[test]
fn captures_are_converted_and_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let from_file = (&*data("zaragoza_7.hdf5"), Wanted::default());
    let distances = cube::wall(from_file.0, from_file.1)
        .unwrap()
        .unwrap()
        .distances()
        .unwrap();
    let changes = Changes {
        shift: Some(distances.iter().map(|r| -r / WIDTH).collect()),
        times: Some(FileTimes {
            start: START,
            width: WIDTH,
            at_sensor: false,
        }),
        ..Changes::default()
    };
    let converted = cube::convert(from_file, &path("wall.h5"), &changes, &mut |_, _| true).unwrap();
    let FileTimes { start, width, .. } = cube::times(&path("wall.h5"), None).unwrap().unwrap();
    assert!((start - (START + converted.later * WIDTH)).abs() < 1e-12 && width == WIDTH);
    let cube = cube::load(&path("wall.h5"), Wanted::default()).unwrap();
    for pixel in 0..20 {
        let bins = 0..cube.shape[2];
        let sum: f64 = bins.clone().map(|bin| cube.total(pixel, bin)).sum();
        let moment: f64 = bins
            .map(|bin| cube.total(pixel, bin) * (start + width * (bin as f64 + 0.5)))
            .sum();
        let expected = from(lit())(wall(pixel / 5, pixel % 5)) + LASER.distance(lit());
        assert!((moment / sum - expected).abs() < 1e-6, "pixel {pixel}");
    }
    // npy, HDF5 of other axes and precisions, and back to npy: the same samples.
    let plain = Changes::default();
    cube::convert(from_file, &path("a.npy"), &plain, &mut |_, _| true).unwrap();
    for (axes, name) in [("T H W C", "b.h5"), ("H W T", "c.hdf5"), ("T W H", "d.h5")] {
        let changes = Changes {
            axes: Some(axes.parse().unwrap()),
            ..Changes::default()
        };
        cube::convert(
            (&path("a.npy"), Wanted::default()),
            &path(name),
            &changes,
            &mut |_, _| true,
        )
        .unwrap();
        let info: CubeInfo = cube::inspect(&path(name), Wanted::default()).unwrap();
        assert_eq!(
            (info.axes.to_string().as_str(), info.assumed),
            (axes, false)
        );
        let back = cube::load(&path(name), Wanted::default()).unwrap();
        assert_eq!(
            back,
            cube::load(&path("a.npy"), Wanted::default()).unwrap(),
            "{name}"
        );
        cube::convert(
            (&path(name), Wanted::default()),
            &path("e.npy"),
            &plain,
            &mut |_, _| true,
        )
        .unwrap();
        assert!(
            std::fs::read(path("e.npy")).unwrap() == std::fs::read(path("a.npy")).unwrap(),
            "{name}"
        );
    }
}

#[test]
fn what_cannot_be_used_is_refused_with_what_would_be_right() {
    let refusal = |name: &str, array: Option<&str>, axes: Option<&str>| {
        let axes = axes.map(|axes| axes.parse::<Axes>().unwrap());
        let wanted = Wanted {
            array,
            axes: axes.as_ref(),
            ..Wanted::default()
        };
        let error = cube::load(&data(name), wanted).unwrap_err();
        assert!(matches!(error, Error::Invalid(_) | Error::Unsupported(_)));
        format!("{error}; {}", error.help())
    };
    for (refusal, words) in [
        (refusal("tal_2.hdf5", None, None), "array = \"H["),
        (refusal("tal_2.hdf5", Some("H[2,0]"), None), "no entry 2"),
        (refusal("tal_1.hdf5", Some("G"), None), "it holds H"),
        (refusal("kinds.h5", None, None), "several arrays"),
        (
            refusal("zaragoza_7.hdf5", None, Some("H W T")),
            "7 axes, and 3 are named",
        ),
    ] {
        assert!(refusal.contains(words), "{refusal}");
    }
}

/// Bytes of small files changed and cut: an answer, and no more memory than the file is worth.
#[test]
fn damaged_files_are_refused_or_read_but_never_break_the_reader() {
    let mut random = crate::random_numbers();
    for name in [
        "tal_3.hdf5",
        "zaragoza_7.hdf5",
        "phasor_fields.mat",
        "kinds.h5",
    ] {
        let whole = std::fs::read(data(name)).unwrap();
        for round in 0..400 {
            let mut bytes = whole.clone();
            for _ in 0..1 + random() % 3 {
                let at = random() % bytes.len();
                bytes[at] = random() as u8;
            }
            if round % 8 == 0 {
                bytes.truncate(random() % whole.len());
            }
            let _ = cube::load_bytes(&bytes, name, Wanted::default());
            let _ = cube::load_bytes(&bytes, name, Wanted::array("storage/gzip"));
        }
    }
}

/// A scene with this file as the texture of a surface.
fn scene(file: &str) -> Result<nullray::scene::model::Scene, Error> {
    let text = format!(
        "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nhfov = \"40 deg\"\n[[object]]\nname = \"wall\"\nshape = {{ sphere = {{ radius = 1 }} }}\n\
         [[source]]\nobjects = [\"wall\"]\n[source.cube]\nfile = \"{file}\"\nuv = 0\n"
    );
    nullray::scene::parse(
        &text,
        "wall.toml",
        &data(""),
        &nullray::scene::Overrides::default(),
    )
}

#[test]
fn scenes_take_times_from_the_file_unless_they_include_the_way_to_a_sensor() {
    use nullray::scene::model::{SourceKind, TimeBins};
    let SourceKind::Cube(cube) = scene("tal_1.hdf5").unwrap().sources.remove(0).kind else {
        panic!("no cube");
    };
    let TimeBins::Uniform { start, width } = cube.bins else {
        panic!("no uniform bins");
    };
    assert_eq!((start, width), (START, WIDTH));
    let refused = scene("tal_1_both.hdf5").unwrap_err();
    let said = format!("{refused} {}", refused.help());
    assert!(
        said.contains("arrival at its sensor") && said.contains("--unwarp tal_1_both.hdf5"),
        "{said}"
    );
}
