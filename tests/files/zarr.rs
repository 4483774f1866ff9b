//! Zarr arrays by zarr-python (`tests/data/zarr`): sample n of each is n.

use std::fs;
use std::path::{Path, PathBuf};

use nullray::io::cube::{self, Axes, Changes, Cube, CubeSamples, FileTimes, Wanted};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/zarr")
        .join(name)
}

fn assert_counts_up(name: &str, cube: &Cube) {
    for n in 0..cube.samples.len() {
        assert_eq!(cube.samples.get(n), Some(n as f64), "{name}");
    }
}

fn converted(from: &Path, to: &Path, changes: &Changes) {
    cube::convert((from, Wanted::default()), to, changes, &mut |_, _| true).unwrap();
}

#[test]
fn every_kind_of_chunks_is_read() {
    for (name, channels, is_said) in [
        ("plain", 1, true),
        ("zstd", 1, false),
        ("gzip", 1, false),
        ("big", 1, false),
        ("frames", 1, true),
        ("turned", 3, false),
        ("sharded", 3, true),
        ("sharded_start", 1, false),
    ] {
        let path = data(name);
        let cube = cube::load(&path, Wanted::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(cube.shape, [5, 6, 7, channels], "{name}");
        assert_counts_up(name, &cube);
        let info = cube::inspect(&path, Wanted::default()).unwrap();
        assert_eq!(
            (info.shape, info.bytes, !info.assumed),
            (cube.shape, cube.samples.bytes(), is_said),
            "{name}"
        );
        assert_eq!(info.remarks, Vec::<String>::new(), "{name}");
        // By way of a temporary file too.
        let folder = tempfile::tempdir().unwrap();
        converted(&path, &folder.path().join("a.npy"), &Changes::default());
        assert_eq!(
            cube::load(&folder.path().join("a.npy"), Wanted::default()).unwrap(),
            cube,
            "{name}"
        );
    }
    let times = cube::times(&data("plain"), None).unwrap().unwrap();
    assert_eq!((times.start, times.width), (1.5, 0.25));
    let two = cube::load(&data("group"), Wanted::array("two")).unwrap();
    assert_counts_up("group", &two);
    // One entry along an axis, and the sum along another.
    for (array, axes, expected) in [
        ("[3]", "L H W", 126.0),
        ("", "S H W", 42.0 * (1.0 + 2.0 + 3.0 + 4.0)),
    ] {
        let axes: Axes = axes.parse().unwrap();
        let wanted = Wanted {
            axes: Some(&axes),
            array: Some(array).filter(|array| !array.is_empty()),
            ..Wanted::default()
        };
        let cube = cube::load(&data("zstd"), wanted).unwrap();
        assert_eq!(
            (cube.shape, cube.samples.get(0)),
            ([6, 7, 1, 1], Some(expected))
        );
    }
}

#[test]
fn blosc_and_version_2_are_read() {
    for name in [
        "blosc_lz4",
        "blosc_lz4hc_bits",
        "blosc_zstd",
        "blosc_zlib",
        "blosc_blosclz",
        "blosc_blosclz_plain",
        "v2",
        "v2_fortran",
        "v2_lz4",
        "v2_gzip",
        "v2_zstd",
        "v2_plain",
    ] {
        let path = data(name);
        let cube = cube::load(&path, Wanted::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(cube.shape, [12, 16, 20, 1], "{name}");
        assert_counts_up(name, &cube);
        let info = cube::inspect(&path, Wanted::default()).unwrap();
        assert_eq!(info.remarks, Vec::<String>::new(), "{name}");
        assert_eq!(info.assumed, name != "v2", "{name}");
    }
    let times = cube::times(&data("v2"), None).unwrap().unwrap();
    assert_eq!((times.start, times.width), (1.5, 0.25));
    let two = cube::load(&data("v2_group"), Wanted::array("two")).unwrap();
    assert_counts_up("v2_group", &two);
    let refused = cube::load(&data("v2_bz2"), Wanted::default()).unwrap_err();
    let text = refused.to_string();
    assert!(
        text.contains("\"bz2\" is not supported") && text.contains(".zarray"),
        "{text}"
    );
    // What stands before compression is named, too.
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(data("v2_plain").join(".zarray")).unwrap();
    let filter = "\"filters\": [{ \"id\": \"delta\", \"dtype\": \"<f4\" }]";
    let text = text.replace("\"filters\": null", filter);
    std::fs::write(folder.path().join(".zarray"), text).unwrap();
    let refused = cube::load(folder.path(), Wanted::default()).unwrap_err();
    assert!(
        refused.to_string().contains("filter \"delta\""),
        "{refused}"
    );
}

/// Chunks with a changed byte, and chunks that are cut off: most are refused, the others are read as what they decode to.
#[test]
fn damaged_blosc_is_refused_or_read_without_a_panic() {
    let folder = tempfile::tempdir().unwrap();
    let mut refused = 0;
    for name in [
        "blosc_lz4",
        "blosc_zstd",
        "blosc_zlib",
        "blosc_blosclz",
        "v2_lz4",
    ] {
        let copy = folder.path().join(name);
        let chunk = ["c/0/0/0", "0/0/0"].map(|chunk| data(name).join(chunk));
        let chunk = chunk.into_iter().find(|chunk| chunk.is_file()).unwrap();
        let inner = chunk.strip_prefix(data(name)).unwrap().to_path_buf();
        fs::create_dir_all(copy.join(&inner).parent().unwrap()).unwrap();
        for own in ["zarr.json", ".zarray"] {
            if data(name).join(own).is_file() {
                fs::copy(data(name).join(own), copy.join(own)).unwrap();
            }
        }
        let whole = fs::read(&chunk).unwrap();
        let mut read = |bytes: &[u8]| {
            fs::write(copy.join(&inner), bytes).unwrap();
            refused += usize::from(cube::load(&copy, Wanted::default()).is_err());
        };
        let step = whole.len().div_ceil(97);
        for at in (0..whole.len()).step_by(step).chain(0..24) {
            read(&whole[..at]);
            for value in [0, 0xff, whole[at] ^ 0x55] {
                let mut bytes = whole.clone();
                bytes[at] = value;
                read(&bytes);
            }
        }
    }
    // All that are cut off, and most of those whose structure is changed.
    assert!(refused > 5 * 121, "{refused}");
}

/// The array `plain`, (y, x, time), with other words about its axes.
#[test]
fn axes_are_those_that_the_array_says_and_asked_for_where_it_says_others() {
    use serde_json::{Value, json};
    let folder = tempfile::tempdir().unwrap();
    let array = folder.path().join("array");
    let said = |change: &dyn Fn(&mut Value)| {
        let _ = fs::remove_dir_all(&array);
        fs::create_dir_all(&array).unwrap();
        let text = fs::read_to_string(data("plain").join("zarr.json")).unwrap();
        let mut document: Value = serde_json::from_str(&text).unwrap();
        change(&mut document);
        fs::write(array.join("zarr.json"), document.to_string()).unwrap();
        cube::inspect(&array, Wanted::default())
    };
    let names = |names: Value| said(&move |document| document["dimension_names"] = names.clone());
    let attribute = |key: &'static str, value: Value| {
        said(&move |document| {
            document["dimension_names"] = Value::Null;
            document["attributes"][key] = value.clone();
        })
    };
    for (info, axes, by) in [
        (names(json!(["y", "x", "time"])), "H W T", "dimension_names"),
        (names(json!(["time", "y", "x"])), "T H W", "dimension_names"),
        (
            attribute("axes", json!("T H W")),
            "T H W",
            "attribute `axes`",
        ),
        (
            attribute("_ARRAY_DIMENSIONS", json!(["t", "row", "column"])),
            "T H W",
            "attribute `_ARRAY_DIMENSIONS`",
        ),
    ] {
        let info = info.unwrap();
        assert_eq!(
            (info.axes.to_string().as_str(), info.assumed),
            (axes, false)
        );
        let note = format!("axes {axes}, by its {by}");
        assert!(info.notes.contains(&note), "{:?}", info.notes);
    }
    for unnamed in [
        json!(null),
        json!([null, null, null]),
        json!(["dim_0", "dim_1", "dim_2"]),
    ] {
        assert!(names(unnamed).unwrap().assumed);
    }
    for (refused, words) in [
        (
            names(json!(["wavelength", "y", "x"])),
            "called wavelength, y, x",
        ),
        (
            names(json!([null, null, "time"])),
            "called (no name), (no name), time",
        ),
        (attribute("axes", json!("T Q W")), "'Q'"),
        (
            said(&|document| {
                document["dimension_names"] = json!(null);
                document["shape"] = json!([9, 8, 3]);
            }),
            "probably a colour picture",
        ),
    ] {
        let error = refused.unwrap_err();
        let said = format!("{error}; {}", error.help());
        assert!(said.contains(words) && said.contains("axes"), "{said}");
    }
}

#[test]
fn missing_chunks_are_the_fill_value_and_are_counted() {
    for (name, said) in [
        ("missing", "8 of 12 chunks are missing"),
        ("missing_in_shard", "1 of 2 shards are missing"),
    ] {
        let cube = cube::load(&data(name), Wanted::default()).unwrap();
        for n in 0..210 {
            let expected = if n < 84 { n as f64 } else { 0.5 };
            assert_eq!(cube.samples.get(n), Some(expected), "{name} {n}");
        }
        let remarks = cube::inspect(&data(name), Wanted::default())
            .unwrap()
            .remarks
            .join("; ");
        assert!(
            remarks.contains(said) && remarks.contains("0.5"),
            "{name}: {remarks}"
        );
    }
}

#[test]
fn arrays_are_written_in_chunks_and_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    // More than a chunk along every axis, none of them whole.
    let shape = [37, 35, 70, 3];
    let samples = (0..shape.iter().product::<usize>()).map(|n| n as f32);
    let cube = Cube::new(shape, CubeSamples::F32(samples.collect())).unwrap();
    nullray::io::image::npz::write_cube(&path("a.npy"), &cube).unwrap();
    let original = fs::read(path("a.npy")).unwrap();
    for axes in ["H W T C", "T H W C", "T C W H"] {
        let changes = Changes {
            axes: Some(axes.parse().unwrap()),
            times: Some(FileTimes {
                start: 2.0,
                width: 0.1,
                at_sensor: false,
            }),
            ..Changes::default()
        };
        let zarr = path(&format!("{}.zarr", axes.replace(' ', "")));
        converted(&path("a.npy"), &zarr, &changes);
        let info = cube::inspect(&zarr, Wanted::default()).unwrap();
        assert_eq!(
            (info.axes.to_string().as_str(), info.assumed, info.shape),
            (axes, false, shape)
        );
        assert!(info.remarks.is_empty());
        let times = cube::times(&zarr, None).unwrap().unwrap();
        assert_eq!((times.start, times.width), (2.0, 0.1));
        converted(&zarr, &path("b.npy"), &Changes::default());
        assert!(fs::read(path("b.npy")).unwrap() == original, "{axes}");
        // What is there is not written over.
        let refused = cube::convert(
            (&path("a.npy"), Wanted::default()),
            &zarr,
            &changes,
            &mut |_, _| true,
        );
        assert!(refused.is_err());
    }
    // To EXR frames and back by way of Zarr.
    converted(&path("HWTC.zarr"), &path("frames"), &Changes::default());
    converted(&path("frames"), &path("c.zarr"), &Changes::default());
    converted(&path("c.zarr"), &path("c.npy"), &Changes::default());
    assert!(fs::read(path("c.npy")).unwrap() == original);
}

/// A copy of the array `name`, changed by `change`, and what reading it says.
fn refusal(name: &str, change: impl Fn(&Path)) -> String {
    fn copy(from: &Path, to: &Path) {
        fs::create_dir_all(to).unwrap();
        for entry in fs::read_dir(from).unwrap() {
            let entry = entry.unwrap();
            let target = to.join(entry.file_name());
            match entry.path().is_dir() {
                true => copy(&entry.path(), &target),
                false => drop(fs::copy(entry.path(), target).unwrap()),
            }
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    copy(&data(name), &path);
    change(&path);
    let error = cube::load(&path, Wanted::default()).unwrap_err();
    format!("{error}; {}", error.help())
}

fn with(path: &Path, old: &str, new: &str) {
    let file = path.join("zarr.json");
    let text: serde_json::Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    let text = text.to_string();
    assert!(text.contains(old), "{text}");
    fs::write(file, text.replace(old, new)).unwrap();
}

#[test]
fn what_is_broken_or_not_known_is_refused_by_name() {
    for (message, words) in [
        (
            refusal("plain", |p| {
                with(p, "\"zarr_format\":3", "\"zarr_format\":4")
            }),
            "not version 3",
        ),
        (
            refusal("plain", |p| with(p, "float32", "complex64")),
            "complex64",
        ),
        (
            refusal("plain", |p| {
                with(p, "\"shape\":[5,6,7]", "\"shape\":[5,0,7]")
            }),
            "no samples",
        ),
        (
            refusal("plain", |p| {
                with(p, "\"shape\":[5,6,7]", "\"shape\":[5,6,1e30]")
            }),
            "sizes",
        ),
        (
            refusal("plain", |p| {
                with(p, "\"chunk_shape\":[2,3,4]", "\"chunk_shape\":[2,3]")
            }),
            "not the size of a chunk",
        ),
        (
            refusal("plain", |p| {
                with(
                    p,
                    "\"chunk_shape\":[2,3,4]",
                    "\"chunk_shape\":[90000,90000,90000]",
                )
            }),
            "1 GiB",
        ),
        (
            refusal("plain", |p| {
                with(p, "\"name\":\"bytes\"", "\"name\":\"blosc\"")
            }),
            "blosc",
        ),
        (
            refusal("plain", |p| fs::write(p.join("c/0/0/0"), [0; 95]).unwrap()),
            "95 bytes, and 96",
        ),
        (
            refusal("plain", |p| fs::write(p.join("zarr.json"), "{").unwrap()),
            "not JSON",
        ),
        (
            refusal("gzip", |p| fs::write(p.join("c/0/0/0"), [7; 100]).unwrap()),
            "checksum",
        ),
        (
            refusal("zstd", |p| fs::write(p.join("c/0/0/0"), [7; 100]).unwrap()),
            "zstd",
        ),
        (
            refusal("sharded", |p| {
                fs::write(p.join("c/0/0/0/0"), [7; 10]).unwrap()
            }),
            "too short",
        ),
        (refusal("group", |_| ()), "several arrays: one, two"),
    ] {
        assert!(message.contains(words), "{words}: {message}");
    }
}

/// Bytes of chunks and of the description changed: an answer, and no more memory than that of a chunk.
#[test]
fn damaged_arrays_are_refused_or_read_but_never_break_the_reader() {
    let mut random = crate::random_numbers();
    for (name, chunk) in [
        ("zstd", "c/0/0/0"),
        ("gzip", "c/0/0/0"),
        ("turned", "c/0/0/0/0"),
        ("sharded", "c/0/0/0/0"),
        ("sharded_start", "c/0/0/0"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir_all(folder.path().join(chunk).parent().unwrap()).unwrap();
        for file in ["zarr.json", chunk] {
            let whole = fs::read(data(name).join(file)).unwrap();
            let other = if file == chunk { "zarr.json" } else { chunk };
            fs::copy(data(name).join(other), folder.path().join(other)).unwrap();
            for _ in 0..150 {
                let mut bytes = whole.clone();
                for _ in 0..1 + random() % 3 {
                    let at = random() % bytes.len();
                    // Digits for digits, so that the description stays one.
                    bytes[at] = match bytes[at] {
                        b'0'..=b'9' if file == "zarr.json" => b'0' + (random() % 10) as u8,
                        _ if file == "zarr.json" => bytes[at],
                        _ => random() as u8,
                    };
                }
                fs::write(folder.path().join(file), &bytes).unwrap();
                if cube::inspect(folder.path(), Wanted::default())
                    .is_ok_and(|info| info.bytes < 1 << 20)
                {
                    let _ = cube::load(folder.path(), Wanted::default());
                }
            }
        }
    }
}
