//! The sky: radiance of all directions of the world, from afar.
//!
//! A look direction d of the world sees the radiance L(d) of the background, of the sun and of the stars within whose
//! discs it lies. An observer in motion sees W⁻ᵖ L along the aberrated direction (W = ω_world/ω_observer, p by the
//! declared quantity), which is what a camera's ray that meets nothing has as its W anyway; discs keep their radiance
//! and change their solid angle with W², so that their irradiance is that of [`lamp`](super::lamp).
//!
//! A pixel of the angle a sees a/W of the world's sky: ahead, where W is small, the sky is crowded, and pictures are
//! looked up in a copy whose texels are as wide as that (`panorama`).

mod boosted;
mod catalogue;
mod panorama;
mod stars;

use glam::DVec3;

pub use boosted::{BoostedSky, SkySample};
pub use catalogue::stars;
pub use panorama::Panorama;
pub use stars::{Star, StarMap};

use crate::scene::model;

/// A sky, ready to be looked at.
#[derive(Debug)]
pub struct Sky {
    background: Background,
    sun: Option<Disc>,
    stars: Option<StarMap>,
}

#[derive(Debug)]
enum Background {
    Uniform([f64; 3]),
    Gradient {
        zenith: [f64; 3],
        horizon: [f64; 3],
        ground: [f64; 3],
    },
    Image(Panorama),
}

/// The sun: the directions whose cosine with its own is above one.
#[derive(Debug)]
struct Disc {
    direction: DVec3,
    cosine: f64,
    radiance: [f64; 3],
}

impl Sky {
    /// `sky`, with its picture, where it has one, and its stars.
    pub fn new(sky: &model::Sky, panorama: Option<Panorama>, stars: Vec<Star>) -> Sky {
        let background = match (&sky.background, panorama) {
            (_, Some(panorama)) => Background::Image(panorama),
            (model::SkyRadiance::Uniform(radiance), _) => Background::Uniform(*radiance),
            (
                model::SkyRadiance::Gradient {
                    zenith,
                    horizon,
                    ground,
                },
                _,
            ) => Background::Gradient {
                zenith: *zenith,
                horizon: *horizon,
                ground: *ground,
            },
            (model::SkyRadiance::Image { .. }, None) => Background::Uniform([0.0; 3]),
        };
        let radius = sky.stars.as_ref().map_or(0.0, |stars| stars.radius);
        Sky {
            background,
            sun: sky.sun.map(|sun| Disc {
                direction: sun.direction,
                cosine: libm::cos(sun.radius),
                radiance: sun.radiance(),
            }),
            stars: (!stars.is_empty()).then(|| StarMap::new(stars, radius)),
        }
    }

    /// Radiance along the look direction `d` of the world, as a pixel sees it that is `angle` wide there.
    #[inline]
    pub fn radiance(&self, d: DVec3, angle: f64) -> [f64; 3] {
        let mut radiance = self.without_sun(d, angle);
        if let Some(sun) = self
            .sun
            .as_ref()
            .filter(|sun| d.dot(sun.direction) > sun.cosine)
        {
            radiance = sum(radiance, sun.radiance);
        }
        radiance
    }

    /// The same without the sun, which lights surfaces as a lamp does.
    #[inline]
    pub fn without_sun(&self, d: DVec3, angle: f64) -> [f64; 3] {
        let background = self.background.radiance(d, angle);
        match &self.stars {
            None => background,
            Some(stars) => sum(background, stars.radiance(d)),
        }
    }
}

impl Background {
    #[inline]
    fn radiance(&self, d: DVec3, angle: f64) -> [f64; 3] {
        match self {
            Background::Uniform(radiance) => *radiance,
            Background::Gradient {
                zenith,
                horizon,
                ground,
            } => {
                if d.y < 0.0 {
                    return *ground;
                }
                let square = (1.0 - d.y) * (1.0 - d.y);
                let weight = 1.0 - square * square;
                std::array::from_fn(|c| horizon[c] + (zenith[c] - horizon[c]) * weight)
            }
            Background::Image(panorama) => panorama.radiance(d, angle),
        }
    }
}

#[inline]
fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| a[c] + b[c])
}
