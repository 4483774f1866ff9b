//! The target of a URI in a glTF file: data in the URI itself (RFC 2397 data URI, base64 of RFC 4648) or a file given by a relative
//! reference (percent-encoded UTF-8 of RFC 3986).

use std::path::{Path, PathBuf};

use crate::spacetime::units::quoted;

/// The target of a URI.
#[derive(Debug, PartialEq)]
pub(super) enum Target {
    /// Data contained in the URI itself.
    Data(Vec<u8>),
    /// A relative path.
    File(PathBuf),
}

/// What is wrong with a URI, and what would be right.
#[derive(Debug, PartialEq)]
pub(super) struct BadUri {
    pub what: String,
    pub help: &'static str,
}

const RELATIVE: &str = "use a path relative to the glTF file, percent-encoded UTF-8, or embed the \
                        data (export as .glb)";

/// Parses `uri`; nothing is read.
pub(super) fn parse(uri: &str) -> Result<Target, BadUri> {
    if let Some(data) = uri.strip_prefix("data:") {
        return data_uri(data).map(Target::Data);
    }
    let path = percent_decoded(uri)?;
    let bad = |what: String| {
        Err(BadUri {
            what,
            help: RELATIVE,
        })
    };
    let scheme = path
        .split('/')
        .next()
        .is_some_and(|first| first.contains(':'));
    match () {
        _ if path.is_empty() => bad("the URI is empty".into()),
        _ if scheme => bad(format!("the URI {} is not relative", quoted(uri))),
        _ if Path::new(&path).has_root() => bad(format!("the path {} is absolute", quoted(uri))),
        _ => Ok(Target::File(PathBuf::from(path))),
    }
}

fn percent_decoded(uri: &str) -> Result<String, BadUri> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.bytes();
    while let Some(byte) = rest.next() {
        let byte = match byte {
            b'%' => hex(rest.next())
                .zip(hex(rest.next()))
                .map(|(h, l)| h << 4 | l),
            byte => Some(byte),
        };
        bytes.push(byte.ok_or_else(|| BadUri {
            what: format!(
                "the URI {} has a % without two hexadecimal digits",
                quoted(uri)
            ),
            help: RELATIVE,
        })?);
    }
    String::from_utf8(bytes).map_err(|_| BadUri {
        what: format!("the URI {} is not percent-encoded UTF-8", quoted(uri)),
        help: RELATIVE,
    })
}

fn hex(digit: Option<u8>) -> Option<u8> {
    let value = char::from(digit?).to_digit(16)?;
    u8::try_from(value).ok()
}

/// The data of `[media type];base64,data`.
fn data_uri(text: &str) -> Result<Vec<u8>, BadUri> {
    let help = "write data:application/octet-stream;base64, and the data in base64, or a .bin file";
    let (kind, data) = text.split_once(',').ok_or_else(|| BadUri {
        what: "the data URI has no comma before its data".into(),
        help,
    })?;
    if !kind.ends_with(";base64") {
        let what = format!("the data URI of type {} is not in base64", quoted(kind));
        return Err(BadUri { what, help });
    }
    base64(data).ok_or_else(|| BadUri {
        what: "the data URI is not valid base64".into(),
        help,
    })
}

/// Decodes base64, with or without padding at the end.
fn base64(text: &str) -> Option<Vec<u8>> {
    let padding = text.bytes().rev().take_while(|&c| c == b'=').count();
    let digits = text.as_bytes().get(..text.len() - padding)?;
    // Two or three digits may be left at the end, one cannot.
    if padding > 2 || digits.len() % 4 == 1 || padding > 0 && !text.len().is_multiple_of(4) {
        return None;
    }
    let mut bytes = Vec::with_capacity(digits.len() / 4 * 3 + 2);
    for group in digits.chunks(4) {
        let mut bits = 0_u32;
        for at in 0..4 {
            let digit = group.get(at).map_or(Some(0), |&c| base64_digit(c))?;
            bits = bits << 6 | u32::from(digit);
        }
        let [_, decoded @ ..] = bits.to_be_bytes();
        bytes.extend(decoded.iter().take(group.len() - 1));
    }
    Some(bytes)
}

fn base64_digit(c: u8) -> Option<u8> {
    match c {
        b'A'..=b'Z' => Some(c - b'A'),
        b'a'..=b'z' => Some(c - b'a' + 26),
        b'0'..=b'9' => Some(c - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_decodes_the_vectors_of_rfc_4648() {
        for (text, expected) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYg==", "foob"),
            ("Zm9vYmE=", "fooba"),
            ("Zm9vYmFy", "foobar"),
            ("Zm9vYmE", "fooba"),
        ] {
            assert_eq!(base64(text).as_deref(), Some(expected.as_bytes()), "{text}");
        }
        assert_eq!(base64("+/8="), Some(vec![0xfb, 0xff]));
    }

    #[test]
    fn what_is_no_base64_is_refused() {
        for text in [
            "Z", "Zg=", "Zg===", "====", "Z g=", "Zm9v\n", "Zm=v", "Zm9vY",
        ] {
            assert_eq!(base64(text), None, "{text:?}");
        }
    }

    #[test]
    fn a_relative_path_is_percent_decoded() {
        let path = PathBuf::from("../a b/é.bin");
        assert_eq!(parse("../a%20b/%c3%A9.bin"), Ok(Target::File(path)));
    }

    #[test]
    fn paths_that_are_not_relative_utf_8_are_refused() {
        for uri in [
            "",
            "/etc/passwd",
            "%2fetc/passwd",
            "file:///x",
            "https://x/y.bin",
            "C:/x",
            "%ff.bin",
            "a%2",
            "a%zz",
            "data:",
            "data:;base64",
            "data:text/plain,abc",
        ] {
            assert!(parse(uri).is_err(), "{uri:?}");
        }
    }
}
