//! Reads the markup of [rich text](super::rich) into runs.

use super::setter::Style;
use crate::error::{Error, Result};

/// Characters of one style on one level.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Run {
    pub style: Style,
    pub level: Level,
    pub text: String,
}

/// The position of a run relative to its line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Level {
    Line,
    Subscript,
    Superscript,
}

/// The largest depth of braces: each level of parsing takes stack.
const DEEPEST: usize = 32;

/// Signs by name, as TeX calls them.
const SIGNS: &[(&str, char)] = &[
    ("alpha", 'α'),
    ("beta", 'β'),
    ("gamma", 'γ'),
    ("delta", 'δ'),
    ("epsilon", 'ε'),
    ("zeta", 'ζ'),
    ("eta", 'η'),
    ("theta", 'θ'),
    ("iota", 'ι'),
    ("kappa", 'κ'),
    ("lambda", 'λ'),
    ("mu", 'μ'),
    ("nu", 'ν'),
    ("xi", 'ξ'),
    ("pi", 'π'),
    ("rho", 'ρ'),
    ("sigma", 'σ'),
    ("tau", 'τ'),
    ("upsilon", 'υ'),
    ("phi", 'φ'),
    ("chi", 'χ'),
    ("psi", 'ψ'),
    ("omega", 'ω'),
    ("Gamma", 'Γ'),
    ("Delta", 'Δ'),
    ("Theta", 'Θ'),
    ("Lambda", 'Λ'),
    ("Xi", 'Ξ'),
    ("Pi", 'Π'),
    ("Sigma", 'Σ'),
    ("Upsilon", 'Υ'),
    ("Phi", 'Φ'),
    ("Psi", 'Ψ'),
    ("Omega", 'Ω'),
    ("prime", '′'),
    ("times", '×'),
    ("cdot", '·'),
    ("pm", '±'),
    ("minus", '−'),
    ("le", '≤'),
    ("ge", '≥'),
    ("ne", '≠'),
    ("approx", '≈'),
    ("infty", '∞'),
    ("partial", '∂'),
    ("sqrt", '√'),
    ("degree", '°'),
    ("parallel", '∥'),
    ("perp", '⊥'),
    ("to", '→'),
];

/// Signs by name, as TeX calls them.
pub(super) fn signs() -> impl Iterator<Item = (&'static str, char)> {
    SIGNS.iter().copied()
}

/// The runs of `markup`.
///
/// # Errors
/// Unclosed or unknown markup, with the position in characters.
pub(super) fn parse(markup: &str) -> Result<Vec<Run>> {
    let mut parser = Parser {
        markup,
        characters: markup.chars().collect(),
        next: 0,
        depth: 0,
        italics: None,
        runs: Vec::new(),
    };
    parser.group(Level::Line, None)?;
    match parser.italics {
        Some(at) => Err(parser.wrong(
            at,
            "the italics that begin here do not end",
            "a second *; \\* is an asterisk",
        )),
        None => Ok(parser.runs),
    }
}

struct Parser<'a> {
    markup: &'a str,
    characters: Vec<char>,
    next: usize,
    /// Number of open braces.
    depth: usize,
    /// The start of the current italics.
    italics: Option<usize>,
    runs: Vec<Run>,
}

impl Parser<'_> {
    /// Reads up to the end, or to the brace that closes the one at `open`.
    fn group(&mut self, level: Level, open: Option<usize>) -> Result<()> {
        while let Some(c) = self.take() {
            match (c, open) {
                ('}', Some(_)) => return Ok(()),
                ('}', None) => {
                    let help = "a { before it; \\} is a brace";
                    return Err(self.wrong(self.next - 1, "this brace closes nothing", help));
                }
                _ => self.element(c, level)?,
            }
        }
        match open {
            Some(open) => Err(self.wrong(
                open,
                "this brace is not closed",
                "a } after it; \\{ is a brace",
            )),
            None => Ok(()),
        }
    }

    /// Reads text in braces, after the opening one.
    fn braces(&mut self, level: Level) -> Result<()> {
        let open = self.next - 1;
        // Braces are read recursively: the stack is no place for a file's braces without end.
        if self.depth == DEEPEST {
            let help = format!("at most {DEEPEST} braces within each other");
            return Err(self.wrong(open, "too many braces are open here", &help));
        }
        self.depth += 1;
        self.group(level, Some(open))?;
        self.depth -= 1;
        Ok(())
    }

    /// Reads an element that begins with `c`, which is already consumed.
    fn element(&mut self, c: char, level: Level) -> Result<()> {
        match c {
            '*' if self.italics.is_some() => self.italics = None,
            '*' => self.italics = Some(self.next - 1),
            '{' => self.braces(level)?,
            '_' => self.script(level, Level::Subscript)?,
            '^' => self.script(level, Level::Superscript)?,
            '\\' => self.escape(level)?,
            '\'' => self.quote(level),
            '-' if !self.follows_a_word() => self.push(level, '−'),
            c => self.push(level, c),
        }
        Ok(())
    }

    fn script(&mut self, outer: Level, level: Level) -> Result<()> {
        let at = self.next - 1;
        // A script of a script would need a third size, which no legend can be read in.
        if outer != Level::Line {
            return Err(self.wrong(
                at,
                "a script has no scripts of its own",
                "one level of _ and ^",
            ));
        }
        match self.take() {
            Some('{') => self.braces(level),
            Some(c) if !c.is_whitespace() && c != '*' => self.element(c, level),
            _ => Err(self.wrong(
                at,
                "this script is empty",
                "_a or _{…}; \\_ and \\^ are the characters",
            )),
        }
    }

    /// Reads what follows a backslash: a name, or a literal character.
    fn escape(&mut self, level: Level) -> Result<()> {
        let at = self.next - 1;
        let name: String = self.characters[self.next..]
            .iter()
            .take_while(|c| c.is_ascii_alphabetic())
            .collect();
        // Without letters: the next character, literally.
        if name.is_empty() {
            let Some(c) = self.take() else {
                return Err(self.wrong(
                    at,
                    "nothing follows this backslash",
                    "\\\\ is a backslash",
                ));
            };
            self.push(level, c);
            return Ok(());
        }
        self.next += name.len();
        // A misspelt name would be printed as a word, and is refused.
        let Some((_, sign)) = SIGNS.iter().find(|(known, _)| *known == name) else {
            let help =
                "names of Greek letters, and of signs such as \\times; {} after a name ends it";
            return Err(self.wrong(
                at,
                &format!("there is no symbol with the name \\{name}"),
                help,
            ));
        };
        self.push(level, *sign);
        Ok(())
    }

    /// A prime, two, or an apostrophe.
    fn quote(&mut self, level: Level) {
        // Between two letters of upright text it is an apostrophe (Alice's); symbols in italics have primes (x't).
        let before = self.next.checked_sub(2).map(|i| self.characters[i]);
        let letter = |c: Option<char>| c.is_some_and(char::is_alphabetic);
        let after = self.characters.get(self.next).copied();
        if self.italics.is_none() && letter(before) && letter(after) {
            self.push(level, '’');
        } else if after == Some('\'') {
            self.next += 1;
            self.push(level, '″');
        } else {
            self.push(level, '′');
        }
    }

    /// Whether the character before the one just taken is a letter or a digit.
    fn follows_a_word(&self) -> bool {
        let before = self.next.checked_sub(2).map(|i| self.characters[i]);
        before.is_some_and(char::is_alphanumeric)
    }

    fn take(&mut self) -> Option<char> {
        let c = self.characters.get(self.next).copied();
        self.next += usize::from(c.is_some());
        c
    }

    fn push(&mut self, level: Level, c: char) {
        let style = match self.italics {
            Some(_) => Style::Italic,
            None => Style::Upright,
        };
        // Characters of one style and level are one run.
        match self.runs.last_mut() {
            Some(run) if run.style == style && run.level == level => run.text.push(c),
            _ => self.runs.push(Run {
                style,
                level,
                text: c.into(),
            }),
        }
    }

    fn wrong(&self, at: usize, what: &str, help: &str) -> Error {
        let place = format!("character {}", at + 1);
        Error::invalid(format!("text \"{}\"", self.markup), place, what, help)
    }
}

#[cfg(test)]
mod tests;
