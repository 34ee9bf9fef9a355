// Files of kerf/peridynamics.h: node tables, families, input of Peridigm, PeriLab, Peridynamics.jl.
// Numbers have enough digits to be read back exactly.
#include <algorithm>
#include <map>
#include <string>

#include "base/union_find.h"
#include "kerf/peridynamics.h"

namespace geo {
namespace {

// "Normal X" for PeriLab, "Normal_X" for Peridigm.
void write_vector(std::ostream& out, const std::string& name, char separator, const Vec3& v) {
  for (int k = 0; k < 3; ++k) {
    std::string key = name + ' ' + "XYZ"[k];
    std::replace(key.begin(), key.end(), ' ', separator);
    out << "        " << key << ": " << std::showpoint << v[k] << std::noshowpoint << '\n';
  }
}

void write_filters(std::ostream& out, const std::vector<BondFilter>& filters, char separator) {
  out << "  Discretization:\n    Type: \"Text File\"\n    Input Mesh File: \"nodes.txt\"\n";
  if (!filters.empty()) out << "    Bond Filters:\n";
  const std::string gap(1, separator);
  for (std::size_t i = 0; i < filters.size(); ++i) {
    const BondFilter& f = filters[i];
    out << "      filter_" << i + 1 << ":\n        Type: \"Rectangular_Plane\"\n";
    write_vector(out, "Normal", separator, f.normal);
    write_vector(out, "Lower Left Corner", separator, f.corner);
    write_vector(out, "Bottom Unit Vector", separator, f.bottom);
    out << std::showpoint << "        Bottom" << gap << "Length: " << f.bottom_length << "\n        Side" << gap
        << "Length: " << f.side_length << std::noshowpoint << '\n';
  }
}

// The components of the families' graph, as the lowest node of each.
std::vector<std::uint32_t> components(const BondModel& model) {
  UnionFind sets(model.block.size());
  for (std::uint32_t i = 0; i < model.block.size(); ++i)
    for (auto e = model.indptr[i]; e < model.indptr[i + 1]; ++e) sets.unite(i, model.indices[e]);
  std::vector<std::uint32_t> result(model.block.size());
  for (std::uint32_t i = 0; i < model.block.size(); ++i) result[i] = static_cast<std::uint32_t>(sets.find(i));
  return result;
}

void write_set(std::ostream& out, const std::string& name, const std::vector<std::uint32_t>& nodes) {
  out << "    point_set!(body, :" << name << ", [";
  for (std::size_t i = 0; i < nodes.size(); ++i) out << (i ? ", " : "") << nodes[i] + 1;
  out << "])\n";
}

}  // namespace

void write_bond_nodes(std::ostream& out, const Body& body, const BondModel& model, bool header) {
  out.precision(17);
  if (header) out << "header: x y z block_id volume\n";
  for (std::size_t i = 0; i < body.nodes.size(); ++i) {
    const Vec3& p = body.nodes.position[i];
    out << p.x() << ' ' << p.y() << ' ' << p.z() << ' ' << model.block[i] + 1 << ' ' << body.nodes.volume[i] << '\n';
  }
}

void write_families(std::ostream& out, const BondModel& model) {
  for (std::size_t i = 0; i + 1 < model.indptr.size(); ++i) {
    out << i + 1;
    for (auto e = model.indptr[i]; e < model.indptr[i + 1]; ++e) out << ' ' << model.indices[e] + 1;
    out << '\n';
  }
}

void write_peridigm(std::ostream& out, const BondModel& model, const std::vector<BondFilter>& filters) {
  out.precision(17);
  out << "# Add Materials, Boundary Conditions, Solver and Output.\nPeridigm:\n";
  write_filters(out, filters, '_');
  out << "  Blocks:\n";
  for (std::size_t b = 0; b < model.horizon.size(); ++b)
    out << "    Horizon " << b + 1 << ":\n      Block Names: \"block_" << b + 1
        << "\"\n      Material: \"My Material\"\n      Horizon: " << std::showpoint << model.horizon[b]
        << std::noshowpoint << '\n';
}

void write_perilab(std::ostream& out, const BondModel& model, const std::vector<BondFilter>& filters) {
  out.precision(17);
  out << "# Add Models, Boundary Conditions, Solver and Outputs, and the density of each block.\nPeriLab:\n";
  write_filters(out, filters, ' ');
  out << "  Blocks:\n";
  for (std::size_t b = 0; b < model.horizon.size(); ++b)
    out << "    block_" << b + 1 << ":\n      Block ID: " << b + 1
        << "\n      Material Model: \"My Material\"\n      Horizon: " << std::showpoint << model.horizon[b]
        << std::noshowpoint << '\n';
}

void write_peridynamics_jl(std::ostream& out, const BondModel& model) {
  out.precision(17);
  out << "using Peridynamics, DelimitedFiles\n\n"
         "# The horizon of each block.\nconst kerf_horizons = Dict(";
  for (std::size_t b = 0; b < model.horizon.size(); ++b)
    out << (b ? ", " : "") << ":block_" << b + 1 << " => " << model.horizon[b];
  out << ")\n\n"
         "# A body of some material, for example BBMaterial(). Give parameters to each block then:\n"
         "#   for (block, horizon) in kerf_horizons\n"
         "#       material!(body, block; horizon, rho = 2700, E = 70e9, Gc = 100)\n"
         "#   end\n"
         "function kerf_body(material; update_dmg = true)\n"
         "    table = readdlm(joinpath(@__DIR__, \"nodes.txt\"))\n"
         "    body = Body(material, permutedims(table[:, 1:3]), table[:, 5])\n"
         "    for b in 1:"
      << model.horizon.size()
      << "\n        point_set!(body, Symbol(\"block_\", b), findall(==(b), table[:, 4]))\n    end\n";
  // Components that bonds hold together come apart as wholes; other bonds break node by node.
  const std::vector<std::uint32_t> component = components(model);
  std::map<std::uint32_t, std::vector<std::uint32_t>> parts, partners;
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> apart;
  for (const auto& [i, j] : model.broken) {
    const auto a = component[i.index()], b = component[j.index()];
    if (a != b) {
      parts[a];
      parts[b];
      apart[{std::min(a, b), std::max(a, b)}] = true;
    } else
      partners[i.value].push_back(j.value);
  }
  for (std::uint32_t i = 0; i < component.size(); ++i)
    if (const auto part = parts.find(component[i]); part != parts.end()) part->second.push_back(i);
  for (const auto& [lowest, nodes] : parts) write_set(out, "part_" + std::to_string(lowest + 1), nodes);
  const auto crack = [&](const std::string& a, const std::string& b) {
    out << "    precrack!(body, :" << a << ", :" << b << "; update_dmg)\n";
  };
  for (const auto& [pair, unused] : apart)
    crack("part_" + std::to_string(pair.first + 1), "part_" + std::to_string(pair.second + 1));
  for (const auto& [i, others] : partners) {
    const std::string number = std::to_string(i + 1);
    write_set(out, "node_" + number, {i});
    write_set(out, "hidden_from_" + number, others);
    crack("node_" + number, "hidden_from_" + number);
  }
  out << "    return body\nend\n";
}

}  // namespace geo
