use super::*;

fn catalogue(catalogue: Catalogue) -> Stars {
    Stars {
        catalogue,
        scale: 1.0,
        radius: 1e-3,
    }
}

#[test]
fn random_stars_follow_their_law() {
    let all = Catalogue::Random {
        count: 20_000,
        seed: 3,
        faintest: 6.0,
    };
    let stars = stars(&catalogue(all), "").unwrap();
    let luminance = |s: &Star| {
        let [r, g, b] = s.colour(1.0);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    // Stars down to one magnitude brighter: 10^−0.6 = 0.2512 of all, ± √(20000 · 0.25 · 0.75) = 61.
    let brighter = |m: f64| {
        stars
            .iter()
            .filter(|s| luminance(s) > libm::pow(10.0, -0.4 * m))
            .count()
    };
    assert!(brighter(5.0).abs_diff(5024) < 250, "{}", brighter(5.0));
    let up = stars.iter().filter(|s| s.direction.y > 0.5).count();
    assert!(up.abs_diff(5000) < 250, "{up}");
}

#[test]
fn tables_are_read_and_their_faults_named_by_line() {
    let file = catalogue(Catalogue::File("a.csv".into()));
    let read = stars(
        &file,
        "x,y,z,magnitude,temperature\n0,0,-2,0,6500\n\n1, 0, 0, 5, 3000\n",
    )
    .unwrap();
    assert_eq!(read.len(), 2);
    // As a spreadsheet writes it, and with column names after a comment.
    for start in [
        "\u{feff}",
        "\u{feff}x,y,z,magnitude,temperature\r\n",
        "# bright\nx,y,z,m,t\n",
    ] {
        let read = stars(&file, &format!("{start}0,0,-2,0,6500\n")).unwrap();
        assert_eq!(read.len(), 1, "{start:?}");
    }
    let nan = stars(&file, "nan,0,1,0,6500\n0,0,1,0,6500\n").unwrap_err();
    assert!(nan.to_string().contains("line 1"), "{nan}");
    assert_eq!(read[0].direction, DVec3::NEG_Z);
    // Five magnitudes are a factor of 100, and 3000 K is red.
    let [r, g, b] = read[1].channels();
    assert!(r > g && g > b && (0.2126 * r + 0.7152 * g + 0.0722 * b - 0.01).abs() < 1e-4);
    for bad in [
        "1,2,3",
        "0,0,0,1,5000",
        "1,0,0,1,0",
        "1,0,0,nan,5000",
        "a\nb",
    ] {
        let error = stars(&file, bad).unwrap_err().to_string();
        assert!(error.contains("line "), "{error}");
    }
    for (bad, said) in [
        ("", "a table without stars"),
        (
            "x,y,z,magnitude,temperature\n# none\n",
            "a table without stars",
        ),
        ("0;0;-1;2;6500", "line 1: semicolons"),
        ("0;0;-1;2,5;6500", "line 1: semicolons"),
    ] {
        let error = stars(&file, bad).unwrap_err().to_string();
        assert!(error.contains("a.csv") && error.contains(said), "{error}");
    }
}
