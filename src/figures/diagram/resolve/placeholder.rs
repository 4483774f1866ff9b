//! Keys within text: `{frame.S'.velocity}` is replaced by the value of this key of `[diagram]`, after `--set`.
//!
//! An entry of a list is addressed by its name, or by its number from 0, as in `--set`. Braces of subscripts and superscripts, and those
//! without a dot, group as usual. `{frame.S''.speed}` is the speed in the world that results from the velocities of a frame and of those
//! that it is relative to: their rapidities, artanh β, add.

use std::str::FromStr;

use toml_edit::{DocumentMut, Item, Table, Value};

use crate::error::Result;
use crate::figures::diagram::layout::number;
use crate::figures::text::rich::escaped;
use crate::scene::{At, Context};
use crate::spacetime::units::quoted;

/// The longest chain of frames relative to each other for a speed.
const MOST: u32 = 100;

/// `text`, which comes from `at`, with the values of its keys.
pub(super) fn filled<T>(cx: &Context, at: &At<T>, text: &str) -> Result<String> {
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
                filled.push_str(&value(cx, at, key)?);
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
    let speed = key.strip_suffix(".speed");
    let speed = speed.and_then(|frame| rapidity(&document, frame.strip_prefix("frame.")?, MOST));
    if let Some(rapidity) = speed {
        return Ok(signed(&number(libm::tanh(rapidity))));
    }
    let found = entry(&document, key);
    let value = match &found {
        Some(Node::Item(item)) => item.as_value(),
        Some(Node::Value(value)) => Some(*value),
        Some(Node::Table(_)) | None => None,
    };
    match value {
        Some(Value::Integer(value)) => Ok(signed(&value.value().to_string())),
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

/// The rapidity of a frame in the world; `None` if a velocity is not a number, and after `most` frames.
fn rapidity(document: &DocumentMut, frame: &str, most: u32) -> Option<f64> {
    let key = |key: &str| entry(document, &format!("frame.{frame}.{key}"));
    let beta = match key("velocity")? {
        Node::Item(item) => item.as_float(),
        Node::Value(value) => value.as_float(),
        Node::Table(_) => None,
    };
    let own = libm::atanh(beta?);
    let name = key("relative_to").and_then(|node| match node {
        Node::Item(item) => item.as_str().map(str::to_owned),
        Node::Value(value) => value.as_str().map(str::to_owned),
        Node::Table(_) => None,
    });
    match name.as_deref() {
        None | Some("world") => Some(own),
        Some(other) => Some(own + rapidity(document, other, most.checked_sub(1)?)?),
    }
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
