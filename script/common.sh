# Sourced by the other scripts: the repository's root, and how a preset is configured and built.
# shellcheck shell=bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# configure PRESET [cmake options...]: says something only when it goes wrong.
configure() {
  local preset=$1 cache=build/$1/CMakeCache.txt log=build/$1/configure.log
  # A checkout that was moved or copied with its build directory starts that directory again.
  if [ -f "$cache" ] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$PWD" "$cache"; then
    rm -rf "build/$preset"
  fi
  mkdir -p "build/$preset"
  if ! cmake --preset "$@" >"$log" 2>&1; then
    cat "$log" >&2
    return 1
  fi
}

# build PRESET
build() {
  # What is left is warnings and errors.
  cmake --build --preset "$1" -- --quiet 2>&1 | sed '/^ninja: no work to do.$/d'
}
