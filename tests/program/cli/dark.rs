//! Messages about dark pictures, and about pictures of the sky only.

use super::Folder;

/// A floor of 2 m seen from 4 m above, and a pulse from 3 m above it at ct = 10 m.
pub(super) const PULSE: &str = "
[camera]
eye = [0, 4, 0]
look_at = [0, 0, 0]
up = [0, 0, -1]
hfov = \"20 deg\"
size = [9, 9]
[[object]]
shape = { plane = { size = [2, 2] } }
[[source]]
name = \"flash\"
pulse = { position = [0, 3, 0], time = \"10 m\", sigma = \"1 cm\" }
";

/// A floor that a camera above it sees alone.
pub(super) fn floor(beta: f64, floor: &str, rest: &str) -> String {
    format!(
        "[camera]\neye = [0, 2, 5]\nlook_at = [0, 0, 0]\nsize = [24, 16]\nvelocity = {{ beta = [0, 0, {beta:?}] }}\n\
         [[object]]\nname = \"floor\"\nshape = {{ plane = {{ size = [2000, 2000] }} }}\n{floor}\n{rest}\n"
    )
}

/// What `plan` and `render` say of a scene.
pub(super) fn planned_and_rendered(folder: &Folder, scene: &str) -> [String; 2] {
    folder.write("floor.toml", scene);
    let rendered = folder.ok(&["render", "floor.toml", "--spp", "1", "-o", "floor.png"]);
    [folder.ok(&["plan", "floor.toml"]), rendered]
}

#[test]
fn a_dark_picture_says_when_the_light_left_and_when_to_look() {
    let folder = Folder::empty();
    folder.write("pulse.toml", PULSE);
    let said = folder.ok(&["render", "pulse.toml", "-o", "a.png"]);
    // The light that is seen at 0 was on the floor at −4 m and less, and would have left the lamp at −7 m.
    let line = said
        .lines()
        .find(|line| line.starts_with("source \"flash\""))
        .expect(&said);
    assert!(
        line.contains("and -7 m; its light is emitted from 9.96 m to 10.04 m"),
        "{line}"
    );
    // At rest, a shot that is later by t sees light that left later by t: from 9.96 + 7 m on.
    assert!(line.contains("try --time \"16.96 m\" to"), "{line}");
    let said = folder.ok(&["render", "pulse.toml", "--time", "17 m", "-o", "b.png"]);
    assert!(!said.contains("black"), "{said}");
}

#[test]
fn light_that_is_shifted_out_of_sight_is_said_to_be() {
    let folder = Folder::empty();
    // Straight away from a wall at γ = 1000: W is near 2γ.
    let scene = "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nsize = [8, 6]\n\
                 velocity = { gamma = 1000, direction = [0, 0, 1] }\n[radiance]\nquantity = \"rgb\"\n\
                 continuation = \"dark\"\n[[object]]\nshape = { box = { size = [100, 100, 1] } }\n";
    folder.write("w.toml", scene);
    let said = folder.ok(&["render", "w.toml", "-o", "w.png"]);
    assert!(said.contains("the picture is black"), "{said}");
    assert!(said.contains("what would be seen was emitted at"), "{said}");
    let said = folder.ok(&[
        "render",
        "w.toml",
        "-o",
        "w.png",
        "--set",
        "effects.doppler=false",
    ]);
    assert!(!said.contains("out of sight"), "{said}");
}

#[test]
fn lamps_whose_light_is_shifted_out_of_sight_or_too_cold_are_named() {
    let folder = Folder::empty();
    // A lamp above the floor that recedes from it: right below it W = e^ζ, and 2γ for parallel light of a fast one.
    let lamp = |numbers: &str| {
        floor(
            0.0,
            "",
            &format!("[[light]]\nname = \"far\"\n{numbers}\n[radiance]\nquantity = \"rgb\""),
        )
    };
    let point = |beta: f64| {
        lamp(&format!(
            "position = [0, 900, 0]\nvelocity = {{ beta = [0, {beta}, 0] }}"
        ))
    };
    let parallel = lamp(
        "type = \"directional\"\ndirection = [0, -1, 0]\nvelocity = { beta = [0, 0.999999, 0] }",
    );
    let hot = |kelvin: f64| {
        lamp(&format!(
            "position = [0, 9, 0]\nspectrum = {{ blackbody = \"{kelvin} K\" }}"
        ))
    };
    for (scene, is_said) in [
        (point(0.95), true),
        (point(-0.95), true),
        (point(0.5), false),
        (parallel, true),
        (hot(300.0), true),
        (hot(3000.0), false),
    ] {
        let [planned, rendered] = planned_and_rendered(&folder, &scene);
        let found = rendered.contains("the light of \"far\" reaches what is in view with");
        assert_eq!(found, is_said, "{scene}: {rendered}");
        assert!(!rendered.contains("try another --time"), "{rendered}");
        // The camera has a velocity, too, which is 0.
        let moves = scene.matches("velocity").count() > 1;
        assert_eq!(
            planned.contains("colours represent smooth spectra"),
            moves,
            "{planned}"
        );
        let told = planned.contains("the light of \"far\" reaches what is in view with");
        assert_eq!(told, is_said, "{planned}");
    }
    // Of the spectrum of the cosmic background nothing is visible on a floor.
    let sky =
        "[sky]\nspectrum = { blackbody = \"2.725 K\", total = 1 }\n[radiance]\nquantity = \"rgb\"";
    let [_, rendered] = planned_and_rendered(&folder, &floor(0.0, "", sky));
    assert!(
        rendered.contains("the light of the sky is invisible"),
        "{rendered}"
    );
}

#[test]
fn a_plan_knows_from_a_few_rays_why_a_picture_will_be_dark() {
    let folder = Folder::empty();
    let ball = |object: &str, rest: &str| {
        format!(
            "[camera]\neye = [0, 1, 4]\nlook_at = [0, 1, 0]\nsize = [128, 96]\n[radiance]\nquantity = \"rgb\"\n\
             [[object]]\nname = \"ball\"\nshape = {{ sphere = {{ radius = 1 }} }}\n{object}\n{rest}"
        )
    };
    let away = "origin = { position = [50, 0, 0] }";
    let light = |rest: &str| format!("[[light]]\nname = \"lamp\"\n{rest}");
    let infrared = "spectrum = { line = \"10 um\", total = 1 }";
    let inside = light("position = [0, 0, 0]");
    let dark = light("position = [0, 0, 9]\nintensity = 0");
    let hot = light(&format!("position = [0, 1, 9]\n{infrared}"));
    let spot = light("type = \"spot\"\nposition = [0, 1, 9]\ndirection = [0, 0, 1]");
    let lit = light("position = [0, 1, 9]");
    for (scene, black, said) in [
        (ball("", &inside), true, "all light is inside objects"),
        (ball("", &inside), true, "lamp \"lamp\" is inside \"ball\""),
        (
            ball("", &dark),
            true,
            "the intensity, radiance or power of all lights is 0",
        ),
        (
            ball("", "[sky]\nradiance = 0"),
            true,
            "power of all lights is 0",
        ),
        (ball(away, &lit), true, "no object's front is in view"),
        (
            ball(away, "[sky]\ngradient = {}"),
            false,
            "no object's front is in view",
        ),
        (
            ball(infrared, ""),
            true,
            "the spectrum of \"ball\" is outside the visible range",
        ),
        (
            ball("", &hot),
            true,
            "the light of \"lamp\" reaches what is in view with 1 times",
        ),
        (
            ball("", &spot),
            true,
            "no light reaches what is in view, at any time",
        ),
    ] {
        let [planned, rendered] = planned_and_rendered(&folder, &scene);
        assert!(rendered.contains(said), "{said}: {rendered}");
        assert!(planned.contains(said), "{said}: {planned}");
        let rays = match black {
            true => "of 3,072 rays, none sees any light: ",
            false => "of 3,072 rays, all see only the sky: ",
        };
        assert!(planned.contains(rays), "{rays}: {planned}");
    }
    let [planned, _] = planned_and_rendered(&folder, &ball("", &lit));
    assert!(!planned.contains("rays, "), "{planned}");
}

#[test]
fn another_time_is_not_proposed_for_a_lamp_that_moves_inside_a_body() {
    let folder = Folder::empty();
    let motion = "velocity = { beta = [0.8, 0, 0] }";
    let inside = format!(
        "[[object]]\nshape = {{ sphere = {{ radius = 0.5 }} }}\norigin = {{ position = [0, 1, 0] }}\n{motion}\n\
         [[light]]\nposition = [0, 1, 0]\n{motion}"
    );
    let [_, rendered] = planned_and_rendered(&folder, &floor(0.0, "", &inside));
    assert!(
        rendered.contains("all light is inside objects"),
        "{rendered}"
    );
    assert!(!rendered.contains("try another --time"), "{rendered}");
}

#[test]
fn light_out_of_sight_that_exposure_makes_bright_is_told_with_its_wavelengths() {
    let folder = Folder::empty();
    // A wall that fills a narrow picture: at 0.99 c away from it W = γ (1 + β) = √199 = 14.107 in the middle.
    let scene = |beta: f64| {
        format!(
            "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nsize = [8, 6]\nhfov = \"2 deg\"\n\
             velocity = {{ beta = {beta}, direction = [0, 0, 1] }}\n[radiance]\nquantity = \"rgb\"\n\
             [[object]]\nshape = {{ box = {{ size = [100, 100, 1] }} }}\n"
        )
    };
    // 380 nm · W and 780 nm · W, then these by W.
    let numbers = [
        "W = 14.11 shifts visible light to 5.36 to 11 µm, out of sight",
        "emitted at 26.94 to 55.3 nm",
        "Planck's law at 6504 K",
        "display.false_colour = \"7829 nm\"",
        "radiance.quantity = \"luminance\"",
    ];
    let count = |said: &str| said.matches("out of sight").count();
    for (beta, is_out) in [(0.99, true), (0.6, false), (-0.99, true), (-0.6, false)] {
        folder.write("w.toml", scene(beta));
        let planned = folder.ok(&["plan", "w.toml"]);
        let rendered = folder.ok(&["render", "w.toml", "-o", "w.png"]);
        for said in [planned, rendered] {
            assert_eq!(count(&said), usize::from(is_out), "{beta}: {said}");
            let words = said.split_whitespace().collect::<Vec<_>>().join(" ");
            for number in numbers.iter().filter(|_| beta == 0.99) {
                assert!(words.contains(number), "{number}: {said}");
            }
        }
    }
    // Wavelengths far beyond the visible have units of their own: √(W₁ W₂) 555 nm = 1.1 m.
    let fast = scene(0.0).replace("beta = 0", "gamma = 1e6");
    folder.write("w.toml", &fast);
    let said = folder.ok(&["plan", "w.toml"]);
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("display.false_colour = \"1.11 m\""), "{said}");
    // What is said to help does.
    folder.write("w.toml", scene(0.99));
    for remedy in [
        "display.false_colour=\"7829 nm\"",
        "radiance.quantity=\"luminance\"",
    ] {
        let said = folder.ok(&["render", "w.toml", "-o", "w.png", "--set", remedy]);
        assert_eq!(count(&said), 0, "{remedy}: {said}");
    }
    // Of a sequence the first picture is told.
    let frames = ["--from", "0 m", "--to", "1 m", "--interval", "0.5 m"];
    let said = folder.ok(&[&["render", "w.toml", "-o", "w-#.png"], &frames[..]].concat());
    assert!(said.contains("frame 0: W = 14.11 shifts"), "{said}");
    // In how many frames, and how far in the first.
    assert_eq!(count(&said), 2, "{said}");
    // In a world in motion, too: a camera at rest, from which the wall flies.
    let moving = scene(0.0) + "velocity = { beta = [0, 0, -0.99] }\n";
    folder.write(
        "w.toml",
        moving.replace("velocity = { beta = 0, direction = [0, 0, 1] }\n", ""),
    );
    let said = folder.ok(&["render", "w.toml", "-o", "w.png"]);
    assert_eq!(count(&said), 1, "{said}");
}

#[test]
fn light_of_a_declared_infrared_spectrum_is_not_called_out_of_sight() {
    let folder = Folder::empty();
    let scene = |spectrum: &str, spectra: &str| {
        format!(
            "[camera]\neye = [0, 1, 3]\nlook_at = [0, 0, 0]\nsize = [16, 10]\n[radiance]\nquantity = \"rgb\"\n\
             [[object]]\nshape = {{ plane = {{ size = [10, 10] }} }}\n[[light]]\nposition = [0, 1, 0]\n{spectrum}\n\
             [render]\nspectra = \"{spectra}\"\n[display]\nfalse_colour = \"10.6 um\"\n"
        )
    };
    let (line, thermal) = (
        "spectrum = { line = \"10.6 um\", total = 1 }",
        "spectrum = { blackbody = \"400 K\", total = 1 }",
    );
    for (spectrum, spectra, is_told) in [
        (line, "sampled", false),
        (thermal, "sampled", false),
        // Visible light of the lamp is 10⁻²² of it: shown as it was emitted it would be black.
        (thermal, "rgb", false),
        ("", "rgb", true),
    ] {
        folder.write("w.toml", scene(spectrum, spectra));
        let said = folder.ok(&["render", "w.toml", "-o", "w.png"]);
        assert_eq!(said.contains("out of sight"), is_told, "{spectrum}: {said}");
        assert_eq!(said.contains("555 nm\""), is_told, "{spectrum}: {said}");
    }
}

#[test]
fn a_sky_alone_and_lines_out_of_sight_have_their_own_reasons() {
    let folder = Folder::empty();
    let camera = "[camera]\neye = [0, 0, 5]\nforward = [0, 0, 1]\nsize = [8, 6]\n";
    let wall =
        "[[object]]\nshape = { box = { size = [100, 100, 1] } }\n[radiance]\nquantity = \"rgb\"\n";
    let sky = "[sky]\nspectrum = { blackbody = \"2.725 K\", total = 1 }\nlights = false\n";
    folder.write("sky.toml", format!("{camera}{wall}{sky}"));
    let said = folder.ok(&["render", "sky.toml", "-o", "a.png"]);
    assert!(said.contains("only the sky is in view"), "{said}");
    assert!(!said.contains("meets an object"), "{said}");
    // A sodium lamp that leaves the wall at 0.9 c: 589 nm come as 2.57 µm.
    let lamp = "[[light]]\nname = \"sodium\"\nposition = [0, 0, 3]\nvelocity = { beta = [0, 0, 0.9] }\n\
                spectrum = { line = \"589 nm\" }\n";
    let scene =
        format!("{camera}{wall}{lamp}").replace("forward = [0, 0, 1]", "look_at = [0, 0, 0]");
    folder.write("lamp.toml", scene);
    let said = folder.ok(&["render", "lamp.toml", "-o", "b.png"]);
    assert!(
        said.contains("the light of \"sodium\" reaches what is in view with"),
        "{said}"
    );
}

#[test]
fn a_dark_picture_of_what_no_time_changes_is_explained_without_a_time() {
    let folder = Folder::empty();
    let lamp = |rest: &str| format!("[[light]]\nposition = [1, 2, 0]\n{rest}\n");
    let below = "[[light]]\nposition = [1, -2, 0]\n".to_owned();
    let late = lamp("emission = { gaussian = { time = \"99 m\", sigma = \"1 cm\" } }");
    for (object, light, part, has_time) in [
        (
            "",
            below,
            "no light reaches what is in view, at any time",
            false,
        ),
        (
            "",
            lamp("intensity = 0"),
            "the intensity, radiance or power of all lights is 0",
            false,
        ),
        (
            "colour = [0, 0, 0]",
            lamp(""),
            "nothing in view reflects any light",
            false,
        ),
        (
            "colour = [0, 0, 0]",
            String::new(),
            "base colours, which are shown in a scene without light, are 0",
            false,
        ),
        ("", late, "nothing in view is lit at the moment", true),
    ] {
        let [_, said] = planned_and_rendered(&folder, &floor(0.0, object, &light));
        assert!(said.contains(part), "{part}: {said}");
        assert_eq!(said.contains("--time"), has_time, "{said}");
    }
}

#[test]
fn a_picture_without_any_object_says_so_and_advises_nothing_that_is_set() {
    let folder = Folder::empty();
    let sky = "[sky]\ngradient = {}\n";
    let inside = "[camera]\neye = [0, 0, 0]\nlook_at = [0, 0, -1]\nsize = [8, 6]\n\
                  [[object]]\nshape = { box = { size = [1, 1, 1] } }\n[display]\nback_faces = \"culled\"\n";
    let away = inside.replace(
        "eye = [0, 0, 0]\nlook_at = [0, 0, -1]",
        "eye = [0, 0, 9]\nlook_at = [0, 0, 10]",
    );
    let two_sided = away.replace("culled", "two_sided");
    for (scene, part, advice) in [
        (
            format!("{inside}{sky}"),
            "only the sky is in view: no object's front is in view",
            true,
        ),
        (
            format!("{two_sided}{sky}"),
            "only the sky is in view: no object is in view:",
            false,
        ),
        (away, "black: no object's front is in view", true),
        (two_sided, "black: no object is in view:", false),
    ] {
        let [_, said] = planned_and_rendered(&folder, &scene);
        assert!(said.contains(part), "{part}: {said}");
        assert_eq!(said.contains("two_sided"), advice, "{said}");
    }
}

#[test]
fn after_a_camera_has_passed_everything_the_times_that_show_it_are_named() {
    let folder = Folder::empty();
    // At 0.6 c along x past a box at the origin, 5 m aside, looking aside with a field of view of 90°.
    let scene = |time: &str, motion: &str| {
        format!(
            "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nhfov = \"90 deg\"\nsize = [64, 48]\ntime = \"{time}\"\n{motion}\n\
             [[object]]\nshape = {{ box = {{ size = [0.5, 0.5, 0.5] }} }}\n"
        )
    };
    let velocity = "velocity = { beta = 0.6, direction = [1, 0, 0] }";
    // cos θ = (cos θ′ − β)/(1 − β cos θ′) at the edges of the film, cos θ′ = ±1/√2, and the camera is at x = −5 m cot θ, at its time
    // x/βγ. Corners of the box pass the edges up to (0.25 + 0.25 |cot θ|) m/βγ earlier or later: 1.1 m.
    let edge = |seen: f64| {
        let cosine = (seen - 0.6) / (1.0 - 0.6 * seen);
        -5.0 * cosine / (1.0 - cosine * cosine).sqrt() / 0.75
    };
    let [enters, leaves] = [edge(0.5f64.sqrt()), edge(-(0.5f64.sqrt()))];
    for time in ["100 m", "-30 m", "1 km"] {
        let [_, said] = planned_and_rendered(&folder, &scene(time, velocity));
        let advice = said
            .split("objects are in view at other times: try --time \"")
            .nth(1);
        let advice = advice.unwrap_or_else(|| panic!("{time}: {said}"));
        let (from, rest) = advice.split_once(" m\" to \"").unwrap();
        let (to, _) = rest.split_once(" m\"").unwrap();
        let [from, to] = [from, to].map(|text| text.parse::<f64>().unwrap());
        assert!(
            (enters - 1.2..enters + 0.1).contains(&from),
            "{from}, {enters}"
        );
        assert!((leaves - 0.1..leaves + 1.2).contains(&to), "{to}, {leaves}");
    }
    // At rest no time helps.
    let [_, said] = planned_and_rendered(
        &folder,
        &scene("100 m", "").replace("[0, 0, 0]\nh", "[0, 0, 9]\nh"),
    );
    assert!(
        said.contains("no object's front is in view") && !said.contains("--time"),
        "{said}"
    );
}

/// Of times so late that six digits are not enough, those that are named show the object, too.
#[test]
fn the_times_that_are_named_show_objects_however_late_they_are() {
    let folder = Folder::empty();
    let scene = "[camera]\neye = [0, 0, 0]\nforward = [1, 0, 0]\nsize = [64, 48]\nvelocity = { beta = [0.5, 0, 0] }\n\
                 [[object]]\nshape = { box = { size = [2, 2, 2] } }\norigin = { position = [12345678912.25, 30, 0] }\n";
    let [_, said] = planned_and_rendered(&folder, scene);
    let advice = said
        .split("objects are in view at other times: try --time \"")
        .nth(1);
    let advice = advice.unwrap_or_else(|| panic!("{said}"));
    let times: Vec<&str> = advice.split('"').step_by(2).take(2).collect();
    for time in times {
        let again = folder.ok(&[
            "render",
            "floor.toml",
            "--time",
            time,
            "--pixel-centers",
            "-o",
            "a.png",
        ]);
        assert!(!again.contains("in view"), "{time}: {again}");
    }
}
