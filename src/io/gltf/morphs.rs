//! Morph targets (glTF 2.0 §3.7.2.2): displacements of positions and normals, each times a weight, which the node or else the mesh gives. The
//! displacements of texture coordinates, colours and tangents are not read.

use std::collections::BTreeMap;
use std::rc::Rc;

use glam::DVec3;

use super::accessor::{self, Layout};
use super::buffers::Buffers;
use super::document::Document;
use super::warnings::Warnings;
use crate::Result;

/// The targets with a weight other than 0, by index, and their weights.
pub(super) type Weights = Rc<[(usize, f64)]>;

/// A target with checked headers.
#[derive(Debug, Clone)]
pub(super) struct Target {
    pub positions: Option<Layout>,
    pub normals: Option<Layout>,
}

/// The weights at nodes.
#[derive(Default)]
pub(super) struct AllWeights {
    /// Of meshes, for the nodes that give none.
    of_mesh: BTreeMap<usize, Weights>,
}

impl AllWeights {
    /// The weights of the mesh at a node.
    pub fn of(
        &mut self,
        document: &Document,
        node: usize,
        mesh: usize,
        warnings: &mut Warnings,
    ) -> Result<Weights> {
        let root = &document.root;
        let own = root.nodes.get(node).and_then(|node| node.weights.as_ref());
        let weights = match (own, self.of_mesh.get(&mesh)) {
            (None, Some(known)) => Rc::clone(known),
            _ => {
                let mesh = root.meshes.get(mesh);
                let given = own.or(mesh.and_then(|mesh| mesh.weights.as_ref()));
                let given = given.map_or(&[][..], Vec::as_slice);
                if let Some(at) = given.iter().position(|weight| !weight.is_finite()) {
                    let what = format!("the weight of its morph target {at} is not finite");
                    let place = document.node_label(node);
                    return Err(document.invalid(place, what, "weights are finite numbers"));
                }
                let first = mesh.and_then(|mesh| mesh.primitives.first());
                let targets = first.and_then(|first| first.targets.as_ref());
                let targets = targets.map_or(0, Vec::len);
                if !given.is_empty() && given.len() != targets {
                    let what = format!(
                        "it has {} weights for {targets} morph targets: missing weights are 0",
                        given.len()
                    );
                    warnings.add(what, &document.node_label(node));
                }
                let weights = given.iter().copied().map(f64::from).enumerate();
                weights.filter(|(_, weight)| *weight != 0.0).collect()
            }
        };
        if own.is_none() {
            self.of_mesh.insert(mesh, Rc::clone(&weights));
        }
        Ok(weights)
    }
}

/// Bytes per vertex while displacements are added: one displacement, and a normal that is not placed yet.
pub(super) const BYTES: u64 = 2 * 24;

/// Adds displacements, each times its weight, to the vectors of a primitive.
pub(super) fn displace<'l>(
    buffers: &mut Buffers,
    displacements: impl Iterator<Item = (&'l Layout, f64)>,
    vectors: &mut [DVec3],
) -> Result<()> {
    for (layout, weight) in displacements {
        // Via a list, because a sparse accessor passes some elements twice.
        let mut deltas = vec![DVec3::ZERO; layout.count as usize];
        accessor::read::<3>(buffers, layout, &mut |at, delta| {
            deltas[at as usize] = DVec3::from_array(delta);
        })?;
        for (vector, delta) in vectors.iter_mut().zip(deltas) {
            *vector += weight * delta;
        }
    }
    Ok(())
}
