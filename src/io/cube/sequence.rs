//! Numbered pictures as cubes: a frame per time bin, or, from streak cameras, a picture per row.
//!
//! A sequence is named by its folder, if that contains only one, or by a pattern for the names of its files with a placeholder for the
//! number: `{i:03d}` as in Python, `%04d` as in C, or `####`. Files are read in the order of their numbers, whatever their leading zeros;
//! none may be missing between the first and the last. If a file has exactly that name, it is meant, not a pattern.
//!
//! A single picture, or a folder of one, may be steady: its axes are then "H W", the default for a single picture. A TIFF file may hold
//! many pictures, a stack: with a time axis these are the pictures of the sequence.
//!
//! Axes are named for (files, rows, columns) of the pictures, by default "T H W"; colours follow. Streaks are "H W T": a file per row of
//! the camera, in it a row per column of the camera, time along x. PNG codes become linear by the transfer that the caller declares; EXR
//! and Radiance HDR are linear.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::axes::{Arrangement, Axes};
use super::channels::CubeChannel;
use super::format::{ByPath, CubeFormat, Parts, Recognition};
use super::layout::StoredLayout;
use super::number::Number;
use super::picture::{Form, Frame, Picture, extension, file_name, frame_count};
use super::samples::{Cube, CubeSamples};
use super::wanted::{CubeInfo, Transfer, Wanted};
use crate::error::{Error, Result};
use crate::io::budget::Budget;
use crate::io::image::panorama;
use crate::io::npy::Dtype;
use crate::io::temporary;

/// Extensions of pictures that frames may be, lower case.
const PICTURES: [&str; 5] = ["exr", "png", "hdr", "tif", "tiff"];

/// The largest number of pictures.
const MOST: usize = 1 << 20;

/// The largest number of pictures decoded at a time; fewer if memory is short.
const TOGETHER: usize = 16;

/// How to name a sequence.
const NAME_IT: &str = "name a folder of pictures with numbered names, or a pattern like \"frames/{i:03d}.exr\" or \
                       \"streak_%04d.hdr\"";

/// Numbered pictures, or a single one.
pub(super) const FORMAT: CubeFormat = CubeFormat {
    name: "sequence of pictures",
    key: "pictures",
    extensions: &[],
    named: false,
    pictures: true,
    recognition: Recognition::ByPath(ByPath {
        is: is_sequence,
        called: "numbered pictures (a folder of them, or a pattern for their names)",
        folder_of: "numbered pictures",
        help: "name a folder of numbered pictures (.exr, .png, .hdr, .tif), or a pattern like \"frames/{i:03d}.exr\"",
    }),
    files: pictures,
    inspect: |input, wanted| inspect(input.path, wanted),
    load: |input, wanted| load(input.path, wanted),
    arrays: |_| Ok(Vec::new()),
    times: |_, _| Ok(None),
    wall: |_, _| Ok(None),
    parts: Parts::WrittenOut(|input, wanted, to| write_out(input.path, wanted, to)),
};

/// Whether `path` names pictures rather than an array, provided it is not a folder of another format.
fn is_sequence(path: &Path) -> bool {
    Pattern::of(path).is_some() || is_picture(path) || path.is_dir()
}

/// Whether `path` names a single picture, which is steady unless its axes include time.
pub fn is_picture(path: &Path) -> bool {
    PICTURES.contains(&extension(path).as_str()) && Pattern::of(path).is_none() && !path.is_dir()
}

/// The pictures of a sequence, in the order of their numbers.
///
/// # Errors
/// There is no such folder, or no such picture in it; it contains several sequences; a number is missing or repeated.
fn pictures(path: &Path) -> Result<Vec<PathBuf>> {
    if is_picture(path) {
        let there = fs::metadata(path).map(|_| vec![path.to_path_buf()]);
        return there.map_err(Error::io(path, "cannot read"));
    }
    let mut numbered = match Pattern::of(path) {
        Some(pattern) => pattern.find(path)?,
        None => in_folder(path)?,
    };
    numbered.sort();
    if let Some(pair) = numbered.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let [first, second] = [&pair[0].1, &pair[1].1].map(|file| file.display().to_string());
        let what = format!("{first} and {second} have the same number");
        return Err(Error::invalid(path, "", what, "remove one of them"));
    }
    let missing = missing(&numbered);
    if !missing.is_empty() {
        let what = format!("pictures are missing between the first and the last: {missing}");
        let help = "add these files; a frame without light is a black picture";
        return Err(Error::invalid(path, "", what, help));
    }
    Ok(numbered.into_iter().map(|(_, file)| file).collect())
}

/// The pictures of a sequence in order: those of its files, or all of a single TIFF stack.
fn frames(path: &Path, wanted: Wanted) -> Result<Vec<Frame>> {
    let files = pictures(path)?;
    if is_picture(path) {
        let count = frame_count(path)?;
        let frame = |number| Frame {
            file: path.to_path_buf(),
            number,
        };
        return match wanted.axes {
            _ if count == 1 => Ok(vec![frame(0)]),
            Some(axes) if axes.has_time() => Ok((0..count).map(frame).collect()),
            _ => Err(Error::invalid(
                path,
                "",
                format!("it holds {count} pictures of one size"),
                "if these are the frames of a cube, say axes = \"T H W\"; for a steady picture, save one of them",
            )),
        };
    }
    let single = |file: PathBuf| match frame_count(&file)? {
        1 => Ok(Frame { file, number: 0 }),
        count => Err(Error::invalid(
            &file,
            "",
            format!("it holds {count} pictures, and is one of a sequence"),
            "name this file alone, with axes = \"T H W\", or save each picture in a file of its own",
        )),
    };
    files.into_iter().map(single).collect()
}

/// The first few missing numbers, and how many there are.
fn missing(numbered: &[(u64, PathBuf)]) -> String {
    const SHOWN: usize = 10;
    let mut shown = Vec::new();
    let mut count = 0;
    for pair in numbered.windows(2) {
        let gap = pair[0].0 + 1..pair[1].0;
        count += gap.end - gap.start;
        let room = SHOWN - shown.len();
        shown.extend(gap.take(room).map(|number| number.to_string()));
    }
    match count.saturating_sub(shown.len() as u64) {
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}

/// The parts of file names before and after the number.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Pattern {
    before: String,
    after: String,
}

impl Pattern {
    /// The pattern of a name with a placeholder; `None` if a file has exactly this name.
    fn of(path: &Path) -> Option<Pattern> {
        let name = path.file_name()?.to_str()?;
        let (start, end) = braces(name)
            .or_else(|| printf(name))
            .or_else(|| hashes(name))?;
        if path.is_file() {
            return None;
        }
        Some(Pattern {
            before: name[..start].into(),
            after: name[end..].into(),
        })
    }

    /// The number in a name of this pattern.
    fn number(&self, name: &str) -> Option<u64> {
        let digits = name.strip_prefix(&self.before)?.strip_suffix(&self.after)?;
        number(digits)
    }

    /// The files of this pattern.
    fn find(&self, path: &Path) -> Result<Vec<(u64, PathBuf)>> {
        let folder = path
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty());
        let numbered: Vec<_> = names(folder.unwrap_or(Path::new(".")), path)?
            .into_iter()
            .filter_map(|(name, file)| Some((self.number(&name)?, file)))
            .collect();
        if numbered.is_empty() {
            let what = format!("there is no file {}number{}", self.before, self.after);
            return Err(Error::invalid(path, "", what, NAME_IT));
        }
        Ok(numbered)
    }
}

/// `{i:03d}`, `{:d}`, `{i}`, `{}`: where it begins and ends.
fn braces(name: &str) -> Option<(usize, usize)> {
    let start = name.find('{')?;
    let end = start + name[start..].find('}')? + 1;
    let (variable, format) = name[start + 1..end - 1]
        .split_once(':')
        .unwrap_or((&name[start + 1..end - 1], "d"));
    let is_variable = variable
        .chars()
        .all(|c| c.is_ascii_alphanumeric() || c == '_');
    let is_integer = format
        .strip_suffix('d')
        .is_some_and(|width| width.chars().all(|c| c.is_ascii_digit()));
    (is_variable && is_integer).then_some((start, end))
}

/// `%04d`, `%d`.
fn printf(name: &str) -> Option<(usize, usize)> {
    let start = name.find('%')?;
    let width = name[start + 1..].find(|c: char| !c.is_ascii_digit())?;
    let end = start + 1 + width;
    name[end..].starts_with('d').then_some((start, end + 1))
}

/// `####`.
fn hashes(name: &str) -> Option<(usize, usize)> {
    let start = name.find('#')?;
    let length = name[start..].find(|c| c != '#')?;
    Some((start, start + length))
}

/// Digits only, few enough for a u64.
fn number(digits: &str) -> Option<u64> {
    let plain =
        !digits.is_empty() && digits.len() <= 18 && digits.bytes().all(|b| b.is_ascii_digit());
    plain.then(|| digits.parse().ok()).flatten()
}

/// Names and paths of what is in `folder`; `path` is for messages.
fn names(folder: &Path, path: &Path) -> Result<Vec<(String, PathBuf)>> {
    let failed = || Error::io(path, "cannot read the folder of");
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed())? {
        let entry = entry.map_err(failed())?;
        if let Ok(name) = entry.file_name().into_string() {
            names.push((name, entry.path()));
        }
        if names.len() > MOST {
            let what = format!("there are more than {MOST} files in the folder");
            return Err(Error::unsupported(
                path,
                "",
                what,
                "put the frames into a folder of their own",
            ));
        }
    }
    Ok(names)
}

/// The numbered pictures of a folder, which share one pattern: names whose last digits are the number.
fn in_folder(path: &Path) -> Result<Vec<(u64, PathBuf)>> {
    let mut found: Option<Pattern> = None;
    let mut numbered = Vec::new();
    for (name, file) in names(path, path)? {
        let Some((pattern, number)) = told_apart(&name) else {
            continue;
        };
        match &found {
            Some(found) if *found != pattern => {
                let mut both = [found, &pattern].map(|p| format!("{}#{}", p.before, p.after));
                both.sort();
                let [one, other] = both;
                let what = format!("the folder holds several sequences: {one} and {other}");
                return Err(Error::invalid(path, "", what, NAME_IT));
            }
            _ => found = Some(pattern),
        }
        numbered.push((number, file));
    }
    match numbered.is_empty() {
        true => Err(Error::invalid(
            path,
            "",
            "the folder holds no numbered pictures (.exr, .png, .hdr, .tif)",
            NAME_IT,
        )),
        false => Ok(numbered),
    }
}

/// The pattern of a picture's name, and its number.
fn told_apart(name: &str) -> Option<(Pattern, u64)> {
    let (stem, extension) = name.rsplit_once('.')?;
    if !PICTURES.contains(&extension.to_ascii_lowercase().as_str()) {
        return None;
    }
    let end = stem.rfind(|c: char| c.is_ascii_digit())? + 1;
    let start = stem[..end]
        .rfind(|c: char| !c.is_ascii_digit())
        .map_or(0, |at| {
            at + stem[at..].chars().next().map_or(1, char::len_utf8)
        });
    let pattern = Pattern {
        before: name[..start].into(),
        after: name[end..].into(),
    };
    Some((pattern, number(&stem[start..end])?))
}

/// What would be loaded, from the number of pictures and the first of them.
fn inspect(path: &Path, wanted: Wanted) -> Result<CubeInfo> {
    refuse_array(path, wanted)?;
    let frames = frames(path, wanted)?;
    let first = Form::of(&frames[0], wanted)?;
    let layout = Layout::new(path, &frames, &first, wanted)?;
    let [h, w, t, c] = layout.arrangement.shape;
    Ok(CubeInfo {
        shape: layout.arrangement.shape,
        dtype: Dtype::F32,
        bytes: 4 * (h * w * t * c) as u64,
        axes: layout.axes,
        assumed: wanted.axes.is_none() && !is_picture(path),
        array: None,
        notes: match frames.as_slice() {
            [_] if is_picture(path) => vec!["one picture, which does not change".into()],
            [one] => vec![format!("one picture, {}", file_name(&one.file))],
            all if is_picture(path) => vec![format!("{} pictures in one file", all.len())],
            [first, .., last] => vec![format!(
                "{} pictures, {} to {}",
                frames.len(),
                file_name(&first.file),
                file_name(&last.file)
            )],
            [] => Vec::new(),
        },
        remarks: match wanted.channels {
            Some(_) => Vec::new(),
            None => unread(&frames[0].file).into_iter().collect(),
        },
    })
}

/// Notes infrared and ultraviolet channels of a picture, which are read only if they are named.
fn unread(file: &Path) -> Option<String> {
    let channels = panorama::head(file)?.channels;
    let companions = CubeChannel::COMPANIONS.map(CubeChannel::name);
    let mut found = companions.to_vec();
    found.retain(|name| channels.iter().any(|channel| channel == name));
    (!found.is_empty()).then(|| {
        format!(
            "the pictures have {} beside R, G and B, which is left out unless `channels` names all: R, G, B, {}",
            found.join(" and "),
            found.join(", ")
        )
    })
}

/// Columns, rows and channels of a picture that may be a frame; reading it uses at most `memory` bytes.
///
/// # Errors
/// It cannot be read, or cannot be a frame.
pub fn frame_size(file: &Path, memory: u64) -> Result<[usize; 3]> {
    // Codes have the same size whatever their meaning.
    let wanted = Wanted::default().within(memory);
    let linear = Wanted {
        transfer: Some(Transfer::Linear),
        ..wanted
    };
    let frame = Frame {
        file: file.to_path_buf(),
        number: 0,
    };
    let form =
        Form::of(&frame, wanted).or_else(|error| Form::of(&frame, linear).map_err(|_| error))?;
    let [columns, rows] = form.size;
    Ok([columns, rows, form.channels])
}

/// Loads the cube.
fn load(path: &Path, wanted: Wanted) -> Result<Cube> {
    refuse_array(path, wanted)?;
    let frames = frames(path, wanted)?;
    let first = Form::of(&frames[0], wanted)?;
    let Layout { arrangement, .. } = Layout::new(path, &frames, &first, wanted)?;
    let count: usize = arrangement.shape.iter().product();
    let budget = wanted.budget();
    budget.take((count as u64).saturating_mul(4), path)?;
    let mut samples = Vec::new();
    samples.try_reserve_exact(count).map_err(|_| {
        let what = format!("there is not enough memory for {count} samples");
        Error::unsupported(path, "", what, "fewer or smaller pictures")
    })?;
    samples.resize(count, 0.0f32);
    // Several at a time, and then in order, so that the first broken one is reported.
    // The memory of a picture is returned.
    let left = budget.left();
    let together = (left / first.memory.max(1)).clamp(1, TOGETHER as u64) as usize;
    for (group, chunk) in frames.chunks(together).enumerate() {
        let decode = |frame: &Frame| Picture::read(frame, wanted, &Budget::new(left));
        let decoded: Vec<_> = chunk.par_iter().map(decode).collect();
        for (place, picture) in decoded.into_iter().enumerate() {
            let number = group * together + place;
            let picture = picture?;
            picture.refuse_other_than(&first, &frames[number].file, &frames[0].file)?;
            arrangement.put(
                number * picture.samples.len(),
                &picture.samples,
                &mut samples,
            );
        }
    }
    Ok(Cube {
        shape: arrangement.shape,
        samples: CubeSamples::F32(samples),
    })
}

/// Writes the samples of all pictures to `to`, in single precision, one picture after the other.
fn write_out(path: &Path, wanted: Wanted, to: &mut dyn Write) -> Result<StoredLayout> {
    refuse_array(path, wanted)?;
    let frames = frames(path, wanted)?;
    let first = Form::of(&frames[0], wanted)?;
    let Layout { axes, sizes, .. } = Layout::new(path, &frames, &first, wanted)?;
    for frame in &frames {
        let picture = Picture::read(frame, wanted, &wanted.budget())?;
        picture.refuse_other_than(&first, &frame.file, &frames[0].file)?;
        for sample in &picture.samples {
            let failed = temporary::in_directory("cannot write a file");
            to.write_all(&sample.to_le_bytes()).map_err(failed)?;
        }
    }
    Ok(StoredLayout {
        start: 0,
        number: Number::F32,
        big_endian: false,
        sizes,
        axes,
    })
}

fn refuse_array(path: &Path, wanted: Wanted) -> Result<()> {
    match wanted.array {
        Some(array) => Err(Error::invalid(
            path,
            format!("array {array:?}"),
            "pictures have no arrays with names",
            "leave out the name of the array",
        )),
        None => Ok(()),
    }
}

/// How pictures form a cube.
struct Layout {
    arrangement: Arrangement,
    axes: Axes,
    /// Sizes of the stored array.
    sizes: Vec<usize>,
}

impl Layout {
    fn new(path: &Path, frames: &[Frame], first: &Form, wanted: Wanted) -> Result<Layout> {
        let help = "name the axes of (files, rows, columns): \"T H W\" for frames, \"H W T\" for streaks, \"H W\" for a single steady picture";
        let axes = match wanted.axes {
            Some(axes) => axes.clone(),
            None if is_picture(path) => Axes::of_picture(),
            None => Axes::of_frames(),
        };
        // Without a time axis it is a single picture.
        let is_steady = frames.len() == 1 && !axes.has_time();
        let axes = axes.with_channels();
        let mut sizes = vec![frames.len(), first.size[1], first.size[0], first.channels];
        if is_steady {
            sizes.remove(0);
        }
        let product = sizes
            .iter()
            .try_fold(1usize, |product, n| product.checked_mul(*n));
        if product.is_none_or(|count| count > isize::MAX as usize / 8) {
            let what = "the pictures have more samples than memory can address";
            return Err(Error::unsupported(
                path,
                "",
                what,
                "fewer or smaller pictures",
            ));
        }
        let arrangement = Arrangement::of(&sizes, &axes, false).map_err(|what| {
            Error::invalid(
                path,
                "",
                format!(
                    "as ({}rows, columns, colours): {what}",
                    if is_steady { "" } else { "files, " }
                ),
                help,
            )
        })?;
        Ok(Layout {
            arrangement,
            axes,
            sizes,
        })
    }
}

#[cfg(test)]
mod tests;
