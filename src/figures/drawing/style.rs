//! Fills and strokes of paths.

/// A colour of the display (sRGB, 8 bits) with its opacity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colour {
    /// Red, green, blue.
    pub rgb: [u8; 3],
    /// 0 is transparent, 255 opaque.
    pub alpha: u8,
}

impl Colour {
    /// Opaque black.
    pub const BLACK: Colour = Colour::rgb(0, 0, 0);
    /// Opaque white.
    pub const WHITE: Colour = Colour::rgb(255, 255, 255);
    /// No colour at all.
    pub const TRANSPARENT: Colour = Colour {
        rgb: [0; 3],
        alpha: 0,
    };

    /// An opaque colour.
    pub const fn rgb(red: u8, green: u8, blue: u8) -> Colour {
        Colour {
            rgb: [red, green, blue],
            alpha: 255,
        }
    }

    /// The colour with another opacity.
    pub const fn with_alpha(self, alpha: u8) -> Colour {
        Colour { alpha, ..self }
    }
}

/// The inside of a path, by the non-zero rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fill {
    /// The colour of the whole inside, or of the lines of the hatch.
    pub colour: Colour,
    /// Lines instead of a filled interior.
    pub hatch: Option<Hatch>,
}

/// Parallel lines, clipped to the path that they fill.
///
/// One of them passes through the page's origin, so that adjacent areas with the same hatch match.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hatch {
    /// Radians, counter-clockwise on the page from the x axis.
    pub angle: f64,
    /// From line to line, points.
    pub spacing: f64,
    /// Of a line, points.
    pub width: f64,
}

/// A line along a path.
#[derive(Debug, Clone, PartialEq)]
pub struct Stroke {
    /// Its colour. Where a translucent shaft meets its head, both are visible.
    pub colour: Colour,
    /// Its width, points.
    pub width: f64,
    /// Lengths of dashes and gaps in turn, points, from the start of every contour; empty: unbroken.
    pub dash: Vec<f64>,
    /// Its ends, and those of its dashes.
    pub cap: Cap,
    /// Its corners.
    pub join: Join,
    /// An arrowhead with its tip at the start of the path.
    pub start: Option<Arrow>,
    /// An arrowhead with its tip at the end of the path.
    pub end: Option<Arrow>,
}

/// The end of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cap {
    /// Cut at its end.
    Butt,
    /// A half circle beyond its end.
    Round,
    /// Half a square beyond its end.
    Square,
}

/// The corner of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Join {
    /// Pointed, up to twice the width beyond the corner; then cut.
    Miter,
    /// A circle.
    Round,
    /// Cut.
    Bevel,
}

/// A filled arrowhead; its back is notched by a quarter of its length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrow {
    /// From the tip to the barbs, points.
    pub length: f64,
    /// From barb to barb, points.
    pub width: f64,
}

impl Fill {
    /// The whole inside in one colour.
    pub fn solid(colour: Colour) -> Fill {
        Fill {
            colour,
            hatch: None,
        }
    }
}

impl Stroke {
    /// An unbroken line with cut ends and pointed corners.
    pub fn new(colour: Colour, width: f64) -> Stroke {
        Stroke {
            colour,
            width,
            dash: Vec::new(),
            cap: Cap::Butt,
            join: Join::Miter,
            start: None,
            end: None,
        }
    }

    /// The line with dashes and gaps of these lengths in turn.
    pub fn dashed(self, dash: impl Into<Vec<f64>>) -> Stroke {
        Stroke {
            dash: dash.into(),
            ..self
        }
    }

    /// The line with rounded ends and corners.
    pub fn rounded(self) -> Stroke {
        Stroke {
            cap: Cap::Round,
            join: Join::Round,
            ..self
        }
    }

    /// The line with an arrowhead at its end.
    pub fn ending(self, arrow: Arrow) -> Stroke {
        Stroke {
            end: Some(arrow),
            ..self
        }
    }

    /// The line with an arrowhead at its start.
    pub fn starting(self, arrow: Arrow) -> Stroke {
        Stroke {
            start: Some(arrow),
            ..self
        }
    }
}

impl Arrow {
    /// The arrowhead that suits a line of `width` points.
    pub fn of_line(width: f64) -> Arrow {
        // Heads grow less than lines, so that those of thin lines are still visible.
        Arrow {
            length: 3.0 + 4.0 * width,
            width: 2.0 + 3.0 * width,
        }
    }
}
