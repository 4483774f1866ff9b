//! `nullray study`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use nullray::figures::drawing;
use nullray::render::metadata;
use nullray::render::plan::Plan;
use nullray::scene::model::Scene;
use nullray::validate::study::{self, Study, StudyOptions};
use nullray::{Error, Result};

use super::args::StudyArguments;
use super::check::Names;
use super::console::say;
use super::failure::refused;
use super::film::in_pool;
use super::names::named_after;
use super::output::{encoded, extension};
use super::progress::Bar;
use super::{inputs, interrupt, memory};

/// Pixels per point in a .png.
const SCALE: f64 = 2.0;

/// Measures, prints the table, and writes it in the formats of the outputs' extensions.
pub fn run(arguments: &StudyArguments) -> Result<()> {
    let scene = arguments.scene.load()?;
    let request = arguments
        .scene
        .changes
        .request(arguments.work.threads.count);
    let read = inputs::of(&scene, &Plan::new(&scene, &request)?);
    let outputs = outputs(arguments, &read)?;
    let options = StudyOptions {
        methods: arguments.methods.0.clone(),
        samples: arguments.samples.0.clone(),
        runs: arguments.runs,
        budget: Duration::from_secs_f64(arguments.budget),
        reference_samples: arguments.reference_spp,
        memory_limit: arguments.scene.changes.memory.bytes(),
        program: memory::program(arguments.work.threads.count),
    };
    let quiet = arguments.work.quiet.on;
    let study = in_pool(arguments.work.threads.count, || {
        let bar = Bar::new(options.rays(scene.camera.size), quiet);
        bar.start();
        study::study(&scene, &options, &bar)
    })?;
    interrupt::check()?;
    say(quiet, &study::table(&study))?;
    if study.was_cut_short {
        let what = "the budget ended the runs: a larger --budget gives more of them\n";
        say(quiet, what)?;
    }
    for output in &outputs {
        write(&study, output, &scene)?;
        say(quiet, &format!("wrote {}\n", output.display()))?;
    }
    Ok(())
}

/// The output files; problems with them are reported before anything is measured.
fn outputs(arguments: &StudyArguments, read: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let path = arguments.scene.path();
    let outputs = match arguments.output.as_slice() {
        [] => ["-study.csv", "-study.json", "-study.svg"]
            .map(|ending| named_after(path, ending))
            .into(),
        said => said.to_vec(),
    };
    let overwritten = "the scene is made from this file, which would be overwritten";
    let mut names = Names::new(read, overwritten, "");
    for output in &outputs {
        let option = format!("-o {}", output.display());
        if !["csv", "json", "svg", "pdf", "png"].contains(&extension(output).as_str()) {
            let help = "end it in .csv, .json, .svg, .pdf or .png";
            return Err(refused(option, "the name does not say what to write", help));
        }
        names.check(&option, output)?;
    }
    Ok(outputs)
}

fn write(study: &Study, path: &Path, scene: &Scene) -> Result<()> {
    match extension(path).as_str() {
        "csv" => drawing::save(path, study::csv(study)),
        "json" => {
            let json = serde_json::to_string_pretty(study);
            let json = json.map_err(|e| Error::invalid(path, "", e.to_string(), ""))?;
            drawing::save(path, json + "\n")
        }
        kind => {
            let mut drawing = study::draw(study)?;
            drawing.origin = metadata::of_text(&scene.name, &scene.text);
            drawing::save(path, encoded(&drawing, kind, SCALE)?)
        }
    }
}
