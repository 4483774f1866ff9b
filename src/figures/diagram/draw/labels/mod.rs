//! Labels beside the things that they name, without overlaps.
//!
//! Each label has candidates: its anchor points, directions from these and distances, best first. The cost of a candidate is
//!
//! ```text
//! preference + Σ what is under it (dots, lines by their weight) + what of it is off the page
//!            + Σ labels under it, or close by
//! ```
//!
//! Labels take their cheapest candidates one after the other, the most important first; then each chooses again with all others fixed,
//! until none moves. (The optimal placement is NP-hard; greedy placement with such a descent works well: Christensen, Marks, Shieber
//! 1995.) No randomness is involved: the same diagram has the same labels in the same places.

mod block;
mod geometry;
mod ground;

use std::collections::HashMap;

use crate::error::Result;
use crate::figures::drawing::{Anchor, AnchorX, AnchorY, Colour, Item, Path, Stroke, Text};
use crate::text::Rect;
use block::Block;
pub(super) use block::{LEADING, wrapped};
use geometry::{Grid, distance, moved};
pub(super) use geometry::{is_inside, part_within, widened, without};
pub(super) use ground::Ground;

const ON_LABEL: f64 = 1000.0;
/// Cost of a label at no distance; 0 at [`CLEAR`] points.
const NEAR_LABEL: f64 = 9.0;
const CLEAR: f64 = 8.0;
/// Of a label of the same colour beside this one, at the same height: the two are read as one.
const NEXT_WORD: f64 = 30.0;
/// The distance for this, points.
const WORD_SPACE: f64 = 7.0;
/// Of the next point, of the next direction, and of a point of distance.
const NEXT_ANCHOR: f64 = 0.9;
const NEXT_DIRECTION: f64 = 0.6;
const FARTHER: f64 = 0.45;
/// Of each line more than one.
const NEXT_LINE: f64 = 20.0;
/// Of a label that is broken between words, into any number of lines: less than that of one that is off the page, even on lines.
const BROKEN: f64 = 300.0;
/// By how much the position in the previous frame of a series is preferred.
const HABIT: f64 = 20.0;
/// The most that a label moves between frames of a series, points; it moves along with a faster point.
const MOST_STEP: f64 = 6.0;
/// The least that it may move beside a fast point, so that it reaches its position.
const LEAST_STEP: f64 = 0.5;
/// The cost from which an optional label is dropped: it is on a line.
const TOO_MUCH: f64 = 24.0;
/// Cost of a leader that passes under another label.
const LEADER_ON_LABEL: f64 = 200.0;
/// The distance from which on a line leads to the label, points.
const LEADER: f64 = 14.0;
/// Free space around a label, points.
const AIR: f64 = 1.0;
/// The side of cells in which labels are looked up, points.
const CELL: f64 = 32.0;
/// Rounds of choosing again.
const ROUNDS: usize = 6;
/// Width of the halo that separates a label from lines under it, points.
const HALO: f64 = 1.6;

/// A label to be placed.
pub(super) struct Request {
    /// Markup.
    pub text: String,
    pub colour: Colour,
    pub size: f64,
    /// Points that it may be placed beside, the best first.
    pub anchors: Vec<[f64; 2]>,
    /// Directions from there, (x, y) with y down, the best first; empty to place it on the point.
    pub directions: Vec<[f64; 2]>,
    /// Distances from there, points.
    pub distances: Vec<f64>,
    /// Whether it is dropped if it would be on a label, a dot or several lines.
    pub optional: bool,
    /// The identity across frames of a label that passes others that stay; `None` for its text.
    pub key: Option<String>,
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

/// The positions of the labels of one frame of a series, for the next one: for each label, the n-th with its text.
#[derive(Debug, Clone, Default)]
pub(crate) struct Habits {
    places: HashMap<(String, usize), Habit>,
    /// Whether the numbers of an axis are on its other side.
    sides: HashMap<String, bool>,
}

/// The place of a label in a frame.
#[derive(Debug, Clone, Copy)]
struct Habit {
    /// Its candidate.
    index: usize,
    /// The middle of its ink.
    middle: [f64; 2],
    /// The point that it names, if there is only one.
    named: Option<[f64; 2]>,
}

impl Habit {
    /// The current middle of the ink, if the label has moved along with the point that it names, and how much farther it may move.
    fn carried(&self, request: &Request) -> Carried {
        let way = match (self.named, named(request)) {
            (Some(then), Some(now)) => [0, 1].map(|i| now[i] - then[i]),
            _ => [0.0; 2],
        };
        Carried {
            middle: [0, 1].map(|i| self.middle[i] + way[i]),
            step: (MOST_STEP - way[0].hypot(way[1])).max(LEAST_STEP),
        }
    }
}

/// Where a label of the picture before has come to.
#[derive(Debug, Clone, Copy)]
struct Carried {
    /// Of its ink.
    middle: [f64; 2],
    /// How far it may move from there, points.
    step: f64,
}

/// The point that a label names, if there is only one.
fn named(request: &Request) -> Option<[f64; 2]> {
    match request.anchors[..] {
        [only] => Some(only),
        _ => None,
    }
}

/// A place that a label may have.
struct Candidate {
    /// In the order of the request.
    index: usize,
    preference: f64,
    /// Its lines.
    texts: Vec<Text>,
    /// Of their ink.
    rect: Rect,
    anchor: [f64; 2],
    distance: f64,
    /// Cost of the ground under it; `None` until it is needed.
    under: Option<f64>,
}

/// A label with its places.
struct Label<'a> {
    request: &'a Request,
    key: (String, usize),
    /// By preference.
    candidates: Vec<Candidate>,
    chosen: Option<usize>,
    /// The middle of its ink in the previous frame, moved along with the point that it names.
    before: Option<Carried>,
    /// The offset that remains to its position.
    late: [f64; 2],
}

/// Labels and their leaders by their places.
struct Places {
    labels: Grid,
    leaders: Grid,
}

impl Places {
    fn insert(&mut self, index: usize, candidate: &Candidate) {
        self.labels.insert(index, candidate.rect);
        if let Some(ends) = candidate.leader() {
            self.leaders.insert(index, geometry::around(&ends));
        }
    }

    fn remove(&mut self, index: usize, candidate: &Candidate) {
        self.labels.remove(index, candidate.rect);
        if let Some(ends) = candidate.leader() {
            self.leaders.remove(index, geometry::around(&ends));
        }
    }
}

/// Places the labels of a page over what is already there.
pub(super) fn place(
    ground: &Ground,
    requests: &[Request],
    habits: &mut Habits,
) -> Result<Vec<Item>> {
    let mut labels = Vec::with_capacity(requests.len());
    let mut counts: HashMap<&str, usize> = HashMap::new();
    for request in requests {
        let key = request.key.as_deref().unwrap_or(&request.text);
        let count = counts.entry(key).or_default();
        labels.push(Label::new(request, *count, ground, habits)?);
        *count += 1;
    }
    let mut places = Places {
        labels: Grid::new(CELL.max(ground.cell())),
        leaders: Grid::new(CELL.max(ground.cell())),
    };
    // Labels that stay are placed as if nothing passed by.
    settle(&mut labels, false, &mut places, ground);
    leave_out(&mut labels, &mut places, ground);
    settle(&mut labels, true, &mut places, ground);
    labels.iter_mut().for_each(Label::step);
    give_way(&mut labels, ground);
    let chosen = labels.iter().filter_map(|label| {
        let candidate = label.candidates.get(label.chosen?)?;
        let habit = Habit {
            index: candidate.index,
            middle: middle(moved(candidate.rect, label.late)),
            named: named(label.request),
        };
        Some((label.key.clone(), habit))
    });
    habits.places = chosen.collect();
    Ok(labels
        .iter()
        .flat_map(|label| label.items(ground))
        .collect())
}

/// Lets the labels that pass by, or all others, choose until none moves.
fn settle(labels: &mut [Label], passing: bool, places: &mut Places, ground: &Ground) {
    for _ in 0..ROUNDS {
        let mut moved = false;
        for i in 0..labels.len() {
            if labels[i].is_passing() != passing {
                continue;
            }
            let before = labels[i].chosen;
            if let Some(candidate) = labels[i].chosen() {
                places.remove(i, candidate);
            }
            labels[i].chosen = choose(labels, i, places, ground);
            if let Some(candidate) = labels[i].chosen() {
                places.insert(i, candidate);
            }
            moved |= labels[i].chosen != before;
        }
        if !moved {
            break;
        }
    }
}

/// Of two ways to place labels on this side of a line or on that, the one in which more of them have room. Over a series
/// they change sides only for two more.
pub(super) fn roomier(
    key: String,
    [first, second]: [&[Request]; 2],
    ground: &Ground,
    habits: &mut Habits,
) -> Result<bool> {
    let room = |requests: &[Request]| -> Result<i32> {
        let mut count = 0;
        for request in requests {
            let mut all = candidates(request, ground)?.into_iter();
            let is_free = |it: &Candidate| {
                it.preference + ground.cost(it.rect, widened(it.rect, AIR)) < TOO_MUCH
            };
            count += i32::from(all.any(|it| is_free(&it)));
        }
        Ok(count)
    };
    let more = room(second)? - room(first)?;
    let is_second = match habits.sides.get(&key) {
        Some(true) => more > -2,
        Some(false) => more >= 2,
        None => more > 0,
    };
    habits.sides.insert(key, is_second);
    Ok(is_second)
}

/// The cheapest candidate of the i-th label, with the others at their current `places`.
fn choose(labels: &mut [Label], i: usize, places: &Places, ground: &Ground) -> Option<usize> {
    let mut candidates = std::mem::take(&mut labels.get_mut(i)?.candidates);
    let mut best: Option<(f64, usize)> = None;
    for (k, candidate) in candidates.iter_mut().enumerate() {
        // They ascend by preference, and costs are only added: none after this one is cheaper.
        if best.is_some_and(|(cost, _)| candidate.preference >= cost) {
            break;
        }
        let least = best.map_or(f64::INFINITY, |(least, _)| least);
        if let Some(cost) = candidate.cost_below(least, labels, places, ground) {
            best = Some((cost, k));
        }
    }
    labels.get_mut(i)?.candidates = candidates;
    best.map(|(_, k)| k)
}

/// Removes optional labels without a good position.
fn leave_out(labels: &mut [Label], places: &mut Places, ground: &Ground) {
    // The least important first, so that it makes room for those before.
    for i in (0..labels.len()).rev() {
        let (true, Some(candidate)) = (labels[i].request.optional, labels[i].chosen()) else {
            continue;
        };
        places.remove(i, candidate);
        let mut candidates = std::mem::take(&mut labels[i].candidates);
        let candidate = labels[i].chosen.and_then(|k| candidates.get_mut(k));
        let cost = candidate.and_then(|it| it.cost_below(TOO_MUCH, labels, places, ground));
        labels[i].candidates = candidates;
        match (cost, labels[i].chosen()) {
            (Some(_), Some(candidate)) => places.insert(i, candidate),
            _ => labels[i].chosen = None,
        }
    }
}

/// Removes, for this frame, clock readings and optional labels that are on a line, on another label or off the page, and any label that is
/// on another on its way, or on a line on its way to where there is none. Passing labels are removed first, then less important ones.
fn give_way(labels: &mut [Label], ground: &Ground) {
    let mut places: Vec<Option<Rect>> = labels.iter().map(Label::place).collect();
    let mut grid = Grid::new(CELL.max(ground.cell()));
    for (i, place) in places.iter().enumerate() {
        place.iter().for_each(|rect| grid.insert(i, *rect));
    }
    let mut order: Vec<usize> = (0..labels.len()).rev().collect();
    // Stable: among the equal the later ones, which are less important, come first.
    order.sort_by_key(|i| !labels[*i].is_passing());
    let leaders: Vec<_> = labels.iter().map(Label::leader).collect();
    for i in order {
        let label = &labels[i];
        let may = label.request.optional || label.is_passing();
        let is_late = label.late != [0.0; 2];
        let Some(own) = places[i].filter(|_| may || is_late) else {
            continue;
        };
        let airy = widened(own, if may { AIR } else { 0.0 });
        let near = |rect: Rect| grid.near(rect).into_iter().filter(|k| *k != i);
        let covers = near(airy).filter_map(|k| places[k]);
        let is_covered = covers.into_iter().any(|other| distance(airy, other) == 0.0);
        let leads = label.leader().is_some_and(|[from, to]| {
            let mut others = near(geometry::around(&[from, to])).filter_map(|k| places[k]);
            label.is_passing() && others.any(|other| other.is_crossed(from, to))
        });
        let led_over = || {
            let others = leaders.iter().zip(&places).enumerate();
            let mut others = others.filter_map(|(k, (leader, place))| {
                place.filter(|_| k != i)?;
                *leader
            });
            others.any(|[from, to]| own.is_crossed(from, to))
        };
        let is_bad = || ground.is_struck(own) || !ground.holds(own) || led_over();
        let goes_over_a_line = || {
            let there = label.rect().filter(|_| is_late);
            there.is_some_and(|there| ground.is_struck(own) && !ground.is_struck(there))
        };
        if is_covered || leads || may && is_bad() || goes_over_a_line() {
            labels[i].chosen = None;
            places[i] = None;
        }
    }
}

impl Candidate {
    /// Its cost beside those of `labels` that are in `places`; `None` if that is `least` or more.
    fn cost_below(
        &mut self,
        least: f64,
        labels: &[Label],
        places: &Places,
        ground: &Ground,
    ) -> Option<f64> {
        // The ground under it does not change while labels choose: its cost is computed once.
        let airy = widened(self.rect, AIR);
        let under = *self
            .under
            .get_or_insert_with(|| ground.cost(self.rect, airy));
        let mut cost = self.preference + under + self.leader_cost(labels, places);
        if cost >= least {
            return None;
        }
        // Anything farther than CLEAR costs nothing.
        let near = places.labels.near(widened(airy, CLEAR)).into_iter();
        let near = near.filter_map(|k| labels.get(k));
        for (other, rect) in near.filter_map(|label| Some((label, label.rect()?))) {
            cost += match distance(airy, rect) {
                0.0 => ON_LABEL,
                // Less the farther, down to nothing at CLEAR.
                apart => NEAR_LABEL * (1.0 - apart / CLEAR).max(0.0),
            };
            if self.colour() == Some(other.request.colour)
                && geometry::is_next_word(self.rect, rect, WORD_SPACE)
            {
                cost += NEXT_WORD;
            }
            if cost >= least {
                return None;
            }
        }
        Some(cost)
    }

    fn colour(&self) -> Option<Colour> {
        Some(self.texts.first()?.colour)
    }

    /// Its leader, if it is far from what it names.
    fn leader(&self) -> Option<[[f64; 2]; 2]> {
        let ends = [self.anchor, nearest(self.anchor, self.rect)];
        (self.distance >= LEADER).then_some(ends)
    }

    /// The cost of leaders that cross labels: its own crossing others, and those of others crossing this one.
    fn leader_cost(&self, all: &[Label], places: &Places) -> f64 {
        let crossed = self.leader().map_or(0, |[from, to]| {
            let near = places.labels.near(geometry::around(&[from, to]));
            let others = near.into_iter().filter_map(|k| all.get(k)?.rect());
            others.filter(|it| it.is_crossed(from, to)).count()
        });
        let near = places.leaders.near(self.rect).into_iter();
        let leaders = near.filter_map(|k| all.get(k)?.chosen()?.leader());
        let crossing = leaders.filter(|[from, to]| self.rect.is_crossed(*from, *to));
        LEADER_ON_LABEL * (crossed + crossing.count()) as f64
    }
}

impl<'a> Label<'a> {
    fn new(
        request: &'a Request,
        count: usize,
        ground: &Ground,
        habits: &Habits,
    ) -> Result<Label<'a>> {
        let name = request.key.as_ref().unwrap_or(&request.text);
        let key = (name.clone(), count);
        let mut candidates = candidates(request, ground)?;
        if request.key.is_some() {
            for candidate in &mut candidates {
                candidate.preference += ground.passed(widened(candidate.rect, AIR));
            }
        }
        let habit = habits.places.get(&key);
        if let Some(habit) = habit.and_then(|habit| candidates.get_mut(habit.index)) {
            habit.preference -= HABIT;
        }
        candidates.sort_by(|a, b| a.preference.total_cmp(&b.preference));
        Ok(Label {
            request,
            key,
            candidates,
            chosen: None,
            before: habit.map(|habit| habit.carried(request)),
            late: [0.0; 2],
        })
    }

    /// Whether it belongs to something that passes by: it disappears with the next picture or the one after.
    fn is_passing(&self) -> bool {
        self.request.key.is_some()
    }

    /// The leader to where it is drawn.
    fn leader(&self) -> Option<[[f64; 2]; 2]> {
        let candidate = self.chosen()?;
        let ends = [candidate.anchor, nearest(candidate.anchor, self.place()?)];
        (candidate.distance >= LEADER).then_some(ends)
    }

    /// The position where its ink is drawn.
    fn place(&self) -> Option<Rect> {
        Some(moved(self.rect()?, self.late))
    }

    /// Moves it towards its position by at most [`MOST_STEP`].
    fn step(&mut self) {
        let (Some(before), Some(rect)) = (self.before, self.rect()) else {
            return;
        };
        let there = middle(rect);
        let way = [0, 1].map(|i| there[i] - before.middle[i]);
        let length = way[0].hypot(way[1]);
        if length > before.step {
            // That position plus this is one step from the previous one.
            self.late = way.map(|part| part * (before.step / length - 1.0));
        }
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
        let rect = moved(candidate.rect, self.late);
        if candidate.distance >= LEADER {
            items.push(leader(candidate.anchor, rect, self.request.colour));
        }
        let halo = ground.is_crossed(widened(rect, AIR));
        let halo = halo.then(|| (ground.colour(rect), HALO));
        items.extend(candidate.texts.iter().map(|text| {
            Item::Text(Text {
                at: [0, 1].map(|i| text.at[i] + self.late[i]),
                halo,
                ..text.clone()
            })
        }));
        items
    }
}

/// A line from a point to the nearest point of a label.
fn leader(anchor: [f64; 2], rect: Rect, colour: Colour) -> Item {
    let path = Path::line(anchor, nearest(anchor, rect));
    Item::stroked(path, Stroke::new(colour.with_alpha(150), 0.4))
}

/// The point closest to `anchor` of the free space of a label in `rect`.
fn nearest(anchor: [f64; 2], rect: Rect) -> [f64; 2] {
    [0, 1].map(|i| anchor[i].clamp(rect.min[i] - AIR, rect.max[i] + AIR))
}

fn middle(rect: Rect) -> [f64; 2] {
    [0, 1].map(|i| 0.5 * (rect.min[i] + rect.max[i]))
}

/// All places of a label, in the order of the request.
fn candidates(request: &Request, ground: &Ground) -> Result<Vec<Candidate>> {
    let mut all = Vec::new();
    let blocks = Block::all(&request.text, request.size)?;
    let narrowest = blocks
        .iter()
        .map(Block::width)
        .fold(f64::INFINITY, f64::min);
    // A label of this size has room on one side of any point, between words if need be.
    let room = ground.size().map(|side| 0.4 * side);
    let broken = match narrowest > room[0] {
        true => Some(Block::within(room, &request.text, request.size)?),
        false => None,
    };
    let lines = |block: &Block| NEXT_LINE * (block.count() - 1) as f64;
    let blocks = blocks.into_iter().map(|block| (lines(&block), block));
    for (lines, block) in blocks.chain(broken.map(|block| (BROKEN, block))) {
        for &distance in &request.distances {
            for (a, &anchor) in request.anchors.iter().enumerate() {
                for (d, &direction) in request.directions.iter().enumerate() {
                    let (texts, rect) = beside(&block, request, anchor, direction, distance);
                    let preference = NEXT_ANCHOR * a as f64 + NEXT_DIRECTION * d as f64;
                    all.push(Candidate {
                        index: all.len(),
                        preference: preference + FARTHER * distance + lines,
                        rect,
                        texts,
                        anchor,
                        distance,
                        under: None,
                    });
                }
            }
        }
    }
    Ok(all)
}

/// The lines of a label beside `anchor` in a direction, and the box of their ink.
fn beside(
    block: &Block,
    request: &Request,
    anchor: [f64; 2],
    direction: [f64; 2],
    distance: f64,
) -> (Vec<Text>, Rect) {
    let [x, y] = direction;
    // A direction with less than 0.3 aside is above or below.
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
    let [x, y] = [0, 1].map(|i| anchor[i] + direction[i] * distance);
    let anchor = Anchor { x: side, y: height };
    let texts = block.lines(height).map(|(line, down)| Text {
        anchor,
        colour: request.colour,
        ..Text::new(line.clone(), [x, y + down], block.size)
    });
    let ink = block.ink(height, |width| anchor.offset(width, block.size));
    (texts.collect(), moved(ink, [x, y]))
}
