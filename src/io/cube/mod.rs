//! Cubes of samples (row, column, time, channel), and the files that hold them.
//!
//! A further format is a file here, with its [`CubeFormat`], and a line in [`FORMATS`].

mod axes;
mod bricks;
mod cache;
mod convert;
mod format;
mod npy;
mod samples;
mod sequence;
mod store;
mod table;
mod transient_image;

pub use axes::{Axes, Axis};
pub use bricks::{BRICK, Bricks, BytesRead, Held, LEAST_ROOM};
pub use convert::{Changes, Converted, convert};
pub use format::{CubeFormat, CubeInfo, FileTimes, Transfer, Wanted};
pub use samples::{Cube, CubeError, CubeStore, Samples};
pub use sequence::{is_sequence, pictures};
pub use table::{FORMATS, format_of, inspect, load, load_bytes, times};
