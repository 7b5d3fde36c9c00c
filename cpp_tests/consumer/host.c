/* Two consumers in one process: loads two plugins, uses both by turns, unloads one and uses the other. */
#include <dlfcn.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

typedef size_t guest(double);

static guest *load(const char *path, void **handle) {
    guest *function = NULL;
    void *symbol;
    *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    symbol = *handle ? dlsym(*handle, "guest_refine") : NULL;
    memcpy(&function, &symbol, sizeof function);
    if (!function) fprintf(stderr, "%s: %s\n", path, dlerror());
    return function;
}

int main(int argc, char **argv) {
    void *handles[2];
    guest *one, *two;
    size_t counts[4];

    if (argc != 3) return 2;
    one = load(argv[1], &handles[0]);
    two = load(argv[2], &handles[1]);
    if (!one || !two) return 1;
    counts[0] = one(2.0);
    counts[1] = two(2.0);
    counts[2] = one(4.0);
    dlclose(handles[0]);
    counts[3] = two(4.0);
    printf("%lu %lu tetrahedra\n", (unsigned long)counts[0], (unsigned long)counts[2]);
    return !(counts[0] > 20 && counts[0] == counts[1] && counts[2] > 5 && counts[2] == counts[3]);
}
