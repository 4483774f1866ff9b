//! Triangles and their attributes, as they are at rest: no motion, no acceleration structure.

use std::collections::HashMap;
use std::fmt::Display;

use glam::{DMat3, DVec2, DVec3};

use super::atlas::Corners;

/// An indexed triangle mesh in the coordinates of its object, metres.
///
/// The front of a triangle is the side from which its corners are seen in counter-clockwise order: from outside, on a closed surface. Its
/// normal (b − a) × (c − a) points there. Backs are seen where the material is [double-sided](Material::double_sided), or the scene's
/// `display.back_faces` says so.
///
/// Whoever makes one sees to it that indices are in range and all numbers finite: [`Mesh::check`] says what is not, and scenes are asked
/// for it before they are rendered. Positions that are not finite are refused when they are loaded, or left out where the object's
/// `bad_vertices` is `"drop"`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, metres, object coordinates. f32 positions of a file are exact here.
    pub positions: Vec<DVec3>,
    /// Texture coordinates per vertex, one list per coordinate set of the file (v = 0 is the
    /// top row of an image). A set that no vertex has is empty; otherwise vertices that lack it
    /// hold NaN.
    pub uvs: Vec<Vec<[f32; 2]>>,
    /// Outward normals per vertex, of any length above 0 (glTF NORMAL); empty where no vertex has one, and 0 of those that have none.
    /// Surfaces reflect light by what lies between those of their corners; triangles with a corner that has none are flat.
    pub normals: Vec<[f32; 3]>,
    /// Linear RGBA factors on base colours, per vertex (glTF COLOR_0); empty where no vertex has one.
    pub colours: Vec<[f32; 4]>,
    /// Three vertex indices per triangle, counter-clockwise as seen from its front, in the order of the file.
    pub triangles: Vec<[u32; 3]>,
    /// Runs of consecutive triangles that share a material, in order; they cover `triangles`.
    pub parts: Vec<Part>,
    /// The materials that parts index.
    pub materials: Vec<Material>,
}

/// A run of triangles with one material.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The first triangle.
    pub first_triangle: u32,
    /// How many triangles.
    pub triangles: u32,
    /// Index into [`Mesh::materials`].
    pub material: u32,
    /// The node of the file that this part came from, for messages.
    pub node: String,
}

/// The highest refractive index of glass.
pub const MOST_INDEX: f32 = 10.0;

/// What a surface is made of: the metallic-roughness model of glTF 2.0 (§3.9).
///
/// Its base colour at a point is factor × texture × vertex colour ([`Mesh::colours`]), linear RGBA.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// The name in the file, or "" where it has none.
    pub name: String,
    /// Linear RGB factor.
    pub base_colour: [f32; 3],
    /// The base colour texture, sRGB with linear alpha.
    pub base_colour_texture: Option<TextureRef>,
    /// Factor on the metalness, 0 (dielectric) to 1 (metal).
    pub metallic: f32,
    /// Factor on the perceptual roughness, 0 (mirror) to 1 (matte); GGX has its square.
    pub roughness: f32,
    /// Linear texture: roughness in its green channel, metalness in its blue one.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Linear RGB factor on the emitted radiance, with the emissive strength in it.
    pub emissive: [f32; 3],
    /// The texture of the emitted radiance, sRGB.
    pub emissive_texture: Option<TextureRef>,
    /// The part of the light not reflected that goes through, 0 to 1 (KHR_materials_transmission).
    pub transmission: f32,
    /// Refractive index of the dielectric (KHR_materials_ior), also of what light goes through.
    pub ior: f32,
    /// Whether it bounds a body of that index (KHR_materials_volume); otherwise it is a film without thickness.
    pub solid: bool,
    /// Factor on alpha, 0 to 1.
    pub alpha: f32,
    /// What alpha does.
    pub alpha_mode: AlphaMode,
    /// Whether the base colour is what it shows under any light (KHR_materials_unlit).
    pub unlit: bool,
    /// Whether glTF says that the back face is to be seen too.
    pub double_sided: bool,
}

/// How a material looks by its factors alone, on which textures may put numbers below 1: what is known before any texture is loaded.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Factors {
    /// Metalness, 0 to 1.
    pub metallic: f32,
    /// Perceptual roughness, 0 to 1.
    pub roughness: f32,
    /// The part of the light not reflected that goes through, 0 to 1.
    pub transmission: f32,
    /// Whether its back is to be seen too.
    pub double_sided: bool,
    /// Whether it shines where there is light.
    pub emits: bool,
}

impl Factors {
    /// Whether it reflects like a perfect mirror, where light is followed from surface to surface.
    pub fn is_mirror(&self) -> bool {
        self.roughness == 0.0 && self.transmission == 0.0
    }

    /// Whether light goes through it.
    pub fn is_glass(&self) -> bool {
        self.transmission > 0.0
    }

    /// Whether it reflects otherwise than diffusely.
    pub fn is_glossy(&self) -> bool {
        self.metallic > 0.0 || self.roughness < 1.0 || self.is_glass()
    }
}

/// What alpha does to a surface (glTF 2.0 §3.9.4).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum AlphaMode {
    /// Nothing.
    #[default]
    Opaque,
    /// Where it is below `cutoff`, there is no surface.
    Mask {
        /// The least alpha that is there.
        cutoff: f32,
    },
    /// The surface is partly transparent.
    Blend,
}

/// The default material of glTF: white metal, rough, one-sided, opaque.
impl Default for Material {
    fn default() -> Material {
        Material {
            name: String::new(),
            base_colour: [1.0; 3],
            base_colour_texture: None,
            metallic: 1.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            emissive: [0.0; 3],
            emissive_texture: None,
            transmission: 0.0,
            ior: 1.5,
            solid: false,
            alpha: 1.0,
            alpha_mode: AlphaMode::Opaque,
            unlit: false,
            double_sided: false,
        }
    }
}

impl Material {
    /// A matte dielectric of linear base colour `colour`.
    pub fn matte(colour: [f32; 3]) -> Material {
        Material {
            base_colour: colour,
            metallic: 0.0,
            ..Material::default()
        }
    }

    /// How it looks by its factors alone.
    pub fn factors(&self) -> Factors {
        Factors {
            metallic: self.metallic,
            roughness: self.roughness,
            transmission: self.transmission,
            double_sided: self.double_sided,
            emits: self.emissive != [0.0; 3],
        }
    }

    /// Whether it has holes by its alpha.
    pub fn is_masked(&self) -> bool {
        matches!(self.alpha_mode, AlphaMode::Mask { .. })
    }

    /// Checks that all numbers are in the ranges that glTF gives them.
    ///
    /// # Errors
    /// The first field that is not.
    pub fn check(&self) -> Result<(), MeshError> {
        let refuse = |field: &str, value: &dyn Display, right: &str| {
            let what = format!("{value} is not {right}");
            Err(MeshError {
                field: field.into(),
                what,
            })
        };
        let colours = [
            ("base_colour", self.base_colour),
            ("emissive", self.emissive),
        ];
        for (field, colour) in colours {
            if let Some(bad) = colour.iter().find(|c| !is_factor(**c)) {
                return refuse(field, bad, FACTOR);
            }
        }
        let parts = [
            ("metallic", self.metallic),
            ("roughness", self.roughness),
            ("transmission", self.transmission),
            ("alpha", self.alpha),
        ];
        for (field, part) in parts {
            if !(0.0..=1.0).contains(&part) {
                return refuse(field, &part, "from 0 to 1");
            }
        }
        if !(1.0..=MOST_INDEX).contains(&self.ior) {
            let right = format!("from 1 to {MOST_INDEX}");
            return refuse("ior", &self.ior, &right);
        }
        match self.alpha_mode {
            AlphaMode::Mask { cutoff } if !is_factor(cutoff) => {
                refuse("alpha_mode.cutoff", &cutoff, FACTOR)
            }
            _ => Ok(()),
        }
    }

    /// The textures that there are.
    pub fn textures(&self) -> impl Iterator<Item = &TextureRef> {
        let all = [
            &self.base_colour_texture,
            &self.metallic_roughness_texture,
            &self.emissive_texture,
        ];
        all.into_iter().flatten()
    }
}

/// Where a material's texture lies and how it is addressed.
#[derive(Debug, Clone, PartialEq)]
pub struct TextureRef {
    /// Index into the list of images of the file.
    pub image: usize,
    /// Which list of [`Mesh::uvs`].
    pub uv_set: usize,
    /// How it is looked up.
    pub sampler: TextureSampler,
}

/// How a texture is looked up (glTF sampler).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TextureSampler {
    /// What happens outside [0, 1], along u and along v.
    pub wrap: [Wrap; 2],
    /// What lies between the centres of texels.
    pub filter: TextureFilter,
}

/// What a texture shows between the centres of its texels (magFilter of a glTF sampler).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextureFilter {
    /// The nearest texel.
    Nearest,
    /// The four texels around, interpolated.
    Linear,
}

impl TextureSampler {
    /// Interpolates between texels.
    pub fn linear(wrap: [Wrap; 2]) -> Self {
        TextureSampler {
            wrap,
            filter: TextureFilter::Linear,
        }
    }
}

/// What a texture does outside [0, 1] (glTF sampler).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wrap {
    /// Periodic.
    Repeat,
    /// Periodic, every second period mirrored.
    Mirror,
    /// The edge texel.
    Clamp,
}

/// Which field of a mesh does not fit the others or is out of its range, and why.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{field}: {what}")]
#[non_exhaustive]
pub struct MeshError {
    /// The field, as in `triangles[7]` or `materials[0].roughness`.
    pub field: String,
    /// What is wrong with it.
    pub what: String,
}

crate::error::value_errors!(MeshError);

/// What [`is_factor`] says yes to.
const FACTOR: &str = "finite and at least 0";

/// Whether a colour may have `value`; not so NaN.
fn is_factor(value: f32) -> bool {
    (0.0..=f32::MAX).contains(&value)
}

impl Mesh {
    /// What [`Mesh::check`] asks for, for messages.
    pub(crate) const CHECKED: &str = "arrays of a mesh must fit each other, and numbers of its materials be in the ranges of glTF";

    /// A mesh of one material without a name, of linear base colour `colour`, that is seen from the front.
    pub fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>, colour: [f32; 3]) -> Mesh {
        Mesh {
            parts: vec![Part {
                first_triangle: 0,
                triangles: triangles.len() as u32,
                material: 0,
                node: String::new(),
            }],
            materials: vec![Material::matte(colour)],
            positions,
            uvs: Vec::new(),
            normals: Vec::new(),
            colours: Vec::new(),
            triangles,
        }
    }

    /// Checks that indices are in range, that lists are as long as they must be, that normals are finite, and that colours and numbers of
    /// materials are in their ranges.
    ///
    /// # Errors
    /// The first field of which that is not so.
    pub fn check(&self) -> Result<(), MeshError> {
        let refuse = |field: String, what: String| Err(MeshError { field, what });
        let vertices = self.positions.len();
        let beyond = |t: &[u32; 3]| t.iter().any(|&v| v as usize >= vertices);
        if let Some(i) = self.triangles.iter().position(beyond) {
            let what = format!(
                "{:?} refers to a vertex that does not exist: there are {vertices}",
                self.triangles[i]
            );
            return refuse(format!("triangles[{i}]"), what);
        }
        let odd = |set: &Vec<[f32; 2]>| !set.is_empty() && set.len() != vertices;
        if let Some(set) = self.uvs.iter().position(odd) {
            let what = format!(
                "{} texture coordinates for {vertices} vertices",
                self.uvs[set].len()
            );
            return refuse(format!("uvs[{set}]"), what);
        }
        let normals = self.normals.len();
        if normals != 0 && normals != vertices {
            let what = format!("{normals} normals for {vertices} vertices");
            return refuse("normals".into(), what);
        }
        let bad = |normal: &[f32; 3]| !normal.iter().all(|x| x.is_finite());
        if let Some(i) = self.normals.iter().position(bad) {
            let what = format!("{:?} are not all finite", self.normals[i]);
            return refuse(format!("normals[{i}]"), what);
        }
        let colours = self.colours.len();
        if colours != 0 && colours != vertices {
            let what = format!("{colours} colours for {vertices} vertices");
            return refuse("colours".into(), what);
        }
        let bad = |colour: &[f32; 4]| !colour.iter().all(|c| is_factor(*c));
        if let Some(i) = self.colours.iter().position(bad) {
            let what = format!("{:?} are not all {FACTOR}", self.colours[i]);
            return refuse(format!("colours[{i}]"), what);
        }
        for (i, material) in self.materials.iter().enumerate() {
            if let Err(error) = material.check() {
                return refuse(format!("materials[{i}].{}", error.field), error.what);
            }
        }
        // Parts stand one behind the other: each triangle has one material.
        let mut next = 0;
        for (i, part) in self.parts.iter().enumerate() {
            if u64::from(part.first_triangle) != next {
                let what = format!("begins at triangle {}, not {next}", part.first_triangle);
                return refuse(format!("parts[{i}].first_triangle"), what);
            }
            next += u64::from(part.triangles);
            if part.material as usize >= self.materials.len() {
                let what = format!("there are {} materials", self.materials.len());
                return refuse(format!("parts[{i}].material"), what);
            }
        }
        match next == self.triangles.len() as u64 {
            true => Ok(()),
            false => {
                let what = format!("cover {next} of {} triangles", self.triangles.len());
                refuse("parts".into(), what)
            }
        }
    }

    /// Adds a set of texture coordinates that are given by triangle and corner, as set `set`, before which there must be as many; sets from
    /// there on are moved one further, with the textures that use them. Vertices whose corners differ become several.
    pub(crate) fn insert_uvs(&mut self, set: usize, corners: &[Corners]) {
        // A vertex is what has one place and one pair of new coordinates, compared by their bits.
        let mut vertices = HashMap::new();
        let mut old = Vec::new();
        let mut uvs = Vec::new();
        for (triangle, corners) in self.triangles.iter_mut().zip(corners) {
            for (vertex, uv) in triangle.iter_mut().zip(corners) {
                let new = *vertices
                    .entry((*vertex, uv.map(f32::to_bits)))
                    .or_insert_with(|| {
                        old.push(*vertex as usize);
                        uvs.push(*uv);
                        old.len() as u32 - 1
                    });
                *vertex = new;
            }
        }
        self.positions = old.iter().map(|v| self.positions[*v]).collect();
        for list in self.uvs.iter_mut().filter(|list| !list.is_empty()) {
            *list = old.iter().map(|v| list[*v]).collect();
        }
        if !self.normals.is_empty() {
            self.normals = old.iter().map(|v| self.normals[*v]).collect();
        }
        if !self.colours.is_empty() {
            self.colours = old.iter().map(|v| self.colours[*v]).collect();
        }
        self.uvs.insert(set, uvs);
        for material in &mut self.materials {
            let textures = [
                &mut material.base_colour_texture,
                &mut material.metallic_roughness_texture,
                &mut material.emissive_texture,
            ];
            for texture in textures.into_iter().flatten() {
                texture.uv_set += usize::from(texture.uv_set >= set);
            }
        }
    }

    /// Whether a material of it has an alpha mask.
    pub fn has_masks(&self) -> bool {
        self.materials.iter().any(Material::is_masked)
    }

    /// The three corners of triangle `index`.
    ///
    /// # Panics
    /// Where there is no such triangle, or it names vertices that are not there ([`check`](Mesh::check)); so do
    /// [`uv`](Mesh::uv) and [`colour`](Mesh::colour) without such a triangle.
    pub fn corners(&self, index: u32) -> [DVec3; 3] {
        self.triangles[index as usize].map(|v| self.positions[v as usize])
    }

    /// The texture coordinates of set `set` at barycentric `(u, v)` of triangle `index`
    /// (u weights the second corner, v the third), or none where the mesh has no such set.
    #[inline]
    pub fn uv(&self, set: usize, index: u32, barycentric: [f64; 2]) -> Option<DVec2> {
        let uvs = self.uvs.get(set)?;
        let corner = |v: u32| {
            let [u, v] = uvs.get(v as usize)?;
            Some(DVec2::new(f64::from(*u), f64::from(*v)))
        };
        let [a, b, c] = self.triangles[index as usize];
        let (a, b, c, [u, v]) = (corner(a)?, corner(b)?, corner(c)?, barycentric);
        // NaN of one corner is NaN here.
        Some(a + (b - a) * u + (c - a) * v).filter(|uv| uv.is_finite())
    }

    /// The unit normal between those of the corners at barycentric `(u, v)` of triangle `index`; none where a corner has none, or where they
    /// cancel. Those of corners have to be unit vectors.
    #[inline]
    pub(crate) fn normal(&self, index: u32, [u, v]: [f64; 2]) -> Option<DVec3> {
        // Unit normals are rounded by 2⁻²⁴ each: what is left of some that cancel may point anywhere.
        const LEAST: f64 = 1e-6;
        if self.normals.is_empty() {
            return None;
        }
        let corners = self.triangles[index as usize];
        let corners = corners.map(|v| DVec3::from(self.normals[v as usize].map(f64::from)));
        if corners.contains(&DVec3::ZERO) {
            return None;
        }
        let [a, b, c] = corners;
        let normal = a + (b - a) * u + (c - a) * v;
        let length = normal.length();
        (length > LEAST).then(|| normal / length)
    }

    /// Turns normals as a linear map of places turns surfaces, and makes them unit vectors; those of length 0 stay 0.
    pub(crate) fn turn_normals(&mut self, places: DMat3) {
        let normals = normal_matrix(places);
        for normal in &mut self.normals {
            let turned = normals * DVec3::from(normal.map(f64::from));
            *normal = turned.normalize_or_zero().as_vec3().to_array();
        }
    }

    /// The vertex colour, linear RGBA, at barycentric `(u, v)` of triangle `index`, or none where the mesh
    /// has none.
    #[inline]
    pub fn colour(&self, index: u32, [u, v]: [f64; 2]) -> Option<[f64; 4]> {
        if self.colours.is_empty() {
            return None;
        }
        let corners = self.triangles[index as usize];
        let [a, b, c] = corners.map(|corner| self.colours[corner as usize].map(f64::from));
        Some(std::array::from_fn(|k| {
            a[k] + (b[k] - a[k]) * u + (c[k] - a[k]) * v
        }))
    }
}

/// What takes normals of surfaces along with a linear map of places, up to a positive factor: the inverse transpose, M⁻ᵀ = cof M/det M.
///
/// Cofactors are there for maps that make all flat, too. With the sign of det M, what points out of a body still does so where it is mirrored.
pub(crate) fn normal_matrix(places: DMat3) -> DMat3 {
    let (x, y, z) = (places.x_axis, places.y_axis, places.z_axis);
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    match places.determinant() < 0.0 {
        true => -cofactors,
        false => cofactors,
    }
}
