//! `nullray selftest`.

use clap::Args;

use super::shared::{Json, MemoryLimit, Threads};

#[derive(Debug, Args)]
#[command(mut_arg("max_memory", |it| it.help("Memory limit, also --memory; checks that take more are refused. Default: three quarters of what is available")))]
pub struct SelftestArguments {
    /// Use 10⁸ rays and a mesh of 10⁷ triangles: takes some minutes and 3 GB of memory.
    #[arg(long)]
    pub thorough: bool,
    /// Run only this check. Repeatable.
    #[arg(long, value_name = "NAME")]
    pub check: Vec<String>,
    #[command(flatten)]
    pub memory: MemoryLimit,
    #[command(flatten)]
    pub json: Json,
    #[command(flatten)]
    pub threads: Threads,
}
