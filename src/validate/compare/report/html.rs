//! A self-contained HTML page: pictures as data, a few lines of script for zooming, no network.

use std::fmt::Write;

use super::pictures::{ErrorMap, bar_across, displays};
use super::table::{lines, notes, rows};
use crate::error::Result;
use crate::figures::drawing::png::{self, RgbaImage};
use crate::figures::drawing::push_base64;
use crate::figures::page::escaped;
use crate::io::image::RgbImage;
use crate::validate::compare::comparison::Comparison;
use crate::validate::compare::errors::Histogram;
use crate::validate::compare::metrics::{Breach, METRICS, number};
use crate::validate::compare::picture::Picture;

/// Pictures with longer sides are reduced by an integer factor.
const LONGEST: u32 = 1600;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The report as HTML: exceeded limits and diagnoses first.
///
/// # Errors
/// Pictures that cannot be drawn.
pub fn page(
    comparison: &Comparison,
    breaches: &[Breach],
    [reference, candidate]: [&Picture; 2],
    maps: &[ErrorMap],
) -> Result<String> {
    // Names come from files: any text that is not ours is escaped.
    let mut html = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\"><title>{}</title>\n<style>{STYLE}</style></head><body>\n",
        escaped(&format!("{} against {}", candidate.name, reference.name))
    );
    let _ = writeln!(
        html,
        "<h1>{}</h1><p>candidate, against the reference <b>{}</b>; {} of {} × {} pixels</p>",
        escaped(&candidate.name),
        escaped(&reference.name),
        comparison.pixels,
        comparison.size[0],
        comparison.size[1]
    );
    limits(&mut html, breaches);
    findings(&mut html, comparison);
    pictures(&mut html, reference, candidate, maps)?;
    errors(&mut html, comparison);
    histograms(&mut html, comparison);
    let _ = writeln!(html, "<script>{SCRIPT}</script></body></html>");
    Ok(html)
}

fn limits(html: &mut String, breaches: &[Breach]) {
    if breaches.is_empty() {
        return;
    }
    html.push_str("<div class=\"breaches\"><b>Not within tolerance</b><ul>");
    for breach in breaches {
        let _ = write!(html, "<li>{}</li>", escaped(&breach.to_string()));
    }
    html.push_str("</ul></div>\n");
}

fn findings(html: &mut String, comparison: &Comparison) {
    for diagnosis in &comparison.diagnoses {
        let _ = write!(
            html,
            "<div class=\"diagnosis\"><b>{}</b><ul>",
            escaped(&diagnosis.what)
        );
        for (name, value) in &diagnosis.evidence {
            let _ = write!(html, "<li>{}: {}</li>", escaped(name), number(*value));
        }
        html.push_str("</ul></div>\n");
    }
    for note in notes(comparison) {
        let _ = writeln!(html, "<p class=\"note\">{}</p>", escaped(&note));
    }
}

fn pictures(
    html: &mut String,
    reference: &Picture,
    candidate: &Picture,
    maps: &[ErrorMap],
) -> Result<()> {
    let ([expected, actual], channel) = displays(reference, candidate)?;
    html.push_str("<h2>Pictures</h2><p>Wheel: zoom; drag: move; double-click: reset. All pictures move together.</p><div class=\"pictures\">\n");
    figure(html, &format!("expected{channel}"), &reduced(&expected), "")?;
    figure(html, &format!("actual{channel}"), &reduced(&actual), "")?;
    for map in maps {
        figure(html, &map.title, &largest(map).image(), &colour_bar(map)?)?;
    }
    html.push_str("</div>\n");
    Ok(())
}

/// The colours of a map with the values at their ends and middle.
fn colour_bar(map: &ErrorMap) -> Result<String> {
    let mut html = String::from("<img class=\"bar\" alt=\"\" src=\"");
    push_image(&mut html, &bar_across())?;
    let [middle, most] = [0.5 * map.most, map.most].map(number);
    let _ = write!(
        html,
        "\"><div class=\"axis\"><span>0</span><span>{middle}</span><span>{most}</span></div>"
    );
    Ok(html)
}

/// The picture and its caption, with `below` between them.
fn figure(html: &mut String, caption: &str, image: &RgbImage, below: &str) -> Result<()> {
    let caption = escaped(caption);
    let _ = write!(
        html,
        "<figure><div class=\"view\" style=\"aspect-ratio: {} / {}\"><img alt=\"{caption}\" src=\"",
        image.width, image.height
    );
    push_image(html, image)?;
    let _ = writeln!(
        html,
        "\"></div>{below}<figcaption>{caption}</figcaption></figure>"
    );
    Ok(())
}

/// The picture as a data URL of an `img`.
fn push_image(html: &mut String, image: &RgbImage) -> Result<()> {
    let raster = RgbaImage {
        width: image.width,
        height: image.height,
        rgba: image
            .rgb
            .as_chunks::<3>()
            .0
            .iter()
            .flat_map(|[r, g, b]| [*r, *g, *b, 255])
            .collect(),
        scale: 1.0,
        origin: Vec::new(),
    };
    html.push_str("data:image/png;base64,");
    push_base64(html, &png::write(&raster)?);
    Ok(())
}

/// The number of rows and columns that are merged into one.
fn factor(width: u32, height: u32) -> u32 {
    width.max(height).div_ceil(LONGEST).max(1)
}

/// The picture, reduced by averaging blocks of pixels if it is large.
fn reduced(image: &RgbImage) -> RgbImage {
    let k = factor(image.width, image.height);
    let [width, height] = [image.width.div_ceil(k), image.height.div_ceil(k)];
    let mut rgb = Vec::with_capacity(3 * (width * height) as usize);
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        // Sums of red, green and blue, and their number: blocks at the edges are smaller.
        let pixels = block([x, y], k, [image.width, image.height]);
        let mut sums = [0u32; 4];
        for i in pixels {
            for (sum, code) in sums.iter_mut().zip(&image.rgb[3 * i..3 * i + 3]) {
                *sum += u32::from(*code);
            }
            sums[3] += 1;
        }
        rgb.extend([0, 1, 2].map(|c| (sums[c] / sums[3].max(1)) as u8));
    }
    RgbImage { width, height, rgb }
}

/// The map, reduced to the largest error of each block if it is large, so that no error is lost.
fn largest(map: &ErrorMap) -> ErrorMap {
    let k = factor(map.width, map.height);
    let [width, height] = [map.width.div_ceil(k), map.height.div_ceil(k)];
    let places = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    let errors = places.map(|place| {
        let pixels = block(place, k, [map.width, map.height]);
        // `max` ignores NaN, which marks pixels without an error: a block of only NaN stays NaN.
        pixels.map(|i| map.errors[i]).fold(f32::NAN, f32::max)
    });
    ErrorMap {
        width,
        height,
        errors: errors.collect(),
        ..map.clone()
    }
}

/// The pixels of a block.
fn block([x, y]: [u32; 2], k: u32, [width, height]: [u32; 2]) -> impl Iterator<Item = usize> {
    let rows = y * k..(y * k + k).min(height);
    let columns = x * k..(x * k + k).min(width);
    rows.flat_map(move |y| {
        columns
            .clone()
            .map(move |x| y as usize * width as usize + x as usize)
    })
}

/// The table of errors by channel, with the errors of the whole picture below it.
fn errors(html: &mut String, comparison: &Comparison) {
    html.push_str("<h2>Errors</h2>\n<div class=\"wide\"><table><tr><th></th>");
    let rows = rows(comparison);
    let first = rows.first();
    // Headings from the cells of the first row: whether a metric has a cell does not depend on values.
    for (heading, _) in first
        .into_iter()
        .flat_map(|(_, e)| METRICS.iter().filter_map(|m| m.cell(*e)))
    {
        let _ = write!(html, "<th>{heading}</th>");
    }
    html.push_str("</tr>\n");
    for (name, errors) in rows {
        let _ = write!(html, "<tr><th>{}</th>", escaped(name));
        for (_, value) in METRICS.iter().filter_map(|m| m.cell(errors)) {
            let _ = write!(html, "<td>{value}</td>");
        }
        html.push_str("</tr>\n");
    }
    html.push_str("</table></div>\n<table class=\"words\">");
    if let Some(flip) = &comparison.flip {
        let _ = write!(
            html,
            "<tr><th>ꟻLIP</th><td>mean {}, largest {}</td></tr>",
            number(flip.mean),
            number(flip.max)
        );
    }
    for (name, value) in lines(comparison) {
        let _ = write!(html, "<tr><th>{name}</th><td>{value}</td></tr>");
    }
    html.push_str("</table>\n");
}

fn histograms(html: &mut String, comparison: &Comparison) {
    html.push_str("<h2>Histograms</h2><p>Pixels by the size of their error, in quarters of octaves.</p><div class=\"pictures\">\n");
    let surface = comparison.surface.as_ref();
    let geometric = surface
        .and_then(|s| s.geometric.as_ref())
        .map(|d| ("geometric error (pixels)", &d.histogram));
    let errors = rows(comparison)
        .into_iter()
        .filter_map(|(name, errors)| Some((name, &errors?.histogram)));
    for (name, histogram) in geometric.into_iter().chain(errors) {
        bars(html, name, histogram);
    }
    html.push_str("</div>\n");
}

/// A histogram as SVG, with the ends of its axis and the number of errors that are exactly 0.
fn bars(html: &mut String, name: &str, histogram: &Histogram) {
    let Some(((low, _), (high, _))) = histogram.bins.first().zip(histogram.bins.last()) else {
        let _ = writeln!(
            html,
            "<figure><figcaption>{}: {} errors, all 0</figcaption></figure>",
            escaped(name),
            histogram.zeros
        );
        return;
    };
    // The highest bar fills the 100 units of the drawing's height, and all bars its width of 300.
    let most = histogram
        .bins
        .iter()
        .map(|bin| bin.1)
        .max()
        .unwrap_or(1)
        .max(1) as f64;
    let width = 300.0 / histogram.bins.len() as f64;
    html.push_str("<figure><svg viewBox=\"0 0 300 100\" preserveAspectRatio=\"none\">");
    for (i, (_, count)) in histogram.bins.iter().enumerate() {
        let height = 100.0 * *count as f64 / most;
        let _ = write!(
            html,
            "<rect x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\"/>",
            i as f64 * width,
            100.0 - height,
            0.9 * width,
            height
        );
    }
    let _ = writeln!(
        html,
        "</svg><div class=\"axis\"><span>{}</span><span>{}</span></div><figcaption>{}; exactly 0: {}</figcaption></figure>",
        number(*low),
        number(*high),
        escaped(name),
        histogram.zeros
    );
}
