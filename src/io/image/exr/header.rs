//! The order of a header's attributes.
//!
//! The crate `exr` keeps custom attributes in a hash map, whose order differs from run to run. The
//! format gives the order no meaning, so they are sorted by name in the finished file: after magic
//! number and version (8 bytes) come `name \0 type \0 size:i32 value`, repeated, and a \0.

use std::io::{self, Read, Seek, SeekFrom, Write};

/// Sorts the attributes of a one-part file, in place.
pub(super) fn sort_attributes(file: &mut (impl Read + Write + Seek)) -> io::Result<()> {
    file.seek(SeekFrom::Start(8))?;
    let mut attributes = Vec::new();
    {
        let mut reader = io::BufReader::new(&mut *file);
        while let Some(attribute) = read_attribute(&mut reader)? {
            attributes.push(attribute);
        }
    }
    attributes.sort();
    file.seek(SeekFrom::Start(8))?;
    file.write_all(&attributes.concat())?;
    file.seek(SeekFrom::End(0))?;
    Ok(())
}

/// The bytes of the next attribute, or none at the end of the header.
fn read_attribute(reader: &mut impl io::BufRead) -> io::Result<Option<Vec<u8>>> {
    let mut attribute = Vec::new();
    reader.read_until(0, &mut attribute)?;
    if attribute.len() <= 1 {
        return Ok(None);
    }
    reader.read_until(0, &mut attribute)?;
    let mut size = [0; 4];
    reader.read_exact(&mut size)?;
    attribute.extend(size);
    let size = u64::from(u32::from_le_bytes(size));
    reader.take(size).read_to_end(&mut attribute)?;
    Ok(Some(attribute))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn attribute(name: &str, value: &[u8]) -> Vec<u8> {
        let size = (value.len() as i32).to_le_bytes();
        [name.as_bytes(), b"\0string\0", &size, value].concat()
    }

    #[test]
    fn attributes_are_sorted_and_nothing_else_moves() {
        let [a, b, c] = [
            attribute("a", b"1"),
            attribute("b", b"\0\0"),
            attribute("c", b""),
        ];
        let file = |order: [&Vec<u8>; 3]| {
            let header = order.map(Vec::as_slice).concat();
            [b"headmore".as_slice(), &header, b"\0pixels"].concat()
        };
        let mut cursor = io::Cursor::new(file([&b, &c, &a]));
        sort_attributes(&mut cursor).unwrap();
        assert_eq!(cursor.into_inner(), file([&a, &b, &c]));
    }
}
