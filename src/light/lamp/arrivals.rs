//! The light of one lamp at many points: the results of [`Lamp::arrival`], in loops over arrays.

use glam::DVec3;

use super::{
    Accelerated, Arrival, AtRest, Cone, Emitter, Inertial, Lamp, ParallelAtRest, ParallelInertial,
    Path, within_cone,
};
use crate::accel::vectors::{
    BLOCK, Block, Columns, VectorLoop, Vectors, VectorsRef, block_of, dispatch, load, store,
};
use crate::spacetime::{Displacement, Event, World};

/// Events or displacements by component.
#[derive(Debug, Default)]
pub(crate) struct EventColumns {
    pub ct: Vec<f64>,
    pub x: Columns,
}

/// Points on world rays.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PointsOnRays<'a> {
    /// The event where all rays start, or relative to which their own start events are given.
    pub shot: Event<World>,
    pub start: Start<'a>,
}

/// The positions of points relative to where their rays start.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Start<'a> {
    /// All rays start at the shot: points at `s` along the tangents (−`index`, d).
    Shot {
        index: f64,
        directions: &'a Columns,
        s: &'a [f64],
    },
    /// Each ray starts at its own event of the world, with its own displacement.
    Own {
        events: &'a EventColumns,
        offsets: &'a EventColumns,
    },
}

impl PointsOnRays<'_> {
    /// Number of points.
    pub fn count(&self) -> usize {
        match self.start {
            Start::Shot { s, .. } => s.len(),
            Start::Own { events, .. } => events.ct.len(),
        }
    }
}

/// The light of a lamp at each point; see [`Arrival`](super::Arrival).
#[derive(Debug, Default)]
pub(crate) struct Arrivals {
    /// Direction to the lamp in the world; NaN if no light arrives.
    pub d: Columns,
    /// Distance to the lamp in the world, metres; infinite for parallel light.
    pub distance: Vec<f64>,
    /// Intensity towards the point for a lamp of intensity 1.
    pub strength: Vec<f64>,
    /// ω_G/ω_world.
    pub ratio: Vec<f64>,
    pub(super) inverse: Vec<f64>,
    pub(super) fade: Vec<f64>,
    /// Direction to the lamp in its frame, if its intensity depends on direction.
    in_lamp: Columns,
    is_aimed: bool,
}

impl EventColumns {
    /// Makes room for `count` events, which must be filled in.
    pub fn resize(&mut self, count: usize) {
        self.ct.resize(count, 0.0);
        self.x.resize(count);
    }
}

impl Arrivals {
    fn resize(&mut self, count: usize, is_aimed: bool) {
        self.is_aimed = is_aimed;
        for column in [
            &mut self.distance,
            &mut self.strength,
            &mut self.ratio,
            &mut self.inverse,
            &mut self.fade,
        ] {
            column.resize(count, 0.0);
        }
        self.d.resize(count);
        self.in_lamp.resize(count);
    }
}

impl Lamp {
    /// The light that reaches each of `points`, in a medium of index `index`.
    pub(crate) fn arrivals(&self, points: &PointsOnRays, index: f64, to: &mut Arrivals) {
        let is_aimed = matches!(self.beam, Cone::Spot { .. });
        to.resize(points.count(), is_aimed);
        // A strength of 0 makes every point dark, whatever the other columns hold.
        if !self.arrive(points, index, to) {
            return to.strength.fill(0.0);
        }
        // The strength, which so far holds the proper time.
        self.emission.at_each(&mut to.strength);
        if let Cone::Spot { axis, outer, inner } = self.beam {
            dispatch(Attenuate {
                axis,
                cone: [outer, inner],
                in_lamp: &to.in_lamp,
                strength: &mut to.strength,
            });
        }
    }

    /// Passes the light that reaches each of `points` to `to`, as if the lamp were steady and isotropic; returns whether any light arrives.
    pub(super) fn arrive(&self, points: &PointsOnRays, index: f64, to: &mut impl Taking) -> bool {
        // Matched once: each kind of lamp has its own loop over blocks.
        match (&self.path, self.beam) {
            (Path::Rest(origin), Cone::Parallel(direction)) => {
                arrive(&ParallelAtRest { direction, index }, *origin, points, to);
            }
            (Path::Inertial(frame), Cone::Parallel(direction)) => {
                let path = ParallelInertial::new(frame, direction);
                arrive(&path, frame.origin(), points, to);
            }
            (Path::Line(_), Cone::Parallel(_)) => return false,
            (Path::Rest(origin), _) => arrive(&AtRest { index }, *origin, points, to),
            (Path::Inertial(frame), _) => {
                arrive(&Inertial { frame }, frame.origin(), points, to);
            }
            (Path::Line(line), _) => {
                arrive(&Accelerated::new(line), line.1.event, points, to);
            }
        }
        true
    }
}

/// A receiver of arrivals, block by block.
pub(super) trait Taking {
    /// Buffers on the stack of the loop over blocks.
    type Buffers;
    /// Buffers to be filled in.
    const BUFFERS: Self::Buffers;
    /// Takes the arrivals at points from `begin` on. To be inlined into a [`VectorLoop`].
    fn take(&mut self, begin: usize, block: &ArrivalsBlock, buffers: &mut Self::Buffers);
}

impl Taking for Arrivals {
    type Buffers = ();
    const BUFFERS: () = ();

    #[inline(always)]
    fn take(&mut self, begin: usize, block: &ArrivalsBlock, (): &mut ()) {
        self.d.store(&block.d, begin);
        if self.is_aimed {
            self.in_lamp.store(&block.in_lamp, begin);
        }
        store(&block.distance, &mut self.distance, begin);
        // `strength` holds proper times until the emission at these times replaces them.
        store(&block.times, &mut self.strength, begin);
        store(&block.ratio, &mut self.ratio, begin);
        store(&block.inverse, &mut self.inverse, begin);
        store(&block.fade, &mut self.fade, begin);
    }
}

/// Passes the light of `emitter`, whose own event is `from`, to `to`.
fn arrive(emitter: &impl Emitter, from: Event<World>, points: &PointsOnRays, to: &mut impl Taking) {
    match points.start {
        Start::Shot {
            index,
            directions,
            s,
        } => dispatch(Arrive {
            emitter,
            ways: FromShot {
                start: points.shot - from,
                index,
                directions,
                s,
            },
            to,
        }),
        Start::Own { events, offsets } => dispatch(Arrive {
            emitter,
            ways: FromOwn {
                from,
                events,
                offsets,
            },
            to,
        }),
    }
}

/// Displacements from a lamp's own event to points.
pub(super) trait Ways {
    /// Displacements to a block of points.
    type Block<'a>;
    fn count(&self) -> usize;
    /// Displacements to the points from `begin` on; those of a partial last block may be copied to `last`.
    fn block<'a>(&'a self, begin: usize, last: &'a mut [Block; 2]) -> Self::Block<'a>;
    /// The displacement to point `k` of a block.
    fn at(block: &Self::Block<'_>, k: usize) -> Displacement<World>;
}

struct FromShot<'s> {
    /// Displacement to the shot.
    start: Displacement<World>,
    index: f64,
    directions: &'s Columns,
    s: &'s [f64],
}

impl Ways for FromShot<'_> {
    type Block<'a> = (Displacement<World>, f64, VectorsRef<'a>, &'a Block);

    #[inline(always)]
    fn count(&self) -> usize {
        self.s.len()
    }

    #[inline(always)]
    fn block<'a>(&'a self, begin: usize, [last, _]: &'a mut [Block; 2]) -> Self::Block<'a> {
        let s = block_of(self.s, begin, last);
        (self.start, self.index, self.directions.block(begin), s)
    }

    #[inline(always)]
    fn at((start, index, directions, s): &Self::Block<'_>, k: usize) -> Displacement<World> {
        // From the lamp to the shot, and from there along the past light cone: s (−η, d).
        *start + Displacement::new(-*index * s[k], directions.get(k) * s[k])
    }
}

struct FromOwn<'s> {
    from: Event<World>,
    events: &'s EventColumns,
    offsets: &'s EventColumns,
}

impl Ways for FromOwn<'_> {
    type Block<'a> = (Event<World>, [(&'a Block, VectorsRef<'a>); 2]);

    #[inline(always)]
    fn count(&self) -> usize {
        self.events.ct.len()
    }

    #[inline(always)]
    fn block<'a>(&'a self, begin: usize, last: &'a mut [Block; 2]) -> Self::Block<'a> {
        let [last_event, last_offset] = last;
        let (events, offsets) = (self.events, self.offsets);
        let events = (
            block_of(&events.ct, begin, last_event),
            events.x.block(begin),
        );
        let offsets = (
            block_of(&offsets.ct, begin, last_offset),
            offsets.x.block(begin),
        );
        (self.from, [events, offsets])
    }

    #[inline(always)]
    fn at((from, [events, offsets]): &Self::Block<'_>, k: usize) -> Displacement<World> {
        // The difference of the two events first: both may be far from the world's origin.
        let event = Event::new(events.0[k], events.1.get(k));
        (event - *from) + Displacement::new(offsets.0[k], offsets.1.get(k))
    }
}

/// Arrivals at a block of points, as if the lamp were steady and isotropic, and the proper times of emission. On the stack, and of fixed
/// size: only loops over such blocks are vectorized.
pub(super) struct ArrivalsBlock {
    pub d: Vectors,
    pub in_lamp: Vectors,
    pub distance: Block,
    pub times: Block,
    pub ratio: Block,
    pub inverse: Block,
    pub fade: Block,
}

impl ArrivalsBlock {
    /// A block to be filled in.
    const ZERO: ArrivalsBlock = ArrivalsBlock {
        d: Vectors::ZERO,
        in_lamp: Vectors::ZERO,
        distance: [0.0; BLOCK],
        times: [0.0; BLOCK],
        ratio: [0.0; BLOCK],
        inverse: [0.0; BLOCK],
        fade: [0.0; BLOCK],
    };

    /// Writes the arrival at point `k`, except for the proper time.
    #[inline(always)]
    pub fn set(&mut self, k: usize, arrival: &Arrival) {
        self.d.set(k, arrival.d.unit());
        self.distance[k] = arrival.distance;
        self.ratio[k] = arrival.ratio;
        self.inverse[k] = arrival.inverse;
        self.fade[k] = arrival.fade;
        self.in_lamp.set(k, arrival.in_lamp);
    }
}

/// The loop over points.
struct Arrive<'a, E, W, T> {
    emitter: &'a E,
    ways: W,
    to: &'a mut T,
}

impl<E: Emitter, W: Ways, T: Taking> VectorLoop for Arrive<'_, E, W, T> {
    #[inline(always)]
    fn run(self) {
        let Arrive { emitter, ways, to } = self;
        // One block on the stack for all: the compiler sees that it overlaps with nothing.
        let mut block = ArrivalsBlock::ZERO;
        let (mut last, mut buffers) = ([[0.0; BLOCK]; 2], T::BUFFERS);
        let mut begin = 0;
        while begin < ways.count() {
            emitter.arrivals::<W>(&ways.block(begin, &mut last), &mut block);
            to.take(begin, &block, &mut buffers);
            begin += BLOCK;
        }
    }
}

/// Applies the attenuation of a spot light's cone.
struct Attenuate<'a> {
    axis: DVec3,
    cone: [f64; 2],
    in_lamp: &'a Columns,
    strength: &'a mut [f64],
}

impl VectorLoop for Attenuate<'_> {
    #[inline(always)]
    fn run(self) {
        let mut begin = 0;
        while begin < self.strength.len() {
            let in_lamp = self.in_lamp.load(begin);
            let mut strength = load(self.strength, begin);
            for (k, strength) in strength.iter_mut().enumerate() {
                *strength *= within_cone(self.axis, self.cone, in_lamp.get(k));
            }
            store(&strength, self.strength, begin);
            begin += BLOCK;
        }
    }
}
