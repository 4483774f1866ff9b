//! Small pictures, to find the exposure of larger ones and what they will show.

use nullray::Result;
use nullray::render;
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::{LoadedCubes, Prepared};
use nullray::render::progress::Silent;
use nullray::scene::model::Scene;

use super::interrupt;

/// A small picture with one ray through the centre of each pixel.
pub struct Preview {
    pub scene: Scene,
    plan: Plan,
}

impl Preview {
    /// The preview of `scene`, with at most so many columns and rows.
    pub fn new(scene: &Scene, request: &Request, aovs: Vec<Aov>, most: u32) -> Result<Preview> {
        let mut scene = scene.clone();
        let [width, height] = scene.camera.size;
        let step = width.max(height).div_ceil(most);
        // Either half of a stereo pair has whole pixels.
        let columns = match scene.camera.stereo {
            Some(_) => 2 * (width / 2).div_ceil(step),
            None => width.div_ceil(step),
        };
        scene.camera.size = [columns, height.div_ceil(step)];
        let request = Request {
            aovs,
            pixel_centers: true,
            ..request.clone()
        };
        let plan = Plan::new(&scene, &request)?;
        Ok(Preview { scene, plan })
    }

    /// Its scene, prepared for it alone.
    pub fn prepared(&self, cubes: &mut LoadedCubes) -> Result<Prepared> {
        interrupt::check()?;
        Prepared::sharing(&self.scene, &self.plan, cubes, &Silent)
    }

    /// The picture, from a scene that was prepared for this camera or another.
    pub fn of(&self, prepared: &mut Prepared) -> Result<Film> {
        interrupt::check()?;
        prepared.retake_on_film(&self.scene, &self.plan)?;
        render::render(prepared, &Silent)
    }

    /// The picture, from a scene that is loaded for it.
    pub fn alone(&self, cubes: &mut LoadedCubes) -> Result<Film> {
        self.of(&mut self.prepared(cubes)?)
    }
}
