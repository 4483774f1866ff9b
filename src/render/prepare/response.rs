//! The responses of surfaces and observers of a scene to light: its effects, its equations and its spectral range.

use crate::colour::{CompanionShift, RgbShift, Spectrum};
use crate::light::Received;
use crate::render::trace::{Colouring, Eye, Response, SampledSpectra, Scaling, SkySpectra};
use crate::scene::model::{
    Effects, Equations, LightKind, Scene, SkyRadiance, Source, SourceKind, Spectra,
};
use crate::spacetime::Quantity;

/// The received light of surfaces in `scene`, for light that measures `quantity`.
pub(super) fn received(quantity: Quantity, scene: &Scene) -> Received {
    match quantity {
        Quantity::Rgb => Received::Rgb(RgbShift::of(scene.continuation)),
        quantity => Received::Scaled(quantity),
    }
}

/// The response of an observer in `scene` to radiance of `quantity`.
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

/// The same for the radiance of a source; with its companions if they are visible.
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

/// The response of an observer in `scene` to the spectra of its sky.
pub(super) fn sky_spectra(scene: &Scene) -> SkySpectra {
    let Effects {
        doppler,
        searchlight,
        ..
    } = scene.effects;
    SkySpectra {
        scaled: match (doppler, searchlight) {
            (true, _) => without(searchlight),
            // Colours at rest, scaled by the brightness of their total energy.
            (false, true) => Scaling::Of(Quantity::Integrated),
            (false, false) => Scaling::None,
        },
        shifted: doppler,
        eye: eye(scene),
    }
}

/// The response of an observer in `scene` to reflected light that is sampled at wavelengths.
pub(super) fn sampled(scene: &Scene) -> Response {
    Response {
        scaled: without(scene.effects.searchlight),
        colour: Colouring::Sampled(eye(scene)),
    }
}

/// How light reflected by surfaces of `scene` is sampled at wavelengths, if it is.
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

/// The scaling for colours that include the searchlight effect.
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

/// The quantity whose power of W is applied: Jarabo et al. 2015 use D⁻⁵ for lines and whole spectra too.
pub(crate) fn scaling(quantity: Quantity, equations: Equations) -> Quantity {
    match equations {
        Equations::Exact => quantity,
        Equations::Paper2015 => quantity.as_in_2015(),
    }
}
