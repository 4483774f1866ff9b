//! The layouts of HDF5 files by known writers of captures.
//!
//! | writer | array | axes | times (metres of light path) |
//! |---|---|---|---|
//! | y-tal (`tal render`) | `H` | by `H_format`: 1 (T, Sx, Sy), 2 (T, Lx, Ly, Sx, Sy), 3 (T, Si), 4 (T, Li, Si) | `t_start`, `delta_t`; with the ways to the laser and the sensor where `t_accounts_first_and_last_bounces` |
//! | Zaragoza NLOS data set | `data` | (colours, T, bounces, sx, sy[, lx, ly]) or its reverse; bounces are added up | `t0`, `deltaT`, with both ways |
//! | phasor fields (`.mat`, version 7.3) | `dataset/data` | in MATLAB (lasers, camera, T): the lasers are what the picture is of, since light goes both ways | `dataset/t0`, `dataset/deltat`, with both ways |
//! | TransientNeRF, synthetic | `data` | (H, W, T, 4): red, green, blue and coverage | not said |
//! | this program | `data` | by its attribute `axes` | its attributes `start`, `bin_width` |
//! | others | the only one, or `data` | by its attribute `axes`, the labels of its dimensions, or the names of their scales | its attributes `start`, `bin_width` |
//!
//! Sources: y-tal 0.20, `tal.io`, `tal.enums`; Galindo et al. 2019, "Z-NLOS" (format of the files); Liu et al. 2019,
//! "Phasor field virtual wave optics" (its data); Malik et al. 2023, "Transient Neural Radiance Fields" (its loader).
//!
//! Sx, Sy, Lx and Ly count along the wall. Rows of the cube are Sx and columns are Sy; the file gives the position of each point, so it
//! does not matter which of them is called horizontal.

use glam::DVec3;

use super::super::axes::{Axes, Axis};
use super::super::selection::{Selection, Taken, name_and_choices};
use super::super::wall::{Wall, columns_of};
use super::super::wanted::{FileTimes, Wanted};
use super::file::{Array, File};
use crate::error::{Error, Result};

/// An array of a file, with its known properties.
pub(super) struct Known {
    pub array: Array,
    pub selection: Selection,
    pub assumed: bool,
    pub wall: Option<Wall>,
    pub notes: Vec<String>,
}

/// The layout of an array.
struct Layout {
    /// Its path.
    array: String,
    /// The axes; `None` if the file does not give them.
    axes: Option<Vec<Axis>>,
    /// The remaining doubt about the axes in that case, if there is more, and the advice.
    doubt: Option<String>,
    unsaid: String,
    /// Columns of the picture, if its points are a list.
    columns: Option<usize>,
    without_alpha: bool,
    assumed: bool,
    times: Option<FileTimes>,
    wall: Option<Wall>,
    notes: Vec<String>,
}

/// The array `wanted`, as the file and the caller describe it.
pub(super) fn known(file: &File, wanted: Wanted) -> Result<Known> {
    let (name, choices) = match wanted.array {
        Some(text) => {
            let (name, choices) = name_and_choices(text);
            (Some(name), choices)
        }
        None => (None, Vec::new()),
    };
    let mut layout = layout(file, name)?;
    let mut axes = layout.axes.take();
    if let Some(said) = wanted.axes {
        axes = Some(said.list().to_vec());
        layout.assumed = false;
        // Rows and columns given by name are those of the array itself.
        if said.list().contains(&Axis::Row) {
            layout.columns = None;
        }
    }
    let array = file.array(&layout.array)?;
    let Some(axes) = axes else {
        let what = layout.doubt.unwrap_or_else(|| {
            let sizes = array.sizes();
            format!(
                "the axes of {} of shape {sizes:?} are unknown",
                layout.array
            )
        });
        return Err(Error::invalid(
            file.path(),
            &layout.array,
            what,
            layout.unsaid,
        ));
    };
    let taken = Taken {
        axes: &axes,
        choices: &choices,
        columns: layout.columns,
        without_alpha: layout.without_alpha,
        channels: wanted.channels,
    };
    let selection = Selection::new(array.sizes(), array.dtype()?, &taken)
        .map_err(|(what, help)| Error::invalid(file.path(), &layout.array, what, help))?;
    // Positions of points that are not the pixels say nothing about them.
    let pixels = |axis| {
        let at = selection.axes.list().iter().position(|a| *a == axis);
        at.map_or(1, |at| selection.sizes[at])
    };
    let size = [pixels(Axis::Row), pixels(Axis::Column)];
    let wall = layout.wall.filter(|wall| wall.size == size);
    if let Some(wall) = &wall {
        layout.notes.push(described(wall));
    }
    Ok(Known {
        array,
        selection,
        assumed: layout.assumed,
        wall,
        notes: layout.notes,
    })
}

/// The time axis of the array of this name, or of the default one.
pub(super) fn times_of(file: &File, name: Option<&str>) -> Result<Option<FileTimes>> {
    let name = name.map(|name| name_and_choices(name).0);
    Ok(layout(file, name)?.times)
}

/// The layout, recognised by the arrays in the file.
fn layout(file: &File, name: Option<&str>) -> Result<Layout> {
    let (groups, arrays) = file.names("")?;
    let has = |name: &str| arrays.iter().any(|known| known == name);
    let is = |known: &str| name.is_none_or(|name| name.trim_start_matches('/') == known);
    if has("H") && has("H_format") && is("H") {
        return tal(file, &arrays);
    }
    if has("data") && has("cameraGridPositions") && is("data") {
        return zaragoza(file);
    }
    if groups.iter().any(|group| group == "dataset") && is("dataset/data") {
        return phasor_fields(file);
    }
    let name = match name {
        Some(name) => name.to_string(),
        None => only(file, &arrays)?,
    };
    plain(file, name)
}

/// The name of the only array, or of the one called `data`.
fn only(file: &File, arrays: &[String]) -> Result<String> {
    if arrays.iter().any(|name| name == "data") {
        return Ok("data".into());
    }
    let mut cubes: Vec<_> = (file.arrays()?.into_iter())
        .filter(|array| array.shape.len() >= 2)
        .filter_map(|array| array.name)
        .collect();
    match cubes.len() {
        1 => Ok(cubes.remove(0)),
        0 => {
            let what = "the file holds no array of two or more axes";
            Err(Error::invalid(file.path(), "", what, "check the file"))
        }
        _ => {
            let what = format!("the file holds several arrays: {}", cubes.join(", "));
            Err(Error::invalid(
                file.path(),
                "",
                what,
                format!("name one of them, like array = {:?}", cubes[0]),
            ))
        }
    }
}

/// An array of an unknown writer, or of this program.
fn plain(file: &File, name: String) -> Result<Layout> {
    let array = file.array(&name)?;
    let times = match (array.number("start"), array.number("bin_width")) {
        (Some(start), Some(width)) if width > 0.0 => Some(FileTimes {
            start,
            width,
            at_sensor: false,
        }),
        _ => None,
    };
    let mut notes = Vec::new();
    let sizes: Vec<usize> = array.sizes().iter().map(|n| *n as usize).collect();
    let (mut doubt, mut unsaid, mut assumed, mut without_alpha) =
        (None, String::new(), false, false);
    let axes = match said_axes(file, &array) {
        Ok(Some((axes, by))) => {
            notes.push(format!("axes {axes}, by its {by}"));
            Some(axes)
        }
        Ok(None) => {
            assumed = true;
            // MATLAB stores axes in reverse.
            let is_reversed = array.text("MATLAB_class").is_some();
            let mut own = sizes.clone();
            if is_reversed {
                own.reverse();
                notes.push(format!(
                    "written by MATLAB, whose axes are stored in reverse: size {own:?} there"
                ));
            }
            without_alpha = matches!(*own, [_, _, _, 4]) && !is_reversed;
            Axes::assumed(&own)
                .map(|axes| if is_reversed { axes.reversed() } else { axes })
                .map_err(|(what, help)| (doubt, unsaid) = (Some(what), help.into()))
                .ok()
        }
        Err((what, help)) => {
            (doubt, unsaid) = (Some(what), help);
            None
        }
    };
    if let Some(FileTimes { start, width, .. }) = times {
        notes.push(format!(
            "start {start} m, bin_width {width} m, by its attributes"
        ));
    }
    if without_alpha {
        notes.push("the last axis has 4 entries: red, green and blue, and the coverage, which is left out (as of TransientNeRF)".into());
    }
    Ok(Layout {
        doubt,
        unsaid,
        axes: axes.map(|axes| axes.list().to_vec()),
        array: name,
        columns: None,
        without_alpha,
        assumed,
        times,
        wall: None,
        notes,
    })
}

/// The order of an array's axes in the file, and its origin: its attribute `axes`, or the names of its dimensions.
fn said_axes(
    file: &File,
    array: &Array,
) -> std::result::Result<Option<(Axes, &'static str)>, (String, String)> {
    if let Some(text) = array.text("axes") {
        let axes = text.parse::<Axes>().map_err(|error| {
            let what = format!("its attribute `axes` is {text:?}: {error}");
            (what, super::super::axes::NAME_AXES.into())
        });
        return axes.map(|axes| Some((axes, "attribute `axes`")));
    }
    let Some((names, by)) = file.axis_names(array) else {
        return Ok(None);
    };
    let axes = Axes::by_names(&names)?;
    Ok(axes.map(|axes| (axes, by)))
}

/// y-tal.
fn tal(file: &File, names: &[String]) -> Result<Layout> {
    use Axis::{Choice, Column, Row, Time};
    let format = file.number("H_format")?;
    let axes: Vec<Axis> = match format {
        Some(1.0) => vec![Time, Row, Column],
        Some(2.0) => vec![Time, Choice, Choice, Row, Column],
        Some(3.0) => vec![Time, Column],
        Some(4.0) => vec![Time, Choice, Column],
        other => {
            let what = match other {
                Some(other) => format!("a format of {other} is unknown"),
                None => "it is not one number".into(),
            };
            let help = "1 (T, Sx, Sy), 2 (T, Lx, Ly, Sx, Sy), 3 (T, Si) and 4 (T, Li, Si) are read";
            return Err(Error::unsupported(file.path(), "H_format", what, help));
        }
    };
    let is_list = !axes.contains(&Row);
    let points = places(file, "sensor_grid_xyz", false)?;
    let wall = wall(file, points, ["sensor_grid_normals", "sensor_xyz"], is_list)?;
    // Written with and without a second "bounce"; both names begin with this.
    let both = names
        .iter()
        .find(|name| name.starts_with("t_accounts_first"));
    let at_sensor = match both {
        Some(name) => file.number(name)? == Some(1.0),
        None => false,
    };
    let start = file.number("t_start")?;
    let mut notes = vec![format!(
        "written by y-tal, H_format {} ({})",
        format.unwrap_or_default(),
        Axes::of(axes.clone())
    )];
    if matches!(format, Some(1.0 | 3.0)) {
        notes.extend(confocal(file, ["laser_grid_xyz", "sensor_grid_xyz"])?);
    }
    if start.is_none() {
        notes.push("t_start is not given: 0 m is assumed".into());
    }
    Ok(Layout {
        array: "H".into(),
        axes: Some(axes),
        doubt: None,
        unsaid: String::new(),
        columns: columns(file, "sensor_grid_xyz", &wall, is_list)?,
        without_alpha: false,
        assumed: false,
        times: times(file, start, "delta_t", at_sensor, &mut notes)?,
        wall,
        notes,
    })
}

/// The Zaragoza NLOS data set. The order of its axes is certain if only one of the two has bins and points where the file says they are.
fn zaragoza(file: &File) -> Result<Layout> {
    use Axis::{Channel, Choice, Column, Row, Sum, Time};
    let array = file.array("data")?;
    let sizes = array.sizes();
    let points = places(file, "cameraGridPositions", false)?;
    let grid = points.as_ref().map(|(_, size)| *size);
    let bins = file.number("t")?;
    let orders: [&[Axis]; 4] = [
        &[Channel, Time, Sum, Row, Column],
        &[Row, Column, Sum, Time, Channel],
        &[Channel, Time, Sum, Row, Column, Choice, Choice],
        &[Choice, Choice, Row, Column, Sum, Time, Channel],
    ];
    let size = |order: &[Axis], axis| {
        let at = order.iter().position(|a| *a == axis);
        at.map_or(0, |at| sizes[at])
    };
    let fits = |order: &&&[Axis]| {
        order.len() == sizes.len()
            && matches!(size(order, Channel), 1 | 3)
            && bins.is_none_or(|bins| bins == size(order, Time) as f64)
            && grid.is_none_or(|[rows, columns]| {
                [size(order, Row), size(order, Column)] == [rows as u64, columns as u64]
            })
    };
    let fitting: Vec<_> = orders.iter().filter(fits).collect();
    let axes = match *fitting {
        [one] => Some(one.to_vec()),
        _ => None,
    };
    let mut notes = vec!["of the Zaragoza NLOS data set".into()];
    if let Some(axes) = &axes {
        let order = Axes::of(axes.clone());
        notes.push(format!(
            "axes {order}, by the numbers of bins and points; bounces (S) are added up"
        ));
    }
    if sizes.len() == 5 {
        notes.extend(confocal(
            file,
            ["laserGridPositions", "cameraGridPositions"],
        )?);
    }
    let start = file.number("t0")?;
    Ok(Layout {
        array: "data".into(),
        axes,
        doubt: None,
        unsaid: "say in `axes` \"C T S H W\" (colours, times, bounces, points), \"C T S H W L L\" (and points that the laser lights), or \
                 the reverse: \"H W S T C\", \"L L H W S T C\""
            .into(),
        columns: None,
        without_alpha: false,
        assumed: false,
        times: times(file, start, "deltaT", true, &mut notes)?,
        wall: wall(file, points, ["cameraGridNormals", "cameraPosition"], false)?,
        notes,
    })
}

/// Phasor fields: MATLAB's (lasers, camera, T), which HDF5 stores in reverse.
fn phasor_fields(file: &File) -> Result<Layout> {
    let points = places(file, "dataset/laserPos", true)?;
    let wall = wall(
        file,
        points,
        ["dataset/laserNorm", "dataset/laserOrigin"],
        true,
    )?;
    let mut notes = vec![
        "phasor-field data: a picture of the points that the laser lit, with source and sensor exchanged".into(),
    ];
    let start = file.number("dataset/t0")?;
    Ok(Layout {
        columns: columns(file, "dataset/laserPos", &wall, true)?,
        array: "dataset/data".into(),
        axes: Some(vec![Axis::Time, Axis::Single, Axis::Column]),
        doubt: None,
        unsaid: String::new(),
        without_alpha: false,
        assumed: false,
        times: times(file, start, "dataset/deltat", true, &mut notes)?,
        wall,
        notes,
    })
}

/// The warning if the laser lit each point when that was recorded, so that their light is not that of one flash.
fn confocal(file: &File, [laser, sensor]: [&str; 2]) -> Result<Option<String>> {
    let (lit, seen) = (places(file, laser, false)?, places(file, sensor, false)?);
    let is_confocal = match (&lit, &seen) {
        (Some((lit, _)), Some((seen, _))) => seen.len() > 1 && lit == seen,
        _ => false,
    };
    Ok(is_confocal.then(|| {
        "confocal: each point was recorded while the laser lit that point, so that a picture of all points shows as many flashes as \
         points, and no light that travels from one point to another"
            .into()
    }))
}

/// Points and their arrangement: (3, a, b) and (a, b, 3) are a rows of b columns, (n, 3) and (3, n) a list. `transposed` decides for 3 ×
/// 3.
type Points = (Vec<DVec3>, [usize; 2]);

fn places(file: &File, name: &str, transposed: bool) -> Result<Option<Points>> {
    let Some((numbers, sizes)) = file.numbers(name)? else {
        return Ok(None);
    };
    let sizes: Vec<usize> = sizes.iter().map(|n| *n as usize).collect();
    // For a list of three points only the format says which axis has the coordinates.
    let (size, coordinates_first) = match *sizes {
        [3, n] if transposed || n != 3 => ([1, n], true),
        [n, 3] => ([1, n], false),
        [3, n] => ([1, n], true),
        [a, b, 3] => ([a, b], false),
        [3, a, b] => ([a, b], true),
        _ => {
            let what =
                format!("an array of shape {sizes:?} is neither a list nor a grid of points");
            return Err(Error::invalid(file.path(), name, what, "check the file"));
        }
    };
    let count = size[0] * size[1];
    let point = |n: usize| match coordinates_first {
        true => DVec3::new(numbers[n], numbers[count + n], numbers[2 * count + n]),
        false => DVec3::new(numbers[3 * n], numbers[3 * n + 1], numbers[3 * n + 2]),
    };
    Ok(Some(((0..count).map(point).collect(), size)))
}

/// The surface through the points, from the arrays of normals and of the sensor's position.
fn wall(
    file: &File,
    points: Option<Points>,
    [normals, sensor]: [&str; 2],
    is_list: bool,
) -> Result<Option<Wall>> {
    let Some((points, mut size)) = points else {
        return Ok(None);
    };
    if is_list {
        let Some(columns) = columns_of(&points) else {
            return Ok(None);
        };
        size = [points.len() / columns, columns];
    }
    let normals = match places(file, normals, is_list) {
        Ok(Some((normals, _))) if normals.len() == points.len() => normals,
        _ => Vec::new(),
    };
    let sensor = file.numbers(sensor)?.and_then(|(place, _)| match *place {
        [x, y, z] => Some(DVec3::new(x, y, z)),
        _ => None,
    });
    Ok(Some(Wall {
        size,
        points,
        normals,
        sensor,
    }))
}

/// The number of columns of the grid in a list of points.
fn columns(file: &File, name: &str, wall: &Option<Wall>, is_list: bool) -> Result<Option<usize>> {
    match (is_list, wall) {
        (false, _) => Ok(None),
        (true, Some(wall)) => Ok(Some(wall.size[1])),
        (true, None) => Err(Error::unsupported(
            file.path(),
            name,
            "the points of the list do not form a grid of rows and columns",
            "give a grid of points on a plane, row after row, all rows alike",
        )),
    }
}

/// The time axis, by the name of the width of a bin.
fn times(
    file: &File,
    start: Option<f64>,
    width: &str,
    at_sensor: bool,
    notes: &mut Vec<String>,
) -> Result<Option<FileTimes>> {
    let Some(bin) = file.number(width)? else {
        return Ok(None);
    };
    if !(bin > 0.0 && bin.is_finite()) {
        let what = format!("bins {bin} m wide do not form a time axis");
        return Err(Error::invalid(
            file.path(),
            width,
            what,
            "it must be above 0, in metres of light path",
        ));
    }
    let start = start.unwrap_or(0.0);
    notes.push(format!(
        "bin 0 starts at {start} m of light path; bins are {bin} m wide"
    ));
    notes.push(match at_sensor {
        true => {
            "times include the paths from the laser to the wall and from the wall to the sensor"
                .into()
        }
        false => "times are measured from the wall to the wall".into(),
    });
    Ok(Some(FileTimes {
        start,
        width: bin,
        at_sensor,
    }))
}

fn described(wall: &Wall) -> String {
    let [rows, columns] = wall.size;
    let place = |p: DVec3| format!("({:.4}, {:.4}, {:.4})", p.x, p.y, p.z);
    let corner = |i: usize, j: usize| place(wall.points[i * columns + j]);
    let sensor = wall.sensor.map_or(String::new(), |p| {
        format!("; the sensor is at {}", place(p))
    });
    format!(
        "pixels are points of a wall: first {}, end of the first row {}, of the last {}{sensor}",
        corner(0, 0),
        corner(0, columns - 1),
        corner(rows - 1, columns - 1)
    )
}
