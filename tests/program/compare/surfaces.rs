//! Errors in pixels, metres and ulp, for known surfaces.

use nullray::io::image::{Layers, Samples};
use nullray::validate::compare::surface::{Distribution, Summary};
use nullray::validate::compare::{CompareOptions, Picture, SurfaceErrors, compare};

use crate::compare::pictures::{field, layers};

const SIZE: u32 = 64;

/// A sphere of radius 1 at distance 4 seen through a camera shifted by `[dx, dy]` pixels: its object's points, NaN and
/// object −1 beside it.
fn sphere(shift: [f64; 2]) -> Layers {
    let ray = |x: f64, y: f64| {
        let scale = 0.7 / f64::from(SIZE);
        let half = f64::from(SIZE) / 2.0;
        let d = [
            (x + 0.5 + shift[0] - half) * scale,
            (half - y - 0.5 - shift[1]) * scale,
            -1.0,
        ];
        let length = (d[0] * d[0] + d[1] * d[1] + 1.0).sqrt();
        let d = d.map(|c| c / length);
        let b = -4.0 * d[2];
        let under = b * b - 15.0;
        let t = b - under.sqrt();
        (under > 0.0).then(|| [t * d[0], t * d[1], t * d[2] + 4.0])
    };
    let part = |k: usize| field(SIZE, SIZE, |x, y| ray(x, y).map_or(f64::NAN, |p| p[k]));
    let object = field(
        SIZE,
        SIZE,
        |x, y| if ray(x, y).is_some() { 0.0 } else { -1.0 },
    );
    layers(
        SIZE,
        SIZE,
        &[
            ("object", object),
            ("object_event.x", part(0)),
            ("object_event.y", part(1)),
            ("object_event.z", part(2)),
        ],
    )
}

/// The summary of a distribution that has values.
fn of(distribution: &Option<Distribution>) -> Summary {
    distribution.as_ref().unwrap().summary.unwrap()
}

fn surface(r: Layers, c: Layers) -> SurfaceErrors {
    let [r, c] = [r, c].map(|layers| Picture::linear("surfaces", layers));
    compare(&r, &c, &CompareOptions::default())
        .unwrap()
        .surface
        .unwrap()
}

#[test]
fn a_shift_below_a_pixel_is_measured() {
    for (shift, tolerance) in [
        ([0.3, 0.0], 0.01),
        ([0.0, -0.5], 0.02),
        ([0.01, 0.02], 1e-3),
    ] {
        let found = of(&surface(sphere([0.0, 0.0]), sphere(shift)).geometric);
        let exact = f64::hypot(shift[0], shift[1]);
        assert!(
            (found.p50 - exact).abs() < tolerance * exact,
            "{} for {exact}",
            found.p50
        );
        assert!(
            (found.p90 - exact).abs() < 0.1 * exact,
            "{} for {exact}",
            found.p90
        );
    }
}

#[test]
fn a_shift_of_several_pixels_is_measured() {
    let found = of(&surface(sphere([0.0, 0.0]), sphere([5.2, -2.5])).geometric);
    let exact = f64::hypot(5.2, 2.5);
    assert!(
        (found.p50 - exact).abs() < 0.02 * exact,
        "{} for {exact}",
        found.p50
    );
}

#[test]
fn a_crease_does_not_pollute_the_error() {
    // Two planes that meet in a vertical edge between pixels, and a candidate shifted by 0.25 pixels.
    let roof = |shift: f64| {
        let x = field(SIZE, SIZE, |x, _| x + shift - 31.5);
        let y = field(SIZE, SIZE, |_, y| y);
        let z = x.iter().map(|x| -3.0 * x.abs()).collect();
        let object = vec![0.0; (SIZE * SIZE) as usize];
        let side = x.iter().map(|x| f64::from(*x > 0.0)).collect();
        layers(
            SIZE,
            SIZE,
            &[
                ("object", object),
                ("primitive", side),
                ("object_event.x", x),
                ("object_event.y", y),
                ("object_event.z", z),
            ],
        )
    };
    let found = of(&surface(roof(0.0), roof(0.25)).geometric);
    assert!(
        (found.mean - 0.25).abs() < 1e-6 && (found.max - 0.25).abs() < 1e-6,
        "{found:?}"
    );
}

#[test]
fn places_on_another_object_are_not_taken_for_those_of_a_surface() {
    // A sphere of triangles smaller than pixels before a plane, whose own coordinates pass through the sphere's edge.
    let plane = [
        field(SIZE, SIZE, |x, _| 0.4 * (x - 60.0)),
        field(SIZE, SIZE, |_, y| 0.4 * (32.0 - y)),
        vec![0.25; (SIZE * SIZE) as usize],
    ];
    let triangle = field(SIZE, SIZE, |x, y| x + f64::from(SIZE) * y);
    let scene = |shift: f64| {
        let sphere = sphere([shift, 0.0]);
        let of_sphere = |channel: usize| match &sphere.channels[channel].samples {
            Samples::F64(values) => values.clone(),
            other => panic!("{other:?}"),
        };
        let object = of_sphere(0);
        let place = |axis: usize| {
            let values = of_sphere(1 + axis).into_iter().zip(&plane[axis]);
            let values = values.zip(&object);
            let either = values.map(|((sphere, plane), o)| if *o < 0.0 { *plane } else { sphere });
            either.collect::<Vec<_>>()
        };
        layers(
            SIZE,
            SIZE,
            &[
                ("object", object.iter().map(|o| o + 1.0).collect()),
                ("object_event.x", place(0)),
                ("object_event.y", place(1)),
                ("object_event.z", place(2)),
                ("primitive", triangle.clone()),
            ],
        )
    };
    let found = of(&surface(scene(0.0), scene(0.01)).geometric);
    assert!(found.max < 0.1, "{found:?}");
}

#[test]
fn a_silhouette_that_moves_is_measured_by_the_area_it_sweeps() {
    for radius in [20.3, 20.8, 21.5] {
        let disc = |radius: f64| {
            let inside = move |x: f64, y: f64| f64::hypot(x - 31.4, y - 31.7) < radius;
            layers(
                SIZE,
                SIZE,
                &[(
                    "object",
                    field(SIZE, SIZE, |x, y| if inside(x, y) { 0.0 } else { -1.0 }),
                )],
            )
        };
        let found = surface(disc(20.0), disc(radius));
        let silhouette = found.silhouette.unwrap();
        let exact = radius - 20.0;
        assert!(
            (silhouette.mean - exact).abs() < 0.12 * exact.max(0.5),
            "{silhouette:?} for {exact}"
        );
        let perimeter = 40.0 * std::f64::consts::PI;
        assert!(
            (silhouette.length - perimeter).abs() < 0.03 * perimeter,
            "{silhouette:?}"
        );
        let largest = silhouette.largest.unwrap();
        assert!((1.0..=2.9).contains(&largest), "{silhouette:?}");
    }
}

#[test]
fn wrong_objects_are_counted() {
    let ids = |edge: f64| {
        layers(
            8,
            8,
            &[("object", field(8, 8, |x, _| f64::from(x >= edge)))],
        )
    };
    let wrong = surface(ids(3.0), ids(5.0)).wrong_objects.unwrap();
    assert_eq!((wrong.pixels, wrong.of), (16, 64));
}

#[test]
fn emission_times_and_wavelength_ratios_have_their_errors() {
    let with = |time: f64, ratio: f64| {
        let n = 16;
        layers(
            4,
            4,
            &[
                ("object", vec![0.0; n]),
                ("event.ct", vec![time; n]),
                ("wavelength_ratio", vec![ratio; n]),
            ],
        )
    };
    let next = f64::from_bits(0.5f64.to_bits() + 3);
    let found = surface(with(-2.0, 0.5), with(-2.25, next));
    assert_eq!(found.emission_time.unwrap().bias, Some(-0.25));
    assert_eq!(of(&found.wavelength_ratio_ulp).max, 3.0);
    let percent = surface(with(0.0, 0.5), with(0.0, 0.51))
        .wavelength_ratio
        .unwrap();
    assert!((percent.bias.unwrap() - 0.02).abs() < 1e-12);
}

#[test]
fn where_one_picture_has_no_hit_the_object_is_wrong_and_there_is_no_geometric_error() {
    let r = sphere([0.0, 0.0]);
    let mut c = r.clone();
    for channel in &mut c.channels {
        if let nullray::io::image::Samples::F64(values) = &mut channel.samples {
            let middle = (SIZE * SIZE / 2 + SIZE / 2) as usize;
            values[middle] = if channel.name == "object" {
                -1.0
            } else {
                f64::NAN
            };
        }
    }
    let found = surface(r, c);
    assert_eq!(found.wrong_objects.unwrap().pixels, 1);
    assert_eq!(of(&found.geometric).max, 0.0);
    assert_eq!(found.geometric.unwrap().unmeasured, 0);
}

#[test]
fn an_empty_distribution_is_none_and_not_0() {
    // Every pixel shows another object: there is no error of places, and none is claimed.
    let all = |object: f64| {
        let n = 16;
        let names = [
            "object_event.x",
            "object_event.y",
            "object_event.z",
            "event.ct",
        ];
        let places = names.map(|name| (name, vec![0.5; n]));
        let object = [("object", vec![object; n])];
        layers(4, 4, &object.into_iter().chain(places).collect::<Vec<_>>())
    };
    let found = surface(all(0.0), all(1.0));
    assert_eq!(found.wrong_objects.unwrap().pixels, 16);
    assert_eq!(found.coverage.unwrap().fraction(), Some(0.0));
    let geometric = found.geometric.unwrap();
    assert_eq!((geometric.count, geometric.summary), (0, None));
    assert_eq!(found.emission_time.unwrap().bias, None);
}
