//! The node hierarchy (glTF 2.0 §3.5): world transforms, and the selection of nodes.
//!
//! A node's local transform is T·R·S or a matrix; its world transform is the product from the root down. The numbers of the file are read
//! as f64, and all products are computed in f64. Rotation quaternions are normalized, because most unit quaternions have no exact
//! decimals.

use ::gltf::json::Value;
use glam::{DAffine3, DMat3, DMat4, DVec3, DVec4};

use super::document::{Document, label, listed, shortened};
use super::warnings::Warnings;
use crate::Result;

/// A node and its world transform.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed {
    /// Index in the document.
    pub node: usize,
    /// From the node's coordinates to those of the file's root.
    pub world: DAffine3,
}

/// The hierarchy, checked to be a forest.
pub(super) struct Hierarchy {
    /// World transform of every node.
    worlds: Vec<DAffine3>,
    children: Vec<Vec<usize>>,
    has_parent: Vec<bool>,
}

impl Hierarchy {
    pub fn new(document: &Document, warnings: &mut Warnings) -> Result<Self> {
        let (children, has_parent) = links(document)?;
        let nodes = &document.root.nodes;
        let mut hierarchy = Hierarchy {
            worlds: vec![DAffine3::IDENTITY; nodes.len()],
            children,
            has_parent,
        };
        let mut reached = vec![false; nodes.len()];
        let roots = hierarchy.roots().map(|root| (root, DAffine3::IDENTITY));
        let mut stack: Vec<_> = roots.collect();
        while let Some((index, parent)) = stack.pop() {
            check_visibility(document, index)?;
            let world = parent * local(document, index, warnings)?;
            if !world.is_finite() {
                let what = "its transform goes beyond the range of numbers";
                return Err(document.invalid(document.node_label(index), what, FINITE));
            }
            hierarchy.worlds[index] = world;
            reached[index] = true;
            stack.extend(hierarchy.below(index).iter().map(|&child| (child, world)));
        }
        // Every node has at most one parent, so nodes that no root reaches are in or below a cycle.
        match reached.iter().position(|&reached| !reached) {
            None => Ok(hierarchy),
            Some(node) => Err(document.invalid(
                document.node_label(node),
                "the node is part of a cycle or hangs below one",
                "a node may not be its own ancestor: remove the cycle from \"children\"",
            )),
        }
    }

    fn roots(&self) -> impl Iterator<Item = usize> {
        let roots = self.has_parent.iter().enumerate();
        roots
            .filter(|(_, has_parent)| !**has_parent)
            .map(|(node, _)| node)
    }

    fn below(&self, node: usize) -> &[usize] {
        self.children.get(node).map_or(&[], Vec::as_slice)
    }

    /// The world transform of `node`.
    pub fn world(&self, node: usize) -> DAffine3 {
        self.worlds.get(node).copied().unwrap_or(DAffine3::IDENTITY)
    }

    /// The nodes of the default scene, or the node named `name` and everything below it, in file order from the top down.
    pub fn select(
        &self,
        document: &Document,
        name: Option<&str>,
        warnings: &mut Warnings,
    ) -> Result<Vec<Placed>> {
        let tops = match name {
            Some(name) => vec![named(document, name)?],
            None => self.scene(document, warnings)?,
        };
        let mut seen = |&node: &usize| {
            let hidden = is_hidden(document, node);
            if hidden {
                warnings.add(HIDDEN, &document.node_label(node));
            }
            !hidden
        };
        // A node requested by name is always shown.
        let tops = match name {
            Some(_) => tops,
            None => tops.into_iter().filter(&mut seen).collect(),
        };
        Ok(self.with_all_below(tops, &mut seen))
    }

    /// `tops` and all nodes below them that are `seen`, parents before children.
    pub fn with_all_below(
        &self,
        tops: Vec<usize>,
        seen: &mut dyn FnMut(&usize) -> bool,
    ) -> Vec<Placed> {
        let mut stack: Vec<usize> = tops.into_iter().rev().collect();
        let mut placed = Vec::new();
        while let Some(node) = stack.pop() {
            let world = self.world(node);
            placed.push(Placed { node, world });
            let first = stack.len();
            stack.extend(self.below(node).iter().filter(|&child| seen(child)));
            stack[first..].reverse();
        }
        placed
    }

    /// The root nodes of the default scene; of the first scene if none is the default; all root nodes if there is no scene.
    fn scene(&self, document: &Document, warnings: &mut Warnings) -> Result<Vec<usize>> {
        let root = &document.root;
        let (index, scene) = match (root.scene, root.scenes.as_slice()) {
            (Some(index), _) => (index.value(), document.get(index, "scene", "scene")?),
            (None, []) => return Ok(self.roots().collect()),
            (None, [first, rest @ ..]) => {
                let several = u64::from(!rest.is_empty());
                warnings.add_many(
                    "there are several scenes and no default: taken",
                    "scene 0",
                    several,
                );
                (0, first)
            }
        };
        let place = label("scene", index, scene.name.as_deref());
        let mut seen = vec![false; root.nodes.len()];
        for node in scene.nodes.iter().map(|node| node.value()) {
            let what = match seen.get_mut(node) {
                None => format!("it refers to node {node}, which does not exist"),
                Some(true) => format!("it lists node {node} twice"),
                Some(_) if self.has_parent.get(node) == Some(&true) => {
                    format!("node {node} is the child of another node")
                }
                Some(seen) => {
                    *seen = true;
                    continue;
                }
            };
            let help = "a scene lists root nodes, each once";
            return Err(document.invalid(place, what, help));
        }
        Ok(scene.nodes.iter().map(|node| node.value()).collect())
    }
}

/// The data of an extension for a node; null if there are none.
pub(super) fn extension<'d>(document: &'d Document, node: usize, name: &str) -> &'d Value {
    let node = document.root.nodes.get(node);
    let all = node.and_then(|node| node.extensions.as_ref());
    let said = all.and_then(|all| all.others.get(name));
    said.unwrap_or(&Value::Null)
}

/// The warning about hidden nodes.
pub(super) const HIDDEN: &str =
    "hidden nodes and what is below them are left out (KHR_node_visibility)";

/// Whether a node is hidden, with everything below it.
fn is_hidden(document: &Document, node: usize) -> bool {
    visibility(document, node) == &Value::Bool(false)
}

/// What a node says of its visibility; null if it says nothing.
fn visibility<'d>(document: &'d Document, node: usize) -> &'d Value {
    &extension(document, node, "KHR_node_visibility")["visible"]
}

fn check_visibility(document: &Document, node: usize) -> Result<()> {
    match visibility(document, node) {
        Value::Null | Value::Bool(_) => Ok(()),
        Value::Number(_) | Value::String(_) | Value::Array(_) | Value::Object(_) => {
            let place = document.node_label(node);
            let what = "`visible` of its KHR_node_visibility is neither true nor false";
            Err(document.invalid(place, what, "`visible` is true or false"))
        }
    }
}

const FINITE: &str = "transforms must be finite numbers, and so must their products";

type Links = (Vec<Vec<usize>>, Vec<bool>);

/// The children of every node, and whether it has a parent; refuses nodes with two parents.
fn links(document: &Document) -> Result<Links> {
    let nodes = &document.root.nodes;
    let mut has_parent = vec![false; nodes.len()];
    let mut links = Vec::with_capacity(nodes.len());
    for (index, node) in nodes.iter().enumerate() {
        let children = node.children.iter().flatten().map(|child| child.value());
        let children: Vec<usize> = children.collect();
        for &child in &children {
            let what = match has_parent.get_mut(child) {
                Some(has_parent) if !*has_parent => {
                    *has_parent = true;
                    continue;
                }
                Some(_) => format!("its child, node {child}, has another parent already"),
                None => format!("its child, node {child}, does not exist"),
            };
            let help = "every node has one parent at most: the nodes must form a tree";
            return Err(document.invalid(document.node_label(index), what, help));
        }
        links.push(children);
    }
    Ok((links, has_parent))
}

/// The parent of every node that has one; the last if there are several, which no valid hierarchy has.
pub(super) fn parents(document: &Document) -> Vec<Option<usize>> {
    let nodes = &document.root.nodes;
    let mut parents = vec![None; nodes.len()];
    for (parent, node) in nodes.iter().enumerate() {
        for child in node.children.iter().flatten() {
            if let Some(of_child) = parents.get_mut(child.value()) {
                *of_child = Some(parent);
            }
        }
    }
    parents
}

/// The name of a node; for one without, its number: "node 3".
pub(super) fn name_of(document: &Document, node: usize) -> String {
    let described = document.root.nodes.get(node);
    let name = described.and_then(|node| node.name.as_deref());
    let name = name.filter(|name| !name.is_empty());
    name.map_or_else(|| format!("node {node}"), shortened)
}

/// Whether a node has this name, or none and this number.
pub(super) fn is_named(document: &Document, node: usize, name: &str) -> bool {
    let described = document.root.nodes.get(node);
    match described.and_then(|node| node.name.as_deref()) {
        None | Some("") => name.strip_prefix("node ") == Some(&node.to_string()),
        Some(own) => own == name,
    }
}

/// The only node with this name.
pub(super) fn named(document: &Document, name: &str) -> Result<usize> {
    let nodes = &document.root.nodes;
    let mut found = (0..nodes.len()).filter(|&node| is_named(document, node, name));
    let place = format!("node {:?}", shortened(name));
    match (found.next(), found.next()) {
        (Some(node), None) => Ok(node),
        (Some(first), Some(second)) => Err(document.invalid(
            place,
            format!("nodes {first} and {second} both have this name"),
            "give the intended node a unique name",
        )),
        _ => {
            let names = listed(nodes.iter().filter_map(|node| node.name.as_deref()));
            let help = format!("the nodes of the file: {names}");
            Err(document.invalid(place, "the file has no node of this name", help))
        }
    }
}

/// The quaternion of a node without a rotation.
pub(super) const NO_ROTATION: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

/// The local transform of the node.
pub(super) fn local(
    document: &Document,
    index: usize,
    warnings: &mut Warnings,
) -> Result<DAffine3> {
    let Some(node) = document.transforms.get(index) else {
        return Ok(DAffine3::IDENTITY);
    };
    let invalid = |what: &str, help: &str| {
        let place = document.node_label(index);
        Err(document.invalid(place, what, help))
    };
    let has_parts = node.translation.is_some() || node.rotation.is_some() || node.scale.is_some();
    if let Some(matrix) = &node.matrix {
        let matrix = DMat4::from_cols_array(matrix);
        return match (matrix.row(3) == DVec4::W, has_parts) {
            (true, false) => Ok(DAffine3::from_mat4(matrix)),
            (false, _) => invalid(
                "its matrix is not affine",
                "the last row must be 0, 0, 0, 1 (matrices are stored column by column)",
            ),
            (true, true) => invalid(
                "it has both a matrix and translation, rotation or scale",
                "give one of the two",
            ),
        };
    }
    let [x, y, z, w] = node.rotation.unwrap_or(NO_ROTATION);
    let norm = x * x + y * y + z * z + w * w;
    if !(norm > 0.0 && norm.is_finite()) {
        let help = "a rotation is a quaternion x, y, z, w of length 1";
        return invalid("its rotation has no direction", help);
    }
    // Single precision and rounding by exporters stay far below this.
    if (norm - 1.0).abs() > 2e-3 {
        let what = "the rotation is not of length 1: it is normalized";
        warnings.add(what, &document.node_label(index));
    }
    Ok(placing(
        DVec3::from_array(node.translation.unwrap_or_default()),
        ([x, y, z, w], norm),
        node.scale.map_or(DVec3::ONE, DVec3::from_array),
    ))
}

/// T·R·S, with the rotation by a quaternion and its squared length.
pub(super) fn placing(
    translation: DVec3,
    (quaternion, norm): ([f64; 4], f64),
    scale: DVec3,
) -> DAffine3 {
    let [right, up, back] = rotation(quaternion, norm);
    DAffine3 {
        matrix3: DMat3::from_cols(right * scale.x, up * scale.y, back * scale.z),
        translation,
    }
}

/// The columns of the rotation matrix of the quaternion `[x, y, z, w]` whose squared length is `norm`.
fn rotation([x, y, z, w]: [f64; 4], norm: f64) -> [DVec3; 3] {
    let s = 2.0 / norm;
    [
        DVec3::new(
            1.0 - s * (y * y + z * z),
            s * (x * y + w * z),
            s * (x * z - w * y),
        ),
        DVec3::new(
            s * (x * y - w * z),
            1.0 - s * (x * x + z * z),
            s * (y * z + w * x),
        ),
        DVec3::new(
            s * (x * z + w * y),
            s * (y * z - w * x),
            1.0 - s * (x * x + y * y),
        ),
    ]
}
