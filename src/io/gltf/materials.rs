//! Base colours as time-independent radiance (glTF 2.0 §3.9): factor, texture, sides.
//!
//! Only base colour factor and texture and doubleSided are read. Alpha, emission, vertex colours,
//! metal, roughness and normal maps are not: surfaces here have a radiance, not a reflectance.

use std::collections::BTreeMap;

use ::gltf::json::material::AlphaMode;
use ::gltf::json::texture::{Info, WrappingMode};
use ::gltf::json::validation::Checked;
use ::gltf::json::{Index, material};
use glam::DVec2;

use super::document::{Document, label};
use super::warnings::Warnings;
use crate::Result;
use crate::mesh::{Material, TextureRef, Wrap};

/// A material as the mesh will hold it, and what its texture coordinates still need.
#[derive(Debug, Clone)]
pub(super) struct Resolved {
    /// `texture.image` counts images of the *document*, `texture.uv_set` its sets.
    pub material: Material,
    /// KHR_texture_transform, where it is not the identity.
    pub transform: Option<UvTransform>,
}

/// uv ↦ offset + R(rotation) · scale · uv (KHR_texture_transform). With v pointing down, a positive
/// rotation is counter-clockwise as seen on the image: R = [[cos, sin], [−sin, cos]].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct UvTransform {
    offset: DVec2,
    scale: DVec2,
    cos: f64,
    sin: f64,
}

impl UvTransform {
    pub fn apply(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let scaled = DVec2::new(u, v) * self.scale;
        let (c, s) = (self.cos, self.sin);
        [
            c * scaled.x + s * scaled.y + self.offset.x,
            c * scaled.y - s * scaled.x + self.offset.y,
        ]
    }
}

/// Resolves each of `used` (none is the default material); `textures` says whether textures matter.
pub(super) fn resolve(
    document: &Document,
    used: impl IntoIterator<Item = Option<usize>>,
    textures: bool,
    warnings: &mut Warnings,
) -> Result<BTreeMap<Option<usize>, Resolved>> {
    let mut resolved = BTreeMap::new();
    for index in used {
        let material = match index {
            Some(index) => one(document, index, textures, warnings)?,
            None => Resolved {
                material: default_material(),
                transform: None,
            },
        };
        resolved.insert(index, material);
    }
    Ok(resolved)
}

/// The material of primitives that name none: white, one-sided.
fn default_material() -> Material {
    Material {
        name: String::new(),
        base_colour: [1.0; 3],
        texture: None,
        double_sided: false,
    }
}

fn one(
    document: &Document,
    index: usize,
    textures: bool,
    warnings: &mut Warnings,
) -> Result<Resolved> {
    let number = Index::<material::Material>::new(u32::try_from(index).unwrap_or(u32::MAX));
    let material = document.get(number, "material", "materials")?;
    let place = label("material", index, material.name.as_deref());
    if material.alpha_mode != Checked::Valid(AlphaMode::Opaque) {
        warnings.add("alpha is ignored: the surface is opaque", &place);
    }
    if material.emissive_factor.0 != [0.0; 3] {
        warnings.add("emission is not read: radiance is the base colour", &place);
    }
    let pbr = &material.pbr_metallic_roughness;
    let [r, g, b, _] = pbr.base_color_factor.0;
    if [r, g, b].iter().any(|c| !(0.0..=f32::MAX).contains(c)) {
        let what = format!("its base colour is {r}, {g}, {b}");
        return Err(document.invalid(place, what, "base colours are finite and not negative"));
    }
    let (texture, transform) = match &pbr.base_color_texture {
        Some(info) if textures => texture(document, info, &place)?,
        _ => (None, None),
    };
    Ok(Resolved {
        material: Material {
            name: material.name.clone().unwrap_or_default(),
            base_colour: [r, g, b],
            texture,
            double_sided: material.double_sided,
        },
        transform,
    })
}

type Texture = (Option<TextureRef>, Option<UvTransform>);

fn texture(document: &Document, info: &Info, place: &str) -> Result<Texture> {
    let place = format!("{place}, texture {}", info.index.value());
    let texture = document.get(info.index, "texture", &place)?;
    if texture.source.value() == u32::MAX as usize {
        return Err(document.unsupported(
            place,
            "it has no image, or one that only an extension knows (KTX2, WebP, …)",
            "store textures as PNG or JPEG",
        ));
    }
    document.get(texture.source, "image", &place)?;
    let wrap = match texture.sampler {
        Some(sampler) => {
            let sampler = document.get(sampler, "sampler", &place)?;
            [&sampler.wrap_s, &sampler.wrap_t].map(wrap)
        }
        None => [Some(Wrap::Repeat); 2],
    };
    let [Some(wrap_u), Some(wrap_v)] = wrap else {
        let help = "wrapS and wrapT must be 10497, 33071 or 33648";
        return Err(document.invalid(place, "its sampler's wrapping is not of glTF", help));
    };
    let (set, transform) = transform(document, info, &place)?;
    let texture = TextureRef {
        image: texture.source.value(),
        uv_set: set as usize,
        wrap: [wrap_u, wrap_v],
    };
    Ok((Some(texture), transform))
}

fn wrap(mode: &Checked<WrappingMode>) -> Option<Wrap> {
    match mode {
        Checked::Valid(WrappingMode::Repeat) => Some(Wrap::Repeat),
        Checked::Valid(WrappingMode::MirroredRepeat) => Some(Wrap::Mirror),
        Checked::Valid(WrappingMode::ClampToEdge) => Some(Wrap::Clamp),
        Checked::Invalid => None,
    }
}

/// The set that a texture uses, and its transform.
fn transform(document: &Document, info: &Info, place: &str) -> Result<(u32, Option<UvTransform>)> {
    let extension = (info.extensions.as_ref()).and_then(|all| all.texture_transform.as_ref());
    let Some(transform) = extension else {
        return Ok((info.tex_coord, None));
    };
    let set = transform.tex_coord.unwrap_or(info.tex_coord);
    let (offset, scale) = (
        transform.offset.0.map(f64::from),
        transform.scale.0.map(f64::from),
    );
    let rotation = f64::from(transform.rotation.0);
    if ([rotation].iter().chain(&offset).chain(&scale)).any(|number| !number.is_finite()) {
        let what = "its KHR_texture_transform is not finite";
        return Err(document.invalid(place, what, "offset, rotation and scale are finite numbers"));
    }
    let (sin, cos) = libm::sincos(rotation);
    let transform = UvTransform {
        offset: DVec2::from_array(offset),
        scale: DVec2::from_array(scale),
        cos,
        sin,
    };
    let identity = rotation == 0.0 && offset == [0.0; 2] && scale == [1.0; 2];
    Ok((set, (!identity).then_some(transform)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The extension's own example: offset (0, 1), a quarter turn and scale ½ show the lower left
    /// quarter of the image, which is u in [0, ½] and v in [½, 1].
    #[test]
    fn a_quarter_turn_shows_the_lower_left_quarter_of_the_image() {
        let (sin, cos) = libm::sincos(std::f64::consts::FRAC_PI_2);
        let transform = UvTransform {
            offset: DVec2::new(0.0, 1.0),
            scale: DVec2::splat(0.5),
            cos,
            sin,
        };
        for (uv, expected) in [
            ([0.0, 0.0], [0.0, 1.0]),
            ([1.0, 0.0], [0.0, 0.5]),
            ([0.0, 1.0], [0.5, 1.0]),
            ([1.0, 1.0], [0.5, 0.5]),
        ] {
            let [u, v] = transform.apply(uv);
            let error = (u - expected[0]).abs() + (v - expected[1]).abs();
            assert!(error < 1e-15, "{uv:?} gives {u}, {v}");
        }
    }
}
