//! The scene: from the text of a file, or from a program's values, to a typed model, with nothing loaded yet.
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
//! TOML (UTF-8, at most 4 MiB). Unknown keys are refused. [`schema`] gives a JSON schema with every description and default, derived from
//! the types that parse the file.
//!
//! | table | purpose |
//! |---|---|
//! | `speed_of_light` | a key at the top: the speed that converts seconds to metres |
//! | `model` | a key at the top: special relativity, or the equations of Jarabo et al. 2015 |
//! | `if_missing` | a key at the top: what to do if a file that the scene names is missing |
//! | `[medium]` | refractive index of the medium |
//! | `[camera]` | pose, field of view, image size, velocity, time of the shot (required) |
//! | `[camera.motion]` | acceleration, keyframes, an animated node or a circle |
//! | `[camera.sensor]` | a sensor behind the pinhole |
//! | `[camera.rotation]` | a rotating sensor |
//! | `[camera.shutter]` | a shutter that is open for some time |
//! | `[[object]]` | geometry from glTF or a shape, transform, velocity, origin event (at least one, unless there is a sky) |
//! | `[[light]]` | lamps on their own world lines, and objects that shine |
//! | `[sky]` | light from infinity: a gradient or a picture, a sun, stars |
//! | `[[source]]` | time-resolved radiance of surfaces: a stored cube, or a pulse of light |
//! | `[radiance]` | what radiance measures, which determines the searchlight exponent |
//! | `[effects]` | aberration, Doppler shift, searchlight effect, retardation: each on or off |
//! | `[outside]` | what replaces data that a cube does not have |
//! | `[render]` | bounces, several captures of one surface, random numbers |
//! | `[display]` | exposure, background, back faces, samples per pixel |
//! | `[[panel]]` | a variant of the scene, given by its changes; each is a separate picture |
//! | `[sheet]` | how the panels are arranged on one page |
//! | `[diagram]` | a space-time diagram, of the scene or independent of it; a file may contain nothing else
//! ([`figures::diagram`](crate::figures::diagram)) |
//!
//! ## Numbers and units
//!
//! - Positions, sizes and translations are plain numbers in metres; directions are of any length but 0.
//!   All numbers are finite and at most 10³⁰ in magnitude.
//! - Everything else that has a dimension is a text with its unit; a bare number is refused. Times: `"0.6 m"`, `"3 mm"` (optical path
//!   length ct: m, cm, mm, um or µm, nm, km) or `"2 ps"` (s, ms, us or µs, ns, ps, fs, as), the latter converted with the scene's speed
//!   of light. Angles: deg, rad. Wavelengths: nm, um, mm, cm, m. Speeds: m/s, km/s, km/h. Percentages: %. Accelerations: /m, /cm, /mm,
//!   /km or 1/m … (a/c²), m/s2 or m/s², g, c/s, c/ns, c/ps. Angular rates: rad/m, deg/m, rad/s, deg/s, rad/ns, deg/ns. Those with seconds
//!   are converted with the scene's speed of light.
//! - Colours are linear red, green, blue.
//!
//! ## Frames and clocks
//!
//! - The world is right-handed with +Y up; the medium and the scene's coordinates rest in it.
//! - The *camera* is a pinhole on a world line. Its clock shows the pinhole's proper time: 0 at the world time `clock_zero`, when the
//!   pinhole is at `eye` and has its `velocity`. `time` is the camera's time at the shot, or when the shutter opens.
//! - The *camera frame* at a time of that clock is the pinhole's momentary rest frame. Its axes are the world's, boosted without rotation
//!   to the momentary velocity; the picture's axes are constant in them, except for `rotation`. `look_at − eye` is the forward axis **in
//!   the camera frame**. For a camera at rest all this is intuitive; at 0.9 c the point `look_at` is in general not seen in the middle of
//!   the picture.
//! - `motion` is the pinhole's motion from there: without acceleration if it is absent; with a proper acceleration (the reading of an
//!   accelerometer on board: `acceleration`, consecutive `segments`, or a `profile`), whose direction is given in
//!   the axes of a gyroscope on board, which at the camera's time 0 are the camera frame's, or with `axes = "world"` in the camera frame; or
//!   along a path in the world (`keyframes`, `animation`, `circle`), whose times are the world's. Profiles and keyframes have a first and
//!   a last time, and an exposure must lie between them; before and after an animation the pinhole is at rest.
//! - A *sensor* lies perpendicular to the forward axis at the focal length d behind the pinhole, and all of it is exposed at one camera
//!   time: at one time of the comoving frame, or with `"bell"`, where all elements have identical, shifted world lines, at one time of
//!   the elements' own clocks. The `assembly` determines what d measures: `"rigid"`, the distance in the camera frame, which a Born-rigid
//!   body keeps when it accelerates; `"world_length"`, the distance in the world, so that in the camera frame it is d/√(1 − β² cos² α),
//!   where α is the angle between forward axis and velocity: γd along the motion, d across it; `"bell"`, the distance in the world when
//!   clocks on the sensor and in the pinhole show the same time. The sensor's width is 2 d tan(`hfov`/2).
//! - A *rotation* turns the sensor right-handed about an axis of the camera frame, by rate × camera time.
//! - An *object* is at rest in its own frame. `transform` maps the file's coordinates to the object's (scale, then rotation, then
//!   translation, or one matrix in row order); `origin` is the world event of the object's own origin when the object's clock shows 0.
//!   Lengths in the object's frame are rest lengths: contraction is computed, never modelled. Objects exist at all times; if one is so
//!   far away, or so fast, that only light from long ago has arrived, it is seen where it was then.
//! - A velocity is given in one way: `beta`, `gamma`, `rapidity` or `one_minus_beta`. A vector includes its direction, a number needs
//!   `direction`.
//! - The pose of a camera may come from a glTF file (`gltf`, `node`) in place of `eye`, `look_at`, `up`.
//!
//! ## Lights and sky
//!
//! In a scene with a `[[light]]`, or a `[sky]` that lights, base colours are reflectances, with glTF's metalness and roughness, in the
//! surfaces' own rest frames; cubes and spectra of objects remain emitted radiance. Light is traced from its source to the surface, with
//! shadows of bodies where they were at that time, and on to the camera; with `render.bounces`, up to that many times from surface to
//! surface in between. A light's clock shows its proper time; its direction is given in its own frame, whose axes are the world's,
//! boosted without rotation. The sky rests in the world.
//!
//! ## Sources
//!
//! A source replaces the base colour as the radiance of the surfaces that it is bound to: all, or those of the named `objects` and
//! `materials`. A surface has one cube, or several that are all captures, each with its own camera; or any number of pulses, which it
//! reflects diffusely if there is neither light nor sky. A cube's samples are addressed by texture coordinates (`uv`) or by projection
//! into the camera that captured it (`capture`); that camera rests in the frame of the objects it captured, so a source with `capture`
//! must be bound to objects of one frame. Its coordinates are the world's if those objects rest in the world, and the objects' own
//! otherwise.
//!
//! The clock of a cube's time axis: `"world"` and `"object"` are times of emission, in the world and by the
//! emitting object's clock; `"capture"` is arrival at the capture camera: the frame's time of emission
//! plus η × *distance* (not depth) to its pinhole.
//!
//! ## Names, paths and overrides
//!
//! Relative paths resolve against the scene file's folder. Objects and sources have unique names; the default is the glTF node, the
//! file's name without its extension, or the shape, with a number (`box-2`) if that name is taken. [`Overrides`] set any key by a dotted
//! path, with entries by name or by number: `camera.velocity.beta=[0.5,0,0]`, `object.cube.velocity={gamma=2,direction=[1,0,0]}`,
//! `source.flash.pulse.sigma="1 cm"`, `object.0.origin.time="2 ns"`.
//!
//! ## Every key
//!
//! With defaults (`scenes/reference.toml`):
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
mod text;
mod tree;
mod values;

pub use builder::{Builder, Value};
pub use load::{SceneFile, load, parse};
pub(crate) use model_scene::MADE_FOR_MODEL;
pub use model_scene::{Flash, FlashLight, Heading, ModelScene, ModelView, model_scene};
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
