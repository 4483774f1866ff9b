//! What compressed bytes decode to, within a limit.

use std::io::Read;

use flate2::read::{MultiGzDecoder, ZlibDecoder};

/// What is wrong with a chunk.
pub(super) type Broken = String;

/// Streams of gzip, one after the other.
pub(super) fn gzip(bytes: &[u8], most: u64) -> Result<Vec<u8>, Broken> {
    limited(MultiGzDecoder::new(bytes), most)
}

/// A stream of zlib.
pub(super) fn zlib(bytes: &[u8], most: u64) -> Result<Vec<u8>, Broken> {
    limited(ZlibDecoder::new(bytes), most)
}

/// A frame of zstd.
pub(super) fn zstd(bytes: &[u8], most: u64) -> Result<Vec<u8>, Broken> {
    let decoder = ruzstd::decoding::StreamingDecoder::new(bytes);
    limited(decoder.map_err(|e| format!("zstd: {e}"))?, most)
}

/// `length` bytes of a block of LZ4.
pub(super) fn lz4(block: &[u8], length: usize) -> Result<Vec<u8>, Broken> {
    lz4_flex::block::decompress(block, length).map_err(|e| format!("LZ4: {e}"))
}

/// All that a decoder gives, if that is no more than `most` bytes.
fn limited(decoder: impl Read, most: u64) -> Result<Vec<u8>, Broken> {
    let mut bytes = Vec::new();
    let read = decoder.take(most + 1).read_to_end(&mut bytes);
    match read {
        Ok(_) if bytes.len() as u64 <= most => Ok(bytes),
        Ok(_) => Err(format!("it decodes to more than {most} bytes")),
        Err(error) => Err(format!("it cannot be decoded: {error}")),
    }
}
