//! The Voronoi facet of an edge and its core disk, in the plane of both.
//!
//! With the edge's midpoint as origin `m` and half its length `h`, a point `x` of the bisector plane is nearer to `p` (and `q`)
//! than to a vertex `r` when `x·w ≤ k`, `w` being the projection of `r − m` to the plane and `k = (|r − m|² − h²) / 2`. So the
//! facet is an intersection of half-planes, one a link vertex; their order doesn't matter, and no circumcentre
//! is needed to see where the facet covers the core disk's rim.
//!
//! At the hull the facet is unbounded; it is closed by the planes of the two hull facets, that is by
//! the wedge in which the domain lies. (The paper closes the chain of circumcentres with the circumcentres of the two facets and m:
//! the same region, for these circumcentres lie on the wedge's sides.)

use glam::{DVec2, DVec3};

/// The half-plane of points nearer to the edge than to one link vertex: `x·normal ≤ offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfPlane {
    /// Not of unit length.
    pub normal: DVec2,
    /// k above.
    pub offset: f64,
}

/// The bisector plane of an edge with the facet's half-planes.
#[derive(Clone, Debug, Default)]
pub struct VoronoiFacet {
    midpoint: DVec3,
    axes: [DVec3; 2],
    /// Length of the edge.
    pub length: f64,
    half_planes: Vec<HalfPlane>,
    /// The directions of the hull facets, for an edge of the hull.
    wedge: Option<[f64; 2]>,
}

/// A maximal arc of the core disk's rim inside the facet: what bounds one component of the facet less the disk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Where it starts, in radians.
    pub start: f64,
    /// The component's span angle γ, up to 2π.
    pub span: f64,
}

const TAU: f64 = std::f64::consts::TAU;

/// Two unit vectors orthogonal to the unit vector `n` and to each other (J. Frisvad's construction as revised by T. Duff et al.,
/// "Building an orthonormal basis, revisited", JCGT 6, 2017).
fn orthonormal(n: DVec3) -> [DVec3; 2] {
    let sign = 1f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    [DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), DVec3::new(b, sign + n.y * n.y * a, -n.y)]
}

impl VoronoiFacet {
    /// The facet of edge `pq` with these link vertices. `closed` is false for an edge of the hull: then the first and last link
    /// vertices are the hull facets' third corners.
    pub fn new(p: DVec3, q: DVec3, link: &[DVec3], closed: bool) -> VoronoiFacet {
        let mut facet = VoronoiFacet::default();
        facet.set(p, q, link.iter().copied(), closed);
        facet
    }

    /// [`new`](Self::new) in place, keeping the memory.
    pub fn set(&mut self, p: DVec3, q: DVec3, link: impl Iterator<Item = DVec3>, closed: bool) {
        let half = (q - p) * 0.5;
        self.midpoint = p + half;
        self.length = 2.0 * half.length();
        self.axes = orthonormal(half / half.length());
        self.half_planes.clear();
        let (midpoint, axes) = (self.midpoint, self.axes);
        self.half_planes.extend(link.map(|r| {
            let r = r - midpoint;
            HalfPlane {
                normal: DVec2::new(r.dot(axes[0]), r.dot(axes[1])),
                offset: 0.5 * (r.length_squared() - half.length_squared()),
            }
        }));
        self.wedge = match (closed, self.half_planes.first(), self.half_planes.last()) {
            (false, Some(first), Some(last)) => {
                let angle = |h: &HalfPlane| h.normal.y.atan2(h.normal.x);
                // The link goes around the edge either way: the wedge is the side on which the inner link vertices lie.
                let (first, last) = (angle(first), angle(last));
                let turn: f64 = self.half_planes.windows(2).map(|w| w[0].normal.angle_to(w[1].normal)).sum();
                Some(if turn >= 0.0 { [first, last] } else { [last, first] })
            }
            _ => None,
        };
    }

    /// Radius of the core disk for the bound β = `radius_edge`: sqrt(β² − ¼) times the edge's length.
    pub fn core_radius(&self, radius_edge: f64) -> f64 {
        (radius_edge * radius_edge - 0.25).max(0.0).sqrt() * self.length
    }

    /// The point of space at an angle and a distance from the edge's midpoint.
    pub fn point(&self, angle: f64, distance: f64) -> DVec3 {
        let (sin, cos) = angle.sin_cos();
        self.midpoint + (self.axes[0] * cos + self.axes[1] * sin) * distance
    }

    /// Where the ray from the midpoint at this angle leaves the facet: the distance, infinite if nowhere. Less than
    /// nothing when the midpoint itself is outside.
    pub fn exit(&self, angle: f64) -> f64 {
        let (sin, cos) = angle.sin_cos();
        let u = DVec2::new(cos, sin);
        self.half_planes
            .iter()
            .filter_map(|h| {
                let along = h.normal.dot(u);
                // A half-plane that the ray enters bounds it only if the midpoint is outside.
                if along > 0.0 {
                    Some(h.offset / along)
                } else if h.offset < 0.0 {
                    Some(f64::NEG_INFINITY)
                } else {
                    None
                }
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// How many link vertices are as near as the edge, but for this share of the squared distance, to the facet's point at an angle and a distance from the midpoint.
    pub fn crowd(&self, angle: f64, distance: f64, share: f64) -> usize {
        let (sin, cos) = angle.sin_cos();
        let x = DVec2::new(cos, sin) * distance;
        let radius2 = distance * distance + 0.25 * self.length * self.length;
        self.half_planes.iter().filter(|h| 2.0 * (h.offset - x.dot(h.normal)) <= share * radius2).count()
    }

    /// The arcs of the circle of this radius that lie inside the facet, in order of their angles; the whole circle is one arc
    /// of span 2π. `arcs` is filled; it stays empty when the circle lies outside, or around the facet.
    pub fn rim_arcs(&self, radius: f64, arcs: &mut Vec<Arc>) {
        arcs.clear();
        // Each half-plane cuts off an interval about its normal's direction; what remains are the gaps of their union.
        let mut cut: Vec<(f64, f64)> = Vec::with_capacity(self.half_planes.len() + 2);
        let mut add = |start: f64, span: f64| {
            let start = start.rem_euclid(TAU);
            if start + span <= TAU {
                cut.push((start, start + span));
            } else {
                cut.push((start, TAU));
                cut.push((0.0, start + span - TAU));
            }
        };
        for h in &self.half_planes {
            let reach = radius * h.normal.length();
            if h.offset <= -reach {
                return;
            }
            if h.offset < reach {
                let half = (h.offset / reach).acos();
                add(h.normal.y.atan2(h.normal.x) - half, 2.0 * half);
            }
        }
        if let Some([first, last]) = self.wedge {
            add(last, (first - last).rem_euclid(TAU));
        }
        if cut.is_empty() {
            arcs.push(Arc { start: 0.0, span: TAU });
            return;
        }
        cut.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut end = cut[0].1;
        for &(start, stop) in &cut[1..] {
            if start > end {
                arcs.push(Arc { start: end, span: start - end });
            }
            end = end.max(stop);
        }
        // The gap across angle 0.
        let last = cut[0].0 + TAU - end;
        if last > 0.0 {
            arcs.push(Arc { start: end, span: last });
        }
    }

    /// The corners of the facet that are circumcentres of tetrahedra around the edge: each between successive link vertices, and
    /// between the last and the first of a ring. In the plane's coordinates.
    pub fn corners(&self) -> impl Iterator<Item = DVec2> + '_ {
        let n = self.half_planes.len();
        let pairs = if self.wedge.is_some() { n.saturating_sub(1) } else { n };
        (0..pairs).map(move |i| {
            let (a, b) = (self.half_planes[i], self.half_planes[(i + 1) % n]);
            (a.offset * DVec2::new(b.normal.y, -b.normal.x) + b.offset * DVec2::new(-a.normal.y, a.normal.x))
                / a.normal.perp_dot(b.normal)
        })
    }

    /// A point of the plane's coordinates in space.
    pub fn to_space(&self, x: DVec2) -> DVec3 {
        self.midpoint + self.axes[0] * x.x + self.axes[1] * x.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// The edge from (0,0,−½) to (0,0,½) and link vertices at height 0.
    fn facet(link: &[(f64, f64)], closed: bool) -> VoronoiFacet {
        let link: Vec<DVec3> = link.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect();
        VoronoiFacet::new(DVec3::new(0.0, 0.0, -0.5), DVec3::new(0.0, 0.0, 0.5), &link, closed)
    }

    #[test]
    fn half_planes_are_bisectors() {
        let f = facet(&[(4.0, 0.0), (0.0, 4.0), (-4.0, 0.0), (0.0, -4.0)], true);
        // Equidistant from (4,0,0) and the edge's ends: (4 − t)² = t² + ¼.
        let t = (16.0 - 0.25) / 8.0;
        for c in f.corners() {
            let c = f.to_space(c);
            assert!((c.x.abs() - t).abs() < 1e-14 && (c.y.abs() - t).abs() < 1e-14, "{c}");
        }
        let angle = f.axes[0].y.atan2(f.axes[0].x);
        assert!((f.exit(-angle) - t).abs() < 1e-14);
    }

    #[test]
    fn arcs_of_a_square() {
        let f = facet(&[(4.0, 0.0), (0.0, 4.0), (-4.0, 0.0), (0.0, -4.0)], true);
        let t = (16.0 - 0.25) / 8.0;
        let mut arcs = Vec::new();
        f.rim_arcs(t * 0.99, &mut arcs);
        assert_eq!(arcs.len(), 1);
        assert_eq!(arcs[0].span, TAU);
        f.rim_arcs(t * 1.1, &mut arcs);
        assert_eq!(arcs.len(), 4);
        let span = FRAC_PI_2 - 2.0 * (1f64 / 1.1).acos();
        assert!(arcs.iter().all(|a| (a.span - span).abs() < 1e-13));
        f.rim_arcs(t * 1.5, &mut arcs);
        assert!(arcs.is_empty(), "the circle lies around the facet");
    }

    #[test]
    fn hull_edges_are_bounded_by_their_wedge() {
        let mut arcs = Vec::new();
        for link in [[(4.0, 0.0), (4.0, 4.0), (0.0, 4.0)], [(0.0, 4.0), (4.0, 4.0), (4.0, 0.0)]] {
            let f = facet(&link, false);
            f.rim_arcs(0.5, &mut arcs);
            assert_eq!(arcs.len(), 1);
            assert!((arcs[0].span - FRAC_PI_2).abs() < 1e-14);
            assert_eq!(f.corners().count(), 2);
            let middle = f.point(arcs[0].start + 0.5 * arcs[0].span, 1.0);
            assert!((middle.x - middle.y).abs() < 1e-14 && middle.x > 0.0);
        }
        // A reflex wedge.
        let f = facet(&[(4.0, 0.0), (0.0, 4.0), (-4.0, 0.0), (0.0, -4.0)], false);
        f.rim_arcs(0.5, &mut arcs);
        assert!((arcs[0].span - 1.5 * PI).abs() < 1e-14);
    }

    #[test]
    fn a_facet_beside_its_disk() {
        // A vertex inside the edge's diametral ball cuts the midpoint off.
        let f = facet(&[(0.1, 0.0), (-3.0, 9.0), (-3.0, -9.0)], true);
        let mut arcs = Vec::new();
        f.rim_arcs(1.0, &mut arcs);
        assert!(arcs.is_empty());
        assert!(f.exit(0.0) < 0.0);
    }
}
