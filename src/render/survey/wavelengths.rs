//! Wavelength ratios W = λ′/λ of the light in view: of lamps whose light is invisible where it arrives, and of all that the camera sees.

use rayon::prelude::*;

use super::{PixelSamples, each_point, one_in};
use crate::camera::Camera;
use crate::colour::{OBSERVED_NM, SpectrumShape};
use crate::error::Result;
use crate::render::film::Tile;
use crate::render::prepare::Prepared;
use crate::render::trace::{Background, CameraRays, generator};
use crate::scene::model::{self, LightKind, Motion, Scene};
use crate::spacetime::Quantity;

/// The eye, which needs some 1e-6 cd/m², sees nothing colder glow, kelvin.
const COLDEST_GLOW: f64 = 600.0;

/// The smallest and the largest W = λ′/λ with which the light of each lamp reaches surfaces in view, if it is invisible there: by the index
/// of the light. `seen` is W of light that is shown as it was emitted: 1 without false colours.
pub fn unseen_lamps(scene: &Scene, prepared: &Prepared, seen: f64) -> Vec<(usize, [f64; 2])> {
    let Some(light) = prepared.light.time_resolved() else {
        return Vec::new();
    };
    let surfaces = prepared.surfaces();
    let rapidities = scene.objects.iter().map(|o| o.velocity.rapidity().length());
    let fastest = rapidities.fold(0.0, f64::max);
    // Colours stand for spectra over the observer's range.
    let [first, last] = OBSERVED_NM;
    let is_colour_visible = |w: f64| first * w < last * seen && last * w > first * seen;
    let is_visible = |lamp: &model::Lamp, incident: f64, w: f64| match lamp.spectrum.as_ref() {
        None => is_colour_visible(w),
        Some(spectrum) => match spectrum.shape().unfiltered() {
            SpectrumShape::Rgb(..) => is_colour_visible(w),
            SpectrumShape::Blackbody(t) => t / w * seen > COLDEST_GLOW,
            _ => incident > 0.0,
        },
    };
    // Light of quantities without a spectrum is visible at any W, and other light at any that a lamp and an object this slow can have.
    let may_be_unseen = |k: &usize| match &scene.lights[*k].kind {
        LightKind::Lamp(lamp) => {
            let has_spectrum = lamp.spectrum.is_some() || scene.quantity == Quantity::Rgb;
            let apart = fastest + lamp.velocity.rapidity().length();
            let is_slow = lamp.motion == Motion::Inertial
                && [-apart, apart]
                    .iter()
                    .all(|apart| is_visible(lamp, 0.0, libm::exp(*apart)));
            has_spectrum && !is_slow
        }
        LightKind::Area { .. } => false,
    };
    // Lamps are numbered after the sources.
    let ratios = |k: usize, pixel_samples: PixelSamples, every: u64| {
        let index = scene.sources.len() + k;
        let lamp = light.lamps.get(index)?.as_ref()?;
        let LightKind::Lamp(of_scene) = &scene.lights[k].kind else {
            return None;
        };
        let tiles = (0..Tile::count(prepared.layout.size)).into_par_iter();
        let tiles = tiles.filter(|tile| tile % every == 0);
        let ratios = tiles.map(|tile| {
            let (mut range, mut is_seen) = ([f64::INFINITY, 0.0f64], false);
            each_point(
                prepared,
                &surfaces,
                (Tile::of_image(prepared.layout.size, tile), pixel_samples),
                |observed| {
                    let point = &observed.point;
                    let arrival = lamp.arrival_at_peak(&point.ray, point.hit.s, light.index);
                    let Some((arrival, _)) = arrival else {
                        return;
                    };
                    // W of light that arrives, from the lamp's frame to the surface's.
                    let rho = surfaces.direction(point.frame, arrival.d).1;
                    let w = arrival.wavelength_ratio(rho);
                    range = [range[0].min(w), range[1].max(w)];
                    let incident = lamp.incident_at(w, 1.0).irradiance;
                    is_seen |= is_visible(of_scene, incident.into_iter().fold(0.0, f64::max), w);
                },
                |_| {},
            );
            (range, is_seen)
        });
        Some(tiles_reduced(ratios))
    };
    let of_lamp = |k: usize| {
        let is_lit = |([least, greatest], _): &([f64; 2], bool)| least <= greatest;
        // A few tiles show of most lamps that their light is visible.
        let few = ratios(
            k,
            PixelSamples::centred(&prepared.camera),
            one_in(scene.camera.size),
        )?;
        if few.1 {
            return None;
        }
        let found = ratios(k, PixelSamples::centred(&prepared.camera), 1)?;
        let (range, is_seen) = match is_lit(&found) {
            true => found,
            false => ratios(k, PixelSamples::of_picture(prepared), 1).filter(is_lit)?,
        };
        (!is_seen).then_some((k, range))
    };
    (0..scene.lights.len())
        .filter(may_be_unseen)
        .filter_map(of_lamp)
        .collect()
}

fn tiles_reduced(ratios: impl ParallelIterator<Item = ([f64; 2], bool)>) -> ([f64; 2], bool) {
    ratios.reduce(
        || ([f64::INFINITY, 0.0], false),
        |(a, seen), (b, also)| ([a[0].min(b[0]), a[1].max(b[1])], seen || also),
    )
}

/// The smallest and the largest W = λ′/λ along rays through pixel centres, including the sky, or along all samples if the former hit no
/// surface; `None` if they hit nothing.
pub fn wavelength_ratios(scene: &Prepared) -> Option<[f64; 2]> {
    let (range, has_met) = ratios_by(scene, 1, PixelSamples::centred(&scene.camera));
    match has_met {
        true => range,
        false => ratios_by(scene, 1, PixelSamples::of_picture(scene)).0,
    }
}

/// [`wavelength_ratios`] if all of them are below or all above the range `within`: for most pictures a few rays show that they are not.
pub fn wavelength_ratios_outside(scene: &Prepared, within: [f64; 2]) -> Option<[f64; 2]> {
    let (few, _) = ratios_by(
        scene,
        one_in(scene.layout.size),
        PixelSamples::centred(&scene.camera),
    );
    match few {
        Some(range) if !is_outside(range, within) => None,
        _ => wavelength_ratios(scene).filter(|range| is_outside(*range, within)),
    }
}

/// The range of W over all directions in the camera's view if everything rests in the world, whatever is seen there; `None` if something
/// moves.
///
/// # Errors
/// A camera that sees nothing at its time.
pub fn camera_ratios_outside(scene: &Scene, within: [f64; 2]) -> Result<Option<[f64; 2]>> {
    if scene.objects.iter().any(|o| !o.velocity.is_rest()) {
        return Ok(None);
    }
    let camera = Camera::new(scene)?;
    let (generator, centred) = (generator(&camera.view), PixelSamples::centred(&camera));
    let size = scene.camera.size;
    let range = |every: u64| {
        let of_tile = |index: u64| {
            let mut rays = CameraRays::default();
            let tile = Tile::of_image(size, index * every);
            generator.generate(&mut rays, &centred.sampler, tile, 0..centred.samples);
            rays.ratios
                .iter()
                .fold(NOTHING, |range, w| widened(range, *w))
        };
        let tiles = (0..Tile::count(size).div_ceil(every)).into_par_iter();
        tiles
            .map(of_tile)
            .reduce(|| NOTHING, |a, [low, high]| widened(widened(a, low), high))
    };
    let is_outside = |range: &[f64; 2]| range[0] <= range[1] && is_outside(*range, within);
    let few = Some(range(one_in(size))).filter(is_outside);
    Ok(few.map(|_| range(1)).filter(is_outside))
}

const NOTHING: [f64; 2] = [f64::INFINITY, 0.0];

fn widened([low, high]: [f64; 2], w: f64) -> [f64; 2] {
    [low.min(w), high.max(w)]
}

fn is_outside([low, high]: [f64; 2], [least, most]: [f64; 2]) -> bool {
    low > most || high < least
}

/// The range of W for one tile in `every`, and whether the rays hit a surface.
fn ratios_by(
    scene: &Prepared,
    every: u64,
    pixel_samples: PixelSamples,
) -> (Option<[f64; 2]>, bool) {
    let surfaces = scene.surfaces();
    let range = |index| {
        let range = std::cell::Cell::new(None);
        let mut has_met = false;
        let tile = Tile::of_image(scene.layout.size, index * every);
        let note = |w: f64| range.set(Some(widened(range.get().unwrap_or(NOTHING), w)));
        let sky = matches!(scene.background, Background::Sky { .. });
        each_point(
            scene,
            &surfaces,
            (tile, pixel_samples),
            |observed| {
                has_met = true;
                note(observed.w.0);
            },
            |w| {
                if sky {
                    note(w);
                }
            },
        );
        (range.get(), has_met)
    };
    let tiles = (0..Tile::count(scene.layout.size).div_ceil(every)).into_par_iter();
    let both = |a: Option<[f64; 2]>, b: Option<[f64; 2]>| match (a, b) {
        (Some(a), Some(b)) => Some([a[0].min(b[0]), a[1].max(b[1])]),
        (a, b) => a.or(b),
    };
    // Minimum and maximum do not depend on the order of tiles.
    tiles.map(range).reduce(
        || (None, false),
        |(a, met), (b, also)| (both(a, b), met || also),
    )
}
