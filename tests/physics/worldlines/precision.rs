//! Hyperbolic motion at gτ from 1e-12 to 30, in both directions of time, against 320-bit arithmetic.
//!
//! One ulp is that of f64 at the largest coordinate involved. The reference solves T − t = |X − x| for τ by
//! Newton's method in the textbook's form; it shares no formula with the crate.

use glam::DVec3;
use nullray::spacetime::worldline::WorldLine;
use nullray::spacetime::{Displacement, Event, Velocity, World};

use crate::common::exact::{Exact, ExactBoost, Four, difference, exact, four, rounded};
use crate::common::worst::Worst;
use crate::worldlines::lines::{Sequence, largest, length, size};

/// Four units in the last place of 1, times `scale`.
fn ulps(scale: f64) -> f64 {
    4.0 * f64::EPSILON * scale
}

/// A hyperbola in its comoving frame at τ = 0.
struct Hyperbola {
    g: Exact,
    n: [Exact; 3],
}

impl Hyperbola {
    fn new(a: DVec3) -> Self {
        let [_, x, y, z] = four(0.0, a);
        let g = (&x * &x + &y * &y + &z * &z).sqrt();
        let n = [x / &g, y / &g, z / &g];
        Hyperbola { g, n }
    }

    /// Event and four-velocity at τ.
    fn at(&self, tau: &Exact) -> [Four; 2] {
        let (up, down) = ((&self.g * tau).exp(), (-&self.g * tau).exp());
        let (cosh, sinh) = ((&up + &down) / exact(2.0), (up - down) / exact(2.0));
        let along = (&cosh - exact(1.0)) / &self.g;
        let [x, y, z] = &self.n;
        [
            [&sinh / &self.g, x * &along, y * &along, z * along],
            [cosh, x * &sinh, y * &sinh, z * sinh],
        ]
    }

    /// T − t − |X − x| at τ, and its derivative.
    fn delay_left(&self, apex: &Four, tau: &Exact) -> [Exact; 2] {
        let [event, u] = self.at(tau);
        let left: Four = std::array::from_fn(|i| &apex[i] - &event[i]);
        let dot = |v: &Four| &left[1] * &v[1] + &left[2] * &v[2] + &left[3] * &v[3];
        let distance = dot(&left).sqrt();
        let closing = dot(&u) / &distance;
        [&left[0] - distance, closing - &u[0]]
    }

    /// The crossing with the past light cone of `apex`, from a guess of its proper time: Newton's method,
    /// kept within a bracket, as the slope jumps where the line passes close by.
    fn crossing(&self, apex: &Four, guess: f64) -> (Four, Exact) {
        let mut tau = exact(guess);
        let zero = exact(0.0);
        let later = self.delay_left(apex, &tau)[0] > zero;
        let mut width = exact(if later { 1e-18 } else { -1e-18 }) / &self.g;
        let mut beyond = &tau + &width;
        while (self.delay_left(apex, &beyond)[0] > zero) == later {
            width *= exact(16.0);
            beyond = &tau + &width;
        }
        let (mut low, mut high) = if later {
            (tau.clone(), beyond)
        } else {
            (beyond, tau.clone())
        };
        for _ in 0..300 {
            let [value, slope] = self.delay_left(apex, &tau);
            let newton = &tau - &value / slope;
            if value > zero {
                low = tau
            } else {
                high = tau
            }
            let middle = (&low + &high) / exact(2.0);
            tau = if newton > low && newton < high {
                newton
            } else {
                middle
            };
            let left = rounded(&(&high - &tau))
                .abs()
                .min(rounded(&(&tau - &low)).abs());
            if left < 1e-25 * rounded(&tau).abs() {
                break;
            }
        }
        (self.at(&tau)[0].clone(), tau)
    }
}

fn error(got: Event<World>, reference: &Four) -> f64 {
    difference(got.ct, &reference[0])
        .abs()
        .max(aside(got.x, reference))
}

/// The largest error of a component.
fn aside(got: DVec3, reference: &Four) -> f64 {
    largest(DVec3::from_array(
        [0, 1, 2].map(|i| difference(got[i], &reference[i + 1])),
    ))
}

/// g, and gτ.
fn motion(sequence: &mut Sequence) -> (f64, f64) {
    let g = sequence.scale(1e-6, 1e6);
    let small = sequence.scale(1e-12, 30.0);
    let any = 30.0 * sequence.next();
    let a = if sequence.next() < 0.5 { small } else { any };
    (g, sequence.sign() * a)
}

#[test]
fn states_are_right_to_four_ulp_in_every_direction() {
    let [mut place, mut way, mut rapidity] = std::array::from_fn(|_| Worst::default());
    let mut sequence = Sequence(1);
    for _ in 0..3000 {
        let (g, phi) = motion(&mut sequence);
        let (a, tau) = (sequence.unit() * g, phi / g);
        let line = WorldLine::hyperbolic(Velocity::REST, Event::ORIGIN, a).unwrap();
        let state = line.state(tau).unwrap();
        let [reference, _] = Hyperbola::new(a).at(&exact(tau));
        let label = || format!("a {a:?}, τ {tau}");
        place.note(
            error(state.event, &reference),
            ulps(size(state.event)),
            label,
        );
        // The way along a, which is quadratic in a small gτ, to eight of its own.
        let along = largest(state.event.x);
        way.note(aside(state.event.x, &reference), 2.0 * ulps(along), label);
        let exact_phi = rounded(&(Hyperbola::new(a).g * exact(tau)));
        let w = state.velocity.rapidity().dot(a.normalize());
        rapidity.note(w - exact_phi, ulps(exact_phi.abs()), label);
    }
    place.assert_within("event");
    way.assert_within("way");
    rapidity.assert_within("rapidity");
}

#[test]
fn crossings_are_right_to_four_ulp_of_the_largest_coordinate() {
    // Along an axis no input is rounded: the acceleration is (g, 0, 0) or the like, and at rest nothing
    // is boosted.
    let [mut place, mut time] = std::array::from_fn(|_| Worst::default());
    let mut sequence = Sequence(2);
    let axes = [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        DVec3::NEG_X,
        DVec3::NEG_Y,
        DVec3::NEG_Z,
    ];
    let mut met = 0;
    for number in 0..2000 {
        let (g, phi) = motion(&mut sequence);
        let a = axes[number % 6] * g;
        let apex = seen_at(a, phi / g, &mut sequence);
        let line = WorldLine::hyperbolic(Velocity::REST, Event::ORIGIN, a).unwrap();
        let near = line.state(0.0).unwrap();
        let Some(crossing) = line.on_past_light_cone(&near, apex) else {
            // Rounding the apex has moved it beyond the horizon.
            assert!(phi < -17.0, "gτ = {phi}");
            continue;
        };
        met += 1;
        let (reference, exact_tau) =
            Hyperbola::new(a).crossing(&four(apex.ct, apex.x), crossing.proper_time());
        let scale = length(crossing.displacement).max(length(apex));
        let label = || format!("a {a:?}, gτ {phi}, apex {apex:?}");
        place.note(error(crossing.event, &reference), ulps(scale), label);
        let gamma = (g * rounded(&exact_tau)).cosh();
        let allowed = ulps(scale / gamma).max(ulps(rounded(&exact_tau).abs()));
        time.note(
            difference(crossing.proper_time(), &exact_tau),
            allowed,
            label,
        );
    }
    assert!(met > 1700, "{met}");
    place.assert_within("event");
    time.assert_within("proper time");
}

/// An event that light from near proper time `tau` comes to, rounded.
fn seen_at(a: DVec3, tau: f64, sequence: &mut Sequence) -> Displacement<World> {
    let g = a.length();
    let source = WorldLine::hyperbolic(Velocity::REST, Event::ORIGIN, a).unwrap();
    let source = source.state(tau).unwrap().event;
    let distance = sequence.scale(1e-6, 1e6) / g;
    let ahead = a / g * sequence.sign();
    let toward = if sequence.next() < 0.4 {
        ahead
    } else {
        sequence.unit()
    };
    Displacement::new(source.ct + distance, source.x + toward * distance)
}

#[test]
fn oblique_and_moving_crossings_lose_no_more_than_rounding_takes() {
    // Rounding n, φ and the boost moves the apex by eps e^φ₀ (1 + φ₀) of its size in the comoving frame, and
    // the crossing by γ/(k·u) of that.
    let mut worst = Worst::default();
    let mut sequence = Sequence(3);
    for _ in 0..2000 {
        let g = sequence.scale(1e-3, 1e3);
        let a = sequence.unit() * g;
        let w = sequence.unit() * sequence.scale(1e-6, 5.0);
        let velocity = Velocity::from_rapidity(w).unwrap();
        let line = WorldLine::hyperbolic(velocity, Event::ORIGIN, a).unwrap();
        let near = line.state(0.0).unwrap();
        let offset = Displacement::new(
            0.0,
            sequence.unit() * (sequence.scale(1e-9, 0.4) / g * (-w.length()).exp()),
        );
        let crossing = line.on_past_light_cone(&near, offset).unwrap();
        let hyperbola = Hyperbola::new(a);
        let apex = ExactBoost::new(-w).apply(&four(offset.ct, offset.x));
        let (event, _) = hyperbola.crossing(&apex, crossing.proper_time());
        let reference = ExactBoost::new(w).apply(&event);
        let growth = (2.0 * w.length()).exp() * (2.0 + 2.0 * w.length());
        let allowed = ulps(length(offset).max(length(crossing.displacement))) * growth;
        let moved = Event::ORIGIN + crossing.displacement;
        worst.note(error(moved, &reference), allowed, || {
            format!("a {a:?}, w {w:?}, {offset:?}")
        });
    }
    worst.assert_within("displacement");
}

#[test]
fn a_state_with_an_initial_velocity_is_the_boosted_hyperbola() {
    let [mut place, mut speed] = std::array::from_fn(|_| Worst::default());
    let mut sequence = Sequence(4);
    for _ in 0..1500 {
        let (w, a) = (sequence.unit() * (8.0 * sequence.next()), sequence.unit());
        let tau = 10.0 * (2.0 * sequence.next() - 1.0);
        let velocity = Velocity::from_rapidity(w).unwrap();
        let line = WorldLine::hyperbolic(velocity, Event::ORIGIN, a).unwrap();
        let state = line.state(tau).unwrap();
        let boost = ExactBoost::new(w);
        let [event, u] = Hyperbola::new(a).at(&exact(tau)).map(|v| boost.apply(&v));
        let label = || format!("w {w:?}, a {a:?}, τ {tau}");
        // As for any boosted displacement: eps (1 + φ) of the terms.
        let terms = w.length().exp() * tau.abs().sinh() * (2.0 + w.length());
        place.note(error(state.event, &event), ulps(terms), label);
        let (gamma, proper) = crate::worldlines::lines::four_velocity(&state);
        let error = difference(gamma, &u[0]).abs().max(aside(proper, &u));
        let terms = w.length().exp() * tau.abs().exp() * (1.0 + w.length() + tau.abs());
        speed.note(error, ulps(terms), label);
    }
    place.assert_within("event");
    speed.assert_within("four-velocity");
}

#[test]
fn a_tiny_offset_keeps_its_digits_far_from_the_origin() {
    // A sensor a nanometre behind a pinhole that is a light-year from the origin: its light left the
    // pinhole a nanometre before, and moved on by gd²/2 = 5e-19 m is below rounding.
    let far = Event::new(3e15, DVec3::new(9e15, -2e15, 4e15));
    let line = WorldLine::hyperbolic(Velocity::REST, far, DVec3::Y).unwrap();
    let near = line.state(0.0).unwrap();
    let d = 1e-9;
    let crossing = line
        .on_past_light_cone(&near, Displacement::new(0.0, DVec3::X * d))
        .unwrap();
    let Displacement { ct, x, .. } = crossing.displacement;
    assert!((ct + d).abs() < 1e-15 * d, "{ct}");
    assert!((x.y - 0.5 * d * d).abs() < 1e-8 * 0.5 * d * d, "{x}");
    assert!((crossing.proper_time() + d).abs() < 1e-15 * d);
}
