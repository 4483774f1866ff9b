//! `nullray plan`.

use nullray::Result;
use nullray::figures::overlay;
use nullray::mesh::Factors;
use nullray::render;
use nullray::render::plan::{Plan, PlannedObject, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::survey;
use nullray::scene::model::{EmissionProfile, Light, LightKind, Scene, Source, SourceKind};

use super::args::PlanArguments;
use super::console::{print, print_json, warn, with_short_lines};
use super::flags::with_flags;
use super::preview::Preview;
use super::progress::Bar;
use super::{builtin, inputs, remarks};

/// The largest cubes, bytes, that a plan reads to report whether light in view misses their times; `render` examines larger ones too.
const LOOKED_INTO: u64 = 256 << 20;

/// The largest mesh that is loaded to report its tessellation, triangles.
const LOADED: u64 = 1 << 20;

/// The largest scene of which a plan traces a few rays: triangles, and bytes of files.
const SURVEYED: u64 = 1 << 18;
const READ: u64 = 64 << 20;

/// The most columns and rows of these rays.
const RAYS: u32 = 64;

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
    let told = remarks::will_be_shifted(&scene)?;
    look_into(arguments, &scene, &mut plan, bytes, told.is_some())?;
    plan.notes.extend(told);
    match arguments.json.on {
        true => print_json(&plan),
        false => print(&with_short_lines(&plan.to_string())),
    }
}

/// Adds what only meshes and data tell, as far as they are not large: mainly why a picture will be dark. `bytes` are those of all cubes;
/// `is_shifted`: it is known that all light is shifted out of sight.
fn look_into(
    arguments: &PlanArguments,
    scene: &Scene,
    plan: &mut Plan,
    bytes: u64,
    is_shifted: bool,
) -> Result<()> {
    let reads_cubes = (1..=LOOKED_INTO).contains(&bytes) && !arguments.json.on;
    let triangles: u64 = plan.objects.iter().map(|object| object.triangles).sum();
    let is_surveyed = bytes <= LOOKED_INTO && triangles <= LOADED && matters(scene, plan);
    let is_small = bytes <= LOOKED_INTO && triangles <= SURVEYED;
    let is_seen = is_small && read(scene, plan) <= READ;
    if !reads_cubes && !is_surveyed && !is_seen {
        return Ok(());
    }
    let mut prepared = match Prepared::new(scene, plan, &Silent) {
        Ok(prepared) => prepared,
        Err(error) if reads_cubes => return Err(error),
        // A plan tolerates meshes that cannot be read yet: rendering reports what is missing.
        Err(_) => return Ok(()),
    };
    if reads_cubes {
        let misfits = survey::misfits(scene, &mut prepared);
        warn(false, prepared.warnings.iter().chain(&misfits));
    }
    if is_surveyed {
        survey::note_mirrors_by_texture(scene, plan, &prepared);
        let moments = survey::moments(scene, &mut prepared, false);
        plan.notes.extend(moments.iter().map(with_flags));
        let in_glass = remarks::in_glass(scene, &prepared);
        plan.notes.extend(in_glass.lines().map(str::to_owned));
    }
    if is_seen {
        let request = arguments.scene.changes.request(None);
        let preview = Preview::new(scene, &request, Vec::new(), RAYS)?;
        let film = preview.of(&mut prepared)?;
        let remarks = remarks::foreseen(&preview.scene, &film, is_shifted, &mut prepared);
        plan.notes.extend(remarks);
    }
    Ok(())
}

/// Whether times, mirrors by textures or glass make a difference that only meshes tell.
fn matters(scene: &Scene, plan: &Plan) -> bool {
    let is_timed = |light: &Light| match &light.kind {
        LightKind::Lamp(lamp) => lamp.emission != EmissionProfile::Steady,
        LightKind::Area { emission, .. } => *emission != EmissionProfile::Steady,
    };
    let is_pulse = |source: &Source| matches!(source.kind, SourceKind::Pulse(_));
    // Textures may make surfaces into mirrors, along which light is traced; and the camera may be inside glass.
    let is_followed = |object: &PlannedObject| {
        object.has_gloss_textures || object.factors.iter().any(Factors::is_glass)
    };
    scene.lights.iter().any(is_timed)
        || scene.sources.iter().any(is_pulse)
        || scene.bounces > 0 && plan.objects.iter().any(is_followed)
}

/// The bytes of all files that are read.
fn read(scene: &Scene, plan: &Plan) -> u64 {
    let files = inputs::of(scene, plan).into_iter();
    let sizes = files.filter_map(|path| Some(path.metadata().ok()?.len()));
    sizes.sum()
}
