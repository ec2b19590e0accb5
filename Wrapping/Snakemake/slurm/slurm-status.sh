#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# What became of a Slurm job, for Snakemake: running, success or failed.  Without it Snakemake waits for
# ever for a job that was killed.
# A job that Slurm no longer knows has ended; Snakemake then looks for its results.
set -u
state=$(scontrol --oneliner show job "$1" 2>&1)
case $state in
  *JobState=COMPLETED*) echo success ;;
  *JobState=PENDING*|*JobState=CONFIGURING*|*JobState=RUNNING*|*JobState=COMPLETING*) echo running ;;
  *JobState=SUSPENDED*|*JobState=REQUEUED*|*JobState=RESIZING*|*JobState=SIGNALING*) echo running ;;
  *JobState=STAGE_OUT*|*JobState=STOPPED*|*JobState=PREEMPTED*Requeue=1*) echo running ;;
  *JobState=*) echo failed ;;
  *"Invalid job id"*) echo success ;;
  *) echo running ;;  # the controller does not answer now
esac
