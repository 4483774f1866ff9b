//! Scenes that share what is loaded.

use std::fs;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;
use nullray::Error;
use nullray::render::film::{Film, Tile};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::{LoadedCubes, Prepared};
use nullray::render::progress::{Progress, Silent};
use nullray::render::{render, render_tiles};
use nullray::scene::model::{LightKind, Motion, Scene};
use nullray::spacetime::Velocity;

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
            "differs from the scene",
        ),
        (
            text("", "", "effects = { doppler = false }\n"),
            "effects",
            "differs from the scene",
        ),
        (
            text("", "", "model = \"paper2015\"\n"),
            "equations",
            "differs from the scene",
        ),
        (
            text("", "[display]\nbackground = [1, 0, 0]\n", ""),
            "background",
            "differs from the scene",
        ),
        (
            text("", "", "radiance = { quantity = \"photons\" }\n"),
            "quantity",
            "differs from the scene",
        ),
        (
            text("", "", "render = { bounces = 2 }\n"),
            "bounces",
            "differs from the scene",
        ),
        (
            text("", "[display]\nback_faces = \"culled\"\n", ""),
            "back_faces",
            "differs from the scene",
        ),
        (
            text("", "[display]\nsamples_per_pixel = 9\n", ""),
            "samples_per_pixel",
            "9 samples",
        ),
        (
            text("", "[[light]]\nposition = [0, 3, 0]\n", ""),
            "light",
            "differs from the scene",
        ),
        (text("", "[sky]\n", ""), "sky", "differs from the scene"),
        (
            text(
                "",
                "[[source]]\npulse = { position = [0, 2, 0], sigma = \"5 cm\" }\n",
                "",
            ),
            "source",
            "differs from the scene",
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
        let is_of_film = ["camera.size", "samples_per_pixel"].contains(&place);
        assert_eq!(own.is_ok(), is_of_film, "{place}");
        // Nor is the plan of one scene carried out for another.
        if place != "samples_per_pixel" {
            let planned = Prepared::new(&other, &plan(&scene), &Silent);
            let said = planned.unwrap_err().to_string();
            assert!(said.contains(what), "{said}");
        }
        prepared.retake_on_film(&scene, &plan(&scene)).unwrap();
    }
    // A plan of one size is none for a scene of another.
    let wide = stage::scene(&text("", "", "").replace("[32, 24]", "[64, 24]"));
    assert!(prepared.retake_on_film(&wide, &plan(&scene)).is_err());
    // After all refusals it is as it was, and another camera is another picture.
    assert_eq!(bits(&render(&prepared, &Silent).unwrap()), before);
    let mut moved = stage::scene(&text("velocity = { beta = [0, 0.3, 0] }", "", ""));
    prepared.retake(&moved).unwrap();
    assert_ne!(bits(&render(&prepared, &Silent).unwrap()), before);
    // So are other random numbers.
    moved.seed = 7;
    prepared.retake(&moved).unwrap();
    let own = Prepared::new(&moved, &plan(&moved), &Silent).unwrap();
    let films = [&prepared, &own].map(|prepared| bits(&render(prepared, &Silent).unwrap()));
    assert_eq!(films[0], films[1]);
    // A camera that no scene file can contain.
    for fov in [0.0, f64::NAN, 7.0] {
        moved.camera.horizontal_fov = fov;
        let said = prepared.retake(&moved).unwrap_err().to_string();
        assert!(said.contains("camera.horizontal_fov"), "{said}");
    }
}

#[test]
fn light_of_a_lamp_that_accelerates_has_the_same_bits_whichever_frame_was_first() {
    let at = |time: &str| {
        stage::scene(&format!(
            "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nsize = [32, 24]\ntime = \"{time} m\"\n\
             [[object]]\nshape = {{ sphere = {{ radius = 1.5, subdivisions = 3 }} }}\n\
             [[light]]\nposition = [2, 3, 4]\nmotion = {{ circle = {{ centre = [0, 3, 4], axis = [0, 1, 0], rate = \"0.3 rad/m\" }} }}\n"
        ))
    };
    let frames = ["-250", "0", "6", "1000"].map(at);
    let mut prepared = Prepared::new(&frames[0], &plan(&frames[0]), &Silent).unwrap();
    for frame in &frames {
        prepared.retake(frame).unwrap();
        let own = Prepared::new(frame, &plan(frame), &Silent).unwrap();
        let films = [&prepared, &own].map(|prepared| bits(&render(prepared, &Silent).unwrap()));
        assert!(films[0] == films[1], "{} m", frame.camera.time);
        assert!(films[0].iter().flatten().any(|x| *x != 0));
    }
}

#[test]
fn a_lamp_that_a_program_moves_lights_as_one_that_the_file_has_there() {
    let with = |light: &str| {
        stage::scene(&format!(
            "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nsize = [32, 24]\ntime = \"10 m\"\n\
             [[object]]\nshape = {{ sphere = {{ radius = 1.5 }} }}\n[[light]]\n{light}"
        ))
    };
    let mut moved = with("position = [0, 4, 0]");
    let LightKind::Lamp(lamp) = &mut moved.lights[0].kind else {
        unreachable!()
    };
    lamp.origin.x.x = 3.0;
    lamp.velocity = Velocity::from_beta(DVec3::new(0.5, 0.0, 0.0)).unwrap();
    lamp.motion = Motion::Accelerated(DVec3::new(0.0, 0.2, 0.0));
    let file = with(
        "position = [3, 4, 0]\nvelocity = { beta = [0.5, 0, 0] }\n\
         motion = { acceleration = { proper = \"0.2 /m\", direction = [0, 1, 0] } }",
    );
    let films = [&moved, &file].map(|scene| {
        render(
            &Prepared::new(scene, &plan(scene), &Silent).unwrap(),
            &Silent,
        )
        .unwrap()
    });
    let [moved, file] = films.each_ref().map(|film| film.radiance().as_flattened());
    assert!(file.iter().any(|x| *x > 0.0));
    for (a, b) in moved.iter().zip(file) {
        assert!((a - b).abs() <= 1e-12 * b, "{a} {b}");
    }
}

/// Counts the questions whether to stop, and says yes to one of them.
struct Asked {
    count: AtomicU64,
    last: u64,
}

impl Progress for Asked {
    fn is_cancelled(&self) -> bool {
        self.count.fetch_add(1, Ordering::Relaxed) == self.last
    }
}

#[test]
fn preparing_can_be_stopped_at_every_step_of_a_tree() {
    let scene = stage::scene(
        "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nsize = [8, 8]\n\
         [[object]]\nshape = { sphere = { radius = 1, subdivisions = 4 } }\n",
    );
    let request = Request {
        pictures: 1 << 20,
        ..Request::default()
    };
    let plan = Plan::new(&scene, &request).unwrap();
    let asked = |last| Asked {
        count: AtomicU64::new(0),
        last,
    };
    let all = asked(u64::MAX);
    Prepared::new(&scene, &plan, &all).unwrap();
    let count = all.count.into_inner();
    // Clusters in about ten passes at least, and 16 passes of better places.
    assert!(count > 25, "{count}");
    for last in 0..count {
        let stopped = Prepared::new(&scene, &plan, &asked(last));
        assert!(matches!(stopped, Err(Error::Cancelled)), "{last}");
    }
}

#[test]
fn tiles_and_films_that_no_image_has_are_refused() {
    let scene = stage::scene(
        "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nsize = [40, 20]\n\
         [[object]]\nshape = { box = { size = [1, 1, 1] } }\n",
    );
    let mut plan = plan(&scene);
    let mut prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    render_tiles(&prepared, 2..6, &Silent).unwrap();
    let said = render_tiles(&prepared, 2..7, &Silent)
        .unwrap_err()
        .to_string();
    assert!(said.contains("tiles 2 to 7 of 6"), "{said}");
    for size in [[0, 0], [u32::MAX, u32::MAX]] {
        prepared.layout.size = size;
        let said = render(&prepared, &Silent).unwrap_err().to_string();
        assert!(said.contains("film, layout: an image of"), "{said}");
    }
    assert_eq!(Tile::of_image([0, 0], 0).pixels(), 0);
    assert_eq!(Tile::of_image([40, 20], u64::MAX).pixels(), 0);
    plan.frames[0].objects = vec![7];
    assert!(Prepared::new(&scene, &plan, &Silent).is_err());
}
