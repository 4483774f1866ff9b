//! Decompression with a size limit.

use std::io::Read;

use flate2::read::{MultiGzDecoder, ZlibDecoder};

/// The problem with a chunk.
pub(super) type Broken = String;

/// Consecutive gzip streams.
pub(super) fn gzip(bytes: &[u8], most: u64) -> Result<Vec<u8>, Broken> {
    limited(MultiGzDecoder::new(bytes), most)
}

/// A zlib stream.
pub(super) fn zlib(bytes: &[u8], most: u64) -> Result<Vec<u8>, Broken> {
    limited(ZlibDecoder::new(bytes), most)
}

/// A zstd frame.
pub(super) fn zstd(bytes: &[u8], most: u64) -> Result<Vec<u8>, Broken> {
    let decoder = ruzstd::decoding::StreamingDecoder::new(bytes);
    limited(decoder.map_err(|e| format!("zstd: {e}"))?, most)
}

/// `length` bytes of an LZ4 block.
pub(super) fn lz4(block: &[u8], length: usize) -> Result<Vec<u8>, Broken> {
    lz4_flex::block::decompress(block, length).map_err(|e| format!("LZ4: {e}"))
}

/// The complete output of a decoder, if it is at most `most` bytes.
fn limited(decoder: impl Read, most: u64) -> Result<Vec<u8>, Broken> {
    let mut bytes = Vec::new();
    let read = decoder.take(most + 1).read_to_end(&mut bytes);
    match read {
        Ok(_) if bytes.len() as u64 <= most => Ok(bytes),
        Ok(_) => Err(format!("it decodes to more than {most} bytes")),
        Err(error) => Err(format!("it cannot be decoded: {error}")),
    }
}
