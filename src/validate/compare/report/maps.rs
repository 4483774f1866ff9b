//! Maps as channels: differences, ꟻLIP, geometric error.

use crate::error::Result;
use crate::io::image::{Channel, Layers, Samples};
use crate::validate::compare::{Comparison, Picture};

/// `difference.NAME`, candidate − reference, for every channel that was compared; `flip` and `geometric_error` where
/// their maps were kept. In single precision.
///
/// # Errors
/// Pictures that were not those of the comparison.
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
