//! The name that was probably meant.

/// The candidate nearest to `word` by edit distance, if any is near; the first of equals.
pub(crate) fn nearest<'c>(
    word: &str,
    candidates: impl IntoIterator<Item = &'c str>,
) -> Option<&'c str> {
    // Bounded, so that a hostile file cannot make a long job of its own refusal.
    const LONGEST: usize = 64;
    const MOST: usize = 1000;
    let letters = word.chars().count();
    if letters > LONGEST {
        return None;
    }
    let near = candidates
        .into_iter()
        .take(MOST)
        .filter(|candidate| candidate.chars().count() <= LONGEST)
        .map(|candidate| (distance(word, candidate), candidate))
        .min_by_key(|&(distance, _)| distance);
    near.filter(|&(distance, _)| distance <= 1 + letters / 4)
        .map(|(_, candidate)| candidate)
}

/// Insertions, deletions and substitutions (Levenshtein), letter case ignored.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.to_lowercase().chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.to_lowercase().chars().enumerate() {
        let mut next = vec![i + 1];
        for ((y, above), left_above) in b.iter().zip(row.iter().skip(1)).zip(&row) {
            let left = next.last().copied().unwrap_or(i + 1);
            let replace = left_above + usize::from(x != *y);
            next.push(replace.min(left + 1).min(above + 1));
        }
        row = next;
    }
    row.last().copied().unwrap_or(0)
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

    #[test]
    fn distances_are_those_of_levenshtein() {
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("", "abc"), 3);
        assert_eq!(distance("abc", ""), 3);
    }
}
