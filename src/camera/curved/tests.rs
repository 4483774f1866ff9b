use super::*;
use crate::accel::numbers;
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::camera::AnyProjection;
use crate::scene::model::ProjectionKind;

/// The look directions of a block, and their lengths.
struct Look<'a, P>(&'a P, [&'a Block; 2], &'a mut [Block; 3], &'a mut Block);

impl<P: Projection> VectorLoop for Look<'_, P> {
    #[inline(always)]
    fn run(self) {
        self.0.directions_and_lengths(self.1, self.2, self.3);
    }
}

#[test]
fn directions_of_blocks_have_the_bits_of_those_one_by_one() {
    let axes = [
        DVec3::new(0.6, 0.0, -0.8),
        DVec3::new(0.48, 0.8, 0.36),
        DVec3::new(0.64, -0.6, 0.48),
    ];
    let kinds = [
        (ProjectionKind::Perspective, 100.0),
        (ProjectionKind::FisheyeEquidistant, 180.0),
        (ProjectionKind::FisheyeEquidistant, 360.0),
        (ProjectionKind::FisheyeEquisolid, 360.0),
        (ProjectionKind::FisheyeOrthographic, 180.0),
        (ProjectionKind::Equirectangular, 360.0),
    ];
    for (kind, degrees) in kinds {
        let of = |size| AnyProjection::of_kind(kind, axes, f64::to_radians(degrees), size);
        // The middle, the edges, and film points that see nothing, which are in the majority on a tall film.
        let (mut seen, mut next) = (0, numbers(3));
        for size in [[401.0, 200.0], [401.0, 4000.0]] {
            let film = of(size);
            for block in 0..200 {
                let [width, height] = size;
                let at = |k: usize, across: f64, random: f64| match (block * BLOCK + k) % 9 {
                    0 => 0.5 * across,
                    1 => 0.0,
                    2 => across,
                    3 => 0.25 * across,
                    _ => 0.5 * (1.0 + random) * across,
                };
                let x: Block = std::array::from_fn(|k| at(k, width, next()));
                let y: Block = std::array::from_fn(|k| at(k / 9, height, next()));
                let (mut to, mut lengths) = ([[0.0; BLOCK]; 3], [0.0; BLOCK]);
                dispatch(Look(&film, [&x, &y], &mut to, &mut lengths));
                for k in 0..BLOCK {
                    let (d, length) = film.direction_and_length(x[k], y[k]);
                    let expected = [d.unit().x, d.unit().y, d.unit().z, length];
                    let found = [to[0][k], to[1][k], to[2][k], lengths[k]];
                    let bits = |all: [f64; 4]| all.map(f64::to_bits);
                    assert_eq!(bits(found), bits(expected), "{kind:?} {} {}", x[k], y[k]);
                    seen += usize::from(film.sees(x[k], y[k]));
                    assert!(film.sees(x[k], y[k]) || d.unit().dot(axes[2]) > 1.0 - 1e-15);
                }
            }
        }
        assert!(seen > 1000, "{kind:?} {seen}");
    }
}
