//! Surfaces smoothed by vertex normals.
//!
//! A ball whose vertices lie on a sphere about the origin, with their positions as normals, has the normal p/|p| at each point p of its
//! triangles: linear interpolation between the vertices gives p itself. So its shading is known in closed form, however coarse it is.

use std::sync::Arc;

use glam::{DMat3, DVec3};
use nullray::io::gltf;
use nullray::mesh::{Mesh, Shape, shapes};
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::scene::Builder;
use nullray::scene::model::Scene;

use crate::pipeline::stage::{self, assert_relative};

const PI: f64 = std::f64::consts::PI;

/// A ball of radius 1 of 20 · 4ⁿ triangles, with its normals.
fn ball(subdivisions: u32, colour: [f32; 3]) -> Mesh {
    let shape = Shape::Sphere {
        radius: 1.0,
        subdivisions,
    };
    let mut mesh = shapes::mesh(shape, colour);
    let normals = mesh.positions.iter().map(|p| p.as_vec3().to_array());
    mesh.normals = normals.collect();
    mesh
}

/// The same, of white metal of this roughness.
fn metal(subdivisions: u32, roughness: f32) -> Mesh {
    let mut mesh = ball(subdivisions, [1.0; 3]);
    (mesh.materials[0].metallic, mesh.materials[0].roughness) = (1.0, roughness);
    mesh
}

/// The scene of `text` with `mesh` at the origin, at β.
fn with_body(text: &str, mesh: &Mesh, beta: f64) -> Builder {
    Builder::from_toml("smooth", text)
        .mesh("body", Arc::new(mesh.clone()))
        .set("object.body.velocity.beta", [beta, 0.0, 0.0])
}

/// `mesh` at the origin, at β, before a camera that moves along with it, 4 m away.
fn scene(mesh: &Mesh, beta: f64, keys: &str) -> Scene {
    let text = format!(
        "
[camera]
eye = [0, 0, 4]
look_at = [0, 0, 0]
hfov = \"40 deg\"
size = [60, 45]
velocity = {{ beta = [{beta}, 0, 0] }}
{keys}"
    );
    with_body(&text, mesh, beta).build().unwrap()
}

/// The normal of the triangle that pixel `i` shows, in its rest frame.
fn geometric(film: &Film, i: usize) -> DVec3 {
    let v = |aov| stage::value(film, aov, i);
    DVec3::new(v(Aov::NormalX), v(Aov::NormalY), v(Aov::NormalZ))
}

/// Parallel light along (0.48, −0.6, −0.64) of the world, towards where it comes from and its ω over that of the world, in a frame at β.
fn sun(beta: f64) -> (DVec3, f64) {
    let gamma = 1.0 / (1.0 - beta * beta).sqrt();
    let k = DVec3::new(0.48, -0.6, -0.64);
    let ratio = gamma * (1.0 - beta * k.x);
    let in_frame = DVec3::new(gamma * (k.x - beta), k.y, k.z) / ratio;
    (-in_frame, ratio)
}

const SUN: &str =
    "[[light]]\ntype = \"directional\"\ndirection = [0.48, -0.6, -0.64]\nirradiance = 3\n";

fn film_of(scene: &Scene, samples: u32) -> Film {
    let mut scene = scene.clone();
    scene.samples_per_pixel = samples;
    stage::rendered(&scene, &stage::sampled()).unwrap()
}

#[test]
fn a_coarse_ball_is_lit_as_the_true_one_at_rest_and_in_motion() {
    for (beta, bounces) in [(0.0, 0), (0.9, 0), (-0.9, 1)] {
        let keys = format!("{SUN}[render]\nbounces = {bounces}\n");
        let smooth = ball(1, [0.5, 0.25, 0.75]);
        let film = stage::film(&scene(&smooth, beta, &keys));
        let faceted = Mesh {
            normals: Vec::new(),
            ..smooth
        };
        let faceted = stage::film(&scene(&faceted, beta, &keys));
        let (l, ratio) = sun(beta);
        assert!((l.length() - 1.0).abs() < 1e-12);
        let (mut lit, mut below, mut error) = (0, 0, 0.0f64);
        for i in stage::met(&film) {
            let (_, p) = stage::object_event(&film, i);
            let cosine = p.normalize().dot(l);
            // E = 3 (ω/ω₀)² cos θ, and the camera moves along; light from below a triangle gives nothing.
            let is_below = geometric(&film, i).dot(l) <= 0.0;
            let whole = 3.0 * ratio * ratio / PI;
            let expected = if is_below {
                0.0
            } else {
                whole * cosine.max(0.0)
            };
            for (got, albedo) in film.radiance()[i].into_iter().zip([0.5, 0.25, 0.75]) {
                let what = (got - albedo * expected).abs();
                assert!(what < 1e-6 * whole, "{beta} {i}: {got} {expected}");
            }
            below += usize::from(is_below && cosine > 0.0);
            if expected > 0.2 * whole {
                lit += 1;
                error = error.max((faceted.radiance()[i][1] / 0.25 - expected).abs() / expected);
            }
        }
        // Of 80 triangles that are flat some are off by half of the light.
        assert!(lit > 50 && error > 0.2, "{beta}: {lit} {error}");
        assert!(below > 0 || beta != 0.0, "{below}");
    }
}

/// f of the head of `light::reflection`, with h.
fn ggx(n: DVec3, v: DVec3, l: DVec3, f0: f64, roughness: f64) -> f64 {
    let a2 = roughness.powi(4);
    let h = (v + l).normalize();
    let fresnel = f0 + (1.0 - f0) * (1.0 - v.dot(h)).powi(5);
    let d = a2 / (PI * (n.dot(h).powi(2) * (a2 - 1.0) + 1.0).powi(2));
    let root = |c: f64| (a2 + (1.0 - a2) * c * c).sqrt();
    let (nl, nv) = (n.dot(l), n.dot(v));
    fresnel * d * 0.5 / (nl * root(nv) + nv * root(nl))
}

#[test]
fn highlights_of_a_coarse_ball_are_those_of_the_true_one() {
    for bounces in [0, 1] {
        let keys = format!("{SUN}[render]\nbounces = {bounces}\n");
        let film = stage::film(&scene(&metal(1, 0.4), 0.0, &keys));
        let (l, _) = sun(0.0);
        let (mut compared, mut highest) = (0, 0.0f64);
        for i in stage::met(&film) {
            let (_, p) = stage::object_event(&film, i);
            let (n, g) = (p.normalize(), geometric(&film, i));
            let v = -stage::direction(&film, i);
            // Where the view is mirrored into the surface, the normal is bent.
            let is_bent = g.dot(2.0 * n.dot(v) * n - v) < 0.01;
            if is_bent || g.dot(l) <= 0.0 || n.dot(l) <= 0.0 {
                continue;
            }
            let expected = 3.0 * n.dot(l) * ggx(n, v, l, 1.0, 0.4);
            assert_relative(film.radiance()[i][0], expected, 1e-5, i);
            (compared, highest) = (compared + 1, highest.max(expected));
        }
        assert!(compared > 200 && highest > 1.0, "{compared} {highest}");
    }
}

#[test]
fn normals_go_with_surfaces_that_nodes_and_objects_stretch_and_mirror() {
    // The file's node stretches and mirrors, and so does the object: M p of a ball has the normal M⁻ᵀ p.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ball.glb");
    gltf::save(&path, "ball", &ball(4, [1.0; 3])).unwrap();
    let text = format!(
        "
[camera]
eye = [0.5, 0.3, 6]
look_at = [0, 0, 0]
hfov = \"40 deg\"
size = [60, 45]
{SUN}
[[object]]
gltf = \"ball.glb\"
transform = {{ scale = [-0.7, 1.5, 1], rotate = {{ axis = [1, 2, 3], angle = \"50 deg\" }} }}"
    );
    let mut file = std::fs::read(&path).unwrap();
    // As long as what it takes the place of.
    let node = b"\"nodes\":[{\"mesh\":0,\"name\":\"ball\"}]";
    let other = b"\"nodes\":[{\"mesh\":0,\"scale\":[2,1,1]}]";
    let at = file.windows(node.len()).position(|w| w == node).unwrap();
    let pad = other.len() - node.len();
    file.splice(at..at + node.len(), other.iter().copied());
    // The header's lengths, in steps of four bytes.
    let json = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize + pad;
    let padded = json.next_multiple_of(4);
    for _ in json..padded {
        file.insert(20 + json, b' ');
    }
    let length = file.len() as u32;
    file[8..12].copy_from_slice(&length.to_le_bytes());
    file[12..16].copy_from_slice(&(padded as u32).to_le_bytes());
    std::fs::write(&path, file).unwrap();

    let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 50f64.to_radians());
    let both = turn * DMat3::from_diagonal(DVec3::new(-1.4, 1.5, 1.0));
    let film = stage::film(&stage::scene_in(folder.path(), &text));
    let (l, _) = sun(0.0);
    let (mut lit, mut compared) = (0, 0);
    for i in stage::met(&film) {
        let (_, p) = stage::object_event(&film, i);
        let on_ball = both.inverse() * p;
        let n = (both.inverse().transpose() * on_ball).normalize();
        if geometric(&film, i).dot(l).abs() < 0.1 {
            continue;
        }
        // 5120 triangles, whose normals turn by some 4° each: what is linear between them is within (4°)²/8.
        let expected = 3.0 / PI * n.dot(l).max(0.0);
        let error = (film.radiance()[i][0] - expected).abs();
        assert!(error < 2e-3, "{i}: {expected} {error}");
        compared += 1;
        lit += usize::from(expected > 0.1);
    }
    assert!(compared > 300 && lit > 100, "{compared} {lit}");
}

/// A triangle in the plane z = 0 that looks at the camera, whose normals lean by 60° to +x.
fn leaning(colour: [f32; 3]) -> Mesh {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (0.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
    let mut mesh = Mesh::new(corners.into(), vec![[0, 1, 2]], colour);
    mesh.normals = vec![[3f32.sqrt(), 0.0, 1.0]; 3];
    mesh
}

#[test]
fn light_from_below_the_triangle_gives_nothing() {
    // From 10° below the plane, 40° from the normals; and from 10° above it, 20° from them.
    let light = |degrees: f64| {
        let (z, x) = libm::sincos(degrees.to_radians());
        let from = DVec3::new(x, 0.0, z);
        let panel = format!(
            "[[object]]\nname = \"panel\"\nshape = {{ box = {{ size = [0.2, 0.2, 0.2] }} }}\ntransform = {{ translate = [{}, 0, {}] }}\n\
             [[light]]\ntype = \"area\"\nobject = \"panel\"\nradiance = 50000\n",
            20.0 * x,
            20.0 * z
        );
        [
            format!(
                "[[light]]\ntype = \"directional\"\ndirection = [{}, 0, {}]\nirradiance = 3\n",
                -from.x, -from.z
            ),
            format!(
                "[[light]]\nposition = [{}, 0, {}]\nintensity = 1200\n",
                20.0 * x,
                20.0 * z
            ),
            panel,
        ]
    };
    let mut glossy = leaning([1.0; 3]);
    (glossy.materials[0].metallic, glossy.materials[0].roughness) = (0.5, 0.5);
    for mesh in [leaning([1.0; 3]), glossy] {
        for (shadows, bounces) in [(true, 0), (false, 0), (true, 1), (false, 1)] {
            for (degrees, is_lit) in [(-10.0, false), (10.0, true)] {
                for light in light(degrees) {
                    let keys =
                        format!("{light}shadows = {shadows}\n[render]\nbounces = {bounces}\n");
                    let film = stage::film(&scene(&mesh, 0.0, &keys));
                    let body = stage::met(&film);
                    assert!(body.len() > 100);
                    let bright = body.iter().filter(|i| film.radiance()[**i][0] > 0.01);
                    let bright = bright.count();
                    match is_lit {
                        false => assert_eq!(bright, 0, "{keys}"),
                        true => assert!(bright > body.len() / 5, "{keys}: {bright}"),
                    }
                }
            }
        }
    }
}

#[test]
fn a_sky_below_the_triangle_gives_nothing() {
    // All of the light comes from z < 0, of which normals that lean see a third.
    let mut upright = leaning([1.0; 3]);
    for p in &mut upright.positions {
        *p = DVec3::new(p.x, p.z, -p.y);
    }
    upright.normals = vec![[3f32.sqrt(), 1.0, 0.0]; 3];
    let sky = "[sky]\ngradient = { zenith = [0, 0, 0], horizon = [0, 0, 0], ground = [3, 3, 3] }\n";
    for (shadows, bounces) in [(true, 0), (false, 0), (true, 1), (false, 1)] {
        let keys = format!("{sky}shadows = {shadows}\n[render]\nbounces = {bounces}\n");
        let mut scene = scene(&upright, 0.0, &keys);
        scene.camera = stage::scene(
            "[camera]\neye = [0, 4, 0]\nlook_at = [0, 0, -0.001]\nhfov = \"40 deg\"\nsize = [60, 45]\n[sky]\nradiance = 1",
        )
        .camera;
        let film = film_of(&scene, 64);
        let seen: Vec<f64> = film.radiance().iter().map(|rgb| rgb[0]).collect();
        let mut body = stage::met(&film);
        // Not those whose samples see the ground beside it.
        body.retain(|i| stage::object_event(&film, *i).1.length() < 0.3);
        let mean = stage::mean(&film, &body)[0];
        // By the normals alone a third of π L would fall there; drawn directions have noise without bounces.
        assert!(
            body.len() > 80 && mean.abs() < 0.01,
            "{keys}: {mean} of {}",
            body.len()
        );
        if bounces == 1 {
            assert_eq!(body.iter().filter(|i| seen[**i] != 0.0).count(), 0);
        }
    }
}

#[test]
fn white_balls_in_an_even_sky_send_no_more_than_comes_and_are_black_nowhere() {
    let sky = "[sky]\nradiance = 1\n";
    // A mirror sends what comes, and no more, also where its normals would mirror the view into it.
    let mirror = stage::film(&scene(
        &metal(1, 0.0),
        0.0,
        &format!("{sky}[render]\nbounces = 1\n"),
    ));
    for i in stage::met(&mirror) {
        assert_relative(mirror.radiance()[i][0], 1.0, 1e-9, i);
    }
    for (mesh, bounces, least) in [
        (ball(1, [1.0; 3]), 0, 0.9),
        (ball(1, [1.0; 3]), 1, 0.9),
        (metal(1, 0.3), 1, 0.5),
        (metal(1, 0.8), 1, 0.4),
    ] {
        let scene = scene(
            &mesh,
            0.9,
            &format!("{sky}[render]\nbounces = {bounces}\n[display]\nback_faces = \"black\"\n"),
        );
        let film = film_of(&scene, 256);
        let aov = film.aov(Aov::Object).unwrap().to_vec();
        let met: Vec<_> = (0..aov.len()).filter(|i| aov[*i] >= 0.0).collect();
        // As the sky at rest: compared with it in the frame of the ball, which is that of the camera.
        let (beta, gamma) = (0.9, 1.0 / f64::sqrt(1.0 - 0.81));
        let matte = mesh.materials[0].metallic == 0.0;
        let irradiance = |n: DVec3| {
            // ∫ D⁴ n·l dω/π over the hemisphere by midpoints, D = 1/(γ (1 − β x)) towards l of the ball's frame.
            let (steps, mut sum) = (60, 0.0);
            let (a, b) = n.any_orthonormal_pair();
            for k in 0..steps * steps {
                let square = (f64::from(k / steps) + 0.5) / f64::from(steps);
                let turn = (f64::from(k % steps) + 0.5) / f64::from(steps) * 2.0 * PI;
                let (s, c) = libm::sincos(turn);
                let l = n * (1.0 - square).sqrt() + (a * c + b * s) * square.sqrt();
                sum += 1.0 / (gamma * (1.0 - beta * l.x)).powi(4);
            }
            sum / f64::from(steps * steps)
        };
        let (mut compared, mut sums) = (0, [0.0; 2]);
        for i in met {
            let seen = film.radiance()[i][0];
            assert!(seen.is_finite() && seen >= 0.0, "{i}: {seen}");
            let (_, p) = stage::object_event(&film, i);
            if matte {
                let n = p.normalize();
                sums[0] += seen;
                sums[1] += irradiance(n);
                compared += 1;
            }
        }
        if matte {
            // Less what is below triangles.
            let part = sums[0] / sums[1];
            assert!(compared > 100 && part < 1.0 && part > least, "{part}");
        }
    }
}

#[test]
fn bounced_and_single_light_of_the_sky_have_one_mean() {
    let sky =
        "[sky]\ngradient = { zenith = [1, 2, 4], horizon = [2, 2, 1], ground = [1, 0.5, 0] }\n";
    for mesh in [ball(1, [0.8; 3]), metal(1, 0.5)] {
        let mean = |bounces: u32| {
            let keys = format!("{sky}[render]\nbounces = {bounces}\n");
            let film = film_of(&scene(&mesh, 0.6, &keys), 64);
            stage::mean(&film, &stage::met(&film))[1]
        };
        // A convex body lights itself with nothing.
        assert_relative(mean(1), mean(0), 4e-3, "bounces");
    }
}

#[test]
fn a_closed_furnace_of_normals_that_lean_has_no_more_than_the_series_of_its_walls() {
    let (bounces, albedo) = (5, 0.6f32);
    let series: f64 = (0..=bounces + 1)
        .map(|k| f64::from(albedo).powi(k))
        .sum::<f64>();
    for beta in [0.0, 0.9] {
        let text = format!(
            "
render = {{ bounces = {bounces} }}
[camera]
eye = [0.1, 0.2, 0.1]
look_at = [1, 0.3, 0.4]
hfov = \"80 deg\"
size = [60, 45]
velocity = {{ beta = [{beta}, 0, 0] }}
[display]
back_faces = \"two_sided\"
samples_per_pixel = 16"
        );
        let light = [
            ("type", "area".into()),
            ("object", "body".into()),
            ("radiance", 2.0.into()),
        ];
        let scene = with_body(&text, &ball(0, [albedo; 3]), beta)
            .light("walls", light)
            .build()
            .unwrap();
        let film = stage::rendered(&scene, &stage::sampled()).unwrap();
        let all: Vec<_> = (0..stage::pixels(&film)).collect();
        let mean = stage::mean(&film, &all)[0] / 2.0;
        // Corners of the icosahedron lean by 37° from its faces: less falls on them, but not much less.
        assert!(mean < series && mean > 0.85 * series, "{mean} {series}");
    }
}

#[test]
fn paths_that_neighbours_share_are_those_of_single_points() {
    // A body that moves out of view makes two frames, in which nothing is shared.
    let text = |more: &str| {
        format!(
            "
render = {{ bounces = 2 }}
[camera]
eye = [0, 1, 4]
look_at = [0, 0, 0]
hfov = \"50 deg\"
size = [40, 30]
[[object]]
name = \"floor\"
shape = {{ plane = {{ size = [6, 6] }} }}
transform = {{ translate = [0, -1, 0] }}
colour = [0.9, 0.6, 0.3]
[[light]]
position = [2, 3, 3]
intensity = 20
[sky]
gradient = {{}}
[display]
samples_per_pixel = 64
{more}"
        )
    };
    let other = "[[object]]\nname = \"far\"\nshape = { sphere = { radius = 0.01 } }\n\
                 transform = { translate = [0, 500, 0] }\nvelocity = { beta = [0.1, 0, 0] }\n";
    let mean = |more: &str, number: usize| {
        let body = ball(1, [0.8; 3]);
        let scene = with_body(&text(more), &body, 0.0).build().unwrap();
        let film = stage::rendered(&scene, &stage::sampled()).unwrap();
        let of_body = stage::met_of(&film, number);
        assert!(of_body.len() > 100);
        stage::mean(&film, &of_body)[0]
    };
    assert_relative(mean("", 1), mean(other, 2), 4e-3, "shared");
}

#[test]
fn smooth_surfaces_have_the_same_bits_on_any_number_of_threads() {
    let keys = format!("{SUN}[sky]\ngradient = {{}}\n[render]\nbounces = 2\n");
    for mesh in [ball(2, [0.8; 3]), metal(2, 0.2)] {
        let scene = scene(&mesh, 0.5, &keys);
        let bits = |threads| stage::bits(&stage::on(threads, || film_of(&scene, 4)));
        let alone = bits(1);
        assert!(bits(3) == alone && bits(2) == alone);
    }
}

#[test]
fn normals_take_memory_where_light_is_reflected_and_nowhere_else() {
    let geometry = |keys: &str, mesh: &Mesh| {
        let scene = scene(mesh, 0.0, keys);
        let plan = Plan::new(&scene, &Request::default()).unwrap();
        plan.memory.geometry
    };
    let smooth = ball(3, [1.0; 3]);
    let flat = Mesh {
        normals: Vec::new(),
        ..smooth.clone()
    };
    assert_eq!(geometry("", &smooth), geometry("", &flat));
    // Three numbers for each vertex, and three for each triangle.
    let numbers = 3 * (smooth.positions.len() + smooth.triangles.len()) as u64;
    assert_eq!(geometry(SUN, &smooth), geometry(SUN, &flat) + 4 * numbers);
}

#[test]
fn normals_of_meshes_in_memory_that_do_not_fit_are_refused() {
    let mut mesh = leaning([1.0; 3]);
    mesh.normals.pop();
    let error = mesh.check().unwrap_err();
    assert_eq!(error.to_string(), "normals: 2 normals for 3 vertices");
    mesh.normals.push([0.0, f32::NAN, 1.0]);
    let error = mesh.check().unwrap_err();
    assert!(error.to_string().contains("normals[2]"), "{error}");
    // A corner without one makes its triangle flat.
    mesh.normals[2] = [0.0; 3];
    mesh.check().unwrap();
    let film = stage::film(&scene(&mesh, 0.0, SUN));
    for i in stage::met(&film) {
        assert_relative(film.radiance()[i][0], 3.0 / PI * 0.64, 1e-9, i);
    }
}
