"""A Slurm of several nodes on this one machine, for tests: no systemd, no cgroups, no database, no
folder outside its own. Debian's slurmd is built for several on a host (-N)."""

import getpass
import os
import re
import shutil
import signal
import socket
import subprocess
import time
from pathlib import Path

PATH = f"{os.environ['PATH']}:/usr/sbin:/sbin"
NEEDED = ("slurmctld", "slurmd", "sbatch", "scontrol", "munged")


def missing():
    """What Slurm needs and this machine has not."""
    return [name for name in NEEDED if shutil.which(name, path=PATH) is None]


def free_ports(count):
    """`count` free ports in a row."""
    first = 26817
    while True:
        try:
            for port in range(first, first + count):
                with socket.socket() as probe:
                    probe.bind(("127.0.0.1", port))
            return first
        except OSError:
            first += 50


def children_of(pid):
    found = []
    for path in Path(f"/proc/{pid}/task").glob("*/children"):
        try:
            found += [int(word) for word in path.read_text().split()]
        except (FileNotFoundError, ProcessLookupError):
            pass
    return found


def tree(pid):
    """A process and all below it, the lowest first."""
    return [below for child in children_of(pid) for below in tree(child)] + [pid]


def command_of(pid):
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
    except (FileNotFoundError, ProcessLookupError):
        return ""


def kill(pid):
    try:
        os.kill(pid, signal.SIGKILL)
    except ProcessLookupError:
        pass


class Slurm:
    """Started by start(), ended by stop() by the processes that it has started itself."""

    def __init__(self, folder, nodes=3, cpus=2):
        self.folder, self.nodes, self.cpus = Path(folder), nodes, cpus
        self.daemons = {}  # name -> Popen
        self.environment = {**os.environ, "PATH": PATH, "SLURM_CONF": str(self.folder / "slurm.conf")}

    def start(self):
        for name in ("state", "log", "run", *(f"spool/n{n}" for n in self.numbers())):
            (self.folder / name).mkdir(parents=True, exist_ok=True)
        for folder in (self.folder, self.folder / "state", self.folder / "log"):
            folder.chmod(0o755)
        (self.folder / "run").chmod(0o711)
        self.configure()
        key = self.folder / "run/munge.key"
        key.touch(mode=0o600)
        key.write_bytes(os.urandom(1024))
        run = self.folder / "run"
        self.daemon("munged", "munged", "--foreground", f"--key-file={key}", "--force",
                    f"--socket={run}/munge.sock", f"--pid-file={run}/munged.pid",
                    f"--log-file={self.folder}/log/munged.log", f"--seed-file={run}/munge.seed")
        self.wait(lambda: (run / "munge.sock").exists(), 10, "munged")
        self.daemon("slurmctld", "slurmctld", "-D", "-c", "-f", self.environment["SLURM_CONF"])
        for n in self.numbers():
            self.start_node(f"n{n}")
        self.wait(lambda: self.ask("sinfo", "-h", "-N", "-o", "%t").split().count("idle") == self.nodes,
                  60, "the nodes")

    def numbers(self):
        return range(1, self.nodes + 1)

    def configure(self):
        host, user, port = socket.gethostname().split(".")[0], getpass.getuser(), free_ports(self.nodes + 1)
        memory = int(re.search(r"MemTotal: +(\d+)", Path("/proc/meminfo").read_text()).group(1)) // 1200
        f = self.folder
        (f / "slurm.conf").write_text(f"""ClusterName=tiny
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={f}/run/munge.sock
CredType=cred/munge
SlurmctldPidFile={f}/run/slurmctld.pid
SlurmdPidFile={f}/run/slurmd-%n.pid
SlurmctldLogFile={f}/log/slurmctld.log
SlurmdLogFile={f}/log/slurmd-%n.log
StateSaveLocation={f}/state
SlurmdSpoolDir={f}/spool/%n
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=2,bf_interval=2,batch_sched_delay=0,sched_min_interval=0
ReturnToService=2
MailProg=/bin/true
SlurmctldTimeout=10
SlurmdTimeout=10
InactiveLimit=0
KillWait=2
MinJobAge=3600
MaxArraySize=1001
MaxJobCount=20000
MessageTimeout=20
JobRequeue=1
SlurmdParameters=config_overrides
DefMemPerCPU=256
NodeName=n[1-{self.nodes}] NodeAddr=127.0.0.1 NodeHostname={host} Port={port + 1}-{port + self.nodes} \
CPUs={self.cpus} RealMemory={memory // self.nodes} State=UNKNOWN
PartitionName=main Nodes=n[1-{self.nodes}] Default=YES MaxTime=1-0 State=UP
""")

    def daemon(self, name, *command):
        with open(self.folder / "log" / f"{name}.out", "ab") as log:
            self.daemons[name] = subprocess.Popen(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL,
                                                  env=self.environment, start_new_session=True)

    def start_node(self, node):
        self.daemon(f"slurmd-{node}", "slurmd", "-D", "-c", "-N", node, "-f", self.environment["SLURM_CONF"])

    def lose_node(self, node):
        """The node's slurmd dies and its jobs go on, as when a machine loses its network: Slurm starts
        them elsewhere, so that two copies of one job run."""
        daemon = self.daemons.pop(f"slurmd-{node}")
        daemon.kill()
        daemon.wait()

    def crash_node(self, node):
        """The whole machine dies: slurmd, and all that its jobs run. start_node() is its way back."""
        daemon = self.daemons.pop(f"slurmd-{node}")
        victims = [*tree(daemon.pid), *self.started_by(node)]
        daemon.kill()  # first, so that it tells nobody
        for pid in victims:
            kill(pid)
        daemon.wait()

    def started_by(self, node=""):
        """Processes of jobs whose script lies in the spool folder of a node, or of any."""
        spool = f" {self.folder}/spool/" + (f"{node}/" if node else "")
        return [pid for path in Path("/proc").iterdir()
                if path.name.isdigit() and spool in command_of(int(path.name))
                for pid in tree(int(path.name))]

    def ask(self, *command, check=False, **options):
        done = subprocess.run(command, env=self.environment, text=True, capture_output=True, timeout=120,
                              **options)
        if check and done.returncode != 0:
            raise AssertionError(f"{command}: {done.stdout}{done.stderr}")
        return done.stdout

    def states(self):
        """Job or task ("12_3") -> state."""
        found = {}
        for line in self.ask("scontrol", "-o", "show", "job").splitlines():
            words = dict(word.split("=", 1) for word in line.split() if "=" in word)
            name = words["JobId"]
            if "ArrayTaskId" in words:
                name = f"{words['ArrayJobId']}_{words['ArrayTaskId']}"
            found[name] = words["JobState"]
        return found

    def pending(self):
        """Number of jobs that have not ended. Those that wait after being requeued are let go."""
        lines = self.ask("squeue", "-h", "-r", "-o", "%i %r").splitlines()
        for line in lines:
            if line.endswith("BeginTime"):
                self.ask("scontrol", "update", f"JobId={line.split()[0]}", "StartTime=now")
        return len(lines)

    @staticmethod
    def wait(condition, seconds, what):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                raise AssertionError(f"{what}: not there after {seconds} s")
            time.sleep(0.25)

    def stop(self):
        self.ask("scancel", f"--user={getpass.getuser()}")
        time.sleep(1)
        steps = [pid for name, daemon in self.daemons.items() if name.startswith("slurmd")
                 for pid in tree(daemon.pid)]
        for name in reversed(list(self.daemons)):
            self.daemons[name].terminate()
        for daemon in self.daemons.values():
            try:
                daemon.wait(timeout=15)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()
        for pid in steps + self.started_by():  # jobs of lost nodes outlive their slurmd
            if str(self.folder) in command_of(pid):
                kill(pid)
