//! Channels as rows of f64 or f32, whatever their precision.

use crate::io::image::{Channel, Layers, Samples};

/// One channel of a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane<'a> {
    samples: &'a Samples,
    width: usize,
}

impl<'a> Plane<'a> {
    pub fn new(layers: &'a Layers, channel: &'a Channel) -> Self {
        Plane {
            samples: &channel.samples,
            width: layers.width as usize,
        }
    }

    /// The channel of this name, where there is one.
    pub fn find(layers: &'a Layers, name: &str) -> Option<Self> {
        Some(Plane::new(layers, layers.channel(name)?))
    }

    /// Three channels of one group, in the order of `components`.
    pub fn group(layers: &'a Layers, names: [&str; 3]) -> Option<[Self; 3]> {
        let [a, b, c] = names.map(|name| Plane::find(layers, name));
        Some([a?, b?, c?])
    }

    /// A sample as f64.
    #[inline]
    pub fn at(&self, index: usize) -> f64 {
        match self.samples {
            Samples::F32(v) => v[index].into(),
            Samples::F64(v) => v[index],
            Samples::U32(v) => v[index].into(),
            Samples::I32(v) => v[index].into(),
        }
    }

    /// Row `y` as f64, into `row`.
    pub fn row(&self, y: usize, row: &mut Vec<f64>) {
        let span = y * self.width..(y + 1) * self.width;
        row.clear();
        match self.samples {
            Samples::F32(v) => row.extend(v[span].iter().map(|&x| f64::from(x))),
            Samples::F64(v) => row.extend_from_slice(&v[span]),
            Samples::U32(v) => row.extend(v[span].iter().map(|&x| f64::from(x))),
            Samples::I32(v) => row.extend(v[span].iter().map(|&x| f64::from(x))),
        }
    }

    /// Columns `x` of row `y`, rounded to f32, into `row`.
    pub fn part(&self, y: usize, x: std::ops::Range<usize>, row: &mut [f32]) {
        let span = y * self.width + x.start..y * self.width + x.end;
        match self.samples {
            Samples::F32(v) => row.copy_from_slice(&v[span]),
            Samples::F64(v) => fill(row, &v[span], |x| x as f32),
            Samples::U32(v) => fill(row, &v[span], |x| x as f32),
            Samples::I32(v) => fill(row, &v[span], |x| x as f32),
        }
    }

    /// Whether samples were rounded to single precision.
    pub fn is_single(&self) -> bool {
        matches!(self.samples, Samples::F32(_))
    }
}

fn fill<T: Copy>(row: &mut [f32], samples: &[T], convert: impl Fn(T) -> f32) {
    for (to, from) in row.iter_mut().zip(samples) {
        *to = convert(*from);
    }
}
