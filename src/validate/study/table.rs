//! A study as text: a table to read, and one for spreadsheets.

use std::fmt::Write;

use super::entry::{Entry, Study, Verdict};

/// The columns of [`csv`].
const COLUMNS: &str = "method,family,samples,runs,seconds,seconds_q1,seconds_q3,setup_seconds,memory_bytes,\
                       geometric_median_px,geometric_p99_px,geometric_max_px,emission_p99_m,emission_max_m,\
                       wrong_object_pixels,relrmse,mrse,flip,front_geometry,front_radiance";

/// All entries as comma-separated values, a line of names first; what is not known is empty.
pub fn csv(study: &Study) -> String {
    let mut text = format!("{COLUMNS}\n");
    for entry in &study.entries {
        let timing = entry.timing.as_ref();
        let geometry = &entry.geometry;
        let fields = [
            format!("\"{}\"", entry.method),
            entry.family.name().replace(',', ""),
            entry.samples.to_string(),
            timing.map_or(0, |t| t.runs.len()).to_string(),
            number(timing.map(|t| t.median)),
            number(timing.map(|t| t.quartiles[0])),
            number(timing.map(|t| t.quartiles[1])),
            number(timing.map(|t| t.setup)),
            entry
                .memory
                .map_or(String::new(), |bytes| bytes.to_string()),
            number(Some(geometry.pixels.median)),
            number(Some(geometry.pixels.p99)),
            number(Some(geometry.pixels.max)),
            number(Some(geometry.emission_time.p99)),
            number(Some(geometry.emission_time.max)),
            geometry.wrong_object.to_string(),
            number(entry.radiance.map(|r| r.relrmse)),
            number(entry.radiance.map(|r| r.mrse)),
            number(entry.radiance.map(|r| r.flip)),
            entry.front.geometry.to_string(),
            entry.front.radiance.to_string(),
        ];
        text.push_str(&fields.join(","));
        text.push('\n');
    }
    text
}

fn number(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| format!("{value:.5e}"))
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
