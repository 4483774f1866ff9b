//! The reference tables. tests/data/physics/README.md describes the data and the tolerances.

use glam::DVec3;
use nullray::spacetime::worldline::{Crossing, WorldLine};
use nullray::spacetime::{Event, Velocity, World};

use crate::common::table::{Row, rows};
use crate::common::worst::{EPS, Worst};
use crate::worldlines::lines::{four_velocity, size};

fn event(row: &Row, prefix: &str) -> Event<World> {
    Event::new(row.number(&format!("{prefix}ct")), row.vector(prefix))
}

#[test]
fn hyperbolic_motion_is_that_of_the_table() {
    let [mut place, mut rise, mut advance, mut speed] = std::array::from_fn(|_| Worst::default());
    let rows = rows("worldlines.csv");
    assert_eq!(rows.len(), 200);
    for row in &rows {
        let n = row.vector("n").normalize();
        let (zero, tau) = (event(row, "O"), row.number("tau"));
        let line = |zero| WorldLine::hyperbolic(Velocity::REST, zero, n * row.number("g")).unwrap();
        let label = || format!("line {}", row.line);
        let (state, reference) = (line(zero).state(tau).unwrap(), event(row, ""));
        let allowed = 2e-15 * (1.0 + row.vector("rap").length()) * size(reference).max(size(zero));
        place.note(
            crate::worldlines::lines::apart(state.event, reference),
            allowed,
            label,
        );
        // The increments alone, relative to themselves.
        let moved = line(Event::ORIGIN).state(tau).unwrap();
        rise.note(
            moved.event.ct - row.number("dct"),
            2e-15 * (1.0 + row.vector("rap").length()) * row.number("dct").abs(),
            label,
        );
        let along = moved.event.x.dot(n);
        advance.note(
            along - row.number("dpos"),
            2e-15 * (1.0 + row.vector("rap").length()) * row.number("dpos").abs(),
            label,
        );
        let rapidity = row.vector("rap");
        let error = (moved.velocity.rapidity() - rapidity).length();
        speed.note(error, 2e-15 * rapidity.length(), label);
        let beta = row.number("beta");
        speed.note(moved.velocity.beta().length() - beta, 2e-15 * beta, label);
        speed.note(
            moved.velocity.gamma() / row.number("gamma") - 1.0,
            2e-15 * (1.0 + rapidity.length()),
            label,
        );
    }
    place.assert_within("event");
    rise.assert_within("time gone by");
    advance.assert_within("way");
    speed.assert_within("velocity");
}

/// The line of a row of the light cone's table.
fn line(row: &Row) -> WorldLine {
    let (u, zero) = (row.vector("u"), event(row, "O"));
    match row.text("kind") {
        "inertial" => WorldLine::inertial(Velocity::from_rapidity(u).unwrap(), zero),
        "hyperbolic" => {
            let a = u.normalize() * row.number("g");
            WorldLine::hyperbolic(Velocity::REST, zero, a).unwrap()
        }
        "circular" => circular(row, u.normalize(), zero.x),
        kind => panic!("{kind}"),
    }
}

fn circular(row: &Row, axis: DVec3, centre: DVec3) -> WorldLine {
    let r = row.vector("r");
    let e1 = (r - axis * axis.dot(r)).normalize();
    let (sin, cos) = row.number("phase").sin_cos();
    let arm = (e1 * cos + axis.cross(e1) * sin) * row.number("R");
    let zero = Event::new(0.0, centre + arm);
    WorldLine::circular(zero, centre, axis, row.number("Om")).unwrap()
}

/// dP = u (k·dE)/(k·u): how far the crossing moves along its line, in units of the move of the apex. By
/// γ for u and 1/W for k·u, W the ratio in the table.
fn magnification(row: &Row, gamma: f64) -> f64 {
    1.0 + gamma / row.number("W")
}

/// A circle is given by rounded positions: its radius and phase, relative, and with them v to γ² of it.
fn roundness(row: &Row) -> f64 {
    match row.text("kind") {
        "circular" => 4.0 * EPS * (size(event(row, "O")) / row.number("R") + 1.0),
        _ => 0.0,
    }
}

fn crossings() -> impl Iterator<Item = (Row, WorldLine, Option<Crossing>)> {
    let rows = rows("lightcone.csv");
    assert_eq!(rows.len(), 200);
    rows.into_iter().map(|row| {
        let line = line(&row);
        let crossing = line.on_past_light_cone_of(event(&row, "E"));
        (row, line, crossing)
    })
}

#[test]
fn light_cones_are_crossed_where_the_table_says() {
    let [mut place, mut time, mut delay] = std::array::from_fn(|_| Worst::default());
    for (row, line, crossing) in crossings() {
        assert_eq!(
            crossing.is_some(),
            row.number("exists") == 1.0,
            "line {}",
            row.line
        );
        let Some(crossing) = crossing else { continue };
        let reference = event(&row, "P");
        let state = line.state(row.number("tau")).unwrap();
        let (gamma, _) = four_velocity(&state);
        let apex = event(&row, "E");
        let zero = line.state(0.0).unwrap().event;
        let scale = size(reference).max(size(apex)).max(size(zero));
        let label = || format!("line {}, {}", row.line, row.text("kind"));
        let allowed = 16.0 * EPS * scale * magnification(&row, gamma);
        place.note(
            crate::worldlines::lines::apart(crossing.event, reference),
            allowed,
            label,
        );
        delay.note(
            -crossing.displacement.ct - row.number("dist"),
            allowed,
            label,
        );
        let tau = row.number("tau");
        let rate = gamma * gamma * roundness(&row);
        let allowed = (1e-12 + rate) * tau.abs() + (1e-12 * scale + 4.0 * allowed) / gamma;
        time.note(crossing.proper_time() - tau, allowed, label);
    }
    place.assert_within("event");
    delay.assert_within("delay");
    time.assert_within("proper time");
}

#[test]
fn the_wavelength_ratio_of_the_crossing_is_that_of_the_table() {
    let mut worst = Worst::default();
    for (row, line, crossing) in crossings() {
        let Some(crossing) = crossing else { continue };
        let state = line.state(crossing.proper_time()).unwrap();
        let (gamma, u) = four_velocity(&state);
        let look = crossing.displacement.x.normalize();
        // γ(1 + v·d) turns with d by γ per radian, and d by eps |E| / distance.
        let apex = event(&row, "E");
        let scale = size(event(&row, "P"))
            .max(size(apex))
            .max(size(line.state(0.0).unwrap().event));
        let w = row.number("W");
        let turned = gamma * scale / row.number("dist") * magnification(&row, gamma);
        let slower = gamma * gamma * gamma * roundness(&row);
        let allowed = 1e-12 * w + 64.0 * EPS * (turned + gamma) + slower;
        worst.note(gamma + u.dot(look) - w, allowed, || {
            format!("line {}, {}", row.line, row.text("kind"))
        });
    }
    worst.assert_within("wavelength ratio");
}
