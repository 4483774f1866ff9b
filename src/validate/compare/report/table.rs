//! The table on a terminal.

use std::fmt::Write;

use super::number;
use crate::validate::compare::surface::{Distribution, Signed};
use crate::validate::compare::{Comparison, Encoding, Errors};

/// The comparison as lines of text.
pub fn table(comparison: &Comparison) -> String {
    let mut text = String::new();
    let [w, h] = comparison.size;
    let unit = match comparison.encoding {
        Encoding::Linear => "linear light",
        Encoding::Srgb => "sRGB codes in [0, 1]",
    };
    line(
        &mut text,
        &format!("{} of {w} × {h} pixels, {unit}", comparison.pixels),
    );
    errors(&mut text, comparison);
    if let Some(flip) = &comparison.flip {
        let kind = match flip.exposures {
            Some([a, b]) => format!(
                "HDR, {} exposures from {a:+.2} to {b:+.2} stops",
                flip.steps
            ),
            None => "as displayed".into(),
        };
        line(
            &mut text,
            &format!(
                "\nFLIP  mean {}  max {}  ({kind}; {:.1} pixels per degree)",
                number(flip.mean),
                number(flip.max),
                flip.pixels_per_degree
            ),
        );
    }
    surfaces(&mut text, comparison);
    for diagnosis in &comparison.diagnoses {
        line(&mut text, &format!("\ndiagnosis: {}", diagnosis.what));
        for (name, value) in &diagnosis.evidence {
            line(&mut text, &format!("  {name}: {}", number(*value)));
        }
    }
    for note in &comparison.notes {
        line(&mut text, &format!("\nnote: {note}"));
    }
    text
}

fn line(text: &mut String, line: &str) {
    text.push_str(line);
    text.push('\n');
}

/// Names of the columns of errors, and their values.
pub(super) fn columns(e: &Errors) -> [(&'static str, String); 11] {
    let optional = |x: Option<f64>| x.map_or("—".into(), number);
    [
        ("bias", number(e.bias)),
        ("MAE", number(e.mae)),
        ("RMSE", number(e.rmse)),
        ("relRMSE", optional(e.relrmse)),
        ("MRSE", number(e.mrse)),
        ("max", number(e.max)),
        ("p50", number(e.p50)),
        ("p99", number(e.p99)),
        ("p99.9", number(e.p99_9)),
        ("PSNR/dB", e.psnr.map_or("∞".into(), number)),
        ("SSIM", optional(e.ssim)),
    ]
}

/// Names of channels, "radiance" for all of the light, and their errors.
pub(super) fn rows(comparison: &Comparison) -> Vec<(&str, &Errors)> {
    let light = comparison
        .radiance
        .iter()
        .map(|errors| ("radiance", errors));
    let channels = comparison
        .channels
        .iter()
        .map(|c| (c.name.as_str(), &c.errors));
    light.chain(channels).collect()
}

fn errors(text: &mut String, comparison: &Comparison) {
    let rows = rows(comparison);
    let Some((_, first)) = rows.first() else {
        return;
    };
    let width = rows
        .iter()
        .map(|(name, _)| name.chars().count())
        .max()
        .unwrap_or(0);
    let mut head = format!("\n{:width$}", "");
    for (name, _) in columns(first) {
        let _ = write!(head, " {name:>10}");
    }
    line(text, &head);
    for (name, errors) in rows {
        let mut row = format!("{name:width$}");
        for (_, value) in columns(errors) {
            let _ = write!(row, " {value:>10}");
        }
        line(text, &row);
    }
}

fn surfaces(text: &mut String, comparison: &Comparison) {
    let rows = surface_rows(comparison);
    if !rows.is_empty() {
        line(text, "\nsurfaces");
    }
    for (name, value) in rows {
        line(text, &format!("  {name:<24}{value}"));
    }
}

/// Errors of surfaces, in words.
pub(super) fn surface_rows(comparison: &Comparison) -> Vec<(&'static str, String)> {
    let Some(surface) = &comparison.surface else {
        return Vec::new();
    };
    let mut rows = Vec::new();
    if let Some(share) = surface.wrong_object {
        let percent = 100.0 * share.pixels as f64 / share.of.max(1) as f64;
        rows.push((
            "wrong object",
            format!("{} pixels ({} %)", share.pixels, number(percent)),
        ));
    }
    if let Some(silhouette) = surface.silhouette {
        let largest = silhouette.largest.map_or("—".into(), number);
        rows.push((
            "silhouette",
            format!(
                "mean {} px, largest {largest} px, over {} px",
                number(silhouette.mean),
                number(silhouette.length)
            ),
        ));
    }
    let plain = |name, found: &Option<Distribution>, unit: &str, scale: f64| {
        found.as_ref().map(|d| (name, words(d, unit, scale)))
    };
    let signed = |name, found: &Option<Signed>, unit: &str, scale: f64| {
        let found = found.as_ref()?;
        Some((
            name,
            format!(
                "bias {} {unit}, {}",
                number(scale * found.bias),
                words(&found.absolute, unit, scale)
            ),
        ))
    };
    rows.extend(
        [
            plain("geometric error", &surface.geometric, "px", 1.0),
            signed("emission time", &surface.emission_time, "m", 1.0),
            signed(
                "emission time",
                &surface.emission_time,
                "ps",
                1e12 / crate::scene::model::SPEED_OF_LIGHT,
            ),
            plain("emission time", &surface.emission_time_bins, "bins", 1.0),
            signed("wavelength ratio", &surface.wavelength_ratio, "%", 100.0),
            plain(
                "wavelength ratio",
                &surface.wavelength_ratio_ulp,
                "ulp",
                1.0,
            ),
        ]
        .into_iter()
        .flatten(),
    );
    rows
}

fn words(d: &Distribution, unit: &str, scale: f64) -> String {
    let [mean, p50, p99, max] = [d.mean, d.p50, d.p99, d.max].map(|x| number(scale * x));
    let unmeasured = match d.unmeasured {
        0 => String::new(),
        n => format!("; {n} pixels have none"),
    };
    format!("mean {mean}, p50 {p50}, p99 {p99}, max {max} {unit}{unmeasured}")
}
