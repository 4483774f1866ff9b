//! A series of pictures of one diagram, all with the same limits and with steady labels.

use super::draw::{Habits, draw_next};
use super::layout::{Limits, Note, Panel, around, contents, layout, limits, notes};
use crate::error::Result;
use crate::figures::diagram::model::{Animation, Diagram, Spot};
use crate::figures::drawing::Drawing;

/// Fewer pictures than these are steps and no motion: labels are then placed anew in each, rather than on their way.
const MOTION: u32 = 24;
/// Pictures whose automatic limits make those of all.
const LOOKED_AT: u32 = 16;

/// The pictures of a diagram's animation, in order from the first.
///
/// A label stays in place as long as possible, so a picture with many labels depends on the previous ones.
pub struct Series {
    /// With limits that contain everything that any picture shows.
    diagram: Diagram,
    animation: Animation,
    /// The extent of the pages of all pictures, for each panel.
    pages: Vec<[[f64; 2]; 2]>,
    /// The notes of all pictures: with those of each its own, pages would differ in height.
    notes: Vec<Note>,
    habits: Habits,
    next: u32,
}

impl Series {
    /// The series of `diagram`; `None` if it has no animation.
    pub fn new(diagram: &Diagram) -> Option<Series> {
        let animation = diagram.animation?;
        let mut diagram = diagram.clone();
        if animation.boost.is_some() {
            fix_limits(&mut diagram, animation.frames);
        }
        let (pages, notes) = pages(&diagram, animation.frames);
        Some(Series {
            pages,
            notes,
            diagram,
            animation,
            habits: Habits::default(),
            next: 0,
        })
    }

    /// The change over the series.
    pub fn animation(&self) -> Animation {
        self.animation
    }
}

impl Iterator for Series {
    type Item = Result<Drawing>;

    fn next(&mut self) -> Option<Result<Drawing>> {
        if self.next >= self.animation.frames {
            return None;
        }
        let mut layout = layout(&self.diagram.picture(self.next));
        for (panel, page) in layout.panels.iter_mut().zip(&self.pages) {
            panel.held = Some(*page);
        }
        layout.notes.clone_from(&self.notes);
        self.next += 1;
        if self.animation.frames < MOTION {
            self.habits = Habits::default();
        }
        Some(draw_next(&layout, &self.diagram.style, &mut self.habits))
    }
}

/// The extent of the pages, for each panel, and the notes, over sample pictures of the whole animation.
fn pages(diagram: &Diagram, frames: u32) -> (Vec<[[f64; 2]; 2]>, Vec<Note>) {
    let last = frames.saturating_sub(1);
    let mut pages: Vec<[[f64; 2]; 2]> = Vec::new();
    let mut panels: Vec<Panel> = Vec::new();
    for k in (0..=LOOKED_AT).map(|i| last * i / LOOKED_AT) {
        let picture = layout(&diagram.picture(k)).panels;
        let shown: Vec<_> = picture.iter().map(Panel::page).collect();
        match pages.is_empty() {
            true => pages = shown,
            false => {
                let both = pages.iter_mut().zip(shown);
                both.for_each(|(page, shown)| *page = around(*page, shown));
            }
        }
        panels.extend(picture);
    }
    (pages, notes(diagram, &panels))
}

/// Sets limits that contain those of sample pictures of the whole animation, if none are given.
fn fix_limits(diagram: &mut Diagram, frames: u32) {
    let last = frames.saturating_sub(1);
    let looked_at = (0..=LOOKED_AT).map(|i| last * i / LOOKED_AT);
    let all = looked_at.flat_map(|k| {
        let picture = diagram.picture(k);
        let views = picture.views.iter();
        views.map(|i| limits(&picture, *i)).collect::<Vec<_>>()
    });
    let wider = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    let whole = all.reduce(|a, b| Limits {
        x: wider(a.x, b.x),
        ct: wider(a.ct, b.ct),
        y: wider(a.y, b.y),
    });
    // Events, and everything in the first picture, stay on the page, even if its limits are given.
    let shown = shown(&diagram.picture(0));
    let looked_at = (0..=LOOKED_AT).map(|i| last * i / LOOKED_AT);
    let points = looked_at.flat_map(|k| {
        let picture = diagram.picture(k);
        let mut points = marked(&picture);
        let all = of_view(&picture).into_iter().zip(&shown);
        points.extend(all.filter_map(|(point, is_shown)| is_shown.then_some(point)));
        points
    });
    let points: Vec<[f64; 2]> = points.collect();
    let range = |i: usize| {
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        let [from, to] = points
            .iter()
            .fold(ends, |[a, b], e| [a.min(e[i]), b.max(e[i])]);
        // A twentieth of the whole.
        let air = 0.05 * (to - from).max(0.0);
        [from - air, to + air]
    };
    if let Some(Limits { x, ct, y }) = whole {
        let metres = |range: [f64; 2]| range.map(|end| end * diagram.unit.metres);
        let (x, ct) = (metres(x), metres(ct));
        diagram.x = Some(wider(diagram.x.unwrap_or(x), range(1)));
        diagram.ct = Some(wider(diagram.ct.unwrap_or(ct), range(0)));
        if diagram.across.is_some() {
            diagram.y.get_or_insert(metres(y));
        }
    }
}

/// The positions of a picture's contents in its view, ct and x, metres.
fn of_view(picture: &Diagram) -> Vec<[f64; 2]> {
    let metres = picture.unit.metres;
    let view = picture.views.first();
    let points = view.map_or(Vec::new(), |index| contents(picture, *index));
    let points = points.iter().map(|p| [p.ct * metres, p.x * metres]);
    points.collect()
}

/// Which of its contents a picture shows within its limits.
fn shown(picture: &Diagram) -> Vec<bool> {
    let Some(index) = picture.views.first() else {
        return Vec::new();
    };
    let limits = limits(picture, *index);
    let points = contents(picture, *index).into_iter();
    points.map(|point| limits.contains(point)).collect()
}

/// The positions of the events with dots in the view of a picture, ct and x, metres.
fn marked(picture: &Diagram) -> Vec<[f64; 2]> {
    let view = picture.views.first().and_then(|i| picture.frames.get(*i));
    let events = picture.events.iter().filter(|event| event.dot);
    let at = |event: &Spot| {
        let own = view?.frame.event_from_world(event.at);
        Some([own.ct, picture.direction.dot(own.x)])
    };
    events.filter_map(at).collect()
}
