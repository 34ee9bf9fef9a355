// Writes a surface and a body, reads the body back, and shows the error for a damaged file.
#include <cstdio>
#include <fstream>
#include <sstream>

#include <kerf/body.h>
#include <kerf/body_file.h>
#include <kerf/error.h>
#include <kerf/files.h>
#include <kerf/mesh.h>
#include <kerf/nodes.h>

int main() {
  const geo::TriangleMesh solid = geo::make_sphere(4);
  const geo::Body body = geo::build_body(geo::Complex::from_skin(solid), geo::sample_nodes(solid, {.spacing = 0.3}));
  {
    std::ofstream surface("sphere.ply", std::ios::binary), graph("sphere.kerf", std::ios::binary);
    geo::write_ply(surface, solid);
    geo::write_body(graph, body);
  }
  const geo::Body again = geo::read_body("sphere.kerf");
  std::printf("%zu nodes, %zu edges, read back %s\n", again.nodes.size(), again.graph.edge_count(),
              again.graph == body.graph ? "equal" : "DIFFERENT");

  std::ostringstream bytes;
  geo::write_body(bytes, body);
  std::string damaged = bytes.str();
  damaged[damaged.size() / 2] ^= 1;
  try {
    geo::parse_body(damaged, "damaged.kerf");
  } catch (const geo::InputError& e) {
    std::printf("%s\n", e.what());
    return again.graph == body.graph ? 0 : 1;
  }
  return 1;
}
