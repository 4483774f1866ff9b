//! Triangles and their attributes, and the built-in shapes.

pub mod atlas;
pub mod shapes;
mod triangles;

pub use shapes::Shape;
pub use triangles::{
    AlphaMode, Factors, MOST_INDEX, Material, Mesh, MeshError, Part, TextureFilter, TextureRef,
    TextureSampler, Wrap,
};
pub(crate) use triangles::{normal_matrix, solid_angle};
