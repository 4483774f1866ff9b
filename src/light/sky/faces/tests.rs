use super::*;

/// Directions all over the sky, with many near edges and corners of the cube.
fn directions() -> impl Iterator<Item = DVec3> {
    let mut state = 7u64;
    let mut next = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..3000).map(move |k| {
        let v = DVec3::new(next(), next(), next());
        let towards = match k % 3 {
            0 => v,
            1 => DVec3::new(v.x.signum(), v.y.signum(), v.z) + 0.05 * v,
            _ => v.signum() + 0.05 * v,
        };
        towards.normalize()
    })
}

#[test]
fn every_disc_is_found_from_all_directions_in_it() {
    let all: Vec<_> = directions().collect();
    for sine in [1e-9, 1e-3, 0.02, 0.5] {
        let grid = Grid { cells: 16 };
        let index = Index::new(grid, (0..).zip(&all).map(|(k, d)| (k, *d, sine)));
        for (k, d) in all.iter().enumerate() {
            // Within the disc, just inside its edge, in some direction.
            let side = d.any_orthonormal_vector();
            let turned = side * (k as f64).cos() + d.cross(side) * (k as f64).sin();
            let (sin, cos) = (sine * (1.0 - 1e-9), (1.0 - sine * sine).sqrt());
            let look = (*d * cos + turned * sin).normalize().to_array();
            let near = Rectangle::of(look, look).unwrap().widened(sine);
            let mut rows = index.rows(near, usize::MAX).unwrap();
            assert!(rows.any(|row| row.contains(&k)), "{sine} {d}");
            // And few others are listed.
            if sine < 0.1 {
                let rows = index.rows(near, 9);
                assert!(rows.is_some(), "{sine} {d}");
            }
        }
    }
}

#[test]
fn a_rectangle_holds_all_directions_between_the_bounds() {
    let all: Vec<_> = directions().collect();
    let (mut whole, mut parts) = (0, 0);
    for chunk in all.chunks(3) {
        let near: Vec<_> = chunk
            .iter()
            .map(|d| (chunk[0] + 0.1 * *d).normalize())
            .collect();
        let low = near.iter().fold(DVec3::ONE, |low, d| low.min(*d));
        let high = near.iter().fold(-DVec3::ONE, |high, d| high.max(*d));
        let faces: Vec<_> = near.iter().map(|d| on_cube(*d)).collect();
        match Rectangle::of(low.to_array(), high.to_array()) {
            Some(held) => {
                whole += 1;
                for (face, place) in faces {
                    assert_eq!(face, held.face);
                    for (x, [first, last]) in place.iter().zip(held.sides) {
                        assert!(first - 1e-12 <= *x && *x <= last + 1e-12);
                    }
                }
            }
            None => parts += 1,
        }
    }
    assert!(whole > 100 && parts > 100, "{whole} {parts}");
}
