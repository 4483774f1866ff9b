//! `nullray info`: the contents of a file, whose kind is recognised by its content.

mod array;
mod camera;
mod gltf;
mod picture;
mod scene;
mod table;

use std::io::Read;
use std::path::Path;

use nullray::io::cube::{self, CubeFormat, format_called, format_of, is_picture};
use nullray::io::files;
use nullray::{Error, Result};
use serde_json::{Map, Value};

use super::args::InfoArguments;
use super::builtin;
use super::console::{escaped, print, print_json};

/// The longest value that is printed; JSON has all of it.
const LONGEST: usize = 100;
/// The most entries of a list that are printed.
const MOST: usize = 20;

pub fn run(arguments: &InfoArguments) -> Result<()> {
    let path = arguments.file.as_path();
    let memory = arguments.memory.bytes();
    let info = match Kind::of(path)? {
        Kind::Gltf => gltf::info(path),
        Kind::Array(format) => array::info(path, format, memory),
        Kind::Exr => picture::exr(path, memory),
        Kind::Png => picture::png(path),
        Kind::Frame(name) => picture::frame(path, name, memory),
        Kind::Table => table::info(path),
        Kind::Scene => scene::info(path, memory),
    }?;
    match arguments.json.on {
        true => print_json(&info.data),
        false => {
            let path = path.display().to_string();
            print(&format!("{}: {}", path.escape_debug(), info.text))
        }
    }
}

/// The facts about a file: rows of a label and a text to print in columns, and data for programs. All texts from the file are escaped.
struct Info {
    text: String,
    data: Map<String, Value>,
}

impl Info {
    /// A file of this kind, printed as `title`.
    fn new(kind: &str, title: &str) -> Self {
        let mut info = Info {
            text: format!("{title}\n"),
            data: Map::new(),
        };
        info.data("kind", kind);
        info
    }

    fn row(&mut self, label: &str, text: impl AsRef<str>) {
        let line = format!("  {:<12}{}", escaped(label), escaped(text.as_ref()));
        self.line(&line);
    }

    fn line(&mut self, line: &str) {
        self.text += line.trim_end();
        self.text.push('\n');
    }

    fn data(&mut self, key: &str, value: impl Into<Value>) {
        self.data.insert(key.into(), value.into());
    }

    /// Adds a row, and the same as data.
    fn fact(&mut self, label: &str, text: impl AsRef<str>, key: &str, value: impl Into<Value>) {
        self.row(label, text);
        self.data(key, value);
    }

    /// Adds a row per entry, for the first few of them.
    fn list<T>(&mut self, label: &str, entries: &[T], text: impl Fn(&T) -> String) {
        for entry in entries.iter().take(MOST) {
            self.row(label, text(entry));
        }
        if entries.len() > MOST {
            let rest = entries.len() - MOST;
            self.row(label, format!("… and {rest} more (--json has all)"));
        }
    }

    /// Adds all names as data, and the first few in one row; no row if there are none.
    fn names(&mut self, label: &str, names: Vec<String>) {
        let shown = names.iter().take(MOST).map(|name| match name.as_str() {
            "" => "(no name)",
            name => name,
        });
        let mut text = shown.collect::<Vec<_>>().join(", ");
        if names.len() > MOST {
            text += &format!(", … and {} more", names.len() - MOST);
        }
        if !names.is_empty() {
            self.row(label, format!("{}: {text}", names.len()));
        }
        self.data(label, names);
    }

    fn metadata(&mut self, entries: &[(String, String)]) {
        let texts = entries.iter();
        let texts = texts.map(|(key, value)| (key.clone(), value.clone().into()));
        self.data("metadata", texts.collect::<Map<_, _>>());
        if !entries.is_empty() {
            self.row("metadata", "");
        }
        for (key, value) in entries {
            let (lines, chars) = (value.lines().count(), value.chars().count());
            let text = match lines > 1 || chars > LONGEST {
                true => format!("({lines} lines, {chars} characters: --json has them)"),
                false => value.clone(),
            };
            self.line(&format!("    {:<25} {}", escaped(key), escaped(&text)));
        }
    }
}

enum Kind {
    Gltf,
    Array(&'static CubeFormat),
    Exr,
    Png,
    /// Another picture that may be a frame of a sequence, and the name of its format.
    Frame(&'static str),
    /// A spectrum, or a table of stars.
    Table,
    Scene,
}

impl Kind {
    /// The kind by the first bytes, or by the extension if these are inconclusive, so that the reader of that kind reports the error.
    fn of(path: &Path) -> Result<Kind> {
        if builtin::is_standard_input(path) {
            return Ok(Kind::Scene);
        }
        let told = format_called(path).filter(|format| format.by_path().is_some());
        if let Some(format) = told.filter(|_| !is_picture(path)) {
            return Ok(Kind::Array(format));
        }
        let start = start(path)?;
        let extension = path.extension().map(|e| e.to_ascii_lowercase());
        let extension = extension.as_ref().and_then(|e| e.to_str()).unwrap_or("");
        let first = start.iter().find(|b| !b.is_ascii_whitespace());
        let is_text = !start.is_empty() && !start.contains(&0);
        match start.as_slice() {
            [b'g', b'l', b'T', b'F', ..] => Ok(Kind::Gltf),
            [0x76, 0x2f, 0x31, 0x01, ..] => Ok(Kind::Exr),
            [0x89, b'P', b'N', b'G', ..] => Ok(Kind::Png),
            [b'#', b'?', b'R', ..] => Ok(Kind::Frame("Radiance HDR picture")),
            [b'I', b'I', 42, 0, ..] | [b'M', b'M', 0, 42, ..] => Ok(Kind::Frame("TIFF picture")),
            start => match extension {
                _ if let Some(format) = format_of(start, path) => Ok(Kind::Array(format)),
                "gltf" | "glb" | "json" => Ok(Kind::Gltf),
                "exr" => Ok(Kind::Exr),
                "png" => Ok(Kind::Png),
                "hdr" => Ok(Kind::Frame("Radiance HDR picture")),
                "tif" | "tiff" => Ok(Kind::Frame("TIFF picture")),
                "toml" => Ok(Kind::Scene),
                "csv" => Ok(Kind::Table),
                _ if first == Some(&b'{') => Ok(Kind::Gltf),
                _ if is_text && std::str::from_utf8(start).is_ok() => Ok(Kind::Scene),
                _ => Err(unknown(path)),
            },
        }
    }
}

fn unknown(path: &Path) -> Error {
    let extensions: Vec<_> = cube::extensions().map(|end| format!(".{end}")).collect();
    let folders = cube::FORMATS.iter().filter_map(CubeFormat::by_path);
    let folders: Vec<_> = folders.map(|told| told.folder_of).collect();
    let help = format!(
        "give a .gltf, .glb, {}, .exr, .png, .hdr, .tif, .csv, a folder of {}, or a scene (.toml)",
        extensions.join(", "),
        folders.join(" or of ")
    );
    Error::unsupported(path, "", "nullray does not know this kind of file", help)
}

/// The first bytes of a file.
fn start(path: &Path) -> Result<Vec<u8>> {
    let failed = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::InvalidInput => {
            Error::invalid(path, "", error.to_string(), "give the path of a file")
        }
        _ => Error::io(path, "cannot read")(error),
    };
    let (file, _) = files::open(path).map_err(failed)?;
    let mut start = Vec::new();
    file.take(64).read_to_end(&mut start).map_err(failed)?;
    // A character cut off at the end is not an error in the file.
    while start.len() >= 62 && start.last().is_some_and(|b| !b.is_ascii()) {
        start.pop();
    }
    Ok(start)
}
