//! What a [transaction](super::restore) goes back to where it changes large stars. To remove a vertex with a million tetrahedra takes seconds, and a control that
//! says stop in the middle of several splits can't wait for that. So before the first large change of which more may follow, all is copied, in pieces; from then on
//! the transaction can be cancelled anywhere, and to take it back is to put the copy in its place.
//!
//! A large split from which nothing follows, which is nearly all of them, needs no copy but [that of its insertion](crate::triangulation).

use super::refiner::Refiner;
use crate::domain::Boundary;
use crate::leavings::InPieces;
use crate::triangulation::{Triangulation, LARGE};
use crate::{Control, Error};

/// The mesh as it was amid a transaction.
#[derive(Debug)]
pub struct Kept {
    t: Triangulation,
    boundary: Boundary,
    /// How many of the transaction's splits had been made.
    records: usize,
    /// Of subsegments and subfacets in all.
    splits: [usize; 2],
}

impl Refiner<'_> {
    /// Whether the cavity in hand is large.
    pub(super) fn is_large(&self) -> bool {
        self.cavity.tets.len() + self.cavity.faces.len() >= LARGE
    }

    /// Copies the mesh before the first large split of a transaction, unless it is the only one in it. From then on the control counts again.
    pub(super) fn keep(&mut self, more_follows: bool) -> Result<(), Error> {
        let is_only = !more_follows && self.records.is_empty();
        if is_only || self.boundary.recovering || self.kept.is_some() {
            return Ok(());
        }
        let control = self.waiting_control.take().unwrap_or_else(|| self.control.clone());
        match self.copied(&control) {
            Ok(kept) => {
                self.kept = Some(Box::new(kept));
                self.control = control;
                Ok(())
            }
            // Then the transaction is one step.
            Err(Error::OutOfMemory { .. }) => {
                self.waiting_control = Some(control);
                Ok(())
            }
            Err(error) => Err(error),
        }
    }

    fn copied(&self, control: &Control) -> Result<Kept, Error> {
        let mut boundary = InPieces::new(self.boundary.try_clone(control)?, control);
        boundary.lazy = self.boundary.lazy;
        let t = self.t.try_clone(control)?;
        let splits = [self.segment_splits, self.facet_splits];
        Ok(Kept { t, boundary: boundary.keep(), records: self.records.len(), splits })
    }

    /// Puts the copy in place, if there is one: the splits since are taken back.
    pub(super) fn put_back(&mut self) {
        let Some(kept) = &mut self.kept else { return };
        std::mem::swap(self.t, &mut kept.t);
        std::mem::swap(self.boundary, &mut kept.boundary);
        [self.segment_splits, self.facet_splits] = kept.splits;
        let records = kept.records;
        self.forget_records(records);
        // What it holds now is of no use.
        self.keep_no_more();
    }

    /// Forgets the copy.
    pub(super) fn keep_no_more(&mut self) {
        if let Some(kept) = self.kept.take() {
            self.control.give_back(kept.t);
            self.control.give_back(kept.boundary);
        }
    }
}
