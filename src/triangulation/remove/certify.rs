//! A preview from a guess: who believes to know what would fill a hole, from computations in floating point say, can have that certified, at a fraction of
//! the cost of finding it. By Delaunay's lemma it is enough to look at single tetrahedra and single faces: tetrahedra that are all positive, whose faces
//! match each other's and the hole's one to one, fill the hole; and when no face has the vertex beyond it in the sphere of the tetrahedron before it, after
//! perturbation, the whole is the Delaunay triangulation of its vertices, of which there is but one. The guess says what is whose neighbour: that
//! is checked, too, not searched for.

use super::faces::{oriented_face, same_face};
use super::{Coming, Going, Hole, HoleFace, Replacement, ADDED, REMOVED};
use crate::geometry::ball::Ball;
use crate::geometry::Sign;
use crate::triangulation::topology::{slot_of, tet_of, GHOST, NONE};
use crate::triangulation::Triangulation;
use crate::{memory, Control};

/// A replacement in full, as somebody foresees it: no ghosts.
#[derive(Clone, Debug, Default)]
pub struct Guess {
    /// The tetrahedra that go.
    pub going: Vec<u32>,
    /// Those that come.
    pub coming: Vec<Linked>,
}

/// A tetrahedron that comes, with its neighbours.
#[derive(Clone, Copy, Debug)]
pub struct Linked {
    /// Vertices, positively oriented; [`ADDED`] for the new point.
    pub v: [u32; 4],
    /// Opposite each the other side's face: `4·position + slot` among what comes, or a face handle outside the hole.
    pub n: [u32; 4],
    /// Bit by slot: whether the other side is outside the hole.
    pub rim: u8,
}

/// Among the numbers of a hole's vertices: one that a tetrahedron which comes has.
const SEEN: u32 = u32::MAX - 2;

impl Triangulation {
    /// As [`preview`](Self::preview), if that is what goes and what comes. False when it is not so, or can't be told; `hole` is empty then.
    pub(crate) fn certify(
        &self,
        replacement: &Replacement,
        guess: &Guess,
        is_wall: &dyn Fn([u32; 3]) -> bool,
        hole: &mut Hole,
    ) -> bool {
        let going = &guess.going;
        if self.dimension() < 3 || going.is_empty() || self.begin_hole(replacement, hole).is_err() {
            hole.clear();
            return false;
        }
        let fetch_mark = |t: u32, hole: &Hole| memory::prefetch(hole.marks.as_ptr().wrapping_add(t as usize));
        for &t in going {
            self.topology.prefetch(t);
            fetch_mark(t, hole);
        }
        for &t in going {
            let tet = self.topology.tet(t);
            if tet.is_live() && !tet.is_ghost() && !hole.contains(t) {
                hole.take(t, tet.v);
                tet.n.iter().for_each(|&n| fetch_mark(tet_of(n), hole));
            }
        }
        let fits =
            hole.going.len() == going.len() && self.take_coming(&guess.coming, hole) && self.is_delaunay_in(hole);
        hole.forget_numbers();
        let fits = fits
            && match self.only_label(hole) {
                Some(label) => {
                    hole.coming.iter_mut().for_each(|coming| coming.label = Some(label));
                    true
                }
                None => self.label_coming(is_wall, hole, Control::never()).is_ok(),
            };
        if !fits {
            hole.clear();
        }
        fits
    }

    /// The label of all that goes and of all around it, if there is but one.
    fn only_label(&self, hole: &Hole) -> Option<u16> {
        let region = &self.topology.region;
        let label = *region.get(hole.going.first()?.t as usize)?;
        let all_going = hole.going.iter().all(|going| region[going.t as usize] == label);
        let is_alone = all_going && hole.faces.iter().all(|face| region[tet_of(face.outside) as usize] == label);
        is_alone.then_some(label)
    }

    /// Takes over what comes. False unless it has all vertices of the hole and no others but the new one, and its faces match each other's and the
    /// hole's one to one. Then all at the vertices that go, goes: no face of the hole has one.
    fn take_coming(&self, coming: &[Linked], hole: &mut Hole) -> bool {
        let mut count = 0;
        for i in 0..hole.going.len() {
            let Going { t, v } = hole.going[i];
            hole.number(v);
            count += self.topology.tet(t).n.iter().filter(|&&n| hole.marks[tet_of(n) as usize] == 0).count();
        }
        let Hole { remove, add, faces, marks, local, vertices, coming: linked, .. } = hole;
        if remove.iter().any(|&v| marks[self.topology.vertex_tet[v as usize] as usize] == 0) {
            return false;
        }
        let (mut seen, mut is_added) = (0, false);
        for (&Linked { v, n, rim }, i) in coming.iter().zip(0..) {
            for v in v {
                match local.get_mut(v as usize) {
                    None if v == ADDED && add.is_some() => is_added = true,
                    None | Some(&mut (NONE | REMOVED)) => return false,
                    Some(&mut SEEN) => {}
                    Some(number) => {
                        *number = SEEN;
                        seen += 1;
                    }
                }
            }
            let mut tet = Coming { v, label: None, small: NONE, n, rim };
            for (slot, &there) in n.iter().enumerate() {
                let face = oriented_face(&v, slot);
                if rim >> slot & 1 == 0 {
                    if !meets(coming, (4 * i + slot as u32, face), there) {
                        return false;
                    }
                } else {
                    let Some(found) = self.face_of_hole(face, there, marks) else { return false };
                    tet.n[slot] = faces.len() as u32;
                    faces.push(found);
                }
            }
            linked.push(tet);
        }
        faces.len() == count && seen == vertices.len() && is_added == add.is_some()
    }

    /// The face of the hole that is `face`, seen from inside, and is named by its handle outside. None if there is no such face, or it has been found before:
    /// the marks of what goes tell.
    fn face_of_hole(&self, face: [u32; 3], outside: u32, marks: &mut [u8]) -> Option<HoleFace> {
        let beyond = self.topology.tets.get(tet_of(outside) as usize)?;
        if !beyond.is_live() || marks[tet_of(outside) as usize] != 0 {
            return None;
        }
        let inside = beyond.n[slot_of(outside)];
        let (mark, found) = (&mut marks[tet_of(inside) as usize], 2 << slot_of(inside));
        let is_same = same_face(oriented_face(&self.topology.tet(tet_of(inside)).v, slot_of(inside)), face);
        if *mark == 0 || *mark & found != 0 || !is_same {
            return None;
        }
        *mark |= found;
        Some(self.hole_face(tet_of(inside), outside))
    }

    /// Whether what comes is positive, and locally Delaunay among itself and with what is around it.
    fn is_delaunay_in(&self, hole: &Hole) -> bool {
        let mut filter = self.filter.clone();
        if let Some(p) = hole.add {
            filter.extend(p);
        }
        hole.coming.iter().zip(0u32..).all(|(tet, i)| {
            let Some(corners) = self.coming_corners(hole, tet) else { return false };
            let ball = Ball::of(corners);
            ball.orientation(&filter) == Sign::Positive
                && (0..4).all(|slot| {
                    let n = tet.n[slot];
                    let beyond = if tet.rim >> slot & 1 != 0 {
                        let outside = hole.faces[n as usize].outside;
                        let v = self.topology.tet(tet_of(outside)).v[slot_of(outside)];
                        // Beyond the hull is no vertex, and a positive tetrahedron is inside of it.
                        if v == GHOST {
                            return true;
                        }
                        v
                    } else if tet_of(n) < i {
                        // It has been looked at from the other side.
                        return true;
                    } else {
                        hole.coming[tet_of(n) as usize].v[slot_of(n)]
                    };
                    !ball.conflicts(&filter, *self.coming_point(hole, beyond))
                })
        })
    }
}

/// Whether a face of what comes and the one that it has as its other side have each other.
fn meets(coming: &[Linked], (this, face): (u32, [u32; 3]), there: u32) -> bool {
    let Some(other) = coming.get(tet_of(there) as usize) else { return false };
    let slot = slot_of(there);
    // From the other side it goes round the other way.
    let [a, b, c] = oriented_face(&other.v, slot);
    other.rim >> slot & 1 == 0 && other.n[slot] == this && there != this && same_face([a, c, b], face)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::super::faces::rotated;
    use super::*;
    use crate::{Control, DVec3};

    fn points() -> impl Strategy<Value = Vec<DVec3>> {
        let real = (-1.0..1.0, -1.0..1.0, -1.0..1.0).prop_map(|(x, y, z): (f64, f64, f64)| DVec3::new(x, y, z));
        let grid = (0..4, 0..4, 0..4).prop_map(|(x, y, z): (i32, i32, i32)| DVec3::new(x.into(), y.into(), z.into()));
        prop_oneof![prop::collection::vec(real, 20..60), prop::collection::vec(grid, 20..60)]
    }

    fn guess(t: &Triangulation, replacement: &Replacement) -> Option<(Vec<u32>, Vec<[u32; 4]>)> {
        let mut hole = Hole::default();
        t.preview(replacement, &|_| false, &mut hole).ok()?;
        let inner = hole.going.iter().all(|going| going.v[3] != GHOST) && hole.coming.iter().all(|c| c.v[3] != GHOST);
        let of = |hole: &Hole| (hole.going.iter().map(|g| g.t).collect(), hole.coming.iter().map(|c| c.v).collect());
        inner.then(|| of(&hole))
    }

    /// With the neighbours that fit, as far as there are any: those that come first, then those outside.
    fn linked(t: &Triangulation, going: &[u32], coming: &[[u32; 4]]) -> Guess {
        let mut sides: BTreeMap<[u32; 3], Vec<(u32, bool)>> = BTreeMap::new();
        for (v, i) in coming.iter().zip(0..) {
            for slot in 0..4 {
                sides.entry(rotated(oriented_face(v, slot as usize))).or_default().push((4 * i + slot, false));
            }
        }
        let outside = going.iter().flat_map(|&id| t.topology.tet(id).n).filter(|&n| !going.contains(&tet_of(n)));
        for n in outside {
            let v = t.topology.tet(tet_of(n)).v;
            sides.entry(rotated(oriented_face(&v, slot_of(n)))).or_default().push((n, true));
        }
        let link = |(&v, i): (&[u32; 4], u32)| {
            let mut linked = Linked { v, n: [NONE; 4], rim: 0 };
            for slot in 0..4 {
                let [a, b, c] = oriented_face(&v, slot);
                let this = 4 * i + slot as u32;
                let others = sides.get(&rotated([a, c, b])).into_iter().flatten();
                if let Some(&(n, rim)) = others.into_iter().find(|&&(n, rim)| rim || n != this) {
                    linked.n[slot] = n;
                    linked.rim |= u8::from(rim) << slot;
                }
            }
            linked
        };
        Guess { going: going.to_vec(), coming: coming.iter().zip(0..).map(link).collect() }
    }

    /// All that differs a little from what comes.
    fn spoiled(t: &Triangulation, going: &[u32], coming: &[[u32; 4]]) -> Vec<Guess> {
        let mut all = Vec::new();
        for i in 0..coming.len() {
            let mut fewer = coming.to_vec();
            let [a, b, c, d] = fewer.remove(i);
            all.push(linked(t, going, &fewer));
            let with = |tet: &[[u32; 4]]| linked(t, going, &[&fewer, tet].concat());
            // Turned inside out, twice, and with a vertex of another.
            all.push(with(&[[b, a, c, d]]));
            all.push(with(&[[a, b, c, d], [a, b, c, d]]));
            let other = coming[(i + 1) % coming.len()];
            all.extend(other.iter().filter(|v| ![a, b, c, d].contains(v)).map(|&v| with(&[[a, b, c, v]])));
            // Two that share a face made three.
            for (j, other) in coming.iter().enumerate().filter(|&(j, _)| j > i) {
                let [Some(p), None] = [0, 1].map(|n| other.iter().filter(|v| ![a, b, c, d].contains(v)).nth(n)) else {
                    continue;
                };
                let rest = coming.iter().enumerate().filter(|&(k, _)| k != i && k != j).map(|(_, &v)| v);
                let mut flipped: Vec<[u32; 4]> = rest.collect();
                for slot in 0..4 {
                    let mut tet = [a, b, c, d];
                    if other.contains(&tet[slot]) {
                        tet[slot] = *p;
                        flipped.push(tet);
                    }
                }
                all.push(linked(t, going, &flipped));
            }
        }
        all.extend((0..going.len()).map(|i| linked(t, &[&going[..i], &going[i + 1..]].concat(), coming)));
        // Each neighbour another one, and on the other side of the rim.
        let right = linked(t, going, coming);
        for (i, tet) in right.coming.iter().enumerate() {
            for slot in 0..4 {
                for n in tet.n.into_iter().chain([
                    tet.n[slot] ^ 1,
                    4 * i as u32 + slot as u32,
                    NONE,
                    4 * coming.len() as u32,
                ]) {
                    if n != tet.n[slot] {
                        let mut wrong = right.clone();
                        wrong.coming[i].n[slot] = n;
                        all.push(wrong);
                    }
                }
                let mut wrong = right.clone();
                wrong.coming[i].rim ^= 1 << slot;
                all.push(wrong);
            }
        }
        all
    }

    proptest! {
        #[test]
        fn what_a_preview_finds_is_certified_and_nothing_else(
            points in points(), v in 0..60usize, add in prop::option::of((0.0..1.0, 0.0..1.0, 0.0..1.0))
        ) {
            let mut t = Triangulation::new();
            t.insert_many(&points, &Control::new()).unwrap();
            let vertices: Vec<u32> = t.vertices().collect();
            let v = vertices[v % vertices.len()];
            let add = add.map(|(x, y, z): (f64, f64, f64)| t.at(v) + 0.3 * DVec3::new(x, y, z));
            let remove = [v];
            let replacement = Replacement { remove: &remove, add };
            prop_assume!(t.dimension() == 3);
            let Some((going, coming)) = guess(&t, &replacement) else { return Ok(()) };
            let mut hole = Hole::default();
            for guess in spoiled(&t, &going, &coming) {
                prop_assert!(!t.certify(&replacement, &guess, &|_| false, &mut hole));
                prop_assert!(hole.going.is_empty() && hole.coming.is_empty());
            }
            prop_assert!(t.certify(&replacement, &linked(&t, &going, &coming), &|_| false, &mut hole));
            t.replace(&mut hole).unwrap();
            prop_assert_eq!(t.validate(3), Ok(()));
        }
    }
}
