//! From checked headers to the mesh: reads the data, builds triangles, collects materials and images.

use std::collections::BTreeMap;
use std::rc::Rc;

use glam::{DAffine3, DVec3};

use super::accessor;
use super::buffers::Buffers;
use super::document::Document;
use super::draft::{Draft, Materials};
use super::glass;
use super::images;
use super::import::{BadTextures, EncodedImage, Imported, Want};
use super::materials::{FIRST_TRANSFORMED, Resolved};
use super::nodes::{Placed, name_of};
use super::pieces::Placement;
use super::primitive::Piece;
use super::vertices::{Block, Vertices};
use super::warnings::Warnings;
use crate::error::{Error, Result};
use crate::mesh::{AlphaMode, Material, Mesh, Part};

pub(super) fn load(document: &mut Document, node: Option<&str>, want: Want) -> Result<Imported> {
    let mut draft = Draft::new(document, node, want)?;
    let mut buffers = Buffers::new(document);
    glass::settle(&mut draft, &mut buffers, want.bad_textures)?;
    let mut builder = Builder {
        buffers,
        vertices: Vertices::new(draft.uv_sets(), want.bad_vertices),
        uv_sets: draft.uv_sets(),
        triangles: Vec::new(),
        parts: Vec::new(),
        palette: Palette {
            bad_textures: want.bad_textures,
            ..Palette::default()
        },
        warnings: draft.warnings,
    };
    let mut skins = BTreeMap::new();
    for (&index, skin) in &draft.pieces.skins {
        skins.insert(
            index,
            skin.read(&mut builder.buffers, &mut builder.warnings)?,
        );
    }
    for at in &draft.pieces.placements {
        let skin = at.skin.and_then(|skin| skins.get(&skin)).map(Vec::as_slice);
        for at in builder.instances(at)? {
            for piece in draft.pieces.of_mesh(at.mesh) {
                builder.add(&at, piece, &draft.materials, skin)?;
            }
        }
    }
    Ok(builder.finish())
}

struct Builder<'d, 'a> {
    buffers: Buffers<'d, 'a>,
    vertices: Vertices,
    uv_sets: usize,
    triangles: Vec<[u32; 3]>,
    parts: Vec<Part>,
    palette: Palette,
    warnings: Warnings,
}

impl Builder<'_, '_> {
    /// The instances of a placement, with their transforms.
    fn instances(&mut self, at: &Placement) -> Result<Vec<Placement>> {
        let Some(instances) = &at.instances else {
            return Ok(vec![at.clone()]);
        };
        let transforms = instances.read(&mut self.buffers)?;
        let placed = |(instance, transform): (u64, &DAffine3)| Placement {
            placed: Placed {
                world: at.placed.world * *transform,
                ..at.placed
            },
            instances: None,
            instance,
            weights: Rc::clone(&at.weights),
            ..*at
        };
        Ok((0..).zip(&transforms).map(placed).collect())
    }

    fn add(
        &mut self,
        at: &Placement,
        piece: &Piece,
        materials: &Materials,
        skin: Option<&[DAffine3]>,
    ) -> Result<()> {
        let place = &piece.positions.place;
        let Some(resolved) = materials.get(&piece.material) else {
            let what = "its material does not exist";
            return Err(self.buffers.document.invalid(place, what, ""));
        };
        let transformed_set = self.vertices.transformed_set;
        let (buffers, palette) = (&mut self.buffers, &mut self.palette);
        let material = palette.number(
            buffers,
            piece.material,
            resolved,
            transformed_set,
            &mut self.warnings,
        )?;
        let block = (self.vertices).of(buffers, at, piece, resolved, skin, &mut self.warnings)?;
        let first_triangle = self.triangles.len() as u32;
        self.add_triangles(piece, block)?;
        self.parts.push(Part {
            first_triangle,
            triangles: piece.triangles as u32,
            material,
            node: name_of(self.buffers.document, at.placed.node),
        });
        Ok(())
    }

    /// Adds the triangles; if the transform mirrors, their winding is restored.
    fn add_triangles(&mut self, piece: &Piece, block: Block) -> Result<()> {
        let corners = corners(&mut self.buffers, piece)?;
        let (mut without_area, mut dropped) = (0, 0);
        for triangle in 0..piece.triangles as usize {
            let corner = |at: usize| block.first + corners[at];
            let [a, b, c] = (piece.topology.corners(triangle)).map(corner);
            let triangle = if block.is_mirrored {
                [a, c, b]
            } else {
                [a, b, c]
            };
            if triangle.iter().any(|&vertex| self.vertices.is_bad(vertex)) {
                dropped += 1;
                self.triangles.push([a; 3]);
                continue;
            }
            let [a, b, c] = triangle.map(|vertex| self.vertices.positions[vertex as usize]);
            without_area += u64::from((b - a).cross(c - a) == DVec3::ZERO);
            self.triangles.push(triangle);
        }
        let what = "triangles with a vertex that is not finite are dropped";
        self.warnings
            .add_many(what, &piece.positions.place, dropped);
        let what = "triangles without area, which are never seen";
        self.warnings
            .add_many(what, &piece.positions.place, without_area);
        Ok(())
    }

    fn finish(mut self) -> Imported {
        self.vertices.settle();
        self.vertices.pad();
        Imported {
            mesh: Mesh {
                positions: self.vertices.positions,
                uvs: self.vertices.uvs,
                normals: self.vertices.normals,
                colours: self.vertices.colours,
                triangles: self.triangles,
                parts: self.parts,
                materials: self.palette.materials,
            },
            uv_sets: self.uv_sets,
            images: self.palette.images,
            warnings: self.warnings.into_sentences(),
        }
    }
}

/// The corners of a primitive as indices of its own vertices, each in range.
fn corners(buffers: &mut Buffers, piece: &Piece) -> Result<Vec<u32>> {
    let vertices = piece.positions.count;
    let Some(layout) = &piece.indices else {
        return Ok((0..vertices as u32).collect());
    };
    // Via the list, because a sparse accessor passes some indices twice.
    let mut corners = vec![0; layout.count as usize];
    accessor::read::<1>(buffers, layout, &mut |at, [index]| {
        corners[at as usize] = index as u32;
    })?;
    let out_of_range = |&index: &u32| u64::from(index) >= vertices;
    match corners.iter().position(out_of_range) {
        None => Ok(corners),
        Some(at) => Err(buffers.document.invalid(
            &layout.place,
            format!(
                "index {at} is {}, but there are {vertices} vertices",
                corners[at]
            ),
            "every index must be below the number of vertices",
        )),
    }
}

/// The materials and images in use, in order of their first use.
#[derive(Default)]
struct Palette {
    materials: Vec<Material>,
    images: Vec<EncodedImage>,
    /// From materials and images of the document to those of the import.
    material_numbers: BTreeMap<Option<usize>, u32>,
    image_numbers: BTreeMap<usize, usize>,
    bad_textures: BadTextures,
}

impl Palette {
    /// The index of a material in the import; a new one is added, with its images.
    fn number(
        &mut self,
        buffers: &mut Buffers,
        index: Option<usize>,
        resolved: &Resolved,
        transformed_set: usize,
        warnings: &mut Warnings,
    ) -> Result<u32> {
        if let Some(&number) = self.material_numbers.get(&index) {
            return Ok(number);
        }
        let mut material = resolved.material.clone();
        let textures = [
            &mut material.base_colour_texture,
            &mut material.metallic_roughness_texture,
            &mut material.emissive_texture,
        ];
        for used in textures {
            let Some(texture) = used else {
                continue;
            };
            match self.image(buffers, texture.image) {
                Ok(number) => texture.image = number,
                Err(Error::Invalid(bad) | Error::Unsupported(bad))
                    if self.bad_textures == BadTextures::Drop =>
                {
                    warnings.add(images::left_out(&bad.what), &bad.place);
                    *used = None;
                    continue;
                }
                Err(error) => return Err(error),
            }
            if let Some(which) = texture.uv_set.checked_sub(FIRST_TRANSFORMED) {
                texture.uv_set = transformed_set + which;
            }
        }
        let image = material.base_colour_texture.as_ref().map(|t| t.image);
        let image = image.and_then(|image| self.images.get(image));
        if resolved.blends && !image.is_some_and(images::has_alpha) {
            material.alpha_mode = AlphaMode::Blend;
        }
        let number = self.materials.len() as u32;
        self.materials.push(material);
        self.material_numbers.insert(index, number);
        Ok(number)
    }

    fn image(&mut self, buffers: &mut Buffers, index: usize) -> Result<usize> {
        if let Some(&number) = self.image_numbers.get(&index) {
            return Ok(number);
        }
        let used = self.images.iter().map(|image| image.bytes.len() as u64);
        let left = images::MOST_BYTES.saturating_sub(used.sum());
        self.images.push(images::read(buffers, index, left)?);
        let number = self.images.len() - 1;
        self.image_numbers.insert(index, number);
        Ok(number)
    }
}
