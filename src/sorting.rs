//! Sorting that a control can cancel: parts are sorted, then merged.

use std::cmp::Ordering;

use crate::control::Watch;
use crate::{memory, Error};

/// Elements that are sorted between two looks at the control: about a millisecond.
const PART: usize = 1 << 13;
/// Elements that are merged.
const POLL_INTERVAL: usize = 1 << 12;

/// Sorts a list, unless the control says stop: then it has the same elements in some order, or some of them twice.
pub(crate) fn sort<T: Copy + Ord + Send + 'static>(list: &mut [T], watch: &Watch<'_>) -> Result<(), Error> {
    sort_by(list, watch, T::cmp)
}

/// [`sort`], and of what is there several times one remains.
pub(crate) fn sort_unique<T: Copy + Ord + Send + 'static>(list: &mut Vec<T>, watch: &Watch<'_>) -> Result<(), Error> {
    sort(list, watch)?;
    let mut kept = 0;
    for i in 0..list.len() {
        if i % POLL_INTERVAL == 0 {
            watch.check()?;
        }
        if kept == 0 || list[kept - 1] != list[i] {
            list[kept] = list[i];
            kept += 1;
        }
    }
    list.truncate(kept);
    Ok(())
}

/// [`sort`] by an order of which no two elements are the same.
pub(crate) fn sort_by<T: Copy + Send + 'static>(
    list: &mut [T],
    watch: &Watch<'_>,
    compare: impl Fn(&T, &T) -> Ordering,
) -> Result<(), Error> {
    for part in list.chunks_mut(PART) {
        watch.check()?;
        part.sort_unstable_by(&compare);
    }
    if list.len() <= PART {
        return Ok(());
    }
    let Ok(mut merged) = memory::room_in_pieces(list.len(), "order", watch.control()) else {
        // Slower to stop, but no less right.
        list.sort_unstable_by(compare);
        return Ok(());
    };
    let mut size = PART;
    while size < list.len() {
        merged.clear();
        for pair in list.chunks(2 * size) {
            let (mut a, mut b) = pair.split_at(size.min(pair.len()));
            while let (Some(x), Some(y)) = (a.first(), b.first()) {
                if merged.len() % POLL_INTERVAL == 0 {
                    watch.check()?;
                }
                if compare(x, y) == Ordering::Greater {
                    merged.push(*y);
                    b = &b[1..];
                } else {
                    merged.push(*x);
                    a = &a[1..];
                }
            }
            for rest in a.chunks(PART).chain(b.chunks(PART)) {
                watch.check()?;
                merged.extend_from_slice(rest);
            }
        }
        for (part, merged) in list.chunks_mut(PART).zip(merged.chunks(PART)) {
            watch.check()?;
            part.copy_from_slice(merged);
        }
        size *= 2;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Control;

    #[test]
    fn long_lists_are_sorted_in_parts() {
        for count in [0, 1, PART, PART + 1, 5 * PART + 77] {
            let mut list: Vec<(usize, usize)> = (0..count).map(|i| (i * 7919 % 1009, i)).collect();
            let mut expected = list.clone();
            expected.sort_unstable();
            sort(&mut list, &Control::new().watch()).unwrap();
            assert!(list == expected, "{count}");
            sort_by(&mut list, &Control::new().watch(), |a, b| b.cmp(a)).unwrap();
            assert!(list.iter().rev().eq(&expected), "{count}");
        }
    }

    #[test]
    fn a_cancellation_is_remembered() {
        let control = Control::new();
        control.cancel();
        let watch = control.watch();
        assert_eq!(sort(&mut [2, 1], &watch), Err(Error::Cancelled));
        control.reset();
        assert!(!watch.poll() && watch.end().is_err());
    }
}
