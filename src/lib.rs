//! A reference renderer for special relativity and time-resolved light.
//!
//! Every sensor sample becomes an event in the camera's frame, is Lorentz-transformed into a null ray of
//! the world, carried into the rest frame of whatever it meets, intersected there with a static BVH,
//! and looked up in time-resolved radiance at the retarded time. Nothing is ever re-tessellated, so
//! there is no tessellation error.
//!
//! ```text
//! scene file → scene model → plan → prepared scene → camera sample → null ray → hit → retarded event
//! [scene]      [scene::model] [plan] [prepare]        [camera]        [spacetime] [accel] [trace]
//!            → radiance      → film → image, display, isochrones
//!              [time_texture]  [film] [image, tonemap, isochrones]
//! ```
//!
//! Around it: [`raster`] makes the same pictures by other means, and [`tessellation`] foretells how fine these must
//! be; [`compare`] holds pictures against each other, [`study`] run time against error; [`export`] writes scenes for
//! other programs. [`diagram`] draws the world lines of a scene, [`sighting`] what one pixel sees of them.
//! [`selftest`] tests a build where f64 ends.
//!
//! A picture in ten lines:
//!
//! ```
//! use nullray::{image::png, plan::{Plan, Request}, prepare::Prepared, progress::Silent};
//! use nullray::{render::render, scene::{self, Overrides}, tonemap::tonemap};
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
//! The library never prints, never exits and never reads the environment. Same input, same output, bit
//! for bit, on any number of threads.

#![deny(unsafe_code)]
#![warn(missing_docs)]

pub mod accel;
pub mod aov;
pub mod apparent;
pub mod camera;
pub mod colour;
pub mod compare;
pub mod diagram;
pub mod drawing;
pub mod error;
pub mod export;
pub mod files;
pub mod film;
pub mod image;
pub mod import;
pub mod isochrones;
pub mod mesh;
pub mod metadata;
pub mod overlay;
pub mod plan;
pub mod prepare;
pub mod progress;
pub mod raster;
pub mod render;
pub mod sampler;
pub mod scene;
pub mod selftest;
pub mod shapes;
pub mod sheet;
pub mod sighting;
pub mod spacetime;
pub mod study;
pub mod tessellation;
pub mod text;
pub mod time_texture;
pub mod tonemap;
pub mod trace;
pub mod units;
mod vectors;

pub use error::{Error, Result};
