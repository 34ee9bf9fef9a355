#!/bin/bash
# What kerf-view draws besides pages: pictures of every kind of thing, animations; the same for any number of threads.
#   tests/tools/pictures.sh TOOLS_DIR SAMPLES_DIR
set -u
. "$(dirname "$(realpath "$0")")/answers.sh"
PATH=$1:$2:$PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
draw() { kerf-view "$@" --size 96x72 --samples 1 -q || fail "kerf-view $*"; }

kerf-model pumpkin --frequency 8 -o p.ply
kerf-model front --around p.ply --steps 8 -o halve.front
kerf-sample p.ply -n 400 | kerf-graph --surface p.ply -o p.kerf
kerf-crack p.ply --front halve.front --steps 0:5 -o half.ply
kerf-crack p.ply --front halve.front -o whole.ply
kerf-update p.kerf --surface half.ply -o half.kerf
kerf-update p.kerf --surface whole.ply -o whole.kerf

# Each option changes what is drawn.
draw half.kerf --opacity 0.3 -o plain.png
for options in --nodes --edges --cut-edges "--cut-edges --before p.kerf" "--nodes --field neighbors" "--nodes --before p.kerf" "--node 7" "--node 7 --zoom 3" --trees "--trees --node 7" --seams --wire --sheets "--cut-away 0,-1,0"; do
  draw half.kerf --opacity 0.3 $options -o "drawn $options.png"
  for other in plain.png "drawn "*.png; do
    [ "$other" = "drawn $options.png" ] || ! cmp -s "$other" "drawn $options.png" || fail "'$options' draws what $other has"
  done
done
draw half.ply halve.front -o front.png
draw half.ply halve.front --steps 4:5 -o step.png
cmp -s front.png step.png && fail "--steps changes nothing"
# Nodes move with their pieces.
draw whole.kerf --opacity 0.3 --nodes --explode 0.8 -o apart.png
draw whole.kerf --opacity 0.3 --nodes --explode 0.8 -j 1 -o again.png
cmp apart.png again.png || fail "threads change the picture"

# However large a model is, and wherever it stands: the same picture.
for size in 1 1e-20 1e20; do
  awk -v s=$size 'BEGIN { s = 2 ^ int(log(s) / log(2)); for (i = 0; i < 8; ++i) printf "v %.17g %.17g %.17g\n", s * (i % 2), s * (int(i / 2) % 2), s * int(i / 4)
    print "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 2 4 8 6\nf 4 3 7 8\nf 3 1 5 7" }' >cube$size.obj
  draw cube$size.obj -o cube$size.png
  cmp cube1.png cube$size.png || fail "a cube of $size looks otherwise"
done
sed 's/^v \([01]\)/v 100000000\1/' cube1.obj >far.obj
draw far.obj -o far.png
cmp cube1.png far.png || fail "a cube that is far away looks otherwise"

# Whatever is drawn fills the picture one way or the other, and is in its middle.
awk '/^v/ { print $1, 9 * $2, $3, $4; next } { print }' cube1.obj >bar.obj
awk '/^v/ { print $1, $2, $3, 7 * $4; next } { print }' cube1.obj >tower.obj
awk '/^v/ { print $1, ($2 - $3) * 4, ($2 + $3) * 4, $4; next } { print }' cube1.obj >tilted.obj
for model in cube1 bar tower tilted; do
  for camera in 0,0 30,22 -75,-10 140,60; do
    draw $model.obj --camera "$camera" --no-ground -o seen.png
    ffmpeg -v error -i seen.png -f rawvideo -pix_fmt rgb24 -y seen.rgb
    python3 - <<'P' || fail "$model from $camera"
data = open("seen.rgb", "rb").read()
here = [(i % 96, i // 96) for i in range(96 * 72) if data[3 * i] > data[3 * i + 2] + 20]
low, high = [min(p[k] for p in here) for k in (0, 1)], [max(p[k] for p in here) + 1 for k in (0, 1)]
filled = max((high[0] - low[0]) / 96, (high[1] - low[1]) / 72)
assert 0.8 < filled < 0.88, filled
assert abs(low[0] + high[0] - 96) <= 2 and abs(low[1] + high[1] - 72) <= 2, (low, high)
P
  done
done

# Zoomed in on what is long, its middle is still seen; what is cut away leaves no empty half.
for zoom in 2 5 30; do
  draw bar.obj --camera 60,20 --zoom $zoom --no-ground -o seen.png
  draw bar.obj --camera 0,0 --cut-away 1,0,0,-0.5 --zoom $((zoom / 3 + 1)) --no-ground -o cut.png
  for picture in seen cut; do
    ffmpeg -v error -i $picture.png -f rawvideo -pix_fmt rgb24 -y seen.rgb
    python3 -c 'data = open("seen.rgb", "rb").read(); at = 3 * (96 * 36 + 48); assert data[at] > data[at + 2] + 20' || fail "$picture at zoom $zoom"
  done
done

# A model whose y is up, stood up.
awk '/^v/ { print $1, $2, $4, -$3; next } { print }' cube1.obj >lying.obj
draw lying.obj --up y -o standing.png
cmp cube1.png standing.png || fail "--up y does not stand a cube up"
draw lying.obj --up y --cut-away 0,0,1,0.1 -o standing.png
draw cube1.obj --cut-away 0,-1,0,0.1 -o cut.png
cmp cut.png standing.png || fail "--up y moves the cut-away"

# A model's images and colours: those of a cube whose left half is red and right half green, told by the pixels.
python3 - <<'P'
import struct, sys, zlib
def png(width, pixels):
    rows = b"".join(b"\0" + bytes(c for p in pixels[i:i + width] for c in p) for i in range(0, len(pixels), width))
    parts = [(b"IHDR", struct.pack(">IIBBBBB", width, len(pixels) // width, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(rows)), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(struct.pack(">I", len(d)) + n + d + struct.pack(">I", zlib.crc32(n + d)) for n, d in parts)
# The upper row is red and green, the lower one blue twice: v points upwards.
open("halves.png", "wb").write(png(2, [(255, 0, 0), (0, 255, 0), (0, 0, 255), (0, 0, 255)]))
open("broken.png", "wb").write(png(2, [(255, 0, 0)] * 4)[:60])
P
{ echo "mtllib halves.mtl"; grep '^v' cube1.obj
  printf 'vt 0.25 0.75\nvt 0.75 0.75\nvt 0.25 0.25\nusemtl red\nf 1/1 3/1 4/1 2/1\nf 5/1 6/1 8/1 7/1\nf 1/1 2/1 6/1 5/1\nusemtl green\nf 2/2 4/2 8/2 6/2\nf 4/3 3/3 7/3 8/3\nf 3/2 1/2 5/2 7/2\n'; } >halves.obj
printf 'newmtl red\nmap_Kd -clamp on halves.png\nnewmtl green\nmap_Kd -clamp on halves.png\n' >halves.mtl
sed 's/halves/broken/' halves.mtl >broken.mtl && sed 's/halves/broken/' halves.obj >broken.obj
# told PICTURE: the colour in the middle of it: r, g, b where one channel is the strongest by far
told() {
  ffmpeg -v error -i "$1" -f rawvideo -pix_fmt rgb24 -y seen.rgb
  python3 -c 'd = open("seen.rgb", "rb").read(); p = d[3 * (96 * 36 + 48):][:3]; print("rgb"[p.index(max(p))] if max(p) > 2 * sorted(p)[1] else "-")'
}
for view in 0,0=r 90,0=g 180,0=b -90,0=g; do
  draw halves.obj --camera "${view%=*}" --no-ground -o seen.png
  [ "$(told seen.png)" = "${view#*=}" ] || fail "halves.obj from ${view%=*} is $(told seen.png)"
done
draw halves.obj --camera 90,0 --no-ground --color patch -o patch.png
draw cube1.obj --camera 90,0 --no-ground -o plain.png
cmp -s patch.png plain.png || fail "--color patch shows materials"
awk '/^v/ { print $0, 0, 0, ($2 > 0 ? 1 : 0.5); next } { print }' cube1.obj >colored.obj
draw colored.obj --camera 0,0 --no-ground -o seen.png
[ "$(told seen.png)" = b ] || fail "colours of vertices are not drawn"
# A damaged image is left out and named, by every tool.
kerf-view broken.obj --size 96x72 --samples 1 -o seen.png 2>said.txt || fail "broken.obj is not drawn"
[ "$(cat said.txt)" = "kerf-view: broken.obj: left out of its materials: image broken.png, which is cut off" ] || fail "broken.obj: $(cat said.txt)"
kerf-pieces broken.obj -o broken.glb 2>said.txt || fail "broken.obj has no pieces"
grep -q 'image broken.png, which is cut off' said.txt && ! grep -aq '"images"' broken.glb || fail "a damaged image is in broken.glb: $(cat said.txt)"
# Images of formats that are not drawn are told in a line, by pictures and pages.
python3 "$(dirname "$(realpath "$0")")/../assets/painted.py"
python3 -c 'd = bytearray(open("painted.glb", "rb").read()); i = d.index(b"\x89PNG"); d[i:i + 12] = b"RIFF____WEBP"; open("webp.glb", "wb").write(d)'
for name in seen.png seen.html; do
  kerf-view painted.glb --size 96x72 --samples 1 -o $name 2>said.txt && [ ! -s said.txt ] || fail "painted.glb: $(cat said.txt)"
  kerf-view webp.glb --size 96x72 --samples 1 -o $name 2>said.txt || fail "webp.glb is not drawn"
  [ "$(cat said.txt)" = "kerf-view: left out: images of materials that are no PNG or JPEG, or that cannot be decoded" ] || fail "webp.glb: $(cat said.txt)"
done

# Animations: as many frames as asked for, the same bytes again.
draw whole.ply --explode 0.5 --frames 5 -o turn.webp
draw whole.ply --explode 0.5 --frames 5 -j 1 -o again.webp
cmp turn.webp again.webp || fail "threads change the animation"
python3 - <<'P' || fail "turn.webp"
data = open("turn.webp", "rb").read()
assert data[:4] == b"RIFF" and data[8:12] == b"WEBP" and int.from_bytes(data[4:8], "little") + 8 == len(data)
assert data.count(b"ANMF") == 5 and data.count(b"ANIM") == 1
P
mkdir frames && cp p.ply frames/frame_0000.ply && cp half.ply frames/frame_0001.ply && cp whole.ply frames/frame_0002.ply
draw frames --rate 10 -o run.mp4
[ "$(ffprobe -v error -count_frames -select_streams v -show_entries stream=codec_name,width,height,nb_read_frames -of csv=p=0 run.mp4)" = h264,96,72,3 ] || fail "run.mp4: $(ffprobe -v error -show_streams run.mp4)"
draw frames --frames 2 -o two.webp
[ "$(grep -ao ANMF two.webp | wc -l)" = 2 ] || fail "--frames"
# Refused.
refuses 65 "no field 'colour', but radius" kerf-view half.kerf --nodes --field colour -o x.png
refuses 65 "no node 9999" kerf-view half.kerf --node 9999 -o x.png
refuses 65 "second file with nodes" kerf-view half.kerf p.kerf -o x.png
refuses 65 "more nodes" kerf-view p.kerf --nodes --before half.kerf -o x.png
refuses 2 "A:B" kerf-view half.ply halve.front --steps 5:4 -o x.png
refuses 2 "one folder" kerf-view frames p.ply -o x.png
refuses 2 "give a file" kerf-view -o x.png
refuses 73 "ffmpeg is not installed" env PATH="$1:$2" kerf-view whole.ply --size 64x48 -o x.mp4
[ ! -e x.png ] && [ ! -e x.mp4 ] || fail "something is left behind"
ls ./*.tmp >/dev/null 2>&1 && fail "something is left behind: $(ls ./*.tmp)"
exit $failed
