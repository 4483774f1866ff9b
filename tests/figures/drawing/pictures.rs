//! Pictures on pages.

use nullray::figures::drawing::{Item, pdf, png, svg};
use nullray::io::image::RgbImage;
use nullray::text::Rect;

use super::{pdf_reader, samples};

/// Two pixels, red and blue, over 40 × 20 points.
fn item() -> Item {
    Item::Image {
        image: RgbImage {
            width: 2,
            height: 1,
            rgb: vec![200, 0, 0, 0, 0, 200],
        },
        rect: Rect {
            min: [10.0, 20.0],
            max: [50.0, 40.0],
        },
    }
}

#[test]
fn every_pixel_of_a_picture_is_a_plain_rectangle() {
    let raster = png::render(&samples::page("", vec![item()]), 1.0).unwrap();
    let pixel = |x: usize, y: usize| &raster.rgba[4 * (y * 120 + x)..][..3];
    for (x, y, rgb) in [
        (10, 20, [200, 0, 0]),
        (29, 39, [200, 0, 0]),
        (30, 20, [0, 0, 200]),
        (49, 39, [0, 0, 200]),
        (9, 30, [255; 3]),
        (50, 30, [255; 3]),
        (20, 40, [255; 3]),
    ] {
        assert_eq!(pixel(x, y), rgb, "({x}, {y})");
    }
}

#[test]
fn an_svg_holds_the_picture_as_a_png() {
    let text = svg::write(&samples::page("", vec![item()])).unwrap();
    // The signature and the length of the first chunk in base 64.
    assert!(text.contains(" x=\"10\" y=\"20\" width=\"40\" height=\"20\""));
    assert!(text.contains("xlink:href=\"data:image/png;base64,iVBORw0KGgo"));
}

#[test]
fn a_pdf_holds_the_picture_with_its_first_row_at_the_top() {
    let bytes = pdf::write(&samples::page("", vec![item()])).unwrap();
    let content = pdf_reader::content(&bytes);
    assert!(content.contains("40 0 0 -20 10 40 cm"), "{content}");
    assert!(content.contains("/I0 Do"), "{content}");
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.contains("/Width 2") && text.contains("/Height 1"));
}

#[test]
fn pictures_that_are_not_sound_are_refused() {
    let refused = |image: RgbImage, max: [f64; 2]| {
        let rect = Rect { min: [0.0; 2], max };
        let page = samples::page("", vec![Item::Image { image, rect }]);
        svg::write(&page).unwrap_err().to_string()
    };
    let picture = |bytes| RgbImage {
        width: 1,
        height: 1,
        rgb: vec![0; bytes],
    };
    assert!(refused(picture(4), [1.0, 1.0]).contains("4 bytes"));
    assert!(refused(picture(3), [0.0, 1.0]).contains("width"));
    assert!(refused(picture(3), [1.0, f64::NAN]).contains("not on any page"));
}
