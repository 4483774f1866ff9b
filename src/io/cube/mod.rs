//! Cubes of samples (row, column, time, channel), and the files that hold them.
//!
//! To add a format, write a file here with its [`CubeFormat`], and a line in [`FORMATS`]; formats are recognised by the content of files,
//! or by path for folders and patterns.

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
mod recorded;
mod samples;
#[cfg(any(feature = "hdf5", feature = "zarr"))]
mod selection;
mod sequence;
mod shifts;
mod store;
mod table;
mod transient_image;
mod wall;
mod wanted;
#[cfg(feature = "zarr")]
mod zarr;
mod zarr_folder;

#[cfg(not(feature = "hdf5"))]
use absent::hdf5;
#[cfg(not(feature = "zarr"))]
use absent::zarr;

pub use axes::{Axes, Axis};
pub(crate) use bricks::LEAST_ROOM;
pub use bricks::{Bricks, BytesRead, Held, Peeked};
pub use byte_order::{ByteOrder, Sign};
pub use channels::{Channels, CubeChannel};
pub use convert::{Changes, Converted, convert};
pub use cube_store::CubeStore;
pub use format::{ByPath, CubeFormat};
pub(crate) use negative::Counted;
pub use negative::{BelowZero, Negative};
pub(crate) use pages::BRICK;
pub use picture::frame_count;
pub(crate) use pieces::Pieces;
pub use recorded::Recorded;
pub use samples::{Cube, CubeError, CubeSamples};
pub use sequence::{frame_size, is_picture};
pub use table::{
    FORMATS, extensions, files, format_called, format_of, inspect, load, load_bytes, recorded,
    times, wall,
};
pub use wall::Wall;
pub use wanted::{BinSizes, CubeInfo, FileTimes, Transfer, Wanted};
