//! Refused probes.

use nullray::Error;
use nullray::figures::pixel_probe::trace;
use nullray::render::progress::Silent;

use crate::pixel_probe::{STILL, scene, text, traced};

#[test]
fn a_pixel_outside_the_picture_is_refused_with_the_columns_and_rows_there_are() {
    let scene = scene(&text(STILL));
    for pixel in [[32, 0], [0, 24], [u32::MAX, u32::MAX]] {
        let Err(Error::Invalid(problem)) = traced(&scene, pixel) else {
            panic!("{pixel:?} is accepted");
        };
        assert_eq!(problem.place, format!("pixel {},{}", pixel[0], pixel[1]));
        assert!(problem.what.contains("32 × 24"), "{}", problem.what);
        assert!(problem.help.contains("0 to 31") && problem.help.contains("0 to 23"));
    }
}

#[test]
fn geometry_beyond_the_memory_limit_is_refused() {
    let error = trace(&scene(&text(STILL)), [0, 0], 16, &Silent).unwrap_err();
    assert!(
        error.to_string().contains("memory") || error.to_string().contains("needs about"),
        "{error}"
    );
}
