#!/bin/sh
# The batch of samples/batch: run whole, and run killed (everything, without warning) and taken up again: the same files.
#   batch.sh BUILD_DIR BATCH_DIR       exit 77 where there is no snakemake
set -eu
PATH=$1/tools:$1/samples:$PATH
command -v snakemake >/dev/null || exit 77
stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
cd "$stage"
export HOME="$stage" XDG_CACHE_HOME="$stage"
mkdir models
for f in 3 4; do kerf-model pumpkin --frequency $f -o models/pumpkin-$f.ply; done
cat >config.yaml <<END
models: [../models/pumpkin-3.ply, ../models/pumpkin-4.ply]
out: out
score: {pattern: voronoi, pieces: 5, jagged: 0.01, seed: 3}
own: {pumpkin-4: {pattern: planes, pieces: 3}}
END
for run in whole killed; do
  mkdir $run
  cp "$2/Snakefile" config.yaml $run
done
batch() { snakemake -d $run -s $run/Snakefile --configfile config.yaml --cores 2 -q "$@"; }

run=whole
batch >log 2>&1 || { cat log; exit 1; }

run=killed
setsid sh -c 'snakemake -d killed -s killed/Snakefile --configfile config.yaml --cores 1 -q' >log 2>&1 &
group=$!
until ls killed/out/*.ply >/dev/null 2>&1; do
  kill -0 $group || { cat log; exit 1; }
  sleep 0.05
done
kill -9 -$group
wait $group || true
made=$(find killed/out -maxdepth 1 -type f | wc -l)
batch --unlock >log 2>&1 || { cat log; exit 1; }
batch --rerun-incomplete >log 2>&1 || { cat log; exit 1; }

all=0
for file in whole/out/*.front whole/out/*.ply whole/out/*.glb whole/out/*.png; do
  cmp "$file" "killed/out/${file#whole/out/}"
  all=$((all + 1))
done
test $all = 8
test "$made" -lt $all
echo "$made of $all files were there when it was killed; all are the same"
