//! A cube in memory or on disk.

use std::sync::Arc;

use super::bricks::Bricks;
use super::samples::{Cube, CubeSamples};

/// A cube in memory, or on disk, from which it is read on demand.
#[derive(Debug, Clone)]
pub enum CubeStore {
    /// All of it in memory.
    Memory(Arc<Cube>),
    /// On disk.
    Disk(Arc<Bricks>),
}

impl CubeStore {
    /// H, W, T, C.
    pub fn shape(&self) -> [usize; 4] {
        match self {
            CubeStore::Memory(cube) => cube.shape,
            CubeStore::Disk(bricks) => bricks.shape(),
        }
    }

    /// The cube, if all of it is in memory.
    pub fn in_memory(&self) -> Option<&Cube> {
        match self {
            CubeStore::Memory(cube) => Some(cube),
            CubeStore::Disk(_) => None,
        }
    }

    /// The cube, if it is read from disk.
    pub fn on_disk(&self) -> Option<&Arc<Bricks>> {
        match self {
            CubeStore::Memory(_) => None,
            CubeStore::Disk(bricks) => Some(bricks),
        }
    }

    /// Bytes of a sample in memory.
    pub fn sample_bytes(&self) -> usize {
        match self {
            CubeStore::Memory(cube) => match &cube.samples {
                CubeSamples::F16(_) => 2,
                CubeSamples::F32(_) => 4,
                CubeSamples::F64(_) => 8,
            },
            CubeStore::Disk(bricks) => bricks.sample_bytes(),
        }
    }
}

impl From<Cube> for CubeStore {
    fn from(cube: Cube) -> CubeStore {
        CubeStore::Memory(Arc::new(cube))
    }
}

impl From<Arc<Cube>> for CubeStore {
    fn from(cube: Arc<Cube>) -> CubeStore {
        CubeStore::Memory(cube)
    }
}

impl From<Bricks> for CubeStore {
    fn from(bricks: Bricks) -> CubeStore {
        CubeStore::Disk(Arc::new(bricks))
    }
}

impl From<Arc<Bricks>> for CubeStore {
    fn from(bricks: Arc<Bricks>) -> CubeStore {
        CubeStore::Disk(bricks)
    }
}
