# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced after common.sh: a Slurm of two nodes on this host's loopback, of Debian's packages (slurm-wlm, munge), without systemd.
# cluster_start, cluster_stop, node_start N, node_kill N, controller_start, controller_stop.
for tool in slurmctld slurmd sbatch munged munge; do
  command -v $tool >/dev/null || [[ -x /usr/sbin/$tool ]] || skip "$tool is missing: the packages slurm-wlm and munge bring it"
done
[[ $(id -u) == 0 ]] || skip "slurmd starts jobs as root only"
cluster=$(mktemp -d /tmp/trephine-slurm-XXXXXX)
chmod 755 "$cluster"
export SLURM_CONF=$cluster/slurm.conf PATH=$PATH:/usr/sbin
# Three ports that nobody listens on, of the loopback only.
read -r port_controller port_n1 port_n2 < <(python3 -c '
import socket
s = [socket.socket() for _ in range(3)]
for one in s: one.bind(("127.0.0.1", 0))
print(*[one.getsockname()[1] for one in s])')
mkdir -p "$cluster"/{munge,state,spool-n1,spool-n2,log}
dd if=/dev/urandom of="$cluster/munge/key" bs=128 count=1 status=none
chmod 700 "$cluster/munge"; chmod 400 "$cluster/munge/key"
cat >"$cluster/slurm.conf" <<Y
ClusterName=trephine
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort=$port_controller
AuthType=auth/munge
AuthInfo=socket=$cluster/munge/socket
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$cluster/state
SlurmdSpoolDir=$cluster/spool-%n
SlurmctldPidFile=$cluster/slurmctld.pid
SlurmdPidFile=$cluster/slurmd-%n.pid
SlurmctldLogFile=$cluster/log/slurmctld.log
SlurmdLogFile=$cluster/log/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SchedulerType=sched/backfill
SchedulerParameters=sched_min_interval=100000,batch_sched_delay=0,sched_interval=2,bf_interval=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=none
ReturnToService=2
SlurmdTimeout=10
SlurmctldTimeout=10
InactiveLimit=0
KillWait=2
MinJobAge=60
MaxArraySize=${max_array:-1001}
CommunicationParameters=NoAddrCache
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
NodeName=n1 NodeHostname=localhost NodeAddr=127.0.0.1 Port=$port_n1 CPUs=1 RealMemory=4000
NodeName=n2 NodeHostname=localhost NodeAddr=127.0.0.1 Port=$port_n2 CPUs=1 RealMemory=4000
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
Y
# until SECONDS COMMAND...: waits until it succeeds.
until_true() {
  local end=$((SECONDS + $1)); shift
  until "$@" >/dev/null 2>&1; do ((SECONDS < end)) || return 1; sleep 0.2; done
}
controller_start() { slurmctld -f "$SLURM_CONF" >"$cluster/log/slurmctld.out" 2>&1 || true; until_true 120 scontrol ping; }
controller_stop() { kill "$(cat "$cluster/slurmctld.pid")"; until_true 60 bash -c '! kill -0 '"$(cat "$cluster/slurmctld.pid")"; }
node_start() { slurmd -N "$1" -f "$SLURM_CONF" >"$cluster/log/slurmd-$1.out" 2>&1; }
# The node dies at once, with everything that runs on it.
node_kill() {
  local node=$1 pid
  kill -9 "$(cat "$cluster/slurmd-$node.pid")"
  for pid in $(pgrep slurmstepd || true); do
    if ls -l "/proc/$pid/fd" 2>/dev/null | grep -q "$cluster/log/slurmd-$node.log"; then
      kill_tree "$pid"
    fi
  done
}
kill_tree() { local child; for child in $(pgrep -P "$1"); do kill_tree "$child"; done; kill -9 "$1" 2>/dev/null || true; }
is_idle() { [[ $(sinfo -h -N -o %T | sort -u) == idle ]]; }
cluster_start() {
  munged --force --foreground --key-file="$cluster/munge/key" --socket="$cluster/munge/socket" --pid-file="$cluster/munge/pid" \
    --log-file="$cluster/log/munged.log" --seed-file="$cluster/munge/seed" --num-threads=2 >"$cluster/log/munged.out" 2>&1 &
  munge_pid=$!
  until_true 60 munge -n -S "$cluster/munge/socket" || fail "munged: $(cat "$cluster"/log/munged.*)"
  controller_start || fail "slurmctld: $(tail "$cluster"/log/slurmctld.*)"
  node_start n1
  node_start n2
  until_true 120 is_idle || fail "the nodes are not there: $(sinfo; tail "$cluster"/log/slurmd-*)"
}
cluster_stop() {
  local file pid
  scancel --user=root 2>/dev/null || true
  for file in "$cluster"/slurmd-*.pid "$cluster/slurmctld.pid"; do
    [[ ! -s $file ]] || kill "$(cat "$file")" 2>/dev/null || true
  done
  [[ -z ${munge_pid:-} ]] || kill "$munge_pid" 2>/dev/null || true
  sleep 0.5
  for file in "$cluster"/slurmd-*.pid "$cluster/slurmctld.pid"; do
    [[ ! -s $file ]] || kill -9 "$(cat "$file")" 2>/dev/null || true
  done
  for pid in $(pgrep slurmstepd || true); do
    ! ls -l "/proc/$pid/fd" 2>/dev/null | grep -q "$cluster" || kill_tree "$pid"
  done
  rm -rf "$cluster"
}
trap 'set +e; cluster_stop; umount "$work/out" 2>/dev/null; chmod -R u+w "$work" 2>/dev/null; rm -rf "$work"' EXIT
