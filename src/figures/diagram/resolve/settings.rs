//! Unit, direction, limits, words and style of a diagram.

use glam::DVec3;

use super::placeholder::{filled, with_any_speeds};
use crate::error::{Error, Result};
use crate::figures::diagram::draw::WIDTH;
use crate::figures::diagram::file;
use crate::figures::diagram::model::{Style, Unit, part_across};
use crate::figures::drawing::LONGEST_SIDE;
use crate::scene::At;
use crate::scene::Context;
use crate::scene::Kinematics;
use crate::scene::{Number, Numbers};
use crate::spacetime::units::Length;
use crate::spacetime::{Direction, World};
use crate::text::RichText;

/// Points of a metre of paper.
const POINTS: f64 = 72.0 / 0.0254;
/// The smallest relative distance of limits: closer ones cannot be distinguished on paper.
const NARROWEST: f64 = 1e-9;

/// The unit of a diagram's numbers, which have c = 1: a unit of time is as many metres as light goes in it, at the scene's speed of light.
pub(super) fn unit(cx: &Context, diagram: &file::Diagram) -> Unit {
    use file::Unit as U;
    let length = |metres, name| (metres, [name, name], false);
    let time = |seconds: f64, names| (seconds * cx.speed_of_light, names, true);
    let Some(at) = &diagram.unit else {
        return Unit::default();
    };
    let (metres, names, is_time) = match at.value {
        U::M => length(1.0, "m"),
        U::Mm => length(1e-3, "mm"),
        U::Cm => length(1e-2, "cm"),
        U::Km => length(1e3, "km"),
        U::Ps => time(1e-12, ["ps", "light-ps"]),
        U::Ns => time(1e-9, ["ns", "light-ns"]),
        U::Us => time(1e-6, ["µs", "light-µs"]),
        U::Ms => time(1e-3, ["ms", "light-ms"]),
        U::S => time(1.0, ["s", "ls"]),
        U::Min => time(60.0, ["min", "light-minutes"]),
        U::H => time(3600.0, ["h", "light-hours"]),
        U::D => time(86400.0, ["d", "light-days"]),
        // The Julian year of 365.25 days, by which light-years are defined.
        U::Yr => time(31_557_600.0, ["yr", "ly"]),
    };
    Unit {
        metres,
        names: Some(names),
        is_time,
    }
}

/// The direction along which x is measured.
pub(super) fn direction(
    cx: &Context,
    diagram: &file::Diagram,
    scene: &Kinematics,
) -> Result<DVec3> {
    let Some(at) = &diagram.direction else {
        let motion = scene.direction().and_then(Direction::<World>::new);
        return Ok(motion.map_or(DVec3::X, Direction::unit));
    };
    let unit = Direction::<World>::new(at.value.vec()).ok_or_else(|| {
        let help = "any direction of length above 0 will do, like [1, 0, 0]";
        cx.refuse(at, "the direction is the zero vector", help)
    })?;
    Ok(unit.unit())
}

/// The direction along which y is measured, a unit vector perpendicular to x; `None` in 1+1 dimensions.
pub(super) fn across(
    cx: &Context,
    diagram: &file::Diagram,
    direction: DVec3,
    scene: &Kinematics,
) -> Result<Option<DVec3>> {
    let three = matches!(&diagram.dimensions, Some(at) if at.value == file::Dimensions::Three);
    let of_three = [
        diagram.across.as_ref().map(|at| (&at.span, "across")),
        diagram.y.as_ref().map(|at| (&at.span, "y")),
    ];
    if let (false, Some((span, key))) = (three, of_three.into_iter().flatten().next()) {
        let what = format!("`{key}` needs a diagram of 2+1 dimensions");
        let help = "leave it out, or write dimensions = \"2+1\"";
        return Err(cx.report.refuse(span, what, help));
    }
    if !three {
        return Ok(None);
    }
    let Some(at) = &diagram.across else {
        let moving = scene.directions().find_map(|v| part_across(direction, v));
        return Ok(moving.or_else(|| upright(direction)));
    };
    let part = part_across(direction, at.value.vec()).ok_or_else(|| {
        let help = "give a direction that is not along x, like [0, 1, 0]";
        cx.refuse(at, "y is measured along the same line as x", help)
    })?;
    Ok(Some(part))
}

/// Across `direction`, along the y axis of the world, or along its z axis.
fn upright(direction: DVec3) -> Option<DVec3> {
    let mut axes = [DVec3::Y, DVec3::Z].into_iter();
    axes.find_map(|axis| part_across(direction, axis))
}

/// Limits in metres.
pub(super) fn limits(
    cx: &Context,
    at: &Option<At<Numbers<2>>>,
    unit: f64,
) -> Result<Option<[f64; 2]>> {
    let Some(at) = at else { return Ok(None) };
    let [from, to] = at.value.0;
    if to - from > NARROWEST * from.abs().max(to.abs()) {
        return Ok(Some([from * unit, to * unit]));
    }
    if to > from {
        let what = format!(
            "limits from {from} to {to} are too close to each other to be told apart on paper"
        );
        let help = format!(
            "give limits that differ by more than {NARROWEST:e} of the larger, or measure from an event nearby"
        );
        return Err(cx.refuse(at, what, help));
    }
    let what = format!("limits from {from} to {to} span nothing");
    Err(cx.refuse(at, what, "give the smaller number first, like [-1, 4]"))
}

/// The labels of the axes.
pub(super) fn labels(
    cx: &Context,
    at: &Option<At<[At<String>; 2]>>,
) -> Result<Option<[String; 2]>> {
    let Some(at) = at else { return Ok(None) };
    let [time, space] = &at.value;
    Ok(Some([
        settable(cx, time, &time.value)?,
        settable(cx, space, &space.value)?,
    ]))
}

/// A number above 0.
pub(super) fn positive(cx: &Context, at: &Option<At<Number>>, name: &str) -> Result<Option<f64>> {
    at.as_ref().map(|at| cx.positive(at, name)).transpose()
}

/// The most views side by side.
const MOST_COLUMNS: u32 = 12;
/// The longest text that is set in one line.
const MOST_CHARACTERS: usize = 400;

/// Words that can be set.
pub(super) fn words(cx: &Context, at: &Option<At<String>>) -> Result<Option<String>> {
    let Some(at) = at else { return Ok(None) };
    if at.value.is_empty() {
        return Ok(None);
    }
    settable(cx, at, &at.value).map(Some)
}

/// `text`, which comes from `at`, if it is markup that can be set.
pub(super) fn settable<T>(cx: &Context, at: &At<T>, text: &str) -> Result<String> {
    let text = filled(cx, at, text)?;
    let count = text.chars().count();
    if count > MOST_CHARACTERS {
        let what = format!("{count} characters do not fit on a line of a diagram");
        return Err(cx.refuse(at, what, format!("give at most {MOST_CHARACTERS}")));
    }
    match RichText::parse(&with_any_speeds(&text)) {
        Ok(_) => Ok(text),
        Err(Error::Invalid(problem) | Error::Unsupported(problem)) => {
            Err(cx.refuse(at, problem.what.to_string(), problem.help.to_string()))
        }
        Err(error) => Err(error),
    }
}

/// The number of views side by side.
fn columns(cx: &Context, at: &Option<At<u32>>) -> Result<Option<u32>> {
    match at {
        Some(at) if !(1..=MOST_COLUMNS).contains(&at.value) => {
            let what = format!("{} views cannot stand side by side", at.value);
            Err(cx.refuse(at, what, format!("give 1 to {MOST_COLUMNS}, like 2")))
        }
        at => Ok(at.as_ref().map(|at| at.value)),
    }
}

/// The width of the page, points.
fn width(cx: &Context, at: &Option<At<Length>>) -> Result<Option<f64>> {
    let Some(at) = at else { return Ok(None) };
    let width = cx.positive_length(at, "`width`")? * POINTS;
    if width <= LONGEST_SIDE {
        return Ok(Some(width));
    }
    let what = "no viewer opens a page as wide as this";
    Err(cx.refuse(at, what, "give at most \"5 m\", like \"120 mm\""))
}

/// A size on a page of this width, points.
fn size(cx: &Context, at: &Option<At<Number>>, key: &str, page: f64) -> Result<Option<f64>> {
    let size = positive(cx, at, &format!("`{key}`"))?;
    match at {
        Some(at) if size > Some(page) => {
            let what = format!("`{key}` is in points, and the page is {page:.0} points wide");
            Err(cx.refuse(
                at,
                what,
                "give a few points, or a greater `width` of the page",
            ))
        }
        _ => Ok(size),
    }
}

pub(super) fn style(cx: &Context, style: &file::DiagramStyle) -> Result<Style> {
    let default = Style::default();
    let width = width(cx, &style.width)?;
    let page = width.unwrap_or(WIDTH);
    Ok(Style {
        dark: matches!(style.theme, Some(file::Theme::Dark)),
        width,
        columns: columns(cx, &style.columns)?,
        height: None,
        font_size: size(cx, &style.font_size, "font_size", page)?.unwrap_or(default.font_size),
        line_width: size(cx, &style.line_width, "line_width", page)?.unwrap_or(default.line_width),
        legend: style.legend.unwrap_or(default.legend),
        ticks: style.ticks.unwrap_or(default.ticks),
        grid: style.grid.unwrap_or(default.grid),
    })
}
