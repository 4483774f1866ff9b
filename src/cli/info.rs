//! `nullray info`.
use nullray::Result;
use super::args::InfoArguments;
pub fn run(_: &InfoArguments) -> Result<()> { Ok(()) }
