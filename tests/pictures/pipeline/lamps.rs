//! Lamps and shining surfaces, against closed forms.
//!
//! A lamp of intensity I that passes at the velocity β gives a floor at rest, at the event (t, x), the irradiance I W⁻² cos θ/r_G² with r =
//! t − t′ to its position at the retarded time t′, r_G = γ (r − β·R), R = x − x′, W = r_G/r and cos θ = h/r at the height h. t′ is the
//! smaller root of (t − t′)² = |x − x₀ − β t′|².

use glam::DVec3;
use nullray::colour::{Scale, Spectrum, SpectrumShape};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::scene::model::Scene;

use crate::pipeline::files::{self, Quad};
use crate::pipeline::lorentz;
use crate::pipeline::stage::{self, assert_relative};

const PI: f64 = std::f64::consts::PI;

/// A floor under lights.
fn floor(lights: &str) -> Scene {
    stage::scene(&format!(
        "
[camera]
eye = [1, 3, 4]
look_at = [0, 0, 0]
hfov = \"60 deg\"
size = [40, 30]
clock_zero = \"7 m\"
[[object]]
name = \"floor\"
shape = {{ plane = {{ size = [8, 8] }} }}
colour = [0.5, 0.25, 0.75]
{lights}"
    ))
}

/// The irradiance of a lamp of intensity 1 at (0, h, 0) + β (t − 2) x̂, at time t at the place x of the floor.
fn passing(beta: f64, h: f64, t: f64, x: DVec3) -> f64 {
    let (t, x0) = (t - 2.0, x - DVec3::Y * h);
    let b = DVec3::X * beta;
    // (1 − β²) t′² − 2 (t − β·x) t′ + t² − x² = 0.
    let (a, half, c) = (
        1.0 - beta * beta,
        t - b.dot(x0),
        t * t - x0.length_squared(),
    );
    let left = (half - (half * half - a * c).sqrt()) / a;
    let from = x0 - b * left;
    let r = t - left;
    assert!((from.length() - r).abs() < 1e-9 * r);
    let in_lamp = (r - b.dot(from)) / a.sqrt();
    let w = in_lamp / r;
    h / r / (w * w * in_lamp * in_lamp)
}

#[test]
fn a_lamp_that_passes_overhead_lights_the_floor_by_the_closed_form() {
    for beta in [0.0, 0.5, -0.9, 0.99] {
        let scene = floor(&format!(
            "[[light]]\nposition = [0, 1.7, 0]\nclock_zero = \"2 m\"\nintensity = [2, 1, 0.5]\n\
             velocity = {{ beta = [{beta}, 0, 0] }}"
        ));
        let film = stage::film(&scene);
        let met = stage::met(&film);
        assert!(met.len() > 500);
        for i in met {
            let (t, x) = stage::event(&film, i);
            let expected = passing(beta, 1.7, t, x);
            let parts = film.radiance()[i].into_iter().zip([1.0, 0.25, 0.375]);
            for (got, factor) in parts {
                let what = format!("pixel {i} at {beta}");
                assert_relative(got, factor / PI * expected, 1e-9, what);
            }
        }
    }
}

#[test]
fn power_and_cone_of_a_spot_are_those_of_gltf() {
    // Over the point below: on the axis 10 W / (2π ((1 − cᵢ) + (cᵢ − cₒ)/3)); nothing outside of 30°.
    let scene = floor(
        "[[light]]\ntype = \"spot\"\nposition = [0, 2, 0]\ndirection = [0, -1, 0]\npower = 10\n\
         inner = \"10 deg\"\nouter = \"30 deg\"",
    );
    let film = stage::film(&scene);
    let (inner, outer) = (10f64.to_radians().cos(), 30f64.to_radians().cos());
    let intensity = 10.0 / (2.0 * PI * ((1.0 - inner) + (inner - outer) / 3.0));
    for i in stage::met(&film) {
        let (_, x) = stage::event(&film, i);
        let r = x.distance(DVec3::Y * 2.0);
        let cosine = 2.0 / r;
        let part = ((cosine - outer) / (inner - outer)).clamp(0.0, 1.0);
        let expected = 0.5 / PI * intensity * part * part * cosine / (r * r);
        assert!((film.radiance()[i][0] - expected).abs() < 1e-9 * intensity);
    }
}

#[test]
fn a_pulsed_lamp_is_the_pulse_of_a_source() {
    // The peak of the lamp is 1, and the energy of the pulse 1 per solid angle: I/(σ √2π).
    let lamp = floor(
        "[[light]]\nposition = [0.7, 1.9, -0.4]\nclock_zero = \"0.3 m\"\nintensity = 2.5\n\
         emission = { gaussian = { sigma = \"0.4 m\" } }",
    );
    let pulse = floor(
        "[[source]]\npulse = { position = [0.7, 1.9, -0.4], time = \"0.3 m\", sigma = \"0.4 m\", intensity = 1 }",
    );
    let factor = 2.5 * 0.4 * (2.0 * PI).sqrt();
    let (lamp, pulse) = (stage::film(&lamp), stage::film(&pulse));
    for (a, b) in lamp.radiance().iter().zip(pulse.radiance()) {
        assert!((a[1] - factor * b[1]).abs() <= 1e-12 * a[1]);
    }
    assert!(lamp.radiance().iter().any(|rgb| rgb[0] > 1e-3));
}

#[test]
fn parallel_light_falls_with_the_cosine_and_casts_shadows() {
    let scene = floor(
        "[[object]]\nname = \"lid\"\nshape = { box = { size = [1, 0.1, 1] } }\ntransform = { translate = [0, 1, 0] }\n\
         [[light]]\ntype = \"directional\"\ndirection = [0.6, -0.8, 0]\nirradiance = 3",
    );
    let film = stage::film(&scene);
    let (mut lit, mut dark) = (0, 0);
    for i in stage::met(&film) {
        let (_, x) = stage::event(&film, i);
        if x.y > 1e-9 {
            continue;
        }
        // Under the lid along (−0.6, 0.8): x is ¾ of its height further.
        let shadow = |at: f64| (at - 0.75).abs() < 0.45 && x.z.abs() < 0.45;
        let clear = x.x < 0.1 || x.x > 1.4 || x.z.abs() > 0.6;
        if shadow(x.x) {
            assert_eq!(film.radiance()[i], [0.0; 3]);
            dark += 1;
        } else if clear {
            assert_relative(film.radiance()[i][0], 0.5 / PI * 3.0 * 0.8, 1e-12, i);
            lit += 1;
        }
    }
    assert!(lit > 300 && dark > 10, "{lit} {dark}");
}

#[test]
fn a_small_shining_panel_is_a_lamp_of_its_area() {
    // From 2 m, a panel of 4 cm is a point to (0.02/2)² = 10⁻⁴: E = L A cos² θ/r².
    for beta in [0.0, 0.6] {
        let area = floor(&format!(
            "[[object]]\nname = \"panel\"\nshape = {{ plane = {{ size = [0.04, 0.04] }} }}\n\
             transform = {{ translate = [0, 2, 0], rotate = {{ axis = [1, 0, 0], angle = \"180 deg\" }} }}\n\
             velocity = {{ beta = [{beta}, 0, 0] }}\norigin = {{ time = \"2 m\" }}\n\
             [[light]]\ntype = \"area\"\nobject = \"panel\"\nradiance = [2, 1, 0.5]"
        ));
        let film = stage::film(&area);
        let mut count = 0;
        for i in stage::met(&film) {
            let (t, x) = stage::event(&film, i);
            if stage::value(&film, nullray::render::aov::Aov::Object, i) != 0.0 {
                continue;
            }
            // In the panel's frame its light goes with the cosine to the vertical, h/r_G.
            let e = passing(beta, 2.0, t, x);
            let in_lamp = distance_in_lamp(beta, 2.0, t, x);
            let expected = 0.5 / PI * 2.0 * 0.0016 * e * (2.0 / in_lamp);
            assert_relative(film.radiance()[i][0], expected, 0.06, format!("{i} {beta}"));
            count += 1;
        }
        assert!(count > 500);
    }
}

/// A panel of 4 mm that shines down on the floor from 2 m and passes at β, with these keys of its own and of its light.
fn panel(beta: f64, keys: &str, light: &str, rest: &str) -> Scene {
    floor(&format!(
        "[[object]]\nname = \"panel\"\nshape = {{ plane = {{ size = [0.004, 0.004] }} }}\n{keys}\n\
         transform = {{ translate = [0, 2, 0], rotate = {{ axis = [1, 0, 0], angle = \"180 deg\" }} }}\n\
         velocity = {{ beta = [{beta}, 0, 0] }}\norigin = {{ time = \"2 m\" }}\n\
         [[light]]\ntype = \"area\"\nobject = \"panel\"\n{light}\n{rest}"
    ))
}

/// The pixels that show the floor.
fn of_floor(film: &nullray::render::film::Film) -> Vec<usize> {
    let object = nullray::render::aov::Aov::Object;
    let mut met = stage::met(film);
    met.retain(|i| stage::value(film, object, *i) == 0.0);
    assert!(met.len() > 500);
    met
}

#[test]
fn the_power_of_a_panel_is_what_it_sends_from_all_sides_that_shine() {
    // E = Φ/(π A) · A cos² θ/r² of one side, whatever its area; half of it where the other shines too.
    for (backs, sides) in [("culled", 1.0), ("two_sided", 2.0), ("black", 1.0)] {
        let rest = format!("[display]\nback_faces = \"{backs}\"");
        let film = stage::film(&panel(0.0, "", "power = [8, 4, 2]", &rest));
        let (floor, mut sum) = (of_floor(&film), 0.0);
        for &i in &floor {
            let (_, x) = stage::event(&film, i);
            let square = (x - DVec3::Y * 2.0).length_squared();
            let e = 8.0 / (sides * PI) * 4.0 / (square * square);
            let expected = 0.5 / PI * e;
            assert_relative(film.radiance()[i][0], expected, 0.01, backs);
            sum += film.radiance()[i][0] / expected;
        }
        assert_relative(sum / floor.len() as f64, 1.0, 3e-3, backs);
    }
}

/// The radiance of a white wall below a shining object, and a black one.
fn under(shining: &str, black: &str, light: &str) -> Vec<[f64; 3]> {
    let scene = stage::scene(&format!(
        "[camera]\neye = [0, 1, 3]\nforward = [0, -1, -3]\nhfov = \"40 deg\"\nsize = [16, 12]\n\
         [[object]]\nname = \"wall\"\nshape = {{ plane = {{ size = [50, 50] }} }}\ncolour = [1, 1, 1]\n\
         [[object]]\nname = \"shining\"\n{shining}\n\
         [[object]]\nname = \"black\"\ncolour = [0, 0, 0]\n{black}\n\
         [[light]]\ntype = \"area\"\nobject = \"shining\"\nradiance = 1\n{light}"
    ));
    stage::film(&scene).radiance().to_vec()
}

/// A square above the wall.
fn above(size: f64, y: f64) -> String {
    format!(
        "shape = {{ plane = {{ size = [{size}, {size}] }} }}\n\
         transform = {{ translate = [0, {y}, 0], rotate = {{ axis = [1, 0, 0], angle = \"180 deg\" }} }}"
    )
}

#[test]
fn what_is_close_in_front_of_a_distant_panel_blocks_all_of_its_light() {
    for (y, gap) in [(1e3, 5e-4), (1e7, 5.0), (1e9, 500.0)] {
        let lit = under(&above(y / 10.0, y), &above(1.0, -1.0), "");
        let dark = under(&above(y / 10.0, y), &above(y / 9.0, y - gap), "");
        assert!(lit.iter().all(|l| l[0] > 1e-3), "{y}");
        assert!(dark.iter().all(|l| l[0] == 0.0), "{y}");
    }
}

#[test]
fn neither_its_own_triangles_nor_a_ceiling_in_its_plane_shadow_what_shines() {
    let ball = "shape = { sphere = { radius = 0.4, subdivisions = 4 } }\ntransform = { translate = [1000, 3000, 0] }";
    let folded = "shape = { box = { size = [0.7, 0.5, 0.4] } }\n\
                  transform = { translate = [0.3, 2, 0], rotate = { axis = [1, 2, 3], angle = \"40 deg\" } }";
    let pane = above(0.7, 2.0);
    for (shining, black) in [
        (ball, above(1.0, -1.0)),
        (folded, above(1.0, -1.0)),
        (&pane, above(5.0, 2.0)),
        (&pane, above(0.7, 2.0)),
    ] {
        let [with, without] = ["", "shadows = false"].map(|light| under(shining, &black, light));
        assert!(with.iter().any(|l| l[0] > 0.0));
        assert_eq!(with, without, "{shining} {black}");
    }
}

#[test]
fn a_panel_with_a_spectrum_lights_by_it_as_surfaces_see_it() {
    // E_F = W² B(λ; T/W) A cos θ_F cos θ_G/r_G², by the light's own spectrum and by that of its object.
    let own = "spectrum = { blackbody = \"3000 K\" }";
    let rgb = "[radiance]\nquantity = \"rgb\"";
    let at = |w: f64| {
        let blackbody = |t: f64, scale| Spectrum::new(SpectrumShape::Blackbody(t), scale).unwrap();
        let factor = blackbody(3000.0, Scale::Luminance(1.0)).factor();
        blackbody(3000.0 / w, Scale::Factor(factor)).colour_at(1.0)
    };
    for (keys, light) in [("", own), (own, "")] {
        let scene = panel(0.6, keys, &format!("{light}\nradiance = 5"), rgb);
        let film = stage::film(&scene);
        for i in of_floor(&film) {
            let (t, x) = stage::event(&film, i);
            let in_lamp = distance_in_lamp(0.6, 2.0, t, x);
            // e = W⁻² h/(r r_G²) with r = r_G/W is W⁻¹ h/r_G³.
            let w = 2.0 / (passing(0.6, 2.0, t, x) * in_lamp.powi(3));
            let e = w.powi(3) * 2.0 / in_lamp.powi(3) * 1.6e-5 * (2.0 / in_lamp);
            let expected = [0.5, 0.25, 0.75].map(|albedo| albedo / PI * 5.0 * e);
            let expected: [f64; 3] = std::array::from_fn(|c| expected[c] * at(w)[c]);
            let largest = expected.into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
            for (got, expected) in film.radiance()[i].into_iter().zip(expected) {
                // dW/W = γβ · 1e-3 across the panel, times hc/λkT = 8 to 17 from red to blue: of a colour as a whole, as
                // its smallest channel is a difference of larger ones.
                let off = (got - expected).abs() / largest;
                assert!(
                    off < 0.01,
                    "{i} {keys}: {got} is not {expected}, off by {off}"
                );
            }
        }
    }
}

#[test]
fn a_panel_with_the_spectrum_of_rgb_is_one_of_rgb() {
    // Drawn and found by chance, and through reflections: the same numbers, but for rounding.
    let rest = "[radiance]\nquantity = \"rgb\"\n[display]\nsamples_per_pixel = 4\n\
                [[object]]\nshape = { sphere = { radius = 0.5 } }\nmetallic = 1\nroughness = 0.3\n\
                transform = { translate = [1, 0.6, 0] }";
    let with = |keys: &str, light: &str, bounces: u32| {
        let large = |scene: &mut Scene| {
            scene.objects[1].transform.matrix3 *=
                glam::DMat3::from_diagonal(DVec3::new(300.0, 1.0, 300.0));
            scene.bounces = bounces;
        };
        let mut scene = panel(0.0, keys, light, rest);
        large(&mut scene);
        stage::rendered(&scene, &stage::sampled()).unwrap()
    };
    for bounces in [0, 2] {
        let a = with("colour = [0, 0, 0]", "radiance = [2, 1, 0.5]", bounces);
        let b = with("", "spectrum = { rgb = [2, 1, 0.5] }", bounces);
        let mut lit = 0;
        for (a, b) in a.radiance().iter().zip(b.radiance()) {
            lit += usize::from(a[0] > 0.0);
            for c in 0..3 {
                assert!(
                    (a[c] - b[c]).abs() <= 1e-9 * a[0].max(1e-3),
                    "{bounces}: {a:?} {b:?}"
                );
            }
        }
        assert!(lit > 500, "{lit}");
    }
}

/// r_G of [`passing`].
fn distance_in_lamp(beta: f64, h: f64, t: f64, x: DVec3) -> f64 {
    let gamma = 1.0 / (1.0 - beta * beta).sqrt();
    let along = gamma * (x.x - beta * (t - 2.0));
    DVec3::new(along, x.y - h, x.z).length()
}

/// A ball and a box in motion, and three lamps of which two move.
const MOVING: &str = "
[camera]
eye = [0, 1, 5]
look_at = [0, 0.3, 0]
hfov = \"50 deg\"
size = [32, 24]
velocity = { beta = [0.3, 0.1, -0.2] }
[[object]]
name = \"ball\"
shape = { sphere = { radius = 0.7, subdivisions = 2 } }
metallic = 0.6
roughness = 0.4
velocity = { beta = [0.5, 0, 0.1] }
origin = { position = [-2, 0, 0], time = \"-5 m\" }
[[object]]
name = \"box\"
shape = { box = { size = [1, 1, 1] } }
transform = { translate = [1, 0, 0] }
[[light]]
position = [2, 3, 2]
intensity = 9
[[light]]
position = [-2, 2, 1]
clock_zero = \"-4 m\"
velocity = { beta = [0, 0.2, 0.7] }
intensity = [8, 4, 2]
[[light]]
type = \"spot\"
position = [1, 4, 1]
direction = [-0.2, -1, -0.2]
outer = \"40 deg\"
velocity = { beta = [-0.4, 0, 0] }
intensity = 12
";

#[test]
fn boosting_lamps_bodies_and_camera_together_changes_nothing_but_rounding() {
    let scene = stage::scene(MOVING);
    let film = stage::film(&scene);
    let lit = film.radiance().iter().filter(|rgb| rgb[0] > 0.0).count();
    assert!(lit > 30, "{lit}");
    for v in [DVec3::new(0.4, 0.0, 0.0), DVec3::new(-0.5, 0.8, 0.3)] {
        let moved = stage::film(&lorentz::boosted(&scene, v));
        let mut differ = 0;
        for (a, b) in film.radiance().iter().zip(moved.radiance()) {
            // On edges of bodies and shadows a ray may fall on the other side.
            let same = (0..3).all(|c| (a[c] - b[c]).abs() <= 1e-8 * a[c].max(1e-6));
            differ += usize::from(!same);
        }
        assert!(differ <= 4, "{differ} pixels differ at {v}");
    }
}

#[test]
fn a_lamp_of_the_spectrum_of_white_is_a_white_lamp() {
    let lamp = |more: &str| {
        floor(&format!(
            "[radiance]\nquantity = \"rgb\"\n[[light]]\nposition = [0, 1.7, 0]\nclock_zero = \"2 m\"\nintensity = 3\n\
             velocity = {{ beta = [0.4, 0, 0] }}\n{more}"
        ))
    };
    let plain = stage::film(&lamp(""));
    let spectrum = stage::film(&lamp("spectrum = { rgb = [1, 1, 1] }"));
    for (a, b) in plain.radiance().iter().zip(spectrum.radiance()) {
        // Both tables are right to 10⁻⁴.
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).abs() <= 5e-4 * a.abs(), "{a} {b}");
        }
    }
    assert!(plain.radiance().iter().any(|rgb| rgb[2] > 0.01));
}

#[test]
fn invalid_lights_are_refused_with_a_message() {
    let refused = |light: &str| {
        let text = format!(
            "camera = {{ eye = [0, 1, 5], look_at = [0, 0, 0] }}\nobject = [{{ shape = {{ plane = {{ size = [1, 1] }} }} }}]\n{light}"
        );
        let read = nullray::scene::parse(&text, "test", ".".as_ref(), &Default::default());
        read.unwrap_err().to_string()
    };
    for (light, words) in [
        ("[[light]]", "has no position"),
        ("[[light]]\nposition = [0, 1, 0]\nintensity = -1", "below 0"),
        (
            "[[light]]\nposition = [0, 1, 0]\nintensity = 1\npower = 1",
            "exclude each other",
        ),
        (
            "[[light]]\nposition = [0, 1, 0]\nvelocity = { beta = [1, 0, 0] }",
            "not below 1",
        ),
        (
            "[[light]]\ntype = \"spot\"\nposition = [0, 1, 0]",
            "needs a direction",
        ),
        (
            "[[light]]\nposition = [0, 1, 0]\ndirection = [0, 1, 0]",
            "has no `direction`",
        ),
        (
            "[[light]]\ntype = \"area\"\nobject = \"plan\"",
            "there is no object named",
        ),
        (
            "[[light]]\ntype = \"spot\"\nposition = [0, 1, 0]\ndirection = [0, 1, 0]\nouter = \"95 deg\"",
            "not a cone",
        ),
        (
            "[[light]]\ntype = \"spot\"\nposition = [0, 1, 0]\ndirection = [0, 1, 0]\ninner = \"50 deg\"",
            "`outer`, which is 45 deg where it is not given",
        ),
        (
            "[[light]]\nposition = [0, 1, 0]\nemission = { train = { sigma = \"1 m\", period = \"0.5 m\" } }",
            "run together",
        ),
        (
            "[[light]]\nposition = [0, 1, 0]\nemission = { train = { sigma = \"5 cm\", period = \"1 m\", count = 0 } }",
            "at least 1",
        ),
        (
            "[[light]]\ntype = \"area\"\nobject = \"plane\"\nemission.train = { sigma = \"5 cm\", period = \"1 m\", count = 0 }",
            "at least 1",
        ),
        (
            "[[light]]\nposition = [0, 1, 0]\nemission.table = [{ time = \"0 m\", factor = 0 }, { time = \"1 m\", factor = 0 }]",
            "all factors are 0",
        ),
        (
            "[[light]]\nposition = [0, 1, 0]\nemission.table = [{ time = \"1 m\", factor = 1 }, { time = \"0 m\", factor = 1 }]",
            "not after",
        ),
        (
            "medium.index = 1.5\n[[light]]\nposition = [0, 1, 0]\nvelocity = { beta = [0.1, 0, 0] }",
            "moves in a medium",
        ),
        (
            "[[light]]\nposition = [0, 1, 0]\nspectrum = { blackbody = \"3000 K\" }",
            "a lamp has a spectrum where",
        ),
        (
            "[[light]]\ntype = \"area\"\nobject = \"plane\"\nradiance = 1\npower = 1",
            "exclude each other",
        ),
        (
            "[[light]]\ntype = \"area\"\nobject = \"plane\"\nclock_zero = \"1 m\"",
            "has no `clock_zero`",
        ),
        (
            "[[light]]\ntype = \"area\"\nobject = \"plane\"\n[[light]]\ntype = \"area\"\nobject = \"plane\"",
            "already shines with another light",
        ),
        (
            "[[light]]\ntype = \"area\"\nobject = \"plane\"\nspectrum = { line = \"589 nm\" }",
            "an area light has a spectrum where",
        ),
        (
            "radiance.quantity = \"rgb\"\n[[light]]\ntype = \"area\"\nobject = \"plane\"\nradiance = [1, 2, 3]\n\
             spectrum = { line = \"589 nm\" }",
            "is one number",
        ),
        ("[sky]\nradiance = 1\ngradient = {}", "given twice"),
        ("[sky]\nimage = { file = \"nowhere.exr\" }", "cannot find"),
        ("[sky]\nsun = { direction = [0, 0, 0] }", "zero vector"),
        ("[sky]\nstars = { count = 2000000 }", "too many"),
        (
            "[sky]\n[display]\nbackground = [1, 1, 1]",
            "exclude each other",
        ),
        (
            "[sky]\n[radiance]\nquantity = \"line\"\nwavelength = \"532 nm\"",
            "no single wavelength",
        ),
    ] {
        let error = refused(light);
        assert!(error.contains(words), "{light}: {error}");
    }
}

#[test]
fn emission_of_a_file_that_no_light_lets_be_seen_is_named() {
    let folder = tempfile::tempdir().unwrap();
    for (lights, emissive, said) in [
        ("", [1.0, 0.5, 0.0], true),
        ("", [0.0; 3], false),
        ("[sky]\nradiance = 0\n", [1.0, 0.5, 0.0], false),
    ] {
        let material = format!(r#"{{ "emissiveFactor": {emissive:?} }}"#);
        let quad = Quad {
            material: Some(&material),
            ..Quad::PLAIN
        };
        files::glb(&folder.path().join("quad.glb"), &quad);
        let text = format!(
            "[camera]\neye = [0, 0, 2]\nlook_at = [0, 0, 0]\nsize = [4, 4]\n{lights}[[object]]\nname = 'panel'\ngltf = 'quad.glb'\n"
        );
        let scene = stage::scene_in(folder.path(), &text);
        let plan = Plan::new(&scene, &Request::default()).unwrap();
        let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
        let warnings = prepared.warnings.join("\n");
        assert_eq!(
            warnings.contains("only lit scenes"),
            said,
            "{lights} {emissive:?}: {warnings}"
        );
        // The plan knows it before anything is loaded.
        let notes = plan.notes.join("\n");
        assert_eq!(
            notes.contains("object \"panel\": only lit"),
            said,
            "{notes}"
        );
        let radiance = plan.objects[0].radiance.join("\n");
        assert_eq!(
            radiance.contains("and what it emits"),
            !lights.is_empty(),
            "{radiance}"
        );
    }
}

#[test]
fn textures_of_metal_roughness_and_emission_are_factors_on_those_of_the_material() {
    // One texel (200, 128, 64): roughness 128/255 and metalness 64/255 as they are, emission by sRGB's curve.
    let mut image = Vec::new();
    let mut encoder = png::Encoder::new(&mut image, 1, 1);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[200, 128, 64]).unwrap();
    writer.finish().unwrap();
    let linear = |code: f64| ((code / 255.0 + 0.055) / 1.055).powf(2.4);
    let textured = r#"{ "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.25, 0.125, 1], "metallicFactor": 0.9,
        "roughnessFactor": 0.8, "metallicRoughnessTexture": { "index": 0 } },
        "emissiveFactor": [0.5, 1, 0.25], "emissiveTexture": { "index": 0 } }"#;
    let plain = format!(
        r#"{{ "pbrMetallicRoughness": {{ "baseColorFactor": [0.5, 0.25, 0.125, 1], "metallicFactor": {},
        "roughnessFactor": {} }}, "emissiveFactor": [{}, {}, {}] }}"#,
        0.9 * 64.0 / 255.0,
        0.8 * 128.0 / 255.0,
        0.5 * linear(200.0),
        linear(128.0),
        0.25 * linear(64.0)
    );
    let films = [textured, &plain].map(|material| {
        let folder = tempfile::tempdir().unwrap();
        let quad = Quad {
            image: Some(&image),
            material: Some(material),
            ..Quad::PLAIN
        };
        files::glb(&folder.path().join("quad.glb"), &quad);
        let scene = stage::scene_in(
            folder.path(),
            "[camera]\neye = [1, 0.5, 2]\nlook_at = [0, 0, 0]\nsize = [24, 16]\n\
             [[light]]\nposition = [-1, 0.5, 2]\nintensity = 3\n[[object]]\ngltf = 'quad.glb'\n",
        );
        stage::film(&scene)
    });
    let met = stage::met(&films[0]);
    assert!(met.len() > 50, "{}", met.len());
    for i in met {
        for c in 0..3 {
            let [a, b] = [&films[0], &films[1]].map(|film| film.radiance()[i][c]);
            // Factors and texels are f32.
            assert!((a / b - 1.0).abs() < 1e-5, "pixel {i}: {a} and {b}");
        }
    }
}

/// Light that comes back to where it came from has v·h = 1, and F = f₀ = ((ν − 1)/(ν + 1))²; a black surface reflects nothing else. From a sky
/// of radiance 1 that a mirror bounces along its normal comes f₀ itself.
#[test]
fn what_a_dielectric_mirrors_follows_from_its_index() {
    let folder = tempfile::tempdir().unwrap();
    let mean = |lights: &str, object: &str| {
        let text = format!(
            "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nhfov = \"1 deg\"\nsize = [4, 4]\n{lights}\n[[object]]\n{object}\n"
        );
        let film = stage::film(&stage::scene_in(folder.path(), &text));
        let met = stage::met(&film);
        assert_eq!(met.len(), 16);
        met.iter().map(|i| film.radiance()[*i][1]).sum::<f64>() / 16.0
    };
    let shape = |roughness: f64, ior: &str| {
        format!(
            "shape = {{ box = {{ size = [1, 1, 1] }} }}\ncolour = [0, 0, 0]\nroughness = {roughness}\n{ior}"
        )
    };
    let lamp = "[[light]]\nposition = [0, 0, 5]\nintensity = 3\n";
    let sky = "[sky]\nradiance = 1\n[render]\nbounces = 1\n";
    let usual = mean(lamp, &shape(0.3, ""));
    assert_eq!(
        usual.to_bits(),
        mean(lamp, &shape(0.3, "ior = 1.5")).to_bits()
    );
    for (ior, f0) in [(1.0, 0.0), (1.5, 0.04), (2.5, 9.0 / 49.0)] {
        let own = format!("ior = {ior:?}");
        let lit = mean(lamp, &shape(0.3, &own)) / usual;
        assert!((lit - f0 / 0.04).abs() < 1e-9, "{ior}: {lit}");
        let bounced = mean(sky, &shape(0.0, &own));
        assert!((bounced - f0).abs() < 1e-9, "{ior}: {bounced}");
    }
    // A model's material, which has the same roughness.
    let of_model = |extension: &str| {
        let material = format!(
            r#"{{ "pbrMetallicRoughness": {{ "baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0, "roughnessFactor": 0.3 }}{extension} }}"#
        );
        let quad = Quad {
            material: Some(&material),
            ..Quad::PLAIN
        };
        files::glb(&folder.path().join("quad.glb"), &quad);
        mean(lamp, "gltf = 'quad.glb'")
    };
    let extension = r#", "extensions": { "KHR_materials_ior": { "ior": 2.5 } }"#;
    let lit = of_model(extension) / of_model("");
    assert!((lit - 9.0 / 49.0 / 0.04).abs() < 1e-9, "{lit}");
}

#[test]
fn a_colour_on_the_spectrum_of_a_lamp_is_a_filter_that_moves_with_it() {
    // Sampled wavelengths, which filter the light in the lamp's frame, against the table of colours.
    for shape in ["blackbody = \"5800 K\"", "line = \"589 nm\""] {
        let [coarse, fine] = [("rgb", 1), ("sampled", 512)].map(|(spectra, samples)| {
            let scene = stage::scene(&format!(
                "radiance.quantity = \"rgb\"\nrender.spectra = \"{spectra}\"\n\
                 [camera]\neye = [0, 2, 0]\nlook_at = [0, 0, 0]\nup = [0, 0, 1]\nhfov = \"0.001 deg\"\nsize = [2, 2]\n\
                 [[object]]\nshape = {{ plane = {{ size = [50, 50] }} }}\ncolour = [1, 1, 1]\n\
                 [[light]]\nposition = [0, 3, 0]\nclock_zero = \"-5 m\"\nvelocity = {{ beta = [0, -0.2, 0] }}\n\
                 intensity = [1, 0.05, 0.05]\nspectrum = {{ {shape} }}\n\
                 [display]\nsamples_per_pixel = {samples}"
            ));
            stage::rendered(&scene, &stage::sampled()).unwrap().radiance()[0]
        });
        let most = fine.iter().fold(0.0f64, |most, c| most.max(c.abs()));
        for (a, b) in coarse.into_iter().zip(fine) {
            assert!((a - b).abs() < 2e-3 * most, "{shape}: {coarse:?} {fine:?}");
        }
    }
}
