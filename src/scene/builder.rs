//! Scenes built by a program: the keys of a scene file, with meshes and cubes in memory.

use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;

use glam::DVec3;
use toml_edit::{ArrayOfTables, DocumentMut, InlineTable, Item, Table};

use super::load::{self, SceneFile};
use super::memory::Memory;
use super::model::{Scene, Shape};
use super::overrides::{self, Overrides};
use super::report::Report;
use super::text::Text;
use crate::error::{Error, Result};
use crate::io::cube::Cube;
use crate::mesh::Mesh;
use crate::spacetime::Velocity;
use crate::spacetime::units::{Dimension, Measure};

/// Builds a [`Scene`] from values instead of a file.
///
/// Every key of a scene file can be [set](Builder::set), by the same name and with the same meaning; anything that a file must not
/// contain is refused here with the same messages, naming the key. The first error is reported by [`build`](Builder::build).
/// [`Scene::text`] is an equivalent scene file, except that it names meshes and cubes in memory by their SHA-256.
///
/// ```
/// use std::sync::Arc;
/// use nullray::mesh::Mesh;
/// use nullray::scene::Builder;
///
/// let corners = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Into::into);
/// let triangle = Mesh::new(corners.into(), vec![[0, 1, 2]], [0.8, 0.2, 0.1]);
/// let builder = Builder::new("a triangle")
///     .set("camera.eye", [0.0, 0.0, 5.0])
///     .set("camera.look_at", [0.0, 0.0, 0.0])
///     .mesh("triangle", Arc::new(triangle));
/// let scene = builder.clone().set("object.triangle.velocity.beta", [0.9, 0.0, 0.0]).build()?;
/// assert_eq!(scene.objects[0].velocity.beta().x, 0.9);
///
/// let refused = builder.set("object.triangle.velocity.beta", [1.5, 0.0, 0.0]).build();
/// let message = refused.unwrap_err().to_string();
/// assert!(message.starts_with("a triangle, object \"triangle\", velocity.beta: |β| = 1.5 is not below 1"));
/// # Ok::<(), nullray::Error>(())
/// ```
#[derive(Debug, Clone)]
#[must_use = "each method takes the builder and returns it"]
pub struct Builder {
    name: String,
    base: PathBuf,
    document: DocumentMut,
    memory: Memory,
    /// The first error.
    error: Option<Refused>,
}

/// The problem: file, place, what, help.
type Refused = [String; 4];

impl Builder {
    /// A scene called `name`, with no key set yet.
    pub fn new(name: impl Into<String>) -> Self {
        Builder {
            name: name.into(),
            base: PathBuf::new(),
            document: DocumentMut::new(),
            memory: Memory::default(),
            error: None,
        }
    }

    /// A scene called `name` that starts from the scene file with this `text`.
    pub fn from_toml(name: impl Into<String>, text: &str) -> Self {
        let mut builder = Builder::new(name);
        match DocumentMut::from_str(text) {
            Ok(document) => builder.document = document,
            Err(error) => builder.refuse("", error.message(), "the text of a scene is TOML"),
        }
        builder
    }

    /// Relative paths of files resolve against `folder`. Default: the current folder.
    pub fn folder(mut self, folder: impl Into<PathBuf>) -> Self {
        self.base = folder.into();
        self
    }

    /// Sets a dotted key of the scene, like `camera.velocity.beta`; existing objects, sources and lights are addressed by name or number,
    /// as in `object.ship.origin.time`. A name that contains a dot is quoted: `object."a.b".colour`.
    pub fn set(mut self, key: &str, value: impl Into<Value>) -> Self {
        let file = self.name.clone();
        let refuse = |what, help| Error::invalid(&file, key, what, help);
        // As for overrides, so that both take the same keys.
        let set = overrides::set(&mut self.document, key, value.into().0, &refuse);
        if let Err(Error::Invalid(problem)) = set {
            self.refuse(&problem.place, &problem.what, &problem.help);
        }
        self
    }

    /// Adds the object `name` with a mesh in memory. The scene shares it; what is rendered is a copy, with the object's transform. The base colours of its materials are used, but not their textures,
    /// which would be images in files.
    ///
    /// It rests at the world's origin unless `object.NAME.velocity`, `object.NAME.origin` and `object.NAME.transform` are set. Objects
    /// move uniformly: accelerated world lines (`motion`) are for the camera and for lamps.
    pub fn mesh(mut self, name: &str, mesh: Arc<Mesh>) -> Self {
        if let Err(error) = mesh.check() {
            let place = format!("object \"{name}\", {}", error.field);
            self.refuse(&place, &error.what, Mesh::CHECKED);
            return self;
        }
        let key = self.memory.add_mesh(mesh);
        self.add("object", name, "gltf", key.into())
    }

    /// Adds the object `name` with a built-in shape.
    pub fn shape(self, name: &str, shape: Shape) -> Self {
        let (kind, keys) = match shape {
            Shape::Box { size } => ("box", Value::table([("size", size.into())])),
            Shape::Plane { size } => ("plane", Value::table([("size", size.into())])),
            Shape::Sphere {
                radius,
                subdivisions,
            } => {
                let keys = [
                    ("radius", radius.into()),
                    ("subdivisions", subdivisions.into()),
                ];
                ("sphere", Value::table(keys))
            }
            Shape::Lattice {
                cells,
                spacing,
                bar,
            } => {
                let (cells, spacing, bar) = (cells.into(), spacing.into(), bar.into());
                let keys = [("cells", cells), ("spacing", spacing), ("bar", bar)];
                ("lattice", Value::table(keys))
            }
        };
        self.add("object", name, "shape", Value::table([(kind, keys)]))
    }

    /// Adds the object `name` from a glTF file.
    pub fn gltf(self, name: &str, path: &str) -> Self {
        self.add("object", name, "gltf", path.into())
    }

    /// Adds the source `name`, a cube in memory, which is shared. Its bins are `bin_width` metres (ct) wide.
    pub fn cube(self, name: &str, cube: Arc<Cube>, bin_width: f64) -> Self {
        self.add_cube(name, cube, ("bin_width", metres(bin_width).into()))
    }

    /// The same with bins of different widths: `edges` are the start of each and the end of the last, metres (ct).
    pub fn cube_with_edges(self, name: &str, cube: Arc<Cube>, edges: &[f64]) -> Self {
        let edges = edges.iter().map(|edge| Value::from(metres(*edge)));
        self.add_cube(name, cube, ("edges", edges.collect()))
    }

    /// Adds the source `name`, a spherical pulse of light from `position`, with a standard deviation of `sigma` metres (ct) in time.
    pub fn pulse(self, name: &str, position: DVec3, sigma: f64) -> Self {
        let sigma = metres(sigma).into();
        let keys = Value::table([("position", position.into()), ("sigma", sigma)]);
        self.add("source", name, "pulse", keys)
    }

    /// Adds the light `name` with these keys of a `[[light]]` table: a lamp, or with `type = "area"` an object that shines.
    ///
    /// ```
    /// use nullray::scene::Builder;
    ///
    /// let scene = Builder::new("a lamp over a box")
    ///     .set("camera.eye", [0.0, 0.0, 5.0])
    ///     .set("camera.look_at", [0.0, 0.0, 0.0])
    ///     .shape("box", nullray::scene::model::Shape::Box { size: [1.0; 3] })
    ///     .light("lamp", [("position", [0.0, 3.0, 0.0].into()), ("power", 100.0.into())])
    ///     .build()?;
    /// assert_eq!(scene.lights[0].name, "lamp");
    /// # Ok::<(), nullray::Error>(())
    /// ```
    pub fn light<'k>(self, name: &str, keys: impl IntoIterator<Item = (&'k str, Value)>) -> Self {
        self.add_keys("light", name, keys)
    }

    /// Builds the scene.
    ///
    /// # Errors
    /// As [`load`](super::load()), and the first error of earlier calls.
    pub fn build(self) -> Result<Scene> {
        if let Some([file, place, what, help]) = self.error {
            return Err(Error::invalid(file, place, what, help));
        }
        let report = Report {
            name: self.name,
            text: Text::unedited(self.document.to_string()),
            edits: Vec::new(),
        };
        // `report` holds the text; the file gives the folder and the arrays in memory.
        let mut file = SceneFile::of_text("", &report.name, &self.base);
        file.memory = self.memory;
        load::scene(report, &file, false).map_err(|error| with_name(error, &self.document))
    }

    /// Builds the scene of the panel `name`, like [`SceneFile::panel`].
    ///
    /// # Errors
    /// As [`build`](Builder::build), or if there is no panel of this name.
    pub fn build_panel(self, name: &str) -> Result<Scene> {
        let whole = self.clone().build()?;
        let Some(panel) = whole.panels.iter().find(|panel| panel.name == name) else {
            let known: Vec<&str> = whole.panels.iter().map(|p| p.name.as_str()).collect();
            let what = format!("the scene has no panel \"{name}\"");
            let help = match known.is_empty() {
                true => "panels are [[panel]] tables in the text of the scene".into(),
                false => format!("there are: {}", known.join(", ")),
            };
            return Err(Error::invalid(&whole.name, "panel", what, help));
        };
        let mut file = SceneFile::of_text(&whole.text, &whole.name, &self.base);
        file.memory = self.memory;
        file.panel(&whole, panel, &Overrides::default())
    }

    /// Adds the source `name`, a cube with this key of its time axis.
    fn add_cube(mut self, name: &str, cube: Arc<Cube>, axis: (&str, Value)) -> Self {
        if let Err(error) = cube.check() {
            let place = format!("source \"{name}\", {}", error.field());
            self.refuse(&place, &error.to_string(), Cube::CHECKED);
            return self;
        }
        let file = self.memory.add_cube(cube).into();
        self.add("source", name, "cube", Value::table([("file", file), axis]))
    }

    /// Adds the entry `name` to the list of objects or sources.
    fn add(self, list: &str, name: &str, key: &str, value: Value) -> Self {
        self.add_keys(list, name, [(key, value)])
    }

    /// Adds the entry `name` with these keys to the list of objects, sources or lights.
    fn add_keys<'k>(
        mut self,
        list: &str,
        name: &str,
        keys: impl IntoIterator<Item = (&'k str, Value)>,
    ) -> Self {
        let mut entry = Table::new();
        entry.insert("name", Item::Value(name.into()));
        for (key, value) in keys {
            entry.insert(key, Item::Value(value.0));
        }
        let item = self.document.entry(list).or_insert_with(new_list);
        let is_empty = item.as_array().is_some_and(toml_edit::Array::is_empty);
        *item = match std::mem::take(item).into_array_of_tables() {
            Ok(mut tables) => {
                tables.push(entry);
                tables.into()
            }
            Err(_) if is_empty => ArrayOfTables::from_iter([entry]).into(),
            // Stays, and is refused when the scene is built, as in a file.
            Err(other) => other,
        };
        self
    }

    /// Keeps the first error.
    fn refuse(&mut self, place: &str, what: &str, help: &str) {
        let refused = [&self.name, place, what, help].map(str::to_string);
        self.error.get_or_insert(refused);
    }
}

/// The error with the name of an entry of a list in place of its number, as the program knows it: `object "ship", colour`.
fn with_name(mut error: Error, document: &DocumentMut) -> Error {
    let named = |place: &str| {
        let (list, rest) = place.split_once('[')?;
        let (number, rest) = rest.split_once("].")?;
        let name = document.get(list)?.get(number.parse::<usize>().ok()?)?;
        let name = name.get("name")?.as_str()?;
        // Two entries may have one name, which is refused.
        (rest != "name").then(|| format!("{list} \"{name}\", {rest}"))
    };
    if let Error::Invalid(problem) | Error::Unsupported(problem) = &mut error
        && let Some(place) = named(&problem.place)
    {
        problem.place = place.into();
    }
    error
}

fn new_list() -> Item {
    Item::ArrayOfTables(ArrayOfTables::new())
}

/// The value of a key: a number, a text, a Boolean, or a list or table of these.
#[derive(Debug, Clone)]
pub struct Value(toml_edit::Value);

impl Value {
    /// A table, like `[("gamma", 7.0.into()), ("direction", [1.0, 0.0, 0.0].into())]`.
    pub fn table<'k>(entries: impl IntoIterator<Item = (&'k str, Value)>) -> Value {
        let entries = entries.into_iter().map(|(key, value)| (key, value.0));
        Value(InlineTable::from_iter(entries).into())
    }
}

/// The value types of TOML, through its own types.
macro_rules! from {
    ($($own:ty => $toml:ty),*) => {
        $(impl From<$own> for Value {
            fn from(value: $own) -> Self {
                Value(<$toml>::from(value).into())
            }
        })*
    };
}

from!(f64 => f64, f32 => f64, u8 => i64, u16 => i64, i32 => i64, u32 => i64, i64 => i64, bool => bool, &str => String, String => String, &String => String);

impl From<u64> for Value {
    fn from(number: u64) -> Self {
        // Of numbers beyond those of TOML, the largest, which every key refuses.
        i64::try_from(number).unwrap_or(i64::MAX).into()
    }
}

impl From<usize> for Value {
    fn from(number: usize) -> Self {
        (number as u64).into()
    }
}

impl<T: Into<Value> + Clone> From<&[T]> for Value {
    fn from(values: &[T]) -> Self {
        values.iter().cloned().collect()
    }
}

impl<T: Into<Value>, const N: usize> From<[T; N]> for Value {
    fn from(values: [T; N]) -> Self {
        Value::from_iter(values)
    }
}

impl<T: Into<Value>> From<Vec<T>> for Value {
    fn from(values: Vec<T>) -> Self {
        Value::from_iter(values)
    }
}

impl<T: Into<Value>> FromIterator<T> for Value {
    fn from_iter<I: IntoIterator<Item = T>>(values: I) -> Self {
        Value(values.into_iter().map(|value| value.into().0).collect())
    }
}

impl From<DVec3> for Value {
    fn from(v: DVec3) -> Self {
        v.to_array().into()
    }
}

impl From<Velocity> for Value {
    fn from(velocity: Velocity) -> Self {
        // β of a text loses 1 − β near the speed of light; the rapidity keeps it.
        Value::table([("rapidity", velocity.rapidity().into())])
    }
}

impl<D: Dimension> From<Measure<D>> for Value {
    fn from(measure: Measure<D>) -> Self {
        measure.to_string().into()
    }
}
/// The shortest text that reads back as the same f64, with an exponent where digits would be many zeros.
fn metres(value: f64) -> String {
    match value.abs() {
        size if size != 0.0 && !(1e-7..1e16).contains(&size) => format!("{value:e} m"),
        _ => format!("{value} m"),
    }
}
