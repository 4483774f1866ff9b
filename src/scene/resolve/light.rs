//! Lights.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::Range;

use glam::DVec3;

use super::context::{Context, GLTF};
use super::motion::{self, Moving};
use super::mover::{Mover, only_one_way};
use super::{object, path, spectrum};
use crate::colour::Continuation;
use crate::error::{Result, number};
use crate::scene::at::At;
use crate::scene::file::{self, LightType};
use crate::scene::limits;
use crate::scene::model::{
    Beam, Binding, Brightness, EmissionProfile, Geometry, Lamp, Light, LightKind, Motion, Object,
    Source, SourceKind,
};
use crate::scene::names;
use crate::scene::suggest::did_you_mean;
use crate::scene::values::NumberOrVector;
use crate::spacetime::Quantity;
use crate::spacetime::units::quoted;

const ALL_IN_VACUUM: &str = "light that a moving lamp sends into a medium is not computed: leave index = 1, or let the lamp rest";

/// The largest number of lights: each may be evaluated at every hit.
const MOST: usize = 10_000;

/// The other parts of the scene that lights depend on.
pub(super) struct Around<'a> {
    pub objects: &'a [Object],
    /// Index of the medium.
    pub index: f64,
    pub quantity: Quantity,
    pub continuation: Continuation,
}

/// All lights.
pub(super) fn resolve_all(
    cx: &Context,
    lights: &[At<file::Light>],
    around: &Around,
) -> Result<Vec<Light>> {
    if let Some(at) = lights.get(MOST) {
        let what = format!("{} lights are too many", lights.len());
        return Err(cx.refuse(at, what, format!("give at most {MOST}")));
    }
    let explicit = lights.iter().filter_map(|at| at.value.name.as_ref());
    object::refuse_duplicates(cx, explicit, "light")?;
    let named = lights.iter().zip(self::names(lights));
    named
        .map(|(at, name)| {
            Ok(Light {
                name,
                kind: kind(cx, at, around)?,
                gltf: (at.value.gltf.as_ref())
                    .map(|file| cx.path(file, GLTF))
                    .transpose()?,
                shadows: at.value.shadows,
                span: span(at),
            })
        })
        .collect()
}

/// The names of lights, those of the file or defaults.
pub(super) fn names(lights: &[At<file::Light>]) -> Vec<String> {
    let entry = |at: &At<file::Light>| {
        let text = |at: &'_ Option<At<String>>| at.as_ref().map(|at| at.value.clone());
        let (gltf, node) = (text(&at.value.gltf), text(&at.value.node));
        let kind = at.value.kind.value.name();
        let default = names::light(gltf.as_deref(), node.as_deref(), kind);
        (text(&at.value.name), default)
    };
    names::unique(lights.iter().map(entry).collect())
}

/// Whether lights of this type have a position of their own.
pub(super) fn has_place(kind: LightType) -> bool {
    matches!(kind, LightType::Point | LightType::Spot)
}

fn span(at: &At<file::Light>) -> Range<usize> {
    let name = at.value.name.as_ref();
    name.map_or_else(|| at.span.clone(), |name| name.span.clone())
}

fn kind(cx: &Context, at: &At<file::Light>, around: &Around) -> Result<LightKind> {
    only_keys_of_its_type(cx, at)?;
    if at.value.kind.value == LightType::Area {
        return area(cx, at, around);
    }
    let lamp = lamp(cx, at, around)?;
    let index = around.index;
    let moves = !lamp.velocity.is_rest() || lamp.motion != Motion::Inertial;
    if index != 1.0 && moves {
        let what = format!("this lamp moves in a medium of index {}", number(index));
        return Err(cx.report.refuse(&span(at), what, ALL_IN_VACUUM));
    }
    Ok(LightKind::Lamp(Box::new(lamp)))
}

/// Refuses keys that do not apply to lights of this type.
fn only_keys_of_its_type(cx: &Context, at: &At<file::Light>) -> Result<()> {
    use LightType::{Area, Directional, Point, Spot};
    let light = &at.value;
    let clock = Some(&light.clock_zero.span).filter(|_| light.clock_zero.is_given());
    type Key<'a> = (&'a str, Option<&'a Range<usize>>, &'a [LightType]);
    let keys: [Key; 14] = [
        ("position", At::span_of(&light.position), &[Point, Spot]),
        (
            "direction",
            At::span_of(&light.direction),
            &[Spot, Directional],
        ),
        ("inner", At::span_of(&light.inner), &[Spot]),
        ("outer", At::span_of(&light.outer), &[Spot]),
        ("intensity", At::span_of(&light.intensity), &[Point, Spot]),
        ("power", At::span_of(&light.power), &[Point, Spot, Area]),
        ("irradiance", At::span_of(&light.irradiance), &[Directional]),
        ("radiance", At::span_of(&light.radiance), &[Area]),
        (
            "spectrum",
            At::span_of(&light.spectrum),
            &[Point, Spot, Directional, Area],
        ),
        ("object", At::span_of(&light.object), &[Area]),
        ("clock_zero", clock, &[Point, Spot, Directional]),
        (
            "velocity",
            At::span_of(&light.velocity),
            &[Point, Spot, Directional],
        ),
        ("motion", At::span_of(&light.motion), &[Point, Spot]),
        (
            "emission",
            At::span_of(&light.emission),
            &[Point, Spot, Directional, Area],
        ),
    ];
    let own = light.kind.value;
    let wrong = keys.iter().find_map(|(key, span, types)| {
        let span = span.filter(|_| !types.contains(&own))?;
        Some((key, span, types))
    });
    let Some((key, span, types)) = wrong else {
        return Ok(());
    };
    let types: Vec<_> = types.iter().map(|t| format!("\"{}\"", t.name())).collect();
    let what = format!("a light of type \"{}\" has no `{key}`", own.name());
    let help = format!("leave it out, or set type = {}", types.join(" or "));
    Err(cx.report.refuse(span, what, help))
}

fn area(cx: &Context, at: &At<file::Light>, around: &Around) -> Result<LightKind> {
    let objects = around.objects;
    let Some(name) = &at.value.object else {
        let help = "add object = \"…\": the object whose surface shines";
        return Err(cx.refuse(at, "this area light has no object", help));
    };
    let Some(object) = objects.iter().position(|o| o.name == name.value) else {
        let names = objects.iter().map(|object| object.name.as_str());
        let meant = did_you_mean(&name.value, names.clone(), quoted);
        let known: Vec<String> = names.take(12).map(quoted).collect();
        let what = format!("there is no object named {}", quoted(&name.value));
        let help = format!("{meant}the objects are: {}", known.join(", "));
        return Err(cx.refuse(name, what, help));
    };
    let (radiance, power) = (&at.value.radiance, &at.value.power);
    cx.exclusive((radiance, "radiance"), (power, "power"))?;
    let emission = emission(cx, &at.value.emission)?;
    // Delays in a medium are computed only for lamps at rest in it.
    if around.index != 1.0 && !objects[object].velocity.is_rest() {
        let what = format!(
            "{} moves in a medium of index {}",
            quoted(&name.value),
            around.index
        );
        return Err(cx.refuse(name, what, ALL_IN_VACUUM));
    }
    // Shapes emit nothing of their own, and a spectrum replaces what materials emit.
    let has_spectrum = at.value.spectrum.is_some() || objects[object].spectrum.is_some();
    let is_shape = matches!(objects[object].geometry, Geometry::Shape { .. });
    Ok(LightKind::Area {
        object,
        emission,
        brightness: match (power, radiance) {
            (Some(_), _) => Brightness::Power(channels(cx, power)?),
            (None, None) if !has_spectrum && !is_shape => Brightness::Materials,
            (None, _) => Brightness::Radiance(channels(cx, radiance)?),
        },
    })
}

/// Gives objects the spectra of the area lights on their surfaces.
pub(super) fn give_spectra(
    cx: &Context,
    file: &[At<file::Light>],
    lights: &[Light],
    objects: &mut [Object],
    (quantity, continuation): (Quantity, Continuation),
) -> Result<()> {
    let mut lit = vec![false; objects.len()];
    for (at, light) in file.iter().zip(lights) {
        let LightKind::Area {
            object, brightness, ..
        } = &light.kind
        else {
            continue;
        };
        let said = &at.value;
        let (seen, object) = (&mut lit[*object], &mut objects[*object]);
        if std::mem::replace(seen, true) {
            let what = format!("{} already shines with another light", quoted(&object.name));
            let help = "an object can be only one area light: leave one of them out";
            return Err(cx.report.refuse(&light.span, what, help));
        }
        let own = spectrum::resolve(
            cx,
            &said.spectrum,
            "an area light",
            (quantity, continuation),
        )?;
        // Shining surfaces have one spectrum, given by either of the two tables.
        if let (Some(spectrum), Some(_)) = (&said.spectrum, &object.spectrum) {
            let what = format!("{} has a spectrum of its own", quoted(&object.name));
            let help = "leave out one `spectrum`: the light has that of its object";
            return Err(cx.refuse(spectrum, what, help));
        }
        object.spectrum = own.or(object.spectrum.take());
        // A spectrum defines its own colour; its factor must be grey.
        let (Brightness::Radiance([r, g, b]) | Brightness::Power([r, g, b])) = *brightness else {
            continue;
        };
        if object.spectrum.is_some() && !(r == g && g == b) {
            let what = "the factor on a spectrum is one number";
            let at = said.radiance.as_ref().or(said.power.as_ref());
            let help = "give `radiance` or `power` as one number";
            return Err(cx
                .report
                .refuse(at.map_or(&light.span, |at| &at.span), what, help));
        }
    }
    Ok(())
}

/// Refuses area lights on surfaces that show a cube: recorded light includes everything that leaves the surface, also its own emission,
/// so one of the two would have no effect.
pub(super) fn refuse_those_of_cubes(
    cx: &Context,
    lights: &[Light],
    sources: &[Source],
    objects: &[Object],
) -> Result<()> {
    let cubes = || {
        let is_cube = |source: &&Source| matches!(source.kind, SourceKind::Cube(_));
        sources.iter().filter(is_cube)
    };
    for light in lights {
        let LightKind::Area { object, .. } = &light.kind else {
            continue;
        };
        let shows = |source: &&Source| match &source.binding {
            Binding::All => true,
            Binding::Only { objects, .. } => objects.contains(object),
        };
        if let Some(cube) = cubes().find(shows) {
            let what = format!(
                "{} shows a cube, which already holds all light that leaves it",
                quoted(&objects[*object].name)
            );
            let help = "leave out this light, or give the cube's source `objects` without that one";
            let other = (&cube.span, "the cube");
            return Err(cx.report.refuse_two(&light.span, other, what, help));
        }
    }
    Ok(())
}

/// The motion of a lamp.
pub(super) fn moving(cx: &Context, at: &At<file::Light>) -> Result<Moving> {
    let light = &at.value;
    let mover = Mover {
        noun: "light",
        position: (&light.position, "position"),
        velocity: &light.velocity,
        clock_zero: &light.clock_zero,
        motion: &light.motion,
        span: &light.clock_zero.span,
    };
    only_one_way(cx, &mover)?;
    let start = path::start(cx, &mover)?;
    let position = start.as_ref().or(light.position.as_ref());
    // Parallel light has no position; its clock is that of the origin.
    let position = match position {
        Some(position) => position.value.vec(),
        None if !has_place(light.kind.value) => DVec3::ZERO,
        None => {
            let help = "add position = [0, 3, 0], or set type = \"directional\"";
            return Err(cx.refuse(at, "this light has no position", help));
        }
    };
    motion::resolve(cx, &mover, position)
}

fn lamp(cx: &Context, at: &At<file::Light>, around: &Around) -> Result<Lamp> {
    let light = &at.value;
    let beam = beam(cx, at)?;
    let Moving {
        origin,
        velocity,
        motion,
        ..
    } = moving(cx, at)?;
    Ok(Lamp {
        intensity: intensity(cx, light, beam)?,
        spectrum: spectrum::resolve(
            cx,
            &light.spectrum,
            "a lamp",
            (around.quantity, around.continuation),
        )?,
        emission: emission(cx, &light.emission)?,
        beam,
        origin,
        velocity,
        motion,
    })
}

fn beam(cx: &Context, at: &At<file::Light>) -> Result<Beam> {
    let light = &at.value;
    let direction = || {
        let Some(direction) = &light.direction else {
            let what = format!("a {} light needs a direction", light.kind.value.name());
            return Err(cx.refuse(at, what, "add direction = [0, -1, 0], in which it shines"));
        };
        cx.unit(
            direction,
            "the direction of a light",
            "give one like [0, -1, 0]",
        )
    };
    match light.kind.value {
        LightType::Point | LightType::Area => Ok(Beam::Point),
        LightType::Directional => direction().map(Beam::Parallel),
        LightType::Spot => {
            let inner = light.inner.as_ref().map_or(0.0, |at| at.value.radians());
            let outer = light.outer.as_ref();
            // π/4 is the default of KHR_lights_punctual.
            let outer_angle = outer.map_or(FRAC_PI_2 / 2.0, |at| at.value.radians());
            // 90° may have been rounded up.
            if !(0.0 <= inner && inner < outer_angle && outer_angle <= FRAC_PI_2 * (1.0 + 1e-12)) {
                let at_span = outer
                    .or(light.inner.as_ref())
                    .map_or(&at.span, |at| &at.span);
                let what = match outer {
                    None if inner > 0.0 => {
                        "this is not a cone: `inner` is not below `outer`, which is 45 deg where it is not given"
                    }
                    _ => {
                        "this is not a cone: `inner` is not below `outer`, or `outer` above 90 deg"
                    }
                };
                let help =
                    "0 deg ≤ inner < outer ≤ 90 deg, like inner = \"20 deg\", outer = \"30 deg\"";
                return Err(cx.report.refuse(at_span, what, help));
            }
            Ok(Beam::Spot {
                axis: direction()?,
                inner,
                outer: outer_angle,
            })
        }
    }
}

/// By channel, from whichever key the file gives.
fn intensity(cx: &Context, light: &file::Light, beam: Beam) -> Result<[f64; 3]> {
    let (intensity, power) = (&light.intensity, &light.power);
    cx.exclusive((intensity, "intensity"), (power, "power"))?;
    match (beam, power) {
        (Beam::Parallel(_), _) => channels(cx, &light.irradiance),
        (_, None) => channels(cx, intensity),
        (beam, Some(_)) => {
            let solid_angle = beam.solid_angle();
            Ok(channels(cx, power)?.map(|power| power / solid_angle))
        }
    }
}

impl Beam {
    /// The solid angle that would contain all of the power at the intensity on the axis: 4π for a point light; for a spot ∫ a dω = 2π ((1
    /// − c_i) + (c_i − c_o)/3), with a = ((c − c_o)/(c_i − c_o))² between the cosines.
    fn solid_angle(self) -> f64 {
        match self {
            Beam::Point | Beam::Parallel(_) => 4.0 * PI,
            Beam::Spot { inner, outer, .. } => {
                let (inner, outer) = (libm::cos(inner), libm::cos(outer));
                TAU * ((1.0 - inner) + (inner - outer) / 3.0)
            }
        }
    }
}

/// One number for all channels, or one each, none below 0. Default: 1.
pub(super) fn channels(cx: &Context, at: &Option<At<NumberOrVector>>) -> Result<[f64; 3]> {
    let Some(at) = at else {
        return Ok([1.0; 3]);
    };
    let channels = match at.value {
        NumberOrVector::Number(all) => [all; 3],
        NumberOrVector::Vector(rgb) => rgb,
    };
    if channels.iter().any(|&c| c < 0.0) {
        let help = "light is at least 0: one number, or [r, g, b]";
        return Err(cx.refuse(at, "there is light below 0", help));
    }
    Ok(channels)
}

/// The intensity as a function of a light's own time, given in one way; steady by default.
fn emission(cx: &Context, at: &Option<At<file::Emission>>) -> Result<EmissionProfile> {
    let Some(at) = at else {
        return Ok(EmissionProfile::Steady);
    };
    let file::Emission {
        gaussian,
        train,
        table,
    } = &at.value;
    let ways = [
        ("gaussian", At::span_of(gaussian)),
        ("train", At::span_of(train)),
        ("table", At::span_of(table)),
    ];
    let help = "give it in exactly one way: `gaussian`, `train` or `table`";
    cx.only_one("the emission", ways, help)?;
    if let Some(gaussian) = gaussian {
        Ok(EmissionProfile::Gaussian {
            centre: cx.time(&gaussian.value.time)?,
            sigma: cx.duration(&gaussian.value.sigma, "`sigma`")?,
        })
    } else if let Some(train) = train {
        self::train(cx, &train.value)
    } else if let Some(table) = table {
        self::table(cx, table)
    } else {
        Err(cx.refuse(at, "no emission is given", help))
    }
}

fn train(cx: &Context, train: &file::PulseTrain) -> Result<EmissionProfile> {
    let sigma = cx.duration(&train.sigma, "`sigma`")?;
    let period = cx.duration(&train.period, "`period`")?;
    if period < sigma {
        let what = format!(
            "a period of {} m is below σ = {} m: the pulses run together",
            number(period),
            number(sigma)
        );
        return Err(cx.refuse(
            &train.period,
            what,
            "a period is at least σ; or leave `emission` out",
        ));
    }
    let profile = EmissionProfile::Train {
        centre: cx.time(&train.time)?,
        sigma,
        period,
        count: train.count.as_ref().map(|count| count.value),
    };
    if let Some(count) = &train.count {
        cx.checked(count, limits::emission(&profile))?;
    }
    Ok(profile)
}

fn table(cx: &Context, at: &At<Vec<At<file::EmissionKnot>>>) -> Result<EmissionProfile> {
    cx.bounded(at, 2, "times of an emission")?;
    let knot = |knot: &At<file::EmissionKnot>| {
        let file::EmissionKnot { time, factor } = &knot.value;
        if factor.value.0 < 0.0 {
            return Err(cx.refuse(factor, "a factor is below 0", "light is at least 0"));
        }
        Ok([cx.time(time)?, factor.value.0])
    };
    let knots: Vec<[f64; 2]> = at.value.iter().map(knot).collect::<Result<_>>()?;
    let times: Vec<f64> = knots.iter().map(|[time, _]| *time).collect();
    cx.ascending(&times, |i| Some(&at.value.get(i)?.value.time))?;
    let profile = EmissionProfile::Table(knots);
    cx.checked(at, limits::emission(&profile))?;
    Ok(profile)
}
