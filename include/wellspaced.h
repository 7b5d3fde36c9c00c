/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/**
 * @file wellspaced.h
 * wellspaced: sparse well-spaced Delaunay refinement.
 *
 * Points or a piecewise linear domain in, a Delaunay mesh of quality tetrahedra with few elements out. The method is
 * that of R. Jampani and A. Uengoer, "Construction of Sparse Well-spaced Point Sets for Quality Tetrahedralizations",
 * 16th International Meshing Roundtable, 2007. This header is the manual; wellspaced/wellspaced.hpp is a C++17
 * face over it.
 *
 * Example
 * -------
 *
 *     double xyz[300];                                      // 100 points of yours in the box
 *     const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
 *     wsp_plc *plc = NULL;
 *     wsp_triangulation *mesh = NULL;
 *     wsp_refine_options options;
 *     wsp_mesh_view view;
 *
 *     wsp_plc_new(&plc);
 *     wsp_plc_add_box(plc, low, high, 1, NULL);             // 8 points, 6 facets
 *     wsp_plc_add_points(plc, xyz, 100, NULL, NULL);
 *     if (wsp_triangulation_from_plc(plc, NULL, NULL, &mesh) < 0)
 *         fprintf(stderr, "%s\n", wsp_last_error());
 *     wsp_refine_options_init(&options, sizeof options);
 *     options.radius_edge = 2.0;
 *     if (wsp_refine(mesh, &options, NULL, NULL) < 0)
 *         fprintf(stderr, "%s\n", wsp_last_error());
 *     wsp_mesh_view_init(&view, sizeof view);
 *     wsp_triangulation_view(mesh, &view);                  // points and tetrahedra, in place
 *     wsp_triangulation_free(mesh);
 *     wsp_plc_free(plc);
 *
 * Three ways in
 * -------------
 * - One call: wsp_triangulation_from_plc or wsp_triangulation_insert, then wsp_refine.
 * - Step by step: wsp_bad_short_edges, wsp_steiner_batch of one, wsp_triangulation_insert_batch, until there are none.
 * - Your own triangulation: wsp_is_bad_edge and wsp_sample_edge need only an edge and the vertices around it,
 *   wsp_sample_mesh takes arrays of points and tetrahedra and answers with points that may all be inserted at once;
 *   wellspaced/cgal.hpp does it for CGAL.
 *
 * Conventions
 * -----------
 * - Status. Functions return a wsp_status: 0 done, above 0 usable but not complete, below 0 an error. After an error
 *   nothing has been changed (two functions say otherwise of two errors), and wsp_last_error says why, with the
 *   offending point or element. Beside the errors listed below, every function may return WSP_ERR_INTERNAL.
 * - Ownership. What a _new, _from_ or _batch function gives out is the caller's, to be freed by the _free of its type;
 *   _free(NULL) does nothing. Nothing else is ever freed across the boundary. Arrays that are passed in are only
 *   read during the call, and may overlap those that the call fills; those that it fills must not overlap
 *   one another.
 * - NULL. Pointers must not be NULL unless the function says so: WSP_ERR_NULL otherwise. An array of no elements may
 *   be NULL.
 * - Structs that begin with struct_size are filled by their _init(&s, sizeof s) before use. Later versions append
 *   fields; programs compiled with an older header keep working. An unknown size or value is an error.
 * - Lists are two-call: ask for the count with capacity 0, then pass a buffer. A buffer that is too small is filled
 *   and the status is WSP_INCOMPLETE.
 * - Views (wsp_triangulation_view, wsp_batch_points) point into the handle and are valid until the next call that
 *   changes or frees it.
 * - Threads. Distinct handles may be used from distinct threads at once, and calls that take the handle as const on one
 *   handle too. A call that changes a handle excludes all others on it: lock, or get WSP_ERR_BUSY. The exception
 *   are the _free functions, which must be the last on a handle.
 * - Callbacks run on the thread that made the call. They must return: no exception or longjmp may leave them.
 * - Faults. A panic within the library is caught: WSP_ERR_INTERNAL, and that handle answers nothing but its _free
 *   from then on.
 * - Units. Coordinates and lengths are in the caller's units, angles in radians unless the name says degrees. Points
 *   are three doubles x y z. Finite coordinates of magnitude 0 or 2^-142 to 2^201 are accepted.
 * - Floating point. Every function works in round-to-nearest without flushing of denormals, whatever mode the caller
 *   is in, and restores that mode and its flags on return (x86-64 and aarch64; on other processors call in
 *   round-to-nearest).
 * - Determinism. The same calls give the same results, on any thread.
 */


#ifndef WELLSPACED_H
#define WELLSPACED_H

/* Made by cbindgen from src/capi. Do not edit: change the comments there and run script/header. */

#include <stddef.h>
#include <stdint.h>

/**
 * Done.
 */
#define WSP_DONE 0

/**
 * The control was cancelled. Handles are valid and usable; what had been reached is said by the function.
 */
#define WSP_CANCELLED 1

/**
 * The vertex limit was reached. The mesh is valid, but some tetrahedra may exceed the bound.
 */
#define WSP_VERTEX_LIMIT 2

/**
 * Some tetrahedra are left that exceed the bound: because of small input angles or a boundary that is kept, because mending them needs an edge
 * below the minimum length, or because rounding leaves no place. wsp_report counts them by reason. Or all keep the bound (`bad` is 0), but some are
 * larger than was asked for and could not be made smaller for such a reason: `too_large` counts them. The mesh is valid.
 */
#define WSP_UNREFINED 3

/**
 * The list has more elements than the buffer has room for. The buffer is full, the count is that of all.
 */
#define WSP_INCOMPLETE 4

/**
 * The seconds were over. The mesh is valid, but some tetrahedra may exceed the bound.
 */
#define WSP_TIME_LIMIT 5

/**
 * More memory would have been needed than allowed. The mesh is valid, but some tetrahedra may exceed the bound.
 */
#define WSP_MEMORY_LIMIT 6

/**
 * A fault of the library, caught. The handle that was being used answers nothing but its `_free` from now on.
 */
#define WSP_ERR_INTERNAL -1

/**
 * A pointer is NULL that must not be.
 */
#define WSP_ERR_NULL -2

/**
 * `struct_size` is none that this library knows: the `_init` was not called, or the header is newer.
 */
#define WSP_ERR_STRUCT_SIZE -3

/**
 * A field of an option struct has a value that it can't have.
 */
#define WSP_ERR_OPTION -4

/**
 * An argument has a value that it can't have, or a pointer is not aligned for its type.
 */
#define WSP_ERR_ARGUMENT -5

/**
 * A coordinate is NaN or infinite.
 */
#define WSP_ERR_NOT_FINITE -6

/**
 * A coordinate other than 0 is smaller than 2^-142 or larger than 2^201 in magnitude.
 */
#define WSP_ERR_OUT_OF_RANGE -7

/**
 * More elements than 32-bit ids can name or memory can hold.
 */
#define WSP_ERR_TOO_MANY -8

/**
 * There is no vertex of this id.
 */
#define WSP_ERR_NO_SUCH_VERTEX -9

/**
 * The two vertices are not joined by an edge.
 */
#define WSP_ERR_NO_SUCH_EDGE -10

/**
 * The domain can't be used; the text names the element.
 */
#define WSP_ERR_INVALID_DOMAIN -11

/**
 * The call needs a domain and there is none, or there is one already.
 */
#define WSP_ERR_DOMAIN -12

/**
 * Memory could not be had.
 */
#define WSP_ERR_MEMORY -13

/**
 * Another call is using the handle: on another thread, or the one whose callback this is.
 */
#define WSP_ERR_BUSY -14

/**
 * The batch is not of the triangulation's present state.
 */
#define WSP_ERR_STALE -15

/**
 * `wsp_triangulation_validate` has found the triangulation wanting, or a host's arrays are no Delaunay mesh; the text says where.
 */
#define WSP_ERR_NOT_VALID -16

/**
 * No vertex, no tetrahedron: the id that is never given out.
 */
#define WSP_NONE UINT32_MAX

/**
 * The library version that this header belongs to.
 */
#define WSP_VERSION_MAJOR 0

/**
 * See WSP_VERSION_MAJOR.
 */
#define WSP_VERSION_MINOR 1

/**
 * See WSP_VERSION_MAJOR.
 */
#define WSP_VERSION_PATCH 0

/**
 * The version of the binary interface, also the number in the library's SONAME: libraries of one number serve
 * programs compiled with any older header of the same number.
 */
#define WSP_ABI_VERSION 0

/**
 * Batches of off-centres around the core disk of a bad short edge: section 4 of Jampani and Üngör, 2007.
 */
#define WSP_RULE_PAPER 1

/**
 * One circumcentre at a time: the classical method, for comparison.
 */
#define WSP_RULE_CIRCUMCENTER 2

/**
 * As WSP_RULE_PAPER with fewer and wider pieces: the sparsest result. Unless its WSP_SPARSIFY level is OFF, segments and facets are not split because
 * a vertex encroaches upon them (lies in the smallest ball around a piece), but when a Steiner point is due that does so, too, or would take the piece
 * out of the mesh. Thin parts need far fewer vertices so. It is not so in
 * steps, nor where sizes are limited.
 */
#define WSP_RULE_SPARSE 3

/**
 * WSP_SPARSIFY_QUICK with WSP_RULE_SPARSE, WSP_SPARSIFY_OFF with the other rules.
 */
#define WSP_SPARSIFY_DEFAULT 0

/**
 * The sampler alone: Steiner points stay where they are put.
 */
#define WSP_SPARSIFY_OFF 1

/**
 * Steiner points are taken away where that is found out at little cost.
 */
#define WSP_SPARSIFY_QUICK 2

/**
 * More is tried: three to five times the time, for about an eighth fewer Steiner points.
 */
#define WSP_SPARSIFY_THOROUGH 3

/**
 * Nothing is taken away from what stands; but instead of inserting a sample one of two Steiner points near it is moved where
 * one place serves both, if that is found at next to no cost; and a point that splits
 * a segment or facet is made one with a neighbour.
 */
#define WSP_SPARSIFY_MOVES 4

/**
 * A line for information: what a call is doing, some lines a call.
 */
#define WSP_LOG_INFO 1

/**
 * A warning: a call has ended at a limit, or with something that can't be mended.
 */
#define WSP_LOG_WARNING 2

/**
 * The complex as a whole.
 */
#define WSP_ELEMENT_DOMAIN 0

/**
 * A point.
 */
#define WSP_ELEMENT_POINT 1

/**
 * A segment of the list of segments.
 */
#define WSP_ELEMENT_SEGMENT 2

/**
 * A facet.
 */
#define WSP_ELEMENT_FACET 3

/**
 * A seed of a hole.
 */
#define WSP_ELEMENT_HOLE 4

/**
 * A seed of a region.
 */
#define WSP_ELEMENT_REGION 5

/**
 * A coordinate of a point or seed is NaN or infinite.
 */
#define WSP_DEFECT_NOT_FINITE 1

/**
 * A coordinate other than 0 is smaller than 2^-142 or larger than 2^201 in magnitude.
 */
#define WSP_DEFECT_OUT_OF_RANGE 2

/**
 * A segment or facet names a point that does not exist; the measure is its position.
 */
#define WSP_DEFECT_NO_SUCH_POINT 3

/**
 * A facet has no polygon, or a polygon no point.
 */
#define WSP_DEFECT_EMPTY 4

/**
 * There are more regions than can be told apart; the measure is how many can.
 */
#define WSP_DEFECT_TOO_MANY_REGIONS 5

/**
 * A segment's ends are at one place.
 */
#define WSP_DEFECT_NO_LENGTH 6

/**
 * A facet's points lie on a line.
 */
#define WSP_DEFECT_NO_AREA 7

/**
 * A facet's points don't lie in a plane; the measure is how far the worst is off.
 */
#define WSP_DEFECT_NOT_PLANAR 8

/**
 * Sides of one facet cross, or two corners lie upon each other in its plane.
 */
#define WSP_DEFECT_CROSSING_SIDES 9

/**
 * Two segments or sides cross.
 */
#define WSP_DEFECT_SEGMENTS_CROSS 10

/**
 * A segment, or the side of a facet, goes through a facet.
 */
#define WSP_DEFECT_SEGMENT_THROUGH_FACET 11

/**
 * Two facets have the same corners.
 */
#define WSP_DEFECT_DUPLICATE_FACET 12

/**
 * Two facets in one plane overlap.
 */
#define WSP_DEFECT_FACETS_OVERLAP 13

/**
 * Two points are at one place; they become one vertex.
 */
#define WSP_DEFECT_DUPLICATE_POINT 1001

/**
 * Two segments are the same.
 */
#define WSP_DEFECT_DUPLICATE_SEGMENT 1002

/**
 * A point lies on a segment or side, which is cut there.
 */
#define WSP_DEFECT_POINT_ON_SEGMENT 1003

/**
 * A point lies in a facet, of which it becomes a vertex.
 */
#define WSP_DEFECT_POINT_ON_FACET 1004

/**
 * An edge has one facet at it: the surface is open there.
 */
#define WSP_DEFECT_OPEN_EDGE 1005

/**
 * An edge has more than two facets at it; the measure is how many.
 */
#define WSP_DEFECT_NON_MANIFOLD_EDGE 1006

/**
 * A point is at a vertex: `vertices[0]`.
 */
#define WSP_AT_VERTEX 0

/**
 * A point is inside an edge: `vertices[0..2]`.
 */
#define WSP_IN_EDGE 1

/**
 * A point is inside a triangle: `vertices[0..3]`.
 */
#define WSP_IN_FACE 2

/**
 * A point is inside a tetrahedron: `vertices[0..4]`.
 */
#define WSP_IN_TETRAHEDRON 3

/**
 * A point is outside the convex hull, or the triangulation has no tetrahedra and no vertex there.
 */
#define WSP_OUTSIDE 4

/**
 * Every tetrahedron's neighbours know it, every vertex has a tetrahedron, the surface is closed.
 */
#define WSP_VALIDATE_TOPOLOGY 1

/**
 * And every tetrahedron is positively oriented.
 */
#define WSP_VALIDATE_ORIENTATION 2

/**
 * And the triangulation is Delaunay, by exact arithmetic, and all subsegments and subfacets are in it, facets consist of
 * theirs, and regions meet at them only.
 */
#define WSP_VALIDATE_DELAUNAY 3

/**
 * And no tetrahedron of the domain exceeds the bound on the radius-edge ratio, by exact arithmetic.
 */
#define WSP_VALIDATE_QUALITY 4

/**
 * The vertex lies on no segment and no facet.
 */
#define WSP_ON_NOTHING 0

/**
 * The vertex is one of the input on the boundary: an end of a segment, a corner of a facet, or a point of the input that lies in one.
 */
#define WSP_ON_VERTEX 1

/**
 * The vertex lies inside a segment.
 */
#define WSP_ON_SEGMENT 2

/**
 * The vertex lies inside a facet.
 */
#define WSP_ON_FACET 3

/**
 * The point is a sample of the rule, in the interior.
 */
#define WSP_ORIGIN_SAMPLE 0

/**
 * The point splits the boundary's subsegment `vertices[0..2]`.
 */
#define WSP_ORIGIN_SEGMENT 1

/**
 * The point splits the boundary's subfacet `vertices[0..3]`.
 */
#define WSP_ORIGIN_SUBFACET 2

/**
 * The Steiner points of one step. It never changes, so any thread may read it at any time.
 */
typedef struct wsp_batch wsp_batch;

/**
 * What wsp_plc_check has found. It never changes, so any thread may read it at any time.
 */
typedef struct wsp_check wsp_check;

/**
 * A handle through which long calls are followed and cancelled.
 *
 * Give it to as many calls as you like, one after the other or at once. Everything but its `_free` may be called
 * from any thread at any time.
 */
typedef struct wsp_control wsp_control;

/**
 * The Steiner points of one round on a host's arrays. It never changes, so any thread may read it at any time.
 */
typedef struct wsp_mesh_batch wsp_mesh_batch;

/**
 * A piecewise linear complex: points, segments, polygonal facets, seeds of holes and of regions.
 *
 * Points are named by their position in it, from 0 in the order in which they were added. Facets are planar sets of
 * polygons. Adding only checks what can be checked at once; wsp_triangulation_from_plc judges the whole.
 *
 * Coordinates on a slanted plane are rounded, so a facet need not be exactly planar: its points may lie off its plane by 1e-5 of the diagonal of the bounding
 * box of all points, but by no more than 1e-4 of the facet's size. Its points are kept where they are; new ones lie near its plane, so that
 * refinement may change the volume by as little. Triangles are always planar.
 */
typedef struct wsp_plc wsp_plc;

/**
 * A Delaunay triangulation of points of any dimension, and the domain that it fills once one is set.
 */
typedef struct wsp_triangulation wsp_triangulation;

/**
 * What a call came to: 0 done; above 0 usable but not complete; below 0 an error, and nothing was changed.
 * Numbers are never reused. A later version may return new ones: test the sign first.
 */
typedef int32_t wsp_status;

/**
 * Options of a triangulation. Fill it with wsp_triangulation_options_init, or pass NULL for the defaults.
 */
typedef struct wsp_triangulation_options {
    /**
     * Set by the `_init`.
     */
    uint32_t struct_size;
    /**
     * Must be 0.
     */
    uint32_t flags;
    /**
     * How many threads an insertion of many points, and the pass over Steiner points after a refinement or in wsp_sparsify_mesh,
     * may use, the caller's among them: 0 for as many as there are processors, else up to 1024. Default: 1. The result
     * is the same in every byte. Callbacks run on the caller's thread only.
     */
    uint32_t threads;
    /**
     * 1 splits no segment or facet to recover it: wsp_triangulation_from_plc refuses a domain of which one is missing from the
     * Delaunay triangulation of its points, and names it (WSP_ERR_INVALID_DOMAIN). Default: 0.
     */
    uint32_t keep_boundary;
} wsp_triangulation_options;

/**
 * How Steiner points are chosen: one of the WSP_RULE_ constants.
 */
typedef uint32_t wsp_rule;

/**
 * What the sampler aims at. Fill it with wsp_sampler_options_init, or pass NULL for the defaults.
 */
typedef struct wsp_sampler_options {
    /**
     * Set by the `_init`.
     */
    uint32_t struct_size;
    /**
     * How Steiner points are chosen. Default: WSP_RULE_SPARSE.
     */
    wsp_rule rule;
    /**
     * The bound on a tetrahedron's circumradius over its shortest edge, 0.62 to 1e6 (a regular one has 0.612).
     * Default: 2.
     */
    double radius_edge;
    /**
     * For wsp_sample_mesh, the only call that looks at this and what follows: 1 puts no points on the boundary, that is on faces with one
     * tetrahedron and on the view's `faces`, and leaves out the samples that would encroach upon it. What could only be mended so is left
     * and counted. Default: 0.
     */
    uint32_t keep_boundary;
    /**
     * Must be 0.
     */
    uint32_t reserved;
    /**
     * For wsp_sample_mesh: no point comes nearer than this to a vertex, in the units of the coordinates; what could only be mended so is left and
     * counted. With it no loop can go on for ever. 0, the default, takes 2^-40 of the diagonal of the points' bounding box, but
     * no less than 2^-46 of the largest coordinate; so does anything below.
     */
    double min_edge;
} wsp_sampler_options;

/**
 * How hard to try to do with fewer Steiner points: one of the WSP_SPARSIFY_ constants.
 */
typedef uint32_t wsp_sparsify;

/**
 * What a refinement shall reach and when it shall stop. Fill it with wsp_refine_options_init, or pass NULL for
 * the defaults.
 */
typedef struct wsp_refine_options {
    /**
     * Set by the `_init`.
     */
    uint32_t struct_size;
    /**
     * How Steiner points are chosen. Default: WSP_RULE_SPARSE.
     */
    wsp_rule rule;
    /**
     * The bound on a tetrahedron's circumradius over its shortest edge, 0.62 to 1e6 (a regular one has 0.612).
     * Default: 2. From 2 on refinement is sure to end by itself, and it usually does so well below; below about 1.1 it
     * goes on until a limit ends it.
     */
    double radius_edge;
    /**
     * No Steiner point is added nearer than this to a vertex, in the units of the coordinates. 0, the default,
     * takes 2^-40 of the diagonal of the points' bounding box, but no less than 2^-46 of the largest coordinate.
     */
    double min_edge;
    /**
     * No vertex is added beyond this many, input included, but for the few that may be needed to keep segments and facets whole where their
     * points can't stand exactly on them (WSP_VERTEX_LIMIT). Default: 100 million.
     */
    size_t max_vertices;
    /**
     * How hard to try to do with fewer Steiner points, one of the WSP_SPARSIFY_ constants. Default: WSP_SPARSIFY_DEFAULT.
     */
    wsp_sparsify sparsify;
    /**
     * Must be 0.
     */
    uint32_t reserved;
    /**
     * The largest length of an edge of a tetrahedron. 0, the default, asks for nothing. See wsp_refine_sized for more.
     */
    double max_edge;
    /**
     * 1 puts no Steiner points on segments and facets; what could only be mended so is left and counted. What the domain's recovery has put there when
     * it was made remains: wsp_triangulation_options has a `keep_boundary` too. Default: 0.
     */
    uint32_t keep_boundary;
    /**
     * Must be 0.
     */
    uint32_t reserved2;
    /**
     * The refinement stops after so many seconds (WSP_TIME_LIMIT). 0, the default: no limit.
     */
    double max_seconds;
    /**
     * The refinement stops before its large arrays and those of the mesh take more than so many bytes (WSP_MEMORY_LIMIT); those of views,
     * small lists, and copies made for the time of a large change are not counted. 0, the default: no limit.
     */
    size_t max_memory;
} wsp_refine_options;

/**
 * How far a call has come. Valid during the callback only; fields may be appended in later versions.
 */
typedef struct wsp_progress {
    /**
     * The size of the struct that the library fills.
     */
    uint32_t struct_size;
    /**
     * 0.
     */
    uint32_t flags;
    /**
     * What is being done now: "delaunay", "boundary", "refine", "sparsify", "validate", "view".
     */
    const char *stage;
    /**
     * From 0 to 1 within the stage. An estimate: refinement can't know its end.
     */
    double fraction;
    /**
     * Vertices of the triangulation now.
     */
    size_t vertices;
} wsp_progress;

/**
 * Told now and then how far a call has come; returns 0 to go on and anything else to cancel.
 *
 * It runs on the thread that made the call, in the floating-point mode in which that thread called. It must
 * return: no exception and no longjmp may leave it (the C++ face sees to that). It must not use the handle of the
 * call that it runs in (WSP_ERR_BUSY); others are free.
 */
typedef int32_t (*wsp_progress_callback)(void *user, const struct wsp_progress *progress);

/**
 * Told what calls do, line by line: `level` is a WSP_LOG_ constant (later versions may have more), `text` is UTF-8 without a line's end, valid
 * during the callback only. It runs as a wsp_progress_callback does, and the same is forbidden to it.
 */
typedef void (*wsp_log_callback)(void *user, uint32_t level, const char *text);

/**
 * A kind of defect: one of the WSP_DEFECT_ constants. From WSP_DEFECT_DUPLICATE_POINT on they are warnings: the
 * complex can be meshed. The others are errors.
 */
typedef uint32_t wsp_defect_kind;

/**
 * A kind of element of a complex: one of the WSP_ELEMENT_ constants.
 */
typedef uint32_t wsp_element_kind;

/**
 * An element of a complex by its position in its list.
 */
typedef struct wsp_element {
    /**
     * A WSP_ELEMENT_ constant.
     */
    wsp_element_kind kind;
    /**
     * The position; 0 for the domain.
     */
    uint32_t index;
} wsp_element;

/**
 * A defect of a complex, or an angle of it. Fill it with wsp_defect_init before it is given to wsp_check_defect or
 * wsp_check_angle.
 */
typedef struct wsp_defect {
    /**
     * Set by the `_init`.
     */
    uint32_t struct_size;
    /**
     * A WSP_DEFECT_ constant; 0 for an angle.
     */
    wsp_defect_kind kind;
    /**
     * 1 for an error, 0 for a warning and for an angle.
     */
    uint32_t is_error;
    /**
     * How many of `elements` count: one or two.
     */
    uint32_t element_count;
    /**
     * The elements concerned. A facet's side that is no segment of the list is named by the facet.
     */
    struct wsp_element elements[2];
    /**
     * A point where it is wrong; NaN where that means nothing.
     */
    double place[3];
    /**
     * A number that goes with the kind, else 0; of an angle its degrees.
     */
    double measure;
} wsp_defect;

/**
 * Where a point is.
 */
typedef struct wsp_location {
    /**
     * WSP_AT_VERTEX, WSP_IN_EDGE, WSP_IN_FACE, WSP_IN_TETRAHEDRON or WSP_OUTSIDE.
     */
    uint32_t kind;
    /**
     * The vertices of what the point is in; WSP_NONE for the rest.
     */
    uint32_t vertices[4];
} wsp_location;

/**
 * The arrays of a mesh. Fill it with wsp_mesh_view_init before it is given to a function.
 *
 * Vertices are numbered by id, tetrahedra by their place in the array. An array without elements may be NULL.
 */
typedef struct wsp_mesh_view {
    /**
     * Set by the `_init`.
     */
    uint32_t struct_size;
    /**
     * 0.
     */
    uint32_t flags;
    /**
     * Three coordinates a vertex id, `3 * points_count` doubles. Ids without a vertex hold NaN.
     */
    const double *points;
    /**
     * Vertex ids run from 0 to one below this.
     */
    size_t points_count;
    /**
     * Four vertex ids a tetrahedron a b c d, positively oriented: det[b-a, c-a, d-a] > 0.
     */
    const uint32_t *tetrahedra;
    /**
     * The number of tetrahedra: those of the domain, or without a domain those of the hull.
     */
    size_t tetrahedra_count;
    /**
     * Four tetrahedra a tetrahedron: the one across the face opposite each vertex, WSP_NONE where there is none.
     */
    const uint32_t *neighbours;
    /**
     * The region of each tetrahedron: 1 + the position of the wsp_plc_add_region that labels it, 0 for none.
     */
    const uint32_t *regions;
    /**
     * For wsp_sample_mesh, three vertex ids a face: inner faces that bound a part of the domain, and any face of its boundary that
     * is to have a number. wsp_triangulation_view gives none.
     */
    const uint32_t *faces;
    /**
     * The number of `faces`.
     */
    size_t faces_count;
    /**
     * The number of each face's facet, for all of `faces` or NULL.
     */
    const uint32_t *facets;
} wsp_mesh_view;

/**
 * The arrays of a domain's boundary. Fill it with wsp_boundary_view_init before it is given to a function.
 *
 * Vertices are numbered by id, tetrahedra as in wsp_mesh_view. An array without elements may be NULL.
 */
typedef struct wsp_boundary_view {
    /**
     * Set by the `_init`.
     */
    uint32_t struct_size;
    /**
     * 0.
     */
    uint32_t flags;
    /**
     * Three vertex ids a face, in the order of facets; counterclockwise seen from outside the first of its tetrahedra.
     */
    const uint32_t *faces;
    /**
     * The number of faces.
     */
    size_t faces_count;
    /**
     * The facet of each face: its number as wsp_plc_add_facets gave it, or a number of its own where the hull is the domain.
     */
    const uint32_t *face_facets;
    /**
     * The marker of each face's facet.
     */
    const int32_t *face_markers;
    /**
     * Two tetrahedra a face, those on its sides: WSP_NONE for none. If there is but one, it is the first; of two it is the lower.
     */
    const uint32_t *face_tetrahedra;
    /**
     * Two vertex ids an edge, in the order of segments.
     */
    const uint32_t *edges;
    /**
     * The number of edges.
     */
    size_t edges_count;
    /**
     * A number of each edge's segment: all edges of one have it, and no others. Facets' sides are segments too.
     */
    const uint32_t *edge_segments;
    /**
     * The marker of each edge's segment: that of wsp_plc_add_segments, or for a facet's side that is no segment the marker of its first facet.
     */
    const int32_t *edge_markers;
    /**
     * For each vertex id WSP_ON_NOTHING, WSP_ON_VERTEX, WSP_ON_SEGMENT or WSP_ON_FACET.
     */
    const uint8_t *vertex_kinds;
    /**
     * For each vertex id the segment or facet that it lies inside of, by the numbers of `edge_segments` and `face_facets`; else WSP_NONE.
     */
    const uint32_t *vertex_elements;
    /**
     * Vertex ids run from 0 to one below this.
     */
    size_t vertices_count;
} wsp_boundary_view;

/**
 * An edge: the ids of its two vertices, in any order where one is asked for, the lower first where one is given.
 */
typedef struct wsp_edge {
    /**
     * The ends.
     */
    uint32_t vertices[2];
} wsp_edge;

/**
 * Where a Steiner point comes from.
 */
typedef struct wsp_origin {
    /**
     * WSP_ORIGIN_SAMPLE, WSP_ORIGIN_SEGMENT or WSP_ORIGIN_SUBFACET.
     */
    uint32_t kind;
    /**
     * The vertices of what the point splits; WSP_NONE for the rest.
     */
    uint32_t vertices[3];
} wsp_origin;

/**
 * What a refinement did, and the mesh's quality now. After WSP_CANCELLED the tetrahedra have not been looked at, for that takes a while:
 * `tetrahedra`, `bad`, `on_segments` and `on_facets` are 0 then, and the ratio and the angle NaN. Fill it with wsp_report_init before it is given
 * to wsp_refine.
 */
typedef struct wsp_report {
    /**
     * Set by the `_init`.
     */
    uint32_t struct_size;
    /**
     * What wsp_refine returned.
     */
    wsp_status status;
    /**
     * Vertices that are no Steiner points.
     */
    size_t input_vertices;
    /**
     * Vertices now.
     */
    size_t vertices;
    /**
     * Tetrahedra of the domain now.
     */
    size_t tetrahedra;
    /**
     * Vertices that are Steiner points: those of earlier calls and of the domain's recovery too.
     */
    size_t steiner;
    /**
     * Vertices that this call has added by the sampling rule.
     */
    size_t samples;
    /**
     * Vertices that this call has added to split segments.
     */
    size_t segment_splits;
    /**
     * Vertices that this call has added to split subfacets.
     */
    size_t facet_splits;
    /**
     * Tetrahedra of the domain that exceed the bound; 0 after WSP_DONE.
     */
    size_t bad;
    /**
     * The largest circumradius over shortest edge in the domain; 0 without tetrahedra.
     */
    double worst_radius_edge;
    /**
     * The smallest dihedral angle in the domain, in degrees; 180 without tetrahedra.
     */
    double min_dihedral_degrees;
    /**
     * Steiner points that this call has taken away again without putting another in their place.
     */
    size_t removed;
    /**
     * Steiner points that this call has put in the place of two each.
     */
    size_t replaced;
    /**
     * Of the bad tetrahedra, those whose shortest edge spans an input angle of less than 60 degrees.
     */
    size_t unrefined_small_angle;
    /**
     * Those whose Steiner points would encroach upon segments or facets that can't be split: at small input angles, or
     * because of `keep_boundary`.
     */
    size_t unrefined_boundary;
    /**
     * Those that would need an edge below the minimum length.
     */
    size_t unrefined_min_edge;
    /**
     * Those that a limit of vertices, seconds or memory came before.
     */
    size_t unrefined_limit;
    /**
     * Those for which rounding left no place.
     */
    size_t unrefined_rounding;
    /**
     * Tetrahedra, bad or not, that are larger than was asked for. With WSP_UNREFINED these may be all that is left, with `bad` 0.
     */
    size_t too_large;
    /**
     * Steiner points that lie on segments now: those of the domain's recovery and of earlier calls too.
     */
    size_t on_segments;
    /**
     * Steiner points that lie on facets now, but on no segment.
     */
    size_t on_facets;
} wsp_report;

/**
 * How large tetrahedra may be at most. Fill it with wsp_sizing_init. Of several sources the smallest length counts at each
 * place; a length that is not positive and finite asks for nothing.
 */
typedef struct wsp_sizing {
    /**
     * Set by the `_init`.
     */
    uint32_t struct_size;
    /**
     * Must be 0.
     */
    uint32_t reserved;
    /**
     * The largest length of an edge in each region, in the order in which the regions were added; `region_count` of them.
     * May be NULL.
     */
    const double *region_max_edge;
    /**
     * See `region_max_edge`; others ask for nothing.
     */
    size_t region_count;
    /**
     * The largest length at each vertex, by id, `vertex_count` of them. May be NULL. Between vertices lengths are interpolated, in the Delaunay
     * triangulation of the input vertices and of those Steiner points that the list reaches: a call with the same list goes on where
     * another one ended. Among vertices that ask for nothing a length grows with the distance from its own vertex.
     */
    const double *vertex_max_edge;
    /**
     * See `vertex_max_edge`; others ask for nothing.
     */
    size_t vertex_count;
    /**
     * Fills in the largest length at `n` points, three doubles each. It must give the same answer each time. May be NULL.
     */
    void (*callback)(void *user, const double *xyz, size_t n, double *max_edge);
    /**
     * Given to the callback as it is.
     */
    void *user;
} wsp_sizing;

/**
 * A Steiner point of a round.
 */
typedef struct wsp_steiner_point {
    /**
     * Where it goes.
     */
    double xyz[3];
    /**
     * What it splits; the vertices are the host's.
     */
    struct wsp_origin origin;
    /**
     * The bad short edge whose mending asks for it; two WSP_NONE for splits of what a vertex of the mesh encroaches upon.
     */
    struct wsp_edge edge;
    /**
     * A tetrahedron of the view whose circumsphere holds the point: to start its location, or the search of its
     * cavity, from. After other insertions any tetrahedron at one of its vertices does.
     */
    uint32_t tetrahedron;
    /**
     * The rule that the point was made by. Splits of the boundary are those that it asks for.
     */
    wsp_rule rule;
} wsp_steiner_point;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * The version of the library that is loaded, as "major.minor.patch". The string is static: never free it.
 * Never fails.
 */
const char *wsp_version(void);

/**
 * The WSP_ABI_VERSION of the library that is loaded; compare it with the header's. Never fails.
 */
uint32_t wsp_abi_version(void);

/**
 * A few words for a status, such as "done"; "unknown status" for a number that has no meaning. The string is
 * static: never free it. Never fails.
 */
const char *wsp_status_string(wsp_status status);

/**
 * What the calling thread's last failure was about: the function, the reason, and the offending point or element
 * ("" before the first failure). Calls that succeed leave it as it is. The string belongs to the library and is
 * valid until the next call that fails on the same thread. Never fails.
 */
const char *wsp_last_error(void);

/**
 * Fills `options` with defaults. `size` is `sizeof *options`.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE (nothing is written then).
 */
wsp_status wsp_triangulation_options_init(struct wsp_triangulation_options *options, size_t size);

/**
 * Fills `options` with defaults. `size` is `sizeof *options`.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE (nothing is written then).
 */
wsp_status wsp_sampler_options_init(struct wsp_sampler_options *options, size_t size);

/**
 * Fills `options` with defaults. `size` is `sizeof *options`.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE (nothing is written then).
 */
wsp_status wsp_refine_options_init(struct wsp_refine_options *options, size_t size);

/**
 * Makes a control. `callback` may be NULL: the control then only cancels. `user` is handed to the callback as it
 * is and may be NULL; what it points to must live as long as the control is in use, and stand the threads that
 * the control's calls run on.
 *
 * `*out` belongs to the caller: free it with wsp_control_free. On an error it is NULL.
 * Errors: WSP_ERR_NULL.
 */
wsp_status wsp_control_new(wsp_progress_callback callback,
                           void *user,
                           struct wsp_control **out);

/**
 * Gives calls that begin with `control` from now on a log; NULL for `callback` takes it away. `user` is handed to the callback as it is: what it
 * points to must live until those calls have ended. Any thread. Constant time.
 * Errors: WSP_ERR_NULL (`control`).
 */
wsp_status wsp_control_set_log(struct wsp_control *control,
                               wsp_log_callback callback,
                               void *user);

/**
 * Frees a control, and what memory cancelled calls have left it; NULL is ignored. Calls that are running with it keep what they need of it, the callback and
 * its `user` included.
 */
void wsp_control_free(struct wsp_control *control);

/**
 * Asks every call that runs with `control`, and every later one, to stop soon, until wsp_control_reset. They return
 * WSP_CANCELLED, within some milliseconds: large memory that they have no more use for they leave to the control, which gives it back when it is
 * reset or freed. Any thread may call this, a callback too. Constant time.
 *
 * That holds for stars of millions of tetrahedra and for splits of facets with as many triangles, too: before so much is changed at once, what there is is
 * copied, to be taken back as a whole.
 * Errors: WSP_ERR_NULL.
 */
wsp_status wsp_control_cancel(struct wsp_control *control);

/**
 * Takes a cancellation back, the callback's too, so that the control can be used again, and gives back the memory that cancelled calls have left:
 * some 30 ms for what a million points take, otherwise constant time. Any thread.
 * Errors: WSP_ERR_NULL.
 */
wsp_status wsp_control_reset(struct wsp_control *control);

/**
 * Makes an empty complex.
 *
 * `*out` belongs to the caller: free it with wsp_plc_free. On an error it is NULL.
 * Errors: WSP_ERR_NULL.
 */
wsp_status wsp_plc_new(struct wsp_plc **out);

/**
 * Frees a complex; NULL is ignored. Called while another call uses the handle it frees nothing and leaves a text for
 * wsp_last_error.
 */
void wsp_plc_free(struct wsp_plc *plc);

/**
 * Adds `n` points, three doubles each. `markers` is NULL or has the caller's own number for each (otherwise 0).
 * `first` is NULL or becomes the position of the first of them; the others follow.
 *
 * All or nothing. The arrays are copied. Cost: linear.
 * Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE, WSP_ERR_TOO_MANY, WSP_ERR_BUSY.
 */
wsp_status wsp_plc_add_points(struct wsp_plc *plc,
                              const double *xyz,
                              size_t n,
                              const int32_t *markers,
                              uint32_t *first);

/**
 * Adds the axis-parallel box from `low` to `high`: eight points and six facets. Point i of the eight is at `high` in
 * x, y, z where bit 0, 1, 2 of i is set. The facets are at x low, x high, y low, y high, z low, z high, with the
 * markers `marker` to `marker + 5`. `first` is NULL or becomes the position of the first of the points.
 *
 * All or nothing. Constant time.
 * Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE, WSP_ERR_ARGUMENT (`low` is not below `high`, or
 * `marker + 5` is too large), WSP_ERR_TOO_MANY, WSP_ERR_BUSY.
 */
wsp_status wsp_plc_add_box(struct wsp_plc *plc,
                           const double low[3],
                           const double high[3],
                           int32_t marker,
                           uint32_t *first);

/**
 * Adds `n` segments, two positions of points each (a facet's sides need not be added). `markers` is NULL or has the
 * caller's own number for each (otherwise 0).
 *
 * All or nothing. The arrays are copied. Cost: linear.
 * Errors: WSP_ERR_NULL, WSP_ERR_NO_SUCH_VERTEX (the points come first), WSP_ERR_ARGUMENT (two equal ends),
 * WSP_ERR_TOO_MANY, WSP_ERR_BUSY.
 */
wsp_status wsp_plc_add_segments(struct wsp_plc *plc,
                                const uint32_t *ends,
                                size_t n,
                                const int32_t *markers);

/**
 * Adds planar facets as two lists of lists. Polygon i is the ring of the points
 * `vertices[polygon_starts[i]]` to `vertices[polygon_starts[i + 1] - 1]`; facet j consists of the polygons
 * `facet_starts[j]` to `facet_starts[j + 1] - 1`. So `polygon_starts` has `polygons + 1` entries and `facet_starts`
 * `facets + 1`, both begin with 0, do not fall, and end with the number of all. `facet_starts` may be NULL: then each
 * polygon is a facet, and `facets` must equal `polygons`.
 *
 * The region of a facet is bounded by all its polygons; a polygon within another is an inner boundary, whose inside
 * is taken out by wsp_plc_add_facet_hole. A polygon of two points is a segment within the facet, one of a
 * single point a vertex within it. `markers` is NULL or has the caller's own number for each facet (otherwise 0).
 * `first` is NULL or becomes the position of the first of the facets.
 *
 * All or nothing. The arrays are copied. Cost: linear.
 * Errors: WSP_ERR_NULL, WSP_ERR_NO_SUCH_VERTEX (the points come first), WSP_ERR_ARGUMENT (starts that are not as
 * above, empty polygons or facets), WSP_ERR_TOO_MANY, WSP_ERR_BUSY.
 */
wsp_status wsp_plc_add_facets(struct wsp_plc *plc,
                              const uint32_t *vertices,
                              const size_t *polygon_starts,
                              size_t polygons,
                              const size_t *facet_starts,
                              size_t facets,
                              const int32_t *markers,
                              uint32_t *first);

/**
 * Takes the part of a facet around `p` out of it: the part bounded by the facet's inner polygons. `p` is in the
 * facet's plane; `facet` is its position.
 * Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE, WSP_ERR_ARGUMENT (no such facet), WSP_ERR_BUSY.
 */
wsp_status wsp_plc_add_facet_hole(struct wsp_plc *plc,
                                  uint32_t facet,
                                  const double p[3]);

/**
 * Takes the volume around `p`, up to the facets that bound it, out of the domain. Holes come before regions: a region's seed in the same volume
 * labels nothing. A seed on a facet counts for one side of it only; inside one volume all places are alike.
 * Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE, WSP_ERR_BUSY.
 */
wsp_status wsp_plc_add_hole(struct wsp_plc *plc,
                            const double p[3]);

/**
 * Labels the volume around `p`, up to the facets that bound it, with `attribute`. `max_volume` asks for tetrahedra of
 * at most that volume there; 0 asks for nothing. Of several seeds in one volume the first one counts, and those of holes come before
 * all. A seed on a facet counts for one side of it only.
 * Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE, WSP_ERR_ARGUMENT (`max_volume` is negative or not
 * finite, `attribute` is NaN), WSP_ERR_BUSY.
 */
wsp_status wsp_plc_add_region(struct wsp_plc *plc,
                              const double p[3],
                              double attribute,
                              double max_volume);

/**
 * How many points, segments and facets the complex has. Each pointer but the first may be NULL. Constant time.
 * Errors: WSP_ERR_NULL, WSP_ERR_BUSY.
 */
wsp_status wsp_plc_counts(const struct wsp_plc *plc,
                          size_t *points,
                          size_t *segments,
                          size_t *facets);

/**
 * Makes `defect` one of no kind. `size` is `sizeof *defect`.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE (nothing is written then).
 */
wsp_status wsp_defect_init(struct wsp_defect *defect, size_t size);

/**
 * Finds every defect of a complex, not only the first: what makes it unusable (wsp_triangulation_from_plc refuses it with
 * the first of these), and what can be meshed but may not be meant. Whether elements meet is decided exactly. The
 * complex is not changed.
 *
 * `*out` belongs to the caller: free it with wsp_check_free. On an error it is NULL. It does not refer to the complex.
 * Cost: n log n in the size of the complex, and linear in the pairs of elements whose bounding boxes meet.
 * Errors: WSP_ERR_NULL, WSP_ERR_BUSY.
 */
wsp_status wsp_plc_check(const struct wsp_plc *plc,
                         struct wsp_check **out);

/**
 * wsp_plc_check that `control`, which may be NULL, cancels: WSP_CANCELLED then, and `*out` is NULL.
 * Errors: those of wsp_plc_check.
 */
wsp_status wsp_plc_check_within(const struct wsp_plc *plc,
                                struct wsp_control *control,
                                struct wsp_check **out);

/**
 * Frees the result of a check; NULL is ignored.
 */
void wsp_check_free(struct wsp_check *check);

/**
 * The number of defects, errors first; 0 for NULL. `errors` is NULL or becomes the number of those that are errors.
 */
size_t wsp_check_count(const struct wsp_check *check,
                       size_t *errors);

/**
 * Fills in defect `index`, from 0. Constant time.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_ARGUMENT (there is no such defect).
 */
wsp_status wsp_check_defect(const struct wsp_check *check, size_t index, struct wsp_defect *defect);

/**
 * Defect `index` in words, to be read until the check is freed; NULL when there is none.
 */
const char *wsp_check_text(const struct wsp_check *check, size_t index);

/**
 * Fills in the smallest angle at which two segments meet (`between_facets` 0) or two facets (1): its degrees as the
 * measure, the two elements, and a point where they meet. With no such angle the degrees are NaN and there are no elements.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_ARGUMENT (`between_facets` is neither).
 */
wsp_status wsp_check_angle(const struct wsp_check *check,
                           uint32_t between_facets,
                           struct wsp_defect *angle);

/**
 * Joins facets of one marker that share a side with no third facet at it, whose normals differ by at most `degrees`, as long
 * as all their points stay in one plane as facets must. Only facets of a single polygon without holes take part, and no
 * side that is a segment of the list is given up. Facets get new positions. `facets` is NULL or becomes how many there are.
 *
 * Cost: n log n in the number of sides.
 * Errors: WSP_ERR_NULL, WSP_ERR_ARGUMENT (`degrees` is not from 0 to 90), WSP_ERR_BUSY.
 */
wsp_status wsp_plc_join_coplanar(struct wsp_plc *plc,
                                 double degrees,
                                 size_t *facets);

/**
 * wsp_plc_join_coplanar that `control`, which may be NULL, cancels: WSP_CANCELLED then, and the complex is as it was. The control is not looked at
 * while one joined facet is put together.
 * Errors: those of wsp_plc_join_coplanar.
 */
wsp_status wsp_plc_join_coplanar_within(struct wsp_plc *plc,
                                        double degrees,
                                        struct wsp_control *control,
                                        size_t *facets);

/**
 * wsp_plc_join_coplanar_within that tells for each facet that there was the number of the one that it is a part of now, in `joined`, which has room for
 * `capacity` of them. Facets that are given to wsp_triangulation_from_plc after that come back by the new numbers (wsp_triangulation_boundary).
 * Errors: those of wsp_plc_join_coplanar, and WSP_ERR_ARGUMENT, with nothing changed, where `capacity` is less than the number of facets.
 */
wsp_status wsp_plc_join_coplanar_groups(struct wsp_plc *plc,
                                        double degrees,
                                        struct wsp_control *control,
                                        uint32_t *joined,
                                        size_t capacity,
                                        size_t *facets);

/**
 * Makes an empty triangulation without a domain. `options` may be NULL: the defaults.
 *
 * `*out` belongs to the caller: free it with wsp_triangulation_free. On an error it is NULL.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION.
 */
wsp_status wsp_triangulation_new(const struct wsp_triangulation_options *options,
                                 struct wsp_triangulation **out);

/**
 * Triangulates a complex's points and makes the complex the domain. The vertex of the complex's point i is the
 * one that wsp_triangulation_insert would give it. Segments and facets are recovered: where they are missing from the
 * Delaunay triangulation they are split, so there may be more vertices than points: those on segments and facets are Steiner points, and
 * wsp_triangulation_boundary tells which they are.
 *
 * `plc` is copied: it may be changed or freed afterwards. `options` and `control` may be NULL.
 * `*out` belongs to the caller: free it with wsp_triangulation_free. It is NULL on an error and after
 * WSP_CANCELLED.
 *
 * A complex of points alone, without facets and segments, gets its hull as the domain; its regions and holes are ignored then.
 *
 * The domain is what the facets enclose, less the volumes around the seeds of holes; it need not be convex. It is checked exactly
 * before anything is made of it, as wsp_plc_check does. Where segments or facets meet at less than 60 degrees, tetrahedra
 * between them may be left bad (WSP_UNREFINED).
 *
 * Cost: that of inserting the points and splits.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION, WSP_ERR_INVALID_DOMAIN, WSP_ERR_TOO_MANY,
 * WSP_ERR_MEMORY, WSP_ERR_BUSY.
 */
wsp_status wsp_triangulation_from_plc(const struct wsp_plc *plc,
                                      const struct wsp_triangulation_options *options,
                                      struct wsp_control *control,
                                      struct wsp_triangulation **out);

/**
 * Makes the convex hull of the present points the domain: its facets are kept, and refinement stays within it.
 * For points whose hull has no volume the domain is empty.
 *
 * Cost: linear in the hull.
 * Errors: WSP_ERR_NULL, WSP_ERR_DOMAIN (there is one already), WSP_ERR_MEMORY, WSP_ERR_BUSY.
 */
wsp_status wsp_triangulation_use_hull_as_domain(struct wsp_triangulation *triangulation);

/**
 * wsp_triangulation_use_hull_as_domain that `control`, which may be NULL, cancels: WSP_CANCELLED then, and nothing has changed.
 * Errors: those of wsp_triangulation_use_hull_as_domain.
 */
wsp_status wsp_triangulation_use_hull_as_domain_within(struct wsp_triangulation *triangulation,
                                                       struct wsp_control *control);

/**
 * Makes a copy, domain included, that shares nothing with the original. Batches of the one fit the other as long
 * as neither has changed.
 *
 * `*out` belongs to the caller: free it with wsp_triangulation_free. On an error it is NULL.
 * Cost: linear in the triangulation.
 * Errors: WSP_ERR_NULL, WSP_ERR_MEMORY, WSP_ERR_BUSY.
 */
wsp_status wsp_triangulation_clone(const struct wsp_triangulation *triangulation,
                                   struct wsp_triangulation **out);

/**
 * wsp_triangulation_clone that `control`, which may be NULL, cancels: WSP_CANCELLED then, and `*out` is NULL.
 * Errors: those of wsp_triangulation_clone.
 */
wsp_status wsp_triangulation_clone_within(const struct wsp_triangulation *triangulation,
                                          struct wsp_control *control,
                                          struct wsp_triangulation **out);

/**
 * Frees a triangulation; NULL is ignored. Called while another call uses the handle (from a callback of that call,
 * say) it frees nothing and leaves a text for wsp_last_error.
 */
void wsp_triangulation_free(struct wsp_triangulation *triangulation);

/**
 * Inserts `n` points, three doubles each. `ids` may be NULL; otherwise it has room for `n`, and `ids[i]` becomes the
 * vertex id of point i. Ids are numbered in the order of insertion and stay; a duplicate has the id of the first
 * point at its place. A new vertex that is inserted alone (`n` is 1) takes the id of the vertex removed last, if there
 * is one; more at once are numbered behind all ids of before. Points are decided exactly, and cospherical ones by a symbolic perturbation, so the result
 * does not depend on the order of insertion.
 *
 * All or nothing: after an error or WSP_CANCELLED the triangulation is as it was, and `ids` too.
 * `n` may be 0, `xyz` is then not looked at; nor is it for an `n` that ids can't number (WSP_ERR_TOO_MANY). A coordinate of -0 is stored as 0.
 * `control` may be NULL. `xyz` and `ids` may overlap.
 *
 * Cost: many points at once are far cheaper than one by one: they are inserted in a spatial order. Expect n log n,
 * with about a million points a second or two.
 * Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE, WSP_ERR_TOO_MANY, WSP_ERR_MEMORY, WSP_ERR_BUSY,
 * WSP_ERR_DOMAIN (there is one: from then on only batches and wsp_refine add points).
 */
wsp_status wsp_triangulation_insert(struct wsp_triangulation *triangulation,
                                    const double *xyz,
                                    size_t n,
                                    uint32_t *ids,
                                    struct wsp_control *control);

/**
 * Removes a vertex. The triangulation is then that of the other points, exactly as if this one had never been
 * there, and its dimension may have dropped. The other vertices keep their ids; this one names no vertex until an
 * insertion takes it again, and holds NaN in the view's points.
 *
 * Cost: that of a triangulation of the vertex's neighbours by themselves, as of some fifteen insertions inside
 * scattered points; linear in all vertices when the others lie in a plane.
 * Errors: WSP_ERR_NULL, WSP_ERR_NO_SUCH_VERTEX, WSP_ERR_DOMAIN (there is one: its vertices stay), WSP_ERR_TOO_MANY,
 * WSP_ERR_MEMORY, WSP_ERR_BUSY.
 */
wsp_status wsp_triangulation_remove(struct wsp_triangulation *triangulation,
                                    uint32_t vertex);

/**
 * wsp_triangulation_remove that `control`, which may be NULL, cancels: WSP_CANCELLED then, and nothing has changed. That is of use for vertices with
 * thousands of neighbours only. Once all is known that takes the place of the vertex's tetrahedra, the change is made without another look at the
 * control; it takes a tenth of the time or less.
 * Errors: those of wsp_triangulation_remove.
 */
wsp_status wsp_triangulation_remove_within(struct wsp_triangulation *triangulation,
                                           uint32_t vertex,
                                           struct wsp_control *control);

/**
 * Finds the vertex, edge, face or tetrahedron of the hull that `p` is in, exactly. `hint` is a vertex near `p` or
 * WSP_NONE.
 *
 * Cost: a walk from the hint; without one it starts anywhere.
 * Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE, WSP_ERR_NO_SUCH_VERTEX (the hint), WSP_ERR_BUSY.
 */
wsp_status wsp_triangulation_locate(const struct wsp_triangulation *triangulation,
                                    const double p[3],
                                    uint32_t hint,
                                    struct wsp_location *location);

/**
 * The triangulation's dimension: -1 without points, 0 one point, 1 collinear, 2 coplanar, 3 otherwise. Only then
 * there are tetrahedra. Constant time.
 * Errors: WSP_ERR_NULL, WSP_ERR_BUSY.
 */
wsp_status wsp_triangulation_dimension(const struct wsp_triangulation *triangulation,
                                       int32_t *dimension);

/**
 * The numbers of vertices (duplicates count once, removed ones not) and of tetrahedra within the convex hull. Either
 * pointer may be NULL. Constant time. After removals ids may be above the number of vertices: those of
 * wsp_mesh_view::points_count are not.
 * Errors: WSP_ERR_NULL, WSP_ERR_BUSY.
 */
wsp_status wsp_triangulation_counts(const struct wsp_triangulation *triangulation,
                                    size_t *vertices,
                                    size_t *tetrahedra);

/**
 * Whether a domain has been set: 1 or 0. Constant time.
 * Errors: WSP_ERR_NULL, WSP_ERR_BUSY.
 */
wsp_status wsp_triangulation_has_domain(const struct wsp_triangulation *triangulation, uint32_t *has_domain);

/**
 * Where a vertex is: three doubles. Constant time; for many points use wsp_triangulation_view.
 * Errors: WSP_ERR_NULL, WSP_ERR_NO_SUCH_VERTEX, WSP_ERR_BUSY.
 */
wsp_status wsp_triangulation_point(const struct wsp_triangulation *triangulation,
                                   uint32_t vertex,
                                   double xyz[3]);

/**
 * Checks a triangulation from the ground up, for tests and bug reports: WSP_DONE if it holds, WSP_ERR_NOT_VALID with a
 * text that names what does not. `level` is a WSP_VALIDATE_ constant; each includes those before it.
 * `radius_edge` is looked at for WSP_VALIDATE_QUALITY only.
 *
 * Cost: linear in the triangulation.
 * Errors: WSP_ERR_NOT_VALID, WSP_ERR_NULL, WSP_ERR_ARGUMENT (the level), WSP_ERR_OPTION (the bound), WSP_ERR_BUSY.
 */
wsp_status wsp_triangulation_validate(const struct wsp_triangulation *triangulation,
                                      uint32_t level,
                                      double radius_edge);

/**
 * wsp_triangulation_validate that `control`, which may be NULL, follows and cancels: WSP_CANCELLED then.
 * Errors: those of wsp_triangulation_validate.
 */
wsp_status wsp_triangulation_validate_within(const struct wsp_triangulation *triangulation,
                                             uint32_t level,
                                             double radius_edge,
                                             struct wsp_control *control);

/**
 * Makes `view` an empty mesh. `size` is `sizeof *view`.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE (nothing is written then).
 */
wsp_status wsp_mesh_view_init(struct wsp_mesh_view *view, size_t size);

/**
 * Shows the mesh's arrays in place: nothing is copied for the caller, and nothing is to be freed. The arrays are
 * valid until the next call that changes or frees `triangulation`. Use of ids: see wsp_triangulation_insert.
 *
 * Cost: the arrays are made at the first call after a change, in linear time; further calls cost nothing.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_MEMORY, WSP_ERR_BUSY; `view` is left as it was.
 */
wsp_status wsp_triangulation_view(const struct wsp_triangulation *triangulation,
                                  struct wsp_mesh_view *view);

/**
 * wsp_triangulation_view that `control`, which may be NULL, follows and cancels: WSP_CANCELLED then, and `view` is left as it was.
 * Errors: those of wsp_triangulation_view.
 */
wsp_status wsp_triangulation_view_within(const struct wsp_triangulation *triangulation,
                                         struct wsp_mesh_view *view,
                                         struct wsp_control *control);

/**
 * Makes `view` an empty boundary. `size` is `sizeof *view`.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE (nothing is written then).
 */
wsp_status wsp_boundary_view_init(struct wsp_boundary_view *view, size_t size);

/**
 * Shows the boundary of the domain in place: its faces and edges as the mesh has them now, with the markers of facets and segments, and for each
 * vertex what it lies on, Steiner points too. Without a domain all arrays are empty. Nothing is copied for the caller, and nothing is to be freed: the
 * arrays are valid until the next call that changes or frees `triangulation`. `control`, which may be NULL, cancels: WSP_CANCELLED then.
 *
 * Cost: the arrays are made at the first call after a change, in time linear in the mesh; further calls cost nothing.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_MEMORY, WSP_ERR_BUSY. After these and WSP_CANCELLED `view` is left as it was.
 */
wsp_status wsp_triangulation_boundary(const struct wsp_triangulation *triangulation,
                                      struct wsp_control *control,
                                      struct wsp_boundary_view *view);

/**
 * Lists the bad short edges of the domain (of the hull without one) for the bound `radius_edge`, shortest first,
 * ties by ids: no tetrahedron is bad if and only if there are none. Two-call list: `out` has room for `capacity` (0
 * and NULL to ask for the count only) and gets the first of them, `*count` becomes the number of all; WSP_INCOMPLETE
 * if they are more than a capacity above 0.
 *
 * Cost: linear in the triangulation, plus sorting, at each call.
 * Errors: WSP_ERR_NULL, WSP_ERR_OPTION (`radius_edge` is not from 0.62 to 1e6), WSP_ERR_BUSY.
 */
wsp_status wsp_bad_short_edges(const struct wsp_triangulation *triangulation,
                               double radius_edge,
                               struct wsp_edge *out,
                               size_t capacity,
                               size_t *count);

/**
 * wsp_bad_short_edges that `control`, which may be NULL, cancels: WSP_CANCELLED then, and nothing is written.
 * Errors: those of wsp_bad_short_edges.
 */
wsp_status wsp_bad_short_edges_within(const struct wsp_triangulation *triangulation,
                                      double radius_edge,
                                      struct wsp_control *control,
                                      struct wsp_edge *out,
                                      size_t capacity,
                                      size_t *count);

/**
 * Lists the vertices around an edge in order. `*closed` becomes 1 if they form a ring, 0 for a chain: then the edge
 * is on the hull, and the first and the last are on the hull's two facets at it. NULL if that does not matter.
 * Two-call list as for wsp_bad_short_edges.
 *
 * Cost: that of the edge's neighbourhood.
 * Errors: WSP_ERR_NULL, WSP_ERR_NO_SUCH_VERTEX, WSP_ERR_NO_SUCH_EDGE, WSP_ERR_BUSY.
 */
wsp_status wsp_edge_link(const struct wsp_triangulation *triangulation,
                         struct wsp_edge edge,
                         uint32_t *out,
                         size_t capacity,
                         size_t *count,
                         uint32_t *closed);

/**
 * Computes what the refinement would insert next for an edge. The boundary comes first: as long as one of its
 * subsegments or subfacets waits to be split, or would be encroached upon by the edge's samples, the batch is of
 * such splits. Otherwise it is the samples of the component of the edge's Voronoi facet outside the core disk that
 * has the largest span. It is empty if the edge is not bad, or can't be mended. Nothing is inserted. `options` may
 * be NULL: the defaults.
 *
 * Without a domain nothing bounds the samples: they may lie outside the hull. See
 * wsp_triangulation_use_hull_as_domain.
 *
 * `*out` belongs to the caller: free it with wsp_batch_free. On an error it is NULL. It refers to no other handle.
 * Cost: that of the edge's neighbourhood.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION, WSP_ERR_NO_SUCH_VERTEX, WSP_ERR_NO_SUCH_EDGE,
 * WSP_ERR_BUSY.
 */
wsp_status wsp_steiner_batch(const struct wsp_triangulation *triangulation,
                             struct wsp_edge edge,
                             const struct wsp_sampler_options *options,
                             struct wsp_batch **out);

/**
 * Inserts a batch. It must be of the triangulation's present state: once anything has been inserted since it was
 * computed, another batch too, its distances and its boundary rules hold no longer, and it is refused. The batch
 * stays the caller's. `ids` is NULL or has room for wsp_batch_count: `ids[i]` becomes the vertex of point i, or
 * WSP_NONE if it was not inserted, because the points before it have made it encroach upon the boundary: the batches
 * to come split that first. If none of a batch's points is inserted and the next batch is the same, the edge can't
 * be mended: that would need edges below 2^-40 of the bounding box.
 *
 * After WSP_ERR_TOO_MANY and WSP_ERR_MEMORY the first points may have been inserted; the triangulation is valid.
 *
 * Cost: that of the insertions.
 * Errors: WSP_ERR_NULL, WSP_ERR_STALE, WSP_ERR_TOO_MANY, WSP_ERR_MEMORY, WSP_ERR_BUSY.
 */
wsp_status wsp_triangulation_insert_batch(struct wsp_triangulation *triangulation,
                                          const struct wsp_batch *batch,
                                          uint32_t *ids);

/**
 * Frees a batch; NULL is ignored.
 */
void wsp_batch_free(struct wsp_batch *batch);

/**
 * The edge that the batch was computed for; two WSP_NONE for NULL.
 */
struct wsp_edge wsp_batch_edge(const struct wsp_batch *batch);

/**
 * The number of Steiner points; 0 for NULL.
 */
size_t wsp_batch_count(const struct wsp_batch *batch);

/**
 * The Steiner points, three doubles each, to be read until the batch is freed; NULL for an empty batch and for NULL.
 */
const double *wsp_batch_points(const struct wsp_batch *batch);

/**
 * Where each Steiner point comes from, to be read until the batch is freed; NULL for an empty batch and for NULL.
 */
const struct wsp_origin *wsp_batch_origins(const struct wsp_batch *batch);

/**
 * The rule that the batch was computed by; 0 for NULL.
 */
wsp_rule wsp_batch_rule(const struct wsp_batch *batch);

/**
 * The span angle of the component that was sampled, in radians; 0 for boundary splits, circumcentres and NULL.
 */
double wsp_batch_span(const struct wsp_batch *batch);

/**
 * The sampling angle, in radians: the span over the number of samples; 0 where the span is.
 */
double wsp_batch_theta(const struct wsp_batch *batch);

/**
 * Makes `report` that of an empty mesh. `size` is `sizeof *report`.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE (nothing is written then).
 */
wsp_status wsp_report_init(struct wsp_report *report, size_t size);

/**
 * Adds Steiner points until no tetrahedron of the domain exceeds the bound on circumradius over shortest edge.
 * Without a domain the convex hull becomes the domain first (see wsp_triangulation_use_hull_as_domain). Input vertices
 * keep their ids, Steiner points are numbered behind them. With `sparsify` on, as it is by default, Steiner points of earlier calls
 * may be taken away too, and those that remain get new ids without gaps; with WSP_SPARSIFY_OFF all keep their ids.
 *
 * Always ends: after WSP_CANCELLED, WSP_VERTEX_LIMIT, WSP_TIME_LIMIT, WSP_MEMORY_LIMIT and WSP_UNREFINED the mesh is valid, Delaunay and
 * usable, and the call may be repeated to go on. A cancellation is answered within some milliseconds; ids of Steiner points may have
 * gaps then, until a later call closes them. A call with the same options but for seconds and bytes, no sizes, and nothing changed in
 * between, tries nothing again that one which was cancelled or whose seconds were over has tried in vain. So calls that are stopped each time come
 * to the end, too, if each may run until it has done something: it begins with a look at all tetrahedra, and the first report of progress may come
 * before anything is done. The second comes after that. `options` and `control` may be NULL. `report` may be NULL; it is
 * written for all statuses of 0 and above, and left as it was after an error.
 *
 * After WSP_ERR_TOO_MANY and WSP_ERR_MEMORY it is valid too, with what had been added.
 *
 * Cost: about linear in the mesh that comes out.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION, WSP_ERR_TOO_MANY, WSP_ERR_MEMORY, WSP_ERR_BUSY.
 */
wsp_status wsp_refine(struct wsp_triangulation *triangulation,
                      const struct wsp_refine_options *options,
                      struct wsp_control *control,
                      struct wsp_report *report);

/**
 * Makes `sizing` ask for nothing. `size` is `sizeof *sizing`.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE (nothing is written then).
 */
wsp_status wsp_sizing_init(struct wsp_sizing *sizing, size_t size);

/**
 * wsp_refine with sizes: a tetrahedron with an edge longer than asked for at its centroid is refined too, within the same boundary
 * rules. Where sizes are asked for, no Steiner point is taken away again, whatever `sparsify` says. The largest volumes of the complex's regions
 * count in both functions. `sizing` may be NULL: nothing more is asked for then. The callback runs on the calling thread.
 * Errors: as wsp_refine.
 */
wsp_status wsp_refine_sized(struct wsp_triangulation *triangulation,
                            const struct wsp_refine_options *options,
                            const struct wsp_sizing *sizing,
                            struct wsp_control *control,
                            struct wsp_report *report);

/**
 * Takes Steiner points away, or puts one in the place of two neighbours, wherever every tetrahedron that comes keeps the bound
 * `radius_edge` (0.62 to 1e6). Works on any triangulation: its Steiner points are the vertices added since it has a domain. Without a domain
 * the convex hull becomes the domain first, and there are none. Input vertices keep their places and ids; segments and facets stay
 * covered by edges and faces; nothing becomes bad. The Steiner points that remain get new ids without gaps, in their order.
 *
 * `level` is a WSP_SPARSIFY_ constant; WSP_SPARSIFY_DEFAULT stands for WSP_SPARSIFY_QUICK. wsp_refine with its option `sparsify` leaves
 * fewer points than this call afterwards. WSP_UNREFINED tells that tetrahedra exceed the bound, as they did before.
 * `control` and `report` may be NULL; `report` is written for all statuses of 0 and above, and left as it was after an error.
 *
 * Cost: some tens of microseconds a Steiner point.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION, WSP_ERR_TOO_MANY, WSP_ERR_MEMORY, WSP_ERR_BUSY.
 */
wsp_status wsp_sparsify_mesh(struct wsp_triangulation *triangulation,
                             double radius_edge,
                             wsp_sparsify level,
                             struct wsp_control *control,
                             struct wsp_report *report);

/**
 * The Steiner batch of edge p q of any Delaunay triangulation, without a handle: as wsp_steiner_batch computes it, but
 * knowing no domain.
 *
 * `link_xyz` are the `n` vertices around the edge in order (either sense), three doubles each. `closed` is 1 if they
 * form a ring; 0 for an edge on the hull, where they are a chain from one of the hull's facets to the other.
 * `options` may be NULL: the defaults. Two-call list: `out_xyz` has room for `capacity` points (0 and NULL to ask
 * for the count only) and gets the first of them, three doubles each, `*count` becomes the number of all;
 * WSP_INCOMPLETE if they are more than a capacity above 0. An edge that is not bad has no points. `out_xyz` may
 * overlap the inputs.
 *
 * Cost: linear in n. May be called from any thread at any time.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE,
 * WSP_ERR_ARGUMENT (p = q, too few link vertices, `closed` neither 0 nor 1).
 */
wsp_status wsp_sample_edge(const double p[3],
                           const double q[3],
                           const double *link_xyz,
                           size_t n,
                           uint32_t closed,
                           const struct wsp_sampler_options *options,
                           double *out_xyz,
                           size_t capacity,
                           size_t *count);

/**
 * The Steiner batch for a bad tetrahedron of any Delaunay triangulation, as the refinement makes it: wsp_sample_edge for hosts that
 * know which tetrahedron they mend.
 *
 * `corners_xyz` are its four corners, twelve doubles, the first two the ends of its shortest edge. `link_xyz`, `n` and `closed` are that
 * edge's link as for wsp_sample_edge, or the part of it on this tetrahedron's side of the domain's boundary, as a chain; with
 * WSP_RULE_CIRCUMCENTER they are not looked at, and NULL and 0 will do. The tetrahedron is not judged: one that is not bad
 * may have points too. Where the rule has no points for the edge, the batch is the circumcentre. The order of the first two corners and
 * that of the last two decide about the last digits: the refinement takes lower ids first. Output as for wsp_sample_edge.
 *
 * Cost: linear in n, less than wsp_sample_edge. May be called from any thread at any time.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE,
 * WSP_ERR_ARGUMENT (the first two corners are the same, too few link vertices, `closed` neither 0 nor 1).
 */
wsp_status wsp_sample_tetrahedron(const double *corners_xyz,
                                  const double *link_xyz,
                                  size_t n,
                                  uint32_t closed,
                                  const struct wsp_sampler_options *options,
                                  double *out_xyz,
                                  size_t capacity,
                                  size_t *count);

/**
 * Whether edge p q of any Delaunay triangulation is bad: `*bad` becomes 1 if its Voronoi facet is not within its core
 * disk, else 0. Arguments as for wsp_sample_edge; `radius_edge` is the bound.
 *
 * Cost: linear in n. May be called from any thread at any time.
 * Errors: WSP_ERR_NULL, WSP_ERR_OPTION (`radius_edge` is not from 0.62 to 1e6), WSP_ERR_NOT_FINITE,
 * WSP_ERR_OUT_OF_RANGE, WSP_ERR_ARGUMENT.
 */
wsp_status wsp_is_bad_edge(const double p[3],
                           const double q[3],
                           const double *link_xyz,
                           size_t n,
                           uint32_t closed,
                           double radius_edge,
                           uint32_t *bad);

/**
 * One round of refinement on the arrays of any mesher: looks for bad short edges and computes points that may all be
 * inserted together. 'Batch, insert, repeat' ends at a batch of no points, with no bad tetrahedron left after
 * WSP_DONE. That is sure for a `radius_edge` of 2 or more where segments and facets meet at 60 degrees or more; below,
 * nothing but `min_edge` may end it, after very many points. Give a host's loop a limit of rounds there (10 for each
 * doubling of the lengths from the smallest feature to the domain, and 100), or a `min_edge` of about a tenth of the
 * smallest feature: then it ends always, and what is left is counted.
 *
 * `view` is a Delaunay mesh of the domain: its points, tetrahedra, and optionally neighbours (NULL: they are found)
 * and `faces`, `facets`. Faces with a tetrahedron on one side only are the domain's boundary, and `faces` is part of
 * it too: no sample encroaches upon them. A face that one would encroach upon, or a vertex does, is split first: the
 * batch then has a point on it, of origin WSP_ORIGIN_SUBFACET or WSP_ORIGIN_SEGMENT; with `keep_boundary` no such
 * point ever comes, what asks for it is left, and samples stay out of the diametral ball of each face and segment that
 * no vertex is in, and take none out. Edges of the boundary are segments where facets meet; what a facet is, `facets`
 * says, and without numbers coplanar neighbours are of one. Nothing is remembered from round to round.
 *
 * The points of different edges are independent: their cavities (as the empty-sphere rule and exact arithmetic have
 * them, cospherical tetrahedra included) neither meet nor share a face, so the order of insertion does not matter and
 * none comes near another. The points of one edge stand together; their cavities may overlap, and they keep their
 * distances. Any first part of the list may be inserted and the rest be left out.
 *
 * A facet that is not parallel to an axis can't hold points exactly: a split may lie off its plane by rounding, with
 * flat tetrahedra between the two. On the outside they are found, and are no part of the domain: tetrahedra without a
 * face in `faces` that are less high than the least distance (see `min_edge`; its default) are neither judged nor
 * mended, and neighbours of the boundary that are coplanar but for that are of one facet. At inner facets, leave them
 * out of the view, and give faces at the facet its number: a tetrahedron is flat if all its vertices are on one facet,
 * where a split of a subfacet is on its facet and the split of a segment on all facets that both its ends are on.
 *
 * `options` and `control` may be NULL. `*out` belongs to the caller: free it with wsp_mesh_batch_free. After an error
 * or WSP_CANCELLED it is NULL. WSP_UNREFINED: the batch has no points, but bad tetrahedra are left, because mending
 * them needs edges below `min_edge`, or, at angles of less than 60 degrees between boundary elements, such as their
 * shortest edge spans or splits that make edges shorter than `radius_edge` / 2 times that; or because of
 * `keep_boundary`.
 *
 * Cost: linear in the arrays, about a microsecond a tetrahedron.
 * Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE,
 * WSP_ERR_TOO_MANY, WSP_ERR_NOT_VALID (a tetrahedron is flat, negative or not Delaunay, names no vertex, or neighbours
 * are wrong: the text says which).
 */
wsp_status wsp_sample_mesh(const struct wsp_mesh_view *view,
                           const struct wsp_sampler_options *options,
                           struct wsp_control *control,
                           struct wsp_mesh_batch **out);

/**
 * Frees a batch; NULL is ignored.
 */
void wsp_mesh_batch_free(struct wsp_mesh_batch *batch);

/**
 * The number of Steiner points; 0 for NULL.
 */
size_t wsp_mesh_batch_count(const struct wsp_mesh_batch *batch);

/**
 * The Steiner points, to be read until the batch is freed; NULL for an empty batch and for NULL.
 */
const struct wsp_steiner_point *wsp_mesh_batch_points(const struct wsp_mesh_batch *batch);

/**
 * The bad short edges of the view, shortest first, to be read until the batch is freed; `*count` becomes their number.
 * NULL when there are none, for NULL, and if `count` is NULL.
 */
const struct wsp_edge *wsp_mesh_batch_bad_edges(const struct wsp_mesh_batch *batch,
                                                size_t *count);

/**
 * How many bad tetrahedra and encroached boundary elements can't be mended (see wsp_sample_mesh); 0 for NULL.
 */
size_t wsp_mesh_batch_refused(const struct wsp_mesh_batch *batch);

/**
 * Which of `n` tetrahedra are bad, in one call: `bad[i]` becomes 1 if the circumradius of tetrahedron i exceeds
 * `radius_edge` times its shortest edge, by exact arithmetic, else 0. `corners_xyz` has four points a tetrahedron, twelve
 * doubles. The two arrays may not overlap.
 *
 * Cost: linear in n. May be called from any thread at any time.
 * Errors: WSP_ERR_NULL, WSP_ERR_OPTION (`radius_edge` is not from 0.62 to 1e6), WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE.
 */
wsp_status wsp_bad_tetrahedra(const double *corners_xyz,
                              size_t n,
                              double radius_edge,
                              uint8_t *bad);

/**
 * The exact sign of det[b-a, c-a, d-a]: `*sign` becomes 1 if tetrahedron a b c d is positively oriented, 0 if it is flat, else -1.
 *
 * Constant time but for degenerate input. May be called from any thread at any time.
 * Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE.
 */
wsp_status wsp_orientation(const double a[3],
                           const double b[3],
                           const double c[3],
                           const double d[3],
                           int32_t *sign);

/**
 * Where `p` is to the circumsphere of the positively oriented tetrahedron a b c d, exactly: `*sign` becomes 1 inside, 0 on
 * it, -1 outside.
 *
 * Constant time but for degenerate input. May be called from any thread at any time.
 * Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE.
 */
wsp_status wsp_side_of_sphere(const double a[3],
                              const double b[3],
                              const double c[3],
                              const double d[3],
                              const double p[3],
                              int32_t *sign);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* WELLSPACED_H */
