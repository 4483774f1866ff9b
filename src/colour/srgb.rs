//! The sRGB space (IEC 61966-2-1:1999): transfer function, and its primaries in CIE XYZ.
//!
//! V = 12.92 L below L = 0.0031308, else 1.055 L^(1/2.4) − 0.055. Primaries (0.64, 0.33), (0.30, 0.60),
//! (0.15, 0.06), white D65 (0.3127, 0.3290), Y of white 1.

/// Linear sRGB from CIE XYZ: the inverse of the matrix with the primaries as columns, each scaled so that they add up to white.
const RGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.240969941904523, -1.537383177570094, -0.498610760293003],
    [-0.969243636280880, 1.875967501507721, 0.041555057407176],
    [0.055630079696994, -0.203976958888977, 1.056971514242879],
];

/// Linear sRGB of a CIE XYZ colour; components are below 0 outside the gamut.
pub fn rgb_from_xyz(xyz: [f64; 3]) -> [f64; 3] {
    RGB_FROM_XYZ.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
}

/// Linear light in [0, 1] of a code value in [0, 1].
pub fn srgb_decode(value: f64) -> f64 {
    if value <= 0.04045 {
        value / 12.92
    } else {
        libm::pow((value + 0.055) / 1.055, 2.4)
    }
}

/// Code value in [0, 1] of linear light in [0, 1].
pub fn srgb_encode(linear: f64) -> f64 {
    if linear <= 0.0031308 {
        12.92 * linear
    } else {
        1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
    }
}

/// The nearest 8-bit code of linear light, clipped to [0, 1]; NaN gives 0.
pub fn srgb_encode_8(linear: f64) -> u8 {
    // The comparison is false for NaN too; `as` saturates and rounds down.
    if linear > 0.0 {
        (255.0 * srgb_encode(linear.min(1.0)) + 0.5) as u8
    } else {
        0
    }
}

/// The nearest 16-bit code, likewise.
pub fn srgb_encode_16(linear: f64) -> u16 {
    if linear > 0.0 {
        (65535.0 * srgb_encode(linear.min(1.0)) + 0.5) as u16
    } else {
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_8_bit_code_survives_decoding_and_encoding() {
        for code in 0..=255u8 {
            assert_eq!(srgb_encode_8(srgb_decode(f64::from(code) / 255.0)), code);
        }
    }

    #[test]
    fn the_transfer_function_has_the_standard_values() {
        // Half of white's light is code 188, and code 119 is 18.4 % grey.
        assert_eq!(srgb_encode_8(0.5), 188);
        assert!((srgb_decode(119.0 / 255.0) - 0.18447).abs() < 1e-5);
        assert_eq!(
            [f64::NAN, -1.0, f64::INFINITY].map(srgb_encode_8),
            [0, 0, 255]
        );
    }

    #[test]
    fn d65_is_white() {
        let (x, y) = (0.3127, 0.3290);
        let white = rgb_from_xyz([x / y, 1.0, (1.0 - x - y) / y]);
        for component in white {
            assert!((component - 1.0).abs() < 1e-12, "{white:?}");
        }
    }

    #[test]
    fn each_primary_has_its_component_alone() {
        for (k, (x, y)) in [(0.64, 0.33), (0.30, 0.60), (0.15, 0.06)]
            .into_iter()
            .enumerate()
        {
            let rgb = rgb_from_xyz([x / y, 1.0, (1.0 - x - y) / y]);
            for (i, component) in rgb.into_iter().enumerate() {
                assert_eq!(component.abs() > 1e-12, i == k, "{rgb:?}");
            }
        }
    }
}
