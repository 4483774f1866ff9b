//! The traced pixel is that of the picture, bit for bit.

use nullray::figures::pixel_probe::Probe;
use nullray::render::aov::{self, Aov};
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::model::Scene;

use crate::pixel_probe::{ALL, scene, text, traced};

fn picture(scene: &Scene) -> Film {
    let request = Request {
        aovs: aov::parse("all").unwrap(),
        pixel_centers: true,
        ..Request::default()
    };
    let plan = Plan::new(scene, &request).unwrap();
    render(&Prepared::new(scene, &plan, &Silent).unwrap(), &Silent).unwrap()
}

/// The picture's values, and those of the probe, as bits.
fn pairs(film: &Film, probe: &Probe) -> Vec<(Aov, u64, u64)> {
    let [column, row] = probe.pixel;
    let i = (row * film.size()[0] + column) as usize;
    let direction = probe.direction.unit();
    let mut values = vec![
        (Aov::DirectionX, direction.x),
        (Aov::DirectionY, direction.y),
        (Aov::DirectionZ, direction.z),
        (
            Aov::Object,
            probe.hit.as_ref().map_or(-1.0, |hit| hit.object as f64),
        ),
    ];
    if let Some(hit) = &probe.hit {
        values.extend([
            (Aov::Primitive, f64::from(hit.triangle)),
            (Aov::EventCt, hit.emission.ct),
            (Aov::EventX, hit.emission.x.x),
            (Aov::EventY, hit.emission.x.y),
            (Aov::EventZ, hit.emission.x.z),
            (Aov::ObjectEventCt, hit.time),
            (Aov::ObjectEventX, hit.place.x),
            (Aov::ObjectEventY, hit.place.y),
            (Aov::ObjectEventZ, hit.place.z),
            (Aov::Distance, hit.distance),
            (Aov::WavelengthRatio, hit.ratio),
        ]);
    }
    // −0 and 0 are the same number.
    let bits = |value: f64| (value + 0.0).to_bits();
    let rendered = |aov| film.aov(aov).unwrap()[i];
    values
        .iter()
        .map(|(aov, value)| (*aov, bits(*value), bits(rendered(*aov))))
        .collect()
}

#[test]
fn every_camera_sees_in_a_pixel_what_its_picture_has_there() {
    let mut objects = [0; 3];
    for camera in ALL {
        let scene = scene(&text(camera));
        let film = picture(&scene);
        for pixel in [
            [0, 0],
            [5, 12],
            [16, 12],
            [17, 20],
            [31, 23],
            [12, 15],
            [20, 14],
        ] {
            let probe = traced(&scene, pixel).unwrap();
            for (aov, traced, rendered) in pairs(&film, &probe) {
                assert_eq!(traced, rendered, "{} of {pixel:?}: {camera}", aov.name());
            }
            objects[probe.hit.map_or(2, |hit| hit.object)] += 1;
        }
    }
    assert!(objects.iter().all(|count| *count > 0), "{objects:?}");
}

#[test]
fn the_data_of_a_probe_are_its_numbers() {
    let scene = scene(&text(crate::pixel_probe::MOVING));
    let probe = traced(&scene, [16, 20]).unwrap();
    let data = serde_json::to_value(&probe).unwrap();
    let (surface, hit) = (&data["surface"], probe.hit.unwrap());
    assert_eq!(surface["emission"][0], hit.emission.ct);
    assert_eq!(surface["wavelength_ratio"], hit.ratio);
    assert_eq!(surface["object"], "floor");
    assert_eq!(data["reception_proper_time"], 0.3);
}
