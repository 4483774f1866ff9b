//! The regimes that are compared with arbitrary precision.

use super::measures;
use super::rows::{Fine, Row, embedded};
use super::{Check, Outcome};

/// A regime with references.
#[derive(Debug)]
#[non_exhaustive]
pub struct Regime {
    /// See [`Check`].
    pub name: &'static str,
    /// See [`Check`].
    pub what: &'static str,
    /// See [`Check`].
    pub unit: &'static str,
    /// See [`Check`].
    pub bound: f64,
    /// The families of rows that belong to it.
    pub families: &'static [&'static str],
    measure: fn(&[f64], &[Fine]) -> f64,
}

impl Regime {
    /// The error of this crate's result for `row`, in the regime's unit.
    pub fn error(&self, row: &Row) -> f64 {
        (self.measure)(&row.inputs, &row.reference)
    }

    /// The embedded rows that belong to it.
    pub fn rows(&self) -> impl Iterator<Item = &'static Row> {
        embedded()
            .iter()
            .filter(|row| self.families.contains(&row.family.as_str()))
    }

    /// The largest error of `rows`.
    pub fn worst<'r>(&self, rows: impl Iterator<Item = &'r Row>) -> Outcome {
        let none = Outcome {
            worst: 0.0,
            cases: 0,
        };
        rows.fold(none, |outcome, row| Outcome {
            worst: outcome.worst.max(self.error(row)),
            cases: outcome.cases + 1,
        })
    }
}

const LOOKS: &[&str] = &["look-1e4", "look-1e8", "look-1e12", "look-end"];
const RATIO: &str = "eps × conditioning";

/// All of them; the bounds are derived at the head of `measures`.
pub static REGIMES: [Regime; 14] = [
    Regime {
        name: "aberration",
        what: "look directions at any angle to β, and within 1e-12 of ±β, γ to 1e17",
        unit: RATIO,
        bound: 16.0,
        families: LOOKS,
        measure: measures::aberration,
    },
    Regime {
        name: "wavelength",
        what: "wavelength ratios of the same",
        unit: RATIO,
        bound: 16.0,
        families: LOOKS,
        measure: measures::wavelength,
    },
    Regime {
        name: "picture-1e4",
        what: "the picture, γ to 1e4",
        unit: "pixel",
        bound: 1.6e-8,
        families: &["look-1e4"],
        measure: measures::picture,
    },
    Regime {
        name: "picture-1e8",
        what: "the picture, γ to 1e8",
        unit: "pixel",
        bound: 1.6e-4,
        families: &["look-1e8"],
        measure: measures::picture,
    },
    Regime {
        name: "picture-1e12",
        what: "the picture, γ to 1e12",
        unit: "pixel",
        bound: 1.6,
        families: &["look-1e12"],
        measure: measures::picture,
    },
    Regime {
        name: "events",
        what: "events in other frames: times to 1e6 s (3e14 m), places to 1e9 m, γ to 1e12",
        unit: "eps (1 + φ) of the terms",
        bound: 32.0,
        families: &["event"],
        measure: measures::event,
    },
    Regime {
        name: "sizes",
        what: "triangles of 1e-9 to 1e9 m: which are hit, s and barycentric weights",
        unit: RATIO,
        bound: 10.0,
        families: &["size"],
        measure: measures::hit,
    },
    Regime {
        name: "offsets",
        what: "the same up to 1e9 m from the origin, rays from as far away",
        unit: RATIO,
        bound: 10.0,
        families: &["offset"],
        measure: measures::hit,
    },
    Regime {
        name: "needles",
        what: "needles and slivers, down to 1e-12 of their length",
        unit: RATIO,
        bound: 10.0,
        families: &["needle"],
        measure: measures::hit,
    },
    Regime {
        name: "grazing",
        what: "triangles seen edge-on, to 1e-12 of their plane",
        unit: RATIO,
        bound: 10.0,
        families: &["grazing"],
        measure: measures::hit,
    },
    Regime {
        name: "borders",
        what: "rays through points of edges and corners, and one ulp beside them",
        unit: RATIO,
        bound: 10.0,
        families: &["border"],
        measure: measures::hit,
    },
    Regime {
        name: "surface",
        what: "rays from a surface, and from one ulp before and behind it",
        unit: RATIO,
        bound: 10.0,
        families: &["surface"],
        measure: measures::hit,
    },
    Regime {
        name: "denormals",
        what: "triangles whose corners are denormal f32 numbers",
        unit: RATIO,
        bound: 10.0,
        families: &["denormal"],
        measure: measures::hit,
    },
    Regime {
        name: "horizon",
        what: "where light left an accelerated pinhole, down to one ulp before its horizon, and beyond it",
        unit: "eps of the largest coordinate",
        bound: 8.0,
        families: &["horizon"],
        measure: measures::horizon,
    },
];

impl From<&'static Regime> for Check {
    fn from(regime: &'static Regime) -> Check {
        Check {
            name: regime.name,
            what: regime.what,
            unit: regime.unit,
            bound: regime.bound,
            kind: super::Kind::Reference(regime),
        }
    }
}
