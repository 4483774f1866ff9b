//! Lines of text: lettered, broken at spaces, one below the other.
//!
//! No line ends within an entry like "β = 0.866" or "0.866 c": signs of operations and relations stay with both their sides, and units with
//! their numbers.

use crate::error::Result;
use crate::text::RichText;

/// From one baseline to the next, as a multiple of the size of the type.
pub(super) const LEADING: f64 = 1.3;
/// From the top of a line of text to its baseline, as a multiple of its size.
const ASCENT: f64 = 0.95;

/// A line of text, centred.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TextLine {
    /// The text.
    pub text: String,
    /// The middle of its baseline: x, y.
    pub middle: [f64; 2],
    /// Pixels per em.
    pub size: f64,
    /// Its width.
    pub width: f64,
}

/// A line and its width.
pub(super) type Measured = (String, f64);

/// Lines one below the other, centred, from the top `y` on.
pub(super) fn lines(measured: Vec<Measured>, [x, y]: [f64; 2], size: f64) -> Vec<TextLine> {
    let place = |(number, (text, width)): (usize, Measured)| TextLine {
        text,
        middle: [x, y + (ASCENT + LEADING * number as f64) * size],
        size,
        width,
    };
    measured.into_iter().enumerate().map(place).collect()
}

/// The label of panel `index`, with its letter if there are several panels.
pub(super) fn lettered(index: usize, count: usize, label: &str) -> String {
    if count == 1 {
        return label.to_string();
    }
    format!("({}) {label}", letters(index))
}

/// a, b, …, z, aa, ab, …
fn letters(index: usize) -> String {
    let last = char::from(b'a' + (index % 26) as u8);
    match index / 26 {
        0 => last.to_string(),
        before => letters(before - 1) + &last.to_string(),
    }
}

fn width(text: &str, size: f64) -> Result<f64> {
    RichText::plain(text)?.width(size)
}

pub(super) fn widest_word(text: &str, size: f64) -> Result<f64> {
    let mut widest: f64 = 0.0;
    for word in words(text) {
        widest = widest.max(width(&word, size)?);
    }
    Ok(widest)
}

/// The parts between which lines may be broken.
fn words(text: &str) -> Vec<String> {
    let is_break = |c: char| c.is_whitespace() && c != '\u{a0}';
    let mut words: Vec<String> = Vec::new();
    for next in text.split(is_break).filter(|word| !word.is_empty()) {
        match words.last_mut().filter(|last| belong_together(last, next)) {
            Some(last) => *last += &format!(" {next}"),
            None => words.push(next.to_string()),
        }
    }
    words
}

/// The longest unit, characters: "nm", "deg".
const UNIT: usize = 3;

/// Whether a line must not end between these words.
fn belong_together(before: &str, after: &str) -> bool {
    let is_sign = |word: &str| {
        let mut characters = word.chars();
        let first = characters.next();
        first.is_some_and(|c| "=≈<>≤≥+−×·±/".contains(c)) && characters.next().is_none()
    };
    let last = before.rsplit(' ').next().unwrap_or_default();
    let unit = after.trim_end_matches([',', ';', '.', ':', ')']);
    let is_unit = unit.starts_with(|c: char| c.is_alphabetic() || "%°".contains(c))
        && unit.chars().count() <= UNIT;
    let is_number = last.ends_with(|c: char| c.is_ascii_digit());
    is_sign(last) || is_sign(after) || (is_number && is_unit)
}

/// The text in lines of at most `room` pixels, broken at spaces.
pub(super) fn broken(text: &str, size: f64, room: f64) -> Result<Vec<Measured>> {
    let mut lines: Vec<Measured> = Vec::new();
    for word in words(text) {
        if let Some((line, line_width)) = lines.last_mut() {
            let longer = format!("{line} {word}");
            let longer_width = width(&longer, size)?;
            if longer_width <= room {
                (*line, *line_width) = (longer, longer_width);
                continue;
            }
        }
        let word_width = width(&word, size)?;
        lines.push((word, word_width));
    }
    Ok(lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_go_on_after_z() {
        assert_eq!(
            [0, 25, 26, 27, 51, 52].map(letters),
            ["a", "z", "aa", "ab", "az", "ba"]
        );
    }

    #[test]
    fn lines_are_broken_at_spaces_and_fit() {
        let lines = broken("one two  three four", 10.0, 45.0).unwrap();
        assert!(lines.len() > 1);
        assert!(lines.iter().all(|(_, width)| *width <= 45.0), "{lines:?}");
        let words: Vec<_> = lines.iter().map(|(text, _)| text.as_str()).collect();
        assert_eq!(words.join(" "), "one two three four");
        assert!(broken("", 10.0, 45.0).unwrap().is_empty());
    }

    #[test]
    fn numbers_keep_their_units_and_signs_their_sides() {
        assert_eq!(
            words("at 0.866 c, t′ = 12.000 m, β = 0.866, 3 cubes (1 µm) a\u{a0}b"),
            [
                "at",
                "0.866 c,",
                "t′ = 12.000 m,",
                "β = 0.866,",
                "3",
                "cubes",
                "(1 µm)",
                "a\u{a0}b"
            ]
        );
        // Even where there is less room.
        let lines = broken("0.866 c", 10.0, 5.0).unwrap();
        assert_eq!(lines.len(), 1, "{lines:?}");
    }
}
