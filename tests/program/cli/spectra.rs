//! Spectra of lights and surfaces.

use super::Folder;
use super::dark::{PULSE, floor, planned_and_rendered};
use super::refused::refused;

#[test]
fn a_spectrum_out_of_sight_is_told_and_no_other_time_is_advised() {
    let folder = Folder::new();
    folder.write(
        "line.toml",
        "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nhfov = \"20 deg\"\nsize = [24, 16]\n\
         velocity = { beta = 0.5, direction = [0, 0, -1] }\n\
         [[object]]\nshape = { sphere = { radius = 1 } }\nspectrum = { line = \"589 nm\" }\n\
         [radiance]\nquantity = \"rgb\"\n",
    );
    let said = folder.ok(&["render", "line.toml", "-o", "line.png"]);
    assert!(
        said.contains("the spectrum of \"sphere\" is seen at 0.57"),
        "{said}"
    );
    assert!(said.contains("none of its light is visible"), "{said}");
    assert!(!said.contains("another --time"), "{said}");
}

#[test]
fn a_spectrum_that_nobody_sees_at_rest_is_outside_the_visible_range() {
    let folder = Folder::empty();
    let scene = |beta: &str| {
        format!(
            "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nhfov = \"1 deg\"\nsize = [4, 4]\n\
             velocity = {{ beta = [0, 0, {beta}] }}\n\
             [[object]]\nname = \"s\"\nshape = {{ plane = {{ size = [9, 9] }} }}\nspectrum = {{ flat = [\"9 um\", \"11 um\"], total = 1 }}\n\
             transform = {{ rotate = {{ axis = [1, 0, 0], angle = \"90 deg\" }} }}\n\
             [radiance]\nquantity = \"rgb\"\n"
        )
    };
    let render = |beta: &str| {
        folder.write("line.toml", scene(beta));
        folder.ok(&["render", "line.toml", "-o", "line.png"])
    };
    let said = render("0");
    assert!(
        said.contains(
            "the spectrum of \"s\" is outside the visible range (see display.false_colour)"
        ),
        "{said}"
    );
    // Away from it at 0.6 c all wavelengths are twice as long, to four digits.
    let said = render("0.6");
    assert!(
        said.contains("the spectrum of \"s\" is seen at 2 times its wavelengths: none"),
        "{said}"
    );
}

#[test]
fn surfaces_that_are_black_in_false_colours_have_the_remedy_told() {
    let folder = Folder::empty();
    folder.write(
        "warm.toml",
        "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nhfov = \"20 deg\"\nsize = [24, 16]\n\
         [[object]]\nshape = { sphere = { radius = 1 } }\n\
         [[light]]\nposition = [0, 0, 5]\npower = 100\nspectrum = { flat = [\"9 um\", \"11 um\"], total = 1 }\n\
         [radiance]\nquantity = \"rgb\"\n[display]\nfalse_colour = \"10 um\"\n",
    );
    let plan = folder.ok(&["plan", "warm.toml"]);
    let said = folder.ok(&["render", "warm.toml", "-o", "warm.png"]);
    for (said, part) in [
        (&plan, "is missing in false colours"),
        (&said, "is missing in false colours"),
        (
            &said,
            "the picture is black: surfaces reflect red, green and blue",
        ),
    ] {
        assert!(
            said.contains(part) && said.contains("spectra = \"sampled\""),
            "{said}"
        );
    }
    let sampled = folder.ok(&[
        "render",
        "warm.toml",
        "--set",
        "render.spectra=sampled",
        "-o",
        "warm.png",
    ]);
    assert!(
        !sampled.contains("black") && !sampled.contains("false colours"),
        "{sampled}"
    );
}

/// A box whose picture is smaller than a pixel, so that no centre of one meets it: ahead at 0.9 c a line at 589 nm is seen at
/// 0.23 times that.
#[test]
fn a_small_picture_of_a_spectrum_out_of_sight_has_the_same_reason() {
    let folder = Folder::new();
    folder.write(
        "small.toml",
        "[camera]\neye = [0, 0, 3]\nlook_at = [0, 0, 0]\nhfov = \"40 deg\"\nsize = [8, 6]\n\
         velocity = { beta = 0.9, direction = [0, 0, -1] }\n\
         [[object]]\nshape = { box = { size = [1, 1, 1] } }\nspectrum = { line = \"589 nm\" }\n\
         [radiance]\nquantity = \"rgb\"\n",
    );
    for size in ["8x6", "80x60"] {
        let said = folder.ok(&["render", "small.toml", "--size", size, "-o", "small.png"]);
        for part in ["none of its light is visible", "W = 0.2"] {
            assert!(said.contains(part), "{size}: {said}");
        }
        assert!(!said.contains("another --time"), "{size}: {said}");
    }
}

#[test]
fn spectra_that_cannot_be_are_refused_in_their_place() {
    let folder = Folder::empty();
    let scene = PULSE.split("[[source]]").next().unwrap();
    folder.write("lamp.csv", "400,1\n300,1\n");
    for (spectrum, said) in [
        ("{ blackbody = \"-5 K\" }", "a temperature of -5 K"),
        ("{ blackbody = \"5 nm\" }", "is not a unit of a temperature"),
        ("{ line = \"0 nm\" }", "a wavelength of 0 nm"),
        ("{ line = \"10 um\" }", "invisible at rest"),
        ("{ lines = [] }", "0 lines"),
        (
            "{ lines = [{ wavelength = \"500 nm\", energy = -1 }] }",
            "below 0",
        ),
        ("{ line = \"500 nm\", blackbody = \"5 K\" }", "given twice"),
        (
            "{ gaussian = { centre = \"500 nm\", sigma = \"0 nm\" } }",
            "wavelength of 0 nm",
        ),
        (
            "{ gaussian = { centre = \"500 nm\", sigma = \"1 um\" } }",
            "a standard deviation of 1 um",
        ),
        (
            "{ flat = [\"500 nm\", \"400 nm\"] }",
            "400 nm is not longer than 500 nm",
        ),
        ("{ rgb = [1, -1, 0] }", "a colour is below 0"),
        (
            "{ rgb = [1, 1, 0], total = 1 }",
            "no sum over all wavelengths",
        ),
        (
            "{ line = \"500 nm\", continuation = \"dark\" }",
            "is continued",
        ),
        (
            "{ line = \"500 nm\", luminance = 1, total = 1 }",
            "given twice",
        ),
        ("{ line = \"500 nm\", luminance = -1 }", "below 0"),
        ("{ table = \"none.csv\" }", "cannot find this file"),
        ("{ table = \"lamp.npy\" }", "neither a .csv nor a .txt file"),
        (
            "{ table = \"lamp.csv\" }",
            "line 2: 300 nm does not come after",
        ),
        ("{ luminance = 1 }", "does not give its wavelengths"),
    ] {
        let rgb = "[radiance]\nquantity = \"rgb\"\n";
        folder.write("bad.toml", format!("{scene}spectrum = {spectrum}\n{rgb}"));
        refused(&folder, &["render", "bad.toml"], &[said]);
    }
    // As of lights and skies, only where radiance is that of spectra.
    folder.write(
        "bad.toml",
        format!("{scene}spectrum = {{ line = \"589 nm\" }}\n"),
    );
    let said = [
        "an object has a spectrum where",
        "set quantity = \"rgb\" in [radiance], or leave `spectrum` out",
    ];
    refused(&folder, &["render", "bad.toml"], &said);
}

#[test]
fn spectra_that_surfaces_in_motion_do_not_reflect_are_named() {
    let folder = Folder::empty();
    let rgb = "[radiance]\nquantity = \"rgb\"\n";
    let lamp = |spectrum: &str| {
        format!(
            "[[light]]\nname = \"sodium\"\nposition = [0, 3, 0]\nspectrum = {{ {spectrum} }}\n{rgb}"
        )
    };
    let line = lamp("line = \"589 nm\"");
    let sky = format!("[sky]\nspectrum = {{ blackbody = \"3000 K\" }}\n{rgb}");
    let along = "velocity = { beta = [0, 0, -0.5] }";
    let stars = format!("[sky]\nradiance = 0\nstars = {{ count = 10 }}\n{rgb}");
    let [planned, _] = planned_and_rendered(&folder, &floor(-0.5, "", &stars));
    let planned = planned.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        planned.contains("spectra = \"sampled\" in [render], and lights = false in [sky]"),
        "{planned}"
    );
    for (beta, object, light, name) in [
        (-0.5, "", &line, Some("\"sodium\"")),
        (-0.5, "", &sky, Some("the sky")),
        (0.0, along, &line, Some("\"sodium\"")),
        (0.0, "", &line, None),
        (-0.5, along, &line, None),
        (-0.5, "", &lamp("rgb = [1, 0.8, 0.2]"), None),
        (-0.5, "spectrum = { line = \"589 nm\" }", &line, None),
        (
            -0.5,
            "",
            &format!("{line}[effects]\ndoppler = false\n"),
            None,
        ),
        (
            -0.5,
            "",
            &format!("{line}[render]\nspectra = \"sampled\"\n"),
            None,
        ),
    ] {
        for said in planned_and_rendered(&folder, &floor(beta, object, light)) {
            let found = said.contains("as red, green and blue, not as its spectrum");
            assert_eq!(found, name.is_some(), "{beta} {object} {light}: {said}");
            let remedy = "spectra = \"sampled\" in [render]";
            assert_eq!(said.contains(remedy), found, "{said}");
            assert!(said.contains(name.unwrap_or_default()), "{said}");
        }
    }
    // Where nothing is reflected there is nothing to sample.
    let unlit = floor(-0.5, "", &format!("{rgb}[render]\nspectra = \"sampled\"\n"));
    let [planned, _] = planned_and_rendered(&folder, &unlit);
    assert!(
        planned.contains("`render.spectra` has no effect"),
        "{planned}"
    );
}

#[test]
fn shapes_that_reflect_more_than_they_receive_are_named() {
    let folder = Folder::empty();
    let lamp = "[[light]]\nposition = [0, 3, 0]\n";
    for (colour, light, is_said) in [
        ("colour = [0.5, 3, 0.5]", lamp, true),
        ("colour = [0.5, 1, 0.5]", lamp, false),
        ("colour = [0.5, 3, 0.5]", "", false),
    ] {
        for said in planned_and_rendered(&folder, &floor(0.0, colour, light)) {
            let part = "the colour of \"floor\" is above 1";
            assert_eq!(said.contains(part), is_said, "{colour} {light}: {said}");
        }
    }
}

#[test]
fn spectra_of_which_nobody_sees_anything_are_refused_by_what_is_wrong_with_them() {
    let folder = Folder::empty();
    folder.write("um.csv", "0.4,1\n0.7,2\n");
    folder.write("zero.csv", "400,0\n700,0\n");
    for (spectrum, parts) in [
        (
            "table = \"um.csv\"",
            &["\"um.csv\" spans 0.4 to 0.7 nm", "are in nm"][..],
        ),
        (
            "table = \"zero.csv\", factor = 2",
            &["all values of \"zero.csv\" are 0"],
        ),
        (
            "line = \"589 nm\", factor = 3",
            &["`factor` multiplies the values of a table", "`total`"],
        ),
        (
            "gaussian = { centre = \"550 nm\", sigma = \"20 nm\" }, factor = 3",
            &["`total`"],
        ),
    ] {
        let light = "[radiance]\nquantity = \"rgb\"\n";
        let object = format!("spectrum = {{ {spectrum} }}");
        folder.write("floor.toml", floor(0.0, &object, light));
        refused(&folder, &["render", "floor.toml"], parts);
    }
}
