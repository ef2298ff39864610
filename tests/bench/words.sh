#!/usr/bin/env bash
# words.sh FOLDER: the benches there refuse words that are none of theirs, with one line and status 2.
set -euo pipefail
folder=$1
fail() { echo "FAILED: $*" >&2; exit 1; }
# refuses WORD BENCH ...: WORD stands among what follows the bench's name.
refuses() {
  local status=0 said
  said=$(timeout 20 "$folder/$2" "${@:3}" 2>&1) || status=$?
  [ "$status" = 2 ] || fail "${*:2}: status $status: ${said:0:300}"
  [[ $said == *"$1"* && $said != *$'\n'* ]] || fail "${*:2}: says: $said"
}
refuses wron dubsar-registration --kind wron
refuses labeled dubsar-registration --pins labeled
refuses wron dubsar-pins --kind wron
refuses metres dubsar-pairs --unit metres .
refuses metres dubsar-fields --unit metres
refuses metres dubsar-evaluate poses --unit metres poses.json scans
refuses nan dubsar-false-accepts 1 1 --gripped-every nan
echo "all well"
