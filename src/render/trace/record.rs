//! Auxiliary channels of a sample; compiled out where none are asked for.

use super::SurfacePoint;
use crate::render::aov::Aov;
use crate::render::film::TileFilm;
use crate::spacetime::{Direction, WavelengthRatio, World};

/// A surface point and the wavelength ratio with which the camera sees it.
#[derive(Debug)]
pub struct Seen<'a> {
    /// The point.
    pub point: SurfacePoint<'a>,
    /// Observed / emitted wavelength.
    pub w: WavelengthRatio,
}

/// Records auxiliary channels of one sample.
pub trait Recorder: Sync {
    /// Whether anything is recorded.
    const RECORDS: bool;

    /// Records what the sample at `offset` in `pixel` has seen along `d`.
    fn record(
        &self,
        pixel: usize,
        offset: [f64; 2],
        d: Direction<World>,
        seen: Option<&Seen>,
        film: &mut TileFilm,
    );
}

/// No channels.
#[derive(Debug, Clone, Copy)]
pub struct NoAovs;

impl Recorder for NoAovs {
    const RECORDS: bool = false;

    #[inline]
    fn record(
        &self,
        _: usize,
        _: [f64; 2],
        _: Direction<World>,
        _: Option<&Seen>,
        _: &mut TileFilm,
    ) {
    }
}

/// The listed channels.
#[derive(Debug, Clone)]
pub struct AovRecorder {
    /// Which, in the order of the film's channels.
    pub channels: Vec<Aov>,
}

impl Recorder for AovRecorder {
    const RECORDS: bool = true;

    fn record(
        &self,
        pixel: usize,
        offset: [f64; 2],
        d: Direction<World>,
        seen: Option<&Seen>,
        film: &mut TileFilm,
    ) {
        let nearest = film.is_nearest_to_centre(pixel, offset, seen.is_some());
        for (channel, aov) in self.channels.iter().enumerate() {
            let Some(value) = value(*aov, d, seen) else {
                continue;
            };
            if !aov.is_of_one_sample() {
                film.add_aov(channel, pixel, value);
            } else if nearest {
                film.set_aov(channel, pixel, value);
            }
        }
    }
}

/// The channel's value, or none where the sample has none. Coverage and standard error are the film's own.
fn value(aov: Aov, d: Direction<World>, seen: Option<&Seen>) -> Option<f64> {
    let d = d.unit();
    match aov {
        Aov::DirectionX => Some(d.x),
        Aov::DirectionY => Some(d.y),
        Aov::DirectionZ => Some(d.z),
        Aov::Coverage | Aov::StandardError => None,
        Aov::Object => Some(seen.map_or(-1.0, |s| s.point.patch.object as f64)),
        Aov::Primitive => Some(seen.map_or(-1.0, |s| s.point.primitive() as f64)),
        _ if aov.is_of_one_sample() => Some(seen.map_or(f64::NAN, |s| of_surface(aov, s))),
        _ => seen.map(|s| of_surface(aov, s)),
    }
}

fn of_surface(aov: Aov, seen: &Seen) -> f64 {
    let point = &seen.point;
    let hit = &point.hit;
    let uv = || point.uv(0).unwrap_or(glam::DVec2::NAN);
    let event = || point.event();
    let object_event = || point.rest_event() - point.patch.object_origin;
    let normal = || point.rest.bvh.normal(hit);
    match aov {
        Aov::BarycentricU => hit.u,
        Aov::BarycentricV => hit.v,
        Aov::UvU => uv().x,
        Aov::UvV => uv().y,
        Aov::EventCt => event().ct,
        Aov::EventX => event().x.x,
        Aov::EventY => event().x.y,
        Aov::EventZ => event().x.z,
        Aov::ObjectEventCt => object_event().ct,
        Aov::ObjectEventX => object_event().x.x,
        Aov::ObjectEventY => object_event().x.y,
        Aov::ObjectEventZ => object_event().x.z,
        Aov::Distance => hit.s,
        Aov::WavelengthRatio => seen.w.0,
        Aov::NormalX => normal().x,
        Aov::NormalY => normal().y,
        Aov::NormalZ => normal().z,
        _ => f64::NAN,
    }
}
