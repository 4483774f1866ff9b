//! Missing data are counted, pixel by pixel and in the mean.
//!
//! In the channel a ray that hits nothing counts as covered: its radiance, the background, is known. The mean is that of rays that hit
//! surfaces with data.

use std::path::Path;

use nullray::light::time_texture::Coverage;
use nullray::render::aov::Aov;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::render::trace::{
    Colouring, Emission, Emitted, Meter, Radiance, Response, Run, Scaling,
};
use nullray::scene::model::Scene;
use nullray::scene::{self, Overrides};

use crate::pipeline::{files, stage};

fn capture() -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/capture.toml");
    let mut scene = scene::load(&path, &Overrides::default()).unwrap();
    scene.camera.size = [64, 48];
    scene.samples_per_pixel = 4;
    scene
}

#[test]
fn the_parts_of_coverage_sum_to_one_at_any_time() {
    let mut scene = capture();
    let mut seen = [0.0_f64; 5];
    for time in [-4.0, -1.0, 0.0, 1.0, 6.0] {
        scene.camera.time = time;
        let film = stage::rendered(&scene, &stage::sampled()).unwrap();
        let mean = film.mean_coverage().unwrap();
        assert!((mean.total() - 1.0).abs() < 1e-12, "{mean:?}");
        let aov = film.aov(Aov::Coverage).unwrap();
        assert!(aov.iter().all(|c| (0.0..=1.0 + 1e-15).contains(c)));
        let held = aov.iter().sum::<f64>() / aov.len() as f64;
        // All surfaces have data.
        let part = film.from_data();
        assert!((part - film.met()).abs() < 1e-12, "{part}");
        let expected = mean.held * part + (1.0 - part);
        assert!((held - expected).abs() < 1e-12, "{held} {expected}");
        let parts = [
            mean.held,
            mean.before,
            mean.after,
            mean.off_texture,
            mean.occluded,
        ];
        let channels = [
            Aov::MissingBefore,
            Aov::MissingAfter,
            Aov::MissingOffTexture,
            Aov::MissingOccluded,
        ];
        for (channel, part) in channels.into_iter().zip(&parts[1..]) {
            let values = film.aov(channel).unwrap();
            let sum = values.iter().sum::<f64>() / values.len() as f64;
            let part = part * film.from_data();
            assert!((sum - part).abs() < 1e-12, "{channel:?}: {sum} {part}");
        }
        seen.iter_mut().zip(parts).for_each(|(s, p)| *s = s.max(p));
    }
    assert!(seen.iter().all(|part| *part > 0.0), "never seen: {seen:?}");
}

#[test]
fn coverage_is_summed_without_channels_too() {
    let scene = capture();
    let with = stage::rendered(&scene, &stage::sampled()).unwrap();
    let without = stage::rendered(&scene, &Request::default()).unwrap();
    assert_eq!(with.mean_coverage(), without.mean_coverage());
    assert_eq!(with.radiance(), without.radiance());
}

#[test]
fn footprints_are_those_of_the_capture_cameras_pixels_on_the_surface() {
    // A capture camera of 4 pixels across 90°, 3 m above a floor: straight below, a pixel is 3 · 2 tan 45° / 4 = 1.5 m
    // wide; 3 m to the side, where it looks down at 45°, the depth is 3 m still, and the tilt widens it by √2.
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    files::npy(&folder.join("footprint.npy"), &[4, 4, 4], [1.0; 64]);
    let text = "
[camera]
eye = [0, 5, 0]
look_at = [0, 0, 0]
up = [0, 0, -1]
hfov = \"80 deg\"
size = [41, 41]
[[object]]
shape = { plane = { size = [20, 20] } }
[[source]]
[source.cube]
file = \"footprint.npy\"
bin_width = \"1 m\"
capture = { eye = [0, 3, 0], look_at = [0, 0, 0], up = [0, 0, -1], hfov = \"90 deg\" }
";
    let film = stage::film(&stage::scene_in(folder, text));
    for i in 0..stage::pixels(&film) {
        let (_, place) = stage::event(&film, i);
        let cosine = 3.0 / (9.0 + place.x * place.x + place.z * place.z).sqrt();
        let value = |aov| stage::value(&film, aov, i);
        stage::assert_relative(value(Aov::CaptureCosine), cosine, 1e-12, "cosine");
        stage::assert_relative(value(Aov::CaptureFootprint), 1.5 / cosine, 1e-12, "width");
    }
}

#[test]
fn marks_are_shown_as_they_are_whatever_the_factors() {
    let film = stage::film(&capture());
    let mut marked = 0;
    for i in stage::met(&film) {
        let c = film.radiance()[i];
        // Off the texture and occluded are both marked by this colour; before and after are black.
        if stage::value(&film, Aov::Coverage, i) == 0.0 && c != [0.0; 3] {
            for (got, mark) in c.into_iter().zip([0.05, 0.0, 0.08]) {
                assert!((got - mark).abs() < 1e-15, "{c:?}");
            }
            marked += 1;
        }
    }
    assert!(marked > 100, "{marked}");
}

/// A square of side 2 with a cube of radiance 3 on its texture coordinates, before a background.
fn square(test: &str) -> Scene {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let name = format!("{test}.npy");
    files::npy(&folder.join(&name), &[1, 1, 4], [3.0; 4]);
    let text = SQUARE.replace("cube.npy", &name);
    stage::scene_in(folder, &text)
}

const SQUARE: &str = "
outside = { before = { mark = [1, 0, 0] }, after = { mark = [0, 1, 0] } }
[display]
background = [0.25, 0.5, 0.75]
[camera]
eye = [0, 4, 0]
look_at = [0, 0, 0]
up = [0, 0, -1]
hfov = \"60 deg\"
size = [16, 16]
[[object]]
shape = { plane = { size = [2, 2] } }
[[source]]
cube = { file = \"cube.npy\", start = \"1 m\", bin_width = \"0.5 m\", values = \"density\", filter = \"linear\" }
";

#[test]
fn times_before_and_after_the_data_are_distinguished_and_misses_are_covered() {
    // Light from the square left 4 to 4.3 m ago; the data are from 1 to 3 m.
    for (time, expected, held) in [
        (4.5, [1.0, 0.0, 0.0], 0.0),
        (6.5, [3.0; 3], 1.0),
        (7.6, [0.0, 1.0, 0.0], 0.0),
    ] {
        let mut scene = square("before");
        scene.camera.time = time;
        let film = stage::film(&scene);
        let met = stage::met(&film);
        assert!(met.len() > 20 && met.len() < stage::pixels(&film));
        assert_eq!(film.mean_coverage().unwrap().held, held);
        for i in 0..stage::pixels(&film) {
            let (radiance, coverage) = match met.contains(&i) {
                true => (expected, held),
                false => ([0.25, 0.5, 0.75], 1.0),
            };
            assert_eq!(film.radiance()[i], radiance);
            assert_eq!(stage::value(&film, Aov::Coverage, i), coverage);
        }
    }
}

#[test]
fn where_nothing_can_be_missing_the_coverage_channel_is_one() {
    let mut scene = square("full");
    scene.sources.clear();
    let film = stage::film(&scene);
    assert_eq!(film.mean_coverage(), None);
    assert!(film.aov(Aov::Coverage).unwrap().iter().all(|c| *c == 1.0));
}

/// The radiance of a ball without data and that of the background are known, and say nothing of the data.
#[test]
fn mean_coverage_is_that_of_surfaces_with_data() {
    for sky in ["", "[sky]\nradiance = 0.5\nlights = false\n"] {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
        files::npy(&folder.join("mean.npy"), &[1, 1, 4], [3.0; 4]);
        let ball = "[[object]]\nname = \"ball\"\nshape = { sphere = { radius = 0.4 } }\n\
                    transform = { translate = [1.6, 0, 0] }\n[[source]]\nobjects = [\"plane\"]\n";
        let mut text = SQUARE
            .replace("cube.npy", "mean.npy")
            .replace("[[source]]\n", ball);
        if !sky.is_empty() {
            text = text.replace("background = [0.25, 0.5, 0.75]", "");
            text += sky;
        }
        let mut scene = stage::scene_in(folder, &text);
        // Before the data, and in the midst of them.
        for (time, held) in [(4.5, 0.0), (6.5, 1.0)] {
            scene.camera.time = time;
            let film = stage::film(&scene);
            let objects = film.aov(Aov::Object).unwrap();
            let of = |index: f64| objects.iter().filter(|o| **o == index).count();
            assert!(of(0.0) > 20 && of(1.0) > 3 && of(-1.0) > 20);
            let mean = film.mean_coverage().unwrap();
            assert_eq!((mean.held, mean.before), (held, 1.0 - held), "{sky}");
            let part = of(0.0) as f64 / objects.len() as f64;
            assert!((film.from_data() - part).abs() < 1e-15);
            for (object, coverage) in objects.iter().zip(film.aov(Aov::Coverage).unwrap()) {
                let expected = if *object == 0.0 { held } else { 1.0 };
                assert_eq!(*coverage, expected, "{sky}: {object}");
            }
        }
    }
}

/// The picture of a fisheye of 360° is a disc: in its corners there is nothing to see, whatever gives light.
#[test]
fn beyond_the_picture_of_a_fisheye_there_is_nothing() {
    let fisheye = "
[camera]
eye = [0, 1.5, 0]
look_at = [0, 1.5, -1]
projection = \"fisheye_equidistant\"
hfov = \"360 deg\"
size = [16, 16]
[[object]]
shape = { plane = { size = [9, 9] } }
";
    for light in ["", "[sky]\nradiance = 0.5\n"] {
        let scene = stage::scene(&format!("{fisheye}{light}"));
        let film = stage::rendered(&scene, &stage::sampled()).unwrap();
        assert_eq!(film.mean_coverage(), None, "{light}");
        assert_eq!(film.hidden(), 0.0);
        let (mut beyond, mut at_edge) = (0, 0);
        for i in 0..stage::pixels(&film) {
            assert_eq!(stage::value(&film, Aov::Coverage, i), 1.0, "{light} {i}");
            assert_eq!(stage::value(&film, Aov::MissingOccluded, i), 0.0);
            let d = [Aov::DirectionX, Aov::DirectionY, Aov::DirectionZ]
                .map(|aov| stage::value(&film, aov, i));
            // The nearest and the farthest point of the pixel from the middle of the disc, of radius 8.
            let [x, y] = [i % 16, i / 16].map(|n| (n as f64 - 7.5).abs());
            let near = (x - 0.5).hypot(y - 0.5);
            let far = (x + 0.5).hypot(y + 0.5);
            let is_nowhere = d.iter().all(|c| c.is_nan());
            if near > 8.0 {
                assert!(is_nowhere, "{light} {x} {y}: {d:?}");
                beyond += 1;
            } else if far < 8.0 {
                let length = d.iter().map(|c| c * c).sum::<f64>().sqrt();
                assert!((length - 1.0).abs() < 0.06, "{light} {x} {y}: {d:?}");
            } else if !is_nowhere {
                // Behind the camera, and none of the forward axis of samples beyond.
                assert!(d[2] > 0.9, "{light} {x} {y}: {d:?}");
                at_edge += 1;
            }
        }
        assert!(beyond > 20 && at_edge > 20, "{beyond} {at_edge}");
    }
}

/// A sensor whose rim turns at 0.75 c hides its pinhole from parts of itself. These lack no data: they are counted apart.
#[test]
fn what_the_sensor_hides_is_counted_apart_from_missing_data() {
    let scene = stage::scene(
        "
[display]
back_faces = \"two_sided\"
[camera]
eye = [0, 1, 3.9]
look_at = [0, 1, 0]
size = [48, 36]
[camera.sensor]
focal_length = \"0.4 m\"
width = \"1 m\"
[camera.rotation]
axis = [0, 1, 0]
rate = \"-1.5 rad/m\"
through = \"sensor\"
elements = \"aberrated\"
[[object]]
shape = { box = { size = [8, 8, 14] } }
",
    );
    let film = stage::rendered(&scene, &stage::sampled()).unwrap();
    let hidden = film.hidden();
    assert!(hidden > 0.02 && hidden < 0.5, "{hidden}");
    assert_eq!((film.mean_coverage(), film.from_data()), (None, 0.0));
    let mean = |aov| {
        let values = film.aov(aov).unwrap();
        values.iter().sum::<f64>() / values.len() as f64
    };
    let occluded = mean(Aov::MissingOccluded);
    assert!((occluded - hidden).abs() < 1e-12, "{occluded} {hidden}");
    assert!((mean(Aov::Coverage) + hidden - 1.0).abs() < 1e-12);
    let wholly = (0..stage::pixels(&film))
        .filter(|i| stage::value(&film, Aov::MissingOccluded, *i) == 1.0)
        .inspect(|i| assert!(stage::value(&film, Aov::DirectionX, *i).is_nan()));
    assert!(wholly.count() > 20);
}

/// 1 where x of the object is above 0; beyond there are no data.
#[derive(Debug)]
struct Half;

impl Radiance for Half {
    fn has_gaps(&self) -> bool {
        true
    }

    fn emit(&self, run: &Run, emitted: &mut Emitted, _: &mut Meter) {
        emitted.start(Response {
            scaled: Scaling::None,
            colour: Colouring::Channels,
        });
        for point in run.points() {
            let event = point.rest_event() - point.patch.object_origin;
            emitted.push(match event.x.x > 0.0 {
                true => Emission::full([1.0; 3]),
                false => Emission {
                    coverage: Coverage::OFF_TEXTURE,
                    ..Emission::full([0.0; 3])
                },
            });
        }
    }
}

/// The second of two objects with one velocity has another origin than their frame.
#[test]
fn a_radiance_of_the_callers_own_counts_what_it_does_not_have() {
    let scene = stage::scene(
        "[camera]\neye = [0, 0, 4]\nlook_at = [0, 0, 0]\nsize = [32, 24]\n\
         [[object]]\nname = 'far'\nshape = { box = { size = [1, 1, 1] } }\norigin = { position = [0, 0, 90] }\n\
         [[object]]\nname = 'near'\nshape = { box = { size = [2, 2, 1] } }\norigin = { position = [0.25, 0, 0] }\n",
    );
    let request = Request {
        aovs: vec![
            Aov::Object,
            Aov::ObjectEventX,
            Aov::Coverage,
            Aov::MissingOffTexture,
        ],
        pixel_centers: true,
        ..Request::default()
    };
    let plan = Plan::new(&scene, &request).unwrap();
    let mut prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    prepared.set_radiance(Box::new(Half));
    let film = render(&prepared, &Silent).unwrap();
    let mut held = [0; 2];
    for i in stage::met(&film) {
        let is_there = stage::value(&film, Aov::ObjectEventX, i) > 0.0;
        let expected = f64::from(u8::from(is_there));
        assert_eq!(film.radiance()[i], [expected; 3]);
        assert_eq!(stage::value(&film, Aov::Coverage, i), expected);
        assert_eq!(
            stage::value(&film, Aov::MissingOffTexture, i),
            1.0 - expected
        );
        held[usize::from(is_there)] += 1;
    }
    assert!(held[0] > 20 && held[1] > 20, "{held:?}");
    let mean = film.mean_coverage().unwrap();
    let expected = f64::from(held[1]) / f64::from(held[0] + held[1]);
    assert!((mean.held - expected).abs() < 1e-12, "{mean:?} {held:?}");
    assert!((mean.off_texture - (1.0 - expected)).abs() < 1e-12);
}

/// Emissions of 1 for so many more or fewer points than there are; without a start if that is `None`.
#[derive(Debug)]
struct Off(Option<i64>);

impl Radiance for Off {
    fn has_gaps(&self) -> bool {
        false
    }

    fn emit(&self, run: &Run, emitted: &mut Emitted, _: &mut Meter) {
        let Some(off) = self.0 else { return };
        emitted.start(Response {
            scaled: Scaling::None,
            colour: Colouring::Channels,
        });
        for _ in 0..run.points().count() as i64 + off {
            emitted.push(Emission::full([1.0; 3]));
        }
    }
}

#[test]
fn a_radiance_of_the_callers_own_gives_one_emission_for_each_point_or_is_an_error() {
    let scene = stage::scene(
        "[camera]\neye = [0, 0, 4]\nlook_at = [0, 0, 0]\nsize = [32, 24]\n\
         [[object]]\nname = 'a'\nshape = { box = { size = [2, 2, 1] } }\n",
    );
    let plan = Plan::new(&scene, &Request::default()).unwrap();
    let rendered = |off| {
        let mut prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
        prepared.set_radiance(Box::new(Off(off)));
        render(&prepared, &Silent)
    };
    assert!(rendered(Some(0)).is_ok());
    for (off, said) in [
        (Some(-1), "emissions for a run of"),
        (Some(3), "emissions for a run of"),
        (None, "did not call Emitted::start"),
    ] {
        let error = rendered(off).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
        assert!(
            error.help().contains("Emitted::push once for each"),
            "{}",
            error.help()
        );
    }
}
