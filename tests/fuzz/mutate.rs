//! Mutations of inputs: of arbitrary bytes, of texts by their lines, numbers and words, and of containers by their parts, with lengths and
//! checksums corrected so that the fault lies deeper.

use std::io::{Cursor, Read, Write};

/// Numbers that look random (xorshift64*), from a seed.
pub struct Numbers(u64);

impl Numbers {
    pub fn new(seed: u64) -> Self {
        Numbers(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// A number from 0 to `n` − 1; 0 of none.
    pub fn below(&mut self, n: usize) -> usize {
        ((self.next() >> 33) as usize) % n.max(1)
    }

    fn pick<'a, T>(&mut self, all: &'a [T]) -> Option<&'a T> {
        all.get(self.below(all.len()))
    }
}

/// Words of a format.
pub struct Dictionary(Vec<Vec<u8>>);

impl Dictionary {
    /// Those in the dictionary of the target, or of files of its kind.
    pub fn of(target: &str, extension: &str) -> Self {
        let path = [target, extension].map(|name| format!("fuzz/dictionaries/{name}.dict"));
        let text = path
            .iter()
            .find_map(|path| std::fs::read_to_string(path).ok());
        let text = text.unwrap_or_default();
        let word = |line: &str| Some(unescaped(line.trim().strip_prefix('"')?.strip_suffix('"')?));
        Dictionary(text.lines().filter_map(word).collect())
    }
}

/// libFuzzer's escapes: `\\`, `\"`, `\xAB`.
fn unescaped(text: &str) -> Vec<u8> {
    let mut out = Vec::new();
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        match byte {
            b'\\' => match rest.next() {
                Some(b'x') => {
                    let digits = [rest.next(), rest.next()].map(|d| d.unwrap_or(b'0'));
                    let digits = String::from_utf8_lossy(&digits).into_owned();
                    out.push(u8::from_str_radix(&digits, 16).unwrap_or(0));
                }
                Some(other) => out.push(other),
                None => {}
            },
            byte => out.push(byte),
        }
    }
    out
}

/// Values at which things change.
const NUMBERS: [&str; 40] = [
    "0",
    "1",
    "-1",
    "2",
    "3",
    "4",
    "7",
    "8",
    "16",
    "127",
    "128",
    "255",
    "256",
    "65535",
    "65536",
    "1048576",
    "2147483647",
    "2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "-9223372036854775808",
    "0.5",
    "-0.0",
    "1e-30",
    "1e-300",
    "5e-324",
    "1e30",
    "1e300",
    "1e308",
    "1e400",
    "nan",
    "inf",
    "-inf",
    "0.99999999999999994",
    "1e9",
    "1e6",
];

/// An input made of one or two of `pool`.
pub fn mutated(
    pool: &[Vec<u8>],
    extension: &str,
    words: &Dictionary,
    numbers: &mut Numbers,
) -> Vec<u8> {
    let Some(seed) = numbers.pick(pool) else {
        return Vec::new();
    };
    let other = numbers.pick(pool).cloned().unwrap_or_default();
    let mut input = seed.clone();
    let changes = 1 + numbers.below(4);
    for _ in 0..changes {
        let by_parts = numbers.below(3) > 0;
        input = match extension {
            "toml" | "txt" | "csv" if by_parts => text(&input, &other, words, numbers),
            "glb" if by_parts => glb(&input, words, numbers),
            "npy" if by_parts => npy(&input, words, numbers),
            "npz" if by_parts => npz(&input, words, numbers),
            "png" if by_parts => png(&input, words, numbers),
            _ => bytes(input, &other, words, numbers),
        };
    }
    input.truncate(1 << 20);
    input
}

/// A change that knows nothing.
fn bytes(mut input: Vec<u8>, other: &[u8], words: &Dictionary, numbers: &mut Numbers) -> Vec<u8> {
    let at = numbers.below(input.len() + 1);
    let to = (at + numbers.below(16)).min(input.len());
    match numbers.below(9) {
        0 if at < input.len() => input[at] ^= 1 << numbers.below(8),
        1 if at < input.len() => input[at] = numbers.next() as u8,
        2 => input.truncate(at),
        3 => drop(input.splice(at..to, [])),
        4 => {
            let copy = input[at..to].to_vec();
            input.splice(at..at, copy);
        }
        5 => {
            let word = numbers.pick(&words.0).cloned().unwrap_or_default();
            input.splice(at..at, word);
        }
        6 => {
            // Integers of any width.
            let value = [
                0,
                1,
                0x7f,
                0x80,
                0xff,
                0x7fff_ffff,
                0x8000_0000,
                0xffff_ffff,
                u64::MAX >> 1,
                u64::MAX,
            ];
            let value = numbers
                .pick(&value)
                .copied()
                .unwrap_or_default()
                .to_le_bytes();
            let width = 1 << numbers.below(4);
            for (byte, new) in input.iter_mut().skip(at).zip(value).take(width) {
                *byte = new;
            }
        }
        7 => {
            let from = numbers.below(other.len() + 1);
            input.truncate(at);
            input.extend_from_slice(&other[from..]);
        }
        _ => {
            for _ in 0..numbers.below(8) {
                let at = numbers.below(input.len());
                if let Some(byte) = input.get_mut(at) {
                    *byte = numbers.next() as u8;
                }
            }
        }
    }
    input
}

/// A change of a text: a number, a word, a line.
fn text(input: &[u8], other: &[u8], words: &Dictionary, numbers: &mut Numbers) -> Vec<u8> {
    let text = String::from_utf8_lossy(input).into_owned();
    let mut lines: Vec<String> = text.split('\n').map(String::from).collect();
    let line = numbers.below(lines.len());
    match numbers.below(8) {
        0 | 1 => {
            let number = *numbers.pick(&NUMBERS).unwrap_or(&"0");
            let which = numbers.below(8);
            lines[line] = with_number(&lines[line], which, number);
        }
        2 => drop(lines.remove(line)),
        3 => lines.insert(line, lines[line].clone()),
        4 => {
            let with = numbers.below(lines.len());
            lines.swap(line, with);
        }
        5 => {
            let other = String::from_utf8_lossy(other).into_owned();
            let others: Vec<&str> = other.split('\n').collect();
            let taken = numbers.pick(&others).copied().unwrap_or_default();
            lines.insert(line, taken.to_string());
        }
        6 => {
            let word = numbers.pick(&words.0).cloned().unwrap_or_default();
            let word = String::from_utf8_lossy(&word).into_owned();
            let places: Vec<usize> = lines[line].char_indices().map(|(at, _)| at).collect();
            let at = numbers.pick(&places).copied().unwrap_or_default();
            lines[line].insert_str(at, &word);
        }
        _ => {
            // A very long line, or very deep brackets.
            let part = *numbers
                .pick(&["[", "{a=", "x", "é", "\u{1b}[31m", " ", "\"\"\""])
                .unwrap_or(&"x");
            let times = 1 << numbers.below(14);
            lines[line].push_str(&part.repeat(times));
        }
    }
    lines.join("\n").into_bytes()
}

/// The n-th number of a line (of those there are) as another.
fn with_number(line: &str, n: usize, number: &str) -> String {
    let is_digit = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+');
    let mut found = Vec::new();
    let mut start = None;
    for (at, c) in line.char_indices().chain([(line.len(), ' ')]) {
        match (start, is_digit(c)) {
            (None, true) => start = Some(at),
            (Some(from), false) => {
                found.push(from..at);
                start = None;
            }
            _ => {}
        }
    }
    let Some(range) = found.get(n % found.len().max(1)) else {
        return line.to_string();
    };
    format!("{}{number}{}", &line[..range.start], &line[range.end..])
}

/// A GLB file of which the JSON says something else: a number, an index, a missing key.
fn glb(input: &[u8], words: &Dictionary, numbers: &mut Numbers) -> Vec<u8> {
    let is_glb = input.starts_with(b"glTF");
    let (json, rest) = match (is_glb, input.get(12..20)) {
        (true, Some(header)) => {
            let length = u32::from_le_bytes(header[..4].try_into().unwrap_or_default()) as usize;
            let end = 20usize.saturating_add(length).min(input.len());
            (&input[20..end], &input[end..])
        }
        _ => (input, &[][..]),
    };
    let Ok(mut value) = serde_json::from_slice::<serde_json::Value>(json) else {
        return bytes(input.to_vec(), &[], words, numbers);
    };
    let count = leaves(&mut value, &mut |_| {});
    let wanted = numbers.below(count);
    let mut index = 0;
    let new = json_value(words, numbers);
    leaves(&mut value, &mut |leaf| {
        if index == wanted {
            *leaf = new.clone();
        }
        index += 1;
    });
    let mut json = value.to_string().into_bytes();
    if !is_glb {
        return json;
    }
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend((20 + json.len() as u32 + rest.len() as u32).to_le_bytes());
    out.extend((json.len() as u32).to_le_bytes());
    out.extend(b"JSON");
    out.extend(json);
    out.extend(rest);
    out
}

fn json_value(words: &Dictionary, numbers: &mut Numbers) -> serde_json::Value {
    match numbers.below(5) {
        0 => serde_json::Value::Null,
        1 => {
            let word = numbers.pick(&words.0).cloned().unwrap_or_default();
            String::from_utf8_lossy(&word).into_owned().into()
        }
        2 => serde_json::json!([]),
        _ => {
            let number = numbers.pick(&NUMBERS).copied().unwrap_or("0");
            serde_json::from_str(number).unwrap_or_else(|_| numbers.below(9).into())
        }
    }
}

/// Calls `with` for every value that holds no others; how many there are.
fn leaves(value: &mut serde_json::Value, with: &mut impl FnMut(&mut serde_json::Value)) -> usize {
    match value {
        serde_json::Value::Array(all) if !all.is_empty() => {
            all.iter_mut().map(|v| leaves(v, with)).sum()
        }
        serde_json::Value::Object(all) if !all.is_empty() => {
            all.values_mut().map(|v| leaves(v, with)).sum()
        }
        leaf => {
            with(leaf);
            1
        }
    }
}

/// An array whose header says something else, with its length made right.
fn npy(input: &[u8], words: &Dictionary, numbers: &mut Numbers) -> Vec<u8> {
    let Some(length) = input.get(8..10) else {
        return bytes(input.to_vec(), &[], words, numbers);
    };
    let length = usize::from(u16::from_le_bytes([length[0], length[1]]));
    let end = (10 + length).min(input.len());
    let header = text(&input[10..end], &[], words, numbers);
    let mut out = input[..8].to_vec();
    out.extend((header.len().min(65_535) as u16).to_le_bytes());
    out.extend(header);
    out.extend(&input[end..]);
    out
}

/// An archive of which a member is changed and stored again, or whose directory lies.
fn npz(input: &[u8], words: &Dictionary, numbers: &mut Numbers) -> Vec<u8> {
    let Ok(mut archive) = zip::ZipArchive::new(Cursor::new(input)) else {
        return bytes(input.to_vec(), &[], words, numbers);
    };
    let mut out = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let changed = numbers.below(archive.len());
    for index in 0..archive.len() {
        let Ok(mut member) = archive.by_index(index) else {
            return bytes(input.to_vec(), &[], words, numbers);
        };
        let mut data = Vec::new();
        let name = member
            .name()
            .map_or("a.npy".into(), |name| name.to_string());
        if (&mut member).take(1 << 20).read_to_end(&mut data).is_err() {
            return bytes(input.to_vec(), &[], words, numbers);
        }
        if index == changed {
            data = npy(&data, words, numbers);
        }
        let method = match numbers.below(2) {
            0 => zip::CompressionMethod::Stored,
            _ => zip::CompressionMethod::Deflated,
        };
        let options = zip::write::SimpleFileOptions::default().compression_method(method);
        if out.start_file(name, options).is_err() || out.write_all(&data).is_err() {
            return input.to_vec();
        }
    }
    let mut out = out
        .finish()
        .map_or_else(|_| input.to_vec(), Cursor::into_inner);
    // Sizes in the directory: 8 bytes from 20 on after each PK\1\2.
    if numbers.below(3) == 0 {
        let entries: Vec<usize> = (0..out.len().saturating_sub(46))
            .filter(|at| out[*at..].starts_with(b"PK\x01\x02"))
            .collect();
        if let Some(&at) = numbers.pick(&entries) {
            let which = at + 20 + 4 * numbers.below(2);
            let size = [
                0u32,
                1,
                0x7fff_ffff,
                0xffff_fffe,
                0xffff_ffff,
                numbers.next() as u32,
            ];
            let size = numbers.pick(&size).copied().unwrap_or_default();
            out[which..which + 4].copy_from_slice(&size.to_le_bytes());
        }
    }
    out
}

/// A PNG of which a chunk is changed, doubled or missing, with checksums made right.
fn png(input: &[u8], words: &Dictionary, numbers: &mut Numbers) -> Vec<u8> {
    let mut chunks: Vec<Vec<u8>> = Vec::new();
    let mut rest = input.get(8..).unwrap_or_default();
    while let Some(length) = rest.get(..4) {
        let length = u32::from_be_bytes(length.try_into().unwrap_or_default()) as usize;
        let Some(chunk) = rest.get(4..length.saturating_add(8)) else {
            break;
        };
        chunks.push(chunk.to_vec());
        rest = rest.get(length + 12..).unwrap_or_default();
    }
    if !input.starts_with(b"\x89PNG") || chunks.is_empty() {
        return bytes(input.to_vec(), &[], words, numbers);
    }
    let which = numbers.below(chunks.len());
    match numbers.below(6) {
        0 => drop(chunks.remove(which)),
        1 => chunks.insert(which, chunks[which].clone()),
        2 => {
            let with = numbers.below(chunks.len());
            chunks.swap(which, with);
        }
        _ => chunks[which] = bytes(std::mem::take(&mut chunks[which]), &[], words, numbers),
    }
    let mut out = input[..8].to_vec();
    for chunk in &chunks {
        let mut crc = flate2::Crc::new();
        crc.update(chunk);
        out.extend((chunk.len().saturating_sub(4) as u32).to_be_bytes());
        out.extend(chunk);
        out.extend(crc.sum().to_be_bytes());
    }
    out
}
