#!/usr/bin/env python3
"""An hour at kerf-live: a stroke every two seconds, in a random direction through the body; reset when pieces exceed a bound.

  tests/live/soak.py TOOLS_DIR SCENE|MODEL [--minutes 60] [--pieces 24] [--seed 1]

Prints a line a minute. Fails where memory leaves 10 % around its level after five minutes (a twelfth of a shorter run), where
kerf-live ends, or where a stroke was refused without a reason.
"""
import argparse, os, random, sys, time
from client import Client, Program, stroke

parser = argparse.ArgumentParser()
parser.add_argument("tools"), parser.add_argument("subject")
parser.add_argument("--minutes", type=float, default=60), parser.add_argument("--pieces", type=int, default=24), parser.add_argument("--seed", type=int, default=1)
wish = parser.parse_args()
dice = random.Random(wish.seed)
program = Program(os.path.join(wish.tools, "kerf-live"), wish.subject)
client = Client(program.address, timeout=600)  # a frame of a body with many cuts takes long
frame = client.next()
lo, hi = client.told["box"]
middle, radius = [(a + b) / 2 for a, b in zip(lo, hi)], 0.5 * sum((b - a) ** 2 for a, b in zip(lo, hi)) ** 0.5


def around(spread):
    """A point around the middle."""
    return [m + spread * radius * dice.uniform(-1, 1) for m in middle]


start, level, strokes, resets, frames, most, failures, told = time.time(), None, 0, 0, 0, 0, [], 0
settle = min(300, wish.minutes * 60 / 12)
while time.time() < start + 60 * wish.minutes:
    direction = [dice.gauss(0, 1) for _ in range(3)]
    size = sum(x * x for x in direction) ** 0.5
    eye = [m + 3 * radius * d / size for m, d in zip(middle, direction)]
    strokes += 1
    stroke(client, eye, (around(1.2), around(1.2)), 2.4 * radius, 1.8 * radius, strokes, seconds=dice.uniform(0.2, 1.2))
    while time.time() < start + 2 * strokes:
        frame = client.next()
        frames += 1
    most = max(most, frame["pieces"])
    if frame["pieces"] > wish.pieces:
        client.send({"reset": True})
        resets += 1
    memory, age = program.memory(), time.time() - start
    if level is None and age > settle:
        level = memory
    if age > 60 * told:
        told += 1
        print(f"{age:5.0f} s: {strokes} strokes, {resets} resets, {frame['pieces']} pieces, {frame['nodes']} nodes, real time x {frame['sim_rate']:.2f}, "
              f"{frame['refused']} refused, {memory / 1e6:.0f} MB", flush=True)
    if program.process.poll() is not None:
        failures.append("kerf-live ended: " + "".join(program.said))
        break
memory = program.memory()
if level and abs(memory - level) > 0.1 * level:
    failures.append(f"memory went from {level / 1e6:.0f} MB to {memory / 1e6:.0f} MB")
unexplained = [n for n in client.notices if not (n.get("error") or n.get("notice"))]
if unexplained:
    failures.append(f"{len(unexplained)} notices without a reason")
for text in sorted({n.get("error") or n.get("notice") for n in client.notices}):
    print(f"said {sum((n.get('error') or n.get('notice')) == text for n in client.notices)} times: {text}")
print(f"{strokes} strokes, {resets} resets, at most {most} pieces, {client.bytes / 1e6:.0f} MB sent; memory {level / 1e6:.0f} MB after {settle:.0f} s, {memory / 1e6:.0f} MB at the end")
client.close()
code = program.stop()
if code != 0:
    failures.append(f"kerf-live's exit code is {code}: {''.join(program.said)}")
for failure in failures:
    print("FAILED:", failure)
sys.exit(bool(failures))
