//! Nodes with many copies of their mesh (EXT_mesh_gpu_instancing): each instance has its own transform T·R·S, which is applied before
//! that of the node.

use ::gltf::json::Index;
use ::gltf::json::accessor::Accessor;
use glam::{DAffine3, DVec3};

use super::accessor::{self, Layout, Purpose};
use super::buffers::Buffers;
use super::document::Document;
use super::nodes::{extension, placing};
use crate::Result;

const NAME: &str = "EXT_mesh_gpu_instancing";
const HELP: &str = "export the model with each instance as a separate node";

/// The instances of a node's mesh, checked.
#[derive(Debug, Clone)]
pub(super) struct Instances {
    /// The number of instances.
    pub count: u64,
    translation: Option<Layout>,
    rotation: Option<Layout>,
    scale: Option<Layout>,
    place: String,
}

impl Instances {
    /// The instances of a node; `None` if its mesh is placed once, without EXT_mesh_gpu_instancing.
    pub fn of(document: &Document, node: usize) -> Result<Option<Instances>> {
        let attributes = &extension(document, node, NAME)["attributes"];
        let Some(attributes) = attributes.as_object() else {
            return Ok(None);
        };
        let place = format!("{}, {NAME}", document.node_label(node));
        let layout = |name: &str, purpose: Purpose| {
            let Some(value) = attributes.get(name) else {
                return Ok(None);
            };
            let index = value.as_u64().and_then(|index| u32::try_from(index).ok());
            let Some(index) = index else {
                let what = format!("{name} is not the number of an accessor");
                return Err(document.invalid(&place, what, HELP));
            };
            Layout::new(document, Index::<Accessor>::new(index), purpose, &place).map(Some)
        };
        let [translation, rotation, scale] = [
            layout("TRANSLATION", Purpose::Vectors)?,
            layout("ROTATION", Purpose::Rotations)?,
            layout("SCALE", Purpose::Vectors)?,
        ];
        // Each attribute may be left out; those that are given have a value for each instance.
        let layouts = [&translation, &rotation, &scale].into_iter().flatten();
        let counts: Vec<u64> = layouts.map(|layout| layout.count).collect();
        let Some(&count) = counts.first() else {
            return Ok(None);
        };
        if let Some(other) = counts.iter().find(|&&other| other != count) {
            let what = format!("it has {count} instances in one attribute and {other} in another");
            let help = "all attributes of the instances have the same count";
            return Err(document.invalid(&place, what, help));
        }
        Ok(Some(Instances {
            count,
            translation,
            rotation,
            scale,
            place,
        }))
    }

    /// The transforms of the instances, in order.
    pub fn read(&self, buffers: &mut Buffers) -> Result<Vec<DAffine3>> {
        // What is left out is the identity.
        let count = self.count as usize;
        let mut translations = vec![DVec3::ZERO; count];
        let mut scales = vec![DVec3::ONE; count];
        let mut rotations = vec![[0.0, 0.0, 0.0, 1.0]; count];
        for (layout, vectors) in [
            (&self.translation, &mut translations),
            (&self.scale, &mut scales),
        ] {
            if let Some(layout) = layout {
                accessor::read::<3>(buffers, layout, &mut |at, v| {
                    vectors[at as usize] = DVec3::from_array(v);
                })?;
            }
        }
        if let Some(layout) = &self.rotation {
            accessor::read::<4>(buffers, layout, &mut |at, q| rotations[at as usize] = q)?;
        }
        // Quaternions need not have length 1: `placing` takes their squared length.
        let mut transforms = Vec::with_capacity(count);
        for at in 0..count {
            let norm = rotations[at].iter().map(|c| c * c).sum::<f64>();
            let transform = placing(translations[at], (rotations[at], norm), scales[at]);
            if !(norm > 0.0 && transform.is_finite()) {
                let what = format!(
                    "the transform of instance {at} is not finite, or its rotation is zero"
                );
                let help = "translations and scales are finite, rotations quaternions of length 1";
                return Err(buffers.document.invalid(&self.place, what, help));
            }
            transforms.push(transform);
        }
        Ok(transforms)
    }
}
