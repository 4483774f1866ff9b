//! The name that was probably meant.

/// The candidate nearest to `word` by edit distance (ignoring case), if any is near; the first among equals.
pub(crate) fn nearest<'c>(
    word: &str,
    candidates: impl IntoIterator<Item = &'c str>,
) -> Option<&'c str> {
    // Bounded, so that a hostile file cannot make its own refusal take long.
    const LONGEST: usize = 64;
    const MOST: usize = 1000;
    let letters = word.chars().count();
    if letters > LONGEST {
        return None;
    }
    let word = word.to_lowercase();
    let near = candidates
        .into_iter()
        .take(MOST)
        .filter(|candidate| candidate.chars().count() <= LONGEST)
        .map(|candidate| {
            (
                strsim::levenshtein(&word, &candidate.to_lowercase()),
                candidate,
            )
        })
        .min_by_key(|&(distance, _)| distance);
    near.filter(|&(distance, _)| distance <= 1 + letters / 4)
        .map(|(_, candidate)| candidate)
}

/// "did you mean NAME? ", with the nearest candidate formatted by `show`; or nothing.
pub(super) fn did_you_mean<'c>(
    word: &str,
    candidates: impl IntoIterator<Item = &'c str>,
    show: impl Fn(&str) -> String,
) -> String {
    let meant = nearest(word, candidates);
    meant.map_or_else(String::new, |name| format!("did you mean {}? ", show(name)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_the_pen_is_seen_through() {
        let keys = ["eye", "look_at", "hfov", "velocity"];
        assert_eq!(nearest("velocty", keys), Some("velocity"));
        assert_eq!(nearest("lookat", keys), Some("look_at"));
        assert_eq!(nearest("HFOV", keys), Some("hfov"));
        assert_eq!(nearest("mass", keys), None);
        assert_eq!(nearest("", keys), None);
    }
}
