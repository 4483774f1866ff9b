//! What surfaces and observers of a scene make of light: its effects, its equations and what its eye sees.

use crate::colour::{CompanionShift, RgbShift, Spectrum};
use crate::light::Received;
use crate::render::trace::{Colouring, Eye, Response, SampledSpectra, Scaling, SkySpectra};
use crate::scene::model::{
    Effects, Equations, LightKind, Scene, SkyRadiance, Source, SourceKind, Spectra,
};
use crate::spacetime::Quantity;

/// What surfaces in `scene` receive of light that measures `quantity`.
pub(super) fn received(quantity: Quantity, scene: &Scene) -> Received {
    match quantity {
        Quantity::Rgb => Received::Rgb(RgbShift::of(scene.continuation)),
        quantity => Received::Scaled(quantity),
    }
}

/// What an observer in `scene` makes of radiance of `quantity`.
pub(super) fn response(quantity: Quantity, scene: &Scene) -> Response {
    let Effects {
        doppler,
        searchlight,
        ..
    } = scene.effects;
    let eye = eye(scene);
    let brightness = match searchlight {
        true => Scaling::Of(scaling(quantity, scene.equations)),
        false => Scaling::None,
    };
    let (scaled, colour) = match (quantity.line().map(|l| eye.wavelength(l)), doppler) {
        (Some(wavelength), true) => (brightness, Colouring::ShiftedLine(wavelength)),
        (Some(wavelength), false) => (brightness, Colouring::UnshiftedLine(wavelength)),
        (None, true) if quantity == Quantity::Rgb => {
            let colour = Colouring::Rgb(RgbShift::of(scene.continuation), eye);
            (without(searchlight), colour)
        }
        (None, _) => (brightness, Colouring::Channels),
    };
    Response { scaled, colour }
}

/// The same of the radiance of a source; where its companions are seen, with these.
pub(super) fn response_to(source: &Source, scene: &Scene) -> Response {
    let plain = response(source.quantity, scene);
    let SourceKind::Cube(cube) = &source.kind else {
        return plain;
    };
    match plain.colour {
        Colouring::Rgb(_, eye) if !scene.companions_of(cube).is_empty() => Response {
            colour: Colouring::Companions(CompanionShift::get(), eye),
            ..plain
        },
        _ => plain,
    }
}

/// What an observer in `scene` makes of the spectra of its sky, as of those of objects.
pub(super) fn sky_spectra(scene: &Scene) -> SkySpectra {
    let Effects {
        doppler,
        searchlight,
        ..
    } = scene.effects;
    SkySpectra {
        scaled: match (doppler, searchlight) {
            (true, _) => without(searchlight),
            // Colours at rest, by the brightness of all their energy.
            (false, true) => Scaling::Of(Quantity::Integrated),
            (false, false) => Scaling::None,
        },
        shifted: doppler,
        eye: eye(scene),
    }
}

/// What an observer in `scene` makes of light that surfaces reflect, where it is sampled at wavelengths.
pub(super) fn sampled(scene: &Scene) -> Response {
    Response {
        scaled: without(scene.effects.searchlight),
        colour: Colouring::Sampled(eye(scene)),
    }
}

/// How light that surfaces of `scene` reflect is sampled at wavelengths, if it is.
pub(super) fn sampled_spectra(scene: &Scene) -> Option<SampledSpectra> {
    let of_lamp = scene.lights.iter().filter_map(|light| match &light.kind {
        LightKind::Lamp(lamp) => lamp.spectrum.as_ref(),
        LightKind::Area { .. } => None,
    });
    let of_objects = scene.objects.iter().filter_map(|o| o.spectrum.as_ref());
    let of_sky = scene.sky.as_ref().and_then(|sky| match &sky.background {
        SkyRadiance::Spectrum(spectrum) => Some(spectrum),
        SkyRadiance::Uniform(_) | SkyRadiance::Gradient { .. } | SkyRadiance::Image { .. } => None,
    });
    let mut all = of_lamp.chain(of_objects).chain(of_sky);
    (scene.spectra == Spectra::Sampled).then(|| SampledSpectra {
        eye: eye(scene),
        shift: RgbShift::of(scene.continuation),
        has_lines: all.any(Spectrum::is_of_lines),
    })
}

/// The scaling that goes with colours that have the searchlight effect in them.
pub(super) fn without(searchlight: bool) -> Scaling {
    match searchlight {
        true => Scaling::None,
        false => Scaling::HueAlone,
    }
}

/// The wavelengths that the observer sees.
pub(super) fn eye(scene: &Scene) -> Eye {
    scene.false_colour.map_or(Eye::HUMAN, Eye::seeing)
}

/// The quantity whose power of W is applied: Jarabo et al. 2015 have D⁻⁵ for lines and whole spectra too.
pub(crate) fn scaling(quantity: Quantity, equations: Equations) -> Quantity {
    match equations {
        Equations::Exact => quantity,
        Equations::Paper2015 => match quantity {
            Quantity::Line { .. } | Quantity::Integrated => Quantity::PerWavelength,
            Quantity::PerWavelength
            | Quantity::PerFrequency
            | Quantity::Photons
            | Quantity::PhotonsPerWavelength
            | Quantity::PhotonsPerFrequency
            | Quantity::Rgb => quantity,
        },
    }
}
