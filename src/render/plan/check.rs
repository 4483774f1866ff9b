//! Numbers of a scene that no scene file can contain: a program that changes a [`Scene`] may set them.

use glam::DVec3;

use crate::error::{Error, Result, number};
use crate::io::cube::Cube;
use crate::mesh::shapes::Shape;
use crate::mesh::{Material, Mesh, MeshError};
use crate::scene::limits::{self, Wrong};
use crate::scene::model::{
    Beam, Binding, Brightness, Catalogue, CubeData, EmissionProfile, Geometry, Lamp, Light,
    LightKind, Mapping, Motion, Object, Scene, Sky, SkyRadiance, Source, SourceKind,
};

/// What a number, a vector or a choice may be.
enum Must<'a> {
    Finite(&'a [f64]),
    AtLeast0(&'a [f64]),
    Above0(&'a [f64]),
    Unit(DVec3),
    /// Right, up and forward.
    Axes([DVec3; 3]),
    /// A condition in words.
    Is(bool, &'static str),
}

use Must::{Above0, AtLeast0, Axes, Finite, Is, Unit};

/// How far products of vectors may be from those of unit vectors at right angles: a little more than those of poses in files.
const ROUNDING: f64 = 2e-3;

impl Must<'_> {
    fn check(&self) -> Result<(), Wrong> {
        // False for NaN.
        let all = |numbers: &[f64], is_fine: fn(f64) -> bool, help: &str| match numbers
            .iter()
            .find(|x| !(x.is_finite() && is_fine(**x)))
        {
            Some(x) => Err((format!("it is {}", number(*x)), help.into())),
            None => Ok(()),
        };
        let are_units = |a: DVec3, b: DVec3, product: f64| (a.dot(b) - product).abs() <= ROUNDING;
        let hold = |holds, help: &str| match holds {
            true => Ok(()),
            false => Err(("it is out of range".into(), help.into())),
        };
        match *self {
            Finite(numbers) => all(numbers, |_| true, "a finite number"),
            AtLeast0(numbers) => all(numbers, |x| x >= 0.0, "a finite number of at least 0"),
            Above0(numbers) => all(numbers, |x| x > 0.0, "a finite number above 0"),
            Unit(v) => hold(are_units(v, v, 1.0), "a vector of length 1"),
            Axes([a, b, c]) => hold(
                [a, b, c].iter().all(|v| are_units(*v, *v, 1.0))
                    && [(a, b), (b, c), (c, a)]
                        .iter()
                        .all(|(v, w)| are_units(*v, *w, 0.0)),
                "three vectors of length 1 at right angles",
            ),
            Is(holds, words) => hold(holds, words),
        }
    }
}

/// Refuses the first row that does not hold, at `of` with its name.
fn check_rows(scene: &Scene, of: &str, rows: &[(&str, Must)]) -> Result<()> {
    rows.iter().try_for_each(|(name, must)| {
        must.check()
            .map_err(|(what, help)| Error::invalid(&scene.name, format!("{of}{name}"), what, help))
    })
}

/// Refuses sizes, counts, indices, numbers and materials with which nothing can be rendered.
pub(super) fn check(scene: &Scene) -> Result<()> {
    check_camera(scene)?;
    let refuse =
        |place: &str, (what, help): Wrong| Err(Error::invalid(&scene.name, place, what, help));
    let checks = [
        (
            "samples_per_pixel",
            limits::samples_per_pixel(scene.samples_per_pixel),
        ),
        ("bounces", limits::bounces(scene.bounces)),
        ("spectra", limits::spectra(scene)),
        ("medium_index", limits::medium_index(scene.medium_index)),
    ];
    for (place, check) in checks {
        if let Err(wrong) = check {
            return refuse(place, wrong);
        }
    }
    let rows = [
        ("speed_of_light", Above0(&[scene.speed_of_light])),
        ("background", Finite(&scene.background)),
        (
            "bits",
            Is(matches!(scene.bits, 8 | 16), "8 or 16 bits per sample"),
        ),
    ];
    check_rows(scene, "", &rows)?;
    scene
        .objects
        .iter()
        .try_for_each(|one| object(scene, one))?;
    scene
        .sources
        .iter()
        .try_for_each(|one| source(scene, one))?;
    scene.lights.iter().try_for_each(|one| light(scene, one))?;
    scene.sky.iter().try_for_each(|one| sky(scene, one))
}

/// The same of the camera.
pub(crate) fn check_camera(scene: &Scene) -> Result<()> {
    let camera = &scene.camera;
    let (fov, projection) = (camera.horizontal_fov, camera.projection);
    if let Err((what, help)) = limits::image_size(camera.size) {
        return Err(Error::invalid(&scene.name, "camera.size", what, help));
    }
    if !limits::is_field_of_view(fov, projection) {
        let what = format!("a field of view of {fov} rad");
        let help = format!("above 0, and at most {} degrees", projection.widest());
        return Err(Error::invalid(
            &scene.name,
            "camera.horizontal_fov",
            what,
            help,
        ));
    }
    let rows = [
        ("time", Finite(&[camera.time])),
        ("origin", Finite(&camera.origin.to_array())),
        ("axes", Axes(camera.axes)),
        ("frame_interval", Above0(camera.frame_interval.as_slice())),
    ];
    check_rows(scene, "camera.", &rows)?;
    if let Some(rotation) = camera.rotation {
        let rows = [
            ("axis", Unit(rotation.axis)),
            ("rate", Finite(&[rotation.rate])),
        ];
        check_rows(scene, "camera.rotation.", &rows)?;
    }
    let [sensor, pupils, shutter] = [
        camera.sensor.map(|sensor| sensor.focal_length),
        camera.stereo.map(|stereo| stereo.interpupillary_distance),
        camera.shutter.map(|shutter| shutter.duration),
    ];
    let rows = [
        ("sensor.focal_length", Above0(sensor.as_slice())),
        (
            "stereo.interpupillary_distance",
            AtLeast0(pupils.as_slice()),
        ),
        ("shutter.duration", Above0(shutter.as_slice())),
    ];
    check_rows(scene, "camera.", &rows)
}

/// The same of a source.
fn source(scene: &Scene, source: &Source) -> Result<()> {
    let of = format!("source \"{}\", ", source.name);
    if let Binding::Only { objects, .. } = &source.binding {
        let is_there = objects.iter().all(|object| *object < scene.objects.len());
        let words = "indices of the objects of the scene";
        check_rows(scene, &of, &[("objects", Is(is_there, words))])?;
    }
    match &source.kind {
        SourceKind::Pulse(pulse) => {
            let rows = [
                ("origin", Finite(&pulse.origin.to_array())),
                ("sigma", Above0(&[pulse.sigma])),
                ("intensity", AtLeast0(&pulse.intensity)),
            ];
            check_rows(scene, &of, &rows)
        }
        SourceKind::Cube(cube) => {
            if let CubeData::Memory(samples) = &cube.data
                && let Err(error) = samples.check()
            {
                let place = of + &error.field();
                let what = error.to_string();
                return Err(Error::invalid(&scene.name, place, what, Cube::CHECKED));
            }
            let Mapping::Capture(camera) = &cube.mapping else {
                return Ok(());
            };
            let sees = limits::is_field_of_view(camera.fov, camera.projection);
            let rows = [
                ("capture.eye", Finite(&camera.eye.to_array())),
                ("capture.axes", Axes(camera.axes)),
                (
                    "capture.fov",
                    Is(sees, "radians, within the range of its projection"),
                ),
                ("capture.near_clip", AtLeast0(&[camera.near_clip])),
            ];
            check_rows(scene, &of, &rows)
        }
    }
}

/// The same of a light.
fn light(scene: &Scene, light: &Light) -> Result<()> {
    let of = format!("light \"{}\", ", light.name);
    let emission = match &light.kind {
        LightKind::Lamp(lamp) => {
            self::lamp(scene, &of, lamp)?;
            &lamp.emission
        }
        LightKind::Area {
            object,
            brightness,
            emission,
        } => {
            let brightness = match brightness {
                Brightness::Radiance(rgb) | Brightness::Power(rgb) => &rgb[..],
                Brightness::Materials => &[],
            };
            let is_there = *object < scene.objects.len();
            let rows = [
                (
                    "object",
                    Is(is_there, "the index of an object of the scene"),
                ),
                ("brightness", AtLeast0(brightness)),
            ];
            check_rows(scene, &of, &rows)?;
            emission
        }
    };
    if let Err((what, help)) = limits::emission(emission) {
        return Err(Error::invalid(&scene.name, of + "emission", what, help));
    }
    let words = "finite times, sigma above 0, a period of at least sigma; ascending times, and factors of at least 0";
    let is_fine = match emission {
        EmissionProfile::Steady => true,
        EmissionProfile::Gaussian { centre, sigma } => centre.is_finite() && is_length(*sigma),
        EmissionProfile::Train {
            centre,
            sigma,
            period,
            ..
        } => centre.is_finite() && is_length(*sigma) && period.is_finite() && period >= sigma,
        EmissionProfile::Table(knots) => {
            let is_lit =
                |[time, factor]: &[f64; 2]| time.is_finite() && (0.0..=f64::MAX).contains(factor);
            knots.iter().all(is_lit) && knots.is_sorted_by(|a, b| a[0] < b[0])
        }
    };
    check_rows(scene, &of, &[("emission", Is(is_fine, words))])
}

fn lamp(scene: &Scene, of: &str, lamp: &Lamp) -> Result<()> {
    let beam = match lamp.beam {
        Beam::Point => Is(true, ""),
        Beam::Parallel(direction) => Unit(direction),
        Beam::Spot { axis, .. } => Unit(axis),
    };
    let is_cone = match lamp.beam {
        Beam::Point => true,
        // Parallel light fills one frame.
        Beam::Parallel(_) => lamp.motion == Motion::Inertial,
        Beam::Spot { inner, outer, .. } => 0.0 <= inner && inner < outer && outer < 1.6,
    };
    let words = "a cone with 0 ≤ inner < outer ≤ π/2; parallel light without acceleration";
    let rows = [
        ("origin", Finite(&lamp.origin.to_array())),
        ("intensity", AtLeast0(&lamp.intensity)),
        ("beam", beam),
        ("beam", Is(is_cone, words)),
    ];
    check_rows(scene, of, &rows)?;
    match lamp.world_line() {
        Ok(_) => Ok(()),
        Err(error) => {
            let help = "give a motion slower than light";
            let place = format!("{of}motion");
            Err(Error::invalid(&scene.name, place, error.to_string(), help))
        }
    }
}

/// The same of the sky.
fn sky(scene: &Scene, sky: &Sky) -> Result<()> {
    let background = match &sky.background {
        SkyRadiance::Uniform(rgb) | SkyRadiance::Image { scale: rgb, .. } => rgb.to_vec(),
        SkyRadiance::Gradient {
            zenith,
            horizon,
            ground,
        } => [*zenith, *horizon, *ground].concat(),
        SkyRadiance::Spectrum(_) => Vec::new(),
    };
    check_rows(scene, "sky.", &[("background", AtLeast0(&background))])?;
    let disc = |radius: f64| {
        Is(
            radius > 0.0 && radius < 0.8,
            "an angle above 0, up to 45 degrees",
        )
    };
    if let Some(sun) = &sky.sun {
        let rows = [
            ("direction", Unit(sun.direction)),
            ("irradiance", AtLeast0(&sun.irradiance)),
            ("radius", disc(sun.radius)),
        ];
        check_rows(scene, "sky.sun.", &rows)?;
    }
    let Some(stars) = &sky.stars else {
        return Ok(());
    };
    let (count, faintest) = match stars.catalogue {
        Catalogue::File(_) => (0, 0.0),
        Catalogue::Random {
            count, faintest, ..
        } => (count, faintest),
    };
    let rows = [
        ("scale", Above0(&[stars.scale])),
        ("radius", disc(stars.radius)),
        (
            "count",
            Is(count <= limits::MOST_STARS, "at most 1000000 stars"),
        ),
        (
            "faintest",
            Is(faintest.abs() <= 30.0, "a magnitude from -30 to 30"),
        ),
    ];
    check_rows(scene, "sky.stars.", &rows)
}

/// The same of an object.
fn object(scene: &Scene, object: &Object) -> Result<()> {
    let name = &object.name;
    let transform = object.transform;
    let inverts = limits::is_invertible(transform) && transform.is_finite();
    let rows = [
        ("transform", Is(inverts, "a transform with an inverse")),
        ("origin", Finite(&object.origin.to_array())),
    ];
    check_rows(scene, &format!("object \"{name}\", "), &rows)?;
    let refuse =
        |place: String, (what, help): Wrong| Err(Error::invalid(&scene.name, place, what, help));
    match &object.geometry {
        Geometry::Mesh(mesh) => match mesh.check() {
            Err(MeshError { field, what, .. }) => refuse(
                format!("object \"{name}\", {field}"),
                (what, Mesh::CHECKED.into()),
            ),
            Ok(()) => Ok(()),
        },
        Geometry::Shape {
            shape: of,
            colour,
            metallic,
            roughness,
            transmission,
            ior,
        } => {
            let material = Material {
                metallic: *metallic,
                roughness: *roughness,
                transmission: *transmission,
                ior: *ior,
                ..Material::matte(*colour)
            };
            if let Err(MeshError { field, what, .. }) = material.check() {
                // Here the base colour is called by its name.
                let field = field.trim_start_matches("base_");
                return refuse(
                    format!("object \"{name}\", {field}"),
                    (what, Mesh::CHECKED.into()),
                );
            }
            let Err((field, wrong)) = shape(of) else {
                return Ok(());
            };
            refuse(format!("object \"{name}\", {field}"), wrong)
        }
        Geometry::Gltf { .. } => Ok(()),
    }
}

/// The invalid field of a shape, and what is wrong with it.
fn shape(shape: &Shape) -> Result<(), (&'static str, Wrong)> {
    let positive = |field, lengths: &[f64]| match lengths.iter().find(|x| !is_length(**x)) {
        Some(bad) => {
            let what = format!("{} m is not above 0", number(*bad));
            Err((field, (what, "give a length in metres, like 1".into())))
        }
        None => Ok(()),
    };
    match shape {
        Shape::Box { size } => positive("size", size),
        Shape::Plane { size } => positive("size", size),
        Shape::Sphere {
            radius,
            subdivisions,
        } => {
            positive("radius", &[*radius])?;
            limits::subdivisions(*subdivisions).map_err(|wrong| ("subdivisions", wrong))
        }
        Shape::Lattice {
            cells,
            spacing,
            bar,
        } => {
            positive("spacing", &[*spacing])?;
            positive("bar", &[*bar])?;
            limits::cells(*cells).map_err(|wrong| ("cells", wrong))
        }
    }
}

/// Whether it is a length, or a duration; false for NaN.
fn is_length(length: f64) -> bool {
    length > 0.0 && length.is_finite()
}
