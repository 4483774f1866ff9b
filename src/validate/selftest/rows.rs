//! Reference rows: exact inputs, with results in arbitrary precision.
//!
//! `rows.csv`: a family, its inputs, a bar, and for each result the nearest f64 and the remainder. The test `stability` computes them
//! with 400 bits, and fails if the file differs.

use std::sync::LazyLock;

/// The largest relative rounding error of one operation, 2⁻⁵³.
pub const EPS: f64 = f64::EPSILON / 2.0;

/// A number as its nearest f64 and the remainder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fine {
    /// The nearest f64; NaN if there is none.
    pub value: f64,
    /// The remainder.
    pub rest: f64,
}

impl Fine {
    /// `got` minus this.
    pub(super) fn error(self, got: f64) -> f64 {
        (got - self.value) - self.rest
    }
}

/// A case with its reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// What the numbers are.
    pub family: String,
    /// The exact inputs.
    pub inputs: Vec<f64>,
    /// In arbitrary precision.
    pub reference: Vec<Fine>,
}

impl Row {
    /// As a line of the file.
    pub fn line(&self) -> String {
        let inputs: Vec<String> = self.inputs.iter().map(|x| format!("{x:e}")).collect();
        let fine = |fine: &Fine| format!("{:e},{:.2e}", fine.value, fine.rest);
        let reference: Vec<String> = self.reference.iter().map(fine).collect();
        format!(
            "{},{},|,{}",
            self.family,
            inputs.join(","),
            reference.join(",")
        )
    }

    fn parse(line: &str) -> Option<Row> {
        let (left, right) = line.split_once(",|,")?;
        let (family, inputs) = left.split_once(',')?;
        let numbers = |text: &str| -> Option<Vec<f64>> {
            text.split(',').map(|number| number.parse().ok()).collect()
        };
        let pairs = numbers(right)?;
        let fine = |pair: &[f64]| Fine {
            value: pair[0],
            rest: pair[1],
        };
        Some(Row {
            family: family.into(),
            inputs: numbers(inputs)?,
            reference: pairs.chunks_exact(2).map(fine).collect(),
        })
    }
}

/// The rows that are compiled into the program.
pub fn embedded() -> &'static [Row] {
    static ROWS: LazyLock<Vec<Row>> = LazyLock::new(|| {
        let lines = include_str!("rows.csv").lines();
        lines.filter_map(Row::parse).collect()
    });
    &ROWS
}
