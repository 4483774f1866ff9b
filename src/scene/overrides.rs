//! Changes to a scene by its caller: edits of the document, made before it is read.
//!
//! A dotted key names what is set: `camera.velocity.beta`, `object.cube.velocity` (by name) or `object.0.velocity` (by number, from 0).
//! Missing tables are created. The value is a TOML value; bare words are taken as text. Spans and error messages then refer to the text
//! after the edits.

use std::str::FromStr;

use toml_edit::{DocumentMut, InlineTable, Item, Key, Table, TableLike, Value};

use super::names;
use super::place::{Place, Step};
use super::suggest::did_you_mean;
use crate::error::{Error, Message, Problem, Result, Setting, number};
use crate::spacetime::units::quoted;

/// Values that replace those of the scene file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Overrides {
    /// Dotted keys and the TOML text of their values; bare words are taken as text.
    pub set: Vec<(String, String)>,
    /// Width and height of the picture, in place of `camera.size`.
    pub size: Option<[u32; 2]>,
    /// In place of `display.exposure` or `display.white`, with its unit: "95 %".
    pub exposure: Option<String>,
    /// In place of `display.white` or `display.exposure`.
    pub white: Option<f64>,
    /// In place of `display.samples_per_pixel`.
    pub samples_per_pixel: Option<u32>,
    /// The camera's proper time at the shot, with its unit, in place of `camera.time`.
    pub time: Option<String>,
    /// The frame in whose coordinates the diagram is drawn, in place of `diagram.view`.
    pub frame: Option<String>,
    /// The frame to which the view of the diagram is boosted, in place of `diagram.animation.boost_to`.
    pub boost_to: Option<String>,
    /// "1+1" or "2+1", in place of `diagram.dimensions`.
    pub dimensions: Option<String>,
    /// Whether glTF files may refer to files outside their own folder and the scene's. Does not change the text.
    pub allow_outside: bool,
}

/// An edit that was made.
pub(crate) struct Edit {
    /// The override and its value.
    pub by: Message,
    /// The place that it changed.
    pub place: Place,
}

/// The keys of `display` of which each sets what is white.
const WHITE_KEYS: [&str; 3] = ["exposure", "white", "logarithmic"];

/// The maximal number of keys in a path: more than any that exists.
const LONGEST_PATH: usize = 16;

/// Makes the edits in `text`. A text that is not TOML is returned unchanged: reading it, with the same parser, reports why.
pub(super) fn apply(text: &str, overrides: &Overrides) -> Result<(String, Vec<Edit>)> {
    let changes = changes(overrides)?;
    if changes.is_empty() {
        return Ok((text.to_string(), Vec::new()));
    }
    let Ok(mut document) = DocumentMut::from_str(text) else {
        return Ok((text.to_string(), Vec::new()));
    };
    let mut edits = Vec::new();
    refuse_rivals(&changes)?;
    let mut kept = Vec::new();
    for change in changes {
        let by = change.by();
        let refuse = |what, help| refuse(change.setting, &change.text, what, help);
        let key = change.key.strip_prefix("display.");
        let white_key = WHITE_KEYS.into_iter().find(|known| key == Some(known));
        let place = set(&mut document, &change.key, change.value, &refuse)?;
        // They replace each other. Two that are both set by --set are refused as in a file.
        if let Some(key) = white_key {
            if change.setting != Setting::Set {
                kept.clear();
            }
            kept.push(key);
            let display = document.get_mut("display");
            if let Some(display) = display.and_then(Item::as_table_like_mut) {
                for other in WHITE_KEYS.iter().filter(|known| !kept.contains(known)) {
                    display.remove(other);
                }
            }
        }
        edits.push(Edit { by, place });
    }
    Ok((document.to_string(), edits))
}

/// Refuses an override of the white point together with a set key for the same, which it would replace.
fn refuse_rivals(changes: &[Change]) -> Result<()> {
    let is_own = |c: &&Change| matches!(c.setting, Setting::Exposure | Setting::White);
    let is_rival = |c: &&Change| {
        // A logarithmic scale is a way of display, which an override replaces.
        let ways = ["exposure", "white"];
        let says_white = match c.key.strip_prefix("display.") {
            Some(key) => ways.contains(&key),
            None => {
                let table = c.value.as_inline_table().filter(|_| c.key == "display");
                table.is_some_and(|table| ways.iter().any(|way| table.contains_key(way)))
            }
        };
        c.setting == Setting::Set && says_white
    };
    match (changes.iter().find(is_own), changes.iter().find(is_rival)) {
        (Some(own), Some(rival)) => {
            let what = own.by() + " says what is white, too";
            let help = "leave one of them out".into();
            Err(refuse(rival.setting, &rival.text, what, help))
        }
        _ => Ok(()),
    }
}

/// A key that is set.
struct Change {
    /// The override.
    setting: Setting,
    /// The value as written there, with its key if it is given.
    text: String,
    key: String,
    value: Value,
}

impl Change {
    fn new(setting: Setting, text: String, key: &str, value: Value) -> Change {
        let key = key.into();
        Change {
            setting,
            text,
            key,
            value,
        }
    }

    fn by(&self) -> Message {
        self.setting + format!(" {}", self.text)
    }
}

fn changes(overrides: &Overrides) -> Result<Vec<Change>> {
    let Overrides {
        set,
        size,
        exposure,
        white,
        samples_per_pixel,
        time,
        frame,
        boost_to,
        dimensions,
        allow_outside: _,
    } = overrides;
    let mut all = Vec::new();
    for (key, text) in set {
        let said = format!("{key}={text}");
        let value = parse_value(text, &said)?;
        all.push(Change::new(Setting::Set, said, key, value));
    }
    let size = size.map(|[w, h]| (format!("{w}x{h}"), Value::from_iter([w, h].map(i64::from))));
    let samples = samples_per_pixel.map(|n| (n.to_string(), Value::from(i64::from(n))));
    let white = white.map(|radiance| (number(radiance).to_string(), Value::from(radiance)));
    let text = |text: &Option<String>| Some((text.clone()?, Value::from(text.clone()?)));
    let others = [
        (Setting::Size, "camera.size", size),
        (
            Setting::SamplesPerPixel,
            "display.samples_per_pixel",
            samples,
        ),
        (Setting::Time, "camera.time", text(time)),
        (Setting::Frame, "diagram.view", text(frame)),
        (
            Setting::BoostTo,
            "diagram.animation.boost_to",
            text(boost_to),
        ),
        (Setting::Dimensions, "diagram.dimensions", text(dimensions)),
        (Setting::Exposure, "display.exposure", text(exposure)),
        (Setting::White, "display.white", white),
    ];
    for (setting, key, given) in others {
        all.extend(given.map(|(said, value)| Change::new(setting, said, key, value)));
    }
    Ok(all)
}

/// The maximal length of an override's value in messages, characters.
const LONGEST_TEXT: usize = 194;

fn refuse(setting: Setting, text: &str, what: impl Into<Message>, help: String) -> Error {
    let short: String = text.chars().take(LONGEST_TEXT).collect();
    let place = Message::from("`") + setting + format!(" {}`", short.escape_debug());
    let mut problem = Problem::new("", place, what, help);
    problem.file = Setting::Overrides.into();
    problem.invalid()
}

fn parse_value(text: &str, said: &str) -> Result<Value> {
    let trimmed = text.trim();
    match Value::from_str(trimmed) {
        Ok(mut value) => {
            value.decor_mut().clear();
            Ok(value)
        }
        Err(error) if trimmed.is_empty() || trimmed.starts_with(['[', '{', '"', '\'']) => {
            let what = format!("{} is not a TOML value: {}", quoted(text), error.message());
            let help = "write a number, a text, [x, y, z], or { key = value }";
            Err(refuse(
                Setting::Set,
                said,
                what.replace('\n', ", "),
                help.into(),
            ))
        }
        Err(_) => Ok(Value::from(trimmed)),
    }
}

/// Sets the dotted `key` of `document`, creating missing tables; returns the place. `refuse` makes the error, from what is wrong and what
/// would be right.
pub(super) fn set(
    document: &mut DocumentMut,
    key: &str,
    value: Value,
    refuse: &dyn Fn(String, String) -> Error,
) -> Result<Place> {
    let path = Key::parse(key).ok();
    let path = path.filter(|path| path.len() <= LONGEST_PATH);
    let path = path.ok_or_else(|| {
        let what = format!("{} is not a dotted key", quoted(key));
        let help = "write keys with dots between, like camera.velocity.beta=[0.5,0,0]; a name with other \
                    characters than letters, digits, - and _ goes in quotes";
        refuse(what, help.into())
    })?;
    let path: Vec<&str> = path.iter().map(Key::get).collect();
    let place = Place::default();
    let mut walk = Walk { refuse, place };
    walk.set_in_table(document.as_table_mut(), &path, value)?;
    Ok(walk.place)
}

/// A walk down the document to the place of a value.
struct Walk<'a> {
    refuse: &'a dyn Fn(String, String) -> Error,
    /// The current place.
    place: Place,
}

impl Walk<'_> {
    /// Sets the key at the end of `path`, creating missing tables.
    fn set_in_table(
        &mut self,
        table: &mut dyn TableLike,
        path: &[&str],
        value: Value,
    ) -> Result<()> {
        let Some((&key, rest)) = path.split_first() else {
            return Err(self.refuse(
                format!("{} is a whole table", self.place),
                "name a key of it",
            ));
        };
        let at_root = self.place == Place::default();
        self.place.0.push(Step::Key(key.to_string()));
        if rest.is_empty() {
            replace(table, key, value);
            return Ok(());
        }
        if table.get(key).is_none_or(Item::is_none) {
            self.refuse_new_entry(key)?;
            table.insert(key, empty_table(at_root));
        }
        match table.get_mut(key) {
            Some(item) => self.set_in_item(item, rest, value),
            None => Ok(()),
        }
    }

    /// `object.x` and `source.x` select an existing entry; they cannot create one.
    fn refuse_new_entry(&self, key: &str) -> Result<()> {
        if self.place.0.len() == 1 && matches!(key, "object" | "source" | "light") {
            let help = format!("add a [[{key}]] table to the scene file");
            return Err(self.refuse(format!("the scene has no {key}"), help));
        }
        Ok(())
    }

    fn set_in_item(&mut self, item: &mut Item, path: &[&str], value: Value) -> Result<()> {
        if let Item::ArrayOfTables(tables) = item {
            let entries: Vec<&dyn TableLike> = tables.iter().map(|t| t as _).collect();
            let (index, rest) = self.choose(&entries, path)?;
            let table = tables.get_mut(index);
            return table.map_or(Ok(()), |table| self.set_in_table(table, rest, value));
        }
        if let Item::Value(Value::Array(array)) = item
            && array.iter().all(Value::is_inline_table)
        {
            let tables = array.iter().filter_map(Value::as_inline_table);
            let entries: Vec<&dyn TableLike> = tables.map(|t| t as _).collect();
            let (index, rest) = self.choose(&entries, path)?;
            let table = array.get_mut(index).and_then(Value::as_inline_table_mut);
            return table.map_or(Ok(()), |table| self.set_in_table(table, rest, value));
        }
        let Some(table) = item.as_table_like_mut() else {
            let what = format!("{} is not a table, and has no keys", self.place);
            let help = format!("set {} itself, or another key", self.place);
            return Err(self.refuse(what, help));
        };
        self.set_in_table(table, path, value)
    }

    /// The entry of an array of tables that the path names, and the rest of the path.
    fn choose<'p>(
        &mut self,
        entries: &[&dyn TableLike],
        path: &'p [&'p str],
    ) -> Result<(usize, &'p [&'p str])> {
        let is_lights = matches!(self.place.0.as_slice(), [Step::Key(key)] if key == "light");
        let named = entries.iter().map(|table| entry_names(*table, is_lights));
        let names = names::unique(named.collect());
        let (word, rest) = path.split_first().map_or(("", path), |(w, r)| (*w, r));
        let by_name = names.iter().position(|name| name == word);
        let by_number = || word.parse().ok().filter(|&n: &usize| n < entries.len());
        let Some(index) = by_name.or_else(by_number) else {
            return Err(self.no_such_entry(word, &names));
        };
        self.place.0.push(Step::Index(index));
        Ok((index, rest))
    }

    fn no_such_entry(&self, word: &str, names: &[String]) -> Error {
        let what = format!("there is no {} {}", self.place, quoted(word));
        let known: Vec<String> = names.iter().take(12).map(|name| quoted(name)).collect();
        let meant = did_you_mean(word, names.iter().map(String::as_str), quoted);
        let known = known.join(", ");
        let help = format!("{meant}there are: {known} (or a number, from 0)");
        self.refuse(what, help)
    }

    fn refuse(&self, what: String, help: impl Into<String>) -> Error {
        (self.refuse)(what, help.into())
    }
}

/// The name of an object, a source or, if `is_lights`, a light in the file, and its default name.
fn entry_names(table: &dyn TableLike, is_lights: bool) -> (Option<String>, String) {
    let text = |key: &str| table.get(key).and_then(Item::as_str);
    let first_key = |item: &Item| {
        let (key, _) = item.as_table_like()?.iter().next()?;
        Some(key.to_string())
    };
    let shape = table.get("shape").and_then(first_key);
    let cube = table.get("cube").and_then(Item::as_table_like);
    let default = if is_lights {
        names::light(text("gltf"), text("node"), text("type").unwrap_or("point"))
    } else if table.contains_key("cube") || table.contains_key("pulse") {
        names::source(cube.and_then(|cube| cube.get("file")?.as_str()))
    } else {
        names::object(text("gltf"), text("node"), shape.as_deref())
    };
    (text("name").map(str::to_string), default)
}

/// A new table: with its own header at the root, inline further down.
fn empty_table(at_root: bool) -> Item {
    if at_root {
        Item::Table(Table::new())
    } else {
        Item::Value(Value::InlineTable(InlineTable::new()))
    }
}

/// Sets a key; a replaced value passes on its position on the line, and the comment after it.
fn replace(table: &mut dyn TableLike, key: &str, mut value: Value) {
    if let Some(Item::Value(old)) = table.get(key) {
        *value.decor_mut() = old.decor().clone();
    }
    table.insert(key, Item::Value(value));
}
