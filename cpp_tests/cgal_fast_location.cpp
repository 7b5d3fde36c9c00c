// What must not compile: wellspaced/cgal.hpp would leave the hierarchy of a Fast_location without the new points. With ALLOWED the same
// program has CGAL's default and compiles.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <wellspaced/cgal.hpp>

int main() {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
#ifdef ALLOWED
    CGAL::Delaunay_triangulation_3<Kernel> dt;
#else
    CGAL::Delaunay_triangulation_3<Kernel, CGAL::Fast_location> dt;
#endif
    return wellspaced::cgal::refine(dt).status;
}
