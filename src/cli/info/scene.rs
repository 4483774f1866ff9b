//! The contents of a scene file; the files that it names are not loaded.

use std::path::Path;

use nullray::Result;
use nullray::colour::Continuation;
use nullray::io::cube::{self, Channels, CubeInfo};
use nullray::render::metadata;
use nullray::render::plan::{self, bytes};
use nullray::scene::Overrides;
use nullray::scene::model::{
    Beam, BinValues, Binding, Catalogue, Clock, CubeBacks, CubeData, CubeSource, EmissionProfile,
    Equations, Geometry, Light, LightKind, Mapping, Object, Scene, Shape, Sky, SkyRadiance, Source,
    SourceKind, TimeBins, TimeFilter,
};
use serde_json::{Value, json};

use super::{Info, camera};
use crate::cli::builtin;

pub fn info(path: &Path, memory: u64) -> Result<Info> {
    let scene = builtin::read(path)?.scene(&Overrides::default())?;
    let mut info = Info::new("scene", "nullray scene");
    camera::rows(&mut info, &scene);
    info.list("object", &scene.objects, object);
    info.list("light", &scene.lights, |l| light(&scene, l));
    if let Some(sky) = &scene.sky {
        info.row("sky", self::sky(sky));
    }
    info.list("source", &scene.sources, |s| source(&scene, s));
    // Only headers of files are read; an unreadable one is shown as a row, not an error, because the scene may still be unfinished.
    for source in scene.sources.iter().take(super::MOST) {
        if let SourceKind::Cube(cube) = &source.kind {
            cube_rows(&mut info, &source.name, cube, memory);
        }
    }
    settings(&mut info, &scene);
    let mut warnings = plan::unread(&scene);
    warnings.extend(plan::contradicted(&scene));
    info.list("warning", &warnings, String::clone);
    info.data("warnings", warnings);
    info.names(
        "panels",
        scene.panels.iter().map(|p| p.name.clone()).collect(),
    );
    info.row("", "`nullray plan` shows what it needs");
    data(&mut info, &scene, memory);
    Ok(info)
}

fn object(object: &Object) -> String {
    let geometry = match &object.geometry {
        Geometry::Gltf { path, node: None } => path.display().to_string(),
        Geometry::Gltf {
            path,
            node: Some(node),
        } => format!("{}, node {node}", path.display()),
        Geometry::Shape { shape, .. } => shape_name(*shape).into(),
        Geometry::Mesh(_) => "mesh in memory".into(),
    };
    format!(
        "{} ({geometry}): {}",
        object.name,
        camera::moving(object.velocity)
    )
}

fn shape_name(shape: Shape) -> &'static str {
    match shape {
        Shape::Box { .. } => "box",
        Shape::Sphere { .. } => "sphere",
        Shape::Plane { .. } => "plane",
        Shape::Lattice { .. } => "lattice",
    }
}

fn source(scene: &Scene, source: &Source) -> String {
    let kind = match &source.kind {
        SourceKind::Cube(cube) => {
            let mapping = match &cube.mapping {
                Mapping::Uv { set, backs } => {
                    let backs = match backs {
                        CubeBacks::AsFront => "",
                        CubeBacks::Black => ", black backs",
                        CubeBacks::SecondHalf => ", backs from its second half",
                    };
                    format!("by texture coordinates {set}{backs}")
                }
                Mapping::Capture(_) => "by projection from its capture camera".into(),
            };
            let path = path(cube).unwrap_or_else(|| "in memory".into());
            format!("cube {path} {mapping}, {}", bins(&cube.bins))
        }
        SourceKind::Pulse(pulse) => {
            let (at, t) = (pulse.origin.x, pulse.origin.ct);
            format!(
                "pulse from ({}, {}, {}) m at {t} m, σ = {} m",
                at.x, at.y, at.z, pulse.sigma
            )
        }
    };
    format!("{}: {kind}; lights {}", source.name, lit(scene, source))
}

fn bins(bins: &TimeBins) -> String {
    match bins {
        TimeBins::Uniform { start, width } => format!("bins of {width} m from {start} m"),
        TimeBins::Edges(edges) => {
            let (first, last) = (bins.edge(0), bins.edge(edges.len()));
            let count = edges.len().saturating_sub(1);
            format!("{count} bins of different widths from {first} m to {last} m")
        }
    }
}

/// Adds what is read from a cube's file, what the scene sets, and what is assumed.
fn cube_rows(info: &mut Info, name: &str, cube: &CubeSource, memory: u64) {
    let header = header(cube, memory);
    let read = match &header {
        Ok(read) => format!("{name}: {}", shape(read, cube.channels.as_ref())),
        Err(error) => format!("{name}: cannot be read: {error}"),
    };
    info.row("  read", read);
    if !cube.read.is_empty() {
        info.row("  by file", cube.read.join(", "));
    }
    let values = match cube.values {
        BinValues::PerBin => "energy per bin",
        BinValues::Density => "energy per metre",
    };
    let clock = match cube.clock {
        Clock::World => "world time of emission",
        Clock::Object => "the object's own time of emission",
        Clock::Capture => "arrival at the capture camera",
    };
    let filter = match cube.filter {
        TimeFilter::Nearest => "nearest",
        TimeFilter::Linear => "linear",
        TimeFilter::Cubic => "cubic",
        TimeFilter::CubicMeans => "cubic_means",
    };
    info.row("  means", format!("{values}, {clock}, filter {filter}"));
    let assumed = assumed(&header, cube);
    if !assumed.is_empty() {
        info.row("  assumed", assumed.join(", "));
    }
}

/// The keys that neither the scene nor the file sets, with the values assumed for them.
fn assumed(header: &Result<CubeInfo>, cube: &CubeSource) -> Vec<String> {
    let axes = header.as_ref().ok().filter(|info| info.assumed);
    let axes = axes.map(|info| format!("axes = \"{}\"", info.axes));
    axes.into_iter()
        .chain(cube.assumed.iter().cloned())
        .collect()
}

/// The file's header.
fn header(cube: &CubeSource, memory: u64) -> Result<CubeInfo> {
    match &cube.data {
        CubeData::File(file) => {
            let wanted = cube.wanted(file);
            cube::inspect(&file.path, wanted.within(memory))
        }
        CubeData::Memory(cube) => Ok(CubeInfo::of(cube)),
    }
}

fn shape(info: &CubeInfo, channels: Option<&Channels>) -> String {
    let [h, w, t, c] = info.shape;
    let colours = match channels {
        Some(channels) => format!("channels {channels}"),
        None if c == 1 => "grey".into(),
        None => "red, green, blue".into(),
    };
    let size = bytes(info.bytes);
    format!("{h} rows, {w} columns, {t} time bins, {colours}; {size}")
}

fn light(scene: &Scene, light: &Light) -> String {
    let shines = match &light.kind {
        LightKind::Area {
            object, emission, ..
        } => format!(
            "surface of {}, {}",
            scene.objects[*object].name,
            described(emission)
        ),
        LightKind::Lamp(lamp) => {
            let at = lamp.origin.x;
            let beam = match lamp.beam {
                Beam::Point => format!("point at ({}, {}, {}) m", at.x, at.y, at.z),
                Beam::Spot { .. } => format!("spot at ({}, {}, {}) m", at.x, at.y, at.z),
                Beam::Parallel(d) => format!("parallel along ({}, {}, {})", d.x, d.y, d.z),
            };
            let emission = described(&lamp.emission);
            format!("{beam}, {emission}; {}", camera::moving(lamp.velocity))
        }
    };
    format!("{}: {shines}", light.name)
}

fn described(emission: &EmissionProfile) -> String {
    match emission {
        EmissionProfile::Steady => "steady".into(),
        EmissionProfile::Gaussian { centre, sigma } => {
            format!("a pulse at its {centre} m, σ = {sigma} m")
        }
        EmissionProfile::Train { sigma, period, .. } => {
            format!("pulses every {period} m, σ = {sigma} m")
        }
        EmissionProfile::Table(knots) => format!("by a table of {} times", knots.len()),
    }
}

fn sky(sky: &Sky) -> String {
    let mut parts = vec![match &sky.background {
        SkyRadiance::Uniform([r, g, b]) => format!("radiance ({r}, {g}, {b})"),
        SkyRadiance::Gradient { .. } => "gradient".into(),
        SkyRadiance::Spectrum(_) => "a spectrum".into(),
        SkyRadiance::Image { path, .. } => path.display().to_string(),
    }];
    parts.extend(sky.sun.map(|_| "a sun".to_string()));
    parts.extend(sky.stars.as_ref().map(|stars| match &stars.catalogue {
        Catalogue::File(path) => format!("stars of {}", path.display()),
        Catalogue::Random { count, .. } => format!("{count} stars"),
    }));
    let lights = if sky.lights {
        "lights surfaces"
    } else {
        "lights nothing"
    };
    format!("{}; {lights}", parts.join(", "))
}

fn path(cube: &CubeSource) -> Option<String> {
    Some(cube.data.path()?.display().to_string())
}

fn lit(scene: &Scene, source: &Source) -> String {
    match &source.binding {
        Binding::All => "all objects".into(),
        Binding::Only { objects, materials } => {
            let objects = objects.iter().filter_map(|&o| scene.objects.get(o));
            let names: Vec<_> = objects.map(|o| o.name.as_str()).collect();
            let materials = match materials.as_slice() {
                [] => String::new(),
                some => format!(" (materials {})", some.join(", ")),
            };
            format!("{}{materials}", names.join(", "))
        }
    }
}

/// Adds the equations in use, the unit of radiance, and which effects are off.
fn settings(info: &mut Info, scene: &Scene) {
    if scene.equations == Equations::Paper2015 {
        info.row(
            "model",
            "the equations of Jarabo et al. 2015, with their approximations",
        );
    }
    let radiance = match scene.continuation {
        Continuation::Companions => format!(
            "{}, continued by infrared and ultraviolet channels",
            scene.quantity
        ),
        _ => scene.quantity.to_string(),
    };
    info.row("radiance", radiance);
    // Physical effects that are on have no row.
    let effects = scene.effects;
    let all = [
        ("aberration", effects.aberration),
        ("Doppler", effects.doppler),
        ("searchlight", effects.searchlight),
        ("retardation", effects.retardation),
    ];
    let off: Vec<_> = all.iter().filter(|e| !e.1).map(|e| e.0).collect();
    if !off.is_empty() {
        info.row("turned off", off.join(", "));
    }
    if scene.medium_index != 1.0 {
        info.row("medium", format!("refractive index {}", scene.medium_index));
    }
    if scene.speed_of_light != nullray::spacetime::SPEED_OF_LIGHT {
        info.row("light", format!("{} m/s", scene.speed_of_light));
    }
}

fn cube_data(cube: &CubeSource, memory: u64) -> Value {
    let read = header(cube, memory);
    let edges = match &cube.bins {
        TimeBins::Uniform { .. } => None,
        TimeBins::Edges(edges) => Some(edges.to_vec()),
    };
    json!({
        "shape": read.as_ref().ok().map(|read| read.shape),
        "channels": cube.channels.as_ref().map(Channels::names),
        "problem": read.as_ref().err().map(|error| error.to_string()),
        "start": cube.bins.edge(0),
        "bin_width": edges.is_none().then(|| cube.bins.width()),
        "edges": edges,
        "values": cube.values,
        "clock": cube.clock,
        "filter": cube.filter,
        "reconstruction": cube.reconstruction,
        "scale": cube.scale,
        "read": cube.read,
        "assumed": assumed(&read, cube),
    })
}

/// Adds the data about a scene for `--json`.
fn data(info: &mut Info, scene: &Scene, memory: u64) {
    let objects = scene.objects.iter().map(|o| {
        let file = match &o.geometry {
            Geometry::Gltf { path, .. } => json!(path.display().to_string()),
            Geometry::Shape { .. } | Geometry::Mesh(_) => Value::Null,
        };
        json!({ "name": o.name, "file": file, "velocity": camera::velocity(o.velocity) })
    });
    // Scripts read these keys: they stay the same when the words of the rows change.
    let sources = scene.sources.iter().map(|s| {
        let file = match &s.kind {
            SourceKind::Cube(cube) => json!(path(cube)),
            SourceKind::Pulse(_) => Value::Null,
        };
        let cube = match &s.kind {
            SourceKind::Cube(cube) => cube_data(cube, memory),
            SourceKind::Pulse(_) => Value::Null,
        };
        json!({ "name": s.name, "file": file, "lights": lit(scene, s), "cube": cube })
    });
    info.data("model", metadata::equations(scene.equations));
    info.data("camera", camera::data(scene));
    info.data("samples_per_pixel", scene.samples_per_pixel);
    info.data("bounces", scene.bounces);
    info.data("objects", objects.collect::<Vec<_>>());
    let lights = scene.lights.iter().map(|l| l.name.clone());
    info.data("lights", lights.collect::<Vec<_>>());
    info.data("sky", scene.sky.as_ref().map(sky));
    info.data("sources", sources.collect::<Vec<_>>());
}
