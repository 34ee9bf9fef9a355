/* Kerf for C99: meshes, cracks, pieces, fracture at an impact, simulation (docs/c.md).
 *
 * Every function returns a kerf_status, unless it says otherwise. After any status but KERF_OK,
 * kerf_last_message() has one line: what is wrong, and what to do. Outputs are then as before, or
 * null.
 *
 * Handles are opaque. A handle that is null, of another kind, or freed gives KERF_HANDLE. Calls may
 * come from any thread. Two calls at once on one handle are allowed where neither changes it; else
 * the later one gives KERF_BUSY.
 *
 * Arrays are a pointer and the number of their elements: points (x, y, z) of `double` have three
 * elements each. Arrays that are given are copied. Arrays that are taken belong to the handle, and
 * stay as they are until it is freed. Texts are UTF-8 and end with a zero.
 */
#ifndef KERF_H
#define KERF_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define KERF_API __attribute__((visibility("default")))
#else
#define KERF_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Status, version, threads */

typedef enum kerf_status {
  KERF_OK = 0,
  KERF_INPUT = 1,    /* data or file is unusable: open mesh, malformed file, value out of range */
  KERF_GEOMETRY = 2, /* a step failed on valid input, nothing changed */
  KERF_OUTPUT = 3,   /* a file cannot be written */
  KERF_STOPPED = 4,  /* the callback stopped the call */
  KERF_HANDLE = 5,   /* a handle is null, of another kind, or freed */
  KERF_ARGUMENT = 6, /* a pointer is null, a length is wrong, a number is not finite */
  KERF_BUSY = 7,     /* another call changes, or reads, this handle now */
  KERF_MEMORY = 8,   /* there is not enough memory */
  KERF_INTERNAL = 9  /* a fault of Kerf: please report it */
} kerf_status;

/* "1.0.0"; never null. */
KERF_API const char* kerf_version(void);
/* Of this header's functions and structures; a change that breaks programs raises it. */
#define KERF_ABI 1
KERF_API uint32_t kerf_abi(void);
/* Of the last call of this thread that did not return KERF_OK; "" before one; valid until the next
 * such call of this thread. */
KERF_API const char* kerf_last_message(void);
/* "KERF_INPUT"; "" for a number that is no status. */
KERF_API const char* kerf_status_name(kerf_status status);
/* Threads of all later calls; 0: one for each core. Results do not depend on it. */
KERF_API kerf_status kerf_set_threads(int32_t count);
/* 1: vectors without fused products, for the bytes of any x86 processor and of WebAssembly in later
 * steps of simulations; 0: the widest vectors. Call it while no other call runs. */
KERF_API kerf_status kerf_set_portable(int32_t portable);

/* Receives the phase, the work done and the total work. Returns 0 to stop the call, which then
 * returns KERF_STOPPED and changes nothing. May be null. Some calls report from other threads. */
typedef int32_t (*kerf_progress)(void* user, const char* phase, size_t done, size_t total);

/* Frees a handle of any kind. Null is allowed. A handle that is freed already gives KERF_HANDLE. */
KERF_API kerf_status kerf_free(void* handle);

/* ---- Bytes: a file in memory */

typedef struct kerf_bytes_s* kerf_bytes;
KERF_API kerf_status kerf_bytes_data(kerf_bytes bytes, const uint8_t** data, size_t* length);

/* ---- Meshes: triangles with attributes, which never change */

typedef struct kerf_mesh_s* kerf_mesh;

/* The content of a mesh, to give and to take. Set all to zero first: `kerf_mesh_arrays a = {0};` */
typedef struct kerf_mesh_arrays {
  const double* vertices; /* points, model units */
  size_t vertices_length;
  const uint32_t* faces; /* three vertices for each triangle, counter-clockwise from outside */
  size_t faces_length;
  const double* uv; /* optional: u, v for each corner of each triangle: 2 * faces_length */
  size_t uv_length;
  const double* normals; /* optional: for each corner: 3 * faces_length */
  size_t normals_length;
  const double* colors; /* optional: red, green, blue, alpha, 0 to 1, for each corner */
  size_t colors_length;
  const int32_t* groups; /* optional: index into group_names for each triangle */
  size_t groups_length;
  const char* const* group_names; /* materials */
  size_t group_names_length;
  double unit; /* the metres of one unit of its coordinates; 0: nothing says so */
  /* Taken only. Of a surface with cracks: 0 skin, +c and -c the two sides of crack c. */
  const int32_t* patch;
  size_t patch_length;
  /* Taken only: the triangle of the model that contains this one; UINT32_MAX: of a crack. */
  const uint32_t* source;
  size_t source_length;
} kerf_mesh_arrays;

KERF_API kerf_status kerf_mesh_create(const kerf_mesh_arrays* arrays, kerf_mesh* mesh);
KERF_API kerf_status kerf_mesh_get(kerf_mesh mesh, kerf_mesh_arrays* arrays);
/* Reads PLY, OBJ (with MTL), STL, OFF, GLB and glTF; the format is found by content. */
KERF_API kerf_status kerf_mesh_load(const char* path, kerf_mesh* mesh);
/* The same from memory. `name` stands for the file in messages. */
KERF_API kerf_status kerf_mesh_parse(const uint8_t* bytes, size_t length, const char* name, kerf_mesh* mesh);
/* Writes .ply, .obj (with .mtl and images), .stl, .off or .glb, by the ending. */
KERF_API kerf_status kerf_mesh_save(kerf_mesh mesh, const char* path);
/* The same to memory; `format` is "ply", "obj", "stl", "off" or "glb". */
KERF_API kerf_status kerf_mesh_write(kerf_mesh mesh, const char* format, kerf_bytes* bytes);

typedef struct kerf_measures {
  double volume; /* model units^3; negative where normals point inwards */
  double area;
  double low[3], high[3]; /* the box around it */
  double centroid[3];     /* of the material */
} kerf_measures;
KERF_API kerf_status kerf_mesh_measures(kerf_mesh mesh, kerf_measures* measures);

typedef struct kerf_report {
  int32_t good; /* 1: a solid; otherwise first_problem says why not */
  int32_t closed, manifold, oriented;
  uint64_t degenerate_faces, self_intersections, shells;
  char first_problem[256];
} kerf_report;
/* Exact. `self_intersections`: 1 also looks for triangles that cross, which costs most. */
KERF_API kerf_status kerf_mesh_check(kerf_mesh mesh, int32_t self_intersections, kerf_report* report);
/* A solid from a surface with holes, seams, reversed triangles or overlapping parts. `weld`: open
 * vertices up to this far apart are one, model units. */
KERF_API kerf_status kerf_mesh_repaired(kerf_mesh mesh, double weld, int32_t smooth, kerf_mesh* solid);
/* Edges of at most `longest`, model units. */
KERF_API kerf_status kerf_mesh_refine(kerf_mesh mesh, double longest, kerf_mesh* refined);
/* Convex hulls that cover it: `count` at most, each with `corners` at most. `hulls` has room for
 * `count` handles. */
KERF_API kerf_status kerf_mesh_convex_decomposition(kerf_mesh mesh, size_t count, size_t corners, kerf_mesh* hulls,
                                                    size_t* hull_count);
/* A block from the origin to `size`; edges of at most `edge`. */
KERF_API kerf_status kerf_shape_block(const double size[3], double edge, kerf_mesh* mesh);
/* 20 * frequency^2 triangles; frequency from 1 to 1000. */
KERF_API kerf_status kerf_shape_sphere(int32_t frequency, kerf_mesh* mesh);
KERF_API kerf_status kerf_shape_pumpkin(int32_t frequency, kerf_mesh* mesh);

/* ---- Complexes: a solid with its cracks */

typedef struct kerf_complex_s* kerf_complex;

/* Of a mesh that is a solid, or a surface with cracks as kerf_complex_surface() gives it. */
KERF_API kerf_status kerf_complex_create(kerf_mesh mesh, kerf_complex* complex);
KERF_API kerf_status kerf_complex_copy(kerf_complex complex, kerf_complex* copy);
/* Skin and both sides of each crack. */
KERF_API kerf_status kerf_complex_surface(kerf_complex complex, kerf_mesh* surface);
KERF_API kerf_status kerf_complex_check(kerf_complex complex, int32_t self_intersections, kerf_report* report);

typedef struct kerf_complex_counts {
  uint64_t vertices, faces;
  int32_t cracks; /* the largest number of a crack */
  uint32_t pieces;
} kerf_complex_counts;
KERF_API kerf_status kerf_complex_count(kerf_complex complex, kerf_complex_counts* counts);

/* Fracture patterns, as kerf-score has them. */
typedef enum kerf_pattern {
  KERF_PLANES = 0,
  KERF_CROSSING = 1,
  KERF_VORONOI = 2,
  KERF_RADIAL = 3,
  KERF_GLASS = 4,
  KERF_WOOD = 5,
  KERF_BRICKS = 6,
  KERF_CURVES = 7 /* the borders of the black areas of `image`, swept along `axis` */
} kerf_pattern;

/* kerf_score_defaults() sets all of it. Lengths are fractions of the model's diagonal. */
typedef struct kerf_score_options {
  int32_t pattern; /* kerf_pattern */
  int32_t pieces;
  uint64_t seed;
  int32_t has_axis, has_impact; /* 1: `axis`, `impact` are given */
  double axis[3];               /* normal of planes, grain of wood, axis of glass */
  double impact[3];             /* where cells are small, or cracks meet; model units */
  double cluster;               /* radius of the small cells around the impact */
  double grain;                 /* wood: length of a cell over its thickness */
  double jagged;                /* amplitude of rough walls; 0: flat ones */
  double frequency;             /* of rough walls, per diagonal */
  double depth;                 /* below 1: walls reach only so deep */
  int32_t attempts;
  int32_t chips;         /* small pieces that break off edges, beside `pieces` */
  double chip_size;      /* their length, of the cube root of the mean piece's volume */
  double edge_detail;    /* amplitude of finer bumps near the skin, of the diagonal; 0: none */
  double edge_width;     /* their depth, of the diagonal */
  const double* density; /* where cells are many: a value of at least 0 for each vertex; or null */
  size_t density_length;
  const uint8_t* image; /* brightness, rows from above, `image_width` bytes each; or null: none */
  int32_t image_width, image_height;
} kerf_score_options;
KERF_API kerf_status kerf_score_defaults(kerf_score_options* options);
/* The walls of a pattern as a sheet for kerf_complex_insert(). `options` may be null. `pieces`
 * receives their number, and may be null. */
KERF_API kerf_status kerf_score(kerf_complex complex, const kerf_score_options* options, kerf_progress progress,
                                void* user, kerf_mesh* sheet, uint32_t* pieces);

/* Cracks along a sheet: any triangles. Parts outside the material have no effect. */
KERF_API kerf_status kerf_complex_insert(kerf_complex complex, kerf_mesh sheet);
/* Cracks along a plane, through the whole solid. */
KERF_API kerf_status kerf_complex_cut_plane(kerf_complex complex, const double point[3], const double normal[3]);
/* Cracks along all sheets and fronts of a file (.front, .obj). Each is a crack that was made before
 * the next one fails. */
KERF_API kerf_status kerf_complex_crack_file(kerf_complex complex, const char* path, kerf_progress progress,
                                             void* user);
KERF_API kerf_status kerf_complex_crack_bytes(kerf_complex complex, const uint8_t* bytes, size_t length,
                                              const char* name, kerf_progress progress, void* user);
/* Takes the last crack, or step of a front, back. One step is kept. */
KERF_API kerf_status kerf_complex_undo(kerf_complex complex);
/* Heals pieces below a volume (model units^3) to their neighbours. */
KERF_API kerf_status kerf_complex_join_small_pieces(kerf_complex complex, double least);
/* Improves faces whose smallest angle is below `angle`, 0 to 30 degrees. This and the next two end
 * the fronts of the complex, and cannot be undone. A call that is stopped leaves it as it was. */
KERF_API kerf_status kerf_complex_remesh(kerf_complex complex, double angle, kerf_progress progress, void* user);
/* Displaces the inner vertices of cracks by noise: `amplitude` as a fraction of the diagonal of the
 * largest bumps, `frequency` of these a diagonal. Volumes of pieces keep their sum. */
KERF_API kerf_status kerf_complex_roughen(kerf_complex complex, double amplitude, double frequency, uint64_t seed,
                                          kerf_progress progress, void* user);
/* Collapses edges where a surface moves by at most `deviation`, a fraction of the diagonal, until
 * `faces` are left; 0: as many as possible. */
KERF_API kerf_status kerf_complex_decimate(kerf_complex complex, double deviation, size_t faces, kerf_progress progress,
                                           void* user);

/* A front: a polyline that cuts on its way. Its complex lives as long as it does. */
typedef struct kerf_front_s* kerf_front;
KERF_API kerf_status kerf_front_begin(kerf_complex complex, const double* points, size_t points_length, int32_t closed,
                                      kerf_front* front);
/* Moves it to `points`, as many as it has. `new_faces` receives the crack faces made, or is null. */
KERF_API kerf_status kerf_front_advance(kerf_front front, const double* points, size_t points_length,
                                        size_t* new_faces);

/* ---- Pieces with bonds */

typedef struct kerf_pieces_s* kerf_pieces;

typedef struct kerf_bond {
  uint32_t a, b; /* pieces, a < b */
  double area;
  double normal[3], centroid[3];
  double section; /* elastic section modulus of the wall, model units^3 */
} kerf_bond;

typedef struct kerf_piece {
  double volume; /* model units^3 */
  double centroid[3];
  double inertia[9]; /* about the centroid, for a density of 1 */
} kerf_piece;

/* In descending order of volume. Inner faces have the group "crack" and texture coordinates. */
KERF_API kerf_status kerf_complex_pieces(kerf_complex complex, kerf_pieces* pieces);
/* Pattern, crack and pieces in one call. */
KERF_API kerf_status kerf_fracture(kerf_mesh solid, const kerf_score_options* options, kerf_progress progress,
                                   void* user, kerf_pieces* pieces);
KERF_API kerf_status kerf_pieces_count(kerf_pieces pieces, size_t* count);
KERF_API kerf_status kerf_pieces_get(kerf_pieces pieces, size_t index, kerf_piece* piece);
KERF_API kerf_status kerf_pieces_mesh(kerf_pieces pieces, size_t index, kerf_mesh* mesh);
KERF_API kerf_status kerf_pieces_bonds(kerf_pieces pieces, const kerf_bond** bonds, size_t* length);
/* A file for engines, .glb or .usda, with convex hulls and bonds. */
KERF_API kerf_status kerf_pieces_save(kerf_pieces pieces, const char* path);
/* The same to memory; `format` is "glb" or "usda". */
KERF_API kerf_status kerf_pieces_write(kerf_pieces pieces, const char* format, kerf_bytes* bytes);

/* ---- Impact: a solid breaks where it is hit, within a budget of time for each call */

/* A solid that is prepared to be broken. Made once for a model, when it is loaded. */
typedef struct kerf_solid_s* kerf_solid;
KERF_API kerf_status kerf_solid_create(kerf_mesh mesh, kerf_solid* solid);
KERF_API kerf_status kerf_solid_mesh(kerf_solid solid, kerf_mesh* mesh);

/* kerf_impact_defaults() sets all of it. */
typedef struct kerf_impact_options {
  double toughness;   /* J for a square model unit of new wall */
  int32_t max_pieces; /* 2 to 10000 */
  double grading;     /* 0: cells are as large everywhere; 1: spacing grows as the distance from the impact */
  double elongation;  /* length of pieces along the direction over their width */
  uint32_t hull_parts, hull_corners;
  uint64_t seed;
  int32_t guard; /* 1: no faces of pieces cross by a rounding, either; takes twice as long */
} kerf_impact_options;
KERF_API kerf_status kerf_impact_defaults(kerf_impact_options* options);

/* A break that goes on from call to call. Its parts that are not divided fill the solid. */
typedef struct kerf_breaking_s* kerf_breaking;
/* Breaks a solid by a blow of `energy` J, for about `budget_ms`, and for one step at least. The
 * direction may be zero, the options null. `finished` receives 0 where kerf_break_continue() has
 * more to do. */
KERF_API kerf_status kerf_break(kerf_solid solid, const double point[3], const double direction[3], double energy,
                                double budget_ms, const kerf_impact_options* options, kerf_breaking* breaking,
                                int32_t* finished);
KERF_API kerf_status kerf_break_continue(kerf_breaking breaking, double budget_ms, int32_t* finished);

typedef struct kerf_part {
  int32_t parent;  /* the part that it came out of; -1: it is the solid */
  int32_t divided; /* 1: other parts have taken its place */
  int32_t whole;   /* 1: it breaks no further in this impact, and has its hulls */
  uint32_t hulls;
  double volume;
  double centroid[3];
  double inertia[9]; /* about the centroid, for a density of 1 */
} kerf_part;
/* Parts are numbered in the order in which they come out; part 0 is the solid. */
KERF_API kerf_status kerf_breaking_count(kerf_breaking breaking, size_t* count);
KERF_API kerf_status kerf_breaking_part(kerf_breaking breaking, size_t index, kerf_part* part);
KERF_API kerf_status kerf_breaking_mesh(kerf_breaking breaking, size_t index, kerf_mesh* mesh);
KERF_API kerf_status kerf_breaking_hull(kerf_breaking breaking, size_t index, size_t hull, kerf_mesh* mesh);
/* The part as a solid that may be broken again. */
KERF_API kerf_status kerf_breaking_solid(kerf_breaking breaking, size_t index, kerf_solid* solid);

/* ---- Simulation, frame by frame, in SI units */

typedef struct kerf_simulation_s* kerf_simulation;

/* A scene in TOML (docs/formats.md), with a solid for each of its bodies. No models: those that the
 * scene names. `folder`: of the files that it names; null: the current one. */
KERF_API kerf_status kerf_simulation_create(const char* scene, size_t scene_length, const char* folder,
                                            const kerf_mesh* models, size_t model_count, kerf_progress progress,
                                            void* user, kerf_simulation* simulation);
KERF_API kerf_status kerf_simulation_load(const char* scene_path, kerf_progress progress, void* user,
                                          kerf_simulation* simulation);

typedef struct kerf_frame {
  double time;         /* s, at the frame's end */
  int32_t frame;       /* frames so far */
  double elastic;      /* energy, J */
  double kinetic;      /* J */
  uint64_t cut_edges;  /* of the graph */
  uint64_t refused;    /* crack steps that could not be made */
  uint64_t new_cracks; /* by stress */
  double seconds;      /* of computing */
} kerf_frame;
/* Makes the next frame. `frame` may be null. A call that was stopped leaves a run that cannot go
 * on. */
KERF_API kerf_status kerf_simulation_step(kerf_simulation simulation, kerf_progress progress, void* user,
                                          kerf_frame* frame);
KERF_API kerf_status kerf_simulation_frame(kerf_simulation simulation, kerf_frame* frame);
/* Of the nodes, copied into room for `length` numbers. `needed` receives their number, and may be
 * null; with null and 0 it is all that happens. */
KERF_API kerf_status kerf_simulation_positions(kerf_simulation simulation, double* points, size_t length,
                                               size_t* needed);
KERF_API kerf_status kerf_simulation_velocities(kerf_simulation simulation, double* points, size_t length,
                                                size_t* needed);
/* Von Mises stress of each node, Pa. */
KERF_API kerf_status kerf_simulation_stress(kerf_simulation simulation, double* values, size_t length, size_t* needed);
/* The deformed surface with the model's attributes, except normals. */
KERF_API kerf_status kerf_simulation_surface(kerf_simulation simulation, kerf_mesh* surface);

/* A position, and a rotation as a quaternion w, x, y, z of any length above 0. */
typedef struct kerf_pose {
  double position[3];
  double rotation[4];
} kerf_pose;

/* kerf_blade_defaults() sets all of it. */
typedef struct kerf_blade_options {
  const double* points; /* of the edge, two at least */
  size_t points_length;
  int32_t closed;
  double back[3];   /* from the edge to the back of the wedge */
  double thickness; /* of the wedge at its back; 0: none */
  double stiffness; /* of the wedge, 1/s^2 */
  double limit;     /* largest motion in one cut, in spacings of nodes */
} kerf_blade_options;
KERF_API kerf_status kerf_blade_defaults(kerf_blade_options* options);

/* Objects have numbers, each kind from 0. A scene's come first, in its order. */
KERF_API kerf_status kerf_simulation_add_blade(kerf_simulation simulation, const kerf_blade_options* blade,
                                               const kerf_pose* pose, uint32_t* index);
/* Moves it there by the end of the next frame, and cuts on its way. */
KERF_API kerf_status kerf_simulation_move_blade(kerf_simulation simulation, uint32_t index, const kerf_pose* pose);
/* The number of the blade with this name. */
KERF_API kerf_status kerf_simulation_blade(kerf_simulation simulation, const char* name, uint32_t* index);
/* That the material exerts on it, N, mean over the last frame. */
KERF_API kerf_status kerf_simulation_blade_force(kerf_simulation simulation, uint32_t index, double force[3]);
/* Holds the nodes in a box, material coordinates. */
KERF_API kerf_status kerf_simulation_add_grip(kerf_simulation simulation, const double low[3], const double high[3],
                                              uint32_t* index);
KERF_API kerf_status kerf_simulation_move_grip(kerf_simulation simulation, uint32_t index, const kerf_pose* pose);
KERF_API kerf_status kerf_simulation_end_grip(kerf_simulation simulation, uint32_t index);
/* A spring from a point of the material to a place in the world; N/m. */
KERF_API kerf_status kerf_simulation_add_pull(kerf_simulation simulation, const double point[3], const double end[3],
                                              double stiffness, uint32_t* index);
KERF_API kerf_status kerf_simulation_move_pull(kerf_simulation simulation, uint32_t index, const double end[3]);
KERF_API kerf_status kerf_simulation_pull_force(kerf_simulation simulation, uint32_t index, double force[3]);
KERF_API kerf_status kerf_simulation_move_obstacle(kerf_simulation simulation, uint32_t index, const kerf_pose* pose);

/* Breaks the piece nearest to a point of the world into about `cells` parts, 2 to 1000, now; they
 * fly from the point. Not while a blade is in the body. A blow that breaks nothing gives
 * KERF_GEOMETRY, and the run is as it was. */
KERF_API kerf_status kerf_simulation_strike(kerf_simulation simulation, const double point[3], int32_t cells);

/* Values from now on. A number that is not above or equal to 0 (NaN) stays as it was. */
typedef struct kerf_changes {
  double young, damping, friction, step;
  int32_t has_gravity;
  double gravity[3];
} kerf_changes;
KERF_API kerf_status kerf_simulation_change(kerf_simulation simulation, const kerf_changes* changes);

#ifdef __cplusplus
}
#endif

#endif
