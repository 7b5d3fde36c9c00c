//! Gift wrapping of a hole: a face's apex is the vertex beyond it whose sphere through the face reaches least far inside.

use glam::DVec3;

use super::{Demand, Filling, Forecast, ABSENT, RIM};

/// A face still to be wrapped.
#[derive(Clone, Copy, Debug)]
struct Open {
    /// Its vertices, counterclockwise seen from where its tetrahedron will be.
    v: [u8; 3],
    /// What lies behind it, as in [`Filling::n`].
    behind: u16,
}

/// A face's vertices, sorted and packed.
#[inline(always)]
fn packed(v: [u8; 3]) -> u32 {
    let [a, b, c] = v.map(u32::from);
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    low << 16 | (a + b + c - low - high) << 8 | high
}

/// The faces still to be wrapped, with their keys apart: looking for one is most of what is done with them.
#[derive(Clone, Debug, Default)]
pub(super) struct OpenFaces {
    keys: Vec<u32>,
    faces: Vec<Open>,
}

impl OpenFaces {
    #[inline(always)]
    pub fn push(&mut self, v: [u8; 3], behind: u16) {
        self.keys.push(packed(v));
        self.faces.push(Open { v, behind });
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<Open> {
        self.keys.pop();
        self.faces.pop()
    }

    /// Takes the face with these vertices out. Returns what lies behind it.
    #[inline(always)]
    fn take(&mut self, v: [u8; 3]) -> Option<u16> {
        let key = packed(v);
        const LANES: usize = 8;
        let chunks = self.keys.chunks_exact(LANES);
        let rest = chunks.remainder();
        let mut place = None;
        for (i, chunk) in chunks.enumerate() {
            // All of them, and only then which: that takes a few instructions.
            if chunk.iter().fold(false, |found, &k| found | (k == key)) {
                place = chunk.iter().position(|&k| k == key).map(|lane| i * LANES + lane);
                break;
            }
        }
        let start = self.keys.len() - rest.len();
        let place = place.or_else(|| rest.iter().position(|&k| k == key).map(|i| start + i))?;
        self.keys.swap_remove(place);
        Some(self.faces.swap_remove(place).behind)
    }

    pub fn clear(&mut self) {
        self.keys.clear();
        self.faces.clear();
    }

    fn len(&self) -> usize {
        self.faces.len()
    }
}

impl Forecast {
    /// Fills the hole inside the open faces. False when they don't close, or when more than `most` obstacles come.
    pub(super) fn wrap(&mut self, demand: Demand, most: usize) -> bool {
        #[cfg(target_arch = "x86_64")]
        if crate::geometry::lanes::Avx2::available() {
            // SAFETY: the processor has what the function is compiled for.
            return unsafe { self.wrap_avx2(demand, most) };
        }
        self.wrap_portable(demand, most)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    unsafe fn wrap_avx2(&mut self, demand: Demand, most: usize) -> bool {
        self.wrap_portable(demand, most)
    }

    #[inline(always)]
    fn wrap_portable(&mut self, demand: Demand, most: usize) -> bool {
        let limit = self.filling.len() + 4 * self.open.len() + 40;
        // A place at NaN lies beyond no face.
        for list in [&mut self.x, &mut self.y, &mut self.z] {
            list.resize(self.vertices.len().next_multiple_of(4), f64::NAN);
        }
        while let Some(face) = self.open.pop() {
            if self.filling.len() >= limit {
                return false;
            }
            let [a, b, c] = face.v.map(|v| self.at(v));
            let (u, w) = (b - a, c - a);
            let n = u.cross(w);
            let nn = n.length_squared();
            let offset = (w.length_squared() * n.cross(u) + u.length_squared() * w.cross(n)) / (2.0 * nn);
            let found = lowest(&self.x, &self.y, &self.z, a, n, 2.0 * offset, 1e-18 * nn);
            let Some((apex, tau)) = found else { return false };
            let d = self.at(apex);
            let shortest2 = u
                .length_squared()
                .min(w.length_squared())
                .min(b.distance_squared(c))
                .min(a.distance_squared(d))
                .min(b.distance_squared(d))
                .min(c.distance_squared(d));
            let [i, j, k] = face.v;
            let this = self.filling.len() as u16;
            let mut tet = Filling {
                v: [i, j, k, apex],
                n: [0, 0, 0, face.behind],
                center: a + offset + tau * n,
                radius2: offset.length_squared() + tau * tau * nn,
                id: ABSENT,
            };
            self.link(face.behind, 4 * this + 3);
            // The other faces, seen from beyond.
            for (slot, v) in [[j, k, apex], [k, i, apex], [i, j, apex]].into_iter().enumerate() {
                let other = 4 * this + slot as u16;
                match self.open.take(v) {
                    Some(behind) => {
                        tet.n[slot] = behind;
                        self.link(behind, other);
                    }
                    None => self.open.push(v, other),
                }
            }
            if tet.radius2 > demand.bound2 * shortest2 && shortest2 <= demand.level2 {
                if self.obstacles.len() == most {
                    return false;
                }
                self.obstacles.push(u32::from(this));
            }
            self.filling.push(tet);
        }
        true
    }

    /// Notes at one side of a face what the other is.
    #[inline(always)]
    fn link(&mut self, side: u16, other: u16) {
        if side & RIM == 0 {
            self.filling[(side >> 2) as usize].n[(side & 3) as usize] = other;
        } else {
            self.rim[(side & !RIM) as usize].inside = other;
        }
    }
}

/// The vertex whose sphere has the lowest centre over a face, among those beyond it.
#[inline(always)]
fn lowest(x: &[f64], y: &[f64], z: &[f64], a: DVec3, n: DVec3, twice: DVec3, flat: f64) -> Option<(u8, f64)> {
    const LANES: usize = 4;
    let (mut best, mut place) = ([f64::INFINITY; LANES], [0u64; LANES]);
    let all = x.chunks_exact(LANES).zip(y.chunks_exact(LANES)).zip(z.chunks_exact(LANES));
    for (i, ((x, y), z)) in all.enumerate() {
        for lane in 0..LANES {
            let (dx, dy, dz) = (x[lane] - a.x, y[lane] - a.y, z[lane] - a.z);
            let h = n.x * dx + n.y * dy + n.z * dz;
            let dd = dx * dx + dy * dy + dz * dz;
            let power = dd - (dx * twice.x + dy * twice.y + dz * twice.z);
            let tau = power / (2.0 * h);
            let better = (h > 0.0) & (h * h > flat * dd) & (tau < best[lane]);
            best[lane] = if better { tau } else { best[lane] };
            place[lane] = if better { i as u64 } else { place[lane] };
        }
    }
    let mut lane = 0;
    for other in 1..LANES {
        if best[other] < best[lane] {
            lane = other;
        }
    }
    (best[lane] < f64::INFINITY).then(|| (place[lane] as u8 * LANES as u8 + lane as u8, best[lane]))
}
