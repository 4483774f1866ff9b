//! A radiance of one's own, as a function of the emission event: every point of a moving sphere shows stripes
//! that its own clock moves along, computed from channels:
//! `cargo run --release --example custom_radiance -- picture.png`.

use std::f64::consts::TAU;
use std::path::PathBuf;

use nullray::io::image::png;
use nullray::render::aov::Aov;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::{render, tonemap};
use nullray::scene::Builder;
use nullray::scene::model::{Exposure, Shape};
use nullray::spacetime::{Quantity, WavelengthRatio};

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
    let channels = [Aov::ObjectEventCt, Aov::ObjectEventY, Aov::WavelengthRatio];
    let request = Request {
        aovs: channels.into(),
        // One event per pixel, which no mean over samples blurs.
        pixel_centers: true,
        ..Request::default()
    };
    let plan = Plan::new(&scene, &request)?;
    let film = render(&Prepared::new(&scene, &plan, &Silent)?, &Silent)?;

    let [time, y, ratio] = channels.map(|aov| film.aov(aov).unwrap_or_default());
    let observed = |i: usize| {
        // NaN where no surface is seen.
        if time[i].is_nan() {
            return [0.0; 3];
        }
        let emitted = 0.5 + 0.5 * (TAU * (3.0 * y[i] - time[i])).sin();
        let factor = Quantity::Integrated.radiance_factor(WavelengthRatio(ratio[i]));
        [emitted * factor; 3]
    };
    let radiance: Vec<[f64; 3]> = (0..time.len()).map(observed).collect();
    let shown = tonemap::tonemap(&radiance, Exposure::Percentile(99.0))?;
    let [width, height] = film.size();
    png::write(&path, width, height, &shown.rgb, &[])?;
    let white = shown.white;
    println!("wrote {}; white is radiance {white}", path.display());
    Ok(())
}
