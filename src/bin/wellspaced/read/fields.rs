//! Text files of numbers, line by line: comments and blank lines are skipped, every field knows the file and line
//! it stands in, so that a wrong one can be named.

use std::fmt::{self, Display, Formatter};
use std::path::Path;
use std::str::FromStr;

use glam::DVec3;

use crate::failure::Failure;

/// The name of an element: what it is and its number in the file.
#[derive(Clone, Copy)]
pub struct Numbered(pub &'static str, pub usize);

impl Display for Numbered {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.0, self.1)
    }
}

/// What stands between the fields of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    /// Blanks, and commas as if they were blanks (TetGen's files).
    Blank,
    /// Commas if the line has any, else blanks: an empty field between two commas is an error.
    CommaOrBlank,
}

/// The lines of a file that hold something.
pub struct Lines<'a> {
    path: &'a Path,
    rest: &'a [u8],
    separator: Separator,
    /// The number of the line last taken, from 1.
    number: usize,
}

impl<'a> Lines<'a> {
    pub fn new(path: &'a Path, content: &'a [u8], separator: Separator) -> Self {
        let rest = content.strip_prefix(b"\xef\xbb\xbf").unwrap_or(content);
        Lines { path, rest, separator, number: 0 }
    }

    /// The next line with a field in it, if the file has one.
    pub fn next(&mut self) -> Result<Option<Fields<'a>>, Failure> {
        while !self.rest.is_empty() {
            let end = self.rest.iter().position(|&b| b == b'\n');
            let line = &self.rest[..end.unwrap_or(self.rest.len())];
            self.rest = &self.rest[end.map_or(self.rest.len(), |end| end + 1)..];
            self.number += 1;
            // Comments may be in any encoding; only what stands before them has to be text.
            let data = line.split(|&b| b == b'#').next().unwrap_or_default().trim_ascii();
            if data.is_empty() {
                continue;
            }
            let Ok(text) = std::str::from_utf8(data) else {
                return Err(Failure::in_line(self.path, self.number, "line", "is not text"));
            };
            let comma = self.separator == Separator::CommaOrBlank && text.contains(',');
            return Ok(Some(Fields { path: self.path, line: self.number, rest: Some(text), comma }));
        }
        Ok(None)
    }

    /// The next line, which must be there: `element` names what was expected in it.
    pub fn expect(&mut self, element: impl Display) -> Result<Fields<'a>, Failure> {
        let next = self.next()?;
        next.ok_or_else(|| Failure::in_line(self.path, self.number.max(1), element, "missing, the file ends here"))
    }

    /// Nothing may follow `last`.
    pub fn expect_end(&mut self, last: impl Display) -> Result<(), Failure> {
        match self.next()? {
            None => Ok(()),
            Some(fields) => Err(fields.wrong("line", format_args!("unexpected, {last} should have been the last"))),
        }
    }

    /// How many entries of at least `bytes` bytes each the rest of the file can hold: a bound for what to reserve,
    /// so that a wrong count can't ask for all memory.
    pub fn room_for(&self, count: usize, bytes: usize) -> usize {
        count.min(self.rest.len() / bytes + 1)
    }
}

/// The fields of one line, taken from the left.
pub struct Fields<'a> {
    path: &'a Path,
    line: usize,
    rest: Option<&'a str>,
    comma: bool,
}

impl<'a> Fields<'a> {
    /// The number of this line, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// A failure that names this line.
    pub fn wrong(&self, element: impl Display, problem: impl Display) -> Failure {
        Failure::in_line(self.path, self.line, element, problem)
    }

    /// The next field as it stands, which stays the next one.
    pub fn peek(&mut self) -> Option<&'a str> {
        let before = self.rest;
        let text = self.text();
        self.rest = before;
        text
    }

    /// The next field as it stands.
    pub fn text(&mut self) -> Option<&'a str> {
        let rest = self.rest?;
        if self.comma {
            let (field, after) = match rest.split_once(',') {
                Some((field, after)) => (field, Some(after)),
                None => (rest, None),
            };
            self.rest = after;
            return Some(field.trim());
        }
        // Bytes are quicker to look through than characters, and none of another character's is one of these.
        let blank = |b: &u8| b.is_ascii_whitespace() || *b == b',';
        let Some(start) = rest.bytes().position(|b| !blank(&b)) else {
            self.rest = None;
            return None;
        };
        let rest = &rest[start..];
        let (field, after) = rest.split_at(rest.as_bytes().iter().position(blank).unwrap_or(rest.len()));
        self.rest = Some(after);
        Some(field)
    }

    /// The next field as a number of type `T`, if there is a field.
    fn optional<T: FromStr>(
        &mut self,
        element: impl Display,
        name: impl Display,
        kind: &str,
    ) -> Result<Option<T>, Failure> {
        let Some(text) = self.text() else { return Ok(None) };
        match text.parse() {
            Ok(value) => Ok(Some(value)),
            Err(_) => Err(self.wrong(element, format_args!("{name} is {text:?}, expected {kind}"))),
        }
    }

    /// The next field as a count or an index.
    pub fn optional_count(&mut self, element: impl Display, name: impl Display) -> Result<Option<usize>, Failure> {
        self.optional(element, name, "a whole number, 0 or more")
    }

    /// The next field as a count or an index, which must be there.
    pub fn count(&mut self, element: impl Display, name: impl Display) -> Result<usize, Failure> {
        match self.optional_count(&element, &name)? {
            Some(value) => Ok(value),
            None => Err(self.wrong(element, format_args!("{name} is missing"))),
        }
    }

    /// The next field as a marker, 0 if there is none.
    pub fn marker(&mut self, element: impl Display) -> Result<i32, Failure> {
        Ok(self.optional(element, "marker", "a whole number of 32 bits")?.unwrap_or(0))
    }

    /// The next field as a finite number.
    pub fn optional_real(&mut self, element: impl Display, name: impl Display) -> Result<Option<f64>, Failure> {
        let Some(value) = self.optional::<f64>(&element, &name, "a number")? else { return Ok(None) };
        if !value.is_finite() {
            return Err(self.wrong(element, format_args!("{name} is not finite")));
        }
        Ok(Some(value))
    }

    /// The next field as a finite number, which must be there.
    pub fn real(&mut self, element: impl Display, name: impl Display) -> Result<f64, Failure> {
        match self.optional_real(&element, &name)? {
            Some(value) => Ok(value),
            None => Err(self.wrong(element, format_args!("{name} is missing"))),
        }
    }

    /// The next three fields as a point.
    pub fn point(&mut self, element: impl Display) -> Result<DVec3, Failure> {
        Ok(DVec3::new(
            self.real(&element, "x coordinate")?,
            self.real(&element, "y coordinate")?,
            self.real(&element, "z coordinate")?,
        ))
    }
}
