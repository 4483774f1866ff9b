use super::*;
use crate::mesh::shapes::{Shape, mesh};

fn triangles(shape: Shape) -> Vec<[DVec3; 3]> {
    let mesh = mesh(shape, [0.5; 3]);
    (0..mesh.triangles.len() as u32)
        .map(|t| mesh.corners(t))
        .collect()
}

fn sphere() -> Vec<[DVec3; 3]> {
    triangles(Shape::Sphere {
        radius: 1.0,
        subdivisions: 3,
    })
}

/// A ramp that turns twice around the axis: its second turn is above the first.
fn spiral() -> Vec<[DVec3; 3]> {
    let place = |k: i32, radius: f64| {
        let angle = f64::from(k) * 0.2;
        DVec3::new(radius * angle.cos(), 0.1 * angle, -radius * angle.sin())
    };
    let pair = |k| {
        let [a, b, c, d] = [
            place(k, 1.0),
            place(k, 2.0),
            place(k + 1, 2.0),
            place(k + 1, 1.0),
        ];
        [[a, b, c], [a, c, d]]
    };
    (0..63).flat_map(pair).collect()
}

/// Corners in texels.
fn in_texels(corners: &[Corners], size: [u32; 2]) -> Vec<[DVec2; 3]> {
    let scale = DVec2::new(f64::from(size[0]), f64::from(size[1]));
    let place = |[u, v]: [f32; 2]| DVec2::new(f64::from(u), f64::from(v)) * scale;
    corners.iter().map(|t| t.map(place)).collect()
}

/// Whether no two triangles of `flat` overlap: tests all pairs.
fn is_apart(flat: &[[DVec2; 3]]) -> bool {
    // More than the rounding of f32.
    let shrunk = |t: &[DVec2; 3]| {
        let middle = (t[0] + t[1] + t[2]) / 3.0;
        t.map(|p| middle + (p - middle) * (1.0 - 1e-3))
    };
    let flat: Vec<_> = flat.iter().map(shrunk).collect();
    let pairs = (0..flat.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
    pairs.into_iter().all(|(a, b)| !overlap(&flat[a], &flat[b]))
}

#[test]
fn every_place_of_a_surface_has_coordinates_of_its_own() {
    let boxed = triangles(Shape::Box {
        size: [1.0, 2.0, 0.5],
    });
    for (name, surface, size) in [
        ("box", boxed, [64, 64]),
        ("sphere", sphere(), [96, 64]),
        ("spiral", spiral(), [64, 64]),
    ] {
        let corners = atlas(&surface, size).unwrap();
        let flat = in_texels(&corners, size);
        assert!(is_apart(&flat), "{name}");
        let inside = |p: &DVec2| p.min_element() >= 0.999 && p.x <= f64::from(size[0]) - 0.999;
        assert!(flat.iter().flatten().all(inside), "{name}");
    }
}

#[test]
fn a_ramp_that_turns_above_itself_becomes_several_charts() {
    let charts = charts(&spiral());
    assert!(charts.len() > 1);
    assert!(charts.iter().all(|chart| is_apart(&chart.flat)));
    let members: usize = charts.iter().map(|chart| chart.triangles.len()).sum();
    assert_eq!(members, spiral().len());
}

#[test]
fn many_copies_of_one_surface_become_a_chart_each_without_trying_all() {
    let square = triangles(Shape::Plane { size: [1.0, 1.0] });
    let copies = 2000;
    let doubled: Vec<_> = (0..copies).flat_map(|_| square.clone()).collect();
    for surface in [doubled, vec![square[0]; copies]] {
        let (charts, visits) = counted_charts(&surface);
        assert_eq!(charts.len(), copies);
        // Each is tested against the few that are neighbours at that time; if each chart tried all, there would be as many tests as
        // copies.
        assert!(visits < 10 * surface.len(), "{visits}");
    }
}

#[test]
fn what_covers_is_that_of_all_pairs() {
    let mut state = 7u64;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    // Triangles of all sizes, many of them near one point, with slivers.
    let mut flat = Vec::new();
    for k in 0..600 {
        let size = 10f64.powf(-4.0 * random());
        let middle = DVec2::new(random(), random()) * 10f64.powf(-3.0 * random());
        let mut corner = |width| middle + size * DVec2::new(random(), width * random());
        let width = if k % 3 == 0 { 1e-4 } else { 1.0 };
        flat.push([corner(width), corner(width), corner(width)]);
    }
    let mut kept: Vec<&[DVec2; 3]> = Vec::new();
    let mut all_pairs = Vec::new();
    for corners in &flat {
        let covers = kept.iter().any(|other| overlap(corners, other));
        all_pairs.push(covers);
        if !covers {
            kept.push(corners);
        }
    }
    assert!(kept.len() > 50 && kept.len() < 550, "{}", kept.len());
    assert_eq!(covering(&flat), all_pairs);
}

/// Rings whose radii grow with a high power: most of the triangles are in a hundredth of the disc.
#[test]
fn a_disc_that_is_fine_in_its_middle_becomes_one_chart() {
    let (sides, rings) = (700, 50);
    let place = |side: i32, ring: i32| {
        let angle = std::f64::consts::TAU * f64::from(side % sides) / f64::from(sides);
        let radius = (f64::from(ring) / f64::from(rings)).powi(6);
        DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
    };
    let cell = |k: i32| {
        let (side, ring) = (k / rings, k % rings);
        let [a, b] = [place(side, ring), place(side, ring + 1)];
        let [c, d] = [place(side + 1, ring + 1), place(side + 1, ring)];
        [[a, b, c], [a, c, d]]
    };
    let disc: Vec<_> = (0..sides * rings).flat_map(cell).collect();
    assert_eq!(charts(&disc).len(), 1);
}

/// Lengths on the texture over lengths on the surface equal the scale, or cos 45° of it where the chart is steepest.
#[test]
fn texels_are_of_one_size_but_for_the_slope_of_their_chart() {
    let size = [128, 128];
    let surface = sphere();
    let flat = in_texels(&atlas(&surface, size).unwrap(), size);
    let ratios = surface.iter().zip(&flat).flat_map(|(solid, flat)| {
        (0..3).map(|k| {
            let next = (k + 1) % 3;
            (flat[next] - flat[k]).length() / (solid[next] - solid[k]).length()
        })
    });
    let ratios: Vec<f64> = ratios.collect();
    let most = ratios.iter().fold(0f64, |most, r| most.max(*r));
    let least = ratios.iter().fold(f64::INFINITY, |least, r| least.min(*r));
    // An edge of a triangle within 45° is within 45° of the plane; allow for f32 rounding.
    assert!(least >= most * STEEPEST * 0.999, "{least} to {most}");
    // A sphere of radius 1 at this scale fills a good part of the texture.
    assert!(
        4.0 * std::f64::consts::PI * most * most > 0.4 * 128.0 * 128.0,
        "{most}"
    );
}

/// Two columns or rows separate charts: the texels within one of a chart belong to no other.
#[test]
fn bilinear_lookups_in_one_chart_never_read_another() {
    let size = [96, 96];
    let surface = sphere();
    let flat = in_texels(&atlas(&surface, size).unwrap(), size);
    let mut owners = vec![None; 96 * 96];
    for (index, chart) in charts(&surface).iter().enumerate() {
        for triangle in &chart.triangles {
            let corners = flat[*triangle as usize];
            let (low, high) = bounds(std::slice::from_ref(&corners));
            for row in (low.y - 0.5).floor() as usize..=(high.y + 0.5).floor() as usize {
                let [from, to] = extent(&corners, [row as f64 - 0.5, row as f64 + 1.5]);
                for column in (from - 0.5).floor() as usize..=(to + 0.5).floor() as usize {
                    let owner: &mut Option<usize> = &mut owners[row * 96 + column];
                    assert!(
                        owner.is_none_or(|other| other == index),
                        "({column}, {row})"
                    );
                    *owner = Some(index);
                }
            }
        }
    }
}

#[test]
fn a_texture_too_small_for_its_charts_says_how_large_it_must_be() {
    let boxed = triangles(Shape::Box { size: [1.0; 3] });
    let error = atlas(&boxed, [6, 6]).unwrap_err();
    assert_eq!(
        error,
        TooSmall {
            charts: 6,
            least: 9
        }
    );
    assert!(atlas(&boxed, [9, 9]).is_ok());
}

#[test]
fn triangles_without_an_area_have_no_chart() {
    let point = [DVec3::ONE; 3];
    let surface = [point, [DVec3::ZERO, DVec3::X, DVec3::Z]];
    let corners = atlas(&surface, [16, 16]).unwrap();
    assert_eq!(corners[0], [[0.0; 2]; 3]);
    assert_ne!(corners[1], [[0.0; 2]; 3]);
}
