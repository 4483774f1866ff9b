//! `nullray compare`.

use std::path::{Path, PathBuf};

use nullray::Result;
use nullray::figures::drawing::{self, png};
use nullray::io::image::{self, exr};
use nullray::scene::model::SPEED_OF_LIGHT;
use nullray::validate::compare::{
    CompareOptions, Comparison, Encoding, NotFinite, Picture, Region, compare, flip, report,
};

use super::args::CompareArguments;
use super::failure::{Done, refused};
use super::output::extension;
use super::{inputs, interrupt, print, print_json};

/// Compares, writes what is asked for, and says whether all tolerances are met.
pub fn run(arguments: &CompareArguments) -> Result<Done> {
    check_outputs(arguments)?;
    let png = arguments
        .transfer
        .map_or(Encoding::Srgb, |transfer| transfer.0);
    let reference = Picture::read(&arguments.reference, png)?;
    let candidate = Picture::read(&arguments.candidate, png)?;
    interrupt::check()?;
    let comparison = compare(&reference, &candidate, &options(arguments)?)?;
    let breaches = comparison.breaches(&arguments.tolerance)?;
    match arguments.json {
        true => print_json(&comparison)?,
        false => print(&report::table(&comparison))?,
    }
    write(arguments, &comparison, &reference, &candidate)?;
    for breach in &breaches {
        super::complain(&format!("not within tolerance: {breach}\n"));
    }
    Ok(match breaches.is_empty() {
        true => Done::Well,
        false => Done::OutOfBounds,
    })
}

fn options(arguments: &CompareArguments) -> Result<CompareOptions> {
    let mask = match &arguments.mask {
        Some(path) => Some(Region::mask_of(
            &Picture::read(path, Encoding::Linear)?.layers,
        )),
        None => None,
    };
    Ok(CompareOptions {
        region: Region {
            crop: arguments.crop,
            mask,
        },
        not_finite: arguments.nan.map_or(NotFinite::Refuse, |policy| policy.0),
        channels: arguments.channels.clone(),
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
    reference: &Picture,
    candidate: &Picture,
) -> Result<()> {
    if arguments.outputs().next().is_none() {
        return Ok(());
    }
    for (_, path, _) in arguments.outputs() {
        super::output::will_write(path);
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
        maps.extend(geometric.filter(|geometric| *geometric != maps[0]));
        drawing::save(path, report::page(comparison, reference, candidate, &maps)?)?;
    }
    Ok(())
}

/// Refuses, before any work, what could not be written after it.
fn check_outputs(arguments: &CompareArguments) -> Result<()> {
    let read = [&arguments.reference, &arguments.candidate].map(|path| inputs::identity(path));
    let mut written: Vec<PathBuf> = Vec::new();
    for (flag, path, kind) in arguments.outputs() {
        let option = format!("{flag} {}", path.display());
        if extension(path) != kind {
            return Err(refused(
                option,
                format!("the name does not end in .{kind}"),
                "the extension says what is written",
            ));
        }
        let identity = inputs::identity(path);
        if read.contains(&identity) {
            return Err(refused(
                option,
                "this is one of the compared pictures and would be overwritten",
                "write to another name",
            ));
        }
        if written.contains(&identity) {
            return Err(refused(
                option,
                "two outputs have this name",
                "give each a name of its own",
            ));
        }
        if !inputs::directory(path).is_dir() {
            let what = format!(
                "there is no directory {}",
                inputs::directory(path).display()
            );
            return Err(refused(
                option,
                what,
                "make the directory first, or write elsewhere",
            ));
        }
        written.push(identity);
    }
    Ok(())
}

impl CompareArguments {
    /// Option, path and extension of each file that is written.
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
