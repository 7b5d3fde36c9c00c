//! A preview from a guess: who believes to know what would fill a hole, from computations in floating point say, can have that certified, at a fraction of
//! the cost of finding it. By Delaunay's lemma it is enough to look at single tetrahedra and single faces: tetrahedra that are all positive, whose faces
//! match each other's and the hole's one to one, fill the hole; and when no face has the vertex beyond it in the sphere of the tetrahedron before it, after
//! perturbation, the whole is the Delaunay triangulation, of which there is but one.

use super::faces::{oriented_face, rotated};
use super::{Coming, Hole, Replacement, ADDED, REMOVED};
use crate::geometry::ball::Ball;
use crate::geometry::Sign;
use crate::memory;
use crate::triangulation::topology::{slot_of, tet_of, GHOST, NONE};
use crate::triangulation::Triangulation;

impl Triangulation {
    /// As [`preview`](Self::preview), if these tetrahedra are what goes and those with these vertices, [`ADDED`] among them, what comes, no ghosts among
    /// either. False when that is not so, or can't be told; `hole` is empty then.
    pub(crate) fn certify(
        &self,
        replacement: &Replacement,
        (going, coming): (&[u32], &[[u32; 4]]),
        is_wall: &dyn Fn([u32; 3]) -> bool,
        hole: &mut Hole,
    ) -> bool {
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
        let fits = self.find_faces(hole, &|| true).is_ok()
            && hole.going.len() == going.len()
            && self.takes_stars(hole)
            && match_faces(coming, hole)
            && self.is_delaunay_in(hole);
        hole.forget_numbers();
        if !fits {
            hole.clear();
            return false;
        }
        self.label_coming(is_wall, hole);
        true
    }

    /// Whether all tetrahedra at the vertices that go, go: no face of the hole has one.
    fn takes_stars(&self, hole: &Hole) -> bool {
        // Those vertices have no number.
        let has_number = |key: &[u32; 3]| key.iter().all(|&number| number != REMOVED);
        hole.by_vertices.keys.iter().all(has_number)
            && hole.remove.iter().all(|&v| hole.contains(self.topology.vertex_tet[v as usize]))
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

/// Links what comes along its faces. False when they don't match one to one, the hole's faces among them.
fn match_faces(coming: &[[u32; 4]], hole: &mut Hole) -> bool {
    let Hole { local, by_vertices, inner, halves, faces, coming: linked, vertices, .. } = hole;
    let number = |v: u32| {
        if v == ADDED {
            vertices.first().filter(|&&v| v == ADDED).map(|_| 0)
        } else {
            local.get(v as usize).copied()
        }
    };
    let is_number = |n: u32| (n as usize) < vertices.len();
    // The new vertex is on no face of the hole.
    let adds = vertices.first() == Some(&ADDED);
    inner.clear();
    halves.clear();
    let mut found = 0;
    for &v in coming {
        let mut numbers = [NONE; 4];
        for (slot, &v) in v.iter().enumerate() {
            match number(v) {
                Some(n) if is_number(n) => numbers[slot] = n,
                _ => return false,
            }
        }
        let i = linked.len() as u32;
        let mut tet = Coming { v, label: None, small: NONE, n: [NONE; 4], rim: 0 };
        for slot in 0..4 {
            let key = rotated(oriented_face(&numbers, slot));
            let at_rim = if adds && key[0] == 0 { None } else { by_vertices.find(key) };
            match at_rim {
                Some(face) => {
                    tet.n[slot] = face;
                    tet.rim |= 1 << slot;
                    found += 1;
                }
                None => {
                    inner.keys.push(key);
                    halves.push(4 * i + slot as u32);
                }
            }
        }
        linked.push(tet);
    }
    if found != faces.len() {
        return false;
    }
    if inner.index(&|| true).is_err() {
        return false;
    }
    let mut pairs = 0;
    for (&[a, b, c], &half) in inner.keys.iter().zip(halves.iter()) {
        // From the other side it goes round the other way.
        let Some(other) = inner.find(rotated([a, c, b])) else { return false };
        let other = halves[other as usize];
        linked[tet_of(half) as usize].n[slot_of(half)] = other;
        pairs += usize::from(half != other);
    }
    // Each face of the hole was found once, and each half has the other one as its own: no key came twice.
    let mutual = |&half: &u32| {
        let other = linked[tet_of(half) as usize].n[slot_of(half)];
        linked[tet_of(other) as usize].n[slot_of(other)] == half
    };
    let mut seen = vec![false; faces.len()];
    let once = linked.iter().all(|tet| {
        (0..4)
            .filter(|slot| tet.rim >> slot & 1 != 0)
            .all(|slot| !std::mem::replace(&mut seen[tet.n[slot] as usize], true))
    });
    pairs == halves.len() && halves.iter().all(mutual) && once
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

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

    /// All that differs a little from what comes.
    fn spoiled(going: &[u32], coming: &[[u32; 4]]) -> Vec<(Vec<u32>, Vec<[u32; 4]>)> {
        let mut all = Vec::new();
        for i in 0..coming.len() {
            let mut fewer = coming.to_vec();
            let [a, b, c, d] = fewer.remove(i);
            all.push((going.to_vec(), fewer.clone()));
            let with = |tet: &[[u32; 4]]| (going.to_vec(), [&fewer, tet].concat());
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
                all.push((going.to_vec(), flipped));
            }
        }
        all.extend((0..going.len()).map(|i| ([&going[..i], &going[i + 1..]].concat(), coming.to_vec())));
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
            for (going, coming) in spoiled(&going, &coming) {
                prop_assert!(!t.certify(&replacement, (&going, &coming), &|_| false, &mut hole));
                prop_assert!(hole.going.is_empty() && hole.coming.is_empty());
            }
            prop_assert!(t.certify(&replacement, (&going, &coming), &|_| false, &mut hole));
            t.replace(&mut hole).unwrap();
            prop_assert_eq!(t.validate(3), Ok(()));
        }
    }
}
