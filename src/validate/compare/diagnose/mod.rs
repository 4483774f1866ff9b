//! Why a candidate is wrong: hypotheses that explain most of an error, with their evidence.
//!
//! A hypothesis h(r) about what a picture holds instead of the reference's r explains the error if |c − h(r)| is below a tenth of |c − r|,
//! or of the rms of that error, at nine tenths of the pixels where either is notable. Hypotheses without free parameters are tested first,
//! the others only if these do not explain it. In large pictures most are tested on some pixels first, and on all only if they may explain
//! the error (`Tally::of_pixels`, `light::LitPixels`).
//!
//! | diagnosis | hypothesis |
//! |---|---|
//! | picture mirrored | the candidate, turned, matches the reference: left to right, top to bottom, both, or across its diagonal |
//! | picture moved by whole pixels | the same for a shift by one or two pixels |
//! | channels never written | the candidate's hold one number at every pixel, while the reference's vary (`constant`) |
//! | identities wrong | the indices of objects (or triangles) count from 1, or are those of other objects |
//! | aberration reversed, missing, or without γ | look directions, or positions in a known scene, are those for −β, for 0, or for a boost that lacks γ (`looks`) |
//! | camera at another velocity, or turned | look directions are those of another boost, or of a rotation before it, also with another film (`looks`); points of a known scene are where such a camera sees them (`camera`) |
//! | camera elsewhere | the same for a camera at another place |
//! | stereo pairs | the eyes are exchanged, or have one picture, or each has a mistake of its own (`stereo`) |
//! | clipped | light is the reference's up to a bound |
//! | light elsewhere | the light is that of the scene with a pulse or a lamp at another place; needs the scene |
//! | camera at another time | points of a known scene are where a camera whose clock is ahead sees them (`camera`) |
//! | shots that differ | the metadata of both pictures state different velocities or times of the camera: then consequences are not reported |
//! | retardation missing | all emission times are equal; or points of a known scene, or of one object, are where they are at the time of the shot |
//! | retardation of the opposite sign | points are where they are as long after the shot; or so is the light |
//! | contraction missing | points are where they would be in bodies as long as at rest (`motion`) |
//! | velocities swapped, reversed, missing, wrong | by wavelength ratios, or by positions in a known scene (`motion`) |
//! | film moved or scaled | points belong at a + k p for the pixel p: half a pixel, another field of view or focal length, another aspect ratio |
//! | axes exchanged | x, y, z of events, normals, directions are permuted, or negated |
//! | directions reversed | d is −d |
//! | frame wrong | events are those of the objects' or the camera's frame, or relative to the shot; directions have the camera's axes |
//! | normals of another frame | normals are those of the contracted or of the apparent body, or along the camera's axes, or those of the file (`normals`) |
//! | depth for distance | the distance is the depth along the axis, or one over it, or the path length in the camera's frame; times are delayed by it (`depth`) |
//! | sign opposite | times are −t |
//! | units | lengths, or times, are multiplied by one factor: mm, cm, km, s, ns |
//! | texture coordinates flipped | v is 1 − v; u is 1 − u; u and v exchanged |
//! | triangles shifted | their indices in an object start at another number |
//! | weights exchanged | barycentric u and v belong to other vertices |
//! | W inverted, or another number | W is 1/W; or W − 1, ln W, W² and the like (`ratios`) |
//! | W of another camera | W is that of a camera at rest, or moving in the opposite direction, or at another velocity |
//! | W by a factor | W is multiplied by γ of the camera or the object, or by 1/γ, or by another factor |
//! | emission time shifted | the time differs by a constant |
//! | times rounded | there are far fewer different times, all separated by multiples of one width |
//! | time lookup shifted | the light is that of the scene with its cubes, pulses and flashes earlier or later; needs the scene |
//! | colours exchanged | R, G, B are permuted |
//! | other primaries | linear light is converted to, or from, Rec. 2020 or Display P3 |
//! | gamma | light is encoded once too often, or once too few times |
//! | exponent of W wrong | ln(c/r) = a + k ln W, with a = 0 or an integer k; or the light is that of the scene with another quantity |
//! | codes for light | the candidate's light is integers |
//! | exposure | light is multiplied by one factor |
//! | offset | one number is added to all light (`curve`) |
//! | tone mapping | one curve, of each channel or of luminance, maps the reference's light to the candidate's (`curve`) |
//! | motion, by light | the light is that of the scene without retardation, with another aberration, or with an object at rest or reversed; needs the scene, and is tested if no channel shows it |
//! | film, or aberration, by light | the pictures match after a shift, scales, or a boost (`registration`) |
//! | shadows missing | the light is that of the scene whose pulses cast no shadows; needs the scene |
//! | size | the surfaces of an object are those of the reference scaled by a factor (`size`) |
//! | one object's channels, or light | if nothing explains the picture, the explanation of one object's pixels (`object`) |
//! | back faces | points of a known scene are on the right rays, but behind the surface that faces the camera (`backs`) |
//! | object elsewhere | points are on the right rays, but off the surface (`backs`); or by their events, points of an object are not on its surface, although nothing hides it; or they are in the frame of another velocity (`events`) |
//! | object missing | the reference shows it, the candidate does not |
//! | surfaces invented | the candidate shows objects where the reference shows nothing |
//! | look directions wrong | they are those of no other camera and no other axes (`looks`) |
//! | surfaces clipped | what the candidate lacks is nearer, or farther, than all that it shows (`holes`) |
//! | object misplaced | most of its points are not where they should be seen, and those of other objects are; nothing else explains it |
//! | triangle, or object displaced | δ is on one triangle, or one object, only: nine tenths of Σ\|δ\|², on at most half of the pixels of surfaces |
//! | channel wrong | its values are outside of the reference's around a pixel that shows the right point; nothing else explains it (`unlike`) |
//!
//! A hypothesis whose channels are missing is not tested. Consequences of a wrong film or a wrong velocity (time, brightness, positions)
//! are not diagnosed again.

mod backs;
mod camera;
mod channels;
mod constant;
mod curve;
mod depth;
mod displacement;
mod events;
mod film;
mod fitted;
mod frames;
mod holes;
mod light;
mod looks;
pub(super) mod mixed;
mod motion;
mod normals;
mod object;
mod part;
mod ratios;
mod registration;
mod rendered;
mod scene_light;
mod size;
mod stereo;
mod time;
mod turns;
mod unlike;

use std::cmp::Ordering;
use std::sync::OnceLock;

use rayon::prelude::*;
use serde::Serialize;

use super::geometry::Field;
use super::known::KnownScene;
use super::options::Region;
use super::picture::Picture;
use super::points::{Points, around};
use crate::error::Message;
use crate::scene::model::Scene;

/// The residual of the squared error of light below which the scene is not tested: noise of one percent beside a third of the light.
const SETTLED: f64 = 1e-3;
/// The fraction of an error that a hypothesis must explain, and of the pixels where it must.
const MOST: f64 = 0.9;
/// The fraction of their error to which a hypothesis must bring values.
const NEAR: f64 = 0.1;

/// A mistake of a candidate, with its evidence.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Diagnosis {
    /// The hypothesis.
    pub kind: Kind,
    /// The mistake as a sentence.
    pub what: Message,
    /// Names and values of the evidence.
    pub evidence: Vec<(&'static str, f64)>,
}

/// The possible diagnoses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Kind {
    /// The picture is mirrored or rotated.
    Mirrored,
    /// The picture is shifted, by whole or fractional pixels.
    FilmShifted,
    /// The field of view, or the focal length, is wrong.
    FieldOfView,
    /// Pixels are not square.
    Aspect,
    /// Indices count from 1.
    IdentitiesOneBased,
    /// Objects have each other's indices.
    IdentitiesSwapped,
    /// Look directions are boosted with the opposite velocity.
    AberrationReversed,
    /// Look directions are those of the camera's frame.
    AberrationMissing,
    /// The camera's boost lacks γ.
    AberrationWithoutGamma,
    /// The camera has another velocity.
    CameraVelocity,
    /// The camera looks in another direction, or is rolled.
    CameraTurned,
    /// The picture shows the camera at another time.
    CameraTime,
    /// The camera is at another place.
    CameraElsewhere,
    /// The pictures of the two eyes are exchanged.
    EyesExchanged,
    /// Both eyes have the same picture.
    EyesAlike,
    /// According to their metadata, the pictures are different shots.
    ShotsDiffer,
    /// Light takes no time.
    RetardationMissing,
    /// Objects are shown where light would arrive from later.
    RetardationReversed,
    /// Two objects have each other's velocity.
    VelocitiesSwapped,
    /// An object has another velocity.
    VelocityWrong,
    /// An object that should move is at rest.
    VelocityMissing,
    /// Moving objects are as long as at rest: the matrices of their boosts lack γ.
    ContractionMissing,
    /// The candidate does not show an object.
    ObjectMissing,
    /// Coordinates are permuted, or negated.
    AxesExchanged,
    /// Look directions point into the camera.
    DirectionsReversed,
    /// Lengths or times are in another unit.
    Units,
    /// Events or directions are in the coordinates of another frame.
    FrameWrong,
    /// Times have the opposite sign.
    SignOpposite,
    /// Indices of triangles do not start at 0.
    IdentitiesShifted,
    /// Barycentric coordinates are the weights of other vertices.
    WeightsExchanged,
    /// Texture coordinates run in the opposite direction.
    TextureFlipped,
    /// Wavelength ratios are inverted.
    RatioInverted,
    /// The channel holds another measure of the Doppler shift than the wavelength ratio.
    RatioForm,
    /// Wavelength ratios are those of a camera with another velocity.
    RatioOfCamera,
    /// Wavelength ratios are wrong by a factor.
    RatioFactor,
    /// Emission times are shifted by a constant.
    TimeShifted,
    /// Times are rounded to whole bins.
    TimesRounded,
    /// Light is looked up at shifted times.
    LookupShifted,
    /// Red, green and blue are exchanged.
    ColoursExchanged,
    /// Red, green and blue are those of another colour space.
    Primaries,
    /// Light is encoded for a display once more, or once less, than it should be.
    Gamma,
    /// The radiance factor has a wrong exponent.
    ExponentWrong,
    /// Light is multiplied by a factor.
    Exposure,
    /// A number is added to light.
    Offset,
    /// Channels hold NaN where they should hold numbers.
    NotANumber,
    /// Channels hold the same number at every pixel.
    ConstantChannel,
    /// Light passes through objects that should block it.
    ShadowsMissing,
    /// A tone curve for displays was applied to light.
    ToneMapped,
    /// Light is clipped at a value.
    Clipped,
    /// A lamp or a pulse is at another place.
    LightElsewhere,
    /// Depths are used instead of distances, or delay light.
    DepthForDistance,
    /// Surfaces nearer, or farther, than a plane or sphere are not shown.
    SurfacesClipped,
    /// Nothing is shown at places where the reference shows surfaces.
    SurfacesMissing,
    /// Surfaces are shown where the reference shows none.
    SurfacesInvented,
    /// An object is larger or smaller than it should be.
    SizeWrong,
    /// One triangle is displaced.
    TriangleDisplaced,
    /// One object is displaced.
    ObjectDisplaced,
    /// The side of an object is shown that its front should hide.
    BackFaces,
    /// The points shown of an object are not on its surface in the reference.
    ObjectElsewhere,
    /// A channel is wrong where the right points are shown.
    ChannelWrong,
}

impl Kind {
    /// Whether it moves or renames everything in view: objects may be out of view as a result.
    fn is_of_all(self) -> bool {
        matches!(
            self,
            Kind::Mirrored
                | Kind::FilmShifted
                | Kind::FieldOfView
                | Kind::Aspect
                | Kind::IdentitiesOneBased
                | Kind::IdentitiesSwapped
                | Kind::AberrationReversed
                | Kind::AberrationMissing
                | Kind::AberrationWithoutGamma
                | Kind::CameraVelocity
                | Kind::CameraTurned
                | Kind::CameraTime
                | Kind::CameraElsewhere
                | Kind::EyesExchanged
                | Kind::EyesAlike
                | Kind::ShotsDiffer
                | Kind::RetardationMissing
                | Kind::RetardationReversed
                | Kind::ContractionMissing
                | Kind::SurfacesClipped
        )
    }

    /// Whether it concerns single channels, whatever else is wrong.
    fn is_of_channel(self) -> bool {
        matches!(
            self,
            Kind::AxesExchanged
                | Kind::DirectionsReversed
                | Kind::Units
                | Kind::FrameWrong
                | Kind::SignOpposite
                | Kind::RatioInverted
                | Kind::RatioForm
                | Kind::TimesRounded
        )
    }

    /// Whether it concerns the camera's motion, or the time of the shot.
    fn is_of_shot(self) -> bool {
        matches!(
            self,
            Kind::AberrationReversed
                | Kind::AberrationMissing
                | Kind::AberrationWithoutGamma
                | Kind::CameraVelocity
                | Kind::CameraTime
                | Kind::RatioOfCamera
        )
    }
}

/// The input of the hypotheses.
#[derive(Debug, Clone, Copy)]
pub(super) struct Case<'a> {
    pub pair: [&'a Picture; 2],
    pub points: [Points<'a>; 2],
    pub region: &'a Region,
    /// Width of a time bin, metres of light path.
    pub bin_width: Option<f64>,
    pub known: Option<&'a KnownScene>,
    pub field: Option<&'a Field<'a>>,
    /// For each pixel, whether its points may be means over several surfaces; empty if there are none.
    pub mixed: &'a [bool],
    /// The scene with all its files.
    pub scene: Option<&'a Scene>,
    /// Of this case only.
    pub lists: &'a PixelLists,
}

/// The pixels that hypotheses are tested on, and whether objects are elsewhere in them, once they are asked for.
#[derive(Debug, Default)]
pub(super) struct PixelLists {
    all: OnceLock<Vec<usize>>,
    same: OnceLock<Vec<usize>>,
    unmixed: OnceLock<Vec<usize>>,
    is_elsewhere: OnceLock<bool>,
}

/// All diagnoses of a candidate: channels that were never written, and the results of the others.
pub(super) fn diagnose(case: &Case) -> Vec<Diagnosis> {
    stereo::of_eyes(case)
        .or_else(|| constant::set_apart(case))
        .unwrap_or_else(|| diagnose_channels(case))
}

/// Mistakes by channels, none of which is constant.
fn diagnose_channels(case: &Case) -> Vec<Diagnosis> {
    let other = camera::other_shot(case);
    let mut found = causes(case, other.is_some());
    // If it is another shot, that is the mistake: objects, light and films follow from it.
    if let Some(other) = other {
        found.retain(|found| found.kind.is_of_shot());
        if found.is_empty() {
            found.push(other);
        }
    }
    if !found.iter().any(|found| found.kind.is_of_all()) {
        let mut gone = part::vanished(case);
        if found.iter().any(|d| d.kind == Kind::VelocitiesSwapped) {
            let mut exchanged = motion::gone_by_exchange(case);
            exchanged.extend(events::gone_by_exchange(case));
            gone.retain(|(object, _)| !exchanged.contains(object));
        }
        // What is missing casts no shadow.
        found.retain(|found| gone.is_empty() || found.kind != Kind::ShadowsMissing);
        let missing: Vec<usize> = gone.iter().map(|(object, _)| *object).collect();
        match motion::advanced_out_of_view(case, &found, &missing) {
            Some(advanced) => found = vec![advanced],
            None => found.extend(gone.into_iter().map(|(_, found)| found)),
        }
    }
    if found.is_empty() {
        found.extend(holes::found(case));
    }
    if found.is_empty() {
        found.extend(part::invented(case));
    }
    if found.is_empty() {
        found.extend(looks::unexplained(case));
    }
    if found.is_empty() {
        found.extend(object::single(case));
    }
    if found.is_empty() {
        found.extend(unlike::channels(case));
    }
    found
}

/// Explanations of the errors of pixels; light, which follows from everything else, is not looked at if the metadata state another shot.
fn causes(case: &Case, is_other_shot: bool) -> Vec<Diagnosis> {
    let causes: [fn(&Case) -> Vec<Diagnosis>; 19] = [
        |case| channels::order_of_events(case).into_iter().collect(),
        // Before cameras, whose places of points depend on indices. Mirrored pictures may show other objects, too.
        |case| {
            let renamed = channels::identities(case).filter(|_| turns::turned(case).is_none());
            renamed.into_iter().collect()
        },
        |case| looks::camera(case).into_iter().collect(),
        |case| camera::another(case).into_iter().collect(),
        |case| turns::turned(case).into_iter().collect(),
        |case| channels::identities(case).into_iter().collect(),
        |case| film::mirrored(case).into_iter().collect(),
        channels::coordinates,
        |case| time::rounded(case).into_iter().collect(),
        |case| ratios::forms(case).into_iter().collect(),
        motion::velocities,
        motion::changes,
        |case| film::scaled(case).into_iter().collect(),
        depth::depths,
        object::units,
        size::wrong,
        backs::shown,
        events::elsewhere,
        backs::off_surface,
    ];
    if let Some(found) = causes
        .iter()
        .map(|cause| cause(case))
        .find(|found| !found.is_empty())
    {
        return with_independent(case, found);
    }
    if is_other_shot {
        return ratios::ratio(case).into_iter().collect();
    }
    let mut found: Vec<Diagnosis> = channels::texture(case).into_iter().collect();
    found.extend(frames::beginnings(case));
    found.extend(frames::weights(case));
    found.extend(ratios::ratio(case));
    found.extend(time::instant(case).or_else(|| time::shifted(case)));
    // Light of points that are not where they should be seen does not say why.
    let misplaced = match found.is_empty() {
        true => part::misplaced(case),
        false => Vec::new(),
    };
    if !misplaced.is_empty() {
        return part::displaced(case).map_or(misplaced, |found| vec![found]);
    }
    let by_light = curve::instead_of(case, light::light(case));
    // Another velocity changes light much as another exponent does, or, if it is far darker, as a factor does; the scene distinguishes
    // them.
    let is_settled = !case.shows_objects_elsewhere()
        && by_light
            .as_ref()
            .is_some_and(|(d, left)| d.kind != Kind::ExponentWrong && *left <= SETTLED);
    let by_scene = if is_settled {
        rendered::Verdict::Nothing
    } else {
        rendered::changes(case)
    };
    let scene_was_tested = !matches!(by_scene, rendered::Verdict::Nothing);
    let by_scene = match by_scene {
        rendered::Verdict::Mistake(found, left) => Some((found, left)),
        rendered::Verdict::Nothing | rendered::Verdict::NoMistake => None,
    };
    let of_light = by_light.as_ref().map(|(_, left)| *left);
    if found.is_empty()
        && by_scene.is_none()
        && of_light.is_none_or(|left| left > NEAR)
        && let Some((turned, left)) = turns::turned_by_light(case)
        && of_light.is_none_or(|of_light| left < of_light)
    {
        return vec![turned];
    }
    match (by_scene, by_light) {
        (Some((by_scene, of_scene)), Some((by_light, left))) => {
            let is_simple = by_light.kind != Kind::ExponentWrong
                && left <= of_scene
                && !case.shows_objects_elsewhere();
            found.push(if is_simple { by_light } else { by_scene });
        }
        (Some((by_scene, _)), None) => found.push(by_scene),
        (None, Some((by_light, left))) => {
            // Another film also changes light at edges.
            let may_be_film = left > NEAR && found.is_empty() && !case.has_places();
            let by_film = may_be_film
                .then(|| registration::found(case, scene_was_tested))
                .flatten();
            let by_film = by_film.filter(|(_, of_film)| *of_film < left);
            found.push(by_film.map_or(by_light, |(by_film, _)| by_film));
        }
        (None, None) if found.is_empty() && !case.has_places() => {
            found.extend(registration::found(case, scene_was_tested).map(|(by_film, _)| by_film));
        }
        (None, None) => {}
    }
    if found.is_empty() {
        found.extend(part::displaced(case));
    }
    found
}

/// The diagnoses of channels, with those of light and wavelength ratios that do not depend on them.
fn with_independent(case: &Case, mut found: Vec<Diagnosis>) -> Vec<Diagnosis> {
    if !found.iter().all(|found| found.kind.is_of_channel()) {
        return found;
    }
    let is_of_ratio =
        |found: &Diagnosis| matches!(found.kind, Kind::RatioInverted | Kind::RatioForm);
    if !found.iter().any(is_of_ratio) {
        found.extend(ratios::forms(case));
    }
    found.extend(light::light(case).map(|(found, _)| found));
    found
}

/// The metadata that only stereo pairs have.
const PUPIL_DISTANCE: &str = "camera_interpupillary_distance";

impl Case<'_> {
    /// Whether the reference is a stereo pair with halves of equal size.
    fn is_stereo_pair(&self) -> bool {
        let width = self.pair[0].layers.width;
        self.pair[0].metadata(PUPIL_DISTANCE).is_some() && width >= 2 && width.is_multiple_of(2)
    }

    /// Whether channels show which points pixels show, or where they look: then light is not needed.
    fn has_places(&self) -> bool {
        let directions = self.points.each_ref().map(|p| p.direction.is_some());
        self.field.is_some() || directions == [true, true]
    }

    /// Whether the points at a pixel may be means over several surfaces.
    fn is_mixed(&self, i: usize) -> bool {
        self.mixed.get(i) == Some(&true)
    }

    /// Whether the candidate shows objects where the reference shows them neither there nor beside, at a notable part of its surfaces:
    /// farther than samples elsewhere in pixels do. Their light differs, whatever its own mistakes are.
    fn shows_objects_elsewhere(&self) -> bool {
        let [r, c] = &self.points;
        let (Some(_), Some(_)) = (r.object, c.object) else {
            return false;
        };
        let count = || {
            let pixels = self.everywhere().par_iter().copied();
            let shown = pixels.filter(|i| r.object_at(*i).is_some_and(|id| id >= 0.0));
            let counts = shown.map(|i| {
                let id = c.object_at(i);
                [
                    1,
                    usize::from(around(r.size(), i).all(|j| r.object_at(j) != id)),
                ]
            });
            counts.reduce(|| [0; 2], |[a, b], [c, d]| [a + c, b + d])
        };
        *self.lists.is_elsewhere.get_or_init(|| {
            let [shown, elsewhere] = count();
            elsewhere >= FEWEST && elsewhere as f64 >= NOTABLE_ELSEWHERE * shown as f64
        })
    }

    /// All pixels of the region.
    fn everywhere(&self) -> &[usize] {
        let all = || self.region.pixels(self.points[0].size()).collect();
        self.lists.all.get_or_init(all)
    }

    /// Those where both pictures show the same object.
    fn of_same_object(&self) -> &[usize] {
        let [r, c] = &self.points;
        let same = || {
            let pixels = self.region.pixels(r.size());
            pixels.filter(|i| r.same_object(c, *i)).collect()
        };
        // Without such channels it is the same everywhere.
        match (r.object, c.object) {
            (Some(_), Some(_)) => self.lists.same.get_or_init(same),
            _ => self.everywhere(),
        }
    }

    /// Those of them whose channels are not means over several surfaces.
    fn pixels(&self) -> &[usize] {
        let unmixed = || {
            let all = self.of_same_object().iter().copied();
            all.filter(|i| !self.is_mixed(*i)).collect()
        };
        match self.mixed.is_empty() {
            true => self.of_same_object(),
            false => self.lists.unmixed.get_or_init(unmixed),
        }
    }
}

/// The least part of the reference's surfaces at which objects are notably elsewhere.
const NOTABLE_ELSEWHERE: f64 = 0.01;

/// The number of pixels that are asked first whether a hypothesis may explain all of them.
const ASKED: usize = 8192;
/// Fewer of them with an error decide nothing; otherwise a hypothesis must explain this fraction of them. If it explains nine tenths of
/// all, the chance that it explains less than seven tenths of 200 is below 10⁻¹⁵.
const FEWEST_ASKED: usize = 200;
const PROMISING: f64 = 0.7;

/// At most `most` of `count` places, from all over: multiples of the golden ratio, modulo 1, which no rows or columns follow.
fn spread(count: usize, most: usize) -> impl Iterator<Item = usize> {
    // 2⁶⁴ times the golden ratio's fraction.
    const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
    let is_whole = count <= most;
    (0..count.min(most)).map(move |k| match is_whole {
        true => k,
        false => {
            let part = (k as u64).wrapping_mul(GOLDEN);
            ((u128::from(part) * count as u128) >> 64) as usize
        }
    })
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    let inside = middle < values.len();
    inside.then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// `all` without the tenth that is farthest off, in their order; of those equally far off the first are kept.
fn without_worst<T: Copy + Sync>(all: &[T], off: impl Fn(&T) -> f64 + Sync) -> Vec<T> {
    let kept = (MOST * all.len() as f64).ceil() as usize;
    if kept >= all.len() {
        return all.to_vec();
    }
    let off: Vec<f64> = all.par_iter().map(&off).collect();
    let mut parted = off.clone();
    let (nearer, limit, _) = parted.select_nth_unstable_by(kept, f64::total_cmp);
    let mut at_limit = nearer
        .iter()
        .filter(|off| off.total_cmp(limit).is_eq())
        .count();
    let is_kept = |off: f64| match off.total_cmp(limit) {
        Ordering::Less => true,
        Ordering::Greater => false,
        Ordering::Equal => {
            let is_kept = at_limit > 0;
            at_limit -= usize::from(is_kept);
            is_kept
        }
    };
    let is_kept: Vec<bool> = off.into_iter().map(is_kept).collect();
    let kept = all.iter().zip(is_kept).filter(|(_, is_kept)| *is_kept);
    kept.map(|(one, _)| *one).collect()
}

/// Distances from the reference and from a hypothesis at each pixel.
#[derive(Debug)]
struct Tally {
    /// |c − r|, and |c − h(r)|, where either is notable.
    distances: Vec<[f64; 2]>,
    /// The rms of |c − r| over all pixels, including those that are left out.
    usual: f64,
}

/// The fewest pixels for a hypothesis.
const FEWEST: usize = 24;

impl Tally {
    /// The finite pairs, without the pixels where neither is a tenth of the error: where nothing is wrong, and the hypothesis changes
    /// nothing, it explains nothing. A hypothesis that changes nothing explains no pixel: of the pairs kept, it matches where the
    /// hypothesis does not.
    fn of(distances: impl ParallelIterator<Item = [f64; 2]>) -> Tally {
        let are_numbers = |[a, b]: &[f64; 2]| a.is_finite() && b.is_finite();
        let mut tally = Tally {
            distances: distances.filter(are_numbers).collect(),
            usual: 0.0,
        };
        tally.usual = tally.error();
        let least = NEAR * tally.usual;
        tally.distances.retain(|[a, b]| a.max(*b) > least);
        tally
    }

    /// The distances at these pixels. If a hypothesis that explains too little of some of them cannot explain all, it is the tally of the
    /// former, which explains nothing either.
    fn of_pixels(pixels: &[usize], distances: impl Fn(usize) -> Option<[f64; 2]> + Sync) -> Tally {
        let unpromising = Tally::of_some(pixels, &distances);
        unpromising.unwrap_or_else(|| Tally::of_all(pixels, distances))
    }

    /// The distances at some of these pixels, if a hypothesis explains so little of them that it cannot explain all.
    fn of_some(
        pixels: &[usize],
        distances: impl Fn(usize) -> Option<[f64; 2]> + Sync,
    ) -> Option<Tally> {
        (pixels.len() > ASKED).then_some(())?;
        let few: Vec<usize> = spread(pixels.len(), ASKED).map(|at| pixels[at]).collect();
        let few = Tally::of_all(&few, distances);
        (few.distances.len() >= FEWEST_ASKED && few.share() < PROMISING).then_some(few)
    }

    /// The distances at all of these pixels.
    fn of_all(pixels: &[usize], distances: impl Fn(usize) -> Option<[f64; 2]> + Sync) -> Tally {
        Tally::of(pixels.par_iter().filter_map(|i| distances(*i)))
    }

    /// The rms distance from the reference.
    fn error(&self) -> f64 {
        let sum: f64 = self.distances.iter().map(|d| d[0] * d[0]).sum();
        (sum / self.distances.len().max(1) as f64).sqrt()
    }

    /// The rms distance from the hypothesis, without the tenth of the pixels where it is largest.
    fn rest(&self) -> f64 {
        let mut rests: Vec<f64> = self.distances.iter().map(|d| d[1]).collect();
        let kept = (MOST * rests.len() as f64).ceil() as usize;
        if kept < rests.len() {
            rests.select_nth_unstable_by(kept, f64::total_cmp);
        }
        let sum: f64 = rests[..kept].iter().map(|x| x * x).sum();
        (sum / kept.max(1) as f64).sqrt()
    }

    /// The fraction of the pixels that the hypothesis explains.
    fn share(&self) -> f64 {
        let explained = |d: &&[f64; 2]| d[1] <= NEAR * d[0].max(self.usual);
        let count = self.distances.iter().filter(explained).count();
        count as f64 / self.distances.len().max(1) as f64
    }

    /// Whether the hypothesis explains more pixels than another one, or as many with a smaller residual.
    fn is_better_than(&self, other: &Tally) -> bool {
        let by_share = self.share().total_cmp(&other.share());
        by_share.then(other.rest().total_cmp(&self.rest())).is_gt()
    }

    /// Whether the hypothesis explains an error of at least `notable` rms.
    fn explains(&self, notable: f64) -> bool {
        self.distances.len() >= FEWEST && self.error() > notable && self.share() >= MOST
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn some_pixels_decide_about_a_hypothesis_as_all_do() {
        let pixels: Vec<usize> = (0..200_000).collect();
        // It explains this many of twenty pixels.
        for explained in [0, 10, 13, 17, 18, 19, 20] {
            let distances = |i: usize| {
                let is_explained = i % 20 < explained;
                Some([1.0, if is_explained { 0.0 } else { 1.0 }])
            };
            let all = Tally::of_all(&pixels, distances);
            let asked = Tally::of_pixels(&pixels, distances);
            assert_eq!(all.explains(0.5), explained >= 18);
            assert_eq!(asked.explains(0.5), all.explains(0.5), "{explained}");
            // Few are enough to exclude it, and only they are looked at.
            let looked_at = if explained <= 13 { ASKED } else { pixels.len() };
            assert_eq!(asked.distances.len(), looked_at, "{explained}");
        }
    }

    #[test]
    fn the_worst_tenth_is_left_out_and_of_equals_the_last() {
        let off = |x: &f64| x.abs();
        let varied: Vec<f64> = (0..100).map(|k| f64::from(k * 37 % 100)).collect();
        let kept = without_worst(&varied, off);
        let expected = varied.iter().copied().filter(|x| *x < 90.0);
        assert!(kept.iter().copied().eq(expected));
        // Which signs are left tells which of the equals were kept.
        let equal: Vec<f64> = (0..100).map(|k| if k < 90 { 1.0 } else { -1.0 }).collect();
        assert_eq!(without_worst(&equal, off), vec![1.0; 90]);
        let one_better: Vec<f64> = equal.iter().copied().chain([0.5; 1]).collect();
        let kept = without_worst(&one_better, off);
        assert_eq!((kept.len(), kept.last()), (91, Some(&0.5)));
        assert_eq!(without_worst(&[2.0], off), [2.0]);
    }

    #[test]
    fn places_from_all_over_are_different_and_in_all_rows_and_columns_alike() {
        for width in [640, 1024, 1920] {
            let count = width * width * 9 / 16;
            let places: BTreeSet<usize> = spread(count, ASKED).collect();
            assert_eq!(places.len(), ASKED);
            // An eighth of the rows, and of the columns.
            for part in 0..8 {
                let rows = places.iter().filter(|i| **i * 8 / count == part);
                let columns = places.iter().filter(|i| **i % width * 8 / width == part);
                for found in [rows.count(), columns.count()] {
                    assert!(
                        found.abs_diff(ASKED / 8) < ASKED / 80,
                        "{width}, {part}: {found}"
                    );
                }
            }
        }
        assert!(spread(5, ASKED).eq(0..5));
    }
}
