//! Baking: time-resolved light of objects at rest relative to each other, as cubes that any moving camera can look up.
//!
//! A cube holds for each pixel of a camera, or each texel of a surface, the energy of its radiance in each time bin: the integral of L over
//! the bin, averaged over the pixel or texel. Paths come from `TimedPaths`; the light of one path goes into all bins in which its lamps'
//! emission arrives, so the cost is that of the paths, whatever the bins: light of pulses much wider than the bins is put into bins once
//! for all paths. Each pixel or texel is summed by one thread, sample by sample, so the number of threads does not change a bit of the
//! result. Tiles of pixels and rows of texels are stored in a [`Journal`](crate::render::journal::Journal) as they are finished, if one is
//! given.
//!
//! # The standard error
//!
//! The samples of a texel form R = 2 or more independent parts ([`sampler`](crate::render::sampler)). With the sums S_k of part k in a bin,
//! the numbers f_k of its samples that lie on the surface, and the baked value m = Σ S_k/Σ f_k,
//!
//! ```text
//! standard error² = R/(R − 1) Σ (S_k − m f_k)²/(Σ f_k)²
//! ```
//!
//! (Cochran, Sampling Techniques, § 6.4; for equal f_k it is the variance of R means over R). For each bin the root mean square over all
//! texels is reported. Texels at the edges of charts that are hit by samples of one part only have no error estimate, and are left out.
//!
//! A camera's times are arrival times: times of emission at the surface, by the world's clock (or the first object's if everything moves),
//! plus η times the *distance* to the pinhole, as in mitransient with `camera_unwarp = false`, whose array layout (H, W, T, C) is used. A
//! surface's times are those of emission, and its radiance is the diffuse part, which is the same in all directions. If backs are visible,
//! they have the same number of rows after those of the fronts, at the same texture coordinates, unless no light reaches any of them. If
//! nothing that shines or reflects lies behind any triangle, none can, and these rows take no memory and no time.

mod camera;
mod charts;
mod histogram;
mod part;
mod stored;
mod surface;
mod trials;

pub use camera::{Captured, camera_cube, captured, check_camera};
pub use surface::{Coordinates, Surface, SurfaceNeeds, check_surface, surface_cube};
pub use trials::{Trial, Trials};

use self::part::Summary;
use self::stored::Stored;
use crate::error::{Error, Result};
use crate::io::cube::Cube;
use crate::io::npy::Dtype;
use crate::light::lamp::Emission;
use crate::mesh::atlas::Corners;
use crate::render::film::TILE;
use crate::render::prepare::Prepared;
use crate::render::trace::{RestFrame, TimedPaths};
use crate::scene::model::{
    Binding, Clock, CubeBacks, EmissionProfile, LightKind, Motion, Scene, SourceKind, Spectra,
};
use crate::spacetime::Velocity;

/// Time bins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bins {
    /// Time at the start of bin 0, metres.
    pub start: f64,
    /// Width of a bin, metres, above 0.
    pub width: f64,
    /// Number of bins, at least 1.
    pub count: usize,
}

/// The number format of a cube. Parts in a journal do not depend on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CubePrecision {
    /// f32.
    Single,
    /// f16, which takes half the memory.
    Half,
}

impl CubePrecision {
    /// The type of its numbers in files.
    pub fn dtype(self) -> Dtype {
        match self {
            CubePrecision::Single => Dtype::F32,
            CubePrecision::Half => Dtype::F16,
        }
    }

    /// Bytes per number.
    pub fn bytes(self) -> u64 {
        match self {
            CubePrecision::Single => 4,
            CubePrecision::Half => 2,
        }
    }
}

impl Bins {
    /// Refuses bins without any time, and cubes of `texels` texels that do not fit into memory.
    fn check<T: Stored>(&self, scene: &Scene, texels: usize) -> Result<()> {
        let refuse = |what: String, help| Err(Error::invalid(&scene.name, "bins", what, help));
        let Bins {
            start,
            width,
            count,
        } = *self;
        // Written so that NaN is refused, too.
        if !(start.is_finite() && width > 0.0 && width.is_finite()) {
            let what = format!("bins that are {width} m wide from {start} m on hold no light");
            return refuse(what, "a finite start, and a width above 0");
        }
        if count == 0 {
            return refuse("there is no bin".into(), "at least one");
        }
        let numbers = texels.checked_mul(count).and_then(|n| n.checked_mul(3));
        let fits = numbers.is_some_and(|n| Vec::<T>::new().try_reserve_exact(n).is_ok());
        match fits {
            true => Ok(()),
            false => refuse(
                format!("there is no memory for {texels} texels of {count} bins"),
                "fewer bins or texels",
            ),
        }
    }
}

/// Energy of light by arrival time, as in the cube (mean of R, G, B), summed over all pixels or texels.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Energy {
    /// Within the bins.
    pub held: f64,
    /// Before the first bin.
    pub before: f64,
    /// After the last bin.
    pub after: f64,
    /// When the first light begins to arrive, and when the last has arrived; `None` if it is dark.
    pub span: Option<[f64; 2]>,
}

/// A baked cube.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Baked {
    /// Energy per bin, (H, W, T, 3), linear RGB, f32 or f16.
    pub cube: Cube,
    /// For each bin, the root mean square over pixels or texels of the standard error of its energy (mean of R, G, B); texels hit by the
    /// samples of one part only are left out. NaN if no others are left, as with one sample.
    pub standard_error: Vec<f64>,
    /// The mean square of the energy (mean of R, G, B) over the same texels and all bins.
    mean_square: f64,
    /// The energy within the bins and outside them.
    pub energy: Energy,
    /// The part of the energy within the bins that is in numbers below the smallest normal one of the format, which holds few of their
    /// digits or none.
    pub faint: f64,
    /// The clock of its times.
    pub clock: Clock,
    /// What the cube shows on the backs of a surface.
    pub backs: CubeBacks,
    /// The texture coordinates generated for a surface, by triangle of its mesh and corner.
    pub texture_coordinates: Option<Vec<Corners>>,
}

impl Baked {
    /// Whether all bins are dark.
    pub fn is_dark(&self) -> bool {
        let [h, w, t, _] = self.cube.shape;
        let mut texels = 0..h * w;
        texels.all(|texel| (0..t).all(|bin| self.cube.total(texel, bin) == 0.0))
    }

    /// The root mean square over all bins of the standard error, relative to that of the energy of the same texels; NaN if all bins are
    /// dark.
    pub fn relative_error(&self) -> f64 {
        let bins = self.standard_error.len().max(1);
        let errors: f64 = self.standard_error.iter().map(|e| e * e).sum();
        match self.mean_square > 0.0 && !self.is_dark() {
            true => (errors / bins as f64 / self.mean_square).sqrt(),
            false => f64::NAN,
        }
    }
}

/// Parts of the samples of a texel: few, because samples within a part are better distributed, and the error is averaged over many texels.
const PARTS: u32 = 2;

/// Bytes per bin of the sums of a pixel or texel: two of three channels, two for the error, and those of wide pulses in at most half as
/// many bins and as many impulses, each f64.
const SUMS: u64 = 8 * 8 + 36;
/// Bytes per bin of its result, and of that as bytes of a journal.
const RESULT: u64 = 2 * 12;

/// Bytes of a camera's cube of `size` (columns and rows) and `bins`, and of the tiles in progress on this many threads.
pub fn camera_bytes(size: [u32; 2], bins: &Bins, precision: CubePrecision, threads: usize) -> u64 {
    let texels = u64::from(size[0]) * u64::from(size[1]);
    let tile = u64::from(TILE * TILE).min(texels) * (SUMS + RESULT);
    cube_bytes(size, bins, precision).saturating_add(of_threads(tile, bins, threads))
}

/// Bytes of a surface's cube of `size` (columns and rows, of both sides if it has [light on its back](SurfaceNeeds::backs)) and `bins`, and of
/// the rows in progress on this many threads; [lists](SurfaceNeeds::lists) come on top.
pub fn surface_bytes(size: [u32; 2], bins: &Bins, precision: CubePrecision, threads: usize) -> u64 {
    // Only one texel of a row is summed at a time, and no more rows than there are.
    let row = SUMS + u64::from(size[0]) * RESULT;
    let threads = threads.min(size[1] as usize);
    cube_bytes(size, bins, precision).saturating_add(of_threads(row, bins, threads))
}

/// Bytes of parts in progress, one per thread, of so many bytes per bin.
fn of_threads(part: u64, bins: &Bins, threads: usize) -> u64 {
    part.saturating_mul(bins.count as u64)
        .saturating_mul(threads as u64)
}

fn cube_bytes(size: [u32; 2], bins: &Bins, precision: CubePrecision) -> u64 {
    let [columns, rows] = size.map(u64::from);
    let texels = columns.saturating_mul(rows);
    let bins = bins.count as u64;
    // Besides its numbers: errors by row and bin, and coverage of texels, twice.
    let each = 3 * precision.bytes();
    let cube = texels.saturating_mul(bins).saturating_mul(each);
    let beside = rows.saturating_mul(8 * bins).saturating_add(2 * texels);
    cube.saturating_add(beside)
}

/// Refuses scenes whose light cannot be baked.
///
/// # Errors
/// Bodies or lamps that move relative to each other, light that never ends, cubes that light other surfaces, no lamps.
pub fn check(scene: &Scene) -> Result<()> {
    let refuse = |place: String, what: String, help: &str| {
        Err(Error::invalid(&scene.name, place, what, help))
    };
    if scene.spectra == Spectra::Sampled {
        let what = "what is baked has red, green and blue, and no spectra";
        let help = "leave `spectra` out, or follow light with `render.bounces`";
        return refuse("render.spectra".into(), what.into(), help);
    }
    let Some(first) = scene.objects.first() else {
        return Ok(());
    };
    // Bins use one clock: everything baked shares one rest frame.
    let moves = |velocity: Velocity| {
        let difference = velocity.rapidity() - first.velocity.rapidity();
        // Rapidities that are equal up to rounding.
        difference.length() > 1e-12
    };
    if let Some(other) = scene.objects.iter().find(|o| moves(o.velocity)) {
        let what = format!("it moves relative to \"{}\"", first.name);
        let help = "bake objects that are at rest relative to each other, each group in a scene of its own, or follow light with `render.bounces`";
        return refuse(format!("object \"{}\"", other.name), what, help);
    }
    // Light that never ends would need infinitely many bins.
    for light in &scene.lights {
        let place = format!("light \"{}\"", light.name);
        let with_an_end = |emission: &EmissionProfile| match emission {
            EmissionProfile::Train { .. } => {
                "give its train a `count` of pulses, or follow light with `render.bounces`"
            }
            EmissionProfile::Steady
            | EmissionProfile::Gaussian { .. }
            | EmissionProfile::Table(_) => {
                "give it an emission with an end, like emission = { gaussian = { sigma = \"5 cm\" } }, or follow light with `render.bounces`"
            }
        };
        let lamp = match &light.kind {
            LightKind::Lamp(lamp) => lamp,
            // Its object is at rest relative to the others.
            LightKind::Area { emission, .. } => match Emission::from(emission).span() {
                Some(_) => continue,
                None => return refuse(place, FOR_EVER.into(), with_an_end(emission)),
            },
        };
        if lamp.motion != Motion::Inertial || moves(lamp.velocity) {
            let what = format!("it moves relative to \"{}\"", first.name);
            let help = "a lamp that rests with the objects, or `render.bounces`";
            return refuse(place, what, help);
        }
        if Emission::from(&lamp.emission).span().is_none() {
            return refuse(place, FOR_EVER.into(), with_an_end(&lamp.emission));
        }
    }
    if scene.sky.as_ref().is_some_and(|sky| sky.lights) {
        let what = "it lights surfaces steadily, which does not fit into bins of time";
        return refuse("sky".into(), what.into(), "set sky.lights = false");
    }
    // Pulses are placed in the world's frame, so the objects must be at rest in it.
    let pulses = scene
        .sources
        .iter()
        .filter(|s| matches!(s.kind, SourceKind::Pulse(_)));
    if let Some(pulse) = pulses.clone().next().filter(|_| !first.velocity.is_rest()) {
        let what = format!(
            "a pulse leaves a place at rest in the world, and \"{}\" moves",
            first.name
        );
        let help = "a [[light]] of the same velocity, with a Gaussian emission";
        return refuse(format!("source \"{}\"", pulse.name), what, help);
    }
    // Without bounces surfaces receive no light of others.
    if let Some((place, what)) = shown_light(scene).filter(|_| scene.bounces > 0) {
        let what = format!("{what}, and what it sheds on other surfaces is not baked");
        let help = "leave the source out, so that lamps light the object, bake direct light alone (`render.bounces = 0`), or follow light with `render.bounces` and no bake";
        return refuse(place, what, help);
    }
    if scene.lights.is_empty() && pulses.count() == 0 {
        let help = "add [[light]] with an emission, like emission = { gaussian = { sigma = \"5 cm\" } }; with type = \"area\" and an object, its surface or what its materials emit";
        return refuse("light".into(), "there is no light to bake".into(), help);
    }
    Ok(())
}

impl Energy {
    const NONE: Energy = Energy {
        held: 0.0,
        before: 0.0,
        after: 0.0,
        span: None,
    };

    fn add(&mut self, other: &Energy) {
        self.held += other.held;
        self.before += other.before;
        self.after += other.after;
        self.span = match (self.span, other.span) {
            (Some([a, b]), Some([c, d])) => Some([a.min(c), b.max(d)]),
            (span, None) => span,
            (None, span) => span,
        };
    }
}

/// The first source whose light objects show instead of reflecting any, and what it does; `None` if there is no such source.
fn shown_light(scene: &Scene) -> Option<(String, String)> {
    let mut sources = scene.sources.iter();
    let source = sources.find(|s| matches!(s.kind, SourceKind::Cube(_)))?;
    let first = match &source.binding {
        Binding::All => 0,
        Binding::Only { objects, .. } => *objects.first()?,
    };
    let object = scene.objects.get(first)?;
    let what = format!("object \"{}\" shows its light", object.name);
    Some((format!("source \"{}\"", source.name), what))
}

/// Why light that never ends is refused.
const FOR_EVER: &str = "it never stops shining, so its light cannot be divided into time bins";

/// The paths of a scene without surfaces that shine for ever: only once models are loaded is it known which surfaces shine.
fn paths<'a>(scene: &Scene, prepared: &'a Prepared) -> Result<TimedPaths<'a>> {
    let rest = prepared.frames.first();
    let paths = match (rest, prepared.light.time_resolved()) {
        (Some(rest), Some(light)) if prepared.frames.len() == 1 => TimedPaths {
            rest,
            light,
            bounces: scene.bounces,
            method: prepared.method,
        },
        _ => {
            return Err(Error::invalid(
                &scene.name,
                "light",
                "no surface reflects any light",
                "objects that rest relative to each other, with lamps that light them",
            ));
        }
    };
    let Some(object) = paths.steady_object() else {
        return Ok(paths);
    };
    let name = &scene.objects[object as usize].name;
    let help = format!(
        "give it light with an end: [[light]] with type = \"area\", object = {name:?} and emission = {{ gaussian = {{ sigma = \"5 cm\" }} }} (radiance = 0 leaves its own light out); or follow light with `render.bounces`"
    );
    let place = format!("object \"{name}\"");
    Err(Error::invalid(&scene.name, place, FOR_EVER, help))
}

fn baked<T: Stored>(
    scene: &Scene,
    prepared: &Prepared,
    [height, width]: [usize; 2],
    bins: &Bins,
    values: Vec<T>,
    summaries: &[Summary],
) -> Result<Baked> {
    let mut energy = Energy::NONE;
    summaries.iter().for_each(|part| energy.add(&part.energy));
    let faint: f64 = summaries.iter().map(|part| part.faint).sum();
    let texels: u64 = summaries.iter().map(|part| part.texels).sum();
    // The root mean square of the standard errors over all texels.
    let square = |bin: usize| {
        summaries
            .iter()
            .map(|part| part.error_squares[bin])
            .sum::<f64>()
    };
    let standard_error = (0..bins.count).map(|bin| (square(bin) / texels as f64).sqrt());
    let standard_error = standard_error.collect();
    let squares: f64 = summaries.iter().map(|part| part.energy_squares).sum();
    T::check(&values, scene)?;
    let cube = Cube::new([height, width, bins.count, 3], T::samples(values));
    let cube = cube.map_err(|e| {
        let help = "use a dimmer lamp: f32 cannot hold this light";
        Error::invalid(&scene.name, "light", e.to_string(), help)
    })?;
    // If everything moves, times are those of the objects' own frame.
    let still = |frame: &RestFrame| frame.frame.velocity().is_rest();
    Ok(Baked {
        cube,
        standard_error,
        mean_square: squares / (texels as f64 * bins.count as f64),
        energy,
        faint: if faint > 0.0 {
            faint / energy.held
        } else {
            0.0
        },
        clock: match prepared.frames.iter().all(still) {
            true => Clock::World,
            false => Clock::Object,
        },
        backs: CubeBacks::AsFront,
        texture_coordinates: None,
    })
}
