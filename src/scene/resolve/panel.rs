//! Panels and their sheet.

use std::collections::HashSet;
use std::str::FromStr;

use toml_edit::{DocumentMut, Item, Key, TableLike, Value};

use super::context::Context;
use crate::error::Result;
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::model::{Panel, Sheet};
use crate::spacetime::units::quoted;

/// The largest number of panels of a scene, and of a row.
const MOST: usize = 100;
/// The longest name, bytes.
const LONGEST_NAME: usize = 80;

pub(super) fn sheet(cx: &Context, sheet: &file::Sheet) -> Result<Sheet> {
    let columns = match &sheet.columns {
        Some(columns) if !(1..=MOST as u32).contains(&columns.value) => {
            let what = format!("{} panels side by side cannot be drawn", columns.value);
            return Err(cx.refuse(columns, what, format!("give 1 to {MOST}, like 4")));
        }
        columns => columns.as_ref().map(|at| at.value),
    };
    Ok(Sheet {
        title: cx.optional_text(&sheet.title, "the title")?,
        columns,
    })
}

pub(super) fn resolve_all(cx: &Context, panels: &[At<file::Panel>]) -> Result<Vec<Panel>> {
    if let Some(beyond) = panels.get(MOST) {
        let what = format!("{} panels are too many", panels.len());
        return Err(cx.refuse(beyond, what, format!("a scene has at most {MOST} panels")));
    }
    if panels.is_empty() {
        return Ok(Vec::new());
    }
    let mut taken = HashSet::new();
    let changes = changes(&cx.report.text.edited);
    let changes = changes.into_iter().chain(std::iter::repeat_with(Vec::new));
    let resolve = |(panel, set)| resolve(cx, panel, set, &mut taken);
    panels.iter().zip(changes).map(resolve).collect()
}

fn resolve(
    cx: &Context,
    at: &At<file::Panel>,
    set: Vec<(String, String)>,
    taken: &mut HashSet<String>,
) -> Result<Panel> {
    let panel = &at.value;
    let name = file_name(cx, &panel.name)?;
    // File systems may not distinguish upper from lower case.
    if !taken.insert(name.to_ascii_lowercase()) {
        let what = format!("another panel is also named {}", quoted(name));
        let help = "give each panel a name of its own (upper and lower case are the same)";
        return Err(cx.refuse(&panel.name, what, help));
    }
    refuse_changes_of_panels(cx, &panel.set, &set)?;
    let label = cx.optional_text(&panel.label, "the label")?;
    Ok(Panel {
        name: name.to_string(),
        label: label.unwrap_or_else(|| name.to_string()),
        show: panel.show,
        new_row: panel.new_row,
        set,
        span: match panel.set.span.is_empty() {
            true => at.span.clone(),
            false => panel.set.span.clone(),
        },
    })
}

fn file_name<'a>(cx: &Context, at: &'a At<String>) -> Result<&'a str> {
    let name = cx.text(at, "the name")?;
    let fits = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '-');
    if name.chars().all(fits) && name.len() <= LONGEST_NAME {
        return Ok(name);
    }
    let what = format!("{} cannot be part of a file's name", quoted(name));
    let help = format!(
        "a panel's name has at most {LONGEST_NAME} letters (a to z), digits, dots, underscores and hyphens, \
         like beta-0.9; `label` is what people read"
    );
    Err(cx.refuse(at, what, help))
}

/// Refuses changes to the figure itself: a panel changes only the scene.
fn refuse_changes_of_panels<T>(cx: &Context, at: &At<T>, set: &[(String, String)]) -> Result<()> {
    let of_panels = |(key, _): &&(String, String)| {
        let path = Key::parse(key).unwrap_or_default();
        let first = path.first().map(Key::get);
        matches!(first, Some("panel" | "sheet"))
    };
    match set.iter().find(of_panels) {
        None => Ok(()),
        Some((key, _)) => {
            let what = format!("{} is not part of what a panel shows", quoted(key));
            let help = "a panel sets keys of the scene, like \"camera.time\"";
            Err(cx.refuse(at, what, help))
        }
    }
}

/// What each panel of the text sets: dotted keys, and their values as TOML.
fn changes(text: &str) -> Vec<Vec<(String, String)>> {
    let Ok(document) = DocumentMut::from_str(text) else {
        return Vec::new();
    };
    let of_panel = |panel: &dyn TableLike| {
        let mut found = Vec::new();
        if let Some(set) = panel.get("set").and_then(Item::as_table_like) {
            collect(set, "", &mut found);
        }
        found
    };
    match document.get("panel") {
        Some(Item::ArrayOfTables(panels)) => panels.iter().map(|p| of_panel(p)).collect(),
        Some(Item::Value(Value::Array(panels))) => {
            let tables = panels.iter().filter_map(Value::as_inline_table);
            tables.map(|p| of_panel(p)).collect()
        }
        _ => Vec::new(),
    }
}

/// Dotted keys and headers are followed; what they lead to, including inline tables, is a value. A quoted key at the start is a whole
/// path.
fn collect(table: &dyn TableLike, path: &str, found: &mut Vec<(String, String)>) {
    for (key, item) in table.iter() {
        let path = match path {
            "" => key.to_string(),
            path => format!("{path}.{}", Key::new(key).display_repr()),
        };
        match item {
            Item::Table(below) => collect(below, &path, found),
            Item::Value(Value::InlineTable(below)) if below.is_dotted() => {
                collect(below, &path, found);
            }
            // An array of tables under headers is one value too; the comment after a value is not part of it.
            value => {
                let value = value.clone().into_value();
                found.extend(value.map(|v| (path, v.decorated("", "").to_string())));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(text: &str) -> Vec<(String, String)> {
        changes(text).remove(0)
    }

    #[test]
    fn keys_are_dotted_in_quotes_without_and_under_headers() {
        let expected = [("camera.velocity.beta".to_string(), "[0, 0, -0.90]".into())];
        for text in [
            "[[panel]]\nset = { \"camera.velocity.beta\" = [0, 0, -0.90] }",
            "[[panel]]\nset = { camera.velocity.beta = [0, 0, -0.90] }",
            "[[panel]]\nset.camera.velocity.beta = [0, 0, -0.90]",
            "[[panel]]\n[panel.set]\n\"camera.velocity.beta\" = [0, 0, -0.90] # fast",
            "[[panel]]\n[panel.set.camera.velocity]\nbeta = [0, 0, -0.90]",
            "panel = [{ set = { \"camera.velocity\".beta = [0, 0, -0.90] } }]",
        ] {
            assert_eq!(set(text), expected, "{text}");
        }
    }

    #[test]
    fn an_inline_table_is_a_value() {
        let text = "[[panel]]\nset = { camera.velocity = { beta = 0.5 }, outside = \"hold\" }";
        assert_eq!(
            set(text),
            [
                ("camera.velocity".to_string(), "{ beta = 0.5 }".to_string()),
                ("outside".to_string(), "\"hold\"".to_string()),
            ]
        );
    }

    #[test]
    fn names_with_spaces_stay_one_key() {
        let text = "[[panel]]\nset = { object.\"big wheel\".colour = [1, 0, 0] }";
        assert_eq!(set(text)[0].0, "object.\"big wheel\".colour");
    }
}
