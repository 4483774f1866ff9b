//! Loads and builds what the plan lists, and nothing else.

mod area;
mod backs;
mod emitters;
mod files;
mod geometry;
mod response;
mod sky;
mod smooth;
mod stores;

pub(crate) use emitters::SurfaceLight;
pub use files::check_files;
pub(crate) use geometry::object_mesh;
pub(crate) use response::scaling;
pub use stores::LoadedCubes;

use std::cell::LazyCell;
use std::num::NonZeroU32;
use std::sync::Arc;

use crate::accel::Traversal;
use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::light::time_texture::{TimeTexture, survey};
use crate::render::film::Layout;
use crate::render::plan::{
    PLANNED, PREPARED, Plan, check_camera, check_same, check_size, unfound_light, unshown,
};
use crate::render::progress::Progress;
use crate::render::sampler::Sampler;
use crate::render::trace::{
    Background, CustomRadiance, HitBuffer, Meter, Radiance, Rays, RestFrame, Surfaces, TracedRays,
};
use crate::scene::model::Scene;

/// A scene with everything loaded and built that its plan lists.
#[derive(Debug)]
#[non_exhaustive]
pub struct Prepared {
    /// The camera at the moment of the shot.
    pub camera: Camera,
    /// The rest frames with their BVHs.
    pub frames: Vec<RestFrame>,
    /// Radiance of surfaces.
    pub(crate) light: SurfaceLight,
    /// Refractive index that delays camera rays; 0 if retardation is turned off.
    pub ray_index: f64,
    /// How long the shutter is open, metres of the camera's own time, if data are integrated over that.
    pub integrated_exposure: Option<f64>,
    /// The radiance of rays that hit nothing.
    pub background: Background,
    /// The positions of samples in a pixel.
    pub sampler: Sampler,
    /// The film.
    pub layout: Layout,
    /// How rays are traced.
    pub method: Traversal,
    /// How many samples of each pixel are traced together; `None` for the number that is fastest. Pixels differ by the rounding of their
    /// sums.
    pub samples_at_once: Option<NonZeroU32>,
    /// Unusual features of the files or the scene that are not errors: a sentence each.
    pub warnings: Vec<String>,
    /// Which light no path can find, and why, if any.
    pub(crate) unfound_light: Option<String>,
    /// The time to build the trees, seconds.
    pub built_in: f64,
    /// What the plan leaves of the memory limit, bytes: for work whose size no plan can estimate.
    pub memory_left: u64,
    /// The scene that was planned.
    of: Arc<Scene>,
}

impl Prepared {
    /// Whether there is light that no path can find, as that of a lamp without extent in a perfect mirror; a warning says which. Pictures
    /// and their standard errors lack it.
    pub fn lacks_light(&self) -> bool {
        self.unfound_light.is_some()
    }

    /// Whether any triangle can be seen: has an area, and corners that are finite.
    pub fn has_triangles(&self) -> bool {
        self.frames.iter().any(|frame| !frame.bvh.is_empty())
    }

    /// Carries out `plan`, which must be that of `scene`, on the threads of rayon's current pool.
    ///
    /// # Errors
    /// A plan of another scene, as far as that is quick to compare (as for [`Prepared::retake`], whatever the camera), broken files, and
    /// [`Error::Cancelled`] when `progress` says so.
    pub fn new(scene: &Scene, plan: &Plan, progress: &dyn Progress) -> Result<Prepared> {
        Prepared::sharing(scene, plan, &mut LoadedCubes::default(), progress)
    }

    /// Like [`Prepared::new`], but cubes that are among `cubes` are not loaded again. After it, `cubes` holds those of `scene`.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn sharing(
        scene: &Scene,
        plan: &Plan,
        cubes: &mut LoadedCubes,
        progress: &dyn Progress,
    ) -> Result<Prepared> {
        check_same(&plan.of, scene, PLANNED)?;
        check_size(scene, plan.film.size)?;
        let count = scene.objects.len();
        let of_scene =
            |objects: &[usize]| !objects.is_empty() && objects.iter().all(|o| *o < count);
        if plan.objects.len() != count || !plan.frames.iter().all(|f| of_scene(&f.objects)) {
            let what = "its frames do not list the objects of the scene";
            return Err(Error::invalid(&scene.name, "plan", what, PLANNED[1]));
        }
        cubes.keep_those_of(scene);
        let camera = Camera::new(scene)?;
        let mut light = emitters::Builder::new(scene, plan);
        let mut warnings = Vec::new();
        // A frame for each velocity: meshes, their materials, and a tree.
        let (frames, built_in) =
            geometry::frames(scene, plan, &mut light, &mut warnings, progress)?;
        progress.check()?;
        let sky = sky::load(scene, plan)?;
        let around = (camera.shot.event, sky.as_ref());
        let light = light.finish(plan, &frames, around, cubes, &mut warnings, progress)?;
        // Textures are searched only if a lamp could be missing in a mirror.
        let mirrors = LazyCell::new(|| smooth::mirrors_by_texture(&light, &frames));
        let unfound = unfound_light(scene, &plan.objects, |object| mirrors.contains(&object));
        drop(mirrors);
        // Warnings known before anything was read come first.
        warnings.splice(
            0..0,
            (scene.passed_over.iter().cloned())
                .chain(unfound.clone())
                .chain(unshown(scene, &plan.objects)),
        );
        // Without retardation, light has no delay.
        let ray_index = if scene.effects.retardation {
            scene.medium_index
        } else {
            0.0
        };
        Ok(Prepared {
            background: sky::background(scene, &camera.shot, sky),
            camera,
            frames,
            light,
            ray_index,
            integrated_exposure: scene.camera.integrated_exposure(),
            sampler: sampler(scene, &plan.film),
            layout: plan.film.clone(),
            method: method(&plan.film),
            samples_at_once: None,
            warnings,
            unfound_light: unfound,
            built_in,
            memory_left: plan.memory_left(),
            of: plan.of.clone(),
        })
    }

    /// All surfaces, for rays that leave the shot.
    pub(crate) fn surfaces(&self) -> Surfaces<'_> {
        Surfaces::new(&self.frames, &self.camera.shot, self.ray_index)
    }

    /// Traces camera rays to their nearest hits on `surfaces`, which are those of [`Prepared::surfaces`].
    pub(crate) fn trace<'a>(
        &self,
        surfaces: &'a Surfaces<'a>,
        rays: Rays<'a>,
        hits: &'a mut HitBuffer,
        meter: &mut Meter,
    ) -> TracedRays<'a> {
        surfaces.nearest(&rays, hits, meter);
        TracedRays {
            surfaces,
            rays,
            hits,
            event: self.camera.shot.event,
            index: self.ray_index,
        }
    }

    /// The radiance of all surfaces: that of the scene, or the one that replaces it.
    pub fn radiance(&self) -> &dyn Radiance {
        self.light.radiance()
    }

    /// The cubes that light surfaces, by source; none once their radiance is replaced.
    pub fn cubes(&self) -> &[TimeTexture] {
        let light = self.light.time_resolved();
        light.map_or(&[], |light| light.cubes.as_slice())
    }

    /// Whether there are cubes, and every sample examined of them is 0: of those in memory some thousands of pixels.
    pub fn has_dark_data(&self) -> bool {
        let mut cubes = self.cubes().iter();
        !self.cubes().is_empty() && cubes.all(|cube| survey::is_dark(cube.cube()))
    }

    /// Replaces the radiance of all surfaces in the scene (base colours, cubes, lamps) by `radiance`. Visibility, alpha masks, the
    /// background and the sky stay.
    ///
    /// Every rendering from here on calls it once for each run of points of one material: see [`Radiance`]. Its
    /// [gaps](Radiance::has_gaps) count in the film's coverage.
    pub fn set_radiance(&mut self, radiance: Box<dyn Radiance>) {
        self.layout.has_gaps |= radiance.has_gaps();
        self.light = SurfaceLight::Custom(CustomRadiance::new(radiance));
    }

    /// Sets whether the camera sees the light that surfaces emit by themselves beside what they reflect, as it does unless told otherwise.
    /// That light falls on other surfaces in any case. Returns whether there are such surfaces.
    pub fn show_emission(&mut self, shows: bool) -> bool {
        let Some(light) = self.light.time_resolved_mut() else {
            return false;
        };
        light.shows_emission = shows;
        light.emits()
    }

    /// Like [`Prepared::retake`], on the film of `plan`, which is that of `scene`: pictures may differ in size, samples and precision, too,
    /// and show less than the prepared plan needs.
    ///
    /// # Errors
    /// As [`Prepared::retake`], and a plan of pictures of another size than the scene's.
    pub fn retake_on_film(&mut self, scene: &Scene, plan: &Plan) -> Result<()> {
        check_same(&self.of, scene, PREPARED)?;
        check_size(scene, plan.film.size)?;
        check_camera(scene)?;
        let has_gaps = self.layout.has_gaps || plan.film.has_gaps;
        self.layout = Layout {
            has_gaps,
            ..plan.film.clone()
        };
        self.sampler = sampler(scene, &plan.film);
        self.method = method(&plan.film);
        self.set_camera(scene)
    }

    /// Sets the camera of the next picture to that of `scene`, which may differ from the prepared scene only in the camera's place,
    /// direction, field of view, motion and time, and in the seed: everything else stays as it is loaded and built. What is quick to
    /// compare is checked; files, materials, and what lights and sources are beyond their names, is not.
    ///
    /// Cameras of one `Prepared` render one after the other: `retake` needs it for itself, and rendering uses all threads anyway.
    ///
    /// # Errors
    /// A picture of another size or with another number of samples; objects that differ in number, name, place or motion; other sources or
    /// lights, another sky, equations, effects and the like; a camera that [`Plan::new`] refuses; and as [`Camera::new`].
    pub fn retake(&mut self, scene: &Scene) -> Result<()> {
        check_same(&self.of, scene, PREPARED)?;
        check_size(scene, self.layout.size)?;
        let (had, has) = (self.layout.samples, scene.samples_per_pixel);
        if had != has && !self.layout.pixel_centers {
            let what = format!("the picture has {has} samples per pixel, but the film {had}");
            let help = "Prepared::retake_on_film with a plan of this scene";
            return Err(Error::invalid(&scene.name, "samples_per_pixel", what, help));
        }
        check_camera(scene)?;
        self.set_camera(scene)?;
        self.sampler = self.sampler.with_seed(scene.seed);
        Ok(())
    }

    /// Sets the camera to that of `scene`, which is known to differ in nothing else.
    pub(crate) fn set_camera(&mut self, scene: &Scene) -> Result<()> {
        self.camera = Camera::new(scene)?;
        self.integrated_exposure = scene.camera.integrated_exposure();
        let shot = self.camera.shot.event;
        if let Some(light) = self.light.time_resolved_mut() {
            let lamps = light.lamps.iter_mut().flatten();
            lamps.for_each(|lamp| lamp.retake(shot));
        }
        // Stars and the sun are widened by the motion of the camera.
        if let Background::Sky {
            angle,
            pixel,
            beaming,
            motions,
            ..
        } = &mut self.background
        {
            [*angle, *pixel] = sky::angles(scene);
            beaming.motion = sky::motion(scene, &self.camera.shot);
            *motions = sky::motions(scene);
        }
        Ok(())
    }
}

/// The positions of samples in the pixels of `film`.
fn sampler(scene: &Scene, film: &Layout) -> Sampler {
    let sampler = match film.pixel_centers {
        true => Sampler::centred(),
        false => Sampler::stratified(film.samples_per_part()),
    };
    sampler.with_seed(scene.seed)
}

/// How the rays of `film` are traced.
fn method(film: &Layout) -> Traversal {
    Traversal {
        precision: film.precision,
        ..Traversal::default()
    }
}
