//! The textbook Lorentz transformation as 4×4 matrices on (ct, x, y, z), independent of the program's own.

use glam::{DMat3, DMat4, DVec3, DVec4};
use nullray::scene::model::{Beam, LightKind, Scene};
use nullray::spacetime::{Event, Velocity, World};

/// (ct, x).
pub fn four(ct: f64, x: DVec3) -> DVec4 {
    DVec4::new(ct, x.x, x.y, x.z)
}

/// The spatial part.
pub fn space(v: DVec4) -> DVec3 {
    DVec3::new(v.y, v.z, v.w)
}

/// B(w): from the frame that moves with rapidity vector `w` to the world.
pub fn boost(w: DVec3) -> DMat4 {
    let phi = w.length();
    let n = w.try_normalize().unwrap_or(DVec3::X);
    let (gamma, sinh) = (phi.cosh(), phi.sinh());
    let column = |e: DVec3| four(sinh * n.dot(e), e + n * ((gamma - 1.0) * n.dot(e)));
    DMat4::from_cols(
        four(gamma, n * sinh),
        column(DVec3::X),
        column(DVec3::Y),
        column(DVec3::Z),
    )
}

/// The rapidity vector of β.
pub fn rapidity(beta: DVec3) -> DVec3 {
    beta.try_normalize().unwrap_or(DVec3::X) * beta.length().atanh()
}

/// Λ B(w) = B(w′) R: the rapidity w′ and the Wigner rotation R.
pub fn compose(lambda: DMat4, w: DVec3) -> (DVec3, DMat3) {
    let both = lambda * boost(w);
    let u = space(both.x_axis);
    let w = u.try_normalize().unwrap_or(DVec3::X) * u.length().asinh();
    let turn = boost(-w) * both;
    let columns = [turn.y_axis, turn.z_axis, turn.w_axis].map(space);
    (w, DMat3::from_cols(columns[0], columns[1], columns[2]))
}

/// The scene with all that is in it, and its camera, boosted by rapidity vector `v`: frames take new
/// velocities, and their contents turn by the Wigner rotation; their own clocks show the same.
pub fn boosted(scene: &Scene, v: DVec3) -> Scene {
    let lambda = boost(v);
    let mut moved = scene.clone();
    let event = |e: Event<World>| {
        let e = lambda * four(e.ct, e.x);
        Event::new(e.x, space(e))
    };
    let camera = &mut moved.camera;
    let (w, turn) = compose(lambda, camera.velocity.rapidity());
    camera.velocity = Velocity::from_rapidity(w).unwrap();
    camera.axes = camera.axes.map(|a| (turn * a).normalize());
    camera.origin = event(camera.origin);
    for light in &mut moved.lights {
        let LightKind::Lamp(lamp) = &mut light.kind else {
            continue;
        };
        let (w, turn) = compose(lambda, lamp.velocity.rapidity());
        lamp.velocity = Velocity::from_rapidity(w).unwrap();
        lamp.origin = event(lamp.origin);
        if let Beam::Spot { axis, .. } = &mut lamp.beam {
            *axis = turn * *axis;
        }
    }
    for object in &mut moved.objects {
        let (w, turn) = compose(lambda, object.velocity.rapidity());
        object.velocity = Velocity::from_rapidity(w).unwrap();
        object.origin = event(object.origin);
        object.transform.matrix3 = turn * object.transform.matrix3;
        object.transform.translation = turn * object.transform.translation;
    }
    moved
}
