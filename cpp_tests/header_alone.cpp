// The C++ header needs nothing before it, and may come twice.
#include "wellspaced/wellspaced.hpp"
#include "wellspaced/wellspaced.hpp"

int header_alone();
int header_alone() { return WSP_DONE; }
