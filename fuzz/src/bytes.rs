//! The fuzzer's bytes as numbers and points. When they run out, all is 0.

use wellspaced::geometry::{MAX_MAGNITUDE, MIN_MAGNITUDE};
use wellspaced::DVec3;

/// What is left of the input.
pub struct Bytes<'a>(pub &'a [u8]);

impl Bytes<'_> {
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        first
    }

    pub fn word(&mut self) -> u32 {
        u32::from_le_bytes(std::array::from_fn(|_| self.byte()))
    }

    pub fn long(&mut self) -> u64 {
        u64::from_le_bytes(std::array::from_fn(|_| self.byte()))
    }

    /// A number below `end`, which is not 0.
    pub fn below(&mut self, end: usize) -> usize {
        if end <= 256 {
            usize::from(self.byte()) % end
        } else {
            self.word() as usize % end
        }
    }

    /// Any bits as a float.
    pub fn any_real(&mut self) -> f64 {
        f64::from_bits(self.long())
    }
}

/// How coordinates are made from bytes: what is near degenerate depends on it.
#[derive(Clone, Copy, Debug)]
pub enum Grid {
    /// Whole numbers from −8 to 7: nearly all is coplanar or cospherical.
    Small,
    /// The same in tenths, which are not exact.
    Tenths,
    /// Small ones far from the origin.
    Shifted,
    /// Scaled by a power of two.
    Scaled(i32),
    /// Any numbers that the predicates hold.
    Wide,
    /// Small ones, some a unit in the last place off.
    Nudged,
}

impl Grid {
    pub fn of(bytes: &mut Bytes) -> Grid {
        match bytes.byte() % 8 {
            0 | 1 => Grid::Small,
            2 => Grid::Tenths,
            3 => Grid::Shifted,
            4 => Grid::Scaled(i32::from(bytes.byte() as i8)),
            5 => Grid::Wide,
            _ => Grid::Nudged,
        }
    }

    fn coordinate(self, bytes: &mut Bytes) -> f64 {
        let small = |byte: u8| f64::from(byte % 16) - 8.0;
        match self {
            Grid::Small => small(bytes.byte()),
            Grid::Tenths => small(bytes.byte()) / 10.0,
            Grid::Shifted => small(bytes.byte()) / 16.0 + 1e12,
            Grid::Scaled(exponent) => small(bytes.byte()) * 2f64.powi(exponent.clamp(-135, 197)),
            Grid::Wide => {
                let bits = bytes.long();
                // The exponent folded into the range, the mantissa as it is, often short.
                let exponent = 1023 - 142 + (bits >> 52 & 0x7ff) % (142 + 201);
                let mantissa = bits & ((1 << 52) - 1);
                let mantissa = if bits >> 63 == 0 { mantissa } else { mantissa & !((1 << 40) - 1) };
                let x = f64::from_bits(exponent << 52 | mantissa);
                debug_assert!((MIN_MAGNITUDE..MAX_MAGNITUDE).contains(&x));
                match bits & 3 {
                    0 => 0.0,
                    1 => -x,
                    _ => x,
                }
            }
            Grid::Nudged => {
                let byte = bytes.byte();
                let x = small(byte);
                match byte >> 4 {
                    1 if x != 0.0 => x.next_up(),
                    2 if x != 0.0 => x.next_down(),
                    3 => x + 0.1,
                    4 => x / 3.0,
                    5 => -0.0,
                    _ => x,
                }
            }
        }
    }

    /// Whether the coordinates are so short that most splits can stand just where they should.
    pub fn is_exact(self) -> bool {
        matches!(self, Grid::Small | Grid::Scaled(_))
    }

    pub fn point(self, bytes: &mut Bytes) -> DVec3 {
        let x = self.coordinate(bytes);
        let y = self.coordinate(bytes);
        DVec3::new(x, y, self.coordinate(bytes))
    }
}
