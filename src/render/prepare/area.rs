//! Objects that are area lights: their brightness over time.

use std::f64::consts::PI;

use super::backs::{Backs, backs};
use crate::mesh::Mesh;
use crate::scene::model::{Brightness, EmissionProfile, LightKind, Scene};

/// Objects that are area lights, and the numbers of their lights, which follow those of sources.
pub(super) fn area_lights(scene: &Scene) -> Vec<(u32, usize)> {
    let lights = (scene.sources.len()..).zip(&scene.lights);
    let area = |(number, light): (usize, &crate::scene::model::Light)| match light.kind {
        LightKind::Area { object, .. } => Some((object as u32, number)),
        LightKind::Lamp(_) => None,
    };
    lights.filter_map(area).collect()
}

/// An object that is an area light: its brightness, its emission profile, and whether it casts shadows.
pub(super) struct AreaLight<'a> {
    pub brightness: Brightness,
    pub emission: &'a EmissionProfile,
    pub shadows: bool,
}

/// `object` as an area light, if it is one.
pub(super) fn area_light(scene: &Scene, object: usize) -> Option<AreaLight<'_>> {
    scene.lights.iter().find_map(|light| match &light.kind {
        LightKind::Area {
            object: lit,
            brightness,
            emission,
        } if *lit == object => Some(AreaLight {
            brightness: *brightness,
            emission,
            shadows: light.shadows,
        }),
        _ => None,
    })
}

/// The radiance of an object that is an area light, whose mesh in its rest frame is `mesh`, unless its materials say what they emit: for
/// power Φ it is Φ/(π A), where A is the area of all sides that shine, because a side emits ∫ L cos θ dω = π L per area.
pub(super) fn area_radiance(scene: &Scene, object: usize, mesh: &Mesh) -> Option<[f64; 3]> {
    let power = match area_light(scene, object)?.brightness {
        Brightness::Radiance(radiance) => return Some(radiance),
        Brightness::Materials => {
            let emits = mesh.materials.iter().any(|m| m.emissive != [0.0; 3]);
            return (!emits).then_some([1.0; 3]);
        }
        Brightness::Power(power) => power,
    };
    let mut area = 0.0;
    for part in &mesh.parts {
        let sides = match backs(scene, &mesh.materials[part.material as usize]) {
            Backs::Same => 2.0,
            Backs::Culled | Backs::Black => 1.0,
        };
        for index in part.first_triangle..part.first_triangle + part.triangles {
            let [a, b, c] = mesh.corners(index);
            area += sides * 0.5 * (b - a).cross(c - a).length();
        }
    }
    Some(match area > 0.0 {
        true => power.map(|c| c / (PI * area)),
        false => [0.0; 3],
    })
}
