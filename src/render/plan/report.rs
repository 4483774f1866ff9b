//! The plan as text, for people: short whatever the size of the scene. The JSON is complete.

use std::fmt::{self, Formatter, Write};
use std::path::Path;

use super::planned::{Plan, PlannedFrame, PlannedObject};
use crate::accel::{Precision, Preset};
use crate::camera::ViewKind;

/// The most entries of a list that are shown one by one.
const MOST: usize = 8;

/// The plan of a bake of surfaces, without a picture, as text.
#[derive(Debug)]
pub struct OfSurfaces<'a>(&'a Plan);

impl fmt::Display for OfSurfaces<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let plan = self.0;
        writeln!(f, "{}", plan.scene.escape_debug())?;
        plan.frames(f)?;
        plan.cubes(f)?;
        row(f, "trees", plan.effort())?;
        plan.memory(f)?;
        plan.notes.iter().try_for_each(|note| row(f, "note", note))
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.scene.escape_debug())?;
        self.film(f)?;
        self.frames(f)?;
        self.cubes(f)?;
        self.cost(f)?;
        self.memory(f)?;
        for skipped in self.skipped.iter().take(2 * MOST) {
            row(
                f,
                "skipped",
                &format!("{}: {}", skipped.what.escape_debug(), skipped.why),
            )?;
        }
        more(f, "skipped", self.skipped.len(), 2 * MOST, "")?;
        for note in &self.notes {
            row(f, "note", note)?;
        }
        Ok(())
    }
}

impl Plan {
    /// The same without film and camera, for a bake of surfaces.
    pub fn of_surfaces(&self) -> OfSurfaces<'_> {
        OfSurfaces(self)
    }

    /// Size, samples, camera, and requested channels.
    fn film(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [width, height] = self.film.size;
        let view = match self.view {
            ViewKind::Still => "camera at rest",
            ViewKind::Moving => "moving camera",
            ViewKind::Unaberrated => "moving camera without aberration",
            ViewKind::Inertial => "a separate event for each sample's ray",
            ViewKind::Accelerated => "accelerated camera, a separate event for each sample",
            ViewKind::Turning => "rotating sensor, a separate event and velocity for each sample",
            ViewKind::Stereo => "stereo pair, a pinhole for each half",
            ViewKind::Paper => "camera by the equations of 2015",
        };
        let blind = match self.has_blind_points {
            true => ", parts of the film see nothing",
            false => "",
        };
        let samples = match (self.film.samples, self.film.pixel_centers) {
            (_, true) => "a ray through the centre of each".into(),
            (1, false) => "1 sample each".into(),
            (n, false) => format!("{n} samples each"),
        };
        row(
            f,
            "film",
            &format!("{width} × {height} pixels, {samples}, {view}{blind}"),
        )?;
        let names: Vec<_> = self.film.channels.iter().map(|a| a.name()).collect();
        match names.as_slice() {
            [] => Ok(()),
            names => row(f, "channels", &names.join(", ")),
        }
    }

    fn frames(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for frame in self.frames.iter().take(2 * MOST) {
            self.frame(f, frame)?;
        }
        let hidden = self.frames.iter().skip(2 * MOST);
        let triangles = hidden.map(|frame| frame.triangles).sum();
        let triangles = count_of(triangles, "triangle");
        more(f, "frame", self.frames.len(), 2 * MOST, &triangles)
    }

    fn frame(&self, f: &mut Formatter<'_>, frame: &PlannedFrame) -> fmt::Result {
        let motion = motion(frame.beta, frame.gamma);
        let objects = count_of(frame.objects.len() as u64, "object");
        let triangles = count_of(frame.triangles, "triangle");
        row(f, "frame", &format!("{motion}: {objects}, {triangles}"))?;
        let mut objects = frame.objects.iter().filter_map(|o| self.objects.get(*o));
        for object in objects.by_ref().take(MOST) {
            row(f, "  object", &describe(object))?;
        }
        let triangles = count_of(objects.map(|o| o.triangles).sum(), "triangle");
        more(f, "  object", frame.objects.len(), MOST, &triangles)
    }

    fn cubes(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let cubes: Vec<_> = self.cubes.iter().flatten().collect();
        for cube in cubes.iter().take(MOST) {
            let [h, w, t, c] = cube.shape;
            let channels = match &cube.channels {
                Some(names) => format!("channels {}", names.join(", ")),
                None => count_of(c as u64, "channel"),
            };
            let text = format!(
                "{} ({}): {h} rows × {w} columns × {t} time bins, {channels}, {}",
                cube.source.escape_debug(),
                file_name(cube.file.as_deref(), "in memory").escape_debug(),
                bytes(cube.bytes)
            );
            row(f, "cube", &text)?;
            if let Some(held) = cube.held {
                row(f, "", &in_parts(held, cube.read))?;
            }
        }
        let size = cubes.iter().skip(MOST).map(|c| c.bytes).sum();
        more(f, "cube", cubes.len(), MOST, &bytes(size))
    }

    /// What trees are built for, in words.
    fn effort(&self) -> &'static str {
        match self.trees {
            Preset::Quick => "built quickly, for few rays per triangle",
            Preset::Balanced => "built with care, for many rays per triangle",
            Preset::Thorough => "built with most care, for very many rays per triangle",
        }
    }

    /// Rays by purpose.
    fn cost(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let rays = &self.rays;
        let mut text = format!("{} from the camera", count(rays.camera));
        if rays.shadow_at_most > 0 {
            let _ = write!(text, ", at most {} for shadows", count(rays.shadow_at_most));
        }
        if rays.bounces_at_most > 0 {
            let _ = write!(
                text,
                ", at most {} continued from surfaces",
                count(rays.bounces_at_most)
            );
        }
        if rays.capture > 0 {
            let _ = write!(text, ", {} from capture cameras", count(rays.capture));
        }
        if self.film.precision == Precision::Fast {
            text += "; fast: in f32, for previews";
        }
        row(f, "rays", &text)?;
        match self.objects.is_empty() {
            true => Ok(()),
            false => row(f, "trees", self.effort()),
        }
    }

    fn memory(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let memory = &self.memory;
        let sky = match memory.sky {
            0 => String::new(),
            sky => format!(", sky {}", bytes(sky)),
        };
        let text = format!(
            "about {}: geometry {}, cubes {}{sky}, film {}, temporarily {}",
            bytes(memory.total()),
            bytes(memory.geometry),
            bytes(memory.cubes),
            bytes(memory.film),
            bytes(memory.temporary)
        );
        let text = match memory.beside {
            0 => text,
            beside => format!("{text}, beside the picture {}", bytes(beside)),
        };
        let text = match memory.program {
            0 => text,
            program => format!("{text}, the program itself {}", bytes(program)),
        };
        row(f, "memory", &text)
    }
}

/// How a cube is read that is not loaded whole.
fn in_parts(held: u64, read: Option<u64>) -> String {
    let held = format!("read from disk in parts, {} at a time", bytes(held));
    match read {
        Some(read) => format!("{held}: about {} of it are needed", bytes(read)),
        None => held,
    }
}

fn describe(object: &PlannedObject) -> String {
    let file = file_name(object.file.as_deref(), object.without_file);
    let holes = match object.has_masks {
        true => ", holes by alpha masks",
        false => "",
    };
    format!(
        "{} ({}, {}{holes}): {}",
        object.name.escape_debug(),
        file.escape_debug(),
        count_of(object.triangles, "triangle"),
        object.radiance.join("; ").escape_debug()
    )
}

fn file_name(file: Option<&Path>, without: &str) -> String {
    file.map_or_else(|| without.to_string(), |path| path.display().to_string())
}

fn row(f: &mut Formatter<'_>, label: &str, text: &str) -> fmt::Result {
    writeln!(f, "  {label:<10}{text}")
}

/// A row for the entries of a list that are not shown.
fn more(f: &mut Formatter<'_>, label: &str, all: usize, shown: usize, what: &str) -> fmt::Result {
    let hidden = all.saturating_sub(shown) as u64;
    match (hidden, what) {
        (0, _) => Ok(()),
        (n, "") => row(f, label, &format!("… and {} more", count(n))),
        (n, what) => row(f, label, &format!("… and {} more: {what}", count(n))),
    }
}

/// "1 object", "2 objects".
pub fn count_of(n: u64, noun: &str) -> String {
    let plural = if n == 1 { "" } else { "s" };
    format!("{} {noun}{plural}", count(n))
}

/// A velocity for people: "at rest", or β and γ.
pub fn motion(beta: [f64; 3], gamma: f64) -> String {
    if gamma == 1.0 && beta == [0.0; 3] {
        return "at rest".into();
    }
    // 12 decimals show every digit that people write, without the rounding.
    let [x, y, z] = beta.map(|b| short(b, 12));
    let gamma = if gamma < 1e6 {
        short(gamma, 6)
    } else {
        format!("{gamma:.6e}")
    };
    format!("β = ({x}, {y}, {z}), γ = {gamma}")
}

/// `x` with at most `digits` decimals, without trailing zeros.
fn short(x: f64, digits: usize) -> String {
    let text = format!("{x:.digits$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    match text {
        "-0" => "0".into(),
        text => text.into(),
    }
}

/// A whole number for people: "6,400,000".
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

pub use crate::io::budget::amount as bytes;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped_by_thousands() {
        let texts = [0, 999, 1000, 6_400_000].map(count);
        assert_eq!(texts, ["0", "999", "1,000", "6,400,000"]);
    }

    #[test]
    fn velocities_are_shown_as_they_were_written() {
        assert_eq!(motion([0.0; 3], 1.0), "at rest");
        let text = motion([0.49999999999999994, -0.0, -1e-20], 1.1547005383792515);
        assert_eq!(text, "β = (0.5, 0, 0), γ = 1.154701");
    }
}
