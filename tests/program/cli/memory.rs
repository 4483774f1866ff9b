//! `--max-memory`: the most memory that a process takes, as counted by the system.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use glam::DVec3;
use nullray::io::gltf;
use nullray::mesh::{Material, Mesh, Part};

const MIB: u64 = 1 << 20;
/// What the program takes itself: its code, the standard library, stacks of threads.
const PROGRAM: u64 = 56 * MIB;

/// Runs the program in `folder`; its output, and the most memory that was resident (VmHWM), bytes.
fn run(folder: &Path, arguments: &[&str]) -> (Output, u64) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_nullray"))
        .args(arguments)
        .current_dir(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The last that is seen of it is what it had a moment before its end.
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    while child.try_wait().unwrap().is_none() {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kibibytes = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
        peak = peak.max(kibibytes.unwrap_or(0) * 1024);
        std::thread::sleep(Duration::from_millis(1));
    }
    (child.wait_with_output().unwrap(), peak)
}

/// A sheet of n × n vertices.
fn sheet(path: &Path, n: u32) {
    let places = (0..n * n).map(|k| {
        let (x, y) = (f64::from(k % n), f64::from(k / n));
        DVec3::new(x, y, (0.1 * x).sin()) / f64::from(n)
    });
    let cells = (0..(n - 1) * (n - 1)).map(|k| k % (n - 1) + k / (n - 1) * n);
    let count = 2 * (n - 1) * (n - 1);
    let mesh = Mesh {
        parts: vec![Part {
            first_triangle: 0,
            triangles: count,
            material: 0,
            node: String::new(),
        }],
        materials: vec![Material::default()],
        positions: places.collect(),
        triangles: cells
            .flat_map(|at| [[at, at + 1, at + n], [at + 1, at + n + 1, at + n]])
            .collect(),
        ..Mesh::default()
    };
    gltf::save(path, "sheet", &mesh).unwrap();
}

/// An array of zeros of this shape in single precision.
fn zeros(path: &Path, shape: &[usize]) {
    let numbers: Vec<String> = shape.iter().map(usize::to_string).collect();
    let header = format!(
        "{{'descr': '<f4', 'fortran_order': False, 'shape': ({}), }}",
        numbers.join(", ")
    );
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend([118, 0]);
    file.extend(format!("{header:<117}\n").bytes());
    file.resize(file.len() + 4 * shape.iter().product::<usize>(), 0);
    std::fs::write(path, file).unwrap();
}

#[test]
#[cfg_attr(
    not(target_os = "linux"),
    ignore = "Linux says what a process had at most"
)]
fn no_command_takes_more_than_its_limit() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    sheet(&at("model.glb"), 800);
    zeros(&at("picture.npy"), &[1200, 1200, 3]);
    zeros(&at("cube.npy"), &[256, 256, 512]);
    zeros(&at("map.npy"), &[1500, 1500]);
    // The command, its limit, and whether that is enough.
    let depth = "mesh-from-depth map.npy --from distance --eye 0,0,0 --look-at 0,0,-1 --fov 40deg -o m.glb -q";
    let cases = [
        (
            "render model.glb --size 64x48 --spp 1 -o a.png -q",
            40,
            false,
        ),
        (
            "render model.glb --size 64x48 --spp 1 -o a.png -q",
            160,
            false,
        ),
        (
            "render model.glb --size 64x48 --spp 1 -o a.png -q",
            560,
            true,
        ),
        ("compare picture.npy picture.npy", 200, false),
        ("compare picture.npy picture.npy", 440, true),
        ("compare picture.npy picture.npy --report r.html", 480, true),
        ("convert cube.npy --axes HWT -o c.npy -q", 24, true),
        ("info cube.npy", 24, true),
        (depth, 60, false),
        ("selftest --check large", 60, false),
        ("selftest --check large", 150, true),
    ];
    for (command, limit, is_enough) in cases {
        let limit_text = format!("{limit}MiB");
        let mut arguments: Vec<&str> = command.split(' ').collect();
        for argument in &mut arguments {
            if *argument == "40deg" {
                *argument = "40 deg";
            }
        }
        arguments.extend(["--max-memory", &limit_text]);
        let (output, peak) = run(folder.path(), &arguments);
        let said = String::from_utf8_lossy(&output.stderr);
        println!("{command}, {limit} MiB: {} MiB", peak / MIB);
        assert_eq!(
            output.status.success(),
            is_enough,
            "{command}, {limit} MiB: {said}"
        );
        assert!(
            is_enough || output.status.code() == Some(2),
            "{command}: {said}"
        );
        assert!(
            peak <= limit * MIB + PROGRAM,
            "{command}: {} MiB, and the limit is {limit}",
            peak / MIB
        );
    }
}

#[test]
#[cfg_attr(
    not(target_os = "linux"),
    ignore = "Linux says what a process had at most"
)]
fn with_the_least_limit_that_is_accepted_a_command_takes_no_more() {
    const SCENE: &str = "[camera]\neye = [0, 0, 4]\nlook_at = [0, 0, 0]\nvelocity = { beta = [0.5, 0, 0] }\n\
        [[object]]\nshape = { box = { size = [1, 1, 1] } }\n";
    const LIGHT: &str = "[[light]]\nposition = [0, 2, 2]\nintensity = 5\n[render]\nbounces = 2\n[radiance]\nquantity = \"rgb\"\n";
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    write("a.toml", SCENE.into());
    write("lit.toml", format!("{SCENE}{LIGHT}"));
    let study = "study a.toml --size 600x600 --methods trace --samples 1 --reference-spp 1 --budget 1 -o s.csv";
    for command in [
        "render a.toml --size 1000x1000 --spp 1 --half -o a.exr",
        "render a.toml --size 300x200 --spp 1 --threads 200 -o a.npz",
        "render lit.toml --size 300x200 --spp 1 --threads 96 -o a.npz",
        "export a.toml --size 500x500 -o bundle --overwrite",
        study,
    ] {
        let run_with = |limit: u64| {
            let limit_text = format!("{limit}MiB");
            let mut arguments: Vec<&str> = command.split(' ').collect();
            arguments.extend(["-q", "--max-memory", &limit_text]);
            run(folder.path(), &arguments)
        };
        // A refusal says what is needed: by that it goes on, in steps of 4 MiB.
        let mut limit = 16;
        let (output, peak) = loop {
            let (output, peak) = run_with(limit);
            if output.status.success() || limit > 2000 {
                break (output, peak);
            }
            let said = String::from_utf8_lossy(&output.stderr);
            let needed = said.split_once("needs about ");
            let needed = needed.and_then(|(_, after)| after.split_once(" MiB"));
            let (needed, _) = needed.unwrap_or_else(|| panic!("{command}: {said}"));
            let needed = needed.parse::<f64>().unwrap().ceil() as u64;
            limit = needed.next_multiple_of(4).max(limit + 4);
        };
        assert!(output.status.success(), "{command}");
        let (less, _) = run_with(limit - 4);
        assert!(
            !less.status.success(),
            "{command}: less than {limit} MiB is enough"
        );
        println!("{command}: {} of {limit} MiB", peak / MIB);
        assert!(
            peak <= limit * MIB,
            "{command}: {} MiB, and the limit is {limit}",
            peak / MIB
        );
    }
}
