//! Image files: pictures are read back as written, by this crate and by independent readers.

use std::fs;
use std::io::{Cursor, Read};
use std::path::Path;

use nullray::Error;
use nullray::io::image::{Channel, Layers, Samples, exr, npz, png};

const WIDTH: u32 = 37;
const HEIGHT: u32 = 21;

fn channel(name: &str, samples: Samples) -> Channel {
    Channel {
        name: name.into(),
        samples,
    }
}

/// Every kind of sample, with the values that are easily lost.
fn layers() -> Layers {
    let n = (WIDTH * HEIGHT) as usize;
    let f32s = |k: f32| (0..n).map(|i| i as f32 * k).collect::<Vec<_>>();
    let f64s = |k: f64| (0..n).map(|i| i as f64 * k + 1e-12).collect::<Vec<_>>();
    let mut ct = f64s(0.1);
    ct[3] = f64::NAN;
    ct[4] = f64::NEG_INFINITY;
    let mut ids: Vec<i32> = (0..n as i32).map(|i| i - 1).collect();
    ids[9] = i32::MAX;
    ids[10] = i32::MIN;
    let channels = vec![
        channel("radiance.R", Samples::F32(f32s(1.0))),
        channel("radiance.G", Samples::F32(f32s(-0.5))),
        channel("radiance.B", Samples::F32(f32s(1e-30))),
        channel("event.ct", Samples::F64(ct)),
        channel("object", Samples::I32(ids)),
        channel(
            "samples",
            Samples::U32((0..n as u32).map(|i| u32::MAX - i).collect()),
        ),
    ];
    let metadata = [
        ("scene", "speed = \"0.9 c\"\n# γ = 2.3, tab\tand \"quotes\""),
        ("version", "0.1.0"),
        ("empty", ""),
    ];
    let metadata = metadata
        .map(|(k, v)| (k.to_string(), v.to_string()))
        .to_vec();
    Layers::new(WIDTH, HEIGHT, channels, metadata).unwrap()
}

/// Bits, so that NaN and −0 count.
fn bits(samples: &Samples) -> Vec<u64> {
    match samples {
        Samples::F32(v) => v.iter().map(|x| x.to_bits().into()).collect(),
        Samples::F64(v) => v.iter().map(|x| x.to_bits()).collect(),
        Samples::U32(v) => v.iter().map(|&x| x.into()).collect(),
        Samples::I32(v) => v.iter().map(|&x| x as u64).collect(),
    }
}

#[test]
fn an_exr_keeps_every_sample_and_rounds_f64_alone() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.exr");
    let written = layers();
    exr::write(&path, &written).unwrap();
    let read = exr::read(&path, &Default::default()).unwrap();
    assert_eq!((read.width, read.height), (WIDTH, HEIGHT));
    assert_eq!(read.channels.len(), written.channels.len());
    for channel in &written.channels {
        let same = &read.channel(&channel.name).unwrap().samples;
        let expected = match &channel.samples {
            Samples::F64(v) => Samples::F32(v.iter().map(|&x| x as f32).collect()),
            other => other.clone(),
        };
        assert_eq!(bits(same), bits(&expected), "{}", channel.name);
    }
    let mut metadata = written.metadata.clone();
    metadata.sort();
    assert_eq!(read.metadata, metadata);
}

#[test]
fn the_same_layers_give_the_same_bytes() {
    let directory = tempfile::tempdir().unwrap();
    for name in ["a.exr", "a.npz"] {
        let path = directory.path().join(name);
        let write = || {
            match name {
                "a.exr" => exr::write(&path, &layers()).unwrap(),
                _ => npz::write(&path, &layers()).unwrap(),
            }
            fs::read(&path).unwrap()
        };
        let first = write();
        assert!((0..5).all(|_| write() == first), "{name}");
    }
}

#[test]
fn pictures_in_memory_are_the_bytes_of_their_files() {
    let folder = tempfile::tempdir().unwrap();
    let layers = layers();
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let path = folder.path().join("a.npz");
    npz::write(&path, &layers).unwrap();
    assert!(npz::encode(&path, &layers).unwrap() == read("a.npz"));
    for (half, sealed) in [(false, false), (true, true)] {
        let path = folder.path().join("a.exr");
        let options = exr::Options {
            half,
            sealed,
            ..exr::Options::default()
        };
        exr::write_with(&path, &layers, &options).unwrap();
        assert!(exr::encode(&path, &layers, &options).unwrap() == read("a.exr"));
    }
    let (text, codes) = (layers.metadata.as_slice(), 3 * WIDTH * HEIGHT);
    let path = folder.path().join("a.png");
    let rgb: Vec<u8> = (0..codes).map(|i| (i * 7) as u8).collect();
    png::write(&path, WIDTH, HEIGHT, &rgb, text).unwrap();
    assert!(png::encode(&path, WIDTH, HEIGHT, &rgb, text).unwrap() == read("a.png"));
    let rgb: Vec<u16> = (0..codes).map(|i| (i * 777) as u16).collect();
    png::write_16(&path, WIDTH, HEIGHT, &rgb, text).unwrap();
    assert!(png::encode_16(&path, WIDTH, HEIGHT, &rgb, text).unwrap() == read("a.png"));
    // What a file refuses is refused, with its name.
    let wrong = png::encode(&path, WIDTH, HEIGHT, &[0; 5], text).unwrap_err();
    assert!(wrong.to_string().contains("a.png"), "{wrong}");
}

#[test]
fn half_precision_is_for_what_is_looked_at_alone() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.exr");
    let names = [
        "radiance.R",
        "radiance.G",
        "radiance.B",
        "alpha",
        "distance",
        "event.ct",
    ];
    let channels = names.map(|name| Channel {
        name: name.into(),
        samples: Samples::F64(vec![1.0 / 3.0, 1e6]),
    });
    let written = Layers::new(2, 1, channels.into(), vec![]).unwrap();
    let matrices = [[1.5; 16], std::array::from_fn(|k| k as f32)];
    let options = exr::Options {
        half: true,
        matrices: matrices.map(Some),
        window_width: Some(1.25),
        ..exr::Options::default()
    };
    exr::write_with(&path, &written, &options).unwrap();
    let read = exr::read(&path, &Default::default()).unwrap();
    for name in names {
        let values = read.channel(name).unwrap().samples.to_f64();
        // 1/3 in half precision is 1365/4096, the largest half 65504.
        let expected = match name {
            "distance" | "event.ct" => [f64::from(1.0f32 / 3.0), 1e6],
            _ => [1365.0 / 4096.0, 65504.0],
        };
        assert_eq!(values, expected, "{name}");
    }
    // The standard's names and attributes.
    let file = ::exr::meta::MetaData::read_from_file(&path, true).unwrap();
    let header = &file.headers[0];
    let mut names: Vec<_> = header
        .channels
        .list
        .iter()
        .map(|c| c.name.to_string())
        .collect();
    names.sort();
    assert_eq!(names, ["A", "B", "G", "R", "Z", "event.ct"]);
    let own = &header.own_attributes;
    assert_eq!(own.world_to_camera, Some(matrices[0]));
    assert_eq!(own.world_to_normalized_device, Some(matrices[1]));
    assert_eq!(own.screen_window_width, 1.25);
}

#[test]
fn viewers_find_radiance_as_the_image_of_an_exr() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.exr");
    exr::write(&path, &layers()).unwrap();
    let file = ::exr::meta::MetaData::read_from_file(&path, true).unwrap();
    let header = &file.headers[0];
    let names: Vec<String> = header
        .channels
        .list
        .iter()
        .map(|c| c.name.to_string())
        .collect();
    assert_eq!(names, ["B", "G", "R", "event.ct", "object", "samples"]);
    let software = header
        .own_attributes
        .software_name
        .as_ref()
        .unwrap()
        .to_string();
    assert!(software.starts_with("nullray "), "{software}");
}

/// A minimal reader of npy 1.0: descriptor and shape as written, and the data.
fn npy(archive: &Path, name: &str) -> (String, Vec<u8>) {
    let mut archive = zip::ZipArchive::new(fs::File::open(archive).unwrap()).unwrap();
    let mut bytes = Vec::new();
    let mut entry = archive.by_name(&format!("{name}.npy")).unwrap();
    entry.read_to_end(&mut bytes).unwrap();
    assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
    let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    assert_eq!((10 + length) % 64, 0);
    let header = String::from_utf8(bytes[10..10 + length].to_vec()).unwrap();
    assert!(header.ends_with('\n'));
    (header.trim_end().to_string(), bytes[10 + length..].to_vec())
}

#[test]
fn an_npz_holds_every_channel_bit_for_bit() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.npz");
    let layers = layers();
    npz::write(&path, &layers).unwrap();

    let (header, data) = npy(&path, "event.ct");
    assert_eq!(
        header,
        "{'descr': '<f8', 'fortran_order': False, 'shape': (21, 37), }"
    );
    let ct: Vec<u64> = data
        .chunks_exact(8)
        .map(|b| u64::from_le_bytes(b.try_into().unwrap()))
        .collect();
    assert_eq!(ct, bits(&layers.channel("event.ct").unwrap().samples));

    let (header, data) = npy(&path, "object");
    assert!(header.contains("'<i4'"));
    let ids: Vec<i32> = data
        .chunks_exact(4)
        .map(|b| i32::from_le_bytes(b.try_into().unwrap()))
        .collect();
    assert_eq!(Samples::I32(ids), layers.channel("object").unwrap().samples);

    let (header, data) = npy(&path, "radiance");
    assert!(
        header.contains("'<f4'") && header.contains("(21, 37, 3)"),
        "{header}"
    );
    let rgb: Vec<f64> = data
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes(b.try_into().unwrap()).into())
        .collect();
    assert_eq!(rgb, layers.radiance().unwrap().concat());
}

#[test]
fn the_metadata_of_an_npz_is_json_in_a_numpy_text() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.npz");
    npz::write(&path, &layers()).unwrap();
    let (header, data) = npy(&path, "metadata");
    assert!(header.contains(&format!("'<U{}'", data.len() / 4)) && header.contains("'shape': ()"));
    let text: String = data
        .chunks_exact(4)
        .map(|b| char::from_u32(u32::from_le_bytes(b.try_into().unwrap())).unwrap())
        .collect();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    for (key, value) in layers().metadata {
        assert_eq!(json[key], value);
    }
}

#[test]
fn names_that_collide_in_a_file_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let one = |names: &[&str]| {
        let channels = names
            .iter()
            .map(|name| channel(name, Samples::F32(vec![0.0])));
        Layers::new(1, 1, channels.collect(), vec![]).unwrap()
    };
    let path = directory.path().join("a");
    for names in [
        &["metadata"][..],
        &["../x"],
        &["radiance", "radiance.R", "radiance.G", "radiance.B"],
    ] {
        assert!(
            matches!(npz::write(&path, &one(names)), Err(Error::Unsupported(_))),
            "{names:?}"
        );
    }
    for names in [&["R", "radiance.R"][..], &[]] {
        assert!(
            matches!(exr::write(&path, &one(names)), Err(Error::Unsupported(_))),
            "{names:?}"
        );
    }
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 0);
}

#[test]
fn a_png_is_lossless_and_holds_its_texts() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.png");
    let rgb: Vec<u8> = (0..3 * WIDTH * HEIGHT).map(|i| (i * 7) as u8).collect();
    let layers = layers();
    png::write(&path, WIDTH, HEIGHT, &rgb, &layers.metadata).unwrap();
    let decoder = ::png::Decoder::new(Cursor::new(fs::read(&path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    assert_eq!(pixels, rgb);
    let info = reader.info();
    assert_eq!(info.utf8_text[0].get_text().unwrap(), layers.metadata[0].1);
    assert_eq!(info.uncompressed_latin1_text[0].text, "0.1.0");
    assert!(png::write(&path, 3, 3, &rgb, &[]).is_err());
}

/// Zeros become a small part of their length: 17 MiB of them make a small file.
#[test]
fn compressed_texts_of_a_png_are_unpacked_up_to_a_limit() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.png");
    for (mebibytes, fits) in [(1, true), (17, false)] {
        let mut encoder = ::png::Encoder::new(fs::File::create(&path).unwrap(), 1, 1);
        let text = "0".repeat(mebibytes << 20);
        encoder.add_ztxt_chunk("a".into(), text.clone()).unwrap();
        encoder.add_ztxt_chunk("b".into(), "short".into()).unwrap();
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&[7]).unwrap();
        writer.finish().unwrap();
        assert!(fs::metadata(&path).unwrap().len() < (mebibytes << 20) as u64 / 20);
        match (png::inspect(&path), fits) {
            (Ok(info), true) => {
                assert_eq!(
                    info.text,
                    [("a".into(), text), ("b".into(), "short".into())]
                );
            }
            (Err(error), false) => {
                assert!(error.to_string().contains("compressed texts"), "{error}");
            }
            (other, _) => panic!("{mebibytes} MiB: {:?}", other.is_ok()),
        }
    }
}

#[test]
fn files_of_more_texts_than_anyone_reads_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let [png, exr] = ["a.png", "a.exr"].map(|name| directory.path().join(name));
    for (count, fits) in [(10_000, true), (10_001, false)] {
        let entry = |i: usize| (format!("key{i:05}"), "text".to_string());
        let entries: Vec<_> = (0..count).map(entry).collect();
        png::write(&png, 1, 1, &[1, 2, 3], &entries).unwrap();
        let one = channel("a", Samples::F32(vec![0.0]));
        let layers = Layers::new(1, 1, vec![one], entries).unwrap();
        exr::write(&exr, &layers).unwrap();
        for read in [
            png::read(&png, &Default::default()),
            exr::read(&exr, &Default::default()),
        ] {
            match (read, fits) {
                (Ok(layers), true) => assert!(layers.metadata.len() >= count),
                (Err(error), false) => {
                    assert!(error.to_string().contains("texts of metadata"), "{error}");
                }
                (other, _) => panic!("{count}: {:?}", other.is_ok()),
            }
        }
    }
}

#[test]
fn hostile_exr_files_are_errors_or_images_but_never_a_panic() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.exr");
    exr::write(&path, &layers()).unwrap();
    let good = fs::read(&path).unwrap();
    for length in (0..good.len()).step_by(61) {
        fs::write(&path, &good[..length]).unwrap();
        let Err(Error::Invalid(problem)) = exr::read(&path, &Default::default()) else {
            panic!("cut to {length} bytes");
        };
        let is_told = problem.help.contains("copy it again") || length < 4;
        assert!(is_told, "cut to {length} bytes: {problem}");
    }
    // Every byte of the header and some of the pixels, to several values.
    for i in (0..1500).chain((1500..good.len()).step_by(97)) {
        for value in [0xff, good[i].wrapping_add(1)] {
            let mut bad = good.clone();
            bad[i] = value;
            fs::write(&path, &bad).unwrap();
            let _ = exr::read(&path, &Default::default());
        }
    }
}

#[test]
fn an_exr_that_claims_too_much_is_refused_before_anything_is_allocated() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.exr");
    let one = channel("a", Samples::F32(vec![0.0]));
    exr::write(&path, &Layers::new(1, 1, vec![one], vec![]).unwrap()).unwrap();
    let mut file = fs::read(&path).unwrap();
    // The data window's maximum, after `dataWindow \0 box2i \0 size xmin ymin`.
    let name = b"dataWindow\0box2i\0";
    let at = file.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 12;
    file[at..at + 8].copy_from_slice(&[0xff, 0xff, 0xff, 0x3f, 0xff, 0xff, 0xff, 0x3f]);
    fs::write(&path, file).unwrap();
    let error = exr::read(&path, &Default::default()).unwrap_err();
    for part in ["a.exr", "truncated or damaged"] {
        assert!(error.to_string().contains(part), "{error}");
    }
}

#[test]
fn colours_of_other_primaries_and_parts_of_pictures_are_refused() {
    use ::exr::meta::attribute::Chromaticities;
    use ::exr::prelude::{
        AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ImageAttributes, IntegerBounds,
        Layer, LayerAttributes, Vec2, WritableImage,
    };
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.exr");
    let rec_709 = Chromaticities {
        red: Vec2(0.64, 0.33),
        green: Vec2(0.30, 0.60),
        blue: Vec2(0.15, 0.06),
        white: Vec2(0.3127, 0.3290),
    };
    // Of ACES.
    let ap0 = Chromaticities {
        red: Vec2(0.7347, 0.2653),
        green: Vec2(0.0, 1.0),
        blue: Vec2(0.0001, -0.077),
        white: Vec2(0.32168, 0.33767),
    };
    let write = |names: &[&'static str], chromaticities, shown: (usize, usize), from| {
        let channel = |name: &&'static str| AnyChannel::new(*name, FlatSamples::F32(vec![1.0; 2]));
        let channels = AnyChannels::sort(names.iter().map(channel).collect());
        let attributes = LayerAttributes {
            layer_position: from,
            ..LayerAttributes::default()
        };
        let layer = Layer::new((2, 1), attributes, Encoding::SMALL_LOSSLESS, channels);
        let attributes = ImageAttributes {
            chromaticities,
            ..ImageAttributes::new(IntegerBounds::from_dimensions(shown))
        };
        let image = Image {
            attributes,
            layer_data: layer,
        };
        image.write().to_file(&path).unwrap();
    };
    let said = |read: nullray::Result<Layers>| read.map(drop).map_err(|error| error.to_string());
    let budget = Default::default();
    let (whole, start) = ((2, 1), Vec2(0, 0));
    for known in [None, Some(rec_709)] {
        write(&["R", "G", "B"], known, whole, start);
        assert_eq!(said(exr::read_whole(&path, &budget)), Ok(()));
    }
    write(&["R", "G", "B"], Some(ap0), whole, start);
    let error = said(exr::read(&path, &budget)).unwrap_err();
    assert!(error.contains("`chromaticities`"), "{error}");
    // What is no colour has no primaries.
    write(&["Z"], Some(ap0), whole, start);
    assert_eq!(said(exr::read(&path, &budget)), Ok(()));
    for (shown, from) in [((4, 2), start), (whole, Vec2(1, 0))] {
        write(&["R", "G", "B"], None, shown, from);
        assert_eq!(said(exr::read(&path, &budget)), Ok(()));
        let error = said(exr::read_whole(&path, &budget)).unwrap_err();
        assert!(error.contains("display window"), "{error}");
    }
}

#[test]
fn parts_of_a_foreign_exr_become_layers() {
    use ::exr::prelude::{
        AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ImageAttributes, Layer,
        LayerAttributes, WritableImage, f16,
    };
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.exr");
    let part = |name: &str, samples| {
        let channels = AnyChannels::sort([AnyChannel::new("Z", samples)].into_iter().collect());
        let attributes = LayerAttributes::named(name);
        Layer::new((2, 1), attributes, Encoding::SMALL_LOSSLESS, channels)
    };
    let half = [1.5, -2.0].map(f16::from_f32).to_vec();
    let parts = [
        part("near", FlatSamples::F16(half)),
        part("far", FlatSamples::U32(vec![7, u32::MAX])),
    ];
    let image = Image::from_layers(ImageAttributes::with_size((2, 1)), parts.to_vec());
    image.write().to_file(&path).unwrap();
    let layers = exr::read(&path, &Default::default()).unwrap();
    let samples = |name| layers.channel(name).unwrap().samples.clone();
    assert_eq!(samples("near.Z"), Samples::F32(vec![1.5, -2.0]));
    assert_eq!(samples("far.Z"), Samples::U32(vec![7, u32::MAX]));
}
