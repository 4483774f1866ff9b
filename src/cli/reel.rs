//! Films of finished pictures: animated PNG and raw video, to files or to a pipe.
//!
//! The pictures of a film are first numbered PNG files, in a folder beside it, so that stopped work can be resumed, as for sequences. The
//! folder is removed once the film is complete. One left behind by a killed program is removed after a day by the next run that makes a
//! film beside it.

use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind, Stdout, Write};
use std::path::{Path, PathBuf};

use nullray::figures::drawing::png::RgbaImage;
use nullray::io::budget::Budget;
use nullray::io::image::film::{Delay, FilmWriter};
use nullray::io::image::{RgbImage, Samples, png, write_atomically};
use nullray::io::temporary;
use nullray::scene::model::Scene;
use nullray::{Error, Result};
use tempfile::TempDir;

use super::check::{Names, by_ffmpeg, unknown_format};
use super::console::{keep_for_film, say};
use super::failure::refused;
use super::output::{Identity, extension};
use super::{inputs, interrupt, memory};

/// The name of a film that goes to standard output.
const PIPE: &str = "-";

/// Its name in errors.
const STDOUT: &str = "standard output";

/// The format of a film.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Apng,
    Y4m,
}

/// Whether an output of this name is a film.
pub fn is_film(path: &Path) -> bool {
    is_pipe(path) || ["apng", "y4m"].contains(&extension(path).as_str())
}

/// Whether an output of this name is standard output.
pub fn is_pipe(path: &Path) -> bool {
    path.as_os_str() == PIPE
}

/// Keeps standard output free for the film among `outputs` that goes there, if there is one.
pub fn keep_pipe(outputs: &[PathBuf]) {
    if outputs.iter().any(|path| is_pipe(path)) {
        keep_for_film();
    }
}

/// Refuses names that are not films, and outputs that could not be written or would overwrite one of the files `read`.
pub fn check(films: &[PathBuf], read: &[PathBuf]) -> Result<()> {
    let overwritten = "the film is made from this file, which would be overwritten";
    let mut names = Names::new(read, overwritten, " film");
    let mut pipes = 0;
    for path in films {
        let option = format!("-o {}", path.display());
        if !is_film(path) {
            let known = "end it in .apng (animated PNG) or .y4m (raw video), or write - for raw video on standard output";
            let help = known.to_string() + &by_ffmpeg(&extension(path));
            return Err(unknown_format(option, path, "film", &help));
        }
        if !is_pipe(path) {
            names.check(&option, path)?;
            continue;
        }
        pipes += 1;
        if pipes > 1 {
            return Err(refused(
                option,
                "two films go to standard output",
                "give it once",
            ));
        }
    }
    Ok(())
}

/// Says that a film shows fewer bits than `scene` asks for.
pub fn tell_bits(films: &[PathBuf], scene: &Scene, quiet: bool) -> Result<()> {
    match films.first().filter(|_| scene.bits > 8) {
        None => Ok(()),
        Some(film) => {
            let film = film.display();
            let what = format!("{film} has 8 bits per sample: display.bits = 16 is for .png\n");
            say(quiet, &what)
        }
    }
}

/// The end of the name of a film's folder.
const ENDING: &str = ".frames";

/// Whether outputs with this name, films and pages, have such a folder while they are made.
fn has_folder(name: &str) -> bool {
    [".apng", ".y4m", ".html"].iter().any(|e| name.ends_with(e))
}

/// Whether a file in such a folder is a picture of a film: its name is a word and a number of six digits.
fn is_picture(name: &str) -> bool {
    let number = name
        .strip_suffix(".png")
        .and_then(|name| name.split_once('-'));
    number.is_some_and(|(word, number)| {
        PICTURES.contains(&word) && number.len() >= 6 && number.bytes().all(|b| b.is_ascii_digit())
    })
}

/// The words before the numbers of pictures.
const PICTURES: [&str; 3] = ["film", "rest", "page"];

/// The folder of a film's pictures.
pub enum Folder {
    /// Beside the film; work can be resumed from it.
    Beside {
        path: PathBuf,
        /// While it is locked, it is not mistaken for a left-over folder.
        lock: Option<File>,
    },
    /// For a film that cannot be resumed.
    Passing(TempDir),
}

impl Folder {
    /// The folder of the first of `films` that is a file, or a temporary one.
    pub fn of(films: &[PathBuf]) -> Result<Folder> {
        let Some(film) = films.iter().find(|path| !is_pipe(path)) else {
            let failed = "cannot make a folder for the pictures of the film";
            let made = tempfile::tempdir().map_err(temporary::in_directory(failed))?;
            // A reader that takes no more pictures must not keep it when the work is stopped.
            temporary::note(made.path());
            return Ok(Folder::Passing(made));
        };
        let mut name = film.file_name().unwrap_or_default().to_os_string();
        name.push(ENDING);
        let path = film.with_file_name(name);
        fs::create_dir_all(&path).map_err(Error::io(&path, "cannot create the directory"))?;
        let lock = File::open(&path).ok();
        if let Some(folder) = &lock {
            // On file systems without locks, only its age protects it.
            let _ = folder.try_lock_shared();
        }
        let is_folder = |name: &str| name.strip_suffix(ENDING).is_some_and(has_folder);
        temporary::clear_folders(inputs::directory(&path), &path, is_folder, is_picture);
        Ok(Folder::Beside { path, lock })
    }

    /// Whether it stays if the work is stopped.
    pub fn stays(&self) -> bool {
        matches!(self, Folder::Beside { .. })
    }

    /// A name for numbered pictures in it.
    pub fn pattern(&self, name: &str) -> PathBuf {
        let path = match self {
            Folder::Beside { path, .. } => path.as_path(),
            Folder::Passing(folder) => folder.path(),
        };
        path.join(format!("{name}-######.png"))
    }

    /// Removes all pictures, including those of earlier films with this name, and the folder if it is then empty; does nothing while
    /// another program is making the same film.
    pub fn remove(self) {
        // Anything that cannot be removed only takes space.
        if let Folder::Beside { path, lock } = &self {
            let is_alone = |lock: &File| !matches!(lock.try_lock(), Err(TryLockError::WouldBlock));
            if !lock.as_ref().is_none_or(is_alone) {
                return;
            }
            for entry in fs::read_dir(path).into_iter().flatten().flatten() {
                if is_picture(&entry.file_name().to_string_lossy()) {
                    let _ = fs::remove_file(entry.path());
                }
            }
            temporary::clear(path);
        }
    }
}

impl Drop for Folder {
    /// Removes the folder if it is empty; pictures of an unfinished film stay.
    fn drop(&mut self) {
        if let Folder::Beside { path, lock } = self {
            // Some systems cannot remove open directories.
            drop(lock.take());
            let _ = fs::remove_dir(path);
        }
    }
}

/// Reads a picture that was written before, with the fingerprint `expected`.
pub fn read(path: &Path, expected: &str) -> Result<RgbImage> {
    let layers = png::read(path, &Budget::new(memory::limit(None)))?;
    // The text is read before the pixels, and the file may be replaced in between.
    let now = png::inspect(path)?.text;
    let is_own = |(key, value): &(String, String)| key == Identity::KEY && value == expected;
    if ![&layers.metadata, &now]
        .iter()
        .all(|texts| texts.iter().any(is_own))
    {
        return Err(replaced(path));
    }
    let mut rgb = vec![0; 3 * layers.width as usize * layers.height as usize];
    for (index, channel) in layers.channels.iter().take(3).enumerate() {
        if let Samples::F32(codes) = &channel.samples {
            for (pixel, code) in rgb.chunks_exact_mut(3).zip(codes) {
                pixel[index] = (code * 255.0).round() as u8;
            }
        }
    }
    Ok(RgbImage {
        width: layers.width,
        height: layers.height,
        rgb,
    })
}

/// The bytes of such a picture.
pub fn read_bytes(path: &Path, expected: &str) -> Result<Vec<u8>> {
    let bytes = fs::read(path).map_err(Error::io(path, "cannot read"))?;
    let mut parts = bytes.windows(expected.len());
    match parts.any(|part| part == expected.as_bytes()) {
        true => Ok(bytes),
        false => Err(replaced(path)),
    }
}

/// The error for a picture that was written by a run with other options, in the same folder at the same time.
fn replaced(path: &Path) -> Error {
    let what = "another run, with a different scene or other options, has replaced this picture since it was rendered";
    let help =
        "wait for that run to end, or write to a file of another name, and run the command again";
    Error::invalid(path, "", what, help)
}

/// The drawing on a white background.
pub fn opaque(raster: &RgbaImage) -> RgbImage {
    let (pixels, _) = raster.rgba.as_chunks::<4>();
    let over_white = |[r, g, b, alpha]: [u8; 4]| {
        let alpha = u32::from(alpha);
        [r, g, b].map(|c| ((u32::from(c) * alpha + 255 * (255 - alpha) + 127) / 255) as u8)
    };
    RgbImage {
        width: raster.width,
        height: raster.height,
        rgb: pixels.iter().flat_map(|pixel| over_white(*pixel)).collect(),
    }
}

/// The picture with its last column or row repeated if their number is odd: encoders with chroma subsampling need even numbers.
pub fn even(picture: RgbImage) -> RgbImage {
    let [width, height] = [picture.width, picture.height].map(|side| side.next_multiple_of(2));
    let mut rgb = Vec::with_capacity(3 * width as usize * height as usize);
    for row in 0..height {
        let row = row.min(picture.height - 1) as usize;
        let length = 3 * picture.width as usize;
        let pixels = &picture.rgb[row * length..][..length];
        rgb.extend_from_slice(pixels);
        if width > picture.width {
            rgb.extend_from_slice(&pixels[length - 3..]);
        }
    }
    RgbImage { width, height, rgb }
}

/// Calls `write` with the name and the writer of a film: a file, or standard output, where a closed pipe is the end and not an error.
pub fn pipe_or_save(
    path: &Path,
    write: impl FnOnce(&Path, &mut dyn Write) -> Result<()>,
) -> Result<()> {
    if !is_pipe(path) {
        return write_atomically(path, |file| write(path, file));
    }
    unless_closed(write(STDOUT.as_ref(), &mut io::stdout().lock())).map(drop)
}

/// The result of work on a film; `None` if it ended because its reader has closed the pipe ("| head").
pub fn unless_closed<T>(done: Result<T>) -> Result<Option<T>> {
    match done {
        Err(error) if is_closed(&error) => Ok(None),
        done => done.map(Some),
    }
}

fn is_closed(error: &Error) -> bool {
    matches!(error, Error::Io { source, .. } if source.kind() == ErrorKind::BrokenPipe)
}

/// The settings with which films are written.
pub struct Reel<'a> {
    pub films: &'a [PathBuf],
    /// Pictures per film.
    pub count: u64,
    /// Pictures per second.
    pub fps: f64,
    /// Metadata, for formats that can hold them.
    pub metadata: &'a [(String, String)],
    pub quiet: bool,
}

impl Reel<'_> {
    /// The film that goes to standard output, if one does; whether it is the only output.
    pub fn stream(&self, is_alone: bool) -> Stream<'_> {
        Stream {
            reel: self,
            film: None,
            is_open: self.films.iter().any(|film| is_pipe(film)),
            is_alone,
        }
    }

    /// Writes all films that are files, from the pictures that `picture` returns for each number from 0.
    pub fn write(&self, mut picture: impl FnMut(u64) -> Result<RgbImage>) -> Result<()> {
        for film in self.films.iter().filter(|film| !is_pipe(film)) {
            let kind = match extension(film).as_str() {
                "apng" => Kind::Apng,
                _ => Kind::Y4m,
            };
            let mut size = [0; 2];
            write_atomically(film, |out| {
                size = self.film(film, out, kind, &mut picture)?;
                Ok(())
            })?;
            let [width, height] = size;
            let (name, count, fps) = (film.display(), self.count, self.fps);
            let what = format!(
                "wrote {name} ({width} × {height} pixels, {count} pictures, {fps} per second)\n"
            );
            say(self.quiet, &what)?;
        }
        Ok(())
    }

    fn film(
        &self,
        name: &Path,
        out: impl Write,
        kind: Kind,
        picture: &mut impl FnMut(u64) -> Result<RgbImage>,
    ) -> Result<[u32; 2]> {
        let first = picture(0)?;
        let size = [first.width, first.height];
        let (count, delay) = (self.pictures(), Delay::of_rate(self.fps)?);
        let mut film = match kind {
            Kind::Apng => FilmWriter::apng(name, out, size, count, delay, self.metadata)?,
            Kind::Y4m => FilmWriter::y4m(name, out, size, count, delay)?,
        };
        film.picture(&first)?;
        for number in 1..self.count {
            interrupt::check()?;
            film.picture(&picture(number)?)?;
        }
        film.finish()?;
        Ok(size)
    }

    fn pictures(&self) -> u32 {
        u32::try_from(self.count).unwrap_or(u32::MAX)
    }
}

/// A film on its way to standard output, where each picture goes as soon as it is made.
pub struct Stream<'a> {
    reel: &'a Reel<'a>,
    /// `None` before the first picture.
    film: Option<FilmWriter<Stdout>>,
    /// Whether somebody reads it.
    is_open: bool,
    is_alone: bool,
}

impl Stream<'_> {
    /// Sends the next picture, if somebody reads the film.
    ///
    /// # Errors
    /// Those of `picture` and of writing. A closed pipe is one, to end the work, if there is no other output.
    pub fn send(&mut self, picture: impl FnOnce() -> Result<RgbImage>) -> Result<()> {
        if !self.is_open {
            return Ok(());
        }
        match self.write(&picture()?) {
            Err(error) if is_closed(&error) && !self.is_alone => {
                self.is_open = false;
                Ok(())
            }
            sent => sent,
        }
    }

    fn write(&mut self, picture: &RgbImage) -> Result<()> {
        let film = match &mut self.film {
            Some(film) => film,
            None => {
                let size = [picture.width, picture.height];
                let delay = Delay::of_rate(self.reel.fps)?;
                let (count, out) = (self.reel.pictures(), io::stdout());
                let film = FilmWriter::y4m(STDOUT.as_ref(), out, size, count, delay)?;
                self.film.insert(film)
            }
        };
        film.picture(picture)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_that_another_run_has_replaced_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film-000000.png");
        let write = |fingerprint: &str| {
            let text = [(Identity::KEY.to_string(), fingerprint.to_string())];
            png::write(&path, 2, 1, &[7; 6], &text).unwrap();
        };
        write("0123456789abcdef");
        assert_eq!(read(&path, "0123456789abcdef").unwrap().rgb, [7; 6]);
        assert!(!read_bytes(&path, "0123456789abcdef").unwrap().is_empty());
        write("fedcba9876543210");
        let refused = [
            read(&path, "0123456789abcdef").err(),
            read_bytes(&path, "0123456789abcdef").err(),
        ];
        for error in refused {
            let said = error.unwrap().to_string();
            assert!(
                said.contains("film-000000.png") && said.contains("replaced"),
                "{said}"
            );
        }
    }
}
