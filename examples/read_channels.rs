//! Lists the channels of an EXR file with their ranges. Without an argument, of one that it renders first:
//! `cargo run --release --example read_channels -- picture.exr`.

use std::path::{Path, PathBuf};

use nullray::io::budget::Budget;
use nullray::io::image::{Layers, exr};
use nullray::render::aov;
use nullray::render::metadata::metadata;
use nullray::render::{Plan, Prepared, Request, Silent, render};
use nullray::scene::Builder;
use nullray::scene::model::Shape;

/// Writes a picture of a plane, with all channels.
fn write(path: &Path) -> nullray::Result<()> {
    let scene = Builder::new("a plane")
        .set("camera.eye", [0.0, 1.0, 2.0])
        .set("camera.look_at", [0.0, 0.0, 0.0])
        .set("camera.size", [64, 48])
        .shape("plane", Shape::Plane { size: [2.0, 2.0] })
        .build()?;
    let request = Request {
        aovs: aov::parse("all").expect("all of them"),
        ..Request::default()
    };
    let plan = Plan::new(&scene, &request)?;
    let film = render(&Prepared::new(&scene, &plan, &Silent)?, &Silent)?;
    let [width, height] = film.size();
    let (channels, words) = (film.channels(&request.aovs), metadata(&scene, &film)?);
    exr::write(path, &Layers::new(width, height, channels, words)?)
}

fn main() -> nullray::Result<()> {
    let given = std::env::args_os().nth(1).map(PathBuf::from);
    let path = given
        .clone()
        .unwrap_or_else(|| std::env::temp_dir().join("channels.exr"));
    if given.is_none() {
        write(&path)?;
    }
    let layers = exr::read(&path, &Budget::default())?;
    println!(
        "{}: {} × {} pixels",
        path.display(),
        layers.width,
        layers.height
    );
    for channel in &layers.channels {
        let values = channel.samples.to_f64();
        let known = values.iter().copied().filter(|value| value.is_finite());
        let low = known.clone().fold(f64::INFINITY, f64::min);
        let high = known.fold(f64::NEG_INFINITY, f64::max);
        println!("{:20} {low} to {high}", channel.name);
    }
    Ok(())
}
