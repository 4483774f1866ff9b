//! One triangle of [`facets`](super::facets) before packets of rays.

use super::facets::{Facets, Lane, V};
use super::simd::Simd;
use crate::accel::wide::WIDTH;

/// A triangle of [`Facets`], in as many lanes as there are rays.
pub(super) struct Facet<'a, K: Simd> {
    kernel: K,
    facets: &'a Facets,
    at: usize,
    edges: [[K::F; 3]; 3],
    sides: [[K::F; 3]; 3],
    slack: [K::F; 3],
}

impl<'a, K: Simd> Facet<'a, K> {
    /// That in lane `at`.
    #[inline(always)]
    pub fn of<const OWN: bool>(k: K, facets: &'a Facets, at: usize) -> Facet<'a, K> {
        let at = at % WIDTH;
        let zero = [k.splat(0.0); 3];
        let mut facet = Facet {
            kernel: k,
            facets,
            at,
            edges: [zero; 3],
            sides: [zero; 3],
            slack: zero,
        };
        let mut edge = 0;
        while edge < 3 {
            facet.edges[edge] = lane3(k, &facets.edges[edge], at);
            if OWN {
                facet.sides[edge] = lane3(k, &facets.sides[edge], at);
            }
            facet.slack[edge] = k.splat(facets.slack[edge][at]);
            edge += 1;
        }
        facet
    }

    /// Whether its σ is certain.
    #[inline(always)]
    pub fn is_certain(&self) -> bool {
        self.facets.certain >> self.at & 1 != 0
    }

    /// U + B, V + B and W + B of rays with these directions and moments.
    #[inline(always)]
    pub fn weigh<const OWN: bool>(&self, d: &[K::F; 3], m: &[K::F; 3]) -> [K::F; 3] {
        let k = self.kernel;
        let mut weights = self.slack;
        let mut edge = 0;
        while edge < 3 {
            if OWN {
                weights[edge] = k.dot(m, &self.sides[edge], weights[edge]);
            }
            weights[edge] = k.dot(d, &self.edges[edge], weights[edge]);
            edge += 1;
        }
        weights
    }

    /// Where U, V and W are certainly positive.
    #[inline(always)]
    pub fn is_inside(&self, weights: &[K::F; 3]) -> u32 {
        let k = self.kernel;
        let [b, c, e] = &self.slack;
        let [u, v, w] = weights;
        k.not_negative(
            k.sub(k.sub(*u, *b), *b),
            k.sub(k.sub(*v, *c), *c),
            k.sub(k.sub(*w, *e), *e),
        )
    }

    /// Δ.
    #[inline(always)]
    pub fn slope(&self, d: &[K::F; 3]) -> K::F {
        let k = self.kernel;
        let normal = lane3(k, &self.facets.normal, self.at);
        k.dot(d, &normal, k.splat(0.0))
    }

    /// The B of Δ.
    #[inline(always)]
    pub fn slope_slack(&self) -> K::F {
        self.kernel.splat(self.facets.normal_slack[self.at])
    }

    /// n·a − n·δ for rays that start at these offsets.
    #[inline(always)]
    pub fn volume<const OWN: bool>(&self, offsets: &[K::F; 3]) -> K::F {
        let k = self.kernel;
        let volume = k.splat(self.facets.volume[self.at]);
        if !OWN {
            return volume;
        }
        let normal = lane3(k, &self.facets.normal, self.at);
        k.sub(volume, k.dot(offsets, &normal, k.splat(0.0)))
    }

    /// δᵥ where n·a − n·δ is `volume`.
    #[inline(always)]
    pub fn volume_slack(&self, volume: K::F) -> K::F {
        let k = self.kernel;
        let slack = k.splat(self.facets.volume_slack[self.at]);
        k.mul_add(k.abs(volume), k.splat(4.0 * V), slack)
    }
}

#[inline(always)]
fn lane3<K: Simd>(k: K, from: &[Lane; 3], at: usize) -> [K::F; 3] {
    [
        k.splat(from[0][at]),
        k.splat(from[1][at]),
        k.splat(from[2][at]),
    ]
}
