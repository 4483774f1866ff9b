//! What programs of others make of our files, where these programs are there.
//!
//! librsvg (`rsvg-convert`) and Poppler (`pdftoppm`) rasterize by methods of their own: edges may differ by
//! their anti-aliasing, and nothing else may.

use crate::common::png::decode;
use std::path::Path;
use std::process::{Command, Stdio};

use nullray::figures::drawing::{Drawing, pdf, png, svg};

use super::samples;

/// Pixels per point: 144 dots per inch.
const SCALE: f64 = 2.0;
/// The mean difference, of 255; lines cover about a hundredth of a page.
const MEAN: f64 = 1.6;
/// The part of pixels that differ by more than half of the range: Poppler rounds pages up to whole pixels, and
/// its lines are then off by a part of one.
const FAR: f64 = 4e-3;

fn is_there(program: &str) -> bool {
    let mut command = Command::new(program);
    let run = command
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    let found = run.status().is_ok();
    if !found {
        crate::common::skipped::skipped(format_args!("there is no {program} here"));
    }
    found
}

/// Runs a program that is to succeed.
fn run(command: &mut Command) {
    let output = command.output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {said}");
}

/// Compares the picture in a file with the one that we draw.
fn compare(name: &str, drawing: &Drawing, file: &Path) {
    let ours = png::render(drawing, SCALE).unwrap();
    let theirs = decode(&std::fs::read(file).unwrap()).unwrap();
    // Pages are rounded up by some, and to the nearest pixel by us.
    let (width, height) = (ours.width.min(theirs.width), ours.height.min(theirs.height));
    assert!(
        ours.width - width <= 1 && theirs.height.abs_diff(ours.height) <= 1,
        "{name}"
    );
    let (mut sum, mut far) = (0u64, 0u64);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let at = 4 * (y * ours.width + x) as usize;
        let pair = ours.rgba[at..at + 3]
            .iter()
            .zip(&theirs.rgba[4 * (y * theirs.width + x) as usize..][..3]);
        let off = pair.map(|(a, b)| u64::from(a.abs_diff(*b)));
        let most = off.clone().max().unwrap();
        sum += off.sum::<u64>();
        far += u64::from(most > 127);
    }
    let count = f64::from(width) * f64::from(height);
    let (mean, far) = (sum as f64 / (3.0 * count), far as f64 / count);
    println!("{name}: {mean:.3} on the average, {far:.2e} far off");
    assert!(mean <= MEAN && far <= FAR, "{name}: {mean}, {far}");
}

#[test]
fn librsvg_shows_what_our_png_files_show() {
    if !is_there("rsvg-convert") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for (name, drawing) in samples::both() {
        let [input, output] = ["a.svg", "a.png"].map(|file| folder.path().join(file));
        std::fs::write(&input, svg::write(&drawing).unwrap()).unwrap();
        let [width, height] = [drawing.width, drawing.height].map(|side| (side * SCALE).round());
        let mut command = Command::new("rsvg-convert");
        command.args(["-w", &width.to_string(), "-h", &height.to_string(), "-o"]);
        run(command.arg(&output).arg(&input));
        compare(&format!("{name}.svg"), &drawing, &output);
    }
}

#[test]
fn poppler_shows_what_our_png_files_of_diagrams_show() {
    if !is_there("pdftoppm") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for (name, drawing) in samples::classics() {
        let [input, output] = ["a.pdf", "a"].map(|file| folder.path().join(file));
        std::fs::write(&input, pdf::write(&drawing).unwrap()).unwrap();
        let resolution = (72.0 * SCALE).to_string();
        let mut command = Command::new("pdftoppm");
        command.args(["-png", "-singlefile", "-r", &resolution]);
        run(command.arg(&input).arg(&output));
        compare(
            &format!("{name}.pdf"),
            &drawing,
            &folder.path().join("a.png"),
        );
    }
}
