//! Emitters: base colours, the cubes that light them, lamps.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::area::{area_light, area_lights, area_radiance};
use super::response::{eye, received, response, response_to, sampled, sampled_spectra, without};
use super::stores::{LoadedCubes, Stores};
use crate::accel::Facing;
use crate::colour::{ColourTable, Spectrum};
use crate::error::Result;
use crate::io::cube::{Bricks, BytesRead};
use crate::io::gltf::EncodedImage;
use crate::io::image::Texture;
use crate::light::lamp::{Emission, Lamp};
use crate::light::reflection::reflectance_of_index;
use crate::light::sky::Sky;
use crate::mesh::{AlphaMode, Material, Mesh, TextureRef};
use crate::render::plan::{Lit, Plan, shown_by};
use crate::render::progress::Progress;
use crate::render::trace::{
    AlphaMask, AreaLights, BaseColour, BaseColours, Colouring, CustomRadiance, Element, Emitter,
    Finish, Glass, Gloss, PathTraced, Radiance, Response, RestFrame, Scaling, TextureLookup,
    TimeResolved,
};
use crate::scene::model::{
    Effects, EmissionProfile, Geometry, LightKind, Reconstruction, Scene, SourceKind, Spectra,
};
use crate::spacetime::{Event, Quantity, World};

/// Radiance of surfaces: constant, varying with time, or defined by the caller.
#[derive(Debug)]
pub(crate) enum SurfaceLight {
    /// Base colours only.
    Constant(BaseColours),
    /// Cubes, lamps, base colours.
    TimeResolved(TimeResolved),
    /// The same, with light that is traced from surface to surface.
    PathTraced(PathTraced),
    /// The caller's radiance in place of the scene's, set by [`Prepared::set_radiance`](super::Prepared::set_radiance).
    Custom(CustomRadiance),
}

impl SurfaceLight {
    /// The radiance of the scene, or the caller's own.
    pub fn radiance(&self) -> &dyn Radiance {
        match self {
            SurfaceLight::Constant(radiance) => radiance,
            SurfaceLight::TimeResolved(radiance) => radiance,
            SurfaceLight::PathTraced(radiance) => radiance,
            SurfaceLight::Custom(radiance) => radiance,
        }
    }

    /// Cubes and lamps, if there are any.
    pub(crate) fn time_resolved(&self) -> Option<&TimeResolved> {
        match self {
            SurfaceLight::TimeResolved(light) => Some(light),
            SurfaceLight::PathTraced(paths) => Some(&paths.light),
            SurfaceLight::Constant(_) | SurfaceLight::Custom(_) => None,
        }
    }

    /// Whether some lookups are means over sample footprints.
    pub(crate) fn has_footprints(&self) -> bool {
        let cubes = self.time_resolved().map_or(&[][..], |light| &light.cubes);
        cubes
            .iter()
            .any(|cube| cube.reconstruction() == Reconstruction::Footprint)
    }

    /// Whether data could not be read on demand, or the caller's radiance has broken its contract.
    pub(crate) fn has_failed(&self) -> bool {
        if let SurfaceLight::Custom(radiance) = self {
            return radiance.has_failed();
        }
        let mut on_disk = self.time_resolved().into_iter().flat_map(|l| l.on_disk());
        on_disk.any(Bricks::has_failed)
    }

    /// Checks that all data requested by lookups could be read, and that the caller's own radiance gave one emission for each point.
    ///
    /// # Errors
    /// The first failure.
    pub fn check(&self) -> Result<()> {
        if let SurfaceLight::Custom(radiance) = self {
            return radiance.check();
        }
        let mut on_disk = self.time_resolved().into_iter().flat_map(|l| l.on_disk());
        on_disk.try_for_each(Bricks::check)
    }

    /// Bytes read so far from cubes that are not loaded whole.
    pub fn bytes_read(&self) -> BytesRead {
        let mut sum = BytesRead::default();
        for bricks in self.time_resolved().into_iter().flat_map(|l| l.on_disk()) {
            let BytesRead { all, again } = bricks.bytes_read();
            sum.all += all;
            sum.again += again;
        }
        sum
    }

    /// The same, mutable.
    pub(crate) fn time_resolved_mut(&mut self) -> Option<&mut TimeResolved> {
        match self {
            SurfaceLight::TimeResolved(light) => Some(light),
            SurfaceLight::PathTraced(paths) => Some(&mut paths.light),
            SurfaceLight::Constant(_) | SurfaceLight::Custom(_) => None,
        }
    }
}

/// Gathers emitters object by object, then loads cubes.
pub(super) struct Builder<'a> {
    scene: &'a Scene,
    colours: Vec<BaseColour>,
    textures: Textures,
    /// Per emitter: what lights it, and its finish.
    emitters: Vec<(Lit, Finish)>,
    /// Per emitter: its alpha mask.
    masks: Vec<Option<AlphaMask>>,
}

impl<'a> Builder<'a> {
    pub(super) fn new(scene: &'a Scene, plan: &Plan) -> Self {
        Builder {
            scene,
            colours: Vec::new(),
            textures: Textures {
                decoded: Vec::new(),
                indices: HashMap::new(),
                budget: plan.memory_left(),
            },
            emitters: Vec::new(),
            masks: Vec::new(),
        }
    }

    /// The alpha mask of emitter `index`, if it has one.
    pub(super) fn mask(&self, index: u32) -> Option<&AlphaMask> {
        self.masks.get(index as usize)?.as_ref()
    }

    /// Emitter indices for the materials of object `object`.
    pub(super) fn materials(
        &mut self,
        object: usize,
        mesh: &Mesh,
        images: Vec<EncodedImage>,
    ) -> Result<Vec<u32>> {
        let file = match &self.scene.objects[object].geometry {
            Geometry::Gltf { path, .. } => path.clone(),
            Geometry::Shape { .. } | Geometry::Mesh(_) => PathBuf::new(),
        };
        let textures = images
            .into_iter()
            .map(|image| self.textures.index(&file, image))
            .collect::<Result<Vec<_>>>()?;
        let own = self.scene.objects[object].spectrum.as_ref();
        let own = own.map(|spectrum| spectrum_colour(spectrum, self.scene));
        let area = area_radiance(self.scene, object, mesh);
        let profile = area_light(self.scene, object)
            .filter(|area| *area.emission != EmissionProfile::Steady)
            .map(|area| Arc::new(Emission::from(area.emission)));
        let vertex_colours = !mesh.colours.is_empty();
        let emitter = |material: &Material| {
            let lit = shown_by(self.scene, object, (&material.name, material.unlit));
            let colour = match &own {
                // For an area light, its radiance is a factor on its spectrum.
                Some(colour) => BaseColour {
                    factor: colour.factor.map(|c| c * area.map_or(1.0, mean)),
                    profile: profile.clone(),
                    ..colour.clone()
                },
                None => base_colour(material, &textures, vertex_colours),
            };
            self.colours.push(colour);
            let finish = Finish {
                colour: self.colours.len() - 1,
                gloss: gloss(self.scene, material, &textures),
                glass: glass(self.scene, material),
                emission: emission(self.scene, (area, &profile), material, &textures),
                is_smooth: !mesh.normals.is_empty(),
            };
            self.emitters.push((lit, finish));
            let decoded = &self.textures.decoded;
            self.masks.push(alpha_mask(material, &textures, decoded));
            self.emitters.len() as u32 - 1
        };
        Ok(mesh.materials.iter().map(emitter).collect())
    }

    /// The sun of a sky that lights, as a lamp.
    fn sun(&self) -> Option<Lamp> {
        let sky = self.scene.sky.as_ref().filter(|sky| sky.lights)?;
        Some(Lamp::sun(
            &sky.sun?,
            received(self.scene.quantity, self.scene),
            sky.shadows,
        ))
    }

    /// The surfaces that shine.
    fn areas(&self, frames: &[RestFrame]) -> Option<Box<AreaLights>> {
        let mut elements = Vec::new();
        let mut spectra: HashMap<u32, Arc<ColourTable>> = HashMap::new();
        for (frame, rest) in (0..).zip(frames) {
            for slot in 0..rest.bvh.len() as u32 {
                let (triangle, facing) = rest.bvh.triangle(slot);
                let patch = rest.patch(triangle);
                let (lit, finish) = &self.emitters[patch.emitter as usize];
                let area = area_light(self.scene, patch.object as usize);
                // No points are sampled on surfaces that show a cube, captures or their base colour; light that bounces may hit them.
                let shines = match lit {
                    Lit::Reflecting(_) => true,
                    Lit::Spectrum => area.is_some(),
                    Lit::Base | Lit::Cube(_) | Lit::Captures(_) => false,
                };
                let Some(radiance) = finish.emission.as_ref().filter(|_| shines) else {
                    continue;
                };
                let object = &self.scene.objects[patch.object as usize];
                // One table of colours for all triangles of an object.
                let spectrum = object.spectrum.as_ref().map(|spectrum| {
                    let table = || Arc::new(ColourTable::new(spectrum));
                    spectra.entry(patch.object).or_insert_with(table).clone()
                });
                elements.push(Element {
                    frame,
                    triangle,
                    corners: rest.bvh.corners(slot),
                    radiance: radiance.clone(),
                    spectrum,
                    two_sided: facing == Facing::TwoSided && !patch.black_back,
                    shadows: area.is_none_or(|area| area.shadows),
                });
            }
        }
        AreaLights::new(elements, received(self.scene.quantity, self.scene)).map(Box::new)
    }

    /// Loads the cubes that the plan lists, but for those that are `loaded`, and traces their capture cameras.
    pub(super) fn finish(
        self,
        plan: &Plan,
        frames: &[RestFrame],
        (shot, sky): (Event<World>, Option<&Arc<Sky>>),
        loaded: &mut LoadedCubes,
        warnings: &mut Vec<String>,
        progress: &dyn Progress,
    ) -> Result<SurfaceLight> {
        let scene = self.scene;
        let (sun, areas) = (self.sun(), self.areas(frames));
        let base = BaseColours {
            colours: self.colours,
            textures: self.textures.decoded,
            response: response(scene.quantity, scene),
        };
        // Without time, emitter k is base colour k.
        if !plan.time_resolved {
            return Ok(SurfaceLight::Constant(base));
        }
        let mut stores = Stores::new(plan, loaded);
        let mut sources = Vec::new();
        for (index, source) in scene.sources.iter().enumerate() {
            progress.check()?;
            let planned = plan.cubes.get(index).and_then(Option::as_ref);
            sources.push(match (&source.kind, planned) {
                (SourceKind::Cube(cube), Some(planned)) => {
                    Some(stores.cube(scene, index, (cube, planned.held), frames)?)
                }
                _ => None,
            });
        }
        let pulses = scene.sources.iter().map(|source| match &source.kind {
            SourceKind::Pulse(pulse) => Some(Lamp::pulse(pulse, received(source.quantity, scene))),
            SourceKind::Cube(_) => None,
        });
        let mut lamps: Vec<_> = pulses.collect();
        for light in &scene.lights {
            lamps.push(match &light.kind {
                LightKind::Lamp(lamp) => Some(Lamp::new(
                    lamp,
                    received(scene.quantity, scene),
                    light.shadows,
                    shot,
                )?),
                LightKind::Area { .. } => None,
            });
        }
        lamps.push(sun);
        // The scene's lights, for everything that reflects.
        let everywhere = || (scene.sources.len()..lamps.len()).filter(|k| lamps[*k].is_some());
        let quantities = self.emitters.iter().map(|(lit, _)| match lit {
            Lit::Cube(source) => scene.sources[*source].quantity,
            Lit::Captures(sources) => scene.sources[sources[0]].quantity,
            Lit::Reflecting(pulses) => pulses
                .first()
                .map_or(scene.quantity, |pulse| scene.sources[*pulse].quantity),
            Lit::Base | Lit::Spectrum => scene.quantity,
        });
        let arriving = quantities.map(|quantity| received(quantity, scene));
        let arriving: Vec<_> = arriving.collect();
        let emitters = self.emitters.into_iter().map(|(lit, finish)| match lit {
            Lit::Base | Lit::Spectrum => {
                let own = base.colours[finish.colour].response.as_ref();
                let response = own.unwrap_or(&base.response).clone();
                (Emitter::Base(finish.colour), response)
            }
            Lit::Reflecting(pulses) => {
                let first = pulses.first().map(|pulse| scene.sources[*pulse].quantity);
                let response = match scene.spectra {
                    Spectra::Rgb => response(first.unwrap_or(scene.quantity), scene),
                    Spectra::Sampled => sampled(scene),
                };
                let emitter = Emitter::Lit {
                    finish: Box::new(finish),
                    lamps: pulses.into_iter().chain(everywhere()).collect(),
                };
                (emitter, response)
            }
            Lit::Cube(source) => {
                let emitter = sources[source]
                    .clone()
                    .unwrap_or(Emitter::Base(finish.colour));
                (emitter, response_to(&scene.sources[source], scene))
            }
            Lit::Captures(indices) => {
                let captured = |source: &usize| match &sources[*source] {
                    Some(Emitter::Captured(one)) => one.clone(),
                    _ => Vec::new(),
                };
                let all = indices.iter().flat_map(captured).collect();
                let response = response_to(&scene.sources[indices[0]], scene);
                (Emitter::Captured(all), response)
            }
        });
        let emitters = emitters.collect();
        warnings.append(&mut stores.warnings);
        let light = TimeResolved {
            emitters,
            base,
            cubes: stores.cubes,
            cube_sources: stores.sources,
            choice: scene.captures,
            captures: stores.captures,
            lamps,
            areas,
            area_lights: area_lights(scene),
            sky: sky.and_then(|sky| super::sky::light(scene, sky, frames)),
            spectra: sampled_spectra(scene),
            index: scene.medium_index,
            shows_emission: true,
        };
        Ok(match scene.bounces {
            0 => SurfaceLight::TimeResolved(light),
            bounces => SurfaceLight::PathTraced(PathTraced::new(light, bounces, arriving, frames)),
        })
    }
}

/// `textures`: for each image of the file, its index among the decoded ones; empty if none are loaded.
fn lookup(texture: &Option<TextureRef>, textures: &[usize]) -> Option<TextureLookup> {
    let texture = texture.as_ref()?;
    Some(TextureLookup {
        texture: *textures.get(texture.image)?,
        uv_set: texture.uv_set,
        sampler: texture.sampler,
    })
}

fn base_colour(material: &Material, textures: &[usize], vertex_colours: bool) -> BaseColour {
    BaseColour {
        factor: material.base_colour.map(f64::from),
        texture: lookup(&material.base_colour_texture, textures),
        vertex_colours,
        response: None,
        profile: None,
    }
}

/// The alpha mask of `material`; `decoded` are the decoded textures.
fn alpha_mask(
    material: &Material,
    textures: &[usize],
    decoded: &[Arc<Texture>],
) -> Option<AlphaMask> {
    let AlphaMode::Mask { cutoff } = material.alpha_mode else {
        return None;
    };
    let texture = lookup(&material.base_colour_texture, textures);
    Some(AlphaMask {
        factor: f64::from(material.alpha),
        texture: texture.map(|of| (decoded[of.texture].clone(), of.uv_set, of.sampler)),
        cutoff,
    })
}

/// Metalness and roughness in a scene with lights; a rough dielectric is diffuse, and so is a surface lit by pulses alone.
fn gloss(scene: &Scene, material: &Material, textures: &[usize]) -> Option<Gloss> {
    let is_matte = material.metallic == 0.0
        && material.roughness == 1.0
        && material.metallic_roughness_texture.is_none();
    let is_glossy = !is_matte || glass(scene, material).is_some();
    (scene.is_lit() && is_glossy).then(|| Gloss {
        metallic: f64::from(material.metallic),
        roughness: f64::from(material.roughness),
        texture: lookup(&material.metallic_roughness_texture, textures),
        dielectric: reflectance_of_index(relative_index(scene, material)),
    })
}

/// The transmission of a surface, if light is traced onwards.
fn glass(scene: &Scene, material: &Material) -> Option<Glass> {
    (scene.bounces > 0 && material.transmission > 0.0).then(|| Glass {
        transmission: f64::from(material.transmission),
        index: relative_index(scene, material),
        solid: material.solid,
    })
}

/// The refractive index of a material over that of the medium around it, by which it reflects and refracts.
fn relative_index(scene: &Scene, material: &Material) -> f64 {
    f64::from(material.ior) / scene.medium_index
}

/// The emission of a surface in a scene with lights: from its material, or as an area light.
fn emission(
    scene: &Scene,
    (area, profile): (Option<[f64; 3]>, &Option<Arc<Emission>>),
    material: &Material,
    textures: &[usize],
) -> Option<BaseColour> {
    let area = area.map(|radiance| BaseColour {
        factor: radiance,
        texture: None,
        vertex_colours: false,
        response: None,
        profile: profile.clone(),
    });
    let own = || BaseColour {
        factor: material.emissive.map(f64::from),
        texture: lookup(&material.emissive_texture, textures),
        vertex_colours: false,
        response: None,
        profile: profile.clone(),
    };
    let shines = scene.is_lit() && material.emissive != [0.0; 3];
    area.or_else(|| shines.then(own))
}

fn mean([r, g, b]: [f64; 3]) -> f64 {
    (r + g + b) / 3.0
}

/// A surface that emits `spectrum`, and its colour for an observer in `scene`.
fn spectrum_colour(spectrum: &Spectrum, scene: &Scene) -> BaseColour {
    let eye = eye(scene);
    let Effects {
        doppler,
        searchlight,
        ..
    } = scene.effects;
    let (factor, response) = if doppler {
        let response = Response {
            scaled: without(searchlight),
            colour: Colouring::Spectrum(Arc::new(ColourTable::new(spectrum)), eye),
        };
        ([1.0; 3], response)
    } else {
        // Its colour at rest, scaled by the brightness of its total energy.
        let response = Response {
            scaled: match searchlight {
                true => Scaling::Of(Quantity::Integrated),
                false => Scaling::None,
            },
            colour: Colouring::Channels,
        };
        (eye.colour(spectrum), response)
    };
    BaseColour {
        vertex_colours: false,
        factor,
        texture: None,
        response: Some(response),
        profile: None,
    }
}

/// Decoded images, each once, within the memory that the plan leaves.
struct Textures {
    decoded: Vec<Arc<Texture>>,
    indices: HashMap<(PathBuf, String), usize>,
    /// Bytes that are left.
    budget: u64,
}

impl Textures {
    fn index(&mut self, file: &Path, image: EncodedImage) -> Result<usize> {
        let key = (file.to_path_buf(), image.place);
        if let Some(index) = self.indices.get(&key) {
            return Ok(*index);
        }
        let texture = Texture::decode_within(&image.bytes, &key.1, file, self.budget)?;
        self.budget = self.budget.saturating_sub(texture.bytes() as u64);
        self.decoded.push(Arc::new(texture));
        self.indices.insert(key, self.decoded.len() - 1);
        Ok(self.decoded.len() - 1)
    }
}
