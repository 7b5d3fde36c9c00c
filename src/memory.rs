//! Memory for what grows with the mesh: where there is none, that is an error of the call and not the end of the process. Lists that stay
//! small are left to the language, which has no answer to that.

use std::collections::VecDeque;

use crate::leavings::InPieces;
use crate::{Control, Error};

/// Elements copied between two looks at the control.
const BLOCK: usize = 1 << 16;
/// Bytes copied between two looks at the control where elements are large: some tenths of a millisecond, a millisecond where the memory is new.
pub(crate) const PIECE: usize = 1 << 20;
/// Elements of a list that takes time to move.
const LONG: usize = 1 << 16;
/// Elements that one step of a refinement may add.
pub(crate) const STEP: usize = 4096;

fn none_for<E>(what: &'static str) -> impl FnOnce(E) -> Error {
    move |_| Error::OutOfMemory { what }
}

/// Room for so many more elements.
pub(crate) fn reserve<T>(list: &mut Vec<T>, more: usize, what: &'static str) -> Result<(), Error> {
    list.try_reserve(more).map_err(none_for(what))
}

/// Empties a list, with room for so many elements. What it has taken is given back in pieces if it is not enough: to have it made longer would be a copy of what nobody
/// needs.
pub(crate) fn reserve_anew<T: Send + 'static>(
    list: &mut Vec<T>,
    count: usize,
    what: &'static str,
    control: &Control,
) -> Result<(), Error> {
    debug_assert!(!std::mem::needs_drop::<T>());
    if list.capacity() >= count {
        list.clear();
    } else {
        control.give_back(std::mem::take(list));
        *list = with_room(count, what)?;
    }
    Ok(())
}

/// [`reserve`], and no more than that.
pub(crate) fn reserve_exact<T>(list: &mut Vec<T>, more: usize, what: &'static str) -> Result<(), Error> {
    list.try_reserve_exact(more).map_err(none_for(what))
}

/// An empty list with room for so many elements.
pub(crate) fn with_room<T>(count: usize, what: &'static str) -> Result<Vec<T>, Error> {
    let mut list = Vec::new();
    list.try_reserve_exact(count).map_err(none_for(what))?;
    Ok(list)
}

/// An empty list with room for so many elements, that is given back in pieces.
pub(crate) fn room_in_pieces<'a, T: Send + 'static>(
    count: usize,
    what: &'static str,
    control: &'a Control,
) -> Result<InPieces<'a, Vec<T>>, Error> {
    Ok(InPieces::new(with_room(count, what)?, control))
}

/// A list of so many zeros; [`Error::Cancelled`] when the control says so before it is whole.
pub(crate) fn zeroed<'a, T: Copy + Default + Send + 'static>(
    count: usize,
    what: &'static str,
    control: &'a Control,
) -> Result<InPieces<'a, Vec<T>>, Error> {
    filled(count, T::default(), what, control)
}

/// [`zeroed`], with another value.
pub(crate) fn filled<'a, T: Copy + Send + 'static>(
    count: usize,
    value: T,
    what: &'static str,
    control: &'a Control,
) -> Result<InPieces<'a, Vec<T>>, Error> {
    let mut list = room_in_pieces(count, what, control)?;
    while list.len() < count {
        control.check()?;
        let end = count.min(list.len() + BLOCK);
        list.resize(end, value);
    }
    Ok(list)
}

/// A copy of a list; [`Error::Cancelled`] when the control says so before it is whole.
pub(crate) fn copied<T: Copy + Send + 'static>(
    from: &[T],
    what: &'static str,
    control: &Control,
) -> Result<Vec<T>, Error> {
    copied_with_room(from, 0, what, control)
}

/// [`copied`], with room for so many more elements: where the alignment is a large one, to make it later would be another copy.
pub(crate) fn copied_with_room<T: Copy + Send + 'static>(
    from: &[T],
    more: usize,
    what: &'static str,
    control: &Control,
) -> Result<Vec<T>, Error> {
    let mut list = room_in_pieces(from.len() + more, what, control)?;
    extend(&mut list, from, control)?;
    Ok(list.keep())
}

/// Puts elements behind a list that has the room for them, as many as the control lets it.
fn extend<T: Copy>(list: &mut Vec<T>, from: &[T], control: &Control) -> Result<(), Error> {
    for block in from.chunks(BLOCK.min(PIECE / size_of::<T>().max(1))) {
        control.check()?;
        list.extend_from_slice(block);
    }
    Ok(())
}

/// [`copied`], for a queue.
pub(crate) fn copied_queue<T: Copy + Send + 'static>(
    from: &VecDeque<T>,
    what: &'static str,
    control: &Control,
) -> Result<VecDeque<T>, Error> {
    copied_queue_with_room(from, 0, what, control)
}

fn copied_queue_with_room<T: Copy + Send + 'static>(
    from: &VecDeque<T>,
    more: usize,
    what: &'static str,
    control: &Control,
) -> Result<VecDeque<T>, Error> {
    let (head, tail) = from.as_slices();
    let mut list = room_in_pieces(from.len() + more, what, control)?;
    extend(&mut list, head, control)?;
    extend(&mut list, tail, control)?;
    Ok(list.keep().into())
}

/// Room for so many more elements, and for as many as there are if that is not there yet: what [`reserve`] does, but in pieces, and [`Error::Cancelled`] when the control
/// says so. Nothing has changed then.
pub(crate) fn grow<T: Copy + Send + 'static>(
    list: &mut Vec<T>,
    more: usize,
    what: &'static str,
    control: &Control,
) -> Result<(), Error> {
    if list.capacity() - list.len() < more {
        let longer = copied_with_room(list, more.max(list.len()), what, control)?;
        control.give_back(std::mem::replace(list, longer));
    }
    Ok(())
}

/// [`grow`] for a list that is a long one by now, [`reserve`] for a short one, which takes no time.
#[inline]
pub(crate) fn grow_long<T: Copy + Send + 'static>(
    list: &mut Vec<T>,
    more: usize,
    what: &'static str,
    control: &Control,
) -> Result<(), Error> {
    if list.len() < LONG {
        return reserve(list, more, what);
    }
    grow(list, more, what, control)
}

/// [`grow_long`], for a queue.
pub(crate) fn grow_queue<T: Copy + Send + 'static>(
    list: &mut VecDeque<T>,
    more: usize,
    what: &'static str,
    control: &Control,
) -> Result<(), Error> {
    if list.len() < LONG {
        return list.try_reserve(more).map_err(none_for(what));
    }
    if list.capacity() - list.len() < more {
        let longer = copied_queue_with_room(list, more.max(list.len()), what, control)?;
        control.give_back(std::mem::replace(list, longer));
    }
    Ok(())
}

/// Makes a list longer, in pieces: so many elements, the new ones of that value. When the control says stop it may have some of them.
pub(crate) fn lengthen<T: Copy + Send + 'static>(
    list: &mut Vec<T>,
    count: usize,
    value: T,
    what: &'static str,
    control: &Control,
) -> Result<(), Error> {
    let more = count.saturating_sub(list.len());
    if list.capacity() - list.len() < more {
        let longer = copied_with_room(list, more, what, control)?;
        control.give_back(std::mem::replace(list, longer));
    }
    while list.len() < count {
        control.check()?;
        let end = count.min(list.len() + BLOCK);
        list.resize(end, value);
    }
    Ok(())
}

/// Sets the elements at these places, if there are such, back to what all others are: the whole list where they are a good part of it, which takes a tenth of
/// the time.
#[inline]
pub(crate) fn reset_at<T: Copy>(list: &mut [T], value: T, places: impl ExactSizeIterator<Item = u32>) {
    const MANY: usize = 1 << 14;
    if places.len() > MANY && places.len() > list.len() / 32 {
        return list.fill(value);
    }
    for place in places {
        if let Some(element) = list.get_mut(place as usize) {
            *element = value;
        }
    }
}

/// The bytes that a list has taken, and those that it will take besides while it next grows, if that is near.
pub(crate) fn bytes<T>(list: &Vec<T>) -> usize {
    let now = list.capacity() * size_of::<T>();
    // It grows to twice the size, and both are there while it is copied.
    if list.len() + STEP > list.capacity() {
        now.max(STEP * size_of::<T>()) * 3
    } else {
        now
    }
}

/// Asks for what is at an address before it is needed. Where it points does not matter: nothing is read.
#[inline(always)]
pub(crate) fn prefetch<T>(address: *const T) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a hint to the cache, which no address makes fail.
    unsafe {
        use std::arch::x86_64::{_mm_prefetch, _MM_HINT_T0};
        _mm_prefetch::<_MM_HINT_T0>(address.cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
}
