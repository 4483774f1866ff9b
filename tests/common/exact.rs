//! The same physics with 320 bits, in textbook form.
//!
//! γ = cosh|w| up to 10¹⁷ costs the textbook form γ(t − β·x) some 2 · 57 bits; 200 remain.

use dashu_float::{FBig, round::mode::HalfEven};
use glam::DVec3;

/// A number of 320 bits.
pub type Exact = FBig<HalfEven, 2>;

/// An event, displacement or null vector: (t, x, y, z).
pub type Four = [Exact; 4];

/// The number `x`, without rounding.
pub fn exact(x: f64) -> Exact {
    Exact::try_from(x).unwrap().with_precision(320).value()
}

/// (t, x), without rounding.
pub fn four(t: f64, x: DVec3) -> Four {
    [exact(t), exact(x.x), exact(x.y), exact(x.z)]
}

/// The null vector (−1, d/|d|).
pub fn look(d: DVec3) -> Four {
    let [_, x, y, z] = four(0.0, d);
    let length = root(&(&x * &x + &y * &y + &z * &z));
    [exact(-1.0), x / &length, y / &length, z / length]
}

/// `got` − `reference`, rounded once.
pub fn difference(got: f64, reference: &Exact) -> f64 {
    (exact(got) - reference).to_f64().value()
}

/// |got − reference| of the three spatial components.
pub fn distance(got: DVec3, reference: &Four) -> f64 {
    let [dx, dy, dz] = [0, 1, 2].map(|i| difference(got[i], &reference[i + 1]));
    DVec3::new(dx, dy, dz).length()
}

/// The nearest f64.
pub fn rounded(x: &Exact) -> f64 {
    x.to_f64().value()
}

fn root(x: &Exact) -> Exact {
    x.sqrt()
}

/// Λ(w): from the frame with rapidity vector w to the world.
pub struct ExactBoost {
    n: [Exact; 3],
    cosh: Exact,
    sinh: Exact,
}

impl ExactBoost {
    pub fn new(w: DVec3) -> Self {
        let [_, x, y, z] = four(0.0, w);
        let phi = root(&(&x * &x + &y * &y + &z * &z));
        let (up, down) = (phi.exp(), (-&phi).exp());
        let two = exact(2.0);
        ExactBoost {
            n: [x / &phi, y / &phi, z / phi],
            cosh: (&up + &down) / &two,
            sinh: (up - down) / two,
        }
    }

    pub fn apply(&self, v: &Four) -> Four {
        let [t, x, y, z] = v;
        let [nx, ny, nz] = &self.n;
        let along = nx * x + ny * y + nz * z;
        let one = exact(1.0);
        let step = (&self.cosh - one) * &along + &self.sinh * t;
        [
            &self.cosh * t + &self.sinh * along,
            x + nx * &step,
            y + ny * &step,
            z + nz * step,
        ]
    }
}
