//! Our files in other programs, if these are installed.
//!
//! librsvg (`rsvg-convert`) and Poppler (`pdftoppm`) rasterize by their own methods: only anti-aliasing at edges may differ. LaTeX
//! (`pdflatex`) sets text in its own fonts, so drawings are compared without text, and characters are only tested to compile.

use crate::common::png::decode;
use std::path::Path;
use std::process::{Command, Stdio};

use nullray::figures::drawing::{Drawing, Item, pdf, png, svg, tikz};
use nullray::text::RichText;

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

/// The same, but for words.
fn wordless(items: Vec<Item>) -> Vec<Item> {
    let kept = items.into_iter().filter_map(|item| match item {
        Item::Text(_) => None,
        Item::Clip { path, items } => Some(Item::Clip {
            path,
            items: wordless(items),
        }),
        other => Some(other),
    });
    kept.collect()
}

/// A document of one page for each picture, which is as large as that.
fn document(preamble: &str, pictures: &[String]) -> String {
    let page = |picture: &String| {
        format!(
            "\\setbox0=\\hbox{{%\n{picture}\\unskip}}\n\\pdfpagewidth=\\wd0 \\pdfpageheight=\\dimexpr\\ht0+\\dp0\\relax\n\\shipout\\box0\n"
        )
    };
    let pages: String = pictures.iter().map(page).collect();
    let head = "\\documentclass{article}\n\\usepackage{tikz}\n\\pdfhorigin=0pt \\pdfvorigin=0pt \\tracinglostchars=2 ";
    format!("{head}{preamble}\n\\begin{{document}}\n{pages}\\end{{document}}\n")
}

/// Compiles a document in `folder`; the log.
fn latex(folder: &Path, document: &str, options: &[&str]) -> String {
    std::fs::write(folder.join("a.tex"), document).unwrap();
    let mut command = Command::new("pdflatex");
    command.current_dir(folder).args(options);
    let output = command
        .args(["-interaction=nonstopmode", "-halt-on-error", "a.tex"])
        .output()
        .unwrap();
    let log = std::fs::read(folder.join("a.log")).unwrap();
    let log = String::from_utf8_lossy(&log).into_owned();
    let end = log.find("\n!").unwrap_or(0);
    assert!(output.status.success(), "{}", &log[end..]);
    log
}

#[test]
fn latex_draws_what_our_png_files_show() {
    if !is_there("pdflatex") || !is_there("pdftoppm") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let drawings = samples::classics().into_iter().map(|(name, drawing)| {
        let items = wordless(drawing.items);
        (name, Drawing { items, ..drawing })
    });
    let drawings: Vec<(String, Drawing)> = drawings.collect();
    let pictures = drawings.iter().map(|(_, drawing)| tikz::write(drawing));
    let pictures: Vec<String> = pictures.map(Result::unwrap).collect();
    latex(folder.path(), &document("", &pictures), &[]);
    let resolution = (72.0 * SCALE).to_string();
    let mut command = Command::new("pdftoppm");
    command.current_dir(folder.path()).args(["-png", "-r"]);
    run(command.args([&resolution, "a.pdf", "page"]));
    for (i, (name, drawing)) in drawings.iter().enumerate() {
        let page = folder.path().join(format!("page-{:02}.png", i + 1));
        compare(&format!("{name}.tex"), drawing, &page);
    }
}

#[test]
fn latex_sets_all_characters_of_our_fonts() {
    if !is_there("pdflatex") {
        return;
    }
    let planes = (0x20..0x2fff).filter_map(char::from_u32);
    let ours = planes.filter(|c| RichText::plain(&c.to_string()).is_ok());
    // Characters one by one, as some would join their neighbours.
    let words: Vec<String> = ours.map(|c| c.to_string()).collect();
    assert!(words.len() > 400, "{}", words.len());
    let items = words.iter().map(|word| Item::Text(samples::plain(word)));
    let drawing = samples::page("All", items.collect());
    let page = document(
        "\\usepackage[T1]{fontenc}",
        &[tikz::write(&drawing).unwrap()],
    );
    let folder = tempfile::tempdir().unwrap();
    let log = latex(folder.path(), &page, &["-draftmode"]);
    assert!(!log.contains("Missing character"), "{log}");
    // What the old encoding has in other places, and what would join.
    let said = |word: &str| tikz::write(&samples::page("", vec![Item::Text(samples::plain(word))]));
    for (word, tex) in [
        ("a<b>c|d", "{a$<$b$>$c$|$d};"),
        ("\"--`", "{''-{}-\\textasciigrave{}};"),
        ("x₁² ħ ⁻⁹", "{x$_1$$^2$ $\\hbar$ $^-$$^9$};"),
    ] {
        let found = said(word).unwrap();
        assert!(found.contains(tex), "{word}: {found}");
    }
}
