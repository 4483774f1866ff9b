//! Triangles and their attributes, and the built-in shapes.

pub mod shapes;
mod triangles;

pub use shapes::Shape;
pub use triangles::{AlphaMode, Material, Mesh, MeshError, Part, TextureRef, Wrap};
