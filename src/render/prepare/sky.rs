//! The sky: its picture and its stars, if a scene has them.

use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use super::response::{received, response, sky_spectra};
use crate::camera::Shot;
use crate::error::{Error, Result};
use crate::io::budget::Budget;
use crate::io::files;
use crate::io::image::{Layers, exr, hdr, panorama};
use crate::io::spectrum::text_of;
use crate::light::sky::{
    Beaming, BoostedSky, LightGrid, Motion, Motions, Panorama, Sky, StarMap, stars,
};
use crate::render::plan::Plan;
use crate::render::trace::{Background, RestFrame, SkyLight};
use crate::scene::model::{self, Catalogue, ProjectionKind, Scene, SkyNegative, SkyRadiance};
use crate::spacetime::Quantity;

/// The scene's sky.
pub(super) fn load(scene: &Scene, plan: &Plan) -> Result<Option<Arc<Sky>>> {
    let Some(sky) = &scene.sky else {
        return Ok(None);
    };
    let budget = Budget::new(plan.memory_for_sky());
    let panorama = match &sky.background {
        SkyRadiance::Image {
            path,
            scale,
            rotation,
            negative,
        } => {
            let (texels, width) = picture(path, *negative, &budget)?;
            budget.take(Panorama::bytes(width), path)?;
            Some(Panorama::new(texels, width, *scale, *rotation))
        }
        SkyRadiance::Uniform(_) | SkyRadiance::Gradient { .. } | SkyRadiance::Spectrum(_) => None,
    };
    let stars = match &sky.stars {
        Some(catalogue) => {
            let stars = stars(catalogue, &table(catalogue, &budget)?)?;
            let file = match &catalogue.catalogue {
                Catalogue::File(path) => path.as_path(),
                Catalogue::Random { .. } => Path::new(&scene.name),
            };
            budget.take(StarMap::bytes(stars.len()), file)?;
            stars
        }
        None => Vec::new(),
    };
    // If radiance is not RGB as a spectrum, stars have channels like everything else.
    let thermal_stars = scene.quantity == Quantity::Rgb;
    Ok(Some(Arc::new(Sky::new(
        sky,
        panorama,
        stars,
        thermal_stars,
    ))))
}

/// The radiance of rays that hit nothing.
pub(super) fn background(scene: &Scene, shot: &Shot, sky: Option<Arc<Sky>>) -> Background {
    let Some(sky) = sky else {
        return Background::Observed(scene.background);
    };
    let [angle, pixel] = angles(scene);
    let (response, spectra) = (response(scene.quantity, scene), sky_spectra(scene));
    let channels = scene.quantity != Quantity::Rgb;
    let scaled = if channels {
        response.scaled
    } else {
        spectra.scaled
    };
    Background::Sky {
        spectra: sky.has_spectra().then_some(spectra),
        sky,
        response,
        beaming: Beaming {
            motion: motion(scene, shot),
            power: scaled.beaming(),
            channels,
            shifted: spectra.shifted,
        },
        motions: motions(scene),
        angle,
        pixel,
    }
}

/// The angle between samples at rest in the camera's frame, and that between pixels where it is largest, radians.
pub(super) fn angles(scene: &Scene) -> [f64; 2] {
    let camera = &scene.camera;
    // Samples side by side in a row: √n for each pixel with n samples.
    let across = f64::from(camera.size[0]) * f64::from(scene.samples_per_pixel).sqrt();
    let of_frame = match camera.projection {
        // Wider in the middle than on average.
        ProjectionKind::Perspective => 2.0 * libm::tan(0.5 * camera.horizontal_fov),
        ProjectionKind::FisheyeEquidistant
        | ProjectionKind::FisheyeEquisolid
        | ProjectionKind::FisheyeOrthographic
        | ProjectionKind::Equirectangular => camera.horizontal_fov,
    };
    let pixels = f64::from(camera.size[0]);
    [camera.horizontal_fov / across, of_frame / pixels]
}

/// The motion that shows in the camera's directions.
pub(super) fn motion(scene: &Scene, shot: &Shot) -> Motion {
    match scene.effects.aberration {
        true => Motion::of(shot.frame.world_from_frame()),
        false => Motion::REST,
    }
}

/// The same by the moment of the exposure, if it changes.
pub(super) fn motions(scene: &Scene) -> Option<Box<Motions>> {
    let camera = &scene.camera;
    let duration = camera.shutter?.duration;
    let changes = camera.motion != model::Motion::Inertial && scene.effects.aberration;
    // The world line was checked when the scene was resolved.
    let line = camera.world_line().ok().filter(|_| changes)?;
    Some(Box::new(Motions {
        line,
        time: camera.time,
        duration,
    }))
}

/// The sky as a light of the surfaces of `frames`.
pub(super) fn light(scene: &Scene, sky: &Arc<Sky>, frames: &[RestFrame]) -> Option<SkyLight> {
    let model = scene.sky.as_ref().filter(|sky| sky.lights)?;
    let grid = Arc::new(LightGrid::new(sky));
    let boosted = |rest: &RestFrame| {
        BoostedSky::new(
            sky,
            &grid,
            rest.frame.frame_from_world(),
            received(scene.quantity, scene),
        )
    };
    Some(SkyLight {
        sky: sky.clone(),
        frames: frames.iter().map(boosted).collect(),
        shadows: model.shadows,
    })
}

/// The text of a catalogue's table.
fn table(stars: &model::Stars, budget: &Budget) -> Result<String> {
    let Catalogue::File(path) = &stars.catalogue else {
        return Ok(String::new());
    };
    text_of(contents(path, budget)?, path, "a CSV table of stars")
}

/// All bytes of a file, taken from `budget`.
fn contents(path: &Path, budget: &Budget) -> Result<Vec<u8>> {
    let (file, length) = files::open(path).map_err(Error::io(path, "cannot read"))?;
    budget.take(length, path)?;
    let mut bytes = Vec::new();
    let read = file.take(length).read_to_end(&mut bytes);
    read.map_err(Error::io(path, "cannot read"))?;
    Ok(bytes)
}

/// The texels of an equirectangular picture, and its width; those below 0 are dealt with as `negative` says.
fn picture(path: &Path, negative: SkyNegative, budget: &Budget) -> Result<(Vec<[f32; 3]>, usize)> {
    let ([width, height], mut texels) = if panorama::is_hdr(path) {
        hdr::read(&contents(path, budget)?, path, budget)?
    } else {
        let layers = exr::read_whole(path, budget)?;
        let size = [layers.width as usize, layers.height as usize];
        (size, linear(&layers, path)?)
    };
    if width != 2 * height {
        let what = format!("{width} by {height} pixels are not 2:1");
        let help = "a sky is an equirectangular picture, twice as wide as high";
        return Err(Error::invalid(path, "", what, help));
    }
    let first = |texels: &[[f32; 3]], is_bad: fn(&f32) -> bool| {
        let at = texels.iter().position(|t| t.iter().any(is_bad));
        at.map(|at| format!("pixel ({}, {})", at % width, at / width))
    };
    match negative {
        SkyNegative::Zero => {
            let all = texels.as_flattened_mut().iter_mut();
            all.filter(|c| **c < 0.0).for_each(|c| *c = 0.0);
        }
        SkyNegative::Refuse => {
            if let Some(place) = first(&texels, |c| *c < 0.0) {
                let what = "a radiance below 0";
                let help = "negative = \"zero\" in the `image` of [sky] takes such radiances as 0";
                return Err(Error::invalid(path, place, what, help));
            }
        }
    }
    if let Some(place) = first(&texels, |c| !c.is_finite()) {
        let what = "a radiance that is infinite or not a number";
        return Err(Error::invalid(path, place, what, "radiances of at least 0"));
    }
    Ok((texels, width))
}

/// Linear RGB of an EXR picture, which may be grey.
fn linear(layers: &Layers, path: &Path) -> Result<Vec<[f32; 3]>> {
    if let Some(radiance) = layers.radiance() {
        let texels = radiance.into_iter().map(|rgb| rgb.map(|c| c as f32));
        return Ok(texels.collect());
    }
    let grey = layers.grey().ok_or_else(|| {
        let help = "an EXR image with the channels R, G and B, or Y alone";
        Error::invalid(path, "", "it has no R, G and B, nor a single channel", help)
    })?;
    let texels = grey.samples.to_f64().into_iter();
    Ok(texels.map(|grey| [grey as f32; 3]).collect())
}
