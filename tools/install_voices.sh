#!/usr/bin/env bash
# install_voices.sh voice...: MBROLA and these voices on a Debian-like system, as root, from the archive that the
# machine already uses.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
chmod 755 "$work"
mkdir -p "$work/parts" "$work/lists/partial"

components="contrib non-free"
if grep -q '^ID=ubuntu' /etc/os-release; then components="universe multiverse"; fi

# deb822 stanzas, then one-line entries, each with its components replaced
for f in /etc/apt/sources.list.d/debian.sources /etc/apt/sources.list.d/ubuntu.sources; do
  [ -r "$f" ] && sed -E "s/^Components:.*/Components: $components/" "$f" >"$work/parts/$(basename "$f")"
done
shopt -s nullglob
cat /dev/null /etc/apt/sources.lis[t] /etc/apt/sources.list.d/*.list |
  sed -nE "s@^(deb (\[[^]]*\] )?[^ ]+/(debian|ubuntu)[^ ]*/? [^ ]+) .*@\1 $components@p" >"$work/parts/lines.list"

options=(-o Dir::Etc::sourcelist=/dev/null -o "Dir::Etc::sourceparts=$work/parts" -o "Dir::State::lists=$work/lists")
apt-get "${options[@]}" -qq update
DEBIAN_FRONTEND=noninteractive apt-get "${options[@]}" -y -qq --no-install-recommends install \
  mbrola "${@/#/mbrola-}" >/dev/null
