//! The triangles that a document declares: its primitives, placed, with every header checked and no data read. Planning uses these, and
//! loading reads what they describe.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use super::document::Document;
use super::instances::Instances;
use super::nodes::Placed;
use super::primitive::{Piece, Wanted, of_mesh};
use super::warnings::Warnings;
use crate::Result;

/// The maximum number of triangles of one import. Nodes may repeat a mesh, so a small file can request any number of them; the same holds
/// for the next two limits.
const MOST_TRIANGLES: u64 = 1 << 26;

/// The maximum number of bytes of vertices (24 for a position, 8 for a pair of texture coordinates, 12 for a normal, 16 for a colour).
const MOST_VERTEX_BYTES: u64 = 1 << 31;

/// The maximum number of primitives, counted at every node.
const MOST_PARTS: u64 = 1 << 20;

/// A mesh at a node. Meshes are checked once, no matter how many nodes place them.
#[derive(Debug, Clone)]
pub(super) struct Placement {
    /// The node and its world transform.
    pub placed: Placed,
    /// Index of its mesh in the document.
    pub mesh: usize,
    /// The transforms of instances, applied before the node's own, if it has several.
    pub instances: Option<Instances>,
    /// The index of the instance, once they are read.
    pub instance: u64,
}

impl Placement {
    /// The number of times that the mesh is placed.
    pub fn count(&self) -> u64 {
        self.instances.as_ref().map_or(1, |all| all.count)
    }
}

/// The triangle primitives of the meshes in use (by index of the mesh), and their placements.
#[derive(Debug, Default)]
pub(super) struct Pieces {
    pub of_mesh: BTreeMap<usize, Vec<Piece>>,
    /// In the order of the nodes; meshes without triangles are not placed.
    pub placements: Vec<Placement>,
}

impl Pieces {
    /// Checks the triangle primitives of `placed`.
    pub fn new(
        document: &Document,
        placed: &[Placed],
        wanted: Wanted,
        warnings: &mut Warnings,
    ) -> Result<Self> {
        let mut pieces = Pieces::default();
        let mut totals = Totals::default();
        for &placed in placed {
            let Some(mesh) = mesh_of(document, placed.node, warnings)? else {
                continue;
            };
            if let Entry::Vacant(entry) = pieces.of_mesh.entry(mesh) {
                entry.insert(of_mesh(document, mesh, wanted, warnings)?);
            }
            let of_mesh = pieces.of_mesh(mesh);
            if !of_mesh.is_empty() {
                let placement = Placement {
                    placed,
                    mesh,
                    instances: Instances::of(document, placed.node)?,
                    instance: 0,
                };
                let totals = totals.add(of_mesh, placement.count());
                totals.check(document, placed.node)?;
                pieces.placements.push(placement);
            }
        }
        match pieces.placements.is_empty() {
            false => Ok(pieces),
            true => Err(nothing(document, placed)),
        }
    }

    pub fn of_mesh(&self, mesh: usize) -> &[Piece] {
        self.of_mesh.get(&mesh).map_or(&[], Vec::as_slice)
    }

    /// Every primitive at every node, once for all its instances.
    pub fn all(&self) -> impl Iterator<Item = (&Placement, &Piece)> {
        let placements = self.placements.iter();
        placements.flat_map(|at| self.of_mesh(at.mesh).iter().map(move |piece| (at, piece)))
    }
}

#[derive(Debug, Default)]
struct Totals {
    parts: u64,
    triangles: u64,
    vertex_bytes: u64,
}

impl Totals {
    fn add(&mut self, pieces: &[Piece], instances: u64) -> &Self {
        // Saturating: counts in a hostile file can exceed u64, and are then refused as too many.
        let parts = (pieces.len() as u64).saturating_mul(instances);
        self.parts = self.parts.saturating_add(parts);
        for piece in pieces {
            let bytes = 24 + 8 * piece.uvs.len() + 16 * usize::from(piece.colours.is_some());
            let bytes = bytes + 12 * usize::from(piece.normals.is_some());
            let bytes = bytes as u64;
            let bytes = piece.positions.count.saturating_mul(bytes);
            let all = |each: u64| each.saturating_mul(instances);
            self.vertex_bytes = self.vertex_bytes.saturating_add(all(bytes));
            self.triangles = self.triangles.saturating_add(all(piece.triangles));
        }
        self
    }

    fn check(&self, document: &Document, node: usize) -> Result<()> {
        let what = match self {
            _ if self.triangles > MOST_TRIANGLES => format!("{MOST_TRIANGLES} triangles"),
            _ if self.vertex_bytes > MOST_VERTEX_BYTES => "2 GiB of vertices".to_owned(),
            _ if self.parts > MOST_PARTS => format!("{MOST_PARTS} primitives"),
            _ => return Ok(()),
        };
        Err(document.unsupported(
            document.node_label(node),
            format!("with this node there are more than {what}"),
            "import fewer nodes, or a coarser mesh",
        ))
    }
}

fn nothing(document: &Document, placed: &[Placed]) -> crate::Error {
    document.invalid(
        match placed {
            [first, ..] => document.node_label(first.node),
            [] => "scene".to_owned(),
        },
        "there are no triangles here or in the nodes below",
        "choose a node that has a mesh, or export the model with its meshes",
    )
}

/// The index of the mesh that a node places.
fn mesh_of(document: &Document, node: usize, warnings: &mut Warnings) -> Result<Option<usize>> {
    let Some(described) = document.root.nodes.get(node) else {
        return Ok(None);
    };
    let Some(index) = described.mesh else {
        return Ok(None);
    };
    let place = document.node_label(node);
    document.get(index, "mesh", &place)?;
    if described.skin.is_some() {
        warnings.add(
            "skins are not applied: the mesh is at its rest pose",
            &place,
        );
    }
    Ok(Some(index.value()))
}
