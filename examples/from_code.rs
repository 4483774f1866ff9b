//! A scene made of values, without any file, rendered, and its channels read:
//! `cargo run --release --example from_code`.

use nullray::render::{Aov, Plan, Prepared, Request, Silent, render};
use nullray::scene::Builder;
use nullray::scene::model::Shape;

fn main() -> nullray::Result<()> {
    let lattice = Shape::Lattice {
        cells: [4, 4, 4],
        spacing: 0.5,
        bar: 0.05,
    };
    let scene = Builder::new("a camera that flies at a lattice")
        .set("camera.eye", [0.0, 0.0, 3.0])
        .set("camera.look_at", [0.0, 0.0, 0.0])
        .set("camera.velocity.beta", [0.0, 0.0, -0.8])
        .set("camera.size", [160, 120])
        .shape("lattice", lattice)
        .build()?;
    let request = Request {
        aovs: vec![Aov::EventCt, Aov::WavelengthRatio],
        ..Request::default()
    };
    let plan = Plan::new(&scene, &request)?;
    println!("{plan}");
    let film = render(&Prepared::new(&scene, &plan, &Silent)?, &Silent)?;

    let (shape, radiance) = film.radiance_array();
    let brightest = radiance.iter().copied().fold(0.0, f64::max);
    println!("radiance, shape {shape:?}: at most {brightest}");
    for aov in [Aov::EventCt, Aov::WavelengthRatio] {
        let Some((shape, values)) = film.aov_array(aov) else {
            continue;
        };
        // Pixels that see no surface hold NaN.
        let seen = values.iter().copied().filter(|value| value.is_finite());
        let [low, high] = seen.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
            [low.min(value), high.max(value)]
        });
        println!("{}, shape {shape:?}: {low} to {high}", aov.name());
    }
    Ok(())
}
