// Every function of kerf.h with random arguments, most of them bad: a status comes back, and the
// program goes on. Handles are null, freed, made up, of other kinds, or good. tests/c/symbols fails
// where a function is not called here.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "base/random.h"
#include "cases.h"
#include "kerf.h"

namespace {

using geo::Random;

constexpr const char* scene =
    "[[body]]\nmesh = \"given\"\nnodes = 40\n[material]\nyoung = 1e4\n[ground]\npoint = [0, 0, 0]\n"
    "[[blade]]\nname = \"knife\"\npoints = [[0, 0, 0], [1, 0, 0]]\nkeys = [[0, 0, 0, 5, 0, 0, 1, 0], [1, 0, 0, 5, 0, "
    "0, 1, 0]]\n"
    "[time]\nstep = 0.03\n";

// Arguments, drawn at random. All that they point to lives until the next case.
class Arguments {
 public:
  explicit Arguments(Random& random) : random_(random) {}

  template <class T>
  T one_of(std::initializer_list<T> values) {
    return values.begin()[random_.below(static_cast<std::uint32_t>(values.size()))];
  }
  double number() {
    const double infinity = std::numeric_limits<double>::infinity();
    return random_.below(3) ? random_.uniform(-1, 2)
                            : one_of({0.0, -1.0, 1e-300, 1e300, 1e60, infinity, -infinity, std::nan(""), 1e9});
  }
  // Null at times.
  const double* numbers(std::size_t count) {
    if (random_.below(12) == 0) return nullptr;
    auto& values = doubles_.emplace_back(count);
    const bool good = random_.below(2) == 0;
    for (double& x : values) x = good ? random_.uniform(-0.2, 1.2) : number();
    return values.data();
  }
  std::int32_t integer() { return one_of({0, 0, 1, 1, 2, 3, 7, -1, 1000, INT32_MIN, INT32_MAX}); }
  std::uint32_t index() { return one_of<std::uint32_t>({0, 0, 0, 1, 2, 5, 1000, UINT32_MAX}); }
  const char* text() {
    if (random_.below(12) == 0) return nullptr;
    auto& text = texts_.emplace_back();
    if (random_.below(2))
      return one_of(
          {"", "-", "ply", "glb", "obj", "stl", "off", "usda", "knife", "/nowhere/a.ply", "\xff\xfe", "%s%n"});
    for (std::uint32_t i = random_.below(20); i > 0; --i) text += static_cast<char>(1 + random_.below(255));
    return text.c_str();
  }
  const std::uint8_t* bytes(std::size_t& length) {
    auto& text = texts_.emplace_back(
        one_of<std::string>({"", "solid a\nfacet", "ply\nformat ascii 1.0\nelement vertex 3\n", "glTF\2\0\0\0",
                             "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
                             "front a\nstep 0\n0 0 0\n1 0 0\nstep 1\n0 0 1\n1 0 1\n", "[[body]]\nmesh = 3\n"}));
    for (std::uint32_t i = random_.below(4); i > 0 && !text.empty(); --i)
      text[random_.below(static_cast<std::uint32_t>(text.size()))] = static_cast<char>(random_.below(256));
    length = text.size();
    return random_.below(12) ? reinterpret_cast<const std::uint8_t*>(text.data()) : nullptr;
  }
  template <class T>
  T* out(T& place) {
    return random_.below(12) ? &place : nullptr;
  }
  kerf_pose* pose() {
    if (random_.below(12) == 0) return nullptr;
    for (double& x : pose_.position) x = number();
    for (double& x : pose_.rotation) x = number();
    return &pose_;
  }
  Random& random() { return random_; }

 private:
  Random& random_;
  std::vector<std::vector<double>> doubles_;
  std::vector<std::string> texts_ = std::vector<std::string>();
  kerf_pose pose_{};

 public:
  // References to elements stay valid.
  void reserve() {
    doubles_.reserve(64);
    texts_.reserve(64);
  }
};

// Handles that calls have made; some are freed.
class Handles {
 public:
  explicit Handles(Random& random) : random_(random) {}
  ~Handles() {
    for (void* handle : live_) kerf_free(handle);
  }
  void add(void* handle) {
    if (!handle) return;
    live_.push_back(handle);
    if (live_.size() > 60) end(random_.below(static_cast<std::uint32_t>(live_.size())));
  }
  void keep(void* handle) { live_.push_back(handle); }
  template <class H>
  H any() {
    const std::uint32_t kind = random_.below(16);
    if (kind == 0) return nullptr;
    if (kind == 1) return reinterpret_cast<H>(static_cast<std::uintptr_t>(random_.bits()));
    if (kind == 2 && !freed_.empty())
      return static_cast<H>(freed_[random_.below(static_cast<std::uint32_t>(freed_.size()))]);
    if (live_.empty()) return nullptr;
    return static_cast<H>(live_[random_.below(static_cast<std::uint32_t>(live_.size()))]);
  }
  void end(std::size_t i) {
    kerf_free(live_[i]);
    freed_.push_back(live_[i]);
    live_.erase(live_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  std::size_t count() const { return live_.size(); }

 private:
  Random& random_;
  std::vector<void*> live_, freed_;
};

int32_t stops_at_times(void* user, const char*, size_t, size_t) { return static_cast<Random*>(user)->below(50) != 0; }

using Call = std::function<kerf_status(Arguments&, Handles&)>;

// Keeps a handle that a call has made.
template <class H>
kerf_status made(kerf_status status, H handle, Handles& handles) {
  CHECK((status == KERF_OK || handle == nullptr));
  handles.add(handle);
  return status;
}

kerf_score_options score_options(Arguments& a) {
  kerf_score_options o;
  kerf_score_defaults(&o);
  o.pattern = a.one_of({0, 1, 2, 3, 4, 5, 6, 7, -1, 99});
  o.pieces = a.one_of({1, 2, 3, 5, 0, -4, INT32_MAX});
  o.attempts = a.one_of({1, 2, 3, 0, INT32_MIN});
  if (a.random().below(3) == 0) o.jagged = a.one_of({0.01, std::nan(""), -1.0, 1e9});
  if (a.random().below(4) == 0) o.cluster = a.number();
  if (a.random().below(4) == 0) o.grain = a.number();
  if (a.random().below(4) == 0) o.depth = a.number();
  if (a.random().below(4) == 0) o.frequency = a.one_of({1.0, 4.0, std::nan(""), 0.0, 1e300});
  if (a.random().below(3) == 0) o.chips = a.one_of({1, 3, -1, INT32_MAX});
  if (a.random().below(4) == 0) o.chip_size = a.one_of({0.2, 0.0, -1.0, std::nan("")});
  if (a.random().below(4) == 0) o.edge_detail = a.one_of({0.01, -1.0, std::nan(""), 1e9});
  if (a.random().below(4) == 0) o.edge_width = a.one_of({0.05, 0.0, std::nan("")});
  if (a.random().below(4) == 0) {
    o.density = a.numbers(8);
    o.density_length = a.one_of<std::size_t>({8, 0, 7});
  }
  static const std::uint8_t pixels[16] = {};
  if (a.random().below(4) == 0) o.image = pixels;
  o.image_width = a.one_of({4, 2, 0, -1});
  o.image_height = a.one_of({4, 1, 0});
  o.has_axis = a.one_of({0, 1, 2});
  o.has_impact = a.one_of({0, 1, -7});
  for (double& x : o.axis) x = a.number();
  for (double& x : o.impact) x = a.number();
  return o;
}

std::vector<Call> mesh_calls() {
  return {[](Arguments& a, Handles& h) {
            kerf_mesh_arrays arrays{};
            std::vector<std::uint32_t> faces(3 * a.random().below(5));
            for (auto& f : faces) f = a.random().below(10) ? a.random().below(8) : a.index();
            std::vector<std::int32_t> groups(faces.size() / 3);
            for (auto& g : groups) g = a.integer();
            const char* names[2] = {a.text(), "b\nc"};
            arrays.vertices_length = a.one_of<std::size_t>({24, 24, 24, 23, 0, 3});
            arrays.vertices = a.numbers(24);
            arrays.faces = a.random().below(10) ? faces.data() : nullptr;
            arrays.faces_length = faces.size() - (a.random().below(5) == 0 && !faces.empty());
            arrays.uv = a.random().below(2) ? a.numbers(2 * faces.size()) : nullptr;
            arrays.uv_length = a.random().below(2) ? 2 * faces.size() : 0;
            arrays.normals = a.random().below(4) == 0 ? a.numbers(3 * faces.size()) : nullptr;
            arrays.normals_length = a.random().below(4) == 0 ? 3 * faces.size() : 0;
            arrays.groups = groups.data();
            arrays.groups_length = a.random().below(2) ? groups.size() : 0;
            arrays.group_names = names;
            arrays.group_names_length = a.random().below(3);
            arrays.unit = a.random().below(4) ? 0 : a.number();
            kerf_mesh mesh = nullptr;
            return made(kerf_mesh_create(a.out(arrays), a.out(mesh)), mesh, h);
          },
          [](Arguments& a, Handles& h) {
            kerf_mesh_arrays arrays;
            const kerf_status status = kerf_mesh_get(h.any<kerf_mesh>(), a.out(arrays));
            return status;
          },
          [](Arguments& a, Handles& h) {
            kerf_mesh mesh = nullptr;
            return made(kerf_mesh_load(a.text(), a.out(mesh)), mesh, h);
          },
          [](Arguments& a, Handles& h) {
            std::size_t length = 0;
            const auto* bytes = a.bytes(length);
            kerf_mesh mesh = nullptr;
            return made(kerf_mesh_parse(bytes, length, a.text(), a.out(mesh)), mesh, h);
          },
          [](Arguments& a, Handles& h) {
            return kerf_mesh_save(h.any<kerf_mesh>(),
                                  a.one_of<const char*>({nullptr, "", "-", "/nowhere/a.ply", "a.unknown"}));
          },
          [](Arguments& a, Handles& h) {
            kerf_bytes bytes = nullptr;
            return made(kerf_mesh_write(h.any<kerf_mesh>(), a.text(), a.out(bytes)), bytes, h);
          },
          [](Arguments& a, Handles& h) {
            const std::uint8_t* data = nullptr;
            std::size_t length = 0;
            return kerf_bytes_data(h.any<kerf_bytes>(), a.out(data), a.out(length));
          },
          [](Arguments& a, Handles& h) {
            kerf_measures measures;
            return kerf_mesh_measures(h.any<kerf_mesh>(), a.out(measures));
          },
          [](Arguments& a, Handles& h) {
            kerf_report report;
            return kerf_mesh_check(h.any<kerf_mesh>(), a.integer(), a.out(report));
          },
          [](Arguments& a, Handles& h) {
            kerf_mesh solid = nullptr;
            return made(kerf_mesh_repaired(h.any<kerf_mesh>(), a.one_of({0.0, 1e-3, -1.0, std::nan("")}), a.integer(),
                                           a.out(solid)),
                        solid, h);
          },
          [](Arguments& a, Handles& h) {
            kerf_mesh refined = nullptr;
            return made(kerf_mesh_refine(h.any<kerf_mesh>(), a.one_of({0.4, 1.0, 0.0, -1.0, std::nan(""), 1e300}),
                                         a.out(refined)),
                        refined, h);
          },
          [](Arguments& a, Handles& h) {
            kerf_mesh hulls[4] = {};
            std::size_t count = 0;
            const kerf_status status = kerf_mesh_convex_decomposition(
                h.any<kerf_mesh>(), a.one_of<std::size_t>({0, 1, 4, SIZE_MAX}),
                a.one_of<std::size_t>({0, 4, 16, SIZE_MAX}), a.random().below(12) ? hulls : nullptr, a.out(count));
            if (status == KERF_OK)
              for (std::size_t i = 0; i < count; ++i) h.add(hulls[i]);
            return status;
          },
          [](Arguments& a, Handles& h) {
            kerf_mesh mesh = nullptr;
            const double size[3] = {a.number(), a.number(), a.number()};
            return made(kerf_shape_block(a.random().below(9) ? size : nullptr,
                                         a.one_of({0.5, 1.0, 0.0, std::nan(""), 1e-300}), a.out(mesh)),
                        mesh, h);
          },
          [](Arguments& a, Handles& h) {
            kerf_mesh mesh = nullptr;
            return made(kerf_shape_sphere(a.one_of({1, 3, 0, -1, INT32_MAX}), a.out(mesh)), mesh, h);
          },
          [](Arguments& a, Handles& h) {
            kerf_mesh mesh = nullptr;
            return made(kerf_shape_pumpkin(a.one_of({1, 3, 0, -1, INT32_MAX}), a.out(mesh)), mesh, h);
          }};
}

std::vector<Call> crack_calls() {
  return {
      [](Arguments& a, Handles& h) {
        kerf_complex complex = nullptr;
        return made(kerf_complex_create(h.any<kerf_mesh>(), a.out(complex)), complex, h);
      },
      [](Arguments& a, Handles& h) {
        kerf_complex copy = nullptr;
        return made(kerf_complex_copy(h.any<kerf_complex>(), a.out(copy)), copy, h);
      },
      [](Arguments& a, Handles& h) {
        kerf_mesh surface = nullptr;
        return made(kerf_complex_surface(h.any<kerf_complex>(), a.out(surface)), surface, h);
      },
      [](Arguments& a, Handles& h) {
        kerf_report report;
        return kerf_complex_check(h.any<kerf_complex>(), a.integer(), a.out(report));
      },
      [](Arguments& a, Handles& h) {
        kerf_complex_counts counts;
        return kerf_complex_count(h.any<kerf_complex>(), a.out(counts));
      },
      [](Arguments& a, Handles&) {
        kerf_score_options options;
        return kerf_score_defaults(a.out(options));
      },
      [](Arguments& a, Handles& h) {
        kerf_score_options options = score_options(a);
        kerf_mesh sheet = nullptr;
        std::uint32_t pieces = 0;
        return made(
            kerf_score(h.any<kerf_complex>(), a.out(options), stops_at_times, &a.random(), a.out(sheet), a.out(pieces)),
            sheet, h);
      },
      [](Arguments&, Handles& h) { return kerf_complex_insert(h.any<kerf_complex>(), h.any<kerf_mesh>()); },
      [](Arguments& a, Handles& h) {
        return kerf_complex_cut_plane(h.any<kerf_complex>(), a.numbers(3), a.numbers(3));
      },
      [](Arguments& a, Handles& h) {
        return kerf_complex_crack_file(h.any<kerf_complex>(), a.text(), nullptr, nullptr);
      },
      [](Arguments& a, Handles& h) {
        std::size_t length = 0;
        const auto* bytes = a.bytes(length);
        return kerf_complex_crack_bytes(h.any<kerf_complex>(), bytes, length, a.text(), stops_at_times, &a.random());
      },
      [](Arguments&, Handles& h) { return kerf_complex_undo(h.any<kerf_complex>()); },
      [](Arguments& a, Handles& h) {
        return kerf_complex_join_small_pieces(h.any<kerf_complex>(), a.one_of({0.0, 0.01, -1.0, std::nan("")}));
      },
      [](Arguments& a, Handles& h) {
        return kerf_complex_remesh(h.any<kerf_complex>(), a.one_of({15.0, 0.0, 90.0, std::nan("")}), nullptr, nullptr);
      },
      [](Arguments& a, Handles& h) {
        return kerf_complex_roughen(h.any<kerf_complex>(), a.one_of({0.01, 0.0, -1.0, std::nan("")}),
                                    a.one_of({2.0, 1e9, std::nan("")}), a.one_of<std::uint64_t>({1, ~0ull}), nullptr,
                                    nullptr);
      },
      [](Arguments& a, Handles& h) {
        return kerf_complex_decimate(h.any<kerf_complex>(), a.one_of({1e-3, 0.0, 2.0, std::nan("")}),
                                     a.one_of<std::size_t>({0, 100, ~std::size_t(0)}), nullptr, nullptr);
      },
      [](Arguments& a, Handles& h) {
        kerf_front front = nullptr;
        return made(kerf_front_begin(h.any<kerf_complex>(), a.numbers(9), a.one_of<std::size_t>({9, 6, 3, 0, 7}),
                                     a.integer(), a.out(front)),
                    front, h);
      },
      [](Arguments& a, Handles& h) {
        std::size_t faces = 0;
        return kerf_front_advance(h.any<kerf_front>(), a.numbers(9), a.one_of<std::size_t>({9, 6, 3, 0, 7}),
                                  a.out(faces));
      },
      [](Arguments& a, Handles& h) {
        kerf_pieces pieces = nullptr;
        return made(kerf_complex_pieces(h.any<kerf_complex>(), a.out(pieces)), pieces, h);
      },
      [](Arguments& a, Handles& h) {
        kerf_score_options options = score_options(a);
        kerf_pieces pieces = nullptr;
        return made(kerf_fracture(h.any<kerf_mesh>(), a.out(options), stops_at_times, &a.random(), a.out(pieces)),
                    pieces, h);
      },
      [](Arguments& a, Handles& h) {
        std::size_t count = 0;
        return kerf_pieces_count(h.any<kerf_pieces>(), a.out(count));
      },
      [](Arguments& a, Handles& h) {
        kerf_piece piece;
        return kerf_pieces_get(h.any<kerf_pieces>(), a.index(), a.out(piece));
      },
      [](Arguments& a, Handles& h) {
        kerf_mesh mesh = nullptr;
        return made(kerf_pieces_mesh(h.any<kerf_pieces>(), a.index(), a.out(mesh)), mesh, h);
      },
      [](Arguments& a, Handles& h) {
        const kerf_bond* bonds = nullptr;
        std::size_t length = 0;
        return kerf_pieces_bonds(h.any<kerf_pieces>(), a.out(bonds), a.out(length));
      },
      [](Arguments& a, Handles& h) {
        return kerf_pieces_save(h.any<kerf_pieces>(),
                                a.one_of<const char*>({nullptr, "", "-", "/nowhere/a.glb", "a.unknown"}));
      },
      [](Arguments& a, Handles& h) {
        kerf_bytes bytes = nullptr;
        return made(kerf_pieces_write(h.any<kerf_pieces>(), a.text(), a.out(bytes)), bytes, h);
      }};
}

std::vector<Call> impact_calls() {
  return {
      [](Arguments& a, Handles& h) {
        kerf_solid solid = nullptr;
        return made(kerf_solid_create(h.any<kerf_mesh>(), a.out(solid)), solid, h);
      },
      [](Arguments& a, Handles& h) {
        kerf_mesh mesh = nullptr;
        return made(kerf_solid_mesh(h.any<kerf_solid>(), a.out(mesh)), mesh, h);
      },
      [](Arguments& a, Handles&) {
        kerf_impact_options options;
        return kerf_impact_defaults(a.out(options));
      },
      [](Arguments& a, Handles& h) {
        kerf_impact_options options;
        kerf_impact_defaults(&options);
        if (a.random().below(3) == 0) options.toughness = a.number();
        if (a.random().below(3) == 0) options.max_pieces = a.one_of({2, 5, 0, -1, INT32_MAX});
        options.guard = a.one_of({0, 0, 1, 2});
        if (a.random().below(3) == 0) options.grading = a.number();
        if (a.random().below(3) == 0) options.elongation = a.number();
        if (a.random().below(3) == 0) options.hull_corners = a.index();
        if (a.random().below(3) == 0) options.hull_parts = a.one_of<std::uint32_t>({0, 1, 2, UINT32_MAX});
        kerf_breaking breaking = nullptr;
        std::int32_t finished = 0;
        return made(kerf_break(h.any<kerf_solid>(), a.numbers(3), a.numbers(3),
                               a.one_of({500.0, 900.0, 0.0, -1.0, std::nan(""), 1e300}),
                               a.one_of({0.0, 1.0, 100.0, -1.0, std::nan("")}), a.out(options), a.out(breaking),
                               a.out(finished)),
                    breaking, h);
      },
      [](Arguments& a, Handles& h) {
        std::int32_t finished = 0;
        return kerf_break_continue(h.any<kerf_breaking>(), a.one_of({0.0, 1.0, -1.0, std::nan("")}), a.out(finished));
      },
      [](Arguments& a, Handles& h) {
        std::size_t count = 0;
        return kerf_breaking_count(h.any<kerf_breaking>(), a.out(count));
      },
      [](Arguments& a, Handles& h) {
        kerf_part part;
        return kerf_breaking_part(h.any<kerf_breaking>(), a.index(), a.out(part));
      },
      [](Arguments& a, Handles& h) {
        kerf_mesh mesh = nullptr;
        return made(kerf_breaking_mesh(h.any<kerf_breaking>(), a.index(), a.out(mesh)), mesh, h);
      },
      [](Arguments& a, Handles& h) {
        kerf_mesh mesh = nullptr;
        return made(kerf_breaking_hull(h.any<kerf_breaking>(), a.index(), a.index(), a.out(mesh)), mesh, h);
      },
      [](Arguments& a, Handles& h) {
        kerf_solid solid = nullptr;
        return made(kerf_breaking_solid(h.any<kerf_breaking>(), a.index(), a.out(solid)), solid, h);
      }};
}

std::vector<Call> simulation_calls() {
  const auto read = [](auto function) -> Call {
    return [function](Arguments& a, Handles& h) {
      double values[600];
      std::size_t needed = 0;
      return function(h.any<kerf_simulation>(), a.random().below(3) ? values : nullptr,
                      a.one_of<std::size_t>({0, 5, 600}), a.out(needed));
    };
  };
  const auto move = [](auto function) -> Call {
    return [function](Arguments& a, Handles& h) { return function(h.any<kerf_simulation>(), a.index(), a.pose()); };
  };
  const auto force = [](auto function) -> Call {
    return [function](Arguments& a, Handles& h) {
      double values[3];
      return function(h.any<kerf_simulation>(), a.index(), a.random().below(9) ? values : nullptr);
    };
  };
  return {
      [](Arguments& a, Handles& h) {
        if (a.random().below(4)) return KERF_OK;  // costs most
        std::string text = scene;
        if (a.random().below(2))
          text[a.random().below(static_cast<std::uint32_t>(text.size()))] = static_cast<char>(a.random().below(256));
        const kerf_mesh models[2] = {h.any<kerf_mesh>(), h.any<kerf_mesh>()};
        kerf_simulation simulation = nullptr;
        return made(kerf_simulation_create(a.random().below(9) ? text.data() : nullptr, text.size(), a.text(),
                                           a.random().below(9) ? models : nullptr, a.random().below(3), stops_at_times,
                                           &a.random(), a.out(simulation)),
                    simulation, h);
      },
      [](Arguments& a, Handles& h) {
        kerf_simulation simulation = nullptr;
        return made(kerf_simulation_load(a.text(), nullptr, nullptr, a.out(simulation)), simulation, h);
      },
      [](Arguments& a, Handles& h) {
        kerf_frame frame;
        return kerf_simulation_step(h.any<kerf_simulation>(), a.random().below(4) ? nullptr : stops_at_times,
                                    &a.random(), a.out(frame));
      },
      [](Arguments& a, Handles& h) {
        kerf_frame frame;
        return kerf_simulation_frame(h.any<kerf_simulation>(), a.out(frame));
      },
      read(kerf_simulation_positions),
      read(kerf_simulation_velocities),
      read(kerf_simulation_stress),
      [](Arguments& a, Handles& h) {
        kerf_mesh surface = nullptr;
        return made(kerf_simulation_surface(h.any<kerf_simulation>(), a.out(surface)), surface, h);
      },
      [](Arguments& a, Handles&) {
        kerf_blade_options options;
        return kerf_blade_defaults(a.out(options));
      },
      [](Arguments& a, Handles& h) {
        kerf_blade_options options;
        kerf_blade_defaults(&options);
        options.points = a.numbers(9);
        options.points_length = a.one_of<std::size_t>({9, 6, 3, 0, 7});
        options.closed = a.integer();
        if (a.random().below(3) == 0) options.thickness = a.number();
        if (a.random().below(3) == 0) options.limit = a.number();
        for (double& x : options.back) x = a.random().below(3) ? 0 : a.number();
        std::uint32_t index = 0;
        return kerf_simulation_add_blade(h.any<kerf_simulation>(), a.out(options), a.pose(), a.out(index));
      },
      move(kerf_simulation_move_blade),
      move(kerf_simulation_move_grip),
      move(kerf_simulation_move_obstacle),
      force(kerf_simulation_blade_force),
      force(kerf_simulation_pull_force),
      [](Arguments& a, Handles& h) {
        std::uint32_t index = 0;
        return kerf_simulation_blade(h.any<kerf_simulation>(), a.text(), a.out(index));
      },
      [](Arguments& a, Handles& h) {
        std::uint32_t index = 0;
        return kerf_simulation_add_grip(h.any<kerf_simulation>(), a.numbers(3), a.numbers(3), a.out(index));
      },
      [](Arguments& a, Handles& h) { return kerf_simulation_end_grip(h.any<kerf_simulation>(), a.index()); },
      [](Arguments& a, Handles& h) {
        std::uint32_t index = 0;
        return kerf_simulation_add_pull(h.any<kerf_simulation>(), a.numbers(3), a.numbers(3), a.number(), a.out(index));
      },
      [](Arguments& a, Handles& h) {
        return kerf_simulation_move_pull(h.any<kerf_simulation>(), a.index(), a.numbers(3));
      },
      [](Arguments& a, Handles& h) {
        return kerf_simulation_strike(h.any<kerf_simulation>(), a.numbers(3),
                                      a.one_of({12, 2, 4, 1, 0, -3, INT32_MAX}));
      },
      [](Arguments& a, Handles& h) {
        kerf_changes changes{a.number(), a.number(),  a.number(),
                             a.number(), a.integer(), {a.number(), a.number(), a.number()}};
        return kerf_simulation_change(h.any<kerf_simulation>(), a.out(changes));
      }};
}

std::vector<Call> general_calls() {
  return {[](Arguments& a, Handles&) {
            CHECK(kerf_version() == std::string(KERF_VERSION));
            CHECK(kerf_abi() == KERF_ABI);
            const auto status = static_cast<kerf_status>(a.random().below(16));
            CHECK((std::strlen(kerf_status_name(status)) > 0) == (status <= KERF_INTERNAL));
            return KERF_OK;
          },
          [](Arguments& a, Handles&) {
            return kerf_set_threads(a.one_of({0, 1, 2, 5, -1, 1025, INT32_MIN}));
          },
          [](Arguments& a, Handles&) {
            return kerf_set_portable(a.one_of({0, 1, 1, 2, -1}));
          }};
}

}  // namespace

TEST_CASE("calls with bad arguments return a status, and the program goes on", "[c]") {
  std::vector<Call> calls;
  for (const auto& more : {general_calls(), mesh_calls(), crack_calls(), impact_calls(), simulation_calls()})
    calls.insert(calls.end(), more.begin(), more.end());
  const auto [first, count] = seeds(20);
  std::size_t good = 0, bad = 0;
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    CAPTURE(seed);
    Random random(seed);
    Handles handles(random);
    kerf_mesh block = nullptr;
    kerf_simulation run = nullptr;
    const double size[3] = {1, 1, 1};
    REQUIRE(kerf_shape_block(size, 1, &block) == KERF_OK);
    REQUIRE(kerf_simulation_create(scene, std::strlen(scene), nullptr, &block, 1, nullptr, nullptr, &run) == KERF_OK);
    handles.add(block);
    handles.add(run);
    for (int k = 0; k < 300; ++k) {
      Arguments arguments(random);
      arguments.reserve();
      const std::size_t which = random.below(static_cast<std::uint32_t>(calls.size()));
      CAPTURE(k, which);
      const kerf_status status = calls[which](arguments, handles);
      CAPTURE(kerf_last_message());
      CHECK((status >= KERF_OK && status < KERF_INTERNAL));
      CHECK((status == KERF_OK || std::strlen(kerf_last_message()) > 0));
      ++(status == KERF_OK ? good : bad);
      if (random.below(20) == 0 && handles.count() > 2)
        handles.end(random.below(static_cast<std::uint32_t>(handles.count())));
    }
  }
  kerf_set_threads(0);
  kerf_set_portable(0);
  WARN(good << " calls succeeded and " << bad << " were refused, from seed " << first);
  CHECK(good > bad / 20);
}
