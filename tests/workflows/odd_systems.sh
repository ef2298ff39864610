#!/usr/bin/env bash
# odd_systems.sh SOURCE FOLDER: ./run and tools/build where Debian, its packages, the network or Slurm are not there, and in a
# clone that was moved: one line says what, with a status of the README. Nothing is installed: apt-get is a stub.
set -euo pipefail
source=$1
folder=$2
fail() { echo "FAILED: $*" >&2; exit 1; }
rm -rf "$folder"
clone="$folder/Klön für Tafeln"
mkdir -p "$clone/build" "$folder/bin" "$folder/stubs"
cp -r "$source/tools" "$source/workflows" "$source/run" "$source/packages.txt" "$clone"
for name in bash env sed grep cat mkdir rm tail sha256sum dirname mktemp touch wc; do
  ln -s "$(command -v "$name")" "$folder/bin/$name"
done
# stub NAME LINE ...: a file of its own, never through a link.
stub() {
  rm -f "$folder/stubs/$1"
  printf '%s\n' '#!/usr/bin/env bash' "${@:2}" >"$folder/stubs/$1"
  chmod +x "$folder/stubs/$1"
}
# expect STATUS WORDS COMMAND ...
expect() {
  local status=0 said
  said=$(PATH="$folder/stubs:$folder/bin" "${@:3}" 2>&1 >/dev/null) || status=$?
  [ "$status" = "$1" ] || fail "${*:3}: status $status, not $1: $said"
  [[ "$said" == *"$2"* ]] || fail "${*:3}: not said: $2: $said"
}

expect 2 'this is no Debian: install what packages.txt names' "$clone/run"

stub dpkg-query 'exit 1'
stub sudo '"$@"'
stub apt-get 'echo "E: Unable to fetch some archives" >&2; exit 100'
expect 4 'the packages could not be installed; is there a network' "$clone/run"
[ ! -e "$clone/build/.packages" ] || fail "a stamp of what is not there"

# The stamp says that all is there; cmake was taken away since.
sha256sum <"$clone/packages.txt" >"$clone/build/.packages"
expect 4 'apt-get install' "$clone/run"

stub dpkg-query 'echo installed'
for tool in ninja g++; do stub "$tool" 'exit 0'; done
# What cmake was asked for is in the file asked; it configures, and builds where $built says so.
stub cmake 'echo "$*" >>asked
case $1 in
  --preset) mkdir -p "build/$2"; echo "CMAKE_HOME_DIRECTORY:INTERNAL=$PWD" >"build/$2/CMakeCache.txt"; touch "build/$2/build.ninja" ;;
  --build) [ -e built ] || { echo "FAILED: a.cpp" >&2; exit 1; } ;;
esac'
expect 4 'tools/build: the build failed, see above' "$clone/tools/build"
touch "$clone/built"
expect 0 '' "$clone/tools/build"
[ "$(grep -c preset "$clone/asked")" = 1 ] || fail "configured more than once: $(cat "$clone/asked")"
mv "$clone" "$folder/moved"
expect 0 'was moved or copied from' "$folder/moved/tools/build"
[ "$(grep -c preset "$folder/moved/asked")" = 2 ] || fail "a moved clone was not configured anew"
expect 0 '' "$folder/moved/tools/build"
[ "$(grep -c preset "$folder/moved/asked")" = 2 ] || fail "a clone that stays was configured again"

# A disk that takes no folder for the session.
stub mkdir "case \$* in *runs/[0-9]*) echo 'mkdir: No space left on device' >&2; exit 1 ;; esac; exec $(command -v mkdir) \"\$@\""
expect 4 'run: mkdir: No space left on device' "$(command -v timeout)" 20 "$folder/moved/run"
rm "$folder/stubs/mkdir"
mkdir "$folder/collection"
expect 2 'submit-slurm: sbatch is missing' "$folder/moved/workflows/submit-slurm" "$folder/collection"
[ ! -e "$folder/collection/log" ] || fail "submit-slurm leaves a list where there is no Slurm"

# A CDPATH of the caller, in which another clone lies.
mkdir -p "$folder/moved/docs" "$folder/other/fuzz"
cp -r "$source/fuzz" "$folder/moved"
cp "$source/docs/reliability.md" "$folder/moved/docs"
(cd "$folder/moved" && CDPATH=$folder/other fuzz/campaign --table) || fail "fuzz/campaign --table with a CDPATH"
cmp "$source/docs/reliability.md" "$folder/moved/docs/reliability.md" || fail "docs/reliability.md has another table than fuzz/executions.tsv"
echo "all well"
