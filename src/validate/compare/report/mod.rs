//! What a comparison has found, for people: a table, maps, strips, and a page that holds all of them.

mod html;
mod legend;
mod maps;
mod strip;
mod table;

pub use html::page;
pub use legend::{ErrorMap, error_map};
pub use maps::maps;
pub use strip::strip;
pub use table::table;

/// A number in four significant digits, whatever its magnitude.
fn number(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        size if !size.is_finite() => {
            if x.is_nan() {
                "—".into()
            } else {
                "∞".into()
            }
        }
        size if (1e-3..1e5).contains(&size) => {
            let digits = (3 - size.log10().floor() as i32).max(0) as usize;
            format!("{x:.digits$}")
        }
        _ => format!("{x:.3e}"),
    }
}
