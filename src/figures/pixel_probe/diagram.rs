//! The space-time diagram of a probe.

use glam::DVec3;

use super::{Probe, ProbeHit, PulseLight};
use crate::figures::diagram::model::{
    Colour, Cone, Diagram, NamedLine, Reference, Segment, Slice, SliceKind, Spot, Track,
    part_across,
};
use crate::figures::diagram::{limits, number, tick_step};
use crate::spacetime::{Displacement, Event, InertialFrame, Rest, Velocity, World};
use crate::text::RichText;
use crate::text::rich::escaped;

/// The approximate number of ticks of clocks from the first to the last event.
const TICKS: f64 = 8.0;
/// The most pulses that are drawn.
const MOST_PULSES: usize = 2;
/// How much the past cone extends beyond the emission in 2+1 dimensions.
const BEYOND: f64 = 1.1;

/// An end of the light that a pixel sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// At the camera.
    Reception,
    /// At the emission, or where its ray is no longer followed.
    Emission,
}

/// The diagram of `probe`, in the coordinates of the frame of this name: "world", "camera", the name of the object that is hit, or one of
/// the frames of `base`; without a name, of the view of `base`. `None` if there is no such frame.
///
/// Its coordinates are 0 at `origin`, or at the frame's own origin.
///
/// It has the unit, limits, dimensions, title, frames and style of `base`, the diagram of the same scene, but not its contents.
pub fn diagram(
    probe: &Probe,
    base: Diagram,
    frame: Option<&str>,
    origin: Option<Origin>,
) -> Option<Diagram> {
    let mut diagram = emptied(base);
    // Frames first: views are chosen among them.
    let camera = frames(probe, &mut diagram);
    if let Some(name) = frame {
        diagram.views = vec![diagram.frames.iter().position(|known| known.name == name)?];
    }
    // Views keep their velocities, with the requested origin.
    if let Some(origin) = origin {
        let event = match origin {
            Origin::Reception => probe.reception.event,
            Origin::Emission => probe.far_end(),
        };
        for index in diagram.views.clone() {
            if let Some(view) = diagram.frames.get_mut(index) {
                view.frame = InertialFrame::new(view.frame.velocity(), event);
            }
        }
    }
    let view = diagram
        .views
        .first()
        .and_then(|i| diagram.frames.get(*i))
        .map(|view| view.frame);
    let view = view.unwrap_or_else(at_rest);
    // Space is shown along the ray, so that the light lies in the plane of the drawing.
    let axes = Axes::new(probe, &view);
    (diagram.direction, diagram.meaning) = (axes.along, Some("along the ray".into()));
    diagram.across = diagram.across.map(|_| axes.across);
    let builder = DiagramBuilder {
        probe,
        view,
        camera,
        diagram,
    };
    Some(builder.build())
}

fn at_rest() -> InertialFrame<Rest> {
    InertialFrame::new(Velocity::REST, Event::ORIGIN)
}

/// A diagram in which nothing is drawn.
fn emptied(base: Diagram) -> Diagram {
    // Numbers of a pixel need a unit, even if the diagram of the scene has none.
    let metres = base.unit.metres;
    let mut unit = base.unit;
    if unit.names.is_none() && metres == 1.0 {
        unit.names = Some(["m", "m"]);
    }
    Diagram {
        unit,
        lines: Vec::new(),
        events: Vec::new(),
        cones: Vec::new(),
        signals: Vec::new(),
        slices: Vec::new(),
        intervals: Vec::new(),
        hyperbolae: Vec::new(),
        curves: Vec::new(),
        labels: None,
        sheets: Vec::new(),
        regions: Vec::new(),
        arrows: Vec::new(),
        wedges: Vec::new(),
        texts: Vec::new(),
        notes: Vec::new(),
        ..base
    }
}

/// Adds the frames of camera and object, without axes; gives the index of the camera's.
fn frames(probe: &Probe, diagram: &mut Diagram) -> usize {
    for frame in &mut diagram.frames {
        frame.axes &= frame.name != "camera";
    }
    if let Some(hit) = &probe.hit {
        let frame = InertialFrame::new(hit.velocity, hit.emission);
        add_frame(diagram, &hit.name, frame);
    }
    let camera = &probe.reception.frame;
    let frame = InertialFrame::new(camera.velocity(), camera.origin());
    if let Some(i) = diagram
        .frames
        .iter()
        .position(|known| known.name == "camera")
    {
        diagram.frames[i].frame = frame;
        return i;
    }
    add_frame(diagram, "camera", frame);
    diagram.frames.len() - 1
}

fn add_frame(diagram: &mut Diagram, name: &str, frame: InertialFrame<Rest>) {
    if diagram.frames.iter().any(|known| known.name == name) {
        return;
    }
    diagram.frames.push(Reference::bare(name, frame));
}

/// The directions of space of a diagram, in the coordinates of its frame.
struct Axes {
    along: DVec3,
    across: DVec3,
}

impl Axes {
    /// Along the ray, and perpendicular to it towards the side with most to show: motion, or the way to a lamp.
    fn new(probe: &Probe, view: &InertialFrame<Rest>) -> Axes {
        let (d, _) = view.frame_from_world().direction(probe.direction);
        let along = d.unit();
        let moving = |velocity: Velocity| {
            let relative = velocity.relative_to(view.velocity()).ok();
            relative.map_or(DVec3::ZERO, |v| v.rapidity())
        };
        let hit = probe.hit.as_ref();
        let way = |lamp: &PulseLight| {
            let to = lamp.left - probe.far_end();
            view.frame_from_world().displacement(to).x
        };
        // The first side that is not along the ray: of the motions, then of the lamps, then any.
        let mut sides = vec![moving(probe.reception.frame.velocity())];
        sides.extend(hit.map(|hit| moving(hit.velocity)));
        sides.extend(hit.iter().flat_map(|hit| hit.pulses.iter().map(way)));
        sides.extend([along.cross(DVec3::Y), DVec3::X]);
        let across = sides.into_iter().find_map(|side| part_across(along, side));
        Axes {
            along,
            across: across.unwrap_or(DVec3::Z),
        }
    }
}

impl Probe {
    /// The far end of the ray: the emission, or where it is no longer followed.
    pub fn far_end(&self) -> Event<World> {
        match &self.hit {
            Some(hit) => hit.emission,
            None => {
                let step = Displacement::new(-self.index, self.direction.unit());
                self.reception.pinhole + step * self.reach
            }
        }
    }
}

/// A diagram under construction.
struct DiagramBuilder<'a> {
    probe: &'a Probe,
    /// In whose coordinates it is drawn first.
    view: InertialFrame<Rest>,
    camera: usize,
    diagram: Diagram,
}

impl DiagramBuilder<'_> {
    fn build(mut self) -> Diagram {
        let [column, row] = self.probe.pixel;
        let title = || format!("What pixel ({column}, {row}) sees");
        self.diagram.title = self.diagram.title.take().or_else(|| Some(title()));
        self.camera_and_ray();
        match &self.probe.hit {
            Some(hit) => self.surface(hit),
            None => self.mark("far end", None, self.probe.far_end(), false),
        }
        self.cone();
        self.fit();
        self.diagram
    }

    /// The distance of ticks of a clock that moves with `velocity`, metres.
    fn step(&self, velocity: Velocity) -> f64 {
        let probe = self.probe;
        let reception = probe.reception;
        // The span of all that is drawn, in time of the view.
        let mut events = vec![probe.far_end(), reception.event, reception.pinhole];
        if let Some(hit) = &probe.hit {
            events.extend(hit.now.into_iter().chain(hit.now_in_world));
            events.extend(hit.pulses.iter().take(MOST_PULSES).map(|lamp| lamp.left));
        }
        let times = events
            .into_iter()
            .map(|event| self.view.event_from_world(event).ct);
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        let [first, last] = times.fold(ends, |[a, b], ct| [a.min(ct), b.max(ct)]);
        // A probe of a single moment has the length of its ray for a span.
        let way = probe.far_end().x - reception.event.x;
        let all = if last > first {
            last - first
        } else {
            way.length()
        };
        // A moving clock shows 1/γ of it.
        let relative = velocity.relative_to(self.view.velocity());
        let own = all / relative.map_or(1.0, Velocity::gamma);
        let unit = self.diagram.unit.metres;
        tick_step(own.max(f64::MIN_POSITIVE) / unit / TICKS) * unit
    }

    fn line(&mut self, name: &str, track: Track, colour: Colour, ticks: Option<f64>) {
        let line = NamedLine {
            name: name.into(),
            label: Some(settable(name)),
            track,
            ticks,
            numbers: ticks.is_some(),
            colour: Some(colour),
        };
        self.diagram.lines.push(line);
    }

    /// A single view shows the events; world lines extend beyond it.
    fn fit(&mut self) {
        let &[view] = self.diagram.views.as_slice() else {
            return;
        };
        let bare = Diagram {
            lines: Vec::new(),
            ..self.diagram.clone()
        };
        // World lines have no ends to fit.
        let limits = limits(&bare, view);
        let unit = self.diagram.unit.metres;
        let metres = |limits: [f64; 2]| Some(limits.map(|end| end * unit));
        self.diagram.x = self.diagram.x.or(metres(limits.x));
        self.diagram.ct = self.diagram.ct.or(metres(limits.ct));
        if self.diagram.across.is_some() {
            self.diagram.y = self.diagram.y.or(metres(limits.y));
        }
    }

    fn mark(&mut self, name: &str, label: Option<String>, event: Event<World>, dot: bool) {
        self.diagram.events.push(Spot {
            name: name.into(),
            at: event,
            label,
            dot,
            colour: None,
        });
    }

    fn signal(&mut self, from: Event<World>, to: Event<World>, label: Option<String>) {
        self.diagram.signals.push(Segment {
            ends: [from, to],
            label,
            colour: None,
            owner: None,
        });
    }

    /// "τ_name = time", with its unit.
    fn clock(&self, name: &str, time: f64) -> String {
        let unit = self.diagram.unit;
        let time = number(time / unit.metres);
        let unit = unit
            .names
            .map_or(String::new(), |[name, _]| format!(" {name}"));
        format!("*τ*_{{{}}} = {time}{unit}", settable(name))
    }

    fn camera_and_ray(&mut self) {
        let probe = self.probe;
        let reception = probe.reception;
        let ticks = self.step(reception.frame.velocity());
        self.line("camera", probe.camera.clone(), Colour::Blue, Some(ticks));
        if let Some(element) = &probe.element {
            self.line("sensor", element.clone(), Colour::Sky, None);
        }
        let clock = self.clock("camera", reception.time);
        self.mark(
            "reception",
            Some(format!("seen: {clock}")),
            reception.event,
            true,
        );
        if reception.pinhole != reception.event {
            self.mark("pinhole", None, reception.pinhole, true);
            self.signal(reception.pinhole, reception.event, None);
        }
        let label = match &probe.hit {
            Some(hit) => format!("*W* = {}", number(hit.ratio)),
            None => "meets nothing".to_string(),
        };
        self.signal(probe.far_end(), reception.pinhole, Some(label));
    }

    fn surface(&mut self, hit: &ProbeHit) {
        let ticks = self.step(hit.velocity);
        self.line(&hit.name, hit.track.clone(), Colour::Red, Some(ticks));
        let clock = self.clock(&hit.name, hit.time);
        self.mark(
            "emission",
            Some(format!("emitted: {clock}")),
            hit.emission,
            true,
        );
        self.nows(hit);
        for lamp in hit.pulses.iter().take(MOST_PULSES) {
            self.lamp(lamp, hit.emission);
        }
    }

    /// The light of a pulse; one from the same event takes the name in beside its own.
    fn lamp(&mut self, lamp: &PulseLight, emission: Event<World>) {
        let name = settable(&lamp.name);
        let mut marks = self.diagram.events.iter_mut();
        if let Some(mark) = marks.find(|mark| mark.at == lamp.left) {
            mark.label = Some(
                mark.label
                    .take()
                    .map_or(name.clone(), |label| format!("{label}, {name}")),
            );
            return;
        }
        self.mark(&lamp.name, Some(name), lamp.left, true);
        self.signal(lamp.left, emission, None);
    }

    /// The position of the surface when it is seen.
    fn nows(&mut self, hit: &ProbeHit) {
        let reception = self.probe.reception.event;
        let rests = self.probe.reception.frame.velocity().is_rest();
        let camera = if rests { "now" } else { "now, for the camera" };
        // For a camera at rest its now is that of the world: one line is enough.
        let world = hit.now_in_world.filter(|_| !rests);
        let frames = [
            (self.camera, hit.now, camera, Colour::Blue),
            (0, world, "now, in the world", Colour::Grey),
        ];
        for (frame, now, label, colour) in frames {
            let Some(now) = now else { continue };
            let mut slice = Slice {
                frame,
                kind: SliceKind::Simultaneity,
                event: reception,
                to: Some(now),
                label: None,
                colour: Some(colour),
            };
            self.mark(label, Some(label.into()), now, true);
            self.diagram.slices.push(slice.clone());
            // In 2+1 dimensions the camera's now is a plane too.
            if self.diagram.across.is_some() && frame == self.camera {
                slice.to = None;
                self.diagram.slices.push(slice);
            }
        }
    }

    /// All that can be seen at the reception is on its past light cone.
    fn cone(&mut self) {
        let way = self.probe.reception.event - self.probe.far_end();
        // As high as the emission is early, or as wide if light travels along x in the frame.
        let way = self.view.frame_from_world().displacement(way);
        let height = BEYOND * way.ct.max(way.x.length());
        self.diagram.cones.push(Cone {
            event: self.probe.reception.event,
            future: false,
            past: true,
            height: Some(height),
            shade: true,
        });
    }
}

/// A name as a label; one that cannot be set is "object".
fn settable(name: &str) -> String {
    let label = escaped(name);
    match RichText::parse(&label) {
        Ok(_) => label,
        Err(_) => "object".into(),
    }
}
