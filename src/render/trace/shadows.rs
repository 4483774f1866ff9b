//! Shadow rays from the points of a run, through all rest frames.

use super::occlusion::{Obstacles, OcclusionQueries, Places};
use super::point_columns::Points;
use super::run::Run;
use super::stats::Meter;
use super::surfaces::{Frame, Frames, Many, Surfaces};
use crate::accel::vectors::{BLOCK, Columns, VectorLoop, dispatch, load};
use crate::spacetime::Direction;

impl Surfaces<'_> {
    /// Answers `queries` about the points of `run`, which are in `points`, in a medium of index `index`.
    pub(super) fn occlude(
        &self,
        queries: &mut OcclusionQueries,
        run: &Run,
        points: &Points,
        index: f64,
        meter: &mut Meter,
    ) {
        let method = run.traced.rays.method;
        match &self.0 {
            // Everything rests in the world: no boost is needed, and the triangle that a ray leaves is skipped by its number.
            Frames::Still(only) => {
                let obstacles = Obstacles {
                    bvh: &only.rest.bvh,
                    frame: 0,
                    boost: None,
                    places: points,
                    own: Some(&points.triangles),
                };
                queries.ask(&obstacles, method, meter.occlusion());
            }
            // One moving frame: directions and delays are in its own axes.
            Frames::One(only) => {
                let obstacles = Obstacles {
                    bvh: &only.rest.bvh,
                    frame: 0,
                    boost: Some((only.boost(), index)),
                    places: points,
                    own: Some(&points.triangles),
                };
                queries.ask(&obstacles, method, meter.occlusion());
            }
            Frames::Many(Many { frames, tubes, .. }) => {
                // Several frames: each is tested for the queries that no frame before it blocks, and skipped if all rays miss the tube that
                // its bodies sweep.
                let bundle = queries.bundle(points, index);
                for (k, frame) in frames.iter().enumerate() {
                    if !tubes.may_meet(k, &bundle) {
                        continue;
                    }
                    let (bvh, boost) = (&frame.rest.bvh, Some((frame.boost(), index)));
                    // In their own frame the positions of the points are known, and the triangles on which they lie.
                    if k as u32 == run.frame {
                        let obstacles = Obstacles {
                            bvh,
                            frame: k as u32,
                            boost,
                            places: points,
                            own: Some(&points.triangles),
                        };
                        queries.ask(&obstacles, method, meter.occlusion());
                    } else {
                        let obstacles = Obstacles {
                            bvh,
                            frame: k as u32,
                            boost,
                            places: InOther { frame, run, points },
                            own: None,
                        };
                        queries.ask(&obstacles, method, meter.occlusion());
                    }
                }
            }
        }
    }
}

/// Points of a run in another rest frame than their own.
struct InOther<'a> {
    frame: &'a Frame<'a>,
    run: &'a Run<'a>,
    points: &'a Points,
}

impl Places for InOther<'_> {
    fn find(&self, points: &[u32], eyes: &mut Columns, from: &mut Columns) {
        eyes.clear();
        from.clear();
        let points = points.iter().map(|k| *k as usize);
        let rays = &self.run.traced.rays;
        if rays.origins.is_some() {
            for k in points {
                let (local, _) = self.frame.boosted_ray(self.run.members[k] as usize, rays);
                eyes.push(local.origin.x);
                from.push(local.at(self.points.s[k]).x);
            }
            return;
        }
        // Rays that share the shot: first the directions, and the points' distances along them.
        let mut s = Vec::new();
        for k in points {
            from.push(rays.directions[self.run.members[k] as usize]);
            eyes.push(self.frame.shot.x);
            s.push(self.points.s[k]);
        }
        dispatch(AlongRays {
            frame: self.frame,
            s: &s,
            places: from,
        });
    }
}

/// The loop from look directions in the world to positions on the rays from the shot.
struct AlongRays<'a> {
    frame: &'a Frame<'a>,
    s: &'a [f64],
    places: &'a mut Columns,
}

impl VectorLoop for AlongRays<'_> {
    #[inline(always)]
    fn run(self) {
        let Frame { shot, index, .. } = *self.frame;
        let boost = self.frame.rest.frame.frame_from_world();
        let mut begin = 0;
        while begin < self.s.len() {
            let (mut places, s) = (self.places.load(begin), load(self.s, begin));
            for (k, s) in s.iter().enumerate() {
                let d = Direction::from_unit(places.get(k));
                let (tangent, _) = boost.tangent_and_ratio(index, d);
                places.set(k, (shot + tangent * *s).x);
            }
            self.places.store(&places, begin);
            begin += BLOCK;
        }
    }
}
