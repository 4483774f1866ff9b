//! Reflection that is not computed in a medium: that of surfaces that move in it, unless it is diffuse.
//!
//! A diffuse surface sees each source in the direction and with the wavelength ratio of vacuum: in its rest frame the irradiance is
//! ∫ W⁻⁴ L cos θ dω as without a medium, from lamps as from paths, and no direction towards the observer matters. The latter is that of
//! the ray (−η, d), which is not null: its transform to the rest frame is not the direction of vacuum from which light reflected by a
//! mirror, by gloss or by glass goes on, so that even a mirror that slides in its own plane would turn it.

use super::bindings::{Lit, shown_by};
use super::planned::PlannedObject;
use crate::error::{Problem, Result, number};
use crate::scene::model::Scene;
use crate::spacetime::units::quoted;

/// Refuses surfaces that move in a medium and reflect light other than diffusely.
pub(super) fn check(scene: &Scene, objects: &[PlannedObject]) -> Result<()> {
    // Surfaces are diffuse where pulses alone light them.
    if scene.medium_index == 1.0 || !scene.is_lit() {
        return Ok(());
    }
    for (index, (object, planned)) in scene.objects.iter().zip(objects).enumerate() {
        if object.velocity.is_rest() {
            continue;
        }
        let mut materials = planned.materials.iter().zip(&planned.factors);
        let found = materials.find(|(name, factors)| {
            let is_unlit = planned.unlit.contains(name);
            let lit = shown_by(scene, index, (name, is_unlit));
            let mut factors = **factors;
            if scene.bounces == 0 {
                // Nothing is transmitted then.
                factors.transmission = 0.0;
            }
            matches!(lit, Lit::Reflecting(_)) && factors.is_glossy()
        });
        let Some((name, factors)) = found else {
            continue;
        };
        let kind = match (factors.is_glass() && scene.bounces > 0, factors.is_mirror()) {
            (true, _) => "is glass",
            (false, true) => "is a mirror",
            (false, false) => "has gloss",
        };
        let material = match name.as_str() {
            "" => String::new(),
            name => format!(", by its material {}", quoted(name)),
        };
        let what = format!(
            "{} moves in a medium of index {} and {kind}{material}",
            quoted(&object.name),
            number(scene.medium_index)
        );
        let help = "what a moving surface reflects in a medium is computed only if it is matte: leave index = 1, let it rest, or give it \
                    metallic = 0 and roughness = 1, without transmission or a texture of these";
        let place = format!("object {}", quoted(&object.name));
        let problem = Problem::new(&scene.name, place, what, help);
        let label = (object.span.clone(), "this object".into());
        return Err(scene.text_and_file().show(problem, vec![label]).invalid());
    }
    Ok(())
}
