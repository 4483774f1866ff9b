//! First arrivals of light from surface points, which reveal a wrong bin width, a wrong start, or a missing near plane.
//!
//! - The times at which light first reaches two points differ by no more than the time of light from one to the other, whatever lights
//!   them: otherwise the bin width is not as stated.
//! - If one flash at a place s lit everything, light that was recorded t after the start o of the data, with d the delay from a point x to
//!   the camera, obeys t + o − d = η|s − x| + f, where f is the time of the flash. With e = (t − d)/η and p = (o − f)/η its square is linear
//!   in p, s and p² − s²: 2 e p + 2 s·x + (p² − s²) = x² − e². Points in shadow do not obey this, so the half that fits best is fitted again.
//! - Rays that begin on a near plane at depth n record times that lack its distance n / cos θ, so e is too small by that: the flash appears
//!   to be early by about n. The n that puts it at time 0 would explain that.

use glam::DVec3;

use super::lines::{percent, rounded, spread};

/// Fewer bins or points are no evidence.
const FEWEST: usize = 8;
/// Enough pixels to judge a picture.
const ENOUGH: usize = 256;
/// The least light of a bright point, as a fraction of that of the brightest.
const BRIGHT: f64 = 0.05;
/// The precision of times of first light, bins.
const ROUGH: f64 = 4.0;
/// A flash earlier by fewer bins than this may be at time 0.
const EARLY: f64 = 2.0;
/// The tolerated fraction of pairs that are too fast: first light in shadow comes from elsewhere, and is faint.
const FAST: f64 = 0.2;

/// First light from the points that a capture camera saw.
pub(super) struct FirstLight {
    points: Vec<Onset>,
    /// Width of a bin, metres.
    width: f64,
    /// η of the medium.
    index: f64,
}

struct Onset {
    /// In bins from the start of the data.
    bin: f64,
    /// The bin at which first light is brightest: the middle of a flash.
    peak: f64,
    /// The largest light of a bin.
    brightest: f64,
    /// In the camera's axes, from its pinhole.
    position: DVec3,
    /// The delay from leaving the point to being recorded, metres.
    delay: f64,
}

/// A flash that first light fits.
struct Flash {
    /// The start of the data that would put it at time 0, metres.
    start: f64,
    /// The error of the worst of the better half of points, metres of light path.
    off: f64,
}

impl FirstLight {
    pub(super) fn new(width: f64, index: f64) -> FirstLight {
        FirstLight {
            points: Vec::new(),
            width,
            index,
        }
    }

    /// Records the samples along time of a pixel that saw `position`, whose light is recorded `delay` metres later.
    pub(super) fn note(&mut self, line: &[f64], position: DVec3, delay: f64) {
        let brightest = line.iter().copied().fold(0.0, f64::max);
        let first = line.iter().position(|value| *value > 0.25 * brightest);
        let climb = |first: usize| {
            let pairs = line[first..]
                .windows(2)
                .take_while(|pair| pair[1] > pair[0]);
            first + pairs.count()
        };
        self.points.extend(first.map(|bin| Onset {
            bin: bin as f64,
            peak: climb(bin) as f64,
            brightest,
            position,
            delay,
        }));
    }

    /// The fraction of pairs of points between which first light would have been faster than light, for bins of `width`.
    fn too_fast(&self, width: f64) -> f64 {
        let some = self.bright();
        let left = |onset: &Onset| onset.bin * width - onset.delay;
        let (mut pairs, mut fast) = (0usize, 0usize);
        for (n, one) in some.iter().enumerate() {
            for other in &some[..n] {
                let way = self.index * (one.position - other.position).length();
                pairs += 1;
                fast += usize::from((left(one) - left(other)).abs() > way + ROUGH * width);
            }
        }
        fast as f64 / pairs.max(1) as f64
    }

    /// The single flash that fits first light, if rays begin on a plane that is `deeper` than declared.
    fn flash(&self, deeper: f64) -> Option<Flash> {
        let rows: Vec<[f64; 6]> = (self.bright().into_iter())
            .map(|onset| {
                let x = onset.position;
                // n / cos θ, where the axis of the camera is z.
                let skipped = deeper * x.length() / x.z;
                let e = ((onset.peak + 0.5) * self.width - onset.delay) / self.index + skipped;
                let right = x.length_squared() - e * e;
                [2.0 * e, 2.0 * x.x, 2.0 * x.y, 2.0 * x.z, 1.0, right]
            })
            .collect();
        let mut kept: Vec<&[f64; 6]> = rows.iter().collect();
        let mut found = None;
        for _ in 0..8 {
            let solved = least_squares(&kept)?;
            let [p, x, y, z, _] = solved;
            // The error of a point in metres: the row is the difference of two squares.
            let off = |row: &[f64; 6]| {
                let at = DVec3::new(row[1], row[2], row[3]) * 0.5;
                ((0.5 * row[0] + p) - at.distance(DVec3::new(x, y, z))).abs()
            };
            let mut by_error: Vec<_> = rows.iter().map(|row| (off(row), row)).collect();
            by_error.sort_by(|a, b| a.0.total_cmp(&b.0));
            by_error.truncate(rows.len() / 2);
            let off = by_error.last()?.0 * self.index;
            found = (off < ROUGH * self.width).then_some(Flash {
                start: p * self.index,
                off,
            });
            kept = by_error.into_iter().map(|(_, row)| row).collect();
        }
        found
    }

    /// The warning if first light is that of one flash before time 0, for data that begin at `start`.
    pub(super) fn early_flash(&self, start: f64) -> Option<String> {
        let early = self.flash(0.0)?.start - start;
        if self.points.len() < FEWEST || early < EARLY * self.width {
            return None;
        }
        Some(format!(
            "first light is that of one flash, {} m before time 0: if the flash was at time 0, {} would fit",
            self.in_bins(early),
            self.explained(start)?
        ))
    }

    /// The keys for which first light is that of one flash at time 0, for data that begin at `start`; `None` if no flash fits.
    pub(super) fn explained(&self, start: f64) -> Option<String> {
        let flash = self.flash(0.0)?;
        let other = format!("start = \"{} m\"", self.in_bins(flash.start));
        // Another start fits as well if no angles distinguish them.
        let near_plane = self
            .near_plane(start)
            .filter(|(_, off)| *off < 1.5 * flash.off);
        Some(match near_plane {
            Some((depth, _)) => format!(
                "capture.near_clip = {} (as rays of Mitsuba begin on a near plane) or {other}",
                self.in_bins(depth)
            ),
            None => other,
        })
    }

    /// The nearest multiple of the bin width, to which times of first light are known.
    fn in_bins(&self, time: f64) -> f64 {
        rounded((time / self.width).round() * self.width)
    }

    /// The depth of a near plane for which first light is that of a flash at time 0, for data that begin at `start`, and its error in
    /// metres; `None` if the plane would lie behind what was seen.
    fn near_plane(&self, start: f64) -> Option<(f64, f64)> {
        let nearest = self.points.iter().fold(f64::INFINITY, |least: f64, point| {
            least.min(point.position.z)
        });
        let mut depth = 0.0;
        // The flash moves by η times the depth, except for the cosines: each step leaves a small part of the error.
        for _ in 0..16 {
            let flash = self.flash(depth)?;
            let early = (flash.start - start) / self.index;
            depth += early;
            if early.abs() < 0.01 * self.width {
                return (0.0..nearest)
                    .contains(&depth)
                    .then_some((depth, flash.off));
            }
        }
        None
    }

    /// Points well above darkness, evenly spread.
    fn bright(&self) -> Vec<&Onset> {
        let brightest =
            (self.points.iter()).fold(0.0, |most: f64, onset| most.max(onset.brightest));
        let bright: Vec<_> = (self.points.iter())
            .filter(|onset| onset.brightest > BRIGHT * brightest)
            .collect();
        spread(bright.len(), ENOUGH).map(|at| bright[at]).collect()
    }

    /// The warning if light would have been faster than light with this bin width.
    pub(super) fn too_wide(&self) -> Option<String> {
        let now = self.too_fast(self.width);
        if self.points.len() < FEWEST || now < FAST {
            return None;
        }
        let what = format!(
            "between {} of the points, light would have had to travel faster than c, by the times of first light",
            percent(now)
        );
        let power =
            (1..=15).find(|power| self.too_fast(self.width * 10f64.powi(-power)) < FAST / 4.0);
        let fit = power.map(|power| {
            let width = rounded(self.width * 10f64.powi(-power));
            format!("; in a unit 10^-{power} times as long it would fit: bin_width = \"{width} m\"")
        });
        Some(format!(
            "{what}: check bin_width (now {} m){}",
            rounded(self.width),
            fit.unwrap_or_default()
        ))
    }
}

/// The unknowns a of rows a·row = right (the last entry), by normal equations; `None` if these are singular.
fn least_squares(rows: &[&[f64; 6]]) -> Option<[f64; 5]> {
    let mut m = [[0.0; 6]; 5];
    for row in rows {
        for (i, line) in m.iter_mut().enumerate() {
            for (k, sum) in line.iter_mut().enumerate() {
                *sum += row[i] * row[k];
            }
        }
    }
    let scale = m
        .iter()
        .flatten()
        .fold(0.0, |most: f64, entry| most.max(entry.abs()));
    // Gauss–Jordan elimination with pivoting; a pivot below 1e-12 of the largest entry is rounding.
    for i in 0..5 {
        let pivot = (i..5).max_by(|a, b| m[*a][i].abs().total_cmp(&m[*b][i].abs()))?;
        m.swap(i, pivot);
        let line = m[i];
        if line[i].abs() <= 1e-12 * scale {
            return None;
        }
        for (_, other) in m.iter_mut().enumerate().filter(|(k, _)| *k != i) {
            let part = other[i] / line[i];
            other
                .iter_mut()
                .zip(line)
                .for_each(|(entry, by)| *entry -= part * by);
        }
    }
    Some(std::array::from_fn(|i| m[i][5] / m[i][i]))
}
