/* The header needs nothing before it, and may come twice. */
#include "wellspaced.h"
#include "wellspaced.h"

int header_alone(void);
int header_alone(void) { return WSP_DONE; }
