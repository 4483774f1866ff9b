//! The cost of tracing rays. It is always counted: that takes less than the spread of measurements, and a second copy of each kernel without it
//! would double the time to compile them.

use std::ops::AddAssign;

/// The kinds of work counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Work {
    /// Rays requested.
    Rays,
    /// Nodes visited, once per block of rays or single ray.
    Nodes,
    /// Triangles tested, once per block of rays or single ray.
    Triangles,
    /// Pairs of ray and triangle that f32 left to f64.
    Doubts,
    /// Pairs of ray and triangle that f64 left to exact arithmetic.
    Exact,
    /// Rays traced one by one.
    Singles,
}

/// The work of tracing rays, by kind.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counts {
    /// Rays requested.
    pub rays: u64,
    /// Nodes visited, once per block of rays or single ray.
    pub nodes: u64,
    /// Triangles tested, once per block of rays or single ray.
    pub triangles: u64,
    /// Pairs of ray and triangle that f32 left to f64.
    pub doubts: u64,
    /// Pairs of ray and triangle that f64 left to exact arithmetic.
    pub exact: u64,
    /// Rays traced one by one.
    pub singles: u64,
}

impl Counts {
    /// Adds `times` pieces of `work`.
    #[inline(always)]
    pub(super) fn add(&mut self, work: Work, times: usize) {
        *match work {
            Work::Rays => &mut self.rays,
            Work::Nodes => &mut self.nodes,
            Work::Triangles => &mut self.triangles,
            Work::Doubts => &mut self.doubts,
            Work::Exact => &mut self.exact,
            Work::Singles => &mut self.singles,
        } += times as u64;
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Counts) {
        self.rays += other.rays;
        self.nodes += other.nodes;
        self.triangles += other.triangles;
        self.doubts += other.doubts;
        self.exact += other.exact;
        self.singles += other.singles;
    }
}
