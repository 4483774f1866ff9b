//! A study as text: a table to read, and one for spreadsheets.

use std::fmt::Write;

use super::entry::{Entry, Study, Timing, Verdict};
use super::errors::RadianceError;

/// A column of [`csv`]: its name, and its entries.
type Column = (&'static str, fn(&Entry) -> String);

/// The columns of [`csv`].
const COLUMNS: [Column; 23] = [
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
    ("once_seconds", |e| number(e.once_seconds)),
    ("total_seconds", total),
    ("once_bytes", |e| e.once_bytes.to_string()),
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

/// All entries as comma-separated values, with a header line; unknown values are empty.
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

fn total(entry: &Entry) -> String {
    let timing = entry.timing.as_ref();
    timing.map_or(String::new(), |t| number(t.median + entry.once_seconds))
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
        "{:<38} {:>7} {:>4} {:>10} {:>9} {:>9} {:>9} {:>7} {:>7} {:>10} {:>10} {:>6} {:>9}\n",
        "method",
        "samples",
        "runs",
        "ms",
        "± %",
        "first ms",
        "once ms",
        "once MB",
        "MB",
        "px, 99 %",
        "px, max",
        "wrong",
        "relRMSE"
    );
    for entry in &study.entries {
        let _ = writeln!(text, "{}", row(entry));
    }
    text.push_str("first: until the first tile is done, in ms; once: trees for tracing, distinct vertices for rasterizers; MB: the film, and vertices and triangles, or texels\n");
    text.push_str("* no other method is both faster and more accurate (px, max; relRMSE)\n");
    for left_out in &study.left_out {
        let _ = writeln!(text, "{} was left out: {}", left_out.method, left_out.why);
    }
    for verdict in &study.verdicts {
        let _ = writeln!(text, "{}", sentence(verdict, study));
    }
    text
}

/// One line of the table, in the units of the header.
fn row(entry: &Entry) -> String {
    let (runs, time, spread, first) = match &entry.timing {
        None => (0, "no time".into(), String::new(), String::new()),
        Some(t) => {
            // Half of the distance between quartiles, in percent of the median.
            let spread = 50.0 * (t.quartiles[1] - t.quartiles[0]) / t.median;
            (
                t.runs.len(),
                format!("{:.2}", 1e3 * t.median),
                format!("{spread:.0}"),
                format!("{:.2}", 1e3 * t.setup),
            )
        }
    };
    let megabytes = |bytes: u64| format!("{:.2}", bytes as f64 / 1e6);
    let memory = entry.memory.map_or(String::new(), megabytes);
    let mark = |on: bool| if on { "*" } else { "" };
    let rel = entry
        .radiance
        .map_or(String::new(), |r| format!("{:.2e}", r.relrmse));
    format!(
        "{:<38} {:>7} {runs:>4} {time:>10} {spread:>9} {first:>9} {:>9} {:>7} {memory:>7} {:>10} {:>10} {:>6} {:>9}",
        entry.method,
        entry.samples,
        format!("{:.2}", 1e3 * entry.once_seconds),
        megabytes(entry.once_bytes),
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
fn sentence(verdict: &Verdict, study: &Study) -> String {
    let Verdict {
        pixels, samples, ..
    } = verdict;
    let case = format!(
        "at most {pixels} px everywhere, samples {samples}, threads {}",
        study.threads
    );
    // Methods that are accurate enough, but of which there is no run.
    let is_untimed = |entry: &Entry| {
        entry.samples == *samples && entry.geometry.pixels.max <= *pixels && entry.timing.is_none()
    };
    let is_cut = study.entries.iter().any(is_untimed);
    let is_timed = verdict.trace.is_some()
        || verdict.trace_fast.is_some()
        || verdict.raster.is_some()
        || verdict.warp.is_some();
    let fastest = match (&verdict.fastest, is_timed, is_cut) {
        (_, false, true) => return format!("{case}: not measured: the budget ended first"),
        (_, false, false) => return format!("{case}: none of the methods is that accurate"),
        (Some(method), _, false) => format!("{method} is fastest"),
        (Some(method), _, true) => {
            format!("{method} is fastest of those measured before the budget ended")
        }
        (None, ..) if verdict.runs == 1 => {
            "one run has no spread, and names no fastest method".into()
        }
        (None, ..) => "no method is significantly fastest".into(),
    };
    let ms = |time: f64| format!("{:.2} ms", 1e3 * time);
    let trace = verdict.trace.map_or("not measured".into(), ms);
    let raster = match (&verdict.raster, verdict.raster_over_trace) {
        (Some((raster, time)), Some([ratio, low, high])) => match verdict.runs {
            1 => format!("{raster} {}, {ratio:.2} times that in one run", ms(*time)),
            runs => format!(
                "{raster} {}; run by run, {ratio:.2} times the ray tracer's time (median of {runs} runs; quartiles {low:.2} to {high:.2})",
                ms(*time)
            ),
        },
        (Some((raster, time)), None) => format!("{raster} {}", ms(*time)),
        _ => "none of the measured rasterizers".into(),
    };
    let fast = match verdict.trace_fast {
        Some(time) => format!(" (trace:fast {})", ms(time)),
        None => String::new(),
    };
    let warp = match &verdict.warp {
        Some((warp, time)) => format!("; {warp} {}", ms(*time)),
        None => String::new(),
    };
    format!("{case}: {fastest}: ray tracer {trace}{fast}; {raster}{warp}")
}
