//! Pictures that cannot be compared, and why.

use nullray::io::image::{Channel, Samples};
use nullray::validate::compare::{
    Alpha, CompareOptions, Encoding, NotFinite, Picture, Tolerance, compare,
};

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
fn channels_without_a_sample_for_each_pixel_are_refused() {
    let [r, mut c] = light(8, 8);
    let Samples::F32(samples) = &mut c.layers.channels[1].samples else {
        unreachable!("light is single precision");
    };
    samples.truncate(60);
    let words = ["radiance.G", "60 samples for 64 pixels"];
    says(&r, &c, &words);
    says(&c, &r, &words);
}

#[test]
fn other_sizes_are_refused() {
    let ([r, _], [_, c]) = (light(8, 8), light(9, 8));
    says(&r, &c, &["9 × 8", "8 × 8"]);
}

#[test]
fn channels_of_one_picture_alone_are_listed_and_the_others_compared() {
    let [mut r, mut c] = light(8, 8);
    r.layers.channels.remove(2);
    c.layers.channels.remove(1);
    let compared = compare(&r, &c, &CompareOptions::default()).unwrap();
    let names: Vec<_> = compared.channels.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["radiance.R"]);
    assert_eq!(compared.uncompared.only_reference, ["radiance.G"]);
    assert_eq!(compared.uncompared.only_candidate, ["radiance.B"]);
    // A limit on the light is not kept by one of its colours; one on that colour is.
    for (metric, why) in [
        ("rmse", "lacks radiance.G of the light"),
        ("flip", "lacks radiance.G of the light"),
        ("radiance.R:rmse", ""),
    ] {
        let limit = Tolerance {
            metric: metric.into(),
            value: 1.0,
        };
        let breaches = compared.breaches(&[limit]).unwrap();
        assert_eq!(breaches.is_empty(), why.is_empty(), "{metric}");
        let said = format!("{breaches:?}");
        assert!(said.contains(why), "{said}");
    }
}

#[test]
fn channels_that_are_demanded_have_to_be_there() {
    let [r, mut c] = light(8, 8);
    c.layers.channels.remove(1);
    let demand = |names: &[&str]| {
        let options = CompareOptions {
            channels: names.iter().map(|name| name.to_string()).collect(),
            ..CompareOptions::default()
        };
        compare(&r, &c, &options).map_err(|error| error.to_string())
    };
    assert!(demand(&["radiance.R"]).is_ok());
    for (names, lacks) in [
        (["radiance"].as_slice(), "no radiance.G"),
        (&["radiance.R", "event"], "no event"),
    ] {
        let message = demand(names).unwrap_err();
        assert!(
            message.contains(lacks) && message.contains("`channels`"),
            "{message}"
        );
    }
}

#[test]
fn pictures_without_a_common_channel_are_refused() {
    let [mut r, mut c] = light(8, 8);
    r.layers.channels.truncate(1);
    c.layers.channels.remove(0);
    says(&r, &c, &["no channel in common", "radiance.R"]);
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
fn non_finite_samples_are_refused_with_their_position() {
    let [r, mut c] = light(8, 8);
    set(&mut c, 19, f32::NAN);
    says(&r, &c, &["radiance.R", "1 NaN", "column 3, row 2"]);
}

#[test]
fn non_finite_samples_can_be_skipped_or_replaced() {
    let [r, mut c] = light(8, 8);
    set(&mut c, 19, f32::NAN);
    let with = |not_finite| {
        let options = CompareOptions {
            not_finite,
            ..CompareOptions::default()
        };
        compare(&r, &c, &options).unwrap()
    };
    // The pixel counts in no channel, whichever of them is no number there.
    let ignored = with(NotFinite::Ignore);
    assert_eq!(ignored.pixels, 63);
    for channel in &ignored.channels {
        assert_eq!(
            channel.errors.as_ref().unwrap().count,
            63,
            "{}",
            channel.name
        );
    }
    let counted = with(NotFinite::CountAs(100.0));
    let counted = counted.channels[0].errors.as_ref().unwrap();
    assert_eq!(counted.count, 64);
    assert!(counted.max > 90.0);
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
    let help = |alpha: Alpha| {
        let c = Picture { alpha, ..c.clone() };
        let error = compare(&r, &c, &CompareOptions::default()).unwrap_err();
        error.help().to_string()
    };
    assert!(help(Alpha::Premultiplied).contains("is premultiplied by alpha"));
    assert!(help(Alpha::Straight).contains("is not multiplied by alpha"));
}

#[test]
fn a_crop_beyond_the_picture_is_refused() {
    let [r, c] = light(8, 8);
    let mut options = CompareOptions::default();
    options.region.crop = Some([4, 4, 5, 1]);
    let message = compare(&r, &c, &options).unwrap_err().to_string();
    assert!(message.contains("5 × 1 pixels at (4, 4)"), "{message}");
}
