//! Checked accessors (glTF 2.0 §3.6.2): typed arrays in buffers, before anything is read.
//!
//! A [`Layout`] is an accessor whose every byte is known to lie inside its buffer views, and those
//! inside the declared lengths of their buffers. Only layouts are read.

use ::gltf::json::accessor::{Accessor, ComponentType, Type, sparse};
use ::gltf::json::validation::Checked;
use ::gltf::json::{self};

use super::buffers::{Range, view_range};
use super::document::Document;
use crate::Result;

const EXPORT_AGAIN: &str = "export the file again; a validator of glTF tells more";

/// What an accessor is for, which decides the types that it may have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Purpose {
    Positions,
    TexCoords,
    Indices,
}

/// A checked accessor.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    /// Its index in the document.
    pub accessor: usize,
    /// How many elements, at least 1.
    pub count: u64,
    /// Where it stands, for messages: `mesh 2 "wheel", primitive 0, accessor 5`.
    pub place: String,
    pub format: Format,
    /// Zeros where absent (which only a sparse accessor may be).
    pub dense: Option<Strided>,
    pub sparse: Option<Sparse>,
}

/// What an element is made of.
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
        let dense = match self.accessor.buffer_view {
            Some(view) => {
                let offset = self.accessor.byte_offset.unwrap_or_default().0;
                Some(self.strided(view, offset, count, element)?)
            }
            None if self.accessor.sparse.is_some() => None,
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

    fn format(&self, purpose: Purpose) -> Result<Format> {
        use ComponentType::{F32, I8, I16, U8, U16, U32};
        let (Checked::Valid(kind), Checked::Valid(component)) =
            (&self.accessor.type_, &self.accessor.component_type)
        else {
            return Err(self.invalid("its type or componentType is not of glTF", EXPORT_AGAIN));
        };
        let (component, normalized) = (component.0, self.accessor.normalized);
        let quantized = self.document.uses("KHR_mesh_quantization");
        let (right, needed) = match (purpose, component) {
            (Purpose::Indices, U8 | U16 | U32) => (*kind == Type::Scalar && !normalized, ""),
            (Purpose::Positions, F32) => (*kind == Type::Vec3 && !normalized, ""),
            (Purpose::Positions, I8 | U8 | I16 | U16) => (*kind == Type::Vec3 && quantized, Q),
            (Purpose::TexCoords, F32) => (*kind == Type::Vec2 && !normalized, ""),
            (Purpose::TexCoords, U8 | U16) if normalized => (*kind == Type::Vec2, ""),
            (Purpose::TexCoords, I8 | U8 | I16 | U16) => (*kind == Type::Vec2 && quantized, Q),
            _ => (false, ""),
        };
        match right {
            true => Ok(Format {
                component,
                normalized,
            }),
            false => Err(self.invalid(
                &format!(
                    "{} of type {kind:?}, component type {component:?}{} are not of glTF{needed}",
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
        if stride < element || stride > element.max(252) {
            let what = format!("elements of {element} bytes lie {stride} bytes apart");
            return Err(self.invalid(&what, "byteStride must be from the element's size to 252"));
        }
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
            return Err(self.invalid("its sparse indices are of no type of glTF", EXPORT_AGAIN));
        };
        let index_format = Format {
            component: index.0,
            normalized: false,
        };
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

/// The end of a message about integers as coordinates.
const Q: &str = " without KHR_mesh_quantization";

impl Purpose {
    fn components(self) -> u64 {
        match self {
            Purpose::Positions => 3,
            Purpose::TexCoords => 2,
            Purpose::Indices => 1,
        }
    }

    fn plural(self) -> &'static str {
        match self {
            Purpose::Positions => "positions",
            Purpose::TexCoords => "texture coordinates",
            Purpose::Indices => "indices",
        }
    }

    fn right_types(self) -> &'static str {
        match self {
            Purpose::Positions => "positions are VEC3 of FLOAT",
            Purpose::TexCoords => "they are VEC2 of FLOAT or normalized UNSIGNED_BYTE or _SHORT",
            Purpose::Indices => "indices are SCALAR of UNSIGNED_BYTE, UNSIGNED_SHORT or _INT",
        }
    }
}

impl Format {
    /// Bytes of a component.
    pub fn size(self) -> u64 {
        self.component.size() as u64
    }
}
