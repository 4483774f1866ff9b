use super::super::tests::{grid, view};
use super::*;

#[test]
fn glass_reflects_by_fresnel_and_bends_by_snell() {
    // At normal incidence ((n − 1)/(n + 1))², in glass of 1.5 as from air; nothing polarized in the plane of incidence is reflected at
    // Brewster's angle, whose tangent is n, and (n² − 1)²/(n² + 1)²/2 of unpolarized light is; beyond the critical angle, sin θ = 1/n,
    // all of it.
    let n = 1.5;
    let glass = |v, near: f64, far: f64| {
        let r = Reflection::metallic_roughness(DVec3::Z, v, [1.0; 3], [0.0, 0.0], 0.04);
        r.within(near).as_glass(1.0, far, true)
    };
    let reflected = |r: Reflection| r.through.unwrap().reflected;
    assert!((reflected(glass(DVec3::Z, 1.0, n)) - 0.04).abs() < 1e-15);
    assert!((reflected(glass(DVec3::Z, n, 1.0)) - 0.04).abs() < 1e-15);
    let brewster = view(1.0 / (1.0 + n * n).sqrt());
    let expected = 0.5 * ((n * n - 1.0) / (n * n + 1.0)).powi(2);
    assert!((reflected(glass(brewster, 1.0, n)) - expected).abs() < 1e-15);
    let beyond = glass(view(0.74), n, 1.0);
    assert!(0.74f64 < (1.0 - 1.0 / (n * n)).sqrt() && reflected(beyond.clone()) == 1.0);
    assert!(beyond.sample([0.999, 0.5]).unwrap().l.z > 0.0);
    // A transmitted direction: n₁ sin θ₁ = n₂ sin θ₂ on the other side, and radiance as n².
    let s = glass(view(0.6), 1.0, n).sample([0.95, 0.5]).unwrap();
    assert!((s.l - DVec3::new(-0.8 / n, 0.0, -(1.0 - 0.64 / (n * n)).sqrt())).length() < 1e-15);
    assert!((s.index, s.density) == (n, f64::INFINITY));
    let drawn = grid(200).map(|u| glass(view(0.6), 1.0, n).sample(u).unwrap());
    let (mut up, mut down) = (0.0, 0.0);
    for s in drawn {
        *if s.l.z > 0.0 { &mut up } else { &mut down } += s.weight[0] / 40_000.0;
    }
    let f = reflected(glass(view(0.6), 1.0, n));
    assert!(
        (up - f).abs() < 1e-3 && (down - (1.0 - f) / (n * n)).abs() < 1e-3,
        "{up} {down} {f}"
    );
}

#[test]
fn glass_is_drawn_as_a_mirror_as_far_as_it_is_one() {
    let glass = |v, index: f64| {
        let r = Reflection::metallic_roughness(DVec3::Z, v, [1.0; 3], [0.0, 0.0], 0.04);
        r.within(1.0).as_glass(1.0, index, true)
    };
    // At index 1 nothing is reflected, and each sample is transmitted with all of the light.
    for cosine in [1.0, 0.6, 0.05] {
        for u in grid(50) {
            let s = glass(view(cosine), 1.0).sample(u).unwrap();
            assert!(s.l.z < 0.0 && s.weight.iter().all(|w| (w - 1.0).abs() < 1e-12));
        }
    }
    // At other indices each part is sampled with its probability, and weighted with its share divided by that.
    for (cosine, index) in [
        (1.0, 1.05),
        (1.0, 1.3),
        (1.0, 1.5),
        (0.3, 1.5),
        (0.002, 1.5),
    ] {
        let r = glass(view(cosine), index);
        let f = r.through.as_ref().unwrap().reflected;
        let q = r.specular_share();
        let through = (1.0 - f) / (index * index);
        for (at, up, part) in [
            (1e-9, true, f / q),
            (1.0 - 1e-9, true, f / q),
            (1.0 + 1e-9, false, through / (1.0 - q)),
            (1.0 / q - 1e-9, false, through / (1.0 - q)),
        ] {
            let s = r.sample([at * q, 0.5]).unwrap();
            let weight = s.weight[0];
            assert!(
                (s.l.z > 0.0) == up && (weight / part - 1.0).abs() < 1e-9,
                "{index} {at}"
            );
        }
        assert!(
            q >= f.min(0.1) && q <= f.max(0.1) && q <= 2.5 * f,
            "{index}: {q} {f}"
        );
        assert!(1.0 - q <= 2.5 * (1.0 - f), "{index}: {q} {f}");
    }
    assert_eq!([0.0, 0.5, 1.0].map(chance_of_mirror), [0.0, 0.5, 1.0]);
}
