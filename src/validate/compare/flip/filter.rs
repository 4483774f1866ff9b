//! The filters, stored as halves: weights from the centre outwards.
//!
//! Contrast sensitivity: Σ aᵢ √(π/bᵢ) exp(−π²x²/bᵢ), x in degrees, out to 3 σ of the widest. The sum of two Gaussians for blue-yellow is
//! filtered as two, each with the root of its amplitude per direction. Features: a Gaussian of σ = w/2 with w = 0.082° and its first two
//! derivatives, positive and negative weights each normalised to 1.

use std::f64::consts::PI;

/// b of the luminance, red-green and the two blue-yellow Gaussians, and their a.
const SENSITIVITY: [(f64, f64); 4] = [(1.0, 0.0047), (1.0, 0.0053), (34.1, 0.04), (13.5, 0.025)];
/// The width of a feature, degrees.
const FEATURE: f64 = 0.082;
/// Weights below this fraction of the central one are below the rounding of single precision.
const NEGLIGIBLE: f64 = 1e-9;

/// All filters of an observer.
#[derive(Debug, Clone)]
pub(super) struct Filters {
    /// Radius in pixels of the widest filter.
    pub radius: usize,
    /// Luminance, red-green, and the two of blue-yellow.
    pub sensitivity: [Vec<f32>; 4],
    /// A Gaussian.
    pub smooth: Vec<f32>,
    /// Its first derivative: odd, the sum of one side is 1.
    pub edge: Vec<f32>,
    /// Its second derivative.
    pub point: Vec<f32>,
}

impl Filters {
    pub fn new(pixels_per_degree: f64) -> Self {
        let widest = SENSITIVITY.iter().map(|(_, b)| *b).fold(0.0, f64::max);
        // Three standard deviations of the widest: of a exp(−π² x²/b) that is √(b/2π²), in degrees.
        let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil();
        let deviation = 0.5 * FEATURE * pixels_per_degree;
        let reach = (3.0 * deviation).ceil() as usize;
        let radius = (radius as usize).max(reach);
        Filters {
            radius,
            sensitivity: sensitivity(radius, pixels_per_degree),
            smooth: smooth(reach, deviation),
            edge: edge(reach, deviation),
            point: point(reach, deviation),
        }
    }
}

fn sensitivity(radius: usize, pixels_per_degree: f64) -> [Vec<f32>; 4] {
    let gauss = |root: bool| {
        move |(a, b): (f64, f64)| {
            let amplitude = a * (PI / b).sqrt();
            // For a sum of two Gaussians, each axis has the root of the amplitude.
            let amplitude = if root { amplitude.sqrt() } else { amplitude };
            let weight = move |i: usize| {
                let x = i as f64 / pixels_per_degree;
                amplitude * libm::exp(-PI * PI * x * x / b)
            };
            (0..=radius).map(weight).collect::<Vec<f64>>()
        }
    };
    let [y, cx, cz1, cz2] = SENSITIVITY;
    let [y, cx] = [y, cx]
        .map(gauss(false))
        .map(|k| scaled(&k, 1.0 / even(&k)));
    let [cz1, cz2] = [cz1, cz2].map(gauss(true));
    let both = even(&cz1).hypot(even(&cz2));
    [y, cx, scaled(&cz1, 1.0 / both), scaled(&cz2, 1.0 / both)]
}

/// The sum of both sides of an even filter.
fn even(half: &[f64]) -> f64 {
    half[0] + 2.0 * half[1..].iter().sum::<f64>()
}

/// Scaled weights, without negligible ones.
fn scaled(half: &[f64], factor: f64) -> Vec<f32> {
    let counts = |weight: &f64| weight.abs() > NEGLIGIBLE * half[0].abs();
    let length = half.iter().rposition(counts).map_or(1, |last| last + 1);
    half[..length].iter().map(|w| (w * factor) as f32).collect()
}

fn gaussian(reach: usize, deviation: f64) -> impl Iterator<Item = (f64, f64)> {
    let gauss = move |x: f64| (x, libm::exp(-x * x / (2.0 * deviation * deviation)));
    (0..=reach).map(move |i| gauss(i as f64))
}

fn smooth(reach: usize, deviation: f64) -> Vec<f32> {
    let half: Vec<f64> = gaussian(reach, deviation).map(|(_, g)| g).collect();
    half.iter().map(|g| (g / even(&half)) as f32).collect()
}

fn edge(reach: usize, deviation: f64) -> Vec<f32> {
    let half: Vec<f64> = gaussian(reach, deviation).map(|(x, g)| x * g).collect();
    let side: f64 = half.iter().sum();
    half.iter().map(|w| (w / side) as f32).collect()
}

fn point(reach: usize, deviation: f64) -> Vec<f32> {
    let second = |(x, g): (f64, f64)| (x * x / (deviation * deviation) - 1.0) * g;
    let half: Vec<f64> = gaussian(reach, deviation).map(second).collect();
    // Positive and negative weights are normalised separately, each to a sum of 1.
    let part = |keep: fn(f64) -> bool| {
        let kept: Vec<f64> = half
            .iter()
            .map(|&w| if keep(w) { w } else { 0.0 })
            .collect();
        even(&kept).abs()
    };
    let (positive, negative) = (part(|w| w > 0.0), part(|w| w <= 0.0));
    let normalised = |w: &f64| w / if *w > 0.0 { positive } else { negative };
    half.iter().map(|w| normalised(w) as f32).collect()
}
