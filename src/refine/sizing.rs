//! How large tetrahedra may be, beside how good they must be: the largest length of an edge, as a function of place.
//!
//! A tetrahedron with a longer edge gets its circumcentre, under the same boundary rules as a bad one. Its circumradius is at least half of
//! that edge, so no edge comes to be shorter than a quarter of what is asked for, where input angles are not small.

use crate::triangulation::Triangulation;
use crate::DVec3;

/// The callback's type: it fills in the largest edge length asked for at each point.
pub type SizeCallback<'a> = dyn Fn(&[DVec3], &mut [f64]) + 'a;

/// What is asked for. Of several sources the smallest size counts at each place. Sizes that are not positive and finite ask for nothing.
///
/// Where anything is asked for, Steiner points are not [taken away](crate::RefineOptions::sparsify) again.
#[derive(Clone, Copy, Default)]
pub struct Sizing<'a> {
    /// The same everywhere.
    pub uniform: f64,
    /// One a region, in the order of [`Plc::regions`](crate::Plc::regions); missing ones ask for nothing.
    pub regions: &'a [f64],
    /// One a vertex, by id; missing ones ask for nothing. Between vertices sizes are interpolated: a new vertex gets the mean of those around it,
    /// weighted by the inverse of their distance.
    pub vertices: &'a [f64],
    /// Asked for many points at once, the centroids of tetrahedra. It must give the same answer each time.
    pub callback: Option<&'a SizeCallback<'a>>,
}

impl std::fmt::Debug for Sizing<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Sizing")
            .field("uniform", &self.uniform)
            .field("regions", &self.regions)
            .field("vertices", &self.vertices.len())
            .field("callback", &self.callback.is_some())
            .finish()
    }
}

/// A size, or none as infinity.
fn asked(size: f64) -> f64 {
    if size > 0.0 && size.is_finite() {
        size
    } else {
        f64::INFINITY
    }
}

/// The sizes of a refinement under way.
pub struct Sizes<'a> {
    sizing: Sizing<'a>,
    /// The largest volume of each region, infinite for none.
    volumes: Vec<f64>,
    /// By vertex id.
    at_vertex: Vec<f64>,
    points: Vec<DVec3>,
    answers: Vec<f64>,
}

impl<'a> Sizes<'a> {
    /// For a refinement with this sizing, in regions with these largest volumes.
    pub fn new(sizing: Sizing<'a>, volumes: &[Option<f64>]) -> Sizes<'a> {
        Sizes {
            sizing,
            volumes: volumes.iter().map(|volume| volume.map_or(f64::INFINITY, asked)).collect(),
            at_vertex: sizing.vertices.iter().copied().map(asked).collect(),
            points: Vec::new(),
            answers: Vec::new(),
        }
    }

    /// The sizes of all vertices, new ones included.
    pub fn into_vertices(self) -> Vec<f64> {
        self.at_vertex
    }

    /// With vertices' sizes that are known from before.
    pub fn with_vertices(self, at_vertex: Vec<f64>) -> Self {
        Sizes { at_vertex, ..self }
    }

    /// Whether nothing is asked for.
    pub fn is_empty(&self) -> bool {
        let none = |sizes: &[f64]| sizes.iter().all(|size| size.is_infinite());
        asked(self.sizing.uniform).is_infinite()
            && self.sizing.regions.iter().all(|&size| asked(size).is_infinite())
            && self.sizing.callback.is_none()
            && none(&self.volumes)
            && none(&self.at_vertex)
    }

    /// Gives a new vertex its size, from those around it.
    pub fn add_vertex(&mut self, t: &Triangulation, vertex: u32, around: impl Iterator<Item = u32>) {
        if self.sizing.vertices.is_empty() {
            return;
        }
        let (mut sum, mut weights) = (0.0, 0.0);
        for v in around {
            let size = self.at_vertex.get(v as usize).copied().unwrap_or(f64::INFINITY);
            if size.is_finite() {
                let weight = 1.0 / t.at(v).distance(t.at(vertex));
                sum += weight * size;
                weights += weight;
            }
        }
        if self.at_vertex.len() <= vertex as usize {
            self.at_vertex.resize(vertex as usize + 1, f64::INFINITY);
        }
        self.at_vertex[vertex as usize] = asked(sum / weights);
    }

    /// Those of some tetrahedra of the domain that are too large.
    pub fn too_large(&mut self, t: &Triangulation, tets: &[u32]) -> Vec<u32> {
        self.answers.clear();
        self.answers.resize(tets.len(), f64::INFINITY);
        if let Some(callback) = self.sizing.callback {
            self.points.clear();
            self.points.extend(tets.iter().map(|&tet| t.corners(tet).into_iter().sum::<DVec3>() / 4.0));
            callback(&self.points, &mut self.answers);
        }
        let exceeds = |&(i, &tet): &(usize, &u32)| {
            let region = t.topology.region.get(tet as usize).map(|&label| (label as usize).wrapping_sub(2));
            let of_region = |list: &[f64]| region.and_then(|r| list.get(r).copied()).map_or(f64::INFINITY, asked);
            let mut size = asked(self.answers[i]).min(asked(self.sizing.uniform)).min(of_region(self.sizing.regions));
            if !self.at_vertex.is_empty() {
                let known = t.topology.tet(tet).v.map(|v| self.at_vertex.get(v as usize).copied());
                let (sum, count) = known
                    .into_iter()
                    .flatten()
                    .filter(|size| size.is_finite())
                    .fold((0.0, 0), |(sum, count), size| (sum + size, count + 1));
                size = size.min(asked(sum / f64::from(count)));
            }
            let [a, b, c, d] = t.corners(tet);
            let volume = (b - a).cross(c - a).dot(d - a).abs() / 6.0;
            let longest = crate::geometry::quality::EDGES
                .map(|[i, j]| t.corners(tet)[i].distance_squared(t.corners(tet)[j]))
                .into_iter()
                .fold(0.0, f64::max);
            longest > size * size || volume > of_region(&self.volumes)
        };
        tets.iter().enumerate().filter(exceeds).map(|(_, &tet)| tet).collect()
    }
}
