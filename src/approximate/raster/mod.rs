//! Reference rasterizers: what others do in place of tracing rays, for validation and for teaching.
//!
//! | method | geometry | what is exact |
//! |---|---|---|
//! | `raster` | vertices are moved to their apparent positions, flat triangles between them are rasterized (`divide`) | vertices |
//! | `warp` | each look direction is looked up in a picture taken from the same event at rest | geometry, as far as texels are small |
//!
//! Radiance, channels, sample positions and film are those of the ray tracer: only geometry and visibility
//! are approximated, so that two films differ by nothing else.
//!
//! *Vertices* (Weiskopf 2001; Müller & Boblest 2014): see [`apparent`](crate::approximate::projection). A rasterizer joins
//! apparent positions by straight edges and flat triangles in the camera's frame, where true edges are
//! curved; triangles are divided into smaller ones to bring the two together (`divide`). What is seen at
//! a film point p = (x, y, 1) is decided by homogeneous edge functions (Olano & Greer, "Triangle scan
//! conversion using 2D homogeneous coordinates", 1997): with corners hᵢ = (xz, yz, z),
//!
//! ```text
//! eᵢ = hⱼ × hₖ,   D = h₀·e₀,   inside: all eᵢ·p of the sign of D,   1/z = Σ eᵢ·p / D,   λᵢ = eᵢ·p / Σ eⱼ·p,
//! ```
//!
//! which needs no clipping where a triangle passes beside or behind the camera. λ are the barycentric
//! weights on the *flat apparent triangle* (perspective-correct interpolation). With them the place X on
//! the surface is interpolated, linearly in its rest frame, and texture coordinates with it. The nearest z
//! is seen; at edges that triangles share both are, and the first in the order of the tree is taken.
//!
//! *Attributes.* By fragment, time and place of emission are those of X itself, whose world line meets the
//! light cone of the shot somewhere, and W that of the look direction. By vertex, the rest frame's time
//! and W are interpolated between corners with the same λ.
//!
//! *Warping.* All rays of a picture leave one event, and a camera at rest there gets the same light: for
//! scenes that rest in the world its picture of all directions holds, for each, what is met. Cameras in
//! motion look it up by the aberrated direction. Nothing but the directions between texels is
//! approximated; with bilinear lookup radiance is that of four texels, everything else of the nearest.

mod batch;
mod bins;
mod bundle;
mod cull;
mod divide;
mod draw;
mod map;
mod method;
mod tile;
mod triangles;
mod warp;

pub use method::{Attributes, Lookup, MOST_TEXELS, Map, Method, Raster, Tessellation, Warp};

use crate::approximate::projection::Observer;
use crate::camera::Kind;
use crate::error::{Error, Result};
use crate::render;
use crate::render::film::Film;
use crate::render::plan::Plan;
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;

/// Renders a prepared scene by `method` on rayon's current thread pool.
///
/// # Errors
/// What the method cannot do: rasterizers and warps need a camera all of whose rays leave one event, and
/// objects slower than light in the medium; warps need objects that rest in the world. Triangles cut
/// at more than 2²⁴ points. [`Error::Cancelled`] when `progress` says so.
pub fn render(scene: &Prepared, method: &Method, progress: &dyn Progress) -> Result<Film> {
    match method {
        Method::Trace => render::render(scene, progress),
        Method::Raster(raster) => {
            let observer = Observer::new(scene)?;
            let drawn = triangles::Triangles::new(scene, &observer, raster, progress)?;
            draw::film(scene, &drawn, progress)
        }
        Method::Warp(warp) => {
            Observer::new(scene)?;
            let looked_up = warp::Warped::new(scene, warp, progress)?;
            draw::film(scene, &looked_up, progress)
        }
    }
}

impl Method {
    /// Refuses what the method cannot do of `plan`, before anything is loaded.
    ///
    /// # Errors
    /// A camera whose rays leave events of their own; for warps, objects that move.
    pub fn check(&self, plan: &Plan) -> Result<()> {
        if *self == Method::Trace {
            return Ok(());
        }
        if !matches!(plan.view, Kind::Still | Kind::Moving | Kind::Unaberrated) {
            return Err(crate::approximate::projection::apart());
        }
        match (self, plan.frames.iter().find(|frame| frame.gamma > 1.0)) {
            (Method::Warp(_), Some(frame)) => {
                let object = frame.objects.first().and_then(|o| plan.objects.get(*o));
                Err(moves(&object.map_or(String::new(), |o| {
                    format!("object \"{}\"", o.name)
                })))
            }
            _ => Ok(()),
        }
    }
}

fn moves(object: &str) -> Error {
    Error::unsupported(
        "object",
        "velocity",
        format!("a warped picture shows what rests in the world, and {object} moves"),
        "render it by --method trace or raster, or let the camera move in place of the object",
    )
}
