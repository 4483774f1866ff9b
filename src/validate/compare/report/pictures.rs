//! Errors as pictures: channels of differences, a map in false colours with a legend, expected | difference | actual.

use crate::error::Result;
use crate::figures::contact_sheet::{self, Panel};
use crate::figures::drawing::{Anchor, AnchorX, AnchorY, Colour, Drawing, Item, Text};
use crate::figures::isochrones::viridis::viridis_srgb;
use crate::figures::ticks::{number, round_step};
use crate::io::image::{Channel, Layers, RgbImage, Samples};
use crate::render::tonemap::tonemap;
use crate::scene::model::Exposure;
use crate::text::{Rect, RichText};
use crate::validate::compare::comparison::Comparison;
use crate::validate::compare::metrics;
use crate::validate::compare::picture::{Encoding, Picture};

/// The colour of pixels without an error: pale grey.
const NOTHING: [u8; 3] = [232; 3];
/// Small maps are enlarged to about this size, and large ones reduced, pixels.
const COMFORTABLE: u32 = 400;
/// The most steps of a legend.
const STEPS: f64 = 8.0;

/// Errors of a picture.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ErrorMap {
    /// The quantity, with its unit.
    pub title: String,
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// An error of at least 0 for each pixel, NaN if it has none.
    pub errors: Vec<f32>,
    /// The value of the brightest colour.
    pub most: f64,
}

/// The most informative map: ꟻLIP if it was kept, else the geometric error, else the difference of the first channel.
pub fn error_map(comparison: &Comparison, reference: &Picture, candidate: &Picture) -> ErrorMap {
    let flip = comparison.flip.as_ref().and_then(|flip| flip.map.clone());
    match (flip, &comparison.geometric_map) {
        (Some(map), _) => ErrorMap::new("FLIP error", comparison, map),
        (None, Some(map)) => ErrorMap::new("geometric error (pixels)", comparison, map.clone()),
        (None, None) => {
            let Some(channel) = comparison.channels.first() else {
                // Differences of indices are meaningless.
                let [w, h] = comparison.size.map(|n| n as usize);
                return ErrorMap::new("no errors to show", comparison, vec![f32::NAN; w * h]);
            };
            let name = &channel.name;
            let [r, c] = [reference, candidate].map(|p| {
                p.layers
                    .channel(name)
                    .map(|c| c.samples.to_f64())
                    .unwrap_or_default()
            });
            let errors = r.iter().zip(&c).map(|(r, c)| (c - r).abs() as f32);
            ErrorMap::new(&format!("error of {name}"), comparison, errors.collect())
        }
    }
}

impl ErrorMap {
    /// A map whose brightest colour is a round number close to the 99.9th percentile.
    pub fn new(title: &str, comparison: &Comparison, errors: Vec<f32>) -> ErrorMap {
        let mut finite: Vec<f32> = errors.iter().copied().filter(|e| e.is_finite()).collect();
        let rank = (finite.len() as f64 * 0.999) as usize;
        let rank = rank.min(finite.len().saturating_sub(1));
        let high = match finite.is_empty() {
            true => 0.0,
            false => f64::from(*finite.select_nth_unstable_by(rank, f32::total_cmp).1),
        };
        // Works for maps without errors, too.
        let step = round_step((high / STEPS).max(1e-12));
        let [width, height] = comparison.size;
        ErrorMap {
            title: title.into(),
            width,
            height,
            errors,
            most: step * (high / step).ceil().max(1.0),
        }
    }

    /// In false colours, pixel by pixel.
    pub fn image(&self) -> RgbImage {
        let colour = |e: &f32| match e.is_finite() {
            true => viridis_srgb(f64::from(*e) / self.most),
            false => NOTHING,
        };
        RgbImage {
            width: self.width,
            height: self.height,
            rgb: self.errors.iter().flat_map(colour).collect(),
        }
    }

    /// A page with the map and its legend; one point is a pixel of the map or, if that is small, of its enlargement.
    ///
    /// # Errors
    /// A map that is too large to draw.
    pub fn page(&self) -> Result<Drawing> {
        let scale = f64::from((COMFORTABLE / self.width.max(self.height)).max(1));
        let [w, h] = [self.width, self.height].map(|n| f64::from(n) * scale);
        let em = (0.035 * h).clamp(14.0, 60.0);
        let margin = em;
        let top = margin + 1.8 * em;
        let bar_height = h.max(10.0 * em);
        let [left, right] = [margin + w + 1.2 * em, margin + w + 2.4 * em];
        let mut items = vec![
            text(
                &self.title,
                [margin, margin + em],
                1.15 * em,
                AnchorY::Baseline,
            )?,
            Item::Image {
                image: self.image(),
                rect: Rect {
                    min: [margin, top],
                    max: [margin + w, top + h],
                },
            },
            Item::Image {
                image: bar(),
                rect: Rect {
                    min: [left, top],
                    max: [right, top + bar_height],
                },
            },
        ];
        // At most one label per two lines of text.
        let step = round_step((self.most / (bar_height / em / 2.0).min(STEPS)).max(1e-13));
        let mut widest: f64 = 0.0;
        // 1e-9, so that rounding does not drop the last label.
        for i in 0..=(self.most / step + 1e-9) as u32 {
            let value = f64::from(i) * step;
            let y = top + bar_height * (1.0 - value / self.most);
            let label = number(value, step);
            widest = widest.max(RichText::plain(&label)?.width(em)?);
            items.push(text(&label, [right + 0.5 * em, y], em, AnchorY::Middle)?);
        }
        let title_width = RichText::plain(&self.title)?.width(1.15 * em)?;
        Ok(Drawing {
            width: (right + 0.5 * em + widest).max(margin + title_width) + margin,
            height: top + bar_height + margin,
            title: self.title.clone(),
            origin: Vec::new(),
            background: Colour::WHITE,
            items,
        })
    }
}

/// The colours from large (top) to small (bottom).
fn bar() -> RgbImage {
    const HEIGHT: u32 = 256;
    let row = |y: u32| viridis_srgb(1.0 - (f64::from(y) + 0.5) / f64::from(HEIGHT));
    RgbImage {
        width: 1,
        height: HEIGHT,
        rgb: (0..HEIGHT).flat_map(row).collect(),
    }
}

/// The colours from small (left) to large (right).
pub(super) fn bar_across() -> RgbImage {
    let bar = bar();
    RgbImage {
        width: bar.height,
        height: bar.width,
        rgb: bar
            .rgb
            .as_chunks::<3>()
            .0
            .iter()
            .rev()
            .flatten()
            .copied()
            .collect(),
    }
}

/// Text that starts at a position.
fn text(words: &str, at: [f64; 2], size: f64, y: AnchorY) -> Result<Item> {
    let x = AnchorX::Start;
    Ok(Item::Text(Text {
        anchor: Anchor { x, y },
        ..Text::new(RichText::plain(words)?, at, size)
    }))
}

/// `difference.NAME`, candidate − reference, for every channel that was compared; `flip` and `geometric_error` if their maps were kept. In
/// single precision.
///
/// # Errors
/// Pictures other than those of the comparison.
pub fn maps(comparison: &Comparison, reference: &Picture, candidate: &Picture) -> Result<Layers> {
    let [width, height] = comparison.size;
    let mut channels: Vec<Channel> = comparison
        .channels
        .iter()
        .filter_map(|compared| difference(&compared.name, reference, candidate))
        .collect();
    let flip = comparison.flip.as_ref().and_then(|flip| flip.map.clone());
    let maps = [
        ("flip", flip),
        ("geometric_error", comparison.geometric_map.clone()),
    ];
    channels.extend(maps.into_iter().filter_map(|(name, map)| {
        let samples = Samples::F32(map?);
        Some(Channel {
            name: name.into(),
            samples,
        })
    }));
    let metadata = [
        ("reference", &reference.name),
        ("candidate", &candidate.name),
    ];
    let metadata = metadata.map(|(key, value)| (key.to_string(), value.replace('\0', "")));
    Layers::new(width, height, channels, metadata.into())
}

fn difference(name: &str, reference: &Picture, candidate: &Picture) -> Option<Channel> {
    let [r, c] = [reference, candidate].map(|p| p.layers.channel(name));
    let [r, c] = [&r?.samples, &c?.samples].map(Samples::to_f64);
    let difference = r.iter().zip(&c).map(|(r, c)| (c - r) as f32);
    Some(Channel {
        name: format!("difference.{name}"),
        samples: Samples::F32(difference.collect()),
    })
}

/// The percentile of the reference's light shown as white if neither picture states its white.
const WHITE: f64 = 99.0;

/// The reference, the map of errors and the candidate side by side, with labels. Both pictures have the same white.
///
/// # Errors
/// Pictures that are too large to draw.
pub fn strip(reference: &Picture, map: &ErrorMap, candidate: &Picture) -> Result<RgbImage> {
    let ([expected, actual], channel) = displays(reference, candidate)?;
    let panel = |picture, label: &str| Panel {
        picture,
        label: label.into(),
        new_row: false,
    };
    let difference = format!("{}, 0 to {}", map.title, metrics::number(map.most));
    let panels = [
        panel(expected, &format!("expected{channel}")),
        panel(map.image(), &difference),
        panel(actual, &format!("actual{channel}")),
    ];
    contact_sheet::compose(
        &panels,
        &contact_sheet::SheetOptions {
            title: None,
            columns: Some(3),
        },
    )
}

/// Both pictures for a display, and what is said of them besides: which channel they show where they do not both have light.
pub(super) fn displays(
    reference: &Picture,
    candidate: &Picture,
) -> Result<([RgbImage; 2], String)> {
    let pair = [reference, candidate];
    let have_light = pair
        .iter()
        .all(|picture| picture.layers.radiance().is_some());
    let common = (!have_light).then(|| common(pair)).flatten();
    let light = pair.map(|picture| light(picture, common));
    let channel = common.map_or_else(String::new, |name| format!(" {name}"));
    let white = match reference.encoding {
        Encoding::Linear => tonemap(&light[0], Exposure::Percentile(WHITE))?.white,
        Encoding::Srgb => 1.0,
    };
    let show = |picture: &Picture, light: &[[f64; 3]]| -> Result<RgbImage> {
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
    let shown = [show(reference, &light[0])?, show(candidate, &light[1])?];
    Ok((shown, channel))
}

/// The first channel of the reference that the candidate has, too.
fn common([reference, candidate]: [&Picture; 2]) -> Option<&str> {
    let names = reference.layers.channels.iter().map(|c| c.name.as_str());
    let mut both = names.filter(|name| candidate.layers.channel(name).is_some());
    both.next()
}

/// The channel of this name in grey; without a name the light, or the first channel, such as that of a grey picture.
fn light(picture: &Picture, name: Option<&str>) -> Vec<[f64; 3]> {
    let layers = &picture.layers;
    let named = name.and_then(|name| layers.channel(name));
    let light = layers.radiance().filter(|_| named.is_none());
    light.unwrap_or_else(|| {
        let shown = named.or(layers.channels.first());
        let values = shown.map_or_else(Vec::new, |channel| channel.samples.to_f64());
        values.into_iter().map(|v| [v; 3]).collect()
    })
}
