//! From the world to the coordinates of a view.

use glam::DVec3;

use super::types::Point;
use crate::figures::diagram::model::{Diagram, Reference};
use crate::spacetime::{Displacement, Event, InertialFrame, Rest, World};

/// The least speed across the directions that are drawn, in parts of that of light, that a reader could measure in a diagram.
const VISIBLE: f64 = 1e-4;

/// A frame in whose coordinates a diagram is drawn.
pub(super) struct View<'d> {
    pub diagram: &'d Diagram,
    pub index: usize,
    pub reference: Reference,
}

impl<'d> View<'d> {
    pub fn new(diagram: &'d Diagram, index: usize) -> Self {
        View {
            diagram,
            index,
            reference: diagram
                .frames
                .get(index)
                .cloned()
                .unwrap_or_else(Reference::world),
        }
    }

    pub fn frame(&self) -> &InertialFrame<Rest> {
        &self.reference.frame
    }

    /// Where an event is.
    pub fn point(&self, event: Event<World>) -> Point {
        let own = self.frame().event_from_world(event);
        self.project(own.ct, own.x)
    }

    /// A displacement.
    pub fn vector(&self, step: Displacement<World>) -> Point {
        let own = self.frame().frame_from_world().displacement(step);
        self.project(own.ct, own.x)
    }

    fn project(&self, ct: f64, x: DVec3) -> Point {
        let unit = self.diagram.unit.metres;
        let across = self
            .diagram
            .across
            .map_or(0.0, |across| across.dot(x) / unit);
        Point::deep(ct / unit, self.diagram.direction.dot(x) / unit, across)
    }

    /// Whether the light between two events has a part across the directions that are drawn.
    pub fn leaves(&self, [from, to]: [Event<World>; 2]) -> bool {
        let step = self.frame().frame_from_world().displacement(to - from);
        // Rounding leaves far less, and anything visible is far more.
        self.part_beside(step.x).length() > 1e-6 * step.x.length()
    }

    /// Whether a clock that goes from one event to another moves across the directions that are drawn, at a visible part of the speed of
    /// light.
    pub fn is_beside(&self, from: Event<World>, to: Event<World>) -> bool {
        let step = self.frame().frame_from_world().displacement(to - from);
        self.part_beside(step.x).length() > VISIBLE * step.ct.abs()
    }

    /// The part of a displacement across the directions that are drawn.
    fn part_beside(&self, x: DVec3) -> DVec3 {
        let (n, m) = (
            self.diagram.direction,
            self.diagram.across.unwrap_or_default(),
        );
        x - n * n.dot(x) - m * m.dot(x)
    }

    /// Whether the diagram has 2+1 dimensions.
    pub fn is_solid(&self) -> bool {
        self.diagram.across.is_some()
    }

    /// One unit along the time axis and along the space axis of a frame.
    pub fn axes_of(&self, index: usize) -> [Point; 2] {
        if index == self.index {
            return [Point::new(1.0, 0.0), Point::new(0.0, 1.0)];
        }
        let unit = self.diagram.unit.metres;
        let frame = View::new(self.diagram, index).reference.frame;
        let steps = [
            Displacement::new(unit, DVec3::ZERO),
            Displacement::new(0.0, self.diagram.direction * unit),
        ];
        steps.map(|step| self.vector(frame.world_from_frame().displacement(step)))
    }

    /// One unit along the y axis of a frame, in 2+1 dimensions.
    pub fn depth_of(&self, index: usize) -> Option<Point> {
        let across = self.diagram.across?;
        if index == self.index {
            return Some(Point::deep(0.0, 0.0, 1.0));
        }
        let frame = View::new(self.diagram, index).reference.frame;
        let step = Displacement::new(0.0, across * self.diagram.unit.metres);
        Some(self.vector(frame.world_from_frame().displacement(step)))
    }

    /// The slope along x and along y of ct at constant time in a frame.
    pub fn rise_of(&self, index: usize) -> [f64; 2] {
        let frame = View::new(self.diagram, index).reference.frame;
        let time = |ct: f64, x: DVec3| {
            let step = self
                .frame()
                .world_from_frame()
                .displacement(Displacement::new(ct, x));
            frame.frame_from_world().displacement(step).ct
        };
        let across = self.diagram.across.unwrap_or_default();
        let up = time(1.0, DVec3::ZERO);
        [self.diagram.direction, across].map(|x| -time(0.0, x) / up)
    }

    /// The origin of a frame's coordinates.
    pub fn origin_of(&self, index: usize) -> Point {
        if index == self.index {
            return Point::default();
        }
        self.point(View::new(self.diagram, index).reference.frame.origin())
    }
}
