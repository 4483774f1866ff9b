//! Bytes of buffers, wherever they are stored. Only requested ranges are read, on demand, so that memory use depends on what is needed of a
//! file and not on what it declares.

use std::io::{Read, Seek, SeekFrom};

use ::gltf::json;

use super::document::Document;
use super::uri::{self, Target};
use crate::io::files::Reader;
use crate::io::open::open_regular;
use crate::spacetime::units::quoted;
use crate::{Error, Result};

/// A range of a buffer that has been checked against the document.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Range {
    pub buffer: usize,
    pub offset: u64,
    pub length: u64,
}

/// The buffers of a document, opened when first used.
pub(super) struct Buffers<'d, 'a> {
    pub document: &'d mut Document<'a>,
    opened: Vec<Option<Blob>>,
}

enum Blob {
    /// In the document's own storage, at this offset.
    Chunk(u64),
    File(Reader),
    Memory(Vec<u8>),
}

/// The range of buffer view `view`, checked against its buffer's declared length.
pub(super) fn view_range(
    document: &Document,
    view: json::Index<json::buffer::View>,
    place: &str,
) -> Result<Range> {
    let description = document.get(view, "buffer view", place)?;
    let place = format!("{place}, buffer view {}", view.value());
    let buffer = document.get(description.buffer, "buffer", &place)?;
    let offset = description.byte_offset.unwrap_or_default().0;
    let length = description.byte_length.0;
    match offset.checked_add(length) {
        Some(end) if end <= buffer.byte_length.0 => Ok(Range {
            buffer: description.buffer.value(),
            offset,
            length,
        }),
        _ => Err(document.invalid(
            place,
            format!(
                "{length} bytes from byte {offset} go beyond the {} bytes of buffer {}",
                buffer.byte_length.0,
                description.buffer.value()
            ),
            "export the file again; byteOffset + byteLength must be within the buffer",
        )),
    }
}

impl<'d, 'a> Buffers<'d, 'a> {
    pub fn new(document: &'d mut Document<'a>) -> Self {
        Buffers {
            document,
            opened: Vec::new(),
        }
    }

    /// Fills `bytes` with data from `range.offset` on.
    pub fn fill(&mut self, range: Range, bytes: &mut [u8], place: &str) -> Result<()> {
        if self.opened.len() <= range.buffer {
            self.opened.resize_with(range.buffer + 1, || None);
        }
        if matches!(self.opened.get(range.buffer), Some(None)) {
            let blob = self.open(range.buffer, place)?;
            self.opened[range.buffer] = Some(blob);
        }
        let read = match self.opened.get_mut(range.buffer) {
            Some(Some(Blob::Chunk(start))) => {
                read_at(&mut *self.document.storage, *start + range.offset, bytes)
            }
            Some(Some(Blob::File(file))) => read_at(file, range.offset, bytes),
            Some(Some(Blob::Memory(data))) => {
                read_at(&mut std::io::Cursor::new(&*data), range.offset, bytes)
            }
            _ => Ok(()),
        };
        read.map_err(Error::io(&self.document.file, "cannot read a buffer"))
    }

    /// The bytes of a whole range, for example of an image.
    pub fn bytes(&mut self, range: Range, place: &str) -> Result<Vec<u8>> {
        // Opening checks the declared length against the real one before memory is allocated.
        self.fill(Range { length: 0, ..range }, &mut [], place)?;
        let length = usize::try_from(range.length).unwrap_or(usize::MAX);
        let mut bytes = Vec::new();
        bytes.try_reserve_exact(length).map_err(|_| {
            let what = format!("there is not enough memory for {length} bytes");
            self.document
                .unsupported(place, what, "use a smaller image")
        })?;
        bytes.resize(length, 0);
        self.fill(range, &mut bytes, place)?;
        Ok(bytes)
    }

    /// The location of the bytes of a buffer: in memory, in a separate file, or in the GLB's chunk, which only buffer 0 may use.
    fn open(&self, index: usize, place: &str) -> Result<Blob> {
        let document = &*self.document;
        let place = format!("{place}, buffer {index}");
        let Some(buffer) = document.root.buffers.get(index) else {
            return Err(document.invalid(place, "there is no such buffer", ""));
        };
        let (blob, length) = match (&buffer.uri, document.bin) {
            (Some(uri), _) => match resource(document, uri, &place)? {
                Resource::Data(data) => {
                    let length = data.len() as u64;
                    (Blob::Memory(data), length)
                }
                Resource::File(file, length) => (Blob::File(file), length),
            },
            (None, Some((offset, length))) if index == 0 => (Blob::Chunk(offset), length),
            (None, _) => {
                return Err(document.invalid(
                    place,
                    "the buffer has no data: it has no uri, and no binary chunk belongs to it",
                    "export the file again, as .glb or with its .bin file",
                ));
            }
        };
        match buffer.byte_length.0 <= length {
            true => Ok(blob),
            false => Err(document.invalid(
                place,
                format!(
                    "it should have {} bytes and has {length}",
                    buffer.byte_length.0
                ),
                "the data are truncated: copy the file with its data again, or export it again",
            )),
        }
    }
}

fn read_at(
    data: &mut (impl Read + Seek + ?Sized),
    at: u64,
    bytes: &mut [u8],
) -> std::io::Result<()> {
    data.seek(SeekFrom::Start(at))?;
    data.read_exact(bytes)
}

/// The resource at a URI: data, or an open file and its length.
pub(super) enum Resource {
    Data(Vec<u8>),
    File(Reader, u64),
}

/// Resolves `uri` against the document's directory.
pub(super) fn resource(document: &Document, uri: &str, place: &str) -> Result<Resource> {
    let target = uri::parse(uri).map_err(|bad| document.invalid(place, bad.what, bad.help))?;
    let relative = match target {
        Target::Data(data) => return Ok(Resource::Data(data)),
        Target::File(relative) => relative,
    };
    let Some(directory) = &document.directory else {
        let what = format!("it refers to the file {}", quoted(uri));
        let help = "a document in memory must embed its data";
        return Err(document.invalid(place, what, help));
    };
    let path = directory.join(relative);
    open_regular(&path)
        .map(|(file, length)| Resource::File(file, length))
        .map_err(|error| {
            document.invalid(
                place,
                format!("its data cannot be read: {error}"),
                format!("the file must be at {}", path.display()),
            )
        })
}
