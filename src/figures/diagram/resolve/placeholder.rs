//! Keys within text: `{frame.S'.velocity}` is replaced by the value of this key of `[diagram]`, after `--set`.
//!
//! An entry of a list is addressed by its name, or by its number from 0, as in `--set`. Braces of subscripts and superscripts, and those
//! without a dot, group as usual. Two keys are not in the file: `{frame.S''.speed}` is the speed of a frame in the world, from 0 to 1, and
//! `{frame.S''.beta}` its component along x, with its sign, however the file gives the frame's motion. They are filled in by
//! [`fill_speeds`] when the frames are known.

use std::str::FromStr;

use toml_edit::{DocumentMut, Item, Table, Value};

use crate::error::Result;
use crate::figures::diagram::layout::{number, speed, speed_with_rest};
use crate::figures::diagram::model::Diagram;
use crate::scene::{At, Context};
use crate::spacetime::units::quoted;
use crate::text::rich::escaped;

/// The frames that exist whether the file has them or not.
const GIVEN: [&str; 2] = ["world", "camera"];

/// `text`, which comes from `at`, with the values of its keys but those of the speeds of frames.
pub(super) fn filled<T>(cx: &Context, at: &At<T>, text: &str) -> Result<String> {
    replaced(text, |key| value(cx, at, key))
}

/// Markup of about the same length without keys of speeds, to check whether `text` can be set.
pub(super) fn with_any_speeds(text: &str) -> String {
    let any = replaced(text, |_| Ok("0.8".into()));
    any.unwrap_or_else(|_| text.into())
}

/// Fills the speeds of frames into all texts of a diagram.
pub(super) fn fill_speeds(diagram: &mut Diagram, frames_of_file: &[&str]) {
    let frames = diagram.frames.clone();
    let direction = diagram.direction;
    let value = |key: &str| {
        let (name, is_speed) = speed_key(key)?;
        let index = frames_of_file.iter().position(|known| *known == name);
        // Before those of the file is the world, and after them the camera.
        let index = index.or_else(|| name.parse().ok()).map(|i| i + 1);
        let named = || frames.iter().position(|frame| frame.name == name);
        let frame = frames.get(index.or_else(named)?)?;
        let rapidity = frame.frame.velocity().rapidity();
        let along = match is_speed {
            true => speed(rapidity.length()),
            // β_x = |β| (w_x/|w|)
            false if rapidity.length() == 0.0 => speed(0.0),
            false => {
                let part = direction.dot(rapidity) / rapidity.length();
                match part.abs() > 1.0 - 1e-12 {
                    true => speed(rapidity.length().copysign(part)),
                    false => number(libm::tanh(rapidity.length()) * part),
                }
            }
        };
        Some(signed(&along))
    };
    each_text(diagram, |text| {
        let filled = replaced(text, |key| {
            Ok(value(key).unwrap_or_else(|| format!("{{{key}}}")))
        });
        if let Ok(filled) = filled {
            *text = filled;
        }
    });
}

/// Changes the title and all labels.
fn each_text(diagram: &mut Diagram, change: impl Fn(&mut String)) {
    let Diagram {
        title,
        labels,
        lines,
        events,
        signals,
        slices,
        intervals,
        hyperbolae,
        curves,
        sheets,
        regions,
        arrows,
        wedges,
        texts,
        ..
    } = diagram;
    let spots = events.iter_mut().chain(texts).map(|it| &mut it.label);
    let segments = signals.iter_mut().chain(arrows);
    let all = spots
        .chain(segments.map(|it| &mut it.label))
        .chain(lines.iter_mut().map(|it| &mut it.label))
        .chain(slices.iter_mut().map(|it| &mut it.label))
        .chain(intervals.iter_mut().map(|it| &mut it.label))
        .chain(hyperbolae.iter_mut().map(|it| &mut it.label))
        .chain(curves.iter_mut().map(|it| &mut it.label))
        .chain(sheets.iter_mut().map(|it| &mut it.label))
        .chain(regions.iter_mut().map(|it| &mut it.label))
        .chain(wedges.iter_mut().map(|it| &mut it.label));
    let all = all.chain([title]).flatten();
    all.chain(labels.iter_mut().flatten()).for_each(change);
}

/// The frame whose speed (or else component of β along x) a key means.
fn speed_key(key: &str) -> Option<(&str, bool)> {
    let rest = key.strip_prefix("frame.")?;
    let speed = rest.strip_suffix(".speed").map(|name| (name, true));
    speed.or_else(|| Some((rest.strip_suffix(".beta")?, false)))
}

/// `text` with its keys replaced.
fn replaced(text: &str, value: impl Fn(&str) -> Result<String>) -> Result<String> {
    let mut filled = String::new();
    let mut rest = text;
    let mut before = None;
    while let Some(c) = rest.chars().next() {
        let key = match (c, before) {
            ('{', Some('_' | '^' | '\\')) => None,
            ('{', _) => key(rest),
            _ => None,
        };
        match key {
            Some(key) => {
                filled.push_str(&value(key)?);
                rest = &rest[key.len() + 2..];
                before = Some('}');
            }
            None => {
                filled.push(c);
                rest = &rest[c.len_utf8()..];
                // A backslash after a backslash is one that escapes nothing.
                before = Some(if before == Some('\\') { ' ' } else { c });
            }
        }
    }
    Ok(filled)
}

/// The key in the braces with which `text` begins.
fn key(text: &str) -> Option<&str> {
    let inner = text.strip_prefix('{')?;
    let key = &inner[..inner.find('}')?];
    let plain = |c: char| !c.is_whitespace() && !['{', '*', '\\', '^'].contains(&c);
    let is_dotted = key.split('.').count() > 1 && key.split('.').all(|part| !part.is_empty());
    (is_dotted && key.chars().all(plain)).then_some(key)
}

/// Markup of the value of `key` in `[diagram]`.
fn value<T>(cx: &Context, at: &At<T>, key: &str) -> Result<String> {
    let document = DocumentMut::from_str(&cx.report.text.edited).unwrap_or_default();
    if let Some((name, _)) = speed_key(key) {
        let is_known =
            GIVEN.contains(&name) || entry(&document, &format!("frame.{name}")).is_some();
        if is_known {
            // The frames are not known yet.
            return Ok(format!("{{{key}}}"));
        }
    }
    let found = entry(&document, key);
    let value = match &found {
        Some(Node::Item(item)) => item.as_value(),
        Some(Node::Value(value)) => Some(*value),
        Some(Node::Table(_)) | None => None,
    };
    match value {
        Some(Value::Integer(value)) => Ok(signed(&value.value().to_string())),
        Some(Value::Float(value)) if key.ends_with(".velocity") => {
            let beta = *value.value();
            Ok(signed(&speed_with_rest(beta, 1.0 - beta.abs())))
        }
        Some(Value::Float(value)) => Ok(signed(&number(*value.value()))),
        Some(Value::String(value)) => Ok(escaped(value.value())),
        _ => {
            let what = match found {
                Some(_) => format!("{} is neither a number nor words", quoted(key)),
                None => format!("[diagram] has no key {}", quoted(key)),
            };
            let help = "name a key of [diagram] with its tables, like {frame.S'.velocity}";
            Err(cx.refuse(at, what, help))
        }
    }
}

fn entry<'d>(document: &'d DocumentMut, key: &str) -> Option<Node<'d>> {
    let mut found = document.get("diagram").map(Node::Item);
    for part in key.split('.') {
        found = found.and_then(|node| node.entry(part));
    }
    found
}

/// With a minus sign instead of a hyphen.
fn signed(number: &str) -> String {
    number.replace('-', "−")
}

/// A part of the file: tables and their lists are written in two ways each.
enum Node<'d> {
    Item(&'d Item),
    Table(&'d Table),
    Value(&'d Value),
}

impl<'d> Node<'d> {
    /// The element of a table, or of a list of them, that a part of a key names.
    fn entry(self, part: &str) -> Option<Node<'d>> {
        match self {
            Node::Item(Item::Table(table)) | Node::Table(table) => table.get(part).map(Node::Item),
            Node::Item(Item::Value(Value::InlineTable(table)))
            | Node::Value(Value::InlineTable(table)) => table.get(part).map(Node::Value),
            Node::Item(Item::ArrayOfTables(list)) => {
                let name = |table: &&Table| table.get("name").and_then(Item::as_str) == Some(part);
                let numbered = || list.get(part.parse().ok()?);
                list.iter().find(name).or_else(numbered).map(Node::Table)
            }
            Node::Item(Item::Value(Value::Array(list))) | Node::Value(Value::Array(list)) => {
                let table = |value: &Value| {
                    value
                        .as_inline_table()?
                        .get("name")?
                        .as_str()
                        .map(str::to_owned)
                };
                let named = |value: &&Value| table(value).as_deref() == Some(part);
                let numbered = || list.get(part.parse().ok()?);
                list.iter().find(named).or_else(numbered).map(Node::Value)
            }
            _ => None,
        }
    }
}
