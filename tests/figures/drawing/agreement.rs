//! All formats show the same drawing.

use nullray::figures::drawing::{pdf, png, svg};

use super::{pdf_reader, samples, svg_reader};

/// The greatest difference of two pictures, of 255.
fn difference(a: &[u8], b: &[u8]) -> u8 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap()
}

/// Coordinates are written to 1e-4 points, 2e-4 pixels here: coverage changes by less than that, and may
/// then be rounded the other way; tiny-skia counts it in 16ths, of which a sample may go the other way.
const MOST: u8 = 17;

#[test]
fn svg_files_show_what_png_files_show() {
    for (name, drawing) in samples::all() {
        let picture = png::render(&drawing, 2.0).unwrap();
        let file = svg::write(&drawing).unwrap();
        let read = svg_reader::render(&file, picture.width, picture.height, 2.0);
        let found = difference(&read, &picture.rgba);
        assert!(found <= MOST, "{name}: {found}");
    }
}

#[test]
fn pdf_files_show_what_png_files_show() {
    for (name, drawing) in samples::all() {
        let picture = png::render(&drawing, 2.0).unwrap();
        let file = pdf::write(&drawing).unwrap();
        let (width, height) = (picture.width, picture.height);
        let read = pdf_reader::render(&file, drawing.height, width, height, 2.0);
        let found = difference(&read, &picture.rgba);
        assert!(found <= MOST, "{name}: {found}");
    }
}

/// The mean difference of two pictures, of 255.
fn mean_difference(a: &[u8], b: &[u8]) -> f64 {
    assert_eq!(a.len(), b.len());
    let sum: u64 = a
        .iter()
        .zip(b)
        .map(|(a, b)| u64::from(a.abs_diff(*b)))
        .sum();
    sum as f64 / a.len() as f64
}

/// Where the rounded length of a dash is summed over hundreds of points, or a slanted edge passes a sample,
/// a few pixels differ more than anybody sees.
const MEAN: f64 = 0.05;

#[test]
fn all_formats_of_the_classic_diagrams_show_the_same() {
    for (name, drawing) in samples::classics() {
        let picture = png::render(&drawing, 2.0).unwrap();
        let (width, height) = (picture.width, picture.height);
        let file = svg::write(&drawing).unwrap();
        let read = svg_reader::render(&file, width, height, 2.0);
        let of_svg = mean_difference(&read, &picture.rgba);
        let file = pdf::write(&drawing).unwrap();
        let read = pdf_reader::render(&file, drawing.height, width, height, 2.0);
        let of_pdf = mean_difference(&read, &picture.rgba);
        assert!(
            of_svg <= MEAN && of_pdf <= MEAN,
            "{name}: {of_svg}, {of_pdf}"
        );
    }
}
