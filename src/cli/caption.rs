//! Captions below pictures.

use nullray::camera::Camera;
use nullray::scene::model::Scene;
use nullray::spacetime::Velocity;
use nullray::text::RichText;
use nullray::{Error, Result};

use super::failure::refused;

/// The caption: these words, the camera's time, and its speed if it moves.
pub fn of(words: &str, scene: &Scene) -> Result<String> {
    let velocity = Camera::new(scene)?.shot.frame.velocity();
    let mut parts = vec![format!("t′ = {:.3} m", scene.camera.time).replace('-', "−")];
    parts.extend((!velocity.is_rest()).then(|| speed(velocity)));
    parts.splice(0..0, (!words.is_empty()).then(|| words.to_string()));
    Ok(parts.join(", "))
}

/// Refuses characters of `--caption` that the font lacks; those of a scene's own caption are refused with the scene.
pub fn check(option: Option<&str>) -> Result<()> {
    let Some(words) = option else {
        return Ok(());
    };
    let set = RichText::plain(words).and_then(|words| words.width(1.0));
    set.map(drop).map_err(|error| match error {
        Error::Invalid(problem) | Error::Unsupported(problem) => {
            refused("--caption", problem.what.to_string(), &problem.help)
        }
        error => error,
    })
}

/// A speed and its Lorentz factor, to three digits.
pub fn speed(velocity: Velocity) -> String {
    let (beta, gamma) = (velocity.beta().length(), velocity.gamma());
    match beta {
        b if b > 0.999 => format!("γ = {gamma:.2}"),
        b => format!("β = {b:.3}, γ = {gamma:.3}"),
    }
}
