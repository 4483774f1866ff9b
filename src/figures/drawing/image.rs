//! Pictures within drawings, as the writers embed them.

use std::path::Path;

use crate::error::Result;
use crate::io::image::{RgbImage, png};

/// The digits of base 64 (RFC 4648, section 4).
const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// The picture as a PNG file.
///
/// # Errors
/// Sizes that PNG does not hold.
pub(super) fn png_of(image: &RgbImage) -> Result<Vec<u8>> {
    png::encode(
        Path::new("drawing"),
        image.width,
        image.height,
        &image.rgb,
        &[],
    )
}

/// Adds `bytes` in base 64: three bytes are four digits, the last ones filled up with `=`.
pub(crate) fn push_base64(text: &mut String, bytes: &[u8]) {
    for chunk in bytes.chunks(3) {
        let byte = |i: usize| u32::from(chunk.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            // Digits are of six bits, the highest first.
            let value = bits >> (18 - 6 * digit) & 63;
            // n bytes fill n + 1 digits.
            text.push(match digit <= chunk.len() {
                true => char::from(DIGITS[value as usize]),
                false => '=',
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::push_base64;

    #[test]
    fn base_64_is_that_of_rfc_4648() {
        for (bytes, expected) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foobar", "Zm9vYmFy"),
        ] {
            let mut text = String::new();
            push_base64(&mut text, bytes.as_bytes());
            assert_eq!(text, expected);
        }
    }
}
