//! A self-contained page of pictures of one scene at many speeds and times, to be opened in a browser without a network.
//!
//! Everything is in the page: pictures and diagrams as data, style and script inline. Its Content-Security-Policy forbids it to load
//! anything else. The sliders are the browser's, which work with keyboards and screen readers; their values are written below them.
//!
//! Beside the picture are, for a camera that moves with β, the wavelength ratio of light from straight ahead, √((1 − β)/(1 + β)), and the
//! angle from ahead at which something abeam at rest is seen, arccos β (aberration; see [`crate::spacetime`]).

use crate::error::{Error, Result};
use crate::figures::drawing::push_base64;

/// A page.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Page {
    /// Heading and title.
    pub title: String,
    /// The text below the heading; may be empty.
    pub text: String,
    /// The speeds v/c, ascending.
    pub betas: Vec<f64>,
    /// The camera times, metres; one or more.
    pub times: Vec<f64>,
    /// Columns and rows of each picture.
    pub size: [u32; 2],
    /// PNG files: for each time, one for each speed.
    pub pictures: Vec<Vec<u8>>,
    /// SVG texts of the scene's space-time diagram: for each time, one for each speed, like the pictures; either all or none.
    pub diagrams: Vec<String>,
    /// Columns and rows of the grid of pixels that have diagrams; 0 for none.
    pub grid: [u32; 2],
    /// PNG files: for each time and each speed, as the pictures, those of the grid row by row.
    pub probes: Vec<Vec<u8>>,
}

/// The page's HTML.
///
/// # Errors
/// Numbers of pictures, diagrams or probes that do not fit those of speeds and times.
pub fn html(page: &Page) -> Result<String> {
    let (speeds, times) = (page.betas.len(), page.times.len());
    let cells = (page.grid[0] * page.grid[1]) as usize;
    let fits = speeds > 0
        && times > 0
        && page.pictures.len() == speeds * times
        && (page.diagrams.is_empty() || page.diagrams.len() == speeds * times)
        && page.probes.len() == cells * speeds * times;
    if !fits {
        let what = format!(
            "{} pictures of {speeds} speeds and {times} times",
            page.pictures.len()
        );
        return Err(Error::invalid("page", "", what, "one for each"));
    }
    let mut out = String::new();
    let mut rest = TEMPLATE;
    while let Some((before, after)) = rest.split_once("{{") {
        let (name, after) = after.split_once("}}").unwrap_or((after, ""));
        out.push_str(before);
        fill(&mut out, name, page);
        rest = after;
    }
    out.push_str(rest);
    Ok(out)
}

const TEMPLATE: &str = include_str!("page.html");

fn fill(out: &mut String, name: &str, page: &Page) {
    match name {
        "title" => out.push_str(&escaped(&page.title)),
        "text" => out.push_str(&escaped(&page.text)),
        "version" => out.push_str(env!("CARGO_PKG_VERSION")),
        "width" => out.push_str(&page.size[0].to_string()),
        "height" => out.push_str(&page.size[1].to_string()),
        "last-speed" => out.push_str(&(page.betas.len() - 1).to_string()),
        "last-time" => out.push_str(&(page.times.len() - 1).to_string()),
        "betas" => numbers(out, &page.betas),
        "times" => numbers(out, &page.times),
        "grid" => numbers(out, &page.grid.map(f64::from)),
        "pictures" => data(out, "image/png", page.pictures.iter().map(Vec::as_slice)),
        "first" => uri(
            out,
            "image/png",
            page.pictures.first().map_or(&[], Vec::as_slice),
        ),
        "diagrams" => data(
            out,
            "image/svg+xml",
            page.diagrams.iter().map(String::as_bytes),
        ),
        "probes" => data(out, "image/png", page.probes.iter().map(Vec::as_slice)),
        _ => {}
    }
}

fn numbers(out: &mut String, numbers: &[f64]) {
    let numbers: Vec<_> = numbers.iter().map(|n| format!("{n:?}")).collect();
    out.push_str(&numbers.join(", "));
}

/// A list of JavaScript's texts.
fn data<'a>(out: &mut String, kind: &str, files: impl Iterator<Item = &'a [u8]>) {
    for file in files {
        out.push('"');
        uri(out, kind, file);
        out.push_str("\",\n");
    }
}

fn uri(out: &mut String, kind: &str, file: &[u8]) {
    out.push_str("data:");
    out.push_str(kind);
    out.push_str(";base64,");
    push_base64(out, file);
}

/// `text` as HTML shows it, within elements and attributes; control characters, which HTML does not allow, are left out.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c if c.is_control() && c != '\n' => {}
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page() -> Page {
        Page {
            title: "A <b>ball</b> & more".into(),
            betas: vec![0.0, 0.5],
            times: vec![0.0],
            size: [4, 3],
            pictures: vec![b"one".to_vec(), b"two".to_vec()],
            ..Page::default()
        }
    }

    #[test]
    fn a_page_holds_all_pictures_and_no_markup_of_its_title() {
        let html = html(&page()).unwrap();
        assert!(html.contains("<h1>A &lt;b&gt;ball&lt;/b&gt; &amp; more</h1>"));
        // Base 64 of "one" and "two".
        assert!(html.contains("\"data:image/png;base64,b25l\""));
        assert!(html.contains("\"data:image/png;base64,dHdv\""));
        assert!(html.contains("const betas = [0.0, 0.5];"));
        assert!(!html.contains("{{"));
    }

    #[test]
    fn pictures_that_are_missing_are_an_error() {
        let short = Page {
            betas: vec![0.0, 0.5, 0.7],
            ..page()
        };
        assert!(html(&short).is_err());
        let no_diagram = Page {
            diagrams: vec![String::new()],
            ..page()
        };
        assert!(html(&no_diagram).is_err());
        let no_probe = Page {
            grid: [2, 2],
            ..page()
        };
        assert!(html(&no_probe).is_err());
    }
}
