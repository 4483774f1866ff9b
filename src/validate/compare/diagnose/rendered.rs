//! Mistakes that are known by the light of the scene rendered with them: times of lookup, and where channels of places are
//! missing, motions and retardation. They need the scene itself.

use glam::DVec3;

use super::super::known::Change;
use super::light::{Lit, NOTABLE, evidence, lit, told};
use super::time::words_for_bins;
use super::{Case, Diagnosis, Kind, Tally};
use crate::render::plan::{Plan, Request};
use crate::render::prepare::Prepared;
use crate::render::progress::Silent;
use crate::render::render;
use crate::scene::model::{Motion, Scene, Source, SourceKind};
use crate::spacetime::Velocity;

/// Shifts of the time of lookup that are asked about, bins.
const SHIFTS: [f64; 4] = [0.5, -0.5, 1.0, -1.0];
/// No more moving objects are asked about.
const MOST_OBJECTS: usize = 8;
/// How far away what is left out goes, metres.
const FAR: f64 = 1e7;
/// Samples per pixel at most: edges alone have more.
const MOST_SAMPLES: u32 = 16;

/// A scene with a mistake, and what is said of it.
struct Mistake {
    kind: Kind,
    what: String,
    size: (&'static str, f64),
    scene: Scene,
}

/// The mistake with which the scene has the candidate's light.
pub(super) fn changes(case: &Case) -> Option<Diagnosis> {
    let scene = case.scene?;
    let lit = lit(case)?;
    if told(&lit, |_, r| r).tally.error() <= NOTABLE {
        return None;
    }
    let mut mistakes = lookups(scene);
    if !case.has_places() {
        // Before other mistakes that leave an object out of view.
        mistakes.extend(absences(scene));
        mistakes.extend(motions(scene));
    }
    let tallies = mistakes.into_iter().filter_map(|mistake| {
        let tally = of_scene(case, &mistake.scene, &lit)?;
        tally.explains(NOTABLE).then_some((mistake, tally))
    });
    let (mistake, tally) = tallies.min_by(|a, b| a.1.rest().total_cmp(&b.1.rest()))?;
    Some(Diagnosis {
        kind: mistake.kind,
        what: mistake.what,
        evidence: [mistake.size].into_iter().chain(evidence(&tally)).collect(),
    })
}

/// How far the candidate is from the light of a scene.
fn of_scene(case: &Case, scene: &Scene, lit: &[Lit]) -> Option<Tally> {
    let mut scene = scene.clone();
    scene.samples_per_pixel = scene.samples_per_pixel.min(MOST_SAMPLES);
    let request = Request {
        pixel_centers: case.pair[0].metadata("pixel_centers") == Some("true"),
        ..Request::default()
    };
    let plan = Plan::new(&scene, &request).ok()?;
    let film = render(&Prepared::new(&scene, &plan, &Silent).ok()?, &Silent).ok()?;
    let light = film.radiance();
    let [width, height] = case.points[0].size();
    (light.len() == width * height).then_some(())?;
    Some(told(lit, |i, _| light[i]).tally)
}

/// The scene with its cubes at shifted times.
fn lookups(scene: &Scene) -> Vec<Mistake> {
    let is_cube = |source: &Source| matches!(source.kind, SourceKind::Cube(_));
    if !scene.sources.iter().any(is_cube) {
        return Vec::new();
    }
    let shifted = |bins: f64| {
        let mut shifted = scene.clone();
        for source in &mut shifted.sources {
            if let SourceKind::Cube(cube) = &mut source.kind {
                // Data that start later are looked up earlier.
                cube.bins = cube.bins.shifted(-bins * cube.bins.width());
            }
        }
        let late = if bins > 0.0 { "late" } else { "early" };
        let amount = words_for_bins(bins.abs());
        Mistake {
            kind: Kind::LookupShifted,
            what: format!("light is looked up {amount} too {late} in the cubes"),
            size: ("shift (bins)", bins),
            scene: shifted,
        }
    };
    SHIFTS.into_iter().map(shifted).collect()
}

/// The scene without retardation, with other aberrations, and with objects at rest or moving the opposite way.
fn motions(scene: &Scene) -> Vec<Mistake> {
    let mut mistakes = Vec::new();
    let mut add = |change: Change, kind, what: String, beta: Velocity| {
        mistakes.extend(changed(scene, change).map(|scene| Mistake {
            kind,
            what: format!("{what}: light alone says so"),
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
    // A missing retardation shows by what moves fastest.
    if let Some(fastest) = fastest {
        add(
            Change::Instant,
            Kind::RetardationMissing,
            "retardation is missing: the picture is that of the time of the shot".into(),
            fastest,
        );
    }
    let camera = scene.camera.velocity;
    if moves(&camera) {
        let (reversed, missing) = (Kind::AberrationReversed, Kind::AberrationMissing);
        let what = "aberration is reversed: the picture is that of a camera that moves the opposite way (−β for β)";
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
        let what =
            format!("the velocity of object {k} is missing: the picture is that of its rest");
        add(Change::AtRest(k), Kind::VelocityMissing, what, velocity);
        let what =
            format!("the velocity of object {k} is reversed: the picture is that of −β for β");
        add(Change::Reversed(k), Kind::VelocityWrong, what, velocity);
    }
    mistakes
}

/// The scene with an object far out of view.
fn absences(scene: &Scene) -> Vec<Mistake> {
    let without = |k: usize| {
        let mut without = scene.clone();
        let origin = &mut without.objects[k].origin;
        origin.x += DVec3::splat(FAR);
        Mistake {
            kind: Kind::ObjectMissing,
            what: format!(
                "object {k} is missing, or out of view: the picture is that without it: light alone says so"
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

/// The scene with a mistake; none where it has no such thing, or would be refused.
fn changed(scene: &Scene, change: Change) -> Option<Scene> {
    let mut changed = scene.clone();
    match change {
        // Light that takes no time is not followed from surface to surface.
        Change::Instant if scene.bounces > 0 => return None,
        Change::Instant => changed.effects.retardation = false,
        Change::CameraAtRest => changed.effects.aberration = false,
        // Of other motions, the velocity is that of one moment.
        Change::CameraReversed if scene.camera.motion != Motion::Inertial => return None,
        Change::CameraReversed => changed.camera.velocity = -scene.camera.velocity,
        Change::AtRest(k) => changed.objects.get_mut(k)?.velocity = Velocity::REST,
        Change::Reversed(k) => {
            let object = changed.objects.get_mut(k)?;
            object.velocity = -object.velocity;
        }
        Change::Standing(_) | Change::Swapped(..) => return None,
    }
    Some(changed)
}
