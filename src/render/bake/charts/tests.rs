use super::*;
use crate::accel::numbers;
use crate::mesh::atlas::atlas;

type Triangle = ([DVec3; 3], [DVec2; 3]);

/// The two triangles of a rectangle of the texture (left, right, lower, upper; texels), on a plane of this height.
fn rectangle([left, right, low, high]: [f64; 4], height: f64) -> [Triangle; 2] {
    let corner = |x: f64, y: f64| (DVec3::new(x, height, y), DVec2::new(x, y));
    let [a, b, c, d] = [
        corner(left, low),
        corner(right, low),
        corner(right, high),
        corner(left, high),
    ];
    [[a, b, c], [a, c, d]].map(|corners| (corners.map(|c| c.0), corners.map(|c| c.1)))
}

fn readers(triangles: &[Triangle], size: [usize; 2]) -> Readers {
    Readers::of(triangles.len(), |k| triangles[k], size)
}

/// The texels that a lookup reads.
fn read([x, y]: [f64; 2], [width, height]: [usize; 2]) -> Vec<usize> {
    let near = |x: f64, count: usize| {
        let cell = (x - 0.5).floor();
        [cell, cell + 1.0].map(|at| at.clamp(0.0, count as f64 - 1.0) as usize)
    };
    let (rows, columns) = (near(y, height), near(x, width));
    let all = rows
        .into_iter()
        .flat_map(|i| columns.map(|j| i * width + j));
    all.collect()
}

#[test]
fn triangles_that_share_corners_in_space_and_on_the_texture_are_one_chart() {
    let size = [8, 8];
    // A floor with a wall that begins where it ends, and a ceiling above the wall's place on the texture.
    let floor = rectangle([0.0, 4.0, 0.0, 8.0], 0.0);
    let [mut wall, mut ceiling] = [0.0, 3.0].map(|h| rectangle([4.0, 8.0, 0.0, 8.0], h));
    for (corners, _) in &mut wall {
        for corner in corners {
            *corner = DVec3::new(4.0, corner.x - 4.0, corner.z);
        }
    }
    let joined = readers(&[floor, wall].concat(), size);
    assert_eq!((joined.shared(), joined.bytes()), (0, 0));
    let apart = readers(&[floor, ceiling].concat(), size);
    assert_eq!(apart.shared(), 16, "two columns of eight texels");
    // One common corner is enough, and −0 is the same place as 0.
    ceiling[0].0[0].y = -0.0;
    let joined = readers(&[floor, ceiling].concat(), size);
    assert_eq!(joined.shared(), 0);
}

#[test]
fn texels_count_as_shared_if_lookups_on_two_charts_read_them() {
    let mut signed = numbers(1);
    let mut random = || (signed() + 1.0) / 2.0;
    let size = [12, 9];
    for _ in 0..200 {
        let mut side = |count: usize| {
            let ends = [0.0; 2].map(|_| random() * count as f64);
            [ends[0].min(ends[1]), ends[0].max(ends[1])]
        };
        let rectangles = [0.0, 1.0].map(|height| {
            let ([left, right], [low, high]) = (side(size[0]), side(size[1]));
            ([left, right, low, high], height)
        });
        let triangles = rectangles.map(|(sides, height)| rectangle(sides, height));
        let found = readers(&triangles.concat(), size);
        // Lookups on a fine grid of points inside each rectangle.
        let reads = rectangles.map(|([left, right, low, high], _)| {
            let mut reads = [false; 12 * 9];
            let inside = |from: f64, to: f64, k: u32| {
                let inset = 1.1 * ROUNDING;
                from + inset + (to - from - 2.0 * inset) * f64::from(k) / 200.0
            };
            for k in 0..=200 {
                for l in 0..=200 {
                    for texel in read([inside(left, right, k), inside(low, high, l)], size) {
                        reads[texel] = true;
                    }
                }
            }
            reads
        });
        let both = reads[0].iter().zip(&reads[1]).filter(|(a, b)| **a && **b);
        assert_eq!(found.shared(), both.count() as u64, "{rectangles:?}");
    }
}

#[test]
fn the_charts_of_an_atlas_share_no_texel() {
    let mut signed = numbers(1);
    let mut random = || (signed() + 1.0) / 2.0;
    for k in 0..20 {
        // Loose triangles, each a chart of its own.
        let mut corner = || DVec3::new(random(), random(), random());
        let places: Vec<[DVec3; 3]> = (0..10 + k)
            .map(|_| [corner(), corner(), corner()])
            .collect();
        let side = 60 + 5 * k;
        let made = atlas(&places, [side; 2]).unwrap();
        let at = |k: usize| {
            let corners = made[k].map(|uv| DVec2::new(uv[0].into(), uv[1].into()));
            (places[k], corners.map(|uv| uv * f64::from(side)))
        };
        let readers = Readers::of(places.len(), at, [side as usize; 2]);
        assert!(readers.bytes() > 0);
        assert_eq!(readers.shared(), 0, "{k}");
    }
}
