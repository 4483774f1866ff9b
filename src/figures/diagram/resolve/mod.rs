//! `[diagram]`: names looked up, events solved for.
//!
//! Frames, world lines and events refer to each other in any order; [`Names`] resolves each on first use, and refuses circular
//! definitions.

mod animation;
mod content;
mod element;
mod event;
mod frame;
mod given;
mod line;
mod names;
mod placeholder;
mod scene;
mod settings;

use crate::error::Result;
use crate::figures::diagram::file;
use crate::figures::diagram::model::Diagram;
use crate::scene::{At, Context, Kinematics};
use names::{Names, Resolvers};

/// The diagram that `table` describes, or the one of the scene.
pub(super) fn resolve(
    cx: &Context,
    scene: &Kinematics,
    table: Option<&At<file::Diagram>>,
) -> Result<Diagram> {
    let nothing = At::nowhere(file::Diagram::default());
    let at = table.unwrap_or(&nothing);
    let said = &at.value;
    content::refuse_many(cx, at, said, scene)?;
    let unit = settings::unit(cx, said);
    let direction = settings::direction(cx, said, scene)?;
    let across = settings::across(cx, said, direction, scene)?;
    let mut diagram = Diagram {
        name: cx.report.name.clone(),
        text: cx.report.text.edited.to_string(),
        title: settings::words(cx, &said.title)?,
        unit,
        direction,
        across,
        labels: settings::labels(cx, &said.labels)?,
        x: settings::limits(cx, &said.x, unit.metres)?,
        y: settings::limits(cx, &said.y, unit.metres)?,
        ct: settings::limits(cx, &said.ct, unit.metres)?,
        style: settings::style(cx, &said.style)?,
        ..Diagram::default()
    };
    let resolvers = Resolvers {
        frame: frame::resolve,
        line: line::resolve,
        event: event::resolve,
    };
    let axes = (direction, across);
    let mut names = Names::new(cx, said, unit.metres, axes, scene, resolvers)?;
    names.resolve_all(&mut diagram)?;
    element::resolve_all(&mut names, said, &mut diagram)?;
    if across.is_some() {
        content::refuse_flat(cx, said)?;
    }
    diagram.views = names.views()?;
    diagram.animation = animation::resolve(&mut names, said, &diagram.views)?;
    if content::is_empty(said) {
        content::of_scene(cx, at, scene, &mut diagram)?;
    }
    let frames: Vec<&str> = said
        .frame
        .iter()
        .map(|at| at.value.name.value.as_str())
        .collect();
    placeholder::fill_speeds(&mut diagram, &frames);
    content::refuse_empty_limits(cx, said, &diagram)?;
    Ok(diagram)
}
