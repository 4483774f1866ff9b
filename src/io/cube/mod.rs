//! Cubes of samples (row, column, time, channel), and the files that hold them.
//!
//! A further format of files is a file here, with its [`CubeFormat`], and a line in [`FORMATS`]. What is no file, as sequences of pictures and
//! Zarr folders, is told by its name alone: [`is_sequence`], [`is_zarr`].

#[cfg(not(all(feature = "hdf5", feature = "zarr")))]
mod absent;
mod axes;
mod bricks;
mod byte_order;
mod cache;
mod channels;
#[cfg(any(feature = "hdf5", feature = "zarr"))]
mod chunks;
mod convert;
mod cube_store;
mod dead;
mod format;
#[cfg(feature = "hdf5")]
mod hdf5;
mod layout;
mod negative;
mod npy;
mod number;
mod pages;
mod picture;
mod pieces;
mod samples;
#[cfg(any(feature = "hdf5", feature = "zarr"))]
mod selection;
mod sequence;
mod shifts;
mod store;
mod table;
mod transient_image;
mod wall;
#[cfg(feature = "zarr")]
mod zarr;

#[cfg(not(feature = "hdf5"))]
use absent::hdf5;
#[cfg(not(feature = "zarr"))]
use absent::zarr;

pub use axes::{Axes, Axis};
pub use bricks::{Bricks, BytesRead, Held, LEAST_ROOM, Peeked};
pub use byte_order::{ByteOrder, Sign};
pub use channels::{Channels, CubeChannel};
pub use convert::{Changes, Converted, convert};
pub use cube_store::CubeStore;
pub use format::{CubeFormat, CubeInfo, FileTimes, Transfer, Wanted};
pub use negative::{BelowZero, Negative};
pub use pages::BRICK;
pub use picture::frame_count;
pub(crate) use pieces::Pieces;
pub use samples::{Cube, CubeError, CubeSamples};
pub use sequence::{frame_size, is_picture, is_sequence, is_zarr, pictures};
pub use table::{FORMATS, arrays, format_of, inspect, load, load_bytes, times, wall};
pub use wall::Wall;
