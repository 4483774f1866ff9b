//! Reads the subset of PDF that the writer writes, and refuses everything else.

use std::collections::HashMap;
use std::io::Read;

use nullray::text::Segment;

use super::canvas::{Canvas, Pen};

/// The objects of a PDF file by number, found by its table of offsets; panics where that is wrong.
pub fn objects(pdf: &[u8]) -> HashMap<usize, &[u8]> {
    let start = rfind(pdf, b"startxref").expect("there is a table");
    let after = std::str::from_utf8(&pdf[start + 9..]).unwrap();
    let mut words = after.split_whitespace();
    let table: usize = words.next().unwrap().parse().unwrap();
    assert_eq!(words.next(), Some("%%EOF"));
    let lines = std::str::from_utf8(&pdf[table..start])
        .unwrap()
        .lines()
        .collect::<Vec<_>>();
    assert_eq!(lines[0], "xref");
    let count: usize = lines[1].strip_prefix("0 ").unwrap().parse().unwrap();
    let mut objects = HashMap::new();
    for number in 1..count {
        // Entries of exactly 20 bytes: offset, generation, in use.
        let entry = lines[2 + number];
        assert_eq!(entry.trim_end().len(), 18, "{entry:?}");
        let offset: usize = entry[..10].parse().unwrap();
        let object = &pdf[offset..];
        let head = format!("{number} 0 obj");
        assert!(
            object.starts_with(head.as_bytes()),
            "object {number} is at {offset}"
        );
        let end = find(object, b"endobj").unwrap();
        objects.insert(number, &object[head.len()..end]);
    }
    let trailer = lines[2 + count..].join(" ");
    assert!(trailer.contains("/Root 1 0 R"), "{trailer}");
    objects
}

/// The content of the page, unpacked.
pub fn content(pdf: &[u8]) -> String {
    let object = objects(pdf)[&4];
    let start = find(object, b"stream\n").unwrap() + 7;
    let mut content = String::new();
    let mut unpacked = flate2::read::ZlibDecoder::new(&object[start..]);
    unpacked.read_to_string(&mut content).unwrap();
    content
}

fn find(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).position(|window| window == what)
}

fn rfind(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).rposition(|window| window == what)
}

/// What a page's operators set.
#[derive(Clone)]
struct State {
    fill: [u8; 3],
    stroke: [u8; 3],
    alpha: u8,
    pen: Pen,
    clips: usize,
}

/// The picture of a page's content, with `scale` pixels per point.
pub fn render(pdf: &[u8], page_height: f64, width: u32, height: u32, scale: f64) -> Vec<u8> {
    let mut canvas = Canvas::new(width, height, scale);
    let mut state = State {
        fill: [0; 3],
        stroke: [0; 3],
        alpha: 255,
        pen: Pen::default(),
        clips: 0,
    };
    let mut saved = Vec::new();
    let mut path = Vec::new();
    let mut numbers: Vec<f64> = Vec::new();
    let mut name = String::new();
    let content = content(pdf).replace(['[', ']'], " ");
    for word in content.split_whitespace() {
        if let Ok(number) = word.parse() {
            numbers.push(number);
            continue;
        }
        if let Some(word) = word.strip_prefix('/') {
            name = word.to_owned();
            continue;
        }
        let rgb = || [0, 1, 2].map(|i| (numbers[i] * 255.0).round() as u8);
        match (word, numbers.as_slice()) {
            ("cm", [turn @ .., height]) => {
                assert_eq!(turn, [1.0, 0.0, 0.0, -1.0, 0.0]);
                assert!((height - page_height).abs() < 1e-4);
            }
            ("M", n) => assert_eq!(n, [4.0]),
            ("rg", _) => state.fill = rgb(),
            ("RG", _) => state.stroke = rgb(),
            ("gs", _) => state.alpha = name.strip_prefix('A').unwrap().parse().unwrap(),
            ("w", &[width]) => state.pen.width = width,
            ("J", &[cap]) => state.pen.cap = cap as u8,
            ("j", &[join]) => state.pen.join = join as u8,
            ("d", [dash @ .., 0.0]) => state.pen.dash = dash.iter().map(|d| *d as f32).collect(),
            ("m", &[x, y]) => path.push(Segment::Move([x, y])),
            ("l", &[x, y]) => path.push(Segment::Line([x, y])),
            ("c", &[a, b, c, d, x, y]) => path.push(Segment::Cubic([a, b], [c, d], [x, y])),
            ("h", []) => path.push(Segment::Close),
            ("f", []) => {
                let [red, green, blue] = state.fill;
                canvas.fill(&std::mem::take(&mut path), [red, green, blue, state.alpha]);
            }
            ("S", []) => {
                let [red, green, blue] = state.stroke;
                let rgba = [red, green, blue, state.alpha];
                canvas.line(&std::mem::take(&mut path), rgba, &state.pen);
            }
            ("W", []) => canvas.clip(&path),
            ("n", []) => path.clear(),
            ("q", []) => {
                state.clips = canvas.clips();
                saved.push(state.clone());
            }
            ("Q", []) => {
                state = saved.pop().unwrap();
                canvas.unclip(state.clips);
            }
            other => panic!("an operator {other:?}"),
        }
        numbers.clear();
    }
    assert!(saved.is_empty(), "every q has its Q");
    canvas.rgba()
}
