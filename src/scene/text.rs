//! Places in the text of a scene's file, for messages about the text that is read: the same after edits by its caller.
//!
//! Edits insert, change and remove lines; the others keep their order. Going down both texts, the next pair of equal lines with the fewest
//! lines before it continues them.

use std::ops::Range;
use std::sync::Arc;

use crate::error::Problem;

/// The most lines of both texts that an edit changes at one place; places below a larger one are not shown.
const MOST_CHANGED: usize = 64;

/// The text of a scene.
#[derive(Debug, Clone)]
pub(crate) struct Text {
    /// After edits: the one that is read.
    pub edited: Arc<str>,
    /// That of the file.
    pub file: Arc<str>,
}

impl Text {
    /// A text without edits.
    pub fn unedited(text: impl Into<Arc<str>>) -> Text {
        let file = text.into();
        Text {
            edited: file.clone(),
            file,
        }
    }

    /// Shows the lines of the file at these ranges of the edited text, with a label for each. A place that only edits made is not shown,
    /// and nothing at all if that is the first one.
    pub fn show(&self, mut problem: Problem, labels: Vec<(Range<usize>, String)>) -> Problem {
        let lines = (*self.edited != *self.file).then(|| self.lines_in_file());
        let mut shown = Vec::new();
        for (k, (span, label)) in labels.into_iter().enumerate() {
            let span = match &lines {
                Some(lines) => in_file(lines, &span),
                None => Some(span),
            };
            match span {
                Some(span) => shown.push((span, label)),
                None if k == 0 => return problem,
                None => {}
            }
        }
        let mut shown = shown.into_iter();
        if let Some((span, label)) = shown.next() {
            problem = problem.labelled(self.file.clone(), span, label);
        }
        if let Some(snippet) = &mut problem.snippet {
            snippet.labels.extend(shown);
        }
        problem
    }

    /// For each line of the edited text, its range and the start of the same line in the file, if it is there.
    fn lines_in_file(&self) -> Vec<(Range<usize>, Option<usize>)> {
        let (edited, file) = (lines(&self.edited), lines(&self.file));
        let mut found: Vec<(Range<usize>, Option<usize>)> =
            edited.iter().map(|(at, _)| (at.clone(), None)).collect();
        let (mut i, mut k) = (0, 0);
        while let (Some((_, line)), Some((at, same))) = (edited.get(i), file.get(k)) {
            if line == same {
                found[i].1 = Some(at.start);
                (i, k) = (i + 1, k + 1);
                continue;
            }
            let is_pair = |(in_edited, in_file): &(usize, usize)| {
                let [a, b] = [edited.get(i + in_edited), file.get(k + in_file)];
                matches!((a, b), (Some((_, a)), Some((_, b))) if a == b && !a.trim().is_empty())
            };
            let steps = (1..=MOST_CHANGED).flat_map(|n| (0..=n).map(move |m| (n - m, m)));
            let Some((in_edited, in_file)) = steps.into_iter().find(is_pair) else {
                break;
            };
            (i, k) = (i + in_edited, k + in_file);
        }
        found
    }
}

/// The range of each line, and the line without its end.
fn lines(text: &str) -> Vec<(Range<usize>, &str)> {
    let mut start = 0;
    text.split_inclusive('\n')
        .map(|line| {
            let range = start..start + line.len();
            start = range.end;
            (range, line.trim_end_matches(['\n', '\r']))
        })
        .collect()
}

/// A range of the edited text in the file: its first line, if its last one is not as far from it there.
fn in_file(lines: &[(Range<usize>, Option<usize>)], span: &Range<usize>) -> Option<Range<usize>> {
    let line_of = |place: usize| {
        let after = lines.partition_point(|(line, _)| line.start <= place);
        lines.get(after.checked_sub(1)?)
    };
    let (line, start) = line_of(span.start)?;
    let moved = |place: usize, line: &Range<usize>, start: usize| start + (place - line.start);
    let first = moved(span.start, line, (*start)?);
    let last = line_of(span.end).and_then(|(line, start)| Some(moved(span.end, line, (*start)?)));
    let is_whole = last.is_some_and(|last| last - span.len().min(last) == first);
    let end = match is_whole {
        true => first + span.len(),
        false => first + (span.end.min(line.end.saturating_sub(1)).max(span.start) - span.start),
    };
    Some(first..end)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is shown of a file for `part` of the edited text.
    fn shown(file: &str, edited: &str, part: &str) -> Option<(usize, String)> {
        let text = Text {
            edited: edited.into(),
            file: file.into(),
        };
        let start = edited.find(part).unwrap();
        let labels = vec![(start..start + part.len(), "here".into())];
        let problem = text.show(Problem::new("a.toml", "", "", ""), labels);
        let snippet = problem.snippet?;
        let span = snippet.labels[0].0.clone();
        let line = snippet.text[..span.start].matches('\n').count() + 1;
        Some((line, snippet.text[span].to_string()))
    }

    #[test]
    fn a_place_below_edits_is_that_in_the_file() {
        let file = "[camera]\nhfov = 1\n\n[display]\nwhite = 1\n\n[[object]]\ncolor = 2\n";
        let longer =
            "[camera]\nhfov = 1\nsize = [1, 1]\ntime = 0\n\n[display]\n\n[[object]]\ncolor = 2\n";
        let line = |part| shown(file, longer, part);
        assert_eq!(line("color"), Some((8, "color".into())));
        assert_eq!(line("hfov = 1"), Some((2, "hfov = 1".into())));
        // These lines are not in the file.
        assert_eq!(line("time"), None);
        // A table that an edit is part of: its beginning.
        let camera = "[camera]\nhfov = 1\nsize = [1, 1]";
        assert_eq!(line(camera), Some((1, "[camera]".into())));
        let object = "[[object]]\ncolor = 2";
        assert_eq!(line(object), Some((7, object.into())));
    }

    #[test]
    fn changed_values_keep_the_lines_around_them() {
        let file = "a = [\n1,\n2,\n]\r\nb = 1\nc = 2";
        let edited = "a = 3\nb = 1\nc = 2";
        assert_eq!(shown(file, edited, "b = 1"), Some((5, "b = 1".into())));
        assert_eq!(shown(file, edited, "c = 2"), Some((6, "c = 2".into())));
        assert_eq!(shown(file, edited, "3"), None);
        assert_eq!(shown("", "[camera]\n", "[camera]"), None);
        assert_eq!(shown("x = 1", "x = 1", "x"), Some((1, "x".into())));
    }
}
