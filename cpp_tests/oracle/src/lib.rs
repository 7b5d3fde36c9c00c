//! CGAL's answers for wellspaced's Rust tests: its Delaunay triangulation and its exact arithmetic.
//!
//! A test-only member of the workspace. CGAL is GPL and never reaches the library; the C++ side is shared
//! with the C++ cross-checks in `cpp_tests/cgal`.

/// A point as CGAL is given it.
pub type Point = [f64; 3];
/// What CGAL refused, and why.
pub type Error = cxx::Exception;
/// CGAL's answer or its exception.
pub type Result<T> = std::result::Result<T, Error>;

#[cxx::bridge(namespace = "oracle")]
mod ffi {
    struct Answer {
        dimension: i32,
        vertices: usize,
        tetrahedra: Vec<u32>,
        hull: Vec<u32>,
        chain: Vec<u32>,
    }

    unsafe extern "C++" {
        include!("bridge.hpp");
        fn delaunay(xyz: &[f64]) -> Result<Answer>;
        fn orientation(xyz: &[f64]) -> Result<i32>;
        fn side_of_oriented_sphere(xyz: &[f64]) -> Result<i32>;
        fn side_of_smallest_sphere(xyz: &[f64]) -> Result<i32>;
        fn side_of_diametral_sphere(xyz: &[f64]) -> Result<i32>;
        fn over_bound(xyz: &[f64], beta: f64) -> Result<bool>;
        fn compare_volumes(xyz_a: &[f64], a: &[u32], xyz_b: &[f64], b: &[u32]) -> Result<i32>;
    }
}

/// CGAL's triangulation. Vertices are positions in the list of points; of equal points the first stands for all.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Delaunay {
    /// −1 (no points) to 3.
    pub dimension: i32,
    /// How many of the points are distinct.
    pub vertices: usize,
    /// The finite cells, positively oriented; empty below dimension 3.
    pub tetrahedra: Vec<[u32; 4]>,
    /// The facets of the hull in dimension 3, all triangles in dimension 2.
    pub hull: Vec<[u32; 3]>,
    /// The edges in dimension 1.
    pub chain: Vec<[u32; 2]>,
}

fn grouped<const N: usize>(flat: &[u32]) -> Vec<[u32; N]> {
    flat.chunks_exact(N).map(|c| c.try_into().expect("chunks have N entries")).collect()
}

/// `CGAL::Delaunay_triangulation_3` of the points.
pub fn delaunay(points: &[Point]) -> Result<Delaunay> {
    let answer = ffi::delaunay(points.as_flattened())?;
    Ok(Delaunay {
        dimension: answer.dimension,
        vertices: answer.vertices,
        tetrahedra: grouped(&answer.tetrahedra),
        hull: grouped(&answer.hull),
        chain: grouped(&answer.chain),
    })
}

/// Exact sign of det[b−a, c−a, d−a].
pub fn orientation(abcd: [Point; 4]) -> Result<i32> {
    ffi::orientation(abcd.as_flattened())
}

/// Exact: +1 if `e` is inside the sphere through the positively oriented `abcd`, 0 on it, −1 outside; the signs
/// change places when `abcd` is negatively oriented.
pub fn side_of_oriented_sphere(abcde: [Point; 5]) -> Result<i32> {
    ffi::side_of_oriented_sphere(abcde.as_flattened())
}

/// Exact: +1 if the fourth point is inside the smallest sphere through the first three, 0 on it, −1 outside.
pub fn side_of_smallest_sphere(abce: [Point; 4]) -> Result<i32> {
    ffi::side_of_smallest_sphere(abce.as_flattened())
}

/// Exact: +1 if the third point is inside the sphere with the first two as its poles, 0 on it, −1 outside.
pub fn side_of_diametral_sphere(abe: [Point; 3]) -> Result<i32> {
    ffi::side_of_diametral_sphere(abe.as_flattened())
}

/// Exact: whether the circumradius is more than `beta` times the shortest edge. Flat ones are over every bound.
pub fn over_bound(abcd: [Point; 4], beta: f64) -> Result<bool> {
    ffi::over_bound(abcd.as_flattened(), beta)
}

/// Exact sign of (sum of the first list's signed volumes) − (sum of the second's).
pub fn compare_volumes(
    points_a: &[Point],
    tetrahedra_a: &[[u32; 4]],
    points_b: &[Point],
    tetrahedra_b: &[[u32; 4]],
) -> Result<i32> {
    ffi::compare_volumes(
        points_a.as_flattened(),
        tetrahedra_a.as_flattened(),
        points_b.as_flattened(),
        tetrahedra_b.as_flattened(),
    )
}
