//! What a plan leaves out, and what its pictures do not show.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::bindings::{Lit, lit_by};
use super::planned::{Plan, PlannedObject, Skipped};
use super::recorded::contradicted;
use crate::camera::{Shot, ViewKind};
use crate::colour::{Continuation, Spectrum, SpectrumShape};
use crate::io::cube::CubeChannel;
use crate::io::gltf;
use crate::io::image::panorama;
use crate::mesh::Factors;
use crate::scene::MADE_FOR_MODEL;
use crate::scene::model::{
    Geometry, Lamp, Light, LightKind, Motion, Object, Scene, SkyRadiance, SourceKind, Spectra,
};
use crate::spacetime::{Hue, Quantity, Velocity};

/// Velocities whose rapidities differ by less are the same up to rounding: W is 1 to as many digits.
const SAME_RAPIDITY: f64 = 1e-9;

pub(super) fn explain(scene: &Scene, plan: &mut Plan) {
    plan.skipped = skipped(scene, plan);
    plan.notes = notes(scene, plan);
}

/// What this scene does not need, and why: the rows that `plan` prints as skipped.
fn skipped(scene: &Scene, plan: &Plan) -> Vec<Skipped> {
    let mut list = Vec::new();
    let mut skip = |condition: bool, what: &str, why: &str| {
        if condition {
            list.push(Skipped {
                what: what.into(),
                why: why.into(),
            });
        }
    };
    let still = scene.objects.iter().all(|o| o.velocity.is_rest());
    skip(
        plan.view == ViewKind::Still,
        "boost of look directions",
        "the camera rests in the world",
    );
    skip(
        still,
        "boosts into rest frames",
        "all objects rest in the world",
    );
    skip(
        plan.frames.len() == 1,
        "loop over rest frames",
        "there is one rest frame",
    );
    skip(
        !plan.time_resolved,
        "time axis, retarded lookup, coverage",
        "no source varies with time",
    );
    skip(
        plan.rays.capture == 0,
        "visibility from a capture camera",
        "no source is projected",
    );
    skip(
        plan.rays.shadow_at_most == 0,
        "shadow rays",
        "no object in a light with shadows, no projected source",
    );
    skip(
        plan.film.channels.is_empty(),
        "auxiliary channels",
        "none is asked for",
    );
    skip(
        scene.spectra == Spectra::Sampled && scene.bounces > 0,
        "paths that neighbours share",
        "each sample has wavelengths of its own",
    );
    let no_uvs = plan.objects.iter().all(|o| !o.uvs);
    skip(no_uvs, "texture coordinates", "nothing uses them");
    let unused_textures = plan.objects.iter().any(|o| o.images > 0 && !o.textures);
    skip(
        unused_textures,
        "base colour textures of some objects",
        "their radiance comes from cubes",
    );
    skip(
        !scene.effects.aberration,
        "aberration",
        "turned off in the scene",
    );
    skip(
        !scene.effects.doppler,
        "Doppler shift of colours",
        "turned off in the scene",
    );
    skip(
        !scene.effects.searchlight,
        "searchlight factor",
        "turned off in the scene",
    );
    skip(
        !scene.effects.retardation,
        "delay of light",
        "turned off in the scene",
    );
    for (source, cube) in scene.sources.iter().zip(&plan.cubes) {
        let unused = matches!(source.kind, SourceKind::Cube(_)) && cube.is_none();
        skip(
            unused,
            &format!("cube of source \"{}\"", source.name),
            "it lights no surface",
        );
    }
    list
}

/// Approximations and omissions that a user might not expect.
fn notes(scene: &Scene, plan: &Plan) -> Vec<String> {
    let mut notes = Vec::new();
    let moves =
        |velocity: &Velocity, motion: &Motion| !velocity.is_rest() || *motion != Motion::Inertial;
    let lamp_moves = |light: &Light| match &light.kind {
        LightKind::Lamp(lamp) => moves(&lamp.velocity, &lamp.motion),
        LightKind::Area { .. } => false,
    };
    let moving = plan.view != ViewKind::Still
        || scene.objects.iter().any(|o| !o.velocity.is_rest())
        || scene.lights.iter().any(lamp_moves);
    let sources = scene.sources.iter().map(|s| s.quantity);
    let mut quantities = sources.chain([scene.quantity]);
    let colours = quantities.any(|q| q.hue() == Hue::Stays);
    if moving && colours && scene.effects.doppler {
        notes.push(
            "colour channels hold no spectrum: the Doppler shift changes their brightness, not their hue \
             (declare quantity = \"rgb\" or \"line\" to see hues shift)"
                .into(),
        );
    }
    if scene.quantity == Quantity::Rgb && moving && scene.effects.doppler {
        let beyond = match scene.continuation {
            Continuation::Dark => "dark",
            Continuation::Edge => "constant",
            Continuation::Blackbody => "falling off as Planck's law at 6504 K",
            Continuation::Companions => "dark, but for infrared and ultraviolet channels,",
        };
        notes.push(format!(
            "colours represent smooth spectra, which are {beyond} below 360 and above 830 nm (radiance.continuation)"
        ));
    }
    if moving || scene.false_colour.is_some() {
        notes.extend(companions(scene, plan));
    }
    if let Some(wavelength) = scene.false_colour {
        notes.push(match scene.sees_wavelengths() {
            true => format!(
                "colours are false: {} nm is shown as 555 nm",
                (wavelength * 1e12).round() / 1e3
            ),
            false => "display.false_colour has no effect: no colour here follows from wavelengths (set quantity = \"rgb\" or \
                      \"line\" in [radiance])"
                .into(),
        });
    }
    let reflects = |(index, object): (usize, &PlannedObject)| {
        let mut materials = object.materials.iter();
        materials.any(|name| matches!(lit_by(scene, index, name), Lit::Reflecting(_)))
    };
    let is_sampled = scene.spectra == Spectra::Sampled;
    if is_sampled && !plan.objects.iter().enumerate().any(reflects) {
        notes.push("no surface here reflects light: `render.spectra` has no effect".into());
    }
    if scene.bounces > 0 && plan.rays.bounces_at_most == 0 {
        notes.push("no light falls on any surface: `render.bounces` has no effect".into());
    }
    notes.extend(unfound_light(scene, &plan.objects, |_| false));
    notes.extend(unshown(scene, &plan.objects));
    if scene.medium_index != 1.0 {
        notes.push(format!(
            "the medium's index {0} delays light, and dielectrics refract and reflect by ior/{0}; other directions, Doppler shifts and \
             brightness are those of vacuum",
            scene.medium_index
        ));
    }
    notes.extend(scene.passed_over.iter().cloned());
    let files = plan.objects.iter().filter_map(|object| {
        let file = object.file.as_deref()?;
        Some((file, object.unread.as_slice()))
    });
    notes.extend(unread_of(scene, files));
    if scene.speed_of_light != crate::spacetime::SPEED_OF_LIGHT {
        notes.push(format!(
            "the speed of light of this scene is {} m/s",
            scene.speed_of_light
        ));
    }
    notes
}

/// What is ignored in the glTF files of the objects of `scene`, from their headers: a sentence for each, after the name of the file.
/// Files that cannot be read are skipped.
pub fn unread(scene: &Scene) -> Vec<String> {
    let mut inspected = HashSet::new();
    let mut files = Vec::new();
    for object in &scene.objects {
        let Geometry::Gltf { path, node } = &object.geometry else {
            continue;
        };
        let part = (path.as_path(), node.as_deref());
        if !inspected.insert(part) {
            continue;
        }
        if let Ok(summary) = gltf::inspect_for(part.0, part.1, object.bad_textures) {
            files.push((part.0, summary.warnings));
        }
    }
    unread_of(scene, files.iter().map(|(path, said)| (*path, &said[..])))
}

/// The same for `files`, with the ignored features of each.
fn unread_of<'a>(
    scene: &Scene,
    files: impl IntoIterator<Item = (&'a Path, &'a [String])>,
) -> Vec<String> {
    let mut notes = Vec::new();
    for (file, unread) in files {
        for sentence in unread {
            let note = format!("{}: {sentence}", file.display());
            if !is_moot(scene, &note) && !notes.contains(&note) {
                notes.push(note);
            }
        }
    }
    notes
}

/// Whether a warning, after the name of its file, does not matter in a scene: lights, if the scene names one of this file, was made for the
/// model and has them, or has recorded light or pulses; cameras, if it was not; and animations, if something follows one.
pub(crate) fn is_moot(scene: &Scene, warning: &str) -> bool {
    let by_animation = |motion: &Motion| matches!(motion, Motion::Animation { .. });
    let lamp = |light: &Light| match &light.kind {
        LightKind::Lamp(lamp) => by_animation(&lamp.motion),
        LightKind::Area { .. } => false,
    };
    let plays = || by_animation(&scene.camera.motion) || scene.lights.iter().any(lamp);
    let is_made = scene.text.starts_with(MADE_FOR_MODEL);
    let mut files = (scene.lights.iter()).filter_map(|light| light.gltf.as_ref());
    let of_file = |file: &PathBuf| warning.starts_with(&format!("{}: ", file.display()));
    let has_light = is_made || (!scene.is_lit() && !scene.sources.is_empty()) || files.any(of_file);
    (warning.contains(gltf::CAMERAS_UNREAD) && !is_made)
        || (warning.contains(gltf::LIGHTS_UNREAD) && has_light)
        || (warning.contains(gltf::ANIMATIONS_UNREAD) && plays())
}

/// Notes that light of lamps without extent is lost via perfect mirrors or through smooth glass: no sampled path goes exactly that way,
/// and none contributes to the standard error. `has_mirror` says for an object, by its index, whether textures make part of it such a
/// mirror.
pub(crate) fn unfound_light(
    scene: &Scene,
    objects: &[PlannedObject],
    has_mirror: impl Fn(usize) -> bool,
) -> Option<String> {
    // Under pulses alone all surfaces are diffuse.
    if scene.bounces == 0 || !scene.is_lit() {
        return None;
    }
    let lights = scene.lights.iter();
    let lamps = lights.filter(|light| matches!(light.kind, LightKind::Lamp(_)));
    let pulses = scene.sources.iter();
    let pulses = pulses.filter(|source| matches!(source.kind, SourceKind::Pulse(_)));
    let names = lamps.map(|light| &light.name);
    let names = names.chain(pulses.map(|source| &source.name));
    let lamps: Vec<String> = names.map(|name| quoted(name)).collect();
    if lamps.is_empty() {
        return None;
    }
    // Surfaces that reflect light at all.
    let has = |index: usize, is: fn(&Factors) -> bool| {
        let object = &objects[index];
        let mut materials = object.materials.iter().zip(&object.factors);
        materials.any(|(material, factors)| {
            is(factors) && matches!(lit_by(scene, index, material), Lit::Reflecting(_))
        })
    };
    let named = |is: &dyn Fn(usize) -> bool| -> Vec<String> {
        let all = (0..objects.len()).filter(|index| is(*index));
        all.map(|index| quoted(&objects[index].name)).collect()
    };
    let mirrors = named(&|index| has(index, Factors::is_mirror) || has_mirror(index));
    let glass = named(&|index| has(index, Factors::is_glass));
    if mirrors.len() + glass.len() == 0 {
        return None;
    }
    let (mut ways, mut remedies) = (Vec::new(), Vec::new());
    if !mirrors.is_empty() {
        ways.push(format!("via the perfect mirrors {}", listed(&mirrors)));
        remedies.push("roughness = 0.03 for mirrors");
    }
    if !glass.is_empty() {
        ways.push(format!("via the smooth glass {}", listed(&glass)));
    }
    remedies.push("a shining object (a light with `object`) in place of the lamp");
    Some(format!(
        "lamps without extent ({}): their light cannot be sampled {}, so it is missing, and the standard error does not include it \
         (remedy: {})",
        listed(&lamps),
        ways.join(" or "),
        remedies.join(", or ")
    ))
}

/// What pictures of a scene do not show, a sentence each, reported before rendering as well as with the pictures.
pub(crate) fn unshown(scene: &Scene, objects: &[PlannedObject]) -> Vec<String> {
    let mut notes = unshown_materials(scene, objects);
    notes.extend(opaque_glass(scene, objects));
    notes.extend(lost_spectra(scene, objects));
    notes.extend(unread_companions(scene));
    notes.extend(contradicted(scene));
    notes.extend(bright_colours(scene, objects));
    notes.extend(lost_digits(scene, objects));
    notes
}

/// Notes that surfaces are so fast in the world that light falling on them is computed with few digits.
///
/// An event at a distance r from a body, in its rest frame, is up to γ r away in the world, where it is rounded by 2⁻⁵³ γ r; a boost back
/// makes that 2⁻⁵³ γ² r. So much is lost where light left a lamp if lamp and surface are both fast, and 2⁻⁵³ γ C if the event of the shot has
/// coordinates up to C in the world, as after a camera time of C/γ; rays that leave a surface start 2⁻⁴² γ² of their coordinates above it.
fn lost_digits(scene: &Scene, objects: &[PlannedObject]) -> Vec<String> {
    // The smallest errors worth a note: of the light of lamps, and of where rays start, relative to the coordinates.
    const LIGHT: f64 = 1e-5;
    const CLEARANCE: f64 = 1e-3;
    if !scene.is_lit() {
        return Vec::new();
    }
    let reflects = |index: &usize| {
        let mut materials = objects[*index].materials.iter();
        materials.any(|name| matches!(lit_by(scene, *index, name), Lit::Reflecting(_)))
    };
    let surfaces: Vec<&Object> = (0..objects.len())
        .filter(reflects)
        .map(|index| &scene.objects[index])
        .collect();
    let gammas = surfaces.iter().map(|object| object.velocity.gamma());
    let surface = gammas.fold(1.0, f64::max);
    let Ok(shot) = Shot::new(&scene.camera) else {
        return Vec::new();
    };
    // Wherever its acceleration changes, and when it emits the light that reaches the camera.
    let fastest = |lamp: &Lamp| {
        let mut times = match &lamp.motion {
            Motion::Profile { knots, .. } => knots.iter().map(|(time, _)| *time).collect(),
            Motion::Segments(segments) => {
                let ends = segments.iter().scan(0.0, |end, segment| {
                    *end += segment.duration;
                    Some(*end)
                });
                ends.collect()
            }
            _ => Vec::new(),
        };
        // The motion was checked before.
        let line = lamp.world_line().ok();
        let seen = (line.as_ref()).and_then(|line| line.on_past_light_cone_of(shot.event));
        times.extend(seen.map(|crossing| crossing.proper_time()));
        let state = |time: &f64| line.as_ref()?.state(*time);
        let gammas = times
            .iter()
            .filter_map(state)
            .map(|state| state.velocity.gamma());
        gammas.fold(lamp.velocity.gamma(), f64::max)
    };
    let lamps = scene.lights.iter().filter_map(|light| match &light.kind {
        LightKind::Lamp(lamp) => Some(fastest(lamp)),
        LightKind::Area { .. } => None,
    });
    let lamp = lamps.fold(1.0, f64::max);
    let reach = shot.event.x.abs().max_element().max(shot.event.ct.abs());
    // γ, and C relative to the distance from the camera.
    let lost = surfaces.iter().map(|object| {
        let gamma = lamp.min(object.velocity.gamma());
        let way = shot.event_in(&object.frame()).x - object.transform.translation;
        let far = match gamma > 1.0 && way != DVec3::ZERO {
            true => reach / way.length(),
            false => 0.0,
        };
        (gamma, gamma * gamma.max(far) * (-53.0f64).exp2())
    });
    let (gamma, light) = lost.fold((1.0, 0.0), |a, b| if b.1 > a.1 { b } else { a });
    let mut notes = Vec::new();
    if light > LIGHT {
        notes.push(format!(
            "lamps and surfaces move at γ = {gamma:.1e} in the world, where coordinates are rounded: the light of such lamps on such surfaces \
             has relative errors of {light:.0e} and more (let the world move with them, and other things past them)"
        ));
    }
    let clearance = surface * surface * (-42.0f64).exp2();
    if scene.bounces > 0 && clearance > CLEARANCE {
        notes.push(format!(
            "surfaces move at γ = {surface:.1e} in the world, where coordinates are rounded: light that bounces starts {clearance:.0e} of its \
             distance from the camera above them (let the world move with them, and other things past them)"
        ));
    }
    notes
}

/// Notes shapes that reflect more light than they receive.
fn bright_colours(scene: &Scene, objects: &[PlannedObject]) -> Option<String> {
    let is_bright = |(index, object): &(usize, &Object)| {
        let colour = match &object.geometry {
            Geometry::Shape { colour, .. } => colour,
            Geometry::Gltf { .. } | Geometry::Mesh(_) => return false,
        };
        let mut materials = objects[*index].materials.iter();
        colour.iter().any(|c| *c > 1.0)
            && materials.any(|name| matches!(lit_by(scene, *index, name), Lit::Reflecting(_)))
    };
    let bright = scene.objects.iter().enumerate().filter(is_bright);
    let names: Vec<String> = bright
        .map(|(_, object)| format!("{:?}", object.name))
        .collect();
    (!names.is_empty()).then(|| {
        format!(
            "the colour of {} is above 1: where there is light, it reflects more than it receives",
            listed(&names)
        )
    })
}

/// Notes infrared and ultraviolet channels of the sky's picture, which are not read.
fn unread_companions(scene: &Scene) -> Option<String> {
    let path = scene.sky.as_ref()?.picture()?;
    let is_companion = |name: &String| {
        let own = name.rsplit('.').next();
        CubeChannel::COMPANIONS
            .iter()
            .any(|channel| own == Some(channel.name()))
    };
    let mut channels = panorama::head(path)?.channels;
    channels.retain(is_companion);
    let shows_companions = scene.continuation == Continuation::Companions && scene.effects.doppler;
    let beyond = match shows_companions {
        true => {
            ": the sky is dark beyond what is visible (radiance.continuation is \"companions\")"
        }
        false => "",
    };
    (!channels.is_empty()).then(|| {
        format!(
            "{}: the channels {} of a sky are not read, only those of cubes{beyond}",
            path.display(),
            channels.join(" and ")
        )
    })
}

/// Notes that surfaces do not reflect spectra: the light that reaches them in their rest frames is represented by red, green and blue,
/// whose shift on the way to a moving camera, or to false colours, is that of smooth spectra.
fn lost_spectra(scene: &Scene, objects: &[PlannedObject]) -> Option<String> {
    let is_sampled = scene.spectra == Spectra::Sampled;
    if scene.quantity != Quantity::Rgb || !scene.effects.doppler || is_sampled {
        return None;
    }
    let is_no_rgb = |own: &Spectrum| !matches!(own.shape(), SpectrumShape::Rgb(..));
    let has_spectrum = |light: &&Light| {
        let spectrum = match &light.kind {
            LightKind::Lamp(lamp) => lamp.spectrum.as_ref(),
            LightKind::Area { object, .. } => scene.objects[*object].spectrum.as_ref(),
        };
        spectrum.is_some_and(is_no_rgb)
    };
    let lights = scene.lights.iter().filter(has_spectrum);
    let sky = scene.sky.as_ref().filter(|sky| sky.lights);
    let sky = sky.filter(|sky| {
        sky.stars.is_some()
            || matches!(&sky.background, SkyRadiance::Spectrum(own) if is_no_rgb(own))
    });
    let stars = match sky.is_some_and(|sky| sky.stars.is_some()) {
        true => ", and lights = false in [sky], as stars cannot light surfaces then",
        false => "",
    };
    let lights = lights.map(|light| format!("{:?}", light.name));
    let lights: Vec<String> = lights.chain(sky.map(|_| "the sky".into())).collect();
    let camera = Shot::new(&scene.camera).ok()?.frame.velocity();
    let moves = |(index, object): (usize, &PlannedObject)| {
        let apart = scene.objects[index].velocity.rapidity() - camera.rapidity();
        let mut materials = object.materials.iter();
        (apart.length() > SAME_RAPIDITY || scene.false_colour.is_some())
            && materials.any(|name| matches!(lit_by(scene, index, name), Lit::Reflecting(_)))
    };
    let is_shifted = !lights.is_empty() && objects.iter().enumerate().any(moves);
    is_shifted.then(|| {
        let wrong = match scene.false_colour {
            None => "surfaces that move relative to the camera have wrong hues unless that spectrum is smooth",
            Some(_) => "what is invisible of it is missing in false colours",
        };
        format!(
            "surfaces reflect the light of {} as red, green and blue, not as its spectrum: {wrong} (remedy: spectra = \"sampled\" in [render]{stars})",
            listed(&lights)
        )
    })
}

/// Notes that glass is opaque without bounces, except under pulses alone, which [`unshown_materials`] handles.
fn opaque_glass(scene: &Scene, objects: &[PlannedObject]) -> Option<String> {
    let is_glass = |(index, object): &(usize, &PlannedObject)| {
        let mut materials = object.materials.iter().zip(&object.factors);
        materials.any(|(name, factors)| {
            factors.is_glass()
                && (scene.is_lit() || !matches!(lit_by(scene, *index, name), Lit::Reflecting(_)))
        })
    };
    let glass = objects.iter().enumerate().filter(is_glass);
    let names: Vec<String> = glass.map(|(_, object)| quoted(&object.name)).collect();
    (scene.bounces == 0 && !names.is_empty()).then(|| {
        format!(
            "the glass of {} is opaque without `render.bounces`: give 2 for each body",
            listed(&names)
        )
    })
}

/// What only lights and skies show of materials, in a scene without any: emission, if base colours are shown; and gloss, if pulses light
/// the surfaces.
fn unshown_materials(scene: &Scene, objects: &[PlannedObject]) -> Vec<String> {
    if scene.is_lit() {
        return Vec::new();
    }
    let has = |index: usize, is: fn(&Factors) -> bool, is_lit: fn(&Lit) -> bool| {
        let object = &objects[index];
        let mut materials = object.materials.iter().zip(&object.factors);
        materials.any(|(name, factors)| is(factors) && is_lit(&lit_by(scene, index, name)))
    };
    let all = 0..objects.len();
    let emitting = all.clone().filter(|index| {
        let is_base = |lit: &Lit| *lit == Lit::Base;
        has(*index, |factors| factors.emits, is_base)
    });
    let sentence = |index: usize| {
        format!(
            "object {:?}: only lit scenes show what its materials emit: add a [[light]], or [sky] with radiance = 0",
            objects[index].name
        )
    };
    let mut notes: Vec<String> = emitting.map(sentence).collect();
    let glossy = all.filter(|index| {
        let is_pulsed = |lit: &Lit| matches!(lit, Lit::Reflecting(_));
        has(*index, Factors::is_glossy, is_pulsed)
    });
    let glossy: Vec<_> = glossy.map(|index| quoted(&objects[index].name)).collect();
    if !glossy.is_empty() {
        let are = if glossy.len() == 1 { "is" } else { "are" };
        notes.push(format!(
            "{} {are} lit only by pulses, which surfaces reflect diffusely: to show metal, gloss and glass, add a [[light]], or [sky] with \
             radiance = 0",
            listed(&glossy)
        ));
    }
    notes
}

fn quoted(name: &str) -> String {
    format!("\"{}\"", name.escape_debug())
}

/// The first few names of a list, and the number of others.
fn listed(names: &[String]) -> String {
    const MOST: usize = 4;
    let shown = names[..names.len().min(MOST)].join(", ");
    match names.len().saturating_sub(MOST) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// What is visible of the infrared and ultraviolet channels of cubes, or why nothing is.
fn companions(scene: &Scene, plan: &Plan) -> Vec<String> {
    let (mut notes, mut without) = (Vec::new(), Vec::new());
    let sources = scene.sources.iter().zip(&plan.cubes);
    for (source, _) in sources.filter(|(_, planned)| planned.is_some()) {
        let SourceKind::Cube(cube) = &source.kind else {
            continue;
        };
        let named = format!("source \"{}\"", source.name.escape_debug());
        let (own, seen) = (cube.companions(), scene.companions_of(cube));
        let names: Vec<_> = own.iter().map(|channel| channel.name()).collect();
        let names = names.join(" and ");
        if own.is_empty() {
            without.push(named);
        } else if seen.is_empty() {
            let why = match scene.effects.doppler {
                true => format!("radiance.continuation is \"{}\"", scene.continuation.name()),
                false => "effects.doppler is off".into(),
            };
            notes.push(format!("{named}: {names} are not used: {why}"));
        } else {
            let bands = seen.iter().map(|channel| {
                let [from, to] = channel.band().map(|end| (end * 1e9).round());
                format!("{} is its radiance from {from} to {to} nm", channel.name())
            });
            let bands: Vec<_> = bands.collect();
            notes.push(format!(
                "{named}: {}; it is dark outside these",
                bands.join(", ")
            ));
        }
    }
    if scene.continuation == Continuation::Companions && scene.effects.doppler {
        match without.as_slice() {
            [] if notes.is_empty() => notes.push(
                "radiance.continuation is \"companions\", and no cube has infrared or ultraviolet channels: everything is dark outside the visible range".into(),
            ),
            [] => {}
            without => notes.push(format!(
                "{} without infrared or ultraviolet channels: dark outside the visible range (radiance.continuation is \"companions\")",
                without.join(", ")
            )),
        }
    }
    notes
}
