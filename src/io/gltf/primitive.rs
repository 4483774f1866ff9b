//! One primitive of a mesh (glTF 2.0 §3.7.2.1), with its headers checked.

use std::collections::{BTreeMap, BTreeSet};

use ::gltf::json::accessor::Type;
use ::gltf::json::mesh::{Mode, Primitive, Semantic};
use ::gltf::json::validation::Checked;

use super::accessor::{Layout, Purpose};
use super::document::Document;
use super::morphs::Target;
use super::skins::Influences;
use super::warnings::Warnings;
use crate::Result;

/// The maximum number of texture coordinate sets.
pub(super) const MOST_SETS: u32 = 16;

/// A triangle primitive.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub topology: Topology,
    pub positions: Layout,
    /// By set; sets that are not wanted are absent.
    pub uvs: BTreeMap<usize, Layout>,
    pub normals: Option<Layout>,
    pub colours: Option<Colours>,
    /// By set; none unless a node has a skin for it.
    pub influences: Vec<Influences>,
    /// The morph targets that are wanted, by index.
    pub targets: BTreeMap<usize, Target>,
    pub indices: Option<Layout>,
    /// Index in the document; `None` is the default material.
    pub material: Option<usize>,
    pub triangles: u64,
}

/// Vertex colours (COLOR_0), checked.
#[derive(Debug, Clone)]
pub(super) struct Colours {
    pub layout: Layout,
    /// Whether there is a fourth component.
    pub alpha: bool,
}

/// The attributes wanted in addition to positions, by material.
#[derive(Clone, Copy)]
pub(super) struct Wanted<'w> {
    /// Whether a texture coordinate set is wanted.
    pub set: &'w dyn Fn(Option<usize>, usize) -> bool,
    /// Whether vertex colours are wanted.
    pub colours: &'w dyn Fn(Option<usize>) -> bool,
    /// Whether normals are wanted, for any material.
    pub normals: bool,
}

/// What the nodes of a mesh need for its deformation.
#[derive(Debug, Default)]
pub(super) struct Deformed {
    /// Whether a node has a skin for it.
    pub by_skin: bool,
    /// The morph targets with a weight other than 0 at any node.
    pub by_targets: BTreeSet<usize>,
}

/// How corners form triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Topology {
    Triangles,
    Strip,
    Fan,
}

/// The triangle primitives of a mesh.
pub(super) fn of_mesh(
    document: &Document,
    mesh: usize,
    wanted: Wanted,
    deformed: &Deformed,
    warnings: &mut Warnings,
) -> Result<Vec<Piece>> {
    let primitives = document
        .root
        .meshes
        .get(mesh)
        .map_or(&[][..], |m| &m.primitives);
    let mut pieces = Vec::new();
    for (number, primitive) in primitives.iter().enumerate() {
        let at = Place {
            document,
            primitive,
            label: document.primitive_label(mesh, number),
        };
        if let Some(topology) = at.topology(warnings)? {
            pieces.push(at.piece(topology, wanted, deformed, warnings)?);
        }
    }
    Ok(pieces)
}

struct Place<'p, 'a> {
    document: &'p Document<'a>,
    primitive: &'p Primitive,
    label: String,
}

impl Place<'_, '_> {
    /// How it forms triangles; `None` if nothing would be visible.
    fn topology(&self, warnings: &mut Warnings) -> Result<Option<Topology>> {
        let has = |semantic| (self.primitive.attributes).contains_key(&Checked::Valid(semantic));
        let topology = match self.primitive.mode {
            Checked::Valid(Mode::Triangles) => Topology::Triangles,
            Checked::Valid(Mode::TriangleStrip) => Topology::Strip,
            Checked::Valid(Mode::TriangleFan) => Topology::Fan,
            Checked::Valid(_) => {
                warnings.add("points and lines have no surface: skipped", &self.label);
                return Ok(None);
            }
            Checked::Invalid => {
                let help = "mode must be 0 to 6; 4 is triangles";
                return Err(self.invalid("its mode is not valid in glTF", help));
            }
        };
        if !has(Semantic::Positions) {
            warnings.add("a primitive without positions: skipped", &self.label);
            return Ok(None);
        }
        if has(Semantic::Colors(1)) {
            warnings.add(
                "vertex colours after the first set are not read",
                &self.label,
            );
        }
        Ok(Some(topology))
    }

    fn piece(
        &self,
        topology: Topology,
        wanted: Wanted,
        deformed: &Deformed,
        warnings: &mut Warnings,
    ) -> Result<Piece> {
        let material = self.primitive.material.map(|material| material.value());
        let (positions, indices) = (self.positions()?, self.indices()?);
        // Without indices the vertices are the corners, in order.
        let corners = indices.as_ref().unwrap_or(&positions).count;
        Ok(Piece {
            topology,
            triangles: self.triangles(topology, corners)?,
            uvs: self.uvs(positions.count, &|set| (wanted.set)(material, set))?,
            normals: match wanted.normals {
                true => self.normals(positions.count)?,
                false => None,
            },
            colours: match (wanted.colours)(material) {
                true => self.colours(positions.count)?,
                false => None,
            },
            influences: match deformed.by_skin {
                true => self.influences(positions.count, warnings)?,
                false => Vec::new(),
            },
            targets: self.targets(positions.count, wanted.normals, &deformed.by_targets)?,
            positions,
            indices,
            material,
        })
    }

    fn positions(&self) -> Result<Layout> {
        match self
            .primitive
            .attributes
            .get(&Checked::Valid(Semantic::Positions))
        {
            Some(&index) => Layout::new(self.document, index, Purpose::Positions, &self.label),
            None => Err(self.invalid("it has no positions", "")),
        }
    }

    fn indices(&self) -> Result<Option<Layout>> {
        (self.primitive.indices)
            .map(|index| Layout::new(self.document, index, Purpose::Indices, &self.label))
            .transpose()
    }

    fn uvs(
        &self,
        vertices: u64,
        wanted: &dyn Fn(usize) -> bool,
    ) -> Result<BTreeMap<usize, Layout>> {
        let mut uvs = BTreeMap::new();
        for (semantic, &index) in &self.primitive.attributes {
            let set = match semantic {
                Checked::Valid(Semantic::TexCoords(set)) if wanted(*set as usize) => *set,
                _ => continue,
            };
            if set >= MOST_SETS {
                let what = format!("it has TEXCOORD_{set}");
                let help = "at most 16 texture coordinate sets are read, TEXCOORD_0 to TEXCOORD_15";
                return Err(self.document.unsupported(&self.label, what, help));
            }
            let layout = Layout::new(self.document, index, Purpose::TexCoords, &self.label)?;
            self.check_count(&layout, &format!("TEXCOORD_{set}"), vertices)?;
            uvs.insert(set as usize, layout);
        }
        Ok(uvs)
    }

    fn normals(&self, vertices: u64) -> Result<Option<Layout>> {
        let attributes = &self.primitive.attributes;
        let Some(&index) = attributes.get(&Checked::Valid(Semantic::Normals)) else {
            return Ok(None);
        };
        let layout = Layout::new(self.document, index, Purpose::Normals, &self.label)?;
        self.check_count(&layout, "NORMAL", vertices)?;
        Ok(Some(layout))
    }

    fn colours(&self, vertices: u64) -> Result<Option<Colours>> {
        let attributes = &self.primitive.attributes;
        let Some(&index) = attributes.get(&Checked::Valid(Semantic::Colors(0))) else {
            return Ok(None);
        };
        let accessor = self.document.get(index, "accessor", &self.label)?;
        let alpha = accessor.type_ == Checked::Valid(Type::Vec4);
        let purpose = Purpose::Colours { alpha };
        let layout = Layout::new(self.document, index, purpose, &self.label)?;
        self.check_count(&layout, "COLOR_0", vertices)?;
        Ok(Some(Colours { layout, alpha }))
    }

    /// The joints of its vertices.
    fn influences(&self, vertices: u64, warnings: &mut Warnings) -> Result<Vec<Influences>> {
        let attribute = |semantic| self.primitive.attributes.get(&Checked::Valid(semantic));
        let mut sets = Vec::new();
        for set in 0..MOST_SETS {
            let pair = (
                attribute(Semantic::Joints(set)),
                attribute(Semantic::Weights(set)),
            );
            let (joints, weights) = match pair {
                (Some(&joints), Some(&weights)) => (joints, weights),
                (None, None) => break,
                (joints, _) => {
                    let [has, lacks] = match joints {
                        Some(_) => ["JOINTS", "WEIGHTS"],
                        None => ["WEIGHTS", "JOINTS"],
                    };
                    let what = format!("it has {has}_{set} and no {lacks}_{set}");
                    return Err(self.invalid(&what, "joints and their weights come in pairs"));
                }
            };
            let joints = Layout::new(self.document, joints, Purpose::Joints, &self.label)?;
            self.check_count(&joints, &format!("JOINTS_{set}"), vertices)?;
            let weights = Layout::new(self.document, weights, Purpose::Weights, &self.label)?;
            self.check_count(&weights, &format!("WEIGHTS_{set}"), vertices)?;
            sets.push(Influences { joints, weights });
        }
        if sets.is_empty() {
            let what = "it has no JOINTS_0 for the skin of its node, and is placed by the node";
            warnings.add(what, &self.label);
        }
        Ok(sets)
    }

    /// The morph targets in `used`.
    fn targets(
        &self,
        vertices: u64,
        normals: bool,
        used: &BTreeSet<usize>,
    ) -> Result<BTreeMap<usize, Target>> {
        let all = self.primitive.targets.as_ref();
        let mut targets = BTreeMap::new();
        for &which in used {
            let Some(target) = all.and_then(|all| all.get(which)) else {
                continue;
            };
            let place = format!("{}, target {which}", self.label);
            let layout = |index, purpose, name: &str| -> Result<Option<Layout>> {
                let Some(index) = index else {
                    return Ok(None);
                };
                let layout = Layout::new(self.document, index, purpose, &place)?;
                self.check_count(&layout, name, vertices)?;
                Ok(Some(layout))
            };
            let target = Target {
                positions: layout(target.positions, Purpose::Displacements, "POSITION")?,
                normals: layout(target.normals.filter(|_| normals), Purpose::Tilts, "NORMAL")?,
            };
            targets.insert(which, target);
        }
        Ok(targets)
    }

    fn check_count(&self, layout: &Layout, name: &str, vertices: u64) -> Result<()> {
        if layout.count == vertices {
            return Ok(());
        }
        let what = format!(
            "{name} has {} elements and POSITION {vertices}",
            layout.count
        );
        let help = "all attributes of a primitive must have the same count";
        Err(self.document.invalid(&layout.place, what, help))
    }

    fn triangles(&self, topology: Topology, corners: u64) -> Result<u64> {
        match topology {
            Topology::Triangles if corners.is_multiple_of(3) => Ok(corners / 3),
            Topology::Strip | Topology::Fan if corners >= 3 => Ok(corners - 2),
            Topology::Triangles => Err(self.invalid(
                &format!("{corners} corners do not make whole triangles"),
                "the number of indices (or vertices, without indices) must be a multiple of 3",
            )),
            Topology::Strip | Topology::Fan => Err(self.invalid(
                &format!("{corners} corners do not make a triangle"),
                "a strip or fan needs at least three",
            )),
        }
    }

    fn invalid(&self, what: &str, help: &str) -> crate::Error {
        self.document.invalid(&self.label, what, help)
    }
}

impl Topology {
    /// Corners of triangle `i` in a list of corners (glTF 2.0 §3.7.2.1), all with the same winding.
    pub fn corners(self, i: usize) -> [usize; 3] {
        match self {
            Topology::Triangles => [3 * i, 3 * i + 1, 3 * i + 2],
            // Odd triangles swap two corners, or they would face the other way.
            Topology::Strip => [i, i + 1 + i % 2, i + 2 - i % 2],
            Topology::Fan => [i + 1, i + 2, 0],
        }
    }
}
