#!/bin/bash
# Runs a command beside a Slurm of one node that lives as long: slurm_cluster.sh FOLDER COMMAND...
# Call it by "unshare -n -m" as root: it makes a network and a /etc/hosts of its own. Ends with 77 where Slurm does not come up.
set -u
folder=$1
shift
name=$(hostname)
ip link set lo up && ip link add cluster0 type veth peer name cluster1 && ip addr add 10.77.0.1/24 dev cluster0 &&
  ip link set cluster0 up && ip link set cluster1 up || exit 77
mount --make-rprivate /
printf '127.0.0.1 localhost\n10.77.0.1 %s\n' "$name" >"$folder/hosts"
mount --bind "$folder/hosts" /etc/hosts
mkdir -p "$folder"/{state,spool}
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
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/ctld.pid
SlurmdPidFile=$folder/d.pid
SlurmctldLogFile=$folder/ctld.log
SlurmdLogFile=$folder/d.log
JobRequeue=1
MpiDefault=none
NodeName=$name NodeAddr=10.77.0.1 CPUs=$(nproc) RealMemory=8000 State=UNKNOWN
PartitionName=all Nodes=$name Default=YES MaxTime=INFINITE State=UP
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
slurmd -D -f "$SLURM_CONF" -N "$name" >"$folder/d.out" 2>&1 &
daemons+=($!)
for _ in $(seq 150); do sinfo -h -o %T 2>/dev/null | grep -qx -e idle -e mixed && break; sleep 0.2; done
sinfo -h -o %T 2>/dev/null | grep -q idle || exit 77
"$@"
