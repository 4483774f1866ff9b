//! `nullray film`: common motions of a camera, as a film made by one command line.
//!
//! Every picture is taken by a camera without acceleration that has the position and velocity of the moving camera at that moment. With the
//! scene's pinhole at P when its clock shows 0 (world time t₀), n the direction of motion and s the distance:
//!
//! ```text
//! fly-by:        P + n x,  x from m − s/2 to m + s/2,  at t₀ + x/β;  m = d (c + γ (β − c))
//! acceleration:  β(τ) = tanh aτ,  x = (cosh aτ − 1)/a,  t = t₀ + sinh(aτ)/a,  a = (γ − 1)/s,  until β, γ are reached
//! speeds:        P at t₀;  β = tanh(k φ/(N − 1)),  tanh φ the greatest, so that each step is the same boost
//! light:         the scene's own camera, at times of its own clock
//! ```
//!
//! A passing camera sees its subject long after it has passed it. The subject is at the distance d from P, at an angle to n with the cosine
//! c. Seen from P + n m, its direction has the cosine (c − β)/(1 − βc), which aberration turns back into c, so that it appears where a
//! camera at rest sees it: in the middle of the picture, and of the film. The light seen there left it at t₀ (for c = 0: m = γβd, the time
//! is t₀ + γd, and the path of the light is γd). For the subject to move from edge to edge as it does for a slow camera, the distance must
//! be γ times as large.
//!
//! (Hyperbolic motion: Rindler, Relativity, 2nd ed., 3.7; aberration: 4.3.)

use std::str::FromStr;

use glam::DVec3;
use nullray::camera;
use nullray::figures::contact_sheet::{self, Panel, SheetOptions};
use nullray::figures::diagram::Series;
use nullray::figures::drawing::png;
use nullray::io::image::RgbImage;
use nullray::render::metadata;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::survey::{self, Shots};
use nullray::scene::model::Scene;
use nullray::scene::{Heading, Overrides, SceneFile};
use nullray::spacetime::{Event, Velocity};
use nullray::{Error, Result};

use super::args::{Beside, FilmArguments, MotionArguments};
use super::failure::refused;
use super::film::in_pool;
use super::frames::{self, Frames, Job, SharedExposure, Shot};
use super::names::{named_after, numbered};
use super::output::Outputs;
use super::reel::{self, Folder, Reel};
use super::{builtin, caption, exposure, inputs};

/// The minimum number of pixels per point in a diagram beside a picture, if the page has room for it.
const SMALLEST: f64 = 0.9;
/// The smallest and the largest side of such a diagram, points.
const PAGES: [f64; 2] = [180.0, 320.0];

pub fn run(mut arguments: FilmArguments) -> Result<()> {
    if arguments.output.is_empty() {
        arguments.output = vec![named_after(arguments.scene.path(), ".apng")];
    }
    reel::keep_pipe(&arguments.output);
    let overrides = arguments.changes.overrides();
    let file = builtin::open(
        arguments.scene.path(),
        &overrides,
        arguments.changes.memory.bytes(),
    )?;
    let scene = file.scene(&overrides)?;
    let plan = Plan::new(
        &scene,
        &arguments.changes.request(arguments.work.threads.count),
    )?;
    reel::check(&arguments.output, &inputs::of(&scene, &plan))?;
    reel::tell_bits(&arguments.output, &scene, arguments.work.quiet.on)?;
    // What cannot be shown beside or below the pictures is refused before any of them is rendered.
    caption::check(arguments.caption.as_deref())?;
    let diagrams = match (arguments.beside, arguments.motion.light) {
        (Some(Beside::Diagram), false) => Some(diagrams(&arguments, &file, &scene)?),
        _ => None,
    };
    let takes = takes(&arguments, &scene)?;
    in_pool(arguments.work.threads.count, || {
        film(&arguments, &file, &scene, &takes, diagrams)
    })
}

/// One of the series of pictures that a film shows side by side, over its whole length.
struct Take {
    /// A part of the names of its pictures.
    name: &'static str,
    frames: Frames,
    /// The text below each picture.
    captions: Vec<String>,
}

/// The takes of a film, the moving one last.
fn takes(arguments: &FilmArguments, scene: &Scene) -> Result<Vec<Take>> {
    let pictures = arguments.pictures;
    let request = arguments.changes.request(arguments.work.threads.count);
    let Some(motion) = motion(&arguments.motion, scene, pictures, &request)? else {
        return match arguments.motion.light {
            true => Ok(vec![light(arguments, scene)?]),
            false => Err(no_motion()),
        };
    };
    let mut takes = Vec::new();
    if arguments.beside == Some(Beside::Rest) {
        let shots = motion.iter().map(|shot| Shot {
            velocity: Velocity::REST,
            ..*shot
        });
        takes.push(Take {
            name: "rest",
            frames: Frames::of_shots(shots.collect()),
            captions: vec!["at rest".into(); motion.len()],
        });
    }
    let captions = motion.iter().map(speed_of);
    takes.push(Take {
        name: "film",
        captions: captions.collect(),
        frames: Frames::of_shots(motion),
    });
    Ok(takes)
}

fn no_motion() -> Error {
    let what = "no camera motion is given";
    let help = "give --flyby 0.9, --accelerate 0.9, --speeds 0.9 or --light";
    refused("film", what, help)
}

/// The speed of a moving camera.
pub fn speed_of(shot: &Shot) -> String {
    caption::speed(shot.velocity)
}

/// The moments of a moving camera; `None` if it is the scene's own.
fn motion(
    motion: &MotionArguments,
    scene: &Scene,
    pictures: u32,
    request: &Request,
) -> Result<Option<Vec<Shot>>> {
    let scene = &placed(scene)?;
    let last = f64::from(pictures.saturating_sub(1).max(1));
    let part = |k: u32| f64::from(k) / last;
    let [right, _, forward] = scene.camera.axes;
    if let Some(beta) = motion.flyby {
        let n = heading(motion.direction, right)?;
        let velocity = velocity("--flyby", beta, n)?;
        let subject = subject(scene, request)?;
        let distance = distance(motion, scene, subject, 2.0 * velocity.gamma())?;
        let way = subject.map(|point| point - scene.camera.origin.x);
        let middle = way.map_or(0.0, |way| straight_ahead(way, n, velocity));
        let shot = |k| {
            let x = middle + (part(k) - 0.5) * distance;
            Ok(shot(scene, x / beta, x * n, velocity))
        };
        return (0..pictures).map(shot).collect::<Result<_>>().map(Some);
    }
    if let Some(beta) = motion.accelerate {
        let n = heading(motion.direction, forward)?;
        let greatest = velocity("--accelerate", beta, n)?;
        let subject = match motion.distance {
            Some(_) => None,
            None => subject(scene, request)?,
        };
        // Not the whole distance, so that the subject stays in view.
        let a = greatest.gamma_minus_one() / distance(motion, scene, subject, 0.9)?;
        let rapidity = greatest.rapidity().length();
        let shot = |k| {
            let w = part(k) * rapidity;
            // cosh w − 1 = 2 sinh²(w/2), without cancellation.
            let x = 2.0 * libm::sinh(w / 2.0).powi(2) / a;
            let velocity = moving("--accelerate", n * w)?;
            Ok(shot(scene, libm::sinh(w) / a, x * n, velocity))
        };
        return (0..pictures).map(shot).collect::<Result<_>>().map(Some);
    }
    let Some(beta) = motion.speeds else {
        return Ok(None);
    };
    speeds("--speeds", motion.direction, scene, beta, pictures).map(Some)
}

/// The same place and moment at speeds from 0 to `beta`, in equal steps of rapidity.
pub fn speeds(
    option: &str,
    direction: Option<Heading>,
    scene: &Scene,
    beta: f64,
    steps: u32,
) -> Result<Vec<Shot>> {
    let scene = &placed(scene)?;
    let n = heading(direction, scene.camera.axes[2])?;
    let rapidity = velocity(option, beta, n)?.rapidity();
    let last = f64::from(steps.saturating_sub(1).max(1));
    let step = |k| {
        let velocity = moving(option, rapidity * (f64::from(k) / last))?;
        Ok(shot(scene, 0.0, DVec3::ZERO, velocity))
    };
    (0..steps).map(step).collect()
}

/// The scene with a camera that rests where, and when, its own one takes its picture.
fn placed(scene: &Scene) -> Result<Scene> {
    let shot = Shot {
        event: camera::Shot::new(&scene.camera)?.event,
        velocity: Velocity::REST,
    };
    Ok(shot.seen(scene))
}

/// The resting camera of `scene` at this displacement from its shot.
fn shot(scene: &Scene, ct: f64, x: DVec3, velocity: Velocity) -> Shot {
    let origin = scene.camera.origin;
    Shot {
        event: Event::new(origin.ct + scene.camera.time + ct, origin.x + x),
        velocity,
    }
}

fn velocity(option: &str, beta: f64, n: DVec3) -> Result<Velocity> {
    if !(beta > 0.0 && beta < 1.0) {
        let what = format!("{beta} is not a speed v/c above 0 and below 1");
        return Err(refused(
            format!("{option} {beta}"),
            what,
            "give a speed like 0.9",
        ));
    }
    let velocity = Velocity::from_beta(n * beta);
    velocity.map_err(|e| {
        refused(
            format!("{option} {beta}"),
            e.to_string(),
            "give a lower speed",
        )
    })
}

fn moving(option: &str, rapidity: DVec3) -> Result<Velocity> {
    let velocity = Velocity::from_rapidity(rapidity);
    velocity.map_err(|e| refused(option, e.to_string(), "give a lower speed"))
}

fn heading(direction: Option<Heading>, default: DVec3) -> Result<DVec3> {
    match direction {
        None => Ok(default.normalize_or(DVec3::NEG_Z)),
        Some(Heading::Along(n)) => Ok(n.normalize_or(DVec3::NEG_Z)),
        Some(_) => Err(refused(
            "--direction",
            "\"towards\" and \"away\" are for `render` and `plan` of a model without a scene",
            "give x, y, z, -x, -y, -z or a vector like 1,0,-1",
        )),
    }
}

/// How far along `n` a camera has to move until aberration shows a point, which was at `way` from the camera, in its original direction
/// again, metres (m in the head of the module).
fn straight_ahead(way: DVec3, n: DVec3, velocity: Velocity) -> f64 {
    let (along, beta) = (way.dot(n), velocity.beta().length());
    along + velocity.gamma() * (beta * way.length() - along)
}

/// The distance that the camera covers, metres: the given one, or `times` its distance from the `subject`.
fn distance(
    motion: &MotionArguments,
    scene: &Scene,
    subject: Option<DVec3>,
    times: f64,
) -> Result<f64> {
    if let Some(distance) = motion.distance {
        let metres = distance.metres(scene.speed_of_light);
        return match metres > 0.0 {
            true => Ok(metres),
            false => Err(refused(
                "--distance",
                "it is not above 0",
                "give a length like \"6 m\"",
            )),
        };
    }
    subject.map(|point| times * point.distance(scene.camera.origin.x)).ok_or_else(|| {
        let what = "the scene does not say what its camera looks at (camera.look_at), and has no surface away from it: the distance is unknown";
        refused("--distance", what, "give the distance, like --distance \"6 m\"")
    })
}

/// The point that the camera looks at: the one in the scene file, or else a point on its forward axis. This is at the median distance of
/// the surfaces in view; if none is in view, at the distance of the nearest object's origin; and in a scene without objects at 1 m. `None`
/// if all objects have their origins in the pinhole.
///
/// # Errors
/// Errors of rendering a small picture.
fn subject(scene: &Scene, request: &Request) -> Result<Option<DVec3>> {
    if let Some(point) = looked_at(&scene.text) {
        return Ok(Some(point));
    }
    let [.., forward] = scene.camera.axes;
    let eye = scene.camera.origin.x;
    let distance = match scene.objects.is_empty() {
        true => Some(1.0),
        false => {
            let still = shot(scene, 0.0, DVec3::ZERO, Velocity::REST).seen(scene);
            let seen = exposure::median_distance(&still, request)?;
            seen.or_else(|| nearest(scene))
        }
    };
    Ok(distance.map(|distance| eye + forward * distance))
}

/// The distance of the nearest object whose origin is not in the pinhole, metres.
fn nearest(scene: &Scene) -> Option<f64> {
    let eye = scene.camera.origin.x;
    let origins = scene.objects.iter();
    let origins = origins.map(|object| object.origin.x + object.transform.translation);
    let distances = origins.map(|origin| origin.distance(eye));
    distances
        .filter(|distance| *distance > 0.0)
        .reduce(f64::min)
}

fn looked_at(text: &str) -> Option<DVec3> {
    let document = toml_edit::DocumentMut::from_str(text).ok()?;
    let point = document.get("camera")?.get("look_at")?.as_array()?;
    let number = |k| {
        let value = point.get(k)?;
        value
            .as_float()
            .or_else(|| value.as_integer().map(|n| n as f64))
    };
    Some(DVec3::new(number(0)?, number(1)?, number(2)?))
}

/// The scene's own camera while light passes by.
fn light(arguments: &FilmArguments, scene: &Scene) -> Result<Take> {
    if let Some(beside) = arguments.beside {
        let what = "with --light the camera is the scene's own, and there is no other motion to compare it with";
        return Err(refused(
            format!("--beside {}", beside.word()),
            what,
            "leave it out",
        ));
    }
    let metres = |time: nullray::spacetime::units::Time| time.metres(scene.speed_of_light);
    let [from, to] = match (arguments.motion.from, arguments.motion.to) {
        (Some(from), Some(to)) => [metres(from), metres(to)],
        _ => passing(arguments, scene)?,
    };
    let frames = Frames::evenly([from, to], arguments.pictures)?;
    let captions = frames.numbers.clone().map(|k| {
        let time = frames.time(k).unwrap_or_default();
        format!("t′ = {time:.2} m").replace('-', "−")
    });
    Ok(Take {
        name: "film",
        captions: captions.collect(),
        frames,
    })
}

/// Light that is in view more than this many times as long as the shortest is ignored: it counts as steady.
const SHINING_ON: f64 = 10.0;

/// The times from the first to the last of the ranges that are not far longer than the shortest.
fn brief(ranges: &[[f64; 2]]) -> Option<[f64; 2]> {
    let length = |[from, to]: &[f64; 2]| to - from;
    let shortest = ranges.iter().map(length).reduce(f64::min)?;
    let brief = ranges
        .iter()
        .filter(|range| length(range) <= SHINING_ON * shortest);
    brief
        .copied()
        .reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}

/// The camera times between which light of some source that is not steady is in view, from a small picture.
fn passing(arguments: &FilmArguments, scene: &Scene) -> Result<[f64; 2]> {
    let mut small = scene.clone();
    let [width, height] = scene.camera.size;
    let step = width.max(height).div_ceil(64);
    small.camera.size = [width.div_ceil(step), height.div_ceil(step)];
    let plan = Plan::new(
        &small,
        &arguments.changes.request(arguments.work.threads.count),
    )?;
    let mut prepared = Prepared::new(&small, &plan, &Silent)?;
    // For a cube, the lit part of its data.
    let mut wanted = survey::seen_times(&prepared);
    for times in &mut wanted {
        times.data = survey::lit(&prepared, times.source).unwrap_or(times.data);
    }
    let mut shots = Shots::new(&small, &mut prepared);
    let times: Vec<[f64; 2]> = wanted.iter().filter_map(|w| shots.showing(w)).collect();
    brief(&times).ok_or_else(|| {
        let what = "no source of the scene says when its light is in view";
        let help = "give the camera's times, like --from \"0 m\" --to \"5 m\", or another motion: --flyby 0.9";
        refused("--light", what, help)
    })
}

/// Renders all takes, and assembles the film, with `diagrams` beside the pictures if there are any.
fn film(
    arguments: &FilmArguments,
    file: &SceneFile,
    scene: &Scene,
    takes: &[Take],
    diagrams: Option<Series>,
) -> Result<()> {
    let count = u64::from(arguments.pictures);
    let diagrams = match diagrams {
        Some(series) => drawn(series, f64::from(scene.camera.size[1]))?,
        None => Vec::new(),
    };
    let folder = Folder::of(&arguments.output)?;
    let request = arguments.changes.request(arguments.work.threads.count);
    let reel = Reel {
        films: &arguments.output,
        count,
        fps: arguments.fps,
        metadata: &metadata::of_text(&scene.name, &scene.text),
        quiet: arguments.work.quiet.on,
    };
    // Pictures are put side by side, one picture of the film at a time.
    let picture = |k: u64, fingerprints: &[&str]| {
        let mut panels = Vec::new();
        for (take, fingerprint) in takes.iter().zip(fingerprints) {
            let path = numbered(&folder.pattern(take.name), k);
            panels.push(Panel {
                picture: reel::read(&path, fingerprint)?,
                label: label(arguments, scene, take, k),
                new_row: false,
            });
        }
        if let Some(picture) = diagrams.get(k as usize) {
            let label = "its space-time diagram".into();
            panels.push(Panel {
                picture: picture.clone(),
                label,
                new_row: false,
            });
        }
        match panels.len() {
            1 if arguments.no_captions => Ok(panels.remove(0).picture),
            n => contact_sheet::compose(
                &panels,
                &SheetOptions {
                    title: None,
                    columns: Some(n as u32),
                },
            )
            .map(reel::even),
        }
    };
    let mut stream = reel.stream(arguments.output.len() == 1);
    // Pictures of all takes are first written to the folder; existing ones are not rendered again.
    let mut fingerprints: Vec<Vec<String>> = Vec::new();
    let is_same = arguments.exposure.is_same();
    // The same for what rests beside it, so that they can be compared.
    let moving = takes.last().map(|take| &take.frames);
    for take in takes {
        let outputs = Outputs {
            images: vec![folder.pattern(take.name)],
            ..Outputs::default()
        };
        let job = Job {
            changes: &arguments.changes,
            shared_exposure: match arguments.motion.speeds {
                Some(_) => SharedExposure::at_speeds(is_same, moving.unwrap_or(&take.frames)),
                None if is_same => SharedExposure::OfMiddle,
                None => SharedExposure::None,
            },
            quiet: arguments.work.quiet.on,
            file,
            scene,
            frames: &take.frames,
            request: &request,
            outputs: &outputs,
            can_resume: folder.stays(),
        };
        let made = frames::run(&job, None, &mut |k, fingerprint| {
            let others = fingerprints.iter().map(|all| all[k as usize].as_str());
            let all: Vec<&str> = others.chain([fingerprint]).collect();
            // Complete with the last of the takes.
            match all.len() == takes.len() {
                true => stream.send(|| picture(k, &all)),
                false => Ok(()),
            }
        });
        let Some(made) = reel::unless_closed(made)? else {
            return Ok(());
        };
        fingerprints.push(made);
    }
    reel.write(|k| {
        let of_picture = fingerprints.iter().map(|all| all[k as usize].as_str());
        picture(k, &of_picture.collect::<Vec<_>>())
    })?;
    folder.remove();
    Ok(())
}

/// The text below picture `k` of a take.
fn label(arguments: &FilmArguments, scene: &Scene, take: &Take, k: u64) -> String {
    let caption = take.captions.get(k as usize).cloned().unwrap_or_default();
    let words = arguments.caption.as_ref().or(scene.caption.as_ref());
    match words.filter(|words| !words.is_empty()) {
        _ if arguments.no_captions => String::new(),
        Some(words) => format!("{words}, {caption}"),
        None => caption,
    }
}

/// The scene's diagram in the frame of each of the camera's speeds, to be drawn as high as its pictures.
fn diagrams(arguments: &FilmArguments, file: &SceneFile, scene: &Scene) -> Result<Series> {
    let Some(beta) = arguments.motion.speeds else {
        let what = "a diagram is boosted along with the speeds of one place and moment";
        return Err(refused(
            "--beside diagram",
            what,
            "give --speeds 0.9 as the motion",
        ));
    };
    let n = heading(arguments.motion.direction, scene.camera.axes[2])?;
    // Its text is as large as that below the picture, and its lines are as far apart as there is room for.
    let height = f64::from(scene.camera.size[1]);
    let page = (height / SMALLEST).clamp(PAGES[0], PAGES[1]);
    boosts(
        file,
        &arguments.changes.overrides(),
        n * beta,
        arguments.pictures,
        Some(page),
    )
}

/// The pictures of a series of diagrams, `height` pixels high.
fn drawn(series: Series, height: f64) -> Result<Vec<RgbImage>> {
    let picture = |drawing: Result<nullray::figures::drawing::Drawing>| {
        let drawing = drawing?;
        let raster = png::render(&drawing, height / drawing.height)?;
        Ok(reel::opaque(&raster))
    };
    series.map(picture).collect()
}

/// The diagram of a scene, boosted in `steps` equal steps of rapidity from the world to the camera's frame, which moves with `beta`. The
/// boosts are about the event of the picture, which stays in place. The page has the given number of points on each side, or a diagram's
/// usual size.
pub fn boosts(
    file: &SceneFile,
    overrides: &Overrides,
    beta: DVec3,
    steps: u32,
    height: Option<f64>,
) -> Result<Series> {
    let mut overrides = Overrides {
        set: overrides.set.clone(),
        time: overrides.time.clone(),
        ..Overrides::default()
    };
    let DVec3 { x, y, z } = beta;
    let set = [
        (
            "camera.velocity",
            format!("{{ beta = [{x:?}, {y:?}, {z:?}] }}"),
        ),
        ("diagram.animation.boost_to", "\"camera\"".into()),
        ("diagram.animation.frames", steps.to_string()),
    ];
    overrides
        .set
        .extend(set.map(|(key, value)| (key.to_string(), value)));
    let mut diagram = builtin::diagram(file, &overrides)?;
    let shot = diagram.events.iter().find(|event| event.name == "shot");
    if let Some(shot) = shot.map(|shot| shot.at) {
        diagram.boost_about(shot);
    }
    if let Some(height) = height {
        diagram.style.width.get_or_insert(height);
        diagram.style.height.get_or_insert(height);
    }
    Series::new(&diagram).ok_or_else(|| {
        let what = "the diagram of this scene cannot be boosted";
        Error::invalid("diagram", "", what, "leave out --beside diagram")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_of_light_lasts_as_long_as_what_flashes_and_not_as_what_shines_on() {
        assert_eq!(brief(&[]), None);
        assert_eq!(brief(&[[4.0, 9.0], [0.0, 8.0]]), Some([0.0, 9.0]));
        let flash_and_lamp = [[-390.0, 415.0], [6.0, 20.0], [10.0, 60.0]];
        assert_eq!(brief(&flash_and_lamp), Some([6.0, 60.0]));
    }

    #[test]
    fn what_a_passing_camera_looks_at_is_in_the_middle_of_its_film() {
        for (way, n) in [
            (DVec3::new(0.0, -0.5, -4.0), DVec3::X),
            (DVec3::new(1.0, -0.5, -4.0), DVec3::X),
            (DVec3::new(-3.0, 2.0, 1.0), DVec3::new(0.6, 0.0, 0.8)),
        ] {
            for beta in [0.1, 0.6, 0.99] {
                let velocity = Velocity::from_beta(n * beta).unwrap();
                let x = straight_ahead(way, n, velocity);
                let to = way - n * x;
                let cos = to.normalize().dot(n);
                let seen = (cos + beta) / (1.0 + beta * cos);
                assert!((seen - way.normalize().dot(n)).abs() < 1e-12, "{beta} {n}");
                // Its light left when the camera's clock showed 0 at P, from where it is seen at a right angle to the motion.
                if way.dot(n) == 0.0 {
                    assert!((x / beta - to.length()).abs() < 1e-9, "{beta} {n}");
                }
            }
        }
    }
}
