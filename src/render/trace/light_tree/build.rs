//! How the triangles of a tree are partitioned.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::{CHILDREN, LightTree, Node, Shining};

/// The number of bins along each axis.
const BINS: usize = 12;

/// A range of triangles, in the order of the tree, that is still to be partitioned.
struct Open {
    node: usize,
    begin: usize,
    end: usize,
}

/// The bounding box, power and normals of some triangles.
#[derive(Clone, Copy)]
struct Sum {
    count: usize,
    lo: DVec3,
    hi: DVec3,
    power: f64,
    area: f64,
    normals: DVec3,
}

impl Sum {
    const NONE: Sum = Sum {
        count: 0,
        lo: DVec3::INFINITY,
        hi: DVec3::NEG_INFINITY,
        power: 0.0,
        area: 0.0,
        normals: DVec3::ZERO,
    };

    fn add(&mut self, shining: &Shining, axis: DVec3) {
        let triangle = &shining.triangle;
        for corner in triangle.corners() {
            (self.lo, self.hi) = (self.lo.min(corner), self.hi.max(corner));
        }
        self.count += 1;
        self.power += shining.power();
        self.area += triangle.area();
        self.normals += 0.5 * shining.normal_along(axis);
    }

    fn with(&self, other: &Sum) -> Sum {
        Sum {
            count: self.count + other.count,
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
            power: self.power + other.power,
            area: self.area + other.area,
            normals: self.normals + other.normals,
        }
    }

    /// Φ M_A M_Ω.
    fn cost(&self) -> f64 {
        let size = self.hi - self.lo;
        let area = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
        let cosine = (2.0 * self.normals.length() / self.area - 1.0).clamp(-1.0, 1.0);
        let most = libm::acos(cosine);
        // All directions within θ_o, and those within π/2 of these, weighted by their cosine.
        let end = (most + FRAC_PI_2).min(PI);
        let sine = libm::sin(most);
        let beside = 2.0 * end * sine - libm::cos(most - 2.0 * end) - 2.0 * most * sine + cosine;
        self.power * area * (TAU * (1.0 - cosine) + FRAC_PI_2 * beside)
    }
}

impl Shining {
    fn power(&self) -> f64 {
        self.triangle.area() * self.brightness
    }

    /// The normal; for a two-sided triangle, the one on the side of `axis`.
    fn normal_along(&self, axis: DVec3) -> DVec3 {
        let normal = self.triangle.normal;
        match self.two_sided && normal.dot(axis) < 0.0 {
            true => -normal,
            false => normal,
        }
    }

    fn middle(&self) -> DVec3 {
        let [a, b, c] = self.triangle.corners();
        (a + b + c) / 3.0
    }
}

pub(super) fn tree(all: Vec<Shining>) -> LightTree {
    let mut order: Vec<u32> = (0..all.len() as u32).collect();
    let mut nodes = Vec::with_capacity(2 * all.len() - 1);
    let mut leaves = vec![0; all.len()];
    nodes.push(node(&all, &order, 0));
    let mut open = vec![Open {
        node: 0,
        begin: 0,
        end: all.len(),
    }];
    while let Some(Open {
        node: at,
        begin,
        end,
    }) = open.pop()
    {
        if let [only] = order[begin..end] {
            nodes[at].first = only;
            leaves[only as usize] = at as u32;
            continue;
        }
        // Split the most expensive part again, until there are enough children.
        let mut parts = vec![(nodes[at], begin, end)];
        while parts.len() < CHILDREN {
            let extent = |(part, begin, end): &(Node, usize, usize)| match end - begin {
                1 => -1.0,
                _ => part.power * part.radius2,
            };
            let largest = (0..parts.len()).max_by(|a, b| {
                let [a, b] = [*a, *b].map(|k| extent(&parts[k]));
                a.total_cmp(&b)
            });
            let Some(k) = largest.filter(|k| parts[*k].2 - parts[*k].1 > 1) else {
                break;
            };
            let (part, begin, end) = parts[k];
            let middle = begin + split(&all, &mut order[begin..end], part.axis);
            let [first, second] = [(begin, middle), (middle, end)].map(|(begin, end)| {
                let part = node(&all, &order[begin..end], at as u32);
                (part, begin, end)
            });
            parts[k] = first;
            parts.insert(k + 1, second);
        }
        nodes[at].first = nodes.len() as u32;
        nodes[at].children = parts.len() as u32;
        for (part, begin, end) in parts {
            let node = nodes.len();
            nodes.push(part);
            open.push(Open { node, begin, end });
        }
    }
    LightTree { nodes, leaves, all }
}

/// The node with the ball, cone and power of these triangles.
fn node(all: &[Shining], chosen: &[u32], parent: u32) -> Node {
    let chosen = || chosen.iter().map(|k| &all[*k as usize]);
    let mut sum = Sum::NONE;
    for shining in chosen() {
        // Two-sided triangles count with the normal on the side of the sum so far.
        sum.add(shining, sum.normals);
    }
    let centre = (sum.lo + sum.hi) * 0.5;
    let corners = chosen().flat_map(|shining| shining.triangle.corners());
    let radius2 = corners.map(|corner| (corner - centre).length_squared());
    // A margin of twice the rounding errors of the corners' coordinates.
    let size = sum.lo.abs().max(sum.hi.abs()).max_element();
    let radius = radius2.fold(0.0, f64::max).sqrt() + 4.0 * f64::EPSILON * size;
    let axis = sum.normals.normalize_or_zero();
    let two_sided = chosen().any(|shining| shining.two_sided);
    // cos θ_o: the least cosine of any normal to the axis.
    let nearest = chosen().map(|shining| {
        let cosine = shining.triangle.normal.dot(axis) / shining.triangle.twice;
        if two_sided { cosine.abs() } else { cosine }
    });
    // Without an axis, the cone contains all directions.
    let cosine = match axis == DVec3::ZERO {
        true => -1.0,
        false => nearest.fold(1.0, f64::min).max(-1.0),
    };
    Node {
        centre,
        radius2: radius * radius,
        axis,
        cosine,
        sine: (1.0 - cosine * cosine).sqrt(),
        power: sum.power,
        two_sided: if two_sided { 1.0 } else { 0.0 },
        parent,
        first: 0,
        children: 0,
    }
}

/// Partitions triangles into two parts, and returns the number in the first part.
fn split(all: &[Shining], chosen: &mut [u32], axis: DVec3) -> usize {
    let middles = || chosen.iter().map(|k| all[*k as usize].middle());
    let (lo, hi) = middles().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), m| {
        (lo.min(m), hi.max(m))
    });
    let size = hi - lo;
    let mut best = (f64::INFINITY, 0, 0);
    for along in 0..3 {
        if size[along] <= 0.0 {
            continue;
        }
        let mut bins = [Sum::NONE; BINS];
        for k in &*chosen {
            let shining = &all[*k as usize];
            bins[bin(shining.middle(), along, lo, size)].add(shining, axis);
        }
        let mut after = [Sum::NONE; BINS + 1];
        for k in (0..BINS).rev() {
            after[k] = after[k + 1].with(&bins[k]);
        }
        // Penalise cuts along the short edges of thin boxes.
        let thin = size.max_element() / size[along];
        let mut before = Sum::NONE;
        for k in 1..BINS {
            before = before.with(&bins[k - 1]);
            if before.count == 0 || after[k].count == 0 {
                continue;
            }
            let cost = thin * (before.cost() + after[k].cost());
            if cost < best.0 {
                best = (cost, along, k);
            }
        }
    }
    let (cost, along, cut) = best;
    // No cut has triangles on both sides: halves, in the given order.
    let half = chosen.len() / 2;
    if cost.is_infinite() {
        return half;
    }
    let is_before = |k: &u32| bin(all[*k as usize].middle(), along, lo, size) < cut;
    // In two passes, so that both parts keep their order.
    let (first, second): (Vec<u32>, Vec<u32>) = chosen.iter().copied().partition(|k| is_before(k));
    chosen[..first.len()].copy_from_slice(&first);
    chosen[first.len()..].copy_from_slice(&second);
    first.len()
}

fn bin(middle: DVec3, along: usize, lo: DVec3, size: DVec3) -> usize {
    let part = (middle[along] - lo[along]) / size[along];
    ((part * BINS as f64) as usize).min(BINS - 1)
}
