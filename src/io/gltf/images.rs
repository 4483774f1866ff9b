//! Encoded images, as stored in the file; they are decoded elsewhere, within limits.

use std::io::Read;

use ::gltf::json::{Index, image};

use super::buffers::{Buffers, Resource, resource, view_range};
use super::document::{Document, label};
use super::import::EncodedImage;
use crate::{Error, Result};

/// The maximum number of bytes of encoded images per import: several images may refer to the same bytes.
pub(super) const MOST_BYTES: u64 = 1 << 30;

/// The encoded bytes of image `index` of the document, at most `most` bytes.
pub(super) fn read(buffers: &mut Buffers, index: usize, most: u64) -> Result<EncodedImage> {
    let document = &*buffers.document;
    let number = Index::<image::Image>::new(u32::try_from(index).unwrap_or(u32::MAX));
    let image = document.get(number, "image", "images")?;
    let place = label("image", index, image.name.as_deref());
    let bytes = match (image.buffer_view, &image.uri) {
        (Some(view), _) => {
            let range = view_range(document, view, &place)?;
            check_size(document, range.length, most, &place)?;
            buffers.bytes(range, &place)?
        }
        (None, Some(uri)) => match resource(document, uri, &place)? {
            Resource::Data(bytes) => bytes,
            Resource::File(file, length) => {
                check_size(document, length, most, &place)?;
                let mut bytes = Vec::new();
                let read = file.take(length).read_to_end(&mut bytes);
                read.map_err(Error::io(&document.file, "cannot read an image"))?;
                bytes
            }
        },
        (None, None) => {
            let help = "an image has a bufferView or a uri";
            return Err(document.invalid(place, "it has no data", help));
        }
    };
    match media_type(&bytes) {
        Some(media_type) => Ok(EncodedImage {
            bytes,
            media_type,
            place,
        }),
        None => Err(buffers.document.unsupported(
            place,
            "it is neither PNG nor JPEG",
            "store textures as PNG or JPEG, the formats of glTF",
        )),
    }
}

fn check_size(document: &Document, bytes: u64, most: u64, place: &str) -> Result<()> {
    match bytes <= most {
        true => Ok(()),
        false => Err(document.unsupported(
            place,
            format!("including it, the images of the file have more than {MOST_BYTES} bytes"),
            "use smaller images, or import fewer nodes",
        )),
    }
}

/// From the first bytes: names and declared types are not reliable.
fn media_type(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n', ..] => Some("image/png"),
        [0xff, 0xd8, 0xff, ..] => Some("image/jpeg"),
        _ => None,
    }
}
