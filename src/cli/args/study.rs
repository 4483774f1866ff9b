//! `nullray study`.

use std::path::PathBuf;

use clap::Args;
use nullray::scene::model::MOST_SAMPLES;
use nullray::validate::study;

use super::shared::{SceneArguments, WorkArguments};
use crate::cli::values;
use crate::cli::values::{MethodList, SampleList};

#[derive(Debug, Args)]
pub struct StudyArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Where to write: .csv, .json, or the plot as .svg, .pdf, .png. Repeatable.
    /// Default: the scene's name with -study.csv, -study.json and -study.svg, in the current directory.
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// The methods, separated by semicolons or spaces: those of render's --method, and trace:fast.
    #[arg(long, value_name = "LIST", default_value = study::METHODS, value_parser = values::methods)]
    pub methods: MethodList,
    /// Numbers of samples per pixel to measure each method with.
    #[arg(long, value_name = "LIST", default_value = "1,4,16,64", value_parser = values::samples, allow_hyphen_values = true)]
    pub samples: SampleList,
    /// Runs of each method and number of samples, as far as the budget allows.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=10_000), allow_negative_numbers = true)]
    pub runs: u32,
    /// Time limit for the measurements, not counting the reference: "60 s", "5 min" or "1 h"; without a unit, in seconds.
    #[arg(long, value_name = "TIME", default_value = "60 s", value_parser = values::work_time, allow_hyphen_values = true)]
    pub budget: f64,
    /// Samples per pixel of the reference picture.
    #[arg(long, value_name = "N", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_SAMPLES)), allow_negative_numbers = true)]
    pub reference_spp: u32,
    #[command(flatten)]
    pub work: WorkArguments,
}
