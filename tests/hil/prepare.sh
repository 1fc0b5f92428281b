#!/usr/bin/env bash
# Sourced by script/hil and script/try-image: what the lab needs on the host.
cache=${XDG_CACHE_HOME:-$HOME/.cache}/bevloc/hil
build=build/hil
umask 022  # users of the guest read what is copied there, whatever umask this user has

skip() {
  echo "$(basename "$0"): skipped: $1" >&2
  exit 77
}

# require_host: skips where the lab cannot run.
require_host() {
  local codename
  # shellcheck source=/dev/null
  codename=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
  [[ $(uname -m) == x86_64 ]] || skip "the lab needs an x86-64 machine"
  ((EUID == 0)) || skip "the lab needs root, for the guest's file system"
  [[ $codename == bookworm ]] || skip "the lab needs Debian 12, whose packages it uses"
}

# need_yaml: what --help and --list need. It needs no root where Python can read YAML files already.
need_yaml() {
  /usr/bin/python3 -c 'import yaml' 2>/dev/null || script/bootstrap hil
}

# build_programs TARGET...: builds these programs of the lab.
build_programs() {
  # The owner of the tree builds and drives in these folders, too.
  mkdir -p build out
  chown --reference=. build out
  export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1
  cmake -S . -B $build -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER_LAUNCHER=ccache \
    -DBEVLOC_HIL=ON >/dev/null
  cmake --build $build --target "$@" drive_pictures
}

# render_pictures: renders the images of the drive, once for each drive and each version of the
# renderer, and sets `pictures` to their folder.
render_pictures() {
  local key
  key=$(cat tests/hil/config/drive.yaml config/rig_demo.yaml $build/bin/drive_pictures |
    sha256sum | cut -c1-16)
  pictures=$cache/pictures/$key
  [[ ! -f $pictures/truth.csv ]] || return 0
  # Another run may still use the images of the version before: only old ones are removed.
  mkdir -p "$cache/pictures"
  find "$cache/pictures" -mindepth 1 -maxdepth 1 -mtime +7 -exec rm -rf {} +
  echo "$(basename "$0"): rendering the images of the drive"
  $build/bin/drive_pictures tests/hil/config/drive.yaml "$pictures"
}
