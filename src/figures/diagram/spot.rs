//! Values of a diagram that are said in one of two ways: events, velocities, names.

use std::fmt;

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::scene::{At, Number, Numbers, VelocityTable};

/// An event: its name, [ct, x], or [ct, x, y].
#[derive(Debug, Clone)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[cfg_attr(feature = "schema", schemars(untagged))]
pub(super) enum Spot {
    Name(String),
    At(Numbers<2>),
    Deep(Numbers<3>),
}

/// A velocity: β along the diagram's direction, or a table.
#[derive(Debug)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[cfg_attr(feature = "schema", schemars(untagged))]
pub(super) enum Speed {
    Beta(Number),
    Table(Box<VelocityTable>),
}

/// One name, or several.
#[derive(Debug)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[cfg_attr(feature = "schema", schemars(untagged))]
pub(super) enum OneOrMany {
    One(String),
    Many(Vec<At<String>>),
}

struct SpotVisitor;

impl<'de> Visitor<'de> for SpotVisitor {
    type Value = Spot;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the name of an event, [ct, x] or [ct, x, y]")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<Spot, E> {
        Ok(Spot::Name(name.to_string()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Spot, A::Error> {
        let all: Vec<Number> = Vec::deserialize(SeqAccessDeserializer::new(seq))?;
        match all.as_slice() {
            [ct, x] => Ok(Spot::At(Numbers([ct.0, x.0]))),
            [ct, x, y] => Ok(Spot::Deep(Numbers([ct.0, x.0, y.0]))),
            other => Err(A::Error::invalid_length(other.len(), &self)),
        }
    }
}

impl<'de> Deserialize<'de> for Spot {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(SpotVisitor)
    }
}

impl Serialize for Spot {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Spot::Name(name) => name.serialize(serializer),
            Spot::At(numbers) => numbers.serialize(serializer),
            Spot::Deep(numbers) => numbers.serialize(serializer),
        }
    }
}

struct SpeedVisitor;

impl<'de> Visitor<'de> for SpeedVisitor {
    type Value = Speed;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number (β) or a table like { gamma = 2 }")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Speed, E> {
        match value.is_finite() {
            true => Ok(Speed::Beta(Number(value))),
            false => Err(E::custom(format!("{value} is not a finite number"))),
        }
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Speed, E> {
        Ok(Speed::Beta(Number(value as f64)))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Speed, A::Error> {
        let table = VelocityTable::deserialize(MapAccessDeserializer::new(map))?;
        Ok(Speed::Table(Box::new(table)))
    }
}

impl<'de> Deserialize<'de> for Speed {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(SpeedVisitor)
    }
}

impl Serialize for Speed {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Speed::Beta(beta) => beta.serialize(serializer),
            Speed::Table(table) => table.serialize(serializer),
        }
    }
}

struct NamesVisitor;

impl<'de> Visitor<'de> for NamesVisitor {
    type Value = OneOrMany;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a name or a list of names")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<OneOrMany, E> {
        Ok(OneOrMany::One(name.to_string()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<OneOrMany, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(seq)).map(OneOrMany::Many)
    }
}

impl<'de> Deserialize<'de> for OneOrMany {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NamesVisitor)
    }
}

impl Serialize for OneOrMany {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            OneOrMany::One(name) => name.serialize(serializer),
            OneOrMany::Many(names) => names.serialize(serializer),
        }
    }
}
