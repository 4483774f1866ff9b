//! Series of pictures of a diagram: numbered files, and animated ones.

use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

use nullray::figures::diagram::Series;
use nullray::figures::diagram::model::Diagram;
use nullray::figures::drawing::png::RgbaImage;
use nullray::figures::drawing::{self, apng, png};
use nullray::io::image::film::{Delay, FilmWriter};
use nullray::{Error, Result};

use super::{Output, Pages};
use crate::cli::args::DiagramArguments;
use crate::cli::console::say;
use crate::cli::failure::refused;
use crate::cli::names::numbered;
use crate::cli::{interrupt, reel};

/// Writes the animated files among `outputs`, and numbered pictures for all others if frames are requested.
pub fn write(pages: &Pages, model: &Diagram) -> Result<()> {
    let arguments = pages.arguments;
    let series = || Series::new(model).ok_or_else(|| nothing_moves(arguments));
    if pages.animated().next().is_none() && arguments.frames.is_none() {
        return Ok(());
    }
    let frames = frames(arguments, series()?.animation().frames)?;
    if arguments.frames.is_some() {
        pictures(pages, series()?, &frames)?;
    }
    for output in pages.animated() {
        animate(pages, series()?, output, &frames)?;
    }
    Ok(())
}

/// The names of all files, for checks before anything is drawn.
pub fn names(arguments: &DiagramArguments, output: &Output) -> Vec<PathBuf> {
    match &arguments.frames {
        Some(frames) if !output.is_animated() => {
            let numbers = frames.clone();
            numbers.map(|k| numbered(&output.path, k)).collect()
        }
        _ => vec![output.path.clone()],
    }
}

fn nothing_moves(arguments: &DiagramArguments) -> Error {
    let option = match &arguments.frames {
        Some(frames) => format!("--frames {}..{}", frames.start, frames.end),
        None => "-o FILE.apng".into(),
    };
    let what = "the diagram has no animation";
    let help = "give --boost-to NAME, or add a table [diagram.animation]";
    refused(option, what, help)
}

fn frames(arguments: &DiagramArguments, count: u32) -> Result<Range<u64>> {
    let all = 0..u64::from(count);
    match &arguments.frames {
        None => Ok(all),
        Some(frames) if frames.end <= all.end => Ok(frames.clone()),
        Some(frames) => {
            let option = format!("--frames {}..{}", frames.start, frames.end);
            let what = format!("the animation has {count} pictures");
            let help = format!("0..{count}, a part of it, or another diagram.animation.frames");
            Err(refused(option, what, &help))
        }
    }
}

fn pictures(pages: &Pages, series: Series, frames: &Range<u64>) -> Result<()> {
    for (k, drawing) in (0..frames.end).zip(series) {
        interrupt::check()?;
        let drawing = pages.signed(drawing?);
        // It must be drawn all the same: the labels of later pictures depend on it.
        if k < frames.start {
            continue;
        }
        for output in pages.stills() {
            pages.save(&drawing, output, &numbered(&output.path, k))?;
        }
    }
    Ok(())
}

fn animate(pages: &Pages, series: Series, output: &Output, frames: &Range<u64>) -> Result<()> {
    let (arguments, path) = (pages.arguments, output.path.as_path());
    let fps = arguments.fps.unwrap_or(series.animation().fps);
    let count = (frames.end - frames.start) as usize;
    let mut size = [0.0; 2];
    let skipped = frames.start as usize;
    let rasters = series.skip(skipped).take(count).map(|drawing| {
        interrupt::check()?;
        let drawing = pages.signed(drawing?);
        size = [drawing.width, drawing.height];
        png::render(&drawing, arguments.scale)
    });
    let delay = Delay::of_rate(fps)?;
    if output.kind == "y4m" {
        reel::pipe_or_save(path, |name, out| {
            video(name, out, count as u32, rasters, delay)
        })?;
    } else {
        drawing::save(path, apng::write(count as u32, rasters, delay)?)?;
    }
    let [width, height] = size.map(f64::round);
    let path = path.display();
    let what = format!("wrote {path} ({width} × {height} points, {count} pictures)\n");
    say(arguments.quiet.on, &what)
}

/// The pictures as raw video.
fn video(
    name: &Path,
    out: &mut dyn Write,
    count: u32,
    mut rasters: impl Iterator<Item = Result<RgbaImage>>,
    delay: Delay,
) -> Result<()> {
    let Some(first) = rasters.next() else {
        return Ok(());
    };
    let first = reel::even(reel::opaque(&first?));
    let mut film = FilmWriter::y4m(name, out, [first.width, first.height], count, delay)?;
    film.picture(&first)?;
    for raster in rasters {
        film.picture(&reel::even(reel::opaque(&raster?)))?;
    }
    film.finish()
}
