use super::*;

const C: f64 = 299_792_458.0;

fn rate(per_second: f64) -> Pace {
    Pace::Rate {
        per_second,
        metres_per_second: C,
    }
}

#[test]
fn a_range_of_times_has_no_frame_at_its_end_whatever_the_rounding() {
    for n in 1..2000u32 {
        // One second at n frames per second, and n intervals of a tenth: neither is exact in binary.
        let second = Frames::between(0.0, C, rate(n.into())).unwrap();
        assert_eq!(second.numbers, 0..u64::from(n));
        let tenths = Pace::Interval(0.1);
        let to = 3.7 + 0.1 * f64::from(n);
        assert_eq!(
            Frames::between(3.7, to, tenths).unwrap().numbers,
            0..n.into()
        );
    }
}

#[test]
fn a_range_that_ends_between_frames_has_the_one_before() {
    let frames = |to| Frames::between(0.0, to, Pace::Interval(1.0)).unwrap();
    assert_eq!(frames(2.5).numbers, 0..3);
    assert_eq!(frames(2.0 + 1e-8).numbers, 0..3);
    assert_eq!(frames(2.0 - 1e-12).numbers, 0..2);
    assert_eq!(frames(1e-6).numbers, 0..1);
}

#[test]
fn the_time_of_a_frame_does_not_depend_on_those_before_it() {
    let frames = Frames {
        numbers: 0..10,
        start: 2.0,
        pace: rate(3.0),
    };
    assert_eq!(frames.time(9), Some(2.0 + 3.0 * C));
    let frames = Frames {
        pace: Pace::Interval(0.1),
        ..frames
    };
    assert_eq!(frames.time(10), Some(3.0));
}

#[test]
fn the_interval_of_the_scene_counts_where_the_command_line_says_none() {
    let mut scene = crate::cli::builtin::open(None, &Default::default(), 0)
        .and_then(|file| file.scene(&Default::default()))
        .unwrap();
    scene.camera.time = 2.0;
    scene.camera.frame_interval = Some(0.25);
    let mut arguments = FrameArguments {
        frames: Some(4..8),
        from: None,
        to: None,
        fps: None,
        interval: None,
    };
    let time = |arguments: &FrameArguments| {
        let frames = Frames::of(arguments, &scene).unwrap().unwrap();
        (frames.numbers.clone(), frames.time(4).unwrap())
    };
    assert_eq!(time(&arguments), (4..8, 3.0));
    arguments.interval = Some("1 m".parse().unwrap());
    assert_eq!(time(&arguments), (4..8, 6.0));
}

#[test]
fn empty_and_endless_ranges_are_refused() {
    for (from, to) in [(1.0, 1.0), (2.0, 1.0)] {
        assert!(Frames::between(from, to, Pace::Interval(1.0)).is_err());
    }
    for to in [1e7, 1e300, f64::INFINITY] {
        let error = Frames::between(0.0, to, Pace::Interval(1.0)).unwrap_err();
        assert!(error.to_string().contains("more than 1000000"), "{error}");
    }
}
