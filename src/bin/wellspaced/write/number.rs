//! Numbers as text: the shortest digits that read back as the same number, and lines of numbers, of which large meshes have millions.

use std::fmt;
use std::io::{self, Write};

/// Writes a number with the fewest digits that keep it, with an exponent only where that is shorter to read.
#[derive(Clone, Copy, Debug)]
pub struct Shortest(pub f64);

impl Shortest {
    /// The text of most numbers. `None` for those that have an exponent in it, or that `digits` gives one.
    fn plain(self, digits: &mut zmij::Buffer) -> Option<&str> {
        let size = self.0.abs();
        if size != 0.0 && !(1e-5..1e17).contains(&size) {
            return None;
        }
        let text = digits.format_finite(self.0);
        (!text.contains('e')).then(|| text.strip_suffix(".0").unwrap_or(text))
    }
}

impl fmt::Display for Shortest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        match self.plain(&mut zmij::Buffer::new()) {
            Some(text) => f.write_str(text),
            None if (1e-5..1e17).contains(&size) => write!(f, "{}", self.0),
            None => write!(f, "{:e}", self.0),
        }
    }
}

/// A line of numbers with a space between two.
#[derive(Default)]
pub struct Line {
    text: Vec<u8>,
    digits: itoa::Buffer,
}

impl Line {
    /// Adds an integer.
    pub fn push(&mut self, number: impl itoa::Integer) {
        self.space();
        self.text.extend_from_slice(self.digits.format(number).as_bytes());
    }

    /// Adds a number, as [`Shortest`] writes it.
    pub fn push_real(&mut self, number: f64) -> io::Result<()> {
        self.space();
        match Shortest(number).plain(&mut zmij::Buffer::new()) {
            Some(text) => self.text.extend_from_slice(text.as_bytes()),
            None => write!(self.text, "{}", Shortest(number))?,
        }
        Ok(())
    }

    fn space(&mut self) {
        if !self.text.is_empty() {
            self.text.push(b' ');
        }
    }

    /// Writes the line, and begins the next.
    pub fn end(&mut self, out: &mut dyn Write) -> io::Result<()> {
        self.text.push(b'\n');
        let result = out.write_all(&self.text);
        self.text.clear();
        result
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn short_where_it_can_be() {
        for (number, text) in [
            (0.0, "0"),
            (-0.0, "-0"),
            (0.1, "0.1"),
            (-50000.0, "-50000"),
            (1e-5, "0.00001"),
            (1e-6, "1e-6"),
            (1.5e20, "1.5e20"),
            (1.0 / 3.0, "0.3333333333333333"),
        ] {
            assert_eq!(Shortest(number).to_string(), text);
        }
    }

    #[test]
    fn lines_are_those_of_the_standard_formatting() {
        let (mut line, mut out) = (Line::default(), Vec::new());
        for number in [0i64, -1, 7, 10, 999, -1000, i64::from(u32::MAX), i64::MIN] {
            line.push(number);
        }
        line.end(&mut out).unwrap();
        line.push(12usize);
        for number in [0.5, -0.0, 3.0, 1e-7, 1e16, 2e-5, 1.5e300] {
            line.push_real(number).unwrap();
        }
        line.end(&mut out).unwrap();
        let text =
            format!("0 -1 7 10 999 -1000 {} {}\n12 0.5 -0 3 1e-7 {} 0.00002 1.5e300\n", u32::MAX, i64::MIN, 1e16);
        assert_eq!(String::from_utf8(out).unwrap(), text);
    }

    proptest! {
        #[test]
        fn reads_back_as_the_same_bits(number in any::<f64>().prop_filter("finite", |x| x.is_finite())) {
            let back: f64 = Shortest(number).to_string().parse().unwrap();
            prop_assert_eq!(back.to_bits(), number.to_bits());
        }

        // Of several shortest texts the two may choose different ones.
        #[test]
        fn as_short_as_the_standard_library_writes_it(number in -1e3..1e3f64, scale in -9..17) {
            for number in [number, number * 10f64.powi(scale), (number * 10f64.powi(scale)).round()] {
                let size = number.abs();
                let plain = size == 0.0 || (1e-5..1e17).contains(&size);
                let standard = if plain { format!("{number}") } else { format!("{number:e}") };
                let text = Shortest(number).to_string();
                prop_assert_eq!(text.len(), standard.len());
                prop_assert_eq!(text.contains('e'), standard.contains('e'));
                prop_assert_eq!(text.parse::<f64>().unwrap().to_bits(), number.to_bits());
            }
        }
    }
}
