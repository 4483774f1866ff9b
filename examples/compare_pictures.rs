//! How far a picture with few samples is from one with many, channel by channel:
//! `cargo run --release --example compare_pictures`.

use nullray::io::image::Layers;
use nullray::render::metadata::metadata;
use nullray::render::{Aov, Plan, Prepared, Request, Silent, render};
use nullray::scene::Builder;
use nullray::scene::model::Shape;
use nullray::validate::compare::{Picture, compare, report};

/// The picture of a moving box with this many samples per pixel.
fn picture(samples: u32) -> nullray::Result<Picture> {
    let cube = Shape::Box {
        size: [1.0, 1.0, 1.0],
    };
    let scene = Builder::new("a moving box")
        .set("camera.eye", [1.0, 1.0, 3.0])
        .set("camera.look_at", [0.0, 0.0, 0.0])
        .set("camera.size", [160, 120])
        .set("camera.time", "3 m")
        .set("display.samples_per_pixel", samples)
        .shape("box", cube)
        .set("object.box.velocity.beta", [0.9, 0.0, 0.0])
        .build()?;
    let request = Request {
        aovs: vec![Aov::EventCt, Aov::WavelengthRatio],
        ..Request::default()
    };
    let plan = Plan::new(&scene, &request)?;
    let film = render(&Prepared::new(&scene, &plan, &Silent)?, &Silent)?;
    let [width, height] = film.size();
    let (channels, words) = (film.channels(&request.aovs), metadata(&scene, &film)?);
    let layers = Layers::new(width, height, channels, words)?;
    Ok(Picture::linear(format!("{samples} samples"), layers))
}

fn main() -> nullray::Result<()> {
    let (reference, candidate) = (picture(64)?, picture(4)?);
    let comparison = compare(&reference, &candidate, &Default::default())?;
    println!("{}", report::table(&comparison));
    if let Some(radiance) = comparison.radiance {
        println!("RMSE of the radiance: {}", radiance.rmse);
    }
    Ok(())
}
