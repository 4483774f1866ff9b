//! Spectra in text files: a wavelength in nanometres and a value per line, separated by a comma, a semicolon or blanks.
//!
//! Wavelengths must be ascending. Empty lines, lines that begin with `#`, a first line of column names and a byte order mark are skipped.

use std::io::{BufReader, Read};
use std::path::Path;

use super::open::open_regular;
use crate::error::{Error, Result, number};

/// The maximum number of rows of a table: more than any spectrometer of visible light resolves, and few enough to integrate over.
pub(crate) const MOST_ROWS: usize = 4096;

/// The maximum length of a file, bytes.
const LONGEST: u64 = 1 << 20;

/// The expected form, for messages.
const FORM: &str = "each line holds a wavelength in nm and a value, like 550, 0.82";

/// The rows of the file at `path`: wavelengths in metres, ascending, and values as given.
///
/// # Errors
/// The file cannot be read; a line is not a wavelength above 0 and a finite value of at least 0; wavelengths are not ascending; fewer than
/// 2 rows, or more than 4096.
pub fn load(path: &Path) -> Result<Vec<[f64; 2]>> {
    let (reader, _) = open_regular(path)?;
    let mut bytes = Vec::new();
    let read = BufReader::new(reader)
        .take(LONGEST + 1)
        .read_to_end(&mut bytes);
    read.map_err(Error::io(path, "cannot read"))?;
    if bytes.len() as u64 > LONGEST {
        return Err(refused(
            path,
            None,
            "this file is longer than 1 MiB".into(),
            FORM,
        ));
    }
    parse(&text_of(bytes, path, FORM)?, path)
}

/// The text of a table; `help` describes its lines.
pub(crate) fn text_of(bytes: Vec<u8>, path: &Path, help: &str) -> Result<String> {
    String::from_utf8(bytes).map_err(|error| {
        let before = error.utf8_error().valid_up_to();
        let ends = error.as_bytes()[..before].iter().filter(|b| **b == b'\n');
        let what = "this is not UTF-8 text".into();
        refused(path, Some(ends.count() + 1), what, help)
    })
}

/// The rows of a table with their line numbers: without empty lines, comments, and a first line with column names.
pub(crate) fn rows_of(text: &str) -> impl Iterator<Item = (usize, &str)> {
    // Spreadsheets write a byte order mark first.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let lines = (1..).zip(text.lines().map(str::trim));
    let mut lines = lines
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
        .peekable();
    let is_header = |(_, line): &(usize, &str)| {
        let first = line.split([',', ';', ' ', '\t']).next().unwrap_or_default();
        let is_word = first.starts_with(|c: char| c.is_alphabetic() || c == '"');
        // `nan` and `inf` are numbers, though not valid ones.
        is_word && first.parse::<f64>().is_err()
    };
    lines.next_if(is_header);
    lines
}

/// Like [`load`], from a text; `path` stands for the file in messages.
///
/// # Errors
/// A text that is not such a table, with the line.
pub fn parse(text: &str, path: &Path) -> Result<Vec<[f64; 2]>> {
    let mut rows: Vec<[f64; 2]> = Vec::new();
    for (at, line) in rows_of(text) {
        let refuse = |what: String, help| Err(refused(path, Some(at), what, help));
        if line.contains(';') && line.contains(',') {
            let what = "a comma in a number, with a semicolon between numbers";
            return refuse(what.into(), "write decimals with a point, like 550; 0.82");
        }
        let Some([nanometres, value]) = numbers(line) else {
            return refuse("this is not two numbers".into(), FORM);
        };
        // Bounds far beyond any practical value, but small enough that products stay finite.
        if !(nanometres > 0.0 && nanometres <= 1e30) {
            let what = format!(
                "a wavelength of {} nm is not above 0 and at most 1e30 nm",
                number(nanometres)
            );
            return refuse(what, FORM);
        }
        if !(0.0..=1e30).contains(&value) {
            let what = format!("a value of {} is not from 0 to 1e30", number(value));
            return refuse(what, FORM);
        }
        if let Some([before, _]) = rows.last()
            && nanometres * 1e-9 <= *before
        {
            let what = format!("{nanometres} nm does not come after the wavelength before it");
            return refuse(what, "give the wavelengths in ascending order, each once");
        }
        if rows.len() == MOST_ROWS {
            return refuse(
                format!("more than {MOST_ROWS} rows"),
                "give fewer wavelengths",
            );
        }
        rows.push([nanometres * 1e-9, value]);
    }
    match rows.len() {
        0 | 1 => Err(refused(
            path,
            None,
            "fewer than two rows of numbers".into(),
            FORM,
        )),
        _ => Ok(rows),
    }
}

/// The two numbers of a line.
fn numbers(line: &str) -> Option<[f64; 2]> {
    let mut numbers = line
        .split([',', ';', ' ', '\t'])
        .filter(|part| !part.is_empty())
        .map(|part| part.parse().ok());
    let pair = [numbers.next()??, numbers.next()??];
    numbers.next().is_none().then_some(pair)
}

fn refused(path: &Path, line: Option<usize>, what: String, help: &str) -> Error {
    let place = line.map_or(String::new(), |line| format!("line {line}"));
    Error::invalid(path, place, what, help)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<[f64; 2]>> {
        parse(text, Path::new("lamp.csv"))
    }

    #[test]
    fn rows_are_read_whatever_separates_their_numbers() {
        let rows = read("nm,W\n# measured\n\n400, 1\n500;2.5\n600\t0\n").unwrap();
        let expected = [
            [400.0 * 1e-9, 1.0],
            [500.0 * 1e-9, 2.5],
            [600.0 * 1e-9, 0.0],
        ];
        assert_eq!(rows, expected);
        // As spreadsheets write it, with and without column names, and with these after a comment.
        for text in [
            "\u{feff}400, 1\n500;2.5\n600\t0\n",
            "\u{feff}nm,W\r\n400,1\r\n500,2.5\r\n600,0\r\n",
            "# measured\n\nnm,W\n400,1\n500,2.5\n600,0\n",
        ] {
            assert_eq!(read(text).unwrap(), expected, "{text:?}");
        }
    }

    #[test]
    fn text_of_another_encoding_is_refused_with_its_line() {
        let bytes = b"nm,W\n400,1\n500,\xb5\n".to_vec();
        let error = text_of(bytes, Path::new("lamp.csv"), FORM).unwrap_err();
        let said = "line 3: this is not UTF-8 text";
        assert!(error.to_string().contains(said), "{error}");
    }

    #[test]
    fn what_is_no_spectrum_is_refused_with_its_line() {
        for (text, said) in [
            ("400,1\n300,1", "line 2: 300 nm does not come after"),
            ("400,1\n400,1", "line 2"),
            ("400,-1\n500,1", "line 1: a value of -1"),
            ("400,NaN\n500,1", "a value of NaN"),
            ("nan,1\n500,1\n600,1", "line 1: a wavelength of NaN nm"),
            ("nm,W\nnm,W\n500,1", "line 2: this is not two numbers"),
            ("400,1\n500,inf", "line 2: a value of inf"),
            ("0,1\n500,1", "a wavelength of 0 nm"),
            ("400,1\n500", "line 2: this is not two numbers"),
            ("400,1\nfive,1", "line 2: this is not two numbers"),
            ("400,1,2\n", "line 1: this is not two numbers"),
            ("400;1,5\n500;2", "line 1: a comma in a number"),
            ("400;\t1\n500,;2", "line 2: a comma in a number"),
            ("400,1\n", "fewer than two rows"),
            ("", "fewer than two rows"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(said), "{text:?}: {message}");
        }
    }
}
