//! Colours and finishes of surfaces by patch and position, and how they reflect.

use std::sync::Arc;

use glam::DVec3;

use super::emitted::{Emitted, Response};
use super::rest_frame::{Patch, RestFrame};
use super::run::Run;
use super::surface_point::EmissionClock;
use crate::accel::Hit;
use crate::io::image::Texture;
use crate::light::lamp;
use crate::light::reflection::{Reflection, bent};
use crate::mesh::TextureSampler;

/// What the radiance of a point depends on, apart from its wavelength ratio: each variant includes all previous ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Dependence {
    /// Only the patch.
    Patch,
    /// The place and time of emission, and the triangle.
    Event,
    /// The barycentric weights on the triangle.
    Weights,
}

/// Radiance or reflectance: a factor, a texture, vertex colours, and for emission a profile in time.
#[derive(Debug, Clone)]
pub struct BaseColour {
    /// Linear RGB.
    pub factor: [f64; 3],
    /// Its texture.
    pub texture: Option<TextureLookup>,
    /// Whether the mesh's vertex colours are a factor, too.
    pub vertex_colours: bool,
    /// The observer's response, if it differs from the common one.
    pub response: Option<Response>,
    /// A factor as a function of the object's proper time; `None` if it is always 1.
    pub(crate) profile: Option<Arc<lamp::Emission>>,
}

/// A texture, and how it is looked up.
#[derive(Debug, Clone, Copy)]
pub struct TextureLookup {
    /// Index into [`BaseColours::textures`].
    pub texture: usize,
    /// The set of texture coordinates.
    pub uv_set: usize,
    /// How it is sampled.
    pub sampler: TextureSampler,
}

/// How a surface reflects and emits light.
#[derive(Debug, Clone)]
pub struct Finish {
    /// Index of its colour in the base colours.
    pub colour: usize,
    /// Metalness and roughness; `None` for a diffuse surface.
    pub gloss: Option<Gloss>,
    /// Transmission; `None` for an opaque surface.
    pub glass: Option<Glass>,
    /// Its own emission.
    pub emission: Option<BaseColour>,
    /// Whether meshes with this finish may have vertex normals.
    pub is_smooth: bool,
}

/// A hit, and the surface that it is on.
type Place<'a> = (&'a RestFrame, &'a Patch, &'a Hit);

impl Finish {
    /// The normal for diffuse reflection at a hit, on the same side as `geometric`, the triangle's normal.
    fn diffuse_normal(&self, (rest, patch, hit): Place, geometric: DVec3) -> DVec3 {
        let smooth = self.is_smooth.then(|| rest.vertex_normal(patch, hit));
        match smooth.flatten() {
            // Winding decides which side is outside: some exporters write normals for the opposite side.
            Some(normal) if normal.dot(geometric) < 0.0 => -normal,
            Some(normal) => normal,
            None => geometric,
        }
    }

    /// The normal for reflection at a hit towards `view`, on the same side as `geometric`, the triangle's normal.
    pub(super) fn normal(
        &self,
        place: Place,
        geometric: DVec3,
        view: impl FnOnce() -> DVec3,
    ) -> DVec3 {
        let normal = self.diffuse_normal(place, geometric);
        match self.is_smooth && self.gloss.is_some() {
            true => bent(normal, geometric, view()),
            false => normal,
        }
    }
}

impl BaseColour {
    /// The colour, if it is constant.
    #[inline]
    pub(super) fn constant(&self) -> Option<[f64; 3]> {
        (self.texture.is_none() && !self.vertex_colours).then_some(self.factor)
    }

    /// What it depends on.
    pub(super) fn dependence(&self) -> Dependence {
        match (self.constant(), &self.profile) {
            (None, _) => Dependence::Weights,
            (Some(_), Some(_)) => Dependence::Event,
            (Some(_), None) => Dependence::Patch,
        }
    }

    /// The factor at a proper time of the object.
    #[inline]
    pub(super) fn factor_at(&self, proper_time: impl FnOnce() -> f64) -> f64 {
        self.profile
            .as_ref()
            .map_or(1.0, |profile| profile.at(proper_time()))
    }

    /// Fills `factors` with the factors at the points of `run`, or empties it if they are always 1.
    pub(super) fn factors(&self, run: &Run, factors: &mut Vec<f64>) {
        factors.clear();
        if let Some(profile) = &self.profile {
            factors.resize(run.count(), 0.0);
            run.times(EmissionClock::Object, 0, factors);
            profile.at_each(factors);
        }
    }
}

/// The transmission of a surface.
#[derive(Debug, Clone, Copy)]
pub struct Glass {
    /// The transmitted fraction of the light that is not reflected.
    pub transmission: f64,
    /// Refractive index of the body that the surface bounds.
    pub index: f64,
    /// Whether the surface bounds a body; otherwise it is thin-walled.
    pub solid: bool,
}

/// Metalness and roughness.
#[derive(Debug, Clone, Copy)]
pub struct Gloss {
    /// Factor on the metalness.
    pub metallic: f64,
    /// Factor on the perceptual roughness.
    pub roughness: f64,
    /// Roughness in its green channel, metalness in its blue one.
    pub texture: Option<TextureLookup>,
    /// f₀ for a dielectric.
    pub dielectric: f64,
}

/// Base colours of all patches.
#[derive(Debug)]
pub struct BaseColours {
    /// By emitter index.
    pub colours: Vec<BaseColour>,
    /// Decoded textures.
    pub textures: Vec<Arc<Texture>>,
    /// The common response.
    pub response: Response,
}

impl BaseColours {
    /// What the factors of `finish` depend on.
    pub(super) fn dependence_of(&self, finish: &Finish) -> Dependence {
        // Its colour and its emission count as colours; the rest determines how it reflects.
        let is_textured = finish.gloss.is_some_and(|gloss| gloss.texture.is_some());
        let colours = [Some(&self.colours[finish.colour]), finish.emission.as_ref()];
        let all = colours.into_iter().flatten().map(BaseColour::dependence);
        let rest = match is_textured || finish.glass.is_some() || finish.is_smooth {
            true => Dependence::Weights,
            false => Dependence::Patch,
        };
        all.fold(rest, Dependence::max)
    }

    /// The emission of colour `index` at `hit`.
    pub(super) fn radiance(&self, index: usize, run: &Run, hit: &Hit) -> [f64; 3] {
        self.colour_at(&self.colours[index], run.rest, run.patch, hit)
    }

    /// The value of `base` at a hit on `patch` of the frame `rest`.
    pub(super) fn colour_at(
        &self,
        base: &BaseColour,
        rest: &RestFrame,
        patch: &Patch,
        hit: &Hit,
    ) -> [f64; 3] {
        let mut colour = base.factor;
        if let Some(lookup) = base.texture
            && let Some(uv) = rest.uv(patch, lookup.uv_set, hit)
        {
            // glTF multiplies factor, texture and vertex colours, all of them linear.
            let texel = self.textures[lookup.texture].sample(uv.to_array(), lookup.sampler);
            colour = std::array::from_fn(|c| base.factor[c] * texel[c]);
        }
        if base.vertex_colours
            && let Some(vertex) = rest.vertex_colour(patch, hit)
        {
            colour = std::array::from_fn(|c| colour[c] * vertex[c]);
        }
        colour
    }

    /// Metalness and roughness at a hit.
    pub(super) fn gloss(
        &self,
        gloss: &Gloss,
        rest: &RestFrame,
        patch: &Patch,
        hit: &Hit,
    ) -> [f64; 2] {
        let both = [gloss.metallic, gloss.roughness];
        let Some(lookup) = gloss.texture else {
            return both;
        };
        let Some(uv) = rest.uv(patch, lookup.uv_set, hit) else {
            return both;
        };
        // A glTF metallic-roughness texture holds numbers, not sRGB codes: green is roughness, blue metalness.
        let [_, roughness, metallic] =
            self.textures[lookup.texture].sample_linear(uv.to_array(), lookup.sampler);
        [gloss.metallic * metallic, gloss.roughness * roughness]
    }

    /// How a surface with this finish reflects at a hit, towards `view`, on the side of its triangle's normal `geometric`. `near` is the
    /// index of the medium of the observer relative to that of the scene's medium.
    #[inline]
    pub(super) fn reflection(
        &self,
        finish: &Finish,
        place: Place,
        (geometric, view): (DVec3, DVec3),
        near: f64,
    ) -> Reflection {
        let normal = finish.normal(place, geometric, || view);
        let reflection = self.reflection_by(finish, place, (normal, view), near);
        match finish.is_smooth {
            true => reflection.on(geometric),
            false => reflection,
        }
    }

    /// The same with a given shading normal.
    #[inline]
    fn reflection_by(
        &self,
        finish: &Finish,
        (rest, patch, hit): Place,
        (normal, view): (DVec3, DVec3),
        near: f64,
    ) -> Reflection {
        let colour = self.colour_at(&self.colours[finish.colour], rest, patch, hit);
        let Some(gloss) = &finish.gloss else {
            return Reflection::diffuse(normal, colour).within(near);
        };
        let [metallic, roughness] = self.gloss(gloss, rest, patch, hit);
        let look = [metallic, roughness];
        let reflection =
            Reflection::metallic_roughness(normal, view, colour, look, gloss.dielectric);
        match &finish.glass {
            // Seen from inside, the other side is the scene's medium: bodies of glass do not touch.
            Some(glass) if glass.solid => {
                let (near, far) = match hit.front {
                    true => (near, glass.index),
                    false => (glass.index, 1.0),
                };
                let reflection = reflection.within(near);
                reflection.as_glass(glass.transmission, far, true)
            }
            Some(glass) => {
                let reflection = reflection.within(near);
                reflection.as_glass(glass.transmission, glass.index, false)
            }
            None if roughness == 0.0 => reflection.as_mirror().within(near),
            None => reflection.within(near),
        }
    }

    /// The diffuse part of the reflection only.
    pub(super) fn diffuse_part(
        &self,
        finish: &Finish,
        place: Place,
        geometric: DVec3,
    ) -> Reflection {
        let (rest, patch, hit) = place;
        let colour = self.colour_at(&self.colours[finish.colour], rest, patch, hit);
        let metallic = finish.gloss.as_ref();
        let metallic = metallic.map_or(0.0, |gloss| self.gloss(gloss, rest, patch, hit)[0]);
        let transmission = finish
            .glass
            .as_ref()
            .map_or(0.0, |glass| glass.transmission);
        let part = (1.0 - metallic) * (1.0 - transmission);
        let normal = finish.diffuse_normal(place, geometric);
        Reflection::diffuse(normal, colour.map(|c| c * part)).on(geometric)
    }

    /// Fills in what colour `index` emits at the points of `run`.
    pub(super) fn fill(&self, index: usize, run: &Run, emitted: &mut Emitted) {
        let base = &self.colours[index];
        // A constant colour: no hit needs to be reconstructed.
        match base {
            BaseColour {
                texture: None,
                vertex_colours: false,
                factor,
                ..
            } => emitted.radiance.resize(run.count(), *factor),
            _ => {
                let hits = (0..run.count()).filter_map(|k| run.hit(k));
                let radiance = hits.map(|hit| self.radiance(index, run, &hit));
                emitted.radiance.extend(radiance);
            }
        }
        // Steady colours have no factors: the loop ends at once and leaves the radiance unchanged.
        base.factors(run, &mut emitted.times);
        for (radiance, factor) in emitted.radiance.iter_mut().zip(&emitted.times) {
            *radiance = radiance.map(|c| c * factor);
        }
    }
}
