//! Quantities derived from a scene: conversions, frames, world lines.

use glam::DVec3;

use super::model::{
    Assembly, CameraModel, Exposure, Lamp, Motion, Object, Scene, Sensor, Sheet, Sky, SkyRadiance,
};
use super::text::Text;
use crate::spacetime::worldline::{WorldLine, WorldLineError};
use crate::spacetime::{CameraFrame, Event, Hue, InertialFrame, Quantity, Rest, Velocity, World};

impl CameraModel {
    /// The frame in which the camera rests when its clock shows 0; for a camera without acceleration, at all times. Its origin is the
    /// pinhole at that moment.
    pub fn frame(&self) -> InertialFrame<CameraFrame> {
        InertialFrame::new(self.velocity, self.origin)
    }

    /// The world line of the pinhole, whose proper time is the camera's clock.
    ///
    /// # Errors
    /// The motion would need the speed of light or more; this cannot happen to a camera from a scene file.
    pub fn world_line(&self) -> Result<WorldLine, WorldLineError> {
        self.motion.world_line(self.velocity, self.origin)
    }

    /// The camera with the shot at another time of its clock: one of a glTF file is turned as its animated node is at that world time.
    pub fn at(&self, time: f64) -> CameraModel {
        let mut camera = self.clone();
        camera.time = time;
        if let Some(turning) = &self.turning
            && let Some(shot) = self.world_line().ok().and_then(|line| line.state(time))
        {
            // Keys of a glTF file are seconds of the world.
            let seconds = shot.event.ct / turning.speed_of_light;
            let turn = turning.track.rotation(seconds);
            camera.axes = turning.axes.map(|axis| turn * axis);
        }
        camera
    }

    /// Half the width and half the height of the sensor, metres; `None` for a point camera.
    pub fn sensor_half_size(&self) -> Option<[f64; 2]> {
        let width = self.sensor?.focal_length * libm::tan(0.5 * self.horizontal_fov);
        let [columns, rows] = self.size.map(f64::from);
        Some([width, width * rows / columns])
    }

    /// The corners of the sensor relative to the pinhole in the camera frame, metres, when the camera has [`CameraModel::velocity`];
    /// `None` for a point camera.
    pub fn sensor_corners(&self) -> Option<[DVec3; 4]> {
        let [right, up, forward] = self.axes;
        let [width, height] = self.sensor_half_size()?;
        let distance = self.sensor?.own_focal_length(forward, self.velocity);
        let corner = |x: f64, y: f64| right * (x * width) + up * (y * height) - forward * distance;
        Some([
            corner(-1.0, 1.0),
            corner(1.0, 1.0),
            corner(1.0, -1.0),
            corner(-1.0, -1.0),
        ])
    }
}

impl Lamp {
    /// Its world line, whose proper time is its clock.
    ///
    /// # Errors
    /// As [`CameraModel::world_line`].
    pub fn world_line(&self) -> Result<WorldLine, WorldLineError> {
        self.motion.world_line(self.velocity, self.origin)
    }
}

impl Scene {
    /// The text with its overrides, and that of the file.
    pub(crate) fn text_and_file(&self) -> Text {
        Text {
            edited: self.text.as_str().into(),
            file: self.file_text.clone(),
        }
    }

    /// The scene without its name, its text and the places there, and without how its pictures are shown: what samples depend on.
    pub fn unshown(&self) -> Scene {
        let mut scene = Scene {
            name: String::new(),
            text: String::new(),
            file_text: "".into(),
            bits: 8,
            times: None,
            luminances: None,
            flash_times: None,
            caption: None,
            exposure: Exposure::default(),
            passed_over: Vec::new(),
            panels: Vec::new(),
            sheet: Sheet::default(),
            ..self.clone()
        };
        // Where an entry stands in the file moves with any edit above it.
        let objects = scene.objects.iter_mut().map(|object| &mut object.span);
        let lights = scene.lights.iter_mut().map(|light| &mut light.span);
        let sources = scene.sources.iter_mut().map(|source| &mut source.span);
        let sky = scene.sky.iter_mut().map(|sky| &mut sky.span);
        for span in objects.chain(lights).chain(sources).chain(sky) {
            *span = 0..0;
        }
        scene
    }

    /// Whether any colours depend on wavelengths: those of lines, of spectra, and of RGB that represents a spectrum, which the Doppler
    /// shift changes.
    pub fn sees_wavelengths(&self) -> bool {
        let sources = self.sources.iter().map(|source| source.quantity);
        let is_seen = |quantity: Quantity| match quantity.hue() {
            Hue::Stays => false,
            Hue::OfLine => true,
            Hue::OfSpectrum => self.effects.doppler,
        };
        let has_spectra = |sky: &Sky| {
            matches!(sky.background, SkyRadiance::Spectrum(_))
                || (sky.stars.is_some() && self.quantity == Quantity::Rgb)
        };
        sources.chain([self.quantity]).any(is_seen)
            || self.objects.iter().any(|object| object.spectrum.is_some())
            || self.sky.as_ref().is_some_and(has_spectra)
    }

    /// Whether lights or a sky illuminate its surfaces: base colours are then reflectances, not radiances.
    pub fn is_lit(&self) -> bool {
        !self.lights.is_empty() || self.sky.as_ref().is_some_and(|sky| sky.lights)
    }
}

impl Motion {
    /// The world line with this motion that has `velocity` at `zero`, where its clock shows 0. Paths in the world (keyframes, animations,
    /// circles) define their own velocity, and keyframes their own beginning.
    ///
    /// # Errors
    /// The motion would need the speed of light or more.
    pub fn world_line(
        &self,
        velocity: Velocity,
        zero: Event<World>,
    ) -> Result<WorldLine, WorldLineError> {
        match self {
            Motion::Inertial => Ok(WorldLine::inertial(velocity, zero)),
            Motion::Accelerated(a) => WorldLine::hyperbolic(velocity, zero, *a),
            Motion::Segments(segments) => WorldLine::segments(velocity, zero, segments),
            Motion::Profile { knots, axes } => WorldLine::profile(velocity, zero, knots, *axes),
            Motion::Keyframes(events) => WorldLine::keyframes(events),
            Motion::Animation { events, velocities } => WorldLine::animation(events, velocities),
            Motion::Circular { centre, axis, rate } => {
                WorldLine::circular(zero, *centre, *axis, *rate)
            }
        }
    }
}

impl Sensor {
    /// The focal length in the frame of a camera that looks along `forward` (unit vector of that frame)
    /// and momentarily moves with `velocity`, metres.
    ///
    /// A rod of the proper length d′ at the angle α to its velocity has the world length
    /// d = d′ √(1 − β² cos² α) = d′ √(1 + γ²β² sin² α) / γ. Where d is that of the file, d′ is the
    /// focal length: γ d along the motion, d across it.
    pub fn own_focal_length(&self, forward: DVec3, velocity: Velocity) -> f64 {
        if self.assembly == Assembly::Rigid || velocity.is_rest() {
            return self.focal_length;
        }
        // √(1 + γ²β² sin² α), with γβ = sinh w.
        let (n, w) = velocity.split();
        let across = libm::sinh(w) * forward.cross(n).length();
        self.focal_length * velocity.gamma() / libm::hypot(1.0, across)
    }
}

impl Object {
    /// The object's rest frame, in the coordinates that [`Object::transform`] leads to.
    pub fn frame(&self) -> InertialFrame<Rest> {
        InertialFrame::new(self.velocity, self.origin)
    }
}
