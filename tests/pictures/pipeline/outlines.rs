//! A moving ball has a circular outline (Penrose 1959, Terrell 1959), as rendered.
//!
//! In the ball's rest frame the outline is the cone d′·a′ = cos α′, sin α′ = R/|P′|, about the direction a′
//! from the camera's event P′ to the ball. With k = (−1, d) and n = (−cos α′, a′) that is k·n = 0 in the
//! metric (−, +, +, +), hence in every frame: d·b = 1 with b = −n_x/n_t of n = Λ n′, again a cone.

use glam::{DMat3, DVec3};
use nullray::camera::Shot;
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::scene::model::Scene;
use nullray::spacetime::Velocity;

use crate::pipeline::{lorentz, stage};

/// Pixels across the picture, and the angle of one in its middle.
const SIZE: usize = 300;
const PIXEL: f64 = 2.0 * 0.363_970_234_266_202_4 / SIZE as f64; // 2 tan 20° / SIZE

fn ball(beta: DVec3) -> Scene {
    let mut scene = stage::scene(
        "
[camera]
eye = [0, 0, 0]
look_at = [0, 0, -1]
hfov = \"40 deg\"
size = [300, 300]
clock_zero = \"6 m\"
[[object]]
shape = { sphere = { radius = 1, subdivisions = 6 } }
origin = { position = [0.2, -0.1, -6.0], time = \"0 m\" }
",
    );
    scene.objects[0].velocity = Velocity::from_beta(beta).unwrap();
    scene
}

/// Directions half-way between neighbouring pixels of which one sees the ball.
fn outline(film: &Film) -> Vec<DVec3> {
    let hit = |i: usize| stage::value(film, Aov::Object, i) == 0.0;
    let mut edge = Vec::new();
    for i in 0..SIZE * SIZE {
        let right = (i % SIZE + 1 < SIZE).then_some(i + 1);
        let below = (i + SIZE < SIZE * SIZE).then_some(i + SIZE);
        for j in [right, below].into_iter().flatten() {
            if hit(i) != hit(j) {
                let middle = stage::direction(film, i) + stage::direction(film, j);
                edge.push(middle.normalize());
            }
        }
    }
    edge
}

/// The cone d·b = 1 nearest to `edge`: (Σ d dᵀ) b = Σ d.
fn fitted(edge: &[DVec3]) -> DVec3 {
    let outer = |d: DVec3| DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    let squares = edge.iter().fold(DMat3::ZERO, |sum, d| sum + outer(*d));
    squares.inverse() * edge.iter().sum::<DVec3>()
}

/// The largest angle between the cone `b` and directions of `edge`.
fn worst_angle(edge: &[DVec3], b: DVec3) -> f64 {
    let (axis, opening) = (b.normalize(), (1.0 / b.length()).acos());
    let off = |d: &DVec3| (axis.dot(*d).acos() - opening).abs();
    edge.iter().map(off).fold(0.0, f64::max)
}

/// The cone of the closed form.
fn predicted(scene: &Scene, beta: DVec3) -> DVec3 {
    let w = lorentz::rapidity(beta);
    let (camera, origin) = (
        Shot::new(&scene.camera).unwrap().event,
        scene.objects[0].origin,
    );
    let seen_from = lorentz::four(camera.ct - origin.ct, camera.x - origin.x);
    let p = lorentz::space(lorentz::boost(-w) * seen_from);
    let cosine = (1.0 - 1.0 / p.length_squared()).sqrt();
    let n = lorentz::boost(w) * lorentz::four(-cosine, -p.normalize());
    -lorentz::space(n) / n.x
}

#[test]
fn the_outline_of_a_moving_ball_is_the_predicted_circle() {
    for beta in [
        DVec3::new(0.9, 0.0, 0.0),
        DVec3::new(0.0, 0.0, 0.9),
        DVec3::new(0.0, 0.0, -0.9),
        DVec3::new(0.5, 0.6, 0.44),
        DVec3::new(-0.3, 0.7, -0.47),
        DVec3::ZERO,
    ] {
        let scene = ball(beta);
        let edge = outline(&stage::film(&scene));
        assert!(edge.len() > 100, "{beta}: {}", edge.len());
        // An edge lies within half a pixel of the middle between two pixel centres. The facets of the
        // ball are within edge²/8 = 4·10⁻⁵ R of it: a few hundredths of a pixel.
        let (b, truth) = (fitted(&edge), predicted(&scene, beta));
        let worst = worst_angle(&edge, truth) / PIXEL;
        assert!(
            worst < 0.6,
            "{beta}: {worst} pixels off the predicted circle"
        );
        let worst = worst_angle(&edge, b) / PIXEL;
        assert!(worst < 0.6, "{beta}: {worst} pixels off the fitted circle");
        // Over hundreds of edge pixels the rounding to pixels averages out.
        let apart = b.normalize().angle_between(truth.normalize()) / PIXEL;
        let wider = (1.0 / b.length()).acos() - (1.0 / truth.length()).acos();
        assert!(
            apart < 0.1 && wider.abs() / PIXEL < 0.1,
            "{beta}: {apart}, {wider}"
        );
    }
}

#[test]
fn without_retardation_the_outline_is_not_a_circle() {
    let mut scene = ball(DVec3::new(0.9, 0.0, 0.0));
    scene.effects.retardation = false;
    // The ball is then where it is at the shot, 5.4 m further on.
    scene.objects[0].origin.x.x -= 0.9 * 6.0;
    let edge = outline(&stage::film(&scene));
    let worst = worst_angle(&edge, fitted(&edge)) / PIXEL;
    assert!(worst > 10.0, "{worst}");
}
