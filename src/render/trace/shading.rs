//! From the hits of a batch to the film: runs of points of one patch, their radiance, the observer's
//! factor W⁻ᵖ and colours.

use std::ops::Range;
use std::sync::Arc;

use super::emitted::{Colouring, Detail, Emitted, Eye, Response, Scaling};
use super::radiance::Radiance;
use super::run::{Run, TracedRays, in_a_row};
use super::stats::{Counter, Meter, Stage};
use crate::accel::Hit;
use crate::accel::vectors::{BLOCK, Block, Columns, VectorLoop, dispatch, shift_each};
use crate::colour::{self, RgbShift, per_wavelength_power};
use crate::light::sky::{Beaming, LookDirections, Motion, Motions, PixelAngles, Sky, Star};
use crate::light::time_texture::Coverage;
use crate::render::film::TileFilm;
use crate::spacetime::Quantity;

/// The destination of the radiance of the rays of a batch.
pub trait RadianceSink {
    /// Adds the radiance of ray `ray`.
    fn add(&mut self, ray: usize, radiance: [f64; 3]);
    /// Adds the radiance of consecutive rays from `first` on, times their factors.
    fn add_scaled(&mut self, first: usize, radiance: &[[f64; 3]], factors: &[f64]) {
        for ((ray, rgb), factor) in (first..).zip(radiance).zip(factors) {
            self.add(ray, rgb.map(|c| factor * c));
        }
    }
    /// Adds the radiance of consecutive rays from `first` on.
    fn add_row(&mut self, first: usize, radiance: &[[f64; 3]]) {
        for (ray, rgb) in (first..).zip(radiance) {
            self.add(ray, *rgb);
        }
    }
    /// Records that no light reaches the sensor element of ray `ray`.
    fn add_blind(&mut self, ray: usize);
    /// Records rays whose radiance is fully known and does not come from data.
    fn add_known(&mut self, rays: &[u32]);
    /// Adds how much of the radiance of `rays`, whose surface has data, the data cover: full coverage, except for `parts`.
    fn cover(&mut self, rays: &[u32], parts: impl Iterator<Item = (usize, Coverage)>);
    /// Records rays that hit nothing.
    fn add_misses(&mut self, rays: u64);
}

/// One ray for each pixel, sample by sample.
impl RadianceSink for TileFilm {
    #[inline(always)]
    fn add(&mut self, ray: usize, radiance: [f64; 3]) {
        TileFilm::add(self, ray, radiance);
    }

    fn add_scaled(&mut self, first: usize, radiance: &[[f64; 3]], factors: &[f64]) {
        TileFilm::add_scaled(self, first, radiance, factors);
    }

    fn add_row(&mut self, first: usize, radiance: &[[f64; 3]]) {
        TileFilm::add_row(self, first, radiance);
    }

    fn add_blind(&mut self, ray: usize) {
        TileFilm::add_blind(self, ray);
    }

    fn add_known(&mut self, rays: &[u32]) {
        TileFilm::add_known(self, rays);
    }

    fn cover(&mut self, rays: &[u32], parts: impl Iterator<Item = (usize, Coverage)>) {
        TileFilm::cover(self, rays, parts);
    }

    fn add_misses(&mut self, rays: u64) {
        TileFilm::add_misses(self, rays);
    }
}

/// What rays see that hit nothing.
#[derive(Debug, Clone)]
pub enum Background {
    /// A constant radiance, as observed, whatever moves.
    Observed([f64; 3]),
    /// A sky at rest in the world.
    Sky {
        /// The sky.
        sky: Arc<Sky>,
        /// How the observer responds to its radiance.
        response: Response,
        /// How the observer sees its spectra, if it has any.
        spectra: Option<SkySpectra>,
        /// The angle between samples at rest in the camera's frame, radians.
        angle: f64,
        /// The angle between pixels, where it is largest.
        pixel: f64,
        /// How the observer sees stars; and the sun, by its motion.
        beaming: Beaming,
        /// The observer's motion by the moment of the exposure, if it changes.
        motions: Option<Box<Motions>>,
    },
}

/// How an observer sees a sky's spectra.
#[derive(Debug, Clone, Copy)]
pub struct SkySpectra {
    /// The factor on their colours.
    pub scaled: Scaling,
    /// Whether wavelengths are shifted.
    pub shifted: bool,
    /// The observer's eye.
    pub eye: Eye,
}

impl Scaling {
    /// p − 2, where radiance is scaled with W⁻ᵖ.
    pub(crate) fn beaming(self) -> i32 {
        match self {
            // p is 0, that of the quantity, or −4.
            Scaling::None => -2,
            Scaling::Of(quantity) => quantity.exponent() as i32 - 2,
            Scaling::HueAlone => -6,
        }
    }
}

impl SkySpectra {
    /// The wavelength ratio at which to look up a sky that is seen at W.
    #[inline]
    fn ratio(&self, w: f64) -> f64 {
        self.eye.ratio(if self.shifted { w } else { 1.0 })
    }
}

/// Buffers for shading one tile.
#[derive(Debug, Default)]
pub struct Shading {
    /// Rays that hit nothing, if there is a sky.
    escaped: Vec<u32>,
    /// Those of them that look at a star.
    starlit: Vec<u32>,
    /// Rays that hit a visible surface, by patch.
    lit: Vec<u32>,
    /// The same in another order.
    reordered: Vec<u32>,
    /// Other rays whose radiance is known without evaluating a surface: a background that is not a sky, and black backs.
    plain: Vec<u32>,
    runs: Vec<Span>,
    emitted: Emitted,
    /// W of each point of a run, and the factors on their radiance.
    ratios: Vec<f64>,
    factors: Vec<f64>,
    /// Look directions in the world of rays that hit nothing, and their observers' motions, if these differ.
    directions: Columns,
    motions: Vec<Motion>,
}

/// Consecutive rays in `lit` that hit one patch of one frame.
#[derive(Debug, Clone, Copy)]
struct Span {
    begin: usize,
    end: usize,
    frame: u32,
    /// The patch's first triangle.
    patch: u32,
    /// A triangle of the patch.
    triangle: u32,
}

/// The triangles of a patch.
#[derive(Debug, Clone, Copy)]
struct PatchSpan {
    frame: u32,
    first: u32,
    end: u32,
    black_back: bool,
}

impl PatchSpan {
    /// The initial value, without triangles.
    const NONE: PatchSpan = PatchSpan {
        frame: u32::MAX,
        first: 0,
        end: 0,
        black_back: false,
    };

    /// Whether `hit`, in this frame, is on the patch.
    #[inline(always)]
    fn contains(&self, hit: &Hit, frame: u32) -> bool {
        frame == self.frame && (self.first..self.end).contains(&hit.triangle)
    }

    /// Whether it is on a side of the patch that is not black.
    #[inline(always)]
    fn shows(&self, hit: &Hit, frame: u32) -> bool {
        self.contains(hit, frame) && (hit.front || !self.black_back)
    }
}

impl Shading {
    /// Adds the radiance of `traced` rays to `sink`; `ratios` are their W for sources at rest in the world.
    pub(crate) fn shade(
        &mut self,
        radiance: &dyn Radiance,
        traced: &TracedRays,
        background: &Background,
        ratios: &[f64],
        sink: &mut impl RadianceSink,
        meter: &mut Meter,
    ) {
        let origins = traced.rays.origins;
        let has_gaps = radiance.has_gaps() || origins.is_some();
        // Without origins the weight is the constant 1, and the compiler drops its tests.
        match origins {
            None => self.sort(traced, background, |_| 1.0, sink),
            Some(origins) => self.sort(traced, background, |ray| origins[ray].weight, sink),
        }
        if has_gaps {
            sink.add_known(&self.plain);
            sink.add_known(&self.escaped);
        }
        self.see_sky(traced, background, ratios, sink);
        meter.count(Counter::Hits, self.lit.len() as u64);
        meter.lap(Stage::Film);
        for at in 0..self.runs.len() {
            let span = self.runs[at];
            let rest = traced.surfaces.rest(span.frame);
            let run = Run {
                traced,
                members: &self.lit[span.begin..span.end],
                patch: rest.patch(span.triangle),
                rest,
                frame: span.frame,
            };
            radiance.emit(&run, &mut self.emitted, meter);
            meter.lap(Stage::Radiance);
            // W in two factors: camera over world, and world over rest frame.
            run.ratios(ratios, &mut self.ratios);
            weigh(
                self.emitted.response.scaled,
                &self.ratios,
                &mut self.factors,
            );
            if let Some(origins) = origins {
                for (factor, ray) in self.factors.iter_mut().zip(run.members) {
                    *factor *= origins[*ray as usize].weight;
                }
            }
            add_colours(
                &mut self.emitted,
                &self.ratios,
                &self.factors,
                run.members,
                sink,
            );
            match has_gaps {
                true if radiance.has_data(run.patch.emitter) => {
                    cover(&self.emitted.details, run.members, sink);
                }
                true => sink.add_known(run.members),
                false => {}
            }
            meter.lap(Stage::Film);
        }
    }

    /// Adds the radiance of the sky to rays that hit nothing.
    fn see_sky(
        &mut self,
        traced: &TracedRays,
        background: &Background,
        ratios: &[f64],
        sink: &mut impl RadianceSink,
    ) {
        let Background::Sky {
            sky,
            response,
            spectra,
            angle,
            pixel,
            beaming,
            motions,
        } = background
        else {
            return;
        };
        let mut escaped = &self.escaped;
        // Not cleared, since it is overwritten.
        let radiance = std::mem::take(&mut self.emitted.radiance);
        self.emitted.start(response.clone());
        self.emitted.radiance = radiance;
        if sky.takes_columns() {
            take_directions(escaped, traced, &mut self.directions);
        }
        self.motions.clear();
        // If the camera accelerates during the exposure, each ray widens discs by the velocity of its own moment.
        if let (Some(motions), [_, ..], true) = (motions, traced.rays.moments, sky.has_discs()) {
            let moments = escaped.iter().map(|ray| traced.rays.moments[*ray as usize]);
            self.motions
                .extend(moments.map(|moment| motions.at(moment)));
        }
        // In the world, a pixel's angle is 1/W as wide.
        let pixels = PixelAngles {
            angle: *angle,
            pixel: *pixel,
            ratios: &[],
            beaming: *beaming,
            power: response.scaled.beaming(),
            motions: &self.motions,
        };
        // There may be nothing to see between stars.
        let only_stars = sky.only_stars();
        if let Some(stars) = only_stars {
            self.starlit.clear();
            self.emitted.radiance.clear();
            let ratios = those_of(escaped, ratios, &mut self.ratios);
            let pixels = PixelAngles { ratios, ..pixels };
            let (starlit, radiance) = (&mut self.starlit, &mut self.emitted.radiance);
            let channels = |_: usize, star: &Star| star.channels();
            stars.each_seen(&self.directions, pixels, channels, |k, seen| {
                starlit.push(escaped[k]);
                radiance.push(seen);
            });
            escaped = &self.starlit;
        }
        let ratios = those_of(escaped, ratios, &mut self.ratios);
        let pixels = PixelAngles { ratios, ..pixels };
        // The factors, and the weights of rays that have their own.
        let weigh_all = |scaled: Scaling, factors: &mut Vec<f64>| {
            weigh(scaled, ratios, factors);
            if let Some(origins) = traced.rays.origins {
                for (factor, ray) in factors.iter_mut().zip(escaped) {
                    *factor *= origins[*ray as usize].weight;
                }
            }
        };
        if sky.has_channels() {
            let look = LookDirections {
                directions: traced.rays.directions,
                rays: escaped,
            };
            if only_stars.is_none() {
                let radiance = &mut self.emitted.radiance;
                sky.radiance_each(look, &self.directions, pixels, radiance);
            }
            weigh_all(self.emitted.response.scaled, &mut self.factors);
            add_colours(&mut self.emitted, ratios, &self.factors, escaped, sink);
        }
        let Some(spectra) = spectra else {
            return;
        };
        weigh_all(spectra.scaled, &mut self.factors);
        let ratio = |w: f64| spectra.ratio(w);
        let gain = spectra.eye.gain();
        sky.each_spectral(&self.directions, pixels, ratio, |k, seen| {
            let seen = seen.map(|c| c * gain * self.factors[k]);
            sink.add(escaped[k] as usize, seen);
        });
    }

    /// Finds the runs, and adds the radiance of rays that hit nothing or a black back. `weight` gives the weight of a ray's radiance; 0 for
    /// a sensor element that no light reaches.
    #[inline(always)]
    fn sort(
        &mut self,
        traced: &TracedRays,
        background: &Background,
        weight: impl Fn(usize) -> f64,
        sink: &mut impl RadianceSink,
    ) {
        self.lit.clear();
        self.plain.clear();
        self.escaped.clear();
        self.runs.clear();
        let mut unmet = 0;
        let mut patch = PatchSpan::NONE;
        let scene = (traced, background);
        // Rays with individual weights are handled one by one.
        let (alike, hits) = match (traced.hits.alike(), traced.hits.hits()) {
            (alike, []) => (alike, [].as_slice()),
            (alike, _) if !alike.is_empty() && traced.rays.origins.is_none() => {
                (alike, [].as_slice())
            }
            (_, hits) => ([].as_slice(), hits),
        };
        let mut begin = 0;
        for (end, hit) in alike {
            let hit = hit.as_ref().map(|found| (&found.hit, found.frame));
            let weight = weight(begin as usize);
            unmet += self.take(scene, begin..*end, hit, weight, &mut patch, sink);
            begin = *end;
        }
        let mut ray = 0;
        while ray < hits.len() {
            let hit = hits[ray].as_ref();
            let hit = hit.map(|hit| (hit, traced.hits.frame(ray)));
            let (of_ray, first) = (weight(ray), ray);
            ray += 1;
            // Rays that hit nothing mostly follow each other, and are handled together.
            while hit.is_none()
                && hits.get(ray).is_some_and(Option::is_none)
                && weight(ray) == of_ray
            {
                ray += 1;
            }
            let rays = first as u32..ray as u32;
            unmet += self.take(scene, rays, hit, of_ray, &mut patch, sink);
            // Most of the following rays hit the same patch, and are handled together.
            let begin = ray;
            while let Some(Some(hit)) = hits.get(ray)
                && patch.shows(hit, traced.hits.frame(ray))
                && weight(ray) != 0.0
            {
                ray += 1;
            }
            self.lit.extend(begin as u32..ray as u32);
        }
        // An empty run, which is removed again, ends the last one.
        self.begin(u32::MAX, 0, 0);
        self.runs.pop();
        self.merge();
        sink.add_misses(unmet);
    }

    /// Adds consecutive rays with the same hit, where `patch` was hit last; returns how many hit nothing.
    #[inline(always)]
    fn take(
        &mut self,
        (traced, background): (&TracedRays, &Background),
        rays: Range<u32>,
        hit: Option<(&Hit, u32)>,
        weight: f64,
        patch: &mut PatchSpan,
        sink: &mut impl RadianceSink,
    ) -> u64 {
        let count = u64::from(rays.end - rays.start);
        // Sensor elements that no light reaches.
        if weight == 0.0 {
            for ray in rays {
                sink.add_blind(ray as usize);
                sink.add(ray as usize, [0.0; 3]);
            }
            return count;
        }
        let Some((hit, frame)) = hit else {
            match background {
                Background::Observed(radiance) => {
                    let seen = radiance.map(|c| c * weight);
                    for ray in rays {
                        sink.add(ray as usize, seen);
                        self.plain.push(ray);
                    }
                }
                Background::Sky { .. } => self.escaped.extend(rays),
            }
            return count;
        };
        // Another patch starts another run.
        if !patch.contains(hit, frame) {
            let (found, end) = traced.surfaces.rest(frame).patch_and_end(hit.triangle);
            *patch = PatchSpan {
                frame,
                first: found.first,
                end,
                black_back: found.black_back,
            };
            self.begin(frame, found.first, hit.triangle);
        }
        if patch.black_back && !hit.front {
            for ray in rays {
                sink.add(ray as usize, [0.0; 3]);
                self.plain.push(ray);
            }
            return 0;
        }
        self.lit.extend(rays);
        0
    }

    /// Merges the runs of each patch: the longer a run, the more of it is vectorised.
    fn merge(&mut self) {
        let is_after =
            |pair: &[Span]| (pair[0].frame, pair[0].patch) < (pair[1].frame, pair[1].patch);
        if self.runs.windows(2).all(is_after) {
            return;
        }
        // Stable: rays of a patch stay in order.
        self.runs.sort_by_key(|span| (span.frame, span.patch));
        self.reordered.clear();
        let mut merged: usize = 0;
        for at in 0..self.runs.len() {
            let span = self.runs[at];
            let begin = self.reordered.len();
            self.reordered
                .extend_from_slice(&self.lit[span.begin..span.end]);
            let end = self.reordered.len();
            // In place: merged ≤ at, so no run is overwritten before it is read.
            match merged.checked_sub(1).map(|last| self.runs[last]) {
                Some(last) if (last.frame, last.patch) == (span.frame, span.patch) => {
                    self.runs[merged - 1].end = end;
                }
                _ => {
                    self.runs[merged] = Span { begin, end, ..span };
                    merged += 1;
                }
            }
        }
        self.runs.truncate(merged);
        std::mem::swap(&mut self.lit, &mut self.reordered);
    }

    /// Starts a new run, which ends the previous one.
    fn begin(&mut self, frame: u32, patch: u32, triangle: u32) {
        let begin = self.lit.len();
        match self.runs.last_mut() {
            Some(last) if last.begin == begin => {
                self.runs.pop();
            }
            Some(last) => last.end = begin,
            None => {}
        }
        self.runs.push(Span {
            begin,
            end: begin,
            frame,
            patch,
            triangle,
        });
    }
}

/// Sets `directions` to the look directions in the world of `rays`.
fn take_directions(rays: &[u32], traced: &TracedRays, directions: &mut Columns) {
    directions.resize(rays.len());
    for (block, rays) in rays.chunks(BLOCK).enumerate() {
        if let Some([x, y, z]) = directions.block_mut(block * BLOCK) {
            for (k, ray) in rays.iter().enumerate() {
                let d = traced.rays.directions[*ray as usize];
                (x[k], y[k], z[k]) = (d.x, d.y, d.z);
            }
        }
    }
}

/// The elements of `all` for `rays`, in place or gathered.
fn those_of<'a>(rays: &[u32], all: &'a [f64], gathered: &'a mut Vec<f64>) -> &'a [f64] {
    match in_a_row(rays).and_then(|rays| all.get(rays)) {
        Some(row) => row,
        None => {
            gathered.clear();
            gathered.extend(rays.iter().map(|ray| all[*ray as usize]));
            gathered
        }
    }
}

/// The observer's factors for wavelength ratios `ratios`.
pub(crate) fn weigh(scaled: Scaling, ratios: &[f64], factors: &mut Vec<f64>) {
    factors.clear();
    match scaled {
        Scaling::None => factors.resize(ratios.len(), 1.0),
        Scaling::Of(quantity) => {
            factors.extend_from_slice(ratios);
            dispatch(Powers { quantity, factors });
        }
        Scaling::HueAlone => factors.extend(ratios.iter().map(|w| w * w * w * w)),
    }
}

/// The loop from ratios to factors.
struct Powers<'a> {
    quantity: Quantity,
    factors: &'a mut [f64],
}

impl VectorLoop for Powers<'_> {
    #[inline(always)]
    fn run(self) {
        self.quantity.radiance_factors(self.factors);
    }
}

/// Adds the radiance of a run, times `factors`, to the pixels of its members. May overwrite the radiance in `emitted`.
fn add_colours(
    emitted: &mut Emitted,
    ratios: &[f64],
    factors: &[f64],
    members: &[u32],
    sink: &mut impl RadianceSink,
) {
    // The usual responses have loops of their own; the last loop serves all others.
    match (&emitted.response.colour, emitted.details.as_slice()) {
        (Colouring::Rgb(shift, eye), []) => {
            shift_all(shift, *eye, ratios, factors, &mut emitted.radiance);
            if let Some(rays) = in_a_row(members) {
                return sink.add_row(rays.start, &emitted.radiance);
            }
            for (ray, seen) in members.iter().zip(&emitted.radiance) {
                sink.add(*ray as usize, *seen);
            }
            return;
        }
        (Colouring::Companions(shift, eye), []) => {
            let rays = members.iter().zip(&emitted.radiance).enumerate();
            for ((k, (ray, rgb)), (w, factor)) in rays.zip(ratios.iter().zip(factors)) {
                let factor = factor * eye.gain();
                let seen = shift.apply(eye.ratio(*w), *rgb, emitted.companions(k));
                sink.add(*ray as usize, seen.map(|c| factor * c));
            }
            return;
        }
        (Colouring::Channels, details) => {
            // Stretches between points with details are added as if there were none.
            let mut begin = 0;
            for Detail { at, unscaled, .. } in details {
                let (known, at) = (begin..*at, *at);
                let radiance = &emitted.radiance[known.clone()];
                add_scaled(radiance, &factors[known.clone()], &members[known], sink);
                let ([r, g, b], [r0, g0, b0]) = (emitted.radiance[at], *unscaled);
                let factor = factors[at];
                let seen = [r0 + factor * r, g0 + factor * g, b0 + factor * b];
                sink.add(members[at] as usize, seen);
                begin = at + 1;
            }
            let rest = &emitted.radiance[begin..];
            return add_scaled(rest, &factors[begin..], &members[begin..], sink);
        }
        (Colouring::ShiftedLine(wavelength), []) => {
            return add_lines(*wavelength, emitted, ratios, factors, members, sink);
        }
        _ => {}
    }
    // Details are ascending by point: each is used when its point comes.
    let mut details = emitted.details.iter().peekable();
    for (k, ray) in members.iter().enumerate() {
        let mut unscaled = [0.0; 3];
        let mut wavelength_scale = 1.0;
        if let Some(detail) = details.next_if(|detail| detail.at == k) {
            (unscaled, wavelength_scale) = (detail.unscaled, detail.wavelength_scale);
        }
        let colour = match &emitted.response.colour {
            Colouring::Channels => emitted.radiance[k],
            Colouring::ShiftedLine(wavelength) => line(
                emitted.radiance[k],
                wavelength * wavelength_scale * ratios[k],
            ),
            Colouring::UnshiftedLine(wavelength) => line(emitted.radiance[k], *wavelength),
            Colouring::Rgb(shift, eye) => shift
                .apply(eye.ratio(ratios[k]), emitted.radiance[k])
                .map(|c| c * eye.gain()),
            Colouring::Companions(shift, eye) => shift
                .apply(
                    eye.ratio(ratios[k]),
                    emitted.radiance[k],
                    emitted.companions(k),
                )
                .map(|c| c * eye.gain()),
            Colouring::Spectrum(table, eye) => {
                let factor = mean(emitted.radiance[k]) * eye.gain();
                table.colour(eye.ratio(ratios[k])).map(|c| c * factor)
            }
            Colouring::Sampled(eye) => {
                let points = &emitted.spectral;
                let seen = eye.colour_of_sampled(points.numbers[k], emitted.radiance[k]);
                let power = per_wavelength_power(ratios[k]);
                std::array::from_fn(|c| power * seen[c] + points.beside[k][c])
            }
        };
        // Substitutes for missing data are shown unchanged; everything else gets the observer's factor.
        let factor = factors[k];
        let [r, g, b] = colour;
        let [r0, g0, b0] = unscaled;
        sink.add(
            *ray as usize,
            [r0 + factor * r, g0 + factor * g, b0 + factor * b],
        );
    }
}

/// Adds radiance times `factors`, without further details.
fn add_scaled(
    radiance: &[[f64; 3]],
    factors: &[f64],
    members: &[u32],
    sink: &mut impl RadianceSink,
) {
    if let Some(rays) = in_a_row(members) {
        return sink.add_scaled(rays.start, radiance, factors);
    }
    for ((ray, [r, g, b]), factor) in members.iter().zip(radiance).zip(factors) {
        sink.add(*ray as usize, [factor * r, factor * g, factor * b]);
    }
}

/// Transforms linear RGB to what an eye sees of it at W `ratios`, times `factors`.
fn shift_all(
    shift: &RgbShift,
    eye: Eye,
    ratios: &[f64],
    factors: &[f64],
    radiance: &mut [[f64; 3]],
) {
    let (mut at, mut rests) = ([0; BLOCK], [0.0; BLOCK]);
    let of_rays = ratios.chunks(BLOCK).zip(factors.chunks(BLOCK));
    for (radiance, (ratios, factors)) in radiance.chunks_mut(BLOCK).zip(of_rays) {
        let mut is_beyond = false;
        dispatch(Places {
            shift,
            eye,
            ratios,
            at: &mut at,
            rests: &mut rests,
            is_beyond: &mut is_beyond,
        });
        let places = (&at, &rests);
        shift_each(shift.matrices(), places, (factors, eye.gain()), radiance);
        if !is_beyond {
            continue;
        }
        // Ratios for which no matrix is tabulated.
        let rays = radiance.iter_mut().zip(ratios.iter().zip(factors));
        for ((rgb, (w, factor)), at) in rays.zip(&at) {
            if *at >= shift.matrices().len() as u64 {
                let factor = factor * eye.gain();
                *rgb = shift.beyond(eye.ratio(*w), *rgb).map(|c| c * factor);
            }
        }
    }
}

/// The loop from a block of W to positions in the table of M(W), and whether any is beyond the table.
struct Places<'a> {
    shift: &'a RgbShift,
    eye: Eye,
    ratios: &'a [f64],
    at: &'a mut [u64; BLOCK],
    rests: &'a mut Block,
    is_beyond: &'a mut bool,
}

impl VectorLoop for Places<'_> {
    #[inline(always)]
    fn run(self) {
        let count = self.shift.matrices().len() as u64;
        let mut is_beyond = false;
        for ((at, rest), w) in self.at.iter_mut().zip(self.rests).zip(self.ratios) {
            (*at, *rest) = self.shift.place(self.eye.ratio(*w));
            is_beyond |= *at >= count;
        }
        *self.is_beyond = is_beyond;
    }
}

/// Adds the colours of a line as seen at W `ratios`, times `factors`, without further details.
fn add_lines(
    wavelength: f64,
    emitted: &Emitted,
    ratios: &[f64],
    factors: &[f64],
    members: &[u32],
    sink: &mut impl RadianceSink,
) {
    let rays = members.iter().zip(&emitted.radiance);
    for ((ray, rgb), (w, factor)) in rays.zip(ratios.iter().zip(factors)) {
        let seen = line(*rgb, wavelength * w);
        sink.add(*ray as usize, seen.map(|c| factor * c));
    }
}

/// The colour of a line whose radiance is the mean of three channels.
fn line(rgb: [f64; 3], wavelength: f64) -> [f64; 3] {
    colour::line_colour(wavelength).map(|c| c * mean(rgb))
}

fn mean([r, g, b]: [f64; 3]) -> f64 {
    (r + g + b) / 3.0
}

/// Adds how much of the radiance of a run is covered by data.
fn cover(details: &[Detail], members: &[u32], sink: &mut impl RadianceSink) {
    let parts = details.iter().map(|detail| (detail.at, detail.coverage));
    sink.cover(members, parts);
}
