//! A study as text: a table to read, and one for spreadsheets.

use std::fmt::Write;

use super::entry::{Entry, Study, Timing, Verdict};
use super::errors::RadianceError;

/// A column of [`csv`]: its name, and what stands in it.
type Column = (&'static str, fn(&Entry) -> String);

/// The columns of [`csv`].
const COLUMNS: [Column; 20] = [
    ("method", |e| format!("\"{}\"", e.method)),
    ("family", |e| e.family.name().replace(',', "")),
    ("samples", |e| e.samples.to_string()),
    ("runs", |e| {
        e.timing.as_ref().map_or(0, |t| t.runs.len()).to_string()
    }),
    ("seconds", |e| of_timing(e, |t| t.median)),
    ("seconds_q1", |e| of_timing(e, |t| t.quartiles[0])),
    ("seconds_q3", |e| of_timing(e, |t| t.quartiles[1])),
    ("setup_seconds", |e| of_timing(e, |t| t.setup)),
    ("memory_bytes", |e| {
        e.memory.map_or(String::new(), |bytes| bytes.to_string())
    }),
    ("geometric_median_px", |e| number(e.geometry.pixels.median)),
    ("geometric_p99_px", |e| number(e.geometry.pixels.p99)),
    ("geometric_max_px", |e| number(e.geometry.pixels.max)),
    ("emission_p99_m", |e| number(e.geometry.emission_time.p99)),
    ("emission_max_m", |e| number(e.geometry.emission_time.max)),
    ("wrong_object_pixels", |e| {
        e.geometry.wrong_object.to_string()
    }),
    ("relrmse", |e| of_radiance(e, |r| r.relrmse)),
    ("mrse", |e| of_radiance(e, |r| r.mrse)),
    ("flip", |e| of_radiance(e, |r| r.flip)),
    ("front_geometry", |e| e.front.geometry.to_string()),
    ("front_radiance", |e| e.front.radiance.to_string()),
];

/// All entries as comma-separated values, a line of names first; what is not known is empty.
pub fn csv(study: &Study) -> String {
    let mut text = COLUMNS.map(|(name, _)| name).join(",") + "\n";
    for entry in &study.entries {
        text.push_str(&COLUMNS.map(|(_, value)| value(entry)).join(","));
        text.push('\n');
    }
    text
}

fn of_timing(entry: &Entry, value: fn(&Timing) -> f64) -> String {
    let timing = entry.timing.as_ref();
    timing.map_or(String::new(), |timing| number(value(timing)))
}

fn of_radiance(entry: &Entry, value: fn(&RadianceError) -> f64) -> String {
    let radiance = entry.radiance.as_ref();
    radiance.map_or(String::new(), |radiance| number(value(radiance)))
}

fn number(value: f64) -> String {
    format!("{value:.5e}")
}

/// All entries and verdicts, to read.
pub fn table(study: &Study) -> String {
    let mut text = format!(
        "{:<38} {:>7} {:>4} {:>10} {:>9} {:>10} {:>10} {:>6} {:>9}\n",
        "method", "samples", "runs", "ms", "± %", "px, 99 %", "px, max", "wrong", "relRMSE"
    );
    for entry in &study.entries {
        let _ = writeln!(text, "{}", row(entry));
    }
    text.push_str("* nothing else is both faster and nearer to the truth (px, max; relRMSE)\n");
    for left_out in &study.left_out {
        let _ = writeln!(text, "{} was left out: {}", left_out.method, left_out.why);
    }
    for verdict in &study.verdicts {
        let _ = writeln!(text, "{}", sentence(verdict));
    }
    text
}

fn row(entry: &Entry) -> String {
    let (runs, time, spread) = match &entry.timing {
        None => (0, "no time".into(), String::new()),
        Some(t) => {
            let spread = 50.0 * (t.quartiles[1] - t.quartiles[0]) / t.median;
            (
                t.runs.len(),
                format!("{:.2}", 1e3 * t.median),
                format!("{spread:.0}"),
            )
        }
    };
    let mark = |on: bool| if on { "*" } else { "" };
    let rel = entry
        .radiance
        .map_or(String::new(), |r| format!("{:.2e}", r.relrmse));
    format!(
        "{:<38} {:>7} {runs:>4} {time:>10} {spread:>9} {:>10} {:>10} {:>6} {:>9}",
        entry.method,
        entry.samples,
        format!("{:.2e}", entry.geometry.pixels.p99),
        format!(
            "{:.2e}{}",
            entry.geometry.pixels.max,
            mark(entry.front.geometry)
        ),
        entry.geometry.wrong_object,
        format!("{rel}{}", mark(entry.front.radiance)),
    )
}

/// A verdict in words.
fn sentence(verdict: &Verdict) -> String {
    let pixels = verdict.pixels;
    let warp = match &verdict.warp {
        Some((warp, time)) => format!("; {warp} {:.2} ms", 1e3 * time),
        None => String::new(),
    };
    let Some(trace) = verdict.trace else {
        return format!("at most {pixels} px everywhere: the ray tracer was not measured{warp}");
    };
    let raster = match (&verdict.raster, verdict.raster_over_trace) {
        (Some((raster, time)), Some([ratio, least, most])) => format!(
            "{raster} {:.2} ms, {ratio:.2} times that ({least:.2} to {most:.2})",
            1e3 * time
        ),
        _ => "no rasterizer that was measured".into(),
    };
    format!(
        "at most {pixels} px everywhere: ray tracer {:.2} ms; {raster}{warp}",
        1e3 * trace
    )
}
