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
use crate::geometry::predicates::{insphere_lanes, insphere_lanes_again, orient_lanes};
use crate::geometry::{Filter, Sign};

#[cfg(target_arch = "x86_64")]
use crate::geometry::lanes::Avx2;

impl Triangulation {
    /// The tetrahedron that holds `p`, its faces included, or a ghost whose hull facet has `p` strictly outside. `p` must be
    /// covered by the filter.
    #[inline]
    pub(crate) fn walk_with(&self, filter: &Filter, p: DVec3, start: u32) -> u32 {
        assert!((start as usize) < self.topology.tets.len());
        // SAFETY: `start` exists, and nothing changes the triangulation meanwhile.
        unsafe { walk_to(Site::of(self), filter, p, start, Everywhere) }.0
    }

    /// Finds the cavity of `p`, starting from a tetrahedron in conflict with it. `p` must not be a vertex; the
    /// filter covers the triangulation and `p`.
    #[inline]
    pub(crate) fn find_cavity(&self, filter: &Filter, p: DVec3, start: u32, cavity: &mut Cavity) {
        debug_assert!(self.conflicts(filter, start, p));
        assert!((start as usize) < self.topology.tets.len());
        cavity.begin(self.topology.tets.len(), self.topology.tets.capacity());
        // SAFETY: `start` exists, every tetrahedron has a mark, and nothing changes the triangulation meanwhile.
        unsafe { search_from(Site::of(self), filter, p, start, cavity, Everywhere) };
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
    own: T,
) -> bool {
    #[cfg(target_arch = "x86_64")]
    if Avx2::available() {
        // SAFETY: the processor has what the function is compiled for; the rest is the caller's promise.
        return unsafe { search_avx2(site, filter, p, start, cavity, own) };
    }
    // SAFETY: the caller's promise.
    unsafe { search::<Portable, T>(site, filter, p, start, cavity, own) }
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
    own: T,
) -> bool {
    // SAFETY: the caller's promise.
    unsafe { search::<Avx2, T>(site, filter, p, start, cavity, own) }
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

#[inline(always)]
fn rotate<L: Lanes>(v: [L; 3]) -> [L; 3] {
    [v[0].rotate(), v[1].rotate(), v[2].rotate()]
}

#[inline(always)]
fn with_lane<L: Lanes, const LANE: usize>(v: [L; 3], other: [L; 3]) -> [L; 3] {
    [v[0].with_lane::<LANE>(other[0]), v[1].with_lane::<LANE>(other[1]), v[2].with_lane::<LANE>(other[2])]
}

/// Returns the tetrahedron where the walk ended, and whether that is its goal: where it would have to cross a face with fewer than two
/// own vertices, it stops.
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
    loop {
        // SAFETY: the start, or the neighbour of a live tetrahedron.
        let tet = unsafe { site.tet(t) };
        if tet.is_ghost() {
            return (t, true);
        }
        // SAFETY: vertices of a live tetrahedron without the ghost.
        let corners = unsafe { tet.v.map(|v| site.point(v)) };
        // Lane i: the three corners other than i.
        let u = rotate(relative(L::load(corners), goal));
        let v = rotate(u);
        let w = rotate(v);
        let det = orient_lanes(u, v, w);
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

/// Returns whether the cavity was found: where it reaches beyond the territory, the search ends.
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
    own: T,
) -> bool {
    let centre = splat::<L>(&p);
    let bound = filter.insphere_bound();
    let (above, below) = (L::splat(bound), L::splat(-bound));
    let Cavity { marks, tets, faces, queue, .. } = cavity;
    let marks = &mut marks[..];
    // Lengths are kept here while the loop runs.
    let (mut tets_len, mut faces_len, mut queue_len, mut next) = (0, 0, 0, 0);
    let mut room = room_in(tets, faces, queue);
    let mut t = start;
    // The faces whose other side is not known to be in the cavity.
    let mut open = 0b1111;
    loop {
        debug_assert!((t as usize) < marks.len());
        // SAFETY: `begin` made a mark for every tetrahedron.
        unsafe { *marks.get_unchecked_mut(t as usize) = 1 };
        if tets_len == room {
            // SAFETY: as many have been written.
            unsafe {
                tets.set_len(tets_len);
                faces.set_len(faces_len);
                queue.set_len(queue_len);
            }
            // Twice as many, at least.
            let more = 2 * tets_len.max(64);
            tets.reserve(more - tets_len);
            faces.reserve(3 * more + 4 - faces_len);
            queue.reserve(3 * more + 4 - queue_len);
            room = room_in(tets, faces, queue);
            debug_assert!(room > tets_len);
        }
        // SAFETY: there is room for one more.
        unsafe { tets.as_mut_ptr().add(tets_len).write(t) };
        tets_len += 1;
        // SAFETY: the start, or the neighbour of a live tetrahedron.
        let tet = unsafe { site.tet(t) };
        // SAFETY: vertices of a live tetrahedron.
        let mine = unsafe { own.of::<L>(&tet.v) };
        // SAFETY: a live tetrahedron that may be read.
        if mine != 0b1111 && !unsafe { may_go(site, tet, mine, own) } {
            // SAFETY: as many have been written.
            unsafe {
                tets.set_len(tets_len);
                faces.set_len(faces_len);
                queue.set_len(queue_len);
            }
            return false;
        }
        let conflict = if tet.is_ghost() {
            // SAFETY: neighbours of a tetrahedron that may go.
            unsafe { exact_conflicts(site, filter, tet, p, open, 0) }
        } else {
            // A ghost gets some other corner instead, so that the determinant has two equal rows and decides nothing.
            // SAFETY: neighbours and vertices of live tetrahedra.
            let apexes: [&DVec3; 4] = unsafe {
                let apex = |slot: usize| {
                    let face = tet.n[slot];
                    let v = site.tet(tet_of(face)).v[slot_of(face)];
                    site.point(if v == GHOST { tet.v[slot ^ 1] } else { v })
                };
                [apex(0), apex(1), apex(2), apex(3)]
            };
            let apexes = relative(L::load(apexes), centre);
            // SAFETY: vertices of a live tetrahedron without the ghost.
            let [a, b, c, d] = unsafe { tet.v.map(|v| site.point(v)) };
            let a = with_lane::<L, 0>(relative(splat(a), centre), apexes);
            let b = with_lane::<L, 1>(relative(splat(b), centre), apexes);
            let c = with_lane::<L, 2>(relative(splat(c), centre), apexes);
            let d = with_lane::<L, 3>(relative(splat(d), centre), apexes);
            let det = insphere_lanes(a, b, c, d);
            let (inside, outside) = (below.greater(det), det.greater(above));
            let unsure = !(inside | outside) & open;
            let mut conflict = inside & open;
            if unsure != 0 {
                // Inside out here too.
                let [outside, inside, on] = insphere_lanes_again(filter, det, a, b, c, d);
                conflict |= inside & unsure;
                let unsure = unsure & !(inside | outside);
                if unsure != 0 {
                    // SAFETY: neighbours of a tetrahedron that may go.
                    conflict |= unsafe { exact_conflicts(site, filter, tet, p, unsure, on) };
                }
            }
            conflict
        };
        let border = open & !conflict;
        // SAFETY: there is room.
        unsafe {
            let handles = POSITIONS[border as usize & 15];
            let handles = [4 * t + handles[0], 4 * t + handles[1], 4 * t + handles[2], 4 * t + handles[3]];
            write_four(faces, faces_len, handles);
            write_four(queue, queue_len, L::compress(&tet.n, conflict));
        }
        faces_len += border.count_ones() as usize;
        queue_len += conflict.count_ones() as usize;
        // A tetrahedron may be found in conflict across several faces.
        loop {
            if next == queue_len {
                // SAFETY: as many have been written.
                unsafe {
                    tets.set_len(tets_len);
                    faces.set_len(faces_len);
                    queue.set_len(queue_len);
                }
                return true;
            }
            // SAFETY: this one has been written.
            let face = unsafe { *queue.as_ptr().add(next) };
            next += 1;
            t = tet_of(face);
            // SAFETY: as above.
            if unsafe { *marks.get_unchecked(t as usize) } == 0 {
                open = 0b1111 & !(1 << slot_of(face));
                break;
            }
        }
    }
}

/// How many tetrahedra a cavity may have for the lists' memory. The first adds at most four to each, every other one
/// three, and four are written at once.
#[inline(always)]
fn room_in(tets: &Vec<u32>, faces: &Vec<u32>, queue: &Vec<u32>) -> usize {
    tets.capacity().min(faces.capacity().min(queue.capacity()).saturating_sub(4) / 3)
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
                portable.begin(t.topology.tets.len(), t.topology.tets.capacity());
                assert!(search::<Portable, _>(Site::of(&t), &filter, p, start, &mut portable, Everywhere));
            }
            t.find_cavity(&filter, p, start, &mut fast);
            assert_eq!((&fast.tets, &fast.faces), (&portable.tets, &portable.faces));
            // And what one predicate after the other says.
            let all: Vec<u32> = t.topology.live().filter(|&t_| t.conflicts(&filter, t_, p)).collect();
            let mut found = fast.tets.clone();
            found.sort_unstable();
            assert_eq!(found, all);
        }
    }
}
