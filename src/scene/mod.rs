//! The scene: from the text of a file, or from a program's values, to a typed model with nothing loaded yet.
//!
//! ```text
//! file ── overrides ──▶ text ── toml ──▶ file structure ── what it names is looked for ── resolve ──▶ model::Scene
//! Builder ──────────────┘
//! ```
//!
//! A program that has meshes and cubes as arrays needs no file: see [`Builder`].
//!
//! # The format of a scene file
//!
//! TOML (UTF-8, at most 4 MiB). Unknown keys are refused. [`schema`] gives a JSON schema with every
//! description and default, made from the types that parse the file.
//!
//! | table | what it is for |
//! |---|---|
//! | `speed_of_light` | a key at the top: with what speed seconds become metres |
//! | `model` | a key at the top: special relativity, or the equations of Jarabo et al. 2015 |
//! | `if_missing` | a key at the top: what to do where a file that the scene names is not there |
//! | `[medium]` | refractive index of what light travels through |
//! | `[camera]` | pose, field of view, image size, velocity, time of the shot (required) |
//! | `[camera.motion]` | acceleration, keyframes, an animated node or a circle |
//! | `[camera.sensor]` | a sensor behind the pinhole |
//! | `[camera.rotation]` | a sensor that turns |
//! | `[camera.shutter]` | a shutter that is open for a while |
//! | `[[object]]` | geometry from glTF or a shape, transform, velocity, origin event (at least one) |
//! | `[[light]]` | lamps on world lines of their own, and objects that shine |
//! | `[sky]` | light from afar: a gradient or a picture, a sun, stars |
//! | `[[source]]` | time-resolved radiance of surfaces: a stored cube, or a pulse of light |
//! | `[radiance]` | what radiance measures, from which the searchlight exponent follows |
//! | `[effects]` | aberration, Doppler shift, searchlight effect, retardation: each on or off |
//! | `[outside]` | what stands in for data that a cube does not have |
//! | `[render]` | bounces, several captures of one surface, random numbers |
//! | `[display]` | exposure, background, back faces, samples per pixel |
//! | `[[panel]]` | a variant of the scene, by what it changes; each is a picture of its own |
//! | `[sheet]` | how the panels are put on one page |
//! | `[diagram]` | a space-time diagram, of the scene or of its own: a file may hold it alone ([`figures::diagram`](crate::figures::diagram)) |
//!
//! ## Numbers and units
//!
//! - Positions, sizes and translations are plain numbers in metres; directions are of any length but 0.
//!   All numbers are finite and at most 10³⁰ in magnitude.
//! - Everything else that has a dimension is a text with its unit; a bare number is refused. Times:
//!   `"0.6 m"`, `"3 mm"` (optical path length ct: m, cm, mm, um or µm, nm, km) or `"2 ps"` (s, ms, us or
//!   µs, ns, ps, fs, as), the latter converted with the scene's speed of light. Angles: deg, rad.
//!   Wavelengths: nm, um, mm, cm, m. Speeds: m/s, km/s, km/h. Percentages: %.
//!   Accelerations: /m, /cm, /mm, /km or 1/m … (a/c²), m/s2 or m/s², g, c/s, c/ns, c/ps. Angular rates: rad/m,
//!   deg/m, rad/s, deg/s, rad/ns, deg/ns. Those with seconds are converted with the scene's speed of light.
//! - Colours are linear red, green, blue.
//!
//! ## Frames and clocks
//!
//! - The world is right-handed with +Y up; the medium and the scene's coordinates rest in it.
//! - The *camera* is a pinhole on a world line. Its clock shows the pinhole's proper time: 0 at the world
//!   time `clock_zero`, when the pinhole is at `eye` and has its `velocity`. `time` is the camera's time of
//!   the shot, or at which the shutter opens.
//! - The *camera frame* at a time of that clock is the inertial frame that moves along with the pinhole
//!   then. Its axes are the world's, boosted without rotation to the momentary velocity; in them the
//!   picture's axes stay the same, turned by `rotation` alone. `look_at − eye` is the forward axis **in the
//!   camera frame**. For a camera at rest all this is what it seems; at 0.9 c the point `look_at` is in
//!   general not seen in the middle of the picture.
//! - `motion` is how the pinhole moves on from there: without acceleration where there is none; with
//!   a proper acceleration (what an accelerometer on board shows: `acceleration`, `segments` one after the other, or a
//!   `profile`), whose direction is one of the camera frame; or along a path in the world (`keyframes`, `animation`,
//!   `circle`), whose times are the world's. Profiles and keyframes have a first and a last time, and an exposure lies
//!   between them; before and after an animation the pinhole is at rest.
//! - A *sensor* lies across the forward axis at the focal length d behind the pinhole, and all of it is
//!   exposed at one camera time: at one time of the comoving frame, or with `"bell"`, where every element
//!   has a world line alike, at one time of the elements' own clocks. What d measures is the `assembly`'s:
//!   `"rigid"`, the distance in the camera frame, which a Born-rigid body keeps when it accelerates;
//!   `"world_length"`, the distance in the world, so that in the camera frame it is d/√(1 − β² cos² α), with
//!   α the angle between forward axis and velocity: γd along the motion, d across it; `"bell"`, the distance
//!   in the world when clocks on the sensor and in the pinhole show the same. The sensor's width is 2 d tan(`hfov`/2).
//! - A *rotation* turns the sensor right-handed about an axis of the camera frame, by rate × camera time.
//! - An *object* is at rest in its own frame. `transform` takes the file's coordinates to the object's
//!   (scale, then rotation, then translation, or one matrix by rows); `origin` is the world event at
//!   which the object's own origin is when the object's clock shows 0. Lengths in the object's frame are
//!   rest lengths: contraction is computed, never modelled. Objects exist at all times; where one is so far
//!   away, or so fast, that its light has only come from long ago, it is seen where it was then.
//! - A velocity is given in one way: `beta`, `gamma`, `rapidity` or `one_minus_beta`. A vector has its own
//!   direction, a number needs `direction`.
//! - The pose of a camera may come from a glTF file (`gltf`, `node`) in place of `eye`, `look_at`, `up`.
//!
//! ## Lights and sky
//!
//! In a scene with a `[[light]]`, or a `[sky]` that lights, base colours are what surfaces reflect, with glTF's
//! metalness and roughness, in their own rest frames; cubes and spectra of objects stay what surfaces shine with. Light
//! is followed from where it comes to the surface, with shadows by bodies where they were then, and to the camera; with
//! `render.bounces`, up to so many times from surface to surface before that. A light's clock shows its proper time; its direction is one of its own frame, whose axes are the world's,
//! boosted without rotation. The sky rests in the world.
//!
//! ## Sources
//!
//! A source takes the place of the base colour as the radiance of the surfaces that it is bound to: all,
//! or those of the named `objects` and `materials`. A surface has one cube, or several that are all captures, each with
//! a camera of its own; or any number of pulses, which it reflects diffusely where there is neither light nor sky. A
//! cube's samples are addressed by texture coordinates (`uv`) or by projection into the camera that captured it
//! (`capture`); that camera rests in the frame of the objects it captured, so that a source with
//! `capture` is bound to objects of one frame. Its coordinates are the world's where those objects rest
//! in the world, and the objects' own otherwise.
//!
//! The clock of a cube's time axis: `"world"` and `"object"` are times of emission, in the world and by the
//! emitting object's clock; `"capture"` is arrival at the capture camera: the frame's time of emission
//! plus η × *distance* (not depth) to its pinhole.
//!
//! ## Names, paths and overrides
//!
//! Relative paths resolve against the scene file's folder. Objects and sources have unique names; without
//! a `name`, the glTF node, the file's name without its extension, or the shape, numbered (`box-2`) where
//! that is taken. [`Overrides`] set any key by a dotted path, entries by name or by number:
//! `camera.velocity.beta=[0.5,0,0]`, `object.cube.velocity={gamma=2,direction=[1,0,0]}`,
//! `source.flash.pulse.sigma="1 cm"`, `object.0.origin.time="2 ns"`.
//!
//! ## Every key
//!
//! With its default where it has one (`scenes/reference.toml`):
//!
//! ```toml
#![doc = include_str!("../../scenes/reference.toml")]
//! ```

mod at;
mod builder;
mod derived;
mod file;
mod inputs;
pub(crate) mod limits;
mod load;
mod memory;
pub mod model;
mod model_scene;
mod names;
mod overrides;
mod panel;
mod place;
mod report;
mod resolve;
mod schema;
mod suggest;
mod tree;
mod values;

pub use builder::{Builder, Value};
pub use load::{SceneFile, load, parse};
pub(crate) use model_scene::MADE_FOR_MODEL;
pub use model_scene::{Heading, ModelScene, ModelView, model_scene};
pub use overrides::Overrides;
pub use schema::schema;

// For `[diagram]`, which `figures` reads from the same file.
pub(crate) use at::At;
pub(crate) use file::Velocity as VelocityTable;
pub(crate) use load::{base, kinematics, parse_diagram, text_of};
pub(crate) use resolve::{
    CameraMotion, Context, Kinematics, ObjectMotion, refuse_duplicates, velocity,
};
#[cfg(feature = "schema")]
pub(crate) use schema::derived as derived_schema;
pub(crate) use suggest::nearest;
pub(crate) use values::{Number, Numbers, Vector};
