//! Triangles and their attributes at rest: no motion, no acceleration structure.

use std::collections::HashMap;
use std::fmt::Display;

use glam::{DMat3, DVec2, DVec3};

use super::atlas::Corners;

/// An indexed triangle mesh in the coordinates of its object, metres.
///
/// The front of a triangle is the side from which its corners are seen in counter-clockwise order: from outside, on a closed surface. Its
/// normal (b − a) × (c − a) points there. Backs are visible if the material is [double-sided](Material::double_sided), or if the scene's
/// `display.back_faces` says so.
///
/// Code that creates a mesh must keep indices in range and all numbers finite: [`Mesh::check`] reports violations, and is called for all
/// meshes of a scene before it is rendered. Positions that are not finite are refused when they are loaded, or left out if the object's
/// `bad_vertices` is `"drop"`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, metres, object coordinates. f32 positions of a file are exact here.
    pub positions: Vec<DVec3>,
    /// Texture coordinates per vertex, one list per coordinate set of the file (v = 0 is the top row of an image). A set without any vertex
    /// is empty; otherwise vertices that lack it hold NaN.
    pub uvs: Vec<Vec<[f32; 2]>>,
    /// Outward normals per vertex, of any length above 0 (glTF NORMAL); empty if no vertex has one, and 0 for vertices without one.
    /// Surfaces are shaded with normals interpolated between their corners; triangles with a corner that has none are flat.
    pub normals: Vec<[f32; 3]>,
    /// Linear RGBA factors on base colours, per vertex (glTF COLOR_0); empty if no vertex has one.
    pub colours: Vec<[f32; 4]>,
    /// Three vertex indices per triangle, counter-clockwise as seen from its front, in the order of the file.
    pub triangles: Vec<[u32; 3]>,
    /// Runs of consecutive triangles that share a material, in order; they cover `triangles`.
    pub parts: Vec<Part>,
    /// The materials to which parts refer.
    pub materials: Vec<Material>,
}

/// A run of triangles with one material.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The first triangle.
    pub first_triangle: u32,
    /// The number of triangles.
    pub triangles: u32,
    /// Index into [`Mesh::materials`].
    pub material: u32,
    /// The node of the file from which this part came, for messages.
    pub node: String,
}

/// The highest refractive index of glass.
pub const MOST_INDEX: f32 = 10.0;

/// What a surface is made of: the metallic-roughness model of glTF 2.0 (§3.9).
///
/// Its base colour at a point is factor × texture × vertex colour ([`Mesh::colours`]), linear RGBA.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Material {
    /// The name in the file, or "" if it has none.
    pub name: String,
    /// Linear RGB factor.
    pub base_colour: [f32; 3],
    /// The base colour texture, sRGB with linear alpha.
    pub base_colour_texture: Option<TextureRef>,
    /// Factor on the metalness, 0 (dielectric) to 1 (metal).
    pub metallic: f32,
    /// Factor on the perceptual roughness, 0 (mirror) to 1 (matte); the α of GGX is its square.
    pub roughness: f32,
    /// Linear texture: roughness in its green channel, metalness in its blue one.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Linear RGB factor on the emitted radiance, including the emissive strength.
    pub emissive: [f32; 3],
    /// The texture of the emitted radiance, sRGB.
    pub emissive_texture: Option<TextureRef>,
    /// The fraction of the light not reflected that is transmitted, 0 to 1 (KHR_materials_transmission).
    pub transmission: f32,
    /// Refractive index of the dielectric (KHR_materials_ior), also for transmitted light.
    pub ior: f32,
    /// Whether it bounds a body with that index (KHR_materials_volume); otherwise it is thin-walled.
    pub solid: bool,
    /// Factor on alpha, 0 to 1.
    pub alpha: f32,
    /// The effect of alpha.
    pub alpha_mode: AlphaMode,
    /// Whether it shows its base colour under any light (KHR_materials_unlit).
    pub unlit: bool,
    /// Whether glTF says that the back face is visible too.
    pub double_sided: bool,
}

/// The appearance of a material by its factors alone, which textures may multiply by numbers below 1: what is known before any texture is
/// loaded.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Factors {
    /// Metalness, 0 to 1.
    pub metallic: f32,
    /// Perceptual roughness, 0 to 1.
    pub roughness: f32,
    /// The fraction of the light not reflected that is transmitted, 0 to 1.
    pub transmission: f32,
    /// Whether its back is visible too.
    pub double_sided: bool,
    /// Whether it emits light, in scenes that are lit.
    pub emits: bool,
    /// Whether metalness and roughness are multiplied by a texture.
    pub has_gloss_texture: bool,
}

impl Factors {
    /// Whether it is a perfect mirror, along which light paths are traced from surface to surface.
    pub fn is_mirror(&self) -> bool {
        self.roughness == 0.0 && self.transmission == 0.0
    }

    /// Whether it transmits light.
    pub fn is_glass(&self) -> bool {
        self.transmission > 0.0
    }

    /// Whether it has any reflection that is not diffuse.
    pub fn is_glossy(&self) -> bool {
        self.metallic > 0.0 || self.roughness < 1.0 || self.has_gloss_texture || self.is_glass()
    }
}

/// The effect of alpha on a surface (glTF 2.0 §3.9.4).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum AlphaMode {
    /// None.
    #[default]
    Opaque,
    /// If alpha is below `cutoff`, there is no surface.
    Mask {
        /// The smallest alpha at which the surface exists.
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

    /// Its appearance by its factors alone.
    pub fn factors(&self) -> Factors {
        Factors {
            metallic: self.metallic,
            roughness: self.roughness,
            transmission: self.transmission,
            double_sided: self.double_sided,
            emits: self.emissive != [0.0; 3],
            has_gloss_texture: self.metallic_roughness_texture.is_some(),
        }
    }

    /// Whether alpha may cut holes into it.
    pub fn is_masked(&self) -> bool {
        matches!(self.alpha_mode, AlphaMode::Mask { .. })
    }

    /// Checks that all numbers are in glTF's ranges.
    ///
    /// # Errors
    /// The first field that is out of range.
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

    /// The textures that it has.
    pub fn textures(&self) -> impl Iterator<Item = &TextureRef> {
        let all = [
            &self.base_colour_texture,
            &self.metallic_roughness_texture,
            &self.emissive_texture,
        ];
        all.into_iter().flatten()
    }
}

/// The image of a material's texture, and how it is addressed.
#[derive(Debug, Clone, PartialEq)]
pub struct TextureRef {
    /// Index into the list of images of the file.
    pub image: usize,
    /// Index into [`Mesh::uvs`].
    pub uv_set: usize,
    /// How it is looked up.
    pub sampler: TextureSampler,
}

/// How a texture is looked up (glTF sampler).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TextureSampler {
    /// The behaviour outside [0, 1], along u and along v.
    pub wrap: [Wrap; 2],
    /// Interpolation between the centres of texels.
    pub filter: TextureFilter,
}

/// The interpolation of a texture between the centres of its texels (magFilter of a glTF sampler).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextureFilter {
    /// The nearest texel.
    Nearest,
    /// Interpolated between the four nearest texels.
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

/// The behaviour of a texture outside [0, 1] (glTF sampler).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wrap {
    /// Periodic.
    Repeat,
    /// Periodic, every second period mirrored.
    Mirror,
    /// The edge texel.
    Clamp,
}

/// Which field of a mesh is inconsistent with others or out of range, and why.
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

/// The condition of [`is_factor`], in words.
const FACTOR: &str = "finite and at least 0";

/// Whether `value` is allowed in a colour; false for NaN.
fn is_factor(value: f32) -> bool {
    (0.0..=f32::MAX).contains(&value)
}

impl Mesh {
    /// The condition of [`Mesh::check`], for messages.
    pub(crate) const CHECKED: &str = "arrays of a mesh must fit each other, and numbers of its materials be in the ranges of glTF";

    /// A mesh with one unnamed material of linear base colour `colour`, visible from the front.
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

    /// Checks that there are triangles, that indices are in range, that lists have the right lengths, that normals are finite, and that colours and numbers of
    /// materials are in range.
    ///
    /// # Errors
    /// The first field that fails.
    pub fn check(&self) -> Result<(), MeshError> {
        let refuse = |field: String, what: String| Err(MeshError { field, what });
        if self.triangles.is_empty() {
            return refuse("triangles".into(), "there are none".into());
        }
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
        // Parts are contiguous: each triangle has one material.
        let mut next = 0;
        for (i, part) in self.parts.iter().enumerate() {
            if u64::from(part.first_triangle) != next {
                let what = format!("begins at triangle {}, not {next}", part.first_triangle);
                return refuse(format!("parts[{i}].first_triangle"), what);
            }
            next += u64::from(part.triangles);
            if part.material as usize >= self.materials.len() {
                let what = match self.materials.len() {
                    1 => format!("is {}, but there is only material 0", part.material),
                    count => format!(
                        "is {}, but there are {count} materials, from 0 on",
                        part.material
                    ),
                };
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

    /// Inserts a set of texture coordinates, given by triangle and corner, as set `set`; that many sets must exist before it. Later sets
    /// move up by one, and so do references of textures to them. A vertex is split if its corners have different coordinates.
    pub(crate) fn insert_uvs(&mut self, set: usize, corners: &[Corners]) {
        // Vertices are identified by the bits of their position and new coordinates.
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

    /// Whether any of its materials has an alpha mask.
    pub fn has_masks(&self) -> bool {
        self.materials.iter().any(Material::is_masked)
    }

    /// The three corners of triangle `index`.
    ///
    /// # Panics
    /// If there is no such triangle, or its vertices do not exist ([`check`](Mesh::check)). [`uv`](Mesh::uv) and [`colour`](Mesh::colour)
    /// also panic without such a triangle.
    pub fn corners(&self, index: u32) -> [DVec3; 3] {
        self.triangles[index as usize].map(|v| self.positions[v as usize])
    }

    /// The texture coordinates of set `set` at barycentric `(u, v)` of triangle `index` (u weights the second corner, v the third); `None`
    /// if the mesh has no such set.
    #[inline]
    pub fn uv(&self, set: usize, index: u32, barycentric: [f64; 2]) -> Option<DVec2> {
        let uvs = self.uvs.get(set)?;
        let corner = |v: u32| {
            let [u, v] = uvs.get(v as usize)?;
            Some(DVec2::new(f64::from(*u), f64::from(*v)))
        };
        let [a, b, c] = self.triangles[index as usize];
        let (a, b, c, [u, v]) = (corner(a)?, corner(b)?, corner(c)?, barycentric);
        // NaN at one corner gives NaN here.
        Some(a + (b - a) * u + (c - a) * v).filter(|uv| uv.is_finite())
    }

    /// The unit normal interpolated between those of the corners, at barycentric `(u, v)` of triangle `index`; `None` if a corner has none,
    /// or if they cancel. Corner normals must be unit vectors.
    #[inline]
    pub(crate) fn normal(&self, index: u32, [u, v]: [f64; 2]) -> Option<DVec3> {
        // Unit normals have rounding errors of 2⁻²⁴: the remainder of normals that cancel may point anywhere.
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

    /// Transforms normals along with a linear map of positions, and normalises them; those of length 0 stay 0.
    pub(crate) fn turn_normals(&mut self, places: DMat3) {
        let normals = normal_matrix(places);
        for normal in &mut self.normals {
            let turned = normals * DVec3::from(normal.map(f64::from));
            *normal = turned.normalize_or_zero().as_vec3().to_array();
        }
    }

    /// The vertex colour, linear RGBA, at barycentric `(u, v)` of triangle `index`; `None` if the mesh has none.
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

/// The solid angle of a triangle as seen from a point, above 0 if it faces away: van Oosterom and Strackee, "The solid angle of a plane
/// triangle", 1983.
pub(crate) fn solid_angle(corners: [DVec3; 3], from: DVec3) -> f64 {
    let [a, b, c] = corners.map(|p| (p - from).normalize_or_zero());
    2.0 * libm::atan2(a.dot(b.cross(c)), 1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

/// The matrix that transforms normals along with a linear map of positions, up to a positive factor: the inverse transpose, M⁻ᵀ = cof M/det M.
///
/// Cofactors exist even for singular maps. The sign of det M keeps outward normals outward if the body is mirrored.
pub(crate) fn normal_matrix(places: DMat3) -> DMat3 {
    let (x, y, z) = (places.x_axis, places.y_axis, places.z_axis);
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    match places.determinant() < 0.0 {
        true => -cofactors,
        false => cofactors,
    }
}
