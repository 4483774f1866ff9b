//! Labels beside what they name, without overlaps.
//!
//! Each label has candidates: its points, directions from these and distances, the best first. What a
//! candidate costs is
//!
//! ```text
//! preference + Σ what is under it (dots, lines by their weight) + what of it is off the page
//!            + Σ labels under it, or close by
//! ```
//!
//! Labels take their cheapest candidates one after the other, the most important first; then each chooses
//! again, all others being where they are, until none moves. (The best places for all are NP-hard to find;
//! greedy placement with such a descent does well: Christensen, Marks, Shieber 1995.) No chance is
//! involved: the same diagram has the same labels in the same places.

mod geometry;
mod ground;

use std::collections::HashMap;

use crate::error::Result;
use crate::figures::drawing::{Anchor, AnchorX, AnchorY, Colour, Item, Path, Stroke, Text};
use crate::figures::text::{Rect, RichText};
use geometry::{Grid, distance, moved, widened};
pub(super) use ground::Ground;

const ON_LABEL: f64 = 1000.0;
/// Of a label at no distance; none at [`CLEAR`] points.
const NEAR_LABEL: f64 = 9.0;
const CLEAR: f64 = 8.0;
/// Of the next point, of the next direction, and of a point of distance.
const NEXT_ANCHOR: f64 = 0.9;
const NEXT_DIRECTION: f64 = 0.6;
const FARTHER: f64 = 0.45;
/// By how much the place of the frame before is better in a series of frames.
const HABIT: f64 = 25.0;
/// From which cost on a label that may be left out is.
const TOO_MUCH: f64 = 40.0;
/// The distance from which on a line leads to the label, points.
const LEADER: f64 = 14.0;
/// What is kept free around a label, points.
const AIR: f64 = 1.0;
/// Rounds of choosing again.
const ROUNDS: usize = 6;
/// Width of what keeps a label apart from lines under it, points.
const HALO: f64 = 1.6;

/// What is to be labelled.
pub(super) struct Request {
    /// Markup.
    pub text: String,
    pub colour: Colour,
    pub size: f64,
    /// Points that it may stand beside, the best first.
    pub anchors: Vec<[f64; 2]>,
    /// Directions from there, (x, y) with y down, the best first; none to stand upon the point.
    pub directions: Vec<[f64; 2]>,
    /// Distances from there, points.
    pub distances: Vec<f64>,
    /// Whether it is left out where it would be on a label, a dot or several lines.
    pub optional: bool,
}

/// The eight directions around an event, the best first.
pub(super) const AROUND: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [0.8, -0.8],
    [0.8, 0.8],
    [-1.0, 0.0],
    [-0.8, -0.8],
    [-0.8, 0.8],
    [0.0, -1.0],
    [0.0, 1.0],
];

/// Where the labels of a frame of a series are, for the next one: candidates by label, the n-th of its
/// words.
#[derive(Debug, Clone, Default)]
pub(crate) struct Habits(HashMap<(String, usize), usize>);

/// A place that a label may have.
struct Candidate {
    /// In the order of the request.
    index: usize,
    preference: f64,
    text: Text,
    /// Of its ink.
    rect: Rect,
    anchor: [f64; 2],
    distance: f64,
    /// What is under it; none until it is asked for.
    under: Option<f64>,
}

/// A label with its places.
struct Label<'a> {
    request: &'a Request,
    key: (String, usize),
    /// By preference.
    candidates: Vec<Candidate>,
    chosen: Option<usize>,
}

/// The labels of a page over what is there already.
pub(super) fn place(
    ground: &Ground,
    requests: &[Request],
    habits: &mut Habits,
) -> Result<Vec<Item>> {
    let mut labels = Vec::with_capacity(requests.len());
    let mut counts: HashMap<&str, usize> = HashMap::new();
    for request in requests {
        let count = counts.entry(&request.text).or_default();
        labels.push(Label::new(request, *count, habits)?);
        *count += 1;
    }
    let mut grid = Grid::default();
    for _ in 0..ROUNDS {
        let mut moved = false;
        for i in 0..labels.len() {
            let before = labels[i].chosen;
            if let Some(rect) = labels[i].rect() {
                grid.remove(i, rect);
            }
            labels[i].chosen = choose(&mut labels, i, &grid, ground);
            if let Some(rect) = labels[i].rect() {
                grid.insert(i, rect);
            }
            moved |= labels[i].chosen != before;
        }
        if !moved {
            break;
        }
    }
    leave_out(&mut labels, &mut grid, ground);
    let chosen = labels.iter().filter_map(|label| {
        let candidate = label.candidates.get(label.chosen?)?;
        Some((label.key.clone(), candidate.index))
    });
    habits.0 = chosen.collect();
    Ok(labels
        .iter()
        .flat_map(|label| label.items(ground))
        .collect())
}

/// The cheapest candidate of the i-th label, the others being where they are, in `grid`.
fn choose(labels: &mut [Label], i: usize, grid: &Grid, ground: &Ground) -> Option<usize> {
    let mut candidates = std::mem::take(&mut labels.get_mut(i)?.candidates);
    let mut best: Option<(f64, usize)> = None;
    for (k, candidate) in candidates.iter_mut().enumerate() {
        if best.is_some_and(|(cost, _)| candidate.preference >= cost) {
            break;
        }
        let cost = candidate.cost(labels, grid, ground);
        if best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, k));
        }
    }
    labels.get_mut(i)?.candidates = candidates;
    best.map(|(_, k)| k)
}

/// Takes away what may be left out and has no good place.
fn leave_out(labels: &mut [Label], grid: &mut Grid, ground: &Ground) {
    for i in (0..labels.len()).rev() {
        let (true, Some(rect)) = (labels[i].request.optional, labels[i].rect()) else {
            continue;
        };
        grid.remove(i, rect);
        let mut candidates = std::mem::take(&mut labels[i].candidates);
        let candidate = labels[i].chosen.and_then(|k| candidates.get_mut(k));
        let cost = candidate.map(|candidate| candidate.cost(labels, grid, ground));
        labels[i].candidates = candidates;
        match cost.is_some_and(|cost| cost >= TOO_MUCH) {
            true => labels[i].chosen = None,
            false => grid.insert(i, rect),
        }
    }
}

impl Candidate {
    /// What it costs beside those of `labels` that are in `grid`.
    fn cost(&mut self, labels: &[Label], grid: &Grid, ground: &Ground) -> f64 {
        let airy = widened(self.rect, AIR);
        let under = *self
            .under
            .get_or_insert_with(|| ground.cost(self.rect, airy));
        // What is farther than CLEAR costs nothing.
        let near = grid.near(widened(airy, CLEAR)).into_iter();
        let near = near.filter_map(|k| labels.get(k)?.rect());
        let labels = near.map(|other| match distance(airy, other) {
            0.0 => ON_LABEL,
            apart => NEAR_LABEL * (1.0 - apart / CLEAR).max(0.0),
        });
        self.preference + under + labels.sum::<f64>()
    }
}

impl<'a> Label<'a> {
    fn new(request: &'a Request, count: usize, habits: &Habits) -> Result<Label<'a>> {
        let key = (request.text.clone(), count);
        let mut candidates = candidates(request)?;
        if let Some(habit) = habits.0.get(&key).and_then(|i| candidates.get_mut(*i)) {
            habit.preference -= HABIT;
        }
        candidates.sort_by(|a, b| a.preference.total_cmp(&b.preference));
        Ok(Label {
            request,
            key,
            candidates,
            chosen: None,
        })
    }

    fn chosen(&self) -> Option<&Candidate> {
        self.candidates.get(self.chosen?)
    }

    fn rect(&self) -> Option<Rect> {
        self.chosen().map(|candidate| candidate.rect)
    }

    fn items(&self, ground: &Ground) -> Vec<Item> {
        let Some(candidate) = self.chosen() else {
            return Vec::new();
        };
        let mut items = Vec::new();
        if candidate.distance >= LEADER {
            items.push(leader(candidate, self.request.colour));
        }
        let halo = ground.is_crossed(widened(candidate.rect, AIR));
        items.push(Item::Text(Text {
            halo: halo.then(|| (ground.colour(candidate.rect), HALO)),
            ..candidate.text.clone()
        }));
        items
    }
}

/// A line from a point to the nearest point of a label.
fn leader(candidate: &Candidate, colour: Colour) -> Item {
    let Candidate { anchor, rect, .. } = candidate;
    let near = [0, 1].map(|i| anchor[i].clamp(rect.min[i] - AIR, rect.max[i] + AIR));
    let path = Path::line(*anchor, near);
    Item::stroked(path, Stroke::new(colour.with_alpha(150), 0.4))
}

/// All places of a label, in the order of the request.
fn candidates(request: &Request) -> Result<Vec<Candidate>> {
    let rich = RichText::parse(&request.text)?;
    let (width, ink) = (rich.width(request.size)?, rich.bounds(request.size)?);
    let mut all = Vec::new();
    for &distance in &request.distances {
        for (a, &anchor) in request.anchors.iter().enumerate() {
            for (d, &direction) in request.directions.iter().enumerate() {
                let text = beside(&rich, request, anchor, direction, distance);
                let [x, y] = text.anchor.offset(width, text.size);
                let preference = NEXT_ANCHOR * a as f64 + NEXT_DIRECTION * d as f64;
                all.push(Candidate {
                    index: all.len(),
                    preference: preference + FARTHER * distance,
                    rect: moved(ink, [text.at[0] + x, text.at[1] + y]),
                    text,
                    anchor,
                    distance,
                    under: None,
                });
            }
        }
    }
    Ok(all)
}

/// The text beside `anchor` in a direction.
fn beside(
    rich: &RichText,
    request: &Request,
    anchor: [f64; 2],
    direction: [f64; 2],
    distance: f64,
) -> Text {
    let [x, y] = direction;
    let side = match x {
        x if x > 0.3 => AnchorX::Start,
        x if x < -0.3 => AnchorX::End,
        _ => AnchorX::Middle,
    };
    let height = match y {
        y if y > 0.3 => AnchorY::Top,
        y if y < -0.3 => AnchorY::Baseline,
        _ => AnchorY::Middle,
    };
    let at = [anchor[0] + x * distance, anchor[1] + y * distance];
    Text {
        anchor: Anchor { x: side, y: height },
        colour: request.colour,
        ..Text::new(rich.clone(), at, request.size)
    }
}
