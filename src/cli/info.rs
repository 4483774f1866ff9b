//! `nullray info`.
use super::args::InfoArguments;
use nullray::Result;
pub fn run(_: &InfoArguments) -> Result<()> {
    Ok(())
}
