//! The arguments: one file per command, and one for options that several commands share. One definition yields the parser, the help, the
//! man pages and the completions.

mod bake;
mod compare;
mod convert;
mod diagram;
mod export;
mod film;
mod info;
mod mesh_from_depth;
mod page;
mod plan;
mod render;
mod selftest;
mod shared;
mod sheet;
mod study;
mod tessellation;

use std::path::PathBuf;

use clap::{Parser, Subcommand};

use super::help;

pub use bake::{BakeArguments, GoalArguments};
pub use compare::CompareArguments;
pub use convert::{ConvertArguments, SampleType};
pub use diagram::{DiagramArguments, Origin};
pub use export::{CubesArgument, ExportArguments};
pub use film::{Beside, FilmArguments, MotionArguments};
pub use info::InfoArguments;
pub use mesh_from_depth::{DepthKind, MeshFromDepthArguments};
pub use page::PageArguments;
pub use plan::PlanArguments;
pub use render::{FrameArguments, PassArguments, RenderArguments};
pub use selftest::SelftestArguments;
pub use shared::{Changes, WorkArguments};
pub use sheet::SheetArguments;
pub use study::StudyArguments;
pub use tessellation::TessellationArguments;

/// Reference renderer for special relativity and time-resolved light.
///
/// Without a command it renders the built-in scene.
#[derive(Debug, Parser)]
#[command(name = "nullray", version, max_term_width = 100, after_help = help::PROGRAM)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene to pictures.
    #[command(after_help = help::RENDER, after_long_help = help::render_long())]
    Render(Box<RenderArguments>),
    /// Make a film of a scene in one line: a fly-by, an acceleration, a row of speeds, or light in flight.
    #[command(after_help = help::FILM)]
    Film(Box<FilmArguments>),
    /// Make an HTML page with a slider for the speed of the camera; it needs no network.
    #[command(after_help = help::PAGE)]
    Page(Box<PageArguments>),
    /// Render the panels of scenes to contact sheets: one labelled page for each scene.
    #[command(after_help = help::SHEET)]
    Sheet(SheetArguments),
    /// Bake the light of pulsed lamps, with its delays and bounces, into cubes for [[source]]; lamps and objects must be at rest relative
    /// to each other.
    #[command(after_help = help::BAKE)]
    Bake(BakeArguments),
    /// Draw the space-time diagram of a scene's world lines, or of a file's own [diagram].
    #[command(after_help = help::DIAGRAM)]
    Diagram(Box<DiagramArguments>),
    /// Write a scene as a bundle for other programs: geometry, camera, sources, reference pictures.
    #[command(after_help = help::EXPORT)]
    Export(ExportArguments),
    /// Convert a cube of time-resolved data: its format, axes, part, bins, precision, clock.
    #[command(after_help = help::CONVERT)]
    Convert(ConvertArguments),
    /// Make a mesh from what a capture camera measured along its pixels' rays: when light first came back, or distances.
    #[command(after_help = help::MESH_FROM_DEPTH)]
    MeshFromDepth(MeshFromDepthArguments),
    /// Compare a picture with its reference: errors, maps, a report, tolerances.
    #[command(after_help = help::compare())]
    Compare(CompareArguments),
    /// Print what a render would load and compute, and what it skips and why, without loading anything heavy.
    #[command(after_help = help::PLAN)]
    Plan(PlanArguments),
    /// Predict how finely a rasterizer has to tessellate the objects of a scene.
    #[command(after_help = help::TESSELLATION)]
    Tessellation(TessellationArguments),
    /// Show what a file holds: glTF, npy, npz, ti, exr, png, hdr, csv, a scene, or a folder of pictures; as features of the build also HDF5
    /// (.h5, .mat), tif and Zarr.
    #[command(after_help = help::INFO)]
    Info(InfoArguments),
    /// Test this build on this machine: numbers against arbitrary precision, meshes for gaps that rays slip through.
    #[command(after_help = help::SELFTEST)]
    Selftest(SelftestArguments),
    /// Measure run time against error: ray tracer, rasterizers, warped pictures.
    #[command(after_help = help::STUDY)]
    Study(StudyArguments),
    /// Print the JSON schema of the scene file, for editors.
    Schema,
    /// Print completions for a shell.
    Completions {
        /// Which shell.
        shell: clap_complete::Shell,
    },
    /// Print the manual page, or write one page per command into a directory.
    Man {
        /// Where to write nullray.1, nullray-render.1, …; created if it does not exist.
        #[arg(long, value_name = "DIR")]
        directory: Option<PathBuf>,
    },
}

#[cfg(test)]
mod tests;
