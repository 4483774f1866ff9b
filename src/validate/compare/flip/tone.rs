//! The filmic curve of ACES as Narkowicz fits it, before which light is multiplied by 0.6.

const OVER: [f32; 2] = [0.6 * 0.6 * 2.51, 0.6 * 0.03];
const UNDER: [f32; 3] = [0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14];

#[inline(always)]
pub(super) fn map(x: f32) -> f32 {
    let x2 = x * x;
    (x2 * OVER[0] + x * OVER[1]) / (x2 * UNDER[0] + x * UNDER[1] + UNDER[2])
}

/// The light that becomes `t`.
pub(super) fn inverse(t: f32) -> f32 {
    let a = OVER[0] - t * UNDER[0];
    let b = OVER[1] - t * UNDER[1];
    let half = -0.5 * (b / a);
    half + (half * half + t * UNDER[2] / a).sqrt()
}
