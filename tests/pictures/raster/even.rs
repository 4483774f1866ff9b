//! Pictures of uniformly shining surfaces, which are drawn without shading.

use nullray::render::film::Film;
use nullray::render::plan::Request;
use nullray::render::trace::{
    Colouring, Dependence, Emission, Emitted, Meter, Radiance, Response, Run, Scaling,
};

use super::stage::{film, prepared, scene};

/// Boxes and balls of several colours, at rest and in motion, in front of and intersecting each other, on a floor that passes below the camera.
const BODIES: &str = r#"
[[object]]
shape = { plane = { size = [9.0, 9.0] } }
colour = [0.5, 0.6, 0.4]
[[object]]
shape = { box = { size = [1.0, 1.1, 0.9] } }
colour = [0.7, 0.3, 0.2]
transform = { rotate = { axis = [0.2, 1.0, 0.1], angle = "30 deg" }, translate = [0.2, 0.5, 0.0] }
[[object]]
shape = { sphere = { radius = 0.4, subdivisions = 3 } }
colour = [0.2, 0.3, 0.9]
transform = { translate = [0.7, 0.5, 0.3] }
"#;
const MOVING: &str = r#"
[[object]]
shape = { sphere = { radius = 0.5, subdivisions = 3 } }
colour = [0.1, 0.9, 0.3]
velocity = { beta = [0.8, 0.0, 0.0] }
origin = { position = [-0.6, 0.9, 0.4], time = "-3 m" }
[[object]]
shape = { box = { size = [0.8, 0.8, 0.8] } }
colour = [0.9, 0.9, 0.3]
velocity = { beta = [0.0, 0.3, -0.4] }
origin = { position = [0.3, 0.6, 0.8], time = "-3 m" }
"#;

/// The radiance of each emitter, for shading point by point.
#[derive(Debug)]
struct Shaded {
    scaled: Scaling,
    radiance: Vec<[f64; 3]>,
}

impl Radiance for Shaded {
    fn dependence(&self) -> Dependence {
        Dependence::Patch
    }

    fn has_gaps(&self) -> bool {
        false
    }

    fn emit(&self, run: &Run, emitted: &mut Emitted, _: &mut Meter) {
        emitted.start(Response {
            scaled: self.scaled,
            colour: Colouring::Channels,
        });
        let radiance = self.radiance[run.patch.emitter as usize];
        for _ in 0..run.count() {
            emitted.push(Emission::full(radiance));
        }
    }
}

/// The films of a scene without and with shading.
fn films(text: &str, samples: u32, method: &str) -> [Film; 2] {
    let text =
        format!("[display]\nsamples_per_pixel = {samples}\nbackground = [0.01, 0.3, 0.02]\n{text}");
    let mut stage = prepared(&scene(&text), &Request::default());
    let fast = film(&stage, method);
    let (scaled, radiance) = stage.radiance().even().unwrap();
    stage.set_radiance(Box::new(Shaded { scaled, radiance }));
    [fast, film(&stage, method)]
}

fn camera(more: &str) -> String {
    format!(
        "[camera]\neye = [0.4, 0.9, 2.0]\nlook_at = [0.1, 0.4, 0]\nhfov = \"70 deg\"\nsize = [70, 53]\n{more}\n"
    )
}

fn bits(film: &Film) -> Vec<[u64; 3]> {
    let all = film.radiance().iter();
    all.map(|rgb| rgb.map(f64::to_bits)).collect()
}

#[test]
fn pictures_of_even_surfaces_are_those_of_shading_bit_for_bit() {
    let cameras = [
        "",
        "velocity = { beta = [0.1, -0.5, -0.6] }",
        "velocity = { beta = [0.0, 0.0, 0.9] }",
    ];
    let mut count = 0;
    for more in cameras {
        for moving in ["", MOVING] {
            let text = format!("{}{BODIES}{moving}", camera(more));
            for samples in [1, 2, 7, 8, 16, 24, 33] {
                let [fast, shaded] = films(&text, samples, "raster:adaptive=0.5");
                assert!(bits(&fast) == bits(&shaded), "{more} {samples}");
                assert_eq!(fast.met(), shaded.met());
                count += bits(&fast).len();
            }
        }
    }
    assert_eq!(count, 3 * 2 * 7 * 70 * 53);
}

#[test]
fn black_backs_and_directions_without_aberration_are_those_of_shading() {
    let open = "[[object]]\nshape = { plane = { size = [3.0, 3.0] } }\ncolour = [0.9, 0.1, 0.2]\n\
                transform = { rotate = { axis = [1.0, 0.0, 0.0], angle = \"-50 deg\" }, translate = [0.0, 0.6, -0.4] }\n";
    let velocity = "velocity = { beta = [0.3, 0.0, -0.6] }";
    for more in ["", "[effects]\naberration = false\n"] {
        let text = format!(
            "back_faces = \"black\"\n{more}{}{BODIES}{open}{MOVING}",
            camera(velocity)
        );
        for samples in [1, 16] {
            let [fast, shaded] = films(&text, samples, "raster:none");
            assert!(bits(&fast) == bits(&shaded), "{more} {samples}");
            assert!(fast.radiance().contains(&[0.0; 3]));
        }
    }
}

#[test]
fn what_depends_on_more_than_patches_is_left_to_shading() {
    let pulse = "[[source]]\npulse = { position = [1, 3, 2], time = \"0 m\", sigma = \"9 m\", intensity = 20.0 }\n";
    let text = format!("{}{BODIES}{MOVING}", camera(""));
    let lit = prepared(&scene(&format!("{text}{pulse}")), &Request::default());
    assert!(lit.radiance().even().is_none());
    // W between vertices differs from that of the samples.
    let [by_vertex, shaded] = films(&text, 1, "raster:none,attributes=vertex");
    assert!(bits(&by_vertex) == bits(&shaded));
    let [exact, _] = films(&text, 1, "raster:none");
    assert!(bits(&by_vertex) != bits(&exact));
}
