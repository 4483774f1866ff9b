//! Lamps, pulses and surfaces that shine.

use super::dark::PULSE;
use super::refused::refused;
use super::{Folder, SMALL};

#[test]
fn lights_without_a_name_are_set_by_the_names_of_their_types() {
    let folder = Folder::new();
    let light = "[[light]]\nposition = [0, 3, 0]\n";
    folder.write("lamps.toml", format!("{SMALL}{light}{light}"));
    let plan = |intensity: &str| folder.ok(&["plan", "lamps.toml", "--set", intensity]);
    plan("light.point.intensity=3");
    plan("light.point-2.intensity=3");
    let lost = ["plan", "lamps.toml", "--set", "light.lamp.intensity=3"];
    refused(&folder, &lost, &["\"point\", \"point-2\""]);
}

#[test]
fn a_lamp_inside_a_body_is_said_to_be() {
    let folder = Folder::empty();
    let scene = |more: &str| {
        format!(
            "[camera]\neye = [0, 1, 6]\nlook_at = [0, 0.5, 0]\nsize = [16, 12]\n             [display]\nback_faces = \"two_sided\"\n             [[object]]\nname = \"floor\"\nshape = {{ plane = {{ size = [20, 20] }} }}\n             [[object]]\nname = \"crate\"\nshape = {{ box = {{ size = [1, 1, 1] }} }}\n             velocity = {{ beta = [0.6, 0, 0] }}\norigin = {{ position = [0, 0.5, 0] }}\n{more}"
        )
    };
    let with_backs = |backs: &str, lamp: &str| {
        folder.write("in.toml", scene(lamp).replace("two_sided", backs));
        folder.ok(&["render", "in.toml", "-o", "in.png", "--white", "1"])
    };
    let said = |lamp: &str| with_backs("two_sided", lamp);
    let inside =
        "[[light]]\nname = \"bulb\"\nposition = [0, 0.5, 0]\nvelocity = { beta = [0.6, 0, 0] }\n";
    let words = "lamp \"bulb\" is inside \"crate\"";
    assert!(said(inside).contains(words));
    assert!(with_backs("culled", inside).contains(words));
    // In front of it; at rest where it has been when its light left; without shadows; and in a room with the camera.
    for lamp in [
        "[[light]]\nname = \"bulb\"\nposition = [0, 0.5, 2]\nvelocity = { beta = [0.6, 0, 0] }\n",
        "[[light]]\nname = \"bulb\"\nposition = [8, 0.5, 0]\n",
        &format!("{inside}shadows = false\n"),
        "[[light]]\nname = \"bulb\"\nposition = [0, 3, 0]\n\
         [[object]]\nname = \"room\"\nshape = { box = { size = [30, 30, 30] } }\n",
    ] {
        for backs in ["two_sided", "culled"] {
            let said = with_backs(backs, lamp);
            assert!(!said.contains("is inside"), "{backs} {lamp}: {said}");
        }
    }
    // A pulse too.
    let pulse = "[[source]]\nname = \"spark\"\npulse = { position = [-3.6, 0.5, 0], time = \"-6 m\", sigma = \"9 m\" }\n";
    assert!(said(pulse).contains("lamp \"spark\" is inside \"crate\""));
}

#[test]
fn an_area_light_on_a_surface_that_shows_a_cube_is_refused() {
    let folder = Folder::empty();
    let unlit = SMALL.split("[[source]]").next().unwrap();
    let light = "[[light]]\ntype = \"area\"\nobject = \"crate\"\n";
    let cube = |objects: &str| {
        format!(
            "[[source]]\nname = \"film\"\nobjects = [{objects}]\n[source.cube]\nfile = \"film.npy\"\nstart = \"0 m\"\n\
             bin_width = \"1 m\"\nuv = 0\n"
        )
    };
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2, 3), }";
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    bytes.extend(format!("{header:<117}\n").bytes());
    bytes.resize(bytes.len() + 48, 0);
    folder.write("film.npy", bytes);
    folder.write("floor.toml", format!("{unlit}{light}{}", cube("\"floor\"")));
    folder.ok(&["plan", "floor.toml"]);
    folder.write(
        "crate.toml",
        format!("{unlit}{light}{}", cube("\"floor\", \"crate\"")),
    );
    let parts = [
        "crate.toml",
        "\"crate\" shows a cube",
        "leave out this light",
    ];
    refused(&folder, &["plan", "crate.toml"], &parts);
}

#[test]
fn a_plan_says_when_light_of_pulses_and_lamps_is_in_view() {
    let folder = Folder::empty();
    folder.write("pulse.toml", PULSE);
    let said = folder.ok(&["plan", "pulse.toml"]);
    let words = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        words.contains("and -7 m; its light is emitted from 9.96 m to 10.04 m"),
        "{said}"
    );
    assert!(
        words.contains("the camera's time 0 m shows none of it; try --time \"16.96 m\" to"),
        "{said}"
    );
    let said = folder.ok(&["plan", "pulse.toml", "--time", "17 m"]);
    assert!(
        said.split_whitespace()
            .collect::<Vec<_>>()
            .join(" ")
            .contains("shows some of it"),
        "{said}"
    );
    // The same by a lamp.
    let lamp = PULSE.replace(
        "[[source]]\nname = \"flash\"\npulse = { position = [0, 3, 0], time = \"10 m\", sigma = \"1 cm\" }",
        "[[light]]\nname = \"flash\"\nposition = [0, 3, 0]\nclock_zero = \"10 m\"\n\
         emission = { gaussian = { sigma = \"1 cm\" } }",
    );
    folder.write("lamp.toml", lamp);
    let said = folder.ok(&["render", "lamp.toml", "-o", "a.png"]);
    let line = said
        .lines()
        .find(|line| line.starts_with("light \"flash\""))
        .expect(&said);
    // At rest its own time is the world's, less 10 m.
    assert!(line.contains("and -17 m; it shines from"), "{line}");
    assert!(line.contains("try --time \"16."), "{line}");
}
