//! Detects which axis of an array is time, from the shapes of lines of samples along each.
//!
//! - Light at a point is brief: along time a pulse and its tail hold most of a line, along the axes of a picture many pixels do. The
//!   fraction of a line that holds 90 % of its light is 0.11 to 0.17 along T of the corner's captures and its lightmap, and 0.33 to 0.53
//!   along H and W. The assumed T is doubted if another axis has less than half of its fraction.
//! - Light that decays slowly fills T as much as the other axes. But it rises suddenly and falls gradually, while pictures have edges in
//!   both directions: with d the steps from sample to sample, Σ d³ / Σ |d|³ is near 1 along time and anywhere between −0.85 and 0.85 along
//!   pictures. Neighbours are joined in groups of 2, 4, 8 and 16, and the largest value is taken, because a pulse rises over some bins and
//!   noise has steps of both signs. For the corner's captures, nine baked textures and cubes of cameras with tails of 20 to 200 bins it is
//!   0.94 to 1.00 along T, at most 0.86 along H and W, and 0.1 to 0.4 along T of short symmetric pulses, whose light is brief.

use super::lines::{Lines, percent, spread};

/// An axis with fewer entries gives no evidence.
const FEWEST: usize = 8;
/// An axis along which light fills less than this fraction of the assumed one looks more like time.
const BRIEFER: f64 = 0.5;
/// Light that fills less than this of the assumed time axis is brief: the axis is time.
const BRIEF: f64 = 0.3;
/// Slow light rises by more than this along time, and by less than this minus the second along an axis of a picture.
const RISE: f64 = 0.85;
const LESS: f64 = 0.1;
/// A line that returns by less than this fraction of its range only rises or only falls, like gradients of pictures and light that is cut
/// off: it is no evidence for an axis or against it.
const BOTH: f64 = 0.1;
/// The maximum number of joined neighbours.
const JOINED: usize = 16;

/// Shapes of lines along an axis, averaged over lines that are not dark.
#[derive(Debug, Clone, Copy, Default)]
struct LineShape {
    /// The fraction that holds 90 % of the light.
    lit: f64,
    /// Σ d³ / Σ |d|³ of the steps from sample to sample: 1 if light rises suddenly and falls gradually, −1 for the reverse.
    rise: f64,
    /// The same with lines that only rise or only fall counted as 0.
    rise_and_fall: f64,
}

/// The warning if another axis looks more like time than the assumed one; `pictures` are assumed to be frames.
pub(super) fn doubt(lines: &mut Lines, pictures: bool) -> Option<String> {
    let [h, w, t, _] = lines.store.shape();
    if h.min(w).min(t) < FEWEST {
        return None;
    }
    let [rows, columns, time] = [0, 1, 2].map(|axis| shape(lines, axis));
    let (rows, columns, time) = (rows?, columns?, time?);
    let others = [(rows, "T H W"), (columns, "H T W")];
    let [first, second] = others;
    let briefer = if rows.lit < columns.lit {
        first
    } else {
        second
    };
    let rising = if rows.rise_and_fall > columns.rise_and_fall {
        first
    } else {
        second
    };
    let least = RISE.max(time.rise + LESS);
    let is_slow = rising.0.rise_and_fall > least && time.lit > BRIEF;
    let (what, order) = match (briefer.0.lit < BRIEFER * time.lit, is_slow) {
        (true, _) => (
            format!(
                "90 % of a line's light fill {} of the axis taken for T and only {} of another",
                percent(time.lit),
                percent(briefer.0.lit)
            ),
            briefer.1,
        ),
        (false, true) => (
            "light rises suddenly and falls gradually along another axis, as it does in time, and not along that taken for T".into(),
            rising.1,
        ),
        (false, false) => return None,
    };
    Some(match pictures {
        true => format!(
            "the pictures are taken for frames, but {what}: if they are streaks, each a row of the camera with time along x, say \
             axes = \"H W T\", and if they are frames, say axes = \"T H W\""
        ),
        false => format!(
            "the axes are taken for (H, W, T), but {what}: if the order is {order}, say axes = \"{order}\", and if it is \
             H W T, say that"
        ),
    })
}

/// The mean shape of lines along `axis`; `None` if all examined lines are dark.
fn shape(from: &mut Lines, axis: usize) -> Option<LineShape> {
    let [h, w, t, _] = from.store.shape();
    // The sizes of the two other axes and of this one, and how to map them to a pixel and a bin.
    let (others, length): (_, usize) = match axis {
        0 => ([w, t], h),
        1 => ([h, t], w),
        _ => ([h, w], t),
    };
    let place = |a: usize, b: usize, n: usize| match axis {
        0 => (n * w + a, b),
        1 => (a * w + n, b),
        _ => (a * w + b, n),
    };
    // All lines use the same joining: the largest mean, not the mean of the largest values.
    let joined: Vec<usize> = (0..)
        .map(|power| 1 << power)
        .take_while(|n| *n <= JOINED && length / n >= FEWEST)
        .collect();
    // One line is held at a time: some are as long as the data.
    let mut values = vec![0.0; length];
    let mut lines = Vec::new();
    for line in spread(others[0] * others[1], from.lines()) {
        let (a, b) = (line / others[1], line % others[1]);
        match axis {
            2 => from.read(a * w + b, 0, &mut values),
            _ => {
                for (n, value) in values.iter_mut().enumerate() {
                    let (pixel, bin) = place(a, b, n);
                    from.read(pixel, bin, std::slice::from_mut(value));
                }
            }
        }
        values.iter_mut().for_each(|value| *value = value.abs());
        let rises = joined.iter().map(|n| rise(&values, *n)).collect();
        lines.push((values.iter().sum::<f64>(), lit_part(&values), rises));
    }
    let mean = lines.iter().map(|line| line.0).sum::<f64>() / lines.len() as f64;
    // Lines with little light are mostly noise.
    lines.retain(|line| line.0 > 0.1 * mean);
    let mean =
        |of: &dyn Fn(&LineNumbers) -> f64| lines.iter().map(of).sum::<f64>() / lines.len() as f64;
    let greatest = |of: &dyn Fn(&LineNumbers, usize) -> f64| {
        let means = (0..joined.len()).map(|n| mean(&|line| of(line, n)));
        means.fold(-1.0, f64::max)
    };
    (!lines.is_empty()).then(|| LineShape {
        lit: mean(&|line| line.1),
        rise: greatest(&|line, n| line.2[n][0]),
        rise_and_fall: greatest(&|line, n| line.2[n][1]),
    })
}

/// For one line: its light, the fraction that holds 90 % of it, and its rises by number of joined neighbours.
type LineNumbers = (f64, f64, Vec<[f64; 2]>);

/// The fraction of a line that holds 90 % of its light.
fn lit_part(line: &[f64]) -> f64 {
    let mut values = line.to_vec();
    values.sort_unstable_by(|a, b| b.total_cmp(a));
    // Brightest first, until 90 % of the light is reached.
    let mut left = 0.9 * values.iter().sum::<f64>();
    let lit = values.iter().take_while(|&&value| {
        left -= value;
        left > 0.0
    });
    (lit.count() + 1) as f64 / line.len() as f64
}

/// Σ d³ / Σ |d|³ of the steps between sums of `joined` neighbours; and the same, but 0 for a line that only rises or only falls.
fn rise(line: &[f64], joined: usize) -> [f64; 2] {
    let sums: Vec<f64> = (line.chunks_exact(joined))
        .map(|part| part.iter().sum())
        .collect();
    let steps: Vec<f64> = sums.windows(2).map(|pair| pair[1] - pair[0]).collect();
    // Relative to the largest step, so that cubes are finite.
    let greatest = steps
        .iter()
        .fold(0.0, |most: f64, step| most.max(step.abs()));
    if greatest == 0.0 {
        return [0.0; 2];
    }
    let way = |sign: f64| steps.iter().map(|step| (sign * step).max(0.0)).sum::<f64>();
    let [up, down] = [1.0, -1.0].map(way);
    let cubes = || steps.iter().map(|step| (step / greatest).powi(3));
    let rise = cubes().sum::<f64>() / cubes().map(f64::abs).sum::<f64>();
    match up.min(down) <= BOTH * up.max(down) {
        true => [rise, 0.0],
        false => [rise; 2],
    }
}
