//! From a byte range of the text to the key that stands there: `object[1].velocity.beta`.

use std::fmt;
use std::ops::Range;

use toml_edit::{Document, Item, TableLike, Value};

/// A step from a table or array to a value in it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Step {
    Key(String),
    Index(usize),
}

/// A path of keys and indices from the root of the document.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Place(pub Vec<Step>);

impl Place {
    /// Whether this place is `other` or lies within it.
    pub fn is_within(&self, other: &Place) -> bool {
        self.0.starts_with(&other.0)
    }

    /// The place without its last step.
    pub fn parent(&self) -> &[Step] {
        self.0.split_last().map_or(&[], |(_, rest)| rest)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, step) in self.0.iter().enumerate() {
            match step {
                Step::Index(index) => write!(f, "[{index}]")?,
                Step::Key(key) => {
                    let dot = if i > 0 { "." } else { "" };
                    write!(f, "{dot}{}", printable(key))?;
                }
            }
        }
        Ok(())
    }
}

/// A key, shortened, without control characters.
fn printable(key: &str) -> String {
    let short: String = key.chars().take(40).collect();
    short.escape_debug().to_string()
}

/// The innermost key or value of `text` that contains `span`; the root if none does, or if the text is not TOML.
pub(super) fn place_of(text: &str, span: &Range<usize>) -> Place {
    let Ok(document) = Document::parse(text) else {
        return Place::default();
    };
    let mut search = Search {
        target: span,
        path: Vec::new(),
        best: None,
    };
    search.table(document.as_table());
    search.best.map(|(_, place)| place).unwrap_or_default()
}

struct Search<'a> {
    target: &'a Range<usize>,
    path: Vec<Step>,
    /// The smallest span so far that contains the target, and its place.
    best: Option<(usize, Place)>,
}

impl Search<'_> {
    /// Takes the current path if `span` contains the target more closely than any before it.
    fn offer(&mut self, span: Option<Range<usize>>) {
        let Some(span) = span else { return };
        if span.start > self.target.start || span.end < self.target.end {
            return;
        }
        // Of equal spans the last one counts, which is the deepest.
        let closer = |&(len, _): &(usize, Place)| span.len() <= len;
        if self.best.as_ref().is_none_or(closer) {
            self.best = Some((span.len(), Place(self.path.clone())));
        }
    }

    fn within(&mut self, step: Step, visit: impl FnOnce(&mut Self)) {
        self.path.push(step);
        visit(self);
        self.path.pop();
    }

    fn table(&mut self, table: &dyn TableLike) {
        for (name, item) in table.iter() {
            let key = table.key(name).and_then(|key| key.span());
            self.within(Step::Key(name.to_string()), |search| {
                search.offer(key);
                search.item(item);
            });
        }
    }

    fn item(&mut self, item: &Item) {
        match item {
            Item::None => {}
            Item::Value(value) => self.value(value),
            Item::Table(table) => {
                self.offer(table.span());
                self.table(table);
            }
            Item::ArrayOfTables(tables) => {
                for (i, table) in tables.iter().enumerate() {
                    self.within(Step::Index(i), |search| {
                        search.offer(table.span());
                        search.table(table);
                    });
                }
            }
        }
    }

    fn value(&mut self, value: &Value) {
        self.offer(value.span());
        match value {
            Value::Array(array) => {
                for (i, value) in array.iter().enumerate() {
                    self.within(Step::Index(i), |search| search.value(value));
                }
            }
            Value::InlineTable(table) => self.table(table),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\
a = 1
[camera]
eye = [1, 2, 3]
velocity.beta = 0.5
[[object]]
name = 'one'
[[object]]
name = 'two'
transform = { rotate = { axis = [1, 0, 0] } }
[object.velocity]
gamma = 7
";

    fn place(needle: &str) -> String {
        let start = TEXT.find(needle).unwrap();
        place_of(TEXT, &(start..start + needle.len())).to_string()
    }

    #[test]
    fn a_span_is_named_by_its_path() {
        assert_eq!(place("[camera]"), "camera");
        assert_eq!(place("eye"), "camera.eye");
        assert_eq!(place("2, 3"), "camera.eye");
        assert_eq!(place("0.5"), "camera.velocity.beta");
        assert_eq!(place("'two'"), "object[1].name");
        assert_eq!(place("[object.velocity]"), "object[1].velocity");
        assert_eq!(place("7"), "object[1].velocity.gamma");
        assert_eq!(place("axis"), "object[1].transform.rotate.axis");
        assert_eq!(place("[1, 0, 0]"), "object[1].transform.rotate.axis");
    }

    #[test]
    fn an_element_of_an_array_has_its_index() {
        let start = TEXT.find("2, 3").unwrap();
        assert_eq!(
            place_of(TEXT, &(start..start + 1)).to_string(),
            "camera.eye[1]"
        );
    }

    #[test]
    fn a_text_that_is_not_toml_has_no_places() {
        assert_eq!(place_of("a = [", &(0..1)), Place::default());
    }
}
