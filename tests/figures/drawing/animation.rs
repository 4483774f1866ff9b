//! Animations contain their frames.

use nullray::Result;
use nullray::figures::drawing::apng::{Delay, write};
use nullray::figures::drawing::png::{RgbaImage, render};

use super::samples::{all, page};

const DELAY: Delay = Delay {
    numerator: 1,
    denominator: 25,
};

fn frames() -> Vec<RgbaImage> {
    all()
        .iter()
        .map(|(_, drawing)| render(drawing, 1.0).unwrap())
        .collect()
}

fn whole(frames: &[RgbaImage]) -> Vec<u8> {
    write(frames.len() as u32, frames.iter().cloned().map(Ok), DELAY).unwrap()
}

fn refusal(count: u32, frames: Vec<RgbaImage>, delay: Delay) -> String {
    write(count, frames.into_iter().map(Ok), delay)
        .unwrap_err()
        .to_string()
}

#[test]
fn an_animation_gives_back_its_frames_and_their_time() {
    let frames = frames();
    let file = whole(&frames);
    let mut reader = png::Decoder::new(std::io::Cursor::new(file))
        .read_info()
        .unwrap();
    let control = reader.info().animation_control.unwrap();
    assert_eq!((control.num_frames, control.num_plays), (5, 0));
    for frame in &frames {
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        let control = reader.info().frame_control.unwrap();
        assert_eq!((control.delay_num, control.delay_den), (1, 25));
        assert!(pixels == frame.rgba);
    }
}

#[test]
fn equal_frames_are_equal_animations() {
    assert_eq!(whole(&frames()), whole(&frames()));
}

#[test]
fn one_frame_is_an_animation() {
    let frame = render(&page("", Vec::new()), 1.0).unwrap();
    assert!(!whole(&[frame]).is_empty());
}

#[test]
fn frames_have_one_size() {
    let (_, drawing) = &all()[0];
    let sizes = [1.0, 2.0].map(|scale| render(drawing, scale).unwrap());
    let error = refusal(2, sizes.to_vec(), DELAY);
    assert!(
        error.contains("picture 1") && error.contains("240 × 120"),
        "{error}"
    );
}

#[test]
fn frames_are_as_many_as_announced() {
    assert!(refusal(0, Vec::new(), DELAY).contains("without frames"));
    assert!(refusal(9, frames(), DELAY).contains("5 pictures of 9"));
}

#[test]
fn a_delay_has_a_denominator() {
    let delay = Delay {
        denominator: 0,
        ..DELAY
    };
    assert!(refusal(5, frames(), delay).contains("denominator"));
}

#[test]
fn the_error_of_a_frame_is_that_of_the_animation() {
    let broken: Result<RgbaImage> = render(&page("", Vec::new()), f64::NAN);
    assert!(write(1, [broken], DELAY).is_err());
}
