//! Everything that can go wrong, with its place: what, where, and what would be right.
//!
//! The library never prints and never exits; the command line turns an [`Error`] into one
//! report and an exit code. Panics are for bugs of this program only.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceSpan};

/// The result of everything in this crate that can fail.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// An error of this crate.
#[derive(Debug, thiserror::Error)]
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
    /// The text and the span that a labelled report shows.
    pub source: Option<(NamedSource<Arc<str>>, Vec<LabeledSpan>)>,
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
            source: None,
        }
    }

    /// Shows `text` of the file with `span` labelled.
    pub fn labelled(
        mut self,
        text: Arc<str>,
        span: std::ops::Range<usize>,
        label: impl Into<String>,
    ) -> Self {
        let label = LabeledSpan::new_primary_with_span(Some(label.into()), SourceSpan::from(span));
        let source = NamedSource::new(&self.file, text).with_language("toml");
        self.source = Some((source, vec![label]));
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

    fn problem(&self) -> Option<&Problem> {
        match self {
            Error::Invalid(problem) | Error::Unsupported(problem) => Some(problem),
            Error::Io { .. } | Error::Cancelled => None,
        }
    }
}

/// What to do about an I/O error, where that can be said.
fn remedy(kind: io::ErrorKind) -> Option<&'static str> {
    use io::ErrorKind as Kind;
    match kind {
        Kind::NotFound => Some("check the path; a relative one starts from the current directory"),
        Kind::PermissionDenied => Some("check the permissions of the file and of its directory"),
        Kind::IsADirectory => Some("name a file, not a directory"),
        Kind::StorageFull | Kind::QuotaExceeded => Some("make room, or write to another place"),
        Kind::ReadOnlyFilesystem => Some("write to another place"),
        _ => None,
    }
}

impl Diagnostic for Error {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        if let Error::Io { source, .. } = self {
            return Some(Box::new(remedy(source.kind())?));
        }
        let problem = self.problem().filter(|p| !p.help.is_empty())?;
        Some(Box::new(&problem.help))
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        let (source, _) = self.problem()?.source.as_ref()?;
        Some(source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let (_, labels) = self.problem()?.source.as_ref()?;
        Some(Box::new(labels.iter().cloned()))
    }
}
