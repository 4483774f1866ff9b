//! What every output says of its origin.

use nullray::film::Film;
use nullray::scene::model::Scene;
use sha2::{Digest, Sha256};

/// Key and value pairs: program, scene, hash, camera, units.
pub fn metadata(scene: &Scene, film: &Film) -> Vec<(String, String)> {
    let camera = &scene.camera;
    let event = camera.origin;
    let [right, up, forward] = camera.axes;
    let pairs = [
        ("software", format!("nullray {}", env!("CARGO_PKG_VERSION"))),
        ("scene", scene.name.clone()),
        ("scene_sha256", sha256(&scene.text)),
        ("scene_text", scene.text.clone()),
        ("units", "metres; times are c·t in metres; c = 1".into()),
        ("speed_of_light_m_per_s", scene.speed_of_light.to_string()),
        ("medium_index", scene.medium_index.to_string()),
        ("samples_per_pixel", film.samples().to_string()),
        ("pixel_centers", film.is_centred().to_string()),
        ("radiance_quantity", scene.quantity.to_string()),
        (
            "camera_clock_zero_event",
            format!("{} {} {} {}", event.ct, event.x.x, event.x.y, event.x.z),
        ),
        ("camera_rapidity", vector(camera.velocity.rapidity())),
        ("camera_time", camera.time.to_string()),
        ("camera_right", vector(right)),
        ("camera_up", vector(up)),
        ("camera_forward", vector(forward)),
        (
            "camera_horizontal_fov_rad",
            camera.horizontal_fov.to_string(),
        ),
    ];
    pairs
        .into_iter()
        .map(|(key, value)| (key.into(), value))
        .collect()
}

fn vector(v: glam::DVec3) -> String {
    format!("{} {} {}", v.x, v.y, v.z)
}

fn sha256(text: &str) -> String {
    Sha256::digest(text.as_bytes())
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}
