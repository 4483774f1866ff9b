//! Films that are shifted or scaled, from light only.
//!
//! If no channel shows which point of a surface a pixel shows, the pictures themselves are registered. With p from the film's centre, the
//! candidate c is assumed to be the reference r seen through another film,
//!
//! ```text
//! c(p) = r(p′),      p′ = a + k p        a shift (k = 1), one scale (a = 0), or two (a = 0)
//! ```
//!
//! by the Gauss–Newton steps of Lucas and Kanade (IJCAI 1981) on blurred light: with the gradient g of r(p′), c − r = g·∂p′, least squares
//! over all pixels and colours; from coarse pictures to fine ones, so that displacements of many pixels are found. Light v is compressed to
//! v / (|v| + m), with m the reference's median, so that lamps do not dominate.
//!
//! A camera that ignored its boost, or reversed it, sees the same light at other film points: p′ is known then, without free parameters.
//!
//! Pictures of single samples cannot be interpolated to what other samples would see, so no hypothesis explains all of the error. It must
//! explain most of it, in most places: of 8 × 8 tiles, it must halve the squared error E of those that hold most of Σ E^(1/4). That root
//! gives places with little contrast nearly the same weight as others, so that a single moving part does not pass: what stands still would
//! have to move, too. And sharp edges of the reference that such a film moves by several pixels must not still be at their old positions:
//! they are if only light has changed, such as for a pulse that spreads.

use glam::{DMat2, DVec2};
use rayon::prelude::*;

use super::super::known::Change;
use super::super::picture::{Plane, RADIANCE};
use super::film::{self, Film};
use super::motion::describe_aberration_by_light;
use super::{Case, Diagnosis, Kind, MOST, median};
use crate::error::Setting;

/// The largest fraction of the squared error that a shift, and a scale, may leave: single samples at edges leave up to half of the error of
/// a half-pixel shift.
const LEFT_BY_SHIFT: f64 = 0.5;
const LEFT_BY_SCALE: f64 = 0.35;
/// Two scales fit a camera that is turned or raised, which leaves 0.23 and more; those of another aspect leave 0.02 at centres of pixels.
const LEFT_BY_TWO_SCALES: f64 = 0.2;
/// The fraction of the tiles, by the fourth root of their error, in which half must be explained: 0.69 and more for films, and 0.45 and
/// less for moving parts, in the scenes of this repository.
const MOST_TILES: f64 = 0.6;
/// Tiles with a smaller fraction of the largest tile's error are noise.
const QUIET: f64 = 1e-3;
/// A hypothesis with fewer free parameters is preferred up to this factor on the smallest residual.
const SIMPLER: f64 = 1.5;
/// The smallest notable displacement, pixels, rms over the film.
const NOTABLE: f64 = 0.15;
/// The smallest notable difference of compressed light, rms.
const NOTABLE_LIGHT: f64 = 0.005;
/// The longest shift reported, pixels: longer ones are tested as whole pixels.
const LONGEST: f64 = 2.5;
/// Tiles along each axis, and the fraction of a tile's pixels that both films must show.
const TILES: usize = 8;
const MOST_OF_TILE: f64 = 0.5;
/// The fraction of the candidate that the reference must show.
const OVERLAP: f64 = 0.25;
/// Pictures whose shorter side has fewer pixels are not halved any more: the search starts on the first such picture.
const COARSE: usize = 24;
/// The largest number of pixels of the finest picture that is searched: larger ones are halved first.
const FINEST: usize = 500_000;
/// Scales where the search starts, on the coarsest pictures.
const STARTS: [f64; 5] = [0.75, 0.87, 1.0, 1.15, 1.33];
/// The smallest scale that is found, and one over the largest: 9 to 16, with a margin.
const SMALLEST: f64 = 0.55;
/// Steps on each level.
const STEPS: usize = 10;

/// A candidate whose film is shifted or scaled, or whose light has the aberration of another velocity, and the fraction of the squared
/// error that this leaves. If the scene itself was tested (`scene_was_tested`), no boost is: its light has excluded them.
pub(super) fn found(case: &Case, scene_was_tested: bool) -> Option<(Diagnosis, f64)> {
    if !case.region.is_all() {
        return None;
    }
    let pair = compressed(case)?;
    if rms_difference(&pair) <= NOTABLE_LIGHT {
        return None;
    }
    let levels = Levels::of(pair);
    let boosts: &[Change] = if scene_was_tested { &[] } else { &BOOSTS };
    let mut fits: Vec<Fit> = (boosts.iter().copied())
        .filter_map(|change| boosted(case, &levels, change))
        .collect();
    let films: Vec<Option<Fit>> = (MODELS.par_iter())
        .map(|model| model.fit(&levels))
        .collect();
    fits.extend(films.into_iter().flatten());
    let single = has_single_samples(case);
    fits.retain(|fit| match &fit.cause {
        Cause::Film(film) => {
            let is_rounding = single
                && match film.k == DVec2::ONE {
                    true => fit.displacement < ROUNDED_SHIFT && fit.tiles < MOST_TILES_OF_SHIFT,
                    false => levels.edges_move(|p| film.of(p)) <= ROUNDED_OUTLINE,
                };
            !is_rounding && !levels.edges_stay(|p| film.of(p))
        }
        Cause::Boost(_) => true,
    });
    let least = fits.iter().map(|fit| fit.left).reduce(f64::min)?;
    let best = fits.into_iter().find(|fit| fit.left <= SIMPLER * least)?;
    let left = best.left;
    Some((best.or_boost(case, &levels, boosts).describe(case), left))
}

/// Single samples round the outline of surfaces by up to half a pixel on each side, which may look like another scale: for such pictures a
/// scale must move the outer edges by more than that and the fit's error, pixels.
const ROUNDED_OUTLINE: f64 = 0.7;

/// The same for a shift, pixels, and the fraction of tiles that a smaller one must explain: other samples explain up to 0.61.
const ROUNDED_SHIFT: f64 = 0.4;
const MOST_TILES_OF_SHIFT: f64 = 0.65;

/// Whether a picture has, or may have, single samples: unless it states its number of samples.
fn has_single_samples(case: &Case) -> bool {
    let are_many = |picture: &super::super::picture::Picture| {
        let samples = picture.metadata("samples_per_pixel");
        samples.is_some_and(|n| n.parse::<u32>().is_ok_and(|n| n > 1))
    };
    !case.pair.into_iter().all(are_many)
}

/// Velocities that the camera may have by mistake.
const BOOSTS: [Change; 2] = [Change::CameraAtRest, Change::CameraReversed];
/// A boost and another film are alike if they differ by less than this fraction of their displacement.
const ALIKE: f64 = 0.2;

/// An explanation of the error.
#[derive(Debug)]
struct Fit {
    cause: Cause,
    /// The rms displacement over the film, pixels.
    displacement: f64,
    /// The fraction of the squared error that is left.
    left: f64,
    /// The fraction of the tiles in which it explains half.
    tiles: f64,
}

#[derive(Debug)]
enum Cause {
    Boost(Change),
    Film(Film),
}

impl Fit {
    /// A camera that moves along its axis sees nearly the same through another film; its motion is known.
    fn or_boost(self, case: &Case, levels: &Levels, boosts: &[Change]) -> Fit {
        let Cause::Film(film) = self.cause else {
            return self;
        };
        let film = Film {
            a: film.a / levels.scale,
            ..film
        };
        let finest = &levels.pairs[0][0];
        let is_alike = |change: &Change| {
            let Some(place) = boost(case, levels.scale, *change) else {
                return false;
            };
            let off = finest.rms_over_film(|p| Some(place(p)? - film.of(p)));
            off <= ALIKE * self.displacement / levels.scale
        };
        match boosts.iter().copied().find(is_alike) {
            Some(change) => Fit {
                cause: Cause::Boost(change),
                ..self
            },
            None => self,
        }
    }

    fn describe(&self, case: &Case) -> Diagnosis {
        let evidence = vec![
            (
                "judged by light only: displacement (pixels, rms)",
                self.displacement,
            ),
            ("what it leaves of the squared error", self.left),
            (
                "part of the error in tiles of which it explains half",
                self.tiles,
            ),
        ];
        match &self.cause {
            Cause::Boost(change) => describe_aberration_by_light(case, *change, evidence),
            Cause::Film(film) => {
                let mut found = film::describe(case, film, film::BY_LIGHT, evidence);
                // Light that spreads in time may look like another scale if nothing is known of the scene.
                let is_scale = matches!(found.kind, Kind::Aspect | Kind::FieldOfView);
                if is_scale && case.known.is_none() && case.scene.is_none() {
                    found.what +=
                        " (by light alone: where a pulse spreads, another time looks alike; ";
                    found.what += Setting::Scene + " tells)";
                }
                found
            }
        }
    }
}

/// Colours of the pixels of a picture, row by row.
#[derive(Debug, Clone)]
struct Light {
    width: usize,
    height: usize,
    colours: Vec<[f64; 3]>,
}

/// The light of both pictures.
fn compressed(case: &Case) -> Option<[Light; 2]> {
    let [width, height] = case.points[0].size();
    let [r, c] = case.pair.map(|p| Plane::group(&p.layers, RADIANCE));
    let planes = [r?, c?];
    let values = |planes: &[Plane; 3]| -> Vec<[f64; 3]> {
        let pixels = (0..width * height).into_par_iter();
        pixels.map(|i| planes.map(|plane| plane.at(i))).collect()
    };
    let [r, c] = planes.each_ref().map(values);
    let lit = r.iter().flatten().filter(|v| **v > 0.0 && v.is_finite());
    let middle = median(lit.copied().collect())?;
    // Maps light to [0, 1), so that bright pixels do not dominate.
    let compress = |v: f64| match v {
        v if v.is_nan() => 0.0,
        v if v.is_infinite() => 1.0,
        v => v / (v.abs() + middle),
    };
    Some([r, c].map(|colours| Light {
        width,
        height,
        colours: colours.into_par_iter().map(|v| v.map(compress)).collect(),
    }))
}

/// The blurred light of both pictures.
pub(super) struct Blurred([Light; 2]);

impl Blurred {
    /// `None` without light, if only a part of the pictures is compared, or if they hardly differ.
    pub fn of(case: &Case) -> Option<Blurred> {
        case.region.is_all().then_some(())?;
        let pair = compressed(case)?.map(|light| light.blurred(BLUR));
        (rms_difference(&pair) > NOTABLE_LIGHT).then_some(Blurred(pair))
    }

    /// The mean squared difference if the candidate's pixel `source(i)` belongs at `i`.
    pub fn error(&self, source: impl Fn(usize) -> Option<usize>) -> f64 {
        let Blurred([r, c]) = self;
        let pairs = (0..r.colours.len()).filter_map(|i| Some((i, source(i)?)));
        let squares = pairs.map(|(i, j)| square(difference(r.colours[i], c.colours[j])));
        let (count, sum) = squares.fold((0.0, 0.0), |(n, sum), d| (n + 1.0, sum + d));
        sum / f64::max(count, 1.0)
    }
}

fn rms_difference([r, c]: &[Light; 2]) -> f64 {
    let sum: f64 = (r.colours.iter().zip(&c.colours))
        .map(|(r, c)| square(difference(*r, *c)))
        .sum();
    (sum / r.colours.len() as f64).sqrt()
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn square(a: [f64; 3]) -> f64 {
    a.iter().map(|v| v * v).sum()
}

impl Light {
    /// The film's centre relative to the centre of the first pixel.
    fn middle(&self) -> DVec2 {
        0.5 * (DVec2::new(self.width as f64, self.height as f64) - 1.0)
    }

    fn size(&self) -> DVec2 {
        DVec2::new(self.width as f64, self.height as f64)
    }

    /// The position of a pixel's centre relative to the film's centre.
    fn place(&self, i: usize) -> DVec2 {
        DVec2::new((i % self.width) as f64, (i / self.width) as f64) - self.middle()
    }

    /// The rms length of a displacement over the film, where it exists.
    fn rms_over_film(&self, displacement: impl Fn(DVec2) -> Option<DVec2>) -> f64 {
        let squares = (0..self.colours.len())
            .filter_map(|i| Some(displacement(self.place(i))?.length_squared()));
        let (count, sum) = squares.fold((0.0, 0.0), |(n, sum), d| (n + 1.0, sum + d));
        libm::sqrt(sum / f64::max(count, 1.0))
    }

    /// The change of the light to the next pixel on the right and below; `None` at the last.
    fn contrast(&self, i: usize) -> Option<f64> {
        let (x, y) = (i % self.width, i / self.width);
        (x + 1 < self.width && y + 1 < self.height).then(|| {
            let next = [i + 1, i + self.width].map(|j| self.colours[j]);
            let changes = next.map(|next| square(difference(next, self.colours[i])).sqrt());
            changes[0].max(changes[1])
        })
    }

    /// Means of 2 × 2 pixels.
    fn halved(&self) -> Light {
        let (width, height) = (self.width / 2, self.height / 2);
        let mean = |i: usize| {
            let at = 2 * (i / width) * self.width + 2 * (i % width);
            let four = [at, at + 1, at + self.width, at + self.width + 1];
            std::array::from_fn(|k| 0.25 * four.iter().map(|j| self.colours[*j][k]).sum::<f64>())
        };
        Light {
            width,
            height,
            colours: (0..width * height).map(mean).collect(),
        }
    }

    /// Bilinear interpolation between pixels; `None` beyond the outermost centres.
    fn at(&self, place: DVec2) -> Option<[f64; 3]> {
        let p = place + self.middle();
        let last = self.size() - 1.0;
        let is_inside = p.cmpge(DVec2::ZERO).all() && p.cmple(last).all();
        is_inside.then_some(())?;
        // A picture with one row or column is constant across it.
        let (x, y) = (
            (p.x as usize).min(self.width.saturating_sub(2)),
            (p.y as usize).min(self.height.saturating_sub(2)),
        );
        let right = usize::from(self.width > 1);
        let below = if self.height > 1 { self.width } else { 0 };
        let (u, v) = (p.x - x as f64, p.y - y as f64);
        let i = y * self.width + x;
        let [a, b] = [i, i + below].map(|i| [self.colours[i], self.colours[i + right]]);
        Some(std::array::from_fn(|k| {
            let [above, below] = [a, b].map(|[left, right]| left[k] + u * (right[k] - left[k]));
            above + v * (below - above)
        }))
    }

    /// Blurred by a Gaussian of this standard deviation, with the edges extended.
    fn blurred(&self, sigma: f64) -> Light {
        let reach = (3.0 * sigma).ceil() as isize;
        let weights: Vec<f64> = (-reach..=reach)
            .map(|x| libm::exp(-0.5 * (x as f64 / sigma).powi(2)))
            .collect();
        let sum: f64 = weights.iter().sum();
        let weights: Vec<f64> = weights.iter().map(|weight| weight / sum).collect();
        let (width, height) = (self.width, self.height);
        // Sums of whole rows of numbers, each times one weight, which are loops for the vector unit.
        let add = |to: &mut [f64], weight: f64, from: &[f64]| {
            to.iter_mut()
                .zip(from)
                .for_each(|(to, v)| *to += weight * v);
        };
        let across = |row: usize, to: &mut [[f64; 3]]| {
            let clamped = |x: isize| x.clamp(0, width as isize - 1) as usize;
            // The row with its ends repeated.
            let places = -reach..width as isize + reach;
            let extended: Vec<[f64; 3]> = places
                .map(|x| self.colours[row * width + clamped(x)])
                .collect();
            for (k, weight) in weights.iter().enumerate() {
                add(to.as_flattened_mut(), *weight, extended[k..].as_flattened());
            }
        };
        let mut rows = vec![[0.0; 3]; self.colours.len()];
        rows.par_chunks_mut(width.max(1))
            .enumerate()
            .for_each(|(row, to)| across(row, to));
        let mut colours = vec![[0.0; 3]; self.colours.len()];
        colours
            .par_chunks_mut(width.max(1))
            .enumerate()
            .for_each(|(row, to)| {
                for (y, weight) in (-reach..=reach).zip(&weights) {
                    let from = row.saturating_add_signed(y).min(height - 1) * width;
                    add(
                        to.as_flattened_mut(),
                        *weight,
                        rows[from..][..width].as_flattened(),
                    );
                }
            });
        Light { colours, ..*self }
    }

    /// The blurred picture of a film that shows at each position what this one has at `place` of it, and which pixels lie in this one.
    fn through(
        &self,
        place: impl Fn(DVec2) -> Option<DVec2> + Sync,
        sigma: f64,
    ) -> (Light, Vec<bool>) {
        let last = self.middle();
        let seen = |i: usize| {
            let place = place(self.place(i));
            let found = place.and_then(|p| self.at(p));
            // Beyond the edge, the edge is extended so that the blur of the interior has no dark border.
            let beside = || self.at(place.unwrap_or_default().clamp(-last, last));
            (found.or_else(beside).unwrap_or_default(), found.is_some())
        };
        let (mut colours, mut inside) = (Vec::new(), Vec::new());
        let pixels = (0..self.colours.len()).into_par_iter();
        pixels.map(seen).unzip_into_vecs(&mut colours, &mut inside);
        (Light { colours, ..*self }.blurred(sigma), inside)
    }
}

/// Both pictures at successive half resolutions, the finest first.
struct Levels {
    pairs: Vec<[Light; 2]>,
    /// Pixels of the pictures per pixel of the finest level.
    scale: f64,
}

/// Standard deviations of the blur on the coarsest level, and on the others, pixels.
const COARSE_BLUR: f64 = 0.7;
const BLUR: f64 = 1.0;

impl Levels {
    fn of(pair: [Light; 2]) -> Levels {
        let halved = |pair: &[Light; 2]| pair.each_ref().map(Light::halved);
        let mut scale = 1.0;
        let mut finest = pair;
        while finest[0].colours.len() > FINEST && finest[0].width.min(finest[0].height) >= COARSE {
            finest = halved(&finest);
            scale *= 2.0;
        }
        let mut pairs = Vec::new();
        let mut last = finest;
        while last[0].width.min(last[0].height) >= COARSE {
            let next = halved(&last);
            pairs.push(std::mem::replace(&mut last, next));
        }
        pairs.push(last);
        Levels { pairs, scale }
    }
}

/// The fraction of the pixels with the sharpest edges, and the distance in pixels that a film must move the tested ones.
const SHARPEST: f64 = 0.02;
const FAR: f64 = 2.5;
/// An edge has stayed if the candidate has this fraction of its contrast; edges have stayed if this fraction of them has, of at least this
/// number.
const CONTRAST: f64 = 0.3;
const STAYS: f64 = 0.5;
const FEWEST_EDGES: usize = 24;

impl Levels {
    /// The most that a film with `place` (pixels of the pictures) moves most of the reference's edges, weighted by the square of their
    /// contrast.
    fn edges_move(&self, place: impl Fn(DVec2) -> DVec2) -> f64 {
        let r = &self.pairs[0][0];
        let mut edges: Vec<[f64; 2]> = (0..r.colours.len())
            .filter_map(|i| {
                let p = self.scale * r.place(i);
                Some([(place(p) - p).length(), r.contrast(i)?.powi(2)])
            })
            .collect();
        edges.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut left = MOST * edges.iter().map(|[_, weight]| weight).sum::<f64>();
        let most = edges.iter().find(|[_, weight]| {
            left -= weight;
            left <= 0.0
        });
        most.map_or(0.0, |[moved, _]| *moved)
    }

    /// Whether edges of the reference that a film with `place` (pixels of the pictures) moves far are still at their old positions.
    fn edges_stay(&self, place: impl Fn(DVec2) -> DVec2) -> bool {
        let [r, c] = &self.pairs[0];
        let mut edges: Vec<(usize, f64)> = (0..r.colours.len())
            .filter_map(|i| Some((i, r.contrast(i)?)))
            .collect();
        edges.sort_by(|a, b| b.1.total_cmp(&a.1));
        edges.truncate((SHARPEST * edges.len() as f64) as usize);
        // The reference's edge at q should be where place(p) = q: about as far from q as place(q) is.
        edges.retain(|(i, _)| {
            let p = self.scale * r.place(*i);
            (place(p) - p).length() > FAR * self.scale
        });
        let stays = |(i, contrast): &&(usize, f64)| {
            c.contrast(*i)
                .is_some_and(|found| found >= CONTRAST * contrast)
        };
        let stay = edges.iter().filter(stays).count();
        edges.len() >= FEWEST_EDGES && stay as f64 >= STAYS * edges.len() as f64
    }
}

/// The free parameters of a film: the directions of steps in (a, k), and the start of the search.
struct Model {
    directions: &'static [[DVec2; 2]],
    scales: fn() -> Vec<DVec2>,
    left: f64,
}

/// The simplest first.
const MODELS: [Model; 3] = [
    Model {
        directions: &[[DVec2::X, DVec2::ZERO], [DVec2::Y, DVec2::ZERO]],
        scales: || vec![DVec2::ONE],
        left: LEFT_BY_SHIFT,
    },
    Model {
        directions: &[[DVec2::ZERO, DVec2::ONE]],
        scales: || STARTS.map(DVec2::splat).to_vec(),
        left: LEFT_BY_SCALE,
    },
    Model {
        directions: &[[DVec2::ZERO, DVec2::X], [DVec2::ZERO, DVec2::Y]],
        scales: || {
            let pairs = STARTS
                .iter()
                .flat_map(|x| STARTS.map(|y| DVec2::new(*x, y)));
            pairs.collect()
        },
        left: LEFT_BY_TWO_SCALES,
    },
];

impl Model {
    fn fit(&self, levels: &Levels) -> Option<Fit> {
        let (coarsest, finer) = levels.pairs.split_last()?;
        let starts = (self.scales)()
            .into_iter()
            .map(|k| Film { a: DVec2::ZERO, k });
        let tried = starts.filter_map(|film| self.refined(coarsest, film, COARSE_BLUR));
        let (mut film, _) = tried.min_by(|a, b| a.1.total_cmp(&b.1))?;
        for pair in finer.iter().rev() {
            // Pixels of the next finer level are half as large.
            film.a *= 2.0;
            film = self.refined(pair, film, BLUR)?.0;
        }
        let [finest, ..] = &levels.pairs[..] else {
            return None;
        };
        let (mut left, mut tiles) = explained(finest, |p| Some(film.of(p)))?;
        // Without its weakly determined part a shift is simpler.
        if let Some(strong) = self.strong_part(finest, &film) {
            let explained = explained(finest, |p| Some(strong.of(p)))?;
            if explained.0 <= SIMPLER * left {
                (film, (left, tiles)) = (strong, explained);
            }
        }
        film.a *= levels.scale;
        let half = 0.5 * levels.scale * finest[0].size();
        // Over the film, p² has the mean half²/3.
        let scaled = (film.k - 1.0) * half;
        let displacement = (film.a.length_squared() + scaled.length_squared() / 3.0).sqrt();
        let is_near = film.a.length() <= LONGEST;
        let explains = left <= self.left && tiles >= MOST_TILES && displacement > NOTABLE;
        (is_near && explains).then_some(Fit {
            cause: Cause::Film(film),
            displacement,
            left,
            tiles,
        })
    }

    /// The film after Gauss–Newton steps, and the mean squared error that it leaves.
    fn refined(&self, [r, c]: &[Light; 2], mut film: Film, sigma: f64) -> Option<(Film, f64)> {
        let wanted = c.blurred(sigma);
        let half = 0.5 * r.size().max_element();
        for _ in 0..STEPS {
            let (shown, inside) = r.through(|p| Some(film.of(p)), sigma);
            let step = self.step(&shown, &wanted, &inside, &film)?;
            film.a += step[0];
            film.k += step[1];
            let is_sane = film.k.min_element() > SMALLEST && film.k.max_element() * SMALLEST < 1.0;
            is_sane.then_some(())?;
            // Converged: the step moves the film by less than a thousandth of a pixel.
            if step[0].abs().max((half * step[1]).abs()).max_element() < 1e-3 {
                break;
            }
        }
        let (shown, inside) = r.through(|p| Some(film.of(p)), sigma);
        let errors = (0..inside.len()).filter(|i| inside[*i]);
        let errors = errors.map(|i| square(difference(wanted.colours[i], shown.colours[i])));
        let (count, sum) = errors.fold((0.0, 0.0), |(n, sum), e| (n + 1.0, sum + e));
        (count >= OVERLAP * inside.len() as f64).then(|| (film, sum / count))
    }

    /// The shift of `film` across most edges, if there are few other edges; `None` for other models, and where both directions are
    /// determined.
    fn strong_part(&self, [r, c]: &[Light; 2], film: &Film) -> Option<Film> {
        let is_shift = self.directions.iter().all(|[_, k]| *k == DVec2::ZERO);
        is_shift.then_some(())?;
        let (shown, inside) = r.through(|p| Some(film.of(p)), BLUR);
        let (normal, _) = self.normal(&shown, &c.blurred(BLUR), &inside, film);
        let [larger, smaller] = eigenvalues(normal);
        let along = strong_direction(normal);
        (smaller < WEAK * larger).then(|| Film {
            a: along * along.dot(film.a),
            ..*film
        })
    }

    /// The normal matrix and the right-hand side of the least squares step.
    fn normal(
        &self,
        shown: &Light,
        wanted: &Light,
        inside: &[bool],
        film: &Film,
    ) -> (DMat2, DVec2) {
        let (mut normal, mut right) = (DMat2::ZERO, DVec2::ZERO);
        for y in 1..shown.height - 1 {
            for x in 1..shown.width - 1 {
                let i = y * shown.width + x;
                if !inside[i] {
                    continue;
                }
                let p = shown.place(i);
                for k in 0..3 {
                    let at = |j: usize| shown.colours[j][k];
                    let across = 0.5 * (at(i + 1) - at(i - 1));
                    let down = 0.5 * (at(i + shown.width) - at(i - shown.width));
                    // ∂r/∂p′ = (∂r/∂p) / k.
                    let gradient = DVec2::new(across, down) / film.k;
                    let mut row = [0.0; 2];
                    for (row, [a, k]) in row.iter_mut().zip(self.directions) {
                        *row = gradient.dot(*a + *k * p);
                    }
                    let row = DVec2::from_array(row);
                    normal += DMat2::from_cols(row * row.x, row * row.y);
                    right += row * (wanted.colours[i][k] - shown.colours[i][k]);
                }
            }
        }
        (normal, right)
    }

    /// The least squares step of (a, k).
    fn step(
        &self,
        shown: &Light,
        wanted: &Light,
        inside: &[bool],
        film: &Film,
    ) -> Option<[DVec2; 2]> {
        let (mut normal, right) = self.normal(shown, wanted, inside, film);
        // With one free parameter the other's row is empty.
        if self.directions.len() == 1 {
            normal.y_axis.y = 1.0;
        }
        // Along edges that all have one direction no shift is seen: there is no step in that one.
        let step = match self.directions {
            [_, _] => step_where_seen(normal, right),
            _ => normal.inverse() * right,
        };
        let along = |which: usize| {
            let parts = self.directions.iter().zip(step.to_array());
            parts.map(|(d, s)| d[which] * s).sum::<DVec2>()
        };
        step.is_finite().then(|| [along(0), along(1)])
    }
}

/// The least fraction of the larger eigenvalue of the normal matrix that the smaller one must have for its parameter to be fitted.
const SEEN: f64 = 0.01;
/// The same below which a shift along the weaker direction must explain part of the error by itself.
const WEAK: f64 = 0.25;

/// The least squares step, of the better determined parameter alone where the other is hardly determined.
fn step_where_seen(normal: DMat2, right: DVec2) -> DVec2 {
    let [larger, smaller] = eigenvalues(normal);
    if smaller >= SEEN * larger {
        return normal.inverse() * right;
    }
    let along = strong_direction(normal);
    along * (along.dot(right) / larger)
}

/// The eigenvalues of a symmetric matrix, the larger first.
fn eigenvalues(m: DMat2) -> [f64; 2] {
    let [a, b, d] = [m.x_axis.x, m.x_axis.y, m.y_axis.y];
    let (middle, half) = (0.5 * (a + d), 0.5 * libm::hypot(a - d, 2.0 * b));
    [middle + half, middle - half]
}

/// The unit eigenvector of the larger eigenvalue of a symmetric matrix.
fn strong_direction(m: DMat2) -> DVec2 {
    let angle = 0.5 * libm::atan2(2.0 * m.x_axis.y, m.x_axis.x - m.y_axis.y);
    DVec2::new(libm::cos(angle), libm::sin(angle))
}

/// The fraction of the squared error that a hypothesis leaves where both films see, and the fraction of the tiles in which it explains
/// half; `place` maps the candidate's positions to the reference's. `None` if there are too few tiles.
fn explained(
    [r, c]: &[Light; 2],
    place: impl Fn(DVec2) -> Option<DVec2> + Sync,
) -> Option<(f64, f64)> {
    let [before, wanted] = [r, c].map(|light| light.blurred(BLUR));
    let (after, inside) = r.through(place, BLUR);
    let mut tiles = vec![[0.0; 3]; TILES * TILES];
    let mut sizes = vec![0.0; TILES * TILES];
    for (i, inside) in inside.iter().enumerate() {
        let (x, y) = (i % r.width, i / r.width);
        let at = y * TILES / r.height * TILES + x * TILES / r.width;
        sizes[at] += 1.0;
        if *inside {
            let wanted = wanted.colours[i];
            let errors =
                [before.colours[i], after.colours[i]].map(|v| square(difference(wanted, v)));
            let [count, was, is] = &mut tiles[at];
            (*count, *was, *is) = (*count + 1.0, *was + errors[0], *is + errors[1]);
        }
    }
    let seen = tiles.iter().zip(&sizes);
    let seen = seen.filter(|([count, ..], size)| *count >= MOST_OF_TILE * **size && **size > 0.0);
    let seen: Vec<[f64; 2]> = seen.map(|([_, was, is], _)| [*was, *is]).collect();
    let [was, is] = [0, 1].map(|k| seen.iter().map(|tile| tile[k]).sum::<f64>());
    let largest = seen.iter().map(|[was, _]| *was).fold(0.0, f64::max);
    let loud = seen
        .iter()
        .filter(|[was, is]| was.max(*is) > QUIET * largest);
    let (all, half) = loud.fold((0.0, 0.0), |(all, half), [was, is]| {
        // By the root of the error (these are squares), so that tiles with large errors do not dominate.
        let weight = was.max(*is).sqrt().sqrt();
        let is_explained = *is <= 0.5 * was;
        (all + weight, half + if is_explained { weight } else { 0.0 })
    });
    (all > 0.0 && was > 0.0).then(|| (is / was, half / all))
}

/// The position in the reference of what a camera with another velocity, or at rest, sees at a position.
fn boost<'a>(
    case: &Case<'a>,
    scale: f64,
    change: Change,
) -> Option<impl Fn(DVec2) -> Option<DVec2> + Sync + 'a> {
    let known = case.known?;
    let changed = known.changed(change)?;
    let [width, height] = case.points[0].size();
    let half = 0.5 * DVec2::new(width as f64, height as f64);
    Some(move |p: DVec2| {
        let seen = known.film_point_along(changed.look_along(half + scale * p)?)?;
        Some((seen - half) / scale)
    })
}

/// The same light in the film of a camera with another velocity, or at rest.
fn boosted(case: &Case, levels: &Levels, change: Change) -> Option<Fit> {
    let [finest, ..] = &levels.pairs[..] else {
        return None;
    };
    let place = boost(case, levels.scale, change)?;
    let (left, tiles) = explained(finest, &place)?;
    let displacement = levels.scale * finest[0].rms_over_film(|p| Some(place(p)? - p));
    let explains = left <= LEFT_BY_SCALE && tiles >= MOST_TILES && displacement > NOTABLE;
    explains.then_some(Fit {
        cause: Cause::Boost(change),
        displacement,
        left,
        tiles,
    })
}
