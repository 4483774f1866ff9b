//! The files of the library and of the program use each other in one direction only, and the library does not depend on the program.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

type Module = Vec<String>;

/// The modules of `src`, with the text of their files, without comments and tests.
fn modules() -> BTreeMap<Module, String> {
    fn gather(folder: &Path, at: &Module, modules: &mut BTreeMap<Module, String>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let stem = path.file_stem().unwrap().to_str().unwrap().to_string();
            let mut module = at.clone();
            if path.is_dir() {
                module.push(stem);
                gather(&path, &module, modules);
            } else if path.extension().is_some_and(|e| e == "rs") && stem != "main" {
                if !["mod", "lib"].contains(&stem.as_str()) {
                    module.push(stem);
                }
                let text = fs::read_to_string(&path).unwrap();
                let code = text.split("#[cfg(test)]\nmod ").next().unwrap();
                modules.insert(module, stripped(code, &["//"]));
            }
        }
    }
    let mut modules = BTreeMap::new();
    gather(Path::new("src"), &vec![], &mut modules);
    modules
}

/// `code` without what begins with one of `begins`: comments (`//`) or the contents of strings (`"`).
fn stripped(code: &str, begins: &[&str]) -> String {
    let (mut kept, mut left) = (String::new(), code);
    while let Some(first) = left.chars().next() {
        let begin = match first {
            '/' if left.starts_with("//") => "//",
            '"' => "\"",
            _ => "",
        };
        let escaped =
            |at: usize| left[..at].bytes().rev().take_while(|b| *b == b'\\').count() % 2 == 1;
        let hashes = kept.len() - kept.trim_end_matches('#').len();
        let is_raw = kept.trim_end_matches('#').ends_with('r');
        let length = match first {
            '/' if begin == "//" => left.find('\n').unwrap_or(left.len()),
            '"' if is_raw => {
                let end = format!("\"{}", "#".repeat(hashes));
                1 + left[1..].find(&end).unwrap() + end.len()
            }
            '"' => {
                let mut quotes = left.match_indices('"').skip(1).map(|(at, _)| at);
                1 + quotes.find(|at| !escaped(*at)).unwrap()
            }
            // A character, not a lifetime.
            '\'' if left.starts_with("'\\") => 3 + left[3..].find('\'').unwrap(),
            '\'' if left.chars().nth(2) == Some('\'') => left.char_indices().nth(2).unwrap().0 + 1,
            _ => first.len_utf8(),
        };
        if !begins.contains(&begin) {
            kept.push_str(&left[..length]);
        } else if begin == "\"" {
            kept.push_str("\"\"");
        }
        left = &left[length..];
    }
    kept
}

/// The paths that `code` writes out wherever it uses something, such as `super::wanted::Wanted`.
fn written_out(code: &str) -> Vec<Vec<String>> {
    let code = stripped(code, &["\""]);
    let words = code.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
    let paths = words.map(|word| word.trim_start_matches(':').split("::"));
    let paths = paths.map(|parts| {
        parts
            .filter(|part| !part.is_empty())
            .map(str::to_string)
            .collect::<Vec<_>>()
    });
    paths.filter(|path| path.len() > 1).collect()
}

/// The paths of the `use` declarations of `code`, each with the name that it brings.
fn imports(code: &str) -> Vec<(Vec<String>, String)> {
    fn expand(tree: &str, before: &[String], paths: &mut Vec<(Vec<String>, String)>) {
        let mut path = before.to_vec();
        let (head, group) = match tree.split_once('{') {
            Some((head, group)) => (head, Some(group.rsplit_once('}').unwrap().0)),
            None => (tree, None),
        };
        let (head, name) = head.split_once(" as ").unwrap_or((head, ""));
        path.extend(head.split("::").map(|part| part.trim().to_string()));
        path.retain(|part| !part.is_empty());
        let Some(group) = group else {
            if path.last().is_some_and(|last| last == "self") {
                path.pop();
            }
            let last = path.last().cloned().unwrap_or_default();
            let name = if name.is_empty() {
                last
            } else {
                name.trim().into()
            };
            return paths.push((path, name));
        };
        let (mut depth, mut begin) = (0, 0);
        for (at, c) in group.char_indices().chain([(group.len(), ',')]) {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    if !group[begin..at].trim().is_empty() {
                        expand(group[begin..at].trim(), &path, paths);
                    }
                    begin = at + 1;
                }
                _ => {}
            }
        }
    }
    let mut paths = Vec::new();
    for declaration in code.split(';') {
        let begin = declaration.rfind("use ").filter(|begin| {
            let before = declaration[..*begin].trim_end();
            before.is_empty() || before.ends_with([')', ']', '{', '}']) || before.ends_with("pub")
        });
        if let Some(begin) = begin {
            expand(&declaration[begin + 4..], &[], &mut paths);
        }
    }
    paths
}

/// `path`, as it stands in `module`, from the root of the crate; none where it is another crate's.
fn absolute(path: &[String], module: &Module, all: &BTreeMap<Module, String>) -> Option<Module> {
    let (first, rest) = path.split_first()?;
    let mut base = match first.as_str() {
        "crate" | "nullray" => vec![],
        "self" => module.clone(),
        "super" => module[..module.len() - 1].to_vec(),
        name => {
            let child = [module.as_slice(), &[name.to_string()]].concat();
            all.contains_key(&child).then_some(child)?
        }
    };
    for part in rest {
        match part.as_str() {
            "super" => drop(base.pop()),
            _ => base.push(part.clone()),
        }
    }
    Some(base)
}

/// Which files each file uses.
fn uses() -> BTreeMap<Module, BTreeSet<Module>> {
    let all = modules();
    assert!(all.len() > 300);
    let mut names = BTreeMap::new();
    for (module, code) in &all {
        for (path, name) in imports(code) {
            if let Some(path) = absolute(&path, module, &all) {
                names.insert((module.clone(), name), path);
            }
        }
    }
    let mut paths: BTreeSet<_> = (names.iter())
        .map(|((module, _), path)| (module, path.clone()))
        .collect();
    for (module, code) in &all {
        for path in written_out(code) {
            let imported = names.get(&(module.clone(), path[0].clone()));
            let imported = imported.map(|to| [to.as_slice(), &path[1..]].concat());
            let path = imported.or_else(|| absolute(&path, module, &all));
            paths.extend(path.map(|path| (module, path)));
        }
    }

    // Which file an item is from: the face of a folder hands names on.
    let file_of = |path: &Module| {
        let mut path = path.clone();
        for _ in 0..8 {
            let depth = (0..=path.len())
                .rev()
                .find(|n| all.contains_key(&path[..*n]))?;
            let module = path[..depth].to_vec();
            let handed_on = path.get(depth).map(|name| (module.clone(), name.clone()));
            match handed_on
                .and_then(|key| names.get(&key))
                .filter(|to| **to != path)
            {
                Some(to) => path = [to.as_slice(), &path[depth + 1..]].concat(),
                None => return Some(module),
            }
        }
        None
    };
    let mut edges: BTreeMap<Module, BTreeSet<Module>> = BTreeMap::new();
    for (module, path) in paths {
        let to = file_of(&path).unwrap_or_default();
        // A folder's face and what is in the folder are one.
        if !module.starts_with(&to) && !to.starts_with(module) {
            edges.entry(module.clone()).or_default().insert(to);
        }
    }
    assert!(edges.values().map(BTreeSet::len).sum::<usize>() > 1000);
    edges
}

#[test]
fn a_module_uses_only_those_above_it_in_the_table() {
    let page = fs::read_to_string("src/lib.rs").unwrap();
    let rows = page
        .lines()
        .filter_map(|line| line.strip_prefix("//! | [`"));
    let mut order: Vec<_> = rows.map(|row| row.split('`').next().unwrap()).collect();
    order.push("cli");
    let rank = |module: &Module| order.iter().position(|name| *name == module[0]).unwrap();
    let mut upward = Vec::new();
    for (module, to) in uses() {
        let to = to.iter().filter(|to| rank(to) > rank(&module));
        upward.extend(to.map(|to| format!("{} -> {}", module.join("::"), to.join("::"))));
    }
    assert!(upward.is_empty(), "{}", upward.join("\n"));
}

#[test]
fn files_do_not_use_each_other_in_circles() {
    // Files that use nothing that is left are taken away, until none is: what stays is in circles, or above one.
    let mut left = uses();
    loop {
        let before = left.len();
        let known: BTreeSet<Module> = left.keys().map(|module| module.to_vec()).collect();
        left.retain(|_, to| {
            to.retain(|to| known.contains(to));
            !to.is_empty()
        });
        if left.len() == before {
            break;
        }
    }
    let mut circle = Vec::new();
    if let Some((first, _)) = left.first_key_value() {
        let mut at = first.to_vec();
        while !circle.contains(&at) {
            circle.push(at.clone());
            at = left[&at].first().unwrap().clone();
        }
        let begin = circle.iter().position(|module| *module == at).unwrap();
        circle.drain(..begin);
    }
    let circle: Vec<_> = circle.iter().map(|module| module.join("::")).collect();
    assert!(circle.is_empty(), "a circle: {}", circle.join(" -> "));
}

#[test]
fn the_library_names_no_flags_of_the_program() {
    // Whole commands are those of the program, or of cargo, wherever they are told.
    let is_command = |line: &str| {
        ["cargo install", "gltf-transform", "nullray convert"]
            .iter()
            .any(|c| line.contains(c))
    };
    let has_flag = |line: &&str| {
        let after = |flag: &str| flag.starts_with(|c: char| c.is_ascii_lowercase());
        line.split("--").skip(1).any(after) && !is_command(line)
    };
    let (mut flags, mut of_program) = (Vec::new(), 0);
    for (module, code) in &modules() {
        let lines = code.lines().filter(has_flag);
        match module.first().is_some_and(|room| room == "cli") {
            true => of_program += lines.count(),
            false => {
                flags.extend(lines.map(|line| format!("{}: {}", module.join("::"), line.trim())))
            }
        }
    }
    assert!(flags.is_empty(), "{}", flags.join("\n"));
    assert!(of_program > 100, "{of_program}");
}
