//! Results that do not depend on the method.

use std::sync::Arc;

use nullray::mesh::{Shape, shapes};
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::render::plan::Request;
use nullray::scene::Builder;

use super::stage::{
    BODIES, camera, centred, different, film, identities, prepared, scene, scene_file, values,
};

/// Asserts that the channels of two films agree to `tolerance` where they see the same triangles.
#[track_caller]
fn assert_alike(a: &Film, b: &Film, tolerance: f64) {
    let (left, right) = (identities(a), identities(b));
    for aov in Aov::ALL {
        let name = aov.name();
        if *aov == Aov::StandardError {
            continue;
        }
        let (x, y) = (values(a, *aov), values(b, *aov));
        for i in (0..x.len()).filter(|i| left[*i] == right[*i]) {
            let near = (x[i] - y[i]).abs() <= tolerance * (1.0 + x[i].abs());
            assert!(
                near || x[i].is_nan() && y[i].is_nan(),
                "{name}, pixel {i}: {} {}",
                x[i],
                y[i]
            );
        }
    }
    for i in (0..left.len()).filter(|i| left[*i] == right[*i]) {
        for (x, y) in a.radiance()[i].iter().zip(b.radiance()[i]) {
            assert!(
                (x - y).abs() <= tolerance * (1e-3 + x.abs()),
                "pixel {i}: {x} {y}"
            );
        }
    }
}

#[test]
fn at_rest_flat_triangles_are_those_of_the_ray_tracer() {
    for method in [
        "raster:none",
        "raster:none,attributes=vertex",
        "raster:uniform=0.3",
    ] {
        let stage = centred(&scene(&(camera("") + BODIES)));
        let (traced, drawn) = (film(&stage, "trace"), film(&stage, method));
        let apart = different(&traced, &drawn);
        // The diagonal of the floor and of the crate's faces may pass through the centre of a pixel.
        assert!(apart.len() <= 2, "{method}: {apart:?}");
        if !method.ends_with("vertex") {
            assert_alike(&traced, &drawn, 1e-10);
        }
    }
}

#[test]
fn triangles_beside_and_behind_a_wide_camera_at_rest_are_seen_as_they_are() {
    let text = "[camera]\neye = [0.2, 0.3, 0.4]\nlook_at = [0.25, 0.2, 0]\nhfov = \"155 deg\"\nsize = [160, 120]\n";
    let stage = centred(&scene(&(text.to_string() + BODIES)));
    let (traced, drawn) = (film(&stage, "trace"), film(&stage, "raster:none"));
    assert!(different(&traced, &drawn).len() <= 2);
    assert_alike(&traced, &drawn, 1e-9);
    assert!(values(&traced, Aov::Object).contains(&0.0));
}

#[test]
fn samples_lie_where_those_of_the_ray_tracer_do() {
    let lit = scene(&(camera("") + BODIES + "[display]\nsamples_per_pixel = 7\n"));
    let stage = prepared(&lit, &Request::default());
    let (traced, drawn) = (film(&stage, "trace"), film(&stage, "raster:none"));
    let same = traced
        .radiance()
        .iter()
        .zip(drawn.radiance())
        .filter(|(a, b)| a == b)
        .count();
    // Edge pixels have the same mean only if the same samples see the same bodies.
    assert!(same >= traced.radiance().len() - 2, "{same}");
}

#[test]
fn culled_and_black_back_faces_are_those_of_the_ray_tracer() {
    for policy in ["culled", "black", "two_sided"] {
        let inside = "[camera]\neye = [0.13, 0.47, 0.05]\nlook_at = [0, 0.4, -1]\nhfov = \"90 deg\"\nsize = [64, 48]\n";
        // Lifted: a face that lies in the floor is as near as the floor.
        let bodies = BODIES.replace("[0, 0.5, 0] }", "[0, 0.6, 0] }");
        let text = format!("{inside}{bodies}[display]\nback_faces = \"{policy}\"\n");
        let stage = centred(&scene(&text));
        let (traced, drawn) = (film(&stage, "trace"), film(&stage, "raster:none"));
        assert!(different(&traced, &drawn).len() <= 2, "{policy}");
        assert_alike(&traced, &drawn, 1e-9);
    }
}

#[test]
fn time_resolved_radiance_is_looked_up_alike() {
    // At rest: a capture re-projected, with gaps, occlusion and three channels.
    let mut captured = scene_file("capture.toml", [96, 72]);
    captured.camera.velocity = nullray::spacetime::Velocity::REST;
    captured.camera.origin.x.y -= 1.3;
    let stage = centred(&captured);
    let (traced, drawn) = (film(&stage, "trace"), film(&stage, "raster:none"));
    assert!(different(&traced, &drawn).len() <= 4);
    assert_alike(&traced, &drawn, 1e-8);
    assert_ne!(traced.mean_coverage().unwrap().held, 1.0);
    assert!(traced.radiance().iter().any(|c| c[0] > 0.0));
}

#[test]
fn films_are_the_same_on_any_number_of_threads() {
    let stage = centred(&scene_file("several-velocities.toml", [80, 50]));
    let on = |threads: usize, method: &str| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| film(&stage, method))
    };
    for method in [
        "raster:adaptive=0.2",
        "raster:uniform=0.3,attributes=vertex",
    ] {
        let (one, three) = (on(1, method), on(3, method));
        assert_eq!(one.radiance(), three.radiance());
        for aov in Aov::ALL {
            let bits = |film: &Film| {
                values(film, *aov)
                    .iter()
                    .map(|v| v.to_bits())
                    .collect::<Vec<_>>()
            };
            assert_eq!(bits(&one), bits(&three), "{method}");
        }
    }
}

#[test]
fn surfaces_that_are_smooth_by_their_vertices_are_shaded_as_by_the_ray_tracer() {
    let shape = Shape::Sphere {
        radius: 0.8,
        subdivisions: 1,
    };
    let mut mesh = shapes::mesh(shape, [0.9, 0.5, 0.3]);
    mesh.materials[0].roughness = 0.4;
    let normals = mesh.positions.iter().map(|p| p.as_vec3().to_array());
    mesh.normals = normals.collect();
    let lights = "[[light]]\ntype = \"directional\"\ndirection = [0.6, -0.8, 0]\nirradiance = 3\n\
                  [[light]]\nposition = [1, 2, 3]\nintensity = 5\n";
    // Where it is at first, to be seen at the left of the crate.
    for (beta, x, method, tolerance) in [
        (0.0, -1.2, "raster:none", 1e-10),
        (0.6, 1.0, "raster:adaptive=0.05", 0.01),
    ] {
        let scene = Builder::from_toml("smooth", &(camera("") + BODIES + lights))
            .mesh("ball", Arc::new(mesh.clone()))
            .set("object.ball.transform.translate", [x, 0.8, 0.0])
            .set("object.ball.velocity.beta", [beta, 0.0, 0.0])
            .build()
            .unwrap();
        let stage = centred(&scene);
        let (traced, drawn) = (film(&stage, "trace"), film(&stage, method));
        let (left, right) = (identities(&traced), identities(&drawn));
        let (mut compared, mut apart) = (0, 0);
        for i in (0..left.len()).filter(|i| left[*i] == right[*i] && left[*i].0 == 2) {
            let [x, y] = [&traced, &drawn].map(|film| film.radiance()[i][0]);
            apart += usize::from((x - y).abs() > tolerance * (0.05 + x));
            compared += 1;
        }
        // In motion, edges of shadows may be between the two places.
        let most = if beta == 0.0 { 0 } else { compared / 50 };
        assert!(apart <= most, "{beta}: {apart} of {compared}");
        assert!(compared > 300, "{compared}");
    }
}
