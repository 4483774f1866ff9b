//! The forecast as text, for people.

use std::fmt::{self, Formatter};

use super::{Forecast, Needed};
use crate::render::plan::count;

impl fmt::Display for Forecast {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let scene = self.scene.escape_debug();
        writeln!(
            f,
            "{scene}: edges for an error of at most {} pixels",
            self.pixels
        )?;
        if self.objects.is_empty() {
            return writeln!(f, "  the picture shows no object");
        }
        let names = self.objects.iter().map(|o| o.name.chars().count());
        let width = names.max().unwrap_or(0).clamp(6, 32);
        writeln!(
            f,
            "  {:<width$}  {:>10}  {:>10}  {:>8}  {:>8}  {:>12}  worst at",
            "object", "edges ≤ m", "longest m", "parts", "halvings", "now ≤ pixels"
        )?;
        for object in &self.objects {
            object.row(f, width)?;
        }
        match self.finest() {
            Some(length) => writeln!(
                f,
                "  for all of them: --method raster:uniform={}",
                short(length)
            ),
            None => writeln!(f, "  no edge is bent: --method raster:none"),
        }
    }
}

impl Forecast {
    /// The edge length that will do for all objects, metres; none where any will.
    pub fn finest(&self) -> Option<f64> {
        let lengths = self.objects.iter().filter_map(|o| o.edge_length);
        lengths.reduce(f64::min)
    }
}

impl Needed {
    fn row(&self, f: &mut Formatter<'_>, width: usize) -> fmt::Result {
        let name: String = self.name.chars().take(width).collect();
        let length = self.edge_length.map_or("any".into(), short);
        let [column, row] = self.worst.pixel;
        writeln!(
            f,
            "  {:<width$}  {length:>10}  {:>10}  {:>8}  {:>8}  {:>12}  triangle {}, pixel ({column}, {row})",
            name.escape_debug().to_string(),
            short(self.longest_edge),
            count(self.parts),
            self.halvings,
            short(self.worst.untessellated),
            count(self.worst.triangle.into()),
        )
    }
}

/// Four significant digits, the last cut off rather than rounded up: a length that is allowed stays one.
fn short(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let exponent = x.abs().log10().floor();
    if !(-4.0..6.0).contains(&exponent) {
        return format!("{x:.3e}");
    }
    let decimals = (3.0 - exponent).max(0.0);
    let scale = 10f64.powf(decimals);
    format!("{:.*}", decimals as usize, (x * scale).floor() / scale)
}
