//! Files with a checksum of themselves, which shows later whether one is complete.
//!
//! Once in such a file stands [`MARK`], and after it 64 hexadecimal digits: the SHA-256 of the file with zeros in their place. A byte that
//! was changed, lost or added anywhere changes the sum.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use sha2::{Digest, Sha256};

/// What stands before the digits.
pub const MARK: &str = "nullray-sha256:";
/// The key under which formats with metadata have it.
pub const KEY: &str = "file_sha256";
const DIGITS: usize = 64;
/// Read at once.
const BLOCK: usize = 1 << 16;

/// What a file has to hold once before it can be sealed.
pub fn blank() -> String {
    format!("{MARK}{}", "0".repeat(DIGITS))
}

/// Puts the digits into the place that [`blank`] keeps for them. A file with no such place, or with two, stays as it is, and is never
/// taken for whole.
///
/// # Errors
/// I/O errors.
pub(crate) fn seal(file: &mut (impl Read + Write + Seek)) -> io::Result<()> {
    if let Some(at) = place(file)? {
        let digits = digest(file, at)?;
        file.seek(SeekFrom::Start(at))?;
        file.write_all(digits.as_bytes())?;
    }
    file.seek(SeekFrom::End(0)).map(drop)
}

/// The same of a file in memory.
pub fn seal_bytes(bytes: &mut Vec<u8>) {
    // Neither reading nor writing memory fails.
    let _ = seal(&mut io::Cursor::new(bytes));
}

/// Whether the file at `path` is sealed, and is byte for byte what was sealed.
///
/// # Errors
/// I/O errors.
pub fn is_whole(path: &Path) -> io::Result<bool> {
    let mut file = File::open(path)?;
    let Some(at) = place(&mut file)? else {
        return Ok(false);
    };
    let mut digits = [0; DIGITS];
    file.seek(SeekFrom::Start(at))?;
    match file.read_exact(&mut digits) {
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => return Ok(false),
        read => read?,
    }
    Ok(digest(&mut file, at)?.as_bytes() == digits)
}

/// Where the digits begin, if the file has one place for them.
fn place(file: &mut (impl Read + Seek)) -> io::Result<Option<u64>> {
    let mark = MARK.as_bytes();
    file.rewind()?;
    let mut window = Vec::with_capacity(BLOCK + mark.len());
    let (mut start, mut found) = (0, None);
    loop {
        let kept = window.len();
        let read = file.by_ref().take(BLOCK as u64).read_to_end(&mut window)?;
        if read == 0 {
            return Ok(found);
        }
        for (at, part) in window.windows(mark.len()).enumerate() {
            if part == mark && found.replace(start + (at + mark.len()) as u64).is_some() {
                return Ok(None);
            }
        }
        // A mark that begins in one block may end in the next.
        let done = (kept + read).saturating_sub(mark.len() - 1);
        window.drain(..done);
        start += done as u64;
    }
}

/// Two digits for each byte.
pub fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The SHA-256 of the file with zeros for digits from `at` on.
fn digest(file: &mut (impl Read + Seek), at: u64) -> io::Result<String> {
    file.rewind()?;
    let mut hash = Sha256::new();
    let mut block = Vec::with_capacity(BLOCK);
    let mut start = 0u64;
    loop {
        block.clear();
        let read = file.by_ref().take(BLOCK as u64).read_to_end(&mut block)?;
        if read == 0 {
            let sum = hash.finalize();
            return Ok(hexadecimal(&sum));
        }
        let within = |place: u64| place.saturating_sub(start).min(read as u64) as usize;
        if let Some(digits) = block.get_mut(within(at)..within(at + DIGITS as u64)) {
            digits.fill(b'0');
        }
        hash.update(&block);
        start += read as u64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sealed(before: usize, after: usize) -> Vec<u8> {
        let mut bytes = [vec![7; before], blank().into_bytes(), vec![9; after]].concat();
        seal_bytes(&mut bytes);
        bytes
    }

    fn is_whole_of(bytes: &[u8]) -> bool {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), bytes).unwrap();
        is_whole(file.path()).unwrap()
    }

    #[test]
    fn any_change_of_a_sealed_file_is_seen() {
        let mut bytes = sealed(20, 30);
        assert!(is_whole_of(&bytes));
        for at in 0..bytes.len() {
            bytes[at] ^= 1;
            assert!(!is_whole_of(&bytes), "byte {at}");
            bytes[at] ^= 1;
            assert!(!is_whole_of(&bytes[..at]), "cut to {at}");
        }
        bytes.push(0);
        assert!(!is_whole_of(&bytes));
    }

    #[test]
    fn the_place_may_lie_across_blocks() {
        for before in BLOCK - DIGITS - MARK.len() - 2..BLOCK + 2 {
            let mut bytes = sealed(before, BLOCK);
            assert!(is_whole_of(&bytes), "{before}");
            *bytes.last_mut().unwrap() ^= 1;
            assert!(!is_whole_of(&bytes), "{before}");
        }
    }

    #[test]
    fn files_with_no_place_or_two_are_never_whole() {
        let twice = [blank(), blank()].concat().into_bytes();
        for mut bytes in [Vec::new(), vec![1; 100], twice] {
            let before = bytes.clone();
            seal_bytes(&mut bytes);
            assert!(bytes == before && !is_whole_of(&bytes));
        }
    }
}
