//! A flash of light on a model.
//!
//! A lamp, or what materials emit, sends a Gaussian pulse at time 0 (σ = 1/16 of the radius), which reaches the model and a floor under it; light
//! from afar leaves so early that it arrives with the nearest.
//! The light is baked, and read by a camera that moves throughout the film, from the first light to some time after the last
//! ([`Show::span`]). At camera time 0, in the middle of the film, it looks at the model from the side from which the still picture does;
//! within three fifths of the film about that the whole model is in view, and W varies by less than a factor of 4. A camera at rest sees the direct light reach the centre of the model at time 0.

use std::fmt::Write;
use std::path::Path;

use glam::DVec3;
use toml_edit::Value;

use super::framing::framing;
use super::fronts::{Lit, Show, Source};
use super::motion::Motion;
use super::subject::{Ball, Subject};
use super::text::{
    DROPS, EMISSION, FlashLight, MADE_FOR_MODEL, ModelScene, backs_of, brightness, light_names,
    vector, write_light,
};
use super::view::{Flash, VIEWPOINT};
use crate::error::{Error, Result};
use crate::io::gltf::{self, GltfLight, GltfLightKind, GltfSummary};
use crate::mesh::Factors;
use crate::spacetime::Quantity;

/// Standard deviation of the pulse in radii of the model: the front is an eighth of the model deep, and in consecutive pictures, 48 over 5
/// radii, it advances by less than that.
const SIGMA: f64 = 1.0 / 16.0;
/// Bins per standard deviation: with two, 2·10⁻³ of a Gaussian's light lies above the frequencies that bins preserve.
const BINS_PER_SIGMA: f64 = 2.0;
/// Bins begin this many standard deviations before the peak: only a millionth of the light is earlier.
const BEGINS: f64 = 5.0;
/// The first picture shows light emitted this many standard deviations before the peak, at a thirtieth of its power.
const DAWN: f64 = 2.6;
/// The film and the bins follow reflected light for this many radii after the last direct light.
const FADES: f64 = 0.6;
const BINS_FADE: f64 = 2.0;
/// The flash of a model without lamps, from its centre, in radii: above the viewer's left shoulder.
const FLASH: DVec3 = DVec3::new(-1.0, 1.5, 1.2);
/// Half the side of the floor under a model, in radii, and its distance below it.
const FLOOR: f64 = 3.0;
const BELOW: f64 = 1e-3;
/// Points of the floor at which light arrives on either side of its middle.
const GRID: i32 = 3;
/// White over black for a flash: light reflected by two surfaces is a hundredth of direct light.
const FLASH_RANGE: f64 = 300.0;
/// The part of a model's surface, at least, that shines without a texture if that is to be a lamp: a panel at the ceiling of a box-shaped
/// room has a hundredth, glowing eyes and buttons have less.
const LAMP: f64 = 1.0 / 200.0;
/// Lamps farther from the middle of a model than this, in radii, flash earlier by the time that their light is on its way, like parallel light:
/// while that of others goes over the model, theirs would not have come yet.
const FAR: f64 = 10.0;
/// The most bins, for a model that is far from its lamps.
const MOST_BINS: u32 = 2048;

/// The file of a model.
pub(super) struct Model<'a> {
    pub(super) path: &'a Path,
    /// Its path as text.
    pub(super) name: &'a str,
    pub(super) held: &'a GltfSummary,
}

/// The scene of a model under a flash.
pub(super) fn flashing(
    model: &Model,
    subject: &Subject,
    motion: Option<Motion>,
    size: [u32; 2],
    flash: &Flash,
) -> Result<ModelScene> {
    let held = model.held;
    let is_bare = |f: &Factors| f.metallic >= 1.0 || f.transmission >= 1.0;
    if held.factors.iter().all(is_bare) && !held.has_gloss_textures {
        let what = match (&held.factors[..], held.default_material) {
            ([_], Some(_)) => {
                "it has no materials, and the default of glTF is metal, whose light depends on the direction: a flash is baked without it"
            }
            _ => {
                "all its surfaces are metal or glass, whose light depends on the direction: a flash is baked without it"
            }
        };
        let help = "materials with a metallicFactor below 1 (without one it is 1), or a scene with `render.bounces`";
        return Err(Error::unsupported(model.path, "materials", what, help));
    }
    let Ball { centre, radius } = subject.ball;
    let sigma = SIGMA * radius;
    // The model's own lamps, or one made for it.
    let mut lamps = String::new();
    let mut sources: Vec<Source> = Vec::new();
    // What materials emit is a lamp, too, or else it is left out: it lasts for ever, and would not fit into bins.
    let emits = held.factors.iter().any(|factors| factors.emits);
    let shining = &subject.shining;
    let shines = shining.part >= LAMP;
    let lights = gltf::lights(model.path)?;
    let is_far = |light: &GltfLight| match light.kind {
        GltfLightKind::Directional => true,
        _ => light.position.distance(centre) > FAR * radius,
    };
    // The light from afar reaches the middle together with that of the nearest lamp.
    let near = lights.iter().filter(|l| !is_far(l)).map(|l| l.position);
    let panels = shining.points.iter().copied().filter(|_| shines);
    let nearest = near
        .chain(panels)
        .map(|p| p.distance(centre))
        .reduce(f64::min);
    for (light, name) in lights.iter().zip(light_names(&lights)) {
        let front = Source::of(light, 0.0);
        let time = match is_far(light) {
            true => nearest.unwrap_or(0.0) - front.arrival(centre),
            false => 0.0,
        };
        // Writing to a string cannot fail.
        let _ = write_light(&mut lamps, light, &name);
        let _ = writeln!(
            lamps,
            "emission = {{ gaussian = {{ time = \"{time:?} m\", sigma = \"{sigma:?} m\" }} }}"
        );
        sources.push(Source::of(light, time));
    }
    if emits {
        let (said, radiance) = match shines {
            true => ("what its materials emit", ""),
            false => (
                "nothing, in place of what its materials emit for ever",
                "radiance = 0\n",
            ),
        };
        let _ = write!(
            lamps,
            "\n# Its surface shines with {said}.\n[[light]]\nname = \"{EMISSION}\"\ntype = \"area\"\nobject = \"model\"\n{radiance}emission = {{ gaussian = {{ sigma = \"{sigma:?} m\" }} }}\n"
        );
    }
    if shines {
        // Normal to the surface, ∫ L dA is its intensity.
        let each = shining.power / shining.points.len() as f64;
        sources.extend(shining.points.iter().map(|p| Source::point(*p, each)));
    }
    if sources.is_empty() {
        let from_middle = (subject.inside).map_or(FLASH, |inside| (inside - centre) / radius);
        let place = centre + from_middle * radius;
        // A white surface in the middle that faces the flash, or a wall, has a radiance of about 1 at the peak.
        let distance = from_middle.length_squared().max(1.0) * radius * radius;
        let intensity = 8.0 * sigma * distance;
        let _ = write!(
            lamps,
            "\n[[light]]\nname = \"flash\"\nposition = {}\nintensity = {intensity:?}\nemission = {{ gaussian = {{ sigma = \"{sigma:?} m\" }} }}\n",
            vector(place)
        );
        sources.push(Source::point(place, intensity));
    }
    let arrivals = |points: &[DVec3]| {
        let all = points
            .iter()
            .flat_map(|p| sources.iter().map(|s| s.arrival(*p)));
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], t| {
            [a.min(t), b.max(t)]
        })
    };
    let floor = subject.floor.map(|bottom| {
        let y = bottom - BELOW * radius;
        DVec3::new(centre.x, y, centre.z)
    });
    let reflected = match flash.bounces {
        0 => 0.0,
        _ => radius,
    };
    let lit = Lit::of(subject, &sources, FLASH_RANGE);
    let show = Show {
        lit: &lit,
        dawn: DAWN * sigma,
        fades: FADES * reflected + DAWN * sigma,
        middle: arrivals(&[centre])[0],
    };
    let camera = framing(subject, motion, size, Some(&show));
    // Bins for all direct light on the model and the floor, or as much of a wide ground, and for the light that follows.
    let grid = || (-GRID..=GRID).map(|k| f64::from(k) / f64::from(GRID) * FLOOR * radius);
    let around = |middle: DVec3| {
        grid().flat_map(move |x| grid().map(move |z| middle + DVec3::new(x, 0.0, z)))
    };
    let ground = subject.ground.map(|y| DVec3::new(centre.x, y, centre.z));
    let outline = subject.outline.iter().copied();
    let seen = subject.seen.iter().map(|piece| piece.point);
    let below = floor.or(ground).into_iter().flat_map(around);
    let places: Vec<DVec3> = outline.chain(seen).chain(below).collect();
    let [first, last] = arrivals(&places);
    let width = sigma / BINS_PER_SIGMA;
    let start = ((first - BEGINS * sigma) / width).floor() * width;
    let end = last + BEGINS * sigma + BINS_FADE * reflected;
    let bins = ((end - start) / width)
        .ceil()
        .clamp(1.0, f64::from(MOST_BINS)) as u32;

    let objects = |is_baked: bool| {
        let mut text = String::new();
        let texture = |text: &mut String, name: &str| {
            if is_baked {
                let file = Value::from(flash.of(name, floor.is_some()));
                let _ = writeln!(
                    text,
                    "texture_coordinates = {{ file = {} }}",
                    file.to_string().trim()
                );
            }
        };
        let _ = write!(
            text,
            "\n[[object]]\nname = \"model\"\ngltf = {}\n{DROPS}",
            Value::from(model.name).to_string().trim()
        );
        texture(&mut text, "model");
        if let Some(middle) = floor {
            let side = 2.0 * FLOOR * radius;
            let _ = write!(
                text,
                "\n[[object]]\nname = \"floor\"\nshape = {{ plane = {{ size = [{side:?}, {side:?}] }} }}\ntransform = {{ translate = {} }}\ncolour = [0.6, 0.6, 0.6]\n",
                vector(middle)
            );
            texture(&mut text, "floor");
        }
        text
    };
    let quantity = camera.quantity();
    let said = match quantity {
        Quantity::Rgb => "quantity = \"rgb\"".to_owned(),
        _ => format!(
            "# Hues stay, as W up to {:.3} would shift all light out of sight.\nquantity = \"luminance\"",
            camera.ratios[1]
        ),
    };
    let mut seen = String::new();
    let _ = camera.write(&mut seen, size);
    let mut text = format!(
        "{MADE_FOR_MODEL}\n\n{seen}{}\n[radiance]\n{said}\n",
        objects(true)
    );
    for (name, set) in [("model", held.uv_sets), ("floor", 1)] {
        if name == "model" || floor.is_some() {
            let file = Value::from(flash.of(name, floor.is_some()));
            let _ = write!(
                text,
                "\n[[source]]\nname = \"light on {name}\"\nobjects = [\"{name}\"]\ncube = {{ file = {}, array = \"radiance\", axes = \"H W T C\", start = \"{start:?} m\", bin_width = \"{width:?} m\", clock = \"world\", uv = {set}, backs = \"as_baked\" }}\n",
                file.to_string().trim()
            );
        }
    }
    let plain = objects(false);
    let light = FlashLight {
        scene: format!(
            "{MADE_FOR_MODEL}\n\n[camera]\neye = {}\nlook_at = {}\n{plain}\n[radiance]\nquantity = \"rgb\"\n\n[render]\nbounces = {}\n{lamps}",
            vector(centre + 3.0 * radius * VIEWPOINT),
            vector(centre),
            flash.bounces
        ),
        start,
        width,
        bins,
        leaves_out_emission: emits && !shines,
        direct: format!("{MADE_FOR_MODEL}\n{seen}{plain}\n[radiance]\n{said}\n{lamps}"),
    };
    let [white, _] = camera.ratios.map(|w| brightness(quantity, w));
    Ok(ModelScene {
        text,
        range: Some(FLASH_RANGE),
        white,
        least_white: 0.0,
        display: backs_of(subject.inside.is_some()).into(),
        flash: Some(light),
    })
}
