//! Memory given back in pieces. What a million points take the system needs some 30 ms to take back, longer than a cancelled call may go on. So a call
//! looks at its control between the pieces, and after a cancellation the rest stays with the control, until that is reset or dropped.

use std::collections::VecDeque;
use std::ops::{Deref, DerefMut};

use crate::Control;

/// Bytes of a piece: some tenths of a millisecond.
const PIECE: usize = 1 << 22;

/// Blocks of this alignment and less are changed where they are.
const ALIGNED: usize = 16;

/// What has memory to give back.
pub(crate) trait Leavings: Send {
    /// Gives a piece of it back; `false` when there is none left but what a drop takes no time for.
    fn give_back(&mut self) -> bool;
}

impl<T: Send> Leavings for Vec<T> {
    fn give_back(&mut self) -> bool {
        debug_assert!(!std::mem::needs_drop::<T>());
        let piece = PIECE / size_of::<T>().max(1);
        if self.capacity() == 0 {
            return false;
        }
        // Allocators cut off the end of a large block where it is. Not where the alignment is a large one: then Rust moves what remains, so that
        // the block stays, and the system is given its pages.
        if align_of::<T>() > ALIGNED && self.len() > piece {
            let rest = self.len() - piece;
            let pages = self[rest..].as_mut_ptr_range();
            self.truncate(rest);
            // SAFETY: what is behind a list's end belongs to the list, and nobody reads it before it is written.
            unsafe { give_pages_back(pages.start.cast(), pages.end.cast()) };
        } else if self.capacity() <= piece || align_of::<T>() > ALIGNED {
            *self = Vec::new();
        } else {
            self.clear();
            self.shrink_to(self.capacity() - piece);
        }
        true
    }
}

/// Allocators leave small blocks that were freed as they are, and put all of them together with their neighbours when a larger one is asked for. A
/// million of them take tens of milliseconds: better now and then than all at once.
pub(crate) fn join_freed_blocks() {
    std::hint::black_box(Vec::<u8>::with_capacity(1 << 12));
}

/// As for a list of plain elements, of elements that own memory: `part` of them at a time, then the list's own.
pub(crate) fn give_elements_back<T>(list: &mut Vec<T>, part: usize) -> bool {
    let piece = PIECE / size_of::<T>().max(1);
    if !list.is_empty() {
        list.truncate(list.len().saturating_sub(part));
        join_freed_blocks();
    } else if list.capacity() > piece {
        list.shrink_to(list.capacity() - piece);
    } else {
        *list = Vec::new();
        return false;
    }
    true
}

impl<T: Send> Leavings for VecDeque<T> {
    fn give_back(&mut self) -> bool {
        // As a list, of which nothing has to be moved unless elements were taken off its front.
        let mut list = Vec::from(std::mem::take(self));
        let more = list.give_back();
        *self = list.into();
        more
    }
}

/// Gives the system the pages within a part of the process's memory, which stays allocated. Where that can't be done, they go with the rest.
///
/// # Safety
/// Nobody reads what was there any more.
#[cfg(all(target_os = "linux", not(miri)))]
unsafe fn give_pages_back(start: *mut u8, end: *mut u8) {
    extern "C" {
        fn madvise(start: *mut u8, length: usize, advice: i32) -> i32;
    }
    const MADV_DONTNEED: i32 = 4;
    /// No page is larger, but for those that a process has to ask for.
    const PAGE: usize = 1 << 16;
    let skipped = start.align_offset(PAGE);
    let length = (end.addr() - start.addr()).saturating_sub(skipped) & !(PAGE - 1);
    if length > 0 {
        // SAFETY: whole pages of what the caller does without; they read as zeros from now on. An error changes nothing.
        unsafe { madvise(start.wrapping_add(skipped), length, MADV_DONTNEED) };
    }
}

#[cfg(not(all(target_os = "linux", not(miri))))]
unsafe fn give_pages_back(_start: *mut u8, _end: *mut u8) {}

/// Things that have memory to give back, one after the other.
#[derive(Debug)]
pub(crate) struct Each<L>(pub Vec<L>);

impl<L> Default for Each<L> {
    fn default() -> Self {
        Each(Vec::new())
    }
}

impl<L: Leavings> Leavings for Each<L> {
    fn give_back(&mut self) -> bool {
        while let Some(last) = self.0.last_mut() {
            if last.give_back() {
                return true;
            }
            self.0.pop();
        }
        false
    }
}

/// A value that is given back in pieces when it goes out of scope, by an early return perhaps.
#[derive(Debug)]
pub(crate) struct InPieces<'a, L: Leavings + Default + 'static> {
    value: L,
    control: &'a Control,
}

impl<'a, L: Leavings + Default + 'static> InPieces<'a, L> {
    pub fn new(value: L, control: &'a Control) -> Self {
        InPieces { value, control }
    }

    /// The value, which is the caller's now.
    pub fn keep(mut self) -> L {
        std::mem::take(&mut self.value)
    }
}

impl<L: Leavings + Default + 'static> Deref for InPieces<'_, L> {
    type Target = L;

    fn deref(&self) -> &L {
        &self.value
    }
}

impl<L: Leavings + Default + 'static> DerefMut for InPieces<'_, L> {
    fn deref_mut(&mut self) -> &mut L {
        &mut self.value
    }
}

impl<L: Leavings + Default + 'static> Drop for InPieces<'_, L> {
    fn drop(&mut self) {
        self.control.give_back(std::mem::take(&mut self.value));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_stays_with_a_cancelled_control_until_it_is_reset() {
        let control = Control::new();
        drop(InPieces::new(vec![0u8; 3 * PIECE], &control));
        assert_eq!(control.leavings(), 0);
        control.cancel();
        drop(InPieces::new(vec![0u8; 3 * PIECE], &control));
        control.give_back(vec![0u64; 10]);
        assert_eq!(control.clone().leavings(), 2);
        control.reset();
        assert_eq!(control.leavings(), 0);
        assert_eq!(InPieces::new(vec![1, 2], &control).keep(), [1, 2]);
    }

    #[test]
    fn pieces_come_to_an_end() {
        let mut list = vec![0u64; PIECE / 2];
        let mut pieces = 0;
        while list.give_back() {
            pieces += 1;
        }
        assert_eq!((pieces, list.capacity()), (4, 0));
        // Of a large alignment, and what has not been given back yet is still there.
        #[repr(align(32))]
        #[derive(Clone, Copy)]
        struct Line([u32; 8]);
        let mut list: Vec<Line> = (0..PIECE as u32 / 8).map(|i| Line([i; 8])).collect();
        let mut pieces = 0;
        while list.give_back() {
            pieces += 1;
            assert!((0u32..).zip(&list).all(|(i, line)| line.0 == [i; 8]));
        }
        assert_eq!((pieces, list.capacity()), (4, 0));
        let mut each = Each(vec![vec![1u8]; 5]);
        assert!((0..5).all(|_| each.give_back()) && !each.give_back());
    }
}
