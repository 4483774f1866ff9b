//! The spacetime core against reference vectors of arbitrary precision.
//!
//! tests/data/physics/README.md describes the data and the tolerances, which are the limits that the
//! conditioning of each problem sets to f64.

use crate::common::table::{Row, rows};
use crate::common::worst::{EPS, Worst};
use glam::DVec3;
use nullray::spacetime::{
    Boost, CameraFrame, Direction, Event, Frame, InertialFrame, Quantity, Velocity,
    WavelengthRatio, World,
};

fn velocity(row: &Row) -> Velocity {
    Velocity::from_rapidity(row.vector("w")).unwrap()
}

fn event<F: Frame>(row: &Row, prefix: &str) -> Event<F> {
    Event::new(row.number(&format!("{prefix}ct")), row.vector(prefix))
}

fn direction<F: Frame>(row: &Row, prefix: &str) -> Direction<F> {
    Direction::new(row.vector(prefix)).unwrap()
}

/// |got − column| ≤ 32 eps (1 + |w|) s for each of the four components.
fn note_event<F: Frame>(worst: &mut Worst, row: &Row, got: Event<F>, prefix: &str) {
    let reference: Event<F> = event(row, prefix);
    let terms: Event<F> = event(row, &format!("s_{prefix}"));
    let allowed = 32.0 * EPS * (1.0 + row.vector("w").length());
    let mut note = |got: f64, reference: f64, terms: f64, name| {
        worst.note(got - reference, allowed * terms, || {
            format!("line {}, {name}: {got:e} for {reference:e}", row.line)
        });
    };
    note(got.ct, reference.ct, terms.ct, "ct");
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        note(got.x[axis], reference.x[axis], terms.x[axis], name);
    }
}

#[test]
fn events_of_a_moving_frame_become_events_of_the_world() {
    let mut worst = Worst::default();
    let table = rows("boosts.csv");
    assert_eq!(table.len(), 400);
    for row in &table {
        let frame = InertialFrame::<CameraFrame>::new(velocity(row), event(row, "O"));
        note_event(&mut worst, row, frame.event_to_world(event(row, "p")), "e");
    }
    worst.assert_within("frame to world");
}

#[test]
fn events_of_the_world_become_events_of_a_moving_frame() {
    let mut worst = Worst::default();
    for row in &rows("boosts.csv") {
        let frame = InertialFrame::<CameraFrame>::new(velocity(row), event(row, "O"));
        note_event(
            &mut worst,
            row,
            frame.event_from_world(event(row, "f")),
            "q",
        );
    }
    worst.assert_within("world to frame");
}

#[test]
fn gamma_and_gamma_minus_one_follow_from_rapidity() {
    // d(cosh φ)/cosh φ ≤ φ dφ/φ, and d(γ − 1)/(γ − 1) = φ coth(φ/2) dφ/φ ≤ (2 + φ) dφ/φ.
    let mut worst = Worst::default();
    for row in rows("boosts.csv").iter().chain(&rows("rays.csv")) {
        let v = velocity(row);
        let allowed = 8.0 * EPS * (1.0 + row.vector("w").length());
        for (got, column) in [(v.gamma(), "gamma"), (v.gamma_minus_one(), "gm1")] {
            let reference = row.number(column);
            worst.note(got - reference, allowed * reference, || {
                format!("line {}, {column}: {got:e} for {reference:e}", row.line)
            });
        }
    }
    worst.assert_within("gamma");
}

/// The errors of a boosted look direction and its frequency ratio.
///
/// The ratio R(d′) changes with the angle to ±n by sinh|w| sin(angle) per radian, and rapidity enters
/// through e^±|w|: relative error 16 eps (1 + |w| + sinh|w| sin(angle)/R).
///
/// The direction d(d′) is a conformal map of scale 1/R (|d⊥| R = |d′⊥|), so rounding d′ or n moves d
/// by eps/R; rounding n turns both spheres, by eps more; rapidity moves it by sin θ d|w| ≤ eps |w|.
struct RayError<'a> {
    row: &'a Row,
    sine: f64,
    got: (DVec3, f64),
    reference: (DVec3, f64),
}

impl RayError<'_> {
    fn note(&self, ratio: &mut Worst, direction: &mut Worst, length: &mut Worst) {
        let (d, r) = self.got;
        let (d_reference, r_reference) = self.reference;
        let rapidity = self.row.vector("w").length();
        let line = self.row.line;
        let slope = rapidity.sinh() * self.sine / r_reference;
        let allowed = 16.0 * EPS * (1.0 + rapidity + slope);
        ratio.note(r / r_reference - 1.0, allowed, || {
            format!("line {line}: {r:e} for {r_reference:e}")
        });
        let allowed = 16.0 * EPS * (1.0 + rapidity + 1.0 / r_reference);
        direction.note((d - d_reference).length(), allowed, || {
            format!("line {line}: {d} for {d_reference}")
        });
        length.note(d.length() - 1.0, 8.0 * EPS, || format!("line {line}: {d}"));
    }
}

fn check_rays(what: &str, error: impl Fn(&Row) -> RayError<'_>) {
    let [mut ratio, mut direction, mut length] = std::array::from_fn(|_| Worst::default());
    let table = rows("rays.csv");
    assert_eq!(table.len(), 600);
    for row in &table {
        error(row).note(&mut ratio, &mut direction, &mut length);
    }
    ratio.assert_within(&format!("{what}, ratio"));
    direction.assert_within(&format!("{what}, direction"));
    length.assert_within(&format!("{what}, length of the direction"));
}

#[test]
fn look_directions_of_the_camera_become_directions_of_the_world() {
    check_rays("camera to world", |row| {
        let world_from_camera = Boost::<World, CameraFrame>::new(velocity(row));
        let (d, w) = world_from_camera.direction(direction(row, "dp"));
        RayError {
            row,
            sine: row.number("ang").sin(),
            got: (d.unit(), w),
            reference: (row.vector("d"), row.number("W")),
        }
    });
}

#[test]
fn ratios_near_1_keep_the_digits_of_their_difference_from_it() {
    // W − 1 is right to what W is, 16 eps (1 + |w| + sinh|w| sin(ang)/W) W, and to the rounding of both differences.
    let mut worst = Worst::default();
    for row in &rows("rays.csv") {
        let (_, w) =
            Boost::<World, CameraFrame>::new(velocity(row)).direction(direction(row, "dp"));
        let (rapidity, ratio) = (row.vector("w").length(), row.number("W"));
        let slope = rapidity.sinh() * row.number("ang").sin() / ratio;
        let difference = row.number("Wm1");
        let allowed = 16.0 * EPS * (1.0 + rapidity + slope) * ratio + 2.0 * EPS * difference.abs();
        worst.note((w - 1.0) - difference, allowed, || {
            format!("line {}", row.line)
        });
    }
    worst.assert_within("W − 1");
}

#[test]
fn look_directions_of_the_world_become_directions_of_the_camera() {
    check_rays("world to camera", |row| {
        let camera_from_world = Boost::<World, CameraFrame>::new(velocity(row)).inverse();
        let (q, ratio) = camera_from_world.direction(direction(row, "q"));
        RayError {
            row,
            sine: sine_to_motion(row, "q"),
            got: (q.unit(), ratio),
            reference: (row.vector("qp"), 1.0 / row.number("Wq")),
        }
    });
}

/// sin of the angle between a direction of the row and w.
fn sine_to_motion(row: &Row, prefix: &str) -> f64 {
    let n = row.vector("w").normalize_or(DVec3::X);
    n.cross(row.vector(prefix).normalize()).length()
}

#[test]
fn in_vacuum_the_tangent_of_a_light_path_is_the_boosted_null_vector() {
    let [mut time, mut space] = std::array::from_fn(|_| Worst::default());
    for row in &rows("rays.csv") {
        let world_from_camera = Boost::<World, CameraFrame>::new(velocity(row));
        let tangent = world_from_camera.tangent(1.0, direction(row, "dp"));
        let (d, w) = (row.vector("d"), row.number("W"));
        let rapidity = row.vector("w").length();
        let slope = rapidity.sinh() * row.number("ang").sin() / w;
        let allowed = 16.0 * EPS * (1.0 + rapidity + slope) * w;
        let place = || format!("line {}: {tangent:?}", row.line);
        time.note(tangent.ct + w, allowed, place);
        // W d: the errors of both, that of d being 16 eps (1 + |w| + 1/W).
        let allowed = allowed + 16.0 * EPS * (w * (1.0 + rapidity) + 1.0);
        space.note((tangent.x - d * w).length(), allowed, place);
    }
    time.assert_within("−W");
    space.assert_within("W d");
}

/// The radiance columns of each quantity, and the columns of its exposure (where there is one).
const QUANTITIES: [(Quantity, &str, Option<&str>); 7] = [
    (Quantity::PerWavelength, "f_Llambda", Some("h_lambda")),
    (Quantity::PerFrequency, "f_Lnu", Some("h_nu")),
    (Quantity::Integrated, "f_bol", Some("h_bol")),
    (
        Quantity::Line { wavelength: 633e-9 },
        "f_bol",
        Some("h_bol"),
    ),
    (Quantity::Photons, "f_photon", Some("h_photon")),
    (Quantity::PhotonsPerWavelength, "f_photon_lambda", None),
    (Quantity::PhotonsPerFrequency, "f_photon_nu", None),
];

#[test]
fn every_quantity_has_its_own_radiance_and_exposure_and_irradiance_factor() {
    let mut worst = Worst::default();
    let table = rows("radiance.csv");
    assert_eq!(table.len(), 200);
    for row in &table {
        let w = WavelengthRatio(row.number("W"));
        for (quantity, radiance, exposure) in QUANTITIES {
            let f = row.number(radiance);
            let h = exposure.map_or(f / row.number("f_rate"), |column| row.number(column));
            for (got, reference) in [
                (quantity.radiance_factor(w), f),
                (quantity.exposure_factor(w), h),
                (quantity.irradiance_factor(w), f * row.number("f_solid")),
            ] {
                worst.note(got / reference - 1.0, 16.0 * EPS, || {
                    format!("line {}, {quantity:?}: {got:e} for {reference:e}", row.line)
                });
            }
        }
    }
    worst.assert_within("factors");
}

// Exact by the definition of the SI.
const H: f64 = 6.626_070_15e-34;
const C: f64 = 299_792_458.0;
const K: f64 = 1.380_649e-23;

/// Planck's radiance per wavelength, W m⁻³ sr⁻¹.
fn planck(wavelength: f64, temperature: f64) -> f64 {
    let x = H * C / (wavelength * K * temperature);
    2.0 * H * C * C / (wavelength.powi(5) * x.exp_m1())
}

/// σT⁴/π with σ = 2π⁵k⁴/(15 h³c²), W m⁻² sr⁻¹; in factors that do not underflow.
fn bolometric(temperature: f64) -> f64 {
    let kt_hc = K * temperature / (H * C);
    2.0 * std::f64::consts::PI.powi(4) / 15.0 * kt_hc.powi(4) * H * C * C
}

#[test]
fn a_boosted_blackbody_is_a_blackbody_of_temperature_t_over_w() {
    let mut worst = Worst::default();
    let table = rows("blackbody.csv");
    assert_eq!(table.len(), 200);
    for row in &table {
        let (t, observed) = (row.number("T"), row.number("lambdap"));
        let w = WavelengthRatio(row.number("W"));
        let emitted = observed / w.0;
        let per_wavelength = planck(emitted, t);
        let per_frequency = per_wavelength * (emitted * emitted / C);
        let seen = Quantity::PerWavelength.radiance_factor(w) * per_wavelength;
        for (got, column) in [
            (seen, "B_resc"),
            (seen, "B_temp"),
            (planck(observed, t / w.0), "B_temp"),
            (
                Quantity::PerFrequency.radiance_factor(w) * per_frequency,
                "Lnu",
            ),
            (
                Quantity::Integrated.radiance_factor(w) * bolometric(t),
                "bol",
            ),
        ] {
            let reference = row.number(column);
            let allowed = 32.0 * EPS * (1.0 + row.number("x"));
            worst.note(got / reference - 1.0, allowed, || {
                format!("line {}, {column}: {got:e} for {reference:e}", row.line)
            });
        }
    }
    worst.assert_within("Planck");
}
