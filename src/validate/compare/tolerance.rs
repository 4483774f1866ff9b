//! Limits of metrics, so that a comparison can be a test.
//!
//! Every number of a [`Comparison`] has a name: `rmse`, `flip`, `geometric.p99`, `radiance.R:max`. A limit holds as far as the
//! metric is no worse: at most the value, or at least it for `psnr` and `ssim`. The bias counts by its size.

use super::Comparison;
use super::errors::Errors;
use super::surface::{Distribution, Signed};
use crate::error::{Error, Result};

/// A limit of one metric.
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerance {
    /// The metric's name.
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

impl std::fmt::Display for Breach {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Tolerance { metric, value } = &self.tolerance;
        let limit = if is_better_when_large(metric) {
            "least"
        } else {
            "most"
        };
        write!(
            f,
            "{metric} is {}, and may be at {limit} {value}",
            self.found
        )
    }
}

/// Whether a larger value is a smaller error.
fn is_better_when_large(metric: &str) -> bool {
    ["psnr", "ssim"].contains(&metric.rsplit(':').next().unwrap_or(metric))
}

impl Comparison {
    /// All metrics by name. A psnr of equal pictures is infinite.
    pub fn metrics(&self) -> Vec<(String, f64)> {
        let mut metrics = Vec::new();
        if let Some(radiance) = &self.radiance {
            add(&mut metrics, "", radiance);
        }
        if let Some(flip) = &self.flip {
            metrics.push(("flip".into(), flip.mean));
            metrics.push(("flip.max".into(), flip.max));
        }
        if let Some(surface) = &self.surface {
            if let Some(share) = surface.wrong_object {
                metrics.push(("wrong_object".into(), share.pixels as f64));
            }
            if let Some(silhouette) = surface.silhouette {
                metrics.push(("silhouette".into(), silhouette.mean));
                metrics.extend(silhouette.largest.map(|d| ("silhouette.max".into(), d)));
            }
            distribution(&mut metrics, "geometric", surface.geometric.as_ref());
            signed(&mut metrics, "time", surface.emission_time.as_ref());
            distribution(
                &mut metrics,
                "time_bins",
                surface.emission_time_bins.as_ref(),
            );
            signed(&mut metrics, "w", surface.wavelength_ratio.as_ref());
            distribution(&mut metrics, "w_ulp", surface.wavelength_ratio_ulp.as_ref());
        }
        for channel in &self.channels {
            add(&mut metrics, &format!("{}:", channel.name), &channel.errors);
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
            let Some((_, found)) = metrics.iter().find(|(name, _)| *name == tolerance.metric)
            else {
                return Err(unknown(&tolerance.metric, &metrics));
            };
            let holds = match is_better_when_large(&tolerance.metric) {
                true => *found >= tolerance.value,
                false => found.abs() <= tolerance.value,
            };
            if !holds {
                breaches.push(Breach {
                    tolerance: tolerance.clone(),
                    found: *found,
                });
            }
        }
        Ok(breaches)
    }
}

fn unknown(metric: &str, metrics: &[(String, f64)]) -> Error {
    let plain: Vec<&str> = metrics
        .iter()
        .map(|(name, _)| name.as_str())
        .filter(|name| !name.contains(':'))
        .collect();
    let what = "the comparison of these pictures has no such metric";
    let help = format!(
        "there are {}, and CHANNEL:METRIC for each channel",
        plain.join(", ")
    );
    Error::invalid("command line", format!("--tolerance {metric}"), what, help)
}

fn add(metrics: &mut Vec<(String, f64)>, prefix: &str, e: &Errors) {
    let named = [
        ("bias", e.bias),
        ("mae", e.mae),
        ("rmse", e.rmse),
        ("relrmse", e.relrmse.unwrap_or(f64::INFINITY)),
        ("mrse", e.mrse),
        ("max", e.max),
        ("p50", e.p50),
        ("p90", e.p90),
        ("p99", e.p99),
        ("p99.9", e.p99_9),
        ("psnr", e.psnr.unwrap_or(f64::INFINITY)),
    ];
    metrics.extend(named.map(|(name, value)| (format!("{prefix}{name}"), value)));
    metrics.extend(e.ssim.map(|ssim| (format!("{prefix}ssim"), ssim)));
}

fn distribution(metrics: &mut Vec<(String, f64)>, name: &str, found: Option<&Distribution>) {
    let Some(d) = found else {
        return;
    };
    let named = [
        ("mean", d.mean),
        ("rms", d.rms),
        ("p50", d.p50),
        ("p90", d.p90),
        ("p99", d.p99),
        ("max", d.max),
    ];
    metrics.extend(named.map(|(part, value)| (format!("{name}.{part}"), value)));
}

fn signed(metrics: &mut Vec<(String, f64)>, name: &str, found: Option<&Signed>) {
    if let Some(found) = found {
        metrics.push((format!("{name}.bias"), found.bias));
        distribution(metrics, name, Some(&found.absolute));
    }
}
