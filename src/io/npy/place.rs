//! A location in a file, for messages.

use std::path::{Path, PathBuf};

use crate::Error;

/// The supported kinds of archive members.
pub(super) const MEMBERS: &str = "members may be stored or deflated, without a password, as numpy.savez and \
                                  numpy.savez_compressed write them";

/// The remedy for a truncated or damaged file.
pub(in crate::io) const WRITE_AGAIN: &str =
    "copy the file again, or write it again with numpy.save or numpy.savez";

/// A file and, in an archive, one of its arrays.
#[derive(Debug, Clone)]
pub(in crate::io) struct Place {
    file: PathBuf,
    pub(super) array: Option<String>,
}

impl Place {
    pub(super) fn new(file: &Path, array: Option<&str>) -> Self {
        Place {
            file: file.to_path_buf(),
            array: array.map(str::to_owned),
        }
    }

    /// "array "name", detail", or the one of the two that exists.
    fn text(&self, detail: &str) -> String {
        match &self.array {
            Some(array) if detail.is_empty() => format!("array {array:?}"),
            Some(array) => format!("array {array:?}, {detail}"),
            None => detail.to_owned(),
        }
    }

    pub fn invalid(&self, detail: &str, what: impl Into<String>, help: impl Into<String>) -> Error {
        Error::invalid(&self.file, self.text(detail), what, help)
    }

    pub fn unsupported(
        &self,
        detail: &str,
        what: impl Into<String>,
        help: impl Into<String>,
    ) -> Error {
        Error::unsupported(&self.file, self.text(detail), what, help)
    }

    /// An I/O error while reading: a truncated file or a broken archive is the file's fault.
    pub(super) fn read_error(&self, detail: &str, error: std::io::Error) -> Error {
        use std::io::ErrorKind::{InvalidData, InvalidInput, UnexpectedEof, Unsupported};
        match error.kind() {
            UnexpectedEof => self.invalid(detail, "the file ends too early", WRITE_AGAIN),
            Unsupported => self.unsupported(detail, error.to_string(), MEMBERS),
            InvalidData | InvalidInput => self.invalid(
                detail,
                format!("the archive is broken: {error}"),
                WRITE_AGAIN,
            ),
            _ => Error::io(&self.file, "cannot read")(error),
        }
    }
}
