//! Arguments of `nullray export` and `nullray study`.

use std::path::PathBuf;

use clap::Args;
use nullray::scene::model::MOST_SAMPLES;
use nullray::validate::study::{self, Subject};

use super::{Changes, values};

#[derive(Debug, Args)]
pub struct ExportArguments {
    /// The scene file (TOML). Default: the built-in scene.
    #[arg(value_name = "SCENE")]
    pub scene: Option<PathBuf>,
    #[command(flatten)]
    pub changes: Changes,
    /// The directory to write. It appears when it is complete.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Export this panel of the scene; the scene as it stands without it.
    #[arg(long, value_name = "NAME")]
    pub panel: Option<String>,
    /// Render no reference pictures.
    #[arg(long)]
    pub no_reference: bool,
    /// What becomes of stored cubes: copied, or named with their SHA-256.
    #[arg(long, value_name = "WHAT", default_value = "copy")]
    pub cubes: CubesArgument,
    /// Replace an export of this name.
    #[arg(long)]
    pub overwrite: bool,
    /// Worker threads. Default: one per core. What is written does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Debug, Args)]
pub struct StudyArguments {
    /// The scene file (TOML). Default: the built-in scene.
    #[arg(value_name = "SCENE")]
    pub scene: Option<PathBuf>,
    #[command(flatten)]
    pub changes: Changes,
    /// Where to write: .csv, .json, or the plot as .svg, .pdf, .png. Repeatable.
    /// Default: the scene's name with -study.csv, -study.json and -study.svg, in the current directory.
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// The methods, separated by semicolons or spaces, as --method of render has them; trace:fast too.
    #[arg(long, value_name = "LIST", default_value = study::METHODS, value_parser = values::methods)]
    pub methods: MethodList,
    /// Samples per pixel that each is measured with.
    #[arg(long, value_name = "LIST", default_value = "1,4,16,64", value_parser = values::samples)]
    pub samples: SampleList,
    /// Pictures of each method and number of samples, as far as the budget goes.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub runs: u32,
    /// For how many seconds to measure, not counting the reference.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = values::seconds)]
    pub budget: f64,
    /// Samples per pixel of the picture that radiance is compared with.
    #[arg(long, value_name = "N", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_SAMPLES)))]
    pub reference_spp: u32,
    /// Study this panel of the scene; the scene as it stands without it.
    #[arg(long, value_name = "NAME")]
    pub panel: Option<String>,
    /// Worker threads. Default: one per core.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
}

/// Methods of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodList(pub Vec<Subject>);

/// Numbers of samples of a study.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SampleList(pub Vec<u32>);

/// What becomes of stored cubes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum CubesArgument {
    /// Copied into the bundle.
    Copy,
    /// Named with their SHA-256.
    Reference,
}
