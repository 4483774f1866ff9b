//! What commands print: results on standard output, messages on standard error, and no text from a file that would steer a terminal.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::io::{self, ErrorKind, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use nullray::io::npy::Dtype;
use nullray::{Error, Result};
use serde::Serialize;

/// `text` without terminal escapes or characters that change the writing direction; line breaks and tabs are kept. File names, names in
/// files and metadata are untrusted.
pub fn harmless(text: &str) -> Cow<'_, str> {
    let is_harmful = |c: char| c.is_control() && !matches!(c, '\n' | '\t') || is_reordering(c);
    if !text.contains(is_harmful) {
        return text.into();
    }
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match is_harmful(c) {
            true => out.extend(c.escape_default()),
            false => out.push(c),
        }
    }
    out.into()
}

/// `text` with long lines cut.
pub fn with_short_lines(text: &str) -> String {
    const LONGEST: usize = 2000;
    let lines = text.split_inclusive('\n');
    let lines = lines.map(|line| match line.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…\n", &line[..end]),
        None => line.to_string(),
    });
    lines.collect()
}

/// Whether a film goes to standard output.
static CARRIES_FILM: AtomicBool = AtomicBool::new(false);

/// Keeps standard output free for a film: from now on messages are not written, and results that options request go to standard error.
pub fn keep_for_film() {
    CARRIES_FILM.store(true, Ordering::Relaxed);
}

fn carries_film() -> bool {
    CARRIES_FILM.load(Ordering::Relaxed)
}

/// Prints `text` on standard output. A closed pipe ("nullray info … | head") is not an error: the work continues.
pub fn print(text: &str) -> Result<()> {
    if carries_film() {
        complain(text);
        return Ok(());
    }
    write_to(io::stdout().lock(), &harmless(text))
}

/// Prints a styled text on standard output, in colour if that is supported.
pub fn print_styled(text: &str) -> Result<()> {
    write_to(anstream::stdout().lock(), text)
}

fn write_to(mut out: impl Write, text: &str) -> Result<()> {
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Error::io("standard output", "cannot write")(error))
        }
        _ => Ok(()),
    }
}

/// Prints `text` unless `quiet`, or unless a film goes to standard output.
pub fn say(quiet: bool, text: &str) -> Result<()> {
    match quiet || carries_film() {
        true => Ok(()),
        false => print(text),
    }
}

/// Writes warnings to standard error unless `quiet`, each once: a model is loaded to frame it, to expose it, and to render it.
pub fn warn<'a>(quiet: bool, warnings: impl IntoIterator<Item = &'a String>) {
    static TOLD: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    let mut told = TOLD.lock().unwrap_or_else(PoisonError::into_inner);
    let news = |text: &&String| !quiet && told.insert((*text).clone());
    for text in warnings.into_iter().filter(news) {
        complain(&format!("warning: {}\n", escaped(text)));
    }
}

/// The warning about light in numbers too small for their type, if it is more than a hundredth of all.
pub fn faint((part, dtype): (f64, &Dtype), help: &str) -> Option<String> {
    let name = match dtype {
        Dtype::F16 => "f16",
        Dtype::F64 => "f64",
        Dtype::F32 | Dtype::Other(_) => "f32",
    };
    (part > 0.01).then(|| {
        format!(
            "{:.1} % of the light is in numbers below {:.1e}, of which {name} holds few digits or none; {help}",
            100.0 * part,
            dtype.smallest_normal()
        )
    })
}

/// Prints `value` as JSON.
pub fn print_json(value: &impl Serialize) -> Result<()> {
    let help = "leave --json out; numbers that JSON cannot represent are a bug";
    let text = serde_json::to_string_pretty(value);
    let text = text.map_err(|e| Error::invalid("command line", "--json", e.to_string(), help))?;
    print(&(escaped_json(&text) + "\n"))
}

/// A JSON text in whose strings all characters that are not [`harmless`] are escaped by number.
fn escaped_json(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match u32::from(c) {
            // Line breaks are layout: those in strings are already escaped.
            code if code != 10 && (c.is_control() || is_reordering(c)) => {
                out.push_str(&format!("\\u{code:04x}"));
            }
            _ => out.push(c),
        }
    }
    out
}

/// Writes `text` to standard error, if there is one.
pub fn complain(text: &str) {
    complain_styled(&harmless(text));
}

/// Writes a styled text to standard error, in colour if that is supported.
pub fn complain_styled(text: &str) {
    let _ = anstream::stderr().lock().write_all(text.as_bytes());
}

/// `text` without control characters, cut to a bounded length.
pub fn escaped(text: &str) -> String {
    const LONGEST_LINE: usize = 2000;
    let mut out = String::new();
    for (at, c) in text.chars().enumerate() {
        match c {
            _ if at == LONGEST_LINE => return out + "…",
            c if c.is_control() || is_reordering(c) => out.extend(c.escape_default()),
            c => out.push(c),
        }
    }
    out
}

/// Whether the character changes the direction of the text after it, or is invisible.
fn is_reordering(c: char) -> bool {
    matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_is_printed_steers_a_terminal() {
        assert_eq!(harmless("a\tb\nγ = 1 × 2"), "a\tb\nγ = 1 × 2");
        assert_eq!(
            harmless("\u{1b}[2J\u{9b}m\u{202e}\r"),
            "\\u{1b}[2J\\u{9b}m\\u{202e}\\r"
        );
        let value = serde_json::json!({ "name": "\u{9b}\u{202e}\u{7f}\u{1b}é" });
        let text = escaped_json(&serde_json::to_string_pretty(&value).unwrap());
        assert!(!text.contains(|c: char| c.is_control() && c != '\n' || is_reordering(c)));
        assert_eq!(
            serde_json::from_str::<serde_json::Value>(&text).unwrap(),
            value
        );
    }

    #[test]
    fn control_characters_do_not_reach_the_terminal() {
        assert_eq!(escaped("a\x1b[31m\n\u{202e}é"), "a\\u{1b}[31m\\n\\u{202e}é");
    }
}
