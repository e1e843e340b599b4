"""A campaign to be run by other processes: `python campaigning.py FILE COUNT PAUSE FOLDER [CLUSTER]`.

Its task leaves its process's number in FOLDER. If FOLDER has a file `victim`, the process whose task has the
number that stands there ends without warning, once.
"""

import os
import signal
import sys
import time
from pathlib import Path

from palpate.experiments import campaign


def task(number, *, pause, folder):
    (Path(folder) / f"{os.getpid()}.pid").touch()
    victim = Path(folder) / "victim"
    if victim.exists() and victim.read_text() == str(number):
        victim.unlink()
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(pause)
    return {"third": number / 3, "seconds": time.time()}


def main(file, count, pause, folder, cluster=None):
    settings = {"pause": float(pause), "folder": folder}
    return campaign.run("thirds", settings, range(int(count)), task, file, cluster=cluster)


if __name__ == "__main__":
    # Under its own name, so that workers find the task.
    import campaigning

    campaigning.main(*sys.argv[1:])
