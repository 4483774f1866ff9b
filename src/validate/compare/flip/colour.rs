//! Colour spaces and elementary functions, in single precision, written so that they vectorise.
//!
//! No library function is called per pixel and nothing is contracted: the same bits on every machine. Errors of the elementary functions
//! are a few units in the last place, below the precision of the published tool.

/// CIE XYZ from linear sRGB: the fractions of the published tool, divided by the white point below.
const XYZ: [[f64; 3]; 3] = [
    [
        10135552.0 / 24577794.0,
        8788810.0 / 24577794.0,
        4435075.0 / 24577794.0,
    ],
    [
        2613072.0 / 12288897.0,
        8788810.0 / 12288897.0,
        887015.0 / 12288897.0,
    ],
    [
        1425312.0 / 73733382.0,
        8788810.0 / 73733382.0,
        70074185.0 / 73733382.0,
    ],
];
/// Linear sRGB from CIE XYZ: the numbers of the published tool, like the white point.
const RGB: [[f64; 3]; 3] = [
    [3.241003275, -1.537398934, -0.498615861],
    [-0.969224334, 1.875930071, 0.041554224],
    [0.055639423, -0.204011202, 1.057148933],
];
/// The white point D65.
const WHITE: [f64; 3] = [0.950428545, 1.0, 1.088900371];

/// A matrix by rows, which multiplies a colour.
pub(super) type Matrix = [[f32; 3]; 3];

/// X/Xw, Y/Yw, Z/Zw of linear RGB.
pub(super) const RELATIVE_XYZ: Matrix = {
    let mut m = [[0.0; 3]; 3];
    let mut i = 0;
    while i < 9 {
        m[i / 3][i % 3] = (XYZ[i / 3][i % 3] / WHITE[i / 3]) as f32;
        i += 1;
    }
    m
};

/// Y + 16, Cx, Cz of linear RGB.
pub(super) const OPPONENT: Matrix = {
    let mut m = [[0.0; 3]; 3];
    let mut k = 0;
    while k < 3 {
        let [x, y, z] = [XYZ[0][k] / WHITE[0], XYZ[1][k], XYZ[2][k] / WHITE[2]];
        m[0][k] = (116.0 * y) as f32;
        m[1][k] = (500.0 * (x - y)) as f32;
        m[2][k] = (200.0 * (y - z)) as f32;
        k += 1;
    }
    m
};

/// Linear RGB of Y + 16, Cx, Cz.
pub(super) const FROM_OPPONENT: Matrix = {
    let mut m = [[0.0; 3]; 3];
    let mut i = 0;
    while i < 3 {
        let [x, y, z] = [RGB[i][0] * WHITE[0], RGB[i][1], RGB[i][2] * WHITE[2]];
        m[i][0] = ((x + y + z) / 116.0) as f32;
        m[i][1] = (x / 500.0) as f32;
        m[i][2] = (-z / 200.0) as f32;
        i += 1;
    }
    m
};

#[inline(always)]
pub(super) fn apply(m: &Matrix, [a, b, c]: [f32; 3]) -> [f32; 3] {
    [
        m[0][0] * a + m[0][1] * b + m[0][2] * c,
        m[1][0] * a + m[1][1] * b + m[1][2] * c,
        m[2][0] * a + m[2][1] * b + m[2][2] * c,
    ]
}

/// x in [0, 1]; 0 for NaN.
#[inline(always)]
pub(super) fn clip(x: f32) -> f32 {
    let x = if x > 0.0 { x } else { 0.0 };
    if x < 1.0 { x } else { 1.0 }
}

/// CIELAB of linear RGB in [0, 1], a* and b* scaled after Hunt by L*/100.
#[inline(always)]
pub(super) fn hunt_lab(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = apply(&RELATIVE_XYZ, rgb);
    let (x, y, z) = (compressed(x), compressed(y), compressed(z));
    let l = 116.0 * y - 16.0;
    [
        l,
        0.01 * l * (500.0 * (x - y)),
        0.01 * l * (200.0 * (y - z)),
    ]
}

/// CIELAB's cube root, linear near black.
#[inline(always)]
fn compressed(t: f32) -> f32 {
    const DELTA: f32 = 6.0 / 29.0;
    let linear = t * (1.0 / (3.0 * DELTA * DELTA)) + 4.0 / 29.0;
    let root = cube_root(t);
    if t > DELTA * DELTA * DELTA {
        root
    } else {
        linear
    }
}

/// The distance HyAB: city-block in lightness, Euclidean in colour.
#[inline(always)]
pub(super) fn hyab(a: [f32; 3], b: [f32; 3]) -> f32 {
    let [l, u, v] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    l.abs() + (u * u + v * v).sqrt()
}

/// ∛x for x above 0.008: Halley's iteration from a guess by the exponent.
#[inline(always)]
pub(super) fn cube_root(x: f32) -> f32 {
    // A third of the exponent; the constant compensates for its bias.
    let mut y = f32::from_bits(x.to_bits() / 3 + 709_958_130);
    for _ in 0..2 {
        let cube = y * y * y;
        y *= (cube + 2.0 * x) / (2.0 * cube + x);
    }
    y
}

/// xʸ for x ≥ 0 and y from 0 to 1, with 0⁰ = 1.
#[inline(always)]
pub(super) fn power(x: f32, y: f32) -> f32 {
    let log = y * log2(x.max(f32::MIN_POSITIVE));
    let power = exp2(log.max(-126.0));
    let zero = if y > 0.0 { 0.0 } else { 1.0 };
    if x >= f32::MIN_POSITIVE { power } else { zero }
}

/// log₂ of a normal number: exponent, and the series of artanh for the mantissa in [√½, √2).
#[inline(always)]
fn log2(x: f32) -> f32 {
    // 0x3f3504f3 is √½, the lower end of the mantissa's range.
    let bits = x.to_bits().wrapping_sub(0x3f35_04f3);
    let exponent = (bits as i32) >> 23;
    let mantissa = f32::from_bits((bits & 0x007f_ffff).wrapping_add(0x3f35_04f3));
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let s2 = s * s;
    let series = 1.0 + s2 * (1.0 / 3.0 + s2 * (0.2 + s2 * (1.0 / 7.0 + s2 * (1.0 / 9.0))));
    exponent as f32 + 2.0 * std::f32::consts::LOG2_E * s * series
}

/// 2ˣ for x from −126 to 127: exponent, and the series of exp for the rest in [−½, ½].
#[inline(always)]
fn exp2(x: f32) -> f32 {
    // Adding and subtracting 1.5 · 2²³ rounds to integers.
    const SHIFT: f32 = 12_582_912.0;
    let whole = (x + SHIFT) - SHIFT;
    let t = (x - whole) * std::f32::consts::LN_2;
    // Taylor's series to t⁷: |t| ≤ ½ ln 2, so that the next term is below f32's rounding.
    let p = 1.0 / 120.0 + t * (1.0 / 720.0 + t * (1.0 / 5040.0));
    let p = 1.0 + t * (1.0 + t * (0.5 + t * (1.0 / 6.0 + t * (1.0 / 24.0 + t * p))));
    p * f32::from_bits((((whole as i32) + 127) as u32) << 23)
}

/// CIELAB after Hunt of filtered Y + 16, Cx, Cz.
#[inline(always)]
pub(super) fn lab(v: &[f32; 5]) -> [f32; 3] {
    let [r, g, b] = apply(&FROM_OPPONENT, [v[0], v[1], v[2]]);
    hunt_lab([clip(r), clip(g), clip(b)])
}

/// Numerator and denominator of the filmic curve of ACES as fitted by Narkowicz, with light multiplied by 0.6 beforehand.
const OVER: [f32; 2] = [0.6 * 0.6 * 2.51, 0.6 * 0.03];
const UNDER: [f32; 3] = [0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14];

/// The brightest light, shown as white, whose square is finite in f32: brighter light would be ∞/∞.
const BRIGHTEST: f32 = 1e9;

/// The curve: from light to its display value.
#[inline(always)]
pub(super) fn tone_map(x: f32) -> f32 {
    let x = if x > BRIGHTEST { BRIGHTEST } else { x };
    let x2 = x * x;
    (x2 * OVER[0] + x * OVER[1]) / (x2 * UNDER[0] + x * UNDER[1] + UNDER[2])
}

/// The light whose display value is `t`.
pub(super) fn inverse_tone_map(t: f32) -> f32 {
    let a = OVER[0] - t * UNDER[0];
    let b = OVER[1] - t * UNDER[1];
    // The larger root of a x² + b x − t u₂ = 0.
    let half = -0.5 * (b / a);
    half + (half * half + t * UNDER[2] / a).sqrt()
}

/// Raises to the power that the definition applies to colour differences.
#[inline(always)]
pub(super) fn power_of_definition(distance: f32) -> f32 {
    power(distance, 0.7)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_of_any_brightness_is_shown_as_white() {
        for x in [1e3, 1e9, 1e19, 1e20, f32::MAX, f32::INFINITY] {
            assert_eq!(clip(tone_map(x)), 1.0, "{x}");
        }
        assert!(tone_map(1e-40) >= 0.0 && tone_map(f32::NAN).is_nan());
    }

    #[test]
    fn elementary_functions_are_right_to_a_few_units() {
        for i in 1..=20_000 {
            let x = i as f32 / 10_000.0;
            let close = |got: f32, exact: f64, units: f64| {
                let error = (f64::from(got) - exact).abs();
                assert!(error <= units * 6e-8 * exact, "{x}: {got} for {exact}");
            };
            // 3.8 units of 6e-8 at worst, and 3.2 however often the iteration is repeated.
            close(
                cube_root(x.max(0.0089)),
                libm::cbrt(x.max(0.0089).into()),
                4.0,
            );
            close(power(x, 0.7), libm::pow(x.into(), f64::from(0.7f32)), 12.0);
            close(power(x, 0.03), libm::pow(x.into(), f64::from(0.03f32)), 4.0);
        }
        assert_eq!(
            [power(0.0, 0.7), power(0.0, 0.0), power(1.0, 0.3)],
            [0.0, 1.0, 1.0]
        );
    }

    #[test]
    fn the_opponent_space_goes_both_ways() {
        for rgb in [[0.2, 0.5, 0.9], [1.0, 0.0, 0.3]] {
            let back = apply(&FROM_OPPONENT, apply(&OPPONENT, rgb));
            for k in 0..3 {
                assert!((back[k] - rgb[k]).abs() < 2e-5, "{back:?}");
            }
        }
    }
}
