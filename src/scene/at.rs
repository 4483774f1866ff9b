//! A value and its place in the file.
//!
//! Tagged, untagged and flattened enums of serde lose places, because they buffer what they read; so the structs of the file format are
//! plain, and alternatives are distinguished when they are resolved.

#[cfg(feature = "schema")]
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;
use std::ops::Range;

#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::tree::PLACED;

/// A value and its byte range in the text; for a table with a header, the range of the header.
#[derive(Debug, Clone)]
pub(crate) struct At<T> {
    pub value: T,
    pub span: Range<usize>,
}

impl<T> At<T> {
    /// A default, which has no place in the text.
    pub fn nowhere(value: T) -> Self {
        At { value, span: 0..0 }
    }

    /// Its place in the text, if it has one.
    pub fn span_of(at: &Option<Self>) -> Option<&Range<usize>> {
        at.as_ref().map(|at| &at.span)
    }

    /// Whether it is in the text.
    pub fn is_given(&self) -> bool {
        !self.span.is_empty()
    }
}

impl<T: Default> Default for At<T> {
    fn default() -> Self {
        At::nowhere(T::default())
    }
}

/// Requests start, end and value from [`tree`](super::tree).
impl<'de, T: Deserialize<'de>> Deserialize<'de> for At<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_tuple_struct(PLACED, 3, AtVisitor(PhantomData))
    }
}

struct AtVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for AtVisitor<T> {
    type Value = At<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value of a scene file")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<At<T>, A::Error> {
        let span = span(&mut seq)?;
        match seq.next_element()? {
            Some(value) => Ok(At { value, span }),
            None => Err(A::Error::invalid_length(2, &self)),
        }
    }
}

/// Start and end; separate from the value, so that it is compiled only once.
fn span<'de, A: SeqAccess<'de>>(seq: &mut A) -> Result<Range<usize>, A::Error> {
    match (seq.next_element()?, seq.next_element()?) {
        (Some(start), Some(end)) => Ok(start..end),
        _ => Err(A::Error::custom("a value without its place")),
    }
}

impl<T: Serialize> Serialize for At<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.value.serialize(serializer)
    }
}

/// The schema is that of the value alone.
#[cfg(feature = "schema")]
impl<T: JsonSchema> JsonSchema for At<T> {
    fn inline_schema() -> bool {
        T::inline_schema()
    }

    fn schema_name() -> Cow<'static, str> {
        T::schema_name()
    }

    fn schema_id() -> Cow<'static, str> {
        T::schema_id()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        T::json_schema(generator)
    }
}
