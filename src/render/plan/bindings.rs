//! Which source lights which surface, what must be loaded of an object for it, and errors in bindings that headers alone reveal, each
//! with its place in the scene file.

use super::planned::PlannedObject;
use crate::error::{Error, Problem, Result};
use crate::scene::model::{
    Binding, EmissionProfile, Light, LightKind, Mapping, Scene, Source, SourceKind,
};

/// The source of a material's radiance on an object; indices of sources.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Lit {
    /// Its base colour.
    Base,
    /// The spectrum of its object.
    Spectrum,
    /// A stored cube.
    Cube(usize),
    /// Several cubes, each from its own capture camera, in the order of the scene.
    Captures(Vec<usize>),
    /// The scene's lights and sky, and these pulses, which it reflects.
    Reflecting(Vec<usize>),
}

/// What lights material `material` of object `object`: the object's own spectrum, else a cube, else pulses, lights and sky, else its base
/// colour.
pub fn lit_by(scene: &Scene, object: usize, material: &str) -> Lit {
    if scene.objects[object].spectrum.is_some() {
        return Lit::Spectrum;
    }
    let bound = |s: &Source| match &s.binding {
        Binding::All => true,
        Binding::Only { objects, materials } => {
            objects.contains(&object)
                && (materials.is_empty() || materials.iter().any(|m| m == material))
        }
    };
    // Cubes hold recorded light, so they take precedence over pulses, which are yet to be reflected.
    let (mut cubes, mut pulses) = (Vec::new(), Vec::new());
    for (index, source) in scene.sources.iter().enumerate().filter(|(_, s)| bound(s)) {
        match source.kind {
            SourceKind::Cube(_) => cubes.push(index),
            SourceKind::Pulse(_) => pulses.push(index),
        }
    }
    // Several cubes on one surface are all captures: others were refused when the scene was resolved.
    match cubes.as_slice() {
        [] => {}
        [only] => return Lit::Cube(*only),
        _ => return Lit::Captures(cubes),
    }
    if pulses.is_empty() && !scene.is_lit() {
        Lit::Base
    } else {
        Lit::Reflecting(pulses)
    }
}

/// The same for a material that may be unlit. In a scene with steady light, an unlit one shows its base colour, which is recorded
/// radiance; if all light comes in pulses, it reflects them like others.
pub(crate) fn shown_by(scene: &Scene, object: usize, (material, is_unlit): (&str, bool)) -> Lit {
    let steady = |light: &Light| match &light.kind {
        LightKind::Lamp(lamp) => lamp.emission == EmissionProfile::Steady,
        LightKind::Area { emission, .. } => *emission == EmissionProfile::Steady,
    };
    // The surface of an area light shows that light, so its base colour is no recorded radiance.
    let own =
        |light: &Light| matches!(light.kind, LightKind::Area { object: o, .. } if o == object);
    let has_steady =
        || scene.sky.as_ref().is_some_and(|sky| sky.lights) || scene.lights.iter().any(steady);
    match lit_by(scene, object, material) {
        Lit::Reflecting(pulses)
            if is_unlit && pulses.is_empty() && has_steady() && !scene.lights.iter().any(own) =>
        {
            Lit::Base
        }
        lit => lit,
    }
}

/// The sources that light anything.
pub(super) fn used_sources(scene: &Scene, objects: &[PlannedObject]) -> Vec<bool> {
    let mut used = vec![false; scene.sources.len()];
    for (index, object) in objects.iter().enumerate() {
        for material in &object.materials {
            match lit_by(scene, index, material) {
                Lit::Base | Lit::Spectrum => {}
                Lit::Cube(source) => used[source] = true,
                Lit::Captures(sources) | Lit::Reflecting(sources) => {
                    sources.iter().for_each(|s| used[*s] = true)
                }
            }
        }
    }
    used
}

/// The largest number of capture cameras on one surface.
pub(super) fn most_captures(scene: &Scene, objects: &[PlannedObject]) -> u64 {
    let is_projected = |source: usize| {
        let cube = match &scene.sources[source].kind {
            SourceKind::Cube(cube) => cube,
            SourceKind::Pulse(_) => return false,
        };
        matches!(cube.mapping, Mapping::Capture(_))
    };
    // Rays and memory grow with the captures of one surface, not with all of the scene.
    let of_surface = |object: usize, material: &String| match lit_by(scene, object, material) {
        Lit::Cube(source) => usize::from(is_projected(source)),
        Lit::Captures(sources) => sources.len(),
        Lit::Base | Lit::Spectrum | Lit::Reflecting(_) => 0,
    };
    let surfaces = objects
        .iter()
        .enumerate()
        .flat_map(|(object, planned)| planned.materials.iter().map(move |m| (object, m)));
    let most = surfaces.map(|(object, material)| of_surface(object, material));
    most.max().unwrap_or(0) as u64
}

/// What the radiance of shining surfaces adds to the light that they reflect.
const EMITS: &str = ", and what it emits";

/// Sets what is loaded of `object`, and the origin of its radiance.
pub(super) fn resolve(scene: &Scene, index: usize, object: &mut PlannedObject, wants_uv: bool) {
    object.uvs = wants_uv || object.has_masks;
    for (at, material) in object.materials.clone().iter().enumerate() {
        let is_unlit = object.unlit.contains(material);
        let lit = shown_by(scene, index, (material, is_unlit));
        let has = (object.images > 0, object.has_colours);
        let (uvs, textures, mut radiance) = needs(scene, &lit, has);
        let shines = object.factors.get(at).is_some_and(|factors| factors.emits);
        if shines && scene.is_lit() && matches!(lit, Lit::Reflecting(_)) {
            radiance += EMITS;
        }
        object.uvs |= uvs;
        object.normals |= object.has_normals && matches!(lit, Lit::Reflecting(_));
        object.textures |= textures;
        if !object.radiance.contains(&radiance) {
            object.radiance.push(radiance);
        }
    }
    // Said once if only parts of the surface shine.
    let all = object.radiance.clone();
    object
        .radiance
        .retain(|plain| !all.contains(&format!("{plain}{EMITS}")));
    for said in &mut object.radiance {
        if let Some(plain) = said.strip_suffix(EMITS)
            && all.iter().any(|other| other == plain)
        {
            *said = format!("{plain}, and what parts of it emit");
        }
    }
}

/// Whether texture coordinates, and images and vertex colours, are needed for what a surface shows, and its name in the plan.
fn needs(
    scene: &Scene,
    lit: &Lit,
    (has_images, has_colours): (bool, bool),
) -> (bool, bool, String) {
    let name = |s: &usize| scene.sources[*s].name.as_str();
    let textures = has_images || has_colours;
    match lit {
        Lit::Base if scene.is_lit() => {
            let words = "base colour as it is, whatever light there is (KHR_materials_unlit)";
            (has_images, textures, words.into())
        }
        Lit::Base => (has_images, textures, "base colour".into()),
        Lit::Spectrum => (false, false, "its own spectrum".into()),
        Lit::Reflecting(pulses) => {
            let lights = scene.lights.iter().map(|light| light.name.as_str());
            let sky = scene.sky.iter().filter(|sky| sky.lights).map(|_| "the sky");
            let names: Vec<_> = pulses.iter().map(name).chain(lights).chain(sky).collect();
            (
                has_images,
                textures,
                format!("base colour lit by {}", names.join(", ")),
            )
        }
        // Projection uses the capture camera: it needs no coordinates.
        Lit::Captures(sources) => {
            let names: Vec<_> = sources.iter().map(name).collect();
            (false, false, format!("{} by projection", names.join(", ")))
        }
        Lit::Cube(source) => {
            let SourceKind::Cube(cube) = &scene.sources[*source].kind else {
                return (false, false, String::new());
            };
            match cube.mapping {
                Mapping::Uv { set, .. } => (
                    true,
                    false,
                    format!("{} by texture coordinates {set}", name(source)),
                ),
                Mapping::Capture(_) => (false, false, format!("{} by projection", name(source))),
            }
        }
    }
}

/// Refuses sources that cannot light the surfaces that they are bound to.
pub(super) fn check(scene: &Scene, objects: &[PlannedObject]) -> Result<()> {
    for source in &scene.sources {
        check_materials(scene, source, objects)?;
    }
    for (index, object) in objects.iter().enumerate() {
        for material in &object.materials {
            match lit_by(scene, index, material) {
                Lit::Base | Lit::Spectrum => {}
                Lit::Cube(source) => check_uv_set(scene, &scene.sources[source], object)?,
                Lit::Captures(captures) => {
                    check_quantities(scene, &captures, object)?;
                    check_companions(scene, &captures, object)?;
                }
                Lit::Reflecting(pulses) => check_quantities(scene, &pulses, object)?,
            }
        }
    }
    Ok(())
}

/// Refuses a source that names materials which none of its objects has.
fn check_materials(scene: &Scene, source: &Source, objects: &[PlannedObject]) -> Result<()> {
    let Binding::Only {
        objects: bound,
        materials,
    } = &source.binding
    else {
        return Ok(());
    };
    let there = bound.iter().flat_map(|o| &objects[*o].materials);
    let there: Vec<&str> = there.map(String::as_str).collect();
    match materials.iter().find(|m| !there.contains(&m.as_str())) {
        None => Ok(()),
        Some(missing) => {
            let what = format!("no material \"{missing}\" in its objects");
            Err(refuse(
                scene,
                source,
                "materials",
                what,
                format!("there are: {}", there.join(", ")),
            ))
        }
    }
}

/// Refuses a cube on texture coordinates if the object has none.
fn check_uv_set(scene: &Scene, source: &Source, object: &PlannedObject) -> Result<()> {
    let SourceKind::Cube(cube) = &source.kind else {
        return Ok(());
    };
    match cube.mapping {
        Mapping::Uv { set, .. } if set >= object.uv_sets => {
            let what = format!(
                "object \"{}\" has no TEXCOORD_{set}: it has {}",
                object.name,
                match object.uv_sets {
                    0 => "no texture coordinates".to_string(),
                    1 => "TEXCOORD_0 alone".to_string(),
                    sets => format!("TEXCOORD_0 to TEXCOORD_{}", sets - 1),
                }
            );
            let help = "another `uv`, a mesh that is exported with texture coordinates, or a `capture` \
                        camera to project the cube from";
            Err(refuse(scene, source, "cube.uv", what, help))
        }
        _ => Ok(()),
    }
}

/// Sources of different quantities cannot light one surface: their sum would have no quantity.
fn check_quantities(scene: &Scene, sources: &[usize], object: &PlannedObject) -> Result<()> {
    let mut sources = sources.iter().map(|k| &scene.sources[*k]);
    let Some(first) = sources.next() else {
        return Ok(());
    };
    match sources.find(|s| s.quantity != first.quantity) {
        // Lights of the scene fall on the same surfaces as pulses, in the scene's own quantity.
        None if scene.is_lit() && is_pulse(first) && first.quantity != scene.quantity => {
            let what = format!(
                "lights object \"{}\" with a different quantity from the scene's lights",
                object.name
            );
            let help = "leave it out: all light on a surface must have the quantity of [radiance]";
            Err(refuse(scene, first, "radiance", what, help))
        }
        None => Ok(()),
        Some(other) => {
            let what = format!(
                "lights object \"{}\" with a different quantity from source \"{}\"",
                object.name, first.name
            );
            let help = "sources of one surface must declare the same quantity and wavelength";
            Err(refuse(scene, other, "radiance", what, help))
        }
    }
}

/// Captures of one surface are blended channel by channel, so they need the same channels.
fn check_companions(scene: &Scene, sources: &[usize], object: &PlannedObject) -> Result<()> {
    let companions = |source: usize| match &scene.sources[source].kind {
        SourceKind::Cube(cube) => scene.companions_of(cube),
        SourceKind::Pulse(_) => Vec::new(),
    };
    // Neighbours that are equal make all equal.
    let mut pairs = sources.windows(2);
    let Some(pair) = pairs.find(|pair| companions(pair[0]) != companions(pair[1])) else {
        return Ok(());
    };
    let [first, other] = [0, 1].map(|n| &scene.sources[pair[n]]);
    let what = format!(
        "it gives object \"{}\" different infrared and ultraviolet channels from source \"{}\"",
        object.name, first.name
    );
    let help =
        "give all captures of a surface the same channels, or set radiance.continuation = \"dark\"";
    Err(refuse(scene, other, "cube.channels", what, help))
}

fn is_pulse(source: &Source) -> bool {
    matches!(source.kind, SourceKind::Pulse(_))
}

fn refuse(
    scene: &Scene,
    source: &Source,
    key: &str,
    what: String,
    help: impl Into<String>,
) -> Error {
    let place = format!("source \"{}\", {key}", source.name);
    let problem = Problem::new(&scene.name, place, what, help);
    let label = (source.span.clone(), "this source".into());
    scene.text_and_file().show(problem, vec![label]).invalid()
}
