//! Where f64 ends.
