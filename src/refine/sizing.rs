//! How large tetrahedra may be, beside how good they must be: the largest length of an edge, as a function of place.
//!
//! A tetrahedron with a longer edge gets its circumcentre, under the same boundary rules as a bad one. Its circumradius is at least half of
//! that edge, so no edge comes to be shorter than a quarter of what is asked for, where input angles are not small.

use crate::triangulation::topology::GHOST;
use crate::triangulation::Triangulation;
use crate::{memory, Control, DVec3, Error};

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
    /// One a vertex, by id; missing ones ask for nothing. Between vertices sizes are interpolated, in the Delaunay triangulation of the input vertices
    /// and of those Steiner points that the list reaches: whatever else is inserted changes nothing, and a call for the same list goes on where
    /// another one ended. Towards a vertex that asks for nothing the sizes of others grow beyond all bounds: halfway they are twice as large.
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

fn ask_for_nothing(sizes: &[f64]) -> bool {
    sizes.iter().all(|&size| asked(size).is_infinite())
}

/// The mean of sizes, each with its weight. Where there is none it counts as a share without demand: the others' mean is divided by their share of
/// the weights, so that it grows beyond all bounds as that falls.
fn mean(sizes: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut all, mut known, mut sum) = (0.0, 0.0, 0.0);
    for (weight, size) in sizes {
        all += weight;
        if size.is_finite() {
            known += weight;
            sum += weight * size;
        }
    }
    asked(sum / known * (all / known))
}

/// Sizes between vertices that have them, and others that ask for nothing.
#[derive(Default)]
struct Field {
    t: Triangulation,
    /// By its vertices, infinite for none.
    sizes: Vec<f64>,
}

impl Field {
    /// The size at a point, and the vertex that is nearest in weight; `near` is one to look for the point from.
    fn at(&self, p: DVec3, near: u32) -> (f64, u32) {
        if self.t.dimension() < 3 {
            return (f64::INFINITY, near);
        }
        let mut filter = self.t.filter.clone();
        filter.extend(p);
        let start = self.t.start((near != GHOST).then_some(near));
        // What rounding has put outside the hull is taken as on it.
        let tet = self.t.finite_at(self.t.walk_with(&filter, p, start));
        let (v, corners) = (self.t.topology.tet(tet).v, self.t.corners(tet));
        let weights = [0, 1, 2, 3].map(|slot| {
            let mut replaced = corners;
            replaced[slot] = p;
            let [a, b, c, d] = replaced;
            (b - a).cross(c - a).dot(d - a).max(0.0)
        });
        let heaviest = (1..4).fold(0, |best, i| if weights[i] > weights[best] { i } else { best });
        (mean(weights.into_iter().zip(v.map(|v| self.sizes[v as usize]))), v[heaviest])
    }
}

/// The sizes of a refinement under way.
pub struct Sizes<'a> {
    sizing: Sizing<'a>,
    /// The largest volume of each region, infinite for none.
    volumes: Vec<f64>,
    /// By vertex id; empty when no vertex has a size.
    at_vertex: Vec<f64>,
    field: Field,
    /// By vertex id: one of the field's that is near.
    near: Vec<u32>,
    points: Vec<DVec3>,
    answers: Vec<f64>,
}

impl<'a> Sizes<'a> {
    /// For a refinement with this sizing, in regions with these largest volumes.
    pub fn new(sizing: Sizing<'a>, volumes: &[Option<f64>]) -> Sizes<'a> {
        Sizes {
            sizing,
            volumes: volumes.iter().map(|volume| volume.map_or(f64::INFINITY, asked)).collect(),
            at_vertex: Vec::new(),
            field: Field::default(),
            near: Vec::new(),
            points: Vec::new(),
            answers: Vec::new(),
        }
    }

    /// Finds the sizes of all vertices, of which those from `first_steiner` on are Steiner points.
    pub fn begin(&mut self, t: &Triangulation, first_steiner: usize, control: &Control) -> Result<(), Error> {
        const WHAT: &str = "sizes of vertices";
        let list = self.sizing.vertices;
        if ask_for_nothing(list) {
            return Ok(());
        }
        let slots = t.vertex_slots();
        let end = list.len().max(first_steiner).min(slots);
        let given = (0..end as u32).filter(|&v| t.is_vertex(v));
        let mut points = memory::with_room(end, WHAT)?;
        memory::reserve_exact(&mut self.at_vertex, slots, WHAT)?;
        memory::reserve_exact(&mut self.near, slots, WHAT)?;
        let turns = control.turns();
        for v in given.clone() {
            turns.check()?;
            points.push(t.at(v));
        }
        self.field.t.set_threads(t.threads());
        let Some(own) = self.field.t.insert_many(&points, control)? else { return Err(Error::Cancelled) };
        control.give_back(points);
        memory::reserve_exact(&mut self.field.sizes, own.len(), WHAT)?;
        self.field.sizes.resize(own.len(), f64::INFINITY);
        self.at_vertex.resize(slots, f64::INFINITY);
        self.near.resize(slots, GHOST);
        for (v, &own) in given.zip(&own) {
            turns.check()?;
            let size = list.get(v as usize).map_or(f64::INFINITY, |&size| asked(size));
            self.field.sizes[own as usize] = size;
            self.at_vertex[v as usize] = size;
            self.near[v as usize] = own;
        }
        control.give_back(own);
        let mut near = GHOST;
        for v in (end..slots).filter(|&v| t.is_vertex(v as u32)) {
            turns.check()?;
            (self.at_vertex[v], near) = self.field.at(t.at(v as u32), near);
            self.near[v] = near;
        }
        turns.end()
    }

    /// The sizes of all vertices, new ones included. The rest is given back to the control.
    pub fn into_vertices(self, control: &Control) -> Vec<f64> {
        control.give_back(self.field.t);
        control.give_back(self.field.sizes);
        control.give_back(self.near);
        self.at_vertex
    }

    /// With vertices' sizes that are known from before.
    pub fn with_vertices(self, at_vertex: Vec<f64>) -> Self {
        Sizes { at_vertex, ..self }
    }

    /// The bytes of its large arrays.
    pub fn bytes(&self) -> usize {
        let Sizes { at_vertex, near, field, .. } = self;
        memory::bytes(at_vertex) + memory::bytes(near) + memory::bytes(&field.sizes) + field.t.bytes()
    }

    /// Whether nothing is asked for.
    pub fn is_empty(&self) -> bool {
        let Sizing { uniform, regions, vertices, callback } = self.sizing;
        let lists = [&[uniform], regions, vertices, &self.volumes];
        callback.is_none() && lists.into_iter().all(ask_for_nothing)
    }

    /// Gives a new vertex its size. `neighbour` is one to look for its place from.
    pub fn add_vertex(&mut self, t: &Triangulation, vertex: u32, neighbour: Option<u32>) {
        if self.at_vertex.is_empty() {
            return;
        }
        let v = vertex as usize;
        if self.at_vertex.len() <= v {
            self.at_vertex.resize(v + 1, f64::INFINITY);
            self.near.resize(v + 1, GHOST);
        }
        let near = neighbour.and_then(|w| self.near.get(w as usize).copied()).unwrap_or(GHOST);
        (self.at_vertex[v], self.near[v]) = self.field.at(t.at(vertex), near);
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
                let of = |v: u32| self.at_vertex.get(v as usize).copied().unwrap_or(f64::INFINITY);
                size = size.min(mean(t.topology.tet(tet).v.into_iter().map(|v| (1.0, of(v)))));
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
