//! Drawings: their geometry, their files, and agreement between formats.

mod agreement;
mod animation;
mod canvas;
mod files;
mod geometry;
mod golden;
mod independent;
mod pdf_reader;
mod pictures;
mod refusals;
mod samples;
mod svg_reader;
