//! The two loops that most of an insertion's time goes to: the walk to the new point and the search of its cavity. Both ask four
//! predicates at once, one in a [lane](crate::geometry::lanes), and decide what they can without branches: which way a
//! single test turns out is a coin's toss that no processor predicts.
//!
//! *Walk*: the visibility walk (O. Devillers, S. Pion, M. Teillaud, "Walking in a triangulation", IJFCS 13, 2002), from
//! tetrahedron to tetrahedron across any face that separates from the goal. In a Delaunay triangulation it never turns
//! in a circle, and the predicates are exact, so it ends.
//!
//! *Cavity*: breadth first, one step per tetrahedron of the cavity. Its four neighbours have three corners each in common with
//! it, so four new corners are all that has to be fetched for their four in-sphere tests. With `t` in hand and corner `i`
//! replaced by the neighbour's, the determinant is that of the neighbour turned inside out.
//!
//! Both stop where their [territory](super::territory) ends.

use glam::DVec3;

use super::cavity::Cavity;
use super::site::Site;
use super::territory::{Everywhere, Territory};
use super::topology::{slot_of, tet_of, Tetrahedron, GHOST};
use super::Triangulation;
use crate::geometry::lanes::{Lanes, Portable, POSITIONS};
use crate::geometry::perturbation::perturbed;
use crate::geometry::predicates::{insphere_lanes, insphere_lanes_again, orient_lanes, Beside};
use crate::geometry::{Filter, Sign};
use crate::{memory, Control, Error};

#[cfg(target_arch = "x86_64")]
use crate::geometry::lanes::Avx2;

impl Triangulation {
    /// The tetrahedron that holds `p`, its faces included, or a ghost whose hull facet has `p` strictly outside. `p` must be
    /// covered by the filter.
    #[inline]
    pub(crate) fn walk_with(&self, filter: &Filter, p: DVec3, start: u32) -> u32 {
        let arrived = self.walk_within(filter, p, start, Control::never());
        debug_assert!(arrived.is_ok());
        arrived.unwrap_or(start)
    }

    /// [`walk_with`](Self::walk_with), as long as `control` does not say stop: [`Error::Cancelled`]. A walk of a million steps there is along as
    /// many points in line.
    #[inline]
    pub(crate) fn walk_within(
        &self,
        filter: &Filter,
        p: DVec3,
        mut start: u32,
        control: &Control,
    ) -> Result<u32, Error> {
        assert!((start as usize) < self.topology.tets.len());
        loop {
            // SAFETY: `start` exists, and nothing changes the triangulation meanwhile.
            let (t, arrived) = unsafe { walk_to(Site::of(self), filter, p, start, Everywhere) };
            if arrived {
                return Ok(t);
            }
            control.check()?;
            start = t;
        }
    }

    /// Finds the cavity of `p`, starting from a tetrahedron in conflict with it. `p` must not be a vertex; the
    /// filter covers the triangulation and `p`. [`Error::Cancelled`] when `control` says so: then what was found is no cavity.
    #[inline]
    pub(crate) fn find_cavity(
        &self,
        filter: &Filter,
        p: DVec3,
        start: u32,
        cavity: &mut Cavity,
        control: &Control,
    ) -> Result<(), Error> {
        debug_assert!(self.conflicts(filter, start, p));
        assert!((start as usize) < self.topology.tets.len());
        cavity.begin(self, control)?;
        // SAFETY: `start` exists, every tetrahedron has a mark, and nothing changes the triangulation meanwhile.
        if unsafe { search_from(Site::of(self), filter, p, start, cavity, (Everywhere, control)) } {
            Ok(())
        } else {
            cavity.clear();
            Err(Error::Cancelled)
        }
    }
}

/// [`walk`] with the best lanes of this processor.
///
/// # Safety
/// As there.
#[inline]
pub(super) unsafe fn walk_to<T: Territory>(site: Site, filter: &Filter, p: DVec3, start: u32, own: T) -> (u32, bool) {
    #[cfg(target_arch = "x86_64")]
    if Avx2::available() {
        // SAFETY: the processor has what the function is compiled for; the rest is the caller's promise.
        return unsafe { walk_avx2(site, filter, p, start, own) };
    }
    // SAFETY: the caller's promise.
    unsafe { walk::<Portable, T>(site, filter, p, start, own) }
}

/// [`search`] with the best lanes of this processor.
///
/// # Safety
/// As there.
#[inline]
pub(super) unsafe fn search_from<T: Territory>(
    site: Site,
    filter: &Filter,
    p: DVec3,
    start: u32,
    cavity: &mut Cavity,
    (own, control): (T, &Control),
) -> bool {
    #[cfg(target_arch = "x86_64")]
    if Avx2::available() {
        // SAFETY: the processor has what the function is compiled for; the rest is the caller's promise.
        return unsafe { search_avx2(site, filter, p, start, cavity, (own, control)) };
    }
    // SAFETY: the caller's promise.
    unsafe { search::<Portable, T>(site, filter, p, start, cavity, (own, control)) }
}

/// # Safety
/// As [`walk`], on a processor with AVX2 and FMA.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
unsafe fn walk_avx2<T: Territory>(site: Site, filter: &Filter, p: DVec3, start: u32, own: T) -> (u32, bool) {
    // SAFETY: the caller's promise.
    unsafe { walk::<Avx2, T>(site, filter, p, start, own) }
}

/// # Safety
/// As [`search`], on a processor with AVX2 and FMA.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
unsafe fn search_avx2<T: Territory>(
    site: Site,
    filter: &Filter,
    p: DVec3,
    start: u32,
    cavity: &mut Cavity,
    (own, control): (T, &Control),
) -> bool {
    // SAFETY: the caller's promise.
    unsafe { search::<Avx2, T>(site, filter, p, start, cavity, (own, control)) }
}

// No closures and no `map` over lanes: what is not inlined always would be compiled for the plain processor.
#[inline(always)]
fn relative<L: Lanes>(points: [L; 3], p: [L; 3]) -> [L; 3] {
    [points[0].sub(p[0]), points[1].sub(p[1]), points[2].sub(p[2])]
}

#[inline(always)]
fn splat<L: Lanes>(p: &DVec3) -> [L; 3] {
    [L::splat(p.x), L::splat(p.y), L::splat(p.z)]
}

/// Returns the tetrahedron where the walk ended, and whether that is its goal: where it would have to cross a face with fewer than two
/// own vertices, it stops, and so it does after [`STEPS`], to be gone on with from there.
///
/// # Safety
/// `start` is the index of a live tetrahedron that may be read: the whole triangulation with [`Everywhere`], one with two own vertices otherwise.
#[inline(always)]
unsafe fn walk<L: Lanes, T: Territory>(site: Site, filter: &Filter, p: DVec3, start: u32, own: T) -> (u32, bool) {
    let goal = splat::<L>(&p);
    let bound = filter.orient_bound();
    let (above, below) = (L::splat(bound), L::splat(-bound));
    let mut t = start;
    // A ghost to start from says nothing of p and its face.
    // SAFETY: the caller's promise.
    let first = unsafe { site.tet(t) };
    if first.is_ghost() {
        t = tet_of(first.n[3]);
    }
    let mut open = 0b1111;
    for _ in 0..STEPS {
        // SAFETY: the start, or the neighbour of a live tetrahedron.
        let tet = unsafe { site.tet(t) };
        if tet.is_ghost() {
            return (t, true);
        }
        // SAFETY: vertices of a live tetrahedron without the ghost.
        let corners = unsafe { tet.v.map(|v| site.point(v)) };
        // Lane i: the three corners other than i.
        let [x, y, z] = relative(L::load(corners), goal);
        let (x, y, z) = (x.rotations(), y.rotations(), z.rotations());
        let det = orient_lanes([x[0], y[0], z[0]], [x[1], y[1], z[1]], [x[2], y[2], z[2]]);
        let (greater, less) = (det.greater(above), below.greater(det));
        // p in the place of corner i makes a negative tetrahedron: a cyclic order of four is an odd permutation, so that the lanes'
        // signs alternate.
        let mut leave = (less & 0b0101 | greater & 0b1010) & open;
        let unsure = !(greater | less) & open;
        // With a bound of 0 they are zeros.
        if unsure != 0 && bound != 0.0 {
            leave |= unsure_faces(filter, corners, p, unsure);
        }
        if leave == 0 {
            return (t, true);
        }
        let mut slot = leave.trailing_zeros() as usize & 3;
        // SAFETY: vertices of a live tetrahedron.
        let mine = unsafe { own.of::<L>(&tet.v) };
        if mine != 0b1111 {
            match crossable(leave, mine) {
                Some(other) => slot = other,
                None => return (t, false),
            }
        }
        let face = tet.n[slot];
        t = tet_of(face);
        // p is on the far side of the face that leads back.
        open = 0b1111 & !(1 << slot_of(face));
    }
    (t, false)
}

/// One of the faces in `leave`, any of which leads on, that has two own vertices; `mine` are the slots with own vertices.
#[cold]
#[inline(never)]
fn crossable(leave: u32, mine: u32) -> Option<usize> {
    (0..4).find(|slot| leave >> slot & 1 == 1 && (mine & !(1 << slot)).count_ones() >= 2)
}

/// Those of the faces in `unsure` that separate from `p`.
#[cold]
#[inline(never)]
fn unsure_faces(filter: &Filter, corners: [&DVec3; 4], p: DVec3, unsure: u32) -> u32 {
    (0..4)
        .filter(|slot| unsure >> slot & 1 == 1)
        .filter(|&slot| {
            let mut replaced = corners.map(|&c| c);
            replaced[slot] = p;
            let [a, b, c, d] = replaced;
            filter.orient3d(a, b, c, d) == Sign::Negative
        })
        .map(|slot| 1 << slot)
        .sum()
}

/// Steps of a walk between two looks at the control.
const STEPS: u32 = 1 << 14;
/// Tetrahedra whose neighbours are looked at between two looks at the control.
const BETWEEN_LOOKS: usize = 1 << 10;
/// How many turns before its own the neighbours of a tetrahedron are fetched.
const AHEAD: usize = 2;

/// Returns whether the cavity was found: where it reaches beyond the territory, or the control says so, the search ends.
///
/// # Safety
/// `start` is the index of a live tetrahedron that may be read, and `cavity` is empty with marks for all tetrahedra.
#[inline(always)]
unsafe fn search<L: Lanes, T: Territory>(
    site: Site,
    filter: &Filter,
    p: DVec3,
    start: u32,
    cavity: &mut Cavity,
    (own, control): (T, &Control),
) -> bool {
    let centre = splat::<L>(&p);
    let bound = filter.insphere_bound();
    let (above, below) = (L::splat(bound), L::splat(-bound));
    let Cavity { marks, tets, faces, entries, labels, .. } = cavity;
    let marks = &mut marks[..];
    let mut giver = labels.begin(site.points().len());
    // The list of entries is the queue too: those from `next` on have neighbours to be looked at. Lengths are kept here while the loop
    // runs.
    let (mut tets_len, mut faces_len, mut next) = (1, 0, 0);
    let mut room = 0;
    entries.clear();
    entries.push(4 * start);
    debug_assert!((start as usize) < marks.len());
    // SAFETY: `begin` made a mark for every tetrahedron. Vertices of a live tetrahedron.
    unsafe {
        *marks.get_unchecked_mut(start as usize) = 1;
        site.tet(start).v[1..].iter().for_each(|&v| giver.give(v));
    }
    let found_all = loop {
        if next == room {
            // SAFETY: as many have been written.
            unsafe {
                entries.set_len(tets_len);
                faces.set_len(faces_len);
            }
            if next != 0 && !control.poll() {
                break false;
            }
            let Some(more) = make_room([&mut *entries, &mut *faces], next, control) else { break false };
            room = more.min(next + BETWEEN_LOOKS);
            debug_assert!(room > next);
        }
        // SAFETY: this one has been written.
        let entry = unsafe { *entries.as_ptr().add(next) };
        let t = tet_of(entry);
        next += 1;
        // SAFETY: the start, or the neighbour of a live tetrahedron.
        let tet = unsafe { site.tet(t) };
        // SAFETY: vertices of a live tetrahedron.
        let mine = unsafe { own.of::<L>(&tet.v) };
        // SAFETY: a live tetrahedron that may be read.
        if mine != 0b1111 && !unsafe { may_go(site, tet, mine, own) } {
            break false;
        }
        // It has three vertices in common with the one that it was found from.
        // SAFETY: a vertex of a live tetrahedron.
        unsafe { giver.give(tet.v[slot_of(entry)]) };
        // The neighbours that are known to be in the cavity.
        // SAFETY: `begin` made a mark for every tetrahedron.
        let known = unsafe { marked(marks, tet) };
        // SAFETY: neighbours of a tetrahedron that may be replaced.
        let answer = unsafe {
            if tet.is_ghost() {
                exact_conflicts(site, filter, tet, p, !known & 0b1111, 0)
            } else {
                conflicts::<L>(site, filter, p, centre, (above, below), tet, known)
            }
        };
        let conflict = known | answer;
        let (found, border) = (conflict & !known, !conflict & 0b1111);
        // A byte for each bit.
        let now = ((conflict * 0x0020_4081) & 0x0101_0101).to_le_bytes();
        for (face, mark) in tet.n.into_iter().zip(now) {
            // Whether it is in the cavity or not: which is a coin's toss.
            // SAFETY: as above.
            unsafe { *marks.get_unchecked_mut(tet_of(face) as usize) = mark };
        }
        // SAFETY: there is room.
        unsafe {
            let handles = POSITIONS[border as usize & 15];
            let handles = [4 * t + handles[0], 4 * t + handles[1], 4 * t + handles[2], 4 * t + handles[3]];
            write_four(faces, faces_len, handles);
            write_four(entries, tets_len, L::compress(&tet.n, found));
        }
        faces_len += border.count_ones() as usize;
        tets_len += found.count_ones() as usize;
        if next == tets_len {
            break true;
        }
        // SAFETY: one that has been written, and a tetrahedron in conflict.
        unsafe {
            let ahead = *entries.as_ptr().add((next + AHEAD).min(tets_len - 1));
            let tet = site.tet(tet_of(ahead));
            for face in tet.n {
                site.prefetch(tet_of(face));
            }
            giver.prefetch(tet.v[slot_of(ahead)]);
        }
    };
    // SAFETY: as many have been written.
    unsafe {
        entries.set_len(tets_len);
        faces.set_len(faces_len);
    }
    tets.clear();
    tets.extend(entries.iter().map(|&entry| tet_of(entry)));
    labels.end(giver);
    found_all
}

/// Which neighbours of a tetrahedron are in conflict with `p`. Those that are known to be need not be named.
///
/// # Safety
/// The tetrahedron is live, without the ghost, and it may be replaced.
#[inline(always)]
unsafe fn conflicts<L: Lanes>(
    site: Site,
    filter: &Filter,
    p: DVec3,
    centre: [L; 3],
    (above, below): (L, L),
    tet: &Tetrahedron,
    known: u32,
) -> u32 {
    // SAFETY: vertices of a live tetrahedron without the ghost.
    let corners = unsafe { tet.v.map(|v| site.point(v)) };
    let beside = Beside::new(relative(L::load(corners), centre));
    // A ghost gets some other corner instead, so that the determinant has two equal rows and decides nothing.
    // SAFETY: neighbours and vertices of live tetrahedra.
    let apexes: [&DVec3; 4] = unsafe {
        let apex = |slot: usize| {
            let v = site.apex(tet.n[slot]);
            site.point(if v == GHOST { tet.v[slot ^ 1] } else { v })
        };
        [apex(0), apex(1), apex(2), apex(3)]
    };
    let apexes = relative(L::load(apexes), centre);
    let det = insphere_lanes(&beside, apexes);
    // The neighbour is turned inside out: on its sphere the determinant is of the opposite sign.
    let (mut inside, outside) = (below.greater(det), det.greater(above));
    let unsure = !(inside | outside | known) & 0b1111;
    if unsure != 0 {
        let [out, within, on] = insphere_lanes_again(filter, det, &beside, apexes);
        inside |= within & unsure;
        let unsure = unsure & !(within | out);
        if unsure != 0 {
            // SAFETY: neighbours of a tetrahedron that may go.
            inside |= unsafe { exact_conflicts(site, filter, tet, p, unsure, on) };
        }
    }
    inside
}

/// A bit for each neighbour that is marked.
///
/// # Safety
/// There are marks for all neighbours.
#[inline(always)]
unsafe fn marked(marks: &[u8], tet: &Tetrahedron) -> u32 {
    let mark = |slot: usize| {
        let t = tet_of(tet.n[slot]) as usize;
        debug_assert!(t < marks.len());
        // SAFETY: the caller's promise.
        u32::from(unsafe { *marks.get_unchecked(t) }) << slot
    };
    mark(0) | mark(1) | mark(2) | mark(3)
}

/// Makes the lists longer, and returns for how many tetrahedra's neighbours there is room in them: more than `done`. The first adds at most four
/// to each list, every other one three, and four are written at once. `None` when the control says stop.
#[cold]
#[inline(never)]
fn make_room(lists: [&mut Vec<u32>; 2], done: usize, control: &Control) -> Option<usize> {
    const FIRST: usize = 8;
    // Twice as many, at least.
    let more = 3 * 2 * done.max(64) + FIRST;
    let mut room = usize::MAX;
    for list in lists {
        if (list.capacity() - FIRST.min(list.capacity())) / 3 <= done {
            if memory::grow_long(list, more - list.len(), "cavity", control) == Err(Error::Cancelled) {
                return None;
            }
            list.reserve(more - list.len());
        }
        room = room.min((list.capacity() - FIRST) / 3);
    }
    Some(room)
}

/// # Safety
/// The list has room for four elements from `at` on.
#[inline(always)]
unsafe fn write_four(list: &mut Vec<u32>, at: usize, values: [u32; 4]) {
    debug_assert!(at + 4 <= list.capacity());
    // SAFETY: the caller's promise.
    unsafe { list.as_mut_ptr().add(at).cast::<[u32; 4]>().write_unaligned(values) }
}

/// Whether a tetrahedron not all of whose vertices are own may go, and its neighbours be linked anew; `mine` are the slots with own
/// vertices. See [`territory`](super::territory).
///
/// # Safety
/// `tet` is live and may be read.
#[cold]
#[inline(never)]
unsafe fn may_go<T: Territory>(site: Site, tet: &Tetrahedron, mine: u32, own: T) -> bool {
    if mine.count_ones() < 3 {
        return false;
    }
    // With its three own vertices a ghost has all that it needs for its neighbours too.
    tet.is_ghost()
        || (0..4).all(|slot| {
            // The face opposite the foreign vertex has three own ones, the others two.
            mine >> slot & 1 == 0 || {
                let face = tet.n[slot];
                // SAFETY: a neighbour across a face with two own vertices, and its vertices.
                unsafe {
                    let mut v = site.tet(tet_of(face)).v;
                    let apex = v[slot_of(face)];
                    v[0] = apex;
                    apex == GHOST || own.of::<Portable>(&v) & 1 == 1
                }
            }
        })
}

/// Those of the neighbours of `tet` in `slots` that are in conflict with `p`, one by one. Those in `on` that are not ghosts are known to
/// have it on their spheres.
///
/// # Safety
/// `tet` is live, and it may be replaced.
#[cold]
#[inline(never)]
unsafe fn exact_conflicts(site: Site, filter: &Filter, tet: &Tetrahedron, p: DVec3, slots: u32, on: u32) -> u32 {
    let conflicts = |slot: usize| {
        let t = tet_of(tet.n[slot]);
        // SAFETY: neighbours of a tetrahedron that may be replaced may be read.
        unsafe {
            if on >> slot & 1 == 1 && !site.tet(t).is_ghost() {
                perturbed(filter, site.corners(t), p)
            } else {
                site.conflicts(filter, t, p)
            }
        }
    };
    (0..4).filter(|&slot| slots >> slot & 1 == 1 && conflicts(slot)).map(|slot| 1 << slot).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Control;

    /// Points at random in a cube, then a grid in it: general position, and every kind of degeneracy.
    fn points() -> Vec<DVec3> {
        let mut state = 11u64;
        let mut next = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 40) as f64 / (1 << 22) as f64
        };
        let mut points: Vec<DVec3> = (0..1500).map(|_| DVec3::new(next(), next(), next())).collect();
        points.extend((0..512).map(|i| DVec3::new((i & 7) as f64, (i >> 3 & 7) as f64, (i >> 6) as f64) * 0.5));
        points
    }

    #[test]
    fn every_kind_of_lanes_finds_the_same_cavity() {
        let points = points();
        let mut t = Triangulation::new();
        t.insert_many(&points[..1900], &Control::new()).unwrap().unwrap();
        let mut filter = t.filter.clone();
        points[1900..].iter().for_each(|&p| filter.extend(p));
        let (mut fast, mut portable) = (Cavity::default(), Cavity::default());
        for &p in &points[1900..] {
            let start = t.walk_with(&filter, p, t.recent());
            // SAFETY: live tetrahedra, and marks for all of them.
            unsafe {
                let found = walk::<Portable, _>(Site::of(&t), &filter, p, t.recent(), Everywhere);
                assert_eq!(found, (start, true));
                portable.begin(&t, &Control::new()).unwrap();
                assert!(search::<Portable, _>(
                    Site::of(&t),
                    &filter,
                    p,
                    start,
                    &mut portable,
                    (Everywhere, &Control::new())
                ));
            }
            t.find_cavity(&filter, p, start, &mut fast, &Control::new()).unwrap();
            assert_eq!((&fast.tets, &fast.faces), (&portable.tets, &portable.faces));
            // And what one predicate after the other says.
            let all: Vec<u32> = t.topology.live().filter(|&t_| t.conflicts(&filter, t_, p)).collect();
            let mut found = fast.tets.clone();
            found.sort_unstable();
            assert_eq!(found, all);
        }
    }
}
