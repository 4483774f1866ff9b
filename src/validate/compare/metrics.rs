//! Metrics: one table for tolerances, the help, the printed table and the HTML report.
//!
//! To add a metric, add a field with its evaluator (of [`Errors`], [`SurfaceErrors`] or [`Comparison`]; JSON includes the field) and a row
//! here. A limit holds if the metric is no worse: at most the value, or at least it if larger is better. The bias counts by its absolute
//! value. A metric without a value exceeds every limit.

use serde::Serialize;

use super::comparison::Comparison;
use super::errors::Errors;
use super::matching::Uncompared;
use super::picture::is_light;
use super::surface::{Distribution, SurfaceErrors, Unmeasured};
use crate::error::{Error, Message, Result, Setting};
use crate::render::aov::Aov;
use crate::spacetime::SPEED_OF_LIGHT;

/// A metric, or a family of metrics for values of many pixels (`geometric.mean`, `geometric.p99`): a row of [`METRICS`].
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Metric {
    /// Its name in tolerances.
    pub name: &'static str,
    /// Its unit; empty for the unit of the channel.
    pub unit: &'static str,
    /// Which values are better.
    pub better: Better,
    /// Its heading in tables; `None` if they omit it.
    pub heading: Option<&'static str>,
    /// The largest possible value.
    largest: f64,
    /// The channels that it needs in both pictures.
    needs: &'static str,
    /// An additional requirement, and its setting.
    set: Option<(&'static str, Setting)>,
    of: Of,
}

/// Which values of a metric are better.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Better {
    /// Those nearer to 0.
    Smaller,
    /// The larger ones.
    Larger,
}

/// What a metric measures, and its evaluator.
#[derive(Debug, Clone, Copy)]
enum Of {
    /// The light, and each channel.
    Channel(fn(&Errors) -> Option<f64>),
    /// The whole picture; with the label in tables.
    Picture(
        fn(&Comparison) -> Option<f64>,
        fn(&Comparison) -> Option<String>,
    ),
    /// Pixels that show surfaces; whether values have a sign; further units in tables, with their factors.
    Pixels(
        fn(&SurfaceErrors) -> Option<Values<'_>>,
        bool,
        &'static [(&'static str, f64)],
    ),
}

/// The mean of signed values if they have signs, and the distribution of their absolute values.
type Values<'a> = (Option<f64>, &'a Distribution);

const PS_PER_METRE: f64 = 1e12 / SPEED_OF_LIGHT;

/// The channels that errors of the light need.
const LIGHT: &str = "the light";
/// The channels that geometric errors need.
const PLACES: &str = "the channels object_event.x, .y, .z (or event.x, .y, .z)";
/// The channels that errors of emission times need.
const TIMES: &str = "the channel event.ct (or object_event.ct)";

/// All metrics, in the order in which they are shown.
pub const METRICS: [Metric; 24] = [
    channel("count", "samples", None, |e| Some(e.count as f64)).better_when_large(),
    channel("bias", "", Some("bias"), |e| Some(e.bias)),
    channel("mae", "", Some("MAE"), |e| Some(e.mae)),
    channel("rmse", "", Some("RMSE"), |e| Some(e.rmse)),
    channel("relrmse", "ratio", Some("relRMSE"), |e| e.relrmse),
    channel("mrse", "ratio", Some("MRSE"), |e| Some(e.mrse)),
    channel("max", "", Some("max"), |e| Some(e.max)),
    channel("p50", "", Some("p50"), |e| Some(e.p50)),
    channel("p90", "", None, |e| Some(e.p90)),
    channel("p99", "", Some("p99"), |e| Some(e.p99)),
    channel("p99.9", "", Some("p99.9"), |e| Some(e.p99_9)),
    channel("psnr", "dB", Some("PSNR/dB"), |e| {
        Some(e.psnr.unwrap_or(f64::INFINITY))
    })
    .better_when_large(),
    channel("ssim", "ratio", Some("SSIM"), |e| e.ssim)
        .better_when_large()
        .at_most(1.0),
    picture("flip", "ratio", None, LIGHT, |c| {
        Some(c.flip.as_ref()?.mean)
    }),
    picture("flip.max", "ratio", None, LIGHT, |c| {
        Some(c.flip.as_ref()?.max)
    }),
    picture(
        "wrong_objects",
        "pixels",
        Some("wrong objects"),
        OBJECTS,
        |c| Some(c.surface.as_ref()?.wrong_objects?.pixels as f64),
    )
    .in_words(wrong_objects),
    picture("coverage", "ratio", Some("coverage"), OBJECTS, |c| {
        c.surface.as_ref()?.coverage?.fraction()
    })
    .better_when_large()
    .at_most(1.0)
    .in_words(coverage),
    picture("silhouette", "pixels", Some("silhouette"), OBJECTS, |c| {
        Some(c.surface.as_ref()?.silhouette?.mean)
    })
    .in_words(silhouette),
    picture("silhouette.max", "pixels", None, OBJECTS, |c| {
        c.surface.as_ref()?.silhouette?.largest
    }),
    pixels(
        ["geometric", "pixels", "geometric error", PLACES],
        &[("px", 1.0)],
        |s| Some((None, s.geometric.as_ref()?)),
    ),
    pixels(
        ["time", "m", "emission time", TIMES],
        &[("m", 1.0), ("ps", PS_PER_METRE)],
        |s| {
            let t = s.emission_time.as_ref()?;
            Some((t.bias, &t.absolute))
        },
    )
    .signed(),
    pixels(
        ["time_bins", "bins", "emission time", "the channel event.ct"],
        &[("bins", 1.0)],
        |s| Some((None, s.emission_time_bins.as_ref()?)),
    )
    .set_by("a width of the bins", Setting::BinWidth),
    pixels(
        [
            "w",
            "ratio",
            "wavelength ratio",
            "the channel wavelength_ratio",
        ],
        &[("%", 100.0)],
        |s| {
            let w = s.wavelength_ratio.as_ref()?;
            Some((w.bias, &w.absolute))
        },
    )
    .signed(),
    pixels(
        [
            "w_ulp",
            "ulp",
            "wavelength ratio",
            "the channel wavelength_ratio",
        ],
        &[("ulp", 1.0)],
        |s| Some((None, s.wavelength_ratio_ulp.as_ref()?)),
    ),
];

/// The channels that errors of objects need.
const OBJECTS: &str = "the channel object";

/// A statistic of a distribution: its name, which values are better, its evaluator.
type Part = (&'static str, Better, fn(&Distribution) -> Option<f64>);

/// The statistics of a distribution.
const PARTS: [Part; 8] = [
    ("mean", Better::Smaller, |d| Some(d.summary?.mean)),
    ("rms", Better::Smaller, |d| Some(d.summary?.rms)),
    ("p50", Better::Smaller, |d| Some(d.summary?.p50)),
    ("p90", Better::Smaller, |d| Some(d.summary?.p90)),
    ("p99", Better::Smaller, |d| Some(d.summary?.p99)),
    ("max", Better::Smaller, |d| Some(d.summary?.max)),
    ("count", Better::Larger, |d| Some(d.count as f64)),
    (UNMEASURED, Better::Smaller, |d| {
        Some(without_value(d) as f64)
    }),
];

/// The name of the count of pixels without a value.
const UNMEASURED: &str = "unmeasured";

/// The pixels that could not be measured: those where the reference shows a surface, whatever the candidate shows; if the reference does
/// not say, those with a surface in both pictures.
fn without_value(d: &Distribution) -> u64 {
    d.unmeasured.max(d.surfaces.saturating_sub(d.count))
}

/// The name of the mean of signed values.
const BIAS: &str = "bias";

const fn channel(
    name: &'static str,
    unit: &'static str,
    heading: Option<&'static str>,
    value: fn(&Errors) -> Option<f64>,
) -> Metric {
    row(name, unit, heading, LIGHT, Of::Channel(value))
}

const fn picture(
    name: &'static str,
    unit: &'static str,
    heading: Option<&'static str>,
    needs: &'static str,
    value: fn(&Comparison) -> Option<f64>,
) -> Metric {
    row(name, unit, heading, needs, Of::Picture(value, |_| None))
}

const fn pixels(
    [name, unit, heading, needs]: [&'static str; 4],
    units: &'static [(&'static str, f64)],
    values: fn(&SurfaceErrors) -> Option<Values<'_>>,
) -> Metric {
    row(
        name,
        unit,
        Some(heading),
        needs,
        Of::Pixels(values, false, units),
    )
}

/// A row for a metric that is better if smaller.
const fn row(
    name: &'static str,
    unit: &'static str,
    heading: Option<&'static str>,
    needs: &'static str,
    of: Of,
) -> Metric {
    Metric {
        name,
        unit,
        better: Better::Smaller,
        heading,
        largest: f64::INFINITY,
        needs,
        set: None,
        of,
    }
}

impl Metric {
    const fn better_when_large(self) -> Metric {
        Metric {
            better: Better::Larger,
            ..self
        }
    }

    const fn at_most(self, largest: f64) -> Metric {
        Metric { largest, ..self }
    }

    const fn in_words(mut self, words: fn(&Comparison) -> Option<String>) -> Metric {
        if let Of::Picture(value, _) = self.of {
            self.of = Of::Picture(value, words);
        }
        self
    }

    const fn set_by(self, what: &'static str, setting: Setting) -> Metric {
        Metric {
            set: Some((what, setting)),
            ..self
        }
    }

    const fn signed(mut self) -> Metric {
        if let Of::Pixels(values, _, units) = self.of {
            self.of = Of::Pixels(values, true, units);
        }
        self
    }

    /// The message that its input is missing.
    fn lacks(&self) -> Message {
        let mut text = Message::from("it needs ");
        if let Some((what, setting)) = self.set {
            text += Message::from(what) + " (" + setting + ") and ";
        }
        text + self.needs + " in both pictures"
    }

    /// Its table column: the heading, and the value for these errors.
    pub(super) fn cell(&self, errors: Option<&Errors>) -> Option<(&'static str, String)> {
        let Of::Channel(value) = self.of else {
            return None;
        };
        let value = errors.and_then(value);
        Some((self.heading?, value.map_or_else(|| NONE.into(), number)))
    }

    /// Its lines below the table: labels and results.
    pub(super) fn lines(&self, comparison: &Comparison) -> Vec<(&'static str, String)> {
        let Some(heading) = self.heading else {
            return Vec::new();
        };
        match self.of {
            Of::Channel(_) => Vec::new(),
            Of::Picture(_, words) => words(comparison)
                .map(|w| (heading, w))
                .into_iter()
                .collect(),
            Of::Pixels(values, _, units) => {
                let Some(values) = comparison.surface.as_ref().and_then(values) else {
                    return Vec::new();
                };
                let line = |&(unit, scale): &(&str, f64)| {
                    (heading, spread(comparison, values, unit, scale))
                };
                units.iter().map(line).collect()
            }
        }
    }
}

/// A number of things: "1 pixel", "2 pixels".
fn counted(n: u64, noun: &str) -> String {
    let s = if n == 1 { "" } else { "s" };
    format!("{n} {noun}{s}")
}

fn wrong_objects(comparison: &Comparison) -> Option<String> {
    let share = comparison.surface.as_ref()?.wrong_objects?;
    let percent = 100.0 * share.pixels as f64 / share.of.max(1) as f64;
    let pixels = counted(share.pixels, "pixel");
    Some(format!("{pixels} ({} %)", number(percent)))
}

fn coverage(comparison: &Comparison) -> Option<String> {
    let share = comparison.surface.as_ref()?.coverage?;
    let percent = share
        .fraction()
        .map_or(NONE.into(), |part| number(100.0 * part));
    Some(format!(
        "the same object at {} of the reference's {} pixels with surfaces ({percent} %)",
        share.pixels, share.of
    ))
}

fn silhouette(comparison: &Comparison) -> Option<String> {
    let silhouette = comparison.surface.as_ref()?.silhouette?;
    // An area over a length: more than any distance where objects are missing.
    let [mean, length] = [silhouette.mean, silhouette.length].map(number);
    let largest = silhouette.largest.map_or(NONE.into(), number);
    Some(format!(
        "moved area {mean} px² per px of outlines, over {length} px; farthest {largest} px"
    ))
}

fn spread(comparison: &Comparison, (bias, d): Values, unit: &str, scale: f64) -> String {
    let Some(summary) = &d.summary else {
        return format!("none: {}", nothing(comparison, d));
    };
    // Only here are numbers scaled to other units: those in JSON stay in metres.
    let values = [summary.mean, summary.p50, summary.p99, summary.max];
    let [mean, p50, p99, max] = values.map(|x| number(scale * x));
    let bias = bias.map_or(String::new(), |b| {
        format!("bias {} {unit}, ", number(scale * b))
    });
    let unmeasured = match (d.unmeasured, gaps(d)) {
        (_, Some(gaps)) => format!("; {gaps}"),
        (0, None) => String::new(),
        (1, None) => "; 1 pixel has none".into(),
        (n, None) => format!("; {n} pixels have none"),
    };
    format!("{bias}mean {mean}, p50 {p50}, p99 {p99}, max {max} {unit}{unmeasured}")
}

/// Why a distribution is empty.
fn nothing(comparison: &Comparison, d: &Distribution) -> String {
    let Uncompared {
        only_reference,
        only_candidate,
    } = &comparison.uncompared;
    let object = Aov::Object.name();
    let has_object = |names: &[String]| names.iter().any(|name| name == object);
    let lacks = |who: &str| {
        format!("the {who} lacks the channel {object}, which says whose points it shows")
    };
    match d.unmeasured {
        0 => "no pixel shows the same object in both pictures".into(),
        _ if has_object(only_reference) => lacks("candidate"),
        _ if has_object(only_candidate) => lacks("reference"),
        n => format!("it cannot be measured at any of the {n} pixels of the same object"),
    }
}

/// The fraction of the reference's surface pixels that must be measured for a limit to hold.
const LEAST_MEASURED: f64 = 0.5;

/// The largest fraction of pixels of the same object where the candidate may lack numbers that the reference has: a few slivers and rims.
const MOST_LACKING: f64 = 0.01;

/// The most objects that a message names.
const MOST_NAMED: usize = 6;

/// Why a distribution does not cover the whole picture: objects, or more than half of the surfaces, have no value.
fn gaps(d: &Distribution) -> Option<String> {
    if let [first, others @ ..] = &d.unmeasured_objects[..] {
        let list = |of: fn(&Unmeasured) -> u64| {
            let named = d
                .unmeasured_objects
                .iter()
                .take(MOST_NAMED)
                .map(|o| of(o).to_string());
            let more = if others.len() < MOST_NAMED {
                ""
            } else {
                ", …"
            };
            format!("{}{more}", named.collect::<Vec<_>>().join(", "))
        };
        let (objects, pixels, shown) = (list(|o| o.object), list(|o| o.pixels), list(|o| o.shown));
        let noun = if others.is_empty() {
            "object"
        } else {
            "objects"
        };
        let moving = match first
            .shown
            .max(others.iter().map(|o| o.shown).max().unwrap_or(0))
        {
            0 => "",
            _ => "; of a moving object, object_event says which point is shown",
        };
        return Some(format!(
            "of {noun} {objects}, which the reference shows at {pixels} pixels and the candidate at {shown} of them, no pixel has a value{moving}"
        ));
    }
    // No object is missing entirely, but pixels may be.
    let compared = d.count + d.unmeasured;
    if d.lacking as f64 > MOST_LACKING * compared as f64 {
        return Some(format!(
            "at {} of the {compared} pixels where both show the same object, the candidate has no numbers (NaN, or infinite) and the reference has some",
            d.lacking
        ));
    }
    let part = d.count as f64 / d.surfaces as f64;
    (part < LEAST_MEASURED).then(|| {
        format!(
            "only {} of the reference's {} pixels with surfaces have a value ({} %)",
            d.count,
            d.surfaces,
            number(100.0 * part)
        )
    })
}

/// The text for a missing value.
const NONE: &str = "none";

/// A number with four significant digits, whatever its magnitude.
pub(super) fn number(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        size if size.is_nan() => "—".into(),
        size if size.is_infinite() => "∞".into(),
        // Four digits: 3 − ⌊log₁₀⌋ decimals.
        size if (1e-3..1e5).contains(&size) => {
            let digits = (3 - size.log10().floor() as i32).max(0) as usize;
            format!("{x:.digits$}")
        }
        _ => format!("{x:.3e}"),
    }
}

/// The names of all metrics with their units, for the help.
pub fn help() -> String {
    // Units of light and ratios are omitted.
    let [mut of_light, mut of_picture, mut of_pixels, mut signed] = [const { Vec::new() }; 4];
    for metric in &METRICS {
        let name = match (metric.unit, metric.better) {
            ("" | "ratio", Better::Smaller) => metric.name.to_string(),
            ("" | "ratio", Better::Larger) => format!("{} (at least)", metric.name),
            (unit, Better::Smaller) => format!("{} ({unit})", metric.name),
            (unit, Better::Larger) => format!("{} ({unit}, at least)", metric.name),
        };
        match metric.of {
            Of::Channel(_) => of_light.push(name),
            Of::Picture(..) => of_picture.push(name),
            Of::Pixels(_, has_sign, _) => {
                of_pixels.push(name);
                signed.extend(has_sign.then(|| format!("{}.{BIAS}", metric.name)));
            }
        }
    }
    let parts = PARTS.map(|(name, better, _)| match better {
        Better::Smaller => format!(".{name}"),
        Better::Larger => format!(".{name} (at least)"),
    });
    format!(
        "  of the light, or of one channel (radiance.R:max): {}\n  of the picture: {}\n  of surfaces, with {}: {}; \
         and {}\n  A metric that cannot be computed exceeds its limit. mrse divides by (|r| + 0.01)², which is far from relative where light is dimmer than 0.01.",
        of_light.join(", "),
        of_picture.join(", "),
        parts.join(", "),
        of_pixels.join(", "),
        signed.join(", ")
    )
}

/// A limit of one metric.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tolerance {
    /// The metric's name: `rmse`, `flip`, `geometric.p99`, `radiance.R:max`.
    pub metric: String,
    /// The worst value allowed.
    pub value: f64,
}

/// A limit that is exceeded.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Breach {
    /// The limit.
    #[serde(flatten)]
    pub tolerance: Tolerance,
    /// The value of the metric.
    pub found: Measured,
}

/// The value of a metric.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Measured {
    /// A number.
    Value(f64),
    /// It could not be computed, for this reason.
    Nothing(Message),
}

impl std::str::FromStr for Tolerance {
    type Err = String;

    /// From `metric=value`.
    fn from_str(text: &str) -> Result<Self, String> {
        let help = "write METRIC=VALUE, for instance rmse=0.01 or radiance.R:max=0.5";
        let (metric, value) = text.rsplit_once('=').ok_or(help)?;
        // Nothing would exceed a limit of NaN.
        let value = value.trim().parse::<f64>().ok().filter(|v| !v.is_nan());
        Ok(Tolerance {
            metric: metric.trim().into(),
            value: value.ok_or(help)?,
        })
    }
}

impl std::fmt::Display for Breach {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Tolerance { metric, value } = &self.tolerance;
        let limit = match Name::of(metric).map(|name| name.better()) {
            Some(Better::Larger) => "must be at least",
            Some(Better::Smaller) | None => "may be at most",
        };
        match &self.found {
            Measured::Value(found) => {
                // The digits of the table, unless they are the same as those of the limit.
                let digits = Some(number(*found)).filter(|digits| *digits != number(*value));
                let found = digits.unwrap_or_else(|| found.to_string());
                write!(f, "{metric} is {found}, and {limit} {value}")
            }
            Measured::Nothing(why) => {
                write!(
                    f,
                    "{metric} {limit} {value}, and could not be computed: {why}"
                )
            }
        }
    }
}

/// The meaning of a metric's name.
#[derive(Debug, Clone, Copy)]
struct Name<'a> {
    /// The channel, for a metric of channels.
    channel: Option<&'a str>,
    row: &'static Metric,
    /// The statistic of a distribution; `None` if the metric is one number, or the bias.
    part: Option<Part>,
}

impl<'a> Name<'a> {
    /// Parses the name of a metric: of light, as CHANNEL:NAME or NAME; of the picture; or of surfaces, as NAME.PART.
    fn of(name: &'a str) -> Option<Name<'a>> {
        let (channel, name) = match name.rsplit_once(':') {
            Some((channel, name)) => (Some(channel), name),
            None => (None, name),
        };
        let is_meant = |row: &&Metric| match row.of {
            Of::Channel(_) => row.name == name,
            Of::Picture(..) => row.name == name && channel.is_none(),
            Of::Pixels(..) => false,
        };
        if let Some(row) = METRICS.iter().find(is_meant) {
            let part = None;
            return Some(Name { channel, row, part });
        }
        let (name, part) = name.rsplit_once('.')?;
        let is_meant = |row: &&Metric| match row.of {
            Of::Pixels(_, has_sign, _) => row.name == name && (has_sign || part != BIAS),
            Of::Channel(_) | Of::Picture(..) => false,
        };
        let row = METRICS
            .iter()
            .find(is_meant)
            .filter(|_| channel.is_none())?;
        let part = match part {
            BIAS => None,
            part => Some(*PARTS.iter().find(|(name, ..)| *name == part)?),
        };
        Some(Name { channel, row, part })
    }

    fn better(&self) -> Better {
        self.part.map_or(self.row.better, |(_, better, _)| better)
    }

    /// The largest possible value.
    fn largest(&self) -> f64 {
        match self.part {
            None => self.row.largest,
            Some(_) => f64::INFINITY,
        }
    }

    /// Why a limit is meaningless: every candidate is within it, or none can be.
    fn refuses(&self, limit: f64) -> Option<&'static str> {
        let is_met = "every candidate is within that limit";
        let never = "no candidate can be within that limit";
        match self.better() {
            Better::Smaller if limit == f64::INFINITY => Some(is_met),
            Better::Smaller if limit < 0.0 => Some(never),
            Better::Larger if limit == f64::NEG_INFINITY => Some(is_met),
            Better::Larger if limit > self.largest() => Some(never),
            Better::Smaller | Better::Larger => None,
        }
    }

    fn allows(&self, limit: f64, found: f64) -> bool {
        match self.better() {
            Better::Larger => found >= limit,
            Better::Smaller => found.abs() <= limit,
        }
    }

    /// The value of the metric in `comparison`; `None` if neither the comparison nor a picture has a channel of this name.
    fn found(&self, comparison: &Comparison) -> Option<Measured> {
        Some(match self.row.of {
            Of::Channel(value) => match self.errors(comparison)? {
                Ok(errors) => settled(
                    value(errors),
                    || "it is not defined for these values, or for so few",
                ),
                Err(why) => Measured::Nothing(why),
            },
            Of::Picture(value, _) => settled(value(comparison), || {
                let is_skipped = self.row.name.starts_with("flip") && comparison.flip.is_none();
                let has_objects = (comparison.surface.as_ref())
                    .is_some_and(|surface| surface.wrong_objects.is_some());
                if is_skipped && comparison.radiance.is_some() {
                    let skipped =
                        || Message::from("FLIP was not computed (") + Setting::NoFlip + ")";
                    comparison.uncompared.of_light().unwrap_or_else(skipped)
                } else if self.row.needs == OBJECTS && has_objects {
                    "the reference shows no object, or no boundary between objects".into()
                } else {
                    self.row.lacks()
                }
            }),
            Of::Pixels(values, ..) => match comparison.surface.as_ref().and_then(values) {
                None => Measured::Nothing(self.row.lacks()),
                Some((bias, d)) => match (self.part, gaps(d)) {
                    // Counts themselves state how much was measured.
                    (Some((_, Better::Larger, of)), _) | (Some((UNMEASURED, _, of)), _) => {
                        settled(of(d), || nothing(comparison, d))
                    }
                    (_, Some(gaps)) if d.count > 0 => Measured::Nothing(gaps.into()),
                    (Some((_, _, of)), _) => settled(of(d), || nothing(comparison, d)),
                    (None, _) => settled(bias, || nothing(comparison, d)),
                },
            },
        })
    }

    /// The errors that a metric of the light or of a channel measures, or why there are none.
    fn errors<'c>(&self, comparison: &'c Comparison) -> Option<Result<&'c Errors, Message>> {
        let empty = || Message::from("no sample is a number in both pictures");
        let Some(name) = self.channel else {
            // A part of the light says nothing of the rest.
            let partial = comparison.uncompared.of_light();
            let light = comparison.radiance.as_ref();
            if let Some(why) = partial.filter(|_| light.is_some()) {
                return Some(Err(why));
            }
            let missing = || match comparison.channels.iter().any(|c| is_light(&c.name)) {
                true => empty(),
                false => self.row.lacks(),
            };
            return Some(light.ok_or_else(missing));
        };
        if let Some(channel) = comparison.channels.iter().find(|c| c.name == name) {
            return Some(channel.errors.as_ref().ok_or_else(empty));
        }
        // A channel of only one picture is a valid name, but has no value.
        let Uncompared {
            only_reference,
            only_candidate,
        } = &comparison.uncompared;
        let lacks = |names: &[String], who: &str| {
            let is_there = names.iter().any(|n| n == name);
            is_there.then(|| Err(format!("the {who} has no channel {name}").into()))
        };
        lacks(only_reference, "candidate").or_else(|| lacks(only_candidate, "reference"))
    }
}

fn settled<M: Into<Message>>(value: Option<f64>, why: impl FnOnce() -> M) -> Measured {
    match value.filter(|value| !value.is_nan()) {
        Some(value) => Measured::Value(value),
        None => Measured::Nothing(why().into()),
    }
}

impl Comparison {
    /// The metric of this name; `None` if there is no such metric, or it could not be computed.
    pub fn metric(&self, name: &str) -> Option<f64> {
        match Name::of(name)?.found(self)? {
            Measured::Value(value) => Some(value),
            Measured::Nothing(_) => None,
        }
    }

    /// The limits that are exceeded, in order; a metric that could not be computed exceeds its limit.
    ///
    /// # Errors
    /// An unknown metric.
    pub fn breaches(&self, tolerances: &[Tolerance]) -> Result<Vec<Breach>> {
        let mut breaches = Vec::new();
        for tolerance in tolerances {
            let name = Name::of(&tolerance.metric);
            let found = name.and_then(|name| Some((name, name.found(self)?)));
            let (name, found) = found.ok_or_else(|| self.unknown(&tolerance.metric))?;
            if let Some(what) = name.refuses(tolerance.value) {
                let place =
                    Setting::ToleranceOf + format!(" {}={}", tolerance.metric, tolerance.value);
                let help = "a number that the metric can have, and that some candidate exceeds";
                return Err(Error::invalid("comparison", place, what, help));
            }
            // A metric that cannot be computed is not within its limit.
            let holds = matches!(&found, Measured::Value(v) if name.allows(tolerance.value, *v));
            if !holds {
                let tolerance = tolerance.clone();
                breaches.push(Breach { tolerance, found });
            }
        }
        Ok(breaches)
    }

    fn unknown(&self, metric: &str) -> Error {
        let place = Setting::ToleranceOf + format!(" {metric}");
        // A known metric of an unknown channel is not an unknown metric.
        if let Some((channel, _)) = metric
            .rsplit_once(':')
            .filter(|_| Name::of(metric).is_some())
        {
            let is_identity = Aov::named(channel).is_some_and(Aov::is_identity);
            if is_identity {
                let what = format!("{channel} holds indices, whose differences mean nothing");
                let help = "wrong_objects counts the pixels at which objects differ";
                return Error::invalid("comparison", place, what, help);
            }
            let what = format!("neither picture has a channel {channel} with numbers");
            let names: Vec<&str> = self.channels.iter().map(|c| c.name.as_str()).collect();
            let help = format!("compared are {}", names.join(", "));
            return Error::invalid("comparison", place, what, help);
        }
        let names = METRICS.iter().map(|metric| match metric.of {
            Of::Channel(_) | Of::Picture(..) => metric.name.to_string(),
            Of::Pixels(_, true, _) => format!("{0}.mean, {0}.{BIAS}", metric.name),
            Of::Pixels(_, false, _) => format!("{}.mean", metric.name),
        });
        let names: Vec<String> = names.collect();
        let parts = PARTS.map(|(name, ..)| name).join(", ");
        let help = format!(
            "there are {}, and CHANNEL:METRIC for each channel; in place of .mean also {parts}",
            names.join(", ")
        );
        Error::invalid("comparison", place, "there is no such metric", help)
    }
}
