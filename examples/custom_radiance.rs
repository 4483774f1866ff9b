//! A radiance of one's own, as a function of the emission event: every point of a moving sphere shows stripes
//! that its own clock moves along:
//! `cargo run --release --example custom_radiance -- picture.png`.

use std::f64::consts::TAU;
use std::path::PathBuf;

use nullray::io::image::png;
use nullray::render::trace::{
    Colouring, Emission, Emitted, Meter, Radiance, Response, Run, Scaling,
};
use nullray::render::{Plan, Prepared, Request, Silent, render, tonemap};
use nullray::scene::Builder;
use nullray::scene::model::{Exposure, Shape};
use nullray::spacetime::Quantity;

/// Stripes across y, which go round once per metre of the sphere's own time.
#[derive(Debug)]
struct Stripes;

impl Radiance for Stripes {
    fn has_gaps(&self) -> bool {
        false
    }

    fn emit(&self, run: &Run, emitted: &mut Emitted, _: &mut Meter) {
        // Radiance over the whole spectrum: the camera sees W⁻⁴ of it.
        emitted.start(Response {
            scaled: Scaling::Of(Quantity::Integrated),
            colour: Colouring::Channels,
        });
        for point in run.points() {
            // In the frame in which the sphere rests, from its own origin on.
            let event = point.rest_event() - point.patch.object_origin;
            let stripe = 0.5 + 0.5 * (TAU * (3.0 * event.x.y - event.ct)).sin();
            emitted.push(Emission::full([stripe; 3]));
        }
    }
}

fn main() -> nullray::Result<()> {
    let path = std::env::args_os().nth(1).map(PathBuf::from);
    let path = path.unwrap_or_else(|| std::env::temp_dir().join("custom_radiance.png"));
    let sphere = Shape::Sphere {
        radius: 1.0,
        subdivisions: 5,
    };
    let scene = Builder::new("a striped sphere")
        .set("camera.eye", [0.0, 0.0, 4.0])
        .set("camera.look_at", [0.0, 0.0, 0.0])
        .set("camera.time", "4 m")
        .shape("sphere", sphere)
        .set("object.sphere.velocity.beta", [0.8, 0.0, 0.0])
        .build()?;
    let plan = Plan::new(&scene, &Request::default())?;
    let mut prepared = Prepared::new(&scene, &plan, &Silent)?;
    prepared.set_radiance(Box::new(Stripes));
    let film = render(&prepared, &Silent)?;

    let shown = tonemap::tonemap(film.radiance(), Exposure::Percentile(99.0))?;
    let [width, height] = film.size();
    png::write(&path, width, height, &shown.rgb, &[])?;
    let white = shown.white;
    println!("wrote {}; white is radiance {white}", path.display());
    Ok(())
}
