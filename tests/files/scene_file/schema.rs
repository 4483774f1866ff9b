//! The JSON schema, and the reference scene against it.

use nullray::scene::{Overrides, parse, schema};
use nullray::spacetime::Quantity;
use serde_json::Value;

use crate::scene_file::motion::camera;

const REFERENCE: &str = include_str!("../../../scenes/reference.toml");

/// All (key, property) pairs of a schema.
fn properties(schema: &Value) -> Vec<(String, Value)> {
    let mut found = Vec::new();
    let children: Vec<&Value> = match schema {
        Value::Object(map) => map.values().collect(),
        Value::Array(items) => items.iter().collect(),
        _ => Vec::new(),
    };
    if let Some(Value::Object(own)) = schema.get("properties") {
        found.extend(own.iter().map(|(key, value)| (key.clone(), value.clone())));
    }
    found.extend(children.into_iter().flat_map(properties));
    found
}

fn contains_null(value: &Value) -> bool {
    match value {
        Value::Null => true,
        Value::String(text) => text == "null",
        Value::Array(items) => items.iter().any(contains_null),
        Value::Object(map) => map.values().any(contains_null),
        _ => false,
    }
}

/// A default as a scene file would write it.
fn toml(value: &Value) -> String {
    match value {
        Value::Array(items) => format!(
            "[{}]",
            items.iter().map(toml).collect::<Vec<_>>().join(", ")
        ),
        Value::Number(number) => number.as_f64().unwrap().to_string(),
        other => other.to_string(),
    }
}

#[test]
fn every_key_is_described() {
    let found = properties(&schema());
    assert!(found.len() > 70, "{}", found.len());
    for (key, property) in found {
        let described = property.get("description").is_some() || key == "mark";
        assert!(described, "{key}: {property}");
    }
}

#[test]
fn the_other_word_for_integrated_radiance_is_in_the_schema() {
    let all = properties(&schema());
    let quantities = all.iter().filter(|(key, _)| key == "quantity");
    let lists = quantities.filter_map(|(_, property)| property["enum"].as_array());
    let mut count = 0;
    for list in lists {
        assert!(list.iter().any(|word| word == "luminance"), "{list:?}");
        for word in list {
            let text = format!(
                "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n[radiance]\nquantity = {word}\n{}\n[[object]]\nshape = {{ sphere = {{ radius = 1 }} }}\n",
                if word == "line" {
                    "wavelength = \"532 nm\""
                } else {
                    ""
                }
            );
            let scene = parse(&text, "test", "".as_ref(), &Overrides::default()).unwrap();
            let is_integrated = scene.quantity == Quantity::Integrated;
            assert_eq!(
                is_integrated,
                word == "integrated" || word == "luminance",
                "{word}"
            );
        }
        count += 1;
    }
    assert!(count > 0);
}

#[test]
fn descriptions_state_the_defaults_that_are_used() {
    for (key, property) in properties(&schema()) {
        let Some(default) = property.get("default") else {
            continue;
        };
        if default.as_array().is_some_and(Vec::is_empty) {
            continue;
        }
        let description = property["description"].as_str().unwrap().replace('\n', " ");
        let stated = format!("Default: {}.", toml(default));
        assert!(
            description.contains(&stated),
            "{key}: {stated} not in {description}"
        );
    }
}

#[test]
fn toml_has_no_null_and_the_schema_neither() {
    assert!(!contains_null(&schema()));
}

#[test]
fn unknown_keys_are_refused_in_every_table() {
    let schema = schema();
    assert_eq!(schema["additionalProperties"], false);
    for (name, table) in schema["$defs"].as_object().unwrap() {
        if table.get("properties").is_some() {
            assert_eq!(table["additionalProperties"], false, "{name}");
        }
    }
}

#[test]
fn the_reference_scene_shows_every_key() {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    // As a key with its value, or in the name of a table; a word of prose is neither.
    let shows = |line: &str, key: &str| {
        line.match_indices(key).any(|(at, _)| {
            let (before, after) = (&line[..at], &line[at + key.len()..]);
            let is_key = after.trim_start().starts_with('=') || after.starts_with(['.', ']']);
            is_key && !before.ends_with(is_word)
        })
    };
    for (key, _) in properties(&schema()) {
        assert!(REFERENCE.lines().any(|line| shows(line, &key)), "{key}");
    }
}

/// The properties of the table, or of the tables, that a key holds.
fn table<'a>(schema: &'a Value, key: &'a Value) -> Option<&'a Value> {
    let named = key.get("$ref").and_then(Value::as_str);
    if let Some(name) = named.and_then(|path| path.strip_prefix("#/$defs/")) {
        return table(schema, &schema["$defs"][name]);
    }
    let of_many = |keys: &'a Value| keys.as_array()?.iter().find_map(|one| table(schema, one));
    let choices = ["anyOf", "oneOf"].iter().filter_map(|kind| key.get(kind));
    let items = key.get("items").and_then(|one| table(schema, one));
    key.get("properties")
        .or(items)
        .or_else(|| choices.filter_map(of_many).next())
}

/// The default that a description states, where that is one number, text, true or false whatever else there is.
fn stated_default(key: &Value) -> Option<toml_edit::Value> {
    let description = key["description"].as_str()?;
    let (_, stated) = description.split_once("Default: ")?;
    let end = match stated.strip_prefix('"') {
        Some(text) => text.find('"')? + 2,
        None => stated.find([' ', ',', ';', '\n']).unwrap_or(stated.len()),
    };
    let (literal, rest) = stated.split_at(end);
    let is_all = literal.ends_with('.') || rest.starts_with(['.', ';']);
    let literal = literal.trim_end_matches('.');
    literal.parse().ok().filter(|_| is_all)
}

/// Whether both are the same number, text, true or false; none where `a` is none of these.
fn is_same(a: &toml_edit::Value, b: &toml_edit::Value) -> Option<bool> {
    let number = |v: &toml_edit::Value| v.as_float().or_else(|| Some(v.as_integer()? as f64));
    let numbers = number(a).map(|n| Some(n) == number(b));
    let texts = a.as_str().map(|text| Some(text) == b.as_str());
    numbers
        .or(texts)
        .or_else(|| Some(a.as_bool()? == b.as_bool()?))
}

#[test]
fn the_reference_scene_says_the_defaults_in_its_comments_too() {
    let schema = schema();
    let mut keys = &schema["properties"];
    let mut count = 0;
    for line in REFERENCE.lines() {
        let line = line.strip_prefix("# ").unwrap_or(line);
        if let Some((name, _)) = line.strip_prefix('[').and_then(|name| name.split_once(']')) {
            keys = name
                .trim_start_matches('[')
                .split('.')
                .fold(&schema["properties"], |keys, part| {
                    table(&schema, &keys[part]).unwrap_or_else(|| panic!("{line}"))
                });
        }
        // Lists of several lines have no default, and examples say in words which it is.
        let Ok(entry) = line.parse::<toml_edit::DocumentMut>() else {
            continue;
        };
        if line.contains("default") {
            continue;
        }
        for (key, value) in entry.iter().filter_map(|(k, v)| Some((k, v.as_value()?))) {
            let default = stated_default(&keys[key]);
            if let Some(same) = default.and_then(|default| is_same(value, &default)) {
                assert!(same, "{line}");
                count += 1;
            }
        }
    }
    assert!(count > 50, "{count}");
}

#[test]
fn the_reference_scene_names_every_colour_of_diagrams() {
    let text = "[diagram]\nx = [0, 1]\nct = [0, 1]\ntext = [{ text = \"a\", at = [0, 0], colour = \"mauve\" }]\n";
    let parse = nullray::figures::diagram::parse;
    let refused = parse(text, "test", "".as_ref(), &Default::default());
    let refused = refused.unwrap_err().to_string();
    let (_, named) = refused.split_once("there are ").unwrap();
    let (named, _) = named.split_once(", and any").unwrap();
    assert!(named.split(", ").count() > 7, "{named}");
    for colour in named.split(", ") {
        assert!(REFERENCE.contains(colour), "{colour}");
    }
}

/// The TOML in the comments of the reference scene from one line to another, prose left out.
fn commented(from: &str, to: &str) -> Vec<&'static str> {
    let lines = REFERENCE.lines().skip_while(|line| *line != from);
    let block = lines.take_while(|line| *line != to);
    let text = block.filter_map(|line| line.strip_prefix("# "));
    let toml = |line: &&str| line.contains('=') || line.starts_with(['[', ']', ' ']);
    text.filter(toml).collect()
}

#[test]
fn every_motion_of_the_reference_scene_is_accepted() {
    let mut motions: Vec<String> = Vec::new();
    let lines = commented("# [camera.motion]", "# [camera.sensor]").split_off(1);
    let axes = lines[0];
    assert!(axes.starts_with("axes = "));
    for line in lines {
        match motions.last_mut() {
            // The axes stand before the first motion, and go with it.
            Some(motion) if line.starts_with([' ', ']']) || *motion == axes => {
                *motion += &format!("\n{line}")
            }
            _ => motions.push(line.to_string()),
        }
    }
    assert_eq!(motions.len(), 7);
    // An animation names a file, which is not there; see `cameras_and_lights_follow_animated_nodes_slower_than_light`.
    motions.retain(|motion| !motion.starts_with("animation"));
    assert_eq!(motions.len(), 6);
    for motion in motions {
        let eye = match motion.starts_with("keyframes") {
            true => "",
            false => "eye = [0, 1, 5]\n",
        };
        let moving = camera(&format!(
            "{eye}look_at = [0, 1, 0]\n[camera.motion]\n{motion}"
        ));
        assert!(moving.world_line().is_ok(), "{motion}");
    }
}

#[test]
fn sensor_rotation_and_shutter_of_the_reference_scene_are_accepted() {
    let tables = commented("# [camera.sensor]", "# A glTF file:").join("\n");
    let camera = camera(&format!("eye = [0, 1, 5]\nlook_at = [0, 1, 0]\n{tables}"));
    assert!(camera.sensor.is_some() && camera.rotation.is_some() && camera.shutter.is_some());
}

#[test]
fn the_diagram_of_the_reference_scene_is_accepted() {
    let lines = REFERENCE.lines().skip_while(|line| *line != "# [diagram]");
    let table: Vec<&str> = lines.filter_map(|line| line.strip_prefix("# ")).collect();
    // One view, as a boost asks for.
    let table = table.join("\n").replace("[\"world\", \"S'\"]", "\"world\"");
    let text = format!("{REFERENCE}\n{table}\n");
    let parse = nullray::figures::diagram::parse;
    let diagram = parse(&text, "reference", "".as_ref(), &Default::default());
    let diagram = diagram.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(diagram.lines.len(), 10);
    assert_eq!(diagram.events.len(), 6);
    assert!(
        diagram
            .animation
            .is_some_and(|a| a.boost.is_some() && a.sweep.is_some())
    );
}

#[cfg(feature = "schema")]
#[test]
fn the_stored_schemas_are_those_of_the_types() {
    use nullray::{figures::diagram, validate::export};

    // Stored without indentation, so that the package stays small.
    let [bundle, scene] = [export::derived_schema(), diagram::derived_schema()].map(|schema| {
        let text = format!("{schema:#}\n");
        let lines = text.lines().flat_map(|line| [line.trim_start(), "\n"]);
        lines.collect::<String>()
    });
    let stored_and_derived = [
        ("src/scene/schema.json", scene),
        ("src/validate/export/schema.json", bundle),
    ];
    for (at, derived) in stored_and_derived {
        let stored =
            std::fs::read_to_string(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(at))
                .unwrap();
        if stored != derived {
            let new = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("schema.json");
            std::fs::write(&new, derived).unwrap();
            panic!(
                "{at} is not what the types say: copy {} there",
                new.display()
            );
        }
    }
}
