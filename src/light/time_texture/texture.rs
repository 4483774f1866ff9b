//! One time-resolved texture: a cube, its time axis, and the substitutes for missing data.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::scene::model::{CubeBacks, Fill, Outside, Reconstruction};

use super::axis::TimeAxis;
use super::axis::{Moment, Phase, Timeline};
use super::bilinear::{Tap, taps};
use super::capture::{Aim, Capture, CapturePoint};
use super::coverage::Coverage;
use super::near::Near;
use super::reader;
use super::spans::{PrefixSums, Span};
use super::weights::bins_of;
use crate::io::cube::{CubeError, CubeStore};

/// The answer to one lookup.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sampled {
    /// Emitted radiance per metre of ct, linear RGB; to be multiplied by the observer's factors.
    /// May be negative beside a step in time (cubic filter).
    pub radiance: [f64; 3],
    /// Colour that marks missing data ([`Fill::Mark`]), already weighted by how much is missing; to be
    /// added after all factors.
    pub unscaled: [f64; 3],
    /// Its coverage; sums to 1.
    pub coverage: Coverage,
}

/// The position of a point in the image of a capture camera, and which pixels saw it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Located(Spot);

/// A place in an image, pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Spot {
    /// In it, with pixels that saw the surface around the point; the total weight of those of the four.
    Seen([f64; 2], [Tap; 4], f64),
    /// The same, with pixels taken as means; whether all 4 × 4 pixels around it saw the surface.
    Sharp([f64; 2], [Tap; 4], f64, bool),
    /// In it, but no pixel saw the surface.
    Unseen([f64; 2]),
    /// Outside it.
    Beside([f64; 2]),
    /// Behind the pinhole.
    Behind,
}

impl Located {
    /// Whether occlusion by the scene remains to be tested.
    pub fn is_seen(&self) -> bool {
        matches!(self.0, Spot::Seen(..) | Spot::Sharp(..))
    }
}

/// A cube on its time axis, ready for lookups from any thread.
#[derive(Debug, Clone)]
pub struct TimeTexture {
    cube: CubeStore,
    axis: TimeAxis,
    outside: Outside,
    timeline: Timeline,
    factor: f64,
    reconstruction: Reconstruction,
    backs: CubeBacks,
    sums: Option<Arc<PrefixSums>>,
}

/// The time of a texel's lookup: a moment, or a span.
pub(super) trait When {
    /// The weighted sum over the bins of a texel.
    fn texel(&self, texture: &TimeTexture, texel: usize, near: &Near) -> [f64; 3];
    /// The fractions of its span before, inside and after the data.
    fn parts(&self) -> [(Phase, f64); 3];
}

impl When for Moment {
    fn texel(&self, texture: &TimeTexture, texel: usize, near: &Near) -> [f64; 3] {
        reader::read_texel(&texture.cube, texel, self, near)
    }

    fn parts(&self) -> [(Phase, f64); 3] {
        let part = |phase| (phase, f64::from(self.phase == phase));
        [part(Phase::Before), part(Phase::Inside), part(Phase::After)]
    }
}

impl<W: When> When for &W {
    fn texel(&self, texture: &TimeTexture, texel: usize, near: &Near) -> [f64; 3] {
        W::texel(self, texture, texel, near)
    }

    fn parts(&self) -> [(Phase, f64); 3] {
        W::parts(self)
    }
}

impl When for Span {
    fn texel(&self, texture: &TimeTexture, texel: usize, near: &Near) -> [f64; 3] {
        Span::texel(self, texture.cube(), texture.sums(), texel, near)
    }

    fn parts(&self) -> [(Phase, f64); 3] {
        self.phases()
    }
}

impl TimeTexture {
    /// A cube (shared if several sources use one file) with its axis and policies.
    ///
    /// # Errors
    /// A shape that does not match the samples, channels other than 1 or 3, a bin width that is not above 0 or too small to be resolved
    /// at the start, a start or scale that is not finite.
    pub fn new(
        cube: impl Into<CubeStore>,
        axis: TimeAxis,
        outside: Outside,
    ) -> Result<TimeTexture, CubeError> {
        let cube = cube.into();
        if let Some(cube) = cube.in_memory() {
            cube.check_shape()?;
        }
        let [_, _, bins, channels] = cube.shape();
        if channels != 1 && channels != 3 {
            return Err(CubeError::Channels(channels));
        }
        Ok(TimeTexture {
            timeline: Timeline::new(&axis, bins, &outside)?,
            factor: axis.factor(),
            reconstruction: Reconstruction::default(),
            backs: CubeBacks::default(),
            sums: None,
            cube,
            axis,
            outside,
        })
    }

    /// The same with this reconstruction of pixels.
    #[must_use]
    pub fn with_reconstruction(self, reconstruction: Reconstruction) -> TimeTexture {
        TimeTexture {
            reconstruction,
            ..self
        }
    }

    /// The same, with this light on the backs of surfaces.
    #[must_use]
    pub fn with_backs(self, backs: CubeBacks) -> TimeTexture {
        TimeTexture { backs, ..self }
    }

    /// Columns and rows of the texels of one side of a surface.
    pub fn size_of_side(&self) -> [usize; 2] {
        let [width, height] = self.size();
        match self.backs {
            CubeBacks::SecondHalf => [width, height / 2],
            CubeBacks::AsFront | CubeBacks::Black => [width, height],
        }
    }

    /// The position of the front, or the back, of the point `uv` in the cube. Lookups next to the edge of a half read no row of the
    /// other.
    #[inline]
    pub fn on_side(&self, uv: DVec2, front: bool) -> DVec2 {
        if self.backs != CubeBacks::SecondHalf || !(0.0..=1.0).contains(&uv.y) {
            return uv;
        }
        // Half a texel from an edge is the centre of the last one.
        let edge = 0.5 / self.size_of_side()[1].max(1) as f64;
        let v = uv.y.clamp(edge, 1.0 - edge);
        DVec2::new(uv.x, 0.5 * if front { v } else { v + 1.0 })
    }

    /// The reconstruction between texels.
    pub fn reconstruction(&self) -> Reconstruction {
        self.reconstruction
    }

    /// The same with prefix sums, by which means over spans of many bins are computed without reading them all; not available for cubes
    /// on disk. They take [`TimeTexture::bytes_of_sums`].
    #[must_use]
    pub fn with_sums(self) -> TimeTexture {
        let sums = self.cube.in_memory().map(PrefixSums::new).map(Arc::new);
        TimeTexture { sums, ..self }
    }

    /// Bytes of the prefix sums of a cube of this shape.
    pub fn bytes_of_sums(shape: [usize; 4]) -> u64 {
        PrefixSums::bytes(shape)
    }

    pub(super) fn sums(&self) -> Option<&PrefixSums> {
        self.sums.as_deref()
    }

    /// The cube.
    pub fn cube(&self) -> &CubeStore {
        &self.cube
    }

    /// The time axis.
    pub fn axis(&self) -> &TimeAxis {
        &self.axis
    }

    pub(super) fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    /// The factor from a stored value to radiance per metre of ct.
    pub(super) fn factor(&self) -> f64 {
        self.factor
    }

    /// Width and height, texels: the size of the image of a [`Capture`].
    pub fn size(&self) -> [usize; 2] {
        let [height, width, ..] = self.cube.shape();
        [width, height]
    }

    /// The number of bins in this much time, by the narrowest.
    pub fn bins_in(&self, time: f64) -> f64 {
        time * self.timeline.bins_per_metre
    }

    /// The number of bytes that a lookup reads, by texture coordinates or at a located point, at a moment or over a span; an upper bound,
    /// because taps without weight are skipped.
    pub fn bytes_of_lookup(&self, located: Option<&Located>, span: Option<[f64; 2]>) -> u64 {
        let bins = match span {
            Some([from, to]) => (self.timeline.span(from, to)).bins_read(self.sums.is_some()),
            None => bins_of(self.axis.filter),
        };
        // A pixel that is read as a mean takes its four neighbours along.
        let texels = match located.map(|located| &located.0) {
            None | Some(Spot::Seen(..)) => 4,
            Some(Spot::Sharp(_, _, _, true)) => 5 * 16,
            Some(Spot::Sharp(_, _, _, false)) => 5 * 4,
            Some(Spot::Unseen(_) | Spot::Beside(_) | Spot::Behind) => 0,
        };
        (texels * bins * self.cube.shape()[3] * self.cube.sample_bytes()) as u64
    }

    /// The times between which it holds data, metres of ct on its own clock.
    pub fn span(&self) -> [f64; 2] {
        [self.axis.end(0), self.axis.end(self.cube.shape()[2])]
    }

    /// Radiance at texture coordinates `uv` (v = 0 is the top edge) and time `t`, metres of ct.
    ///
    /// Coordinates outside [0, 1] are off the texture, with no tiling; [`Fill::Hold`] clamps them.
    #[inline]
    pub fn sample_uv(&self, uv: DVec2, t: f64) -> Sampled {
        self.sample_uv_near(uv, t, &Near::default())
    }

    /// [`TimeTexture::sample_uv`] with bricks held by the thread.
    #[inline]
    pub fn sample_uv_near(&self, uv: DVec2, t: f64, near: &Near) -> Sampled {
        let [width, height] = self.size().map(|n| n as f64);
        let on_texture = uv.x >= 0.0 && uv.x <= 1.0 && uv.y >= 0.0 && uv.y <= 1.0;
        let read = || self.sample_texels([uv.x * width, uv.y * height], t, near);
        if on_texture {
            read()
        } else {
            self.fill(self.outside.off_texture, Coverage::OFF_TEXTURE, read)
        }
    }

    /// The mean of [`TimeTexture::sample_uv`] over the times from `from` to `to`, which ascend.
    pub fn mean_uv(&self, uv: DVec2, [from, to]: [f64; 2], near: &Near) -> Sampled {
        let span = self.timeline.span(from, to);
        let [width, height] = self.size();
        let on_texture = uv.x >= 0.0 && uv.x <= 1.0 && uv.y >= 0.0 && uv.y <= 1.0;
        let read = || {
            let taps = taps(uv.x * width as f64, uv.y * height as f64, width, height);
            self.gather(&taps, |_| &span, near)
        };
        if on_texture {
            read()
        } else {
            self.fill(self.outside.off_texture, Coverage::OFF_TEXTURE, read)
        }
    }

    /// The mean of [`TimeTexture::sample_located`] over the times from `from` to `to`, as [`TimeTexture::mean_uv`].
    pub fn mean_located(
        &self,
        capture: &Capture,
        located: &Located,
        [from, to]: [f64; 2],
        occluded: bool,
        near: &Near,
    ) -> Sampled {
        let span = |texel: usize| {
            let delay = capture.delay_of(texel);
            self.timeline.span(from + delay, to + delay)
        };
        match &located.0 {
            Spot::Seen(_, taps, _) if !occluded => self.gather(taps, span, near),
            Spot::Sharp(place, taps, _, all) if !occluded => {
                self.sample_means(capture, (*place, *all), taps, span, near)
            }
            // Places without data are filled as at a moment.
            _ => self.sample_located(capture, located, 0.5 * (from + to), occluded, near),
        }
    }

    /// Taps, each when it is read.
    fn gather<W: When>(&self, taps: &[Tap; 4], when: impl Fn(usize) -> W, near: &Near) -> Sampled {
        let mut sampled = Sampled::default();
        for tap in taps.iter().filter(|tap| tap.weight != 0.0) {
            let when = when(tap.texel);
            let value = when.texel(self, tap.texel, near);
            for (sum, value) in sampled.radiance.iter_mut().zip(value) {
                *sum += tap.weight * self.factor * value;
            }
            self.account_for(&mut sampled, tap.weight, &when);
        }
        sampled
    }

    /// Carries out `count` lookups in this cube, by number; for cubes on disk each is carried out twice, and counts when `near` [is not
    /// asking](Near::is_asking).
    pub fn look_up_each(&self, near: &Near, count: usize, look_up: impl FnMut(usize)) {
        match &self.cube {
            CubeStore::Memory(_) => (0..count).for_each(look_up),
            CubeStore::Disk(bricks) => near.look_up_each(bricks, count, look_up),
        }
    }

    /// Adds a tap's weight to the coverage by its time.
    pub(super) fn account_for(&self, sampled: &mut Sampled, weight: f64, when: &impl When) {
        for (phase, part) in when.parts() {
            if part != 0.0 {
                self.account(sampled, weight * part, phase);
            }
        }
    }

    /// Radiance of a surface point as the capture camera recorded it.
    ///
    /// `t` is the time of emission, metres of ct in the frame in which capture camera and surface rest (for a cube in object or world
    /// time: on that clock). `occluded(point, eye)` says whether the scene blocks the line between them; it is called last, and only if a
    /// pixel saw the surface. Taps that saw another surface or nothing are left out, and the others' weights are normalized to 1.
    ///
    /// Off the image: the point projects outside it or is behind the pinhole. Occluded: the visible side faces away, none of the four
    /// taps saw the surface, or `occluded` says so. Held positions take the nearest pixels, whatever surface they saw; behind the pinhole
    /// none is near, and they are black.
    #[inline]
    pub fn sample_capture(
        &self,
        capture: &Capture,
        point: &CapturePoint,
        t: f64,
        occluded: impl FnOnce(DVec3, DVec3) -> bool,
    ) -> Sampled {
        let located = self.locate(capture, point);
        let occluded = located.is_seen() && occluded(point.position, capture.eye());
        self.sample_located(capture, &located, t, occluded, &Near::default())
    }

    /// The position of `point` in the image of `capture`, and whether a pixel saw its surface.
    #[inline]
    pub fn locate(&self, capture: &Capture, point: &CapturePoint) -> Located {
        let (place, aim) = capture.look_at(capture.projection(), point);
        let aim = (place.is_some() && aim.faces()).then_some(aim);
        self.located(capture, place, aim)
    }

    /// What is at `place` of the image; `None` is behind the pinhole. `aim` is the point, if it faces the pinhole.
    #[inline]
    pub(super) fn located(
        &self,
        capture: &Capture,
        place: Option<[f64; 2]>,
        aim: Option<Aim>,
    ) -> Located {
        let Some(place) = place else {
            return Located(Spot::Behind);
        };
        if !self.on_image(place) {
            return Located(Spot::Beside(place));
        }
        let Some(aim) = aim else {
            return Located(Spot::Unseen(place));
        };
        let taps = self.taps_where(place, |pixel| capture.saw(pixel, &aim));
        Located(match (taps, self.reconstruction) {
            (Some((taps, part)), Reconstruction::Bilinear | Reconstruction::Footprint) => {
                Spot::Seen(place, taps, part)
            }
            (Some((taps, part)), Reconstruction::Sharp) => {
                Spot::Sharp(place, taps, part, self.is_sharp_at(capture, place, &aim))
            }
            (None, _) => Spot::Unseen(place),
        })
    }

    /// Radiance of a point that was located, as [`TimeTexture::sample_capture`]. `occluded` counts where the
    /// point [is seen](Located::is_seen).
    #[inline]
    pub fn sample_located(
        &self,
        capture: &Capture,
        located: &Located,
        t: f64,
        occluded: bool,
        near: &Near,
    ) -> Sampled {
        match &located.0 {
            Spot::Seen(_, taps, _) if !occluded => self.sample_pixels(capture, taps, t, near),
            Spot::Sharp(place, taps, _, all) if !occluded => {
                // On a capture's own clock each texel is read at its own time of arrival.
                let when = |texel| self.timeline.moment(t + capture.delay_of(texel));
                self.sample_means(capture, (*place, *all), taps, when, near)
            }
            Spot::Seen(place, ..)
            | Spot::Sharp(place, ..)
            | Spot::Unseen(place)
            | Spot::Beside(place) => {
                let (fill, coverage) = self.absence(located);
                self.fill(fill, coverage, || {
                    self.sample_anything(capture, *place, t, near)
                })
            }
            Spot::Behind => {
                let (fill, coverage) = self.absence(located);
                self.fill(fill, coverage, Sampled::default)
            }
        }
    }

    /// The substitute for a located point if the capture has no data for it, provided that needs no data. `occluded` is as in
    /// [`TimeTexture::sample_located`].
    #[inline]
    pub fn without_data(&self, located: &Located, occluded: bool) -> Option<Sampled> {
        let (fill, coverage) = match located.is_seen() && !occluded {
            true => return None,
            false => self.absence(located),
        };
        (fill != Fill::Hold).then(|| self.fill(fill, coverage, Sampled::default))
    }

    /// The same for an occluded point, or one whose surface no pixel saw.
    #[inline]
    pub fn occluded(&self) -> Option<Sampled> {
        let fill = self.outside.occluded;
        (fill != Fill::Hold).then(|| self.fill(fill, Coverage::OCCLUDED, Sampled::default))
    }

    /// The same for a point outside the image, or behind the pinhole.
    #[inline]
    pub fn off_image(&self) -> Option<Sampled> {
        let fill = self.outside.off_texture;
        (fill != Fill::Hold).then(|| self.fill(fill, Coverage::OFF_TEXTURE, Sampled::default))
    }

    /// Why the capture has no data for a point, and what replaces them. A point that is seen is occluded.
    fn absence(&self, located: &Located) -> (Fill, Coverage) {
        match &located.0 {
            Spot::Seen(..) | Spot::Sharp(..) | Spot::Unseen(_) => {
                (self.outside.occluded, Coverage::OCCLUDED)
            }
            Spot::Beside(_) | Spot::Behind => (self.outside.off_texture, Coverage::OFF_TEXTURE),
        }
    }

    /// How well the image shows the point, 0 to 1: the weight of those of the four pixels around it that saw its surface, times its
    /// distance from the edge of the image, pixels, at most 1. Above 0 wherever the point is seen.
    pub fn seen_part(&self, located: &Located) -> f64 {
        /// If only one capture sees a point, any weight will do.
        const LEAST: f64 = 1e-6;
        let (Spot::Seen([x, y], _, part) | Spot::Sharp([x, y], _, part, _)) = &located.0 else {
            return 0.0;
        };
        let [width, height] = self.size().map(|n| n as f64);
        let edge = x.min(width - x).min(*y).min(height - y);
        part.max(LEAST) * edge.clamp(LEAST, 1.0)
    }

    fn on_image(&self, [x, y]: [f64; 2]) -> bool {
        let [width, height] = self.size().map(|n| n as f64);
        x >= 0.0 && x <= width && y >= 0.0 && y <= height
    }

    /// The nearest pixels that saw anything.
    fn sample_anything(&self, capture: &Capture, place: [f64; 2], t: f64, near: &Near) -> Sampled {
        match self.taps_where(place, |pixel| capture.distance(pixel).is_some()) {
            Some((taps, _)) => self.sample_pixels(capture, &taps, t, near),
            None => Sampled::default(),
        }
    }

    /// The bilinear taps at `place` that are `valid`, with weights normalized to 1, and their original sum.
    #[inline]
    fn taps_where(
        &self,
        [x, y]: [f64; 2],
        valid: impl Fn(usize) -> bool,
    ) -> Option<([Tap; 4], f64)> {
        let [width, height] = self.size();
        let mut taps = taps(x, y, width, height);
        let mut sum = 0.0;
        let mut complete = true;
        for tap in &mut taps {
            if valid(tap.texel) {
                sum += tap.weight;
            } else {
                tap.weight = 0.0;
                complete = false;
            }
        }
        if complete {
            return Some((taps, 1.0));
        }
        // Normalized: a point that is seen in part is not darker for it.
        (sum > 0.0).then(|| {
            let taps = taps.map(|tap| Tap {
                weight: tap.weight / sum,
                ..tap
            });
            (taps, sum)
        })
    }

    /// All taps at one time.
    #[inline]
    fn sample_texels(&self, [x, y]: [f64; 2], t: f64, near: &Near) -> Sampled {
        let [width, height] = self.size();
        self.blend_at(&taps(x, y, width, height), &self.timeline.moment(t), near)
    }

    /// Every tap at the time at which its own light reached the capture camera.
    #[inline]
    fn sample_pixels(&self, capture: &Capture, taps: &[Tap; 4], t: f64, near: &Near) -> Sampled {
        if capture.is_warped() {
            let moments = taps.map(|tap| self.timeline.moment(t + capture.delay_of(tap.texel)));
            self.blend(taps, moments.each_ref(), near)
        } else {
            self.blend_at(taps, &self.timeline.moment(t), near)
        }
    }

    /// Taps that share one moment.
    #[inline]
    fn blend_at(&self, taps: &[Tap; 4], moment: &Moment, near: &Near) -> Sampled {
        let mut sampled = self.read(taps, [moment; 4], near);
        self.account(&mut sampled, 1.0, moment.phase);
        sampled
    }

    #[inline]
    fn read(&self, taps: &[Tap; 4], moments: [&Moment; 4], near: &Near) -> Sampled {
        let sum = reader::read(&self.cube, taps, moments, near);
        Sampled {
            radiance: sum.map(|value| value * self.factor),
            ..Sampled::default()
        }
    }

    #[inline]
    fn blend(&self, taps: &[Tap; 4], moments: [&Moment; 4], near: &Near) -> Sampled {
        let mut sampled = self.read(taps, moments, near);
        for (tap, moment) in taps.iter().zip(moments) {
            self.account(&mut sampled, tap.weight, moment.phase);
        }
        sampled
    }

    /// Adds a tap's weight to the coverage by its time, with the colour that marks it.
    #[inline]
    pub(super) fn account(&self, sampled: &mut Sampled, weight: f64, phase: Phase) {
        let fill = match phase {
            Phase::Inside => {
                sampled.coverage.held += weight;
                return;
            }
            Phase::Before => {
                sampled.coverage.before += weight;
                self.outside.before
            }
            Phase::After => {
                sampled.coverage.after += weight;
                self.outside.after
            }
        };
        if let Fill::Mark(colour) = fill {
            for (sum, channel) in sampled.unscaled.iter_mut().zip(colour) {
                *sum += weight * channel;
            }
        }
    }

    /// A position without data: `hold` reads the nearest, whose times may be missing too and are filled.
    #[inline]
    fn fill(&self, fill: Fill, coverage: Coverage, hold: impl FnOnce() -> Sampled) -> Sampled {
        let sampled = match fill {
            Fill::Black => Sampled::default(),
            Fill::Mark(colour) => Sampled {
                unscaled: colour,
                ..Sampled::default()
            },
            Fill::Hold => hold(),
        };
        Sampled {
            coverage,
            ..sampled
        }
    }
}
