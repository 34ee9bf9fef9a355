/* A knife goes down through a soft block, and a grip pulls a corner; positions come out each frame. */
#include <kerf.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void check(kerf_status status) {
  if (status == KERF_OK) return;
  fprintf(stderr, "%s: %s\n", kerf_status_name(status), kerf_last_message());
  exit(1);
}

/* Stops nothing; a program may return 0 here to stop the call. */
static int32_t tell(void* user, const char* phase, size_t done, size_t total) {
  (void)phase;
  (void)done;
  (void)total;
  ++*(size_t*)user;
  return 1;
}

int main(void) {
  static const char scene[] =
      "[[body]]\nname = \"block\"\nmesh = \"given\"\nnodes = 150\n"
      "[material]\nyoung = 3e4\n[ground]\npoint = [0, 0, 0]\n[time]\nstep = 0.02\n";
  const double size[3] = {1, 1, 1}, low[3] = {-1, -1, 0.8}, high[3] = {0.2, 2, 2}, edge[6] = {0.5, -1, 0, 0.5, 2, 0};
  const double corner[3] = {1, 1, 1};
  kerf_pose pose = {{0, 0, 1.1}, {1, 0, 0, 0}};
  kerf_mesh block, surface;
  kerf_simulation run;
  kerf_blade_options knife;
  kerf_frame frame;
  uint32_t blade, grip;
  size_t reports = 0, needed;
  uint64_t cut = 0;
  double* positions;
  int i;

  check(kerf_shape_block(size, 0.25, &block));
  check(kerf_simulation_create(scene, strlen(scene), NULL, &block, 1, tell, &reports, &run));
  check(kerf_blade_defaults(&knife));
  knife.points = edge;
  knife.points_length = 6;
  check(kerf_simulation_add_blade(run, &knife, &pose, &blade));
  check(kerf_simulation_add_grip(run, low, high, &grip));
  for (i = 0; i < 6; ++i) {
    pose.position[2] -= 0.2;
    check(kerf_simulation_move_blade(run, blade, &pose));
    check(kerf_simulation_step(run, tell, &reports, &frame));
    cut += frame.cut_edges;
  }
  check(kerf_simulation_end_grip(run, grip));
  check(kerf_simulation_step(run, tell, &reports, &frame)); /* a blade that is not moved is gone */
  check(kerf_simulation_strike(run, corner, 6));
  check(kerf_simulation_step(run, tell, &reports, &frame));
  check(kerf_simulation_positions(run, NULL, 0, &needed));
  positions = malloc(needed * sizeof *positions);
  if (!positions) return 1;
  check(kerf_simulation_positions(run, positions, needed, NULL));
  check(kerf_simulation_surface(run, &surface));
  check(kerf_mesh_save(surface, "cut.ply"));
  printf("%d frames, %u nodes, %u edges of the graph cut\n", frame.frame, (unsigned)(needed / 3), (unsigned)cut);
  free(positions);
  check(kerf_free(surface));
  check(kerf_free(run));
  check(kerf_free(block));
  return cut > 0 && reports > 0 ? 0 : 1;
}
