//! The result of a comparison for people: a table, maps, strips, and a page with all of them.

mod html;
mod pictures;
mod table;

pub use html::page;
pub use pictures::{ErrorMap, error_map, maps, strip};
pub use table::table;
