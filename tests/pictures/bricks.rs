//! Cubes larger than the memory limit: pictures have the bits of cubes in memory, and the amount read is as estimated.

use std::fs::{File, OpenOptions};
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::Path;

use nullray::error::{Error, Result};
use nullray::io::cube::BytesRead;
use nullray::render::estimate_reads;
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::{LoadedCubes, Prepared};
use nullray::render::progress::Silent;
use nullray::render::{render, render_with_stats};
use nullray::scene::model::Scene;
use nullray::scene::{Overrides, parse};
use tempfile::TempDir;

/// 80 × 96 pixels and 700 bins of one channel: 20.5 MiB in single precision.
const SHAPE: [usize; 4] = [80, 96, 700, 1];

/// Of more than three channels there are fewer bins, which last as long in all.
fn bins(channels: usize) -> usize {
    SHAPE[2] / channels.div_ceil(3)
}

/// A number that tells nothing of its neighbours, exact in half precision.
fn sample(index: usize) -> u16 {
    (index as u64)
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .rotate_left(24) as u16
        % 1024
}

/// How an array is stored: its axes, its type, the order in memory.
struct Stored {
    axes: &'static str,
    descr: &'static str,
    fortran: bool,
    channels: usize,
}

/// Writes an array of `sample`s of (row, column, bin, channel).
fn write(path: &Path, stored: &Stored) {
    let shape = [SHAPE[0], SHAPE[1], bins(stored.channels), stored.channels];
    let slots: Vec<usize> = stored.axes.chars().filter_map(|c| "HWTC".find(c)).collect();
    let sizes: Vec<usize> = slots.iter().map(|slot| shape[*slot]).collect();
    let text: Vec<String> = sizes.iter().map(|n| format!("{n},")).collect();
    let order = if stored.fortran { "True" } else { "False" };
    let header = format!(
        "{{'descr': '{}', 'fortran_order': {order}, 'shape': ({}), }}",
        stored.descr,
        text.join(" ")
    );
    let mut file = BufWriter::new(File::create(path).unwrap());
    file.write_all(b"\x93NUMPY\x01\x00\x76\x00").unwrap();
    file.write_all(format!("{header:<117}\n").as_bytes())
        .unwrap();
    // The file's axes, the slowest first, and how far apart their entries are in (H, W, T, C).
    let strides = [
        shape[1] * shape[2] * shape[3],
        shape[2] * shape[3],
        shape[3],
        1,
    ];
    let mut axes: Vec<(usize, usize)> = sizes
        .iter()
        .zip(&slots)
        .map(|(size, slot)| (*size, strides[*slot]))
        .collect();
    if stored.fortran {
        axes.reverse();
    }
    let count: usize = sizes.iter().product();
    for n in 0..count {
        let (mut rest, mut index) = (n, 0);
        for (size, stride) in axes.iter().rev() {
            index += rest % size * stride;
            rest /= size;
        }
        let number = sample(index);
        match stored.descr {
            "<f2" => file.write_all(&half::f16::from_f32(f32::from(number)).to_le_bytes()),
            "<f4" => file.write_all(&f32::from(number).to_le_bytes()),
            ">f4" => file.write_all(&f32::from(number).to_be_bytes()),
            "<u2" => file.write_all(&number.to_le_bytes()),
            other => panic!("{other}"),
        }
        .unwrap();
    }
    file.flush().unwrap();
}

const UV: &str = "uv = 0";
const CAPTURE: &str = "clock = \"capture\"
[source.cube.capture]
eye = [1, 1, 4]
look_at = [0, 0, 0]
hfov = \"60 deg\"";

/// A camera that passes a plane and a ball, both showing the cube.
fn scene(folder: &TempDir, axes: &str, filter: &str, mapping: &str) -> Scene {
    scene_of(1, folder, axes, filter, mapping)
}

/// The same with a cube of that many channels.
fn scene_of(channels: usize, folder: &TempDir, axes: &str, filter: &str, mapping: &str) -> Scene {
    let width = 14.0 / bins(channels) as f64;
    let text = format!(
        "[camera]
eye = [0.3, 0.2, 3]
look_at = [0, 0, 0]
hfov = \"70 deg\"
size = [80, 64]
velocity = {{ beta = [0.4, 0, 0] }}
time = \"8 m\"
[display]
samples_per_pixel = 2
[[object]]
name = \"plane\"
shape = {{ plane = {{ size = [4, 4] }} }}
transform = {{ rotate = {{ axis = [1, 0, 0], angle = \"90 deg\" }} }}
[[object]]
name = \"ball\"
shape = {{ sphere = {{ radius = 0.5 }} }}
[[source]]
[source.cube]
file = \"cube.npy\"
axes = \"{axes}\"
start = \"-2 m\"
bin_width = \"{width} m\"
filter = \"{filter}\"
{mapping}
"
    );
    parse(&text, "test scene", folder.path(), &Overrides::default()).unwrap()
}

/// The plan with so much room for bricks, bytes; or without a limit.
fn plan(scene: &Scene, room: Option<u64>) -> Plan {
    let whole = Plan::new(scene, &Request::default()).unwrap();
    let Some(room) = room else {
        return whole;
    };
    let bytes = whole.cubes[0].as_ref().unwrap().bytes;
    let request = Request {
        memory_limit: (whole.memory.total() - bytes + room).min(whole.memory.total() - 1),
        ..Request::default()
    };
    let plan = Plan::new(scene, &request).unwrap();
    assert!(plan.cubes[0].as_ref().unwrap().held.is_some());
    assert!(plan.memory.total() <= request.memory_limit);
    plan
}

fn film(scene: &Scene, plan: &Plan, threads: usize) -> Result<Film> {
    film_sharing(scene, plan, threads, &mut LoadedCubes::default())
}

/// The same, with the cube of the last scene if that was in memory.
fn film_sharing(
    scene: &Scene,
    plan: &Plan,
    threads: usize,
    cubes: &mut LoadedCubes,
) -> Result<Film> {
    let prepared = Prepared::sharing(scene, plan, cubes, &Silent)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let pool = pool.build().unwrap();
    pool.install(|| render(&prepared, &Silent))
}

fn bits(film: &Film) -> Vec<u64> {
    film.radiance()
        .iter()
        .flatten()
        .map(|c| c.to_bits())
        .collect()
}

const SMALL: u64 = 9 << 20;

fn same_bits(stored: &Stored, filters: &[&str], mappings: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("cube.npy"), stored);
    let mut cubes = LoadedCubes::default();
    for filter in filters {
        for mapping in mappings {
            let scene = scene_of(stored.channels, &folder, stored.axes, filter, mapping);
            let whole = film_sharing(&scene, &plan(&scene, None), 2, &mut cubes);
            let whole = bits(&whole.unwrap());
            assert!(whole.iter().any(|bits| *bits != 0));
            for threads in [1, 3] {
                let parts = bits(&film(&scene, &plan(&scene, Some(SMALL)), threads).unwrap());
                assert!(parts == whole, "{} {filter} {mapping}", stored.axes);
            }
        }
    }
}

#[test]
fn pictures_from_bricks_have_the_bits_of_those_from_memory() {
    let stored = Stored {
        axes: "HWT",
        descr: "<f4",
        fortran: false,
        channels: 1,
    };
    let sharp = format!("reconstruction = \"sharp\"\n{CAPTURE}");
    same_bits(
        &stored,
        &["nearest", "linear", "cubic", "cubic_means"],
        &[UV, CAPTURE, &sharp],
    );
    // Means over what samples stand for, and over an exposure.
    let mappings =
        [UV, CAPTURE].map(|mapping| format!("reconstruction = \"footprint\"\n{mapping}"));
    let exposed = |mapping: &str| {
        format!("{mapping}\n[camera.shutter]\nduration = \"0.1 m\"\nintegration = \"means\"")
    };
    let [uv, capture, sharp_means] = [&mappings[0], &mappings[1], &sharp].map(|m| exposed(m));
    same_bits(
        &stored,
        &["cubic_means"],
        &[&mappings[0], &mappings[1], &uv, &capture, &sharp_means],
    );
}

#[test]
fn bricks_hold_every_type_and_every_order_of_axes() {
    for (axes, descr, fortran, channels) in [
        ("THW", "<f4", false, 1),
        ("CTHW", "<f2", false, 3),
        ("HWTC", ">f4", false, 3),
        ("HWTC", "<u2", true, 3),
    ] {
        let stored = Stored {
            axes,
            descr,
            fortran,
            channels,
        };
        same_bits(&stored, &["cubic_means"], &[UV, CAPTURE]);
    }
}

#[test]
fn companions_from_bricks_have_the_bits_of_those_from_memory() {
    for (axes, fortran) in [("HWTC", false), ("CTHW", true)] {
        let stored = Stored {
            axes,
            descr: "<f2",
            fortran,
            channels: 5,
        };
        let named = |mapping: &str| {
            let channels = "channels = [\"UV\", \"G\", \"R\", \"IR\", \"B\"]";
            format!("{channels}\n{mapping}\n[radiance]\nquantity = \"rgb\"")
        };
        same_bits(&stored, &["linear"], &[&named(UV), &named(CAPTURE)]);
    }
}

fn plain(folder: &TempDir) {
    let stored = Stored {
        axes: "HWT",
        descr: "<f4",
        fortran: false,
        channels: 1,
    };
    write(&folder.path().join("cube.npy"), &stored);
}

#[test]
fn as_much_is_read_as_was_estimated_and_nothing_twice_where_there_is_room() {
    let folder = tempfile::tempdir().unwrap();
    plain(&folder);
    for mapping in [UV, CAPTURE] {
        let scene = scene(&folder, "HWT", "cubic_means", mapping);
        let mut plan = plan(&scene, Some(64 << 20));
        estimate_reads(&scene, &mut plan, &Silent).unwrap();
        let estimated = plan.cubes[0].as_ref().unwrap().read.unwrap();
        let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
        let (_, stats) = render_with_stats(&prepared, &Silent).unwrap();
        let BytesRead { all, again, .. } = stats.disk;
        assert_eq!((all, again), (estimated, 0));
        // Each of 5,120 pixels has two samples of four texels, each in two bricks at the most.
        assert!(all > 1 << 20 && all <= 5120 * 2 * 4 * 2 * 4096, "{all}");
        // What is there already is not read for the next picture.
        let (_, stats) = render_with_stats(&prepared, &Silent).unwrap();
        assert_eq!(stats.disk, BytesRead::default());
    }
}

#[test]
fn a_file_that_shrinks_and_non_finite_samples_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    plain(&folder);
    let path = folder.path().join("cube.npy");
    let scene = scene(&folder, "HWT", "cubic_means", UV);
    let plan = plan(&scene, Some(SMALL));
    let told = |result: Result<Film>| match result {
        Err(error @ Error::Invalid(_)) => error.to_string(),
        other => panic!("{other:?}"),
    };

    let mut file = OpenOptions::new().write(true).open(&path).unwrap();
    for pixel in 0..SHAPE[0] * SHAPE[1] {
        // In the middle of what is seen at that time.
        let at = 128 + 4 * (pixel * SHAPE[2] + 360) as u64;
        file.seek(SeekFrom::Start(at)).unwrap();
        file.write_all(&f32::NAN.to_le_bytes()).unwrap();
    }
    let error = told(film(&scene, &plan, 2));
    assert!(
        error.contains("finite") && error.contains("cube.npy"),
        "{error}"
    );

    let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    file.set_len(4096).unwrap();
    let error = told(render(&prepared, &Silent));
    assert!(
        error.contains("shorter") && error.contains("cube.npy"),
        "{error}"
    );
    // The next picture tries again, and says so again.
    assert!(render(&prepared, &Silent).is_err());
}

#[test]
#[cfg(unix)]
fn a_file_that_is_overwritten_while_it_is_read_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    plain(&folder);
    let path = folder.path().join("cube.npy");
    let scene = scene(&folder, "HWT", "cubic_means", UV);
    let plan = plan(&scene, Some(SMALL));
    let modified = || std::fs::metadata(&path).unwrap().modified().unwrap();
    // The first sample, with the time of the last change as it was.
    let overwrite = |value: f32| {
        let then = modified();
        let mut file = OpenOptions::new().write(true).open(&path).unwrap();
        file.seek(SeekFrom::Start(128)).unwrap();
        file.write_all(&value.to_le_bytes()).unwrap();
        file.set_modified(then).unwrap();
    };
    for value in [0.5, 0.25] {
        let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
        render(&prepared, &Silent).unwrap();
        // Times of files go in steps of the system's clock.
        std::thread::sleep(std::time::Duration::from_millis(30));
        overwrite(value);
        let error = render(&prepared, &Silent).err().unwrap().to_string();
        let is_told = error.contains("cube.npy") && error.contains("changed while it was read");
        assert!(is_told, "{error}");
    }
    // Another file under its name changes nothing of it.
    let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    let before = render(&prepared, &Silent).unwrap();
    std::thread::sleep(std::time::Duration::from_millis(30));
    std::fs::write(folder.path().join("other"), [0; 4096]).unwrap();
    std::fs::rename(folder.path().join("other"), &path).unwrap();
    let after = render(&prepared, &Silent).unwrap();
    let bits = |film: &Film| {
        film.radiance()
            .iter()
            .map(|r| r.map(f64::to_bits))
            .collect::<Vec<_>>()
    };
    assert_eq!(bits(&before), bits(&after));
}
