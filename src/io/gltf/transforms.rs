//! The transforms of nodes in double precision. The crate `gltf` rounds their numbers to single precision, which places a model on a globe
//! to half a metre.

use ::gltf::json::{self, deserialize};
use serde::Deserialize;

/// The numbers of a node in the JSON, as far as it has them.
#[derive(Debug, Default, Deserialize)]
pub(super) struct Numbers {
    pub matrix: Option<Box<[f64; 16]>>,
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
}

/// Those of each node of a JSON text.
pub(super) fn of_nodes(text: &[u8]) -> Result<Vec<Numbers>, json::Error> {
    #[derive(Deserialize)]
    struct Nodes {
        #[serde(default)]
        nodes: Vec<Numbers>,
    }
    Ok(deserialize::from_slice::<Nodes>(text)?.nodes)
}
