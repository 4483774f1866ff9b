//! The light of a scene in the candidate's pixels, rendered as the reference was.

use glam::DVec3;

use super::super::known::is_all_in_its_text;
use super::light::{Fit, Lit, fit};
use super::{Case, FEWEST_ASKED};
use crate::render::aov::Aov;
use crate::render::film::{Film, TILE, Tile};
use crate::render::plan::{Plan, Request};
use crate::render::prepare::Prepared;
use crate::render::progress::Silent;
use crate::render::{render, render_every};
use crate::scene::model::Scene;

/// The most samples per pixel, and the most rays of a picture: edges alone need more.
const MOST_SAMPLES: u32 = 16;
const MOST_RAYS: usize = 4_000_000;
/// The most memory for a scene without files, which may come from any picture's metadata.
pub(super) const MEMORY: u64 = 1 << 30;

/// The light of a scene, for each pixel.
#[derive(Clone)]
pub(super) struct Light(pub Vec<[f64; 3]>);

impl Light {
    pub fn fit(&self, lit: &[Lit]) -> Fit {
        fit(lit, |i, _| self.0[i])
    }
}

/// The light of a scene in the candidate's pixels.
pub(super) fn light_of(case: &Case, scene: &Scene, lit: &[Lit]) -> Option<Light> {
    light_of_all(&prepared(case, scene)?, lit)
}

/// The indices of the objects that a scene shows in the candidate's pixels, −1 for none.
pub(super) fn objects_of(case: &Case, scene: &Scene) -> Option<Vec<f64>> {
    let prepared = prepared_with(case, scene, vec![Aov::Object])?;
    let film = render(&prepared, &Silent).ok()?;
    Some(film.aov(Aov::Object)?.to_vec())
}

/// The same as [`light_of`], with the largest distance in metres of surfaces from the origins of their rest frames.
pub(super) fn light_and_size_of(case: &Case, scene: &Scene, lit: &[Lit]) -> Option<(Light, f64)> {
    let prepared = prepared(case, scene)?;
    let reach = |(lo, hi): (DVec3, DVec3)| lo.abs().max(hi.abs()).max_element();
    let bounds = prepared
        .frames
        .iter()
        .filter_map(|frame| frame.bvh.bounds());
    let size = bounds.map(reach).fold(0.0, f64::max);
    Some((light_of_all(&prepared, lit)?, size))
}

/// The pixels with light, and those of some tiles, which are asked first about a hypothesis: it has to be rendered there alone.
pub(super) struct Asked<'a> {
    pub lit: &'a [Lit],
    first: Option<Few>,
}

/// The pixels of every `step`-th tile.
pub(super) struct Few {
    step: u64,
    pub lit: Vec<Lit>,
}

impl<'a> Asked<'a> {
    pub fn new(case: &Case, lit: &'a [Lit]) -> Asked<'a> {
        let first = Few::of(case, lit);
        Asked { lit, first }
    }

    /// The few that are asked first, if they are enough to decide.
    pub fn first(&self) -> Option<&Few> {
        self.first.as_ref()
    }

    /// The light of a scene that is only of interest if it explains that of the candidate: `None` if it explains too little of the first
    /// tiles.
    pub fn light_if_promising(&self, case: &Case, scene: &Scene) -> Option<Light> {
        let prepared = prepared(case, scene)?;
        if let Some(few) = &self.first {
            let light = few.light_of_all(&prepared)?;
            is_promising(&light.fit(&few.lit)).then_some(())?;
        }
        light_of_all(&prepared, self.lit)
    }
}

impl Few {
    fn of(case: &Case, lit: &[Lit]) -> Option<Few> {
        let size = case.points[0].size().map(|n| n as u32);
        let across = u64::from(size[0].div_ceil(TILE));
        // In no row or column more than in others.
        let step = STEPS.into_iter().find(|step| across % step != 0)?;
        let is_of_them = |(i, _): &&Lit| {
            let [x, y] = [*i as u32 % size[0], *i as u32 / size[0]].map(|at| u64::from(at / TILE));
            (y * across + x) % step == 0
        };
        let is_large = Tile::count(size) >= FEWEST_TILES * step;
        let lit: Vec<Lit> = is_large.then(|| lit.iter().filter(is_of_them).copied().collect())?;
        let wrong = fit(&lit, |_, r| r).tally.distances.len();
        (wrong >= FEWEST_ASKED).then_some(Few { step, lit })
    }

    /// The light of a scene in these pixels.
    pub fn light(&self, case: &Case, scene: &Scene) -> Option<Light> {
        self.light_of_all(&prepared(case, scene)?)
    }

    fn light_of_all(&self, prepared: &Prepared) -> Option<Light> {
        light(render_every(prepared, self.step, &Silent).ok()?, &self.lit)
    }
}

/// Whether a hypothesis explains so much of the first tiles that it may explain all.
pub(super) fn is_promising(fit: &Fit) -> bool {
    fit.tally.share() >= PROMISING
}

/// Every seventh tile is asked first, or, if that would be whole columns, fewer; where these are enough to decide.
const STEPS: [u64; 3] = [7, 11, 13];
const FEWEST_TILES: u64 = 32;
/// Tiles are less independent than pixels: a hypothesis that explains nine tenths of all pixels explains more than half of those in them.
const PROMISING: f64 = 0.5;

fn light_of_all(prepared: &Prepared, lit: &[Lit]) -> Option<Light> {
    light(render(prepared, &Silent).ok()?, lit)
}

/// The light of a film that has these pixels.
fn light(film: Film, lit: &[Lit]) -> Option<Light> {
    let light = film.radiance().to_vec();
    let last = lit.iter().map(|(i, _)| *i).max()?;
    (last < light.len()).then_some(Light(light))
}

/// A scene, ready to be rendered as the reference was.
fn prepared(case: &Case, scene: &Scene) -> Option<Prepared> {
    prepared_with(case, scene, Vec::new())
}

/// The same with more channels.
fn prepared_with(case: &Case, scene: &Scene, aovs: Vec<Aov>) -> Option<Prepared> {
    let mut scene = scene.clone();
    let [width, height] = case.points[0].size();
    let most = (MOST_RAYS / (width * height).max(1)).clamp(1, MOST_SAMPLES as usize);
    // The reference may have been rendered with another number of samples than its file requests.
    let of_reference = case.pair[0].metadata("samples_per_pixel");
    let of_reference = of_reference.and_then(|samples| samples.parse().ok());
    let samples: u32 = of_reference.unwrap_or(scene.samples_per_pixel);
    scene.samples_per_pixel = samples.clamp(1, most as u32);
    let mut request = Request {
        aovs,
        pixel_centers: case.pair[0].metadata("pixel_centers") == Some("true"),
        ..Request::default()
    };
    if is_all_in_its_text(&scene) {
        request.memory_limit = MEMORY;
    }
    let plan = Plan::new(&scene, &request).ok()?;
    let prepared = Prepared::new(&scene, &plan, &Silent).ok()?;
    // Pictures of other sizes are not compared.
    (prepared.layout.size.map(|n| n as usize) == [width, height]).then_some(prepared)
}
