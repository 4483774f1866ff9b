//! Reads the subset of SVG that the writer writes, and refuses everything else.

use std::collections::HashMap;

use nullray::text::Segment;

use super::canvas::{Canvas, Pen};

/// A start tag, an end tag or text.
#[derive(Debug, PartialEq)]
pub enum Token {
    /// A name, its attributes, and whether it is closed at once.
    Start(String, HashMap<String, String>, bool),
    End(String),
    Text(String),
}

/// The tags and texts of an XML file; panics where it is not well-formed.
pub fn tokens(xml: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut open = Vec::new();
    let mut rest = xml;
    while let Some(start) = rest.find('<') {
        let text = rest[..start].trim();
        if !text.is_empty() {
            tokens.push(Token::Text(unescaped(text)));
        }
        let end = start + rest[start..].find('>').expect("a tag ends");
        let tag = &rest[start + 1..end];
        rest = &rest[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name), "tags close in order");
            tokens.push(Token::End(name.to_owned()));
            continue;
        }
        let (name, attributes, closed) = start_tag(tag);
        if !closed {
            open.push(name.clone());
        }
        tokens.push(Token::Start(name, attributes, closed));
    }
    assert!(open.is_empty() && rest.trim().is_empty(), "all is closed");
    tokens
}

fn start_tag(tag: &str) -> (String, HashMap<String, String>, bool) {
    let (tag, closed) = tag
        .strip_suffix('/')
        .map_or((tag, false), |tag| (tag, true));
    let (name, mut rest) = tag.split_once(' ').unwrap_or((tag, ""));
    let mut attributes = HashMap::new();
    while let Some((key, after)) = rest.split_once("=\"") {
        let (value, after) = after.split_once('"').expect("a value ends");
        let key = key.trim().to_owned();
        assert!(!value.contains('<'));
        assert!(
            attributes.insert(key, unescaped(value)).is_none(),
            "attributes are distinct"
        );
        rest = after;
    }
    assert!(rest.trim().is_empty(), "{rest:?} is no attribute");
    (name.to_owned(), attributes, closed)
}

fn unescaped(text: &str) -> String {
    let text = text.replace("&lt;", "<").replace("&gt;", ">");
    text.replace("&quot;", "\"").replace("&amp;", "&")
}

/// The picture of an SVG file with `scale` pixels per unit.
pub fn render(svg: &str, width: u32, height: u32, scale: f64) -> Vec<u8> {
    let mut canvas = Canvas::new(width, height, scale);
    let mut clips = HashMap::new();
    let mut defining = None;
    // How many clips were in force where each open group began.
    let mut groups = Vec::new();
    for token in tokens(svg) {
        match token {
            Token::Start(name, attributes, _) => match name.as_str() {
                "path" => match &defining {
                    Some(id) => {
                        clips.insert(format!("url(#{id})"), data(&attributes["d"]));
                    }
                    None => draw(&mut canvas, &attributes),
                },
                "clipPath" => defining = Some(attributes["id"].clone()),
                "g" => {
                    groups.push(canvas.clips());
                    if let Some(clip) = attributes.get("clip-path") {
                        canvas.clip(&clips[clip]);
                    }
                }
                "svg" | "title" => {}
                other => panic!("an element {other}"),
            },
            Token::End(name) => match name.as_str() {
                "clipPath" => defining = None,
                "g" => canvas.unclip(groups.pop().unwrap()),
                _ => {}
            },
            Token::Text(_) => {}
        }
    }
    canvas.rgba()
}

fn draw(canvas: &mut Canvas, attributes: &HashMap<String, String>) {
    let path = data(&attributes["d"]);
    if attributes["fill"] != "none" {
        return canvas.fill(&path, colour(attributes, "fill"));
    }
    let attribute = |name| attributes.get(name).map_or("", String::as_str);
    let dash = attribute("stroke-dasharray").split_whitespace();
    let pen = Pen {
        width: attributes["stroke-width"].parse().unwrap(),
        dash: dash.map(|part| part.parse().unwrap()).collect(),
        cap: choice(attribute("stroke-linecap"), ["", "round", "square"]),
        join: choice(attribute("stroke-linejoin"), ["", "round", "bevel"]),
    };
    canvas.line(&path, colour(attributes, "stroke"), &pen);
}

fn choice(value: &str, names: [&str; 3]) -> u8 {
    names.iter().position(|name| *name == value).unwrap() as u8
}

fn colour(attributes: &HashMap<String, String>, name: &str) -> [u8; 4] {
    let hex = u32::from_str_radix(attributes[name].strip_prefix('#').unwrap(), 16).unwrap();
    let opacity = attributes.get(&format!("{name}-opacity"));
    let alpha = opacity.map_or(1.0, |value| value.parse::<f64>().unwrap());
    let [_, red, green, blue] = hex.to_be_bytes();
    [red, green, blue, (alpha * 255.0).round() as u8]
}

/// The segments of path data.
pub fn data(d: &str) -> Vec<Segment> {
    let mut segments = Vec::new();
    let mut rest = d;
    while let Some(command) = rest.chars().next() {
        let end = rest[1..]
            .find(|c: char| c.is_ascii_alphabetic())
            .map_or(rest.len(), |i| i + 1);
        let numbers = rest[1..end].split_whitespace();
        let n: Vec<f64> = numbers.map(|value| value.parse().unwrap()).collect();
        segments.push(match (command, n.as_slice()) {
            ('M', &[x, y]) => Segment::Move([x, y]),
            ('L', &[x, y]) => Segment::Line([x, y]),
            ('Q', &[a, b, x, y]) => Segment::Quadratic([a, b], [x, y]),
            ('C', &[a, b, c, d, x, y]) => Segment::Cubic([a, b], [c, d], [x, y]),
            ('Z', []) => Segment::Close,
            other => panic!("path data {other:?}"),
        });
        rest = &rest[end..];
    }
    segments
}
