//! The plan as text.

use std::fmt;

use super::{Plan, ViewKind};

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.scene)?;
        self.film(f)?;
        self.frames(f)?;
        self.cubes(f)?;
        self.cost(f)?;
        for skipped in &self.skipped {
            writeln!(f, "  skipped   {}: {}", skipped.what, skipped.why)?;
        }
        for note in &self.notes {
            writeln!(f, "  note      {note}")?;
        }
        Ok(())
    }
}

impl Plan {
    fn film(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.film.size;
        let view = match self.view {
            ViewKind::Still => "camera at rest",
            ViewKind::Moving => "moving camera",
            ViewKind::Unaberrated => "moving camera without aberration",
        };
        write!(
            f,
            "  film      {width} × {height} pixels, {} samples each, {view}",
            self.film.samples
        )?;
        if !self.film.channels.is_empty() {
            let names: Vec<_> = self.film.channels.iter().map(|a| a.name()).collect();
            write!(f, "; channels {}", names.join(", "))?;
        }
        writeln!(f)
    }

    fn frames(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for frame in &self.frames {
            let [x, y, z] = frame.beta;
            let motion = if frame.gamma == 1.0 {
                "at rest".into()
            } else {
                format!("β = ({x:.6}, {y:.6}, {z:.6}), γ = {:.6}", frame.gamma)
            };
            writeln!(f, "  frame     {motion}: {} triangles", frame.triangles)?;
            for object in frame.objects.iter().map(|o| &self.objects[*o]) {
                let file = object
                    .file
                    .as_ref()
                    .map_or("shape".into(), |p| p.display().to_string());
                let radiance = object.radiance.join("; ");
                writeln!(
                    f,
                    "    object  {} ({file}, {} triangles): {radiance}",
                    object.name, object.triangles
                )?;
            }
        }
        Ok(())
    }

    fn cubes(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for cube in self.cubes.iter().flatten() {
            let [h, w, t, c] = cube.shape;
            let size = bytes(cube.bytes);
            writeln!(
                f,
                "  cube      {} ({}): {h} × {w} texels, {t} bins, {c} channels, {size}",
                cube.source,
                cube.file.display()
            )?;
        }
        Ok(())
    }

    fn cost(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rays = &self.rays;
        writeln!(
            f,
            "  rays      {} from the camera, at most {} for shadows, {} from capture cameras",
            rays.camera, rays.shadow_at_most, rays.capture
        )?;
        let memory = &self.memory;
        writeln!(
            f,
            "  memory    {}: geometry {}, cubes {}, film {}",
            bytes(memory.total()),
            bytes(memory.geometry),
            bytes(memory.cubes),
            bytes(memory.film)
        )
    }
}

/// A number of bytes for people.
pub(super) fn bytes(n: u64) -> String {
    const UNITS: [&str; 5] = ["B", "KiB", "MiB", "GiB", "TiB"];
    let mut value = n as f64;
    let mut unit = 0;
    while value >= 1024.0 && unit + 1 < UNITS.len() {
        value /= 1024.0;
        unit += 1;
    }
    if unit == 0 {
        format!("{n} B")
    } else {
        format!("{value:.1} {}", UNITS[unit])
    }
}
