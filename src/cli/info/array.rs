//! The contents of a file of arrays, from its headers, and whether it can be used as a cube; or that it is a picture.

use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

use nullray::io::cube::{self, Bricks, CubeFormat, CubeInfo, Transfer, Wanted};
use nullray::io::npy::{self, Dtype, Header};
use nullray::light::time_texture::survey::{self, Order};
use nullray::render::aov;
use nullray::render::plan::bytes;
use nullray::{Error, Result};
use serde_json::{Map, Value, json};

use super::{Info, MOST};
use crate::cli::console::escaped;

pub fn info(path: &Path, format: &CubeFormat, memory: u64) -> Result<Info> {
    match format.pictures {
        true => sequence(path, format, memory),
        false => of_arrays(path, format, memory),
    }
}

fn of_arrays(path: &Path, format: &CubeFormat, memory: u64) -> Result<Info> {
    let (name, headers) = (format.name, (format.arrays)(path)?);
    let metadata = metadata(path, &headers);
    let baked = metadata.as_ref().filter(|told| is_baked(told, &headers));
    let is_cube = |told: &Map<_, _>| told.contains_key("bin_width");
    let is_picture = !metadata.as_ref().is_some_and(is_cube) && is_picture(&headers);
    let title = match headers.as_slice() {
        headers if baked.is_some() => format!("baked light, {} arrays", headers.len()),
        headers if is_picture => format!("picture of {} arrays", headers.len()),
        [one] if one.name.is_none() => name.into(),
        [_] => format!("{name} of 1 array"),
        headers => format!("{name} of {} arrays", headers.len()),
    };
    let mut info = Info::new(format.key, &title);
    // If a file says which of its arrays is a cube, the others only describe it.
    let said = cube::inspect(path, Wanted::default());
    let said = said
        .ok()
        .filter(|info| !info.assumed)
        .and_then(|info| info.array);
    // All arrays together, however many there are, may cost as much as one large one.
    let (mut looked_at, mut left) = (0, most_read(memory));
    let arrays = headers.iter().map(|header| {
        let is_metadata = metadata.is_some() && header.name.as_deref() == Some("metadata");
        let is_beside = baked.is_some() || is_metadata || said.is_some() && said != header.name;
        let may_be_cube = !is_picture && !is_beside;
        if may_be_cube && looked_at == MOST {
            return data(header, None);
        }
        let cube = may_be_cube.then(|| inspected(path, header, memory, &mut left));
        looked_at += usize::from(may_be_cube);
        describe(&mut info, header, cube.as_ref());
        data(header, cube.as_ref())
    });
    let arrays: Vec<Value> = arrays.collect();
    if looked_at == MOST && headers.len() > MOST {
        let more = headers.len() - MOST;
        info.row(
            "",
            format!("… and {more} more arrays, not looked into (--json has their shapes)"),
        );
    }
    if let Some(baked) = baked {
        as_baked(&mut info, path, baked);
    }
    if is_picture {
        info.row("usable", "yes: `nullray compare` reads its channels");
        let entries = metadata.iter().flatten();
        let texts = entries.filter_map(|(key, text)| Some((key.clone(), text.as_str()?.into())));
        info.metadata(&texts.collect::<Vec<_>>());
    }
    info.data("arrays", arrays);
    Ok(info)
}

/// The metadata that nullray writes into its archives; empty for other files.
fn metadata(path: &Path, headers: &[Header]) -> Option<Map<String, Value>> {
    named(headers, "metadata")?;
    npy::load_metadata(path)
}

/// Whether these are the metadata and arrays of light baked by `nullray bake`.
fn is_baked(metadata: &Map<String, Value>, headers: &[Header]) -> bool {
    let keys = ["start", "bin_width", "bins", "clock"];
    named(headers, "radiance").is_some_and(|header| header.shape.len() == 4)
        && keys.iter().all(|key| metadata.contains_key(*key))
}

/// The array of this name.
fn named<'a>(headers: &'a [Header], name: &str) -> Option<&'a Header> {
    let mut headers = headers.iter();
    headers.find(|header| header.name.as_deref() == Some(name))
}

/// Adds the bins, clock and error of baked light, and the table of a scene that shows it.
fn as_baked(info: &mut Info, path: &Path, metadata: &Map<String, Value>) {
    let text = |key: &str| metadata.get(key).and_then(Value::as_str);
    let said = |key: &str| text(key).unwrap_or("?");
    let [bins, width, start] = ["bins", "bin_width", "start"].map(said);
    info.row("bins", format!("{bins} of {width} m from {start} m"));
    info.row("clock", said("clock"));
    info.row("radiance", said("radiance_quantity"));
    if let Some(index) = text("medium_index").filter(|index| *index != "1") {
        info.row("medium", format!("refractive index {index}"));
    }
    let number = |key: &str| text(key).and_then(|number| number.parse::<f64>().ok());
    let is_dark = number("energy_in_bins") == Some(0.0);
    // Files of older versions do not have these times.
    if let (Some(from), Some(to)) = (number("light_from"), number("light_until")) {
        let none = if is_dark {
            ", none of it in the bins"
        } else {
            ""
        };
        info.row("light", format!("from {from:.6} m to {to:.6} m{none}"));
    }
    let error = match number("relative_standard_error").filter(|error| error.is_finite()) {
        Some(error) => format!(
            "{:.2} % in a bin, of the root mean square of all ({} samples each)",
            100.0 * error,
            said("samples_per_pixel")
        ),
        None if text("samples_per_pixel") != Some("1") => "none: the bins are dark".into(),
        None => "not known: of one sample per texel".into(),
    };
    info.row("error", error);
    info.data("metadata", metadata.clone());
    let Some(table) = text("source_table") else {
        return info.row("usable", "yes: as the file of a [[source]]");
    };
    info.row("usable", "yes, by these lines of a scene");
    // The file may have been renamed.
    let own = path.file_name().unwrap_or_default().to_string_lossy();
    for line in table.lines() {
        let line = match line.split_once("file = \"") {
            Some((before, after)) => match after.split_once('"') {
                Some((_, after)) => format!("{before}file = {own:?}{after}"),
                None => line.into(),
            },
            None => line.to_string(),
        };
        info.line(&format!("    {}", escaped(&line)));
    }
}

/// Adds a sequence of pictures as a cube.
fn sequence(path: &Path, format: &CubeFormat, memory: u64) -> Result<Info> {
    let mut info = Info::new(format.key, format.name);
    // Coded pictures have no meaning without a transfer function, and any one will do for an inspection.
    let plain = Wanted::default().within(memory);
    let linear = Wanted {
        transfer: Some(Transfer::Linear),
        ..plain
    };
    let (wanted, cube, lacks_transfer) = match cube::inspect(path, plain) {
        Ok(cube) => (plain, cube, false),
        Err(error) => match cube::inspect(path, linear) {
            Ok(cube) => (linear, cube, true),
            Err(_) => return Err(error),
        },
    };
    let remarks = match cube.bytes > most_read(memory) {
        true => None,
        false => {
            let cube = cube::load(path, wanted)?.into();
            Some(survey::of_samples(&cube, Order::Pictures))
        }
    };
    let cube = Known {
        remarks,
        cube,
        at_sensor: false,
    };
    as_cube(&mut info, &cube);
    if lacks_transfer {
        info.row(
            "needs",
            "transfer = \"linear\" or \"srgb\" in the source: how codes encode radiance, which pictures do not say",
        );
    }
    info.data("needs_transfer", lacks_transfer);
    info.data("cube", usable(&cube));
    Ok(info)
}

/// The result of an inspection of a cube.
type Cube = Result<Known>;

/// Problems of a cube's samples (`None` if they were not read), its header, and whether its times include the path to a sensor that only
/// the file knows.
struct Known {
    remarks: Option<Vec<String>>,
    cube: CubeInfo,
    at_sensor: bool,
}

/// Inspects the array as a cube; its samples are read if they take no more than the bytes `left`.
fn inspected(path: &Path, header: &Header, memory: u64, left: &mut u64) -> Cube {
    let wanted = Wanted {
        array: header.name.as_deref(),
        ..Wanted::default()
    };
    let cube = cube::inspect(path, wanted)?;
    // Ambiguous times are reported by `cube`.
    let times = cube::times(path, wanted.array).ok().flatten();
    Ok(Known {
        remarks: samples(path, wanted, &cube, memory, left)?,
        cube,
        at_sensor: times.is_some_and(|times| times.at_sensor),
    })
}

/// Samples that need more memory than this are not read, bytes.
const MOST_READ: u64 = 1 << 30;

/// Memory for parts of larger arrays.
const ROOM: u64 = 256 << 20;

/// How many of `memory` bytes may be read: a cube may be in memory twice while it is reordered.
fn most_read(memory: u64) -> u64 {
    MOST_READ.min(memory / 2)
}

/// Reads the samples, which also checks that all are finite, and looks for problems.
fn samples(
    path: &Path,
    wanted: Wanted,
    info: &CubeInfo,
    memory: u64,
    left: &mut u64,
) -> Result<Option<Vec<String>>> {
    let order = match info.assumed {
        true => Order::Array,
        false => Order::Stated,
    };
    if info.bytes <= *left {
        *left -= info.bytes;
        let cube = cube::load(path, wanted)?.into();
        return Ok(Some(survey::of_samples(&cube, order)));
    }
    // Only a part of larger arrays is read, unless they would have to be unpacked.
    let room = ROOM.min(memory / 2);
    if Bricks::counting(path, wanted, room)?.is_none() {
        return Ok(None);
    }
    let bricks = Arc::new(Bricks::open(path, wanted, room)?);
    let mut remarks = survey::of_samples(&bricks.clone().into(), order);
    bricks.check()?;
    remarks.push(format!(
        "only a part of the samples was checked: there are more than {}",
        bytes(most_read(memory))
    ));
    Ok(Some(remarks))
}

/// Whether these are the arrays of a picture: channels with metadata, as written by `render`, or only channels, as written by other
/// programs.
fn is_picture(headers: &[Header]) -> bool {
    let is_text = |header: &Header| match &header.dtype {
        Dtype::Other(descr) => descr.starts_with("<U"),
        Dtype::F16 | Dtype::F32 | Dtype::F64 => false,
    };
    let name = |header: &Header| header.name.clone().unwrap_or_default();
    let has_metadata = headers.iter().any(|h| name(h) == "metadata" && is_text(h));
    let is_channel = |header: &Header| aov::parse(&name(header)).is_ok_and(|aovs| !aovs.is_empty());
    let is_light = |header: &Header| name(header) == "radiance";
    let channels_alone =
        headers.iter().any(is_channel) && headers.iter().all(|h| is_channel(h) || is_light(h));
    headers.len() > 1 && (has_metadata || channels_alone)
}

/// Adds the rows of the array, and of the cube that it is, if it was inspected as one.
fn describe(info: &mut Info, header: &Header, cube: Option<&Cube>) {
    if let Some(name) = &header.name {
        info.row("array", name);
    }
    info.row("shape", shape(header));
    let size = size(header).map_or("unknown size".into(), bytes);
    let order = if header.fortran_order { "Fortran" } else { "C" };
    let kind = kind_of_samples(header);
    info.row(
        "samples",
        format!("{} ({kind}), {order} order, {size}", descr(header)),
    );
    match cube {
        None => {}
        Some(Ok(cube)) => as_cube(info, cube),
        Some(Err(error)) => {
            let (why, help) = why(error);
            info.row("usable", format!("no: {why}"));
            if !help.is_empty() {
                info.row("remedy", help);
            }
        }
    }
}

/// Adds what the samples are as a cube.
fn as_cube(info: &mut Info, known: &Known) {
    let Known { remarks, cube, .. } = known;
    let [h, w, t, c] = cube.shape;
    let colours = if c == 1 { "grey" } else { "red, green, blue" };
    info.row(
        "as a cube",
        format!("H = {h} rows, W = {w} columns, T = {t} time bins, C = {c} ({colours})"),
    );
    if cube.assumed {
        let text = format!(
            "{}, assumed; give any other order as `axes` in the source",
            cube.axes
        );
        info.row("axes", text);
    }
    for note in &cube.notes {
        info.row("says", note);
    }
    let usable = match known.at_sensor {
        false => "yes: as the file of a [source.cube]",
        true => {
            "after `nullray convert FILE --unwarp FILE --surface wall.glb -o wall.npy`: its times are those of arrival at its sensor"
        }
    };
    info.row("usable", usable);
    let unread = || {
        vec![format!(
            "samples not read: with those of the arrays before them more than {}",
            bytes(MOST_READ)
        )]
    };
    let remarks = remarks.clone().unwrap_or_else(unread);
    for remark in cube.remarks.iter().chain(&remarks) {
        info.row("remark", remark);
    }
}

fn usable(known: &Known) -> Value {
    let Known {
        remarks,
        cube,
        at_sensor,
    } = known;
    let [h, w, t, c] = cube.shape;
    let remarks = remarks
        .as_ref()
        .map(|remarks| [cube.remarks.as_slice(), remarks].concat());
    json!({
        "h": h, "w": w, "t": t, "c": c, "bytes": cube.bytes,
        "axes": cube.axes.to_string(), "axes_assumed": cube.assumed, "notes": cube.notes,
        "remarks": remarks, "times_at_sensor": at_sensor,
    })
}

fn data(header: &Header, cube: Option<&Cube>) -> Value {
    let usable = cube.and_then(|cube| cube.as_ref().ok()).map(usable);
    let problem = cube.and_then(|cube| cube.as_ref().err());
    let problem = problem.map(|error| why(error).0);
    json!({
        "name": header.name,
        "shape": header.shape,
        "dtype": descr(header),
        "order": if header.fortran_order { "F" } else { "C" },
        "bytes": size(header),
        "cube": usable,
        "problem": problem,
    })
}

fn why(error: &Error) -> (String, String) {
    match error {
        Error::Invalid(problem) | Error::Unsupported(problem) => {
            // The row already names the array; only the sample is named here.
            let place = match problem.place.rfind("sample") {
                Some(at) => format!(", {}", &problem.place[at..]),
                None => String::new(),
            };
            (format!("{}{place}", problem.what), problem.help.to_string())
        }
        other => (other.to_string(), String::new()),
    }
}

fn shape(header: &Header) -> String {
    let sizes: Vec<_> = header.shape.iter().map(usize::to_string).collect();
    match sizes.as_slice() {
        [one] => format!("({one},)"),
        sizes => format!("({})", sizes.join(", ")),
    }
}

/// The type in numpy's notation.
fn descr(header: &Header) -> String {
    let order = if header.big_endian { '>' } else { '<' };
    match &header.dtype {
        Dtype::F16 => format!("{order}f2"),
        Dtype::F32 => format!("{order}f4"),
        Dtype::F64 => format!("{order}f8"),
        Dtype::Other(descr) => descr.chars().take(100).collect(),
    }
}

/// What samples are, in words.
fn kind_of_samples(header: &Header) -> Cow<'static, str> {
    let descr = match &header.dtype {
        Dtype::F16 => return "half precision".into(),
        Dtype::F32 => return "single precision".into(),
        Dtype::F64 => return "double precision".into(),
        Dtype::Other(descr) => descr,
    };
    let Some((kind, bytes)) = simple(descr) else {
        return "neither numbers nor text".into();
    };
    match kind {
        'b' => "true or false".into(),
        'i' => format!("{}-bit integers", 8 * u128::from(bytes)).into(),
        'u' => format!("{}-bit integers from 0", 8 * u128::from(bytes)).into(),
        'f' => "floating-point numbers".into(),
        'c' => "complex numbers".into(),
        'S' | 'U' => "text".into(),
        _ => "neither numbers nor text".into(),
    }
}

/// The bytes of all samples, if the type gives the size of one.
fn size(header: &Header) -> Option<u64> {
    let sample = match &header.dtype {
        Dtype::F16 => 2,
        Dtype::F32 => 4,
        Dtype::F64 => 8,
        Dtype::Other(descr) => simple_size(descr)?,
    };
    let mut sizes = header.shape.iter();
    sizes.try_fold(sample, |bytes: u64, &n| bytes.checked_mul(n as u64))
}

/// The kind and the number of a type like "<i4".
fn simple(descr: &str) -> Option<(char, u64)> {
    let mut chars = descr.chars();
    let kind = chars.find(|c| !matches!(c, '<' | '>' | '|' | '='))?;
    Some((kind, chars.as_str().parse().ok()?))
}

/// The bytes of a sample of such a type; each character of "<U5" has 4 bytes.
fn simple_size(descr: &str) -> Option<u64> {
    let (kind, number) = simple(descr)?;
    match kind {
        'b' | 'i' | 'u' | 'f' | 'c' | 'S' | 'V' => Some(number),
        'U' => number.checked_mul(4),
        _ => None,
    }
}
