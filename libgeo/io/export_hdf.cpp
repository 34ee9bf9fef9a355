// write_vtkhdf() of kerf/export.h. VTKHDF 1.0, which ParaView 5.11 opens:
// https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html
#include <hdf5.h>

#include <cstdint>
#include <functional>
#include <vector>

#include "io/graph_edges.h"
#include "io/kerf_writer.h"
#include "kerf/error.h"
#include "kerf/export.h"

namespace geo {
namespace {

void require(std::int64_t result) {
  if (result < 0) throw OutputError("the HDF5 library has no memory for this body; export another format");
}

// An HDF5 handle, closed by the destructor.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) { require(id); }
  ~Handle() { close_(id_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void write_attribute(hid_t object, const char* name, hid_t type, const Handle& space, const void* value) {
  const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  require(H5Awrite(attribute, type, value));
}

// Writes a data set of `rows` × `columns` values, which `fill` puts.
void write_set(hid_t group, const char* name, hid_t type, hsize_t rows, hsize_t columns,
               const std::function<void(KerfSink&)>& fill) {
  const hsize_t shape[] = {rows, columns};
  const Handle space(H5Screate_simple(columns > 1 ? 2 : 1, shape, nullptr), H5Sclose),
      properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  require(H5Pset_obj_track_times(properties, false));  // else the bytes depend on the time
  const Handle set(H5Dcreate2(group, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose);
  // Blocks need not end at the end of a row.
  const hsize_t width = columns * H5Tget_size(type);
  std::vector<std::byte> rest;
  hsize_t at = 0;
  KerfSink sink([&](std::span<const std::byte> block) {
    rest.insert(rest.end(), block.begin(), block.end());
    const hsize_t count[] = {rest.size() / width, columns}, start[] = {at, 0};
    if (count[0] == 0) return;
    const Handle memory(H5Screate_simple(columns > 1 ? 2 : 1, count, nullptr), H5Sclose);
    require(H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, count, nullptr));
    require(H5Dwrite(set, type, memory, space, H5P_DEFAULT, rest.data()));
    rest.erase(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(count[0] * width));
    at += count[0];
  });
  fill(sink);
  sink.finish();
}

template <class T>
hid_t type_of() {
  if constexpr (std::is_same_v<T, double>)
    return H5T_IEEE_F64LE;
  else if constexpr (std::is_same_v<T, std::int64_t>)
    return H5T_STD_I64LE;
  else if constexpr (std::is_same_v<T, std::uint32_t>)
    return H5T_STD_U32LE;
  else
    return H5T_STD_U8LE;
}

template <class T>
void write_set(hid_t group, const char* name, const std::vector<T>& values) {
  write_set(group, name, type_of<T>(), values.size(), 1,
            [&](KerfSink& sink) { sink.write(std::as_bytes(std::span(values))); });
}

}  // namespace

void write_vtkhdf(std::ostream& out, const Body& body) {
  const NodeSet& nodes = body.nodes;
  const auto edges = static_cast<std::int64_t>(body.graph.edge_count());
  std::vector<std::uint32_t> component;
  body.graph.components(component);
  require(H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr));  // else the library prints errors
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose), creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  require(H5Pset_fapl_core(access, 1 << 24, false));
  require(H5Pset_obj_track_times(creation, false));
  const Handle file(H5Fcreate("body.hdf", H5F_ACC_TRUNC, creation, access), H5Fclose);
  {
    const Handle root(H5Gcreate2(file, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    const hsize_t two = 2;
    const Handle pair(H5Screate_simple(1, &two, nullptr), H5Sclose), scalar(H5Screate(H5S_SCALAR), H5Sclose),
        text(H5Tcopy(H5T_C_S1), H5Tclose);
    const std::int64_t version[] = {1, 0};
    const char kind[] = "UnstructuredGrid";
    require(H5Tset_size(text, sizeof kind - 1));
    require(H5Tset_strpad(text, H5T_STR_NULLPAD));
    write_attribute(root, "Version", H5T_STD_I64LE, pair, version);
    write_attribute(root, "Type", text, scalar, kind);
    write_set(root, "NumberOfPoints", std::vector<std::int64_t>{static_cast<std::int64_t>(nodes.size())});
    write_set(root, "NumberOfCells", std::vector<std::int64_t>{edges});
    write_set(root, "NumberOfConnectivityIds", std::vector<std::int64_t>{2 * edges});
    write_set(root, "Points", H5T_IEEE_F64LE, nodes.size(), 3,
              [&](KerfSink& sink) { sink.write(std::as_bytes(std::span(nodes.position))); });
    write_set(root, "Types", H5T_STD_U8LE, static_cast<hsize_t>(edges), 1, [&](KerfSink& sink) {
      for (std::int64_t e = 0; e < edges; ++e) sink.put(std::uint8_t(3));  // lines
    });
    write_set(root, "Offsets", H5T_STD_I64LE, static_cast<hsize_t>(edges + 1), 1, [&](KerfSink& sink) {
      for (std::int64_t e = 0; e <= edges; ++e) sink.put(2 * e);
    });
    write_set(root, "Connectivity", H5T_STD_I64LE, static_cast<hsize_t>(2 * edges), 1, [&](KerfSink& sink) {
      each_edge(body, [&](std::uint32_t i, std::uint32_t j) {
        sink.put(std::int64_t(i));
        sink.put(std::int64_t(j));
      });
    });
    const Handle fields(H5Gcreate2(root, "PointData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    write_set(fields, "radius", nodes.radius);
    write_set(fields, "spacing", nodes.spacing);
    write_set(fields, "volume", nodes.volume);
    write_set(fields, "debris", body.debris);
    write_set(fields, "component", component);
  }
  require(H5Fflush(file, H5F_SCOPE_GLOBAL));
  const auto size = H5Fget_file_image(file, nullptr, 0);
  require(size);
  std::vector<char> image(static_cast<std::size_t>(size));
  require(H5Fget_file_image(file, image.data(), image.size()));
  out.write(image.data(), static_cast<std::streamsize>(image.size()));
}

}  // namespace geo
