//! From a pixel to the point that it sees.

use glam::DVec3;

use super::{Probe, ProbeHit, PulseLight, Reception};
use crate::accel::Precision;
use crate::camera::{AnyProjection, CameraRay, Projection, rotation_matrix};
use crate::error::{Error, Result};
use crate::figures::diagram::model::Track;
use crate::render::aov::Aov;
use crate::render::film::{Film, Tile};
use crate::render::plan::{Plan, Request};
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::render_tiles;
use crate::scene::model::{Assembly, CameraModel, Equations, Object, Pivot, Scene, SourceKind};
use crate::spacetime::worldline::{State, WorldLine};
use crate::spacetime::{Displacement, Event, InertialFrame, World};

const CHANNELS: [Aov; 12] = [
    Aov::Object,
    Aov::Primitive,
    Aov::EventCt,
    Aov::EventX,
    Aov::EventY,
    Aov::EventZ,
    Aov::ObjectEventCt,
    Aov::ObjectEventX,
    Aov::ObjectEventY,
    Aov::ObjectEventZ,
    Aov::Distance,
    Aov::WavelengthRatio,
];

/// Traces the ray through the centre of the pixel in column and row `pixel`. Geometry is loaded and its BVHs are
/// built; textures and cubes are not.
///
/// # Errors
/// A pixel outside the image, or one that no light reaches; and as [`Plan::new`] and [`Prepared::new`], whose
/// memory is to stay within `memory_limit` bytes.
pub fn trace(
    scene: &Scene,
    pixel: [u32; 2],
    memory_limit: u64,
    progress: &dyn Progress,
) -> Result<Probe> {
    within(scene, pixel)?;
    check(scene)?;
    let request = Request {
        aovs: CHANNELS.to_vec(),
        pixel_centers: true,
        precision: Precision::Certified,
        memory_limit,
        ..Request::default()
    };
    // The light is traced back to where it left, which needs geometry only.
    let mut plan = Plan::new(scene, &request)?;
    plan.cubes.iter_mut().for_each(|cube| *cube = None);
    for object in &mut plan.objects {
        (object.uvs, object.textures, object.normals) = (false, false, false);
    }
    let mut prepared = Prepared::new(scene, &plan, progress)?;
    let (ray, moment) = camera_ray(&prepared, pixel);
    // Behind a finite pinhole some elements of the sensor get no light.
    if !ray.origin.sees() || !ray.d.unit().is_finite() {
        let what = "no light reaches this element of the sensor through the pinhole";
        let help = "take another pixel, or another time";
        return Err(Error::invalid(&scene.name, place(pixel), what, help));
    }
    let arrival = Arrival::new(scene, &prepared, pixel, moment)?;
    let reception = arrival.reception(ray);
    let mut exposed = Exposed {
        prepared: &mut prepared,
        pixel,
        progress,
    };
    let film = exposed.film()?;
    let hit = match exposed.object(&film) {
        Some(index) => Some(ProbeHit {
            pulses: exposed.pulses(scene, &film)?,
            ..exposed.hit(scene, index, &film, &reception)
        }),
        None => None,
    };
    Ok(Probe {
        pixel,
        reception,
        direction: ray.d,
        index: prepared.ray_index * ray.origin.delay,
        camera: arrival.line.clone().into(),
        element: arrival.track(),
        hit,
        reach: reach(scene, reception.pinhole),
    })
}

/// Refuses a camera with two pinholes, of whose pixels there are no diagrams.
///
/// # Errors
/// A stereo pair.
pub fn check(scene: &Scene) -> Result<()> {
    if scene.camera.stereo.is_none() {
        return Ok(());
    }
    let what = "a diagram follows the light to one pinhole, but a stereo pair has two";
    let help = "leave [camera.stereo] out, and move `eye` to either eye";
    Err(Error::unsupported(&scene.name, "camera.stereo", what, help))
}

fn place([column, row]: [u32; 2]) -> String {
    format!("pixel {column},{row}")
}

fn within(scene: &Scene, pixel: [u32; 2]) -> Result<()> {
    let [width, height] = scene.camera.size;
    if pixel[0] < width && pixel[1] < height {
        return Ok(());
    }
    let what = format!("this is outside the picture of {width} × {height} pixels");
    let help = format!(
        "columns are 0 to {} (from the left), rows 0 to {} (from the top)",
        width - 1,
        height - 1
    );
    Err(Error::invalid(&scene.name, place(pixel), what, help))
}

/// The ray of a pixel's centre, and its moment of the exposure, as rendered.
fn camera_ray(prepared: &Prepared, [column, row]: [u32; 2]) -> (CameraRay, f64) {
    let sampler = &prepared.sampler;
    let [x, y] = sampler.offset(column, row, 0);
    let moment = sampler.moment(column, row, 0);
    let (x, y) = (f64::from(column) + x, f64::from(row) + y);
    (prepared.camera.view.ray(x, y, moment), moment)
}

/// How far to follow a ray that hits nothing: the largest distance of an object's origin from the pinhole.
fn reach(scene: &Scene, pinhole: Event<World>) -> f64 {
    let far = scene
        .objects
        .iter()
        .map(|object| (object.origin.x - pinhole.x).length());
    let far = far.fold(0.0, f64::max);
    if far > 0.0 { far } else { 1.0 }
}

/// The camera and the sensor element at the time of the light's arrival.
struct Arrival<'a> {
    model: &'a CameraModel,
    line: WorldLine,
    state: State,
    /// The film vector D of the element.
    film: DVec3,
    shot: Event<World>,
    /// Whether the light continues from the pinhole to a sensor element, which the equations of the paper ignore.
    has_element: bool,
}

impl<'a> Arrival<'a> {
    fn new(
        scene: &'a Scene,
        prepared: &Prepared,
        [column, row]: [u32; 2],
        moment: f64,
    ) -> Result<Self> {
        let model = &scene.camera;
        let open = model.shutter.map_or(0.0, |shutter| shutter.duration);
        let refuse = |what: String| {
            let help = "give a time and a motion that the camera has";
            Error::invalid(&scene.name, "camera", what, help)
        };
        let line = model
            .world_line()
            .map_err(|error| refuse(error.to_string()))?;
        let state = line.state(model.time + moment * open);
        let state =
            state.ok_or_else(|| refuse("its world line does not exist at that time".into()))?;
        let by_paper = scene.equations == Equations::Paper2015 && model.rotation.is_none();
        Ok(Arrival {
            // Through the pixel's centre.
            film: AnyProjection::new(model).vector(f64::from(column) + 0.5, f64::from(row) + 0.5),
            shot: prepared.camera.shot.event,
            has_element: model.sensor.is_some() && !by_paper,
            model,
            line,
            state,
        })
    }

    fn reception(&self, ray: CameraRay) -> Reception {
        let pinhole = self.shot + ray.origin.displacement;
        let event = self.element().unwrap_or(pinhole);
        let passing = Track::from(self.line.clone()).where_zero(|e| e.ct - pinhole.ct);
        let time = self.state.proper_time;
        Reception {
            event,
            time,
            pinhole,
            pinhole_time: match pinhole == self.state.event {
                true => time,
                false => passing.map_or(time, |moment| moment.proper_time),
            },
            frame: InertialFrame::new(self.state.velocity, event),
        }
    }

    /// The event of the element at the time of the exposure.
    fn element(&self) -> Option<Event<World>> {
        let sensor = self.model.sensor.filter(|_| self.has_element)?;
        let forward = self.model.axes[2];
        let element = self.film * -sensor.focal_length;
        if sensor.assembly == Assembly::Bell && self.model.rotation.is_none() {
            return Some(self.state.event + Displacement::new(0.0, element));
        }
        // The focal length that the camera measures itself.
        let own = sensor.own_focal_length(forward, self.state.velocity);
        let mut place = element - forward * (own - sensor.focal_length);
        if let Some(rotation) = self.model.rotation {
            let turn = rotation_matrix(rotation.axis, rotation.rate * self.state.proper_time);
            let centre = match rotation.through {
                Pivot::Pinhole => DVec3::ZERO,
                Pivot::Sensor => forward * -own,
            };
            // Turning about the centre: c + R (p − c).
            place = centre + turn * (place - centre);
        }
        let offset = Displacement::new(0.0, place);
        Some(self.state.event + self.state.frame().world_from_frame().displacement(offset))
    }

    /// The element's world line, if it does not turn.
    fn track(&self) -> Option<Track> {
        let sensor = self
            .model
            .sensor
            .filter(|_| self.has_element && self.model.rotation.is_none())?;
        let line = self.line.clone();
        Some(Track::element(line, sensor, self.model.axes[2], self.film))
    }
}

/// One pixel of a prepared scene.
struct Exposed<'a> {
    prepared: &'a mut Prepared,
    pixel: [u32; 2],
    progress: &'a dyn Progress,
}

impl Exposed<'_> {
    /// The tile of the pixel: with its neighbours, as it is rendered.
    fn film(&self) -> Result<Film> {
        let tile = Tile::holding(self.prepared.layout.size, self.pixel);
        render_tiles(self.prepared, tile..tile + 1, self.progress)
    }

    fn at(&self) -> usize {
        let [column, row] = self.pixel.map(|side| side as usize);
        row * self.prepared.layout.size[0] as usize + column
    }

    fn value(&self, film: &Film, aov: Aov) -> f64 {
        let value = film.aov(aov).and_then(|values| values.get(self.at()));
        value.copied().unwrap_or(f64::NAN)
    }

    fn object(&self, film: &Film) -> Option<usize> {
        let object = self.value(film, Aov::Object);
        (object >= 0.0).then_some(object as usize)
    }

    fn hit(&self, scene: &Scene, index: usize, film: &Film, reception: &Reception) -> ProbeHit {
        let object: &Object = &scene.objects[index];
        let value = |aov| self.value(film, aov);
        let vector = |[x, y, z]: [Aov; 3]| DVec3::new(value(x), value(y), value(z));
        let place = vector([Aov::ObjectEventX, Aov::ObjectEventY, Aov::ObjectEventZ]);
        let zero = object.frame().event_to_world(Event::new(0.0, place));
        let track = Track::from(WorldLine::inertial(object.velocity, zero));
        let event = |moment: Option<crate::figures::diagram::model::Moment>| Some(moment?.event);
        ProbeHit {
            object: index,
            name: object.name.clone(),
            velocity: object.velocity,
            triangle: value(Aov::Primitive) as u32,
            emission: self.emission(film),
            time: value(Aov::ObjectEventCt),
            place,
            distance: value(Aov::Distance),
            ratio: value(Aov::WavelengthRatio),
            now: event(track.at_time(&reception.frame, 0.0)),
            now_in_world: event(track.where_zero(|e| e.ct - reception.event.ct)),
            track,
            pulses: Vec::new(),
        }
    }

    /// The pulses whose light is visible: each is rendered alone.
    fn pulses(&mut self, scene: &Scene, film: &Film) -> Result<Vec<PulseLight>> {
        let Some(light) = self.prepared.light.time_resolved() else {
            return Ok(Vec::new());
        };
        let all = light.lamps.clone();
        let emission = self.emission(film);
        let mut lamps = Vec::new();
        for (k, source) in scene.sources.iter().enumerate() {
            let SourceKind::Pulse(pulse) = &source.kind else {
                continue;
            };
            if let Some(light) = self.prepared.light.time_resolved_mut() {
                let alone = all
                    .iter()
                    .enumerate()
                    .map(|(i, lamp)| lamp.clone().filter(|_| i == k));
                light.lamps = alone.collect();
            }
            let film = self.film()?;
            let radiance: f64 = film.radiance()[self.at()].iter().sum();
            let way = scene.medium_index * (emission.x - pulse.origin.x).length();
            let left = Event::new(emission.ct - way, pulse.origin.x);
            lamps.push(PulseLight {
                name: source.name.clone(),
                left,
                deviations: (left.ct - pulse.origin.ct) / pulse.sigma,
                share: radiance,
            });
        }
        Ok(shares(lamps))
    }

    fn emission(&self, film: &Film) -> Event<World> {
        let value = |aov| self.value(film, aov);
        let x = DVec3::new(value(Aov::EventX), value(Aov::EventY), value(Aov::EventZ));
        Event::new(value(Aov::EventCt), x)
    }
}

/// Those that are seen, the brightest first, each with its part of the sum.
fn shares(mut lamps: Vec<PulseLight>) -> Vec<PulseLight> {
    let sum: f64 = lamps.iter().map(|lamp| lamp.share).sum();
    lamps.retain(|lamp| lamp.share > 0.0);
    lamps.iter_mut().for_each(|lamp| lamp.share /= sum);
    lamps.sort_by(|a, b| b.share.total_cmp(&a.share));
    lamps
}
