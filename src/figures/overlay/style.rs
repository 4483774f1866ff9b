//! Colours and lines. Every line has a dark border, so that it is legible on dark and on bright ground.

use super::pointer::Target;
use crate::error::Result;
use crate::figures::diagram::number;
use crate::figures::drawing::{Anchor, Arrow, Cap, Colour, Item, Join, Path, Stroke, Text};
use crate::text::RichText;

/// The radius of ⊗ and ⊙, points.
pub(super) const RADIUS: f64 = 5.0;
/// Borders of lines and labels on the picture.
const DARK: Colour = Colour::rgb(18, 18, 24);

/// The look of a kind of line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pen {
    pub colour: Colour,
    /// Points.
    pub width: f64,
    /// Width of its border, points.
    pub border: f64,
    pub is_dashed: bool,
}

/// Where objects are seen.
pub(super) const APPARENT: Pen = pen(Colour::rgb(255, 205, 60), 1.0, 0.5, false);
/// Where objects are.
pub(super) const INSTANTANEOUS: Pen = pen(Colour::rgb(95, 215, 255), 1.0, 0.5, true);
/// Lines of equal retarded time.
pub(super) const ISOCHRONE: Pen = pen(Colour::WHITE, 0.5, 0.3, false);
/// One of every five of them.
pub(super) const HEAVY: Pen = pen(Colour::WHITE, 1.0, 0.4, false);
/// The camera's velocity, and the angle to scale.
pub(super) const POINTER: Pen = pen(Colour::rgb(255, 130, 165), 1.2, 0.5, false);

const fn pen(colour: Colour, width: f64, border: f64, is_dashed: bool) -> Pen {
    Pen {
        colour,
        width,
        border,
        is_dashed,
    }
}

impl Pen {
    /// The line along `path` with its border.
    pub fn draw(self, path: Path) -> [Item; 2] {
        self.draw_ending(path, None)
    }

    /// The line with an arrowhead at its end.
    pub fn draw_arrow(self, path: Path) -> [Item; 2] {
        self.draw_ending(path, Some(Arrow::of_line(1.4 * self.width)))
    }

    /// A line over its dark border, which keeps it visible on any picture.
    fn draw_ending(self, path: Path, end: Option<Arrow>) -> [Item; 2] {
        let line = Stroke {
            dash: if self.is_dashed {
                vec![4.5, 3.0]
            } else {
                Vec::new()
            },
            cap: if self.is_dashed {
                Cap::Butt
            } else {
                Cap::Round
            },
            join: Join::Round,
            end,
            ..Stroke::new(self.colour, self.width)
        };
        let wider = |arrow: Arrow| Arrow {
            length: arrow.length + 2.0 * self.border,
            width: arrow.width + 3.0 * self.border,
        };
        let border = Stroke {
            // Shaft and head of an arrow overlap, which would show unless they are opaque.
            colour: DARK.with_alpha(if end.is_some() { 255 } else { 170 }),
            width: self.width + 2.0 * self.border,
            end: end.map(wider),
            ..line.clone()
        };
        let border = Item::Path {
            path: path.clone(),
            fill: None,
            stroke: Some(border),
        };
        [border, Item::stroked(path, line)]
    }
}

/// The sign of a velocity, at its middle or, for an arrow, at its tip.
pub(super) fn symbol(target: Target, at: [f64; 2]) -> Vec<Item> {
    let ring = Path::circle(at, RADIUS);
    let by = |x: f64, y: f64| [at[0] + x, at[1] + y];
    match target {
        Target::Ahead(_) => {
            let k = RADIUS * std::f64::consts::FRAC_1_SQRT_2;
            let cross = Path::line(by(-k, -k), by(k, k)).and(Path::line(by(-k, k), by(k, -k)));
            POINTER.draw(ring.and(cross)).into()
        }
        Target::Behind(_) => {
            let mut items: Vec<Item> = POINTER.draw(ring).into();
            // The dot of ⊙.
            items.extend(POINTER.draw(Path::circle(at, 0.7)));
            items
        }
        Target::Outside([x, y]) => POINTER
            .draw_arrow(Path::line(by(-24.0 * x, -24.0 * y), at))
            .into(),
    }
}

/// A line of text on the picture: in the colour of its line, with a dark border.
pub(super) fn label(text: RichText, at: [f64; 2], colour: Colour, size: f64) -> Text {
    Text {
        colour,
        anchor: Anchor::MIDDLE,
        halo: Some((DARK, 1.1)),
        ..Text::new(text, at, size)
    }
}

/// β with enough digits to distinguish it from 1: "*β* = 0.9"; or γ if that takes too many.
pub(super) fn speed(velocity: crate::spacetime::Velocity) -> Result<RichText> {
    let (beta, gamma) = (velocity.beta().length(), velocity.gamma());
    let told = |decimals: &usize| {
        let rounded =
            (beta * libm::pow(10.0, *decimals as f64)).round() / libm::pow(10.0, *decimals as f64);
        // To 1 % of β and of 1 − β, whichever is less.
        rounded < 1.0 && (rounded - beta).abs() <= 0.01 * beta.min(1.0 - beta)
    };
    match (1..=8).find(told) {
        Some(decimals) => RichText::parse(&format!("*β* = {beta:.decimals$}")),
        None if beta < 0.5 => RichText::parse("*β* < 10^{-8}"),
        None => RichText::parse(&format!("*γ* = {}", number(gamma))),
    }
}
