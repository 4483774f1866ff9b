//! Everything that can go wrong, with its place: what, where, and what would be right.
//!
//! The library never prints and never exits; the command line turns an [`Error`] into one
//! report and an exit code. Panics are for bugs of this program only.

mod message;

use std::fmt;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub use message::{Message, Setting};

/// The result of reading, planning, rendering and writing. Velocities, world lines, units, meshes, atlases and cubes have their own
/// errors, without a file and a place; `?` turns these into [`Error::Value`].
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// An error of this crate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be opened, read, written or renamed.
    #[error("{}: {action}: {source}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What was being done, as a phrase: "cannot read".
        action: &'static str,
        /// The operating system's reason.
        source: io::Error,
    },
    /// The input is impossible or meaningless.
    #[error("{0}")]
    Invalid(Box<Problem>),
    /// The input is well-formed, but asks for something this version cannot do.
    #[error("{0}")]
    Unsupported(Box<Problem>),
    /// An invalid velocity, world line, quantity, mesh, atlas or cube: their own errors, without a file and a place.
    #[error(transparent)]
    Value(Box<dyn std::error::Error + Send + Sync>),
    /// The work was cancelled by its caller; nothing was written.
    #[error("stopped before the end; nothing was written")]
    Cancelled,
}

/// Makes `?` turn errors of values into [`Error::Value`].
macro_rules! value_errors {
    ($($error:ty),*) => {
        $(impl From<$error> for $crate::error::Error {
            fn from(error: $error) -> Self {
                $crate::error::Error::Value(Box::new(error))
            }
        })*
    };
}
pub(crate) use value_errors;

/// A number as messages show it: in scientific notation if it would have too many zeros to count.
pub fn number(value: f64) -> impl fmt::Display {
    fmt::from_fn(move |f| match value.abs() {
        size if size == 0.0 || !size.is_finite() || (1e-5..1e16).contains(&size) => {
            write!(f, "{value}")
        }
        _ => write!(f, "{value:e}"),
    })
}

/// What is wrong with an input: where, what, and what would be right.
#[derive(Debug)]
#[non_exhaustive]
pub struct Problem {
    /// The file (or the overrides, or "built-in scene").
    pub file: Message,
    /// The place in it, as a reader would name it: "mesh 0, primitive 2, accessor 5",
    /// `object.velocity`. May be empty.
    pub place: Message,
    /// What is wrong.
    pub what: Message,
    /// What would be right. May be empty.
    pub help: Message,
    /// The part of the file that a report shows.
    pub snippet: Option<Snippet>,
}

/// A text with labels at parts of it.
#[derive(Debug)]
#[non_exhaustive]
pub struct Snippet {
    /// The whole text.
    pub text: Arc<str>,
    /// Byte ranges of the text with a label for each; the place of the problem comes first.
    pub labels: Vec<(Range<usize>, String)>,
}

impl Problem {
    /// A problem in `file` at `place`.
    pub fn new(
        file: impl AsRef<Path>,
        place: impl Into<Message>,
        what: impl Into<Message>,
        help: impl Into<Message>,
    ) -> Self {
        Problem {
            file: file.as_ref().display().to_string().into(),
            place: place.into(),
            what: what.into(),
            help: help.into(),
            snippet: None,
        }
    }

    /// Shows `text` of the file with `span` labelled.
    pub fn labelled(
        mut self,
        text: Arc<str>,
        span: Range<usize>,
        label: impl Into<String>,
    ) -> Self {
        let labels = vec![(span, label.into())];
        self.snippet = Some(Snippet { text, labels });
        self
    }

    /// As an [`Error::Invalid`].
    pub fn invalid(self) -> Error {
        Error::Invalid(Box::new(self))
    }

    /// As an [`Error::Unsupported`].
    pub fn unsupported(self) -> Error {
        Error::Unsupported(Box::new(self))
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file)?;
        if !self.place.is_empty() {
            write!(f, ", {}", self.place)?;
        }
        write!(f, ": {}", self.what)
    }
}

impl Error {
    /// An [`Error::Invalid`] without a labelled span.
    pub fn invalid(
        file: impl AsRef<Path>,
        place: impl Into<Message>,
        what: impl Into<Message>,
        help: impl Into<Message>,
    ) -> Self {
        Problem::new(file, place, what, help).invalid()
    }

    /// An [`Error::Unsupported`] without a labelled span.
    pub fn unsupported(
        file: impl AsRef<Path>,
        place: impl Into<Message>,
        what: impl Into<Message>,
        help: impl Into<Message>,
    ) -> Self {
        Problem::new(file, place, what, help).unsupported()
    }

    /// For `map_err`: an I/O error of `path` while doing `action` ("cannot read").
    pub fn io(path: impl AsRef<Path>, action: &'static str) -> impl FnOnce(io::Error) -> Self {
        let path = path.as_ref().to_path_buf();
        move |source| Error::Io {
            path,
            action,
            source,
        }
    }

    /// What would be right, or what to do; empty if unknown.
    pub fn help(&self) -> &str {
        match self {
            Error::Io { source, .. } => remedy(source.kind()),
            Error::Invalid(problem) | Error::Unsupported(problem) => &problem.help,
            Error::Value(_) | Error::Cancelled => "",
        }
    }
}

/// What to do about an I/O error; empty if nothing can be said.
fn remedy(kind: io::ErrorKind) -> &'static str {
    use io::ErrorKind as Kind;
    match kind {
        Kind::NotFound => "check the path; a relative one starts from the current directory",
        Kind::PermissionDenied => "check the permissions of the file and of its directory",
        Kind::IsADirectory => "name a file, not a directory",
        Kind::StorageFull | Kind::QuotaExceeded => "free some space, or write to another place",
        Kind::FileTooLarge => {
            "the system or `ulimit -f` limits how large files are: raise the limit, or write less"
        }
        Kind::ReadOnlyFilesystem => "write to another place",
        _ => "",
    }
}

#[cfg(feature = "reports")]
impl Error {
    /// The error for people to read: with the lines of the file that it refers to, and what would be right. With ANSI colours if
    /// `styled`; it contains no other terminal escapes. Long lines are cut around the place.
    pub fn report(&self, styled: bool) -> String {
        let draw = std::panic::AssertUnwindSafe(|| self.drawn(styled));
        // Whatever the file does to the drawing, the message itself is shown.
        let report = std::panic::catch_unwind(draw).unwrap_or_else(|_| self.plain());
        report.replace(|c| ('\u{80}'..='\u{9f}').contains(&c), "�")
    }

    /// The error without lines from the file.
    fn plain(&self) -> String {
        match self.help() {
            "" => format!("error: {}\n", visible(&self.to_string())),
            help => format!(
                "error: {}\nhelp: {}\n",
                visible(&self.to_string()),
                visible(help)
            ),
        }
    }

    /// The message with the lines that it refers to, as compilers show it. Control characters from files are made visible.
    fn drawn(&self, styled: bool) -> String {
        use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
        let title = visible(&self.to_string());
        let help = visible(self.help());
        let mut group = Level::ERROR
            .primary_title(title)
            .elements(None::<annotate_snippets::Message>);
        let shown;
        if let Error::Invalid(problem) | Error::Unsupported(problem) = self
            && let Some(snippet) = &problem.snippet
        {
            shown = snippet.cut();
            let (first_line, snippet) = match &shown {
                Some((first_line, cut)) => (*first_line, cut),
                None => (1, snippet),
            };
            let kinds = std::iter::once(AnnotationKind::Primary);
            let kinds = kinds.chain(std::iter::repeat(AnnotationKind::Context));
            let labels = kinds.zip(&snippet.labels);
            group = group.element(
                Snippet::source(&*snippet.text)
                    .line_start(first_line)
                    .path(visible(&problem.file))
                    .annotations(labels.map(|(kind, (span, label))| {
                        kind.span(span.clone()).label(visible(label))
                    })),
            );
        }
        if !help.is_empty() {
            group = group.element(Level::HELP.message(help));
        }
        let renderer = match styled {
            true => Renderer::styled(),
            false => Renderer::plain(),
        };
        renderer.render(&[group]) + "\n"
    }
}

/// The longest message or path of a report, characters.
#[cfg(feature = "reports")]
const MOST_WORDS: usize = 2000;
/// The longest line of a file that is shown in full, bytes.
#[cfg(feature = "reports")]
const LONGEST_LINE: usize = 400;
/// How much of a longer line is shown before the place, and from it on, bytes.
#[cfg(feature = "reports")]
const AROUND: [usize; 2] = [80, 160];

/// A text of bounded length without terminal escapes or characters that change the writing direction.
#[cfg(feature = "reports")]
fn visible(text: &str) -> String {
    let is_harmful = |c: char| {
        c.is_control() && c != '\n'
            || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    let shown = text.char_indices().nth(MOST_WORDS);
    let end = shown.map_or(text.len(), |(end, _)| end);
    let shown = text[..end].replace(is_harmful, "�");
    if end < text.len() {
        shown + "…"
    } else {
        shown
    }
}

#[cfg(feature = "reports")]
impl Snippet {
    /// If a labelled line is too long to show: the line number of the first place, and the text around the place.
    fn cut(&self) -> Option<(usize, Snippet)> {
        let text = &*self.text;
        let line_of = |place: usize| {
            let place = text.floor_char_boundary(place.min(text.len()));
            let start = text[..place].rfind('\n').map_or(0, |newline| newline + 1);
            let end = text[place..]
                .find('\n')
                .map_or(text.len(), |newline| place + newline);
            start..end
        };
        let spans = || self.labels.iter().map(|(span, _)| span);
        let lines = spans().flat_map(|span| [line_of(span.start), line_of(span.end)]);
        if lines.map(|line| line.len()).max()? <= LONGEST_LINE {
            return None;
        }
        let (span, label) = self.labels.first()?;
        let line = line_of(span.start);
        let place = text.floor_char_boundary(span.start.min(line.end));
        let from = text.floor_char_boundary(place.saturating_sub(AROUND[0]).max(line.start));
        let to = text.floor_char_boundary((place + AROUND[1]).min(line.end));
        let before = if from > line.start { "… " } else { "" };
        let after = if to < line.end { " …" } else { "" };
        let start = before.len() + place - from;
        let end = before.len() + text.floor_char_boundary(span.end.clamp(place, to)) - from;
        let number = text[..line.start].matches('\n').count() + 1;
        let cut = Snippet {
            text: format!("{before}{}{after}", &text[from..to]).into(),
            labels: vec![(start..end, label.clone())],
        };
        Some((number, cut))
    }
}

#[cfg(all(test, feature = "reports"))]
mod tests {
    use super::*;

    fn report(text: &str, span: Range<usize>) -> String {
        let problem = Problem::new("scene.toml", "a", "this is wrong", "do that");
        problem
            .labelled(text.into(), span, "here")
            .invalid()
            .report(false)
    }

    #[test]
    fn a_place_far_to_the_right_is_shown_with_what_stands_around_it() {
        for column in [300, 65_535, 65_536, 70_000, 3_000_000] {
            let text = format!(
                "a = 1\nb = \"{}wrong{}\"\n",
                "é".repeat(column),
                "x".repeat(column)
            );
            let place = text.find("wrong").unwrap();
            let report = report(&text, place..place + 5);
            for part in [
                "this is wrong",
                "scene.toml",
                "wrong",
                "here",
                "do that",
                "2 |",
            ] {
                assert!(
                    report.contains(part),
                    "column {column}: {part} is not in {report}"
                );
            }
            let longest = report.lines().map(str::len).max().unwrap();
            assert!(longest < 1000, "column {column}: {longest} bytes in a line");
        }
    }

    #[test]
    fn spans_that_are_no_spans_of_the_text_are_reported_all_the_same() {
        for [start, end] in [[0, 0], [7, 3], [2, 3], [900, 1000], [5, usize::MAX]] {
            let span = start..end;
            for text in ["", "aéb\ncd", &"é".repeat(1000)] {
                assert!(
                    report(text, span.clone()).contains("this is wrong"),
                    "{span:?} of {text:?}"
                );
            }
        }
    }

    #[test]
    fn nothing_in_a_report_steers_a_terminal() {
        let evil = "a\u{1b}[2J\u{9b}31m\u{7}\u{202e}\u{8}\rb";
        let problem = Problem::new(evil, evil, evil, evil);
        let error = problem.labelled(evil.into(), 0..evil.len(), evil).invalid();
        for report in [error.report(false), error.plain()] {
            let left: Vec<char> = report
                .chars()
                .filter(|c| c.is_control() && *c != '\n')
                .collect();
            assert!(left.is_empty(), "{left:?} in {report:?}");
        }
    }

    #[test]
    fn long_words_are_cut() {
        let problem = Problem::new("a", "b", "w".repeat(2 << 20), "h".repeat(2 << 20));
        assert!(problem.invalid().report(false).len() < 20_000);
    }
}
