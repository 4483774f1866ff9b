//! Mistakes identified by rendering the scene with them: lookup times and, if position channels are missing, motions and retardation. They
//! need the scene itself, whose light must be the reference's. Mistakes of unknown size are fitted (`fitted`).

use std::collections::BTreeMap;

use glam::DVec3;

use super::super::known::{Change, at_time, is_all_in_its_text};
use super::camera::elsewhere_in_words;
use super::fitted::{of_some_place, of_some_size};
use super::light::{Fit, Lit, NOTABLE, evidence, fit, lit, lit_and_dark, lit_of_any_object};
use super::motion::{ADVANCED, in_words};
use super::scene_light::{Asked, Light, MEMORY, light_and_size_of, light_of, objects_of};
use super::time::words_for_bins;
use super::{Case, Diagnosis, Kind, median};
use crate::camera::Shot;
use crate::render::aov::Aov;
use crate::render::plan::{Plan, Request};
use crate::render::prepare::Prepared;
use crate::render::progress::Silent;
use crate::render::render;
use crate::scene::model::{EmissionProfile, LightKind, Motion, Scene, SourceKind, TimeFilter};
use crate::spacetime::{Hue, Quantity, Velocity};

/// The most moving objects that are tested.
const MOST_OBJECTS: usize = 8;
/// The most objects that are tested in pairs for exchanged velocities: 6 pairs.
const MOST_EXCHANGED: usize = 4;
/// The distance to which omitted objects are moved, in sizes of the scene: far out of view, but close enough that f32 boxes around
/// everything at rest together, accurate to 6e-8 of their distance, still separate the other objects.
const FAR: f64 = 1e3;

/// A scene with a mistake, and its diagnosis.
struct Mistake {
    kind: Kind,
    what: String,
    size: (&'static str, f64),
    scene: Scene,
}

/// The largest fraction of the squared error that a mistake without a free parameter may leave: single samples elsewhere leave it at edges.
/// A hypothesis that leaves more happens to darken, or to move, the same places.
const LEFT_BY_MISTAKE: f64 = 0.03;

/// The result of comparing the scene's light.
#[derive(Debug)]
pub(super) enum Verdict {
    /// Inconclusive: there is no scene, or its light is not the reference's, or nothing is wrong.
    Nothing,
    /// None of the mistakes reproduces the candidate's light.
    NoMistake,
    /// The mistake, and the fraction of the squared error that it leaves.
    Mistake(Diagnosis, f64),
}

/// The mistake with which the scene reproduces the candidate's light.
pub(super) fn changes(case: &Case) -> Verdict {
    match in_the_light(case) {
        Verdict::Mistake(found, left) => Verdict::Mistake(found, left),
        verdict => in_the_dark(case).map_or(verdict, |(found, left)| Verdict::Mistake(found, left)),
    }
}

/// The same from the pixels with light in the reference.
fn in_the_light(case: &Case) -> Verdict {
    let scene_and_size = || {
        // What moves objects is seen where it moved them.
        let lit = match case.has_places() {
            true => lit(case),
            false => lit_of_any_object(case),
        };
        let (scene, lit) = (case.scene?, lit?);
        if fit(&lit, |_, r| r).tally.error() <= NOTABLE {
            return None;
        }
        let unchanged = light_if_that_of(case, scene, &lit)?;
        Some((scene, lit, unchanged))
    };
    let Some((scene, lit, unchanged)) = scene_and_size() else {
        return Verdict::Nothing;
    };
    mistake(case, scene, &lit, &unchanged).map_or(Verdict::NoMistake, |(found, left)| {
        Verdict::Mistake(found, left)
    })
}

/// Missing shadows that are black in the reference, such as those of a single lamp: only the pixels in them show it.
fn in_the_dark(case: &Case) -> Option<(Diagnosis, f64)> {
    let (scene, lit) = (case.scene?, lit(case)?);
    let mistake = without_shadows(scene)?;
    let mut all = lit_and_dark(case)?;
    let is_lit = |light: &[f64; 3]| light.iter().sum::<f64>() > 0.0;
    let in_either = all.iter().filter(|(_, pair)| pair.iter().any(is_lit));
    let in_either: Vec<Lit> = in_either.copied().collect();
    if fit(&in_either, |_, r| r).tally.error() <= NOTABLE {
        return None;
    }
    light_if_that_of(case, scene, &lit)?;
    let light = light_of(case, &mistake.scene, &all)?;
    // Where both are black, light without shadows would be a mistake of the hypothesis.
    all.retain(|(i, pair)| pair.iter().any(is_lit) || is_lit(&light.0[*i]));
    let fit = light.fit(&all);
    let explains = fit.tally.explains(NOTABLE) && fit.left <= LEFT_BY_MISTAKE;
    explains.then(|| {
        let diagnosis = Diagnosis {
            kind: mistake.kind,
            what: mistake.what.into(),
            evidence: evidence_of(mistake.size, &fit),
        };
        (diagnosis, fit.left)
    })
}

/// The evidence for a mistake of this size.
fn evidence_of(size: (&'static str, f64), fit: &Fit) -> Vec<(&'static str, f64)> {
    let of_light = evidence(&fit.tally).into_iter();
    let left = ("what it leaves of the squared error", fit.left);
    std::iter::once(size)
        .chain(of_light)
        .chain([left])
        .collect()
}

/// The mistake in a scene whose light is `unchanged`, and whose size that is.
fn mistake(
    case: &Case,
    scene: &Scene,
    lit: &[Lit],
    unchanged: &(Light, f64),
) -> Option<(Diagnosis, f64)> {
    let (light, size) = (&unchanged.0, unchanged.1);
    let asked = Asked::new(case, lit);
    let mut moves = Vec::new();
    if !case.has_places() {
        // Before other mistakes that move an object out of view.
        moves.extend(absences(scene, FAR * size));
        moves.extend(motions(scene));
        moves.extend(camera_at_rest(scene));
    }
    let mut others: Vec<Mistake> = without_shadows(scene).into_iter().collect();
    others.extend(by_whole_bins(scene));
    others.extend(other_exponents(scene));
    let explaining = |mistake: Mistake| {
        let fit = asked.light_if_promising(case, &mistake.scene)?.fit(lit);
        let explains = fit.tally.explains(NOTABLE) && fit.left <= LEFT_BY_MISTAKE;
        explains.then_some((mistake, fit))
    };
    let is_where_shown = |(mistake, _): &(Mistake, Fit)| explains_objects(case, &mistake.scene);
    let moves = moves.into_iter().filter_map(explaining);
    let of_no_size = moves.filter(is_where_shown);
    let of_no_size = of_no_size.chain(others.into_iter().filter_map(explaining));
    let of_times = of_some_size(case, &asked, light, &times(scene), |x| later(scene, x));
    let of_times = of_times.map(|(x, fit)| (lookup(scene, x), fit));
    let speeds: &[f64] = if case.has_places() { &[] } else { &SPEEDS };
    let of_speeds = of_some_size(case, &asked, light, speeds, |x| faster(scene, x));
    let of_speeds = of_speeds.filter(|(x, fit)| x.abs() >= SLOWEST && fit.left <= LEFT_BY_SPEED);
    let of_speeds = of_speeds.and_then(|(x, fit)| Some((speed(scene, x)?, fit)));
    let of_speeds = of_speeds.filter(is_where_shown);
    let mut found: Vec<(Mistake, Fit)> = of_no_size.chain(of_times).chain(of_speeds).collect();
    if found.is_empty() {
        found.extend(elsewhere(case, scene, &asked, unchanged));
    }
    let rest = |(_, fit): &(Mistake, Fit)| fit.tally.rest();
    let best = (found.iter()).min_by(|a, b| rest(a).total_cmp(&rest(b)))?;
    // Several mistakes may move the same object out of view: then light cannot distinguish them.
    let alike = found.iter().filter(|found| {
        !std::ptr::eq(*found, best) && rest(found) == rest(best) && found.1.left == best.1.left
    });
    let alike: Vec<&str> = alike.map(|(mistake, _)| mistake.what.as_str()).collect();
    let (mistake, fit) = best;
    let or = match alike.is_empty() {
        true => String::new(),
        false => format!("; the same light is that where {}", alike.join("; or ")),
    };
    let diagnosis = Diagnosis {
        kind: mistake.kind,
        what: format!("{}{or}", mistake.what).into(),
        evidence: evidence_of(mistake.size, fit),
    };
    Some((diagnosis, fit.left))
}

/// The largest fraction of wrongly shown objects that a mistake may leave: those at edges, where samples are elsewhere.
const LEFT_OF_OBJECTS: f64 = 0.5;

/// Whether a scene shows the objects that the candidate shows, where those differ from the reference's; true if nothing says so.
fn explains_objects(case: &Case, scene: &Scene) -> bool {
    if !case.shows_objects_elsewhere() {
        return true;
    }
    let Some(objects) = objects_of(case, scene) else {
        return true;
    };
    let [r, c] = &case.points;
    let count =
        |is_wrong: &dyn Fn(&&usize) -> bool| case.everywhere().iter().filter(is_wrong).count();
    let was = count(&|i| r.object_at(**i) != c.object_at(**i));
    let is = count(&|i| objects.get(**i).copied() != c.object_at(**i));
    is as f64 <= LEFT_OF_OBJECTS * was as f64
}

/// The time and position of the events of one object alone at pixel centres, with a change or without.
pub(super) fn events_of(
    case: &Case,
    object: usize,
    change: Option<Change>,
) -> Option<BTreeMap<usize, (f64, DVec3)>> {
    let mut scene = match change {
        Some(change) => changed(case.scene?, change)?,
        None => case.scene?.clone(),
    };
    let size = case.points[0].size();
    let is_of_size = scene.camera.size.map(|n| n as usize) == size;
    (is_of_size && object < scene.objects.len()).then_some(())?;
    scene.objects = vec![scene.objects.swap_remove(object)];
    // Light does not affect events.
    scene.lights.clear();
    scene.sources.clear();
    (scene.sky, scene.bounces, scene.samples_per_pixel) = (None, 0, 1);
    let mut request = Request {
        aovs: vec![
            Aov::Object,
            Aov::EventCt,
            Aov::EventX,
            Aov::EventY,
            Aov::EventZ,
        ],
        pixel_centers: true,
        ..Request::default()
    };
    if is_all_in_its_text(&scene) {
        request.memory_limit = MEMORY;
    }
    let plan = Plan::new(&scene, &request).ok()?;
    let prepared = Prepared::new(&scene, &plan, &Silent).ok()?;
    let film = render(&prepared, &Silent).ok()?;
    let (is_hit, times) = (film.aov(Aov::Object)?, film.aov(Aov::EventCt)?);
    let (x, y, z) = (
        film.aov(Aov::EventX)?,
        film.aov(Aov::EventY)?,
        film.aov(Aov::EventZ)?,
    );
    let hit = case.region.pixels(size).filter(|i| is_hit[*i] >= 0.0);
    Some(
        hit.map(|i| (i, (times[i], DVec3::new(x[i], y[i], z[i]))))
            .collect(),
    )
}

/// The relative error of light below which at least half of the pixels must be if the scene is the reference's, whatever their samples.
const SAME_LIGHT: f64 = 0.05;

/// The light of the scene, and its size, if that is the reference's light.
fn light_if_that_of(case: &Case, scene: &Scene, lit: &[Lit]) -> Option<(Light, f64)> {
    let (Light(light), size) = light_and_size_of(case, scene, lit)?;
    let sum = |light: &[f64; 3]| light.iter().sum::<f64>();
    let off = lit
        .iter()
        .map(|(i, [r, _])| (sum(&light[*i]) / sum(r) - 1.0).abs());
    median(off.collect())
        .filter(|off| *off <= SAME_LIGHT)
        .map(|_| (Light(light), size))
}

/// The most pulses and lamps that are tested for other places.
const MOST_LIGHTS: usize = 4;

/// The camera, a pulse or a lamp at another place.
fn elsewhere(
    case: &Case,
    scene: &Scene,
    asked: &Asked,
    unchanged: &(Light, f64),
) -> Option<(Mistake, Fit)> {
    let (light, size) = (&unchanged.0, unchanged.1);
    let mut found = Vec::new();
    let mut test = |kind, change: &dyn Fn(&mut Scene, DVec3), words: &dyn Fn(DVec3) -> String| {
        let scene_with = |x: DVec3| {
            let mut changed = scene.clone();
            change(&mut changed, x);
            Some(changed)
        };
        found.extend(
            of_some_place(case, asked, light, size, &scene_with).map(|(x, fit)| {
                let what = format!("{} (judged by light only)", words(x));
                let size = ("displaced by (m)", x.length());
                let scene = scene.clone();
                (
                    Mistake {
                        kind,
                        what,
                        size,
                        scene,
                    },
                    fit,
                )
            }),
        );
    };
    let eye = scene.camera.origin.x;
    if !case.has_places() {
        test(
            Kind::CameraElsewhere,
            &|scene, x| scene.camera.origin.x += x,
            &|x| elsewhere_in_words(eye + x, eye),
        );
    }
    let in_words = |name: &str, is: DVec3, right: DVec3| {
        let [is, right] = [is, right].map(in_words);
        format!("{name} is elsewhere: at {is} m, and should be at {right} m")
    };
    for (k, source) in scene.sources.iter().enumerate().take(MOST_LIGHTS) {
        if let SourceKind::Pulse(pulse) = &source.kind {
            let right = pulse.origin.x;
            let change = |scene: &mut Scene, x| {
                if let SourceKind::Pulse(pulse) = &mut scene.sources[k].kind {
                    pulse.origin.x += x;
                }
            };
            let words = |x| in_words(&format!("the pulse {:?}", source.name), right + x, right);
            test(Kind::LightElsewhere, &change, &words);
        }
    }
    for (k, light) in scene.lights.iter().enumerate().take(MOST_LIGHTS) {
        if let LightKind::Lamp(lamp) = &light.kind
            && lamp.motion == Motion::Inertial
        {
            let right = lamp.origin.x;
            let change = |scene: &mut Scene, x| {
                if let LightKind::Lamp(lamp) = &mut scene.lights[k].kind {
                    lamp.origin.x += x;
                }
            };
            let words = |x| in_words(&format!("the lamp {:?}", light.name), right + x, right);
            test(Kind::LightElsewhere, &change, &words);
        }
    }
    found
        .into_iter()
        .min_by(|a, b| a.1.left.total_cmp(&b.1.left))
}

/// Delays to try, relative to the shortest time in which light changes.
const DELAYS: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];

/// The delays to test: empty if nothing changes in time.
fn times(scene: &Scene) -> Vec<f64> {
    let of_source = |kind: &SourceKind| match kind {
        SourceKind::Cube(cube) => cube.bins.width(),
        SourceKind::Pulse(pulse) => pulse.sigma,
    };
    let of_profile = |profile: &EmissionProfile| match profile {
        EmissionProfile::Steady => None,
        EmissionProfile::Gaussian { sigma, .. } | EmissionProfile::Train { sigma, .. } => {
            Some(*sigma)
        }
        EmissionProfile::Table(table) => {
            let steps = table.windows(2).map(|pair| pair[1][0] - pair[0][0]);
            steps.filter(|step| *step > 0.0).reduce(f64::min)
        }
    };
    let of_light = |kind: &LightKind| match kind {
        LightKind::Lamp(lamp) => of_profile(&lamp.emission),
        LightKind::Area { emission, .. } => of_profile(emission),
    };
    let sources = scene.sources.iter().map(|source| of_source(&source.kind));
    let lights = scene
        .lights
        .iter()
        .filter_map(|light| of_light(&light.kind));
    let Some(shortest) = sources.chain(lights).reduce(f64::min) else {
        return Vec::new();
    };
    let both = DELAYS.into_iter().flat_map(|part| [part, -part]);
    both.map(|part| part * shortest).collect()
}

/// The scene with the light of all its sources looked up `delay` too late: sources that start earlier are looked up later.
fn later(scene: &Scene, delay: f64) -> Option<Scene> {
    let profile = |profile: &mut EmissionProfile| match profile {
        EmissionProfile::Steady => {}
        EmissionProfile::Gaussian { centre, .. } | EmissionProfile::Train { centre, .. } => {
            *centre -= delay;
        }
        EmissionProfile::Table(table) => table.iter_mut().for_each(|row| row[0] -= delay),
    };
    let mut shifted = scene.clone();
    for source in &mut shifted.sources {
        match &mut source.kind {
            SourceKind::Cube(cube) => cube.bins = cube.bins.shifted(-delay),
            SourceKind::Pulse(pulse) => pulse.origin.ct -= delay,
        }
    }
    for light in &mut shifted.lights {
        match &mut light.kind {
            LightKind::Lamp(lamp) => profile(&mut lamp.emission),
            LightKind::Area { emission, .. } => profile(emission),
        }
    }
    Some(shifted)
}

/// The diagnosis of a delay.
fn lookup(scene: &Scene, delay: f64) -> Mistake {
    let late = if delay > 0.0 { "late" } else { "early" };
    let widths = scene
        .sources
        .iter()
        .filter_map(|source| match &source.kind {
            SourceKind::Cube(cube) => Some(cube.bins.width()),
            SourceKind::Pulse(_) => None,
        });
    let (what, size) = match widths.reduce(f64::min) {
        Some(width) => (
            format!(
                "light is looked up {} too {late} in the cubes: {:.4} m",
                words_for_bins((delay / width).abs()),
                delay.abs()
            ),
            ("shift (bins)", delay / width),
        ),
        None => (
            format!("pulses are looked up {:.4} m too {late}", delay.abs()),
            ("shift (m)", delay),
        ),
    };
    Mistake {
        kind: Kind::LookupShifted,
        what,
        size,
        scene: scene.clone(),
    }
}

/// The scene without retardation, with other aberrations, and with objects at rest or moving in the opposite direction.
fn motions(scene: &Scene) -> Vec<Mistake> {
    let mut mistakes = Vec::new();
    let mut add = |change: Change, kind, what: String, beta: Velocity| {
        mistakes.extend(changed(scene, change).map(|scene| Mistake {
            kind,
            what: format!("{what} (judged by light only)"),
            size: ("beta", beta.beta().length()),
            scene,
        }));
    };
    let moves = |velocity: &Velocity| !velocity.is_rest();
    let fastest = scene.objects.iter().map(|object| object.velocity);
    let fastest = fastest.reduce(|a, b| match a.beta().length() < b.beta().length() {
        true => b,
        false => a,
    });
    // A missing retardation is most visible in the fastest object.
    if let Some(fastest) = fastest {
        add(
            Change::Instant,
            Kind::RetardationMissing,
            "retardation is missing: the picture is that of the time of the shot".into(),
            fastest,
        );
        if moves(&fastest) {
            let what = format!("{ADVANCED}: the picture is that of places as long after the shot");
            let kind = Kind::RetardationReversed;
            add(Change::Advanced, kind, what, fastest);
        }
    }
    let camera = scene.camera.velocity;
    if moves(&camera) {
        let (reversed, missing) = (Kind::AberrationReversed, Kind::AberrationMissing);
        let what = "aberration is reversed: the picture is that of a camera that moves in the opposite direction (−β for β)";
        add(Change::CameraReversed, reversed, what.into(), camera);
        let what = "aberration is missing: the picture is that of a camera at rest";
        add(Change::CameraAtRest, missing, what.into(), camera);
    }
    let moving = scene
        .objects
        .iter()
        .map(|object| object.velocity)
        .enumerate();
    for (k, velocity) in moving.filter(|(_, v)| moves(v)).take(MOST_OBJECTS) {
        let what = format!(
            "the velocity of object {k} is missing: the picture is that of the object at rest"
        );
        add(Change::AtRest(k), Kind::VelocityMissing, what, velocity);
        let what =
            format!("the velocity of object {k} is reversed: the picture is that of −β for β");
        add(Change::Reversed(k), Kind::VelocityWrong, what, velocity);
    }
    let velocities: Vec<Velocity> = (scene.objects.iter())
        .map(|object| object.velocity)
        .take(MOST_EXCHANGED)
        .collect();
    for (j, of_j) in velocities.iter().enumerate() {
        for (k, of_k) in velocities.iter().enumerate().skip(j + 1) {
            if of_j != of_k {
                let what = format!(
                    "the velocities of objects {j} and {k} are swapped: the picture is that with exchanged velocities"
                );
                let swapped = Change::Swapped(j, k);
                add(swapped, Kind::VelocitiesSwapped, what, *of_j);
            }
        }
    }
    mistakes.extend(of_all_objects(scene));
    mistakes
}

/// The scene with all objects reversed, or at rest, at their origins, or where these are at the time of the shot; none if fewer than two move.
fn of_all_objects(scene: &Scene) -> Vec<Mistake> {
    let fastest = scene
        .objects
        .iter()
        .map(|object| object.velocity.beta().length());
    let fastest = fastest.fold(0.0, f64::max);
    if scene
        .objects
        .iter()
        .filter(|object| !object.velocity.is_rest())
        .count()
        < 2
    {
        return Vec::new();
    }
    let Ok(shot) = Shot::new(&scene.camera) else {
        return Vec::new();
    };
    let at_rest = |at_shot: bool| {
        let mut at_rest = scene.clone();
        for object in &mut at_rest.objects {
            let origin = &mut object.origin;
            if at_shot {
                *origin = at_time(object.velocity, *origin, shot.event.ct);
            }
            object.velocity = Velocity::REST;
        }
        let place = if at_shot {
            ", where they are at the time of the shot"
        } else {
            ""
        };
        Mistake {
            kind: Kind::VelocityMissing,
            what: format!(
                "the velocities of all objects are missing: the picture is that of objects at rest{place} (judged by light only)"
            ),
            size: ("beta", fastest),
            scene: at_rest,
        }
    };
    let mut reversed = scene.clone();
    for object in &mut reversed.objects {
        object.velocity = -object.velocity;
    }
    let reversed = Mistake {
        kind: Kind::VelocityWrong,
        what: "the velocities of all objects are reversed: the picture is that of −β for β (judged by light only)".into(),
        size: ("beta", fastest),
        scene: reversed,
    };
    vec![at_rest(false), at_rest(true), reversed]
}

/// The scene with the camera at rest.
fn camera_at_rest(scene: &Scene) -> Option<Mistake> {
    let velocity = scene.camera.velocity;
    (!velocity.is_rest()).then_some(())?;
    let mut at_rest = scene.clone();
    at_rest.camera.velocity = Velocity::REST;
    Some(Mistake {
        kind: Kind::CameraVelocity,
        what: "the camera's velocity is missing: the picture is that of a camera at rest, without aberration, Doppler shift and searchlight effect (judged by light only)".into(),
        size: ("beta", velocity.beta().length()),
        scene: at_rest,
    })
}

/// Rapidities to try that a moving camera may have in excess.
const SPEEDS: [f64; 14] = [
    -0.64, -0.32, -0.16, -0.08, -0.04, -0.02, -0.01, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32, 0.64,
];
/// The largest fraction of the squared error that another speed may leave.
const LEFT_BY_SPEED: f64 = 0.06;

/// The least such rapidity that is reported: the film that is moved by a fraction of a pixel looks like a smaller one.
const SLOWEST: f64 = 0.01;

/// The scene with the camera faster by a rapidity, in the direction of its motion; `None` if it is at rest, or accelerated.
fn faster(scene: &Scene, excess: f64) -> Option<Scene> {
    let camera = &scene.camera;
    (camera.motion == Motion::Inertial && !camera.velocity.is_rest()).then_some(())?;
    let (n, rapidity) = camera.velocity.split();
    let mut faster = scene.clone();
    faster.camera.velocity = Velocity::from_rapidity((rapidity + excess) * n).ok()?;
    Some(faster)
}

/// The diagnosis of a camera that is faster by a rapidity.
fn speed(scene: &Scene, excess: f64) -> Option<Mistake> {
    let scene_of_it = faster(scene, excess)?;
    let [right, is] = [scene, &scene_of_it].map(|scene| scene.camera.velocity.beta());
    Some(Mistake {
        kind: Kind::CameraVelocity,
        what: format!(
            "the camera moves at another velocity: the picture is that of a camera with β = {}, and should be that of one with {} (judged by light only)",
            in_words(is),
            in_words(right)
        ),
        size: ("beta differs by", (is - right).length()),
        scene: scene_of_it,
    })
}

/// The scene whose pulses shine through everything.
fn without_shadows(scene: &Scene) -> Option<Mistake> {
    let mut without = scene.clone();
    let mut count = 0;
    for source in &mut without.sources {
        if let SourceKind::Pulse(pulse) = &mut source.kind
            && pulse.shadows
        {
            pulse.shadows = false;
            count += 1;
        }
    }
    (count > 0).then(|| Mistake {
        kind: Kind::ShadowsMissing,
        what: "shadows are missing: the light is that of pulses that shine through everything"
            .into(),
        size: ("pulses", f64::from(count)),
        scene: without,
    })
}

/// One quantity of each exponent.
const OF_EXPONENTS: [Quantity; 4] = [
    Quantity::PhotonsPerFrequency,
    Quantity::PerFrequency,
    Quantity::Integrated,
    Quantity::PerWavelength,
];

/// The scene with radiances of another quantity, if cubes, pulses or lamps light it: light that pulses and lamps bring to moving objects has
/// the exponent, too, and where pixels have several samples, that of a cube is not W^k for one W. Other light has W^k for its ratio, which
/// needs no scene.
fn other_exponents(scene: &Scene) -> Vec<Mistake> {
    let shines = !scene.sources.is_empty() || !scene.lights.is_empty();
    let has_exponent = scene.quantity.hue() == Hue::Stays;
    let right = scene.quantity.exponent();
    let are_alike = scene
        .sources
        .iter()
        .all(|source| source.quantity == scene.quantity);
    let others = OF_EXPONENTS
        .into_iter()
        .filter(|other| other.exponent() != right);
    let with = |other: Quantity| {
        let mut with = scene.clone();
        with.quantity = other;
        with.sources
            .iter_mut()
            .for_each(|source| source.quantity = other);
        let is = other.exponent();
        Mistake {
            kind: Kind::ExponentWrong,
            what: format!(
                "the exponent p of W is {is} and should be {right}: the light is that of radiances as {other}, both from surfaces and on them"
            ),
            size: ("exponent", f64::from(is)),
            scene: with,
        }
    };
    match shines && has_exponent && are_alike {
        true => others.map(with).collect(),
        false => Vec::new(),
    }
}

/// The scene whose cubes are looked up in the bin that contains a time, without interpolation.
fn by_whole_bins(scene: &Scene) -> Option<Mistake> {
    let mut whole = scene.clone();
    let mut width = None;
    for source in &mut whole.sources {
        if let SourceKind::Cube(cube) = &mut source.kind
            && cube.filter != TimeFilter::Nearest
        {
            cube.filter = TimeFilter::Nearest;
            width = width.or(Some(cube.bins.width()));
        }
    }
    let width = width?;
    Some(Mistake {
        kind: Kind::TimesRounded,
        what: format!(
            "times are rounded to whole bins in the lookup of light: it is that of the bin of {width:.4} m that contains them, without interpolation between bins"
        ),
        size: ("width of a bin (m)", width),
        scene: whole,
    })
}

/// The scene with an object out of view, `far` metres away along each axis.
fn absences(scene: &Scene, far: f64) -> Vec<Mistake> {
    let without = |k: usize| {
        let mut without = scene.clone();
        let origin = &mut without.objects[k].origin;
        origin.x += DVec3::splat(far);
        Mistake {
            kind: Kind::ObjectMissing,
            what: format!(
                "object {k} is missing, or out of view: the picture is that without it (judged by light only)"
            ),
            size: ("object", k as f64),
            scene: without,
        }
    };
    (0..scene.objects.len())
        .take(MOST_OBJECTS)
        .map(without)
        .collect()
}

/// The scene with a mistake; `None` if it does not apply to it, or would be refused.
fn changed(scene: &Scene, change: Change) -> Option<Scene> {
    let mut changed = scene.clone();
    match change {
        // Light that takes no time cannot be traced between surfaces.
        Change::Instant if scene.bounces > 0 => return None,
        Change::Instant => changed.effects.retardation = false,
        Change::Advanced => {
            let ct = Shot::new(&scene.camera).ok()?.event.ct;
            for object in &mut changed.objects {
                object.origin = at_time(object.velocity, object.origin, ct);
                object.velocity = -object.velocity;
            }
        }
        Change::CameraAtRest => changed.effects.aberration = false,
        // For other motions, the velocity is instantaneous.
        Change::CameraReversed if scene.camera.motion != Motion::Inertial => return None,
        Change::CameraReversed => changed.camera.velocity = -scene.camera.velocity,
        Change::AtRest(k) => changed.objects.get_mut(k)?.velocity = Velocity::REST,
        Change::Reversed(k) => {
            let object = changed.objects.get_mut(k)?;
            object.velocity = -object.velocity;
        }
        Change::Swapped(j, k) => {
            let (of_j, of_k) = (
                scene.objects.get(j)?.velocity,
                scene.objects.get(k)?.velocity,
            );
            changed.objects[j].velocity = of_k;
            changed.objects[k].velocity = of_j;
        }
        Change::Standing(_) | Change::CameraWithoutGamma | Change::Uncontracted => return None,
    }
    Some(changed)
}
