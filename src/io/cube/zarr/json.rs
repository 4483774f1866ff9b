//! The JSON that describes arrays and groups.

use std::io::Read;
use std::path::Path;

use serde_json::{Map, Value};

use crate::error::{Error, Result};
use crate::io::open::open_regular;

/// The longest document that is read, bytes.
const LONGEST: u64 = 16 << 20;

/// The JSON of a node.
pub(super) fn document(file: &Path) -> Result<Map<String, Value>> {
    let (reader, length) = open_regular(file)?;
    let invalid =
        |what: String| Error::invalid(file, "", what, "copy the array again, or write it again");
    if length > LONGEST {
        return Err(invalid("it is too long to describe an array".into()));
    }
    let mut text = Vec::new();
    (reader.take(LONGEST).read_to_end(&mut text)).map_err(Error::io(file, "cannot read"))?;
    match serde_json::from_slice(&text) {
        Ok(Value::Object(document)) => Ok(document),
        Ok(_) => Err(invalid("it is not a JSON object".into())),
        Err(error) => Err(invalid(format!("it is not JSON: {error}"))),
    }
}
