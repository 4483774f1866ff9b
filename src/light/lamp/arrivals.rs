//! The light of one lamp at many points: what [`Lamp::arrival`] says of each, in loops over arrays.

use glam::DVec3;

use super::{
    Accelerated, AtRest, Cone, Emitter, Inertial, Lamp, ParallelAtRest, ParallelInertial, Path,
    within_cone,
};
use crate::accel::vectors::{
    BLOCK, Block, Columns, VectorLoop, Vectors, block_of, dispatch, load, store,
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
    /// Where all rays leave.
    pub shot: Event<World>,
    /// Where each of them does; none if all leave the shot.
    pub origins: Option<&'a EventColumns>,
    /// From there to the points.
    pub offsets: &'a EventColumns,
}

/// What comes of a lamp, by point; see [`Arrival`](super::Arrival).
#[derive(Debug, Default)]
pub(crate) struct Arrivals {
    /// Towards the lamp in the world; NaN where no light comes.
    pub d: Columns,
    /// To the lamp in the world, metres; infinite for parallel light.
    pub distance: Vec<f64>,
    /// Intensity towards the point for one of 1.
    pub strength: Vec<f64>,
    /// ω_G/ω_world.
    pub ratio: Vec<f64>,
    pub(super) reach: Vec<f64>,
    /// Towards the lamp in its frame, where it does not shine everywhere alike.
    in_lamp: Columns,
    is_aimed: bool,
}

impl EventColumns {
    /// Makes room for `count` events; what they are is to be written.
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
            &mut self.reach,
        ] {
            column.resize(count, 0.0);
        }
        self.d.resize(count);
        self.in_lamp.resize(count);
    }
}

impl Lamp {
    /// What falls on each of `points`, in a medium of index `index`.
    pub(crate) fn arrivals(&self, points: &PointsOnRays, index: f64, to: &mut Arrivals) {
        let is_aimed = matches!(self.beam, Cone::Spot { .. });
        to.resize(points.offsets.ct.len(), is_aimed);
        if !self.arrive(points, index, to) {
            return to.strength.fill(0.0);
        }
        // Its strength, which so far is the proper time.
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

    /// Has `to` take what comes to each of `points`, as if it were steady and shone everywhere; whether anything comes.
    pub(super) fn arrive(&self, points: &PointsOnRays, index: f64, to: &mut impl Taking) -> bool {
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

/// What arrivals go to, block by block.
pub(super) trait Taking {
    /// Buffers on the stack of the loop over blocks.
    type Buffers;
    /// To be written.
    const BUFFERS: Self::Buffers;
    /// Takes those at points from `begin` on. To be inlined into a [`VectorLoop`].
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
        // `strength` holds proper times until the emission at them replaces them.
        store(&block.times, &mut self.strength, begin);
        store(&block.ratio, &mut self.ratio, begin);
        store(&block.reach, &mut self.reach, begin);
    }
}

/// Has `to` take what comes from `emitter`, whose own event is `from`.
fn arrive(emitter: &impl Emitter, from: Event<World>, points: &PointsOnRays, to: &mut impl Taking) {
    let offsets = points.offsets;
    match points.origins {
        None => dispatch(Arrive {
            emitter,
            starts: Shared(points.shot - from),
            offsets,
            to,
        }),
        Some(origins) => dispatch(Arrive {
            emitter,
            starts: Each(origins, from),
            offsets,
            to,
        }),
    }
}

/// From a lamp's own event to where rays leave.
trait Starts {
    /// Of a block of rays.
    type Block;
    /// Those from `begin` on.
    fn load(&self, begin: usize) -> Self::Block;
    fn at(&self, block: &Self::Block, k: usize) -> Displacement<World>;
}

struct Shared(Displacement<World>);

impl Starts for Shared {
    type Block = ();

    #[inline(always)]
    fn load(&self, _: usize) {}

    #[inline(always)]
    fn at(&self, (): &(), _: usize) -> Displacement<World> {
        self.0
    }
}

struct Each<'a>(&'a EventColumns, Event<World>);

impl Starts for Each<'_> {
    type Block = (Block, Vectors);

    #[inline(always)]
    fn load(&self, begin: usize) -> (Block, Vectors) {
        (load(&self.0.ct, begin), self.0.x.load(begin))
    }

    #[inline(always)]
    fn at(&self, (ct, x): &(Block, Vectors), k: usize) -> Displacement<World> {
        Event::new(ct[k], x.get(k)) - self.1
    }
}

/// Arrivals at a block of points, as if the lamp were steady and shone everywhere, and the proper times at which they left. On the stack,
/// and by number: only loops over such blocks become vector code.
pub(super) struct ArrivalsBlock {
    pub d: Vectors,
    pub in_lamp: Vectors,
    pub distance: Block,
    pub times: Block,
    pub ratio: Block,
    pub reach: Block,
}

impl ArrivalsBlock {
    /// To be written.
    const ZERO: ArrivalsBlock = ArrivalsBlock {
        d: Vectors::ZERO,
        in_lamp: Vectors::ZERO,
        distance: [0.0; BLOCK],
        times: [0.0; BLOCK],
        ratio: [0.0; BLOCK],
        reach: [0.0; BLOCK],
    };
}

/// The loop over points.
struct Arrive<'a, E, S, T> {
    emitter: &'a E,
    starts: S,
    offsets: &'a EventColumns,
    to: &'a mut T,
}

impl<E: Emitter, S: Starts, T: Taking> VectorLoop for Arrive<'_, E, S, T> {
    #[inline(always)]
    fn run(self) {
        let Arrive {
            emitter,
            starts,
            offsets,
            to,
        } = self;
        let mut block = ArrivalsBlock::ZERO;
        let (mut way_times, mut ways) = ([0.0; BLOCK], Vectors::ZERO);
        let (mut last, mut buffers) = ([0.0; BLOCK], T::BUFFERS);
        let mut begin = 0;
        while begin < offsets.ct.len() {
            let ct = block_of(&offsets.ct, begin, &mut last);
            let x = offsets.x.block(begin);
            let from = starts.load(begin);
            for k in 0..BLOCK {
                let way = starts.at(&from, k) + Displacement::new(ct[k], x.get(k));
                way_times[k] = way.ct;
                ways.set(k, way.x);
            }
            emitter.arrivals(&way_times, &ways, &mut block);
            to.take(begin, &block, &mut buffers);
            begin += BLOCK;
        }
    }
}

/// What the cone of a spot light leaves of its strength.
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
