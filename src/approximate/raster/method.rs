//! The rendering method, and its text form: "raster:uniform=0.05,attributes=vertex".

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result, Setting};

/// The rendering method.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Method {
    /// Ray tracing: the reference.
    #[default]
    Trace,
    /// Vertices are moved to their apparent positions, and the triangles between them are rasterized.
    Raster(Raster),
    /// Each look direction is looked up in a picture taken from the same event at rest.
    Warp(Warp),
}

/// How triangles are rasterized.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Raster {
    /// How they are divided first.
    pub tessellation: Tessellation,
    /// Where times and wavelength ratios are computed.
    pub attributes: Attributes,
}

/// How triangles are divided, so that straight lines between vertices are close enough to curves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tessellation {
    /// Not at all.
    None,
    /// Until no edge is longer than this, metres in its rest frame.
    Uniform(f64),
    /// Until no point is drawn farther from its true film point than this, pixels, by the curvature of edges.
    Adaptive(f64),
}

/// Where times and wavelength ratios are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Attributes {
    /// At vertices: interpolated between them.
    Vertex,
    /// At each sample, for its own point of the surface.
    #[default]
    Fragment,
}

/// How a picture is warped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Warp {
    /// The form of the picture at rest.
    pub map: Map,
    /// How it is looked up.
    pub lookup: Lookup,
}

/// A picture of all directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Map {
    /// Six squares with this many texels per side.
    Cube(u32),
    /// Longitude and latitude: columns and rows.
    Panorama([u32; 2]),
}

/// Reconstruction between texels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Lookup {
    /// That of the nearest texel.
    Nearest,
    /// Of the four around it, by distance.
    #[default]
    Bilinear,
}

/// The largest number of texels of a map.
pub const MOST_TEXELS: u64 = 1 << 26;
/// The most columns or rows: products of two are far below 2⁶⁴.
const MOST_SIDE: u32 = 65_536;

const FORMS: &str = "write trace, raster:none, raster:uniform=0.05 (metres), raster:adaptive=0.5 (pixels), \
                     warp:cube=1024 or warp:panorama=2048x1024";

impl FromStr for Method {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // KIND:WAY[=VALUE][,OPTION]…
        let (kind, rest) = text.split_once(':').unwrap_or((text, ""));
        let mut words = rest.split(',').map(str::trim);
        let first = words.next().unwrap_or("");
        let method = match kind.trim() {
            "trace" if rest.is_empty() => Ok(Method::Trace),
            "raster" => raster(first),
            "warp" => warp(first),
            _ => Err(format!("\"{text}\" is not a method; {FORMS}")),
        }?;
        words.try_fold(method, Method::with)
    }
}

fn raster(text: &str) -> Result<Method, String> {
    let (name, value) = text.split_once('=').unwrap_or((text, ""));
    let tessellation = match name.trim() {
        "none" if value.is_empty() => Tessellation::None,
        "uniform" => Tessellation::Uniform(positive(value, "uniform", "an edge length in metres")?),
        "adaptive" => Tessellation::Adaptive(positive(value, "adaptive", "an error in pixels")?),
        _ => return Err(format!("\"raster:{text}\" is not a method; {FORMS}")),
    };
    Ok(Method::Raster(Raster {
        tessellation,
        attributes: Attributes::default(),
    }))
}

fn positive(text: &str, key: &str, what: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok();
    number
        .filter(|x| is_usable(*x))
        .ok_or_else(|| format!("{key}={text}: give {what}, a number from 1e-9 to 1e9"))
}

/// Whether triangles can be divided by this length or error; not by NaN, which is in no range.
fn is_usable(x: f64) -> bool {
    (1e-9..=1e9).contains(&x)
}

fn warp(text: &str) -> Result<Method, String> {
    let (name, value) = text.split_once('=').unwrap_or((text, ""));
    let map = match name.trim() {
        "cube" => Map::Cube(texels(value, name)?),
        "panorama" => {
            let (columns, rows) = value.split_once('x').unwrap_or((value, ""));
            Map::Panorama([texels(columns, name)?, texels(rows, name)?])
        }
        _ => return Err(format!("\"warp:{text}\" is not a method; {FORMS}")),
    };
    if map.texels() > MOST_TEXELS {
        let all = map.texels();
        return Err(format!(
            "{text}: a map of {all} texels is more than the {MOST_TEXELS} that are kept; give a smaller one"
        ));
    }
    Ok(Method::Warp(Warp {
        map,
        lookup: Lookup::default(),
    }))
}

fn texels(text: &str, key: &str) -> Result<u32, String> {
    let number = text.trim().parse::<u32>().ok();
    let number = number.filter(|n| (1..=MOST_SIDE).contains(n));
    number.ok_or_else(|| {
        format!(
            "{key}={text}: give the size in texels, like cube=1024 or panorama=2048x1024, up to 65536"
        )
    })
}

impl Method {
    /// Refuses what [`Method::from_str`] would not read.
    ///
    /// # Errors
    /// Triangles divided by a length or an error that is not from 10⁻⁹ to 10⁹, maps without texels or with more than [`MOST_TEXELS`].
    pub(super) fn check_numbers(&self) -> Result<()> {
        let refuse =
            |what: String, help| Err(Error::invalid("method", self.to_string(), what, help));
        match self {
            Method::Raster(Raster {
                tessellation: Tessellation::Uniform(x) | Tessellation::Adaptive(x),
                ..
            }) if !is_usable(*x) => refuse(
                format!("triangles cannot be divided by {x}"),
                "a number from 1e-9 to 1e9",
            ),
            Method::Warp(Warp { map, .. }) => {
                let sides = match *map {
                    Map::Cube(side) => [side, side],
                    Map::Panorama(sides) => sides,
                };
                let fits = sides.iter().all(|n| (1..=MOST_SIDE).contains(n));
                if fits && map.texels() <= MOST_TEXELS {
                    return Ok(());
                }
                refuse(
                    format!("a map of {} × {} texels cannot be kept", sides[0], sides[1]),
                    "sides from 1 to 65536, with 2²⁶ texels in all at most",
                )
            }
            Method::Trace | Method::Raster(_) => Ok(()),
        }
    }
}

impl Map {
    /// The number of texels.
    pub fn texels(self) -> u64 {
        match self {
            Map::Cube(side) => 6 * u64::from(side) * u64::from(side),
            Map::Panorama([columns, rows]) => u64::from(columns) * u64::from(rows),
        }
    }
}

impl Method {
    /// The same with the option `text`.
    fn with(self, text: &str) -> Result<Method, String> {
        match (self, text) {
            (Method::Raster(raster), "attributes=vertex") => {
                Ok(Method::Raster(raster.with(Attributes::Vertex)))
            }
            (Method::Raster(raster), "attributes=fragment") => {
                Ok(Method::Raster(raster.with(Attributes::Fragment)))
            }
            (Method::Warp(warp), "lookup=nearest") => Ok(Method::Warp(warp.with(Lookup::Nearest))),
            (Method::Warp(warp), "lookup=bilinear") => {
                Ok(Method::Warp(warp.with(Lookup::Bilinear)))
            }
            _ => Err(format!(
                "\"{text}\" is not an option; raster has attributes=vertex or attributes=fragment, warp has \
                 lookup=nearest or lookup=bilinear"
            )),
        }
    }
}

impl Raster {
    /// Divided by `tessellation`; all else by its default.
    pub fn new(tessellation: Tessellation) -> Self {
        Raster {
            tessellation,
            attributes: Attributes::default(),
        }
    }

    /// The same with times and ratios computed by `attributes`.
    pub fn with(self, attributes: Attributes) -> Self {
        Raster { attributes, ..self }
    }
}

impl Warp {
    fn with(self, lookup: Lookup) -> Self {
        Warp { lookup, ..self }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Method::Trace => write!(f, "trace"),
            Method::Raster(raster) => {
                match raster.tessellation {
                    Tessellation::None => write!(f, "raster:none")?,
                    Tessellation::Uniform(length) => write!(f, "raster:uniform={length}")?,
                    Tessellation::Adaptive(pixels) => write!(f, "raster:adaptive={pixels}")?,
                }
                match raster.attributes {
                    Attributes::Vertex => write!(f, ",attributes=vertex"),
                    Attributes::Fragment => Ok(()),
                }
            }
            Method::Warp(warp) => {
                match warp.map {
                    Map::Cube(side) => write!(f, "warp:cube={side}")?,
                    Map::Panorama([columns, rows]) => write!(f, "warp:panorama={columns}x{rows}")?,
                }
                match warp.lookup {
                    Lookup::Nearest => write!(f, ",lookup=nearest"),
                    Lookup::Bilinear => Ok(()),
                }
            }
        }
    }
}

pub(super) fn moves(scene: &str, object: &str) -> Error {
    Error::unsupported(
        scene,
        "object.velocity",
        format!("a warped picture needs objects at rest in the world, but {object} moves"),
        Setting::TraceIt + ", or rasterize it, or let the camera move in place of the object",
    )
}

pub(super) fn samples_spectra(scene: &str) -> Error {
    Error::unsupported(
        scene,
        "render.spectra",
        "this method has no samples with wavelengths of their own",
        Setting::TraceIt + ", or leave `spectra` out",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_are_said_as_they_are_read() {
        for text in [
            "trace",
            "raster:none",
            "raster:uniform=0.05",
            "raster:adaptive=0.5,attributes=vertex",
            "warp:cube=1024",
            "warp:panorama=2048x1024,lookup=nearest",
        ] {
            assert_eq!(text.parse::<Method>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn what_is_no_method_is_refused_with_what_would_be_one() {
        for (text, part) in [
            ("ray", "raster:uniform"),
            ("raster", "raster:none"),
            ("raster:uniform", "metres"),
            ("raster:uniform=-1", "metres"),
            ("raster:uniform=nan", "metres"),
            ("raster:adaptive=1e-300", "pixels"),
            ("raster:none=3", "raster:none"),
            ("raster:none,lookup=nearest", "attributes=vertex"),
            ("warp:cube=0", "cube=1024"),
            ("warp:cube=65536", "texels"),
            ("warp:panorama=2048", "2048x1024"),
            ("warp:cube=64,attributes=vertex", "lookup=nearest"),
            ("trace,attributes=vertex", "not a method"),
        ] {
            let error = text.parse::<Method>().unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
