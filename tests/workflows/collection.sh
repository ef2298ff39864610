#!/usr/bin/env bash
# collection.sh SOURCE DUBSAR FOLDER: a collection of two tablets gone through by workflows/do-tablet, killed in the middle,
# started again; then a session with its package.
set -euo pipefail
workflows=$1/workflows
export DUBSAR=$2
folder=$3
fail() { echo "FAILED: $*" >&2; exit 1; }
rm -rf "$folder" "$folder.far"
mkdir -p "$folder/museum/a b" "$folder/session/grids"
"$DUBSAR" simulate tablet --seed 1 --size 12x10x7 --spacing 0.15 -o "$folder/museum/a b" >/dev/null 2>&1
"$DUBSAR" simulate tablet --seed 2 --size 20x16x9 --spacing 0.1 -o "$folder/museum/c" >/dev/null 2>&1
touch "$folder/session/session.sqlite" "$folder/session/grids/model.ply" "$folder/museum/readme.txt"

listed=$("$workflows/list-tablets" "$folder")
[ "$listed" = $'museum/a b\nmuseum/c\nsession' ] || fail "list-tablets: $listed"
# By its name it is the one that lies here, whatever the shell of who asks looks for folders in.
mkdir -p "$folder.far/$(basename "$folder")"
again=$(cd "$folder/.." && CDPATH=$folder.far:. "$workflows/list-tablets" "$(basename "$folder")")
[ "$again" = "$listed" ] || fail "list-tablets with a CDPATH: $again"
# At any depth, below folders of any name, and through links; of a session and its results nothing but the session.
mkdir -p "$folder"/export/one "$folder"/sub/mesh/two "$folder"/three "$folder"/session/{mesh,sub/package} \
  "$folder"/session.results/package "$folder"/lost/mesh "$folder"/.hidden "$folder.far/session"
touch "$folder"/export/one/tablet.ply "$folder"/sub/mesh/two/model.ply "$folder"/session/{mesh,sub/package}/model.ply \
  "$folder"/session.results/package/tablet.ply "$folder"/lost/session.backup.sqlite "$folder"/lost/mesh/model.ply \
  "$folder"/.hidden/model.ply "$folder.far/session/session.sqlite" "$folder.far/scan.ply"
ln -s "$folder.far/session" "$folder/linked"
ln -s "$folder.far/scan.ply" "$folder/three/model.ply"
listed=$("$workflows/list-tablets" "$folder" 2>"$folder/said")
[ "$listed" = $'export/one\nlinked\nmuseum/a b\nmuseum/c\nsession\nsub/mesh/two\nthree' ] || fail "list-tablets: $listed"
[[ $(cat "$folder/said") == "list-tablets: lost: a session without its session.sqlite"* ]] || fail "list-tablets: $(cat "$folder/said")"
# What comes again through a link is one tablet, by the name without a link where it has one; links alone give it the first.
mkdir "$folder.far/more"
cp -r "$folder/three" "$folder.far/more/four"
ln -s "$folder/session" "$folder/again"
ln -s "$folder.far/session" "$folder/zlinked"
ln -s ../museum "$folder/sub/museum"
ln -s "$folder.far/more" "$folder/more"
ln -s "$folder.far/more/four" "$folder/five"
again=$("$workflows/list-tablets" "$folder" 2>/dev/null)
[ "$again" = $'export/one\nfive\nlinked\nmuseum/a b\nmuseum/c\nsession\nsub/mesh/two\nthree' ] || fail "list-tablets, of what comes again: $again"
rm "$folder"/{again,zlinked,sub/museum,more,five}
# One that lost its backup, too, is known by what else a session has.
mkdir -p "$folder"/lost.sums/{grids,mesh} "$folder"/lost.lock "$folder"/lost.link "$folder"/lost.results
touch "$folder"/lost.sums/{session.sums,mesh/model.ply} "$folder"/lost.lock/session.lock
ln -s nowhere "$folder/lost.link/session.sqlite"
[ "$("$workflows/list-tablets" "$folder" 2>"$folder/said")" = "$listed" ] || fail "a session without database and backup is listed"
said=$(LC_ALL=C sort "$folder/said")
without="a session without its session.sqlite, left out; dubsar verify --repair makes it anew"
[ "$said" = "list-tablets: lost.link: $without
list-tablets: lost.lock: $without
list-tablets: lost.sums: $without
list-tablets: lost: $without" ] || fail "list-tablets says: $said"
# Or by its grids alone, as a copy has that broke off; a folder of other grids is none, and one with a name of any bytes is.
odd=$'lost.o\xff'
mkdir -p "$folder"/lost.grids/{grids,mesh} "$folder/$odd/grids" "$folder"/lost.other/{grids,first/grids,grids/012}
touch "$folder"/lost.grids/{grids/000.grid,grids/001.grid,mesh/model.ply} "$folder/$odd/grids/1000.grid" \
  "$folder"/lost.other/{grids/first.grid,grids/000.gridx,grids/012a.grid,first/grids/12.grid,grids/012/345.grid}
[ "$("$workflows/list-tablets" "$folder" 2>"$folder/said")" = "$listed" ] || fail "a session of grids alone is listed"
said=$(LC_ALL=C sort "$folder/said")
[ "$said" = "list-tablets: lost.grids: $without
list-tablets: lost.link: $without
list-tablets: lost.lock: $without
list-tablets: $odd: $without
list-tablets: lost.sums: $without
list-tablets: lost: $without" ] || fail "list-tablets says: $said"
# So it is for every awk: gawk goes by the characters of the locale, mawk by bytes.
whichever_awk() { [ "${LC_ALL-}" = C ] && command "$(type -P gawk awk | head -n 1)" "$@"; }
again=$(awk() { whichever_awk "$@"; } && export -f awk whichever_awk && "$workflows/list-tablets" "$folder" 2>"$folder/said") ||
  fail "list-tablets, with names that are no text, leaves awk to the locale"
[ "$again" = "$listed" ] || fail "list-tablets, by whichever awk: $again"
[ "$(LC_ALL=C sort "$folder/said")" = "$said" ] || fail "list-tablets says, by whichever awk: $(cat "$folder/said")"
rm -r "$folder"/lost.*
listed=$("$workflows/list-tablets" "$folder/session")
[ "$listed" = . ] || fail "list-tablets of a session: $listed"
# What cannot be gone through is told of and keeps nobody from the rest; what lies in sessions or is hidden is not told of.
bound=()  # root reads everything, unless it is bound
[ "$(id -u)" != 0 ] || bound=(setpriv --bounding-set "-dac_override,-dac_read_search")
mkdir -p "$folder"/{closed,äöü,session/closed} "$folder"/$'broken\nname' "$folder"/three/$'broken\nname' "$folder"/session/$'broken\nname'
touch "$folder"/closed/model.ply "$folder"/$'broken\nname'/model.ply
for loop in "museum/a b/latest" äöü/latest museum/.latest session/latest; do ln -s . "$folder/$loop"; done
ln -s itself "$folder/itself"
chmod 0 "$folder"/{closed,session/closed}
status=0
again=$("${bound[@]}" "$workflows/list-tablets" "$folder" 2>"$folder/said") || status=$?
chmod 700 "$folder"/{closed,session/closed}
[ "$status $again" = $'0 export/one\nlinked\nmuseum/a b\nmuseum/c\nsession\nsub/mesh/two\nthree' ] || fail "list-tablets: $status $again"
said=$(LC_ALL=C sort "$folder/said")
[ "$said" = "list-tablets: .: a folder in it has a line break in its name, left out; give it another
list-tablets: closed: Permission denied, left out
list-tablets: itself: Too many levels of symbolic links, left out
list-tablets: lost: a session without its session.sqlite, left out; dubsar verify --repair makes it anew
list-tablets: museum/a b/latest: a link that leads back to where it lies, left out
list-tablets: three: a folder in it has a line break in its name, left out; give it another
list-tablets: äöü/latest: a link that leads back to where it lies, left out" ] || fail "list-tablets says: $said"
# A search that breaks off is no list.
status=0
(find() { command find "$@" >/dev/full; } && export -f find && "$workflows/list-tablets" "$folder" >/dev/null 2>&1) || status=$?
[ $status = 2 ] || fail "list-tablets when its search breaks off: status $status"
rm -r "$folder"/{closed,äöü,itself} "$folder"/$'broken\nname' "$folder/museum/a b/latest" "$folder/museum/.latest"
rm -r "$folder"/{export,sub,three,session,session.results,lost,.hidden,linked,said} "$folder.far"

"$workflows/do-tablet" "$folder" "museum/a b"
[ -f "$folder/museum/a b/wedges.json.done" ] || fail "no stamp"
"$workflows/do-tablet" "$folder" "museum/a b"
"$workflows/do-tablet" "$folder" museum/c &
worker=$!
for _ in $(seq 300); do grep -qs begin "$folder/log/museum/c.log" && break; sleep 0.02; done
# The shell and the program that it waits for.
kill -9 $worker $(cat "/proc/$worker/task/$worker/children" 2>/dev/null) 2>/dev/null || true
wait $worker 2>/dev/null || true
killed=$(grep -c ' analyze end$' "$folder/log/museum/c.log" || true)
"$workflows/do-tablet" "$folder" museum/c
[ "$(grep -c ' analyze end$' "$folder/log/museum/a b.log")" = 1 ] || fail "the first tablet was done twice"
[ "$(grep -c ' found-done$' "$folder/log/museum/a b.log")" = 1 ] || fail "the first tablet was not found done"
# The kill may come too late; then the tablet was done once all the same.
[ "$(grep -c ' analyze end$' "$folder/log/museum/c.log")" = 1 ] || fail "the second tablet: $killed before, then $(cat "$folder/log/museum/c.log")"

status=0
"$workflows/do-tablet" "$folder" nowhere 2>/dev/null || status=$?
[ $status = 2 ] || fail "a tablet that is not there: status $status"
grep -q ' analyze failed status=2 {"error":{.*"there is no folder' "$folder/log/nowhere.log" || fail "no reason: $(cat "$folder/log/nowhere.log")"
mkdir "$folder/museum/bad"
echo 'no mesh' >"$folder/museum/bad/model.ply"
"$workflows/do-tablet" "$folder" museum/bad 2>/dev/null && fail "what is no mesh was done"
said=$("$workflows/check-collection" "$folder" 2>/dev/null) && fail "check-collection overlooks what is not done"
[[ $said == 'museum/bad: is not done: analyze failed status=2 {"error":'*'not a PLY file'* ]] || fail "check-collection: $said"
mkdir "$folder/museum/broken"
echo 'no database' >"$folder/museum/broken/session.sqlite"
status=0
"$workflows/do-tablet" "$folder" museum/broken 2>/dev/null || status=$?
grep -q " failed status=$status {\"error\":{" "$folder/log/museum/broken.log" || fail "no reason: $(cat "$folder/log/museum/broken.log")"
rm -r "$folder/museum/bad" "$folder/museum/broken"*
mkdir "$folder/museum/lost"
echo 'a copy of the tables' >"$folder/museum/lost/session.backup.sqlite"
said=$("$workflows/check-collection" "$folder" 2>/dev/null) && fail "check-collection overlooks a session without its database"
[[ $said == 'museum/lost: a session without its session.sqlite'* ]] || fail "check-collection: $said"
rm -r "$folder/museum/lost"
# A name of any bytes is one name, and does not keep the others from being looked at.
odd=$'museum/o\xff\x0b\r\xe2\x80\xa8d'
mkdir "$folder/$odd"
echo 'no mesh' >"$folder/$odd/model.ply"
said=$("$workflows/check-collection" "$folder" 2>/dev/null) && fail "check-collection overlooks a name that is no text"
[ "$said" = "$odd: is not done" ] || fail "check-collection: $said"
rm -r "$folder/$odd"
cp -r "$folder/museum/a b" "$folder/$odd"
said=$("$workflows/check-collection" "$folder" 2>&1) || fail "check-collection of a whole one with a name that is no text: $said"
# What cannot be read is told of, and keeps nobody from the rest.
rm "$folder/$odd/wedges.json"
mkdir "$folder/$odd/wedges.json"
said=$("$workflows/check-collection" "$folder" 2>/dev/null) && fail "check-collection overlooks what cannot be read"
[ "$said" = "$odd: wedges.json cannot be read: Is a directory" ] || fail "check-collection: $said"
rm -r "$folder/$odd"
"$workflows/check-collection" "$folder" 2>/dev/null || fail "check-collection"
printf 'x' >>"$folder/museum/c/wedges.json"
said=$("$workflows/check-collection" "$folder" 2>/dev/null) && fail "check-collection overlooks damage"
[ "$said" = "museum/c: wedges.json has other bytes than were written" ] || fail "check-collection: $said"
printf 'x' >"$folder/museum/c/wedges.json.done"
said=$("$workflows/check-collection" "$folder" 2>/dev/null) && fail "check-collection overlooks a stamp that is none"
[ "$said" = "museum/c: wedges.json.done cannot be read as a stamp" ] || fail "check-collection: $said"
status=0
said=$("$workflows/check-collection" "$folder/nowhere" 2>&1) || status=$?
[ "$status $said" = "2 usage: check-collection COLLECTION (a folder)" ] || fail "check-collection of nothing: $status $said"
# A session is only read: what comes of it lies beside it, and it verifies as before.
export DUBSAR_EXPORT=yes
rm -r "$folder/museum/c"
"$DUBSAR" -q scan --auto --device 'sim:?seed=1&size=12x10x7&spacing=0.15&noise=0.01' --session "$folder/museum/s" \
  --max-scans 2 >/dev/null 2>&1 || [ $? = 1 ] || fail "no session"
"$DUBSAR" -q verify "$folder/museum/s" >/dev/null 2>&1 || fail "the session before"
log=$folder/log/museum/s.log
"$workflows/do-tablet" "$folder" museum/s 2>/dev/null &
worker=$!
for _ in $(seq 3000); do grep -qs 'export begin' "$log" && break; sleep 0.02; done
kill -9 $worker $(cat "/proc/$worker/task/$worker/children" 2>/dev/null) 2>/dev/null || true
wait $worker 2>/dev/null || true
"$workflows/do-tablet" "$folder" museum/s 2>/dev/null || fail "a session begun anew"
"$workflows/do-tablet" "$folder" museum/s 2>/dev/null || fail "a session that is done"
[ "$(grep -c ' export end$' "$log")" = 1 ] || fail "the package was made twice: $(cat "$log")"
[ "$(tail -n 1 "$log" | grep -c ' export found-done$')" = 1 ] || fail "the package was not found done: $(cat "$log")"
"$DUBSAR" -q verify "$folder/museum/s" >/dev/null 2>&1 || fail "the session was changed"
"$DUBSAR" -q verify "$folder/museum/s.results/package" >/dev/null 2>&1 || fail "the package is not whole"
[ -z "$(find "$folder/museum/s.results" -name '.dubsar-tmp-*')" ] || fail "something was left behind"
# While another program makes the package there is something to be tried again, not something that is wrong.
if command -v flock >/dev/null; then
  cp -r "$folder/museum/s" "$folder/museum/u"
  mkdir -p "$folder/museum/u.results/.dubsar-tmp-package"
  status=0
  flock "$folder/museum/u.results/.dubsar-tmp-package" "$workflows/do-tablet" "$folder" museum/u 2>/dev/null || status=$?
  [ $status = 4 ] || fail "two at once: status $status"
  tail -n 1 "$folder/log/museum/u.log" | grep -q ' export failed status=4 .*another program is writing this folder now' ||
    fail "two at once: $(cat "$folder/log/museum/u.log")"
  "$workflows/do-tablet" "$folder" museum/u 2>/dev/null || fail "after the other of two: $(cat "$folder/log/museum/u.log")"
  rm -r "$folder/museum/u" "$folder/museum/u.results" "$folder/log/museum/u.log"
fi
# So it is where the collection is the session.
"$workflows/do-tablet" "$folder/museum/s" . 2>/dev/null || fail "a collection that is a session"
tail -n 1 "$folder/museum/s.results/log/s.log" | grep -q ' export found-done$' || fail "a collection that is a session was done anew"
"$workflows/check-collection" "$folder/museum/s" 2>/dev/null || fail "check-collection of a session"
"$DUBSAR" -q verify "$folder/museum/s" >/dev/null 2>&1 || fail "the session that is a collection was changed"
# The mesh that a session keeps is used while it is of its scans as they stand; else one is stitched beside it.
packed() { DUBSAR_EXPORT=yes "$workflows/do-tablet" "$folder" museum/t 2>/dev/null; }
wedges_of() { python3 -c 'import json, sys; print(len(json.load(open(sys.argv[1]))["wedges"]))' "$1"; }
cp -r "$folder/museum/s" "$folder/museum/t"
log=$folder/log/museum/t.log
DUBSAR_EXPORT=no "$workflows/do-tablet" "$folder" museum/t 2>/dev/null || fail "a copied session"
[ ! -e "$folder/museum/t.results/mesh.ply" ] || fail "the session's own mesh was stitched again"
cp "$folder/museum/t.results/wedges.json.done" "$folder/before.done"
"$DUBSAR" -q session drop "$folder/museum/t" 1 >/dev/null 2>&1 || fail "drop"
DUBSAR_EXPORT=no "$workflows/do-tablet" "$folder" museum/t 2>/dev/null || fail "a session with a scan less"
! cmp -s "$folder/before.done" "$folder/museum/t.results/wedges.json.done" || fail "the wedges are of a scan that was taken out"
[ "$(tail -n 1 "$log" | grep -c ' analyze end$')" = 1 ] || fail "wedges of a scan that was taken out: $(cat "$log")"
DUBSAR_EXPORT=no "$workflows/do-tablet" "$folder" museum/t 2>/dev/null || fail "a session with a scan less, again"
[ "$(grep -c ' stitch end$' "$log")" = 1 ] || fail "the mesh was stitched again: $(cat "$log")"
[ "$(grep -c ' stitch found-done$' "$log")" = 1 ] || fail "the mesh was not found done: $(cat "$log")"
cp "$folder/museum/t.results/mesh.ply" "$folder/before.ply"
"$DUBSAR" -q export "$folder/museum/t" --to "$folder/fresh" --without renderings,features >/dev/null 2>&1 || fail "export"
if command -v python3 >/dev/null; then
  [ "$(wedges_of "$folder/museum/t.results/wedges.json")" = "$(wedges_of "$folder/fresh/data/wedges/wedges.json")" ] ||
    fail "the workflow and export count other wedges"
fi
cmp -s "$folder/before.ply" "$folder"/fresh/data/model/*.ply || fail "the workflow and export stitch other meshes"
# Its package follows: an earlier one goes when the new one is whole, one that somebody changed stays.
cp -r "$folder/museum/s.results/package" "$folder/museum/s.results/package.done" "$folder/museum/t.results/"
packed || fail "the package of a session that has changed: $(cat "$log")"
[ "$(tail -n 1 "$log" | grep -c ' export end lacking .*the poses do not follow yet what was said: scan 1 has been taken out')" = 1 ] || fail "the package of a session that has changed: $(cat "$log")"
cmp -s "$folder/before.ply" "$folder"/museum/t.results/package/data/model/*.ply || fail "the package has another mesh"
packed || fail "the package of a session that has changed, again"
[ "$(tail -n 1 "$log" | grep -c ' export found-done$')" = 1 ] || fail "the new package was not found done: $(cat "$log")"
"$DUBSAR" -q session restore "$folder/museum/t" 1 >/dev/null 2>&1 || fail "restore"
"$DUBSAR" -q session drop "$folder/museum/t" 0 >/dev/null 2>&1 || fail "drop"
DUBSAR_EXPORT=no "$workflows/do-tablet" "$folder" museum/t 2>/dev/null || fail "a session with another scan less"
! cmp -s "$folder/before.ply" "$folder/museum/t.results/mesh.ply" || fail "the mesh beside is of a scan that was taken out"
printf 'mine' >>"$folder/museum/t.results/package/data/README.txt"
packed && fail "a package that somebody changed was replaced"
grep -q mine "$folder/museum/t.results/package/data/README.txt" || fail "a package that somebody changed is gone"
rm -r "$folder/museum/t" "$folder/museum/t.results" "$folder/before.ply" "$folder/before.done" "$folder/fresh"
listed=$("$workflows/list-tablets" "$folder")
[ "$listed" = $'museum/a b\nmuseum/s' ] || fail "list-tablets: $listed"
"$workflows/check-collection" "$folder" 2>/dev/null || fail "check-collection"
mv "$folder/museum/s.results/package.done" "$folder/aside.done"
DUBSAR_EXPORT=no "$workflows/check-collection" "$folder" 2>/dev/null || fail "check-collection, of wedges alone"
said=$(DUBSAR_EXPORT=yes "$workflows/check-collection" "$folder" 2>/dev/null) && fail "check-collection overlooks a package that is not there"
[ "$said" = "museum/s: has no package" ] || fail "check-collection: $said"
mv "$folder/aside.done" "$folder/museum/s.results/package.done"
printf 'x' >>"$folder/museum/s.results/package/data/README.txt"
said=$("$workflows/check-collection" "$folder" 2>/dev/null) && fail "check-collection overlooks damage to a package"
[ "$said" = "museum/s: package/data/README.txt has other bytes than were written" ] || fail "check-collection: $said"
truncate -s -1 "$folder/museum/s.results/package/data/README.txt"
"$workflows/check-collection" "$folder" 2>/dev/null || fail "check-collection of a package as it was"
mkdir "$folder/museum/s.results/package/data/more"
echo mine >"$folder/museum/s.results/package/data/more/mine.txt"
said=$("$workflows/check-collection" "$folder" 2>/dev/null) && fail "check-collection overlooks a file that no manifest lists"
[ "$said" = "museum/s: package/data/more/mine.txt was not written with the package; the bag is not valid with it" ] ||
  fail "check-collection: $said"
for script in "$workflows"/*; do
  case $(head -1 "$script") in *bash) bash -n "$script" || fail "$script" ;; esac
done
