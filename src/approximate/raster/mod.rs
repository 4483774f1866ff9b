//! Reference rasterizers: the usual approximations to ray tracing, for validation and for teaching.
//!
//! | method | geometry | what is exact |
//! |---|---|---|
//! | `raster` | vertices are moved to their apparent positions, flat triangles between them are rasterized (`divide`) | vertices |
//! | `warp` | each look direction is looked up in a picture taken from the same event at rest | geometry, as far as texels are small |
//!
//! Radiance, channels, sample positions and film are those of the ray tracer: only geometry and visibility are approximated, so that two
//! films differ in nothing else.
//!
//! *Vertices* (Weiskopf 2001; Müller & Boblest 2014): see [`projection`](crate::approximate::projection). A rasterizer joins
//! apparent positions by straight edges and flat triangles in the camera's frame, where true edges are
//! curved; triangles are divided into smaller ones to bring the two together (`divide`). What is seen at
//! a film point p = (x, y, 1) is decided by homogeneous edge functions (Olano & Greer, "Triangle scan
//! conversion using 2D homogeneous coordinates", 1997): with corners hᵢ = (xz, yz, z),
//!
//! ```text
//! eᵢ = hⱼ × hₖ,   D = h₀·e₀,   inside: all eᵢ·p of the sign of D,   1/z = Σ eᵢ·p / D,   λᵢ = eᵢ·p / Σ eⱼ·p,
//! ```
//!
//! which needs no clipping if a triangle passes beside or behind the camera. λ are the barycentric weights on the *flat apparent
//! triangle* (perspective-correct interpolation). With them the position X on the surface is interpolated, linearly in its rest frame,
//! and texture coordinates with it. The nearest z is visible; on shared edges both triangles are covered, and the first in the order of
//! the tree is taken.
//!
//! The implementation follows fast rasterizers: each distinct vertex is transformed once, in loops over one array per coordinate
//! (`vertices`); triangles are divided level by level (`divide`, `flatness`), culled (`cull`: with one sample per pixel also those that
//! contain none) and sorted by the tiles that they may reach (`batch`). A tile is rasterized in strips of rows (`draw`), all samples of a pixel together: their depths stay in the cache while
//! triangles cover them in f32, and in f64 where that is in doubt (`tile`); of the visible triangles (`surfaces`), only what radiance
//! depends on is interpolated (`fragments`), and shaded by the loops of the ray tracer. If radiance depends only on the patch, only its
//! patch and W are determined for each sample (`even`).
//!
//! *Attributes.* By fragment, time and position of emission are those of X itself, whose world line meets the light cone of the shot
//! somewhere, and W that of the look direction. By vertex, the rest frame's time and W are interpolated between corners with the same λ.
//!
//! *Warping.* All rays of a picture leave one event, and a camera at rest there gets the same light: for scenes that rest in the world
//! its picture of all directions contains the hit in each. Moving cameras look it up by the aberrated direction. Only the directions
//! between texels are approximated; with bilinear lookup radiance is that of four texels, everything else of the nearest.

mod batch;
mod cull;
mod cuts;
mod divide;
mod draw;
mod even;
mod flatness;
mod fragments;
mod map;
mod method;
mod plan;
mod ratios;
mod surfaces;
mod tile;
mod triangles;
mod vertices;
mod visible;
mod warp;

pub use method::{Attributes, Lookup, MOST_TEXELS, Map, Method, Raster, Tessellation, Warp};

use crate::approximate::projection::{Observer, apart};
use crate::error::Result;
use crate::render;
use crate::render::film::Film;
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;

/// Renders a prepared scene by `method` on rayon's current thread pool.
///
/// # Errors
/// Scenes that the method does not support: rasterizers and warps need a camera whose rays all leave one event, objects slower than light
/// in the medium, and colours without sampled spectra; warps need objects that rest in the world. Parameters that no text of a method
/// could have. Triangles cut at more than 2²⁴ points. [`Error::Cancelled`](crate::Error::Cancelled) when `progress` says so.
pub fn render(scene: &Prepared, method: &Method, progress: &dyn Progress) -> Result<Film> {
    Ok(counted(scene, method, None, progress)?.0)
}

/// The same picture in the memory of `film`, as by [`render_over`](crate::render::render_over).
///
/// # Errors
/// As for [`render()`].
pub fn render_over(
    scene: &Prepared,
    method: &Method,
    film: Film,
    progress: &dyn Progress,
) -> Result<Film> {
    Ok(counted(scene, method, Some(film), progress)?.0)
}

/// The picture, in the memory of `over` if given, and the bytes that the method holds for it beside the scene and the film: vertices and
/// triangles, or texels.
pub(crate) fn counted(
    scene: &Prepared,
    method: &Method,
    over: Option<Film>,
    progress: &dyn Progress,
) -> Result<(Film, u64)> {
    method.check_numbers()?;
    let light = scene.light.time_resolved();
    if *method != Method::Trace && light.is_some_and(|light| light.spectra.is_some()) {
        return Err(method::samples_spectra("scene"));
    }
    let (film, bytes) = match method {
        Method::Trace => {
            let film = match over {
                Some(film) => render::render_over(scene, film, progress),
                None => render::render(scene, progress),
            };
            (film?, 0)
        }
        Method::Raster(raster) => {
            let observer = Observer::new(scene)?;
            let drawn = triangles::Triangles::new(scene, &observer, raster, progress)?;
            let film = match even::Even::new(scene, &drawn) {
                Some(even) => draw::paint(scene, tile::MOST_TOGETHER, &even, over, progress),
                None => draw::film(scene, &drawn, over, progress),
            };
            (film?, drawn.bytes())
        }
        Method::Warp(warp) => {
            scene.camera.view.point().ok_or_else(apart)?;
            let looked_up = warp::Warped::new(scene, warp, progress)?;
            let film = draw::film(scene, &looked_up, over, progress)?;
            (film, looked_up.bytes())
        }
    };
    Ok((film, bytes))
}
