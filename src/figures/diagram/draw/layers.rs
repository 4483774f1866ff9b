//! The lines and areas of a panel, from bottom to top.

use super::labels::without;
use super::page::Map;
use super::theme::Theme;
use crate::figures::diagram::layout::{Area, Axes, Axis, Bead, Kind, Now, Panel, Point, Tick};
use crate::figures::diagram::model::{Colour as Name, Style};
use crate::figures::drawing::{Arrow, Colour, Fill, Item, Path, Stroke};
use crate::text::Rect;

/// Radius of an event's dot, in widths of world lines.
pub(super) const DOT: f64 = 1.7;
/// Radius of a clock on its way, in widths of world lines.
pub(super) const BEAD: f64 = 2.5;
/// Half the length of a tick, points.
pub(super) const TICK: f64 = 2.4;
/// Signals of less height have a smaller head half way, points.
const HEADED: f64 = 14.0;
/// Shorter signals have no head.
const HEADLESS: f64 = 3.0;

/// The length from which on a line has a direction on the page, points.
const SHORTEST: f64 = 0.01;

/// The pen for a panel's lines.
pub(super) struct Pen<'a> {
    pub panel: &'a Panel,
    pub map: &'a Map,
    pub theme: &'a Theme,
}

/// With `gaps` in lines that move from picture to picture.
pub(super) fn of(
    panel: &Panel,
    map: &Map,
    theme: &Theme,
    style: &Style,
    gaps: &[Rect],
) -> Vec<Item> {
    let pen = Pen { panel, map, theme };
    let mut clipped = pen.floor();
    clipped.extend(pen.areas());
    clipped.extend(pen.grid());
    clipped.extend(pen.solids());
    clipped.extend(pen.light());
    clipped.extend(pen.slices());
    clipped.extend(pen.hyperbolae());
    let axes = panel.axes.iter().flat_map(|axes| pen.axes(axes, style));
    let mut upper = pen.intervals();
    upper.extend(pen.curves());
    upper.extend(pen.world_lines());
    upper.extend(pen.now(gaps));
    let clip = |items: Vec<Item>| Item::Clip {
        path: Path::rect(map.rect()),
        items,
    };
    let mut items = vec![clip(clipped)];
    items.extend(axes);
    items.push(clip(upper));
    items.extend(pen.arrows());
    items.extend(pen.dots());
    items.extend(pen.beads());
    items
}

/// The colour that a frame has in a panel.
pub(super) fn frame_colour(panel: &Panel, theme: &Theme, index: usize) -> Colour {
    let own = panel.axes.first().is_some_and(|axes| axes.frame == index);
    let said = panel.axes.iter().find(|axes| axes.frame == index);
    theme.of_frame(index, own, said.and_then(|axes| axes.colour))
}

/// The colour of a world line.
pub(super) fn line_colour(panel: &Panel, theme: &Theme, index: usize) -> Colour {
    let said = panel.world_lines.get(index).and_then(|line| line.colour);
    theme.of_line(index, said)
}

/// The colour of an area.
pub(super) fn area_colour(panel: &Panel, theme: &Theme, area: &Area) -> Colour {
    match (area.colour, area.owner) {
        (Some(name), _) => theme.colour(name),
        (None, Some(line)) => line_colour(panel, theme, line),
        (None, None) => theme.colour(Name::Grey),
    }
}

/// The colour of simultaneity.
pub(super) fn now_colour(panel: &Panel, theme: &Theme, now: &Now) -> Colour {
    match now.colour {
        Some(name) => theme.colour(name),
        None => frame_colour(panel, theme, now.frame),
    }
}

/// The shade of an area.
pub(super) fn area_fill(panel: &Panel, theme: &Theme, area: &Area) -> Colour {
    area_colour(panel, theme, area).with_alpha(theme.shade)
}

/// The shade within a light cone.
pub(super) fn cone_fill(theme: &Theme) -> Colour {
    theme.light.with_alpha(theme.shade)
}

/// The tip of a signal's head, about half way, and its size relative to others; `None` for a very short one.
pub(super) fn head(panel: &Panel, map: &Map, ends: [Point; 2]) -> Option<(Point, f64)> {
    let [from, to] = panel.limits.segment(ends[0], ends[1])?;
    let height = map.at(to)[1] - map.at(from)[1];
    let size = (height.abs() / HEADED).min(1.0);
    // A little beyond the middle: the head lies before its tip.
    (height.abs() > HEADLESS).then(|| (from.plus(0.55, to.from(from)), size))
}

impl Pen<'_> {
    pub fn line(&self, ends: [Point; 2], stroke: Stroke) -> Item {
        Item::stroked(self.map.polyline(&ends), stroke)
    }

    /// A line with a head at its end, unless it is too short on the page to have a direction.
    fn arrow(&self, ends: [Point; 2], stroke: Stroke, head: Arrow) -> Item {
        let [from, to] = ends.map(|end| self.map.at(end));
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let stroke = if length > SHORTEST {
            stroke.ending(head)
        } else {
            stroke
        };
        self.line(ends, stroke)
    }

    fn named(&self, name: Option<Name>, otherwise: Name) -> Colour {
        self.theme.colour(name.unwrap_or(otherwise))
    }

    fn areas(&self) -> Vec<Item> {
        let mut items = Vec::new();
        for cone in &self.panel.cones {
            let inside = cone.inside.iter().map(|edge| self.polygon(edge));
            items.extend(inside.map(|path| Item::filled(path, cone_fill(self.theme))));
        }
        for area in &self.panel.areas {
            let fill = area_fill(self.panel, self.theme, area);
            items.push(Item::filled(self.polygon(&area.edge), fill));
            let horizon = self.theme.thin(self.theme.light).dashed([5.0, 2.5]);
            items.extend(
                area.horizons
                    .iter()
                    .map(|ray| self.line(*ray, horizon.clone())),
            );
        }
        items
    }

    pub fn polygon(&self, edge: &[Point]) -> Path {
        Path::polygon(&self.map.points(edge))
    }

    fn grid(&self) -> Vec<Item> {
        let lines = self.panel.grid.iter().map(|line| {
            let colour = frame_colour(self.panel, self.theme, line.frame).with_alpha(100);
            self.line(line.ends, Stroke::new(colour, 0.35 * self.theme.width))
        });
        lines.collect()
    }

    /// Light, thin and warm, with a head half way along each signal.
    fn light(&self) -> Vec<Item> {
        let thin = |colour: Colour| Stroke::new(colour, 0.6 * self.theme.width);
        let rays = self.panel.cones.iter().flat_map(|cone| &cone.rays);
        let rays = rays.map(|ray| self.line(*ray, thin(self.theme.light)));
        let mut items: Vec<Item> = rays.collect();
        for (signal, projected) in self.panel.signals.iter().zip(&self.panel.projected) {
            let colour = self.named(signal.colour, Name::Orange);
            let stroke = match projected {
                true => thin(colour).dashed([3.2, 2.0]),
                false => thin(colour),
            };
            // Light is visible through translucent areas, without gaps: pieces of it would look like several signals.
            items.push(self.line(signal.ends, stroke));
            if let Some((tip, size)) = head(self.panel, self.map, signal.ends) {
                let head = thin(colour).ending(Arrow {
                    length: 6.4 * size,
                    width: 4.8 * size,
                });
                // The shaft is drawn already.
                let [from, _] = self.map.points(&[signal.ends[0], tip])[..] else {
                    continue;
                };
                let at = self.map.at(tip);
                let way = (at[0] - from[0]).hypot(at[1] - from[1]);
                // A piece of seven points that carries the head along.
                let back =
                    [0, 1].map(|i| at[i] - (at[i] - from[i]) * 7.0 * size / way.max(7.0 * size));
                items.push(Item::stroked(Path::line(back, at), head));
            }
        }
        items
    }

    fn slices(&self) -> Vec<Item> {
        let slices = self.panel.slices.iter().map(|slice| {
            let frame = slice.owner.unwrap_or(0);
            let colour = match slice.colour {
                Some(name) => self.theme.colour(name),
                None => frame_colour(self.panel, self.theme, frame),
            };
            self.line(slice.ends, self.theme.thin(colour).dashed([4.0, 2.2]))
        });
        slices.collect()
    }

    fn hyperbolae(&self) -> Vec<Item> {
        let all = self.panel.hyperbolae.iter().map(|hyperbola| {
            let colour = self.named(hyperbola.colour, Name::Grey);
            let stroke = self.theme.thin(colour).dashed([6.0, 2.0, 1.2, 2.0]);
            Item::stroked(self.map.polyline(&hyperbola.curve.points), stroke)
        });
        all.collect()
    }

    fn curves(&self) -> Vec<Item> {
        let all = self.panel.curves.iter().map(|curve| {
            let colour = self.named(curve.colour, Name::Black);
            let dash: &[f64] = if curve.dashed { &[4.0, 2.2] } else { &[] };
            let stroke = Stroke::new(colour, 0.8 * self.theme.width).rounded();
            Item::stroked(self.map.polyline(&curve.points), stroke.dashed(dash))
        });
        all.collect()
    }

    /// A broad band, which is visible beside an axis under it, with the pattern of its kind on it.
    fn intervals(&self) -> Vec<Item> {
        let mut items = Vec::new();
        for interval in &self.panel.intervals {
            let colour = self.named(interval.colour, Name::Grey);
            let band = Stroke::new(colour.with_alpha(60), 3.0 * self.theme.width);
            items.push(self.band(interval.ends, band));
            let stroke = Stroke::new(colour, 0.9 * self.theme.width).rounded();
            let dash: &[f64] = match interval.kind {
                Kind::Timelike => &[],
                // With round caps: dots.
                Kind::Spacelike => &[0.1, 3.0],
                Kind::Null | Kind::Unresolved => &[6.0, 2.5],
            };
            items.push(self.line(interval.ends, stroke.dashed(dash)));
        }
        items
    }

    /// A broad line as an area: only the thin one on it is a line.
    fn band(&self, ends: [Point; 2], band: Stroke) -> Item {
        let [a, b] = ends.map(|end| self.map.at(end));
        let [x, y] = [b[0] - a[0], b[1] - a[1]];
        // Half of its width over its length.
        let half = 0.5 * band.width / x.hypot(y).max(f64::MIN_POSITIVE);
        let [u, v] = [-y * half, x * half];
        let corners = [
            [a[0] + u, a[1] + v],
            [b[0] + u, b[1] + v],
            [b[0] - u, b[1] - v],
            [a[0] - u, a[1] - v],
        ];
        Item::filled(Path::polygon(&corners), band.colour)
    }

    fn world_lines(&self) -> Vec<Item> {
        let mut items = Vec::new();
        for (i, line) in self.panel.world_lines.iter().enumerate() {
            let colour = line_colour(self.panel, self.theme, i);
            let stroke = self.theme.world_line(i, colour);
            items.extend(self.strokes(&line.curve.points, &stroke));
            let ticks = line
                .ticks
                .iter()
                .map(|tick| self.tick(tick, colour, 1.2 * TICK));
            items.extend(ticks);
        }
        items
    }

    /// A tick across the line that it is on.
    fn tick(&self, tick: &Tick, colour: Colour, half: f64) -> Item {
        let [x, y] = self.map.at(tick.at);
        let [right, up] = self.map.direction(tick.along);
        let [dx, dy] = [up * half, right * half];
        let path = Path::line([x - dx, y - dy], [x + dx, y + dy]);
        Item::stroked(path, Stroke::new(colour, 0.6 * self.theme.width))
    }

    fn axes(&self, axes: &Axes, style: &Style) -> Vec<Item> {
        let own = self.panel.axes.first() == Some(axes);
        let colour = frame_colour(self.panel, self.theme, axes.frame);
        let mut items = Vec::new();
        for axis in [&axes.time, &axes.space].into_iter().chain(&axes.depth) {
            items.push(self.axis(axis, colour));
            if style.ticks || !own {
                let inner = axis
                    .ticks
                    .iter()
                    .filter(|tick| is_inner(self.map, axis, tick));
                items.extend(inner.map(|tick| self.tick(tick, colour, TICK)));
            }
        }
        items
    }

    fn axis(&self, axis: &Axis, colour: Colour) -> Item {
        let head = Arrow {
            length: 6.5,
            width: 4.5,
        };
        self.arrow(
            axis.ends,
            Stroke::new(colour, 0.55 * self.theme.width),
            head,
        )
    }

    fn arrows(&self) -> Vec<Item> {
        let all = self.panel.arrows.iter().map(|arrow| {
            let colour = match (arrow.colour, arrow.owner) {
                (Some(name), _) => self.theme.colour(name),
                (None, Some(line)) => line_colour(self.panel, self.theme, line),
                (None, None) => self.theme.ink,
            };
            let width = 1.3 * self.theme.width;
            let head = Arrow::of_line(width);
            self.arrow(arrow.ends, Stroke::new(colour, width), head)
        });
        all.collect()
    }

    /// Simultaneous events, interrupted at `gaps`.
    fn now(&self, gaps: &[Rect]) -> Vec<Item> {
        let lines = self.panel.now.iter().flat_map(|now| {
            let stroke = self.theme.thin(now_colour(self.panel, self.theme, now));
            let parts = without(now.ends.map(|end| self.map.at(end)), gaps).into_iter();
            parts.map(move |[from, to]| Item::stroked(Path::line(from, to), stroke.clone()))
        });
        lines.collect()
    }

    /// Larger than events, and in the colours of their lines.
    fn beads(&self) -> Vec<Item> {
        let beads = self.panel.now.iter().flat_map(|now| &now.beads);
        let bead = |bead: &Bead| Item::Path {
            path: Path::circle(self.map.at(bead.at), BEAD * self.theme.width),
            fill: Some(Fill::solid(line_colour(self.panel, self.theme, bead.line))),
            stroke: Some(Stroke::new(self.theme.background, 0.6 * self.theme.width)),
        };
        beads.map(bead).collect()
    }

    fn dots(&self) -> Vec<Item> {
        let marked = self.panel.events.iter().filter(|event| event.dot);
        let seen = marked.filter(|event| self.panel.limits.contains(event.at));
        let dots = seen.map(|event| {
            let path = Path::circle(self.map.at(event.at), DOT * self.theme.width);
            Item::filled(path, self.named(event.colour, Name::Black))
        });
        dots.collect()
    }
}

/// Whether a tick is clear of the head of its axis.
pub(super) fn is_inner(map: &Map, axis: &Axis, tick: &Tick) -> bool {
    let ([x, y], [u, v]) = (map.at(tick.at), map.at(axis.ends[1]));
    (x - u).hypot(y - v) > 9.0
}
