# SPDX-License-Identifier: Apache-2.0
"""How long a client, or a program between it and the daemon, waited for a core: only that excuses a missed scan."""
import collections
import os
import time
from pathlib import Path

QUEUE_S = 2.0  # the daemon and the relay keep so much for a client that does not read
LOOK_BACK_S = 2 * QUEUE_S  # a loss shows after what the queue had kept was read
EVERY_S = 0.1


def waited_s(process: int) -> dict[tuple[int, str], float]:
    """Returns how long each thread of a process has waited for a core since it began. The kernel counts that, so a late daemon is not in it.
    Empty if the kernel does not count, or if the process has ended: then no loss is excused."""
    waits = {}
    try:
        for thread in Path(f"/proc/{process}/task").iterdir():
            waits[process, thread.name] = int((thread / "schedstat").read_text().split()[1]) * 1e-9
    except OSError:
        pass
    return waits


class Starvation:
    """How long this process, or one of the processes on the way to it, waited for a core in the last LOOK_BACK_S: the longest wait of a thread."""

    def __init__(self, on_the_way: tuple[int, ...] = ()) -> None:
        self._processes = (os.getpid(), *on_the_way)
        self._samples = collections.deque([(time.monotonic(), self._waited_s())])
        self.most_s = 0.0

    def is_excuse(self) -> bool:
        return self._look() > QUEUE_S

    def _look(self) -> float:
        now_s = time.monotonic()
        while len(self._samples) > 1 and self._samples[1][0] < now_s - LOOK_BACK_S:
            self._samples.popleft()
        before, now = self._samples[0][1], self._waited_s()
        if now_s - self._samples[-1][0] >= EVERY_S:
            self._samples.append((now_s, now))
        starved_s = max((waited - before.get(thread, 0.0) for thread, waited in now.items()), default=0.0)
        self.most_s = max(self.most_s, starved_s)
        return starved_s

    def _waited_s(self) -> dict[tuple[int, str], float]:
        return {thread: waited for process in self._processes for thread, waited in waited_s(process).items()}
