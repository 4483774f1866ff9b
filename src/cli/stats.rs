//! What a command has cost, over all pictures that it rendered: a table, and the same as JSON.

use std::io::Write;
use std::path::Path;

use nullray::io::cube::BytesRead;
use nullray::io::image::write_atomically;
use nullray::render::plan;
use nullray::render::trace::{Stage, Stats};
use nullray::{Error, Result, accel::Counts};

/// The cost of pictures.
#[derive(Debug, Default)]
pub struct Account {
    pictures: u64,
    /// Seconds on the wall's clock: files, trees, pictures.
    loaded_in: f64,
    built_in: f64,
    rendered_in: f64,
    stats: Stats,
}

/// Seconds that a scene took to prepare.
#[derive(Debug, Clone, Copy, Default)]
pub struct Preparation {
    /// All of it.
    pub seconds: f64,
    /// The part that was spent on trees.
    pub built_in: f64,
}

impl Account {
    /// Notes that a scene was prepared.
    pub fn prepared(&mut self, preparation: Preparation) {
        self.loaded_in += preparation.seconds - preparation.built_in;
        self.built_in += preparation.built_in;
    }

    /// Notes a picture.
    pub fn picture(&mut self, stats: Stats, seconds: f64) {
        self.pictures += 1;
        self.rendered_in += seconds;
        self.stats.merge(stats);
    }

    fn total(&self) -> f64 {
        self.loaded_in + self.built_in + self.rendered_in
    }

    /// As a table.
    pub fn table(&self) -> String {
        let stats = &self.stats;
        let mut rows = vec![
            row("pictures", &plan::count(self.pictures)),
            row("camera rays", &plan::count(stats.rays)),
            row("of them hit", &plan::count(stats.hits)),
        ];
        rows.extend(work("visibility", &stats.visibility));
        if stats.occlusion.rays > 0 {
            rows.extend(work("shadows", &stats.occlusion));
        }
        rows.push(row(
            "bytes of time data read",
            &plan::bytes(stats.texture_bytes),
        ));
        if stats.disk.all > 0 {
            let BytesRead { all, again, .. } = stats.disk;
            rows.push(row("needed of cubes on disk", &plan::bytes(all - again)));
            rows.push(row("read of them", &plan::bytes(all)));
            rows.push(row("read again", &plan::bytes(again)));
        }
        rows.push(row("files", &seconds(self.loaded_in)));
        rows.push(row("trees", &seconds(self.built_in)));
        rows.push(row("rendering", &seconds(self.rendered_in)));
        rows.push(row("total", &seconds(self.total())));
        rows.push("processor time while rendering, all threads\n".into());
        for stage in Stage::ALL {
            rows.push(self.stage(stage));
        }
        rows.concat()
    }

    fn stage(&self, stage: Stage) -> String {
        let spent = self.stats.seconds[stage as usize];
        // Without a ray or a measured second the shares are 0, not NaN.
        let share = 100.0 * spent / self.stats.total_seconds().max(f64::MIN_POSITIVE);
        let per_ray = 1e9 * spent / (self.stats.rays.max(1)) as f64;
        let text = format!(
            "{:<10} {share:5.1} % {per_ray:8.2} ns per ray",
            seconds(spent)
        );
        row(stage.name(), &text)
    }

    /// Writes the same as a JSON object.
    pub fn write(&self, path: &Path) -> Result<()> {
        let text = serde_json::to_string_pretty(&self.json())
            .map_err(|e| Error::invalid(path, "", e.to_string(), "numbers that JSON can hold"))?;
        write_atomically(path, |file| {
            let written = writeln!(file, "{text}");
            written.map_err(Error::io(path, "cannot write"))
        })
    }

    /// The numbers of the table as JSON, times in seconds.
    fn json(&self) -> serde_json::Value {
        let stats = &self.stats;
        let stages: serde_json::Map<_, _> = Stage::ALL
            .iter()
            .filter_map(|stage| {
                let name = serde_json::to_value(stage).ok()?.as_str()?.to_string();
                Some((name, stats.seconds[*stage as usize].into()))
            })
            .collect();
        serde_json::json!({
            "pictures": self.pictures,
            "camera_rays": stats.rays,
            "camera_rays_met": stats.hits,
            "visibility": counts(&stats.visibility),
            "occlusion": counts(&stats.occlusion),
            "texture_bytes": stats.texture_bytes,
            "disk_bytes": {
                "needed": stats.disk.all - stats.disk.again,
                "read": stats.disk.all,
                "read_again": stats.disk.again,
            },
            "seconds": {
                "load": self.loaded_in,
                "build": self.built_in,
                "render": self.rendered_in,
                "total": self.total(),
            },
            "stage_processor_seconds": stages,
        })
    }
}

fn row(name: &str, text: &str) -> String {
    format!("  {name:<30}{text}\n")
}

fn seconds(seconds: f64) -> String {
    format!("{seconds:.4} s")
}

/// Rows about rays of one kind.
fn work(kind: &str, counts: &Counts) -> [String; 6] {
    let named = |name: &str, n: u64| row(&format!("{kind}: {name}"), &plan::count(n));
    [
        named("rays", counts.rays),
        named("singly", counts.singles),
        named("nodes", counts.nodes),
        named("triangles", counts.triangles),
        named("f64 fall-backs", counts.doubts),
        named("exact fall-backs", counts.exact),
    ]
}

fn counts(counts: &Counts) -> serde_json::Value {
    serde_json::json!({
        "rays": counts.rays,
        "single_rays": counts.singles,
        "node_visits": counts.nodes,
        "triangle_tests": counts.triangles,
        "f64_fallbacks": counts.doubts,
        "exact_fallbacks": counts.exact,
    })
}
