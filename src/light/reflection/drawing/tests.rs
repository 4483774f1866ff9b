use super::super::tests::{grid, view};
use super::*;

#[test]
fn drawn_directions_give_the_integral_of_the_specular_part() {
    // ∫ f (n·l) dω of white metal over the hemisphere: by z = n·l and azimuth, and by sampling.
    for (roughness, cosine) in [(0.5, 0.9), (0.7, 0.3), (1.0, 0.6)] {
        let r = Reflection::metallic_roughness(
            DVec3::Z,
            view(cosine),
            [1.0; 3],
            [1.0, roughness],
            0.04,
        );
        let n = 400;
        let uniform = grid(n).map(|[x, y]| {
            let (z, phi) = (x, TAU * y);
            let s = (1.0 - z * z).sqrt();
            r.value(DVec3::new(s * libm::cos(phi), s * libm::sin(phi), z))[0] * z * TAU
        });
        let uniform = uniform.sum::<f64>() / (n * n) as f64;
        let drawn = grid(n).filter_map(|u| Some(r.sample_specular(u)?.1[0]));
        let drawn = drawn.sum::<f64>() / (n * n) as f64;
        assert!(
            (uniform - drawn).abs() < 2e-3,
            "{roughness} {cosine}: {uniform} {drawn}"
        );
        assert!(drawn < 1.0 + 1e-9);
    }
}

#[test]
fn directions_of_all_of_the_reflection_give_its_integral() {
    for (metallic, roughness, cosine) in [(0.0, 0.5, 0.8), (0.4, 0.7, 0.4), (1.0, 0.6, 0.9)] {
        let colour = [0.9, 0.6, 0.3];
        let r = Reflection::metallic_roughness(
            DVec3::Z,
            view(cosine),
            colour,
            [metallic, roughness],
            0.04,
        );
        let n = 600;
        let (mut uniform, mut drawn, mut all) = ([0.0; 3], [0.0; 3], 0.0);
        for [x, y] in grid(n) {
            let s = (1.0 - x * x).sqrt();
            let l = DVec3::new(s * libm::cos(TAU * y), s * libm::sin(TAU * y), x);
            let value = r.value(l);
            let scattered = r.sample([x, y]);
            for c in 0..3 {
                uniform[c] += value[c] * x * TAU / (n * n) as f64;
                drawn[c] += scattered.map_or(0.0, |s| s.weight[c]) / (n * n) as f64;
            }
            all += r.density(l) * TAU / (n * n) as f64;
        }
        for (a, b) in uniform.into_iter().zip(drawn) {
            assert!((a - b).abs() < 3e-3 * a, "{metallic} {roughness}: {a} {b}");
        }
        // The density integrates to 1, less the part below the surface.
        let lost = grid(n).filter(|u| r.sample(*u).is_none()).count();
        let kept = 1.0 - lost as f64 / (n * n) as f64;
        assert!((all - kept).abs() < 5e-3, "{metallic}: {all} {kept}");
    }
}

#[test]
fn a_mirror_sends_all_into_one_direction() {
    let v = view(0.6);
    let r =
        Reflection::metallic_roughness(DVec3::Z, v, [0.9, 0.8, 0.7], [1.0, 0.0], 0.04).as_mirror();
    let s = r.sample([0.3, 0.8]).unwrap();
    assert!((s.l - DVec3::new(-v.x, -v.y, v.z)).length() < 1e-15);
    // Schlick: f₀ + (1 − f₀) 0.4⁵.
    assert!((s.weight[1] - (0.8 + 0.2 * 0.01024)).abs() < 1e-15);
    assert!(s.density.is_infinite());
    assert_eq!(r.value(s.l), [0.0; 3]);
}
