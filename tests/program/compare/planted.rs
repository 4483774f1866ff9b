//! Errors planted one at a time are found and named; a clean pair has none.

use nullray::io::image::{Channel, Layers, Samples};
use nullray::render::aov::{self, Aov};
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::{self, Overrides};
use nullray::validate::compare::{CompareOptions, Comparison, Diagnosis, Kind, Picture, compare};

const BETA: f64 = 0.5;

/// Two bodies of the given velocities along x over a floor, passed by a camera; twice as many pixels as pictures have.
fn text(camera: f64, [left, right]: [f64; 2]) -> String {
    format!(
        r#"
        camera = {{ eye = [0, 0.6, 4], look_at = [1.5, 0.3, 0], hfov = "60 deg", size = [160, 120], velocity = {{ beta = [{camera}, 0, 0] }} }}
        [[object]]
        name = "floor"
        shape = {{ plane = {{ size = [12, 12] }} }}
        colour = [0.2, 0.5, 0.8]
        [[object]]
        name = "left"
        shape = {{ box = {{ size = [1.2, 1.2, 1.2] }} }}
        velocity = {{ beta = [{left}, 0, 0] }}
        origin = {{ position = [-1, 0.6, 0], time = "-4 m" }}
        [[object]]
        name = "right"
        shape = {{ box = {{ size = [1.2, 1.2, 1.2] }} }}
        velocity = {{ beta = [{right}, 0, 0] }}
        origin = {{ position = [1, 0.6, 0], time = "-4 m" }}
        "#
    )
}

fn film(text: &str) -> Film {
    let scene = scene::parse(text, "test scene", ".".as_ref(), &Overrides::default()).unwrap();
    let request = Request {
        aovs: aov::parse("all").unwrap(),
        pixel_centers: true,
        ..Request::default()
    };
    let plan = Plan::new(&scene, &request).unwrap();
    render(&Prepared::new(&scene, &plan, &Silent).unwrap(), &Silent).unwrap()
}

/// Every second pixel of every second row, half a pixel (of these) to the right where `late` says so.
fn picture(film: &Film, late: impl Fn(usize) -> bool) -> Picture {
    let aovs = aov::parse("all").unwrap();
    let [width, height] = film.size().map(|n| n as usize / 2);
    let place = |i: usize| (2 * (i / width)) * 2 * width + 2 * (i % width);
    let pick = |channel: Channel| Channel {
        samples: Samples::F64({
            let all = channel.samples.to_f64();
            (0..width * height)
                .map(|i| all[place(i) + usize::from(late(place(i)))])
                .collect()
        }),
        ..channel
    };
    let channels = film
        .channels(&aovs)
        .into_iter()
        .filter(|c| c.name != "standard_error");
    // A camera with β = 0.5 along x.
    let rapidity = (
        "camera_rapidity".to_string(),
        format!("{} 0 0", BETA.atanh()),
    );
    let layers = Layers::new(
        width as u32,
        height as u32,
        channels.map(pick).collect(),
        vec![rapidity],
    );
    Picture::linear("planted", layers.unwrap())
}

fn exact() -> Picture {
    picture(&film(&text(BETA, [0.3, -0.2])), |_| false)
}

fn compared(reference: &Picture, candidate: &Picture) -> Comparison {
    let options = CompareOptions {
        bin_width: Some(0.05),
        ..CompareOptions::default()
    };
    compare(reference, candidate, &options).unwrap()
}

fn diagnosed(reference: &Picture, candidate: &Picture) -> Vec<Diagnosis> {
    compared(reference, candidate).diagnoses
}

/// The only diagnosis, of this kind.
fn the(kind: Kind, diagnoses: Vec<Diagnosis>) -> Diagnosis {
    assert_eq!(
        diagnoses.iter().map(|d| d.kind).collect::<Vec<_>>(),
        [kind],
        "{diagnoses:?}"
    );
    diagnoses.into_iter().next().unwrap()
}

fn values<'a>(picture: &'a mut Picture, name: &str) -> &'a mut Vec<f64> {
    let channel = picture
        .layers
        .channels
        .iter_mut()
        .find(|c| c.name == name)
        .unwrap();
    match &mut channel.samples {
        Samples::F64(values) => values,
        _ => unreachable!("planted pictures hold f64"),
    }
}

#[test]
fn a_clean_pair_has_no_diagnosis() {
    let exact = exact();
    assert_eq!(diagnosed(&exact, &exact), []);
}

#[test]
fn noise_has_no_diagnosis() {
    let exact = exact();
    let mut noisy = exact.clone();
    for name in [
        "radiance.R",
        "radiance.G",
        "radiance.B",
        "event.ct",
        "object_event.x",
    ] {
        for (i, value) in values(&mut noisy, name).iter_mut().enumerate() {
            *value *= 1.0 + 0.01 * (((i * 7919) % 101) as f64 / 50.0 - 1.0);
        }
    }
    assert_eq!(diagnosed(&exact, &noisy), []);
}

#[test]
fn a_triangle_moved_by_half_a_pixel_is_named() {
    let film = film(&text(BETA, [0.3, -0.2]));
    let [objects, triangles] =
        [Aov::Object, Aov::Primitive].map(|aov| film.aov(aov).unwrap().to_vec());
    let at = |i: usize| (objects[i] as i64, triangles[i] as i64);
    // The triangle of the right-hand box that the most pixels show.
    let pixels = |t: i64| (0..objects.len()).filter(|i| at(*i) == (2, t)).count();
    let most = (0..12).max_by_key(|t| pixels(*t)).unwrap();
    let reference = picture(&film, |_| false);
    let candidate = picture(&film, |i| at(i) == (2, most) && at(i + 1) == (2, most));
    let found = the(Kind::TriangleDisplaced, diagnosed(&reference, &candidate));
    assert!(
        found.what.contains(&format!("triangle {most} of object 2")),
        "{}",
        found.what
    );
    assert!(
        found.what.contains("by 0.50 pixels, (-0.50, "),
        "{}",
        found.what
    );
}

#[test]
fn times_off_by_one_bin_are_named() {
    let exact = exact();
    let mut late = exact.clone();
    values(&mut late, "event.ct")
        .iter_mut()
        .for_each(|t| *t += 0.05);
    let found = the(Kind::TimeShifted, diagnosed(&exact, &late));
    assert!(found.what.contains("late by one bin"), "{}", found.what);
}

#[test]
fn a_wrong_exponent_of_w_is_named() {
    let exact = exact();
    for exponent in [1i32, -1, 2] {
        let mut wrong = exact.clone();
        let ratios = values(&mut wrong, "wavelength_ratio").clone();
        for name in ["radiance.R", "radiance.G", "radiance.B"] {
            for (value, w) in values(&mut wrong, name).iter_mut().zip(&ratios) {
                *value *= if w.is_nan() { 1.0 } else { w.powi(exponent) };
            }
        }
        let found = the(Kind::ExponentWrong, diagnosed(&exact, &wrong));
        assert!(
            found.what.contains(&format!("W^({exponent:+})")),
            "{}",
            found.what
        );
    }
}

#[test]
fn reversed_aberration_is_named() {
    let reversed = picture(&film(&text(-BETA, [0.3, -0.2])), |_| false);
    let found = the(Kind::AberrationReversed, diagnosed(&exact(), &reversed));
    assert!(found.what.contains("−β for β"), "{}", found.what);
}

#[test]
fn missing_aberration_is_named() {
    let still = picture(&film(&text(0.0, [0.3, -0.2])), |_| false);
    the(Kind::AberrationMissing, diagnosed(&exact(), &still));
}

#[test]
fn swapped_velocities_are_named() {
    let swapped = picture(&film(&text(BETA, [-0.2, 0.3])), |_| false);
    let found = the(Kind::VelocitiesSwapped, diagnosed(&exact(), &swapped));
    assert!(found.what.contains("objects 1 and 2"), "{}", found.what);
}

#[test]
fn a_wrong_velocity_is_named() {
    let wrong = picture(&film(&text(BETA, [0.3, 0.1])), |_| false);
    let found = the(Kind::VelocityWrong, diagnosed(&exact(), &wrong));
    assert!(found.what.contains("object 2"), "{}", found.what);
}

#[test]
fn an_object_that_is_displaced_is_named() {
    let film = film(&text(BETA, [0.3, -0.2]));
    let objects = film.aov(Aov::Object).unwrap().to_vec();
    let reference = picture(&film, |_| false);
    let candidate = picture(&film, |i| objects[i] == 1.0 && objects[i + 1] == 1.0);
    let found = the(Kind::ObjectDisplaced, diagnosed(&reference, &candidate));
    assert!(
        found.what.contains("object 1 is displaced by 0.50"),
        "{}",
        found.what
    );
}
