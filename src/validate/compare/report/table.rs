//! The table for a terminal.

use std::fmt::Write;

use crate::render::aov::group;
use crate::validate::compare::comparison::Comparison;
use crate::validate::compare::errors::Errors;
use crate::validate::compare::matching::Uncompared;
use crate::validate::compare::metrics::{METRICS, number};
use crate::validate::compare::picture::Encoding;

/// The comparison as lines of text.
pub fn table(comparison: &Comparison) -> String {
    let [w, h] = comparison.size;
    let unit = match comparison.encoding {
        Encoding::Linear => "linear light",
        Encoding::Srgb => "sRGB codes in [0, 1]",
    };
    let mut text = format!("{} of {w} × {h} pixels, {unit}\n", comparison.pixels);
    errors(&mut text, comparison);
    if let Some(flip) = &comparison.flip {
        let kind = match flip.exposures {
            Some([a, b]) => format!(
                "HDR, {} exposure{} from {a:+.2} to {b:+.2} stops{}",
                flip.steps,
                if flip.steps == 1 { "" } else { "s" },
                match flip.stops_apart() {
                    Some(apart) => format!(", {apart:.1} apart"),
                    None => String::new(),
                }
            ),
            None => "as displayed".into(),
        };
        let [mean, max] = [flip.mean, flip.max].map(number);
        let ppd = flip.pixels_per_degree;
        let _ = writeln!(
            text,
            "\nFLIP  mean {mean}  max {max}  ({kind}; {ppd:.1} pixels per degree)"
        );
    }
    let lines = lines(comparison);
    if !lines.is_empty() {
        text.push_str("\nsurfaces\n");
    }
    for (name, value) in lines {
        let _ = writeln!(text, "  {name:<24}{value}");
    }
    for diagnosis in &comparison.diagnoses {
        let _ = writeln!(text, "\ndiagnosis: {}", diagnosis.what);
        for (name, value) in &diagnosis.evidence {
            let _ = writeln!(text, "  {name}: {}", number(*value));
        }
    }
    for note in notes(comparison) {
        let _ = writeln!(text, "\nnote: {note}");
    }
    text
}

/// The notes for the reader, starting with channels that were not compared.
pub(super) fn notes(comparison: &Comparison) -> Vec<String> {
    let Uncompared {
        only_reference,
        only_candidate,
    } = &comparison.uncompared;
    let sides = [("candidate", only_reference), ("reference", only_candidate)];
    let lacking = sides.iter().filter(|(_, names)| !names.is_empty());
    lacking
        .map(|(who, names)| format!("not compared, as the {who} lacks it: {}", names.join(", ")))
        .chain(comparison.notes.iter().map(|note| note.to_string()))
        .collect()
}

/// Names of channels, "radiance" for the light as a whole, and their errors: by group, colours in the order R, G, B, and passes of indices last.
pub(super) fn rows(comparison: &Comparison) -> Vec<(&str, Option<&Errors>)> {
    let light = comparison.radiance.iter().map(|e| ("radiance", Some(e)));
    let channels = comparison.channels.iter();
    let mut rows: Vec<_> = light
        .chain(channels.map(|c| (c.name.as_str(), c.errors.as_ref())))
        .collect();
    let mut groups: Vec<&str> = Vec::new();
    for (name, _) in &rows {
        if !groups.contains(&group(name)) {
            groups.push(group(name));
        }
    }
    // Stable: other channels of a group stay in the order of the file.
    rows.sort_by_key(|(name, _)| {
        let colour = match name.strip_prefix(group(name)) {
            Some("") => 0,
            Some(".R") => 1,
            Some(".G") => 2,
            Some(".B") => 3,
            _ => 4,
        };
        let place = groups.iter().position(|known| *known == group(name));
        (group(name).starts_with("Index"), place, colour)
    });
    rows
}

/// The results for surfaces: labels and text.
pub(super) fn lines(comparison: &Comparison) -> Vec<(&'static str, String)> {
    METRICS.iter().flat_map(|m| m.lines(comparison)).collect()
}

fn errors(text: &mut String, comparison: &Comparison) {
    let rows = rows(comparison);
    let Some((_, first)) = rows.first() else {
        return;
    };
    let names = rows.iter().map(|(name, _)| name.chars().count());
    let width = names.max().unwrap_or(0);
    let _ = write!(text, "\n{:width$}", "");
    for (heading, _) in METRICS.iter().filter_map(|m| m.cell(*first)) {
        let _ = write!(text, " {heading:>10}");
    }
    text.push('\n');
    for (name, errors) in rows {
        let _ = write!(text, "{name:width$}");
        for (_, value) in METRICS.iter().filter_map(|m| m.cell(errors)) {
            let _ = write!(text, " {value:>10}");
        }
        text.push('\n');
    }
}
