//! The equations of Jarabo et al. 2015 against reference values, and their exact counterparts by this crate.

use crate::common::table::{Row, rows};
use crate::common::worst::Worst;
use glam::DVec3;
use nullray::spacetime::paper2015::*;
use nullray::spacetime::{
    Boost, CameraFrame, Direction, Event, InertialFrame, Rest, Velocity, World,
};

/// Compares a column with `value`, relative to the column or, where that is a difference, to its terms.
fn check(column: &str, value: impl Fn(&Row) -> f64, terms: impl Fn(&Row) -> f64) {
    let mut worst = Worst::default();
    let rows = rows("paper.csv");
    assert_eq!(rows.len(), 100);
    for row in &rows {
        let reference = row.number(column);
        let allowed = 1e-12 * reference.abs().max(terms(row));
        worst.note(value(row) - reference, allowed, || {
            format!("line {}", row.line)
        });
    }
    worst.assert_within(column);
}

fn relative(column: &str, value: impl Fn(&Row) -> f64) {
    check(column, value, |_| 0.0);
}

fn beta(row: &Row) -> f64 {
    row.number("beta")
}

fn doppler(row: &Row) -> f64 {
    doppler_factor(beta(row), row.number("thetap"))
}

fn contracted(row: &Row) -> f64 {
    contracted_distance(beta(row), row.number("theta"), row.number("z"))
}

fn contracted_by_its_own_angle(row: &Row) -> f64 {
    let theta = world_angle(beta(row), row.number("thetap"));
    contracted_distance(beta(row), theta, row.number("z"))
}

fn elapsed(row: &Row) -> f64 {
    row.number("t") - row.number("t0")
}

fn velocity(beta: f64) -> Velocity {
    Velocity::from_beta(DVec3::Z * beta).unwrap()
}

#[test]
fn the_lorentz_factor_is_that_of_the_table() {
    relative("gamma", |row| lorentz_factor(beta(row)));
}

#[test]
fn equation_1_adds_the_delay_of_the_depth() {
    relative("eq1", |row| {
        capture_time(row.number("t"), row.number("z"), row.number("eta"))
    });
}

#[test]
fn equation_2_gives_doppler_factor_direction_and_wavelength() {
    relative("eq2_D", doppler);
    relative("eq2_theta", |row| {
        world_angle(beta(row), row.number("thetap"))
    });
    check(
        "eq2_cos",
        |row| world_angle(beta(row), row.number("thetap")).cos(),
        |_| 1.0,
    );
    relative("eq2_lambda", |row| {
        emitted_wavelength(row.number("lambdap"), doppler(row))
    });
}

#[test]
fn radiance_is_multiplied_by_the_fifth_power() {
    relative("eq2_f", |row| radiance_factor(doppler(row)));
}

#[test]
fn equation_3_contracts_distances_like_rods() {
    relative("eq3", contracted);
}

#[test]
fn equation_4_narrows_the_field_of_view() {
    relative("eq4", |row| field_of_view(beta(row), row.number("alpha")));
}

#[test]
fn equation_5_gives_the_direction_in_the_camera_frame() {
    relative("eq5_thetap", |row| {
        camera_angle(beta(row), row.number("theta"))
    });
    check(
        "eq5_cos",
        |row| camera_angle(beta(row), row.number("theta")).cos(),
        |_| 1.0,
    );
}

#[test]
fn equation_11_gives_the_time_argument_for_either_angle() {
    let time = |row: &Row, z| emission_time(beta(row), row.number("tp"), z, row.number("eta"));
    // A difference, to the digits of its terms.
    let terms = |row: &Row| row.number("tp").abs() / lorentz_factor(beta(row));
    check("eq11_t", |row| time(row, contracted(row)), terms);
    check(
        "eq11_t_chain",
        |row| time(row, contracted_by_its_own_angle(row)),
        terms,
    );
}

#[test]
fn equation_12_gives_the_proper_acceleration() {
    relative("eq12", |row| {
        proper_acceleration(beta(row), row.number("acc"))
    });
}

#[test]
fn equations_13_to_15_describe_hyperbolic_motion() {
    relative("eq13", |row| speed_after(row.number("g"), elapsed(row)));
    check(
        "eq14",
        |row| row.number("x0") + position_after(row.number("g"), elapsed(row)),
        |row| row.number("x0").abs(),
    );
    relative("eq15", |row| world_time(row.number("g"), row.number("tp")));
}

#[test]
fn equation_16_has_the_sign_of_a_leading_sensor_and_the_other_sign_is_exact() {
    let separation =
        |row: &Row, sign: f64, v| comoving_separation(sign * row.number("g"), row.number("d"), v);
    // Its terms: γd, and at most as much again.
    let terms = |row: &Row, v: f64| row.number("d") * lorentz_factor(v);
    let accelerated = |row: &Row| speed_after(row.number("g"), elapsed(row));
    check(
        "eq16a",
        |row| separation(row, 1.0, accelerated(row)),
        |row| terms(row, accelerated(row)),
    );
    check(
        "eq16b",
        |row| separation(row, 1.0, beta(row)),
        |row| terms(row, beta(row)),
    );
    relative("x_dsim16b", |row| separation(row, -1.0, beta(row)));
}

#[test]
fn equation_17_adds_speeds() {
    check(
        "eq17",
        |row| composed_speed(row.number("bi"), row.number("bj")),
        |row| row.number("bi").abs(),
    );
}

#[test]
fn the_exact_relative_velocity_subtracts_speeds() {
    check(
        "x_rel17",
        |row| {
            let [i, j] = ["bi", "bj"].map(|column| velocity(row.number(column)));
            j.relative_to(i).unwrap().beta().z
        },
        |row| row.number("bi").abs(),
    );
}

#[test]
fn the_doppler_factor_is_the_wavelength_ratio_of_the_opposite_look_direction() {
    relative("eq2_D", |row| {
        // Light that propagates at θ′ is seen in the opposite direction.
        let angle = row.number("thetap");
        let look = -DVec3::new(angle.sin(), 0.0, angle.cos());
        let look = Direction::<CameraFrame>::new(look).unwrap();
        Boost::<World, CameraFrame>::new(velocity(beta(row)))
            .direction(look)
            .1
    });
}

#[test]
fn the_exact_emission_time_and_distance_are_those_of_a_lorentz_transformation() {
    let frame = |row: &Row| InertialFrame::<Rest>::new(velocity(beta(row)), Event::ORIGIN);
    let camera = |row: &Row| Event::<Rest>::new(row.number("tp"), DVec3::ZERO);
    check(
        "x_temit",
        |row| frame(row).event_to_world(camera(row)).ct - row.number("eta") * row.number("z"),
        |row| row.number("tp").abs(),
    );
    relative("x_zcam", |row| {
        let theta = world_angle(beta(row), row.number("thetap"));
        let look = Direction::<World>::new(-DVec3::new(theta.sin(), 0.0, theta.cos()));
        let ray = frame(row).ray_from_world(Event::ORIGIN, look.unwrap(), 1.0);
        ray.at(row.number("z")).x.length()
    });
}
