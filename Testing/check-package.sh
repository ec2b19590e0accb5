#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Makes the Debian packages of build/ and tries them: unpacked into a folder, or, as root with
# debootstrap, installed by apt into a clean Debian:
#   Testing/check-package.sh            unpacked
#   Testing/check-package.sh SYSTEM     in a clean Debian made in the folder SYSTEM, which stays
set -eu
cd "$(dirname "$0")/.."
root=$PWD
rm -rf build/packages
cpack --config build/CPackConfig.cmake >build/cpack.log || { cat build/cpack.log; exit 1; }
packages=$(ls build/packages/*.deb)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for package in $packages; do
  echo "$(basename "$package"): $(dpkg-deb --field "$package" Installed-Size) kB, depends on $(dpkg-deb --field "$package" Depends)"
  dpkg-deb --extract "$package" "$work/tree"
done
for file in bin/explica share/man/man1/explica.1 share/man/man1/explica-unfold.1 \
  share/bash-completion/completions/explica share/zsh/vendor-completions/_explica \
  share/explica/study.schema.json share/explica/slurm/explica-study-slurm; do
  [ -e "$work/tree/usr/$file" ] || { echo "missing: /usr/$file"; exit 1; }
done
if [ $# -eq 0 ]; then
  cd "$work"
  tree/usr/bin/explica --version
  tree/usr/bin/explica phantom shell --size 16 --quiet --out shell
  tree/usr/bin/explica verify shell --quiet >/dev/null
  PYTHONPATH=tree/usr/lib/python3/dist-packages /usr/bin/python3 -c 'import explica; print(explica.__version__)'
  echo "packages: unpacked and run"
  exit
fi
debootstrap --variant=minbase bookworm "$1" http://deb.debian.org/debian >"$work/debootstrap.log"
cp $packages "$1/root/"
chroot "$1" sh -ec 'apt-get update -q; apt-get install -qy --no-install-recommends /root/*.deb
  explica --version; explica phantom shell --size 16 --quiet --out /tmp/shell; explica verify /tmp/shell
  python3 -c "import explica; print(explica.__version__)"'
cd "$root"
echo "packages: installed and run in $1"
