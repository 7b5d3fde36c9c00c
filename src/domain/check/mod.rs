//! What is wrong with a complex, all of it, before anything is built from it.
//!
//! | module | idea |
//! |---|---|
//! | [`defect`] | the kinds of defects, and how each is told |
//! | `arrangement` | points, segments and triangles of the complex by themselves: duplicates merged, facets triangulated |
//! | `boxes` | R-trees of bounding boxes |
//! | `meet` | which of them meet where they should not: exact predicates on pairs from these |
//! | `edges` | open and branching edges, and the smallest angles |
//!
//! Whether two elements meet is decided exactly. Only planarity has a tolerance, because points on a slanted plane have no exact coordinates; points that
//! nothing else names have the same.

pub(crate) mod arrangement;
mod boxes;
mod close;
pub mod defect;
mod edges;
mod meet;

#[cfg(test)]
mod tests;

pub use defect::{PlcDefect, PlcDefectKind, Severity};

use super::plc::Plc;
use crate::leavings::{give_elements_back, InPieces, Leavings};
use crate::sorting::sort_by;
use crate::{Control, DVec3, DomainElement, Error};
use arrangement::Arrangement;

/// What [`Plc::check`] has found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlcCheck {
    /// All defects, errors before warnings, in a fixed order.
    pub defects: Vec<PlcDefect>,
    /// The smallest angle at which two segments meet, if any do.
    pub segment_angle: Option<SmallAngle>,
    /// The smallest angle at which two facets meet along a segment, if any do.
    pub facet_angle: Option<SmallAngle>,
}

/// An angle of the input.
#[derive(Clone, Debug, PartialEq)]
pub struct SmallAngle {
    /// From 0 to 180.
    pub degrees: f64,
    /// The elements that meet there.
    pub elements: [DomainElement; 2],
    /// A point where they do.
    pub place: DVec3,
}

impl PlcCheck {
    /// The defects for which the complex can't be meshed.
    pub fn errors(&self) -> impl Iterator<Item = &PlcDefect> {
        self.defects.iter().filter(|defect| defect.kind.severity() == Severity::Error)
    }
}

impl Plc {
    /// Finds every defect of the complex and its smallest angles.
    ///
    /// Errors are what makes it unusable: numbers that name no point, coordinates out of range, facets that are not planar, that
    /// have no area or sides that cross, and segments and facets that meet anywhere but at common points and segments. Warnings are what meshing
    /// copes with but the caller may not have meant: duplicate points, points on segments and facets, edges with one facet or more than two.
    ///
    /// Cost: n log n in the size of the complex, and linear in the pairs of elements whose bounding boxes meet.
    pub fn check(&self) -> PlcCheck {
        self.check_within(&Control::new()).unwrap_or_default()
    }

    /// [`check`](Self::check), unless a control cancels it: [`Error::Cancelled`].
    pub fn check_within(&self, control: &Control) -> Result<PlcCheck, Error> {
        self.examine(true, control).map(|(check, _)| check.keep())
    }

    /// The complex taken apart, or the first error.
    pub(crate) fn arrange<'a>(&self, control: &'a Control) -> Result<InPieces<'a, Arrangement>, Error> {
        let (check, arrangement) = self.examine(false, control)?;
        // Of those that are alike in their order, the one found first.
        let first = check.errors().min_by(|a, b| PlcDefect::order(a, b)).map(PlcDefect::error);
        first.map_or(Ok(arrangement), Err)
    }

    /// With `all`, also what is no error and only of interest, and in order.
    fn examine<'a>(
        &self,
        all: bool,
        control: &'a Control,
    ) -> Result<(InPieces<'a, PlcCheck>, InPieces<'a, Arrangement>), Error> {
        let mut check = InPieces::new(PlcCheck::default(), control);
        let mut arrangement = Arrangement::new(self, &mut check.defects, control)?;
        meet::find(self, &mut arrangement, &mut check.defects, control)?;
        control.check()?;
        if all {
            edges::find(&arrangement, &mut check, control)?;
            check.defects = in_order(std::mem::take(&mut check.defects), control)?;
        }
        Ok((check, arrangement))
    }
}

impl Leavings for PlcCheck {
    fn give_back(&mut self) -> bool {
        /// Defects given back at once: each has memory of its own.
        const PART: usize = 1 << 12;
        give_elements_back(&mut self.defects, PART)
    }
}

/// Defects in their order; those that are alike in it, as they were found.
fn in_order(defects: Vec<PlcDefect>, control: &Control) -> Result<Vec<PlcDefect>, Error> {
    let mut order: Vec<usize> = (0..defects.len()).collect();
    sort_by(&mut order, &control.watch(), |&i, &j| PlcDefect::order(&defects[i], &defects[j]).then(i.cmp(&j)))?;
    let mut defects: Vec<Option<PlcDefect>> = defects.into_iter().map(Some).collect();
    Ok(order.into_iter().filter_map(|i| defects[i].take()).collect())
}
