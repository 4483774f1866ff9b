//! 2+1 dimensions: the floor, cones, planes, and hidden lines.
//!
//! All surfaces are translucent. Anything behind one is drawn paler, so that it looks behind, and the rim of a past cone is dashed where
//! the cone hides it.

use super::layers::{Pen, frame_colour, line_colour};
use super::page::Map;
use super::theme::Theme;
use crate::figures::diagram::layout::{Nappe, Panel, Plane, Point};
use crate::figures::diagram::model::Colour as Name;
use crate::figures::drawing::{Colour, Item, Path, Stroke};

/// Opacity of lines behind a surface, of 255.
const BEHIND: u8 = 95;
/// Opacities of the floor, of the two sides of a cone and of planes, of 255.
const FLOOR: u8 = 9;
const FAR_SIDE: u8 = 26;
const NEAR_SIDE: u8 = 44;
const PLANE: u8 = 34;
/// Pieces into which lines are divided to find hidden parts, and bisections of their ends.
const PIECES: u32 = 96;
const HALVINGS: u32 = 12;
/// Every how many points of a rim there is a generator.
const GENERATOR: usize = 8;

/// The colour of a plane: its own if given, or that of its frame; grey for the view's own.
fn plane_colour(panel: &Panel, theme: &Theme, plane: &Plane) -> Colour {
    let own = panel
        .axes
        .first()
        .is_some_and(|axes| axes.frame == plane.frame);
    match plane.colour {
        Some(name) => theme.colour(name),
        None if own => theme.colour(Name::Grey),
        None => frame_colour(panel, theme, plane.frame),
    }
}

/// The halves of cones: those of the past, and those of the future.
fn nappes(panel: &Panel) -> [Vec<&Nappe>; 2] {
    let nappes = panel.cones.iter().flat_map(|cone| &cone.nappes);
    let (past, future) = nappes.partition(|nappe| nappe.height < 0.0);
    [past, future]
}

/// The edge of a side of a mantle, with this part of its rim.
pub(super) fn mantle(nappe: &Nappe, rim: &[Point]) -> Vec<Point> {
    let mut edge = vec![nappe.apex];
    edge.extend_from_slice(rim);
    edge
}

/// The shaded surfaces of a room, in drawing order, with their colours.
pub(super) fn shaded(panel: &Panel, theme: &Theme) -> Vec<(Vec<Point>, Colour)> {
    let floor = panel.solid.iter();
    let mut all: Vec<_> = floor
        .map(|solid| (solid.floor.to_vec(), theme.ink.with_alpha(FLOOR)))
        .collect();
    let light = |alpha: u8| theme.light.with_alpha(alpha);
    let sides = |nappe: &Nappe| {
        [
            (mantle(nappe, &nappe.far), light(FAR_SIDE)),
            (mantle(nappe, &nappe.near), light(NEAR_SIDE)),
        ]
    };
    let [past, future] = nappes(panel);
    all.extend(past.into_iter().flat_map(sides));
    let plane = |plane: &Plane| {
        let colour = plane_colour(panel, theme, plane).with_alpha(PLANE);
        (plane.corners.clone(), colour)
    };
    all.extend(panel.planes.iter().map(plane));
    all.extend(future.into_iter().flat_map(sides));
    all
}

/// A text, its colour, and the points of the page that it may be placed beside.
type Wording<'a> = (&'a str, Colour, Vec<[f64; 2]>);

/// The labels of planes: at their corners, or half way between these.
pub(super) fn plane_labels<'a>(
    panel: &'a Panel,
    map: &'a Map,
    theme: &'a Theme,
) -> impl Iterator<Item = Wording<'a>> {
    panel.planes.iter().filter_map(move |plane| {
        let after = plane.corners.iter().cycle().skip(1);
        let middles = plane.corners.iter().zip(after);
        let middles = middles.map(|(a, b)| a.plus(0.5, b.from(*a)));
        let corners = plane.corners.iter().copied().chain(middles);
        let anchors = corners.map(|corner| map.at(corner)).collect();
        Some((
            plane.label.as_deref()?,
            plane_colour(panel, theme, plane),
            anchors,
        ))
    })
}

impl Pen<'_> {
    /// The floor, and the shadows on it.
    pub fn floor(&self) -> Vec<Item> {
        let Some(solid) = &self.panel.solid else {
            return Vec::new();
        };
        let ink = self.theme.ink;
        let thin = |colour: Colour, width: f64| Stroke::new(colour, width * self.theme.width);
        let floor = self.polygon(&solid.floor);
        let mut items = vec![Item::filled(floor.clone(), ink.with_alpha(FLOOR))];
        let grid = solid.grid.iter();
        // Alphas of 255: the grid is fainter than the edge of the floor, shadows are clearer.
        items.extend(grid.map(|line| self.line(*line, thin(ink.with_alpha(38), 0.3))));
        items.push(Item::stroked(floor, thin(ink.with_alpha(90), 0.35)));
        for (i, shadow) in solid.shadows.iter().enumerate() {
            let colour = line_colour(self.panel, self.theme, i).with_alpha(120);
            items.push(Item::stroked(
                self.map.polyline(&shadow.points),
                thin(colour, 0.55),
            ));
            // Anything at rest is above one point.
            let foot = shadow
                .points
                .first()
                .map(|p| Path::circle(self.map.at(*p), self.theme.width));
            let rests = shadow.points.first() == shadow.points.last();
            items.extend(
                foot.filter(|_| rests)
                    .map(|foot| Item::filled(foot, colour)),
            );
        }
        let light = self.theme.light.with_alpha(150);
        items.extend(
            solid
                .light
                .iter()
                .map(|way| self.line(*way, thin(light, 0.45))),
        );
        let drop = thin(ink.with_alpha(110), 0.3).dashed([1.5, 1.8]);
        for drop_line in &solid.drops {
            items.push(self.line(*drop_line, drop.clone()));
            let foot = Path::circle(self.map.at(drop_line[1]), 0.75 * self.theme.width);
            items.push(Item::filled(foot, ink.with_alpha(120)));
        }
        items
    }

    /// Cones and planes: past cones, then planes of simultaneity, then future cones, since each is seen from above.
    pub fn solids(&self) -> Vec<Item> {
        let [past, future] = nappes(self.panel);
        let mut items: Vec<Item> = past
            .into_iter()
            .flat_map(|nappe| self.nappe(nappe))
            .collect();
        items.extend(self.planes());
        items.extend(future.into_iter().flat_map(|nappe| self.nappe(nappe)));
        items
    }

    /// The side behind, then that in front.
    fn nappe(&self, nappe: &Nappe) -> Vec<Item> {
        let light = self.theme.light;
        let stroke =
            |alpha: u8, width: f64| Stroke::new(light.with_alpha(alpha), width * self.theme.width);
        // A past cone, seen from above, hides the farther side of its rim.
        let is_past = nappe.height < 0.0;
        let far_rim = match is_past {
            true => stroke(170, 0.5).dashed([3.0, 2.4]),
            false => stroke(255, 0.6),
        };
        let mut items = self.side(nappe, &nappe.far, FAR_SIDE, stroke(60, 0.25));
        items.push(Item::stroked(self.map.polyline(&nappe.far), far_rim));
        items.extend(self.side(nappe, &nappe.near, NEAR_SIDE, stroke(110, 0.3)));
        items.push(Item::stroked(
            self.map.polyline(&nappe.near),
            stroke(255, 0.6),
        ));
        items.push(Item::stroked(
            self.map.polyline(&nappe.outline()),
            stroke(255, 0.6),
        ));
        items
    }

    /// A side of a mantle, with some of its light rays.
    fn side(&self, nappe: &Nappe, rim: &[Point], alpha: u8, ray: Stroke) -> Vec<Item> {
        let fill = self.theme.light.with_alpha(alpha);
        let mut items = vec![Item::filled(self.polygon(&mantle(nappe, rim)), fill)];
        let inner = rim
            .iter()
            .enumerate()
            .skip(1)
            .take(rim.len().saturating_sub(2));
        let rays = inner.filter(|(i, _)| i % GENERATOR == 0);
        items.extend(rays.map(|(_, p)| self.line([nappe.apex, *p], ray.clone())));
        items
    }

    fn planes(&self) -> Vec<Item> {
        let planes = self.panel.planes.iter().flat_map(|plane| {
            let colour = plane_colour(self.panel, self.theme, plane);
            let path = self.polygon(&plane.corners);
            let edge = Stroke::new(colour.with_alpha(150), 0.4 * self.theme.width);
            [
                Item::filled(path.clone(), colour.with_alpha(PLANE)),
                Item::stroked(path, edge),
            ]
        });
        planes.collect()
    }

    /// A line, paler behind a cone or a plane.
    pub fn strokes(&self, points: &[Point], stroke: &Stroke) -> Vec<Item> {
        let has_surfaces = !self.panel.planes.is_empty()
            || self.panel.cones.iter().any(|cone| !cone.nappes.is_empty());
        if !has_surfaces {
            return vec![Item::stroked(self.map.polyline(points), stroke.clone())];
        }
        let pale = Stroke {
            colour: stroke.colour.with_alpha(BEHIND),
            ..stroke.clone()
        };
        let parts = self.parts(points).into_iter();
        let item = |(hidden, part): (bool, Vec<Point>)| {
            let stroke = if hidden { &pale } else { stroke };
            Item::stroked(self.map.polyline(&part), stroke.clone())
        };
        parts.map(item).collect()
    }

    /// The parts of a line that are behind something, and those that are not.
    fn parts(&self, points: &[Point]) -> Vec<(bool, Vec<Point>)> {
        let mut parts: Vec<(bool, Vec<Point>)> = Vec::new();
        let count = (PIECES / points.len().max(1) as u32).max(1);
        for pair in points.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            for k in 0..count {
                let at = |part: f64| a.plus(part / f64::from(count), b.from(a));
                let (from, to) = (at(f64::from(k)), at(f64::from(k + 1)));
                self.add_piece(&mut parts, from, to);
            }
        }
        parts
    }

    /// Adds a short piece, cut in two where it passes behind something or emerges.
    fn add_piece(&self, parts: &mut Vec<(bool, Vec<Point>)>, from: Point, to: Point) {
        let before = parts
            .last()
            .map_or_else(|| self.is_hidden(from), |part| part.0);
        if parts.is_empty() {
            parts.push((before, vec![from]));
        }
        let after = self.is_hidden(to);
        if after != before {
            let edge = self.edge(from, to, before);
            parts
                .iter_mut()
                .last()
                .into_iter()
                .for_each(|part| part.1.push(edge));
            parts.push((after, vec![edge]));
        }
        parts
            .iter_mut()
            .last()
            .into_iter()
            .for_each(|part| part.1.push(to));
    }

    /// The point between two points where being hidden changes from `before`.
    fn edge(&self, from: Point, to: Point, before: bool) -> Point {
        let (mut low, mut high) = (0.0, 1.0);
        // Bisection: `low` is like the first point, `high` like the second.
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            match self.is_hidden(from.plus(middle, to.from(from))) == before {
                true => low = middle,
                false => high = middle,
            }
        }
        from.plus(high, to.from(from))
    }

    /// Whether a cone or a plane is in front of a point. Points on one of them are not behind it.
    fn is_hidden(&self, p: Point) -> bool {
        let [width, height] = self.panel.limits.size();
        let clearance = 1e-6 * (width + height);
        let nappes = self.panel.cones.iter().flat_map(|cone| &cone.nappes);
        nappes.into_iter().any(|nappe| nappe.hides(p, clearance))
            || self
                .panel
                .planes
                .iter()
                .any(|plane| plane.hides(p, clearance))
    }
}
