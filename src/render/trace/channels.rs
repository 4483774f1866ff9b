//! Auxiliary channels of a sample.

use super::radiance::Radiance;
use super::surface_point::ObservedPoint;
use crate::render::aov::{Aov, Combine};
use crate::render::film::TileFilm;
use crate::spacetime::{Direction, World};

/// Records `channels`, the film's channels in order, for a sample at `offset` in `pixel` that looks along `d`, if it sees anything.
#[allow(clippy::too_many_arguments)]
pub(crate) fn record(
    channels: &[Aov],
    radiance: &dyn Radiance,
    pixel: usize,
    offset: [f64; 2],
    d: Option<Direction<World>>,
    observed: Option<&ObservedPoint>,
    film: &mut TileFilm,
) {
    // Identities and positions come from one sample, never from a mean over two surfaces.
    let nearest = film.is_nearest_to_centre(pixel, offset, observed.is_some());
    if d.is_none() {
        film.add_blind_sample(pixel);
    }
    for (channel, aov) in channels.iter().enumerate() {
        match aov.combine() {
            Combine::NearestIdentity | Combine::Nearest if !nearest => {}
            Combine::NearestIdentity => {
                film.set_aov(
                    channel,
                    pixel,
                    value(*aov, radiance, d, observed).unwrap_or(-1.0),
                );
            }
            Combine::Nearest => {
                film.set_aov(
                    channel,
                    pixel,
                    value(*aov, radiance, d, observed).unwrap_or(f64::NAN),
                );
            }
            Combine::MeanOfHits | Combine::MeanOfAll | Combine::MeanOfSeeing => {
                if let Some(value) = value(*aov, radiance, d, observed) {
                    film.add_aov(channel, pixel, value);
                }
            }
            // The film computes these from radiance and its parts.
            Combine::Coverage | Combine::Missing(_) | Combine::StandardError | Combine::Samples => {
            }
        }
    }
}

/// The channel's value, or `None` if the sample has none. The film computes coverage, standard error and number of samples.
fn value(
    aov: Aov,
    radiance: &dyn Radiance,
    d: Option<Direction<World>>,
    observed: Option<&ObservedPoint>,
) -> Option<f64> {
    let point = observed.map(|o| &o.point);
    // Each is computed only if a channel needs it: most pictures have none of these channels.
    let uv = || Some(point?.uv(0).unwrap_or(glam::DVec2::NAN));
    let event = || Some(point?.event());
    let object_event = || point.map(|p| p.rest_event() - p.patch.object_origin);
    let normal = || point.map(|p| p.rest.bvh.normal(&p.hit));
    let capture = || radiance.capture(point?);
    match aov {
        Aov::Object => Some(point?.patch.object as f64),
        Aov::Primitive => Some(point?.primitive() as f64),
        Aov::BarycentricU => Some(point?.hit.u),
        Aov::BarycentricV => Some(point?.hit.v),
        Aov::UvU => Some(uv()?.x),
        Aov::UvV => Some(uv()?.y),
        Aov::EventCt => Some(event()?.ct),
        Aov::EventX => Some(event()?.x.x),
        Aov::EventY => Some(event()?.x.y),
        Aov::EventZ => Some(event()?.x.z),
        Aov::ObjectEventCt => Some(object_event()?.ct),
        Aov::ObjectEventX => Some(object_event()?.x.x),
        Aov::ObjectEventY => Some(object_event()?.x.y),
        Aov::ObjectEventZ => Some(object_event()?.x.z),
        Aov::DirectionX => Some(d?.unit().x),
        Aov::DirectionY => Some(d?.unit().y),
        Aov::DirectionZ => Some(d?.unit().z),
        Aov::Distance => Some(point?.hit.s),
        Aov::WavelengthRatio => Some(observed?.w.0),
        Aov::NormalX => Some(normal()?.x),
        Aov::NormalY => Some(normal()?.y),
        Aov::NormalZ => Some(normal()?.z),
        Aov::CaptureFootprint => Some(capture()?.footprint),
        Aov::CaptureCosine => Some(capture()?.cosine),
        Aov::CaptureSource => Some(radiance.capture_source(point?)? as f64),
        // Masks count from 1, as 0 means that no object covers the sample.
        Aov::ObjectId => Some(point.map_or(0.0, |p| f64::from(p.patch.object) + 1.0)),
        Aov::Alpha => Some(f64::from(observed.is_some())),
        Aov::Coverage
        | Aov::MissingBefore
        | Aov::MissingAfter
        | Aov::MissingOffTexture
        | Aov::MissingOccluded
        | Aov::StandardError
        | Aov::Samples => None,
    }
}
