use super::*;

/// A number from −1 to 1.
fn part(k: usize, n: usize) -> f64 {
    (k * n % 103) as f64 / 51.0 - 1.0
}

/// More than one block of factors, many of them 0.
fn factors() -> Vec<f64> {
    (0..150).map(|k| part(k, 7).max(0.0)).collect()
}

fn columns(of: impl Fn(usize) -> DVec3) -> Columns {
    let mut columns = Columns::default();
    (0..150).for_each(|k| columns.push(of(k)));
    columns
}

fn all(columns: &Columns) -> Vec<[f64; 3]> {
    let mut all = vec![];
    columns.add_to(&mut all);
    all
}

#[test]
fn light_of_one_colour_has_the_bits_of_light_with_a_colour_at_each_point() {
    let colour = DVec3::new(0.3, 0.7, 1.1);
    let (factors, colours) = (factors(), columns(|_| colour));
    let sum = |constant, weighs| {
        let mut gathered = Gathered::default();
        gathered.start(factors.len(), weighs);
        for _ in 0..3 {
            let light = Light {
                constant,
                colours: &colours,
                ratios: None,
                factors: &factors,
            };
            dispatch(Gather {
                light,
                is_first: false,
                gathered: &mut gathered,
            });
        }
        all(&gathered.sum)
    };
    let expected = sum(None, false);
    let lit = expected.iter().filter(|[r, ..]| *r > 0.0).count();
    assert!((50..100).contains(&lit), "{lit}");
    assert_eq!(sum(Some(colour), false), expected);
    assert_eq!(sum(Some(colour), true), expected);
}

#[test]
fn surfaces_that_are_all_alike_reflect_as_if_each_had_a_finish_of_its_own() {
    let unit = |k, n| DVec3::new(part(k, n), part(k, n + 4), 1.5).normalize();
    let (normals, views, l) = (
        columns(|k| unit(k, 3)),
        columns(|k| unit(k, 5)),
        columns(|k| unit(k, 11)),
    );
    let (factors, none) = (factors(), Columns::default());
    let colour = [0.2, 0.5, 0.9];
    for look in [[1.0, 1.0], [0.4, 0.3]] {
        let mut each = Glosses::default();
        each.metallic.resize(factors.len(), look[0]);
        each.roughness.resize(factors.len(), look[1]);
        each.colours = columns(|_| colour.into());
        each.dielectric = 0.2;
        let mut alike = Glosses::default();
        alike.fill_alike([0.1; 3], [0.5; 2], 0.04);
        alike.clear();
        alike.fill_alike(colour, look, 0.2);
        let reflected = |glosses: &Glosses| {
            let (mut gathered, mut added) = (Gathered::default(), Columns::default());
            gathered.start(factors.len(), false);
            added.fill(factors.len(), DVec3::ZERO);
            dispatch(Gloss {
                light: Light {
                    constant: Some(DVec3::ONE),
                    colours: &none,
                    ratios: None,
                    factors: &factors,
                },
                glosses,
                normals: &normals,
                views: (&views, 1.0),
                l: &l,
                gathered: &mut gathered,
                is_first: false,
                added: &mut added,
            });
            all(&added)
        };
        let expected = reflected(&each);
        let lit = expected[BLOCK..].iter().filter(|[r, ..]| *r > 0.0).count();
        assert!((20..70).contains(&lit), "{lit}");
        assert_eq!(reflected(&alike), expected);
    }
}

#[test]
fn the_first_light_overwrites_what_was_there_and_tangents_count_as_views_the_other_way_round() {
    let unit = |k, n| DVec3::new(part(k, n), part(k, n + 4), 1.5).normalize();
    let (normals, views, tangents, l) = (
        columns(|k| unit(k, 3)),
        columns(|k| unit(k, 5)),
        columns(|k| -unit(k, 5)),
        columns(|k| unit(k, 11)),
    );
    // No light arrives at the second of three blocks.
    let mut factors = factors();
    factors[BLOCK..2 * BLOCK].fill(0.0);
    let (none, mut glosses) = (Columns::default(), Glosses::default());
    glosses.fill_alike([0.2, 0.5, 0.9], [1.0, 1.0], 0.04);
    let lit = |is_first: bool, weighs: bool| {
        let light = Light {
            constant: Some(DVec3::new(0.3, 0.7, 1.1)),
            colours: &none,
            ratios: None,
            factors: &factors,
        };
        let before = if is_first { DVec3::NAN } else { DVec3::ZERO };
        let (mut gathered, mut added) = (Gathered::default(), Columns::default());
        gathered.start(factors.len(), weighs);
        gathered.sum.fill(factors.len(), before);
        added.fill(factors.len(), before);
        dispatch(Gather {
            light,
            is_first,
            gathered: &mut gathered,
        });
        dispatch(Gloss {
            light,
            glosses: &glosses,
            normals: &normals,
            views: match is_first {
                true => (&tangents, -1.0),
                false => (&views, 1.0),
            },
            l: &l,
            gathered: &mut gathered,
            is_first,
            added: &mut added,
        });
        (all(&gathered.sum), all(&added))
    };
    for weighs in [false, true] {
        let (matte, glossy) = lit(false, weighs);
        assert_eq!(lit(true, weighs), (matte.clone(), glossy.clone()));
        for all in [matte, glossy] {
            let count = all.iter().filter(|[r, ..]| *r > 0.0).count();
            assert!((20..70).contains(&count), "{count}");
        }
    }
}
