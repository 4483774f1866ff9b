//! Lights as the bundle describes them, and what it cannot describe.

use super::bundle::{EmissionEntry, LampEntry};
use super::describe::{matrix, velocity};
use crate::mesh::Material;
use crate::scene::model::{Beam, EmissionProfile, Lamp, Light, LightKind, Scene, Spectra};
use crate::spacetime::Quantity;

/// The lamps of `scene` that move without acceleration.
pub(super) fn lamps(scene: &Scene) -> Vec<LampEntry> {
    let lamp = |light: &Light| match &light.kind {
        LightKind::Lamp(lamp) => describe(light, lamp),
        LightKind::Area { .. } => None,
    };
    scene.lights.iter().filter_map(lamp).collect()
}

fn describe(light: &Light, lamp: &Lamp) -> Option<LampEntry> {
    let frame = lamp.world_line().ok()?.frame()?;
    let (beam, axis, cone) = match lamp.beam {
        Beam::Point => ("point", None, None),
        Beam::Spot { axis, inner, outer } => ("spot", Some(axis), Some([inner, outer])),
        Beam::Parallel(direction) => ("parallel", Some(direction), None),
    };
    Some(LampEntry {
        name: light.name.clone(),
        beam,
        axis: axis.map(|axis| axis.to_array()),
        cone,
        intensity: lamp.intensity,
        emission: emission(&lamp.emission),
        origin: frame.origin().to_array(),
        velocity: velocity(frame.velocity()),
        world_from_lamp: matrix(frame.world_from_frame()),
        shadows: light.shadows,
    })
}

fn emission(profile: &EmissionProfile) -> EmissionEntry {
    let steady = EmissionEntry {
        kind: "steady",
        centre: None,
        sigma: None,
        period: None,
        count: None,
        table: None,
    };
    match profile {
        EmissionProfile::Steady => steady,
        EmissionProfile::Gaussian { centre, sigma } => EmissionEntry {
            kind: "gaussian",
            centre: Some(*centre),
            sigma: Some(*sigma),
            ..steady
        },
        EmissionProfile::Train {
            centre,
            sigma,
            period,
            count,
        } => EmissionEntry {
            kind: "train",
            centre: Some(*centre),
            sigma: Some(*sigma),
            period: Some(*period),
            count: *count,
            ..steady
        },
        EmissionProfile::Table(table) => EmissionEntry {
            kind: "table",
            table: Some(table.clone()),
            ..steady
        },
    }
}

/// Whether a surface reflects diffusely, and does not emit.
pub(super) fn is_matte(material: &Material) -> bool {
    let is_diffuse = material.metallic == 0.0 && material.roughness == 1.0;
    let is_dark = material.emissive == [0.0; 3] && material.emissive_texture.is_none();
    is_diffuse && is_dark && material.transmission == 0.0
}

/// What affects the light of `scene` but is not described by a bundle.
pub(super) fn undescribed(scene: &Scene, is_matte: bool) -> Vec<&'static str> {
    let has = |of: &dyn Fn(&Light) -> bool| scene.lights.iter().any(of);
    let lamp = |of: fn(&Lamp) -> bool| move |light: &Light| matches!(&light.kind, LightKind::Lamp(lamp) if of(lamp));
    let is_area = |light: &Light| matches!(light.kind, LightKind::Area { .. });
    let all_effects = scene.effects.searchlight && scene.effects.doppler;
    let reasons = [
        (
            scene.sky.is_some(),
            "the sky: what rays that hit nothing see, and its light on surfaces",
        ),
        (has(&is_area), "lights that are surfaces of objects"),
        (
            has(&lamp(|lamp| {
                lamp.world_line().is_ok_and(|line| line.frame().is_none())
            })),
            "lamps that accelerate, which `lamps` leaves out",
        ),
        (
            has(&lamp(|lamp| lamp.spectrum.is_some())),
            "spectra of lamps, on which their intensity is a factor",
        ),
        (
            scene.is_lit() && scene.quantity == Quantity::Rgb,
            "the Doppler shift of moving lamps' colours at surfaces (quantity \"rgb\")",
        ),
        (
            scene.is_lit() && !all_effects,
            "the light of lamps with effects turned off",
        ),
        (
            scene.is_lit() && !is_matte,
            "surfaces that are not matte: metals, glossy and emissive ones, glass",
        ),
        (scene.bounces > 0, "light that is reflected more than once"),
        (
            scene.spectra == Spectra::Sampled,
            "spectra of the light that surfaces reflect",
        ),
    ];
    let found = reasons.into_iter().filter(|(is_so, _)| *is_so);
    found.map(|(_, what)| what).collect()
}
