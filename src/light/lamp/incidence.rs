//! How the light of one lamp falls on surfaces of one rest frame, in loops over arrays: what [`Lamp::incident`] says of each.

use super::{Arrivals, Lamp};
use crate::accel::vectors::{BLOCK, Columns, VectorLoop, block_of, dispatch, load, store};
use crate::light::Received;
use crate::spacetime::{Boost, Direction, Rest, World};

/// Arrivals as they fall on surfaces, by point.
#[derive(Debug, Default)]
pub(crate) struct Incidence {
    /// Towards the lamp in the surfaces' rest frame, where that is another than in the world.
    in_rest: Columns,
    is_boosted: bool,
    /// W.
    pub ratios: Vec<f64>,
    /// Factors on the lamp's intensity: strength · W²⁻ᵖ cos θ/r². 0 where it shines on the other side, or not at all.
    pub factors: Vec<f64>,
}

impl Incidence {
    /// Towards the lamp in the surfaces' rest frame.
    pub fn l<'a>(&'a self, arrivals: &'a Arrivals) -> &'a Columns {
        match self.is_boosted {
            true => &self.in_rest,
            false => &arrivals.d,
        }
    }
}

impl Lamp {
    /// How `arrivals` fall on surfaces with these normals, at rest in the frame to which `boost` leads from the world; none where that
    /// changes nothing.
    pub(crate) fn incidence(
        &self,
        arrivals: &Arrivals,
        boost: Option<&Boost<Rest, World>>,
        normals: &Columns,
        to: &mut Incidence,
    ) {
        let count = arrivals.ratio.len();
        to.is_boosted = boost.is_some();
        if to.is_boosted {
            to.in_rest.resize(count);
        }
        to.ratios.resize(count, 0.0);
        to.factors.resize(count, 0.0);
        dispatch(Fall {
            received: &self.received,
            arrivals,
            boost,
            normals,
            to,
        });
    }
}

/// The loop over points.
struct Fall<'a> {
    received: &'a Received,
    arrivals: &'a Arrivals,
    boost: Option<&'a Boost<Rest, World>>,
    normals: &'a Columns,
    to: &'a mut Incidence,
}

impl VectorLoop for Fall<'_> {
    #[inline(always)]
    fn run(self) {
        let Fall {
            received,
            arrivals,
            boost,
            normals,
            to,
        } = self;
        let mut cosine = [0.0; BLOCK];
        let mut last = [[0.0; BLOCK]; 2];
        let mut begin = 0;
        while begin < to.factors.len() {
            let normals = normals.block(begin);
            let [last_strength, last_reach] = &mut last;
            let (strength, reach) = (
                block_of(&arrivals.strength, begin, last_strength),
                block_of(&arrivals.reach, begin, last_reach),
            );
            let mut ratio = load(&arrivals.ratio, begin);
            // W = (ω_G/ω_world)/(ω_F/ω_world).
            if let Some(boost) = boost {
                let mut l = arrivals.d.load(begin);
                for (k, ratio) in ratio.iter_mut().enumerate() {
                    let (in_rest, rho) = boost.direction(Direction::from_unit(l.get(k)));
                    l.set(k, in_rest.unit());
                    *ratio /= rho;
                }
                for (k, cosine) in cosine.iter_mut().enumerate() {
                    *cosine = normals.get(k).dot(l.get(k));
                }
                to.in_rest.store(&l, begin);
            } else {
                let d = arrivals.d.block(begin);
                for (k, cosine) in cosine.iter_mut().enumerate() {
                    *cosine = normals.get(k).dot(d.get(k));
                }
            }
            store(&ratio, &mut to.ratios, begin);
            let mut factor = ratio;
            let (mut above, mut below) = ([0.0; BLOCK], [0.0; BLOCK]);
            for k in 0..BLOCK {
                above[k] = strength[k] * cosine[k];
                below[k] = reach[k] * reach[k];
            }
            received.irradiances_over(&mut factor, above, below);
            for (k, factor) in factor.iter_mut().enumerate() {
                // On the side that the camera sees. Cosines are NaN where no light comes.
                let is_lit = (strength[k] != 0.0) & (cosine[k] > 0.0);
                *factor = if is_lit { *factor } else { 0.0 };
            }
            store(&factor, &mut to.factors, begin);
            begin += BLOCK;
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::{Cone, Emission, EventColumns, Path, PointsOnRays};
    use super::*;
    use crate::spacetime::{Event, InertialFrame, NullRay, Quantity, Velocity};

    #[test]
    fn light_in_loops_has_the_bits_of_light_at_single_points() {
        let velocity = |x, y, z| Velocity::from_beta(DVec3::new(x, y, z)).unwrap();
        let origin = Event::new(-3.0, DVec3::new(0.4, 2.0, -1.0));
        let path = |v| match v {
            None => Path::Rest(origin),
            Some(v) => Path::Inertial(InertialFrame::new(v, origin)),
        };
        let paths = [
            path(None),
            path(Some(velocity(0.3, 0.0, 0.1))),
            path(Some(velocity(-0.6, 0.7, 0.0))),
        ];
        let axis = DVec3::new(0.0, -0.6, -0.8);
        let beams = [
            Cone::Everywhere,
            Cone::Parallel(axis),
            Cone::Spot {
                axis,
                outer: 0.1,
                inner: 0.9,
            },
        ];
        let boosts = [None, Some(Boost::new(velocity(0.5, -0.2, 0.3)))];

        // Points on rays from one event, more than a block of them; the normals of some are turned away from the light.
        let shot = Event::new(0.2, DVec3::new(0.1, 0.2, 5.0));
        let part = |k: usize, n: usize| (k * n % 103) as f64 / 51.0 - 1.0;
        let count = 150;
        let (mut offsets, mut normals, mut rays) =
            (EventColumns::default(), Columns::default(), vec![]);
        offsets.resize(count);
        for k in 0..count {
            let d = DVec3::new(part(k, 7), part(k, 11), -1.5);
            let ray = NullRay::new(shot, Direction::new(d).unwrap(), 1.0);
            let s = 4.0 + 2.0 * part(k, 13);
            let offset = ray.tangent * s;
            offsets.ct[k] = offset.ct;
            offsets.x.set(k, offset.x);
            normals.push(DVec3::new(part(k, 17), part(k, 19), part(k, 23)).normalize());
            rays.push((ray, s));
        }
        let points = PointsOnRays {
            shot,
            origins: None,
            offsets: &offsets,
        };
        let mut dark = 0;
        for (path, beam) in paths.iter().flat_map(|path| beams.map(|beam| (path, beam))) {
            let lamp = Lamp {
                path: path.clone(),
                beam,
                emission: Emission::Gaussian {
                    centre: -2.0,
                    sigma: 2.0,
                    scale: 1.3,
                },
                intensity: [1.0, 0.5, 0.25],
                received: Received::Scaled(Quantity::Integrated),
                spectrum: None,
                shadows: false,
                pulse: None,
            };
            for boost in &boosts {
                let (mut arrivals, mut incidence) = (Arrivals::default(), Incidence::default());
                lamp.arrivals(&points, 1.0, &mut arrivals);
                lamp.incidence(&arrivals, boost.as_ref(), &normals, &mut incidence);
                for (k, (ray, s)) in rays.iter().enumerate() {
                    let (w, factor) = (incidence.ratios[k], incidence.factors[k]);
                    let together = lamp.incident_at(w, factor);
                    let arrival = lamp.arrival(ray, *s, 1.0);
                    let alone = arrival.and_then(|arrival| {
                        let (l, rho) = match boost {
                            None => (arrival.d.unit(), 1.0),
                            Some(boost) => {
                                let (l, rho) = boost.direction(arrival.d);
                                (l.unit(), rho)
                            }
                        };
                        assert_eq!(l, incidence.l(&arrivals).get(k));
                        let cosine = normals.get(k).dot(l);
                        (cosine > 0.0).then(|| lamp.incident(&arrival, rho, cosine))
                    });
                    let Some(alone) = alone else {
                        assert_eq!(factor, 0.0);
                        dark += 1;
                        continue;
                    };
                    assert_eq!(alone.irradiance, together.irradiance);
                    assert_eq!(alone.wavelength_scale, together.wavelength_scale);
                }
            }
        }
        assert!((200..count * 18 - 200).contains(&dark), "{dark}");
    }
}
