//! Error messages: what is wrong, labelled in the text, named by its key, with what would be right.

use std::ops::Range;

use serde::de::DeserializeOwned;
use serde_json::Value;

use super::file;
use super::overrides::Edit;
use super::place::{Place, Step, place_of};
use super::schema;
use super::suggest::did_you_mean;
use super::text::Text;
use super::tree;
use crate::error::{Error, Message, Problem, Result, Setting};

/// The text of a scene, and which parts of it overrides set.
pub(crate) struct Report {
    /// The scene's name.
    pub name: String,
    /// The text.
    pub text: Text,
    /// What overrides changed in it.
    pub edits: Vec<Edit>,
}

impl Report {
    /// Parses the text into the file's structure.
    pub(super) fn read<D: DeserializeOwned>(&self) -> Result<file::Scene<D>> {
        tree::read(&self.text.edited).map_err(|error| {
            let span = error.span.unwrap_or(0..0);
            let place = place_of(&self.text.edited, &span);
            // A syntax error has no key, because there is no tree yet.
            if place == Place::default() && toml_edit::Document::parse(&*self.text.edited).is_err()
            {
                return self.not_toml(span, &error.message);
            }
            let (what, help) = explain(&schema::schema(), &error.message, &place);
            self.refuse_at(&place, &[(&span, "here")], what, help)
        })
    }

    /// The error for the text at `span`.
    pub fn refuse(
        &self,
        span: &Range<usize>,
        what: impl Into<Message>,
        help: impl Into<Message>,
    ) -> Error {
        self.refuse_at(
            &place_of(&self.text.edited, span),
            &[(span, "here")],
            what,
            help,
        )
    }

    /// The error for the text at `span`, which conflicts with that at `other`.
    pub fn refuse_two(
        &self,
        span: &Range<usize>,
        (other, label): (&Range<usize>, &str),
        what: impl Into<Message>,
        help: impl Into<Message>,
    ) -> Error {
        let place = place_of(&self.text.edited, span);
        let mut error = self.refuse_at(&place, &[(span, "here"), (other, label)], what, help);
        let edit = self.edit_within(&place_of(&self.text.edited, other));
        if let Error::Invalid(problem) = &mut error {
            cite(&mut problem.help, edit);
        }
        error
    }

    /// The error for a text without the key `key` at its root.
    pub fn missing(&self, key: &str) -> Error {
        let (what, help) = explain(
            &schema::schema(),
            &format!("missing field `{key}`"),
            &Place::default(),
        );
        self.refuse_at(&Place::default(), &[(&(0..0), "here")], what, help)
    }

    fn refuse_at(
        &self,
        place: &Place,
        labels: &[(&Range<usize>, &str)],
        what: impl Into<Message>,
        help: impl Into<Message>,
    ) -> Error {
        let mut help = help.into();
        cite(&mut help, self.edit_within(place));
        let problem = Problem::new(&self.name, place.to_string(), what, help);
        let labels = labels
            .iter()
            .map(|(span, label)| ((*span).clone(), label.to_string()));
        self.text.show(problem, labels.collect()).invalid()
    }

    /// The edit that set the value at `place`.
    fn edit_within(&self, place: &Place) -> Option<&Edit> {
        // Of several edits the last one counts.
        let mut edits = self.edits.iter().rev();
        edits.find(|edit| place.is_within(&edit.place))
    }

    fn not_toml(&self, span: Range<usize>, message: &str) -> Error {
        let span = self.visible(span);
        let before = self.text.edited.get(..span.start).unwrap_or_default();
        let line = before.matches('\n').count() + 1;
        let what = format!("not TOML: {}", printable(message));
        let help =
            "a scene is a TOML file: `key = value` lines under [table] headers, texts in quotes";
        let problem = Problem::new(&self.name, format!("line {line}"), what, help);
        self.text
            .show(problem, vec![(span, "here".into())])
            .invalid()
    }

    /// The span, or the last character of the text if the span is beyond it.
    fn visible(&self, span: Range<usize>) -> Range<usize> {
        let text = self.text.edited.trim_end();
        match text.char_indices().next_back() {
            Some((last, _)) if span.start >= text.len() => last..text.len(),
            _ => span,
        }
    }
}

/// Names the override in the help, once.
fn cite(help: &mut Message, edit: Option<&Edit>) {
    let Some(edit) = edit else { return };
    let cited =
        Message::from("(Set by `") + edit.by.clone() + "` on the " + Setting::Overrides + ".)";
    if !help.contains(&*cited) {
        let space = if help.is_empty() { "" } else { " " };
        *help += space;
        *help += cited;
    }
}

/// The meaning of a message of serde at `place`, and what would be right.
fn explain(schema: &Value, message: &str, place: &Place) -> (String, String) {
    let described = |place: &[Step]| {
        let node = schema::at(schema, place)?;
        Some(format!(
            "`{}`: {}",
            last_key(place)?,
            schema::description(node)?
        ))
    };
    // serde has no kinds of errors, only messages: they are distinguished by how they begin.
    if message.starts_with("unknown field") {
        return unknown_key(schema, place);
    }
    if let Some(key) = ticked(message, "missing field ") {
        let mut missing = place.0.clone();
        missing.push(Step::Key(key.to_string()));
        let what = format!("the key `{key}` is missing");
        return (what, described(&missing).unwrap_or_default());
    }
    if let Some(word) = ticked(message, "unknown variant ") {
        let known = message
            .split_once("expected")
            .map_or("", |(_, known)| known);
        let words: Vec<&str> = known.split('`').skip(1).step_by(2).collect();
        let what = format!("{} is not one of {}", printable(word), words.join(", "));
        let meant = did_you_mean(word, words.iter().copied(), |word| format!("\"{word}\""));
        let help = meant + &described(&place.0).unwrap_or_default();
        return (what, help);
    }
    // serde names whole numbers by their types in Rust. Most keys have narrower ranges, which their descriptions name.
    let refused = ["u32", "usize"].into_iter().find_map(|name| {
        let found = message.strip_suffix(name)?.strip_suffix(", expected ")?;
        let found = found.split_once(": ")?.1.replace('`', "");
        let found = found
            .trim_start_matches("integer ")
            .trim_start_matches("floating point ");
        Some(match found.parse::<f64>() {
            Ok(number) if number > f64::from(u32::MAX) && number.fract() == 0.0 => {
                format!("{found} is too large")
            }
            Ok(_) | Err(_) => format!("{found} is not a whole number, 0 or above"),
        })
    });
    let message = refused.as_deref().unwrap_or(message);
    // The description of the key itself, or of the nearest enclosing table that has one.
    let help = (0..place.0.len())
        .rev()
        .find_map(|n| described(place.0.get(..=n)?));
    (printable(message), help.unwrap_or_default())
}

fn unknown_key(schema: &Value, place: &Place) -> (String, String) {
    let parent = Place(place.parent().to_vec());
    let node = schema::at(schema, &parent.0);
    let keys = node.map_or_else(Vec::new, |node| schema::keys(schema, node));
    let key = last_key(&place.0).unwrap_or_default();
    let meant = did_you_mean(key, keys.iter().copied(), |key| format!("`{key}`"));
    let what = format!("unknown key `{}`", printable(key));
    let (table, keys) = (parent.to_string(), keys.join(", "));
    let table = if table.is_empty() {
        "a scene".into()
    } else {
        format!("`{table}`")
    };
    let help = format!("{meant}the keys of {table} are: {keys}");
    match place.0.as_slice() {
        [Step::Key(list), Step::Index(_), Step::Key(key)]
            if list == "object" && MOTIONS.contains(&key.as_str()) =>
        {
            (what, format!("{UNIFORM}; {help}"))
        }
        _ => (what, help),
    }
}

/// Keys for the motion of cameras and lamps, and the message for an object that has one of them.
const MOTIONS: [&str; 4] = ["motion", "world_line", "keyframes", "acceleration"];
const UNIFORM: &str = "objects move uniformly (`velocity`, and `origin` for where they are and when), so that rays can be intersected with them in their rest frame; world lines of any kind are for [camera] and [[light]]";

fn last_key(place: &[Step]) -> Option<&str> {
    match place.last()? {
        Step::Key(key) => Some(key),
        Step::Index(_) => None,
    }
}

/// The name in backticks after `prefix`.
fn ticked<'m>(message: &'m str, prefix: &str) -> Option<&'m str> {
    let rest = message.strip_prefix(prefix)?.strip_prefix('`')?;
    rest.split_once('`').map(|(name, _)| name)
}

/// A message without control characters, of bounded length.
fn printable(message: &str) -> String {
    let mut short: String = message.chars().take(300).collect();
    if short.len() < message.len() {
        short.push('…');
    }
    let plain = |c: char| if c.is_control() { ' ' } else { c };
    short.chars().map(plain).collect()
}
