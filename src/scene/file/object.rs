//! `[[object]]`.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::camera::Velocity;
use super::spectrum::Spectrum;
use crate::scene::at::At;
use crate::scene::model::{BadTextures, BadVertices};
use crate::scene::values::{Number, NumberOrVector, Numbers, Vector};
use crate::spacetime::units::{Angle, Time};

/// A body with geometry, at rest in its own frame.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { gltf = \"thing.glb\" } or { shape = { sphere = { radius = 1 } } }"
)]
pub(in crate::scene) struct Object {
    /// A unique name, for sources, messages and `--set`. Default: the node, or the file's name without its extension, or the shape, with
    /// a number if that name is taken.
    pub name: Option<At<String>>,
    /// A .gltf or .glb file, relative to the scene file. Excludes `shape`.
    pub gltf: Option<At<String>>,
    /// Only this node of the glTF file, with everything below it. Default: the file's default scene.
    pub node: Option<At<String>>,
    /// What to do about vertices of a glTF file that are NaN, infinite or beyond 2e90 m: "refuse" the file, or "drop" the triangles that
    /// use them, with a warning that counts them. The other triangles keep their numbers. Excludes `shape`. Default: "refuse".
    pub bad_vertices: Option<At<BadVertices>>,
    /// What to do about textures of a glTF file whose image is missing or neither PNG nor JPEG: "refuse" the file, or "drop" them, with a
    /// warning: their material then has its factors alone. Excludes `shape`. Default: "refuse".
    pub bad_textures: Option<At<BadTextures>>,
    /// A built-in shape, like { box = { size = [1, 1, 1] } }. Excludes `gltf`.
    pub shape: Option<At<Shape>>,
    /// Linear RGB base colour of the shape, each at least 0. Default: [0.8, 0.8, 0.8].
    pub colour: Option<At<Vector>>,
    /// The spectrum that it emits uniformly, in place of base colours and of any [[source]]. Excludes `colour`. Needs quantity = "rgb" in
    /// `radiance`.
    pub spectrum: Option<At<Spectrum>>,
    /// Metalness of the shape under lights and sky, 0 (dielectric) to 1 (metal). Default: 0.
    pub metallic: Option<At<Number>>,
    /// Perceptual roughness of the shape under lights and sky, 0 (mirror) to 1; glTF's model. At 1 without metalness it is diffuse.
    /// Default: 1.
    pub roughness: Option<At<Number>>,
    /// The fraction of the light not reflected that passes through the shape, 0 (opaque) to 1 (glass), if `render.bounces` traces it: a
    /// smooth body of index `ior`, whatever its roughness. Default: 0.
    pub transmission: Option<At<Number>>,
    /// Refractive index of the shape unless it is a metal, 1 to 10: it determines how much light the surface mirrors and, for glass, how
    /// it refracts, both by its ratio to `medium.index`. Surfaces of roughness 1 without metalness are diffuse, whatever their index. Default: 1.5.
    pub ior: Option<At<Number>>,
    /// Further texture coordinates, as the set after those of the mesh: made by `nullray bake --atlas` for models whose own do not cover
    /// every point uniquely.
    pub texture_coordinates: Option<At<TextureCoordinates>>,
    /// Object coordinates from the file's (or shape's) coordinates. Default: the identity.
    pub transform: Option<At<Transform>>,
    /// Velocity in the world. Default: at rest.
    pub velocity: Option<At<Velocity>>,
    /// The world event of the object's own origin when the object's clock shows 0. Default: the world's origin at time 0.
    #[serde(default)]
    pub origin: Origin,
}

impl Object {
    /// The default of `colour`.
    pub const COLOUR: Vector = Numbers([0.8; 3]);
}

/// Texture coordinates in an array.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { file = \"light.npz\" }"
)]
pub(in crate::scene) struct TextureCoordinates {
    /// A .npy or .npz file, relative to the scene file, of an array of shape (triangles, 3, 2): by triangle of the mesh and corner,
    /// u and v, with v = 0 the top row.
    pub file: At<String>,
    /// The array of an .npz file. Default: "texture_coordinates".
    pub array: Option<At<String>>,
}

/// A shape that needs no file: exactly one of the keys.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { box = { size = [1, 1, 1] } }"
)]
pub(in crate::scene) struct Shape {
    /// A box centred on the origin, with its edges along the axes.
    #[serde(rename = "box")]
    pub cuboid: Option<At<BoxShape>>,
    /// An icosphere centred on the origin.
    pub sphere: Option<At<Sphere>>,
    /// A rectangle in the plane y = 0 centred on the origin, facing +y.
    pub plane: Option<At<Plane>>,
    /// A wire lattice of square bars along the edges of cubic cells, centred on the origin.
    pub lattice: Option<At<Lattice>>,
}

/// A box.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a table like { size = [1, 1, 1] }")]
pub(in crate::scene) struct BoxShape {
    /// Edge lengths along x, y and z, metres, each above 0.
    pub size: At<Vector>,
}

/// An icosphere.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a table like { radius = 1 }")]
pub(in crate::scene) struct Sphere {
    /// Radius of the vertices, metres, above 0.
    pub radius: At<Number>,
    /// Subdivisions of the icosahedron, 0 to 8: 20·4ⁿ triangles. Default: 4.
    #[serde(default = "Sphere::subdivisions")]
    pub subdivisions: At<u32>,
}

impl Sphere {
    fn subdivisions() -> At<u32> {
        At::nowhere(4)
    }
}

/// A rectangle.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a table like { size = [1, 1] }")]
pub(in crate::scene) struct Plane {
    /// Edge lengths along x and z, metres, each above 0.
    pub size: At<Numbers<2>>,
}

/// A wire lattice.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { cells = [4, 4, 4], spacing = 1, bar = 0.1 }"
)]
pub(in crate::scene) struct Lattice {
    /// Cells along x, y and z, each 1 to 64.
    pub cells: At<[u32; 3]>,
    /// Edge length of a cell, metres, above 0.
    pub spacing: At<Number>,
    /// Thickness of a bar, metres, above 0 and below `spacing`.
    pub bar: At<Number>,
}

/// Object coordinates from the file's coordinates: scaled, then rotated, then translated; or one matrix.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { translate = [0, 1, 0], scale = 2 }"
)]
pub(in crate::scene) struct Transform {
    /// Metres along x, y and z. Default: [0, 0, 0].
    pub translate: Option<At<Vector>>,
    /// A rotation about an axis through the origin, right-handed. Default: none.
    pub rotate: Option<At<Rotation>>,
    /// One factor, or one per axis; none 0. A negative factor mirrors. Default: 1.
    pub scale: Option<At<NumberOrVector>>,
    /// A 4×4 matrix in row order, 16 numbers, for column vectors: its last row is 0, 0, 0, 1. Excludes the other keys.
    pub matrix: Option<At<Numbers<16>>>,
}

/// A rotation about an axis through the origin, right-handed.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { axis = [0, 1, 0], angle = \"30 deg\" }"
)]
pub(in crate::scene) struct Rotation {
    /// The axis, of any length but 0.
    pub axis: At<Vector>,
    /// The angle, like "30 deg".
    pub angle: At<Angle>,
}

/// A world event.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    default,
    deny_unknown_fields,
    expecting = "a table like { position = [0, 0, -2], time = \"0 m\" }"
)]
pub(in crate::scene) struct Origin {
    /// World position, metres. Default: [0, 0, 0].
    pub position: At<Vector>,
    /// World time (ct). Default: "0 m".
    pub time: At<Time>,
}

impl Default for Origin {
    fn default() -> Self {
        Origin {
            position: At::nowhere(Numbers([0.0; 3])),
            time: At::nowhere(Time::customary(0.0)),
        }
    }
}
