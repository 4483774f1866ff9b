//! Metrics against numpy, scikit-image and the published FLIP: `tests/data/compare`.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::LazyLock;

use nullray::error::Message;
use nullray::validate::compare::{
    Breach, CompareOptions, Comparison, Errors, Picture, Region, Tolerance, compare,
};

use crate::compare::pictures::{codes, layers, light};

/// Expected values of one picture by metric.
fn expected(picture: &str, width: u32) -> HashMap<String, f64> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/compare/metrics.csv");
    let text = std::fs::read_to_string(path).unwrap();
    let rows = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect::<Vec<_>>());
    let rows = rows.filter(|row| row[0] == picture && row[1] == width.to_string());
    rows.map(|row| (row[3].to_string(), row[4].parse().unwrap()))
        .collect()
}

/// The comparison on so many threads, with maps.
fn compared_on(threads: usize, [reference, candidate]: &[Picture; 2]) -> Comparison {
    let options = CompareOptions {
        maps: true,
        ..CompareOptions::default()
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let pool = pool.build().unwrap();
    pool.install(|| compare(reference, candidate, &options).unwrap())
}

/// Every kind of picture, at a size within one tile and at one of several, on three threads.
static CASES: LazyLock<Vec<(HashMap<String, f64>, Comparison)>> = LazyLock::new(|| {
    let mut cases = Vec::new();
    for (width, height) in [(61, 47), (600, 300)] {
        for (name, pair) in [
            ("light", light(width, height)),
            ("codes", codes(width, height)),
        ] {
            cases.push((expected(name, width), compared_on(3, &pair)));
        }
    }
    cases
});

fn close(got: f64, expected: f64, relative: f64) {
    let error = (got - expected).abs();
    assert!(error <= relative * expected.abs(), "{got} for {expected}");
}

fn check(metric: &str, relative: f64, of: impl Fn(&Errors) -> f64) {
    for (expected, compared) in CASES.iter() {
        close(
            of(compared.radiance.as_ref().unwrap()),
            expected[metric],
            relative,
        );
    }
}

#[test]
fn means_are_those_of_numpy() {
    check("bias", 1e-10, |e| e.bias);
    check("mae", 1e-12, |e| e.mae);
    check("rmse", 1e-12, |e| e.rmse);
    check("relrmse", 1e-12, |e| e.relrmse.unwrap());
    check("max", 1e-15, |e| e.max);
}

#[test]
fn mean_relative_square_error_is_that_of_imgtool() {
    check("mrse", 1e-12, |e| e.mrse);
}

#[test]
fn percentiles_are_those_of_numpy_within_a_bin() {
    check("p50", 1.0 / 1024.0, |e| e.p50);
    check("p90", 1.0 / 1024.0, |e| e.p90);
    check("p99", 1.0 / 1024.0, |e| e.p99);
    check("p99.9", 1.0 / 1024.0, |e| e.p99_9);
}

#[test]
fn signal_to_noise_and_similarity_are_those_of_scikit_image() {
    check("psnr", 1e-12, |e| e.psnr.unwrap());
    check("ssim", 1e-9, |e| e.ssim.unwrap());
}

#[test]
fn flip_is_that_of_the_published_tool() {
    for (expected, compared) in CASES.iter() {
        let flip = compared.flip.as_ref().unwrap();
        close(flip.mean, expected["flip"], 2e-5);
        close(flip.max, expected["flip_max"], 1e-3);
    }
}

#[test]
fn exposures_are_those_of_the_published_tool() {
    for (expected, compared) in CASES.iter() {
        let flip = compared.flip.as_ref().unwrap();
        let Some([start, stop]) = flip.exposures else {
            assert!(!expected.contains_key("flip_start"));
            continue;
        };
        close(start, expected["flip_start"], 1e-6);
        close(stop, expected["flip_stop"], 1e-6);
        assert_eq!(f64::from(flip.steps), expected["flip_steps"]);
    }
}

#[test]
fn equal_pictures_have_no_error() {
    let [r, _] = light(61, 47);
    let compared = compare(&r, &r, &CompareOptions::default()).unwrap();
    let e = compared.radiance.unwrap();
    assert_eq!([e.bias, e.mae, e.rmse, e.max, e.p99_9, e.mrse], [0.0; 6]);
    assert_eq!((e.relrmse, e.psnr, e.max_at), (Some(0.0), None, None));
    assert!((e.ssim.unwrap() - 1.0).abs() < 1e-12);
    assert_eq!(compared.flip.unwrap().max, 0.0);
}

#[test]
fn black_pictures_are_equal() {
    let black = |name: &str| {
        let mut picture = light(16, 16)[0].clone();
        for channel in &mut picture.layers.channels {
            channel.samples = nullray::io::image::Samples::F32(vec![0.0; 256]);
        }
        picture.name = name.into();
        picture
    };
    let compared = compare(&black("a"), &black("b"), &CompareOptions::default()).unwrap();
    assert_eq!(compared.flip.unwrap().mean, 0.0);
    let e = compared.radiance.unwrap();
    assert_eq!((e.relrmse, e.ssim), (Some(0.0), Some(1.0)));
}

#[test]
fn pictures_of_one_row_or_one_column_are_compared() {
    for (width, height) in [(70, 1), (1, 70), (1, 1)] {
        let [r, c] = light(width, height);
        let compared = compare(&r, &c, &CompareOptions::default()).unwrap();
        assert!(compared.radiance.unwrap().rmse > 0.0, "{width} × {height}");
    }
}

#[test]
fn pictures_of_light_that_is_all_but_gone_have_at_most_64_exposures() {
    // More than half of it is the tail of a pulse, below the normal numbers of f32, where 1/x is infinite.
    let dim = |tail: f32| {
        let mut picture = light(16, 16)[0].clone();
        for channel in &mut picture.layers.channels {
            let value = |k: usize| if k < 200 { tail } else { 1.0 };
            channel.samples = nullray::io::image::Samples::F32((0..256).map(value).collect());
        }
        picture
    };
    let flip = |candidate: f32| {
        let compared = compare(&dim(1e-40), &dim(candidate), &CompareOptions::default());
        compared.unwrap().flip.unwrap()
    };
    let same = flip(1e-40);
    let [_, stop] = same.exposures.unwrap();
    assert!(
        same.mean == 0.0 && stop == 127.0 && same.steps == 64,
        "{same:?}"
    );
    // 1e-38 is 1.7 of the brightest exposure's light, 1e-40 is 0.017 of it.
    let brighter = flip(1e-38);
    assert!(brighter.mean > 0.1 && brighter.mean <= 1.0, "{brighter:?}");
}

/// The part of both pictures from `[x, y]` on.
fn part(pair: &[Picture; 2], [x, y]: [usize; 2], [w, h]: [usize; 2]) -> [Picture; 2] {
    pair.clone().map(|mut picture| {
        let width = picture.layers.width as usize;
        for channel in &mut picture.layers.channels {
            let all = channel.samples.to_f64();
            let rows = (y..y + h).flat_map(|y| all[y * width + x..y * width + x + w].to_vec());
            channel.samples = nullray::io::image::Samples::F64(rows.collect());
        }
        (picture.layers.width, picture.layers.height) = (w as u32, h as u32);
        picture
    })
}

#[test]
fn a_crop_has_the_errors_of_the_part() {
    let pair = light(61, 47);
    let options = CompareOptions {
        region: Region {
            crop: Some([5, 7, 30, 20]),
            mask: None,
        },
        ..CompareOptions::default()
    };
    let cropped = compare(&pair[0], &pair[1], &options).unwrap();
    let [r, c] = part(&pair, [5, 7], [30, 20]);
    let alone = compare(&r, &c, &CompareOptions::default()).unwrap();
    let (a, b) = (cropped.radiance.unwrap(), alone.radiance.unwrap());
    assert_eq!(
        (a.count, a.max, a.rmse, a.p90),
        (b.count, b.max, b.rmse, b.p90)
    );
    assert_eq!(a.max_at.map(|[x, y]| [x - 5, y - 7]), b.max_at);
}

#[test]
fn a_mask_is_a_crop_where_it_has_its_shape() {
    let [r, c] = light(61, 47);
    let crop = [5, 7, 30, 20];
    let inside = |i: u32| (5..35).contains(&(i % 61)) && (7..27).contains(&(i / 61));
    let mask: Vec<bool> = (0..61 * 47).map(inside).collect();
    let with = |region: Region| {
        let options = CompareOptions {
            region,
            ..CompareOptions::default()
        };
        compare(&r, &c, &options).unwrap()
    };
    let cropped = with(Region {
        crop: Some(crop),
        mask: None,
    });
    let masked = with(Region {
        crop: None,
        mask: Some(mask),
    });
    assert_eq!(cropped, masked);
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    // The light of several tiles.
    let on_three = &CASES[2].1;
    assert!(on_three == &compared_on(1, &light(600, 300)));
}

#[test]
fn limits_on_what_could_not_be_computed_are_exceeded_and_say_why() {
    let n = 16;
    let picture = |object: f64| {
        let event = ["event.ct", "event.x", "event.y", "event.z"].map(|name| (name, vec![0.5; n]));
        let channels = [("object", vec![object; n])].into_iter().chain(event);
        Picture::linear("ids", layers(4, 4, &channels.collect::<Vec<_>>()))
    };
    // All objects are wrong: no place can be compared.
    let found = compare(&picture(0.0), &picture(1.0), &CompareOptions::default()).unwrap();
    let breached = |limits: &[&str]| {
        let limits: Vec<Tolerance> = limits.iter().map(|limit| limit.parse().unwrap()).collect();
        let breaches = found.breaches(&limits).map_err(|error| error.to_string())?;
        Ok::<_, String>(breaches.iter().map(Breach::to_string).collect::<Vec<_>>())
    };
    for (limit, words) in [
        ("geometric.max=1e9", "no pixel shows the same object"),
        ("time.bias=1e9", "no pixel shows the same object"),
        ("w.max=1e9", "needs the channel wavelength_ratio"),
        ("rmse=1e9", "needs the light"),
        (
            "time_bins.p99=1",
            "a width of the bins (`bin_width`) and the channel event.ct in both",
        ),
        ("wrong_objects=15", "wrong_objects is 16"),
        ("coverage=0.01", "coverage is 0, and must be at least 0.01"),
        ("geometric.count=1", "geometric.count is 0"),
        (
            "geometric.unmeasured=0",
            "geometric.unmeasured is 16.00, and may be at most 0",
        ),
        ("event.ct:count=17", "event.ct:count is 16"),
    ] {
        let breaches = breached(&[limit]).unwrap();
        assert!(
            breaches.len() == 1 && breaches[0].contains(words),
            "{limit}: {breaches:?}"
        );
    }
    let kept = [
        "wrong_objects=16",
        "coverage=0",
        "geometric.unmeasured=16",
        "event.x:max=0",
    ];
    assert_eq!(breached(&kept), Ok(vec![]));
    for unknown in [
        "geometric=1",
        "geometric.bias=1",
        "radiance.Q:max=1",
        "object:max=1",
        "flop=1",
    ] {
        assert!(breached(&[unknown]).is_err(), "{unknown}");
    }
}

#[test]
fn mrse_is_finite_where_the_reference_is_near_0_or_below() {
    // r = −0.01 is where the usual r + 0.01 vanishes: with the floor on |r| the term is (0.02/0.02)² = 1.
    let one = |value: f64| Picture::linear("one", layers(1, 1, &[("v", vec![value])]));
    let found = compare(&one(-0.01), &one(0.01), &CompareOptions::default()).unwrap();
    assert!((found.metric("v:mrse").unwrap() - 1.0).abs() < 1e-12);
}

/// Grey is the mean of nothing: its one channel stands for red, green and blue, so that a colour picture of equal channels
/// differs in nothing, and one that is 3 too bright in blue by 3 in a third of its samples.
#[test]
fn a_grey_picture_is_compared_with_one_in_colours() {
    use nullray::io::image::{Channel, Layers, Samples};
    let values: Vec<f64> = (0..12).map(f64::from).collect();
    let channel = |name: &str, more: f64| Channel {
        name: name.into(),
        samples: Samples::F64(values.iter().map(|value| value + more).collect()),
    };
    let picture = |name: &str, channels: Vec<Channel>| {
        Picture::linear(name, Layers::new(4, 3, channels, Vec::new()).unwrap())
    };
    let colours = |blue: f64| {
        let channels = [
            ("radiance.R", 0.0),
            ("radiance.G", 0.0),
            ("radiance.B", blue),
        ];
        picture(
            "colours",
            channels.map(|(name, more)| channel(name, more)).into(),
        )
    };
    let options = CompareOptions::default();
    for name in ["Y", "value"] {
        let grey = picture("grey", vec![channel(name, 0.0)]);
        for [reference, candidate] in [[&grey, &colours(0.0)], [&colours(0.0), &grey]] {
            let compared = compare(reference, candidate, &options).unwrap();
            assert_eq!(compared.radiance.unwrap().mae, 0.0);
            let said = |note: &Message| {
                note.contains("grey is grey: its one channel is compared with red")
            };
            assert!(compared.notes.iter().any(said), "{:?}", compared.notes);
        }
        let compared = compare(&grey, &colours(3.0), &options).unwrap();
        assert!((compared.radiance.unwrap().mae - 1.0).abs() < 1e-12);
    }
    // Two grey ones are compared as they are.
    let grey = || picture("grey", vec![channel("Y", 0.0)]);
    let compared = compare(&grey(), &grey(), &options).unwrap();
    assert!(compared.radiance.is_none() && compared.channels.len() == 1);
}

#[test]
fn exceeded_limits_have_the_digits_of_the_table() {
    let [r, c] = light(8, 8);
    let found = compare(&r, &c, &CompareOptions::default()).unwrap();
    let is = found.metric("rmse").unwrap();
    let words = |limit: f64| {
        let limit = format!("rmse={limit}").parse().unwrap();
        found.breaches(&[limit]).unwrap()[0].to_string()
    };
    let told = words(0.5 * is);
    let digits = told.strip_prefix("rmse is ").unwrap();
    let digits = digits.split(',').next().unwrap();
    assert!(digits.len() <= 7, "{told}");
    // Where these are those of the limit, there are more.
    let told = words(is * (1.0 - 1e-9));
    assert!(told.starts_with(&format!("rmse is {is}, ")), "{told}");
}

#[test]
fn limits_on_indices_are_refused_with_what_counts_them() {
    let [r, c] = light(8, 8);
    let found = compare(&r, &c, &CompareOptions::default()).unwrap();
    let limit = "object:max=0".parse().unwrap();
    let error = found.breaches(&[limit]).unwrap_err();
    assert!(error.help().contains("wrong_objects"), "{error}");
}
