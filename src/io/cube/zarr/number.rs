//! Types of the numbers of Zarr arrays.

/// A type of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    F16,
    F32,
    F64,
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
}

impl Number {
    pub(super) const NAMES: [(&'static str, Number, usize); 11] = [
        ("float16", Number::F16, 2),
        ("float32", Number::F32, 4),
        ("float64", Number::F64, 8),
        ("int8", Number::I8, 1),
        ("int16", Number::I16, 2),
        ("int32", Number::I32, 4),
        ("int64", Number::I64, 8),
        ("uint8", Number::U8, 1),
        ("uint16", Number::U16, 2),
        ("uint32", Number::U32, 4),
        ("uint64", Number::U64, 8),
    ];

    pub fn bytes(self) -> usize {
        let row = Number::NAMES.iter().find(|row| row.1 == self);
        row.map_or(8, |row| row.2)
    }

    pub fn name(self) -> &'static str {
        let row = Number::NAMES.iter().find(|row| row.1 == self);
        row.map_or("", |row| row.0)
    }
}
