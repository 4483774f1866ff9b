//! Help, schema, completions, manual.

use serde_json::Value;

use super::Folder;

#[test]
fn the_schema_is_json_that_knows_the_tables_of_a_scene() {
    let schema: Value = serde_json::from_str(&Folder::empty().ok(&["schema"])).unwrap();
    assert_eq!(schema["type"], "object");
    // A file may be a diagram alone: not even the camera is required of all.
    assert!(schema.get("required").is_none(), "{}", schema["required"]);
    for table in [
        "camera", "object", "source", "display", "effects", "outside", "radiance", "medium",
        "panel", "sheet", "diagram",
    ] {
        assert!(schema["properties"][table].is_object(), "{table}");
    }
}

#[test]
fn every_shell_gets_completions_that_know_the_commands() {
    for shell in ["bash", "zsh", "fish"] {
        let text = Folder::empty().ok(&["completions", shell]);
        for word in [
            "render",
            "plan",
            "sheet",
            "info",
            "isochrones",
            "exposure",
            "interval",
        ] {
            assert!(text.contains(word), "{shell}: {word}");
        }
    }
}

#[test]
fn the_manual_has_a_page_for_each_command() {
    let folder = Folder::empty();
    let said = folder.ok(&["man", "--directory", "share/man1"]);
    for page in [
        "nullray",
        "nullray-render",
        "nullray-plan",
        "nullray-sheet",
        "nullray-info",
        "nullray-schema",
    ] {
        let name = format!("share/man1/{page}.1");
        let text = String::from_utf8(folder.read(&name)).unwrap();
        assert!(text.contains(".SH NAME"), "{page}");
        assert!(said.contains(&format!("wrote {name}")), "{said}");
    }
    let render = String::from_utf8(folder.read("share/man1/nullray-render.1")).unwrap();
    assert!(render.contains("wavelength_ratio"), "{render}");
    assert!(folder.ok(&["man"]).contains(".SH NAME"));
}

#[test]
fn the_help_has_examples_exit_codes_and_formats() {
    let folder = Folder::empty();
    let help = folder.ok(&["--help"]);
    for part in [
        "Examples:",
        "Exit codes: 0 done; 1 `compare` exceeded a --tolerance or could not judge it, or a check of",
        "`selftest` failed; 2 ",
        "130 stopped",
        "NO_COLOR",
    ] {
        assert!(help.contains(part), "{part} in {help}");
    }
    let help = folder.ok(&["help", "render"]);
    for part in [
        "Examples:",
        ".npz",
        "--isochrone-step",
        "Repeatable",
        "sRGB",
    ] {
        assert!(help.contains(part), "{part} in {help}");
    }
}

/// What cannot be written to standard output is an error, but for a reader who has seen enough.
#[cfg(unix)]
#[test]
fn texts_that_cannot_be_written_are_an_error() {
    use std::fs::OpenOptions;
    use std::process::Stdio;

    let folder = Folder::new();
    let commands: [&[&str]; 8] = [
        &["--help"],
        &["--version"],
        &["render", "--help"],
        &["help", "compare"],
        &["schema"],
        &["completions", "bash"],
        &["man"],
        &["plan", "scene.toml"],
    ];
    for arguments in commands {
        let full = OpenOptions::new().write(true).open("/dev/full");
        // Other systems than Linux have no such device.
        let Ok(full) = full else { return };
        let output = folder.command(arguments).stdout(full).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains("standard output: cannot write"), "{said}");

        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = folder
            .command(arguments)
            .stdout(Stdio::from(writer))
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        assert_eq!(output.stderr, b"", "{arguments:?}");
    }
}
