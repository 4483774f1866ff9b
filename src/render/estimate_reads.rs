//! An estimate of how much of cubes on disk a picture will read, before it is rendered.
//!
//! The scene is prepared and traced as usual, but bricks that lookups request are only counted, and contain zeros. For large pictures
//! every s-th tile is traced: neighbouring tiles share few bricks, so the sum is s times as large.

use super::plan::Plan;
use super::prepare::Prepared;
use super::progress::Progress;
use super::tiles::render_every;
use crate::error::Result;
use crate::scene::model::Scene;

/// The most rays that are traced.
const RAYS: u64 = 1 << 22;

/// Stores in `plan`, which is that of `scene`, how many bytes will be needed of the cubes that it reads in parts. Cubes from pictures and
/// archives are left out: they are unpacked first.
///
/// # Errors
/// As [`Prepared::new`].
pub fn estimate_reads(scene: &Scene, plan: &mut Plan, progress: &dyn Progress) -> Result<()> {
    if plan.cubes.iter().flatten().all(|cube| cube.held.is_none()) {
        return Ok(());
    }
    let prepared = Prepared::new(
        scene,
        &Plan {
            counts_only: true,
            ..plan.clone()
        },
        progress,
    )?;
    // Odd, so that it does not divide the number of tiles in a row.
    let step = plan.rays.camera.div_ceil(RAYS) | 1;
    render_every(&prepared, step, progress)?;
    let Some(light) = prepared.light.time_resolved() else {
        return Ok(());
    };
    for (texture, source) in light.cubes.iter().zip(&light.cube_sources) {
        let Some(cube) = plan.cubes[*source].as_mut() else {
            continue;
        };
        if cube.held.is_some() {
            let counted = texture
                .cube()
                .on_disk()
                .filter(|bricks| bricks.counts_only());
            // Each companion is read from the same file.
            let read = counted.map(|bricks| bricks.bytes_read().all.saturating_mul(step));
            let read = read.map(|read| read.min(cube.bytes));
            cube.read = read.map(|read| read.saturating_add(cube.read.unwrap_or(0)));
        }
    }
    Ok(())
}
