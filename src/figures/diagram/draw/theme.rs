//! Colours and lines: the palette of Okabe and Ito (2008), which people of any colour vision can distinguish; in grey, line patterns do.

use crate::figures::diagram::model::{Colour as Name, Style};
use crate::figures::drawing::{Cap, Colour, Stroke};

/// The default colours of world lines, and of frames other than the view's own.
const LINES: [Name; 5] = [Name::Blue, Name::Red, Name::Green, Name::Purple, Name::Sky];
const FRAMES: [Name; 4] = [Name::Red, Name::Green, Name::Purple, Name::Sky];

/// Colours and widths of a diagram.
pub(super) struct Theme {
    pub dark: bool,
    pub background: Colour,
    pub ink: Colour,
    pub light: Colour,
    /// Width of world lines, points; all other widths follow from it.
    pub width: f64,
    /// Size of the type, points.
    pub size: f64,
    /// Opacity of shaded areas, of 255.
    pub shade: u8,
    /// Whether world lines have patterns, so that a legend can be read in grey.
    pub patterns: bool,
}

impl Theme {
    pub fn new(style: &Style) -> Theme {
        let (background, ink) = match style.dark {
            true => (Colour::rgb(16, 18, 22), Colour::rgb(235, 235, 230)),
            false => (Colour::WHITE, Colour::rgb(20, 20, 20)),
        };
        Theme {
            dark: style.dark,
            background,
            ink,
            light: hue(Name::Orange, style.dark).unwrap_or(ink),
            shade: if style.dark { 60 } else { 36 },
            width: style.line_width,
            size: style.font_size,
            patterns: style.legend,
        }
    }

    /// A colour of the palette; those that are dark on white are lighter on black.
    pub fn colour(&self, name: Name) -> Colour {
        hue(name, self.dark).unwrap_or(self.ink)
    }

    /// The colour of the i-th world line.
    pub fn of_line(&self, i: usize, said: Option<Name>) -> Colour {
        self.colour(said.unwrap_or(LINES[i % LINES.len()]))
    }

    /// The colour of a frame; the view's own is that of the ink.
    pub fn of_frame(&self, i: usize, own: bool, said: Option<Name>) -> Colour {
        let other = FRAMES[(i + FRAMES.len() - 1) % FRAMES.len()];
        let other = if i == 0 { Name::Grey } else { other };
        let default = if own { Name::Black } else { other };
        self.colour(said.unwrap_or(default))
    }

    /// The stroke of the i-th world line.
    pub fn world_line(&self, i: usize, colour: Colour) -> Stroke {
        let stroke = Stroke::new(colour, self.width).rounded();
        // Solid, dashed, dash-dotted, dotted: distinguishable without colours.
        let pattern: &[f64] = match i % 4 {
            _ if !self.patterns => &[],
            0 => &[],
            1 => &[6.0, 2.5],
            2 => &[8.0, 2.5, 1.5, 2.5],
            _ => &[2.0, 2.2],
        };
        match pattern.is_empty() {
            true => stroke,
            false => Stroke {
                cap: Cap::Butt,
                ..stroke.dashed(pattern)
            },
        }
    }

    /// A thin line.
    pub fn thin(&self, colour: Colour) -> Stroke {
        Stroke::new(colour, 0.5 * self.width)
    }
}

/// A colour of the palette on white or on black; `None` for the ink's colour.
fn hue(name: Name, dark: bool) -> Option<Colour> {
    let (on_white, on_black) = match name {
        Name::Black => return None,
        Name::Rgb(rgb) => (rgb, rgb),
        Name::Grey => ([120, 120, 120], [150, 150, 150]),
        Name::Blue => ([0, 114, 178], [86, 160, 220]),
        Name::Red => ([213, 94, 0], [240, 125, 50]),
        Name::Green => ([0, 158, 115], [40, 190, 145]),
        Name::Orange => ([217, 142, 0], [240, 175, 30]),
        Name::Sky => ([50, 150, 208], [110, 195, 240]),
        Name::Purple => ([180, 90, 145], [215, 140, 185]),
    };
    let [r, g, b] = if dark { on_black } else { on_white };
    Some(Colour::rgb(r, g, b))
}
