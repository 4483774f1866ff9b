//! `nullray compare`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use nullray::Result;
use nullray::figures::drawing::{self, png};
use nullray::io::budget::Budget;
use nullray::io::image::{self, exr};
use nullray::render::aov::Aov;
use nullray::scene::Overrides;
use nullray::scene::model::Scene;
use nullray::spacetime::SPEED_OF_LIGHT;
use nullray::validate::compare::{
    Breach, CompareOptions, Comparison, Encoding, NotFinite, Picture, Region, compare, flip,
    report, working_memory,
};
use serde::Serialize;

use super::args::CompareArguments;
use super::check::Names;
use super::console::{complain, print_json, say};
use super::failure::{Done, refused};
use super::film::in_pool;
use super::output::extension;
use super::{builtin, flags, inputs, interrupt};

/// Compares, writes the outputs, and returns whether all tolerances are met.
pub fn run(arguments: &CompareArguments) -> Result<Done> {
    in_pool(arguments.work.threads.count, || run_here(arguments))
}

/// The same, on rayon's current thread pool.
fn run_here(arguments: &CompareArguments) -> Result<Done> {
    check_outputs(arguments, &[])?;
    let (budget, [reference, candidate]) = pair(arguments)?;
    check_effects(arguments, [&reference, &candidate])?;
    let scene = scene(arguments, &reference)?;
    if let Some(scene) = scene
        .as_ref()
        .filter(|_| arguments.outputs().next().is_some())
    {
        check_outputs(arguments, &inputs::of_any(scene))?;
    }
    let options = CompareOptions {
        scene,
        ..options(arguments, &budget)?
    };
    let taken = working_memory(&reference, &candidate, &options);
    budget.take(taken, &arguments.reference)?;
    interrupt::check()?;
    let comparison = flags::of_comparison(compare(&reference, &candidate, &options)?);
    let breaches = comparison.breaches(&arguments.tolerance)?;
    let breaches: Vec<Breach> = breaches.into_iter().map(flags::of_breach).collect();
    match arguments.json.on {
        true => print_json(&ComparisonJson {
            comparison: &comparison,
            breaches: &breaches,
        })?,
        false => say(arguments.work.quiet.on, &report::table(&comparison))?,
    }
    write(arguments, &comparison, &breaches, [&reference, &candidate])?;
    for breach in &breaches {
        complain(&format!("not within tolerance: {breach}\n"));
    }
    Ok(match breaches.is_empty() {
        true => Done::Well,
        false => Done::OutOfBounds,
    })
}

/// Refuses options that would change nothing for these pictures.
fn check_effects(arguments: &CompareArguments, pair: [&Picture; 2]) -> Result<()> {
    let has = |picture: &Picture, aov: Aov| picture.layers.channel(aov.name()).is_some();
    let both = |aov| pair.iter().all(|picture| has(picture, aov));
    let either = |aov| pair.iter().any(|picture| has(picture, aov));
    let is_png = |path: &PathBuf| extension(path) == "png";
    let has_png = is_png(&arguments.reference) || is_png(&arguments.candidate);
    let checks = [
        (
            "--transfer",
            arguments.transfer.is_some() && !has_png,
            "neither picture is a .png, whose encoding it says",
        ),
        (
            "--bin-width",
            arguments.bin_width.is_some() && !both(Aov::EventCt) && !both(Aov::ObjectEventCt),
            "no channel event.ct (or object_event.ct) is in both pictures, whose errors it counts",
        ),
        (
            "--no-hit",
            arguments.no_hit.is_some() && !either(Aov::Object) && !either(Aov::Primitive),
            "neither picture has a channel object or primitive, in which it stands",
        ),
    ];
    match checks.into_iter().find(|(_, is_vain, _)| *is_vain) {
        Some((option, _, what)) => Err(refused(option, what, "leave it out")),
        None => Ok(()),
    }
}

/// The JSON output: the comparison, and the limits that it exceeds.
#[derive(Serialize)]
struct ComparisonJson<'a> {
    #[serde(flatten)]
    comparison: &'a Comparison,
    /// Exceeded limits.
    breaches: &'a [Breach],
}

/// The named scene, with the size and the camera time of the reference.
fn scene(arguments: &CompareArguments, reference: &Picture) -> Result<Option<Arc<Scene>>> {
    let Some(path) = &arguments.scene else {
        return Ok(None);
    };
    let time = reference.metadata("camera_time");
    let overrides = Overrides {
        size: Some([reference.layers.width, reference.layers.height]),
        time: time.map(|metres| format!("{metres} m")),
        ..Overrides::default()
    };
    Ok(Some(Arc::new(builtin::read(path)?.scene(&overrides)?)))
}

/// Both pictures, and what is left of the memory.
fn pair(arguments: &CompareArguments) -> Result<(Budget, [Picture; 2])> {
    let read = |budget: &Budget, path| picture(path, arguments, budget);
    let budget = Budget::new(arguments.memory.bytes());
    let both = rayon::join(
        || read(&budget, &arguments.reference),
        || read(&budget, &arguments.candidate),
    );
    match both {
        (Ok(reference), Ok(candidate)) => return Ok((budget, [reference, candidate])),
        // Its memory is needed again.
        failed => drop(failed),
    }
    // Which of two pictures is beyond the memory depends on the threads: the second one.
    let budget = Budget::new(arguments.memory.bytes());
    let reference = read(&budget, &arguments.reference)?;
    let candidate = read(&budget, &arguments.candidate)?;
    Ok((budget, [reference, candidate]))
}

/// A picture, read according to the options.
fn picture(path: &Path, arguments: &CompareArguments, budget: &Budget) -> Result<Picture> {
    let png = arguments.transfer.unwrap_or(Encoding::Srgb);
    let mut picture = Picture::read(path, png, budget)?;
    if let Some(no_hit) = arguments.no_hit {
        picture.set_no_hit(no_hit);
    }
    Ok(picture)
}

fn options(arguments: &CompareArguments, budget: &Budget) -> Result<CompareOptions> {
    let mask = match &arguments.mask {
        Some(path) => Some(Region::mask_of(
            &Picture::read(path, Encoding::Linear, budget)?.layers,
        )),
        None => None,
    };
    Ok(CompareOptions {
        region: Region {
            crop: arguments.crop,
            mask,
        },
        not_finite: arguments.nan.unwrap_or(NotFinite::Refuse),
        channels: arguments.channels.clone(),
        scene: None,
        bin_width: arguments.bin_width.map(|time| time.metres(SPEED_OF_LIGHT)),
        pixels_per_degree: (!arguments.no_flip)
            .then_some(arguments.ppd.unwrap_or(flip::PIXELS_PER_DEGREE)),
        allow_swapped: arguments.allow_swapped,
        maps: arguments.outputs().next().is_some(),
    })
}

fn write(
    arguments: &CompareArguments,
    comparison: &Comparison,
    breaches: &[Breach],
    [reference, candidate]: [&Picture; 2],
) -> Result<()> {
    if arguments.outputs().next().is_none() {
        return Ok(());
    }
    if let Some(path) = &arguments.maps {
        exr::write(path, &report::maps(comparison, reference, candidate)?)?;
    }
    let map = report::error_map(comparison, reference, candidate);
    if let Some(path) = &arguments.error_map {
        drawing::save(path, png::write(&png::render(&map.page()?, 1.0)?)?)?;
    }
    if let Some(path) = &arguments.strip {
        let strip = report::strip(reference, &map, candidate)?;
        image::png::write(path, strip.width, strip.height, &strip.rgb, &[])?;
    }
    if let Some(path) = &arguments.report {
        let geometric = comparison.geometric_map.clone();
        let geometric = geometric
            .map(|errors| report::ErrorMap::new("geometric error (pixels)", comparison, errors));
        let mut maps = vec![map];
        // Maps contain NaN, which equals nothing.
        maps.extend(geometric.filter(|geometric| geometric.title != maps[0].title));
        let pair = [reference, candidate];
        drawing::save(path, report::page(comparison, breaches, pair, &maps)?)?;
    }
    Ok(())
}

/// Refuses, before any work, outputs that could not be written later; `read` are the files of the scene.
fn check_outputs(arguments: &CompareArguments, read: &[PathBuf]) -> Result<()> {
    let overwritten = "this is an input file, which would be overwritten";
    let compared = [&arguments.reference, &arguments.candidate];
    let others = [&arguments.mask, &arguments.scene].into_iter().flatten();
    let others = others.chain(read);
    let mut names = Names::new(compared.into_iter().chain(others), overwritten, "");
    for (flag, path, kind) in arguments.outputs() {
        let option = format!("{flag} {}", path.display());
        if extension(path) != kind {
            let what = format!("the name does not end in .{kind}");
            return Err(refused(option, what, "the extension says what is written"));
        }
        names.check(&option, path)?;
    }
    Ok(())
}

impl CompareArguments {
    /// The option, path and extension of each output file.
    fn outputs(&self) -> impl Iterator<Item = (&'static str, &Path, &'static str)> {
        [
            ("--maps", self.maps.as_deref(), "exr"),
            ("--error-map", self.error_map.as_deref(), "png"),
            ("--strip", self.strip.as_deref(), "png"),
            ("--report", self.report.as_deref(), "html"),
        ]
        .into_iter()
        .filter_map(|(flag, path, kind)| Some((flag, path?, kind)))
    }
}
