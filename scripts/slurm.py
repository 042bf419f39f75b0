"""A Slurm of this machine alone: a controller and two nodes on 127.0.0.1, in a temporary folder.

Needs Debian's slurm-wlm and munge (sh scripts/setup --slurm). Nothing of it touches a Slurm that is installed
for good: keys, sockets, ports and state are its own.
"""

import os
import pwd
import signal
import socket
import subprocess
import tempfile
import time
from pathlib import Path

CONFIGURATION = """\
ClusterName=single
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort={controller_port}
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool/%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
SlurmctldLogFile={folder}/log/slurmctld.log
SlurmdLogFile={folder}/log/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=2,batch_sched_delay=0,sched_min_interval=200000
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmctldTimeout=30
SlurmdTimeout=10
InactiveLimit=0
KillWait=2
MinJobAge=3600
JobRequeue=1
MaxArraySize=1001
JobCompType=jobcomp/none
AccountingStorageType=accounting_storage/none
{nodes}
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Slurm:
    """Started by `with`, stopped at its end with every process of its jobs."""

    def __init__(self, nodes=("n1", "n2"), cpus=2):
        self.nodes = nodes
        self.cpus = cpus
        self.processes = {}

    def __enter__(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="asperity-slurm-")
        folder = self.folder = Path(self.temporary.name)
        # munged asks for folders that others cannot write to.
        folder.chmod(0o755)
        for name in ["state", "spool", "log"]:
            (folder / name).mkdir()
        host = socket.gethostname().split(".")[0]
        nodes = "\n".join(
            f"NodeName={node} NodeAddr=127.0.0.1 NodeHostname={host} Port={free_port()} "
            f"CPUs={self.cpus} RealMemory=1000 State=UNKNOWN"
            for node in self.nodes
        )
        user = pwd.getpwuid(os.getuid()).pw_name
        text = CONFIGURATION.format(
            folder=folder, user=user, nodes=nodes, controller_port=free_port()
        )
        (folder / "slurm.conf").write_text(text)
        # Jobs that are submitted from here look for the same configuration.
        self.environment = {**os.environ, "SLURM_CONF": str(folder / "slurm.conf")}
        try:
            self.start_munge()
            self.start("slurmctld", ["slurmctld", "-D"])
            for node in self.nodes:
                self.start_node(node)
            self.wait_for("the nodes", lambda: self.idle() == set(self.nodes), 60)
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for name in list(self.processes):
            self.kill(name)
        for process in self.of_jobs():
            kill(process)
        self.temporary.cleanup()

    def start_munge(self):
        folder = self.folder
        key = folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        options = {
            "key-file": key,
            "socket": folder / "munge.socket",
            "pid-file": folder / "munged.pid",
            "log-file": folder / "munged.log",
            "seed-file": folder / "munged.seed",
        }
        arguments = [f"--{name}={path}" for name, path in options.items()]
        self.start("munged", ["munged", "--foreground", "--force", "--num-threads=2", *arguments])
        self.wait_for("munged", (folder / "munge.socket").exists, 20)

    def start(self, name, command):
        path = f"{os.environ.get('PATH', '')}:/usr/sbin:/sbin"
        log = open(self.folder / "log" / f"{name}.out", "ab")
        self.processes[name] = subprocess.Popen(
            command,
            env={**self.environment, "PATH": path},
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=log,
        )

    def start_node(self, node):
        self.start(node, ["slurmd", "-D", "-N", node])

    def kill(self, name):
        """SIGKILL, as when the power goes."""
        process = self.processes.pop(name)
        process.kill()
        process.wait()

    def run(self, *command):
        """The standard output of a command."""
        done = subprocess.run(
            command, env=self.environment, capture_output=True, text=True, check=False
        )
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(map(str, command))}: {done.stderr.strip()}")
        return done.stdout

    def idle(self):
        """Nodes that take jobs; none while the controller starts."""
        try:
            lines = self.run("sinfo", "-h", "-N", "-o", "%N %t").split("\n")
        except RuntimeError:
            return set()
        return {line.split()[0] for line in lines if line.endswith((" idle", " mix", " alloc"))}

    def states(self, job):
        """State and node of every element of a job, as far as it was looked at."""
        lines = self.run("squeue", "-h", "-r", "-t", "all", "-j", job, "-o", "%i %T %N").split("\n")
        rows = [line.split() for line in lines if line]
        return {row[0]: (row[1], row[2] if len(row) > 2 else "") for row in rows}

    def wait_for(self, what, ready, seconds):
        end = time.monotonic() + seconds
        while not ready():
            for name, process in self.processes.items():
                if process.poll() is not None:
                    raise RuntimeError(f"{name} ended: {self.log(name)}")
            if time.monotonic() > end:
                logs = "\n".join(f"{name}: {self.log(name)}" for name in self.processes)
                raise RuntimeError(f"no {what} after {seconds} s\n{logs}")
            time.sleep(0.2)

    def log(self, name):
        """The last lines that a process wrote."""
        paths = sorted((self.folder / "log").glob(f"*{name}*"))
        return "\n".join(path.read_text(errors="replace")[-2000:] for path in paths)

    def of_jobs(self, node=None):
        """Processes of jobs of this Slurm, of one node or of all."""
        found = []
        for path in Path("/proc").glob("[0-9]*/environ"):
            try:
                words = path.read_bytes().split(b"\0")
            except OSError:
                continue
            ours = f"SLURM_CONF={self.folder}/slurm.conf".encode()
            named = b"SLURMD_NODENAME=" + (node.encode() if node else b"")
            if ours in words and any(word.startswith(named) for word in words):
                found.append(int(path.parent.name))
        return found


def kill(process):
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        pass
