//! Values of a diagram that are given in one of two ways: events, velocities, names.

use std::fmt;

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Error, IntoDeserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use crate::scene::{At, Number, Numbers, VelocityTable};
use crate::spacetime::units::Acceleration;

/// An event: its name, [ct, x], or [ct, x, y].
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
pub(super) enum Place {
    Name(String),
    At(Numbers<2>),
    Deep(Numbers<3>),
}

/// A velocity: β along the diagram's direction, or a table.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
pub(super) enum Speed {
    Beta(Number),
    Table(Box<VelocityTable>),
}

/// A proper acceleration: a number per unit of length, or with a unit of its own, like "1 g".
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
pub(super) enum ProperAcceleration {
    PerUnit(Number),
    Quantity(Acceleration),
}

impl ProperAcceleration {
    /// In 1/m (a/c²), where a number is one per `unit` metres, and light goes `c` metres in a second.
    pub fn per_metre(&self, unit: f64, c: f64) -> f64 {
        match self {
            ProperAcceleration::PerUnit(number) => number.0 / unit,
            ProperAcceleration::Quantity(quantity) => quantity.per_metre(c),
        }
    }
}

struct ProperAccelerationVisitor;

impl Visitor<'_> for ProperAccelerationVisitor {
    type Value = ProperAcceleration;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number (per unit of length) or a quantity like \"1 g\"")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<ProperAcceleration, E> {
        Number::deserialize(value.into_deserializer()).map(ProperAcceleration::PerUnit)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<ProperAcceleration, E> {
        Ok(ProperAcceleration::PerUnit(Number(value as f64)))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<ProperAcceleration, E> {
        let quantity = text.parse().map_err(E::custom)?;
        Ok(ProperAcceleration::Quantity(quantity))
    }
}

impl<'de> Deserialize<'de> for ProperAcceleration {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ProperAccelerationVisitor)
    }
}

/// One name, or several.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
pub(super) enum OneOrMany {
    One(String),
    Many(Vec<At<String>>),
}

struct PlaceVisitor;

impl<'de> Visitor<'de> for PlaceVisitor {
    type Value = Place;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the name of an event, [ct, x] or [ct, x, y]")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<Place, E> {
        Ok(Place::Name(name.to_string()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Place, A::Error> {
        let all: Vec<Number> = Vec::deserialize(SeqAccessDeserializer::new(seq))?;
        match all.as_slice() {
            [ct, x] => Ok(Place::At(Numbers([ct.0, x.0]))),
            [ct, x, y] => Ok(Place::Deep(Numbers([ct.0, x.0, y.0]))),
            other => Err(A::Error::invalid_length(other.len(), &self)),
        }
    }
}

impl<'de> Deserialize<'de> for Place {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(PlaceVisitor)
    }
}

struct SpeedVisitor;

impl<'de> Visitor<'de> for SpeedVisitor {
    type Value = Speed;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number (β) or a table like { gamma = 2 }")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Speed, E> {
        Number::deserialize(value.into_deserializer()).map(Speed::Beta)
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
