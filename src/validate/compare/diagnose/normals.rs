//! Normals in coordinates other than those of the object's own frame.
//!
//! A surface F(p) = 0 of a body with velocity β along e, with the normal n there, has the normal in the world
//!
//! ```text
//! at one time            n⊥ + γ (n·e) e                      p = x⊥ + γ (x·e − βt) e
//! as it is seen          n⊥ + γ (n·e) (e + ηβ d)             t = T − η|x|, along the look direction d
//! ```
//!
//! and as seen from a camera with βc along ec, at the look direction d′ of its frame, a⊥ + γc (a·ec)(ec − βc d′), with a from above. Each
//! may also be along the camera's own axes, and so may n itself.

use glam::{DMat3, DVec3};

use super::super::picture::Plane;
use super::super::points::place;
use super::frames::{Hypothesis, VIEW, best};
use super::{Case, Diagnosis};
use crate::render::aov::Aov;
use crate::spacetime::{Direction, World};

/// Smaller errors of unit normals are ignored: half precision leaves 0.0005.
const NOTABLE: f64 = 0.002;
const RIGHT: &str = "the objects' own frames";

/// Normals in another frame.
pub(super) fn normals(case: &Case) -> Option<Diagnosis> {
    let names = [Aov::NormalX, Aov::NormalY, Aov::NormalZ];
    let [r, c] = case.pair.map(|p| Plane::aovs(&p.layers, names));
    let (r, c, known) = (r?, c?, case.known?);
    let [width, _] = case.points[0].size();
    let object = move |i: usize| match case.points[0].object_at(i) {
        Some(id) => (id >= 0.0).then_some(id as usize),
        None => Some(0),
    };
    let own = move |i: usize| place(&r, i);
    let look = move |i: usize| -> Option<Direction<World>> {
        let centre = [i % width, i / width].map(|x| x as f64 + 0.5);
        known.look_along(centre.into())
    };
    let contracted = move |i: usize| {
        let velocity = known.frame(object(i)?)?.velocity();
        let (e, _) = velocity.split();
        let n = own(i);
        Some((n + (velocity.gamma() - 1.0) * n.dot(e) * e).normalize())
    };
    let apparent = move |i: usize| {
        let velocity = known.frame(object(i)?)?.velocity();
        let (e, n) = (velocity.split().0, own(i));
        let slid = known.index() * velocity.beta().length() * look(i)?.unit();
        let part = n.dot(e);
        let along = velocity.gamma() * part * (e + slid) - part * e;
        Some((n + along).normalize())
    };
    let camera = known.camera_velocity();
    let from_camera = move |i: usize| {
        let (ec, a) = (camera.split().0, apparent(i)?);
        let own = known.own_look(look(i)?.unit())?;
        let part = a.dot(ec);
        let along = camera.gamma() * part * (ec - camera.beta().length() * own) - part * ec;
        Some((a + along).normalize())
    };
    let facing = move |i: usize| {
        let frame = known.frame(object(i)?)?;
        let (d, _) = frame.frame_from_world().direction(look(i)?);
        let n = own(i);
        Some(if n.dot(d.unit()) > 0.0 { -n } else { n })
    };
    let mut hypotheses: Vec<Hypothesis> = vec![
        (
            "the world's frame, of the contracted body",
            Box::new(contracted),
        ),
        (
            "the world's frame, of the body as it is seen",
            Box::new(apparent),
        ),
        (
            "the camera's frame, of the body as it is seen",
            Box::new(from_camera),
        ),
        (VIEW, Box::new(move |i| Some(known.view(own(i))))),
        (
            "the camera's own axes (right, up, backwards), of the body as it is seen",
            Box::new(move |i| Some(known.view(from_camera(i)?))),
        ),
        (
            "the objects' own frames, but turned towards the camera",
            Box::new(facing),
        ),
    ];
    if let Some(scene) = case.scene {
        // A covector in the file's coordinates is the transposed matrix times that in the object's.
        let of_file = move |i: usize| {
            let matrix: DMat3 = scene.objects.get(object(i)?)?.transform.matrix3;
            Some((matrix.transpose() * own(i)).normalize_or(DVec3::ZERO))
        };
        let words = "the coordinates of their files, before they are turned and scaled";
        hypotheses.push((words, Box::new(of_file)));
    }
    best(
        ["normal", RIGHT],
        NOTABLE,
        case.pixels(),
        [r, c],
        hypotheses,
    )
}
