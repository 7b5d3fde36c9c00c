//! A hash map in parts. When a map of a million entries grows, is copied or is dropped, that takes longer than a cancelled call may go on; a part of one does
//! not. A map that stays small is one part.

use std::collections::hash_map::Entry;
use std::collections::TryReserveError;
use std::hash::{BuildHasher, Hash};

use rustc_hash::{FxBuildHasher, FxHashMap};

use crate::leavings::{InPieces, Leavings};
use crate::sorting::sort;
use crate::{memory, Control, Error};

/// Entries of a map that is one part still: a millisecond to divide them.
const FEW: usize = 1 << 14;
/// Parts of a large map.
const PARTS: usize = 256;
/// Room that a part of a large map has at least where room for more is asked for: of some elements to come, few fall into one part.
const ROOM: usize = 16;
/// Parts copied or given back between two looks at the control.
const PIECE: usize = 8;

/// A map as others are, without an order that means anything.
#[derive(Clone, Debug)]
pub(crate) struct PartedMap<K, V> {
    /// What there is while it is small.
    whole: FxHashMap<K, V>,
    /// None, or [`PARTS`] of them.
    parts: Vec<FxHashMap<K, V>>,
}

impl<K, V> Default for PartedMap<K, V> {
    fn default() -> Self {
        PartedMap { whole: FxHashMap::default(), parts: Vec::new() }
    }
}

impl<K: Copy + Eq + Hash, V> PartedMap<K, V> {
    /// The part of a key in a large map. The maps go by the lowest bits of the same hash, and by the highest.
    #[inline]
    fn index(key: &K) -> usize {
        (FxBuildHasher.hash_one(key) >> 16) as usize % PARTS
    }

    #[inline]
    fn part(&self, key: &K) -> &FxHashMap<K, V> {
        if self.parts.is_empty() {
            &self.whole
        } else {
            &self.parts[Self::index(key)]
        }
    }

    #[inline]
    fn part_mut(&mut self, key: &K) -> &mut FxHashMap<K, V> {
        if self.parts.is_empty() {
            &mut self.whole
        } else {
            &mut self.parts[Self::index(key)]
        }
    }

    /// The part for a key that may be new.
    #[inline]
    fn part_for(&mut self, key: &K) -> &mut FxHashMap<K, V> {
        if self.whole.len() >= FEW {
            // Without memory for that it grows as maps do.
            let _ = self.try_divide();
        }
        self.part_mut(key)
    }

    #[cold]
    fn try_divide(&mut self) -> Result<(), TryReserveError> {
        let mut parts: Vec<FxHashMap<K, V>> = Vec::new();
        parts.try_reserve_exact(PARTS)?;
        parts.resize_with(PARTS, FxHashMap::default);
        parts.iter_mut().try_for_each(|part| part.try_reserve(2 * FEW / PARTS))?;
        for (key, value) in std::mem::take(&mut self.whole) {
            parts[Self::index(&key)].insert(key, value);
        }
        self.parts = parts;
        Ok(())
    }

    fn all(&self) -> impl Iterator<Item = &FxHashMap<K, V>> + '_ {
        std::iter::once(&self.whole).chain(&self.parts)
    }

    #[inline]
    pub fn get(&self, key: &K) -> Option<&V> {
        self.part(key).get(key)
    }

    #[inline]
    pub fn contains_key(&self, key: &K) -> bool {
        self.part(key).contains_key(key)
    }

    /// Puts an entry in, and returns what was there before.
    pub fn insert(&mut self, key: K, value: V) -> Option<V> {
        self.part_for(&key).insert(key, value)
    }

    /// The place of a key, as other maps have it.
    pub fn entry(&mut self, key: K) -> Entry<'_, K, V> {
        self.part_for(&key).entry(key)
    }

    pub fn remove(&mut self, key: &K) -> Option<V> {
        self.part_mut(key).remove(key)
    }

    pub fn len(&self) -> usize {
        self.all().map(FxHashMap::len).sum()
    }

    pub fn is_empty(&self) -> bool {
        self.all().all(FxHashMap::is_empty)
    }

    pub fn iter(&self) -> impl Iterator<Item = (&K, &V)> + '_ {
        self.all().flatten()
    }

    pub fn keys(&self) -> impl Iterator<Item = &K> + '_ {
        self.iter().map(|(key, _)| key)
    }

    pub fn clear(&mut self) {
        *self = PartedMap::default();
    }

    /// Memory for some more: for any `more` entries while the map is small, for about as many when it is large.
    pub fn try_reserve(&mut self, more: usize) -> Result<(), TryReserveError> {
        if !self.parts.is_empty() {
            return self.parts.iter_mut().try_for_each(|part| part.try_reserve(ROOM));
        }
        if self.whole.len() + more < FEW {
            self.whole.try_reserve(more)
        } else {
            self.try_divide()
        }
    }

    /// The bytes that it has taken, about.
    pub fn bytes(&self) -> usize {
        self.all().map(bytes_of).sum()
    }
}

/// The bytes of a map's places, a power of two of which it leaves an eighth free, and a byte of control for each.
fn bytes_of<K, V>(map: &FxHashMap<K, V>) -> usize {
    (map.capacity() * 8 / 7).next_power_of_two() * (size_of::<(K, V)>() + 1)
}

/// Tries for the memory that copies of these maps take: where there is none, the copy itself would end the process. The largest is a part of a map: to ask for much at
/// once and give it back makes the allocator give back to the system what it has.
fn try_room_of<K, V>(maps: &[FxHashMap<K, V>]) -> Result<(), Error> {
    /// The vector and the control bytes behind the last place, for each map.
    const MORE: usize = 64;
    let bytes = maps.iter().map(|map| bytes_of(map) + MORE).sum();
    drop(memory::with_room::<u8>(bytes, "a map")?);
    Ok(())
}

impl<K: Copy + Eq + Hash + Ord + Send + 'static, V: Clone + Send + 'static> PartedMap<K, V> {
    /// A copy, unless memory is lacking or the control says stop.
    pub fn try_clone(&self, control: &Control) -> Result<Self, Error> {
        try_room_of(std::slice::from_ref(&self.whole))?;
        let mut copy = InPieces::new(PartedMap { whole: self.whole.clone(), parts: Vec::new() }, control);
        for parts in self.parts.chunks(PIECE) {
            control.check()?;
            try_room_of(parts)?;
            copy.parts.extend_from_slice(parts);
        }
        Ok(copy.keep())
    }

    /// Its keys in order, unless the control says stop.
    pub fn sorted_keys<'a>(&self, control: &'a Control) -> Result<InPieces<'a, Vec<K>>, Error> {
        let mut keys = memory::room_in_pieces(self.len(), "keys", control)?;
        let turns = control.turns();
        for &key in self.keys() {
            turns.check()?;
            keys.push(key);
        }
        sort(&mut keys, &control.watch())?;
        Ok(keys)
    }

    /// Changes the keys by `f`, which may change the values too, and leaves out entries for which there is none. The map is empty when the control says stop.
    pub fn rekey(&mut self, control: &Control, f: impl Fn(K, &mut V) -> Option<K>) -> Result<(), Error> {
        let mut new = InPieces::new(PartedMap::default(), control);
        let mut old = InPieces::new(std::mem::take(self), control);
        let turns = control.turns();
        let PartedMap { whole, parts } = &mut *old;
        for part in std::iter::once(whole).chain(parts) {
            for (key, mut value) in std::mem::take(part) {
                turns.check()?;
                if let Some(key) = f(key, &mut value) {
                    new.insert(key, value);
                }
            }
        }
        *self = new.keep();
        Ok(())
    }
}

impl<K: Send, V: Send> Leavings for PartedMap<K, V> {
    fn give_back(&mut self) -> bool {
        self.parts.truncate(self.parts.len().saturating_sub(PIECE));
        if self.parts.is_empty() {
            self.whole = FxHashMap::default();
        }
        !self.parts.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Small and large, through the division and back to empty, it says what a map of one part says.
    #[test]
    fn it_is_a_map() {
        let control = Control::new();
        let (mut parted, mut plain) = (PartedMap::default(), FxHashMap::default());
        let mut state = 11u64;
        for turn in 0..6 * FEW as u32 {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let key = [(state >> 46) as u32, (state >> 32 & 3) as u32];
            if state >> 60 == 0 {
                assert_eq!(parted.remove(&key), plain.remove(&key));
            } else if turn % 2 == 0 {
                assert_eq!(parted.insert(key, turn), plain.insert(key, turn));
            } else {
                assert_eq!(parted.entry(key).or_insert(turn), plain.entry(key).or_insert(turn));
            }
            assert_eq!(parted.get(&[turn, 0]), plain.get(&[turn, 0]));
        }
        assert_eq!(parted.parts.len(), PARTS);
        // They are about alike, so that none is large.
        assert!(parted.parts.iter().all(|part| part.len() * PARTS < 2 * parted.len()));
        parted.try_reserve(64).unwrap();
        let entries = |map: &PartedMap<[u32; 2], u32>| {
            let mut all: Vec<_> = map.iter().map(|(&k, &v)| (k, v)).collect();
            all.sort_unstable();
            all
        };
        let mut expected: Vec<_> = plain.iter().map(|(&k, &v)| (k, v)).collect();
        expected.sort_unstable();
        assert_eq!(parted.len(), expected.len());
        assert!(entries(&parted) == expected && entries(&parted.try_clone(&control).unwrap()) == expected);
        let mut renamed = parted.clone();
        renamed.rekey(&control, |[a, b], _| (a % 2 == 0).then_some([a / 2, b])).unwrap();
        let halves = expected.iter().filter(|([a, _], _)| a % 2 == 0).map(|&([a, b], v)| ([a / 2, b], v));
        assert!(entries(&renamed).into_iter().eq(halves));
        assert!(parted.sorted_keys(&control).unwrap().keep().into_iter().eq(expected.iter().map(|&(k, _)| k)));
        assert_eq!(control.looks(None, || drop(parted.try_clone(&control))), PARTS / PIECE + 1);
        control.cancel();
        assert!(parted.try_clone(&control).is_err() && parted.rekey(&control, |key, _| Some(key)).is_err());
        let pieces = (1..).take_while(|_| renamed.give_back()).count();
        assert_eq!((pieces, renamed.len()), (PARTS / PIECE - 1, 0));
    }
}
