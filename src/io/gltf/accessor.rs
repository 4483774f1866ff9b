//! Accessors (glTF 2.0 §3.6.2): typed arrays in buffers, checked before anything is read, then read as f64, which holds every component
//! exactly.
//!
//! A [`Layout`] is an accessor whose bytes are all known to be inside its buffer views, which in turn are inside the declared lengths of
//! their buffers. Only layouts are read.

use ::gltf::json::accessor::{Accessor, ComponentType, Type, sparse};
use ::gltf::json::validation::Checked;
use ::gltf::json::{self};

use super::buffers::{Buffers, Range, view_range};
use super::document::Document;
use crate::Result;

/// The number of bytes read at a time.
const PIECE: u64 = 1 << 16;

/// The number of elements without data that any accessor may have, and the number it may have per stored element: in a mesh they are all at
/// one point.
const FEW_ZEROS: u64 = 1 << 20;
const ZEROS_OF_ONE: u64 = 64;

const EXPORT_AGAIN: &str = "export the file again; a validator of glTF tells more";

/// The purpose of an accessor, which determines its allowed types.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Purpose {
    Positions,
    TexCoords,
    Normals,
    /// RGB, or RGBA if `alpha` is set.
    Colours {
        alpha: bool,
    },
    Indices,
    /// Translations and scales.
    Vectors,
    /// Quaternions.
    Rotations,
    /// Keyframe times of an animation, seconds.
    Times,
    /// Displacements of positions by a morph target.
    Displacements,
    /// Displacements of normals by a morph target.
    Tilts,
    /// Numbers of joints in a skin.
    Joints,
    /// Weights of these joints.
    Weights,
    /// Inverse bind matrices of a skin.
    Matrices,
}

/// A checked accessor.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    /// Its index in the document.
    pub accessor: usize,
    /// The number of elements, at least 1.
    pub count: u64,
    /// Where it is in the file, for messages: `mesh 2 "wheel", primitive 0, accessor 5`.
    pub place: String,
    pub format: Format,
    /// Dense elements; zeros if absent, which is allowed only for sparse accessors.
    pub dense: Option<Strided>,
    pub sparse: Option<Sparse>,
}

/// The format of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Format {
    pub component: ComponentType,
    pub normalized: bool,
}

/// Elements at equal distances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Strided {
    pub range: Range,
    /// Bytes from one element to the next.
    pub stride: u64,
}

/// Elements that replace some of the dense ones.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sparse {
    pub index_format: Format,
    pub indices: Strided,
    pub values: Strided,
}

impl Layout {
    /// Checks accessor `index` for `purpose`; `place` is that of the primitive.
    pub fn new(
        document: &Document,
        index: json::Index<Accessor>,
        purpose: Purpose,
        place: &str,
    ) -> Result<Layout> {
        let accessor = document.get(index, "accessor", place)?;
        let check = Check {
            document,
            accessor,
            place: format!("{place}, accessor {}", index.value()),
        };
        check.layout(index.value(), purpose)
    }
}

struct Check<'c, 'a> {
    document: &'c Document<'a>,
    accessor: &'c Accessor,
    place: String,
}

impl Check<'_, '_> {
    fn layout(self, index: usize, purpose: Purpose) -> Result<Layout> {
        let format = self.format(purpose)?;
        let element = format.size() * purpose.components();
        let count = self.accessor.count.0;
        if count == 0 {
            return Err(self.invalid("it has no elements", "count must be at least 1"));
        }
        // Without a buffer view elements are zeros (§3.6.2.3). That makes sense for vertex attributes other than positions: there are no
        // more of them than positions, which have data. For all others, some elements must be replaced by sparse ones.
        let dense = match self.accessor.buffer_view {
            Some(view) => {
                let offset = self.accessor.byte_offset.unwrap_or_default().0;
                Some(self.strided(view, offset, count, element)?)
            }
            None if let Some(sparse) = &self.accessor.sparse => {
                self.check_zeros(count, sparse.count.0)?;
                None
            }
            // Zeros, for as many vertices as there are positions in the file.
            None if purpose.may_be_zero() => None,
            None => return Err(self.invalid("it has no data: no bufferView", EXPORT_AGAIN)),
        };
        let sparse = match &self.accessor.sparse {
            Some(sparse) => Some(self.sparse(sparse, count, element)?),
            None => None,
        };
        Ok(Layout {
            accessor: index,
            count,
            place: self.place,
            format,
            dense,
            sparse,
        })
    }

    /// Refuses implausible numbers of zeros, which cost memory but no bytes of the file.
    fn check_zeros(&self, count: u64, given: u64) -> Result<()> {
        if count <= FEW_ZEROS.max(given.saturating_mul(ZEROS_OF_ONE)) {
            return Ok(());
        }
        let what =
            format!("of its {count} elements {given} are given, and no bufferView has the others");
        let help = format!("at most {FEW_ZEROS} elements, or {ZEROS_OF_ONE} per stored element");
        Err(self.invalid(&what, &help))
    }

    fn format(&self, purpose: Purpose) -> Result<Format> {
        use ComponentType::{F32, I8, I16, U8, U16, U32};
        let (Checked::Valid(kind), Checked::Valid(component)) =
            (&self.accessor.type_, &self.accessor.component_type)
        else {
            return Err(self.invalid(
                "its type or componentType is not valid in glTF",
                EXPORT_AGAIN,
            ));
        };
        let (component, normalized) = (component.0, self.accessor.normalized);
        // Types by purpose: those of §3.7.2.1 and §3.11, extended by KHR_mesh_quantization.
        let quantized = self.document.uses("KHR_mesh_quantization");
        let (right, needed) = match (purpose, component) {
            (Purpose::Indices, U8 | U16 | U32) => (*kind == Type::Scalar && !normalized, ""),
            (Purpose::Positions, F32) => (*kind == Type::Vec3 && !normalized, ""),
            (Purpose::Positions, I8 | U8 | I16 | U16) => (*kind == Type::Vec3 && quantized, Q),
            (Purpose::TexCoords, F32) => (*kind == Type::Vec2 && !normalized, ""),
            (Purpose::TexCoords, U8 | U16) if normalized => (*kind == Type::Vec2, ""),
            (Purpose::TexCoords, I8 | U8 | I16 | U16) => (*kind == Type::Vec2 && quantized, Q),
            (Purpose::Normals, F32) => (*kind == Type::Vec3 && !normalized, ""),
            (Purpose::Normals, I8 | I16) if normalized => (*kind == Type::Vec3 && quantized, Q),
            (Purpose::Colours { alpha }, F32 | U8 | U16) => {
                let right = if alpha { Type::Vec4 } else { Type::Vec3 };
                (*kind == right && normalized == (component != F32), "")
            }
            (Purpose::Vectors, F32) => (*kind == Type::Vec3 && !normalized, ""),
            (Purpose::Times, F32) => (*kind == Type::Scalar && !normalized, ""),
            (Purpose::Displacements, F32) => (*kind == Type::Vec3 && !normalized, ""),
            (Purpose::Displacements, I8 | I16) => (*kind == Type::Vec3 && quantized, Q),
            (Purpose::Tilts, F32) => (*kind == Type::Vec3 && !normalized, ""),
            (Purpose::Tilts, I8 | I16) if normalized => (*kind == Type::Vec3 && quantized, Q),
            (Purpose::Joints, U8 | U16) => (*kind == Type::Vec4 && !normalized, ""),
            (Purpose::Weights, F32 | U8 | U16) => {
                (*kind == Type::Vec4 && normalized == (component != F32), "")
            }
            (Purpose::Matrices, F32) => (*kind == Type::Mat4 && !normalized, ""),
            (Purpose::Rotations, F32) => (*kind == Type::Vec4 && !normalized, ""),
            (Purpose::Rotations, I8 | I16) => (*kind == Type::Vec4 && normalized, ""),
            _ => (false, ""),
        };
        match right {
            true => Ok(Format {
                component,
                normalized,
            }),
            false => Err(self.invalid(
                &format!(
                    "{} of type {kind:?}, component type {component:?}{} are not valid in glTF{needed}",
                    purpose.plural(),
                    if normalized { ", normalized" } else { "" },
                ),
                purpose.right_types(),
            )),
        }
    }

    fn strided(
        &self,
        view: json::Index<json::buffer::View>,
        offset: u64,
        count: u64,
        element: u64,
    ) -> Result<Strided> {
        let range = view_range(self.document, view, &self.place)?;
        let stride = self
            .document
            .get(view, "buffer view", &self.place)?
            .byte_stride;
        let stride = stride.map_or(element, |stride| stride.0 as u64);
        // The specification allows at most 252. Overlapping elements would let a small file declare a large mesh.
        if stride < element || stride > element.max(252) {
            let what = format!("elements of {element} bytes lie {stride} bytes apart");
            return Err(self.invalid(&what, "byteStride must be from the element's size to 252"));
        }
        // The last element needs no stride after it. Counts in hostile files may overflow.
        let needed = (count - 1)
            .checked_mul(stride)
            .and_then(|bytes| bytes.checked_add(element))
            .and_then(|bytes| bytes.checked_add(offset));
        match needed {
            Some(needed) if needed <= range.length => Ok(Strided {
                range: Range {
                    offset: range.offset + offset,
                    length: needed - offset,
                    ..range
                },
                stride,
            }),
            _ => Err(self.invalid(
                &format!(
                    "{count} elements of {element} bytes from byte {offset} go beyond the {} bytes \
                     of buffer view {}",
                    range.length,
                    view.value()
                ),
                EXPORT_AGAIN,
            )),
        }
    }

    fn sparse(&self, sparse: &sparse::Sparse, of: u64, element: u64) -> Result<Sparse> {
        let count = sparse.count.0;
        if count == 0 || count > of {
            let what = format!("{count} of its {of} elements are sparse");
            return Err(self.invalid(&what, "sparse.count must be from 1 to count"));
        }
        let Checked::Valid(index) = sparse.indices.component_type else {
            return Err(self.invalid(
                "the type of its sparse indices is not valid in glTF",
                EXPORT_AGAIN,
            ));
        };
        let index_format = Format {
            component: index.0,
            normalized: false,
        };
        // Values have the format of the accessor, indices their own format, and both are packed.
        let (indices, values) = (&sparse.indices, &sparse.values);
        Ok(Sparse {
            index_format,
            indices: self.strided(
                indices.buffer_view,
                indices.byte_offset.0,
                count,
                index_format.size(),
            )?,
            values: self.strided(values.buffer_view, values.byte_offset.0, count, element)?,
        })
    }

    fn invalid(&self, what: &str, help: &str) -> crate::Error {
        self.document.invalid(&self.place, what, help)
    }
}

/// The end of a message about integer coordinates.
const Q: &str = " without KHR_mesh_quantization";

impl Purpose {
    fn components(self) -> u64 {
        match self {
            Purpose::Positions | Purpose::Normals | Purpose::Vectors => 3,
            Purpose::Displacements | Purpose::Tilts => 3,
            Purpose::Rotations | Purpose::Joints | Purpose::Weights => 4,
            Purpose::Matrices => 16,
            Purpose::TexCoords => 2,
            Purpose::Colours { alpha } => 3 + u64::from(alpha),
            Purpose::Indices | Purpose::Times => 1,
        }
    }

    /// Whether its elements may be zeros without data.
    fn may_be_zero(self) -> bool {
        matches!(
            self,
            Purpose::TexCoords
                | Purpose::Normals
                | Purpose::Colours { .. }
                | Purpose::Displacements
                | Purpose::Tilts
        )
    }

    fn plural(self) -> &'static str {
        match self {
            Purpose::Positions => "positions",
            Purpose::TexCoords => "texture coordinates",
            Purpose::Normals => "normals",
            Purpose::Colours { .. } => "vertex colours",
            Purpose::Indices => "indices",
            Purpose::Vectors => "translations or scales",
            Purpose::Rotations => "rotations",
            Purpose::Times => "times",
            Purpose::Displacements => "displacements of positions",
            Purpose::Tilts => "displacements of normals",
            Purpose::Joints => "joints",
            Purpose::Weights => "weights of joints",
            Purpose::Matrices => "inverse bind matrices",
        }
    }

    fn right_types(self) -> &'static str {
        match self {
            Purpose::Positions => "positions are VEC3 of FLOAT",
            Purpose::Normals => "normals are VEC3 of FLOAT",
            Purpose::TexCoords => "they are VEC2 of FLOAT or normalized UNSIGNED_BYTE or _SHORT",
            Purpose::Colours { .. } => {
                "they are VEC3 or VEC4 of FLOAT or normalized UNSIGNED_BYTE or _SHORT"
            }
            Purpose::Vectors | Purpose::Displacements | Purpose::Tilts => "they are VEC3 of FLOAT",
            Purpose::Joints => "they are VEC4 of UNSIGNED_BYTE or _SHORT",
            Purpose::Weights => "they are VEC4 of FLOAT or normalized UNSIGNED_BYTE or _SHORT",
            Purpose::Matrices => "they are MAT4 of FLOAT",
            Purpose::Rotations => "they are VEC4 of FLOAT or normalized BYTE or SHORT",
            Purpose::Times => "times are SCALAR of FLOAT",
            Purpose::Indices => "indices are SCALAR of UNSIGNED_BYTE, UNSIGNED_SHORT or _INT",
        }
    }
}

impl Format {
    /// Bytes per component.
    pub fn size(self) -> u64 {
        self.component.size() as u64
    }

    /// The component at the start of `bytes` (glTF 2.0 §3.6.2.2 and §3.11 for normalized ones).
    fn decode(self, bytes: &[u8]) -> f64 {
        // Little-endian. A normalized integer maps its greatest value to 1, and is at least −1: both −127 and −128 become −1.
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

/// Passes every element of `layout` to `sink`, with its index; a sparse element is passed a second time, with its final value.
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
    // Indices fit in memory: there are no more than elements, for which the caller has a budget.
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
            // Only the first bad index is reported. Reading continues, as `each` cannot be stopped from here.
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
    // As many whole elements as fit in a piece, so that memory does not grow with the file.
    let element = format.size() * N as u64;
    let (stride, count) = (from.stride, (from.range.length - element) / from.stride + 1);
    let per_piece = (PIECE / stride).max(1);
    let mut piece = vec![0; (per_piece.min(count) * stride) as usize];
    let mut first = 0;
    while first < count {
        let elements = per_piece.min(count - first);
        // The buffer may end with the last element: do not read beyond it.
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
