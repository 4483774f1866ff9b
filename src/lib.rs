//! A reference renderer for special relativity and time-resolved light.
//!
//! Every sensor sample becomes an event in the camera's frame, is Lorentz-transformed into a null ray of
//! the world, carried into the rest frame of whatever it meets, intersected there with a static BVH,
//! and looked up in time-resolved radiance at the retarded time. Nothing is ever re-tessellated, so
//! there is no tessellation error.
//!
//! ```text
//! scene file → scene model → plan → prepared scene → camera sample → null ray → hit → retarded event
//! [scene]      [scene::model] [render::plan] [render::prepare] [camera] [spacetime] [accel] [render::trace]
//!            → radiance → film → picture
//!              [light]    [render::film] [io::image]
//! ```
//!
//! # Modules, from bottom to top
//!
//! Each may use those above it in this table, and none below.
//!
//! | module | contents |
//! |---|---|
//! | [`error`] | what can go wrong: what, where, and what would be right |
//! | [`spacetime`] | events, velocities, boosts, null rays, world lines, Doppler factors; quantities with units |
//! | [`colour`] | sRGB, the CIE observer, spectral lines |
//! | [`mesh`] | triangles, materials, built-in shapes |
//! | [`accel`] | nearest and any hits of rays with triangles at rest; loops for wide vectors |
//! | [`text`] | text as outlines, the same on every machine |
//! | [`io`] | glTF, NumPy arrays, pictures, files that scenes name |
//! | [`scene`] | from the text of a scene file to a typed model |
//! | [`camera`] | from film points to null rays |
//! | [`light`] | time-resolved radiance |
//! | [`render`] | plan, prepare, trace, film, tone mapping |
//! | [`approximate`] | the same pictures by rasterizers and image warps, and the tessellation that they need |
//! | [`figures`] | space-time diagrams, overlays, isochrones, contact sheets |
//! | [`validate`] | comparison, bundles for other programs, studies of time against error, the self-test |
//!
//! # The guide
//!
//! [Cameras](camera::guide), [light and data](light::guide), [diagrams](figures::guide), [validation](validate::guide),
//! [accuracy](spacetime::guide), [speed](accel::guide). The format of scene files is described in [`scene`].
//!
//! # A picture in a dozen lines
//!
//! ```
//! use nullray::io::image::png;
//! use nullray::render::{Plan, Prepared, Request, Silent, render, tonemap::tonemap};
//! use nullray::scene::{self, Overrides};
//! # fn main() -> nullray::Result<()> {
//! let text = r#"
//!     camera = { eye = [0, 0, 3], look_at = [0, 0, 0], size = [32, 24], velocity = { beta = [0.5, 0, 0] } }
//!     object = [{ shape = { sphere = { radius = 1 } } }]
//! "#;
//! let scene = scene::parse(text, "a sphere", ".".as_ref(), &Overrides::default())?;
//! let plan = Plan::new(&scene, &Request::default())?;      // headers only; print it to see what is skipped
//! let prepared = Prepared::new(&scene, &plan, &Silent)?;   // loads and builds what the plan lists
//! let film = render(&prepared, &Silent)?;                  // the same bits on any number of threads
//! let display = tonemap(film.radiance(), scene.exposure)?;
//! # let folder = tempfile::tempdir().unwrap();
//! let path = std::env::temp_dir().join("sphere.png");
//! # let path = folder.path().join("sphere.png");
//! png::write(&path, 32, 24, &display.rgb, &[])?;
//! # Ok(())
//! # }
//! ```
//!
//! Conventions: c = 1, events are (ct, x, y, z) in metres; right-handed, +Y up, cameras look along −Z;
//! image row 0 is the top row; frame velocities are rapidity vectors; transforms are named
//! target-from-source. See [`spacetime`] for the physics and [`scene`] for the file format.
//!
//! # Features
//!
//! `cli` (default) is the program, with `reports` (errors that show the lines they refer to) and `pdf` (diagrams and overlays as PDF).
//! `hdf5`, `zarr` and `tiff` read captures in these formats. `schema` makes the JSON schemas of scene files, and `peers` is for a
//! benchmark. As a library it needs none of them: `default-features = false`. Work is spread over the threads of the rayon pool in which
//! a function is called. In debug builds, optimize the dependencies (`[profile.dev.package."*"]` with `opt-level = 3`): otherwise even
//! small pictures with light take many seconds.
//! The library never prints and never exits, and of the environment it reads only where temporary files go (`TMPDIR`). Same input, same
//! output, bit for bit, on any number of threads.

pub mod accel;
pub mod approximate;
pub mod camera;
pub mod colour;
pub mod error;
pub mod figures;
pub mod io;
pub mod light;
pub mod mesh;
pub mod render;
pub mod scene;
pub mod spacetime;
pub mod text;
pub mod validate;

pub use error::{Error, Result};
/// Vectors and matrices of the public interface.
pub use glam;
/// Half precision of cubes and pictures.
pub use half;
/// JSON: schemas and the metadata of files.
pub use serde_json;
