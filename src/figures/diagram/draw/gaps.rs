//! Gaps in lines for labels, if a crowded page or a moving label has no other place.

use std::collections::BTreeMap;

use super::labels::{widened, without};
use super::parts::{pieces, straight};
use crate::figures::drawing::Item;
use crate::text::Rect;

/// Free space around a label, points.
const AIR: f64 = 0.6;
/// The height of a row in which labels are looked up, points.
const ROW: f64 = 16.0;
/// Lines of less opacity are seen as ground.
const PALE: u8 = 170;

/// `items` with gaps in lines that go through `labels`.
pub(super) fn interrupted(items: Vec<Item>, labels: &[Rect]) -> Vec<Item> {
    let labels = Labels::new(labels);
    items
        .into_iter()
        .flat_map(|item| labels.without(item))
        .collect()
}

/// Labels by the rows of the page that they are in.
struct Labels(BTreeMap<i32, Vec<Rect>>);

impl Labels {
    fn new(labels: &[Rect]) -> Labels {
        let mut rows: BTreeMap<i32, Vec<Rect>> = BTreeMap::new();
        for label in labels {
            for row in row(label.min[1])..=row(label.max[1]) {
                rows.entry(row).or_default().push(*label);
            }
        }
        Labels(rows)
    }

    /// An item with gaps.
    fn without(&self, item: Item) -> Vec<Item> {
        match item {
            // The lines are inside of clips, which may be nested.
            Item::Clip { path, items } => {
                let items = items.into_iter().flat_map(|item| self.without(item));
                vec![Item::Clip {
                    path,
                    items: items.collect(),
                }]
            }
            Item::Path {
                path,
                fill: None,
                stroke: Some(stroke),
            } if stroke.colour.alpha >= PALE => {
                let points = straight(&path.0).unwrap_or_default();
                let gaps = self.crossed(&points);
                match gaps.is_empty() {
                    true => vec![Item::stroked(path, stroke)],
                    false => {
                        let parts = points.windows(2);
                        let parts = parts.flat_map(|ends| without([ends[0], ends[1]], &gaps));
                        pieces(&points, parts, &stroke)
                    }
                }
            }
            other => vec![other],
        }
    }

    /// The labels that a line crosses, with some space around them.
    fn crossed(&self, points: &[[f64; 2]]) -> Vec<Rect> {
        let mut found: Vec<Rect> = Vec::new();
        for ends in points.windows(2) {
            let (low, high) = (ends[0][1].min(ends[1][1]), ends[0][1].max(ends[1][1]));
            // A label in two rows is found twice.
            let near = self.0.range(row(low)..=row(high));
            for label in near.flat_map(|(_, labels)| labels) {
                if label.is_crossed(ends[0], ends[1]) {
                    let gap = widened(*label, AIR);
                    if !found.contains(&gap) {
                        found.push(gap);
                    }
                }
            }
        }
        found
    }
}

/// The row of a height on the page.
fn row(y: f64) -> i32 {
    (y / ROW).clamp(-1e6, 1e6).floor() as i32
}
