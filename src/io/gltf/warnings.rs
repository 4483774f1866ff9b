//! Ignored features of a file, reported once per kind, with the first place.

use std::borrow::Cow;
use std::collections::HashMap;

/// Collects warnings.
#[derive(Debug, Default)]
pub(super) struct Warnings {
    /// In the order of their first places.
    entries: Vec<Entry>,
    /// The index of each in `entries`.
    places: HashMap<Cow<'static, str>, usize>,
}

#[derive(Debug)]
struct Entry {
    what: Cow<'static, str>,
    first: String,
    count: u64,
}

impl Warnings {
    /// Records that `what` occurs at `place`.
    pub fn add(&mut self, what: impl Into<Cow<'static, str>>, place: &str) {
        self.add_many(what, place, 1);
    }

    /// Records that `what` occurs `count` times, first at `place`.
    pub fn add_many(&mut self, what: impl Into<Cow<'static, str>>, place: &str, count: u64) {
        let what = what.into();
        match self.places.get(&what) {
            _ if count == 0 => {}
            Some(&at) => self.entries[at].count += count,
            None => {
                self.places.insert(what.clone(), self.entries.len());
                self.entries.push(Entry {
                    what,
                    first: place.to_owned(),
                    count,
                });
            }
        }
    }

    /// Whether `what` was recorded.
    pub fn has(&self, what: &str) -> bool {
        self.places.contains_key(what)
    }

    /// One sentence per kind.
    pub fn into_sentences(self) -> Vec<String> {
        let sentence = |entry: Entry| match entry.count {
            1 => format!("{}: {}", entry.first, entry.what),
            n => format!("{}: {} ({n} times in all)", entry.first, entry.what),
        };
        self.entries.into_iter().map(sentence).collect()
    }
}
