/* A cube of two materials is hit. It breaks within a few milliseconds a frame, one of its pieces
 * breaks again, and all pieces are written: piece_01.ply and so on. */
#include <kerf.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Ends the program where a call fails. */
static void check(kerf_status status) {
  if (status == KERF_OK) return;
  fprintf(stderr, "%s: %s\n", kerf_status_name(status), kerf_last_message());
  exit(1);
}

/* A cube from 0 to 1 with texture coordinates; its lower half is stone, its upper half wood. */
static kerf_mesh make_cube(void) {
  static const char* const names[] = {"stone", "wood"};
  const double size[3] = {1, 1, 1};
  kerf_mesh block, cube;
  kerf_mesh_arrays arrays;
  double* uv;
  int32_t* groups;
  size_t corner;

  check(kerf_shape_block(size, 0.125, &block));
  check(kerf_mesh_get(block, &arrays));
  uv = malloc(2 * arrays.faces_length * sizeof *uv);
  groups = calloc(arrays.faces_length / 3, sizeof *groups);
  if (!uv || !groups) exit(1);
  for (corner = 0; corner < arrays.faces_length; ++corner) {
    const double* p = arrays.vertices + 3 * arrays.faces[corner];
    uv[2 * corner] = p[0] + p[1];
    uv[2 * corner + 1] = p[2];
    if (p[2] > 0.5) groups[corner / 3] = 1;
  }
  arrays.uv = uv;
  arrays.uv_length = 2 * arrays.faces_length;
  arrays.groups = groups;
  arrays.groups_length = arrays.faces_length / 3;
  arrays.group_names = names;
  arrays.group_names_length = 2;
  check(kerf_mesh_create(&arrays, &cube));
  free(uv);
  free(groups);
  check(kerf_free(block));
  return cube;
}

/* Breaks a solid, 4 ms a frame. */
static kerf_breaking hit(kerf_solid solid, const double point[3], double energy) {
  const double direction[3] = {0, 0, -1};
  kerf_breaking breaking;
  int32_t finished;
  int frames = 1;

  check(kerf_break(solid, point, direction, energy, 4, NULL, &breaking, &finished));
  for (; !finished; ++frames) check(kerf_break_continue(breaking, 4, &finished));
  printf("finished after %d frames\n", frames);
  return breaking;
}

/* Writes the pieces, and returns their volume. The largest one is number `*largest`. */
static double write_pieces(kerf_breaking breaking, size_t* largest) {
  double volume = 0, most = 0;
  size_t count, i;

  check(kerf_breaking_count(breaking, &count));
  for (i = 0; i < count; ++i) {
    char name[64];
    kerf_part part;
    kerf_mesh mesh;

    check(kerf_breaking_part(breaking, i, &part));
    if (part.divided) continue;
    check(kerf_breaking_mesh(breaking, i, &mesh));
    snprintf(name, sizeof name, "piece_%02u.ply", (unsigned)i);
    check(kerf_mesh_save(mesh, name));
    check(kerf_free(mesh));
    volume += part.volume;
    if (part.volume > most) {
      most = part.volume;
      *largest = i;
    }
  }
  return volume;
}

int main(void) {
  const double corner[3] = {0.2, 0.2, 1};
  kerf_mesh cube = make_cube();
  kerf_solid solid, part;
  kerf_breaking first, second;
  double volume, again;
  size_t largest = 0, smaller = 0;
  kerf_part whole;

  printf("Kerf %s\n", kerf_version());
  check(kerf_solid_create(cube, &solid));
  first = hit(solid, corner, 700);
  volume = write_pieces(first, &largest);
  check(kerf_breaking_part(first, largest, &whole));

  /* A piece breaks again as any solid does. */
  check(kerf_breaking_solid(first, largest, &part));
  second = hit(part, whole.centroid, 300);
  again = write_pieces(second, &smaller);
  printf("volume %.6f of 1, and %.6f of %.6f\n", volume, again, whole.volume);

  check(kerf_free(second));
  check(kerf_free(part));
  check(kerf_free(first));
  check(kerf_free(solid));
  check(kerf_free(cube));
  return volume > 1 - 1e-9 && volume < 1 + 1e-9 && again > 0.999999 * whole.volume && again < 1.000001 * whole.volume
             ? 0
             : 1;
}
