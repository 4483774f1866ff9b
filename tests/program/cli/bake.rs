//! `nullray bake`: the file that it writes is a source as described.

use glam::DVec3;
use nullray::io::budget::Budget;
use nullray::io::cube::{self, Wanted};
use nullray::io::gltf;
use nullray::io::image::exr;
use nullray::mesh::Mesh;
use serde_json::json;

use super::Folder;

/// A floor and a flash.
pub(super) const FLASH: &str = r#"
[camera]
eye = [0, 2, 4]
look_at = [0, 0, 0]
hfov = "50 deg"
size = [24, 18]
time = "7 m"
[[object]]
name = "floor"
shape = { plane = { size = [4, 4] } }
"#;

pub(super) const LIGHT: &str = r#"
[[light]]
position = [0.5, 1.5, 0]
intensity = 5
emission = { gaussian = { sigma = "30 cm" } }
"#;

/// That two scenes of a folder have the same mean, to 2 %.
pub(super) fn assert_as_bright(folder: &Folder, a: &str, b: &str) {
    let [a, b] = [a, b].map(|scene| {
        folder.ok(&["render", scene, "-o", "a.exr", "--spp", "16", "-q"]);
        let layers = exr::read(&folder.path("a.exr"), &Budget::new(1 << 30)).unwrap();
        let radiance = layers.radiance().unwrap();
        radiance.iter().map(|rgb| rgb[0]).sum::<f64>() / radiance.len() as f64
    });
    assert!(b > 0.0 && (a / b - 1.0).abs() < 0.02, "{a} {b}");
}

#[test]
fn a_scene_says_how_to_make_a_file_that_is_not_there() {
    let folder = Folder::empty();
    let scene = |first: &str| {
        format!(
            "{first}{FLASH}[[source]]\ncube = {{ file = \"light.npz\", bin_width = \"1 m\" }}\n"
        )
    };
    let remedy = "if_missing = \"nullray bake lit.toml -o light.npz\"\n";
    folder.write("a.toml", scene(remedy));
    folder.write("b.toml", scene(""));
    let [a, b] = ["a.toml", "b.toml"].map(|name| folder.run(&["render", name]));
    for run in [&a, &b] {
        assert_eq!(run.code, 2);
        assert!(run.message().contains("cannot find this file"));
        assert!(run.message().contains("paths are relative"));
    }
    let said = "the scene says: nullray bake lit.toml -o light.npz";
    assert!(a.message().contains(said), "{}", a.message());
    assert!(!b.message().contains("the scene says"), "{}", b.message());
    // Files that are there and are no cubes have other remedies.
    folder.write("light.npz", "no archive");
    let run = folder.run(&["render", "a.toml"]);
    assert!(run.code == 2 && !run.message().contains("the scene says"));
    // Pictures of a sequence, too.
    for pictures in ["frames/{i:03d}.exr", "frame-%04d.exr"] {
        folder.write(
            "a.toml",
            scene(remedy).replace("light.npz\", b", &format!("{pictures}\", b")),
        );
        let run = folder.run(&["render", "a.toml"]);
        assert_eq!(run.code, 2);
        assert!(run.message().contains(said), "{}", run.message());
    }
    // Words that say nothing are refused.
    folder.write("a.toml", scene("if_missing = \" \"\n"));
    let run = folder.run(&["render", "a.toml"]);
    assert!(run.code == 2 && run.message().contains("what to do is empty"));
}

#[test]
fn baked_scenes_say_how_their_light_is_baked() {
    let folder = Folder::empty();
    for name in ["rabbit", "dragon", "tomatoes"] {
        let text = |file: &str| {
            let path = super::repository(&format!("scenes/baked/{file}.toml"));
            std::fs::read_to_string(path).unwrap()
        };
        // The command at the head of the scene that is baked.
        let lit = text(&format!("{name}-lit"));
        let mut lines = lit.lines();
        let command = lines.find_map(|line| line.strip_prefix("#   ")).unwrap();
        let start = format!("nullray bake scenes/baked/{name}-lit.toml ");
        assert!(command.starts_with(&start), "{command}");
        folder.write("scene.toml", text(name));
        let run = folder.run(&["render", "scene.toml"]);
        assert_eq!(run.code, 2, "{name}");
        assert!(run.message().contains(command), "{}", run.message());
    }
}

#[test]
fn what_bake_prints_reads_what_it_has_written() {
    for (options, file) in [
        (["--camera", "--spp=16"], "cube.npy"),
        (["--texels=32x32", "--spp=4"], "floor.npy"),
        (["--camera", "--spp=16"], "cube.npz"),
        (["--texels=32x32", "--spp=4"], "floor.npz"),
    ] {
        let folder = Folder::empty();
        folder.write("lit.toml", FLASH.to_string() + LIGHT);
        let bins = ["--start=-2 m", "--bin-width=10 cm", "--bins=150"];
        let arguments = [&["bake", "lit.toml", "-o", file], &options[..], &bins].concat();
        let said = folder.ok(&arguments);
        assert!(said.starts_with(&format!("wrote {file}: ")), "{said}");
        assert!(said.contains("light arrives between"), "{said}");
        assert!(said.contains("standard error of a bin"), "{said}");
        assert!(!said.contains("warning"), "{said}");
        assert!(!folder.path(&format!("{file}.parts")).exists());
        // So does what `info` says of an archive.
        if file.ends_with(".npz") {
            let clock = match options[0] {
                "--camera" => "clock       capture",
                _ => "clock       world",
            };
            let info = folder.ok(&["info", file]);
            assert!(info.contains(clock), "{info}");
        }
        // The picture through the cube is that of the light itself, but for the width of its bins and texels.
        let source = said.split_once("\n\n").unwrap().1;
        folder.write("baked.toml", FLASH.to_string() + source);
        assert_as_bright(&folder, "baked.toml", "lit.toml");
    }
}

/// A floor and a box on it, which move with a camera and a lamp, and have clocks and origins of their own.
const TOGETHER: &str = r#"
[camera]
eye = [0, 0.9, 2]
look_at = [0, 0.2, 0]
hfov = "70 deg"
size = [48, 36]
velocity = { beta = [0.6, 0, 0] }
clock_zero = "0.7 m"
time = "3.5 m"
[[object]]
name = "floor"
shape = { plane = { size = [3, 3] } }
velocity = { beta = [0.6, 0, 0] }
origin = { position = [0, 0, 0], time = "0.7 m" }
[[object]]
name = "box"
shape = { box = { size = [0.5, 0.5, 0.5] } }
velocity = { beta = [0.6, 0, 0] }
origin = { position = [0.3, 0.25, 0.1], time = "0.1 m" }
"#;

#[test]
fn objects_with_clocks_of_their_own_read_a_camera_cube_by_their_own_sources() {
    let folder = Folder::empty();
    let lamp = "[[light]]\nposition = [0.7, 1.5, 1]\nclock_zero = \"0.2 m\"\nvelocity = { beta = [0.6, 0, 0] }\n\
                emission = { gaussian = { time = \"0.3 m\", sigma = \"30 cm\" } }\n";
    folder.write("lit.toml", format!("{TOGETHER}{lamp}"));
    let bake = [
        "--camera",
        "--spp=16",
        "--start=-1 m",
        "--bin-width=2 cm",
        "--bins=500",
    ];
    let said = folder.ok(&[&["bake", "lit.toml", "-o=a.npz"], &bake[..]].concat());
    let sources = said.split_once("\n\n").unwrap().1;
    assert_eq!(sources.matches("[[source]]").count(), 2, "{sources}");
    // In the frame of all, the origins are 0.6 m apart in world time and 0.3 m along the motion: γ(0.6 + β 0.3) m = 0.975 m.
    let starts = sources.split("start = \"").skip(1);
    let starts = starts.map(|text| text.split(" m").next().unwrap().parse::<f64>().unwrap());
    for (start, expected) in starts.zip([-1.0, -0.025]) {
        assert!((start - expected).abs() < 1e-12, "{sources}");
    }
    assert!(sources.contains("objects = [\"box\"]"), "{sources}");
    folder.write("baked.toml", format!("{TOGETHER}{sources}"));
    let plan = folder.ok(&["plan", "baked.toml"]);
    assert!(!plan.contains("which is used"), "{plan}");
    // The same bodies with one origin and one clock: the box is at γ(0.3 + β 0.6) m = 0.825 m in the coordinates of the floor.
    let origin = "origin = { position = [0.3, 0.25, 0.1], time = \"0.1 m\" }";
    let same = "origin = { position = [0, 0, 0], time = \"0.7 m\" }\ntransform = { translate = [0.825, 0.25, 0.1] }";
    assert!(TOGETHER.contains(origin));
    let one = TOGETHER.replace(origin, same);
    folder.write("one-lit.toml", format!("{one}{lamp}"));
    let said = folder.ok(&[&["bake", "one-lit.toml", "-o=b.npz"], &bake[..]].concat());
    let source = said.split_once("\n\n").unwrap().1;
    assert_eq!(source.matches("[[source]]").count(), 1, "{source}");
    folder.write("one.toml", format!("{one}{source}"));
    let [baked, lit, one] = ["baked.toml", "lit.toml", "one.toml"].map(|scene| {
        folder.ok(&["render", scene, "-o", "a.exr", "--spp", "16", "-q"]);
        let layers = exr::read(&folder.path("a.exr"), &Budget::new(1 << 30)).unwrap();
        layers.radiance().unwrap()
    });
    for (other, most) in [(lit, 0.1), (one, 1e-4)] {
        let (mut squares, mut all) = (0.0, 0.0);
        for (a, b) in baked.iter().flatten().zip(other.iter().flatten()) {
            squares += f64::powi(*a - *b, 2);
            all += f64::powi(*b, 2);
        }
        let error = f64::sqrt(squares / all);
        assert!(all > 0.0 && error < most, "{error} {most}");
    }
}

#[test]
fn an_archive_says_what_it_is_of_and_a_plan_what_it_takes() {
    let folder = Folder::empty();
    folder.write("lit.toml", FLASH.to_string() + LIGHT);
    let bake = [
        "bake",
        "lit.toml",
        "--texels=64x32",
        "--bin-width=10 cm",
        "--bins=150",
        "--spp=4",
    ];
    let said = folder.ok(&[&bake[..], &["--plan", "-o", "a.npz"]].concat());
    assert!(
        said.contains("a.npz: 32 rows × 64 columns × 150 bins, 3.5 MiB on disk, and as much again"),
        "{said}"
    );
    assert!(said.contains("memory"), "{said}");
    assert!(!folder.path("a.npz").exists());
    folder.ok(&[&bake[..], &["-o", "a.npz"]].concat());
    folder.ok(&[&bake[..], &["--half", "-o", "half.npz"]].concat());
    let said = folder.ok(&["info", "a.npz"]);
    assert!(
        said.contains("radiance") && said.contains("standard_error"),
        "{said}"
    );
    let length = |name: &str| folder.read(name).len();
    assert!(length("half.npz") < length("a.npz"));
    // What another bake has left is not taken for this one's.
    folder.write("a.npz.parts", "nullray parts 1\nand more");
    let said = folder.ok(&[&bake[..], &["-o", "a.npz"]].concat());
    assert!(!said.contains("resuming"), "{said}");
}

#[test]
fn an_atlas_is_written_with_the_light_and_read_by_the_object() {
    let folder = Folder::empty();
    let boxed = FLASH.replace("plane = { size = [4, 4] }", "box = { size = [4, 0.2, 4] }");
    folder.write("lit.toml", boxed.clone() + LIGHT);
    let bake = [
        "bake",
        "lit.toml",
        "--start=-2 m",
        "--bin-width=10 cm",
        "--bins=150",
        "--spp=4",
    ];
    // The faces of a box share their coordinates.
    for (options, words) in [
        (["--uv=0", "-o=light.npy"], "in an .npz file --atlas"),
        (["--uv=0", "-o=light.npz"], "charts overlap"),
        (["--uv=0", "-o=light.npz"], "--atlas"),
        (["--threads=2", "-o=light.npy"], "charts overlap"),
        (["--atlas", "-o=light.npy"], "end it in .npz"),
        (["--atlas", "--texels=6x6"], "--texels 9x9"),
        (["--threads=2", "--texels=6x6"], "--texels 9x9"),
        (["--threads=2", "--texels=1x1"], "--texels 9x9"),
    ] {
        let run = folder.run(&[&bake[..], &options].concat());
        assert_eq!(run.code, 2);
        assert!(run.message().contains(words), "{}", run.stderr);
    }
    // Without a word an atlas takes their place, which is said, and by a plan, too.
    let words = "object \"floor\": its charts overlap";
    let by_itself = [&bake[..], &["--texels=64x64", "-o=light.npz"]].concat();
    let planned = folder.ok(&[&by_itself[..], &["--plan"]].concat());
    let said = folder.ok(&by_itself);
    for said in [&planned, &said] {
        assert!(
            said.contains(words) && said.contains("an atlas takes their place"),
            "{said}"
        );
    }
    let bits = folder.read("light.npz");
    let said = folder.ok(&[&bake[..], &["--atlas", "--texels=64x64", "-o=light.npz"]].concat());
    assert!(!said.contains("overlap"), "{said}");
    assert!(bits == folder.read("light.npz"));
    let (_, tables) = said.split_once("\n\n").unwrap();
    let (_, key) = tables.split_once("# Give object \"floor\"\n# ").unwrap();
    let (key, source) = key.split_once('\n').unwrap();
    folder.write("baked.toml", format!("{boxed}{key}\n{source}"));
    assert_as_bright(&folder, "baked.toml", "lit.toml");
    // Another mesh is not the one of these coordinates.
    let other = boxed.replace("box = { size = [4, 0.2, 4] }", "plane = { size = [4, 4] }");
    folder.write("other.toml", format!("{other}{key}\n{source}"));
    let run = folder.run(&["render", "other.toml", "-o", "b.exr"]);
    assert_eq!(run.code, 2);
    let words = "its shape is [12, 3, 2], and object \"floor\" has 2 triangles";
    assert!(run.message().contains(words), "{}", run.stderr);
}

#[test]
fn a_second_set_of_texture_coordinates_is_taken_where_the_first_overlaps() {
    let folder = Folder::empty();
    // Two triangles of a floor. In set 0 they are the same.
    let corners = [
        [-2f32, 0.0, 2.0],
        [2.0, 0.0, 2.0],
        [2.0, 0.0, -2.0],
        [-2.0, 0.0, 2.0],
        [2.0, 0.0, -2.0],
        [-2.0, 0.0, -2.0],
    ];
    let first = [[0f32, 1.0], [1.0, 1.0], [1.0, 0.0]].repeat(2);
    let second = corners.map(|[x, _, z]| [(x + 2.0) / 4.0, (z + 2.0) / 4.0]);
    let numbers = corners
        .iter()
        .flatten()
        .chain(first.iter().flatten())
        .chain(second.iter().flatten());
    folder.write(
        "floor.bin",
        numbers.flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>(),
    );
    let accessor = |view: usize, kind: &str| json!({ "bufferView": view, "componentType": 5126, "count": 6, "type": kind, "min": corners[5], "max": corners[1] });
    let pair = |view: usize| json!({ "bufferView": view, "componentType": 5126, "count": 6, "type": "VEC2" });
    let view = |offset: usize, length: usize| json!({ "buffer": 0, "byteOffset": offset, "byteLength": length });
    let model = json!({
        "asset": { "version": "2.0" },
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1, "TEXCOORD_1": 2 }, "material": 0 }] }],
        "materials": [{ "pbrMetallicRoughness": { "metallicFactor": 0.0 } }],
        "accessors": [accessor(0, "VEC3"), pair(1), pair(2)],
        "bufferViews": [view(0, 72), view(72, 48), view(120, 48)],
        "buffers": [{ "byteLength": 168, "uri": "floor.bin" }],
    });
    folder.write("floor.gltf", model.to_string());
    let lit = FLASH.replace(
        "shape = { plane = { size = [4, 4] } }",
        "gltf = \"floor.gltf\"",
    ) + LIGHT;
    folder.write("lit.toml", lit);
    let bake = |options: &[&str]| {
        let bake = [
            "bake",
            "lit.toml",
            "--bin-width=50 cm",
            "--bins=20",
            "--spp=1",
            "--texels=16x16",
        ];
        folder.run(&[&bake[..], options].concat())
    };
    // Such coordinates need no .npz.
    let run = bake(&["-o=light.npy"]);
    assert_eq!(run.code, 0, "{}", run.message());
    let said = run.stdout + &run.stderr;
    assert!(
        said.contains("charts overlap")
            && said.contains("set 1 takes its place (--uv 1)")
            && said.contains("uv = 1,"),
        "{said}"
    );
    let bits = folder.read("light.npy");
    assert_eq!(bake(&["-o=same.npy", "--uv=1"]).code, 0);
    assert!(bits == folder.read("same.npy"));
    let run = bake(&["-o=other.npy", "--uv=0"]);
    assert!(
        run.code == 2 && run.message().contains("charts overlap"),
        "{}",
        run.message()
    );
}

/// A floor on the left of its texture, up to `end`, and on the right from `begin` on a ceiling, which no light reaches.
fn room(folder: &Folder, end: f32, begin: f32) {
    let quad = |corners: [[f64; 3]; 4]| corners.map(DVec3::from);
    let floor = quad([[-1., 0., 1.], [1., 0., 1.], [1., 0., -1.], [-1., 0., -1.]]);
    let ceiling = quad([[-1., 3., -1.], [1., 3., -1.], [1., 3., 1.], [-1., 3., 1.]]);
    let triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
    let mut mesh = Mesh::new([floor, ceiling].concat(), triangles, [1.0; 3]);
    let half = |left: f32, right: f32| [[left, 1.0], [right, 1.0], [right, 0.0], [left, 0.0]];
    mesh.uvs = vec![[half(0.0, end), half(begin, 1.0)].concat()];
    gltf::save(&folder.path("room.glb"), "room", &mesh).unwrap();
    let camera = "[camera]\neye = [0, 1, 0]\nlook_at = [0, 3, 0.001]\nup = [0, 0, 1]\nhfov = \"70 deg\"\nsize = [32, 32]\ntime = \"9 m\"\n";
    let object = "[[object]]\nname = \"room\"\ngltf = \"room.glb\"\n";
    folder.write("room.toml", format!("{camera}{object}"));
    let lamp = LIGHT.replace("[0.5, 1.5, 0]", "[0, 5, 6]");
    let lamp = lamp.replace("30 cm", "1 m").replace("= 5\n", "= 300\n");
    folder.write("lit.toml", format!("{camera}{object}{lamp}"));
}

/// The largest radiance on the ceiling, by the light that a bake printed.
fn on_the_ceiling(folder: &Folder, said: &str) -> f64 {
    let (_, tables) = said.split_once("\n\n").unwrap();
    let (key, source) = match tables.split_once("# texture_coordinates") {
        Some((_, rest)) => {
            let (key, source) = rest.split_once('\n').unwrap();
            (format!("texture_coordinates{key}\n"), source)
        }
        None => (String::new(), tables),
    };
    let (source, _) = source.split_once("\nwarning").unwrap_or((source, ""));
    let scene = folder.read("room.toml");
    let scene = String::from_utf8_lossy(&scene).into_owned();
    folder.write("baked.toml", format!("{scene}{key}{source}"));
    folder.ok(&["render", "baked.toml", "-o", "a.exr", "--spp", "4", "-q"]);
    let layers = exr::read(&folder.path("a.exr"), &Budget::new(1 << 30)).unwrap();
    let radiance = layers.radiance().unwrap();
    radiance.into_iter().flatten().fold(0.0, f64::max)
}

#[test]
fn no_light_of_one_chart_shows_on_another() {
    let folder = Folder::empty();
    let bake = |options: &[&str]| {
        let bake = [
            "bake",
            "lit.toml",
            "--bin-width=20 cm",
            "--bins=80",
            "--spp=4",
            "--texels=8x8",
        ];
        let run = folder.run(&[&bake[..], options].concat());
        assert_eq!(run.code, 0, "{}", run.message());
        (run.stdout, run.stderr)
    };
    room(&folder, 0.5, 0.5);
    let words = "object \"room\": its charts are less than two texels apart: in 16 texels light of one shows on another";
    let (said, _) = bake(&["-o=light.npz"]);
    assert!(
        said.contains(words) && said.contains("an atlas takes their place (--atlas)"),
        "{said}"
    );
    assert_eq!(on_the_ceiling(&folder, &said), 0.0);
    // Coordinates that are asked for are used, and so are those that nothing can replace.
    for (options, advice) in [
        (&["--uv=0", "-o=light.npz"][..], "or --atlas"),
        (&["-o=light.npy"], "an .npz file, which can hold an atlas"),
    ] {
        let (said, warned) = bake(options);
        assert!(
            warned.contains(words) && warned.contains(advice),
            "{warned}"
        );
        assert!(on_the_ceiling(&folder, &said) > 0.01);
    }
    // Two texels between them are enough, wherever those begin, also if only one of them has no light of its own.
    for [end, begin] in [[3.0, 5.0], [2.4, 4.4], [2.9, 4.9], [3.5, 5.5]] {
        room(&folder, end / 8.0, begin / 8.0);
        let (said, warned) = bake(&["-o=light.npz"]);
        assert!(
            !(said.clone() + &warned).contains("texels apart"),
            "{said}{warned}"
        );
        assert_eq!(on_the_ceiling(&folder, &said), 0.0, "{end} {begin}");
    }
}

#[test]
fn bounces_are_those_of_the_scene_unless_the_command_line_gives_others() {
    let folder = Folder::empty();
    let wall = "[[object]]\nname = \"wall\"\nshape = { plane = { size = [4, 4] } }\n\
                transform = { translate = [0, 1, -1], rotate = { axis = [1, 0, 0], angle = \"90 deg\" } }\n";
    folder.write("lit.toml", format!("{FLASH}{wall}{LIGHT}"));
    let light = |options: &[&str]| {
        let bake = [
            "bake",
            "lit.toml",
            "--bin-width=50 cm",
            "--bins=20",
            "--spp=4",
            "-o=a.npz",
        ];
        folder.ok(&[&bake[..], options].concat());
        folder.read("a.npz")
    };
    let camera = |options: &[&str]| light(&[&["--camera"][..], options].concat());
    let set = ["--set", "render.bounces=2"];
    let direct = camera(&[]);
    let bounced = camera(&["--bounces=2"]);
    assert!(direct != bounced);
    assert!(bounced == camera(&set));
    assert!(
        light(&["--object=floor", "--bounces=2"])
            == light(&[&["--object=floor"][..], &set].concat())
    );
    let picture = |options: &[&str]| {
        let render = [
            "render",
            "lit.toml",
            "-o",
            "a.npz",
            "--set",
            "light.point.emission={gaussian={sigma=\"9 m\"}}",
        ];
        folder.ok(&[&render[..], options].concat());
        folder.read("a.npz")
    };
    let bounced = picture(&["--bounces=2"]);
    assert!(bounced != picture(&[]) && bounced == picture(&set));
}

#[test]
fn bins_that_miss_light_say_how_much() {
    let folder = Folder::empty();
    folder.write("lit.toml", FLASH.to_string() + LIGHT);
    let said = folder.ok(&[
        "bake",
        "lit.toml",
        "--bin-width=10 cm",
        "--bins=14",
        "--texels=8x8",
    ]);
    assert!(
        said.starts_with("warning: lit-light.npz: ")
            && said.contains(" % of the light arrives after the last bin"),
        "{said}"
    );
    // Nothing is missed before the bins, and so nothing is said of it.
    assert!(!said.contains("before the first bin"), "{said}");
    assert!(said.contains("wrote lit-light.npz"), "{said}");
    // One sample tells no error, which `info` says, too.
    let one = [
        "bake",
        "lit.toml",
        "--bin-width=30 cm",
        "--bins=80",
        "--texels=8x8",
        "--spp=1",
    ];
    let said =
        folder.ok(&[&one[..], &["-o", "one.npz"]].concat()) + &folder.ok(&["info", "one.npz"]);
    assert!(
        said.contains("standard error of a bin: not known, of one sample each")
            && said.contains("not known: of one sample per texel"),
        "{said}"
    );
    // Of bins before all light there is no error, but a word on when it comes.
    let early = [
        "--start=-9 m",
        "--bin-width=10 cm",
        "--bins=14",
        "--texels=8x8",
        "--spp=4",
    ];
    let said = folder.ok(&[&["bake", "lit.toml", "-o", "early.npz"], &early[..]].concat());
    let words = "warning: early.npz: none of its light falls into the bins, which are from -9 m to -7.6 m: they are dark";
    assert!(
        said.contains("light arrives between") && said.contains(words),
        "{said}"
    );
    assert!(!said.contains("standard error"), "{said}");
    let said = folder.ok(&["info", "early.npz"]);
    assert!(
        said.contains("none of it in the bins") && said.contains("none: the bins are dark"),
        "{said}"
    );
    // Numbers that are very small have few digits.
    let said = folder.ok(&[
        "bake",
        "lit.toml",
        "--bin-width=1e-36 m",
        "--bins=256",
        "--texels=2x2",
        "--spp=1",
        "-o=small.npz",
    ]);
    for words in [
        "from 0 m to 2.56e-34 m: they are dark",
        "bin_width = \"1e-36 m\"",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let said = folder.ok(&["info", "small.npz"]);
    assert!(said.contains("256 of 1e-36 m from 0 m"), "{said}");
    for (width, words) in [
        ("0 m", "width above 0"),
        ("1e-300 m", "too small for single precision"),
    ] {
        let run = folder.run(&["bake", "lit.toml", "--bin-width", width]);
        assert_eq!(run.code, 2);
        assert!(run.message().contains(words), "{}", run.stderr);
    }
    folder.write("dark.toml", FLASH);
    let run = folder.run(&["bake", "dark.toml", "--bin-width=1 cm"]);
    assert_eq!(run.code, 2);
    assert!(run.message().contains("no light to bake"), "{}", run.stderr);
    let memory = ["--bins=60000", "--texels=4000x4000", "--max-memory=1GB"];
    let run = folder.run(&[&["bake", "lit.toml", "--bin-width=1 cm"], &memory[..]].concat());
    assert_eq!(run.code, 2);
    for words in ["more than the limit", "--texels", "--bins", "--half"] {
        assert!(run.message().contains(words), "{}", run.stderr);
    }
}

#[test]
fn energies_that_half_precision_does_not_hold_are_refused_and_their_parts_kept() {
    let folder = Folder::empty();
    folder.write("lit.toml", FLASH.to_string() + &lamp(1.5, 1e9));
    let bake = [
        "bake",
        "lit.toml",
        "--bin-width=1 m",
        "--bins=14",
        "--texels=8x8",
    ];
    let run = folder.run(&[&bake[..], &["--half"]].concat());
    assert_eq!(run.code, 2);
    let words = [
        "--half",
        "energies beyond 65504 do not fit half precision",
        "leave --half out",
    ];
    assert!(
        words.iter().all(|word| run.stderr.contains(word)),
        "{}",
        run.stderr
    );
    assert!(!folder.path("lit-light.npz").exists());
    let said = folder.ok(&bake);
    assert!(said.contains("resuming lit-light.npz"), "{said}");
}

#[test]
fn energies_that_half_precision_holds_few_digits_of_are_told_with_their_share() {
    let folder = Folder::empty();
    let bake = [
        "bake",
        "lit.toml",
        "--start=-2 m",
        "--bin-width=10 cm",
        "--bins=150",
        "--texels=8x8",
        "--spp=4",
    ];
    for intensity in [5.0, 0.02] {
        folder.write("lit.toml", FLASH.to_string() + &lamp(1.5, intensity));
        let said = folder.ok(&[&bake[..], &["-o=a.npz"]].concat());
        assert!(!said.contains("few digits"), "{said}");
        let wanted = Wanted {
            array: Some("radiance"),
            ..Wanted::default()
        };
        let cube = cube::load(&folder.path("a.npz"), wanted).unwrap();
        let (mut faint, mut all) = (0.0, 0.0);
        for k in 0..cube.samples.len() {
            let energy = cube.samples.get(k).unwrap();
            faint += if energy < f64::powi(2.0, -14) {
                energy
            } else {
                0.0
            };
            all += energy;
        }
        let said = folder.ok(&[&bake[..], &["--half", "-o=b.npz"]].concat());
        let part = 100.0 * faint / all;
        let words = format!(
            "{part:.1} % of the light is in numbers below 6.1e-5, of which f16 holds few digits or none"
        );
        assert_eq!(said.contains(&words), part > 1.0, "{words}: {said}");
        assert_eq!(part > 1.0, intensity < 1.0, "{part}");
    }
}

/// A lamp at this height below or above the floor, of this intensity.
fn lamp(height: f64, intensity: f64) -> String {
    LIGHT
        .replace("1.5", &height.to_string())
        .replace("intensity = 5", &format!("intensity = {intensity}"))
}

#[test]
fn backs_take_memory_where_light_may_come_to_them() {
    let folder = Folder::empty();
    let above = "[[object]]\nname = \"above\"\nshape = { box = { size = [1, 0.5, 1] } }\n\
                 transform = { translate = [0, 1, 0] }\n";
    let below = above.replace("[0, 1, 0]", "[0, -1, 0]");
    let bounces = "render = { bounces = 1 }\n";
    let [up, down] = [lamp(1.5, 5.0), lamp(-1.5, 5.0)];
    for (bounces, more, backs) in [
        ("", up.clone(), false),
        ("", format!("{up}{down}"), true),
        // Only light that bounces comes from bodies, and only from those behind.
        ("", format!("{up}{below}"), false),
        (bounces, up.clone(), false),
        (bounces, format!("{up}{above}"), false),
        (bounces, format!("{up}{below}"), true),
    ] {
        folder.write("lit.toml", format!("{bounces}{FLASH}{more}"));
        let bake = |memory: &'static str| {
            let options = [
                "--object=floor",
                "--bin-width=10 cm",
                "--bins=1000",
                "--texels=256x256",
            ];
            let more = ["--plan", "--threads=1", "--max-memory", memory];
            folder.run(&[&["bake", "lit.toml"], &options[..], &more].concat())
        };
        // The numbers of one side take 750 MiB.
        let run = bake("10 GB");
        let words = "and as many rows of backs if light comes to any, 1.5 GiB on disk";
        let plan = if backs {
            words
        } else {
            "1000 bins, 750.0 MiB on disk"
        };
        assert!(
            run.stdout.contains(plan),
            "{more}: {}{}",
            run.stdout,
            run.stderr
        );
        let run = bake("1200 MB");
        let said = run.message();
        assert_eq!(run.code, if backs { 2 } else { 0 }, "{more}: {said}");
        assert!(
            !backs || said.contains("light may come to its back"),
            "{said}"
        );
        let run = bake("700 MB");
        assert_eq!(run.code, 2, "{more}");
        assert!(
            run.message().contains("more than the limit"),
            "{}",
            run.stderr
        );
    }
}

#[test]
fn backs_have_light_of_their_own() {
    // One lamp above the sheet, and a brighter one below it, seen from both sides; then one below it alone.
    let below = FLASH.replace("eye = [0, 2, 4]", "eye = [0, -2, 4]");
    for (lamps, views) in [
        (lamp(1.5, 5.0) + &lamp(-1.5, 20.0), vec![FLASH, &below]),
        (lamp(-1.5, 5.0), vec![&below]),
    ] {
        let folder = Folder::empty();
        folder.write("lit.toml", FLASH.to_string() + &lamps);
        let bins = ["--start=-2 m", "--bin-width=10 cm", "--bins=150"];
        let options = ["--texels=32x32", "--spp=4", "-o=sheet.npz"];
        let said = folder.ok(&[&["bake", "lit.toml"], &options[..], &bins].concat());
        assert!(said.contains("64 rows × 32 columns"), "{said}");
        let source = said.split_once("\n\n").unwrap().1;
        assert!(source.contains("backs = \"second_half\""), "{source}");
        // A source that does not say so would show half of the rows on each half of the sheet.
        folder.write(
            "old.toml",
            FLASH.to_string() + &source.replace(", backs = \"second_half\"", ""),
        );
        let run = folder.run(&["plan", "old.toml"]);
        assert_eq!(run.code, 2);
        assert!(
            run.message().contains("add backs = \"second_half\""),
            "{}",
            run.stderr
        );
        for view in views {
            folder.write("direct.toml", view.to_string() + &lamps);
            folder.write("baked.toml", view.to_string() + source);
            assert_as_bright(&folder, "baked.toml", "direct.toml");
        }
        // From above, the sheet that is lit from below is black.
        if !source.is_empty() && lamps == lamp(-1.5, 5.0) {
            folder.write("baked.toml", FLASH.to_string() + source);
            folder.ok(&["render", "baked.toml", "-o", "a.exr", "--spp", "1", "-q"]);
            let layers = exr::read(&folder.path("a.exr"), &Budget::new(1 << 30)).unwrap();
            assert!(
                layers
                    .radiance()
                    .unwrap()
                    .iter()
                    .all(|rgb| rgb == &[0.0; 3])
            );
        }
    }
}

#[test]
fn backs_that_no_light_comes_to_have_no_rows_and_are_black() {
    let folder = Folder::empty();
    folder.write("lit.toml", FLASH.to_string() + LIGHT);
    let said = folder.ok(&[
        "bake",
        "lit.toml",
        "--bin-width=10 cm",
        "--bins=150",
        "--texels=8x8",
        "-o=a.npz",
    ]);
    assert!(said.contains(": 8 rows × 8 columns × 150 bins\n"), "{said}");
    let source = said.split_once("\n\n").unwrap().1;
    assert!(source.contains("backs = \"black\""), "{source}");
    let below = FLASH.replace("eye = [0, 2, 4]", "eye = [0, -2, 4]");
    folder.write("below.toml", below + source);
    folder.ok(&["render", "below.toml", "-o", "a.exr", "--spp", "1", "-q"]);
    let layers = exr::read(&folder.path("a.exr"), &Budget::new(1 << 30)).unwrap();
    assert!(
        layers
            .radiance()
            .unwrap()
            .iter()
            .all(|rgb| rgb == &[0.0; 3])
    );
    // A cube of fronts alone cannot be said to have both sides where its rows have no halves.
    folder.ok(&[
        "bake",
        "lit.toml",
        "--bin-width=1 m",
        "--texels=7x7",
        "-o=odd.npz",
    ]);
    let odd = "[[source]]\ncube = { file = \"odd.npz\", array = \"radiance\", bin_width = \"1 m\", backs = \"second_half\" }\n";
    folder.write("odd.toml", FLASH.to_string() + odd);
    let run = folder.run(&["plan", "odd.toml"]);
    assert_eq!(run.code, 2);
    assert!(
        run.message().contains("7 rows have no second half"),
        "{}",
        run.stderr
    );
}

/// A ball, lit.
pub(super) fn ball(keys: &str) -> String {
    FLASH.replace(
        "shape = { plane = { size = [4, 4] } }",
        &format!("shape = {{ sphere = {{ radius = 0.5 }} }}\n{keys}"),
    ) + LIGHT
}

#[test]
fn an_atlas_has_a_standard_error_though_texels_at_its_edges_have_one_sample() {
    let folder = Folder::empty();
    folder.write("lit.toml", ball(""));
    for samples in ["4", "16"] {
        let said = folder.ok(&[
            "bake",
            "lit.toml",
            "--atlas",
            "--bin-width=20 cm",
            "--bins=20",
            "--spp",
            samples,
            "-o=a.npz",
        ]);
        assert!(
            said.contains("standard error of a bin"),
            "{samples}: {said}"
        );
    }
    let said = folder.ok(&["info", "a.npz"]);
    assert!(said.starts_with("a.npz: baked light"), "{said}");
    for words in [
        "20 of 0.2 m from 0 m",
        "clock       world",
        "of the root mean square",
        "[[source]]",
        "file = \"a.npz\"",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    assert!(!said.contains("compare"), "{said}");
}

#[test]
fn gloss_that_is_not_baked_is_said_by_name() {
    for (keys, words) in [
        (
            "metallic = 1\nroughness = 0.3",
            "object \"floor\": all its light is gloss",
        ),
        (
            "metallic = 0.5\nroughness = 0.3",
            "object \"floor\": its gloss is not baked",
        ),
    ] {
        let folder = Folder::empty();
        folder.write("lit.toml", ball(keys));
        let bake = [
            "bake",
            "lit.toml",
            "--atlas",
            "--bin-width=20 cm",
            "--spp=1",
            "-o=a.npz",
        ];
        let said = folder.ok(&[&bake[..], &["--plan"]].concat());
        assert!(said.contains(words), "{said}");
        // Surfaces are baked without a camera and a film.
        assert!(
            !said.contains("film  ") && !said.contains("from the camera"),
            "{said}"
        );
        let said = folder.ok(&bake);
        assert!(
            said.contains(words) && !said.contains("no light arrives"),
            "{said}"
        );
    }
}

#[test]
fn under_pulses_alone_metal_is_diffuse_and_all_its_light_is_baked() {
    let folder = Folder::empty();
    let keys = "metallic = 1\nroughness = 0.3";
    let floor = FLASH.replace("size = [4, 4] } }", &format!("size = [4, 4] }} }}\n{keys}"));
    let pulse = "[[source]]\npulse = { position = [0.5, 1.5, 0], sigma = \"30 cm\" }\n";
    folder.write("lit.toml", floor + pulse);
    let bake = [
        "bake",
        "lit.toml",
        "--bin-width=20 cm",
        "--bins=60",
        "-o=a.npz",
    ];
    for plan in [&["--plan"][..], &[]] {
        let said = folder.ok(&[&bake[..], plan].concat());
        assert!(!said.contains("all its light is gloss"), "{said}");
    }
}
