//! Finite exposures against an independent renderer of transient light.
//!
//! The reference (tests/data/transient/README.md) is the mean over 0.5 m of the camera's own time of frames in flight, each with the camera
//! at its position at that time. The limit, a relRMSE of 0.012, is twice that of an independent reconstruction from the same lightmap.

use std::path::Path;

use crate::common::arrays::array_at;
use crate::common::frames::data;
use glam::DVec3;
use nullray::io::cube::{Cube, CubeSamples};
use nullray::io::image::npz;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::model::{Integration, Records, Scene, Shutter};
use nullray::scene::{self, Overrides};
use nullray::spacetime::Velocity;

const DURATION: f64 = 0.5;
const LIMIT: f64 = 0.012;

const LIGHT: &str = "
[effects]
searchlight = false
[display]
back_faces = \"black\"
samples_per_pixel = 64
[[object]]
name = \"corner\"
gltf = \"scenes/corner/corner.glb\"
[[source]]
[source.cube]
file = \"scenes/corner/lightmap.npz\"
start = \"1.75 m\"
bin_width = \"0.05 m\"
filter = \"cubic_means\"
";

const STILL: &str = "[camera]
eye = [1.9, 1.7, 3.3]
look_at = [1.3715840072635999, 1.5374104637734154, 2.4667286268387536]
hfov = \"60 deg\"
size = [96, 96]
clock_zero = \"8.4 m\"
";

const MOVING: &str = "[camera]
eye = [1.5, 2.0, 3.2]
look_at = [1.6583467904418625, 1.8238347595572684, 2.2284589035884714]
hfov = \"40 deg\"
size = [96, 96]
velocity = { beta = [0.5283, 0.0, -0.2845] }
clock_zero = \"8.15 m\"
";

fn scene(camera: &str) -> Scene {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = format!("{camera}{LIGHT}");
    let mut scene = scene::parse(&text, "exposure", root, &Overrides::default()).unwrap();
    scene.camera.shutter = Some(Shutter {
        duration: DURATION,
        records: Records::Mean,
        integration: Default::default(),
    });
    scene
}

fn picture(scene: &Scene) -> Vec<f64> {
    let plan = Plan::new(scene, &Request::default()).unwrap();
    let prepared = Prepared::new(scene, &plan, &Silent).unwrap();
    let film = render(&prepared, &Silent).unwrap();
    film.radiance().iter().map(|rgb| rgb[0]).collect()
}

/// relRMSE against the reference frame `name`.
fn score(scene: &Scene, name: &str) -> f64 {
    let truth = array_at(&data("exposures.npz"), name);
    let (mut error, mut norm) = (0.0, 0.0);
    for (got, truth) in picture(scene).iter().zip(truth) {
        error += (got - truth).powi(2);
        norm += truth * truth;
    }
    let score = (error / norm).sqrt();
    println!("{name}: relRMSE {score:.4}");
    score
}

#[test]
fn an_exposure_at_rest_matches_the_transient_renderer() {
    assert!(score(&scene(STILL), "exp_static") <= LIMIT);
}

#[test]
fn an_exposure_in_motion_matches_the_transient_renderer() {
    assert!(score(&scene(MOVING), "exp_right06") <= LIMIT);
}

#[test]
fn an_exposure_frozen_or_timed_by_the_worlds_clock_fails_by_far() {
    // Frozen: the camera stays where the shutter opens.
    let mut frozen = scene(MOVING);
    frozen.camera.shutter = None;
    assert!(score(&frozen, "exp_right06") > 0.6);
    // 0.5 m of world time are 0.5/γ of the camera's.
    let mut undilated = scene(MOVING);
    let gamma = undilated.camera.velocity.gamma();
    undilated.camera.shutter = Some(Shutter {
        duration: DURATION / gamma,
        records: Records::Mean,
        integration: Default::default(),
    });
    assert!(score(&undilated, "exp_right06") > 0.25);
}

#[test]
fn energy_is_the_mean_times_the_duration() {
    let mut scene = scene(MOVING);
    scene.samples_per_pixel = 4;
    let means = picture(&scene);
    scene.camera.shutter = Some(Shutter {
        duration: DURATION,
        records: Records::Energy,
        integration: Default::default(),
    });
    for (energy, mean) in picture(&scene).into_iter().zip(means) {
        assert!((energy - DURATION * mean).abs() <= 1e-13 * mean.abs());
    }
}

#[test]
fn a_flash_gives_the_energy_that_it_emitted_whoever_looks() {
    // ∫L dt′ over the whole flash = W⁻ᵖ⁺¹ ∫L dt for a point straight ahead, of which the hit stays put:
    // the camera moves along its line of sight towards a wall lit evenly in the pulse's plane.
    let text = "
camera = { eye = [0, 0, 10], look_at = [0, 0, 0], hfov = \"0.01 deg\", size = [1, 1] }
medium = { index = 1 }
object = [{ shape = { plane = { size = [1, 1] } }, transform = { rotate = { axis = [1, 0, 0], angle = \"90 deg\" } }, colour = [1, 1, 1] }]
source = [{ pulse = { position = [0, 0, 30], time = \"0 m\", sigma = \"5 cm\", intensity = 1 } }]
display = { samples_per_pixel = 4096, background = [0, 0, 0] }
";
    let energy = |beta: f64, opens: f64, duration: f64| {
        let mut scene = scene::parse(text, "flash", Path::new(""), &Overrides::default()).unwrap();
        scene.camera.velocity = Velocity::from_beta(DVec3::NEG_Z * beta).unwrap();
        scene.camera.origin.ct = 40.0;
        scene.camera.time = opens;
        scene.camera.shutter = Some(Shutter {
            duration,
            records: Records::Energy,
            integration: Default::default(),
        });
        picture(&scene)[0]
    };
    // The flash leaves the wall at world time 30 and meets a camera at rest, 10 m away, at 40.
    let rest = energy(0.0, -1.0, 2.0);
    let moving = energy(0.6, -1.0, 2.0);
    // W = γ(1 − β) = ½ when looking ahead at 0.6 c; integrated radiance goes with W⁻⁴, its energy with W⁻³.
    assert!(rest > 0.0);
    assert!(
        (moving / rest / 8.0 - 1.0).abs() < 2e-3,
        "{}",
        moving / rest
    );
}

/// The same with samples that take means over their parts of the exposure.
fn integrated(mut scene: Scene) -> Scene {
    scene.camera.shutter = Some(Shutter {
        duration: DURATION,
        records: Records::Mean,
        integration: Integration::Means,
    });
    scene
}

#[test]
fn means_over_parts_of_an_exposure_match_the_transient_renderer_with_fewer_samples() {
    assert!(score(&integrated(scene(MOVING)), "exp_right06") <= LIMIT);
    assert!(score(&integrated(scene(STILL)), "exp_static") <= LIMIT);
    // What is left of the error is that of places in pixels.
    let mut few = scene(STILL);
    few.samples_per_pixel = 16;
    let moments = score(&few, "exp_static");
    let means = score(&integrated(few), "exp_static");
    assert!(means < 0.7 * moments, "{means} {moments}");
}

/// A plane 2 m below the camera shows light that left it from 1 to 2 m.
#[test]
fn exposures_record_the_energies_of_their_bins_whatever_the_widths() {
    let folder = tempfile::tempdir().unwrap();
    let recorded = |energies: &[f64], keys: &str| {
        let lines = energies.iter().cycle().take(4 * energies.len()).copied();
        let cube = Cube::new([2, 2, energies.len(), 1], CubeSamples::F64(lines.collect()));
        npz::write_cube(&folder.path().join("a.npy"), &cube.unwrap()).unwrap();
        let text = format!(
            "[camera]\neye = [0, 2, 0]\nlook_at = [0, 0, 0]\nup = [0, 0, -1]\nhfov = \"0.001 deg\"\nsize = [2, 2]\n\
             time = \"3 m\"\nshutter = {{ duration = \"1 m\", records = \"energy\", integration = \"means\" }}\n\
             [[object]]\nshape = {{ plane = {{ size = [4, 4] }} }}\n\
             [[source]]\ncube = {{ file = \"a.npy\", filter = \"nearest\", {keys} }}\n"
        );
        let scene = scene::parse(&text, "a.toml", folder.path(), &Overrides::default());
        picture(&scene.unwrap())
    };
    let table = |edges: &mut dyn Iterator<Item = f64>| {
        let edges: Vec<String> = edges.map(|edge| format!("\"{edge:?} m\"")).collect();
        format!("edges = [{}]", edges.join(", "))
    };
    let energies: Vec<f64> = (0..20).map(|bin| f64::from(bin * bin % 7)).collect();
    let expected: f64 = energies[10..].iter().sum();
    let uniform = recorded(&energies, "bin_width = \"0.1 m\"");
    assert!((uniform[0] - expected).abs() < 1e-6, "{uniform:?}");
    // Times as a table in centimetres has them, and as one in single precision.
    let exact = table(&mut (0..=20).map(|edge| 0.01 * f64::from(10 * edge)));
    let single = table(&mut (0..=20).map(|edge| f64::from(0.1 * edge as f32)));
    for table in [exact, single] {
        for (found, uniform) in recorded(&energies, &table).into_iter().zip(&uniform) {
            assert!((found - uniform).abs() < 1e-5, "{table}: {found} {uniform}");
        }
    }
    let uneven = table(&mut [0.0, 0.3, 0.5, 1.0, 1.2, 1.25, 1.6, 2.0, 2.5].into_iter());
    let energies: Vec<f64> = (1..=8).map(f64::from).collect();
    for found in recorded(&energies, &uneven) {
        assert!((found - (4.0 + 5.0 + 6.0 + 7.0)).abs() < 1e-6, "{found}");
    }
}
