//! The colours in which an observer sees linear red, green and blue at a ratio W: c_jk(W) = W⁻⁵ ∫ white(λ/W) b_k(λ/W) m_j(λ) dλ, as
//! computed by [`integrate`](super::spectrum::integrate), but several times as fast. Tables of M(W) need thousands of such sums.
//!
//! Within the range of the basis, white, b_k and the observer's functions are linear between their own knots, so that products of three
//! are cubic in λ between all knots: two-point Gauss quadrature is exact there. Both tables are traversed in parallel, without look-ups.
//! Beyond the range of the basis, all three radiances are multiples of one function.

use super::observer::{self, FIRST, LAST};
use super::planck::planck;
use super::rgb_basis::{self, Continuation, STEP, WHITE_TEMPERATURE};
use super::spectrum::{add_panel, panels};

/// Two points of Gauss on [0, 1], ½ (1 ∓ 1/√3); each has the weight ½.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// CIE XYZ of linear red, of green and of blue, seen with wavelengths times `w`, which is above 0.
pub(super) fn xyz_of_primaries(w: f64, continuation: Continuation) -> [[f64; 3]; 3] {
    let mut sums = within(w);
    if let Some(beyond) = beyond(w, continuation) {
        for (sums, beyond) in sums.iter_mut().zip(beyond) {
            for (sum, more) in sums.iter_mut().zip(beyond) {
                *sum += more;
            }
        }
    }
    let scale = 1.0 / (w * w * w * w * w);
    sums.map(|xyz| xyz.map(|sum| scale * sum))
}

/// The part within the range of the basis, without W⁻⁵.
fn within(w: f64) -> [[f64; 3]; 3] {
    let (cie, basis) = (observer::rows(), rgb_basis::rows());
    let (begin, end) = (FIRST.max(w * FIRST), LAST.min(w * LAST));
    let mut sums = [[0.0; 3]; 3];
    if begin >= end {
        return sums;
    }
    // Nanometres: observer's panels i of 1, and those k of the basis, W times their width.
    let (last_i, last_k) = (cie.len() - 2, basis.len() - 2);
    let mut i = ((begin - FIRST) as usize).min(last_i);
    let mut k = (((begin / w - FIRST) / STEP).max(0.0) as usize).min(last_k);
    let mut from = begin;
    while from < end {
        // The last panels go up to the end, wherever rounding puts theirs.
        let mut to = end;
        if i < last_i {
            to = to.min(FIRST + (i + 1) as f64);
        }
        if k < last_k {
            to = to.min(w * (FIRST + STEP * (k + 1) as f64));
        }
        if to > from {
            for point in GAUSS {
                let l = from + (to - from) * point;
                let in_i = l - (FIRST + i as f64);
                let in_k = (l / w - (FIRST + STEP * k as f64)) / STEP;
                let xyz = between(cie[i], cie[i + 1], in_i);
                let [white, r, g, b] = between(basis[k], basis[k + 1], in_k);
                // Metres.
                let weight = 0.5e-9 * (to - from) * white;
                for (sums, b) in sums.iter_mut().zip([r, g, b]) {
                    for (sum, m) in sums.iter_mut().zip(xyz) {
                        *sum += weight * b * m;
                    }
                }
            }
        }
        from = to;
        if i < last_i && FIRST + (i + 1) as f64 <= to {
            i += 1;
        }
        if k < last_k && w * (FIRST + STEP * (k + 1) as f64) <= to {
            k += 1;
        }
    }
    sums
}

/// The part beyond the range of the basis; `None` if that is dark, or not visible.
fn beyond(w: f64, continuation: Continuation) -> Option<[[f64; 3]; 3]> {
    let (first, last) = (w * FIRST * 1e-9, w * LAST * 1e-9);
    if first <= FIRST * 1e-9 && last >= LAST * 1e-9 {
        return None;
    }
    let (factors, is_thermal) = match continuation {
        Continuation::Dark | Continuation::Companions => return None,
        Continuation::Edge => (rgb_basis::edges(), false),
        Continuation::Blackbody => (rgb_basis::thermal(), true),
    };
    // XYZ of the function that all three have there, below and above.
    let radiance = |l: f64| match is_thermal {
        true => planck(l / w, WHITE_TEMPERATURE),
        false => 1.0,
    };
    let mut sums = [[0.0; 3]; 2];
    for (nodes, [from, to]) in panels() {
        let side = match () {
            () if to <= first => 0,
            () if from >= last => 1,
            () if from >= first && to <= last => continue,
            () => {
                // An end of the basis is within: the sum up to it, and from it on.
                let ends = [first, last].map(|end| end.clamp(from, to));
                let [below, above] = &mut sums;
                let seen = |l| observer::colour_matching(l).map(|m| radiance(l) * m);
                add_panel(below, from, ends[0], seen);
                add_panel(above, ends[1], to, seen);
                continue;
            }
        };
        for node in nodes {
            node.add(&mut sums[side], radiance(node.wavelength), node.xyz);
        }
    }
    let [below, above] = factors;
    let mut all = [[0.0; 3]; 3];
    for (k, xyz) in all.iter_mut().enumerate() {
        for (j, sum) in xyz.iter_mut().enumerate() {
            *sum = below[k] * sums[0][j] + above[k] * sums[1][j];
        }
    }
    Some(all)
}

#[inline]
fn between<const N: usize>(mut a: [f64; N], b: [f64; N], weight: f64) -> [f64; N] {
    for (a, b) in a.iter_mut().zip(b) {
        *a += (b - *a) * weight;
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::Spectrum;

    #[test]
    fn sums_are_the_integrals_that_spectra_have() {
        let primaries = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for continuation in [
            Continuation::Dark,
            Continuation::Edge,
            Continuation::Blackbody,
            Continuation::Companions,
        ] {
            // Ratios at which knots of both tables meet, and others; up to where the basis is out of view, and beyond.
            let ratios = (0..200).map(|k| libm::exp2((f64::from(k) - 100.0) / 60.0));
            for w in ratios.chain([
                0.5,
                1.0 + 1e-15,
                1.25,
                360.0 / 830.0,
                830.0 / 360.0,
                20.0,
                0.05,
            ]) {
                let sums = xyz_of_primaries(w, continuation);
                for (rgb, xyz) in primaries.into_iter().zip(sums) {
                    let expected = Spectrum::rgb(rgb, continuation).xyz_at(w);
                    let size = expected.iter().fold(1e-3, |a: f64, x| a.max(x.abs()));
                    for (sum, expected) in xyz.into_iter().zip(expected) {
                        let error = (sum - expected).abs() / size;
                        assert!(error < 1e-12, "{continuation:?} {w} {rgb:?}: {error:e}");
                    }
                }
            }
        }
    }
}
