//! Materials (glTF 2.0 §3.9): metallic-roughness factors and textures, emission with its strength (KHR_materials_emissive_strength), alpha,
//! sides, whether the material is unlit (KHR_materials_unlit), and glass: the transmitted fraction of light (KHR_materials_transmission),
//! its index (KHR_materials_ior), and whether it bounds a body (KHR_materials_volume with a thickness above 0) or is a film.
//!
//! Of materials with a diffuse and a specular colour (KHR_materials_pbrSpecularGlossiness) the diffuse one is read.
//!
//! Normal and occlusion textures are not read, nor absorption in a body of glass. For textures of its transmission see [`super::glass`].

use std::collections::BTreeMap;

use ::gltf::json::material::{
    AlphaMode as JsonAlphaMode, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor,
};
use ::gltf::json::texture::{Info, MagFilter, WrappingMode};
use ::gltf::json::validation::Checked;
use ::gltf::json::{Index, deserialize, material};
use glam::DVec2;
use serde::Deserialize;
use serde::de::IgnoredAny;

use super::document::{Document, label};
use super::extensions::SPECULAR_GLOSSINESS;
use super::images;
use super::import::{BadTextures, Want};
use super::primitive::MOST_SETS;
use super::warnings::Warnings;
use crate::Result;
use crate::mesh::{
    AlphaMode, MOST_INDEX, Material, TextureFilter, TextureRef, TextureSampler, Wrap,
};

/// A material as the mesh will store it, and the transforms that its texture coordinates still need.
#[derive(Debug, Clone)]
pub(super) struct Resolved {
    /// In its textures, `image` is an index in the *document*, and `uv_set` one of its sets; from [`FIRST_TRANSFORMED`] on, it is an index
    /// into `transforms`.
    pub material: Material,
    /// The sets that KHR_texture_transform changes, and how, without repetitions.
    pub transforms: Vec<(usize, UvTransform)>,
    /// Whether its mask stands for blending by the alpha of its texture, if that has one.
    pub blends: bool,
    pub glass: Glass,
}

/// What else a file says of glass.
#[derive(Debug, Clone, Default)]
pub(super) struct Glass {
    /// The material, for messages.
    pub place: String,
    /// The image in the document whose red is a factor on the transmission.
    pub texture: Option<usize>,
    /// Warnings about features of glass that are ignored, if it is glass.
    pub uncomputed: Vec<&'static str>,
}

/// The extensions for transmission, and for bodies of glass.
const TRANSMISSION: &str = "KHR_materials_transmission";
const VOLUME: &str = "KHR_materials_volume";

/// The first set number that stands for a transform in a [`Resolved`] material.
pub(super) const FIRST_TRANSFORMED: usize = MOST_SETS as usize;

impl Resolved {
    /// The sets of the document that its textures use.
    pub fn sets(&self) -> impl Iterator<Item = usize> {
        let set = |t: &TextureRef| match t.uv_set.checked_sub(FIRST_TRANSFORMED) {
            None => Some(t.uv_set),
            Some(which) => self.transforms.get(which).map(|(set, _)| *set),
        };
        self.material.textures().filter_map(set)
    }

    /// Whether one of its textures uses this set of the document.
    pub fn uses_set(&self, set: usize) -> bool {
        self.sets().any(|used| used == set)
    }

    /// Whether the surface has holes.
    pub fn is_masked(&self) -> bool {
        self.material.is_masked()
    }
}

/// uv ↦ offset + R(rotation) · scale · uv (KHR_texture_transform). As v points down, a positive rotation is counter-clockwise as seen in
/// the image: R = [[cos, sin], [−sin, cos]].
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

/// Resolves each of `used` (`None` is the default material), with the textures that `want` requests.
pub(super) fn resolve(
    document: &Document,
    used: impl IntoIterator<Item = Option<usize>>,
    want: Want,
    warnings: &mut Warnings,
) -> Result<BTreeMap<Option<usize>, Resolved>> {
    let mut resolved = BTreeMap::new();
    for index in used {
        let material = match index {
            Some(index) => one(document, index, want, warnings)?,
            None => Resolved {
                material: Material::default(),
                transforms: Vec::new(),
                blends: false,
                glass: Glass::default(),
            },
        };
        resolved.insert(index, material);
    }
    Ok(resolved)
}

fn one(document: &Document, index: usize, want: Want, warnings: &mut Warnings) -> Result<Resolved> {
    // An index that does not fit in 32 bits is out of range for any list, and is refused as such.
    let number = Index::<material::Material>::new(u32::try_from(index).unwrap_or(u32::MAX));
    let material = document.get(number, "material", "materials")?;
    let mut reader = Reader {
        document,
        place: label("material", index, material.name.as_deref()),
        transforms: Vec::new(),
        bad_textures: want.bad_textures,
        warnings,
    };
    let pbr = &reader.pbr(material)?;
    // The alpha of a mask is in the texture of its base colour, so it is loaded even if colours are not wanted.
    let [r, g, b, alpha] = pbr.base_color_factor.0;
    let (alpha_mode, blends) = match reader.alpha_mode(material)? {
        // Half the alpha of the texture, whatever the factor: a window that is transparent as a whole stays opaque.
        AlphaMode::Blend if pbr.base_color_texture.is_some() => (
            AlphaMode::Mask {
                cutoff: 0.5 * alpha,
            },
            true,
        ),
        mode => (mode, false),
    };
    reader.warn(material, blends);
    let glass = reader.glass(material)?;
    // Of an unlit material only the base colour counts: where it reflects light, it is matte.
    let unlit = (material.extensions.as_ref()).is_some_and(|all| all.unlit.is_some());
    let masked = matches!(alpha_mode, AlphaMode::Mask { .. });
    Ok(Resolved {
        material: Material {
            name: material.name.clone().unwrap_or_default(),
            base_colour: reader.colour([r, g, b], "base colour")?,
            base_colour_texture: match &pbr.base_color_texture {
                Some(info) if want.textures || masked => reader.texture(info)?,
                _ => None,
            },
            metallic: match unlit {
                true => 0.0,
                false => reader.fraction(pbr.metallic_factor.0, "metallicFactor")?,
            },
            roughness: match unlit {
                true => 1.0,
                false => reader.fraction(pbr.roughness_factor.0, "roughnessFactor")?,
            },
            metallic_roughness_texture: match &pbr.metallic_roughness_texture {
                Some(info) if want.shading && !unlit => reader.texture(info)?,
                _ => None,
            },
            emissive: reader.emissive(material)?,
            emissive_texture: match &material.emissive_texture {
                Some(info) if want.shading => reader.texture(info)?,
                _ => None,
            },
            transmission: reader.transmission(material)?,
            ior: reader.ior(material)?,
            solid: reader.number(material, VOLUME, "thicknessFactor", 0.0) > 0.0,
            alpha: reader.fraction(alpha, "the alpha of its base colour")?,
            alpha_mode,
            // Only a thickness indicates a body: without it the glass is a film, which does not refract.
            unlit,
            double_sided: material.double_sided,
        },
        transforms: reader.transforms,
        blends,
        glass,
    })
}

/// Reads one material.
struct Reader<'d, 'a> {
    document: &'d Document<'a>,
    /// For messages.
    place: String,
    transforms: Vec<(usize, UvTransform)>,
    bad_textures: BadTextures,
    warnings: &'d mut Warnings,
}

impl Reader<'_, '_> {
    /// Warns about features of the material that are ignored.
    fn warn(&mut self, material: &material::Material, blends: bool) {
        if material.alpha_mode == Checked::Valid(JsonAlphaMode::Blend) {
            let what = match blends {
                true => {
                    "alpha blending is not supported: what its texture shows with an alpha below a half is left out, and the rest is opaque"
                }
                false => "alpha blending is not supported: the surface is opaque",
            };
            self.warnings.add(what, &self.place);
        }
        if material.normal_texture.is_some() {
            self.warnings.add("normal maps are not read", &self.place);
        }
        if material.occlusion_texture.is_some() {
            self.warnings
                .add("occlusion maps are not read", &self.place);
        }
    }

    /// What the material says of glass, apart from its factors.
    fn glass(&mut self, material: &material::Material) -> Result<Glass> {
        let is_glass = self.number(material, TRANSMISSION, "transmissionFactor", 0.0) > 0.0;
        let pbr = &material.pbr_metallic_roughness;
        let is_rough = pbr.roughness_factor.0 > 0.0 || pbr.metallic_roughness_texture.is_some();
        let absorbs = self.number(material, VOLUME, "attenuationDistance", 0.0) > 0.0;
        let has_thickness = extension(material, VOLUME, "thicknessTexture").is_some();
        let uncomputed = [
            (is_rough, "rough glass is taken as smooth"),
            (absorbs, "absorption in glass is not computed"),
            (
                has_thickness && self.number(material, VOLUME, "thicknessFactor", 0.0) > 0.0,
                "its thicknessTexture is not read: where it is glass, it bounds a body of glass",
            ),
        ];
        let uncomputed = uncomputed.into_iter().filter(|(is, _)| is_glass && *is);
        let texture = extension(material, TRANSMISSION, "transmissionTexture");
        Ok(Glass {
            place: self.place.clone(),
            texture: match texture.filter(|_| is_glass) {
                None => None,
                Some(info) => {
                    let info = deserialize::from_value::<Info>(info.clone()).map_err(|error| {
                        let what = format!("its transmissionTexture cannot be read: {error}");
                        self.invalid(what, "a texture is { \"index\": … }")
                    })?;
                    let place = self.texture_place(&info);
                    self.image(&info, &place)?
                }
            },
            uncomputed: uncomputed.map(|(_, what)| what).collect(),
        })
    }

    /// The metallic-roughness properties. A material that has only a diffuse and a specular colour is a dielectric of the former.
    fn pbr(&mut self, material: &material::Material) -> Result<PbrMetallicRoughness> {
        let pbr = &material.pbr_metallic_roughness;
        let all = material.extensions.as_ref();
        let Some(value) = all.and_then(|all| all.others.get(SPECULAR_GLOSSINESS)) else {
            return Ok(pbr.clone());
        };
        let is_given = pbr.base_color_factor.0 != [1.0; 4]
            || pbr.base_color_texture.is_some()
            || pbr.metallic_roughness_texture.is_some()
            || [pbr.metallic_factor, pbr.roughness_factor]
                .iter()
                .any(|factor| factor.0 != 1.0);
        if is_given {
            return Ok(pbr.clone());
        }
        #[derive(Deserialize)]
        #[serde(rename_all = "camelCase", default)]
        struct SpecularGlossiness {
            diffuse_factor: [f32; 4],
            diffuse_texture: Option<Info>,
            glossiness_factor: f32,
            specular_glossiness_texture: Option<IgnoredAny>,
        }
        impl Default for SpecularGlossiness {
            fn default() -> Self {
                SpecularGlossiness {
                    diffuse_factor: [1.0; 4],
                    diffuse_texture: None,
                    glossiness_factor: 1.0,
                    specular_glossiness_texture: None,
                }
            }
        }
        let read = deserialize::from_value::<SpecularGlossiness>(value.clone());
        let given = read.map_err(|error| {
            let what = format!("its {SPECULAR_GLOSSINESS} cannot be read: {error}");
            self.invalid(what, "export the model with metallic-roughness materials")
        })?;
        let what = "of KHR_materials_pbrSpecularGlossiness only the diffuse colour and the glossiness factor are read; \
                    `gltf-transform metalrough IN.glb OUT.glb` converts all of it";
        self.warnings.add(what, &self.place);
        Ok(PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor(given.diffuse_factor),
            base_color_texture: given.diffuse_texture,
            metallic_factor: StrengthFactor(0.0),
            // A texture may make any part of it rough.
            roughness_factor: StrengthFactor(match given.specular_glossiness_texture {
                None => 1.0 - given.glossiness_factor,
                Some(_) => 1.0,
            }),
            ..pbr.clone()
        })
    }

    fn alpha_mode(&self, material: &material::Material) -> Result<AlphaMode> {
        match material.alpha_mode {
            Checked::Valid(JsonAlphaMode::Opaque) => Ok(AlphaMode::Opaque),
            Checked::Valid(JsonAlphaMode::Blend) => Ok(AlphaMode::Blend),
            Checked::Valid(JsonAlphaMode::Mask) => {
                let cutoff = material.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0);
                match (0.0..=f32::MAX).contains(&cutoff) {
                    true => Ok(AlphaMode::Mask { cutoff }),
                    false => Err(self.invalid(
                        format!("its alphaCutoff is {cutoff}"),
                        "alphaCutoff is finite and not negative",
                    )),
                }
            }
            Checked::Invalid => Err(self.invalid(
                "its alphaMode is not one that glTF defines",
                "alphaMode is \"OPAQUE\", \"MASK\" or \"BLEND\"",
            )),
        }
    }

    fn colour(&self, colour: [f32; 3], name: &str) -> Result<[f32; 3]> {
        let [r, g, b] = colour;
        match colour.iter().all(|c| (0.0..=f32::MAX).contains(c)) {
            true => Ok(colour),
            false => Err(self.invalid(
                format!("its {name} is {r}, {g}, {b}"),
                format!("{name}s are finite and not negative"),
            )),
        }
    }

    fn fraction(&self, value: f32, name: &str) -> Result<f32> {
        match (0.0..=1.0).contains(&value) {
            true => Ok(value),
            false => Err(self.invalid(format!("{name} is {value}"), "it is between 0 and 1")),
        }
    }

    /// The emission: factor times strength.
    fn emissive(&self, material: &material::Material) -> Result<[f32; 3]> {
        let extension = material.extensions.as_ref();
        let strength = extension.and_then(|all| all.emissive_strength.as_ref());
        let strength = strength.map_or(1.0, |strength| strength.emissive_strength.0);
        let emitted = material.emissive_factor.0.map(|c| c * strength);
        self.colour(emitted, "emission")
    }

    fn transmission(&self, material: &material::Material) -> Result<f32> {
        let factor = self.number(material, TRANSMISSION, "transmissionFactor", 0.0);
        self.fraction(factor as f32, "transmissionFactor")
    }

    fn ior(&self, material: &material::Material) -> Result<f32> {
        let ior = self.number(material, "KHR_materials_ior", "ior", 1.5) as f32;
        match (1.0..=MOST_INDEX).contains(&ior) {
            true => Ok(ior),
            false => Err(self.invalid(
                format!("its ior is {ior}"),
                format!("a refractive index is from 1 to {MOST_INDEX}"),
            )),
        }
    }

    /// A number from an extension of a material.
    fn number(
        &self,
        material: &material::Material,
        extension: &str,
        key: &str,
        default: f64,
    ) -> f64 {
        let said = self::extension(material, extension, key);
        said.map_or(default, |value| value.as_f64().unwrap_or(f64::NAN))
    }

    fn texture_place(&self, info: &Info) -> String {
        format!("{}, texture {}", self.place, info.index.value())
    }

    /// The image of a texture, by its index in the document; `None` if it has none that can be read, and such textures are dropped.
    fn image(&mut self, info: &Info, place: &str) -> Result<Option<usize>> {
        let document = self.document;
        let texture = document.get(info.index, "texture", place)?;
        // The parser uses this number for a texture without `source`.
        if texture.source.value() == u32::MAX as usize {
            let what = "it has no image, or one that only an extension knows (KTX2, WebP, …)";
            if self.bad_textures == BadTextures::Drop {
                self.warnings.add(images::left_out(what), place);
                return Ok(None);
            }
            let extensions = texture.extensions.as_ref();
            let uses_ktx =
                extensions.is_some_and(|all| all.others.contains_key("KHR_texture_basisu"));
            return Err(document.unsupported(place, what, images::remedy(uses_ktx)));
        }
        document.get(texture.source, "image", place)?;
        Ok(Some(texture.source.value()))
    }

    /// A texture; `None` if it has no image that can be read, and such textures are dropped.
    fn texture(&mut self, info: &Info) -> Result<Option<TextureRef>> {
        let place = self.texture_place(info);
        let Some(image) = self.image(info, &place)? else {
            return Ok(None);
        };
        let document = self.document;
        let texture = document.get(info.index, "texture", &place)?;
        // Without a sampler both axes repeat (glTF 2.0 §3.8.4.5).
        let (wrap, mag_filter) = match texture.sampler {
            Some(sampler) => {
                let sampler = document.get(sampler, "sampler", &place)?;
                let wrap = [&sampler.wrap_s, &sampler.wrap_t].map(wrap);
                (wrap, sampler.mag_filter.as_ref())
            }
            None => ([Some(Wrap::Repeat); 2], None),
        };
        let [Some(wrap_u), Some(wrap_v)] = wrap else {
            let help = "wrapS and wrapT must be 10497, 33071 or 33648";
            return Err(document.invalid(
                place,
                "its sampler's wrapping is not valid in glTF",
                help,
            ));
        };
        // Without a filter the choice is free (ibid.).
        let filter = match mag_filter {
            Some(Checked::Valid(MagFilter::Nearest)) => TextureFilter::Nearest,
            Some(Checked::Valid(MagFilter::Linear)) | None => TextureFilter::Linear,
            Some(Checked::Invalid) => {
                let help = "magFilter must be 9728 or 9729";
                return Err(document.invalid(
                    place,
                    "its sampler's filter is not valid in glTF",
                    help,
                ));
            }
        };
        // The extension may name another set than the texture, so the limit applies to that one.
        let (set, transform) = transform(document, info, &place)?;
        if set >= MOST_SETS {
            let what = format!("it uses TEXCOORD_{set}");
            let help = "at most 16 texture coordinate sets are read, TEXCOORD_0 to TEXCOORD_15";
            return Err(document.unsupported(place, what, help));
        }
        Ok(Some(TextureRef {
            image,
            uv_set: self.set(set as usize, transform),
            sampler: TextureSampler {
                wrap: [wrap_u, wrap_v],
                filter,
            },
        }))
    }

    /// The number of a set with this transform applied.
    fn set(&mut self, set: usize, transform: Option<UvTransform>) -> usize {
        let Some(transform) = transform else {
            return set;
        };
        let changed = (set, transform);
        let known = self.transforms.iter().position(|known| *known == changed);
        FIRST_TRANSFORMED
            + known.unwrap_or_else(|| {
                self.transforms.push(changed);
                self.transforms.len() - 1
            })
    }

    fn invalid(&self, what: impl Into<String>, help: impl Into<String>) -> crate::Error {
        self.document.invalid(&self.place, what, help)
    }
}

/// What an extension of a material says under a key.
fn extension<'m>(
    material: &'m material::Material,
    extension: &str,
    key: &str,
) -> Option<&'m ::gltf::json::Value> {
    let all = material.extensions.as_ref()?;
    all.others.get(extension)?.get(key)
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
    // The identity needs no set of its own: vertices keep their coordinates bit for bit.
    let identity = rotation == 0.0 && offset == [0.0; 2] && scale == [1.0; 2];
    Ok((set, (!identity).then_some(transform)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The extension's own example: offset (0, 1), a quarter turn and scale ½ show the lower left quarter of the image, which is u in [0,
    /// ½] and v in [½, 1].
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
