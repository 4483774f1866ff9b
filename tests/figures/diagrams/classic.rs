//! The classic figures of `scenes/diagrams`.

use std::path::PathBuf;

use nullray::figures::diagram;
use nullray::figures::drawing::{Drawing, Item, Text, pdf, png, svg};

fn files() -> Vec<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes/diagrams");
    let entries = std::fs::read_dir(folder).unwrap();
    let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(files.len() >= 10, "{files:?}");
    files
}

fn drawn(file: &std::path::Path) -> Drawing {
    let model = diagram::load(file, &Default::default()).unwrap_or_else(|error| panic!("{error}"));
    diagram::draw(&diagram::layout(&model), &model.style).unwrap()
}

fn texts(items: &[Item]) -> Vec<&Text> {
    let mut found = Vec::new();
    for item in items {
        match item {
            Item::Text(text) => found.push(text),
            Item::Clip { items, .. } => found.extend(texts(items)),
            Item::Path { .. } | Item::Image { .. } => {}
        }
    }
    found
}

#[test]
fn every_file_is_drawn_in_every_format() {
    for file in files() {
        let drawing = drawn(&file);
        assert!(svg::write(&drawing).unwrap().contains("</svg>"));
        assert!(pdf::write(&drawing).unwrap().starts_with(b"%PDF"));
        let raster = png::render(&drawing, 1.0).unwrap();
        assert!(
            png::write(&raster).unwrap().starts_with(b"\x89PNG"),
            "{file:?}"
        );
    }
}

#[track_caller]
fn check_labels(drawing: &Drawing, name: &str) {
    let texts = texts(&drawing.items);
    for (i, a) in texts.iter().enumerate() {
        for b in texts.iter().skip(i + 1) {
            let (p, q) = (a.bounds().unwrap(), b.bounds().unwrap());
            let apart = (0..2).any(|k| p.max[k] <= q.min[k] || q.max[k] <= p.min[k]);
            assert!(apart, "{name}: {} on {}", a.text.text(), b.text.text());
        }
    }
}

#[test]
fn no_label_is_on_another() {
    for file in files() {
        check_labels(&drawn(&file), &file.display().to_string());
    }
}

#[test]
fn no_label_is_on_another_while_the_diagram_moves() {
    let mut moving = 0;
    for file in files() {
        let model = diagram::load(&file, &Default::default()).unwrap();
        let Some(series) = nullray::figures::diagram::Series::new(&model) else {
            continue;
        };
        for (k, drawing) in series.enumerate() {
            check_labels(&drawing.unwrap(), &format!("{}, {k}", file.display()));
        }
        moving += 1;
    }
    assert!(moving >= 2, "{moving}");
}

#[test]
fn every_label_is_on_the_page() {
    for file in files() {
        let drawing = drawn(&file);
        for text in texts(&drawing.items) {
            let rect = text.bounds().unwrap();
            let inside = rect.min.iter().all(|v| *v >= 0.0)
                && rect.max[0] <= drawing.width
                && rect.max[1] <= drawing.height;
            assert!(inside, "{file:?}: {} at {rect:?}", text.text.text());
        }
    }
}

#[test]
fn every_file_says_what_it_teaches_and_is_short() {
    for file in files() {
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.starts_with("# "), "{file:?}");
        assert!(text.lines().count() <= 32, "{file:?}");
    }
}

#[test]
fn the_same_diagram_is_drawn_to_the_same_bytes() {
    let file = &files()[0];
    assert_eq!(
        svg::write(&drawn(file)).unwrap(),
        svg::write(&drawn(file)).unwrap()
    );
}

#[test]
fn a_diagram_alone_is_not_a_scene_to_render() {
    let file = &files()[0];
    let error = nullray::scene::load(file, &Default::default()).unwrap_err();
    assert!(error.to_string().contains("no camera"), "{error}");
}

#[test]
fn world_lines_go_with_the_speed_of_the_frame_that_the_title_names() {
    use nullray::figures::diagram::model::Diagram;
    let at = |name: &str, beta: f64| -> Diagram {
        let path =
            PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/diagrams/{name}.toml"));
        let overrides = nullray::scene::Overrides {
            set: vec![("diagram.frame.\"S'\".velocity".into(), beta.to_string())],
            ..Default::default()
        };
        diagram::load(&path, &overrides).unwrap()
    };
    // The moving lines, and what the intervals measure at β = 0.28, where 1/γ = 0.96.
    for (name, lines, values) in [
        (
            "length-contraction",
            &["rear", "front"][..],
            &["1.92", "2"][..],
        ),
        ("simultaneity", &["train", "rear end", "front end"], &[]),
        ("light-clock", &["rear", "front"], &[]),
        ("time-dilation", &["clock'"], &["1.042", "1.042"]),
        ("ladder-paradox", &["rear", "front"], &["1.92"]),
    ] {
        let model = at(name, 0.28);
        for line in lines {
            let found = model.lines.iter().find(|known| known.name == *line);
            let track = &found.unwrap_or_else(|| panic!("{name}: {line}")).track;
            let [from, to] = track.span();
            let moment = track.at(from.max(-1.0).midpoint(to.min(1.0))).unwrap();
            let beta = moment.velocity.beta().dot(model.direction);
            assert!((beta - 0.28).abs() < 1e-12, "{name}: {line} at {beta}");
        }
        let drawing = diagram::draw(&diagram::layout(&model), &model.style).unwrap();
        let all: Vec<String> = texts(&drawing.items)
            .iter()
            .map(|text| text.text.text())
            .collect();
        assert!(
            all.iter().any(|text| text.contains("β = 0.28")),
            "{name}: {all:?}"
        );
        for value in values {
            assert!(
                all.iter().any(|text| text.ends_with(&format!("= {value}"))),
                "{name}: {all:?}"
            );
        }
    }
}
