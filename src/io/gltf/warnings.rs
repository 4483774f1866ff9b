//! What is passed over in a file, said once per kind, with the first place.

use std::borrow::Cow;

/// Collects warnings.
#[derive(Debug, Default)]
pub(super) struct Warnings(Vec<Entry>);

#[derive(Debug)]
struct Entry {
    what: Cow<'static, str>,
    first: String,
    count: u64,
}

impl Warnings {
    /// Notes that `what` is so at `place`.
    pub fn add(&mut self, what: impl Into<Cow<'static, str>>, place: &str) {
        self.add_many(what, place, 1);
    }

    /// Notes that `what` is so `count` times, first at `place`.
    pub fn add_many(&mut self, what: impl Into<Cow<'static, str>>, place: &str, count: u64) {
        let what = what.into();
        match self.0.iter_mut().find(|entry| entry.what == what) {
            _ if count == 0 => {}
            Some(entry) => entry.count += count,
            None => self.0.push(Entry {
                what,
                first: place.to_owned(),
                count,
            }),
        }
    }

    /// One sentence per kind.
    pub fn into_sentences(self) -> Vec<String> {
        let sentence = |entry: Entry| match entry.count {
            1 => format!("{}: {}", entry.first, entry.what),
            n => format!("{}: {} ({n} times in all)", entry.first, entry.what),
        };
        self.0.into_iter().map(sentence).collect()
    }
}
