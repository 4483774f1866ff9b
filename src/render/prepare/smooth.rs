//! Objects that are perfect mirrors because of their textures.

use std::collections::{BTreeSet, HashMap};

use super::emitters::SurfaceLight;
use crate::render::trace::{Emitter, RestFrame};

/// The objects with a texture that makes their roughness 0 in some texel, and that reflect light of lamps and transmit none.
pub(super) fn mirrors_by_texture(light: &SurfaceLight, frames: &[RestFrame]) -> BTreeSet<usize> {
    let mut mirrors = BTreeSet::new();
    let Some(light) = light.time_resolved() else {
        return mirrors;
    };
    let mut least: HashMap<usize, f64> = HashMap::new();
    for (rest, patch) in frames
        .iter()
        .flat_map(|rest| rest.patches.iter().map(move |p| (rest, p)))
    {
        let Emitter::Lit { finish, .. } = &light.emitters[patch.emitter as usize].0 else {
            continue;
        };
        let Some(gloss) = finish.gloss.filter(|_| finish.glass.is_none()) else {
            continue;
        };
        // Without the coordinates that the texture needs, only factors count.
        let uvs = |set: usize| rest.meshes.get(patch.mesh as usize)?.uvs.get(set);
        let Some(lookup) = gloss.texture.filter(|of| uvs(of.uv_set).is_some()) else {
            continue;
        };
        let least = least.entry(lookup.texture);
        let least = *least.or_insert_with(|| light.base.textures[lookup.texture].least_green());
        if gloss.roughness * least == 0.0 {
            mirrors.insert(patch.object as usize);
        }
    }
    mirrors
}
