//! The number that each scene of `scenes/gallery` states to its readers, from closed forms that share no code with the renderer.

use std::path::Path;

use glam::DVec3;
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::model::Scene;
use nullray::scene::{Overrides, SceneFile};

/// A panel, or the scene itself (""), as a small picture of rays through pixel centres, with the channels that are looked at.
struct Shot {
    scene: Scene,
    film: Film,
}

impl Shot {
    fn of(file: &str, panel: &str, size: [u32; 2], set: &[(&str, &str)]) -> Shot {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("scenes/gallery")
            .join(file);
        let set = set
            .iter()
            .map(|(key, value)| (key.to_string(), value.to_string()));
        let overrides = Overrides {
            size: Some(size),
            set: set.collect(),
            ..Overrides::default()
        };
        let file = SceneFile::read(&path).unwrap();
        let whole = file.scene(&overrides).unwrap_or_else(|e| panic!("{e}"));
        let scene = match whole.panels.iter().find(|p| p.name == panel) {
            Some(named) => {
                let scene = file.panel(&whole, named, &overrides);
                scene.unwrap_or_else(|e| panic!("{e}"))
            }
            // The scene itself has no name.
            None => {
                assert_eq!(panel, "");
                whole.clone()
            }
        };
        let request = Request {
            aovs: vec![
                Aov::Object,
                Aov::EventCt,
                Aov::EventX,
                Aov::EventY,
                Aov::EventZ,
                Aov::ObjectEventCt,
                Aov::ObjectEventX,
                Aov::ObjectEventY,
                Aov::ObjectEventZ,
                Aov::DirectionZ,
                Aov::WavelengthRatio,
            ],
            pixel_centers: true,
            ..Request::default()
        };
        let plan = Plan::new(&scene, &request).unwrap();
        let film = render(&Prepared::new(&scene, &plan, &Silent).unwrap(), &Silent).unwrap();
        Shot { scene, film }
    }

    fn pixels(&self) -> std::ops::Range<usize> {
        let [width, height] = self.film.size();
        0..(width * height) as usize
    }

    fn aov(&self, aov: Aov, pixel: usize) -> f64 {
        self.film.aov(aov).unwrap()[pixel]
    }

    fn object(&self, name: &str) -> f64 {
        let mut objects = self.scene.objects.iter();
        objects.position(|object| object.name == name).unwrap() as f64
    }

    fn shows(&self, name: &str) -> impl Iterator<Item = usize> {
        let object = self.object(name);
        self.pixels()
            .filter(move |&pixel| self.aov(Aov::Object, pixel) == object)
    }

    fn event(&self, pixel: usize) -> DVec3 {
        let [x, y, z] = [Aov::EventX, Aov::EventY, Aov::EventZ].map(|aov| self.aov(aov, pixel));
        DVec3::new(x, y, z)
    }

    /// The look direction of a pixel of a pinhole camera that looks along `forward`, whose width is `hfov` degrees.
    fn direction(&self, pixel: usize, forward: DVec3, hfov: f64) -> DVec3 {
        let [width, height] = self.film.size().map(f64::from);
        let (column, row) = (pixel % width as usize, pixel / width as usize);
        let forward = forward.normalize();
        let right = forward.cross(DVec3::Y).normalize();
        let scale = 2.0 * (hfov.to_radians() / 2.0).tan() / width;
        let x = (column as f64 + 0.5 - width / 2.0) * scale;
        let y = (height / 2.0 - row as f64 - 0.5) * scale;
        (forward + x * right + y * right.cross(forward)).normalize()
    }
}

/// Of a camera that flies along −z: what is at θ from ahead at rest is at θ′ with tan(θ′/2) = k tan(θ/2), k = √((1 − β)/(1 + β)),
/// and its light has 1/(γ (1 + β cos θ)) of its wavelength, θ that of the world.
fn check_aberration(shot: &Shot, eye: DVec3, forward: DVec3, hfov: f64, gamma: f64) {
    let beta = (1.0 - gamma.powi(-2)).sqrt();
    let k = ((1.0 - beta) / (1.0 + beta)).sqrt();
    let mut seen = 0;
    for pixel in shot.pixels().filter(|&p| shot.aov(Aov::Object, p) >= 0.0) {
        let cos = (shot.event(pixel) - eye).normalize().dot(-DVec3::Z);
        let moved = 2.0 * (k * (cos.clamp(-1.0, 1.0).acos() / 2.0).tan()).atan();
        let angle = shot.direction(pixel, forward, hfov).dot(-DVec3::Z).acos();
        assert!(
            (angle - moved).abs() < 1e-6,
            "pixel {pixel}: {angle} {moved}"
        );
        let ratio = 1.0 / (gamma * (1.0 + beta * cos));
        let found = shot.aov(Aov::WavelengthRatio, pixel);
        assert!(
            (found / ratio - 1.0).abs() < 1e-6,
            "pixel {pixel}: {found} {ratio}"
        );
        seen += 1;
    }
    assert!(seen > 1000, "{seen}");
}

/// Smallest wavelength ratio in the picture.
fn bluest(shot: &Shot) -> f64 {
    shot.pixels()
        .map(|p| shot.aov(Aov::WavelengthRatio, p))
        .fold(f64::INFINITY, f64::min)
}

/// The angle from ahead, degrees, at which the wall or column is seen that is most nearly abeam in the world.
fn abeam(shot: &Shot, eye: DVec3, forward: DVec3, hfov: f64) -> f64 {
    let pixels = shot.pixels().filter(|&p| shot.aov(Aov::Object, p) >= 0.0);
    let off = |p: usize| (shot.event(p).z - eye.z).abs();
    let nearest = pixels.min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap();
    shot.direction(nearest, forward, hfov)
        .dot(-DVec3::Z)
        .acos()
        .to_degrees()
}

#[test]
fn the_street_is_aberrated_and_shifted_as_its_header_says() {
    let (eye, forward) = (DVec3::new(0.9, 1.7, 6.0), DVec3::new(0.0, 0.06, -1.0));
    let rest = Shot::of("street.toml", "rest", [96, 54], &[]);
    check_aberration(&rest, eye, forward, 84.0, 1.0);
    let shot = Shot::of("street.toml", "motion", [192, 108], &[]);
    check_aberration(&shot, eye, forward, 84.0, 1.0 / (1.0f64 - 0.81).sqrt());
    // √(0.1/1.9) straight ahead, arccos 0.9 abeam; a pixel is half a degree.
    assert!((bluest(&shot) - 0.2294).abs() < 2e-4, "{}", bluest(&shot));
    assert!((abeam(&shot, eye, forward, 84.0) - 25.84).abs() < 0.5);
}

#[test]
fn the_tunnel_is_aberrated_and_shifted_as_its_header_says() {
    let (eye, forward) = (DVec3::new(0.5, 1.9, 8.0), DVec3::new(0.0, 0.08, -1.0));
    let shot = Shot::of("tunnel.toml", "motion", [192, 108], &[]);
    check_aberration(&shot, eye, forward, 64.0, 10.0);
    // 1/(10 (1 + 0.99499)) = 0.05013 straight ahead; a pixel at 0.4° has 0.1 % more. arccos 0.99499 = 5.739° abeam.
    assert!((bluest(&shot) - 0.0501).abs() < 3e-4, "{}", bluest(&shot));
    assert!((abeam(&shot, eye, forward, 64.0) - 5.74).abs() < 0.4);
}

#[test]
fn the_cornell_box_is_abeam_where_its_header_says() {
    let rest = Shot::of("cornell.toml", "rest", [48, 48], &[]);
    assert!(
        rest.shows("tall")
            .all(|p| (rest.aov(Aov::WavelengthRatio, p) - 1.0).abs() < 1e-12)
    );
    let shot = Shot::of("cornell.toml", "passing", [96, 96], &[]);
    let forward = DVec3::new(0.9, 0.0, -0.436);
    let gamma = 1.0 / (1.0f64 - 0.81).sqrt();
    let seen = shot.pixels().filter(|&p| shot.aov(Aov::Object, p) >= 0.0);
    let mut nearest = (f64::INFINITY, 0.0, 0.0);
    for pixel in seen {
        // W = γ (1 − β cos θ′), θ′ from ahead, which is +x.
        let cos = shot.direction(pixel, forward, 18.0).x;
        let found = shot.aov(Aov::WavelengthRatio, pixel);
        assert!(
            (found / (gamma * (1.0 - 0.9 * cos)) - 1.0).abs() < 1e-4,
            "{found} {cos}"
        );
        let off = shot.event(pixel).x.abs();
        if off < nearest.0 {
            nearest = (off, cos.acos().to_degrees(), found);
        }
    }
    // Abeam: arccos 0.9 = 25.84° and 1/γ = 0.436; a pixel is 0.2°.
    let (_, angle, ratio) = nearest;
    assert!(
        (angle - 25.84).abs() < 0.2 && (ratio - 0.436).abs() < 5e-3,
        "{angle} {ratio}"
    );
}

#[test]
fn no_place_is_lit_before_the_flash_has_reached_it_and_walls_glow_behind_its_front() {
    // The direct way is the shortest: what is r away from the flash has none of its light until r, less the length of the flash; with 3
    // bounces it glows after. Nine standard deviations of 12 cm are 1.08 m, where f64 has nothing left of a Gaussian. What there is
    // before is the dim lamp's: the same without the flash, which is then a kilometre late.
    let flash = DVec3::new(1.2, 2.8, 1.0);
    for panel in ["first", "second", "third"] {
        let shot = Shot::of("flash.toml", panel, [96, 96], &[]);
        let late = ("light.flash.emission.gaussian.time", "\"1000 m\"");
        let dim = Shot::of("flash.toml", panel, [96, 96], &[late]);
        let (mut early, mut glowing) = (0, 0);
        for pixel in shot.pixels().filter(|&p| shot.aov(Aov::Object, p) >= 0.0) {
            let [radiance, without] = [&shot, &dim].map(|shot| shot.film.radiance()[pixel]);
            let late = shot.aov(Aov::EventCt, pixel) - (shot.event(pixel) - flash).length();
            if late < -1.08 {
                assert_eq!(radiance, without, "{panel}, pixel {pixel}: {late} m");
                early += 1;
            }
            glowing += u32::from(late > 1.08 && radiance[1] > without[1]);
        }
        assert!(panel != "first" || early > 50, "{early}");
        assert!(panel != "third" || glowing > 100, "{glowing}");
    }
    // Ahead at 0.9 c, √(0.1/1.9) of the wavelength.
    let fast = Shot::of("flash.toml", "fast", [96, 96], &[]);
    assert!((bluest(&fast) - 0.2294).abs() < 1e-2, "{}", bluest(&fast));
}

#[test]
fn the_mirrors_shift_light_as_their_header_says() {
    let shot = Shot::of("mirrors.toml", "", [192, 108], &[]);
    let eye = DVec3::new(0.0, 1.3, 6.0);
    for (name, beta) in [("coming", 0.15), ("resting", 0.0), ("going", -0.15f64)] {
        let gamma = 1.0 / (1.0 - beta * beta).sqrt();
        let mut seen = 0;
        for pixel in shot.shows(name) {
            // Of light that leaves at the angle α from the mirror's velocity, W = γ (1 − β cos α).
            let cos = (eye - shot.event(pixel)).normalize().z;
            let ratio = gamma * (1.0 - beta * cos);
            let found = shot.aov(Aov::WavelengthRatio, pixel);
            assert!(
                (found / ratio - 1.0).abs() < 1e-6,
                "{name}: {found} {ratio}"
            );
            seen += 1;
        }
        assert!(seen > 50, "{name}: {seen}");
        // Straight there and back: W².
        let straight = (gamma * (1.0 - beta)).powi(2);
        assert!((straight - (1.0 - beta) / (1.0 + beta)).abs() < 1e-12);
        assert!(name != "coming" || (straight - 0.739).abs() < 5e-4);
    }
}

#[test]
fn the_oncoming_train_closes_in_at_the_sum_of_rapidities() {
    let shot = Shot::of("trains.toml", "motion", [192, 108], &[]);
    // β = 1.2/1.36 = 0.88235, γ = 2.125; W = γ (1 − β cos θ′) of light from θ′ off the line of motion, ¼ at θ′ = 0.
    let forward = DVec3::new(0.2, -0.12, -1.0);
    let mut least = f64::INFINITY;
    for pixel in shot.shows("oncoming") {
        let cos = shot.direction(pixel, forward, 70.0).dot(-DVec3::Z);
        let ratio = 2.125 * (1.0 - 1.2 / 1.36 * cos);
        let found = shot.aov(Aov::WavelengthRatio, pixel);
        assert!((found / ratio - 1.0).abs() < 1e-6, "{found} {ratio}");
        least = least.min(found);
    }
    assert!((0.25..0.27).contains(&least), "{least}");
    assert!(shot.shows("own").count() > 1000);
    for pixel in shot.shows("own") {
        assert!((shot.aov(Aov::WavelengthRatio, pixel) - 1.0).abs() < 1e-9);
    }
}

#[test]
fn half_of_the_sky_of_the_stars_lies_within_arccos_beta() {
    for (panel, gamma, hfov) in [
        ("rest", 1.0, 150.0),
        ("motion", 2.0, 150.0),
        ("gamma-10", 10.0, 40.0),
        ("gamma-100", 100.0, 4.0),
    ] {
        let shot = Shot::of("stars.toml", panel, [301, 301], &[]);
        let [width, _] = shot.film.size();
        // An equidistant fisheye: the angle from ahead is proportional to the distance from the middle.
        let limit = f64::sqrt(1.0 - f64::powi(gamma, -2)).acos().to_degrees();
        let middle_row = (width * (width / 2)) as usize;
        let mut edges = 0;
        for column in 0..width as usize {
            let angle = ((column as f64 + 0.5) / f64::from(width) - 0.5).abs() * hfov;
            if (angle - limit).abs() < 1e-6 * limit {
                continue;
            }
            let is_ahead = shot.aov(Aov::DirectionZ, middle_row + column) < 0.0;
            assert_eq!(is_ahead, angle < limit, "{panel}, {angle}°");
            edges += u32::from(angle > limit);
        }
        // At rest 90° are out of the picture; else both sides of the circle are in it.
        assert_eq!(edges > 0, gamma > 1.0, "{panel}");
    }
}

/// The event seen from the rest frame of what flies along +x at β and has its origin at the event (t, x).
fn in_flight([t, x, y, z]: [f64; 4], [t0, x0, y0, z0]: [f64; 4], beta: f64) -> [f64; 4] {
    let gamma = 1.0 / (1.0 - beta * beta).sqrt();
    let (t, x) = (t - t0, x - x0);
    [
        gamma * (t - beta * x),
        gamma * (x - beta * t),
        y - y0,
        z - z0,
    ]
}

#[test]
fn a_flying_ball_is_bounded_by_a_circle_on_the_sphere_of_directions() {
    let shot = Shot::of("dice-and-balls.toml", "motion", [480, 270], &[]);
    let forward = DVec3::new(0.0, 1.55 - 2.6, -11.0);
    for (name, place) in [
        ("flying-ball-1", [-12.36, -4.2, 3.4, -0.6]),
        ("flying-ball-3", [-11.71, 1.4, 3.4, -0.6]),
    ] {
        let place = [
            exact_time(&shot, name, place[0]),
            place[1],
            place[2],
            place[3],
        ];
        // In the ball's frame the camera is at P′, and sees a cap of half-angle asin(R/|P′|) about −P′.
        let [_, x, y, z] = in_flight([0.0, 0.0, 2.6, 11.0], place, 0.9);
        let axis = -DVec3::new(x, y, z);
        let half = (0.5 / axis.length()).asin();
        let across = axis.normalize().any_orthonormal_pair();
        // Three directions of its rim, as the camera that rests in the world sees them: x_w ∝ γ(x + β t), light comes with t = −1.
        let rim = |turn: f64| {
            let side = turn.cos() * across.0 + turn.sin() * across.1;
            let d = half.cos() * axis.normalize() + half.sin() * side;
            let gamma = 1.0 / (1.0f64 - 0.81).sqrt();
            DVec3::new(gamma * (d.x - 0.9), d.y, d.z).normalize()
        };
        let [a, b, c] = [rim(0.0), rim(2.0), rim(4.0)];
        // The circle through the three: all d with n·d = n·a. Its inside is the side of the ball's middle.
        let n = (b - a).cross(c - a).normalize();
        let n = n * n.dot(a).signum();
        let limit = n.dot(a);
        let (mut inside, object) = (0, shot.object(name));
        for pixel in shot.pixels() {
            let d = shot.direction(pixel, forward, 52.0);
            let depth = n.dot(d).acos() - limit.acos();
            // The mesh of 96 gores is up to 0.0005 m within the ball, less than a tenth of a pixel.
            if depth.abs() > 3e-4 {
                let is_ball = shot.aov(Aov::Object, pixel) == object;
                assert_eq!(is_ball, depth < 0.0, "{name}, pixel {pixel}, {depth}");
                inside += u32::from(is_ball);
            }
        }
        assert!(inside > 300, "{inside}");
    }
}

/// The origin's time in the file, which is rounded, near `about`.
fn exact_time(shot: &Shot, name: &str, about: f64) -> f64 {
    let time = shot.scene.objects[shot.object(name) as usize].origin.ct;
    assert!((time - about).abs() < 0.2, "{name}: {time}");
    time
}

#[test]
fn a_flying_die_far_away_is_as_wide_as_one_that_is_turned() {
    // Abeam at 2000 m: what is seen of it at x = 1.4 at the time of the shot left at −2000 m.
    let set = [
        ("camera.eye", "[1.4, 0.5, 2002.6]"),
        ("camera.look_at", "[1.4, 0.5, 2.6]"),
        ("camera.hfov", "\"0.1 deg\""),
        ("camera.time", "\"1991.23 m\""),
    ];
    let shot = Shot::of("dice-and-balls.toml", "motion", [800, 400], &set);
    let columns: Vec<_> = shot
        .shows("flying-die-3")
        .map(|pixel| pixel % 800)
        .collect();
    let (low, high) = (columns.iter().min().unwrap(), columns.iter().max().unwrap());
    let pixel = 2.0 * 2000.0 * f64::tan(0.05f64.to_radians()) / 800.0;
    let width = (high - low + 1) as f64 * pixel;
    // A square of edge 1 with corners of radius 0.09, turned by arcsin 0.9: 0.82 (0.9 + √0.19) + 2·0.09 = 1.2754.
    // At a finite distance the near side is up to 0.05 % nearer.
    assert!((width - 1.2754).abs() < 2.0 * pixel, "{width} {pixel}");
    assert!(*low > 0 && *high < 799);
}

#[test]
fn the_clocks_show_the_proper_time_at_which_their_light_left() {
    let shot = Shot::of("clocks.toml", "motion", [192, 108], &[]);
    let [t, x, y, z] = in_flight([22.38, 0.0, 0.0, 7.5], [15.0, 0.0, 0.0, 0.0], 0.6);
    for row in 1..=3 {
        for column in 1..=7 {
            for pixel in shot.shows(&format!("clock-{row}-{column}")) {
                let [px, py, pz] = [Aov::ObjectEventX, Aov::ObjectEventY, Aov::ObjectEventZ]
                    .map(|aov| shot.aov(aov, pixel));
                let way = DVec3::new(px - x, py - y, pz - z).length();
                let shown = shot.aov(Aov::ObjectEventCt, pixel);
                assert!(
                    (shown - (t - way)).abs() < 1e-6,
                    "clock {row} {column}: {shown}"
                );
                // It is within the 12 m that the faces have, so that none is dark.
                assert!(shot.film.radiance()[pixel][0] > 0.01);
            }
        }
    }
    // The header's numbers, of the clocks' centres.
    let reading = |at: f64| t - DVec3::new(at - x, 0.0, 0.12 - z).length();
    assert!((reading(-6.0) - 1.83).abs() < 0.01, "{}", reading(-6.0));
    assert!((reading(6.0) + 4.47).abs() < 0.01, "{}", reading(6.0));
}

/// How far apart the barn's lamps are seen at time t of the ladder's frame, in which x′ = ±5/γ − β t′ and the light has
/// come from 400 m away and 3 m above: t′ = t − √(x′² + 400² + 3²).
fn flying_apart(t: f64) -> f64 {
    let beta = 0.75f64.sqrt();
    let seen = |x: f64| {
        let mut at = 0.0;
        for _ in 0..50 {
            at = x / 2.0 - beta * (t - f64::hypot(at, f64::hypot(400.0, 3.0)));
        }
        at
    };
    seen(5.0) - seen(-5.0)
}

#[test]
fn the_ladder_fits_the_barn_in_one_frame_and_the_lamps_say_when() {
    let pixel = 2.0 * 400.0 * f64::tan(2.1f64.to_radians()) / 960.0;
    let columns = |shot: &Shot, name: &str| {
        let columns: Vec<_> = shot.shows(name).map(|pixel| pixel % 960).collect();
        let (low, high) = (columns.iter().min().unwrap(), columns.iter().max().unwrap());
        [*low as f64 * pixel, (*high + 1) as f64 * pixel]
    };
    let length = |[low, high]: [f64; 2]| high - low;
    let middle = |[low, high]: [f64; 2]| (low + high) / 2.0;
    let is_green = |shot: &Shot, name: &str| {
        let [red, green, _] = shot.film.radiance()[shot.shows(name).next().unwrap()];
        green > red
    };
    let lamps = ["left lamp", "right lamp"];
    let cases = [
        // Panel, length of the ladder, distance of the lamps, which are green: 20 m/γ, and 10 m/γ, with γ = 2.
        ("rest", 20.0, 10.0, [true, true]),
        ("barn", 10.0, 10.0, [true, true]),
        ("ladder-front", 20.0, 5.0, [false, true]),
        ("ladder-rear", 20.0, 5.0, [true, false]),
    ];
    for (panel, ladder, apart, green) in cases {
        let shot = Shot::of("barn-and-ladder.toml", panel, [960, 320], &[]);
        // Posts hide up to 0.25 m of the ladder's ends where it just fits.
        let found = length(columns(&shot, "ladder"));
        assert!((found - ladder).abs() < 0.3, "{panel}: ladder {found}");
        let [left, right] = lamps.map(|name| middle(columns(&shot, name)));
        let seen = match panel {
            "ladder-front" => flying_apart(391.5),
            "ladder-rear" => flying_apart(408.8),
            _ => apart,
        };
        assert!((seen - apart).abs() < 0.1, "{seen}");
        let found = right - left;
        assert!(
            (found - seen).abs() < 3.0 * pixel,
            "{panel}: {found} {seen}"
        );
        assert_eq!(lamps.map(|name| is_green(&shot, name)), green, "{panel}");
    }
}
