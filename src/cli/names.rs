//! File names for the pictures of one request, by frame number or panel name.

use std::ffi::OsString;
use std::ops::Range;
use std::path::{Path, PathBuf};

use nullray::Result;

use super::builtin;
use super::failure::refused;

/// Digits of a number without a pattern.
const DIGITS: usize = 4;

/// The name of frame `number`. The number replaces the run of # in `path`'s name, padded to its length, or %04d, padded as in C; without
/// such a place it goes before the extension: "name-0007.png".
pub fn numbered(path: &Path, number: u64) -> PathBuf {
    let name = path.file_name().and_then(|name| name.to_str());
    let name = name.unwrap_or_default();
    match places(name).as_slice() {
        [(place, width)] => {
            let (before, after) = (&name[..place.start], &name[place.end..]);
            path.with_file_name(format!("{before}{number:0width$}{after}"))
        }
        _ => suffixed(path, &format!("{number:0DIGITS$}")),
    }
}

/// The places for a number in a name, a run of # or %04d each, and the least number of digits there.
fn places(name: &str) -> Vec<(Range<usize>, usize)> {
    let mut found: Vec<(Range<usize>, usize)> = Vec::new();
    for (start, sign) in name.match_indices(['#', '%']) {
        if found.last().is_some_and(|(place, _)| start < place.end) {
            continue;
        }
        let rest = &name[start..];
        let others = rest.trim_start_matches('#');
        let hashes = rest.len() - others.len();
        if sign == "#" {
            found.push((start..start + hashes, hashes));
        } else if let Some((width, _)) = rest[1..].split_once('d')
            && width.len() <= 2
            && width.bytes().all(|byte| byte.is_ascii_digit())
        {
            let end = start + 2 + width.len();
            found.push((start..end, width.parse().unwrap_or(1)));
        }
    }
    found
}

/// Refuses the name `path`, given by `option`, if it has several places for a number.
pub fn check_places(option: &str, path: &Path) -> Result<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    match places(&name).len() > 1 {
        true => Err(refused(
            format!("{option} {}", path.display()),
            "the name has several places for the number of a frame",
            "leave one run of #",
        )),
        false => Ok(()),
    }
}

/// "name-suffix.png" for "name.png".
pub fn suffixed(path: &Path, suffix: &str) -> PathBuf {
    let mut name = OsString::from(path.file_stem().unwrap_or_default());
    name.push("-");
    name.push(suffix);
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

/// A name made safe for use in a file name: path separators and invisible characters become `_`.
pub fn in_file_name(name: &str) -> String {
    let is_apart = |c: char| std::path::is_separator(c) || c.is_control();
    name.replace(is_apart, "_")
}

/// The name of the scene's file without its extension.
pub fn stem(path: Option<&Path>) -> PathBuf {
    if path.is_some_and(builtin::is_standard_input) {
        return "stdin".into();
    }
    let stem = path.and_then(Path::file_stem);
    stem.unwrap_or("nullray".as_ref()).into()
}

/// A file in the current directory with the scene's name and `ending`.
pub fn named_after(path: Option<&Path>, ending: &str) -> PathBuf {
    // Not `with_extension`, which would take ".9" in "approaching-0.9" for an extension.
    let mut name = stem(path).into_os_string();
    name.push(ending);
    name.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(path: &str, number: u64) -> String {
        numbered(Path::new(path), number).display().to_string()
    }

    #[test]
    fn numbers_stand_before_the_extension_in_four_digits_or_more() {
        assert_eq!(frame("a/name.png", 7), "a/name-0007.png");
        assert_eq!(
            frame("approaching-0.9.exr", 12345),
            "approaching-0.9-12345.exr"
        );
    }

    #[test]
    fn a_run_of_places_takes_the_number() {
        assert_eq!(frame("a#/frame-####.exr", 7), "a#/frame-0007.exr");
        assert_eq!(frame("#.png", 12), "12.png");
        assert_eq!(frame("β###.final.png", 12), "β012.final.png");
        // As in the names of a cube's pictures.
        assert_eq!(frame("a%d/frame-%04d.exr", 7), "a%d/frame-0007.exr");
        assert_eq!(frame("%d.png", 12), "12.png");
        assert_eq!(frame("β%03d.50%.png", 12), "β012.50%.png");
        assert_eq!(frame("50%.png", 12), "50%-0012.png");
        assert_eq!(frame("a%0999d.png", 12), "a%0999d-0012.png");
    }

    #[test]
    fn the_name_of_a_panel_stands_before_the_extension() {
        let path = suffixed(Path::new("out/fig.png"), "beta-0.9");
        assert_eq!(path, Path::new("out/fig-beta-0.9.png"));
    }

    #[test]
    fn the_name_of_an_object_leads_into_no_other_directory() {
        let path = suffixed(Path::new("out/a.npz"), &in_file_name("../up\n/./x"));
        assert_eq!(path, Path::new("out/a-.._up__._x.npz"));
    }
}
