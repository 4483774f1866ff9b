//! The small part of Python's literals that stands in an array's header.

/// A value of the header's dictionary.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Literal {
    /// A string, without escapes.
    Text(String),
    /// `True` or `False`.
    Bool(bool),
    /// A tuple of non-negative integers.
    Tuple(Vec<usize>),
    /// Anything in brackets, as it stands: the description of a structured type.
    List(String),
}

/// The entries of `{'key': value, …}`, or what is wrong with it.
pub(super) fn dictionary(text: &str) -> Result<Vec<(String, Literal)>, String> {
    let mut rest = Rest(text.trim());
    let mut entries = Vec::new();
    rest.expect('{')?;
    while !rest.take('}') {
        let key = rest.text()?;
        rest.expect(':')?;
        entries.push((key, rest.literal()?));
        if !rest.take(',') {
            rest.expect('}')?;
            break;
        }
    }
    match rest.0.is_empty() {
        true => Ok(entries),
        false => Err("there is text after the dictionary".into()),
    }
}

/// What is still to be parsed; never starts with white space after a step.
struct Rest<'a>(&'a str);

impl<'a> Rest<'a> {
    fn take(&mut self, c: char) -> bool {
        match self.0.strip_prefix(c) {
            Some(rest) => {
                self.0 = rest.trim_start();
                true
            }
            None => false,
        }
    }

    fn expect(&mut self, c: char) -> Result<(), String> {
        match self.take(c) {
            true => Ok(()),
            false => Err(format!("{c:?} expected at {:?}", self.excerpt())),
        }
    }

    fn excerpt(&self) -> String {
        self.0.chars().take(20).collect()
    }

    /// Everything up to `end`, which is consumed.
    fn until(&mut self, end: char) -> Result<&'a str, String> {
        let (inside, rest) = self
            .0
            .split_once(end)
            .ok_or_else(|| format!("{end:?} is missing"))?;
        self.0 = rest.trim_start();
        Ok(inside)
    }

    fn text(&mut self) -> Result<String, String> {
        for quote in ['\'', '"'] {
            if self.take(quote) {
                return self.until(quote).map(str::to_owned);
            }
        }
        Err(format!("a string expected at {:?}", self.excerpt()))
    }

    fn literal(&mut self) -> Result<Literal, String> {
        if let Some(rest) = self.0.strip_prefix("True") {
            self.0 = rest.trim_start();
            return Ok(Literal::Bool(true));
        }
        if let Some(rest) = self.0.strip_prefix("False") {
            self.0 = rest.trim_start();
            return Ok(Literal::Bool(false));
        }
        match self.0.chars().next() {
            Some('(') => self.tuple().map(Literal::Tuple),
            Some('[') => self.list().map(Literal::List),
            _ => self.text().map(Literal::Text),
        }
    }

    fn tuple(&mut self) -> Result<Vec<usize>, String> {
        self.expect('(')?;
        let inside = self.until(')')?.trim();
        let inside = inside.strip_suffix(',').unwrap_or(inside);
        if inside.is_empty() {
            return Ok(Vec::new());
        }
        inside.split(',').map(integer).collect()
    }

    /// The text of a bracketed list with its inner brackets.
    fn list(&mut self) -> Result<String, String> {
        let mut depth = 0_usize;
        for (at, c) in self.0.char_indices() {
            depth = match c {
                '[' => depth + 1,
                ']' => depth - 1,
                _ => depth,
            };
            if depth == 0 {
                let (list, rest) = self.0.split_at(at + 1);
                self.0 = rest.trim_start();
                return Ok(list.to_owned());
            }
        }
        Err("']' is missing".into())
    }
}

/// A non-negative integer; Python 2 wrote a final L.
fn integer(text: &str) -> Result<usize, String> {
    let digits = text.trim();
    let digits = digits.strip_suffix('L').unwrap_or(digits);
    digits
        .parse()
        .map_err(|_| format!("{:?} is no size of an array", text.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_as_numpy_writes_it_is_read() {
        let text = "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 4, 5), }   \n";
        let expected = [
            ("descr", Literal::Text("<f4".into())),
            ("fortran_order", Literal::Bool(false)),
            ("shape", Literal::Tuple(vec![3, 4, 5])),
        ];
        let expected = expected.map(|(key, value)| (key.to_owned(), value));
        assert_eq!(dictionary(text).unwrap(), expected);
    }

    #[test]
    fn tuples_of_none_one_and_python_2_integers_are_read() {
        for (text, expected) in [
            ("{'s': ()}", vec![]),
            ("{'s': (7,)}", vec![7]),
            ("{\"s\":(7L, 8L)}", vec![7, 8]),
        ] {
            let entries = dictionary(text).unwrap();
            assert_eq!(entries, [("s".to_owned(), Literal::Tuple(expected))]);
        }
    }

    #[test]
    fn a_structured_type_is_kept_as_text() {
        let entries = dictionary("{'descr': [('a', '<f4', [2]), ('b', '<i4')]}").unwrap();
        let list = "[('a', '<f4', [2]), ('b', '<i4')]".to_owned();
        assert_eq!(entries, [("descr".to_owned(), Literal::List(list))]);
    }

    #[test]
    fn what_is_no_dictionary_is_refused() {
        for text in [
            "",
            "{",
            "}",
            "{'a'}",
            "{'a': }",
            "{'a': (1, -2)}",
            "{'a': (1",
            "{'a': [",
            "{'a': True} 1",
            "{'a': (99999999999999999999999,)}",
        ] {
            assert!(dictionary(text).is_err(), "{text:?}");
        }
    }
}
