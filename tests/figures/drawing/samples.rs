//! Small drawings that together use all features.

use nullray::figures::drawing::{
    Anchor, AnchorX, AnchorY, Arrow, Cap, Colour, Drawing, Fill, Hatch, Item, Join, Path, Stroke,
    Text,
};
use nullray::text::{Rect, RichText};

pub const RED: Colour = Colour::rgb(190, 30, 40);
pub const BLUE: Colour = Colour::rgb(30, 70, 170);

/// A white page of 120 × 60 points.
pub fn page(title: &str, items: Vec<Item>) -> Drawing {
    Drawing {
        width: 120.0,
        height: 60.0,
        title: title.to_owned(),
        origin: Vec::new(),
        background: Colour::WHITE,
        items,
    }
}

pub fn text(markup: &str, at: [f64; 2], size: f64) -> Text {
    Text::new(RichText::parse(markup).unwrap(), at, size)
}

/// Words as they stand.
pub fn plain(words: &str) -> Text {
    Text::new(RichText::plain(words).unwrap(), [10.0, 30.0], 10.0)
}

/// Every sample, by name.
pub fn all() -> Vec<(&'static str, Drawing)> {
    vec![
        ("arrows", page("Arrows", arrows())),
        ("dashes", page("Dashes", dashes())),
        ("hatches", page("Hatches", hatches())),
        ("labels", page("Labels", labels())),
        ("lines", page("World lines", lines())),
    ]
}

fn arrows() -> Vec<Item> {
    let arrow = Arrow::of_line(1.5);
    let stroke = Stroke::new(BLUE, 1.5);
    let curve = Path::smooth(&[[10.0, 50.0], [30.0, 20.0], [60.0, 25.0], [75.0, 50.0]]);
    vec![
        Item::stroked(
            Path::line([8.0, 8.0], [70.0, 12.0]),
            stroke.clone().ending(arrow),
        ),
        Item::stroked(
            curve,
            stroke.clone().rounded().starting(arrow).ending(arrow),
        ),
        Item::stroked(
            Path::polyline(&[[90.0, 55.0], [110.0, 40.0], [95.0, 8.0]]),
            stroke.dashed([4.0, 2.0]).ending(arrow),
        ),
        // Shorter than its heads.
        Item::stroked(
            Path::line([80.0, 20.0], [85.0, 20.0]),
            Stroke::new(RED, 0.8).starting(arrow).ending(arrow),
        ),
    ]
}

fn dashes() -> Vec<Item> {
    let mut items = Vec::new();
    for (i, cap) in [Cap::Butt, Cap::Round, Cap::Square].into_iter().enumerate() {
        for (j, join) in [Join::Miter, Join::Round, Join::Bevel]
            .into_iter()
            .enumerate()
        {
            let (x, y) = (6.0 + 38.0 * j as f64, 6.0 + 18.0 * i as f64);
            let corner = Path::polyline(&[[x, y], [x + 28.0, y + 2.0], [x + 8.0, y + 13.0]]);
            let stroke = Stroke {
                cap,
                join,
                ..Stroke::new(RED, 3.0)
            };
            let stroke = if j == i {
                stroke.dashed([5.0, 4.0, 1.0])
            } else {
                stroke
            };
            items.push(Item::stroked(corner, stroke));
        }
    }
    items.push(Item::stroked(
        Path::circle([60.0, 30.0], 20.0),
        Stroke::new(BLUE, 0.4).dashed([3.0, 1.5]),
    ));
    items
}

fn hatches() -> Vec<Item> {
    let hatched = |path: Path, angle: f64| Item::Path {
        path,
        fill: Some(Fill {
            colour: BLUE.with_alpha(160),
            hatch: Some(Hatch {
                angle,
                spacing: 4.0,
                width: 0.8,
            }),
        }),
        stroke: Some(Stroke::new(Colour::BLACK, 0.6)),
    };
    let rect = Rect {
        min: [70.0, 8.0],
        max: [112.0, 34.0],
    };
    vec![
        Item::filled(Path::circle([40.0, 36.0], 18.0), RED.with_alpha(90)),
        hatched(Path::circle([24.0, 26.0], 20.0), 0.6),
        hatched(Path::rect(rect), -0.9),
        Item::Clip {
            path: Path::polygon(&[[60.0, 58.0], [90.0, 30.0], [118.0, 58.0]]),
            items: vec![
                Item::filled(Path::circle([78.0, 50.0], 12.0), BLUE),
                hatched(Path::circle([98.0, 50.0], 14.0), 0.0),
            ],
        },
    ]
}

fn labels() -> Vec<Item> {
    let anchored = |markup, at, x, y| {
        Item::Text(Text {
            anchor: Anchor { x, y },
            ..text(markup, at, 11.0)
        })
    };
    vec![
        Item::filled(
            Path::rect(Rect {
                min: [60.0, 0.0],
                max: [120.0, 60.0],
            }),
            RED.with_alpha(60),
        ),
        anchored(
            "*ct*' = *γ*(*ct* - *βx*)",
            [60.0, 2.0],
            AnchorX::Middle,
            AnchorY::Top,
        ),
        anchored(
            "*x*_A^2 + 10^{-9} s",
            [118.0, 30.0],
            AnchorX::End,
            AnchorY::Middle,
        ),
        anchored("Alice’s", [2.0, 58.0], AnchorX::Start, AnchorY::Bottom),
        Item::Text(Text {
            angle: 0.7,
            colour: BLUE,
            halo: Some((Colour::WHITE, 1.2)),
            ..text("Δ*τ* ⊥ *Q*", [60.0, 56.0], 10.0)
        }),
    ]
}

fn lines() -> Vec<Item> {
    let area = Path::rect(Rect {
        min: [6.0, 6.0],
        max: [114.0, 54.0],
    });
    let world = |x: f64| {
        let points: Vec<[f64; 2]> = (0..=12)
            .map(|i| {
                let t = f64::from(i) / 6.0 - 1.0;
                [
                    x + 20.0 * ((1.0 + 4.0 * t * t).sqrt() - 1.0),
                    30.0 - 40.0 * t,
                ]
            })
            .collect();
        Path::smooth(&points)
    };
    let cone = Path::polygon(&[[60.0, 30.0], [120.0, 90.0], [0.0, 90.0]]).and(Path::polygon(&[
        [60.0, 30.0],
        [120.0, -30.0],
        [0.0, -30.0],
    ]));
    let inside = vec![
        Item::filled(cone, Colour::rgb(250, 220, 120).with_alpha(128)),
        Item::stroked(world(30.0), Stroke::new(BLUE, 1.2)),
        Item::stroked(
            world(60.0),
            Stroke::new(RED, 1.2).dashed([3.0, 2.0]).rounded(),
        ),
    ];
    vec![
        Item::Clip {
            path: area.clone(),
            items: inside,
        },
        Item::stroked(area, Stroke::new(Colour::BLACK, 0.5)),
    ]
}

/// The diagrams of `scenes/diagrams`, by name.
pub fn classics() -> Vec<(String, Drawing)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/diagrams");
    let entries = std::fs::read_dir(folder).unwrap();
    let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let drawn = files.iter().map(|file| {
        let model = nullray::figures::diagram::load(file, &Default::default()).unwrap();
        let layout = nullray::figures::diagram::layout(&model);
        let drawing = nullray::figures::diagram::draw(&layout, &model.style).unwrap();
        let name = file.file_stem().unwrap().to_str().unwrap();
        (name.to_string(), drawing)
    });
    drawn.collect()
}

/// Samples and classics.
pub fn both() -> Vec<(String, Drawing)> {
    let samples = all().into_iter();
    let samples = samples.map(|(name, drawing)| (name.to_string(), drawing));
    samples.chain(classics()).collect()
}
