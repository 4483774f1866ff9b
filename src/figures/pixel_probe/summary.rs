//! The numbers of a probe, for people and for programs.

use std::fmt;

use serde::Serialize;

use super::{Hit, Probe};
use crate::spacetime::{Event, World};

/// The numbers of a [`Probe`]; metres, times as ct, events (ct, x, y, z) in the world.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Column and row.
    pub pixel: [u32; 2],
    /// The camera's proper time at the reception.
    pub reception_proper_time: f64,
    /// The reception: at the sensor element, or at the pinhole of a point camera.
    pub reception: [f64; 4],
    /// The light's passage through the pinhole.
    pub pinhole: [f64; 4],
    /// The pinhole's proper time then.
    pub pinhole_proper_time: f64,
    /// β of the camera in the world.
    pub camera_beta: [f64; 3],
    /// The look direction in the world.
    pub direction: [f64; 3],
    /// Metres of ct per metre of the ray.
    pub refractive_index: f64,
    /// What is seen; none where the ray meets nothing.
    pub surface: Option<Surface>,
}

/// The surface that is seen.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Surface {
    /// The object's name.
    pub object: String,
    /// Its index in the scene.
    pub object_index: usize,
    /// Index of the triangle in the object.
    pub triangle: u32,
    /// β of the object in the world.
    pub beta: [f64; 3],
    /// The emission.
    pub emission: [f64; 4],
    /// The object's proper time then.
    pub emission_proper_time: f64,
    /// The point in the object's coordinates.
    pub object_position: [f64; 3],
    /// World distance from the pinhole's event to the emission.
    pub distance: f64,
    /// Observed / emitted wavelength.
    pub wavelength_ratio: f64,
    /// The event of the point that is simultaneous with the reception in the camera's frame.
    pub now_for_camera: Option<[f64; 4]>,
    /// The same in the world.
    pub now_in_world: Option<[f64; 4]>,
    /// The pulses whose light is seen, the brightest first.
    pub lit_by: Vec<Lit>,
}

/// A pulse whose light is seen.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Lit {
    /// Its name.
    pub source: String,
    /// The event at which the light left it.
    pub left: [f64; 4],
    /// How long after the pulse's centre that was, in its standard deviations.
    pub deviations: f64,
    /// Its part of the radiance from all pulses.
    pub share: f64,
}

impl Summary {
    /// The numbers of `probe`.
    pub fn of(probe: &Probe) -> Summary {
        let reception = &probe.reception;
        Summary {
            pixel: probe.pixel,
            reception_proper_time: reception.time,
            reception: four(reception.event),
            pinhole: four(reception.pinhole),
            pinhole_proper_time: reception.pinhole_time,
            camera_beta: reception.frame.velocity().beta().to_array(),
            direction: probe.direction.unit().to_array(),
            refractive_index: probe.index,
            surface: probe.hit.as_ref().map(Surface::of),
        }
    }
}

impl Surface {
    fn of(hit: &Hit) -> Surface {
        let lamps = hit.pulses.iter().map(|lamp| Lit {
            source: lamp.name.clone(),
            left: four(lamp.left),
            deviations: lamp.deviations,
            share: lamp.share,
        });
        Surface {
            object: hit.name.clone(),
            object_index: hit.object,
            triangle: hit.triangle,
            beta: hit.velocity.beta().to_array(),
            emission: four(hit.emission),
            emission_proper_time: hit.time,
            object_position: hit.place.to_array(),
            distance: hit.distance,
            wavelength_ratio: hit.ratio,
            now_for_camera: hit.now.map(four),
            now_in_world: hit.now_in_world.map(four),
            lit_by: lamps.collect(),
        }
    }
}

fn four(event: Event<World>) -> [f64; 4] {
    [event.ct, event.x.x, event.x.y, event.x.z]
}

/// Numbers to six digits after the point, in brackets.
struct Tuple<'a>(&'a [f64]);

impl fmt::Display for Tuple<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers: Vec<String> = self.0.iter().map(|number| format!("{number:.6}")).collect();
        write!(f, "({})", numbers.join(", "))
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [column, row] = self.pixel;
        writeln!(
            f,
            "pixel {column},{row}: events (ct, x, y, z) in the world, metres"
        )?;
        let reception = Tuple(&self.reception);
        writeln!(
            f,
            "  reception     {reception}, camera's clock {:.6}",
            self.reception_proper_time
        )?;
        if self.pinhole != self.reception {
            let pinhole = Tuple(&self.pinhole);
            writeln!(
                f,
                "  pinhole       {pinhole}, camera's clock {:.6}",
                self.pinhole_proper_time
            )?;
        }
        writeln!(f, "  looks along   {}", Tuple(&self.direction))?;
        if self.refractive_index != 1.0 {
            writeln!(
                f,
                "  light takes   {} m of ct per metre",
                self.refractive_index
            )?;
        }
        match &self.surface {
            Some(surface) => surface.fmt(f),
            None => writeln!(f, "  meets nothing"),
        }
    }
}

impl fmt::Display for Surface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = crate::spacetime::units::quoted(&self.object);
        writeln!(f, "  meets         {name}, triangle {}", self.triangle)?;
        let emission = Tuple(&self.emission);
        writeln!(
            f,
            "  emission      {emission}, object's clock {:.6}",
            self.emission_proper_time
        )?;
        writeln!(f, "  distance      {:.6}", self.distance)?;
        writeln!(f, "  W = λ′/λ      {:.6}", self.wavelength_ratio)?;
        let nows = [
            ("now, camera ", &self.now_for_camera),
            ("now, world  ", &self.now_in_world),
        ];
        for (what, event) in nows {
            if let Some(event) = event {
                writeln!(f, "  {what}  {}", Tuple(event))?;
            }
        }
        for lit in &self.lit_by {
            let name = crate::spacetime::units::quoted(&lit.source);
            let (left, share) = (Tuple(&lit.left), 100.0 * lit.share);
            let after = lit.deviations;
            writeln!(
                f,
                "  lit by        {name} to {share:.1} %: left {left}, {after:+.2} σ from the pulse's centre"
            )?;
        }
        Ok(())
    }
}
