//! The ranges of numbers in scenes, whether they come from a file or from a program. Each check returns what is wrong, and what would be
//! right.

use glam::{DAffine3, DVec3};

use super::model::{EmissionProfile, MOST_BOUNCES, MOST_SAMPLES, ProjectionKind, Scene, Spectra};
use crate::error::number;
use crate::spacetime::{Direction, Quantity, World};

/// What is wrong, and what would be right.
pub(crate) type Wrong = (String, String);

/// The largest width or height of a picture.
const LARGEST_SIDE: u32 = 65_536;
/// The largest number of pixels.
const LARGEST_AREA: u64 = 1 << 28;
/// The most subdivisions of a sphere: 1.3 million triangles.
const MOST_SUBDIVISIONS: u32 = 8;
/// The most cells of a lattice along each axis.
const MOST_CELLS: u32 = 64;
/// The most stars.
pub(crate) const MOST_STARS: u32 = 1_000_000;

/// Width and height of a picture.
pub(crate) fn image_size([width, height]: [u32; 2]) -> Result<(), Wrong> {
    let side = |n: u32| (1..=LARGEST_SIDE).contains(&n);
    if !side(width) || !side(height) {
        let what = format!("an image of {width} by {height} pixels cannot be made");
        let help = format!("width and height are each 1 to {LARGEST_SIDE}, like [640, 480]");
        return Err((what, help));
    }
    let area = u64::from(width) * u64::from(height);
    if area > LARGEST_AREA {
        let what = format!("{width} by {height} are {area} pixels");
        let help = format!("an image has at most {LARGEST_AREA} pixels");
        return Err((what, help));
    }
    Ok(())
}

/// Samples of each pixel.
pub(crate) fn samples_per_pixel(samples: u32) -> Result<(), Wrong> {
    if (1..=MOST_SAMPLES).contains(&samples) {
        return Ok(());
    }
    let what = format!("{samples} samples per pixel cannot be taken");
    Err((what, format!("give 1 to {MOST_SAMPLES}, like 16")))
}

/// How often light is reflected after direct light.
pub(crate) fn bounces(bounces: u32) -> Result<(), Wrong> {
    if bounces <= MOST_BOUNCES {
        return Ok(());
    }
    let what = format!("{bounces} bounces are out of range");
    Err((what, format!("give 0 to {MOST_BOUNCES}, like 4")))
}

/// What surfaces reflect, in a resolved scene: only light with known spectra can be sampled at wavelengths.
pub(crate) fn spectra(scene: &Scene) -> Result<(), Wrong> {
    if scene.spectra == Spectra::Rgb {
        return Ok(());
    }
    let wrong = |what: &str, help: &str| Err((what.into(), help.into()));
    if scene.quantity != Quantity::Rgb {
        let what = "spectra are sampled, but radiance of this quantity has none";
        return wrong(
            what,
            "set quantity = \"rgb\" in [radiance], or leave `spectra` out",
        );
    }
    if let Some(other) = scene.sources.iter().find(|s| s.quantity != Quantity::Rgb) {
        let what = format!(
            "spectra are sampled, but those of source {:?} are unknown",
            other.name
        );
        return wrong(
            &what,
            "give its radiance the quantity \"rgb\", or leave `spectra` out",
        );
    }
    if !scene.effects.doppler {
        let what = "spectra are sampled at wavelengths that shift, but these do not";
        return wrong(what, "turn `effects.doppler` on, or leave `spectra` out");
    }
    let mut sky = scene.sky.iter();
    if sky.any(|sky| sky.lights && sky.stars.is_some()) {
        let what = "spectra are sampled, but stars light surfaces only in red, green and blue";
        let help = "leave `stars` or `spectra` out, or set sky.lights = false";
        return wrong(what, help);
    }
    Ok(())
}

/// The refractive index of the medium.
pub(crate) fn medium_index(index: f64) -> Result<(), Wrong> {
    let help = || "give 1 (vacuum) or more, like 1.33 for water".to_string();
    if index < 1.0 {
        let what = format!(
            "a refractive index of {} is below 1, that of vacuum",
            number(index)
        );
        return Err((what, help()));
    }
    match index.is_finite() {
        true => Ok(()),
        false => Err((format!("a refractive index of {index}"), help())),
    }
}

/// Subdivisions of a sphere.
pub(crate) fn subdivisions(subdivisions: u32) -> Result<(), Wrong> {
    if subdivisions <= MOST_SUBDIVISIONS {
        return Ok(());
    }
    let what = format!("{subdivisions} subdivisions would be 20·4^{subdivisions} triangles");
    Err((what, format!("give 0 to {MOST_SUBDIVISIONS}")))
}

/// Cells of a lattice.
pub(crate) fn cells(cells: [u32; 3]) -> Result<(), Wrong> {
    if cells.iter().all(|n| (1..=MOST_CELLS).contains(n)) {
        return Ok(());
    }
    let what = format!("a lattice has 1 to {MOST_CELLS} cells along each axis");
    Err((what, "give numbers like [4, 4, 4]".into()))
}

/// Checks that an emission is not always 0.
pub(crate) fn emission(profile: &EmissionProfile) -> Result<(), Wrong> {
    match profile {
        EmissionProfile::Train { count: Some(0), .. } => {
            let what = "a train of 0 pulses never shines: it has at least 1";
            let help = "give a `count` of at least 1, or leave it out for a train without end";
            Err((what.into(), help.into()))
        }
        EmissionProfile::Table(knots) if knots.iter().all(|[_, factor]| *factor == 0.0) => {
            let help = "give some time a factor above 0, or leave the light out";
            Err(("all factors are 0: it never shines".into(), help.into()))
        }
        _ => Ok(()),
    }
}

/// Whether a picture of this projection can have this field of view, radians: within the projection's range, and not within a billionth
/// of 0 or, for a perspective camera, of π, so that the tangent of half the angle keeps its digits.
pub(crate) fn is_field_of_view(radians: f64, projection: ProjectionKind) -> bool {
    radians > 1e-9
        && match projection {
            ProjectionKind::Perspective => radians < std::f64::consts::PI - 1e-9,
            _ => radians <= projection.widest().to_radians(),
        }
}

/// Whether the transform has an inverse that f64 can hold: columns of unit length must span a volume.
pub(crate) fn is_invertible(transform: DAffine3) -> bool {
    let columns = [
        transform.matrix3.x_axis,
        transform.matrix3.y_axis,
        transform.matrix3.z_axis,
    ];
    let units = columns.map(|column| Direction::<World>::new(column).map(Direction::unit));
    let [Some(x), Some(y), Some(z)] = units else {
        return false;
    };
    // The volume of unit columns: below this bound it is dominated by rounding.
    let spans = x.cross(y).dot(z).abs() > 1e-12;
    let sized = |column: DVec3| (1e-30..=1e30).contains(&column.abs().max_element());
    spans && columns.into_iter().all(sized)
}
