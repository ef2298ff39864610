#!/usr/bin/env bash
# not_done.sh SOURCE FOLDER: what workflows/do-tablet itself cannot go on with (a full disk, a collection that is not mounted or
# read only, names in each other's way) is not done, to be tried again, and a failed task of a Slurm array. dubsar is a stub.
set -euo pipefail
workflows=$1/workflows
folder=$2
fail() { echo "FAILED: $*" >&2; exit 1; }
chmod -R u+w "$folder" 2>/dev/null || true
rm -rf "$folder" "$folder.results"
mkdir -p "$folder/stub" "$folder/c"
cat >"$folder/stub/dubsar" <<'STUB'
#!/usr/bin/env bash
case " $* " in
  *" session mesh "*) echo own.ply ;;
  *" analyze "*)
    [ -z "${CHANGE:-}" ] || [ -e "${ONCE:-/nowhere}" ] || echo more >>"$CHANGE"
    [ -z "${ONCE:-}" ] || touch "$ONCE"
    [ -z "${SPOIL:-}" ] || { rm "$SPOIL"; ln -s /dev/full "$SPOIL"; exit 3; }; echo '{"wedges":3}' ;;
  *) echo '{"whole":1}' ;;
esac
STUB
chmod +x "$folder/stub/dubsar"
export DUBSAR=$folder/stub/dubsar
session() { mkdir -p "$folder/c/$1"; touch "$folder/c/$1/session.sqlite"; }

bound=()  # root writes everywhere, unless it is bound
[ "$(id -u)" != 0 ] || bound=(setpriv --bounding-set "-dac_override,-dac_read_search")
# ends STATUS TABLET [COLLECTION]: do-tablet's, and for an engine a failed task unless it is 0 or 1.
ends() {
  local status=0 task=0 collection=${3-$folder/c}
  "${bound[@]}" "$workflows/do-tablet" "$collection" "$2" 2>"$folder/said" || status=$?
  [ "$status" = "$1" ] || fail "${2:0:40}: status $status, not $1: $(cat "$folder/said")"
  printf '%s\n' "$2" >"$folder/list"
  DUBSAR_LIST=$folder/list DUBSAR_SHARE=1 SLURM_ARRAY_TASK_ID=0 DUBSAR_COLLECTION=$collection DUBSAR_WORKFLOWS=$workflows \
    "${bound[@]}" "$workflows/slurm-array" 2>/dev/null || task=$?
  [ $((status > 1)) = $((task > 0)) ] || fail "${2:0:40}: status $status, and of the task $task"
}

session a
ends 0 a
# By whatever name it goes, what comes of it lies beside it.
mv "$folder/c/a.results" "$folder/c/log" "$folder"
ends 0 a//
[ "$(ls -A "$folder/c") $(ls -A "$folder/c/a") $(ls "$folder/c/log")" = $'a\na.results\nlog session.sqlite a.log' ] ||
  fail "a session with a slash at its end: $(ls -AR "$folder/c")"
ends 2 ''
rm -r "$folder/c/log" "$folder/a.results" "$folder/log"
mkdir "$folder/c/log"
ln -s /dev/full "$folder/c/log/a.log"
ends 4 a
grep -q 'do-tablet: a: not done' "$folder/said" || fail "not said: $(cat "$folder/said")"
# What dubsar said stays what it said where no line of it can be written any more.
rm "$folder/c/log/a.log"
SPOIL=$folder/c/log/a.log ends 3 a
grep -q 'do-tablet: a: analyze failed status=3' "$folder/said" || fail "no reason: $(cat "$folder/said")"
rm "$folder/c/log/a.log"

# What changes meanwhile is not what was done, and the mark of an engine would be newer.
CHANGE=$folder/c/a/session.sqlite ends 4 a
grep -q ' tablet failed status=4 it was changed while it was done' "$folder/c/log/a.log" || fail "no reason: $(cat "$folder/c/log/a.log")"
rm "$folder/c/log/a.log"
CHANGE=$folder/c/a/session.sqlite ONCE=$folder/once "$workflows/do-tablet" "$folder/c" a || fail "a session that changed once"
[ "$(grep -c ' analyze end$' "$folder/c/log/a.log")" = 2 ] || fail "not looked at again: $(cat "$folder/c/log/a.log")"
# What a start left half-written goes when nobody can be writing it any more.
touch -d '2 hours ago' "$folder/c/a.results/.dubsar-tmp-1-0"
touch "$folder/c/a.results/.dubsar-tmp-2-0"
ends 0 a
[ "$(ls -A "$folder/c/a.results")" = .dubsar-tmp-2-0 ] || fail "left behind: $(ls -A "$folder/c/a.results")"

chmod -R a-w "$folder/c"
ends 4 a
chmod -R u+w "$folder/c"
session b
touch "$folder/c/b.results"
ends 4 b
session "$(printf 'n%.0s' {1..252})"
ends 4 "$(printf 'n%.0s' {1..252})"
session x
session x.log/y
ends 0 x
ends 4 x.log/y
ends 4 a "$folder/nowhere"

# A list that cannot be read, or has nothing for the task, is no task that was done.
task() {
  status=0
  DUBSAR_LIST=$1 DUBSAR_SHARE=1 SLURM_ARRAY_TASK_ID=$2 DUBSAR_COLLECTION=$folder/c DUBSAR_WORKFLOWS=$workflows \
    "$workflows/slurm-array" 2>"$folder/said" || status=$?
}
task "$folder/nowhere" 0
[ $status = 4 ] || fail "a list that is not there: status $status"
task "$folder/list" 7
[ $status = 2 ] || fail "a task without a tablet: status $status"

# Snakemake on a cluster, where nobody has said how many cores there are: its own word for them raises an error.
threads=$(sed -n 's/^    threads: //p' "$workflows/Snakefile")
THREADS=$threads python3 - <<'PYTHON' || fail "Snakefile: threads on a cluster: $threads"
import os
class Cluster:
    @property
    def cores(self):
        raise RuntimeError("Workflow requires a total number of cores to be defined")
class Machine:
    cores = 8
expression = os.environ["THREADS"]
assert eval(expression, {"config": {"threads": "2"}, "workflow": Cluster()}) == 2
assert eval(expression, {"config": {"threads": "2"}, "workflow": Machine()}) == 2
assert eval(expression, {"config": {}, "workflow": Machine()}) == 8
PYTHON

# A name that Snakemake does not take is left out: it would keep all others from being done.
REFUSAL=$(sed -n '/^def refusal/,/^$/p' "$workflows/Snakefile") python3 - <<'PYTHON' || fail "Snakefile: names that are taken"
import os
import re
exec(os.environ["REFUSAL"])
for name in (b"BM {b}", b"{ b }", b"a{1,2}/c", b"o\xffd"):
    assert refusal(os.fsdecode(name)), name
for name in ("BM 1", "a {b c}", "{}", "}{", "{-}", "ö {"):
    assert not refusal(name), name
PYTHON

# A session that is called log is only read, too.
session log
ends 0 log
[ "$(ls "$folder/c/log" | grep -c '^log')" = 0 ] || fail "the log lies in the session: $(ls "$folder/c/log")"
grep -q ' analyze end$' "$folder/c.results/log/log.log" || fail "no log"
