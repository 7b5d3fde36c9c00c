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

/// Keys that are looked at together.
const KEYS: usize = 8;
/// No face's key.
const NO_KEY: u32 = u32::MAX;

/// The faces still to be wrapped, with their keys apart: looking for one is most of what is done with them.
#[derive(Clone, Debug, Default)]
pub(super) struct OpenFaces {
    /// Behind those of the faces all are [`NO_KEY`].
    keys: Vec<[u32; KEYS]>,
    faces: Vec<Open>,
}

impl OpenFaces {
    #[inline(always)]
    pub fn push(&mut self, v: [u8; 3], behind: u16) {
        let place = self.faces.len();
        if place == KEYS * self.keys.len() {
            self.lengthen();
        }
        self.keys[place / KEYS][place % KEYS] = packed(v);
        self.faces.push(Open { v, behind });
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<Open> {
        let last = self.faces.pop()?;
        self.drop_key();
        Some(last)
    }

    /// Takes the face with these vertices out, the first one if there are two. Returns what lies behind it.
    #[inline(always)]
    fn take(&mut self, v: [u8; 3]) -> Option<u16> {
        let key = packed(v);
        // All of them, in lanes: where a loop ends early can't be foretold, and a wrong guess takes longer than the rest of it.
        let (mut found, mut next) = ([u32::MAX; KEYS], [0, 1, 2, 3, 4, 5, 6, 7]);
        for keys in self.keys.iter().take(self.faces.len().div_ceil(KEYS)) {
            for lane in 0..KEYS {
                found[lane] = found[lane].min(if keys[lane] == key { next[lane] } else { u32::MAX });
                next[lane] += KEYS as u32;
            }
        }
        let place = found.into_iter().fold(u32::MAX, u32::min) as usize;
        if place >= self.faces.len() {
            return None;
        }
        let behind = self.faces.swap_remove(place).behind;
        let last = self.drop_key();
        if place < self.faces.len() {
            self.keys[place / KEYS][place % KEYS] = last;
        }
        Some(behind)
    }

    /// Takes out the key behind those of all faces.
    #[inline(always)]
    fn drop_key(&mut self) -> u32 {
        let place = self.faces.len();
        std::mem::replace(&mut self.keys[place / KEYS][place % KEYS], NO_KEY)
    }

    #[cold]
    fn lengthen(&mut self) {
        self.keys.push([NO_KEY; KEYS]);
    }

    pub fn clear(&mut self) {
        self.keys.iter_mut().take(self.faces.len().div_ceil(KEYS)).for_each(|keys| *keys = [NO_KEY; KEYS]);
        self.faces.clear();
    }

    fn len(&self) -> usize {
        self.faces.len()
    }
}

/// Corners that are looked at together.
const LANES: usize = 4;

/// Where four corners are, and their squared distances from the hole's origin. A corner that is not there is at NaN, which is beyond no face.
#[derive(Clone, Copy, Debug)]
struct Four {
    x: [f64; LANES],
    y: [f64; LANES],
    z: [f64; LANES],
    square: [f64; LANES],
}

/// The corners of the open faces: no other vertex is an apex.
#[derive(Clone, Debug, Default)]
pub(super) struct Corners {
    places: Vec<Four>,
    /// Their numbers in the hole.
    number: Vec<u8>,
    /// The largest distance from the origin.
    extent: f64,
}

impl Corners {
    #[inline(always)]
    fn begin(&mut self, open: &OpenFaces, at: impl Fn(u8) -> DVec3) {
        let Corners { places, number, extent } = self;
        let mut sets = [0u64; 4];
        for face in &open.faces {
            for v in face.v {
                sets[usize::from(v / 64)] |= 1 << (v % 64);
            }
        }
        number.clear();
        for (mut set, first) in sets.into_iter().zip([0, 64, 128, 192]) {
            while set != 0 {
                number.push(first + set.trailing_zeros() as u8);
                set &= set - 1;
            }
        }
        places.clear();
        let mut most: f64 = 0.0;
        for four in number.chunks(LANES) {
            let none = [f64::NAN; LANES];
            let mut place = Four { x: none, y: none, z: none, square: none };
            for (lane, &v) in four.iter().enumerate() {
                let p = at(v);
                (place.x[lane], place.y[lane], place.z[lane]) = (p.x, p.y, p.z);
                place.square[lane] = p.length_squared();
                most = most.max(place.square[lane]);
            }
            places.push(place);
        }
        *extent = most.sqrt();
    }

    /// The one whose sphere through a face has the lowest centre over it, among those beyond it, and that height as a multiple of the normal `n`. `a` is
    /// a corner of the face, `center` its circumcentre.
    ///
    /// A point x is above the plane by h = n·x − n·a, and its power with the circle's own sphere is x² − 2 x·center + center² − (center − a)²: the quotient is twice
    /// the height.
    #[inline(always)]
    fn lowest(&self, a: DVec3, n: DVec3, center: DVec3) -> Option<(u8, f64)> {
        let (twice_n, twice_center) = (2.0 * n, 2.0 * center);
        let base = twice_n.dot(a);
        let constant = center.length_squared() - center.distance_squared(a);
        // What is nearer to the plane is in it, as far as can be told.
        let flat = 2e-10 * n.length() * self.extent;
        let (mut best, mut place) = ([f64::INFINITY; LANES], [0u64; LANES]);
        for (i, four) in self.places.iter().enumerate() {
            for lane in 0..LANES {
                let (x, y, z) = (four.x[lane], four.y[lane], four.z[lane]);
                let h = (twice_n.x * x + twice_n.y * y + twice_n.z * z) - base;
                let along = twice_center.x * x + twice_center.y * y + twice_center.z * z;
                let tau = ((four.square[lane] + constant) - along) / h;
                let better = (h > flat) & (tau < best[lane]);
                best[lane] = if better { tau } else { best[lane] };
                place[lane] = if better { i as u64 } else { place[lane] };
            }
        }
        let lower = |i: usize, j: usize| if best[j] < best[i] { j } else { i };
        let lane = lower(lower(0, 1), lower(2, 3));
        (best[lane] < f64::INFINITY).then(|| (self.number[place[lane] as usize * LANES + lane], best[lane]))
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
        let mut corners = std::mem::take(&mut self.corners);
        corners.begin(&self.open, |v| self.at(v));
        let fits = self.wrap_within(&corners, limit, demand, most);
        self.corners = corners;
        fits
    }

    #[inline(always)]
    fn wrap_within(&mut self, corners: &Corners, limit: usize, demand: Demand, most: usize) -> bool {
        while let Some(face) = self.open.pop() {
            if self.filling.len() >= limit {
                return false;
            }
            // No `map`: it would not be inlined here, where more instructions may be used than elsewhere.
            let [i, j, k] = face.v;
            let (a, b, c) = (self.at(i), self.at(j), self.at(k));
            let (u, w) = (b - a, c - a);
            let n = u.cross(w);
            let nn = n.length_squared();
            let offset = (w.length_squared() * n.cross(u) + u.length_squared() * w.cross(n)) / (2.0 * nn);
            let center = a + offset;
            let Some((apex, tau)) = corners.lowest(a, n, center) else { return false };
            let d = self.at(apex);
            let shortest2 = u
                .length_squared()
                .min(w.length_squared())
                .min(b.distance_squared(c))
                .min(a.distance_squared(d))
                .min(b.distance_squared(d))
                .min(c.distance_squared(d));
            let this = self.filling.len() as u16;
            let mut tet = Filling {
                v: [i, j, k, apex],
                n: [0, 0, 0, face.behind],
                center: center + tau * n,
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
