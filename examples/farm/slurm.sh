#!/usr/bin/env bash
# Pictures of a folder of models by a Slurm array job, a part per task:
#
#     sbatch --array=1-8 examples/farm/slurm.sh MODELS OUT
#
# Tessera finds in SLURM_ARRAY_TASK_* which part is its own. A task whose node failed, or that had to make way, is
# queued again and does what is missing; one that ran out of its time or memory is not: submit it again, with the same
# array (what is there already takes no time). When all tasks are done:
#
#     tessera merge-report OUT/reports/*.json -o OUT/report.json
#
#SBATCH --job-name=tessera
#SBATCH --array=1-8
#SBATCH --cpus-per-task=4
#SBATCH --mem=8G
#SBATCH --time=01:00:00
#SBATCH --requeue
#SBATCH --open-mode=append
set -euo pipefail
models=${1:?usage: sbatch --array=1-N slurm.sh MODELS OUT}
out=${2:?usage: sbatch --array=1-N slurm.sh MODELS OUT}
: "${SLURM_ARRAY_TASK_ID:?run this as an array job: sbatch --array=1-N}"

mkdir -p "$out/reports"
# --max-memory is that of the scenes and of the frames each: together three quarters of --mem.
exec "${TESSERA:-tessera}" batch "$models" -o "$out/{path}.{extension}.png" -s 512x512 --background none \
    --max-memory 3G --timeout 600 --skip-existing --report "$out/reports/$SLURM_ARRAY_TASK_ID.json"
