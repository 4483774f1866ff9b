//! Stereo pairs: each eye's half of the picture is a picture by itself.
//!
//! The pinholes of the eyes rest in the camera's frame at ±(d/2) to the right of the middle, d the interpupillary distance, and have the
//! camera's clock (`camera::stereo`). So each eye is a camera whose origin is displaced by Λ(0, ±(d/2) right) from the pair's.

use super::super::geometry::Field;
use super::super::known::{self, KnownScene};
use super::super::options::Region;
use super::super::picture::{Picture, Plane, RADIANCE};
use super::super::points::{Points, place};
use super::fitted::of_some_size;
use super::scene_light::{Asked, light_of};
use super::{
    Case, Diagnosis, Kind, PUPIL_DISTANCE, PixelLists, constant, diagnose_channels, light, mixed,
    turns,
};
use crate::error::Message;
use crate::io::image::{Layers, Samples};
use crate::scene::model::Scene;

/// The names of the eyes, and on which side of the middle they are.
const EYES: [(&str, f64); 2] = [("left", -1.0), ("right", 1.0)];

/// Mistakes of a stereo pair; `None` for other pictures.
pub(super) fn of_eyes(case: &Case) -> Option<Vec<Diagnosis>> {
    case.is_stereo_pair().then_some(())?;
    if let Some(found) = turns::turned(case).filter(|found| found.kind == Kind::EyesExchanged) {
        return Some(vec![found]);
    }
    if let Some(found) = alike(case) {
        return Some(vec![found]);
    }
    let found = [0, 1].map(|k| of_eye(case, k));
    // What both eyes have in common is a mistake of the pair.
    let has = |found: &[Diagnosis], one: &Diagnosis| {
        found
            .iter()
            .any(|other| other.kind == one.kind && other.what == one.what)
    };
    let [left, right] = &found;
    let mut all: Vec<Diagnosis> = left.iter().filter(|one| has(right, one)).cloned().collect();
    for (k, (name, _)) in EYES.iter().enumerate() {
        let alone = found[k].iter().filter(|one| !has(&found[1 - k], one));
        all.extend(alone.map(|one| Diagnosis {
            what: Message::from(format!("in the {name} eye, ")) + one.what.clone(),
            ..one.clone()
        }));
    }
    Some(all)
}

/// The fraction of the difference between the reference's eyes below which the candidate's are alike.
const ALIKE: f64 = 0.1;

/// One picture for both eyes.
fn alike(case: &Case) -> Option<Diagnosis> {
    let [width, height] = case.points[0].size();
    case.region.is_all().then_some(())?;
    let planes = [0, 1].map(|which| Plane::group(&case.pair[which].layers, RADIANCE));
    let [r, c] = [planes[0].as_ref()?, planes[1].as_ref()?];
    // The mean difference of light between two halves.
    let apart = |[a, in_a]: [usize; 2], [b, in_b]: [usize; 2]| {
        let light = |which: usize, i: usize| place(if which == 0 { r } else { c }, i);
        let rows = (0..height).flat_map(|y| (0..width / 2).map(move |x| y * width + x));
        let off = rows
            .map(|i| (light(a, i + in_a * width / 2) - light(b, i + in_b * width / 2)).length());
        off.filter(|off| off.is_finite()).sum::<f64>()
    };
    let (right, is) = (apart([0, 0], [0, 1]), apart([1, 0], [1, 1]));
    (is <= ALIKE * right && right > 0.0).then(|| {
        let off = [0, 1].map(|eye| apart([1, 0], [0, eye]));
        let whose = match off.iter().position(|off| *off <= ALIKE * right) {
            Some(eye) => format!(": that of the {} eye", EYES[eye].0),
            None => ", and neither's: are the pupils at one place?".into(),
        };
        Diagnosis {
            kind: Kind::EyesAlike,
            what: format!("both eyes have the same picture{whose}").into(),
            evidence: vec![(
                "difference of the eyes over that in the reference",
                is / right,
            )],
        }
    })
}

/// Mistakes of one eye's picture.
fn of_eye(case: &Case, eye: usize) -> Vec<Diagnosis> {
    let halves = case.pair.map(|picture| half(picture, eye));
    let pair = halves.each_ref();
    let size = [pair[0].layers.width, pair[0].layers.height].map(|n| n as usize);
    let region = match case.region.is_all() {
        true => Region::default(),
        false => {
            let rows = (0..size[1]).flat_map(|y| {
                let row = case.region.row(y, 2 * size[0]);
                row[eye * size[0]..][..size[0]].to_vec()
            });
            Region {
                crop: None,
                mask: Some(rows.collect()),
            }
        }
    };
    if region.pixels(size).next().is_none() {
        return Vec::new();
    }
    let points = Points::pair(pair.map(|picture| &picture.layers));
    let side = EYES[eye].1;
    let whole = case.scene;
    let scene = whole.and_then(|scene| {
        let camera = known::eye(
            &scene.camera,
            side,
            [pair[0].layers.width, pair[0].layers.height],
        )?;
        Some(Scene {
            camera,
            ..scene.clone()
        })
    });
    let known = match &scene {
        Some(scene) => KnownScene::of(scene),
        None => KnownScene::of_eye(pair[0], side),
    };
    let known = known.filter(|known| known.is_that_of(&points[0]));
    let field = Field::new(&points, known.as_ref());
    let mixed = mixed::pixels(pair, &points);
    let lists = PixelLists::default();
    let case = Case {
        lists: &lists,
        mixed: &mixed,
        pair,
        points,
        region: &region,
        bin_width: case.bin_width,
        known: known.as_ref(),
        field: field.as_ref(),
        scene: scene.as_ref(),
    };
    let found = constant::set_apart(&case).unwrap_or_else(|| diagnose_channels(&case));
    // An eye that is a little aside also looks like a shifted film.
    let may_be_apart =
        !case.has_places() && found.iter().all(|found| found.kind == Kind::FilmShifted);
    let whole = whole.filter(|_| may_be_apart);
    match whole.and_then(|whole| apart(&case, whole, side)) {
        Some(apart) => vec![apart],
        None => found,
    }
}

/// Changes of the distance between the eyes to try, relative to it.
const WIDER: [f64; 5] = [-0.5, -0.25, 0.25, 0.5, 1.0];

/// Another distance between the eyes of the pair's scene, by the light of one eye.
fn apart(case: &Case, pair: &Scene, side: f64) -> Option<Diagnosis> {
    let right = pair.camera.stereo?.interpupillary_distance;
    let size = case.points[0].size().map(|n| n as u32);
    let with = |x: f64| {
        let mut camera = pair.camera.clone();
        camera.stereo.as_mut()?.interpupillary_distance += x * right;
        let camera = known::eye(&camera, side, size)?;
        Some(Scene {
            camera,
            ..pair.clone()
        })
    };
    let lit = light::lit(case)?;
    let unchanged = light_of(case, &with(0.0)?, &lit)?;
    let (x, fit) = of_some_size(case, &Asked::new(case, &lit), &unchanged, &WIDER, with)?;
    let is = (1.0 + x) * right;
    let evidence = [("distance (m)", is)].into_iter();
    Some(Diagnosis {
        kind: Kind::CameraElsewhere,
        what: format!(
            "the eyes are {is:.3} m apart, and should be {right:.3} m (judged by light only)"
        )
        .into(),
        evidence: evidence.chain(light::evidence(&fit.tally)).collect(),
    })
}

/// One eye's half of a picture.
fn half(picture: &Picture, eye: usize) -> Picture {
    fn part<T: Copy>(samples: &[T], width: usize, eye: usize) -> Vec<T> {
        let rows = samples.chunks_exact(width);
        rows.flat_map(|row| row[eye * (width / 2)..][..width / 2].to_vec())
            .collect()
    }
    let width = picture.layers.width as usize;
    let mut half = picture.clone();
    half.layers = Layers {
        width: picture.layers.width / 2,
        ..half.layers
    };
    for channel in &mut half.layers.channels {
        channel.samples = match &channel.samples {
            Samples::F32(v) => Samples::F32(part(v, width, eye)),
            Samples::F64(v) => Samples::F64(part(v, width, eye)),
            Samples::U32(v) => Samples::U32(part(v, width, eye)),
            Samples::I32(v) => Samples::I32(part(v, width, eye)),
        };
    }
    half.layers
        .metadata
        .retain(|(key, _)| key != PUPIL_DISTANCE);
    half
}
