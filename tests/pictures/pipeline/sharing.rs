//! Scenes that share what is loaded.

use std::fs;

use nullray::Error;
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::{LoadedCubes, Prepared};
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::model::Scene;

use super::files::npy;
use super::stage::{self, scene_in};

/// A wall that a cube in `folder` lights, or none, seen with `camera` keys.
fn wall(folder: &std::path::Path, camera: &str, with_cube: bool) -> Scene {
    let source = "[[source]]\ncube = { file = \"light.npy\", start = \"0 m\", bin_width = \"1 m\", clock = \"world\", uv = 0 }\n";
    let text = format!(
        "[camera]\neye = [0.2, 0.1, 3]\nlook_at = [0, 0, 0]\n{camera}\n[display]\nsamples_per_pixel = 3\nback_faces = \"two_sided\"\n\
         [[object]]\nname = \"wall\"\nshape = {{ box = {{ size = [2, 2, 0.1] }} }}\n{}",
        if with_cube { source } else { "" }
    );
    scene_in(folder, &text)
}

fn plan(scene: &Scene) -> Plan {
    Plan::new(scene, &Request::default()).unwrap()
}

/// Light that still grows when it ends, which is worth a remark.
fn light(folder: &std::path::Path) -> std::path::PathBuf {
    let file = folder.join("light.npy");
    npy(&file, &[4, 4, 16], (0..256).map(|k| f64::from(k % 16)));
    file
}

fn bits(film: &Film) -> Vec<[u64; 3]> {
    let radiance = film.radiance().iter();
    radiance.map(|pixel| pixel.map(f64::to_bits)).collect()
}

#[test]
fn a_cube_is_loaded_once_for_scenes_that_show_it_one_after_the_other() {
    let folder = tempfile::tempdir().unwrap();
    let file = light(folder.path());
    let [first, second] = [
        "size = [24, 18]\ntime = \"4 m\"",
        "size = [24, 18]\ntime = \"6 m\"\nhfov = \"30 deg\"",
    ]
    .map(|camera| wall(folder.path(), camera, true));
    let without = wall(folder.path(), "", false);
    // A plan reads the head of the file.
    let plans = [&first, &second, &without].map(plan);
    let alone = Prepared::new(&second, &plans[1], &Silent).unwrap();
    assert!(!alone.warnings.is_empty());
    let mut cubes = LoadedCubes::default();
    let mut share = |scene: &Scene, plan| Prepared::sharing(scene, plan, &mut cubes, &Silent);
    share(&first, &plans[0]).unwrap();
    // It is in memory now.
    fs::remove_file(&file).unwrap();
    let shared = share(&second, &plans[1]).unwrap();
    assert_eq!(shared.warnings, alone.warnings);
    let film = render(&shared, &Silent).unwrap();
    assert_eq!(bits(&film), bits(&render(&alone, &Silent).unwrap()));
    // A scene without it needs the memory for its own.
    share(&without, &plans[2]).unwrap();
    assert!(matches!(share(&second, &plans[1]), Err(Error::Io { .. })));
}

#[test]
fn pictures_of_other_sizes_and_samples_need_no_other_preparation() {
    let folder = tempfile::tempdir().unwrap();
    light(folder.path());
    let large = wall(folder.path(), "time = \"4 m\"\nsize = [60, 40]", true);
    let small = wall(folder.path(), "time = \"5 m\"\nsize = [15, 10]", true);
    let centres = Plan::new(&small, &stage::centred()).unwrap();
    let mut prepared = Prepared::new(
        &large,
        &Plan::new(&large, &stage::centred()).unwrap(),
        &Silent,
    )
    .unwrap();
    for (scene, plan) in [(&small, &centres), (&large, &plan(&large))] {
        prepared.retake_on_film(scene, plan).unwrap();
        let own = render(&Prepared::new(scene, plan, &Silent).unwrap(), &Silent).unwrap();
        let film = render(&prepared, &Silent).unwrap();
        assert_eq!(film.size(), own.size());
        assert_eq!(bits(&film), bits(&own));
    }
}

#[test]
fn stars_are_as_wide_as_pixels_of_the_camera_in_use() {
    let wide = "[camera]\neye = [0, 0, 0]\nlook_at = [0, 0, -1]\nsize = [96, 64]\nhfov = \"60 deg\"\n\
                [sky]\nradiance = 0\nsun = { direction = [0.01, 0, -1], diameter = \"0.05 deg\", irradiance = 1 }\n\
                stars = { count = 3000, diameter = \"0.05 deg\" }\n";
    let narrow = wide
        .replace("60 deg", "2 deg")
        .replace("[96, 64]", "[192, 128]");
    let [wide, narrow] = [wide, &narrow].map(stage::scene);
    let mut prepared = Prepared::new(&wide, &plan(&wide), &Silent).unwrap();
    let own = render(
        &Prepared::new(&narrow, &plan(&narrow), &Silent).unwrap(),
        &Silent,
    );
    prepared.retake_on_film(&narrow, &plan(&narrow)).unwrap();
    assert_eq!(
        bits(&render(&prepared, &Silent).unwrap()),
        bits(&own.unwrap())
    );
}

#[test]
fn another_picture_of_what_was_not_prepared_is_refused() {
    let text = |camera: &str, object: &str, more: &str| {
        format!(
            "{more}[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nsize = [32, 24]\n{camera}\n\
             [[object]]\nname = \"q\"\nshape = {{ box = {{ size = [1, 1, 1] }} }}\n{object}"
        )
    };
    let scene = stage::scene(&text("", "", ""));
    let mut prepared = Prepared::new(&scene, &plan(&scene), &Silent).unwrap();
    let before = bits(&render(&prepared, &Silent).unwrap());
    let wide = text("", "", "").replace("[32, 24]", "[64, 24]");
    let second =
        text("", "", "") + "[[object]]\nname = \"r\"\nshape = { box = { size = [1, 1, 1] } }\n";
    let cases = [
        (wide, "camera.size", "64 × 24"),
        (
            text("", "velocity = { beta = [0.5, 0, 0] }\n", ""),
            "object[0]",
            "\"q\" differs",
        ),
        (
            text("", "origin = { position = [1, 0, 0] }\n", ""),
            "object[0]",
            "\"q\" differs",
        ),
        (
            text("", "transform = { translate = [1, 0, 0] }\n", ""),
            "object[0]",
            "\"q\" differs",
        ),
        (second, "object", "2 objects, but 1"),
        (
            text("", "", "medium = { index = 1.5 }\n"),
            "medium_index",
            "medium",
        ),
        (
            text("", "", "effects = { doppler = false }\n"),
            "effects",
            "effects",
        ),
    ];
    for (text, place, what) in cases {
        let other = stage::scene(&text);
        let Err(Error::Invalid(problem)) = prepared.retake(&other) else {
            panic!("{place} is not refused")
        };
        assert_eq!(problem.place.to_string(), place);
        assert!(problem.what.contains(what), "{}", &*problem.what);
        assert!(problem.help.contains("Prepared::"), "{}", &*problem.help);
        // Its own film makes up for another size alone.
        let own = prepared.retake_on_film(&other, &plan(&other));
        assert_eq!(own.is_ok(), place == "camera.size");
        prepared.retake_on_film(&scene, &plan(&scene)).unwrap();
    }
    // A plan of one size is none for a scene of another.
    let wide = stage::scene(&text("", "", "").replace("[32, 24]", "[64, 24]"));
    assert!(prepared.retake_on_film(&wide, &plan(&scene)).is_err());
    // After all refusals it is as it was, and another camera is another picture.
    assert_eq!(bits(&render(&prepared, &Silent).unwrap()), before);
    let moved = stage::scene(&text("velocity = { beta = [0, 0.3, 0] }", "", ""));
    prepared.retake(&moved).unwrap();
    assert_ne!(bits(&render(&prepared, &Silent).unwrap()), before);
}
