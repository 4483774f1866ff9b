//! `nullray study`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use nullray::figures::drawing;
use nullray::render::metadata;
use nullray::validate::study::{self, Study, StudyOptions};
use nullray::{Error, Result};

use super::args::StudyArguments;
use super::failure::refused;
use super::film::in_pool;
use super::names::named_after;
use super::output::{encoded, extension, will_write};
use super::progress::Bar;
use super::{inputs, interrupt, panels, print};

/// Pixels of a point in a .png.
const SCALE: f64 = 2.0;

pub fn run(arguments: &StudyArguments) -> Result<()> {
    let outputs = outputs(arguments)?;
    let path = arguments.scene.as_deref();
    let scene = panels::scene(
        path,
        arguments.panel.as_ref(),
        &arguments.changes.overrides(),
    )?;
    let options = StudyOptions {
        methods: arguments.methods.0.clone(),
        samples: arguments.samples.0.clone(),
        runs: arguments.runs,
        budget: Duration::from_secs_f64(arguments.budget),
        reference_samples: arguments.reference_spp,
        memory_limit: arguments.changes.max_memory,
    };
    let study = in_pool(arguments.threads, || {
        let bar = Bar::new(options.rays(scene.camera.size), arguments.quiet);
        bar.start();
        study::study(&scene, &options, &bar)
    })?;
    interrupt::check()?;
    let say = |text: &str| if arguments.quiet { Ok(()) } else { print(text) };
    say(&study::table(&study))?;
    if study.was_cut_short {
        say("the budget ended the runs: a larger --budget gives more of them\n")?;
    }
    let origin = metadata::of_text(&scene.name, &scene.text);
    for output in &outputs {
        will_write(output);
        write(&study, output, &origin)?;
        say(&format!("wrote {}\n", output.display()))?;
    }
    Ok(())
}

/// Where to write; refused before anything is measured.
fn outputs(arguments: &StudyArguments) -> Result<Vec<PathBuf>> {
    let path = arguments.scene.as_deref();
    if arguments.output.is_empty() {
        let endings = ["-study.csv", "-study.json", "-study.svg"];
        return Ok(endings.map(|ending| named_after(path, ending)).into());
    }
    for output in &arguments.output {
        let option = format!("-o {}", output.display());
        if !["csv", "json", "svg", "pdf", "png"].contains(&extension(output).as_str()) {
            let help = "end it in .csv, .json, .svg, .pdf or .png";
            return Err(refused(option, "the name does not say what to write", help));
        }
        if !inputs::directory(output).is_dir() {
            let what = format!(
                "there is no directory {}",
                inputs::directory(output).display()
            );
            return Err(refused(
                option,
                what,
                "make the directory first, or write elsewhere",
            ));
        }
    }
    Ok(arguments.output.clone())
}

fn write(study: &Study, path: &Path, origin: &[(String, String)]) -> Result<()> {
    match extension(path).as_str() {
        "csv" => drawing::save(path, study::csv(study)),
        "json" => {
            let json = serde_json::to_string_pretty(study);
            let json = json.map_err(|e| Error::invalid(path, "", e.to_string(), ""))?;
            drawing::save(path, json + "\n")
        }
        kind => drawing::save(path, encoded(&study::draw(study)?, kind, SCALE, origin)?),
    }
}
