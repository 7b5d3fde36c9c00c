//! Large changes that can be cancelled in the middle. Tetrahedra half of which have been replaced are of no use to anybody, and to put the old ones back
//! would take as long as it took to replace them. So a copy of all of them is made before, in pieces, and takes their place at once when it comes to that.
//!
//! It costs some nanoseconds a tetrahedron. What changes fewer than some ten thousand has no copy and is not interrupted.

use super::Triangulation;
use crate::{Control, Error};

/// Changes of fewer tetrahedra take some milliseconds.
pub(crate) const LARGE: usize = if cfg!(test) { 1 << 9 } else { 1 << 15 };

impl Triangulation {
    /// Makes a change of so many tetrahedra, which touches nothing else that matters. When it is cancelled, they are as they were before.
    #[inline]
    pub(super) fn change<R>(
        &mut self,
        count: usize,
        control: &Control,
        change: impl FnOnce(&mut Triangulation, &Control) -> Result<R, Error>,
    ) -> Result<R, Error> {
        if count < LARGE || control.is_never() {
            return change(self, Control::never());
        }
        self.change_large(control, change)
    }

    #[cold]
    #[inline(never)]
    fn change_large<R>(
        &mut self,
        control: &Control,
        change: impl FnOnce(&mut Triangulation, &Control) -> Result<R, Error>,
    ) -> Result<R, Error> {
        let mut kept = match self.topology.try_clone(0, control) {
            Ok(copy) => copy,
            // Better late than never.
            Err(Error::OutOfMemory { .. }) => return change(self, Control::never()),
            Err(error) => return Err(error),
        };
        let result = change(self, control);
        if result.is_err() {
            std::mem::swap(&mut self.topology, &mut kept);
        }
        control.give_back(kept);
        result
    }
}
