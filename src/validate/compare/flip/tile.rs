//! One tile of both pictures, at one exposure after the other.
//!
//! Rows pass through the horizontal filters into ring buffers as high as the vertical filters; a row of errors is computed as soon as its
//! ring is full. All of a tile fits in a core's own cache.

use super::colour::{
    OPPONENT, apply, clip, hunt_lab, hyab, lab, power, power_of_definition, tone_map,
};
use super::filter::Filters;
use crate::accel::vectors::VectorLoop;
use crate::colour::srgb_decode;
use crate::validate::compare::options::Region;
use crate::validate::compare::picture::Plane;

/// Columns of a tile; a multiple of the lanes.
pub(super) const WIDTH: usize = 512;
/// Rows of a tile.
pub(super) const HEIGHT: usize = 256;
/// Pixels that are computed together.
const LANES: usize = 16;
/// Components stored for a row after the horizontal filters: luminance, red-green, blue-yellow twice, then the first and second derivative
/// and the smoothed luminance.
const KEPT: usize = 7;

/// From the definition: differences up to 0.4 of the largest map to errors up to 0.95.
const LARGE_PART: f32 = 0.4;
const LARGE_ERROR: f32 = 0.95;

type Lanes = [f32; LANES];

/// The input of ꟻLIP.
#[derive(Debug, Clone, Copy)]
pub(in crate::validate::compare) struct Question<'a> {
    /// Linear red, green and blue of the reference.
    pub reference: [Plane<'a>; 3],
    /// The candidate's.
    pub candidate: [Plane<'a>; 3],
    /// Columns and rows.
    pub size: [usize; 2],
    /// Pixels over which the mean is taken.
    pub region: &'a Region,
    /// Whether values above 1 are light that an exposure can show.
    pub high_range: bool,
    /// Whether values are sRGB codes.
    pub encoded: bool,
    /// Pixels per degree of visual angle.
    pub pixels_per_degree: f64,
    /// Whether the map is requested.
    pub map: bool,
}

/// Errors of a tile's pixels in the region.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sum {
    pub sum: f64,
    pub count: u64,
    pub max: f32,
}

/// A tile under evaluation.
pub(super) struct Tile<'a> {
    question: &'a Question<'a>,
    filters: &'a Filters,
    corner: [usize; 2],
    size: [usize; 2],
    tone_mapped: bool,
    /// The largest colour difference, green to blue, raised to the power of the definition.
    largest: f32,
    /// Errors so far, `WIDTH` per row.
    errors: Vec<f32>,
    rings: [Ring; 2],
    /// Whether each pixel of a row is not a number in one of the pictures.
    unusable: Vec<bool>,
    /// Offsets of the rings' rows, from the uppermost on.
    starts: Vec<usize>,
}

/// Rows of one picture after the horizontal filters.
struct Ring {
    rows: [Vec<f32>; KEPT],
    /// The row being filtered, with its margins: Y + 16, Cx, Cz.
    source: [Vec<f32>; 3],
    light: [Vec<f32>; 3],
}

/// A finished tile.
pub(super) struct Done {
    pub sum: Sum,
    corner: [usize; 2],
    size: [usize; 2],
    errors: Vec<f32>,
}

/// A tile at several exposures.
pub(super) struct Exposing<'t, 'a> {
    pub tile: &'t mut Tile<'a>,
    /// Factors on light.
    pub gains: &'t [f32],
}

impl VectorLoop for Exposing<'_, '_> {
    #[inline(always)]
    fn run(self) {
        for gain in self.gains {
            self.tile.expose(*gain);
        }
    }
}

impl<'a> Tile<'a> {
    /// The buffers of a tile: for each picture a ring with as many rows as the filters are high.
    pub fn new(
        question: &'a Question<'a>,
        filters: &'a Filters,
        corner: [usize; 2],
        tone_mapped: bool,
    ) -> Self {
        let [width, height] = question.size;
        let ring = || Ring {
            rows: std::array::from_fn(|_| vec![0.0; (2 * filters.radius + 1) * WIDTH]),
            source: std::array::from_fn(|_| vec![0.0; WIDTH + 2 * filters.radius]),
            light: std::array::from_fn(|_| vec![0.0; width.min(WIDTH + 2 * filters.radius)]),
        };
        let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(hunt_lab);
        Tile {
            question,
            filters,
            corner,
            size: [WIDTH.min(width - corner[0]), HEIGHT.min(height - corner[1])],
            tone_mapped,
            largest: power_of_definition(hyab(green, blue)),
            errors: vec![0.0; WIDTH * HEIGHT],
            rings: [ring(), ring()],
            unusable: Vec::new(),
            starts: Vec::new(),
        }
    }

    /// Includes the errors at an exposure: light is multiplied by `gain`.
    #[inline(always)]
    fn expose(&mut self, gain: f32) {
        let radius = self.filters.radius;
        for row in 0..self.size[1] + 2 * radius {
            self.take(row, gain);
            if row >= 2 * radius {
                self.give(row - 2 * radius);
            }
        }
    }

    /// Applies the horizontal filters to row `row` of the tile with its margins.
    #[inline(always)]
    fn take(&mut self, row: usize, gain: f32) {
        let radius = self.filters.radius;
        let [left, top] = self.corner;
        let y = (top + row)
            .saturating_sub(radius)
            .min(self.question.size[1] - 1);
        let pictures = [&self.question.reference, &self.question.candidate];
        self.unusable.clear();
        self.unusable.resize(WIDTH + 2 * radius, false);
        for (ring, planes) in self.rings.iter_mut().zip(pictures) {
            ring.load(planes, y, left, radius, self.question);
            let [r, g, b] = &ring.light;
            let count = r.len();
            let (g, b, unusable) = (&g[..count], &b[..count], &mut self.unusable[..count]);
            for x in 0..count {
                unusable[x] |= !(r[x] + g[x] + b[x]).is_finite();
            }
        }
        let slot = row % (2 * radius + 1);
        for ring in &mut self.rings {
            ring.prepare(
                &self.unusable,
                left,
                radius,
                self.tone_mapped.then_some(gain),
            );
            ring.filter(slot, self.filters);
        }
    }

    /// Computes row `row` of the tile's errors from the rings.
    #[inline(always)]
    fn give(&mut self, row: usize) {
        let size = 2 * self.filters.radius + 1;
        self.starts.clear();
        self.starts
            .extend((row..row + size).map(|row| row % size * WIDTH));
        let [reference, candidate] = &self.rings;
        let errors = &mut self.errors[row * WIDTH..(row + 1) * WIDTH];
        for (x, errors) in (0..WIDTH)
            .step_by(LANES)
            .zip(errors.as_chunks_mut::<LANES>().0)
        {
            if x >= self.size[0] {
                break;
            }
            let r = reference.column(x, &self.starts, self.filters);
            let c = candidate.column(x, &self.starts, self.filters);
            for lane in 0..LANES {
                let r = [r[0][lane], r[1][lane], r[2][lane], r[3][lane], r[4][lane]];
                let c = [c[0][lane], c[1][lane], c[2][lane], c[3][lane], c[4][lane]];
                // HDR-ꟻLIP is the largest error over all exposures.
                let error = error(r, c, self.largest);
                errors[lane] = if error > errors[lane] {
                    error
                } else {
                    errors[lane]
                };
            }
        }
    }

    /// The errors, and their sum over the region.
    pub fn finish(self, region: &Region) -> Done {
        let mut sum = Sum::default();
        let [left, top] = self.corner;
        for y in 0..self.size[1] {
            let chosen = (!region.is_all()).then(|| region.row(top + y, self.question.size[0]));
            for x in 0..self.size[0] {
                let error = self.errors[y * WIDTH + x];
                if chosen.as_ref().is_none_or(|chosen| chosen[left + x]) {
                    sum.sum += f64::from(error);
                    sum.count += 1;
                    sum.max = sum.max.max(error);
                }
            }
        }
        Done {
            sum,
            corner: self.corner,
            size: self.size,
            errors: self.errors,
        }
    }
}

impl Done {
    /// Copies the errors into a map with rows of `width`.
    pub fn place(&self, map: &mut [f32], width: usize) {
        for y in 0..self.size[1] {
            let start = (self.corner[1] + y) * width + self.corner[0];
            let row = &self.errors[y * WIDTH..y * WIDTH + self.size[0]];
            map[start..start + row.len()].copy_from_slice(row);
        }
    }
}

impl Ring {
    /// Reads row `y` from the tile's left margin on, as far as it exists.
    #[inline(always)]
    fn load(
        &mut self,
        planes: &[Plane; 3],
        y: usize,
        left: usize,
        radius: usize,
        question: &Question,
    ) {
        let first = left.saturating_sub(radius);
        let last = (left + WIDTH + radius).min(question.size[0]);
        for (plane, light) in planes.iter().zip(&mut self.light) {
            light.resize(last - first, 0.0);
            plane.part(y, first..last, light);
            if question.encoded {
                light
                    .iter_mut()
                    .for_each(|code| *code = srgb_decode((*code).into()) as f32);
            }
        }
    }

    /// Light → Y + 16, Cx, Cz as shown on a display, with margins.
    #[inline(always)]
    fn prepare(&mut self, unusable: &[bool], left: usize, radius: usize, gain: Option<f32>) {
        let first = left.saturating_sub(radius);
        let Ring {
            light: [r, g, b],
            source,
            ..
        } = self;
        let count = r.len();
        let rgb = [&mut r[..], &mut g[..count], &mut b[..count]];
        match gain {
            Some(gain) => oppose(rgb, &unusable[..count], |x| tone_map(x * gain)),
            None => oppose(rgb, &unusable[..count], |x| x),
        }
        let before = first + radius - left;
        for (light, source) in [r, g, b].into_iter().zip(source) {
            let end = (before + count).min(source.len());
            source[..before].fill(light[0]);
            source[before..end].copy_from_slice(&light[..end - before]);
            source[end..].fill(light[count - 1]);
        }
    }

    /// The horizontal filters, into `slot` of the ring.
    #[inline(always)]
    fn filter(&mut self, slot: usize, filters: &Filters) {
        let Ring {
            rows,
            source: [y, cx, cz],
            ..
        } = self;
        let [sy, sx, sz1, sz2] = &filters.sensitivity;
        let plan: [(&[f32], &[f32], f32); KEPT] = [
            (y, sy, 1.0),
            (cx, sx, 1.0),
            (cz, sz1, 1.0),
            (cz, sz2, 1.0),
            (y, &filters.edge, -1.0),
            (y, &filters.point, 1.0),
            (y, &filters.smooth, 1.0),
        ];
        for ((source, half, sign), rows) in plan.into_iter().zip(rows) {
            let row = &mut rows[slot * WIDTH..(slot + 1) * WIDTH];
            for (x, sums) in row.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
                let centre = x * LANES + filters.radius;
                *sums = along(source, centre, half, sign);
            }
        }
    }

    /// The vertical filters at the columns from `x` on: Y + 16, Cx, Cz, and the strengths of edge and point, times 116.
    #[inline(always)]
    fn column(&self, x: usize, starts: &[usize], filters: &Filters) -> [Lanes; 5] {
        let [sy, sx, sz1, sz2] = &filters.sensitivity;
        let (smooth, edge, point) = (&filters.smooth, &filters.edge, &filters.point);
        let [cz1, cz2] = [
            self.down(2, sz1, 1.0, x, starts),
            self.down(3, sz2, 1.0, x, starts),
        ];
        let [dx, ddx] = [
            self.down(4, smooth, 1.0, x, starts),
            self.down(5, smooth, 1.0, x, starts),
        ];
        let [dy, ddy] = [
            self.down(6, edge, -1.0, x, starts),
            self.down(6, point, 1.0, x, starts),
        ];
        let mut found = [
            self.down(0, sy, 1.0, x, starts),
            self.down(1, sx, 1.0, x, starts),
            cz1,
            dx,
            ddx,
        ];
        for lane in 0..LANES {
            // Cz is the sum of two filters.
            found[2][lane] += cz2[lane];
            found[3][lane] = (dx[lane] * dx[lane] + dy[lane] * dy[lane]).sqrt();
            found[4][lane] = (ddx[lane] * ddx[lane] + ddy[lane] * ddy[lane]).sqrt();
        }
        found
    }

    /// One vertical filter at the columns from `x` on; `starts` are the offsets of the ring's rows, from the uppermost on.
    #[inline(always)]
    fn down(&self, kept: usize, half: &[f32], sign: f32, x: usize, starts: &[usize]) -> Lanes {
        let (rows, middle) = (&self.rows[kept], starts.len() / 2);
        let centre = lanes(rows, starts[middle] + x);
        let mut sums = [0.0; LANES];
        for lane in 0..LANES {
            sums[lane] = half[0] * centre[lane];
        }
        for (i, weight) in half.iter().enumerate().skip(1) {
            let after = lanes(rows, starts[middle + i] + x);
            let before = lanes(rows, starts[middle - i] + x);
            for lane in 0..LANES {
                sums[lane] += weight * (after[lane] + sign * before[lane]);
            }
        }
        sums
    }
}

/// Light in RGB → display value → Y + 16, Cx, Cz; black where it is unusable.
#[inline(always)]
fn oppose([r, g, b]: [&mut [f32]; 3], unusable: &[bool], show: impl Fn(f32) -> f32) {
    let count = unusable.len();
    let (r, g, b) = (&mut r[..count], &mut g[..count], &mut b[..count]);
    for x in 0..count {
        let usable = |light: f32| if unusable[x] { 0.0 } else { light };
        let rgb = [usable(r[x]), usable(g[x]), usable(b[x])];
        let shown = [show(rgb[0]), show(rgb[1]), show(rgb[2])];
        [r[x], g[x], b[x]] = apply(&OPPONENT, [clip(shown[0]), clip(shown[1]), clip(shown[2])]);
    }
}

/// The filter with the weights `half` to the right, and `sign` times these to the left, at `centre` and the following pixels.
#[inline(always)]
fn along(row: &[f32], centre: usize, half: &[f32], sign: f32) -> Lanes {
    let middle = lanes(row, centre);
    let mut sums = [0.0; LANES];
    for lane in 0..LANES {
        sums[lane] = half[0] * middle[lane];
    }
    for (i, weight) in half.iter().enumerate().skip(1) {
        let (after, before) = (lanes(row, centre + i), lanes(row, centre - i));
        for lane in 0..LANES {
            sums[lane] += weight * (after[lane] + sign * before[lane]);
        }
    }
    sums
}

#[inline(always)]
fn lanes(row: &[f32], start: usize) -> Lanes {
    row[start..].first_chunk().copied().unwrap_or([0.0; LANES])
}

/// ꟻLIP of one pixel from both pictures' Y + 16, Cx, Cz, edge and point.
#[inline(always)]
fn error(r: [f32; 5], c: [f32; 5], largest: f32) -> f32 {
    // Colour: the HyAB distance; differences up to 0.4 of the largest map to errors up to 0.95.
    let difference = power_of_definition(hyab(lab(&r), lab(&c)));
    let large = LARGE_PART * largest;
    let small = difference * (LARGE_ERROR / large);
    let beyond = LARGE_ERROR + (difference - large) / (largest - large) * (1.0 - LARGE_ERROR);
    let colour = if difference < large { small } else { beyond };
    // Features: the larger change of edges and points, normalised by √2, to the power ½.
    let (edge, point) = ((r[3] - c[3]).abs(), (r[4] - c[4]).abs());
    let feature = if edge > point { edge } else { point };
    let feature = (feature * (std::f32::consts::FRAC_1_SQRT_2 / 116.0)).sqrt();
    // ꟻLIP = ΔEc^(1 − ΔEf).
    power(colour, 1.0 - feature)
}
