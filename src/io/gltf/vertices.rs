//! Vertices, read and placed; primitives of a node that name the same data share them.

use std::collections::BTreeMap;

use glam::{DAffine3, DVec3};

use super::accessor::{self, Layout};
use super::buffers::Buffers;
use super::import::BadVertices;
use super::materials::{Resolved, UvTransform};
use super::pieces::Placement;
use super::primitive::Piece;
use crate::Result;

/// The vertices of all that has been read so far.
pub(super) struct Vertices {
    pub positions: Vec<DVec3>,
    /// By set; shorter than `positions` where the last vertices lack the set.
    pub uvs: Vec<Vec<[f32; 2]>>,
    /// Where shared vertices start.
    blocks: BTreeMap<BlockKey, u32>,
    /// The list for coordinates of transformed textures: the one after the file's sets.
    pub transformed_set: usize,
    bad: BadVertices,
}

/// What makes two primitives share their vertices: node, positions, sets, and the material where
/// it transforms its coordinates.
type BlockKey = (usize, usize, Vec<(usize, usize)>, Option<usize>);

impl Vertices {
    /// No vertices yet, of a file with this many sets.
    pub fn new(sets: usize, bad: BadVertices) -> Self {
        Vertices {
            positions: Vec::new(),
            uvs: Vec::new(),
            blocks: BTreeMap::new(),
            transformed_set: sets,
            bad,
        }
    }

    /// Where the vertices of a primitive start; reads them unless an earlier primitive did.
    pub fn of(
        &mut self,
        buffers: &mut Buffers,
        at: &Placement,
        piece: &Piece,
        material: &Resolved,
    ) -> Result<u32> {
        let transform = texture_transform(piece, material);
        let sets = piece.uvs.iter();
        let key = (
            at.placed.node,
            piece.positions.accessor,
            sets.map(|(&set, uvs)| (set, uvs.accessor)).collect(),
            transform.as_ref().and(piece.material),
        );
        if let Some(&base) = self.blocks.get(&key) {
            return Ok(base);
        }
        let base = self.positions.len();
        self.read_positions(buffers, &piece.positions, at.placed.world)?;
        for (&set, uvs) in &piece.uvs {
            self.read_uvs(buffers, set, uvs, base, None)?;
        }
        if let Some((uvs, transform)) = transform {
            self.read_uvs(buffers, self.transformed_set, uvs, base, Some(transform))?;
        }
        self.blocks.insert(key, base as u32);
        Ok(base as u32)
    }

    fn read_positions(
        &mut self,
        buffers: &mut Buffers,
        layout: &Layout,
        world: DAffine3,
    ) -> Result<()> {
        let base = self.positions.len();
        let mut bad = None;
        self.positions
            .resize(base + layout.count as usize, DVec3::ZERO);
        accessor::read::<3>(buffers, layout, &mut |at, position| {
            let placed = world.transform_point3(DVec3::from_array(position));
            if !placed.is_finite() {
                bad.get_or_insert((at, position));
            }
            self.positions[base + at as usize] = match placed.is_finite() {
                true => placed,
                false => DVec3::NAN,
            };
        })?;
        match bad.filter(|_| self.bad == BadVertices::Refuse) {
            None => Ok(()),
            Some((at, [x, y, z])) => Err(buffers.document.invalid(
                format!("{}, vertex {at}", layout.place),
                format!("the position {x}, {y}, {z} is not finite, or not after its transform"),
                "positions must be finite numbers; bad_vertices = \"drop\" leaves their triangles out",
            )),
        }
    }

    fn read_uvs(
        &mut self,
        buffers: &mut Buffers,
        set: usize,
        layout: &Layout,
        base: usize,
        transform: Option<UvTransform>,
    ) -> Result<()> {
        if self.uvs.len() <= set {
            self.uvs.resize_with(set + 1, Vec::new);
        }
        let uvs = &mut self.uvs[set];
        let positions = &mut self.positions[base..];
        let mut bad = None;
        uvs.resize(base + layout.count as usize, [f32::NAN; 2]);
        accessor::read::<2>(buffers, layout, &mut |at, uv| {
            let placed = transform.map_or(uv, |transform| transform.apply(uv));
            let placed = placed.map(|coordinate| coordinate as f32);
            if placed.iter().any(|coordinate| !coordinate.is_finite()) {
                bad.get_or_insert((at, uv));
                positions[at as usize] = DVec3::NAN;
            }
            uvs[base + at as usize] = placed;
        })?;
        match bad.filter(|_| self.bad == BadVertices::Refuse) {
            None => Ok(()),
            Some((at, [u, v])) => Err(buffers.document.invalid(
                format!("{}, vertex {at}", layout.place),
                format!("the texture coordinates {u}, {v} are not finite"),
                "texture coordinates must be finite numbers; bad_vertices = \"drop\" leaves their triangles out",
            )),
        }
    }

    /// Whether a vertex is no place, or has no place on its texture.
    pub fn is_bad(&self, vertex: u32) -> bool {
        self.positions[vertex as usize].is_nan()
    }

    /// Gives vertices that are no places, and that no triangle uses, one.
    pub fn settle(&mut self) {
        let bad = self.positions.iter_mut().filter(|p| p.is_nan());
        bad.for_each(|position| *position = DVec3::ZERO);
    }

    /// Brings every set that is in use to the number of vertices.
    pub fn pad_uvs(&mut self) {
        let vertices = self.positions.len();
        let used = self.uvs.iter_mut().filter(|set| !set.is_empty());
        used.for_each(|set| set.resize(vertices, [f32::NAN; 2]));
    }
}

/// The coordinates that the material's texture transforms, and how.
fn texture_transform<'p>(
    piece: &'p Piece,
    material: &Resolved,
) -> Option<(&'p Layout, UvTransform)> {
    let texture = material.material.texture.as_ref()?;
    Some((piece.uvs.get(&texture.uv_set)?, material.transform?))
}
