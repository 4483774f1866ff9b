//! Time-resolved sources.

use super::context::Context;
use super::{binding, object, pose, radiance};
use crate::error::Result;
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::model::{
    BinValues, CaptureCamera, Clock, CubeSource, Mapping, Object, Pulse, Source, SourceKind,
    TimeFilter,
};
use crate::scene::names;
use crate::scene::values::NumberOrVector;
use crate::spacetime::{Event, Quantity};

/// All sources; `quantity` is that of sources that do not say their own.
pub(super) fn resolve_all(
    cx: &Context,
    sources: &[At<file::Source>],
    objects: &[Object],
    quantity: Quantity,
) -> Result<Vec<Source>> {
    let explicit = sources.iter().filter_map(|at| at.value.name.as_ref());
    object::refuse_duplicates(cx, explicit, "source")?;
    let names = names::unique(sources.iter().map(|at| entry_names(&at.value)).collect());
    let mut bindings = binding::Bindings::new(cx, objects);
    let mut resolved = Vec::with_capacity(sources.len());
    for (at, name) in sources.iter().zip(names) {
        resolved.push(Source {
            name,
            kind: kind(cx, at)?,
            binding: bindings.bind(at)?,
            quantity: match &at.value.radiance {
                Some(own) => radiance::resolve(cx, own)?,
                None => quantity,
            },
            span: binding::span(at),
        });
    }
    Ok(resolved)
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
        (Some(source), None) => cube(cx, source).map(SourceKind::Cube),
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
    let path = cx.path(&cube.file, ["npy", "npz"])?;
    let is_npy = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("npy"));
    if let (Some(array), true) = (&cube.array, is_npy) {
        let help = "leave `array` out, or name an .npz file";
        return Err(cx.refuse(
            array,
            "an .npy file holds a single array without a name",
            help,
        ));
    }
    Ok(CubeSource {
        path,
        array: cx.optional_text(&cube.array, "the array's name")?,
        mapping: mapping(cx, cube)?,
        clock: clock(cx, cube)?,
        start: cx.time(&cube.start)?,
        bin_width: cx.duration(&cube.bin_width, "`bin_width`")?,
        values: match cube.values {
            file::BinValues::PerBin => BinValues::PerBin,
            file::BinValues::Density => BinValues::Density,
        },
        filter: match cube.filter {
            file::TimeFilter::Nearest => TimeFilter::Nearest,
            file::TimeFilter::Linear => TimeFilter::Linear,
            file::TimeFilter::Cubic => TimeFilter::Cubic,
            file::TimeFilter::CubicMeans => TimeFilter::CubicMeans,
        },
        scale: cube.scale.0,
    })
}

fn mapping(cx: &Context, cube: &file::Cube) -> Result<Mapping> {
    cx.exclusive((&cube.uv, "uv"), (&cube.capture, "capture"))?;
    if let Some(camera) = &cube.capture {
        return capture(cx, camera).map(Mapping::Capture);
    }
    let Some(uv) = &cube.uv else {
        return Ok(Mapping::Uv { set: 0 });
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
    })
}

fn capture(cx: &Context, at: &At<file::Capture>) -> Result<CaptureCamera> {
    let pose = pose::resolve(cx, at, &(&at.value).into())?;
    let horizontal_fov = match (&at.value.hfov, pose.gltf_fov) {
        (Some(hfov), _) => pose::fov(cx, hfov)?,
        (None, Some((Some(horizontal), _))) => horizontal,
        (None, gltf) => {
            let what = match gltf {
                Some(_) => "the glTF camera says no horizontal field of view",
                None => "the key `hfov` is missing",
            };
            return Err(cx.refuse(
                at,
                what,
                "add the horizontal field of view, like hfov = \"40 deg\"",
            ));
        }
    };
    Ok(CaptureCamera {
        eye: pose.eye,
        axes: pose.axes,
        horizontal_fov,
    })
}

fn clock(cx: &Context, cube: &file::Cube) -> Result<Clock> {
    match cube.clock.value {
        file::Clock::World => Ok(Clock::World),
        file::Clock::Object => Ok(Clock::Object),
        file::Clock::Capture if cube.capture.is_some() => Ok(Clock::Capture),
        file::Clock::Capture => {
            let what = "the clock of the capture camera needs to know where that camera was";
            let help = "add capture = { eye = […], look_at = […], hfov = \"…\" }, or say clock = \"world\"";
            Err(cx.refuse(&cube.clock, what, help))
        }
    }
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
