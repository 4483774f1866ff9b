//! Why a candidate is wrong: hypotheses that explain most of an error, with their evidence.
//!
//! A hypothesis h(r) of what a picture holds instead of the reference's r explains the error where |c − h(r)| is below a
//! tenth of |c − r|, or of that error's root mean square, at nine tenths of the pixels at which either is not small. Those without free numbers are
//! asked first, the others only where these do not explain it.
//!
//! | diagnosis | hypothesis |
//! |---|---|
//! | picture mirrored | the candidate turned around is the reference: left to right, top to bottom, both, or across its diagonal |
//! | picture moved by whole pixels | the same for a shift by one or two pixels |
//! | channels never written | the candidate's hold one number at every pixel, and the reference's do not (`constant`) |
//! | identities wrong | the objects' (or triangles') indices count from 1; or are those of other objects |
//! | aberration reversed, missing, or without γ | look directions, or places of a known scene, are those for −β, for 0, or of a boost that lacks γ (`looks`) |
//! | camera at another velocity, or turned | look directions are those of another boost, or of a rotation before it (`looks`); points of a known scene are where such a camera sees them (`camera`) |
//! | camera at another time | points of a known scene are where a camera sees them whose clock is ahead (`camera`) |
//! | shots that differ | the metadata of both pictures say another velocity or time of the camera: then nothing is said of what follows |
//! | retardation missing | all emission times are the same; or points of a known scene, or of one object, are where they are at the time of the shot |
//! | velocities swapped, reversed, missing, wrong | by wavelength ratios, or by places of a known scene (`motion`) |
//! | film moved or scaled | points belong at a + k p for the pixel p: half a pixel, another field of view or focal length, another aspect ratio |
//! | axes exchanged | x, y, z of events, normals, directions are others of these, or their opposites |
//! | directions reversed | d is −d |
//! | frame wrong | events are those of the objects' or the camera's frame, or relative to the shot; directions have the camera's axes |
//! | normals of another frame | normals are those of the contracted or of the apparent body, or along the camera's axes, or of the file (`normals`) |
//! | depth for distance | the distance is the depth along the axis, or one over it, or the way in the camera's frame; times are delayed by it (`depth`) |
//! | sign opposite | times are −t |
//! | units | lengths, or times, are multiplied by one factor: mm, cm, km, s, ns |
//! | texture coordinates flipped | v is 1 − v; u is 1 − u; u and v exchanged |
//! | triangles shifted | in an object, their indices begin at another number |
//! | weights exchanged | barycentric u and v belong to other corners |
//! | W inverted, or another number | W is 1/W; or W − 1, ln W, W² and the like (`ratios`) |
//! | W of another camera | W is that of a camera at rest, or that moves the opposite way, or at another velocity |
//! | W by a factor | W is multiplied by γ of the camera or the object, or by 1/γ, or by another factor |
//! | emission time shifted | the time differs by a constant |
//! | times rounded | times are far fewer numbers, all of them steps of one width apart |
//! | time lookup shifted | the light is that of the scene with its cubes, pulses and flashes earlier or later; needs the scene |
//! | colours exchanged | R, G, B are others of these |
//! | gamma | light is encoded once more than it should be, or once less |
//! | exponent of W wrong | ln(c/r) = a + k ln W, with a = 0 or k a whole number |
//! | codes for light | the candidate's light is whole numbers |
//! | exposure | light is multiplied by one factor |
//! | offset | one number is added to all light (`curve`) |
//! | tone mapping | one curve, of each channel or of luminance, makes the candidate's light of the reference's (`curve`) |
//! | motion, by light | the light is that of the scene without retardation, with another aberration, or with an object at rest or reversed; needs the scene, where no channel says so |
//! | film, or aberration, by light | the pictures lie over each other after a shift, scales, or a boost (`registration`) |
//! | shadows missing | the light is that of the scene whose pulses throw no shadows; needs the scene |
//! | size | the surfaces of an object are those of the reference times a factor (`size`) |
//! | one object's channels, or light | where nothing explains the picture, what explains the pixels of one object (`object`) |
//! | object elsewhere | by their events, points of an object are not on its surface, where nothing hides it; or they are in the frame of another velocity (`events`) |
//! | object missing | the reference shows it, the candidate nowhere |
//! | object misplaced | most of its points are not where they are seen, and others are; nothing else explains it |
//! | triangle, or object displaced | δ on one triangle, or one object, alone: nine tenths of Σ\|δ\|², on at most half of the pixels of surfaces |
//!
//! A hypothesis without the channels that it needs is not asked. What follows from a wrong film or a wrong velocity (time,
//! brightness, places) is not diagnosed again.

mod camera;
mod channels;
mod constant;
mod curve;
mod depth;
mod events;
mod film;
mod frames;
mod light;
mod looks;
mod motion;
mod normals;
mod object;
mod part;
mod ratios;
mod registration;
mod rendered;
mod size;
mod time;

use serde::Serialize;

use super::geometry::Field;
use super::known::KnownScene;
use super::options::Region;
use super::picture::Picture;
use super::points::Points;
use crate::error::Message;
use crate::scene::model::Scene;

/// What explains light up to this part of its squared error, noise of a hundredth beside a third of it, leaves nothing to ask the scene for.
const SETTLED: f64 = 1e-3;
/// The part of an error that a hypothesis has to explain, and of the pixels at which it does.
const MOST: f64 = 0.9;
/// A hypothesis has to bring values nearer than this part of their error.
const NEAR: f64 = 0.1;

/// What is wrong with a candidate, and how one sees it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Diagnosis {
    /// Which hypothesis.
    pub kind: Kind,
    /// What is wrong, as a sentence.
    pub what: Message,
    /// Names and values of the evidence.
    pub evidence: Vec<(&'static str, f64)>,
}

/// What can be diagnosed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Kind {
    /// The picture is mirrored or turned.
    Mirrored,
    /// The picture is shifted, by whole pixels or parts of them.
    FilmShifted,
    /// The field of view, or the focal length, is another.
    FieldOfView,
    /// Width and height of pixels are not alike.
    Aspect,
    /// Indices count from 1.
    IdentitiesOneBased,
    /// Objects have each other's indices.
    IdentitiesSwapped,
    /// Look directions are boosted with the opposite velocity.
    AberrationReversed,
    /// Look directions are those of the camera's frame.
    AberrationMissing,
    /// The camera's boost lacks its γ.
    AberrationWithoutGamma,
    /// The camera has another velocity.
    CameraVelocity,
    /// The camera looks along another axis, or is rolled.
    CameraTurned,
    /// The picture is that of another time of the camera.
    CameraTime,
    /// By their metadata, the pictures are of different shots.
    ShotsDiffer,
    /// Light takes no time.
    RetardationMissing,
    /// Two objects have each other's velocity.
    VelocitiesSwapped,
    /// An object has another velocity.
    VelocityWrong,
    /// An object rests that should move.
    VelocityMissing,
    /// An object is nowhere in the candidate.
    ObjectMissing,
    /// Coordinates are exchanged, or have the opposite sign.
    AxesExchanged,
    /// Look directions point into the camera.
    DirectionsReversed,
    /// Lengths or times have another unit.
    Units,
    /// Events or directions are in the coordinates of another frame.
    FrameWrong,
    /// Times have the opposite sign.
    SignOpposite,
    /// Indices of triangles begin at another number than 0.
    IdentitiesShifted,
    /// Barycentric coordinates are the weights of other corners.
    WeightsExchanged,
    /// Texture coordinates run the other way.
    TextureFlipped,
    /// Wavelength ratios are their inverses.
    RatioInverted,
    /// The channel holds another number of the Doppler shift than the wavelength ratio.
    RatioForm,
    /// Wavelength ratios are those of a camera of another velocity.
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
    /// Light is encoded for a display once more, or once less, than it should be.
    Gamma,
    /// The radiance factor has another exponent.
    ExponentWrong,
    /// Light is multiplied by a factor.
    Exposure,
    /// A number is added to light.
    Offset,
    /// Channels have no numbers where they should.
    NotANumber,
    /// Channels hold the same number at every pixel.
    ConstantChannel,
    /// Light comes through what should hide it.
    ShadowsMissing,
    /// Light went through a curve for displays.
    ToneMapped,
    /// Depths stand where distances should, or delay light.
    DepthForDistance,
    /// An object is larger or smaller than it should be.
    SizeWrong,
    /// One triangle is displaced.
    TriangleDisplaced,
    /// One object is displaced.
    ObjectDisplaced,
    /// The points shown of an object are not on the surface that the reference shows.
    ObjectElsewhere,
    /// Events in the world are not those of the points of objects beside them.
    EventsWrong,
}

impl Kind {
    /// Whether it moves or renames all that is seen: objects may be out of view for it.
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
                | Kind::ShotsDiffer
                | Kind::RetardationMissing
        )
    }

    /// Whether it is of single channels, whatever else is wrong.
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

    /// Whether it says how the camera moves, or when the shot is taken.
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

/// What the hypotheses are asked of.
#[derive(Debug, Clone, Copy)]
pub(super) struct Case<'a> {
    pub pair: [&'a Picture; 2],
    pub points: [Points<'a>; 2],
    pub region: &'a Region,
    /// Width of a time bin, metres of light path.
    pub bin_width: Option<f64>,
    pub known: Option<&'a KnownScene>,
    pub field: Option<&'a Field<'a>>,
    /// The scene with all its files.
    pub scene: Option<&'a Scene>,
}

/// All diagnoses of a candidate: channels that were never written, and what the others say.
pub(super) fn diagnose(case: &Case) -> Vec<Diagnosis> {
    constant::set_apart(case).unwrap_or_else(|| diagnose_channels(case))
}

/// What is wrong by channels, all of which hold several numbers.
fn diagnose_channels(case: &Case) -> Vec<Diagnosis> {
    let mut found = causes(case);
    // Of another shot, that is what is wrong: objects, light and films follow from it.
    if let Some(other) = camera::other_shot(case) {
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
        found.extend(gone.into_iter().map(|(_, found)| found));
    }
    if found.is_empty() {
        found.extend(object::single(case));
    }
    found
}

/// What explains the errors of pixels.
fn causes(case: &Case) -> Vec<Diagnosis> {
    let causes: [fn(&Case) -> Vec<Diagnosis>; 15] = [
        |case| channels::order_of_events(case).into_iter().collect(),
        |case| looks::camera(case).into_iter().collect(),
        |case| camera::another(case).into_iter().collect(),
        |case| film::turned(case).into_iter().collect(),
        |case| channels::identities(case).into_iter().collect(),
        channels::coordinates,
        |case| time::rounded(case).into_iter().collect(),
        |case| ratios::forms(case).into_iter().collect(),
        motion::velocities,
        motion::changes,
        |case| film::scaled(case).into_iter().collect(),
        depth::depths,
        object::units,
        size::wrong,
        events::elsewhere,
    ];
    if let Some(found) = causes
        .iter()
        .map(|cause| cause(case))
        .find(|found| !found.is_empty())
    {
        return with_independent(case, found);
    }
    let mut found: Vec<Diagnosis> = channels::texture(case).into_iter().collect();
    found.extend(frames::beginnings(case));
    found.extend(frames::weights(case));
    found.extend(ratios::ratio(case));
    found.extend(time::instant(case).or_else(|| time::shifted(case)));
    let by_light = curve::instead_of(case, light::light(case));
    // Another velocity changes light much as another exponent does, or as a factor on what is far darker, and the scene tells them apart.
    let is_settled = by_light
        .as_ref()
        .is_some_and(|(d, left)| d.kind != Kind::ExponentWrong && *left <= SETTLED);
    let by_scene = if is_settled {
        rendered::Asked::Nothing
    } else {
        rendered::changes(case)
    };
    let is_asked = !matches!(by_scene, rendered::Asked::Nothing);
    let by_scene = match by_scene {
        rendered::Asked::Mistake(found, left) => Some((found, left)),
        rendered::Asked::Nothing | rendered::Asked::NoMistake => None,
    };
    match (by_scene, by_light) {
        (Some((by_scene, of_scene)), Some((by_light, left))) => {
            let is_simple = by_light.kind != Kind::ExponentWrong && left <= of_scene;
            found.push(if is_simple { by_light } else { by_scene });
        }
        (Some((by_scene, _)), None) => found.push(by_scene),
        (None, Some((by_light, left))) => {
            // Another film changes light, too, at edges.
            let may_be_film = left > NEAR && found.is_empty() && !case.has_places();
            let by_film = may_be_film
                .then(|| registration::found(case, is_asked))
                .flatten();
            let by_film = by_film.filter(|(_, of_film)| *of_film < left);
            found.push(by_film.map_or(by_light, |(by_film, _)| by_film));
        }
        (None, None) if found.is_empty() && !case.has_places() => {
            found.extend(registration::found(case, is_asked).map(|(by_film, _)| by_film));
        }
        (None, None) => {}
    }
    if found.is_empty() {
        found.extend(part::displaced(case));
    }
    if found.is_empty() {
        found.extend(part::misplaced(case));
    }
    if found.is_empty() {
        found.extend(events::unlike_points(case));
    }
    found
}

/// What was found of channels, and what light and wavelength ratios say beside it: they do not depend on those.
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

impl Case<'_> {
    /// Whether channels say which points pixels show, or where they look: then light need not.
    fn has_places(&self) -> bool {
        let directions = self.points.each_ref().map(|p| p.direction.is_some());
        self.field.is_some() || directions == [true, true]
    }

    /// Pixels of the region at which both pictures show the same object.
    fn pixels(&self) -> Vec<usize> {
        let [r, c] = &self.points;
        let pixels = self.region.pixels(r.size());
        pixels.filter(|i| r.same_object(c, *i)).collect()
    }
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    let inside = middle < values.len();
    inside.then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Distances from the reference and from a hypothesis, pixel by pixel.
#[derive(Debug)]
struct Tally {
    /// |c − r|, and |c − h(r)|, where either is notable.
    distances: Vec<[f64; 2]>,
    /// The rms of |c − r| over all pixels, these and those that are left out.
    usual: f64,
}

/// A hypothesis needs so many pixels.
const FEWEST: usize = 24;

impl Tally {
    /// Of pairs, those that are numbers, without the pixels at which neither is a tenth of the error: where nothing is
    /// wrong, and the hypothesis changes nothing, it explains nothing. To change nothing explains no pixel: of those that are
    /// kept, it is near where the hypothesis is not.
    fn of(distances: impl Iterator<Item = [f64; 2]>) -> Tally {
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

    /// The rms distance from the reference.
    fn error(&self) -> f64 {
        let sum: f64 = self.distances.iter().map(|d| d[0] * d[0]).sum();
        (sum / self.distances.len().max(1) as f64).sqrt()
    }

    /// The rms distance from the hypothesis, without the tenth of the pixels at which it is largest.
    fn rest(&self) -> f64 {
        let mut rests: Vec<f64> = self.distances.iter().map(|d| d[1]).collect();
        rests.sort_unstable_by(f64::total_cmp);
        let kept = (MOST * rests.len() as f64).ceil() as usize;
        let sum: f64 = rests[..kept].iter().map(|x| x * x).sum();
        (sum / kept.max(1) as f64).sqrt()
    }

    /// The part of the pixels that the hypothesis explains.
    fn share(&self) -> f64 {
        let explained = |d: &&[f64; 2]| d[1] <= NEAR * d[0].max(self.usual);
        let count = self.distances.iter().filter(explained).count();
        count as f64 / self.distances.len().max(1) as f64
    }

    /// Whether the hypothesis explains more pixels than another one, or as many and these better.
    fn is_better_than(&self, other: &Tally) -> bool {
        let by_share = self.share().total_cmp(&other.share());
        by_share.then(other.rest().total_cmp(&self.rest())).is_gt()
    }

    /// Whether the hypothesis explains an error of at least `notable`, rms.
    fn explains(&self, notable: f64) -> bool {
        self.distances.len() >= FEWEST && self.error() > notable && self.share() >= MOST
    }
}
