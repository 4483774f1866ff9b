//! The contents of a file, from its JSON only.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::buffers::Buffers;
use super::camera;
use super::document::Document;
use super::draft::Draft;
use super::glass;
use super::import::{BadTextures, BadVertices, Want};
use super::lights;
use super::pieces::Pieces;
use super::uri::{self, Target};
use crate::error::{Message, Result};
use crate::mesh::{Factors, Material};

/// What an import would read, and what else could be chosen.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct GltfSummary {
    /// The program that wrote the file, if stated.
    pub generator: Option<String>,
    /// Names of the nodes that would be imported, top down; "" for a node without one.
    pub nodes: Vec<String>,
    /// The number of different meshes that they use.
    pub meshes: usize,
    /// The number of triangle primitives that they place.
    pub primitives: usize,
    /// Triangles.
    pub triangles: u64,
    /// Vertices of all primitives (fewer are stored if primitives share them).
    pub vertices: u64,
    /// Names of the materials in use; "" for one without a name, and for the default material.
    pub materials: Vec<String>,
    /// Which of them is the default material, of primitives without one.
    pub default_material: Option<usize>,
    /// Material factors of each of them.
    pub factors: Vec<Factors>,
    /// The number of different images that they use.
    pub images: usize,
    /// Whether a material has a texture of metalness and roughness.
    pub has_gloss_textures: bool,
    /// Whether one of them has an alpha mask, that is, holes.
    pub has_masks: bool,
    /// Whether vertices have colours.
    pub has_colours: bool,
    /// Whether vertices have normals.
    pub has_normals: bool,
    /// Names of the materials that show their base colours under any light (KHR_materials_unlit).
    pub unlit: Vec<String>,
    /// The number of texture coordinate sets: the highest number, plus one.
    pub uv_sets: usize,
    /// Names of the lights (KHR_lights_punctual) that [`lights`](super::lights) finds; "" for one without a name.
    pub lights: Vec<String>,
    /// Names by which [`camera`](super::camera) finds the cameras of the whole file.
    pub cameras: Vec<String>,
    /// Names of the animations of the whole file; "" for one without a name.
    pub animations: Vec<String>,
    /// The files to which the whole file refers (buffers and images), without repetitions; they need not exist.
    pub files: Vec<PathBuf>,
    /// The minimum and maximum corner of a box around all vertices, metres, as the file declares it (which is not checked); `None` if it
    /// does not.
    pub bounds: Option<[DVec3; 2]>,
    /// Bytes that skins and morph targets take while the vertices of one primitive are placed, for the primitive that needs most.
    pub placing: u64,
    /// What would be ignored, with its place, one sentence each.
    pub warnings: Vec<String>,
}

/// The contents of a file as its nodes place them, from the counts of accessors only: instances count each time.
pub(super) fn summary(
    document: &mut Document,
    node: Option<&str>,
    bad_textures: BadTextures,
) -> Result<GltfSummary> {
    let want = Want {
        bad_vertices: BadVertices::Refuse,
        bad_textures,
        uvs: true,
        textures: true,
        shading: true,
        normals: true,
    };
    let mut draft = Draft::new(document, node, want)?;
    // What cannot be read is refused where it is loaded.
    let _ = glass::settle(&mut draft, &mut Buffers::new(document), bad_textures);
    let document = &*document;
    // Lights are those of the whole scene, whichever node is requested.
    let lit = match node {
        None => draft.nodes.clone(),
        Some(_) => Draft::new(document, None, want).map_or_else(|_| Vec::new(), |all| all.nodes),
    };
    let (pieces, used) = (&draft.pieces, used_materials(&draft));
    let default_material = used.iter().position(|(index, _)| index.is_none());
    let materials: Vec<&Material> = used.into_iter().map(|(_, material)| material).collect();
    let all = || pieces.all().map(|(at, piece)| (at.count(), piece));
    let meshes: BTreeSet<usize> = pieces.placements.iter().map(|at| at.mesh).collect();
    let textures = materials.iter().flat_map(|m| m.textures());
    let images: BTreeSet<usize> = textures.map(|texture| texture.image).collect();
    Ok(GltfSummary {
        generator: document.root.asset.generator.clone(),
        nodes: draft.nodes.iter().map(|&n| name(document, n)).collect(),
        meshes: meshes.len(),
        primitives: all().map(|(count, _)| count as usize).sum(),
        triangles: all().map(|(count, piece)| count * piece.triangles).sum(),
        vertices: all()
            .map(|(count, piece)| count * piece.positions.count)
            .sum(),
        images: images.len(),
        has_gloss_textures: (materials.iter()).any(|m| m.metallic_roughness_texture.is_some()),
        has_masks: materials.iter().any(|m| m.is_masked()),
        has_colours: pieces.all().any(|(_, piece)| piece.colours.is_some()),
        has_normals: pieces.all().any(|(_, piece)| piece.normals.is_some()),
        unlit: (materials.iter().filter(|m| m.unlit))
            .map(|m| m.name.clone())
            .collect(),
        uv_sets: draft.uv_sets(),
        materials: materials.iter().map(|m| m.name.clone()).collect(),
        default_material,
        factors: materials.iter().map(|m| m.factors()).collect(),
        lights: lights::names(document, &lit),
        cameras: camera::names(document),
        animations: (document.root.animations.iter())
            .map(|animation| animation.name.clone().unwrap_or_default())
            .collect(),
        files: files(document),
        bounds: bounds(document, pieces),
        placing: (pieces.all())
            .map(|(_, piece)| piece.positions.count.saturating_mul(piece.scratch()))
            .max()
            .unwrap_or(0),
        warnings: draft.warnings.into_sentences(),
    })
}

fn name(document: &Document, node: usize) -> String {
    let node = document.root.nodes.get(node);
    node.and_then(|node| node.name.clone()).unwrap_or_default()
}

/// Other files to which a document refers.
pub(super) fn files(document: &Document) -> Vec<PathBuf> {
    let Some(directory) = &document.directory else {
        return Vec::new();
    };
    let root = &document.root;
    let buffers = root.buffers.iter().filter_map(|b| b.uri.as_deref());
    let images = root.images.iter().filter_map(|i| i.uri.as_deref());
    let elsewhere = buffers.chain(images).filter(|u| !u.starts_with("data:"));
    let paths = elsewhere.filter_map(|u| match uri::parse(u) {
        Ok(Target::File(path)) => Some(directory.join(path)),
        _ => None,
    });
    paths.collect::<BTreeSet<_>>().into_iter().collect()
}

/// Refuses a file that refers to files outside its own folder; `help` says what to do instead.
pub(super) fn refuse_outside(document: &Document, help: impl Into<Message>) -> Result<()> {
    // An empty name is the current folder.
    let real = |folder: &Path| match folder.as_os_str().is_empty() {
        true => Path::new(".").canonicalize().ok(),
        false => folder.canonicalize().ok(),
    };
    let Some(own) = document.directory.as_deref().and_then(real) else {
        return Ok(());
    };
    for other in files(document) {
        // If a file does not exist, its folder decides.
        let in_folder = || Some(real(other.parent()?)?.join(other.file_name()?));
        let place = other.canonicalize().ok().or_else(in_folder);
        let place = place.unwrap_or_else(|| other.clone());
        if !place.starts_with(&own) {
            let what = format!(
                "it refers to {}, which is outside its folder",
                other.display()
            );
            return Err(document.invalid("uri", what, help));
        }
    }
    Ok(())
}

/// The materials of the pieces, without repetitions, in order of first use.
fn used_materials(draft: &Draft) -> Vec<(Option<usize>, &Material)> {
    let mut seen = BTreeSet::new();
    (draft.pieces.all().map(|(_, piece)| piece.material))
        .filter(|&material| seen.insert(material))
        .filter_map(|index| Some((index, &draft.materials.get(&index)?.material)))
        .collect()
}

/// A box around the declared boxes of all pieces, after placement.
fn bounds(document: &Document, pieces: &Pieces) -> Option<[DVec3; 2]> {
    let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    for (at, piece) in pieces.all() {
        // The positions of instances, weights of joints and displacements are in a buffer, and no buffer is read here.
        if at.instances.is_some() || at.skin.is_some() || !at.weights.is_empty() {
            return None;
        }
        let accessor = document.root.accessors.get(piece.positions.accessor)?;
        let least = corner(accessor.min.as_ref()?)?;
        let greatest = corner(accessor.max.as_ref()?)?;
        // A rotated box is enclosed by the box around its eight corners.
        for which in 0..8 {
            let pick = |axis: usize| [least, greatest][which >> axis & 1][axis];
            let corner = DVec3::new(pick(0), pick(1), pick(2));
            let placed = at.placed.world.transform_point3(corner);
            bounds = [bounds[0].min(placed), bounds[1].max(placed)];
        }
    }
    let finite = bounds.iter().all(|corner| corner.is_finite());
    finite.then_some(bounds)
}

fn corner(value: &::gltf::json::Value) -> Option<DVec3> {
    match value.as_array()?.as_slice() {
        [x, y, z] => Some(DVec3::new(x.as_f64()?, y.as_f64()?, z.as_f64()?)),
        _ => None,
    }
}
