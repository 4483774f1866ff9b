//! The picture with its lines, as a page.

use super::label::Labels;
use super::legend;
use super::name::Regions;
use super::style::{self, APPARENT, HEAVY, INSTANTANEOUS, ISOCHRONE, POINTER, Pen, RADIUS};
use super::{Isochrones, Outline, Overlay, Part, Parts, Pointer, Polyline, Target};
use crate::error::{Error, Result};
use crate::figures::drawing::{Colour, Drawing, Item, Path};
use crate::figures::isochrones::lines::path_of;
use crate::io::image::RgbImage;
use crate::text::{Rect, RichText};

/// Points per em of the names of objects.
const NAME: f64 = 6.5;
/// Free space between them and outlines, points.
const BESIDE: f64 = 2.5;
/// The picture's longer side, points.
const SIDE: f64 = 480.0;
/// The least width of a page with a legend, points.
const LEAST_WIDTH: f64 = 240.0;
/// The longer side of the picture in a PNG, pixels, unless it has more.
const PIXELS: f64 = 1200.0;

/// Pixels per point at which a PNG of a picture of this size shows each of its pixels as a square of
/// whole pixels, at least 1200 of them along its longer side.
pub fn png_scale(size: [u32; 2]) -> f64 {
    let side = f64::from(size[0].max(size[1]).max(1));
    (PIXELS / side).ceil().max(1.0) * side / SIDE
}

/// Bytes that pictures of `size` with overlays take beside the picture: the films on which the lines are traced, and the largest page,
/// which is drawn and encoded.
pub fn bytes(size: [u32; 2], parts: Parts) -> u64 {
    let pixels = u64::from(size[0]) * u64::from(size[1]);
    // Radiance and the channels, f64, as a film and as the channels of one.
    let apparent = match parts.needs().len() as u64 {
        0 => 0,
        channels => 2 * (24 + 8 * channels),
    };
    let instantaneous = if parts.has(Part::Outlines) {
        // Identities of both, and where names have room.
        2 * (24 + 8) + 12
    } else {
        0
    };
    let squares = png_scale(size) * SIDE / f64::from(size[0].max(size[1]).max(1));
    // Of each pixel of the page RGBA, and RGB on its way into the file.
    let page = (7.0 * squares * squares) as u64;
    pixels.saturating_mul(apparent + instantaneous + 3 + page)
}

impl Overlay {
    /// The page: `picture`, the lines over it, the legend below it.
    ///
    /// # Errors
    /// A picture of another size than the film.
    pub fn drawing(&self, title: &str, picture: RgbImage) -> Result<Drawing> {
        if [picture.width, picture.height] != self.size || self.size.contains(&0) {
            let what = format!(
                "a picture of {} × {} pixels for a film of {} × {}",
                picture.width, picture.height, self.size[0], self.size[1]
            );
            return Err(Error::invalid(
                "overlay",
                "picture",
                what,
                "the film's own size",
            ));
        }
        let place = Place::new(self.size);
        let rect = Rect {
            min: [0.0; 2],
            max: place.size,
        };
        let mut items = vec![Item::Image {
            image: picture,
            rect,
        }];
        items.push(Item::Clip {
            path: Path::rect(rect),
            items: self.lines(&place)?,
        });
        let (mut width, mut height) = (place.size[0], place.size[1]);
        if let Some(facts) = &self.legend {
            width = width.max(LEAST_WIDTH);
            let legend = legend::lay_out(self, facts, [width, height], place.scale)?;
            items.extend(legend.items);
            height += legend.height;
        }
        Ok(Drawing {
            width,
            height,
            title: title.to_owned(),
            origin: Vec::new(),
            background: Colour::WHITE,
            items,
        })
    }

    /// The lines over the picture.
    fn lines(&self, place: &Place) -> Result<Vec<Item>> {
        let mut items = Vec::new();
        let mut labels = Labels::new(place.size);
        let mut texts = Vec::new();
        let isochrones = self.isochrones.iter().flat_map(|all| &all.lines);
        let outlines = self.instantaneous.iter().chain(&self.apparent);
        let all = isochrones.flat_map(|line| &line.lines);
        for line in all.chain(outlines.flat_map(|outline| &outline.lines)) {
            labels.keep_off_line(place.line(line));
        }
        let mut pointed_at = Vec::new();
        if let Some(pointer) = &self.pointer {
            pointed_at = pointed(place, pointer, &mut labels)?;
            labels.keep_off(place.pointed_at(pointer.target), 3.5 * RADIUS);
        }
        if let Some(isochrones) = &self.isochrones {
            texts = labelled(place, isochrones, &mut labels)?;
        }
        texts.extend(self.named(place, &mut labels)?);
        // All lines are interrupted at labels.
        let drawn = |pen: Pen, lines: Vec<&Polyline>| {
            let lines = lines.into_iter().map(|line| place.line(line));
            let parts: Vec<Polyline> = lines.flat_map(|line| labels.beside(&line)).collect();
            pen.draw(path_of(&parts, |point| point))
        };
        if let Some(isochrones) = &self.isochrones {
            for (pen, heavy) in [(ISOCHRONE, false), (HEAVY, true)] {
                let lines = isochrones.lines.iter().filter(|l| l.is_heavy == heavy);
                items.extend(drawn(pen, lines.flat_map(|l| &l.lines).collect()));
            }
        }
        for (pen, outlines) in [
            (INSTANTANEOUS, &self.instantaneous),
            (APPARENT, &self.apparent),
        ] {
            let lines = outlines.iter().flat_map(|outline| &outline.lines);
            items.extend(drawn(pen, lines.collect()));
        }
        items.extend(texts);
        items.extend(pointed_at);
        Ok(items)
    }
}

impl Overlay {
    /// The names of objects, at their positions, or at their apparent positions if they are out of view.
    fn named(&self, place: &Place, labels: &mut Labels) -> Result<Vec<Item>> {
        let is_there = |outline: &&Outline| {
            let mut there = self.instantaneous.iter();
            there.any(|there| there.object == outline.object)
        };
        let there = self.instantaneous.iter().collect();
        let left = self.apparent.iter().filter(|seen| !is_there(seen));
        let mut items = Vec::new();
        for (outlines, objects, pen) in [
            (there, &self.objects_there, INSTANTANEOUS),
            (left.collect::<Vec<_>>(), &self.objects_seen, APPARENT),
        ] {
            let Some(regions) = Regions::new(self.size, objects) else {
                continue;
            };
            for outline in outlines {
                let name = self.names.get(outline.object);
                // Names that cannot be set are omitted.
                let Some(name) = name.and_then(|name| RichText::plain(name).ok()) else {
                    continue;
                };
                let size = [name.width(NAME)?, NAME];
                let at = spot(place, outline, &regions, size, labels);
                let label = at.map(|at| style::label(name, at, pen.colour, NAME));
                items.extend(label.map(Item::Text));
            }
        }
        Ok(items)
    }
}

/// The position of a name of this size, points: within the visible part of its object, or beside it if there is no room.
fn spot(
    place: &Place,
    outline: &Outline,
    regions: &Regions,
    size: [f64; 2],
    labels: &mut Labels,
) -> Option<[f64; 2]> {
    // With the dashes of its outline all around.
    let room = size.map(|side| (side + 2.0 * BESIDE) / place.scale);
    let within = regions.places(outline.object, room).into_iter();
    let within: Vec<[f64; 2]> = within.map(place.point()).collect();
    let beside = || around(place, outline, size);
    labels
        .level(&within, size)
        .or_else(|| labels.level(&beside(), size))
}

/// Positions for a name of this size, points, above, below and on both sides of an object; empty if that is much smaller.
fn around(place: &Place, outline: &Outline, [width, height]: [f64; 2]) -> Vec<[f64; 2]> {
    let points = outline.lines.iter().flatten().copied().map(place.point());
    let Some(Rect { min, max }) = Rect::around(points) else {
        return Vec::new();
    };
    let reach = (max[0] - min[0]) + (max[1] - min[1]);
    if reach < width {
        return Vec::new();
    }
    let middle = [0, 1].map(|i| 0.5 * (min[i] + max[i]));
    let [aside, up] = [0.5 * width + BESIDE, 0.5 * height + BESIDE];
    vec![
        [middle[0], min[1] - up],
        [middle[0], max[1] + up],
        [max[0] + aside, middle[1]],
        [min[0] - aside, middle[1]],
    ]
}

/// From pixels of the film to the page.
pub(super) struct Place {
    /// Points per pixel.
    pub scale: f64,
    /// Of the picture, points.
    pub size: [f64; 2],
}

impl Place {
    fn new(size: [u32; 2]) -> Place {
        let scale = SIDE / f64::from(size[0].max(size[1]));
        Place {
            scale,
            size: size.map(|side| scale * f64::from(side)),
        }
    }

    /// The position of the velocity's symbol.
    fn pointed_at(&self, target: Target) -> [f64; 2] {
        match target {
            Target::Ahead(at) | Target::Behind(at) => at.map(|x| x * self.scale),
            Target::Outside(way) => arrow_tip(self, way),
        }
    }

    fn point(&self) -> impl Fn([f64; 2]) -> [f64; 2] {
        |p| p.map(|x| x * self.scale)
    }

    fn line(&self, line: &Polyline) -> Polyline {
        line.iter().copied().map(self.point()).collect()
    }
}

/// The labels of isochrones, those of heavy lines first.
fn labelled(place: &Place, isochrones: &Isochrones, labels: &mut Labels) -> Result<Vec<Item>> {
    let (heavy, light): (Vec<_>, Vec<_>) = isochrones.lines.iter().partition(|l| l.is_heavy);
    let mut texts = Vec::new();
    for isochrone in heavy.into_iter().chain(light) {
        for line in &isochrone.lines {
            let text = RichText::plain(&isochrone.label)?;
            let label = labels.along(&place.line(line), text, HEAVY.colour)?;
            texts.extend(label.map(Item::Text));
        }
    }
    Ok(texts)
}

/// ⊗, ⊙ or an arrow, and the speed beside it.
fn pointed(place: &Place, pointer: &Pointer, labels: &mut Labels) -> Result<Vec<Item>> {
    let mut items = Vec::new();
    let at = place.pointed_at(pointer.target);
    items.extend(style::symbol(pointer.target, at));
    let text = style::speed(pointer.velocity)?;
    let (size, width) = (8.5, text.width(8.5)?);
    // Behind the arrow, or above the sign first.
    let places: Vec<[f64; 2]> = match pointer.target {
        Target::Outside([x, y]) => {
            // Behind the shaft of 24 points.
            let first = 34.0 + 0.5 * width * x.abs();
            let backs = (0..12).map(|k| first + 10.0 * f64::from(k));
            backs.map(|back| [-back * x, -back * y]).collect()
        }
        Target::Ahead(_) | Target::Behind(_) => {
            let (up, aside) = (RADIUS + 7.0, RADIUS + 5.0 + 0.5 * width);
            vec![[0.0, -up], [0.0, up], [aside, 0.0], [-aside, 0.0]]
        }
    };
    let places = places.iter().map(|[x, y]| {
        [
            // Half of the text and its halo stay on the page.
            kept(at[0] + x, 0.5 * width + 4.0, place.size[0]),
            kept(at[1] + y, 7.0, place.size[1]),
        ]
    });
    let places: Vec<[f64; 2]> = places.collect();
    let beside = labels.level(&places, [width, size]);
    let label = beside.map(|beside| style::label(text, beside, POINTER.colour, size));
    items.extend(label.map(Item::Text));
    Ok(items)
}

/// `x`, but at least `margin` from 0 and from `end`.
fn kept(x: f64, margin: f64, end: f64) -> f64 {
    x.min(end - margin).max(margin)
}

/// Where an arrow at the edge ends.
fn arrow_tip(place: &Place, way: [f64; 2]) -> [f64; 2] {
    let middle = place.size.map(|side| 0.5 * side);
    let reach = [0, 1].map(|i| match way[i] == 0.0 {
        true => f64::INFINITY,
        // Room for the head and its border.
        false => (middle[i] - 6.0).max(0.0) / way[i].abs(),
    });
    let far = reach[0].min(reach[1]);
    [0, 1].map(|i| middle[i] + far * way[i])
}
