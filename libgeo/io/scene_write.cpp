// write_scene() of kerf/files.h. Every value is written, also those that are the default, so that a
// later change of a default does not change a recording.
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <system_error>

#include "base/number_text.h"
#include "kerf/files.h"

namespace geo {
namespace {

// Shortest text that is read back exactly, as a TOML float.
std::string number(double x) {
  if (std::isinf(x)) return x < 0 ? "-inf" : "inf";
  char text[40];
  std::string s(text, write_number(text, x));
  if (s.find_first_of(".e") == s.npos) s += ".0";
  return s;
}

std::string row(std::initializer_list<double> values) {
  std::string text = "[";
  for (const double x : values) text += (text.size() > 1 ? ", " : "") + number(x);
  return text + "]";
}

std::string row(const Vec3& p) { return row({p.x(), p.y(), p.z()}); }

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      constexpr char digits[] = "0123456789abcdef";
      out += std::string("\\u00") + digits[static_cast<unsigned char>(c) >> 4] + digits[c & 15];
    } else {
      out += c;
    }
  }
  return out + "\"";
}

class SceneWriter {
 public:
  SceneWriter(std::ostream& out, std::string folder) : out_(out), folder_(std::move(folder)) {}

  void write(const Scene& s);

 private:
  void table(const char* name) { out_ << "\n" << name << "\n"; }
  void key(const char* name, const std::string& text) { out_ << name << " = " << text << "\n"; }
  void key(const char* name, double x) { key(name, number(x)); }
  void key(const char* name, const Vec3& p) { key(name, row(p)); }
  void whole(const char* name, std::uint64_t n) { key(name, std::to_string(n)); }
  void flag(const char* name, bool on) { key(name, std::string(on ? "true" : "false")); }
  void path(const char* name, const std::string& file) {
    namespace fs = std::filesystem;
    std::error_code none;  // a browser has no current folder: the file is named as it is
    const fs::path absolute = fs::absolute(file, none).lexically_normal();
    if (none) return key(name, quoted(file));
    key(name, quoted((folder_.empty() ? absolute : absolute.lexically_relative(fs::absolute(folder_))).string()));
  }
  void rotation(const Eigen::Quaterniond& r) {
    if (r.w() != 1) key("quaternion", row({r.w(), r.x(), r.y(), r.z()}));
  }

  void material(const Material& m, bool own);
  void prestretch(const Prestretch& p);
  void strength(const Strength& s);
  void breakage(const Breakage& b);
  void fracture(const FractureOptions& f);
  void body(const SceneBody& b, const Scene& s, std::size_t index);
  void keys(const Motion& motion);
  void grip(const Grip& g);
  void blade(const Blade& b);
  void pull(const Pull& p);
  void stitch(const Stitch& s);
  void blow(const Blow& b);
  void load(const Load& l);
  void support(const Support& s);
  void obstacle(const SceneObstacle& o);
  void change(const SceneChange& c);
  void time(const Scene& s);

  std::ostream& out_;
  std::string folder_;
};

void SceneWriter::material(const Material& m, bool own) {
  key("model", std::string(m.model == ElasticModel::saint_venant_kirchhoff ? "\"stvk\"" : "\"neo-hookean\""));
  key("young", m.young);
  key("poisson", m.poisson);
  key("density", m.density);
  key("volume_term", m.volume_term);
  key("damping", m.damping);
  if (!own)
    key("discretisation", std::string(m.discretisation == Discretisation::galerkin ? "\"galerkin\"" : "\"mueller04\""));
  key("viscosity", m.viscosity);
  key("mode_penalty", m.mode_penalty);
  key("yield", m.yield);
  key("creep", m.creep);
  key("most_plastic", m.max_plastic);
}

void SceneWriter::prestretch(const Prestretch& p) {
  key("stretch", p.stretch);
  if (!(p.depth > 0)) return;
  key("skin", p.skin);
  key("depth", p.depth);
}

void SceneWriter::strength(const Strength& s) {
  key("strength", s.strength);
  key("toughness", s.toughness);
  key("variation", s.variation);
  key("grain", s.grain);
}

void SceneWriter::breakage(const Breakage& b) {
  strength(b);
  whole("cells", static_cast<std::uint64_t>(b.cells));
  key("jagged", b.jagged);
}

void SceneWriter::fracture(const FractureOptions& f) {
  table("[fracture]");
  breakage(f);
  key("speed", f.speed);
  key("branching", f.branching);
  key("apart", f.separation);
  whole("cracks", static_cast<std::uint64_t>(f.max_cracks));
  whole("cracks_per_step", static_cast<std::uint64_t>(f.cracks_per_step));
  key("start", f.start);
  std::string rows;
  for (const auto& [lo, hi] : f.off)
    rows += (rows.empty() ? "" : ", ") + row({lo.x(), lo.y(), lo.z(), hi.x(), hi.y(), hi.z()});
  key("off", "[" + rows + "]");
}

void SceneWriter::body(const SceneBody& b, const Scene& s, std::size_t index) {
  table("[[body]]");
  key("name", quoted(b.name));
  path("mesh", b.mesh);
  if (b.sampling.spacing > 0)
    key("spacing", b.sampling.spacing);
  else if (b.sampling.count > 0)
    whole("nodes", b.sampling.count);
  else
    key("spacing_percent", b.spacing_percent);
  whole("levels", static_cast<std::uint64_t>(b.sampling.levels));
  whole("across", static_cast<std::uint64_t>(b.sampling.across));
  whole("k", static_cast<std::uint64_t>(s.k));
  key("scale", b.scale);
  if (b.refine > 0) key("refine", b.refine);
  key("position", b.place.position);
  rotation(b.place.rotation);
  key("velocity", b.velocity);
  key("spin", b.spin);
  if (b.material) {
    table("[body.material]");
    material(*b.material, true);
  }
  if (b.prestretch) {
    table("[body.prestretch]");
    prestretch(*b.prestretch);
  }
  if (!s.fracture.per_body.empty()) {
    table("[body.fracture]");
    breakage(s.fracture.per_body.at(index));
  }
}

void SceneWriter::keys(const Motion& motion) {
  out_ << "keys = [\n";
  for (const Motion::Key& k : motion.keys)
    out_ << "  "
         << row({k.time, k.position.x(), k.position.y(), k.position.z(), k.axis.x(), k.axis.y(), k.axis.z(), k.angle})
         << ",\n";
  out_ << "]\n";
}

void SceneWriter::grip(const Grip& g) {
  table("[[grip]]");
  key("box", row({g.lo.x(), g.lo.y(), g.lo.z(), g.hi.x(), g.hi.y(), g.hi.z()}));
  if (std::isfinite(g.from)) key("from", g.from);
  if (std::isfinite(g.until)) key("until", g.until);
  flag("release", g.release);
  if (!g.motion.keys.empty()) keys(g.motion);
}

void SceneWriter::blade(const Blade& b) {
  table("[[blade]]");
  key("name", quoted(b.name));
  flag("closed", b.closed);
  out_ << "points = [\n";
  for (const Vec3& p : b.points) out_ << "  " << row(p) << ",\n";
  out_ << "]\n";
  key("back", b.back);
  key("thickness", b.thickness);
  key("stiffness", b.stiffness);
  key("friction", b.friction);
  key("resistance", b.resistance);
  key("limit", b.limit);
  keys(b.motion);
}

void SceneWriter::pull(const Pull& p) {
  table("[[pull]]");
  key("point", p.point);
  if (p.node) whole("node", *p.node);
  key("stiffness", p.stiffness);
  keys(p.motion);
}

void SceneWriter::stitch(const Stitch& s) {
  table("[[stitch]]");
  key("point_a", s.ends[0].point);
  if (s.ends[0].node) whole("node_a", *s.ends[0].node);
  key("point_b", s.ends[1].point);
  if (s.ends[1].node) whole("node_b", *s.ends[1].node);
  key("stiffness", s.stiffness);
  key("length", s.length);
  if (s.slack) key("slack", *s.slack);
  key("closing", s.closing);
  key("from", s.from);
  if (std::isfinite(s.until)) key("until", s.until);
}

void SceneWriter::blow(const Blow& b) {
  table("[[blow]]");
  key("time", b.time);
  key("point", b.point);
  whole("cells", static_cast<std::uint64_t>(b.cells));
}

void SceneWriter::load(const Load& l) {
  table("[[load]]");
  key("box", row({l.lo.x(), l.lo.y(), l.lo.z(), l.hi.x(), l.hi.y(), l.hi.z()}));
  key("traction", l.traction);
  key("from", l.from);
  key("ramp", l.ramp);
  if (std::isfinite(l.until)) key("until", l.until);
}

void SceneWriter::support(const Support& s) {
  table("[[support]]");
  key("box", row({s.lo.x(), s.lo.y(), s.lo.z(), s.hi.x(), s.hi.y(), s.hi.z()}));
  key("axes", quoted(std::string(s.axes.x ? "x" : "") + (s.axes.y ? "y" : "") + (s.axes.z ? "z" : "")));
  if (std::isfinite(s.from)) key("from", s.from);
  if (std::isfinite(s.until)) key("until", s.until);
  if (!s.motion.keys.empty()) keys(s.motion);
}

void SceneWriter::obstacle(const SceneObstacle& o) {
  table("[[obstacle]]");
  key("name", quoted(o.name));
  if (o.mesh.triangles.empty())
    key("normal", o.normal);
  else if (o.file.empty())
    throw InputError("obstacle '" + o.name + "' has a mesh that was not read from a file, which no scene can name");
  else
    path("mesh", o.file);
  key("scale", o.scale);
  key("position", o.place.position);
  rotation(o.place.rotation);
  key("stiffness", o.stiffness);
  key("friction", o.friction);
  if (!o.motion.keys.empty()) keys(o.motion);
}

void SceneWriter::change(const SceneChange& c) {
  table("[[change]]");
  key("time", c.time);
  if (c.young) key("young", *c.young);
  if (c.damping) key("damping", *c.damping);
  if (c.gravity) key("gravity", *c.gravity);
  if (c.friction) key("friction", *c.friction);
  if (c.accuracy) key("accuracy", *c.accuracy);
  if (c.dt) key("step", *c.dt);
}

void SceneWriter::time(const Scene& s) {
  table("[time]");
  whole("frames", static_cast<std::uint64_t>(s.frames));
  key("frame_rate", s.frame_rate);
  key("step", s.dt);
  key("accuracy", s.accuracy);
  if (s.sleep > 0) key("sleep", s.sleep);
  whole("checkpoint_every", static_cast<std::uint64_t>(s.checkpoint_every));
  std::string frames;
  for (const int f : s.checkpoints) frames += (frames.empty() ? "" : ", ") + std::to_string(f);
  key("checkpoints", "[" + frames + "]");
  key("integrator", quoted(s.integrator()));
  whole("seed", s.seed);
}

void SceneWriter::write(const Scene& s) {
  if (!s.scores.empty() && s.score_files.empty())
    throw InputError("the scene has cracks that were not read from a file, which no scene can name");
  key("gravity", s.gravity);
  table("[material]");
  material(s.material, false);
  if (s.prestretch != Prestretch{} || s.loaded) {
    table("[prestretch]");
    prestretch(s.prestretch);
    if (s.loaded) flag("loaded", true);
  }
  if (s.fracture.on) fracture(s.fracture);
  for (std::size_t b = 0; b < s.bodies.size(); ++b) body(s.bodies[b], s, b);
  if (s.ground) {
    table("[ground]");
    key("point", s.ground_point);
    key("normal", s.ground_normal);
    key("stiffness", s.ground_stiffness);
    key("friction", s.friction);
  }
  table("[contact]");
  flag("self", s.self_contact);
  key("friction", s.contact.friction);
  key("gap", s.contact.gap);
  time(s);
  for (const SceneScoreFile& score : s.score_files) {
    table("[[score]]");
    path("file", score.file);
    whole("body", static_cast<std::uint64_t>(score.body));
    if (score.glue) strength(*score.glue);
  }
  for (const Grip& g : s.grips) grip(g);
  for (const SceneObstacle& o : s.obstacles) obstacle(o);
  for (const Blade& b : s.blades) blade(b);
  for (const Pull& p : s.pulls) pull(p);
  for (const Stitch& stitch : s.stitches) this->stitch(stitch);
  for (const Blow& b : s.blows) blow(b);
  for (const Load& l : s.loads) load(l);
  for (const Support& support : s.supports) this->support(support);
  for (const SceneChange& c : s.changes) change(c);
}

}  // namespace

void write_scene(std::ostream& out, const Scene& scene, const std::string& folder) {
  SceneWriter(out, folder).write(scene);
}

}  // namespace geo
