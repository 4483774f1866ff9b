//! Remarks on a finished picture.

use nullray::Result;
use nullray::colour::{Continuation, Spectrum};
use nullray::light::time_texture::Coverage;
use nullray::render::film::Film;
use nullray::render::plan;
use nullray::render::prepare::Prepared;
use nullray::render::trace::Background;
use nullray::render::{enclosed, survey};
use nullray::scene::model::{
    BackFaces, Brightness, EmissionProfile, Geometry, Light, LightKind, Motion, Object, Scene, Sky,
    SkyRadiance, Source, SourceKind, Spectra,
};
use nullray::spacetime::{Quantity, Velocity};

use super::console::escaped;
use super::flags::with_flags;

/// The line about rays and times.
pub fn cost(rays: u64, prepared_in: f64, rendered_in: f64) -> String {
    let rate = rays as f64 / rendered_in.max(1e-9) / 1e6;
    format!(
        "{} rays, {prepared_in:.2} s to prepare, {rendered_in:.2} s to render ({rate:.1} Mrays/s)\n",
        plan::count(rays)
    )
}

/// Whether the picture is black.
pub fn is_black(film: &Film) -> bool {
    !film.radiance().iter().flatten().any(|value| *value > 0.0)
}

/// Why a picture is black, if it is; empty otherwise. `is_shifted`: [`shift`] gives the reason.
pub fn blackness(
    scene: &Scene,
    film: &Film,
    is_shifted: bool,
    prepared: Option<&Prepared>,
) -> String {
    let why = why_black(scene, film, is_shifted, prepared);
    why.map_or(String::new(), |why| {
        format!("the picture is black: {why}\n")
    })
}

/// The same without what it explains; `None` for a picture that is not black.
fn why_black(
    scene: &Scene,
    film: &Film,
    is_shifted: bool,
    prepared: Option<&Prepared>,
) -> Option<String> {
    if !is_black(film) {
        return None;
    }
    let is_sky_black = prepared.is_some_and(|p| match &p.background {
        Background::Sky { sky, .. } => sky.has_black_picture(),
        Background::Observed(_) => false,
    });
    Some(if film.met() == 0.0 && is_sky_black {
        "only the sky is in view, and its image is black: all its numbers are 0, or its `scale` is"
            .into()
    } else if film.met() == 0.0 && scene.sky.is_some() {
        "only the sky is in view, and none of it is visible: it is dark there, or its light is shifted out of sight \
         (see display.false_colour, too)"
            .into()
    } else if film.met() == 0.0 {
        nothing_met(scene, prepared)
    } else if film.met() > 0.0 && reflects_rgb(scene) {
        "surfaces reflect red, green and blue, of which nothing is visible in these false colours (remedy: spectra = \"sampled\" \
         in [render], and lights with a spectrum)"
            .into()
    } else if is_shifted {
        "what is in view shines, but none of its light is visible".into()
    } else if prepared.is_some_and(|p| is_shut_in(scene, p)) {
        "all light is inside objects, whose outside it does not light".into()
    } else if is_from_data(scene) && prepared.is_some_and(|p| p.has_dark_data()) {
        "the data of what is in view are dark: all their numbers are 0".into()
    } else {
        let missing = film.mean_coverage().and_then(missing);
        missing.unwrap_or_else(|| unlit(scene, is_sky_black)).into()
    })
}

/// The remarks before rendering, one a line, from `film`: a small picture of `scene`, with one ray in each pixel. `is_shifted`: it is
/// known already that all light is shifted out of sight.
pub fn foreseen(
    scene: &Scene,
    film: &Film,
    is_shifted: bool,
    prepared: &mut Prepared,
) -> Vec<String> {
    let rays = plan::count(film.size().map(u64::from).iter().product());
    let shift = match (is_shifted, is_black(film)) {
        (true, _) => String::new(),
        (false, true) => shift(scene, prepared),
        (false, false) => shifted(scene, prepared),
    };
    let is_shifted = is_shifted || !shift.is_empty();
    let mut text = String::new();
    if let Some(why) = why_black(scene, film, is_shifted, Some(prepared)) {
        text = format!("of {rays} rays, none sees any light: {why}\n");
    } else if sees_only_sky(scene, film) {
        text = format!(
            "of {rays} rays, all see only the sky: {}\n",
            nothing_met(scene, Some(prepared))
        );
    }
    text += &other_times(scene, film, prepared);
    text += &enclosed(scene, prepared);
    text += &shift;
    text.lines().map(str::to_owned).collect()
}

/// Whether all light of surfaces is of cubes.
fn is_from_data(scene: &Scene) -> bool {
    let is_cube = |source: &Source| matches!(source.kind, SourceKind::Cube(_));
    !scene.is_lit() && scene.sources.iter().all(is_cube)
}

/// Whether false colours show surfaces that reflect the light on them without its spectrum.
fn reflects_rgb(scene: &Scene) -> bool {
    let is_rgb = scene.quantity == Quantity::Rgb && scene.spectra == Spectra::Rgb;
    is_rgb && scene.is_lit() && scene.effects.doppler && scene.false_colour.is_some()
}

/// A remark if only the sky is in view of a scene that has objects; empty otherwise, and if the picture is black.
pub fn only_sky(scene: &Scene, film: &Film, prepared: &Prepared) -> String {
    match sees_only_sky(scene, film) && !is_black(film) {
        true => format!(
            "only the sky is in view: {}\n",
            nothing_met(scene, Some(prepared))
        ),
        false => String::new(),
    }
}

/// Whether the sky is all that is in view of a scene that has objects.
fn sees_only_sky(scene: &Scene, film: &Film) -> bool {
    film.met() == 0.0 && scene.sky.is_some() && !scene.objects.is_empty()
}

/// The remark that no object is visible, with advice.
fn nothing_met(scene: &Scene, prepared: Option<&Prepared>) -> String {
    if !scene.objects.is_empty() && prepared.is_some_and(|prepared| !prepared.has_triangles()) {
        return "no triangle can be seen: all have no area, or a vertex that is not finite, for which they were dropped".into();
    }
    let (what, behind) = match scene.back_faces {
        BackFaces::TwoSided => ("object", ""),
        BackFaces::AsFile | BackFaces::Black | BackFaces::Culled => (
            "object's front",
            ", or, from inside or behind, set display.back_faces = \"two_sided\"",
        ),
    };
    format!("no {what} is in view: aim the camera elsewhere, change camera.hfov{behind}")
}

/// The camera times that show objects, if this picture shows none; empty otherwise, and if nothing moves.
pub fn other_times(scene: &Scene, film: &Film, prepared: &mut Prepared) -> String {
    if film.met() > 0.0 || scene.objects.is_empty() {
        return String::new();
    }
    let text = survey::other_times(scene, prepared);
    text.map_or(String::new(), |text| with_flags(&text) + "\n")
}

/// For each lamp and pulse whose light is not in view at its time: when the light in view left, when there are data, and the camera times
/// that would show some of them.
pub fn times(scene: &Scene, prepared: &mut Prepared) -> String {
    // Cubes that do not fit are reported before rendering.
    let moments = survey::moments(scene, prepared, true).into_iter();
    moments.map(|text| with_flags(&text) + "\n").collect()
}

/// The range of W = λ′/λ at which some part of the spectra of colours, from 360 to 830 nm, is visible.
fn seen_ratios(scene: &Scene) -> [f64; 2] {
    let seen = seen_as_emitted(scene);
    let [first, last] = nullray::colour::OBSERVED_NM;
    let across = last / first;
    [seen / across, seen * across]
}

/// W of light that is shown with the wavelength with which it was emitted.
fn seen_as_emitted(scene: &Scene) -> f64 {
    scene.false_colour.map_or(1.0, |shown| shown / GREEN)
}

/// The wavelength as which the false-colour wavelength is shown, metres.
const GREEN: f64 = 555e-9;

/// Whether colours stand for spectra that a Doppler shift can take out of sight.
fn has_colours(scene: &Scene) -> bool {
    let of_sky = |sky: &Sky| match sky.background {
        SkyRadiance::Uniform(radiance) => radiance != [0.0; 3] || sky.sun.is_some(),
        SkyRadiance::Spectrum(_) => sky.sun.is_some(),
        SkyRadiance::Gradient { .. } | SkyRadiance::Image { .. } => true,
    };
    scene.quantity == Quantity::Rgb
        && scene.effects.doppler
        && (scene.objects.iter().any(|object| object.spectrum.is_none())
            || scene.sky.as_ref().is_some_and(of_sky))
}

/// The remark that all light in view was emitted outside the visible range although a picture shows some of it, and that of lamps; empty
/// otherwise.
pub fn shifted(scene: &Scene, prepared: &Prepared) -> String {
    if !has_colours(scene) {
        return String::new();
    }
    let range = survey::wavelength_ratios_outside(prepared, seen_ratios(scene));
    match range {
        Some(range) if is_declared(scene, range) => String::new(),
        Some(range) => out_of_sight(scene, range, false) + "\n",
        None => unseen_lamps(scene, prepared),
    }
}

/// The remarks on lamps whose light is invisible on the surfaces in view, as it is in their rest frames.
fn unseen_lamps(scene: &Scene, prepared: &Prepared) -> String {
    let unseen = survey::unseen_lamps(scene, prepared, seen_as_emitted(scene));
    let line = |(light, [low, high]): (usize, [f64; 2])| {
        let [low, high] = [low, high].map(short);
        let times = match low == high {
            true => low,
            false => format!("{low} to {high}"),
        };
        format!(
            "the light of \"{}\" reaches what is in view with {times} times its emitted wavelength: none of its spectrum is visible \
             there, and what is shown of it, if anything, is too dim for any eye, or extrapolated (see radiance.continuation and \
             display.false_colour)\n",
            escaped(&scene.lights[light].name),
        )
    };
    unseen.into_iter().map(line).collect()
}

/// The same before rendering, if it is known that all light will be emitted outside the visible range, whatever is in view.
pub fn will_be_shifted(scene: &Scene) -> Result<Option<String>> {
    if !has_colours(scene) {
        return Ok(None);
    }
    let range = survey::camera_ratios_outside(scene, seen_ratios(scene))?;
    let range = range.filter(|range| !is_declared(scene, *range));
    Ok(range.map(|range| out_of_sight(scene, range, false)))
}

/// The part of a spectrum's brightness without which nothing is seen of it.
const FAINTEST: f64 = 1e-6;

/// Whether light in view with W from `low` to `high` has a spectrum of its own that reaches the wavelengths shown: false colours that show
/// visible light as it was emitted would then see no more; much less, where surfaces reflect red, green and blue.
fn is_declared(scene: &Scene, [low, high]: [f64; 2]) -> bool {
    let (seen, middle) = (seen_as_emitted(scene), (low * high).sqrt());
    let of_lights = scene.lights.iter().filter_map(|light| match &light.kind {
        LightKind::Lamp(lamp) => lamp.spectrum.as_ref(),
        LightKind::Area { .. } => None,
    });
    let of_objects = scene.objects.iter().filter_map(|o| o.spectrum.as_ref());
    let of_sky = scene.sky.iter().filter_map(|sky| match &sky.background {
        SkyRadiance::Spectrum(spectrum) => Some(spectrum),
        SkyRadiance::Uniform(_) | SkyRadiance::Gradient { .. } | SkyRadiance::Image { .. } => None,
    });
    let reaches = |spectrum: &Spectrum| {
        let at = |shown: f64| brightest(spectrum, [low / shown, high / shown]);
        let (shown, proposed) = (at(seen), at(middle));
        shown > 0.0
            && match scene.spectra {
                Spectra::Sampled => shown >= FAINTEST * proposed,
                Spectra::Rgb => FAINTEST * shown > proposed,
            }
    };
    of_lights.chain(of_objects).chain(of_sky).any(reaches)
}

/// The largest XYZ of a spectrum seen at these W, without the factor W⁻⁴ of its energy.
fn brightest(spectrum: &Spectrum, range: [f64; 2]) -> f64 {
    let values = ratios_within(range).map(|w| {
        let xyz = spectrum.xyz_at(w);
        w.powi(4) * xyz.into_iter().fold(0.0, f64::max)
    });
    values.fold(0.0, f64::max)
}

/// W across a range: as fine as the changes of the eye's response, where that is no wider than the visible one.
fn ratios_within([low, high]: [f64; 2]) -> impl Iterator<Item = f64> {
    const PLACES: i32 = 32;
    let places = (0..=PLACES).map(|k| f64::from(k) / f64::from(PLACES));
    places.map(move |part| low + (high - low) * part)
}

/// Where light in view with these W is shifted to and from; all of them take visible light out of the visible range.
fn out_of_sight(scene: &Scene, [low, high]: [f64; 2], is_black: bool) -> String {
    // The visible range, metres.
    let (violet, red) = (380e-9, 780e-9);
    let seen = seen_as_emitted(scene);
    let middle = (low * high).sqrt();
    let continued = match scene.continuation {
        Continuation::Dark => "dark",
        Continuation::Edge => "extrapolated as constant",
        Continuation::Blackbody => "extrapolated by Planck's law at 6504 K",
        Continuation::Companions => "dark but for infrared and ultraviolet channels",
    };
    let shown = match is_black {
        true => "what would be seen",
        false => "what is seen, however bright it appears,",
    };
    let ratios = match [short(low), short(high)] {
        [low, high] if low == high => low,
        [low, high] => format!("{low} to {high}"),
    };
    let shown_as = middle * GREEN;
    let (unit, name) = unit_of(shown_as);
    format!(
        "W = {ratios} shifts visible light to {}, out of sight; {shown} was emitted at {}, where colours are {continued} \
         (radiance.continuation): try display.false_colour = \"{} {name}\", or radiance.quantity = \"luminance\", which keeps hues",
        span([low * violet, high * red]),
        span([violet * seen / high, red * seen / low]),
        short(shown_as / unit),
    )
}

/// A unit, metres, in which a wavelength of this many metres has few digits, and its name.
fn unit_of(wavelength: f64) -> (f64, &'static str) {
    match wavelength {
        wavelength if wavelength < 10e-6 => (1e-9, "nm"),
        wavelength if wavelength < 10e-3 => (1e-6, "µm"),
        _ => (1.0, "m"),
    }
}

/// The largest quotient of two wavelengths that are written in the same unit.
const SAME_UNIT: f64 = 1e3;

/// Two wavelengths, metres, in a readable unit; in one of its own each, if they are far apart.
fn span([from, to]: [f64; 2]) -> String {
    let (unit, name) = unit_of(to);
    let (own, own_name) = unit_of(from);
    match to / from < SAME_UNIT || name == own_name {
        true => format!("{} to {} {name}", short(from / unit), short(to / unit)),
        false => format!(
            "{} {own_name} to {} {name}",
            short(from / own),
            short(to / unit)
        ),
    }
}

/// The remark that all light in view is shifted out of the visible range; empty otherwise.
pub fn shift(scene: &Scene, prepared: &Prepared) -> String {
    if scene.quantity != Quantity::Rgb || !scene.effects.doppler {
        return String::new();
    }
    let [least, most] = seen_ratios(scene);
    let mut text = match survey::wavelength_ratios(prepared) {
        Some(range @ [low, high]) if low > most || high < least => {
            match is_declared(scene, range) {
                true => String::new(),
                false => out_of_sight(scene, range, true) + "\n",
            }
        }
        Some(range) => unseen_spectra(scene, range),
        None => String::new(),
    };
    text += &unseen_lamps(scene, prepared);
    text
}

/// The objects whose spectra are invisible at all of these W.
fn unseen_spectra(scene: &Scene, [low, high]: [f64; 2]) -> String {
    let is_seen = |spectrum: &Spectrum| {
        let mut ratios = ratios_within([low, high]);
        ratios.any(|w| spectrum.xyz_at(w).iter().any(|value| *value > 0.0))
    };
    let unseen = scene.objects.iter().filter(|object| {
        let spectrum = object.spectrum.as_ref();
        spectrum.is_some_and(|spectrum| !is_seen(spectrum))
    });
    let range = match (short(low), short(high)) {
        (from, to) if from == to => from,
        (from, to) => format!("{from} to {to}"),
    };
    let where_seen = match range.as_str() {
        "1" => "is outside the visible range".to_owned(),
        range => {
            format!("is seen at {range} times its wavelengths: none of it is visible there")
        }
    };
    let line = |object: &Object| {
        format!(
            "the spectrum of \"{}\" {where_seen} (see display.false_colour)\n",
            escaped(&object.name)
        )
    };
    unseen.map(line).collect()
}

/// Whether all light is of lamps inside objects with which they move.
fn is_shut_in(scene: &Scene, prepared: &Prepared) -> bool {
    let sky = scene.sky.as_ref();
    let is_lit_by_lamps = scene.sources.is_empty() && sky.is_none_or(is_dark);
    let inside = enclosed::enclosed_lamps(scene, prepared);
    let stays = |light: &Light| {
        let LightKind::Lamp(lamp) = &light.kind else {
            return false;
        };
        let mut inside = inside.iter().filter(|inside| inside.lamp == light.name);
        inside.any(|inside| {
            let object = scene.objects.get(inside.object);
            lamp.motion == Motion::Inertial && object.is_some_and(|o| o.velocity == lamp.velocity)
        })
    };
    is_lit_by_lamps && !scene.lights.is_empty() && scene.lights.iter().all(stays)
}

/// Remarks on lamps inside objects.
pub fn enclosed(scene: &Scene, prepared: &Prepared) -> String {
    let lamps = enclosed::enclosed_lamps(scene, prepared).into_iter();
    let line = |lamp: enclosed::EnclosedLamp| {
        let object = scene
            .objects
            .get(lamp.object)
            .map_or("", |object| &object.name);
        format!(
            "lamp \"{}\" is inside \"{}\": it lights the outside only through openings\n",
            escaped(&lamp.lamp),
            escaped(object)
        )
    };
    lamps.map(line).collect()
}

/// A remark on a camera inside glass.
pub fn in_glass(scene: &Scene, prepared: &Prepared) -> String {
    let object = enclosed::glass_around_camera(prepared).and_then(|k| scene.objects.get(k));
    object.map_or(String::new(), |object| {
        format!(
            "the camera is inside the glass of \"{}\": from its surface to the camera light takes as long as outside, not longer by the \
             glass's index; place the camera outside for right times\n",
            escaped(&object.name)
        )
    })
}

/// A number to four significant digits, with a power of ten if it would have many zeros.
pub fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    match rounded.abs() {
        size if size > 0.0 && !(1e-4..1e7).contains(&size) => format!("{rounded:e}"),
        // Adding 0 turns −0 into 0.
        _ => (rounded + 0.0).to_string(),
    }
}

/// Why surfaces in view are dark although no data are missing, with advice.
fn unlit(scene: &Scene, is_sky_black: bool) -> &'static str {
    let lights_send_nothing = scene.lights.iter().all(sends_nothing);
    let of_image = |sky: &Sky| sky.lights && sky.sun.is_none() && sky.stars.is_none();
    let is_alone = scene.sources.is_empty() && lights_send_nothing;
    if is_sky_black && is_alone && scene.sky.as_ref().is_some_and(of_image) {
        "nothing in view is lit: the image of the sky is black (all its numbers are 0, or its `scale` is)"
    } else if varies(scene) {
        "nothing in view is lit at the moment at which its light left: try another --time (see display.back_faces, \
         too, and whether lamps are inside objects, whose outside they do not light)"
    } else if !scene.is_lit() {
        "what is in view is black: its base colours, which are shown in a scene without light, are 0"
    } else if scene.lights.is_empty() && scene.sky.as_ref().is_some_and(is_unseen) {
        "the light of the sky is invisible on what is in view (see display.false_colour and render.spectra)"
    } else if lights_send_nothing && scene.sky.as_ref().is_none_or(is_dark) {
        "nothing in view is lit: the intensity, radiance or power of all lights is 0"
    } else if scene.objects.iter().all(reflects_nothing) {
        "nothing in view reflects any light: its colour is 0"
    } else {
        "no light reaches what is in view, at any time: it comes from behind the surfaces, is shadowed, misses them (the cone of a \
         spot), or is inside objects, whose outside it does not light (see display.back_faces, too)"
    }
}

/// Whether the light on surfaces depends on time; it does not if lights are steady and rest in the world together with all objects.
fn varies(scene: &Scene) -> bool {
    let moves = |velocity: Velocity, motion: &Motion| {
        !velocity.is_rest() || !matches!(motion, Motion::Inertial)
    };
    let varies = |light: &Light| match &light.kind {
        LightKind::Lamp(lamp) => {
            lamp.emission != EmissionProfile::Steady || moves(lamp.velocity, &lamp.motion)
        }
        LightKind::Area { emission, .. } => *emission != EmissionProfile::Steady,
    };
    !scene.sources.is_empty()
        || scene.lights.iter().any(varies)
        || scene
            .objects
            .iter()
            .any(|object| !object.velocity.is_rest())
}

/// Whether a sky lights no surface.
fn is_dark(sky: &Sky) -> bool {
    let is_black = sky.background == SkyRadiance::Uniform([0.0; 3]);
    !sky.lights || (is_black && sky.sun.is_none() && sky.stars.is_none())
}

/// Whether a sky lights surfaces only with a spectrum of which nothing is visible at rest.
fn is_unseen(sky: &Sky) -> bool {
    let SkyRadiance::Spectrum(spectrum) = &sky.background else {
        return false;
    };
    let is_alone = sky.lights && sky.sun.is_none() && sky.stars.is_none();
    is_alone && spectrum.xyz_at(1.0).iter().all(|value| *value <= 0.0)
}

fn sends_nothing(light: &Light) -> bool {
    let light = match &light.kind {
        LightKind::Lamp(lamp) => lamp.intensity,
        LightKind::Area { brightness, .. } => match brightness {
            Brightness::Radiance(light) | Brightness::Power(light) => *light,
            Brightness::Materials => return false,
        },
    };
    light == [0.0; 3]
}

/// Whether a shape is black and has no mirror reflection.
fn reflects_nothing(object: &Object) -> bool {
    match &object.geometry {
        Geometry::Shape {
            colour,
            metallic,
            roughness,
            ..
        } => *colour == [0.0; 3] && *metallic == 0.0 && *roughness == 1.0,
        Geometry::Gltf { .. } | Geometry::Mesh(_) => false,
    }
}

/// The main reason for missing data, if most are missing.
fn missing(c: Coverage) -> Option<&'static str> {
    let reasons = [
        (
            c.before,
            "most of it was seen before the first bin of its data: try a later --time",
        ),
        (
            c.after,
            "most of it was seen after the last bin of its data: try an earlier --time",
        ),
        (
            c.off_texture,
            "most of it is off the texture: check `uv`, or the capture camera's pose and hfov",
        ),
        (
            c.occluded,
            "most of it is hidden from the capture camera: check its pose",
        ),
    ];
    let largest = reasons.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let largest = largest.filter(|(part, _)| *part > c.held);
    largest.map(|(_, why)| why)
}

/// The part of the surfaces with data in view that the data cover, and what the sensor hides, in words; empty if nothing is missing.
pub fn coverage(film: &Film) -> String {
    let hidden = match film.hidden() {
        part if part > 0.0 => format!(
            "{} of the film is hidden by the sensor itself\n",
            percent(part)
        ),
        _ => String::new(),
    };
    let Some(c) = film.mean_coverage() else {
        return hidden;
    };
    let parts = [
        (c.before, "before the first bin"),
        (c.after, "after the last bin"),
        (c.off_texture, "off the texture"),
        (c.occluded, "hidden from the capture camera"),
    ];
    let missing: Vec<_> = parts
        .iter()
        .filter(|(part, _)| *part > 0.0)
        .map(|(part, why)| format!("{} {why}", percent(*part)))
        .collect();
    if missing.is_empty() {
        return hidden;
    }
    let held = percent(c.held);
    format!(
        "coverage {held} of the surfaces with data in view; no data for {}\n{hidden}",
        missing.join(", ")
    )
}

/// A part in per cent; the text shows if a value that rounds to 0 or 100 is not exactly that.
fn percent(part: f64) -> String {
    match part {
        p if p > 0.0 && p < 0.0005 => "< 0.1 %".into(),
        p if (0.9995..1.0).contains(&p) => "> 99.9 %".into(),
        p => format!("{:.1} %", 100.0 * p),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wavelengths_and_ratios_of_any_size_are_written_with_few_digits() {
        assert_eq!(span([5.36e-6, 11e-6]), "5.36 to 11 µm");
        assert_eq!(span([380e-9, 780e-9]), "380 to 780 nm");
        assert_eq!(span([2.261e-6, 0.01314]), "2261 nm to 0.01314 m");
        assert_eq!(span([4.182e-15, 7.254e-14]), "4.182e-6 to 7.254e-5 nm");
        let written = [14.107, 1.078e-8, 2e-4, 2e16, 0.0, -0.0].map(short);
        assert_eq!(written, ["14.11", "1.078e-8", "0.0002", "2e16", "0", "0"]);
    }
}
