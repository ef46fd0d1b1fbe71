#!/usr/bin/env bash
# A campaign with GNU parallel on this machine, or with --sshlogin on several that share the folder.
# Started again it goes on where it was: what is DONE is not run again.
#
#   configs/campaigns/engines/parallel.sh CAMPAIGN FOLDER [JOBS]
#
# Interrupted, it lets the runs that are on their way end, and begins no other.
set -euo pipefail

campaign=$1 folder=$2 jobs=${3:-$(nproc)}
rigwire=${RIGWIRE:-rigwire}

"$rigwire" campaign expand "$campaign" -o "$folder"
last=$(($(wc -l <"$folder/table.csv") - 2))
parallel --will-cite --halt never --jobs "$jobs" --joblog "$folder/parallel.txt" \
  "$rigwire" campaign run "$campaign" --index {} -o "$folder" < <(seq 0 "$last") &
engine=$!
trap 'kill -TERM "$engine"; wait "$engine" || true; exit 130' INT TERM
wait "$engine" || true # rows tell what crashed
"$rigwire" campaign collect "$folder"
