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

use glam::DVec3;

use super::cavity::Cavity;
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
        #[cfg(target_arch = "x86_64")]
        if Avx2::available() {
            // SAFETY: the processor has what the function is compiled for; `start` exists.
            return unsafe { walk_avx2(self, filter, p, start) };
        }
        // SAFETY: `start` exists.
        unsafe { walk::<Portable>(self, filter, p, start) }
    }

    /// Finds the cavity of `p`, starting from a tetrahedron in conflict with it. `p` must not be a vertex; the
    /// filter covers the triangulation and `p`.
    #[inline]
    pub(crate) fn find_cavity(&self, filter: &Filter, p: DVec3, start: u32, cavity: &mut Cavity) {
        debug_assert!(self.conflicts(filter, start, p));
        assert!((start as usize) < self.topology.tets.len());
        #[cfg(target_arch = "x86_64")]
        if Avx2::available() {
            // SAFETY: the processor has what the function is compiled for; `start` exists.
            return unsafe { search_avx2(self, filter, p, start, cavity) };
        }
        // SAFETY: `start` exists.
        unsafe { search::<Portable>(self, filter, p, start, cavity) }
    }
}

/// The triangulation as the loops see it: without bounds checks, which would be a fifth of their instructions.
#[derive(Clone, Copy)]
struct Unchecked<'a> {
    tets: &'a [Tetrahedron],
    points: &'a [DVec3],
}

impl<'a> Unchecked<'a> {
    fn of(t: &'a Triangulation) -> Self {
        Unchecked { tets: &t.topology.tets, points: &t.points }
    }

    /// # Safety
    /// `t` is less than the number of tetrahedra: a start that was checked, or what a live tetrahedron names as its neighbour.
    #[inline(always)]
    unsafe fn tet(self, t: u32) -> &'a Tetrahedron {
        debug_assert!(self.tets[t as usize].is_live());
        // SAFETY: the caller's promise.
        unsafe { self.tets.get_unchecked(t as usize) }
    }

    /// # Safety
    /// `v` is a vertex of a live tetrahedron, and not the ghost.
    #[inline(always)]
    unsafe fn point(self, v: u32) -> &'a DVec3 {
        debug_assert!((v as usize) < self.points.len());
        // SAFETY: tetrahedra are made of vertices whose points are stored.
        unsafe { self.points.get_unchecked(v as usize) }
    }
}

/// # Safety
/// As [`walk`], on a processor with AVX2 and FMA.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
unsafe fn walk_avx2(this: &Triangulation, filter: &Filter, p: DVec3, start: u32) -> u32 {
    // SAFETY: the caller's promise.
    unsafe { walk::<Avx2>(this, filter, p, start) }
}

/// # Safety
/// As [`search`], on a processor with AVX2 and FMA.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
unsafe fn search_avx2(this: &Triangulation, filter: &Filter, p: DVec3, start: u32, cavity: &mut Cavity) {
    // SAFETY: the caller's promise.
    unsafe { search::<Avx2>(this, filter, p, start, cavity) }
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

/// # Safety
/// `start` is the index of a live tetrahedron.
#[inline(always)]
unsafe fn walk<L: Lanes>(this: &Triangulation, filter: &Filter, p: DVec3, start: u32) -> u32 {
    let goal = splat::<L>(&p);
    let bound = filter.orient_bound();
    let (above, below) = (L::splat(bound), L::splat(-bound));
    let all = Unchecked::of(this);
    let mut t = start;
    // A ghost to start from says nothing of p and its face.
    // SAFETY: the caller's promise.
    let first = unsafe { all.tet(t) };
    if first.is_ghost() {
        t = tet_of(first.n[3]);
    }
    let mut open = 0b1111;
    loop {
        // SAFETY: the start, or the neighbour of a live tetrahedron.
        let tet = unsafe { all.tet(t) };
        if tet.is_ghost() {
            return t;
        }
        // SAFETY: vertices of a live tetrahedron without the ghost.
        let corners = unsafe { tet.v.map(|v| all.point(v)) };
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
            return t;
        }
        let face = tet.n[leave.trailing_zeros() as usize & 3];
        t = tet_of(face);
        // p is on the far side of the face that leads back.
        open = 0b1111 & !(1 << slot_of(face));
    }
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

/// # Safety
/// `start` is the index of a live tetrahedron.
#[inline(always)]
unsafe fn search<L: Lanes>(this: &Triangulation, filter: &Filter, p: DVec3, start: u32, cavity: &mut Cavity) {
    cavity.begin(this.topology.tets.len(), this.topology.tets.capacity());
    let centre = splat::<L>(&p);
    let bound = filter.insphere_bound();
    let (above, below) = (L::splat(bound), L::splat(-bound));
    let all = Unchecked::of(this);
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
        let tet = unsafe { all.tet(t) };
        let conflict = if tet.is_ghost() {
            exact_conflicts(this, filter, tet, p, open, 0)
        } else {
            // A ghost gets some other corner instead, so that the determinant has two equal rows and decides nothing.
            // SAFETY: neighbours and vertices of live tetrahedra.
            let apexes: [&DVec3; 4] = unsafe {
                let apex = |slot: usize| {
                    let face = tet.n[slot];
                    let v = all.tet(tet_of(face)).v[slot_of(face)];
                    all.point(if v == GHOST { tet.v[slot ^ 1] } else { v })
                };
                [apex(0), apex(1), apex(2), apex(3)]
            };
            let apexes = relative(L::load(apexes), centre);
            // SAFETY: vertices of a live tetrahedron without the ghost.
            let [a, b, c, d] = unsafe { tet.v.map(|v| all.point(v)) };
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
                    conflict |= exact_conflicts(this, filter, tet, p, unsure, on);
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
                return;
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

/// Those of the neighbours of `tet` in `slots` that are in conflict with `p`, one by one. Those in `on` that are not ghosts are known to
/// have it on their spheres.
#[cold]
#[inline(never)]
fn exact_conflicts(this: &Triangulation, filter: &Filter, tet: &Tetrahedron, p: DVec3, slots: u32, on: u32) -> u32 {
    let conflicts = |slot: usize| {
        let t = tet_of(tet.n[slot]);
        if on >> slot & 1 == 1 && !this.topology.tet(t).is_ghost() {
            perturbed(filter, this.corners(t), p)
        } else {
            this.conflicts(filter, t, p)
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
            // SAFETY: live tetrahedra.
            assert_eq!(unsafe { walk::<Portable>(&t, &filter, p, t.recent()) }, start);
            t.find_cavity(&filter, p, start, &mut fast);
            unsafe { search::<Portable>(&t, &filter, p, start, &mut portable) };
            assert_eq!((&fast.tets, &fast.faces), (&portable.tets, &portable.faces));
            // And what one predicate after the other says.
            let all: Vec<u32> = t.topology.live().filter(|&t_| t.conflicts(&filter, t_, p)).collect();
            let mut found = fast.tets.clone();
            found.sort_unstable();
            assert_eq!(found, all);
        }
    }
}
