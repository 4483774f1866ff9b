//! Tests of how models are framed.

use glam::DVec3;

use super::flyby::passing;
use super::framing::{FILLED, framing};
use super::fronts::{Lit, Show, Source};
use super::motion::Motion;
use super::subject::{Ball, Shining, Subject};
use super::view::{ModelView, VIEWPOINT};
use crate::mesh::shapes::{self, Shape};
use crate::mesh::{Material, Mesh, Part};

/// A box, given by the corners of a grid on it, and its bounding sphere.
fn slab(size: DVec3, middle: DVec3) -> Subject {
    let steps = || (0..=4).map(|k| f64::from(k) / 4.0 - 0.5);
    let grid = steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| [x, y, z])));
    let outline = grid.map(|p| middle + size * DVec3::from_array(p)).collect();
    Subject {
        ball: Ball {
            centre: middle,
            radius: 0.5 * size.length(),
        },
        outline,
        floor: None,
        ground: None,
        inside: None,
        seen: Vec::new(),
        shining: Shining::default(),
    }
}

#[test]
fn the_model_fills_the_middle_of_the_picture_at_any_speed_and_scale() {
    for scale in [1e-3, 1.0, 1e4] {
        let size = DVec3::new(4.0, 1.0, 0.5) * scale;
        let subject = slab(size, DVec3::new(3.0, -1.0, 7.0) * scale);
        for (beta, n) in [
            (0.0, DVec3::X),
            (0.9, DVec3::X),
            (0.99, DVec3::new(0.3, 0.9, -0.3)),
            (0.5, -VIEWPOINT),
            (0.99, VIEWPOINT),
        ] {
            let n = n.normalize();
            let gamma = 1.0 / f64::sqrt(1.0 - beta * beta);
            let motion = Motion { beta, gamma, n };
            let camera = framing(&subject, Some(motion), [640, 320], None);
            // cos θ′ = (cos θ + β)/(1 + β cos θ) for angles from the motion, in the plane of both directions.
            let seen = |p: DVec3| {
                let d = (p - camera.eye).normalize();
                let cos = d.dot(n);
                let along = (cos + beta) / (1.0 + beta * cos);
                let across = d.reject_from(n).normalize_or_zero();
                n * along + across * (1.0 - along * along).max(0.0).sqrt()
            };
            let right = camera.forward.cross(DVec3::Y).normalize();
            let up = right.cross(camera.forward);
            let half = libm::tan(0.5 * camera.fov.to_radians());
            let extent = |axis: DVec3, half: f64| {
                let places = subject.outline.iter().map(|p| {
                    let l = seen(*p);
                    l.dot(axis) / l.dot(camera.forward) / half
                });
                places.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| {
                    [a.min(x), b.max(x)]
                })
            };
            let edges = [extent(right, half), extent(up, 0.5 * half)];
            let case = format!("{scale} {beta} {n}: {edges:?}");
            let filled = edges.map(|[a, b]| b.max(-a));
            assert!(
                (filled[0].max(filled[1]) / FILLED - 1.0).abs() < 1e-6,
                "{case}"
            );
            // The margins are equal.
            assert!(edges.iter().all(|[a, b]| (a + b).abs() < 1e-2), "{case}");
        }
    }
}

#[test]
fn the_outline_has_what_is_farthest_in_every_direction() {
    // A ball of many triangles with a spike.
    let mut corners = Vec::new();
    for k in 0..20_000 {
        let z = 1.0 - f64::from(k) / 10_000.0;
        let (sin, cos) = libm::sincos(2.4 * f64::from(k));
        corners.push(DVec3::new(cos, sin, 0.0) * (1.0 - z * z).max(0.0).sqrt() + DVec3::Z * z);
    }
    corners[5000] *= 1.5;
    let spike = corners[5000];
    let triangles = (0..corners.len() as u32 - 2).map(|k| [k, k + 1, k + 2]);
    let mesh = Mesh::new(corners.clone(), triangles.collect(), [1.0; 3]);
    let subject = Subject::in_mesh(&mesh).unwrap();
    assert!(subject.outline.len() < 4000 && subject.outline.contains(&spike));
    for direction in [
        DVec3::X,
        DVec3::new(-1.0, 2.0, 0.4),
        DVec3::new(0.1, -0.3, -2.0),
    ] {
        let reach = |all: &[DVec3]| {
            let along = all.iter().map(|p| p.dot(direction.normalize()));
            along.fold(f64::NEG_INFINITY, f64::max)
        };
        let [all, outline] = [&corners, &subject.outline].map(|all| reach(all));
        assert!(outline > all * (1.0 - 4e-3), "{outline} of {all}");
    }
}

#[test]
fn a_model_on_a_wide_ground_is_framed_without_it() {
    let square = |size: f64, y: f64| {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, z)| DVec3::new(x * size, y, z * size))
    };
    let with = |ground: f64| {
        let mut mesh = crate::mesh::shapes::mesh(
            crate::mesh::shapes::Shape::Plane { size: [1.0; 2] },
            [1.0; 3],
        );
        mesh.positions = [square(ground, 0.0), square(1.0, 2.0)].concat();
        mesh.triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
        Subject::in_mesh(&mesh).unwrap().ball
    };
    // Only the upper square: its half diagonal. With a ground of the same size both are framed.
    let alone = with(100.0);
    assert!((alone.radius - 2f64.sqrt()).abs() < 1e-12, "{alone:?}");
    assert!((alone.centre - DVec3::Y * 2.0).length() < 1e-12);
    assert!((with(1.0).radius - 3f64.sqrt()).abs() < 1e-12);
}

#[test]
fn only_models_without_a_ground_of_their_own_get_a_floor() {
    let cube = |size: DVec3| {
        let corner = |i: usize| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
        (0..8).map(move |i| (corner(i) - DVec3::new(0.5, 0.0, 0.5)) * size)
    };
    // Counter-clockwise as seen from outside.
    let faces = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let floor_of = |boxes: &[DVec3]| {
        let positions = boxes.iter().flat_map(|size| cube(*size)).collect();
        let triangles = (0..boxes.len() as u32).flat_map(|k| {
            let quad = move |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
            faces
                .into_iter()
                .flat_map(quad)
                .map(move |t| t.map(|i| i + 8 * k))
        });
        let mesh = Mesh::new(positions, triangles.collect(), [1.0; 3]);
        Subject::in_mesh(&mesh).unwrap().floor
    };
    // A cube alone, on a thin slab twice as wide, and on a thin slab of half its width.
    let thin = 0.02;
    assert_eq!(floor_of(&[DVec3::ONE]), Some(0.0));
    assert_eq!(floor_of(&[DVec3::ONE, DVec3::new(2.0, thin, 2.0)]), None);
    assert_eq!(
        floor_of(&[DVec3::ONE, DVec3::new(0.5, thin, 0.5)]),
        Some(0.0)
    );
}

#[test]
fn a_flyby_crosses_the_picture_about_the_place_without_a_shift() {
    let ball = Ball {
        centre: DVec3::new(5.0, 0.0, 0.0),
        radius: 2.0,
    };
    // β, γ, and where all but the fastest leave the picture, half of which is 45/50 of the way from the first place to the middle.
    for (beta, gamma) in [
        (0.02, 1.0002),
        (0.6, 1.25),
        (0.96, 1.0 / 0.28),
        (0.9999, 70.71),
    ] {
        let n = DVec3::X;
        let motion = Motion { beta, gamma, n };
        let camera = passing(&ball, motion);
        let seen = |time: f64| {
            // The path per proper time is γβ.
            let path = camera.interval.unwrap() * time * gamma * beta;
            let to = ball.centre - (camera.eye + DVec3::X * path);
            let cos = to.normalize().x;
            let w = 1.0 / (gamma * (1.0 + beta * cos));
            (((cos + beta) / (1.0 + beta * cos)).acos(), w)
        };
        let ahead = camera.forward.x.acos();
        assert!((gamma * (1.0 - beta * ahead.cos()) - 1.0).abs() < 1e-4);
        let steps = (ModelView::FLYBY_FRAMES - 1) as f64;
        let ([first, _], [last, w]) = (seen(0.0).into(), seen(steps).into());
        let half = 0.5 * camera.fov.to_radians();
        assert!(
            ((ahead - first) / half - 50.0 / 45.0).abs() < 1e-4,
            "{beta}"
        );
        let is_at_edge = ((last - ahead) / half - 50.0 / 45.0).abs() < 1e-4;
        let is_reddest = (w / 2.5 - 1.0).abs() < 1e-3 && last - ahead < half * 50.0 / 45.0;
        assert!(
            is_at_edge == (beta < 0.9) && is_at_edge != is_reddest,
            "{beta} {last} {w}"
        );
    }
}

/// A hollow box whose walls face inward, with half extents 1, and a square of this size in the middle that faces up.
fn room(size: f64) -> Mesh {
    let mut mesh = shapes::mesh(Shape::Box { size: [2.0; 3] }, [1.0; 3]);
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let square = shapes::mesh(Shape::Plane { size: [size; 2] }, [1.0; 3]);
    let before = mesh.positions.len() as u32;
    mesh.positions.extend(square.positions);
    let triangles = square.triangles.iter().map(|t| t.map(|k| k + before));
    let first_triangle = mesh.triangles.len() as u32;
    mesh.triangles.extend(triangles);
    mesh.parts.push(Part {
        first_triangle,
        triangles: 2,
        material: 1,
        node: String::new(),
    });
    mesh.materials.push(Material {
        emissive: [1.0, 2.0, 3.0],
        ..Material::default()
    });
    Mesh {
        uvs: Vec::new(),
        normals: Vec::new(),
        ..mesh
    }
}

#[test]
fn a_film_of_a_flash_shows_the_light_on_the_sides_that_face_the_camera() {
    let mesh = room(1e-3);
    let subject = Subject::in_mesh(&mesh).unwrap().with_surface(&mesh);
    let lamp = DVec3::new(0.7, 0.8, 0.6);
    let lit = Lit::of(&subject, &[Source::point(lamp, 1.0)], 1e9);
    let show = Show {
        lit: &lit,
        dawn: 0.0,
        fades: 0.0,
        middle: 0.0,
    };
    let eye = subject.ball.centre + 4.0 * VIEWPOINT;
    let span = show.span(&subject, eye, None);
    // The camera sees the floor, the left wall and the back wall from within, and the other three are seen through.
    let steps = || (0..=100).map(|k| f64::from(k) / 50.0 - 1.0);
    let walls = |a: f64, b: f64| {
        [
            DVec3::new(a, -1.0, b),
            DVec3::new(-1.0, a, b),
            DVec3::new(a, b, -1.0),
        ]
    };
    let all = steps().flat_map(|a| steps().flat_map(move |b| walls(a, b)));
    let seen = all.map(|p| p.distance(lamp) + p.distance(eye) - span.zero);
    let [first, last] = seen.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], t| {
        [a.min(t), b.max(t)]
    });
    // Pieces are an eighth of the radius √3 wide.
    assert!((span.first - first).abs() < 0.22, "{span:?} {first}");
    assert!((span.last - last).abs() < 0.44, "{span:?} {last}");
}

#[test]
fn what_a_lamp_hardly_lights_does_not_lengthen_a_film() {
    let mesh = shapes::mesh(Shape::Plane { size: [2.0; 2] }, [1.0; 3]);
    let subject = Subject::in_mesh(&mesh).unwrap().with_surface(&mesh);
    // Above a corner by h the irradiance falls as h/r³ beyond r = h, and white is that of a twentieth of 4 m².
    let (height, range) = (0.01, 30.0_f64);
    let lamp = Source::point(DVec3::new(-1.0, height, -1.0), 1.0);
    let farthest = |range: f64, lamp: Source| {
        let lit = Lit::of(&subject, &[lamp], range);
        lit.iter().map(|lit| lit.last).fold(0.0, f64::max)
    };
    // A quarter of a disc: π r²/4 = 0.2.
    let white = (0.8 / std::f64::consts::PI).sqrt();
    let expected = white * range.cbrt();
    let found = farthest(range, lamp);
    assert!((found - expected).abs() < 0.25, "{found} {expected}");
    let all = farthest(1e9, Source::point(DVec3::new(-1.0, height, -1.0), 1.0));
    assert!(all > 2.6, "{all}");
    // A cone of 45° that looks straight down from 1 m above the middle.
    let cone = Source {
        cone: Some((-DVec3::Y, 0.5f64.sqrt())),
        ..Source::point(DVec3::Y, 1.0)
    };
    let beside = farthest(1e9, cone);
    assert!((1.3..=2f64.sqrt()).contains(&beside), "{beside}");
}

#[test]
fn a_surface_that_shines_is_known_by_its_area_power_and_corners() {
    let mesh = room(0.5);
    let shining = Shining::of(&mesh);
    assert!((shining.part - 0.25 / 24.25).abs() < 1e-12);
    assert!((shining.power - 0.5).abs() < 1e-12);
    for corner in [[-0.25, -0.25], [0.25, -0.25], [0.25, 0.25], [-0.25, 0.25]] {
        let corner = DVec3::new(corner[0], 0.0, corner[1]);
        assert!(shining.points.contains(&corner), "{corner}");
    }
    assert!(shining.points.iter().any(|p| p.length() < 1e-12));
    let mut textured = mesh;
    textured.materials[1].emissive = [0.0; 3];
    assert_eq!(Shining::of(&textured), Shining::default());
}

#[test]
fn triangles_without_extent_are_not_framed() {
    let flat = Mesh::new(vec![DVec3::ONE; 3], vec![[0, 1, 2]], [1.0; 3]);
    assert_eq!(Subject::in_mesh(&flat), None);
    let corners = vec![DVec3::ZERO, DVec3::X * 2.0, DVec3::Y, DVec3::Z * 1e9];
    let one = Mesh::new(corners, vec![[0, 1, 2], [3, 3, 3]], [1.0; 3]);
    let ball = Subject::in_mesh(&one).unwrap().ball;
    assert_eq!(ball.centre, DVec3::new(1.0, 0.5, 0.0));
}

#[test]
fn a_moving_camera_sees_the_middle_of_the_model_with_about_its_own_colours() {
    let subject = slab(DVec3::ONE, DVec3::new(2.0, 0.5, -1.0));
    for beta in [0.3, 0.9, 0.999_99] {
        for n in [DVec3::X, -DVec3::X, DVec3::Y, DVec3::new(0.2, -0.4, 0.7)] {
            let n = n.normalize();
            let gamma = 1.0 / f64::sqrt(1.0 - beta * beta);
            let motion = Motion { beta, gamma, n };
            let camera = framing(&subject, Some(motion), [640, 480], None);
            let d = (subject.ball.centre - camera.eye).normalize();
            // W of light that comes along −d: 1/(γ (1 + β·d)).
            let w = 1.0 / (gamma * (1.0 + beta * n.dot(d)));
            assert!((0.9 - 1e-9..1.1 + 1e-9).contains(&w), "{beta} {n}: {w}");
            let [least, most] = camera.ratios;
            assert!(most < 2.2 * least, "{beta} {n}: {least} {most}");
        }
    }
}

#[test]
fn rooms_are_told_from_bodies_and_corners() {
    let body = shapes::mesh(
        Shape::Box {
            size: [3.0, 2.0, 4.0],
        },
        [1.0; 3],
    );
    let mut room = body.clone();
    room.triangles
        .iter_mut()
        .for_each(|triangle| triangle.swap(1, 2));
    let is_room = |mesh: &Mesh| Subject::in_mesh(mesh).unwrap().inside.is_some();
    assert!(!is_room(&body));
    assert!(is_room(&room));
    // Without its ceiling; and a corner: the floor and two walls.
    let without = |faces: &[DVec3]| {
        let mut mesh = room.clone();
        let is_kept = |[a, b, c]: [DVec3; 3]| {
            let n = (b - a).cross(c - a).normalize();
            !faces.iter().any(|face| n.dot(*face) > 0.9)
        };
        mesh.triangles = (0..room.triangles.len() as u32)
            .filter(|k| is_kept(room.corners(*k)))
            .map(|k| room.triangles[k as usize])
            .collect();
        mesh.parts[0].triangles = mesh.triangles.len() as u32;
        mesh
    };
    assert!(is_room(&without(&[-DVec3::Y])));
    assert!(!is_room(&without(&[-DVec3::Y, -DVec3::X, -DVec3::Z])));
}

#[test]
fn a_room_with_a_body_in_its_middle_is_a_room_and_its_lamp_is_beside_the_body() {
    let block = |size: [f64; 3]| shapes::mesh(Shape::Box { size }, [1.0; 3]);
    let with = |walls: Mesh, body: Mesh| {
        let first = walls.positions.len() as u32;
        let triangles = body.triangles.iter().map(|t| t.map(|k| k + first));
        let mut mesh = walls.clone();
        mesh.triangles.extend(triangles);
        mesh.positions.extend(body.positions);
        mesh.parts[0].triangles = mesh.triangles.len() as u32;
        Mesh {
            uvs: Vec::new(),
            normals: Vec::new(),
            ..mesh
        }
    };
    let turned = |mut mesh: Mesh| {
        let turn = |triangle: &mut [u32; 3]| triangle.swap(1, 2);
        mesh.triangles.iter_mut().for_each(turn);
        mesh
    };
    let inside = |mesh: &Mesh| Subject::in_mesh(mesh).unwrap().inside;
    let walls = || turned(block([4.0, 3.0, 5.0]));
    assert_eq!(inside(&walls()), Some(DVec3::ZERO));
    // Half-way to the corner above that is nearest to the viewer.
    let place = DVec3::new(1.0, 0.75, 1.25);
    let furnished = with(walls(), block([0.5; 3]));
    assert_eq!(inside(&furnished), Some(place));
    // A shell of two surfaces, seen from outside, is a body, whatever is turned inside it.
    let hollow = with(block([4.0, 3.0, 5.0]), turned(block([0.5; 3])));
    assert_eq!(inside(&hollow), None);
}
