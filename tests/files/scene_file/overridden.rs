//! The effect of overrides.

use glam::DVec3;
use nullray::scene::Overrides;
use nullray::scene::model::{Exposure, Fill, SourceKind};

use crate::scene_file::{Folder, VALID, problem};

fn set(pairs: &[(&str, &str)]) -> Overrides {
    let owned = |(key, value): &(&str, &str)| (key.to_string(), value.to_string());
    Overrides {
        set: pairs.iter().map(owned).collect(),
        ..Overrides::default()
    }
}

#[test]
fn values_are_set_by_dotted_keys() {
    let overrides = set(&[
        ("camera.velocity", "{ beta = [0.25, 0, 0] }"),
        ("camera.hfov", "90 deg"),
        ("object.ship.velocity.beta", "[0, 0.5, 0]"),
        ("object.1.origin.time", "\"7 m\""),
        ("source.flash.pulse.sigma", "1 cm"),
        ("effects.doppler", "false"),
        ("outside", "hold"),
        ("display.white", "2"),
    ]);
    let scene = Folder::with_files().parse_with(VALID, &overrides).unwrap();
    // It takes the place of the file's percentile.
    assert_eq!(scene.exposure, Exposure::White(2.0));
    assert_eq!(scene.camera.velocity.beta().y, 0.0);
    assert!((scene.camera.velocity.beta().x - 0.25).abs() < 1e-16);
    assert!((scene.camera.horizontal_fov - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    assert!((scene.objects[2].velocity.beta() - DVec3::Y * 0.5).length() < 1e-15);
    assert_eq!(scene.objects[1].origin.ct, 7.0);
    let SourceKind::Pulse(pulse) = &scene.sources[1].kind else {
        panic!("{:?}", scene.sources[1]);
    };
    assert_eq!(pulse.sigma, 0.01);
    assert!(!scene.effects.doppler && scene.effects.aberration);
    assert_eq!(scene.outside.off_texture, Fill::Hold);
    assert!(scene.text.contains("hfov = \"90 deg\""), "{}", scene.text);
}

#[test]
fn size_samples_and_time_have_their_own_overrides() {
    let overrides = Overrides {
        size: Some([7, 5]),
        samples_per_pixel: Some(9),
        time: Some("3 m".into()),
        ..Overrides::default()
    };
    let scene = Folder::with_files().parse_with(VALID, &overrides).unwrap();
    assert_eq!(scene.camera.size, [7, 5]);
    assert_eq!(scene.samples_per_pixel, 9);
    assert_eq!(scene.camera.time, 3.0);
}

#[test]
fn without_overrides_the_text_stays_as_it_is() {
    let scene = Folder::with_files().parse(VALID).unwrap();
    assert_eq!(scene.text, VALID);
}

#[test]
fn an_edit_keeps_comments() {
    let text = VALID.replace("hfov = \"40 deg\"", "hfov = \"40 deg\" # wide");
    let scene = Folder::with_files().parse_with(&text, &set(&[("camera.hfov", "50 deg")]));
    assert!(scene.unwrap().text.contains("hfov = \"50 deg\" # wide"));
}

#[test]
fn entries_of_inline_arrays_are_found_too() {
    let text = "object = [{ name = 'x', shape = { sphere = { radius = 1 } } }]\n\
                [camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n";
    let overrides = set(&[("object.x.origin.position", "[1, 2, 3]")]);
    let scene = Folder::with_files().parse_with(text, &overrides).unwrap();
    assert_eq!(scene.objects[0].origin.x, DVec3::new(1.0, 2.0, 3.0));
}

#[test]
fn names_with_dots_go_in_quotes() {
    let text = VALID.replace("name = \"ship\"", "name = \"s.s. ship\"");
    let overrides = set(&[("object.\"s.s. ship\".colour", "[0, 0, 1]")]);
    assert!(Folder::with_files().parse_with(&text, &overrides).is_ok());
}

#[test]
fn what_an_override_breaks_names_the_override() {
    let folder = Folder::with_files();
    for (key, value, what) in [
        ("camera.hfov", "200 deg", "200 deg"),
        ("camera.hfovv", "20 deg", "unknown key"),
        ("camera.velocity.gamma", "2", "given twice"),
        ("camera.time", "3", "no unit"),
        ("nonsense", "2", "unknown key"),
    ] {
        let refusal = problem(folder.parse_with(VALID, &set(&[(key, value)])));
        assert!(refusal.what.contains(what), "{key}: {}", refusal.what);
        let cited = format!("(Set by `set {key}={value}` on the list of overrides.)");
        assert!(refusal.help.contains(&cited), "{key}: {}", refusal.help);
    }
    // Two ways to say what is white, both by overrides.
    let both = set(&[("display.white", "2"), ("display.logarithmic", "[1, 2]")]);
    let refusal = problem(folder.parse_with(VALID, &both));
    assert!(
        refusal.what.contains("exclude each other"),
        "{}",
        refusal.what
    );
    assert!(
        refusal.help.contains("display.logarithmic"),
        "{}",
        refusal.help
    );
    let overrides = Overrides {
        time: Some("3".into()),
        ..Overrides::default()
    };
    let refusal = problem(folder.parse_with(VALID, &overrides));
    assert!(refusal.help.contains("`camera.time 3`"), "{}", refusal.help);
}

#[test]
fn an_error_elsewhere_does_not_name_the_override() {
    let text = VALID.replace("\"40 deg\"", "40");
    let refusal = problem(Folder::with_files().parse_with(&text, &set(&[("camera.time", "3 m")])));
    assert!(!refusal.help.contains("overrides"), "{}", refusal.help);
}

#[test]
fn a_path_that_leads_nowhere_is_refused_by_its_override() {
    let folder = Folder::with_files();
    for (key, value, what, help) in [
        (
            "object.shp.velocity",
            "{}",
            "no object \"shp\"",
            "did you mean \"ship\"?",
        ),
        (
            "object.3.velocity",
            "{}",
            "no object \"3\"",
            "\"wheel\", \"floor\", \"ship\"",
        ),
        ("object.ship", "{}", "whole table", "name a key"),
        (
            "camera.eye.x",
            "1",
            "camera.eye is not a table",
            "set camera.eye",
        ),
        (
            "camera..eye",
            "1",
            "not a dotted key",
            "camera.velocity.beta",
        ),
        ("", "1", "not a dotted key", "dots"),
        ("camera.eye", "[1, 2", "not a TOML value", "[x, y, z]"),
        ("camera.time", "", "not a TOML value", "number"),
    ] {
        let refusal = problem(folder.parse_with(VALID, &set(&[(key, value)])));
        assert_eq!(refusal.file, "list of overrides", "{key}");
        assert_eq!(refusal.place, format!("`set {key}={value}`"));
        assert!(refusal.what.contains(what), "{key}: {}", refusal.what);
        assert!(refusal.help.contains(help), "{key}: {}", refusal.help);
    }
    let refusal = problem(folder.parse_with("", &set(&[("object.0.name", "x")])));
    assert!(refusal.what.contains("has no object"), "{}", refusal.what);
}
