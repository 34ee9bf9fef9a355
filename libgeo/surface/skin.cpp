// Faces in the order of their ids.
#include "surface/skin.h"

namespace geo {

TriangleMesh skin_of(const Complex& complex) {
  TriangleMesh skin;
  for (std::uint32_t v = 0; v < complex.vertex_count(); ++v) skin.vertices.push_back(complex.point(VertexId(v)));
  for (std::uint32_t f = 0; f < complex.face_count(); ++f) {
    const auto& face = complex.face(FaceId(f));
    if (face.alive && face.crack == 0) skin.triangles.push_back({face.v[0].value, face.v[1].value, face.v[2].value});
  }
  return skin;
}

}  // namespace geo
