//! `.zarray` and `.zattrs` of an array of version 2, converted to the equivalent `zarr.json`: "Zarr storage specification version 2".

use std::path::Path;

use serde_json::{Map, Value, json};

use super::json::document;
use crate::error::{Error, Result};

/// The file that describes an array.
pub(super) const ARRAY: &str = ".zarray";
/// The file that marks a folder as a group.
pub(super) const GROUP: &str = ".zgroup";

/// The prefix of the codec names that zarr-python uses beyond those of the specification.
pub(super) const NUMCODECS: &str = "numcodecs.";

/// The names of types here and in version 3; the first character gives the byte order.
const TYPES: [(&str, &str); 11] = [
    ("f2", "float16"),
    ("f4", "float32"),
    ("f8", "float64"),
    ("i1", "int8"),
    ("i2", "int16"),
    ("i4", "int32"),
    ("i8", "int64"),
    ("u1", "uint8"),
    ("u2", "uint16"),
    ("u4", "uint32"),
    ("u8", "uint64"),
];

/// The document of version 3 that describes the array in `folder`.
///
/// # Errors
/// Files that cannot be read, and features that version 3 does not have: numbers with several components, filters.
pub(super) fn as_version_3(folder: &Path) -> Result<Map<String, Value>> {
    let file = folder.join(ARRAY);
    let said = document(&file)?;
    let unsupported =
        |key: &str, what: String, help: &str| Error::unsupported(&file, key, what, help);
    let get = |key: &str| said.get(key).unwrap_or(&Value::Null);
    // Numbers: a character for the byte order, a letter for the kind, and the number of bytes.
    let text = get("dtype").as_str().unwrap_or_default();
    let (order, name) = text.split_at_checked(1).unwrap_or_default();
    let Some((_, number)) = TYPES.iter().find(|(own, _)| *own == name) else {
        let what = format!("samples of type {} cannot hold radiance", get("dtype"));
        return Err(unsupported("dtype", what, "give f2, f4, f8 or integers"));
    };
    let endian = if order == ">" { "big" } else { "little" };
    if let Some(filter) = get("filters")
        .as_array()
        .and_then(|filters| filters.first())
    {
        let name = filter.get("id").and_then(Value::as_str).unwrap_or_default();
        let what = format!("the filter {name:?} is not supported");
        let help = "write it without filters: zarr.create_array(..., filters=None)";
        return Err(unsupported("filters", what, help));
    }
    // The stored order, the bytes, and their compression.
    let axes = get("shape").as_array().map_or(0, Vec::len);
    let mut codecs = Vec::new();
    if get("order") == "F" {
        let turned: Vec<usize> = (0..axes).rev().collect();
        codecs.push(json!({ "name": "transpose", "configuration": { "order": turned } }));
    }
    codecs.push(json!({ "name": "bytes", "configuration": { "endian": endian } }));
    if let Some(compressor) = get("compressor").as_object() {
        let id = compressor
            .get("id")
            .and_then(Value::as_str)
            .unwrap_or_default();
        codecs.push(json!({ "name": format!("{NUMCODECS}{id}") }));
    }
    let fill = match get("fill_value") {
        Value::Null => json!(0),
        fill => fill.clone(),
    };
    let separator = get("dimension_separator").as_str().unwrap_or(".");
    let attributes = folder.join(".zattrs");
    let attributes = match attributes.is_file() {
        true => document(&attributes)?,
        false => Map::new(),
    };
    let described = json!({
        "zarr_format": 3,
        "node_type": "array",
        "shape": get("shape"),
        "data_type": number,
        "chunk_grid": { "name": "regular", "configuration": { "chunk_shape": get("chunks") } },
        "chunk_key_encoding": { "name": "v2", "configuration": { "separator": separator } },
        "fill_value": fill,
        "codecs": codecs,
        "attributes": attributes,
    });
    match described {
        Value::Object(described) => Ok(described),
        _ => Ok(Map::new()),
    }
}
