//! The CIE 1931 2° standard observer.
//!
//! Colour matching functions x̄, ȳ, z̄ at 1 nm from 360 to 830 nm (CIE 018:2019, table 6; ISO/CIE
//! 11664-1), linear between. The table was taken from the Python package colour-science 0.4.7
//! (BSD-3-Clause), which has it from the Colour & Vision Research Laboratory, <http://www.cvrl.org>.

use std::sync::LazyLock;

const TABLE: &str = include_str!("cie_1931_2deg.csv");

/// The first wavelength of the table, nanometres; the step is 1 nm.
pub(super) const FIRST: f64 = 360.0;

/// The last.
pub(super) const LAST: f64 = 830.0;

/// The first and the last wavelength that the observer sees, nanometres: colours stand for spectra between them.
pub const OBSERVED_NM: [f64; 2] = [FIRST, LAST];

/// Lines `wavelength,x,y,z`.
static ROWS: LazyLock<Vec<[f64; 3]>> = LazyLock::new(|| TABLE.lines().filter_map(row).collect());

fn row(line: &str) -> Option<[f64; 3]> {
    let mut numbers = line.split(',').skip(1).map(|n| n.parse().ok());
    Some([numbers.next()??, numbers.next()??, numbers.next()??])
}

/// x̄, ȳ, z̄ from [`FIRST`] to [`LAST`] at every nanometre.
pub(super) fn rows() -> &'static [[f64; 3]] {
    &ROWS
}

/// x̄, ȳ, z̄ at a wavelength in metres; 0 outside 360 to 830 nm.
pub fn colour_matching(wavelength: f64) -> [f64; 3] {
    between(&ROWS, wavelength * 1e9 - FIRST).unwrap_or([0.0; 3])
}

/// Linear between the entries of `table` at a position counted in entries; none outside.
pub(super) fn between(table: &[[f64; 3]], position: f64) -> Option<[f64; 3]> {
    // NaN fails the comparison.
    if !(position >= 0.0 && position <= table.len() as f64 - 1.0) {
        return None;
    }
    let first = position as usize;
    let (a, b) = (
        table.get(first)?,
        table.get(first + 1).unwrap_or(&table[first]),
    );
    let weight = position - first as f64;
    Some(std::array::from_fn(|k| a[k] + (b[k] - a[k]) * weight))
}

/// The CIE's own numbers, without processing by the library: wavelength in nm, x̄, ȳ, z̄ per row.
#[cfg(test)]
pub(super) fn numbers() -> Vec<Vec<f64>> {
    let row = |line: &str| line.split(',').map(|x| x.trim().parse().ok()).collect();
    let rows: Vec<Vec<f64>> = TABLE.lines().filter_map(row).collect();
    assert!(rows.len() > 400);
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chromaticity(nanometres: f64) -> [f64; 2] {
        let [x, y, z] = colour_matching(nanometres * 1e-9);
        [x / (x + y + z), y / (x + y + z)]
    }

    #[test]
    fn the_table_is_whole() {
        assert_eq!(ROWS.len(), 471);
    }

    #[test]
    fn the_spectral_locus_has_the_published_chromaticities() {
        // Wyszecki & Stiles, Color Science, 2nd ed., table 3.3.1.
        for (nanometres, x, y) in [
            (400.0, 0.1733, 0.0048),
            (450.0, 0.1566, 0.0177),
            (500.0, 0.0082, 0.5384),
            (520.0, 0.0743, 0.8338),
            (589.0, 0.5693, 0.4301),
            (700.0, 0.7347, 0.2653),
        ] {
            let [cx, cy] = chromaticity(nanometres);
            let close = (cx - x).abs() < 6e-5 && (cy - y).abs() < 6e-5;
            assert!(close, "{nanometres} nm: {cx} {cy}");
        }
    }

    #[test]
    fn luminance_peaks_at_555_nm_and_the_three_areas_are_equal() {
        assert_eq!(colour_matching(555e-9)[1], 1.0);
        // Equal-energy light is white (1/3, 1/3): the sums agree.
        let sum = |k: usize| ROWS.iter().map(|row| row[k]).sum::<f64>();
        assert!((sum(0) / sum(1) - 1.0).abs() < 5e-4);
        assert!((sum(2) / sum(1) - 1.0).abs() < 5e-4);
    }

    #[test]
    fn there_is_no_colour_outside_the_table() {
        for wavelength in [f64::NAN, 0.0, 359e-9, 831e-9, f64::INFINITY, -500e-9] {
            assert_eq!(colour_matching(wavelength), [0.0; 3]);
        }
    }
}
