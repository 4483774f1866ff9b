//! Detects which axis of an array is time, from the shapes of lines of samples along each.
//!
//! - Light at a place is brief: along time a pulse and its tail hold most of a line, along the axes of a picture many pixels do. How large a
//!   part of a line holds 90 % of its light is 0.11 to 0.17 along T of the corner's captures and its lightmap, and 0.33 to 0.53 along H
//!   and W. What was assumed to be T is doubted where another axis has less than half of its part.
//! - Light that decays slowly fills as much of T as of the others. But it rises at once and falls gradually, and pictures have edges up and
//!   down: with d the steps from sample to sample, Σ d³ / Σ |d|³ is near 1 along time and anywhere between −0.85 and 0.85 along
//!   pictures. Neighbours are joined, by 2, 4, 8 and 16, and the greatest value is taken, as a pulse rises over some bins and noise has steps
//!   of both signs. Of the corner's captures, nine baked textures and cubes of cameras with tails of 20 to 200 bins it is 0.94 to 1.00 along T,
//!   0.86 at most along H and W, and 0.1 to 0.4 along T of short symmetric pulses, whose light is brief.

use super::lines::{Lines, percent, spread};

/// Fewer entries along an axis are no evidence.
const FEWEST: usize = 8;
/// An axis along which light fills less than this fraction of the assumed one looks more like time.
const BRIEFER: f64 = 0.5;
/// Light that fills less of the axis taken for time is brief: that is time.
const BRIEF: f64 = 0.3;
/// Along time slow light rises by more than this, and along an axis of a picture by that much less.
const RISE: f64 = 0.85;
const LESS: f64 = 0.1;
/// A line that comes back by less of its way only rises or only falls, as gradients of pictures do, and light that is cut off: it tells
/// nothing for an axis and nothing against it.
const BOTH: f64 = 0.1;
/// The most neighbours that are joined.
const JOINED: usize = 16;

/// Shapes of lines along an axis, in the mean over lines that are not dark.
#[derive(Debug, Clone, Copy, Default)]
struct LineShape {
    /// The part that holds 90 % of the light.
    lit: f64,
    /// Σ d³ / Σ |d|³ of the steps from sample to sample: 1 where light rises suddenly and falls gradually, −1 where the reverse.
    rise: f64,
    /// The same where lines that only rise or only fall count as 0.
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

/// The mean shape of lines along `axis`; none where all that are looked at are dark.
fn shape(from: &mut Lines, axis: usize) -> Option<LineShape> {
    let [h, w, t, _] = from.store.shape();
    // The sizes of the two other axes and of this one, and how to get from them to a pixel and a bin.
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
    // Lines are joined alike: the greatest mean, not the mean of greatest ones.
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
        let rises = |both| -> Vec<f64> { joined.iter().map(|n| rise(&values, *n, both)).collect() };
        let (alone, and_fall) = (rises(false), rises(true));
        lines.push((
            values.iter().sum::<f64>(),
            lit_part(&values),
            alone,
            and_fall,
        ));
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
        rise: greatest(&|line, n| line.2[n]),
        rise_and_fall: greatest(&|line, n| line.3[n]),
    })
}

/// Of one line: its light, the part that holds 90 % of it, and its rises by how many neighbours are joined, as they are and with a fall.
type LineNumbers = (f64, f64, Vec<f64>, Vec<f64>);

/// The part of a line that holds 90 % of its light.
fn lit_part(line: &[f64]) -> f64 {
    let mut values = line.to_vec();
    values.sort_by(|a, b| b.total_cmp(a));
    // Brightest first, until 90 % of the light is reached.
    let mut left = 0.9 * values.iter().sum::<f64>();
    let lit = values.iter().take_while(|&&value| {
        left -= value;
        left > 0.0
    });
    (lit.count() + 1) as f64 / line.len() as f64
}

/// Σ d³ / Σ |d|³ of the steps between sums of `joined` neighbours; with `both` 0 of a line that only rises or only falls.
fn rise(line: &[f64], joined: usize, both: bool) -> f64 {
    let sums: Vec<f64> = (line.chunks_exact(joined))
        .map(|part| part.iter().sum())
        .collect();
    let steps = || sums.windows(2).map(|pair| pair[1] - pair[0]);
    // By the greatest step, so that cubes are finite.
    let greatest = steps().fold(0.0, |most: f64, step| most.max(step.abs()));
    let way = |sign: f64| steps().map(|step| (sign * step).max(0.0)).sum::<f64>();
    let [up, down] = [1.0, -1.0].map(way);
    if greatest == 0.0 || (both && up.min(down) <= BOTH * up.max(down)) {
        return 0.0;
    }
    let cubes = || steps().map(|step| (step / greatest).powi(3));
    cubes().sum::<f64>() / cubes().map(f64::abs).sum::<f64>()
}
