//! Many reflections at once, in loops with the bits of single evaluations.

use glam::DVec3;

use super::Reflection;
use crate::accel::vectors::{BLOCK, Columns, VectorLoop, Vectors, dispatch};

impl Reflection {
    /// [`Reflection::value`] of each of `reflections` with an index in `chosen`, for its own light direction in `l`.
    pub(crate) fn values(
        reflections: &[Reflection],
        chosen: &[u32],
        l: &Columns,
        values: &mut Columns,
    ) {
        values.resize(chosen.len());
        dispatch(Values {
            reflections,
            chosen,
            l,
            values,
        });
    }
}

/// The loop over points, whose reflections are first gathered by component.
struct Values<'a> {
    reflections: &'a [Reflection],
    chosen: &'a [u32],
    l: &'a Columns,
    values: &'a mut Columns,
}

impl VectorLoop for Values<'_> {
    #[inline(always)]
    fn run(self) {
        let mut begin = 0;
        while begin < self.chosen.len() {
            let count = (self.chosen.len() - begin).min(BLOCK);
            let chosen = &self.chosen[begin..begin + count];
            let (mut normals, mut views, mut l) = (Vectors::ZERO, Vectors::ZERO, Vectors::ZERO);
            let (mut diffuse, mut specular) = (Vectors::ZERO, Vectors::ZERO);
            let (mut facing, mut alpha) = ([1.0; BLOCK], [1.0; BLOCK]);
            // By component: points have records of their own, which a vector loop cannot read.
            for (k, point) in chosen.iter().enumerate() {
                let of = &self.reflections[*point as usize];
                normals.set(k, of.normal);
                views.set(k, of.view);
                l.set(k, self.l.get(*point as usize));
                diffuse.set(k, DVec3::from_array(of.diffuse));
                specular.set(k, DVec3::from_array(of.specular.unwrap_or_default()));
                facing[k] = of.facing;
                alpha[k] = of.alpha;
            }
            // All as glossy surfaces, in one loop.
            let mut values = Vectors::ZERO;
            for k in 0..BLOCK {
                let of = Reflection {
                    normal: normals.get(k),
                    geometric: normals.get(k),
                    view: views.get(k),
                    facing: facing[k],
                    diffuse: diffuse.get(k).to_array(),
                    specular: None,
                    alpha: alpha[k],
                    is_mirror: false,
                    through: None,
                    near: 1.0,
                };
                values.set(k, of.glossy_value(specular.get(k), l.get(k)));
            }
            // The others are evaluated one by one.
            for (k, point) in chosen.iter().enumerate() {
                let of = &self.reflections[*point as usize];
                if of.is_mirror || of.specular.is_none() {
                    let value = of.value(self.l.get(*point as usize));
                    values.set(k, DVec3::from_array(value));
                }
            }
            self.values.store(&values, begin);
            begin += BLOCK;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::view;
    use super::*;

    #[test]
    fn many_values_have_the_bits_of_single_ones() {
        let of = |k: u32| {
            let cosine = 0.05 + 0.9 * f64::from(k % 17) / 17.0;
            let colour = [0.9, 0.5, 0.1 * f64::from(k % 9)];
            match k % 5 {
                0 => Reflection::diffuse(DVec3::Z, colour),
                1 => {
                    Reflection::metallic_roughness(DVec3::Z, view(cosine), colour, [1.0, 0.0], 0.04)
                        .as_mirror()
                }
                _ => {
                    let roughness = f64::from(k % 7) / 6.0;
                    Reflection::metallic_roughness(
                        DVec3::Z,
                        view(cosine),
                        colour,
                        [0.3, roughness],
                        0.04,
                    )
                }
            }
        };
        let reflections: Vec<_> = (0..150).map(of).collect();
        let mut l = Columns::default();
        for k in 0..150 {
            l.push(view(0.01 + 0.006 * f64::from(k)));
        }
        let chosen: Vec<u32> = (0..150).filter(|k| k % 11 != 3).collect();
        let mut values = Columns::default();
        Reflection::values(&reflections, &chosen, &l, &mut values);
        for (at, k) in chosen.iter().map(|k| *k as usize).enumerate() {
            assert_eq!(
                values.get(at).to_array(),
                reflections[k].value(l.get(k)),
                "{k}"
            );
        }
    }
}
