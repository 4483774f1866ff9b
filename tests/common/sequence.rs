//! A fixed sequence of numbers, so that every run is the same.

use glam::DVec3;

/// Numbers in [0, 1) by splitmix64.
pub struct Sequence(pub u64);

impl Sequence {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 * (0.5 * f64::EPSILON)
    }

    pub fn unit(&mut self) -> DVec3 {
        let (z, azimuth) = (2.0 * self.next() - 1.0, std::f64::consts::TAU * self.next());
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * azimuth.cos(), r * azimuth.sin(), z)
    }

    /// Log-uniform in [`low`, `high`).
    pub fn scale(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }
}
