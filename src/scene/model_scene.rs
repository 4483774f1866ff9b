//! A scene for a model that comes without one: a camera that frames it, a sky, and its own lights or a sun.
//!
//! *Framing.* The camera looks from a fixed side at the middle C of the model's bounding box. A model at rest is seen from an event as at any
//! time, so that a vertex in the look direction l is seen by a moving camera in the aberrated direction l′ = Λ l
//! ([`Boost::direction`]), wherever its shadow would fall for a camera at rest. Straight edges are seen bent, so that points of long ones count, too; of all points those
//! that are farthest from C in their direction (an outline of a few thousand). The forward axis goes through the middle of what the outline covers of
//! the film; a few steps find it, as every turn changes what the middle is. The distance is such that the outline fills the picture, by bisection: it
//! covers the more the nearer the camera is. A fast camera sees what is ahead small: it would have to be so near that it sees the model from many sides at
//! once, one part of it blue and another dark. So it comes no nearer than where the model is within a cone, and has wavelength ratios within a factor of 4; from there
//! the picture is made narrower instead.
//!
//! What stands on a wide and level ground is framed without it: triangles at the very bottom are left out of the sphere where
//! all others fit into a quarter of its radius.
//!
//! *Fly-by.* The camera passes C at the distance b. What it sees at the angle θ′ from its motion lies at θ, with
//! sin θ = sin θ′/W, cos θ = (cos θ′ − β)/(1 − β cos θ′), and has the wavelength ratio W = γ(1 − β cos θ′). C is at θ where the camera is
//! b cot θ before it, which it is at
//!
//! ```text
//! x = −b cot θ = b γ (β − cos θ′)/sin θ′.
//! ```
//!
//! The forward axis is where W = 1, at cos θ′ = γβ/(γ + 1), between blueshift and redshift: slow cameras look across their motion, and fast
//! ones more and more ahead, where all that they can see is. The first picture has C at θ = 40°, the last one at the other edge
//! of the picture, or at W = 2.5, beyond which daylight is darker than a three-hundredth. From the one to the other it takes (x₂ − x₁)/(γβ) of the camera's
//! own time.
//!
//! *Flash.* Light leaves a lamp at time 0, as a Gaussian of a sixteenth of the radius, and reaches the model and a floor under it. It is baked, and
//! looked up by a camera that moves on through a film: at camera time 0 it is at the place of the still picture, and sees the direct light reach C. The film lasts from the first light to some
//! time after the last ([`Show::span`]); the camera has the model in view, and W within the factor of 4, at both ends and at time 0.
//!
//! *Display.* What is white at 6504 K is seen with W as a blackbody of 6504 K/W, and colours that keep their hue with W⁻⁴ of their radiance. Where that
//! differs by more than a factor of 20 over the model, the display is logarithmic. Where the model is seen with W > 5, which shows what left below 170 nm, with a part in
//! 10⁷ of its brightness, colours keep their hue.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use glam::DVec3;
use toml_edit::Value;

use crate::error::{Error, Result};
use crate::io::budget::Budget;
use crate::io::gltf::{self, BadVertices, GltfLight, GltfLightKind, GltfSummary, Want};
use crate::mesh::{Factors, Mesh};
use crate::spacetime::{Boost, CameraFrame, Direction, Quantity, Velocity, World};

/// The first line of such a scene.
pub(crate) const MADE_FOR_MODEL: &str = "# Made by nullray for a model without a scene.";

/// How a model is looked at that comes without a scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ModelView {
    /// The camera's speed v/c; none at rest, and 0.5 for a fly-by.
    pub beta: Option<f64>,
    /// Where it moves to; none: along x.
    pub direction: Option<Heading>,
    /// Whether it passes by, in a sequence of [`ModelView::FLYBY_FRAMES`] pictures.
    pub flyby: bool,
    /// Columns and rows of the picture; none: those of a scene that says nothing.
    pub size: Option<[u32; 2]>,
    /// Whether the model may refer to files outside its own folder.
    pub allow_outside: bool,
    /// Whether its lights flash, and their light in flight is seen.
    pub flash: Option<Flash>,
}

/// A flash of light on a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Flash {
    /// Reflections after the first that its light is followed over.
    pub bounces: u32,
    /// The file for the baked light, an `.npz`; that of a model and the floor under it goes to two files, with `-model` and `-floor` in their names.
    pub file: PathBuf,
}

/// What of a flash has to be baked before it is looked at.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FlashLight {
    /// The scene whose objects are to be baked; its camera is always the same.
    pub scene: String,
    /// The start of the first bin, metres.
    pub start: f64,
    /// Width of a bin, metres.
    pub width: f64,
    /// Number of bins.
    pub bins: u32,
    /// What is seen of it without bounces, by the camera that looks at it: to choose an exposure.
    direct: String,
}

impl FlashLight {
    /// The scene of direct light alone, by the camera of the film.
    pub fn direct(&self) -> &str {
        &self.direct
    }
}

/// Where a camera moves to that looks at a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Heading {
    /// Along this vector, of any length but 0.
    Along(DVec3),
    /// To the model.
    Towards,
    /// From the model.
    Away,
}

impl ModelView {
    /// How many pictures a fly-by or a flash has.
    pub const FLYBY_FRAMES: u64 = 48;
    /// The speed of a fly-by for which none is given: what passes is turned by 30° and changes its hue.
    const FLYBY_SPEED: f64 = 0.5;
}

/// From the model to the camera: in front (+z, as glTF has it), somewhat to the right and above.
const VIEWPOINT: DVec3 = DVec3::new(0.5, 0.35, 1.0);
/// Horizontal field of view of a picture, degrees.
const FOV: f64 = 50.0;
/// How much of the picture, from its middle to its edges, the model fills in the direction in which it fills more.
const FILLED: f64 = 0.88;
/// Turns of the forward axis: each leaves about a fifth of how far the middle of the model is off, and all 1e-5 of it.
const TURNS: usize = 8;
/// What is seen nearer than this to 90° from the forward axis (its cosine) is taken as out of any picture.
const SIDEWAYS: f64 = 0.02;
/// Cells of the outline, from the middle along an axis: directions to 1/12, or 5°, in which a sphere is 4·10⁻³ flatter.
const CELLS: usize = 12;
/// Points of the outline on long edges, per radius: straight edges are seen bent, and 1/8 of a radius of a circle is 2·10⁻³ of it off its chord.
const PARTS: f64 = 8.0;
/// Where the model is when a fly-by begins, degrees from the motion: a little beyond the edge of the picture of a slow camera.
const FLYBY_EDGE: f64 = 40.0;
/// How far beyond the edge that is, of half the picture.
const BEYOND: f64 = 50.0 / 45.0;
/// Distance of the fly-by, in radii.
const FLYBY_DISTANCE: f64 = 2.0;
/// W at which a fly-by ends.
const FLYBY_REDDEST: f64 = 2.5;
/// At rest the sphere about the model would be within this angle, degrees: the camera is not nearer than 1.74 r.
const WIDEST: f64 = 35.0;
/// The largest quotient of two wavelength ratios of the model.
const SPREAD: f64 = 4.0;
/// W from which on colours keep their hue.
const REDDEST: f64 = 5.0;
/// How many times as bright one part of the model may be as another on a linear display, by their wavelength ratios alone.
const LINEAR: f64 = 20.0;
/// How much darker than it is what is black on a logarithmic one: shadows.
const SHADOWS: f64 = 100.0;
/// Beyond nine decades neighbouring radiances have one code.
const DECADES: f64 = 1e9;
/// A ground is at the bottom, level to this part of the radius of all, and what stands on it has at most this part of it.
const LEVEL: f64 = 0.01;
const WIDE: f64 = 0.25;
/// Bounces of a model with glass: two hollow bodies, of four surfaces each, are seen through.
const GLASS_BOUNCES: u32 = 8;
/// The size of a scene that says nothing.
const SIZE: [u32; 2] = [640, 480];

/// The scene that a model stands for.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelScene {
    /// All but how bright it is shown.
    text: String,
    /// White over black, of a logarithmic display.
    range: Option<f64>,
    /// The radiance of white, where it is not measured.
    white: f64,
    /// What has to be baked for it.
    flash: Option<FlashLight>,
}

impl ModelScene {
    /// What has to be baked before it can be rendered.
    pub fn flash(&self) -> Option<&FlashLight> {
        self.flash.as_ref()
    }

    /// Its text; a logarithmic display is for a white model in daylight.
    pub fn text(&self) -> String {
        match self.range {
            Some(_) => self.exposed(self.white),
            None => self.text.clone(),
        }
    }

    /// Its text, in which what of the model has the radiance `white` is white.
    pub fn exposed(&self, white: f64) -> String {
        let short = |radiance: f64| format!("{radiance:.2e}").parse().unwrap_or(radiance);
        let white: f64 = short(white);
        let display = match self.range {
            Some(range) => format!("logarithmic = [{:?}, {white:?}]", short(white / range)),
            None => format!("white = {white:?}"),
        };
        format!("{}\n[display]\n{display}\n", self.text)
    }
}

/// The scene that the glTF file at `path` stands for, seen as `view` says. Its path is in it as it is
/// given, so that the scene file belongs in the folder from which `path` starts. The model is loaded to be framed, and let go
/// again.
///
/// # Errors
/// As [`gltf::load`]; a model that refers to files outside its folder, unless it may, or takes more than `budget` has; a path that is not UTF-8; a model without extent; a speed that is not below that of light;
/// a direction of length 0.
pub fn model_scene(path: &Path, view: &ModelView, budget: &Budget) -> Result<ModelScene> {
    let name = path.to_str().ok_or_else(|| {
        let help = "rename the file, so that a scene file can name it";
        Error::unsupported(path, "path", "its name is not UTF-8 text", help)
    })?;
    if !view.allow_outside {
        gltf::refuse_outside(path)?;
    }
    let held = gltf::inspect(path, None)?;
    let subject = Subject::of(path, &held, budget)?;
    let motion = Motion::new(path, view)?;
    let size = view.size.unwrap_or(SIZE);
    if let Some(flash) = &view.flash {
        let model = Model {
            path,
            name,
            held: &held,
        };
        return flashing(&model, &subject, motion, size, flash);
    }
    let camera = match (view.flyby, motion) {
        (true, Some(motion)) => passing(&subject.ball, motion),
        (_, motion) => framing(&subject, motion, size, None),
    };
    let mut text = format!("{MADE_FOR_MODEL}\n");
    // Writing to a text does not fail.
    let _ = camera.write(&mut text, size);
    let _ = write!(
        text,
        "\n[[object]]\ngltf = {}\n\n[radiance]\n",
        Value::from(name).to_string().trim()
    );
    let quantity = camera.quantity();
    let _ = match quantity {
        Quantity::Rgb => writeln!(text, "quantity = \"rgb\""),
        _ => writeln!(
            text,
            "# Hues stay, as W up to {:.3} would shift all light out of sight.\nquantity = \"luminance\"",
            camera.ratios[1]
        ),
    };
    if held.factors.iter().any(Factors::is_glass) {
        let _ = write!(text, "\n[render]\nbounces = {GLASS_BOUNCES}\n");
    }
    let lights = gltf::lights(path)?;
    let _ = writeln!(text, "\n[sky]\ngradient = {{}}");
    if lights.is_empty() {
        let _ = writeln!(text, "sun = {{ direction = {} }}", vector(SUN));
    }
    for light in &lights {
        let _ = write_light(&mut text, light);
    }
    let [white, dark] = camera.ratios.map(|w| brightness(quantity, w));
    let range = white / dark;
    Ok(ModelScene {
        text,
        range: (range > LINEAR).then(|| (range * SHADOWS).min(DECADES)),
        white,
        flash: None,
    })
}

/// The file of a model.
struct Model<'a> {
    path: &'a Path,
    /// Its path as text.
    name: &'a str,
    held: &'a GltfSummary,
}

/// Standard deviation of a flash over the radius of the model: its front is an eighth of the model deep, and 48 pictures that follow it through
/// 5 radii are less far apart than that.
const SIGMA: f64 = 1.0 / 16.0;
/// Bins per standard deviation: a Gaussian of two bins has 2·10⁻³ of its light beyond the frequencies that bins keep.
const BINS_PER_SIGMA: f64 = 2.0;
/// Emission begins so many standard deviations before its peak: what is before is a millionth of the light.
const BEGINS: f64 = 5.0;
/// The first picture shows what leaves the flash so many standard deviations before its peak, at a thirtieth of it.
const DAWN: f64 = 2.6;
/// Reflected light is followed in the film for so many radii after the last direct light, and in bins for twice as many.
const FADES: f64 = 1.0;
/// Towards the flash of a model without point or spot lights, from its middle: above the viewer's left shoulder, in radii.
const FLASH: DVec3 = DVec3::new(-1.0, 1.5, 1.2);
/// Half the side of the floor under a model, in radii, and how far below the model it is.
const FLOOR: f64 = 3.0;
const BELOW: f64 = 1e-3;
/// White over black of a flash: light that comes by way of two surfaces is a hundredth of what comes directly.
const FLASH_RANGE: f64 = 300.0;

/// The scene of a model under a flash.
fn flashing(
    model: &Model,
    subject: &Subject,
    motion: Option<Motion>,
    size: [u32; 2],
    flash: &Flash,
) -> Result<ModelScene> {
    let held = model.held;
    let is_bare = |f: &Factors| f.metallic >= 1.0 || f.transmission >= 1.0;
    if held.factors.iter().all(is_bare) && !held.has_gloss_textures {
        let what = "all its surfaces are metal or glass, whose light depends on the direction, and a flash is baked without it";
        let help = "materials with a metallicFactor below 1, or a scene with `render.bounces`";
        return Err(Error::unsupported(model.path, "materials", what, help));
    }
    let Ball { centre, radius } = subject.ball;
    let sigma = SIGMA * radius;
    // Its own lamps, or one for it.
    let mut lamps = String::new();
    let mut sources: Vec<Front> = Vec::new();
    for light in &gltf::lights(model.path)? {
        // Writing to a text does not fail.
        let _ = write_light(&mut lamps, light);
        let _ = writeln!(
            lamps,
            "emission = {{ gaussian = {{ sigma = \"{sigma:?} m\" }} }}"
        );
        sources.push(match light.kind {
            GltfLightKind::Directional => Front::Plane(light.direction),
            _ => Front::Sphere(light.position),
        });
    }
    if sources.is_empty() {
        let place = centre + FLASH * radius;
        // White that faces it at the middle has about the radiance 1 when the flash is there.
        let intensity = 8.0 * sigma * FLASH.length_squared() * radius * radius;
        let _ = write!(
            lamps,
            "\n[[light]]\nname = \"flash\"\nposition = {}\nintensity = {intensity:?}\nemission = {{ gaussian = {{ sigma = \"{sigma:?} m\" }} }}\n",
            vector(place)
        );
        sources.push(Front::Sphere(place));
    }
    let arrivals = |points: &[DVec3]| {
        let all = points
            .iter()
            .flat_map(|p| sources.iter().map(|s| s.arrival(*p)));
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], t| {
            [a.min(t), b.max(t)]
        })
    };
    let floor = subject.floor.map(|bottom| {
        let y = bottom - BELOW * radius;
        let half = FLOOR * radius;
        let corner = |x: f64, z: f64| DVec3::new(centre.x + x * half, y, centre.z + z * half);
        (
            DVec3::new(centre.x, y, centre.z),
            [
                corner(-1.0, -1.0),
                corner(1.0, -1.0),
                corner(-1.0, 1.0),
                corner(1.0, 1.0),
            ],
        )
    });
    let fades = match flash.bounces {
        0 => 0.0,
        _ => FADES * radius,
    };
    let show = Show {
        sources: &sources,
        dawn: DAWN * sigma,
        fades: fades + DAWN * sigma,
        middle: arrivals(&[centre])[0],
    };
    let camera = framing(subject, motion, size, Some(&show));
    // Bins for all light that reaches the model or the floor directly, and for what follows.
    let corners = floor.iter().flat_map(|(_, corners)| corners).copied();
    let places: Vec<DVec3> = subject.outline.iter().copied().chain(corners).collect();
    let [first, last] = arrivals(&places);
    let under = floor.map(|(middle, _)| {
        sources
            .iter()
            .map(|s| s.arrival(DVec3::new(middle.x, middle.y, middle.z)))
            .fold(f64::INFINITY, f64::min)
    });
    let first = under.map_or(first, |t| first.min(t));
    let width = sigma / BINS_PER_SIGMA;
    let start = ((first - BEGINS * sigma) / width).floor() * width;
    let end = last + BEGINS * sigma + 2.0 * fades;
    let bins = ((end - start) / width)
        .ceil()
        .clamp(1.0, f64::from(MOST_BINS)) as u32;

    let objects = |is_baked: bool| {
        let mut text = String::new();
        let texture = |text: &mut String, name: &str| {
            if is_baked {
                let file = Value::from(flash.of(name, floor.is_some()));
                let _ = writeln!(
                    text,
                    "texture_coordinates = {{ file = {} }}",
                    file.to_string().trim()
                );
            }
        };
        let _ = write!(
            text,
            "\n[[object]]\nname = \"model\"\ngltf = {}\n",
            Value::from(model.name).to_string().trim()
        );
        texture(&mut text, "model");
        if let Some((middle, _)) = floor {
            let side = 2.0 * FLOOR * radius;
            let _ = write!(
                text,
                "\n[[object]]\nname = \"floor\"\nshape = {{ plane = {{ size = [{side:?}, {side:?}] }} }}\ntransform = {{ translate = {} }}\ncolour = [0.6, 0.6, 0.6]\n",
                vector(middle)
            );
            texture(&mut text, "floor");
        }
        text
    };
    let quantity = camera.quantity();
    let said = match quantity {
        Quantity::Rgb => "quantity = \"rgb\"".to_owned(),
        _ => format!(
            "# Hues stay, as W up to {:.3} would shift all light out of sight.\nquantity = \"luminance\"",
            camera.ratios[1]
        ),
    };
    let mut seen = String::new();
    let _ = camera.write(&mut seen, size);
    let mut text = format!(
        "{MADE_FOR_MODEL}\n\n{seen}{}\n[radiance]\n{said}\n",
        objects(true)
    );
    for (name, set) in [("model", held.uv_sets), ("floor", 1)] {
        if name == "model" || floor.is_some() {
            let file = Value::from(flash.of(name, floor.is_some()));
            let _ = write!(
                text,
                "\n[[source]]\nname = \"light on {name}\"\nobjects = [\"{name}\"]\ncube = {{ file = {}, array = \"radiance\", axes = \"H W T C\", start = \"{start:?} m\", bin_width = \"{width:?} m\", clock = \"world\", uv = {set}, backs = \"as_baked\" }}\n",
                file.to_string().trim()
            );
        }
    }
    let plain = objects(false);
    let light = FlashLight {
        scene: format!(
            "{MADE_FOR_MODEL}\n\n[camera]\neye = {}\nlook_at = {}\n{plain}\n[radiance]\nquantity = \"rgb\"\n\n[render]\nbounces = {}\n{lamps}",
            vector(centre + 3.0 * radius * VIEWPOINT),
            vector(centre),
            flash.bounces
        ),
        start,
        width,
        bins,
        direct: format!("{MADE_FOR_MODEL}\n{seen}{plain}\n[radiance]\n{said}\n{lamps}"),
    };
    let [white, _] = camera.ratios.map(|w| brightness(quantity, w));
    Ok(ModelScene {
        text,
        range: Some(FLASH_RANGE),
        white,
        flash: Some(light),
    })
}

/// More bins than any flash has, for a model that is far from its lamps.
const MOST_BINS: u32 = 2048;

impl Flash {
    /// The file for the light on this object.
    fn of(&self, object: &str, has_floor: bool) -> String {
        if !has_floor {
            return self.file.display().to_string();
        }
        let stem = self.file.file_stem().unwrap_or_default().to_string_lossy();
        let name = self.file.with_file_name(format!("{stem}-{object}.npz"));
        name.display().to_string()
    }
}

/// The front of a flash that leaves its lamp at time 0, or the origin if its light is parallel.
enum Front {
    Sphere(DVec3),
    Plane(DVec3),
}

impl Front {
    /// When it is at `point`.
    fn arrival(&self, point: DVec3) -> f64 {
        match self {
            Front::Sphere(place) => point.distance(*place),
            Front::Plane(direction) => point.dot(*direction),
        }
    }
}

/// What of a flash a film shows.
struct Show<'a> {
    sources: &'a [Front],
    /// How long before its front the film begins, and how long after it the film ends.
    dawn: f64,
    fades: f64,
    /// When it is at the middle of the model.
    middle: f64,
}

impl Show<'_> {
    /// When a camera sees the light of the middle of the model that leaves it with the front: it is at `eye` then.
    fn zero(&self, ball: &Ball, eye: DVec3) -> f64 {
        self.middle + eye.distance(ball.centre)
    }

    /// World times, after that moment, at which the first light of the model is seen, and the last.
    ///
    /// From E, relative to the point, at that moment, the camera is at E + βn(q + a) when it sees light that left a time q before, where a is
    /// the time of emission after that moment. q² = |E + βna + βnq|², with F = E + βna, is q = γ²(βF·n + √(β²(F·n)² + F²/γ²)).
    fn span(&self, subject: &Subject, eye: DVec3, motion: Option<&Motion>) -> [f64; 2] {
        let zero = self.zero(&subject.ball, eye);
        let seen = |point: DVec3, time: f64| {
            let after = time - zero;
            let (beta, gamma, n) = motion.map_or((0.0, 1.0, DVec3::X), |m| (m.beta, m.gamma, m.n));
            let from = eye - point + n * (beta * after);
            let along = beta * from.dot(n);
            let root = (along * along + from.length_squared() / (gamma * gamma)).sqrt();
            // Without cancellation, on either side.
            let delay = match along < 0.0 {
                true => from.length_squared() / (root - along),
                false => gamma * gamma * (along + root),
            };
            after + delay
        };
        let mut span = [f64::INFINITY, f64::NEG_INFINITY];
        for point in &subject.outline {
            for source in self.sources {
                let front = source.arrival(*point);
                span[0] = span[0].min(seen(*point, front - self.dawn));
                span[1] = span[1].max(seen(*point, front + self.fades));
            }
        }
        span
    }
}

/// How many times as bright what is white is seen with W as at rest.
fn brightness(quantity: Quantity, w: f64) -> f64 {
    // hc/(λkT) at 555 nm and 6504 K.
    const X: f64 = 0.014_387_769 / (555e-9 * 6504.0);
    match quantity {
        Quantity::Rgb => libm::expm1(X) / libm::expm1(X * w),
        _ => 1.0 / (w * w * w * w),
    }
}

/// Towards the sun of a model that has no lights of its own: above the viewer's right shoulder.
const SUN: DVec3 = DVec3::new(1.0, 1.4, 0.9);

/// A light of the file as one of the scene.
fn write_light(text: &mut String, light: &GltfLight) -> std::fmt::Result {
    let direction = vector(light.direction);
    let intensity = vector(DVec3::from_array(light.intensity));
    writeln!(text, "\n[[light]]")?;
    match light.kind {
        GltfLightKind::Directional => {
            writeln!(text, "type = \"directional\"\ndirection = {direction}")?;
            return writeln!(text, "irradiance = {intensity}");
        }
        GltfLightKind::Point => writeln!(text, "type = \"point\"")?,
        GltfLightKind::Spot { inner, outer } => {
            let [inner, outer] = [inner, outer].map(f64::to_degrees);
            writeln!(text, "type = \"spot\"\ndirection = {direction}")?;
            writeln!(text, "inner = \"{inner:?} deg\"\nouter = \"{outer:?} deg\"")?;
        }
    }
    writeln!(text, "position = {}", vector(light.position))?;
    writeln!(text, "intensity = {intensity}")
}

/// A vector as the scene file has it.
fn vector(v: DVec3) -> String {
    format!("[{:?}, {:?}, {:?}]", v.x + 0.0, v.y + 0.0, v.z + 0.0)
}

/// A sphere around all triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ball {
    centre: DVec3,
    /// Above 0.
    radius: f64,
}

/// What a camera frames.
#[derive(Debug, Clone, PartialEq)]
struct Subject {
    ball: Ball,
    /// Points of edges that are farthest from the middle of the ball, each in its cell of directions.
    outline: Vec<DVec3>,
    /// The height of its bottom, if it does not stand on a ground of its own.
    floor: Option<f64>,
}

impl Subject {
    /// Bytes that a vertex takes while a model is loaded without texture coordinates: its place, in a list that grows.
    const VERTEX: u64 = 2 * 24;
    /// A triangle: its corners, in a list that grows, and as they are in the file.
    const TRIANGLE: u64 = 2 * 12 + 12;

    fn of(path: &Path, held: &GltfSummary, budget: &Budget) -> Result<Subject> {
        let taken = Subject::VERTEX.saturating_mul(held.vertices);
        budget.take(
            taken.saturating_add(Subject::TRIANGLE.saturating_mul(held.triangles)),
            path,
        )?;
        let want = Want {
            uvs: false,
            textures: false,
            shading: false,
            normals: false,
            bad_vertices: BadVertices::Drop,
        };
        let mesh = gltf::load(path, None, want)?.mesh;
        Subject::in_mesh(&mesh).ok_or_else(|| {
            let what = "its triangles have no extent that a camera could frame";
            let help = "export a model whose triangles have an area, in metres from 1e-60 to 1e28, and no corner that is not finite";
            Error::invalid(path, "meshes", what, help)
        })
    }

    /// The triangles that have corners apart; of a model on a wide and level ground, what is above the ground.
    fn in_mesh(mesh: &Mesh) -> Option<Subject> {
        let all = Ball::of_those(mesh, |_| true)?;
        let corners = (0..mesh.triangles.len() as u32).flat_map(|i| mesh.corners(i));
        let bottom = corners.map(|p| p.y).fold(f64::INFINITY, f64::min);
        let top = bottom + LEVEL * all.radius;
        let is_above = |corners: &[DVec3; 3]| corners.iter().any(|p| p.y > top);
        let above = Ball::of_those(mesh, is_above);
        Some(
            match above.filter(|above| above.radius < WIDE * all.radius) {
                Some(above) => Subject::within(above, mesh, is_above),
                None => Subject {
                    floor: Some(bottom),
                    ..Subject::within(all, mesh, |_| true)
                },
            },
        )
    }

    /// The triangles that `count`, which are within `ball`.
    fn within(ball: Ball, mesh: &Mesh, count: impl Fn(&[DVec3; 3]) -> bool) -> Subject {
        const SIDE: usize = 2 * CELLS + 1;
        let mut farthest = vec![(0.0, DVec3::ZERO); SIDE * SIDE * SIDE];
        let step = ball.radius / PARTS;
        for point in counted(mesh, count).flat_map(|corners| along_edges(corners, step)) {
            let from_middle = point - ball.centre;
            let distance = from_middle.length();
            if distance == 0.0 {
                continue;
            }
            // Unit vectors lie in the cells of a cube of side 2 that the sphere goes through.
            let cell = |x: f64| (CELLS as f64 * (1.0 + x / distance)).round() as usize;
            let [x, y, z] = from_middle.to_array().map(cell);
            let slot = &mut farthest[(x * SIDE + y) * SIDE + z];
            if distance > slot.0 {
                *slot = (distance, point);
            }
        }
        let outline = farthest.into_iter().filter(|(distance, _)| *distance > 0.0);
        Subject {
            ball,
            outline: outline.map(|(_, point)| point).collect(),
            floor: None,
        }
    }
}

/// Points of a triangle's edges, its corners among them, that are about `step` apart or nearer.
fn along_edges([a, b, c]: [DVec3; 3], step: f64) -> impl Iterator<Item = DVec3> {
    [(a, b), (b, c), (c, a)]
        .into_iter()
        .flat_map(move |(p, q)| {
            // No edge is longer than the diameter.
            let count = (p.distance(q) / step).clamp(1.0, 2.0 * PARTS).ceil();
            (0..count as u32).map(move |k| p.lerp(q, f64::from(k) / count))
        })
}

/// The corners of the triangles that `count`, and have corners apart.
fn counted(mesh: &Mesh, count: impl Fn(&[DVec3; 3]) -> bool) -> impl Iterator<Item = [DVec3; 3]> {
    let all = (0..mesh.triangles.len() as u32).map(|i| mesh.corners(i));
    all.filter(move |corners @ [a, b, c]| a != b && b != c && count(corners))
}

impl Ball {
    /// That of those triangles that `count`, and have corners apart.
    fn of_those(mesh: &Mesh, count: impl Fn(&[DVec3; 3]) -> bool) -> Option<Ball> {
        let seen = || counted(mesh, &count).flatten();
        let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let [least, greatest] = seen().fold(empty, |[l, g], p| [l.min(p), g.max(p)]);
        let centre = 0.5 * least + 0.5 * greatest;
        let radius = seen().map(|p| p.distance(centre)).fold(0.0, f64::max);
        // Squares of lengths and the camera's place, at most a hundred radii away, are in the range of scenes, and the sphere is larger than
        // the last digit of where it is.
        let seen = (1e-60..1e28).contains(&radius)
            && centre.length() < 1e29
            && centre.length() * 1e-12 < radius;
        seen.then_some(Ball { centre, radius })
    }
}

/// The camera's motion.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Motion {
    beta: f64,
    gamma: f64,
    /// Unit vector.
    n: DVec3,
}

impl Motion {
    /// None at rest.
    fn new(path: &Path, view: &ModelView) -> Result<Option<Motion>> {
        let refuse =
            |place: &str, what: String, help: &str| Err(Error::invalid(path, place, what, help));
        let default = view.flyby.then_some(ModelView::FLYBY_SPEED);
        let Some(beta) = view.beta.or(default) else {
            return Ok(None);
        };
        if !(beta > -1.0 && beta < 1.0) {
            let what = format!("|β| = {} is not below 1", beta.abs());
            return refuse("beta", what, "give a speed between −1 and 1, like 0.9");
        }
        let away = VIEWPOINT.normalize();
        let n = match view.direction.unwrap_or(Heading::Along(DVec3::X)) {
            Heading::Along(vector) => vector,
            Heading::Towards => -away,
            Heading::Away => away,
        };
        let Some(n) = Direction::<World>::new(n) else {
            let what = format!("{n} has no direction");
            return refuse("direction", what, "give a vector like 1,0,-1");
        };
        if beta == 0.0 && view.flyby {
            let what = "a camera at rest passes nothing".to_owned();
            return refuse("beta", what, "give a speed above 0, like 0.9");
        }
        let velocity = Velocity::from_beta(n.unit() * beta);
        let gamma = velocity.map_or(f64::INFINITY, Velocity::gamma);
        if gamma.is_nan() || gamma >= 1e8 {
            let what = format!("at |β| = {} nothing can be framed", beta.abs());
            return refuse("beta", what, "give a slower camera");
        }
        let (beta, n) = (beta.abs(), n.unit() * beta.signum());
        Ok((beta > 0.0).then_some(Motion { beta, gamma, n }))
    }

    /// To the camera's frame.
    fn boost(&self) -> Boost<CameraFrame, World> {
        let velocity = Velocity::from_beta(self.n * self.beta);
        // Speeds were checked when the motion was made.
        Boost::<World, CameraFrame>::new(velocity.unwrap_or(Velocity::REST)).inverse()
    }
}

/// The camera of a scene.
struct Framing {
    eye: DVec3,
    forward: DVec3,
    /// Degrees.
    fov: f64,
    motion: Option<Motion>,
    /// Camera time between the pictures of a sequence, metres.
    interval: Option<f64>,
    /// The world time at which the camera is at `eye`, and its own time of the first picture after that, metres.
    times: Option<[f64; 2]>,
    /// A length of the scene, to which `look_at` is.
    reach: f64,
    /// The least and the greatest W of the model.
    ratios: [f64; 2],
}

impl Framing {
    /// What its light is seen by: the hues of a model stay where nothing would be seen of it.
    fn quantity(&self) -> Quantity {
        match self.ratios[1] > REDDEST {
            true => Quantity::Integrated,
            false => Quantity::Rgb,
        }
    }

    fn write(&self, text: &mut String, size: [u32; 2]) -> std::fmt::Result {
        writeln!(text, "[camera]")?;
        writeln!(text, "eye = {}", vector(self.eye))?;
        let target = self.eye + self.forward * self.reach;
        writeln!(text, "look_at = {}", vector(target))?;
        let up = up_of(self.forward);
        if up != DVec3::Y {
            writeln!(text, "up = {}", vector(up))?;
        }
        writeln!(text, "hfov = \"{:?} deg\"", self.fov)?;
        writeln!(text, "size = [{}, {}]", size[0], size[1])?;
        if let Some(Motion { beta, n, .. }) = self.motion {
            let direction = vector(n);
            writeln!(
                text,
                "velocity = {{ beta = {beta:?}, direction = {direction} }}"
            )?;
        }
        if let Some([zero, first]) = self.times {
            writeln!(text, "clock_zero = \"{zero:?} m\"")?;
            writeln!(text, "time = \"{first:?} m\"")?;
        }
        match self.interval {
            Some(interval) => writeln!(text, "frame_interval = \"{interval:?} m\""),
            None => Ok(()),
        }
    }
}

/// A camera that has the whole model in view, in each picture of a film if it shows a flash.
fn framing(
    subject: &Subject,
    motion: Option<Motion>,
    [width, height]: [u32; 2],
    show: Option<&Show>,
) -> Framing {
    let away = VIEWPOINT.normalize();
    let Ball { centre, radius } = subject.ball;
    let aspect = f64::from(width) / f64::from(height);
    // Half the extents of the film at the distance 1.
    let across = libm::tan(0.5 * FOV.to_radians());
    let film = [across, across / aspect];
    let boost = motion.as_ref().map(Motion::boost);
    let look = |alpha: f64| {
        let eye = centre + away * (radius / libm::sin(alpha));
        let span = show.map(|show| show.span(subject, eye, motion.as_ref()));
        let eyes = match (span, motion) {
            (Some([first, last]), Some(Motion { beta, n, .. })) => {
                vec![eye, eye + n * (beta * first), eye + n * (beta * last)]
            }
            _ => vec![eye],
        };
        let look = Look::at(subject, &eyes, boost.as_ref(), film);
        (eye, look, span)
    };
    let widest = WIDEST.to_radians();
    let fits = |alpha: f64| {
        let is_fit = |look: Look| look.filled < FILLED && look.ratios[1] < SPREAD * look.ratios[0];
        look(alpha).1.is_some_and(is_fit)
    };
    let alpha = bisect(widest, fits);
    // What is found is at most one last digit beyond the edge, where nothing may be in view at all.
    let (eye, look, span) = look(alpha * (1.0 - f64::EPSILON));
    let gamma = motion.map_or(1.0, |motion| motion.gamma);
    let Look {
        forward,
        filled,
        ratios,
    } = look.unwrap_or(Look {
        forward: -away,
        filled: FILLED,
        ratios: [1.0; 2],
    });
    // Narrower, where the camera would have to be too near to fill the picture.
    let tangent = across * (filled / FILLED).min(1.0);
    Framing {
        eye,
        forward,
        fov: 2.0 * libm::atan(tangent).to_degrees(),
        motion,
        interval: span
            .map(|[first, last]| (last - first) / gamma / (ModelView::FLYBY_FRAMES - 1) as f64),
        times: show
            .zip(span)
            .map(|(show, [first, _])| [show.zero(&subject.ball, eye), first / gamma]),
        reach: eye.distance(centre),
        ratios,
    }
}

/// How a camera has a model in the middle of its picture.
#[derive(Debug, Clone, Copy)]
struct Look {
    forward: DVec3,
    /// How much of half the picture the model fills, across or upwards.
    filled: f64,
    /// The least and the greatest W of the model.
    ratios: [f64; 2],
}

impl Look {
    /// From the first of `eyes`, and all others on its way, of a camera whose film has these half extents at the distance 1; none where the model is seen too far to the side.
    fn at(
        subject: &Subject,
        eyes: &[DVec3],
        boost: Option<&Boost<CameraFrame, World>>,
        film: [f64; 2],
    ) -> Option<Look> {
        let seen = |point: DVec3, eye: DVec3| {
            let d = (point - eye).normalize();
            match boost {
                None => (d, 1.0),
                // The boost to the world has W where the one back has 1/W.
                Some(boost) => {
                    let (seen, inverse) = boost.direction(Direction::from_unit(d));
                    (seen.unit(), inverse.recip())
                }
            }
        };
        let from = |eye: &DVec3| {
            let eye = *eye;
            subject.outline.iter().map(move |p| seen(*p, eye))
        };
        let outline: Vec<(DVec3, f64)> = eyes.iter().flat_map(from).collect();
        let ratios = outline.iter().map(|(_, w)| *w);
        let ratios = ratios.fold([f64::INFINITY, 0.0], |[a, b]: [f64; 2], w| {
            [a.min(w), b.max(w)]
        });
        let middles = eyes.iter().map(|eye| seen(subject.ball.centre, *eye).0);
        let mut forward = middles.sum::<DVec3>().normalize();
        let mut filled = f64::INFINITY;
        for turn in 1..=TURNS {
            let right = forward.cross(up_of(forward)).normalize();
            let up = right.cross(forward);
            let mut least = [f64::INFINITY; 2];
            let mut most = [f64::NEG_INFINITY; 2];
            for (l, _) in &outline {
                let ahead = l.dot(forward);
                if ahead < SIDEWAYS {
                    return None;
                }
                for (k, axis) in [right, up].into_iter().enumerate() {
                    let place = l.dot(axis) / ahead;
                    least[k] = least[k].min(place);
                    most[k] = most[k].max(place);
                }
            }
            // The farther of both edges from the middle of the picture, which is in the middle of them after some turns.
            let parts = [0, 1].map(|k| most[k].max(-least[k]) / film[k]);
            let before = std::mem::replace(&mut filled, parts[0].max(parts[1]));
            let [x, y] = [0, 1].map(|k| 0.5 * (least[k] + most[k]));
            if turn == TURNS || before - filled <= 1e-9 * filled {
                break;
            }
            forward = (forward + right * x + up * y).normalize();
        }
        Some(Look {
            forward,
            filled,
            ratios,
        })
    }
}

/// What is up in the picture of a camera that looks along `forward`: where that is up or down, what is behind it.
fn up_of(forward: DVec3) -> DVec3 {
    match forward.y.abs() > 0.99 {
        true => DVec3::new(0.0, 0.0, -forward.y.signum()),
        false => DVec3::Y,
    }
}

/// The largest number up to `most` that is `below`, which smaller ones are.
fn bisect(most: f64, below: impl Fn(f64) -> bool) -> f64 {
    if below(most) {
        return most;
    }
    let (mut low, mut high) = (0.0, most);
    // A hundred halvings leave nothing of f64, of numbers as small as 1e-14 too.
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        match below(middle) {
            true => low = middle,
            false => high = middle,
        }
    }
    high
}

/// A camera that passes by.
fn passing(ball: &Ball, motion: Motion) -> Framing {
    let Motion { beta, gamma, n } = motion;
    // It passes in front; to the right where it comes from there, or goes there.
    let side = |v: DVec3| v.reject_from_normalized(n);
    let front = side(DVec3::new(0.0, 0.25, 1.0));
    let across = match front.length() > 0.3 {
        true => front.normalize(),
        false => side(DVec3::new(1.0, 0.25, 0.0)).normalize(),
    };
    let distance = FLYBY_DISTANCE * ball.radius;
    // From θ = 40°, seen at tan θ′/2 = e^−φ tan θ/2.
    let edge = FLYBY_EDGE.to_radians();
    let shrinks = 1.0 / (gamma * (1.0 + beta));
    let first = 2.0 * libm::atan(shrinks * libm::tan(0.5 * edge));
    let middle = libm::acos(gamma * beta / (gamma + 1.0));
    let reddest = libm::acos(((1.0 - FLYBY_REDDEST / gamma) / beta).max(-1.0));
    let last = (2.0 * middle - first).min(reddest);
    let place = |seen: f64| {
        let (sin, cos) = libm::sincos(seen);
        distance * gamma * (beta - cos) / sin
    };
    let [from, to] = [first, last].map(place);
    let duration = (to - from) / (gamma * beta);
    let (sin, cos) = libm::sincos(middle);
    Framing {
        eye: ball.centre + across * distance + n * from,
        forward: n * cos - across * sin,
        fov: (2.0 * (middle - first) / BEYOND).to_degrees(),
        motion: Some(motion),
        interval: Some(duration / (ModelView::FLYBY_FRAMES - 1) as f64),
        times: None,
        reach: distance,
        ratios: [first, last].map(|seen| gamma * (1.0 - beta * libm::cos(seen))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box, by the corners of a grid on it, and the sphere about it.
    fn slab(size: DVec3, middle: DVec3) -> Subject {
        let steps = || (0..=4).map(|k| f64::from(k) / 4.0 - 0.5);
        let grid = steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| [x, y, z])));
        let outline = grid.map(|p| middle + size * DVec3::from_array(p)).collect();
        Subject {
            ball: Ball {
                centre: middle,
                radius: 0.5 * size.length(),
            },
            outline,
            floor: None,
        }
    }

    #[test]
    fn the_model_fills_the_middle_of_the_picture_at_any_speed_and_scale() {
        for scale in [1e-3, 1.0, 1e4] {
            let size = DVec3::new(4.0, 1.0, 0.5) * scale;
            let subject = slab(size, DVec3::new(3.0, -1.0, 7.0) * scale);
            for (beta, n) in [
                (0.0, DVec3::X),
                (0.9, DVec3::X),
                (0.99, DVec3::new(0.3, 0.9, -0.3)),
                (0.5, -VIEWPOINT),
                (0.99, VIEWPOINT),
            ] {
                let n = n.normalize();
                let gamma = 1.0 / f64::sqrt(1.0 - beta * beta);
                let motion = Motion { beta, gamma, n };
                let camera = framing(&subject, Some(motion), [640, 320], None);
                // cos θ′ = (cos θ + β)/(1 + β cos θ) about the motion, in the plane of both.
                let seen = |p: DVec3| {
                    let d = (p - camera.eye).normalize();
                    let cos = d.dot(n);
                    let along = (cos + beta) / (1.0 + beta * cos);
                    let across = d.reject_from(n).normalize_or_zero();
                    n * along + across * (1.0 - along * along).max(0.0).sqrt()
                };
                let right = camera.forward.cross(DVec3::Y).normalize();
                let up = right.cross(camera.forward);
                let half = libm::tan(0.5 * camera.fov.to_radians());
                let extent = |axis: DVec3, half: f64| {
                    let places = subject.outline.iter().map(|p| {
                        let l = seen(*p);
                        l.dot(axis) / l.dot(camera.forward) / half
                    });
                    places.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| {
                        [a.min(x), b.max(x)]
                    })
                };
                let edges = [extent(right, half), extent(up, 0.5 * half)];
                let case = format!("{scale} {beta} {n}: {edges:?}");
                let filled = edges.map(|[a, b]| b.max(-a));
                assert!(
                    (filled[0].max(filled[1]) / FILLED - 1.0).abs() < 1e-6,
                    "{case}"
                );
                // The margins are alike.
                assert!(edges.iter().all(|[a, b]| (a + b).abs() < 1e-2), "{case}");
            }
        }
    }

    #[test]
    fn the_outline_has_what_is_farthest_in_every_direction() {
        // A spike out of a ball of many triangles.
        let mut corners = Vec::new();
        for k in 0..20_000 {
            let z = 1.0 - f64::from(k) / 10_000.0;
            let (sin, cos) = libm::sincos(2.4 * f64::from(k));
            corners.push(DVec3::new(cos, sin, 0.0) * (1.0 - z * z).max(0.0).sqrt() + DVec3::Z * z);
        }
        corners[5000] *= 1.5;
        let spike = corners[5000];
        let triangles = (0..corners.len() as u32 - 2).map(|k| [k, k + 1, k + 2]);
        let mesh = Mesh::new(corners.clone(), triangles.collect(), [1.0; 3]);
        let subject = Subject::in_mesh(&mesh).unwrap();
        assert!(subject.outline.len() < 4000 && subject.outline.contains(&spike));
        for direction in [
            DVec3::X,
            DVec3::new(-1.0, 2.0, 0.4),
            DVec3::new(0.1, -0.3, -2.0),
        ] {
            let reach = |all: &[DVec3]| {
                let along = all.iter().map(|p| p.dot(direction.normalize()));
                along.fold(f64::NEG_INFINITY, f64::max)
            };
            let [all, outline] = [&corners, &subject.outline].map(|all| reach(all));
            assert!(outline > all * (1.0 - 4e-3), "{outline} of {all}");
        }
    }

    #[test]
    fn a_model_on_a_wide_ground_is_framed_without_it() {
        let square = |size: f64, y: f64| {
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(|(x, z)| DVec3::new(x * size, y, z * size))
        };
        let with = |ground: f64| {
            let mut mesh = crate::mesh::shapes::mesh(
                crate::mesh::shapes::Shape::Plane { size: [1.0; 2] },
                [1.0; 3],
            );
            mesh.positions = [square(ground, 0.0), square(1.0, 2.0)].concat();
            mesh.triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
            Subject::in_mesh(&mesh).unwrap().ball
        };
        // The upper square alone: its half diagonal. With a ground of its size both are framed.
        let alone = with(100.0);
        assert!((alone.radius - 2f64.sqrt()).abs() < 1e-12, "{alone:?}");
        assert!((alone.centre - DVec3::Y * 2.0).length() < 1e-12);
        assert!((with(1.0).radius - 3f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_flyby_crosses_the_picture_about_the_place_without_a_shift() {
        let ball = Ball {
            centre: DVec3::new(5.0, 0.0, 0.0),
            radius: 2.0,
        };
        // β, γ, and where all but the fastest leave the picture, half of which is 45/50 of the way from the first place to the middle.
        for (beta, gamma) in [
            (0.02, 1.0002),
            (0.6, 1.25),
            (0.96, 1.0 / 0.28),
            (0.9999, 70.71),
        ] {
            let n = DVec3::X;
            let motion = Motion { beta, gamma, n };
            let camera = passing(&ball, motion);
            let seen = |time: f64| {
                // γβ of path per proper time.
                let path = camera.interval.unwrap() * time * gamma * beta;
                let to = ball.centre - (camera.eye + DVec3::X * path);
                let cos = to.normalize().x;
                let w = 1.0 / (gamma * (1.0 + beta * cos));
                (((cos + beta) / (1.0 + beta * cos)).acos(), w)
            };
            let ahead = camera.forward.x.acos();
            assert!((gamma * (1.0 - beta * ahead.cos()) - 1.0).abs() < 1e-4);
            let steps = (ModelView::FLYBY_FRAMES - 1) as f64;
            let ([first, _], [last, w]) = (seen(0.0).into(), seen(steps).into());
            let half = 0.5 * camera.fov.to_radians();
            assert!(
                ((ahead - first) / half - 50.0 / 45.0).abs() < 1e-4,
                "{beta}"
            );
            let is_at_edge = ((last - ahead) / half - 50.0 / 45.0).abs() < 1e-4;
            let is_reddest = (w / 2.5 - 1.0).abs() < 1e-3 && last - ahead < half * 50.0 / 45.0;
            assert!(
                is_at_edge == (beta < 0.9) && is_at_edge != is_reddest,
                "{beta} {last} {w}"
            );
        }
    }

    #[test]
    fn triangles_without_extent_are_not_framed() {
        let flat = Mesh::new(vec![DVec3::ONE; 3], vec![[0, 1, 2]], [1.0; 3]);
        assert_eq!(Subject::in_mesh(&flat), None);
        let corners = vec![DVec3::ZERO, DVec3::X * 2.0, DVec3::Y, DVec3::Z * 1e9];
        let one = Mesh::new(corners, vec![[0, 1, 2], [3, 3, 3]], [1.0; 3]);
        let ball = Subject::in_mesh(&one).unwrap().ball;
        assert_eq!(ball.centre, DVec3::new(1.0, 0.5, 0.0));
    }
}
