//! Pictures of retarded time.

use nullray::figures::isochrones::{
    FLASH_NEEDS, IsochroneOptions, draw, draw_radiance, flash_times,
};
use nullray::io::image::RgbImage;

/// A sphere of radius 1 in front of a wall, seen from the origin along −z: ct = −distance.
fn sphere_and_wall(width: u32, height: u32) -> Vec<f64> {
    let pixel = |i: u32| {
        let (x, y) = (f64::from(i % width) + 0.5, f64::from(i / width) + 0.5);
        let scale = 1.4 / f64::from(width);
        let u = (x - f64::from(width) / 2.0) * scale;
        let v = (f64::from(height) / 2.0 - y) * scale;
        let length = (u * u + v * v + 1.0).sqrt();
        // |s d − centre|² = 1 with the centre at (0.4, 0.2, −4).
        let b = (0.4 * u + 0.2 * v + 4.0) / length;
        let under = b * b - (0.16 + 0.04 + 16.0) + 1.0;
        let wall = 6.0 * length;
        match (under > 0.0, v > 0.55) {
            (true, _) => -(b - under.sqrt()),
            (false, true) => f64::NAN,
            (false, false) => -wall,
        }
    };
    (0..width * height).map(pixel).collect()
}

fn pixel(image: &RgbImage, x: u32, y: u32) -> [u8; 3] {
    let i = 3 * (y * image.width + x) as usize;
    [image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]]
}

/// For looking at: NULLRAY_TEST_PICTURES names a directory.
fn save(name: &str, image: &RgbImage) {
    if let Some(directory) = std::env::var_os("NULLRAY_TEST_PICTURES") {
        let path = std::path::Path::new(&directory).join(name);
        nullray::io::image::png::write(&path, image.width, image.height, &image.rgb, &[]).unwrap();
    }
}

#[test]
fn near_is_late_and_bright_and_far_is_early_and_dark() {
    let (w, h) = (640, 480);
    let image = draw(w, h, &sphere_and_wall(w, h), &IsochroneOptions::default()).unwrap();
    save("sphere.png", &image);
    let luminance = |x, y| {
        pixel(&image, x, y)
            .iter()
            .map(|&c| u32::from(c))
            .sum::<u32>()
    };
    // The sphere's centre is a little right of and above the picture's.
    assert!(luminance(420, 300) > luminance(60, 500) + 100);
}

#[test]
fn every_size_gives_a_page_that_holds_picture_and_legend() {
    for (w, h) in [
        (1, 1),
        (2, 1),
        (16, 9),
        (64, 64),
        (33, 200),
        (1200, 60),
        (300, 300),
    ] {
        let ct: Vec<f64> = (0..w * h).map(|i| f64::from(i % w) * 0.01).collect();
        let image = draw(w, h, &ct, &IsochroneOptions::default()).unwrap();
        save(&format!("size_{w}x{h}.png"), &image);
        assert!(image.width > w && image.height > h);
        assert!(image.width >= 200 && image.height >= 200, "{w} × {h}");
        assert_eq!(image.rgb.len() as u32, 3 * image.width * image.height);
    }
}

#[test]
fn an_endless_floor_leaves_the_near_part_readable() {
    let (w, h) = (480, 360);
    let floor = |i: u32| {
        let y = f64::from(i / w) + 0.5 - 120.0;
        let x = (f64::from(i % w) + 0.5 - 240.0) / 300.0;
        let depth = 300.0 / y;
        if y > 0.0 {
            10.0 - depth * (1.0 + x * x + (y / 300.0) * (y / 300.0)).sqrt()
        } else {
            f64::NAN
        }
    };
    let ct: Vec<f64> = (0..w * h).map(floor).collect();
    let image = draw(w, h, &ct, &IsochroneOptions::default()).unwrap();
    save("floor.png", &image);
    // Rows 150–170 and 330–350, at depths of 8 and 1.4: on a scale to the horizon (depth 600) both
    // would be of one yellow, red 240 or so.
    let red = |row: u32| u32::from(pixel(&image, 30, 48 + row)[0]);
    let mean = |rows: std::ops::Range<u32>| rows.map(red).sum::<u32>() / 20;
    let (far, near) = (mean(150..170), mean(330..350));
    assert!(near > far + 60, "{far} {near}");
}

#[test]
fn an_empty_picture_is_grey_and_has_no_legend() {
    let image = draw(
        200,
        200,
        &vec![f64::NAN; 40_000],
        &IsochroneOptions::default(),
    )
    .unwrap();
    save("nothing.png", &image);
    let (x, y) = (image.width / 2, image.height / 2);
    assert_eq!(pixel(&image, x, y), [232; 3]);
}

#[test]
fn hostile_values_are_drawn_or_refused_but_do_not_panic() {
    let values = [
        0.0,
        -0.0,
        1e308,
        -1e308,
        f64::MAX,
        f64::MIN,
        f64::MIN_POSITIVE,
        1e-320,
    ];
    for a in values {
        for b in values {
            for step in [None, Some(1e-3), Some(1e300), Some(f64::MIN_POSITIVE)] {
                let ct = [a, b, f64::NAN, a, b, a, f64::INFINITY, b, a];
                let options = IsochroneOptions {
                    step,
                    ..IsochroneOptions::default()
                };
                let _ = draw(3, 3, &ct, &options);
            }
        }
    }
}

#[test]
fn impossible_requests_are_refused_with_a_reason() {
    let refused =
        |ct: &[f64], options: IsochroneOptions| draw(2, 2, ct, &options).unwrap_err().to_string();
    let options = IsochroneOptions::default;
    let ct = [0.0, 1.0, 2.0, 3.0];
    assert!(refused(&ct[..3], options()).contains("3 values for 2 × 2"));
    for step in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refusal = refused(
            &ct,
            IsochroneOptions {
                step: Some(step),
                ..options()
            },
        );
        assert!(refusal.contains("step"), "{refusal}");
    }
    let refusal = refused(
        &ct,
        IsochroneOptions {
            step: Some(1e-4),
            ..options()
        },
    );
    assert!(refusal.contains("30001 isochrones"), "{refusal}");
    let refusal = refused(
        &ct,
        IsochroneOptions {
            speed_of_light: 0.0,
            ..options()
        },
    );
    assert!(refusal.contains("speed of light"), "{refusal}");
    let refusal = refused(
        &ct,
        IsochroneOptions {
            title: "⌘".into(),
            ..options()
        },
    );
    assert!(refusal.contains("U+2318"), "{refusal}");
}

#[test]
fn one_range_gives_pictures_of_other_times_the_same_colours() {
    // Times of 2 m in the one picture, of 2 m and 8 m in the other: on their own scales 2 m has different colours.
    let [width, height] = [40, 40];
    let flat = vec![2.0; 1600];
    let steps: Vec<f64> = (0..1600)
        .map(|i| if i % 40 < 20 { 2.0 } else { 8.0 })
        .collect();
    let colour = |ct: &[f64], range: Option<[f64; 2]>| {
        let options = IsochroneOptions {
            range,
            ..IsochroneOptions::default()
        };
        let page = draw(width, height, ct, &options).unwrap();
        // A point of the left part, some way below the title.
        let at = 3 * ((page.height / 2) * page.width + page.width / 8) as usize;
        page.rgb[at..at + 3].to_vec()
    };
    assert_ne!(colour(&flat, None), colour(&steps, None));
    let range = Some([0.3, 10.3]);
    assert_eq!(colour(&flat, range), colour(&steps, range));
    let backwards = IsochroneOptions {
        range: Some([3.0, 3.0]),
        ..IsochroneOptions::default()
    };
    assert!(draw(width, height, &flat, &backwards).is_err());
}

#[test]
fn pictures_of_luminance_on_one_scale_have_one_colour_for_one_luminance() {
    // Grey of luminance 1 on the left; on the right a tenth of that in one picture, a hundred times that in the other.
    let drawn = |right: f64, range: Option<[f64; 2]>| {
        let grey = |i: u32| [if i % 80 < 40 { 1.0 } else { right }; 3];
        let pixels: Vec<[f64; 3]> = (0..80 * 60).map(grey).collect();
        draw_radiance(80, 60, &pixels, "Luminance", range).unwrap()
    };
    let left = |image: &RgbImage| pixel(image, image.width / 6, image.height / 3);
    let one_scale = Some([1e-2, 1e3]);
    let (dark, bright) = (drawn(0.1, one_scale), drawn(100.0, one_scale));
    assert_eq!(left(&dark), left(&bright));
    assert_ne!(left(&drawn(0.1, None)), left(&drawn(100.0, None)));
    assert!(draw_radiance(1, 1, &[[1.0; 3]], "", Some([2.0, 1.0])).is_err());
}

#[test]
fn times_of_a_flash_are_its_ways_by_the_metre_on_all_three_clocks() {
    // Straight down on a floor from 3 m above (0.5, 0, −0.25): columns go along x, rows along z.
    let scene = |clock: &str| {
        let text = format!(
            "camera = {{ eye = [0.5, 3, -0.25], look_at = [0.5, 0, -0.25], up = [0, 0, -1], hfov = \"90 deg\", size = [6, 4], \
             clock_zero = \"10 m\", time = \"4 m\" }}\n\
             object = [{{ shape = {{ plane = {{ size = [9, 2.2] }} }}, transform = {{ translate = [0, 0, -1] }} }}]\n\
             medium.index = 1.5\n\
             display.isochrones = {{ flash = [-1, 2, 0.5], time = \"7 m\", {clock} }}"
        );
        nullray::scene::parse(&text, "test", ".".as_ref(), &Default::default()).unwrap()
    };
    let length =
        |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
    for (clock, receiver, zero) in [
        ("clock = \"world\"", None, 0.0),
        ("clock = [2, 1, 4]", Some([2.0, 1.0, 4.0]), 0.0),
        ("clock = \"camera\"", Some([0.5, 3.0, -0.25]), 10.0),
    ] {
        let scene = scene(clock);
        let request = nullray::render::plan::Request {
            aovs: FLASH_NEEDS.to_vec(),
            pixel_centers: true,
            ..Default::default()
        };
        let plan = nullray::render::plan::Plan::new(&scene, &request).unwrap();
        let silent = &nullray::render::progress::Silent;
        let prepared = nullray::render::prepare::Prepared::new(&scene, &plan, silent).unwrap();
        let film = nullray::render::render(&prepared, silent).unwrap();
        let times = flash_times(&film, &scene.flash_times.unwrap(), scene.medium_index);
        let mut seen = 0;
        for (k, time) in times.into_iter().enumerate() {
            // A pixel is 1 m wide on the floor.
            let [i, j] = [k / 6, k % 6].map(|n| n as f64 + 0.5);
            let at = [0.5 + (j - 3.0), 0.0, -0.25 + (i - 2.0)];
            if at[2] > 0.1 || at[2] < -2.1 {
                assert!(time.is_nan(), "{at:?}");
                continue;
            }
            seen += 1;
            let way = length(at, [-1.0, 2.0, 0.5]) + receiver.map_or(0.0, |eye| length(at, eye));
            let expected = 7.0 + 1.5 * way - zero;
            assert!(
                (time - expected).abs() < 1e-9,
                "{clock} {at:?}: {time} {expected}"
            );
        }
        assert_eq!(seen, 12);
    }
}

#[test]
fn times_of_a_flash_are_refused_of_what_moves() {
    let parse = |camera: &str, object: &str| {
        let text = format!(
            "camera = {{ eye = [0, 0, 5], look_at = [0, 0, 0] {camera} }}\n\
             object = [{{ name = \"crate\", shape = {{ box = {{ size = [1, 1, 1] }} }} {object} }}]\n\
             display.isochrones = {{ flash = [0, 2, 0], clock = \"camera\" }}"
        );
        nullray::scene::parse(&text, "test", ".".as_ref(), &Default::default())
    };
    assert!(parse("", "").is_ok());
    for (camera, object, said) in [
        (
            ", velocity = { beta = [0.1, 0, 0] }",
            "",
            "camera with one pinhole at rest",
        ),
        (
            ", stereo = { interpupillary_distance = \"6 cm\" }",
            "",
            "camera with one pinhole at rest",
        ),
        (
            "",
            ", velocity = { beta = [0.1, 0, 0] }",
            "but \"crate\" moves",
        ),
    ] {
        let error = parse(camera, object).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
}
