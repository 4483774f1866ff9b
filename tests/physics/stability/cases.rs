//! Inputs of each family, reproducible on every machine.

use glam::DVec3;

use crate::common::sequence::Sequence;

pub struct Random(Sequence);

impl Random {
    pub fn new(seed: u64) -> Self {
        Random(Sequence(seed))
    }

    /// In [0, 1).
    pub fn share(&mut self) -> f64 {
        self.0.next()
    }

    /// In [−1, 1).
    pub fn number(&mut self) -> f64 {
        2.0 * self.share() - 1.0
    }

    pub fn vector(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }

    pub fn unit(&mut self) -> DVec3 {
        loop {
            let v = self.vector();
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }

    /// Log-uniform.
    pub fn scale(&mut self, low: f64, high: f64) -> f64 {
        low * libm::pow(high / low, self.share())
    }

    pub fn sign(&mut self) -> f64 {
        if self.share() < 0.5 { -1.0 } else { 1.0 }
    }

    /// ±x, ±y or ±z.
    pub fn axis(&mut self) -> DVec3 {
        DVec3::AXES[(self.share() * 3.0) as usize] * self.sign()
    }

    /// Whole, up to ±`most`.
    pub fn whole(&mut self, most: f64) -> DVec3 {
        (self.vector() * most).round()
    }
}

/// The inputs of case `index` of `family`.
pub fn inputs(family: &str, index: usize) -> Vec<f64> {
    let mut random = Random::new(index as u64 * 0x51ed + family.len() as u64);
    let r = &mut random;
    match family {
        "look-1e4" => look(r, 1e4),
        "look-1e8" => look(r, 1e8),
        "look-1e12" => look(r, 1e12),
        "look-end" => look(r, 1e17),
        "event" => event(r),
        "size" => size(r),
        "offset" => offset(r),
        "needle" => needle(r),
        "grazing" => grazing(r),
        "border" => border(r),
        "surface" => surface(r),
        "denormal" => denormal(r),
        "horizon" => horizon(r),
        other => panic!("no family {other}"),
    }
}

fn joined(vectors: &[DVec3]) -> Vec<f64> {
    vectors.iter().flat_map(|v| v.to_array()).collect()
}

/// Rapidity vector and look direction: anywhere, or within 1e-18 to 1e-12, or to 1, of ±β, or ±β itself.
fn look(r: &mut Random, fastest: f64) -> Vec<f64> {
    let n = if r.share() < 0.2 { r.axis() } else { r.unit() };
    let phi = libm::acosh(r.scale(1.0 + 1e-6, fastest)).max(1e-9);
    let axis = n * r.sign();
    let aside = r.unit().cross(n).normalize();
    let d = match (5.0 * r.share()) as u32 {
        0 => axis,
        1 => r.unit(),
        2 => axis + aside * r.scale(1e-18, 1e-12),
        _ => axis + aside * r.scale(1e-12, 1.0),
    };
    joined(&[n * phi, d])
}

/// Rapidity vector, time, place: unrelated, simultaneous, null, or nearly at rest in the other frame.
fn event(r: &mut Random) -> Vec<f64> {
    let phi = libm::acosh(r.scale(1.0 + 1e-6, 1e12));
    let n = r.unit();
    let x = r.unit() * r.scale(1e-9, 1e9);
    let late = r.scale(1e-9, 3e14) * r.sign();
    let t = match (4.0 * r.share()) as u32 {
        0 => 0.0,
        1 => x.length() * (1.0 + r.scale(1e-16, 1e-3)),
        _ => late,
    };
    let x = if r.share() < 0.3 { n * late } else { x };
    let mut inputs = joined(&[n * phi]);
    inputs.push(t);
    inputs.extend(x.to_array());
    inputs
}

/// A ray from `origin` at a point in or near the triangle, along a direction of any length.
fn aimed(r: &mut Random, corners: [DVec3; 3], origin: DVec3) -> Vec<f64> {
    let [a, b, c] = corners;
    let (u, v) = (1.2 * r.share() - 0.1, 1.2 * r.share() - 0.1);
    let (u, v) = if u + v > 1.1 {
        (1.0 - u, 1.0 - v)
    } else {
        (u, v)
    };
    let target = a + (b - a) * u + (c - a) * v;
    joined(&[a, b, c, origin, (target - origin) * r.scale(0.1, 10.0)])
}

fn single(v: DVec3) -> DVec3 {
    v.as_vec3().as_dvec3()
}

fn size(r: &mut Random) -> Vec<f64> {
    let scale = r.scale(1e-9, 1e9);
    let corners = [0; 3].map(|_| single(r.vector() * scale));
    let origin = r.vector() * (3.0 * scale);
    aimed(r, corners, origin)
}

fn offset(r: &mut Random) -> Vec<f64> {
    let place = single(r.unit() * r.scale(1e3, 1e9));
    let scale = r.scale(1e-3, 1e3);
    let corners = [0; 3].map(|_| place + r.vector() * scale);
    let origin = match r.share() < 0.5 {
        true => place + r.vector() * (3.0 * scale),
        false => r.unit() * r.scale(1e3, 1e9),
    };
    aimed(r, corners, origin)
}

fn needle(r: &mut Random) -> Vec<f64> {
    let (a, along) = (r.vector(), r.unit());
    let (width, place) = (r.scale(1e-12, 1.0), r.number());
    let tip = a + along * place + r.unit() * width;
    let origin = r.vector() * 3.0;
    aimed(r, [a, a + along, tip], origin)
}

fn grazing(r: &mut Random) -> Vec<f64> {
    let corners = [0; 3].map(|_| single(r.vector()));
    let [a, b, c] = corners;
    let n = (b - a).cross(c - a).normalize();
    let within = n.cross(r.unit()).normalize();
    let away = within * r.scale(0.1, 100.0);
    let origin = (a + b + c) / 3.0 + away + n * (away.length() * r.scale(1e-12, 1e-1));
    aimed(r, corners, origin)
}

/// Whole numbers, so that the ray runs through a point of the border exactly, or one ulp beside it.
fn border(r: &mut Random) -> Vec<f64> {
    let scale = libm::exp2((60.0 * r.number()).round());
    let [a, b, c] = [0; 3].map(|_| r.whole(1e6) * 8.0);
    let origin = r.whole(1e7);
    let part = (r.share() * 9.0).floor() / 8.0;
    let target = a + (b - a) * part;
    let mut direction = target - origin;
    if r.share() < 0.5 {
        let axis = (r.share() * 3.0) as usize;
        let up = r.share() < 0.5;
        let moved = if up { f64::next_up } else { f64::next_down };
        direction[axis] = moved(direction[axis]);
    }
    let corners = match (r.share() * 3.0) as u32 {
        0 => [a, b, c],
        1 => [b, c, a],
        _ => [c, a, b],
    };
    let [a, b, c] = corners.map(|v| v * scale);
    joined(&[a, b, c, origin * scale, direction])
}

/// From a corner, an edge or the inside, exactly, or one ulp off.
fn surface(r: &mut Random) -> Vec<f64> {
    let scale = libm::exp2((30.0 * r.number()).round());
    let [a, b, c] = [0; 3].map(|_| r.whole(1e6) * 8.0);
    let weights = [
        [0.0, 0.0],
        [0.5, 0.0],
        [0.25, 0.5],
        [0.375, 0.125],
        [0.0, 0.625],
    ];
    let [u, v] = weights[(r.share() * 5.0) as usize];
    let mut origin = a + (b - a) * u + (c - a) * v;
    if r.share() < 0.6 {
        let axis = (r.share() * 3.0) as usize;
        let up = r.share() < 0.5;
        origin[axis] = if up {
            origin[axis].next_up()
        } else {
            origin[axis].next_down()
        };
    }
    let [a, b, c] = [a, b, c].map(|v| v * scale);
    joined(&[a, b, c, origin * scale, r.unit() * r.scale(0.1, 10.0)])
}

/// Corners of whole multiples of the least f32, up to 2²³ of them: none is a normal number.
fn denormal(r: &mut Random) -> Vec<f64> {
    let least = libm::exp2(-149.0);
    let most = r.scale(8.0, 8e6);
    let corners = [0; 3].map(|_| r.whole(most) * least);
    let origin = r.vector() * (3.0 * most * least);
    aimed(r, corners, origin)
}

/// Proper acceleration along an axis; an apex before, at and beyond the horizon, or anywhere.
fn horizon(r: &mut Random) -> Vec<f64> {
    let g = r.scale(1e-6, 1e6);
    let axis = r.axis();
    let along = r.number() * r.scale(1e-3, 1e3) / g;
    let left = r.scale(1e-16, 1.0) * (r.sign() * 0.6 + 0.4).signum();
    let mut t = (left - 1.0) / g - along;
    match (6.0 * r.share()) as u32 {
        0 => t = (-1.0 / g - along).next_up(),
        1 => t = (-1.0 / g - along).next_down(),
        2 => t = r.number() * 1e9,
        _ => {}
    }
    let aside = DVec3::AXES[(0..3).find(|i| axis[*i] == 0.0).unwrap()] * r.scale(1e-6, 1e3) / g;
    let aside = aside * if r.share() < 0.5 { 0.0 } else { 1.0 };
    let mut inputs = joined(&[axis * g]);
    inputs.push(t);
    inputs.extend((axis * along + aside).to_array());
    inputs
}
