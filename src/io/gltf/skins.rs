//! Skins (glTF 2.0 §3.7.3): each vertex follows some joints, which are nodes, at the poses that the file itself gives them. No animation is
//! played.
//!
//! With W_j the world transform of joint j, B_j its inverse bind matrix, and w_j the weights of a vertex, which follows M = Σ w_j W_j B_j / Σ w_j,
//!
//! ```text
//! p′ = M p,   n′ ∝ cof(M) n
//! ```
//!
//! in the coordinates of the file's root: the transform of the node that has the mesh does not count. Dividing by Σ w_j leaves no trace of
//! the rounding of single precision and of bytes.

use ::gltf::json::Index;
use ::gltf::json::skin;
use glam::{DAffine3, DMat3, DVec3};

use super::accessor::{self, Layout, Purpose};
use super::buffers::Buffers;
use super::document::{Document, label};
use super::import::BadVertices;
use super::nodes::Hierarchy;
use super::warnings::Warnings;
use crate::Result;

/// The maximum number of joints of all skins of an import.
const MOST_JOINTS: usize = 1 << 20;
/// The sum of a vertex's weights deviates from 1 by less, if they were meant to add up to it: two steps of bytes.
const SUM: f64 = 0.01;

/// A skin with checked headers.
#[derive(Debug, Clone)]
pub(super) struct Skin {
    /// The world transforms of its joints.
    joints: Vec<DAffine3>,
    /// Inverse bind matrices; identities if absent.
    inverse: Option<Layout>,
}

impl Skin {
    /// Skin `index` of a node; `used` joints of other skins count towards the limit.
    pub fn of(
        document: &Document,
        hierarchy: &Hierarchy,
        index: Index<skin::Skin>,
        node: usize,
        used: usize,
    ) -> Result<Skin> {
        let skin = document.get(index, "skin", &document.node_label(node))?;
        let place = label("skin", index.value(), skin.name.as_deref());
        let invalid = |what: String, help: &str| Err(document.invalid(&place, what, help));
        if skin.joints.is_empty() {
            return invalid(
                "it has no joints".into(),
                "a skin lists the nodes that are its joints",
            );
        }
        if used + skin.joints.len() > MOST_JOINTS {
            let what = format!("with it, the skins have more than {MOST_JOINTS} joints");
            return Err(document.unsupported(place, what, "import fewer nodes"));
        }
        for &joint in &skin.joints {
            document.get(joint, "node", &place)?;
        }
        let inverse = (skin.inverse_bind_matrices)
            .map(|matrices| Layout::new(document, matrices, Purpose::Matrices, &place))
            .transpose()?;
        if let Some(inverse) = &inverse
            && (inverse.count < skin.joints.len() as u64 || inverse.count > MOST_JOINTS as u64)
        {
            let (joints, matrices) = (skin.joints.len(), inverse.count);
            let what = format!("it has {joints} joints and {matrices} inverse bind matrices");
            return invalid(what, "a skin has an inverse bind matrix for each joint");
        }
        let joints = skin.joints.iter();
        Ok(Skin {
            joints: joints.map(|joint| hierarchy.world(joint.value())).collect(),
            inverse,
        })
    }

    /// The number of its joints.
    pub fn len(&self) -> usize {
        self.joints.len()
    }

    /// W_j B_j of each joint.
    pub fn read(&self, buffers: &mut Buffers, warnings: &mut Warnings) -> Result<Vec<DAffine3>> {
        let mut matrices = self.joints.clone();
        let Some(layout) = &self.inverse else {
            return Ok(matrices);
        };
        let mut skewed = 0;
        accessor::read::<16>(buffers, layout, &mut |at, m| {
            let at = at as usize;
            if let (Some(matrix), Some(world)) = (matrices.get_mut(at), self.joints.get(at)) {
                skewed += u64::from([m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0]);
                let column = |k: usize| DVec3::new(m[4 * k], m[4 * k + 1], m[4 * k + 2]);
                *matrix = *world
                    * DAffine3 {
                        matrix3: DMat3::from_cols(column(0), column(1), column(2)),
                        translation: column(3),
                    };
            }
        })?;
        let what = "inverse bind matrices whose last row is not 0, 0, 0, 1: taken as if it were";
        warnings.add_many(what, &layout.place, skewed);
        match matrices.iter().position(|matrix| !matrix.is_finite()) {
            None => Ok(matrices),
            Some(at) => Err(buffers.document.invalid(
                format!("{}, matrix {at}", layout.place),
                "the inverse bind matrix is not finite, or not after the transform of its joint",
                "inverse bind matrices are finite numbers: export the model again",
            )),
        }
    }
}

/// Four joints of each vertex, and their weights.
#[derive(Debug, Clone)]
pub(super) struct Influences {
    pub joints: Layout,
    pub weights: Layout,
}

/// Which joints the vertices of a primitive follow.
pub(super) struct Binding {
    /// In each set, by vertex: joints, and their weights.
    sets: Vec<[Vec<[f64; 4]>; 2]>,
}

impl Binding {
    /// Bytes per vertex in each set.
    pub const BYTES: u64 = 2 * 32;

    /// Reads the joints of a primitive. A vertex with a weight that is negative or not finite is refused, or follows NaN, which drops its
    /// triangles.
    pub fn read(
        buffers: &mut Buffers,
        influences: &[Influences],
        joints: usize,
        bad: BadVertices,
        warnings: &mut Warnings,
    ) -> Result<Binding> {
        let mut sets = Vec::with_capacity(influences.len());
        for set in influences {
            let [mut of, mut weights] = [(); 2].map(|()| vec![[0.0; 4]; set.joints.count as usize]);
            accessor::read::<4>(buffers, &set.joints, &mut |at, v| of[at as usize] = v)?;
            accessor::read::<4>(buffers, &set.weights, &mut |at, v| weights[at as usize] = v)?;
            for (at, (of, weights)) in of.iter_mut().zip(&mut weights).enumerate() {
                let invalid = |layout: &Layout, what: String, help: &str| {
                    let place = format!("{}, vertex {at}", layout.place);
                    Err(buffers.document.invalid(place, what, help))
                };
                if !weights.iter().all(|w| (0.0..=f64::MAX).contains(w)) {
                    if bad == BadVertices::Refuse {
                        let [a, b, c, d] = *weights;
                        let what = format!("the weights of its joints are {a}, {b}, {c}, {d}");
                        let help = "weights are finite and not negative; bad_vertices = \"drop\" leaves their triangles out";
                        return invalid(&set.weights, what, help);
                    }
                    *weights = [f64::NAN; 4];
                    *of = [0.0; 4];
                }
                for (joint, weight) in of.iter_mut().zip(&*weights) {
                    if *weight == 0.0 {
                        // Exporters leave anything in joints that do not count.
                        *joint = 0.0;
                    } else if *joint >= joints as f64 {
                        let what =
                            format!("it follows joint {joint} of a skin with {joints} joints");
                        return invalid(&set.joints, what, "every joint must be one of the skin");
                    }
                }
            }
            sets.push([of, weights]);
        }
        let binding = Binding { sets };
        let vertices = influences
            .first()
            .map_or(0, |set| set.joints.count as usize);
        let sums = || (0..vertices).map(|vertex| binding.sum(vertex));
        if let Some(first) = influences.first() {
            let place = &first.weights.place;
            let free = sums().filter(|sum| *sum == 0.0).count();
            let what = "vertices without weights follow the first joint of their skin";
            warnings.add_many(what, place, free as u64);
            let uneven = sums().filter(|sum| *sum != 0.0 && (sum - 1.0).abs() > SUM);
            let what = "weights of joints that do not add up to 1 are divided by their sum";
            warnings.add_many(what, place, uneven.count() as u64);
        }
        Ok(binding)
    }

    fn sum(&self, vertex: usize) -> f64 {
        let weights = self.sets.iter().flat_map(|[_, weights]| &weights[vertex]);
        weights.sum()
    }

    /// M of a vertex.
    pub fn matrix(&self, matrices: &[DAffine3], vertex: usize) -> DAffine3 {
        let sum = self.sum(vertex);
        if sum == 0.0 {
            return matrices[0];
        }
        let mut blended = DAffine3::ZERO;
        for [joints, weights] in &self.sets {
            for (joint, weight) in joints[vertex].iter().zip(&weights[vertex]) {
                if *weight == 0.0 {
                    continue;
                }
                let (matrix, part) = (matrices[*joint as usize], weight / sum);
                blended.matrix3 += matrix.matrix3 * part;
                blended.translation += matrix.translation * part;
            }
        }
        blended
    }
}
