//! The metadata of every output, and scene-file words for it.

use std::io::{self, Read};

use sha2::{Digest, Sha256};

use crate::camera::{Camera, Projection as _};
use crate::colour::{Continuation, INFRARED, ULTRAVIOLET};
use crate::error::{Result, number};
use crate::io::sealed::hexadecimal;
use crate::render::bake::{Baked, Bins};
use crate::render::film::Film;
use crate::scene::model::{
    Assembly, CameraModel, CubeBacks, Elements, Equations, Integration, Motion, Pivot,
    ProjectionKind, Records, Scene, Spectra,
};
use crate::spacetime::{Event, Quantity, World};

/// For a file generated from a text alone: program, name of the text, hash, and the text.
pub fn of_text(name: &str, text: &str) -> Vec<(String, String)> {
    let pairs = [
        ("software", software()),
        ("scene", name.into()),
        ("scene_sha256", sha256(text.as_bytes())),
        ("scene_text", text.into()),
    ];
    pairs.map(|(key, value)| (key.into(), value)).into()
}

fn software() -> String {
    format!("nullray {}", env!("CARGO_PKG_VERSION"))
}

/// Key and value pairs: program, scene, hash, camera, units.
///
/// # Errors
/// A camera that cannot take a picture ([`Camera::new`]).
pub fn metadata(scene: &Scene, film: &Film) -> Result<Vec<(String, String)>> {
    let camera = &scene.camera;
    let taken = Camera::new(scene)?;
    let shot = &taken.shot;
    let [right, up, forward] = shot.projection.axes();
    let pairs = [
        ("units", "metres; times are c·t in metres; c = 1".into()),
        ("speed_of_light_m_per_s", scene.speed_of_light.to_string()),
        ("medium_index", scene.medium_index.to_string()),
        (
            "samples_per_pixel",
            (u64::from(film.samples()) * u64::from(film.passes())).to_string(),
        ),
        ("pixel_centers", film.is_centred().to_string()),
        ("precision", film.precision().name().into()),
        ("radiance_quantity", scene.quantity.to_string()),
        ("camera_clock_zero_event", event(camera.origin)),
        ("camera_rapidity", vector(camera.velocity.rapidity())),
        ("camera_time", camera.time.to_string()),
        ("camera_shot_event", event(shot.event)),
        (
            "camera_shot_rapidity",
            vector(shot.frame.velocity().rapidity()),
        ),
        ("camera_right", vector(right)),
        ("camera_up", vector(up)),
        ("camera_forward", vector(forward)),
        (
            "camera_horizontal_fov_rad",
            taken.horizontal_fov(camera).to_string(),
        ),
    ];
    // Keys of absent values are omitted.
    let has_rgb = scene.quantity == Quantity::Rgb
        || scene.sources.iter().any(|s| s.quantity == Quantity::Rgb);
    let continuation = has_rgb.then(|| {
        (
            "radiance_continuation",
            scene.continuation.name().to_string(),
        )
    });
    let bands = has_rgb && scene.continuation == Continuation::Companions;
    let bands = bands.then(|| {
        [
            ("infrared_channel_m", INFRARED),
            ("ultraviolet_channel_m", ULTRAVIOLET),
        ]
        .map(|(key, [from, to])| (key, format!("{} {}", wavelength(from), wavelength(to))))
    });
    let false_colour = scene
        .false_colour
        .filter(|_| scene.sees_wavelengths())
        .map(|l| ("false_colour_m", wavelength(l)));
    let spectra = (scene.spectra != Spectra::Rgb)
        .then(|| ("reflected_spectra", scene.spectra.name().to_string()));
    let bounces = (scene.bounces > 0).then(|| ("bounces", scene.bounces.to_string()));
    let passes = (film.passes() > 1).then(|| ("passes", film.passes().to_string()));
    let error = film
        .error_asked_for()
        .map(|error| ("relative_error_asked_for", error.to_string()));
    let degrees = film.degrees_of_freedom().map(|degrees| {
        let text = format!("{degrees:.1}");
        ("standard_error_degrees_of_freedom", text)
    });
    let equations = (scene.equations != Equations::Exact)
        .then(|| ("equations", equations(scene.equations).to_string()));
    let own = pairs
        .into_iter()
        .chain(continuation)
        .chain(bands.into_iter().flatten())
        .chain(false_colour)
        .chain(bounces)
        .chain(spectra)
        .chain(passes)
        .chain(error)
        .chain(degrees)
        .chain(projection(camera))
        .chain(equations)
        .chain(moving(camera))
        .chain(sensor(camera));
    let own = own.map(|(key, value)| (key.into(), value));
    let all = of_text(&scene.name, &scene.text).into_iter().chain(own);
    Ok(all.collect())
}

/// For baked light: program, scene, hash, units, bins.
pub fn of_baked(scene: &Scene, bins: &Bins, samples: u32, baked: &Baked) -> Vec<(String, String)> {
    let energy = &baked.energy;
    let pairs = [
        (
            "units",
            "energy of radiance per bin of time; metres; times are c·t in metres; c = 1".into(),
        ),
        ("speed_of_light_m_per_s", scene.speed_of_light.to_string()),
        ("medium_index", scene.medium_index.to_string()),
        ("samples_per_pixel", samples.to_string()),
        ("radiance_quantity", scene.quantity.to_string()),
        ("bounces", scene.bounces.to_string()),
        ("start", number(bins.start).to_string()),
        ("bin_width", number(bins.width).to_string()),
        ("bins", bins.count.to_string()),
        ("clock", baked.clock.name().into()),
        ("energy_in_bins", energy.held.to_string()),
        ("energy_before_bins", energy.before.to_string()),
        ("energy_after_bins", energy.after.to_string()),
        (
            "relative_standard_error",
            baked.relative_error().to_string(),
        ),
    ];
    // The first and the last time at which any light arrives.
    let span = energy.span.into_iter();
    let span = span.flat_map(|[from, to]| [("light_from", from), ("light_until", to)]);
    let span = span.map(|(key, time)| (key, time.to_string()));
    // For a surface, what is on its backs.
    let backs = (CubeBacks::KEY, baked.backs.name().into());
    let own = pairs.into_iter().chain(span).chain([backs]);
    let own = own.map(|(key, value): (_, String)| (key.into(), value));
    of_text(&scene.name, &scene.text)
        .into_iter()
        .chain(own)
        .collect()
}

/// For a camera that is not a single pinhole with a perspective.
fn projection(camera: &CameraModel) -> Vec<(&'static str, String)> {
    let mut pairs = Vec::new();
    if camera.projection != ProjectionKind::Perspective {
        pairs.push(("camera_projection", camera.projection.name().into()));
    }
    if let Some(stereo) = camera.stereo {
        let distance = stereo.interpupillary_distance;
        pairs.push(("camera_interpupillary_distance", distance.to_string()));
    }
    pairs
}

/// For a camera with acceleration or an exposure.
fn moving(camera: &CameraModel) -> Vec<(&'static str, String)> {
    let mut pairs = Vec::new();
    if camera.motion != Motion::Inertial {
        pairs.push(("camera_motion", motion(&camera.motion).into()));
    }
    if let Motion::Accelerated(a) = camera.motion {
        pairs.push(("camera_proper_acceleration_per_m", vector(a)));
    }
    if let Motion::Circular { centre, axis, rate } = camera.motion {
        pairs.push(("camera_circle_centre", vector(centre)));
        pairs.push(("camera_circle_axis", vector(axis)));
        pairs.push(("camera_circle_rate_rad_per_m", rate.to_string()));
    }
    if let Some(shutter) = camera.shutter {
        pairs.push(("shutter_duration", shutter.duration.to_string()));
        pairs.push(("shutter_records", records(shutter.records).into()));
        if shutter.integration == Integration::Means {
            pairs.push((
                "shutter_integration",
                integration(shutter.integration).into(),
            ));
        }
    }
    if let Some(interval) = camera.frame_interval {
        pairs.push(("frame_interval", interval.to_string()));
    }
    pairs
}

/// For a camera with a sensor apart from its pinhole, or a rotating one.
fn sensor(camera: &CameraModel) -> Vec<(&'static str, String)> {
    let mut pairs = Vec::new();
    if let (Some(sensor), Some([x, y])) = (camera.sensor, camera.sensor_half_size()) {
        pairs.push(("sensor_focal_length", sensor.focal_length.to_string()));
        pairs.push(("sensor_size", format!("{} {}", 2.0 * x, 2.0 * y)));
        pairs.push(("sensor_assembly", assembly(sensor.assembly).into()));
    }
    if let Some(rotation) = camera.rotation {
        pairs.push(("rotation_axis", vector(rotation.axis)));
        pairs.push(("rotation_rate_rad_per_m", rotation.rate.to_string()));
        pairs.push(("rotation_through", pivot(rotation.through).into()));
        pairs.push(("rotation_elements", elements(rotation.elements).into()));
    }
    pairs
}

/// The table in scene files of what a radiance measures, like `{ quantity = "photons" }`.
pub fn radiance(quantity: Quantity) -> String {
    let name = quantity.kind().name();
    match quantity.line() {
        Some(line) => format!(
            "{{ quantity = {name:?}, wavelength = \"{} m\" }}",
            wavelength(line)
        ),
        None => format!("{{ quantity = {name:?} }}"),
    }
}

/// A wavelength in metres, in the shortest form with an exponent: 8.3e-7.
fn wavelength(metres: f64) -> String {
    // Twelve digits: a product with 1e-9 may differ from the intended number in the last digit.
    let rounded: f64 = format!("{metres:.11e}").parse().unwrap_or(metres);
    format!("{rounded:e}")
}

/// Its name in scene files.
pub fn equations(equations: Equations) -> &'static str {
    match equations {
        Equations::Exact => "exact",
        Equations::Paper2015 => "paper2015",
    }
}

/// Its name in scene files.
pub fn motion(motion: &Motion) -> &'static str {
    match motion {
        Motion::Inertial => "inertial",
        Motion::Accelerated(_) => "acceleration",
        Motion::Segments(_) => "segments",
        Motion::Profile { .. } => "profile",
        Motion::Keyframes(_) => "keyframes",
        Motion::Animation { .. } => "animation",
        Motion::Circular { .. } => "circle",
    }
}

/// Its name in scene files.
pub fn assembly(assembly: Assembly) -> &'static str {
    match assembly {
        Assembly::Rigid => "rigid",
        Assembly::WorldLength => "world_length",
        Assembly::Bell => "bell",
    }
}

/// Its name in scene files.
pub fn pivot(pivot: Pivot) -> &'static str {
    match pivot {
        Pivot::Pinhole => "pinhole",
        Pivot::Sensor => "sensor",
    }
}

/// Its name in scene files.
pub fn elements(elements: Elements) -> &'static str {
    match elements {
        Elements::Exact => "exact",
        Elements::Comoving => "comoving",
        Elements::Aberrated => "aberrated",
    }
}

/// Its name in scene files.
pub fn integration(integration: Integration) -> &'static str {
    match integration {
        Integration::Moments => "moments",
        Integration::Means => "means",
    }
}

/// Its name in scene files.
pub fn records(records: Records) -> &'static str {
    match records {
        Records::Mean => "mean",
        Records::Energy => "energy",
    }
}

fn event(event: Event<World>) -> String {
    format!("{} {}", event.ct, vector(event.x))
}

fn vector(v: glam::DVec3) -> String {
    format!("{} {} {}", v.x, v.y, v.z)
}

/// The SHA-256 of `bytes`, in hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// The remaining length of `reader`, and the SHA-256 of that in hexadecimal.
///
/// # Errors
/// Those of `reader`.
pub(crate) fn sha256_of(reader: &mut impl Read) -> io::Result<(u64, String)> {
    let mut hasher = Sha256::new();
    let mut block = vec![0; 1 << 16];
    let mut length = 0;
    loop {
        match reader.read(&mut block)? {
            0 => return Ok((length, hexadecimal(&hasher.finalize()))),
            n => {
                hasher.update(&block[..n]);
                length += n as u64;
            }
        }
    }
}
