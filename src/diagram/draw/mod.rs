use super::layout::Layout;
use crate::drawing::Drawing;
use crate::error::Result;
use crate::scene::model::diagram::Style;
pub fn draw(_l: &Layout, _s: &Style) -> Result<Drawing> {
    todo!()
}
