//! Pictures that cannot be compared, and why.

use nullray::io::image::{Channel, Samples};
use nullray::validate::compare::{CompareOptions, Encoding, NotFinite, Picture, compare};

use crate::compare::pictures::light;

fn message(reference: &Picture, candidate: &Picture) -> String {
    compare(reference, candidate, &CompareOptions::default())
        .unwrap_err()
        .to_string()
}

fn says(reference: &Picture, candidate: &Picture, words: &[&str]) {
    let message = message(reference, candidate);
    assert!(words.iter().all(|word| message.contains(word)), "{message}");
}

fn with_metadata(picture: &Picture, key: &str, value: &str) -> Picture {
    let mut picture = picture.clone();
    picture.layers.metadata.push((key.into(), value.into()));
    picture
}

fn set(picture: &mut Picture, index: usize, value: f32) {
    let Samples::F32(samples) = &mut picture.layers.channels[0].samples else {
        unreachable!("light is single precision");
    };
    samples[index] = value;
}

#[test]
fn other_sizes_are_refused() {
    let ([r, _], [_, c]) = (light(8, 8), light(9, 8));
    says(&r, &c, &["9 × 8", "8 × 8"]);
}

#[test]
fn other_channels_are_refused_by_name() {
    let [r, mut c] = light(8, 8);
    c.layers.channels.remove(1);
    says(&r, &c, &["lacks radiance.G"]);
    says(&c, &r, &["has also radiance.G"]);
}

#[test]
fn other_encodings_are_refused() {
    let [r, mut c] = light(8, 8);
    c.encoding = Encoding::Srgb;
    says(&r, &c, &["sRGB codes", "linear light"]);
}

#[test]
fn other_quantities_are_refused() {
    let [r, c] = light(8, 8);
    let r = with_metadata(&r, "radiance_quantity", "photons");
    let c = with_metadata(&c, "radiance_quantity", "line");
    says(&r, &c, &["radiance_quantity is line", "photons"]);
}

#[test]
fn swapped_arguments_are_refused() {
    let [r, c] = light(8, 8);
    let exact = with_metadata(&r, "software", "nullray 0.1.0");
    let raster = with_metadata(
        &with_metadata(&c, "software", "nullray 0.1.0"),
        "method",
        "raster:none",
    );
    says(&raster, &exact, &["look swapped", "raster:none"]);
    assert!(compare(&exact, &raster, &CompareOptions::default()).is_ok());
    let options = CompareOptions {
        allow_swapped: true,
        ..CompareOptions::default()
    };
    assert!(compare(&raster, &exact, &options).is_ok());
}

#[test]
fn samples_that_are_no_numbers_are_refused_with_their_place() {
    let [r, mut c] = light(8, 8);
    set(&mut c, 19, f32::NAN);
    says(&r, &c, &["radiance.R", "1 NaN", "column 3, row 2"]);
}

#[test]
fn samples_that_are_no_numbers_can_be_left_out_or_counted() {
    let [r, mut c] = light(8, 8);
    set(&mut c, 19, f32::NAN);
    let with = |not_finite| {
        let options = CompareOptions {
            not_finite,
            ..CompareOptions::default()
        };
        compare(&r, &c, &options).unwrap()
    };
    let ignored = with(NotFinite::Ignore);
    assert_eq!(ignored.channels[0].errors.count, 63);
    assert_eq!(ignored.channels[0].only_reference, 1);
    let counted = with(NotFinite::CountAs(100.0));
    assert_eq!(counted.channels[0].errors.count, 64);
    assert!(counted.channels[0].errors.max > 90.0);
}

#[test]
fn half_precision_that_overflows_is_named() {
    let [r, mut c] = light(8, 8);
    set(&mut c, 0, f32::INFINITY);
    says(&r, &c, &["1 infinite"]);
    c.half = vec!["radiance.R".into()];
    says(&r, &c, &["half precision", "65504"]);
}

#[test]
fn alpha_that_one_picture_has_alone_counts_where_it_is_not_opaque() {
    let [r, mut c] = light(8, 8);
    c.layers.channels.push(Channel {
        name: "A".into(),
        samples: Samples::F32(vec![1.0; 64]),
    });
    let compared = compare(&r, &c, &CompareOptions::default()).unwrap();
    assert!(compared.notes[0].contains("opaque"), "{:?}", compared.notes);
    c.layers.channels[3].samples = Samples::F32(vec![0.5; 64]);
    says(&r, &c, &["alpha", "transparent"]);
}

#[test]
fn a_crop_beyond_the_picture_is_refused() {
    let [r, c] = light(8, 8);
    let mut options = CompareOptions::default();
    options.region.crop = Some([4, 4, 5, 1]);
    let message = compare(&r, &c, &options).unwrap_err().to_string();
    assert!(message.contains("5 × 1 pixels at (4, 4)"), "{message}");
}
