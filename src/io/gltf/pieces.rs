//! The triangles that a document declares: its primitives, placed, with every header checked and no data read. Planning uses these, and
//! loading reads what they describe.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use super::document::Document;
use super::instances::Instances;
use super::morphs::{self, AllWeights, Weights};
use super::nodes::{HIDDEN, Hierarchy, Placed};
use super::primitive::{Deformed, Piece, Wanted, of_mesh};
use super::skins::{Binding, Skin};
use super::warnings::Warnings;
use crate::Result;

/// The maximum number of triangles of one import. Nodes may repeat a mesh, so a small file can request any number of them; the same holds
/// for the next two limits.
const MOST_TRIANGLES: u64 = 1 << 26;

/// The maximum number of bytes of vertices (24 for a position, 8 for a pair of texture coordinates, 12 for a normal, 16 for a colour).
const MOST_VERTEX_BYTES: u64 = 1 << 31;

/// The maximum number of displacements of vertices by morph targets.
const MOST_DISPLACED: u64 = 1 << 30;

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
    /// The index of the skin in the document, which places the mesh instead of the node.
    pub skin: Option<usize>,
    /// Of its morph targets.
    pub weights: Weights,
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
    /// The skins in use, by index in the document.
    pub skins: BTreeMap<usize, Skin>,
}

impl Pieces {
    /// Checks the triangle primitives of `placed`.
    pub fn new(
        document: &Document,
        placed: &[Placed],
        hierarchy: &Hierarchy,
        wanted: Wanted,
        warnings: &mut Warnings,
    ) -> Result<Self> {
        let mut pieces = Pieces::default();
        let mut deformed = BTreeMap::<usize, Deformed>::new();
        let mut weights = AllWeights::default();
        let mut joints = 0;
        for &placed in placed {
            let node = placed.node;
            let Some(mesh) = mesh_of(document, node)? else {
                continue;
            };
            let skin = document.root.nodes.get(node).and_then(|node| node.skin);
            if let Some(index) = skin
                && let Entry::Vacant(entry) = pieces.skins.entry(index.value())
            {
                let skin = entry.insert(Skin::of(document, hierarchy, index, node, joints)?);
                joints += skin.len();
            }
            let placement = Placement {
                placed,
                mesh,
                instances: Instances::of(document, node)?.filter(|_| skin.is_none()),
                instance: 0,
                skin: skin.map(|skin| skin.value()),
                weights: weights.of(document, node, mesh, warnings)?,
            };
            let deformed = deformed.entry(mesh).or_default();
            deformed.by_skin |= skin.is_some();
            deformed
                .by_targets
                .extend(placement.weights.iter().map(|(target, _)| target));
            pieces.placements.push(placement);
        }
        let mut totals = Totals::default();
        for at in &pieces.placements {
            let of_mesh = match pieces.of_mesh.entry(at.mesh) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(entry) => {
                    let deformed = &deformed[&at.mesh];
                    entry.insert(of_mesh(document, at.mesh, wanted, deformed, warnings)?)
                }
            };
            totals.add(of_mesh, at).check(document, at.placed.node)?;
        }
        let has_meshes = !pieces.placements.is_empty();
        let of_mesh = &pieces.of_mesh;
        let has_triangles =
            |at: &Placement| of_mesh.get(&at.mesh).is_some_and(|all| !all.is_empty());
        pieces.placements.retain(has_triangles);
        match pieces.placements.is_empty() {
            false => Ok(pieces),
            true => Err(nothing(document, placed, has_meshes, warnings)),
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
    displaced: u64,
}

impl Totals {
    fn add(&mut self, pieces: &[Piece], at: &Placement) -> &Self {
        let instances = at.count();
        // Saturating: counts in a hostile file can exceed u64, and are then refused as too many.
        let parts = (pieces.len() as u64).saturating_mul(instances);
        self.parts = self.parts.saturating_add(parts);
        for piece in pieces {
            let bytes = 24 + 8 * piece.uvs.len() + 16 * usize::from(piece.colours.is_some());
            let bytes = bytes + 12 * usize::from(piece.normals.is_some());
            let bytes = bytes as u64 + piece.scratch();
            let bytes = piece.positions.count.saturating_mul(bytes);
            let all = |each: u64| each.saturating_mul(instances);
            self.vertex_bytes = self.vertex_bytes.saturating_add(all(bytes));
            self.triangles = self.triangles.saturating_add(all(piece.triangles));
            let targets = if piece.targets.is_empty() {
                0
            } else {
                at.weights.len() as u64
            };
            let displaced = all(piece.positions.count.saturating_mul(targets));
            self.displaced = self.displaced.saturating_add(displaced);
        }
        self
    }

    fn check(&self, document: &Document, node: usize) -> Result<()> {
        let what = match self {
            _ if self.triangles > MOST_TRIANGLES => format!("{MOST_TRIANGLES} triangles"),
            _ if self.vertex_bytes > MOST_VERTEX_BYTES => "2 GiB of vertices".to_owned(),
            _ if self.displaced > MOST_DISPLACED => {
                format!("{MOST_DISPLACED} displacements by morph targets")
            }
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

impl Piece {
    /// Bytes per vertex for its deformation, while it is read.
    pub fn scratch(&self) -> u64 {
        let displaced = if self.targets.is_empty() {
            0
        } else {
            morphs::BYTES
        };
        Binding::BYTES * self.influences.len() as u64 + displaced
    }
}

fn nothing(
    document: &Document,
    placed: &[Placed],
    has_meshes: bool,
    warnings: &Warnings,
) -> crate::Error {
    let place = match placed {
        [first, ..] => document.node_label(first.node),
        [] => "scene".to_owned(),
    };
    let shown =
        "make nodes visible and export the model again, or name a hidden node, which is then shown";
    let (what, help) = match (has_meshes, placed.is_empty(), warnings.has(HIDDEN)) {
        (true, ..) => (
            "there are only points and lines here and in the nodes below: nothing with a surface",
            "choose a node with triangles, or give points and lines a thickness before exporting",
        ),
        (false, true, true) => ("all nodes are hidden (KHR_node_visibility)", shown),
        (false, false, true) => (
            "there are no triangles here or in the nodes below, apart from hidden ones (KHR_node_visibility)",
            shown,
        ),
        (false, _, false) => (
            "there are no triangles here or in the nodes below",
            "choose a node that has a mesh, or export the model with its meshes",
        ),
    };
    document.invalid(place, what, help)
}

/// The index of the mesh that a node places.
fn mesh_of(document: &Document, node: usize) -> Result<Option<usize>> {
    let Some(described) = document.root.nodes.get(node) else {
        return Ok(None);
    };
    let Some(index) = described.mesh else {
        return Ok(None);
    };
    document.get(index, "mesh", &document.node_label(node))?;
    Ok(Some(index.value()))
}
