//! `zarr.json` of an array: "Zarr core specification (version 3)", its chunk grids, key encodings, data types and codecs. Arrays of version 2
//! are converted to it.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value};

use super::super::axes::Axes;
use super::super::axes::NAME_AXES;
use super::codecs::Codec;
use super::json::document;
use super::number::Number;
use super::version_2::{self, NUMCODECS};
use crate::error::{Error, Result};

/// The largest chunk, bytes once decoded.
const LARGEST_CHUNK: u64 = 1 << 30;
/// The most axes.
const MOST_AXES: usize = 16;

/// The description of an array.
#[derive(Debug, Clone)]
pub(super) struct Metadata {
    pub folder: PathBuf,
    pub shape: Vec<u64>,
    pub chunk: Vec<usize>,
    pub number: Number,
    pub fill: f64,
    pub codecs: Vec<Codec>,
    /// The separator of numbers in the file names of chunks; whether they start with `c`.
    separator: char,
    with_c: bool,
    /// The names of its axes, and where they come from; empty if there are none.
    pub names: Vec<String>,
    names_from: &'static str,
    pub attributes: Map<String, Value>,
}

impl Metadata {
    /// Reads the metadata of the array in `folder`.
    pub fn read(folder: &Path) -> Result<Metadata> {
        let file = folder.join(version_2::ARRAY);
        if file.is_file() {
            return Reading { file: &file }.array(folder, &version_2::as_version_3(folder)?);
        }
        let file = folder.join("zarr.json");
        Reading { file: &file }.array(folder, &document(&file)?)
    }

    /// The file of a chunk.
    pub fn chunk_file(&self, place: &[usize]) -> PathBuf {
        let numbers: Vec<String> = place.iter().map(usize::to_string).collect();
        let numbers = numbers.join(&self.separator.to_string());
        self.folder.join(match (self.with_c, numbers.as_str()) {
            (true, "") => "c".into(),
            (true, numbers) => format!("c{}{numbers}", self.separator),
            (false, "") => "0".into(),
            (false, numbers) => numbers.into(),
        })
    }

    /// Chunks along each axis.
    pub fn chunks(&self) -> Vec<usize> {
        let along = |(size, chunk): (&u64, &usize)| size.div_ceil(*chunk as u64) as usize;
        self.shape.iter().zip(&self.chunk).map(along).collect()
    }

    /// The order of its axes, and where it comes from: the attribute `axes`, or their names; `None` if it is not given.
    ///
    /// # Errors
    /// The given order is invalid: what it is, and what to do about it.
    pub fn axes(&self) -> Result<Option<(Axes, &'static str)>, (String, String)> {
        if let Some(text) = self.attributes.get("axes").and_then(Value::as_str) {
            let axes = text.parse::<Axes>().map_err(|error| {
                let what = format!("its attribute `axes` is {text:?}: {error}");
                (what, NAME_AXES.into())
            });
            return axes.map(|axes| Some((axes, "attribute `axes`")));
        }
        let axes = Axes::by_names(&self.names)?;
        Ok(axes.map(|axes| (axes, self.names_from)))
    }

    /// A numeric attribute of the array.
    pub fn number_of(&self, attribute: &str) -> Option<f64> {
        self.attributes.get(attribute)?.as_f64()
    }
}

struct Reading<'a> {
    file: &'a Path,
}

impl Reading<'_> {
    fn invalid(&self, key: &str, what: impl Into<String>) -> Error {
        Error::invalid(
            self.file,
            key,
            what,
            "copy the array again, or write it again",
        )
    }

    fn unsupported(&self, key: &str, what: impl Into<String>, help: &str) -> Error {
        Error::unsupported(self.file, key, what, help)
    }

    fn array(&self, folder: &Path, document: &Map<String, Value>) -> Result<Metadata> {
        if document.get("zarr_format") != Some(&Value::from(3)) {
            return Err(self.unsupported(
                "zarr_format",
                "this is not version 3",
                "write it as Zarr version 3",
            ));
        }
        self.refuse_unknown(document)?;
        let shape = self.sizes(document.get("shape"), "shape")?;
        if shape.len() > MOST_AXES {
            return Err(self.unsupported(
                "shape",
                format!("{} axes are too many", shape.len()),
                "save a part of it",
            ));
        }
        let number = self.number(document)?;
        // Chunks: a regular grid, in files named by their positions.
        let (name, grid) = self.named(document.get("chunk_grid"), "chunk_grid")?;
        if name != "regular" {
            let what = format!("chunk grids of the kind {name:?} are not supported");
            return Err(self.unsupported("chunk_grid", what, "write it with chunks of one size"));
        }
        let chunk = self.chunk(grid.get("chunk_shape"), shape.len(), number)?;
        let (name, keys) = self.named(document.get("chunk_key_encoding"), "chunk_key_encoding")?;
        let with_c = match name {
            "default" => true,
            "v2" => false,
            _ => {
                let what = format!("the encoding {name:?} of chunk keys is unknown");
                return Err(self.unsupported(
                    "chunk_key_encoding",
                    what,
                    "write it with default names",
                ));
            }
        };
        // The default of "default" is a slash, and that of "v2" a dot.
        let separator = match keys.get("separator").and_then(Value::as_str) {
            Some("/") => '/',
            Some(".") => '.',
            None if with_c => '/',
            None => '.',
            Some(other) => {
                return Err(self.invalid(
                    "chunk_key_encoding",
                    format!("{other:?} is not a separator"),
                ));
            }
        };
        let codecs = self.codecs(document.get("codecs"), &chunk, number)?;
        let attributes = match document.get("attributes") {
            Some(Value::Object(attributes)) => attributes.clone(),
            _ => Map::new(),
        };
        // The names of axes, from the format's own key, or else from the attribute that xarray writes.
        let names = [
            ("dimension_names", document.get("dimension_names")),
            (
                "attribute `_ARRAY_DIMENSIONS`",
                attributes.get("_ARRAY_DIMENSIONS"),
            ),
        ]
        .into_iter()
        .find_map(|(from, names)| Some((names_of(names)?, from)));
        let (names, names_from) = names.unwrap_or_default();
        Ok(Metadata {
            folder: folder.to_path_buf(),
            names,
            names_from,
            attributes,
            fill: self.fill(document.get("fill_value"), number)?,
            shape,
            chunk,
            number,
            codecs,
            separator,
            with_c,
        })
    }

    /// Unknown extensions must be marked as optional.
    fn refuse_unknown(&self, document: &Map<String, Value>) -> Result<()> {
        const KNOWN: [&str; 11] = [
            "zarr_format",
            "node_type",
            "shape",
            "data_type",
            "chunk_grid",
            "chunk_key_encoding",
            "fill_value",
            "codecs",
            "attributes",
            "dimension_names",
            "consolidated_metadata",
        ];
        for (key, value) in document {
            let may_be_passed_over = value.get("must_understand") == Some(&Value::Bool(false));
            let is_empty = value.as_array().is_some_and(Vec::is_empty);
            if !KNOWN.contains(&key.as_str()) && !may_be_passed_over && !is_empty {
                return Err(self.unsupported(key, "this extension is unknown", "write it without"));
            }
        }
        Ok(())
    }

    fn sizes(&self, value: Option<&Value>, key: &str) -> Result<Vec<u64>> {
        let sizes = value.and_then(Value::as_array);
        let sizes: Option<Vec<u64>> =
            sizes.and_then(|sizes| sizes.iter().map(Value::as_u64).collect());
        sizes.ok_or_else(|| self.invalid(key, "there is no list of sizes"))
    }

    /// The size of a chunk with `axes` axes, which must fit in memory.
    fn chunk(&self, value: Option<&Value>, axes: usize, number: Number) -> Result<Vec<usize>> {
        let sizes = self.sizes(value, "chunk_shape")?;
        let bytes = sizes
            .iter()
            .try_fold(number.bytes() as u64, |n, size| n.checked_mul(*size));
        if sizes.len() != axes || sizes.contains(&0) {
            return Err(self.invalid(
                "chunk_shape",
                format!("{sizes:?} is not the size of a chunk of {axes} axes"),
            ));
        }
        match bytes.filter(|bytes| *bytes <= LARGEST_CHUNK) {
            Some(_) => Ok(sizes.into_iter().map(|n| n as usize).collect()),
            None => Err(self.unsupported(
                "chunk_shape",
                format!("a chunk of {sizes:?} has more than 1 GiB"),
                "write it in smaller chunks",
            )),
        }
    }

    fn number(&self, document: &Map<String, Value>) -> Result<Number> {
        let name = document
            .get("data_type")
            .and_then(Value::as_str)
            .unwrap_or("");
        let known = Number::NAMES.iter().find(|row| row.0 == name);
        known.map(|row| row.1).ok_or_else(|| {
            let what = match document.get("data_type") {
                Some(other) => {
                    format!("samples of type {other} cannot hold radiance")
                }
                None => "there is no type".into(),
            };
            self.unsupported(
                "data_type",
                what,
                "give float16, float32, float64 or integers",
            )
        })
    }

    /// A number, the name of one that JSON cannot represent, or its bits.
    fn fill(&self, value: Option<&Value>, number: Number) -> Result<f64> {
        let text = match value {
            Some(Value::Number(fill)) => return Ok(fill.as_f64().unwrap_or(0.0)),
            Some(Value::String(text)) => text.as_str(),
            _ => return Err(self.invalid("fill_value", "there is none")),
        };
        let bits = || u64::from_str_radix(text.strip_prefix("0x")?, 16).ok();
        match text {
            "NaN" => Ok(f64::NAN),
            "Infinity" => Ok(f64::INFINITY),
            "-Infinity" => Ok(f64::NEG_INFINITY),
            _ => match (bits(), number) {
                (Some(bits), Number::F16) => Ok(half::f16::from_bits(bits as u16).to_f64()),
                (Some(bits), Number::F32) => Ok(f32::from_bits(bits as u32).into()),
                (Some(bits), Number::F64) => Ok(f64::from_bits(bits)),
                _ => Err(self.invalid("fill_value", format!("{text:?} is not a number"))),
            },
        }
    }

    /// A name and its configuration; a name alone has none.
    fn named<'v>(
        &self,
        value: Option<&'v Value>,
        key: &str,
    ) -> Result<(&'v str, Map<String, Value>)> {
        match value {
            Some(Value::String(name)) => Ok((name, Map::new())),
            Some(Value::Object(object)) => {
                let name = object.get("name").and_then(Value::as_str);
                let name = name.ok_or_else(|| self.invalid(key, "it has no name"))?;
                let configuration = object.get("configuration").and_then(Value::as_object);
                Ok((name, configuration.cloned().unwrap_or_default()))
            }
            _ => Err(self.invalid(key, "it is missing")),
        }
    }

    /// The codecs of chunks of this size, in the order in which they encode.
    fn codecs(&self, value: Option<&Value>, chunk: &[usize], number: Number) -> Result<Vec<Codec>> {
        let Some(list) = value.and_then(Value::as_array) else {
            return Err(self.invalid("codecs", "there is no list of them"));
        };
        // First codecs from array to array, then one from array to bytes, then those from bytes to bytes; `chunk` is the shape so far.
        let mut codecs: Vec<Codec> = Vec::new();
        let mut chunk = chunk.to_vec();
        for entry in list {
            let (name, configuration) = self.named(Some(entry), "codecs")?;
            let has_bytes = codecs.iter().any(Codec::makes_bytes);
            let codec = match (name, has_bytes) {
                ("bytes", false) => Codec::Bytes {
                    is_big: match configuration.get("endian").and_then(Value::as_str) {
                        Some("big") => true,
                        Some("little") => false,
                        None if number.bytes() == 1 => false,
                        _ => return Err(self.invalid("codecs", "the order of bytes is not given")),
                    },
                },
                ("transpose", false) => {
                    let order = self.sizes(configuration.get("order"), "codecs")?;
                    let order: Vec<usize> = order.into_iter().map(|n| n as usize).collect();
                    let mut sorted = order.clone();
                    sorted.sort_unstable();
                    if !sorted.iter().copied().eq(0..chunk.len()) {
                        return Err(self.invalid(
                            "codecs",
                            format!("{order:?} is not an order of {} axes", chunk.len()),
                        ));
                    }
                    let codec = Codec::Transpose {
                        order: order.clone(),
                    };
                    chunk = order.iter().map(|axis| chunk[*axis]).collect();
                    codec
                }
                ("sharding_indexed", false) => {
                    let inner =
                        self.chunk(configuration.get("chunk_shape"), chunk.len(), number)?;
                    if chunk
                        .iter()
                        .zip(&inner)
                        .any(|(shard, inner)| shard % inner != 0)
                    {
                        let what =
                            format!("a shard of {chunk:?} does not consist of chunks of {inner:?}");
                        return Err(self.invalid("codecs", what));
                    }
                    // A shard within a shard would need an index for each level.
                    let nested = |entry: &Value| {
                        entry.get("name").and_then(Value::as_str) == Some("sharding_indexed")
                    };
                    let inside = configuration.get("codecs");
                    if inside
                        .and_then(Value::as_array)
                        .is_some_and(|list| list.iter().any(nested))
                    {
                        return Err(self.unsupported(
                            "codecs",
                            "shards within shards are not supported",
                            "write it with shards of one level",
                        ));
                    }
                    let index = self.codecs(configuration.get("index_codecs"), &[], Number::U64)?;
                    // The index is read at a known position, so its length must be known: compression is not allowed.
                    let is_plain = |codec: &Codec| {
                        matches!(codec, Codec::Bytes { is_big: false } | Codec::Crc32c)
                    };
                    if !index.iter().all(is_plain) {
                        return Err(self.unsupported(
                            "codecs",
                            "the index of shards is compressed",
                            "write it with the usual index",
                        ));
                    }
                    let at_start = match configuration.get("index_location").and_then(Value::as_str)
                    {
                        None | Some("end") => false,
                        Some("start") => true,
                        Some(other) => {
                            return Err(self.invalid(
                                "codecs",
                                format!("{other:?} is not a place for an index"),
                            ));
                        }
                    };
                    Codec::Sharding {
                        codecs: self.codecs(inside, &inner, number)?,
                        has_checksum: index.contains(&Codec::Crc32c),
                        inner,
                        at_start,
                    }
                }
                ("bytes" | "transpose" | "sharding_indexed", true) => {
                    return Err(self.invalid("codecs", format!("{name} is in the wrong place")));
                }
                _ => match compressor(name) {
                    Some(codec) if has_bytes => codec,
                    Some(_) => {
                        let what = format!("{name} is in the wrong place");
                        return Err(self.invalid("codecs", what));
                    }
                    None => {
                        let name = name.trim_start_matches(NUMCODECS);
                        let what = format!("the codec {name:?} is not supported");
                        let help = "bytes, transpose, blosc, gzip, zlib, lz4, zstd, crc32c and sharding_indexed are: write it with zarr's default codecs";
                        return Err(self.unsupported("codecs", what, help));
                    }
                },
            };
            codecs.push(codec);
        }
        match codecs.iter().any(Codec::makes_bytes) {
            true => Ok(codecs),
            false => Err(self.invalid("codecs", "none of them makes bytes")),
        }
    }
}

/// The codec from bytes to bytes with this name.
fn compressor(name: &str) -> Option<Codec> {
    match name {
        "blosc" | "numcodecs.blosc" => Some(Codec::Blosc),
        "gzip" | "numcodecs.gzip" => Some(Codec::Gzip),
        "zstd" | "numcodecs.zstd" => Some(Codec::Zstd),
        "crc32c" => Some(Codec::Crc32c),
        "numcodecs.lz4" => Some(Codec::Lz4),
        "numcodecs.zlib" => Some(Codec::Zlib),
        _ => None,
    }
}

/// Names of axes, some of which may be missing.
fn names_of(names: Option<&Value>) -> Option<Vec<String>> {
    let names = names?.as_array()?;
    let all_missing = names.iter().all(Value::is_null);
    let text = |name: &Value| name.as_str().unwrap_or_default().to_string();
    (!all_missing).then(|| names.iter().map(text).collect())
}
