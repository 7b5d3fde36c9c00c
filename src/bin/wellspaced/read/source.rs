//! Where in the user's files each element stands, so that what the core finds wrong later is still named by file,
//! line and the number that the file gives it.

use std::path::{Path, PathBuf};

use wellspaced::{DomainElement, Error, Plc, PlcDefect};

use super::fields::Numbered;
use crate::failure::Failure;

/// The line and number of one element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The line, from 1.
    pub line: usize,
    /// The element's number in the file.
    pub number: usize,
}

/// The places of all elements of an input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The file the user named.
    pub path: PathBuf,
    /// The file of the points: a `.poly` may leave them to its `.node`.
    pub points_path: PathBuf,
    /// Whether elements are numbered from 0 or from 1.
    pub base: usize,
    /// The line of each point.
    pub points: Vec<u32>,
    pub segments: Vec<Place>,
    pub facets: Vec<Place>,
    pub holes: Vec<Place>,
    pub regions: Vec<Place>,
}

impl Source {
    pub fn new(path: &Path) -> Self {
        Source {
            path: path.to_owned(),
            points_path: path.to_owned(),
            base: 0,
            points: Vec::new(),
            segments: Vec::new(),
            facets: Vec::new(),
            holes: Vec::new(),
            regions: Vec::new(),
        }
    }

    /// Facets whose lines are not known are numbered, so that they are still named as the file has them when they have been cut or joined.
    pub fn number_facets(&mut self, count: usize) {
        let known = self.facets.len();
        self.facets.extend((known..count).map(|number| Place { line: 0, number }));
    }

    /// Facet `i` has become a part of facet `group[i]` of `count`. Each is named by the first of its parts.
    pub fn join(&mut self, group: &[u32], count: usize) {
        let mut first = vec![Place { line: 0, number: 0 }; count];
        for (&place, &new) in self.facets.iter().zip(group).rev() {
            first[new as usize] = place;
        }
        self.facets = first;
    }

    /// New facet `i` is a part of facet `origins[i]`.
    pub fn cut(&mut self, origins: &[u32]) {
        self.facets = origins.iter().map(|&old| self.facets[old as usize]).collect();
    }

    /// The files that were read.
    pub fn files(&self) -> [&Path; 2] {
        [&self.path, &self.points_path]
    }

    /// The core's error as a line that names this input's file, line and element.
    pub fn explain(&self, error: &Error) -> Failure {
        match error {
            Error::NotFinite { index, .. } => self.point(*index, "a coordinate is not finite"),
            Error::OutOfRange { index, .. } => self.point(
                *index,
                "a coordinate is outside the range of the exact predicates (0, or a magnitude from 2^-142 to 2^201)",
            ),
            Error::InvalidDomain { element, problem } => self.element(*element, problem),
            other => Failure::in_file(&self.path, other),
        }
    }

    fn point(&self, index: usize, problem: &str) -> Failure {
        let element = Numbered("point", index + self.base);
        match self.points.get(index) {
            Some(&line) => Failure::in_line(&self.points_path, line as usize, element, problem),
            None => Failure::in_file(&self.points_path, format_args!("{element}: {problem}")),
        }
    }

    fn element(&self, element: DomainElement, problem: &str) -> Failure {
        if let DomainElement::Point(index) = element {
            return self.point(index, problem);
        }
        let name = self.name(element);
        match self.place(element) {
            (_, _, Some(line)) => Failure::in_line(&self.path, line, name, problem),
            _ => Failure::in_file(&self.path, format_args!("{name}: {problem}")),
        }
    }

    /// What kind of element the file has it as, its number there, and its line where that is known.
    pub fn place(&self, element: DomainElement) -> (&'static str, Option<usize>, Option<usize>) {
        let (kind, places, index) = match element {
            DomainElement::Point(index) => {
                let line = self.points.get(index).map(|&line| line as usize);
                return ("point", Some(index + self.base), line);
            }
            // The file has them as facets without a polygon that spans a plane.
            DomainElement::Segment(index) => ("segment", &self.segments, index),
            DomainElement::Facet(index) => ("facet", &self.facets, index),
            DomainElement::Hole(index) => ("hole", &self.holes, index),
            DomainElement::Region(index) => ("region", &self.regions, index),
            _ => return ("domain", None, None),
        };
        match places.get(index) {
            Some(place) => (kind, Some(place.number), (place.line > 0).then_some(place.line)),
            None => (kind, Some(index), None),
        }
    }

    /// An element's name as the file has it.
    pub fn name(&self, element: DomainElement) -> String {
        match self.place(element) {
            // In a `.poly` a segment is a facet of two corners.
            ("segment", Some(number), _) => format!("segment of facet {number}"),
            (kind, Some(number), _) => format!("{kind} {number}"),
            (kind, None, _) => kind.to_owned(),
        }
    }

    /// [`explain`](Self::explain) for an error of this domain: where it names a second element, the core has its own number for that.
    pub fn explain_domain(&self, error: &Error, plc: &Plc) -> Failure {
        let Error::InvalidDomain { problem, .. } = error else { return self.explain(error) };
        // Seldom, and then nothing else takes time.
        let found = plc.check();
        let same = found.errors().find(|defect| defect.elements.len() == 2 && defect.problem() == *problem);
        same.map_or_else(|| self.explain(error), |defect| self.failure(defect))
    }

    /// A defect as a line that names this input's file, line and elements.
    pub fn describe(&self, defect: &PlcDefect) -> String {
        self.failure(defect).message().to_owned()
    }

    fn failure(&self, defect: &PlcDefect) -> Failure {
        let first = defect.elements.first().copied().unwrap_or(DomainElement::Whole);
        let mut problem = defect.problem();
        if let Some(&other) = defect.elements.get(1) {
            problem = problem.replacen(&other.to_string(), &self.name(other), 1);
        }
        self.element(first, &problem)
    }
}
