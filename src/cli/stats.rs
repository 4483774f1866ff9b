//! The cost of a command over all pictures that it rendered: a table, and the same as JSON.

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
    /// Wall-clock seconds: files, trees, pictures.
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
    /// Records that a scene was prepared.
    pub fn prepared(&mut self, preparation: Preparation) {
        self.loaded_in += preparation.seconds - preparation.built_in;
        self.built_in += preparation.built_in;
    }

    /// Records a picture.
    pub fn picture(&mut self, stats: Stats, seconds: f64) {
        self.pictures += 1;
        self.rendered_in += seconds;
        self.stats.merge(stats);
    }

    fn total(&self) -> f64 {
        self.loaded_in + self.built_in + self.rendered_in
    }

    /// The table.
    pub fn table(&self) -> String {
        let stats = &self.stats;
        let mut rows = vec![
            row("pictures", &plan::count(self.pictures)),
            row("camera rays", &plan::count(stats.rays)),
            row("hits", &plan::count(stats.hits)),
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
            rows.push(row("read of cubes on disk", &plan::bytes(all)));
            rows.push(row("read again", &plan::bytes(again)));
        }
        rows.push(row("loading", &seconds(self.loaded_in)));
        rows.push(row("building trees", &seconds(self.built_in)));
        rows.push(row("rendering", &seconds(self.rendered_in)));
        rows.push(row("in all, without writing", &seconds(self.total())));
        rows.push("time while rendering, summed over threads\n".into());
        for stage in Stage::ALL {
            let [spent, share, per_ray] = self.stage(stage);
            let text = format!(
                "{:<10} {:5.1} % {per_ray:8.2} ns per ray",
                seconds(spent),
                100.0 * share
            );
            rows.push(row(stage.name(), &text));
        }
        rows.concat()
    }

    /// The seconds of a stage, its share of the total, and its nanoseconds per ray.
    fn stage(&self, stage: Stage) -> [f64; 3] {
        let spent = self.stats.seconds[stage as usize];
        // 0, not NaN, without a ray or measured time.
        let share = spent / self.stats.total_seconds().max(f64::MIN_POSITIVE);
        let per_ray = 1e9 * spent / (self.stats.rays.max(1)) as f64;
        [spent, share, per_ray]
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
            .map(|stage| {
                let [seconds, share, ns_per_ray] = self.stage(*stage);
                let numbers = serde_json::json!({
                    "seconds": seconds,
                    "share": share,
                    "ns_per_ray": ns_per_ray,
                });
                (stage.name().replace(' ', "_"), numbers)
            })
            .collect();
        serde_json::json!({
            "pictures": self.pictures,
            "camera_rays": stats.rays,
            "camera_rays_hit": stats.hits,
            "visibility": counts(&stats.visibility),
            "shadows": counts(&stats.occlusion),
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
            "stages": stages,
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
        named("single rays", counts.singles),
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
