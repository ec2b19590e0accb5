# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""A Slurm of one node in a temporary folder, from Debian's packages, as root and without systemd.

Nothing outside the folder is touched.  Everything that was started ends with stop(), which kills what
does not end by itself; `with SlurmNode() as node:` makes sure of it.
"""

import os
import pathlib
import shutil
import signal
import socket
import subprocess
import tempfile
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "scontrol", "scancel", "sinfo")
START_SECONDS = 90  # more than any machine needs; a limit against hanging only


def search_path():
    """PATH with the folders of system programs."""
    return os.environ.get("PATH", "") + ":/usr/sbin:/sbin"


def missing():
    """Why there can be no node here; empty if there can."""
    absent = [name for name in PROGRAMS if not shutil.which(name, path=search_path())]
    if absent:
        return "not installed: " + ", ".join(absent) + " (apt-get install slurm-wlm munge)"
    return "" if os.geteuid() == 0 else "the daemons must be started as root"


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class SlurmNode:
    def __init__(self, cpus=2, megabytes=4000):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="explica-slurm-"))
        self.daemons = []
        self.environment = dict(os.environ, PATH=search_path(), SLURM_CONF=str(self.folder / "slurm.conf"))
        for name in list(self.environment):
            if name.startswith("SLURM_") and name != "SLURM_CONF":
                del self.environment[name]
        self._write_configuration(cpus, megabytes)

    def __enter__(self):
        try:
            self.start()
        except BaseException:
            self.stop()
            raise
        return self

    def __exit__(self, *_):
        self.stop()

    def _write_configuration(self, cpus, megabytes):
        d = self.folder
        for name in ("log", "state", "spool"):
            (d / name).mkdir()
        key = d / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        # The node's name need not be known to any resolver: all addresses are given.
        (d / "slurm.conf").write_text(f"""\
ClusterName=explica
SlurmctldHost={socket.gethostname().split('.')[0]}(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket={d}/munge.sock
CryptoType=crypto/munge
SlurmUser=root
SlurmdUser=root
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
StateSaveLocation={d}/state
SlurmdSpoolDir={d}/spool
SlurmctldPidFile={d}/slurmctld.pid
SlurmdPidFile={d}/slurmd.pid
SlurmctldLogFile={d}/log/slurmctld.log
SlurmdLogFile={d}/log/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=5,batch_sched_delay=0
SlurmdParameters=config_overrides
ReturnToService=2
MpiDefault=none
SwitchType=switch/none
PluginDir=/usr/lib/x86_64-linux-gnu/slurm-wlm
KillWait=5
MinJobAge=3600
NodeName=node NodeHostname={socket.gethostname().split('.')[0]} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory={megabytes} State=UNKNOWN
PartitionName=main Nodes=node Default=YES MaxTime=INFINITE State=UP
""")

    def _daemon(self, *words):
        log = open(self.folder / "log" / (words[0] + ".out"), "wb")
        process = subprocess.Popen(words, env=self.environment, stdin=subprocess.DEVNULL, stdout=log,
                                   stderr=subprocess.STDOUT, start_new_session=True)
        log.close()
        self.daemons.append(process)

    def logs(self):
        return "\n".join(f"== {log.name}\n{log.read_text(errors='replace')[-2000:]}"
                         for log in sorted((self.folder / "log").iterdir()))

    def _wait(self, what, holds):
        end = time.monotonic() + START_SECONDS
        while not holds():
            dead = [d.args[0] for d in self.daemons if d.poll() is not None]
            if dead or time.monotonic() > end:
                raise RuntimeError(f"Slurm: {what}: {dead or 'no answer'}\n{self.logs()}")
            time.sleep(0.1)

    def start(self):
        d = self.folder
        self._daemon("munged", "--foreground", "--force", f"--socket={d}/munge.sock",
                     f"--key-file={d}/munge.key", f"--log-file={d}/log/munged.log",
                     f"--pid-file={d}/munged.pid", f"--seed-file={d}/munge.seed", "--num-threads=2")
        self._wait("munge", (d / "munge.sock").exists)
        self._daemon("slurmctld", "-D", "-i")
        self._wait("controller", lambda: "is UP" in self.run("scontrol", "ping", check=False))
        self._daemon("slurmd", "-D", "-N", "node")
        self._wait("node", lambda: "idle" in self.run("sinfo", "-h", "-o", "%T", check=False))

    def run(self, *words, check=True, **more):
        """A Slurm command's standard output."""
        done = subprocess.run(words, env=self.environment, stdout=subprocess.PIPE,
                              stderr=None if check else subprocess.DEVNULL, text=True, timeout=60,
                              check=check, **more)
        return done.stdout

    def job_states(self, job):
        """States of a job's tasks by array index (-1 for a job that is no array)."""
        states = {}
        for line in self.run("scontrol", "--oneliner", "show", "job", str(job), check=False).splitlines():
            fields = dict(word.split("=", 1) for word in line.split() if "=" in word)
            index = fields.get("ArrayTaskId", "-1")
            if index.isdigit() or index == "-1":
                states[int(index)] = fields.get("JobState", "")
            else:
                states[index] = fields.get("JobState", "")  # tasks that wait together: "2-3"
        return states

    def stop(self):
        if self.daemons:
            self.run("scancel", "--user=root", "--signal=KILL", "--full", check=False)
        for daemon in reversed(self.daemons):
            if daemon.poll() is None:
                daemon.send_signal(signal.SIGTERM)
                try:
                    daemon.wait(timeout=15)
                except subprocess.TimeoutExpired:
                    daemon.kill()
                    daemon.wait()
        self.daemons = []
        self._end_steps()
        shutil.rmtree(self.folder, ignore_errors=True)

    def _processes(self):
        """Processes that run under this node, with their environment: (pid, command line, variables)."""
        ours = f"SLURM_CONF={self.folder}/slurm.conf".encode()
        for entry in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                environment = (entry / "environ").read_bytes().split(b"\0")
                words = (entry / "cmdline").read_bytes().split(b"\0")
            except OSError:
                continue
            if ours in environment and int(entry.name) != os.getpid():
                yield int(entry.name), words, dict(x.split(b"=", 1) for x in environment if b"=" in x)

    def kill_job_with(self, word):
        """SIGKILL, as when memory has run out, to every process of the job in which `word` stands on
        a command line.  (scancel --signal=KILL would first ask politely.)"""
        for _, words, variables in self._processes():
            job = variables.get(b"SLURM_JOB_ID")
            if job and word.encode() in words:
                for pid, _, others in list(self._processes()):
                    if others.get(b"SLURM_JOB_ID") == job:
                        _kill(pid)
                return
        raise AssertionError(f"no job does {word}")

    def _end_steps(self):
        """Kills the node's remaining step daemons and what they run."""
        for pid, _, variables in list(self._processes()):
            if b"SLURM_JOB_ID" in variables or b"SLURMSTEPD" in variables:
                _kill(pid)


def _kill(pid):
    try:
        os.kill(pid, signal.SIGKILL)
    except ProcessLookupError:
        pass
