//! What is fuzzed: each target is a function of bytes that must come back with a result or an error, soon, without a panic
//! and without much memory. `tests/fuzz` replays the corpus and runs the farm; `fuzz_targets` gives the same functions to libFuzzer.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use nullray::accel::Precision;
use nullray::approximate::raster::{self, Method};
use nullray::figures::diagram;
use nullray::figures::drawing::svg;
use nullray::figures::isochrones::{self, IsochroneOptions};
use nullray::figures::overlay::{self, Overlay, Parts};
use nullray::io::budget::Budget;
use nullray::io::cube::{self, Bricks, Held, Wanted};
use nullray::io::gltf::{self, Want};
use nullray::io::image::{Layers, RgbImage, Texture, exr, hdr, png};
use nullray::io::{colmap, npy, spectrum};
use nullray::render::aov::{self, Aov};
use nullray::render::bake::{self, Bins, Coordinates, CubePrecision, Surface};
use nullray::render::film::Film;
use nullray::render::metadata::metadata;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::render::tonemap::tonemap;
use nullray::scene::model::{BadTextures, BadVertices, Scene};
use nullray::scene::{self, Overrides, SceneFile};
use nullray::text::RichText;
use nullray::validate::compare::{Encoding, Picture, Tolerance};

/// A target: its name, which is that of its folder of the corpus, and the extension of its files.
pub struct Target {
    pub name: &'static str,
    pub extension: &'static str,
    pub run: fn(&[u8]),
}

pub const TARGETS: [Target; 19] = [
    Target {
        name: "cube_npy",
        extension: "npy",
        run: cube_npy,
    },
    Target {
        name: "cube_npz",
        extension: "npz",
        run: cube_npz,
    },
    Target {
        name: "cube_ti",
        extension: "ti",
        run: cube_ti,
    },
    Target {
        name: "cube_hdf5",
        extension: "hdf5",
        run: cube_hdf5,
    },
    Target {
        name: "cube_zarr",
        extension: "chunk",
        run: cube_zarr,
    },
    Target {
        name: "colmap",
        extension: "bin",
        run: pose_of_colmap,
    },
    Target {
        name: "frame_tiff",
        extension: "tif",
        run: frame_tiff,
    },
    Target {
        name: "gltf",
        extension: "glb",
        run: gltf,
    },
    Target {
        name: "texture",
        extension: "png",
        run: texture,
    },
    Target {
        name: "scene",
        extension: "toml",
        run: scene,
    },
    Target {
        name: "picture",
        extension: "toml",
        run: picture,
    },
    Target {
        name: "diagram",
        extension: "toml",
        run: diagram,
    },
    Target {
        name: "override",
        extension: "txt",
        run: override_of_scene,
    },
    Target {
        name: "picture_png",
        extension: "png",
        run: picture_png,
    },
    Target {
        name: "picture_exr",
        extension: "exr",
        run: picture_exr,
    },
    Target {
        name: "picture_npz",
        extension: "npz",
        run: picture_npz,
    },
    Target {
        name: "picture_hdr",
        extension: "hdr",
        run: picture_hdr,
    },
    Target {
        name: "spectrum",
        extension: "csv",
        run: spectrum,
    },
    Target {
        name: "texts",
        extension: "txt",
        run: texts,
    },
];

/// What readers of pictures may take: more than honest small files need, and less than the farm counts as a finding.
const MEMORY: u64 = 64 << 20;

fn cube_npy(bytes: &[u8]) {
    let _ = cube::load_bytes(bytes, "fuzzed.npy", Wanted::default());
}

fn cube_npz(bytes: &[u8]) {
    let _ = cube::load_bytes(bytes, "fuzzed.npz", Wanted::default());
    let _ = cube::load_bytes(bytes, "fuzzed.npz", Wanted::array("cube"));
}

fn cube_ti(bytes: &[u8]) {
    let _ = cube::load_bytes(bytes, "fuzzed.ti", Wanted::default());
}

/// Loads a cube that is not too large by its own word, as commands do.
fn load_small(path: &Path, wanted: Wanted) {
    if cube::inspect(path, wanted).is_ok_and(|info| info.bytes < MEMORY) {
        let _ = cube::load(path, wanted);
        // Part by part, where it has places to be read at.
        const ROOM: u64 = 64 << 20;
        if let Ok(Some(_)) = Bricks::counting(path, wanted, ROOM)
            && let Ok(bricks) = Bricks::open(path, wanted, ROOM)
        {
            let [h, w, bins, channels] = bricks.shape();
            let mut line = vec![0.0; bins.min(1000) * channels];
            for pixel in [0, h * w / 2, h * w - 1] {
                bricks.samples(&mut Held::default(), pixel, 0, &mut line);
            }
            let _ = bricks.check();
        }
    }
}

/// Refused as a whole where the feature is off.
fn cube_hdf5(bytes: &[u8]) {
    with_file("hdf5", bytes, |path| {
        load_small(path, Wanted::default());
        load_small(path, Wanted::array("storage/gzip"));
        let _ = cube::wall(path, Wanted::default());
        let _ = cube::times(path, None);
    });
}

/// A shard of compressed chunks, and the same bytes as the description of an array.
fn cube_zarr(bytes: &[u8]) {
    const SHARDS: &str = include_str!("../../tests/data/zarr/sharded/zarr.json");
    let folder = folder().join("zarr");
    let write = |name: &str, bytes: &[u8]| {
        std::fs::write(folder.join(name), bytes).expect("a file can be written");
    };
    std::fs::create_dir_all(folder.join("c/0/0/0")).expect("a folder can be made");
    write("zarr.json", SHARDS.as_bytes());
    write("c/0/0/0/0", bytes);
    load_small(&folder, Wanted::default());
    write("zarr.json", bytes);
    load_small(&folder, Wanted::default());
    cube_zarr_2(bytes);
}

/// The same bytes as a chunk in Blosc, and as the description of an array of version 2.
fn cube_zarr_2(bytes: &[u8]) {
    const BLOSC: &str = include_str!("../../tests/data/zarr/v2/.zarray");
    let folder = folder().join("zarr-2");
    let write = |name: &str, bytes: &[u8]| {
        std::fs::write(folder.join(name), bytes).expect("a file can be written");
    };
    std::fs::create_dir_all(&folder).expect("a folder can be made");
    write(".zarray", BLOSC.as_bytes());
    write("0.0.0", bytes);
    load_small(&folder, Wanted::default());
    write(".zarray", bytes);
    load_small(&folder, Wanted::default());
}

/// Images and cameras of a reconstruction, as binary files and as texts.
fn pose_of_colmap(bytes: &[u8]) {
    const CAMERA: &[u8] = b"1 PINHOLE 640 480 320 320 320 240\n";
    const IMAGE: &[u8] = b"1 1 0 0 0 0 0 0 1 a\n\n";
    let Ok(folder) = tempfile::tempdir() else {
        return;
    };
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).is_ok();
    for [images, cameras] in [[bytes, CAMERA], [IMAGE, bytes]] {
        if write("images.txt", images) && write("cameras.txt", cameras) {
            let _ = colmap::pose(folder.path(), "a");
        }
    }
    for name in ["cameras.bin", "images.bin"] {
        if write(name, bytes) {
            let _ = colmap::pose(folder.path(), "a");
        }
    }
}

fn frame_tiff(bytes: &[u8]) {
    with_file("tif", bytes, |path| {
        let pattern = path.with_file_name(match path.file_name().and_then(|name| name.to_str()) {
            Some(name) => format!("{}#.tif", name.trim_end_matches(".tif")),
            None => return,
        });
        let frame = pattern.with_file_name(
            pattern
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .replace('#', "1"),
        );
        if std::fs::copy(path, &frame).is_ok() {
            let wanted = Wanted {
                transfer: Some(cube::Transfer::Linear),
                ..Wanted::default()
            };
            load_small(&pattern, wanted);
            let _ = std::fs::remove_file(&frame);
        }
    });
}

fn gltf(bytes: &[u8]) {
    for (bad_vertices, bad_textures) in [
        (BadVertices::Refuse, BadTextures::Refuse),
        (BadVertices::Drop, BadTextures::Drop),
    ] {
        let want = Want {
            uvs: true,
            textures: true,
            shading: true,
            normals: true,
            bad_vertices,
            bad_textures,
        };
        let Ok(imported) = gltf::load_bytes(bytes, "fuzzed.glb", None, want) else {
            continue;
        };
        // What is imported is sound.
        let mesh = imported.mesh;
        let vertices = mesh.positions.len();
        assert!(
            mesh.triangles
                .iter()
                .flatten()
                .all(|&v| (v as usize) < vertices)
        );
        assert!(mesh.positions.iter().all(|p| p.is_finite()));
        assert!(
            mesh.parts
                .iter()
                .all(|p| (p.material as usize) < mesh.materials.len())
        );
    }
}

fn texture(bytes: &[u8]) {
    let _ = Texture::decode(bytes, "image", Path::new("fuzzed"));
}

/// A text that is a scene, or says why it is none in a report that is not long.
fn scene(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    if let Err(error) = scene::parse(&text, "fuzzed.toml", Path::new("."), &Overrides::default()) {
        check_report(&error);
    }
}

/// What pictures of a few pixels may take, bytes.
const MEMORY_OF_PICTURE: u64 = 256 << 20;

/// A scene, planned, prepared and rendered in a few pixels: by the ray tracer, and by another way of which the text decides, if it can be.
fn picture(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let overrides = Overrides {
        size: Some([6, 4]),
        samples_per_pixel: Some(1),
        ..Overrides::default()
    };
    let file = SceneFile::of_text(&text, "fuzzed.toml", Path::new("scenes"));
    let hash = bytes.iter().fold(17u64, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3)
    });
    if text.contains("diagram") {
        diagram(bytes);
    }
    let checked = file.scene(&overrides).and_then(|scene| {
        pictures_of(&scene, hash)?;
        for panel in scene.panels.iter().take(2) {
            pictures_of(&file.panel(&scene, panel, &overrides)?, hash)?;
        }
        Ok(())
    });
    if let Err(error) = checked {
        check_report(&error);
    }
}

/// Ways to a picture beside the ray tracer.
const METHODS: [&str; 6] = [
    "raster:none",
    "raster:uniform=0.5",
    "raster:adaptive=0.5",
    "raster:none,attributes=vertex",
    "warp:cube=8",
    "warp:panorama=16x8,lookup=nearest",
];

fn pictures_of(scene: &Scene, hash: u64) -> nullray::Result<()> {
    let one_in = |n: u64, bits: u32| (hash >> bits).is_multiple_of(n);
    let request = Request {
        aovs: match one_in(2, 8) {
            true => Aov::ALL.to_vec(),
            false => vec![Aov::EventCt, Aov::Object],
        },
        pixel_centers: scene.camera.shutter.is_none() && one_in(4, 12),
        precision: match one_in(4, 16) {
            true => Precision::Fast,
            false => Precision::Certified,
        },
        memory_limit: MEMORY_OF_PICTURE,
        ..Request::default()
    };
    let plan = Plan::new(scene, &request)?;
    let _ = plan.to_string();
    let mut prepared = Prepared::new(scene, &plan, &Silent)?;
    let film = render(&prepared, &Silent)?;
    let [width, height] = film.size();
    if one_in(8, 20) {
        // The same bits on other numbers of threads.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build();
        let again = pool.map(|pool| pool.install(|| render(&prepared, &Silent)));
        if let Ok(again) = again {
            let bits = |film: &Film| -> Vec<u64> {
                let all = film.radiance().iter().flatten();
                all.map(|x| x.to_bits()).collect()
            };
            assert!(bits(&film) == bits(&again?), "other bits on three threads");
        }
    }
    let shown = tonemap(film.radiance(), scene.exposure);
    let words = metadata(scene, &film)?;
    drop(Layers::new(
        width,
        height,
        film.channels(&request.aovs),
        words,
    ));
    if let Some(ct) = film.aov(Aov::EventCt) {
        let _ = isochrones::draw(width, height, ct, &IsochroneOptions::default());
    }
    let _ = isochrones::draw_radiance(width, height, film.radiance(), "β", None);
    if one_in(3, 24) && Overlay::check(scene).is_ok() && shown.is_ok() {
        let parts = Parts::default();
        let seen = overlay::apparent(&mut prepared, parts, &Silent)?;
        let there = overlay::instantaneous(scene, &mut prepared, &Silent)?;
        let traced = Overlay::trace(scene, Some(&seen), Some(&there), parts, None)?;
        let image = RgbImage {
            width,
            height,
            rgb: vec![0; 3 * width as usize * height as usize],
        };
        let _ = traced
            .drawing(&scene.name, image)
            .and_then(|page| svg::write(&page));
    }
    if one_in(3, 28) {
        let bins = Bins {
            start: 0.0,
            width: 0.5,
            count: 8,
        };
        let _ = bake::camera_cube(
            scene,
            &prepared,
            &bins,
            CubePrecision::Single,
            None,
            &Silent,
        );
        let surface = Surface {
            object: 0,
            coordinates: match one_in(2, 32) {
                true => Coordinates::Set(0),
                false => Coordinates::Atlas,
            },
            size: [24, 24],
        };
        let _ = bake::surface_cube(
            scene,
            &prepared,
            &surface,
            &bins,
            CubePrecision::Single,
            None,
            &Silent,
        );
    }
    drop(prepared);
    let method = METHODS[(hash >> 36) as usize % METHODS.len()];
    let Ok(method) = method.parse::<Method>() else {
        return Ok(());
    };
    let plan = method.plan(scene, &request)?;
    let prepared = Prepared::new(scene, &plan, &Silent)?;
    raster::render(&prepared, &method, &Silent).map(drop)
}

fn check_report(error: &nullray::Error) {
    let report = error.report(false);
    let is_harmful = |c: char| c.is_control() && c != '\n';
    assert!(!report.contains(is_harmful), "{report:?}");
    assert!(report.len() < 100_000, "{} bytes of report", report.len());
}

fn diagram(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    match diagram::parse(&text, "fuzzed.toml", Path::new("."), &Overrides::default()) {
        Ok(model) => drop(diagram::draw(&diagram::layout(&model), &model.style)),
        Err(error) => check_report(&error),
    }
}

/// `KEY=VALUE`, set in a scene that has the tables.
fn override_of_scene(bytes: &[u8]) {
    const SCENE: &str = include_str!("../../scenes/dice.toml");
    let text = String::from_utf8_lossy(bytes);
    let Some((key, value)) = text.split_once('=') else {
        return;
    };
    let overrides = Overrides {
        set: vec![(key.into(), value.into())],
        ..Overrides::default()
    };
    if let Err(error) = scene::parse(SCENE, "dice.toml", Path::new("scenes"), &overrides) {
        check_report(&error);
    }
}

fn picture_png(bytes: &[u8]) {
    with_file("png", bytes, |path| {
        let _ = png::inspect(path);
        let _ = png::read(path, &Budget::new(MEMORY));
    });
}

fn picture_exr(bytes: &[u8]) {
    with_file("exr", bytes, |path| {
        let _ = exr::half_channels(path);
        let _ = exr::read(path, &Budget::new(MEMORY));
    });
}

fn picture_npz(bytes: &[u8]) {
    with_file("npz", bytes, |path| {
        let _ = npy::inspect(path, None);
        let _ = Picture::read(path, Encoding::Linear, &Budget::new(MEMORY));
    });
}

fn picture_hdr(bytes: &[u8]) {
    let read = hdr::read(bytes, Path::new("fuzzed.hdr"), &Budget::new(MEMORY));
    if let Ok(([width, height], pixels)) = read {
        assert_eq!(pixels.len(), width * height);
    }
}

fn spectrum(bytes: &[u8]) {
    let _ = spectrum::parse(&String::from_utf8_lossy(bytes), Path::new("fuzzed.csv"));
}

/// Everything on a command line that has a grammar of its own.
fn texts(bytes: &[u8]) {
    use nullray::spacetime::units::{Acceleration, Angle, Length, Percentage, Speed, Time};
    let text = &*String::from_utf8_lossy(bytes);
    let _ = aov::parse(text);
    let _ = Parts::parse(text);
    let _ = text.parse::<Tolerance>();
    let _ = text.parse::<Time>();
    let _ = text.parse::<Length>();
    let _ = text.parse::<Speed>();
    let _ = text.parse::<Angle>();
    let _ = text.parse::<Acceleration>();
    let _ = text.parse::<Percentage>();
    if let Ok(method) = text.parse::<Method>() {
        // What is read is said so that it is read again.
        assert_eq!(method.to_string().parse::<Method>().as_ref(), Ok(&method));
    }
    if let Ok(rich) = RichText::parse(text) {
        let _ = rich.width(10.0);
    }
}

/// A folder of this thread's own for all inputs, in memory where the system has a folder there.
fn folder() -> PathBuf {
    thread_local! {
        static FOLDER: RefCell<Option<tempfile::TempDir>> = const { RefCell::new(None) };
    }
    FOLDER.with_borrow_mut(|folder| {
        let in_memory = Path::new("/dev/shm");
        let made = folder.get_or_insert_with(|| {
            let made = tempfile::tempdir_in(in_memory).or_else(|_| tempfile::tempdir());
            made.expect("a folder can be made")
        });
        made.path().to_path_buf()
    })
}

/// Readers that want a file get one.
fn with_file(extension: &str, bytes: &[u8], read: impl FnOnce(&Path)) {
    let path = folder().join(format!("fuzzed.{extension}"));
    std::fs::write(&path, bytes).expect("a file can be written");
    read(&path);
}
