//! Time-resolved sources.

use std::path::{Path, PathBuf};

use super::context::Context;
use super::{binding, object, pose, radiance};
use crate::error::{Result, number};
use crate::io::colmap::ColmapPicture;
use crate::io::cube::{self, Axes, Channels, CubeFormat, Recorded, is_picture};
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::model::{
    BinValues, CaptureCamera, Clock, Crop, CubeBacks, CubeData, CubeFile, CubeSource, FovAxis,
    Mapping, Object, ProjectionKind, Pulse, Reconstruction, Source, SourceKind, TimeBins,
    TimeFilter,
};
use crate::scene::names;
use crate::scene::values::NumberOrVector;
use crate::spacetime::units::{LARGEST, Time, quoted};
use crate::spacetime::{Event, Quantity};

/// All sources; `quantity` is the default of sources without their own.
pub(super) fn resolve_all(
    cx: &Context,
    sources: &[At<file::Source>],
    objects: &[Object],
    quantity: Quantity,
) -> Result<Vec<Source>> {
    refuse_many_pulses(cx, sources)?;
    let explicit = sources.iter().filter_map(|at| at.value.name.as_ref());
    object::refuse_duplicates(cx, explicit, "source")?;
    let names = self::names(sources);
    // A surface is lit by one cube at most: the bindings track which are taken.
    let mut bindings = binding::Bindings::new(cx, objects);
    let mut resolved = Vec::with_capacity(sources.len());
    for (at, name) in sources.iter().zip(names) {
        let quantity = match &at.value.radiance {
            Some(own) => radiance::of_source(cx, own)?,
            None => quantity,
        };
        let kind = kind(cx, at)?;
        refuse_companions(cx, &at.value, (&kind, quantity))?;
        resolved.push(Source {
            name,
            kind,
            binding: bindings.bind(at)?,
            quantity,
            span: binding::span(at),
        });
    }
    Ok(resolved)
}

/// The largest number of pulses, as for lights: each may be evaluated at every hit.
const MOST_PULSES: usize = 10_000;

fn refuse_many_pulses(cx: &Context, sources: &[At<file::Source>]) -> Result<()> {
    let pulses = || sources.iter().filter(|at| at.value.pulse.is_some());
    match pulses().nth(MOST_PULSES) {
        None => Ok(()),
        Some(at) => {
            let what = format!("{} pulses are too many", pulses().count());
            Err(cx.refuse(at, what, format!("give at most {MOST_PULSES}")))
        }
    }
}

/// Refuses infrared and ultraviolet beside channels that are not a spectrum: nothing shifts into view.
fn refuse_companions(
    cx: &Context,
    source: &file::Source,
    (kind, quantity): (&SourceKind, Quantity),
) -> Result<()> {
    let companions = match kind {
        SourceKind::Cube(cube) => cube.companions(),
        SourceKind::Pulse(_) => return Ok(()),
    };
    let at = source
        .cube
        .as_ref()
        .and_then(|cube| cube.value.channels.as_ref());
    let Some(at) = at.filter(|_| quantity != Quantity::Rgb && !companions.is_empty()) else {
        return Ok(());
    };
    let names: Vec<_> = companions.iter().map(|c| c.name()).collect();
    let what = format!(
        "{} shift into view if colours are spectra, but this radiance is {quantity}",
        names.join(" and ")
    );
    let help = "set quantity = \"rgb\" in [radiance] or in the source's `radiance`";
    Err(cx.refuse(at, what, help))
}

/// The names of sources, those of the file or defaults.
pub(super) fn names(sources: &[At<file::Source>]) -> Vec<String> {
    names::unique(sources.iter().map(|at| entry_names(&at.value)).collect())
}

fn entry_names(source: &file::Source) -> (Option<String>, String) {
    let name = source.name.as_ref().map(|name| name.value.clone());
    let cube = source.cube.as_ref();
    (
        name,
        names::source(cube.map(|cube| cube.value.file.value.as_str())),
    )
}

fn kind(cx: &Context, at: &At<file::Source>) -> Result<SourceKind> {
    match (&at.value.cube, &at.value.pulse) {
        (Some(source), None) => cube(cx, source).map(Box::new).map(SourceKind::Cube),
        (None, Some(source)) => pulse(cx, &source.value).map(SourceKind::Pulse),
        (Some(cube), Some(pulse)) => Err(cx.refuse_both((cube, "cube"), (pulse, "pulse"))),
        (None, None) => {
            let help = "add cube = { file = \"a.npy\", bin_width = \"0.05 m\" } or \
                        pulse = { position = [0, 2, 0], sigma = \"5 cm\" }";
            Err(cx.refuse(at, "this source has neither a cube nor a pulse", help))
        }
    }
}

fn cube(cx: &Context, at: &At<file::Cube>) -> Result<CubeSource> {
    let cube = &at.value;
    let axes = axes(cx, cube)?;
    // Axes without T declare a steady picture, and so does the name of a single picture: it has no time axis whose keys could be missing.
    let steady = match &axes {
        Some(axes) => !axes.has_time(),
        None => is_picture(&cx.inputs.base.join(&cube.file.value)),
    };
    let recorded = cx.inputs.recorded(&cube.file);
    let (mut time, recorded) = match steady {
        true => (steady_time(cx, cube)?, Recorded::default()),
        false => time_axis(cx, at, recorded)?,
    };
    let channels = channels(cx, cube)?;
    let data = data(cx, cube, axes, &time)?;
    let mapping = mapping(cx, cube, &recorded)?;
    let clock = clock(cx, cube, &recorded, &mut time.read)?;
    Ok(CubeSource {
        data,
        channels,
        mapping,
        clock,
        bins: time.bins,
        values: time.values,
        filter: time.filter,
        reconstruction: reconstruction(cx, cube)?,
        scale: match &cube.scale {
            Some(scale) => cx.positive(scale, "`scale`")?,
            None => 1.0,
        },
        negative: cube.negative.as_ref().map(|at| at.value),
        read: time.read,
        assumed: time
            .assumed
            .into_iter()
            .chain(assumed(cube, steady, (clock, &recorded)))
            .collect(),
        recorded,
    })
}

/// The omitted keys with the values assumed, except `axes`: whether the file gives them is in its header.
fn assumed(cube: &file::Cube, steady: bool, (clock, recorded): (Clock, &Recorded)) -> Vec<String> {
    let mut assumed = Vec::new();
    let mut says = |said: bool, what: &str| assumed.extend((!said).then(|| what.to_string()));
    if !steady {
        let is_recorded = recorded.clock.is_some();
        says(cube.clock.is_some() || is_recorded, "clock = \"world\"");
        says(cube.values.is_some(), "values = \"per_bin\"");
        says(cube.filter.is_some(), "filter = \"cubic_means\"");
    }
    if let Some(capture) = &cube.capture {
        says(
            cube.reconstruction.is_some(),
            "reconstruction = \"bilinear\"",
        );
        // Mitsuba's rays begin on the near plane, and no file records where that is.
        says(
            clock != Clock::Capture || capture.value.near_clip.is_some(),
            "capture.near_clip = 0",
        );
    }
    says(cube.uv.is_some() || cube.capture.is_some(), "uv = 0");
    assumed
}

/// The keys of the time axis, resolved.
struct TimeKeys {
    bins: TimeBins,
    /// What the file says, and what is assumed.
    read: Vec<String>,
    assumed: Vec<String>,
    values: BinValues,
    filter: TimeFilter,
}

/// The time axis, and what the file says of its light.
fn time_axis(
    cx: &Context,
    at: &At<file::Cube>,
    recorded: Result<Recorded>,
) -> Result<(TimeKeys, Recorded)> {
    let cube = &at.value;
    cx.exclusive((&cube.start, "start"), (&cube.first_center, "first_center"))?;
    let keys = |bins, read, assumed| TimeKeys {
        bins,
        read,
        assumed,
        values: cube
            .values
            .as_ref()
            .map_or_else(Default::default, |at| at.value),
        filter: cube
            .filter
            .as_ref()
            .map_or_else(Default::default, |at| at.value),
    };
    // A table of edges defines the whole axis.
    if let Some(edges) = edges(cx, cube)? {
        let recorded = recorded.unwrap_or_default();
        return Ok((keys(edges, Vec::new(), Vec::new()), recorded));
    }
    // The scene takes precedence over the cube's file.
    let recorded = recorded?;
    let times = recorded.times;
    if times.is_some_and(|times| times.at_sensor) {
        let what = format!(
            "the times in {} are those of arrival at its sensor: they include the path from each point of the wall",
            quoted(&cube.file.value)
        );
        let file = &cube.file.value;
        let help = format!(
            "subtract it: nullray convert {file} --unwarp {file} --surface wall.glb -o wall.npy, and use these two"
        );
        return Err(cx.refuse(&cube.file, what, help));
    }
    let (mut read, mut assumed) = (Vec::new(), Vec::new());
    let width = match (&cube.bin_width, &times) {
        (Some(width), _) => Some(cx.duration(width, "`bin_width`")?),
        (None, Some(times)) => {
            read.push(format!("bin_width = \"{} m\"", times.width));
            Some(times.width)
        }
        (None, None) => None,
    };
    let Some(bin_width) = width else {
        let help = "add the width of a bin, like bin_width = \"0.05 m\", or `edges` where widths differ; a picture that does not change with time \
                    is declared by axes = \"H W\"";
        return Err(cx.refuse(at, "the key `bin_width` is missing", help));
    };
    // The start is that of the first bin: half a bin before its centre.
    let start = match (&cube.start, &cube.first_center, times) {
        (Some(start), _, _) => cx.time(start)?,
        (None, Some(center), _) => cx.time(center)? - 0.5 * bin_width,
        (None, None, Some(times)) => {
            read.push(format!("start = \"{} m\"", times.start));
            times.start
        }
        (None, None, None) => {
            assumed.push("start = \"0 m\"".into());
            0.0
        }
    };
    let bins = TimeBins::Uniform {
        start,
        width: bin_width,
    };
    Ok((keys(bins, read, assumed), recorded))
}

/// The table of edges, if there is one.
fn edges(cx: &Context, cube: &file::Cube) -> Result<Option<TimeBins>> {
    let help = "keep `edges`, `edges_file`, or `bin_width` with `start` or `first_center`";
    let span = |at: &Option<At<Time>>| at.as_ref().map(|at| at.span.clone());
    let table = cube.edges.as_ref().map(|at| &at.span);
    let file = cube.edges_file.as_ref().map(|at| &at.span);
    if table.or(file).is_none() {
        return Ok(None);
    }
    // The table replaces all keys of equal bins; none of them may be given with it.
    for (key, other) in [
        ("start", span(&cube.start)),
        ("first_center", span(&cube.first_center)),
        ("bin_width", span(&cube.bin_width)),
    ] {
        let ways = [
            ("edges", table),
            ("edges_file", file),
            (key, other.as_ref()),
        ];
        cx.only_one("the time axis", ways, help)?;
    }
    if let Some(table) = &cube.edges {
        cx.bounded(table, 2, "edges")?;
        let times: Vec<f64> = (table.value.iter())
            .map(|edge| cx.time(edge))
            .collect::<Result<_>>()?;
        cx.ascending(&times, |edge| table.value.get(edge))?;
        return Ok(Some(TimeBins::Edges(times.into())));
    }
    let Some(table) = &cube.edges_file else {
        return Ok(None);
    };
    // Numbers in a file have no units.
    let unit = cx.duration(&table.value.unit, "`unit`")?;
    let times: Vec<f64> = cx
        .numbers(&table.value.file)?
        .iter()
        .map(|n| n * unit)
        .collect();
    let ascends = times.windows(2).all(|pair| pair[1] > pair[0]);
    let within = times.iter().all(|time| time.abs() <= LARGEST);
    if times.len() < 2 || !ascends || !within {
        let what = format!(
            "{} is not a table of edges",
            quoted(&table.value.file.value)
        );
        let help = "an array of one axis with two or more times that ascend: the start of each bin, and the end of the last";
        return Err(cx.refuse(&table.value.file, what, help));
    }
    Ok(Some(TimeBins::Edges(times.into())))
}

/// One bin that covers all times, whose value is the radiance.
fn steady_time(cx: &Context, cube: &file::Cube) -> Result<TimeKeys> {
    let keys = [
        (&cube.start, "start"),
        (&cube.first_center, "first_center"),
        (&cube.bin_width, "bin_width"),
    ];
    let keys = keys.map(|(key, name)| (key.as_ref().map(|at| &at.span), name));
    let tables = [
        (cube.edges.as_ref().map(|at| &at.span), "edges"),
        (cube.edges_file.as_ref().map(|at| &at.span), "edges_file"),
    ];
    // Time keys would be ignored, and nothing is ignored silently.
    for (key, name) in keys.into_iter().chain(tables) {
        if let Some(span) = key {
            let what = format!("`{name}` describes a time axis, but `axes` has no T");
            let help = "leave it out, or add T to `axes`";
            return Err(cx.report.refuse(span, what, help));
        }
    }
    Ok(TimeKeys {
        // A density is not divided by its width, and `nearest` reads no neighbouring bin.
        bins: TimeBins::Uniform {
            start: -0.5 * LARGEST,
            width: LARGEST,
        },
        read: Vec::new(),
        assumed: Vec::new(),
        values: BinValues::Density,
        filter: TimeFilter::Nearest,
    })
}

fn axes(cx: &Context, cube: &file::Cube) -> Result<Option<Axes>> {
    let Some(at) = &cube.axes else {
        return Ok(None);
    };
    let refused = |what: String| {
        let help = "name every axis of the array once, the slowest first, like \"T H W\" or \"H W T C\": H rows, \
                    W columns, T time bins, C channels, 1 an axis of one entry";
        cx.refuse(at, format!("{}: {what}", quoted(&at.value)), help)
    };
    at.value.parse().map(Some).map_err(refused)
}

fn channels(cx: &Context, cube: &file::Cube) -> Result<Option<Channels>> {
    let Some(at) = &cube.channels else {
        return Ok(None);
    };
    let names = at.value.iter().map(String::as_str);
    let channels = Channels::named(names).map_err(|what| {
        let help = "name each channel once, in the order of the array: \"R\", \"G\", \"B\", and maybe \"IR\" and \"UV\"";
        cx.refuse(at, what.to_string(), help)
    })?;
    Ok(Some(channels))
}

fn data(cx: &Context, cube: &file::Cube, axes: Option<Axes>, time: &TimeKeys) -> Result<CubeData> {
    let memory = &cx.inputs.memory;
    let alone = |what| {
        let refuse = |array| cx.refuse(array, what, "leave `array` out, or name an .npz file");
        cube.array
            .as_ref()
            .map_or(Ok(()), |array| Err(refuse(array)))
    };
    // A cube from a program has neither array names nor an order of axes to give.
    if let Some(in_memory) = cx.in_memory(&cube.file, |name| memory.cube(name))? {
        alone("a cube in memory is a single array without a name")?;
        if let Some(axes) = &cube.axes {
            let what = "a cube in memory has its axes in the order H W T C";
            return Err(cx.refuse(axes, what, "leave `axes` out"));
        }
        if let Some(transfer) = &cube.transfer {
            let what = "a cube in memory holds radiance as it is";
            return Err(cx.refuse(transfer, what, "leave `transfer` out"));
        }
        if cube.dead_bins.as_ref().is_some_and(|bins| !bins.is_empty()) {
            let what = "a cube in memory is read as it is: it has no `dead_bins`";
            return Err(cx.refuse(
                &cube.file,
                what,
                "leave `dead_bins` out, and give the cube without them",
            ));
        }
        let count = in_memory.shape[3];
        if let Some(at) = &cube.channels
            && at.value.len() != count
        {
            let what = format!(
                "{} channels are named, but the cube has {count}",
                at.value.len()
            );
            return Err(cx.refuse(at, what, "name each of them once, in their order"));
        }
        let Some(negative) = &cube.negative else {
            return Ok(CubeData::Memory(in_memory));
        };
        let treated = negative
            .value
            .applied(in_memory, Path::new(&cx.report.name));
        return treated.map(CubeData::Memory);
    }
    let path = cube_path(cx, &cube.file)?;
    if !cube::format_called(&path).is_some_and(|format| format.named) {
        alone(
            "only the arrays of .npz and HDF5 files and of Zarr groups have names: this is without a name",
        )?;
    }
    let array = cx.optional_text(&cube.array, "the array's name")?;
    let dead_bins = cube.dead_bins.clone().unwrap_or_default();
    let size = |edges: &[f64]| match time.values {
        BinValues::PerBin => [0.5 * (edges[0] + edges[1]), edges[1] - edges[0]],
        BinValues::Density => [0.5 * (edges[0] + edges[1]), 1.0],
    };
    let bin_sizes = match time.bins.evenly() {
        TimeBins::Edges(edges) if !dead_bins.is_empty() => {
            Some(edges.windows(2).map(size).collect())
        }
        _ => None,
    };
    Ok(CubeData::File(CubeFile {
        path,
        array,
        axes,
        transfer: cube.transfer.as_ref().map(|at| at.value),
        dead_bins,
        bin_sizes,
    }))
}

/// The path of a cube file, or of a sequence of pictures.
fn cube_path(cx: &Context, file: &At<String>) -> Result<PathBuf> {
    let path = cx.inputs.base.join(cx.text(file, "the file's name")?);
    // A folder or a pattern has no extension that identifies its format.
    if let Some(told) = cube::format_called(&path).and_then(CubeFormat::by_path) {
        return match cx.inputs.problem(file) {
            Some(problem) => Err(cx.refuse(file, problem, cx.remedy(file, told.help.into()))),
            None => Ok(path),
        };
    }
    cx.path(file, &cube::extensions().collect::<Vec<_>>())
}

fn mapping(cx: &Context, cube: &file::Cube, recorded: &Recorded) -> Result<Mapping> {
    cx.exclusive((&cube.uv, "uv"), (&cube.capture, "capture"))?;
    cx.exclusive((&cube.backs, "backs"), (&cube.capture, "capture"))?;
    if let Some(camera) = &cube.capture {
        return capture(cx, camera).map(Mapping::Capture);
    }
    let backs = match cube.backs.as_ref().map(|at| (at, at.value)) {
        None | Some((_, file::Backs::AsFront)) => CubeBacks::AsFront,
        Some((_, file::Backs::Black)) => CubeBacks::Black,
        Some((_, file::Backs::SecondHalf)) => CubeBacks::SecondHalf,
        Some((at, file::Backs::AsBaked)) => {
            let said = recorded.backs.as_deref().and_then(CubeBacks::named);
            let unsaid = || {
                let what = format!("{} does not say what backs show", quoted(&cube.file.value));
                let help = "give \"as_front\", \"black\" or \"second_half\": only files that `nullray bake` and `nullray convert` wrote can say it";
                cx.refuse(at, what, help)
            };
            said.ok_or_else(unsaid)?
        }
    };
    let Some(uv) = &cube.uv else {
        return Ok(Mapping::Uv { set: 0, backs });
    };
    if uv.value > 255 {
        let what = format!("there is no TEXCOORD_{}", uv.value);
        return Err(cx.refuse(
            uv,
            what,
            "`uv` is the number of a set of texture coordinates, like 0",
        ));
    }
    Ok(Mapping::Uv {
        set: uv.value as usize,
        backs,
    })
}

fn capture(cx: &Context, at: &At<file::Capture>) -> Result<CaptureCamera> {
    let camera = &at.value;
    let pose = match &camera.pose {
        Some(given) => pose::given(cx, given, &camera.into())?,
        None => pose::resolve(cx, at, &camera.into())?,
    };
    let projection = camera.projection.value;
    cx.exclusive((&camera.hfov, "hfov"), (&camera.fov, "fov"))?;
    let crop = crop(cx, camera)?;
    let says_fov = camera.hfov.is_some() || camera.fov.is_some();
    let (film_fov, picture) = match &pose.picture {
        // The scene gives the whole lens.
        Some(_) if says_fov && crop.is_some() => (None, None),
        Some(picture) => {
            let ([horizontal, vertical], size) = of_colmap(cx, at, picture, crop)?;
            let fov = Some((Some(horizontal), vertical));
            (fov, size.filter(|_| !says_fov))
        }
        None => (pose.gltf_fov, None),
    };
    // The file's own field of view takes precedence over that of the glTF camera; of the latter only the horizontal one is known to apply
    // to the picture, whatever its shape.
    let (fov, fov_axis) = match (&camera.hfov, &camera.fov, film_fov) {
        (Some(hfov), _, _) => (pose::fov(cx, hfov, projection)?, FovAxis::X),
        (None, Some(fov), _) => (pose::fov(cx, fov, projection)?, fov_axis(cx, camera)?),
        (None, None, Some((Some(horizontal), _))) => (horizontal, FovAxis::X),
        (None, None, gltf) => {
            let what = match gltf {
                Some(_) => "the glTF camera has no horizontal field of view",
                None => "the key `hfov` is missing",
            };
            return Err(cx.refuse(
                at,
                what,
                "add the horizontal field of view, like hfov = \"40 deg\"",
            ));
        }
    };
    // Beside `hfov`, or a glTF camera's field of view, the axis would be ignored.
    if let (Some(axis), None) = (&camera.fov_axis, &camera.fov) {
        let what = "`fov_axis` is the axis of `fov`, but there is none";
        return Err(cx.refuse(axis, what, "give the field of view as `fov`"));
    }
    Ok(CaptureCamera {
        eye: pose.eye,
        axes: pose.axes,
        projection,
        fov,
        fov_axis,
        crop,
        picture,
        near_clip: near_clip(cx, camera)?,
    })
}

/// The horizontal and the vertical field of view of the whole film of a camera of COLMAP, and the size of the picture that the cube should
/// be: the film is the picture, or a larger one with the principal point in its middle.
fn of_colmap(
    cx: &Context,
    at: &At<file::Capture>,
    picture: &ColmapPicture,
    crop: Option<Crop>,
) -> Result<([f64; 2], Option<[u32; 2]>)> {
    let size = picture.size;
    let fov = |film| picture.fov(film);
    let whole = Some(size.map(|n| n as u32));
    let crop = crop.map(|crop| [crop.film, crop.offset].map(|pair| pair.map(f64::from)));
    let is_picture = |film: [f64; 2]| film[0] * size[1] == film[1] * size[0];
    match crop {
        None if picture.is_centred(size, [0.0; 2]) => return Ok((fov(size), whole)),
        // The cube is a part of the picture, at whatever resolution.
        Some([film, _]) if is_picture(film) && picture.is_centred(size, [0.0; 2]) => {
            return Ok((fov(size), None));
        }
        Some([film, offset]) if picture.is_centred(film, offset) => return Ok((fov(film), whole)),
        _ => {}
    }
    let [film, offset] = crop.unwrap_or([size, [0.0; 2]]);
    let what = format!(
        "the principal point of COLMAP's camera is {:?}, but the middle of the film is at {:?} of its picture",
        picture.centre,
        [0, 1].map(|axis| 0.5 * film[axis] - offset[axis])
    );
    let [film, offset] = picture.film().map(|pair| pair.map(|n| n as u32));
    let help = format!(
        "say where the picture is on a film with that point in its middle: crop = {{ film = {film:?}, offset = {offset:?} }}"
    );
    Err(cx.refuse(at, what, help))
}

fn fov_axis(cx: &Context, camera: &file::Capture) -> Result<FovAxis> {
    if let Some(axis) = camera
        .fov_axis
        .as_ref()
        .filter(|axis| axis.value != FovAxis::X)
    {
        perspective_only(
            cx,
            camera,
            axis,
            "a field of view along an axis other than x",
        )?;
    }
    match (&camera.fov_axis, &camera.fov) {
        (Some(axis), _) => Ok(axis.value),
        (None, Some(fov)) => {
            let what = "the axis of this field of view is missing";
            let help = "add fov_axis = \"x\", \"y\", \"diagonal\", \"smaller\" or \"larger\"";
            Err(cx.refuse(fov, what, help))
        }
        (None, None) => Ok(FovAxis::X),
    }
}

/// Refuses `thing`, which only a perspective camera has, for any other projection.
fn perspective_only<T>(
    cx: &Context,
    camera: &file::Capture,
    at: &At<T>,
    thing: &str,
) -> Result<()> {
    if camera.projection.value == ProjectionKind::Perspective {
        return Ok(());
    }
    let what = format!("{thing} is for perspective cameras only");
    Err(cx.refuse(at, what, "leave it out, or leave `projection` out"))
}

fn crop(cx: &Context, camera: &file::Capture) -> Result<Option<Crop>> {
    let Some(at) = &camera.crop else {
        return Ok(None);
    };
    let file::Crop { film, offset } = at.value;
    // Whether the crop fits on the film is also checked in the plan, where the cube's size is known.
    let lies = |axis: usize| film[axis] > 0 && offset[axis] < film[axis];
    if !(lies(0) && lies(1)) {
        let what = format!("an offset of {offset:?} is not on a film of {film:?} columns and rows");
        return Err(cx.refuse(
            at,
            what,
            "`film` is the size of the whole film, `offset` less than it",
        ));
    }
    Ok(Some(Crop { film, offset }))
}

fn near_clip(cx: &Context, camera: &file::Capture) -> Result<f64> {
    let Some(at) = &camera.near_clip else {
        return Ok(0.0);
    };
    let near = at.value.0;
    if !(0.0..=LARGEST).contains(&near) {
        let help = "`near_clip` is the depth of the near plane in metres, at least 0, like 0.01";
        return Err(cx.refuse(
            at,
            format!("a near plane at a depth of {} m", number(near)),
            help,
        ));
    }
    perspective_only(cx, camera, at, "a near plane")?;
    Ok(near)
}

/// The clock that the scene states, or else the file, which is then among the keys `read`.
fn clock(
    cx: &Context,
    cube: &file::Cube,
    recorded: &Recorded,
    read: &mut Vec<String>,
) -> Result<Clock> {
    let Some(at) = &cube.clock else {
        let Some(clock) = recorded.clock.as_deref().and_then(Clock::named) else {
            return Ok(Clock::default());
        };
        if clock == Clock::Capture && cube.capture.is_none() {
            let what = format!(
                "the times in {} are those of arrival at the camera that captured it, whose position is missing",
                quoted(&cube.file.value)
            );
            let help = "add capture = { eye = […], look_at = […], hfov = \"…\" }, or set clock = \"world\"";
            return Err(cx.refuse(&cube.file, what, help));
        }
        read.push(format!("clock = \"{}\"", clock.name()));
        return Ok(clock);
    };
    match at.value {
        Clock::Capture if cube.capture.is_none() => {
            let what = "the clock of the capture camera needs the position of that camera";
            let help = "add capture = { eye = […], look_at = […], hfov = \"…\" }, or set clock = \"world\"";
            Err(cx.refuse(at, what, help))
        }
        clock => Ok(clock),
    }
}

fn reconstruction(cx: &Context, cube: &file::Cube) -> Result<Reconstruction> {
    let Some(at) = &cube.reconstruction else {
        return Ok(Reconstruction::default());
    };
    if at.value == Reconstruction::Sharp && cube.capture.is_none() {
        let what = "only the pixels of a capture are known to be means over their squares";
        return Err(cx.refuse(at, what, "leave `reconstruction` out, or add `capture`"));
    }
    Ok(at.value)
}

fn pulse(cx: &Context, pulse: &file::Pulse) -> Result<Pulse> {
    let intensity = match pulse.intensity.value {
        NumberOrVector::Number(all) => [all; 3],
        NumberOrVector::Vector(rgb) => rgb,
    };
    if intensity.iter().any(|&i| i < 0.0) {
        let help = "energy per solid angle is at least 0: one number, or [r, g, b]";
        return Err(cx.refuse(&pulse.intensity, "an intensity is below 0", help));
    }
    Ok(Pulse {
        origin: Event::new(cx.time(&pulse.time)?, pulse.position.value.vec()),
        sigma: cx.duration(&pulse.sigma, "`sigma`")?,
        intensity,
        shadows: pulse.shadows,
    })
}
