//! `nullray plan`.

use nullray::Result;
use nullray::figures::overlay;
use nullray::mesh::Factors;
use nullray::render;
use nullray::render::plan::{PlannedObject, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::survey;
use nullray::scene::model::{EmissionProfile, Light, LightKind, Source, SourceKind};

use super::args::PlanArguments;
use super::console::{print, print_json, warn, with_short_lines};
use super::flags::with_flags;
use super::progress::Bar;
use super::{builtin, remarks};

/// The largest cubes, bytes, that a plan reads to report whether light in view misses their times; `render` examines larger ones too.
const LOOKED_INTO: u64 = 256 << 20;

/// The largest mesh that is loaded to report its tessellation, triangles.
const LOADED: u64 = 1 << 20;

pub fn run(arguments: &PlanArguments) -> Result<()> {
    let changes = &arguments.scene.changes;
    let file = builtin::open_as(
        arguments.scene.path(),
        &arguments.model.view(None),
        &changes.overrides(),
        changes.memory.bytes(),
    )?;
    let scene = arguments.scene.of(&file)?;
    let aovs = arguments.channels.list();
    let parts = arguments.lines.parts();
    let beside = match arguments.overlay {
        true => overlay::bytes(scene.camera.size, parts),
        false => 0,
    };
    let request = Request {
        aovs,
        beside,
        ..arguments.scene.changes.request(None)
    };
    let mut plan = arguments.method.method.plan(&scene, &request)?;
    let method = &arguments.method.method;
    method.explain_cuts(&scene, &mut plan, LOADED)?;
    let bar = Bar::new(plan.rays.camera, arguments.json.on).named("what will be read".into());
    render::estimate_reads(&scene, &mut plan, &bar)?;
    drop(bar);
    let cubes = plan.cubes.iter().flatten().map(|cube| cube.bytes);
    let bytes: u64 = cubes.sum();
    if (1..=LOOKED_INTO).contains(&bytes) && !arguments.json.on {
        let mut prepared = Prepared::new(&scene, &plan, &Silent)?;
        let misfits = survey::misfits(&scene, &mut prepared);
        warn(false, prepared.warnings.iter().chain(&misfits));
    }
    let is_timed = |light: &Light| match &light.kind {
        LightKind::Lamp(lamp) => lamp.emission != EmissionProfile::Steady,
        LightKind::Area { emission, .. } => *emission != EmissionProfile::Steady,
    };
    let is_pulse = |source: &Source| matches!(source.kind, SourceKind::Pulse(_));
    let is_timed = scene.lights.iter().any(is_timed) || scene.sources.iter().any(is_pulse);
    let triangles: u64 = plan.objects.iter().map(|object| object.triangles).sum();
    // Textures may make surfaces into mirrors, along which light is traced; and the camera may be inside glass.
    let matters = |object: &PlannedObject| {
        object.has_gloss_textures || object.factors.iter().any(Factors::is_glass)
    };
    let is_followed = scene.bounces > 0 && plan.objects.iter().any(matters);
    if (is_timed || is_followed) && bytes <= LOOKED_INTO && triangles <= LOADED {
        // A plan tolerates meshes that cannot be read yet: rendering reports what is missing.
        if let Ok(mut prepared) = Prepared::new(&scene, &plan, &Silent) {
            survey::note_mirrors_by_texture(&scene, &mut plan, &prepared);
            let moments = survey::moments(&scene, &mut prepared, false);
            plan.notes.extend(moments.iter().map(with_flags));
            let in_glass = remarks::in_glass(&scene, &prepared);
            plan.notes.extend(in_glass.lines().map(str::to_owned));
        }
    }
    plan.notes.extend(remarks::will_be_shifted(&scene)?);
    match arguments.json.on {
        true => print_json(&plan),
        false => print(&with_short_lines(&plan.to_string())),
    }
}
