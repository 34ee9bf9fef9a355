"""energies.py NATIVE WASM: no frame has a crossing, and elastic and kinetic energies agree within 1e-6 of their sum."""
import sys

native, wasm = ([line.split() for line in open(path)] for path in sys.argv[1:3])
assert len(native) == len(wasm) > 0, "the runs have different numbers of frames"
worst = 0.0
for a, b in zip(native, wasm):
    assert a[3] == b[3] == "0", f"frame {a[1]}: {a[3]} and {b[3]} crossings"
    whole = float(a[5]) + float(a[7])
    worst = max(worst, *(abs(float(a[i]) - float(b[i])) / whole for i in (5, 7)))
print(f"{len(native)} frames without a crossing; energies differ by {worst:.1e} of their sum at most")
sys.exit(worst > 1e-6)
