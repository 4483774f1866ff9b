//! Studies of run time against error.

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use nullray::Error;
use nullray::figures::drawing::{Item, svg};
use nullray::render::progress::Silent;
use nullray::scene::model::Scene;
use nullray::scene::{self, Overrides};
use nullray::validate::study::{
    Entry, Family, Study, StudyOptions, Verdict, csv, draw, parse_methods, study, table,
};

/// A cube and a floor, from a camera at 0.9 c, as rasterizers like it least.
const SCENE: &str = r#"
[camera]
eye = [0, 1.4, 3.4]
look_at = [0, 0.5, 0]
hfov = "90 deg"
size = [64, 48]
velocity = { beta = [0, 0, -0.9] }
[display]
back_faces = "two_sided"
[[object]]
name = "floor"
shape = { plane = { size = [8, 8] } }
colour = [0.5, 0.5, 0.5]
[[object]]
name = "cube"
shape = { box = { size = [1, 1, 1] } }
colour = [0.8, 0.3, 0.2]
velocity = { beta = [0.3, 0, 0] }
origin = { position = [-0.4, 0.5, 0], time = "-3 m" }
"#;

fn parsed(text: &str) -> Scene {
    scene::parse(text, "test", Path::new("."), &Overrides::default()).unwrap()
}

fn options(methods: &str) -> StudyOptions {
    StudyOptions {
        methods: parse_methods(methods).unwrap(),
        samples: vec![1, 4],
        runs: 3,
        budget: Duration::from_secs(600),
        reference_samples: 64,
        ..StudyOptions::default()
    }
}

fn studied(methods: &str) -> Study {
    study(&parsed(SCENE), &options(methods), &Silent).unwrap()
}

fn entry<'s>(study: &'s Study, method: &str, samples: u32) -> &'s Entry {
    let is_it = |e: &&Entry| e.method == method && e.samples == samples;
    study.entries.iter().find(is_it).unwrap()
}

#[test]
fn the_ray_tracer_shows_every_point_where_it_should_be() {
    let study = studied("trace");
    let geometry = entry(&study, "trace", 1).geometry;
    assert!(geometry.pixels.max < 1e-9, "{geometry:?}");
    assert_eq!(geometry.emission_time.max, 0.0);
    assert_eq!(geometry.wrong_object, 0);
    assert!(geometry.seen > 100);
}

#[test]
fn the_error_of_vertices_that_are_moved_falls_with_the_square_of_the_edge() {
    let study = studied("raster:uniform=0.4; raster:uniform=0.2; raster:uniform=0.1; raster:none");
    let error = |method| entry(&study, method, 1).geometry.pixels;
    let (coarse, middle, fine) = (
        error("raster:uniform=0.4"),
        error("raster:uniform=0.2"),
        error("raster:uniform=0.1"),
    );
    assert!(error("raster:none").max > 10.0 * coarse.max);
    for ratio in [coarse.median / middle.median, middle.median / fine.median] {
        assert!(
            (2.5..6.5).contains(&ratio),
            "{coarse:?} {middle:?} {fine:?}"
        );
    }
}

#[test]
fn an_adaptive_rasterizer_keeps_to_its_error() {
    let study = studied("raster:adaptive=0.5");
    let error = entry(&study, "raster:adaptive=0.5", 1).geometry.pixels.max;
    assert!(error > 0.0 && error <= 0.5, "{error}");
}

#[test]
fn more_samples_bring_radiance_nearer_to_the_reference() {
    let study = studied("trace");
    let error = |samples| entry(&study, "trace", samples).radiance.unwrap();
    assert!(error(4).relrmse < 0.8 * error(1).relrmse);
    assert!(error(4).mrse < error(1).mrse && error(4).flip < error(1).flip);
}

#[test]
fn methods_take_turns_and_each_has_all_its_runs() {
    let study = studied("trace; raster:none; raster:adaptive=1").entries;
    assert_eq!(study.len(), 6);
    for entry in &study {
        let timing = entry.timing.as_ref().unwrap();
        assert_eq!(timing.runs.len(), 3);
        assert!(timing.setup <= timing.runs.iter().fold(0.0, |a, b| b.max(a)));
        assert!(timing.quartiles[0] <= timing.median && timing.median <= timing.quartiles[1]);
    }
}

#[test]
fn a_budget_of_nothing_measures_nothing_and_says_so() {
    let options = StudyOptions {
        budget: Duration::ZERO,
        ..options("trace")
    };
    let study = study(&parsed(SCENE), &options, &Silent).unwrap();
    assert!(study.was_cut_short);
    assert!(study.entries.iter().all(|e| e.timing.is_none()));
    assert!(table(&study).contains("no time"));
    // Which is no verdict on any method.
    assert!(table(&study).contains("not measured: the budget ended first"));
    assert!(!table(&study).contains("fastest"));
    assert!(svg::write(&draw(&study).unwrap()).is_ok());
}

#[test]
fn the_front_has_no_entry_that_another_beats() {
    let study = studied("trace; raster:none; raster:uniform=0.1; raster:adaptive=0.3");
    let of = |e: &Entry| [e.timing.as_ref().unwrap().median, e.geometry.pixels.max];
    let first: Vec<_> = study.entries.iter().filter(|e| e.samples == 1).collect();
    for a in &first {
        let beaten = first
            .iter()
            .any(|b| of(b)[0] < of(a)[0] && of(b)[1] < of(a)[1]);
        assert_eq!(a.front.geometry, !beaten, "{}", a.method);
    }
    assert!(
        study
            .entries
            .iter()
            .all(|e| e.samples == 1 || !e.front.geometry)
    );
}

#[test]
fn verdicts_name_the_fastest_of_those_that_keep_to_the_error() {
    let study = studied("trace; raster:none; raster:adaptive=0.05");
    let verdicts = study.verdicts.iter();
    assert_eq!(verdicts.len(), 4);
    let is_it = |v: &&Verdict| v.pixels == 0.1 && v.samples == 1;
    let verdict = study.verdicts.iter().find(is_it).unwrap();
    let (method, time) = verdict.raster.clone().unwrap();
    assert_eq!(method, "raster:adaptive=0.05");
    assert_eq!(
        Some(time),
        entry(&study, &method, 1).timing.as_ref().map(|t| t.median)
    );
    let [median, least, most] = verdict.raster_over_trace.unwrap();
    assert!(least <= median && median <= most && least > 0.0);
    assert!(verdict.warp.is_none());
    if let Some(fastest) = &verdict.fastest {
        assert_eq!(fastest == "trace", median > 1.0, "{fastest} {median}");
    }
    let (tree, vertices) = (study.once.tree_seconds, study.once.vertex_seconds);
    assert_eq!(entry(&study, "trace", 1).once_seconds, tree);
    assert_eq!(entry(&study, &method, 1).once_seconds, vertices);
}

#[test]
fn verdicts_judge_the_ray_tracer_in_single_precision_too() {
    let study = studied("trace; trace:fast");
    let verdicts = study.verdicts.iter();
    for verdict in verdicts.filter(|verdict| verdict.samples == 1) {
        let time = |method: &str| {
            let entry = entry(&study, method, 1);
            let fits = entry.geometry.pixels.max <= verdict.pixels;
            entry.timing.as_ref().filter(|_| fits).map(|t| t.median)
        };
        assert_eq!(
            [verdict.trace, verdict.trace_fast],
            ["trace", "trace:fast"].map(time)
        );
        let (Some(trace), Some(fast)) = (verdict.trace, verdict.trace_fast) else {
            panic!("both keep to {} px", verdict.pixels);
        };
        if let Some(fastest) = &verdict.fastest {
            assert_eq!(fastest == "trace", trace < fast, "{fastest} {trace} {fast}");
        }
    }
}

#[test]
fn the_table_for_spreadsheets_has_a_line_for_each_entry_and_a_field_for_each_column() {
    let study = studied("trace; raster:none,attributes=vertex");
    let text = csv(&study);
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(lines.len(), 1 + study.entries.len());
    let columns = lines[0].split(',').count();
    // The name of a method may hold a comma; it stands in quotes.
    let fields = |line: &str| line.rsplit_once('"').unwrap().1.split(',').count();
    assert!(lines[1..].iter().all(|line| fields(line) == columns));
}

#[test]
fn the_drawing_has_a_mark_for_each_result_and_the_ray_tracer_in_it() {
    let study = studied("trace; raster:none; raster:uniform=0.2");
    let drawing = draw(&study).unwrap();
    let filled = |item: &&Item| matches!(item, Item::Path { fill: Some(_), .. });
    // One of geometry for each method, one of radiance for each entry, one in the legend for each family.
    assert_eq!(drawing.items.iter().filter(filled).count(), 3 + 6 + 3);
    assert!(study.entries.iter().any(|e| e.family == Family::Trace));
}

#[test]
fn a_method_that_cannot_render_the_scene_is_left_out_by_name_and_refused_alone() {
    let both = studied("trace; warp:cube=32");
    assert!(both.entries.iter().all(|e| e.family == Family::Trace));
    assert_eq!(both.left_out[0].method, "warp:cube=32");
    assert!(table(&both).contains("warp:cube=32 was left out"));
    let alone = study(&parsed(SCENE), &options("warp:cube=32"), &Silent).map(|_| ());
    assert!(alone.is_err_and(|e| e.to_string().contains("cube")));
}

#[test]
fn a_camera_without_exact_film_points_is_refused() {
    let sensor = SCENE.replace(
        "[display]",
        "sensor = { focal_length = \"36 mm\", width = \"24 mm\" }\n[display]",
    );
    let sensor = sensor.replace("hfov = \"90 deg\"\n", "");
    let refused = study(&parsed(&sensor), &options("trace"), &Silent).map(|_| ());
    assert!(matches!(refused, Err(Error::Unsupported(_))), "{refused:?}");
}

#[test]
fn a_study_that_is_stopped_ends() {
    let stopped = study(&parsed(SCENE), &options("trace"), &AtomicBool::new(true));
    assert!(matches!(stopped, Err(Error::Cancelled)));
}

#[test]
fn a_study_that_does_not_fit_beside_the_program_is_refused_before_it_begins() {
    let options = |program| StudyOptions {
        memory_limit: 256 << 20,
        program,
        budget: Duration::ZERO,
        ..options("trace")
    };
    assert!(study(&parsed(SCENE), &options(0), &Silent).is_ok());
    let error = study(&parsed(SCENE), &options(220 << 20), &Silent).unwrap_err();
    assert!(error.to_string().contains("more than the limit"), "{error}");
}

#[test]
fn memory_is_that_of_what_holds_the_picture_whatever_was_measured_before() {
    let methods = ["trace", "raster:none", "raster:uniform=0.1"];
    let [there, back] = [
        methods.join(";"),
        methods
            .map(String::from)
            .into_iter()
            .rev()
            .collect::<Vec<_>>()
            .join(";"),
    ]
    .map(|methods| studied(&methods));
    // Three numbers of eight bytes for each pixel.
    let film = 64 * 48 * 3 * 8;
    assert_eq!(entry(&there, "trace", 1).memory, Some(film));
    assert_eq!(entry(&there, "trace", 4).memory, Some(film));
    for method in methods {
        let memory = |study| entry(study, method, 1).memory.unwrap();
        assert_eq!(memory(&there), memory(&back), "{method}");
    }
    // 12 triangles of a cube and 2 of a floor, and those that these are cut into.
    let [none, cut] =
        ["raster:none", "raster:uniform=0.1"].map(|m| entry(&there, m, 1).memory.unwrap() - film);
    assert!((1000..20_000).contains(&none), "{none}");
    assert!(cut > 20 * none, "{none} {cut}");
    assert_eq!(entry(&there, "trace", 1).once_bytes, there.once.tree_bytes);
    // 8 + 4 vertices of 32 bytes, and 14 triples of indices.
    assert_eq!(there.once.vertex_bytes, 12 * 32 + 14 * 12);
    assert_eq!(
        entry(&there, "raster:none", 4).once_bytes,
        there.once.vertex_bytes
    );
    assert!(table(&there).contains("once MB"));
    assert!(csv(&there).lines().next().unwrap().contains("once_bytes"));
}

#[test]
fn one_run_names_no_fastest_method() {
    let options = StudyOptions {
        runs: 1,
        ..options("trace; raster:adaptive=0.05")
    };
    let study = study(&parsed(SCENE), &options, &Silent).unwrap();
    let is_it = |v: &&Verdict| v.pixels == 0.1 && v.samples == 1;
    let verdict = study.verdicts.iter().find(is_it).unwrap();
    assert_eq!((verdict.runs, &verdict.fastest), (1, &None));
    let table = table(&study);
    assert!(table.contains("one run has no spread"), "{table}");
    assert!(table.contains("times that in one run"), "{table}");
    assert!(!table.contains("quartiles"), "{table}");
}
