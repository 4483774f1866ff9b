//! Arrays as numpy writes them, read back sample by sample.

use std::path::{Path, PathBuf};

use half::f16;
use nullray::io::cube::{self, CubeSamples, Wanted};
use nullray::io::npy::{self, Dtype};

fn valid(file: &str) -> PathBuf {
    Path::new("tests/data/valid").join(file)
}

/// The samples of all the files: (n − 3)/8, exact in half precision.
fn expected() -> impl Iterator<Item = f64> {
    (0..24).map(|n| f64::from(n - 3) / 8.0)
}

#[test]
fn single_precision_of_every_header_version_is_read() {
    for file in [
        "cube-f4.npy",
        "cube-f4-version-2.npy",
        "cube-f4-version-3.npy",
        "stored.npz",
    ] {
        let cube = cube::load(&valid(file), Wanted::default()).unwrap();
        assert_eq!(cube.shape, [2, 3, 4, 1], "{file}");
        let samples = expected().map(|s| s as f32).collect();
        assert_eq!(cube.samples, CubeSamples::F32(samples), "{file}");
    }
}

#[test]
fn half_precision_is_read_as_it_is() {
    let cube = cube::load(&valid("cube-f2.npy"), Wanted::default()).unwrap();
    let samples = expected().map(f16::from_f64).collect();
    assert_eq!(cube.samples, CubeSamples::F16(samples));
}

#[test]
fn big_endian_samples_are_converted() {
    let cube = cube::load(&valid("cube-f8-big-endian.npy"), Wanted::default()).unwrap();
    assert_eq!(cube.samples, CubeSamples::F64(expected().collect()));
}

#[test]
fn axes_in_another_order_are_brought_into_that_of_a_cube() {
    let samples: Vec<f32> = expected().map(|s| s as f32).collect();
    let axes = "T H W".parse().unwrap();
    let wanted = Wanted {
        axes: Some(&axes),
        ..Wanted::default()
    };
    let file = valid("time-first-f4.npy");
    let cube = cube::load(&file, wanted).unwrap();
    assert_eq!(cube.shape, [2, 3, 4, 1]);
    assert_eq!(cube.samples, CubeSamples::F32(samples.clone()));
    let info = cube::inspect(&file, wanted).unwrap();
    assert_eq!((info.shape, info.assumed), ([2, 3, 4, 1], false));
    // Fortran order is an order of axes like any other, and needs no name.
    let cube = cube::load(&valid("fortran-order.npy"), Wanted::default()).unwrap();
    assert_eq!(cube.shape, [2, 3, 4, 1]);
    assert_eq!(cube.samples, CubeSamples::F32(samples));
}

#[test]
fn axes_without_time_are_a_steady_picture() {
    let axes = "H W".parse().unwrap();
    let wanted = Wanted {
        axes: Some(&axes),
        ..Wanted::default()
    };
    let cube = cube::load(&valid("steady-f4.npy"), wanted).unwrap();
    assert_eq!(cube.shape, [4, 6, 1, 1]);
    let refused = cube::load(&valid("cube-f4.npy"), wanted).unwrap_err();
    assert!(
        refused.to_string().contains("has 3 axes, and 2 are named"),
        "{refused}"
    );
}

#[test]
fn integers_are_read_exactly() {
    let cube = cube::load(&valid("counts-u2.npy"), Wanted::default()).unwrap();
    let counts = (0..24).map(|n| (2700 * n) as f32).collect();
    assert_eq!(cube.samples, CubeSamples::F32(counts));
    let cube = cube::load(&valid("counts-i4-big-endian.npy"), Wanted::default()).unwrap();
    let counts = (0..24).map(|n| 90e6 * f64::from(n) - 1.0).collect();
    assert_eq!(cube.samples, CubeSamples::F64(counts));
    let cube = cube::load(&valid("counts-i8.npy"), Wanted::default()).unwrap();
    let counts = (0..24).map(|n| 9e10 * f64::from(n) - 1.0).collect();
    assert_eq!(cube.samples, CubeSamples::F64(counts));
    // 2⁵³ + 1 is the first that is not.
    let mut bytes = std::fs::read(valid("counts-i8.npy")).unwrap();
    let last = bytes.len() - 8;
    bytes[last..].copy_from_slice(&((1u64 << 53) + 1).to_le_bytes());
    let refused = cube::load_bytes(&bytes, "a.npy", Wanted::default()).unwrap_err();
    for words in ["sample [1, 2, 3, 0]", "the integer is beyond 2^53"] {
        assert!(refused.to_string().contains(words), "{refused}");
    }
    assert!(refused.help().contains("astype"), "{}", refused.help());
    let info = cube::inspect(&valid("counts-u2.npy"), Wanted::default()).unwrap();
    assert_eq!((info.bytes, info.assumed), (96, true));
}

#[test]
fn a_fourth_axis_is_channels() {
    let cube = cube::load(&valid("rgb-f4.npy"), Wanted::default()).unwrap();
    assert_eq!(cube.shape, [2, 2, 2, 3]);
}

#[test]
fn a_deflated_array_is_found_by_its_name_among_arrays_that_are_no_cubes() {
    let cube = cube::load(&valid("deflated.npz"), Wanted::array("cube")).unwrap();
    assert_eq!(cube.samples, CubeSamples::F64(expected().collect()));
}

#[test]
fn an_array_that_is_not_there_is_refused_with_the_names_of_those_that_are() {
    let error = cube::load(&valid("deflated.npz"), Wanted::array("cubes")).unwrap_err();
    let help = error.help();
    for name in ["\"cube\"", "\"wavelengths\"", "\"axis\""] {
        assert!(help.contains(name), "{help}");
    }
}

#[test]
fn a_name_for_the_nameless_array_of_an_npy_file_is_refused() {
    let error = cube::load(&valid("cube-f4.npy"), Wanted::array("cube")).unwrap_err();
    assert!(error.to_string().contains("has no name"), "{error}");
}

#[test]
fn inspecting_tells_headers_of_all_arrays() {
    let headers = npy::inspect(&valid("deflated.npz"), None).unwrap();
    let told: Vec<_> = (headers.iter())
        .map(|header| {
            (
                header.name.as_deref().unwrap(),
                header.shape.as_slice(),
                &header.dtype,
            )
        })
        .collect();
    let integers = Dtype::Other("<i8".into());
    let expected = [
        ("cube", &[2, 3, 4][..], &Dtype::F64),
        ("wavelengths", &[4], &integers),
        ("axis", &[5], &Dtype::F64),
    ];
    assert_eq!(told, expected);
    let one = npy::inspect(&valid("cube-f8-big-endian.npy"), None).unwrap();
    assert!(one[0].big_endian && one[0].name.is_none());
}

#[test]
fn inspecting_a_cube_tells_its_size_in_memory() {
    let info = cube::inspect(&valid("cube-f2.npy"), Wanted::default()).unwrap();
    assert_eq!((info.shape, info.bytes), ([2, 3, 4, 1], 48));
    assert_eq!(info.dtype, Dtype::F16);
}

#[test]
fn bytes_in_memory_are_read_as_files_are() {
    for (file, wanted) in [
        ("cube-f4.npy", Wanted::default()),
        ("deflated.npz", Wanted::array("cube")),
    ] {
        let bytes = std::fs::read(valid(file)).unwrap();
        let cube = cube::load_bytes(&bytes, "built-in", wanted).unwrap();
        assert_eq!(cube, cube::load(&valid(file), wanted).unwrap());
        let error = cube::load_bytes(&bytes[..90], "built-in", wanted).unwrap_err();
        assert!(error.to_string().starts_with("built-in"), "{error}");
    }
}

/// More samples than fit into one piece of the reader, so that pieces join without a seam.
#[test]
fn a_cube_of_many_pieces_is_read_whole() {
    let shape = "{'descr': '<f4', 'fortran_order': False, 'shape': (50, 40, 30), }\n";
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((shape.len() as u16).to_le_bytes());
    bytes.extend(shape.bytes());
    bytes.extend((0..60_000).flat_map(|n| (n as f32).to_le_bytes()));
    let cube = cube::load_bytes(&bytes, "memory", Wanted::default()).unwrap();
    assert_eq!(
        cube.samples,
        CubeSamples::F32((0..60_000).map(|n| n as f32).collect())
    );
}
