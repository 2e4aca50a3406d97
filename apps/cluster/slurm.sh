#!/bin/bash
# foucault as a Slurm array; the arguments are those of foucault, without --shard:
#   sbatch --array=1-64 apps/cluster/slurm.sh evaluate logs/*.rawlog --store runs --out all
#SBATCH --job-name=foucault
#SBATCH --cpus-per-task=2
#SBATCH --mem-per-cpu=500M
#SBATCH --time=01:00:00
#SBATCH --requeue
#SBATCH --output=foucault-%A_%a.txt
exec "${FOUCAULT:-foucault}" "$@" --shard auto --jobs "${SLURM_CPUS_PER_TASK:-1}" --quiet
