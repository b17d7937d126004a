#!/bin/bash
# Runs a command beside a Slurm of two nodes that lives as long: slurm_cluster.sh FOLDER COMMAND...
# Call it by "unshare -n -m" as root: it makes a network and a /etc/hosts of its own. Ends with 77 where Slurm does not come up.
# Each node has processes of its own: killing the process in FOLDER/node2.init ends all that runs there at once.
set -u
folder=$1
shift
name=$(hostname)
ip link set lo up && ip link add cluster0 type veth peer name cluster1 && ip addr add 10.77.0.1/24 dev cluster0 &&
  ip addr add 10.77.0.2/24 dev cluster0 && ip link set cluster0 up && ip link set cluster1 up || exit 77
mount --make-rprivate /
printf '127.0.0.1 localhost\n10.77.0.1 %s node1\n10.77.0.2 node2\n' "$name" >"$folder/hosts"
mount --bind "$folder/hosts" /etc/hosts
mkdir -p "$folder/state"
cat >"$folder/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$name(10.77.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CryptoType=crypto/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool-%n
SlurmctldPidFile=$folder/ctld.pid
SlurmdPidFile=$folder/%n.pid
SlurmctldLogFile=$folder/ctld.log
SlurmdLogFile=$folder/%n.log
SlurmdTimeout=10
JobRequeue=1
MpiDefault=none
NodeName=node1 NodeHostname=node1 NodeAddr=10.77.0.1 Port=17001 CPUs=$(nproc) RealMemory=8000 State=UNKNOWN
NodeName=node2 NodeHostname=node2 NodeAddr=10.77.0.2 Port=17002 CPUs=$(nproc) RealMemory=8000 State=UNKNOWN
PartitionName=all Nodes=node1,node2 Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$folder/slurm.conf
head -c 1024 /dev/urandom >"$folder/munge.key"
chmod 400 "$folder/munge.key"
munged --foreground --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" --pid-file="$folder/munge.pid" \
  --log-file="$folder/munge.log" --seed-file="$folder/munge.seed" >"$folder/munge.out" 2>&1 &
daemons=($!)
trap 'kill "${daemons[@]}" 2>/dev/null; sleep 0.5; kill -9 "${daemons[@]}" 2>/dev/null' EXIT
for _ in $(seq 50); do test -S "$folder/munge.socket" && break; sleep 0.1; done
slurmctld -D -c -f "$SLURM_CONF" >"$folder/ctld.out" 2>&1 &
daemons+=($!)
for node in node1 node2; do
  unshare --pid --fork --kill-child --mount-proc slurmd -D -f "$SLURM_CONF" -N $node >"$folder/$node.out" 2>&1 &
  daemons+=($!)
  echo $! >"$folder/$node.init"
done
for _ in $(seq 150); do test "$(sinfo -h -N -o %T 2>/dev/null | grep -cx -e idle -e mixed)" = 2 && break; sleep 0.2; done
test "$(sinfo -h -N -o %T 2>/dev/null | grep -cx idle)" = 2 || exit 77
"$@"
