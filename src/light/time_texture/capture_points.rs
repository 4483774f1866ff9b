//! Batched projection of points into a capture camera: [`TimeTexture::locate`] in loops.
//!
//! A block of points is projected; the pixels around each image point are gathered, and compared with the point; those that saw its
//! surface get their weights. The rest are points outside the image, behind the pinhole, or seen by no pixel. For other reconstructions,
//! each point is located by itself. Each operation is that of a single point, in its order, so that results are the same bit for bit.

use glam::DVec3;

use super::capture::{Aim, Capture, CapturePoint, Seen};
use super::places::{BATCH, integer, neighbours};
use super::texture::{Located, TimeTexture};
use crate::accel::vectors::{
    BLOCK, Block, Columns, NO_ROW, VectorLoop, Vectors, VectorsRef, dispatch, gather_rows, store,
};
use crate::camera::{AnyProjection, Projection};
use crate::scene::model::Reconstruction;

/// The points of a run as seen by a capture camera.
#[derive(Debug, Default)]
pub struct CapturePoints {
    /// By point, padded to a whole batch: whether the pixels that saw its surface can be read directly.
    is_plain: Vec<bool>,
    /// For those points: the indices of the four pixels around each, their weights, and the delay between emission and recording of each
    /// one's light, metres. Meaningless for other points.
    pub(super) texels: [Vec<f64>; 4],
    pub(super) weights: [Vec<f64>; 4],
    pub(super) delays: [Vec<f64>; 4],
    /// Whether they are outside the image, or behind the pinhole.
    is_beside: Vec<bool>,
    /// All points, if they are read one by one; empty if pixels are read directly.
    others: Vec<(u32, Located)>,
    /// Whether all points are plain.
    is_all_plain: bool,
    /// Scratch space for one block, allocated on first use.
    block: Option<Box<LocatedBlock>>,
}

impl CapturePoints {
    /// Whether each of the points is plain.
    pub(super) fn is_plain(&self) -> &[bool] {
        &self.is_plain
    }

    /// All points with their positions, if they must be read one by one; otherwise none.
    pub fn others(&self) -> &[(u32, Located)] {
        &self.others
    }

    /// Whether all points are plain.
    pub fn is_all_plain(&self) -> bool {
        self.is_all_plain
    }

    /// Whether point `at` is read directly from pixels that saw its surface.
    #[inline(always)]
    pub fn is_plain_at(&self, at: usize) -> bool {
        self.is_plain[at]
    }

    /// Whether it is outside the image, or behind the pinhole.
    #[inline(always)]
    pub fn is_beside_at(&self, at: usize) -> bool {
        self.is_beside[at]
    }

    /// Calls `each` with all points whose surface a pixel saw, in ascending order.
    #[inline(always)]
    pub fn each_seen(&self, mut each: impl FnMut(usize)) {
        for (k, is_plain) in self.is_plain.iter().enumerate() {
            if *is_plain {
                each(k);
            }
        }
        let seen = self.others.iter().filter(|(_, located)| located.is_seen());
        seen.for_each(|(k, _)| each(*k as usize));
    }

    /// Locates points at `positions` with `normals`; `singly` says that all are to be read one by one.
    pub(crate) fn locate(
        &mut self,
        texture: &TimeTexture,
        capture: &Capture,
        (positions, normals): (&Columns, &Columns),
        singly: bool,
    ) {
        let count = positions.len();
        let room = count.next_multiple_of(BATCH);
        self.others.clear();
        for column in [&mut self.is_plain, &mut self.is_beside] {
            column.clear();
            column.resize(room, false);
        }
        let singly = singly | (texture.reconstruction() == Reconstruction::Sharp);
        let mut plain = 0;
        let columns = [&mut self.texels, &mut self.weights, &mut self.delays];
        for column in columns.into_iter().flatten() {
            column.resize(room, 0.0);
        }
        let seen = &mut **self.block.get_or_insert_default();
        let mut begin = 0;
        while begin < count {
            let block = (positions.block(begin), normals.block(begin));
            // The usual projection has a loop compiled for it; the others share one.
            match capture.projection() {
                AnyProjection::Perspective(film) => {
                    dispatch(Locate::new(texture, capture, film, block, seen));
                }
                film => dispatch(Locate::new(texture, capture, film, block, seen)),
            }
            let now = (count - begin).min(BLOCK);
            if singly {
                for k in 0..now {
                    let place = seen.is_before[k].then_some([seen.place[0][k], seen.place[1][k]]);
                    let aim = seen.faces[k].then(|| seen.aim(k));
                    let located = texture.located(capture, place, aim);
                    self.others.push(((begin + k) as u32, located));
                }
                begin += BLOCK;
                continue;
            }
            self.is_beside[begin..begin + now].copy_from_slice(&seen.is_beside[..now]);
            // For some blocks no pixel can have seen anything.
            if seen.may_be_plain == [false; BLOCK] {
                begin += BLOCK;
                continue;
            }
            for (pixels, seen) in seen.pixels.iter().zip(&mut seen.seen) {
                gather_rows(capture.all_seen(), pixels, seen);
            }
            dispatch(Weigh(seen, capture));
            self.is_plain[begin..begin + now].copy_from_slice(&seen.is_plain[..now]);
            plain += seen.is_plain[..now].iter().filter(|plain| **plain).count();
            for tap in 0..4 {
                store(&seen.texels[tap], &mut self.texels[tap], begin);
                store(&seen.weights[tap], &mut self.weights[tap], begin);
                store(&seen.delays[tap], &mut self.delays[tap], begin);
            }
            begin += BLOCK;
        }
        self.is_all_plain = plain == count;
    }
}

/// A block of points as seen by the capture camera.
#[derive(Debug)]
struct LocatedBlock {
    /// Film points, and whether they are in front of the pinhole.
    place: [Block; 2],
    is_before: [bool; BLOCK],
    /// Positions and normals in the camera's axes, and whether the points face it.
    p: Vectors,
    n: Vectors,
    faces: [bool; BLOCK],
    /// Width of a pixel at the point.
    footprint: Block,
    /// Whether each is read directly if pixels saw its surface, and whether it is outside the image.
    may_be_plain: [bool; BLOCK],
    is_beside: [bool; BLOCK],
    /// The four pixels around each, [`NO_ROW`] for those to be skipped, and what they saw, word by word.
    pixels: [[u32; BLOCK]; 4],
    seen: [[[u32; BLOCK]; 8]; 4],
    /// As in [`CapturePoints`].
    is_plain: [bool; BLOCK],
    texels: [Block; 4],
    weights: [Block; 4],
    delays: [Block; 4],
}

impl Default for LocatedBlock {
    fn default() -> Self {
        LocatedBlock {
            place: [[0.0; BLOCK]; 2],
            is_before: [false; BLOCK],
            p: Vectors::ZERO,
            n: Vectors::ZERO,
            faces: [false; BLOCK],
            footprint: [0.0; BLOCK],
            may_be_plain: [false; BLOCK],
            is_beside: [false; BLOCK],
            pixels: [[NO_ROW; BLOCK]; 4],
            seen: [[[0; BLOCK]; 8]; 4],
            is_plain: [false; BLOCK],
            texels: [[0.0; BLOCK]; 4],
            weights: [[0.0; BLOCK]; 4],
            delays: [[0.0; BLOCK]; 4],
        }
    }
}

impl LocatedBlock {
    #[inline(always)]
    fn aim(&self, k: usize) -> Aim {
        Aim {
            position: self.p.get(k),
            normal: self.n.get(k),
            footprint: self.footprint[k],
        }
    }
}

/// The loops over the points of a block.
struct Locate<'a, P> {
    texture: &'a TimeTexture,
    capture: &'a Capture,
    film: &'a P,
    positions: VectorsRef<'a>,
    normals: VectorsRef<'a>,
    to: &'a mut LocatedBlock,
}

impl<'a, P> Locate<'a, P> {
    fn new(
        texture: &'a TimeTexture,
        capture: &'a Capture,
        film: &'a P,
        (positions, normals): (VectorsRef<'a>, VectorsRef<'a>),
        to: &'a mut LocatedBlock,
    ) -> Self {
        Locate {
            texture,
            capture,
            film,
            positions,
            normals,
            to,
        }
    }
}

impl<P: Projection> VectorLoop for Locate<'_, P> {
    #[inline(always)]
    fn run(self) {
        let block = self.to;
        block.project(self.capture, self.film, self.positions, self.normals);
        // Points that are read as means of pixels are left to single lookups.
        match self.texture.reconstruction() {
            Reconstruction::Sharp => {}
            Reconstruction::Bilinear | Reconstruction::Footprint => {
                block.find_taps(self.texture.size());
            }
        }
    }
}

/// The loop over the points of a block that weights the pixels around them.
struct Weigh<'a>(&'a mut LocatedBlock, &'a Capture);

impl VectorLoop for Weigh<'_> {
    #[inline(always)]
    fn run(self) {
        self.0.weigh(self.1);
    }
}

impl LocatedBlock {
    /// Projects the points into the capture camera.
    #[inline(always)]
    fn project<P: Projection>(
        &mut self,
        capture: &Capture,
        film: &P,
        positions: VectorsRef,
        normals: VectorsRef,
    ) {
        // Into separate arrays, so that the compiler knows they do not alias the inputs.
        let (mut x, mut y) = ([0.0; BLOCK], [0.0; BLOCK]);
        let (mut p, mut n) = (Vectors::ZERO, Vectors::ZERO);
        let mut footprint = [0.0; BLOCK];
        let (mut is_before, mut faces) = ([false; BLOCK], [false; BLOCK]);
        for k in 0..BLOCK {
            let point = CapturePoint {
                position: positions.get(k),
                normal: normals.get(k),
            };
            let (place, aim) = capture.look_at(film, &point);
            (is_before[k], [x[k], y[k]]) = match place {
                Some(place) => (true, place),
                None => (false, [0.0; 2]),
            };
            p.set(k, aim.position);
            n.set(k, aim.normal);
            footprint[k] = aim.footprint;
            faces[k] = is_before[k] & aim.faces();
        }
        (self.place, self.p, self.n) = ([x, y], p, n);
        (self.footprint, self.is_before, self.faces) = (footprint, is_before, faces);
    }

    /// The four pixels of an image of `size` (width, height) around each position, with their bilinear weights.
    #[inline(always)]
    fn find_taps(&mut self, size: [usize; 2]) {
        let [width, height] = size.map(|n| n as f64);
        for k in 0..BLOCK {
            let (x, y) = (self.place[0][k], self.place[1][k]);
            let on_image = (x >= 0.0) & (x <= width) & (y >= 0.0) & (y <= height);
            self.may_be_plain[k] = self.faces[k] & on_image;
            self.is_beside[k] = !(self.is_before[k] & on_image);
            let (left, right, fx) = neighbours(x, width - 1.0);
            let (top, bottom, fy) = neighbours(y, height - 1.0);
            let (top, bottom) = (top * width, bottom * width);
            self.texels[0][k] = top + left;
            self.texels[1][k] = top + right;
            self.texels[2][k] = bottom + left;
            self.texels[3][k] = bottom + right;
            self.weights[0][k] = (1.0 - fx) * (1.0 - fy);
            self.weights[1][k] = fx * (1.0 - fy);
            self.weights[2][k] = (1.0 - fx) * fy;
            self.weights[3][k] = fx * fy;
        }
        // In a separate loop: merged with the one above it would not vectorize.
        let mut tap = 0;
        while tap < 4 {
            for k in 0..BLOCK {
                let pixel = integer(self.texels[tap][k]) as u32;
                self.pixels[tap][k] = if self.may_be_plain[k] { pixel } else { NO_ROW };
            }
            tap += 1;
        }
    }

    /// Keeps only the weights of pixels that saw the point's surface, normalized to 1 if some are dropped.
    #[inline(always)]
    fn weigh(&mut self, capture: &Capture) {
        // Which taps saw the surface around each point, and the delay of each.
        let mut saw = [[false; BLOCK]; 4];
        let mut tap = 0;
        while tap < 4 {
            let words = &self.seen[tap];
            for (k, saw) in saw[tap].iter_mut().enumerate() {
                let seen = Seen::of_words([
                    words[0][k],
                    words[1][k],
                    words[2][k],
                    words[3][k],
                    words[4][k],
                    words[5][k],
                    words[6][k],
                    words[7][k],
                ]);
                let (place, normal) = (widened(seen.position), widened(seen.normal));
                // A distance of 0 stands for a pixel that saw nothing, and for pixels that are skipped.
                *saw = (seen.distance > 0.0) & self.aim(k).is_of(place, normal);
                self.delays[tap][k] = capture.delay_from(&seen);
            }
            tap += 1;
        }
        // Their weights, with sum 1; if no tap is dropped, unchanged.
        let mut k = 0;
        while k < BLOCK {
            let (mut sum, mut complete) = (0.0, true);
            let mut tap = 0;
            while tap < 4 {
                let weight = self.weights[tap][k];
                sum += if saw[tap][k] { weight } else { 0.0 };
                complete &= saw[tap][k];
                tap += 1;
            }
            let whole = if complete { 1.0 } else { sum };
            let mut tap = 0;
            while tap < 4 {
                let weight = if saw[tap][k] {
                    self.weights[tap][k]
                } else {
                    0.0
                };
                self.weights[tap][k] = weight / whole;
                tap += 1;
            }
            self.is_plain[k] = self.may_be_plain[k] & (complete | (sum > 0.0));
            k += 1;
        }
    }
}

#[inline(always)]
fn widened([x, y, z]: [f32; 3]) -> DVec3 {
    DVec3::new(f64::from(x), f64::from(y), f64::from(z))
}
