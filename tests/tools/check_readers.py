"""check_readers.py BODY.kerf STEM: STEM.npz as numpy reads it, STEM.vtu, .hdf and .ply as VTK does, hold what the body does;
INFO.json, written by kerf-info --json, says as many nodes and edges."""
import json, sys
import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader
from vtkmodules.vtkIOPLY import vtkPLYReader
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from read_kerf import numbers, read_kerf

body, stem, told = read_kerf(sys.argv[1]), sys.argv[2], json.load(open(sys.argv[3]))

archive = numpy.load(stem + ".npz")
for name, (dtype, shape, data) in body.items():
    if dtype == "json":
        continue
    array = archive[name]
    assert array.dtype == numpy.dtype(dtype if dtype == "u1" else "<" + dtype) and array.shape == tuple(shape), name
    assert array.tobytes() == data, name

count, to, bits = (archive["graph/" + name] for name in ("count", "to", "bits"))
first = numpy.repeat(numpy.arange(len(count)), count)
edge = (bits & 0x8000 != 0) & (to > first) & (to < 1 << 31)
edges = set(zip(first[edge].tolist(), to[edge].tolist()))
assert told["nodes"] == len(count) and told["edges"] == len(edges)
position = archive["nodes/position"]


def points_of(data):
    return vtk_to_numpy(data.GetPoints().GetData())


def check_grid(grid):
    assert grid.GetNumberOfPoints() == len(count) and grid.GetNumberOfCells() == len(edges)
    assert (points_of(grid) == position).all()
    ends = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 2)
    assert set(map(tuple, ends.tolist())) == edges
    assert set(vtk_to_numpy(grid.GetCellTypesArray()).tolist()) == {3}
    for name in ("radius", "spacing", "volume", "debris"):
        assert (vtk_to_numpy(grid.GetPointData().GetArray(name)) == archive["nodes/" + name]).all(), name
    assert vtk_to_numpy(grid.GetPointData().GetArray("component")).max() + 1 == told["graph_components"]


for reader, file in ((vtkXMLUnstructuredGridReader(), stem + ".vtu"), (vtkHDFReader(), stem + ".hdf")):
    reader.SetFileName(file)
    assert reader.CanReadFile(file), file
    reader.Update()
    check_grid(reader.GetOutput())
    print(file, "read")

reader = vtkPLYReader()
reader.SetFileName(stem + ".ply")
reader.Update()
read = points_of(reader.GetOutput())
assert read.shape == position.shape and numpy.abs(read - position).max() <= 1e-6 * numpy.abs(position).max()  # VTK has them as floats
