//! `--stats`, `--stats-json` and `--precision`.

use nullray::io::image::exr;
use serde_json::Value;

use super::Folder;

fn json(folder: &Folder, name: &str) -> Value {
    serde_json::from_slice(&folder.read(name)).unwrap()
}

#[test]
fn the_table_says_what_was_traced_and_how_long_each_stage_took() {
    let folder = Folder::new();
    let said = folder.ok(&["render", "scene.toml", "--stats"]);
    for part in [
        "  pictures                      1\n",
        "  camera rays                   3,072\n",
        // One per rest frame that a ray may meet: of 6,144 all, of which some 2,800 are outside the cone of the body that moves.
        "  visibility: rays              3,323\n",
        "  shadows: rays ",
        "  visibility: exact fall-backs ",
        "  hits and lookups ",
        " ns per ray\n",
    ] {
        assert!(said.contains(part), "{part:?} in {said}");
    }
}

#[test]
fn the_same_numbers_are_written_as_json() {
    let folder = Folder::new();
    folder.ok(&["render", "scene.toml", "-q", "--stats-json", "cost.json"]);
    let cost = json(&folder, "cost.json");
    assert_eq!(cost["camera_rays"], 32 * 24 * 4);
    assert_eq!(cost["visibility"]["rays"], 3323);
    assert!(cost["visibility"]["triangle_tests"].as_u64() > Some(0));
    assert!(cost["camera_rays_hit"].as_u64() < Some(32 * 24 * 4));
    let seconds = |key: &str| cost["seconds"][key].as_f64().unwrap();
    let parts = seconds("load") + seconds("build") + seconds("render");
    assert!((parts - seconds("total")).abs() < 1e-12);
    let stages = cost["stages"].as_object().unwrap();
    assert_eq!(stages.len(), 5);
    let sum = |key: &str| -> f64 { stages.values().map(|s| s[key].as_f64().unwrap()).sum() };
    assert!((sum("share") - 1.0).abs() < 1e-12, "{cost}");
    let rays = cost["camera_rays"].as_f64().unwrap();
    assert!((sum("ns_per_ray") * rays / (1e9 * sum("seconds")) - 1.0).abs() < 1e-12);
    let spent = |stage: &serde_json::Value| stage["seconds"].as_f64() > Some(0.0);
    assert!(stages.values().all(spent), "{cost}");
}

#[test]
fn a_picture_does_not_depend_on_whether_its_cost_is_counted() {
    let folder = Folder::new();
    folder.ok(&["render", "scene.toml", "-o", "plain.npz"]);
    folder.ok(&["render", "scene.toml", "-o", "counted.npz", "--stats"]);
    assert_eq!(folder.read("plain.npz"), folder.read("counted.npz"));
}

#[test]
fn the_cost_of_a_sequence_is_that_of_all_its_frames() {
    let folder = Folder::new();
    folder.ok(&[
        "render",
        "scene.toml",
        "-q",
        "--frames",
        "0..3",
        "--interval",
        "1 cm",
        "-o",
        "f-#.npz",
        "--stats-json",
        "cost.json",
    ]);
    let cost = json(&folder, "cost.json");
    assert_eq!(cost["pictures"], 3);
    assert_eq!(cost["camera_rays"], 3 * 32 * 24 * 4);
}

#[test]
fn statistics_are_not_printed_quietly() {
    let folder = Folder::new();
    let run = folder.run(&["render", "scene.toml", "--stats", "--quiet"]);
    assert_eq!(run.code, 2, "{}", run.stderr);
    assert_eq!(folder.names(), ["scene.toml"]);
}

#[test]
fn statistics_are_not_written_over_the_scene() {
    let folder = Folder::new();
    let run = folder.run(&["render", "scene.toml", "--stats-json", "scene.toml"]);
    assert_eq!(run.code, 2);
    assert!(
        run.message().contains("--stats-json scene.toml"),
        "{}",
        run.stderr
    );
    assert_eq!(folder.names(), ["scene.toml"]);
}

#[test]
fn a_picture_says_how_precise_its_visibility_is() {
    let folder = Folder::new();
    folder.ok(&["render", "scene.toml", "-o", "a.exr"]);
    folder.ok(&["render", "scene.toml", "-o", "b.exr", "--precision", "fast"]);
    for (name, precision) in [("a.exr", "certified"), ("b.exr", "fast")] {
        let layers = exr::read(&folder.path(name), &Default::default()).unwrap();
        let said = layers.metadata.iter().find(|(key, _)| key == "precision");
        assert_eq!(said.map(|(_, value)| value.as_str()), Some(precision));
    }
}

#[test]
fn the_plan_of_a_preview_says_so() {
    let folder = Folder::new();
    let said = folder.ok(&["plan", "scene.toml", "--precision", "fast"]);
    assert!(said.contains("; fast: in f32, for previews"), "{said}");
    let text = folder.ok(&["plan", "scene.toml", "--json"]);
    let plan: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(plan["film"]["precision"], "certified");
}

#[test]
fn another_precision_is_refused() {
    let folder = Folder::new();
    let run = folder.run(&["render", "scene.toml", "--precision", "exact"]);
    assert_eq!(run.code, 2);
    assert!(run.message().contains("certified"), "{}", run.stderr);
}
