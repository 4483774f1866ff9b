//! `nullray export`.

use nullray::Result;
use nullray::render::plan::{self, Plan};
use nullray::scene::model::Scene;
use nullray::validate::export::{self, Cubes, ExportOptions, Exported};

use super::args::{CubesArgument, ExportArguments};
use super::console::{print, warn};
use super::failure::refused;
use super::progress::Bar;
use super::{film, inputs, interrupt, memory};

pub fn run(arguments: &ExportArguments) -> Result<()> {
    let scene = arguments.scene.load()?;
    let options = ExportOptions {
        reference: !arguments.no_reference,
        cubes: match arguments.cubes {
            CubesArgument::Copy => Cubes::Copied,
            CubesArgument::Reference => Cubes::Referenced,
        },
        vectors: arguments.vectors,
        overwrite: arguments.overwrite,
        memory_limit: arguments.scene.changes.memory.bytes(),
        program: memory::program(arguments.work.threads.count),
    };
    let plan = export::plan(&scene, &options)?;
    check(arguments, &scene, &plan)?;
    let exported = film::in_pool(arguments.work.threads.count, || {
        let bar = Bar::new(plan.rays.camera, arguments.work.quiet.on);
        bar.start();
        export::export(&scene, &arguments.output, &options, &bar)
    })?;
    interrupt::check()?;
    match arguments.work.quiet.on {
        true => Ok(()),
        false => report(arguments, &exported),
    }
}

/// Refuses to replace a directory that the scene is read from.
fn check(arguments: &ExportArguments, scene: &Scene, plan: &Plan) -> Result<()> {
    let target = inputs::identity(&arguments.output);
    let read = inputs::of(scene, plan);
    match read
        .iter()
        .find(|path| inputs::identity(path).starts_with(&target))
    {
        None => Ok(()),
        Some(path) => Err(refused(
            format!("-o {}", arguments.output.display()),
            format!("the scene reads {}, which is inside it", path.display()),
            "write to another name",
        )),
    }
}

fn report(arguments: &ExportArguments, exported: &Exported) -> Result<()> {
    let bundle = &exported.bundle;
    let triangles: u64 = bundle.objects.iter().map(|o| o.triangles).sum();
    let bytes: u64 = bundle.files.iter().map(|f| f.bytes).sum();
    let reference = match &bundle.reference {
        Some(reference) => format!("reference pictures {} and .exr", reference.npz),
        None => "no reference pictures".into(),
    };
    let plural = |n: usize| if n == 1 { "" } else { "s" };
    let (objects, sources) = (bundle.objects.len(), bundle.sources.len());
    print(&format!(
        "wrote {}: {objects} object{} ({} triangles), {sources} source{}, {reference}; {} files, {}\n\
         README.md in it says how to read it, and how to compare\n",
        arguments.output.display(),
        plural(objects),
        plan::count(triangles),
        plural(sources),
        bundle.files.len() + 1,
        plan::bytes(bytes),
    ))?;
    warn(false, &exported.warnings);
    Ok(())
}
