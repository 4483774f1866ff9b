//! Reading checked accessors as f64, which holds every component exactly, piece by piece.

use ::gltf::json::accessor::ComponentType;

use super::buffers::{Buffers, Range};
use super::layout::{Format, Layout, Sparse, Strided};
use crate::Result;

/// Bytes that are read at a time.
const PIECE: u64 = 1 << 16;

impl Format {
    /// The component at the start of `bytes` (glTF 2.0 §3.6.2.2 and §3.11 for normalized ones).
    fn decode(self, bytes: &[u8]) -> f64 {
        let byte = |at: usize| bytes.get(at).copied().unwrap_or_default();
        let (two, four) = ([byte(0), byte(1)], [byte(0), byte(1), byte(2), byte(3)]);
        let (value, greatest) = match self.component {
            ComponentType::I8 => (f64::from(i8::from_le_bytes([byte(0)])), f64::from(i8::MAX)),
            ComponentType::U8 => (f64::from(byte(0)), f64::from(u8::MAX)),
            ComponentType::I16 => (f64::from(i16::from_le_bytes(two)), f64::from(i16::MAX)),
            ComponentType::U16 => (f64::from(u16::from_le_bytes(two)), f64::from(u16::MAX)),
            ComponentType::U32 => (f64::from(u32::from_le_bytes(four)), 1.0),
            ComponentType::F32 => (f64::from(f32::from_le_bytes(four)), 1.0),
        };
        match self.normalized {
            true => (value / greatest).max(-1.0),
            false => value,
        }
    }

    fn decode_all<const N: usize>(self, bytes: &[u8]) -> [f64; N] {
        let size = self.component.size();
        std::array::from_fn(|i| self.decode(bytes.get(i * size..).unwrap_or_default()))
    }
}

/// Gives every element of `layout` to `sink` with its index; an element that is sparse is given a
/// second time, with its final value.
pub(super) fn read<const N: usize>(
    buffers: &mut Buffers,
    layout: &Layout,
    sink: &mut dyn FnMut(u64, [f64; N]),
) -> Result<()> {
    match layout.dense {
        Some(dense) => each(buffers, dense, layout.format, layout, sink)?,
        None => (0..layout.count).for_each(|index| sink(index, [0.0; N])),
    }
    let Some(sparse) = &layout.sparse else {
        return Ok(());
    };
    let indices = sparse_indices(buffers, layout, sparse)?;
    each(
        buffers,
        sparse.values,
        layout.format,
        layout,
        &mut |at, value| {
            if let Some(&index) = usize::try_from(at).ok().and_then(|at| indices.get(at)) {
                sink(index, value);
            }
        },
    )
}

fn sparse_indices(buffers: &mut Buffers, layout: &Layout, sparse: &Sparse) -> Result<Vec<u64>> {
    let mut indices = Vec::<u64>::new();
    let mut bad = None;
    each::<1>(
        buffers,
        sparse.indices,
        sparse.index_format,
        layout,
        &mut |at, [index]| {
            let index = index as u64;
            if index >= layout.count || indices.last().is_some_and(|&last| last >= index) {
                bad.get_or_insert((at, index));
            }
            indices.push(index);
        },
    )?;
    match bad {
        None => Ok(indices),
        Some((at, index)) => Err(buffers.document.invalid(
            &layout.place,
            format!("sparse index {at} is {index}"),
            format!("sparse indices must increase and be below {}", layout.count),
        )),
    }
}

/// Reads strided elements piece by piece.
fn each<const N: usize>(
    buffers: &mut Buffers,
    from: Strided,
    format: Format,
    layout: &Layout,
    sink: &mut dyn FnMut(u64, [f64; N]),
) -> Result<()> {
    let element = format.size() * N as u64;
    let (stride, count) = (from.stride, (from.range.length - element) / from.stride + 1);
    let per_piece = (PIECE / stride).max(1);
    let mut piece = vec![0; (per_piece.min(count) * stride) as usize];
    let mut first = 0;
    while first < count {
        let elements = per_piece.min(count - first);
        let bytes = &mut piece[..((elements - 1) * stride + element) as usize];
        let range = Range {
            offset: from.range.offset + first * stride,
            ..from.range
        };
        buffers.fill(range, bytes, &layout.place)?;
        for (index, bytes) in (first..).zip(bytes.chunks(stride as usize)) {
            sink(index, format.decode_all(bytes));
        }
        first += elements;
    }
    Ok(())
}
