#!/usr/bin/env bash
# damaged.sh SOURCE DUBSAR FOLDER: a collection with bags, things kept aside and damaged sessions: what can be done is done,
# what is lost is told for as long as it is so, and nothing is done twice for it.
set -euo pipefail
workflows=$1/workflows
export DUBSAR=$2
folder=$3
fail() { echo "FAILED: $*" >&2; exit 1; }
rm -rf "$folder"
mkdir -p "$folder"

# What lies in a bag, or was kept aside, is no tablet; no session is left out in silence.
mkdir -p "$folder"/bag/data/{kept/mesh,model,$'broken\nname',closed} "$folder"/{tablet,tablet.kept-1/mesh,tablet.kept-x} \
  "$folder"/parts/{wall.damaged-12/data,of/data/session}
touch "$folder"/{bag,parts/of}/bagit.txt "$folder"/bag/data/{kept/mesh/model.ply,model/tablet.ply} \
  "$folder"/tablet.kept-1/mesh/model.ply "$folder"/tablet{,.kept-x}/model.ply \
  "$folder"/parts/{wall.damaged-12/data,of/data/session}/session.sqlite "$folder/bag/data/session.backup.sqlite"
ln -s . "$folder/bag/data/loop"
listed=$("$workflows/list-tablets" "$folder" 2>"$folder/said")
[ "$listed" = $'tablet\ntablet.kept-x' ] || fail "list-tablets: $listed"
said=$(LC_ALL=C sort "$folder/said")
left_out="a session in a bag or kept aside, left out; copy it out, or give its folder another name"
[ "$said" = "list-tablets: parts/of/data/session: $left_out
list-tablets: parts/wall.damaged-12/data: $left_out" ] || fail "list-tablets says: $said"
status=0
said=$("$workflows/list-tablets" "$folder/bag" 2>&1) || status=$?
[[ "$status $said" == "2 list-tablets: the collection is a bag"* ]] || fail "list-tablets of a bag: $status $said"
rm -r "$folder"/*

# do_tablet STATUS NAME
do_tablet() {
  local status=0
  "$workflows/do-tablet" "$folder" "$2" 2>"$folder/said" || status=$?
  [ "$status" = "$1" ] || fail "$2: status $status, not $1: $(cat "$folder/log/$2.log")"
}
logged() { grep -qE " pid=[0-9]+ $2" "$folder/log/$1.log" || fail "$1: not logged: $2: $(cat "$folder/log/$1.log")"; }
times() { grep -cE " $2( |\$)" "$folder/log/$1.log" || true; }
"$DUBSAR" -q scan --auto --device 'sim:?seed=1&size=12x10x7&spacing=0.15&noise=0.01' --session "$folder/whole" \
  --max-scans 3 >/dev/null 2>&1 || [ $? = 1 ] || fail "no session"
"$DUBSAR" -q session describe "$folder/whole" --museum-number 'BM 77' >/dev/null

# A scan that cannot be read.
cp -r "$folder/whole" "$folder/lost"
mv "$folder/lost/grids/001.grid" "$folder/001.grid"
export DUBSAR_EXPORT=yes
do_tablet 1 lost
grep -q 'do-tablet: lost: falls short: damaged: grids/001.grid: missing' "$folder/said" || fail "not said: $(cat "$folder/said")"
logged lost 'session falls-short damaged: grids/001.grid: missing'
logged lost 'stitch end left_out \[\{"id":1,"file":".*","state":"unreadable","reason":"grids/001.grid: missing; .*"\}\]$'
logged lost 'analyze end$'
logged lost 'export end lacking \["Scan 1 is damaged.*"\]$'
[[ $(tail -n 1 "$folder/log/lost.log") == *" tablet falls-short status=1 damaged: grids/001.grid: missing; "* ]] || fail "the last line: $(cat "$folder/log/lost.log")"
do_tablet 1 lost
[ "$(times lost '(stitch|analyze|export) end')" = 3 ] || fail "what is damaged was done twice: $(cat "$folder/log/lost.log")"
logged lost 'stitch found-done left_out \[\{"id":1,'
logged lost 'export found-done$'
do_tablet 0 whole
status=0
said=$("$workflows/check-collection" "$folder" 2>/dev/null) || status=$?
[[ "$status $said" == "1 lost: falls short: damaged: grids/001.grid: missing; "* ]] || fail "check-collection: $status $said"
[ "$(wc -l <<<"$said")" = 1 ] || fail "check-collection: $said"
# To an engine it is done; brought back, it is done anew, and whole.
printf 'lost\nwhole\n' >"$folder/list"
DUBSAR_LIST=$folder/list DUBSAR_SHARE=2 DUBSAR_COLLECTION=$folder DUBSAR_WORKFLOWS=$workflows SLURM_ARRAY_TASK_ID=0 \
  "$workflows/slurm-array" 2>/dev/null || fail "a task with a tablet that falls short"
mv "$folder/001.grid" "$folder/lost/grids/"
do_tablet 0 lost
[ "$(times lost '(analyze|export) end')" = 4 ] || fail "what was mended was not done anew: $(cat "$folder/log/lost.log")"
"$workflows/check-collection" "$folder" >/dev/null 2>&1 || fail "check-collection of what was mended"

# A row of the record, in the database and in its backup: the package that holds it stays.
LC_ALL=C sed -i 's/BM 77/CM 77/g' "$folder"/lost/session.sqlite "$folder"/lost/session.backup.sqlite
before=$(cat "$folder"/lost.results/package/manifest-*.txt)
do_tablet 1 lost
logged lost 'session falls-short damaged: .*the database is damaged'
logged lost 'export falls-short \{"error":'
[ "$before" = "$(cat "$folder"/lost.results/package/manifest-*.txt)" ] || fail "a package that holds what is lost was replaced"
said=$("$workflows/check-collection" "$folder" 2>/dev/null) && fail "check-collection overlooks a damaged record"
[[ $said == "lost: falls short: damaged: "*"the database is damaged"* ]] || fail "check-collection: $said"
rm -r "$folder"/lost*

# Who is stopped ends with status 1, too: that is not done. Nor is whole what failed later.
cat >"$folder/stopped" <<'STOPPED'
#!/usr/bin/env bash
case " $* " in *" export "*) echo '{"error":{"what":"stopped","where":"","mend":""}}'; exit 1 ;; esac
exec "$REAL_DUBSAR" "$@"
STOPPED
chmod +x "$folder/stopped"
REAL_DUBSAR=$DUBSAR DUBSAR=$folder/stopped do_tablet 4 whole
logged whole 'export failed status=4 \{"error":'
said=$("$workflows/check-collection" "$folder" 2>/dev/null) && fail "check-collection overlooks a failure"
[[ $said == 'whole: was done before, and then: export failed status=4 {"error":'* ]] || fail "check-collection: $said"
DUBSAR_EXPORT=no "$workflows/check-collection" "$folder" 2>/dev/null || fail "check-collection, of wedges alone"

# What a person has said in the session is in its wedges here as in its package, and made out once.
do_tablet 0 whole
beside=$folder/whole.results/wedges.json
wedges_of() { grep -c '"confidence"' "$1"; }
before=$(wedges_of "$beside")
place=$(tr -d ' \n' <"$beside" | sed -E 's/.*"wedges":\[\{"id":0,"depth_point":(\[[^]]*\]).*/\1/')
echo "{\"unit\":\"mm\",\"mesh\":\"model.ply\",\"corrections\":[{\"do\":\"delete\",\"at\":[$place]}]}" \
  >"$folder/whole/analysis/wedges.corrections.json"
do_tablet 0 whole
[ "$(wedges_of "$beside")" = $((before - 1)) ] || fail "$before wedges, and one taken out: $(wedges_of "$beside")"
[ "$(wedges_of "$folder/whole.results/package/data/wedges/wedges.json")" = $((before - 1)) ] || fail "the package has others"
done_before=$(times whole 'analyze end')
do_tablet 0 whole
[ "$(times whole 'analyze end')" = "$done_before" ] || fail "corrected wedges were made out twice"
# The session keeps its own mesh, which was stitched before it had a number: its wedges have the number all the same.
[ "$(times whole 'stitch begin')" = 0 ] || fail "the mesh of the session was stitched again"
grep -q '"BM 77"' "$beside" || fail "no museum number: $(head -n 12 "$beside")"
# A search finds the tablet once, however often its wedges lie here.
said=$("$DUBSAR" -q search "$folder" --like "$beside" --json 2>/dev/null) || fail "search"
[[ $said == *'"files":1,'* ]] || fail "a search takes one tablet for more: $said"
# Those beside the wedges are used where the session has none, else told of.
mv "$folder/whole/analysis/wedges.corrections.json" "$folder/whole.results/"
DUBSAR_EXPORT=no do_tablet 0 whole
[ "$(wedges_of "$beside")" = $((before - 1)) ] || fail "corrections beside the wedges are not used"
echo '{"unit":"mm","mesh":"model.ply","corrections":[]}' >"$folder/whole/analysis/wedges.corrections.json"
DUBSAR_EXPORT=no do_tablet 0 whole
[ "$(wedges_of "$beside")" = "$before" ] || fail "corrections beside the wedges come before those of the session"
logged whole 'analyze passes over whole.results/wedges.corrections.json: '

# Of a session without a standing scan there are no wedges; it is packed all the same.
cp -r "$folder/whole" "$folder/none"
for scan in 0 1 2; do "$DUBSAR" -q session drop "$folder/none" $scan >/dev/null || fail "drop"; done
do_tablet 2 none
logged none 'export end'
"$DUBSAR" -q verify "$folder/none.results/package" >/dev/null 2>&1 || fail "the package of a session without a scan"
said=$("$workflows/check-collection" "$folder" 2>/dev/null) && fail "check-collection overlooks a session without a scan"
[[ $said == 'none: is not done: stitch failed status=2 {"error":{"what":"no scan in it"'* ]] || fail "check-collection: $said"
rm -r "$folder"/none* "$folder/log/none.log"

# A start that was cut off anywhere is told of, for what there is may be of the start before.
"$workflows/check-collection" "$folder" 2>/dev/null || fail "check-collection before a cut"
cp "$folder/log/whole.log" "$folder/whole.log"
line=$(tail -n 1 "$folder/whole.log" | grep -o '^.* pid=[0-9]*')
for said in 'verify begin' 'session falls-short damaged: one' 'stitch begin' 'stitch end left_out [{}]' 'analyze begin' 'export begin'; do
  { cat "$folder/whole.log"; echo "$line $said"; } >"$folder/log/whole.log"
  told=$("$workflows/check-collection" "$folder" 2>/dev/null) && fail "check-collection overlooks a start that was cut off at $said"
  [ "$told" = "whole: was done before, and then: ${said%% *} was begun and not ended; start do-tablet again" ] || fail "check-collection: $told"
done
DUBSAR_EXPORT=no "$workflows/check-collection" "$folder" 2>/dev/null || fail "check-collection, of wedges alone, before a package"
cp "$folder/whole.log" "$folder/log/whole.log"
