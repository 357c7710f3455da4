"""A sweep on a cluster with SLURM: dask-jobqueue starts the workers, this script distributes cases and writes files.

Run it on the login node: python examples/cluster_sweep.py study.toml
With --show-job, it only prints the job script of a worker and submits no job.
"""

import argparse

from dask_jobqueue import SLURMCluster
from distributed import Client

import stickslip as ss

JOBS = 10


def slurm_cluster() -> SLURMCluster:
    """One worker with one thread for each job, because thread limits apply to a whole process."""
    return SLURMCluster(
        cores=1,
        processes=1,
        memory="4GB",
        walltime="04:00:00",
        job_extra_directives=["--job-name=stickslip"],
        job_script_prologue=["export OMP_NUM_THREADS=1"],
        # Any free port: on a login node that many share, the fixed one of the dashboard belongs to somebody else.
        scheduler_options={"dashboard_address": ":0"},
    )


def main(arguments: list[str] | None = None) -> None:
    """Start the workers, sweep the load, write the folder ``loads``."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("study", nargs="?", default="study.toml")
    parser.add_argument("--show-job", action="store_true", help="print the job script and stop")
    chosen = parser.parse_args(arguments)
    with slurm_cluster() as cluster:
        if chosen.show_job:
            print(cluster.job_script())
            return
        cluster.scale(jobs=JOBS)
        with Client(cluster) as client:
            case = ss.load_case(chosen.study)
            vary = {"preload.centrifugal_force": "50:2000:40:log"}
            result = ss.sweep(case, vary, client.get_executor(), out="loads", workers=JOBS)
    print(f"{len(result.table.rows)} cases, {len(result.table.failed)} failed; see loads/sweep.html")


if __name__ == "__main__":
    main()
