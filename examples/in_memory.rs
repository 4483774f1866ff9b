//! A mesh made in memory flies past a camera at 0.9 c, and a wall shows a film of its own from an array:
//! `cargo run --release --example in_memory -- picture.png`.

use std::f64::consts::TAU;
use std::path::PathBuf;
use std::sync::Arc;

use nullray::glam::DVec3;
use nullray::io::cube::{Cube, CubeSamples};
use nullray::io::image::png;
use nullray::mesh::Mesh;
use nullray::render::{Plan, Prepared, Request, Silent, metadata::metadata, render, tonemap};
use nullray::scene::Builder;
use nullray::scene::model::Shape;

/// A band around the x axis, of radius 0.8: n pairs of triangles.
fn ring(n: u32) -> Mesh {
    let vertex = |i: u32| {
        let (sin, cos) = (TAU * f64::from(i / 2) / f64::from(n)).sin_cos();
        DVec3::new([-0.25, 0.25][i as usize % 2], 0.8 * cos, 0.8 * sin)
    };
    let pair = |k: u32| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| (2 * k + i) % (2 * n));
        [[a, c, b], [b, c, d]]
    };
    let (corners, triangles) = ((0..2 * n).map(vertex), (0..n).flat_map(pair));
    Mesh::new(corners.collect(), triangles.collect(), [0.9, 0.5, 0.1])
}

fn main() -> nullray::Result<()> {
    let path = std::env::args_os().nth(1).map(PathBuf::from);
    let path = path.unwrap_or_else(|| std::env::temp_dir().join("in_memory.png"));
    // 8 × 8 texels, each of which lights up at a time of its own.
    let samples = (0..8 * 8 * 64).map(|i| f32::from(i / 64 % 64 == i % 64));
    let samples = CubeSamples::F32(samples.collect());
    let cube = Cube::new([8, 8, 64, 1], samples)?;
    let size = [4.0, 3.0, 0.1];
    let scene = Builder::new("ring")
        .set("camera.eye", [0.0, 0.0, 4.0])
        .set("camera.look_at", [0.0, 0.0, 0.0])
        .set("camera.time", "8 m")
        .mesh("ring", Arc::new(ring(96)))
        .set("object.ring.velocity.beta", [0.9, 0.0, 0.0])
        .set("object.ring.origin.time", "4.4 m")
        .shape("wall", Shape::Box { size })
        .set("object.wall.origin.position", [0.0, 0.0, -2.0])
        .cube("light", Arc::new(cube), 0.1)
        .set("source.light.cube.values", "density")
        .set("source.light.objects", ["wall"])
        .build()?;
    let plan = Plan::new(&scene, &Request::default())?;
    let film = render(&Prepared::new(&scene, &plan, &Silent)?, &Silent)?;
    let shown = tonemap::tonemap(film.radiance(), scene.exposure)?;
    let [width, height] = film.size();
    png::write(&path, width, height, &shown.rgb, &metadata(&scene, &film)?)?;
    println!("wrote {}", path.display());
    Ok(())
}
