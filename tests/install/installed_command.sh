#!/usr/bin/env bash
# installed_command.sh BUILD PREFIX: the installed program finds its own plugins, and what the desktop and the shells are
# told is in its place and well formed.
set -euo pipefail
prefix=$(realpath "$2")
fail() { echo "FAILED: $*" >&2; exit 1; }
# Nothing of the caller's that could lead the program to the build.
run() { env -i HOME=/nonexistent PATH=/usr/bin:/bin "$@"; }
dubsar=$prefix/bin/dubsar

[[ $(run "$dubsar" --version) =~ ^[0-9]+\.[0-9]+\.[0-9]+$ ]] || fail "dubsar --version"
listed=$(run "$dubsar" drivers --json)
for plugin in "$1"/lib/dubsar/drivers/*.so; do
  name=$(basename "$plugin")
  [[ $listed == *"\"path\":\"$prefix/lib/dubsar/drivers/$name\""* ]] || fail "drivers does not list $name of the prefix: $listed"
done
[[ $listed == *'"rejected":[]'* ]] || fail "a plugin was left out: $listed"
[ ! -e "$1/lib/dubsar/drivers/usb_stage_guard" ] || [ -x "$prefix/lib/dubsar/drivers/usb_stage_guard" ] ||
  fail "the laser's guard is not beside its plugin"
run "$dubsar" simulate tablet --size 16x14x9 --spacing 0.2 -o "$2/tablet" >/dev/null 2>&1 || fail "simulate tablet"
run "$dubsar" simulate scans --tablet "$2/tablet/tablet.ply" --views 8 --spacing 0.15 --noise 0.01 -o "$2/scans" \
  >/dev/null 2>&1 || fail "simulate scans"

[[ $(run "$prefix/bin/dubsar-station" --help) == usage:* ]] || fail "dubsar-station --help"
status=0
run "$prefix/bin/dubsar-station" --sesion x 2>/dev/null || status=$?
[ $status = 2 ] || fail "dubsar-station takes an option for a session: status $status"
# A name that is mistyped does not go on with the session that it is typed in. The window that opens is a stub.
rm -rf "$2/opened" && mkdir -p "$2/opened/bin" "$2/opened/S"
printf '#!/bin/sh\necho "$@"\n' >"$2/opened/bin/dubsar"
chmod +x "$2/opened/bin/dubsar"
touch "$2/opened/S/session.sqlite"
opened() {
  (cd "$prefix/opened/S" && run env PATH="$prefix/opened/bin:/usr/bin:/bin" "$prefix/bin/dubsar-station" "$@" 2>&1)
}
status=0
said=$(opened BM_1) || status=$?
[ $status = 2 ] || fail "dubsar-station opens what is not there: status $status, $said"
for name in ../S session.sqlite "$prefix/opened/S/session.sqlite"; do
  said=$(opened "$name") || fail "dubsar-station $name: $said"
  [[ $said == "station --session "* ]] || fail "dubsar-station $name: $said"
done

share=$prefix/share
for file in applications/dubsar.desktop applications/dubsar-mesh.desktop icons/hicolor/scalable/apps/dubsar.svg \
  mime/packages/dubsar.xml bash-completion/completions/dubsar zsh/vendor-completions/_dubsar \
  doc/dubsar/copyright doc/dubsar/operators/storeroom-guide.md; do
  [ -s "$share/$file" ] || fail "no $file"
done
# A link of a page that is not installed leads nowhere.
dead=$(find "$share/doc/dubsar" -name '*.md' -print | while IFS= read -r page; do
  { grep -oE '\]\([^)#]+' "$page" || true; } | sed 's/^](//' | while IFS= read -r target; do
    [[ $target == http* ]] || [ -e "$(dirname "$page")/$target" ] || echo "$page: $target"
  done
done)
[ -z "$dead" ] || fail "dead links: $dead"
[ -s "$prefix/lib/udev/rules.d/60-dubsar.rules" ] || fail "no udev rules"
for packed in man/man1/dubsar.1 man/man1/dubsar-station.1 doc/dubsar/third-party-notices doc/dubsar/changelog; do
  gzip -t "$share/$packed.gz" || fail "$packed.gz"
done
gzip -dc "$share/man/man1/dubsar.1.gz" | cmp -s - <(run "$dubsar" reference man) || fail "the manual page is an old one"
cmp -s "$share/bash-completion/completions/dubsar" <(run "$dubsar" reference bash) || fail "the completion is an old one"
notices=$(gzip -dc "$share/doc/dubsar/third-party-notices.gz")
for package in libeigen3 libimgui nlohmann-json3 libceres libflann; do
  [[ $notices == *$'\n'$package-dev$'\n==='* ]] || fail "no notice of $package"
done

# The Python module, where there is one, from the prefix alone.
if [ -d "$1/lib/python/dubsar" ]; then
  run env PYTHONPATH="$prefix/lib/python3/dist-packages" PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 -c \
    "import dubsar; assert len(dubsar.read_grids('$2/scans')) == 8; assert '$prefix' in dubsar.__file__" ||
    fail "the Python module of the prefix"
fi

# Every program that a desktop entry starts, and every type that it opens and that is ours, is there.
for entry in "$share"/applications/*.desktop; do
  program=$(sed -n 's/^Exec=\([^ ]*\).*/\1/p' "$entry")
  [ -x "$prefix/bin/$program" ] || fail "$entry starts $program, which is not installed"
  for type in $(sed -n 's/^MimeType=//p' "$entry" | tr ';' ' '); do
    case $type in application/x-dubsar* | model/x-ply)
      grep -q "type=\"$type\"" "$share/mime/packages/dubsar.xml" || fail "$entry opens $type, which nobody defines" ;;
    esac
  done
done
# The checkers of these formats.
for checker in desktop-file-validate:desktop-file-utils update-mime-database:shared-mime-info mandoc:mandoc zsh:zsh; do
  command -v "${checker%:*}" >/dev/null || fail "there is no ${checker%:*} here: install ${checker#*:} (packages.txt)"
done
remarks=$(desktop-file-validate "$share"/applications/*.desktop) || fail "desktop-file-validate: $remarks"
[ -z "$remarks" ] || fail "$remarks"
rm -rf "$2/mime" && cp -r "$share/mime" "$2/mime"
remarks=$(XDG_DATA_DIRS=$prefix update-mime-database "$2/mime" 2>&1) || fail "update-mime-database: $remarks"
[ -z "$remarks" ] || fail "$remarks"
grep -q '^80:application/x-dubsar-session:session.sqlite$' "$2/mime/globs2" || fail "no glob for a session"
for page in dubsar dubsar-station; do
  remarks=$(gzip -dc "$share/man/man1/$page.1.gz" | mandoc -T lint -W error) || fail "mandoc: $page.1: $remarks"
  [ -z "$remarks" ] || fail "$page.1: $remarks"
done
zsh -n "$share/zsh/vendor-completions/_dubsar" || fail "zsh does not read its completion"
