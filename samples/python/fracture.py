"""Fracture in six lines: a pumpkin in thirty pieces, each a closed mesh of its own, and all in one file for Blender or Unity.

python3 fracture.py
"""
import kerf

model = kerf.shapes.pumpkin(16)  # a model of one's own: kerf.load("bear.obj")
broken = model.crack(kerf.score(model, "voronoi", pieces=30, jagged=0.02, seed=7))
for piece in broken.pieces():
    piece.save(f"piece_{piece.index:02}.ply")
broken.save("pumpkin.glb")
