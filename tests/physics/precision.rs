//! Boosts at every accepted rapidity, against 320-bit arithmetic.
//!
//! A rounding error of one eps = 2⁻⁵³ in the direction n of motion, in the rapidity φ or in the look direction d′ has unavoidable
//! consequences. The tolerances are 16 times these.

use crate::common::exact::{
    Exact, ExactBoost, Four, difference, distance, exact, four, look, rounded,
};
use crate::common::worst::{EPS, Worst};
use glam::DVec3;
use nullray::spacetime::{
    Boost, CameraFrame, Direction, Displacement, MAX_RAPIDITY, Rest, Velocity, World,
};

use crate::common::sequence::Sequence;

impl Sequence {
    fn pick<const N: usize>(&mut self, choices: [f64; N]) -> f64 {
        choices[(self.next() * N as f64) as usize]
    }

    fn rapidity(&mut self) -> f64 {
        let (slow, any) = (self.scale(1e-15, 0.5), MAX_RAPIDITY * self.next());
        self.pick([slow, any, 19.0 * any / MAX_RAPIDITY, 19.0, MAX_RAPIDITY])
    }

    /// A unit vector at an angle of 1e-18 to 1 to `n` or to −n, or anywhere, or ±n itself.
    fn near(&mut self, n: DVec3) -> DVec3 {
        let axis = n * self.pick([1.0, 1.0, 1.0, -1.0]);
        let angle = self.scale(1e-18, 1.0);
        let tilted = axis + self.unit().cross(n).normalize() * angle;
        let kind = self.next();
        if kind < 0.1 {
            axis
        } else if kind < 0.3 {
            self.unit()
        } else {
            tilted
        }
    }
}

/// A velocity and a look direction, and what the light-cone coordinates of (−η, d′) are made of.
struct Case {
    velocity: Velocity,
    d: DVec3,
    phi: f64,
    one_plus: f64,
    one_minus: f64,
    sine: f64,
}

impl Case {
    fn new(velocity: Velocity, d: DVec3) -> Self {
        let (phi, n) = (
            velocity.rapidity().length(),
            velocity.rapidity().normalize(),
        );
        let sine = n.cross(d).length();
        let small = sine * sine / (1.0 + n.dot(d).abs());
        let ahead = n.dot(d) > 0.0;
        Case {
            velocity,
            d,
            phi,
            one_plus: if ahead { 2.0 - small } else { small },
            one_minus: if ahead { small } else { 2.0 - small },
            sine,
        }
    }

    fn random(sequence: &mut Sequence) -> Self {
        let n = sequence.unit();
        let velocity = Velocity::from_rapidity_along(sequence.rapidity(), n).unwrap();
        let d = sequence.near(velocity.rapidity().normalize());
        Case::new(velocity, Direction::<CameraFrame>::new(d).unwrap().unit())
    }

    fn direction(&self) -> Direction<CameraFrame> {
        Direction::new(self.d).unwrap()
    }

    fn world_from_camera(&self) -> Boost<World, CameraFrame> {
        Boost::new(self.velocity)
    }

    fn reference(&self, v: &Four) -> Four {
        ExactBoost::new(self.velocity.rapidity()).apply(v)
    }

    fn label(&self) -> String {
        format!("w {:?}, d′ {:?}", self.velocity.rapidity(), self.d)
    }

    /// What rounding does to ½ e^±φ (t ± x∥) of (−η, d′): rapidity enters as e^φ, and 1 ∓ c∥ changes by
    /// sin(angle) per radian, to second order too: ahead at φ above 36 that is all there is. Rounding
    /// 1 − η costs one eps of it.
    fn tangent_error(&self, index: f64) -> f64 {
        let slow = (1.0 - index).abs();
        let turned = self.sine + 16.0 * EPS;
        let plus = (1.0 + self.phi) * (slow + self.one_minus) + turned;
        let minus = (1.0 + self.phi) * (slow + self.one_plus) + turned;
        0.5 * EPS * (self.phi.exp() * plus + (-self.phi).exp() * minus)
    }
}

#[test]
fn light_paths_keep_their_digits_at_every_rapidity_angle_and_refractive_index() {
    let [mut time, mut space] = std::array::from_fn(|_| Worst::default());
    let mut sequence = Sequence(1);
    for _ in 0..4000 {
        let case = Case::random(&mut sequence);
        let any = 3.0 * sequence.next();
        let index = sequence.pick([0.0, 1.0, 1.0, 1.5, any]);
        let tangent = case.world_from_camera().tangent(index, case.direction());
        let mut start = look(case.d);
        start[0] = exact(-index);
        let reference = case.reference(&start);
        let allowed = 16.0 * case.tangent_error(index);
        let place = || format!("η {index}, {}", case.label());
        time.note(difference(tangent.ct, &reference[0]), allowed, place);
        // d⊥ moves by eps, and the longitudinal part turns with n.
        let allowed = allowed + 16.0 * EPS * (1.0 + rounded(&reference[0]).abs());
        space.note(distance(tangent.x, &reference), allowed, place);
    }
    time.assert_within("time");
    space.assert_within("space");
}

#[test]
fn the_tangent_of_a_light_path_is_the_boosted_displacement() {
    // The general boost of (−η, d) loses e^φ eps; the tangent must agree with it within that.
    let mut worst = Worst::default();
    let mut sequence = Sequence(2);
    for _ in 0..20_000 {
        let case = Case::random(&mut sequence);
        let any = 3.0 * sequence.next();
        let index = sequence.pick([0.0, 1.0, 1.5, any]);
        let boost = case.world_from_camera();
        let tangent = boost.tangent(index, case.direction());
        let general = boost.displacement(Displacement::new(-index, case.d));
        let allowed = 8.0 * f64::EPSILON * case.phi.exp() * (1.0 + index);
        let error = (tangent.ct - general.ct).abs() + (tangent.x - general.x).length();
        worst.note(error, allowed, || format!("η {index}, {}", case.label()));
    }
    worst.assert_within("tangent");
}

#[test]
fn look_directions_keep_their_digits_at_every_rapidity_and_stay_unit_vectors() {
    let [mut ratio, mut direction, mut length] = std::array::from_fn(|_| Worst::default());
    let mut sequence = Sequence(3);
    for _ in 0..4000 {
        let case = Case::random(&mut sequence);
        let (d, w) = case.world_from_camera().direction(case.direction());
        let [t, x, y, z] = case.reference(&look(case.d));
        let w_reference = -&t;
        let unit = [t, x / &w_reference, y / &w_reference, z / &w_reference];
        // Ratio: see tangent_error. Direction: a conformal map of scale 1/W, turned with n.
        let allowed = 16.0 * case.tangent_error(1.0);
        ratio.note(difference(w, &w_reference), allowed, || case.label());
        let allowed = 16.0 * EPS * (1.0 + case.phi + 1.0 / rounded(&w_reference));
        direction.note(distance(d.unit(), &unit), allowed, || case.label());
        // A few eps² along n are left in d⊥, over W: nothing below φ = 33.
        let allowed = 8.0 * EPS * (1.0 + 8.0 * EPS / w);
        length.note(d.unit().length() - 1.0, allowed, || case.label());
        // By e^−φ ≤ W ≤ e^φ, to the digits of e^φ.
        let edge = case.phi.exp() * (1.0 + 8.0 * EPS * (1.0 + case.phi));
        assert!(w <= edge && w >= 1.0 / edge, "W = {w}, {}", case.label());
    }
    ratio.assert_within("ratio");
    direction.assert_within("direction");
    length.assert_within("length of the direction");
}

#[test]
fn along_an_axis_no_digit_is_lost_at_any_angle() {
    // n and the transverse part of d′ are exact here, so that rapidity alone is left: W to
    // 16 eps (1 + φ), relative, at every angle. γ(1 − β cos) would lose all of it ahead.
    let mut worst = Worst::default();
    let mut sequence = Sequence(4);
    for _ in 0..2000 {
        let phi = sequence.rapidity();
        let sign = sequence.pick([1.0, -1.0]);
        let velocity = Velocity::from_rapidity(DVec3::new(0.0, 0.0, phi * sign)).unwrap();
        let angle = sequence.scale(1e-25, 1.0);
        let case = Case::new(velocity, DVec3::new(angle, -0.5 * angle, 1.0).normalize());
        let tangent = case.world_from_camera().tangent(1.0, case.direction());
        let (_, w) = case.world_from_camera().direction(case.direction());
        let reference = -&case.reference(&look(case.d))[0];
        let allowed = 16.0 * EPS * (1.0 + phi) * rounded(&reference);
        worst.note(difference(w, &reference), allowed, || case.label());
        worst.note(difference(-tangent.ct, &reference), allowed, || {
            case.label()
        });
    }
    worst.assert_within("ratio");
}

#[test]
fn displacements_keep_their_digits_at_every_rapidity() {
    // 32 eps (1 + φ) times the sum of the absolute values of a component's terms:
    // γ|t| + γβ Σ|n_j x_j|, and |x_i| + (γ − 1)|n_i| Σ|n_j x_j| + γβ|n_i t|.
    let mut worst = Worst::default();
    let mut sequence = Sequence(5);
    for _ in 0..4000 {
        let case = Case::random(&mut sequence);
        let x = case.d * sequence.scale(1e-9, 1e9);
        let any = sequence.scale(1e-9, 1e9);
        // Unrelated, simultaneous, null, nearly null, nearly at rest in the boosted frame.
        let nearly = 1.0 + sequence.scale(1e-16, 1e-3);
        let rest = -x.length() / case.phi.tanh();
        let t = sequence.pick([any, 0.0, x.length(), x.length() * nearly, rest * nearly]);
        let got = case
            .world_from_camera()
            .displacement(Displacement::new(t, x));
        let reference = case.reference(&four(t, x));
        let n = case.velocity.rapidity().normalize().abs();
        let (gamma, sinh) = (case.velocity.gamma(), case.phi.sinh());
        let along = n.dot(x.abs());
        let spatial = case.velocity.gamma_minus_one() * along + sinh * t.abs();
        let allowed = 32.0 * EPS * (1.0 + case.phi);
        let terms = gamma * t.abs() + sinh * along;
        let place = || format!("t {t:?}, x {x:?}, {}", case.label());
        worst.note(difference(got.ct, &reference[0]), allowed * terms, place);
        for axis in 0..3 {
            let terms = x[axis].abs() + n[axis] * spatial;
            let error = difference(got.x[axis], &reference[axis + 1]);
            worst.note(error, allowed * terms, place);
        }
    }
    worst.assert_within("displacement");
}

#[test]
fn a_null_displacement_along_an_axis_stays_null_at_the_largest_rapidity() {
    let velocity = Velocity::from_rapidity(DVec3::Z * MAX_RAPIDITY).unwrap();
    let boost = Boost::<World, CameraFrame>::new(velocity);
    for (sign, factor) in [(1.0, MAX_RAPIDITY), (-1.0, -MAX_RAPIDITY)] {
        let light = boost.displacement(Displacement::new(3.0, DVec3::Z * 3.0 * sign));
        assert_eq!(light.ct, light.x.z * sign);
        assert!((light.ct / (3.0 * libm::exp(factor)) - 1.0).abs() < 4.0 * EPS);
    }
}

#[test]
fn two_boosts_in_a_row_give_the_exact_wavelength_ratio() {
    // Camera → world → rest frame. The second ratio moves by sinh φ₂ per radian of d, d by eps/W₁.
    let mut worst = Worst::default();
    let mut sequence = Sequence(6);
    for _ in 0..2000 {
        let [w1, w2] = std::array::from_fn(|_| sequence.unit() * (6.0 * sequence.next()));
        let [v1, v2] = [w1, w2].map(|w| Velocity::from_rapidity(w).unwrap());
        let camera = Direction::new(sequence.near(w1.normalize())).unwrap();
        let (world, first) = Boost::<World, CameraFrame>::new(v1).direction(camera);
        let (_, second) = Boost::<World, Rest>::new(v2).inverse().direction(world);
        let null = ExactBoost::new(w1).apply(&look(camera.unit()));
        let ratio: Exact = -&ExactBoost::new(-w2).apply(&null)[0];
        let (a, b) = (w1.length(), w2.length());
        let turned = 1.0 + a + 1.0 / first;
        let slope = a.sinh() / first + b.sinh() / second * turned;
        let allowed = 16.0 * EPS * (1.0 + a + b + slope) * rounded(&ratio);
        worst.note(difference(first * second, &ratio), allowed, || {
            format!("w {w1:?}, {w2:?}, d′ {camera:?}")
        });
    }
    worst.assert_within("ratio of two boosts");
}

#[test]
fn relative_velocities_keep_their_digits() {
    // γ′β′ = Λ(−w₂)(γ, γβ): in the observer's frame, rounding a rapidity moves γ′β′ by γ′ eps φ, and
    // turning n by eps moves it by eps sinh φ, times cosh ψ sin(angle) along the motion.
    let mut worst = Worst::default();
    let mut sequence = Sequence(7);
    for _ in 0..4000 {
        let n = sequence.unit();
        let psi = sequence.rapidity().min(19.0);
        let observer = Velocity::from_rapidity_along(psi, n).unwrap();
        let phi = psi * sequence.pick([1.0, 0.5, 0.999_999]);
        let velocity = Velocity::from_rapidity_along(phi, sequence.near(n)).unwrap();
        let seen = velocity.relative_to(observer).unwrap().rapidity();
        let own = four(1.0, DVec3::ZERO);
        let in_world = ExactBoost::new(velocity.rapidity()).apply(&own);
        let reference = ExactBoost::new(-observer.rapidity()).apply(&in_world);
        let proper = seen.normalize_or_zero() * seen.length().sinh();
        let sine = n.cross(velocity.rapidity().normalize()).length();
        let turned = phi.sinh() * (1.0 + psi.cosh() * sine);
        let gamma = rounded(&reference[0]);
        let allowed = 16.0 * EPS * ((phi + psi) * gamma + turned);
        worst.note(distance(proper, &reference), allowed, || {
            format!("{velocity:?} from {observer:?}")
        });
    }
    worst.assert_within("relative velocity");
}
