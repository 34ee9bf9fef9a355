#!/usr/bin/env python3
"""An hour at kerf-live: a stroke every two seconds, in a random direction through the body.

  tests/live/soak.py TOOLS_DIR SCENE|MODEL [--minutes 60] [--pieces 24] [--slowest 0.03] [--seed 1]

Resets where there are more than --pieces pieces, or where the simulation has been slower than --slowest of real time for 30 s.
Prints a line a minute. Memory is compared after resets, when the body is the same: the first reset after five minutes (a
twelfth of a shorter run), and one at the end. It is the least in 12 seconds: every ten, freed memory goes back to the system.
Fails where these differ by more than 10 %, where kerf-live ends, where a reset does not give the first body back, or where a
stroke was refused without a reason.
"""
import argparse, collections, os, random, select, sys, time
from client import Client, Program, stroke

parser = argparse.ArgumentParser()
parser.add_argument("tools"), parser.add_argument("subject")
parser.add_argument("--minutes", type=float, default=60), parser.add_argument("--pieces", type=int, default=24)
parser.add_argument("--slowest", type=float, default=0.03), parser.add_argument("--seed", type=int, default=1)
wish = parser.parse_args()
dice = random.Random(wish.seed)
program = Program(os.path.join(wish.tools, "kerf-live"), wish.subject)
client = Client(program.address, timeout=600)
first = client.next()
lo, hi = client.told["box"]
middle, radius = [(a + b) / 2 for a, b in zip(lo, hi)], 0.5 * sum((b - a) ** 2 for a, b in zip(lo, hi)) ** 0.5
said, failures = collections.Counter(), []
frames = most = resets = strokes = told = highest = slowest = 0
level = None
recent = []  # pairs of seconds, real and simulated
message = ""


def around(spread):
    """A point around the middle."""
    return [m + spread * radius * dice.uniform(-1, 1) for m in middle]


def next_frame():
    """The next frame, counted; sentences for people are counted when they change."""
    global frames, message, slowest
    begin = time.time()
    frame = client.next()
    slowest = max(slowest, time.time() - begin)
    frames += 1
    if frame["message"] != message and not frame["message"].startswith("slower than"):
        message = frame["message"]
        if message:
            said[message] += 1
    return frame


def least_memory(seconds):
    """The least memory in a time. Frames may come: a model without a scene stands still after a reset."""
    end, least = time.time() + seconds, program.memory()
    while time.time() < end:
        if client.rest or select.select([client.socket], [], [], 0.1)[0]:
            next_frame()
        least = min(least, program.memory())
    return least


def reset():
    """Begins anew; the least memory in the next 12 seconds."""
    global resets
    resets += 1
    client.send({"reset": True})
    end = time.time() + 120
    frame = next_frame()
    while frame["nodes"] != first["nodes"] or frame["time"] > 5:
        frame = next_frame()
        if time.time() > end:
            failures.append(f"{frame['nodes']} nodes, {frame['time']:.1f} s after a reset; {first['nodes']} and less than 5 s are expected")
            break
    return least_memory(12)


start = time.time()
settle = min(300, wish.minutes * 60 / 12)
while time.time() < start + 60 * wish.minutes:
    direction = [dice.gauss(0, 1) for _ in range(3)]
    size = sum(x * x for x in direction) ** 0.5
    eye = [m + 3 * radius * d / size for m, d in zip(middle, direction)]
    strokes += 1
    due = time.time() + 2
    stroke(client, eye, (around(1.2), around(1.2)), 2.4 * radius, 1.8 * radius, strokes, seconds=dice.uniform(0.2, 1.2))
    frame = next_frame()
    while time.time() < due:
        frame = next_frame()
    memory, age = program.memory(), time.time() - start
    most, highest = max(most, frame["pieces"]), max(highest, memory)
    if age > 60 * told:
        told += 1
        print(f"{age:5.0f} s: {strokes} strokes, {resets} resets, {frame['pieces']} pieces, {frame['nodes']} nodes, real time x {frame['sim_rate']:.2f}, "
              f"{frame['refused']} refused, {memory / 1e6:.0f} MB", flush=True)
    recent = [(a, t) for a, t in recent if a > age - 40] + [(age, frame["time"])]
    is_slow = age - recent[0][0] > 30 and frame["time"] - recent[0][1] < wish.slowest * (age - recent[0][0])
    if frame["pieces"] > wish.pieces or is_slow:
        recent, memory = [], reset()
        print(f"{age:5.0f} s: {memory / 1e6:.0f} MB after reset {resets}", flush=True)
        level = level or (memory if age > settle else None)
    if program.process.poll() is not None:
        failures.append("kerf-live ended: " + "".join(program.said))
        break
last = reset()
level = level or last
if abs(last - level) > 0.1 * level:
    failures.append(f"memory went from {level / 1e6:.0f} MB to {last / 1e6:.0f} MB")
for notice in client.notices:
    said[notice.get("error") or notice.get("notice") or ""] += 1
if said[""]:
    failures.append(f"{said['']} notices without a reason")
for text, count in sorted(said.items()):
    print(f"said {count} times: {text}")
print(f"{strokes} strokes, {frames} frames, {resets} resets, at most {most} pieces, at most {slowest:.1f} s for a frame, {client.bytes / 1e6:.0f} MB sent; memory {level / 1e6:.0f} MB "
      f"after a reset at {settle:.0f} s or later, {last / 1e6:.0f} MB after one at the end, at most {highest / 1e6:.0f} MB")
client.close()
code = program.stop()
if code != 0:
    failures.append(f"kerf-live's exit code is {code}: {''.join(program.said)}")
for failure in failures:
    print("FAILED:", failure)
sys.exit(bool(failures))
