#!/usr/bin/env bash
# A campaign as a Slurm array, in a folder that all nodes see. Waits for the end, and collects.
# Started again it goes on where it was: what is DONE is not run again.
#
#   configs/campaigns/engines/slurm.sh CAMPAIGN FOLDER [RUNS_PER_TASK]
#
# A task takes one CPU and the scheduler about a second: runs that are shorter than some tens of
# seconds are better done several in a task (10). SBATCH_PARTITION, SBATCH_TIMELIMIT and the other
# variables of sbatch hold as always.
set -euo pipefail

campaign=$(realpath -e "$1") folder=$(realpath -m "$2") each=${3:-10}
rigwire=$(command -v "${RIGWIRE:-rigwire}")

"$rigwire" campaign expand "$campaign" -o "$folder"
runs=$(($(wc -l <"$folder/table.csv") - 1))
tasks=$(((runs + each - 1) / each))
mkdir -p "$folder/slurm"
export rigwire campaign folder each runs # sbatch hands the environment on
job=$(sbatch --parsable --job-name=rigwire --array="0-$((tasks - 1))" --cpus-per-task=1 \
  --output="$folder/slurm/%a.txt" --open-mode=append <<'JOB'
#!/usr/bin/env bash
first=$((SLURM_ARRAY_TASK_ID * each))
last=$((first + each < runs ? first + each - 1 : runs - 1))
# In place of the shell, so that Slurm's SIGTERM arrives.
exec "$rigwire" campaign run "$campaign" --index "$first-$last" -o "$folder"
JOB
)
echo "job $job: $runs runs in $tasks tasks"
trap 'scancel "$job"; exit 130' INT TERM
# sbatch --wait looks ever more rarely.
while [ -n "$(squeue --noheader --jobs="$job" 2>/dev/null || true)" ]; do sleep 1; done
"$rigwire" campaign collect "$folder"
