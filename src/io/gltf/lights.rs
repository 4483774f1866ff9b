//! Lights of a file (KHR_lights_punctual): they shine along their node's local −Z. Candela and lux are taken as radiometric power, without
//! a factor. A `range`, beyond which a program may ignore the light, is not applied: it is a hint, and light falls off as 1/r² at any
//! distance.

use std::f64::consts::FRAC_PI_2;

use ::gltf::json::extensions::scene::khr_lights_punctual::{Light, Type};
use ::gltf::json::validation::Checked;
use glam::{DAffine3, DVec3};

use super::document::{Document, shortened};
use super::holders::{self, Held};
use super::nodes::{Hierarchy, Placed};
use super::warnings::Warnings;
use crate::Result;
use crate::spacetime::{Direction, World};

/// A light with its position and direction.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct GltfLight {
    /// The name of its node, or its own name; "" if neither has one.
    pub name: String,
    /// How it shines.
    pub kind: GltfLightKind,
    /// Linear RGB: luminous intensity of a point or spot light in candela, illuminance of a directional one in lux.
    pub intensity: [f64; 3],
    /// Position, metres, in the coordinates of the file's root.
    pub position: DVec3,
    /// The direction in which it shines: a unit vector.
    pub direction: DVec3,
}

/// How a light shines.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum GltfLightKind {
    /// In all directions.
    Point,
    /// In a cone.
    Spot {
        /// Full intensity within this angle of the axis, radians.
        inner: f64,
        /// Dark beyond this angle, radians, which is above `inner` and at most π/2.
        outer: f64,
    },
    /// Parallel light.
    Directional,
}

/// The index of a node's light.
pub(super) fn index_of(document: &Document, node: usize) -> Option<usize> {
    let node = document.root.nodes.get(node)?;
    let light = node.extensions.as_ref()?.khr_lights_punctual.as_ref()?;
    Some(light.light.value())
}

fn all<'d>(document: &'d Document) -> &'d [Light] {
    let extensions = document.root.extensions.as_ref();
    let lights = extensions.and_then(|all| all.khr_lights_punctual.as_ref());
    lights.map_or(&[], |all| &all.lights)
}

/// Whether the light of a node has a range beyond which programs may ignore it.
pub(super) fn has_range(document: &Document, node: usize) -> bool {
    let light = index_of(document, node).and_then(|index| all(document).get(index));
    light.is_some_and(|light| light.range.is_some())
}

const LIGHTS: Held = Held {
    noun: "light",
    otherwise: "export the model with its lights (KHR_lights_punctual), or give `type`, `position` and `intensity`",
    of: own_name,
};

fn own_name<'d>(document: &'d Document, node: usize) -> Option<&'d str> {
    let light = all(document).get(index_of(document, node)?);
    let name = light.and_then(|light| light.name.as_deref());
    Some(name.unwrap_or_default())
}

/// The names of the lights among these nodes.
pub(super) fn names(document: &Document, nodes: &[usize]) -> Vec<String> {
    holders::names(document, nodes.iter().copied(), &LIGHTS)
}

/// The lights of the default scene that are not hidden.
pub(super) fn all_shown(document: &Document) -> Result<Vec<GltfLight>> {
    let mut warnings = Warnings::default();
    let hierarchy = Hierarchy::new(document, &mut warnings)?;
    let nodes = hierarchy.select(document, None, &mut warnings)?;
    let lights = nodes.into_iter().filter_map(|at| of_node(document, at));
    lights.collect()
}

/// The light with this name, or the only one.
pub(super) fn find(document: &Document, name: Option<&str>) -> Result<GltfLight> {
    let hierarchy = Hierarchy::new(document, &mut Warnings::default())?;
    let node = holders::find(document, &hierarchy, name, &LIGHTS)?;
    let world = hierarchy.world(node);
    of_node(document, Placed { node, world }).unwrap_or_else(|| {
        let place = document.node_label(node);
        Err(document.invalid(place, "the node has no light", ""))
    })
}

/// The light of a node, if it has one.
fn of_node(document: &Document, Placed { node, world }: Placed) -> Option<Result<GltfLight>> {
    let index = index_of(document, node)?;
    let place = document.node_label(node);
    let Some(light) = all(document).get(index) else {
        let what = format!("it refers to light {index}, which does not exist");
        let help = "every index must be within its list";
        return Some(Err(document.invalid(place, what, help)));
    };
    let described = document.root.nodes.get(node);
    let of_node = described.and_then(|node| node.name.as_deref());
    let name = of_node.filter(|name| !name.is_empty());
    let name = shortened(name.or(light.name.as_deref()).unwrap_or_default());
    let light = one(document, light, world, &place);
    Some(light.map(|light| GltfLight { name, ..light }))
}

fn one(document: &Document, light: &Light, world: DAffine3, place: &str) -> Result<GltfLight> {
    let invalid = |what: String, help: &str| Err(document.invalid(place, what, help));
    let strength = f64::from(light.intensity);
    let intensity = light.color.map(|c| f64::from(c) * strength);
    if !intensity.iter().all(|c| (0.0..=f64::MAX).contains(c)) {
        let what = format!("its light has the intensity {intensity:?}");
        return invalid(what, "colour and intensity are finite and not negative");
    }
    let kind = match (&light.type_, &light.spot) {
        (Checked::Valid(Type::Point), _) => GltfLightKind::Point,
        (Checked::Valid(Type::Directional), _) => GltfLightKind::Directional,
        (Checked::Valid(Type::Spot), spot) => {
            let spot = spot.as_ref();
            let inner = spot.map_or(0.0, |s| f64::from(s.inner_cone_angle));
            let outer = spot.map_or(0.5 * FRAC_PI_2, |s| f64::from(s.outer_cone_angle));
            // f32 rounds a right angle up.
            let right = outer > FRAC_PI_2 && outer < FRAC_PI_2 + 1e-7;
            let outer = if right { FRAC_PI_2 } else { outer };
            if !(0.0 <= inner && inner < outer && outer <= FRAC_PI_2) {
                let what = format!("the cone of its spot light goes from {inner} to {outer} rad");
                let help = "0 ≤ innerConeAngle < outerConeAngle ≤ π/2";
                return invalid(what, help);
            }
            GltfLightKind::Spot { inner, outer }
        }
        (Checked::Invalid, _) => {
            let help = "a light is \"point\", \"spot\" or \"directional\"";
            return invalid("the type of its light is not valid in glTF".into(), help);
        }
    };
    let Some(direction) = Direction::<World>::new(-world.matrix3.z_axis) else {
        let what = "its transform leaves the light without a direction".into();
        return invalid(what, "place lights by rotation and translation");
    };
    Ok(GltfLight {
        name: String::new(),
        kind,
        intensity,
        position: world.translation,
        direction: direction.unit(),
    })
}
