// The header over CGAL needs nothing before it, and may come twice.
#include "wellspaced/cgal.hpp"
#include "wellspaced/cgal.hpp"

int header_alone();
int header_alone() { return WSP_DONE; }
