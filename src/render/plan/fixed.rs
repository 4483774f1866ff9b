//! What a plan, and all pictures of what was prepared, have in common, compared as far as that is quick.

use std::mem::discriminant;

use crate::error::{Error, Result};
use crate::scene::model::{Object, Scene, Sky};

/// What was done with a scene, and what to do about another one.
pub(crate) const PLANNED: [&str; 2] = ["planned", "a plan of this scene: Plan::new"];
pub(crate) const PREPARED: [&str; 2] = [
    "prepared",
    "prepare this scene anew with Prepared::new: only the camera can be another",
];

/// Refuses a scene that differs in more than its camera from `first`, which was [`PLANNED`] or [`PREPARED`].
pub(crate) fn check_same(first: &Scene, scene: &Scene, [done, help]: [&str; 2]) -> Result<()> {
    let refuse = |place: &str, what: String| Err(Error::invalid(&scene.name, place, what, help));
    let (had, has) = (first.objects.len(), scene.objects.len());
    if had != has {
        let what = format!("the scene has {has} objects, but {had} were {done}");
        return refuse("object", what);
    }
    let is_same = |a: &Object, b: &Object| {
        a.name == b.name
            && a.transform == b.transform
            && a.velocity == b.velocity
            && a.origin == b.origin
    };
    let mut pairs = first.objects.iter().zip(&scene.objects).enumerate();
    if let Some((i, (_, object))) = pairs.find(|(_, (a, b))| !is_same(a, b)) {
        let what = format!(
            "\"{}\" differs in name, place or motion from what was {done}",
            object.name
        );
        return refuse(&format!("object[{i}]"), what);
    }
    let sources = |s: &Scene| {
        Vec::from_iter(
            s.sources
                .iter()
                .map(|s| (s.name.clone(), discriminant(&s.kind))),
        )
    };
    let lights = |s: &Scene| Vec::from_iter(s.lights.iter().map(|l| l.name.clone()));
    // Places in the texts are their own.
    let sky = |s: &Scene| s.sky.clone().map(|sky| Sky { span: 0..0, ..sky });
    let (a, b) = (first, scene);
    let same = [
        ("source", sources(a) == sources(b)),
        ("light", lights(a) == lights(b)),
        ("sky", sky(a) == sky(b)),
        ("equations", a.equations == b.equations),
        ("effects", a.effects == b.effects),
        ("medium_index", a.medium_index == b.medium_index),
        ("background", a.background == b.background),
        ("quantity", a.quantity == b.quantity),
        ("spectra", a.spectra == b.spectra),
        ("continuation", a.continuation == b.continuation),
        ("captures", a.captures == b.captures),
        ("outside", a.outside == b.outside),
        ("bounces", a.bounces == b.bounces),
        ("back_faces", a.back_faces == b.back_faces),
    ];
    match same.iter().find(|(_, is_same)| !is_same) {
        Some((place, _)) => refuse(place, format!("it differs from the scene that was {done}")),
        None => Ok(()),
    }
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
