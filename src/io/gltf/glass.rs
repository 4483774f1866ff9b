//! Glass by textures (KHR_materials_transmission, KHR_materials_volume).
//!
//! The transmitted part of light is transmissionFactor times the red of transmissionTexture. Here a surface is glass as a whole or not at
//! all: a texture that is the same all over is a factor; of another one, the mean decides whether all of the surface has transmissionFactor
//! or is opaque, with a warning. The thickness counts as above 0 wherever thicknessFactor is.

use super::buffers::Buffers;
use super::draft::Draft;
use super::images;
use super::import::BadTextures;
use super::materials::Resolved;
use crate::error::{Error, Result};
use crate::io::image::Texture;

/// Values of a texture that differ by less are the same: noise of compression.
const EVEN: f64 = 0.03;
/// Most of a texture is glass if its mean is at least this.
const MOSTLY: f64 = 0.5;

/// Reads the textures that decide whether materials are glass, and warns about what is not computed of glass.
pub(super) fn settle(
    draft: &mut Draft,
    buffers: &mut Buffers,
    bad_textures: BadTextures,
) -> Result<()> {
    let warnings = &mut draft.warnings;
    for resolved in draft.materials.values_mut() {
        if let Some(image) = resolved.glass.texture
            && resolved.material.transmission > 0.0
        {
            let place = &resolved.glass.place;
            match Spread::of_image(buffers, image) {
                Ok(spread) => {
                    resolved.material.transmission *= spread.factor();
                    if !spread.is_even() {
                        warnings.add(spread.warning(), place);
                    }
                }
                Err(Error::Invalid(bad) | Error::Unsupported(bad))
                    if bad_textures == BadTextures::Drop =>
                {
                    warnings.add(images::left_out(&bad.what), &bad.place);
                }
                Err(error) => return Err(error),
            }
        }
        let Resolved {
            material, glass, ..
        } = resolved;
        if material.transmission > 0.0 {
            for what in &glass.uncomputed {
                warnings.add(*what, &glass.place);
            }
        }
    }
    Ok(())
}

/// The range and the mean of the red of a texture, from 0 to 1.
struct Spread {
    least: f64,
    most: f64,
    mean: f64,
}

impl Spread {
    fn of_image(buffers: &mut Buffers, image: usize) -> Result<Spread> {
        let encoded = images::read(buffers, image, images::MOST_BYTES)?;
        let file = &buffers.document.file;
        let texture = Texture::decode(&encoded.bytes, &encoded.place, file)?;
        let [width, height] = texture.size();
        let (mut least, mut most, mut sum) = (1.0_f64, 0.0_f64, 0.0);
        for red in texture.reds() {
            (least, most, sum) = (least.min(red), most.max(red), sum + red);
        }
        Ok(Spread {
            least,
            most,
            mean: sum / (width * height) as f64,
        })
    }

    fn is_even(&self) -> bool {
        self.most - self.least < EVEN
    }

    /// The factor on the transmission of all of the surface.
    fn factor(&self) -> f32 {
        match self.is_even() {
            true => self.mean as f32,
            false => f32::from(self.mean >= MOSTLY),
        }
    }

    fn warning(&self) -> &'static str {
        match self.mean >= MOSTLY {
            true => {
                "its transmissionTexture makes only parts of it glass, which is not supported: all of it is glass, like most of the texture"
            }
            false => {
                "its transmissionTexture makes parts of it glass, which is not supported: all of it is opaque, like most of the texture"
            }
        }
    }
}
