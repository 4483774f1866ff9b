//! Files made to break the program, and a farm that generates more of them.
//!
//! `cargo test --test fuzz` replays the corpus of `fuzz/`, all small files of the other tests, and a few thousand inputs generated from
//! them. `fuzz/run SECONDS` runs the farm (the ignored test here) for any length of time; see `fuzz/README.md`.

#[path = "../common/counting.rs"]
mod counting;
mod farm;
mod mutate;
mod scenes;
mod schema;
#[path = "../../fuzz/src/targets.rs"]
mod targets;
mod watch;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use nullray::figures::diagram;
use nullray::render::plan::{Plan, Request};
use nullray::scene::Overrides;
use targets::{TARGETS, Target};

#[global_allocator]
static ALLOCATOR: counting::Counting = counting::Counting;

/// The least corpus of a target: its own folder, and what the other tests have of its kind.
fn seeds(target: &Target) -> Vec<(PathBuf, Vec<u8>)> {
    let elsewhere: &[&str] = match target.name {
        "cube_npy" | "cube_npz" | "gltf" | "picture_npz" => {
            &["tests/data/valid", "tests/data/invalid"]
        }
        "cube_hdf5" => &["tests/data/hdf5"],
        "frame_tiff" => &["tests/data/tiff"],
        "scene" | "picture" => &["scenes", "scenes/effects", "scenes/cube"],
        "diagram" => &["scenes/diagrams"],
        _ => &[],
    };
    let own = format!("fuzz/corpus/{}", target.name);
    let mut paths: Vec<PathBuf> = elsewhere
        .iter()
        .flat_map(|folder| files(Path::new(folder)))
        .filter(|path| has_kind(path, target.extension))
        .chain(files(Path::new(&own)))
        .collect();
    paths.sort();
    let read = |path: PathBuf| {
        let bytes = std::fs::read(&path).unwrap();
        (path, bytes)
    };
    let all = paths.into_iter().map(read);
    all.filter(|(_, bytes)| bytes.len() < 100_000).collect()
}

fn has_kind(path: &Path, extension: &str) -> bool {
    let own = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    own == extension || (own, extension) == ("gltf", "glb")
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .map(|entry| entry.path())
        .filter(|path| path.is_file())
        .collect()
}

#[test]
fn the_corpus_is_read_or_refused_without_a_panic_and_without_much_memory() {
    for target in &TARGETS {
        let seeds = seeds(target);
        assert!(!seeds.is_empty(), "{} has no corpus", target.name);
        for (path, bytes) in seeds {
            let begin = Instant::now();
            let peak = counting::peak_of(|| (target.run)(&bytes));
            let name = path.display();
            assert!(peak < watch::MOST_MEMORY, "{name}: {peak} bytes");
            assert!(
                begin.elapsed() < Duration::from_secs(20),
                "{name}: {:?}",
                begin.elapsed()
            );
        }
    }
}

#[test]
fn a_first_harvest_of_the_farm_has_no_finding() {
    let report = farm::run(&TARGETS, seeds, farm::Until::Inputs(300), 1);
    assert!(report.findings.is_empty(), "{:#?}", report.findings);
}

/// Files of the schema, of which hardly one is a scene without a mistake; `NULLRAY_FUZZ_SCENES` says how many.
#[test]
fn scenes_made_of_the_schema_are_read_or_refused() {
    let count = std::env::var("NULLRAY_FUZZ_SCENES").map_or(2000, |text| text.parse().unwrap());
    let mut maker = schema::Maker::new(1);
    let mut diagrams = 0;
    let run = |name: &str| {
        TARGETS
            .iter()
            .find(|target| target.name == name)
            .unwrap()
            .run
    };
    for k in 0..count {
        let text = maker.scene();
        let begin = Instant::now();
        let peak = counting::peak_of(|| {
            let outcome = std::panic::catch_unwind(|| {
                run("scene")(text.as_bytes());
                run("diagram")(text.as_bytes());
            });
            assert!(outcome.is_ok(), "scene {k} of the schema:\n{text}");
        });
        assert!(peak < watch::MOST_MEMORY, "{peak} bytes:\n{text}");
        let seconds = begin.elapsed().as_secs();
        assert!(seconds < 20, "{seconds} s:\n{text}");
        let (name, base) = ("schema", Path::new("scenes"));
        diagrams += u32::from(diagram::parse(&text, name, base, &Overrides::default()).is_ok());
    }
    // Those that are read show that what is made is not refused by its first key.
    println!("of {count}: {diagrams} diagrams are read");
    assert!(diagrams > count / 20, "{diagrams} of {count}");
}

/// Most whole scenes can be rendered: what is changed in them lies deep, and the farm does not stop at the first key.
#[test]
fn most_whole_scenes_are_rendered_without_a_panic() {
    let mut maker = schema::Maker::new(2);
    let (count, mut planned) = (100, 0);
    let picture = TARGETS.iter().find(|target| target.name == "picture");
    for k in 0..count {
        let text = maker.whole_scene();
        let outcome = std::panic::catch_unwind(|| (picture.unwrap().run)(text.as_bytes()));
        assert!(outcome.is_ok(), "whole scene {k}:\n{text}");
        let overrides = Overrides {
            size: Some([6, 4]),
            ..Overrides::default()
        };
        let scene = nullray::scene::parse(&text, "whole", Path::new("scenes"), &overrides);
        planned += u32::from(scene.is_ok_and(|s| Plan::new(&s, &Request::default()).is_ok()));
    }
    println!("of {count}: {planned} can be rendered");
    assert!(planned > 2 * count / 5, "{planned} of {count}");
}

/// `NULLRAY_FUZZ_SECONDS`, `NULLRAY_FUZZ_SEED`, `NULLRAY_FUZZ_TARGETS` say for how long, from which number, and which.
#[test]
#[ignore = "it runs for as long as it is told to: fuzz/run"]
fn the_farm() {
    let number = |name: &str, or: u64| std::env::var(name).map_or(or, |text| text.parse().unwrap());
    let seconds = Duration::from_secs(number("NULLRAY_FUZZ_SECONDS", 60));
    let seed = number("NULLRAY_FUZZ_SEED", 1);
    let report = farm::run(&TARGETS, seeds, farm::Until::Time(seconds), seed);
    print!("{report}");
    assert!(report.findings.is_empty(), "{:#?}", report.findings);
}
