//! Resident memory of the program, as reported by the system.

use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::process::Stdio;
use std::time::Duration;

use super::Folder;

/// A floor lit by a cube on disk that is many times as large as the memory that may be taken, and sparse: its samples are 0.
const SCENE: &str = r#"
[display]
samples_per_pixel = 4
[camera]
eye = [0, 3, 0]
look_at = [0, 0, -3]
hfov = "70 deg"
size = [320, 240]
clock_zero = "10 m"
[[object]]
name = "floor"
shape = { plane = { size = [20, 20] } }
[[source]]
[source.cube]
file = "large.npy"
start = "-30 m"
bin_width = "0.05 m"
uv = 0
"#;

/// The most that process `id` has kept in memory so far, bytes; none once it has ended.
fn most_resident(id: u32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{id}/status")).ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kibibytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kibibytes << 10)
}

#[test]
fn a_cube_larger_than_the_memory_limit_is_rendered_within_it() {
    if !cfg!(target_os = "linux") {
        return;
    }
    const LIMIT: u64 = 256 << 20;
    let folder = Folder::empty();
    folder.write("scene.toml", SCENE);
    let shape = [1024u64, 1024, 1000];
    let [h, w, t] = shape;
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({h}, {w}, {t}), }}");
    let mut file = File::create(folder.path("large.npy")).unwrap();
    file.write_all(b"\x93NUMPY\x01\x00\x76\x00").unwrap();
    writeln!(file, "{header:<117}").unwrap();
    let end = file.seek(SeekFrom::End(0)).unwrap();
    file.set_len(end + 4 * h * w * t).unwrap();
    drop(file);
    for reconstruction in ["bilinear", "footprint"] {
        let set = format!("source.0.cube.reconstruction=\"{reconstruction}\"");
        let arguments = [
            "render",
            "scene.toml",
            "-q",
            "-o",
            "a.npz",
            "--memory",
            "256MiB",
            "--stats-json",
            "cost.json",
            "--set",
            &set,
        ];
        let mut command = folder.command(&arguments);
        let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
        let mut most = 0;
        let status = loop {
            most = most.max(most_resident(child.id()).unwrap_or(0));
            match child.try_wait().unwrap() {
                Some(status) => break status,
                None => std::thread::sleep(Duration::from_millis(2)),
            }
        };
        assert!(status.success(), "{reconstruction}");
        println!("{reconstruction}: {} MiB resident at most", most >> 20);
        assert!(
            most > 0 && most <= LIMIT,
            "{reconstruction}: {} MiB resident within a limit of {} MiB",
            most >> 20,
            LIMIT >> 20
        );
        // More than the limit was read in all, so that bricks made way.
        let cost: serde_json::Value = serde_json::from_slice(&folder.read("cost.json")).unwrap();
        let read = cost["disk_bytes"]["needed"].as_u64().unwrap();
        assert!(read > LIMIT, "{read} bytes: {cost}");
        assert!(cost["texture_bytes"].as_u64() > Some(0), "{cost}");
        folder.read("a.npz");
    }
}
