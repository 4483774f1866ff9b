//! Moving meshes against brute force in the world frame, without any transform between frames.
//!
//! The reference (tests/data/moving_meshes/README.md) contracts each mesh, moves it, and intersects it with the light path in world
//! coordinates in 80-bit arithmetic. Here rays are transformed to rest frames. Object and triangle must agree in every pixel that is not on
//! an edge; numbers to 1e-13 of the scene's size, directions and ratios to 1e-14.

use crate::common::arrays::array_at;
use nullray::render::aov::{self, Aov};
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::{self, Overrides};

/// Numbers per pixel in the reference.
const COLUMNS: usize = 21;

fn compare(name: &str) {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/moving_meshes");
    let pixels = array_at(&folder.join(format!("{name}.npz")), "pixels");
    let scene = scene::load(&folder.join(format!("{name}.toml")), &Overrides::default()).unwrap();
    let request = Request {
        aovs: aov::parse("all").unwrap(),
        pixel_centers: true,
        ..Request::default()
    };
    let plan = Plan::new(&scene, &request).unwrap();
    let film = render(&Prepared::new(&scene, &plan, &Silent).unwrap(), &Silent).unwrap();
    let (mut met, mut worst) = (0, Worst::default());
    for (i, truth) in pixels.chunks_exact(COLUMNS).enumerate() {
        if truth[14] == 1.0 {
            continue;
        }
        let at = format!("{name}, row {}, column {}", i / 96, i % 96);
        assert_eq!(value(&film, Aov::Object, i), truth[0], "{at}: object");
        assert_eq!(value(&film, Aov::Primitive, i), truth[1], "{at}: triangle");
        worst.directions(&film, i, &truth[18..21]);
        if truth[0] >= 0.0 {
            worst.surface(&film, i, truth);
            met += 1;
        }
    }
    assert!(met > 500, "{name}: only {met} pixels see anything");
    worst.check(name);
}

fn value(film: &Film, aov: Aov, i: usize) -> f64 {
    film.aov(aov).unwrap()[i]
}

/// The largest deviations; lengths relative to 10 m, the size of the scenes.
#[derive(Default, Debug)]
struct Worst {
    direction: f64,
    distance: f64,
    event: f64,
    object_event: f64,
    ratio: f64,
    barycentric: f64,
}

impl Worst {
    fn directions(&mut self, film: &Film, i: usize, truth: &[f64]) {
        for (aov, truth) in [Aov::DirectionX, Aov::DirectionY, Aov::DirectionZ]
            .into_iter()
            .zip(truth)
        {
            self.direction = self.direction.max((value(film, aov, i) - truth).abs());
        }
    }

    fn surface(&mut self, film: &Film, i: usize, truth: &[f64]) {
        let events = [Aov::EventCt, Aov::EventX, Aov::EventY, Aov::EventZ];
        let object_events = [
            Aov::ObjectEventCt,
            Aov::ObjectEventX,
            Aov::ObjectEventY,
            Aov::ObjectEventZ,
        ];
        let off = |aov, column: usize| (value(film, aov, i) - truth[column]).abs();
        self.distance = self.distance.max(off(Aov::Distance, 4) / 10.0);
        for k in 0..4 {
            self.event = self.event.max(off(events[k], 5 + k) / 10.0);
            self.object_event = self.object_event.max(off(object_events[k], 9 + k) / 10.0);
        }
        self.ratio = self.ratio.max(off(Aov::WavelengthRatio, 13) / truth[13]);
        self.barycentric = self
            .barycentric
            .max(off(Aov::BarycentricU, 2))
            .max(off(Aov::BarycentricV, 3));
    }

    fn check(&self, name: &str) {
        for (what, error, limit) in [
            ("direction", self.direction, 1e-14),
            ("distance", self.distance, 1e-13),
            ("event", self.event, 1e-13),
            ("object event", self.object_event, 1e-13),
            ("wavelength ratio", self.ratio, 1e-14),
            // Measured in triangles: the smallest ones are a hundredth of the scene.
            ("barycentric", self.barycentric, 2e-12),
        ] {
            assert!(
                error <= limit,
                "{name}: worst {what} error {error:.2e} above {limit:.0e}"
            );
        }
    }
}

#[test]
fn a_static_camera_sees_moving_meshes_where_they_were() {
    compare("d1_static_camera");
}

#[test]
fn a_camera_at_half_c_sees_moving_meshes_where_they_were() {
    compare("d2_forward_half_c");
}

#[test]
fn an_oblique_camera_at_0_9_c_sees_moving_meshes_where_they_were() {
    compare("d3_oblique_09");
}
