# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""A virtual X display of its own for each test, whatever else runs beside it."""

import os
import shutil
import subprocess

SERVER = shutil.which("Xvfb")


class VirtualDisplay:
    """Xvfb on a number that the server itself finds free: nothing is guessed, so nothing races."""

    def __enter__(self):
        reader, writer = os.pipe()
        self.server = subprocess.Popen(
            [SERVER, "-displayfd", str(writer), "-screen", "0", "1600x1000x24"]
            + ["-nolisten", "tcp", "-noreset"],
            pass_fds=[writer],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(writer)
        with os.fdopen(reader) as announced:
            number = announced.readline().strip()
        if not number:
            self.server.wait()
            raise RuntimeError(f"Xvfb did not start: exit {self.server.returncode}")
        return {**os.environ, "DISPLAY": f":{number}"}

    def __exit__(self, *_):
        self.server.terminate()
        self.server.wait()
