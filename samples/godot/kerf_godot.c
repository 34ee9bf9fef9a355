/* Kerf for Godot 3, by GDNative: procedures that GDScript calls with an array of arguments.
 *
 * Debian has no headers of GDNative. What is needed of them is declared here: objects of the engine
 * are opaque bytes, and functions are entries of a table, whose places core 1.0 has fixed. */
#include <kerf.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* ---- The engine */

typedef struct {
  void* own;
} godot_array;
typedef struct {
  void* own;
} godot_vector3_pool;
typedef struct {
  float x, y, z;
} godot_vector3;
typedef struct {
  uint64_t own[3];
} godot_variant;
typedef void (*godot_function)(void);

enum { core_functions = 744 };
typedef struct {
  unsigned type, major, minor;
  const void* next;
  unsigned extension_count;
  const void* const* extensions;
  godot_function functions[core_functions];
} godot_core;
typedef struct {
  bool in_editor;
  uint64_t hashes[3];
  godot_function reports[2];
  void* library;
  const godot_core* core;
  const void* path;
} godot_options;

/* Places in the table, with the types of the functions there. */
enum {
  at_pool_new = 235,
  at_pool_resize = 244,
  at_pool_read = 245,
  at_pool_write = 246,
  at_pool_size = 249,
  at_pool_destroy = 250,
  at_pool_read_data = 288,
  at_pool_read_destroy = 290,
  at_pool_write_data = 316,
  at_pool_write_destroy = 318,
  at_array_new = 323,
  at_array_get = 333,
  at_array_push_back = 351,
  at_array_size = 356,
  at_array_destroy = 361,
  at_variant_new_nil = 509,
  at_variant_new_int = 512,
  at_variant_new_real = 513,
  at_variant_new_vector3 = 517,
  at_variant_new_array = 529,
  at_variant_new_pool = 535,
  at_variant_as_int = 539,
  at_variant_as_real = 540,
  at_variant_as_vector3 = 544,
  at_variant_as_pool = 562,
  at_variant_destroy = 570,
  at_print_error = 741
};
static const godot_core* core;
#define ENGINE(place, result, ...) ((result(*)(__VA_ARGS__))core->functions[place])

static void say(const char* message) {
  ENGINE(at_print_error, void, const char*, const char*, const char*, int)(message, "kerf", "kerf_godot.c", 0);
}

/* Whether a call of Kerf was good; tells the engine's console otherwise. */
static bool good(kerf_status status) {
  if (status != KERF_OK) say(kerf_last_message());
  return status == KERF_OK;
}

/* ---- Arguments and results */

static godot_variant argument(const godot_array* arguments, int index) {
  return ENGINE(at_array_get, godot_variant, const godot_array*, int)(arguments, index);
}

static bool has_arguments(const godot_array* arguments, int count) {
  if (ENGINE(at_array_size, int, const godot_array*)(arguments) == count) return true;
  say("wrong number of arguments");
  return false;
}

static void forget(godot_variant* value) { ENGINE(at_variant_destroy, void, godot_variant*)(value); }

static double real_argument(const godot_array* arguments, int index) {
  godot_variant value = argument(arguments, index);
  const double real = ENGINE(at_variant_as_real, double, const godot_variant*)(&value);
  forget(&value);
  return real;
}

/* Handles are integers in GDScript; Kerf refuses those that it did not make. */
static void* handle_argument(const godot_array* arguments, int index) {
  godot_variant value = argument(arguments, index);
  const int64_t number = ENGINE(at_variant_as_int, int64_t, const godot_variant*)(&value);
  forget(&value);
  return (void*)(intptr_t)number;
}

static void point_argument(const godot_array* arguments, int index, double point[3]) {
  godot_variant value = argument(arguments, index);
  const godot_vector3 v = ENGINE(at_variant_as_vector3, godot_vector3, const godot_variant*)(&value);
  forget(&value);
  point[0] = v.x;
  point[1] = v.y;
  point[2] = v.z;
}

static godot_variant nil(void) {
  godot_variant value;
  ENGINE(at_variant_new_nil, void, godot_variant*)(&value);
  return value;
}

static godot_variant integer(int64_t number) {
  godot_variant value;
  ENGINE(at_variant_new_int, void, godot_variant*, int64_t)(&value, number);
  return value;
}

static void append(godot_array* array, godot_variant value) {
  ENGINE(at_array_push_back, void, godot_array*, const godot_variant*)(array, &value);
  forget(&value);
}

static void append_real(godot_array* array, double number) {
  godot_variant value;
  ENGINE(at_variant_new_real, void, godot_variant*, double)(&value, number);
  append(array, value);
}

static void append_vector(godot_array* array, const double point[3]) {
  const godot_vector3 v = {(float)point[0], (float)point[1], (float)point[2]};
  godot_variant value;
  ENGINE(at_variant_new_vector3, void, godot_variant*, const godot_vector3*)(&value, &v);
  append(array, value);
}

static godot_variant array_variant(godot_array* array) {
  godot_variant value;
  ENGINE(at_variant_new_array, void, godot_variant*, const godot_array*)(&value, array);
  ENGINE(at_array_destroy, void, godot_array*)(array);
  return value;
}

/* ---- Meshes */

/* A corner of the engine's triangles, to be sorted by place. */
typedef struct {
  godot_vector3 at;
  size_t corner;
} corner_place;

static int by_place(const void* a, const void* b) {
  const godot_vector3 *p = &((const corner_place*)a)->at, *q = &((const corner_place*)b)->at;
  if (p->x != q->x) return p->x < q->x ? -1 : 1;
  if (p->y != q->y) return p->y < q->y ? -1 : 1;
  return p->z < q->z ? -1 : p->z > q->z;
}

/* A mesh of Kerf from three points for each triangle, as Mesh.get_faces() of Godot gives them:
 * corners at one place become one vertex, and triangles are turned, since Godot's are clockwise. */
static kerf_status mesh_of(const godot_vector3* points, size_t count, kerf_mesh* mesh) {
  corner_place* places = malloc((count + 1) * sizeof *places);
  double* vertices = malloc((3 * count + 1) * sizeof *vertices);
  uint32_t* faces = malloc((count + 1) * sizeof *faces);
  kerf_mesh_arrays arrays;
  kerf_status status;
  size_t i, used = 0;

  for (i = 0; places && i < count; ++i) {
    places[i].at = points[i];
    places[i].corner = i;
  }
  if (places) qsort(places, count, sizeof *places, by_place);
  for (i = 0; places && vertices && faces && i < count; ++i) {
    const size_t corner = places[i].corner, turned = corner - corner % 3 + 2 - corner % 3;
    if (i == 0 || by_place(&places[i - 1], &places[i]) != 0) {
      vertices[3 * used] = places[i].at.x;
      vertices[3 * used + 1] = places[i].at.y;
      vertices[3 * used + 2] = places[i].at.z;
      ++used;
    }
    faces[turned] = (uint32_t)(used - 1);
  }
  memset(&arrays, 0, sizeof arrays);
  arrays.vertices = vertices;
  arrays.vertices_length = 3 * used;
  arrays.faces = faces;
  arrays.faces_length = count;
  status = kerf_mesh_create(&arrays, mesh);
  free(places);
  free(vertices);
  free(faces);
  return status;
}

/* Points of a mesh as a pool of the engine: corners of its triangles, clockwise, or its vertices. Of
 * null there are none. */
static void append_points(godot_array* array, kerf_mesh mesh, bool corners) {
  kerf_mesh_arrays arrays;
  godot_vector3_pool pool;
  godot_variant value;
  size_t count, i;

  memset(&arrays, 0, sizeof arrays);
  if (mesh) good(kerf_mesh_get(mesh, &arrays));
  count = corners ? arrays.faces_length : arrays.vertices_length / 3;
  ENGINE(at_pool_new, void, godot_vector3_pool*)(&pool);
  ENGINE(at_pool_resize, void, godot_vector3_pool*, int)(&pool, (int)count);
  if (count > 0) {
    void* access = ENGINE(at_pool_write, void*, godot_vector3_pool*)(&pool);
    godot_vector3* to = ENGINE(at_pool_write_data, godot_vector3*, const void*)(access);
    for (i = 0; i < count; ++i) {
      const double* p = arrays.vertices + 3 * (corners ? arrays.faces[i - i % 3 + 2 - i % 3] : i);
      to[i].x = (float)p[0];
      to[i].y = (float)p[1];
      to[i].z = (float)p[2];
    }
    ENGINE(at_pool_write_destroy, void, void*)(access);
  }
  ENGINE(at_variant_new_pool, void, godot_variant*, const godot_vector3_pool*)(&value, &pool);
  ENGINE(at_pool_destroy, void, godot_vector3_pool*)(&pool);
  append(array, value);
}

/* ---- Procedures */

/* solid(triangles: PoolVector3Array) -> handle of a solid, or null */
godot_variant solid(godot_array* arguments) {
  kerf_mesh mesh = NULL;
  kerf_solid made = NULL;
  godot_variant value;
  godot_vector3_pool pool;
  void* access;

  if (!has_arguments(arguments, 1)) return nil();
  value = argument(arguments, 0);
  pool = ENGINE(at_variant_as_pool, godot_vector3_pool, const godot_variant*)(&value);
  access = ENGINE(at_pool_read, void*, const godot_vector3_pool*)(&pool);
  if (good(mesh_of(ENGINE(at_pool_read_data, const godot_vector3*, const void*)(access),
                   (size_t)ENGINE(at_pool_size, int, const godot_vector3_pool*)(&pool), &mesh)))
    good(kerf_solid_create(mesh, &made));
  kerf_free(mesh);
  ENGINE(at_pool_read_destroy, void, void*)(access);
  ENGINE(at_pool_destroy, void, godot_vector3_pool*)(&pool);
  forget(&value);
  return made ? integer((intptr_t)made) : nil();
}

/* hit(solid, point, direction, energy, milliseconds) -> handle of a break, or null */
godot_variant hit(godot_array* arguments) {
  double point[3], direction[3];
  int32_t finished;
  kerf_breaking breaking = NULL;

  if (!has_arguments(arguments, 5)) return nil();
  point_argument(arguments, 1, point);
  point_argument(arguments, 2, direction);
  good(kerf_break(handle_argument(arguments, 0), point, direction, real_argument(arguments, 3),
                  real_argument(arguments, 4), NULL, &breaking, &finished));
  return breaking ? integer((intptr_t)breaking) : nil();
}

/* go_on(break, milliseconds) -> 1: it is finished; 0: it is not; null: it is no break */
godot_variant go_on(godot_array* arguments) {
  int32_t finished = 0;
  if (!has_arguments(arguments, 2)) return nil();
  if (!good(kerf_break_continue(handle_argument(arguments, 0), real_argument(arguments, 1), &finished))) return nil();
  return integer(finished);
}

/* The part, its points, and those of its first hull. */
static godot_variant piece(kerf_breaking breaking, size_t index, const kerf_part* part) {
  kerf_mesh mesh = NULL, hull = NULL;
  godot_array array;

  ENGINE(at_array_new, void, godot_array*)(&array);
  append_real(&array, part->volume);
  append_vector(&array, part->centroid);
  good(kerf_breaking_mesh(breaking, index, &mesh));
  append_points(&array, mesh, true);
  kerf_free(mesh);
  if (part->hulls > 0) good(kerf_breaking_hull(breaking, index, 0, &hull));
  append_points(&array, hull, false);
  kerf_free(hull);
  return array_variant(&array);
}

/* pieces(break) -> array of [volume, centroid, corners of triangles, points of the hull], or null */
godot_variant pieces(godot_array* arguments) {
  kerf_breaking breaking;
  size_t count = 0, i;
  kerf_part part;
  godot_array array;

  if (!has_arguments(arguments, 1)) return nil();
  breaking = handle_argument(arguments, 0);
  if (!good(kerf_breaking_count(breaking, &count))) return nil();
  ENGINE(at_array_new, void, godot_array*)(&array);
  for (i = 0; i < count; ++i)
    if (good(kerf_breaking_part(breaking, i, &part)) && !part.divided) append(&array, piece(breaking, i, &part));
  return array_variant(&array);
}

/* release(handle) */
godot_variant release(godot_array* arguments) {
  if (has_arguments(arguments, 1)) good(kerf_free(handle_argument(arguments, 0)));
  return nil();
}

/* The engine calls these when it loads and unloads the library. */
void godot_gdnative_init(const godot_options* options);
void godot_gdnative_terminate(const void* options);
void godot_gdnative_init(const godot_options* options) { core = options->core; }
void godot_gdnative_terminate(const void* options) { (void)options; }
