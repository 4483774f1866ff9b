//! The default contents of a scene without a `[diagram]`, and limits that span nothing.
//!
//! For a scene: the world lines of camera, sensor and objects, the events of pulses with their light, and the light by which the camera
//! sees each object's origin at its time.

use super::scene;
use super::settings::settable;
use crate::error::Result;
use crate::figures::diagram::file;
use crate::figures::diagram::model::{Cone, Diagram, NamedLine, Segment, Spot, Track};
use crate::scene::At;
use crate::scene::Context;
use crate::scene::{CameraMotion, Kinematics};
use crate::spacetime::{Event, World};
use crate::text::rich::escaped;

/// The most objects that have world lines of their own.
const MOST: usize = 12;

/// The most things of a diagram: more than a page has room for.
const MOST_THINGS: usize = 5000;

/// Whether a diagram names nothing to draw.
pub(super) fn is_empty(said: &file::Diagram) -> bool {
    things(said) == 0
}

/// Refuses a diagram of more things than can be drawn in reasonable time.
pub(super) fn refuse_many<T>(
    cx: &Context,
    at: &At<T>,
    said: &file::Diagram,
    scene: &Kinematics,
) -> Result<()> {
    match things(said) + scene.pulses.len() {
        count if count <= MOST_THINGS => Ok(()),
        count => {
            let what =
                format!("{count} elements are more than the {MOST_THINGS} that a diagram may have");
            Err(cx.refuse(at, what, "draw a part of them, or several diagrams"))
        }
    }
}

/// The number of elements to draw.
fn things(said: &file::Diagram) -> usize {
    let lists = [
        said.frame.len(),
        said.worldline.len(),
        said.event.len(),
        said.light_cone.len(),
        said.signal.len(),
        said.simultaneity.len(),
        said.place.len(),
        said.interval.len(),
        said.hyperbola.len(),
        said.curve
            .iter()
            .map(|at| at.value.through.value.len())
            .sum(),
        said.sheet.len(),
        said.region.len(),
        said.arrow.len(),
        said.wedge.len(),
        said.text.len(),
    ];
    lists.iter().sum()
}

/// Fills `diagram` with the contents of the scene; messages point at `at`.
pub(super) fn of_scene<T>(
    cx: &Context,
    at: &At<T>,
    scene: &Kinematics,
    diagram: &mut Diagram,
) -> Result<()> {
    if let Some(camera) = &scene.camera {
        film(scene, camera, diagram);
    }
    diagram.notes.extend(left_out(scene));
    for body in scene.objects.iter().take(MOST) {
        let name = settable(cx, at, &escaped(&body.name)).unwrap_or_else(|_| "object".into());
        add_body(diagram, name, scene::object_track(body));
    }
    for (name, event) in &scene.pulses {
        let label = settable(cx, at, &escaped(name)).ok();
        diagram.events.push(mark(name, label, *event));
        diagram.cones.push(Cone {
            event: *event,
            future: true,
            past: false,
            height: None,
            shade: false,
        });
    }
    see(scene, diagram);
    if diagram.lines.is_empty() && diagram.events.is_empty() {
        let what = "there is nothing to draw";
        let help = "add [[diagram.worldline]], [[diagram.event]] and the like, or a scene";
        return Err(cx.refuse(at, what, help));
    }
    Ok(())
}

/// The note on objects beyond those that are drawn.
fn left_out(scene: &Kinematics) -> Option<String> {
    let all = scene.objects.len();
    let rest = all.checked_sub(MOST).filter(|rest| *rest > 0)?;
    let verb = if rest == 1 { "is" } else { "are" };
    Some(format!(
        "{rest} of {all} objects {verb} left out: [[diagram.worldline]] with of = \"NAME\" draws any"
    ))
}

fn film(scene: &Kinematics, camera: &CameraMotion, diagram: &mut Diagram) {
    if !diagram.frames.iter().any(|f| f.name == "camera") {
        diagram.frames.extend(scene::camera_frame(camera));
    }
    for name in ["camera", "sensor"] {
        if let Some(track) = scene::camera(scene, name) {
            diagram.lines.push(line(name.into(), track));
        }
    }
}

fn line(name: String, track: Track) -> NamedLine {
    NamedLine {
        label: Some(name.clone()),
        name,
        track,
        ticks: None,
        numbers: false,
        colour: None,
    }
}

fn mark(name: &str, label: Option<String>, at: Event<World>) -> Spot {
    Spot {
        name: name.into(),
        at,
        label,
        dot: true,
        colour: None,
    }
}

/// Adds the world line of an object; one that is drawn already takes the name in beside its own.
fn add_body(diagram: &mut Diagram, name: String, track: Track) {
    let (n, across) = (diagram.direction, diagram.across.unwrap_or_default());
    let place = |event: Event<World>| [event.ct, n.dot(event.x), across.dot(event.x)];
    let at = |track: &Track, time| track.at(time).map(|m| place(m.event));
    // Objects are inertial: lines that agree at two of their own times are the same.
    let same = |other: &NamedLine| {
        [0.0, 1.0]
            .iter()
            .all(|t| at(&other.track, *t) == at(&track, *t))
    };
    if let Some(other) = diagram.lines.iter_mut().find(|line| same(line)) {
        if let Some(label) = &mut other.label {
            *label = format!("{label}, {name}");
        }
        return;
    }
    diagram.lines.push(line(name, track));
}

/// The light by which the camera sees the objects' origins.
fn see(scene: &Kinematics, diagram: &mut Diagram) {
    let Some(camera) = &scene.camera else { return };
    let Some(shot) = camera.line.state(camera.model.time) else {
        return;
    };
    diagram
        .events
        .push(mark("shot", Some("shot".into()), shot.event));
    let bodies = scene.objects.iter().take(MOST);
    let seen = bodies.filter_map(|body| scene::object_track(body).emits_to(shot.event));
    diagram.signals.extend(seen.map(|emission| Segment {
        ends: [emission.event, shot.event],
        label: None,
        colour: None,
        owner: None,
    }));
}

/// Refuses elements that have no meaning in 2+1 dimensions.
pub(super) fn refuse_flat(cx: &Context, said: &file::Diagram) -> Result<()> {
    let grid = said.frame.iter().find(|at| at.value.grid == Some(true));
    let flat = [
        (
            grid.map(|at| &at.span),
            "a grid of lines of equal time and place",
            "in 2+1 dimensions equal times are planes: draw one by `simultaneity`",
        ),
        (
            said.hyperbola.first().map(|at| &at.span),
            "a hyperbola of constant interval",
            "in 2+1 dimensions it is a surface: leave it out",
        ),
        (
            said.wedge.first().map(|at| &at.span),
            "a wedge between two light rays",
            "in 2+1 dimensions draw the light cone of its event",
        ),
    ];
    let found = flat
        .into_iter()
        .find_map(|(span, what, help)| Some((span?, what, help)));
    let Some((span, what, help)) = found else {
        return Ok(());
    };
    let what = format!("{what} needs a diagram of 1+1 dimensions");
    Err(cx.report.refuse(span, what, help))
}

/// Refuses limits within which nothing is.
pub(super) fn refuse_empty_limits(
    cx: &Context,
    said: &file::Diagram,
    diagram: &Diagram,
) -> Result<()> {
    let said = [(&said.x, 1), (&said.ct, 0), (&said.y, 2)];
    for (at, axis) in said {
        let Some(at) = at else { continue };
        let [from, to] = at.value.0.map(|number| number * diagram.unit.metres);
        let within = |p: [f64; 3]| (from..=to).contains(&p[axis]);
        let mut points = points(diagram).peekable();
        // A line without ends is not sampled, so points cannot show that it stays outside.
        let straight = diagram.lines.iter().any(|l| l.track.span() == ENDLESS);
        if points.peek().is_some() && !straight && !points.any(within) {
            let what = "nothing in the diagram is within these limits";
            let help = "leave them out to have them chosen by the contents";
            return Err(cx.refuse(at, what, help));
        }
    }
    Ok(())
}

const ENDLESS: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// Events of the diagram, (ct, x, y) in the world.
fn points(diagram: &Diagram) -> impl Iterator<Item = [f64; 3]> + '_ {
    let (n, across) = (diagram.direction, diagram.across.unwrap_or_default());
    let marks = diagram.events.iter().map(|mark| mark.at);
    let signals = diagram.signals.iter().flat_map(|signal| signal.ends);
    let regions = diagram
        .regions
        .iter()
        .flat_map(|r| r.corners.iter().copied());
    let ends = diagram.lines.iter().flat_map(|line| {
        let [first, last] = line.track.span();
        // 65 events of a track show its extent.
        let steps = (0..=64).map(move |k| first + (last - first) * f64::from(k) / 64.0);
        steps.filter_map(|time| Some(line.track.at(time)?.event))
    });
    let all = marks.chain(signals).chain(regions).chain(ends);
    all.map(move |event| [event.ct, n.dot(event.x), across.dot(event.x)])
}
