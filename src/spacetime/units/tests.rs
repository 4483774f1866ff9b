use std::f64::consts::PI;

use super::*;

const C: f64 = 299_792_458.0;

fn time(text: &str) -> f64 {
    text.parse::<Time>().unwrap().metres(C)
}

#[test]
fn a_decimal_unit_gives_the_nearest_f64() {
    assert_eq!(time("12 cm"), 0.12);
    assert_eq!(time("3mm"), 0.003);
    assert_eq!(time("-2.5e-1 km"), -250.0);
    let line: Wavelength = "532 nm".parse().unwrap();
    assert_eq!(line.metres(), 532e-9);
    assert_eq!("7 µm".parse::<Length>().unwrap().metres(), 7e-6);
    assert_eq!("7 μm".parse::<Length>().unwrap().metres(), 7e-6);
}

#[test]
fn seconds_use_the_speed_of_light_of_the_scene_and_metres_do_not() {
    assert_eq!(time("1 s"), C);
    assert_eq!("2 ns".parse::<Time>().unwrap().metres(1e9), 2.0);
    assert_eq!("2 m".parse::<Time>().unwrap().metres(1e9), 2.0);
    // 1 ps of light is 0.299792458 mm.
    assert!((time("1 ps") - 0.299_792_458e-3).abs() < 1e-19);
    assert!((time("1e6 as") - time("1 ps")).abs() < 1e-19);
    assert!((time("1 us") - 299.792_458).abs() < 1e-12);
}

#[test]
fn right_angles_have_exact_sines() {
    for (text, expected) in [
        ("90 deg", (1.0, 0.0)),
        ("-90 deg", (-1.0, 0.0)),
        ("180°", (0.0, -1.0)),
        ("720 deg", (0.0, 1.0)),
    ] {
        assert_eq!(text.parse::<Angle>().unwrap().sin_cos(), expected, "{text}");
    }
    let (sin, _) = "30 deg".parse::<Angle>().unwrap().sin_cos();
    assert!((sin - 0.5).abs() < 1e-16);
    assert_eq!("180 deg".parse::<Angle>().unwrap().radians(), PI);
}

#[test]
fn angles_are_written_with_as_few_degrees_as_give_them() {
    for degrees in [50.0f64, 60.0, 0.1, 44.7, -30.0, 1e-7] {
        let angle = Angle::customary(degrees);
        assert_eq!(Angle::of_radians(angle.radians()), angle);
    }
    // Most others need all digits.
    for radians in [1.0, 0.3, 2.0, f64::NAN] {
        let text = Angle::of_radians(radians).to_string();
        let back = text.parse::<Angle>().map_or(f64::NAN, Angle::radians);
        assert!((back - radians).abs() < 4e-16 * radians || radians.is_nan());
    }
}

#[test]
fn speeds_and_percentages_have_their_units() {
    let bicycle: Speed = "36 km/h".parse().unwrap();
    assert_eq!(bicycle.metres_per_second(), 10.0);
    assert_eq!("99.5%".parse::<Percentage>().unwrap().percent(), 99.5);
}

#[test]
fn accelerations_are_divided_by_the_square_of_the_speed_of_light() {
    let per_metre = |text: &str| text.parse::<Acceleration>().unwrap().per_metre(C);
    for text in [
        "0.1 /m", "0.1/m", "0.1 1/m", "1e-3 /cm", "1e-4 /mm", "100 1/km",
    ] {
        assert_eq!(per_metre(text), 0.1, "{text}");
    }
    // g = 9.80665 m/s²: c²/g = 8.987551787e16/9.80665 m = 9.164752e15 m, 0.97 light years.
    for text in ["9.80665 m/s2", "9.80665 m/s^2", "9.80665 m/s²"] {
        assert!(
            (1.0 / per_metre(text) / 9.164_752e15 - 1.0).abs() < 1e-6,
            "{text}"
        );
    }
    // A speed of c in each second of c metres.
    assert_eq!(per_metre("1 c/s"), 1.0 / C);
    assert_eq!(per_metre("1 c/ns"), 1e9 / C);
    assert_eq!("2 c/s".parse::<Acceleration>().unwrap().per_metre(4.0), 0.5);
    assert_eq!(
        "8 m/s2".parse::<Acceleration>().unwrap().per_metre(4.0),
        0.5
    );
}

#[test]
fn angular_rates_are_per_metre_of_light_path() {
    let rate = |text: &str| text.parse::<AngularRate>().unwrap().radians_per_metre(C);
    assert_eq!(rate("-0.5 rad/m"), -0.5);
    assert_eq!(rate("180 deg/m"), PI);
    assert_eq!(rate("180 °/m"), PI);
    assert_eq!(rate("3 rad/s"), 3.0 / C);
    assert_eq!(rate("180 deg/s"), PI / C);
    assert!((rate("180 deg/ns") - rate("1 rad/ns") * PI).abs() < 1e-14);
    assert!("1 1/m".parse::<AngularRate>().is_err());
}

#[test]
fn refusals_say_what_would_be_right() {
    let refusal = |text: &str| text.parse::<Time>().unwrap_err().to_string();
    assert!(refusal("0.6").contains("like \"0.6 m\""));
    assert!(refusal("0.6 lightyears").contains("\"lightyears\" is not a unit of a time"));
    assert!(refusal("").contains("not a time"));
    assert!(refusal("m").contains("not a time"));
    assert!(refusal("nan m").contains("not a time"));
    assert!(refusal("1e400 m").contains("beyond"));
    assert!(refusal("1e29 km").contains("beyond"));
    assert!(refusal("2 M").contains("not a unit"));
    assert!(refusal("1 e m").contains("not a unit"));
    assert!(refusal("1.2.3 m").contains("not a unit"));
    assert!("5 nm".parse::<Angle>().is_err());
}

#[test]
fn a_measure_prints_as_it_is_read() {
    for text in ["60 deg", "0.25 rad"] {
        assert_eq!(text.parse::<Angle>().unwrap().to_string(), text);
    }
}
