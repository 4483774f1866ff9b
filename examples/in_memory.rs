//! A mesh made in memory flies past a camera at 0.9 c, and a wall shows a film of its own from an array:
//! `cargo run --release --example in_memory -- picture.png`.

use std::f64::consts::TAU;
use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec3;
use nullray::io::cube::{Cube, Samples};
use nullray::io::image::png;
use nullray::mesh::Mesh;
use nullray::render::metadata::metadata;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::{render, tonemap};
use nullray::scene::Builder;
use nullray::scene::model::Shape;
use nullray::spacetime::Velocity;

/// A torus around the z axis, of the radii 0.7 and 0.25.
fn torus(n: u32) -> Mesh {
    let vertex = |i: u32| {
        let [u, v] = [i % n, i / n].map(|k| TAU * f64::from(k) / f64::from(n));
        let radius = 0.7 + 0.25 * v.cos();
        DVec3::new(radius * u.cos(), radius * u.sin(), 0.25 * v.sin())
    };
    let triangles = |i: u32| {
        let at = |du: u32, dv: u32| (i + du) % n + ((i / n + dv) % n) * n;
        let [a, b, c, d] = [i, at(1, 0), at(1, 1), at(0, 1)];
        [[a, b, c], [a, c, d]]
    };
    let positions = (0..n * n).map(vertex).collect();
    Mesh::new(
        positions,
        (0..n * n).flat_map(triangles).collect(),
        [0.9, 0.5, 0.1],
    )
}

fn main() -> nullray::Result<()> {
    let path = std::env::args_os().nth(1).map(PathBuf::from);
    let path = path.unwrap_or_else(|| std::env::temp_dir().join("in_memory.png"));
    // 8 × 8 texels, each of which lights up at a time of its own.
    let samples = (0..8 * 8 * 64)
        .map(|i| f32::from(i / 64 % 64 == i % 64))
        .collect();
    let cube = Cube::new([8, 8, 64, 1], Samples::F32(samples)).expect("its shape is right");
    let wall = Shape::Box {
        size: [4.0, 3.0, 0.1],
    };
    let scene = Builder::new("torus")
        .set("camera.eye", [0.0, 0.0, 4.0])
        .set("camera.look_at", [0.0, 0.0, 0.0])
        .set("camera.time", "8 m")
        .mesh("torus", Arc::new(torus(96)))
        .set(
            "object.torus.velocity",
            Velocity::from_beta(DVec3::X * 0.9).expect("below 1"),
        )
        .set("object.torus.origin.time", "4.4 m")
        .shape("wall", wall)
        .set("object.wall.origin.position", [0.0, 0.0, -2.0])
        .cube("light", Arc::new(cube), 0.1)
        .set("source.light.cube.values", "density")
        .set("source.light.objects", ["wall"])
        .build()?;
    let plan = Plan::new(&scene, &Request::default())?;
    let film = render(&Prepared::new(&scene, &plan, &Silent)?, &Silent)?;
    let shown = tonemap::tonemap(film.radiance(), scene.exposure)?;
    let [width, height] = film.size();
    png::write(&path, width, height, &shown.rgb, &metadata(&scene, &film))?;
    println!("wrote {}", path.display());
    Ok(())
}
