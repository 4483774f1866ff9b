//! Vertices, read and transformed; primitives of a node that refer to the same data share them.

use std::collections::BTreeMap;

use glam::{DAffine3, DVec3};

use super::accessor::{self, Layout};
use super::buffers::Buffers;
use super::import::BadVertices;
use super::materials::{Resolved, UvTransform};
use super::morphs::displace;
use super::pieces::Placement;
use super::primitive::{Colours, Piece};
use super::skins::Binding;
use super::warnings::Warnings;
use crate::Result;
use crate::mesh::normal_matrix;

/// The colour of vertices that have none.
const WHITE: [f32; 4] = [1.0; 4];

/// The normal of vertices that have none.
const FLAT: [f32; 3] = [0.0; 3];

/// All vertices read so far.
pub(super) struct Vertices {
    pub positions: Vec<DVec3>,
    /// By set; shorter than `positions` if the last vertices lack the set.
    pub uvs: Vec<Vec<[f32; 2]>>,
    /// Unit vectors, or 0; shorter than `positions` if the last vertices lack them.
    pub normals: Vec<[f32; 3]>,
    /// Shorter than `positions` if the last vertices lack colours.
    pub colours: Vec<[f32; 4]>,
    /// The shared blocks.
    blocks: BTreeMap<BlockKey, Block>,
    /// The first list for coordinates of transformed textures: the one after the file's sets.
    pub transformed_set: usize,
    bad: BadVertices,
}

/// Primitives share their vertices if all of these are equal.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct BlockKey {
    node: usize,
    instance: u64,
    /// Accessors of positions, of sets, of normals, and of colours.
    positions: usize,
    sets: Vec<(usize, usize)>,
    normals: Option<usize>,
    colours: Option<usize>,
    /// The material, if it transforms coordinates.
    material: Option<usize>,
    /// Accessors of joints and their weights, if they place the vertices.
    influences: Vec<[usize; 2]>,
    /// Accessors of the displacements of positions and of normals.
    targets: Vec<[Option<usize>; 2]>,
}

/// The vertices of a primitive.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    /// The index of the first one.
    pub first: u32,
    /// Whether their transform mirrors: that of most of them, if they follow joints.
    pub is_mirrored: bool,
}

/// What places the vertices of a primitive.
enum Placing<'s> {
    Node(DAffine3),
    Skin(Binding, &'s [DAffine3]),
}

impl Placing<'_> {
    /// The transform of a vertex.
    fn of(&self, vertex: usize) -> DAffine3 {
        match self {
            Placing::Node(world) => *world,
            Placing::Skin(binding, matrices) => binding.matrix(matrices, vertex),
        }
    }

    fn is_mirrored(&self, vertices: usize) -> bool {
        let mirrors = |world: DAffine3| world.matrix3.determinant() < 0.0;
        match self {
            Placing::Node(world) => mirrors(*world),
            Placing::Skin(..) => {
                let all = (0..vertices).filter(|&vertex| mirrors(self.of(vertex)));
                2 * all.count() > vertices
            }
        }
    }
}

impl Vertices {
    /// No vertices yet, for a file with this number of sets.
    pub fn new(sets: usize, bad: BadVertices) -> Self {
        Vertices {
            positions: Vec::new(),
            uvs: Vec::new(),
            normals: Vec::new(),
            colours: Vec::new(),
            blocks: BTreeMap::new(),
            transformed_set: sets,
            bad,
        }
    }

    /// The vertices of a primitive; reads them unless an earlier primitive did. `skin` has the matrices of its node's joints.
    pub fn of(
        &mut self,
        buffers: &mut Buffers,
        at: &Placement,
        piece: &Piece,
        material: &Resolved,
        skin: Option<&[DAffine3]>,
        warnings: &mut Warnings,
    ) -> Result<Block> {
        let sets = piece.uvs.iter();
        let transforms = !material.transforms.is_empty();
        let skin = skin.filter(|_| !piece.influences.is_empty());
        let influences = piece.influences.iter().filter(|_| skin.is_some());
        let accessors = |layout: &Option<Layout>| layout.as_ref().map(|layout| layout.accessor);
        let key = BlockKey {
            node: at.placed.node,
            instance: at.instance,
            positions: piece.positions.accessor,
            sets: sets.map(|(&set, uvs)| (set, uvs.accessor)).collect(),
            normals: piece.normals.as_ref().map(|normals| normals.accessor),
            colours: piece.colours.as_ref().map(|c| c.layout.accessor),
            material: piece.material.filter(|_| transforms),
            influences: influences
                .map(|set| [set.joints.accessor, set.weights.accessor])
                .collect(),
            targets: (piece.targets.values())
                .map(|target| [accessors(&target.positions), accessors(&target.normals)])
                .collect(),
        };
        if let Some(&block) = self.blocks.get(&key) {
            return Ok(block);
        }
        let placing = match skin {
            None => Placing::Node(at.placed.world),
            Some(matrices) => {
                let (sets, joints) = (&piece.influences, matrices.len());
                Placing::Skin(
                    Binding::read(buffers, sets, joints, self.bad, warnings)?,
                    matrices,
                )
            }
        };
        // Positions first: a vertex with bad coordinates, normals or colours is marked by its position.
        let base = self.positions.len();
        self.read_positions(buffers, at, piece, &placing)?;
        for (&set, uvs) in &piece.uvs {
            self.read_uvs(buffers, set, uvs, base, None)?;
        }
        for (which, &(set, transform)) in material.transforms.iter().enumerate() {
            if let Some(uvs) = piece.uvs.get(&set) {
                let list = self.transformed_set + which;
                self.read_uvs(buffers, list, uvs, base, Some(transform))?;
            }
        }
        self.read_normals(buffers, at, piece, base, &placing, warnings)?;
        if let Some(colours) = &piece.colours {
            self.read_colours(buffers, colours, base)?;
        }
        let block = Block {
            first: base as u32,
            is_mirrored: placing.is_mirrored(piece.positions.count as usize),
        };
        self.blocks.insert(key, block);
        Ok(block)
    }

    /// Reads positions and transforms them to the file's world; one that is not finite becomes NaN, which drops its triangles.
    fn read_positions(
        &mut self,
        buffers: &mut Buffers,
        at: &Placement,
        piece: &Piece,
        placing: &Placing,
    ) -> Result<()> {
        let layout = &piece.positions;
        let base = self.positions.len();
        self.positions
            .resize(base + layout.count as usize, DVec3::ZERO);
        let positions = &mut self.positions[base..];
        accessor::read::<3>(buffers, layout, &mut |at, position| {
            positions[at as usize] = DVec3::from_array(position);
        })?;
        let targets = at.weights.iter().filter_map(|(target, weight)| {
            let target = piece.targets.get(target)?;
            Some((target.positions.as_ref()?, *weight))
        });
        displace(buffers, targets, positions)?;
        let mut bad = None;
        for (vertex, position) in positions.iter_mut().enumerate() {
            let placed = placing.of(vertex).transform_point3(*position);
            if !placed.is_finite() {
                bad.get_or_insert((vertex, position.to_array()));
            }
            *position = match placed.is_finite() {
                true => placed,
                false => DVec3::NAN,
            };
        }
        match bad.filter(|_| self.bad == BadVertices::Refuse) {
            None => Ok(()),
            Some((at, [x, y, z])) => Err(buffers.document.invalid(
                format!("{}, vertex {at}", layout.place),
                format!("the position {x}, {y}, {z} is not finite, or not after its transform"),
                "positions must be finite numbers; bad_vertices = \"drop\" leaves their triangles out",
            )),
        }
    }

    /// Reads set `set` and applies its transform. If the coordinates of a vertex are not finite, its position becomes NaN, which drops its
    /// triangles.
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
        // Earlier vertices that lack the set have no coordinates.
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

    /// Reads normals and transforms them to the file's world. If a normal is not finite, the position of its vertex becomes NaN, which
    /// drops its triangles. Exporters write normals of length 0 for faces without area: their triangles are shaded flat.
    fn read_normals(
        &mut self,
        buffers: &mut Buffers,
        at: &Placement,
        piece: &Piece,
        base: usize,
        placing: &Placing,
        warnings: &mut Warnings,
    ) -> Result<()> {
        let Some(layout) = &piece.normals else {
            return Ok(());
        };
        let (normals, positions) = (&mut self.normals, &mut self.positions[base..]);
        let mut bad = None;
        // Earlier primitives without normals are flat.
        normals.resize(base + layout.count as usize, FLAT);
        let mut place = |at: usize, normal: DVec3| {
            if !normal.is_finite() {
                bad.get_or_insert((at, normal.to_array()));
                positions[at] = DVec3::NAN;
            }
            let to_world = normal_matrix(placing.of(at).matrix3);
            let placed = (to_world * normal).normalize_or_zero();
            normals[base + at] = placed.as_vec3().to_array();
        };
        let targets = at.weights.iter().filter_map(|(target, weight)| {
            let target = piece.targets.get(target)?;
            Some((target.normals.as_ref()?, *weight))
        });
        if targets.clone().next().is_none() {
            accessor::read::<3>(buffers, layout, &mut |at, normal| {
                place(at as usize, DVec3::from_array(normal));
            })?;
        } else {
            let mut displaced = vec![DVec3::ZERO; layout.count as usize];
            accessor::read::<3>(buffers, layout, &mut |at, normal| {
                displaced[at as usize] = DVec3::from_array(normal);
            })?;
            displace(buffers, targets, &mut displaced)?;
            for (at, normal) in displaced.into_iter().enumerate() {
                place(at, normal);
            }
        }
        let all = normals[base..].iter().zip(&*positions);
        let flat = all.filter(|(normal, position)| **normal == FLAT && !position.is_nan());
        let what = "normals of length 0: triangles that have one are shaded as flat";
        warnings.add_many(what, &layout.place, flat.count() as u64);
        match bad.filter(|_| self.bad == BadVertices::Refuse) {
            None => Ok(()),
            Some((at, [x, y, z])) => Err(buffers.document.invalid(
                format!("{}, vertex {at}", layout.place),
                format!("the normal {x}, {y}, {z} is not finite"),
                "normals must be finite numbers; bad_vertices = \"drop\" leaves their triangles out",
            )),
        }
    }

    /// Reads vertex colours. If a colour is negative or not finite, the position of its vertex becomes NaN, which drops its triangles.
    fn read_colours(&mut self, buffers: &mut Buffers, from: &Colours, base: usize) -> Result<()> {
        let Colours { layout, alpha } = from;
        let (colours, positions) = (&mut self.colours, &mut self.positions[base..]);
        let mut bad = None;
        // Earlier primitives without colours are white.
        colours.resize(base, WHITE);
        colours.resize(base + layout.count as usize, WHITE);
        let mut take = |at: u64, colour: [f64; 4]| {
            let stored = colour.map(|c| c as f32);
            if !stored.iter().all(|c| (0.0..=f32::MAX).contains(c)) {
                bad.get_or_insert((at, colour));
                positions[at as usize] = DVec3::NAN;
            }
            colours[base + at as usize] = stored;
        };
        match alpha {
            true => accessor::read::<4>(buffers, layout, &mut take)?,
            false => accessor::read::<3>(buffers, layout, &mut |at, [r, g, b]| {
                take(at, [r, g, b, 1.0]);
            })?,
        }
        match bad.filter(|_| self.bad == BadVertices::Refuse) {
            None => Ok(()),
            Some((at, [r, g, b, a])) => Err(buffers.document.invalid(
                format!("{}, vertex {at}", layout.place),
                format!("the vertex colour is {r}, {g}, {b}, {a}"),
                "colours are finite and not negative; bad_vertices = \"drop\" leaves their triangles out",
            )),
        }
    }

    /// Whether a vertex is marked as bad.
    pub fn is_bad(&self, vertex: u32) -> bool {
        self.positions[vertex as usize].is_nan()
    }

    /// Gives bad vertices, which no triangle uses, a valid position.
    pub fn settle(&mut self) {
        let bad = self.positions.iter_mut().filter(|p| p.is_nan());
        bad.for_each(|position| *position = DVec3::ZERO);
    }

    /// Extends every list in use to the number of vertices.
    pub fn pad(&mut self) {
        let vertices = self.positions.len();
        let used = self.uvs.iter_mut().filter(|set| !set.is_empty());
        used.for_each(|set| set.resize(vertices, [f32::NAN; 2]));
        if !self.normals.is_empty() {
            self.normals.resize(vertices, FLAT);
        }
        if !self.colours.is_empty() {
            self.colours.resize(vertices, WHITE);
        }
    }
}
