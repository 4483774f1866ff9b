//! The scene: from the text of a file to a typed model, with nothing loaded yet.

pub mod model;
