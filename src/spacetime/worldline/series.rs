//! World lines as piecewise polynomials in a parameter of their own.
//!
//! On a piece, the displacement from the event at its centre s₀ is D(u) = Σ cₖ uᵏ, k ≥ 1, u = (s − s₀)/h. The displacement between two
//! parameters is computed from the divided difference,
//!
//! ```text
//! D(u₂) − D(u₁) = (u₂ − u₁) Q(u₂),    Q(u) = Σ bₖ uᵏ,    bₖ₋₁ = cₖ + u₁ bₖ,
//! ```
//!
//! so that a small one keeps its digits. The crossing with a light cone is the root of F(s) = T − t(s) − |X − x(s)|, which strictly
//! decreases; the piece is the one of which only the beginning lies in the causal past of the cone's apex.

use glam::{DVec3, DVec4};

use super::root::{self, Sample};
use crate::spacetime::{Displacement, Event, World};

/// A polynomial piece.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    /// The node (an end of the piece) at its centre, where u = 0.
    pub centre: usize,
    /// The parameter interval that corresponds to 1 in u; negative if the piece ends at its centre.
    pub scale: f64,
    /// The index of its first coefficient, c₁.
    pub first: usize,
    /// The number of coefficients.
    pub count: usize,
}

/// A piecewise polynomial world line; vectors are (x, y, z, ct).
#[derive(Debug, Clone, Default)]
pub(super) struct Series {
    /// Parameters at the ends of the pieces, ascending.
    pub parameters: Vec<f64>,
    /// Events at these parameters.
    pub events: Vec<Event<World>>,
    /// One fewer than nodes.
    pub pieces: Vec<Piece>,
    pub coefficients: Vec<DVec4>,
}

/// A displacement along the line, and the tangent (per unit of the parameter) at its end.
#[derive(Debug, Clone, Copy)]
struct Way {
    moved: Displacement<World>,
    tangent: Displacement<World>,
}

/// A crossing: displacement from the reference event, and parameter.
#[derive(Debug, Clone, Copy)]
pub(super) struct SeriesCrossing {
    pub displacement: Displacement<World>,
    pub parameter: f64,
}

impl Series {
    /// The first and the last parameter.
    pub fn span(&self) -> [f64; 2] {
        [self.parameters[0], self.parameters[self.pieces.len()]]
    }

    /// The piece that contains a parameter, the later one at a node.
    pub fn piece(&self, parameter: f64) -> usize {
        let inner = &self.parameters[1..self.pieces.len()];
        inner.partition_point(|node| *node <= parameter)
    }

    /// The event and the tangent (x, y, z, ct) at a parameter.
    pub fn at(&self, parameter: f64) -> (Event<World>, Displacement<World>) {
        let index = self.piece(parameter);
        let centre = self.pieces[index].centre;
        let from = self.parameters[centre];
        let way = self.way(index, from, parameter - from);
        (self.events[centre] + way.moved, way.tangent)
    }

    /// The tangent (x, y, z, ct) on a piece, `s` after its beginning.
    pub fn tangent(&self, piece: usize, s: f64) -> Displacement<World> {
        self.way(piece, self.parameters[piece], s).tangent
    }

    /// The second derivative of the position at a parameter.
    pub fn second(&self, parameter: f64) -> DVec3 {
        let piece = self.pieces[self.piece(parameter)];
        let u = (parameter - self.parameters[piece.centre]) / piece.scale;
        // Σ k (k − 1) cₖ uᵏ⁻² by Horner.
        let mut sum = DVec4::ZERO;
        for k in (2..=piece.count).rev() {
            let factor = (k * (k - 1)) as f64;
            sum = self.coefficients[piece.first + k - 1] * factor + sum * u;
        }
        sum.truncate() / (piece.scale * piece.scale)
    }

    /// The third derivative of the position at a parameter, of pieces of degree 3 or less: constant on each.
    pub fn third(&self, parameter: f64) -> DVec3 {
        let piece = self.pieces[self.piece(parameter)];
        let cubic = match piece.count {
            3.. => self.coefficients[piece.first + 2],
            _ => DVec4::ZERO,
        };
        cubic.truncate() * (6.0 / piece.scale.powi(3))
    }

    /// The displacement on a piece from the parameter `from` to `from` + `s`.
    fn way(&self, piece: usize, from: f64, s: f64) -> Way {
        let piece = self.pieces[piece];
        let first = (from - self.parameters[piece.centre]) / piece.scale;
        let step = s / piece.scale;
        let second = first + step;
        // Horner's scheme for three: bₖ at u₁, and Q and D′ at u₂.
        let [mut b, mut q, mut slope] = [DVec4::ZERO; 3];
        for k in (1..=piece.count).rev() {
            let c = self.coefficients[piece.first + k - 1];
            b = c + b * first;
            q = b + q * second;
            slope = c * k as f64 + slope * second;
        }
        Way {
            moved: displacement(q * step),
            tangent: displacement(slope / piece.scale),
        }
    }

    /// The crossing with the past light cone of the event at `offset` from `near`, the event of the line at `parameter`; the displacement
    /// is from `near`. `guess` is the crossing of a straight line.
    pub fn past_cone(
        &self,
        near: Event<World>,
        parameter: f64,
        offset: Displacement<World>,
        guess: f64,
    ) -> Option<SeriesCrossing> {
        let own = self.piece(parameter);
        let target = self.crossed(own, |node| (near - node) + offset)?;
        if target == own {
            return Some(self.on_piece(own, parameter, offset, guess));
        }
        // From node to node, and on from there.
        let (leave, enter) = if target > own {
            (own + 1, target)
        } else {
            (own, target + 1)
        };
        let first = self.way(own, parameter, self.parameters[leave] - parameter);
        let between = first.moved + (self.events[enter] - self.events[leave]);
        let from = self.parameters[enter];
        let found = self.on_piece(target, from, offset - between, parameter - from + guess);
        Some(SeriesCrossing {
            displacement: between + found.displacement,
            ..found
        })
    }

    /// The crossing with the past light cone of `apex`; the displacement is from `apex`.
    pub fn past_cone_of(&self, apex: Event<World>) -> Option<SeriesCrossing> {
        let piece = self.crossed(0, |node| apex - node)?;
        let offset = apex - self.events[piece];
        // Without a guess, the search starts at the middle of the piece.
        let found = self.on_piece(piece, self.parameters[piece], offset, f64::NAN);
        Some(SeriesCrossing {
            displacement: found.displacement - offset,
            ..found
        })
    }

    /// The piece that a past light cone crosses; `from` is the displacement from a node to the cone's apex. `likely` is tested first.
    fn crossed(
        &self,
        likely: usize,
        from: impl Fn(Event<World>) -> Displacement<World>,
    ) -> Option<usize> {
        let seen = |node: &Event<World>| from(*node).is_causal();
        // The light cone crosses where the causal past of its apex ends.
        if seen(&self.events[likely]) && !seen(&self.events[likely + 1]) {
            return Some(likely);
        }
        let count = self.events.partition_point(seen);
        if count == self.events.len() {
            // Seen exactly at the line's end, and no later.
            let last = from(self.events[count - 1]);
            return (last.ct == last.x.length()).then(|| count - 2);
        }
        count.checked_sub(1)
    }

    /// The crossing on a piece; `offset` and displacement are relative to the event at parameter `from`.
    fn on_piece(
        &self,
        piece: usize,
        from: f64,
        offset: Displacement<World>,
        guess: f64,
    ) -> SeriesCrossing {
        let bracket = [piece, piece + 1].map(|node| self.parameters[node] - from);
        let s = root::decreasing(bracket, guess, |s| {
            let Way { moved, tangent } = self.way(piece, from, s);
            delay_left(offset, moved, tangent)
        });
        SeriesCrossing {
            displacement: self.way(piece, from, s).moved,
            parameter: from + s,
        }
    }
}

/// T − t − |X − x| after moving by `moved` along a line, with its derivative.
pub(super) fn delay_left(
    offset: Displacement<World>,
    moved: Displacement<World>,
    tangent: Displacement<World>,
) -> Sample {
    let left = offset - moved;
    let distance = left.x.length();
    // −d|X − x|/ds: the rate at which the distance shrinks. It has a kink at the apex, where 0 lies between both slopes.
    let closing = if distance > 0.0 {
        left.x.dot(tangent.x) / distance
    } else {
        0.0
    };
    Sample {
        value: left.ct - distance,
        slope: closing - tangent.ct,
        // One rounding error of each number in the value.
        noise: f64::EPSILON * (left.ct.abs() + distance + moved.ct.abs() + moved.x.length()),
    }
}

fn displacement(v: DVec4) -> Displacement<World> {
    Displacement::new(v.w, v.truncate())
}
