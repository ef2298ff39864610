#!/usr/bin/env bash
# consumer.sh SOURCE PREFIX CXX: a project of somebody else is configured, built and run on the installed libraries.
set -euo pipefail
build=$2/consumer
cmake -S "$1/tests/install/consumer" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_COMPILER="$3" \
  -DCMAKE_PREFIX_PATH="$2" >"$2/consumer.log" || { cat "$2/consumer.log" >&2; exit 1; }
# Nothing of the sources may be on its command lines.
if cmake --build "$build" -- -t commands consumer | grep -F -e "-I$1" -e "-I $1"; then
  echo "FAILED: the consumer sees the sources" >&2
  exit 1
fi
# The first library that is not there is told, and not the last of those that stand on it.
if said=$(PKG_CONFIG_PATH='' PKG_CONFIG_LIBDIR=$2/none cmake -S "$1/tests/install/lacking" -B "$2/lacking" -G Ninja \
  -DCMAKE_CXX_COMPILER="$3" -DCMAKE_PREFIX_PATH="$2" 2>&1) || ! [[ $said == *"dubsar needs libzstd"* ]]; then
  echo "FAILED: a library is missing, and what is said of it is: $said" >&2
  exit 1
fi
cmake --build "$build" >"$2/consumer.log" || { cat "$2/consumer.log" >&2; exit 1; }
said=$("$build/consumer" "$2/scans" "$2/model.ply")
echo "$said"
[[ $said =~ ^[6-8]\ of\ 8\ scans ]] || { echo "FAILED: too few scans fit" >&2; exit 1; }
"$2/bin/dubsar" mesh check "$2/model.ply" >/dev/null
