//! W of samples that see objects at rest in one frame, from their film points:
//!
//! ```text
//! W = W_camera(d′) W_rest(d),     d′ the direction in which the camera looks at the sample, d that in the world.
//! ```

use glam::DVec3;

use crate::accel::vectors::{VectorLoop, dispatch};
use crate::camera::{AnyProjection, Camera, Point, Projection};
use crate::spacetime::{Boost, CameraFrame, Direction, Rest, World};

/// The number of samples whose W are computed together.
const LANES: usize = 16;

/// A camera whose rays all leave one event.
#[derive(Debug)]
pub(super) struct CameraRatios<'a> {
    film: &'a AnyProjection,
    /// `None` for a camera that rests in the world.
    world_from_camera: Option<Boost<World, CameraFrame>>,
    /// Whether directions of the camera are used as the world's.
    is_unaberrated: bool,
}

impl<'a> CameraRatios<'a> {
    /// The ratios for `camera`; `None` if rays have their own events.
    pub fn of(camera: &'a Camera) -> Option<Self> {
        let shot = &camera.shot;
        let (moves, is_unaberrated) = match camera.view.point()? {
            Point::Still(_) => (false, false),
            Point::Moving(_) => (true, false),
            Point::Unaberrated(_) => (true, true),
        };
        let boost = *shot.frame.world_from_frame();
        Some(CameraRatios {
            film: &shot.projection,
            world_from_camera: (moves && !boost.is_identity()).then_some(boost),
            is_unaberrated,
        })
    }

    /// Whether W of objects at rest in the world differs from sample to sample.
    pub fn differ(&self) -> bool {
        self.world_from_camera.is_some()
    }

    /// Fills `ratios` with W of the samples at these film points, counted from `corner`, that see the rest frame to which `rest` boosts.
    pub fn fill(
        &self,
        rest: &Boost<Rest, World>,
        [x, y]: [&[f64]; 2],
        corner: [f64; 2],
        ratios: &mut [f64],
    ) {
        let rest_from_world = (!rest.is_identity()).then_some(rest);
        if !self.differ() && rest_from_world.is_none() {
            return ratios.fill(1.0);
        }
        // The most common projection is matched here, rather than at each film point.
        match self.film {
            AnyProjection::Perspective(film) => {
                self.fill_through(film, rest_from_world, [x, y], corner, ratios);
            }
            film => self.fill_through(film, rest_from_world, [x, y], corner, ratios),
        }
    }

    /// [`CameraRatios::fill`] with the camera's projection, `film`.
    fn fill_through<P: Projection>(
        &self,
        film: &P,
        rest_from_world: Option<&Boost<Rest, World>>,
        points: [&[f64]; 2],
        corner: [f64; 2],
        ratios: &mut [f64],
    ) {
        dispatch(RatioLoop {
            film,
            world_from_camera: self.world_from_camera.as_ref(),
            is_unaberrated: self.is_unaberrated,
            rest_from_world,
            points,
            corner,
            ratios,
        });
    }
}

/// The loop over film points.
struct RatioLoop<'a, P> {
    film: &'a P,
    world_from_camera: Option<&'a Boost<World, CameraFrame>>,
    is_unaberrated: bool,
    rest_from_world: Option<&'a Boost<Rest, World>>,
    points: [&'a [f64]; 2],
    corner: [f64; 2],
    ratios: &'a mut [f64],
}

impl<P: Projection> VectorLoop for RatioLoop<'_, P> {
    #[inline(always)]
    fn run(self) {
        let [left, top] = self.corner;
        let [x, y] = self.points.map(|all| all.chunks(LANES));
        for ((x, y), to) in x.zip(y).zip(self.ratios.chunks_mut(LANES)) {
            // The last points are padded to a whole vector, of which only their part is stored.
            let mut last = [[0.0; LANES]; 2];
            let (at_x, at_y): (&[f64; LANES], &[f64; LANES]) =
                match (x.first_chunk(), y.first_chunk()) {
                    (Some(x), Some(y)) => (x, y),
                    _ => {
                        last[0][..x.len()].copy_from_slice(x);
                        last[1][..y.len()].copy_from_slice(y);
                        (&last[0], &last[1])
                    }
                };
            // Short loops, one step after the other: compilers do not vectorize long ones for AVX2.
            let (mut dx, mut dy, mut dz) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
            for k in 0..LANES {
                let d = self.film.direction(at_x[k] + left, at_y[k] + top).unit();
                (dx[k], dy[k], dz[k]) = (d.x, d.y, d.z);
            }
            // W_camera, and then W_rest of the direction in the world.
            let mut ratios = [1.0; LANES];
            if let Some(boost) = self.world_from_camera.copied() {
                // Directions are needed in the world only for a second boost, and boosted only with aberration.
                if self.is_unaberrated || self.rest_from_world.is_none() {
                    for k in 0..LANES {
                        let d = Direction::from_unit(DVec3::new(dx[k], dy[k], dz[k]));
                        ratios[k] = boost.direction_of_moving(d).1;
                    }
                } else {
                    for k in 0..LANES {
                        let d = Direction::from_unit(DVec3::new(dx[k], dy[k], dz[k]));
                        let (d, ratio) = boost.direction_of_moving(d);
                        ratios[k] = ratio;
                        (dx[k], dy[k], dz[k]) = (d.unit().x, d.unit().y, d.unit().z);
                    }
                }
            }
            if let Some(boost) = self.rest_from_world.copied() {
                for k in 0..LANES {
                    let d = Direction::from_unit(DVec3::new(dx[k], dy[k], dz[k]));
                    ratios[k] *= boost.direction_of_moving(d).1;
                }
            }
            match to.first_chunk_mut() {
                Some(to) => *to = ratios,
                None => to.copy_from_slice(&ratios[..to.len()]),
            }
        }
    }
}
