//! `nullray convert`.

use std::ops::Range;
use std::path::{Path, PathBuf};

use nullray::io::budget::Budget;
use nullray::io::cube::{self, Changes, Converted, FileTimes, Wanted};
use nullray::io::gltf;
use nullray::io::npy::{self, Dtype};
use nullray::mesh::Mesh;
use nullray::render::plan::bytes;
use nullray::{Error, Result};

use super::args::{ConvertArguments, SampleType};
use super::check::Names;
use super::console::{faint, print, warn};
use super::failure::refused;
use super::output::extension;
use super::progress::Bar;
use super::times::Times;

pub fn run(arguments: &ConvertArguments) -> Result<()> {
    let wanted = Wanted {
        array: arguments.array.as_deref(),
        axes: arguments.axes.as_ref(),
        channels: arguments.channels.as_ref(),
        transfer: arguments.transfer.map(Into::into),
        dead_bins: &arguments.dead_bins,
        negative: arguments.negative.map(Into::into),
        memory: Some(arguments.memory.bytes()),
        ..Wanted::default()
    };
    let info = cube::inspect(&arguments.input, wanted)?;
    if !arguments.quiet.on {
        warn(false, &info.remarks);
    }
    // Errors are reported before the first sample is read.
    let times = Times::of(
        (&arguments.input, wanted.array),
        [&arguments.start, &arguments.bin_width],
        arguments.medium_index,
        arguments.quiet.on,
    )?;
    check_outputs(arguments)?;
    let surface = match &arguments.surface {
        Some(to) => surface(arguments, wanted)?.map(|mesh| (to, mesh)),
        None => None,
    };
    let [h, w, ..] = info.shape;
    let changes = Changes {
        rows: arguments.rows.clone(),
        columns: arguments.columns.clone(),
        bins: arguments.bins.clone(),
        merge: arguments.merge.unwrap_or(1) as usize,
        density: arguments.density,
        shift: shift(arguments, &times, [h, w])?,
        clock: clock(arguments).map(String::from),
        dtype: arguments.sample_type.map(|kind| match kind {
            SampleType::F16 => Dtype::F16,
            SampleType::F32 => Dtype::F32,
            SampleType::F64 => Dtype::F64,
        }),
        axes: arguments.to_axes.clone(),
        times: known(&times, arguments),
        memory: arguments.memory.bytes(),
    };
    let bar = Bar::samples(
        info.shape.iter().map(|n| *n as u64).product(),
        arguments.quiet.on,
    );
    let mut done = |written, of| bar.reached(written, of);
    let converted = cube::convert(
        (&arguments.input, wanted),
        &arguments.output,
        &changes,
        &mut done,
    )?;
    drop(bar);
    if let Some((to, mesh)) = &surface {
        gltf::save(to, "wall", mesh)?;
    }
    match arguments.quiet.on {
        true => Ok(()),
        false => report(arguments, &converted, &times),
    }
}

/// The surface of the pixels; `None` for rows and columns that do not exist, which the conversion refuses.
fn surface(arguments: &ConvertArguments, wanted: Wanted) -> Result<Option<Mesh>> {
    let input = &arguments.input;
    let refuse = |what| {
        let help = "the files of y-tal, of the Zaragoza NLOS data set and of phasor fields, and transient images of Bonn, say \
                    where the points of their pixels are, at least two rows and two columns";
        Err(Error::invalid(input, "", what, help))
    };
    let Some(wall) = cube::wall(input, wanted)? else {
        return refuse("the file does not say where the points of its pixels are");
    };
    let kept = |range: &Option<Range<usize>>, count| range.clone().unwrap_or(0..count);
    let rows = kept(&arguments.rows, wall.size[0]);
    let columns = kept(&arguments.columns, wall.size[1]);
    if rows.end > wall.size[0] || columns.end > wall.size[1] {
        return Ok(None);
    }
    match wall.mesh(rows, columns) {
        Some(mesh) => Ok(Some(mesh)),
        None => refuse("the points of a single row or column make no surface"),
    }
}

/// The whole time axis, if it is known.
fn known(times: &Times, arguments: &ConvertArguments) -> Option<FileTimes> {
    let still_at_sensor = times.at_sensor && arguments.unwarp.is_none();
    Some(FileTimes {
        start: times.start.filter(|_| !still_at_sensor)?,
        width: times.width.filter(|width| *width > 0.0)?,
        at_sensor: false,
    })
}

/// Refuses, before any work, outputs that could not be written later, that would be written twice, or that would overwrite an input.
fn check_outputs(arguments: &ConvertArguments) -> Result<()> {
    let maps = arguments.unwarp.iter().chain(&arguments.warp);
    let read: Vec<_> = maps.chain([&arguments.input]).collect();
    let mut names = Names::new(read, "this is an input file", "");
    let output = &arguments.output;
    let option = format!("-o {}", output.display());
    // A new folder may be named with a slash at the end; whether it already exists is checked when it is created.
    match extension(output).as_str() {
        "" | "zarr" => names.take(&option, output)?,
        _ => names.check(&option, output)?,
    }
    let Some(surface) = &arguments.surface else {
        return Ok(());
    };
    let option = format!("--surface {}", surface.display());
    if extension(surface) != "glb" {
        let what = "the surface is binary glTF";
        return Err(refused(option, what, "give a name that ends in .glb"));
    }
    names.check(&option, surface)
}

/// The clock to which the output is turned, if it is.
fn clock(arguments: &ConvertArguments) -> Option<&'static str> {
    let unwarped = arguments.unwarp.as_ref().map(|_| "world");
    unwarped.or(arguments.warp.as_ref().map(|_| "capture"))
}

/// The delay of each pixel in bins: ∓ η r/w.
fn shift(
    arguments: &ConvertArguments,
    times: &Times,
    size: [usize; 2],
) -> Result<Option<Vec<f64>>> {
    let (file, sign, option) = match (&arguments.unwarp, &arguments.warp) {
        (None, None) => return Ok(None),
        (Some(file), _) => (file, -1.0, "--unwarp"),
        (None, Some(file)) => (file, 1.0, "--warp"),
    };
    // By the file, the path is still in its times, or it is not.
    let by_arrival = times.clock.as_deref().map(|clock| clock == "capture");
    if let Some(by_arrival) = by_arrival.filter(|by_arrival| *by_arrival == (sign > 0.0)) {
        let (times, other) = match by_arrival {
            true => ("arrival at the camera", "--unwarp subtracts"),
            false => ("emission", "--warp adds"),
        };
        let what = format!(
            "the times in {} are those of {times} already",
            arguments.input.display()
        );
        let help = format!("leave it out; {other} the path of the light");
        return Err(refused(option, what, &help));
    }
    let Some(width) = times.width.filter(|width| *width > 0.0) else {
        let what = "the width of a bin is not known, or not above 0";
        return Err(refused(option, what, "add it, like --bin-width \"0.05 m\""));
    };
    let index = times.medium_index.unwrap_or(1.0);
    let distances = distances(file, size, arguments.memory.bytes())?;
    let shift = |distance: f64| match distance > 0.0 && distance.is_finite() {
        true => sign * index * distance / width,
        false => f64::NAN,
    };
    Ok(Some(distances.into_iter().map(shift).collect()))
}

/// Distances per pixel, row by row, from a file.
fn distances(file: &Path, size: [usize; 2], memory: u64) -> Result<Vec<f64>> {
    let budget = Budget::new(memory);
    let named = |known: &str| {
        file.extension()
            .is_some_and(|e| e.eq_ignore_ascii_case(known))
    };
    if ["h5", "hdf5", "mat"].into_iter().any(named) {
        return distances_of_wall(file, size);
    }
    let is_archive = named("npz");
    let map = npy::load_plain(file, is_archive.then_some("distance"), &budget)?;
    if map.shape != size {
        let what = format!(
            "distances of shape {:?} for a picture of {} rows and {} columns",
            map.shape, size[0], size[1]
        );
        return Err(Error::invalid(
            file,
            "",
            what,
            "give a distance per pixel of the whole picture",
        ));
    }
    Ok(map.samples.into_f64())
}

/// The distances from the sensor to the points of the pixels, from the file of a capture.
fn distances_of_wall(file: &Path, size: [usize; 2]) -> Result<Vec<f64>> {
    let wall = cube::wall(file, Wanted::default())?;
    let distances = wall
        .filter(|wall| wall.size == size)
        .and_then(|wall| wall.distances());
    distances.ok_or_else(|| {
        let what = format!(
            "the file does not say how far the points of {} rows and {} columns are from a sensor",
            size[0], size[1]
        );
        Error::invalid(file, "", what, "give distances as a .npy file")
    })
}

/// A summary of the output, and the keys with which a scene reads it; times follow from the width of the input's bins, or are in bins if
/// that is unknown.
fn report(arguments: &ConvertArguments, converted: &Converted, times: &Times) -> Result<()> {
    let [h, w, t, c] = converted.shape;
    let (name, size) = match converted.dtype {
        Dtype::F16 => ("f16", 2),
        Dtype::F64 => ("f64", 8),
        _ => ("f32", 4),
    };
    let colours = match &arguments.channels {
        Some(channels) => format!("channels {channels}"),
        None if c == 1 => "grey".into(),
        None => "red, green, blue".into(),
    };
    let output: &PathBuf = &arguments.output;
    let mut text = format!(
        "wrote {}: {h} rows, {w} columns, {t} time bins, {colours}; {name}, {}\n",
        output.display(),
        bytes((h * w * t * c * size) as u64)
    );
    let merged = converted.merged as f64;
    let is_as_before = converted.later == 0.0 && converted.merged == 1;
    text += &match (times.start, times.width) {
        (Some(start), Some(width)) => format!(
            "start = \"{} m\", bin_width = \"{} m\"{}\n",
            start + converted.later * width,
            width * merged,
            clock(arguments).map_or(String::new(), |clock| format!(", clock = \"{clock}\""))
        ),
        _ if is_as_before => String::new(),
        _ => format!(
            "bin 0 begins {} bins of the input later; a bin is {merged} of its bins wide\n",
            converted.later
        ),
    };
    print(&text)?;
    if times.at_sensor && arguments.unwarp.is_none() {
        let input = arguments.input.display();
        let warning = format!(
            "times are those of arrival at the sensor, as in the input; --unwarp {input} subtracts the path from each point"
        );
        warn(false, [&warning]);
    }
    let help =
        "choose a wider --type, or scale the samples and give the source the inverse `scale`";
    warn(false, &faint((converted.faint, &converted.dtype), help));
    if converted.dropped != 0.0 {
        let warning = format!(
            "samples of pixels without a distance were dropped; their sum is {}",
            converted.dropped
        );
        warn(false, [&warning]);
    }
    Ok(())
}
