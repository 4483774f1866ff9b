//! Pair kerning from the GPOS table.

use ttf_parser::gpos::{PairAdjustment, PositioningSubtable};
use ttf_parser::{Face, GlyphId};

/// By how much `second` moves towards or away from `first`, font units. The embedded fonts have no
/// lookups other than those of kerning.
pub(super) fn kerning(face: &Face, first: GlyphId, second: GlyphId) -> i32 {
    let Some(gpos) = face.tables().gpos else {
        return 0;
    };
    let of_lookup = |lookup: ttf_parser::opentype_layout::Lookup| {
        let subtables = lookup.subtables.into_iter::<PositioningSubtable>();
        // The first subtable that knows the pair decides.
        subtables
            .filter_map(|subtable| pair(subtable, first, second))
            .next()
            .unwrap_or(0)
    };
    gpos.lookups.into_iter().map(of_lookup).sum()
}

fn pair(subtable: PositioningSubtable, first: GlyphId, second: GlyphId) -> Option<i32> {
    let PositioningSubtable::Pair(pair) = subtable else {
        return None;
    };
    let index = pair.coverage().get(first)?;
    let (value, _) = match pair {
        PairAdjustment::Format1 { sets, .. } => sets.get(index)?.get(second)?,
        PairAdjustment::Format2 {
            classes, matrix, ..
        } => matrix.get((classes.0.get(first), classes.1.get(second)))?,
    };
    Some(i32::from(value.x_advance))
}
