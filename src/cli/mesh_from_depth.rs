//! `nullray mesh-from-depth`.

use std::path::Path;

use nullray::io::budget::Budget;
use nullray::io::cube::{self, Wanted};
use nullray::io::gltf;
use nullray::io::npy;
use nullray::light::depth::{DepthMesh, FirstLight, Flash, PixelRays, first_light};
use nullray::scene::model::CaptureCamera;
use nullray::spacetime::SPEED_OF_LIGHT;
use nullray::{Error, Result};

use super::args::{DepthKind, MeshFromDepthArguments};
use super::check::Names;
use super::console::{print, warn};
use super::failure::refused;
use super::names::named_after;
use super::output::extension;
use super::times::Times;

/// The default fractions: of a pixel's highest value, above which its first maximum counts; and of the brightest pixel, below which a pixel
/// is in shadow.
const PEAK_FRACTION: f64 = 0.2;
const DARK_FRACTION: f64 = 0.02;

/// Builds the mesh from a capture's distances and writes it; names are checked before anything is read.
pub fn run(arguments: &MeshFromDepthArguments) -> Result<()> {
    let output = match &arguments.output {
        Some(path) => path.clone(),
        None => named_after(Some(&arguments.input), ".glb"),
    };
    if extension(&output) != "glb" {
        let option = format!("-o {}", output.display());
        return Err(refused(
            option,
            "the mesh is binary glTF",
            "give a name that ends in .glb",
        ));
    }
    let option = format!("-o {}", output.display());
    Names::new([&arguments.input], "this is the input file", "").check(&option, &output)?;
    refuse_unread(arguments)?;
    let camera = camera(arguments)?;
    let budget = Budget::new(arguments.memory.bytes());
    let (rays, distances) = match arguments.from {
        DepthKind::FirstLight => by_first_light(arguments, &camera, &budget)?,
        DepthKind::Distance | DepthKind::Depth => by_map(arguments, &camera, &budget)?,
    };
    let made = rays.mesh(&distances, arguments.max_step);
    if made.mesh.triangles.is_empty() {
        let what = "no three neighbouring pixels lie on one surface";
        let help = "check the camera, the lamp and the times; a larger --max-step joins pixels that are farther apart";
        return Err(Error::invalid(&arguments.input, "", what, help));
    }
    gltf::save(&output, "surface", &made.mesh)?;
    if arguments.quiet.on {
        return Ok(());
    }
    report(&output, &made, &distances)
}

/// Refuses options about arrival times when a map is read.
fn refuse_unread(arguments: &MeshFromDepthArguments) -> Result<()> {
    if arguments.from == DepthKind::FirstLight {
        return Ok(());
    }
    let given = [
        ("--lamp", arguments.lamp.is_some()),
        ("--lamp-time", arguments.lamp_time.is_some()),
        ("--start", arguments.start.is_some()),
        ("--bin-width", arguments.bin_width.is_some()),
        ("--axes", arguments.axes.is_some()),
        ("--medium-index", arguments.medium_index.is_some()),
        ("--peak-fraction", arguments.peak_fraction.is_some()),
        ("--dark-fraction", arguments.dark_fraction.is_some()),
    ];
    match given.into_iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => {
            let what = "it applies to a cube of times of arrival, but --from names a map";
            Err(refused(option, what, "leave it out, or leave out --from"))
        }
        None => Ok(()),
    }
}

/// The camera that the options describe.
fn camera(arguments: &MeshFromDepthArguments) -> Result<CaptureCamera> {
    let (eye, up) = (arguments.eye, arguments.up);
    let Some(forward) = (arguments.look_at - eye).try_normalize() else {
        let what = "it is where the pinhole is";
        return Err(refused(
            "--look-at",
            what,
            "give a point on the forward axis",
        ));
    };
    // For parallel vectors, rounding leaves a small remainder.
    let across = forward.cross(up);
    let is_across = across.length() > 1e-9 * up.length();
    let Some(right) = across.try_normalize().filter(|_| is_across) else {
        let what = "it lies along the forward axis";
        return Err(refused(
            "--up",
            what,
            "give a direction that is up in the picture",
        ));
    };
    let fov = arguments.fov.radians();
    if !(fov > 0.0 && fov < std::f64::consts::PI) {
        let what = "a pinhole camera sees between 0 and 180 degrees";
        return Err(refused("--fov", what, "give an angle like \"40 deg\""));
    }
    Ok(CaptureCamera {
        fov_axis: arguments.fov_axis.into(),
        near_clip: arguments.near_clip,
        ..CaptureCamera::new(eye, [right, right.cross(forward), forward], fov)
    })
}

/// Distances from the first arrival of light in each pixel.
fn by_first_light(
    arguments: &MeshFromDepthArguments,
    camera: &CaptureCamera,
    budget: &Budget,
) -> Result<(PixelRays, Vec<f64>)> {
    let Some(position) = arguments.lamp else {
        let what = "the position of the pulse is missing";
        return Err(refused(
            "--lamp",
            what,
            "add its place, like --lamp 1.2,2.8,1",
        ));
    };
    // Options take precedence over the file's time axis.
    let times = Times::of(
        (&arguments.input, arguments.array.as_deref()),
        [&arguments.start, &arguments.bin_width],
        arguments.medium_index,
        arguments.quiet.on,
    )?;
    if let Some(clock) = times.clock.as_ref().filter(|clock| *clock != "capture") {
        let what = format!(
            "its times are those of emission (clock = \"{clock}\"), not of arrival at a camera"
        );
        let help = "give a cube by the clock of its camera, as `nullray bake --camera` makes it, or `nullray convert --warp`";
        return Err(Error::invalid(&arguments.input, "", what, help));
    }
    let Some(width) = times
        .width
        .filter(|width| *width > 0.0 && width.is_finite())
    else {
        let what = "the width of a bin is not known, or not above 0";
        return Err(refused(
            "--bin-width",
            what,
            "add it, like --bin-width \"0.05 m\"",
        ));
    };
    // The memory is reserved before anything is read.
    let wanted = Wanted {
        array: arguments.array.as_deref(),
        axes: arguments.axes.as_ref(),
        memory: Some(arguments.memory.bytes()),
        ..Wanted::default()
    };
    let info = cube::inspect(&arguments.input, wanted)?;
    budget.take(info.bytes, &arguments.input)?;
    let [h, w, ..] = info.shape;
    take_mesh(budget, [h, w], &arguments.input)?;
    let cube = cube::load(&arguments.input, wanted)?;
    let rays = PixelRays::new(camera, [w, h]);
    let first = FirstLight {
        peak_fraction: arguments.peak_fraction.unwrap_or(PEAK_FRACTION),
        dark_fraction: arguments.dark_fraction.unwrap_or(DARK_FRACTION),
    };
    let arrivals = first_light(&cube, times.start.unwrap_or(0.0), width, &first);
    let lamp_time = arguments.lamp_time.as_ref();
    let flash = Flash {
        position,
        time: lamp_time.map_or(0.0, |time| time.metres(SPEED_OF_LIGHT)),
    };
    let distances = rays.distances(&arrivals, &flash, times.medium_index.unwrap_or(1.0));
    Ok((rays, distances))
}

/// Distances from a map of distances or depths.
fn by_map(
    arguments: &MeshFromDepthArguments,
    camera: &CaptureCamera,
    budget: &Budget,
) -> Result<(PixelRays, Vec<f64>)> {
    let file = &arguments.input;
    let is_archive = extension(file) == "npz";
    let kind = match arguments.from {
        DepthKind::Depth => "depth",
        _ => "distance",
    };
    let array = arguments.array.as_deref().or(is_archive.then_some(kind));
    let map = npy::load_plain(file, array, budget)?;
    let [h, w] = *map.shape.as_slice() else {
        let what = format!("an array of shape {:?} is not a map of {kind}s", map.shape);
        let help = format!("give an array (rows, columns) of metres, named {kind} in an .npz file");
        return Err(Error::invalid(file, "", what, help));
    };
    take_mesh(budget, [h, w], file)?;
    let rays = PixelRays::new(camera, [w, h]);
    let distances = match arguments.from {
        DepthKind::Depth => rays.distances_of_depths(&map.samples.into_f64()),
        _ => map.samples.into_f64(),
    };
    Ok((rays, distances))
}

/// Bytes per pixel of rays, distances and mesh, and of the file that is written.
const PIXEL: u64 = 200;

/// Reserves the memory for this many rows and columns.
fn take_mesh(budget: &Budget, [h, w]: [usize; 2], file: &Path) -> Result<()> {
    budget.take(PIXEL.saturating_mul(h as u64 * w as u64), file)
}

fn report(output: &Path, made: &DepthMesh, distances: &[f64]) -> Result<()> {
    let DepthMesh {
        mesh,
        unknown,
        torn,
        ..
    } = made;
    // A wrong unit shows in these numbers.
    let known = || {
        distances
            .iter()
            .copied()
            .filter(|d| *d > 0.0 && d.is_finite())
    };
    let [nearest, farthest] = [
        known().fold(f64::INFINITY, f64::min),
        known().fold(0.0, f64::max),
    ];
    let shown = |metres: f64| format!("{metres:.4e}").parse().unwrap_or(metres);
    print(&format!(
        "wrote {}: {} triangles, {} vertices; texture coordinates are those of the picture (uv = 0)\n\
         surfaces are {} to {} m from the camera; {torn} pairs of neighbouring pixels are not joined, as they lie on different \
         surfaces\n",
        output.display(),
        mesh.triangles.len(),
        mesh.positions.len(),
        shown(nearest),
        shown(farthest),
    ))?;
    if *unknown > 0 {
        let pixels = distances.len();
        let warning =
            format!("{unknown} of {pixels} pixels have no distance: the mesh has holes there");
        warn(false, [&warning]);
    }
    Ok(())
}
