//! Time-resolved sources.

use super::context::{Context, has_extension};
use super::{binding, object, pose, radiance};
use crate::error::Result;
use crate::io::cube::FORMATS;
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::model::{
    CaptureCamera, Clock, CubeData, CubeSource, Mapping, Object, Pulse, Source, SourceKind,
};
use crate::scene::names;
use crate::scene::values::NumberOrVector;
use crate::spacetime::{Event, Quantity};

/// All sources; `quantity` is that of sources that give none of their own.
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
                Some(own) => radiance::of_source(cx, own)?,
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
    Ok(CubeSource {
        data: data(cx, cube)?,
        mapping: mapping(cx, cube)?,
        clock: clock(cx, cube)?,
        start: cx.time(&cube.start)?,
        bin_width: cx.duration(&cube.bin_width, "`bin_width`")?,
        values: cube.values,
        filter: cube.filter,
        scale: cube.scale.0,
    })
}

fn data(cx: &Context, cube: &file::Cube) -> Result<CubeData> {
    let memory = &cx.inputs.memory;
    let alone = |what| {
        let refuse = |array| cx.refuse(array, what, "leave `array` out, or name an .npz file");
        cube.array
            .as_ref()
            .map_or(Ok(()), |array| Err(refuse(array)))
    };
    if let Some(cube) = cx.in_memory(&cube.file, |name| memory.cube(name))? {
        alone("a cube in memory is a single array without a name")?;
        return Ok(CubeData::Memory(cube));
    }
    let extensions: Vec<_> = FORMATS.iter().map(|format| format.extension).collect();
    let path = cx.path(&cube.file, &extensions)?;
    if !FORMATS
        .iter()
        .any(|f| f.named && has_extension(&path, &[f.extension]))
    {
        alone("an .npy file holds a single array without a name")?;
    }
    let array = cx.optional_text(&cube.array, "the array's name")?;
    Ok(CubeData::File { path, array })
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
        (Some(hfov), _) => pose::fov(cx, hfov, at.value.projection.value)?,
        (None, Some((Some(horizontal), _))) => horizontal,
        (None, gltf) => {
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
    Ok(CaptureCamera {
        eye: pose.eye,
        axes: pose.axes,
        projection: at.value.projection.value,
        horizontal_fov,
    })
}

fn clock(cx: &Context, cube: &file::Cube) -> Result<Clock> {
    match cube.clock.value {
        Clock::Capture if cube.capture.is_none() => {
            let what = "the clock of the capture camera needs to know where that camera was";
            let help = "add capture = { eye = […], look_at = […], hfov = \"…\" }, or set clock = \"world\"";
            Err(cx.refuse(&cube.clock, what, help))
        }
        clock => Ok(clock),
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
