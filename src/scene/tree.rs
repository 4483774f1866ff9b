//! From a parsed TOML document to the structures of the file, each value with its place.
//!
//! A serde deserializer over toml_edit's document, which keeps the byte range of every key and value. The file has some two hundred types
//! that are read through it, so it is one concrete type and does nothing generic beyond calling their visitors: that takes a quarter of
//! the time to compile them through `toml`.

use std::fmt::Display;
use std::ops::Range;

use serde::de::value::StrDeserializer;
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error as _, IntoDeserializer, MapAccess, SeqAccess,
    Unexpected, VariantAccess, Visitor,
};
use serde::{Deserialize, forward_to_deserialize_any};
use toml_edit::{ArrayOfTables, Document, Item, TableLike, Value};

/// The name by which [`At`](super::at::At) requests a value with its place: start, end, value.
pub(super) const PLACED: &str = "nullray::At";

/// Why a text does not match the requested type, and where.
#[derive(Debug)]
pub(super) struct Mismatch {
    pub message: String,
    pub span: Option<Range<usize>>,
}

/// Reads `text` as a `T`.
pub(super) fn read<T: for<'a> Deserialize<'a>>(text: &str) -> Result<T, Mismatch> {
    let document = Document::parse(text).map_err(|error| Mismatch {
        message: match error.message() {
            "invalid mantissa, expected digits" | "invalid fraction, expected digits" => {
                "a number has digits on both sides of its point: 0.8, not .8 or 8.".into()
            }
            message => message.to_string(),
        },
        span: error.span(),
    })?;
    T::deserialize(Node {
        content: Content::Table(document.as_table()),
        span: 0..0,
    })
}

/// A value of the document.
#[derive(Clone)]
struct Node<'a> {
    content: Content<'a>,
    span: Range<usize>,
}

#[derive(Clone, Copy)]
enum Content<'a> {
    /// An end of a place.
    Bound(usize),
    Value(&'a Value),
    Table(&'a dyn TableLike),
    Tables(&'a ArrayOfTables),
}

impl<'a> Node<'a> {
    /// The node of `item`; values that are only implied by the text get the place of their key, `key`.
    fn of(item: &'a Item, key: Range<usize>) -> Option<Self> {
        let content = match item {
            Item::None => return None,
            Item::Value(Value::InlineTable(table)) => Content::Table(table),
            Item::Value(value) => Content::Value(value),
            Item::Table(table) => Content::Table(table),
            Item::ArrayOfTables(tables) => Content::Tables(tables),
        };
        let span = item.span().unwrap_or(key);
        Some(Node { content, span })
    }

    /// The value found, for messages about a type mismatch.
    fn unexpected(&self) -> Unexpected<'a> {
        match self.content {
            Content::Bound(bound) => Unexpected::Unsigned(bound as u64),
            Content::Table(_) | Content::Value(Value::InlineTable(_)) => Unexpected::Map,
            Content::Tables(_) | Content::Value(Value::Array(_)) => Unexpected::Seq,
            Content::Value(Value::String(text)) => Unexpected::Str(text.value()),
            Content::Value(Value::Integer(number)) => Unexpected::Signed(*number.value()),
            Content::Value(Value::Float(number)) => Unexpected::Float(*number.value()),
            Content::Value(Value::Boolean(flag)) => Unexpected::Bool(*flag.value()),
            Content::Value(Value::Datetime(_)) => Unexpected::Other("a date or time"),
        }
    }

    fn of_value(value: &'a Value) -> Self {
        let span = value.span().unwrap_or_default();
        let content = match value {
            Value::InlineTable(table) => Content::Table(table),
            value => Content::Value(value),
        };
        Node { content, span }
    }
}

impl serde::de::Error for Mismatch {
    fn custom<T: Display>(message: T) -> Self {
        Mismatch {
            message: message.to_string(),
            span: None,
        }
    }
}

impl Display for Mismatch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Mismatch {}

impl Mismatch {
    /// The same, at `span` unless its place is known more precisely.
    fn within(mut self, span: &Range<usize>) -> Self {
        self.span.get_or_insert_with(|| span.clone());
        self
    }
}

impl<'de> Deserializer<'de> for Node<'de> {
    type Error = Mismatch;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Mismatch> {
        let read = match self.content {
            Content::Bound(bound) => visitor.visit_u64(bound as u64),
            Content::Table(table) => visitor.visit_map(Entries::of(table)),
            Content::Tables(tables) => visitor.visit_seq(Elements::of_tables(tables)),
            Content::Value(Value::Array(array)) => visitor.visit_seq(Elements::of_array(array)),
            Content::Value(Value::String(text)) => visitor.visit_str(text.value()),
            Content::Value(Value::Integer(number)) => visitor.visit_i64(*number.value()),
            Content::Value(Value::Float(number)) => visitor.visit_f64(*number.value()),
            Content::Value(Value::Boolean(flag)) => visitor.visit_bool(*flag.value()),
            Content::Value(Value::Datetime(_) | Value::InlineTable(_)) => {
                Err(Mismatch::invalid_type(self.unexpected(), &visitor))
            }
        };
        read.map_err(|error| error.within(&self.span))
    }

    // Structures and lists have their own methods: with `deserialize_any` each of the file's types would be compiled with code to be read
    // from values of every kind.
    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Mismatch> {
        let read = match self.content {
            Content::Table(table) => visitor.visit_map(Entries::of(table)),
            _ => Err(Mismatch::invalid_type(self.unexpected(), &visitor)),
        };
        read.map_err(|error| error.within(&self.span))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Mismatch> {
        self.deserialize_map(visitor)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Mismatch> {
        let read = match self.content {
            Content::Tables(tables) => visitor.visit_seq(Elements::of_tables(tables)),
            Content::Value(Value::Array(array)) => visitor.visit_seq(Elements::of_array(array)),
            _ => Err(Mismatch::invalid_type(self.unexpected(), &visitor)),
        };
        read.map_err(|error| error.within(&self.span))
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        count: usize,
        visitor: V,
    ) -> Result<V::Value, Mismatch> {
        // Visitors stop after the last element that they know.
        match self.content {
            Content::Value(Value::Array(array)) if array.len() > count => {
                Err(Mismatch::invalid_length(array.len(), &visitor).within(&self.span))
            }
            _ => self.deserialize_seq(visitor),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Mismatch> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Mismatch> {
        visitor.visit_newtype_struct(self)
    }

    /// The only structures of this kind are values with their places.
    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: usize,
        visitor: V,
    ) -> Result<V::Value, Mismatch> {
        visitor.visit_seq(Placed {
            node: self,
            next: 0,
        })
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Mismatch> {
        let span = self.span.clone();
        let read = match self.content {
            Content::Value(Value::String(name)) => {
                let name: StrDeserializer<'_, Mismatch> = name.value().as_str().into_deserializer();
                visitor.visit_enum(name)
            }
            Content::Table(table) if table.len() == 1 => visitor.visit_enum(Entries::of(table)),
            _ => Err(Mismatch::custom("a text or a table of one key is expected")),
        };
        read.map_err(|error| error.within(&span))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit
        unit_struct identifier ignored_any
    }
}

/// A value with its place: its start, its end, itself.
struct Placed<'a> {
    node: Node<'a>,
    next: usize,
}

impl<'de> SeqAccess<'de> for Placed<'de> {
    type Error = Mismatch;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Mismatch> {
        self.next += 1;
        let mut part = self.node.clone();
        match self.next {
            1 => part.content = Content::Bound(part.span.start),
            2 => part.content = Content::Bound(part.span.end),
            _ => {}
        }
        seed.deserialize(part).map(Some)
    }
}

/// The elements of an array.
struct Elements<'a>(Box<dyn Iterator<Item = Node<'a>> + 'a>);

impl<'a> Elements<'a> {
    fn of_array(array: &'a toml_edit::Array) -> Self {
        Elements(Box::new(array.iter().map(Node::of_value)))
    }

    fn of_tables(tables: &'a ArrayOfTables) -> Self {
        Elements(Box::new(tables.iter().map(|table| Node {
            content: Content::Table(table),
            span: table.span().unwrap_or_default(),
        })))
    }
}

impl<'de> SeqAccess<'de> for Elements<'de> {
    type Error = Mismatch;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Mismatch> {
        self.0.next().map(|node| seed.deserialize(node)).transpose()
    }
}

/// The keys and values of a table, in the order of the text.
struct Entries<'a> {
    rest: Box<dyn Iterator<Item = (&'a str, Range<usize>, Node<'a>)> + 'a>,
    value: Option<Node<'a>>,
}

impl<'a> Entries<'a> {
    fn of(table: &'a dyn TableLike) -> Self {
        let entry = |(name, item): (&'a str, &'a Item)| {
            let key = table.key(name).and_then(|key| key.span());
            let key = key.unwrap_or_default();
            Some((name, key.clone(), Node::of(item, key)?))
        };
        Entries {
            rest: Box::new(table.iter().filter_map(entry)),
            value: None,
        }
    }
}

impl<'de> MapAccess<'de> for Entries<'de> {
    type Error = Mismatch;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Mismatch> {
        let Some((name, span, node)) = self.rest.next() else {
            return Ok(None);
        };
        self.value = Some(node);
        let key: StrDeserializer<'_, Mismatch> = name.into_deserializer();
        seed.deserialize(key)
            .map(Some)
            .map_err(|error| error.within(&span))
    }

    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, Mismatch> {
        let Some(node) = self.value.take() else {
            return Err(Mismatch::custom("a value without its key"));
        };
        let span = node.span.clone();
        seed.deserialize(node).map_err(|error| error.within(&span))
    }
}

impl<'de> EnumAccess<'de> for Entries<'de> {
    type Error = Mismatch;
    type Variant = Node<'de>;

    fn variant_seed<V: DeserializeSeed<'de>>(
        mut self,
        seed: V,
    ) -> Result<(V::Value, Node<'de>), Mismatch> {
        let variant = self.next_key_seed(seed)?;
        match (variant, self.value) {
            (Some(variant), Some(node)) => Ok((variant, node)),
            _ => Err(Mismatch::custom("a table of one key is expected")),
        }
    }
}

impl<'de> VariantAccess<'de> for Node<'de> {
    type Error = Mismatch;

    fn unit_variant(self) -> Result<(), Mismatch> {
        let error = Mismatch::custom("this takes no value: write it as a text");
        Err(error.within(&self.span))
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Mismatch> {
        let span = self.span.clone();
        seed.deserialize(self).map_err(|error| error.within(&span))
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, visitor: V) -> Result<V::Value, Mismatch> {
        self.deserialize_any(visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Mismatch> {
        self.deserialize_any(visitor)
    }
}
