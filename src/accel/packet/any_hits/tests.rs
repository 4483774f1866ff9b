use super::*;
use crate::accel::packet::method::{Kernel, Precision, Traversal};
use crate::accel::vectors::Columns;
use crate::accel::{Bvh, Facing, numbers};

#[test]
fn segments_to_one_point_are_blocked_as_single_ones_are() {
    let mut next = numbers(11);
    let mut vector = || DVec3::new(next(), next(), next());
    // A tree of usual size, and one small enough for incoherent rays.
    for triangles in [3000, 40] {
        let corners: Vec<[DVec3; 3]> = (0..triangles)
            .map(|_| {
                let centre = vector();
                [centre, centre + vector() * 0.1, centre + vector() * 0.1]
            })
            .collect();
        let bvh = Bvh::build(corners.clone(), |_| Facing::TwoSided);
        // Near, in a corner of a triangle, beyond the range of packets, and nowhere.
        let ends = [
            DVec3::new(0.1, 0.2, 0.3),
            corners[7][1],
            DVec3::splat(1e5),
            DVec3::new(0.0, f64::NAN, 0.0),
        ];
        for end in ends {
            for count in [0, 5, 37, 64, 256, 700] {
                let mut from = Columns::default();
                let (mut s_min, mut skip) = (Vec::new(), Vec::new());
                for k in 0..count {
                    // On triangles; every other point is on the same triangle as the one before.
                    let triangle = (k / 2 * 5) % triangles;
                    let [a, b, c] = corners[triangle];
                    let place = match k % 7 {
                        0 => a,
                        1 => a.midpoint(b),
                        _ => (a + b + c) / 3.0 + vector() * 1e-3,
                    };
                    // One of them is at infinity, where no ray can start.
                    from.push(if k == 33 {
                        place * f64::INFINITY
                    } else {
                        place
                    });
                    s_min.push(1e-9);
                    skip.push(triangle as u32);
                }
                let segments = Converging {
                    end,
                    from: from.axes(),
                    s_min: &s_min,
                    skip: &skip,
                    // With and without a triangle at which all end, which does not block.
                    at: (count % 2 == 0).then_some(7),
                };
                let single: Vec<_> = (0..count).map(|k| segments.segment(k)).collect();
                let method = |kernel| Traversal {
                    kernel,
                    precision: Precision::Certified,
                };
                let mut expected = vec![false; count];
                bvh.any_by(method(Kernel::Scalar), &single, &mut expected, None);
                for kernel in Kernel::ALL.into_iter().filter(|k| k.is_supported()) {
                    let mut blocked = vec![true; count];
                    bvh.any_to_point(method(kernel), segments, &mut blocked, None);
                    assert_eq!(blocked, expected, "{kernel:?}, {count} to {end}");
                }
            }
        }
    }
}
