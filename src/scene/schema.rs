//! The JSON schema of a scene file, and queries on it.

#[cfg(feature = "schema")]
use std::collections::HashMap;

#[cfg(feature = "schema")]
use serde_json::Map;
use serde_json::Value;

#[cfg(feature = "schema")]
use super::file;
use super::place::Step;

/// The schema of scene files as shipped. It is derived from the types that parse them; a test compares the two.
const SCHEMA: &str = include_str!("schema.json");

/// The JSON schema (draft 2020-12) of a scene file with its `[diagram]`, for editors: descriptions, defaults, and what is
/// refused.
pub fn schema() -> Value {
    serde_json::from_str(SCHEMA).unwrap_or_default()
}

/// The schema derived from the types, where `[diagram]` is a `D`.
#[cfg(feature = "schema")]
pub(crate) fn derived<D: schemars::JsonSchema>() -> Value {
    let mut schema = schemars::schema_for!(file::Scene<D>).to_value();
    tidy(&mut schema);
    inline_words(&mut schema);
    schema
}

#[cfg(feature = "schema")]
/// Lists the words of enumerations where they may appear; their meaning is in the description of the key.
fn inline_words(schema: &mut Value) {
    let Some(Value::Object(definitions)) = schema.get_mut("$defs") else {
        return;
    };
    let words = |definition: &Value| -> Option<Vec<Value>> {
        let words = definition.get("oneOf")?.as_array()?.iter();
        words.map(|word| word.get("const").cloned()).collect()
    };
    let mut lists = HashMap::new();
    definitions.retain(|name, definition| match words(definition) {
        Some(list) => lists.insert(format!("#/$defs/{name}"), list).is_some(),
        None => true,
    });
    put_words(schema, &lists);
}

#[cfg(feature = "schema")]
fn put_words(value: &mut Value, lists: &HashMap<String, Vec<Value>>) {
    match value {
        Value::Array(items) => items.iter_mut().for_each(|item| put_words(item, lists)),
        Value::Object(map) => {
            let target = map.get("$ref").and_then(Value::as_str);
            if let Some(list) = target.and_then(|target| lists.get(target)) {
                map.remove("$ref");
                map.insert("type".into(), "string".into());
                map.insert("enum".into(), list.clone().into());
            }
            map.values_mut().for_each(|item| put_words(item, lists));
        }
        _ => {}
    }
}

#[cfg(feature = "schema")]
/// Removes `null`, which TOML does not have, and the repeated defaults of whole tables.
fn tidy(value: &mut Value) {
    match value {
        Value::Array(items) => items.iter_mut().for_each(tidy),
        Value::Object(map) => {
            map.retain(|key, value| key != "default" || !(value.is_null() || value.is_object()));
            tidy_type(map);
            tidy_alternatives(map);
            map.values_mut().for_each(tidy);
        }
        _ => {}
    }
}

#[cfg(feature = "schema")]
fn tidy_type(map: &mut Map<String, Value>) {
    if let Some(Value::Array(words)) = map.get_mut("enum") {
        words.retain(|word| !word.is_null());
    }
    let Some(Value::Array(types)) = map.get_mut("type") else {
        return;
    };
    types.retain(|name| name != "null");
    if let [only] = types.as_slice() {
        let only = only.clone();
        map.insert("type".into(), only);
    }
}

#[cfg(feature = "schema")]
fn tidy_alternatives(map: &mut Map<String, Value>) {
    let Some(Value::Array(alternatives)) = map.get_mut("anyOf") else {
        return;
    };
    alternatives.retain(|schema| schema.get("type") != Some(&Value::from("null")));
    if let [Value::Object(only)] = alternatives.as_slice() {
        let only = only.clone();
        map.remove("anyOf");
        for (key, value) in only {
            map.entry(key).or_insert(value);
        }
    }
}

/// The part of `schema` that describes `place`.
pub(super) fn at<'s>(schema: &'s Value, place: &[Step]) -> Option<&'s Value> {
    place.iter().try_fold(schema, |node, step| {
        alternatives(schema, node)
            .into_iter()
            .find_map(|node| match step {
                Step::Key(key) => node.get("properties")?.get(key),
                Step::Index(_) => node.get("items"),
            })
    })
}

/// The keys of the table that `node` describes.
pub(super) fn keys<'s>(schema: &'s Value, node: &'s Value) -> Vec<&'s str> {
    let tables = alternatives(schema, node).into_iter();
    let properties = tables.filter_map(|node| node.get("properties")?.as_object());
    properties
        .flat_map(|map| map.keys().map(String::as_str))
        .collect()
}

/// The description of `node`, on one line.
pub(super) fn description(node: &Value) -> Option<String> {
    let text = node.get("description")?.as_str()?;
    Some(text.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// `node`, the definition that it refers to, its alternatives, and theirs.
fn alternatives<'s>(schema: &'s Value, node: &'s Value) -> Vec<&'s Value> {
    let definition = |node: &'s Value| {
        let pointer = node.get("$ref")?.as_str()?.strip_prefix('#')?;
        schema.pointer(pointer)
    };
    let listed = |node: &'s Value| {
        let lists = ["anyOf", "oneOf"].map(|key| node.get(key).and_then(Value::as_array));
        lists.into_iter().flatten().flatten()
    };
    let mut found = vec![node];
    let mut next = 0;
    // The definitions are not recursive, so this ends.
    while let Some(&node) = found.get(next) {
        found.extend(definition(node));
        found.extend(listed(node));
        next += 1;
    }
    found
}
