//! Textures: decoding and lookup.

use std::fs;
use std::path::Path;

use nullray::io::image::{Texture, png};
use nullray::mesh::{TextureFilter, TextureSampler, Wrap};

fn rgb_png(width: u32, height: u32, rgb: &[u8]) -> Vec<u8> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.png");
    png::write(&path, width, height, rgb, &[]).unwrap();
    fs::read(&path).unwrap()
}

fn decode(bytes: &[u8]) -> nullray::Result<Texture> {
    Texture::decode(bytes, "image 0", Path::new("a.glb"))
}

#[test]
fn a_texture_is_exact_at_texel_centres_and_linear_in_light_between() {
    let texture = decode(&rgb_png(2, 1, &[0, 0, 0, 255, 255, 255])).unwrap();
    assert_eq!(texture.size(), [2, 1]);
    let at = |u: f64| texture.sample([u, 0.5], TextureSampler::linear([Wrap::Clamp; 2]))[0];
    assert_eq!((at(0.25), at(0.75)), (0.0, 1.0));
    // Half of the light, which a blend of code values would make 0.21.
    assert_eq!(at(0.5), 0.5);
    assert_eq!((at(-3.0), at(0.0), at(1.0), at(7.0)), (0.0, 0.0, 1.0, 1.0));
}

/// Of 64 × 64 grey pixels of a bit each, 512 bytes become 4096: the header says so.
#[test]
fn a_texture_that_takes_more_memory_than_is_left_is_refused_before_it_is_decoded() {
    let mut file = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut file, 64, 64);
    encoder.set_depth(::png::BitDepth::One);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[0xaa; 512]).unwrap();
    writer.finish().unwrap();
    let decode =
        |bytes: &[u8], memory| Texture::decode_within(bytes, "image 0", Path::new("a.glb"), memory);
    assert_eq!(decode(&file, 4096).unwrap().bytes(), 4096);
    // Also where its pixels are not there: nothing of them was read.
    for bytes in [&file[..], &file[..file.len() - 20]] {
        let error = decode(bytes, 4095).unwrap_err();
        assert!(error.to_string().contains("more memory"), "{error}");
    }
    let error = decode(&file[..file.len() - 20], 4096).unwrap_err();
    assert!(error.to_string().contains("not a readable"), "{error}");
}

#[test]
fn the_top_row_of_a_texture_is_at_v_0() {
    let texture = decode(&rgb_png(1, 2, &[255, 0, 0, 0, 0, 255])).unwrap();
    assert_eq!(
        texture.sample([0.5, 0.25], TextureSampler::linear([Wrap::Clamp; 2])),
        [1.0, 0.0, 0.0]
    );
    assert_eq!(
        texture.sample([0.5, 0.75], TextureSampler::linear([Wrap::Clamp; 2])),
        [0.0, 0.0, 1.0]
    );
}

#[test]
fn the_nearest_texel_is_shown_to_the_bit_where_the_sampler_asks_for_it() {
    // Every pixel differs; sixteen places in each, and some beyond the edges.
    let rgb: Vec<u8> = (0..3 * 2 * 3).map(|k| 40 + 11 * k).collect();
    let texture = decode(&rgb_png(3, 2, &rgb)).unwrap();
    let shown = |uv, wrap, filter| texture.sample(uv, TextureSampler { wrap, filter });
    for (wrap, index) in [
        (
            Wrap::Clamp,
            (|i: i64, n: i64| i.clamp(0, n - 1)) as fn(i64, i64) -> i64,
        ),
        (Wrap::Repeat, |i, n| i.rem_euclid(n)),
        (Wrap::Mirror, |i, n| match i.rem_euclid(2 * n) {
            i if i < n => i,
            i => 2 * n - 1 - i,
        }),
    ] {
        for (k, l) in (-18_i64..30).flat_map(|k| (-12_i64..20).map(move |l| (k, l))) {
            let [u, v] = [(k as f64 + 0.5) / 18.0, (l as f64 + 0.5) / 12.0];
            let (j, i) = (index(k.div_euclid(6), 3), index(l.div_euclid(6), 2));
            let centre = [(j as f64 + 0.5) / 3.0, (i as f64 + 0.5) / 2.0];
            let texel = shown(centre, [Wrap::Clamp; 2], TextureFilter::Linear);
            assert_eq!(
                shown([u, v], [wrap; 2], TextureFilter::Nearest),
                texel,
                "{u} {v} {wrap:?}"
            );
        }
    }
}

#[test]
fn wrapping_repeats_and_mirrors() {
    let rgb: Vec<u8> = [0u8, 60, 130, 255].iter().flat_map(|&c| [c; 3]).collect();
    let texture = decode(&rgb_png(4, 1, &rgb)).unwrap();
    let at = |u: f64, wrap| texture.sample([u, 0.5], TextureSampler::linear([wrap; 2]))[0];
    for i in 0..400 {
        let u = f64::from(i) / 128.0 - 1.0;
        assert_eq!(at(u, Wrap::Repeat), at(u + 2.0, Wrap::Repeat), "{u}");
        assert_eq!(at(u, Wrap::Mirror), at(u + 2.0, Wrap::Mirror), "{u}");
        assert!(
            (at(u, Wrap::Mirror) - at(-u, Wrap::Mirror)).abs() < 1e-15,
            "{u}"
        );
    }
    // Across the seam: last and first texel meet, or each meets itself.
    assert_eq!(at(0.0, Wrap::Repeat), 0.5);
    assert_eq!(at(1.0, Wrap::Repeat), 0.5);
    assert_eq!((at(1.0, Wrap::Mirror), at(2.0, Wrap::Mirror)), (1.0, 0.0));
    assert_eq!(at(0.125, Wrap::Mirror), at(-0.125, Wrap::Mirror));
}

#[test]
fn non_finite_or_huge_coordinates_give_a_finite_colour() {
    let texture = decode(&rgb_png(3, 2, &[200; 18])).unwrap();
    for x in [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        1e300,
        -1e300,
        -1e-320,
        9e15,
    ] {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            let rgb = texture.sample([x, -x], TextureSampler::linear([wrap; 2]));
            assert!(
                rgb.iter().all(|c| (c - rgb[0]).abs() < 1e-15 && *c > 0.5),
                "{x} {wrap:?}"
            );
        }
    }
}

#[test]
fn grey_and_16_bit_images_keep_their_precision() {
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(::png::ColorType::Grayscale);
    encoder.set_depth(::png::BitDepth::Sixteen);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[0x80, 0x01]).unwrap();
    writer.finish().unwrap();
    let [r, g, b] = decode(&bytes)
        .unwrap()
        .sample([0.5; 2], TextureSampler::linear([Wrap::Clamp; 2]));
    let expected = nullray::colour::srgb_decode(f64::from(0x8001) / 65535.0);
    assert_eq!([r, g, b], [expected; 3]);
}

#[test]
fn broken_and_foreign_images_are_errors_that_say_where() {
    let error = decode(b"GIF89a not for us").unwrap_err().to_string();
    assert!(error.starts_with("a.glb, image 0: "), "{error}");
    assert!(decode(&[]).is_err());
    let good = rgb_png(16, 16, &[90; 768]);
    for length in 0..good.len() - 12 {
        assert!(decode(&good[..length]).is_err(), "cut to {length} bytes");
    }
    for i in 0..good.len() {
        for value in [0, 0xff, good[i] ^ 0x80] {
            let mut bad = good.clone();
            bad[i] = value;
            let _ = decode(&bad);
        }
    }
}

#[test]
fn an_image_that_claims_to_be_huge_is_refused() {
    let mut bytes = rgb_png(1, 1, &[0; 3]);
    // Width in IHDR, with its checksum corrected.
    bytes[16..20].copy_from_slice(&20_000u32.to_be_bytes());
    let crc = crc(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&crc.to_be_bytes());
    let error = decode(&bytes).unwrap_err();
    assert!(error.to_string().contains("imit"), "{error}");
}

/// CRC-32 as PNG defines it.
fn crc(bytes: &[u8]) -> u32 {
    let step = |crc: u32| {
        if crc & 1 == 1 {
            0xedb8_8320 ^ (crc >> 1)
        } else {
            crc >> 1
        }
    };
    !bytes.iter().fold(u32::MAX, |crc, &b| {
        (0..8).fold(crc ^ u32::from(b), |c, _| step(c))
    })
}
