//! Incidence of the light of one lamp on surfaces of one rest frame, in loops over arrays: the results of [`Lamp::incident`].
//!
//! Arrivals are stored if they are needed elsewhere, for example for shadows. Otherwise they are used in the loop that computes them.

use super::arrivals::{ArrivalsBlock, Taking};
use super::{Arrivals, Cone, Lamp, PointsOnRays};
use crate::accel::vectors::{
    BLOCK, Block, Columns, VectorLoop, Vectors, VectorsRef, block_of, dispatch,
};
use crate::light::Received;
use crate::spacetime::{Boost, Direction, Rest, World};

/// Light incident on surfaces, for each point.
#[derive(Debug, Default)]
pub(crate) struct Incidence {
    count: usize,
    /// Direction to the lamp in the surfaces' rest frame, if it differs from that of the arrivals.
    in_rest: Columns,
    has_l: bool,
    /// W, if kept, and the factors, in whole blocks.
    ratios: Vec<f64>,
    has_ratios: bool,
    factors: Vec<f64>,
}

impl Incidence {
    /// Direction to the lamp in the surfaces' rest frame.
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

    /// Factors on the lamp's intensity: strength · W²⁻ᵖ cos θ/r². 0 if the light falls on the other side, or there is none.
    pub fn factors(&self) -> &[f64] {
        &self.factors[..self.count]
    }

    /// Removes all light from point `k`.
    pub fn darken(&mut self, k: usize) {
        self.factors[k] = 0.0;
    }

    fn resize(&mut self, count: usize, has_l: bool, has_ratios: bool) {
        (self.count, self.has_l, self.has_ratios) = (count, has_l, has_ratios);
        if has_l {
            self.in_rest.resize(count);
        }
        // Whole blocks: the loops write the last one without a test.
        let room = count.next_multiple_of(BLOCK);
        self.ratios.resize(room, 0.0);
        self.factors.resize(room, 0.0);
    }

    /// W and the factors from `begin` on, to be filled in.
    #[inline(always)]
    fn block_mut(&mut self, begin: usize) -> Option<[&mut Block; 2]> {
        Some([
            self.ratios.get_mut(begin..)?.first_chunk_mut()?,
            self.factors.get_mut(begin..)?.first_chunk_mut()?,
        ])
    }
}

impl Lamp {
    /// Incidence of `arrivals` on surfaces with these normals, at rest in the frame to which `boost` transforms from the world; `None` if
    /// that is the world.
    pub(crate) fn incidence(
        &self,
        arrivals: &Arrivals,
        boost: Option<&Boost<Rest, World>>,
        normals: &Columns,
        to: &mut Incidence,
    ) {
        to.resize(arrivals.ratio.len(), boost.is_some(), true);
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

    /// [`Lamp::arrivals`] and [`Lamp::incidence`] in one loop, without storing intermediate results; `kept` states which others are stored.
    /// Returns false, and does nothing, for lamps that are not steady and isotropic.
    pub(crate) fn incidence_at(
        &self,
        (points, index): (&PointsOnRays, f64),
        boost: Option<&Boost<Rest, World>>,
        normals: &Columns,
        kept: Kept,
        to: &mut Incidence,
    ) -> bool {
        if !self.emission.is_steady() || matches!(self.beam, Cone::Spot { .. }) {
            return false;
        }
        to.resize(points.count(), kept.directions, kept.ratios);
        let onto = Onto {
            received: &self.received,
            boost,
            normals,
        };
        self.arrive(points, index, &mut Falling { onto, to })
    }
}

/// The results to store in addition to factors.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kept {
    /// Directions to the lamp, in the surfaces' rest frame.
    pub directions: bool,
    /// W.
    pub ratios: bool,
}

/// Surfaces that receive light.
#[derive(Clone, Copy)]
struct Onto<'a> {
    received: &'a Received,
    /// Boost to their frame.
    boost: Option<&'a Boost<Rest, World>>,
    normals: &'a Columns,
}

/// Arrivals at a block of points.
struct Arriving<'a> {
    d: VectorsRef<'a>,
    strength: &'a Block,
    fade: &'a Block,
    ratio: &'a Block,
    inverse: &'a Block,
}

/// Intermediate results of a block.
struct Buffers {
    /// Direction to the lamp in the surfaces' frame, W and its inverse, if that frame is not the world's.
    l: Vectors,
    ratio: Block,
    inverse: Block,
    /// Irradiance without the factor of W.
    irradiance: Block,
}

impl Buffers {
    /// Buffers to be filled in.
    const ZERO: Buffers = Buffers {
        l: Vectors::ZERO,
        ratio: [0.0; BLOCK],
        inverse: [0.0; BLOCK],
        irradiance: [0.0; BLOCK],
    };
}

impl Onto<'_> {
    /// Writes to `to` the incidence of `arriving` at the points from `begin` on.
    #[inline(always)]
    fn fall(&self, begin: usize, arriving: &Arriving, buffers: &mut Buffers, to: &mut Incidence) {
        let normals = self.normals.block(begin);
        let Arriving {
            d,
            strength,
            fade,
            ratio,
            inverse,
        } = arriving;
        let has_ratios = to.has_ratios;
        let Some([ratios, factors]) = to.block_mut(begin) else {
            return;
        };
        // W = (ω_G/ω_world)/(ω_F/ω_world), and the irradiance without it.
        let irradiance = &mut buffers.irradiance;
        let (ratio, inverse) = match self.boost {
            Some(boost) => {
                let l = &mut buffers.l;
                for k in 0..BLOCK {
                    let d = Direction::from_unit(d.get(k));
                    let (in_rest, [rho, per_rho]) = boost.direction_and_inverse(d);
                    l.set(k, in_rest.unit());
                    buffers.ratio[k] = ratio[k] * per_rho;
                    buffers.inverse[k] = inverse[k] * rho;
                }
                for k in 0..BLOCK {
                    irradiance[k] = strength[k] * normals.get(k).dot(l.get(k)) * fade[k];
                }
                (&buffers.ratio, &buffers.inverse)
            }
            None => {
                for k in 0..BLOCK {
                    irradiance[k] = strength[k] * normals.get(k).dot(d.get(k)) * fade[k];
                }
                (*ratio, *inverse)
            }
        };
        if has_ratios {
            *ratios = *ratio;
        }
        // Only on the side that the camera sees. They are NaN if no light arrives.
        (self.received).irradiances_at([ratio, inverse], irradiance, factors);
    }
}

/// The loop over points with known arrivals.
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
        let mut last = [[0.0; BLOCK]; 4];
        let mut begin = 0;
        while begin < to.count {
            let [last_strength, last_fade, last_ratio, last_inverse] = &mut last;
            // Lengths that are no multiple of a block end in a copy, padded with zeros, which give no light.
            let arriving = Arriving {
                d: arrivals.d.block(begin),
                strength: block_of(&arrivals.strength, begin, last_strength),
                fade: block_of(&arrivals.fade, begin, last_fade),
                ratio: block_of(&arrivals.ratio, begin, last_ratio),
                inverse: block_of(&arrivals.inverse, begin, last_inverse),
            };
            onto.fall(begin, &arriving, &mut buffers, to);
            if to.has_l {
                to.in_rest.store(&buffers.l, begin);
            }
            begin += BLOCK;
        }
    }
}

/// Light that is used in the loop where it arrives, steady and isotropic.
struct Falling<'a> {
    onto: Onto<'a>,
    to: &'a mut Incidence,
}

impl Taking for Falling<'_> {
    type Buffers = Buffers;
    const BUFFERS: Buffers = Buffers::ZERO;

    #[inline(always)]
    fn take(&mut self, begin: usize, block: &ArrivalsBlock, buffers: &mut Buffers) {
        // Steady and isotropic: full strength in all directions.
        let arriving = Arriving {
            d: block.d.as_ref(),
            strength: &[1.0; BLOCK],
            fade: &block.fade,
            ratio: &block.ratio,
            inverse: &block.inverse,
        };
        self.onto.fall(begin, &arriving, buffers, self.to);
        if self.to.has_l {
            // In a frame at rest in the world the directions are those of the arrivals.
            let l = match self.onto.boost {
                Some(_) => &buffers.l,
                None => &block.d,
            };
            self.to.in_rest.store(l, begin);
        }
    }
}

#[cfg(test)]
mod tests;
