//! Frames, world lines and events by name, each resolved on first use.

use std::ops::Range;

use glam::DVec3;

use super::given::Given;
use super::{scene, settings};
use crate::error::{Error, Result};
use crate::figures::diagram::file;
use crate::figures::diagram::model::{Diagram, NamedLine, Reference, Spot, Track};
use crate::figures::diagram::spot::{OneOrMany, Place, ProperAcceleration, Speed};
use crate::scene::At;
use crate::scene::Context;
use crate::scene::Kinematics;
use crate::scene::nearest;
use crate::scene::refuse_duplicates;
use crate::scene::velocity;
use crate::spacetime::units::quoted;
use crate::spacetime::{Event, InertialFrame, Rest, Velocity, World};

/// The state of a name.
enum Slot<T> {
    /// Nothing yet.
    Unasked,
    /// It is being resolved.
    Asked,
    /// Its meaning.
    Known(T),
}

/// The resolvers of each kind of named element.
#[derive(Clone, Copy)]
pub(super) struct Resolvers {
    pub frame: fn(&mut Names, &At<file::DiagramFrame>) -> Result<Reference>,
    pub line: fn(&mut Names, &At<file::DiagramLine>) -> Result<NamedLine>,
    pub event: fn(&mut Names, &At<file::DiagramEvent>) -> Result<Spot<Given>>,
}

/// The names of a diagram.
pub(super) struct Names<'a> {
    pub cx: &'a Context,
    pub file: &'a file::Diagram,
    /// Metres of a number.
    pub unit: f64,
    /// Along which x is measured, unit vector.
    pub direction: DVec3,
    /// Along which y is measured, in 2+1 dimensions.
    pub across: Option<DVec3>,
    pub scene: &'a Kinematics,
    resolvers: Resolvers,
    /// The world, then those of the file, then the camera's unless the file has one of that name.
    frames: Vec<Slot<Reference>>,
    lines: Vec<Slot<NamedLine>>,
    events: Vec<Slot<Spot<Given>>>,
}

impl<'a> Names<'a> {
    pub fn new(
        cx: &'a Context,
        file: &'a file::Diagram,
        unit: f64,
        (direction, across): (DVec3, Option<DVec3>),
        scene: &'a Kinematics,
        resolvers: Resolvers,
    ) -> Result<Self> {
        refuse_duplicates(cx, file.frame.iter().map(|at| &at.value.name), "frame")?;
        refuse_duplicates(
            cx,
            file.worldline.iter().map(|at| &at.value.name),
            "world line",
        )?;
        refuse_duplicates(cx, file.event.iter().map(|at| &at.value.name), "event")?;
        if let Some(at) = file.frame.iter().find(|at| at.value.name.value == "world") {
            let help = "give it another name";
            let what = "\"world\" is the name of the scene's own frame";
            return Err(cx.refuse(&at.value.name, what, help));
        }
        let mut names = Names {
            cx,
            file,
            unit,
            direction,
            across,
            scene,
            resolvers,
            frames: vec![Slot::Known(Reference::world())],
            lines: file.worldline.iter().map(|_| Slot::Unasked).collect(),
            events: file.event.iter().map(|_| Slot::Unasked).collect(),
        };
        names
            .frames
            .extend(file.frame.iter().map(|_| Slot::Unasked));
        let taken = file.frame.iter().any(|at| at.value.name.value == "camera");
        if let (Some(camera), false) = (&scene.camera, taken) {
            names
                .frames
                .extend(scene::camera_frame(camera).map(Slot::Known));
        }
        Ok(names)
    }

    /// Resolves every name into `diagram`.
    pub fn resolve_all(&mut self, diagram: &mut Diagram) -> Result<()> {
        for (i, at) in self.file.frame.iter().enumerate() {
            self.reference(i + 1, &at.span)?;
        }
        for (i, at) in self.file.worldline.iter().enumerate() {
            self.line(i, &at.span)?;
        }
        for (i, at) in self.file.event.iter().enumerate() {
            self.spot(i, &at.span)?;
        }
        diagram.frames = known(&self.frames);
        diagram.lines = known(&self.lines);
        let events = known(&self.events);
        diagram.events = events.iter().map(|spot| spot.map(|at| at.event)).collect();
        Ok(())
    }

    /// The frames to draw in.
    pub fn views(&mut self) -> Result<Vec<usize>> {
        match &self.file.view {
            None => Ok(vec![0]),
            Some(at) => match &at.value {
                OneOrMany::One(name) => Ok(vec![self.frame_named(name, &at.span)?]),
                OneOrMany::Many(names) if !names.is_empty() => {
                    let frame = |name: &At<String>| self.frame_named(&name.value, &name.span);
                    names.iter().map(frame).collect()
                }
                OneOrMany::Many(_) => {
                    let what = "there is no frame to draw in";
                    Err(self
                        .cx
                        .refuse(at, what, "leave `view` out, or name a frame"))
                }
            },
        }
    }

    /// The i-th element of a kind, referenced at `span`; resolved by `resolve` on first use.
    fn known<T: Clone>(
        &mut self,
        slots: fn(&mut Self) -> &mut Vec<Slot<T>>,
        i: usize,
        span: &Range<usize>,
        resolve: impl FnOnce(&mut Self) -> Result<T>,
    ) -> Result<T> {
        match &mut slots(self)[i] {
            Slot::Known(known) => return Ok(known.clone()),
            Slot::Asked => {
                let what = "this is defined in terms of itself";
                let help = "define one of them by numbers";
                return Err(self.cx.report.refuse(span, what, help));
            }
            slot => *slot = Slot::Asked,
        }
        let known = resolve(self)?;
        slots(self)[i] = Slot::Known(known.clone());
        Ok(known)
    }

    fn reference(&mut self, i: usize, span: &Range<usize>) -> Result<Reference> {
        let frames = &self.file.frame;
        self.known(
            |names| &mut names.frames,
            i,
            span,
            |names| {
                // World and camera are known from the beginning.
                (names.resolvers.frame)(names, &frames[i - 1])
            },
        )
    }

    /// The i-th world line, referenced at `span`.
    pub fn line(&mut self, i: usize, span: &Range<usize>) -> Result<NamedLine> {
        let at = &self.file.worldline[i];
        self.known(
            |names| &mut names.lines,
            i,
            span,
            |names| (names.resolvers.line)(names, at),
        )
    }

    fn spot(&mut self, i: usize, span: &Range<usize>) -> Result<Spot<Given>> {
        let at = &self.file.event[i];
        self.known(
            |names| &mut names.events,
            i,
            span,
            |names| (names.resolvers.event)(names, at),
        )
    }

    fn frame_names(&self) -> Vec<&'a str> {
        let own = self
            .file
            .frame
            .iter()
            .map(|at| at.value.name.value.as_str());
        let mut names: Vec<&str> = std::iter::once("world").chain(own).collect();
        if self.frames.len() > names.len() {
            names.push("camera");
        }
        names
    }

    fn frame_named(&self, name: &str, span: &Range<usize>) -> Result<usize> {
        find(self.cx, name, span, &self.frame_names(), "frame")
    }

    /// The frame of this name and its index; the world if no name is given.
    pub fn frame(&mut self, name: &Option<At<String>>) -> Result<(usize, InertialFrame<Rest>)> {
        let Some(at) = name else {
            return Ok((0, Reference::world().frame));
        };
        let i = self.frame_named(&at.value, &at.span)?;
        Ok((i, self.reference(i, &at.span)?.frame))
    }

    /// The i-th frame.
    pub fn frame_at(&mut self, i: usize, span: &Range<usize>) -> Result<InertialFrame<Rest>> {
        Ok(self.reference(i, span)?.frame)
    }

    fn line_names(&self) -> Vec<&'a str> {
        let lines = self.file.worldline.iter();
        lines.map(|at| at.value.name.value.as_str()).collect()
    }

    fn event_names(&self) -> Vec<&'a str> {
        let events = self.file.event.iter();
        events.map(|at| at.value.name.value.as_str()).collect()
    }

    /// The index of a world line.
    pub fn line_named(&self, at: &At<String>) -> Result<usize> {
        find(
            self.cx,
            &at.value,
            &at.span,
            &self.line_names(),
            "world line",
        )
    }

    /// The track of the world line of this name, or of something in the scene.
    pub fn track(&mut self, at: &At<String>) -> Result<Track> {
        if let Some(i) = self.line_names().iter().position(|name| *name == at.value) {
            return Ok(self.line(i, &at.span)?.track);
        }
        if let Some(track) = self.of_scene(&at.value, &at.span)? {
            return Ok(track);
        }
        let mut all = self.line_names();
        all.extend(self.scene.names());
        Err(unknown(self.cx, &at.value, &at.span, &all, "world line"))
    }

    /// The track of the thing of this name in the scene, if there is one.
    pub fn of_scene(&self, name: &str, span: &Range<usize>) -> Result<Option<Track>> {
        let mut found = scene::tracks(self.scene, name);
        if found.len() > 1 {
            let what = format!(
                "{} things of the scene are named {}",
                found.len(),
                in_quotes(name)
            );
            let help = "give each a name of its own";
            return Err(self.cx.report.refuse(span, what, help));
        }
        Ok(found.pop())
    }

    /// A proper acceleration, 1/m.
    pub fn per_metre(&self, acceleration: &ProperAcceleration) -> f64 {
        acceleration.per_metre(self.unit, self.cx.speed_of_light)
    }

    /// The world line that `spot` names, if it names one and no event.
    pub fn emitter(&mut self, spot: &At<Place>) -> Result<Option<Track>> {
        let Place::Name(name) = &spot.value else {
            return Ok(None);
        };
        if self.event_names().contains(&name.as_str()) {
            return Ok(None);
        }
        let known = self.line_names().contains(&name.as_str())
            || self.of_scene(name, &spot.span)?.is_some();
        if !known {
            let mut all = self.event_names();
            all.extend(self.line_names());
            let thing = "event or world line";
            return Err(unknown(self.cx, name, &spot.span, &all, thing));
        }
        let at = At {
            value: name.clone(),
            span: spot.span.clone(),
        };
        self.track(&at).map(Some)
    }

    /// The event at `spot`, coordinates being those of the world.
    pub fn event(&mut self, spot: &At<Place>) -> Result<Event<World>> {
        Ok(self.given(spot, &Reference::world().frame)?.event)
    }

    /// The event at `spot` as it is given, coordinates being those of `frame`.
    pub fn given(&mut self, spot: &At<Place>, frame: &InertialFrame<Rest>) -> Result<Given> {
        match &spot.value {
            Place::At(numbers) => {
                let [ct, x] = numbers.0.map(|number| number * self.unit);
                Ok(Given::within(frame, Event::new(ct, self.direction * x)))
            }
            Place::Deep(numbers) => {
                let across = self.across.ok_or_else(|| {
                    let what = "[ct, x, y] is for 2+1 dimensions, but this diagram has 1+1";
                    let help = "write [ct, x], or dimensions = \"2+1\" in [diagram]";
                    self.cx.refuse(spot, what, help)
                })?;
                let [ct, x, y] = numbers.0.map(|number| number * self.unit);
                let at = Event::new(ct, self.direction * x + across * y);
                Ok(Given::within(frame, at))
            }
            Place::Name(name) => {
                let i = find(self.cx, name, &spot.span, &self.event_names(), "event")?;
                Ok(self.spot(i, &spot.span)?.at)
            }
        }
    }

    /// The velocity in the world that is `speed` relative to `frame`.
    pub fn velocity(
        &mut self,
        speed: &Option<At<Speed>>,
        relative_to: &Option<At<String>>,
    ) -> Result<Velocity> {
        let (_, frame) = self.frame(relative_to)?;
        let Some(at) = speed else {
            return Ok(frame.velocity());
        };
        let refuse = |error| velocity::refusal(self.cx, &at.span, error);
        let own = match &at.value {
            Speed::Beta(beta) => {
                velocity::from_signed_beta(beta.0, self.direction).map_err(refuse)?
            }
            Speed::Table(table) => velocity::said(self.cx, table, &at.span, self.direction)?,
        };
        own.relative_to(-frame.velocity()).map_err(refuse)
    }

    /// Words beside something that has a name.
    pub fn label(&self, label: &Option<At<String>>, name: &At<String>) -> Result<Option<String>> {
        match label {
            Some(_) => settings::words(self.cx, label),
            None => settings::settable(self.cx, name, &name.value).map(Some),
        }
    }
}

fn known<T: Clone>(slots: &[Slot<T>]) -> Vec<T> {
    let known = slots.iter().filter_map(|slot| match slot {
        Slot::Known(known) => Some(known.clone()),
        Slot::Unasked | Slot::Asked => None,
    });
    known.collect()
}

fn find(
    cx: &Context,
    name: &str,
    span: &Range<usize>,
    names: &[&str],
    thing: &str,
) -> Result<usize> {
    let found = names.iter().position(|known| *known == name);
    found.ok_or_else(|| unknown(cx, name, span, names, thing))
}

fn unknown(cx: &Context, name: &str, span: &Range<usize>, names: &[&str], thing: &str) -> Error {
    let what = format!("there is no {thing} {}", in_quotes(name));
    let meant = nearest(name, names.iter().copied());
    let meant = meant.map(|name| format!("did you mean {}? ", in_quotes(name)));
    let known: Vec<String> = names.iter().take(12).map(|name| in_quotes(name)).collect();
    let known = match known.is_empty() {
        true => "there are none".to_string(),
        false => format!("there are: {}", known.join(", ")),
    };
    let help = meant.unwrap_or_default() + &known;
    cx.report.refuse(span, what, help)
}

/// A name in quotes; the primes of frames need no escape.
fn in_quotes(name: &str) -> String {
    quoted(name).replace("\\'", "'")
}
