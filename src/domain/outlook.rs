//! What a vertex that is to split boundary elements will bring, told from its cavity before anything changes. The star to come has a tetrahedron for each of the
//! cavity's faces, and very many where the vertex stands beside one with a large star: then to look through it takes long, and only as long as nothing has
//! changed can a control say stop.

use super::boundary::{edge_key, face_key, face_keys, Boundary};
use super::elements::Corners;
use super::facet::FacetChange;
use super::pending::Demand;
use super::waiting::State;
use crate::sorting::sort_by;
use crate::triangulation::topology::{slot_of, tet_of};
use crate::triangulation::Triangulation;
use crate::{Control, DVec3, Error};

/// A vertex to come, or one that is there already, and the split that it is for.
#[derive(Clone, Copy)]
pub(crate) struct Coming<'a> {
    pub vertex: u32,
    pub at: DVec3,
    /// The subsegment that it splits, if it is one.
    pub edge: Option<[u32; 2]>,
    /// What it changes in facets.
    pub changes: &'a [(u32, FacetChange)],
    /// The faces around its cavity, or its star, as handles inside.
    pub faces: &'a [u32],
    /// Subfacets that go with the cavity.
    pub going: &'a [[u32; 3]],
}

/// What is seen beforehand.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outlook {
    /// New elements that will be missing, and others that something encroaches upon.
    missing_segments: Vec<[u32; 2]>,
    missing_facets: Vec<[u32; 3]>,
    encroached_segments: Vec<[u32; 2]>,
    encroached_facets: Vec<[u32; 3]>,
    /// Where rounding puts the vertex off the plane of its facet: a triangle that was a subfacet and is a face still will lie beside the facet, and the flat
    /// tetrahedron between them comes to the other side of it. The places of these among the faces, and the tetrahedra beyond.
    flat: Vec<(u32, u32)>,
    pub labels: LabelsAhead,
}

impl Outlook {
    /// Whether a new element will be missing.
    pub fn misses(&self) -> bool {
        !self.missing_segments.is_empty() || !self.missing_facets.is_empty()
    }
}

/// What the labels in a star to come will show, provided that there were different ones on the two sides of subfacets only. Nothing where there are no labels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LabelsAhead {
    /// There will be different ones on the two sides of a face that is no subfacet.
    pub leak: bool,
    /// All new subfacets will be between different ones.
    pub parted: bool,
    /// A subfacet will be between equal ones. Looked for only if it matters.
    pub hide: bool,
}

/// An edge of the cavity's surface with which the vertex makes a new subfacet, or at which labels may change.
#[derive(Clone, Copy)]
struct Side {
    /// Its vertices.
    key: u64,
    /// The new subfacet's place among all that are created; [`NONE`] for no subfacet.
    created: u32,
    label: Option<u16>,
    parts: bool,
    state: State,
}

const NONE: u32 = u32::MAX;

impl Side {
    fn new(key: u64, created: u32) -> Side {
        Side { key, created, label: None, parts: false, state: State::Missing }
    }
}

fn side_key(a: u32, b: u32) -> u64 {
    u64::from(a.min(b)) << 32 | u64::from(a.max(b))
}

impl Boundary {
    /// Looks at what a vertex will bring. [`Error::Cancelled`] when the control says stop.
    pub(crate) fn foresee(&self, t: &Triangulation, coming: Coming, control: &Control) -> Result<Outlook, Error> {
        let mut outlook = Outlook::default();
        self.foresee_parts(t, coming, &mut outlook, control)?;
        let Coming { vertex, changes, faces, going, .. } = coming;
        if changes.is_empty() && going.is_empty() && t.topology.region.is_empty() {
            return Ok(outlook);
        }
        let turns = control.turns();
        let removed = face_keys(changes.iter().flat_map(|(_, change)| &change.removed), control)?;
        let across = |face: [u32; 3]| {
            debug_assert!(face.contains(&vertex));
            let at = face.iter().position(|&v| v == vertex).unwrap_or(0);
            [face[(at + 1) % 3], face[(at + 2) % 3]]
        };
        let created =
            || changes.iter().flat_map(|(facet, change)| change.created.iter().map(move |&face| (*facet, face)));
        let mut sides: Vec<Side> = Vec::new();
        for (place, (_, face)) in created().enumerate() {
            turns.check()?;
            let [a, b] = across(face);
            sides.push(Side::new(side_key(a, b), place as u32));
        }
        if !t.topology.region.is_empty() {
            let edges = removed.iter().chain(going).flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
            sides.extend(edges.take_while(|_| turns.go_on()).map(|(a, b)| Side::new(side_key(a, b), NONE)));
        }
        // New subfacets first, and each side once.
        sort_by(&mut sides, &control.watch(), |a, b| (a.key, a.created).cmp(&(b.key, b.created)))?;
        sides.dedup_by_key(|side| side.key);
        let all: Vec<(u32, [u32; 3])> = if self.lazy { Vec::new() } else { created().collect() };
        let corners = Corners::of(sides.iter().flat_map(|side| [(side.key >> 32) as u32, side.key as u32]));
        let topology = &t.topology;
        let at = |v: u32| if v == vertex { coming.at } else { t.at(v) };
        let label = |tet: u32| topology.region.get(tet as usize).copied();
        for (place, &handle) in faces.iter().enumerate() {
            turns.check()?;
            let (tet, slot) = (topology.tet(tet_of(handle)), slot_of(handle));
            let (v, beyond) = (tet.v, tet_of(tet.n[slot]));
            let (mut inside, outside) = (label(tet_of(handle)), label(beyond));
            let [a, b, c] = [v[slot ^ 1], v[slot ^ 2], v[slot ^ 3]];
            let may = [a, b, c].map(|v| corners.may_have(v));
            if inside.is_some() && may == [true; 3] && removed.binary_search(&face_key([a, b, c])).is_ok() {
                outlook.flat.push((place as u32, beyond));
                inside = outside;
            }
            if inside != outside && !self.is_subfacet([a, b, c]) {
                outlook.labels.leak = true;
            }
            for ([p, q], apex, may) in
                [([a, b], c, may[0] && may[1]), ([b, c], a, may[1] && may[2]), ([c, a], b, may[2] && may[0])]
            {
                if !may {
                    continue;
                }
                let Ok(found) = sides.binary_search_by_key(&side_key(p, q), |side| side.key) else { continue };
                let side = &mut sides[found];
                match side.label {
                    None => side.label = inside,
                    Some(other) => side.parts |= Some(other) != inside,
                }
                if side.created != NONE && side.state != State::Encroached {
                    let encroaches = || {
                        let (facet, face) = all[side.created as usize];
                        self.encroaches_triangle(t, (facet, face.map(at)), apex)
                    };
                    side.state = State::of(!self.lazy && encroaches());
                }
            }
        }
        outlook.labels.leak |= sides.iter().any(|side| side.parts && side.created == NONE);
        // In the order in which they come.
        sides.retain(|side| side.created != NONE);
        sort_by(&mut sides, &control.watch(), |a, b| a.created.cmp(&b.created))?;
        outlook.labels.parted = !topology.region.is_empty() && sides.iter().all(|side| side.parts);
        for ((_, face), side) in created().zip(&sides) {
            turns.check()?;
            match side.state {
                State::Missing => outlook.missing_facets.push(face_key(face)),
                State::Encroached => outlook.encroached_facets.push(face_key(face)),
                State::Clear => {}
            }
        }
        if self.parts_labels && !topology.region.is_empty() && (outlook.labels.leak || !outlook.labels.parted) {
            let hidden = |side: &Side| side.state != State::Missing && !side.parts;
            outlook.labels.hide = sides.iter().any(hidden) || self.hides_around(t, faces, &removed, control)?;
        }
        Ok(outlook)
    }

    /// Whether one of the faces around a cavity stays a subfacet that lies between equal labels.
    fn hides_around(
        &self,
        t: &Triangulation,
        faces: &[u32],
        removed: &[[u32; 3]],
        control: &Control,
    ) -> Result<bool, Error> {
        let turns = control.turns();
        for &handle in faces {
            turns.check()?;
            let (tet, slot) = (tet_of(handle), slot_of(handle));
            let face = t.topology.tet(tet).face(slot);
            if !t.topology.labels_differ(tet, slot)
                && self.is_subfacet(face)
                && removed.binary_search(&face_key(face)).is_err()
            {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// What becomes of the two parts of a subsegment.
    fn foresee_parts(
        &self,
        t: &Triangulation,
        coming: Coming,
        outlook: &mut Outlook,
        control: &Control,
    ) -> Result<(), Error> {
        let Coming { vertex, at: p, edge: Some(edge), faces, .. } = coming else { return Ok(()) };
        let Some(&segment) = self.subsegments.get(&edge_key(edge)) else { return Ok(()) };
        let (turns, ends) = (control.turns(), edge_key(edge));
        let mut states = [State::Missing; 2];
        let at = |v: u32| if v == vertex { p } else { t.at(v) };
        for &handle in faces {
            turns.check()?;
            let face = t.topology.tet(tet_of(handle)).face(slot_of(handle));
            for (&end, state) in ends.iter().zip(&mut states) {
                if *state == State::Encroached || !face.contains(&end) {
                    continue;
                }
                let part = edge_key([end, vertex]);
                let encroaches = |&v: &u32| v != end && self.encroaches_part(t, (segment, part.map(at)), v);
                *state = State::of(!self.lazy && face.iter().any(encroaches));
            }
        }
        for (end, state) in ends.into_iter().zip(states) {
            match state {
                State::Missing => outlook.missing_segments.push(edge_key([end, vertex])),
                State::Encroached => outlook.encroached_segments.push(edge_key([end, vertex])),
                State::Clear => {}
            }
        }
        Ok(())
    }

    /// Queues what was seen, and mends labels; `star` are the tetrahedra that the faces have become.
    pub(crate) fn take_in(&mut self, t: &mut Triangulation, outlook: &Outlook, star: &[u32], demand: Demand) {
        debug_assert!(outlook.missing_segments.iter().all(|&[a, b]| t.find_edge(a, b).is_none()));
        debug_assert!(outlook.missing_facets.iter().all(|&face| t.find_face(face).is_none()));
        debug_assert!(outlook.encroached_segments.iter().all(|&edge| self.demand_of_segment(t, edge).is_some()));
        debug_assert!(outlook.encroached_facets.iter().all(|&face| self.demand_of_facet(t, face).is_some()));
        self.missing_segments.extend(&outlook.missing_segments);
        self.missing_facets.extend(&outlook.missing_facets);
        self.pending_segments.extend(outlook.encroached_segments.iter().map(|&edge| (edge, demand)));
        self.pending_facets.extend(outlook.encroached_facets.iter().map(|&face| (face, demand)));
        let region = &mut t.topology.region;
        for &(place, beyond) in &outlook.flat {
            region[star[place as usize] as usize] = region[beyond as usize];
        }
    }
}
