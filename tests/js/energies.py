"""energies.py NAME RUN: no frame of a run has a crossing, and its energies are finite and change."""
import math
import sys

frames = [line.split() for line in open(sys.argv[2])]
assert frames, f"{sys.argv[1]}: there are no frames"
for frame in frames:
    assert frame[3] == "0", f"{sys.argv[1]}: frame {frame[1]} has {frame[3]} crossings"
    assert math.isfinite(float(frame[5])) and math.isfinite(float(frame[7]))
assert len({frame[7] for frame in frames}) > len(frames) // 2, f"{sys.argv[1]}: nothing moves"
print(f"{sys.argv[1]}: {len(frames)} frames without a crossing have the same bytes")
