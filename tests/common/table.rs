//! Reference tables in tests/data/physics.

use std::collections::HashMap;

use glam::DVec3;

/// A row of a table, by column.
pub struct Row {
    /// The line in the file, from 1.
    pub line: usize,
    cells: HashMap<String, String>,
}

impl Row {
    pub fn number(&self, column: &str) -> f64 {
        self.cells[column].parse().unwrap()
    }

    /// A column that is no number.
    #[allow(dead_code)] // most tables have none
    pub fn text(&self, column: &str) -> &str {
        &self.cells[column]
    }

    /// Whether there is a column of this name.
    #[allow(dead_code)]
    pub fn has(&self, column: &str) -> bool {
        self.cells.contains_key(column)
    }

    /// The vector whose components are in the columns `prefix`x, `prefix`y, `prefix`z.
    pub fn vector(&self, prefix: &str) -> DVec3 {
        let component = |axis| self.number(&format!("{prefix}{axis}"));
        DVec3::new(component('x'), component('y'), component('z'))
    }
}

/// The rows of tests/data/physics/`name`.
pub fn rows(name: &str) -> Vec<Row> {
    let path = format!("{}/tests/data/physics/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text
        .lines()
        .enumerate()
        .filter(|(_, l)| !l.starts_with('#'));
    let header: Vec<String> = lines
        .next()
        .unwrap()
        .1
        .split(',')
        .map(String::from)
        .collect();
    lines
        .map(|(index, line)| Row {
            line: index + 1,
            cells: header
                .iter()
                .cloned()
                .zip(line.split(',').map(String::from))
                .collect(),
        })
        .collect()
}
