//! Elements in the order in which they came, each once: few are looked through, which beats a set; many are in a set besides.

use std::hash::Hash;

use rustc_hash::FxHashSet;

/// So many are found faster by looking through them.
const FEW: usize = 48;

/// A list without duplicates.
#[derive(Clone, Debug)]
pub(crate) struct Distinct<T> {
    pub list: Vec<T>,
    seen: FxHashSet<T>,
}

impl<T> Default for Distinct<T> {
    fn default() -> Self {
        Distinct { list: Vec::new(), seen: FxHashSet::default() }
    }
}

impl<T: Copy + Eq + Hash> Distinct<T> {
    #[inline]
    pub fn contains(&self, element: T) -> bool {
        if self.list.len() < FEW {
            self.list.contains(&element)
        } else {
            self.seen.contains(&element)
        }
    }

    /// Adds an element; false if it is there already.
    #[inline]
    pub fn insert(&mut self, element: T) -> bool {
        if self.contains(element) {
            return false;
        }
        self.list.push(element);
        match self.list.len() {
            ..FEW => {}
            FEW => self.seen.extend(&self.list),
            _ => _ = self.seen.insert(element),
        }
        true
    }

    pub fn clear(&mut self) {
        self.list.clear();
        self.seen.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_comes_once_however_many_there_are() {
        let mut distinct = Distinct::default();
        for i in 0..4 * FEW {
            assert!(!distinct.contains(i));
            assert!(distinct.insert(i));
            assert!((0..=i).all(|old| distinct.contains(old) && !distinct.insert(old)));
        }
        assert_eq!(distinct.list, (0..4 * FEW).collect::<Vec<_>>());
        distinct.clear();
        assert!(!distinct.contains(0) && distinct.insert(0));
    }
}
