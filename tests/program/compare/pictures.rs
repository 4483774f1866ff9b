//! Pictures made by formulas.

use nullray::io::image::{Channel, Layers, Samples};
use nullray::validate::compare::{Encoding, Picture};

/// Layers of f64 channels.
pub fn layers(width: u32, height: u32, channels: &[(&str, Vec<f64>)]) -> Layers {
    let channels = channels.iter().map(|(name, values)| Channel {
        name: name.to_string(),
        samples: Samples::F64(values.clone()),
    });
    Layers::new(width, height, channels.collect(), vec![]).unwrap()
}

/// A value per pixel.
pub fn field(width: u32, height: u32, value: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let at = |i: u32| value(f64::from(i % width), f64::from(i / width));
    (0..width * height).map(at).collect()
}

/// The reference and the candidate of `tests/data/compare/make.py`.
pub fn light(width: u32, height: u32) -> [Picture; 2] {
    let value = |candidate: bool| {
        move |x: u32, y: u32, c: u32| {
            let noise = ((x * 37 + y * 57 + c * 101) ^ (x * y)) % 256;
            let smooth = (x * x + 3 * y * y + c * 50 * x) % 1024;
            let board = if (x / 40 + y / 30) % 2 == 1 { 4.0 } else { 1.0 };
            let ramp = f64::from(1u32 << (x * 6 / width));
            let light =
                (f64::from(noise) / 1024.0 + f64::from(smooth) / 256.0) * board * ramp / 64.0;
            let factor = 1.0 + (f64::from((x * 13 + y * 7 + c) % 17) - 6.0) / 64.0;
            (if candidate { light * factor } else { light }) as f32
        }
    };
    [false, true].map(|candidate| Picture::linear("light", rgb(width, height, value(candidate))))
}

/// The same as 8-bit codes.
pub fn codes(width: u32, height: u32) -> [Picture; 2] {
    light(width, height).map(|mut picture| {
        for channel in &mut picture.layers.channels {
            let code = |v: f64| (255.0 * v.min(1.0)).floor() / 255.0;
            let codes = channel.samples.to_f64().into_iter().map(code);
            channel.samples = Samples::F64(codes.collect());
        }
        picture.encoding = Encoding::Srgb;
        picture
    })
}

fn rgb(width: u32, height: u32, value: impl Fn(u32, u32, u32) -> f32) -> Layers {
    let channel = |c: u32| Channel {
        name: ["radiance.R", "radiance.G", "radiance.B"][c as usize].into(),
        samples: Samples::F32(
            (0..width * height)
                .map(|i| value(i % width, i / width, c))
                .collect(),
        ),
    };
    Layers::new(width, height, (0..3).map(channel).collect(), vec![]).unwrap()
}
