#!/usr/bin/env bash
# install_prefix.sh BUILD PREFIX: installs the build into an empty prefix.
set -euo pipefail
rm -rf "$2"
cmake --install "$1" --prefix "$2" >/dev/null
