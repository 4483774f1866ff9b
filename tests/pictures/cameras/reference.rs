//! Pinhole cameras against vectors of arbitrary precision.
//!
//! The film is addressed by 1 + px/f, which costs a few eps of a film of width two: directions are accurate to some eps (1 + 1/W), because
//! aberration magnifies by 1/W, and W to that times γβ sin(angle).

use glam::DVec3;
use nullray::camera::CameraRay;
use nullray::scene::model::{Assembly, Elements, Motion, Pivot, Rotation, Scene};
use nullray::spacetime::{Boost, CameraFrame, Event, Velocity, World};

use super::bench_camera::{element, looking_along_z, sensor, start};
use crate::common::table::{Row, rows};
use crate::common::worst::{EPS, Worst};

/// What conditioning leaves of a look direction and of W, for a film point some eps off.
struct Allowed {
    direction: f64,
    ratio: f64,
    /// Of the event of passage, metres.
    event: f64,
}

fn note(row: &Row, scene: &Scene, worst: &mut [Worst; 3], allowed: impl Fn(f64) -> Allowed) {
    let (px, py) = (row.number("px"), row.number("py"));
    let (camera, ray) = element(scene, px, py);
    let event = camera.shot.event + ray.origin.displacement;
    let d = row.vector(if row.has("dx") { "d" } else { "l" });
    let w = row.number("W");
    let allowed = allowed(w);
    let place = || format!("line {}", row.line);
    worst[0].note((ray.d.unit() - d).length(), allowed.direction, place);
    worst[1].note(ray.ratio / w - 1.0, allowed.ratio, place);
    let p = Event::<World>::new(row.number("Pct"), passage(row));
    let off = (event.ct - p.ct).abs().max((event.x - p.x).length());
    worst[2].note(off, allowed.event, place);
}

/// Boosts the ray to the frame that moves with its element at this velocity, where the table has its direction as `c`. `allowed` is that of
/// the world's direction: the boost scales small angles by W.
fn note_comoving(row: &Row, ray: &CameraRay, velocity: Velocity, worst: &mut Worst, allowed: f64) {
    let comoving = Boost::<CameraFrame, World>::new(-velocity);
    let c = comoving.direction(ray.d).0.unit();
    let (w, rapidity) = (row.number("W"), velocity.rapidity().length());
    let of_boost = 16.0 * EPS * (1.0 + rapidity + w);
    worst.note(
        (c - row.vector("c")).length(),
        allowed * w + of_boost,
        || format!("line {}", row.line),
    );
}

/// Where the light passed: the origin, unless the table says otherwise.
fn passage(row: &Row) -> DVec3 {
    match row.has("Px") {
        true => row.vector("P"),
        false => DVec3::ZERO,
    }
}

fn assert_within([d, w, p]: [Worst; 3], what: &str) {
    d.assert_within(&format!("{what}: look directions"));
    w.assert_within(&format!("{what}: wavelength ratios"));
    p.assert_within(&format!("{what}: events at the pinhole"));
}

#[test]
fn light_passes_the_pinhole_of_a_rigid_camera_before_it_reaches_the_sensor() {
    let mut worst = Default::default();
    let [mut distance, mut reached, mut own]: [Worst; 3] = Default::default();
    let table = rows("pinhole_a.csv");
    assert_eq!(table.len(), 100);
    for row in &table {
        let mut scene = looking_along_z();
        let w = row.vector("w");
        scene.camera.velocity = Velocity::from_rapidity(w).unwrap();
        scene.camera.origin = Event::new(row.number("Oct"), row.vector("O"));
        scene.camera.time = row.number("cts");
        scene.camera.sensor = sensor(row.number("dp"), Assembly::Rigid);
        let seen = row.vector("c");
        let across = w.normalize_or_zero().cross(seen).length();
        let size = row.number("Pct").abs() + row.vector("P").length();
        note(row, &scene, &mut worst, |ratio| Allowed {
            direction: 32.0 * EPS * (1.0 + w.length() + 1.0 / ratio),
            ratio: 32.0 * EPS * (1.0 + w.length() + w.length().sinh() * (across + EPS) / ratio),
            event: 16.0
                * EPS
                * (1.0 + w.length())
                * (size + row.number("cts").abs() * w.length().cosh()),
        });
        let element = DVec3::new(row.number("px"), row.number("py"), -row.number("dp"));
        let r = row.number("r");
        distance.note(element.length() - r, 4.0 * EPS * r, || {
            format!("line {}", row.line)
        });
        // The light that passed at P along −d reaches the element's event Q: Q − P = (t, −t d).
        let (camera, ray) = self::element(&scene, row.number("px"), row.number("py"));
        let p = camera.shot.event + ray.origin.displacement;
        let (q, t) = (row.vector("Q"), row.number("Qct") - p.ct);
        let extent = q.length() + row.number("Qct").abs() + size;
        let of_direction = 32.0 * EPS * (1.0 + w.length() + 1.0 / row.number("W"));
        note_comoving(row, &ray, scene.camera.velocity, &mut own, of_direction);
        let turned = of_direction * t.abs();
        let of_event = 32.0
            * EPS
            * (1.0 + w.length())
            * (extent + row.number("cts").abs() * w.length().cosh());
        reached.note(
            (q - p.x + ray.d.unit() * t).length(),
            turned + of_event,
            || format!("line {}", row.line),
        );
    }
    distance.assert_within("rigid: distances of elements");
    reached.assert_within("rigid: events of elements");
    own.assert_within("rigid: directions in the camera's frame");
    assert_within(worst, "rigid");
}

#[test]
fn light_finds_the_pinhole_that_accelerates_ahead_of_its_sensor() {
    let mut worst = Default::default();
    let [mut speed, mut apart, mut own]: [Worst; 3] = Default::default();
    let table = rows("pinhole_b.csv");
    assert_eq!(table.len(), 100);
    for row in &table {
        let mut scene = looking_along_z();
        let d = row.number("d");
        scene.camera.origin = Event::new(0.0, DVec3::Z * d);
        scene.camera.motion = start(DVec3::Z * row.number("g"));
        scene.camera.time = row.number("tau");
        scene.camera.sensor = sensor(d, Assembly::Bell);
        let size = row.number("Ect").abs() + row.vector("E").length();
        let (gamma, delay) = (row.number("gamma"), row.number("delay"));
        // The sensor accelerates from ct = 0 on: β = tanh(g τ). The pinhole that its light passed before that rests.
        let (g, beta) = (row.number("g"), row.number("beta"));
        let place = || format!("line {}, {}", row.line, row.text("phase"));
        speed.note(beta - (g * row.number("tau")).tanh(), 8.0 * EPS, place);
        assert_eq!(
            row.text("phase") == "rest",
            row.number("Pct") < 0.0,
            "line {}",
            row.line
        );
        // The distance in the sensor's comoving frame, exact: γd + (√(1 + (gdγβ)²) − 1)/g.
        let x = g * d * gamma * beta;
        let lead = x * x / (1.0 + (1.0 + x * x).sqrt()) / g;
        let comoving = gamma * d + lead;
        // The paper's Eq. 16 has the sign of a sensor ahead of its pinhole.
        let allowed = 64.0 * EPS * gamma * gamma * comoving;
        apart.note(gamma * d - lead - row.number("eq16"), allowed, place);
        apart.note(
            comoving / row.number("dsim") - 1.0,
            64.0 * EPS * gamma * gamma,
            place,
        );
        let of_direction = 32.0 * EPS * (1.0 + gamma);
        let velocity = Velocity::from_rapidity(DVec3::Z * g * row.number("tau")).unwrap();
        let (_, ray) = element(&scene, row.number("px"), row.number("py"));
        note_comoving(row, &ray, velocity, &mut own, of_direction);
        note(row, &scene, &mut worst, |ratio| Allowed {
            direction: of_direction,
            ratio: 64.0 * EPS * (1.0 + gamma / ratio),
            event: 16.0 * EPS * (size + gamma * delay),
        });
    }
    speed.assert_within("Bell's ships: β");
    apart.assert_within("Bell's ships: comoving distance");
    own.assert_within("Bell's ships: directions in the sensor's frame");
    assert_within(worst, "Bell's ships");
}

#[test]
fn a_turning_sensor_sees_a_pinhole_at_rest() {
    let mut worst = Default::default();
    let [mut look, mut shift, mut own]: [Worst; 3] = Default::default();
    let table = rows("pinhole_c.csv");
    assert_eq!(table.len(), 200);
    for row in &table {
        let mut scene = looking_along_z();
        scene.camera.time = row.number("cts");
        scene.camera.sensor = sensor(row.number("d"), Assembly::Rigid);
        scene.camera.motion = Motion::Inertial;
        scene.camera.rotation = Some(Rotation {
            axis: DVec3::Y,
            rate: row.number("Om"),
            through: match row.number("az") == 0.0 {
                true => Pivot::Pinhole,
                false => Pivot::Sensor,
            },
            elements: Elements::Exact,
        });
        let through_pinhole = row.text("mode") == "axis_pinhole";
        assert_eq!(
            through_pinhole,
            row.number("az") == 0.0,
            "line {}",
            row.line
        );
        // The pinhole rests: the element at r looks along −r, and moves with v: W = 1/(γ (1 + v·l)).
        let (l, v) = (-row.vector("r").normalize(), row.vector("v"));
        let (_, ray) = element(&scene, row.number("px"), row.number("py"));
        let turned = (row.number("Om") * row.number("cts")).abs();
        let label = || format!("line {}", row.line);
        let of_direction = 16.0 * EPS * (1.0 + turned);
        look.note((ray.d.unit() - l).length(), of_direction, label);
        let gamma = row.number("gamma");
        // A speed known to an eps gives the rapidity to γ² of them.
        let rapidity = v.length().atanh() * v.normalize_or_zero();
        let velocity = Velocity::from_rapidity(rapidity).unwrap();
        let of_speed = 16.0 * EPS * gamma * gamma / row.number("W");
        note_comoving(row, &ray, velocity, &mut own, of_direction + of_speed);
        let ratio = 1.0 / (gamma * (1.0 + v.dot(l)));
        shift.note(
            ray.ratio / ratio - 1.0,
            32.0 * EPS * gamma * gamma * (1.0 + turned),
            label,
        );
        let angle = (row.number("Om") * row.number("cts")).abs();
        let (gamma, size) = (row.number("gamma"), row.number("cts").abs());
        note(row, &scene, &mut worst, |_| Allowed {
            direction: 16.0 * EPS * (1.0 + angle),
            ratio: 16.0 * EPS * gamma * gamma * (1.0 + angle),
            event: 8.0 * EPS * (size + row.number("delay") * (1.0 + angle)),
        });
    }
    look.assert_within("turning: along −r");
    shift.assert_within("turning: 1/(γ (1 + v·l))");
    own.assert_within("turning: directions in the element's frame");
    assert_within(worst, "turning");
}
