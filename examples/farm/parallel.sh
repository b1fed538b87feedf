#!/usr/bin/env bash
# Pictures of a folder of models by GNU parallel, on this machine or on several, a part per job:
#
#     examples/farm/parallel.sh MODELS OUT [PARTS [OPTION OF PARALLEL...]]
#     examples/farm/parallel.sh /shared/models /shared/out 16 --sshlogin a.example,b.example
#
# The folders and the command must be the same on all machines. A part that fails does not stop the others; run it again
# after a failure, and it does what is missing.
set -euo pipefail
models=${1:?usage: parallel.sh MODELS OUT [PARTS [OPTION OF PARALLEL...]]}
out=${2:?usage: parallel.sh MODELS OUT [PARTS [OPTION OF PARALLEL...]]}
parts=${3:-4}
shift $(($# < 3 ? $# : 3))
tessera=${TESSERA:-tessera}

mkdir -p "$out/reports"
rm -f "$out"/reports/*.json
# One part at a time per machine, for each uses all its processors. What stands in braces is tessera's, {} is parallel's.
seq 1 "$parts" | parallel --will-cite --quote --jobs 1 "$@" "$tessera" batch "$models" -o "$out/{path}.{extension}.png" \
    -s 512x512 --background none --skip-existing --shard "{}/$parts" --report "$out/reports/{}.json" || true
exec "$tessera" merge-report "$out"/reports/*.json -o "$out/report.json"
