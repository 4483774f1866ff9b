//! Pictures as numpy writes them: types, shapes and orders of arrays.

use std::path::Path;

use nullray::io::image::Layers;
use nullray::validate::compare::{Encoding, Picture};

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
    use std::io::Write;
    let mut archive = zip::ZipWriter::new(std::fs::File::create(path).unwrap());
    let name = path.file_stem().unwrap().to_str().unwrap();
    let options = zip::write::SimpleFileOptions::default();
    archive.start_file(format!("{name}.npy"), options).unwrap();
    archive.write_all(array).unwrap();
    archive.finish().unwrap();
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
fn what_stands_where_nothing_is_met_can_be_said() {
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
fn what_is_no_picture_is_refused_with_what_it_is() {
    for (descr, shape, bytes, words) in [
        ("<c16", "(1, 1)", 16, "complex numbers (<c16)"),
        ("<f16", "(1, 1)", 16, "more than 64 bits (<f16)"),
        ("|O", "(1, 1)", 8, "Python objects"),
        ("<U4", "(1, 1)", 16, "texts"),
        ("<f4", "(4,)", 16, "shape [4] is no picture"),
        ("<f4", "(1, 1, 5)", 20, "shape [1, 1, 5] is no picture"),
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
