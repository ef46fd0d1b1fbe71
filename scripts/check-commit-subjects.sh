#!/usr/bin/env bash
# Checks the subjects of the commits after BASE, merges aside: "area: verb object", at most 72
# characters, no full stop at the end. There is one area, of one or two words in lower case ("can",
# "command line"). The verb is imperative: it does not end as "added", "adding" or "adds" do.
#
#   scripts/check-commit-subjects.sh BASE    in the repository of the working directory
set -euo pipefail
export LC_ALL=C.UTF-8 # characters, not bytes, are counted

area='^[a-z0-9_./-]+( [a-z0-9_./-]+)?: '
# Imperatives that end like other forms.
imperatives=' embed exceed feed need proceed seed shed speed bring ping ring sing string swing wing alias bias focus '

fault() { # fault SUBJECT: what is wrong with it, nothing when it is right
  local verb
  if [ ${#1} -gt 72 ]; then
    echo "has ${#1} characters, allowed 72"
  elif [[ ! $1 =~ $area ]]; then
    echo 'is not "area: verb object" with one area in lower case'
  elif [[ $1 == *. ]]; then
    echo "ends with a full stop"
  else
    verb=${1#*: }
    verb=${verb%%[ ,]*}
    if [[ $imperatives != *" $verb "* && $verb =~ (ed|ing|[^s]s)$ ]]; then
      echo "does not begin with an imperative: '$verb'"
    elif [[ ! $verb =~ ^[a-z] ]]; then
      echo "does not begin with a verb in lower case: '$verb'"
    fi
  fi
}

base=$(git rev-parse --verify --quiet "${1:?no BASE}^{commit}") || {
  echo "check-commit-subjects: no commit '$1'" >&2
  exit 2
}
commits=0
breaches=0
while read -r commit subject; do
  commits=$((commits + 1))
  found=$(fault "$subject")
  if [ -n "$found" ]; then
    echo "$commit \"$subject\": $found"
    breaches=$((breaches + 1))
  fi
done < <(git log --no-merges --format='%h %s' "$base..HEAD")
echo "$commits subjects of commits read, $breaches breaches"
[ $breaches = 0 ]
