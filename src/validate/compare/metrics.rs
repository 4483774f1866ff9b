//! Metrics: one table from which tolerances, the help, the printed table and the HTML report come.
//!
//! A further metric is a field with its evaluator (of [`Errors`], [`SurfaceErrors`] or [`Comparison`]; JSON has it with the
//! field) and a row here. A limit holds as far as the metric is no worse: at most the value, or at least it where
//! larger is better. The bias counts by its size.

use super::comparison::Comparison;
use super::errors::Errors;
use super::surface::{Distribution, SurfaceErrors};
use crate::error::{Error, Result};
use crate::scene::model::SPEED_OF_LIGHT;

/// A metric, or for values of many pixels a family of them (`geometric.mean`, `geometric.p99`): a row of [`METRICS`].
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Metric {
    /// Its name in tolerances.
    pub name: &'static str,
    /// Its unit; empty for that of the channel.
    pub unit: &'static str,
    /// Which values are better.
    pub better: Better,
    /// Its heading in tables; none where they leave it out.
    pub heading: Option<&'static str>,
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

/// What a metric is a number of, and its evaluator.
#[derive(Debug, Clone, Copy)]
enum Of {
    /// The light, and each channel; NaN where it is undefined.
    Channel(fn(&Errors) -> Option<f64>),
    /// The whole picture; and the words for it in tables.
    Picture(
        fn(&Comparison) -> Option<f64>,
        fn(&Comparison) -> Option<String>,
    ),
    /// Pixels that show surfaces; whether values have a sign; further units in which tables have them, and factors.
    Pixels(
        fn(&SurfaceErrors) -> Option<Values<'_>>,
        bool,
        &'static [(&'static str, f64)],
    ),
}

/// The mean of values with their signs, and the distribution of their sizes.
type Values<'a> = (Option<f64>, &'a Distribution);

const PS_PER_METRE: f64 = 1e12 / SPEED_OF_LIGHT;

/// All metrics, in the order in which they are shown.
pub const METRICS: [Metric; 22] = [
    channel("bias", "", Some("bias"), |e| Some(e.bias)),
    channel("mae", "", Some("MAE"), |e| Some(e.mae)),
    channel("rmse", "", Some("RMSE"), |e| Some(e.rmse)),
    channel("relrmse", "ratio", Some("relRMSE"), |e| {
        Some(e.relrmse.unwrap_or(f64::NAN))
    }),
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
    channel("ssim", "ratio", Some("SSIM"), |e| e.ssim).better_when_large(),
    picture("flip", "ratio", None, |c| Some(c.flip.as_ref()?.mean)),
    picture("flip.max", "ratio", None, |c| Some(c.flip.as_ref()?.max)),
    picture("wrong_object", "pixels", Some("wrong object"), |c| {
        Some(c.surface.as_ref()?.wrong_object?.pixels as f64)
    })
    .in_words(wrong_object),
    picture("silhouette", "pixels", Some("silhouette"), |c| {
        Some(c.surface.as_ref()?.silhouette?.mean)
    })
    .in_words(silhouette),
    picture("silhouette.max", "pixels", None, |c| {
        c.surface.as_ref()?.silhouette?.largest
    }),
    pixels(
        "geometric",
        "pixels",
        "geometric error",
        &[("px", 1.0)],
        |s| Some((None, s.geometric.as_ref()?)),
    ),
    pixels(
        "time",
        "m",
        "emission time",
        &[("m", 1.0), ("ps", PS_PER_METRE)],
        |s| {
            s.emission_time
                .as_ref()
                .map(|t| (Some(t.bias), &t.absolute))
        },
    )
    .signed(),
    pixels(
        "time_bins",
        "bins",
        "emission time",
        &[("bins", 1.0)],
        |s| Some((None, s.emission_time_bins.as_ref()?)),
    ),
    pixels("w", "ratio", "wavelength ratio", &[("%", 100.0)], |s| {
        let w = s.wavelength_ratio.as_ref()?;
        Some((Some(w.bias), &w.absolute))
    })
    .signed(),
    pixels("w_ulp", "ulp", "wavelength ratio", &[("ulp", 1.0)], |s| {
        Some((None, s.wavelength_ratio_ulp.as_ref()?))
    }),
];

/// A name and a number of a distribution.
type Part = (&'static str, fn(&Distribution) -> f64);

/// The numbers of a distribution.
const PARTS: [Part; 6] = [
    ("mean", |d| d.mean),
    ("rms", |d| d.rms),
    ("p50", |d| d.p50),
    ("p90", |d| d.p90),
    ("p99", |d| d.p99),
    ("max", |d| d.max),
];

const fn row(
    name: &'static str,
    unit: &'static str,
    heading: Option<&'static str>,
    of: Of,
) -> Metric {
    let better = Better::Smaller;
    Metric {
        name,
        unit,
        better,
        heading,
        of,
    }
}

const fn channel(
    name: &'static str,
    unit: &'static str,
    heading: Option<&'static str>,
    value: fn(&Errors) -> Option<f64>,
) -> Metric {
    row(name, unit, heading, Of::Channel(value))
}

const fn picture(
    name: &'static str,
    unit: &'static str,
    heading: Option<&'static str>,
    value: fn(&Comparison) -> Option<f64>,
) -> Metric {
    row(name, unit, heading, Of::Picture(value, |_| None))
}

const fn pixels(
    name: &'static str,
    unit: &'static str,
    heading: &'static str,
    units: &'static [(&'static str, f64)],
    values: fn(&SurfaceErrors) -> Option<Values<'_>>,
) -> Metric {
    row(name, unit, Some(heading), Of::Pixels(values, false, units))
}

impl Metric {
    const fn better_when_large(self) -> Metric {
        Metric {
            better: Better::Larger,
            ..self
        }
    }

    const fn in_words(mut self, words: fn(&Comparison) -> Option<String>) -> Metric {
        if let Of::Picture(value, _) = self.of {
            self.of = Of::Picture(value, words);
        }
        self
    }

    const fn signed(mut self) -> Metric {
        if let Of::Pixels(values, _, units) = self.of {
            self.of = Of::Pixels(values, true, units);
        }
        self
    }

    /// Its column of a table: the heading, and the value for these errors.
    pub(super) fn cell(&self, errors: &Errors) -> Option<(&'static str, String)> {
        let Of::Channel(value) = self.of else {
            return None;
        };
        Some((self.heading?, number(value(errors).unwrap_or(f64::NAN))))
    }

    /// Its lines below the table: what is measured, and what was found.
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
                let line = |&(unit, scale): &(&str, f64)| (heading, spread(values, unit, scale));
                units.iter().map(line).collect()
            }
        }
    }
}

fn wrong_object(comparison: &Comparison) -> Option<String> {
    let share = comparison.surface.as_ref()?.wrong_object?;
    let percent = 100.0 * share.pixels as f64 / share.of.max(1) as f64;
    Some(format!("{} pixels ({} %)", share.pixels, number(percent)))
}

fn silhouette(comparison: &Comparison) -> Option<String> {
    let silhouette = comparison.surface.as_ref()?.silhouette?;
    let [mean, length] = [silhouette.mean, silhouette.length].map(number);
    let largest = number(silhouette.largest.unwrap_or(f64::NAN));
    Some(format!(
        "mean {mean} px, largest {largest} px, over {length} px"
    ))
}

fn spread((bias, d): Values, unit: &str, scale: f64) -> String {
    let [mean, p50, p99, max] = [d.mean, d.p50, d.p99, d.max].map(|x| number(scale * x));
    let bias = bias.map_or(String::new(), |b| {
        format!("bias {} {unit}, ", number(scale * b))
    });
    let unmeasured = match d.unmeasured {
        0 => String::new(),
        n => format!("; {n} pixels have none"),
    };
    format!("{bias}mean {mean}, p50 {p50}, p99 {p99}, max {max} {unit}{unmeasured}")
}

/// A number in four significant digits, whatever its magnitude.
pub(super) fn number(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        size if size.is_nan() => "—".into(),
        size if size.is_infinite() => "∞".into(),
        size if (1e-3..1e5).contains(&size) => {
            let digits = (3 - size.log10().floor() as i32).max(0) as usize;
            format!("{x:.digits$}")
        }
        _ => format!("{x:.3e}"),
    }
}

/// The names of all metrics with their units, for the help.
pub fn help() -> String {
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
                signed.extend(has_sign.then(|| format!("{}.bias", metric.name)));
            }
        }
    }
    let parts = PARTS.map(|(name, _)| format!(".{name}"));
    format!(
        "  of the light, or of one channel (radiance.R:max): {}\n  of the picture: {}\n  of surfaces, with {}: {}; \
         and {}",
        of_light.join(", "),
        of_picture.join(", "),
        parts.join(", "),
        of_pixels.join(", "),
        signed.join(", ")
    )
}

/// A limit of one metric.
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerance {
    /// The metric's name: `rmse`, `flip`, `geometric.p99`, `radiance.R:max`.
    pub metric: String,
    /// The worst value that is allowed.
    pub value: f64,
}

/// A limit that is exceeded.
#[derive(Debug, Clone, PartialEq)]
pub struct Breach {
    /// The limit.
    pub tolerance: Tolerance,
    /// What the metric is.
    pub found: f64,
}

impl std::str::FromStr for Tolerance {
    type Err = String;

    /// From `metric=value`.
    fn from_str(text: &str) -> Result<Self, String> {
        let help = "write METRIC=VALUE, for instance rmse=0.01 or radiance.R:max=0.5";
        let (metric, value) = text.rsplit_once('=').ok_or(help)?;
        let value = value.trim().parse::<f64>().ok().filter(|v| !v.is_nan());
        Ok(Tolerance {
            metric: metric.trim().into(),
            value: value.ok_or(help)?,
        })
    }
}

impl Tolerance {
    fn better(&self) -> Better {
        let name = self.metric.rsplit(':').next().unwrap_or(&self.metric);
        let row = METRICS.iter().find(|metric| metric.name == name);
        row.map_or(Better::Smaller, |metric| metric.better)
    }

    fn allows(&self, found: f64) -> bool {
        match self.better() {
            Better::Larger => found >= self.value,
            Better::Smaller => found.abs() <= self.value,
        }
    }
}

impl std::fmt::Display for Breach {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Tolerance { metric, value } = &self.tolerance;
        let limit = match self.tolerance.better() {
            Better::Larger => "least",
            Better::Smaller => "most",
        };
        write!(
            f,
            "{metric} is {}, and may be at {limit} {value}",
            self.found
        )
    }
}

impl Comparison {
    /// All metrics by name; infinite where one is undefined.
    pub fn metrics(&self) -> Vec<(String, f64)> {
        let mut metrics = Vec::new();
        let of_channel = |prefix: &str, errors: &Errors| {
            let row = |metric: &Metric| match metric.of {
                Of::Channel(value) => Some((format!("{prefix}{}", metric.name), value(errors)?)),
                Of::Picture(..) | Of::Pixels(..) => None,
            };
            METRICS.iter().filter_map(row).collect::<Vec<_>>()
        };
        metrics.extend(
            self.radiance
                .iter()
                .flat_map(|errors| of_channel("", errors)),
        );
        for metric in &METRICS {
            match metric.of {
                Of::Channel(_) => {}
                Of::Picture(value, _) => {
                    metrics.extend(value(self).map(|value| (metric.name.into(), value)));
                }
                Of::Pixels(values, ..) => {
                    let Some((bias, d)) = self.surface.as_ref().and_then(values) else {
                        continue;
                    };
                    let bias = bias.map(|bias| ("bias", bias));
                    let parts = PARTS.map(|(part, of)| (part, of(d)));
                    let named = bias.into_iter().chain(parts);
                    metrics.extend(named.map(|(part, x)| (format!("{}.{part}", metric.name), x)));
                }
            }
        }
        for channel in &self.channels {
            metrics.extend(of_channel(&format!("{}:", channel.name), &channel.errors));
        }
        for (_, value) in metrics.iter_mut().filter(|(_, value)| value.is_nan()) {
            *value = f64::INFINITY;
        }
        metrics
    }

    /// The limits that are exceeded, in their order.
    ///
    /// # Errors
    /// A metric that this comparison does not have.
    pub fn breaches(&self, tolerances: &[Tolerance]) -> Result<Vec<Breach>> {
        let metrics = self.metrics();
        let mut breaches = Vec::new();
        for tolerance in tolerances {
            let found = metrics.iter().find(|(name, _)| *name == tolerance.metric);
            let Some(&(_, found)) = found else {
                return Err(unknown(&tolerance.metric, &metrics));
            };
            if !tolerance.allows(found) {
                let tolerance = tolerance.clone();
                breaches.push(Breach { tolerance, found });
            }
        }
        Ok(breaches)
    }
}

fn unknown(metric: &str, metrics: &[(String, f64)]) -> Error {
    let names = metrics.iter().map(|(name, _)| name.as_str());
    let plain: Vec<&str> = names.filter(|name| !name.contains(':')).collect();
    let what = "the comparison of these pictures has no such metric";
    let help = format!(
        "there are {}, and CHANNEL:METRIC for each channel",
        plain.join(", ")
    );
    Error::invalid("command line", format!("--tolerance {metric}"), what, help)
}
