//! Obstacles for labels.

use super::labels::{Ground, is_inside};
use super::layers::{BEAD, DOT, TICK, area_fill, cone_fill, head, is_inner};
use super::page::Map;
use super::solid;
use super::theme::Theme;
use crate::figures::diagram::layout::{Panel, Tick};
use crate::text::Rect;

/// How much thin lines, and the faint ones of a grid, disturb a label.
const THIN: f64 = 0.8;
const FAINT: f64 = 0.15;
/// By a floor's edges, the dotted lines down to it and the shadows on it.
const DOTTED: f64 = 0.4;
/// The number of pieces into which a side of a panel is divided, and how far within the panel they are, points.
const PIECES: u32 = 64;
const INNER: f64 = 0.1;
/// Of the head of a signal's arrow, points.
const HEAD: f64 = 3.0;
/// Of the head of an axis, about its tip.
const AXIS_HEAD: f64 = 2.5;

/// Adds everything drawn in a panel to `ground`, except for the moving line, which is interrupted at labels.
pub(super) fn add(ground: &mut Ground, panel: &Panel, map: &Map, theme: &Theme) {
    ground.within(widened(map.rect()));
    areas(ground, panel, map, theme);
    lines(ground, panel, map);
    thin_lines(ground, panel, map);
    solids(ground, panel, map);
    for line in &panel.grid {
        ground.line(map.points(&line.ends), FAINT);
    }
    for event in panel.events.iter().filter(|event| event.dot) {
        ground.dot(map.at(event.at), DOT * theme.width);
    }
    for bead in panel.now.iter().flat_map(|now| &now.beads) {
        ground.bead(map.at(bead.at), BEAD * theme.width);
    }
    for signal in &panel.signals {
        if let Some((head, size)) = head(panel, map, signal.ends) {
            ground.dot(map.at(head), HEAD * size);
        }
    }
}

/// With room for the ticks of axes along its edges.
fn widened(rect: Rect) -> Rect {
    Rect {
        min: rect.min.map(|side| side - 2.0 * TICK),
        max: rect.max.map(|side| side + 2.0 * TICK),
    }
}

fn areas(ground: &mut Ground, panel: &Panel, map: &Map, theme: &Theme) {
    for (edge, colour) in solid::shaded(panel, theme) {
        ground.area(map.points(&edge), colour);
    }
    for cone in &panel.cones {
        for edge in &cone.inside {
            ground.area(map.points(edge), cone_fill(theme));
        }
    }
    for area in &panel.areas {
        let points = map.points(&area.edge);
        sides(ground, &points, map.rect());
        ground.area(points, area_fill(panel, theme, area));
        // Back to the first point: an edge is closed.
        let edge = area.edge.iter().chain(area.edge.first());
        ground.line(edge.map(|point| map.at(*point)).collect(), THIN);
    }
}

/// The sides of the panel where shade ends at them.
fn sides(ground: &mut Ground, edge: &[[f64; 2]], Rect { min, max }: Rect) {
    // In pieces, since shade may end anywhere along a side.
    let height = |k: u32| min[1] + (max[1] - min[1]) * f64::from(k) / f64::from(PIECES);
    for (x, inner) in [(min[0], min[0] + INNER), (max[0], max[0] - INNER)] {
        // Just within the panel: on its very side the shade's own edge decides either way.
        let is_shaded = |k: u32| is_inside([inner, 0.5 * (height(k) + height(k + 1))], edge);
        let mut from = 0;
        while from < PIECES {
            let to = (from..PIECES).find(|k| !is_shaded(*k)).unwrap_or(PIECES);
            if to > from {
                ground.line(vec![[x, height(from)], [x, height(to)]], THIN);
            }
            from = to + 1;
        }
    }
}

/// World lines and axes, with their ticks.
fn lines(ground: &mut Ground, panel: &Panel, map: &Map) {
    for line in &panel.world_lines {
        ground.line(map.points(&line.curve.points), 1.0);
        for tick in &line.ticks {
            ground.line(across(map, tick).into(), 1.0);
        }
    }
    let axes = panel.axes.iter();
    let axes = axes.flat_map(|axes| [&axes.time, &axes.space].into_iter().chain(&axes.depth));
    for axis in axes {
        ground.line(map.points(&axis.ends), 1.0);
        ground.dot(map.at(axis.ends[1]), AXIS_HEAD);
        for tick in axis.ticks.iter().filter(|tick| is_inner(map, axis, tick)) {
            ground.line(across(map, tick).into(), 1.0);
        }
    }
}

/// The ends of a tick, on the page.
fn across(map: &Map, tick: &Tick) -> [[f64; 2]; 2] {
    let [x, y] = map.at(tick.at);
    let [right, up] = map.direction(tick.along);
    [-TICK, TICK].map(|half| [x + half * up, y + half * right])
}

fn thin_lines(ground: &mut Ground, panel: &Panel, map: &Map) {
    let segments = panel.signals.iter().chain(&panel.slices);
    let segments = segments.chain(&panel.arrows).map(|segment| segment.ends);
    let intervals = panel.intervals.iter().map(|interval| interval.ends);
    let rays = panel.cones.iter().flat_map(|cone| &cone.rays);
    let horizons = panel.areas.iter().flat_map(|area| &area.horizons);
    let straight = segments.chain(intervals);
    let straight = straight.chain(rays.chain(horizons).copied());
    for ends in straight {
        ground.line(map.points(&ends), THIN);
    }
    for curve in &panel.curves {
        ground.line(map.points(&curve.points), 1.0);
    }
    for hyperbola in &panel.hyperbolae {
        ground.line(map.points(&hyperbola.curve.points), THIN);
    }
}

/// The outlines of cones and planes in a room.
fn solids(ground: &mut Ground, panel: &Panel, map: &Map) {
    for nappe in panel.cones.iter().flat_map(|cone| &cone.nappes) {
        for half in [&nappe.near, &nappe.far] {
            ground.side(map.points(&solid::mantle(nappe, half)));
        }
        ground.line(map.points(&nappe.outline()), 1.0);
        ground.line(map.points(&nappe.near), 1.0);
        ground.line(map.points(&nappe.far), THIN);
    }
    for plane in &panel.planes {
        let corners = plane.corners.iter().chain(plane.corners.first());
        ground.line(corners.map(|corner| map.at(*corner)).collect(), THIN);
    }
    if let Some(solid) = &panel.solid {
        let floor = solid.floor.iter().chain(solid.floor.first());
        ground.line(floor.map(|corner| map.at(*corner)).collect(), DOTTED);
        for drop in &solid.drops {
            ground.line(map.points(drop), DOTTED);
        }
        for shadow in &solid.shadows {
            ground.line(map.points(&shadow.points), DOTTED);
        }
    }
}
