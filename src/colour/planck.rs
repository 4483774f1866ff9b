//! Planck's law.

use crate::spacetime::SPEED_OF_LIGHT;

/// Planck's constant times the speed of light over Boltzmann's constant, m K (exact in SI: 2019).
const SECOND_RADIATION_CONSTANT: f64 = 6.626_070_15e-34 * SPEED_OF_LIGHT / 1.380_649e-23;

/// 2 h c², W m² / sr (exact).
const FIRST_RADIATION_CONSTANT: f64 = 2.0 * 6.626_070_15e-34 * SPEED_OF_LIGHT * SPEED_OF_LIGHT;

/// Planck's law: W m⁻² sr⁻¹ per metre of wavelength, at a temperature in kelvin.
pub fn planck(wavelength: f64, temperature: f64) -> f64 {
    let x = SECOND_RADIATION_CONSTANT / (wavelength * temperature);
    // λ⁻⁵ last: neither factor overflows for any wavelength that is looked at.
    FIRST_RADIATION_CONSTANT
        / libm::expm1(x)
        / (wavelength * wavelength * wavelength)
        / (wavelength * wavelength)
}

/// Its integral over all wavelengths, W m⁻² sr⁻¹: σT⁴/π with σ = 2π⁵k⁴/(15h³c²), which is c₁ π⁴ T⁴ / (15 c₂⁴) with c₁ = 2hc²
/// and c₂ = hc/k.
pub(super) fn planck_total(temperature: f64) -> f64 {
    let x = temperature * std::f64::consts::PI / SECOND_RADIATION_CONSTANT;
    FIRST_RADIATION_CONSTANT * x * x * x * x / 15.0
}
