//! The default names of objects and sources.

use std::collections::{HashMap, HashSet};
use std::path::Path;

/// The default name of an object: its node, or its file's name without extension, or its shape.
pub(super) fn object(gltf: Option<&str>, node: Option<&str>, shape: Option<&str>) -> String {
    let name = node
        .map(str::to_string)
        .or_else(|| gltf.map(file_stem))
        .or_else(|| shape.map(str::to_string));
    name.unwrap_or_else(|| "object".into())
}

/// The default name of a light: the node or the name without extension of its glTF file, or else its type.
pub(super) fn light(gltf: Option<&str>, node: Option<&str>, kind: &str) -> String {
    match gltf {
        Some(_) => object(gltf, node, None),
        None => kind.to_string(),
    }
}

/// The default name of a source: its cube's file name without extension, or "pulse".
pub(super) fn source(cube_file: Option<&str>) -> String {
    cube_file.map_or_else(|| "pulse".into(), file_stem)
}

/// The names of all: each entry's name in the file, or else its default, numbered "-2", "-3", … if that is taken.
pub(super) fn unique(entries: Vec<(Option<String>, String)>) -> Vec<String> {
    let explicit = entries.iter().filter_map(|(name, _)| name.clone());
    let mut taken: HashSet<String> = explicit.collect();
    let mut numbers: HashMap<String, u64> = HashMap::new();
    let name = |(name, default): (Option<String>, String)| {
        name.unwrap_or_else(|| free(default, &mut taken, &mut numbers))
    };
    entries.into_iter().map(name).collect()
}

/// The first of "x", "x-2", "x-3", … that is free; marks it as taken.
fn free(
    default: String,
    taken: &mut HashSet<String>,
    numbers: &mut HashMap<String, u64>,
) -> String {
    let number = numbers.entry(default.clone()).or_insert(0);
    loop {
        *number += 1;
        let name = match *number {
            1 => default.clone(),
            n => format!("{default}-{n}"),
        };
        if taken.insert(name.clone()) {
            return name;
        }
    }
}

fn file_stem(path: &str) -> String {
    let stem = Path::new(path).file_stem();
    stem.map_or_else(
        || path.to_string(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_default_name_that_is_taken_gets_a_number() {
        let default = |name: &str| (None, name.to_string());
        let entries = vec![
            default("box"),
            (Some("box-2".into()), "box".into()),
            default("box"),
            default("sphere"),
        ];
        assert_eq!(unique(entries), ["box", "box-2", "box-3", "sphere"]);
    }

    #[test]
    fn the_default_name_says_most_about_the_thing() {
        assert_eq!(object(Some("a/b.glb"), Some("Wheel"), None), "Wheel");
        assert_eq!(object(Some("a/b.glb"), None, None), "b");
        assert_eq!(object(None, None, Some("box")), "box");
        assert_eq!(source(Some("c.d.npy")), "c.d");
    }
}
