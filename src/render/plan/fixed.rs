//! What a plan, and all pictures of what was prepared, have in common, compared as far as that is quick.

use glam::DAffine3;

use crate::colour::Continuation;
use crate::error::{Error, Result};
use crate::scene::model::{
    BackFaces, CaptureChoice, Effects, Equations, Object, Outside, Scene, SourceKind, Spectra,
};
use crate::spacetime::{Event, Quantity, Velocity, World};

/// The parts of a scene that only another plan, and another preparation, can change.
#[derive(Debug, Clone)]
pub(crate) struct Fixed {
    objects: Vec<Placed>,
    /// Names, and which are cubes.
    sources: Vec<(String, bool)>,
    lights: Vec<String>,
    has_sky: bool,
    equations: Equations,
    effects: Effects,
    medium_index: f64,
    background: [f64; 3],
    quantity: Quantity,
    spectra: (Spectra, Continuation),
    missing: (Outside, CaptureChoice),
    bounces: u32,
    back_faces: BackFaces,
}

/// An object with its place and motion.
#[derive(Debug, Clone, PartialEq)]
struct Placed {
    name: String,
    transform: DAffine3,
    velocity: Velocity,
    origin: Event<World>,
}

impl Placed {
    fn is_of(&self, object: &Object) -> bool {
        self.name == object.name
            && self.transform == object.transform
            && self.velocity == object.velocity
            && self.origin == object.origin
    }
}

/// What was done with the first scene, and what to do about another one.
pub(crate) const PLANNED: [&str; 2] = ["planned", "a plan of this scene: Plan::new"];
pub(crate) const PREPARED: [&str; 2] = [
    "prepared",
    "prepare this scene anew with Prepared::new: only the camera can be another",
];

impl Fixed {
    pub fn of(scene: &Scene) -> Fixed {
        let objects = scene.objects.iter().map(|object| Placed {
            name: object.name.clone(),
            transform: object.transform,
            velocity: object.velocity,
            origin: object.origin,
        });
        Fixed {
            objects: objects.collect(),
            sources: sources(scene).map(|(name, is)| (name.into(), is)).collect(),
            lights: scene
                .lights
                .iter()
                .map(|light| light.name.clone())
                .collect(),
            has_sky: scene.sky.is_some(),
            equations: scene.equations,
            effects: scene.effects,
            medium_index: scene.medium_index,
            background: scene.background,
            quantity: scene.quantity,
            spectra: (scene.spectra, scene.continuation),
            missing: (scene.outside, scene.captures),
            bounces: scene.bounces,
            back_faces: scene.back_faces,
        }
    }

    /// Refuses a scene that differs from the one that was [`PLANNED`] or [`PREPARED`].
    pub fn check(&self, scene: &Scene, [done, help]: [&str; 2]) -> Result<()> {
        let refuse =
            |place: &str, what: String| Err(Error::invalid(&scene.name, place, what, help));
        let (had, has) = (self.objects.len(), scene.objects.len());
        if had != has {
            let what = format!("the scene has {has} objects, but {had} were {done}");
            return refuse("object", what);
        }
        let mut pairs = self.objects.iter().zip(&scene.objects).enumerate();
        if let Some((i, (_, object))) = pairs.find(|(_, (placed, object))| !placed.is_of(object)) {
            let what = format!(
                "\"{}\" differs in name, place or motion from what was {done}",
                object.name
            );
            return refuse(&format!("object[{i}]"), what);
        }
        let names = self.sources.iter().map(|(name, is)| (name.as_str(), *is));
        let lights = scene.lights.iter().map(|light| &light.name);
        let same = [
            ("source", "other sources", names.eq(sources(scene))),
            ("light", "other lights", self.lights.iter().eq(lights)),
            ("sky", "another sky", self.has_sky == scene.sky.is_some()),
            (
                "equations",
                "other equations",
                self.equations == scene.equations,
            ),
            ("effects", "other effects", self.effects == scene.effects),
            (
                "medium_index",
                "another medium",
                self.medium_index == scene.medium_index,
            ),
            (
                "background",
                "another background",
                self.background == scene.background,
            ),
            (
                "quantity",
                "another quantity of radiance",
                self.quantity == scene.quantity,
            ),
            (
                "spectra",
                "other spectra",
                self.spectra == (scene.spectra, scene.continuation),
            ),
            (
                "outside",
                "other substitutes for missing data",
                self.missing == (scene.outside, scene.captures),
            ),
            (
                "bounces",
                "another number of bounces",
                self.bounces == scene.bounces,
            ),
            (
                "back_faces",
                "other back faces",
                self.back_faces == scene.back_faces,
            ),
        ];
        match same.iter().find(|(.., is_same)| !is_same) {
            Some((place, what, _)) => refuse(
                place,
                format!("the scene has {what} than the one that was {done}"),
            ),
            None => Ok(()),
        }
    }
}

/// The names of the sources, and which are cubes.
fn sources(scene: &Scene) -> impl Iterator<Item = (&str, bool)> {
    let sources = scene.sources.iter();
    sources.map(|source| {
        (
            source.name.as_str(),
            matches!(source.kind, SourceKind::Cube(_)),
        )
    })
}

/// Refuses a scene whose picture has another size than the film.
pub(crate) fn check_size(scene: &Scene, size: [u32; 2]) -> Result<()> {
    if scene.camera.size == size {
        return Ok(());
    }
    let ([w, h], [width, height]) = (scene.camera.size, size);
    let what = format!("the picture has {w} × {h} pixels, but the film {width} × {height}");
    let help = "another film for another size: Prepared::retake_on_film with a plan of this scene";
    Err(Error::invalid(&scene.name, "camera.size", what, help))
}
