//! Progressive rendering: passes of independent samples, until an error is reached or the caller stops.
//!
//! Each pass repeats the samples of the layout with random numbers of its own ([`sampler`](crate::render::sampler)). Passes come in pairs,
//! one for each half of a tile's samples, and each half decides how many passes of the other are used, so the picture has no bias
//! ([`film`](crate::render::film)). A half requests no more passes of the other as soon as, by its own estimates,
//! ```text
//! √(mean over pixels, and R, G and B, of standard error²) ≤ ε · (mean radiance of the tile, or of the picture if that is higher),
//! ```
//!
//! where two of its own standard deviations are added to the mean square, which is uncertain while few passes find a light. A tile is
//! rendered until both halves are decided. The first decision comes after 4 passes and 32 samples per pixel of each half:
//! of fewer samples, all parts of a half often agree exactly at the rim of a light, although their mean is wrong. As this number depends on
//! no sample, it adds no bias. A half that saw too little noise by chance can still settle the other too early; passes that make up for it would
//! depend on the values, so they are not taken, and the tile is counted ([`Passes::beyond`]).
//!
//! The picture of P passes is a function of scene, ε and P: the same bits on any number of threads, and whether or not the work was
//! interrupted and resumed in between.
//!
//! The file of the sums: a line that names the format, the fingerprint of what is rendered, passes, ε and the picture's mean radiance per
//! half, the sums of all tiles in order (numbers in little-endian order), and the SHA-256 of all that.

use std::convert::Infallible;
use std::io::{self, Read, Write};
use std::path::Path;

use rayon::prelude::*;
use sha2::{Digest, Sha256};

use crate::error::{Error, Result};
use crate::io::image::write_atomically;
use crate::render::film::{Film, Layout, Tile, TileFilm};
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::sampler::Sampler;
use crate::render::tiles::{Buffers, Pipeline};
use crate::render::trace::Meter;
use crate::scene::model::MOST_SAMPLES;

/// The least number of passes of each half before its first decision, which give a variance of its parts, and of its samples per pixel.
const LEAST_PASSES: u32 = 4;
const LEAST_SAMPLES: u32 = 32;
/// The first line of a file of sums.
const FORMAT: &[u8] = b"nullray passes 5\n";
/// The error message for an invalid file of sums.
const DAMAGED: &str = "this file of finished passes is damaged";
/// Bytes of a SHA-256.
const DIGEST: usize = 32;

/// The sums of all finished passes.
#[derive(Debug)]
pub struct Passes {
    tiles: Vec<TileFilm>,
    /// The samples of each tile, unless it has no more than those of the finished passes.
    taken: Vec<u32>,
    layout: Layout,
    sampler: Sampler,
    done: u32,
    /// ε.
    error: Option<f64>,
    /// The mean radiance of the picture per half at the first decisions.
    mean: Option<[f64; 2]>,
}

impl Passes {
    /// Zero passes of a prepared scene; `error` is the requested error relative to radiance, or `None` for unlimited passes.
    ///
    /// # Errors
    /// An error that is not above 0; a film without pixels.
    pub fn new(scene: &Prepared, error: Option<f64>) -> Result<Self> {
        if let Some(error) = error.filter(|error| !(error.is_finite() && *error > 0.0)) {
            let what = format!("an error of {error} cannot be reached");
            return Err(Error::invalid(
                "passes",
                "error",
                what,
                "above 0, like 0.01",
            ));
        }
        let layout = scene.layout.clone();
        layout.check()?;
        let tiles = 0..Tile::count(layout.size);
        let tiles: Vec<_> = tiles
            .map(|index| TileFilm::of_passes(Tile::of_image(layout.size, index), &layout))
            .collect();
        Ok(Passes {
            taken: vec![0; tiles.len()],
            tiles,
            sampler: scene.sampler.with_samples(layout.samples),
            layout,
            done: 0,
            error,
            mean: None,
        })
    }

    /// The number of finished passes, which is even.
    pub fn done(&self) -> u32 {
        self.done
    }

    /// The maximum number of passes of a layout: those of 65,536 samples per pixel, or 16.
    pub fn most(&self) -> u32 {
        (MOST_SAMPLES / self.layout.samples / 2 * 2).max(4 * LEAST_PASSES)
    }

    /// The number of passes of each half before its first decision: a function of the samples of a pass alone.
    fn first(&self) -> u32 {
        LEAST_SAMPLES
            .div_ceil(self.layout.samples)
            .max(LEAST_PASSES)
    }

    /// Whether all tiles have reached the requested error.
    pub fn is_settled(&self) -> bool {
        self.unsettled() == 0
    }

    /// The number of tiles that need more passes.
    pub fn unsettled(&self) -> usize {
        let parts = self.tiles.iter().filter_map(TileFilm::parts);
        parts.filter(|parts| !parts.is_settled()).count()
    }

    /// Camera rays of the next two passes.
    pub fn rays(&self) -> u64 {
        let unsettled = self.tiles.iter().filter(|tile| needs_more(tile));
        let pixels: usize = unsettled.map(|tile| tile.tile().pixels()).sum();
        2 * pixels as u64 * u64::from(self.layout.samples)
    }

    /// Renders two more passes of the tiles that need them, on rayon's current thread pool; `scene` is the one they were started with. If
    /// it was cancelled, the next call renders what is left of these two: with the same bits as without the interruption.
    ///
    /// # Errors
    /// [`Error::Cancelled`] when `progress` says so; a scene that is prepared for another film; and data that cannot be read, after which
    /// these sums are unusable.
    pub fn advance(&mut self, scene: &Prepared, progress: &dyn Progress) -> Result<()> {
        if scene.layout != self.layout {
            let what = "the scene is prepared for another film than these passes";
            let help = "the scene that they were started with";
            return Err(Error::invalid("passes", "layout", what, help));
        }
        let pipeline = Pipeline::new(scene, self.sampler);
        let first = self.done * self.layout.samples;
        let end = first + 2 * self.layout.samples;
        let tiles = self.tiles.par_iter_mut().zip(&mut self.taken);
        let unsettled = tiles.filter(|(tile, _)| needs_more(tile));
        let done = unsettled.try_for_each_init(Buffers::default, |buffers, (film, taken)| {
            let mut left = first.max(*taken)..end;
            let meter = &mut Meter::new(false);
            let done = pipeline.samples(&mut left, buffers, film, progress, meter);
            *taken = left.start;
            done
        });
        scene.light.check()?;
        done?;
        self.done += 2;
        self.decide();
        Ok(())
    }

    /// Lets each half of each tile decide whether it needs more passes of the other.
    fn decide(&mut self) {
        let Some(error) = self.error.filter(|_| self.done >= 2 * self.first()) else {
            return;
        };
        let mean = *self.mean.get_or_insert_with(|| means(&self.tiles));
        for parts in self.tiles.iter_mut().filter_map(TileFilm::parts_mut) {
            for half in 0..2 {
                let judge = 1 - half;
                let [radiance, standard_error] = parts.tile_judgement(judge);
                // NaN does not improve with more samples.
                let is_coarse = standard_error > error * radiance.max(mean[judge]);
                parts.settled[half] |= !is_coarse;
            }
        }
    }

    /// Refuses passes of which some tiles have more than others.
    fn check_whole(&self) -> Result<()> {
        let finished = self.done * self.layout.samples;
        if self.taken.iter().all(|taken| *taken <= finished) {
            return Ok(());
        }
        let what = "two passes were cancelled, which some tiles have finished and others have not";
        let help = "call `advance` again, which renders what is left of them";
        Err(Error::invalid("passes", "", what, help))
    }

    /// The picture so far.
    ///
    /// # Errors
    /// Passes that were cancelled, until [`Passes::advance`] has finished them.
    pub fn film(&self) -> Result<Film> {
        self.check_whole()?;
        let Ok(film) = Film::of_tiles(&self.layout, |rows| {
            self.tiles.iter().for_each(|tile| rows.place(tile));
            Ok::<(), Infallible>(())
        });
        Ok(film.with_passes(self.done, self.error))
    }

    /// The standard error of the picture so far: root mean square over pixels, and R, G and B, divided by their mean radiance. 0 if it is dark.
    pub fn error(&self) -> f64 {
        let (mut square, mut pixels) = (0.0, 0);
        for parts in self.tiles.iter().filter_map(TileFilm::parts) {
            let count = parts.pixels();
            pixels += count;
            square += (0..count)
                .map(|pixel| parts.own_error_square(pixel))
                .sum::<f64>();
        }
        let [a, b] = means(&self.tiles);
        let mean = 0.5 * (a + b);
        match mean > 0.0 {
            true => (square / pixels as f64).sqrt() / mean,
            false => 0.0,
        }
    }

    /// The settled tiles whose standard error, as the root mean square over their pixels, is nevertheless above the requested one.
    pub fn beyond(&self) -> Beyond {
        let mut beyond = Beyond::default();
        let Some(wanted) = self.error else {
            return beyond;
        };
        // Radiance and error of the tiles as they are in the picture, and the picture's mean radiance.
        let found = self.tiles.iter().filter_map(TileFilm::parts);
        let found = found.map(|parts| (parts, parts.tile_radiance()));
        let found: Vec<_> = found.collect();
        let (sum, pixels) = found
            .iter()
            .fold((0.0, 0.0), |(sum, pixels), (parts, mean)| {
                let count = parts.pixels() as f64;
                (sum + mean * count, pixels + count)
            });
        let picture = sum / pixels;
        for (parts, mean) in found.iter().filter(|(parts, _)| parts.is_settled()) {
            let count = parts.pixels();
            let square = (0..count).map(|pixel| parts.own_error_square(pixel));
            let error = (square.sum::<f64>() / count as f64).sqrt() / mean.max(picture);
            // Neither a dark picture nor NaN has an error.
            if error > wanted {
                beyond.tiles += 1;
                beyond.largest = beyond.largest.max(error);
            }
        }
        beyond
    }

    /// Writes all sums to `path` atomically. `fingerprint` identifies what is rendered.
    ///
    /// # Errors
    /// I/O errors; passes that were cancelled, as for [`Passes::film`].
    pub fn write(&mut self, path: &Path, fingerprint: &[u8; DIGEST]) -> Result<()> {
        self.check_whole()?;
        let head = self.head(fingerprint);
        write_atomically(path, |writer| {
            let mut hash = Sha256::new();
            let mut block = head;
            let mut failed = Ok(());
            // The digest covers everything before it, so that a truncated or changed file is detected.
            let mut flush = |block: &mut Vec<u8>, least: usize| {
                if block.len() > least && failed.is_ok() {
                    hash.update(&*block);
                    failed = writer.write_all(block);
                    block.clear();
                }
            };
            for tile in &mut self.tiles {
                let block = std::cell::RefCell::new(&mut block);
                tile.each_sum(
                    &mut |numbers| {
                        let bytes = numbers.iter().flat_map(|x| x.to_le_bytes());
                        block.borrow_mut().extend(bytes);
                    },
                    &mut |count| block.borrow_mut().extend(count.to_le_bytes()),
                );
                flush(&mut block.borrow_mut(), 1 << 16);
            }
            flush(&mut block, 0);
            let written = failed.and_then(|()| writer.write_all(&hash.finalize()));
            written.map_err(Error::io(path, "cannot write"))
        })
    }

    fn head(&self, fingerprint: &[u8; DIGEST]) -> Vec<u8> {
        let mut head = FORMAT.to_vec();
        head.extend(fingerprint);
        head.extend(self.done.to_le_bytes());
        head.push(u8::from(self.mean.is_some()));
        for mean in self.mean.unwrap_or_default() {
            head.extend(mean.to_le_bytes());
        }
        head
    }

    /// Resumes from the sums in `path`; returns false, with nothing changed, if they belong to other work or there is no such file.
    ///
    /// # Errors
    /// A file that is damaged, or not a file of passes; I/O errors.
    pub fn resume(&mut self, path: &Path, fingerprint: &[u8; DIGEST]) -> Result<bool> {
        let file = match std::fs::File::open(path) {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
            Err(error) => return Err(Error::io(path, "cannot read")(error)),
        };
        let mut reader = Hashed {
            reader: io::BufReader::with_capacity(1 << 16, file),
            hash: Sha256::new(),
        };
        let failed = |error: io::Error| match error.kind() {
            io::ErrorKind::UnexpectedEof => damaged(path),
            _ => Error::io(path, "cannot read")(error),
        };
        let mut head = Vec::new();
        let length = (FORMAT.len() + DIGEST) as u64;
        (&mut reader)
            .take(length)
            .read_to_end(&mut head)
            .map_err(failed)?;
        if !head.starts_with(FORMAT) {
            let what = "this is not a file of finished passes, and would be overwritten";
            return Err(Error::invalid(
                path,
                "",
                what,
                "remove it, or write elsewhere",
            ));
        }
        if head.len() as u64 == length && !head.ends_with(fingerprint) {
            return Ok(false);
        }
        let (done, mean) = self.read_sums(&mut reader).map_err(failed)?;
        let found = reader.hash.finalize();
        let mut digest = [0; DIGEST];
        reader.reader.read_exact(&mut digest).map_err(failed)?;
        // Nothing may follow.
        let ends = reader.reader.read(&mut [0]).map_err(failed)? == 0;
        if found[..] != digest || !ends || done % 2 != 0 {
            return Err(damaged(path));
        }
        (self.done, self.mean) = (done, mean);
        self.taken.fill(0);
        Ok(true)
    }

    /// Reads the number of passes, the means and the sums of all tiles.
    fn read_sums(&mut self, reader: &mut impl Read) -> io::Result<(u32, Option<[f64; 2]>)> {
        let mut number = [0; 4];
        reader.read_exact(&mut number)?;
        let mut has_mean = [0];
        reader.read_exact(&mut has_mean)?;
        let mut mean = [0.0; 2];
        for mean in &mut mean {
            *mean = f64::from_le_bytes(read_eight(reader)?);
        }
        // The closures below are called in turn and cannot return errors: the first error is stored, and ends the loop.
        let reader = std::cell::RefCell::new(reader);
        let mut failed = Ok(());
        let failed = std::cell::RefCell::new(&mut failed);
        let next = || match read_eight(*reader.borrow_mut()) {
            Ok(bytes) => bytes,
            Err(error) => {
                **failed.borrow_mut() = Err(error);
                [0; 8]
            }
        };
        for tile in &mut self.tiles {
            tile.each_sum(
                &mut |numbers| numbers.fill_with(|| f64::from_le_bytes(next())),
                &mut |count| *count = u64::from_le_bytes(next()),
            );
            if failed.borrow().is_err() {
                break;
            }
        }
        let result = std::mem::replace(*failed.borrow_mut(), Ok(()));
        result.map(|()| {
            (
                u32::from_le_bytes(number),
                (has_mean == [1]).then_some(mean),
            )
        })
    }
}

/// Tiles that are settled, and have a larger error than the requested one.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Beyond {
    /// Their number.
    pub tiles: usize,
    /// The largest of their standard errors, relative to the mean radiance of its tile, or of the picture if that is higher.
    pub largest: f64,
}

/// Bytes of the passes of `layout` besides the film.
pub fn bytes(layout: &Layout) -> u64 {
    layout.bytes_of_passes()
}

fn needs_more(tile: &TileFilm) -> bool {
    tile.parts().is_some_and(|parts| !parts.is_settled())
}

/// The mean radiance of all pixels, per half.
fn means(tiles: &[TileFilm]) -> [f64; 2] {
    std::array::from_fn(|half| {
        let (mut sum, mut pixels) = (0.0, 0);
        for parts in tiles.iter().filter_map(TileFilm::parts) {
            let count = parts.pixels();
            pixels += count;
            sum += parts.tile_judgement(half)[0] * count as f64;
        }
        sum / pixels as f64
    })
}

fn damaged(path: &Path) -> Error {
    Error::invalid(path, "", DAMAGED, "remove it to start the picture again")
}

fn read_eight(reader: &mut impl Read) -> io::Result<[u8; 8]> {
    let mut bytes = [0; 8];
    reader.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// Hashes what it reads.
struct Hashed<R> {
    reader: R,
    hash: Sha256,
}

impl<R: Read> Read for Hashed<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.reader.read(buffer)?;
        self.hash.update(&buffer[..n]);
        Ok(n)
    }
}
