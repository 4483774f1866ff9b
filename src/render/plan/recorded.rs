//! Where a scene says other things of its cubes than their files.

use crate::error::number;
use crate::scene::model::{CubeSource, Mapping, Scene, Source, SourceKind};

/// What the files of the cubes of `scene` say otherwise than the scene, a sentence each.
pub fn contradicted(scene: &Scene) -> Vec<String> {
    let cubes = scene
        .sources
        .iter()
        .filter_map(|source| match &source.kind {
            SourceKind::Cube(cube) => Some((source, cube)),
            SourceKind::Pulse(_) => None,
        });
    cubes
        .flat_map(|(source, cube)| {
            let all = [
                keys(scene, cube),
                quantity(source, cube),
                medium(scene, cube),
            ];
            let name = format!("source {:?}: ", source.name);
            let file = cube.data.path().map(|path| path.display().to_string());
            let file = file.unwrap_or_default();
            (all.into_iter().flatten())
                .map(move |[by_file, by_scene]| format!("{name}{file} {by_file}, but {by_scene}"))
        })
        .collect()
}

/// What the file says, and what the scene does.
type Difference = Option<[String; 2]>;

/// The keys of the time axis; those of the scene are used.
fn keys(scene: &Scene, cube: &CubeSource) -> Difference {
    let (mut by_file, mut by_scene) = (Vec::new(), Vec::new());
    let mut differ = |key: &str, [file, scene]: [String; 2]| {
        by_file.push(format!("{key} = \"{file}\""));
        by_scene.push(format!("{key} = \"{scene}\""));
    };
    if let Some(times) = cube.recorded.times {
        // A capture of moving objects starts by the clock of its first object, and others have clocks of their own.
        let mut origins = scene.objects.iter().map(|object| object.origin);
        let first = origins.next();
        let moves = scene.objects.iter().any(|o| !o.velocity.is_rest());
        let has_clocks = moves && origins.any(|origin| Some(origin) != first);
        let is_own = has_clocks && matches!(cube.mapping, Mapping::Capture(_));
        for (key, both) in times.differing(cube.bins.edge(0), cube.bins.width()) {
            if key != "start" || !is_own {
                differ(key, both.map(|time| format!("{} m", number(time))));
            }
        }
    }
    let clock = cube.recorded.clock.as_deref();
    if let Some(clock) = clock.filter(|clock| *clock != cube.clock.name()) {
        differ("clock", [clock, cube.clock.name()].map(String::from));
    }
    (!by_file.is_empty()).then(|| {
        [
            format!("says {}", by_file.join(", ")),
            format!("the scene {}, which is used", by_scene.join(", ")),
        ]
    })
}

fn quantity(source: &Source, cube: &CubeSource) -> Difference {
    let said = cube.recorded.quantity.as_ref()?;
    let read_as = source.quantity.to_string();
    (*said != read_as).then(|| {
        [
            format!("holds radiance as {said}"),
            format!("the scene reads it as {read_as} (`radiance` of the source says which it is)"),
        ]
    })
}

fn medium(scene: &Scene, cube: &CubeSource) -> Difference {
    let said = cube.recorded.medium_index?;
    (said != scene.medium_index).then(|| {
        [
            format!("holds light delayed by a medium of refractive index {said}"),
            format!(
                "the scene's index is {} (`index` in [medium])",
                scene.medium_index
            ),
        ]
    })
}
