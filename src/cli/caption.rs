//! Captions below pictures.

use nullray::Result;
use nullray::camera::Camera;
use nullray::scene::model::Scene;
use nullray::spacetime::Velocity;

/// The caption: these words, the camera's time, and its speed if it moves.
pub fn of(words: &str, scene: &Scene) -> Result<String> {
    let velocity = Camera::new(scene)?.shot.frame.velocity();
    let mut parts = vec![format!("t′ = {:.3} m", scene.camera.time).replace('-', "−")];
    parts.extend((!velocity.is_rest()).then(|| speed(velocity)));
    parts.splice(0..0, (!words.is_empty()).then(|| words.to_string()));
    Ok(parts.join(", "))
}

/// A speed and its Lorentz factor, to three digits.
pub fn speed(velocity: Velocity) -> String {
    let (beta, gamma) = (velocity.beta().length(), velocity.gamma());
    match beta {
        b if b > 0.999 => format!("γ = {gamma:.2}"),
        b => format!("β = {b:.3}, γ = {gamma:.3}"),
    }
}
