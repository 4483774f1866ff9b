use super::super::Reflection;
use super::*;

#[test]
fn glossy_surfaces_in_loops_have_the_bits_of_single_ones() {
    for k in 0..500 {
        let part = |n: u32| f64::from(k * n % 101) / 100.0;
        let (n, v) = (
            DVec3::Z,
            DVec3::new(part(3), -part(5), 0.1 + part(7)).normalize(),
        );
        let l = DVec3::new(-part(11), part(13), 0.01 + part(17)).normalize();
        let (colour, look) = ([part(19), part(23), part(29)], [part(31), part(37)]);
        let one = Reflection::metallic_roughness(n, v, colour, look, 0.04).value(l);
        let many = |look| Coefficients::new(colour.into(), look, 0.04);
        let all = many(look).value_at::<false, false>(n, v, l).to_array();
        assert_eq!(one.map(f64::to_bits), all.map(f64::to_bits));
        // Fully rough surfaces and metals have loops of their own.
        let one = |m, r| Reflection::metallic_roughness(n, v, colour, [m, r], 0.04).value(l);
        let rough = many([look[0], 1.0]).value_at::<true, false>(n, v, l);
        assert_eq!(one(look[0], 1.0), rough.to_array());
        let metal = many([1.0, look[1]]).value_at::<false, true>(n, v, l);
        assert_eq!(one(1.0, look[1]), metal.to_array());
        let both = many([1.0, 1.0]).value_at::<true, true>(n, v, l);
        assert_eq!(one(1.0, 1.0), both.to_array());
    }
}

#[test]
fn reflection_with_one_division_is_that_of_the_formulas() {
    // F D V from h, with D and V computed separately; including peaks of smooth surfaces and grazing light.
    for k in 0..500 {
        let part = |n: u32| f64::from(k * n % 101) / 100.0;
        let v = DVec3::new(part(3), -part(5), 0.02 + part(7)).normalize();
        let l = match k % 4 {
            0 => DVec3::new(-v.x, -v.y, v.z),
            _ => DVec3::new(-part(11), part(13), 0.01 + part(17)).normalize(),
        };
        let colour = [part(19), part(23), part(29)];
        let r = Reflection::metallic_roughness(DVec3::Z, v, colour, [part(31), part(37)], 0.04);
        let h = (v + l).normalize();
        let gloss = r.distribution(h.z) * r.visibility(l.z);
        let weight = schlick(v.dot(h));
        for (c, value) in r.value(l).into_iter().enumerate() {
            let f0 = r.specular.unwrap()[c];
            let f = f0 + (1.0 - f0) * weight;
            let expected = (1.0 - f) * r.diffuse[c] / PI + f * gloss;
            // At peaks of α = 10⁻³ the cancelling 1 in D leaves α² = 10⁻⁶, with an error of some eps.
            let alpha = r.alpha * r.alpha;
            let bound = 1e-14 + 1e-15 / alpha;
            assert!(
                (value - expected).abs() <= bound * expected,
                "{k}: {value} {expected}"
            );
        }
    }
}

#[test]
fn light_that_grazes_from_behind_has_the_normal_between() {
    // v + l = 0: h = n, so that n·h = 1 and v·h = n·v, which is kept above 0.
    let r = Reflection::metallic_roughness(DVec3::Z, DVec3::X, [0.5; 3], [1.0, 0.5], 0.04);
    let gloss = r.distribution(1.0) * r.visibility(0.0);
    let expected = gloss * (0.5 + 0.5 * schlick(r.facing));
    let value = r.value(DVec3::NEG_X)[0];
    assert!(
        (value - expected).abs() < 1e-14 * expected,
        "{value} {expected}"
    );
}
