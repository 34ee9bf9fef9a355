// read_checkpoint() and write_checkpoint() of kerf/body_file.h. Sections run/… behind those of the
// body (docs/formats.md): motion, fronts and counts of a run. Doubles are stored as such, so that a
// run resumes exactly.
#include "kerf/body_file.h"

#include "io/body_sections.h"
#include "io/json_integer.h"
#include "kerf/files.h"
#include "kerf/vectors.h"
#include "simulation/fracture_front.h"

namespace geo {
namespace {

constexpr const char* portable_name = "portable";  // of vectors; files of runs with the widest do not name them

// Calls each(name, count) for the counts of a run.
template <class Work, class Each>
void counts(Work& w, const Each& each) {
  each("steps", w.steps);
  each("newton", w.newton);
  each("cg", w.cg);
  each("fronts", w.fronts);
  each("refused", w.refused);
  each("cracks_begun", w.fracture.begun);
  each("cracks_divided", w.fracture.divided);
  each("bonds_broken", w.fracture.broken);
  each("triangles_cut", w.split.crack.triangles_cut);
  each("edges_cut", w.split.edges_cut);
  each("touching", w.contact.touching);
  each("in_zones", w.contact.in_zones);
  each("held", w.contact.held);
  each("nodes_updated", w.split.nodes_updated);
  each("nodes_added", w.split.nodes_added);
  each("blows", w.blows);
  each("blow_parts", w.blow_parts);
}

nlohmann::ordered_json about_front(const FrontState& f, std::vector<Vec3>& places) {
  nlohmann::ordered_json segments = nlohmann::ordered_json::array();
  for (const auto& segment : f.segments) {
    nlohmann::ordered_json ids = nlohmann::ordered_json::array();
    for (const auto& p : segment) {
      ids.push_back(p.id.valid() ? static_cast<std::int64_t>(p.id.value) : -1);
      places.push_back(p.position);
    }
    segments.push_back(ids);
  }
  return {{"name", f.name}, {"closed", f.closed}, {"crack", f.crack}, {"step", f.step}, {"segments", segments}};
}

// Hands out values in order. Throws InputError where the file has too few.
template <class T>
class Supply {
 public:
  Supply(std::vector<T> values, const KerfFile& file) : values_(std::move(values)), file_(file) {}
  T next() {
    if (at_ >= values_.size()) file_.fail("a front of the run has fewer points than it says");
    return values_[at_++];
  }

 private:
  std::vector<T> values_;
  const KerfFile& file_;
  std::size_t at_ = 0;
};

FrontState front_from(const nlohmann::json& about, Supply<Vec3>& places, const KerfFile& file) {
  FrontState front;
  front.name = about.at("name").get<std::string>();
  front.closed = about.at("closed").get<bool>();
  front.crack = json_integer<std::int32_t>(about.at("crack"));
  front.step = json_integer<std::uint32_t>(about.at("step"));
  front.has_moved = front.step > 0;
  for (const auto& segment : about.at("segments")) {
    front.segments.emplace_back();
    for (const auto& id : segment) {
      const auto v = json_integer<std::int64_t>(id);
      front.segments.back().push_back(
          {places.next(), v < 0 || v > ~0u ? VertexId() : VertexId(static_cast<std::uint32_t>(v))});
    }
    // Ends at one place may be one point.
    if (front.segments.back().empty()) file.fail("a front of the run has a segment without ends");
    front.points.push_back(front.segments.back().front());
  }
  if (front.segments.empty()) file.fail("a front of the run is empty");
  if (!front.closed) front.points.push_back(front.segments.back().back());
  return front;
}

std::vector<Vec3> columns_of(const std::vector<Mat3>& matrices) {
  std::vector<Vec3> columns;
  for (const Mat3& m : matrices)
    for (int c = 0; c < 3; ++c) columns.push_back(m.col(c));
  return columns;
}

// The matrices of a section, by columns; none where the file does not have it.
std::vector<Mat3> read_matrices(const KerfFile& file, const std::string& section) {
  if (file.sections().count(section) == 0) return {};
  const auto columns = read_points(file, section);
  if (columns.size() % 3 != 0) file.fail("has an incomplete matrix in " + section);
  std::vector<Mat3> matrices(columns.size() / 3);
  for (std::size_t i = 0; i < columns.size(); ++i) matrices[i / 3].col(static_cast<int>(i % 3)) = columns[i];
  return matrices;
}

// The numbers of a bond that its faces do not give: cells, body, and whether it is broken; strength
// and toughness; the traction that holds its broken wall: crack, peak and opening, and the largest
// opening of each face so far.
struct GluedNumbers {
  std::vector<std::uint32_t> faces, bond_of_face, cells, cracks;
  std::vector<std::uint32_t> pace;
  std::vector<double> limits, laws, reached;

  explicit GluedNumbers(const GluedBonds& glued) : pace{glued.halvings, glued.calm} {
    for (std::uint32_t b = 0; b < glued.bonds.size(); ++b) {
      const GluedBond& bond = glued.bonds[b];
      for (const Triangle& face : bond.faces) {
        faces.insert(faces.end(), face.begin(), face.end());
        bond_of_face.push_back(b);
      }
      cells.insert(cells.end(), {bond.a, bond.b, bond.body, std::uint32_t(bond.broken)});
      limits.insert(limits.end(), {bond.strength, bond.toughness});
      const Cohesion& cohesion = bond.cohesion;
      cracks.push_back(static_cast<std::uint32_t>(cohesion.crack));
      laws.insert(laws.end(), {cohesion.peak, cohesion.opening});
      reached.insert(reached.end(), cohesion.reached.begin(), cohesion.reached.end());
      if (cohesion.crack == 0) reached.resize(reached.size() + bond.faces.size(), 0);
    }
  }
};

// `bond_of_face`: faces of a bond stand in their order. Older files have no tractions.
void read_cohesion(const KerfFile& file, std::span<const std::uint32_t> bond_of_face, GluedBonds& glued) {
  if (file.sections().count("run/glue_laws") == 0) return;
  const auto cracks = file.read<std::uint32_t>("run/glue_cracks");
  const auto pace = file.read<std::uint32_t>("run/glue_pace");
  if (pace.size() != 2 || pace[0] > max_halvings) file.fail("the time step of breaking bonds is none");
  glued.halvings = pace[0];
  glued.calm = pace[1];
  const auto laws = file.read<double>("run/glue_laws", 2), reached = file.read<double>("run/glue_reached");
  if (cracks.size() != glued.bonds.size() || laws.size() != 2 * cracks.size() || reached.size() != bond_of_face.size())
    file.fail("the sections of glued bonds have different lengths");
  for (std::size_t f = 0; f < reached.size(); ++f) {
    Cohesion& cohesion = glued.bonds[bond_of_face[f]].cohesion;
    if (cracks[bond_of_face[f]] != 0) cohesion.reached.push_back(reached[f]);
  }
  for (std::size_t b = 0; b < cracks.size(); ++b) {
    Cohesion& cohesion = glued.bonds[b].cohesion;
    cohesion.crack = static_cast<std::int32_t>(cracks[b]);
    cohesion.peak = laws[2 * b];
    cohesion.opening = laws[2 * b + 1];
    const bool is_law = cohesion.peak > 0 && cohesion.opening > 0 && std::isfinite(cohesion.peak * cohesion.opening);
    const bool is_open = std::all_of(cohesion.reached.begin(), cohesion.reached.end(), [](double r) { return r > 0; });
    if (cohesion.crack != 0 && (!is_law || !is_open)) file.fail("a broken bond has a traction that is not positive");
  }
}

GluedBonds read_glued(const KerfFile& file) {
  GluedBonds glued;
  if (file.sections().count("run/glue_points") == 0) return glued;
  glued.points = read_points(file, "run/glue_points");
  const auto faces = file.read<std::uint32_t>("run/glue_faces", 3), of = file.read<std::uint32_t>("run/glue_bonds");
  const auto cells = file.read<std::uint32_t>("run/glue_cells", 4);
  const auto limits = file.read<double>("run/glue_limits", 2);
  glued.bonds.resize(cells.size() / 4);
  if (faces.size() != 3 * of.size() || limits.size() != 2 * glued.bonds.size())
    file.fail("the sections of glued bonds have different lengths");
  for (std::size_t f = 0; f < of.size(); ++f) {
    const Triangle face{faces[3 * f], faces[3 * f + 1], faces[3 * f + 2]};
    if (of[f] >= glued.bonds.size() || *std::max_element(face.begin(), face.end()) >= glued.points.size())
      file.fail("a glued bond has a face or a point that is not there");
    glued.bonds[of[f]].faces.push_back(face);
  }
  for (std::size_t b = 0; b < glued.bonds.size(); ++b) {
    GluedBond& bond = glued.bonds[b];
    bond.a = cells[4 * b];
    bond.b = cells[4 * b + 1];
    bond.body = cells[4 * b + 2];
    bond.broken = cells[4 * b + 3] != 0;
    bond.strength = limits[2 * b];
    bond.toughness = limits[2 * b + 1];
    if (!(bond.strength > 0) || !(bond.toughness >= 0)) file.fail("a glued bond has no strength");
    measure(bond, glued.points);
  }
  read_cohesion(file, of, glued);
  return glued;
}

}  // namespace

void write_checkpoint(std::ostream& out, const Body& body, const RunState& state, std::uint64_t scene) {
  std::vector<Vec3> places;
  std::vector<double> at;
  nlohmann::ordered_json about = {{"frame", state.frame},
                                  {"scene", scene},
                                  {"fronts", nlohmann::ordered_json::array()},
                                  {"counts", nlohmann::ordered_json::object()}};
  if (vectors() == Vectors::portable) about["vectors"] = portable_name;
  for (const auto& blade : state.fronts) {
    about["fronts"].push_back(nlohmann::ordered_json::array());
    for (const EdgeFront& edge : blade) {
      about["fronts"].back().push_back(about_front(edge.front, places));
      about["fronts"].back().back()["left"] = edge.is_left;
      at.insert(at.end(), edge.at.begin(), edge.at.end());
    }
  }
  // Fronts of fracture have a normal for each point, and (owed, ended, length of the front).
  about["cracks"] = state.fracture.cracks;
  about["growing"] = nlohmann::ordered_json::array();
  std::vector<Vec3> normals, owed;
  for (const GrowingFront& g : state.fracture.fronts) {
    about["growing"].push_back(about_front(g.front, places));
    for (std::size_t i = 0; i < g.size(); ++i) {
      normals.push_back(g.normal[i]);
      owed.push_back({g.owed[i], double(g.ended[i]), g.length});
    }
  }
  counts(state.total, [&](const char* name, std::size_t n) { about["counts"][name] = n; });
  const std::string text = about.dump();
  std::vector<KerfArray> more{kerf_array("run/displacement", coordinates(state.motion.displacement), 3),
                              kerf_array("run/velocity", coordinates(state.motion.velocity), 3),
                              kerf_array("run/part", std::span(state.body_index)),
                              kerf_array("run/surface", coordinates(state.surface), 3),
                              kerf_array("run/front_points", coordinates(places), 3),
                              kerf_array("run/front_at", std::span<const double>(at)),
                              kerf_array("run/front_normals", coordinates(normals), 3),
                              kerf_array("run/front_owed", coordinates(owed), 3),
                              kerf_array("run/time", std::span(&state.time, 1))};
  if (!state.motion.acceleration.empty())
    more.push_back(kerf_array("run/acceleration", coordinates(state.motion.acceleration), 3));
  if (!state.motion.smooth.empty())
    more.push_back(kerf_array("run/smooth", std::span<const std::uint8_t>(state.motion.smooth)));
  if (!state.rest.time.empty()) {
    more.push_back(kerf_array("run/rest_anchor", coordinates(state.rest.anchor), 3));
    more.push_back(kerf_array("run/rest_time", std::span<const double>(state.rest.time)));
  }
  const std::vector<Vec3> plastic = columns_of(state.motion.plastic), rotation = columns_of(state.motion.rotation),
                          prestretch = columns_of(state.motion.prestretch);
  if (!plastic.empty()) more.push_back(kerf_array("run/plastic", coordinates(plastic), 3));
  if (!prestretch.empty()) more.push_back(kerf_array("run/prestretch", coordinates(prestretch), 3));
  const GluedNumbers glued(state.glued);
  if (!state.glued.bonds.empty()) {
    more.push_back(kerf_array("run/glue_points", coordinates(state.glued.points), 3));
    more.push_back(kerf_array("run/glue_faces", std::span(glued.faces), 3));
    more.push_back(kerf_array("run/glue_bonds", std::span(glued.bond_of_face)));
    more.push_back(kerf_array("run/glue_cells", std::span(glued.cells), 4));
    more.push_back(kerf_array("run/glue_limits", std::span<const double>(glued.limits), 2));
    more.push_back(kerf_array("run/glue_pace", std::span(glued.pace)));
    more.push_back(kerf_array("run/glue_cracks", std::span(glued.cracks)));
    more.push_back(kerf_array("run/glue_laws", std::span<const double>(glued.laws), 2));
    more.push_back(kerf_array("run/glue_reached", std::span<const double>(glued.reached)));
  }
  if (!rotation.empty()) more.push_back(kerf_array("run/rotation", coordinates(rotation), 3));
  more.push_back({.name = "run/about", .dtype = "json", .shape = {text.size()}, .fill = [&text](KerfSink& sink) {
                    sink.write(std::as_bytes(std::span(text)));
                  }});
  write_body_with(out, body, more);
}

Checkpoint read_checkpoint(const KerfFile& file) {
  if (file.sections().count("run/about") == 0) file.fail("is no checkpoint of a run");
  Checkpoint c{.body = read_body(file), .state = {}};
  RunState& state = c.state;
  state.motion.displacement = read_points(file, "run/displacement");
  state.motion.velocity = read_points(file, "run/velocity");
  if (file.sections().count("run/acceleration") != 0) state.motion.acceleration = read_points(file, "run/acceleration");
  if (file.sections().count("run/smooth") != 0) state.motion.smooth = file.read<std::uint8_t>("run/smooth");
  state.motion.plastic = read_matrices(file, "run/plastic");
  state.motion.rotation = read_matrices(file, "run/rotation");
  state.motion.prestretch = read_matrices(file, "run/prestretch");
  state.surface = read_points(file, "run/surface");
  if (file.sections().count("run/rest_time") != 0) {
    state.rest = {.anchor = read_points(file, "run/rest_anchor"), .time = file.read<double>("run/rest_time")};
    if (state.rest.anchor.size() != state.rest.time.size() || state.rest.time.size() > c.body.nodes.size())
      file.fail("the sections of rest have different lengths");
    if (std::any_of(state.rest.time.begin(), state.rest.time.end(), [](double t) { return !(t >= 0); }))
      file.fail("a node has rested for less than no time");
  }
  state.glued = read_glued(file);
  state.body_index = file.read<std::uint32_t>("run/part");
  const auto time = file.read<double>("run/time");
  const std::size_t n = c.body.nodes.size();
  if (time.size() != 1 || !std::isfinite(time[0]) || state.motion.displacement.size() != n ||
      state.motion.velocity.size() != n || state.body_index.size() != n)
    file.fail("the sections of the run have different lengths");
  const std::size_t smooth = state.motion.smooth.size();
  if (smooth != 0 && (smooth != n || state.motion.acceleration.size() != n))
    file.fail("the sections of the motion have different lengths");
  state.time = time[0];
  Supply<Vec3> places(read_points(file, "run/front_points"), file),
      normals(read_points(file, "run/front_normals"), file), owed(read_points(file, "run/front_owed"), file);
  Supply<double> at(file.read<double>("run/front_at"), file);
  const auto about = nlohmann::json::parse(file.text("run/about"), nullptr, false);
  try {
    state.frame = json_integer<int>(about.at("frame"));
    c.scene = json_integer<std::uint64_t>(about.at("scene"));
    if (about.value("vectors", "") == portable_name) c.vectors = Vectors::portable;
    for (const auto& blade : about.at("fronts")) {
      state.fronts.emplace_back();
      for (const auto& front : blade) {
        EdgeFront edge{.front = front_from(front, places, file), .at = {}, .is_left = front.value("left", false)};
        for (std::size_t i = 0; i < edge.front.points.size(); ++i) edge.at.push_back(at.next());
        state.fronts.back().push_back(std::move(edge));
      }
    }
    state.fracture.cracks = json_integer<std::int32_t>(about.at("cracks"));
    for (const auto& f : about.at("growing")) {
      FrontState front = front_from(f, places, file);
      std::vector<Vec3> normal;
      for (std::size_t i = 0; i < front.points.size(); ++i) normal.push_back(normals.next());
      GrowingFront g = growing(std::move(front), std::move(normal));
      for (std::size_t i = 0; i < g.size(); ++i) {
        const Vec3 row = owed.next();
        g.owed[i] = row.x();
        g.ended[i] = row.y() != 0;
        g.length = row.z();
      }
      state.fracture.fronts.push_back(std::move(g));
    }
    counts(state.total, [&](const char* name, std::size_t& count) {
      const auto& known = about.at("counts");
      count = known.contains(name) ? json_integer<std::size_t>(known.at(name)) : 0;  // older files lack some
    });
  } catch (const nlohmann::json::exception&) {
    file.fail("section 'run/about' is malformed");
  } catch (const std::out_of_range&) {
    file.fail("section 'run/about' holds an impossible value");
  }
  return c;
}

}  // namespace geo
