"""The Python side of `kerf-bench python`: for each line of input, a fracture from arrays to arrays. Prints CPU seconds of all,
of score, crack and pieces alone, and the pieces' volume, faces and number."""
import sys
import time

import numpy

import kerf

frequency, pieces = int(sys.argv[1]), int(sys.argv[2])
kerf.set_threads(1)
model = kerf.shapes.pumpkin(frequency)
vertices, faces = numpy.array(model.vertices), model.faces.astype(numpy.int64)
for _ in sys.stdin:
    begin = time.process_time()
    solid = kerf.Solid(vertices, faces)
    start = time.process_time()
    cracked = solid.crack(kerf.score(solid, "voronoi", pieces=pieces, jagged=0.02, seed=7))
    chunks = cracked.pieces()
    arrays = [(p.vertices, p.faces, p.patch, p.source, p.volume) for p in chunks]
    end = time.process_time()
    volume = 0.0
    for _, _, _, _, one in arrays:
        volume += one
    print(end - begin, end - start, repr(volume), sum(len(f) for _, f, _, _, _ in arrays), len(arrays), flush=True)
