//! Pictures as written by numpy: types, shapes and orders of arrays.

use std::path::Path;

use nullray::io::image::{Layers, Samples};
use nullray::validate::compare::{CompareOptions, Encoding, Picture, compare};

/// A `.npy` file of these bytes after a header that says so, read as a picture.
fn read(descr: &str, order: &str, shape: &str, samples: &[u8]) -> Result<Picture, String> {
    read_as("picture.npy", None, header(descr, order, shape), samples)
}

fn header(descr: &str, order: &str, shape: &str) -> String {
    format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}\n")
}

fn read_as(
    name: &str,
    no_hit: Option<i64>,
    header: String,
    samples: &[u8],
) -> Result<Picture, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    bytes.extend(samples);
    match Path::new(name).extension().is_some_and(|e| e == "npz") {
        true => archive(&path, &bytes),
        false => std::fs::write(&path, bytes).unwrap(),
    }
    let mut picture = Picture::read(&path, Encoding::Srgb, &Default::default())
        .map_err(|error| error.to_string())?;
    no_hit
        .into_iter()
        .for_each(|no_hit| picture.set_no_hit(no_hit));
    Ok(picture)
}

/// An archive of one array whose name is that of the file.
fn archive(path: &Path, array: &[u8]) {
    let name = path.file_stem().unwrap().to_str().unwrap();
    archive_of(path, &[(name, array.to_vec())]);
}

fn archive_of(path: &Path, arrays: &[(&str, Vec<u8>)]) {
    use std::io::Write;
    let mut archive = zip::ZipWriter::new(std::fs::File::create(path).unwrap());
    let options = zip::write::SimpleFileOptions::default();
    for (name, array) in arrays {
        archive.start_file(format!("{name}.npy"), options).unwrap();
        archive.write_all(array).unwrap();
    }
    archive.finish().unwrap();
}

/// A `.npy` of this type and shape, of zeros.
fn zeros(descr: &str, shape: &str, bytes: usize) -> Vec<u8> {
    let header = header(descr, "False", shape);
    let mut array = b"\x93NUMPY\x01\x00".to_vec();
    array.extend((header.len() as u16).to_le_bytes());
    array.extend(header.bytes());
    array.resize(array.len() + bytes, 0);
    array
}

fn values(layers: &Layers, name: &str) -> Vec<f64> {
    let channel = layers.channel(name);
    channel
        .unwrap_or_else(|| panic!("no {name}"))
        .samples
        .to_f64()
}

#[test]
fn integers_of_every_width_and_order_are_read() {
    // 1, 2, 3, and what −1 is in the type.
    let signed = [1i64, 2, 3, -1];
    let bytes = |width: usize, big: bool| -> Vec<u8> {
        let one = |n: &i64| {
            let mut bytes = n.to_le_bytes()[..width].to_vec();
            if big {
                bytes.reverse();
            }
            bytes
        };
        signed.iter().flat_map(one).collect()
    };
    for (width, prefix) in [
        (1, "|"),
        (2, "<"),
        (2, ">"),
        (4, "<"),
        (4, ">"),
        (8, "<"),
        (8, ">"),
    ] {
        for kind in ["i", "u"] {
            let descr = format!("{prefix}{kind}{width}");
            let header = header(&descr, "False", "(2, 2)");
            let picture =
                read_as("object.npz", None, header, &bytes(width, prefix == ">")).unwrap();
            // Of identities, the largest number of an unsigned type means that nothing is met.
            let ids = values(&picture.layers, "object");
            let nothing = ids[3] == -1.0 || ids[3] == 4_294_967_295.0;
            assert!(ids[..3] == [1.0, 2.0, 3.0] && nothing, "{descr}: {ids:?}");
        }
    }
}

#[test]
fn the_number_that_marks_no_hit_can_be_given() {
    let header = header("|u1", "False", "(1, 3)");
    let picture = read_as("object.npz", Some(0), header, &[0, 1, 2]).unwrap();
    assert_eq!(values(&picture.layers, "object"), [-1.0, 1.0, 2.0]);
}

#[test]
fn the_order_of_fortran_is_that_of_c_turned_around() {
    // shape (2, 3): element (i, j) = 10 i + j, the first index fastest.
    let samples: Vec<u8> = [0.0f64, 10.0, 1.0, 11.0, 2.0, 12.0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let picture = read("<f8", "True", "(2, 3)", &samples).unwrap();
    assert_eq!([picture.layers.width, picture.layers.height], [3, 2]);
    assert_eq!(
        values(&picture.layers, "value"),
        [0.0, 1.0, 2.0, 10.0, 11.0, 12.0]
    );
}

#[test]
fn arrays_of_one_three_and_four_numbers_per_pixel_are_channels() {
    let samples = |n: u8| -> Vec<u8> { (0..n).flat_map(|v| f32::from(v).to_le_bytes()).collect() };
    let grey = read("<f4", "False", "(1, 2, 1)", &samples(2)).unwrap();
    assert_eq!(values(&grey.layers, "value"), [0.0, 1.0]);
    let rgba = read("<f4", "False", "(1, 2, 4)", &samples(8)).unwrap();
    assert_eq!(values(&rgba.layers, "radiance.G"), [1.0, 5.0]);
    assert_eq!(values(&rgba.layers, "A"), [3.0, 7.0]);
    let event = read_as(
        "event.npz",
        None,
        header("<f4", "False", "(1, 2, 4)"),
        &samples(8),
    )
    .unwrap();
    assert_eq!(values(&event.layers, "event.ct"), [0.0, 4.0]);
    assert_eq!(values(&event.layers, "event.z"), [3.0, 7.0]);
    let uv = read_as(
        "uv.npz",
        None,
        header("<f4", "False", "(1, 2, 2)"),
        &samples(4),
    )
    .unwrap();
    assert_eq!(values(&uv.layers, "uv.v"), [1.0, 3.0]);
}

#[test]
fn files_that_are_not_pictures_are_refused_with_what_they_are() {
    for (descr, shape, bytes, words) in [
        ("<c16", "(1, 1)", 16, "complex numbers (<c16)"),
        ("<f16", "(1, 1)", 16, "more than 64 bits (<f16)"),
        ("|O", "(1, 1)", 8, "Python objects"),
        ("<U4", "(1, 1)", 16, "texts"),
        ("<f4", "(4,)", 16, "shape [4] is not a picture"),
        ("<f4", "(1, 1, 5)", 20, "shape [1, 1, 5] is not a picture"),
    ] {
        let message = read(descr, "False", shape, &vec![0; bytes]).unwrap_err();
        assert!(message.contains(words), "{descr} {shape}: {message}");
    }
    let large = (1i64 << 60).to_le_bytes();
    assert!(
        read("<i8", "False", "(1, 1)", &large)
            .unwrap_err()
            .contains("2^53")
    );
}

#[test]
fn arrays_of_less_than_their_group_are_refused_with_what_is_missing() {
    let places = read_as(
        "event.npz",
        None,
        header("<f4", "False", "(1, 2, 3)"),
        &[0; 24],
    );
    let message = places.unwrap_err();
    for words in [
        "it has 3 numbers per pixel, and stands for 4 channels: event.ct, event.x, event.y, event.z",
        "event.ct is missing, if these are event.x, event.y, event.z",
    ] {
        assert!(message.contains(words), "{words}: {message}");
    }
    let normals = read_as(
        "normal.npz",
        None,
        header("<f4", "False", "(1, 2, 2)"),
        &[0; 16],
    );
    let message = normals.unwrap_err();
    assert!(message.contains("normal.x is missing"), "{message}");
}

/// An archive of light, of objects, and of these arrays.
fn with_others(others: &[(&str, Vec<u8>)]) -> Result<Picture, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.npz");
    let mut arrays = others.to_vec();
    arrays.push(("object", zeros("<i4", "(8, 9)", 4 * 72)));
    arrays.push(("radiance", zeros("<f4", "(8, 9, 3)", 12 * 72)));
    archive_of(&path, &arrays);
    Picture::read(&path, Encoding::Srgb, &Default::default()).map_err(|error| error.to_string())
}

#[test]
fn arrays_that_are_not_channels_are_noted_and_the_others_compared() {
    let others = [
        ("camera", zeros("<f8", "(4, 4)", 128)),
        ("fps", zeros("<f8", "()", 8)),
        ("title", zeros("<U4", "()", 16)),
        ("motion", zeros("<f4", "(8, 9, 2)", 8 * 72)),
        ("normals", zeros("<f4", "(8, 9, 3)", 12 * 72)),
        ("field", zeros("<c16", "(8, 9)", 16 * 72)),
        ("triangles", zeros("<i4", "(10, 3)", 120)),
        ("mask", zeros("|b1", "(8, 9)", 72)),
    ];
    let picture = with_others(&others).unwrap();
    let all = [
        "camera",
        "fps",
        "title",
        "motion",
        "normals",
        "field",
        "triangles",
    ];
    assert_eq!(picture.unread, all);
    assert!(picture.layers.channel("mask").is_some());
    let plain = with_others(&[]).unwrap();
    let options = CompareOptions::default();
    let compared = compare(&plain, &picture, &options).unwrap();
    let is_told = |note: &str| note.contains("not read of") && note.contains(": camera, fps");
    assert_eq!(compared.notes.iter().filter(|n| is_told(n)).count(), 1);
    assert_eq!(compared.uncompared.only_candidate, ["mask"]);
    // What is named like channels of ours has to be like them.
    for (name, array, words) in [
        (
            "event",
            zeros("<f4", "(8, 9, 3)", 12 * 72),
            "array \"event\"",
        ),
        (
            "direction",
            zeros("<c16", "(8, 9, 3)", 48 * 72),
            "direction",
        ),
        ("distance", zeros("<f4", "(7, 9)", 4 * 63), "9 × 7"),
    ] {
        let message = with_others(&[(name, array)]).unwrap_err();
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn a_plane_beside_others_is_not_grey_light() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mask.npz");
    let grey = |arrays: &[(&str, Vec<u8>)]| {
        archive_of(&path, arrays);
        let candidate = Picture::read(&path, Encoding::Srgb, &Default::default()).unwrap();
        let reference = with_others(&[]).unwrap();
        let compared = compare(&reference, &candidate, &CompareOptions::default()).unwrap();
        compared.radiance.is_some()
    };
    let object = || ("object", zeros("<i4", "(8, 9)", 4 * 72));
    assert!(!grey(&[("mask", zeros("|b1", "(8, 9)", 72)), object()]));
    assert!(grey(&[
        ("radiance", zeros("<f4", "(8, 9)", 4 * 72)),
        object()
    ]));
    assert!(grey(&[("image", zeros("<f4", "(8, 9)", 4 * 72))]));
}

/// Objects as numbers of one byte, a picture of 8 × 9 pixels without a surface in the upper half.
fn objects(nothing: i8) -> Picture {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("objects.npz");
    let mut array = zeros("|i1", "(8, 9)", 0);
    array.extend((0..72).map(|i| if i < 36 { nothing as u8 } else { i as u8 % 2 }));
    archive_of(&path, &[("object", array)]);
    Picture::read(&path, Encoding::Srgb, &Default::default()).unwrap()
}

#[test]
fn a_number_that_marks_no_hit_is_named() {
    let notes = |nothing: i8| {
        let options = CompareOptions::default();
        compare(&objects(-1), &objects(nothing), &options)
            .unwrap()
            .notes
    };
    for nothing in [99, -2] {
        let words = format!("`set_no_hit` {nothing} says so");
        assert!(
            notes(nothing).iter().any(|n| n.contains(&words)),
            "{:?}",
            notes(nothing)
        );
    }
    for nothing in [-1, 0] {
        assert_eq!(notes(nothing), Vec::<String>::new(), "{nothing}");
    }
    let mut said = objects(99);
    said.set_no_hit(99);
    let compared = compare(&objects(-1), &said, &CompareOptions::default()).unwrap();
    assert_eq!(compared.notes, Vec::<String>::new());
    assert_eq!(compared.surface.unwrap().wrong_objects.unwrap().pixels, 0);
}

#[test]
fn indices_that_are_not_integers_are_refused() {
    let mut wrong = objects(-1);
    let mut ids = wrong.layers.channels[0].samples.to_f64();
    ids[40] = 0.5;
    wrong.layers.channels[0].samples = Samples::F64(ids);
    let error = compare(&objects(-1), &wrong, &CompareOptions::default()).unwrap_err();
    let message = error.to_string();
    assert!(message.contains("0.5 at column 4, row 4"), "{message}");
}

#[test]
fn an_array_without_channels_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("none.npz");
    let arrays = [
        ("radiance", zeros("<f4", "(4, 5, 0)", 0)),
        ("object", zeros("<i4", "(4, 5)", 80)),
    ];
    archive_of(&path, &arrays);
    let read = Picture::read(&path, Encoding::Linear, &Default::default());
    assert!(read.unwrap_err().to_string().contains("not a picture"));
}

#[test]
fn metadata_of_any_byte_order_and_of_one_element_are_read() {
    let json = "{\"quantity\": \"rgb\"}";
    for (order, shape) in [("<", "()"), (">", "()"), ("<", "(1,)"), (">", "(1,)")] {
        let header = header(&format!("{order}U{}", json.len()), "True", shape);
        let mut text = b"\x93NUMPY\x01\x00".to_vec();
        text.extend((header.len() as u16).to_le_bytes());
        text.extend(header.bytes());
        for character in json.chars().map(u32::from) {
            text.extend(match order {
                "<" => character.to_le_bytes(),
                _ => character.to_be_bytes(),
            });
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.npz");
        let light = zeros("<f8", "(2, 3, 3)", 2 * 3 * 3 * 8);
        archive_of(&path, &[("radiance", light), ("metadata", text)]);
        let picture = Picture::read(&path, Encoding::Srgb, &Default::default()).unwrap();
        let metadata = &picture.layers.metadata;
        assert_eq!(
            metadata[..],
            [("quantity".into(), "rgb".into())],
            "{order} {shape}"
        );
    }
}
