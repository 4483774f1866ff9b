//! The leaves of a scene file: finite numbers, vectors, quantities. Each refuses invalid values at their place in the file, so that no
//! NaN, infinity or number without unit gets any further.

#[cfg(feature = "schema")]
use std::borrow::Cow;
use std::fmt;

use glam::DVec3;
#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::spacetime::units::{Dimension, LARGEST, Measure};

/// A finite number of magnitude at most 10³⁰.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Number(pub f64);

/// N finite numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Numbers<const N: usize>(pub [f64; N]);

/// Three finite numbers: a position in metres, a direction, a colour.
pub(crate) type Vector = Numbers<3>;

/// One number, or three.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum NumberOrVector {
    Number(f64),
    Vector([f64; 3]),
}

impl Vector {
    pub fn vec(self) -> DVec3 {
        DVec3::from_array(self.0)
    }
}

/// `value`, if it is finite and within range.
fn checked<E: Error>(value: f64) -> Result<f64, E> {
    if value.is_finite() && value.abs() <= LARGEST {
        Ok(value)
    } else if value.is_finite() {
        Err(E::custom(format!("{value:e} is beyond {LARGEST:e}")))
    } else {
        Err(E::custom(format!("{value} is not a finite number")))
    }
}

struct NumberVisitor;

impl Visitor<'_> for NumberVisitor {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<f64, E> {
        checked(value)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<f64, E> {
        // Above 2⁵³ this rounds, as a number with a decimal point would.
        checked(value as f64)
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<f64, E> {
        checked(value as f64)
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_f64(NumberVisitor).map(Number)
    }
}

/// Reads exactly N numbers.
fn array<'de, const N: usize, A: SeqAccess<'de>>(
    mut seq: A,
    expected: &dyn serde::de::Expected,
) -> Result<[f64; N], A::Error> {
    let mut values = [0.0; N];
    for (i, value) in values.iter_mut().enumerate() {
        let element: Option<Number> = seq.next_element()?;
        *value = element
            .ok_or_else(|| A::Error::invalid_length(i, expected))?
            .0;
    }
    // Reads to the end to count: the message gives the number of elements.
    let mut found = N;
    while seq.next_element::<Number>()?.is_some() {
        found += 1;
    }
    if found > N {
        return Err(A::Error::invalid_length(found, expected));
    }
    Ok(values)
}

struct NumbersVisitor<const N: usize>;

impl<'de, const N: usize> Visitor<'de> for NumbersVisitor<N> {
    type Value = Numbers<N>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "an array of {N} numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Numbers<N>, A::Error> {
        array(seq, &self).map(Numbers)
    }
}

impl<'de, const N: usize> Deserialize<'de> for Numbers<N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(NumbersVisitor)
    }
}

impl<const N: usize> Serialize for Numbers<N> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.as_slice().serialize(serializer)
    }
}

struct NumberOrVectorVisitor;

impl<'de> Visitor<'de> for NumberOrVectorVisitor {
    type Value = NumberOrVector;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or an array of 3 numbers")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<NumberOrVector, E> {
        checked(value).map(NumberOrVector::Number)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<NumberOrVector, E> {
        checked(value as f64).map(NumberOrVector::Number)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<NumberOrVector, A::Error> {
        array(seq, &self).map(NumberOrVector::Vector)
    }
}

impl<'de> Deserialize<'de> for NumberOrVector {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NumberOrVectorVisitor)
    }
}

impl Serialize for NumberOrVector {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            NumberOrVector::Number(value) => value.serialize(serializer),
            NumberOrVector::Vector(values) => values.serialize(serializer),
        }
    }
}

struct MeasureVisitor<D>(std::marker::PhantomData<D>);

impl<D: Dimension> Visitor<'_> for MeasureVisitor<D> {
    type Value = Measure<D>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let example = Measure::<D>::customary(2.5);
        write!(f, "{} as a text like \"{example}\"", D::NAME)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Measure<D>, E> {
        text.parse().map_err(E::custom)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Measure<D>, E> {
        Err(E::custom(Measure::<D>::without_unit(crate::error::number(
            value,
        ))))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Measure<D>, E> {
        Err(E::custom(Measure::<D>::without_unit(value)))
    }
}

impl<'de, D: Dimension> Deserialize<'de> for Measure<D> {
    fn deserialize<De: Deserializer<'de>>(deserializer: De) -> Result<Self, De::Error> {
        deserializer.deserialize_any(MeasureVisitor(std::marker::PhantomData))
    }
}

impl<D: Dimension> Serialize for Measure<D> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for Number {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "number".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "number" })
    }
}

#[cfg(feature = "schema")]
impl<const N: usize> JsonSchema for Numbers<N> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("{N} numbers").into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "array", "items": { "type": "number" }, "minItems": N, "maxItems": N })
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for NumberOrVector {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "number or vector".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let (one, three) = (
            Number::json_schema(generator),
            Vector::json_schema(generator),
        );
        json_schema!({ "anyOf": [one, three] })
    }
}

#[cfg(feature = "schema")]
impl<D: Dimension> JsonSchema for Measure<D> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        D::NAME.into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let units: Vec<String> = Self::spellings()
            .map(|unit| unit.replace('^', r"\^"))
            .collect();
        let number = r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?";
        let pattern = format!(r"^\s*{number}\s*({})\s*$", units.join("|"));
        json_schema!({ "type": "string", "pattern": pattern, "examples": [Self::customary(2.5)] })
    }
}
