//! What is behind a handle: a value with a count of the calls that are reading it, or a mark that one is
//! changing it, and a mark that a panic left it broken.
//!
//! C can't promise that nobody reads what another call is changing (a callback that uses the handle of its own
//! call, two threads without a lock). Here that is an answer, `WSP_ERR_BUSY`, instead of undefined behaviour,
//! for two atomic operations a call.

use std::cell::UnsafeCell;
use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use super::guard::Failure;
use super::status::{WSP_ERR_BUSY, WSP_ERR_INTERNAL};

const CHANGING: u32 = u32::MAX;

pub(super) struct Handle<T> {
    /// The number of calls reading, or `CHANGING`.
    calls: AtomicU32,
    poisoned: AtomicBool,
    value: UnsafeCell<T>,
}

// SAFETY: `calls` lets either readers or one writer in, as a read-write lock does, so the same bounds hold.
unsafe impl<T: Send + Sync> Sync for Handle<T> {}

fn busy(what: &str) -> Failure {
    Failure::new(WSP_ERR_BUSY, format!("another call is {what} the handle"))
}

impl<T> Handle<T> {
    pub fn new(value: T) -> Handle<T> {
        Handle { calls: AtomicU32::new(0), poisoned: AtomicBool::new(false), value: UnsafeCell::new(value) }
    }

    /// For a call that does not change the value. Any number of them run at once.
    pub fn read(&self) -> Result<Read<'_, T>, Failure> {
        let entered = self.calls.fetch_update(Ordering::Acquire, Ordering::Relaxed, |calls| {
            // CHANGING − 1 readers can't be: there are not as many threads.
            (calls < CHANGING - 1).then(|| calls + 1)
        });
        entered.map_err(|_| busy("changing"))?;
        let read = Read { handle: self, panicking: std::thread::panicking() };
        self.check_poison()?;
        #[cfg(test)]
        injected::panic_if_asked();
        Ok(read)
    }

    /// For a call that changes the value: the only one on the handle.
    pub fn write(&self) -> Result<Write<'_, T>, Failure> {
        let entered = self.calls.compare_exchange(0, CHANGING, Ordering::Acquire, Ordering::Relaxed);
        entered.map_err(|calls| busy(if calls == CHANGING { "changing" } else { "reading" }))?;
        let write = Write { handle: self, panicking: std::thread::panicking() };
        self.check_poison()?;
        #[cfg(test)]
        injected::panic_if_asked();
        Ok(write)
    }

    /// Whether a call is running on the handle.
    pub fn in_use(&self) -> bool {
        self.calls.load(Ordering::Acquire) != 0
    }

    fn check_poison(&self) -> Result<(), Failure> {
        if self.poisoned.load(Ordering::Acquire) {
            return Err(Failure::new(WSP_ERR_INTERNAL, "the handle is unusable since an internal error: free it"));
        }
        Ok(())
    }

    fn poison_after_panic(&self, panicking_before: bool) {
        if !panicking_before && std::thread::panicking() {
            self.poisoned.store(true, Ordering::Release);
        }
    }
}

/// Permission to read.
pub(super) struct Read<'a, T> {
    handle: &'a Handle<T>,
    panicking: bool,
}

impl<T> Deref for Read<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        // SAFETY: `calls` counts this reader, so there is no writer until it is dropped.
        unsafe { &*self.handle.value.get() }
    }
}

impl<T> Drop for Read<'_, T> {
    fn drop(&mut self) {
        self.handle.poison_after_panic(self.panicking);
        self.handle.calls.fetch_sub(1, Ordering::Release);
    }
}

/// Permission to change.
pub(super) struct Write<'a, T> {
    handle: &'a Handle<T>,
    panicking: bool,
}

impl<T> Deref for Write<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        // SAFETY: `calls` is CHANGING until this is dropped, so nobody else has access.
        unsafe { &*self.handle.value.get() }
    }
}

impl<T> DerefMut for Write<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        // SAFETY: as above, and `&mut self` rules out a second reference through this guard.
        unsafe { &mut *self.handle.value.get() }
    }
}

impl<T> Drop for Write<'_, T> {
    fn drop(&mut self) {
        self.handle.poison_after_panic(self.panicking);
        self.handle.calls.store(0, Ordering::Release);
    }
}

#[cfg(test)]
pub(super) mod injected {
    //! A panic in the middle of a call, for tests.

    use std::cell::Cell;

    thread_local! {
        static ASKED: Cell<bool> = const { Cell::new(false) };
    }

    /// Lets the thread's next call panic as soon as it has entered a handle.
    pub fn ask() {
        ASKED.set(true);
    }

    pub fn panic_if_asked() {
        if ASKED.replace(false) {
            panic!("injected by a test");
        }
    }
}
