//! CGAL oracle
