//! What `nullray bake` says of a bake: what it would take, what was written, and how a scene reads it.

use nullray::error::number;
use nullray::mesh::Factors;
use nullray::render::bake::{self, Baked, Bins, Captured, Coordinates, CubePrecision, Surface};
use nullray::render::metadata;
use nullray::render::plan::{self, Plan};
use nullray::render::prepare::Prepared;
use nullray::scene::model::{CubeBacks, Scene};
use nullray::spacetime::Quantity;
use nullray::spacetime::units::Angle;

use super::Job;
use crate::cli::console::faint;
use crate::cli::output::extension;

/// What a bake would cost.
pub fn planned(
    (scene, plan): (&Scene, &Plan),
    jobs: &[Job],
    bins: &Bins,
    precision: CubePrecision,
) -> String {
    // Surfaces have no camera and no film.
    let mut text = match jobs.iter().any(|job| job.surface.is_none()) {
        true => plan.to_string(),
        false => plan.of_surfaces().to_string(),
    };
    for job in jobs {
        let [w, h] = job.size(scene);
        let (rows, backs) = match job.has_backs {
            true => (h / 2, ", and as many rows of backs if light comes to any"),
            false => (h, ""),
        };
        let samples = u64::from(w) * u64::from(h) * bins.count as u64 * 3;
        let bytes = samples * precision.bytes();
        text += &format!(
            "{}: {rows} rows × {w} columns × {} bins{backs}, {} on disk, and as much again for its parts while it is being made\n",
            job.path.display(),
            bins.count,
            plan::bytes(bytes)
        );
        if let Some(gloss) = gloss((scene, plan), job) {
            text += &format!("  note      {gloss}\n");
        }
    }
    text
}

/// What was written and how a scene uses it, with warnings about what is missing from it.
pub fn report(
    (scene, plan): (&Scene, &Plan),
    job: &Job,
    (baked, bins, precision): (&Baked, &Bins, CubePrecision),
    samples: u32,
    table: &str,
    // Its bins hold what its film shows, and not all of a wide ground.
    is_of_flash: bool,
) -> (String, Vec<String>) {
    let [h, w, t, _] = baked.cube.shape;
    let energy = &baked.energy;
    let mut warnings: Vec<String> = gloss((scene, plan), job).into_iter().collect();
    let seen = |surface: Surface| plan.objects[surface.object].shows_backs(scene);
    let backs_are_seen = job.surface.is_some_and(seen);
    let sides = match baked.backs {
        CubeBacks::SecondHalf => {
            format!(
                ", {} of them of its front and then as many of its back",
                h / 2
            )
        }
        _ => String::new(),
    };
    let all = energy.held + energy.before + energy.after;
    let mut text = format!(
        "wrote {}: {h} rows × {w} columns × {t} bins{sides}\n",
        job.path.display()
    );
    let Some([from, to]) = energy.span else {
        let why = match (job.surface, backs_are_seen) {
            (None, _) => "no light arrives",
            // The warning about gloss gives the reason.
            (Some(_), _) if !warnings.is_empty() => "no diffuse light leaves it",
            (Some(_), true) => "no diffuse light leaves its fronts or its backs",
            (Some(_), false) => {
                "no diffuse light leaves its fronts, and its backs are not seen (display.back_faces = \"two_sided\")"
            }
        };
        let object = job
            .surface
            .and_then(|surface| plan.objects.get(surface.object));
        let whose = object.map_or_else(String::new, |object| {
            format!("object \"{}\": ", object.name)
        });
        warnings.push(format!("{whose}{why}: it is black"));
        return (text, warnings);
    };
    let part = |energy: f64| 100.0 * energy / all;
    text += &format!("light arrives between {from:.6} m and {to:.6} m");
    let (before, after) = (part(energy.before), part(energy.after));
    let missed = [before, after].map(|missed| missed > MISSED && !is_of_flash);
    let lacking = match (baked.is_dark(), missed) {
        (true, _) if energy.held > 0.0 => Some(
            "what falls into the bins is too little for the numbers of the file: they are dark"
                .into(),
        ),
        (true, _) => Some(format!(
            "none of its light falls into the bins, which are from {} m to {} m: they are dark",
            number(bins.start),
            number(bins.start + bins.width * bins.count as f64)
        )),
        (false, [true, true]) => Some(format!(
            "{before:.2} % of the light arrives before the first bin, and {after:.2} % after the last bin"
        )),
        (false, [true, false]) => Some(format!(
            "{before:.2} % of the light arrives before the first bin"
        )),
        (false, [false, true]) => Some(format!(
            "{after:.2} % of the light arrives after the last bin"
        )),
        (false, [false, false]) => None,
    };
    let help =
        "leave --half out, or make the lamps brighter and give the source the inverse `scale`";
    let faint = faint((baked.faint, &precision.dtype()), help);
    let of_file = |text: String| format!("{}: {text}", job.path.display());
    warnings.extend(lacking.into_iter().chain(faint).map(of_file));
    let error = 100.0 * baked.relative_error();
    if error.is_finite() {
        text += &format!("\nstandard error of a bin: {error:.2} % of the root mean square of all");
    } else if samples == 1 {
        text += "\nstandard error of a bin: not known, of one sample each";
    }
    (text + "\n\n" + table, warnings)
}

/// Light outside of the bins is mentioned from this many per cent on.
const MISSED: f64 = 0.01;

/// The advice for gloss.
pub const WAYS: &str =
    ": bake what the camera sees (--camera), or follow light with `render.bounces`";

/// The part of an object's light that a texture does not hold: whatever is not reflected diffusely; `None` if there is no such part.
fn gloss((scene, plan): (&Scene, &Plan), job: &Job) -> Option<String> {
    // Under pulses alone all surfaces are diffuse.
    if !scene.is_lit() {
        return None;
    }
    let object = &plan.objects[job.surface?.object];
    if !object.factors.iter().any(Factors::is_glossy) {
        return None;
    }
    // Metal and clear glass have no diffuse part.
    let is_bare = |f: &Factors| f.metallic >= 1.0 || f.transmission >= 1.0;
    let part = match object.factors.iter().all(is_bare) {
        true => "all its light is gloss (metal or glass), which is not baked",
        false => "its gloss is not baked, only what it reflects diffusely",
    };
    let by_texture = match object.textures {
        true => ", where its textures say so",
        false => "",
    };
    Some(format!(
        "object \"{}\": {part}{by_texture}{WAYS}",
        object.name.escape_debug()
    ))
}

/// The table with which a scene file reads the cube.
pub fn source(
    (scene, plan): (&Scene, &Plan),
    prepared: &Prepared,
    job: &Job,
    bins: &Bins,
    baked: &Baked,
) -> String {
    let file = job.path.file_name().unwrap_or_default().to_string_lossy();
    // An archive holds several arrays.
    let array = match extension(&job.path).as_str() {
        "npz" => "array = \"radiance\", ",
        _ => "",
    };
    let axis = |later: f64| {
        format!(
            "file = {file:?}, {array}start = \"{} m\", bin_width = \"{} m\"",
            number(bins.start + later),
            number(bins.width)
        )
    };
    // The quantity that a source has if nothing says another.
    let radiance = match scene.quantity {
        Quantity::Integrated => String::new(),
        other => format!("radiance = {}\n", metadata::radiance(other)),
    };
    match &job.surface {
        Some(surface) => {
            let object = &scene.objects[surface.object].name;
            let (clock, backs) = (baked.clock.name(), baked.backs.name());
            // The new file of coordinates replaces an existing one.
            let has_file = scene.objects[surface.object].texture_coordinates.is_some();
            let own_sets = plan.objects[surface.object].uv_sets - usize::from(has_file);
            let (before, set) = match surface.coordinates {
                Coordinates::Set(set) => (String::new(), set),
                // The set after its own.
                Coordinates::Atlas => (
                    format!(
                        "# Give object {object:?}\n# texture_coordinates = {{ file = {file:?} }}\n"
                    ),
                    own_sets,
                ),
            };
            format!(
                "{before}[[source]]\nname = {:?}\nobjects = [{object:?}]\ncube = {{ {}, clock = \"{clock}\", uv = {set}, backs = \"{backs}\" }}\n{radiance}",
                format!("light on {object}"),
                axis(0.0)
            )
        }
        None => {
            let [_, up, forward] = scene.camera.axes;
            let vector = |v: glam::DVec3| format!("[{}, {}, {}]", v.x, v.y, v.z);
            let captured = bake::captured(scene, prepared);
            let one = |of: &Captured| {
                let names = of.objects.iter().map(|k| &scene.objects[*k].name);
                let names: Vec<_> = names.collect();
                // Objects with clocks of their own need sources of their own.
                let (name, objects) = match captured.len() {
                    1 => ("light".into(), String::new()),
                    _ => (
                        format!("light on {}", names[0]),
                        format!("objects = {names:?}\n"),
                    ),
                };
                format!(
                    "[[source]]\nname = {name:?}\n{objects}cube = {{ {}, clock = \"{}\", capture = {{ eye = {}, look_at = {}, up = {}, \
                     hfov = \"{}\" }} }}\n{radiance}",
                    axis(of.later),
                    baked.clock.name(),
                    vector(of.eye),
                    vector(of.eye + forward),
                    vector(up),
                    Angle::of_radians(scene.camera.horizontal_fov)
                )
            };
            captured.iter().map(one).collect::<Vec<_>>().join("\n")
        }
    }
}
