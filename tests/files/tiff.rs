//! Folders of TIFF frames by tifffile (`tests/data/tiff`): frame k, row i, column j is 30 k + 6 i + j.

use std::path::{Path, PathBuf};

use nullray::io::budget::Budget;
use nullray::io::cube::{self, Axes, Transfer, Wanted};
use nullray::io::image::tiff;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/tiff")
        .join(name)
}

#[test]
fn frames_of_all_kinds_of_samples_are_read() {
    let srgb = |code: f64| match code <= 0.04045 {
        true => code / 12.92,
        false => ((code + 0.055) / 1.055).powf(2.4),
    };
    for (pattern, transfer, channels) in [
        ("f32_%03d.tif", None, 1),
        ("f16_{i:03d}.tif", None, 1),
        ("u16_###.tiff", Some(Transfer::Linear), 1),
        ("rgb_%03d.tif", Some(Transfer::Srgb), 3),
    ] {
        let wanted = Wanted {
            transfer,
            ..Wanted::default()
        };
        let cube = cube::load(&data(pattern), wanted).unwrap();
        assert_eq!(cube.shape, [5, 6, 4, channels], "{pattern}");
        for n in 0..120 * channels {
            let (i, j, k, c) = (
                n / channels / 24,
                n / channels / 4 % 6,
                n / channels % 4,
                n % channels,
            );
            let value = (30 * k + 6 * i + j) as f64;
            let expected = match transfer {
                None => value,
                Some(Transfer::Linear) => 100.0 * value / 65535.0,
                Some(Transfer::Srgb) => srgb([1.0, 2.0, 0.0][c] * value / 255.0),
            };
            let found = cube.samples.get(n).unwrap();
            assert!(
                (found - expected).abs() <= 1e-6 * expected.max(1e-3),
                "{pattern} {n}: {found} for {expected}"
            );
        }
    }
    // Codes are not taken for light unless that is said.
    let error = cube::load(&data("u16_%03d.tiff"), Wanted::default()).unwrap_err();
    assert!(
        error.to_string().contains("not radiance as they stand"),
        "{error}"
    );
}

#[test]
fn damaged_pictures_are_refused_or_read_but_never_break_the_reader() {
    let mut random = crate::random_numbers();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tif");
    for name in ["f32_001.tif", "u16_001.tiff", "rgb_001.tif"] {
        let whole = std::fs::read(data(name)).unwrap();
        for _ in 0..400 {
            let mut bytes = whole.clone();
            for _ in 0..1 + random() % 3 {
                let at = random() % bytes.len();
                bytes[at] = random() as u8;
            }
            if random().is_multiple_of(10) {
                bytes.truncate(random() % whole.len());
            }
            std::fs::write(&path, &bytes).unwrap();
            let _ = tiff::count(&path);
            let _ = tiff::read(&path, 0, &Budget::new(1 << 24));
        }
    }
}

/// A stack of frames in one file is a cube where that is said, and is not taken for its first picture alone.
#[test]
fn a_stack_has_all_of_its_pictures_and_a_preview_is_none() {
    let axes: Axes = "T H W".parse().unwrap();
    let in_time = Wanted {
        axes: Some(&axes),
        ..Wanted::default()
    };
    let cube = cube::load(&data("stack.tif"), in_time).unwrap();
    assert_eq!(cube.shape, [5, 6, 4, 1]);
    let apart = cube::load(&data("f32_%03d.tif"), Wanted::default()).unwrap();
    assert_eq!(cube, apart);
    assert_eq!(cube::frame_count(&data("stack.tif")).unwrap(), 4);
    let refused = cube::load(&data("stack.tif"), Wanted::default()).unwrap_err();
    assert!(refused.to_string().contains("4 pictures"), "{refused}");
    assert!(refused.help().contains("T H W"), "{}", refused.help());
    // In a folder every file is one frame.
    let folder = tempfile::tempdir().unwrap();
    for k in 0..2 {
        let to = folder.path().join(format!("{k}.tif"));
        std::fs::copy(data("stack.tif"), to).unwrap();
    }
    let refused = cube::load(folder.path(), Wanted::default()).unwrap_err();
    assert!(
        refused.to_string().contains("one of a sequence"),
        "{refused}"
    );
    let steady = cube::load(&data("preview.tif"), Wanted::default()).unwrap();
    assert_eq!(steady.shape, [5, 6, 1, 1]);
}

/// A little-endian TIFF of these directories, each at its place with entries of tag, type, count and value, and the next one's place.
fn directories(all: &[(u32, &[[u32; 4]], u32)], length: usize) -> Vec<u8> {
    let mut file = vec![0; length];
    file[..8].copy_from_slice(b"II\x2a\0\x08\0\0\0");
    for (at, entries, next) in all {
        let mut bytes = (entries.len() as u16).to_le_bytes().to_vec();
        for [tag, kind, count, value] in *entries {
            bytes.extend((*tag as u16).to_le_bytes());
            bytes.extend((*kind as u16).to_le_bytes());
            bytes.extend(count.to_le_bytes());
            bytes.extend(value.to_le_bytes());
        }
        bytes.extend(next.to_le_bytes());
        file[*at as usize..][..bytes.len()].copy_from_slice(&bytes);
    }
    file
}

#[test]
fn text_in_place_of_numbers_is_refused_before_the_decoder_prints_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tif");
    let size = [[256, 3, 1, 4], [257, 3, 1, 4]];
    // More text than a decoder may have: in the first picture, and in the second.
    let offsets = [273, 2, 0x7fff_ffff, 8];
    for second in [false, true] {
        let first: Vec<[u32; 4]> = size
            .into_iter()
            .chain((!second).then_some(offsets))
            .collect();
        let next = [size[0], size[1], offsets];
        let bytes = directories(&[(8, &first, 100), (100, &next, 0)], 300);
        std::fs::write(&path, bytes).unwrap();
        let picture = usize::from(second);
        for error in [
            tiff::count(&path).unwrap_err(),
            tiff::read(&path, picture, &Budget::new(1 << 24)).unwrap_err(),
        ] {
            let expected = format!("tag 273 of picture {picture} holds text in place of numbers");
            assert!(error.to_string().contains(&expected), "{error}");
        }
    }
}

#[test]
fn directories_that_overlap_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tif");
    // Every place holds the number of a directory of 16,448 entries, of which the last leads to a place four bytes on.
    let mut bytes = vec![0x40; 1 << 20];
    bytes[..8].copy_from_slice(b"II\x2a\0\x08\0\0\0");
    let entries = 0x4040;
    for k in 0..60_000u32 {
        let at = 8 + 4 * k;
        let end = (at + 2 + 12 * entries) as usize;
        bytes[end..end + 4].copy_from_slice(&(at + 4).to_le_bytes());
    }
    std::fs::write(&path, bytes).unwrap();
    let begin = std::time::Instant::now();
    let error = tiff::read(&path, 59_999, &Budget::new(1 << 24)).unwrap_err();
    assert!(error.to_string().contains("they overlap"), "{error}");
    assert!(begin.elapsed() < std::time::Duration::from_secs(5));
}
