//! A file of finished parts of long work, from which stopped work is resumed.
//!
//! A line with the format and the fingerprint of the work; then for each part its index, its length in bytes, its bytes, and the CRC-32
//! of all three, numbers in little-endian order. A part that was being written when a process ended has no valid checksum, and is cut
//! off.

use std::collections::HashMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use crate::error::{Error, Result};

/// The first line.
const FORMAT: &[u8] = b"nullray parts 1\n";
/// Bytes of a fingerprint, and of index and length.
const FINGERPRINT: usize = 32;
const HEAD: usize = 16;

/// Finished parts of some work.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    fingerprint: [u8; FINGERPRINT],
    file: Mutex<Option<File>>,
    parts: Parts,
    forgot: bool,
}

/// By index of a part, the position and number of its bytes.
type Parts = HashMap<u64, (u64, usize)>;

impl Journal {
    /// Opens the file of the work with this fingerprint; parts of other work are discarded. The file is created with the first part, so
    /// work that is refused leaves no file.
    ///
    /// # Errors
    /// I/O errors, a file in use by another process, and one that is not a journal.
    pub fn open(path: &Path, fingerprint: &[u8; FINGERPRINT]) -> Result<Journal> {
        let failed = || Error::io(path, "cannot write");
        let mut journal = Journal {
            path: path.into(),
            fingerprint: *fingerprint,
            file: Mutex::new(None),
            parts: Parts::new(),
            forgot: false,
        };
        if !path.try_exists().map_err(failed())? {
            return Ok(journal);
        }
        let mut file = ours(path)?;
        let (parts, end) = scan(&mut file, fingerprint).map_err(failed())?;
        let head = (FORMAT.len() + FINGERPRINT) as u64;
        journal.forgot = end == 0 && file.metadata().map_err(failed())?.len() > head;
        journal.parts = parts;
        // Unusable content is overwritten by the first part.
        if end == 0 {
            return Ok(journal);
        }
        journal.begin(&mut file, end).map_err(failed())?;
        journal.file = Mutex::new(Some(file));
        Ok(journal)
    }

    /// Truncates `file` to `end`, where the next part will go, and writes the header if there is no part.
    fn begin(&self, file: &mut File, end: u64) -> io::Result<()> {
        file.set_len(end)?;
        file.seek(SeekFrom::Start(end))?;
        match end {
            0 => file.write_all(&[FORMAT, &self.fingerprint].concat()),
            _ => Ok(()),
        }
    }

    /// The number of parts found.
    pub fn found(&self) -> usize {
        self.parts.len()
    }

    /// Whether parts of other work were found, and discarded.
    pub fn forgot(&self) -> bool {
        self.forgot
    }

    /// The bytes of a part that was found.
    ///
    /// # Errors
    /// I/O errors.
    pub fn part(&self, index: u64) -> Result<Option<Vec<u8>>> {
        let Some((at, length)) = self.parts.get(&index) else {
            return Ok(None);
        };
        let read = |file: &mut Option<File>| {
            let file = file.as_mut().ok_or(io::ErrorKind::NotFound)?;
            let end = file.stream_position()?;
            let mut bytes = vec![0; *length];
            file.seek(SeekFrom::Start(*at))?;
            file.read_exact(&mut bytes)?;
            file.seek(SeekFrom::Start(end))?;
            Ok(bytes)
        };
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let bytes = read(&mut file).map_err(Error::io(&self.path, "cannot read"))?;
        Ok(Some(bytes))
    }

    /// Adds a part.
    ///
    /// # Errors
    /// I/O errors.
    pub fn add(&self, index: u64, bytes: &[u8]) -> Result<()> {
        let mut record = Vec::with_capacity(HEAD + bytes.len() + 4);
        record.extend(index.to_le_bytes());
        record.extend((bytes.len() as u64).to_le_bytes());
        record.extend(bytes);
        let mut crc = flate2::Crc::new();
        crc.update(&record);
        record.extend(crc.sum().to_le_bytes());
        let failed = || Error::io(&self.path, "cannot write");
        let mut held = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        if held.is_none() {
            let mut file = ours(&self.path)?;
            self.begin(&mut file, 0).map_err(failed())?;
            *held = Some(file);
        }
        match held.as_mut() {
            Some(file) => file.write_all(&record).map_err(failed()),
            None => Ok(()),
        }
    }

    /// Removes the file, if it exists, because all parts have been used or are no longer needed.
    ///
    /// # Errors
    /// I/O errors.
    pub fn remove(self) -> Result<()> {
        let file = self.file.into_inner();
        match file.unwrap_or_else(PoisonError::into_inner) {
            Some(_) => {
                std::fs::remove_file(&self.path).map_err(Error::io(&self.path, "cannot remove"))
            }
            None => Ok(()),
        }
    }
}

/// The file of a journal, empty if it did not exist.
fn ours(path: &Path) -> Result<File> {
    let failed = || Error::io(path, "cannot write");
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    let mut file = options.open(path).map_err(failed())?;
    if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
        let what = "another process is working on this";
        return Err(Error::invalid(
            path,
            "",
            what,
            "wait for it, or write elsewhere",
        ));
    }
    if !is_journal(&mut file).map_err(failed())? {
        let what = "this is not a file of finished parts, and would be overwritten";
        return Err(Error::invalid(
            path,
            "",
            what,
            "remove it, or write elsewhere",
        ));
    }
    Ok(file)
}

/// Whether `file` is empty or begins like a journal, as far as it goes.
fn is_journal(file: &mut File) -> io::Result<bool> {
    let mut line = Vec::new();
    file.take(FORMAT.len() as u64).read_to_end(&mut line)?;
    file.rewind()?;
    Ok(FORMAT.starts_with(&line))
}

/// The complete parts in `file`, if they belong to this work, and where they end.
fn scan(file: &mut File, fingerprint: &[u8; FINGERPRINT]) -> io::Result<(Parts, u64)> {
    let length = file.metadata()?.len();
    let mut parts = Parts::new();
    let mut reader = BufReader::with_capacity(1 << 16, file);
    let mut head = [0; FORMAT.len() + FINGERPRINT];
    let is_ours = match reader.read_exact(&mut head) {
        Ok(()) => head.starts_with(FORMAT) && head.ends_with(fingerprint),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => false,
        Err(error) => return Err(error),
    };
    // A journal of other work, or none, starts anew: nothing of it is kept.
    if !is_ours {
        return Ok((parts, 0));
    }
    let mut at = head.len() as u64;
    let mut block = vec![0; 1 << 16];
    // Consecutive parts, as long as they are complete and their checksums match; an incomplete last part is overwritten.
    while let Some(after) = at.checked_add(HEAD as u64).filter(|after| *after <= length) {
        let mut crc = flate2::Crc::new();
        let mut numbers = [0; HEAD];
        reader.read_exact(&mut numbers)?;
        crc.update(&numbers);
        let number = |from: usize| {
            let bytes = std::array::from_fn(|k| numbers[from + k]);
            u64::from_le_bytes(bytes)
        };
        let (index, bytes) = (number(0), number(8));
        // Lengths come from the file, which may be damaged: none beyond its end is trusted.
        let end = after.checked_add(bytes).and_then(|end| end.checked_add(4));
        let (Some(end), Ok(size)) = (end.filter(|end| *end <= length), usize::try_from(bytes))
        else {
            break;
        };
        // In pieces, so that a part of any size is checked with the same memory.
        let mut left = size;
        while left > 0 {
            let piece = left.min(block.len());
            reader.read_exact(&mut block[..piece])?;
            crc.update(&block[..piece]);
            left -= piece;
        }
        let mut sum = [0; 4];
        reader.read_exact(&mut sum)?;
        if u32::from_le_bytes(sum) != crc.sum() {
            break;
        }
        parts.insert(index, (after, size));
        at = end;
    }
    Ok((parts, at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_parts_are_found_again_and_torn_ones_are_cut_off() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("parts");
        let journal = Journal::open(&path, &[1; 32]).unwrap();
        // No file before the first part.
        assert!(!path.exists());
        journal.add(7, b"seven").unwrap();
        journal.add(2, &[9; 100_000]).unwrap();
        assert!(Journal::open(&path, &[1; 32]).is_err());
        drop(journal);
        let whole = std::fs::read(&path).unwrap();
        for (cut, parts) in [(0, 2), (1, 1), (100_003, 1), (100_021, 0)] {
            std::fs::write(&path, &whole[..whole.len() - cut]).unwrap();
            let journal = Journal::open(&path, &[1; 32]).unwrap();
            assert_eq!(journal.found(), parts, "{cut}");
            let seven = journal.part(7).unwrap();
            assert_eq!(seven.as_deref(), (parts > 0).then_some(&b"seven"[..]));
            journal.add(3, b"more").unwrap();
            drop(journal);
            let journal = Journal::open(&path, &[1; 32]).unwrap();
            assert_eq!(journal.part(3).unwrap().unwrap(), b"more");
        }
        // A changed byte ends the valid parts; other work starts anew.
        let mut changed = whole.clone();
        changed[60] ^= 1;
        std::fs::write(&path, &changed).unwrap();
        assert_eq!(Journal::open(&path, &[1; 32]).unwrap().found(), 0);
        std::fs::write(&path, &whole).unwrap();
        let other = Journal::open(&path, &[2; 32]).unwrap();
        assert!(other.found() == 0 && other.forgot());
        assert_eq!(std::fs::read(&path).unwrap(), whole);
        other.add(1, b"one").unwrap();
        other.remove().unwrap();
        assert!(!path.exists());
        // Files that are not journals are never overwritten.
        for text in [
            "notes",
            "notes that are longer than the first line of a journal",
        ] {
            std::fs::write(&path, text).unwrap();
            let error = Journal::open(&path, &[1; 32]).unwrap_err();
            assert!(error.to_string().contains("overwritten"), "{error}");
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        }
        std::fs::write(&path, &FORMAT[..7]).unwrap();
        assert_eq!(Journal::open(&path, &[1; 32]).unwrap().found(), 0);
    }
}
