//! Everything that can go wrong, with its place: what, where, and what would be right.
//!
//! The library never prints and never exits; the command line turns an [`Error`] into one
//! report and an exit code. Panics are for bugs of this program only.

use std::fmt;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The result of everything in this crate that can fail.
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
    /// The input says something that cannot be true or cannot be meant.
    #[error("{0}")]
    Invalid(Box<Problem>),
    /// The input is well-formed and asks for what this version does not do.
    #[error("{0}")]
    Unsupported(Box<Problem>),
    /// The work was cancelled by its caller; nothing was written.
    #[error("stopped before the end; nothing was written")]
    Cancelled,
}

/// What is wrong with an input: where, what, and what would be right.
#[derive(Debug)]
pub struct Problem {
    /// The file (or "command line", or "built-in scene").
    pub file: String,
    /// The place in it, as a reader would name it: "mesh 0, primitive 2, accessor 5",
    /// `object.velocity`. May be empty.
    pub place: String,
    /// What is wrong.
    pub what: String,
    /// What would be right. May be empty.
    pub help: String,
    /// The part of the file that a report shows.
    pub snippet: Option<Snippet>,
}

/// A text with labels at parts of it.
#[derive(Debug)]
pub struct Snippet {
    /// The whole text.
    pub text: Arc<str>,
    /// Bytes of the text, and what is said of them; the place of the problem comes first.
    pub labels: Vec<(Range<usize>, String)>,
}

impl Problem {
    /// A problem in `file` at `place`.
    pub fn new(
        file: impl AsRef<Path>,
        place: impl Into<String>,
        what: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        Problem {
            file: file.as_ref().display().to_string(),
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
        place: impl Into<String>,
        what: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        Problem::new(file, place, what, help).invalid()
    }

    /// An [`Error::Unsupported`] without a labelled span.
    pub fn unsupported(
        file: impl AsRef<Path>,
        place: impl Into<String>,
        what: impl Into<String>,
        help: impl Into<String>,
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

    /// What would be right, or what to do; empty where that is not known.
    pub fn help(&self) -> &str {
        match self {
            Error::Io { source, .. } => remedy(source.kind()),
            Error::Invalid(problem) | Error::Unsupported(problem) => &problem.help,
            Error::Cancelled => "",
        }
    }
}

/// What to do about an I/O error; empty where that cannot be said.
fn remedy(kind: io::ErrorKind) -> &'static str {
    use io::ErrorKind as Kind;
    match kind {
        Kind::NotFound => "check the path; a relative one starts from the current directory",
        Kind::PermissionDenied => "check the permissions of the file and of its directory",
        Kind::IsADirectory => "name a file, not a directory",
        Kind::StorageFull | Kind::QuotaExceeded => "free some space, or write to another place",
        Kind::ReadOnlyFilesystem => "write to another place",
        _ => "",
    }
}

#[cfg(feature = "reports")]
impl Error {
    /// The error with the lines of the file that it is about, and what would be right: for people to read.
    /// With ANSI colours where it is `styled`.
    pub fn report(&self, styled: bool) -> String {
        use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
        let mut group = Level::ERROR
            .primary_title(self.to_string())
            .elements(None::<annotate_snippets::Message>);
        if let Error::Invalid(problem) | Error::Unsupported(problem) = self
            && let Some(snippet) = &problem.snippet
        {
            let kinds = std::iter::once(AnnotationKind::Primary);
            let kinds = kinds.chain(std::iter::repeat(AnnotationKind::Context));
            let labels = kinds.zip(&snippet.labels);
            group = group.element(
                Snippet::source(&*snippet.text)
                    .path(&problem.file)
                    .annotations(
                        labels.map(|(kind, (span, label))| kind.span(span.clone()).label(label)),
                    ),
            );
        }
        if !self.help().is_empty() {
            group = group.element(Level::HELP.message(self.help()));
        }
        let renderer = match styled {
            true => Renderer::styled(),
            false => Renderer::plain(),
        };
        renderer.render(&[group]) + "\n"
    }
}
