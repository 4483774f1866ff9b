//! A parsed document whose data are still in their files, and labels for its parts in messages.

use std::collections::BTreeSet;
use std::io::{BufReader, Cursor};
use std::path::{Path, PathBuf};

use ::gltf::json::{self, Root};
use serde::Deserialize;
use serde::de::IgnoredAny;

use super::container::{self, Storage};
use super::extensions::{self, OF_IMAGES, UNDERSTOOD};
use super::transforms::{self, Numbers};
use crate::error::{Error, Message, Result};
use crate::io::open::open_regular;

/// A parsed glTF document.
pub(super) struct Document<'a> {
    /// The file, for messages.
    pub file: PathBuf,
    /// The directory to which URIs are relative; `None` for a document in memory.
    pub directory: Option<PathBuf>,
    pub root: Root,
    /// The transforms of the nodes of `root`, which has them in single precision only.
    pub transforms: Vec<Numbers>,
    /// Animation and channel indices of channels without a node, which are left out of `root`.
    pub without_node: Vec<[usize; 2]>,
    /// The extensions that the file declares as used.
    used: BTreeSet<String>,
    /// The extensions named in its parts.
    named: BTreeSet<String>,
    /// Offset and length of the binary chunk in `storage`.
    pub bin: Option<(u64, u64)>,
    pub storage: Box<dyn Storage + 'a>,
}

impl Document<'static> {
    pub fn open(path: &Path) -> Result<Self> {
        let (file, length) = open_regular(path)?;
        let storage = BufReader::new(file);
        let mut document = Document::parse(Box::new(storage), length, path)?;
        document.directory = Some(path.parent().unwrap_or(Path::new("")).to_path_buf());
        Ok(document)
    }
}

impl<'a> Document<'a> {
    pub fn from_bytes(bytes: &'a [u8], name: &str) -> Result<Self> {
        let length = bytes.len() as u64;
        Document::parse(Box::new(Cursor::new(bytes)), length, Path::new(name))
    }

    fn parse(mut storage: Box<dyn Storage + 'a>, length: u64, file: &Path) -> Result<Self> {
        let container = container::read(&mut *storage, length, file)?;
        check_objects(&container.json, file)?;
        let (root, without_node) = root(&container.json, file)?;
        let used = root.extensions_used.iter().chain(&root.extensions_required);
        let document = Document {
            file: file.to_path_buf(),
            directory: None,
            used: used.cloned().collect(),
            named: extensions::named(&container.json),
            transforms: transforms::of_nodes(&container.json)
                .map_err(|error| unreadable(&container.json, &error, file))?,
            root,
            without_node,
            bin: container.bin,
            storage,
        };
        document.check_version()?;
        document.check_extensions()?;
        Ok(document)
    }

    fn check_version(&self) -> Result<()> {
        let asset = &self.root.asset;
        let needed = asset.min_version.as_deref().unwrap_or(&asset.version);
        // Minor versions only add what readers may ignore, so without `minVersion` any 2.x is readable.
        let readable = match asset.min_version {
            Some(_) => needed == "2.0",
            None => needed.starts_with("2."),
        };
        match readable {
            true => Ok(()),
            false => Err(self.unsupported(
                "asset",
                format!("version {:?} of glTF is unknown", shortened(needed)),
                "export the model as glTF 2.0",
            )),
        }
    }

    fn check_extensions(&self) -> Result<()> {
        let mut required = self.root.extensions_required.iter();
        match required.find(|name| !is_known(name)) {
            None => Ok(()),
            Some(name) => Err(self.unsupported(
                "extensionsRequired",
                format!(
                    "the file needs the extension {:?}, which is not supported",
                    shortened(name)
                ),
                extensions::remedy(name),
            )),
        }
    }

    /// The extensions that the file uses and that are not read, without repetitions, and whether each is declared as used.
    pub fn unread_extensions(&self) -> impl Iterator<Item = (&str, bool)> {
        let declared = self.root.extensions_used.iter();
        let declared: BTreeSet<&str> = declared.map(String::as_str).collect();
        let unread = |name: &&str| !is_known(name);
        let others = self.named.iter().map(String::as_str);
        let others = others.filter(|name| !self.uses(name));
        let others: Vec<&str> = others.filter(unread).collect();
        let declared = declared.into_iter().filter(unread);
        (declared.map(|name| (name, true))).chain(others.into_iter().map(|name| (name, false)))
    }

    /// Whether the file declares this extension as used.
    pub fn uses(&self, extension: &str) -> bool {
        self.used.contains(extension)
    }

    /// The item at `index`, or an error that names the list that is too short.
    pub fn get<T>(&self, index: json::Index<T>, list: &str, place: &str) -> Result<&T>
    where
        Root: json::root::Get<T>,
    {
        self.root.get(index).ok_or_else(|| {
            let what = format!(
                "it refers to {list} {}, which does not exist",
                index.value()
            );
            self.invalid(place, what, "every index must be within its list")
        })
    }

    /// `mesh 2 "wheel", primitive 0`.
    pub fn primitive_label(&self, mesh: usize, primitive: usize) -> String {
        let name = self.root.meshes.get(mesh).and_then(|m| m.name.as_deref());
        format!("{}, primitive {primitive}", label("mesh", mesh, name))
    }

    /// `node 3 "left"`.
    pub fn node_label(&self, node: usize) -> String {
        let name = self.root.nodes.get(node).and_then(|n| n.name.as_deref());
        label("node", node, name)
    }

    pub fn invalid(
        &self,
        place: impl Into<String>,
        what: impl Into<String>,
        help: impl Into<Message>,
    ) -> Error {
        Error::invalid(&self.file, place, what, help)
    }

    pub fn unsupported(
        &self,
        place: impl Into<String>,
        what: impl Into<String>,
        help: impl Into<String>,
    ) -> Error {
        Error::unsupported(&self.file, place, what, help)
    }
}

/// Whether an extension is read, or else reported by what needs it.
fn is_known(extension: &str) -> bool {
    UNDERSTOOD.contains(&extension) || OF_IMAGES.contains(&extension)
}

/// Parses JSON text, and returns what was left out of the document: animation channels whose target has no node, like those of materials
/// with KHR_animation_pointer, must be ignored (glTF 2.0 §5.7), but the parser would refuse them.
fn root(text: &[u8], file: &Path) -> Result<(Root, Vec<[usize; 2]>)> {
    let error = match Root::from_slice(text) {
        Ok(root) => return Ok((root, Vec::new())),
        Err(error) => error,
    };
    let found = channels_without_node(text);
    if found.is_empty() {
        return Err(unreadable(text, &error, file));
    }
    let refuse = |error: json::Error| unreadable(text, &error, file);
    let mut value: json::Value = json::deserialize::from_slice(text).map_err(refuse)?;
    for [animation, channel] in found.iter().rev() {
        let channels = value["animations"][*animation]["channels"].as_array_mut();
        channels.map(|channels| channels.remove(*channel));
    }
    let root = json::deserialize::from_value(value).map_err(refuse)?;
    Ok((root, found))
}

/// Animation and channel indices of channels whose target has no node, ascending.
fn channels_without_node(text: &[u8]) -> Vec<[usize; 2]> {
    // Whatever the size of the JSON, only this is kept.
    #[derive(Deserialize)]
    struct Head {
        #[serde(default)]
        animations: Vec<Animation>,
    }
    #[derive(Deserialize)]
    struct Animation {
        #[serde(default)]
        channels: Vec<Channel>,
    }
    #[derive(Deserialize)]
    struct Channel {
        target: Target,
    }
    #[derive(Deserialize)]
    struct Target {
        node: Option<IgnoredAny>,
    }
    let Ok(head) = json::deserialize::from_slice::<Head>(text) else {
        return Vec::new();
    };
    let mut found = Vec::new();
    for (k, animation) in head.animations.iter().enumerate() {
        let channels = animation.channels.iter().enumerate();
        let lacking = channels.filter(|(_, channel)| channel.target.node.is_none());
        found.extend(lacking.map(|(channel, _)| [k, channel]));
    }
    found
}

/// The number of JSON objects, each of which takes a few hundred bytes of memory, that is accepted in any case.
const FEW_OBJECTS: usize = 1 << 17;
/// The shortest text of an object with contents, like `{"a":0},`, bytes.
const LEAST_OBJECT: usize = 8;

/// Refuses JSON with many empty objects, which takes hundreds of times as much memory as text.
fn check_objects(text: &[u8], file: &Path) -> Result<()> {
    // This counts braces in names too, of which there are few.
    let objects = text.iter().filter(|byte| **byte == b'{').count();
    if objects <= FEW_OBJECTS.max(text.len() / LEAST_OBJECT) {
        return Ok(());
    }
    let what = format!(
        "it has {objects} objects in {} bytes: most are empty",
        text.len()
    );
    let help = "export the model again, without empty nodes";
    Err(Error::invalid(file, "JSON", what, help))
}

/// The error for JSON that cannot be read as glTF.
fn unreadable(text: &[u8], error: &json::Error, file: &Path) -> Error {
    // Whatever the size of the JSON, only this is kept.
    #[derive(Deserialize)]
    struct Head {
        asset: Option<Asset>,
    }
    #[derive(Deserialize)]
    struct Asset {
        version: Option<IgnoredAny>,
    }
    let head = json::deserialize::from_slice::<Head>(text);
    if head.is_ok_and(|head| head.asset.is_none_or(|asset| asset.version.is_none())) {
        let what = "this JSON is not glTF: it has no `asset` with its glTF version";
        let help =
            "give a .gltf or .glb file of glTF 2.0, which has \"asset\": {\"version\": \"2.0\"}";
        return Error::invalid(file, "JSON", what, help);
    }
    let help = "the file must be glTF 2.0; a validator of glTF tells more, and exporting the model again often helps";
    Error::invalid(file, "JSON", error.to_string(), help)
}

/// `kind 7 "name"`, or `kind 7` if there is no name.
pub(super) fn label(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("{kind} {index} {:?}", shortened(name)),
        _ => format!("{kind} {index}"),
    }
}

/// A name from the file, shortened for a message.
pub(super) fn shortened(name: &str) -> String {
    const MOST: usize = 60;
    match name.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", name.split_at(end).0),
        None => name.to_owned(),
    }
}

/// Up to a dozen names, for "there are …".
pub(super) fn listed<'n>(names: impl Iterator<Item = &'n str>) -> String {
    const MOST: usize = 12;
    let mut names = names.filter(|name| !name.is_empty());
    let first: Vec<String> = (names.by_ref().take(MOST))
        .map(|name| format!("{:?}", shortened(name)))
        .collect();
    match (first.is_empty(), names.count()) {
        (true, _) => "none has a name".to_owned(),
        (false, 0) => first.join(", "),
        (false, more) => format!("{} and {more} more", first.join(", ")),
    }
}
