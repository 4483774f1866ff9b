//! How the light of one lamp falls on surfaces of one rest frame, in loops over arrays: what [`Lamp::incident`] says of each.
//!
//! Arrivals are in memory where something else needs them, as shadows do. Where nothing does, they are used in the loop that finds them.

use super::arrivals::{ArrivalsBlock, Taking};
use super::{Arrivals, Cone, Lamp, PointsOnRays};
use crate::accel::vectors::{
    BLOCK, Block, Columns, VectorLoop, Vectors, VectorsRef, block_of, dispatch,
};
use crate::light::Received;
use crate::spacetime::{Boost, Direction, Rest, World};

/// Arrivals as they fall on surfaces, by point.
#[derive(Debug, Default)]
pub(crate) struct Incidence {
    count: usize,
    /// Towards the lamp in the surfaces' rest frame, where that is not what arrivals say.
    in_rest: Columns,
    has_l: bool,
    /// W, and the factors, in whole blocks.
    ratios: Vec<f64>,
    factors: Vec<f64>,
}

impl Incidence {
    /// Towards the lamp in the surfaces' rest frame.
    pub fn l<'a>(&'a self, arrivals: &'a Arrivals) -> &'a Columns {
        match self.has_l {
            true => &self.in_rest,
            false => &arrivals.d,
        }
    }

    /// W.
    pub fn ratios(&self) -> &[f64] {
        &self.ratios[..self.count]
    }

    /// Factors on the lamp's intensity: strength · W²⁻ᵖ cos θ/r². 0 where it shines on the other side, or not at all.
    pub fn factors(&self) -> &[f64] {
        &self.factors[..self.count]
    }

    /// Takes all light from point `k`.
    pub fn darken(&mut self, k: usize) {
        self.factors[k] = 0.0;
    }

    fn resize(&mut self, count: usize, has_l: bool) {
        (self.count, self.has_l) = (count, has_l);
        if has_l {
            self.in_rest.resize(count);
        }
        let room = count.next_multiple_of(BLOCK);
        self.ratios.resize(room, 0.0);
        self.factors.resize(room, 0.0);
    }

    /// W and the factors from `begin` on, to be written.
    #[inline(always)]
    fn block_mut(&mut self, begin: usize) -> Option<[&mut Block; 2]> {
        Some([
            self.ratios.get_mut(begin..)?.first_chunk_mut()?,
            self.factors.get_mut(begin..)?.first_chunk_mut()?,
        ])
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
        to.resize(arrivals.ratio.len(), boost.is_some());
        dispatch(Fall {
            onto: Onto {
                received: &self.received,
                boost,
                normals,
            },
            arrivals,
            to,
        });
    }

    /// [`Lamp::arrivals`] and [`Lamp::incidence`] in one loop, which keeps nothing of what lies between; directions only for surfaces that are
    /// `glossy`. False, and nothing done, of lamps that are not as bright always and everywhere.
    pub(crate) fn incidence_at(
        &self,
        (points, index): (&PointsOnRays, f64),
        boost: Option<&Boost<Rest, World>>,
        normals: &Columns,
        glossy: bool,
        to: &mut Incidence,
    ) -> bool {
        if !self.emission.is_steady() || matches!(self.beam, Cone::Spot { .. }) {
            return false;
        }
        to.resize(points.offsets.ct.len(), glossy);
        let onto = Onto {
            received: &self.received,
            boost,
            normals,
        };
        self.arrive(points, index, &mut Falling { onto, to })
    }
}

/// Surfaces that light falls on.
#[derive(Clone, Copy)]
struct Onto<'a> {
    received: &'a Received,
    /// To their frame.
    boost: Option<&'a Boost<Rest, World>>,
    normals: &'a Columns,
}

/// Arrivals at a block of points.
struct Arriving<'a> {
    d: VectorsRef<'a>,
    strength: &'a Block,
    reach: &'a Block,
    ratio: &'a Block,
}

/// Numbers of a block on their way.
struct Buffers {
    /// Towards the lamp in the surfaces' frame and W, where that frame is another than the world's.
    l: Vectors,
    ratio: Block,
    cosine: Block,
    /// What the factors have above and below the line.
    above: Block,
    below: Block,
}

impl Buffers {
    /// To be written.
    const ZERO: Buffers = Buffers {
        l: Vectors::ZERO,
        ratio: [0.0; BLOCK],
        cosine: [0.0; BLOCK],
        above: [0.0; BLOCK],
        below: [0.0; BLOCK],
    };
}

impl Onto<'_> {
    /// Writes to `to` how `arriving` falls on the points from `begin` on.
    #[inline(always)]
    fn fall(&self, begin: usize, arriving: &Arriving, buffers: &mut Buffers, to: &mut Incidence) {
        let normals = self.normals.block(begin);
        let Buffers {
            l,
            ratio: boosted,
            cosine,
            above,
            below,
        } = buffers;
        let Arriving {
            d,
            strength,
            reach,
            ratio,
        } = arriving;
        // W = (ω_G/ω_world)/(ω_F/ω_world).
        let ratio = match self.boost {
            Some(boost) => {
                for k in 0..BLOCK {
                    let (in_rest, rho) = boost.direction(Direction::from_unit(d.get(k)));
                    l.set(k, in_rest.unit());
                    boosted[k] = ratio[k] / rho;
                }
                for (k, cosine) in cosine.iter_mut().enumerate() {
                    *cosine = normals.get(k).dot(l.get(k));
                }
                boosted
            }
            None => {
                for (k, cosine) in cosine.iter_mut().enumerate() {
                    *cosine = normals.get(k).dot(d.get(k));
                }
                *ratio
            }
        };
        for k in 0..BLOCK {
            above[k] = strength[k] * cosine[k];
            below[k] = reach[k] * reach[k];
        }
        let Some([ratios, factors]) = to.block_mut(begin) else {
            return;
        };
        *ratios = *ratio;
        *factors = *ratio;
        self.received.irradiances_over(factors, above, below);
        for k in 0..BLOCK {
            // On the side that the camera sees. Cosines are NaN where no light comes.
            let is_lit = (strength[k] != 0.0) & (cosine[k] > 0.0);
            factors[k] = if is_lit { factors[k] } else { 0.0 };
        }
    }
}

/// The loop over points whose arrivals are known.
struct Fall<'a> {
    onto: Onto<'a>,
    arrivals: &'a Arrivals,
    to: &'a mut Incidence,
}

impl VectorLoop for Fall<'_> {
    #[inline(always)]
    fn run(self) {
        let Fall { onto, arrivals, to } = self;
        let mut buffers = Buffers::ZERO;
        let mut last = [[0.0; BLOCK]; 3];
        let mut begin = 0;
        while begin < to.count {
            let [last_strength, last_reach, last_ratio] = &mut last;
            let arriving = Arriving {
                d: arrivals.d.block(begin),
                strength: block_of(&arrivals.strength, begin, last_strength),
                reach: block_of(&arrivals.reach, begin, last_reach),
                ratio: block_of(&arrivals.ratio, begin, last_ratio),
            };
            onto.fall(begin, &arriving, &mut buffers, to);
            if to.has_l {
                to.in_rest.store(&buffers.l, begin);
            }
            begin += BLOCK;
        }
    }
}

/// Light that falls where it arrives, always and everywhere of the same strength.
struct Falling<'a> {
    onto: Onto<'a>,
    to: &'a mut Incidence,
}

impl Taking for Falling<'_> {
    type Buffers = Buffers;
    const BUFFERS: Buffers = Buffers::ZERO;

    #[inline(always)]
    fn take(&mut self, begin: usize, block: &ArrivalsBlock, buffers: &mut Buffers) {
        let arriving = Arriving {
            d: block.d.as_ref(),
            strength: &[1.0; BLOCK],
            reach: &block.reach,
            ratio: &block.ratio,
        };
        self.onto.fall(begin, &arriving, buffers, self.to);
        if self.to.has_l {
            let l = match self.onto.boost {
                Some(_) => &buffers.l,
                None => &block.d,
            };
            self.to.in_rest.store(l, begin);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::{Cone, Emission, EventColumns, Path, PointsOnRays};
    use super::*;
    use crate::spacetime::{Event, InertialFrame, NullRay, Quantity, Velocity};

    fn velocity(x: f64, y: f64, z: f64) -> Velocity {
        Velocity::from_beta(DVec3::new(x, y, z)).unwrap()
    }

    fn boosts() -> [Option<Boost<Rest, World>>; 2] {
        [None, Some(Boost::new(velocity(0.5, -0.2, 0.3)))]
    }

    /// Lamps of all beams at rest, slow and fast.
    fn lamps(emission: &Emission) -> Vec<Lamp> {
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
        let all = paths.iter().flat_map(|path| beams.map(|beam| (path, beam)));
        let lamp = |(path, beam): (&Path, Cone)| Lamp {
            path: path.clone(),
            beam,
            emission: emission.clone(),
            intensity: [1.0, 0.5, 0.25],
            received: Received::Scaled(Quantity::Integrated),
            spectrum: None,
            shadows: false,
            pulse: None,
        };
        all.map(lamp).collect()
    }

    const COUNT: usize = 150;
    const SHOT: Event<World> = Event::new(0.2, DVec3::new(0.1, 0.2, 5.0));

    /// Points on rays from one event, more than a block of them; the normals of some are turned away from the light.
    fn points() -> (EventColumns, Columns, Vec<(NullRay<World>, f64)>) {
        let part = |k: usize, n: usize| (k * n % 103) as f64 / 51.0 - 1.0;
        let (mut offsets, mut normals, mut rays) =
            (EventColumns::default(), Columns::default(), vec![]);
        offsets.resize(COUNT);
        for k in 0..COUNT {
            let d = DVec3::new(part(k, 7), part(k, 11), -1.5);
            let ray = NullRay::new(SHOT, Direction::new(d).unwrap(), 1.0);
            let s = 4.0 + 2.0 * part(k, 13);
            let offset = ray.tangent * s;
            offsets.ct[k] = offset.ct;
            offsets.x.set(k, offset.x);
            normals.push(DVec3::new(part(k, 17), part(k, 19), part(k, 23)).normalize());
            rays.push((ray, s));
        }
        (offsets, normals, rays)
    }

    fn on_rays(offsets: &EventColumns) -> PointsOnRays<'_> {
        PointsOnRays {
            shot: SHOT,
            origins: None,
            offsets,
        }
    }

    #[test]
    fn arrivals_that_nothing_else_needs_fall_with_the_same_bits() {
        let (offsets, normals, _) = points();
        let points = on_rays(&offsets);
        let mut in_one_loop = 0;
        for lamp in lamps(&Emission::Steady) {
            for (boost, glossy) in boosts().iter().flat_map(|b| [(b, false), (b, true)]) {
                let (mut arrivals, mut expected) = (Arrivals::default(), Incidence::default());
                lamp.arrivals(&points, 1.0, &mut arrivals);
                lamp.incidence(&arrivals, boost.as_ref(), &normals, &mut expected);
                let mut found = Incidence::default();
                let to = &mut found;
                let is_found =
                    lamp.incidence_at((&points, 1.0), boost.as_ref(), &normals, glossy, to);
                assert_eq!(is_found, !matches!(lamp.beam, Cone::Spot { .. }));
                if !is_found {
                    continue;
                }
                in_one_loop += 1;
                assert_eq!(found.factors(), expected.factors());
                assert_eq!(found.ratios(), expected.ratios());
                let lit = found.factors().iter().filter(|f| **f > 0.0).count();
                assert!((10..COUNT - 10).contains(&lit), "{lit}");
                if glossy {
                    let none = Arrivals::default();
                    for k in 0..COUNT {
                        assert_eq!(found.l(&none).get(k), expected.l(&arrivals).get(k));
                    }
                }
            }
        }
        assert_eq!(in_one_loop, 24);
    }

    #[test]
    fn lamps_that_flicker_are_not_taken_in_one_loop() {
        let (offsets, normals, _) = points();
        let flickering = Emission::Table(vec![[-100.0, 1.0], [100.0, 2.0]]);
        for lamp in lamps(&flickering) {
            let to = &mut Incidence::default();
            assert!(!lamp.incidence_at((&on_rays(&offsets), 1.0), None, &normals, false, to));
        }
    }

    #[test]
    fn light_in_loops_has_the_bits_of_light_at_single_points() {
        let (offsets, normals, rays) = points();
        let points = on_rays(&offsets);
        let gaussian = Emission::Gaussian {
            centre: -2.0,
            sigma: 2.0,
            scale: 1.3,
        };
        let mut dark = 0;
        for lamp in lamps(&gaussian) {
            for boost in &boosts() {
                let (mut arrivals, mut incidence) = (Arrivals::default(), Incidence::default());
                lamp.arrivals(&points, 1.0, &mut arrivals);
                lamp.incidence(&arrivals, boost.as_ref(), &normals, &mut incidence);
                for (k, (ray, s)) in rays.iter().enumerate() {
                    let (w, factor) = (incidence.ratios()[k], incidence.factors()[k]);
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
        assert!((200..COUNT * 18 - 200).contains(&dark), "{dark}");
    }
}
