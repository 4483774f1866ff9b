//! expected | difference | actual.

use super::legend::ErrorMap;
use crate::error::Result;
use crate::figures::contact_sheet::{self, Panel};
use crate::io::image::RgbImage;
use crate::render::tonemap::tonemap;
use crate::scene::model::Exposure;
use crate::validate::compare::{Encoding, Picture};

/// The percentile of the reference's light that is white where neither picture says what is.
const WHITE: f64 = 99.0;

/// The reference, the map of errors and the candidate side by side, with labels. Both pictures have the same white.
///
/// # Errors
/// Pictures that are too large to be drawn.
pub fn strip(reference: &Picture, map: &ErrorMap, candidate: &Picture) -> Result<RgbImage> {
    let [expected, actual] = displays(reference, candidate)?;
    let panel = |picture, label: &str| Panel {
        picture,
        label: label.into(),
    };
    let difference = format!("{}, 0 to {}", map.title, super::number(map.most));
    let panels = [
        panel(expected, "expected"),
        panel(map.image(), &difference),
        panel(actual, "actual"),
    ];
    contact_sheet::compose(
        &panels,
        &contact_sheet::Options {
            title: None,
            columns: Some(3),
        },
    )
}

/// Both pictures for a display.
pub(super) fn displays(reference: &Picture, candidate: &Picture) -> Result<[RgbImage; 2]> {
    let light = [reference, candidate].map(light);
    let white = match reference.encoding {
        Encoding::Linear => tonemap(&light[0], Exposure::Percentile(WHITE))?.white,
        Encoding::Srgb => 1.0,
    };
    let show = |picture: &Picture, light: &[[f64; 3]]| {
        Ok(RgbImage {
            width: picture.layers.width,
            height: picture.layers.height,
            rgb: match picture.encoding {
                Encoding::Linear => tonemap(light, Exposure::White(white))?.rgb,
                Encoding::Srgb => light
                    .iter()
                    .flatten()
                    .map(|code| (255.0 * code + 0.5) as u8)
                    .collect(),
            },
        })
    };
    Ok([show(reference, &light[0])?, show(candidate, &light[1])?])
}

/// The light; a first channel in grey where there is none.
fn light(picture: &Picture) -> Vec<[f64; 3]> {
    picture.layers.radiance().unwrap_or_else(|| {
        let first = picture.layers.channels.first().map(|c| c.samples.to_f64());
        first
            .unwrap_or_default()
            .into_iter()
            .map(|v| [v; 3])
            .collect()
    })
}
