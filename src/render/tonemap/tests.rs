use super::*;

fn shown(pixel: [f64; 3]) -> [u8; 3] {
    let display = tonemap(&[pixel], Exposure::White(2.0)).unwrap();
    display.rgb.try_into().unwrap()
}

#[test]
fn white_is_white_and_half_of_it_is_188() {
    assert_eq!(shown([2.0; 3]), [255; 3]);
    assert_eq!(shown([1.0; 3]), [188; 3]);
    assert_eq!(shown([0.0; 3]), [0; 3]);
}

#[test]
fn a_percentile_is_the_nearest_rank_among_lit_pixels() {
    // 1 to 1000 in the brightest channel, shuffled, among dark and unusable pixels.
    let lit = (0..1000u32).map(|i| [0.0, f64::from(i * 387 % 1000 + 1), 0.0]);
    let unusable = [[0.0; 3], [-1.0; 3], [f64::NAN; 3], [f64::INFINITY; 3]];
    let pixels: Vec<_> = lit.chain(unusable).collect();
    for (p, white) in [
        (100.0, 1000.0),
        (99.9, 999.0),
        (50.0, 500.0),
        (50.01, 501.0),
        (1e-9, 1.0),
    ] {
        let display = tonemap(&pixels, Exposure::Percentile(p)).unwrap();
        assert_eq!(display.white, white, "{p}");
    }
}

#[test]
fn a_colour_outside_the_gamut_is_exposed_by_what_is_shown_of_it() {
    // Y = 0.2126 · 4 − 0.7152 − 0.0722 = 0.0630; the remaining red is Y + Y/(Y + 1) (4 − Y).
    let outside = [4.0, -1.0, -1.0];
    let y = 0.2126390058715103 * 4.0 - 0.7151686787677559 - 0.0721923153607337;
    let expected = y + y / (y + 1.0) * (4.0 - y);
    let display = tonemap(&[outside], Exposure::Percentile(100.0)).unwrap();
    assert!((display.white / expected - 1.0).abs() < 1e-12);
    // Its red is white.
    assert_eq!(display.rgb, [255, 0, 0]);
}

#[test]
fn a_dark_image_stays_black() {
    let display = tonemap(&[[0f32; 3]; 4], Exposure::Percentile(99.0)).unwrap();
    assert_eq!(
        display,
        Display {
            rgb: vec![0; 12],
            white: 1.0,
            black: None,
        }
    );
}

#[test]
fn what_is_not_a_number_stands_out() {
    assert_eq!(shown([0.0, f64::NAN, 1.0]), NOT_A_NUMBER);
    assert_eq!(shown([f64::INFINITY, 0.0, 0.0]), [255; 3]);
    assert_eq!(shown([f64::NEG_INFINITY, 2.0, 0.0]), [0, 255, 0]);
}

#[test]
fn overexposure_keeps_the_hue_on_the_way_to_white() {
    // Clipping each component would turn blue (0.4, 0.1, 1) × 10 into roughly magenta, (1, 1, 1), at once.
    let mut last = [0; 3];
    for exposure in [1.0, 1.5, 2.0, 4.0, 16.0, 1e6] {
        let rgb = shown([0.2, 0.05, 1.0].map(|c| c * 2.0 * exposure));
        assert_eq!(rgb[2], 255);
        assert!(rgb[0] >= rgb[1] && rgb[0] >= last[0] && rgb[1] >= last[1]);
        last = rgb;
    }
    assert_eq!(last, [255; 3]);
}

#[test]
fn a_colour_outside_the_gamut_keeps_its_hue_and_its_luminance() {
    // (2, 1, −0.2): Y = 1.1260; t = Y/(Y + 0.2); c − Y is scaled by t, and blue becomes 0.
    let [r, g, b] = within_gamut([2.0, 1.0, -0.2]);
    let y = 0.2126390058715103 * 2.0 + 0.7151686787677559 - 0.0721923153607337 * 0.2;
    assert!((luminance([r, g, b]) - y).abs() < 1e-12);
    assert!(b.abs() < 1e-15);
    // The direction from white, (r − y)/(g − y), is unchanged.
    assert!(((r - y) / (g - y) - (2.0 - y) / (1.0 - y)).abs() < 1e-9);
    assert_eq!(within_gamut([-1.0, 0.2, -1.0]), [0.0; 3]);
}

#[test]
fn sixteen_bits_are_the_same_light_in_finer_steps() {
    let pixels = [[2.0, 1.0, 0.5], [0.001, 5.0, 0.0], [f64::NAN, 0.0, 0.0]];
    let exposure = Exposure::White(2.0);
    let (deep, white, _) = tonemap_16(&pixels, exposure).unwrap();
    let display = tonemap(&pixels, exposure).unwrap();
    assert_eq!(white, 2.0);
    for (deep, code) in deep.into_iter().zip(display.rgb) {
        assert!((f64::from(deep) / 257.0 - f64::from(code)).abs() <= 0.501);
    }
}

#[test]
fn on_a_logarithmic_scale_equal_ratios_are_equal_steps_of_code_and_hues_stay() {
    let exposure = Exposure::Logarithmic([1e-2, 1e3]);
    // Five decades over 255 codes: 51 per decade.
    for (radiance, code) in [
        (1e-3, 0),
        (1e-2, 0),
        (1e-1, 51),
        (1.0, 102),
        (1e2, 204),
        (1e3, 255),
        (1e5, 255),
    ] {
        let display = tonemap(&[[radiance; 3]], exposure).unwrap();
        assert_eq!(display.rgb, [code; 3], "{radiance}");
        assert_eq!((display.white, display.black), (1e3, Some(1e-2)));
    }
    // Red with half as much green, in linear light: decode(204/255) = 0.60383, half of which is encoded as 0.58553 = 149.31/255.
    let display = tonemap(&[[1e2, 5e1, 0.0]], exposure).unwrap();
    assert_eq!(display.rgb, [204, 149, 0]);
    assert_eq!(tonemap(&[[0.0f64; 3]], exposure).unwrap().rgb, [0; 3]);
}

#[test]
fn an_impossible_exposure_is_refused() {
    for exposure in [
        Exposure::Logarithmic([0.0, 1.0]),
        Exposure::Logarithmic([1.0, 1.0]),
        Exposure::Logarithmic([1.0, f64::INFINITY]),
        Exposure::White(0.0),
        Exposure::White(f64::NAN),
        Exposure::Percentile(0.0),
        Exposure::Percentile(101.0),
    ] {
        assert!(tonemap(&[[1.0f64; 3]], exposure).is_err());
    }
}
