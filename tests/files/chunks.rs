//! Arrays in chunks, read brick by brick: the same as when loaded whole, without a temporary file.

use std::fs;
use std::path::{Path, PathBuf};

use nullray::io::cube::{self, Axes, Bricks, Changes, Cube, CubeSamples, Held, Wanted};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::{Overrides, parse};

const ROOM: u64 = 9 << 20;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data")
        .join(name)
}

/// All samples of both, pixel by pixel in an order that jumps, some named before.
fn assert_same(path: &Path, wanted: Wanted) {
    let name = format!("{} {:?}", path.display(), wanted.array);
    let whole = cube::load(path, wanted).unwrap_or_else(|e| panic!("{name}: {e}"));
    // Nothing is unpacked: what is only counted has no temporary file.
    assert!(Bricks::counting(path, wanted, ROOM).unwrap().is_some());
    let bricks = Bricks::open(path, wanted, ROOM).unwrap();
    let [h, w, bins, channels] = whole.shape;
    assert_eq!(bricks.shape(), whole.shape, "{name}");
    let (mut held, mut wanted) = (Held::default(), Vec::new());
    let mut line = vec![0.0; bins * channels];
    for n in 0..h * w {
        let pixel = n * 7919 % (h * w);
        if n % 3 == 0 {
            bricks.want(&held, pixel, 0, bins, &mut wanted);
            bricks.bring(&mut held, &mut wanted);
        }
        bricks.samples(&mut held, pixel, 0, &mut line);
        for (k, sample) in line.iter().enumerate() {
            let expected = whole.samples.get(pixel * bins * channels + k);
            assert_eq!(Some(*sample), expected, "{name} {pixel} {k}");
        }
        let (last, channel) = (bins - 1, channels - 1);
        assert_eq!(bricks.sample(pixel, last, channel), line[line.len() - 1]);
    }
    bricks.check().unwrap();
}

/// A part of the cube, converted, has the samples of the whole: read in windows, with as little memory as is taken, and so by a
/// temporary file where chunks are thick.
fn assert_converted(path: &Path, wanted: Wanted) {
    let name = format!("{} {:?} {:?}", path.display(), wanted.array, wanted.axes);
    let whole = cube::load(path, wanted).unwrap_or_else(|e| panic!("{name}: {e}"));
    let [h, w, t, c] = whole.shape;
    let folder = tempfile::tempdir().unwrap();
    let (rows, columns, bins) = (h / 3..h, w / 2..w, t / 4..t);
    for (axes, memory) in ["H W T C", "T C H W"]
        .into_iter()
        .flat_map(|axes| [16 << 30, 3000].map(|memory| (axes, memory)))
    {
        let axes: Axes = axes.parse().unwrap();
        let changes = Changes {
            rows: Some(rows.clone()),
            columns: Some(columns.clone()),
            bins: Some(bins.clone()),
            axes: Some(axes.clone()),
            memory,
            ..Changes::default()
        };
        let to = folder.path().join("part.npy");
        match cube::convert((path, wanted), &to, &changes, &mut |_, _| true) {
            Err(error) if memory == 3000 => {
                // A single row or bin is more than that.
                assert!(error.to_string().contains("memory"), "{name}: {error}");
                continue;
            }
            converted => converted.unwrap_or_else(|e| panic!("{name}: {e}")),
        };
        let of_part = Wanted {
            axes: Some(&axes),
            ..Wanted::default()
        };
        let part = cube::load(&to, of_part).unwrap();
        assert_eq!(
            part.shape,
            [rows.len(), columns.len(), bins.len(), c],
            "{name}"
        );
        for n in 0..part.samples.len() {
            let (k, l) = (n / c % bins.len() + bins.start, n % c);
            let pixel = n / c / bins.len();
            let (i, j) = (
                pixel / columns.len() + rows.start,
                pixel % columns.len() + columns.start,
            );
            let at = ((i * w + j) * t + k) * c + l;
            assert_eq!(
                part.samples.get(n),
                whole.samples.get(at),
                "{name} {axes} {n}"
            );
        }
    }
}

#[test]
fn every_kind_of_chunks_is_read_brick_by_brick() {
    for name in [
        "plain",
        "zstd",
        "gzip",
        "big",
        "frames",
        "turned",
        "sharded",
        "sharded_start",
        "missing",
        "missing_in_shard",
    ] {
        assert_same(&data("zarr").join(name), Wanted::default());
        assert_converted(&data("zarr").join(name), Wanted::default());
    }
    for (array, axes) in [("[3]", "L H W"), ("", "S H W"), ("", "T W H")] {
        let axes: Axes = axes.parse().unwrap();
        let wanted = Wanted {
            axes: Some(&axes),
            array: Some(array).filter(|array| !array.is_empty()),
            ..Wanted::default()
        };
        assert_same(&data("zarr/zstd"), wanted);
        assert_converted(&data("zarr/zstd"), wanted);
    }
}

#[test]
fn every_layout_of_hdf5_is_read_brick_by_brick() {
    for (name, array) in [
        ("tal_1.hdf5", None),
        ("tal_2.hdf5", Some("H[1,0]")),
        ("tal_3.hdf5", None),
        ("tal_4.hdf5", Some("H[3]")),
        ("zaragoza_5.hdf5", None),
        ("zaragoza_7.hdf5", None),
        ("phasor_fields.mat", None),
        ("transient_nerf.h5", None),
        ("kinds.h5", Some("storage/gzip")),
    ] {
        let wanted = Wanted {
            array,
            ..Wanted::default()
        };
        assert_same(&data("hdf5").join(name), wanted);
        assert_converted(&data("hdf5").join(name), wanted);
    }
}

/// Before HDF5 there may be a block of any other kind.
#[test]
fn hdf5_behind_a_block_is_known_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("block.h5");
    let mut bytes = fs::read(data("hdf5/phasor_fields.mat")).unwrap();
    bytes[..512].fill(0);
    fs::write(&path, bytes).unwrap();
    assert_same(&path, Wanted::default());
    assert_converted(&path, Wanted::default());
}

/// A number that tells nothing of its neighbours.
fn sample(index: usize) -> f32 {
    let mixed = (index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (mixed.rotate_left(24) % 1024) as f32
}

/// Files and the orders of their axes.
const FILES: [(&str, &str); 3] = [
    ("a.zarr", "H W T C"),
    ("b.zarr", "T C H W"),
    ("c.h5", "T H W C"),
];

/// Files of a cube in which no chunk is as another: 19 MiB for 560 bins.
fn written(folder: &Path, bins: usize, files: &[(&str, &str)]) {
    let shape = [60, 50, bins, 3];
    let samples = (0..shape.iter().product()).map(sample).collect();
    let cube = Cube::new(shape, CubeSamples::F32(samples)).unwrap();
    let npy = folder.join("cube.npy");
    nullray::io::image::npz::write_cube(&npy, &cube).unwrap();
    for (name, axes) in files {
        let changes = Changes {
            axes: Some(axes.parse().unwrap()),
            ..Changes::default()
        };
        let from = (&*npy, Wanted::default());
        cube::convert(from, &folder.join(name), &changes, &mut |_, _| true).unwrap();
    }
}

/// The bits of a picture of a plane that shows the cube, and how many bytes of it were held.
fn picture(folder: &Path, file: &str, mapping: &str, in_parts: bool) -> Vec<u64> {
    let text = format!(
        "[camera]\neye = [0.3, 0.2, 3]\nlook_at = [0, 0, 0]\nhfov = \"70 deg\"\nsize = [64, 48]\nvelocity = {{ beta = [0.4, 0, 0] }}\n\
         time = \"6 m\"\n[[object]]\nname = \"ball\"\nshape = {{ sphere = {{ radius = 1 }} }}\n[[source]]\n[source.cube]\n\
         file = \"{file}\"\nstart = \"-2 m\"\nbin_width = \"0.05 m\"\n{mapping}\n"
    );
    let scene = parse(&text, "chunks", folder, &Overrides::default()).unwrap();
    let whole = Plan::new(&scene, &Request::default()).unwrap();
    let request = Request {
        memory_limit: whole.memory.total() - 2_000_000,
        ..Request::default()
    };
    let plan = match in_parts {
        true => Plan::new(&scene, &request).unwrap(),
        false => whole,
    };
    assert_eq!(plan.cubes[0].as_ref().unwrap().held.is_some(), in_parts);
    let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    let film = render(&prepared, &Silent).unwrap();
    film.radiance()
        .iter()
        .flatten()
        .map(|c| c.to_bits())
        .collect()
}

#[test]
fn pictures_from_chunks_have_the_bits_of_those_from_memory() {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), 560, &FILES);
    let capture = "clock = \"capture\"\ncapture = { eye = [1, 1, 4], look_at = [0, 0, 0], hfov = \"60 deg\" }";
    for mapping in ["uv = 0", capture] {
        let whole = picture(folder.path(), "cube.npy", mapping, false);
        assert!(whole.iter().any(|bits| *bits != 0));
        for (file, _) in FILES {
            assert!(
                whole == picture(folder.path(), file, mapping, true),
                "{file} {mapping}"
            );
        }
    }
}

#[test]
fn a_chunk_that_is_broken_or_no_number_is_an_error_with_its_name() {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), 200, &FILES[..1]);
    let array = folder.path().join("a.zarr");
    let chunk = array.join("c/1/1/2/0");
    fs::write(&chunk, b"no gzip").unwrap();
    let bricks = Bricks::open(&array, Wanted::default(), ROOM).unwrap();
    // Row 12, column 40, bin 150.
    assert_eq!(bricks.sample(12 * 50 + 40, 150, 0), 0.0);
    let error = bricks.check().unwrap_err().to_string();
    assert!(error.contains("c/1/1/2/0"), "{error}");

    let mut samples = vec![1.0; 20 * 20 * 70];
    samples[(13 * 20 + 5) * 70 + 66] = f32::NAN;
    let cube = Cube {
        shape: [20, 20, 70, 1],
        samples: CubeSamples::F32(samples),
    };
    let npy = folder.path().join("nan.npy");
    nullray::io::image::npz::write_cube(&npy, &cube).unwrap();
    let refused = cube::convert(
        (&npy, Wanted::default()),
        &folder.path().join("nan.zarr"),
        &Changes::default(),
        &mut |_, _| true,
    );
    assert!(refused.is_err() && !folder.path().join("nan.zarr").exists());
}

/// Layers of chunks that do not fit into the memory would be decoded for each row anew.
#[test]
fn thick_chunks_are_converted_in_little_memory() {
    let folder = tempfile::tempdir().unwrap();
    let shape = [40, 30, 64, 1];
    let samples = (0..shape.iter().product()).map(sample).collect();
    let cube = Cube::new(shape, CubeSamples::F32(samples)).unwrap();
    let npy = folder.path().join("cube.npy");
    nullray::io::image::npz::write_cube(&npy, &cube).unwrap();
    let converted = |from: &Path, to: &Path, axes: Option<&str>, memory: u64| {
        let changes = Changes {
            axes: axes.map(|axes| axes.parse().unwrap()),
            memory,
            ..Changes::default()
        };
        cube::convert((from, Wanted::default()), to, &changes, &mut |_, _| true).unwrap();
    };
    let zarr = folder.path().join("frames.zarr");
    converted(&npy, &zarr, Some("T H W"), 16 << 30);
    // A row of it takes 92 kB, and its chunks hold more than four rows.
    let back = folder.path().join("back.npy");
    converted(&zarr, &back, None, 200_000);
    assert!(cube::load(&back, Wanted::default()).unwrap() == cube);
}
