//! Frames of a moving camera against an independent renderer of transient light.
//!
//! The reference frames, cubes and masks come from a path tracer that simulates light in flight, independent of this program
//! (tests/data/transient/README.md). They hold world-frame radiance: no Doppler or searchlight factor. Scores are relRMSE = √(Σ(a−b)²/Σb²).
//! The limits are 1.25 times what a careful implementation of the same reconstruction reaches on the same data.
//!
//! The same comparison is made with one planted error at a time (no retardation, reversed aberration, no aberration, depth for distance):
//! each must fail by a wide margin, or the test would prove nothing.

use std::path::Path;
use std::sync::OnceLock;

use crate::common::frames::{Frame, Limit, frames, reference};
use nullray::io::cube::{Changes, Cube, Wanted, convert};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::model::Scene;
use nullray::scene::{self, Overrides};

const SOURCES: [(&str, &str); 3] = [
    (
        "lightmap",
        "file = \"scenes/corner/lightmap.npz\"\nstart = \"1.75 m\"\nclock = \"world\"\nuv = 0",
    ),
    (
        "world",
        "file = \"tests/data/transient/capture_world.npz\"\nstart = \"1.75 m\"\nclock = \"world\"",
    ),
    (
        "camera",
        "file = \"tests/data/transient/capture_camera.npz\"\nstart = \"7.2 m\"\nclock = \"capture\"",
    ),
];

const CAPTURE: &str = "[source.cube.capture]
eye = [3.2, 3.0, 4.6]
look_at = [-0.4, 1.0, -0.6]
hfov = \"45 deg\"
";

/// The scene as frame `frame` sees it, radiance from source `source` reconstructed by `filter`.
fn text(frame: &Frame, source: usize, filter: &str) -> String {
    let (_, cube) = SOURCES[source];
    let capture = if source == 0 { "" } else { CAPTURE };
    format!(
        "outside = \"black\"
[display]
back_faces = \"black\"
samples_per_pixel = 16
[camera]
eye = {:?}
look_at = {:?}
hfov = \"{:?} deg\"
size = [96, 96]
velocity = {{ beta = {:?} }}
clock_zero = \"{:?} m\"
time = \"0 m\"
[effects]
searchlight = false
[[object]]
name = \"corner\"
gltf = \"scenes/corner/corner.glb\"
[[source]]
name = \"light\"
objects = [\"corner\"]
[source.cube]
bin_width = \"0.05 m\"
values = \"per_bin\"
filter = \"{filter}\"
{cube}
{capture}",
        frame.eye,
        frame.look_at(),
        frame.hfov,
        frame.beta,
        frame.time
    )
}

fn parsed(text: &str) -> Scene {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    scene::parse(text, "test scene", root, &Overrides::default()).unwrap()
}

/// Mean radiance per pixel of the scene `text`.
fn picture(text: &str) -> Vec<f64> {
    pictures([text.into()]).remove(0)
}

/// The same of scenes that differ in their cameras, which share one preparation.
fn pictures(texts: impl IntoIterator<Item = String>) -> Vec<Vec<f64>> {
    let mut shared: Option<Prepared> = None;
    let mut of = |text: String| {
        let scene = parsed(&text);
        let prepared = match &mut shared {
            Some(prepared) => {
                prepared.retake(&scene).unwrap();
                prepared
            }
            none => {
                let plan = Plan::new(&scene, &Request::default()).unwrap();
                none.insert(Prepared::new(&scene, &plan, &Silent).unwrap())
            }
        };
        let film = render(prepared, &Silent).unwrap();
        film.radiance().iter().map(|rgb| rgb[0]).collect()
    };
    texts.into_iter().map(&mut of).collect()
}

/// relRMSE over the pixels that `mask` chooses.
fn score(got: &[f64], truth: &[f64], mask: impl Fn(usize) -> bool) -> f64 {
    let (mut error, mut norm) = (0.0, 0.0);
    for i in (0..truth.len()).filter(|i| mask(*i)) {
        error += (got[i] - truth[i]).powi(2);
        norm += truth[i].powi(2);
    }
    (error / norm).sqrt()
}

fn everywhere(_: usize) -> bool {
    true
}

#[test]
fn lightmap_frames_match_the_transient_renderer() {
    type Allowed = fn(&Limit) -> f64;
    let limits: [(&str, Allowed); 3] = [
        ("linear", |limit| 1.25 * limit.linear),
        ("cubic", |limit| 1.25 * limit.cubic),
        ("cubic_means", |limit| limit.means + 0.01),
    ];
    for (filter, limit) in limits {
        let images = pictures(frames().iter().map(|frame| text(frame, 0, filter)));
        for (frame, image) in frames().iter().zip(images) {
            let limit = limit(&frame.limit);
            let got = score(&image, &reference(&frame.name), everywhere);
            assert!(
                got <= limit,
                "{} {filter}: relRMSE {got:.4} above {limit:.4}",
                frame.name
            );
        }
    }
}

/// What each frame sees of the captures of the world's clock and of the camera's.
fn reprojected() -> &'static [Vec<Vec<f64>>; 2] {
    static PICTURES: OnceLock<[Vec<Vec<f64>>; 2]> = OnceLock::new();
    PICTURES.get_or_init(|| {
        [1, 2].map(|source| pictures(frames().iter().map(|f| text(f, source, "cubic_means"))))
    })
}

/// The same scene with the sharp reconstruction.
fn sharp(text: String) -> String {
    text.replace("filter =", "reconstruction = \"sharp\"\nfilter =")
}

#[test]
fn captures_reprojected_match_the_transient_renderer_where_they_saw_the_scene() {
    for (k, frame) in frames().iter().enumerate() {
        let truth = reference(&frame.name);
        let interior = crate::common::frames::mask(&format!("interior_{}", frame.name));
        for (source, limit) in [
            (1, frame.limit.world_interior),
            (2, frame.limit.camera_interior),
        ] {
            let limit = 1.25 * limit + 0.003;
            let image = &reprojected()[source - 1][k];
            let got = score(image, &truth, |i| interior[i] == 1.0);
            let name = SOURCES[source].0;
            assert!(
                got <= limit,
                "{} {name}: relRMSE {got:.4} above {limit:.4}",
                frame.name
            );
        }
    }
}

/// On every frame and clock the sharp reconstruction is at least as good on smooth surfaces.
#[test]
fn captures_taken_as_means_come_nearer_to_the_transient_renderer() {
    let mut gains = Vec::new();
    for source in [1, 2] {
        let name = SOURCES[source].0;
        let texts = frames();
        let texts = texts.iter().map(|f| sharp(text(f, source, "cubic_means")));
        for ((frame, plain), sharp) in frames()
            .iter()
            .zip(&reprojected()[source - 1])
            .zip(pictures(texts))
        {
            let truth = reference(&frame.name);
            let interior = crate::common::frames::mask(&format!("interior_{}", frame.name));
            let [plain, sharp] =
                [plain, &sharp].map(|image| score(image, &truth, |i| interior[i] == 1.0));
            println!("{} {name}: {plain:.4} {sharp:.4}", frame.name);
            assert!(
                sharp <= plain,
                "{} {name}: relRMSE {sharp:.4} above {plain:.4}",
                frame.name
            );
            gains.push(plain / sharp);
        }
    }
    let mean = gains.iter().sum::<f64>() / gains.len() as f64;
    assert!(mean > 1.2, "{mean}: {gains:?}");
}

/// The formats that this program was built with, and the order of axes in each where it is not the usual one.
fn formats() -> Vec<(&'static str, Option<&'static str>)> {
    let mut formats = vec![
        ("array.npy", None),
        ("frames-first.npy", Some("T H W")),
        ("archive.npz", None),
        ("frames", Some("T H W")),
    ];
    if cfg!(feature = "hdf5") {
        formats.extend([("array.h5", None), ("frames-first.h5", Some("T H W"))]);
    }
    if cfg!(feature = "zarr") {
        formats.extend([("array.zarr", None), ("frames-first.zarr", Some("T H W"))]);
    }
    formats
}

/// A float of one byte per colour and a common exponent, as Radiance pictures have it: cut off to 8 bits.
fn rgbe(value: f64) -> [u8; 4] {
    if value <= 0.0 {
        return [0; 4];
    }
    // 2^(e − 1) ≤ value < 2^e.
    let e = value.log2().floor() as i32 + 1;
    let mantissa = (value * 2f64.powi(8 - e)) as u8;
    [mantissa, mantissa, mantissa, (e + 128) as u8]
}

/// The samples of `cube`, a pixel after another, times `scale`.
fn samples(cube: &Cube, scale: f64) -> Vec<f64> {
    let count = cube.shape.iter().product();
    (0..count)
        .map(|n| scale * cube.samples.get(n).unwrap())
        .collect()
}

/// Streaks, a picture per row with time along x; the scale of samples that they want.
fn streaks(cube: &Cube, to: &Path) -> f64 {
    let [h, w, t, _] = cube.shape;
    let samples = samples(cube, 1.0);
    for row in 0..h {
        let mut bytes =
            format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {w} +X {t}\n").into_bytes();
        bytes.extend(
            samples[row * w * t..][..w * t]
                .iter()
                .flat_map(|value| rgbe(*value)),
        );
        std::fs::write(to.join(format!("row_{row:04}.hdr")), bytes).unwrap();
    }
    1.0
}

/// Frames of 16 bits per sample, in proportion.
fn png_frames(cube: &Cube, to: &Path) -> f64 {
    let [h, w, t, _] = cube.shape;
    let samples = samples(cube, 1.0);
    let brightest = samples.iter().copied().fold(0.0, f64::max);
    for bin in 0..t {
        let file = std::fs::File::create(to.join(format!("{bin:03}.png"))).unwrap();
        let mut encoder = png::Encoder::new(file, w as u32, h as u32);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::Sixteen);
        let codes =
            (0..h * w).map(|pixel| (samples[pixel * t + bin] / brightest * 65535.0).round() as u16);
        let bytes: Vec<u8> = codes.flat_map(u16::to_be_bytes).collect();
        encoder
            .write_header()
            .unwrap()
            .write_image_data(&bytes)
            .unwrap();
    }
    brightest
}

/// Frames of floating-point samples.
#[cfg(feature = "tiff")]
fn tiff_frames(cube: &Cube, to: &Path) -> f64 {
    let [h, w, t, _] = cube.shape;
    let samples = samples(cube, 1.0);
    for bin in 0..t {
        let file = std::fs::File::create(to.join(format!("{bin:03}.tif"))).unwrap();
        let frame: Vec<f32> = (0..h * w)
            .map(|pixel| samples[pixel * t + bin] as f32)
            .collect();
        let mut encoder = tiff::encoder::TiffEncoder::new(file).unwrap();
        encoder
            .write_image::<tiff::encoder::colortype::Gray32Float>(w as u32, h as u32, &frame)
            .unwrap();
    }
    1.0
}

/// A transient image of the University of Bonn, version 1.
fn transient_image(cube: &Cube, to: &Path) -> f64 {
    let [h, w, t, _] = cube.shape;
    let mut bytes = b"TI01".to_vec();
    bytes.extend([t, w, h].into_iter().flat_map(|n| (n as u32).to_le_bytes()));
    bytes.extend([0f32, t as f32].into_iter().flat_map(f32::to_le_bytes));
    bytes.extend(
        samples(cube, 1.0)
            .into_iter()
            .flat_map(|value| (value as f32).to_le_bytes()),
    );
    std::fs::write(to.join("image.ti"), bytes).unwrap();
    1.0
}

/// A way to write a cube into a folder that gives the scale of its samples; the name of its files, and the keys of sources that read them.
type Written = (fn(&Cube, &Path) -> f64, &'static str, &'static str);

/// Formats of eight or sixteen bits, which round samples: from each, every frame is within its limit, and the sharp reconstruction at least as good as the
/// plain one.
#[test]
fn frames_from_formats_that_round_samples_match_the_transient_renderer() {
    let ways: [Written; 2] = [
        (streaks, "row_%04d.hdr", "axes = \"H W T\""),
        (png_frames, "{i:03d}.png", "transfer = \"linear\""),
    ];
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (name, cube) = SOURCES[2];
    let file = cube.split('"').nth(1).unwrap();
    let whole = nullray::io::cube::load(&root.join(file), Wanted::default()).unwrap();
    for (write, files, key) in ways {
        let folder = tempfile::tempdir().unwrap();
        let scale = write(&whole, folder.path());
        let path = folder.path().join(files);
        let plain = |frame: &Frame| {
            text(frame, 2, "cubic_means")
                .replace(file, path.to_str().unwrap())
                .replace("filter =", &format!("{key}\nscale = {scale:?}\nfilter ="))
        };
        let plains = pictures(frames().iter().map(plain));
        let sharps = pictures(frames().iter().map(|frame| sharp(plain(frame))));
        for ((frame, plain), sharp) in frames().iter().zip(plains).zip(sharps) {
            let truth = reference(&frame.name);
            let interior = crate::common::frames::mask(&format!("interior_{}", frame.name));
            let [plain, sharp] =
                [plain, sharp].map(|image| score(&image, &truth, |i| interior[i] == 1.0));
            let limit = 1.25 * frame.limit.camera_interior + 0.003;
            assert!(
                plain <= limit && sharp <= plain,
                "{} {name} {files}: relRMSE {plain:.4} and {sharp:.4}, limit {limit:.4}",
                frame.name
            );
        }
    }
}

/// The samples of the cube of the scene `text` as bits, and those of its picture with one sample per pixel.
fn bits(text: &str) -> [Vec<u64>; 2] {
    let scene = parsed(&text.replace("samples_per_pixel = 16", "samples_per_pixel = 1"));
    let plan = Plan::new(&scene, &Request::default()).unwrap();
    let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    let cube = samples(prepared.cubes()[0].cube().in_memory().unwrap(), 1.0);
    let film = render(&prepared, &Silent).unwrap();
    let picture = film.radiance().iter().map(|rgb| rgb[0]).collect();
    [cube, picture].map(|values: Vec<f64>| values.into_iter().map(f64::to_bits).collect())
}

/// A cube has the same bits whatever holds it, and so has a picture: what holds of one format holds of all. And it is within the
/// limit of the frame.
#[test]
fn captures_are_the_same_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let frame = &frames()[0];
    for source in [1, 2] {
        let (name, cube) = SOURCES[source];
        let file = cube.split('"').nth(1).unwrap();
        let plain = sharp(text(frame, source, "cubic_means"));
        let whole = picture(&plain);
        let interior = crate::common::frames::mask(&format!("interior_{}", frame.name));
        let limit = match source {
            1 => frame.limit.world_interior,
            _ => frame.limit.camera_interior,
        };
        let limit = 1.25 * limit + 0.003;
        let got = score(&whole, &reference(&frame.name), |i| interior[i] == 1.0);
        assert!(got <= limit, "{name}: relRMSE {got:.4} above {limit:.4}");
        let expected = bits(&plain);
        assert!(expected.iter().all(|bits| bits.iter().any(|b| *b != 0)));
        for (target, axes) in formats() {
            let to = folder.path().join(format!("{name}-{target}"));
            let root = Path::new(env!("CARGO_MANIFEST_DIR"));
            let is_array = target.contains('.');
            let changes = Changes {
                axes: axes.filter(|_| is_array).map(|axes| axes.parse().unwrap()),
                ..Changes::default()
            };
            let from = (root.join(file), Wanted::default());
            convert((&from.0, from.1), &to, &changes, &mut |_, _| true).unwrap();
            let mut converted = plain.replace(file, to.to_str().unwrap());
            if let Some(axes) = axes {
                converted = converted.replace("filter =", &format!("axes = \"{axes}\"\nfilter ="));
            }
            assert!(bits(&converted) == expected, "{name} {target}");
        }
        // Formats of single precision that this program does not write.
        let whole = nullray::io::cube::load(
            &Path::new(env!("CARGO_MANIFEST_DIR")).join(file),
            Wanted::default(),
        )
        .unwrap();
        let others: &[Written] = &[
            (transient_image, "image.ti", ""),
            #[cfg(feature = "tiff")]
            (tiff_frames, "{i:03d}.tif", ""),
        ];
        for (write, files, _) in others {
            let to = folder
                .path()
                .join(format!("{name}-{}", &files[files.len() - 2..]));
            std::fs::create_dir(&to).unwrap();
            write(&whole, &to);
            let written = plain.replace(file, to.join(files).to_str().unwrap());
            assert!(bits(&written) == expected, "{name} {files}");
        }
    }
}

#[test]
fn a_second_camera_at_rest_sees_the_cube_that_the_transient_renderer_made_for_it() {
    // Bin k of the reference holds the energy that arrives in [7.85 + 0.05 k, 7.85 + 0.05 (k + 1)] m; a
    // picture at the bin's centre is its density, value/0.05, to second order in the width.
    let path = crate::common::frames::data("reference_cube.npz");
    let [height, width, bins, _] = nullray::io::cube::load(&path, Default::default())
        .unwrap()
        .shape;
    assert_eq!([height, width, bins], [64, 64, 183]);
    let values = crate::common::arrays::array_at(&path, "radiance");
    let slice = |k: usize| values.iter().skip(k).step_by(bins).map(|v| v / 0.05);
    let energy = |k: &usize| slice(*k).map(|v| v * v).sum::<f64>();
    let brightest = (0..bins).max_by(|a, b| energy(a).total_cmp(&energy(b)));
    let brightest = brightest.unwrap();
    let slices = [-20, -10, 0, 10, 20].map(|off| brightest.checked_add_signed(off).unwrap());
    let at = |k: usize| {
        let camera = Frame {
            eye: [0.3, 3.4, 6.0],
            forward: [-0.7, -2.5, -6.6],
            hfov: 45.0,
            beta: [0.0; 3],
            time: 7.85 + 0.05 * (k as f64 + 0.5),
            ..frames()[0].clone()
        };
        text(&camera, 0, "cubic_means").replace("[96, 96]", "[64, 64]")
    };
    let (mut got, mut truth) = (Vec::new(), Vec::new());
    for (k, image) in slices.into_iter().zip(pictures(slices.map(at))) {
        got.extend(image);
        truth.extend(slice(k));
        // Alone, a slice a metre from the brightest has a tenth of its energy and more of the noise.
        let last = got.len() - 64 * 64..;
        let alone = score(&got[last.clone()], &truth[last], everywhere);
        assert!(alone <= 0.03, "bin {k} of {slices:?}: relRMSE {alone:.4}");
    }
    let all = score(&got, &truth, everywhere);
    assert!(all <= 0.025, "bins {slices:?}: relRMSE {all:.4}");
}

#[test]
fn without_retardation_every_frame_is_wrong() {
    let wrong = |frame: &Frame| {
        text(frame, 0, "cubic").replace(
            "searchlight = false",
            "searchlight = false\nretardation = false",
        )
    };
    let images = pictures(frames().iter().map(wrong));
    for (frame, image) in frames().iter().zip(images) {
        let got = score(&image, &reference(&frame.name), everywhere);
        assert!(got > 0.6, "{}: {got:.4}", frame.name);
    }
}

#[test]
fn with_reversed_or_no_aberration_every_moving_frame_is_wrong() {
    let mut moving = frames();
    moving.retain(|frame| frame.beta != [0.0; 3]);
    let reversed = |frame: &Frame| {
        let reversed = Frame {
            beta: frame.beta.map(|b| -b),
            ..frame.clone()
        };
        text(&reversed, 0, "cubic")
    };
    let none = |frame: &Frame| {
        text(frame, 0, "cubic").replace(
            "searchlight = false",
            "searchlight = false\naberration = false",
        )
    };
    for images in [
        pictures(moving.iter().map(reversed)),
        pictures(moving.iter().map(none)),
    ] {
        for (frame, image) in moving.iter().zip(images) {
            let got = score(&image, &reference(&frame.name), everywhere);
            assert!(got > 0.6, "{}: {got:.4}", frame.name);
        }
    }
}

#[test]
fn taking_depth_for_distance_would_be_noticed() {
    // Depth along the optical axis in place of distance: the retarded time of a pixel at angle θ from
    // the axis is late by r(1 − cos θ). Planted here by the angle at which it is largest.
    for frame in frames().iter().filter(|f| f.beta == [0.0; 3]) {
        let truth = reference(&frame.name);
        let times = depth_for_distance(frame);
        let got = score(&times, &truth, everywhere);
        assert!(got > 0.6, "{}: {got:.4}", frame.name);
    }
}

/// The frame as a renderer shows it that delays light by depth: pixel by pixel, the camera clock is
/// set ahead by the difference.
fn depth_for_distance(frame: &Frame) -> Vec<f64> {
    use nullray::render::aov::Aov;
    let base = text(frame, 0, "cubic").replace("samples_per_pixel = 16", "samples_per_pixel = 1");
    let scene = parsed(&base);
    let request = Request {
        aovs: vec![
            Aov::Distance,
            Aov::DirectionX,
            Aov::DirectionY,
            Aov::DirectionZ,
        ],
        pixel_centers: true,
        ..Request::default()
    };
    let plan = Plan::new(&scene, &request).unwrap();
    let mut prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    let seen = render(&prepared, &Silent).unwrap();
    let aov = |a| seen.aov(a).unwrap();
    let forward = scene.camera.axes[2];
    let late: Vec<f64> = (0..aov(Aov::Distance).len())
        .map(|i| {
            let d = glam::DVec3::new(
                aov(Aov::DirectionX)[i],
                aov(Aov::DirectionY)[i],
                aov(Aov::DirectionZ)[i],
            );
            aov(Aov::Distance)[i] * (1.0 - d.dot(forward))
        })
        .collect();
    // One rendering per step of lateness; each pixel takes the nearest.
    let step = 0.05;
    let steps = late
        .iter()
        .copied()
        .filter(|l| l.is_finite())
        .fold(0.0, f64::max)
        / step;
    let films: Vec<_> = (0..=steps.ceil() as usize)
        .map(|k| {
            let mut later = scene.clone();
            later.camera.time += k as f64 * step;
            prepared.retake(&later).unwrap();
            render(&prepared, &Silent).unwrap()
        })
        .collect();
    late.iter()
        .enumerate()
        .map(|(i, l)| {
            if l.is_finite() {
                films[(l / step).round() as usize].radiance()[i][0]
            } else {
                0.0
            }
        })
        .collect()
}
