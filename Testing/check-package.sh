#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Makes the Debian packages and the wheel of build/ and tries them: the packages unpacked into a folder and the wheel
# installed by pip into a virtual environment, without network; or, as root with debootstrap, the packages installed by
# apt into a clean Debian, where bash, zsh and man must find what they look for and a project of its own (consumer/) is
# built with what the packages depend on:
#   Testing/check-package.sh            here
#   Testing/check-package.sh SYSTEM     in a clean Debian made in the folder SYSTEM, which stays
set -eu
cd "$(dirname "$0")/.."
rm -rf build/packages
cpack --config build/CPackConfig.cmake >build/cpack.log || { cat build/cpack.log; exit 1; }
packages=$(ls build/packages/*.deb)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for package in $packages; do
  echo "$(basename "$package"): $(dpkg-deb --field "$package" Installed-Size) kB, depends on $(dpkg-deb --field "$package" Depends)"
  dpkg-deb --extract "$package" "$work/tree"
done
for file in bin/explica lib/explica/explica-window share/man/man1/explica.1 share/man/man1/explica-unfold.1 \
  share/bash-completion/completions/explica share/zsh/vendor-completions/_explica \
  share/explica/study.schema.json share/explica/slurm/explica-study-slurm; do
  [ -e "$work/tree/usr/$file" ] || { echo "missing: /usr/$file"; exit 1; }
done
# What each way of installing must do in the end.
from_python='import explica
assert round(explica.enclosed_volume(explica.icosphere(5)), 1) == 4.2
print(explica.__version__, explica.__file__)'
if [ $# -eq 0 ]; then
  wheel=$(/usr/bin/python3 Wrapping/Python/tools/make_wheel.py build "$work")
  /usr/bin/python3 -m venv --without-pip --system-site-packages "$work/venv"  # which has numpy
  /usr/bin/python3 -m pip --python "$work/venv/bin/python" install --quiet --no-index --no-deps \
    --disable-pip-version-check "$wheel"
  cd "$work"
  tree/usr/bin/explica --version
  tree/usr/bin/explica phantom shell --size 16 --quiet --out shell
  tree/usr/bin/explica verify shell --quiet >/dev/null
  PYTHONPATH=tree/usr/lib/python3/dist-packages /usr/bin/python3 -c "$from_python"
  venv/bin/python -c "$from_python"
  echo "packages: unpacked and run; $(basename "$wheel"): installed and run"
  exit
fi
debootstrap --variant=minbase bookworm "$1" http://deb.debian.org/debian >"$work/debootstrap.log"
cp -r $packages Testing/consumer "$1/root/"
chroot "$1" sh -ec 'export DEBIAN_FRONTEND=noninteractive
  apt-get update -q; apt-get install -qy --no-install-recommends /root/*.deb man-db bash-completion zsh cmake g++ make
  explica --version; explica phantom shell --size 16 --quiet --out /tmp/shell; explica verify /tmp/shell
  python3 -c "$1"
  man -w explica explica-unfold
  bash -c ". /usr/share/bash-completion/bash_completion; _completion_loader explica; complete -p explica"
  zsh -f -c "autoload -U compinit; compinit -u -D; [ \"\$_comps[explica]\" = _explica ] && echo zsh: _explica"
  cmake -S /root/consumer -B /tmp/consumer; cmake --build /tmp/consumer; cd /tmp; consumer/consumer' sh "$from_python"
echo "packages: installed and run in $1"
