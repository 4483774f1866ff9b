//! Encoded images, as stored in the file; they are decoded elsewhere, within limits.

use std::io::Read;

use ::gltf::json::{Index, image};

use super::buffers::{Buffers, Resource, resource, view_range};
use super::document::{Document, label};
use super::import::EncodedImage;
use crate::error::{Error, Result};

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
        (None, Some(uri)) => match resource(document, uri, &place).map_err(or_leave_out)? {
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
            remedy(bytes.starts_with(KTX)),
        )),
    }
}

/// The start of a KTX2 file.
const KTX: &[u8] = b"\xabKTX 20";

/// What to do about an image that is not read.
pub(super) fn remedy(is_ktx: bool) -> String {
    let convert = match is_ktx {
        true => "`gltf-transform ktxdecompress IN.glb OUT.glb`",
        false => "`gltf-transform png IN.glb OUT.glb --formats \"*\"`",
    };
    format!("store textures as PNG or JPEG, for example by {convert}{LEAVE_OUT}")
}

/// The other remedy.
const LEAVE_OUT: &str = "; bad_textures = \"drop\" leaves them out";

fn or_leave_out(mut error: Error) -> Error {
    if let Error::Invalid(problem) = &mut error {
        problem.help += LEAVE_OUT;
    }
    error
}

/// The warning about a texture that is dropped because of `what`.
pub(super) fn left_out(what: &str) -> String {
    format!("its texture is left out: {what}")
}

/// Whether an image has an alpha channel: a PNG of such a kind, or with a transparent colour.
pub(super) fn has_alpha(image: &EncodedImage) -> bool {
    let data = image.bytes.windows(4).position(|name| name == b"IDAT");
    let head = image
        .bytes
        .get(..data.unwrap_or_default())
        .unwrap_or_default();
    // The type of colours follows the signature, and the length, name, size and depth of the first chunk.
    let kind = head.get(25);
    kind.is_some_and(|kind| [4, 6].contains(kind)) || head.windows(4).any(|name| name == b"tRNS")
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
