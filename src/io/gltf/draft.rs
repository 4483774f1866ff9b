//! The result of checking all headers of an import: what will be read.

use std::collections::{BTreeMap, BTreeSet};

use ::gltf::json::animation::Animation;

use super::document::{Document, shortened};
use super::import::Want;
use super::lights;
use super::materials::{Resolved, resolve};
use super::nodes::{Hierarchy, Placed, parents};
use super::pieces::Pieces;
use super::primitive::Wanted;
use super::warnings::Warnings;
use crate::Result;

/// Materials by index in the document; `None` is the default material.
pub(super) type Materials = BTreeMap<Option<usize>, Resolved>;

/// An import with checked headers, before its data are read.
pub(super) struct Draft {
    pub pieces: Pieces,
    pub materials: Materials,
    pub warnings: Warnings,
    /// The imported nodes, top down.
    pub nodes: Vec<usize>,
}

impl Draft {
    /// Checks all headers that `node` and `want` need.
    pub fn new(document: &Document, node: Option<&str>, want: Want) -> Result<Self> {
        let mut warnings = Warnings::default();
        let hierarchy = Hierarchy::new(document, &mut warnings)?;
        let placed = hierarchy.select(document, node, &mut warnings)?;
        warn_of_unread(document, &placed, &mut warnings);
        let nodes: Vec<usize> = placed.iter().map(|placed| placed.node).collect();
        let used = materials_of(document, &nodes)?;
        let materials = resolve(document, used, want, &mut warnings)?;
        // Only the attributes that something will look up are read.
        let wanted = Wanted {
            set: &|material, set| {
                let of = materials.get(&material);
                want.uvs || of.is_some_and(|material| material.uses_set(set))
            },
            colours: &|material| {
                let of = materials.get(&material);
                want.textures || of.is_some_and(|material| material.is_masked())
            },
            normals: want.normals,
        };
        let pieces = Pieces::new(document, &placed, &hierarchy, wanted, &mut warnings)?;
        warn_of_missing_uvs(&pieces, &materials, &mut warnings);
        Ok(Draft {
            pieces,
            materials,
            warnings,
            nodes,
        })
    }

    /// The number of texture coordinate sets of the file that are read: the highest number, plus one.
    pub fn uv_sets(&self) -> usize {
        let pieces = self.pieces.of_mesh.values().flatten();
        let sets = pieces.flat_map(|piece| piece.uvs.keys());
        sets.max().map_or(0, |last| last + 1)
    }
}

/// The maximum number of extensions that are named in warnings: files with an exporter's own extensions have a few.
const MOST_NAMED: usize = 20;

/// The warning about a file's lights.
pub(crate) const LIGHTS_UNREAD: &str =
    "the file's lights shine in a scene only if it names them, by gltf and node in [[light]]";

/// The warning about a file's cameras.
pub(crate) const CAMERAS_UNREAD: &str =
    "the file's cameras are used only if a scene names them, by gltf and node in [camera]";

/// The warning about animations that move no mesh.
pub(crate) const ANIMATIONS_UNREAD: &str =
    "no mesh moves with it; cameras and lights follow it if motion.animation names it";

/// Warns about features of the file that are ignored as a whole.
fn warn_of_unread(document: &Document, placed: &[Placed], warnings: &mut Warnings) {
    // Extensions, whether or not the file says that it uses them.
    let mut unread = document.unread_extensions();
    for (name, is_declared) in unread.by_ref().take(MOST_NAMED) {
        let name = shortened(name);
        let (place, what) = match is_declared {
            true => (
                "extensionsUsed",
                format!("the extension {name:?} is not supported"),
            ),
            false => (
                "extensions",
                format!("the extension {name:?}, which extensionsUsed lacks, is not supported"),
            ),
        };
        warnings.add(what, place);
    }
    let more = unread.count();
    if more > 0 {
        let what = format!("{more} more extensions are not supported");
        warnings.add(what, "extensionsUsed");
    }
    // Animations: of meshes, of cameras and lights, and of what is no node.
    let what = "animations of meshes are not played: nodes, and joints of skins, stay as they are at rest (cameras and \
                lights follow them by motion.animation)";
    let animated = animations_of_meshes(document, placed);
    if let Some(first) = animated.first() {
        warnings.add_many(what, &format!("animation {first}"), animated.len() as u64);
    }
    let others = (0..document.root.animations.len()).filter(|k| !animated.contains(k));
    let others: Vec<usize> = others.collect();
    if let Some(first) = others.first() {
        warnings.add_many(
            ANIMATIONS_UNREAD,
            &format!("animation {first}"),
            others.len() as u64,
        );
    }
    for [animation, channel] in &document.without_node {
        let what = "it animates something other than a node, and is not played";
        warnings.add(what, &format!("animation {animation}, channel {channel}"));
    }
    // Cameras and lights, which only scenes place.
    let has_camera = |placed: &&Placed| {
        let node = document.root.nodes.get(placed.node);
        node.is_some_and(|node| node.camera.is_some())
    };
    let mut cameras = placed.iter().filter(has_camera);
    if let Some(first) = cameras.next() {
        let count = 1 + cameras.count() as u64;
        warnings.add_many(CAMERAS_UNREAD, &document.node_label(first.node), count);
    }
    let has_light = |&placed: &Placed| lights::index_of(document, placed.node).is_some();
    let lights: Vec<Placed> = placed.iter().copied().filter(has_light).collect();
    if let Some(first) = lights.first() {
        let place = document.node_label(first.node);
        warnings.add_many(LIGHTS_UNREAD, &place, lights.len() as u64);
        let limited = lights
            .iter()
            .filter(|placed| lights::has_range(document, placed.node));
        for placed in limited {
            let what =
                "the range of its light is not applied: light falls off as 1/r² at any distance";
            warnings.add(what, &document.node_label(placed.node));
        }
    }
}

/// Animations that move or deform a mesh of these nodes: those of the nodes themselves, of their ancestors, or of the joints of a skin.
fn animations_of_meshes(document: &Document, placed: &[Placed]) -> Vec<usize> {
    let nodes = &document.root.nodes;
    let meshes = placed.iter().map(|placed| placed.node);
    let meshes = meshes.filter(|&node| nodes.get(node).is_some_and(|node| node.mesh.is_some()));
    let meshes: Vec<usize> = meshes.collect();
    let skin = |&node: &usize| Some(nodes.get(node)?.skin?.value());
    let skins: BTreeSet<usize> = meshes.iter().filter_map(skin).collect();
    let skins = skins
        .iter()
        .filter_map(|&skin| document.root.skins.get(skin));
    let joints = skins.flat_map(|skin| &skin.joints);
    let joints = joints
        .map(|joint| joint.value())
        .filter(|&joint| joint < nodes.len());
    let parents = parents(document);
    // Nodes with a mesh or a joint at or below them; a hierarchy with placed nodes has no cycles.
    let mut carries = vec![false; nodes.len()];
    for node in meshes.iter().copied().chain(joints) {
        let mut next = Some(node);
        while let Some(node) = next.filter(|&node| !carries[node]) {
            carries[node] = true;
            next = parents[node];
        }
    }
    let moves_mesh = |animation: &Animation| {
        let mut targets = animation.channels.iter().map(|c| c.target.node.value());
        targets.any(|node| carries.get(node).is_some_and(|carries| *carries))
    };
    let animations = document.root.animations.iter().enumerate();
    animations
        .filter(|(_, a)| moves_mesh(a))
        .map(|(k, _)| k)
        .collect()
}

/// Warns about meshes that show textures as if they were white.
fn warn_of_missing_uvs(pieces: &Pieces, materials: &Materials, warnings: &mut Warnings) {
    for (_, piece) in pieces.all() {
        let material = materials.get(&piece.material);
        let mut sets = material.into_iter().flat_map(Resolved::sets);
        if let Some(set) = sets.find(|set| !piece.uvs.contains_key(set)) {
            let what = format!(
                "it lacks the texture coordinates TEXCOORD_{set} of its material's texture, which is not shown"
            );
            warnings.add(what, &piece.positions.place);
        }
    }
}

/// The materials of the meshes of these nodes; checks that each exists.
fn materials_of(document: &Document, nodes: &[usize]) -> Result<BTreeSet<Option<usize>>> {
    let root = &document.root;
    let mesh = |&node: &usize| Some(root.nodes.get(node)?.mesh?.value());
    let meshes: BTreeSet<usize> = nodes.iter().filter_map(mesh).collect();
    let mut materials = BTreeSet::new();
    for (index, mesh) in meshes
        .iter()
        .filter_map(|&m| Some((m, root.meshes.get(m)?)))
    {
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            if let Some(material) = primitive.material
                && root.get(material).is_none()
            {
                let place = document.primitive_label(index, number);
                document.get(material, "material", &place)?;
            }
            materials.insert(primitive.material.map(|material| material.value()));
        }
    }
    Ok(materials)
}
