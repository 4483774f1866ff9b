//! Additional elements in 2+1 dimensions: the floor with shadows, light cones as cones, equal times as planes.
//!
//! A light cone of height h has the rim (x, y) = |h| (cos φ, sin φ) at ct = h, on the page the upright ellipse (cos ψ, k sin ψ) |h| about
//! its middle, with ψ = φ − α and α, k, s those of [`Point`]. The outline of the cone touches the rim where the line from the apex is
//! tangent to it: sin ψ = ∓k/s, the upper sign for the future. Between its two edges is the side that is closer to the viewer, about ψ =
//! −90°.

use std::f64::consts::{PI, TAU};

use super::types::Limits;
use super::types::{Curve, HEIGHT, Point, RISE, TURN, WorldLine};
use super::types::{Nappe, Plane, Solid};
use super::view::View;
use crate::figures::diagram::model::{Cone, Slice, SliceKind};

/// Pieces of each side of a rim.
const PIECES: u32 = 64;

/// The floor and the shadows on it; `None` in 1+1 dimensions.
pub(super) fn of(view: &View, limits: &Limits, lines: &[WorldLine], step: f64) -> Option<Solid> {
    if !view.is_solid() {
        return None;
    }
    let [ct, [left, right], [near, far]] = [limits.ct, limits.x, limits.y];
    let at = |x: f64, y: f64| Point::deep(ct[0], x, y);
    let below = |p: &Point| Point { ct: ct[0], ..*p };
    let shadow = |line: &WorldLine| Curve {
        points: line.curve.points.iter().map(below).collect(),
    };
    let signals = view.diagram.signals.iter();
    let light = signals.map(|s| s.ends.map(|event| below(&view.point(event))));
    let marks = view.diagram.events.iter().filter(|mark| mark.dot);
    let marks = marks.map(|mark| view.point(mark.at));
    Some(Solid {
        floor: [
            at(left, near),
            at(right, near),
            at(right, far),
            at(left, far),
        ],
        grid: grid(limits, step),
        shadows: lines.iter().map(shadow).collect(),
        light: light.collect(),
        drops: marks
            .filter(|p| limits.contains(*p))
            .map(|p| [p, below(&p)])
            .collect(),
    })
}

fn grid(limits: &Limits, step: f64) -> Vec<[Point; 2]> {
    let Limits { ct, x, y } = *limits;
    let at = |x: f64, y: f64| Point::deep(ct[0], x, y);
    let equal_x = super::axes::multiples(step, x).map(|v| [at(v, y[0]), at(v, y[1])]);
    let equal_y = super::axes::multiples(step, y).map(|v| [at(x[0], v), at(x[1], v)]);
    equal_x.chain(equal_y).collect()
}

/// The halves of a light cone that are drawn.
pub(super) fn nappes(view: &View, limits: &Limits, cone: &Cone) -> Vec<Nappe> {
    let apex = view.point(cone.event);
    let said = cone.height.map(|height| height / view.diagram.unit.metres);
    let halves = [(cone.future, 1.0), (cone.past, -1.0)].into_iter();
    let drawn = halves.filter(|(drawn, _)| *drawn);
    let heights =
        drawn.map(|(_, up)| up * said.unwrap_or(f64::INFINITY).min(room(limits, apex, up)));
    heights
        .filter(|h| *h != 0.0)
        .map(|h| nappe(apex, h))
        .collect()
}

/// The largest height of a cone from `apex` that stays within the limits, also sideways.
fn room(limits: &Limits, apex: Point, up: f64) -> f64 {
    let to_ct = match up > 0.0 {
        true => limits.ct[1] - apex.ct,
        false => apex.ct - limits.ct[0],
    };
    let sides = [(apex.x, limits.x), (apex.y, limits.y)].into_iter();
    let sides = sides.flat_map(|(p, [low, high])| [p - low, high - p]);
    sides.fold(to_ct, f64::min).max(0.0)
}

fn nappe(apex: Point, height: f64) -> Nappe {
    let sign = -height.signum();
    let turn = libm::atan2(TURN[1], TURN[0]);
    let edge = libm::asin(HEIGHT / RISE);
    // From edge to edge by way of the side in front.
    let (first, last) = match sign > 0.0 {
        true => (turn + PI - edge, turn + edge + TAU),
        false => (turn + PI + edge, turn - edge + TAU),
    };
    let arc = |from: f64, to: f64| {
        let steps =
            (0..=PIECES).map(move |k| from + (to - from) * f64::from(k) / f64::from(PIECES));
        steps.map(|phi| rim(apex, height, phi)).collect()
    };
    Nappe {
        apex,
        height,
        near: arc(first, last),
        far: arc(last, first + TAU),
    }
}

/// The point of a rim at angle φ.
fn rim(apex: Point, height: f64, phi: f64) -> Point {
    let radius = height.abs();
    apex.plus(
        1.0,
        Point::deep(height, radius * libm::cos(phi), radius * libm::sin(phi)),
    )
}

/// Whether a slice is drawn as a plane.
pub(super) fn is_plane(view: &View, slice: &Slice) -> bool {
    view.is_solid() && slice.kind == SliceKind::Simultaneity && slice.to.is_none()
}

/// Planes of equal time.
pub(super) fn planes(view: &View, limits: &Limits) -> Vec<Plane> {
    let colour = |i: usize| view.diagram.frames.get(i).and_then(|frame| frame.colour);
    let slices = view
        .diagram
        .slices
        .iter()
        .filter(|slice| is_plane(view, slice));
    let planes = slices.map(|slice| {
        let event = view.point(slice.event);
        let rise = view.rise_of(slice.frame);
        Plane {
            frame: slice.frame,
            corners: plane_within(limits, event, rise),
            rise,
            event,
            label: slice.label.clone(),
            colour: slice.colour.or(colour(slice.frame)),
        }
    });
    planes.filter(|plane| plane.corners.len() > 2).collect()
}

/// The part of a plane within the limits: that above the floor, cut off at the lowest and the highest ct.
fn plane_within(limits: &Limits, event: Point, rise: [f64; 2]) -> Vec<Point> {
    let at = |x: f64, y: f64| {
        Point::deep(
            event.ct + rise[0] * (x - event.x) + rise[1] * (y - event.y),
            x,
            y,
        )
    };
    let [[left, right], [near, far]] = [limits.x, limits.y];
    let whole = vec![
        at(left, near),
        at(right, near),
        at(right, far),
        at(left, far),
    ];
    let above = cut(&whole, |p| p.ct - limits.ct[0]);
    cut(&above, |p| limits.ct[1] - p.ct)
}

/// The part of a convex polygon where `inside`, which is linear, is not below 0 (Sutherland and Hodgman 1974).
fn cut(corners: &[Point], inside: impl Fn(&Point) -> f64) -> Vec<Point> {
    let mut kept = Vec::new();
    let after = corners.iter().cycle().skip(1);
    for (a, b) in corners.iter().zip(after) {
        let (at_a, at_b) = (inside(a), inside(b));
        if at_a >= 0.0 {
            kept.push(*a);
        }
        if (at_a >= 0.0) != (at_b >= 0.0) {
            kept.push(a.plus(at_a / (at_a - at_b), b.from(*a)));
        }
    }
    kept
}
