//! Numbers as text: the shortest digits that read back as the same number.

use std::fmt;

/// Writes a number with the fewest digits that keep it, with an exponent only where that is shorter to read.
pub struct Shortest(pub f64);

impl fmt::Display for Shortest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size == 0.0 || (1e-5..1e17).contains(&size) {
            write!(f, "{}", self.0)
        } else {
            write!(f, "{:e}", self.0)
        }
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

    proptest! {
        #[test]
        fn reads_back_as_the_same_bits(number in any::<f64>().prop_filter("finite", |x| x.is_finite())) {
            let back: f64 = Shortest(number).to_string().parse().unwrap();
            prop_assert_eq!(back.to_bits(), number.to_bits());
        }
    }
}
