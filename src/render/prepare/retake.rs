//! What pictures of one prepared scene have in common, compared as far as that is quick.

use glam::DAffine3;

use crate::error::{Error, Result};
use crate::scene::model::{Effects, Object, Scene};
use crate::spacetime::{Event, Velocity, World};

/// The parts of a scene that only another preparation can change.
#[derive(Debug)]
pub(super) struct Fixed {
    objects: Vec<Placed>,
    effects: Effects,
    medium_index: f64,
}

/// An object with its place and motion.
#[derive(Debug, PartialEq)]
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
            effects: scene.effects,
            medium_index: scene.medium_index,
        }
    }

    /// Refuses a scene that differs.
    pub fn check(&self, scene: &Scene) -> Result<()> {
        let (had, has) = (self.objects.len(), scene.objects.len());
        if had != has {
            let what = format!("the scene has {has} objects, but {had} were prepared");
            return Err(refuse(scene, "object".into(), what));
        }
        let mut pairs = self.objects.iter().zip(&scene.objects).enumerate();
        if let Some((i, (_, object))) = pairs.find(|(_, (placed, object))| !placed.is_of(object)) {
            let place = format!("object[{i}]");
            let what = format!(
                "\"{}\" differs in name, place or motion from what was prepared",
                object.name
            );
            return Err(refuse(scene, place, what));
        }
        if self.effects != scene.effects {
            let what = "other effects are on than in the scene that was prepared".to_string();
            return Err(refuse(scene, "effects".into(), what));
        }
        if self.medium_index != scene.medium_index {
            let what = "the medium is not that of the scene that was prepared".to_string();
            return Err(refuse(scene, "medium_index".into(), what));
        }
        Ok(())
    }
}

/// Refuses a scene whose picture has another size than the film.
pub(super) fn check_size(scene: &Scene, size: [u32; 2]) -> Result<()> {
    if scene.camera.size == size {
        return Ok(());
    }
    let ([w, h], [width, height]) = (scene.camera.size, size);
    let what = format!("the picture has {w} × {h} pixels, but the film {width} × {height}");
    let help = "another film for another size: Prepared::retake_on_film with a plan of this scene";
    Err(Error::invalid(&scene.name, "camera.size", what, help))
}

fn refuse(scene: &Scene, place: String, what: String) -> Error {
    let help = "prepare this scene anew with Prepared::new: only the camera can be another";
    Error::invalid(&scene.name, place, what, help)
}
